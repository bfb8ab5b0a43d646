//! The few warps of shapes, in double precision where a point must be exact.

use straal_math::simd::Double;
use straal_math::{DVec3, ops, warp};

/// Sine and cosine of a whole turn times `u`.
pub(super) fn turn(u: f32) -> (f64, f64) {
    ops::sin_cos_degrees(360.0 * f64::from(u))
}

/// A point of the unit sphere, uniformly by area, to single precision.
pub(super) fn sphere(u: [f32; 2]) -> DVec3 {
    warp::uniform_sphere(u).as_dvec3()
}

/// Two unit vectors that make a right-handed frame x, y, n with a unit vector (Duff et al. 2017, "Building an
/// Orthonormal Basis, Revisited").
#[inline(always)]
pub(super) fn tangents<D: Double>(n: DVec3<D>) -> (DVec3<D>, DVec3<D>) {
    let sign = D::ONE.copysign(n.z);
    let a = D::splat(-1.0) / (sign + n.z);
    let b = n.x * n.y * a;
    let first = DVec3::new(D::ONE + sign * n.x * n.x * a, sign * b, -sign * n.x);
    (first, DVec3::new(b, sign + n.y * n.y * a, -n.y))
}
