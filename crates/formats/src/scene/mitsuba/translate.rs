//! From the tree of objects to a description: what all kinds of objects need.

use std::collections::{BTreeMap, BTreeSet};

use straal_scene::desc::{Camera, Perspective, Relief, Scene, Texture, TextureOf, Transform};
use straal_scene::limit::Limit;
use straal_scene::value::{Link, Name};
use straal_scene::{Diagnostic, Severity, Span, Spanned, suggest};

use super::bsdf::Around;
use super::kinds;
use super::search::Search;
use super::texture::Role;
use super::tree::{Class, Object, Property, Tree, Value};
use super::uv::Uv;
use crate::files::Refusal;
use crate::scene::{Made, Means, Translated, motion};
use straal_math::{Affine, DVec3};
use straal_scene::desc::MaterialRef;

/// Materials and textures that are made of the scene's objects, for each of these: one that is used in several ways is made several times.
const MOST_EACH: usize = 8;

/// So many more.
const MOST_MORE: usize = 10_000;

/// Translates a scene.
pub(super) fn translate(tree: Tree, means: &mut Means<'_>) -> Option<Translated> {
    let Tree { objects, folders, paths, mut files, text_bytes } = tree;
    let allowed = MOST_EACH * objects.len() + MOST_MORE;
    let mut t = Translator {
        objects: &objects,
        folders: &folders,
        paths: &paths,
        made: Made::default(),
        scene: Scene::seen_by(Camera::Perspective(Perspective::default())),
        search: Search::default(),
        materials: BTreeMap::new(),
        textures: BTreeMap::new(),
        groups: BTreeMap::new(),
        reliefs: vec![Relief::default()],
        codes: BTreeSet::new(),
        code_lists: vec![BTreeSet::new()],
        has_cube: false,
        hides_emitters: super::emitter::are_hidden(&objects),
        nodes: 0,
        serialized: BTreeMap::new(),
        read: Vec::new(),
        media: BTreeSet::new(),
        told: BTreeMap::new(),
        allowed,
        means,
    };
    let root = objects.first()?;
    t.whole(root);
    let Translator { scene, made, read, .. } = t;
    files.extend(read);
    Some(Translated { scene, made, files, text_bytes })
}

/// Makes a description of objects.
pub(super) struct Translator<'o, 'm, 'a> {
    pub objects: &'o [Object],
    folders: &'o [std::path::PathBuf],
    paths: &'o [std::path::PathBuf],
    pub made: Made,
    pub scene: Scene,
    search: Search,
    /// Materials with a name, by their object and what is around it.
    pub materials: BTreeMap<(usize, Around), MaterialRef>,
    /// Textures with a name, likewise.
    pub textures: BTreeMap<(usize, Uv, Role), Name>,
    /// Groups of shapes, by the names of what they have become.
    pub groups: BTreeMap<usize, Name>,
    /// Reliefs that materials are given by what is around them; the first is none.
    pub reliefs: Vec<Relief>,
    /// Which attributes of the mesh in hand are bytes, by Mitsuba's names; and all such lists that there were, the first of which is empty.
    pub codes: BTreeSet<String>,
    pub code_lists: Vec<BTreeSet<String>>,
    /// Whether the camera doesn't see what shines.
    pub hides_emitters: bool,
    /// Whether the mesh of cubes is made.
    pub has_cube: bool,
    /// How many shapes were made.
    pub nodes: usize,
    /// Meshes of `.serialized` files that were read, and whether they say that they are flat.
    pub serialized: BTreeMap<String, bool>,
    /// What was read besides the scene's files.
    pub read: Vec<(std::path::PathBuf, String, [u8; 32])>,
    /// Media of which it was told that they are left out.
    pub media: BTreeSet<usize>,
    /// How often something was told of a kind of thing.
    told: BTreeMap<(&'static str, String), usize>,
    /// Materials and textures that may still be made.
    allowed: usize,
    pub means: &'m mut Means<'a>,
}

