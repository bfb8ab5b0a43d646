//! What `straal diff` takes.

use crate::exit;
use clap::Args;
use std::path::PathBuf;

pub(super) const DIFF_ABOUT: &str = "\
Tells whether two pictures of the same scene differ by more than chance: by Welch's t-test at every pixel and on 8 x \
8 blocks of pixels, corrected for the number of tests.

The noise of A comes from its layer `variance`, which every EXR of straal has (best measured with --replicates). The \
noise of B comes from --variance, else from B's own layer `variance`.";

const DIFF_EXAMPLES: &str = "\
Examples:
  straal diff mine.exr reference.exr --variance reference-variance.exr
  straal diff before.exr after.exr --json | jq .relmse";

/// `straal diff`
#[derive(Debug, Args)]
#[command(after_help = DIFF_EXAMPLES, after_long_help = format!("{DIFF_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct DiffArgs {
    /// The picture to judge
    pub a: PathBuf,

    /// The picture to judge it by
    pub b: PathBuf,

    /// A picture of the variance of B
    #[arg(long, value_name = "PICTURE")]
    pub variance: Option<PathBuf>,

    /// Judge pictures with rare bright pixels: by the mean of the picture and by blocks only
    #[arg(long)]
    pub heavy_tails: bool,

    /// Print one JSON object on standard output instead
    #[arg(long)]
    pub json: bool,
}
