//! Files of exact sums: a render that was cut off is taken up again, and parts that were rendered apart are put together,
//! to the bits of the whole.
//!
//! Such a file is, in this order, all numbers little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `straalSU` |
//! | 4 | the version of this format, 1 |
//! | 4 | bytes of the header, H |
//! | H | the header: lines of text in UTF-8, each a key and what it says; see [`Stamp`] |
//! | 32 | BLAKE3 of all before |
//! | ... | for each pixel of the region, row by row from the top, the numbers that the header's line `record` lists |
//! | 32 | BLAKE3 of all before |

use crate::job::{Error, Job};
use crate::look::Look;
use crate::picture::Picture;
use blake3::Hasher;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use straal_color::Space;
use straal_color::spectrum::Bands;
use straal_render::film::{Evidence, Film, Held, Joined, MAX_SAMPLES, Span, hash_of};
use straal_render::settings::Region;
use straal_scene::memory::{PROGRAM, Shortage};

const MAGIC: &[u8; 8] = b"straalSU";
const VERSION: u32 = 1;
/// Bytes of a hash.
const HASH: usize = 32;
/// More than any header has.
const MOST_HEADER: u32 = 1 << 16;

/// What a file of sums tells of the render that it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Stamp {
    /// What pictures of that render tell of themselves, but for what came of it.
    pub story: Vec<(String, String)>,
    /// What else decides the bits of its sums.
    pub also: Vec<(String, String)>,
    /// How the scene wants its picture developed.
    pub look: Look,
    /// Size of the whole picture.
    pub size: [u32; 2],
    /// Which samples, and of which part of the picture.
    pub span: Span,
    /// Samples of each pixel in all, where that was said.
    pub whole: Option<u32>,
    /// By what noise is told, if it is.
    pub error: Option<Evidence>,
    /// What there is of each pixel.
    pub held: Held,
    /// Whether some tiles have more samples than the span says: it was written in the middle of a pass.
    pub is_midway: bool,
    /// The first sample that was dropped: pixel and index.
    pub dropped: Option<([u32; 2], u32)>,
}

/// A render between two passes, in the middle of one or at its end, for who wants to keep its sums. In the middle some tiles
/// have more samples than [`Snapshot::samples`] says; who goes on from there takes of each what it hasn't got.
pub struct Snapshot<'a> {
    pub(crate) job: &'a Job,
    pub(crate) film: &'a Film,
    pub(crate) end: u32,
    /// Whether it is in the middle of a pass.
    pub is_midway: bool,
    /// Whether no pass comes after.
    pub is_last: bool,
    /// Whether all samples that were asked for are taken.
    pub is_complete: bool,
}

impl Snapshot<'_> {
    /// Samples of each pixel that are taken.
    pub fn samples(&self) -> u32 {
        self.end - self.job.first
    }

    /// Writes its sums.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let stamp = Stamp { is_midway: self.is_midway, ..self.job.stamp(self.film, self.end) }.to_string();
        let mut out = Hashed::new(out);
        out.write_all(MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&(stamp.len() as u32).to_le_bytes())?;
        out.write_all(stamp.as_bytes())?;
        out.write_hash()?;
        self.film.write_sums(&mut out)?;
        out.write_hash()
    }
}

/// Why a file of sums is of no use.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SumsError {
    /// The system refused.
    #[error("can't read {name}: {source}", name = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is something else, damaged or of another version.
    #[error("can't use {path}: {problem}", path = .0.display(), problem = .1)]
    File(PathBuf, String),
    /// The files don't go together.
    #[error("{0}")]
    Parts(String),
    /// Samples are missing.
    #[error("{0}")]
    Gaps(String),
    /// The film takes more memory than may be used.
    #[error(transparent)]
    Memory(#[from] Shortage),
}

/// Whether a file says that it holds sums.
pub fn is_named(path: &Path) -> bool {
    let mut magic = [0; 8];
    path.is_file()
        && File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok()
        && magic == *MAGIC
}

