//! Which files may be read, where they are, and their bytes.
//!
//! Only plain files are read, and of each no more than the size that it tells: a device, a pipe or a file of the kernel could
//! go on for ever. Where reading is confined to a folder, symbolic links are followed before it is asked whether a file is in it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::{Component, Path, PathBuf};

use straal_scene::suggest;

/// Why a file isn't read, and what would help.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{problem}")]
pub struct Refusal {
    /// What is wrong, as a sentence without a full stop.
    pub problem: String,
    /// What would be right, if that is known.
    pub help: Option<String>,
}

impl Refusal {
    /// Without help.
    pub fn new(problem: impl Into<String>) -> Self {
        Self { problem: problem.into(), help: None }
    }

    /// With what would be right.
    #[must_use]
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    /// Whether there is no such file.
    pub(crate) fn is_missing(&self) -> bool {
        self.problem == MISSING
    }

    /// Whether another name would help.
    pub(crate) fn is_of_the_name(&self) -> bool {
        self.is_missing() || self.problem == FOLDER
    }

    /// With a file of nearly that name as help, where the one that was named isn't there.
    #[must_use]
    pub(crate) fn or_similar(self, path: &Path) -> Self {
        let help = if self.help.is_none() && !path.exists() { similar(path) } else { None };
        Self { help: help.or(self.help), ..self }
    }
}

/// What is said where nothing is.
const MISSING: &str = "there is no such file";
const FOLDER: &str = "it is a folder";

/// So many bytes at a file's beginning are looked at before the rest is read.
const HEAD: u64 = 4096;

/// The bytes of a plain file that has at most `most` of them and is no stand-in for another.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, Refusal> {
    read_if(path, most, |_| Ok(()))
}

/// The same of a file that may be packed by gzip: the bytes in it, of which there are at most `most` as well.
pub(crate) fn read_packed(path: &Path, most: u64) -> Result<Vec<u8>, Refusal> {
    let bytes = read_with(path, most, |head| if is_gzip(head) { Ok(()) } else { no_stand_in(head) })?;
    if is_gzip(&bytes) { unpacked(&bytes, most) } else { Ok(bytes) }
}

/// The same of a file that may be a ZIP, which is left as it is.
pub(crate) fn read_archive(path: &Path, most: u64) -> Result<Vec<u8>, Refusal> {
    read_with(path, most, |head| if head.starts_with(b"PK\x03\x04") { Ok(()) } else { no_stand_in(head) })
}

/// Whether bytes are packed by gzip.
pub(crate) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x1f\x8b")
}

/// What is in bytes that are packed by gzip (RFC 1952).
pub(crate) fn unpacked(bytes: &[u8], most: u64) -> Result<Vec<u8>, Refusal> {
    let damaged = || Refusal::new("it is packed by gzip, and damaged");
    let flags = *bytes.get(3).ok_or_else(damaged)?;
    let mut at = 10;
    if flags & 4 != 0 {
        let length = bytes.get(at..at + 2).ok_or_else(damaged)?;
        at += 2 + usize::from(u16::from_le_bytes([length[0], length[1]]));
    }
    // The name that it had, and a comment: each ends with a 0.
    for _ in 0..usize::from(flags & 8 != 0) + usize::from(flags & 16 != 0) {
        let rest = bytes.get(at..).ok_or_else(damaged)?;
        at += 1 + rest.iter().position(|b| *b == 0).ok_or_else(damaged)?;
    }
    if flags & 2 != 0 {
        at += 2;
    }
    let rest = bytes.get(at..).ok_or_else(damaged)?;
    // It unpacks to a thousand times as much at most, so that the file proves what is asked for.
    let most = usize::try_from(most).unwrap_or(usize::MAX).min(rest.len().saturating_mul(1100));
    miniz_oxide::inflate::decompress_to_vec_with_limit(rest, most).map_err(|e| match e.status {
        miniz_oxide::inflate::TINFLStatus::HasMoreOutput => {
            Refusal::new(format!("it is packed by gzip, and there are more than {most} bytes in it"))
        }
        _ => damaged(),
    })
}

