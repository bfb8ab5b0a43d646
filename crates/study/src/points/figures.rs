//! How evenly points lie, in figures.

use super::Request;
use straal_math::ops;

/// Sets whose spectra are averaged, for few points.
const SETS: u32 = 16;

/// What there is to say about a pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// The root mean square over several sets of their L2-star discrepancy.
    pub discrepancy: f64,
    /// The same of as many independent points, over all sets that there can be.
    pub discrepancy_of_random: f64,
    /// By radius in cycles a side, from 0: the mean power, which is 1 for independent points; radius 0 is left at 0.
    pub power: Vec<f64>,
    /// Root mean square error of the pixels of (1 + sin(x²y²)) / 2 over [0, 3.79]² and [0, 10.83]², with as many samples
    /// a pixel.
    pub aliasing: [f64; 2],
}

/// Works them out.
pub fn figures(request: &Request, course: &Course) -> Figures {
    let sets = (SETS * 256 / request.count.max(1)).clamp(1, SETS);
    let all: Vec<Vec<[f32; 2]>> = (0..sets).map(|k| request.points([17 * k, 5 * k])).collect();
    let n = f64::from(request.count);
    Figures {
        discrepancy: mean_discrepancy(request),
        discrepancy_of_random: ((1.0 / 4.0 - 1.0 / 9.0) / n).sqrt(),
        power: radial_power(&all),
        aliasing: [0, 1].map(|k| aliasing(request, EXTENTS[k], &course.means[k])),
    }
}

/// Over as many sets as take about as long as a single one of 2,048 points, up to 256: a single set of independent points can be far luckier
/// or unluckier than others.
fn mean_discrepancy(request: &Request) -> f64 {
    let sets =
        ((1 << 22) / (u64::from(request.count) * u64::from(request.count)).max(1)).clamp(1, 256) as u32;
    let squares = (0..sets).map(|k| {
        let d = star_discrepancy(&request.points([17 * k, 5 * k]));
        d * d
    });
    (squares.sum::<f64>() / f64::from(sets)).sqrt()
}

/// The L2-star discrepancy of points of the unit square (Warnock 1972).
pub fn star_discrepancy(points: &[[f32; 2]]) -> f64 {
    let n = points.len() as f64;
    let points: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::from)).collect();
    let later = |a: f64, b: f64| if a > b { a } else { b };
    let (mut single, mut pairs) = (0.0, 0.0);
    for p in &points {
        single += (1.0 - p[0] * p[0]) * (1.0 - p[1] * p[1]);
        pairs += points.iter().map(|q| (1.0 - later(p[0], q[0])) * (1.0 - later(p[1], q[1]))).sum::<f64>();
    }
    let squared = 1.0 / 9.0 - 0.5 * single / n + pairs / (n * n);
    if squared > 0.0 { squared.sqrt() } else { 0.0 }
}

/// Highest frequency of a spectrum of `n` points: twice that of a square grid of as many.
fn highest(n: usize) -> usize {
    (2 * n.isqrt()).clamp(8, 128)
}

/// |sum of exp(-2 pi i k x)|² / n, the mean over sets and over the frequencies k of each radius.
fn radial_power(sets: &[Vec<[f32; 2]>]) -> Vec<f64> {
    let top = highest(sets[0].len());
    let side = 2 * top + 1;
    let mut power = vec![0.0; top + 1];
    let mut count = vec![0.0; top + 1];
    for set in sets {
        // Frequencies -top..=top across, 0..=top down: the others are mirrored.
        let mut sums = vec![[0.0_f64; 2]; side * (top + 1)];
        for point in set {
            let wave = |x: f32, k: f64| {
                let (s, c) = ops::sin_cos_d(-2.0 * std::f64::consts::PI * k * f64::from(x));
                [c, s]
            };
            let across: Vec<[f64; 2]> = (0..side).map(|k| wave(point[0], k as f64 - top as f64)).collect();
            for (k, row) in sums.chunks_exact_mut(side).enumerate() {
                let down = wave(point[1], k as f64);
                for (sum, a) in row.iter_mut().zip(&across) {
                    sum[0] += a[0] * down[0] - a[1] * down[1];
                    sum[1] += a[0] * down[1] + a[1] * down[0];
                }
            }
        }
        for (i, sum) in sums.iter().enumerate() {
            let (x, y) = ((i % side) as f64 - top as f64, (i / side) as f64);
            let radius = ((x * x + y * y).sqrt() + 0.5) as usize;
            if (1..=top).contains(&radius) {
                power[radius] += (sum[0] * sum[0] + sum[1] * sum[1]) / set.len() as f64;
                count[radius] += 1.0;
            }
        }
    }
    power.iter().zip(&count).map(|(p, c)| if *c > 0.0 { p / c } else { 0.0 }).collect()
}

/// The sides of the squares over which the course's test function is looked at.
const EXTENTS: [f64; 2] = [3.79, 10.83];

/// Pixels from side to side of its picture, of which every fourth is looked at.
const PIXELS: u32 = 64;
const STEP: usize = 4;

