//! The few warps of shapes, in double precision where a point must be exact.

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
pub(super) fn tangents(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}
