//! Tone curves: from light without limit to what a screen can show.

use straal_math::ops;

/// How what is brighter than the screen is brought to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// What is brighter than white is white.
    #[default]
    Clamp,
    /// Narkowicz's (2015) fit of the ACES filmic curve, channel by channel: a soft toe and shoulder.
    Filmic,
}

impl Tone {
    /// Linear light at the given exposure factor to linear light in [0, 1].
    pub fn apply(self, rgb: [f32; 3], exposure: f32) -> [f32; 3] {
        rgb.map(|v| {
            let v = ops::max(v * exposure, 0.0);
            let shown = match self {
                Self::Clamp => v,
                // At 64 the curve is at white; beyond, the squares would leave the range of single precision.
                Self::Filmic => {
                    let x = ops::min(v, 64.0);
                    x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
                }
            };
            ops::clamp(shown, 0.0, 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_from_black_to_white() {
        for tone in [Tone::Clamp, Tone::Filmic] {
            let mut last = 0.0;
            assert_eq!(tone.apply([0.0; 3], 1.0), [0.0; 3]);
            for i in 0..1000 {
                let v = tone.apply([i as f32 * 0.1; 3], 0.5)[0];
                assert!(v >= last && v <= 1.0, "{tone:?} at {i}");
                last = v;
            }
            assert_eq!(tone.apply([f32::INFINITY; 3], 1.0), [1.0; 3], "{tone:?}");
        }
    }
}
