//! Exposure: how much light makes white.

use crate::parse::{ParseError, number};
use std::fmt;
use std::str::FromStr;
use straal_math::ops;

/// What light is multiplied by: by so many stops, or as a light meter says and so many stops more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exposure {
    /// Who says.
    pub meter: Meter,
    /// Stops on top, each of which doubles the light.
    pub stops: f32,
}

/// A light meter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Meter {
    /// None: light is taken as it is.
    #[default]
    Off,
    /// The logarithmic mean of luminance becomes middle grey, 0.18 (Reinhard et al. 2002, equations 1 and 2). Pixels that
    /// are black or not finite don't count.
    Average,
    /// All but the brightest hundredth of the pixels, by their strongest component, are shown within white.
    Highlights,
}

/// Luminance of middle grey.
const MIDDLE_GREY: f64 = 0.18;

impl Exposure {
    /// Without a meter.
    pub const fn stops(stops: f32) -> Self {
        Self { meter: Meter::Off, stops }
    }

    /// What the pixels are multiplied by. `luminance` weighs red, green and blue. Sums go in the order of the pixels, so
    /// that the same picture gives the same factor everywhere; where there is no light to measure only the stops count.
    pub fn factor(self, pixels: &[[f32; 3]], luminance: [f64; 3]) -> f32 {
        let metered = match self.meter {
            Meter::Off => 1.0,
            Meter::Average => average(pixels, luminance).map_or(1.0, |mean| MIDDLE_GREY / mean),
            Meter::Highlights => highlight(pixels).map_or(1.0, |most| 1.0 / most),
        };
        (metered * f64::from(ops::exp2(self.stops))) as f32
    }
}

fn average(pixels: &[[f32; 3]], luminance: [f64; 3]) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_u64);
    for rgb in pixels {
        let y: f64 = rgb.iter().zip(luminance).map(|(v, weight)| f64::from(*v) * weight).sum();
        if y > 0.0 && y.is_finite() {
            sum += ops::ln_d(y);
            count += 1;
        }
    }
    (count > 0).then(|| ops::exp_d(sum / count as f64))
}

fn highlight(pixels: &[[f32; 3]]) -> Option<f64> {
    let most = |rgb: &[f32; 3]| ops::max(rgb[0], ops::max(rgb[1], rgb[2]));
    let mut lit: Vec<f32> = pixels.iter().map(most).filter(|v| v.is_finite() && *v > 0.0).collect();
    let last = lit.len().checked_sub(1)?;
    let (_, value, _) = lit.select_nth_unstable_by(last - last / 100, f32::total_cmp);
    Some(f64::from(*value))
}

impl fmt::Display for Exposure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.meter {
            Meter::Off => return write!(f, "{}", self.stops),
            Meter::Average => f.write_str("auto")?,
            Meter::Highlights => f.write_str("highlights")?,
        }
        if self.stops == 0.0 { Ok(()) } else { write!(f, "{:+}", self.stops) }
    }
}

impl FromStr for Exposure {
    type Err = ParseError;

    /// Stops from -64 to 64; `auto` and `highlights`, which may be followed by stops as in `auto+1.5`.
    fn from_str(text: &str) -> Result<Self, ParseError> {
        let (meter, rest) = match text.strip_prefix("auto") {
            Some(rest) => (Meter::Average, rest),
            None => match text.strip_prefix("highlights") {
                Some(rest) => (Meter::Highlights, rest),
                None => (Meter::Off, text),
            },
        };
        if rest.is_empty() && meter != Meter::Off {
            return Ok(Self { meter, stops: 0.0 });
        }
        let stops = number(rest).filter(|v| v.abs() <= 64.0);
        let signed = meter == Meter::Off || rest.starts_with(['+', '-']);
        match stops {
            Some(stops) if signed => Ok(Self { meter, stops }),
            _ => Err(ParseError::new(
                "expected stops from -64 to 64, or auto or highlights, perhaps with stops as in auto+1.5",
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LUMINANCE: [f64; 3] = [0.25, 0.5, 0.25];

    #[test]
    fn meters_set_grey_and_white() {
        let mut pixels: Vec<[f32; 3]> = (0..200_u8).map(|i| [f32::from(i) * 0.01; 3]).collect();
        pixels.extend([[f32::NAN; 3], [f32::INFINITY; 3], [-1.0; 3]]);
        let shown = |e: Exposure| e.factor(&pixels, LUMINANCE);
        assert_eq!(shown(Exposure::stops(2.0)), 4.0);
        let average = Exposure { meter: Meter::Average, stops: 0.0 };
        let exposed: Vec<[f32; 3]> = pixels.iter().map(|p| p.map(|v| v * shown(average))).collect();
        let again = average.factor(&exposed, LUMINANCE);
        assert!((again - 1.0).abs() < 1e-6, "{again}");
        let highlights = Exposure { meter: Meter::Highlights, stops: 1.0 };
        assert!((shown(highlights) - 2.0 / 1.98).abs() < 1e-3, "{}", shown(highlights));
        for dark in [vec![], vec![[0.0; 3]]] {
            assert_eq!((average.factor(&dark, LUMINANCE), highlights.factor(&dark, LUMINANCE)), (1.0, 2.0));
        }
    }

    #[test]
    fn what_is_told_is_read_again() {
        for text in ["0", "-1.5", "auto", "auto+1", "highlights-0.5", "64"] {
            assert_eq!(text.parse::<Exposure>().unwrap().to_string(), text);
        }
        for wrong in ["", "auto1", "auto+", "bright", "nan", "65", "highlights+1e9"] {
            assert!(wrong.parse::<Exposure>().is_err(), "{wrong}");
        }
    }
}
