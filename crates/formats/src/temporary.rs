//! The temporary file that becomes a picture once it is whole.
//!
//! Whoever writes one holds a lock on it, which the system takes away when the process ends, however it ends. So a
//! temporary file without a lock was left behind, by a `kill -9` or a power cut, and the next that writes into the same
//! folder removes it. Neither numbers of processes nor times are asked: both mislead where machines share a folder.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

const PREFIX: &str = ".straal-";
const SUFFIX: &str = ".part";

/// The temporary files of this process that are being written: what is to be removed if it ends in the middle. A signal
/// comes to the process as a whole, so that this list is the process's as well.
static WRITTEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn written() -> MutexGuard<'static, Vec<PathBuf>> {
    WRITTEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files that this process is writing: for those who end it without unwinding. What is being
/// written fails then, or ends before it is removed, and is whole.
pub fn abandon() {
    for path in written().drain(..) {
        let _ = fs::remove_file(path);
    }
}

/// A temporary file that goes away unless it gets a name.
pub(crate) struct Temporary {
    file: NamedTempFile,
    listed: Listed,
}

/// An entry of the list of what is being written.
struct Listed(PathBuf);

impl Listed {
    fn new(path: &Path) -> Self {
        written().push(path.to_path_buf());
        Self(path.to_path_buf())
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        written().retain(|p| *p != self.0);
    }
}

impl Temporary {
    /// In the folder of `path`, from which those are swept that nobody writes any more.
    pub(crate) fn beside(path: &Path) -> io::Result<Self> {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        sweep(folder);
        // Another process that sweeps may take the file for a leftover before it is locked, but hardly time and again.
        let mut tries = 0;
        loop {
            tries += 1;
            let file = create(folder)?;
            let listed = Listed::new(file.path());
            let locked = match file.as_file().try_lock() {
                Err(TryLockError::WouldBlock) => false,
                // Where there are no locks, nothing is swept either.
                Ok(()) | Err(TryLockError::Error(_)) => true,
            };
            if (locked && file.path().exists()) || tries == 8 {
                return Ok(Self { file, listed });
            }
        }
    }

    /// To write to.
    pub(crate) fn file(&self) -> &File {
        self.file.as_file()
    }

    /// Gives it the name `path`, in place of what has that name.
    pub(crate) fn name(self, path: &Path) -> io::Result<()> {
        let Self { file, listed } = self;
        let done = file.persist(path).map(drop).map_err(|failed| failed.error);
        drop(listed);
        done
    }
}

fn create(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    // A temporary file is private by default; a picture has the permissions of any file that the user makes.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Removes the temporary files in a folder that nobody writes any more.
fn sweep(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let is_ours = name.to_str().is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(SUFFIX));
        if !is_ours || !entry.file_type().is_ok_and(|t| t.is_file()) {
            continue;
        }
        let path = entry.path();
        let Ok(file) = OpenOptions::new().write(true).open(&path) else { continue };
        if file.try_lock().is_ok() {
            let _ = fs::remove_file(&path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_nobody_writes_is_swept() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in [".straal-left.part", ".straal-other", "straal-1.part", "picture.png"] {
            fs::write(at(name), b"half").unwrap();
        }
        let alive = Temporary::beside(&at("picture.png")).unwrap();
        let second = Temporary::beside(&at("picture.png")).unwrap();
        assert!(!at(".straal-left.part").exists());
        for name in [".straal-other", "straal-1.part", "picture.png"] {
            assert!(at(name).exists(), "{name}");
        }
        assert!(alive.file.path().exists());
        second.name(&at("second.png")).unwrap();
        drop(alive);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
    }

    #[cfg(unix)]
    #[test]
    fn what_a_leftover_of_that_name_leads_to_stays() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("precious"), b"all").unwrap();
        std::os::unix::fs::symlink(at("precious"), at(".straal-link.part")).unwrap();
        sweep(folder.path());
        assert!(at("precious").exists() && at(".straal-link.part").is_symlink());
    }
}
