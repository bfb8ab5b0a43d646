//! What rays see that leave the scene, for a block of them.

use super::technique::Technique;
use super::vertices::{BLOCK, Bits, Lights, ROOM};
use crate::lanes::Lanes;
use crate::light::Receiver;
use crate::surface::{Column, Vectors};
use crate::world::World;
use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::{Float, Kernel, Mask};

/// Rays that leave the scene.
pub(super) struct Leaving<L> {
    count: usize,
    d: Vectors,
    beta: Lights,
    /// Densities of their directions, where these weren't drawn from delta lobes.
    pdf: Column,
    delta: Bits,
    /// Where they come from, as light sampling saw it.
    from: Vectors,
    from_n: Vectors,
    lanes: [L; ROOM],
}

/// One of them.
pub(super) struct Leaver<L> {
    pub d: Vec3,
    pub beta: Light,
    pub pdf: f32,
    pub delta: bool,
    pub from: Receiver,
    pub lanes: L,
}

impl<L: Copy> Leaving<L> {
    /// None yet.
    pub fn new(lanes: L) -> Self {
        Self {
            count: 0,
            d: Vectors::default(),
            beta: Lights::default(),
            pdf: Column::default(),
            delta: Bits::default(),
            from: Vectors::default(),
            from_n: Vectors::default(),
            lanes: [lanes; ROOM],
        }
    }

    /// Begins a block.
    pub fn clear(&mut self) {
        (self.count, self.delta) = (0, Bits::default());
    }

    /// Adds one.
    #[inline(always)]
    pub fn push(&mut self, leaver: &Leaver<L>) {
        let i = self.count;
        self.count += 1;
        self.d.set(i, leaver.d);
        self.beta.set(i, leaver.beta);
        self.pdf.set(i, leaver.pdf);
        self.delta.set(i, leaver.delta);
        self.from.set(i, leaver.from.p);
        self.from_n.set(i, leaver.from.n);
        self.lanes[i] = leaver.lanes;
    }
}

/// Looks an emitter that surrounds the scene up, and weighs its light against the chance that light sampling finds it.
pub(super) struct LookUp<'a, L> {
    pub world: &'a World,
    pub leaving: &'a Leaving<L>,
    pub emitter: u32,
    pub technique: Technique,
    pub out: &'a mut [Light; BLOCK],
}

impl<L: Lanes> Kernel for LookUp<'_, L> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { world, leaving, emitter, technique, out } = self;
        let environment = &world.emitters[emitter as usize];
        let readings = world.readings(&leaving.lanes);
        for first in (0..leaving.count.min(BLOCK)).step_by(F::WIDTH) {
            let readings = readings.from(first);
            let d = leaving.d.load::<F>(first);
            let delta = leaving.delta.load::<F>(first);
            let beta = leaving.beta.load(first);
            let light = if delta.all() {
                beta * environment.radiance_from_many(d, &readings)
            } else {
                let from = Receiver { p: leaving.from.load(first), n: leaving.from_n.load(first) };
                let (radiance, pdf) = environment.radiance_pdf_from_many(&from, d, &readings);
                let by_light = world.lights.pmfs(emitter, &from) * pdf;
                let weight = technique.of_bsdf(leaving.pdf.load(first), by_light);
                beta * radiance * F::select(delta, F::ONE, weight)
            };
            light.for_each(
                #[inline(always)]
                |i, light| {
                    if let Some(out) = out.get_mut(first + i) {
                        *out = light;
                    }
                },
            );
        }
    }
}
