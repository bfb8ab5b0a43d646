//! Tone curves: from light without limit to what a screen can show.
//!
//! Light comes in the linear RGB of the screen (Rec. 709 primaries, D65), exposed so that white is about 1. What comes
//! out is linear light for the screen; where a curve leaves it beyond [0, 1], [`crate::Gamut`] says what happens. All
//! curves keep black black, greys grey, and never fall.

mod agx;

use crate::luminance;
use crate::parse::{ParseError, number};
use std::fmt;
use std::str::FromStr;
use straal_math::ops;

/// How what is brighter than the screen is brought to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Tone {
    /// Light as it is: what is brighter than white is out of gamut.
    Clamp,
    /// Suffern's (2007) max-to-one: a colour with a component above 1 is divided by the largest, so that its
    /// hue stays.
    ScaleToMaximum,
    /// Reinhard, Stark, Shirley and Ferwerda (2002), on luminance: L / (1 + L) (their equation 3), or with a white that
    /// becomes 1, L (1 + L / white²) / (1 + L) (equation 4).
    Reinhard {
        /// The luminance that becomes white; infinite for the plain curve.
        white: f32,
    },
    /// Hable's curve of *Uncharted 2* (GDC 2010), channel by channel, with his constants and exposure bias of 2.
    Hable {
        /// What becomes white. His own number is 11.2 after the bias, so that 5.6 is before it.
        white: f32,
    },
    /// Narkowicz's (2015) fit of the ACES filmic curve, channel by channel: a soft toe and shoulder.
    Filmic,
    /// Hill's (2016) fit of the ACES reference rendering and output transforms for an sRGB screen: brighter colours turn
    /// towards white.
    Aces,
    /// After Sobotka's AgX (2022): primaries are drawn towards white, light is taken by its logarithm through a
    /// sigmoid, and saturated colours turn white gracefully.
    Agx,
    /// Khronos' PBR Neutral (2024): colours up to 0.8 are shown as they are but for the sheen of dielectrics, and only
    /// what is brighter is compressed.
    #[default]
    KhronosNeutral,
}

impl Tone {
    /// Reinhard's plain curve.
    pub const REINHARD: Self = Self::Reinhard { white: f32::INFINITY };
    /// Hable's with his white.
    pub const HABLE: Self = Self::Hable { white: 5.6 };

    /// One of each, with the usual numbers.
    pub const ALL: [Self; 8] = [
        Self::Clamp,
        Self::ScaleToMaximum,
        Self::REINHARD,
        Self::HABLE,
        Self::Filmic,
        Self::Aces,
        Self::Agx,
        Self::KhronosNeutral,
    ];

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clamp => "clamp",
            Self::ScaleToMaximum => "max_to_one",
            Self::Reinhard { .. } => "reinhard",
            Self::Hable { .. } => "hable",
            Self::Filmic => "filmic",
            Self::Aces => "aces",
            Self::Agx => "agx",
            Self::KhronosNeutral => "khronos_neutral",
        }
    }

    /// Exposed light to light for the screen. Components that are no numbers are 0 and infinite ones very bright.
    pub fn apply(self, rgb: [f32; 3]) -> [f32; 3] {
        let rgb = rgb.map(|v| if v.is_nan() { 0.0 } else { v });
        match self {
            Self::Clamp => rgb,
            Self::ScaleToMaximum => {
                let most = largest(rgb);
                if most > 1.0 { rgb.map(|v| bounded(v) / bounded(most)) } else { rgb }
            }
            Self::Reinhard { white } => reinhard(rgb.map(bounded), white),
            Self::Hable { white } => {
                let most = hable(2.0 * white);
                rgb.map(|v| hable(2.0 * bounded(ops::max(v, 0.0))) / most)
            }
            // At 64 the curve is at white; beyond, the squares would leave the range of single precision.
            Self::Filmic => rgb.map(|v| {
                let x = ops::min(ops::max(v, 0.0), 64.0);
                ops::min(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 1.0)
            }),
            Self::Aces => aces(rgb.map(bounded)),
            Self::Agx => agx::agx(rgb.map(bounded)),
            Self::KhronosNeutral => khronos(rgb.map(|v| bounded(ops::max(v, 0.0)))),
        }
    }
}

