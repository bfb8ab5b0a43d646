//! What `straal check` takes.

use crate::exit;
use clap::Args;
use std::path::PathBuf;

pub(super) const CHECK_ABOUT: &str = "\
Checks a scene without rendering it: reads all its files, tells everything that is wrong with them in one go, and \
forecasts how much memory a render takes.";

/// `straal check`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct CheckArgs {
    /// The scene or mesh
    pub scene: PathBuf,

    /// Print one JSON object on standard output instead
    #[arg(long)]
    pub json: bool,

    /// Read files from this folder only: what a scene names, and what those files name
    ///
    /// Symbolic links are followed first.
    #[arg(long, value_name = "DIR")]
    pub root: Option<PathBuf>,

    /// Take unknown keys for warnings
    #[arg(long)]
    pub lenient: bool,
}