impl<'o> Translator<'o, '_, '_> {
    /// What stands in the scene itself.
    fn whole(&mut self, root: &'o Object) {
        let mut sensors = Vec::new();
        let mut integrators = Vec::new();
        for (property, i) in root.objects() {
            let object = &self.objects[i];
            match object.class {
                Class::Shape => {
                    let nodes = self.shape(i);
                    self.scene.world.extend(nodes);
                }
                Class::Emitter => self.emitter(i),
                Class::Sensor => sensors.push(i),
                Class::Integrator => integrators.push(i),
                // What has a name is made where it is used; a look shows what is wrong with it all the same.
                Class::Bsdf | Class::Texture | Class::Medium | Class::Volume | Class::Phase => {}
                Class::Film | Class::Sampler | Class::Filter | Class::Subsurface | Class::Scene => {
                    let message =
                        format!("a {} means nothing here: it belongs into a sensor", object.class.word());
                    self.warn(property.span, message);
                }
            }
        }
        self.only(root, &[]);
        if let [_, others @ ..] = integrators.as_slice() {
            for &other in others {
                self.warn(self.objects[other].plugin.span, "a scene has one integrator: this one isn't used");
            }
        }
        match integrators.first() {
            Some(&i) => self.integrator(i),
            None => self.note(root.plugin.span, "no integrator is said: the path tracer is used"),
        }
        match sensors.as_slice() {
            [] => {
                let help = "such as `<sensor type=\"perspective\">` with a `<lookat>`";
                let complaint =
                    Diagnostic::error(root.plugin.span, "nobody looks at this scene: it has no sensor");
                self.push(complaint.help(help));
            }
            [first, others @ ..] => {
                self.sensor(*first);
                for &other in others {
                    self.warn(
                        self.objects[other].plugin.span,
                        "a picture is made by the first sensor: this one isn't used",
                    );
                }
            }
        }
    }

