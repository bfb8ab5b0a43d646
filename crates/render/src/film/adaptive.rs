//! Which pixels need no further samples.
//!
//! Blocks of 8 x 8 pixels, aligned to the whole picture, are looked at when their pixels have 32, 48, 64, 96, 128, ...
//! samples. A rule that ends sampling by the very samples that it keeps prefers pictures that happen to look clean,
//! which are too dark: they have missed what is rare and bright. So every pixel's samples are dealt out to two halves, and each half
//! ends by what the other halves of the pixels around show, which knows nothing of its own luck (after Kirk and Arvo 1991, "Unbiased
//! Sampling Techniques for Image Synthesis"). A pixel's value is the mean of its two halves' means, whatever their numbers: weighed by
//! these, the darker half would count for more.
//!
//! Between one check and the next the first of the samples go to one half and the rest to the other. Each half is a sequence by itself, of other points ([`named_by`]),
//! so that it is well spread, and independent of the other.
//!
//! [`super::error_estimate`] tells how noisy a half of a pixel is, and [`super::district`] which need no further samples.

use super::control::Control;
use super::error_estimate::Batches;
use super::fixed::{Fixed, Square};
use super::{BandSample, Film, FilmTile, Pixel, TILE};
use crate::film::Region;

/// Side of a block in pixels.
pub const BLOCK: u32 = 8;

/// Blocks from one side of a tile to the other.
const ACROSS: u32 = TILE / BLOCK;

/// Radiance below which a block's noise is not measured against its own brightness but against this.
pub const DARK: f64 = 0.01;

/// The least number of samples after which blocks are looked at.
pub const FIRST_CHECK: u32 = 32;

/// The check after `samples` samples: the next of 32, 48, 64, 96, 128, ...
pub(crate) fn next_check(samples: u32) -> u32 {
    let mut check = FIRST_CHECK;
    while check <= samples {
        check += 1 << (check.ilog2() - 1);
    }
    check
}

/// How many samples lie between the checks before and after one of them: half as many as the greatest power of two that isn't above it.
fn step_from(index: u32) -> u32 {
    if index < FIRST_CHECK { FIRST_CHECK } else { 1 << (index.ilog2() - 1) }
}

/// Which of a pixel's two halves a sample belongs to.
pub(crate) fn half_of(index: u32) -> usize {
    (index & (step_from(index) >> 1) != 0).into()
}

/// Set in the column of what the second half's samples are named by: beyond any picture's columns, and among the 16 bits of it that follow a curve through all pixels.
const SECOND: u32 = 0x8000_8000;

/// By which pixel and index a sample's numbers are drawn. Each half is a sequence of its own: two parts of one sequence avoid one another, so that where the one shows
/// little noise for it happens to lie well, the other is the more likely to be too dark, or too bright.
#[inline]
pub(crate) fn named_by([x, y]: [u32; 2], index: u32) -> ([u32; 2], u32) {
    let step = step_from(index);
    let rank = (index & !(step - 1)) / 2 + (index & ((step >> 1) - 1));
    ([if half_of(index) == 0 { x } else { x ^ SECOND }, y], rank)
}

/// One past the index of the last of the first `count` samples of a half.
fn index_after(half: u32, count: u32) -> u32 {
    let (mut start, mut left) = (0, count);
    loop {
        let each = (next_check(start) - start) / 2;
        if left == 0 {
            return start;
        }
        if left <= each {
            return start + half * each + left;
        }
        left -= each;
        start += 2 * each;
    }
}

/// What a pixel keeps of its halves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Halves {
    /// Sums of the second half; those of the first are what the pixel has besides.
    pub(super) value: [Fixed; 3],
    pub(super) square: [Square; 3],
    pub(super) control: Control,
    pub(super) count: u32,
    /// Of each half, where noise is told by batches.
    pub(super) batches: [Batches; 2],
}

/// The sums of one half of a pixel.
struct Part {
    sums: Pixel,
    squares: [Square; 3],
    control: Option<Control>,
}

/// What a half of a pixel tells of a channel: its mean, and the variance of that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Told {
    pub(super) mean: f64,
    /// By how single samples scatter.
    pub(super) spread: f64,
    /// By two or three batches, and by all of them, five to eight; by spread where samples are independent.
    pub(super) few: f64,
    pub(super) all: f64,
}

