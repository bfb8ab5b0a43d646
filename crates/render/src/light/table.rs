//! The choice of an emitter.

use straal_math::simd::{Float, Mask, Uint};
use straal_math::table::Table1;

use super::copies::{Inside, Within, inwards, mean_stretch};
use super::reach::{Reach, Receiver};
use super::tree::{Held, Tree, WHOLE};
use super::{AreaLight, Emitter, LitSurface};
use crate::shape::Geometry;

/// Up to so many lights are weighed at each point.
const FEW: usize = 16;

/// Picks an emitter to sample. Black lights are never picked.
///
/// A few lights are weighed, at each point, by what they would bring if nothing were in the way, each of them getting one part of
/// the steps that probabilities are told in: sixteenths, or sixty-fourths for more than four lights. So a light that lies in
/// shadow can't starve the others, and a set of 64 well-spread samples is dealt out in whole numbers.
///
/// Many lights, and meshes of many triangles that shine, are a tree of what stands near each other (`tree.rs`), from which a point picks by
/// going down to what brings it more; those from afar stand beside it. An object in which something shines has a tree of its own, in its own space, which is gone down
/// wherever an instance of it is picked.
#[derive(Clone, Debug)]
pub struct LightTable {
    way: Way,
    /// By power, for rays that leave lights: the world's own, and those of each group in which anything shines.
    by_power: Vec<Option<Table1>>,
}

#[derive(Clone, Debug)]
enum Way {
    Nothing,
    /// A single one shines.
    Only(u32),
    Few(Vec<Lit>),
    Many(Box<Many>),
}

/// One of a few.
#[derive(Clone, Debug)]
struct Lit {
    index: u32,
    copy: u32,
    reach: Reach,
}

/// Many lights.
#[derive(Clone, Debug)]
struct Many {
    /// Those from afar.
    far: Vec<(u32, Reach)>,
    /// All others: the world's, and those of each group in which anything shines, in its own space.
    near: Vec<Option<Tree>>,
}

/// Meshes of more triangles than this are a lamp each triangle.
const WHOLE_MESH: usize = 64;

/// The least part of the picks that those from afar have, and the others, where both bring anything.
const LEAST: f32 = 0.2;

/// A chosen emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Which.
    pub index: u32,
    /// With which probability, above 0.
    pub pmf: f32,
    /// What is left of the number that chose: uniform in [0, 1) again.
    pub rest: f32,
    /// Which triangle of it, where [`LightTable::splits`] says so.
    pub part: u32,
    /// Which copy of it, of one that stands in an object.
    pub copy: u32,
}

/// Chosen emitters, side by side.
#[derive(Clone, Copy, Debug)]
pub struct Picks<F: Float> {
    /// Which.
    pub index: F::Uint,
    /// With which probability; 0 where nothing shines.
    pub pmf: F,
    /// What is left of the numbers that chose.
    pub rest: F,
    /// Which triangles, see [`Pick::part`].
    pub part: F::Uint,
    /// Which copies, see [`Pick::copy`].
    pub copy: F::Uint,
}

/// The greatest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

impl LightTable {
    /// Bytes that it takes for each of many emitters.
    pub const BYTES: usize = Table1::BYTES + Tree::BYTES;

    /// Bytes that it takes besides, for each, while it is made: powers, what shines, weights.
    pub const MAKING_BYTES: usize =
        size_of::<f64>() + size_of::<u32>() + size_of::<f32>() + Tree::MAKING_BYTES;

    /// A table of all emitters of a scene of the given radius in m.
    pub fn new(emitters: &[Emitter], geometry: &Geometry, scene_radius: f64) -> Self {
        Self::within(emitters, geometry, scene_radius, Within::WORLD)
    }

    /// [`Self::new`] of emitters some of which stand in objects.
    pub fn within(emitters: &[Emitter], geometry: &Geometry, scene_radius: f64, within: Within<'_>) -> Self {
        Self::of((emitters, &|_| true), geometry, scene_radius, within)
    }

