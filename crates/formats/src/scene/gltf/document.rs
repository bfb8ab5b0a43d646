//! The JSON of a file as it is asked, the bytes of its buffers, and complaints that name the place.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use straal_scene::{Diagnostic, FileId, Span};

use super::container;
use super::json::{Json, Value};
use super::meshopt;
use crate::files;
use crate::scene::Means;

/// What is wrong at a place of the JSON text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    place: (u32, u32),
    problem: String,
    help: Option<&'static str>,
}

/// What can be wrong.
pub(super) type Result<T> = std::result::Result<T, Fault>;

impl Fault {
    /// A complaint about a value.
    pub fn of(at: &Json, problem: impl Into<String>) -> Self {
        Self { place: (at.start, at.end), problem: problem.into(), help: None }
    }

    /// With what would be right.
    pub fn help(self, help: &'static str) -> Self {
        Self { help: Some(help), ..self }
    }
}

/// Any bytes of a file: a part of it, or what was read or unpacked.
pub(super) type Bytes<'a> = Arc<Cow<'a, [u8]>>;

/// A part of a buffer.
pub(super) struct View<'a> {
    bytes: Bytes<'a>,
    range: Range<usize>,
    /// From one thing to the next, where it is told.
    pub stride: Option<usize>,
}

impl View<'_> {
    /// Its bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[self.range.clone()]
    }
}

/// A file's JSON and its buffers.
pub(super) struct Document<'a> {
    pub root: &'a Json,
    file: FileId,
    buffers: Vec<Option<Bytes<'a>>>,
    /// Views that were packed.
    unpacked: BTreeMap<usize, Bytes<'a>>,
    /// Bytes of all buffers.
    pub held: u64,
    /// Numbers that may still be read of accessors: several may ask for the same bytes.
    pub(super) room: u64,
}

/// So many numbers are read of accessors in all.
const MOST_NUMBERS: u64 = 1 << 32;

impl<'a> Document<'a> {
    /// Reads the buffers; complains of all that can't be read. What was read is told with its hash.
    pub fn open(
        root: &'a Json,
        file: FileId,
        binary: Option<&'a [u8]>,
        means: &mut Means<'_>,
        files: &mut Vec<(PathBuf, String, [u8; 32])>,
    ) -> Self {
        let mut document =
            Self { root, file, buffers: Vec::new(), unpacked: BTreeMap::new(), held: 0, room: MOST_NUMBERS };
        for (i, buffer) in document.list("buffers").iter().enumerate() {
            let bytes = match buffer.get("uri").map(|uri| (uri, text(uri))) {
                None if i == 0 => Ok(binary.map(Cow::Borrowed)),
                // What stands in for bytes that are packed elsewhere.
                None => Ok(None),
                Some((_, Err(fault))) => Err(fault),
                Some((at, Ok(uri))) => document.bytes_of(at, uri, means, files).map(|b| Some(Cow::Owned(b))),
            };
            let bytes = bytes.unwrap_or_else(|fault| {
                means.d.push(document.error(&fault));
                None
            });
            let held = bytes.as_ref().map_or(0, |b| b.len() as u64);
            document.held += held;
            if let Some(Cow::Owned(_)) = &bytes {
                means.ledger.keep(held);
            }
            document.buffers.push(bytes.map(Arc::new));
        }
        document
    }

    /// The bytes that a URI holds or names.
    pub fn bytes_of(
        &self,
        at: &Json,
        uri: &str,
        means: &mut Means<'_>,
        files: &mut Vec<(PathBuf, String, [u8; 32])>,
    ) -> Result<Vec<u8>> {
        if let Some(held) = container::data(uri) {
            return held.map_err(|problem| Fault::of(at, problem));
        }
        let name = container::file(uri).map_err(|problem| Fault::of(at, problem))?;
        let refused = |refusal: files::Refusal| {
            let help = refusal.help.map_or(String::new(), |help| format!(" ({help})"));
            Fault::of(
                at,
                format!("cannot read `{}`: {}{help}", straal_scene::suggest::brief(&name), refusal.problem),
            )
        };
        let found = means.finder.find(means.base, &name).map_err(refused)?;
        let length = files::size(&found.path, means.limits.max_bytes).map_err(refused)?;
        let what = || format!("reading `{}`", straal_scene::suggest::brief(&name));
        if let Some(shortage) = means.ledger.refuse(length, what, "a smaller scene takes less") {
            means.d.lacks_memory = true;
            return Err(Fault::of(at, shortage.to_string()));
        }
        let bytes = files::read(&found.path, means.limits.max_bytes).map_err(refused)?;
        files.push((found.path, name, blake3::hash(&bytes).into()));
        Ok(bytes)
    }

