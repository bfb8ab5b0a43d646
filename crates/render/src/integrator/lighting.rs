//! Next-event estimation for a block of vertices: points on lights, and what they bring.

use super::Target;
use super::hemisphere::Directions;
use super::numbers::Numbers;
use super::technique::Technique;
use super::vertices::{BLOCK, Bits, Lights, ROOM, Row, Standing, Vertices, frames, ray};
use crate::lanes::Lanes;
use crate::light::LightSample;
use crate::light::links::{ALL, Class};
use crate::light::table::Picks;
use crate::material::many::{OfKind, WithKind};
use crate::shape::offset::End;
use crate::surface::{Column, Surfaces, Vectors};
use crate::world::World;
use straal_color::Light;
use straal_math::Ray;
use straal_math::simd::{Float, Kernel, Mask, Simd, Uint};

/// A light sample for each vertex, in columns.
#[derive(Default)]
pub(super) struct Lit {
    /// Those for which there is one.
    there: Bits,
    delta: Bits,
    /// Those on lamps of which not everything casts shadows.
    is_linked: Bits,
    far: Bits,
    wi: Vectors,
    radiance: Lights,
    /// Density, the choice of the light included.
    pdf: Column,
    to: Vectors,
    to_err: Vectors,
    to_ng: Vectors,
    /// Which emitter it is on, in a world where that matters.
    emitter: Numbered,
}

/// A number for each vertex.
#[derive(Clone, Copy)]
struct Numbered([u32; ROOM]);

impl Default for Numbered {
    fn default() -> Self {
        Self([0; ROOM])
    }
}

impl Lit {
    /// The emitter that vertex `i` has a sample of, in a world with groups of lights or lamps of which not everything casts shadows.
    pub fn emitter(&self, i: usize) -> u32 {
        self.emitter.0[i]
    }

    #[inline(always)]
    fn store<F: Float>(&mut self, first: usize, light: &LightSample<F>, pdf: F) {
        self.there.store(first, pdf.gt(F::ZERO));
        self.delta.store(first, light.delta);
        self.far.store(first, light.far);
        self.wi.store(first, light.wi);
        self.radiance.store(first, light.radiance);
        self.pdf.store(first, pdf);
        self.to.store(first, light.to.p);
        self.to_err.store(first, light.to.p_err);
        self.to_ng.store(first, light.to.ng);
    }

    #[inline(always)]
    fn load<F: Float>(&self, first: usize) -> LightSample<F> {
        LightSample {
            wi: self.wi.load(first),
            radiance: self.radiance.load(first),
            pdf: self.pdf.load(first),
            delta: self.delta.load::<F>(first),
            far: self.far.load::<F>(first),
            to: End { p: self.to.load(first), p_err: self.to_err.load(first), ng: self.to_ng.load(first) },
        }
    }
}

/// Chooses a light for each vertex, and a point on it by what is left of the number that chose: pairs of numbers are spread
/// better than what is drawn beside them.
pub(super) struct Illuminate<'a, 'w, L> {
    pub world: &'a World,
    pub surfaces: &'a Surfaces,
    pub vertices: &'a Vertices<'w>,
    /// By what each path reads colours.
    pub lanes: &'a [L; ROOM],
    /// By which lamps each vertex is lit, where not by all.
    pub classes: Option<&'a [Class; BLOCK]>,
    pub numbers: &'a Numbers,
    pub out: &'a mut Lit,
}

impl<L: Lanes> Kernel for Illuminate<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { world, surfaces, vertices, lanes, classes, numbers, out } = self;
        (out.there, out.delta, out.is_linked, out.far) = Default::default();
        let (readings, casters) = (world.readings(lanes), world.links.shadows_matter());
        let tells_emitter = casters || world.light_groups.matter();
        for first in (0..vertices.count.min(BLOCK)).step_by(F::WIDTH) {
            let asks = vertices.asks_lights.load::<F>(first);
            if !asks.any() {
                continue;
            }
            let at = vertices.receivers(surfaces, first);
            let [u, v] = numbers.light(first);
            let readings = readings.from(first);
            // Once, but where vertices are lit by other lamps than their neighbours.
            let (mut all, mut light, mut left) = (Picks::none(), LightSample::none(), asks);
            let picked = loop {
                let (class, these) = classes.map_or(
                    (ALL, left),
                    #[inline(always)]
                    |classes| of_a_class(classes, first, left),
                );
                let lights = world.lights_of(class);
                let mut picked = lights.picks(u, &at, world.within());
                picked.pmf = F::select(these, picked.pmf, F::ZERO);
                let one = world.sample_lights((lights, &picked), &at, v, &readings);
                if classes.is_none() {
                    light = one;
                    break picked;
                }
                all = Picks::select(these, &picked, &all);
                light = LightSample::select(these, one, light);
                left = left & !these;
                if !left.any() {
                    break all;
                }
            };
            if casters {
                let index = picked.index.to_array();
                let found = (0..F::WIDTH).filter(|&i| world.links.has_casters(index.as_ref()[i]));
                out.is_linked.store(first, F::Mask::from_bits(found.fold(0, |bits, i| bits | 1 << i)));
            }
            out.store(first, &light, picked.pmf * light.pdf);
            if tells_emitter {
                let to = &mut out.emitter.0[first..first + F::WIDTH];
                to.copy_from_slice(picked.index.to_array().as_ref());
            }
        }
    }
}