/// An opened file of sums whose header is whole.
#[derive(Debug)]
pub struct Kept {
    /// Its name.
    pub path: PathBuf,
    /// What it tells.
    pub stamp: Stamp,
    input: Hashed<BufReader<File>>,
}

impl Kept {
    /// Opens a file and reads its header. Nothing is taken for true before its hash, and its length, are those of a whole
    /// file; the sums behind are read when they are used.
    pub fn open(path: &Path) -> Result<Self, SumsError> {
        let failed = |source| SumsError::Read { path: path.to_path_buf(), source };
        let wrong = |problem: String| SumsError::File(path.to_path_buf(), problem);
        // A pipe has no length, and could keep its readers waiting.
        let about = std::fs::metadata(path).map_err(failed)?;
        if !about.is_file() {
            return Err(wrong("it is not a plain file".into()));
        }
        // Files of the kernel tell no length either, and some of them wait for ever.
        if about.len() == 0 {
            return Err(wrong("the file is empty".into()));
        }
        let file = File::open(path).map_err(failed)?;
        let cut = |e: io::Error| match e.kind() {
            io::ErrorKind::UnexpectedEof => {
                wrong("it is cut off in its header, or holds no sums of straal".into())
            }
            _ => failed(e),
        };
        let mut input = Hashed::new(BufReader::with_capacity(1 << 16, file));
        let [mut magic, mut number] = [[0; 8], [0; 8]];
        input.read_exact(&mut magic).map_err(cut)?;
        if magic != *MAGIC {
            return Err(wrong("it holds no sums of straal".into()));
        }
        input.read_exact(&mut number).map_err(cut)?;
        let [version, length] =
            [0, 4].map(|i| u32::from_le_bytes([number[i], number[i + 1], number[i + 2], number[i + 3]]));
        if version != VERSION {
            return Err(wrong(format!("its format is version {version}, and this straal knows {VERSION}")));
        }
        let damaged = || wrong("it is damaged: its header isn't what was written".into());
        if length > MOST_HEADER {
            return Err(damaged());
        }
        let mut header = vec![0; length as usize];
        input.read_exact(&mut header).map_err(cut)?;
        if !input.is_hash_next().map_err(cut)? {
            return Err(damaged());
        }
        let stamp = std::str::from_utf8(&header).ok().and_then(Stamp::read);
        let stamp = stamp.ok_or_else(|| wrong("its header makes no sense to this straal".into()))?;
        let records = stamp.span.region.area() as u64 * stamp.held.bytes_a_pixel(stamp.span.first) as u64;
        let want = 16 + u64::from(length) + 2 * HASH as u64 + records;
        if about.len() < want {
            return Err(wrong(format!("it is cut off: it has {} of {want} bytes", about.len())));
        }
        if about.len() > want {
            return Err(wrong(format!("it is damaged: it has {} bytes, not {want}", about.len())));
        }
        Ok(Self { path: path.to_path_buf(), stamp, input })
    }

    /// Samples of each pixel that it holds.
    pub fn samples(&self) -> u32 {
        self.stamp.span.end - self.stamp.span.first
    }

    /// Whether it holds sums of a job's scene, rendered in the same way.
    pub fn is_of(&self, job: &Job) -> bool {
        self.stamp.story == job.facts()
    }

