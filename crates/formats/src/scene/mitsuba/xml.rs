//! From the text of one or several files to a tree of objects.
//!
//! Nothing is taken on trust: elements nest no deeper than [`DEEPEST`], files include one another no deeper than Mitsuba lets them and no more often
//! than [`MOST_FILES`], entities of the text are refused by the parser, and values put for names stay below [`MOST_PUT`] bytes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node, ParsingOptions};
use straal_math::DVec3;
use straal_scene::{Diagnostic, FileId, Span, Spanned, suggest};

use super::search::Search;
use super::tree::{Class, Numbers, Object, Property, Tree, Value};
use crate::files;
use crate::scene::Means;

/// Elements inside one another.
const DEEPEST: usize = 100;

/// Files that include one another, as in Mitsuba.
const DEEPEST_FILE: usize = 15;

/// Files in all.
const MOST_FILES: usize = 1000;

/// Bytes of one file.
const MOST_TEXT: u64 = 1 << 30;

/// Bytes that stand for names, in all.
const MOST_PUT: usize = 1 << 24;

/// Elements of one file.
const MOST_NODES: u32 = 100_000_000;

/// Bytes that a text takes while it is read, for each of its own.
const PER_BYTE: u64 = 8;

/// Reads a scene and what it includes; `None` where nothing is left to look at.
pub(super) fn read(name: &str, bytes: &[u8], means: &mut Means<'_>) -> Option<Tree> {
    let mut reader = Reader {
        tree: Tree::default(),
        defaults: means.define.clone(),
        used: BTreeSet::new(),
        ids: BTreeMap::new(),
        search: Search::default(),
        put: 0,
        count: 0,
        here: Here { file: FileId(0), folder: 0, depth: 0, is_old: false },
        means,
    };
    let folder = reader.means.base.to_owned();
    reader.file(name, bytes, folder, None)?;
    let Reader { tree, used, ids, means, .. } = reader;
    for name in means.define.keys().filter(|name| !used.contains(*name)) {
        let message = format!("nothing in this scene is called `${}`", suggest::brief(name));
        means.d.push(Diagnostic::warning(Span::NONE, message));
    }
    let mut tree = tree;
    lead(&mut tree, &ids, means);
    Some(tree)
}

/// Reads files into a tree.
pub(super) struct Reader<'m, 'a> {
    pub means: &'m mut Means<'a>,
    tree: Tree,
    /// What stands for names: what was said outside, then the first default.
    defaults: BTreeMap<String, String>,
    used: BTreeSet<String>,
    ids: BTreeMap<String, usize>,
    search: Search,
    put: usize,
    count: usize,
    here: Here,
}

/// Where reading is.
#[derive(Clone, Copy)]
struct Here {
    file: FileId,
    folder: usize,
    depth: usize,
    is_old: bool,
}

impl Reader<'_, '_> {
    /// Reads a file; what it holds becomes part of `parent`, or the scene.
    fn file(&mut self, name: &str, bytes: &[u8], folder: PathBuf, parent: Option<usize>) -> Option<()> {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let text = match std::str::from_utf8(bytes) {
            Ok(text) if bytes.len() as u64 <= MOST_TEXT => text,
            Ok(_) => {
                let message = format!("`{name}` is too large for a scene: {} bytes", bytes.len());
                self.push(Diagnostic::error(Span::NONE, message));
                return None;
            }
            Err(e) => {
                let start = String::from_utf8_lossy(&bytes[..e.valid_up_to()]).into_owned();
                let at = u32::try_from(start.len()).unwrap_or(u32::MAX);
                let file = self.means.d.sources.add(name, start);
                let span = Span { file, start: at, end: at };
                self.push(Diagnostic::error(span, "this is not a text: the file must be UTF-8"));
                return None;
            }
        };
        let length = text.len() as u64;
        let what = || format!("reading `{name}`");
        if let Some(shortage) =
            self.means.ledger.refuse(PER_BYTE * length, what, "shapes in PLY files take less than text")
        {
            self.push(Diagnostic::error(Span::NONE, shortage.to_string()).help(shortage.help()));
            self.means.d.lacks_memory = true;
            return None;
        }
        self.means.ledger.pass(PER_BYTE * length);
        self.tree.text_bytes += length;
        let file = self.means.d.sources.add(name, text);
        let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
        let document = match Document::parse_with_options(text, options) {
            Ok(document) => document,
            Err(e) => {
                self.refuse_text(file, text, &e);
                return None;
            }
        };
        let root = document.root_element();
        let folder = {
            self.tree.folders.push(folder);
            self.tree.folders.len() - 1
        };
        let outside = self.here;
        self.here = Here { file, folder, depth: outside.depth, is_old: false };
        let done = self.root(root, parent);
        self.here = outside;
        done
    }

