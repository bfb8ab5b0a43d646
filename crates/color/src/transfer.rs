//! Transfer functions: from linear light to the signal that a screen or a file wants, and back.

use crate::srgb;
use straal_math::ops;

/// How linear light in [0, 1] becomes a signal in [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Transfer {
    /// IEC 61966-2-1: a line near black, then a power of 2.4, as a whole near 2.2.
    #[default]
    Srgb,
    /// The signal is the 1/gamma-th power of light.
    Gamma(f32),
    /// ITU-R BT.709 and BT.2020 (10 bits): the curve of video cameras.
    Rec709,
    /// The signal is light.
    Linear,
}

impl Transfer {
    /// The signal; what is beyond [0, 1] goes to the nearer end, NaN to 0.
    pub fn encode(self, linear: f32) -> f32 {
        let v = ops::clamp(linear, 0.0, 1.0);
        match self {
            Self::Srgb => srgb::encode(v),
            Self::Gamma(gamma) => ops::pow(v, 1.0 / gamma),
            Self::Rec709 if v < 0.018 => 4.5 * v,
            Self::Rec709 => 1.099 * ops::pow(v, 0.45) - 0.099,
            Self::Linear => v,
        }
    }

    /// The light of a signal; what is beyond [0, 1] goes to the nearer end, NaN to 0.
    pub fn decode(self, signal: f32) -> f32 {
        let v = ops::clamp(signal, 0.0, 1.0);
        match self {
            Self::Srgb => srgb::decode(v),
            Self::Gamma(gamma) => ops::pow(v, gamma),
            Self::Rec709 if v < 0.081 => v / 4.5,
            Self::Rec709 => ops::pow((v + 0.099) / 1.099, 1.0 / 0.45),
            Self::Linear => v,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Transfer; 6] = [
        Transfer::Srgb,
        Transfer::Gamma(1.0),
        Transfer::Gamma(2.2),
        Transfer::Gamma(3.0),
        Transfer::Rec709,
        Transfer::Linear,
    ];

    #[test]
    fn there_and_back_and_always_upwards() {
        for curve in ALL {
            let mut last = -1.0;
            for i in 0..=4096_u16 {
                let v = f32::from(i) / 4096.0;
                let signal = curve.encode(v);
                assert!(signal > last, "{curve:?} at {v}");
                last = signal;
                // BT.709 has rounded constants, with a step of 2e-5 in light where line and power meet.
                let tolerance = if curve == Transfer::Rec709 { 3e-5 } else { 1e-6 };
                assert!((curve.decode(signal) - v).abs() < tolerance, "{curve:?} at {v}");
            }
            assert_eq!((curve.encode(0.0), curve.encode(f32::NAN)), (0.0, 0.0), "{curve:?}");
            assert!((curve.encode(1.0) - 1.0).abs() < 1e-6 && curve.encode(9.0) <= 1.0, "{curve:?}");
        }
    }

    #[test]
    fn middle_grey_is_where_the_standards_have_it() {
        assert!((Transfer::Gamma(2.2).encode(0.5) - 0.729_740).abs() < 1e-6);
        assert!((Transfer::Rec709.encode(0.18) - 0.409_0).abs() < 1e-4);
        assert_eq!(Transfer::Linear.encode(0.18), 0.18);
    }
}
