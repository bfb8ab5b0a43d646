//! What the samples of a pixel have met of an edge, and what there is of it.
//!
//! Sixteen samples tell the share of a pixel that a surface fills to an eighth of a pixel's light. Albedo and normal of the very samples have the same error, and are known better
//! by more camera rays. So light Y is corrected by B (G - g): the guides G of many rays less those of its own, times what light has to do with guides around the pixel. That takes off the part of
//! the noise that is due to the edge, whatever B is (a control variate; Glasserman 2003, "Monte Carlo Methods in Financial Engineering", section 4.1), and the better the nearer B is to the regression of
//! light on guides. It is found by least squares over 5 x 5 pixels of a first clean picture, which has no noise that it could take for a relation.

use rayon::prelude::*;

/// Pixels to each side of a neighbourhood.
const RADIUS: usize = 2;

/// What is added to the variances of the guides, as a share of their mean, and as such: what they can't tell apart is left alone.
const RIDGE: [f64; 2] = [1e-2, 1e-4];

/// Added to brightness before differences are divided by it.
const DARK: f64 = 0.01;

/// Numbers of a pixel that guide.
const GUIDES: usize = 6;

type Guide = [f64; GUIDES];

/// Guides of a picture: albedo and normals, those of its own samples and those of more rays.
pub(crate) struct Edges<'a> {
    pub width: usize,
    pub own: [&'a [[f32; 3]]; 2],
    pub more: [&'a [[f32; 3]]; 2],
}

impl Edges<'_> {
    /// Corrects noisy light, by how light has to do with guides in a picture that is nearly clean.
    pub fn correct(&self, noisy: &mut [[f32; 3]], clean: &[[f32; 3]]) {
        noisy.par_iter_mut().enumerate().for_each(|(k, light)| {
            let (own, more) = (guide(self.own, k), guide(self.more, k));
            let off: Guide = std::array::from_fn(|i| more[i] - own[i]);
            if off.iter().all(|v| *v == 0.0) {
                return;
            }
            let change = self.change(k, &off, clean);
            for (light, change) in light.iter_mut().zip(change) {
                let corrected = (f64::from(*light) + change) as f32;
                if corrected.is_finite() {
                    // Light isn't taken below nothing.
                    *light = if corrected < 0.0 && *light >= 0.0 { 0.0 } else { corrected };
                }
            }
        });
    }

    /// By how much light changes at pixel `k` with guides that change by `off`.
    fn change(&self, k: usize, off: &Guide, clean: &[[f32; 3]]) -> [f64; 3] {
        let width = self.width.max(1);
        let (x, y) = (k % width, k / width);
        let height = clean.len() / width;
        let (mut weights, mut guides, mut lights) = (0.0, [0.0; GUIDES], [0.0; 3]);
        let mut square = [[0.0; GUIDES]; GUIDES];
        let mut cross = [[0.0; 3]; GUIDES];
        for v in y.saturating_sub(RADIUS)..(y + RADIUS + 1).min(height) {
            for u in x.saturating_sub(RADIUS)..(x + RADIUS + 1).min(width) {
                let at = v * width + u;
                let light = clean[at].map(f64::from);
                // So that a highlight doesn't speak for all around it.
                let brightness = (light[0] + light[1] + light[2]) / 3.0 + DARK;
                let weight = 1.0 / (brightness * brightness);
                let g = guide(self.more, at);
                if !(weight.is_finite() && g.iter().all(|v| v.is_finite())) {
                    continue;
                }
                weights += weight;
                for i in 0..GUIDES {
                    guides[i] += weight * g[i];
                    for j in 0..=i {
                        square[i][j] += weight * g[i] * g[j];
                    }
                    for (sum, light) in cross[i].iter_mut().zip(light) {
                        *sum += weight * g[i] * light;
                    }
                }
                for (sum, light) in lights.iter_mut().zip(light) {
                    *sum += weight * light;
                }
            }
        }
        if !(weights > 0.0 && weights.is_finite()) {
            return [0.0; 3];
        }
        for i in 0..GUIDES {
            for j in 0..=i {
                square[i][j] = square[i][j] / weights - guides[i] / weights * (guides[j] / weights);
            }
            for c in 0..3 {
                cross[i][c] = cross[i][c] / weights - guides[i] / weights * (lights[c] / weights);
            }
        }
        let trace = (0..GUIDES).fold(0.0, |sum, i| sum + square[i][i]);
        for (i, row) in square.iter_mut().enumerate() {
            row[i] += RIDGE[0] * trace / GUIDES as f64 + RIDGE[1];
        }
        // The change is off^T S^-1 C: solved for off once, in place of each colour.
        let Some(by) = solve(&square, off) else { return [0.0; 3] };
        std::array::from_fn(|c| by.iter().zip(&cross).fold(0.0, |sum, (by, cross)| sum + by * cross[c]))
    }
}

fn guide([albedo, normal]: [&[[f32; 3]]; 2], k: usize) -> Guide {
    let ([a, b, c], [x, y, z]) = (albedo[k], normal[k]);
    [a, b, c, x, y, z].map(f64::from)
}

