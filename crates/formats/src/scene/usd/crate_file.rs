//! Layers in binary (.usdc): tables of tokens, fields and paths, and values that are read where they are asked for.
//!
//! The layout is that of versions 0.4 and later (2016), as the USD Core Specification 1.0.1 tells it in its section 16.3.

mod values;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

use self::values::numbers_of;
use super::layer::{
    DEEPEST, Edit, Edits, LONGEST, Layer, Numbers, Offset, Reference, Spec, Specifier, Value, join,
};
use super::packed::{integers, unpack};

/// What is wrong with a file.
type Result<T> = std::result::Result<T, String>;

/// How files begin.
pub(super) const MAGIC: &[u8] = b"PXR-USDC";

/// Where a value is, and of which kind: the eight bytes that a field has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Rep(u64);

impl Rep {
    fn is_array(self) -> bool {
        self.0 >> 63 & 1 == 1
    }
    fn is_inlined(self) -> bool {
        self.0 >> 62 & 1 == 1
    }
    fn is_packed(self) -> bool {
        self.0 >> 61 & 1 == 1
    }
    fn kind(self) -> u8 {
        (self.0 >> 48) as u8
    }
    fn payload(self) -> u64 {
        self.0 & ((1 << 48) - 1)
    }
}

/// A file whose tables were read.
#[derive(Debug)]
pub(super) struct File {
    bytes: Rc<[u8]>,
    range: Range<usize>,
    version: [u8; 3],
    tokens: Vec<String>,
    strings: Vec<u32>,
    fields: Vec<(u32, Rep)>,
    paths: Vec<String>,
    /// Values that were read, so that those that share their bytes share their memory.
    known: RefCell<BTreeMap<Rep, Value>>,
    /// How many numbers may still be made.
    room: RefCell<usize>,
}

/// Bytes as they are read one after the other.
struct Cursor<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Cursor<'b> {
    fn take(&mut self, count: usize) -> Result<&'b [u8]> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let end = end.ok_or("it ends too early, or points beyond its end")?;
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32> {
        Ok(self.take(4)?.iter().rev().fold(0, |v, b| v << 8 | u32::from(*b)))
    }

    fn u64(&mut self) -> Result<u64> {
        Ok(self.take(8)?.iter().rev().fold(0, |v, b| v << 8 | u64::from(*b)))
    }

    /// How many things follow, of so many bytes each at least.
    fn count(&mut self, each: usize) -> Result<usize> {
        let count = self.u64()?;
        let fits = usize::try_from(count).ok().filter(|n| n.saturating_mul(each) <= self.bytes.len());
        fits.ok_or_else(|| format!("it tells of {count} things, more than it has room for"))
    }

    /// Packed bytes, whose size stands before them.
    fn packed(&mut self) -> Result<&'b [u8]> {
        let size = self.count(1)?;
        self.take(size)
    }

    /// Goes to where the number at the place leads, counted from the place.
    fn follow(&mut self) -> Result<()> {
        let start = self.at as u64;
        let to = start.wrapping_add(self.u64()?);
        self.at = usize::try_from(to).map_err(|_| "it points beyond its end")?;
        Ok(())
    }
}

