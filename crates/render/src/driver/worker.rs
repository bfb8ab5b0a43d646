//! One thread's work: a pool of paths, filled as paths end.
//!
//! The pool is a stack. In each turn the paths on top, up to as many as the pool is meant to hold, are advanced by one edge,
//! and what their vertices emit is put back on top. So an integrator whose paths split goes deep before it goes wide, and the pool
//! stays bounded by what a path can split into, not by what a picture can.

use super::finishing::{self, Finish};
use super::guides;
use super::samples::{Pending, Samples};
use super::sorting::{Ranks, Sorting};
use super::starting::{self, Starting, Wanted};
use super::stream::{self, Name, Stream};
use crate::camera::Needs;
use crate::film::channel::{FirstHit, Seen, see};
use crate::film::{FilmTile, SampleSums, TILE};
use crate::filter::Filter;
use crate::footprint::PackedFootprint;
use crate::integrator::{
    Contribution, Integrator, Origin, Out, Path, PathTracer, Queue, Scratch, Start, Target,
};
use crate::lanes::{Lanes, Wavelengths};
use crate::probe::{Answer, Asked, AskedShadows, Probe};
use crate::settings::{Guides, Settings};
use crate::stopwatch::{Clock, Phase, Stopwatch, Times};
use crate::surface::BLOCK;
use crate::world::World;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};
use straal_accel::Hit;
use straal_color::Light;
use straal_math::Ray;
use straal_math::lowdisc::Purpose;
use straal_math::simd::{Float, Kernel, Simd};

/// Samples that may be under way for each path that the pool holds: a long path holds up those that were started after it.
const SAMPLES_A_PATH: usize = 4;

/// The pool is filled when this part of it is free, so that camera rays are searched many at a time.
const REFILL: usize = 4;

/// Bytes that each thread keeps for its pool, in a path tracer.
pub fn thread_bytes(settings: &Settings) -> u64 {
    type State = <PathTracer as Integrator>::State<Wavelengths>;
    let batch = settings.batch as u64;
    // Paths and their rays, those that go on as well; what they hit, their order; shadow rays and what they bring. Twice, since buffers double.
    let path = 2 * (2 * (size_of::<Path<State>>() + size_of::<Ray>()) + size_of::<Hit>() + 8)
        + size_of::<Ray>()
        + size_of::<Contribution>()
        + size_of::<Light>()
        + 1;
    let seen = if settings.layers { size_of::<Seen>() } else { 0 };
    let sample =
        size_of::<Option<Pending<Wavelengths>>>() + SampleSums::bytes(settings.light_groups) + 4 + seen;
    batch.saturating_mul(path as u64 + (SAMPLES_A_PATH * sample) as u64)
}

/// What the workers of a pass share.
pub(super) struct Pass<'a, 'f> {
    pub tiles: &'a [Mutex<&'f mut FilmTile>],
    /// The next tile to be worked on, if there is one.
    pub take_tile: &'a (dyn Fn() -> Option<u32> + Sync),
    /// The samples of each pixel.
    pub indices: Range<u32>,
}