/// Points a side by which a pixel's true mean is found: the function has up to 68 waves in a pixel.
const FINE: u32 = 256;

fn test_function(x: f64, y: f64) -> f64 {
    0.5 + 0.5 * ops::sin_cos_d(x * x * y * y).0
}

/// The pixels that are looked at.
fn pixels() -> impl Iterator<Item = [u32; 2]> {
    let coordinates = || (1..PIXELS).step_by(STEP);
    coordinates().flat_map(move |y| coordinates().map(move |x| [x, y]))
}

/// The test function at a place of a pixel, in parts of the pixel.
fn within([x, y]: [u32; 2], [u, v]: [f64; 2], extent: f64) -> f64 {
    let side = extent / f64::from(PIXELS);
    test_function((f64::from(x) + u) * side, (f64::from(y) + v) * side)
}

/// The true means of the course's test function over the pixels that samplers are judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    means: [Vec<f64>; 2],
}

impl Course {
    /// Works them out, which takes about a second.
    pub fn new() -> Self {
        Self { means: EXTENTS.map(|extent| pixels().map(|p| true_mean(p, extent)).collect()) }
    }
}

impl Default for Course {
    fn default() -> Self {
        Self::new()
    }
}

fn true_mean(pixel: [u32; 2], extent: f64) -> f64 {
    let fine = |k: u32| (f64::from(k) + 0.5) / f64::from(FINE);
    let row = |j| (0..FINE).map(|i| within(pixel, [fine(i), fine(j)], extent)).sum::<f64>();
    (0..FINE).map(row).sum::<f64>() / f64::from(FINE * FINE)
}

fn aliasing(request: &Request, extent: f64, means: &[f64]) -> f64 {
    let squares = pixels().zip(means).map(|(pixel, mean)| {
        let points = request.points(pixel);
        let sum: f64 = points.iter().map(|p| within(pixel, p.map(f64::from), extent)).sum();
        let error = sum / points.len() as f64 - mean;
        error * error
    });
    (squares.sum::<f64>() / means.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::lowdisc::PatternKind;

    fn of(kind: PatternKind, count: u32) -> Request {
        Request { kind, count, seed: 1, dimensions: [0, 1] }
    }

    #[test]
    fn discrepancy_is_that_of_the_definition() {
        // One point in the middle: the integral of (area - counted)², by the definition.
        let points = [[0.25, 0.5], [0.75, 0.125], [0.5, 0.875]];
        let n = 1000;
        let mut sum = 0.0;
        for i in 0..n * n {
            let corner = [i % n, i / n].map(|v| (f64::from(v) + 0.5) / f64::from(n));
            let inside = points.iter().filter(|p| (0..2).all(|d| f64::from(p[d]) < corner[d])).count();
            let difference = corner[0] * corner[1] - inside as f64 / 3.0;
            sum += difference * difference / f64::from(n * n);
        }
        assert!((star_discrepancy(&points) - sum.sqrt()).abs() < 1e-4);
    }

    #[test]
    fn random_points_have_the_discrepancy_and_the_power_of_chance() {
        let runs = 200;
        let mean = (0..runs)
            .map(|k| star_discrepancy(&of(PatternKind::Random, 64).points([k, 0])))
            .map(|d| d * d)
            .sum::<f64>()
            / f64::from(runs);
        let want = (1.0 / 4.0 - 1.0 / 9.0) / 64.0;
        assert!((mean / want - 1.0).abs() < 0.2, "{mean}, not {want}");
        let sets: Vec<_> = (0..16).map(|k| of(PatternKind::Random, 64).points([k, 1])).collect();
        let power = radial_power(&sets);
        let high = power[8..].iter().sum::<f64>() / (power.len() - 8) as f64;
        assert!((high - 1.0).abs() < 0.1, "{high}");
        // A grid has no power but at whole multiples of its own frequency.
        let grid = radial_power(&[of(PatternKind::Regular, 64).points([0, 0])]);
        assert!(grid[1..8].iter().all(|p| *p < 1e-9) && grid[8] > 1.0);
    }

    #[test]
    fn patterns_are_evener_than_chance() {
        for kind in PatternKind::ALL {
            let discrepancy = star_discrepancy(&of(kind, 64).points([3, 3]));
            let random = ((1.0 / 4.0 - 1.0 / 9.0) / 64.0_f64).sqrt();
            if kind != PatternKind::Random {
                assert!(discrepancy < 0.9 * random, "{kind}: {discrepancy}, chance {random}");
            }
        }
    }

    #[test]
    fn good_patterns_alias_less() {
        let means: Vec<f64> = pixels().map(|p| true_mean(p, EXTENTS[0])).collect();
        let error = |kind| aliasing(&of(kind, 16), EXTENTS[0], &means);
        let random = error(PatternKind::Random);
        assert!(error(PatternKind::Sobol) < 0.5 * random && error(PatternKind::MultiJittered) < 0.5 * random);
    }
}
