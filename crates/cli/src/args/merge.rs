//! What `straal merge` takes.

use super::{DevelopmentArgs, MemoryArgs};
use crate::exit;
use clap::Args;
use std::path::PathBuf;

pub(super) const MERGE_ABOUT: &str = "\
Puts together parts of a picture that `straal render --save-sums` wrote, on whatever machines: runs of samples, crops, or \
both, in any order. The picture is that of one render of all of it, to the last bit. Samples that several files have are \
refused, and so are gaps.";

const MERGE_EXAMPLES: &str = "\
Examples:
  straal render scene.yaml --spp 128 --samples 0..64 --save-sums a.sums       here
  straal render scene.yaml --spp 128 --samples 64..128 --save-sums b.sums     there
  straal merge a.sums b.sums -o scene.exr -o scene.png
  straal merge scene.exr.checkpoint -o so-far.png --allow-gaps";

/// `straal merge`
#[derive(Debug, Args)]
#[command(after_help = MERGE_EXAMPLES, after_long_help = format!("{MERGE_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct MergeArgs {
    /// The files of sums
    #[arg(required = true)]
    pub sums: Vec<PathBuf>,

    /// Where the picture goes: .exr, .png, .hdr or .pfm; may be given several times
    #[arg(short, long = "output", value_name = "PICTURE", required = true)]
    pub output: Vec<PathBuf>,

    /// Take samples that are missing for a warning
    #[arg(long)]
    pub allow_gaps: bool,

    /// How much memory is taken
    #[command(flatten)]
    pub memory: MemoryArgs,

    /// How a PNG is developed
    #[command(flatten)]
    pub development: DevelopmentArgs,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}
