//! What `straal tree` takes.

use super::ReadingArgs;
use crate::exit;
use clap::Args;
use std::path::PathBuf;

pub(super) const TREE_ABOUT: &str = "\
Prints what stands in a scene as a tree: groups and what is in them, instances and the objects that they show, with the steps that place \
each. With --matrices and --points it shows what the steps do.";

/// `straal tree`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct TreeArgs {
    /// The scene or mesh
    pub scene: PathBuf,

    /// Show the matrix of each step, of all together, its inverse, and that of normals
    #[arg(long)]
    pub matrices: bool,

    /// Show points of each thing after each step, in the world, and as the camera sees them
    #[arg(long)]
    pub points: bool,

    #[command(flatten)]
    pub reading: ReadingArgs,
}
