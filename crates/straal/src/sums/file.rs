//! Writing and reading a file of sums, so that nothing damaged is taken for true.

use super::Stamp;
use blake3::Hasher;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use straal_render::film::{Film, Span};
use straal_scene::memory::Shortage;

const MAGIC: &[u8; 8] = b"straalSU";
const VERSION: u32 = 1;
/// Bytes of a hash.
const HASH: usize = 32;
/// More than any header has.
const MOST_HEADER: u32 = 1 << 16;

/// Writes the sums of a film behind what is told of them.
pub(crate) fn write(stamp: &Stamp, film: &Film, out: &mut dyn Write) -> io::Result<()> {
    let stamp = stamp.to_string();
    let mut out = Hashed::new(out);
    out.write_all(MAGIC)?;
    out.write_all(&VERSION.to_le_bytes())?;
    out.write_all(&(stamp.len() as u32).to_le_bytes())?;
    out.write_all(stamp.as_bytes())?;
    out.write_hash()?;
    film.write_sums(&mut out)?;
    out.write_hash()
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
