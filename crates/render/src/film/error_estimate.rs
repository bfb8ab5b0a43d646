//! By what the noise of a pixel's mean is told.
//!
//! Independent samples tell the variance of their mean by how they scatter. Points that avoid one another leave less noise
//! than that: there the samples are taken in two or three batches, in order, all but the last of as many as a power of two. Each
//! batch is well spread by itself, so that batch means differ by as much as pictures of so many samples do. Their union is
//! more even still, and batches avoid one another: the mean is better than the differences tell, never worse. What two or
//! three numbers tell of a single pixel has as much chance in it as they have: one or two degrees of freedom.

use super::fixed::Fixed;
use straal_math::lowdisc::PatternKind;

/// By what a pixel's noise is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorEstimate {
    /// By how samples scatter: they are independent.
    Spread,
    /// By how the means of batches do.
    Batches,
    /// By how whole pictures of independent seeds do.
    Replicates,
}

impl ErrorEstimate {
    /// What suits a pattern. Sets of a known number are shuffled, but for Sobol's: part of one is as good as independent
    /// samples, so that batches of it would tell no more than the spread does, and that by fewer numbers.
    pub const fn of(pattern: PatternKind) -> Self {
        match pattern {
            PatternKind::Sobol | PatternKind::BlueSobol | PatternKind::Halton => Self::Batches,
            PatternKind::Hammersley
            | PatternKind::MultiJittered
            | PatternKind::NRooks
            | PatternKind::Jittered
            | PatternKind::Regular
            | PatternKind::Random => Self::Spread,
        }
    }

    /// The name in a picture's story.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Spread => "spread",
            Self::Batches => "batches",
            Self::Replicates => "replicates",
        }
    }
}

/// The sums that batches end with: those of a pixel when it had h / 2 samples and h, h being the largest power of two below
/// the number that it has. In double precision: integers so large are rounded, always alike. Exact, as [`Fixed`], where
/// the sums of earlier samples are added later.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BatchSums<T = f64>(pub(super) [[T; 3]; 2]);

impl<T: Copy + From<Fixed>> BatchSums<T> {
    /// Takes note of a pixel's sums before the sample `index` is added; its samples come in order.
    #[inline]
    pub(super) fn note(&mut self, index: u32, sums: &[Fixed; 3]) {
        if index.is_power_of_two() {
            self.0 = [self.0[1], sums.map(T::from)];
        }
    }
}

impl BatchSums {
    /// Goes on with what was noted of later samples, without the sums `before` them; how often there was something to note.
    pub(super) fn follow(&mut self, before: &[Fixed; 3], later: &BatchSums<Fixed>, notes: usize) {
        let all = |part: &[Fixed; 3]| -> [f64; 3] {
            std::array::from_fn(|c| Fixed(before[c].0.wrapping_add(part[c].0)).to_f64())
        };
        match notes {
            0 => {}
            1 => self.0 = [self.0[1], all(&later.0[1])],
            _ => self.0 = [all(&later.0[0]), all(&later.0[1])],
        }
    }

    /// The variance of a channel's mean, of `count` samples that sum to `sum`, by the means of batches; 0 for a single sample.
    pub(super) fn variance(&self, count: u32, sum: f64, channel: usize) -> f64 {
        let [at_half, at_whole] = self.0.map(|sums| sums[channel]);
        let whole = count.next_power_of_two() / 2;
        if whole == 0 {
            return 0.0;
        }
        let (half, whole) = ((whole / 2, at_half), (whole, at_whole));
        let end = (count, sum);
        // The last batch, of all that is left, has as many samples as the first, or more.
        if count == 2 * whole.0 {
            variance_of_batches([whole, end])
        } else if count < whole.0 + half.0 {
            variance_of_batches([half, end])
        } else {
            variance_of_batches([half, whole, end])
        }
    }
}

/// The most batches that are kept of a half, but for the last.
const KEPT: usize = 7;

/// The sums of a half's batches, where blocks end by themselves: of samples beyond a power of two and up to the next, 2 h, batches of h / 4 each, five
/// to eight of them. In single precision, since they are told from one another by chance alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Batches(pub(super) [[f32; 3]; KEPT]);

impl Batches {
    /// Samples of a batch when there are `count`.
    const fn size(count: u32) -> u32 {
        let whole = count.next_power_of_two() / 2;
        if whole < 4 { 1 } else { whole / 4 }
    }