/// As [`read`], where `check` is asked about the first bytes before the rest is read.
pub(crate) fn read_if(
    path: &Path,
    most: u64,
    check: impl FnOnce(&[u8]) -> Result<(), Refusal>,
) -> Result<Vec<u8>, Refusal> {
    read_with(path, most, |head| {
        no_stand_in(head)?;
        check(head)
    })
}

/// A file of which the first bytes are read.
pub(crate) struct Opened {
    pub head: Vec<u8>,
    /// What follows.
    pub rest: io::Take<File>,
    /// How many bytes it has in all.
    pub size: u64,
}

impl Opened {
    /// The file from its start, for who reads it bit by bit.
    pub fn into_whole(self) -> Result<File, Refusal> {
        let mut file = self.rest.into_inner();
        file.rewind().map_err(|e| Refusal::new(reason(&e)))?;
        Ok(file)
    }
}

/// Opens a file if its first bytes are as they should be, by [`no_stand_in`] and `check`.
pub(crate) fn open_if(
    path: &Path,
    most: u64,
    check: impl FnOnce(&[u8]) -> Result<(), Refusal>,
) -> Result<Opened, Refusal> {
    open_with(path, most, |head| {
        no_stand_in(head)?;
        check(head)
    })
}

fn open_with(
    path: &Path,
    most: u64,
    check: impl FnOnce(&[u8]) -> Result<(), Refusal>,
) -> Result<Opened, Refusal> {
    // Opening a pipe would already wait for someone who writes to it.
    size(path, most)?;
    let failed = |e: io::Error| Refusal::new(reason(&e));
    let file = File::open(path).map_err(failed)?;
    let size = size_of(&file.metadata().map_err(failed)?, most)?;
    let mut head = Vec::new();
    reserve(&mut head, size.min(HEAD))?;
    (&file).take(size.min(HEAD)).read_to_end(&mut head).map_err(failed)?;
    check(&head)?;
    let rest = file.take(size - head.len() as u64);
    Ok(Opened { head, rest, size })
}

/// Reads a file if its first bytes are as they should be.
fn read_with(
    path: &Path,
    most: u64,
    check: impl FnOnce(&[u8]) -> Result<(), Refusal>,
) -> Result<Vec<u8>, Refusal> {
    let Opened { head: mut bytes, mut rest, .. } = open_with(path, most, check)?;
    if rest.limit() > 0 {
        reserve(&mut bytes, rest.limit())?;
        rest.read_to_end(&mut bytes).map_err(|e| Refusal::new(reason(&e)))?;
    }
    Ok(bytes)
}

fn reserve(bytes: &mut Vec<u8>, more: u64) -> Result<(), Refusal> {
    let fits = usize::try_from(more).is_ok_and(|more| bytes.try_reserve_exact(more).is_ok());
    if fits { Ok(()) } else { Err(Refusal::new(format!("there is no memory for its {more} bytes"))) }
}

/// The size of a file that may be read.
pub(crate) fn size(path: &Path, most: u64) -> Result<u64, Refusal> {
    let size = size_of(&std::fs::metadata(path).map_err(|e| Refusal::new(reason(&e)))?, most);
    // Files of the kernel tell a size of 0, and some of them never end.
    let is_kernels = || resolved(path).starts_with("/proc") || resolved(path).starts_with("/sys");
    if size.is_err() && is_kernels() {
        Err(Refusal::new("it is a file of the kernel, not a plain one"))
    } else {
        size
    }
}

fn size_of(about: &std::fs::Metadata, most: u64) -> Result<u64, Refusal> {
    if about.is_dir() {
        return Err(Refusal::new(FOLDER));
    }
    if !about.is_file() {
        return Err(Refusal::new("it is not a plain file"));
    }
    match about.len() {
        0 => Err(Refusal::new("the file is empty")),
        size if size > most => Err(Refusal::new(format!("it has {size} bytes, more than {most}"))),
        size => Ok(size),
    }
}

fn reason(e: &io::Error) -> String {
    match e.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => MISSING.to_owned(),
        io::ErrorKind::PermissionDenied => "no permission".to_owned(),
        _ => e.to_string(),
    }
}

