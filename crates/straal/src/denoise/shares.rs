//! How much each of several networks counts in their mean.
//!
//! Networks that were trained with other guides make other mistakes, and which of them is nearest to the truth depends on the picture: one that sees the light alone is the best at
//! sharp shadows, which no guide tells, and the worst at textures. The two halves A and B of the samples tell it. B is the truth and a noise that has nothing to do with A, so that for
//! what networks make of A
//!
//! E[(D_i(A) - B) (D_j(A) - B)] = E[(D_i(A) - T) (D_j(A) - T)] + E|B - T|²,
//!
//! where the last term is the same for all. So the shares w of the least error have the least w^T R w, where R are the means of these products, of A's against B and of B's against A.
//! They are at least 0 and make up 1. (Least squares with the noise of one picture judging the other, as in the selection of filters by Rousselle, Manzi and Zwicker 2013, "Robust
//! Denoising using Feature and Color Information".)
//!
//! The shares are those of the whole picture. Measured on ten scenes at 16 samples, shares by squares of 33 or 65 pixels are better by 2 % at best, and as often worse: they learn the noise.

use rayon::prelude::*;

/// Networks.
pub(super) const NETWORKS: usize = 3;

/// The shares that are taken where the halves don't tell: networks that see guides are nearer to the truth more often.
pub(super) const USUAL: Shares = [0.4, 0.4, 0.2];

/// How strongly shares are drawn to the usual ones, as a part of what the networks differ by.
const DRAWN: f64 = 0.1;

/// Added to brightness before differences are divided by it, in the picture's own scale.
const DARK: f64 = 0.01;

/// Squares of differences of both halves, relative to brightness, from which on a pixel counts by half or less: those of a firefly tell nothing.
const FIREFLY: f64 = 9.0;

/// Rounds of exchange between shares. Each takes what is left of the way to the best to a part of it; thirty are enough for four digits.
const ROUNDS: usize = 100;

/// Sums of products of what each pair of networks is off by.
type Products = [[f64; NETWORKS]; NETWORKS];

/// Light of a picture's pixels.
pub(super) type Light = Vec<[f32; 3]>;

/// What each of them makes of some light.
pub(super) type Pictures = [Light; NETWORKS];

/// How much each of them counts.
pub(super) type Shares = [f32; NETWORKS];

/// The shares of networks that make `clean` of each of the halves `noisy`.
pub(super) fn shares(width: usize, noisy: [&[[f32; 3]]; 2], clean: [&Pictures; 2]) -> Shares {
    let count = noisy[0].len();
    // Rows are summed one after the other, so that threads don't change the sum.
    let rows: Vec<Products> = (0..count.div_ceil(width.max(1)))
        .into_par_iter()
        .map(|y| {
            let row = y * width..((y + 1) * width).min(count);
            row.fold(Products::default(), |sum, k| plus(sum, &off(noisy, clean, k)))
        })
        .collect();
    let sum = rows.iter().fold(Products::default(), plus);
    least(&sum).map(|share| share as f32)
}

fn plus(mut a: Products, b: &Products) -> Products {
    a.iter_mut().flatten().zip(b.iter().flatten()).for_each(|(a, b)| *a += b);
    a
}

/// A pixel's products.
fn off(noisy: [&[[f32; 3]]; 2], clean: [&Pictures; 2], k: usize) -> Products {
    let light = |p: &[f32; 3]| p.map(f64::from);
    let halves = noisy.map(|half| light(&half[k]));
    let made = clean.map(|half| half.each_ref().map(|of| light(&of[k])));
    let brightness = made.iter().flat_map(|half| half[0]).sum::<f64>() / 6.0 + DARK;
    let scale = 1.0 / (brightness * brightness);
    let apart = (0..3).map(|c| halves[0][c] - halves[1][c]).fold(0.0, |sum, v| sum + v * v);
    let weight = scale / (1.0 + apart * scale / FIREFLY);
    let mut out = Products::default();
    for (half, other) in [(0, 1), (1, 0)] {
        let off: [[f64; 3]; NETWORKS] =
            made[half].map(|of| std::array::from_fn(|c| of[c] - halves[other][c]));
        for (out, a) in out.iter_mut().zip(&off) {
            for (out, b) in out.iter_mut().zip(&off) {
                *out += weight * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
            }
        }
    }
    if out.iter().flatten().all(|v| v.is_finite()) { out } else { Products::default() }
}

