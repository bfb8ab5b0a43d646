//! How far a denoised picture is from the truth, and where the noisy one is nearer.
//!
//! The samples of a picture are parted into two pictures A and B that know nothing of each other, of shares a and b; Y = a A + b B is the noisy
//! picture. Each is denoised by itself, to D_A and D_B; D is the denoised whole. What differs between A and B is chance alone, so that from
//! means over a neighbourhood follow, without any assumption about the noise or the network,
//!
//! - V = a b |A - B|², the variance of the noisy picture,
//! - X = a b (A - B)(D_A - D_B), what the denoised picture has taken over of that noise (its covariance with it), and
//! - M = |D - Y|², by how much they differ: the denoised picture's own error and noise, and V - 2 X.
//!
//! The mean square error of Y + w (D - Y) is V - 2 w (V - X) + w² M, as in Stein's unbiased estimate (Stein 1981, "Estimation of the Mean of a
//! Multivariate Normal Distribution"), whose derivative of the network the two halves stand for. It is least for w = (V - X) / M: 1 where the network is right and
//! the noise is large, 0 where the network is farther from the truth than the noise.

use rayon::prelude::*;
use straal_math::ops;

/// Pixels to each side of a neighbourhood. Measured on the reference scenes from 16 to 4096 samples: half of it is as good with many samples, and with few the weight becomes noisy itself.
const RADIUS: usize = 7;

/// The share from which on the denoised picture is taken whole, and less of it accordingly. The share is known by few neighbours, and with few samples it is nearly always 1 but
/// for chance. From a half on, all of the denoised picture is nearer to the truth than the noisy one, so that this never makes a picture worse than its samples.
/// Measured on ten scenes at 16 samples, 0.9 has 2 to 6 % more error.
const WHOLE: f32 = 0.6;

/// Added to brightness before differences are divided by it.
const DARK: f32 = 0.01;