    /// Whether a batch ends with `count` samples.
    #[inline]
    pub(super) const fn ends_at(count: u32) -> bool {
        count > 0 && count & (Self::size(count) - 1) == 0
    }

    /// Takes note of a batch that ends with `count` samples, which sum to `sums`.
    pub(super) fn end(&mut self, count: u32, sums: [f64; 3]) {
        let number = (count / Self::size(count)) as usize - 1;
        let last = std::array::from_fn(|c| (sums[c] - self.first(number, c)) as f32);
        if let Some(batch) = self.0.get_mut(number) {
            *batch = last;
            return;
        }
        // Eight of them become four of twice the size.
        let of = |i: usize| self.0.get(i).copied().unwrap_or(last);
        let mut joined = [[0.0; 3]; KEPT];
        for (i, batch) in joined.iter_mut().enumerate().take(4) {
            let (a, b) = (of(2 * i), of(2 * i + 1));
            *batch = std::array::from_fn(|c| a[c] + b[c]);
        }
        self.0 = joined;
    }

    /// The sum of a channel over the first so many batches.
    fn first(&self, batches: usize, channel: usize) -> f64 {
        self.0.iter().take(batches).map(|sums| f64::from(sums[channel])).sum()
    }

    /// The variance of a channel's mean, of `count` samples that sum to `sum`: by two or three batches, and by all there are.
    pub(super) fn variances(&self, count: u32, sum: f64, channel: usize) -> [f64; 2] {
        let (size, whole) = (Self::size(count), count.next_power_of_two() / 2);
        if whole == 0 {
            return [0.0; 2];
        }
        let kept = ((count - 1) / size) as usize;
        let mean = sum / f64::from(count);
        let (mut at_half, mut at_whole, mut before, mut squares) = (0.0, 0.0, 0.0, 0.0);
        for (batch, number) in self.0.iter().zip(1_u32..).take(kept) {
            let (batch, at) = (f64::from(batch[channel]), number * size);
            before += batch;
            let off = batch - f64::from(size) * mean;
            squares += off * off;
            if at == whole / 2 {
                at_half = before;
            }
            if at == whole {
                at_whole = before;
            }
        }
        let few = BatchSums([[at_half; 3], [at_whole; 3]]).variance(count, sum, channel);
        // The last batch may be smaller; it weighs by its size.
        let last = f64::from(count - kept as u32 * size);
        let off = sum - before - last * mean;
        let squares = squares / f64::from(size) + off * off / last;
        [few, squares / (f64::from(count) * kept as f64)]
    }
}

