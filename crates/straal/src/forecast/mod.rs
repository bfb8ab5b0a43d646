//! How much memory a job will take, told before any of it is taken: one piece of code for `straal check` and for the limit
//! of a render.
//!
//! A render goes through phases, and what one has given back another takes again: the text and the files are read; the
//! world is made and its search structures built; light is gathered on the film; the film becomes layers, and these files. What counts
//! is the phase that takes the most.

mod search;
mod world;

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::denoise::Denoising;
use crate::resolve::{Error, Overrides, Plan};
use straal_accel::Structure;
use straal_color::spectrum::uplift::UpliftTable;
use straal_formats::load::Loaded;
use straal_render::driver::thread_bytes;
use straal_render::film::Film;
use straal_render::light::ImageEnvironment;
use straal_render::settings::Settings;
use straal_render::texture::Pyramid;
use straal_scene::count::{self, Contents};
use straal_scene::memory::{PROGRAM, Shortage};

/// Bytes that a job takes, and what they are for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Forecast {
    /// Triangles that are kept: those of an object once, those of an object that glows for each of its instances.
    pub triangles: u64,
    /// Vertices that are kept.
    pub vertices: u64,
    /// Triangles and other shapes that rays can meet, instances counted each time.
    pub visible: u64,
    /// The program itself.
    pub program: u64,
    /// The scene's text and what it says.
    pub scene: u64,
    /// Meshes, shapes and instances.
    pub geometry: u64,
    /// The search structures.
    pub search: u64,
    /// What building them takes besides.
    pub building: u64,
    /// What shines, and how it is chosen.
    pub lights: u64,
    /// Pictures that are all around.
    pub images: u64,
    /// Pictures that textures are read off, with their smaller copies.
    pub textures: u64,
    /// The film's sums.
    pub film: u64,
    /// The layers that they become.
    pub layers: u64,
    /// What the threads have of their own.
    pub threads: u64,
    /// All that is in use at one time, at most.
    pub peak: u64,
}

/// Forecasts what a loaded scene takes with what a caller wants otherwise.
pub fn forecast(loaded: &Loaded, wish: &Overrides) -> Result<Forecast, Error> {
    Ok(Forecast::of(loaded, &Plan::new(loaded, wish)?))
}

/// What a thread takes besides: the part of its stack that is used, and the allocator's share.
const THREAD: u64 = 100_000;

impl Forecast {
    pub(crate) fn of(loaded: &Loaded, plan: &Plan) -> Self {
        let contents = count::count(&loaded.scene, &loaded.assets);
        let world::Cost { geometry, lights, making } =
            world::cost(&contents.kept, world::choices(&loaded.scene));
        let (search, building) = search_of(&contents, &plan.structure);
        let pixels: u64 = contents.surroundings.iter().sum();
        let large = contents.surroundings.iter().filter(|pixels| **pixels > 500).count() as u64;
        let largest = contents.surroundings.iter().copied().max().unwrap_or(0);
        let textures = textures_of(loaded);
        let extent = plan.extent();
        let region = plan.rendered();
        let crop = plan.settings.crop.area() as u64;
        let each = Film::layer_bytes_a_pixel(&extent, [plan.settings.error, true]) as u64;
        let threads = if plan.settings.threads == 0 {
            std::thread::available_parallelism().map_or(1, usize::from)
        } else {
            plan.settings.threads
        };
        // Samples under way have a sum for each part of the light as well, what `clamp` takes away among them.
        let under_way = Settings { light_groups: extent.light_groups, ..plan.settings.clone() };
        // Of samples that others come before, batches are kept exact, which takes as much again.
        let is_later = plan.first > 0 && extent.batches;
        let later =
            if is_later { (Film::BATCH_BYTES as u64).saturating_mul(region.area() as u64) } else { 0 };
        let film = Film::bytes(&extent, region, plan.settings.size).saturating_add(later);
        // A picture is denoised in the place of the film.
        let denoising = plan.denoise.as_ref().map_or(0, |how| {
            let halves = crop.saturating_mul(Denoising::BYTES_WITH_FILM);
            halves.max(how.bytes(plan.settings.crop).saturating_sub(film))
        });
        let mut f = Self {
            triangles: contents.kept.triangles,
            vertices: contents.kept.vertices,
            visible: contents.visible,
            program: PROGRAM + if plan.spectral { UpliftTable::embedded_bytes() as u64 } else { 0 },
            scene: loaded.text_bytes.saturating_add(loaded.scene.heap_bytes()),
            geometry,
            search,
            building: building.saturating_add(making),
            lights,
            images: pixels
                .saturating_mul(ImageEnvironment::BYTES_A_PIXEL as u64)
                .saturating_add(large.saturating_mul(ImageEnvironment::BYTES as u64)),
            textures: textures.kept,
            film,
            layers: crop.saturating_mul(each).saturating_add(denoising),
            threads: (threads as u64).saturating_mul(THREAD + thread_bytes(&under_way)),
            peak: 0,
        };
        let sum = |parts: &[u64]| parts.iter().fold(0, |sum: u64, part| sum.saturating_add(*part));
        let made = sum(&[f.program, f.scene, loaded.assets.heap_bytes(), f.geometry]);
        // The pictures themselves are among the assets, and kept.
        let smaller = textures.kept - textures.read;
        let phases = [
            loaded.peak_bytes,
            sum(&[made, smaller, textures.making]),
            sum(&[made, smaller, f.search, f.building]),
            sum(&[
                made,
                smaller,
                f.search,
                f.lights,
                f.images,
                largest.saturating_mul(ImageEnvironment::MAKING_BYTES_A_PIXEL as u64),
            ]),
            sum(&[
                f.program,
                loaded.text_bytes,
                f.geometry,
                f.search,
                f.lights,
                f.images,
                f.textures,
                f.film,
                f.layers,
                f.threads,
            ]),
        ];
        f.peak = phases.into_iter().max().unwrap_or(0);
        f
    }

