//! From a signal to whole numbers: rounding, and dithering that hides its steps.

use straal_math::ops;

/// How a signal is rounded to a code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dither {
    /// To the nearest.
    #[default]
    Off,
    /// Up or down by the pixel's place, in proportion to what is lost: Jimenez' (2014) interleaved gradient noise, which
    /// like blue noise differs most between neighbours. A smooth gradient stays smooth, and the mean over a few pixels
    /// is right; a code that is met exactly stays.
    On,
}

impl Dither {
    /// The code of a signal in [0, 1] at a pixel (of the whole picture) and channel. `most` is the largest code.
    pub fn code(self, signal: f32, most: u32, pixel: [u32; 2], channel: usize) -> u32 {
        let scaled = ops::clamp(signal, 0.0, 1.0) * most as f32;
        let code = match self {
            Self::Off => scaled + 0.5,
            Self::On => scaled + threshold(pixel, channel),
        };
        (code as u32).min(most)
    }
}

/// In [0, 1); channels are far apart in the pattern.
fn threshold([x, y]: [u32; 2], channel: usize) -> f32 {
    let shift = 47.0 * channel as f64;
    let place = 0.067_110_56 * (f64::from(x) + shift) + 0.005_837_15 * (f64::from(y) + 0.36 * shift);
    let v = 52.982_918_9 * (place - place.floor());
    let threshold = (v - v.floor()) as f32;
    // Rounding to single precision may reach 1.
    if threshold < 1.0 { threshold } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_even_and_their_means_are_right() {
        let mut counts = [0_u32; 16];
        for i in 0..128 * 128 {
            let t = threshold([i % 128, i / 128], 0);
            counts[(t * 16.0) as usize] += 1;
        }
        assert!(counts.iter().all(|c| (900..1150).contains(c)), "{counts:?}");
        for signal in [0.1, 0.300_1, 0.777] {
            for channel in 0..3 {
                let codes = (0..64 * 64).map(|i| Dither::On.code(signal, 255, [i % 64, i / 64], channel));
                let mean = codes.map(f64::from).sum::<f64>() / 4096.0;
                assert!((mean - f64::from(signal) * 255.0).abs() < 0.02, "{signal}: {mean}");
            }
        }
    }

    #[test]
    fn codes_that_are_met_stay() {
        for code in 0..=255_u32 {
            for i in 0..64 {
                let at = [i * 7, i * 13];
                assert_eq!(Dither::On.code(code as f32 / 255.0, 255, at, 1).abs_diff(code), 0, "{code}");
            }
            assert_eq!(Dither::Off.code(code as f32 / 255.0, 255, [0, 0], 0), code);
        }
        assert_eq!(Dither::Off.code(f32::NAN, 255, [0, 0], 0), 0);
        assert_eq!(
            (Dither::On.code(7.0, 65_535, [3, 4], 2), Dither::On.code(-1.0, 255, [3, 4], 2)),
            (65_535, 0)
        );
    }

    /// Neighbours differ more than those of white noise would: their mean difference is above a third.
    #[test]
    fn neighbours_differ() {
        let mut sum = 0.0;
        for i in 0..64 * 64 {
            let at = [i % 64, i / 64];
            sum += (threshold(at, 0) - threshold([at[0], at[1] + 1], 0)).abs();
            sum += (threshold(at, 0) - threshold([at[0] + 1, at[1]], 0)).abs();
        }
        assert!(sum / 8192.0 > 0.38, "{}", sum / 8192.0);
    }
}
