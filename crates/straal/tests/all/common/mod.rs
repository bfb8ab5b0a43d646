//! What the integration tests share.

use std::path::{Path, PathBuf};
use straal::{Control, Job, LoadOptions, Outcome, Overrides};

/// The project's own folder.
pub fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

#[path = "../../../../../tests/shared.rs"]
mod shared_data;

pub use shared_data::shared;

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
