//! What happens to colours that a screen can't show.

use crate::luminance;
use crate::parse::{ParseError, number};
use crate::tone::Tone;
use std::fmt;
use std::str::FromStr;
use straal_math::ops;

/// What becomes of a colour with a component below 0 or above 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Gamut {
    /// Each component goes to the nearer end by itself; hues shift.
    #[default]
    Clip,
    /// The colour moves straight towards the grey of its own luminance until the screen can show it, so that luminance and
    /// roughly hue are kept; what is as bright as white is white.
    Desaturate,
    /// It is shown as one colour, as Suffern's (2007) clamp-to-colour: linear RGB in [0, 1].
    Flag([f32; 3]),
}

/// Conversions between spaces round: this much beyond the ends is not out of gamut.
const SLACK: f32 = 1e-5;

impl Gamut {
    /// The textbook's: out of gamut is red.
    pub const FLAG_RED: Self = Self::Flag([1.0, 0.0, 0.0]);

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clip => "clip",
            Self::Desaturate => "desaturate",
            Self::Flag(_) => "flag",
        }
    }

    /// Exposed linear light of the screen's space to what it shows, within [0, 1]: components below 0, which stand for
    /// colours that are purer than its primaries, are dealt with first, then the tone curve is applied, then what is
    /// still above 1 is dealt with.
    pub fn show(self, rgb: [f32; 3], tone: Tone) -> [f32; 3] {
        let most = rgb.into_iter().fold(1.0, ops::max);
        let is_purer = rgb.iter().any(|v| *v < -SLACK * most);
        let pure = match self {
            Self::Flag(colour) if is_purer => return colour.map(|v| ops::clamp(v, 0.0, 1.0)),
            Self::Desaturate if is_purer => lifted(rgb),
            _ => rgb,
        };
        self.apply(tone.apply(pure.map(|v| ops::max(v, 0.0))))
    }

    /// Linear light for the screen, within [0, 1].
    pub fn apply(self, rgb: [f32; 3]) -> [f32; 3] {
        let inside = |v: &f32| *v >= -SLACK && *v <= 1.0 + SLACK;
        let shown = match self {
            _ if rgb.iter().all(inside) => rgb,
            Self::Clip => rgb,
            Self::Desaturate => desaturate(rgb),
            Self::Flag(colour) => colour,
        };
        shown.map(|v| ops::clamp(v, 0.0, 1.0))
    }
}

impl fmt::Display for Gamut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Flag([r, g, b]) if *self != Self::FLAG_RED => write!(f, "flag:{r},{g},{b}"),
            _ => f.write_str(self.name()),
        }
    }
}

impl FromStr for Gamut {
    type Err = ParseError;

    /// `clip`, `desaturate` or `flag`, which may be followed by the colour as in `flag:1,0,1`.
    fn from_str(text: &str) -> Result<Self, ParseError> {
        match text {
            "clip" => return Ok(Self::Clip),
            "desaturate" => return Ok(Self::Desaturate),
            "flag" => return Ok(Self::FLAG_RED),
            _ => {}
        }
        let Some(colour) = text.strip_prefix("flag:") else {
            return Err(ParseError::new("no such way; there are clip, desaturate, flag"));
        };
        let colour: Option<Vec<f32>> = colour.split(',').map(|v| number(v.trim())).collect();
        match colour.as_deref() {
            Some(&[r, g, b]) if [r, g, b].iter().all(|v| (0.0..=1.0).contains(v)) => {
                Ok(Self::Flag([r, g, b]))
            }
            _ => Err(ParseError::new("the colour must be three numbers from 0 to 1, as in flag:1,0,1")),
        }
    }
}

fn desaturate(rgb: [f32; 3]) -> [f32; 3] {
    let grey = luminance(rgb);
    // NaN and infinities have no grey to go to.
    if !grey.is_finite() || grey >= 1.0 {
        return rgb.map(|v| if v.is_nan() { 0.0 } else { 1.0 });
    }
    if grey <= 0.0 {
        return [0.0; 3];
    }
    // The share of colour that the most offending component can bear.
    let share = rgb.into_iter().fold(1.0, |share, v| {
        let most = if v > 1.0 {
            (1.0 - grey) / (v - grey)
        } else if v < 0.0 {
            grey / (grey - v)
        } else {
            1.0
        };
        ops::min(share, most)
    });
    rgb.map(|v| grey + share * (v - grey))
}