    /// Reads all of it, to find out whether it is what was written.
    pub fn verify(&mut self) -> Result<(), SumsError> {
        self.sums(|stamp, input| {
            let Span { region, first, .. } = stamp.span;
            let bytes = region.area() as u64 * stamp.held.bytes_a_pixel(first) as u64;
            let found = io::copy(&mut input.take(bytes), &mut io::sink())?;
            if found < bytes { Err(io::ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
        })
    }

    /// Reads the sums through `read`, and then finds out whether they were what was written.
    pub(crate) fn sums(
        &mut self,
        read: impl FnOnce(&Stamp, &mut dyn Read) -> io::Result<()>,
    ) -> Result<(), SumsError> {
        let path = || self.path.clone();
        let done = read(&self.stamp, &mut self.input).and_then(|()| self.input.is_hash_next());
        match done {
            Ok(true) => Ok(()),
            Ok(false) => {
                Err(SumsError::File(path(), "it is damaged: its hash isn't that of what it holds".into()))
            }
            Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => {
                Err(SumsError::File(path(), "it is cut off".into()))
            }
            Err(source) => Err(SumsError::Read { path: path(), source }),
        }
    }
}

/// A file's bytes on their way, and the hash of all of them.
#[derive(Debug)]
struct Hashed<T> {
    inner: T,
    hasher: Hasher,
}

impl<T> Hashed<T> {
    fn new(inner: T) -> Self {
        Self { inner, hasher: Hasher::new() }
    }
}

impl<W: Write> Hashed<W> {
    fn write_hash(&mut self) -> io::Result<()> {
        let hash = self.hasher.finalize();
        self.write_all(hash.as_bytes())
    }
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.inner.write(bytes)?;
        self.hasher.update(&bytes[..n]);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<R: Read> Hashed<R> {
    /// Reads a hash: whether it is that of all before.
    fn is_hash_next(&mut self) -> io::Result<bool> {
        let want = self.hasher.finalize();
        let mut found = [0; HASH];
        self.read_exact(&mut found)?;
        Ok(want == blake3::Hash::from_bytes(found))
    }
}

impl<R: Read> Read for Hashed<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let n = self.inner.read(bytes)?;
        self.hasher.update(&bytes[..n]);
        Ok(n)
    }
}

impl std::fmt::Display for Stamp {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (kind, list) in [("story", &self.story), ("also", &self.also)] {
            for (key, value) in list {
                writeln!(f, "{kind} {key} {}", value.replace('\n', " "))?;
            }
        }
        let region = |r: Region| format!("{} {} {} {}", r.min[0], r.min[1], r.max[0], r.max[1]);
        writeln!(f, "look {}", self.look)?;
        writeln!(f, "size {} {}", self.size[0], self.size[1])?;
        writeln!(f, "crop {}", region(self.span.crop))?;
        writeln!(f, "region {}", region(self.span.region))?;
        writeln!(f, "samples {} {}", self.span.first, self.span.end)?;
        if let Some(whole) = self.whole {
            writeln!(f, "whole {whole}")?;
        }
        if let Some(error) = self.error {
            writeln!(f, "error {}", error.name())?;
        }
        if let Some(timed) = self.held.costs {
            writeln!(f, "costs {}", if timed { "tests_and_time" } else { "tests" })?;
        }
        if let Some(bands) = self.held.bands {
            let [from, to] = bands.ends();
            writeln!(f, "bands {from} {to} {}", bands.count())?;
        }
        if !self.held.mean_squares.is_empty() {
            let numbers: Vec<String> = self.held.mean_squares.iter().map(f64::to_string).collect();
            writeln!(f, "mean_squares {}", numbers.join(" "))?;
        }
        if let Some(weight) = self.held.weight {
            writeln!(f, "weight {weight}")?;
        }
        let held = &self.held;
        for (key, is_held) in [
            ("splats", held.splats),
            ("batches", held.batches),
            ("squares", held.squares),
            ("guides", held.guides),
            ("light_splats", held.light_splats),
            ("halves", held.halves),
            ("midway", self.is_midway),
        ] {
            if is_held {
                writeln!(f, "{key} yes")?;
            }
        }
        if let Some(([x, y], index)) = self.dropped {
            writeln!(f, "dropped {x} {y} {index}")?;
        }
        writeln!(f, "record {}", self.held.names(self.span.first))
    }
}

