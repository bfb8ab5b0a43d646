//! Files that are read: layers, and the packages that they may be in.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::rc::Rc;

use straal_scene::{Diagnostic, Span};

use super::archive::{self, Archive};
use super::layer::{Layer, Offset};
use super::{crate_file, document, text};
use crate::files;
use crate::scene::Means;

/// The longest text of a layer, in bytes: places in texts have 32 bits.
const MOST_TEXT: usize = 1 << 31;

/// Layers within layers, at most.
const MOST_LAYERS: usize = 10_000;

/// Bytes that reading takes for each byte of a file: the file itself, and what comes of it.
const BYTES: [u64; 2] = [8, 3];

/// A layer, and where it is.
pub(super) struct Held {
    pub layer: Layer,
    pub home: Home,
    /// The layers of its own stack, strongest first, once they were asked for.
    stack: Option<usize>,
}

/// Where a layer's names of files begin.
#[derive(Clone, Debug)]
pub(super) struct Home {
    /// Its folder, from that of the scene or within its package.
    folder: String,
    /// Its package.
    package: Option<usize>,
}

/// What a name of a file leads to.
pub(super) enum Place {
    /// A file, by its name from the scene's folder.
    File(String),
    /// Bytes of a package, and what they are called.
    Packed { package: usize, range: Range<usize>, name: String },
}

/// All that was read.
pub(super) struct Library<'m, 'a> {
    pub means: &'m mut Means<'a>,
    pub layers: Vec<Held>,
    /// Stacks of layers: each with the offset of its times.
    pub stacks: Vec<Vec<(usize, Offset)>>,
    pub packages: Vec<Archive>,
    /// Layers by the names of their files.
    known: BTreeMap<String, Option<usize>>,
    /// What was read besides the scene's own file.
    pub files: Vec<(PathBuf, String, [u8; 32])>,
}

impl<'m, 'a> Library<'m, 'a> {
    /// With the scene's own file as the first layer; nothing after a complaint.
    pub fn open(name: &str, bytes: &[u8], means: &'m mut Means<'a>) -> Option<Self> {
        let mut library = Self {
            means,
            layers: Vec::new(),
            stacks: Vec::new(),
            packages: Vec::new(),
            known: BTreeMap::new(),
            files: Vec::new(),
        };
        let home = Home { folder: String::new(), package: None };
        library.read(name, bytes.into(), home)?;
        Some(library)
    }

    fn fail(&mut self, message: String) {
        self.means.d.push(Diagnostic::error(Span::NONE, message));
    }

    /// A file that isn't there, or can't be read: an error, as a picture without it would be another.
    fn missing(&mut self, message: String) {
        let complaint = if self.means.lenient {
            Diagnostic::warning(Span::NONE, message)
        } else {
            Diagnostic::error(Span::NONE, message)
                .help("`--lenient` goes on without what another file should bring")
        };
        self.means.d.push(complaint);
    }

    /// Takes the memory that a file's content needs; where there isn't as much, it is an error.
    fn take(&mut self, name: &str, needs: u64) -> Option<()> {
        let shortage =
            self.means.ledger.refuse(needs, || format!("reading `{name}`"), "a smaller scene takes less");
        if let Some(shortage) = shortage {
            self.means.d.lacks_memory = true;
            self.fail(format!("cannot read `{name}`: {shortage}"));
            return None;
        }
        self.means.ledger.keep(needs);
        Some(())
    }

    /// Reads the bytes of a file as a layer.
    fn read(&mut self, name: &str, bytes: Rc<[u8]>, home: Home) -> Option<usize> {
        let is_text = !bytes.starts_with(archive::MAGIC) && !bytes.starts_with(crate_file::MAGIC);
        let needs = BYTES[usize::from(!is_text)] * bytes.len() as u64;
        self.take(name, needs)?;
        if !bytes.starts_with(archive::MAGIC) {
            let range = 0..bytes.len();
            return self.read_layer(name, bytes, range, home);
        }
        let package = self.packages.len();
        let archive = match Archive::open(bytes) {
            Ok(archive) => archive,
            Err(problem) => {
                self.fail(format!("cannot read `{name}`: {problem}"));
                return None;
            }
        };
        let first = archive.first().cloned();
        self.packages.push(archive);
        let Some((entry, range)) = first else {
            self.fail(format!("cannot read `{name}`: the package is empty"));
            return None;
        };
        self.packed_layer(package, (&entry, range))
    }

