//! Where a scene's files are.
//!
//! Mitsuba is told folders on its command line, so that scenes name files which aren't beside them. A name is looked for in the scene's
//! folder, in that of the file that says it, in those of `<path>`, in the present one, and then around the scene: in the
//! folders that it lies in and in those beside it, where it must be in one of them only.

use std::path::{Path, PathBuf};

use crate::files::{Finder, Refusal};

/// So many folders above the scene's are looked into.
const UP: usize = 3;

/// Folders with more in them aren't looked through.
const MOST: usize = 1000;

/// Where files were found before.
#[derive(Default)]
pub(super) struct Search {
    /// From the scene's folder.
    found_in: Vec<String>,
    /// Folders around the scene, once someone asked.
    around: Option<Vec<Vec<String>>>,
}

/// A file.
pub(super) struct Found {
    /// Its name from the scene's folder.
    pub name: String,
    /// Where it is.
    pub path: PathBuf,
    /// The folder, where it is one that nobody named and that is met first.
    pub told: Option<String>,
}

impl Search {
    /// Looks for a file; `folders` are where it may be besides the scene's own, `base`.
    pub fn find(
        &mut self,
        finder: &mut Finder,
        (base, folders): (&Path, &[PathBuf]),
        name: &str,
    ) -> Result<Found, Refusal> {
        let refused = match finder.find(base, name) {
            Ok(found) => return Ok(Found { name: name.to_owned(), path: found.path, told: None }),
            Err(refusal) if refusal.is_missing() => refusal,
            Err(refusal) => return Err(refusal),
        };
        if name.is_empty() || Path::new(name).is_absolute() {
            return Err(refused);
        }
        let from_base = |folder: &Path| {
            let here = if base.as_os_str().is_empty() { None } else { folder.strip_prefix(base).ok() };
            let folder = match here {
                Some(inside) => inside.to_owned(),
                None if folder.is_absolute() || base.as_os_str().is_empty() => folder.to_owned(),
                None => std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned()),
            };
            folder.to_string_lossy().into_owned()
        };
        let mut named: Vec<String> = folders.iter().map(|folder| from_base(folder)).collect();
        named.extend(std::path::absolute(".").ok().map(|here| here.to_string_lossy().into_owned()));
        named.splice(0..0, self.found_in.iter().cloned());
        for prefix in &named {
            if let Some(found) = at(finder, base, prefix, name) {
                return Ok(found);
            }
        }
        let around = self.around.get_or_insert_with(|| around(base)).clone();
        for step in around {
            let mut here: Vec<Found> =
                step.iter().filter_map(|prefix| at(finder, base, prefix, name)).collect();
            if here.len() == 1
                && let Some(found) = here.pop()
            {
                let folder = found.name[..found.name.len() - name.len()].trim_end_matches('/').to_owned();
                self.found_in.push(folder.clone());
                return Ok(Found { told: Some(folder), ..found });
            }
        }
        Err(refused)
    }
}

fn at(finder: &mut Finder, base: &Path, prefix: &str, name: &str) -> Option<Found> {
    let name = if prefix.is_empty() { name.to_owned() } else { format!("{prefix}/{name}") };
    let found = finder.find(base, &name).ok().filter(|found| found.instead.is_none())?;
    found.path.is_file().then_some(Found { name, path: found.path, told: None })
}

/// The folders above the scene's, and beside each, from the nearest on.
fn around(base: &Path) -> Vec<Vec<String>> {
    let mut steps = Vec::new();
    let mut up = String::from("..");
    for _ in 0..UP {
        steps.push(vec![up.clone()]);
        let entries = std::fs::read_dir(base.join(&up)).into_iter().flatten().take(MOST).flatten();
        let folders = entries.filter(|e| e.path().is_dir()).filter_map(|e| e.file_name().into_string().ok());
        let mut beside: Vec<String> =
            folders.filter(|f| !f.starts_with('.')).map(|f| format!("{up}/{f}")).collect();
        beside.sort();
        steps.push(beside);
        up += "/..";
    }
    steps
}
