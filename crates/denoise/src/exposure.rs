//! How bright a picture is: what it is multiplied by before the network sees it.

use rayon::prelude::*;
use straal_math::ops;

/// Side of the squares that are averaged before the logarithm is taken, so that noise hardly counts.
const SQUARE: usize = 16;
/// What a picture's mean becomes.
const KEY: f64 = 0.18;
/// Squares that are darker are left out.
const BLACK: f64 = 1e-8;

/// [`KEY`] over the geometric mean of the luminance of squares; 1 for a black picture.
pub(crate) fn exposure(width: usize, height: usize, color: &[[f32; 3]]) -> f32 {
    let squares = [width.div_ceil(SQUARE), height.div_ceil(SQUARE)];
    let row = |j: usize| -> (f64, u64) {
        let rows = j * height / squares[1]..(j + 1) * height / squares[1];
        let (mut sum, mut count) = (0.0, 0);
        for i in 0..squares[0] {
            let columns = i * width / squares[0]..(i + 1) * width / squares[0];
            let mean = mean_luminance(width, color, rows.clone(), columns);
            if mean > BLACK {
                sum += ops::ln_d(mean);
                count += 1;
            }
        }
        (sum, count)
    };
    let rows: Vec<(f64, u64)> = (0..squares[1]).into_par_iter().map(row).collect();
    // One after the other, so that it is the same sum for any number of threads.
    let (sum, count) = rows.iter().fold((0.0, 0), |(sum, count), (s, n)| (sum + s, count + n));
    if count == 0 { 1.0 } else { (KEY / ops::exp_d(sum / count as f64)) as f32 }
}

fn mean_luminance(
    width: usize,
    color: &[[f32; 3]],
    rows: std::ops::Range<usize>,
    columns: std::ops::Range<usize>,
) -> f64 {
    let count = rows.len() * columns.len();
    let mut sum = 0.0;
    for y in rows {
        for pixel in &color[y * width..][columns.clone()] {
            let [r, g, b] = pixel.map(|v| f64::from(ops::clamp(v, 0.0, f32::MAX)));
            sum += 0.212_671 * r + 0.715_160 * g + 0.072_169 * b;
        }
    }
    sum / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grey_picture_becomes_the_key() {
        let grey = vec![[0.5; 3]; 40 * 20];
        assert!((exposure(40, 20, &grey) - 0.36).abs() < 1e-6);
    }

    #[test]
    fn black_and_numbers_that_are_no_light_do_not_count() {
        assert_eq!(exposure(3, 1, &[[0.0; 3]; 3]), 1.0);
        let mut half = vec![[0.0; 3]; 32 * 16];
        half.iter_mut().enumerate().for_each(|(k, p)| {
            *p = if k % 32 < 16 { [f32::NAN, -1.0, f32::NAN] } else { [1.0; 3] };
        });
        assert!((exposure(32, 16, &half) - 0.18).abs() < 1e-6);
    }
}
