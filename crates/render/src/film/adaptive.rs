//! Which pixels need no further samples.
//!
//! Blocks of 8 x 8 pixels, aligned to the whole picture, are looked at when their pixels have 32, 48, 64, 96, 128, ...
//! samples. A rule that ends sampling by the very samples that it keeps prefers pictures that happen to look clean,
//! which are too dark: they have missed what is rare and bright. So a block's pixels are dealt out like the fields of
//! a chessboard, and each half ends by what the other half shows, which knows nothing of its own luck (after Kirk and
//! Arvo 1991, "Unbiased Sampling Techniques for Image Synthesis").
//!
//! How noisy a pixel is, independent samples tell by their spread. Points that avoid one another leave less noise than
//! that: there the samples are taken in two or three batches, in order, of as many as the largest power of two allows. Each
//! batch is well spread by itself, so that batch means differ by as much as pictures of so many samples do. Their union is
//! more even still, and batches avoid one another: the mean is better than the differences tell, never worse. A pixel tells
//! little by three numbers, but the half of a block that is judged as one has up to 32 of them.

use super::fixed::Value;
use super::{FilmTile, Pixel, TILE};
use crate::settings::Region;

/// Side of a block in pixels.
pub const BLOCK: u32 = 8;

/// Blocks from one side of a tile to the other.
const ACROSS: u32 = TILE / BLOCK;

/// Radiance below which a block's noise is not measured against its own brightness but against this.
pub const DARK: f64 = 0.01;

/// The least number of samples after which blocks are looked at.
const FIRST_LOOK: u32 = 32;

/// The look after `samples` samples: the next of 32, 48, 64, 96, 128, ...; before them all 16, when the first batch is full.
pub(crate) fn next_look(samples: u32) -> u32 {
    let mut look = FIRST_LOOK / 2;
    while look <= samples {
        look += if look < FIRST_LOOK { look } else { 1 << (look.ilog2() - 1) };
    }
    look
}

/// By what a pixel's noise is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Evidence {
    /// By how samples scatter: they are independent.
    Spread,
    /// By how the means of batches do.
    Batches,
}

/// Sums of a pixel when it had one batch's samples, and two.
pub(super) type Marks = [[Value; 3]; 2];

/// The variance of a pixel's mean by the means of its batches.
fn variance_by_batches(p: &Pixel, marks: &Marks, channel: usize) -> f64 {
    let [one, two] = marks.map(|m| m[channel].to_f64());
    let all = p.value[channel].to_f64();
    // Of a power of two, two halves; of one and a half times that, three thirds.
    if p.count.is_power_of_two() {
        let size = f64::from(p.count / 2);
        let difference = (all - one - one) / size;
        return 0.25 * difference * difference;
    }
    let size = f64::from(p.count / 3);
    let mean = all / (3.0 * size);
    let squares: f64 = { [one, two - one, all - two] }
        .iter()
        .map(|sum| {
            let off = sum / size - mean;
            off * off
        })
        .sum();
    squares / 6.0
}

/// What one half of a block shows.
#[derive(Clone, Copy, Debug, Default)]
struct Half {
    pixels: u32,
    /// Samples of each.
    samples: u32,
    variance: f64,
    brightness: f64,
}

impl Half {
    /// Adds a pixel, whose marks there are where noise is told by batches.
    fn add(&mut self, p: &Pixel, marks: Option<&Marks>) {
        self.pixels += 1;
        self.samples = p.count;
        for c in 0..3 {
            let (mean, spread) = p.mean_and_variance(c);
            self.variance += marks.map_or(spread, |marks| variance_by_batches(p, marks, c));
            self.brightness += mean.abs();
        }
    }

    /// The root mean square of the values' standard errors over their mean brightness, as it is to be expected with
    /// `samples` samples.
    fn noise(&self, samples: u32) -> f64 {
        let values = 3.0 * f64::from(self.pixels);
        let brightness = self.brightness / values;
        let variance = self.variance / values * f64::from(self.samples) / f64::from(samples);
        variance.sqrt() / if brightness > DARK { brightness } else { DARK }
    }
}

/// Block of a tile (row by row), and half of that block, that a pixel belongs to.
fn place([x, y]: [u32; 2]) -> (usize, usize) {
    let block = (y % TILE / BLOCK) * ACROSS + x % TILE / BLOCK;
    (block as usize, ((x + y) % 2) as usize)
}

/// The pixels of a tile that need further samples: all but the halves of blocks whose bit is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sampled {
    ended: u8,
}

impl Sampled {
    /// Whether a pixel of the tile does.
    #[inline]
    pub(crate) fn contains(self, pixel: [u32; 2]) -> bool {
        let (block, half) = place(pixel);
        self.ended >> (2 * block + half) & 1 == 0
    }
}

