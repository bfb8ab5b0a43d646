//! The commands, one each file, and what several of them need.

pub mod accel;
pub mod check;
pub mod completions;
pub mod develop;
pub mod diff;
pub mod gamma_chart;
pub mod info;
pub mod man;
pub mod metamer;
pub mod render;
pub mod sampler;
pub mod schema;

use crate::exit::Failure;
use std::fs;
use std::path::Path;
use straal_scene::{Diagnostic, Diagnostics, Span};

/// Prints a result; that it could not be printed is a failure of the system.
fn print(text: &str) -> Result<(), Failure> {
    crate::out::result(text).map_err(|e| Failure::system(format!("can't write to standard output: {e}")))
}

/// The bytes of a picture.
fn read_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    // A device or a pipe could go on for ever.
    let fail = |problem: String| Failure::input(format!("can't read {}: {problem}", path.display()));
    let about = fs::metadata(path).map_err(|e| fail(e.to_string()))?;
    if !about.is_file() {
        return Err(fail("it is not a file".into()));
    }
    fs::read(path).map_err(|e| fail(e.to_string()))
}

/// Adds what a job's author should know to the complaints of its scene.
fn warn(complaints: &mut Diagnostics, job: &straal::Job) {
    for note in &job.world.notes {
        complaints.push(Diagnostic::warning(Span::NONE, note));
    }
}

/// Why the library won't do a job, with the place in the scene where it knows one; `read` holds the scene's texts.
fn refused(error: straal::Error, read: &Diagnostics) -> Failure {
    match error {
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