    /// What is wrong with a text that is no XML.
    fn refuse_text(&mut self, file: FileId, text: &str, e: &roxmltree::Error) {
        let at = e.pos();
        let line =
            text.split('\n').take(at.row.saturating_sub(1) as usize).map(|l| l.len() + 1).sum::<usize>();
        let rest = text.get(line..).unwrap_or("");
        let within =
            rest.char_indices().nth(at.col.saturating_sub(1) as usize).map_or(rest.len(), |(i, _)| i);
        let at = u32::try_from((line + within).min(text.len())).unwrap_or(u32::MAX);
        let said = e.to_string();
        // The place is told beside it.
        let said = said.rsplit_once(" at ").map_or(said.as_str(), |(what, _)| what);
        let message = match e {
            roxmltree::Error::DtdDetected => {
                "a document type (`<!DOCTYPE`) isn't read, nor what it defines".to_owned()
            }
            _ => format!("this is not XML: {}", suggest::brief(said)),
        };
        self.push(Diagnostic::error(Span { file, start: at, end: at }, message));
    }

    fn root(&mut self, root: Node<'_, '_>, parent: Option<usize>) -> Option<()> {
        let is_scene = root.tag_name().name() == "scene";
        if parent.is_none() && !is_scene {
            let tag = suggest::brief(root.tag_name().name()).into_owned();
            let message = format!("this is no scene of Mitsuba: it begins with `<{tag}>`, not `<scene>`");
            self.push(Diagnostic::error(self.span(root), message));
            return None;
        }
        match root.attribute("version").map(|v| (v, v.split('.').next().unwrap_or("").parse::<u32>())) {
            Some((_, Ok(major))) => self.here.is_old = major < 2,
            Some((version, Err(_))) => {
                let message = format!("`{}` is no version", suggest::brief(version));
                self.warn(self.span_of(root, "version"), message);
            }
            None if is_scene => {
                let message = "this scene doesn't say its version: it is read as of version 3";
                self.warn(self.span(root), message);
            }
            None => {}
        }
        if !is_scene {
            if let Some(parent) = parent {
                self.element(root, parent);
            }
            return Some(());
        }
        self.only(root, &["version", "type", "id", "name"]);
        let parent = parent.unwrap_or_else(|| {
            self.tree.objects.push(Object {
                class: Class::Scene,
                plugin: Spanned::new("scene".to_owned(), self.span(root)),
                id: None,
                properties: Vec::new(),
                is_old: self.here.is_old,
                folder: self.here.folder,
            });
            self.tree.objects.len() - 1
        });
        self.children(root, parent);
        Some(())
    }

