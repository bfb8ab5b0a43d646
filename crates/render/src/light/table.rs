//! The choice of an emitter.

use straal_math::simd::{Float, Mask, Uint};
use straal_math::table::Table1;

use super::reach::{Reach, Receiver};
use super::tree::{Tree, WHOLE};
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
/// going down to what brings it more; those from afar stand beside it.
#[derive(Clone, Debug)]
pub struct LightTable {
    way: Way,
    /// By power, for rays that leave lights.
    by_power: Option<Table1>,
}

#[derive(Clone, Debug)]
enum Way {
    Nothing,
    /// A single one shines.
    Only(u32),
    Few(Vec<(u32, Reach)>),
    Many(Box<Many>),
}

/// Many lights.
#[derive(Clone, Debug)]
struct Many {
    /// Those from afar.
    far: Vec<(u32, Reach)>,
    /// All others.
    near: Option<Tree>,
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
        Self::of(emitters, geometry, scene_radius, &|_| true)
    }

    /// The same of some of them.
    pub(super) fn of(
        emitters: &[Emitter],
        geometry: &Geometry,
        scene_radius: f64,
        is_one: &dyn Fn(u32) -> bool,
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
        let way = match shining[..] {
            [] => Way::Nothing,
            _ if shining.len() > FEW || shining.iter().any(|i| triangles(i) > WHOLE_MESH) => {
                Way::Many(Box::new(Many::new((emitters, is_one), geometry, &shining)))
            }
            [only] => Way::Only(only),
            _ => {
                let reach = |&i: &u32| Some((i, emitters[i as usize].reach(geometry)?));
                Way::Few(shining.iter().filter_map(reach).collect())
            }
        };
        // Relative to the strongest, so that single precision holds them.
        let most = powers.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        let relative: Vec<f32> = powers.iter().map(|&w| (w / most) as f32).collect();
        Self { way, by_power: Table1::new(&relative) }
    }

    /// Picks the light that a ray is to leave, by power; `None` when nothing shines.
    pub fn pick_by_power(&self, u: f32) -> Option<Pick> {
        let choice = self.by_power.as_ref()?.sample(u);
        Some(Pick { index: choice.index as u32, pmf: choice.pmf, rest: choice.rest, part: WHOLE })
    }

    /// Picks for a point by `u` in [0, 1); `None` when nothing shines on it.
    #[inline]
    pub fn pick(&self, u: f32, at: &Receiver) -> Option<Pick> {
        let Picks { index, pmf, rest, part } = self.picks(u, at);
        (pmf > 0.0).then_some(Pick { index, pmf, rest, part })
    }

    /// [`Self::pick`] for many points side by side.
    #[inline(always)]
    pub fn picks<F: Float>(&self, u: F, at: &Receiver<F>) -> Picks<F> {
        match &self.way {
            Way::Nothing => Picks::whole(F::Uint::splat(0), F::ZERO, u),
            Way::Only(index) => Picks::whole(F::Uint::splat(*index), F::ONE, u),
            Way::Few(lights) => picks_of_few(lights, u, at),
            Way::Many(many) => many.picks(u, at),
        }
    }

    /// The probability with which an emitter is picked for a point.
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
            Way::Few(lights) => {
                let Some(place) = lights.iter().position(|(i, _)| *i == index) else { return F::ZERO };
                let shares = Shares::of(lights, at);
                shares.each[place] / shares.steps
            }
            Way::Many(many) => many.pmfs(index, WHOLE, at),
        }
    }

    /// Whether an emitter is picked triangle by triangle.
    #[inline]
    pub fn splits(&self, index: u32) -> bool {
        matches!(&self.way, Way::Many(many) if many.near.as_ref().is_some_and(|tree| tree.splits(index)))
    }

    /// The probability with which a triangle of an emitter is picked, of one that [`Self::splits`].
    #[inline]
    pub fn pmf_of_part(&self, index: u32, part: u32, at: &Receiver) -> f32 {
        match &self.way {
            Way::Many(many) => many.pmfs(index, part, at),
            _ => 0.0,
        }
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let tree = match &self.way {
            Way::Many(many) => many.near.as_ref().map_or(0, Tree::bytes),
            _ => 0,
        };
        tree + self.by_power.as_ref().map_or(0, |table| table.len() * Table1::BYTES)
    }
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
        }
    }

    /// Nothing.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self::whole(F::Uint::splat(0), F::ZERO, F::ZERO)
    }

    #[inline(always)]
    fn whole(index: F::Uint, pmf: F, rest: F) -> Self {
        Self { index, pmf, rest, part: F::Uint::splat(WHOLE) }
    }
}

