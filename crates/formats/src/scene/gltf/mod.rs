//! Scenes of glTF 2.0, as text (.gltf) or packed (.glb), by the specification 2.0.1 of Khronos.
//!
//! | file | what |
//! |---|---|
//! | `container.rs` | chunks of a .glb; URIs, which hold bytes or name files |
//! | `json.rs`, `document.rs` | the JSON with its places, what leads where in it, buffers; complaints that name the path |
//! | `accessor.rs`, `meshopt.rs`, `draco.rs` | columns of numbers, and those that are packed |
//! | `animation.rs`, `pointer.rs` | where nodes are at a frame, and what any number of the file is |
//! | `tree.rs`, `world.rs` | the tree of nodes; what they show, once or many times |
//! | `geometry.rs` | primitives as triangles; morph targets and skins |
//! | `material.rs`, `textures.rs` | materials and the pictures that they read |
//! | `lights.rs`, `view.rs` | lights, exposure and cameras, and what stands in for them |
//!
//! Right-handed, y up and metres are glTF's own conventions as well. Texture coordinates are turned over, as their v falls there.

mod accessor;
mod animation;
mod container;
mod document;
mod draco;
mod extensions;
mod geometry;
mod json;
mod lights;
mod material;
mod meshopt;
mod pointer;
mod tangents;
mod textures;
mod tree;
mod unlit;
mod view;
mod world;

use std::collections::BTreeMap;
use std::fmt::Write;

use straal_math::DVec3;
use straal_scene::desc::{Camera, Light, Node, Orthographic, Perspective, Scene};
use straal_scene::{Diagnostic, Diagnostics, Span, suggest};

use self::container::Container;
use self::document::{Document, Result, required, text};
use self::json::Json;
use self::material::{Has, Look};
use self::textures::Pictures;
use self::tree::Tree;
use super::{Made, Means, Translated};

pub(super) use self::animation::slerp;
pub(super) use self::lights::studio;
pub(super) use self::tree::rotation;

/// The longest JSON text, in bytes.
const MOST_TEXT: usize = 1 << 28;

/// Reads one.
pub(super) fn read(name: &str, bytes: &[u8], means: &mut Means<'_>) -> Option<Translated> {
    let mut fail = |message: String| {
        means.d.push(Diagnostic::error(Span::NONE, format!("cannot read `{name}`: {message}")));
    };
    let container = match Container::of(bytes) {
        Ok(container) => container,
        Err(problem) => {
            fail(problem);
            return None;
        }
    };
    let Ok(text) = std::str::from_utf8(container.json) else {
        fail("its JSON isn't UTF-8".to_owned());
        return None;
    };
    // A chunk is filled up with spaces.
    let text = text.trim_end_matches([' ', '\0']);
    if text.len() > MOST_TEXT {
        fail(format!("its JSON is too long: {} bytes", text.len()));
        return None;
    }
    let needs = json::BYTES * text.len() as u64;
    if let Some(shortage) =
        means.ledger.refuse(needs, || format!("reading `{name}`"), "a smaller scene takes less")
    {
        fail(shortage.to_string());
        means.d.lacks_memory = true;
        return None;
    }
    means.ledger.pass(needs);
    let file = means.d.sources.add(name, text);
    let mut root = match Json::parse(text) {
        Ok(root) => root,
        Err(wrong) => {
            let at = wrong.at as u32;
            means.d.push(Diagnostic::error(
                Span { file, start: at, end: at },
                format!("this is no JSON: {}", wrong.problem),
            ));
            return None;
        }
    };
    pointer::settle(&mut root, file, container.binary, means);
    let mut files = Vec::new();
    let document = Document::open(&root, file, container.binary, means, &mut files);
    let mut translation = Translation {
        name: std::path::Path::new(name)
            .file_name()
            .map_or_else(|| name.to_owned(), |n| n.to_string_lossy().into_owned()),
        document,
        means,
        made: Made::default(),
        scene: Scene::seen_by(Camera::Perspective(Perspective::default())),
        pictures: Pictures::default(),
        looks: BTreeMap::new(),
        primitives: BTreeMap::new(),
        objects: BTreeMap::new(),
        skinned: Vec::new(),
        corners: Vec::new(),
        vertices: 0,
        kept: 0,
        meshes: 0,
        variant: None,
        is_fitted: false,
        told: BTreeMap::new(),
    };
    if let Err(fault) = translation.all() {
        translation.means.d.push(translation.document.error(&fault));
    }
    translation.tell();
    let Translation { mut scene, made, means, is_fitted, .. } = translation;
    if means.d.has_errors() {
        return None;
    }
    if is_fitted && means.frame != 0.0 {
        see_as_at_first(&mut scene, name, bytes, means);
    }
    Some(Translated { scene, made, files, text_bytes: text.len() as u64 })
}