impl<'a, 'f> Pass<'a, 'f> {
    /// A tile is one worker's from the moment it is taken, so that nobody waits.
    pub fn tile(&self, tile: u32) -> MutexGuard<'a, &'f mut FilmTile> {
        self.tiles[tile as usize].lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Puts a list in place of what another has from `base` on, and leaves it empty.
fn put_on<T>(list: &mut Vec<T>, base: usize, next: &mut Vec<T>) {
    list.truncate(base);
    if list.is_empty() {
        std::mem::swap(list, next);
    } else {
        list.append(next);
    }
}

/// One thread's buffers.
pub(super) struct Worker<'a, I: Integrator, L: Lanes> {
    world: &'a World,
    integrator: &'a I,
    settings: &'a Settings,
    needs: Needs,
    simd: Simd,
    stopwatch: Stopwatch,
    probe: &'a mut dyn Probe,
    samples: Samples<L>,
    stream: Stream,
    /// The tile of the stream.
    tile: u32,
    /// Samples that set out.
    names: Vec<Name>,
    starting: Box<Starting>,
    /// Whether there may be samples that weren't started.
    has_more: bool,
    paths: Vec<Path<I::State<L>>>,
    rays: Vec<Ray>,
    /// How many of the paths, the last, have just been started.
    fresh: usize,
    hits: Vec<Hit>,
    sorting: Sorting<'a>,
    next: Vec<Path<I::State<L>>>,
    next_rays: Vec<Ray>,
    shadow_rays: Vec<Ray>,
    shadows: Vec<Contribution>,
    splats: Vec<Contribution>,
    scratch: Option<Box<Scratch>>,
    transmittance: Vec<Light>,
    blocked: Vec<bool>,
    finishing: Box<finishing::Scratch>,
}

impl<'a, I: Integrator, L: Lanes> Worker<'a, I, L> {
    pub fn new(
        (world, ranks): (&'a World, &'a Ranks),
        integrator: &'a I,
        settings: &'a Settings,
        (clock, probe): (Option<Clock>, &'a mut dyn Probe),
    ) -> Self {
        let room = settings.batch.saturating_mul(SAMPLES_A_PATH).min(1 << 24);
        let samples =
            Samples::new(room, settings.layers, (settings.light_groups_of::<I>(), integrator.limit()));
        probe.make_room(samples.room());
        Self {
            world,
            integrator,
            settings,
            needs: Needs { time: world.camera.needs().time || world.accel.moves(), ..world.camera.needs() },
            simd: world.simd(),
            stopwatch: Stopwatch::start(clock),
            probe,
            samples,
            stream: Stream::empty(),
            tile: 0,
            names: Vec::new(),
            starting: Box::default(),
            has_more: true,
            paths: Vec::new(),
            rays: Vec::new(),
            fresh: 0,
            hits: Vec::new(),
            sorting: Sorting::new(ranks),
            next: Vec::new(),
            next_rays: Vec::new(),
            shadow_rays: Vec::new(),
            shadows: Vec::new(),
            splats: Vec::new(),
            scratch: None,
            transmittance: Vec::new(),
            blocked: Vec::new(),
            finishing: Box::new(finishing::Scratch::new()),
        }
    }

    /// Takes tiles, and all their samples, until there are none.
    pub fn render(&mut self, pass: &Pass<'_, '_>) {
        loop {
            self.refill(pass);
            if self.samples.is_empty() {
                return;
            }
            self.turn();
            self.splat(pass);
            self.finish(pass);
        }
    }

    /// Where the time went.
    pub fn times(&self) -> Times {
        self.stopwatch.times
    }

    /// Paths that are advanced together.
    fn capacity(&self) -> usize {
        self.settings.batch.max(1)
    }

    /// Starts samples if there is room for many.
    fn refill(&mut self, pass: &Pass<'_, '_>) {
        self.fresh = 0;
        let room = self.capacity().saturating_sub(self.paths.len());
        if !self.has_more || room * REFILL < self.capacity() {
            return;
        }
        while self.paths.len() < self.capacity() && !self.samples.is_full() {
            let room = (self.capacity() - self.paths.len()).min(self.samples.room_left()).min(BLOCK);
            self.names.clear();
            self.names.extend(self.stream.by_ref().take(room));
            if !self.names.is_empty() {
                self.start();
                continue;
            }
            let Some(tile) = (pass.take_tile)() else {
                self.has_more = false;
                break;
            };
            self.tile = tile;
            self.stream = Stream::of(&pass.tile(tile), pass.indices.clone());
        }
        self.stopwatch.lap(Phase::Camera);
    }

    /// Starts the samples that have names.
    fn start(&mut self) {
        let (world, settings) = (self.world, self.settings);
        let from_camera = I::ORIGIN == Origin::Camera;
        let Needs { lens, time, glasses, .. } = self.needs;
        self.simd.run(starting::Start {
            names: &self.names,
            pattern: settings.pattern,
            seed: settings.seed,
            halves: settings.adapts(),
            filter: if settings.splat { &Filter::Box } else { &world.filter },
            wanted: Wanted { lens, time, wavelength: L::DRAWN, rays: from_camera },
            camera: &world.camera,
            out: &mut self.starting,
        });
        let (starting, counts) = (&self.starting, self.probe.counts());
        let (wants_footprint, mask) = (from_camera && world.wants_footprints(), world.camera_mask());
        let before = self.paths.len();
        for (i, &(pixel, index)) in self.names.iter().enumerate() {
            let name = match from_camera {
                true => starting.name(i),
                false => stream::light_path(settings, pixel, index),
            };
            let lanes = L::drawn(&world.tables, if L::DRAWN { starting.wavelength(i) } else { 0.0 });
            let at = || starting.film_point(i, pixel);
            let sample = self.samples.begin(Pending {
                name: (pixel, index),
                tile: self.tile,
                lanes,
                weight: starting.weight(i),
                offset: starting.offset(i),
                glasses: if glasses { world.camera.glasses(&at()) } else { [1.0; 3] },
            });
            if counts {
                self.probe.begin(sample);
            }
            let footprint = match wants_footprint {
                true => world.camera.footprint(&at()).of_sample(index.into()).packed(),
                false => PackedFootprint::NONE,
            };
            // Where nothing is seen there is no path, and the sample is black.
            let camera_ray = starting.ray(i).map(|ray| Ray { mask, ..ray });
            let (size, pattern) = (settings.size, settings.pattern);
            let start = Start { world, size, pixel, pattern, name, lanes, camera_ray, footprint };
            if let Some((ray, state)) = self.integrator.start(&start) {
                self.rays.push(ray);
                self.paths.push(Path { name, sample, state });
                self.samples.depart(sample);
            }
        }
        self.fresh += self.paths.len() - before;
    }

    /// The paths on top: search, step, shadows.
    fn turn(&mut self) {
        let world = self.world;
        let base = self.paths.len() - self.paths.len().min(self.capacity());
        let (paths, rays) = (&self.paths[base..], &self.rays[base..]);
        let old = paths.len() - self.fresh;
        self.hits.resize(paths.len(), Hit::MISS);
        for (range, primary) in [(0..old, false), (old..paths.len(), I::ORIGIN == Origin::Camera)] {
            if !range.is_empty() {
                let asking = &paths[range.clone()];
                let asked = Asked { primary, sample: &|i| asking[i].sample, rays: &rays[range.clone()] };
                self.probe.closest(world, &asked, &mut self.hits[range]);
            }
        }
        if world.materials.any_may_pass() {
            let primary = |i: usize| i >= old && I::ORIGIN == Origin::Camera;
            for i in 0..paths.len() {
                if !world.meets_mask(&self.hits[i]) {
                    continue;
                }
                let u = self.settings.pattern.d1(&paths[i].name, Purpose::Opacity);
                let (probe, sample) = (&mut self.probe, paths[i].sample);
                world.go_past_masks(&rays[i], &mut self.hits[i], u, |ray| {
                    let mut hit = [Hit::MISS];
                    let rays = std::slice::from_ref(ray);
                    let asked = Asked { primary: primary(i), sample: &|_| sample, rays };
                    probe.closest(world, &asked, &mut hit);
                    hit[0]
                });
            }
        }
        self.stopwatch.times.rays += rays.len() as u64;
        self.stopwatch.lap(Phase::Search);

        if I::ORIGIN == Origin::Camera && !self.samples.seen.is_empty() {
            let follows = self.settings.guides == Guides::Specular;
            for i in old..paths.len() {
                let (ray, hit) = (&rays[i], &self.hits[i]);
                if follows {
                    let (pattern, sample) = (self.settings.pattern, paths[i].sample);
                    let seen = guides::Seen { world, pattern, name: paths[i].name, ray: *ray, hit: *hit };
                    let probe = &mut self.probe;
                    let first = seen.follow(|ray| {
                        let mut hit = [Hit::MISS];
                        let rays = std::slice::from_ref(ray);
                        let asked = Asked { primary: false, sample: &|_| sample, rays };
                        probe.closest(world, &asked, &mut hit);
                        hit[0]
                    });
                    let distance = if hit.is_hit() { first.distance } else { 0.0 };
                    self.samples.seen[paths[i].sample as usize] = see(&FirstHit { distance, ..first });
                } else if hit.is_hit() {
                    let surface = world.surface(ray, hit, &PackedFootprint::NONE);
                    let first =
                        FirstHit { albedo: world.albedo(&surface), normal: surface.point.n, distance: hit.t };
                    self.samples.seen[paths[i].sample as usize] = see(&first);
                }
            }
        }
        self.sorting.sort(world, &self.hits);
        for (kind, order) in self.sorting.queues() {
            let (size, pattern, simd) = (self.settings.size, self.settings.pattern, self.simd);
            let queue = Queue { kind, size, pattern, simd, order, paths, rays, hits: &self.hits };
            let mut out = Out {
                sums: &mut self.samples.sums,
                next: &mut self.next,
                rays: &mut self.next_rays,
                shadow_rays: &mut self.shadow_rays,
                shadows: &mut self.shadows,
                splats: &mut self.splats,
                scratch: &mut self.scratch,
                stopwatch: &mut self.stopwatch,
            };
            self.integrator.step(world, &queue, &mut out);
        }
        self.next.iter().for_each(|path| self.samples.depart(path.sample));
        paths.iter().for_each(|path| self.samples.arrive(path.sample));
        put_on(&mut self.paths, base, &mut self.next);
        put_on(&mut self.rays, base, &mut self.next_rays);
        self.stopwatch.lap(Phase::Shading);
        self.answer();
    }

    /// Light of the shadow rays that nothing is in the way of.
    fn answer(&mut self) {
        let asked = AskedShadows { shadows: &self.shadows, rays: &self.shadow_rays };
        let answer = Answer { blocked: &mut self.blocked, light: &mut self.transmittance };
        self.probe.transmittance(self.world, &asked, answer);
        if !self.transmittance.is_empty() {
            self.dim_shadows();
        }
        self.simd.run(Arrive {
            shadows: &self.shadows,
            blocked: &self.blocked,
            sums: &mut self.samples.sums,
            splats: &mut self.splats,
        });
        self.stopwatch.times.shadow_rays += self.shadow_rays.len() as u64;
        self.shadow_rays.clear();
        self.shadows.clear();
        self.stopwatch.lap(Phase::Search);
    }

    /// Multiplies what shadow rays bring by the share that passes.
    #[cold]
    fn dim_shadows(&mut self) {
        let all = self.shadows.iter_mut().zip(&self.transmittance).zip(&mut self.blocked);
        for ((shadow, &t), blocked) in all {
            shadow.light *= t;
            *blocked = t == Light::ZERO;
        }
    }

    /// Brings light to the pixels whose filter reaches where it came down on the film.
    fn splat(&mut self, pass: &Pass<'_, '_>) {
        let (filter, size) = (&self.world.filter, self.settings.size);
        let across = size[0].div_ceil(TILE);
        let tells_groups = self.settings.light_groups_of::<I>() > 0;
        for splat in self.splats.drain(..) {
            let sample = splat.sample as usize;
            let (Target::Film(at), Some(pending)) = (splat.target, &self.samples.pending[sample]) else {
                continue;
            };
            let rgb = self.world.sensor.take(pending.lanes, splat.light);
            let band = tells_groups.then(|| self.world.sensor.first_band_of_group(splat.from.group));
            let reach = |axis: usize| {
                let first = (at[axis] - 0.5 - filter.radius()).ceil();
                let end = (at[axis] - 0.5 + filter.radius()).floor() + 1.0;
                // What is below 0, or no number, becomes 0.
                first as u32..(end as u32).min(size[axis])
            };
            for y in reach(1) {
                for x in reach(0) {
                    let height =
                        filter.height(at[0] - (x as f32 + 0.5)) * filter.height(at[1] - (y as f32 + 0.5));
                    let mut tile = pass.tile(y / TILE * across + x / TILE);
                    if height != 0.0 && !tile.add_light_splat([x, y], rgb.map(|v| v * height), band) {
                        self.samples.sums.spoil(sample);
                    }
                }
            }
        }
    }

    /// Gives the film the samples that are finished.
    fn finish(&mut self, pass: &Pass<'_, '_>) {
        let Self { world, simd, samples, finishing: scratch, .. } = self;
        simd.run(Finish { world, probe: &*self.probe, samples, pass, scratch });
        self.stopwatch.lap(Phase::Film);
    }
}

/// Light of shadow rays comes to its sample or to the film. Four lanes of it side by side: it is a kernel for the sake of wide registers.
struct Arrive<'a> {
    shadows: &'a [Contribution],
    blocked: &'a [bool],
    sums: &'a mut SampleSums,
    splats: &'a mut Vec<Contribution>,
}

impl Kernel for Arrive<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        for (shadow, _) in self.shadows.iter().zip(self.blocked).filter(|(_, blocked)| !**blocked) {
            match shadow.target {
                Target::Sample | Target::Shared(_) => self.sums.add(shadow.sample, shadow.from, shadow.light),
                Target::Film(_) => self.splats.push(*shadow),
            }
        }
    }
}
