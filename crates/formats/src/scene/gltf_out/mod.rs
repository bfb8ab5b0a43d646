//! Scenes written as glTF 2.0: the mirror of the reader in `gltf`, with the same conventions.
//!
//! | file | what |
//! |---|---|
//! | `buffer.rs` | the buffer, its views and accessors; the chunks of a .glb |
//! | `geometry.rs` | meshes as primitives |
//! | `shapes.rs`, `pieces.rs` | formulas as meshes |
//! | `tree.rs` | nodes, and which mesh with which materials they show |
//! | `likeness.rs` | other materials as the material `gltf` |
//! | `material.rs` | that material with its extensions |
//! | `textures.rs` | what a texture is a product of; pictures, samplers and where they lie |
//! | `lights.rs`, `camera.rs` | lights and the camera |
//! | `moving.rs` | what moves from frame to frame |
//!
//! What glTF can't say is told, once for each kind, and left out or replaced by what is near to it.

mod buffer;
mod camera;
mod geometry;
mod lights;
mod likeness;
mod material;
mod moving;
mod pieces;
mod shapes;
mod textures;
mod tree;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde_json::{Map, Value as Json, json};
use straal_color::spectrum::uplift::Uplift;
use straal_scene::{Assets, Diagnostic, Diagnostics, Mesh, Scene, Span};

use self::buffer::Buffer;
pub use self::moving::{Frames, MOST_FRAMES};
use crate::Loaded;

/// How a scene of glTF is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form<'a> {
    /// All in one file (.glb).
    Packed,
    /// JSON, and a buffer of that name beside it (.gltf).
    Beside(&'a str),
}

/// A scene as glTF.
#[derive(Debug)]
pub struct Written {
    /// The file.
    pub bytes: Vec<u8>,
    /// What goes into the file beside it, if there is one and it holds anything.
    pub buffer: Option<Vec<u8>>,
    /// What glTF doesn't say, a warning for each kind.
    pub warnings: Diagnostics,
}

/// Writes a scene as glTF; an error says why there is none.
pub fn write(loaded: &Loaded, form: Form<'_>) -> Result<Written, String> {
    write_at_most(loaded, None, form, MOST)
}

/// The same of so many nodes at most, with what moves from frame to frame.
fn write_at_most(
    loaded: &Loaded,
    frames: Option<&Frames<'_>>,
    form: Form<'_>,
    most: usize,
) -> Result<Written, String> {
    let mut out = Out { frames, ..Out::of(&loaded.scene, &loaded.assets, most) };
    for told in frames.into_iter().flat_map(Frames::told) {
        out.tell(told);
    }
    let roots = out.world();
    let mut roots: Vec<usize> = roots.into_iter().chain(out.camera()).collect();
    roots.extend(out.lights());
    let mut warnings = Diagnostics::default();
    for (message, count) in std::mem::take(&mut out.told) {
        let more = if count > 1 { format!(", and so {} more times", count - 1) } else { String::new() };
        warnings.push(Diagnostic::warning(Span::NONE, format!("{message}{more}")));
    }
    let (root, buffer) = out.document(&roots, form)?;
    let text = root.to_string();
    match form {
        Form::Packed => Ok(Written { bytes: buffer::packed(&text, &buffer)?, buffer: None, warnings }),
        Form::Beside(_) => Ok(Written {
            bytes: text.into_bytes(),
            buffer: Some(buffer).filter(|bytes| !bytes.is_empty()),
            warnings,
        }),
    }
}

/// More nodes aren't written: copies of copies would fill a disk.
const MOST: usize = 1_000_000;

/// Things of a kind, in the order in which they are met.
#[derive(Default)]
struct List {
    items: Vec<Json>,
    known: BTreeMap<String, usize>,
}

impl List {
    /// Adds one; gives its index.
    fn add(&mut self, item: Json) -> usize {
        self.items.push(item);
        self.items.len() - 1
    }

    /// The index of what says the same, which is added if there is none.
    fn once(&mut self, item: Json) -> usize {
        let text = item.to_string();
        if let Some(known) = self.known.get(&text) {
            return *known;
        }
        let index = self.add(item);
        self.known.insert(text, index);
        index
    }
}

