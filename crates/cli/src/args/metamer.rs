//! What `straal metamer` takes.

use super::parsers::observer;
use crate::exit;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;
use straal_color::spectrum::{Observer, illuminant};

pub(super) const METAMER_ABOUT: &str = "\
Tells how much two surfaces differ in colour under each illuminant of the CIE, as CIEDE2000: below about 1 nobody sees \
a difference, and surfaces that match under one light and not under another are metamers.

A spectrum is a file with a wavelength in nm and a value on each line, the name of a colour as '#c08040', or a grey such \
as 0.4. With --make and one spectrum, a metamer of it is made: of the same colour under --under and as different \
otherwise as reflectances from 0 to 1 allow.";

const METAMER_EXAMPLES: &str = "\
Examples:
  straal metamer paint.spd print.spd
  straal metamer paint.spd --make twin.spd --under D65
  straal metamer '#8090a0' --make twin.spd && straal metamer '#8090a0' twin.spd --json";

/// `straal metamer`
#[derive(Debug, Args)]
#[command(after_help = METAMER_EXAMPLES, after_long_help = format!("{METAMER_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct MetamerArgs {
    /// A spectrum of reflectance: a file, a metal by name, '#rrggbb' or a number
    pub a: String,

    /// The spectrum to compare it with
    #[arg(required_unless_present = "make", conflicts_with = "make")]
    pub b: Option<String>,

    /// Write a metamer of A to this file
    #[arg(long, value_name = "FILE")]
    pub make: Option<PathBuf>,

    /// The light under which the metamer has the colour of A
    #[arg(long, value_name = "LIGHT", default_value = "D65", value_parser = PossibleValuesParser::new(illuminant::NAMES), ignore_case = true)]
    pub under: String,

    /// Whose eyes: the observer of 2 or of 10 degrees
    #[arg(long, value_name = "DEGREES", default_value = "2", value_parser = observer())]
    pub observer: Observer,

    /// Print one JSON object on standard output instead
    #[arg(long)]
    pub json: bool,
}