/// Refuses what stands where another file should be: a pointer to it, a packed one, the page that says that it is gone.
fn no_stand_in(head: &[u8]) -> Result<(), Refusal> {
    let begins = |with: &[u8]| head.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with));
    if begins(b"version https://git-lfs") {
        return Err(Refusal::new("it is a pointer of Git LFS: the file itself was not fetched")
            .help("run `git lfs pull` in its repository"));
    }
    if begins(b"/annex/objects/") {
        return Err(Refusal::new("it is a pointer of git-annex: the file itself was not fetched")
            .help("run `git annex get` in its repository"));
    }
    let packed: [(&[u8], &str); 5] = [
        (b"\x1f\x8b", "gzip"),
        (b"PK\x03\x04", "zip"),
        (b"BZh", "bzip2"),
        (b"\xfd7zXZ\0", "xz"),
        (b"\x28\xb5\x2f\xfd", "zstd"),
    ];
    if let Some((_, name)) = packed.iter().find(|(magic, _)| head.starts_with(magic)) {
        return Err(Refusal::new(format!("it is packed by {name}")).help("unpack it first"));
    }
    if begins(b"<!doctype html") || begins(b"<html") {
        return Err(Refusal::new("it is a web page (HTML)")
            .help("perhaps a download gave the page about the file instead of the file"));
    }
    if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
        return Err(Refusal::new("it is text in UTF-16, where UTF-8 is needed")
            .help("save it as UTF-8 (in PowerShell: `Set-Content -Encoding utf8`)"));
    }
    Ok(())
}

/// A file that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Where it is.
    pub path: PathBuf,
    /// The name under which it was found, where that isn't the one that was asked for.
    pub instead: Option<String>,
}

/// A folder that files must be in.
#[derive(Clone, Debug)]
struct Root {
    /// Without symbolic links.
    real: PathBuf,
    /// As it was given, but absolute.
    given: PathBuf,
}

/// Finds files by the names that scenes and meshes give them.
#[derive(Clone, Debug, Default)]
pub struct Finder {
    /// The folder that all files must be in.
    root: Option<Root>,
    /// Names in folders that were looked through, by their lower case.
    listings: BTreeMap<PathBuf, BTreeMap<String, Vec<String>>>,
}

impl Finder {
    /// Finds files anywhere, or only those in the folder `root`.
    pub fn new(root: Option<&Path>) -> Result<Self, Refusal> {
        let Some(folder) = root else { return Ok(Self::default()) };
        let told = |problem: &str| {
            Refusal::new(format!("files can't be confined to `{}`: {problem}", folder.display()))
        };
        let real = folder.canonicalize().map_err(|e| {
            told(if e.kind() == io::ErrorKind::NotFound {
                "there is no such folder"
            } else {
                "it can't be looked into"
            })
        })?;
        if !real.is_dir() {
            return Err(told("it is not a folder"));
        }
        let given = std::path::absolute(folder).unwrap_or_else(|_| real.clone());
        Ok(Self { root: Some(Root { real, given }), ..Self::default() })
    }

    /// Where a file is that the caller itself names: it may be anywhere, but one in the root must not lead out of it.
    pub(crate) fn named(&self, path: &Path) -> Result<PathBuf, Refusal> {
        let Some(root) = &self.root else { return Ok(path.to_owned()) };
        let folder = path.parent().unwrap_or(Path::new(""));
        let written = std::path::absolute(path).unwrap_or_default();
        let is_inside = resolved(folder).starts_with(&root.real)
            || written.starts_with(&root.given)
            || written.starts_with(&root.real);
        if is_inside { self.confined(path) } else { Ok(path.to_owned()) }
    }

    /// Where a file is by a name that was written for the folder `base`. A name that isn't there may be meant for Windows:
    /// looked for then is the one with forward slashes, and at last the only one that differs in upper and lower case.
    pub fn find(&mut self, base: &Path, name: &str) -> Result<Found, Refusal> {
        let exact = self.confined(&base.join(name))?;
        if exact.exists() {
            return Ok(Found { path: exact, instead: None });
        }
        // What begins with a slash is relative to a drive there.
        let slashed = name.replace('\\', "/");
        let meant = if slashed == name { name } else { slashed.trim_start_matches('/') };
        if let Some(found) = self.in_any_case(base, meant)? {
            return Ok(found);
        }
        Err(Refusal { problem: MISSING.to_owned(), help: similar(&exact) })
    }