    /// What a property is, by its name.
    pub fn get(&self, o: &'o Object, name: &str) -> Option<&'o Property> {
        o.get(name)
    }

    /// A number; `None` where it isn't said or is none, which is told.
    pub fn float(&mut self, o: &'o Object, name: &str) -> Option<f64> {
        let property = self.get(o, name)?;
        match property.value {
            Value::Float(v) => Some(v),
            Value::Integer(v) => Some(v as f64),
            Value::Spectrum(super::tree::Numbers::Uniform(v)) => Some(v),
            _ => {
                self.wrong(property, "a number");
                None
            }
        }
    }

    /// A number within a range; what is beyond is told, and the nearest in it taken.
    pub fn within(&mut self, o: &'o Object, name: &str, absent: f64, limit: Limit) -> f64 {
        let Some(v) = self.float(o, name) else { return absent };
        let span = self.get(o, name).map_or(Span::NONE, |p| p.span);
        self.held(span, name, v, limit)
    }

    /// The nearest number in a range; what is beyond is told.
    pub fn held(&mut self, span: Span, name: &str, v: f64, limit: Limit) -> f64 {
        if limit.allows(v) {
            return v;
        }
        let tiny = 1e-6;
        let low = if limit.open { limit.min + tiny } else { limit.min };
        let high = if limit.open { limit.max - tiny } else { limit.max };
        let near = if v > low { if v < high { v } else { high } } else { low };
        let near = if near.is_finite() && (near as f32).is_finite() {
            near
        } else {
            f64::from(f32::MAX) * near.signum() * 1e-6
        };
        let near = if limit.allows(near) { near } else { low };
        let complaint = format!("{}: {near} is taken", limit.complaint(name, v));
        self.warn(span, complaint);
        near
    }

    /// A whole number.
    pub fn integer(&mut self, o: &'o Object, name: &str) -> Option<i64> {
        let property = self.get(o, name)?;
        match property.value {
            Value::Integer(v) => Some(v),
            Value::Float(v) if v.fract() == 0.0 && v.abs() < 1e15 => Some(v as i64),
            _ => {
                self.wrong(property, "a whole number");
                None
            }
        }
    }

    /// A whole number within a range.
    pub fn count(&mut self, o: &'o Object, name: &str, absent: u32, [least, most]: [u32; 2]) -> u32 {
        let Some(v) = self.integer(o, name) else { return absent };
        let held = v.clamp(i64::from(least), i64::from(most));
        if held != v {
            let span = self.get(o, name).map_or(Span::NONE, |p| p.span);
            self.warn(span, format!("`{name}` must be from {least} to {most}, found {v}: {held} is taken"));
        }
        held as u32
    }

    /// Yes or no.
    pub fn boolean(&mut self, o: &'o Object, name: &str) -> Option<bool> {
        let property = self.get(o, name)?;
        match &property.value {
            Value::Boolean(v) => Some(*v),
            Value::Text(v) if v == "true" || v == "false" => Some(v == "true"),
            _ => {
                self.wrong(property, "`true` or `false`");
                None
            }
        }
    }

    /// A text.
    pub fn text(&mut self, o: &'o Object, name: &str) -> Option<Spanned<String>> {
        let property = self.get(o, name)?;
        match &property.value {
            Value::Text(v) => Some(Spanned::new(v.clone(), property.span)),
            _ => {
                self.wrong(property, "a text");
                None
            }
        }
    }

    /// One of a few words.
    pub fn word(&mut self, o: &'o Object, name: &str, words: &[&'static str]) -> Option<&'static str> {
        let text = self.text(o, name)?;
        let found = words.iter().find(|word| word.eq_ignore_ascii_case(text.trim())).copied();
        if found.is_none() {
            let message = format!(
                "`{name}` is one of {}, found `{}`",
                suggest::list(words.iter().copied()),
                suggest::brief(&text)
            );
            let help = suggest::did_you_mean(&text, words.iter().copied());
            self.push(Diagnostic::error(text.span, message).maybe_help(help));
        }
        found
    }

    /// A place or direction.
    pub fn vector(&mut self, o: &'o Object, name: &str) -> Option<DVec3> {
        let property = self.get(o, name)?;
        match property.value {
            Value::Vector([x, y, z]) => Some(DVec3::new(x, y, z)),
            _ => {
                self.wrong(property, "a point or vector");
                None
            }
        }
    }

    /// A transform; none where it isn't said.
    pub fn transform(&mut self, o: &'o Object, name: &str) -> Affine {
        let Some(property) = self.get(o, name) else { return Affine::IDENTITY };
        match &property.value {
            Value::Transform(m) => *m,
            Value::Motion(keys) => at(keys, self.shutter()[0]),
            _ => {
                self.wrong(property, "a transform");
                Affine::IDENTITY
            }
        }
    }

    /// When the first sensor's shutter opens and closes.
    pub fn shutter(&self) -> [f64; 2] {
        let sensor = self.objects.iter().find(|o| o.class == Class::Sensor);
        ["shutter_open", "shutter_close"].map(|name| {
            match sensor.and_then(|o| o.get(name)).map(|property| &property.value) {
                Some(Value::Float(v)) => *v,
                Some(Value::Integer(v)) => *v as f64,
                _ => 0.0,
            }
        })
    }

    /// Where an object is at even times while the shutter is open; empty if it stays.
    pub fn motion(&self, o: &'o Object) -> Vec<Affine> {
        /// Between two of these times things go straight.
        const WAYS: u32 = 16;
        let Some(Value::Motion(keys)) = o.get("to_world").map(|property| &property.value) else {
            return Vec::new();
        };
        let [open, close] = self.shutter();
        let time = |i: u32| open + (close - open) * f64::from(i) / f64::from(WAYS);
        let places: Vec<Affine> = (0..=WAYS).map(|i| at(keys, time(i))).collect();
        let moves = close > open && places.iter().any(|place| *place != places[0]);
        if moves && places.iter().all(|place| place.inverse().is_some()) { places } else { Vec::new() }
    }

    /// The transform of something that is at `place` when the shutter opens.
    pub fn moving(&self, o: &'o Object, place: &Affine) -> Transform {
        let places = self.motion(o);
        match places.first().and_then(Affine::inverse) {
            Some(back) => {
                let own = place.then(&back);
                motion::transform(&places.iter().map(|place| own.then(place)).collect::<Vec<_>>())
            }
            None => super::uv::placed(place),
        }
    }

    /// That of an object to the world, which must have an inverse.
    pub fn world_of(&mut self, o: &'o Object) -> Affine {
        let m = self.transform(o, "to_world");
        if m.inverse().is_none() {
            let span = self.get(o, "to_world").map_or(o.plugin.span, |p| p.span);
            self.push(Diagnostic::error(span, "this transform has no inverse: it makes everything flat"));
            return Affine::IDENTITY;
        }
        m
    }

    /// The objects of a class in another.
    pub fn inside(&self, o: &'o Object, class: Class) -> Vec<usize> {
        let objects = self.objects;
        o.objects().filter(|(_, i)| objects[*i].class == class).map(|(_, i)| i).collect()
    }

    /// Where a file is: its name from the scene's folder.
    pub fn file(&mut self, o: &'o Object, name: &Spanned<String>) -> Option<super::search::Found> {
        let mut folders = Vec::new();
        if o.folder != 0 {
            folders.extend(self.folders.get(o.folder).cloned());
        }
        folders.extend(self.paths.iter().cloned());
        let base = self.means.base;
        match self.search.find(self.means.finder, (base, &folders), name) {
            Ok(found) => {
                if let Some(folder) = &found.told {
                    let (shown, folder) = (suggest::brief(name), suggest::brief(folder));
                    let message =
                        format!("`{shown}` isn't beside the scene: it is looked for in `{folder}` as well");
                    let span = o.get("filename").map_or(name.span, |p| p.span);
                    self.warn(span, message);
                }
                Some(found)
            }
            Err(refusal) => {
                self.refuse(name, &refusal);
                None
            }
        }
    }

    /// Tells of a file that can't be read.
    pub fn refuse(&mut self, name: &Spanned<String>, refusal: &Refusal) {
        let message = format!("cannot read `{}`: {}", suggest::brief(name), refusal.problem);
        self.push(Diagnostic::error(name.span, message).maybe_help(refusal.help.clone()));
    }

    /// A texture that may have a name of its own, made but once for each way in which it is used.
    pub fn shared_texture(
        &mut self,
        key: (usize, Uv, Role),
        make: impl FnOnce(&mut Self) -> Texture,
    ) -> TextureOf {
        let object = &self.objects[key.0];
        // What an attribute is depends on the mesh.
        let own = object.id.as_ref().filter(|_| object.plugin.as_str() != "mesh_attribute");
        let Some(id) = own else {
            let is_allowed = self.spend(object.plugin.span);
            return TextureOf::Inline(if is_allowed { make(self) } else { super::texture::grey(0.5) });
        };
        if let Some(name) = self.textures.get(&key) {
            return TextureOf::Named(Link::new(name.clone()));
        }
        if !self.spend(object.plugin.span) {
            return TextureOf::Inline(super::texture::grey(0.5));
        }
        let texture = make(self);
        let words = [key.1.word(), key.2.word()];
        let name = free_name(id, &words, |name| self.scene.textures.get(name).is_some());
        let name = Spanned::new(name, object.plugin.span);
        self.scene.textures.insert(name.clone(), texture);
        self.textures.insert(key, name.clone());
        TextureOf::Named(Link::new(name))
    }

    /// Counts something that is made, and tells once that it is too much.
    pub fn spend(&mut self, span: Span) -> bool {
        if self.allowed == 1 {
            let message = "materials and textures refer to one another in too many ways";
            self.push(Diagnostic::error(span, message));
        }
        self.allowed = self.allowed.saturating_sub(1);
        self.allowed > 0
    }

    /// Warns of properties that a plugin doesn't have, beside objects without a name.
    pub fn only(&mut self, o: &'o Object, known: &[&str]) {
        for property in &o.properties {
            let is_child = matches!(property.value, Value::Object(_));
            if property.name.is_empty() || known.contains(&property.name.as_str()) {
                continue;
            }
            let is_of_no_use = ["id", "type"].contains(&property.name.as_str());
            if is_child && known.contains(&"*") || is_of_no_use {
                continue;
            }
            let message =
                format!("`{}` has no `{}`", suggest::brief(&o.plugin), suggest::brief(&property.name));
            let help = suggest::did_you_mean(&property.name, known.iter().copied().filter(|k| *k != "*"));
            self.push(Diagnostic::warning(property.span, message).maybe_help(help));
        }
    }

    /// Tells that a plugin isn't known, or isn't supported yet; `instead` is what is taken.
    pub fn unsupported(&mut self, o: &'o Object, instead: &str) {
        let known = kinds::of(o.class);
        let (plugin, word) = (suggest::brief(&o.plugin), o.class.word());
        if known.contains(&o.plugin.value.as_str()) {
            self.warn(o.plugin.span, format!("the {word} `{plugin}` isn't supported: {instead}"));
            return;
        }
        let message = format!("Mitsuba has no {word} `{plugin}`");
        let help = suggest::did_you_mean(&o.plugin, known.iter().copied());
        let mut complaint = Diagnostic::error(o.plugin.span, message).maybe_help(help);
        if self.means.lenient {
            complaint.severity = Severity::Warning;
        }
        self.push(complaint);
    }

    /// A warning about an approximation, for each plugin at most once a word.
    pub fn alike(&mut self, what: &'static str, o: &'o Object, message: String) {
        let times = self.told.entry((what, o.plugin.value.clone())).or_default();
        *times += 1;
        if *times == 1 {
            self.warn(o.plugin.span, message);
        }
    }

    fn wrong(&mut self, property: &'o Property, wanted: &str) {
        let message = format!("`{}` must be {wanted}", suggest::brief(&property.name));
        self.push(Diagnostic::error(property.span, message));
    }

    pub fn push(&mut self, d: Diagnostic) {
        self.means.d.push(d);
    }

    pub fn fail(&mut self, span: Span, message: impl Into<String>) {
        self.push(Diagnostic::error(span, message));
    }

    pub fn warn(&mut self, span: Span, message: impl Into<String>) {
        self.push(Diagnostic::warning(span, message));
    }

    pub fn note(&mut self, span: Span, message: impl Into<String>) {
        self.push(Diagnostic::note(span, message));
    }
}

/// A name that nothing has yet.
pub(super) fn free_name(id: &str, words: &[&str], taken: impl Fn(&str) -> bool) -> String {
    let words: Vec<&str> = words.iter().copied().filter(|w| !w.is_empty()).collect();
    let plain = if words.is_empty() { id.to_owned() } else { format!("{id} ({})", words.join(", ")) };
    let mut name = plain.clone();
    let mut n = 2;
    while taken(&name) {
        name = format!("{plain} {n}");
        n += 1;
    }
    name
}

/// Where something is at a time: before the first key at its place, after the last at that.
fn at(keys: &[(f64, Affine)], time: f64) -> Affine {
    let next = keys.partition_point(|(t, _)| *t <= time);
    match (keys.get(next.wrapping_sub(1)), keys.get(next)) {
        (Some((from, a)), Some((to, b))) => motion::part(a, b, (time - from) / (to - from)),
        (Some((_, place)), None) | (None, Some((_, place))) => *place,
        (None, None) => Affine::IDENTITY,
    }
}