/// A scene on its way to a file.
struct Out<'a> {
    scene: &'a Scene,
    assets: &'a Assets,
    buffer: Buffer,
    nodes: List,
    /// How many of these are written.
    most: usize,
    meshes: List,
    materials: List,
    textures: List,
    samplers: List,
    images: List,
    cameras: List,
    lights: List,
    extensions: BTreeSet<&'static str>,
    /// Meshes of formulas and of the scene's text, by where their nodes stand in memory.
    made: BTreeMap<usize, Option<Arc<Mesh>>>,
    /// Primitives that were written.
    primitives: BTreeMap<geometry::Key, Json>,
    /// Pictures by the handles and channels that they are made of.
    pictures: BTreeMap<textures::Key, Option<usize>>,
    /// For spectra, once there is one.
    uplift: Option<Box<Uplift>>,
    /// The frames of a scene that moves, and what is written of them.
    frames: Option<&'a Frames<'a>>,
    moving: moving::Moving,
    /// What is to be told, and how often.
    told: BTreeMap<String, usize>,
}

impl<'a> Out<'a> {
    fn of(scene: &'a Scene, assets: &'a Assets, most: usize) -> Self {
        Self {
            scene,
            assets,
            buffer: Buffer::default(),
            nodes: List::default(),
            most,
            meshes: List::default(),
            materials: List::default(),
            textures: List::default(),
            samplers: List::default(),
            images: List::default(),
            cameras: List::default(),
            lights: List::default(),
            extensions: BTreeSet::new(),
            made: BTreeMap::new(),
            primitives: BTreeMap::new(),
            pictures: BTreeMap::new(),
            uplift: None,
            frames: None,
            moving: moving::Moving::default(),
            told: BTreeMap::new(),
        }
    }

    /// Tells of something that is left out or changed, once, however often it is met.
    fn tell(&mut self, message: impl Into<String>) {
        *self.told.entry(message.into()).or_default() += 1;
    }

    /// What an object has under an extension's name, which is taken note of.
    fn extend(&mut self, object: &mut Map<String, Json>, name: &'static str, said: Json) {
        self.extensions.insert(name);
        let all = object.entry("extensions").or_insert_with(|| json!({}));
        if let Some(all) = all.as_object_mut() {
            all.insert(name.to_owned(), said);
        }
    }

    /// The whole, and the bytes of its buffer.
    fn document(self, roots: &[usize], form: Form<'_>) -> Result<(Json, Vec<u8>), String> {
        let mut root = Map::new();
        root.insert("asset".to_owned(), json!({ "version": "2.0", "generator": "straal" }));
        if !self.extensions.is_empty() {
            root.insert("extensionsUsed".to_owned(), json!(self.extensions));
        }
        root.insert("scene".to_owned(), json!(0));
        // A list may not be empty.
        let scene = if roots.is_empty() { json!({}) } else { json!({ "nodes": roots }) };
        root.insert("scenes".to_owned(), json!([scene]));
        if !self.lights.items.is_empty() {
            let lights = json!({ "KHR_lights_punctual": { "lights": self.lights.items } });
            root.insert("extensions".to_owned(), lights);
        }
        let Buffer { bytes, views, accessors } = self.buffer;
        if u32::try_from(bytes.len()).is_err() {
            return Err(format!("a buffer of glTF holds at most 4 GiB, and this has {} bytes", bytes.len()));
        }
        let buffers = match form {
            _ if bytes.is_empty() => Vec::new(),
            Form::Packed => vec![json!({ "byteLength": bytes.len() })],
            Form::Beside(name) => vec![json!({ "uri": escaped(name), "byteLength": bytes.len() })],
        };
        let lists = [
            ("nodes", self.nodes.items),
            ("animations", self.moving.said().into_iter().collect()),
            ("cameras", self.cameras.items),
            ("meshes", self.meshes.items),
            ("materials", self.materials.items),
            ("textures", self.textures.items),
            ("samplers", self.samplers.items),
            ("images", self.images.items),
            ("accessors", accessors),
            ("bufferViews", views),
            ("buffers", buffers),
        ];
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            root.insert(key.to_owned(), Json::Array(list));
        }
        Ok((Json::Object(root), bytes))
    }
}

/// A file's name as a URI has it: all but letters, digits and `-._~` by percent signs (RFC 3986).
fn escaped(name: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-._~".contains(&b);
    name.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

#[cfg(test)]
mod tests;