    /// A file by its last name alone, wherever its path says that it was when it was written.
    pub(crate) fn find_beside(&mut self, base: &Path, name: &str) -> Result<Option<Found>, Refusal> {
        let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
        let last = last.rsplit_once(':').map_or(last, |(_, behind)| behind);
        if last.is_empty() || last == name {
            return Ok(None);
        }
        self.in_any_case(base, last)
    }

    /// Walks to a file, where each step may differ in case if only one name does.
    fn in_any_case(&mut self, base: &Path, name: &str) -> Result<Option<Found>, Refusal> {
        if Path::new(name).has_root() {
            return Ok(None);
        }
        let (mut path, mut taken) = (base.to_owned(), PathBuf::new());
        let mut is_exact = true;
        for step in Path::new(name).components() {
            let here = path.join(step);
            if !matches!(step, Component::Normal(_)) || self.confined(&here)?.exists() {
                (path, taken) = (here, taken.join(step));
                continue;
            }
            let folder = if path.as_os_str().is_empty() { Path::new(".") } else { &path };
            let folder = self.confined(folder)?;
            let wanted = step.as_os_str().to_string_lossy().to_lowercase();
            let names = self.listing(folder).get(&wanted);
            let [only] = names.map_or(&[][..], Vec::as_slice) else { return Ok(None) };
            (path, taken) = (path.join(only), taken.join(only));
            is_exact = false;
        }
        let path = self.confined(&path)?;
        let instead = (!is_exact).then(|| taken.to_string_lossy().into_owned());
        Ok(path.is_file().then_some(Found { path, instead }))
    }

    /// The names in a folder, which is looked through once.
    fn listing(&mut self, folder: PathBuf) -> &BTreeMap<String, Vec<String>> {
        /// Larger folders aren't looked through further.
        const MOST: usize = 100_000;
        self.listings.entry(folder).or_insert_with_key(|folder| {
            let mut names: BTreeMap<String, Vec<String>> = BTreeMap::new();
            for entry in std::fs::read_dir(folder).into_iter().flatten().take(MOST).flatten() {
                if let Ok(name) = entry.file_name().into_string() {
                    names.entry(name.to_lowercase()).or_default().push(name);
                }
            }
            names
        })
    }

    /// The path itself, and without symbolic links where there is a root that it must be in.
    fn confined(&self, path: &Path) -> Result<PathBuf, Refusal> {
        let Some(root) = &self.root else { return Ok(path.to_owned()) };
        let real = resolved(path);
        if real.starts_with(&root.real) {
            return Ok(real);
        }
        let (path, root) = (shown(path), shown(&root.real));
        Err(Refusal::new(format!("`{path}` lies outside of `{root}`, and only files in there may be read"))
            .help("`--root` says which folder a scene may read from"))
    }
}

/// A path as it can be shown: a scene may put anything into the names of its files.
fn shown(path: &Path) -> String {
    const MOST: usize = 300;
    let text = path.to_string_lossy();
    text.chars().take(MOST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

/// A path without symbolic links, `.` and `..`. What isn't there is taken as it is written, so that the answer doesn't tell
/// whether something is.
fn resolved(path: &Path) -> PathBuf {
    let mut known = path;
    let mut rest = Vec::new();
    loop {
        let folder = if known.as_os_str().is_empty() { Path::new(".") } else { known };
        if let Ok(real) = folder.canonicalize() {
            let mut real = real;
            for step in rest.iter().rev() {
                match step {
                    Component::ParentDir => {
                        real.pop();
                    }
                    Component::Normal(name) => real.push(name),
                    _ => {}
                }
            }
            return real;
        }
        let mut steps = known.components();
        match steps.next_back() {
            Some(step) => rest.push(step),
            None => return path.to_owned(),
        }
        known = steps.as_path();
    }
}

/// A file of nearly that name in the same folder.
pub(crate) fn similar(path: &Path) -> Option<String> {
    const MOST: usize = 1000;
    let wanted = path.file_name()?.to_string_lossy().into_owned();
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .ok()?
        .take(MOST)
        .filter_map(|e| Some(e.ok()?.file_name().to_string_lossy().into_owned()))
        .filter(|name| *name != wanted)
        .collect();
    names.sort();
    suggest::did_you_mean(&wanted, names.iter().map(String::as_str))
}
