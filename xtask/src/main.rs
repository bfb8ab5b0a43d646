//! Chores of the project, one word each: `cargo xtask book`, `cargo xtask gallery`.
#![forbid(unsafe_code)]
// A chore talks to whoever runs it.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod book;
mod diagrams;
mod draw;
mod energy_tables;
mod gallery;
mod keys;
mod looks;
mod references;
mod uplift_table;
mod weights;

use std::path::PathBuf;
use std::process::ExitCode;

/// Why a chore couldn't be done.
type Failure = Box<dyn std::error::Error>;

const USAGE: &str = "\
usage: cargo xtask CHORE [NAME...]

  gallery      render the scenes of scenes/ (or those named) to book/src/images; `--minutes 5`: for no longer than that each
  references   render the reference scenes of the shared data (or those named) and compare them with their pictures
  book         bring the book's generated text and drawings up to date and make its HTML in target/book
  looks        make the book's pictures of tone curves, of blur by depth, of filters, of integrators, of denoising and of relighting (or those of one: `looks relighting`)
  uplift-table work out the table by which pixels become spectra; `uplift-table check` says whether it is as it is kept
  energy-tables check: hold the tables of what rough surfaces lose between their facets against the integrals
  weights      WHEEL: take the denoiser's weights out of the Python wheel of pyoidn 2.5.1.0 into crates/denoise/data; WHEEL FOLDER: all
               sets that there are, into FOLDER; check: whether the weights in crates/denoise/data are the published ones";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let Some((chore, names)) = words.split_first() else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let done = match chore.as_str() {
        "gallery" => gallery::run(names),
        "references" => references::run(names),
        "book" | "keys" => book::run(),
        "looks" => looks::run(names),
        "uplift-table" => uplift_table::run(names),
        "weights" => weights::run(names),
        "energy-tables" => energy_tables::run(names),
        _ => {
            eprintln!("there is no chore `{chore}`\n\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::FAILURE
        }
    }
}

/// The project's folder.
fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// The scene files of a folder of the project, by name without extension, in alphabetical order; all of them, or those
/// that are named.
fn scenes(folder: &str, names: &[String]) -> Result<Vec<(String, PathBuf)>, Failure> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(root().join(folder))? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == "yaml")
            && let Some(name) = path.file_stem().and_then(|s| s.to_str())
        {
            all.push((name.to_owned(), path));
        }
    }
    all.sort();
    if let Some(unknown) = names.iter().find(|n| all.iter().all(|(name, _)| name != *n)) {
        return Err(format!("there is no scene `{unknown}` in {folder}").into());
    }
    all.retain(|(name, _)| names.is_empty() || names.contains(name));
    Ok(all)
}