    /// The same of some of them.
    pub(super) fn of(
        (emitters, is_one): (&[Emitter], &dyn Fn(u32) -> bool),
        geometry: &Geometry,
        scene_radius: f64,
        within: Within<'_>,
    ) -> Self {
        let powers: Vec<f64> = (0..)
            .zip(emitters)
            .map(|(i, e)| if is_one(i) { e.power(geometry, scene_radius) } else { 0.0 })
            .map(|w| if w > 0.0 && w.is_finite() { w } else { 0.0 })
            .collect();
        let shining: Vec<u32> = (0..).zip(&powers).filter(|(_, w)| **w > 0.0).map(|(i, _)| i).collect();
        let triangles = |&i: &u32| match &emitters[i as usize] {
            Emitter::Area(AreaLight { surface: LitSurface::Mesh { mesh, .. }, .. }) => {
                geometry.meshes[*mesh as usize].indices.len()
            }
            _ => 1,
        };
        let copies = within.copies;
        let count = shining.iter().fold(0_usize, |sum, i| sum.saturating_add(copies.count(*i) as usize));
        let is_many = count > FEW || shining.iter().any(|i| triangles(i) > WHOLE_MESH);
        let way = match shining[..] {
            [] => Way::Nothing,
            _ if is_many => Way::Many(Box::new(Many::new((emitters, is_one), geometry, &shining, within))),
            [only] if count == 1 => Way::Only(only),
            _ => {
                let of = |&index: &u32| {
                    let reach = emitters[index as usize].reach(geometry);
                    (0..copies.count(index)).filter_map(move |copy| {
                        let reach = reach.clone()?;
                        let reach =
                            if copies.has(index) { within.stand(index, copy).reach(reach) } else { reach };
                        Some(Lit { index, copy, reach })
                    })
                };
                Way::Few(shining.iter().flat_map(of).collect())
            }
        };
        Self { way, by_power: by_power(&powers, within) }
    }

    /// Picks the light that a ray is to leave, by power; `None` when nothing shines.
    pub fn pick_by_power(&self, u: f32, within: Within<'_>) -> Option<Pick> {
        let copies = within.copies;
        let (mut group, mut copy, mut pmf, mut rest) = (0, 0_u32, 1.0, u);
        loop {
            let choice = self.by_power.get(group)?.as_ref()?.sample(rest);
            (pmf, rest) = (pmf * choice.pmf, choice.rest);
            if copies.is_empty() {
                return Some(Pick { index: choice.index as u32, pmf, rest, part: WHOLE, copy });
            }
            let (lamps, inside) = copies.of_group(group);
            if let Some(&index) = lamps.get(choice.index) {
                return Some(Pick { index, pmf, rest, part: WHOLE, copy });
            }
            let &Inside { instance, group: inner } = inside.get(choice.index - lamps.len())?;
            copy = copy.wrapping_add(copies.part(instance));
            group = inner as usize;
        }
    }

    /// Picks for a point by `u` in [0, 1); `None` when nothing shines on it.
    #[inline]
    pub fn pick(&self, u: f32, at: &Receiver, within: Within<'_>) -> Option<Pick> {
        let Picks { index, pmf, rest, part, copy } = self.picks(u, at, within);
        (pmf > 0.0).then_some(Pick { index, pmf, rest, part, copy })
    }

    /// [`Self::pick`] for many points side by side.
    #[inline(always)]
    pub fn picks<F: Float>(&self, u: F, at: &Receiver<F>, within: Within<'_>) -> Picks<F> {
        match &self.way {
            Way::Nothing => Picks::whole(F::Uint::splat(0), F::ZERO, u),
            Way::Only(index) => Picks::whole(F::Uint::splat(*index), F::ONE, u),
            // Compiled once each, not for each way to read colours.
            Way::Few(lights) => F::vectorize(
                #[inline(always)]
                || picks_of_few(lights, u, at),
            ),
            Way::Many(many) => F::vectorize(
                #[inline(always)]
                || many.picks(u, at, within),
            ),
        }
    }