impl FilmTile {
    /// The pixels that need further samples.
    pub(crate) fn sampled(&self) -> Sampled {
        self.sampled
    }

    /// Whether there are any.
    pub(crate) fn is_open(&self) -> bool {
        let Region { min, max } = self.region;
        let mut pixels = (min[1]..max[1]).flat_map(|y| (min[0]..max[0]).map(move |x| [x, y]));
        pixels.any(|p| self.sampled.contains(p))
    }

    /// Blocks that still have pixels which need further samples.
    pub(crate) fn open_blocks(&self) -> u32 {
        let Region { min, max } = self.region;
        let pixels = (min[1]..max[1]).flat_map(|y| (min[0]..max[0]).map(move |x| [x, y]));
        let open = pixels.filter(|p| self.sampled.contains(*p));
        open.fold(0_u32, |blocks, p| blocks | 1 << place(p).0).count_ones()
    }

    /// Makes ready to tell noise by batches.
    pub(crate) fn mark_batches(&mut self) {
        self.marks = vec![Marks::default(); self.pixels.len()];
    }

    /// Ends the halves whose counterparts' noise is at most `target`, those that go on having `samples` samples.
    pub(crate) fn look(&mut self, samples: u32, target: f64) {
        if samples >= FIRST_LOOK {
            self.end_halves(samples, target);
        }
        self.mark(samples);
    }

    /// Notes the sums that the next looks need as those of their first or second batch. Pixels that have ended keep what
    /// they were judged by.
    fn mark(&mut self, samples: u32) {
        let width = self.region.width() as usize;
        for (k, (marks, p)) in self.marks.iter_mut().zip(&self.pixels).enumerate() {
            let pixel = [self.region.min[0] + (k % width) as u32, self.region.min[1] + (k / width) as u32];
            if !self.sampled.contains(pixel) {
                continue;
            }
            if samples < FIRST_LOOK {
                marks[0] = p.value;
            } else if samples.is_power_of_two() {
                marks[1] = p.value;
            } else {
                marks[0] = marks[1];
            }
        }
    }

    fn end_halves(&mut self, samples: u32, target: f64) {
        let mut blocks = [[Half::default(); 2]; (ACROSS * ACROSS) as usize];
        let width = self.region.width() as usize;
        for (k, p) in self.pixels.iter().enumerate() {
            let pixel = [self.region.min[0] + (k % width) as u32, self.region.min[1] + (k / width) as u32];
            let (block, half) = place(pixel);
            blocks[block][half].add(p, self.marks.get(k));
        }
        for (block, halves) in blocks.iter().enumerate() {
            for half in 0..2 {
                // A block of one pixel, in the corner of a picture, has no other half.
                let other = if halves[1 - half].pixels > 0 { &halves[1 - half] } else { &halves[half] };
                if other.pixels > 0 && other.noise(samples) <= target {
                    self.sampled.ended |= 1 << (2 * block + half);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_are_at_fixed_counts() {
        let mut looks = vec![next_look(0)];
        while looks.len() < 8 {
            looks.push(next_look(looks[looks.len() - 1]));
        }
        assert_eq!(looks, [16, 32, 48, 64, 96, 128, 192, 256]);
        assert_eq!(next_look(100), 128);
    }

    /// Of independent samples, batches tell what the spread tells, with more chance in it.
    #[test]
    fn batches_tell_the_variance_of_the_mean() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1_u64 << 24) as f32
        };
        let (mut sums, n) = ([0.0; 6], 4000);
        for _ in 0..n {
            let mut tile = FilmTile::new(Region { min: [0, 0], max: [1, 1] });
            tile.mark_batches();
            let mut taken = 0;
            for (sum, look) in sums.iter_mut().zip([0, 32, 48, 64, 96, 128]) {
                let stop = if look == 0 { 16 } else { look };
                while taken < stop {
                    let sample = super::super::Sample { rgb: [random(); 3], ..Default::default() };
                    tile.add([0, 0], taken, &sample, &[]);
                    taken += 1;
                }
                if look > 0 {
                    *sum += variance_by_batches(&tile.pixels[0], &tile.marks[0], 0) * f64::from(look);
                }
                tile.look(stop, 0.0);
            }
        }
        // The variance of numbers from 0 to 1 is 1/12.
        for sum in &sums[1..] {
            let variance = sum / f64::from(n);
            assert!((variance * 12.0 - 1.0).abs() < 0.08, "{variance}");
        }
    }

    #[test]
    fn halves_are_fields_of_one_colour() {
        for y in 0..16 {
            for x in 0..16 {
                let (block, half) = place([32 + x, 16 + y]);
                assert_eq!(block as u32, y / 8 * 2 + x / 8);
                assert_ne!(half, place([32 + (x ^ 1), 16 + y]).1);
                assert_ne!(half, place([32 + x, 16 + (y ^ 1)]).1);
            }
        }
    }
}
