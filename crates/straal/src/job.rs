//! A scene with all that was asked for it: compiled, ready to render.

use crate::forecast::Forecast;
use crate::look::{Bits, Gamma, Look};
use crate::picture::Picture;
use crate::search;
use crate::sums::{Kept, Snapshot};
use straal_accel::{Build, BvhParams, Isa, Structure};
use straal_color::{Dither, RgbSpace, Space};
use straal_formats::load::Loaded;
use straal_math::lowdisc::{Pattern, PatternKind};
use straal_render::compile::{self, CompileError, Custom, Detail, Request};
use straal_render::driver::{Pause, Render, RenderError};
use straal_render::film::{Extent, Film, MAX_SAMPLES, Recording, hash_of};
use straal_render::integrator::{Integrator, PathTracer, SineProduct};
use straal_render::settings::{Region, Settings};
use straal_render::stopwatch::{Clock, Times};
use straal_render::world::World;
use straal_scene::desc;
use straal_scene::memory::Shortage;
use straal_scene::value::Depth;

/// What a caller wants otherwise than the scene says; `None` leaves it to the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Samples per pixel.
    pub spp: Option<u32>,
    /// Those of them that are taken: the index of the first, and one past that of the last.
    pub samples: Option<[u32; 2]>,
    /// Width and height of the whole picture.
    pub size: Option<[u32; 2]>,
    /// The part to render: x0, y0, x1, y1 in pixels, ends exclusive.
    pub crop: Option<[u32; 4]>,
    /// Seed of all random numbers.
    pub seed: Option<u64>,
    /// Relative standard error at which a block of pixels needs no further samples.
    pub noise: Option<f64>,
    /// Which pattern they follow.
    pub pattern: Option<PatternKind>,
    /// Largest number of edges of a path.
    pub max_depth: Option<u32>,
    /// Worker threads; all cores when absent.
    pub threads: Option<usize>,
    /// Search structure.
    pub accel: Option<Structure>,
    /// How much work goes into the structure, where that is `bvh`.
    pub build: Option<Build>,
    /// Instruction set of the search kernels; the best there is when absent.
    pub isa: Option<Isa>,
    /// Paths that travel together.
    pub batch: Option<usize>,
    /// Shuffles the order of tiles by this seed.
    pub shuffle_tiles: Option<u64>,
    /// Counts what the searches of each pixel cost.
    pub cost: Option<bool>,
    /// Tells each pixel's standard error, as an EXR shows it; yes, when absent.
    pub error: Option<bool>,
    /// Keeps all layers of an EXR; yes, when absent. Without them the picture has its colours alone, and its film takes a third.
    pub layers: Option<bool>,
    /// Lets a sample count in all pixels whose filter reaches it.
    pub splat: Option<bool>,
    /// Computes light by wavelengths instead of red, green and blue.
    pub spectral: Option<bool>,
    /// In which numbers the film takes light.
    pub recording: Option<Recording>,
    /// Bytes of memory that may be used: a job that takes more is refused before it takes them. No limit when absent.
    pub memory: Option<u64>,
}

/// Why a job can't be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// What was asked for makes no sense for this scene.
    #[error("{0}")]
    Request(String),
    /// It takes more memory than may be used.
    #[error(transparent)]
    Memory(#[from] Shortage),
    /// The description has no world.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// The render couldn't start.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A compiled scene and its settings.
pub struct Job {
    /// The scene ready for rays.
    pub world: World,
    /// How it is sampled.
    pub settings: Settings,
    /// One past the index of the last sample of a pixel: how many there are, where the first is 0.
    pub spp: u32,
    /// Index of the first sample of a pixel.
    pub first: u32,
    /// How many samples a pixel gets in all, where that was said or has to be known.
    pub whole: Option<u32>,
    /// How light is gathered.
    pub integrator: PathTracer,
    /// The test function that is shown in place of light, if any.
    pub chart: Option<SineProduct>,
    /// A fingerprint of the scene's texts and files.
    pub scene_hash: String,
    /// What it takes of memory.
    pub forecast: Forecast,
    memory: Option<u64>,
    look: Look,
    space: Space,
    structure: Structure,
}

/// What a caller lends to a render: a say in when it ends, and a clock.
pub struct Control<'a> {
    /// Called between passes; a pass adds the same number of samples to every pixel.
    pub progress: Option<&'a mut dyn FnMut(&Progress) -> Verdict>,
    /// To tell where the time goes; without it [`Outcome::times`] has ray counts only.
    pub clock: Option<Clock>,
    /// Whether to go on for as long as `progress` says, past the samples that the scene asks for.
    pub open_ended: bool,
    /// Sums of the same render up to some sample, to go on from; not in replicates.
    pub resume: Option<Kept>,
    /// Called between passes and at the end with what there is; not in replicates.
    pub keep: Option<&'a mut dyn FnMut(&Snapshot<'_>)>,
    /// Asked by all threads, time and again, whether `keep` should be shown what there is in the middle of a pass.
    pub pause: Option<Pause>,
    keep_on: bool,
}

