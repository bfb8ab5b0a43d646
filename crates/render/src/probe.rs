//! What a render's searches are asked through: plainly, with every test counted, or with the rays kept.
//!
//! Which of them is decided once for a pass. A probe is asked once for a whole slice of rays, so that the driver needn't be compiled for
//! each, and a plain render pays nothing for the others.

use crate::film::CostSample;
use crate::integrator::Contribution;
use crate::stopwatch::Clock;
use crate::world::{Passing, World};
use straal_accel::Hit;
use straal_color::Light;
use straal_math::Ray;

/// One worker's way of asking what rays hit. All give the same answers.
pub trait Probe: Send {
    /// The worker will number its samples from 0 to `room`, time and again.
    fn make_room(&mut self, room: usize);

    /// Whether it counts what samples cost, so that it must hear of them.
    fn counts(&self) -> bool;

    /// A sample begins under a number that an earlier one may have had.
    fn begin(&mut self, sample: u32);

    /// What each ray hits first.
    fn closest(&mut self, world: &World, asked: &Asked<'_>, hits: &mut [Hit]);

    /// [`World::transmittance`] of the shadow rays.
    fn transmittance(&mut self, world: &World, asked: &AskedShadows<'_>, answer: Answer<'_>);

    /// What the searches of a sample have cost so far, where that is counted.
    fn cost(&self, sample: usize) -> Option<CostSample>;
}

/// Rays that are searched together.
pub struct Asked<'a> {
    /// Whether they come from the camera.
    pub primary: bool,
    /// The sample that each ray belongs to.
    pub sample: &'a dyn Fn(usize) -> u32,
    /// The rays.
    pub rays: &'a [Ray],
}

/// Shadow rays that are searched together.
#[derive(Debug)]
pub struct AskedShadows<'a> {
    /// Who asks, as many as there are rays.
    pub shadows: &'a [Contribution],
    /// The rays.
    pub rays: &'a [Ray],
}

/// Where the transmittance of shadow rays goes.
#[derive(Debug)]
pub struct Answer<'a> {
    /// By ray, whether anything is in the way.
    pub blocked: &'a mut Vec<bool>,
    /// By ray; empty in a world where light passes whole or not at all.
    pub light: &'a mut Vec<Light>,
}

/// Asks and does nothing else.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plain;

impl Probe for Plain {
    fn make_room(&mut self, _room: usize) {}

    fn counts(&self) -> bool {
        false
    }

    fn begin(&mut self, _sample: u32) {}

    fn closest(&mut self, world: &World, asked: &Asked<'_>, hits: &mut [Hit]) {
        world.closest(asked.rays, hits);
    }

    fn transmittance(&mut self, world: &World, asked: &AskedShadows<'_>, answer: Answer<'_>) {
        world.transmittance(asked, answer.blocked, answer.light);
    }

    fn cost(&self, _sample: usize) -> Option<CostSample> {
        None
    }
}

/// Searches with one ray at a time, and books what each cost on its sample.
#[derive(Clone)]
pub struct CostMeter {
    clock: Option<Clock>,
    samples: Vec<CostSample>,
}

impl CostMeter {
    /// Counts tests; with a clock, time as well: of the counting search, the reading of the clock included.
    pub fn new(clock: Option<Clock>) -> Self {
        Self { clock, samples: Vec::new() }
    }

    fn now(&self) -> u64 {
        self.clock.as_ref().map_or(0, |clock| clock())
    }

    fn book(&mut self, sample: u32, cost: &straal_accel::Cost, nanoseconds: u64) {
        let sum = &mut self.samples[sample as usize];
        sum.nodes += u64::from(cost.nodes);
        sum.primitives += u64::from(cost.primitives);
        sum.nanoseconds += nanoseconds;
    }
}

impl Probe for CostMeter {
    fn make_room(&mut self, room: usize) {
        self.samples.resize(room, CostSample::default());
    }

    fn counts(&self) -> bool {
        true
    }

    fn begin(&mut self, sample: u32) {
        self.samples[sample as usize] = CostSample::default();
    }

    fn closest(&mut self, world: &World, asked: &Asked<'_>, hits: &mut [Hit]) {
        let mut last = self.now();
        for (i, (ray, hit)) in asked.rays.iter().zip(hits).enumerate() {
            let (found, cost) = world.accel.closest_counted(&world.geometry, ray);
            *hit = found;
            let now = self.now();
            self.book((asked.sample)(i), &cost, now.saturating_sub(last));
            last = now;
        }
    }

    fn transmittance(&mut self, world: &World, asked: &AskedShadows<'_>, answer: Answer<'_>) {
        let may_pass = world.any_may_pass();
        answer.blocked.clear();
        answer.light.clear();
        let mut last = self.now();
        for (shadow, ray) in asked.shadows.iter().zip(asked.rays) {
            let (blocked, mut cost) = world.accel.occluded_counted(&world.geometry, ray);
            answer.blocked.push(blocked);
            if may_pass {
                let mut passing = Passing::ALL;
                if blocked {
                    passing = world.past_masks(ray, |ray| {
                        let (hit, more) = world.accel.closest_counted(&world.geometry, ray);
                        cost.nodes = cost.nodes.saturating_add(more.nodes);
                        cost.primitives = cost.primitives.saturating_add(more.primitives);
                        hit
                    });
                }
                answer.light.push(Light::splat(passing.counts(shadow.weight())));
            }
            let now = self.now();
            self.book(shadow.sample, &cost, now.saturating_sub(last));
            last = now;
        }
    }

    fn cost(&self, sample: usize) -> Option<CostSample> {
        self.samples.get(sample).copied()
    }
}

/// Rays of one kind, slice by slice as the driver asked for them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tape {
    /// The rays, up to the recorder's limit.
    pub rays: Vec<Ray>,
    /// Where each slice ends among them.
    pub ends: Vec<usize>,
    /// Rays that were asked for, the unrecorded included.
    pub asked: u64,
}

impl Tape {
    fn take(&mut self, rays: &[Ray], limit: usize) {
        self.asked += rays.len() as u64;
        let room = limit - self.rays.len();
        let taken = if rays.len() < room { rays.len() } else { room };
        if taken > 0 {
            self.rays.extend_from_slice(&rays[..taken]);
            self.ends.push(self.rays.len());
        }
    }
}

/// Asks plainly, and keeps the rays.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    limit: usize,
    /// From the camera.
    pub primary: Tape,
    /// From surfaces onwards.
    pub bounce: Tape,
    /// Towards lights.
    pub shadow: Tape,
}

impl Recorder {
    /// Keeps at most `limit` rays of each kind.
    pub fn new(limit: usize) -> Self {
        Self { limit, ..Self::default() }
    }
}

impl Probe for Recorder {
    fn make_room(&mut self, _room: usize) {}

    fn counts(&self) -> bool {
        false
    }

    fn begin(&mut self, _sample: u32) {}

    fn closest(&mut self, world: &World, asked: &Asked<'_>, hits: &mut [Hit]) {
        let tape = if asked.primary { &mut self.primary } else { &mut self.bounce };
        tape.take(asked.rays, self.limit);
        world.closest(asked.rays, hits);
    }

    fn transmittance(&mut self, world: &World, asked: &AskedShadows<'_>, answer: Answer<'_>) {
        self.shadow.take(asked.rays, self.limit);
        world.transmittance(asked, answer.blocked, answer.light);
    }

    fn cost(&self, _sample: usize) -> Option<CostSample> {
        None
    }
}
