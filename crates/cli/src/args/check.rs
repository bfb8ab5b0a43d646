//! What `straal check` takes.

use super::ReadingArgs;
use super::heading::{LIGHT, MACHINE, PICTURE, SAMPLING, SEARCH, TALK};
use super::parsers::{StructureParser, build, pattern};
use crate::exit;
use crate::quantity::{self, Crop, Size};
use clap::Args;
use std::path::PathBuf;
use straal::Recording;
use straal_accel::{Build, Structure};
use straal_math::lowdisc::PatternKind;

pub(super) const CHECK_ABOUT: &str = "\
Checks a scene without rendering it: reads all its files, tells everything that is wrong with them in one go, and \
forecasts how much memory a render takes: one with the same --size, --output and so on, to a tenth or so.";

/// `straal check`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct CheckArgs {
    /// The scene or mesh
    pub scene: PathBuf,

    /// Where the picture that is forecast would go: an .exr takes more than a .png
    #[arg(short, long = "output", value_name = "PICTURE", help_heading = PICTURE)]
    pub output: Vec<PathBuf>,

    /// Width and height of the picture that is forecast
    #[arg(long, value_name = "WxH", value_parser = quantity::size, help_heading = PICTURE)]
    pub size: Option<Size>,

    /// Its part that is rendered
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = quantity::crop, help_heading = PICTURE)]
    pub crop: Option<Crop>,

    /// In which numbers an EXR holds the picture
    #[arg(long, value_name = "NUMBERS", value_parser = quantity::recording, help_heading = PICTURE)]
    pub channels: Option<Recording>,

    /// With light by wavelengths
    #[arg(long, help_heading = LIGHT)]
    pub spectral: bool,

    /// With samples that count in several pixels
    #[arg(long, conflicts_with = "noise", help_heading = SAMPLING)]
    pub splat: bool,

    /// Sampled until its noise is at most this
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = quantity::noise, help_heading = SAMPLING)]
    pub noise: Option<f64>,

    /// Pattern of the random numbers
    #[arg(long, value_name = "PATTERN", value_parser = pattern(), help_heading = SAMPLING)]
    pub sampler: Option<PatternKind>,

    /// Structure in which rays are searched, and its parameters
    #[arg(long, value_name = "STRUCTURE[:KEY=VALUE,...]", value_parser = StructureParser, help_heading = SEARCH)]
    pub accel: Option<Structure>,

    /// Work that goes into the tree of the structure bvh
    #[arg(long, value_name = "WORK", value_parser = build(), help_heading = SEARCH)]
    pub build: Option<Build>,

    /// Paths that travel together
    #[arg(long, value_name = "N", value_parser = quantity::batch, help_heading = SEARCH)]
    pub batch: Option<usize>,

    /// With what the searches of each pixel cost
    #[arg(long, help_heading = SEARCH)]
    pub cost: bool,

    /// Worker threads; as many as there are processors when absent
    #[arg(long, value_name = "N", value_parser = quantity::threads, help_heading = MACHINE)]
    pub threads: Option<usize>,

    /// Print one JSON object on standard output instead
    #[arg(long, help_heading = TALK)]
    pub json: bool,

    /// How the files of the scene are read
    #[command(flatten)]
    pub reading: ReadingArgs,
}