    /// The probability with which an emitter that stands in no object is picked for a point.
    #[inline]
    pub fn pmf(&self, index: u32, at: &Receiver) -> f32 {
        self.pmfs(index, at)
    }

    /// [`Self::pmf`] for many points side by side.
    #[inline(always)]
    pub fn pmfs<F: Float>(&self, index: u32, at: &Receiver<F>) -> F {
        match &self.way {
            Way::Nothing => F::ZERO,
            Way::Only(only) => F::splat(f32::from(u8::from(*only == index))),
            Way::Few(lights) => pmfs_of_few(lights, [index, 0], at),
            Way::Many(many) => many.pmfs(index, WHOLE, at),
        }
    }

    /// Whether an emitter is picked triangle by triangle.
    #[inline]
    pub fn splits(&self, index: u32) -> bool {
        matches!(&self.way, Way::Many(many) if many.near.iter().flatten().any(|tree| tree.splits(index)))
    }

    /// The probability with which a triangle of an emitter is picked, of one that [`Self::splits`] and stands in no object.
    #[inline]
    pub fn pmf_of_part(&self, index: u32, part: u32, at: &Receiver) -> f32 {
        match &self.way {
            Way::Many(many) => many.pmfs(index, part, at),
            _ => 0.0,
        }
    }

    /// The probability with which a copy of an emitter is picked, or a triangle of it where it [`Self::splits`].
    pub fn pmf_of_copy(&self, [index, copy, part]: [u32; 3], at: &Receiver, within: Within<'_>) -> f32 {
        match &self.way {
            Way::Nothing => 0.0,
            Way::Only(only) => f32::from(u8::from(*only == index)),
            Way::Few(lights) => pmfs_of_few(lights, [index, copy], at),
            Way::Many(many) => many.pmf_of_copy([index, copy, part], at, within),
        }
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let trees = match &self.way {
            Way::Many(many) => many.near.iter().flatten().map(Tree::bytes).sum(),
            _ => 0,
        };
        trees + self.by_power.iter().flatten().map(|table| table.len() * Table1::BYTES).sum::<usize>()
    }
}

/// Tables of each group by power, of which that of an instance is that of all within it.
fn by_power(powers: &[f64], within: Within<'_>) -> Vec<Option<Table1>> {
    // Relative to the strongest, so that single precision holds them.
    let table = |weights: &[f64]| {
        let most = weights.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        let relative: Vec<f32> = weights.iter().map(|&w| (w / most) as f32).collect();
        Table1::new(&relative)
    };
    if within.copies.is_empty() {
        return vec![table(powers)];
    }
    let (groups, order) = within.copies.groups();
    let mut tables = vec![None; groups.len()];
    let mut sums = vec![0.0; groups.len()];
    for number in order {
        let group = &groups[number];
        let lamps = group.lamps.iter().map(|i| powers[*i as usize]);
        let inside = group.inside.iter().map(|i| {
            let all = sums[i.group as usize] * f64::from(mean_stretch(&within.transform(i.instance)));
            if all.is_finite() { all } else { 0.0 }
        });
        let weights: Vec<f64> = lamps.chain(inside).collect();
        sums[number] = weights.iter().sum();
        tables[number] = table(&weights);
    }
    tables
}

impl<F: Float> Picks<F> {
    /// `yes` where the mask says so, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn select(mask: F::Mask, yes: &Self, no: &Self) -> Self {
        Self {
            index: F::Uint::select(mask, yes.index, no.index),
            pmf: F::select(mask, yes.pmf, no.pmf),
            rest: F::select(mask, yes.rest, no.rest),
            part: F::Uint::select(mask, yes.part, no.part),
            copy: F::Uint::select(mask, yes.copy, no.copy),
        }
    }

    /// Nothing.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self::whole(F::Uint::splat(0), F::ZERO, F::ZERO)
    }

    #[inline(always)]
    fn whole(index: F::Uint, pmf: F, rest: F) -> Self {
        Self { index, pmf, rest, part: F::Uint::splat(WHOLE), copy: F::Uint::splat(0) }
    }
}

