//! Scenes of pbrt-v4, and of version 3 where its words are plain.
//!
//! The language is a list of directives, which change a graphics state or make something out of it ([`state`], [`directives`]); what
//! they make is translated at once, a file for each kind of thing. pbrt's own conventions are turned into straal's here:
//!
//! - its cameras look along +z with x to the right, so that what straal sees of the same numbers is a mirror image: `mirror` of the
//!   camera undoes that;
//! - a light's numbers are multiplied by what the film's sensor makes of them (exposure time, ISO);
//! - lights that are told by spectra have a luminance of 1, times their scale;
//! - a transform is a matrix, by columns.
//!
//! What is left out or approximated is said by name and place, once for each kind. Facts are from pbrt-v4's page "pbrt-v4 Input File
//! Format" and its source.

mod camera;
mod curves;
mod directives;
mod film;
mod lights;
mod materials;
mod meshes;
mod params;
mod shapes;
mod spectra;
mod state;
#[cfg(test)]
mod tests;
mod textures;
mod tokens;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use straal_math::DVec3;
use straal_scene::desc::{Camera, Node, Observer, Perspective};
use straal_scene::value::Name;
use straal_scene::{Diagnostic, Diagnostics, Scene, Span, Spanned, suggest};

use super::{Made, Means, Translated};
use crate::files::{self, Refusal};
use params::Params;
use state::State;
use tokens::Tokens;

/// Reads one.
pub(super) fn read(name: &str, bytes: &[u8], means: &mut Means<'_>) -> Option<Translated> {
    let mut reader = Reader::new(name, bytes, means);
    reader.directives();
    reader.finish()
}

/// What the directives before `WorldBegin` say, until it is known what of it counts.
#[derive(Default)]
struct Options {
    camera: Option<Thing>,
    film: Option<Thing>,
    filter: Option<Thing>,
    sampler: Option<Thing>,
    integrator: Option<Thing>,
    /// From `Option "seed"`.
    seed: Option<u64>,
    /// When transforms are those of the start and of the end.
    transform_times: Option<[f64; 2]>,
}

/// A kind and its parameters.
struct Thing {
    kind: Spanned<String>,
    params: Params,
}

/// An object that is being defined.
struct Object {
    name: Name,
    nodes: Vec<Node>,
}

/// How far a scene has been read.
struct Reader<'a, 'm> {
    means: &'a mut Means<'m>,
    tokens: Tokens<'a>,
    scene: Scene,
    made: Made,
    /// What was read besides, see [`Translated::files`].
    files: Vec<(PathBuf, String, [u8; 32])>,
    text_bytes: u64,
    options: Options,
    /// Whether `WorldBegin` was read.
    in_world: bool,
    state: State,
    /// States that come back, and why.
    stack: Vec<state::Saved>,
    systems: BTreeMap<String, state::Transforms>,
    object: Option<Object>,
    /// Where in the world the instances of each object are gathered.
    instances: BTreeMap<String, usize>,
    textures: textures::Known,
    materials: materials::Known,
    spectra: spectra::Known,
    /// What all light is multiplied by, for the film's exposure.
    light_scale: f64,
    /// What was said already, so that it isn't said a thousand times.
    told: BTreeSet<String>,
    /// How many meshes the text holds.
    meshes: usize,
    /// Bytes that they take.
    mesh_bytes: u64,
    curves: Option<curves::Gathered>,
    /// How many nodes there are.
    nodes: u64,
    /// Whether the rest isn't read, after an error that leaves no sense in it.
    is_done: bool,
    /// Whether something of the world came before it.
    is_early: bool,
    /// What the last directive named as a material though nothing goes by it.
    just_named: Option<Name>,
}

impl<'a, 'm> Reader<'a, 'm> {
    fn new(name: &str, bytes: &'a [u8], means: &'a mut Means<'m>) -> Self {
        let tokens = Tokens::new(name, bytes, means.d);
        // Where nothing is said, the camera stands at the origin and looks along +z.
        let observer = Observer { eye: DVec3::ZERO, look_at: DVec3::Z, ..Observer::default() };
        let camera = Camera::Perspective(Perspective { observer, ..Perspective::default() });
        Self {
            means,
            tokens,
            scene: Scene::seen_by(camera),
            made: Made::default(),
            files: Vec::new(),
            text_bytes: tokens::kept(bytes.len()),
            options: Options::default(),
            in_world: false,
            state: State::default(),
            stack: Vec::new(),
            systems: BTreeMap::new(),
            object: None,
            instances: BTreeMap::new(),
            textures: textures::Known::default(),
            materials: materials::Known::default(),
            spectra: spectra::Known::default(),
            light_scale: 1.0,
            told: BTreeSet::new(),
            meshes: 0,
            mesh_bytes: 0,
            curves: None,
            nodes: 0,
            is_done: false,
            is_early: false,
            just_named: None,
        }
    }

