//! What `straal info` takes.

use crate::exit;
use clap::Args;
use std::path::PathBuf;

pub(super) const INFO_ABOUT: &str = "\
Prints what a picture tells about itself: size, windows, colour space, layers with the least, the mean and the greatest \
number of each channel and how many are no numbers, and the metadata that straal wrote into it; whether the film hash among \
them is that of the pixels.";

/// `straal info`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct InfoArgs {
    /// An EXR, PNG, HDR or PFM picture
    pub picture: PathBuf,

    /// Print one JSON object instead
    #[arg(long)]
    pub json: bool,
}
