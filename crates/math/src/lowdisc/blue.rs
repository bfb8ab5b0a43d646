//! Sobol's points along a shuffled Morton curve through all pixels (Ahmed and Wonka 2020): neighbours get points of the
//! sequence that follow one another, so that what one misses the next one has, and the error that is left is of high
//! frequency. The order of the four quarters of each square of the curve is drawn anew, and for each purpose.

use super::padded::Padded;
use super::sobol::{scramble, second_dimension_of_64};
use super::{Purpose, SampleName, mix};

/// The part of a sequence that each pixel owns: 2^k points, k being held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Order {
    bits: u32,
}

impl Order {
    /// For `count` samples of each pixel: the next power of two is owned.
    pub(super) fn new(count: u32) -> Self {
        Self { bits: u32::BITS - count.saturating_sub(1).leading_zeros() }
    }

    /// A name that keeps the pixel's place on the curve (lower half of `pixel`) apart from the seed (upper half).
    pub(super) fn name(seed: u64, pixel: [u32; 2], index: u32) -> SampleName {
        let seed = mix(seed ^ 0x5851_f42d_4c95_7f2d) & 0xffff_ffff_0000_0000;
        let place = spread(pixel[0]) | spread(pixel[1]) << 1;
        SampleName { pixel: seed | u64::from(place), ..SampleName::new(0, [0; 2], index) }
    }

    /// As [`SampleName::stream`], the same for all pixels.
    pub(super) fn stream(self, name: &SampleName, purpose: Purpose) -> u64 {
        mix((name.pixel & 0xffff_ffff_0000_0000) ^ (u64::from(name.node) << 32 | purpose as u64))
    }

    /// The points of the pixel that a name tells.
    pub(super) fn at(self, name: &SampleName) -> Pixel {
        Pixel { bits: self.bits, place: name.pixel as u32 }
    }
}

/// The lower 16 bits, each followed by an empty one.
fn spread(x: u32) -> u32 {
    let mut x = x & 0xffff;
    x = (x | x << 8) & 0x00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

/// The points that one pixel owns.
pub(super) struct Pixel {
    bits: u32,
    /// On the Morton curve.
    place: u32,
}

impl Pixel {
    /// The number in the sequence.
    fn number(&self, stream: u64, index: u32) -> u64 {
        let place = u64::from(shuffle(stream, self.place));
        // Within a pixel as everywhere else; samples beyond its own points get those of an unrelated pixel.
        let own = mix(stream ^ mix(u64::from(self.place)));
        let shuffled = scramble(index.reverse_bits(), own as u32).reverse_bits();
        let beyond = u64::from(index) >> self.bits;
        let place = if beyond == 0 { place } else { mix(own ^ beyond) >> 32 };
        place << self.bits | u64::from(shuffled) & ((1 << self.bits) - 1)
    }
}

impl Padded for Pixel {
    fn one(&self, stream: u64, index: u32) -> u32 {
        scramble(self.number(stream, index) as u32, (stream >> 32) as u32).reverse_bits()
    }

    fn two(&self, stream: u64, index: u32) -> [u32; 2] {
        let number = self.number(stream, index);
        let seeds = mix(stream ^ 0xa54f_f53a_5f1d_36f1);
        [
            scramble(number as u32, (stream >> 32) as u32).reverse_bits(),
            scramble(second_dimension_of_64(number) as u32, seeds as u32).reverse_bits(),
        ]
    }
}

/// The place on a Morton curve whose every square goes through its quarters in an order of its own.
fn shuffle(stream: u64, place: u32) -> u32 {
    let mut out = 0;
    for level in (0..16).rev() {
        let above = u64::from(place) >> (2 * level + 2);
        let order = ORDERS[(mix(stream ^ (above << 4 | level)) % 24) as usize];
        let quarter = place >> (2 * level) & 3;
        out |= u32::from(order >> (2 * quarter) & 3) << (2 * level);
    }
    out
}

/// The 24 orders of four things, two bits for each.
const ORDERS: [u8; 24] = orders();

const fn orders() -> [u8; 24] {
    let mut all = [0; 24];
    let mut found = 0;
    let mut code: u32 = 0;
    while code < 256 {
        let (a, b, c, d) = (code & 3, code >> 2 & 3, code >> 4 & 3, code >> 6);
        if 1 << a | 1 << b | 1 << c | 1 << d == 15 {
            all[found] = code as u8;
            found += 1;
        }
        code += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::{Pattern, PatternKind};
    use super::*;

    #[test]
    fn squares_of_pixels_share_out_a_block_of_points() {
        for (count, side) in [(1, 8), (4, 4), (2, 8), (16, 2)] {
            let order = Order::new(count);
            let block = u64::from(count) * side * side;
            let mut seen = std::collections::BTreeSet::new();
            for y in 0..side {
                for x in 0..side {
                    let name = Order::name(3, [(40 * side + x) as u32, (17 * side + y) as u32], 0);
                    for i in 0..count {
                        seen.insert(order.at(&name).number(mix(5), i));
                    }
                }
            }
            let first = *seen.first().unwrap();
            assert_eq!(first % block, 0, "{count} samples, {side} pixels");
            assert!(seen.iter().copied().eq(first..first + block));
        }
    }

    #[test]
    fn the_error_is_of_high_frequency() {
        // The mean of x y over four samples a pixel, and how much of its variance is left in blocks of 8 x 8 pixels:
        // a 64th of it where pixels are independent.
        let left = |kind| {
            let pattern = Pattern::new(kind, 4);
            let error = |x: u32, y: u32| -> f64 {
                let value = |i| {
                    let [u, v] = pattern.d2(&pattern.name(1, [x, y], i), Purpose::LightPoint);
                    f64::from(u) * f64::from(v)
                };
                (0..4).map(value).sum::<f64>() / 4.0 - 0.25
            };
            let (mut all, mut blocks) = (0.0, 0.0);
            for by in 0..16 {
                for bx in 0..16 {
                    let mut mean = 0.0;
                    for k in 0..64 {
                        let e = error(8 * bx + k % 8, 8 * by + k / 8);
                        all += e * e / (256.0 * 64.0);
                        mean += e / 64.0;
                    }
                    blocks += mean * mean / 256.0;
                }
            }
            64.0 * blocks / all
        };
        let (plain, blue) = (left(PatternKind::Sobol), left(PatternKind::BlueSobol));
        assert!((0.6..1.6).contains(&plain) && blue < 0.1, "{plain}, {blue}");
    }
}