impl<'a> Control<'a> {
    /// Renders all samples, says nothing.
    pub fn to_the_end() -> Self {
        Self {
            progress: None,
            clock: None,
            open_ended: false,
            resume: None,
            keep: None,
            pause: None,
            keep_on: true,
        }
    }

    /// Renders until all samples are taken or `progress` ends it.
    pub fn new(progress: &'a mut dyn FnMut(&Progress) -> Verdict) -> Self {
        Self { progress: Some(progress), ..Self::to_the_end() }
    }
}

/// Whether a render goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// With the next pass.
    GoOn,
    /// The picture so far is the result.
    Stop,
}

/// How far a render has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Samples per pixel taken, all replicates together.
    pub samples: u64,
    /// Samples per pixel to take in all.
    pub of: u64,
    /// Samples per pixel that the next pass will add; 0 after the last of a picture or replicate.
    pub next: u64,
    /// Pixels of the crop.
    pub pixels: u64,
    /// Rays traced so far, and time where a clock was lent.
    pub times: Times,
    /// How many blocks still need samples, where noise decides that; of the replicate under way.
    pub blocks: Option<Blocks>,
}

/// Blocks of 8 x 8 pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    /// Those that need further samples.
    pub left: u64,
    /// All of them.
    pub of: u64,
}

/// What a render leaves.
#[derive(Debug)]
pub struct Outcome {
    /// The picture with its layers and story.
    pub picture: Picture,
    /// Samples per pixel taken; of an adaptive render, of the pixels that have the most.
    pub samples: u32,
    /// Samples of a pixel on average.
    pub mean_samples: f64,
    /// Passes they were taken in.
    pub passes: u32,
    /// Whether all samples asked for were taken.
    pub complete: bool,
    /// Blocks of 8 x 8 pixels that are noisier than was asked, of an adaptive render; in replicates, of all of them together.
    pub noisy_blocks: u64,
    /// Rays, and time by phase where a clock was lent.
    pub times: Times,
    /// Worker threads.
    pub threads: usize,
    /// Samples that were not numbers or beyond the film's range, and where the first was: pixel, sample index.
    pub dropped: straal_render::film::Dropped,
}

/// Largest picture or crop in pixels: its film takes 15 GB if it tells its error by batches.
pub(crate) const MAX_PIXELS: usize = 1 << 26;

/// Samples a pixel in each pass. It only decides how often a render can be stopped: samples have names, and the
/// film's sums don't depend on their order.
const PASS: u32 = 4;

/// The passes in which so many samples are usually taken: a short first one gives a picture, and a forecast, at once. What
/// pictures tell, so that those of a render that was taken up again, or of parts, tell the same.
pub(crate) const fn passes(samples: u32) -> u32 {
    if samples == 0 { 0 } else { 1 + (samples - 1).div_ceil(PASS) }
}

impl Job {
    /// Compiles a loaded scene with what the caller wants otherwise.
    pub fn new(loaded: Loaded, wish: Overrides) -> Result<Self, Error> {
        Self::with_custom(loaded, wish, &Custom::default())
    }

    /// The same with a program's own shapes and materials.
    pub fn with_custom(loaded: Loaded, wish: Overrides, custom: &Custom) -> Result<Self, Error> {
        Self::of(&loaded, &wish, custom)
    }

