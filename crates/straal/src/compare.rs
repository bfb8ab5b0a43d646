//! Whether two pictures differ by more than their noise.
//!
//! A Monte Carlo picture is an estimate: each value has a variance, known from replicates or from the samples. Two
//! pictures of the same scene agree when their differences, measured in standard errors, look like chance: pixel
//! by pixel, over blocks of 8 x 8 pixels, and for the mean of the whole picture. The test at each place is Welch's
//! (1947), since the two variances differ and are themselves estimates from few replicates.
//!
//! Pixels are taken to be independent, which a box filter makes them; wider filters make blocks look surer than
//! they are.

use serde_json::json;
use straal_math::ops::{exp_d, ln_d};
use straal_scene::Image;

use self::student::{binomial_at_least, two_sided};

mod student;
#[cfg(test)]
mod tests;

/// A picture and how sure its values are.
#[derive(Clone, Copy, Debug)]
pub struct Estimate<'a> {
    /// The values.
    pub image: &'a Image,
    /// The variance of every value (of the mean, not of a sample), if known. Without it every value is taken to be
    /// exact.
    pub variance: Option<&'a Image>,
    /// Degrees of freedom of the variance: replicates less one.
    pub dof: f64,
}

impl<'a> Estimate<'a> {
    /// A picture with the variance from 16 replicates, or without one.
    pub fn new(image: &'a Image, variance: Option<&'a Image>) -> Self {
        Self { image, variance, dof: 15.0 }
    }
}

/// How the noise of the pictures is spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tails {
    /// Nearly normal: single pixels can be judged.
    Light,
    /// Rare bright paths make single pixels lie (caustics): the mean and the blocks are judged.
    Heavy,
}

/// What there is to say about the difference of picture A and picture B.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Means of both pictures, by channel.
    pub means: [[f64; 3]; 2],
    /// The mean of A - B, by channel.
    pub mean_error: [f64; 3],
    /// The mean error of the values that have noise, in standard errors, by channel; 0 where none has.
    pub mean_z: [f64; 3],
    /// Mean over pixels and channels of ((A - B)² - V) / (B² + 0.01), V the variance of B; `None` when V isn't known.
    pub relmse: Option<f64>,
    /// The same with V = 0: too high by the noise of B.
    pub relmse_biased: f64,
    /// The median over pixels of the best of the two, the channels averaged in each pixel.
    pub relmse_median: f64,
    /// Values that both pictures are sure of.
    pub exact: Exact,
    /// Welch's test of every value that neither picture is sure of.
    pub pixels: Tally,
    /// Welch's test of every block and channel that any picture is unsure of.
    pub blocks: Tally,
    /// Pixels with an infinite value or NaN in either picture; nothing else looks at them.
    pub non_finite: usize,
    /// Whether the pictures differ beyond chance.
    pub differs: bool,
    /// Why, in words; empty when they don't differ.
    pub reasons: Vec<String>,
}

/// Values with no variance in both pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exact {
    /// How many there are.
    pub compared: usize,
    /// How many differ by more than 1e-4, absolutely up to 1 and relatively beyond.
    pub differing: usize,
    /// The largest difference, by that measure.
    pub worst: f64,
}

/// The outcome of one test in many places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Values tested.
    pub tested: usize,
    /// How many are beyond the 99 % bound of Student's t: one in a hundred by chance.
    pub beyond: usize,
    /// The difference that is the least likely, in standard errors.
    pub worst_t: f64,
    /// Where that is: column and row of the pixel, or of the block's first.
    pub worst_at: [usize; 2],
    /// The chance that the least likely of so many differences is as unlikely as that (Šidák 1967).
    pub p_worst: f64,
    /// The chance of so many beyond the bound (binomial), for the worst channel of three (Bonferroni).
    pub p_count: f64,
}

/// The pictures are of different sizes, so that there is nothing to compare.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what} is {} x {} pixels, picture A is {} x {}", found[0], found[1], expected[0], expected[1])]
pub struct SizeError {
    /// The picture that is not of the size of picture A.
    pub what: &'static str,
    /// Its width and height.
    pub found: [usize; 2],
    /// Those of picture A.
    pub expected: [usize; 2],
}