/// Towards the grey of its own luminance until nothing is below 0.
fn lifted(rgb: [f32; 3]) -> [f32; 3] {
    let grey = luminance(rgb);
    if !grey.is_finite() {
        return rgb;
    }
    if grey <= 0.0 {
        return [0.0; 3];
    }
    let least = rgb.into_iter().fold(0.0, ops::min);
    let share = grey / (grey - least);
    rgb.map(|v| grey + share * (v - grey))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_purer_than_the_screen_is_brought_to_it_before_the_curve() {
        let red = [1.98, -0.13, -0.01];
        for tone in Tone::ALL {
            for (gamut, what) in [(Gamut::Clip, "clipped"), (Gamut::Desaturate, "desaturated")] {
                let [r, g, b] = gamut.show(red, tone);
                assert!(r > 0.5 && b <= g + 0.5 * r, "{tone:?} {what}: {r} {g} {b}");
            }
            assert_eq!(Gamut::FLAG_RED.show([-0.2, 0.5, 0.5], tone), [1.0, 0.0, 0.0]);
        }
        assert_eq!(Gamut::Clip.show([0.5, -0.2, 0.25], Tone::Clamp), [0.5, 0.0, 0.25]);
        let lifted = Gamut::Desaturate.show([0.5, -0.1, 0.25], Tone::Clamp);
        assert!((luminance(lifted) - luminance([0.5, -0.1, 0.25])).abs() < 1e-6 && lifted[1].abs() < 1e-6);
    }

    #[test]
    fn what_is_told_is_read_again() {
        for gamut in [Gamut::Clip, Gamut::Desaturate, Gamut::FLAG_RED, Gamut::Flag([0.25, 0.0, 1.0])] {
            assert_eq!(gamut.to_string().parse(), Ok(gamut));
        }
        for wrong in ["", "flag:", "flag:1,0", "flag:1,0,2", "flag:1,0,nan", "cut"] {
            assert!(wrong.parse::<Gamut>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_can_be_shown_is_left_alone() {
        for gamut in [Gamut::Clip, Gamut::Desaturate, Gamut::FLAG_RED] {
            for rgb in [[0.0, 0.5, 1.0], [0.2, 0.3, 0.1]] {
                assert_eq!(gamut.apply(rgb), rgb, "{gamut:?}");
            }
            assert_eq!(gamut.apply([1.000_001, -1e-7, 0.5]), [1.0, 0.0, 0.5], "{gamut:?}");
        }
    }

    #[test]
    fn what_can_not_is_brought_inside() {
        for i in 0..4096_u32 {
            let rgb = [i % 16, i / 16 % 16, i / 256].map(|v| v as f32 * 0.2 - 1.0);
            for gamut in [Gamut::Clip, Gamut::Desaturate, Gamut::FLAG_RED] {
                assert!(gamut.apply(rgb).iter().all(|v| (0.0..=1.0).contains(v)), "{gamut:?} {rgb:?}");
            }
            let grey = luminance(rgb);
            if (0.0..1.0).contains(&grey) {
                let kept = luminance(Gamut::Desaturate.apply(rgb));
                assert!((kept - grey).abs() < 1e-5, "{rgb:?}: {kept}, not {grey}");
            }
        }
        assert_eq!(Gamut::FLAG_RED.apply([1.2, 0.5, 0.5]), [1.0, 0.0, 0.0]);
        assert_eq!(Gamut::Desaturate.apply([9.0, 1.0, 1.0]), [1.0; 3]);
        assert_eq!(Gamut::Desaturate.apply([f32::NAN, f32::INFINITY, 1.0]), [0.0, 1.0, 1.0]);
    }
}
