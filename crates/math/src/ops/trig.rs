//! Sine, cosine, tangent.

use super::{poly, round};
use crate::simd::{Double, Float, Mask, Ulong};
use std::f64::consts::{FRAC_2_PI, PI};

/// pi/2 in three pieces; a whole number below 2^20 times either of the first two is exact (33 bits each).
const PIO2: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];
/// The second and third piece of pi/2 in one.
const PIO2_REST: f64 = 6.077100506506192e-11;
/// Up to here an argument is reduced by the pieces of [`PIO2`], beyond by [`reduce_huge`].
const SMALL: f64 = (1 << 20) as f64;

/// The fraction of 2/pi in binary, first bit worth 1/2.
const TWO_OVER_PI: [u64; 20] = [
    0xa2f9836e4e441529,
    0xfc2757d1f534ddc0,
    0xdb6295993c439041,
    0xfe5163abdebbc561,
    0xb7246e3a424dd2e0,
    0x06492eea09d1921c,
    0xfe1deb1cb129a73e,
    0xe88235f52ebb4484,
    0xe99c7026b45f7e41,
    0x3991d639835339f4,
    0x9c845f8bbdf9283b,
    0x1ff897ffde05980f,
    0xef2f118b5a0a6d1f,
    0x6d367ecf27cb09b7,
    0x4f463f669e5fea2d,
    0x7527bac7ebe5f17b,
    0x3d0739f78a5292ea,
    0x6bfb5fb11f8d5d08,
    0x56033046fc7b6bab,
    0xf0cfbc209af4361d,
];

/// Sine.
#[inline(always)]
pub fn sin<F: Float>(x: F) -> F {
    sin_cos(x).0
}

/// Cosine.
#[inline(always)]
pub fn cos<F: Float>(x: F) -> F {
    sin_cos(x).1
}

/// Tangent.
#[inline(always)]
pub fn tan<F: Float>(x: F) -> F {
    let (s, c) = sin_cos_wide(x);
    F::from_double(s / c)
}

/// Sine and cosine of the same angle.
#[inline(always)]
pub fn sin_cos<F: Float>(x: F) -> (F, F) {
    let (s, c) = sin_cos_wide(x);
    (F::from_double(s), F::from_double(c))
}

/// Sine and cosine of an angle within [-pi/4, pi/4], for callers that know their octant.
#[inline(always)]
pub fn sin_cos_eighth<F: Float>(x: F) -> (F, F) {
    let (s, c) = kernel_short(x.to_double());
    (F::from_double(s), F::from_double(c))
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
pub fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    if !degrees.is_finite() {
        return (f64::NAN, f64::NAN);
    }
    // The remainder of a division is exact in IEEE 754, as is the subtraction of the nearest multiple of 90.
    within_a_turn(degrees % 360.0)
}

/// [`sin_cos_degrees`] of angles from 0 to below 720 degrees, one or many side by side.
#[inline(always)]
pub fn sin_cos_two_turns<D: Double>(degrees: D) -> (D, D) {
    // As exact as a remainder.
    within_a_turn(D::select(degrees.lt(D::splat(360.0)), degrees, degrees - 360.0))
}

#[inline(always)]
fn within_a_turn<D: Double>(degrees: D) -> (D, D) {
    let (quarters, n) = round(degrees / 90.0);
    let r = (degrees - quarters * 90.0) * (PI / 180.0);
    turn(kernel(r, D::ZERO), n)
}

/// Sine and cosine to some 33 bits.
#[inline(always)]
fn sin_cos_wide<F: Float>(x: F) -> (F::Double, F::Double) {
    let is_small = x.abs().lt(F::splat(SMALL as f32));
    let x = x.to_double();
    let (whole, n) = round(x * FRAC_2_PI);
    let r = (x - whole * PIO2[0]) - whole * PIO2_REST;
    let (r, n) = if is_small.all() { (r, n) } else { reduce_lanes::<F>(!is_small.to_bits(), x, r, n) };
    turn(kernel_short(r), n)
}

/// What is left of an angle and its quarter turns, some lanes of which are reduced by [`reduce_huge`].
#[cold]
#[inline(never)]
fn reduce_lanes<F: Float>(huge: u32, x: F::Double, r: F::Double, n: F::Ulong) -> (F::Double, F::Ulong) {
    let (x, mut r, mut n) = (x.to_array(), r.to_array(), n.to_array());
    for i in 0..F::WIDTH {
        if huge >> i & 1 == 1 {
            let (rest, quarters) = reduce_huge(x.as_ref()[i]);
            (r.as_mut()[i], n.as_mut()[i]) = (rest, quarters as u64);
        }
    }
    (F::Double::from_array(r), F::Ulong::from_array(n))
}