impl fmt::Display for Tone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Reinhard { white } if white.is_finite() => write!(f, "reinhard:{white}"),
            Self::Hable { white } if *self != Self::HABLE => write!(f, "hable:{white}"),
            _ => f.write_str(self.name()),
        }
    }
}

impl FromStr for Tone {
    type Err = ParseError;

    /// A curve's name; that of Reinhard's or Hable's may be followed by what becomes white, as in `reinhard:4`.
    fn from_str(text: &str) -> Result<Self, ParseError> {
        let (name, white) = text.split_once(':').map_or((text, None), |(name, white)| (name, Some(white)));
        let known = Self::ALL.into_iter().find(|t| t.name() == name);
        let Some(tone) = known else {
            let names: Vec<_> = Self::ALL.iter().map(|t| t.name()).collect();
            return Err(ParseError::new(format!("no such curve; there are {}", names.join(", "))));
        };
        let Some(white) = white else { return Ok(tone) };
        let white = number(white).filter(|w| *w >= LEAST_WHITE && *w <= MOST_WHITE);
        let white = white.ok_or_else(|| {
            ParseError::new(format!("what becomes white must be a number from {LEAST_WHITE} to {MOST_WHITE}"))
        })?;
        match tone {
            Self::Reinhard { .. } => Ok(Self::Reinhard { white }),
            Self::Hable { .. } => Ok(Self::Hable { white }),
            _ => Err(ParseError::new("only reinhard and hable take what becomes white")),
        }
    }
}

/// Least number that can become white.
pub const LEAST_WHITE: f32 = 0.01;
/// Greatest number that can become white.
pub const MOST_WHITE: f32 = 1e6;

/// What no curve tells from infinite, but whose square single precision holds.
const BRIGHTEST: f32 = 1e16;

fn bounded(v: f32) -> f32 {
    ops::clamp(v, -BRIGHTEST, BRIGHTEST)
}

fn largest([r, g, b]: [f32; 3]) -> f32 {
    ops::max(r, ops::max(g, b))
}

fn reinhard(rgb: [f32; 3], white: f32) -> [f32; 3] {
    let l = luminance(rgb);
    if l <= 0.0 {
        return rgb;
    }
    // Without a white the square is infinite and its share 0.
    let scale = (1.0 + l / (white * white)) / (1.0 + l);
    rgb.map(|v| v * scale)
}

