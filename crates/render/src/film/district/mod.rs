//! Which halves of which pixels need no further samples, by what their district shows.
//!
//! A block is done when its noise is at most what is wished for: the root mean square of its pixels' standard errors over its mean brightness, or over each
//! pixel's own, where that is more: a dark wall beside a lamp counts as well. [`lone`] tells what each pixel has of a block's noise, [`known`] tells how noisy a block is when few of its samples have met what makes its
//! noise, [`unmet`] what may lie beside what is bright, and [`wanted`] which pixels go on.
//!
//! Districts of 64 x 64 pixels are aligned to the whole picture, and a crop is rendered in whole ones, so that it ends where the picture does.

mod known;
mod lone;
mod unmet;
mod wanted;

use super::adaptive::Told;
use super::{BLOCK, Film, FilmTile, Region};
use rayon::prelude::*;

/// Side of a district in pixels.
pub const DISTRICT: u32 = 64;

/// Blocks from one side of a district to the other.
const SIDE: usize = (DISTRICT / BLOCK) as usize;

/// Pixels of a block.
const PIXELS: usize = (BLOCK * BLOCK) as usize;

/// Pixels of a district, block by block.
const ALL: usize = SIDE * SIDE * PIXELS;

/// Brightness that is added, by squares, to that of a pixel by itself, whose mean is noise as well.
const DIM: f64 = 0.1;

/// What one half of a pixel's samples shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Half {
    /// How many they are; 0 outside of the picture.
    count: f64,
    /// The mean of the colours' values, each without its sign.
    brightness: f64,
    /// The mean of the colours' variances, of single samples: what samples of a pattern leave, by two or three batches.
    variance: f64,
    /// The same by all batches, five to eight.
    by_all: f64,
    /// What independent samples would leave.
    spread: f64,
    /// Whether further samples of this half are wanted.
    is_open: bool,
}

impl Half {
    fn of(tile: &FilmTile, k: usize, half: usize, is_open: bool) -> Self {
        let count = f64::from(tile.count_of_half(k, half).max(1));
        let mut sum = Self { count, is_open, ..Self::default() };
        for Told { mean, spread, few, all } in tile.told_by_half(k, half) {
            sum.brightness += mean.abs() / 3.0;
            sum.variance += few * count / 3.0;
            sum.by_all += all * count / 3.0;
            sum.spread += spread * count / 3.0;
        }
        sum
    }

    /// How many bright samples it has met if the others are black: between 1 and all of them, 0 where there is no noise.
    fn events(&self) -> f64 {
        if self.spread <= 0.0 || self.variance <= 0.0 {
            return 0.0;
        }
        let events = self.count * self.brightness * self.brightness / self.spread;
        at_least(if events < self.count { events } else { self.count }, 1.0)
    }

    /// What the square of a pixel's error is divided by where it counts beside its own brightness.
    fn own_square(&self) -> f64 {
        self.brightness * self.brightness + DIM * DIM
    }
}

/// The greater of two numbers.
fn at_least(v: f64, least: f64) -> f64 {
    if v > least { v } else { least }
}

/// Place of a pixel of a district, given in its coordinates, among all of them.
fn place([x, y]: [usize; 2]) -> usize {
    let side = BLOCK as usize;
    (y / side * SIDE + x / side) * PIXELS + y % side * side + x % side
}

impl Film {
    /// Ends the halves of pixels whose counterparts tell that they need no more than the `samples` which those that go on have by now, for a noise of
    /// at most `target`.
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
            let mut halves = [vec![Half::default(); ALL], vec![Half::default(); ALL]];
            for tile in members.iter().map(|i| &tiles[*i]) {
                for_each_pixel(tile.region, |k, pixel, place| {
                    let ended = tile.ended(pixel);
                    for (half, shown) in halves.iter_mut().enumerate() {
                        shown[place] = Half::of(tile, k, half, ended >> half & 1 == 0);
                    }
                });
            }
            let [first, second] = &halves;
            let samples = f64::from(samples);
            Some(
                [(first, second), (second, first)]
                    .map(|(own, other)| wanted::ending(own, other, (samples, target))),
            )
        };
        let looked: Vec<Option<[Vec<bool>; 2]>> = districts.par_iter().map(look).collect();
        for (members, ends) in districts.iter().zip(looked) {
            let Some([first, second]) = ends else { continue };
            for i in members {
                let tile = &mut self.tiles[*i];
                for_each_pixel(tile.region, |_, pixel, place| {
                    tile.end_halves(pixel, u8::from(first[place]) | u8::from(second[place]) << 1);
                });
            }
        }
    }
}

/// The pixels of a tile: place in the tile, in the picture and in their district.
fn for_each_pixel(Region { min, max }: Region, mut f: impl FnMut(usize, [u32; 2], usize)) {
    let pixels = (min[1]..max[1]).flat_map(|y| (min[0]..max[0]).map(move |x| [x, y]));
    for (k, pixel) in pixels.enumerate() {
        f(k, pixel, place(pixel.map(|v| (v % DISTRICT) as usize)));
    }
}
