//! Samples that are finished: what the film takes of them.

use super::samples::{Pending, Samples};
use super::worker::Pass;
use crate::film::{BandSample, FilmTile, Flying, Many, Sample, Sensor};
use crate::lanes::Lanes;
use crate::probe::Probe;
use crate::world::World;
use straal_color::Light;
use straal_math::simd::{Float, Kernel};

/// Gives the film the samples that are finished: many side by side where nothing is asked of them but red, green and blue, else one by one.
pub(super) struct Finish<'a, 'p, 'f, L> {
    pub world: &'a World,
    pub probe: &'a dyn Probe,
    pub samples: &'a mut Samples<L>,
    pub pass: &'a Pass<'p, 'f>,
    pub scratch: &'a mut Scratch,
}

/// What is worked in.
pub(super) struct Scratch {
    many: Many,
    /// What a sample adds to bands of wavelengths and of groups of lights.
    bands: Vec<BandSample>,
}

impl Scratch {
    pub const fn new() -> Self {
        Self { many: Many::new(), bands: Vec::new() }
    }
}

impl<L: Lanes> Kernel for Finish<'_, '_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(mut self) {
        let (world, samples) = (self.world, &self.samples);
        let wants_little = !L::DRAWN
            && world.sensor.takes_as_is()
            && !world.camera.needs().glasses
            && samples.sums.are_whole()
            && samples.seen.is_empty()
            && !self.probe.counts();
        while let Some((_, Pending { tile: number, .. })) = self.samples.finished() {
            let mut tile = self.pass.tile(number);
            let wants_little = wants_little && tile.holds_light_alone() && tile.splats().is_none();
            while let Some((place, pending)) = self.samples.finished().filter(|(_, p)| p.tile == number) {
                if wants_little {
                    self.take_many::<F>(&mut tile, number);
                } else {
                    self.take_one(&mut tile, (place, &pending));
                    self.samples.leave();
                }
            }
        }
    }
}

impl<L: Lanes> Finish<'_, '_, '_, L> {
    /// Takes the first samples, which are of one tile.
    #[inline(always)]
    fn take_many<F: Float>(&mut self, tile: &mut FilmTile, number: u32) {
        let many = &mut self.scratch.many;
        let first = self.samples.number_of_first();
        many.clear();
        while let Some((place, pending)) = self.samples.finished().filter(|(_, p)| p.tile == number) {
            if many.is_full() {
                break;
            }
            many.push(self.samples.sums.sum(place), pending.weight, tile.index(pending.name.0));
            self.samples.leave();
        }
        many.round::<F>();
        tile.add_many(many);
        let mut unusual = many.unusual();
        while unusual != 0 {
            if let Some((place, pending)) = self.samples.numbered(first + unusual.trailing_zeros() as usize) {
                self.take_one(tile, (place, &pending));
            }
            unusual &= unusual - 1;
        }
    }

    /// Takes one sample.
    #[inline(never)]
    fn take_one(&mut self, tile: &mut FilmTile, (place, pending): (usize, &Pending<L>)) {
        let (sensor, samples, bands) = (&self.world.sensor, &self.samples, &mut self.scratch.bands);
        let &Pending { name: (pixel, index), lanes, weight, offset, .. } = pending;
        let light = samples.sums.light(place);
        let rgb = taken(sensor, pending, light);
        let sample = Sample { rgb, seen: samples.seen.get(place), negative: weight < 0.0 };
        bands.clear();
        sensor.bands(lanes, light * weight, bands);
        for (group, light) in (0..).zip(samples.sums.parts(place)) {
            if !light.is_black() {
                let first = sensor.first_band_of_group(group) as u16;
                let colours = (first..).zip(taken(sensor, pending, light));
                bands.extend(colours.map(|(band, value)| BandSample { band, value }));
            }
        }
        let is_taken = tile.add(pixel, index, &sample, bands);
        if let Some(splats) = tile.splats() {
            let sample = is_taken.then_some(&sample);
            splats.add(&self.world.filter, &Flying { pixel, offset, sample, bands });
        }
        if let Some(cost) = self.probe.cost(place) {
            tile.add_cost(pixel, &cost);
        }
    }
}

/// Light of a sample as the film takes it.
#[inline(always)]
fn taken<L: Lanes>(sensor: &Sensor, sample: &Pending<L>, light: Light) -> [f32; 3] {
    let ([r, g, b], glasses) = (sensor.take(sample.lanes, light), &sample.glasses);
    [r * sample.weight * glasses[0], g * sample.weight * glasses[1], b * sample.weight * glasses[2]]
}
