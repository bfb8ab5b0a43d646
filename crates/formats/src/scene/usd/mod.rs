//! Scenes of OpenUSD: text (.usda), binary (.usdc) and packages (.usdz), by the USD Core Specification and the schemas of OpenUSD.
//!
//! | file | what |
//! |---|---|
//! | `layer.rs` | what one file says: prims, properties, what is to be composed |
//! | `text.rs`; `crate_file.rs`, `packed.rs`; `archive.rs` | files as text; as binary; packages |
//! | `library.rs` | which files are read, and how they are stacked |
//! | `stage.rs` | all of it composed, and what it says at a time |
//! | `xform.rs`, `world.rs` | where prims stand, and what they show, once or many times |
//! | `mesh.rs`, `shapes.rs` | meshes and their primvars; shapes that are a formula, and curves |
//! | `skel.rs`; `dual.rs` | skeletons, and what follows them; joints mixed as screws |
//! | `material.rs`, `texture.rs` | `UsdPreviewSurface` and the textures that it reads |
//! | `mtlx.rs`; `document.rs` | surfaces and nodes of MaterialX; its own files as layers |
//! | `lights.rs`, `view.rs`, `extent.rs` | lights, cameras, frames, and what stands in for them |
//!
//! The reader is straal's own: the crate `openusd` (0.6) asks for memory that a damaged file only promises, which ends the process,
//! stops at files of versions before 0.4 by a panic, and brings two versions of crates.

mod archive;
mod crate_file;
mod document;
mod dual;
mod extent;
mod layer;
mod library;
mod lights;
mod material;
mod mesh;
mod mtlx;
mod packed;
mod shapes;
mod skel;
mod stage;
mod text;
mod texture;
mod view;
mod world;
mod xform;

use std::collections::BTreeMap;

use straal_math::{Affine, DVec3};
use straal_scene::desc::{Camera, Node, Perspective, Scene};
use straal_scene::{Diagnostic, Span};

use self::library::Library;
use self::stage::Stage;
use super::{Made, Means, Translated};

/// Reads one.
pub(super) fn read(name: &str, bytes: &[u8], means: &mut Means<'_>) -> Option<Translated> {
    let library = Library::open(name, bytes, means)?;
    let stage = Stage::of(library);
    if stage.library.means.d.has_errors() {
        return None;
    }
    let name =
        std::path::Path::new(name).file_name().map_or(name.into(), |n| n.to_string_lossy()).into_owned();
    let mut translation = Translation::new(name, stage);
    translation.all();
    translation.tell();
    let Translation { scene, made, stage, .. } = translation;
    if stage.library.means.d.has_errors() {
        return None;
    }
    Some(Translated { scene, made, files: stage.library.files, text_bytes: 0 })
}

/// A stage on its way to a scene.
struct Translation<'m, 'a> {
    /// What messages and names call the file.
    name: String,
    stage: Stage<'m, 'a>,
    made: Made,
    scene: Scene,
    /// From the stage to the scene: metres, y up.
    root: Affine,
    /// Metres of a unit of the stage.
    unit: f64,
    /// Names of materials, by their prim and what the mesh has.
    looks: BTreeMap<(Option<usize>, material::Has), material::Look>,
    /// Names of the scene's objects, by the prim whose content they are and what it inherits.
    objects: BTreeMap<(usize, bool, Option<usize>), Option<String>>,
    /// Those of what has no material, by its colour and opacity, and whether vertices have these.
    displays: BTreeMap<(Vec<u64>, bool, bool), material::Look>,
    names: Names,
    /// What stands in the world, wherever it is said.
    reset: Vec<Node>,
    pictures: texture::Pictures,
    /// Prims that were walked through, and how many may be.
    walked: usize,
    /// Of all meshes together.
    vertices: u64,
    /// Bytes of all meshes.
    kept: u64,
    /// Nodes of MaterialX that one is within.
    nested: usize,
    /// Such nodes that were read.
    computed: usize,
    /// For how many time codes the shutter is open.
    open: f64,
    /// What is to be told, and how often.
    told: BTreeMap<String, usize>,
}

impl<'m, 'a> Translation<'m, 'a> {
    fn new(name: String, stage: Stage<'m, 'a>) -> Self {
        let about = &stage.library.layers[0].layer.about;
        // What a stage that says nothing is measured in: centimetres.
        let unit = about.meters_per_unit.filter(|v| (1e-9..=1e9).contains(v)).unwrap_or(0.01);
        let mut root = Affine::scale(DVec3::splat(unit));
        if about.up_axis.as_deref() == Some("Z") {
            // z becomes y, and y goes away from the viewer.
            let turn = Affine { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -1.0, 0.0, 0.0]] };
            root = root.then(&turn);
        }
        Self {
            name,
            stage,
            made: Made::default(),
            scene: Scene::seen_by(Camera::Perspective(Perspective::default())),
            root,
            unit,
            looks: BTreeMap::new(),
            displays: BTreeMap::new(),
            names: Names::default(),
            objects: BTreeMap::new(),
            reset: Vec::new(),
            pictures: texture::Pictures::default(),
            walked: 0,
            vertices: 0,
            kept: 0,
            nested: 0,
            computed: 0,
            open: 0.0,
            told: BTreeMap::new(),
        }
    }

    /// Translates all that there is.
    fn all(&mut self) {
        self.frames();
        self.world();
        self.decode_pictures();
        if self.stage.library.means.d.has_errors() {
            return;
        }
        let corners = extent::corners(&self.scene, &self.made.assets);
        if corners.is_empty() {
            let message = format!("`{}` shows nothing: there is nothing with a surface in it", self.name);
            self.fail(message);
            return;
        }
        self.view(&corners);
        if self.scene.lights.is_empty() && !self.has_lamps() {
            self.studio();
        }
    }

    fn fail(&mut self, message: String) {
        self.stage.library.means.d.push(Diagnostic::error(Span::NONE, message));
    }

    /// Tells of something that is left out or changed, once, however often it is met.
    fn warn(&mut self, prim: usize, message: &str) {
        const MOST: usize = 100;
        if self.told.len() < MOST || self.told.contains_key(message) {
            let path = straal_scene::suggest::brief(&self.stage.prims[prim].path).into_owned();
            let count = self.told.entry(message.to_owned()).or_insert(0);
            *count += 1;
            if *count == 1 {
                let message = format!("`{path}`: {message}");
                self.stage.library.means.d.push(Diagnostic::warning(Span::NONE, message));
            }
        }
    }

    /// Tells what was met again.
    fn tell(&mut self) {
        for (message, count) in std::mem::take(&mut self.told) {
            if count > 1 {
                let message = format!("`{}`: {message}: {count} times in all", self.name);
                self.stage.library.means.d.push(Diagnostic::note(Span::NONE, message));
            }
        }
    }
}

/// Names that were made, and how many of each.
#[derive(Default)]
struct Names(BTreeMap<String, usize>);

impl Names {
    /// A name that nothing has: the one that is wanted, or one with a number. Those that were given out aren't tried again.
    fn free(&mut self, wanted: &str, is_taken: impl Fn(&str) -> bool) -> String {
        let count = self.0.entry(wanted.to_owned()).or_insert(0);
        loop {
            *count += 1;
            let name = if *count == 1 { wanted.to_owned() } else { format!("{wanted} ({count})") };
            if !is_taken(&name) {
                return name;
            }
        }
    }
}

/// Numbers that are kept between two.
fn within(v: f64, least: f64, most: f64) -> f64 {
    if v < least || v.is_nan() {
        least
    } else if v > most {
        most
    } else {
        v
    }
}