impl FilmTile {
    /// Makes ready to be ended block by block.
    fn adapt(&mut self, by_batches: bool) {
        self.halves = vec![Halves::default(); self.pixels.len()];
        self.second_bands =
            [self.bands.len(), self.negative_bands.len()].map(|room| vec![Fixed::default(); room]);
        self.by_batches = by_batches;
    }

    /// Takes note of a half of pixel `k` before its next sample.
    pub(super) fn note_half(&mut self, k: usize, index: u32) {
        let half = half_of(index);
        let count = self.count_of_half(k, half);
        if self.by_batches && Batches::ends_at(count) {
            let part = self.half(k, half);
            let sums = self.sums_of(&part.sums, part.control.as_ref());
            self.halves[k].batches[half].end(count, sums);
        }
        self.halves[k].count += half as u32;
    }

    /// Adds a sample to its half of pixel `k`.
    pub(super) fn add_to_half(
        &mut self,
        k: usize,
        index: u32,
        (rgb, negative): ([f32; 3], bool),
        bands: &[BandSample],
    ) {
        if half_of(index) == 0 {
            return;
        }
        let [all, negative_bands] = &mut self.second_bands;
        let first = k * (all.len() / self.pixels.len());
        for b in bands {
            let i = first + usize::from(b.band);
            all[i].add(b.value);
            if let Some(sum) = negative_bands.get_mut(i).filter(|_| negative) {
                sum.add(b.value);
            }
        }
        let second = &mut self.halves[k];
        for (c, v) in rgb.into_iter().enumerate() {
            second.value[c].add(v);
            second.square[c].add(v);
        }
        if negative {
            second.control.add(rgb);
        }
    }

    /// The sums of one half of pixel `k`.
    fn half(&self, k: usize, half: usize) -> Part {
        let (all, second) = (&self.pixels[k], &self.halves[k]);
        let control = self.controls.get(k);
        if half == 1 {
            let sums = Pixel { value: second.value, count: second.count, dropped: 0 };
            return Part { sums, squares: second.square, control: control.map(|_| second.control) };
        }
        let sums = Pixel {
            value: std::array::from_fn(|c| all.value[c] - second.value[c]),
            count: all.count - second.count,
            dropped: 0,
        };
        // Without squares nobody asks for the spread.
        let squares = self.squares.get(k).copied().unwrap_or(second.square);
        let squares = std::array::from_fn(|c| squares[c] - second.square[c]);
        Part { sums, squares, control: control.map(|all| all.without(&second.control)) }
    }

    /// Samples of one half of pixel `k`.
    pub(super) fn count_of_half(&self, k: usize, half: usize) -> u32 {
        let second = self.halves[k].count;
        if half == 1 { second } else { self.pixels[k].count - second }
    }

    /// Mean and variance of the mean of a channel of one half of pixel `k`; the variance by batches or by spread.
    pub(super) fn mean_of_half(&self, k: usize, half: usize, channel: usize, by_batches: bool) -> (f64, f64) {
        let Told { mean, spread, few, .. } = self.told_by_half(k, half)[channel];
        (mean, if by_batches { few } else { spread })
    }

    /// What one half of pixel `k` tells of each channel.
    pub(super) fn told_by_half(&self, k: usize, half: usize) -> [Told; 3] {
        let Part { sums: p, squares, control } = self.half(k, half);
        let sums = self.sums_of(&p, control.as_ref());
        std::array::from_fn(|channel| {
            let mean = sums[channel] / f64::from(p.count.max(1));
            let spread = match &control {
                Some(control) => control.variance((&p, &squares), channel, self.weight),
                None => p.variance(&squares, channel),
            };
            let [few, all] = match self.by_batches {
                true => self.halves[k].batches[half].variances(p.count, sums[channel], channel),
                false => [spread; 2],
            };
            Told { mean, spread, few, all }
        })
    }

    /// The mean of both halves of pixel `k`, and the variance of that mean; `None` where there are no two halves.
    pub(super) fn mean_of_halves(&self, k: usize, channel: usize, by_batches: bool) -> Option<(f64, f64)> {
        let second = self.halves.get(k)?.count;
        if second == 0 || second == self.pixels[k].count {
            return None;
        }
        let [a, b] = [0, 1].map(|half| self.mean_of_half(k, half, channel, by_batches));
        Some((0.5 * (a.0 + b.0), 0.25 * (a.1 + b.1)))
    }