    /// Compiles a scene only to find what is wrong with it, and what follows from its camera: curved surfaces are coarse and rays
    /// searched by brute force, so that its picture isn't the scene's.
    pub fn draft(loaded: &Loaded, wish: Overrides) -> Result<Self, Error> {
        let wish = Overrides { accel: Some(Structure::Brute), build: None, ..wish };
        Self::made(loaded, &wish, &Custom::default(), Detail::Draft)
    }

    /// The same of a scene that is needed further.
    pub fn of(loaded: &Loaded, wish: &Overrides, custom: &Custom) -> Result<Self, Error> {
        Self::made(loaded, wish, custom, Detail::Whole)
    }

    fn made(loaded: &Loaded, wish: &Overrides, custom: &Custom, detail: Detail) -> Result<Self, Error> {
        let scene = &loaded.scene;
        let plan = Plan::new(loaded, wish)?;
        let forecast = Forecast::of(loaded, &plan);
        if let Some(shortage) = forecast.refuse(wish.memory) {
            return Err(shortage.into());
        }
        let Plan { settings, end, spectral, recording, structure, first, whole, .. } = plan;
        let size = settings.size;
        let by_default = desc::PathTracer::default();
        let (path, chart) = match &scene.integrator {
            desc::Integrator::Path(path) => (path, None),
            desc::Integrator::SineProduct => (&by_default, Some(SineProduct)),
        };
        let integrator = PathTracer {
            max_depth: wish.max_depth.unwrap_or(match path.max_depth {
                Depth::Unlimited => u32::MAX,
                Depth::Edges(n) => n,
            }),
            roulette_depth: path.roulette_depth,
        };
        let search = straal_accel::Options {
            structure,
            isa: wish.isa.unwrap_or_else(Isa::detect),
            ..straal_accel::Options::default()
        };
        let world = compile::compile(&Request {
            scene,
            assets: &loaded.assets,
            custom,
            size,
            search: &search,
            spectral,
            recording,
            detail,
        })?;
        if recording != Recording::Rgb && world.camera.needs().taken {
            return Err(Error::Request(format!(
                "an anaglyph gives each eye colours of its own in red, green and blue, which a film of the kind `{}` \
                 doesn't have",
                recording.name()
            )));
        }
        Ok(Self {
            world,
            settings,
            spp: end,
            first,
            whole,
            integrator,
            chart,
            scene_hash: scene_hash(loaded, custom),
            forecast,
            memory: wish.memory,
            look: look(&scene.film),
            space: scene.color.space.space(),
            structure,
        })
    }

    /// How the scene wants its picture developed.
    pub fn look(&self) -> Look {
        self.look
    }

    /// The work space.
    pub fn space(&self) -> Space {
        self.space
    }

    /// What the three numbers of the film's pixels are.
    pub fn film_space(&self) -> RgbSpace {
        match self.world.palette.recording() {
            Recording::Xyz => RgbSpace::XYZ,
            Recording::Rgb | Recording::Spectral(_) => self.space.rgb(),
        }
    }

    /// What follows from the camera's settings.
    pub fn camera(&self) -> crate::CameraFacts {
        self.world.camera.facts()
    }

    /// The search structure in use.
    pub fn structure(&self) -> Structure {
        self.structure
    }

    /// The instruction set of the search kernels in use.
    pub fn isa(&self) -> Isa {
        self.world.accel.isa()
    }

    /// Why this job can't be rendered without knowing how many samples there will be, if so.
    pub fn needs_count(&self) -> Option<String> {
        needs_count(self.settings.pattern.kind())
    }

    /// Renders the picture.
    pub fn render(&self, control: &mut Control<'_>) -> Result<Outcome, Error> {
        if let Some(reason) = self.needs_count().filter(|_| control.open_ended) {
            return Err(Error::Request(reason));
        }
        let of = if control.open_ended { MAX_SAMPLES } else { self.spp };
        let mut progress = Progress { of: u64::from(of - self.first), ..self.progress() };
        let run = self.film(self.settings.seed, of, control, &mut progress)?;
        let mut picture = Picture::new(&run.film, run.film.layers(), self.film_space());
        picture.story = self.story(run.samples);
        picture.story.push(("straal.passes".into(), run.passes.to_string()));
        picture.story.push(("straal.film_hash".into(), hash_of(&picture.layers.rgb)));
        Ok(Outcome {
            picture,
            samples: run.samples,
            mean_samples: run.film.mean_samples(),
            passes: run.passes,
            complete: control.open_ended || run.complete,
            noisy_blocks: self.noisy_blocks(&run.film),
            times: run.times,
            threads: run.threads,
            dropped: run.film.dropped(),
        })
    }