/// Reads the tables of a file, and what they say but for values.
pub(super) fn read(bytes: Rc<[u8]>, range: Range<usize>) -> Result<(Layer, File)> {
    let all = &bytes[range.clone()];
    let version = match all.get(8..11) {
        Some(v) if all.starts_with(MAGIC) => [v[0], v[1], v[2]],
        _ => return Err("it is no file of this format".to_owned()),
    };
    if version[0] != 0 || version < [0, 4, 0] || version[1] > 13 {
        let [a, b, c] = version;
        return Err(format!("it is of version {a}.{b}.{c}, of which those from 0.4.0 on are read"));
    }
    // Small files of much repetition are ordinary; gigabytes out of kilobytes aren't.
    let room = all.len().saturating_mul(64).max(1 << 22);
    let mut file = File {
        range: range.clone(),
        version,
        tokens: Vec::new(),
        strings: Vec::new(),
        fields: Vec::new(),
        paths: Vec::new(),
        known: RefCell::new(BTreeMap::new()),
        room: RefCell::new(room),
        bytes: Rc::clone(&bytes),
    };
    let mut toc = Cursor { bytes: all, at: 16 };
    toc.at = usize::try_from(toc.u64()?).map_err(|_| "it points beyond its end")?;
    let mut sections = BTreeMap::new();
    for _ in 0..toc.count(32)?.min(64) {
        let name = toc.take(16)?;
        let name = name.split(|b| *b == 0).next().unwrap_or(name);
        let (start, size) = (toc.u64()?, toc.u64()?);
        let range = usize::try_from(start).ok().zip(usize::try_from(size).ok());
        let range = range.and_then(|(start, size)| Some(start..start.checked_add(size)?));
        let range = range.filter(|r| r.end <= all.len()).ok_or("a part of it lies beyond its end")?;
        sections.insert(name, range);
    }
    let section = |name: &str| {
        let range = sections.get(name.as_bytes()).cloned().unwrap_or(0..0);
        Cursor { bytes: &all[..range.end], at: range.start }
    };
    let mut at = section("TOKENS");
    if at.at < at.bytes.len() {
        let (count, size) = (at.u64()?, at.u64()?);
        let size = usize::try_from(size).ok().filter(|s| *s <= room).ok_or("its tokens are too long")?;
        let text = unpack(at.packed()?, size).ok_or("its tokens can't be unpacked")?;
        let tokens = text.split(|b| *b == 0).map(|t| String::from_utf8_lossy(t).into_owned());
        file.tokens = tokens.take(usize::try_from(count).unwrap_or(0)).collect();
    }
    let mut at = section("STRINGS");
    if at.at < at.bytes.len() {
        for _ in 0..at.count(4)? {
            file.strings.push(at.u32()?);
        }
    }
    let mut at = section("FIELDS");
    if at.at < at.bytes.len() {
        let count = file.table(at.u64()?)?;
        let tokens = file.ints(&mut at, count)?;
        let reps = unpack(at.packed()?, count * 8).filter(|r| r.len() == count * 8);
        let reps = reps.ok_or("its fields can't be unpacked")?;
        let reps = reps.chunks_exact(8).map(|r| Rep(r.iter().rev().fold(0, |v, b| v << 8 | u64::from(*b))));
        file.fields = tokens.into_iter().map(|t| t as u32).zip(reps).collect();
    }
    let mut at = section("FIELDSETS");
    let mut sets = Vec::new();
    if at.at < at.bytes.len() {
        let count = file.table(at.u64()?)?;
        sets = file.ints(&mut at, count)?;
    }
    let mut at = section("PATHS");
    if at.at < at.bytes.len() {
        file.read_paths(&mut at, room)?;
    }
    let layer = file.specs(&mut section("SPECS"), &sets, room)?;
    Ok((layer, file))
}

impl File {
    fn all(&self) -> &[u8] {
        &self.bytes[self.range.clone()]
    }

    /// The length of a table, which packed numbers have to prove.
    fn table(&self, count: u64) -> Result<usize> {
        let most = self.room.borrow().min(self.all().len().saturating_mul(1024));
        let fits = usize::try_from(count).ok().filter(|n| *n <= most);
        fits.ok_or_else(|| format!("it tells of {count} things, more than it has room for"))
    }

    /// So many packed whole numbers of four bytes.
    fn ints(&self, at: &mut Cursor<'_>, count: usize) -> Result<Vec<i64>> {
        self.packed_ints(at, count, false)
    }

    fn packed_ints(&self, at: &mut Cursor<'_>, count: usize, wide: bool) -> Result<Vec<i64>> {
        let most = 16 + count.saturating_mul(9);
        let bytes = unpack(at.packed()?, most).ok_or("its numbers can't be unpacked")?;
        integers(&bytes, count, wide).ok_or_else(|| "its numbers can't be unpacked".to_owned())
    }

