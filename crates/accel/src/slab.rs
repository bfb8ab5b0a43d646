//! Where a ray crosses a box: the arithmetic that all box tests share.
//!
//! For each axis the crossing of a plane at b is (b - o) * (1 / d), two roundings, monotone in b. A box that
//! contains another therefore never has a later entry or an earlier exit, in any rounding.

use crate::local::LocalRay;
use straal_math::{Bounds, Vec3, ops};

/// The exit is pushed out by this factor (Ize 2013, "Robust BVH Ray Traversal", section 3, gives 1 + 2 gamma(3) =
/// 1 + 3.6e-7 for the roundings of the crossing). The rest, up to 16 units in the last place, covers the roundings of the
/// sheared vertices in `triangle.rs`, which move with their distance from the origin, as a crossing does.
pub(crate) const EXIT: f32 = 1.0 + 16.0 * f32::EPSILON;

/// Where a primitive is large beside its distance, the roundings of its vertices move with its size instead: boxes grow
/// by this part of their longest edge on each side.
pub(crate) const PAD_EXTENT: f32 = 8.0 * f32::EPSILON;

/// They also grow by this part of each coordinate, so that the sum is rounded outwards.
pub(crate) const PAD_COORDINATE: f32 = f32::EPSILON;

/// The latest entry into a box that may hold a hit at `t`: boxes of parts of a triangle are computed apart from its own,
/// and rounding may put their entry behind a hit by as much as [`EXIT`] allows for exits, or by some [`UNITS`]. `t` is not
/// negative.
#[inline(always)]
pub(crate) fn loosened(t: f32) -> f32 {
    let loose = t * EXIT + UNITS;
    if loose > f32::MAX { f32::MAX } else { loose }
}

/// A few units in the last place of the smallest numbers, where roundings are no longer parts of the numbers.
const UNITS: f32 = f32::from_bits(8);

/// A primitive's own box, padded so that every hit the primitive's routine finds lies inside.
#[inline(always)]
pub(crate) fn padded(b: Bounds) -> Bounds {
    let by = b.extent().max_element() * PAD_EXTENT;
    let low = |x: f32| x - (by + x.abs() * PAD_COORDINATE);
    let high = |x: f32| x + (by + x.abs() * PAD_COORDINATE);
    Bounds {
        min: Vec3::new(low(b.min.x), low(b.min.y), low(b.min.z)),
        max: Vec3::new(high(b.max.x), high(b.max.y), high(b.max.z)),
    }
}

/// The padded box of a triangle.
#[inline(always)]
pub(crate) fn triangle_bounds(v: &[Vec3; 3]) -> Bounds {
    padded(Bounds { min: v[0].min(v[1]).min(v[2]), max: v[0].max(v[1]).max(v[2]) })
}

/// The entry into a box when the ray crosses it within its interval.
#[inline(always)]
pub(crate) fn entry(b: &Bounds, r: &LocalRay) -> Option<f32> {
    let planes = [[b.min.x, b.max.x], [b.min.y, b.max.y], [b.min.z, b.max.z]];
    let near = |i: usize| (planes[i][usize::from(r.neg[i] & 1)] - r.ray.o[i]) * r.inv[i];
    let far = |i: usize| (planes[i][usize::from(r.neg[i] & 1 ^ 1)] - r.ray.o[i]) * r.inv[i];
    let enter = ops::max(ops::max(near(0), near(1)), near(2));
    let exit = ops::min(ops::min(far(0), far(1)), far(2)) * EXIT;
    (ops::max(enter, r.ray.t_min) <= ops::min(exit, r.ray.t_max)).then_some(enter)
}
