//! What the tests of this crate share.

use std::path::PathBuf;

/// The folder of shared assets (`STRAAL_SHARED`, else beside the project), or a note that a test is skipped.
pub fn shared() -> Option<PathBuf> {
    let folder = std::env::var_os("STRAAL_SHARED")
        .map(PathBuf::from)
        .unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"));
    if !folder.is_dir() {
        #[allow(clippy::print_stdout)] // a note to whoever runs the tests
        {
            println!("skipped: no shared data");
        }
        return None;
    }
    Some(folder)
}
