//! `straal convert`

use super::{Writing, load};
use crate::args::ConvertArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use std::fs;
use std::io::Write;
use std::path::Path;
use straal::written;
use straal_formats::atomic;

/// Reads a scene and writes it in the scene language.
pub fn run(args: &ConvertArgs) -> Result<Exit, Failure> {
    let extension = args.output.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !matches!(extension.as_str(), "yaml" | "yml" | "json") {
        let message = format!("`{}`: a scene is written as .yaml", args.output.display());
        return Err(Failure::input(message).help("such as `straal convert scene.glb scene.yaml`"));
    }
    let loaded = load(&args.scene, &args.reading.options())?;
    if !args.quiet {
        out::say(&complaint::show(&loaded.warnings, out::has_colours()));
    }
    let is_same =
        |path: &Path| path.canonicalize().ok().is_some_and(|p| args.output.canonicalize().ok() == Some(p));
    if loaded.files.iter().any(|file| is_same(file)) || is_same(&args.scene) {
        let message = format!("`{}` is what is read: it isn't written over", args.output.display());
        return Err(Failure::input(message).help("choose another name"));
    }
    let beside = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    // A bare mesh is named from the current folder.
    let base = if straal::is_mesh(&args.scene) { Path::new("").to_owned() } else { beside(&args.scene) };
    let folder = beside(&args.output);
    let stem =
        args.output.file_stem().map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned());
    let pieces = format!("{stem}_files");
    let converted = written::converted(&loaded, &base, &folder, &pieces);
    if !converted.pieces.is_empty() {
        let place = folder.join(&pieces);
        fs::create_dir_all(&place)
            .map_err(|e| Failure::system(format!("can't make the folder {}: {e}", place.display())))?;
    }
    let mut writing = Writing::default();
    for (name, piece) in &converted.pieces {
        let path = folder.join(name);
        writing.note(&path, atomic::write(&path, |out| piece.write(out)));
    }
    writing.note(&args.output, atomic::write(&args.output, |out| out.write_all(converted.text.as_bytes())));
    writing.end()?;
    if !args.quiet {
        let more = match converted.pieces.len() {
            0 => String::new(),
            count => format!(", and {count} files in {}", folder.join(&pieces).display()),
        };
        out::say(&format!("wrote {}{more}\n", args.output.display()));
    }
    Ok(Exit::Fine)
}