/// Sine and cosine in double precision.
pub(super) fn sin_cos_double(x: f64) -> (f64, f64) {
    if x.abs() < SMALL {
        let (whole, n) = round(x * FRAC_2_PI);
        // a and b are exact; r + tail = a - b - c to twice the precision.
        let a = x - whole * PIO2[0];
        let b = whole * PIO2[1];
        let c = whole * PIO2[2];
        let ab = a - b;
        let bb = a - ab;
        let rest = ((a - (ab + bb)) + (bb - b)) - c;
        let r = ab + rest;
        let tail = (ab - r) + rest;
        turn(kernel(r, tail), n)
    } else {
        let (r, n) = reduce_huge(x);
        turn(kernel(r, 0.0), n as u64)
    }
}

/// Carries (sin, cos) over `n` quarter turns, modulo 2^64.
#[inline(always)]
fn turn<D: Double>((s, c): (D, D), n: D::Ulong) -> (D, D) {
    // Angles are as good as random: bit masks instead of branches that would be mispredicted.
    let (s, c) = (s.to_bits(), c.to_bits());
    let swap = (s ^ c) & D::Ulong::splat(0).wrapping_sub(n & 1);
    let sign_s = (n & 2) << 62;
    let sign_c = (n.wrapping_add(D::Ulong::splat(1)) & 2) << 62;
    (D::from_bits(s ^ swap ^ sign_s), D::from_bits(c ^ swap ^ sign_c))
}

/// Taylor series on [-pi/4, pi/4], off by at most 2e-9 of a sine and 2e-10 of a cosine.
#[inline(always)]
fn kernel_short<D: Double>(r: D) -> (D, D) {
    const S: [f64; 5] = [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0];
    const C: [f64; 6] = [1.0, -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0];
    let z = r * r;
    (r * poly(z, S), poly(z, C))
}

/// Taylor series of r + tail, |r| <= pi/4 and tail below a unit in the last place of r, to double precision.
#[inline(always)]
fn kernel<D: Double>(r: D, tail: D) -> (D, D) {
    const S: [f64; 8] = [
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 1_307_674_368_000.0,
        1.0 / 355_687_428_096_000.0,
    ];
    const C: [f64; 8] = [
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        -1.0 / 87_178_291_200.0,
        1.0 / 20_922_789_888_000.0,
        -1.0 / 6_402_373_705_728_000.0,
    ];
    let z = r * r;
    let half = z * 0.5;
    let s = r + (r * z * poly(z, S) + tail * (D::ONE - half));
    let c = D::ONE - half;
    // What 1 - z/2 lost is added back.
    let c = c + (((D::ONE - c) - half) + (z * z * poly(z, C) - r * tail));
    (D::select(r.eq(D::ZERO), r, s), c)
}

/// x modulo pi/2 and the count of quarter turns (modulo 4), for any |x| >= 2^20 (Payne and Hanek 1983, "Radian
/// Reduction for Trigonometric Functions"): only those bits of 2/pi are multiplied that are worth neither a
/// multiple of 4 nor too little. NaN for infinities.
#[cold]
fn reduce_huge(x: f64) -> (f64, i64) {
    if !x.is_finite() {
        return (f64::NAN, 0);
    }
    let bits = x.abs().to_bits();
    let mantissa = (bits & ((1 << 52) - 1)) | (1 << 52);
    let exponent = (bits >> 52) as i64 - 1075;
    // The first bit of 2/pi that counts is worth 2 once multiplied by 2^exponent.
    let first = exponent - 2;
    let word = |i: i64| {
        if i < 0 { 0 } else { TWO_OVER_PI.get(i as usize).copied().unwrap_or(0) }
    };
    let window = |k: i64| {
        let at = first + 64 * k;
        let (i, shift) = (at.div_euclid(64), at.rem_euclid(64) as u32);
        if shift == 0 { word(i) } else { (word(i) << shift) | (word(i + 1) >> (64 - shift)) }
    };
    // mantissa * window modulo 2^192, in units where 2^192 is four quarter turns.
    let m = u128::from(mantissa);
    let low = m * u128::from(window(2));
    let mid = m * u128::from(window(1)) + (low >> 64);
    let high = (m * u128::from(window(0)) + (mid >> 64)) as u64;
    let top = (u128::from(high) << 64) | u128::from(mid as u64);
    // As a signed number, the fraction of a quarter turn lies in [-1/2, 1/2).
    let fraction = ((top << 2) | u128::from((low as u64) >> 62)) as i128;
    let n = (top >> 126) as i64 + i64::from(fraction < 0);
    let unit = f64::from_bits((1023 - 128) << 52);
    let r = fraction as f64 * unit * std::f64::consts::FRAC_PI_2;
    if x < 0.0 { (-r, -n) } else { (r, n) }
}
