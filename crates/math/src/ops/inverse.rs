//! Inverse trigonometric functions.
#![allow(
    clippy::redundant_closure,
    reason = "a function that is named in place of a closure isn't inlined for sure"
)]

use super::poly;
use crate::simd::{Double, Float, Mask};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// tan(pi/8): above it an arc tangent is measured from pi/4.
const TAN_EIGHTH: f64 = 0.414_213_562_373_095_03;

/// Arc sine, in [-pi/2, pi/2]; NaN beyond [-1, 1].
#[inline(always)]
pub fn asin<F: Float>(x: F) -> F {
    let x = x.to_double();
    let (p, far) = asin_kernel(
        x.abs(),
        #[inline(always)]
        |z| asin_short(z),
    );
    let a = F::Double::select(far, F::Double::splat(FRAC_PI_2) - p * 2.0, p);
    F::from_double(a.copysign(x))
}

/// Arc cosine, in [0, pi]; NaN beyond [-1, 1].
#[inline(always)]
pub fn acos<F: Float>(x: F) -> F {
    F::from_double(acos_with(
        x.to_double(),
        #[inline(always)]
        |z| asin_short(z),
    ))
}

/// Arc tangent, in [-pi/2, pi/2].
#[inline(always)]
pub fn atan<F: Float>(x: F) -> F {
    atan2(x, F::ONE)
}

/// The angle of the point (x, y) in [-pi, pi], 0 along +x, counter-clockwise.
#[inline(always)]
pub fn atan2<F: Float>(y: F, x: F) -> F {
    F::from_double(atan2_with(
        y.to_double(),
        x.to_double(),
        #[inline(always)]
        |z| atan_short(z),
    ))
}

/// Arc cosine by a given series for (asin(s)/s - 1)/s².
#[inline(always)]
pub(super) fn acos_with<D: Double>(x: D, series: impl Fn(D) -> D) -> D {
    let (p, far) = asin_kernel(x.abs(), series);
    let is_negative = x.lt(D::ZERO);
    // Far from the middle p is half the angle to the nearer end; near it the angle from the middle.
    let base = D::select(far, D::select(is_negative, D::splat(PI), D::ZERO), D::splat(FRAC_PI_2));
    let scale = D::select(far, D::splat(-2.0), D::ONE);
    base + D::select(is_negative, scale, -scale) * p
}

/// For 0 <= a <= 1: asin(a) and false up to 1/2, beyond it asin(sqrt((1-a)/2)) = acos(a)/2 and true.
#[inline(always)]
fn asin_kernel<D: Double>(a: D, series: impl Fn(D) -> D) -> (D, D::Mask) {
    let far = a.gt(D::splat(0.5));
    let z = D::select(far, (D::ONE - a) * 0.5, a * a);
    let s = D::select(far, z.sqrt(), a);
    (s + s * z * series(z), far)
}

/// The angle of (x, y) by a given series for (atan(t)/t - 1)/t².
#[inline(always)]
pub(super) fn atan2_with<D: Double>(y: D, x: D, series: impl Fn(D) -> D) -> D {
    let (ay, ax) = (y.abs(), x.abs());
    let steep = ay.gt(ax);
    let (low, high) = (D::select(steep, ax, ay), D::select(steep, ay, ax));
    let is_plain = high.lt(D::splat(4e307)) & high.gt(D::ZERO);
    let (low, high) = if is_plain.all() { (low, high) } else { atan2_lanes(!is_plain.to_bits(), low, high) };
    // The angle of (high, low) in [0, pi/4], from 0 or from pi/4, with one division.
    let from_diagonal = low.gt(high * TAN_EIGHTH);
    let n = D::select(from_diagonal, low - high, low);
    let d = D::select(from_diagonal, low + high, high);
    let t = n / d;
    let z = t * t;
    let base = D::select(from_diagonal, D::splat(FRAC_PI_4), D::ZERO);
    let a = base + (t + t * z * series(z));
    let a = D::select(steep, D::splat(FRAC_PI_2) - a, a);
    let a = D::select(x.is_sign_negative(), D::splat(PI) - a, a);
    a.copysign(y)
}

/// [`atan2_special`] in some lanes.
#[cold]
#[inline(never)]
fn atan2_lanes<D: Double>(lanes: u32, low: D, high: D) -> (D, D) {
    let (mut low, mut high) = (low.to_array(), high.to_array());
    for (i, (low, high)) in low.as_mut().iter_mut().zip(high.as_mut()).enumerate() {
        if lanes >> i & 1 == 1 {
            (*low, *high) = atan2_special(*low, *high);
        }
    }
    (D::from_array(low), D::from_array(high))
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
fn asin_short<D: Double>(z: D) -> D {
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
pub(super) fn asin_long<D: Double>(z: D) -> D {
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
fn atan_short<D: Double>(z: D) -> D {
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
pub(super) fn atan_long<D: Double>(z: D) -> D {
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
