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
use crate::quantity::grouped;
use crate::settings::is_stream;
use std::fs;
use std::io::{self, IsTerminal, Read};
use std::path::Path;
use straal::{LoadOptions, Loaded};
use straal_formats::Limits;
use straal_scene::{Diagnostic, Diagnostics, Span};

/// Prints a result; that it could not be printed is a failure of the system.
fn print(text: &str) -> Result<(), Failure> {
    crate::out::result(text).map_err(|e| Failure::system(format!("can't write to standard output: {e}")))
}

/// The bytes of a picture; of standard input for `-`.
fn read_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    if is_stream(path) {
        return standard_input();
    }
    // A device or a pipe could go on for ever.
    let fail = |problem: String| Failure::input(format!("can't read {}: {problem}", path.display()));
    let about = fs::metadata(path).map_err(|e| fail(e.to_string()))?;
    if !about.is_file() {
        return Err(fail("it is not a file".into()));
    }
    fs::read(path).map_err(|e| fail(e.to_string()))
}

/// A scene or bare mesh with all its files; from standard input for `-`.
fn load(path: &Path, options: &LoadOptions) -> Result<Loaded, Failure> {
    if !is_stream(path) {
        return straal::load(path, options).map_err(Failure::scene);
    }
    let bytes = standard_input()?;
    straal::load_stream("standard input", &bytes, Path::new(""), options).map_err(Failure::scene)
}

/// All of standard input, unless that is more than a file may have.
fn standard_input() -> Result<Vec<u8>, Failure> {
    let fail = |problem: String| Failure::input(format!("can't read standard input: {problem}"));
    if io::stdin().is_terminal() {
        return Err(fail("it is a terminal".into())
            .help("`-` reads what a pipe brings, as in `make-scene | straal render -`"));
    }
    let most = Limits::default().max_bytes;
    let mut bytes = Vec::new();
    io::stdin().lock().take(most + 1).read_to_end(&mut bytes).map_err(|e| fail(e.to_string()))?;
    if bytes.len() as u64 > most {
        return Err(fail(format!("it has more than {} bytes", grouped(most))));
    }
    Ok(bytes)
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