    /// The same where so many bytes are taken besides layers.
    pub(crate) fn with(self, bytes: u64) -> Self {
        Self { layers: self.layers.saturating_add(bytes), peak: self.peak.saturating_add(bytes), ..self }
    }

    /// Why the job can't be done with so many bytes, if so.
    pub fn refuse(&self, limit: Option<u64>) -> Option<Shortage> {
        let limit = limit.filter(|limit| self.peak > *limit)?;
        let parts = [
            (
                "the scene's text",
                self.scene,
                "write what is repeated as an object with instances, or meshes into files",
            ),
            (
                "meshes and shapes",
                self.geometry,
                "a lower `resolution` of Bezier patches, and instances in place of copies, take less",
            ),
            (
                "searching rays",
                self.search + self.building,
                "fewer triangles (a lower `resolution` of Bezier patches, instances in place of copies) take less, and so does \
                 --accel bvh:build=fast,compact=true",
            ),
            (
                "lights",
                self.lights,
                "each instance of an object that glows is a light of its own: fewer take less",
            ),
            ("surroundings", self.images, "a smaller picture takes less"),
            ("textures", self.textures, "smaller pictures take less"),
            (
                "the film",
                self.film + self.layers,
                "a smaller --size takes less, --crop renders a part at a time, and a PNG alone takes less than an EXR",
            ),
            ("threads", self.threads, "fewer --threads and a smaller --batch take less"),
        ];
        let (part, bytes, help) = parts.into_iter().max_by_key(|part| part.1)?;
        let what = "rendering this".to_owned();
        Some(Shortage { what, needs: self.peak, most: Some((part, bytes)), limit, help })
    }
}

/// What the pictures of textures take.
#[derive(Clone, Copy, Debug, Default)]
struct Textures {
    /// As they were read.
    read: u64,
    /// With their smaller copies.
    kept: u64,
    /// Besides, while the largest is made.
    making: u64,
}

fn textures_of(loaded: &Loaded) -> Textures {
    let mut all = Textures::default();
    let mut seen = BTreeSet::new();
    for bitmap in loaded.assets.bitmaps.iter().filter(|b| seen.insert(Arc::as_ptr(b))) {
        let [smaller, making] = Pyramid::bytes_of(&bitmap.texels);
        all.read = all.read.saturating_add(bitmap.heap_bytes());
        all.kept = all.kept.saturating_add(bitmap.heap_bytes()).saturating_add(smaller);
        all.making = all.making.max(making);
    }
    all
}

/// What the search structures of all spaces take, and building the costliest.
fn search_of(contents: &Contents, structure: &Structure) -> (u64, u64) {
    contents.spaces.iter().fold((0, 0), |(kept, building), space| {
        let needs = search::needs(structure, space);
        (needs.kept.saturating_add(kept), needs.building.max(building))
    })
}