    fn read_paths(&mut self, at: &mut Cursor<'_>, room: usize) -> Result<()> {
        let places = self.table(at.u64()?)?;
        let count = self.table(at.u64()?)?;
        let indices = self.ints(at, count)?;
        let elements = self.ints(at, count)?;
        let jumps = self.ints(at, count)?;
        self.paths = vec![String::new(); places];
        // Each place of the tree is met once, so that it ends.
        let mut met = vec![false; count];
        let mut open: Vec<(usize, Option<usize>, usize)> = vec![(0, None, 0)];
        let mut length = 0;
        while let Some((start, mut parent, mut depth)) = open.pop() {
            let mut here = start;
            loop {
                if here >= count || std::mem::replace(&mut met[here], true) || depth > 2 * DEEPEST {
                    return Err("its tree of paths is damaged".to_owned());
                }
                let place = usize::try_from(indices[here]).ok().filter(|i| *i < places);
                let place = place.ok_or("its tree of paths is damaged")?;
                let path = match parent {
                    None => "/".to_owned(),
                    Some(parent) => self.path_in(&self.paths[parent], elements[here])?,
                };
                length += path.len();
                if path.len() > LONGEST || length > room {
                    return Err("its paths are too long".to_owned());
                }
                self.paths[place] = path;
                let jump = jumps[here];
                let has_child = jump > 0 || jump == -1;
                if jump >= 0 && has_child {
                    let sibling = usize::try_from(jump).ok().and_then(|jump| here.checked_add(jump));
                    open.push((sibling.ok_or("its tree of paths is damaged")?, parent, depth));
                }
                if has_child {
                    parent = Some(place);
                    depth += 1;
                } else if jump < 0 {
                    break;
                }
                here += 1;
            }
        }
        Ok(())
    }

    /// A path in another; a property's element is told below 0.
    fn path_in(&self, parent: &str, element: i64) -> Result<String> {
        let token = usize::try_from(element.unsigned_abs()).ok().and_then(|i| self.tokens.get(i));
        let token = token.ok_or("a path has no name")?;
        Ok(if element < 0 {
            format!("{parent}.{token}")
        } else if token.starts_with(['{', '[']) {
            format!("{parent}{token}")
        } else {
            join(parent, token)
        })
    }

    fn token(&self, index: u64) -> Result<&str> {
        let token = usize::try_from(index).ok().and_then(|i| self.tokens.get(i));
        token.map(String::as_str).ok_or_else(|| "a word is missing".to_owned())
    }

    fn string(&self, index: u64) -> Result<&str> {
        let token = usize::try_from(index).ok().and_then(|i| self.strings.get(i));
        self.token(u64::from(*token.ok_or("a string is missing")?))
    }

    fn path(&self, index: u32) -> Result<String> {
        let path = self.paths.get(index as usize).map(|path| super::layer::plain(path));
        path.ok_or_else(|| "a path is missing".to_owned())
    }

