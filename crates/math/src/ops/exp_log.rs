//! Exponentials, logarithms, powers and roots in single precision.

use super::{double, patched, poly, power_of_two, round};
use crate::simd::{Double, Float, Ulong};
use std::f64::consts::{LN_2, LOG2_E, LOG10_E};

/// e to the x.
#[inline(always)]
pub fn exp<F: Float>(x: F) -> F {
    F::from_double(exp2_wide(x.to_double() * LOG2_E))
}

/// 2 to the x.
#[inline(always)]
pub fn exp2<F: Float>(x: F) -> F {
    F::from_double(exp2_wide(x.to_double()))
}

/// Natural logarithm.
#[inline(always)]
pub fn ln<F: Float>(x: F) -> F {
    let (n, l) = ln_parts(x.to_double());
    logarithm(x, n * LN_2 + l)
}

/// Logarithm to base 2; exact for powers of 2.
#[inline(always)]
pub fn log2<F: Float>(x: F) -> F {
    logarithm(x, log2_wide(x.to_double()))
}

/// Logarithm to base 10.
#[inline(always)]
pub fn log10<F: Float>(x: F) -> F {
    let (n, l) = ln_parts(x.to_double());
    logarithm(x, (n * LN_2 + l) * LOG10_E)
}

/// A logarithm of x, of which is known what it is where x is positive and finite.
#[inline(always)]
fn logarithm<F: Float>(x: F, plain: F::Double) -> F {
    let is_plain = x.gt(F::ZERO) & x.lt(F::splat(f32::INFINITY));
    patched(!is_plain, F::from_double(plain), move |i| ln_special(x.lane(i)))
}

/// x to the y.
#[inline(always)]
pub fn pow<F: Float>(x: F, y: F) -> F {
    // Some hundred instructions, in a function of its own: many who call it are compiled for each kind of surface.
    F::vectorize(
        #[inline(always)]
        move || {
            let infinity = F::splat(f32::INFINITY);
            let is_plain = x.gt(F::ZERO) & x.lt(infinity) & y.abs().lt(infinity);
            let power = F::from_double(exp2_wide(y.to_double() * log2_wide(x.to_double())));
            patched(!is_plain, power, move |i| pow_special(x.lane(i), y.lane(i)))
        },
    )
}

/// x to a whole power, by squaring.
#[inline(always)]
pub fn powi<F: Float>(x: F, n: i32) -> F {
    let mut base = x.to_double();
    let mut left = n.unsigned_abs();
    let mut result = F::Double::ONE;
    while left != 0 {
        if left & 1 == 1 {
            result *= base;
        }
        base *= base;
        left >>= 1;
    }
    F::from_double(if n < 0 { F::Double::ONE / result } else { result })
}

/// Cube root, negative for negative x.
#[inline(always)]
pub fn cbrt<F: Float>(x: F) -> F {
    let a = x.abs().to_double();
    // A third of the exponent gives the root within an eighth; each step of Halley's method cubes the error.
    let bits = a.to_bits();
    let mut r = F::Double::from_bits(F::Ulong::from_fn(|i| bits.lane(i) / 3 + (682 << 52)));
    for _ in 0..3 {
        let rrr = r * r * r;
        r = r * (rrr + a + a) / (rrr + rrr + a);
    }
    F::select(x.ne(F::ZERO) & x.is_finite(), F::from_double(r).copysign(x), x)
}

/// The length of (x, y); infinite when either is.
#[inline(always)]
pub fn hypot<F: Float>(x: F, y: F) -> F {
    let infinity = F::splat(f32::INFINITY);
    let is_infinite = x.abs().eq(infinity) | y.abs().eq(infinity);
    let (x, y) = (x.to_double(), y.to_double());
    F::select(is_infinite, infinity, F::from_double((x * x + y * y).sqrt()))
}

/// Hyperbolic sine, lane by lane.
#[inline(always)]
pub fn sinh<F: Float>(x: F) -> F {
    x.map(one_sinh)
}

/// Hyperbolic cosine, lane by lane.
#[inline(always)]
pub fn cosh<F: Float>(x: F) -> F {
    x.map(one_cosh)
}