impl Many {
    fn new(
        (emitters, is_one): (&[Emitter], &dyn Fn(u32) -> bool),
        geometry: &Geometry,
        shining: &[u32],
        within: Within<'_>,
    ) -> Self {
        let is_far = |i: &&u32| emitters[**i as usize].is_from_afar();
        let far = { shining.iter().filter(is_far) }
            .filter_map(|&i| Some((i, emitters[i as usize].reach(geometry)?)))
            .collect();
        let copies = within.copies;
        if copies.is_empty() {
            let all: Vec<u32> = (0..emitters.len() as u32).collect();
            return Self { far, near: vec![Tree::new((emitters, geometry), &all, &[], is_one)] };
        }
        let (groups, order) = copies.groups();
        let mut near: Vec<Option<Tree>> = vec![None; groups.len()];
        for number in order {
            let group = &groups[number];
            let held = |i: &Inside| {
                let whole = near[i.group as usize].as_ref().map(Tree::whole);
                Held { inside: *i, cluster: whole.map(|whole| whole.through(&within.transform(i.instance))) }
            };
            let inside: Vec<Held> = group.inside.iter().map(held).collect();
            near[number] = Tree::new((emitters, geometry), &group.lamps, &inside, is_one);
        }
        Self { far, near }
    }

    /// The world's own.
    #[inline(always)]
    fn in_world(&self) -> Option<&Tree> {
        self.near.first().and_then(Option::as_ref)
    }

    /// What each of those from afar brings.
    #[inline(always)]
    fn estimate<F: Float>(reach: &Reach, at: &Receiver<F>) -> F {
        let brings = reach.estimate(at);
        F::select(brings.gt(F::ZERO), brings.min(F::splat(1e30)), F::ZERO)
    }

    /// What all of those from afar bring, and the part of the picks that the others have.
    #[inline(always)]
    fn shares<F: Float>(&self, at: &Receiver<F>) -> (F, F) {
        let far = self.far.iter().fold(
            F::ZERO,
            #[inline(always)]
            |sum, (_, reach)| sum + Self::estimate(reach, at),
        );
        let Some(tree) = self.in_world() else { return (far, F::ZERO) };
        if self.far.is_empty() {
            return (far, F::ONE);
        }
        let near = tree.estimate(at);
        let share = (near / (near + far)).max(F::splat(LEAST)).min(F::splat(1.0 - LEAST));
        let share = F::select(far.gt(F::ZERO), share, F::ONE);
        (far, F::select(near.gt(F::ZERO), share, F::ZERO))
    }

    #[inline(always)]
    fn picks<F: Float>(&self, u: F, at: &Receiver<F>, within: Within<'_>) -> Picks<F> {
        let (far, share) = self.shares(at);
        let is_near = u.lt(share);
        let mut picked = Picks::whole(F::Uint::splat(0), F::ZERO, u);
        if let Some(tree) = self.in_world().filter(|_| is_near.any()) {
            let below_one = F::splat(BELOW_ONE);
            let down = tree.picks(F::select(is_near, u / share, F::ZERO).min(below_one), at);
            picked.index = down.emitter;
            picked.part = down.part;
            picked.pmf = F::select(is_near, down.pmf * share, F::ZERO);
            picked.rest = down.rest;
            let inside = down.inside & picked.pmf.gt(F::ZERO);
            if inside.any() {
                self.go_inside(&mut picked, inside, at, within);
            }
        }
        if is_near.all() {
            return picked;
        }
        let left = F::ONE - share;
        let place = (u - share) / left * far;
        let mut sum = F::ZERO;
        let mut open = !is_near & far.gt(F::ZERO);
        for (index, reach) in &self.far {
            let brings = Self::estimate(reach, at);
            // The last that brings anything also has what rounding leaves over.
            let it = open & brings.gt(F::ZERO) & !place.lt(sum);
            let rest = ((place - sum) / brings).max(F::ZERO).min(F::splat(BELOW_ONE));
            picked.index = F::Uint::select(it, F::Uint::splat(*index), picked.index);
            picked.part = F::Uint::select(it, F::Uint::splat(WHOLE), picked.part);
            picked.pmf = F::select(it, left * (brings / far), picked.pmf);
            picked.rest = F::select(it, rest, picked.rest);
            sum += brings;
            open = open & !place.lt(sum);
        }
        picked
    }