    /// What all pictures of this job tell about themselves, with so many samples.
    pub(crate) fn story(&self, samples: u32) -> Vec<(String, String)> {
        let mut story = self.facts();
        story.push(("straal.samples".into(), samples.to_string()));
        story
    }

    /// The same but for what comes of it.
    pub(crate) fn facts(&self) -> Vec<(String, String)> {
        let s = &self.settings;
        let depth = match self.integrator.max_depth {
            u32::MAX => "unlimited".to_string(),
            n => n.to_string(),
        };
        let noise = s.noise.map(|noise| ("noise", noise.to_string()));
        let counted = s.cost.then(|| ("cost", self.structure.to_string()));
        let recording = self.world.palette.recording();
        let channels = (recording != Recording::Rgb).then(|| ("channels", recording.name().to_string()));
        let magnified = self.world.camera.focal_pixels().map(|f| ("focal_pixels", f.to_string()));
        [
            ("version", crate::VERSION.to_string()),
            ("scene_hash", self.scene_hash.clone()),
            ("seed", s.seed.to_string()),
            ("sampler", s.pattern.kind().to_string()),
            ("space", self.space.name().to_string()),
            ("light", if self.world.palette.is_spectral() { "wavelengths" } else { "rgb" }.to_string()),
            ("integrator", if self.chart.is_some() { "sine_product" } else { "path" }.to_string()),
            ("max_depth", depth),
            ("roulette_depth", self.integrator.roulette_depth.to_string()),
            ("size", format!("{}x{}", s.size[0], s.size[1])),
            ("crop", format!("{},{},{},{}", s.crop.min[0], s.crop.min[1], s.crop.max[0], s.crop.max[1])),
        ]
        .into_iter()
        .chain(noise)
        .chain(counted)
        .chain(magnified)
        .chain(channels)
        .chain(s.splat.then(|| ("splat", "true".to_string())))
        .chain((self.first > 0).then(|| ("first_sample", self.first.to_string())))
        .map(|(k, v)| (format!("straal.{k}"), v))
        .collect()
    }

    /// Blocks of a film that are noisier than was asked.
    pub(crate) fn noisy_blocks(&self, film: &Film) -> u64 {
        if self.settings.noise.is_some() { film.open_blocks() } else { 0 }
    }

    /// Refuses to sum up replicates where that takes more memory than may be used.
    pub(crate) fn check_replicates(&self) -> Result<(), Error> {
        let shortage = self.forecast.with_replicates(&self.settings).refuse(self.memory);
        shortage.map_or(Ok(()), |shortage| Err(shortage.into()))
    }

    pub(crate) fn progress(&self) -> Progress {
        Progress { pixels: self.settings.crop.area() as u64, ..Progress::default() }
    }

    /// One film of `spp` samples with a seed of its own.
    pub(crate) fn film(
        &self,
        seed: u64,
        spp: u32,
        control: &mut Control<'_>,
        progress: &mut Progress,
    ) -> Result<Run, Error> {
        let settings = Settings { seed, ..self.settings.clone() };
        match self.chart {
            None => self.film_by(self.integrator, settings, (spp, control), progress),
            Some(chart) => self.film_by(chart, settings, (spp, control), progress),
        }
    }

