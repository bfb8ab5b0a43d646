//! Samples that are finished: what the film takes of them.

use super::samples::{Pending, Samples};
use super::worker::Pass;
use crate::film::{BandSample, FilmTile, Flying, Sample, Sensor};
use crate::lanes::Lanes;
use crate::probe::Probe;
use crate::world::World;
use std::sync::MutexGuard;
use straal_color::Light;
use straal_math::simd::{Float, Kernel};

/// Gives the film the samples that are finished. Four lanes of light side by side: it is a kernel for the sake of wide registers.
pub(super) struct Finish<'a, 'p, 'f, L> {
    pub world: &'a World,
    pub probe: &'a dyn Probe,
    pub samples: &'a mut Samples<L>,
    /// What a sample adds to bands of wavelengths and of groups of lights; in here to be used again.
    pub bands: &'a mut Vec<BandSample>,
    pub pass: &'a Pass<'p, 'f>,
}

impl<L: Lanes> Kernel for Finish<'_, '_, '_, L> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { world, probe, samples, bands, pass } = self;
        let (sensor, counts) = (&world.sensor, probe.counts());
        let mut held: Option<(u32, MutexGuard<'_, &mut FilmTile>)> = None;
        while let Some((place, pending)) = samples.finished() {
            let tile = match &mut held {
                Some((number, tile)) if *number == pending.tile => tile,
                _ => &mut held.insert((pending.tile, pass.tile(pending.tile))).1,
            };
            let Pending { name: (pixel, index), lanes, weight, offset, .. } = pending;
            let light = samples.sums.light(place);
            let rgb = taken(sensor, &pending, light);
            let sample = Sample { rgb, seen: samples.seen.get(place), negative: weight < 0.0 };
            bands.clear();
            sensor.bands(lanes, light * weight, bands);
            for (group, light) in (0..).zip(samples.sums.parts(place)) {
                if !light.is_black() {
                    let first = sensor.first_band_of_group(group) as u16;
                    let colours = (first..).zip(taken(sensor, &pending, light));
                    bands.extend(colours.map(|(band, value)| BandSample { band, value }));
                }
            }
            let is_taken = tile.add(pixel, index, &sample, bands);
            if let Some(splats) = tile.splats() {
                let sample = is_taken.then_some(&sample);
                splats.add(&world.filter, &Flying { pixel, offset, sample, bands });
            }
            if let Some(cost) = counts.then(|| probe.cost(place)).flatten() {
                tile.add_cost(pixel, &cost);
            }
            samples.leave();
        }
    }
}

/// Light of a sample as the film takes it.
#[inline(always)]
fn taken<L: Lanes>(sensor: &Sensor, sample: &Pending<L>, light: Light) -> [f32; 3] {
    let ([r, g, b], glasses) = (sensor.take(sample.lanes, light), &sample.glasses);
    [r * sample.weight * glasses[0], g * sample.weight * glasses[1], b * sample.weight * glasses[2]]
}
