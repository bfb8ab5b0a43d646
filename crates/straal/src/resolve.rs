//! What was asked for and what the scene says, put together: the settings of a job, and why there are none.
//!
//! All that can be known to be wrong before a world is made is found here.

use crate::denoise::{Denoising, Effort, NoDenoise};
use crate::search;
use straal_accel::{Build, BuildError, BvhParams, Isa, Structure};
use straal_color::Space;
use straal_formats::load::Loaded;
use straal_math::lowdisc::{Pattern, PatternKind};
use straal_render::compile::Custom;
use straal_render::driver::RenderError;
use straal_render::film::Region;
use straal_render::film::{Extent, Film, MAX_SAMPLES, Recording};
use straal_render::integrator::AnyIntegrator;
use straal_render::settings::{Guides, Settings};
use straal_scene::memory::Shortage;
use straal_scene::{Diagnostic, Span, desc};

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
    /// How light is computed.
    pub integrator: Option<desc::Integrator>,
    /// Largest number of edges of a path.
    pub max_depth: Option<u32>,
    /// The most that light counts that came by way of more than one surface.
    pub clamp: Option<f64>,
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
    /// Denoises the picture, or not.
    pub denoise: Option<desc::Denoise>,
    /// What the layers of albedo and normals are of; by way of mirrors and glass for a picture that is denoised, when absent.
    pub guides: Option<Guides>,
    /// Before that, takes away light of single pixels that are brighter than so many times what is around them.
    pub fireflies: Option<f32>,
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
    /// The scene can't be rendered so.
    #[error("{}", .0.message)]
    Scene(Box<Diagnostic>),
    /// Rays can't be searched so.
    #[error(transparent)]
    Search(#[from] BuildError),
    /// The picture can't be denoised.
    #[error("the picture can't be denoised: {0}")]
    Denoise(#[from] NoDenoise),
    /// The render couldn't start.
    #[error(transparent)]
    Render(#[from] RenderError),
}

impl Error {
    /// What is wrong with a scene, and where.
    pub(crate) fn scene(span: Span, message: String) -> Self {
        Self::Scene(Box::new(Diagnostic::error(span, message)))
    }
}

/// Whether all materials are there that a program's own shapes name.
pub(crate) fn check_custom(custom: &Custom, scene: &desc::Scene) -> Result<(), Error> {
    match custom.unknown_material(scene) {
        Some(name) => Err(Error::Request(format!("there is no material `{name}`"))),
        None => Ok(()),
    }
}

/// Largest picture or crop in pixels: its film takes 15 GB if it tells its error by batches.
pub(crate) const MAX_PIXELS: usize = 1 << 26;

/// Samples a pixel in each pass. It only decides how often a render can be stopped: samples have names, and the
/// film's sums don't depend on their order.
pub(crate) const PASS: u32 = 4;

/// The passes in which so many samples are usually taken: a short first one gives a picture, and a forecast, at once. What
/// pictures tell, so that those of a render that was taken up again, or of parts, tell the same.
pub(crate) const fn passes(samples: u32) -> u32 {
    if samples == 0 { 0 } else { 1 + (samples - 1).div_ceil(PASS) }
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
    pub isa: Isa,
    pub integrator: AnyIntegrator,
    /// How the picture is denoised.
    pub denoise: Option<Denoising>,
    /// The noise of the denoised picture that ends the render.
    pub denoised_noise: Option<f64>,
    /// The work space.
    pub space: Space,
    /// In pixels.
    pub filter_radius: f64,
    /// Bytes of memory that may be used; no limit when absent.
    pub memory: Option<u64>,
}

impl Plan {
    /// What a scene and a caller's wishes come to.
    pub fn new(loaded: &Loaded, wish: &Overrides) -> Result<Self, Error> {
        let scene = &loaded.scene;
        let size = wish.size.unwrap_or(scene.film.size);
        let crop = crop(size, wish.crop, if wish.size.is_none() { scene.film.crop } else { None })?;
        let spectral = wish.spectral.unwrap_or(scene.spectral);
        let recording = wish.recording.map_or_else(|| recorded(&scene.film.channels), Ok)?;
        check_recording(recording, spectral, scene)?;
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
        let isa = wish.isa.unwrap_or_else(Isa::detect);
        let denoise = denoising(wish, &scene.film, isa);
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
        let mut integrator =
            integrator(wish.integrator.as_ref().unwrap_or(&scene.integrator), wish.max_depth);
        if let Some(most) = wish.clamp {
            clamp(&mut integrator, most)?;
        }
        // Pixels have next to no samples of their own.
        let by_light = integrator.splats();
        if by_light {
            check_light_splats(noise.is_some(), splat, denoise.is_some(), recording)?;
        }
        // They are layers of the picture.
        let tells_groups =
            (wish.layers.unwrap_or(true) || denoise.is_some()) && integrator.tells_light_groups();
        let named = if tells_groups { scene.light_groups().len() } else { 0 };
        let settings = Settings {
            size,
            crop,
            pattern: Pattern::new(kind, spp),
            seed: wish.seed.unwrap_or(scene.sampler.seed),
            // Of what is denoised, the denoised picture tells which blocks are good enough.
            noise: noise.filter(|_| denoise.is_none()),
            error: wish.error.unwrap_or(true) && !by_light || denoise.is_some(),
            halves: denoise.is_some(),
            guides: wish.guides.unwrap_or(if denoise.is_some() { Guides::Specular } else { Guides::First }),
            layers: wish.layers.unwrap_or(true) && !by_light || denoise.is_some(),
            signed: !splat && scene.film.filter.is_signed(),
            splat,
            threads: wish.threads.unwrap_or(0),
            batch: wish.batch.unwrap_or(1024),
            shuffle_tiles: wish.shuffle_tiles,
            light_groups: if named > 0 { named + 1 } else { 0 },
            cost: wish.cost.unwrap_or(scene.accel.cost),
            blocks: noise.is_some() && denoise.is_some(),
        };
        if let Some(reason) = scene.camera.misfit(scene.film.size, size) {
            return Err(Error::scene(Span::NONE, reason));
        }
        let filter_radius = scene.film.filter.radius();
        let plan = Self {
            settings,
            first,
            end,
            whole,
            spectral,
            recording,
            structure,
            isa,
            integrator,
            denoised_noise: noise.filter(|_| denoise.is_some()),
            denoise,
            space: scene.color.space.space(),
            filter_radius,
            memory: wish.memory,
        };
        check_size(&plan)?;
        Ok(plan)
    }

    /// What the film holds.
    pub fn extent(&self) -> Extent {
        let light_splats = self.integrator.splats();
        let light_groups = self.settings.light_groups + usize::from(self.integrator.limit().is_finite());
        Extent { light_splats, light_groups, ..self.settings.extent(self.recording, self.filter_radius) }
    }

    /// The part of the picture that is rendered.
    pub fn rendered(&self) -> Region {
        match self.integrator.splats() {
            true => Region::whole(self.settings.size),
            false => self.settings.rendered(self.filter_radius),
        }
    }
}

/// How the picture is denoised, if it is.
fn denoising(wish: &Overrides, film: &desc::Film, isa: Isa) -> Option<Denoising> {
    let effort = match wish.denoise.as_ref().unwrap_or(&film.denoise) {
        desc::Denoise::Off => return None,
        desc::Denoise::Best => Effort::Best,
        desc::Denoise::Fast => Effort::Fast,
    };
    let (fireflies, threads) = (wish.fireflies, wish.threads);
    Some(Denoising { effort, fireflies, threads, isa: Some(isa), ..Denoising::default() })
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

/// How light is gathered.
fn integrator(said: &desc::Integrator, max_depth: Option<u32>) -> AnyIntegrator {
    let mut integrator = AnyIntegrator::of(said);
    if let Some(edges) = max_depth {
        integrator.limit_depth(edges);
    }
    integrator
}

/// Lets light count so much at most, of an integrator that can.
fn clamp(integrator: &mut AnyIntegrator, most: f64) -> Result<(), Error> {
    let AnyIntegrator::Path(path) = integrator else {
        let name = integrator.name();
        return Err(Error::Request(format!(
            "`{name}` has no `clamp`: its light comes by way of one surface, or isn't told apart by that; `path` has one"
        )));
    };
    path.clamp = Some(most as f32);
    Ok(())
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
fn check_size(plan: &Plan) -> Result<(), Error> {
    let (settings, extent) = (&plan.settings, &plan.extent());
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

/// What doesn't go together with light that is brought to the whole picture by paths that are no pixel's own.
fn check_light_splats(noise: bool, splat: bool, denoise: bool, recording: Recording) -> Result<(), Error> {
    let cannot = if noise {
        "end where the noise of a pixel is low, since the light in it comes from paths that are no samples of it: --replicates 8 measures it"
    } else if splat {
        "splat its own samples by the filter as well: the light that it brings counts in every pixel that the filter reaches anyway"
    } else if denoise {
        "guide the denoiser: no ray comes from the camera, so that there are no layers of albedo and normals"
    } else if recording.bands().is_some() {
        "bring its light in bands of wavelengths, only as red, green and blue or X, Y and Z"
    } else {
        return Ok(());
    };
    Err(Error::Request(format!("an integrator that brings light to the whole picture can't {cannot}")))
}

/// Whether a film of such numbers can take the light of a scene.
fn check_recording(recording: Recording, spectral: bool, scene: &desc::Scene) -> Result<(), Error> {
    if recording.bands().is_some() && !spectral {
        return Err(Error::Request(
            "a film of wavelengths needs light that is computed by wavelengths: say `spectral: true` in the scene, or \
             --spectral"
                .into(),
        ));
    }
    if recording != Recording::Rgb && scene.camera.is_anaglyph() {
        return Err(Error::Request(format!(
            "an anaglyph gives each eye colours of its own in red, green and blue, which a film of the kind `{}` \
             doesn't have",
            recording.name()
        )));
    }
    Ok(())
}

/// Why a pattern is of no use before the number of samples is known, if so.
pub(crate) fn needs_count(kind: PatternKind) -> Option<String> {
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