    fn children(&mut self, element: Node<'_, '_>, parent: usize) {
        if self.here.depth == DEEPEST {
            self.fail(element, format!("elements nest deeper than {DEEPEST}"));
            return;
        }
        self.here.depth += 1;
        for child in element.children() {
            if child.is_element() {
                self.element(child, parent);
            } else if child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()) {
                self.warn(self.span(child), "text between elements means nothing");
            }
        }
        self.here.depth -= 1;
    }

    /// An element that is a part of an object.
    fn element(&mut self, element: Node<'_, '_>, parent: usize) {
        let tag = element.tag_name().name();
        match tag {
            "spectrum" if element.has_attribute("type") => self.object(Class::Texture, element, parent),
            "default" => self.default_value(element),
            "include" => self.include(element, parent),
            "path" => self.path(element, parent),
            "alias" => {
                self.only(element, &["id", "as"]);
                let (Some(id), Some(other)) = (self.attribute(element, "id"), self.attribute(element, "as"))
                else {
                    return;
                };
                match self.ids.get(&id) {
                    Some(&i) => {
                        self.ids.insert(other, i);
                    }
                    None => {
                        let message = format!("nothing above is called `{}`", suggest::brief(&id));
                        self.fail_at(element, "id", message);
                    }
                }
            }
            "ref" => {
                self.only(element, &["id", "name"]);
                let Some(id) = self.attribute(element, "id") else { return };
                let name = self.name(element).unwrap_or_default();
                self.add(parent, name, Value::Reference(id), self.span_of(element, "id"));
            }
            "null" => {}
            _ => match Class::of(tag) {
                Some(Class::Scene) => self.fail(element, "a scene can't be in a scene"),
                Some(class) => self.object(class, element, parent),
                None => self.property(element, parent),
            },
        }
    }

    fn object(&mut self, class: Class, element: Node<'_, '_>, parent: usize) {
        self.only(element, &["type", "id", "name", "version"]);
        let Some(plugin) = self.attribute(element, "type") else { return };
        let plugin = Spanned::new(plugin.trim().to_owned(), self.span_of(element, "type"));
        let id = element.has_attribute("id").then(|| self.attribute(element, "id")).flatten();
        let name = self.name(element).unwrap_or_default();
        let index = self.tree.objects.len();
        if let Some(id) = &id {
            if let Some(&other) = self.ids.get(id) {
                let other = self.tree.objects[other].plugin.span;
                let message = format!("`{}` is the `id` of something already", suggest::brief(id));
                let span = self.span_of(element, "id");
                self.push(Diagnostic::error(span, message).related(other, "the other is here"));
            } else {
                self.ids.insert(id.clone(), index);
            }
        }
        let Here { is_old, folder, .. } = self.here;
        self.tree.objects.push(Object { class, plugin, id, properties: Vec::new(), is_old, folder });
        self.add(parent, name, Value::Object(index), self.span_of(element, "type"));
        self.children(element, index);
        if is_old {
            upgrade(&mut self.tree.objects[index]);
        }
    }

    fn add(&mut self, parent: usize, name: String, value: Value, span: Span) {
        let properties = &mut self.tree.objects[parent].properties;
        // Several may be without a name; of others the last counts, as in Mitsuba.
        let is_object = matches!(value, Value::Object(_) | Value::Reference(_));
        let before =
            if name.is_empty() || is_object { None } else { properties.iter().position(|p| p.name == name) };
        match before {
            Some(i) => {
                let earlier = properties[i].span;
                let message = format!("`{}` is said twice: the second counts", suggest::brief(&name));
                properties[i] = Property { name, value, span };
                self.push(Diagnostic::warning(span, message).related(earlier, "it is said here already"));
            }
            None => properties.push(Property { name, value, span }),
        }
    }

    fn property(&mut self, element: Node<'_, '_>, parent: usize) {
        let tag = element.tag_name().name();
        let value = match tag {
            "float" => {
                self.only(element, &["name", "value"]);
                self.number(element, "value").map(Value::Float)
            }
            "integer" => {
                self.only(element, &["name", "value"]);
                self.attribute(element, "value").and_then(|text| {
                    let found = text.trim().parse().ok();
                    if found.is_none() {
                        self.fail_at(
                            element,
                            "value",
                            format!("`{}` is no whole number", suggest::brief(&text)),
                        );
                    }
                    found.map(Value::Integer)
                })
            }
            "boolean" => {
                self.only(element, &["name", "value"]);
                self.attribute(element, "value").and_then(|text| {
                    match text.trim().to_ascii_lowercase().as_str() {
                        "true" => Some(Value::Boolean(true)),
                        "false" => Some(Value::Boolean(false)),
                        _ => {
                            let message =
                                format!("`{}` is neither `true` nor `false`", suggest::brief(&text));
                            self.fail_at(element, "value", message);
                            None
                        }
                    }
                })
            }
            "string" => {
                self.only(element, &["name", "value"]);
                self.attribute(element, "value").map(Value::Text)
            }
            "point" | "vector" => {
                self.only(element, &["name", "value", "x", "y", "z"]);
                self.three(element, 0.0).map(|v| Value::Vector(v.to_array()))
            }
            "rgb" | "srgb" => {
                self.only(element, &["name", "value", "intent"]);
                self.rgb(element, tag == "srgb")
            }
            "spectrum" => {
                self.only(element, &["name", "value", "filename", "intent"]);
                self.spectrum(element)
            }
            "blackbody" => {
                self.only(element, &["name", "temperature", "scale"]);
                let kelvin = self.attribute(element, "temperature").and_then(|text| {
                    let found = number(text.trim().trim_end_matches(['K', 'k']));
                    if found.is_none() {
                        let message = format!("`{}` is no temperature in kelvins", suggest::brief(&text));
                        self.fail_at(element, "temperature", message);
                    }
                    found
                });
                let scale =
                    if element.has_attribute("scale") { self.number(element, "scale") } else { Some(1.0) };
                kelvin.zip(scale).map(|(k, s)| Value::Spectrum(Numbers::BlackBody(k, s)))
            }
            "transform" => {
                self.only(element, &["name"]);
                Some(Value::Transform(self.transform(element)))
            }
            "animation" => {
                self.only(element, &["name"]);
                let mut keys = Vec::new();
                for key in element.children().filter(|c| c.is_element() && c.tag_name().name() == "transform")
                {
                    self.only(key, &["time"]);
                    let time =
                        if key.has_attribute("time") { self.number(key, "time").unwrap_or(0.0) } else { 0.0 };
                    keys.push((time, self.transform(key)));
                }
                keys.sort_by(|a: &(f64, _), b| a.0.total_cmp(&b.0));
                match keys.as_slice() {
                    [] => {
                        self.fail(element, "an `<animation>` has a `<transform>` for each of its times");
                        None
                    }
                    [(_, only)] => Some(Value::Transform(*only)),
                    _ => Some(Value::Motion(keys)),
                }
            }
            _ => {
                let known = [
                    "float",
                    "integer",
                    "boolean",
                    "string",
                    "point",
                    "vector",
                    "rgb",
                    "spectrum",
                    "transform",
                    "ref",
                    "shape",
                    "bsdf",
                    "emitter",
                    "sensor",
                    "film",
                    "sampler",
                    "rfilter",
                    "integrator",
                    "texture",
                    "medium",
                    "volume",
                    "phase",
                    "default",
                    "include",
                    "alias",
                    "path",
                ];
                let message = format!("`<{}>` is no element of a scene", suggest::brief(tag));
                let help = suggest::did_you_mean(tag, known);
                let complaint = Diagnostic::error(self.span(element), message).maybe_help(help);
                self.unknown(complaint);
                return;
            }
        };
        if !matches!(tag, "transform" | "animation")
            && let Some(child) = element.children().find(Node::is_element)
        {
            let message = format!("`<{tag}>` is a value: nothing can be in it");
            self.fail(child, message);
        }
        let Some(name) = self.name(element) else {
            if !element.has_attribute("name") {
                self.fail(element, format!("this `<{tag}>` has no `name`"));
            }
            return;
        };
        let span =
            if element.has_attribute("value") { self.span_of(element, "value") } else { self.span(element) };
        if let Some(value) = value {
            self.add(parent, name, value, span);
        }
    }

    fn rgb(&mut self, element: Node<'_, '_>, is_coded: bool) -> Option<Value> {
        let text = self.attribute(element, "value")?;
        let rgb = match numbers(&text).as_deref() {
            Some(&[v]) => Some([v; 3]),
            Some(&[r, g, b]) => Some([r, g, b]),
            _ => None,
        };
        let found = match rgb {
            Some(rgb) if is_coded => Some(rgb.map(|v| {
                let v = if v > 0.0 { v } else { 0.0 };
                if v <= 0.040_45 { v / 12.92 } else { straal_math::ops::pow_d((v + 0.055) / 1.055, 2.4) }
            })),
            None => straal_scene::value::LinearRgb::from_hex(text.trim()).map(|c| c.0),
            found => found,
        };
        if found.is_none() {
            let message = format!("`{}` is no colour: it has three numbers, or one", suggest::brief(&text));
            self.fail_at(element, "value", message);
        }
        found.map(Value::Rgb)
    }

    fn spectrum(&mut self, element: Node<'_, '_>) -> Option<Value> {
        let numbers = match (element.has_attribute("value"), element.has_attribute("filename")) {
            (false, true) => Numbers::File(self.attribute(element, "filename")?),
            (true, false) => {
                let text = self.attribute(element, "value")?;
                let found = table(&text);
                if found.is_none() {
                    let message = format!(
                        "`{}` is no spectrum: it has a number, or `wavelength:value` pairs",
                        suggest::brief(&text)
                    );
                    self.fail_at(element, "value", message);
                }
                found?
            }
            _ => {
                self.fail(element, "a spectrum has a `value` or a `filename`");
                return None;
            }
        };
        Some(Value::Spectrum(numbers))
    }

    fn default_value(&mut self, element: Node<'_, '_>) {
        self.only(element, &["name", "value"]);
        let (Some(name), Some(value)) = (self.attribute(element, "name"), self.attribute(element, "value"))
        else {
            return;
        };
        if name.is_empty() {
            self.fail_at(element, "name", "a default needs a name");
        } else {
            self.defaults.entry(name).or_insert(value);
        }
    }

    fn path(&mut self, element: Node<'_, '_>, parent: usize) {
        self.only(element, &["value"]);
        let Some(value) = self.attribute(element, "value") else { return };
        if parent != 0 {
            self.warn(self.span(element), "`<path>` counts for the whole scene wherever it stands");
        }
        let folder = self.tree.folders[self.here.folder].join(value);
        self.tree.paths.push(folder);
    }

    fn include(&mut self, element: Node<'_, '_>, parent: usize) {
        self.only(element, &["filename", "name"]);
        let Some(name) = self.attribute(element, "filename") else { return };
        let span = self.span_of(element, "filename");
        let cycle = self.here.depth >= DEEPEST;
        self.count += 1;
        if self.count > MOST_FILES || cycle {
            let message = format!("more than {MOST_FILES} files are included, or one includes itself");
            self.push(Diagnostic::error(span, message));
            return;
        }
        let mut folders = vec![self.tree.folders[self.here.folder].clone()];
        folders.extend(self.tree.paths.iter().cloned());
        let base = self.means.base;
        let read = self.search.find(self.means.finder, (base, &folders), &name).and_then(|found| {
            let bytes = files::read(&found.path, self.means.limits.max_bytes)?;
            Ok((found, bytes))
        });
        match read {
            Ok((found, bytes)) => {
                self.tree.files.push((found.path.clone(), found.name.clone(), blake3::hash(&bytes).into()));
                let folder = found.path.parent().unwrap_or(Path::new("")).to_owned();
                // A file inside another counts for as many elements as make the deepest chain of files end in time.
                let step = DEEPEST.div_ceil(DEEPEST_FILE);
                self.here.depth += step;
                let shown = found.path.display().to_string();
                let _ = self.file(&shown, &bytes, folder, Some(parent));
                self.here.depth -= step;
            }
            Err(refusal) => {
                let message = format!("cannot include `{}`: {}", suggest::brief(&name), refusal.problem);
                self.push(Diagnostic::error(span, message).maybe_help(refusal.help));
            }
        }
    }

    /// The name of a property in its present form.
    fn name(&mut self, element: Node<'_, '_>) -> Option<String> {
        let name = element.has_attribute("name").then(|| self.attribute(element, "name")).flatten()?;
        Some(if self.here.is_old { snake(&name) } else { name })
    }

    /// An attribute, with what stands for names in it; its absence is told.
    pub fn attribute(&mut self, element: Node<'_, '_>, name: &str) -> Option<String> {
        let Some(text) = element.attribute(name) else {
            let tag = suggest::brief(element.tag_name().name()).into_owned();
            self.fail(element, format!("this `<{tag}>` has no `{name}`"));
            return None;
        };
        if !text.contains('$') {
            return Some(text.to_owned());
        }
        let mut out = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('$') {
            if let Some(before) = before.strip_suffix('\\') {
                out.push_str(before);
                out.push('$');
                rest = after;
                continue;
            }
            out.push_str(before);
            // The longest name that is known counts, as there.
            let known = self.defaults.keys().filter(|key| after.starts_with(key.as_str()));
            let Some(key) = known.max_by_key(|key| key.len()).cloned() else {
                let end = after.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(after.len());
                let wanted = &after[..end];
                let message = format!("nothing says what `${}` is", suggest::brief(wanted));
                let help = suggest::did_you_mean(wanted, self.defaults.keys().map(String::as_str))
                    .unwrap_or_else(|| {
                        "say it by `-D name=value`, or by `<default name=\"...\" value=\"...\"/>`".to_owned()
                    });
                self.push(Diagnostic::error(self.span_of(element, name), message).help(help));
                return None;
            };
            let value = &self.defaults[&key];
            self.put = self.put.saturating_add(value.len());
            if self.put > MOST_PUT {
                self.fail_at(element, name, "what stands for names in this scene is too long");
                return None;
            }
            out.push_str(value);
            rest = &after[key.len()..];
            self.used.insert(key);
        }
        out.push_str(rest);
        Some(out)
    }

    /// A number; what is none is told.
    pub fn number(&mut self, element: Node<'_, '_>, name: &str) -> Option<f64> {
        let text = self.attribute(element, name)?;
        let found = number(&text);
        if found.is_none() {
            self.fail_at(element, name, format!("`{}` is no number", suggest::brief(&text)));
        }
        found
    }

    /// Three numbers in one attribute.
    pub fn vector(&mut self, element: Node<'_, '_>, name: &str) -> Option<DVec3> {
        let text = self.attribute(element, name)?;
        match numbers(&text).as_deref() {
            Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
            _ => {
                self.fail_at(element, name, format!("`{}` is not three numbers", suggest::brief(&text)));
                None
            }
        }
    }

    /// Three numbers in `value`, or in `x`, `y` and `z`, of which those that are absent are `absent`.
    pub fn three(&mut self, element: Node<'_, '_>, absent: f64) -> Option<DVec3> {
        if element.has_attribute("value") {
            let text = self.attribute(element, "value")?;
            return match numbers(&text).as_deref() {
                Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
                Some(&[v]) => Some(DVec3::splat(v)),
                _ => {
                    self.fail_at(
                        element,
                        "value",
                        format!("`{}` is not three numbers", suggest::brief(&text)),
                    );
                    None
                }
            };
        }
        let mut all = [absent; 3];
        for (v, name) in all.iter_mut().zip(["x", "y", "z"]) {
            if element.has_attribute(name) {
                *v = self.number(element, name)?;
            }
        }
        Some(DVec3::new(all[0], all[1], all[2]))
    }

    /// Warns of attributes that an element doesn't have.
    pub fn only(&mut self, element: Node<'_, '_>, known: &[&str]) {
        for attribute in element.attributes() {
            if !known.contains(&attribute.name()) {
                let tag = element.tag_name().name();
                let message = format!(
                    "`<{}>` has no attribute `{}`",
                    suggest::brief(tag),
                    suggest::brief(attribute.name())
                );
                let help = suggest::did_you_mean(attribute.name(), known.iter().copied());
                let span = self.at(attribute.range());
                self.push(Diagnostic::warning(span, message).maybe_help(help));
            }
        }
    }

    /// Where an element begins.
    pub fn span(&self, element: Node<'_, '_>) -> Span {
        let range = element.range();
        // The tag alone, not all that is in it.
        let end =
            if element.is_element() { range.start + 1 + element.tag_name().name().len() } else { range.end };
        self.at(range.start..end)
    }

    /// Where an attribute's value is; else the element.
    pub fn span_of(&self, element: Node<'_, '_>, name: &str) -> Span {
        match element.attribute_node(name) {
            Some(attribute) => self.at(attribute.range_value()),
            None => self.span(element),
        }
    }

    fn at(&self, range: std::ops::Range<usize>) -> Span {
        let [start, end] = [range.start, range.end].map(|i| u32::try_from(i).unwrap_or(u32::MAX));
        Span { file: self.here.file, start, end: end.max(start) }
    }

    pub fn push(&mut self, d: Diagnostic) {
        self.means.d.push(d);
    }

    pub fn fail(&mut self, element: Node<'_, '_>, message: impl Into<String>) {
        self.push(Diagnostic::error(self.span(element), message));
    }

    pub fn fail_at(&mut self, element: Node<'_, '_>, name: &str, message: impl Into<String>) {
        self.push(Diagnostic::error(self.span_of(element, name), message));
    }

    fn warn(&mut self, span: Span, message: impl Into<String>) {
        self.push(Diagnostic::warning(span, message));
    }

    /// Something that nobody knows: an error, or a warning to who is lenient.
    fn unknown(&mut self, mut complaint: Diagnostic) {
        if self.means.lenient {
            complaint.severity = straal_scene::Severity::Warning;
        }
        self.push(complaint);
    }
}