    #[inline(always)]
    fn pmfs<F: Float>(&self, index: u32, part: u32, at: &Receiver<F>) -> F {
        let (far, share) = self.shares(at);
        if let Some((_, reach)) = self.far.iter().find(|(i, _)| *i == index) {
            let brings = Self::estimate(reach, at);
            return F::select(brings.gt(F::ZERO), (F::ONE - share) * (brings / far), F::ZERO);
        }
        let tree = self.in_world();
        tree.map_or(F::ZERO, |tree| F::select(share.gt(F::ZERO), tree.pmfs(index, part, at) * share, F::ZERO))
    }

    /// Goes on within the instances that were picked, lane by lane: hardly two are in the same.
    #[cold]
    fn go_inside<F: Float>(
        &self,
        picked: &mut Picks<F>,
        lanes: F::Mask,
        at: &Receiver<F>,
        within: Within<'_>,
    ) {
        let mut left = lanes.to_bits();
        while left != 0 {
            let i = left.trailing_zeros() as usize;
            left &= left - 1;
            let inside = Inside { instance: picked.index.lane(i), group: picked.part.lane(i) };
            let at = Receiver { p: at.p.lane(i), n: at.n.lane(i) };
            let found = self.pick_inside(inside, picked.rest.lane(i), &at, within);
            let this = F::Mask::from_bits(1 << i);
            let pmf = picked.pmf * F::splat(found.pmf);
            picked.index = F::Uint::select(this, F::Uint::splat(found.index), picked.index);
            picked.part = F::Uint::select(this, F::Uint::splat(found.part), picked.part);
            picked.copy = F::Uint::select(this, F::Uint::splat(found.copy), picked.copy);
            picked.pmf = F::select(this, pmf, picked.pmf);
            picked.rest = F::select(this, F::splat(found.rest), picked.rest);
        }
    }

    /// Goes down the trees of an instance, and of those in it.
    fn pick_inside(&self, inside: Inside, u: f32, at: &Receiver, within: Within<'_>) -> Pick {
        let (mut inside, mut at) = (inside, *at);
        let mut picked = Pick { index: 0, pmf: 1.0, rest: u, part: WHOLE, copy: 0 };
        loop {
            at = inwards(&at, &within.transform(inside.instance));
            picked.copy = picked.copy.wrapping_add(within.copies.part(inside.instance));
            let Some(Some(tree)) = self.near.get(inside.group as usize) else {
                return Pick { index: 0, pmf: 0.0, ..picked };
            };
            let down = tree.picks::<f32>(picked.rest, &at);
            (picked.pmf, picked.rest) = (picked.pmf * down.pmf, down.rest);
            if picked.pmf <= 0.0 {
                return Pick { index: 0, pmf: 0.0, ..picked };
            }
            if !down.inside {
                return Pick { index: down.emitter, part: down.part, ..picked };
            }
            inside = Inside { instance: down.emitter, group: down.part };
        }
    }

