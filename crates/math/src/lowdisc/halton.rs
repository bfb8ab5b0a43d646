//! Halton's points (1960) of bases 2 and 3, scrambled after Owen (1995).
//!
//! Every 6^k points from a multiple of 6^k on have one in each box of 2^-k by 3^-k. A shuffle that moves such blocks
//! as a whole, and the blocks within them, keeps that: Burley's (2020) for base 2, carried over to the digits of
//! base 6.

use super::mix;
use super::padded::Padded;
use super::sobol::scramble;

/// See [`super::Pattern::Halton`].
pub(super) struct Halton;

/// Digits of base 6 of an index that are shuffled: all that a film can take, 2^18 samples.
const SHUFFLED: u32 = 7;

/// Digits of base 3 of those.
const THIRDS: u32 = 12;

impl Padded for Halton {
    fn one(&self, stream: u64, index: u32) -> u32 {
        half(stream, shuffle(stream, index))
    }

    fn two(&self, stream: u64, index: u32) -> [u32; 2] {
        let index = shuffle(stream, index);
        [half(stream, index), third(mix(stream ^ 0xa54f_f53a_5f1d_36f1), index)]
    }
}

/// The scrambled binary fraction.
fn half(stream: u64, index: u64) -> u32 {
    scramble(index as u32, (stream >> 32) as u32).reverse_bits()
}

/// The scrambled fraction in base 3.
fn third(stream: u64, index: u64) -> u32 {
    let (mut rest, mut digits, mut scale, mut k) = (index, 0_u64, 1_u64, 0);
    while k < THIRDS || rest > 0 {
        // The permutation of a digit depends on those before it, which the scrambled ones tell as well.
        let h = mix(stream ^ mix(digits << 6 | u64::from(k)));
        digits = 3 * digits + permuted::<3>((rest % 3) as usize, h);
        scale *= 3;
        rest /= 3;
        k += 1;
    }
    // All further digits are those of 0, whose scrambling is any number at all.
    let tail = mix(stream ^ mix(digits << 6 | 0x3f)) >> 44;
    let fraction = (digits as f64 + tail as f64 / f64::from(1_u32 << 20)) / scale as f64;
    (fraction * 4_294_967_296.0) as u32
}

/// The index with its digits of base 6 permuted, each as those above it say.
fn shuffle(stream: u64, index: u32) -> u64 {
    let mut place = 6_u64.pow(SHUFFLED);
    let index = u64::from(index);
    let mut out = index / place * place;
    for _ in 0..SHUFFLED {
        place /= 6;
        let above = index / (6 * place);
        let h = mix(stream ^ mix(above.wrapping_mul(0x9e37_79b9) ^ place << 32));
        out += place * permuted::<6>((index / place % 6) as usize, h);
    }
    out
}

/// Where a random permutation of N things takes one of them (Fisher and Yates 1938).
fn permuted<const N: usize>(digit: usize, random: u64) -> u64 {
    let mut order: [u8; N] = std::array::from_fn(|i| i as u8);
    let mut random = random;
    for i in (1..N).rev() {
        order.swap(i, (random % (i as u64 + 1)) as usize);
        random /= i as u64 + 1;
    }
    order[digit].into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_have_a_point_in_each_box() {
        for stream in [mix(1), mix(2), mix(3)] {
            for (halves, thirds) in [(1, 1), (2, 1), (1, 2), (2, 2), (3, 3)] {
                let (columns, rows) = (1_u32 << halves, 3_u32.pow(thirds));
                let block = 6_u32.pow(if halves > thirds { halves } else { thirds });
                let mut counts = vec![0; (columns * rows) as usize];
                for i in 5 * block..6 * block {
                    let [x, y] = Halton.two(stream, i);
                    let cell = |v: u32, n: u32| ((u64::from(v) * u64::from(n)) >> 32) as u32;
                    counts[(cell(y, rows) * columns + cell(x, columns)) as usize] += 1;
                }
                assert!(counts.iter().all(|&c| c == block / (columns * rows)), "{columns} x {rows}");
            }
        }
    }

    #[test]
    fn a_shuffle_moves_each_once() {
        let mut seen = vec![false; 6_usize.pow(5)];
        for i in 0..6_u32.pow(5) {
            let to = shuffle(mix(9), i) % 6_u64.pow(5);
            assert!(!std::mem::replace(&mut seen[to as usize], true));
        }
        assert_eq!(shuffle(mix(9), u32::MAX) / 6_u64.pow(7), u64::from(u32::MAX) / 6_u64.pow(7));
    }
}
