//! Inverse trigonometric functions.

use super::poly;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// tan(pi/8): above it an arc tangent is measured from pi/4.
const TAN_EIGHTH: f64 = 0.414_213_562_373_095_03;

/// Arc sine, in [-pi/2, pi/2]; NaN beyond [-1, 1].
#[inline]
pub fn asin(x: f32) -> f32 {
    let x = f64::from(x);
    let (p, far) = asin_kernel(x.abs(), asin_short);
    (if far { FRAC_PI_2 - 2.0 * p } else { p }).copysign(x) as f32
}

/// Arc cosine, in [0, pi]; NaN beyond [-1, 1].
#[inline]
pub fn acos(x: f32) -> f32 {
    acos_with(f64::from(x), asin_short) as f32
}

/// Arc tangent, in [-pi/2, pi/2].
#[inline]
pub fn atan(x: f32) -> f32 {
    atan2(x, 1.0)
}

/// The angle of the point (x, y) in [-pi, pi], 0 along +x, counter-clockwise.
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    atan2_with(f64::from(y), f64::from(x), atan_short) as f32
}

/// Arc cosine by a given series for (asin(s)/s - 1)/s².
#[inline(always)]
pub(super) fn acos_with(x: f64, series: impl Fn(f64) -> f64) -> f64 {
    let (p, far) = asin_kernel(x.abs(), series);
    // Far from the middle p is half the angle to the nearer end; near it the angle from the middle.
    let (base, scale) = if far {
        if x < 0.0 { (PI, -2.0) } else { (0.0, 2.0) }
    } else {
        (FRAC_PI_2, if x < 0.0 { 1.0 } else { -1.0 })
    };
    base + scale * p
}

/// For 0 <= a <= 1: asin(a) and false up to 1/2, beyond it asin(sqrt((1-a)/2)) = acos(a)/2 and true.
#[inline(always)]
fn asin_kernel(a: f64, series: impl Fn(f64) -> f64) -> (f64, bool) {
    let far = a > 0.5;
    let z = if far { 0.5 * (1.0 - a) } else { a * a };
    let s = if far { z.sqrt() } else { a };
    (s + s * z * series(z), far)
}

/// The angle of (x, y) by a given series for (atan(t)/t - 1)/t².
#[inline(always)]
pub(super) fn atan2_with(y: f64, x: f64, series: impl Fn(f64) -> f64) -> f64 {
    let (ay, ax) = (y.abs(), x.abs());
    let steep = ay > ax;
    let (mut low, mut high) = if steep { (ax, ay) } else { (ay, ax) };
    if !(high < 4e307 && high > 0.0) {
        (low, high) = atan2_special(low, high);
    }
    // The angle of (high, low) in [0, pi/4], from 0 or from pi/4, with one division.
    let from_diagonal = low > high * TAN_EIGHTH;
    let (n, d) = if from_diagonal { (low - high, low + high) } else { (low, high) };
    let t = n / d;
    let z = t * t;
    let base = if from_diagonal { FRAC_PI_4 } else { 0.0 };
    let a = base + (t + t * z * series(z));
    let a = if steep { FRAC_PI_2 - a } else { a };
    let a = if x.is_sign_negative() { PI - a } else { a };
    a.copysign(y)
}

/// Finite numbers with the same angle, for the origin, infinities and what would overflow.
#[cold]
fn atan2_special(low: f64, high: f64) -> (f64, f64) {
    if low.is_nan() || high.is_nan() {
        (f64::NAN, f64::NAN)
    } else if high == 0.0 {
        (0.0, 1.0)
    } else if high == f64::INFINITY {
        (if low == f64::INFINITY { 1.0 } else { 0.0 }, 1.0)
    } else {
        (low * 0.125, high * 0.125)
    }
}

/// (asin(sqrt(z))/sqrt(z) - 1)/z on [0, 1/4], Chebyshev interpolation, error below 2e-11.
#[inline(always)]
fn asin_short(z: f64) -> f64 {
    poly(
        z,
        [
            0.1666666666549508,
            0.07500000598830976,
            0.04464235848347945,
            0.030397634168364135,
            0.022132443144764227,
            0.019306263952688547,
            0.005443175331929123,
            0.0293052517882001,
        ],
    )
}

/// As [`asin_short`], error below 1e-18 before rounding.
#[inline(always)]
pub(super) fn asin_long(z: f64) -> f64 {
    poly(
        z,
        [
            0.16666666666666666,
            0.07500000000000118,
            0.04464285714255189,
            0.0303819444755325,
            0.022372157443499355,
            0.017352816540553255,
            0.01396378000798693,
            0.011566459664246437,
            0.009621842530506778,
            0.009319563332347104,
            0.003044870046905273,
            0.019554538003846208,
            -0.019241707598188187,
            0.029612034269949298,
        ],
    )
}

/// (atan(sqrt(z))/sqrt(z) - 1)/z on [0, tan²(pi/8)], Chebyshev interpolation, error below 2e-11.
#[inline(always)]
fn atan_short(z: f64) -> f64 {
    poly(
        z,
        [
            -0.3333333333144073,
            0.19999998917287984,
            -0.14285612511340912,
            0.11107495134432346,
            -0.09028983484413358,
            0.07135325031857727,
            -0.04043224634751892,
        ],
    )
}

/// As [`atan_short`], error below 4e-17 before rounding.
#[inline(always)]
pub(super) fn atan_long(z: f64) -> f64 {
    poly(
        z,
        [
            -0.3333333333333333,
            0.1999999999999552,
            -0.14285714284666542,
            0.11111111015256292,
            -0.09090904578121085,
            0.07692183190760651,
            -0.0666451144646022,
            0.05858148904795124,
            -0.050854496960392584,
            0.039231657085083686,
            -0.019176885636589053,
        ],
    )
}
