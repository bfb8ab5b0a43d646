//! What `straal gamma-chart` takes.

use crate::exit;
use clap::Args;
use std::path::PathBuf;

pub(super) const GAMMA_CHART_ABOUT: &str = "\
Makes the picture by which a screen's gamma is found: fields of black and white checks, each with a grey in its middle that \
is as bright as they are together on a screen of one gamma only, from 1.0 to 3.0. Show it at its own size, step back until \
the checks blur, and look for the field whose middle vanishes: its label is the screen's gamma.";

/// `straal gamma-chart`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct GammaChartArgs {
    /// Where the chart goes, a PNG
    #[arg(short, long, value_name = "PICTURE", default_value = "gamma-chart.png")]
    pub output: PathBuf,

    /// Print one JSON object on standard output at the end
    #[arg(long)]
    pub json: bool,
}
