//! The commands, one each file, and what several of them need.

pub mod accel;
pub mod check;
pub mod completions;
pub mod develop;
pub mod diff;
pub mod gamma_chart;
pub mod info;
pub mod man;
pub mod merge;
pub mod metamer;
pub mod render;
pub mod sampler;
pub mod schema;

use crate::exit::Failure;
use std::path::Path;
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

/// Bounds on a picture that is read: it may take what memory is free.
fn picture_limits() -> Limits {
    let usual = Limits::default();
    let free = crate::machine::memory().unwrap_or(usual.max_decoded);
    Limits { max_decoded: usual.max_decoded.min(free), ..usual }
}

/// The bytes of a picture.
fn read_picture(path: &Path) -> Result<Vec<u8>, Failure> {
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
        straal::Error::Compile(e) => {
            let mut complaints = Diagnostics::default();
            complaints.sources = read.sources.clone();
            complaints.push(Diagnostic::error(e.span, e.message));
            Failure::scene(complaints)
        }
        other => Failure::input(other.to_string()),
    }
}
