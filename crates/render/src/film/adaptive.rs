//! Which pixels need no further samples.
//!
//! Blocks of 8 x 8 pixels, aligned to the whole picture, are looked at when their pixels have 32, 48, 64, 96, 128, ...
//! samples. A rule that ends sampling by the very samples that it keeps prefers pictures that happen to look clean,
//! which are too dark: they have missed what is rare and bright. So a block's pixels are dealt out like the fields of
//! a chessboard, and each half ends by what the other half shows, which knows nothing of its own luck (after Kirk and
//! Arvo 1991, "Unbiased Sampling Techniques for Image Synthesis").
//!
//! [`super::evidence`] tells how noisy a pixel is. A pixel by itself tells little by two or three batches, but the half of a
//! block that is judged as one has up to 32 of them.

use super::{FilmTile, TILE};
use crate::settings::Region;

/// Side of a block in pixels.
pub const BLOCK: u32 = 8;

/// Blocks from one side of a tile to the other.
const ACROSS: u32 = TILE / BLOCK;

/// Radiance below which a block's noise is not measured against its own brightness but against this.
pub const DARK: f64 = 0.01;

/// The least number of samples after which blocks are looked at.
pub const FIRST_LOOK: u32 = 32;

/// The look after `samples` samples: the next of 32, 48, 64, 96, 128, ...
pub(crate) fn next_look(samples: u32) -> u32 {
    let mut look = FIRST_LOOK;
    while look <= samples {
        look += 1 << (look.ilog2() - 1);
    }
    look
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
    /// Adds pixel `k` of a tile.
    fn add(&mut self, tile: &FilmTile, k: usize) {
        self.pixels += 1;
        self.samples = tile.pixels[k].count;
        for c in 0..3 {
            self.variance += tile.variance_of_mean(k, c);
            self.brightness += tile.pixels[k].mean(c).abs();
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

    /// Takes no further samples of the half of a block that a pixel belongs to.
    pub(super) fn end_half_of(&mut self, pixel: [u32; 2]) {
        let (block, half) = place(pixel);
        self.sampled.ended |= 1 << (2 * block + half);
    }

    /// Index of the next sample of those pixels: they have as many, all of them.
    pub(crate) fn next_sample(&self) -> u32 {
        let Region { min, max } = self.region;
        let mut pixels = (min[1]..max[1]).flat_map(|y| (min[0]..max[0]).map(move |x| [x, y]));
        let open = pixels.find(|p| self.sampled.contains(*p));
        self.first + open.map_or(0, |p| self.pixels[self.index(p)].count)
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

    /// Ends the halves whose counterparts' noise is at most `target`, those that go on having `samples` samples.
    pub(crate) fn look(&mut self, samples: u32, target: f64) {
        let mut blocks = [[Half::default(); 2]; (ACROSS * ACROSS) as usize];
        let width = self.region.width() as usize;
        for k in 0..self.pixels.len() {
            let pixel = [self.region.min[0] + (k % width) as u32, self.region.min[1] + (k / width) as u32];
            let (block, half) = place(pixel);
            blocks[block][half].add(self, k);
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
        assert_eq!(looks, [32, 48, 64, 96, 128, 192, 256, 384]);
        assert_eq!(next_look(100), 128);
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
