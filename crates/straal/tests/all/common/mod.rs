//! What the integration tests share.
#![allow(dead_code, clippy::print_stdout)] // each test binary uses its part; a skipped test says so

use std::path::{Path, PathBuf};
use straal::{Control, Job, LoadOptions, Outcome, Overrides};

/// The project's own folder.
pub fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The folder of models and reference pictures, if this machine has it; a test that can't go on without it says so.
pub fn shared() -> Option<PathBuf> {
    let named = std::env::var_os("STRAAL_SHARED").map(PathBuf::from);
    let found = named.unwrap_or_else(|| project().join("../shared"));
    if found.join("reference").is_dir() {
        return Some(found);
    }
    assert!(std::env::var_os("CI").is_none(), "no shared data at {}", found.display());
    println!("skipped: no shared data");
    None
}

/// A scene of the project, ready to render.
pub fn job(scene: &str, wish: Overrides) -> Job {
    let path = project().join(scene);
    let loaded = straal::load(&path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{scene}:\n{e}"));
    Job::new(loaded, wish).unwrap_or_else(|e| panic!("{scene}: {e}"))
}

/// Renders it.
pub fn render(scene: &str, wish: Overrides) -> Outcome {
    job(scene, wish).render(&mut Control::to_the_end()).unwrap_or_else(|e| panic!("{scene}: {e}"))
}
