//! Patterns that must know how many points they have.

use super::mix;
use super::padded::Padded;
use super::sobol::scramble;

/// How many points a set has, and the grid they lie in: as square as can be without empty cells, else with the
/// fewest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Set {
    count: u32,
    columns: u32,
    rows: u32,
}

impl Set {
    /// For `count` points; 0 is taken as 1.
    pub fn new(count: u32) -> Self {
        let count = if count == 0 { 1 } else { count };
        let side = count.isqrt();
        // A grid twice as long as wide is preferred to one with holes.
        let whole = (1..=side).rev().take_while(|&c| count / c <= 2 * c).find(|c| count % c == 0);
        let columns = whole.unwrap_or(side);
        Self { count, columns, rows: count.div_ceil(columns) }
    }

    /// Points.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Columns and rows of the grid.
    pub const fn grid(&self) -> [u32; 2] {
        [self.columns, self.rows]
    }

    /// Which of the set's points sample `index` is, in the stream's order; samples beyond the set belong to further
    /// sets of streams of their own.
    fn point(&self, stream: u64, index: u32) -> (u64, u32) {
        let stream = match index / self.count {
            0 => stream,
            set => mix(stream ^ mix(u64::from(set))),
        };
        (stream, permute(index % self.count, self.count, stream))
    }

    /// One number of the set's points, each anywhere in a stratum of its own.
    fn stratum(&self, stream: u64, index: u32) -> u32 {
        let (stream, i) = self.point(stream, index);
        within(i, self.count, hash(stream, index) as u32)
    }
}

/// (i + u) / n as a fraction of 32 bits, u being one as well.
fn within(i: u32, n: u32, u: u32) -> u32 {
    ((u64::from(i) << 32 | u64::from(u)) / u64::from(n)) as u32
}

/// 64 bits for each sample of a stream.
fn hash(stream: u64, index: u32) -> u64 {
    mix(mix(stream ^ 0x2545_f491_4f6c_dd1d).wrapping_add(u64::from(index)))
}

/// A place in a random permutation of 0..len, which the seed chooses. A permutation of the next power of two is
/// repeated until it leads back into the range (Black and Rogaway 2002, "cycle walking"; for samples, Kensler 2013).
fn permute(index: u32, len: u32, seed: u64) -> u32 {
    if len < 2 {
        return 0;
    }
    let bits = u32::BITS - (len - 1).leading_zeros();
    let mask = u32::MAX >> (u32::BITS - bits);
    let shift = bits.div_ceil(2);
    let [a, b] = [mix(seed ^ 0x6a09_e667_f3bc_c908), mix(seed ^ 0xbb67_ae85_84ca_a73b)];
    let keys = [a, a >> 21, a >> 42, b, b >> 21, b >> 42].map(|k| k as u32);
    let mut x = index;
    loop {
        for key in keys {
            x = (x.wrapping_mul(key | 1).wrapping_add(key >> 1)) & mask;
            x ^= x >> shift;
            x = x.wrapping_add(key >> 11) & mask;
        }
        if x < len {
            return x;
        }
    }
}

/// See [`super::Pattern::Regular`].
pub(super) struct Regular(pub Set);

impl Padded for Regular {
    fn one(&self, stream: u64, index: u32) -> u32 {
        let (_, i) = self.0.point(stream, index);
        within(i, self.0.count, 1 << 31)
    }

    fn two(&self, stream: u64, index: u32) -> [u32; 2] {
        let (_, i) = self.0.point(stream, index);
        let [columns, rows] = self.0.grid();
        [within(i % columns, columns, 1 << 31), within(i / columns, rows, 1 << 31)]
    }
}

/// See [`super::Pattern::Jittered`].
pub(super) struct Jittered(pub Set);

impl Padded for Jittered {
    fn one(&self, stream: u64, index: u32) -> u32 {
        self.0.stratum(stream, index)
    }

