//! Light of single pixels far brighter than all around: the trace of one rare path.
//!
//! To take it away makes a picture darker than the truth, so what was taken is told.

use std::fmt;

/// What was taken away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fireflies {
    /// Pixels that were too bright.
    pub pixels: usize,
    /// The share of the picture's light, of all three colours, that they lost.
    pub share: f64,
}

impl fmt::Display for Fireflies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pixels = if self.pixels == 1 { "1 pixel".to_owned() } else { format!("{} pixels", self.pixels) };
        write!(f, "{pixels}, {:.3} % of the picture's light", 100.0 * self.share)
    }
}

/// Brings pixels that are brighter than `times` the second brightest of the eight around them down to that one, colour and all by
/// the same factor. (The brightest may be a firefly as well, whose light went to both.)
pub(crate) fn remove(width: usize, rgb: &mut [[f32; 3]], times: f32) -> Fireflies {
    let brightness = |p: &[f32; 3]| p.iter().filter(|v| v.is_finite()).fold(0.0, |sum, v| sum + v);
    let before: Vec<f32> = rgb.iter().map(brightness).collect();
    let height = before.len().checked_div(width).unwrap_or(0);
    let mut found = Fireflies::default();
    let (mut taken, mut all) = (0.0, 0.0);
    for y in 0..height {
        for x in 0..width {
            let k = y * width + x;
            all += f64::from(before[k]);
            let [mut brightest, mut second] = [0.0, 0.0];
            for v in y.saturating_sub(1)..(y + 2).min(height) {
                for u in x.saturating_sub(1)..(x + 2).min(width) {
                    let other = before[v * width + u];
                    if (u, v) == (x, y) {
                        continue;
                    }
                    if other > brightest {
                        (brightest, second) = (other, brightest);
                    } else if other > second {
                        second = other;
                    }
                }
            }
            // Beside black nothing tells what is too bright.
            if second > 0.0 && before[k] > times * second {
                let share = second / before[k];
                rgb[k] = rgb[k].map(|v| v * share);
                found.pixels += 1;
                taken += f64::from(before[k]) - f64::from(second);
            }
        }
    }
    found.share = if all > 0.0 { taken / all } else { 0.0 };
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lone_bright_pixel_is_taken_down_and_told() {
        let mut rgb = vec![[1.0; 3]; 9 * 9];
        rgb[4 * 9 + 4] = [20.0, 10.0, 0.0];
        let found = remove(9, &mut rgb, 4.0);
        assert_eq!(rgb[4 * 9 + 4], [2.0, 1.0, 0.0]);
        assert_eq!(found.pixels, 1);
        assert!((found.share - 27.0 / 270.0).abs() < 1e-12);
        assert_eq!(found.to_string(), "1 pixel, 10.000 % of the picture's light");
    }

    #[test]
    fn edges_pairs_and_numbers_that_are_none_stay() {
        // A lamp of several pixels, two fireflies side by side, NaN, and a picture of one pixel.
        let mut rgb = vec![[1.0; 3]; 64];
        (0..8).for_each(|y| rgb[y * 8 + 1] = [50.0; 3]);
        rgb[29] = [f32::NAN; 3];
        let before = rgb.clone();
        assert_eq!(remove(8, &mut rgb, 4.0).pixels, 0);
        assert!(rgb.iter().zip(&before).all(|(a, b)| a == b || b[0].is_nan()));
        let mut one = vec![[7.0; 3]];
        assert_eq!(remove(1, &mut one, 4.0), Fireflies::default());
        assert_eq!(remove(0, &mut [], 4.0), Fireflies::default());
    }
}
