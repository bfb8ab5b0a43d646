//! A scene with all that was asked for it: compiled, ready to render.

mod keep;
mod run;
mod seen;

pub use keep::Snapshot;
pub use run::{Blocks, Control, Outcome, Progress, Verdict};
pub(crate) use seen::{Seen, SeenLight};

use crate::denoise::Denoising;
use crate::development::Development;
use crate::forecast::Forecast;
use crate::resolve::{Error, Overrides, Plan, check_custom, needs_count};
use straal_accel::{Isa, Structure};
use straal_color::{RgbSpace, Space};
use straal_formats::load::Loaded;
use straal_render::compile::{self, Custom, Detail, Request};
use straal_render::film::Recording;
use straal_render::integrator::{AnyIntegrator, PathTracer};
use straal_render::settings::{Guides, Settings};
use straal_render::world::World;

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
    pub integrator: AnyIntegrator,
    /// A fingerprint of the scene's texts and files.
    pub scene_hash: String,
    /// How the picture is denoised when it is rendered, if it is.
    pub denoise: Option<Denoising>,
    /// Relative error of the denoised picture that ends the render, block by block of 8 x 8 pixels.
    pub denoised_noise: Option<f64>,
    /// What it takes of memory.
    pub forecast: Forecast,
    memory: Option<u64>,
    development: Development,
    space: Space,
    structure: Structure,
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

    /// The same after another job, such as the frame before, whose search structures are taken over where nothing has changed in them.
    pub fn after(before: Option<Self>, loaded: Loaded, wish: &Overrides) -> Result<Self, Error> {
        Self::made(before.map(|job| job.world), &loaded, wish, &Custom::default(), Detail::Whole)
    }

    /// How many objects have the search structure that they had in the job before.
    pub fn taken_over(&self) -> usize {
        self.world.accel.taken_over()
    }

    /// How many have the tree that they had, with boxes where their triangles are.
    pub fn refitted(&self) -> usize {
        self.world.accel.refitted()
    }

    /// Compiles a scene only to find what is wrong with it, and what follows from its camera: curved surfaces are coarse and rays
    /// searched by brute force, so that its picture isn't the scene's.
    pub fn draft(loaded: &Loaded, wish: Overrides) -> Result<Self, Error> {
        let wish = Overrides { accel: Some(Structure::Brute), build: None, ..wish };
        Self::made(None, loaded, &wish, &Custom::default(), Detail::Draft)
    }

    /// The same of a scene that is needed further.
    pub fn of(loaded: &Loaded, wish: &Overrides, custom: &Custom) -> Result<Self, Error> {
        Self::made(None, loaded, wish, custom, Detail::Whole)
    }

    fn made(
        before: Option<World>,
        loaded: &Loaded,
        wish: &Overrides,
        custom: &Custom,
        detail: Detail,
    ) -> Result<Self, Error> {
        let scene = &loaded.scene;
        let plan = Plan::new(loaded, wish)?;
        check_custom(custom, scene)?;
        let forecast = Forecast::of(loaded, &plan);
        if let Some(shortage) = forecast.refuse(plan.memory) {
            return Err(shortage.into());
        }
        let Plan { settings, first, end, whole, spectral, recording, structure, isa, .. } = plan;
        let search = straal_accel::Options { structure, isa, ..straal_accel::Options::default() };
        let request = Request {
            scene,
            assets: &loaded.assets,
            custom,
            size: settings.size,
            search: &search,
            spectral,
            recording,
            detail,
        };
        let mut world = compile::compile_after(before, &request)?;
        if !plan.integrator.tells_light_groups() && world.light_groups.matter() {
            let name = plan.integrator.name();
            world.notes.push(format!(
                "`{name}` can't tell what light comes from which lamp: groups of lights have no layers"
            ));
        }
        if let Some(why) = &world.out_of_focus {
            return Err(Error::scene(why.span, why.to_string()));
        }
        if let Some(why) = plan.integrator.misfit(&world) {
            return Err(Error::Request(why));
        }
        world.learn(&plan.integrator, settings.size);
        Ok(Self {
            world,
            settings,
            spp: end,
            first,
            whole,
            integrator: plan.integrator,
            denoise: plan.denoise,
            denoised_noise: plan.denoised_noise,
            scene_hash: scene_hash(loaded, custom),
            forecast,
            memory: plan.memory,
            development: Development::of(&scene.film),
            space: plan.space,
            structure,
        })
    }

    /// How the scene wants its picture developed.
    pub fn development(&self) -> Development {
        self.development
    }

    /// The work space.
    pub fn space(&self) -> Space {
        self.space
    }

    /// What the three numbers of the film's pixels are.
    pub fn film_space(&self) -> RgbSpace {
        match self.world.sensor.recording() {
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

    /// How light is gathered.
    pub fn integrator(&self) -> AnyIntegrator {
        self.integrator
    }

    /// The path tracer of the scene; the usual one where it asks for something else.
    pub fn path_tracer(&self) -> PathTracer {
        match self.integrator {
            AnyIntegrator::Path(path) => path,
            _ => PathTracer::default(),
        }
    }

    /// What all pictures of this job tell about themselves, with so many samples.
    pub(crate) fn metadata(&self, samples: u32) -> Vec<(String, String)> {
        let mut metadata = self.facts();
        metadata.push(("straal.samples".into(), samples.to_string()));
        metadata
    }

    /// The same but for what comes of it.
    pub(crate) fn facts(&self) -> Vec<(String, String)> {
        let s = &self.settings;
        let noise = s.noise.or(self.denoised_noise).map(|noise| ("noise", noise.to_string()));
        let guides = (s.guides != Guides::First).then(|| ("guides_of", s.guides.name().to_string()));
        let counted = s.cost.then(|| ("cost", self.structure.to_string()));
        let recording = self.world.sensor.recording();
        let channels = (recording != Recording::Rgb).then(|| ("channels", recording.name().to_string()));
        let magnified = self.world.camera.focal_pixels().map(|f| ("focal_pixels", f.to_string()));
        [
            ("version", crate::VERSION.to_string()),
            ("scene_hash", self.scene_hash.clone()),
            ("seed", s.seed.to_string()),
            ("sampler", s.pattern.kind().to_string()),
            ("space", self.space.name().to_string()),
            ("light", if self.world.tables.is_spectral() { "wavelengths" } else { "rgb" }.to_string()),
            ("integrator", self.integrator.name().to_string()),
        ]
        .into_iter()
        .chain(self.integrator.facts())
        .chain([
            ("size", format!("{}x{}", s.size[0], s.size[1])),
            ("crop", format!("{},{},{},{}", s.crop.min[0], s.crop.min[1], s.crop.max[0], s.crop.max[1])),
        ])
        .chain(noise)
        .chain(guides)
        .chain(counted)
        .chain(magnified)
        .chain(channels)
        .chain(s.splat.then(|| ("splat", "true".to_string())))
        .chain((self.first > 0).then(|| ("first_sample", self.first.to_string())))
        .map(|(k, v)| (format!("straal.{k}"), v))
        .collect()
    }

    /// Refuses what takes so many bytes besides the job itself, where that is more than may be used.
    pub(crate) fn check_room(&self, bytes: u64) -> Result<(), Error> {
        let shortage = self.forecast.with(bytes).refuse(self.memory);
        shortage.map_or(Ok(()), |shortage| Err(shortage.into()))
    }
}

/// The scene's hash in hexadecimal, 16 bytes of it; where a program brought shapes or materials, with the fingerprints
/// of these behind it.
fn scene_hash(loaded: &Loaded, custom: &Custom) -> String {
    let scene: String = loaded.hash[..16].iter().map(|b| format!("{b:02x}")).collect();
    let shapes = custom.shapes.iter().map(|(s, _)| s.fingerprint());
    let all: Vec<u64> = shapes.chain(custom.materials.iter().map(|(_, m)| m.fingerprint())).collect();
    all.iter().fold(scene, |text, f| format!("{text}-{f:016x}"))
}
