//! The only door to functions beyond + - * / and the square root.
//!
//! Every function here is written out in IEEE 754 double precision operations, so that it gives the same bits on
//! every machine. Single precision ones compute in double and round once: they are off by hardly more than half
//! a unit in the last place. Those whose name ends in `_d` are for set-up and are good to about 1e-15, relative.
//! Special values (signed zeros, infinities, NaN, domain errors) follow C's Annex F.

mod double;
mod exp_log;
mod inverse;
mod trig;

#[cfg(test)]
mod tests;

pub use double::{acos_d, atan2_d, exp_d, ln_d, pow_d, sin_cos_d};
pub use exp_log::{cbrt, cosh, exp, exp2, hypot, ln, log2, log10, pow, powi, sinh, tanh};
pub use inverse::{acos, asin, atan, atan2};
pub use trig::{cos, sin, sin_cos, sin_cos_degrees, sin_cos_eighth, tan};

/// The lesser of two; `b` when they can't be compared.
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two; `b` when they can't be compared.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `x` brought into [lo, hi]; NaN gives `lo`.
#[inline(always)]
pub fn clamp(x: f32, lo: f32, hi: f32) -> f32 {
    if x > lo { if x < hi { x } else { hi } } else { lo }
}

/// The polynomial c0 + c1 z + c2 z² + ..., its even and odd powers summed side by side.
#[inline(always)]
fn poly<const N: usize>(z: f64, c: [f64; N]) -> f64 {
    const { assert!(N >= 2) };
    let zz = z * z;
    // The two highest coefficients start the two sums.
    let (mut high, mut low) = (c[N - 1], c[N - 2]);
    let mut i = N - 2;
    while i >= 2 {
        high = high * zz + c[i - 1];
        low = low * zz + c[i - 2];
        i -= 2;
    }
    if i == 1 { (high * z + low) * z + c[0] } else { high * z + low }
}

/// The nearest whole number (ties to even) and, in its low bits, the same as an integer; |x| < 2^50.
#[inline(always)]
fn round(x: f64) -> (f64, i64) {
    // Adding 1.5 * 2^52 leaves no room for a fraction.
    const MAGIC: f64 = 6_755_399_441_055_744.0;
    let shifted = x + MAGIC;
    (shifted - MAGIC, (shifted.to_bits() as i64).wrapping_sub(MAGIC.to_bits() as i64))
}

/// 2^n for -1022 <= n <= 1023.
#[inline(always)]
fn power_of_two(n: i64) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}