    fn film_by<I: Integrator>(
        &self,
        integrator: I,
        settings: Settings,
        (end, control): (u32, &mut Control<'_>),
        progress: &mut Progress,
    ) -> Result<Run, Error> {
        let mut render = Render::new(&self.world, integrator, settings, control.clock.clone())?;
        render.begin_at(self.first);
        if let Some(kept) = control.resume.take() {
            self.take_up(&mut render, kept, end)?;
        }
        let (before, times) = (progress.samples, progress.times);
        let adapts = self.settings.noise.is_some();
        let all_blocks = self.noisy_blocks(render.film());
        if let (Some(pause), true) = (&control.pause, control.keep.is_some()) {
            render.pause_when(pause.clone());
        }
        let next_pass = |render: &Render<'_, I>, most: u32| {
            if render.is_settled() { 0 } else { most.min(end - render.samples_done()) }
        };
        let mut next = next_pass(&render, if render.samples_done() == self.first { 1 } else { PASS });
        while next > 0 && control.keep_on {
            render.advance(next);
            while render.is_midway() {
                self.show(&render, control, [false, false]);
                render.advance(0);
            }
            next = next_pass(&render, PASS);
            progress.samples = before + u64::from(render.samples_done() - self.first);
            progress.next = u64::from(next);
            progress.times = times;
            progress.times += render.times();
            progress.blocks =
                adapts.then(|| Blocks { left: self.noisy_blocks(render.film()), of: all_blocks });
            control.keep_on = control.progress.as_mut().is_none_or(|say| say(progress) == Verdict::GoOn);
            if next > 0 && control.keep_on {
                self.show(&render, control, [false, false]);
            }
        }
        // Time is the end of what has no other; of what noise should end, it is too early.
        let ends_by_time = control.open_ended && !adapts;
        self.show(&render, control, [true, next == 0 || ends_by_time]);
        let samples = render.samples_done() - self.first;
        Ok(Run {
            samples,
            complete: next == 0,
            passes: passes(samples),
            times: render.times(),
            threads: render.threads(),
            film: render.into_film(),
        })
    }
}

/// What a job will be, before anything of it is made.
pub(crate) struct Plan {
    pub settings: Settings,
    /// Index of the first sample, and one past that of the last.
    pub first: u32,
    pub end: u32,
    /// How many there are in all, where that was said or has to be known.
    pub whole: Option<u32>,
    pub spectral: bool,
    pub recording: Recording,
    pub structure: Structure,
    /// In pixels.
    pub filter_radius: f64,
}

impl Plan {
    /// What a scene and a caller's wishes come to.
    pub fn new(loaded: &Loaded, wish: &Overrides) -> Result<Self, Error> {
        let scene = &loaded.scene;
        let size = wish.size.unwrap_or(scene.film.size);
        let crop = crop(size, wish.crop, if wish.size.is_none() { scene.film.crop } else { None })?;
        let spectral = wish.spectral.unwrap_or(scene.spectral);
        let recording = wish.recording.map_or_else(|| recorded(&scene.film.channels), Ok)?;
        check_recording(recording, spectral)?;
        let splat = wish.splat.unwrap_or(scene.film.splat);
        let structure = wish.accel.unwrap_or_else(|| search::structure_of(&scene.accel.structure));
        let structure = built(structure, wish.build)?;
        let spp = wish.spp.unwrap_or(scene.sampler.spp);
        if spp == 0 || spp > MAX_SAMPLES {
            return Err(Error::Request(format!(
                "{spp} samples per pixel: it must be from 1 to {MAX_SAMPLES}"
            )));
        }
        let kind = wish.pattern.unwrap_or(pattern_of(&scene.sampler.kind));
        let noise = wish.noise.or(scene.sampler.noise);
        let whole = wish.spp.or(kind.needs_count().then_some(spp));
        let (first, end) = run_of_samples(wish.samples, whole, kind, noise)?.unwrap_or((0, spp));
        if let Some(reason) = needs_count(kind).filter(|_| noise.is_some()) {
            return Err(Error::Request(reason + "; the noise that is asked for decides that pixel by pixel"));
        }
        if splat && noise.is_some() {
            return Err(Error::Request(
                "samples that count in several pixels (`splat`) can't be taken by the noise of each: pixels with many samples \
                 would weigh more in their neighbours"
                    .into(),
            ));
        }
        let settings = Settings {
            size,
            crop,
            pattern: Pattern::new(kind, spp),
            seed: wish.seed.unwrap_or(scene.sampler.seed),
            noise,
            error: wish.error.unwrap_or(true),
            layers: wish.layers.unwrap_or(true),
            signed: !splat && scene.film.filter.is_signed(),
            splat,
            threads: wish.threads.unwrap_or(0),
            batch: wish.batch.unwrap_or(1024),
            shuffle_tiles: wish.shuffle_tiles,
            cost: wish.cost.unwrap_or(scene.accel.cost),
        };
        let filter_radius = scene.film.filter.radius();
        check_size(&settings, &settings.extent(recording, filter_radius))?;
        Ok(Self { settings, first, end, whole, spectral, recording, structure, filter_radius })
    }
}

