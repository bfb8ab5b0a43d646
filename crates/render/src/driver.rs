//! The driver: passes over the picture, tiles over the threads, waves of paths.

use crate::camera::FilmPoint;
use crate::film::{BandSample, Film, FilmTile, Flying, MAX_SAMPLES, next_look};
use crate::filter::{Filter, FilterSample};
use crate::footprint::PackedFootprint;
use crate::integrator::{Integrator, Path, Pending, ShadowRay, Wave};
use crate::lanes::{Lanes, Rgb, Wavelengths};
use crate::probe::{Answer, Asked, AskedShadows, CostMeter, Plain, Probe};
use crate::settings::Settings;
use crate::stopwatch::{Clock, Phase, Stopwatch, Times};
use crate::world::World;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use straal_accel::Hit;
use straal_color::Light;
use straal_math::Ray;
use straal_math::lowdisc::Purpose;

/// A render under way. Between calls of [`Render::advance`] the film is whole, unless it [pauses](Render::pause_when): every pixel
/// that is still sampled has the same number of samples, and the sums are those of any other way to get there.
pub struct Render<'w, I> {
    world: &'w World,
    integrator: I,
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
}

impl<'w, I: Integrator> Render<'w, I> {
    /// Prepares a render; nothing is traced yet. A clock lets it tell where the time goes.
    pub fn new(
        world: &'w World,
        integrator: I,
        settings: Settings,
        clock: Option<Clock>,
    ) -> Result<Self, RenderError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build()?;
        let region = settings.rendered(f64::from(world.filter.radius()));
        let mut film = Film::over(settings.size, [settings.crop, region], settings.keep());
        if let Some(bands) = world.sensor.recording().bands() {
            film.hold_bands(*bands);
        }
        if settings.splat {
            film.splat(&world.filter);
        } else if let Some(weight) = world.filter.signed_weight() {
            film.control(f64::from(weight));
        }
        if settings.noise.is_some() {
            film.adapt(settings.holds_batches());
        } else if settings.holds_batches() {
            film.hold_batches();
        }
        if settings.error {
            film.tell_error(settings.evidence());
        }
        if settings.cost {
            film.count_costs(clock.is_some());
        }
        Ok(Self {
            world,
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

    /// The same, each worker asking what rays hit through a probe of its own; gives the probes back.
    pub fn advance_through<P: Probe>(&mut self, samples: u32, probe: impl Fn() -> P + Sync) -> Vec<P> {
        if self.world.tables.is_spectral() {
            self.advance_by::<Wavelengths, P>(samples, probe)
        } else {
            self.advance_by::<Rgb, P>(samples, probe)
        }
    }

    fn advance_by<L: Lanes, P: Probe>(&mut self, samples: u32, probe: impl Fn() -> P + Sync) -> Vec<P> {
        if !self.is_midway() {
            self.goal = self.done.saturating_add(samples).min(MAX_SAMPLES);
        }
        let mut probes = Vec::new();
        while self.done < self.goal && !self.is_settled() {
            // Looks come at fixed counts, however the samples are cut into passes.
            let look = next_look(self.done);
            let end = if self.settings.noise.is_some() { self.goal.min(look) } else { self.goal };
            probes.append(&mut self.take::<L, P>(self.done..end, &probe));
            if self.is_midway() {
                break;
            }
            if let Some(target) = self.settings.noise.filter(|_| self.done == look) {
                for tile in &mut self.film.tiles {
                    tile.look(look, target);
                }
            }
        }
        probes
    }

    /// Whether no pixel needs further samples.
    pub fn is_settled(&self) -> bool {
        self.settings.noise.is_some() && !self.film.tiles.iter().any(FilmTile::is_open)
    }

    /// Takes the given samples of every pixel that needs them and hasn't got them, or as many tiles' as there is time for.
    fn take<L: Lanes, P: Probe>(&mut self, range: Range<u32>, probe: &(impl Fn() -> P + Sync)) -> Vec<P> {
        let order = tile_order(self.film.tiles.len(), self.settings.shuffle_tiles);
        let tiles: Vec<Mutex<&mut FilmTile>> = self.film.tiles.iter_mut().map(Mutex::new).collect();
        let start = self.tiles_done;
        let next = AtomicUsize::new(start);
        let pause = &self.pause;
        let goes_on = || pause.as_ref().is_none_or(|pause| next.load(Ordering::Relaxed) == start || !pause());
        let (world, integrator, settings, clock) =
            (self.world, &self.integrator, &self.settings, &self.clock);
        let done = self.pool.broadcast(|_| {
            let mut worker = Worker::<I, P, L>::new(world, integrator, settings, (clock.clone(), probe()));
            while goes_on()
                && let Some(&tile) = order.get(next.fetch_add(1, Ordering::Relaxed))
            {
                let mut tile = tiles[tile as usize].lock().unwrap_or_else(PoisonError::into_inner);
                worker.render(&mut tile, range.clone());
            }
            (worker.stopwatch.times, worker.probe)
        });
        let reached = next.into_inner();
        if reached < order.len() {
            self.tiles_done = reached;
        } else {
            (self.tiles_done, self.done) = (0, range.end);
        }
        let mut probes = Vec::with_capacity(done.len());
        for (times, probe) in done {
            self.times += times;
            probes.push(probe);
        }
        probes
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

/// One thread's buffers, reused from wave to wave.
struct Worker<'a, I: Integrator, P, L: Lanes> {
    world: &'a World,
    integrator: &'a I,
    settings: &'a Settings,
    stopwatch: Stopwatch,
    probe: P,
    /// Whether the next wave comes from the camera.
    primary: bool,
    paths: Vec<Path<I::State<L>>>,
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    order: Vec<u32>,
    counts: Vec<u32>,
    samples: Vec<Pending>,
    names: Vec<([u32; 2], u32)>,
    /// By sample: by what the film takes it.
    lanes: Vec<L>,
    /// By sample, what the filter multiplies its light by.
    weights: Vec<f32>,
    /// By sample, where it lies from its pixel's centre.
    offsets: Vec<[f32; 2]>,
    /// What the sample that the film takes adds to bands of wavelengths.
    bands: Vec<BandSample>,
    shadow_rays: Vec<Ray>,
    shadows: Vec<ShadowRay>,
    transmittance: Vec<Light>,
    blocked: Vec<bool>,
}

impl<'a, I: Integrator, P: Probe, L: Lanes> Worker<'a, I, P, L> {
    fn new(
        world: &'a World,
        integrator: &'a I,
        settings: &'a Settings,
        (clock, probe): (Option<Clock>, P),
    ) -> Self {
        Self {
            world,
            integrator,
            settings,
            stopwatch: Stopwatch::start(clock),
            probe,
            primary: true,
            paths: Vec::new(),
            rays: Vec::new(),
            hits: Vec::new(),
            order: Vec::new(),
            counts: Vec::new(),
            samples: Vec::new(),
            names: Vec::new(),
            lanes: Vec::new(),
            weights: Vec::new(),
            offsets: Vec::new(),
            bands: Vec::new(),
            shadow_rays: Vec::new(),
            shadows: Vec::new(),
            transmittance: Vec::new(),
            blocked: Vec::new(),
        }
    }

    /// Takes the given samples of every pixel of a tile, a batch at a time.
    fn render(&mut self, tile: &mut FilmTile, indices: Range<u32>) {
        let region = tile.region;
        let pixels =
            (region.min[1]..region.max[1]).flat_map(|y| (region.min[0]..region.max[0]).map(move |x| [x, y]));
        let sampled = tile.sampled();
        // A tile that was taken up from the middle of a pass may have some of them.
        let indices = indices.start.max(tile.next_sample())..indices.end;
        let mut names = { pixels.filter(|p| sampled.is_open(*p)) }
            .flat_map(|p| indices.clone().map(move |i| (p, i)))
            .filter(|(p, i)| sampled.contains(*p, *i));
        loop {
            self.names.clear();
            self.names.extend(names.by_ref().take(self.settings.batch.max(1)));
            if self.names.is_empty() {
                return;
            }
            self.start();
            while !self.paths.is_empty() {
                self.bounce();
            }
            for (k, (&(pixel, index), s)) in self.names.iter().zip(&self.samples).enumerate() {
                let mut sample = s.guides;
                sample.negative = self.weights[k] < 0.0;
                let light = self.world.sensor.take(self.lanes[k], s.light);
                sample.rgb = std::array::from_fn(|i| light[i] * self.weights[k] * s.taken[i]);
                self.bands.clear();
                self.world.sensor.bands(self.lanes[k], s.light * self.weights[k], &mut self.bands);
                let taken = tile.add(pixel, index, &sample, &self.bands);
                if let Some(splats) = tile.splats() {
                    let (offset, sample) = (self.offsets[k], taken.then_some(&sample));
                    let flying = Flying { pixel, offset, sample, bands: &self.bands };
                    splats.add(&self.world.filter, &flying);
                }
                if let Some(cost) = self.probe.cost(k) {
                    tile.add_cost(pixel, &cost);
                }
            }
            self.stopwatch.lap(Phase::Film);
        }
    }

    /// Camera rays of the named samples.
    fn start(&mut self) {
        let (world, settings) = (self.world, self.settings);
        self.paths.clear();
        self.rays.clear();
        self.lanes.clear();
        self.weights.clear();
        self.offsets.clear();
        self.samples.clear();
        self.samples.resize(self.names.len(), Pending::default());
        self.probe.begin(self.names.len());
        self.primary = true;
        let needs = world.camera.needs();
        for (k, &(pixel, index)) in self.names.iter().enumerate() {
            let name = settings.pattern.name(settings.seed, pixel, index);
            // The first two of four numbers are the same as two by themselves, which are cheaper.
            let (film, lens) = if needs.lens {
                let [x, y, u, v] = settings.pattern.d4(&name, Purpose::Film);
                ([x, y], [u, v])
            } else {
                (settings.pattern.d2(&name, Purpose::Film), [0.5; 2])
            };
            let time = if needs.time { settings.pattern.d1(&name, Purpose::Time) } else { 0.0 };
            let FilterSample { offset, weight } =
                if settings.splat { Filter::Box.sample(film) } else { world.filter.sample(film) };
            let position = [pixel[0] as f32 + 0.5 + offset[0], pixel[1] as f32 + 0.5 + offset[1]];
            let at = FilmPoint { pixel, position, lens, time };
            let u = if L::DRAWN { settings.pattern.d1(&name, Purpose::Wavelength) } else { 0.0 };
            let lanes = L::drawn(&world.tables, u);
            self.weights.push(weight);
            self.offsets.push(offset);
            self.lanes.push(lanes);
            if needs.taken {
                self.samples[k].taken = world.camera.taken(&at);
            }
            // Where nothing is seen there is no path, and the sample is black.
            let Some(ray) = world.camera.ray(&at) else { continue };
            let mut footprint = PackedFootprint::NONE;
            if world.materials.vary() {
                footprint = world.camera.footprint(&at).packed();
            }
            self.rays.push(ray);
            self.paths.push(Path {
                name,
                sample: k as u32,
                alive: true,
                state: self.integrator.start(lanes, footprint),
            });
        }
        self.stopwatch.lap(Phase::Camera);
    }

    /// One wave: trace, step, shadows, and the paths that ended leave.
    fn bounce(&mut self) {
        let world = self.world;
        self.hits.resize(self.paths.len(), Hit::MISS);
        let asked = Asked { primary: self.primary, paths: &self.paths, rays: &self.rays };
        self.probe.closest(world, &asked, &mut self.hits);
        self.primary = false;
        self.stopwatch.times.rays += self.rays.len() as u64;
        self.stopwatch.lap(Phase::Search);

        self.group_by_material();
        self.integrator.step(
            world,
            &mut Wave {
                pattern: self.settings.pattern,
                paths: &mut self.paths,
                rays: &mut self.rays,
                hits: &self.hits,
                order: &self.order,
                samples: &mut self.samples,
                shadow_rays: &mut self.shadow_rays,
                shadows: &mut self.shadows,
                stopwatch: &mut self.stopwatch,
            },
        );
        self.stopwatch.lap(Phase::Shading);

        // A sample has one path, and the path one shadow ray a step, so that a sample's light is added in the
        // order of its path whatever the wave.
        let asked = AskedShadows { shadows: &self.shadows, rays: &self.shadow_rays };
        let answer = Answer { blocked: &mut self.blocked, light: &mut self.transmittance };
        self.probe.transmittance(world, &asked, answer);
        for (shadow, &t) in self.shadows.iter().zip(&self.transmittance) {
            self.samples[shadow.sample as usize].light += shadow.light * t;
        }
        self.stopwatch.times.shadow_rays += self.shadow_rays.len() as u64;
        self.shadow_rays.clear();
        self.shadows.clear();

        let mut kept = 0;
        for i in 0..self.paths.len() {
            if self.paths[i].alive {
                self.paths[kept] = self.paths[i];
                self.rays[kept] = self.rays[i];
                kept += 1;
            }
        }
        self.paths.truncate(kept);
        self.rays.truncate(kept);
        self.stopwatch.lap(Phase::Search);
    }

    /// Counting sort of the paths by the material they hit; what misses comes last.
    fn group_by_material(&mut self) {
        let groups = self.world.material_count() + 1;
        self.counts.clear();
        self.counts.resize(groups + 1, 0);
        for hit in &self.hits {
            self.counts[self.world.material_group(hit) + 1] += 1;
        }
        for g in 0..groups {
            self.counts[g + 1] += self.counts[g];
        }
        self.order.resize(self.hits.len(), 0);
        for (i, hit) in self.hits.iter().enumerate() {
            let slot = &mut self.counts[self.world.material_group(hit)];
            self.order[*slot as usize] = i as u32;
            *slot += 1;
        }
    }
}
