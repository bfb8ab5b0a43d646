//! Where the models, maps and reference pictures are that some tests need; each crate's tests include this file.

use std::io::Write;
use std::path::{Path, PathBuf};

/// The folder of shared data: where `STRAAL_SHARED` says, else beside the project. Without it the test is skipped, which is said
/// where everybody sees it; on a CI machine it fails.
pub fn shared() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let found = std::env::var_os("STRAAL_SHARED").map_or_else(beside, PathBuf::from);
    if found.join("scenes").is_dir() {
        return Some(found);
    }
    assert!(std::env::var_os("CI").is_none(), "no shared data at {}", found.display());
    // What is printed by macros is shown of tests that fail only.
    let test = std::thread::current().name().unwrap_or("a test").to_owned();
    let _ = writeln!(std::io::stderr(), "skipped: no shared data: {test}");
    None
}
