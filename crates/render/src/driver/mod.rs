//! The driver: passes over the picture, tiles over the threads, a pool of paths for each thread.
//!
//! It owns the loop: a worker starts samples, searches what their rays hit, sorts paths into queues
//! for the integrator's step, answers the shadow rays that it asks for, and fills the pool as paths end.

mod finishing;
mod guides;
mod samples;
mod sorting;
mod starting;
mod stream;
mod worker;

use crate::film::{CLAMPED, Film, FilmTile, MAX_SAMPLES, Region, next_check};
use crate::integrator::{AnyIntegrator, Integrator, WithIntegrator};
use crate::lanes::{Lanes, Rgb, Wavelengths};
use crate::probe::{CostMeter, Plain, Probe};
use crate::settings::Settings;
use crate::stopwatch::{Clock, Times};
use crate::world::World;
use sorting::Ranks;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use worker::{Pass, Worker};

pub use worker::thread_bytes;

/// A render under way. Between calls of [`Render::advance`] the film is whole, unless it [pauses](Render::pause_when): every pixel
/// that is still sampled has the same number of samples, and the sums are those of any other way to get there.
pub struct Render<'w> {
    world: &'w World,
    ranks: Ranks,
    integrator: Box<dyn Works + 'w>,
    settings: Settings,
    film: Film,
    done: u32,
    /// Up to which sample it was asked to advance.
    goal: u32,
    /// How many tiles, in their order, have the samples of the pass under way.
    tiles_done: usize,
    pause: Option<Pause>,
    times: Times,
    clock: Option<Clock>,
    pool: rayon::ThreadPool,
}

/// Asked by all threads, time and again, whether to pause.
pub type Pause = Arc<dyn Fn() -> bool + Send + Sync>;

/// Why a render can't start.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The operating system gave no threads.
    #[error("can't start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// What was asked for doesn't go together with light that paths bring to other pixels than their own.
    #[error("an integrator that brings light to the whole picture can't {0}")]
    LightSplats(&'static str),
}

/// An integrator of any kind as a render holds it: what is compiled for each kind is one thread's work.
trait Works: Sync {
    /// Takes tiles, and all their samples, until there are none; tells where the time went.
    fn work(&self, part: Part<'_, '_>, probe: &mut dyn Probe) -> Times;
}

/// What a thread is given for a pass.
struct Part<'a, 'f> {
    world: &'a World,
    ranks: &'a Ranks,
    settings: &'a Settings,
    clock: Option<Clock>,
    pass: &'a Pass<'a, 'f>,
}

impl Part<'_, '_> {
    fn work_by<I: Integrator, L: Lanes>(self, integrator: &I, probe: &mut dyn Probe) -> Times {
        let Self { world, ranks, settings, clock, pass } = self;
        let mut worker = Worker::<I, L>::new((world, ranks), integrator, settings, (clock, probe));
        worker.render(pass);
        worker.times()
    }
}

impl<I: Integrator> Works for I {
    fn work(&self, part: Part<'_, '_>, probe: &mut dyn Probe) -> Times {
        match part.world.tables.is_spectral() {
            true => part.work_by::<I, Wavelengths>(self, probe),
            false => part.work_by::<I, Rgb>(self, probe),
        }
    }
}

/// Lends a probe to one thread's work, and keeps it afterwards.
type Lend<'a> = &'a (dyn Fn(&mut dyn FnMut(&mut dyn Probe)) + Sync);

/// A render that is prepared by whichever integrator.
struct Prepare<'w> {
    world: &'w World,
    settings: Settings,
    clock: Option<Clock>,
}

impl<'w> WithIntegrator for Prepare<'w> {
    type Out = Result<Render<'w>, RenderError>;

    fn with<I: Integrator + 'static>(self, integrator: I) -> Self::Out {
        Render::new(self.world, integrator, self.settings, self.clock)
    }
}