    fn packed_layer(&mut self, package: usize, (entry, range): (&str, Range<usize>)) -> Option<usize> {
        let bytes = Rc::clone(&self.packages[package].bytes);
        let home = Home { folder: folder(entry), package: Some(package) };
        if bytes[range.clone()].starts_with(archive::MAGIC) {
            self.fail(format!("`{entry}` is a package in a package, which isn't read"));
            return None;
        }
        self.read_layer(entry, bytes, range, home)
    }

    fn read_layer(&mut self, name: &str, bytes: Rc<[u8]>, range: Range<usize>, home: Home) -> Option<usize> {
        let own = &bytes[range.clone()];
        let layer = if own.starts_with(crate_file::MAGIC) {
            match crate_file::read(Rc::clone(&bytes), range) {
                Ok((layer, file)) => Layer { file: Some(file), ..layer },
                Err(problem) => {
                    self.fail(format!("cannot read `{name}`: {problem}"));
                    return None;
                }
            }
        } else {
            let Ok(words) = std::str::from_utf8(own) else {
                self.fail(format!("cannot read `{name}`: it is no layer of USD, neither text nor binary"));
                return None;
            };
            if words.len() > MOST_TEXT {
                self.fail(format!("cannot read `{name}`: its text is too long: {} bytes", words.len()));
                return None;
            }
            let made = if document::is_one(words) { Some(self.of_document(name, words)?) } else { None };
            match text::read(made.as_deref().unwrap_or(words)) {
                Ok(layer) => layer,
                Err(wrong) => {
                    let file = self.means.d.sources.add(name, words);
                    let at = wrong.at.min(words.len()) as u32;
                    self.means.d.push(Diagnostic::error(Span { file, start: at, end: at }, wrong.problem));
                    return None;
                }
            }
        };
        self.layers.push(Held { layer, home, stack: None });
        Some(self.layers.len() - 1)
    }

    /// What a document of MaterialX says, as the text of a layer; nothing after a complaint.
    fn of_document(&mut self, name: &str, words: &str) -> Option<String> {
        let made = match document::as_layer(words) {
            Ok(made) => made,
            Err(wrong) => {
                let file = self.means.d.sources.add(name, words);
                let at = wrong.at.min(words.len()) as u32;
                self.means.d.push(Diagnostic::error(Span { file, start: at, end: at }, wrong.problem));
                return None;
            }
        };
        let needs = BYTES[1] * made.len() as u64;
        self.take(name, needs)?;
        Some(made)
    }

    /// What a name that a layer says leads to; nothing where there is no such file.
    pub fn place(&mut self, layer: usize, name: &str) -> Option<Place> {
        let home = self.layers[layer].home.clone();
        // A file within a package that is told by name.
        let (name, within) = match name.strip_suffix(']').and_then(|name| name.split_once('[')) {
            Some((package, within)) => (package, Some(within)),
            None => (name, None),
        };
        let name = name.replace('\\', "/");
        if let Some(package) = home.package {
            let entry = within.map_or(name.as_str(), |within| within);
            let candidates = [archive::inside(&home.folder, entry), archive::inside("", entry)];
            let archive = &self.packages[package];
            let found =
                candidates.into_iter().flatten().find_map(|name| Some((archive.find(&name)?, name)))?;
            return Some(Place::Packed { package, range: found.0, name: found.1 });
        }
        let beside = if name.starts_with('/') || home.folder.is_empty() {
            name.clone()
        } else {
            format!("{}/{}", home.folder, name.trim_start_matches("./"))
        };
        // A name that doesn't begin with a dot may be told from the scene's folder as well.
        let is_anchored = name.starts_with(['.', '/']);
        let candidates = [Some(beside), Some(name).filter(|_| !is_anchored)];
        let base = self.means.base;
        let found =
            candidates.into_iter().flatten().find(|name| self.means.finder.find(base, name).is_ok())?;
        let Some(within) = within else { return Some(Place::File(found)) };
        let root = self.layer_of_file(&found)?;
        let package = self.layers[root].home.package?;
        let range = self.packages[package].find(within)?;
        Some(Place::Packed { package, range, name: within.to_owned() })
    }