impl Stamp {
    /// What a header says; `None` where it isn't one that this version writes.
    fn read(text: &str) -> Option<Self> {
        let [mut story, mut also] = [Vec::new(), Vec::new()];
        let mut facts = Vec::new();
        for line in text.lines() {
            let (key, value) = line.split_once(' ')?;
            let list = match key {
                "story" => &mut story,
                "also" => &mut also,
                _ => {
                    facts.push((key, value));
                    continue;
                }
            };
            let (key, value) = value.split_once(' ')?;
            list.push((key.to_owned(), value.to_owned()));
        }
        let fact = |wanted: &str| facts.iter().find(|(key, _)| *key == wanted).map(|(_, value)| *value);
        // A fact that is there and can't be read is an error; one that isn't there may be none.
        let numbers = |key: &str| -> Option<Option<Vec<u32>>> {
            let Some(value) = fact(key) else { return Some(None) };
            value.split(' ').map(|n| n.parse().ok()).collect::<Option<Vec<u32>>>().map(Some)
        };
        let region = |key: &str| match numbers(key)?.as_deref() {
            Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Some(Region { min: [x0, y0], max: [x1, y1] }),
            _ => None,
        };
        let &[width, height] = numbers("size")??.as_slice() else { return None };
        let &[first, end] = numbers("samples")??.as_slice() else { return None };
        let span = Span { crop: region("crop")?, region: region("region")?, first, end };
        let inside = |a: Region, b: Region| a.intersection(b) == a;
        let whole_picture = Region::whole([width, height]);
        let is_sound = inside(span.crop, span.region)
            && inside(span.region, whole_picture)
            && first <= end
            && end <= MAX_SAMPLES
            && span.region.area() <= crate::job::MAX_PIXELS;
        let bands = match fact("bands") {
            None => None,
            Some(value) => match *value.split(' ').collect::<Vec<_>>() {
                [from, to, count] => {
                    Some(Bands::new(from.parse().ok()?, to.parse().ok()?, count.parse().ok()?)?)
                }
                _ => return None,
            },
        };
        let mean_squares: Vec<f64> = match fact("mean_squares") {
            None => Vec::new(),
            Some(value) => value.split(' ').map(|n| n.parse().ok()).collect::<Option<_>>()?,
        };
        // Filters reach 16 pixels at most.
        if mean_squares.len() > 17 || mean_squares.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let held = Held {
            costs: fact("costs").map(|c| c == "tests_and_time"),
            bands,
            splats: fact("splats").is_some(),
            batches: fact("batches").is_some(),
            squares: fact("squares").is_some(),
            guides: fact("guides").is_some(),
            light_splats: fact("light_splats").is_some(),
            weight: match fact("weight") {
                None => None,
                Some(value) => Some(value.parse().ok().filter(|w: &f64| w.is_finite() && *w >= 1.0)?),
            },
            halves: fact("halves").is_some(),
            mean_squares,
        };
        let error = match fact("error") {
            None => None,
            Some(name) => Some([Evidence::Spread, Evidence::Batches].into_iter().find(|e| e.name() == name)?),
        };
        let whole = match numbers("whole")?.as_deref() {
            None => None,
            Some(&[whole]) => Some(whole),
            Some(_) => return None,
        };
        let dropped = match numbers("dropped")?.as_deref() {
            None => None,
            Some(&[x, y, index]) => Some(([x, y], index)),
            Some(_) => return None,
        };
        let look = fact("look")?.parse().ok()?;
        let is_midway = fact("midway").is_some();
        let stamp =
            Self { story, also, look, size: [width, height], span, whole, error, held, is_midway, dropped };
        (is_sound && fact("record") == Some(stamp.held.names(first).as_str())).then_some(stamp)
    }

    /// What a key of the story says.
    fn tells(&self, key: &str) -> Option<&str> {
        self.story.iter().find(|(k, _)| k.strip_prefix("straal.") == Some(key)).map(|(_, v)| v.as_str())
    }