/// Leads references to what they name; those that lead nowhere, or back to where they stand, are told and taken away.
fn lead(tree: &mut Tree, ids: &BTreeMap<String, usize>, means: &mut Means<'_>) {
    for object in &mut tree.objects {
        object.properties.retain_mut(|property| {
            let Value::Reference(id) = &property.value else { return true };
            if let Some(&i) = ids.get(id) {
                property.value = Value::Object(i);
                return true;
            }
            let message = format!("nothing is called `{}`", suggest::brief(id));
            let help = suggest::did_you_mean(id, ids.keys().map(String::as_str));
            means.d.push(Diagnostic::error(property.span, message).maybe_help(help));
            false
        });
    }
    cut_cycles(tree, means);
}

/// Walks the tree from every object that wasn't met yet, without recursion: references may make a chain as long as the file.
fn cut_cycles(tree: &mut Tree, means: &mut Means<'_>) {
    #[derive(Clone, Copy, PartialEq)]
    enum Met {
        Never,
        Open,
        Done,
    }
    let mut met = vec![Met::Never; tree.objects.len()];
    // Of what is done: how many objects inside one another it is.
    let mut height = vec![0_usize; tree.objects.len()];
    for first in 0..tree.objects.len() {
        if met[first] != Met::Never {
            continue;
        }
        let mut open = vec![(first, 0)];
        met[first] = Met::Open;
        while let Some((object, next)) = open.last_mut() {
            let (at, i) = (*object, *next);
            let Some(property) = tree.objects[at].properties.get(i) else {
                met[at] = Met::Done;
                height[at] =
                    1 + tree.objects[at].objects().map(|(_, inner)| height[inner]).max().unwrap_or(0);
                if height[at] > DEEPEST {
                    let span = tree.objects[at].plugin.span;
                    let message = format!(
                        "by its references this is made of more than {DEEPEST} objects inside one another"
                    );
                    means.d.push(Diagnostic::error(span, message));
                    tree.objects[at].properties.clear();
                    height[at] = 1;
                }
                open.pop();
                continue;
            };
            *next += 1;
            let Value::Object(inner) = property.value else { continue };
            match met[inner] {
                Met::Done => {}
                Met::Never => {
                    met[inner] = Met::Open;
                    open.push((inner, 0));
                }
                Met::Open => {
                    let name = tree.objects[inner].id.clone().unwrap_or_default();
                    let message = format!("`{}` is a part of itself", suggest::brief(&name));
                    means.d.push(Diagnostic::error(property.span, message));
                    tree.objects[at].properties.remove(i);
                    *next -= 1;
                }
            }
        }
    }
}