impl Many {
    fn new(
        (emitters, is_one): (&[Emitter], &dyn Fn(u32) -> bool),
        geometry: &Geometry,
        shining: &[u32],
    ) -> Self {
        let is_far = |i: &&u32| emitters[**i as usize].is_from_afar();
        let far = { shining.iter().filter(is_far) }
            .filter_map(|&i| Some((i, emitters[i as usize].reach(geometry)?)))
            .collect();
        Self { far, near: Tree::new(emitters, geometry, is_one) }
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
        let Some(tree) = &self.near else { return (far, F::ZERO) };
        if self.far.is_empty() {
            return (far, F::ONE);
        }
        let near = tree.estimate(at);
        let share = (near / (near + far)).max(F::splat(LEAST)).min(F::splat(1.0 - LEAST));
        let share = F::select(far.gt(F::ZERO), share, F::ONE);
        (far, F::select(near.gt(F::ZERO), share, F::ZERO))
    }

    #[inline(always)]
    fn picks<F: Float>(&self, u: F, at: &Receiver<F>) -> Picks<F> {
        let (far, share) = self.shares(at);
        let is_near = u.lt(share);
        let mut picked = Picks::whole(F::Uint::splat(0), F::ZERO, u);
        if let Some(tree) = self.near.as_ref().filter(|_| is_near.any()) {
            let below_one = F::splat(BELOW_ONE);
            let down = tree.picks(F::select(is_near, u / share, F::ZERO).min(below_one), at);
            picked.index = down.emitter;
            picked.part = down.part;
            picked.pmf = F::select(is_near, down.pmf * share, F::ZERO);
            picked.rest = down.rest;
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
        let tree = self.near.as_ref();
        tree.map_or(F::ZERO, |tree| F::select(share.gt(F::ZERO), tree.pmfs(index, part, at) * share, F::ZERO))
    }
}

#[inline(always)]
fn picks_of_few<F: Float>(lights: &[(u32, Reach)], u: F, at: &Receiver<F>) -> Picks<F> {
    let shares = Shares::of(lights, at);
    // Exact: the steps are a power of two.
    let place = u * shares.steps;
    let mut first = F::ZERO;
    let mut picked = Picks::whole(F::Uint::splat(0), F::ZERO, F::ZERO);
    for ((index, _), &width) in lights.iter().zip(&shares.each) {
        let end = first + width;
        // Those before have ended at or before it.
        let it = place.lt(end) & !place.lt(first);
        picked.index = F::Uint::select(it, F::Uint::splat(*index), picked.index);
        picked.pmf = F::select(it, width / shares.steps, picked.pmf);
        picked.rest = F::select(it, ((place - first) / width).min(F::splat(BELOW_ONE)), picked.rest);
        first = end;
    }
    picked
}

/// Probabilities in whole steps.
struct Shares<F> {
    steps: f32,
    /// By light; their sum is `steps`, or 0 when none shines there.
    each: [F; FEW],
}

impl<F: Float> Shares<F> {
    #[inline(always)]
    fn of(lights: &[(u32, Reach)], at: &Receiver<F>) -> Self {
        let mut weights = [F::ZERO; FEW];
        let (mut total, mut count) = (F::ZERO, F::ZERO);
        for (weight, (_, reach)) in weights.iter_mut().zip(lights) {
            let w = reach.estimate(at);
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
