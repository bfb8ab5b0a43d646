//! A colour map for numbers: from dark violet through red and orange to light yellow.
//!
//! It is a helix in OKLab: lightness rises and hue turns evenly at constant chroma, so that equal steps of the number
//! are equal steps of colour to the eye, and a grey print still shows their order.

use crate::oklab::Oklab;
use crate::srgb;
use straal_math::ops;

/// Lightness of 0 and of 1.
const LIGHTNESS: [f32; 2] = [0.22, 0.95];
/// Hue of 0 and of 1 in degrees, from red towards yellow: violet, then once past red.
const HUE: [f32; 2] = [285.0, 465.0];
/// The most that a screen can show along the whole way is a little more.
const CHROMA: f32 = 0.115;

/// The colour of a number in [0, 1]; what is beyond goes to the nearer end, NaN to 0.
pub fn oklab(x: f32) -> Oklab {
    let x = ops::clamp(x, 0.0, 1.0);
    let between = |[a, b]: [f32; 2]| a + (b - a) * x;
    let (sin, cos) = ops::sin_cos_degrees(f64::from(between(HUE)));
    Oklab { l: between(LIGHTNESS), a: CHROMA * cos as f32, b: CHROMA * sin as f32 }
}

/// The same for the screen: sRGB in eight bits.
pub fn srgb_u8(x: f32) -> [u8; 3] {
    oklab(x).to_linear().map(srgb::encode_u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: usize = 64;

    fn steps() -> impl Iterator<Item = f32> {
        (0..=STEPS).map(|i| i as f32 / STEPS as f32)
    }

    #[test]
    fn a_screen_can_show_all_of_it() {
        for x in steps() {
            let rgb = oklab(x).to_linear();
            assert!(rgb.iter().all(|v| (0.0..=1.0).contains(v)), "{x}: {rgb:?}");
        }
    }

    /// Judged by what a screen gets, eight bits and all: hence the tolerance.
    #[test]
    fn lightness_rises_and_steps_are_even() {
        let shown: Vec<Oklab> = steps()
            .map(|x| Oklab::from_linear(srgb_u8(x).map(|c| srgb::decode(f32::from(c) / 255.0))))
            .collect();
        let sizes: Vec<f32> = shown.windows(2).map(|w| w[0].distance(w[1])).collect();
        let mean = sizes.iter().sum::<f32>() / STEPS as f32;
        for (w, size) in shown.windows(2).zip(&sizes) {
            assert!(w[1].l > w[0].l, "lightness falls from {w:?}");
            assert!((size / mean - 1.0).abs() < 0.3, "a step of {size}, where the mean is {mean}");
        }
        let exact: Vec<f32> =
            steps().zip(steps().skip(1)).map(|(a, b)| oklab(a).distance(oklab(b))).collect();
        assert!(exact.iter().all(|s| (s / exact[0] - 1.0).abs() < 1e-3), "{exact:?}");
    }

    #[test]
    fn what_is_no_number_is_the_least() {
        assert_eq!(srgb_u8(f32::NAN), srgb_u8(0.0));
        assert_eq!((srgb_u8(-3.0), srgb_u8(f32::INFINITY)), (srgb_u8(0.0), srgb_u8(1.0)));
    }
}
