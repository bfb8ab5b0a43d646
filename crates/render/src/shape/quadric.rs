//! The quadratic that spheres and cylinders share.

/// The roots of a t² - 2 b t + c = 0 in ascending order, given the discriminant's `reduced` form (b² - a c) / a that
/// each caller computes without cancellation, a > 0. `None` when there is none, or the line only touches.
///
/// c / q keeps the small root exact where b - s would cancel (Haines, Günther & Akenine-Möller 2019, "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7).
#[inline]
pub(super) fn roots(a: f64, b: f64, c: f64, reduced: f64) -> Option<[f64; 2]> {
    // Written so that NaN fails.
    if !(reduced > 0.0 && a > 0.0) {
        return None;
    }
    let q = b + (a * reduced).sqrt().copysign(b);
    let (t0, t1) = (c / q, q / a);
    Some(if t0 < t1 { [t0, t1] } else { [t1, t0] })
}