    /// In what two renders differ that must be alike: each as 'seed 1 there and 2 here'. `except` needn't.
    fn differences(&self, other: &Self, except: &[&str]) -> Vec<String> {
        let of = |stamp: &Self| -> Vec<(String, String)> {
            let short = |k: &str| k.strip_prefix("straal.").unwrap_or(k).replace('_', " ");
            let all = stamp.story.iter().chain(&stamp.also).map(|(k, v)| (short(k), v.clone()));
            all.filter(|(k, _)| !except.contains(&k.as_str())).collect()
        };
        let (there, here) = (of(self), of(other));
        let find = |list: &[(String, String)], key: &str| {
            list.iter().find(|(k, _)| k == key).map_or("none".to_owned(), |(_, v)| v.clone())
        };
        let mut keys: Vec<&String> = there.iter().chain(&here).map(|(k, _)| k).collect();
        keys.dedup();
        let mut told = Vec::new();
        for key in keys {
            let (a, b) = (find(&there, key), find(&here, key));
            let line = format!("{key} {a} there and {b} here");
            if a != b && !told.contains(&line) {
                told.push(line);
            }
        }
        if told.is_empty() && self.held != other.held {
            told.push("other layers there than here".into());
        }
        told
    }
}

impl Job {
    /// What a file of this job's sums tells.
    pub(crate) fn stamp(&self, film: &Film, end: u32) -> Stamp {
        let kind = self.settings.pattern.kind();
        let text = |n: u32| n.to_string();
        let of_set =
            kind.needs_count().then(|| ("samples_in_all".to_owned(), text(self.whole.unwrap_or(end))));
        let noise = self.settings.error.then(|| self.settings.evidence().name().to_owned());
        let error = ("error".to_owned(), noise.unwrap_or_else(|| "none".into()));
        let from = ("first_sample".to_owned(), text(self.first));
        Stamp {
            story: self.facts(),
            also: of_set.into_iter().chain([error, from]).collect(),
            look: self.look(),
            size: film.size,
            span: Span { crop: film.crop, region: film.region(), first: self.first, end },
            whole: self.whole,
            error: self.settings.error.then(|| self.settings.evidence()),
            held: film.held(),
            is_midway: false,
            dropped: film.dropped().first,
        }
    }

    /// Why a render can't go on from a file of sums, if so; `film` is what it would be taken up on.
    pub(crate) fn refuses(&self, kept: &Kept, film: &Film, end: u32) -> Option<Error> {
        let name = kept.path.display();
        let differences = kept.stamp.differences(&self.stamp(film, self.first), &[]);
        if !differences.is_empty() {
            return Some(Error::Request(format!("can't go on from {name}: {}", differences.join(", "))));
        }
        if kept.stamp.span.region != film.region() || kept.stamp.held != film.held() {
            return Some(Error::Request(format!(
                "can't go on from {name}: it holds other sums than are needed"
            )));
        }
        (kept.stamp.span.end > end).then(|| {
            let (there, here) = (kept.samples(), end - self.first);
            Error::Request(format!(
                "can't go on from {name}: it has {there} samples of each pixel, more than the {here} that are wanted"
            ))
        })
    }
}

/// Pictures put together from files of sums.
#[derive(Debug)]
pub struct Merged {
    /// The picture.
    pub picture: Picture,
    /// How the scene wants it developed.
    pub look: Look,
    /// Samples of each pixel.
    pub samples: u32,
    /// What is missing, where that was allowed.
    pub gaps: Vec<String>,
}

/// What is no error when files of sums are put together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Allowed {
    /// That samples are in none of them.
    pub gaps: bool,
    /// How many bytes of memory are taken, if there is a limit.
    pub memory: Option<u64>,
}