/// The class of the first vertex that is left, from vertex `first` on, and which of those that are left are of it.
#[inline(always)]
fn of_a_class<M: Mask>(classes: &[Class; BLOCK], first: usize, left: M) -> (Class, M) {
    let (left, class_of) = (left.to_bits(), |i: usize| classes.get(first + i).copied().unwrap_or(ALL));
    let class = class_of(left.trailing_zeros() as usize);
    let (mut these, mut rest) = (0, left);
    while rest != 0 {
        let i = rest.trailing_zeros();
        these |= u32::from(class_of(i as usize) == class) << i;
        rest &= rest - 1;
    }
    (class, M::from_bits(these))
}

/// What lights bring if nothing is in the way.
#[derive(Default)]
pub(super) struct Brought {
    /// The vertices to which they bring anything.
    pub bright: Bits,
    /// Origin and least t, direction and largest t.
    rays: [[Row; 2]; BLOCK],
    light: [Light; BLOCK],
    /// Of those on lamps of which not everything casts shadows the weight beside what BSDFs find, which their light hasn't yet.
    shared: Bits,
    weight: Column,
}

impl Brought {
    /// The ray that must be free for light to come to vertex `i`; its time is that of `like`.
    #[inline(always)]
    pub fn ray(&self, i: usize, like: &Ray) -> Ray {
        ray(&self.rays[i], like)
    }

    /// Where it goes.
    #[inline]
    pub fn target(&self, i: usize) -> Target {
        if self.shared.at(i) { Target::Shared(self.weight.at(i)) } else { Target::Sample }
    }

    /// What comes to vertex `i`.
    #[inline(always)]
    pub fn light(&self, i: usize) -> Light {
        self.light[i]
    }
}

/// Weighs light samples by BSDFs, and against the chance that these find the same light.
pub(super) struct Weigh<'a, 'w> {
    pub simd: Simd,
    pub surfaces: &'a Surfaces,
    pub vertices: &'a Vertices<'w>,
    pub lit: &'a Lit,
    pub technique: Technique,
    pub directions: Directions,
    pub out: &'a mut Brought,
}

impl<'w> WithKind<'w> for Weigh<'_, 'w> {
    fn with<K: OfKind<'w>>(self) {
        self.simd.run(WeighBy::<K> { of: self, kind: std::marker::PhantomData });
    }
}

/// [`Weigh`] by BSDFs of the kind `K`.
struct WeighBy<'a, 'w, K> {
    of: Weigh<'a, 'w>,
    kind: std::marker::PhantomData<K>,
}

impl<'w, K: OfKind<'w>> Kernel for WeighBy<'_, 'w, K> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        // See `Vertices::by_kind`.
        if F::WIDTH == 1 && !K::IS_ANY {
            return;
        }
        let mut of = self.of;
        let Weigh { surfaces, vertices, lit, directions, .. } = of;
        (of.out.bright, of.out.shared) = Default::default();
        for first in (0..vertices.count.min(BLOCK)).step_by(F::WIDTH) {
            let there = lit.there.load::<F>(first);
            let Some(bsdfs) = vertices.bsdfs::<K>(first) else { break };
            if !there.any() {
                continue;
            }
            let wi = frames::<F>(surfaces, first).to_local(lit.wi.load(first));
            let Standing { leaning, .. } = vertices.standing(surfaces, first);
            let wo = surfaces.wo.load(first);
            let is_open = vertices.is_open.load::<F>(first);
            let (value, pdf) = directions.eval_pdf_many(bsdfs, leaning, [wo, wi], is_open);
            of.bring(first, there, (value, pdf));
        }
    }
}

impl Weigh<'_, '_> {
    /// What comes to the vertices from number `first` on, by the values and densities of their BSDFs. It doesn't depend on the kind of these, and is compiled
    /// once.
    #[inline(always)]
    fn bring<F: Float>(&mut self, first: usize, there: F::Mask, (value, pdf): (Light<F>, F)) {
        let Self { surfaces, vertices, lit, technique, out, .. } = self;
        F::vectorize(
            #[inline(always)]
            || {
                let light = lit.load::<F>(first);
                let Standing { from, .. } = vertices.standing(surfaces, first);
                let mut weight = F::select(light.delta, F::ONE, technique.of_light(light.pdf, pdf));
                let shared = lit.is_linked.load::<F>(first) & !light.delta;
                if shared.any() {
                    out.shared.store(first, shared);
                    out.weight.store(first, weight);
                    weight = F::select(shared, F::ONE, weight);
                }
                let beta = vertices.beta::<F>(first);
                let brought = beta * value * light.radiance * (weight / light.pdf);

                let ([o, d], t_max) = light.way_from(&from);
                out.bright.store(first, there & !value.is_black() & !brought.is_black());
                F::to_rows(
                    [o.x, o.y, o.z, F::ZERO],
                    #[inline(always)]
                    |i, row| out.rays[first + i][0] = row,
                );
                F::to_rows(
                    [d.x, d.y, d.z, t_max],
                    #[inline(always)]
                    |i, row| out.rays[first + i][1] = row,
                );
                brought.for_each(
                    #[inline(always)]
                    |i, light| out.light[first + i] = light,
                );
            },
        );
    }
}