/// Blocks are this many pixels wide and high; those at the right and bottom edges may be smaller.
const BLOCK: usize = 8;
/// Values that both pictures are sure of may differ by this much, absolutely up to 1 and relatively beyond.
const EXACT: f64 = 1e-4;
/// A standard error below this part of the value is rounding of a sum and not noise.
const ROUNDING: f64 = 1e-6;
/// The bound beyond which values are counted: one in a hundred is there by chance.
const BOUND: f64 = 0.01;
/// A test fails when its outcome has less than this chance. Five tests at most are made, so that equal pictures
/// with normal noise are told apart wrongly in fewer than one comparison in two hundred.
const ALPHA: f64 = 1e-3;
/// For heavy tails: the part of blocks that may be beyond the bound.
const HEAVY_BEYOND: f64 = 0.02;
/// In a small picture more than that may be there by chance: it must be less likely than this. From some 256 x 256
/// pixels on it always is.
const SMALL_PICTURE: f64 = 0.01;
/// The standard errors by which the means of the whole pictures may differ.
const MEAN_Z: f64 = 4.0;

/// Compares two pictures.
pub fn compare(a: Estimate<'_>, b: Estimate<'_>, tails: Tails) -> Result<Comparison, SizeError> {
    let size = [a.image.width, a.image.height];
    let images =
        [(Some(b.image), "picture B"), (a.variance, "the variance of A"), (b.variance, "the variance of B")];
    for (image, what) in images {
        let found = image.map_or(size, |image| [image.width, image.height]);
        if found != size {
            return Err(SizeError { what, found, expected: size });
        }
    }
    let values = Values { a, b };
    let dof = [a.dof, b.dof];
    let ratio = values.noise_ratio();
    // What is sure is compared as such, and left out of the tests: its small differences are no noise.
    let mut unsure = [Sums::default(); 3];
    let mut totals = [[0.0; 3]; 2];
    let (mut pixels, mut blocks) = (Tests::default(), Tests::default());
    let mut exact = Exact::default();
    let mut relmse = RelMse::default();
    let mut non_finite = 0;
    for corner in block_corners(size) {
        let mut block = [Sums::default(); 3];
        for [x, y] in pixels_of_block(corner, size) {
            let Some(pixel) = values.at(y * size[0] + x) else {
                non_finite += 1;
                continue;
            };
            relmse.add(&pixel);
            for (k, &value) in pixel.iter().enumerate() {
                totals[0][k] += value[0];
                totals[1][k] += value[1];
                if let [a, b, 0.0, 0.0] = value {
                    exact.add(a, b);
                    continue;
                }
                block[k].add(value);
                // Where one picture found nothing its variance isn't zero but unknown.
                if value[2] > 0.0 && value[3] > 0.0 {
                    let mut alone = Sums::default();
                    alone.add(value);
                    pixels.add(k, [x, y], alone.borrowing(ratio).welch(dof));
                }
            }
        }
        for (k, sums) in block.iter().enumerate() {
            blocks.add(k, corner, sums.borrowing(ratio).welch(dof));
            unsure[k].merge(sums);
        }
    }
    let count = (size[0] * size[1] - non_finite).max(1) as f64;
    let mut comparison = Comparison {
        size,
        means: totals.map(|sums| sums.map(|sum| sum / count)),
        mean_error: [0, 1, 2].map(|k| (totals[0][k] - totals[1][k]) / count),
        mean_z: unsure.map(|sums| sums.welch(dof).map_or(0.0, |(z, _)| z)),
        relmse: b.variance.is_some().then_some(relmse.sum / (3.0 * count)),
        relmse_biased: relmse.biased_sum / (3.0 * count),
        relmse_median: relmse.median(),
        exact,
        pixels: pixels.finish(),
        blocks: blocks.finish(),
        non_finite,
        differs: false,
        reasons: Vec::new(),
    };
    comparison.reasons = reasons(&comparison, tails);
    comparison.differs = !comparison.reasons.is_empty();
    Ok(comparison)
}

impl Comparison {
    /// Everything as JSON, under the names of the fields.
    pub fn to_json(&self) -> serde_json::Value {
        let tally = |tally: &Tally| {
            json!({
                "tested": tally.tested,
                "beyond": tally.beyond,
                "worst_t": tally.worst_t,
                "worst_at": tally.worst_at,
                "p_worst": tally.p_worst,
                "p_count": tally.p_count,
            })
        };
        json!({
            "differs": self.differs,
            "reasons": self.reasons,
            "size": self.size,
            "means": self.means,
            "mean_error": self.mean_error,
            "mean_z": self.mean_z,
            "relmse": self.relmse,
            "relmse_biased": self.relmse_biased,
            "relmse_median": self.relmse_median,
            "exact": {
                "compared": self.exact.compared,
                "differing": self.exact.differing,
                "worst": self.exact.worst,
            },
            "pixels": tally(&self.pixels),
            "blocks": tally(&self.blocks),
            "non_finite": self.non_finite,
        })
    }
}

/// The values of both pictures at a pixel, by channel: value of A and B, variance of A and B.
type Pixel = [[f64; 4]; 3];

