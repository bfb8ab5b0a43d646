//! How noisy a block is, by what it shows and what is around it.
//!
//! A few samples tell the noise of a block only as far as they have met what makes it. A pixel in which a lamp's edge covers one part in a hundred is black
//! in most of its first samples, and light that comes by one path in a million in nearly all. What a block alone shows of these is nothing, or very much; either is
//! wrong. But its surroundings have more pixels, and some of these have met it. So a block's variance is drawn towards that of the square of four blocks that it lies in,
//! this towards that of the square of sixteen, and so on up to a district of 64 x 64 pixels:
//!
//! V' = (m V + c V'(around)) / (m + c),
//!
//! where m is by how many events V is known (shrinkage, as in empirical Bayes; Efron and Morris 1975, "Data Analysis Using Stein's Estimator and its Generalizations"). Events of a
//! pixel with mean μ and variance per sample v of n samples: n μ² / v, which is the number of bright samples where the others are
//! black, between 1 and n. Those of several pixels: (Σ v)² / Σ (v² / events), which is their sum where they are alike, and those of the
//! noisiest where one stands out. A square that has met nothing counts as many as its part of those around would have. So even light is judged by itself, after a few samples already, and what is rare by all that
//! has met it. What m events tell may be off by a part of sqrt(2 / (m + c)), by which a block's variance counts for more.
//!
//! Noise is the root mean square of the values' standard errors over the block's mean brightness, or over each pixel's own, where that is more: a dark wall beside a
//! lamp counts as well.
//!
//! A block ends with as many samples n as its noise needs; or more, where its district needs far more: equal noise everywhere isn't the least for so
//! many samples. The mean square error of a picture, Σ v / n, is least for samples in proportion to the root of v (Neyman 1934, "On the Two
//! Different Aspects of the Representative Method"). So a block has at least as many as the geometric mean of what it needs and what its district does on average, up
//! to sixteen times its own need.
//!
//! Districts are aligned to the whole picture, and a crop is rendered in whole ones, so that it ends where the picture does.

use super::adaptive::{ACROSS, block_of};
use super::{BLOCK, DARK, Film, FilmTile, Region, TILE};
use rayon::prelude::*;

/// Side of a district in pixels.
pub const DISTRICT: u32 = 64;

/// Blocks from one side of a district to the other.
const SIDE: usize = (DISTRICT / BLOCK) as usize;

/// The events that what lies around counts for.
const AROUND: f64 = 0.3;

/// At most so many times the samples that it needs by itself a block has for its district.
const MOST: f64 = 16.0;

/// Brightness that is added, by squares, to that of a pixel by itself, whose mean is noise as well.
const DIM: f64 = 0.1;

/// What one half of the pixels' samples show, summed over a square.
#[derive(Clone, Copy, Debug, Default)]
struct Shown {
    pixels: f64,
    /// Of single samples.
    variance: f64,
    /// Squares of variances over the events that these are known by.
    doubt: f64,
    /// Variances over the squares of their own pixels' brightness.
    relative: f64,
    brightness: f64,
}

impl Shown {
    /// Adds a half of pixel `k` of a tile.
    fn add(&mut self, tile: &FilmTile, k: usize, half: usize) {
        let (mut mean, mut variance) = (0.0, 0.0);
        for c in 0..3 {
            let (m, v) = tile.mean_of_half(k, half, c, tile.by_batches);
            mean += m.abs() / 3.0;
            variance += v / 3.0;
        }
        let count = f64::from(tile.count_of_half(k, half).max(1));
        let variance = variance * count;
        self.pixels += 1.0;
        self.brightness += mean;
        if variance > 0.0 {
            let events = count * mean * mean / variance;
            let events = if events < count { events } else { count };
            let events = if events > 1.0 { events } else { 1.0 };
            self.variance += variance;
            self.doubt += variance * variance / events;
            self.relative += variance / (mean * mean + DIM * DIM);
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            pixels: self.pixels + other.pixels,
            variance: self.variance + other.variance,
            doubt: self.doubt + other.doubt,
            relative: self.relative + other.relative,
            brightness: self.brightness + other.brightness,
        }
    }

    /// By how many events the variance is known.
    fn events(&self) -> f64 {
        if self.doubt > 0.0 { self.variance * self.variance / self.doubt } else { 0.0 }
    }

    fn mean_variance(&self) -> f64 {
        self.variance / if self.pixels > 0.0 { self.pixels } else { 1.0 }
    }
}

