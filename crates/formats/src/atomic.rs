//! Files that are either written whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::temporary::Temporary;
pub use crate::temporary::abandon;

/// A file that couldn't be written. What was there before under that name is still there, untouched.
#[derive(Debug, thiserror::Error)]
#[error("can't write {}: {source}", path.display())]
pub struct WriteError {
    /// The file that was to be written.
    pub path: PathBuf,
    /// What the system, or the encoder, said.
    pub source: io::Error,
}

/// Writes a file through `fill`: into a temporary file beside it, which takes the name `path` only once all of
/// it is on the disk. A reader sees the old file or the whole new one, and a failure leaves nothing behind.
pub fn write<F>(path: &Path, fill: F) -> Result<(), WriteError>
where
    F: FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
{
    write_io(path, fill).map_err(|source| WriteError { path: path.to_path_buf(), source })
}

/// Whether [`write()`] could make its file, found out by making an empty one that goes away again: better to learn it
/// before an hour of rendering than after.
pub fn check(path: &Path) -> Result<(), WriteError> {
    check_io(path).map_err(|source| WriteError { path: path.to_path_buf(), source })
}

fn check_io(path: &Path) -> io::Result<()> {
    match Target::of(path)? {
        // To open a pipe and close it again would tell its reader that nothing comes.
        Target::Device(_) => Ok(()),
        Target::File(path) => Temporary::beside(&path).map(drop),
    }
}

/// What a name stands for.
enum Target {
    /// A file that is there, or can be.
    File(PathBuf),
    /// What can't be replaced by a file: a pipe or a device such as `/dev/null`.
    Device(PathBuf),
}

impl Target {
    fn of(path: &Path) -> io::Result<Self> {
        // A link is followed, so that the file it names is replaced and not the link.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        if path.file_name().is_none() || path.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        Ok(if path.exists() && !path.is_file() { Self::Device(path) } else { Self::File(path) })
    }
}

fn write_io(path: &Path, fill: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> io::Result<()> {
    let path = match Target::of(path)? {
        Target::Device(path) => return fill_device(&path, fill),
        Target::File(path) => path,
    };
    let temporary = Temporary::beside(&path)?;
    let mut writer = BufWriter::with_capacity(1 << 16, temporary.file());
    let filled = fill(&mut writer).and_then(|()| writer.flush());
    // What couldn't be written isn't tried again.
    let _ = writer.into_parts();
    filled?;
    temporary.file().sync_all()?;
    temporary.name(&path)
}

/// Writes straight into a pipe or a device.
fn fill_device(path: &Path, fill: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> io::Result<()> {
    let device = File::options().write(true).open(path)?;
    let mut writer = BufWriter::with_capacity(1 << 16, &device);
    fill(&mut writer)?;
    writer.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.pfm");
        write(&path, |w| w.write_all(b"first")).unwrap();
        write(&path, |w| w.write_all(b"second")).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.pfm");
        write(&path, |w| w.write_all(b"first")).unwrap();
        let error = write(&path, |w| {
            w.write_all(&[0; 1 << 17])?;
            Err(io::Error::other("the encoder gave up"))
        })
        .unwrap_err();
        assert_eq!(error.to_string(), format!("can't write {}: the encoder gave up", path.display()));
        assert_eq!(std::fs::read(&path).unwrap(), b"first");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn folders_are_told_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("nowhere").join("picture.png");
        let error = write(&missing, |_| Ok(())).unwrap_err();
        assert_eq!(error.path, missing);
        assert_eq!(error.source.kind(), io::ErrorKind::NotFound);
        assert_eq!(check(&missing).unwrap_err().source.kind(), io::ErrorKind::NotFound);
        for error in [write(folder.path(), |_| Ok(())).unwrap_err(), check(folder.path()).unwrap_err()] {
            assert!(error.to_string().ends_with("it is a folder"), "{error}");
        }
    }

    #[test]
    fn a_check_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        check(&folder.path().join("picture.pfm")).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        #[cfg(unix)]
        check(Path::new("/dev/null")).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_and_devices_stay_what_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        std::fs::write(&target, b"old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        write(&link, |w| w.write_all(b"new")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&target).unwrap(), b"new");
        write(Path::new("/dev/null"), |w| w.write_all(b"gone")).unwrap();
        assert!(!Path::new("/dev/null").is_file());
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_an_ordinary_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write(&ours, |_| Ok(())).unwrap();
        std::fs::write(&plain, b"").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
