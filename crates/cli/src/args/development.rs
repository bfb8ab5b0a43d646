//! How light becomes a picture for the screen, as several commands take it.

use super::heading::DEVELOPMENT;
use super::parsers::{Listed, named};
use clap::Args;
use straal::{Bits, Development, Dither, Exposure, Gamma, Gamut, Tone};

/// How light becomes a picture for the screen; what isn't said is as the scene, or the picture that is developed again,
/// has it.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = DEVELOPMENT)]
pub struct DevelopmentArgs {
    /// Brighten by stops, such as 1.5 or -1, or by a meter: auto or highlights
    ///
    /// Each stop doubles the light. Of the meters, auto makes the mean grey and highlights shows nearly all within white,
    /// perhaps with stops as in auto+1.5.
    #[arg(long, value_name = "EV", allow_hyphen_values = true, value_parser = str::parse::<Exposure>)]
    pub exposure: Option<Exposure>,

    /// Tone curve: what becomes of what is brighter than white
    ///
    /// reinhard and hable may be followed by what becomes white, as in reinhard:4.
    #[arg(long, value_name = "CURVE", value_parser = Listed::<Tone>::new(Tone::ALL.map(Tone::name)))]
    pub tone: Option<Tone>,

    /// What becomes of colours that the screen can't show after that
    ///
    /// flag may be followed by a colour, as in flag:1,0,1.
    #[arg(long, value_name = "WAY", hide_short_help = true, value_parser = Listed::<Gamut>::new(["clip", "desaturate", "flag"]))]
    pub gamut: Option<Gamut>,

    /// How light becomes a signal: srgb, or the power of a plain gamma curve such as 2.2
    #[arg(long, value_name = "GAMMA", hide_short_help = true, value_parser = str::parse::<Gamma>)]
    pub gamma: Option<Gamma>,

    /// Bits a channel
    #[arg(long, value_name = "BITS", hide_short_help = true, value_parser = named(vec![("8", Bits::Eight), ("16", Bits::Sixteen)]))]
    pub bits: Option<Bits>,

    /// Whether smooth gradients are dithered, so that they show no steps
    #[arg(long, value_name = "ON", hide_short_help = true, value_parser = named(vec![("on", Dither::On), ("off", Dither::Off)]))]
    pub dither: Option<Dither>,
}

impl DevelopmentArgs {
    /// What is said here over what is there.
    pub fn over(&self, development: Development) -> Development {
        Development {
            exposure: self.exposure.unwrap_or(development.exposure),
            tone: self.tone.unwrap_or(development.tone),
            gamut: self.gamut.unwrap_or(development.gamut),
            gamma: self.gamma.unwrap_or(development.gamma),
            bits: self.bits.unwrap_or(development.bits),
            dither: self.dither.unwrap_or(development.dither),
        }
    }
}