impl Job {
    /// Shows what there is to who keeps it.
    fn show<I: Integrator>(
        &self,
        render: &Render<'_, I>,
        control: &mut Control<'_>,
        [is_last, is_complete]: [bool; 2],
    ) {
        if let Some(keep) = &mut control.keep {
            let (end, is_midway) = (render.samples_done(), render.is_midway());
            keep(&Snapshot { job: self, film: render.film(), end, is_midway, is_last, is_complete });
        }
    }

    /// Goes on from sums that were kept.
    fn take_up<I: Integrator>(
        &self,
        render: &mut Render<'_, I>,
        mut kept: Kept,
        end: u32,
    ) -> Result<(), Error> {
        if let Some(refusal) = self.refuses(&kept, render.film(), end) {
            return Err(refusal);
        }
        let taken_up = kept.sums(|stamp, input| render.take_up(stamp.span.end, stamp.dropped, input));
        taken_up.map_err(|e| Error::Request(e.to_string()))
    }
}

/// The samples that are asked for, if not all of them.
fn run_of_samples(
    wish: Option<[u32; 2]>,
    whole: Option<u32>,
    kind: PatternKind,
    noise: Option<f64>,
) -> Result<Option<(u32, u32)>, Error> {
    let Some([first, end]) = wish else { return Ok(None) };
    let refused = |reason: String| {
        Err(Error::Request(format!("samples {first}..{end} can't be taken alone: {reason}")))
    };
    if first >= end || end > MAX_SAMPLES {
        return refused(format!(
            "write the first and one past the last, of at most {MAX_SAMPLES}, such as 64..128"
        ));
    }
    if noise.is_some() {
        return refused(
            "which samples a block needs is decided by those before (`noise`); parts of such a picture are crops".into(),
        );
    }
    match whole {
        Some(whole) if end > whole && kind.needs_count() => refused(format!(
            "the sampler {kind} must know how many there are in all, and that is {whole}: say --spp N for all parts"
        )),
        Some(whole) if end > whole => refused(format!("there are {whole} of them")),
        _ => Ok(Some((first, end))),
    }
}

/// How a film wants its picture developed.
pub(crate) fn look(film: &desc::Film) -> Look {
    Look {
        exposure: film.exposure,
        tone: film.tone.curve(),
        gamut: film.gamut.way(),
        gamma: match film.gamma {
            desc::Gamma::Srgb => Gamma::Srgb,
            desc::Gamma::Power(gamma) => Gamma::Power(gamma as f32),
        },
        bits: Bits::of(film.bits).unwrap_or_default(),
        dither: if film.dither { Dither::On } else { Dither::Off },
    }
}

/// In which numbers a scene wants its film to take light.
fn recorded(channels: &desc::Channels) -> Result<Recording, Error> {
    Ok(match channels {
        desc::Channels::Rgb => Recording::Rgb,
        desc::Channels::Xyz => Recording::Xyz,
        desc::Channels::Spectral(s) => {
            let none = || Error::Request("the film's bands of wavelengths make no sense".into());
            Recording::Spectral(s.bands().ok_or_else(none)?)
        }
    })
}

/// Whether the film of a picture or crop can be held.
fn check_size(settings: &Settings, extent: &Extent) -> Result<(), Error> {
    let pixels = settings.crop.area();
    let usual = Film::bytes_a_pixel(&Extent { batches: true, layers: true, ..Extent::default() }) as u64;
    let bytes = Film::bytes(extent, settings.crop, settings.size);
    let each = if pixels > 0 { bytes.div_ceil(pixels as u64).max(1) } else { usual };
    let most = MAX_PIXELS.min((MAX_PIXELS as u64 * usual / each) as usize);
    if settings.size.contains(&0) || pixels > most {
        return Err(Error::Request(format!(
            "{pixels} pixels can't be rendered at once: it must be from 1 to {most}; a larger picture can be rendered in crops"
        )));
    }
    Ok(())
}

