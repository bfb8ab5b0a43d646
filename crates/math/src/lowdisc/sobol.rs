//! Shuffled and scrambled Sobol points of a pixel's samples (Burley 2020).
//!
//! A digit-wise scramble after Owen flips every bit of a fraction by a function of the bits above it. With the
//! bits reversed that is a hash in which bits only act upwards, [`scramble`]. So everything here is kept in reversed
//! bits for as long as possible: a shuffle takes the reversed index, and Sobol's first dimension *is* the
//! reversed index, the second costs five shifts.

/// The sample's number in one dimension, 32 bits after the binary point.
#[inline(always)]
pub(super) fn d1(stream: u64, reversed_index: u32) -> u32 {
    let index = shuffle(stream, reversed_index);
    scramble(index, (stream >> 32) as u32).reverse_bits()
}

/// Two dimensions.
#[inline(always)]
pub(super) fn d2(stream: u64, reversed_index: u32) -> [u32; 2] {
    first_two(stream, shuffle(stream, reversed_index))
}

/// Three dimensions.
#[inline(always)]
pub(super) fn d3(stream: u64, reversed_index: u32) -> [u32; 3] {
    let index = shuffle(stream, reversed_index);
    let [a, b] = first_two(stream, index);
    let seed = super::mix(stream) as u32;
    [a, b, scramble(by_table(&THIRD, index), seed).reverse_bits()]
}

/// Four dimensions.
#[inline(always)]
pub(super) fn d4(stream: u64, reversed_index: u32) -> [u32; 4] {
    let index = shuffle(stream, reversed_index);
    let [a, b] = first_two(stream, index);
    let seeds = super::mix(stream);
    let [c, d] = reverse_both([
        scramble(by_table(&THIRD, index), seeds as u32),
        scramble(by_table(&FOURTH, index), (seeds >> 32) as u32),
    ]);
    [a, b, c, d]
}

#[inline(always)]
fn first_two(stream: u64, index: u32) -> [u32; 2] {
    let seeds = more_seeds(stream);
    reverse_both([
        scramble(index, (stream >> 32) as u32),
        scramble(second_dimension(index), (seeds >> 32) as u32),
    ])
}

/// Both bit-reversed, at the cost of one: no instruction of x86 does it, and it is half of all the work here.
#[inline(always)]
fn reverse_both([a, b]: [u32; 2]) -> [u32; 2] {
    let both = (u64::from(a) << 32 | u64::from(b)).reverse_bits();
    [both as u32, (both >> 32) as u32]
}

/// The sample's place in the shuffled order. Samples of an aligned block of 2^k stay in one such block.
#[inline(always)]
fn shuffle(stream: u64, reversed_index: u32) -> u32 {
    scramble(reversed_index, stream as u32).reverse_bits()
}

/// Further bits from those of a stream, the upper ones good.
#[inline(always)]
fn more_seeds(stream: u64) -> u64 {
    (stream ^ (stream >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93)
}

/// The hash of Laine and Karras (2011) with Vegdahl's constants (2021, "Building a Better LK Hash"): a
/// permutation in which each bit acts on itself and those above it only.
#[inline(always)]
pub(super) fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Sobol's second dimension in reversed bits: the index times Pascal's triangle modulo 2, which is the fifth
/// Kronecker power of [[1, 1], [0, 1]] and so falls apart into five steps.
#[inline(always)]
const fn second_dimension(mut x: u32) -> u32 {
    x ^= x >> 16;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 2) & 0x3333_3333;
    x ^ ((x >> 1) & 0x5555_5555)
}

/// The same for indices of 64 bits: the lower half is the first 32 bits of the fraction.
pub(super) const fn second_dimension_of_64(x: u64) -> u64 {
    let x = x ^ x >> 32;
    (second_dimension((x >> 32) as u32) as u64) << 32 | second_dimension(x as u32) as u64
}

/// A dimension as the exclusive or of one entry for each byte of the index.
type ByteTable = [[u32; 256]; 4];

/// Third and fourth dimension after Joe and Kuo 2008 (new-joe-kuo-6.21201): primitive polynomials x² + x + 1 and
/// x³ + x + 1, first direction numbers 1, 3 and 1, 3, 1.
static THIRD: ByteTable = byte_table(&[1, 3], 1);
static FOURTH: ByteTable = byte_table(&[1, 3, 1], 1);

#[inline(always)]
fn by_table(table: &ByteTable, x: u32) -> u32 {
    let [a, b, c, d] = x.to_le_bytes();
    table[0][a as usize] ^ table[1][b as usize] ^ table[2][c as usize] ^ table[3][d as usize]
}

const fn byte_table(m: &[u32], a: u32) -> ByteTable {
    let directions = reversed_directions(m, a);
    let mut table = [[0; 256]; 4];
    let mut byte = 0;
    while byte < 4 {
        let mut value = 0;
        while value < 256 {
            let mut bit = 0;
            while bit < 8 {
                if value >> bit & 1 == 1 {
                    table[byte][value] ^= directions[8 * byte + bit];
                }
                bit += 1;
            }
            value += 1;
        }
        byte += 1;
    }
    table
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
            let point = [i, second_dimension(i), by_table(&THIRD, i), by_table(&FOURTH, i)];
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