    /// The layer of a file, from the scene's folder.
    fn layer_of_file(&mut self, name: &str) -> Option<usize> {
        if let Some(known) = self.known.get(name) {
            return *known;
        }
        self.known.insert(name.to_owned(), None);
        if self.layers.len() > MOST_LAYERS {
            self.fail(format!("too many layers: {MOST_LAYERS} are read"));
            return None;
        }
        let most = self.means.limits.max_bytes;
        let found = self.means.finder.find(self.means.base, name);
        let bytes = found.and_then(|found| Ok((files::read_archive(&found.path, most)?, found.path)));
        let (bytes, path) = match bytes {
            Ok(read) => read,
            Err(refusal) => {
                self.missing(format!("cannot read `{name}`: {refusal}"));
                return None;
            }
        };
        self.files.push((path, name.to_owned(), blake3::hash(&bytes).into()));
        let home = Home { folder: folder(name), package: None };
        let layer = self.read(name, bytes.into(), home);
        self.known.insert(name.to_owned(), layer);
        layer
    }

    /// The layer that a name in another leads to; nothing after a complaint.
    pub fn layer(&mut self, from: usize, name: &str) -> Option<usize> {
        match self.place(from, name) {
            Some(Place::File(name)) => self.layer_of_file(&name),
            Some(Place::Packed { package, range, name }) => {
                let key = format!("{package}[{name}]");
                if let Some(known) = self.known.get(&key) {
                    return *known;
                }
                self.known.insert(key.clone(), None);
                let layer = self.packed_layer(package, (&name, range));
                self.known.insert(key, layer);
                layer
            }
            None => {
                let key = format!("?{name}");
                if self.known.insert(key, None).is_none() {
                    self.missing(format!("there is no file `{}`", straal_scene::suggest::brief(name)));
                }
                None
            }
        }
    }

    /// The stack of a layer: itself, and those that it is made of.
    pub fn stack(&mut self, layer: usize) -> usize {
        if let Some(known) = self.layers[layer].stack {
            return known;
        }
        let mut stack = Vec::new();
        self.stacked(layer, Offset::default(), &mut Vec::new(), &mut stack);
        self.stacks.push(stack);
        let index = self.stacks.len() - 1;
        self.layers[layer].stack = Some(index);
        index
    }

    fn stacked(
        &mut self,
        layer: usize,
        offset: Offset,
        within: &mut Vec<usize>,
        stack: &mut Vec<(usize, Offset)>,
    ) {
        /// Layers in layers so deep, and so many of one stack.
        const MOST: [usize; 2] = [64, 1000];
        if within.contains(&layer) || within.len() > MOST[0] || stack.len() > MOST[1] {
            self.fail("a layer is a part of itself, or of too many others".to_owned());
            return;
        }
        within.push(layer);
        stack.push((layer, offset));
        for (name, inner) in self.layers[layer].layer.sub_layers.clone() {
            if let Some(sub) = self.layer(layer, &name) {
                self.stacked(sub, offset.around(&inner), within, stack);
            }
        }
        within.pop();
    }
}

/// The folder of a file; empty for none.
fn folder(name: &str) -> String {
    name.rsplit_once('/').map_or(String::new(), |(folder, _)| folder.to_owned())
}
