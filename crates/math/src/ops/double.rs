//! Double precision, for set-up.
#![allow(
    clippy::redundant_closure,
    reason = "a function that is named in place of a closure isn't inlined for sure"
)]

use super::{inverse, poly, power_of_two, round, trig};
use crate::simd::{Double, Ulong};
use std::f64::consts::LOG2_E;

/// ln 2 in two pieces; a whole number below 2^11 times the first is exact.
const LN2_HIGH: f64 = 0.6931471804855391;
const LN2_LOW: f64 = 7.440617110012397e-11;

/// Sine and cosine of the same angle.
pub fn sin_cos_d(x: f64) -> (f64, f64) {
    trig::sin_cos_double(x)
}

/// Arc cosine, in [0, pi]; NaN beyond [-1, 1].
#[inline(always)]
pub fn acos_d<D: Double>(x: D) -> D {
    inverse::acos_with(
        x,
        #[inline(always)]
        |z| inverse::asin_long(z),
    )
}

/// The angle of the point (x, y) in [-pi, pi], 0 along +x, counter-clockwise.
pub fn atan2_d(y: f64, x: f64) -> f64 {
    inverse::atan2_with(y, x, inverse::atan_long)
}

/// e to the x.
pub fn exp_d(x: f64) -> f64 {
    exp_sum(x, 0.0)
}

/// Natural logarithm.
pub fn ln_d(x: f64) -> f64 {
    if x > 0.0 && x < f64::INFINITY {
        let (high, low) = ln_pair(x);
        high + low
    } else if x == 0.0 {
        f64::NEG_INFINITY
    } else if x == f64::INFINITY {
        x
    } else {
        f64::NAN
    }
}

/// x to the y.
pub fn pow_d(x: f64, y: f64) -> f64 {
    if y == 0.0 || x == 1.0 {
        return 1.0;
    }
    if x.is_nan() || y.is_nan() {
        return f64::NAN;
    }
    let ax = x.abs();
    if y.is_infinite() {
        return if ax == 1.0 {
            1.0
        } else if (ax > 1.0) == (y > 0.0) {
            f64::INFINITY
        } else {
            0.0
        };
    }
    // From 2^53 on every number is an even integer.
    let small = y.abs() < 9_007_199_254_740_992.0;
    let whole = !small || (y as i64) as f64 == y;
    let odd = small && whole && (y as i64) & 1 == 1;
    let size = if ax == 0.0 || ax == f64::INFINITY {
        if (ax == 0.0) == (y > 0.0) { 0.0 } else { f64::INFINITY }
    } else if x > 0.0 || whole {
        let (high, low) = ln_pair(ax);
        // Even for the x nearest to 1 a larger exponent over- or underflows just the same, and the products
        // below stay finite.
        let limit: f64 = power_of_two(66);
        let y = if y > limit {
            limit
        } else if y < -limit {
            -limit
        } else {
            y
        };
        let (p, p_low) = product(y, high);
        exp_sum(p, p_low + y * low)
    } else {
        return f64::NAN;
    };
    if odd { size.copysign(x) } else { size }
}

/// e to the (x + tail), the tail tiny beside x.
fn exp_sum(x: f64, tail: f64) -> f64 {
    // 1/k!, k = 2..=13, on |r| <= ln(2)/2: the first term left out is below 1e-17.
    const C: [f64; 12] = [
        1.0 / 2.0,
        1.0 / 6.0,
        1.0 / 24.0,
        1.0 / 120.0,
        1.0 / 720.0,
        1.0 / 5040.0,
        1.0 / 40_320.0,
        1.0 / 362_880.0,
        1.0 / 3_628_800.0,
        1.0 / 39_916_800.0,
        1.0 / 479_001_600.0,
        1.0 / 6_227_020_800.0,
    ];
    if x.is_nan() {
        return x;
    }
    if x > 710.0 {
        return f64::INFINITY;
    }
    if x < -746.0 {
        return 0.0;
    }
    let (whole, n) = round(x * LOG2_E);
    let r_high = x - whole * LN2_HIGH;
    let r = r_high - (whole * LN2_LOW - tail);
    let lost = (r_high - r) - (whole * LN2_LOW - tail);
    let e = 1.0 + (r + (lost + r * r * poly(r, C)));
    // In two steps, since 2^n alone may be beyond the range of normal numbers.
    let n = n as i64;
    let half = n >> 1;
    e * power_of_two::<f64>(half as u64) * power_of_two::<f64>((n - half) as u64)
}

/// ln x as the sum of two numbers, good to some 60 bits; x positive and finite.
fn ln_pair(x: f64) -> (f64, f64) {
    // artanh(s)/s = 1 + s²/3 + s⁴/5 + ...: the part after s, divided by s² and doubled, |s| < 0.1716.
    const C: [f64; 11] = [
        2.0 / 3.0,
        2.0 / 5.0,
        2.0 / 7.0,
        2.0 / 9.0,
        2.0 / 11.0,
        2.0 / 13.0,
        2.0 / 15.0,
        2.0 / 17.0,
        2.0 / 19.0,
        2.0 / 21.0,
        2.0 / 23.0,
    ];
    let (scaled, shift) = if x < f64::MIN_POSITIVE { (x * power_of_two::<f64>(64), -64.0) } else { (x, 0.0) };
    let (n, m) = split(scaled);
    let n = n + shift;
    let f = m - 1.0;
    // d + d_low = m + 1 exactly; s + s_low = f / (m + 1).
    let d = m + 1.0;
    let d_low = if m > 1.0 { (m - d) + 1.0 } else { (1.0 - d) + m };
    let s = f / d;
    let (p, p_low) = product(s, d);
    let s_low = (((f - p) - p_low) - s * d_low) / d;
    let z = s * s;
    // The dominant terms n ln2 + 2s exactly as a pair, the small ones added to the lower part.
    let a = n * LN2_HIGH;
    let b = 2.0 * s;
    let (sum, sum_low) = two_sum(a, b);
    let low = sum_low + (2.0 * s_low + n * LN2_LOW + s * z * poly(z, C));
    let high = sum + low;
    (high, (sum - high) + low)
}

/// a b as the sum of two numbers, exactly (Dekker 1971); |a|, |b| < 2^996.
fn product(a: f64, b: f64) -> (f64, f64) {
    let halve = |v: f64| {
        let c = 134_217_729.0 * v;
        let high = c - (c - v);
        (high, v - high)
    };
    let p = a * b;
    let ((ah, al), (bh, bl)) = (halve(a), halve(b));
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

/// a + b as the sum of two numbers, exactly (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let bb = s - a;
    (s, (a - (s - bb)) + (b - bb))
}

/// n and m with x = 2^n m and m in [sqrt(1/2), sqrt(2)), for positive finite normal x.
#[inline(always)]
pub(super) fn split<D: Double>(x: D) -> (D, D) {
    const SQRT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    // n + 1024 is never negative: a shift of 64 bits that keeps the sign is more than some processors have.
    const BIAS: u64 = 1024 << 52;
    let bits = x.to_bits();
    let n = bits.wrapping_sub(D::Ulong::splat(SQRT_HALF.wrapping_sub(BIAS))) >> 52;
    let m = bits.wrapping_sub((n << 52).wrapping_sub(D::Ulong::splat(BIAS)));
    // A whole number in the low bits of 2^52.
    const TWO_52: f64 = 4_503_599_627_370_496.0;
    (D::from_bits(n | TWO_52.to_bits()) - (TWO_52 + 1024.0), D::from_bits(m))
}
