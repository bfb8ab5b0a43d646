//! Where the paths of a block of vertices go on.

use super::numbers::Numbers;
use super::vertices::{BLOCK, Bits, Row, Vertices, ends, frames, vector};
use crate::light::Receiver;
use crate::material::many::{OfKind, WithKind};
use crate::material::{BsdfSample, Transport, shaded};
use crate::surface::{Column, Surfaces};
use straal_color::Light;
use straal_math::Ray;
use straal_math::simd::{Float, Kernel, Mask, Simd};

/// Where paths go on.
#[derive(Default)]
pub(super) struct Onward {
    /// The vertices from which they do.
    pub alive: Bits,
    delta: Bits,
    transmitted: Bits,
    /// Origins and densities; directions and products of squared relative indices; normals where light arrives.
    rows: [[Row; 3]; BLOCK],
    beta: [Light; BLOCK],
    eta: Column,
    wavelength: Column,
}

/// How one path goes on.
pub(super) struct Next {
    /// Its ray; time and mask are those of the ray before.
    pub ray: Ray,
    pub beta: Light,
    pub eta_squared: f32,
    /// The vertex, as light sampling saw it.
    pub from: Receiver,
    /// Of its direction, in the world. What it weighs is in `beta`.
    pub sample: BsdfSample,
}

impl Onward {
    /// How the path of vertex `i` goes on.
    #[inline(always)]
    pub fn get(&self, i: usize, surfaces: &Surfaces, before: &Ray) -> Next {
        let [o, d, n] = &self.rows[i];
        let (pdf, wi) = (o[3], vector(d));
        Next {
            ray: Ray { o: vector(o), t_min: 0.0, d: wi, t_max: f32::INFINITY, ..*before },
            beta: self.beta[i],
            eta_squared: d[3],
            from: Receiver { p: surfaces.p.at(i), n: vector(n) },
            sample: BsdfSample {
                wi,
                weight: Light::ZERO,
                pdf,
                delta: self.delta.at(i),
                transmitted: self.transmitted.at(i),
                eta: self.eta.at(i),
                wavelength: self.wavelength.at(i),
            },
        }
    }
}

/// Draws directions, and sends paths on or ends them.
pub(super) struct SendOn<'a, 'w> {
    pub simd: Simd,
    pub surfaces: &'a Surfaces,
    pub vertices: &'a Vertices<'w>,
    pub numbers: &'a Numbers,
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
        let SendOn { surfaces, vertices, numbers, out, .. } = self.of;
        (out.alive, out.delta, out.transmitted) = Default::default();
        for first in (0..vertices.count.min(BLOCK)).step_by(F::WIDTH) {
            let alive = vertices.alive.load::<F>(first);
            let Some(bsdfs) = vertices.bsdfs::<K>(first) else { break };
            if !alive.any() {
                continue;
            }
            let (leaning, wo) = (surfaces.leaning.load(first), surfaces.wo.load(first));
            let u = numbers.direction::<F>(first);
            let (s, there) = shaded::sample_many(bsdfs, leaning, (wo, u), Transport::Radiance);
            let mut alive = alive & there;
            let mut beta = vertices.beta.load::<F>(first) * s.weight;
            let eta_squared = vertices.eta_squared.load::<F>(first) * s.eta * s.eta;

            // Roulette: paths that carry little end with a chance that keeps the mean. They go on by the root of what they carry: by
            // the whole, survivors would be multiplied by so much that the noise costs more than the time saved (in `box-diffuse`
            // 12 % less variance for 3 % more time). Rath et al. 2022, "EARS: Efficiency-Aware Russian Roulette and Splitting", whose
            // optimum is a root as well.
            let plays = vertices.plays_roulette.load::<F>(first);
            if plays.any() {
                let survive = (beta.max_lane() * eta_squared).sqrt().min(F::splat(0.95));
                alive = alive & !(plays & numbers.roulette::<F>(first).ge(survive));
                beta = beta * F::select(plays, F::ONE / survive, F::ONE);
            }

            let wi = frames(surfaces, first).to_world(s.wi);
            let o = ends(surfaces, first).leave(wi);
            let n = vertices.receivers(surfaces, first).n;
            out.alive.store(first, alive & !beta.is_black());
            out.delta.store(first, s.delta);
            out.transmitted.store(first, s.transmitted);
            out.eta.store(first, s.eta);
            out.wavelength.store(first, s.wavelength);
            F::to_rows(
                [o.x, o.y, o.z, s.pdf],
                #[inline(always)]
                |i, row| out.rows[first + i][0] = row,
            );
            F::to_rows(
                [wi.x, wi.y, wi.z, eta_squared],
                #[inline(always)]
                |i, row| out.rows[first + i][1] = row,
            );
            F::to_rows(
                [n.x, n.y, n.z, F::ZERO],
                #[inline(always)]
                |i, row| out.rows[first + i][2] = row,
            );
            beta.for_each(
                #[inline(always)]
                |i, light| out.beta[first + i] = light,
            );
        }
    }
}
