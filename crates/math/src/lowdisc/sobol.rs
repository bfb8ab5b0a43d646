//! Shuffled and scrambled Sobol points of a pixel's samples (Burley 2020).
//!
//! A digit-wise scramble after Owen flips every bit of a fraction by a function of the bits above it. With the
//! bits reversed that is a hash in which bits only act upwards, [`scramble`]. So everything here is kept in reversed
//! bits for as long as possible: a shuffle takes the reversed index, and Sobol's first dimension *is* the
//! reversed index, the second costs five shifts.

use crate::simd::{Uint, Ulong};

/// The number of a place in the order in one dimension, 32 bits after the binary point.
#[inline(always)]
pub(super) fn d1<U: Uint<Ulong = L>, L: Ulong<Uint = U>>(stream: L, index: U) -> U {
    scramble(index, stream.high()).reverse_bits()
}

/// Two dimensions.
#[inline(always)]
pub(super) fn d2<U: Uint<Ulong = L>, L: Ulong<Uint = U>>(stream: L, index: U) -> [U; 2] {
    let seed = more_seeds(stream).high();
    // Reversing bits is half of all the work here.
    U::reverse_both(scramble(index, stream.high()), scramble(second_dimension(index), seed))
}

/// Three dimensions.
#[inline(always)]
pub(super) fn d3<U: Uint<Ulong = L>, L: Ulong<Uint = U>>(stream: L, index: U) -> [U; 3] {
    let [a, b] = d2(stream, index);
    let seed = super::mix(stream).low();
    [a, b, scramble(THIRD.of(index), seed).reverse_bits()]
}

/// Four dimensions.
#[inline(always)]
pub(super) fn d4<U: Uint<Ulong = L>, L: Ulong<Uint = U>>(stream: L, index: U) -> [U; 4] {
    let [a, b] = d2(stream, index);
    let seeds = super::mix(stream);
    let [c, d] =
        U::reverse_both(scramble(THIRD.of(index), seeds.low()), scramble(FOURTH.of(index), seeds.high()));
    [a, b, c, d]
}

/// The sample's place in the shuffled order. Samples of an aligned block of 2^k stay in one such block.
#[inline(always)]
pub(super) fn shuffle<U: Uint<Ulong = L>, L: Ulong<Uint = U>>(stream: L, reversed_index: U) -> U {
    scramble(reversed_index, stream.low()).reverse_bits()
}

/// Further bits from those of a stream, the upper ones good.
#[inline(always)]
fn more_seeds<L: Ulong>(stream: L) -> L {
    (stream ^ (stream >> 32)).wrapping_mul(L::splat(0xd6e8_feb8_6659_fd93))
}

/// The hash of Laine and Karras (2011) with Vegdahl's constants (2021, "Building a Better LK Hash"): a
/// permutation in which each bit acts on itself and those above it only.
#[inline(always)]
pub(super) fn scramble<U: Uint>(x: U, seed: U) -> U {
    let x = x ^ x.wrapping_mul(U::splat(0x3d20_adea));
    let x = x.wrapping_add(seed);
    let x = x.wrapping_mul((seed >> 16) | 1);
    let x = x ^ x.wrapping_mul(U::splat(0x0552_6c56));
    x ^ x.wrapping_mul(U::splat(0x53a2_2864))
}

/// Sobol's second dimension in reversed bits: the index times Pascal's triangle modulo 2, which is the fifth
/// Kronecker power of [[1, 1], [0, 1]] and so falls apart into five steps.
#[inline(always)]
fn second_dimension<U: Uint>(x: U) -> U {
    let x = x ^ (x >> 16);
    let x = x ^ ((x >> 8) & 0x00ff_00ff);
    let x = x ^ ((x >> 4) & 0x0f0f_0f0f);
    let x = x ^ ((x >> 2) & 0x3333_3333);
    x ^ ((x >> 1) & 0x5555_5555)
}

/// The same for indices of 64 bits: the lower half is the first 32 bits of the fraction.
pub(super) fn second_dimension_of_64(x: u64) -> u64 {
    let x = x ^ x >> 32;
    u64::from(second_dimension((x >> 32) as u32)) << 32 | u64::from(second_dimension(x as u32))
}

/// A dimension in reversed bits, as the exclusive or of one table entry for each few bits of the index.
struct Dimension {
    /// For each byte, which is the fewest steps for a single number.
    bytes: [[u32; 256]; 4],
    /// For three bits at a time: tables of eight entries, which stay in a register.
    triples: [[u32; 8]; 11],
}

/// Third and fourth dimension after Joe and Kuo 2008 (new-joe-kuo-6.21201): primitive polynomials x² + x + 1 and
/// x³ + x + 1, first direction numbers 1, 3 and 1, 3, 1.
static THIRD: Dimension = Dimension::new(&[1, 3], 1);
static FOURTH: Dimension = Dimension::new(&[1, 3, 1], 1);

