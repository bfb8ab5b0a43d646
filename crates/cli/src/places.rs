//! Where results go: whether a file can be there, and whether that would destroy what the result is made of.

use crate::exit::Failure;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use straal::picture::Format;
use straal_formats::atomic;

/// Whether a name stands for standard input or output.
pub fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// The format of what goes to a place, `stream` being that of standard output; `None` of what is no picture.
pub fn format_of(path: &Path, stream: Format) -> Option<Format> {
    if is_stream(path) { Some(stream) } else { Format::of(path).ok() }
}

/// Whether pictures can go to all these places; the format of what goes to standard output. `said` is what --format says.
pub fn check_pictures(outputs: &[PathBuf], said: Option<Format>, json: bool) -> Result<Format, Failure> {
    for path in outputs {
        if !is_stream(path) {
            Format::of(path).map_err(|e| Failure::input(e.to_string()))?;
            check_output(path)?;
        } else if json {
            let help = "write the picture to a file, or leave out --json";
            return Err(Failure::input("`-o -` and --json can't share standard output").help(help));
        } else if std::io::stdout().is_terminal() {
            let message = "`-o -` writes a picture to standard output, and that is a terminal";
            let help = "send it on, as in `straal render scene.yaml -o - > picture.png`";
            return Err(Failure::input(message).help(help));
        }
    }
    if said.is_some() && !outputs.iter().any(|o| is_stream(o)) {
        let help = "the name of a file says its format, such as `-o picture.exr`";
        return Err(Failure::input("--format is for `-o -`, standard output").help(help));
    }
    Ok(said.unwrap_or(Format::Png))
}

/// Whether a file can go there.
pub fn check_output(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::input(format!("{} is a folder", path.display())));
    }
    match path.parent() {
        Some(folder) if folder.exists() && !folder.is_dir() => {
            Err(Failure::input(format!("{} is not a folder", folder.display())))
        }
        Some(folder) if !folder.as_os_str().is_empty() && !folder.exists() => {
            let message = format!("there is no folder {} for {}", folder.display(), path.display());
            Err(Failure::input(message).help(format!("make it first: mkdir -p {}", folder.display())))
        }
        _ => atomic::check(path).map_err(|e| Failure::system(e.to_string())),
    }
}

/// Refuses two results of one name.
pub fn refuse_twins<'a>(outputs: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    let mut before: Vec<&Path> = Vec::new();
    for path in outputs {
        if before.iter().any(|b| *b == path || !is_stream(path) && is_same_file(b, path)) {
            return Err(Failure::input(format!("{} is named twice", path.display())));
        }
        before.push(path);
    }
    Ok(())
}

/// Refuses results that would replace what they are made of.
pub fn refuse_inputs<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: &[PathBuf],
) -> Result<(), Failure> {
    for path in outputs {
        // Standard output replaces nothing.
        let replaces = |input: &&PathBuf| !is_stream(path) && !is_stream(input) && is_same_file(path, input);
        if let Some(input) = inputs.iter().find(replaces) {
            let message = if path == input {
                format!("{} would replace what it is made from", path.display())
            } else {
                format!("{} would replace {}, which it is made from", path.display(), input.display())
            };
            return Err(Failure::input(message).help("give the result another name"));
        }
    }
    Ok(())
}

/// Whether both names lead to one file, by links of any kind as well. What isn't there yet is known by its folder.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((resolved(a), resolved(b)), (Some(a), Some(b)) if a == b) || is_hard_link(a, b)
}

fn resolved(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(folder.canonicalize().ok()?.join(path.file_name()?))
    })
}

#[cfg(unix)]
fn is_hard_link(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let name = |path: &Path| path.metadata().ok().filter(|m| m.is_file()).map(|m| (m.dev(), m.ino()));
    name(a).is_some_and(|a| name(b) == Some(a))
}

#[cfg(not(unix))]
fn is_hard_link(_: &Path, _: &Path) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_has_many_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("sub")).unwrap();
        std::fs::write(at("a.png"), b"a").unwrap();
        assert!(is_same_file(&at("a.png"), &at("sub/../a.png")));
        assert!(is_same_file(&at("new.png"), &at("sub/../new.png")));
        assert!(!is_same_file(&at("a.png"), &at("new.png")));
        assert!(!is_same_file(&at("a.png"), &at("sub/a.png")));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("a.png"), at("soft.png")).unwrap();
            std::fs::hard_link(at("a.png"), at("hard.png")).unwrap();
            assert!(is_same_file(&at("soft.png"), &at("a.png")));
            assert!(is_same_file(&at("hard.png"), &at("soft.png")));
        }
        let told = refuse_twins([at("new.png").as_path(), at("sub/../new.png").as_path()]).unwrap_err();
        assert!(told.message.ends_with("new.png is named twice"));
        let told = refuse_inputs([at("sub/../a.png").as_path()], &[at("b.obj"), at("a.png")]).unwrap_err();
        assert!(told.message.contains("would replace"), "{}", told.message);
    }
}
