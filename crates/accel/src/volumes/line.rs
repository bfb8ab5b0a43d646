//! The line of a ray, and how far beside it a hit can lie.

use crate::local::LocalRay;
use straal_math::DVec3;

/// What single precision does between a ray and what it hits, as a part of the distance from the ray's origin to the far end of
/// the volume. A box test lets a ray pass that is off by 17 units in the last place of single precision along each axis
/// (`slab::EXIT`, and two roundings), with reciprocals of the direction that are off by 2; the vertices that
/// `triangle.rs` moves and shears are off by 4. Across three axes that is less than 35.
const MARGIN: f64 = 64.0 * f32::EPSILON as f64;

/// By how much underflow of crossings (`slab.rs`), at 2^-149, can shift a line along directions up to [`LONGEST`].
const UNDERFLOW: f64 = 1e-28;

/// More than the error of t that comes from underflow (`triangle.rs`).
const ERROR: f64 = f64::from_bits((1023 - 98) << 52);

/// Where coordinates or directions are as large or as small as this, products of them overflow or reciprocals are cut
/// (`local.rs`), and nothing is said of the line.
const FARTHEST: f64 = 1e37;
const LONGEST: f64 = 1e15;
const SHORTEST: f64 = 1e-30;

/// A ray as volumes are tested against it.
pub(super) struct Line {
    pub o: DVec3,
    pub d: DVec3,
    /// The axis along which the direction is longest.
    axis: usize,
    t_min: f64,
    /// Whether roundings are as [`MARGIN`] says.
    sound: bool,
}

impl Line {
    #[inline(always)]
    pub fn new(r: &LocalRay) -> Self {
        let (o, d, axis) = (r.ray.o.as_dvec3(), r.ray.d.as_dvec3(), r.axes()[2]);
        let longest = d[axis].abs();
        let sound = longest > SHORTEST && longest < LONGEST;
        Self { o, d, axis, t_min: f64::from(r.ray.t_min), sound }
    }

    /// By how much a volume of that centre and radius must be grown for this line; `None` when no amount is known
    /// to do.
    #[inline(always)]
    pub fn margin(&self, center: DVec3, radius: f64) -> Option<f64> {
        let reach = (center - self.o).abs().max_element() + radius;
        (self.sound && reach < FARTHEST).then_some(reach * MARGIN + UNDERFLOW)
    }

    /// Whether what reaches from `center` by `half` in both directions along the dominant axis is between the
    /// ray's start and `limit`.
    #[inline(always)]
    pub fn passes(&self, center: DVec3, half: impl FnOnce(usize) -> f64, limit: f32) -> bool {
        let (axis, half) = (self.axis, half(self.axis));
        let cross = |x: f64| (x - self.o[axis]) / self.d[axis];
        let (a, b) = (cross(center[axis] - half), cross(center[axis] + half));
        let (near, far) = if a < b { (a, b) } else { (b, a) };
        near <= f64::from(limit) + ERROR && far + ERROR >= self.t_min
    }
}
