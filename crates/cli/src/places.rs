//! Where results go: whether a file can be there, and whether that would destroy what the result is made of.

use crate::exit::Failure;
use std::path::{Path, PathBuf};
use straal_formats::atomic;

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
        if before.iter().any(|b| *b == path || is_same_file(b, path)) {
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
        if let Some(input) = inputs.iter().find(|input| is_same_file(path, input)) {
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