/// The blocks of a district, row by row.
type Blocks<T> = [T; SIDE * SIDE];

/// The variance of single samples in each block, drawn towards what is around, and by how many events it is known.
fn drawn_together(blocks: &Blocks<Shown>) -> Blocks<(f64, f64)> {
    // Squares of 2^level blocks a side.
    let square = |level: usize, [x, y]: [usize; 2]| {
        let side = 1 << level;
        let places = (0..side * side).map(|i| (y * side + i / side) * SIDE + x * side + i % side);
        places.fold(Shown::default(), |sum, place| sum.plus(blocks[place]))
    };
    let top = SIDE.ilog2() as usize;
    let whole = square(top, [0, 0]);
    let mut around = [(whole, (whole.mean_variance(), whole.events())); SIDE * SIDE];
    for level in (0..top).rev() {
        let across = SIDE >> level;
        let mut within = around;
        for (i, within) in within.iter_mut().enumerate().take(across * across) {
            let at = [i % across, i / across];
            let (outer, (its, _)) = around[at[1] / 2 * (across / 2) + at[0] / 2];
            let own = square(level, at);
            let part = outer.events() * own.pixels / if outer.pixels > 0.0 { outer.pixels } else { 1.0 };
            let events = if own.events() > part { own.events() } else { part };
            let known = events + AROUND;
            *within = (own, ((events * own.mean_variance() + AROUND * its) / known, known));
        }
        around = within;
    }
    around.map(|(_, known)| known)
}

/// How many samples each block needs for a noise of 1.
fn needs(blocks: &Blocks<Shown>) -> Blocks<f64> {
    let known = drawn_together(blocks);
    let own: Blocks<f64> = std::array::from_fn(|i| {
        let Shown { pixels, variance: own, relative, brightness, .. } = blocks[i];
        if pixels == 0.0 {
            return 0.0;
        }
        let brightness = brightness / pixels;
        let bright = if brightness > DARK { brightness } else { DARK };
        let by_block = 1.0 / (bright * bright);
        let by_pixels = if own > 0.0 { relative / own } else { 0.0 };
        let (variance, events) = known[i];
        variance * (1.0 + (2.0 / events).sqrt()) * if by_pixels > by_block { by_pixels } else { by_block }
    });
    let pixels: f64 = blocks.iter().map(|b| b.pixels).sum();
    let all: f64 = own.iter().zip(blocks).map(|(need, b)| need * b.pixels).sum();
    let mean = all / if pixels > 0.0 { pixels } else { 1.0 };
    own.map(|need| {
        let shared = (need * mean).sqrt();
        let most = MOST * need;
        let shared = if shared < most { shared } else { most };
        if shared > need { shared } else { need }
    })
}

/// Place of a tile's block, of [`block_of`], in its district.
fn place(region: Region, block: usize) -> usize {
    let corner = region.min.map(|v| (v / TILE * TILE % DISTRICT / BLOCK) as usize);
    let across = ACROSS as usize;
    (corner[1] + block / across) * SIDE + corner[0] + block % across
}