/// Names of versions before 2 in their present form, as Mitsuba 3 does it.
fn upgrade(object: &mut Object) {
    let is_diffuse = object.plugin.value == "diffuse";
    for property in &mut object.properties {
        if is_diffuse && property.name == "diffuse_reflectance" {
            property.name = "reflectance".to_owned();
        }
    }
    let factor = |name: &str| match object.get(name).map(|p| (&p.value, p.span)) {
        Some((Value::Float(v), span)) => Some((*v, span)),
        Some((Value::Integer(v), span)) => Some((*v as f64, span)),
        _ => None,
    };
    let said = ["uscale", "vscale", "uoffset", "voffset"].map(factor);
    if let Some((_, span)) = said.iter().flatten().next().copied() {
        let [su, sv, ou, ov] = said;
        let of = |v: Option<(f64, Span)>, absent: f64| v.map_or(absent, |(v, _)| v);
        let scale = straal_math::Affine::scale(DVec3::new(of(su, 1.0), of(sv, 1.0), 1.0));
        let offset = straal_math::Affine::translate(DVec3::new(of(ou, 0.0), of(ov, 0.0), 0.0));
        object.properties.retain(|p| !["uscale", "vscale", "uoffset", "voffset"].contains(&p.name.as_str()));
        let value = Value::Transform(offset.then(&scale));
        object.properties.push(Property { name: "to_uv".to_owned(), value, span });
    }
}