impl<'w> Render<'w> {
    /// Prepares a render by an integrator that a scene asks for; nothing is traced yet. A clock lets it tell where the time goes. (All that
    /// such an integrator does is compiled in this crate; [`Render::new`] has it compiled where it is called.)
    pub fn by(
        world: &'w World,
        integrator: AnyIntegrator,
        settings: Settings,
        clock: Option<Clock>,
    ) -> Result<Self, RenderError> {
        integrator.hand_to(Prepare { world, settings, clock })
    }

    /// The same by any integrator.
    pub fn new<I: Integrator + 'w>(
        world: &'w World,
        integrator: I,
        settings: Settings,
        clock: Option<Clock>,
    ) -> Result<Self, RenderError> {
        let groups = if settings.light_groups_of::<I>() > 0 { world.light_groups.names() } else { &[] };
        let mut parts = groups.to_vec();
        if integrator.limit().is_finite() {
            parts.push(CLAMPED.to_owned());
        }
        Self::prepare(world, (Box::new(integrator), I::SPLATS, parts), settings, clock)
    }

    fn prepare(
        world: &'w World,
        (integrator, splats, parts): (Box<dyn Works + 'w>, bool, Vec<String>),
        settings: Settings,
        clock: Option<Clock>,
    ) -> Result<Self, RenderError> {
        if splats && settings.noise.is_some() {
            return Err(RenderError::LightSplats("end where the noise of a pixel's own samples is low"));
        }
        if splats && settings.splat {
            return Err(RenderError::LightSplats("splat its own samples by the filter as well"));
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build()?;
        let region = match splats {
            true => Region::whole(settings.size),
            false => settings.rendered(f64::from(world.filter.radius())),
        };
        let mut film = Film::over(settings.size, [settings.crop, region], settings.keep());
        film.hold_bands(world.sensor.recording().bands().copied(), &parts);
        if settings.splat {
            film.splat(&world.filter, world.simd());
        } else if let Some(weight) = world.filter.signed_weight() {
            film.control(f64::from(weight));
        }
        if splats {
            film.hold_light_splats();
        }
        if settings.adapts() {
            film.adapt(settings.holds_batches());
        } else if settings.holds_batches() {
            film.hold_batches();
        }
        if settings.error {
            film.tell_error(settings.error_estimate());
        }
        if settings.cost {
            film.count_costs(clock.is_some());
        }
        Ok(Self {
            world,
            ranks: Ranks::new(world),
            integrator,
            settings,
            film,
            done: 0,
            goal: 0,
            tiles_done: 0,
            pause: None,
            times: Times::default(),
            clock,
            pool,
        })
    }

    /// Leaves out the samples before `first`, of a render that has taken none yet.
    pub fn begin_at(&mut self, first: u32) {
        self.film.begin_at(first);
        self.done = first;
    }

    /// Takes up the sums that [`Film::write_sums`] wrote of a render of the same kind, up to the sample `done`; `dropped` is
    /// where it dropped the first. After an error the film is of no use.
    pub fn take_up(
        &mut self,
        done: u32,
        dropped: Option<([u32; 2], u32)>,
        sums: &mut dyn std::io::Read,
    ) -> std::io::Result<()> {
        self.film.read_sums(sums, dropped)?;
        self.done = done;
        Ok(())
    }

    /// Lets the render pause in the middle of a pass when it is asked to: [`Render::advance`] comes back when the tiles under way are
    /// done. At least one tile is done each time.
    pub fn pause_when(&mut self, pause: Pause) {
        self.pause = Some(pause);
    }

    /// Whether it has paused: some tiles have more samples than others. The next call of [`Render::advance`] adds no samples
    /// beyond those that it was asked for before.
    pub const fn is_midway(&self) -> bool {
        self.tiles_done > 0
    }

    /// Adds `samples` samples to every pixel (fewer where the film can't hold more: [`MAX_SAMPLES`] in all).
    pub fn advance(&mut self, samples: u32) {
        if self.settings.cost {
            let clock = self.clock.clone();
            self.advance_through(samples, || CostMeter::new(clock.clone()));
        } else {
            self.advance_through(samples, || Plain);
        }
    }

    /// The same, each worker asking what rays hit through a probe of its own; gives the probes back, in no order.
    pub fn advance_through<P: Probe>(&mut self, samples: u32, probe: impl Fn() -> P + Sync) -> Vec<P> {
        let probes = Mutex::new(Vec::new());
        self.advance_lending(samples, &|work| {
            let mut probe = probe();
            work(&mut probe);
            probes.lock().unwrap_or_else(PoisonError::into_inner).push(probe);
        });
        probes.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    fn advance_lending(&mut self, samples: u32, lend: Lend<'_>) {
        if !self.is_midway() {
            self.goal = self.done.saturating_add(samples).min(MAX_SAMPLES);
        }
        while self.done < self.goal && !self.is_settled() {
            // Looks come at fixed counts, however the samples are cut into passes.
            let look = next_check(self.done);
            let end = if self.settings.noise.is_some() { self.goal.min(look) } else { self.goal };
            self.take(self.done..end, lend);
            if self.is_midway() {
                break;
            }
            if let Some(target) = self.settings.noise.filter(|_| self.done == look) {
                self.pool.install(|| self.film.check(look, target));
            }
        }
    }

    /// Whether no pixel needs further samples.
    pub fn is_settled(&self) -> bool {
        self.settings.adapts() && !self.film.tiles.iter().any(FilmTile::is_open)
    }

    /// Takes no further samples of the blocks that are told by their first pixel in the whole picture; of a render whose blocks may be
    /// ended so, between passes.
    pub fn end_blocks(&mut self, is_done: impl Fn([u32; 2]) -> bool) {
        if self.settings.blocks {
            self.film.end_blocks(is_done);
        }
    }

    /// Takes the given samples of every pixel that needs them and hasn't got them, or as many tiles' as there is time for.
    fn take(&mut self, range: Range<u32>, lend: Lend<'_>) {
        let order = tile_order(self.film.tiles.len(), self.settings.shuffle_tiles);
        let tiles: Vec<Mutex<&mut FilmTile>> = self.film.tiles.iter_mut().map(Mutex::new).collect();
        let start = self.tiles_done;
        let next = AtomicUsize::new(start);
        let pause = &self.pause;
        let goes_on = || pause.as_ref().is_none_or(|pause| next.load(Ordering::Relaxed) == start || !pause());
        let (world, ranks, settings, clock) = (self.world, &self.ranks, &self.settings, &self.clock);
        let integrator = &*self.integrator;
        let take_tile = || {
            let place = goes_on().then(|| next.fetch_add(1, Ordering::Relaxed))?;
            order.get(place).copied()
        };
        let pass = Pass { tiles: &tiles, take_tile: &take_tile, indices: range.clone() };
        let done = self.pool.broadcast(|_| {
            let mut times = Times::default();
            lend(&mut |probe| {
                let part = Part { world, ranks, settings, clock: clock.clone(), pass: &pass };
                times += integrator.work(part, probe);
            });
            times
        });
        let reached = next.into_inner();
        if reached < order.len() {
            self.tiles_done = reached;
        } else {
            (self.tiles_done, self.done) = (0, range.end);
        }
        for times in done {
            self.times += times;
        }
    }

    /// The film so far.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The film, when the render is done.
    pub fn into_film(self) -> Film {
        self.film
    }

    /// Samples taken of every pixel that isn't done before.
    pub fn samples_done(&self) -> u32 {
        self.done
    }

    /// Where the time went, and rays traced.
    pub fn times(&self) -> Times {
        self.times
    }

    /// Worker threads.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }
}

/// Row by row, or shuffled (Fisher-Yates with a splitmix generator).
fn tile_order(n: usize, shuffle: Option<u64>) -> Vec<u32> {
    let mut order: Vec<u32> = (0..n as u32).collect();
    if let Some(mut state) = shuffle {
        for i in (1..n).rev() {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            order.swap(i, ((z ^ z >> 31) % (i as u64 + 1)) as usize);
        }
    }
    order
}
