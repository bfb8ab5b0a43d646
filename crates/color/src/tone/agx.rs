//! AgX: the picture formation that Troy Sobotka published in 2022, worked out from its parts rather than by a fit.

use super::{rows_of_one, times};
use crate::matrix::Matrix3;
use std::sync::LazyLock;
use straal_math::ops;

/// The log2 range around middle grey, in stops.
const BELOW: f32 = 10.0;
const ABOVE: f32 = 6.5;
const MIDDLE: f32 = 0.18;

/// Where middle grey lies on the way from the darkest to the brightest, what it is shown as, and how steep the sigmoid is
/// there; the powers with which it bends towards black and white.
const PIVOT: [f32; 2] = [BELOW / (BELOW + ABOVE), 0.5];
const SLOPE: f32 = 2.0;
const POWERS: [f32; 2] = [3.0, 3.25];

/// Draws the primaries of sRGB towards white, so that a saturated colour lights all three channels a little (the inset
/// matrix of AgX in the form that Wrensch, 2023, published); greys are kept to the last digit.
const INSET: [[f64; 3]; 3] = [
    [0.842_479_062_253_094, 0.078_433_599_999_999_2, 0.079_223_745_147_764_3],
    [0.042_328_242_261_012_3, 0.878_468_636_469_772, 0.079_166_127_460_543_4],
    [0.042_375_654_905_705_1, 0.078_433_6, 0.879_142_973_793_104],
];

/// The inset and its inverse.
static SETS: LazyLock<[[[f32; 3]; 3]; 2]> = LazyLock::new(|| {
    let inset = rows_of_one(INSET);
    let inverse = Matrix3(inset.map(|row| row.map(f64::from))).inverse().unwrap_or(Matrix3::IDENTITY);
    [inset, rows_of_one(inverse.0)]
});

/// Light for the screen. The sigmoid's output is a signal for a screen of gamma 2.2.
pub(super) fn agx(rgb: [f32; 3]) -> [f32; 3] {
    let [inset, outset] = &*SETS;
    let signal = times(inset, rgb).map(|v| {
        let stops = ops::log2(ops::max(v, 1e-20) / MIDDLE);
        sigmoid(ops::clamp((stops + BELOW) / (BELOW + ABOVE), 0.0, 1.0))
    });
    times(outset, signal).map(|v| ops::pow(ops::max(v, 0.0), 2.2))
}

/// Rises from (0, 0) through the pivot to (1, 1). On either side the straight line of the slope is bent: a distance d
/// from the pivot becomes s d / (1 + (s d / S)^p)^(1/p), with S such that the end is met.
fn sigmoid(x: f32) -> f32 {
    let [at, height] = PIVOT;
    let bent = |d: f32, reach: f32, rise: f32, power: f32| {
        let full = ops::pow(SLOPE * reach / rise, power) - 1.0;
        let line = SLOPE * d;
        line / ops::pow(1.0 + full * ops::pow(d / reach, power), 1.0 / power)
    };
    if x < at {
        height - bent(at - x, at, height, POWERS[0])
    } else {
        height + bent(x - at, 1.0 - at, 1.0 - height, POWERS[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wrensch's polynomial of sixth order was fitted to the same sigmoid, with errors up to 0.004 or so.
    #[test]
    fn the_sigmoid_is_the_published_one() {
        for i in 0..=100_u8 {
            let x = f32::from(i) / 100.0;
            let (x2, x4) = (x * x, x * x * x * x);
            let fit =
                15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x
                    - 0.002_32;
            assert!((sigmoid(x) - fit).abs() < 0.01, "{x}: {} {fit}", sigmoid(x));
        }
        assert!(sigmoid(0.0).abs() < 1e-6 && (sigmoid(1.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn bright_saturated_light_turns_white() {
        let dim = agx([0.1, 0.0, 0.0]);
        assert!(dim[0] > 3.0 * dim[1], "{dim:?}");
        let bright = agx([1000.0, 0.0, 0.0]);
        assert!(bright[1] > 0.5 * bright[0], "{bright:?}");
    }
}