/// Both pictures, looked at together.
struct Values<'a> {
    a: Estimate<'a>,
    b: Estimate<'a>,
}

impl Values<'_> {
    /// The values at a pixel; `None` if any of them is not finite.
    fn at(&self, index: usize) -> Option<Pixel> {
        let variance = |estimate: &Estimate<'_>, k: usize, value: f64| {
            let variance = estimate.variance.map_or(0.0, |image| f64::from(image.pixels[index][k]));
            let rounding = ROUNDING * value;
            if variance > rounding * rounding || variance.is_nan() { variance } else { 0.0 }
        };
        let pixel: Pixel = [0, 1, 2].map(|k| {
            let (a, b) = (f64::from(self.a.image.pixels[index][k]), f64::from(self.b.image.pixels[index][k]));
            [a, b, variance(&self.a, k, a), variance(&self.b, k, b)]
        });
        pixel.as_flattened().iter().all(|v| v.is_finite()).then_some(pixel)
    }

    /// How many times the variance of B that of A is: the median over blocks and channels, of the blocks where both
    /// have noise; `None` where there are none. Over blocks, since the variance that a single pixel shows is far too
    /// low in most pixels when the noise comes from rare paths, and the more so in the picture with fewer samples.
    fn noise_ratio(&self) -> Option<f64> {
        let size = [self.a.image.width, self.a.image.height];
        let mut ratios = Vec::new();
        for corner in block_corners(size) {
            let mut block = [Sums::default(); 3];
            for pixel in pixels_of_block(corner, size).filter_map(|[x, y]| self.at(y * size[0] + x)) {
                for (sums, value) in block.iter_mut().zip(pixel) {
                    sums.add(value);
                }
            }
            ratios.extend(block.iter().map(|sums| sums.variance[0] / sums.variance[1]));
        }
        ratios.retain(|ratio| *ratio > 0.0 && ratio.is_finite());
        let middle = ratios.len() / 2;
        (!ratios.is_empty()).then(|| *ratios.select_nth_unstable_by(middle, f64::total_cmp).1)
    }
}

/// The first column and row of every block.
fn block_corners([width, height]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    (0..height).step_by(BLOCK).flat_map(move |y| (0..width).step_by(BLOCK).map(move |x| [x, y]))
}

fn pixels_of_block([x0, y0]: [usize; 2], [width, height]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    let columns = x0..width.min(x0 + BLOCK);
    (y0..height.min(y0 + BLOCK)).flat_map(move |y| columns.clone().map(move |x| [x, y]))
}

/// Sums over the pixels of a block or of the picture, of one channel.
#[derive(Clone, Copy, Default)]
struct Sums {
    a: f64,
    b: f64,
    /// Variance of both sums, and the squares of the variances, which tell how many degrees of freedom they have.
    variance: [f64; 2],
    squares: [f64; 2],
}

impl Sums {
    fn add(&mut self, [a, b, va, vb]: [f64; 4]) {
        self.a += a;
        self.b += b;
        self.variance = [self.variance[0] + va, self.variance[1] + vb];
        self.squares = [self.squares[0] + va * va, self.squares[1] + vb * vb];
    }

    fn merge(&mut self, other: &Self) {
        self.a += other.a;
        self.b += other.b;
        for k in 0..2 {
            self.variance[k] += other.variance[k];
            self.squares[k] += other.squares[k];
        }
    }

    /// The same with at least the variance that the other picture, whose noise has `ratio` times less variance,
    /// shows. Skewed noise needs this: where few paths reach light, the replicates that miss it give a value that is
    /// too low and a variance that is too low at once, and Student's t counts such luck as certainty.
    fn borrowing(mut self, ratio: Option<f64>) -> Self {
        let Some(ratio) = ratio else { return self };
        for (k, scale) in [(0, ratio), (1, 1.0 / ratio)] {
            let other = 1 - k;
            if self.variance[k] < scale * self.variance[other] {
                self.variance[k] = scale * self.variance[other];
                self.squares[k] = scale * scale * self.squares[other];
                break;
            }
        }
        self
    }

    /// The difference in standard errors and its chance: Welch's t with the Welch-Satterthwaite degrees of freedom.
    /// `None` if both sums are sure.
    fn welch(&self, dof: [f64; 2]) -> Option<(f64, f64)> {
        let variance = self.variance[0] + self.variance[1];
        if variance <= 0.0 {
            return None;
        }
        let t = (self.a - self.b) / variance.sqrt();
        let dof = variance * variance / (self.squares[0] / dof[0] + self.squares[1] / dof[1]);
        Some((t, two_sided(t, dof)))
    }
}

