//! The picture by which a screen's gamma is found.
//!
//! A checkerboard of single black and white pixels gives half of white's light, whatever the gamma. Beside it stands a
//! grey whose code gives half the light on a screen of one gamma only: from a distance at which the checks blur, the field
//! whose middle vanishes tells the screen's. Shown at other than its own size, the picture tells nothing.

use crate::false_colour::{Chart, font};
use straal_math::ops;

/// The gammas of the fields: from 1.0 to 3.0 in steps of 0.1.
pub fn gammas() -> impl Iterator<Item = f32> {
    (10..=30_u8).map(|tenths| f32::from(tenths) / 10.0)
}

/// The code, of 0 to 255, that gives half of the light on a screen of that gamma.
pub fn half(gamma: f32) -> u8 {
    (255.0 * ops::pow(0.5, 1.0 / gamma) + 0.5) as u8
}

/// The code that gives half of the light on a screen that follows sRGB.
pub const SRGB_HALF: u8 = 188;

const COLUMNS: usize = 6;
/// Side of a field, of the grey in it, and what is between fields, in pixels; all even, so that checks are whole.
const FIELD: usize = 96;
const GREY: usize = 48;
const GAP: usize = 16;
const LINE: usize = 2 * font::HEIGHT + 6;

/// The chart, with a field for each gamma and one for sRGB's own curve, each labelled with its gamma and code.
pub fn chart() -> Chart {
    let fields: Vec<(String, u8)> =
        gammas().map(|g| (format!("{g:.1}"), half(g))).chain([("srgb".to_owned(), SRGB_HALF)]).collect();
    let rows = fields.len().div_ceil(COLUMNS);
    let (width, height) = (GAP + COLUMNS * (FIELD + GAP), GAP + rows * (FIELD + GAP + LINE));
    let mut chart = Chart::blank(width, height);
    for (i, (name, code)) in fields.iter().enumerate() {
        let left = GAP + i % COLUMNS * (FIELD + GAP);
        let top = GAP + i / COLUMNS * (FIELD + GAP + LINE);
        let inset = (FIELD - GREY) / 2;
        for y in 0..FIELD {
            for x in 0..FIELD {
                let is_grey = (inset..inset + GREY).contains(&x) && (inset..inset + GREY).contains(&y);
                let check = if (x + y) % 2 == 0 { 255 } else { 0 };
                let v = if is_grey { *code } else { check };
                chart.pixels[(top + y) * width + left + x] = [v; 3];
            }
        }
        chart.write(&format!("{name} {code}"), [left, top + FIELD + 4], 2);
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_color::srgb;

    #[test]
    fn greys_have_half_of_the_light() {
        for gamma in gammas() {
            let light = ops::pow(f32::from(half(gamma)) / 255.0, gamma);
            assert!((light - 0.5).abs() < 0.006, "{gamma}: {light}");
        }
        assert_eq!((half(1.0), half(2.2), srgb::encode_u8(0.5)), (128, 186, SRGB_HALF));
    }

    /// Averaged over a field's rim the checks have half of white's light, and the grey is in the middle.
    #[test]
    fn checks_are_even() {
        let chart = chart();
        let at = |x: usize, y: usize| chart.pixels[(GAP + y) * chart.width + GAP + x][0];
        let rim = (0..FIELD).map(|x| u32::from(at(x, 3))).sum::<u32>();
        assert_eq!(rim, 255 * FIELD as u32 / 2);
        assert_eq!(at(FIELD / 2, FIELD / 2), half(1.0));
        assert_eq!(chart.pixels.len(), chart.width * chart.height);
    }
}
