//! Where the paths of a block of vertices go on.

use super::hemisphere::Directions;
use super::numbers::Numbers;
use super::vertices::{BLOCK, Bits, Row, Standing, Vertices, frames, ray, vector};
use crate::light::Receiver;
use crate::material::BsdfSample;
use crate::material::many::{OfKind, WithKind};
use crate::surface::{Column, Surfaces};
use straal_color::Light;
use straal_math::simd::{Float, Kernel, Mask, Simd};
use straal_math::{Ray, Vec3};
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

/// What a path remembers of the vertex that it leaves, in rows that are moved whole: the normal where light arrives beside the density of
/// the direction, and the point beside the product of squared relative indices passed.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(16))]
pub(super) struct Behind([Row; 2]);

impl Behind {
    /// At the camera, which sees as if by a delta lobe.
    pub const CAMERA: Self = Self([[0.0; 4], [0.0, 0.0, 0.0, 1.0]]);

    /// The vertex as light sampling saw it.
    #[inline(always)]
    pub fn from(&self) -> Receiver {
        Receiver { p: vector(&self.0[1]), n: vector(&self.0[0]) }
    }

    /// The same of many from number `first` on, and the densities.
    #[inline(always)]
    pub fn of_many<F: Float>(these: &[Self], first: usize) -> (Receiver<F>, F) {
        let these = &these[first..first + F::WIDTH];
        let [nx, ny, nz, pdf] = F::from_rows(
            #[inline(always)]
            |i| these[i].0[0],
        );
        let [px, py, pz, _] = F::from_rows(
            #[inline(always)]
            |i| these[i].0[1],
        );
        (Receiver { p: Vec3::new(px, py, pz), n: Vec3::new(nx, ny, nz) }, pdf)
    }

    /// Density by which the direction was drawn there, in solid angle; unused after a delta lobe.
    #[inline(always)]
    pub const fn pdf(&self) -> f32 {
        self.0[0][3]
    }

    /// Product of squared relative indices passed: roulette looks at the light's energy, not its radiance.
    #[inline(always)]
    pub const fn eta_squared(&self) -> f32 {
        self.0[1][3]
    }
}

/// Where paths go on.
#[derive(Default)]
pub(super) struct Onward {
    /// The vertices from which they do.
    pub alive: Bits,
    delta: Bits,
    transmitted: Bits,
    /// Those whose directions are of a single wavelength.
    parted: Bits,
    /// Origin and least t, direction and largest t.
    rays: [[Row; 2]; BLOCK],
    beta: [Light; BLOCK],
    behind: [Behind; BLOCK],
    eta: Column,
    wavelength: Column,
}

impl Onward {
    /// The ray that goes on from vertex `i`; its time is that of the ray before.
    #[inline(always)]
    pub fn ray(&self, i: usize, before: &Ray) -> Ray {
        ray(&self.rays[i], before)
    }

    /// What it carries.
    #[inline(always)]
    pub fn beta(&self, i: usize) -> Light {
        self.beta[i]
    }

    /// What it remembers of the vertex.
    #[inline(always)]
    pub fn behind(&self, i: usize) -> Behind {
        self.behind[i]
    }

    /// Whether the direction was drawn from a delta lobe.
    #[inline(always)]
    pub fn delta(&self, i: usize) -> bool {
        self.delta.at(i)
    }

    /// Whether any direction is that of a single wavelength.
    #[inline(always)]
    pub fn parts_wavelengths(&self) -> bool {
        self.parted.any()
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
            pdf: self.behind[i].pdf(),
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
        let mut of = self.of;
        let SendOn { surfaces, vertices, numbers, goes_on, directions, .. } = of;
        (of.out.alive, of.out.delta, of.out.transmitted, of.out.parted) = Default::default();
        for first in (0..vertices.count.min(BLOCK)).step_by(F::WIDTH) {
            let alive = goes_on.load::<F>(first);
            let Some(bsdfs) = vertices.bsdfs::<K>(first) else { break };
            if !alive.any() {
                continue;
            }
            let Standing { leaning, .. } = vertices.standing(surfaces, first);
            let wo = surfaces.wo.load(first);
            let u = numbers.direction::<F>(first);
            let is_open = vertices.is_open.load::<F>(first);
            let (s, there) = directions.sample_many(bsdfs, leaning, (wo, u), is_open);
            of.go_on(first, alive & there, &s);
        }
    }
}

impl SendOn<'_, '_> {
    /// Sends the paths of vertices from number `first` on by their samples. It doesn't depend on the kind of BSDF, and is compiled once.
    #[inline(always)]
    fn go_on<F: Float>(&mut self, first: usize, alive: F::Mask, s: &BsdfSample<F>) {
        let Self { surfaces, vertices, numbers, roulette, out, .. } = self;
        F::vectorize(
            #[inline(always)]
            || {
                let Standing { from, .. } = vertices.standing(surfaces, first);
                let mut alive = alive;
                let mut beta = vertices.beta::<F>(first) * s.weight;
                let eta_squared = vertices.eta_squared.load::<F>(first) * s.eta * s.eta;

                // Roulette: paths that carry little end with a chance that keeps the mean. They go on by the root of what they carry, unless the scene
                // says otherwise: by the whole, survivors would be multiplied by so much that the noise costs more than the time saved (in
                // `box-diffuse` 12 % less variance for 3 % more time). Rath et al. 2022, "EARS: Efficiency-Aware Russian Roulette and Splitting",
                // whose optimum is a root as well.
                let plays = vertices.plays_roulette.load::<F>(first);
                if plays.any() {
                    let carried = beta.max_lane() * eta_squared;
                    let chance = if *roulette == Roulette::Throughput { carried } else { carried.sqrt() };
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
                out.parted.store(first, s.wavelength.gt(F::ZERO));
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
                    |i, row| out.behind[first + i].0[0] = row,
                );
                let p = from.end.p;
                F::to_rows(
                    [p.x, p.y, p.z, eta_squared],
                    #[inline(always)]
                    |i, row| out.behind[first + i].0[1] = row,
                );
                beta.for_each(
                    #[inline(always)]
                    |i, light| out.beta[first + i] = light,
                );
            },
        );
    }
}