/// `fooBar` and `fooBAR` as `foo_bar`.
fn snake(name: &str) -> String {
    let mut out = String::with_capacity(name.len() + 4);
    let mut after_lower = false;
    let mut within = false;
    for c in name.chars() {
        if c.is_ascii_uppercase() && (after_lower || within) {
            if after_lower {
                out.push('_');
            }
            out.push(c.to_ascii_lowercase());
            within = true;
            after_lower = false;
        } else {
            out.push(c);
            after_lower = c.is_ascii_lowercase();
            within = false;
        }
    }
    out
}

/// A number as Mitsuba reads it.
pub(super) fn number(text: &str) -> Option<f64> {
    let text = text.trim();
    let text = text
        .strip_suffix(['f', 'F'])
        .filter(|t| t.ends_with(|c: char| c.is_ascii_digit() || c == '.'))
        .unwrap_or(text);
    let is_number = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    text.parse::<f64>().ok().filter(|v| v.is_finite() && is_number)
}

/// Numbers parted by spaces and commas.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()).map(number).collect()
}

/// A spectrum of one number, or of pairs.
pub(super) fn table(text: &str) -> Option<Numbers> {
    if !text.contains(':') {
        return match numbers(text)?[..] {
            [v] => Some(Numbers::Uniform(v)),
            _ => None,
        };
    }
    let (mut wavelengths, mut values) = (Vec::new(), Vec::new());
    for word in text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()) {
        let (nm, value) = word.split_once(':')?;
        wavelengths.push(number(nm)?);
        values.push(number(value)?);
    }
    Some(Numbers::Table(wavelengths, values))
}