/// What [`blend`] takes, all by pixel.
pub(crate) struct Halves<'a> {
    pub width: usize,
    /// A and B.
    pub noisy: [&'a [[f32; 3]]; 2],
    /// The share of A.
    pub share: &'a [f32],
    /// D_A and D_B.
    pub clean: [&'a [[f32; 3]]; 2],
}

/// What comes of it, by pixel.
pub(crate) struct Blended {
    pub rgb: Vec<[f32; 3]>,
    /// The root mean square error that is to be expected.
    pub error: Vec<[f32; 3]>,
    /// The share of the denoised picture.
    pub weight: Vec<f32>,
}

/// Two pixels of halves, of which the first has that share.
fn both(share: f32, a: &[f32; 3], b: &[f32; 3]) -> [f32; 3] {
    std::array::from_fn(|c| share * a[c] + (1.0 - share) * b[c])
}

/// The whole of two halves, of which the first has these shares.
pub(crate) fn mean(shares: &[f32], a: &[[f32; 3]], b: &[[f32; 3]]) -> Vec<[f32; 3]> {
    shares.iter().zip(a.iter().zip(b)).map(|(share, (a, b))| both(*share, a, b)).collect()
}

/// The noisy picture and the denoised `clean`, each where it is nearer to the truth. What is nearer is told by the halves alone.
pub(crate) fn blend(of: &Halves<'_>, noisy: &[[f32; 3]], clean: &[[f32; 3]]) -> Blended {
    let each = |f: &(dyn Fn(usize) -> f32 + Sync)| -> Vec<f32> {
        let values: Vec<f32> = (0..noisy.len()).into_par_iter().map(f).collect();
        smooth(of.width, &values)
    };
    let ([a, b], [da, db]) = (of.noisy, of.clean);
    let product = |k: usize| of.share[k] * (1.0 - of.share[k]);
    let both = |k: usize, a: &[f32; 3], b: &[f32; 3]| both(of.share[k], a, b);
    let mean = |k: usize| both(k, &da[k], &db[k]);
    // Relative to brightness, so that a lamp doesn't speak for the wall beside it.
    let scale = |k: usize| {
        let brightness = mean(k).iter().fold(0.0, |sum, v| sum + v) / 3.0 + DARK;
        if brightness.is_finite() { 1.0 / (brightness * brightness) } else { 0.0 }
    };
    let sum = |k: usize, f: &dyn Fn(usize) -> f32| {
        let sum = (f(0) + f(1) + f(2)) * scale(k);
        if sum.is_finite() { sum } else { 0.0 }
    };
    let square = |v: f32| v * v;
    let variance = each(&|k| sum(k, &|c| product(k) * square(a[k][c] - b[k][c])));
    let taken_over = each(&|k| sum(k, &|c| product(k) * (a[k][c] - b[k][c]) * (da[k][c] - db[k][c])));
    let apart = each(&|k| {
        let (mean, own) = (mean(k), both(k, &a[k], &b[k]));
        sum(k, &|c| square(mean[c] - own[c]))
    });
    let weight: Vec<f32> = (0..noisy.len())
        .map(|k| {
            // Where they don't differ, either will do.
            let best = if apart[k] > 0.0 { (variance[k] - taken_over[k]) / apart[k] } else { 1.0 };
            ops::clamp(best / WHOLE, 0.0, 1.0)
        })
        .collect();
    // Never less than what the halves differ by.
    let chance = each(&|k| {
        let w = weight[k];
        sum(k, &|c| product(k) * square(w * (da[k][c] - db[k][c]) + (1.0 - w) * (a[k][c] - b[k][c])))
    });
    let mut out = Blended { rgb: Vec::new(), error: Vec::new(), weight: Vec::new() };
    for k in 0..noisy.len() {
        let w = weight[k];
        out.rgb.push(std::array::from_fn(|c| {
            if w >= 1.0 { clean[k][c] } else { noisy[k][c] + w * (clean[k][c] - noisy[k][c]) }
        }));
        let expected = variance[k] - 2.0 * w * (variance[k] - taken_over[k]) + w * w * apart[k];
        let square = ops::max(ops::max(expected, chance[k]), 0.0);
        let by = scale(k);
        out.error.push([if by > 0.0 { (square / (3.0 * by)).sqrt() } else { 0.0 }; 3]);
    }
    out.weight = weight;
    out
}

/// The mean over squares of 2 [`RADIUS`] + 1 pixels, or what of them lies in the picture. Sums are taken anew for each pixel and direction, so that they don't drift.
fn smooth(width: usize, values: &[f32]) -> Vec<f32> {
    let height = values.len().checked_div(width).unwrap_or(0);
    let near = |at: usize, end: usize| at.saturating_sub(RADIUS)..(at + RADIUS + 1).min(end);
    let mut rows = vec![0.0; values.len()];
    rows.par_chunks_mut(width.max(1)).zip(values.par_chunks(width.max(1))).for_each(|(out, row)| {
        for (x, out) in out.iter_mut().enumerate() {
            let near = near(x, row.len());
            let count = near.len() as f32;
            *out = row[near].iter().fold(0.0, |sum, v| sum + v) / count;
        }
    });
    let mut out = vec![0.0_f32; values.len()];
    out.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, out)| {
        let near = near(y, height);
        let count = near.len() as f32;
        for v in near {
            out.iter_mut().zip(&rows[v * width..]).for_each(|(sum, v)| *sum += v);
        }
        out.iter_mut().for_each(|sum| *sum /= count);
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 48;

    /// Numbers that look like chance, of mean 0 and variance 1/3.
    fn noise(seed: u32, size: f32) -> Vec<[f32; 3]> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((state >> 8) as f32 / (1 << 23) as f32 - 1.0) * size
        };
        (0..WIDTH * WIDTH).map(|_| std::array::from_fn(|_| next())).collect()
    }

    fn plus(a: &[[f32; 3]], value: f32) -> Vec<[f32; 3]> {
        a.iter().map(|p| p.map(|v| v + value)).collect()
    }

    fn mean(a: &[[f32; 3]], b: &[[f32; 3]]) -> Vec<[f32; 3]> {
        a.iter().zip(b).map(|(a, b)| std::array::from_fn(|c| 0.5 * (a[c] + b[c]))).collect()
    }

    /// A grey of 1, whose halves have such noise, and what a network makes of them: off by a constant, and with some of the noise kept.
    fn blended(size: f32, off: f32, kept: f32) -> (Blended, f32) {
        let noises = [noise(1, size), noise(2, size)];
        let noisy = [plus(&noises[0], 1.0), plus(&noises[1], 1.0)];
        let clean = noises
            .each_ref()
            .map(|n| -> Vec<[f32; 3]> { n.iter().map(|p| p.map(|v| 1.0 + off + kept * v)).collect() });
        let share = vec![0.5; WIDTH * WIDTH];
        let halves = Halves {
            width: WIDTH,
            noisy: [&noisy[0], &noisy[1]],
            share: &share,
            clean: [&clean[0], &clean[1]],
        };
        let out = blend(&halves, &mean(&noisy[0], &noisy[1]), &mean(&clean[0], &clean[1]));
        let square = out.rgb.iter().flatten().fold(0.0, |sum, v| sum + (v - 1.0) * (v - 1.0));
        let error = (square / (3 * WIDTH * WIDTH) as f32).sqrt();
        (out, error)
    }

    #[test]
    fn the_nearer_picture_counts_and_the_error_is_told() {
        // Noise of standard error 0.2 and 0.002 beside a network that is off by 0.02.
        for (size, off, kept, expected) in [
            (0.5, 0.02, 0.0, [0.95, 1.0]),
            (0.005, 0.02, 0.0, [0.0, 0.05]),
            (0.5, 0.0, 0.3, [0.95, 1.0]),
            (0.1, 0.04, 0.2, [0.3, 0.9]),
        ] {
            let (out, error) = blended(size, off, kept);
            let n = (WIDTH * WIDTH) as f32;
            let weight = out.weight.iter().fold(0.0, |sum, w| sum + w) / n;
            assert!((expected[0]..=expected[1]).contains(&weight), "{size} {off} {kept}: {weight}");
            // The noise's variance is known by the 675 numbers of a neighbourhood, to a part of sqrt(2 / 675), and no square is below 0.
            let noisy = size * (1.0_f32 / 6.0).sqrt();
            let told = out.error.iter().fold(0.0, |sum, e| sum + e[0] * e[0]) / n;
            let bound = 0.5 * error * error + 0.06 * noisy * noisy;
            let off_by = (told - error * error).abs();
            assert!(off_by < bound, "{size} {off} {kept}: {}, not {error}", told.sqrt());
            // Never much worse than either.
            let clean = (off * off + kept * kept * noisy * noisy).sqrt();
            let better = if noisy < clean { noisy } else { clean };
            assert!(error < 1.05 * better, "{size} {off} {kept}: {error}, {noisy} {clean}");
        }
    }

    #[test]
    fn equal_pictures_numbers_that_are_none_and_nothing_do_no_harm() {
        let (out, error) = blended(0.0, 0.0, 0.0);
        assert_eq!((error, out.error[0]), (0.0, [0.0; 3]));
        let bad = vec![[f32::INFINITY, f32::NAN, 1.0]; 4];
        let halves = Halves { width: 2, noisy: [&bad, &bad], share: &[0.5; 4], clean: [&bad, &bad] };
        assert!(blend(&halves, &bad, &[[1.0; 3]; 4]).error.iter().flatten().all(|e| e.is_finite()));
        let halves = Halves { width: 0, noisy: [&[], &[]], share: &[], clean: [&[], &[]] };
        assert!(blend(&halves, &[], &[]).rgb.is_empty());
    }
}