    /// One of the lists of the file; empty where it isn't there.
    pub fn list(&self, name: &str) -> &'a [Json] {
        self.root.get(name).map_or(&[], |list| list.items())
    }

    /// What a number leads to in one of the lists.
    pub fn item(&self, list: &str, at: &Json) -> Result<(usize, &'a Json)> {
        in_list(list, self.list(list), at)
    }

    /// A fault as an error.
    pub fn error(&self, fault: &Fault) -> Diagnostic {
        let (span, path) = self.place(fault.place);
        Diagnostic::error(span, format!("{path}{}", fault.problem)).maybe_help(fault.help.map(str::to_owned))
    }

    /// A place as the beginning of a sentence.
    pub fn place(&self, (start, end): (u32, u32)) -> (Span, String) {
        let path = self.root.path_to(start, end);
        let path = if path.is_empty() { path } else { format!("`{path}`: ") };
        (Span { file: self.file, start, end }, path)
    }

    /// The view that a number leads to.
    pub fn view(&mut self, at: &Json) -> Result<View<'a>> {
        let (i, view) = self.item("bufferViews", at)?;
        let stride = view.get("byteStride").map(size).transpose()?.filter(|s| *s > 0);
        let packed =
            view.extension("EXT_meshopt_compression").or_else(|| view.extension("KHR_meshopt_compression"));
        if let Some(packed) = packed {
            let bytes = match self.unpacked.get(&i) {
                Some(bytes) => bytes.clone(),
                None => {
                    let bytes: Bytes<'a> = Arc::new(Cow::Owned(self.unpack(packed)?));
                    self.unpacked.insert(i, bytes.clone());
                    bytes
                }
            };
            let range = 0..bytes.len();
            return Ok(View { bytes, range, stride });
        }
        self.part(view, stride)
    }

    /// The part of a buffer that an object tells by `buffer`, `byteOffset` and `byteLength`.
    fn part(&self, view: &Json, stride: Option<usize>) -> Result<View<'a>> {
        let (i, buffer) = self.item("buffers", required(view, "buffer")?)?;
        let Some(bytes) = self.buffers.get(i).cloned().flatten() else {
            return Err(Fault::of(
                buffer,
                "the buffer has no bytes: no `uri`, and none are packed with the file",
            ));
        };
        let (start, length) = (size_or(view, "byteOffset", 0)?, size(required(view, "byteLength")?)?);
        let range = start.checked_add(length).map(|end| start..end).filter(|range| range.end <= bytes.len());
        let Some(range) = range else {
            let message = format!(
                "{length} bytes from byte {start} on are more than the {} of the buffer",
                bytes.len()
            );
            return Err(Fault::of(view, message));
        };
        Ok(View { bytes, range, stride })
    }

    /// What a packed view holds.
    fn unpack(&mut self, packed: &Json) -> Result<Vec<u8>> {
        let source = self.part(packed, None)?;
        let (count, stride) = (size(required(packed, "count")?)?, size(required(packed, "byteStride")?)?);
        let mode = text(required(packed, "mode")?)?;
        let filter = packed.get("filter").map_or(Ok("NONE"), text)?;
        let total = count.checked_mul(stride).map_or(u64::MAX, |total| total as u64);
        self.spend(packed, total)?;
        let what = meshopt::Packed { count, stride, mode, filter };
        what.unpack(source.bytes()).map_err(|problem| Fault::of(packed, problem))
    }

    /// Takes note of numbers that are read.
    pub fn spend(&mut self, at: &Json, numbers: u64) -> Result<()> {
        let left = self.room.checked_sub(numbers);
        self.room = left.ok_or_else(|| Fault::of(at, "the file asks for more numbers than can be read"))?;
        Ok(())
    }
}

/// What a number leads to in a list.
pub(super) fn in_list<'a>(name: &str, list: &'a [Json], at: &Json) -> Result<(usize, &'a Json)> {
    let i = size(at)?;
    let found = list.get(i).map(|item| (i, item));
    found.ok_or_else(|| {
        let has = if list.len() == 1 { "is 1".to_owned() } else { format!("are {}", list.len()) };
        Fault::of(at, format!("there is no {name}[{i}]: there {has}, counted from 0"))
    })
}

/// What an object must have.
pub(super) fn required<'a>(of: &'a Json, key: &str) -> Result<&'a Json> {
    of.get(key).ok_or_else(|| Fault::of(of, format!("`{key}` is missing")))
}

fn expected(what: &str, at: &Json) -> Fault {
    Fault::of(at, format!("{what} was expected, but this is {}", at.kind()))
}

/// A text.
pub(super) fn text(at: &Json) -> Result<&str> {
    at.text().ok_or_else(|| expected("a text", at))
}

/// A number that single precision holds.
pub(super) fn number(at: &Json) -> Result<f64> {
    let v = at.number().ok_or_else(|| expected("a number", at))?;
    if (v as f32).is_finite() { Ok(v) } else { Err(Fault::of(at, "the number is too large")) }
}

/// A number under a key, and what it is without one.
pub(super) fn number_or(of: &Json, key: &str, absent: f64) -> Result<f64> {
    of.get(key).map_or(Ok(absent), number)
}

/// A count or an index.
pub(super) fn size(at: &Json) -> Result<usize> {
    let v = at.number().ok_or_else(|| expected("a whole number", at))?;
    // 2^53 and beyond aren't exact.
    let is_whole = (0.0..9_007_199_254_740_992.0).contains(&v) && v.fract() == 0.0;
    if is_whole { Ok(v as usize) } else { Err(Fault::of(at, "a whole number from 0 on was expected")) }
}

/// A count under a key, and what it is without one.
pub(super) fn size_or(of: &Json, key: &str, absent: usize) -> Result<usize> {
    of.get(key).map_or(Ok(absent), size)
}

/// Whether something is said to be so.
pub(super) fn flag(of: &Json, key: &str) -> Result<bool> {
    match of.get(key).map(|v| (v, &v.value)) {
        None => Ok(false),
        Some((_, Value::Bool(v))) => Ok(*v),
        Some((at, _)) => Err(expected("true or false", at)),
    }
}

/// So many numbers.
pub(super) fn vector<const N: usize>(at: &Json) -> Result<[f64; N]> {
    let items = at.items();
    if items.len() != N {
        return Err(Fault::of(at, format!("a list of {N} numbers was expected")));
    }
    let mut out = [0.0; N];
    for (v, item) in out.iter_mut().zip(items) {
        *v = number(item)?;
    }
    Ok(out)
}

/// So many numbers under a key, and what they are without one.
pub(super) fn vector_or<const N: usize>(of: &Json, key: &str, absent: [f64; N]) -> Result<[f64; N]> {
    of.get(key).map_or(Ok(absent), vector)
}