    /// See [`LightTable::pmf_of_copy`].
    fn pmf_of_copy(&self, [index, copy, part]: [u32; 3], at: &Receiver, within: Within<'_>) -> f32 {
        let (_, share) = self.shares(at);
        let (mut tree, mut at) = (self.in_world(), *at);
        // Multiplied in the order of `picks`, for the same bits.
        let (mut outside, mut inside) = (share, 1.0);
        for (depth, instance) in within.copies.way(index, copy).iter().enumerate() {
            let Some((pmf, group)) = tree.and_then(|tree| tree.pmf_of_instance(instance, &at)) else {
                return 0.0;
            };
            if depth == 0 {
                outside = pmf * share;
            } else {
                inside *= pmf;
            }
            if outside * inside <= 0.0 {
                return 0.0;
            }
            at = inwards(&at, &within.transform(instance));
            tree = self.near.get(group as usize).and_then(Option::as_ref);
        }
        let lamp = tree.map_or(0.0, |tree| tree.pmfs::<f32>(index, part, &at));
        if within.copies.has(index) { outside * (inside * lamp) } else { lamp * share }
    }
}

#[inline(always)]
fn picks_of_few<F: Float>(lights: &[Lit], u: F, at: &Receiver<F>) -> Picks<F> {
    let shares = Shares::of(lights, at);
    // Exact: the steps are a power of two.
    let place = u * shares.steps;
    let mut first = F::ZERO;
    let mut picked = Picks::whole(F::Uint::splat(0), F::ZERO, F::ZERO);
    for (light, &width) in lights.iter().zip(&shares.each) {
        let end = first + width;
        // Those before have ended at or before it.
        let it = place.lt(end) & !place.lt(first);
        picked.index = F::Uint::select(it, F::Uint::splat(light.index), picked.index);
        picked.copy = F::Uint::select(it, F::Uint::splat(light.copy), picked.copy);
        picked.pmf = F::select(it, width / shares.steps, picked.pmf);
        picked.rest = F::select(it, ((place - first) / width).min(F::splat(BELOW_ONE)), picked.rest);
        first = end;
    }
    picked
}

#[inline(always)]
fn pmfs_of_few<F: Float>(lights: &[Lit], [index, copy]: [u32; 2], at: &Receiver<F>) -> F {
    let is_it = |l: &Lit| l.index == index && l.copy == copy;
    let Some(place) = lights.iter().position(is_it) else { return F::ZERO };
    let shares = Shares::of(lights, at);
    shares.each[place] / shares.steps
}

/// Probabilities in whole steps.
struct Shares<F> {
    steps: f32,
    /// By light; their sum is `steps`, or 0 when none shines there.
    each: [F; FEW],
}

impl<F: Float> Shares<F> {
    #[inline(always)]
    fn of(lights: &[Lit], at: &Receiver<F>) -> Self {
        let mut weights = [F::ZERO; FEW];
        let (mut total, mut count) = (F::ZERO, F::ZERO);
        for (weight, light) in weights.iter_mut().zip(lights) {
            let w = light.reach.estimate(at);
            let shines = w.gt(F::ZERO);
            // On a light of no size anything is infinite.
            *weight = F::select(shines, w.min(F::splat(1e30)), F::ZERO);
            total += *weight;
            count += F::select(shines, F::ONE, F::ZERO);
        }
        let steps = if lights.len() <= 4 { 16.0 } else { 64.0 };
        let mut each = [F::ZERO; FEW];
        let shared = F::splat(steps) - count;
        let (mut sum, mut before, mut last) = (F::ZERO, F::ZERO, F::ZERO);
        for (i, (share, &weight)) in each.iter_mut().zip(&weights).enumerate().take(lights.len()) {
            // One step, and of the others its part, by rounding the running sum.
            let shines = weight.gt(F::ZERO);
            sum += weight;
            let now = (shared * (sum / total) + 0.5).trunc();
            *share = F::select(shines, now - before + 1.0, F::ZERO);
            before = F::select(shines, now, before);
            last = F::select(shines, F::splat(i as f32), last);
        }
        // Should rounding have left a step over.
        let over = F::select(count.gt(F::ZERO), shared - before, F::ZERO);
        for (i, share) in each.iter_mut().enumerate().take(lights.len()) {
            *share += F::select(last.eq(F::splat(i as f32)), over, F::ZERO);
        }
        Self { steps, each }
    }
}