/// Puts files of sums together, in whatever order they are given. Samples that several of them have are an error, and so are
/// samples that none has, unless that is allowed.
pub fn merge(mut parts: Vec<Kept>, allowed: Allowed) -> Result<Merged, SumsError> {
    parts.sort_by_key(|p| (p.stamp.span.crop.min[1], p.stamp.span.crop.min[0], p.stamp.span.first));
    let Some(first) = parts.first() else { return Err(SumsError::Parts("no sums to merge".into())) };
    let stamp = first.stamp.clone();
    for part in &parts[1..] {
        let differences = first.stamp.differences(&part.stamp, &["first sample", "crop"]);
        if !differences.is_empty() {
            let [a, b] = [first, part].map(|p| p.path.display().to_string());
            let differences: Vec<String> = differences
                .iter()
                .map(|d| {
                    d.replace(" there and ", &format!(" in {a}, ")).replace(" here", &format!(" in {b}"))
                })
                .collect();
            return Err(SumsError::Parts(format!(
                "{a} and {b} aren't parts of one picture: {}",
                differences.join("; ")
            )));
        }
    }
    if let Some(midway) = parts.iter().find(|p| p.stamp.is_midway && parts.len() > 1) {
        return Err(SumsError::Parts(format!(
            "{} was written in the middle of a pass, so that some pixels have more samples than others: by itself it makes a \
             picture, and `straal render --resume` goes on from it",
            midway.path.display()
        )));
    }
    let (crop, end) = frame(&parts)?;
    let whole = parts.iter().filter_map(|p| p.stamp.whole).max().unwrap_or(end).max(end);
    let missing = missing(&parts, whole);
    if !missing.is_empty() && !allowed.gaps {
        return Err(SumsError::Gaps(missing.join("; ")));
    }
    if stamp.tells("noise").is_some() && parts.iter().any(|p| p.stamp.span.first != 0) {
        return Err(SumsError::Parts("parts of an adaptive render are crops, not runs of samples".into()));
    }
    let region = parts.iter().map(|p| p.stamp.span.region).reduce(cover).unwrap_or(crop);
    check_memory(&stamp, [crop, region], allowed.memory)?;
    let mut joined = Joined::new(stamp.size, [crop, region], &stamp.held, stamp.error);
    let mut groups: Vec<Region> = Vec::new();
    for part in &mut parts {
        let span = part.stamp.span;
        if groups.last() != Some(&span.crop) {
            groups.push(span.crop);
        }
        let group = groups.len() as u32;
        part.sums(|stamp, input| joined.add(&span, group, input, stamp.dropped))?;
    }
    if !missing.is_empty() {
        joined.has_gaps();
    }
    let film = joined.into_film();
    let samples = of_first_crop(&parts);
    let space = stamp.tells("space").and_then(Space::named).unwrap_or_default();
    let space = match stamp.tells("channels") {
        Some("xyz") => straal_color::RgbSpace::XYZ,
        _ => space.rgb(),
    };
    let mut picture = Picture::new(&film, film.layers(), space);
    picture.story = stamp.story.clone();
    let place = picture.story.iter().position(|(k, _)| k == "straal.crop");
    if let Some((_, value)) = place.and_then(|i| picture.story.get_mut(i)) {
        *value = format!("{},{},{},{}", crop.min[0], crop.min[1], crop.max[0], crop.max[1]);
    }
    picture.story.retain(|(k, _)| k != "straal.first_sample");
    picture.story.push(("straal.samples".into(), samples.to_string()));
    picture.story.push(("straal.passes".into(), crate::job::passes(samples).to_string()));
    picture.story.push(("straal.film_hash".into(), hash_of(&picture.layers.rgb)));
    Ok(Merged { picture, look: stamp.look, samples, gaps: missing })
}

/// Whether the film and its layers can be held.
fn check_memory(stamp: &Stamp, [crop, region]: [Region; 2], limit: Option<u64>) -> Result<(), SumsError> {
    let Held { costs, bands, guides, .. } = &stamp.held;
    // Numbers of a pixel in all layers: of light, its variance and the guides, the error, costs and bands.
    let layers = 3
        + if *guides { 3 + 3 + 3 + 1 + 1 } else { 0 }
        + if stamp.error.is_some() { 3 } else { 0 }
        + if costs.is_some() { 3 } else { 0 }
        + bands.as_ref().map_or(0, Bands::count);
    // Records lie aligned in memory, and it is known where each came from.
    let film = (stamp.held.bytes_a_pixel(0) + 16) as u64 * region.area() as u64;
    let needs = PROGRAM + film + 4 * layers as u64 * crop.area() as u64;
    match limit {
        Some(limit) if needs > limit => Err(SumsError::Memory(Shortage {
            what: "the picture that is put together".into(),
            needs,
            most: Some(("the film", film)),
            limit,
            help: "merge fewer crops at a time",
        })),
        _ => Ok(()),
    }
}

