//! The only door to functions beyond + - * / and the square root.
//!
//! Every function here is written out in IEEE 754 double precision operations, so that it gives the same bits on
//! every machine. Single precision ones compute in double and round once: they are off by hardly more than half
//! a unit in the last place. Those whose name ends in `_d` are for set-up and are good to about 1e-15, relative.
//! Special values (signed zeros, infinities, NaN, domain errors) follow C's Annex F.
//!
//! Single precision functions take plain numbers or many side by side ([`crate::simd`]); a lane gives the bits of the plain number.

use crate::simd::{Arithmetic, Double, Float, Mask, Ulong};

mod double;
mod exp_log;
mod inverse;
mod trig;

#[cfg(test)]
mod tests;

pub use double::{acos_d, atan2_d, exp_d, ln_d, pow_d, sin_cos_d};
pub use exp_log::{cbrt, cosh, exp, exp2, hypot, ln, log2, log10, pow, powi, sinh, tanh};
pub use inverse::{acos, asin, atan, atan2};
pub use trig::{cos, sin, sin_cos, sin_cos_degrees, sin_cos_eighth, sin_cos_two_turns, tan};

/// The lesser of two; `b` when they can't be compared.
#[inline(always)]
pub fn min<F: Float>(a: F, b: F) -> F {
    a.min(b)
}

/// The greater of two; `b` when they can't be compared.
#[inline(always)]
pub fn max<F: Float>(a: F, b: F) -> F {
    a.max(b)
}

/// `x` brought into [lo, hi]; NaN gives `lo`.
#[inline(always)]
pub fn clamp<F: Float>(x: F, lo: F, hi: F) -> F {
    F::select(x.gt(lo), x.min(hi), lo)
}

/// x a + b, rounded once.
#[inline(always)]
pub fn mul_add<F: Float>(x: F, a: F, b: F) -> F {
    x.mul_add(a, b)
}

/// The polynomial c0 + c1 z + c2 z² + ..., its even and odd powers summed side by side.
#[inline(always)]
fn poly<D: Arithmetic<f64> + Double, const N: usize>(z: D, c: [f64; N]) -> D {
    const { assert!(N >= 2) };
    let zz = z * z;
    // The two highest coefficients start the two sums.
    let (mut high, mut low) = (D::splat(c[N - 1]), D::splat(c[N - 2]));
    let mut i = N - 2;
    while i >= 2 {
        high = high * zz + c[i - 1];
        low = low * zz + c[i - 2];
        i -= 2;
    }
    if i == 1 { (high * z + low) * z + c[0] } else { high * z + low }
}

/// Added to a number below 2^50 it leaves no room for a fraction: 1.5 * 2^52.
const MAGIC: f64 = 6_755_399_441_055_744.0;

/// The nearest whole number (ties to even) and, modulo 2^64, the same as an integer; |x| < 2^50.
#[inline(always)]
fn round<D: Double>(x: D) -> (D, D::Ulong) {
    let shifted = x + MAGIC;
    (shifted - MAGIC, shifted.to_bits().wrapping_sub(D::Ulong::splat(MAGIC.to_bits())))
}

/// 2^n for -1022 <= n <= 1023, n modulo 2^64.
#[inline(always)]
fn power_of_two<D: Double>(n: D::Ulong) -> D {
    D::from_bits(n.wrapping_add(D::Ulong::splat(1023)) << 52)
}

/// `f` in place of `of` in the lanes of the mask: for arguments that seldom occur.
#[inline(always)]
fn patched<F: Float>(mask: F::Mask, of: F, f: impl Fn(usize) -> f32) -> F {
    #[cold]
    #[inline(never)]
    fn patch<F: Float>(lanes: u32, of: F, f: impl Fn(usize) -> f32) -> F {
        let old = of.to_array();
        F::from_fn(|i| if lanes >> i & 1 == 1 { f(i) } else { old.as_ref()[i] })
    }
    if mask.any() { patch(mask.to_bits(), of, f) } else { of }
}