impl Film {
    /// Ends the halves of blocks whose counterparts' noise is at most `target`, those that go on having `samples` samples with them.
    pub(crate) fn check(&mut self, samples: u32, target: f64) {
        let region = self.region().in_squares(DISTRICT, [u32::MAX; 2]);
        let across = (region.width() / DISTRICT) as usize;
        let district = |tile: &FilmTile| {
            let [x, y] = [0, 1].map(|a| ((tile.region.min[a] - region.min[a]) / DISTRICT) as usize);
            y * across + x
        };
        let mut districts = vec![Vec::new(); across * (region.height() / DISTRICT) as usize];
        for (i, tile) in self.tiles.iter().enumerate() {
            districts[district(tile)].push(i);
        }
        let tiles = &self.tiles;
        let look = |members: &Vec<usize>| {
            if !members.iter().any(|i| tiles[*i].is_open()) {
                return None;
            }
            let mut halves = [[Shown::default(); SIDE * SIDE]; 2];
            for tile in members.iter().map(|i| &tiles[*i]) {
                let width = tile.region.width() as usize;
                for k in 0..tile.pixels.len() {
                    let min = tile.region.min;
                    let pixel = [min[0] + (k % width) as u32, min[1] + (k / width) as u32];
                    let block = place(tile.region, block_of(pixel));
                    for (half, blocks) in halves.iter_mut().enumerate() {
                        blocks[block].add(tile, k, half);
                    }
                }
            }
            let enough = |need: f64| need <= target * target * f64::from(samples);
            Some(halves.map(|blocks| needs(&blocks).map(enough)))
        };
        let looked: Vec<Option<[Blocks<bool>; 2]>> = districts.par_iter().map(look).collect();
        for (members, halves) in districts.iter().zip(looked) {
            let Some([first, second]) = halves else { continue };
            for i in members {
                let tile = &mut self.tiles[*i];
                for block in 0..(ACROSS * ACROSS) as usize {
                    let at = place(tile.region, block);
                    tile.end_block(block, u8::from(second[at]) | u8::from(first[at]) << 1);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of 64 pixels of this mean, variance of single samples, and number of events that these are known by.
    fn shown(mean: f64, variance: f64, events: f64) -> Shown {
        let square = 64.0 * variance * variance * 64.0;
        Shown {
            pixels: 64.0,
            variance: 64.0 * variance,
            doubt: if events > 0.0 { square / events } else { 0.0 },
            relative: 64.0 * variance / (mean * mean + DIM * DIM),
            brightness: 64.0 * mean,
        }
    }

    #[test]
    fn what_is_known_well_is_judged_by_itself() {
        let mut blocks = [shown(1.0, 0.1, 1e4); SIDE * SIDE];
        blocks[20] = shown(1.0, 4.0, 1e4);
        for (i, (variance, _)) in drawn_together(&blocks).into_iter().enumerate() {
            let own = blocks[i].mean_variance();
            assert!((variance / own - 1.0).abs() < 1e-3, "{i}: {variance}, not {own}");
        }
    }

    /// A single event in the first of 64 blocks, whose variance is 1: of the whole 1/64. Of the squares that have met nothing, the largest count a
    /// quarter of an event each, and what lies within them none.
    #[test]
    fn what_is_rare_is_shared() {
        let mut blocks = [shown(1.0, 0.0, 0.0); SIDE * SIDE];
        blocks[0] = shown(1.0, 1.0, 1.0);
        let got = drawn_together(&blocks).map(|(variance, _)| variance);
        let towards =
            |own: f64, events: f64, around: f64| (events * own + AROUND * around) / (events + AROUND);
        let whole = 1.0 / 64.0;
        let far = towards(0.0, 0.25, whole);
        assert!((got[63] - far).abs() < 1e-12 && (got[7] - far).abs() < 1e-12, "{got:?}");
        let largest = towards(1.0 / 16.0, 1.0, whole);
        let next = towards(0.0, 0.25, largest);
        assert!((got[SIDE + 2] - next).abs() < 1e-12, "{got:?}");
        let own = towards(1.0, 1.0, towards(0.25, 1.0, largest));
        assert!((got[0] - own).abs() < 1e-12, "{got:?}");
        assert!(got[1] > next && next > far);
    }

    #[test]
    fn easy_blocks_have_a_share_in_what_the_district_needs() {
        let sure = 1e12;
        let mut blocks = [shown(2.0, 0.04, sure); SIDE * SIDE];
        assert!(needs(&blocks).iter().all(|need| (need / 0.01 - 1.0).abs() < 1e-5), "{:?}", needs(&blocks));
        // Half of the district needs sixteen times as many: 8.5 times on average.
        blocks[32..].fill(shown(2.0, 0.64, sure));
        let got = needs(&blocks);
        assert!(
            (got[0] / (0.01 * 8.5_f64.sqrt()) - 1.0).abs() < 1e-5 && (got[63] / 0.16 - 1.0).abs() < 1e-5,
            "{got:?}"
        );
        // One needs a million times as many.
        blocks[0] = shown(2.0, 0.04e6, sure);
        let got = needs(&blocks);
        assert!((got[1] / (0.01 * MOST) - 1.0).abs() < 1e-3, "{got:?}");
        // A dark wall beside a lamp: half of the variance counts by its own brightness.
        let beside = shown(2.0, 0.04, sure);
        let beside = Shown { relative: 0.5 * beside.variance / (DIM * DIM), ..beside };
        let got = needs(&[beside; SIDE * SIDE]);
        assert!((got[5] / (0.5 * 0.04 / (DIM * DIM)) - 1.0).abs() < 1e-5, "{got:?}");
        // Nothing is nothing.
        assert_eq!(needs(&[Shown::default(); SIDE * SIDE]), [0.0; SIDE * SIDE]);
    }
}