    /// The same of a band, which stands at place `i` of all.
    pub(super) fn band_mean_of_halves(&self, k: usize, i: usize) -> Option<f64> {
        let second = self.halves.get(k)?.count;
        if second == 0 || second == self.pixels[k].count {
            return None;
        }
        let [all, negative] = [
            [self.bands.get(i)?, self.second_bands[0].get(i)?],
            self.negative_bands.get(i).zip(self.second_bands[1].get(i)).map_or([&Fixed(0); 2], Into::into),
        ];
        let means = [0, 1].map(|half| {
            let Part { sums: p, control, .. } = self.half(k, half);
            let of = |[all, second]: [&Fixed; 2]| if half == 1 { *second } else { *all - *second };
            let sum = match &control {
                Some(control) => control.sum_of(&p, [of(all), of(negative)], self.weight),
                None => of(all).to_f64(),
            };
            sum / f64::from(p.count.max(1))
        });
        Some(0.5 * (means[0] + means[1]))
    }

    /// Whether the halves of pixel `k` have as many samples as one another, so that the pixel's own sums tell all.
    pub(super) fn is_even(&self, k: usize) -> bool {
        self.halves.get(k).is_none_or(|h| 2 * h.count == self.pixels[k].count)
    }
}

impl Film {
    /// Makes ready to be ended block by block, noise being told by batches or by spread; bands and controls, if any, are held before.
    pub(crate) fn adapt(&mut self, by_batches: bool) {
        self.tiles.iter_mut().for_each(|tile| tile.adapt(by_batches));
    }

    /// How many times as many pixels there are as still take samples, 1 to 1024.
    pub fn sparsity(&self) -> u32 {
        let all: usize = self.tiles.iter().map(|tile| tile.pixels.len()).sum();
        let open: usize = self.tiles.iter().map(FilmTile::open_pixels).sum();
        (all / open.max(1)).clamp(1, 1024) as u32
    }

    /// Takes no further samples of the blocks that are told by their first pixel.
    pub(crate) fn end_blocks(&mut self, is_done: impl Fn([u32; 2]) -> bool) {
        for tile in &mut self.tiles {
            let mut done = [None; (ACROSS * ACROSS) as usize];
            for pixel in tile.places() {
                if *done[block_of(pixel)].get_or_insert_with(|| is_done(pixel.map(|v| v / BLOCK * BLOCK))) {
                    tile.end_halves(pixel, 3);
                }
            }
        }
    }
}

/// Block of a tile, row by row, that a pixel belongs to.
fn block_of([x, y]: [u32; 2]) -> usize {
    ((y % TILE / BLOCK) * ACROSS + x % TILE / BLOCK) as usize
}

/// Place of a pixel in its tile, of 256.
fn place([x, y]: [u32; 2]) -> usize {
    (y % TILE * TILE + x % TILE) as usize
}

/// The samples of a tile that are still wanted: all but the halves of pixels whose bit is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sampled {
    ended: [[u64; (TILE * TILE / 64) as usize]; 2],
    /// Whether any bit is.
    any: bool,
}

impl Sampled {
    /// Whether a half of a pixel of the tile is.
    #[inline]
    fn has_half(&self, pixel: [u32; 2], half: usize) -> bool {
        let place = place(pixel);
        self.ended[half][place / 64] >> (place % 64) & 1 == 0
    }

    /// Whether a sample of a pixel of the tile is.
    #[inline]
    pub(crate) fn contains(&self, pixel: [u32; 2], index: u32) -> bool {
        !self.any || self.has_half(pixel, half_of(index))
    }

    /// Whether any sample of a pixel is.
    #[inline]
    pub(crate) fn is_open(&self, pixel: [u32; 2]) -> bool {
        !self.any || self.has_half(pixel, 0) || self.has_half(pixel, 1)
    }
}

impl FilmTile {
    /// The samples that are still wanted.
    pub(crate) fn sampled(&self) -> Sampled {
        self.sampled
    }

    /// Which halves of a pixel take no further samples: a bit for each.
    pub(super) fn ended(&self, pixel: [u32; 2]) -> u8 {
        [0, 1].map(|half| u8::from(!self.sampled.has_half(pixel, half)) << half).iter().sum()
    }

    /// Takes no further samples of these halves of a pixel: a bit for each.
    pub(super) fn end_halves(&mut self, pixel: [u32; 2], halves: u8) {
        let place = place(pixel);
        for (half, ended) in self.sampled.ended.iter_mut().enumerate() {
            ended[place / 64] |= u64::from(halves >> half & 1) << (place % 64);
        }
        self.sampled.any |= halves & 3 != 0;
    }

