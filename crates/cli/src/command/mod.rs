//! The commands, one each file, and what several of them need.

pub mod accel;
pub mod check;
pub mod completions;
pub mod convert;
pub mod denoise;
pub mod develop;
pub mod diff;
pub mod frames;
pub mod gamma_chart;
pub mod info;
pub mod man;
pub mod merge;
pub mod metamer;
pub mod render;
pub mod sampler;
pub mod schema;
pub mod tree;

use crate::exit::Failure;
use crate::places::is_stream;
use crate::quantity::grouped;
use std::io::{self, IsTerminal, Read};
use std::path::Path;
use straal::{LoadOptions, Loaded};
use straal_formats::files::Refusal;
use straal_formats::{Limits, image};
use straal_scene::{Diagnostic, Diagnostics, Span};

/// Prints a result; that it could not be printed is a failure of the system.
fn print(text: &str) -> Result<(), Failure> {
    crate::out::result(text).map_err(|e| Failure::system(format!("can't write to standard output: {e}")))
}

/// Files that are written one after the other: one that fails doesn't keep the others from being tried.
#[derive(Default)]
struct Writing {
    written: Vec<String>,
    failed: Vec<String>,
}

impl Writing {
    /// Takes note of what became of a file.
    fn note<E: std::fmt::Display>(&mut self, path: &Path, done: Result<(), E>) {
        match done {
            Ok(()) => self.written.push(path.display().to_string()),
            Err(e) => self.failed.push(e.to_string()),
        }
    }

    /// Writes a picture: `stream` to standard output where that is its place, else `file`.
    fn picture<E: std::fmt::Display>(
        &mut self,
        path: &Path,
        stream: impl FnOnce(&mut dyn io::Write) -> io::Result<()>,
        file: impl FnOnce(&Path) -> Result<(), E>,
    ) {
        if is_stream(path) {
            let done = crate::out::picture(stream);
            self.note(path, done.map_err(|e| format!("can't write to standard output: {e}")));
        } else {
            self.note(path, file(path));
        }
    }

    /// All failures as one, with what was written all the same.
    fn end(self) -> Result<(), Failure> {
        if self.failed.is_empty() {
            return Ok(());
        }
        let failure = Failure::system(self.failed.join("; "));
        if self.written.is_empty() {
            return Err(failure);
        }
        Err(failure.help(format!("written all the same: {}", self.written.join(", "))))
    }
}

/// A scene or bare mesh with all its files; from standard input for `-`.
fn load(path: &Path, options: &LoadOptions) -> Result<Loaded, Failure> {
    if !is_stream(path) {
        return straal::load(path, options).map_err(Failure::scene);
    }
    straal::load_stream("standard input", &standard_input()?, options).map_err(Failure::scene)
}

/// All of standard input, unless that is more than a file may have.
fn standard_input() -> Result<Vec<u8>, Failure> {
    let fail = |problem: String| Failure::input(format!("can't read standard input: {problem}"));
    if io::stdin().is_terminal() {
        let help = "`-` reads what a pipe brings, as in `make-scene | straal render -`";
        return Err(fail("it is a terminal".into()).help(help));
    }
    let most = Limits::default().max_bytes;
    let mut bytes = Vec::new();
    io::stdin().lock().take(most + 1).read_to_end(&mut bytes).map_err(|e| fail(e.to_string()))?;
    if bytes.len() as u64 > most {
        return Err(fail(format!("it has more than {} bytes", grouped(most))));
    }
    Ok(bytes)
}

/// Bounds on a picture that is read: it may take what memory is free.
fn picture_limits() -> Limits {
    let usual = Limits::default();
    let free = crate::machine::memory().unwrap_or(usual.max_decoded);
    Limits { max_decoded: usual.max_decoded.min(free), ..usual }
}

/// The bytes of a picture; of standard input for `-`.
fn read_picture(path: &Path) -> Result<Vec<u8>, Failure> {
    if is_stream(path) {
        return standard_input();
    }
    image::bytes(path, &Limits::default()).map_err(|refusal| not_read(path, refusal))
}

/// Why a file isn't read.
fn not_read(path: &Path, refusal: Refusal) -> Failure {
    let failure = Failure::input(format!("can't read {}: {}", path.display(), refusal.problem));
    match refusal.help {
        Some(help) => failure.help(help),
        None => failure,
    }
}

/// Adds what a job's author should know to the complaints of its scene.
fn warn(complaints: &mut Diagnostics, job: &straal::Job) {
    for note in &job.world.notes {
        complaints.push(Diagnostic::warning(Span::NONE, note));
    }
    for dropped in &job.world.dropped {
        complaints.push(Diagnostic::warning(dropped.span, &dropped.message));
    }
}

/// Why the library won't do a job, with the place in the scene where it knows one; `read` holds the scene's texts.
fn refused(error: straal::Error, read: &Diagnostics) -> Failure {
    match error {
        straal::Error::Memory(shortage) => Failure::memory(&shortage),
        straal::Error::Render(e) => Failure::system(e.to_string()),
        straal::Error::Scene(complaint) => {
            let mut complaints = Diagnostics::default();
            complaints.sources = read.sources.clone();
            complaints.push(*complaint);
            Failure::scene(complaints)
        }
        other => Failure::input(other.to_string()),
    }
}