/// Has a scene without a camera seen, and lit, in all frames as in the first: a camera that follows what moves would hide that it does.
fn see_as_at_first(scene: &mut Scene, name: &str, bytes: &[u8], means: &mut Means<'_>) {
    let (mut d, mut ledger) = (Diagnostics::default(), *means.ledger);
    let mut still = means.beside(0.0, &mut ledger, &mut d);
    let Some(first) = read(name, bytes, &mut still) else { return };
    scene.camera = first.scene.camera;
    if let (Some(Light::Environment(to)), Some(Light::Environment(from))) =
        (scene.lights.first_mut(), first.scene.lights.first())
    {
        to.rotate = from.rotate;
    }
}

/// A file on its way to a scene.
struct Translation<'a, 'm> {
    /// What messages and names call the file.
    name: String,
    document: Document<'a>,
    means: &'a mut Means<'m>,
    made: Made,
    scene: Scene,
    pictures: Pictures<'a>,
    /// Materials, by their index and what the mesh has.
    looks: BTreeMap<(Option<usize>, Has), Look>,
    /// Primitives by what they are read from.
    primitives: BTreeMap<String, world::Known>,
    /// Meshes that are shown several times, by where they are said and their weights.
    objects: BTreeMap<(u32, Vec<u64>), Option<world::Object>>,
    /// What follows skeletons, which stands in the world as it is.
    skinned: Vec<Node>,
    /// Corners of boxes around all that is seen.
    corners: Vec<DVec3>,
    /// Of all meshes together.
    vertices: u64,
    /// Bytes of all meshes.
    kept: u64,
    /// How many meshes were made.
    meshes: usize,
    /// The variant of materials that is shown.
    variant: Option<usize>,
    /// Whether it is seen by a camera that isn't its own.
    is_fitted: bool,
    /// What is to be told, where it was met first, and how often.
    told: BTreeMap<String, ((u32, u32), usize)>,
}

