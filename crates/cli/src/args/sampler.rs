//! What `straal sampler` takes.

use super::parsers::pattern;
use crate::exit;
use crate::quantity::{self, Dimensions, Shape};
use clap::Args;
use std::path::PathBuf;
use straal_math::lowdisc::PatternKind;

pub(super) const SAMPLER_ABOUT: &str = "\
Tells how evenly the points of a sampling pattern, or of all of them, lie in the unit square: their L2-star discrepancy, \
and by how much the pixels of a picture of (1 + sin(x²y²))/2 are off when each is sampled by them. --plot draws the points, \
mapped to a disc, a hemisphere or what else --map says, beside their power spectrum.";

const SAMPLER_EXAMPLES: &str = "\
Examples:
  straal sampler                                all patterns, 64 points each
  straal sampler sobol --count 256 --plot       to sobol.svg
  straal sampler jittered --plot disc.svg --map disc
  straal sampler n_rooks --map hemisphere:e=10 --plot";

/// `straal sampler`
#[derive(Debug, Args)]
#[command(after_help = SAMPLER_EXAMPLES, after_long_help = format!("{SAMPLER_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct SamplerArgs {
    /// The pattern; all of them when absent
    #[arg(value_parser = pattern())]
    pub pattern: Option<PatternKind>,

    /// How many points
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = quantity::points)]
    pub count: u32,

    /// Seed of the pattern
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = quantity::seed)]
    pub seed: u64,

    /// Which two of the four numbers that a sample may draw at once, from 0
    #[arg(long, value_name = "X,Y", default_value = "0,1", value_parser = quantity::dimensions)]
    pub dimensions: Dimensions,

    /// Draw the points as an SVG (.svg); when no name follows, to one of the pattern's name in the current folder
    #[arg(long, value_name = "DRAWING")]
    pub plot: Option<Option<PathBuf>>,

    /// What the square is mapped to in the drawing: square, disc, hemisphere:e=1, sphere, triangle or cone:degrees=30
    #[arg(long, value_name = "SHAPE", default_value = "square", value_parser = quantity::shape)]
    pub map: Shape,

    /// Print one JSON object on standard output instead
    #[arg(long)]
    pub json: bool,
}