/// Shoulder strength, linear strength and angle, toe strength, numerator and denominator.
fn hable(x: f32) -> f32 {
    let [a, b, c, d, e, f] = [0.15, 0.5, 0.1, 0.2, 0.02, 0.3];
    (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f
}

/// Each row adds up to 1, as greys stay grey.
fn rows_of_one(m: [[f64; 3]; 3]) -> [[f32; 3]; 3] {
    m.map(|row| row.map(|v| (v / (row[0] + row[1] + row[2])) as f32))
}

fn times(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn aces(rgb: [f32; 3]) -> [f32; 3] {
    // sRGB to the AP1 of ACES, with the desaturation of its reference rendering transform; and back.
    const IN: [[f64; 3]; 3] =
        [[0.597_19, 0.354_58, 0.048_23], [0.076, 0.908_34, 0.015_66], [0.028_4, 0.133_83, 0.837_77]];
    const OUT: [[f64; 3]; 3] = [
        [1.604_75, -0.531_08, -0.073_67],
        [-0.102_08, 1.108_13, -0.006_05],
        [-0.003_27, -0.072_76, 1.076_02],
    ];
    let curve = |v: f32| {
        let v = ops::max(v, 0.0);
        ops::max(v * (v + 0.024_578_6) - 0.000_090_537, 0.0) / (v * (0.983_729 * v + 0.432_951) + 0.238_081)
    };
    times(&rows_of_one(OUT), times(&rows_of_one(IN), rgb).map(curve))
}

fn khronos(rgb: [f32; 3]) -> [f32; 3] {
    /// Where compression starts, and how fast what is brighter loses its colour.
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    // What a dielectric of F0 = 0.04 adds to every channel is taken off.
    let least = ops::min(rgb[0], ops::min(rgb[1], rgb[2]));
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let rgb = rgb.map(|v| v - offset);
    let peak = largest(rgb);
    if peak < START {
        return rgb;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let scale = new_peak / peak;
    let grey = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    rgb.map(|v| v * scale + (new_peak - v * scale) * grey)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the curve of a grey ends: Reinhard's plain one only comes near to 1, ACES and AgX end a little off it.
    #[test]
    fn curves_of_greys_rise_from_black_to_white_and_stay_grey() {
        for tone in Tone::ALL.into_iter().chain([Tone::Reinhard { white: 4.0 }]) {
            let mut last = 0.0;
            let black = tone.apply([0.0; 3]);
            assert!(black.iter().all(|v| (0.0..1e-6).contains(v)), "{tone:?}: {black:?}");
            for i in 0..4000 {
                let v = ops::exp2(i as f32 * 0.01 - 20.0);
                let [r, g, b] = tone.apply([v; 3]);
                assert!(
                    (r - g).abs() < 2e-6 * (1.0 + g) && (b - g).abs() < 2e-6 * (1.0 + g),
                    "{tone:?} at {v}"
                );
                assert!(g >= last - 2e-7 * (1.0 + last), "{tone:?} at {v}: {g} after {last}");
                last = g;
            }
            assert!(last > 0.98, "{tone:?} ends at {last}");
        }
    }

    #[test]
    fn what_is_no_number_is_shown_as_one() {
        for tone in Tone::ALL {
            for odd in
                [[f32::NAN, 0.5, 0.5], [f32::INFINITY; 3], [f32::NEG_INFINITY, 1.0, 2.0], [-1.0, 3.0, 0.1]]
            {
                assert!(tone.apply(odd).iter().all(|v| !v.is_nan()), "{tone:?} {odd:?}");
            }
        }
    }

    #[test]
    fn known_points_are_met() {
        let grey = |tone: Tone, v: f32| tone.apply([v; 3])[1];
        assert!((grey(Tone::REINHARD, 1.0) - 0.5).abs() < 1e-6);
        assert!((grey(Tone::Reinhard { white: 4.0 }, 4.0) - 1.0).abs() < 1e-6);
        assert!((grey(Tone::HABLE, 5.6) - 1.0).abs() < 1e-6);
        // Khronos' specification: a dielectric's base colour of 0.2 with 4 % of sheen is shown as 0.2.
        assert!((grey(Tone::KhronosNeutral, 0.24) - 0.2).abs() < 1e-6);
        // Hill's and Narkowicz's formulas by hand at 1.
        assert!((grey(Tone::Aces, 1.0) - 1.024_488_1 / 1.654_761).abs() < 1e-5);
        assert!((grey(Tone::Filmic, 1.0) - 2.54 / 3.16).abs() < 1e-6);
        // AgX shows middle grey at half the signal of a screen of gamma 2.2.
        assert!((grey(Tone::Agx, 0.18) - ops::pow(0.5, 2.2)).abs() < 1e-5);
    }

    #[test]
    fn what_is_told_is_read_again() {
        for tone in Tone::ALL.into_iter().chain([Tone::Reinhard { white: 4.5 }, Tone::Hable { white: 11.2 }])
        {
            assert_eq!(tone.to_string().parse(), Ok(tone));
        }
        for wrong in ["", "agx:3", "reinhard:", "reinhard:0", "hable:-1", "hable:nan", "reinhard:1e9", "film"]
        {
            assert!(wrong.parse::<Tone>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn max_to_one_keeps_the_hue() {
        assert_eq!(Tone::ScaleToMaximum.apply([4.0, 2.0, 1.0]), [1.0, 0.5, 0.25]);
        assert_eq!(Tone::ScaleToMaximum.apply([0.4, 0.2, 0.1]), [0.4, 0.2, 0.1]);
    }
}
