//! What rays see that leave the scene, for a block of them.

use super::scattering::Behind;
use super::technique::Technique;
use super::vertices::{BLOCK, Bits, ROOM, Row};
use crate::film::{Provenance, SampleSums};
use crate::lanes::Lanes;
use crate::world::World;
use straal_color::Light;
use straal_math::simd::{Float, Kernel, Mask};
use straal_math::{Ray, Vec3};

/// Rays that leave the scene.
pub(super) struct Leaving<L> {
    count: usize,
    /// Their directions.
    d: [Row; ROOM],
    beta: [Light; ROOM],
    /// Where they come from. Densities are of directions that weren't drawn from delta lobes.
    behind: [Behind; ROOM],
    delta: Bits,
    /// Those that came by way of more than one surface.
    indirect: Bits,
    lanes: [L; ROOM],
    /// Whose light it is.
    sample: [u32; ROOM],
}

/// One of them.
pub(super) struct Leaver<'a, L> {
    pub ray: &'a Ray,
    pub beta: Light,
    pub behind: Behind,
    pub delta: bool,
    pub indirect: bool,
    pub lanes: L,
    pub sample: u32,
}

impl<L: Copy> Leaving<L> {
    /// None yet.
    pub fn new(lanes: L) -> Self {
        Self {
            count: 0,
            d: [[0.0; 4]; ROOM],
            beta: [Light::ZERO; ROOM],
            behind: [Behind::CAMERA; ROOM],
            delta: Bits::default(),
            indirect: Bits::default(),
            lanes: [lanes; ROOM],
            sample: [0; ROOM],
        }
    }

    /// Begins a block.
    pub fn clear(&mut self) {
        (self.count, self.delta, self.indirect) = Default::default();
    }

    /// Adds one.
    #[inline(always)]
    pub fn push(&mut self, leaver: &Leaver<'_, L>) {
        let (i, d) = (self.count, leaver.ray.d);
        self.count += 1;
        self.d[i] = [d.x, d.y, d.z, leaver.ray.t_max];
        self.beta[i] = leaver.beta;
        self.behind[i] = leaver.behind;
        self.delta.set(i, leaver.delta);
        self.indirect.set(i, leaver.indirect);
        self.lanes[i] = leaver.lanes;
        self.sample[i] = leaver.sample;
    }
}

/// Looks an emitter that surrounds the scene up, weighs its light against the chance that light sampling finds it, and adds it to the
/// samples.
pub(super) struct LookUp<'a, L> {
    pub world: &'a World,
    pub leaving: &'a Leaving<L>,
    pub emitter: u32,
    pub technique: Technique,
    pub sums: &'a mut SampleSums,
}

impl<L: Lanes> Kernel for LookUp<'_, L> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { world, leaving, emitter, technique, sums } = self;
        let environment = &world.emitters[emitter as usize];
        let readings = world.readings(&leaving.lanes);
        let group = world.light_groups.of(emitter);
        let count = leaving.count.min(BLOCK);
        for first in (0..count).step_by(F::WIDTH) {
            let readings = readings.from(first);
            let d = &leaving.d[first..first + F::WIDTH];
            let [x, y, z, _] = F::from_rows(
                #[inline(always)]
                |i| d[i],
            );
            let d = Vec3::new(x, y, z);
            let delta = leaving.delta.load::<F>(first);
            let beta = Light::from_fn(
                #[inline(always)]
                |i| leaving.beta[first + i],
            );
            let light = if delta.all() {
                beta * environment.radiance_from_many(d, &readings)
            } else {
                let (from, pdf) = Behind::of_many(&leaving.behind, first);
                let (radiance, by_environment) = environment.radiance_pdf_from_many(&from, d, &readings);
                let by_light = world.lights.pmfs(emitter, &from) * by_environment;
                let weight = technique.of_bsdf(pdf, by_light);
                beta * radiance * F::select(delta, F::ONE, weight)
            };
            light.for_each(
                #[inline(always)]
                |i, light| {
                    let i = first + i;
                    if i < count {
                        let from = Provenance { group, is_indirect: leaving.indirect.at(i) };
                        sums.add(leaving.sample[i], from, light);
                    }
                },
            );
        }
    }
}
