//! Exponentials, logarithms, powers and roots in single precision.

use super::{double, poly, power_of_two, round};
use std::f64::consts::{LN_2, LOG2_E, LOG10_E};

/// e to the x.
#[inline]
pub fn exp(x: f32) -> f32 {
    exp2_wide(f64::from(x) * LOG2_E) as f32
}

/// 2 to the x.
#[inline]
pub fn exp2(x: f32) -> f32 {
    exp2_wide(f64::from(x)) as f32
}

/// Natural logarithm.
#[inline]
pub fn ln(x: f32) -> f32 {
    if x > 0.0 && x < f32::INFINITY {
        let (n, l) = ln_parts(f64::from(x));
        (n * LN_2 + l) as f32
    } else {
        ln_special(x)
    }
}

/// Logarithm to base 2; exact for powers of 2.
#[inline]
pub fn log2(x: f32) -> f32 {
    if x > 0.0 && x < f32::INFINITY { log2_wide(f64::from(x)) as f32 } else { ln_special(x) }
}

/// Logarithm to base 10.
#[inline]
pub fn log10(x: f32) -> f32 {
    if x > 0.0 && x < f32::INFINITY {
        let (n, l) = ln_parts(f64::from(x));
        ((n * LN_2 + l) * LOG10_E) as f32
    } else {
        ln_special(x)
    }
}

/// x to the y.
#[inline]
pub fn pow(x: f32, y: f32) -> f32 {
    if x > 0.0 && x < f32::INFINITY && y.abs() < f32::INFINITY {
        exp2_wide(f64::from(y) * log2_wide(f64::from(x))) as f32
    } else {
        pow_special(x, y)
    }
}

/// x to a whole power, by squaring.
#[inline]
pub fn powi(x: f32, n: i32) -> f32 {
    let mut base = f64::from(x);
    let mut left = n.unsigned_abs();
    let mut result = 1.0;
    while left != 0 {
        if left & 1 == 1 {
            result *= base;
        }
        base *= base;
        left >>= 1;
    }
    (if n < 0 { 1.0 / result } else { result }) as f32
}

/// Cube root, negative for negative x.
pub fn cbrt(x: f32) -> f32 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let a = f64::from(x.abs());
    // A third of the exponent gives the root within an eighth; each step of Halley's method cubes the error.
    let mut r = f64::from_bits(a.to_bits() / 3 + (682 << 52));
    for _ in 0..3 {
        let rrr = r * r * r;
        r = r * (rrr + a + a) / (rrr + rrr + a);
    }
    (r as f32).copysign(x)
}

/// The length of (x, y); infinite when either is.
#[inline]
pub fn hypot(x: f32, y: f32) -> f32 {
    if x.is_infinite() || y.is_infinite() {
        return f32::INFINITY;
    }
    let (x, y) = (f64::from(x), f64::from(y));
    (x * x + y * y).sqrt() as f32
}

/// Hyperbolic sine.
pub fn sinh(x: f32) -> f32 {
    let x = f64::from(x);
    if x.abs() < 1e-2 {
        return (x * (1.0 + x * x / 6.0 * (1.0 + x * x / 20.0))) as f32;
    }
    let e = double::exp_d(x);
    (0.5 * (e - 1.0 / e)) as f32
}

/// Hyperbolic cosine.
pub fn cosh(x: f32) -> f32 {
    let e = double::exp_d(f64::from(x));
    (0.5 * (e + 1.0 / e)) as f32
}

/// Hyperbolic tangent.
pub fn tanh(x: f32) -> f32 {
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
fn exp2_wide(x: f64) -> f64 {
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
    // Comparisons with NaN fail, so that it comes through.
    let x = if x > 400.0 { 400.0 } else { x };
    let x = if x < -400.0 { -400.0 } else { x };
    let (whole, n) = round(x);
    let n = if x.is_nan() { 0 } else { n };
    poly(x - whole, C) * power_of_two(n)
}

/// A positive finite normal x as 2^n m with m in [sqrt(1/2), sqrt(2)): n, and ln m to some 38 bits (relative).
#[inline(always)]
fn ln_parts(x: f64) -> (f64, f64) {
    // 2 artanh(s) / s with s = (m - 1) / (m + 1), |s| < 0.1716: the first term left out is below 3e-12.
    const C: [f64; 7] = [2.0, 2.0 / 3.0, 2.0 / 5.0, 2.0 / 7.0, 2.0 / 9.0, 2.0 / 11.0, 2.0 / 13.0];
    let (n, m) = split(x);
    let s = (m - 1.0) / (m + 1.0);
    (n as f64, s * poly(s * s, C))
}

#[inline(always)]
fn log2_wide(x: f64) -> f64 {
    let (n, l) = ln_parts(x);
    n + l * LOG2_E
}

/// n and m with x = 2^n m and m in [sqrt(1/2), sqrt(2)), for positive finite normal x.
#[inline(always)]
pub(super) fn split(x: f64) -> (i64, f64) {
    const SQRT_HALF: i64 = 0x3fe6_a09e_667f_3bcd;
    let bits = x.to_bits() as i64;
    let n = (bits - SQRT_HALF) >> 52;
    (n, f64::from_bits((bits - (n << 52)) as u64))
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