/// The variance of the mean of batches that end at some numbers of samples with some sums, if each one's mean has a
/// variance in inverse proportion to its size.
fn variance_of_batches<const K: usize>(ends: [(u32, f64); K]) -> f64 {
    let (count, all) = ends[K - 1];
    let mean = all / f64::from(count);
    let (mut before, mut squares) = ((0, 0.0), 0.0);
    for (at, sum) in ends {
        let size = f64::from(at - before.0);
        let off = (sum - before.1) / size - mean;
        squares += size * off * off;
        before = (at, sum);
    }
    squares / (f64::from(count) * (K - 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::super::{FilmTile, Keep, Sample};
    use super::Batches;
    use crate::film::Region;

    /// The variances that the samples of one pixel tell in batches, by number of samples.
    fn told(samples: impl Iterator<Item = f32>) -> Vec<f64> {
        let mut tile = FilmTile::new(Region { min: [0, 0], max: [1, 1] }, Keep::ALL);
        tile.mark_batches();
        let mut told = Vec::new();
        for (i, v) in samples.enumerate() {
            tile.add([0, 0], i as u32, &Sample { rgb: [v; 3], ..Sample::default() }, &[]);
            told.push(tile.variance_of_mean(0, 1));
        }
        told
    }

    #[test]
    fn batches_are_halves_or_thirds_as_near_as_can_be() {
        let v = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
        let got = told(v.into_iter());
        let mean = |range: std::ops::Range<usize>| v[range.clone()].iter().sum::<f32>() / range.len() as f32;
        // Two equal batches: a quarter of the squared difference.
        let square = |v: f32| f64::from(v * v);
        let halves = |n: usize| 0.25 * square(mean(0..n / 2) - mean(n / 2..n));
        let unequal = square(mean(0..2) - mean(2..5)) * 6.0 / 25.0;
        let thirds: f64 =
            [0..2, 2..4, 4..6].into_iter().map(|r| square(mean(r) - mean(0..6))).sum::<f64>() / 6.0;
        for (n, want) in [(1, 0.0), (2, halves(2)), (4, halves(4)), (5, unequal), (6, thirds), (8, halves(8))]
        {
            assert!((got[n - 1] - want).abs() < 1e-6, "{n}: {}, not {want}", got[n - 1]);
        }
    }

    /// Of independent samples, batches tell what the spread tells, with more chance in it.
    #[test]
    fn batches_tell_the_variance_of_the_mean() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1_u64 << 24) as f32
        };
        let (mut sums, n) = (vec![0.0; 128], 4000);
        for _ in 0..n {
            for (sum, told) in sums.iter_mut().zip(told(std::iter::repeat_with(&mut random).take(128))) {
                *sum += told;
            }
        }
        assert_eq!(sums[0], 0.0);
        for (i, sum) in sums.iter().enumerate().skip(1) {
            // The variance of numbers from 0 to 1 is 1/12.
            let variance = sum / f64::from(n) * (i + 1) as f64 * 12.0;
            assert!((variance - 1.0).abs() < 0.1, "{} samples: {variance} of the variance", i + 1);
        }
    }

    #[test]
    fn what_is_even_has_no_variance() {
        assert!(told(std::iter::repeat_n(0.1, 300)).iter().all(|v| *v == 0.0));
    }

    /// The variances that a half tells by few of its batches and by all of them, by number of samples.
    fn told_by_half(samples: impl Iterator<Item = f32>) -> Vec<[f64; 2]> {
        let (mut batches, mut sum) = (Batches::default(), 0.0);
        let mut told = Vec::new();
        for (count, v) in (0..).zip(samples) {
            if Batches::ends_at(count) {
                batches.end(count, [0.0, sum, 0.0]);
            }
            sum += f64::from(v);
            told.push(batches.variances(count + 1, sum, 1));
        }
        told
    }

    /// Few batches of a half are those of a pixel; all are as many as can be, of a size.
    #[test]
    fn halves_have_more_batches() {
        let v: Vec<f32> = (0..100_u32).map(|i| (i * 37 % 101) as f32 * 0.1).collect();
        let (few, got) = (told(v.iter().copied()), told_by_half(v.iter().copied()));
        assert_eq!(got[0], [0.0; 2]);
        for (n, got) in (1..).zip(&got) {
            let few = few[n - 1];
            // Sums in single precision are off by a part of 2^-24.
            assert!((got[0] - few).abs() <= 1e-4 * few + 1e-8, "{n}: {}, not {few}", got[0]);
        }
        for (n, size) in
            [(4, 1), (8, 1), (10, 2), (12, 2), (16, 2), (20, 4), (31, 4), (32, 4), (48, 8), (64, 8), (96, 16)]
        {
            // Each batch weighs by its size; the last may be smaller.
            let sum_of = |part: &[f32]| part.iter().map(|v| f64::from(*v)).sum::<f64>();
            let (all, n) = (&v[..n], n as f64);
            let squares: f64 = all
                .chunks(size)
                .map(|batch| {
                    let off = sum_of(batch) / batch.len() as f64 - sum_of(all) / n;
                    batch.len() as f64 * off * off
                })
                .sum();
            let want = squares / (n * (all.chunks(size).count() - 1) as f64);
            let got = got[all.len() - 1][1];
            assert!((got - want).abs() <= 1e-4 * want + 1e-8, "{n}: {got}, not {want}");
        }
    }

    /// Of independent samples all batches tell the variance, and far more surely than few.
    #[test]
    fn more_batches_are_surer() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1_u64 << 24) as f32
        };
        for (n, surer) in [(64, 5.0), (96, 2.0)] {
            let (mut sums, mut squares) = ([0.0; 2], [0.0; 2]);
            for _ in 0..4000 {
                let told = told_by_half(std::iter::repeat_with(&mut random).take(n));
                for k in 0..2 {
                    // The variance of numbers from 0 to 1 is 1/12.
                    let told = told[n - 1][k] * n as f64 * 12.0;
                    (sums[k], squares[k]) = (sums[k] + told / 4000.0, squares[k] + told * told / 4000.0);
                }
            }
            let spread = [0, 1].map(|k| squares[k] - sums[k] * sums[k]);
            assert!(sums.iter().all(|v| (v - 1.0).abs() < 0.08), "{n}: {sums:?}");
            assert!(spread[0] > surer * spread[1], "{n}: {spread:?}");
        }
    }
}