/// Hyperbolic tangent, lane by lane.
#[inline(always)]
pub fn tanh<F: Float>(x: F) -> F {
    x.map(one_tanh)
}

fn one_sinh(x: f32) -> f32 {
    let x = f64::from(x);
    if x.abs() < 1e-2 {
        return (x * (1.0 + x * x / 6.0 * (1.0 + x * x / 20.0))) as f32;
    }
    let e = double::exp_d(x);
    (0.5 * (e - 1.0 / e)) as f32
}

fn one_cosh(x: f32) -> f32 {
    let e = double::exp_d(f64::from(x));
    (0.5 * (e + 1.0 / e)) as f32
}

fn one_tanh(x: f32) -> f32 {
    let x = f64::from(x);
    if x.abs() < 1e-2 {
        let z = x * x;
        return (x * (1.0 - z / 3.0 + z * z * (2.0 / 15.0))) as f32;
    }
    if x.abs() > 20.0 {
        return 1.0_f32.copysign(x as f32);
    }
    let e = double::exp_d(2.0 * x);
    ((e - 1.0) / (e + 1.0)) as f32
}

/// 2 to the x to some 32 bits, beyond the range of single precision clamped to what rounds to 0 or infinity.
#[inline(always)]
fn exp2_wide<D: Double>(x: D) -> D {
    // Taylor series of 2^r, |r| <= 1/2: the first term left out is below 3e-10.
    const L: f64 = LN_2;
    const C: [f64; 9] = [
        1.0,
        L,
        L * L / 2.0,
        L * L * L / 6.0,
        L * L * L * L / 24.0,
        L * L * L * L * L / 120.0,
        L * L * L * L * L * L / 720.0,
        L * L * L * L * L * L * L / 5040.0,
        L * L * L * L * L * L * L * L / 40_320.0,
    ];
    // Comparisons with NaN fail, so that it comes through, whatever power of two it is multiplied with.
    let x = D::splat(-400.0).max(D::splat(400.0).min(x));
    let (whole, n) = round(x);
    poly(x - whole, C) * power_of_two::<D>(n)
}

/// A positive finite normal x as 2^n m with m in [sqrt(1/2), sqrt(2)): n, and ln m to some 38 bits (relative).
#[inline(always)]
fn ln_parts<D: Double>(x: D) -> (D, D) {
    // 2 artanh(s) / s with s = (m - 1) / (m + 1), |s| < 0.1716: the first term left out is below 3e-12.
    const C: [f64; 7] = [2.0, 2.0 / 3.0, 2.0 / 5.0, 2.0 / 7.0, 2.0 / 9.0, 2.0 / 11.0, 2.0 / 13.0];
    let (n, m) = double::split(x);
    let s = (m - 1.0) / (m + 1.0);
    (n, s * poly(s * s, C))
}

#[inline(always)]
fn log2_wide<D: Double>(x: D) -> D {
    let (n, l) = ln_parts(x);
    n + l * LOG2_E
}

#[cold]
fn ln_special(x: f32) -> f32 {
    if x == 0.0 {
        f32::NEG_INFINITY
    } else if x == f32::INFINITY {
        x
    } else {
        f32::NAN
    }
}

#[cold]
fn pow_special(x: f32, y: f32) -> f32 {
    let (ax, yd) = (x.abs(), f64::from(y));
    if y == 0.0 || x == 1.0 {
        return 1.0;
    }
    if x.is_nan() || y.is_nan() {
        return f32::NAN;
    }
    if y.is_infinite() {
        return if ax == 1.0 {
            1.0
        } else if (ax > 1.0) == (y > 0.0) {
            f32::INFINITY
        } else {
            0.0
        };
    }
    let whole = yd.abs() >= 9_007_199_254_740_992.0 || yd as i64 as f64 == yd;
    let odd = whole && yd.abs() < 9_007_199_254_740_992.0 && (yd as i64) & 1 == 1;
    let size = if ax == 0.0 || ax == f32::INFINITY {
        if (ax == 0.0) == (y > 0.0) { 0.0 } else { f32::INFINITY }
    } else if whole {
        exp2_wide(yd * log2_wide(f64::from(ax))) as f32
    } else {
        return f32::NAN;
    };
    if odd { size.copysign(x) } else { size }
}