/// Samples of each pixel of the first crop; with noise, of those that have the most in any.
fn of_first_crop(parts: &[Kept]) -> u32 {
    let of = |crop: Region| parts.iter().filter(|p| p.stamp.span.crop == crop).map(Kept::samples).sum();
    parts.iter().map(|p| of(p.stamp.span.crop)).max().unwrap_or(0)
}

fn cover(a: Region, b: Region) -> Region {
    let pick = |f: fn(u32, u32) -> u32, a: [u32; 2], b: [u32; 2]| [f(a[0], b[0]), f(a[1], b[1])];
    Region { min: pick(Ord::min, a.min, b.min), max: pick(Ord::max, a.max, b.max) }
}

/// The rectangle that all crops make together, and the greatest end of samples.
fn frame(parts: &[Kept]) -> Result<(Region, u32), SumsError> {
    let mut crops: Vec<(Region, &Path)> = Vec::new();
    for part in parts {
        let (crop, path) = (part.stamp.span.crop, part.path.as_path());
        if crops.iter().any(|(c, _)| *c == crop) {
            continue;
        }
        let twin = crops.iter().find(|(c, _)| {
            let both = c.intersection(crop);
            both.width() > 0 && both.height() > 0
        });
        if let Some((_, other)) = twin {
            let (a, b) = (other.display(), path.display());
            return Err(SumsError::Parts(format!("the crops of {a} and {b} overlap")));
        }
        crops.push((crop, path));
    }
    let all = crops.iter().map(|(c, _)| *c).reduce(cover).unwrap_or(Region::whole([0, 0]));
    let covered: usize = crops.iter().map(|(c, _)| c.area()).sum();
    if covered != all.area() {
        return Err(SumsError::Parts(format!(
            "the crops leave {} pixels between them empty: together they must be a rectangle",
            all.area() - covered
        )));
    }
    let end = parts.iter().map(|p| p.stamp.span.end).max().unwrap_or(0);
    for (i, a) in parts.iter().enumerate() {
        for b in parts[i + 1..].iter().filter(|b| b.stamp.span.crop == a.stamp.span.crop) {
            let [sa, sb] = [a, b].map(|p| p.stamp.span);
            if sa.first.max(sb.first) < sa.end.min(sb.end) {
                return Err(SumsError::Parts(format!(
                    "samples {}..{} are in {} and in {}: no sample may count twice",
                    sa.first.max(sb.first),
                    sa.end.min(sb.end),
                    a.path.display(),
                    b.path.display()
                )));
            }
        }
    }
    Ok((all, end))
}

/// The samples that no part has, crop by crop. The parts are in order.
fn missing(parts: &[Kept], whole: u32) -> Vec<String> {
    let mut told = Vec::new();
    let adapts = parts.iter().any(|p| p.stamp.tells("noise").is_some());
    let mut tell = |range: std::ops::Range<u32>, crop: Region| {
        if !range.is_empty() {
            let [x0, y0] = crop.min;
            let [x1, y1] = crop.max;
            told.push(format!(
                "samples {}..{} of the crop {x0},{y0},{x1},{y1} are in none of the files",
                range.start, range.end
            ));
        }
    };
    let mut at = 0;
    for (i, part) in parts.iter().enumerate() {
        let Span { crop, first, end, .. } = part.stamp.span;
        tell(at..first, crop);
        at = end;
        if parts.get(i + 1).is_none_or(|next| next.stamp.span.crop != crop) {
            // Noise ends crops at other numbers of samples.
            if !adapts {
                tell(at..whole, crop);
            }
            at = 0;
        }
    }
    told
}
