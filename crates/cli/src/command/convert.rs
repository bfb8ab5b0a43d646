//! `straal convert`

use super::{Writing, load};
use crate::args::ConvertArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::out;
use crate::places::is_stream;
use std::fs;
use std::io::Write;
use std::path::Path;
use straal::written;
use straal_formats::scene::gltf_out::{Form, Frames, MOST_FRAMES};
use straal_formats::{Loaded, atomic};

/// What a scene is written as.
enum Kind {
    /// The scene language.
    Own,
    /// glTF, in one file or with a buffer beside it.
    Gltf { is_packed: bool },
}

/// Reads a scene and writes it in the scene language or as glTF.
pub fn run(args: &ConvertArgs) -> Result<Exit, Failure> {
    let extension = args.output.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let kind = match extension.as_str() {
        "yaml" | "yml" | "json" => Kind::Own,
        "gltf" => Kind::Gltf { is_packed: false },
        "glb" => Kind::Gltf { is_packed: true },
        _ => {
            let message = format!("`{}`: a scene is written as .yaml, .gltf or .glb", args.output.display());
            return Err(Failure::input(message).help("such as `straal convert scene.glb scene.yaml`"));
        }
    };
    let loaded = load(&args.scene, &args.reading.options())?;
    if !args.quiet {
        out::say(&complaint::show(&loaded.warnings, out::has_colours()));
    }
    let buffer = args.output.with_extension("bin");
    let outputs = match kind {
        Kind::Gltf { is_packed: false } => vec![&args.output, &buffer],
        _ => vec![&args.output],
    };
    for output in outputs {
        let is_same =
            |path: &Path| path.canonicalize().ok().is_some_and(|p| output.canonicalize().ok() == Some(p));
        if loaded.files.iter().any(|file| is_same(file)) || is_same(&args.scene) {
            let message = format!("`{}` is what is read: it isn't written over", output.display());
            return Err(Failure::input(message).help("choose another name"));
        }
    }
    match kind {
        Kind::Own => own(args, &loaded),
        Kind::Gltf { is_packed: true } => gltf(args, &loaded, None),
        Kind::Gltf { is_packed: false } => gltf(args, &loaded, Some(&buffer)),
    }
}

/// Writes it as glTF, with its buffer in a file of its own if there is a name for one.
fn gltf(args: &ConvertArgs, loaded: &Loaded, buffer: Option<&Path>) -> Result<Exit, Failure> {
    let name = buffer.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let form = name.as_deref().map_or(Form::Packed, Form::Beside);
    let mut frames = Frames::of(loaded);
    // One frame that is asked for is written by itself.
    let of = match loaded.scene.animation.frames {
        // What a pipe brings is there but once.
        2.. if is_stream(&args.scene) => {
            out::say("warning: of a scene of standard input one frame is written\n");
            1
        }
        _ if args.reading.frame.is_some() => 1,
        all => all,
    };
    if of > MOST_FRAMES {
        out::say(&format!("warning: of {of} frames the first {MOST_FRAMES} are written\n"));
    }
    // Files are read once for all frames.
    let mut options = args.reading.options();
    for frame in 1..of.min(MOST_FRAMES) {
        options.frame = f64::from(frame);
        frames.add(&load(&args.scene, &options)?);
    }
    let written = frames
        .write(form)
        .map_err(|problem| Failure::input(format!("`{}`: {problem}", args.output.display())))?;
    if !args.quiet {
        out::say(&complaint::show(&written.warnings, out::has_colours()));
    }
    let mut writing = Writing::default();
    let mut more = String::new();
    if let (Some(path), Some(bytes)) = (buffer, &written.buffer) {
        writing.note(path, atomic::write(path, |out| out.write_all(bytes)));
        more = format!(", and {}", path.display());
    }
    writing.note(&args.output, atomic::write(&args.output, |out| out.write_all(&written.bytes)));
    writing.end()?;
    if !args.quiet {
        out::say(&format!("wrote {}{more}\n", args.output.display()));
    }
    Ok(Exit::Fine)
}

/// Writes it in the scene language, with what its file holds itself in a folder beside it.
fn own(args: &ConvertArgs, loaded: &Loaded) -> Result<Exit, Failure> {
    let beside = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    // A bare mesh is named from the current folder.
    let base = if straal::is_mesh(&args.scene) { Path::new("").to_owned() } else { beside(&args.scene) };
    let folder = beside(&args.output);
    let stem =
        args.output.file_stem().map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned());
    let pieces = format!("{stem}_files");
    let converted = written::converted(loaded, &base, &folder, &pieces);
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