    fn finish(mut self) -> Option<Translated> {
        self.end_of_curves();
        for saved in std::mem::take(&mut self.stack) {
            let message = match saved.why {
                state::Why::Object => "this object has no `ObjectEnd`",
                _ => "this has no `AttributeEnd`",
            };
            self.error(saved.span, message);
        }
        if !self.in_world {
            let place = self.tokens.place();
            let mut complaint =
                Diagnostic::error(place, "the file ends before `WorldBegin`: nothing is in the world");
            if self.is_early {
                complaint = complaint.help("perhaps it is a part of a scene, which another file includes");
            }
            self.d().push(complaint);
        }
        let Self { scene, made, files, text_bytes, .. } = self;
        Some(Translated { scene, made, files, text_bytes })
    }

    fn d(&mut self) -> &mut Diagnostics {
        self.means.d
    }

    fn error(&mut self, span: Span, message: impl Into<String>) {
        self.d().push(Diagnostic::error(span, message));
    }

    fn warn(&mut self, span: Span, message: impl Into<String>) {
        self.d().push(Diagnostic::warning(span, message));
    }

    /// Warns once of what may be there a thousand times.
    fn warn_once(&mut self, span: Span, message: impl Into<String>) {
        let message = message.into();
        if self.told.insert(message.clone()) {
            self.warn(span, message);
        }
    }

    /// The complaint of a kind that isn't known, of which there are `known` ones.
    fn unknown(&mut self, what: &str, kind: &Spanned<String>, known: &[&str]) {
        let message = format!("there is no {what} `{}`", suggest::brief(kind));
        let names = || known.iter().copied();
        let help = suggest::did_you_mean(kind, names()).unwrap_or_else(|| suggest::list(names()));
        self.d().push(Diagnostic::error(kind.span, message).help(help));
    }

    /// Puts something into the object that is open, or into the world.
    fn push(&mut self, node: Node) {
        self.nodes += 1;
        if self.nodes.is_multiple_of(1 << 14) {
            let bytes = self.nodes * size_of::<Node>() as u64 + self.mesh_bytes;
            let help = "instances of objects, and meshes of many triangles, take less than single shapes";
            let what = || "the description of this scene".to_owned();
            if let Some(shortage) = self.means.ledger.refuse(bytes, what, help) {
                self.means.d.lacks_memory = true;
                self.is_done = true;
                let place = self.tokens.place();
                return self.error(place, shortage.to_string());
            }
        }
        match &mut self.object {
            Some(object) => object.nodes.push(node),
            None => self.scene.world.push(node),
        }
    }

    /// The bytes of a file that the scene names, and where it is.
    fn bytes_of(&mut self, file: &Spanned<String>, most: u64) -> Result<(PathBuf, Vec<u8>), Refusal> {
        let path = self.found(file)?;
        let size = files::size(&path, most)?;
        let what = || format!("reading `{}`", suggest::brief(file));
        if let Some(shortage) = self.means.ledger.refuse(size, what, "a smaller file takes less") {
            self.d().lacks_memory = true;
            return Err(Refusal::new(shortage.to_string()).help(shortage.help()));
        }
        let bytes = files::read_packed(&path, most)?;
        Ok((path, bytes))
    }

    /// Where a file is that the scene names.
    fn found(&mut self, file: &Spanned<String>) -> Result<PathBuf, Refusal> {
        let found = self.means.finder.find(self.means.base, file)?;
        if let Some(instead) = found.instead {
            let (name, instead) = (suggest::brief(file), suggest::brief(&instead));
            let message = format!("there is no file `{name}`: `{instead}` is read");
            self.means.d.push(Diagnostic::warning(file.span, message));
        }
        Ok(found.path)
    }

    /// Why a file of the scene isn't read.
    fn refuse(&mut self, file: &Spanned<String>, refusal: Refusal) {
        let message = format!("cannot read `{}`: {}", suggest::brief(file), refusal.problem);
        self.d().push(Diagnostic::error(file.span, message).maybe_help(refusal.help));
    }
}