impl<'a> Translation<'a, '_> {
    /// Translates all that there is.
    fn all(&mut self) -> Result<()> {
        self.version()?;
        self.extensions();
        if self.means.d.has_errors() {
            return Ok(());
        }
        self.variant = self.chosen_variant();
        let scene = self.chosen_scene()?;
        let (poses, later) = self.poses()?;
        let tree = Tree::of(&self.document, scene, poses)?;
        let later = later.into_iter().map(|poses| Tree::of(&self.document, scene, poses));
        let later: Vec<Tree<'a>> = later.collect::<Result<_>>()?;
        self.world(&tree, &later)?;
        self.decode_pictures();
        let Some([min, max]) = self.extent() else {
            let message = format!("`{}` shows nothing: there are no triangles in its scene", self.name);
            self.means.d.push(Diagnostic::error(Span::NONE, message));
            return Ok(());
        };
        let (centre, radius) = ((min + max) * 0.5, (max - min).length() * 0.5);
        self.view(&tree, &later, centre)?;
        self.lights(&tree)?;
        if self.scene.lights.is_empty() {
            let observer = match &self.scene.camera {
                Camera::Perspective(Perspective { observer, .. }) => observer.clone(),
                Camera::Orthographic(Orthographic { observer, .. }) => observer.clone(),
                _ => return Ok(()),
            };
            self.studio(&observer);
        } else {
            self.expose(centre, radius);
        }
        Ok(())
    }

    /// Complains of files of another version.
    fn version(&mut self) -> Result<()> {
        let asset = required(self.document.root, "asset")?;
        for key in ["version", "minVersion"] {
            let Some(at) = asset.get(key) else { continue };
            let version = text(at)?;
            let is_read = if key == "version" { version.starts_with("2.") } else { version == "2.0" };
            if !is_read {
                let message =
                    format!("the file is of glTF {}, of which only 2.0 is read", suggest::brief(version));
                return Err(document::Fault::of(at, message));
            }
        }
        required(asset, "version").map(|_| ())
    }

    /// The scene that is shown; none where the file has none, and all of its nodes are.
    fn chosen_scene(&mut self) -> Result<Option<&'a Json>> {
        let scenes = self.document.list("scenes");
        let name_of =
            |i: usize| match scenes[i].get("name").and_then(Json::text).filter(|name| !name.is_empty()) {
                Some(name) => suggest::brief(name).to_string(),
                None => format!("scenes[{i}]"),
            };
        let names = || (0..scenes.len()).map(name_of).collect::<Vec<_>>().join(", ");
        if let Some(wanted) = self.means.define.get("scene") {
            let found = (0..scenes.len()).find(|&i| name_of(i) == *wanted);
            let found = found.or_else(|| wanted.parse().ok().filter(|i| *i < scenes.len()));
            if let Some(i) = found {
                return Ok(Some(&scenes[i]));
            }
            let message =
                format!("`{}` has no scene `{}`: it has {}", self.name, suggest::brief(wanted), names());
            self.means.d.push(Diagnostic::error(Span::NONE, message));
        }
        let i = match self.document.root.get("scene") {
            Some(at) => self.document.item("scenes", at)?.0,
            None => 0,
        };
        if scenes.len() > 1 && !self.means.define.contains_key("scene") {
            let message = format!(
                "`{}` has {} scenes: {}; `{}` is shown",
                self.name,
                scenes.len(),
                names(),
                name_of(i)
            );
            self.means.d.push(Diagnostic::note(Span::NONE, message).help("`-D scene=NAME` says another"));
        }
        Ok(scenes.get(i))
    }

    /// Which of the variants of materials is asked for.
    fn chosen_variant(&mut self) -> Option<usize> {
        let said = self.document.root.extension("KHR_materials_variants").and_then(|e| e.get("variants"));
        let variants = said.map_or(&[][..], |list| list.items());
        let names: Vec<&str> =
            variants.iter().map(|v| v.get("name").and_then(Json::text).unwrap_or("")).collect();
        let mut shown = String::new();
        for name in names.iter().take(50) {
            let _ = write!(shown, "{}{}", if shown.is_empty() { "" } else { ", " }, suggest::brief(name));
        }
        let Some(wanted) = self.means.define.get("variant") else {
            if !names.is_empty() {
                let message = format!("`{}` has variants: {shown}; its own materials are shown", self.name);
                self.means
                    .d
                    .push(Diagnostic::note(Span::NONE, message).help("`--variant NAME` says another"));
            }
            return None;
        };
        let found = names.iter().position(|name| name == wanted);
        if found.is_none() {
            let has = if names.is_empty() { "it has none".to_owned() } else { format!("it has {shown}") };
            let message = format!("`{}` has no variant `{}`: {has}", self.name, suggest::brief(wanted));
            self.means.d.push(Diagnostic::error(Span::NONE, message));
        }
        found
    }

    /// Tells of something that is left out or changed, once, however often it is met.
    fn warn(&mut self, at: &Json, message: impl Into<String>) {
        const MOST: usize = 100;
        let message = message.into();
        if self.told.len() < MOST || self.told.contains_key(&message) {
            self.told.entry(message).or_insert(((at.start, at.end), 0)).1 += 1;
        }
    }

    /// Gives what was to be told.
    fn tell(&mut self) {
        for (message, (place, count)) in std::mem::take(&mut self.told) {
            let (span, path) = self.document.place(place);
            let more = if count > 1 { format!(", and so {} more times", count - 1) } else { String::new() };
            self.means.d.push(Diagnostic::warning(span, format!("{path}{message}{more}")));
        }
    }
}

/// Numbers that are kept between two.
trait Within {
    /// The nearest that is from `least` to `most`.
    fn within(self, least: f64, most: f64) -> f64;
}

impl Within for f64 {
    fn within(self, least: f64, most: f64) -> f64 {
        if self < least {
            least
        } else if self > most {
            most
        } else {
            self
        }
    }
}

/// An angle in degrees.
fn degrees(radians: f64) -> f64 {
    radians * (180.0 / std::f64::consts::PI)
}
