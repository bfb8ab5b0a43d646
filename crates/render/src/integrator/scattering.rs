//! Where the paths of a block of vertices go on.

use super::hemisphere::Directions;
use super::numbers::Numbers;
use super::vertices::{BLOCK, Bits, Row, Standing, Vertices, frames, ray, vector};
use crate::light::Receiver;
use crate::material::BsdfSample;
use crate::material::many::{OfKind, WithKind};
use crate::surface::{Column, Surfaces};
use straal_color::Light;
use straal_math::Ray;
use straal_math::simd::{Float, Kernel, Mask, Simd};
use straal_scene::desc;

/// By which chance roulette lets a path go on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Roulette {
    /// The root of what it carries.
    #[default]
    Root,
    /// What it carries.
    Throughput,
    /// It isn't played before a path has 1000 edges.
    Off,
    /// What it brings for what it costs, as [`Ears`](super::Ears) knows it of the world; paths split as well.
    Ears,
}

impl Roulette {
    pub(super) fn of(said: &desc::Roulette) -> Self {
        match said {
            desc::Roulette::Root => Self::Root,
            desc::Roulette::Throughput => Self::Throughput,
            desc::Roulette::Off => Self::Off,
            desc::Roulette::Ears => Self::Ears,
        }
    }
}

/// Where paths go on.
#[derive(Default)]
pub(super) struct Onward {
    /// The vertices from which they do.
    pub alive: Bits,
    delta: Bits,
    transmitted: Bits,
    /// Origin and least t, direction and largest t.
    rays: [[Row; 2]; BLOCK],
    beta: [Light; BLOCK],
    eta_squared: Column,
    /// Normals where light arrives, and densities of the directions.
    rest: [Row; BLOCK],
    eta: Column,
    wavelength: Column,
}

impl Onward {
    /// The ray that goes on from vertex `i`; its time and mask are those of the ray before.
    #[inline(always)]
    pub fn ray(&self, i: usize, before: &Ray) -> Ray {
        ray(&self.rays[i], before)
    }

    /// What it carries, and the product of squared relative indices passed.
    #[inline(always)]
    pub fn carried(&self, i: usize) -> (Light, f32) {
        (self.beta[i], self.eta_squared.at(i))
    }

    /// The vertex as light sampling saw it, and the density of the direction.
    #[inline(always)]
    pub fn from(&self, i: usize, surfaces: &Surfaces) -> (Receiver, f32) {
        let rest = &self.rest[i];
        (Receiver { p: surfaces.p.at(i), n: vector(rest) }, rest[3])
    }

    /// Whether the direction was drawn from a delta lobe.
    #[inline(always)]
    pub fn delta(&self, i: usize) -> bool {
        self.delta.at(i)
    }

    /// See [`BsdfSample::wavelength`].
    #[inline(always)]
    pub fn wavelength(&self, i: usize) -> f32 {
        self.wavelength.at(i)
    }

    /// The sample whose direction it was, in the world. Its weight is in what is carried.
    pub fn sample(&self, i: usize) -> BsdfSample {
        BsdfSample {
            wi: vector(&self.rays[i][1]),
            weight: Light::ZERO,
            pdf: self.rest[i][3],
            delta: self.delta.at(i),
            transmitted: self.transmitted.at(i),
            eta: self.eta.at(i),
            wavelength: self.wavelength.at(i),
        }
    }
}

/// Draws directions, and sends paths on or ends them.
pub(super) struct SendOn<'a, 'w> {
    pub simd: Simd,
    pub surfaces: &'a Surfaces,
    pub vertices: &'a Vertices<'w>,
    pub numbers: &'a Numbers,
    /// The vertices from which paths may go on.
    pub goes_on: Bits,
    pub directions: Directions,
    pub roulette: Roulette,
    pub out: &'a mut Onward,
}

impl<'w> WithKind<'w> for SendOn<'_, 'w> {
    fn with<K: OfKind<'w>>(self) {
        self.simd.run(SendOnBy::<K> { of: self, kind: std::marker::PhantomData });
    }
}

/// [`SendOn`] by BSDFs of the kind `K`.
struct SendOnBy<'a, 'w, K> {
    of: SendOn<'a, 'w>,
    kind: std::marker::PhantomData<K>,
}

impl<'w, K: OfKind<'w>> Kernel for SendOnBy<'_, 'w, K> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        // See `Vertices::by_kind`.
        if F::WIDTH == 1 && !K::IS_ANY {
            return;
        }
        let SendOn { surfaces, vertices, numbers, goes_on, directions, roulette, out, .. } = self.of;
        (out.alive, out.delta, out.transmitted) = Default::default();
        for first in (0..vertices.count.min(BLOCK)).step_by(F::WIDTH) {
            let alive = goes_on.load::<F>(first);
            let Some(bsdfs) = vertices.bsdfs::<K>(first) else { break };
            if !alive.any() {
                continue;
            }
            let Standing { from, leaning } = vertices.standing(surfaces, first);
            let wo = surfaces.wo.load(first);
            let u = numbers.direction::<F>(first);
            let is_open = vertices.is_open.load::<F>(first);
            let (s, there) = directions.sample_many(bsdfs, leaning, (wo, u), is_open);
            let mut alive = alive & there;
            let mut beta = vertices.beta.load::<F>(first) * s.weight;
            let eta_squared = vertices.eta_squared.load::<F>(first) * s.eta * s.eta;

            // Roulette: paths that carry little end with a chance that keeps the mean. They go on by the root of what they carry, unless the scene
            // says otherwise: by the whole, survivors would be multiplied by so much that the noise costs more than the time saved (in
            // `box-diffuse` 12 % less variance for 3 % more time). Rath et al. 2022, "EARS: Efficiency-Aware Russian Roulette and Splitting",
            // whose optimum is a root as well.
            let plays = vertices.plays_roulette.load::<F>(first);
            if plays.any() {
                let carried = beta.max_lane() * eta_squared;
                let chance = if roulette == Roulette::Throughput { carried } else { carried.sqrt() };
                let survive = chance.min(F::splat(0.95));
                alive = alive & !(plays & numbers.roulette::<F>(first).ge(survive));
                beta *= F::select(plays, F::ONE / survive, F::ONE);
            }

            let wi = frames(surfaces, first).to_world(s.wi);
            let o = from.leave(wi);
            let n = vertices.receivers(surfaces, first).n;
            out.alive.store(first, alive & !beta.is_black());
            out.delta.store(first, s.delta);
            out.transmitted.store(first, s.transmitted);
            out.eta_squared.store(first, eta_squared);
            out.eta.store(first, s.eta);
            out.wavelength.store(first, s.wavelength);
            F::to_rows(
                [o.x, o.y, o.z, F::ZERO],
                #[inline(always)]
                |i, row| out.rays[first + i][0] = row,
            );
            F::to_rows(
                [wi.x, wi.y, wi.z, F::splat(f32::INFINITY)],
                #[inline(always)]
                |i, row| out.rays[first + i][1] = row,
            );
            F::to_rows(
                [n.x, n.y, n.z, s.pdf],
                #[inline(always)]
                |i, row| out.rest[first + i] = row,
            );
            beta.for_each(
                #[inline(always)]
                |i, light| out.beta[first + i] = light,
            );
        }
    }
}