fn check_recording(recording: Recording, spectral: bool) -> Result<(), Error> {
    if recording.bands().is_some() && !spectral {
        return Err(Error::Request(
            "a film of wavelengths needs light that is computed by wavelengths: say `spectral: true` in the scene, or \
             --spectral"
                .into(),
        ));
    }
    Ok(())
}

/// Why a pattern is of no use before the number of samples is known, if so.
fn needs_count(kind: PatternKind) -> Option<String> {
    kind.needs_count().then(|| {
        format!(
            "the sampler {kind} must know how many samples a pixel gets, since where one lies depends on it (sobol, \
             halton and random needn't)"
        )
    })
}

/// The pattern that a scene names.
fn pattern_of(kind: &desc::SamplerKind) -> PatternKind {
    match kind {
        desc::SamplerKind::Sobol => PatternKind::Sobol,
        desc::SamplerKind::BlueSobol => PatternKind::BlueSobol,
        desc::SamplerKind::Halton => PatternKind::Halton,
        desc::SamplerKind::Hammersley => PatternKind::Hammersley,
        desc::SamplerKind::MultiJittered => PatternKind::MultiJittered,
        desc::SamplerKind::NRooks => PatternKind::NRooks,
        desc::SamplerKind::Jittered => PatternKind::Jittered,
        desc::SamplerKind::Regular => PatternKind::Regular,
        desc::SamplerKind::Random => PatternKind::Random,
    }
}

/// The structure, built with as much work as is wanted.
fn built(structure: Structure, build: Option<Build>) -> Result<Structure, Error> {
    match (structure, build) {
        (_, None) => Ok(structure),
        (Structure::Bvh(params), Some(build)) => Ok(Structure::Bvh(BvhParams { build, ..params })),
        (other, Some(build)) => Err(Error::Request(format!(
            "a build of the kind '{}' is for the search structure bvh only, and rays are searched by {other}",
            build.name()
        ))),
    }
}

/// A film and how it came about.
pub(crate) struct Run {
    pub film: Film,
    pub samples: u32,
    /// Whether there was nothing more to do.
    pub complete: bool,
    pub passes: u32,
    pub times: Times,
    pub threads: usize,
}

/// The scene's hash in hexadecimal, 16 bytes of it; where a program brought shapes or materials, with the fingerprints
/// of these behind it.
fn scene_hash(loaded: &Loaded, custom: &Custom) -> String {
    let scene: String = loaded.hash[..16].iter().map(|b| format!("{b:02x}")).collect();
    let shapes = custom.shapes.iter().map(|(s, _)| s.fingerprint());
    let all: Vec<u64> = shapes.chain(custom.materials.iter().map(|(_, m)| m.fingerprint())).collect();
    all.iter().fold(scene, |text, f| format!("{text}-{f:016x}"))
}

/// The crop that was asked for, or the scene's, or the whole; it must lie inside the picture and not be empty.
fn crop(size: [u32; 2], wish: Option<[u32; 4]>, scene: Option<[u32; 4]>) -> Result<Region, Error> {
    let Some([x0, y0, x1, y1]) = wish.or(scene) else { return Ok(Region::whole(size)) };
    if x0 >= x1 || y0 >= y1 || x1 > size[0] || y1 > size[1] {
        return Err(Error::Request(format!(
            "the crop {x0},{y0},{x1},{y1} is not a part of a picture of {} x {} pixels (left, top, right, bottom; \
             the last two exclusive)",
            size[0], size[1]
        )));
    }
    Ok(Region { min: [x0, y0], max: [x1, y1] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_for_the_tree_that_knows_it() {
        let best = Structure::Bvh(BvhParams { build: Build::Best, ..BvhParams::DEFAULT });
        assert_eq!(built(Structure::default(), Some(Build::Best)).ok(), Some(best));
        let error = built(Structure::Brute, Some(Build::Fast)).unwrap_err().to_string();
        assert!(
            error.ends_with("is for the search structure bvh only, and rays are searched by brute"),
            "{error}"
        );
        assert_eq!(built(Structure::Brute, None).ok(), Some(Structure::Brute));
    }
}