    fn two(&self, stream: u64, index: u32) -> [u32; 2] {
        // Of a grid with more cells than points, cells are chosen at random: any other way would favour some.
        let [columns, rows] = self.0.grid();
        let cells = Set { count: columns * rows, columns, rows };
        let own = self.0.count;
        let (stream, _) = self.0.point(stream, index);
        let cell = permute(index % own, cells.count, stream);
        let jitter = hash(stream, index);
        [within(cell % columns, columns, jitter as u32), within(cell / columns, rows, (jitter >> 32) as u32)]
    }
}

/// See [`super::Pattern::NRooks`].
pub(super) struct NRooks(pub Set);

impl Padded for NRooks {
    fn one(&self, stream: u64, index: u32) -> u32 {
        self.0.stratum(stream, index)
    }

    fn two(&self, stream: u64, index: u32) -> [u32; 2] {
        [self.0.stratum(stream, index), self.0.stratum(mix(stream ^ 0x5851_f42d_4c95_7f2d), index)]
    }
}

/// See [`super::Pattern::MultiJittered`].
pub(super) struct MultiJittered(pub Set);

impl Padded for MultiJittered {
    fn one(&self, stream: u64, index: u32) -> u32 {
        self.0.stratum(stream, index)
    }

    fn two(&self, stream: u64, index: u32) -> [u32; 2] {
        let (stream, s) = self.0.point(stream, index);
        let [columns, rows] = self.0.grid();
        // Column by column the same permutation of rows, and row by row the same of columns: that is the correlation.
        let column = permute(s % columns, columns, stream ^ 0x1f83_d9ab_fb41_bd6b);
        let row = permute(s / columns, rows, stream ^ 0x5be0_cd19_137e_2179);
        let jitter = hash(stream, index);
        [
            within(column * rows + row, columns * rows, jitter as u32),
            within(s, self.0.count, (jitter >> 32) as u32),
        ]
    }
}

/// See [`super::Pattern::Hammersley`].
pub(super) struct Hammersley(pub Set);

impl Padded for Hammersley {
    fn one(&self, stream: u64, index: u32) -> u32 {
        self.two(stream, index)[0]
    }

    fn two(&self, stream: u64, index: u32) -> [u32; 2] {
        let (stream, i) = self.0.point(stream, index);
        let seeds = mix(stream ^ 0x3c6e_f372_fe94_f82b);
        let turned = within(i, self.0.count, 0).wrapping_add(seeds as u32);
        [turned, scramble(i, (seeds >> 32) as u32).reverse_bits()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_are_permutations_and_any_of_them() {
        for len in [1, 2, 3, 4, 5, 7, 8, 16, 17, 100, 1000] {
            for seed in 0..20 {
                let mut seen = vec![false; len as usize];
                for i in 0..len {
                    let x = permute(i, len, mix(seed)) as usize;
                    assert!(!std::mem::replace(&mut seen[x], true), "{len}: {x} twice");
                }
            }
        }
        // Where two neighbours go: every pair of different places is as likely.
        for len in [2_u32, 3, 4, 5, 7, 8, 13, 16] {
            let pairs = (len * (len - 1)) as usize;
            let runs = 400 * pairs as u32;
            let mut counts = vec![0_u32; (len * len) as usize];
            for seed in 0..runs {
                let to = [0, 1].map(|i| permute(i, len, mix(u64::from(seed))));
                counts[(to[0] * len + to[1]) as usize] += 1;
            }
            let statistic: f64 = counts
                .iter()
                .enumerate()
                .filter(|(k, _)| k / len as usize != k % len as usize)
                .map(|(_, &c)| (f64::from(c) - 400.0).powi(2) / 400.0)
                .sum();
            let degrees = pairs as f64 - 1.0;
            assert!((statistic - degrees).abs() < 5.0 * (2.0 * degrees).sqrt() + 1.0, "{len}: {statistic}");
        }
    }

    #[test]
    fn grids_are_as_square_as_can_be() {
        for (count, grid) in [
            (1, [1, 1]),
            (2, [1, 2]),
            (6, [2, 3]),
            (7, [2, 4]),
            (50, [5, 10]),
            (64, [8, 8]),
            (128, [8, 16]),
            (61, [7, 9]),
            (1 << 18, [512, 512]),
        ] {
            assert_eq!(Set::new(count).grid(), grid, "{count}");
        }
    }
}