    /// Its pixels.
    fn places(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let Region { min, max } = self.region;
        (min[1]..max[1]).flat_map(move |y| (min[0]..max[0]).map(move |x| [x, y]))
    }

    /// Index of the next sample of what is open: it has all samples before, all of it.
    pub(crate) fn next_sample(&self) -> u32 {
        let Some(open) = self.places().find(|p| self.sampled.is_open(*p)) else { return self.first };
        let k = self.index(open);
        let count = self.pixels[k].count;
        match (self.ended(open), self.halves.get(k)) {
            (1, Some(second)) => index_after(1, second.count),
            (2, Some(second)) => index_after(0, count - second.count),
            _ => self.first + count,
        }
    }

    /// Whether there are any.
    pub(crate) fn is_open(&self) -> bool {
        !self.sampled.any || self.places().any(|p| self.sampled.is_open(p))
    }

    /// Pixels of which further samples are wanted.
    fn open_pixels(&self) -> usize {
        if self.sampled.any {
            self.places().filter(|p| self.sampled.is_open(*p)).count()
        } else {
            self.pixels.len()
        }
    }

    /// Blocks of which further samples are wanted.
    pub(crate) fn open_blocks(&self) -> u32 {
        let open = self.places().filter(|p| self.sampled.is_open(*p));
        open.fold(0_u32, |blocks, p| blocks | 1 << block_of(p)).count_ones()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_are_at_fixed_counts() {
        let mut checks = vec![next_check(0)];
        while checks.len() < 8 {
            checks.push(next_check(checks[checks.len() - 1]));
        }
        assert_eq!(checks, [32, 48, 64, 96, 128, 192, 256, 384]);
        assert_eq!(next_check(100), 128);
    }

    #[test]
    fn halves_are_as_large_at_every_look() {
        let (mut counts, mut check) = ([0, 0], next_check(0));
        for index in 0..4096 {
            if index == check {
                assert_eq!(counts[0], counts[1], "at {check}");
                check = next_check(check);
            }
            counts[half_of(index)] += 1;
        }
        for half in 0..2 {
            let mut taken = 0;
            for index in 0..2048 {
                if half_of(index) == half as usize {
                    taken += 1;
                    assert_eq!(index_after(half, taken), index + 1);
                }
            }
        }
        // Each half is a sequence by itself, from the start, and its own.
        let mut ranks = [0, 0];
        for index in 0..4096 {
            let half = half_of(index);
            assert_eq!(named_by([3, 5], index), ([[3, 0x8000_8003][half], 5], ranks[half]), "{index}");
            ranks[half] += 1;
        }
        assert!((0..16).all(|i| half_of(i) == 0) && (16..32).all(|i| half_of(i) == 1));
        assert!((32..40).all(|i| half_of(i) == 0) && (40..48).all(|i| half_of(i) == 1));
        assert!((96..112).all(|i| half_of(i) == 0) && (112..128).all(|i| half_of(i) == 1));
    }

    /// A block that is black but for a corner of one pixel: noise in a single pixel keeps the whole block going.
    #[test]
    fn one_noisy_pixel_is_seen_by_both_halves() {
        let mut film = Film::new([8, 8], Region::whole([8, 8]));
        film.adapt(false);
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1_u64 << 24) as f32
        };
        let (mut done, mut check) = (0, 0);
        while film.tiles[0].is_open() && done < 1 << 17 {
            check = next_check(check);
            let tile = &mut film.tiles[0];
            for index in done..check {
                for k in 0..64 {
                    let pixel = [k % 8, k / 8];
                    if tile.sampled().contains(pixel, index) {
                        let lit = pixel == [7, 7] && random() < 0.09;
                        let rgb = if lit { [1.0; 3] } else { [0.0; 3] };
                        tile.add(pixel, index, &super::super::Sample { rgb, ..Default::default() }, &[]);
                    }
                }
            }
            done = check;
            film.check(check, 0.02);
        }
        // The pixel's standard error over 64 pixels, over 0.01: 2 % with 32,000 samples.
        let tile = &film.tiles[0];
        let noise = (tile.variance_of_mean(63, 0) / 64.0).sqrt() / DARK;
        assert!(!tile.is_open() && noise < 1.3 * 0.02 && noise > 0.7 * 0.02, "{noise} after {done}");
        let mean = tile.mean(63, 0);
        assert!((mean - 0.09).abs() < 0.01, "{mean}");
    }
}