    /// What all prims and properties say.
    fn specs(&self, at: &mut Cursor<'_>, sets: &[i64], room: usize) -> Result<Layer> {
        let mut layer = Layer::default();
        layer.prims.insert("/".to_owned(), Spec::default());
        if at.at >= at.bytes.len() {
            return Ok(layer);
        }
        let count = self.table(at.u64()?)?;
        let (paths, fields, kinds) = (self.ints(at, count)?, self.ints(at, count)?, self.ints(at, count)?);
        let mut work = 0;
        let mut offsets = Vec::new();
        for ((path, set), kind) in paths.into_iter().zip(fields).zip(kinds) {
            let path = usize::try_from(path).ok().and_then(|i| self.paths.get(i));
            let path = path.filter(|p| !p.is_empty()).ok_or("a path is missing")?;
            let set =
                usize::try_from(set).ok().and_then(|i| sets.get(i..)).ok_or("a set of fields is missing")?;
            for index in set.iter().take_while(|i| **i != -1 && **i != i64::from(u32::MAX)) {
                work += 1;
                if work > room {
                    return Err("it says too much of too many things".to_owned());
                }
                let field = usize::try_from(*index).ok().and_then(|i| self.fields.get(i));
                let (name, rep) = *field.ok_or("a field is missing")?;
                let name = self.token(u64::from(name))?;
                match kind {
                    // A prim, the root, a variant.
                    7 if name == "subLayers" => {
                        let layers = self.texts(rep)?;
                        layer.sub_layers = layers.into_iter().map(|l| (l, Offset::default())).collect();
                    }
                    7 if name == "subLayerOffsets" => offsets = self.offsets(rep)?,
                    6 | 7 | 10 => {
                        let is_plain =
                            matches!(numbers_of(rep.kind()), Some((_, 1))) || matches!(rep.kind(), 10 | 11);
                        if kind == 7 && is_plain {
                            layer.say(name, &self.value(rep)?);
                        }
                        let spec = layer.prims.entry(path.clone()).or_default();
                        self.field_of_prim(spec, name, rep)?;
                    }
                    1 | 8 => {
                        let Some((prim, property)) = path.rsplit_once('.') else { continue };
                        let spec = layer.prims.entry(prim.to_owned()).or_default();
                        let property = spec.properties.entry(property.to_owned()).or_default();
                        match name {
                            "default" => property.value = Some(Value::Packed(rep)),
                            "timeSamples" => property.samples = self.samples(rep)?,
                            "connectionPaths" | "targetPaths" => {
                                property.targets = self.list(rep, |c| self.path(c.u32()?))?;
                            }
                            "interpolation" => property.interpolation = Some(self.text(rep)?),
                            "colorSpace" => property.color_space = Some(self.text(rep)?),
                            "weight" => {
                                if let Value::Numbers(Numbers { values, .. }) = self.value(rep)? {
                                    property.weight = values.first().copied();
                                }
                            }
                            "bindMaterialAs" => property.is_strong = self.text(rep)? == super::text::STRONG,
                            _ => {}
                        }
                    }
                    _ => {}
                }
            }
        }
        for ((_, to), offset) in layer.sub_layers.iter_mut().zip(offsets) {
            *to = offset;
        }
        Ok(layer)
    }

    fn field_of_prim(&self, spec: &mut Spec, name: &str, rep: Rep) -> Result<()> {
        match name {
            "specifier" => {
                spec.specifier = match rep.payload() {
                    0 => Specifier::Def,
                    1 => Specifier::Over,
                    _ => Specifier::Class,
                }
            }
            "typeName" => spec.type_name = self.text(rep)?,
            "primChildren" => spec.children = self.texts(rep)?,
            "references" => spec.references = self.list(rep, |c| self.reference(c, true))?,
            "payload" if rep.kind() == 47 => {
                let mut at = self.at(rep)?;
                let payload = self.payload(&mut at)?;
                spec.payloads.add(Edit::Set, vec![payload]);
            }
            "payload" => spec.payloads = self.list(rep, |c| self.payload(c))?,
            "inheritPaths" => spec.inherits = self.list(rep, |c| self.path(c.u32()?))?,
            "specializes" => spec.specializes = self.list(rep, |c| self.path(c.u32()?))?,
            "variantSetNames" => {
                spec.variant_sets = self.list(rep, |c| Ok(self.string(u64::from(c.u32()?))?.to_owned()))?;
            }
            "apiSchemas" => {
                spec.schemas = self.list(rep, |c| Ok(self.token(u64::from(c.u32()?))?.to_owned()))?;
            }
            "variantSelection" if !rep.is_inlined() => {
                let mut at = self.at(rep)?;
                for _ in 0..at.count(8)? {
                    let (set, choice) = (u64::from(at.u32()?), u64::from(at.u32()?));
                    spec.selections.insert(self.string(set)?.to_owned(), self.string(choice)?.to_owned());
                }
            }
            "active" | "instanceable" => spec.say(name, &self.value(rep)?),
            "clips" => spec.has_clips = true,
            _ => {}
        }
        Ok(())
    }