/// Solves S x = b for a symmetric, positive definite S, of which the lower half is given, by Cholesky's decomposition.
fn solve(s: &[Guide; GUIDES], b: &Guide) -> Option<Guide> {
    let mut l = [[0.0; GUIDES]; GUIDES];
    for i in 0..GUIDES {
        for j in 0..=i {
            let sum = (0..j).fold(s[i][j], |sum, k| sum - l[i][k] * l[j][k]);
            l[i][j] = if i > j { sum / l[j][j] } else { sum.sqrt() };
        }
        if !(l[i][i] > 0.0 && l[i][i].is_finite()) {
            return None;
        }
    }
    let mut x = *b;
    for i in 0..GUIDES {
        x[i] = (0..i).fold(x[i], |sum, k| sum - l[i][k] * x[k]) / l[i][i];
    }
    for i in (0..GUIDES).rev() {
        x[i] = (i + 1..GUIDES).fold(x[i], |sum, k| sum - l[k][i] * x[k]) / l[i][i];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 16;

    /// Shares of the right one of two surfaces in pixels of a slanted edge.
    fn shares() -> Vec<f32> {
        let share = |k: usize| 0.5 + (k % WIDTH) as f32 - 0.4 * (k / WIDTH) as f32 - 5.0;
        (0..WIDTH * WIDTH).map(|k| straal_math::ops::clamp(share(k), 0.0, 1.0)).collect()
    }

    fn mixed(shares: &[f32], [a, b]: [[f32; 3]; 2]) -> Vec<[f32; 3]> {
        shares.iter().map(|s| std::array::from_fn(|c| a[c] + s * (b[c] - a[c]))).collect()
    }

    #[test]
    fn noise_of_an_edge_is_taken_off() {
        let light = [[0.5, 0.25, 0.125], [4.0, 3.0, 5.0]];
        let (albedo, normal) = ([[0.8; 3], [0.25; 3]], [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
        let truth = shares();
        // What sixteen samples tell: off by up to a fifth where there is an edge.
        let mut state = 1_u32;
        let told: Vec<f32> = { truth.iter() }
            .map(|s| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let off = ((state >> 8) as f32 / (1 << 23) as f32 - 1.0) * 0.2;
                if *s > 0.0 && *s < 1.0 { straal_math::ops::clamp(s + off, 0.0, 1.0) } else { *s }
            })
            .collect();
        let (own, more) =
            ([mixed(&told, albedo), mixed(&told, normal)], [mixed(&truth, albedo), mixed(&truth, normal)]);
        let edges = Edges { width: WIDTH, own: [&own[0], &own[1]], more: [&more[0], &more[1]] };
        let clean = mixed(&truth, light);
        let mut noisy = mixed(&told, light);
        let off = |picture: &[[f32; 3]]| {
            let squares = picture.iter().zip(&clean).map(|(a, b)| (a[0] - b[0]) * (a[0] - b[0]));
            squares.fold(0.0, |sum, v| sum + v)
        };
        let before = off(&noisy);
        edges.correct(&mut noisy, &clean);
        // The ridge leaves a hundredth of it, squared.
        assert!(before > 0.1 && off(&noisy) < 1e-3 * before, "{before} {}", off(&noisy));
    }

    #[test]
    fn what_guides_do_not_tell_stays() {
        let truth = shares();
        let grey = mixed(&truth, [[0.5; 3]; 2]);
        let clean = mixed(&truth, [[1.0; 3], [2.0; 3]]);
        let edges = Edges { width: WIDTH, own: [&grey, &grey], more: [&grey, &grey] };
        let mut noisy = clean.clone();
        edges.correct(&mut noisy, &clean);
        assert!(noisy == clean);
        // Guides that differ without telling anything about light, and numbers that are none.
        let other = mixed(&truth, [[0.25; 3]; 2]);
        let edges = Edges { width: WIDTH, own: [&other, &other], more: [&grey, &grey] };
        edges.correct(&mut noisy, &clean);
        assert!(noisy == clean);
        let bad = vec![[f32::NAN, f32::INFINITY, 0.0]; WIDTH * WIDTH];
        let edges = Edges { width: WIDTH, own: [&bad, &grey], more: [&grey, &bad] };
        edges.correct(&mut noisy, &bad);
        assert!(noisy == clean);
        Edges { width: 0, own: [&[], &[]], more: [&[], &[]] }.correct(&mut [], &[]);
    }

    #[test]
    fn equations_are_solved() {
        let s: [Guide; GUIDES] = std::array::from_fn(|i| {
            std::array::from_fn(|j: usize| if i == j { 4.0 } else { 1.0 / (1.0 + i.abs_diff(j) as f64) })
        });
        let x = [1.0, -2.0, 0.5, 0.0, 3.0, -1.0];
        let b: Guide = s.map(|row| row.iter().zip(x).fold(0.0, |sum, (s, x)| sum + s * x));
        let found = solve(&s, &b).unwrap();
        assert!(found.iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert_eq!(solve(&[[0.0; GUIDES]; GUIDES], &b), None);
    }
}
