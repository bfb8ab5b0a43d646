//! The few warps of shapes, in double precision where a point must be exact.

use straal_math::DVec3;

/// Sine and cosine of a whole turn times `u`.
pub(super) fn turn(u: f32) -> (f64, f64) {
    straal_math::ops::sin_cos_degrees(360.0 * f64::from(u))
}

/// A point of the unit sphere, uniformly by area (Archimedes: its height is uniform).
pub(super) fn sphere(u: [f32; 2]) -> DVec3 {
    let y = 1.0 - 2.0 * f64::from(u[0]);
    let (s, c) = turn(u[1]);
    let r = (1.0 - y * y).sqrt();
    DVec3::new(r * s, y, r * c)
}

/// Two unit vectors that make a right-handed frame x, y, n with a unit vector (Duff et al. 2017, "Building an
/// Orthonormal Basis, Revisited").
pub(super) fn tangents(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// A point of the unit disc, uniformly by area.
pub(super) fn disc(u: [f32; 2]) -> [f32; 2] {
    let (s, c) = turn(u[1]);
    let r = f64::from(u[0]).sqrt();
    [(r * s) as f32, (r * c) as f32]
}