impl Exact {
    fn add(&mut self, a: f64, b: f64) {
        let size = [1.0, a.abs(), b.abs()].into_iter().fold(0.0, |m, v| if v > m { v } else { m });
        let difference = (a - b).abs() / size;
        self.compared += 1;
        self.differing += usize::from(difference > EXACT);
        if difference > self.worst {
            self.worst = difference;
        }
    }
}

/// Relative errors, pixel by pixel.
#[derive(Default)]
struct RelMse {
    sum: f64,
    biased_sum: f64,
    by_pixel: Vec<f64>,
}

impl RelMse {
    fn add(&mut self, pixel: &Pixel) {
        let mut here = 0.0;
        for &[a, b, _, vb] in pixel {
            let square = (a - b) * (a - b);
            let scale = b * b + 0.01;
            here += (square - vb) / scale;
            self.biased_sum += square / scale;
        }
        self.sum += here;
        self.by_pixel.push(here / 3.0);
    }

    fn median(mut self) -> f64 {
        if self.by_pixel.is_empty() {
            return 0.0;
        }
        let middle = self.by_pixel.len() / 2;
        *self.by_pixel.select_nth_unstable_by(middle, f64::total_cmp).1
    }
}

/// One test made in many places, tallied by channel: the channels of a place share their paths, and so their luck.
#[derive(Default)]
struct Tests {
    tested: [usize; 3],
    beyond: [usize; 3],
    worst: Option<(f64, f64, [usize; 2])>,
}

impl Tests {
    fn add(&mut self, channel: usize, at: [usize; 2], outcome: Option<(f64, f64)>) {
        let Some((t, p)) = outcome else { return };
        self.tested[channel] += 1;
        self.beyond[channel] += usize::from(p < BOUND);
        if self
            .worst
            .is_none_or(|(worst_t, worst_p, _)| p < worst_p || p == worst_p && t.abs() > worst_t.abs())
        {
            self.worst = Some((t, p, at));
        }
    }

    fn finish(&self) -> Tally {
        let tested = self.tested.iter().sum();
        let Some((worst_t, p, worst_at)) = self.worst else {
            return Tally { p_worst: 1.0, p_count: 1.0, ..Tally::default() };
        };
        // 1 - (1 - p)^n, without losing a small p beside 1.
        let p_worst = if p < 1e-9 { p * tested as f64 } else { 1.0 - exp_d(tested as f64 * ln_d(1.0 - p)) };
        let chance = |k: usize| 3.0 * binomial_at_least(self.beyond[k], self.tested[k], BOUND);
        let p_count =
            [chance(0), chance(1), chance(2)].into_iter().fold(1.0, |m, v| if v < m { v } else { m });
        let p_worst = if p_worst < 1.0 { p_worst } else { 1.0 };
        Tally { tested, beyond: self.beyond.iter().sum(), worst_t, worst_at, p_worst, p_count }
    }
}

/// What tells the pictures apart.
fn reasons(comparison: &Comparison, tails: Tails) -> Vec<String> {
    let mut reasons = Vec::new();
    let Comparison { exact, pixels, blocks, .. } = comparison;
    if comparison.non_finite > 0 {
        reasons.push(format!("{} pixels are infinite or not a number", comparison.non_finite));
    }
    if exact.differing > 0 {
        reasons.push(format!(
            "{} of {} values without noise differ by more than {EXACT}, the worst by {:.3e}",
            exact.differing, exact.compared, exact.worst
        ));
    }
    for (name, z) in ["red", "green", "blue"].into_iter().zip(comparison.mean_z) {
        if z.abs() > MEAN_Z {
            reasons.push(format!(
                "the mean of {name} differs by {z:.1} standard errors (the bound is {MEAN_Z})"
            ));
        }
    }
    if tails == Tails::Heavy {
        let part = blocks.beyond as f64 / blocks.tested.max(1) as f64;
        if part > HEAVY_BEYOND && blocks.p_count < SMALL_PICTURE {
            reasons.push(format!(
                "{:.2} % of the blocks are beyond the 99 % bound (at most {} % may be)",
                100.0 * part,
                100.0 * HEAVY_BEYOND
            ));
        }
        return reasons;
    }
    for (what, tally) in [("pixel", pixels), ("block", blocks)] {
        let Tally { worst_t: t, worst_at: [x, y], p_worst, p_count, beyond, tested } = *tally;
        if p_worst < ALPHA {
            reasons.push(format!(
                "the {what} at {x}, {y} differs by {t:.1} standard errors (chance {p_worst:.1e})"
            ));
        }
        if p_count < ALPHA {
            let part = 100.0 * beyond as f64 / tested as f64;
            reasons.push(format!(
                "{part:.2} % of the {what} values are beyond the 99 % bound (chance {p_count:.1e})"
            ));
        }
    }
    reasons
}