/// A matrix over the bits of a place: 14 rows, the first of what decides most, beyond which it is the identity's. It is upper triangular, so that a block of 2^k places
/// stays one.
///
/// Of the two dimensions of a place and the two of it multiplied by this, each pair has a point in each elementary interval. What boxes in all four dimensions
/// have one as well was searched for, column by column, by random choice among the best: for 16 points in 19 of the 25 ways to cut both pairs, for 64 in 43
/// of 70, for 256 in 83 of 147, where shuffles of one against the other have 10, 28 and 54. That the pairs are in their
/// own right (0,2)-sequences, and good together, is the aim of Ahmed et al. 2024, "SZ Sequences: Binary-Based (0, 2^q)-Sequences".
const TURN: [u32; 14] =
    [16029, 9530, 12500, 6568, 4656, 928, 8000, 13952, 15616, 5632, 9216, 2048, 12288, 8192];

static TURNED: Dimension = Dimension::by(&columns(&TURN));

/// The place in the order of a node by that at the node before.
#[inline(always)]
pub(super) fn turned<U: Uint>(place: U) -> U {
    TURNED.of(place)
}

const fn columns(rows: &[u32; 14]) -> [u32; 32] {
    let mut columns = [0_u32; 32];
    let mut bit = 0;
    while bit < 32 {
        columns[bit] = 1 << bit;
        let mut row = 0;
        while bit < rows.len() && row < rows.len() {
            columns[bit] |= (rows[row] >> bit & 1) << row;
            row += 1;
        }
        bit += 1;
    }
    columns
}

impl Dimension {
    #[inline(always)]
    fn of<U: Uint>(&self, x: U) -> U {
        if U::WIDTH == 1 {
            let [a, b, c, d] = x.lane(0).to_le_bytes().map(usize::from);
            return U::splat(self.bytes[0][a] ^ self.bytes[1][b] ^ self.bytes[2][c] ^ self.bytes[3][d]);
        }
        let mut out = x.look_up(&self.triples[0]);
        let mut k = 1;
        while k < self.triples.len() {
            out = out ^ (x >> (3 * k as u32)).look_up(&self.triples[k]);
            k += 1;
        }
        out
    }

    const fn new(m: &[u32], a: u32) -> Self {
        Self::by(&reversed_directions(m, a))
    }

    /// Of what each bit of the index adds.
    const fn by(directions: &[u32; 32]) -> Self {
        let (mut bytes, mut triples) = ([[0; 256]; 4], [[0; 8]; 11]);
        let mut bit = 0;
        while bit < 32 {
            add(&mut bytes[bit / 8], bit % 8, directions[bit]);
            add(&mut triples[bit / 3], bit % 3, directions[bit]);
            bit += 1;
        }
        Self { bytes, triples }
    }
}

/// Adds a direction to the entries of a table whose number has the bit.
const fn add(table: &mut [u32], bit: usize, direction: u32) {
    let mut value = 0;
    while value < table.len() {
        if value >> bit & 1 == 1 {
            table[value] ^= direction;
        }
        value += 1;
    }
}

/// The direction numbers by the recurrence of Bratley and Fox (1988), in reversed bits.
const fn reversed_directions(m: &[u32], a: u32) -> [u32; 32] {
    let degree = m.len();
    let mut v = [0_u32; 32];
    let mut i = 0;
    while i < 32 {
        if i < degree {
            v[i] = m[i] << (31 - i);
        } else {
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if a >> (degree - 1 - k) & 1 == 1 {
                    v[i] ^= v[i - k];
                }
                k += 1;
            }
        }
        i += 1;
    }
    let mut i = 0;
    while i < 32 {
        v[i] = v[i].reverse_bits();
        i += 1;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unscrambled_points_are_the_published_ones() {
        // The first eight points of the sequence of Joe and Kuo, in eighths.
        let want = [
            [0, 0, 0, 0],
            [4, 4, 4, 4],
            [2, 6, 6, 6],
            [6, 2, 2, 2],
            [1, 5, 3, 1],
            [5, 1, 7, 5],
            [3, 3, 5, 7],
            [7, 7, 1, 3],
        ];
        for (i, want) in (0_u32..).zip(want) {
            let point = [i, second_dimension(i), THIRD.of(i), FOURTH.of(i)];
            assert_eq!(point.map(|x| x.reverse_bits() >> 29), want, "point {i}");
        }
    }

    #[test]
    fn scrambling_is_a_permutation_that_only_looks_down() {
        for seed in [0, 1, 0x9e37_79b9, u32::MAX] {
            let mut seen = vec![false; 1 << 16];
            for x in 0..1_u32 << 16 {
                // The lower 16 bits depend on the lower 16 bits alone.
                let low = scramble(x, seed) & 0xffff;
                assert_eq!(low, scramble(x | 0xabcd_0000, seed) & 0xffff);
                assert!(!std::mem::replace(&mut seen[low as usize], true));
            }
        }
    }
}