/// The shares w of the least w^T R w, drawn to the usual ones.
fn least(products: &Products) -> [f64; NETWORKS] {
    let square = |i: usize, j: usize| products[i][i] - 2.0 * products[i][j] + products[j][j];
    let pairs = (0..NETWORKS).flat_map(|i| (0..i).map(move |j| (i, j)));
    let differences = pairs.clone().map(|(i, j)| square(i, j)).sum::<f64>() / pairs.clone().count() as f64;
    let drawn = DRAWN * differences;
    let usual = USUAL.map(f64::from);
    let mut shares = usual;
    if !(drawn > 0.0 && drawn.is_finite()) {
        return shares;
    }
    for (i, j) in std::iter::repeat_n(pairs, ROUNDS).flatten() {
        // What the error changes by where one share grows.
        let slope = |i: usize| {
            let along = shares.iter().zip(&products[i]).map(|(share, p)| share * p).sum::<f64>();
            along + drawn * (shares[i] - usual[i])
        };
        let step = (slope(j) - slope(i)) / (square(i, j) + 2.0 * drawn);
        let step = if step > shares[j] { shares[j] } else { step };
        let step = if step < -shares[i] { -shares[i] } else { step };
        shares[i] += step;
        shares[j] -= step;
    }
    shares
}

/// The mean of pictures of which each has a share, in the place of the first.
pub(super) fn mean(mut pictures: Pictures, shares: Shares) -> Vec<[f32; 3]> {
    let mut out = std::mem::take(&mut pictures[0]);
    out.as_flattened_mut().iter_mut().for_each(|v| *v *= shares[0]);
    for (more, share) in pictures.iter().zip(shares).skip(1) {
        super::add(&mut out, more, share);
    }
    out
}

/// A picture as a mirror shows it, with left and right exchanged.
pub(super) fn mirrored(width: usize, picture: &[[f32; 3]]) -> Vec<[f32; 3]> {
    picture.chunks(width.max(1)).flat_map(|row| row.iter().rev().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 40;

    /// Numbers that look like chance, of mean 0.
    fn noise(seed: u32, size: f32) -> Vec<[f32; 3]> {
        let mut state = seed.wrapping_mul(0x9e37_79b9);
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((state >> 8) as f32 / (1 << 23) as f32 - 1.0) * size
        };
        (0..WIDTH * WIDTH).map(|_| std::array::from_fn(|_| next())).collect()
    }

    /// A grey of 1 and what is added to it.
    fn grey(off: &[[f32; 3]]) -> Vec<[f32; 3]> {
        off.iter().map(|p| p.map(|v| 1.0 + v)).collect()
    }

    /// What networks make of a noisy grey that are off by so much, each in its own way, the same for both halves.
    fn found(sizes: [f32; NETWORKS], noisy: &[Vec<[f32; 3]>; 2]) -> Shares {
        let mut seed = 10;
        let clean = sizes.map(|size| {
            seed += 1;
            grey(&noise(seed, size))
        });
        shares(WIDTH, [&noisy[0], &noisy[1]], [&clean, &clean])
    }

    #[test]
    fn shares_are_as_networks_err() {
        let noisy = [1, 2].map(|seed| grey(&noise(seed, 0.5)));
        // Errors that have nothing to do with one another: the best shares go as 1 / size², drawn to the usual ones.
        let even = found([0.1; 3], &noisy);
        assert!(even.iter().zip([0.34, 0.34, 0.31]).all(|(a, b)| (a - b).abs() < 0.08), "{even:?}");
        let third = found([0.4, 0.4, 0.02], &noisy);
        assert!(third[2] > 0.75, "{third:?}");
        let first = found([0.02, 0.4, 0.4], &noisy);
        assert!(first[0] > 0.8 && first[2] < 0.1, "{first:?}");
        for shares in [even, third, first] {
            let sum: f32 = shares.iter().sum();
            assert!((sum - 1.0).abs() < 1e-5 && shares.iter().all(|s| *s >= 0.0), "{shares:?}");
        }
    }

    #[test]
    fn a_firefly_does_not_speak_for_the_picture() {
        let mut noisy = [1, 2].map(|seed| grey(&noise(seed, 0.5)));
        let before = found([0.02, 0.4, 0.4], &noisy);
        noisy[0][777] = [1e6; 3];
        noisy[1][12] = [f32::NAN, f32::INFINITY, 1.0];
        let after = found([0.02, 0.4, 0.4], &noisy);
        assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 0.02), "{before:?} {after:?}");
    }

    #[test]
    fn where_networks_agree_shares_are_the_usual() {
        let noisy = [1, 2].map(|seed| grey(&noise(seed, 0.5)));
        assert_eq!(found([0.0; 3], &noisy), USUAL);
        let nothing = Pictures::default();
        assert_eq!(shares(0, [&[], &[]], [&nothing, &nothing]), USUAL);
    }

    #[test]
    fn a_mirror_turns_rows() {
        let picture: Vec<[f32; 3]> = (0..6).map(|v| [v as f32; 3]).collect();
        let turned = mirrored(3, &picture);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|k| turned[k][0]), [2.0, 1.0, 0.0, 5.0, 4.0, 3.0]);
        assert_eq!(mirrored(3, &turned), picture);
        assert!(mirrored(0, &[]).is_empty());
    }

    #[test]
    fn means_have_their_shares() {
        let pictures = [1.0, 2.0, 4.0].map(|v| vec![[v, 0.0, 1.0]]);
        assert_eq!(mean(pictures, [0.5, 0.25, 0.25]), [[2.0, 0.0, 1.0]]);
    }
}