    /// Where a value's bytes are.
    fn at(&self, rep: Rep) -> Result<Cursor<'_>> {
        let at = usize::try_from(rep.payload()).map_err(|_| "it points beyond its end")?;
        Ok(Cursor { bytes: self.all(), at })
    }

    fn text(&self, rep: Rep) -> Result<String> {
        match self.value(rep)? {
            Value::Text(text) => Ok(text),
            _ => Err("a word was expected".to_owned()),
        }
    }

    fn texts(&self, rep: Rep) -> Result<Vec<String>> {
        match self.value(rep)? {
            Value::Texts(texts) => Ok(texts),
            _ => Err("a list of words was expected".to_owned()),
        }
    }

    /// How a list is edited.
    fn list<T: Clone + PartialEq>(
        &self,
        rep: Rep,
        item: impl Fn(&mut Cursor<'_>) -> Result<T>,
    ) -> Result<Edits<T>> {
        let mut edits = Edits::default();
        if rep.is_inlined() {
            return Ok(edits);
        }
        let mut at = self.at(rep)?;
        let which = at.take(1)?[0];
        let parts = [
            (2, Edit::Set),
            (4, Edit::Append),
            (32, Edit::Prepend),
            (64, Edit::Append),
            (8, Edit::Delete),
            (16, Edit::Reorder),
        ];
        if which & 1 != 0 {
            edits.add(Edit::Set, Vec::new());
        }
        for (bit, edit) in parts {
            if which & bit != 0 {
                let items = (0..at.count(4)?).map(|_| item(&mut at)).collect::<Result<_>>()?;
                edits.add(edit, items);
            }
        }
        Ok(edits)
    }

    fn reference(&self, at: &mut Cursor<'_>, has_more: bool) -> Result<Reference> {
        let asset = self.string(u64::from(at.u32()?))?.to_owned();
        let path = at.u32()?;
        let path = if path == u32::MAX { String::new() } else { self.path(path)? };
        let mut offset = Offset::default();
        if has_more {
            offset = Offset { offset: f64::from_bits(at.u64()?), scale: f64::from_bits(at.u64()?) };
            // What programs of their own keep there: names, each with where its value ends.
            for _ in 0..at.count(12)? {
                at.u32()?;
                at.follow()?;
                at.u64()?;
            }
        }
        Ok(Reference { asset, path, offset })
    }

    fn payload(&self, at: &mut Cursor<'_>) -> Result<Reference> {
        let mut payload = self.reference(at, false)?;
        if self.version >= [0, 8, 0] {
            payload.offset = Offset { offset: f64::from_bits(at.u64()?), scale: f64::from_bits(at.u64()?) };
        }
        Ok(payload)
    }

    fn offsets(&self, rep: Rep) -> Result<Vec<Offset>> {
        let mut at = self.at(rep)?;
        let count = at.count(16)?;
        let one = |_| Ok(Offset { offset: f64::from_bits(at.u64()?), scale: f64::from_bits(at.u64()?) });
        (0..count).map(one).collect()
    }

    /// Times, and where the value of each is.
    fn samples(&self, rep: Rep) -> Result<Vec<(f64, Value)>> {
        if rep.kind() != 46 || rep.is_inlined() {
            return Ok(Vec::new());
        }
        let mut at = self.at(rep)?;
        at.follow()?;
        let times = Rep(at.u64()?);
        let Value::Numbers(times) = self.value(times)? else { return Err("times are numbers".to_owned()) };
        at.follow()?;
        let count = at.count(8)?;
        let mut samples = Vec::new();
        for time in times.values.iter().take(count) {
            samples.push((*time, Value::Packed(Rep(at.u64()?))));
        }
        samples.retain(|(time, _)| time.is_finite());
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(samples)
    }
}
