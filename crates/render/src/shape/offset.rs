//! Rays that leave a surface, and rays that must end before one.

use straal_math::simd::{Float, Mask};
use straal_math::{Ray, Transform, Vec3};

use super::SurfacePoint;

/// Unit roundoff of single precision.
const U: f32 = f32::EPSILON * 0.5;

/// Higham's bound of the relative error of n rounded operations, n u / (1 - n u).
const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * U;
    nu / (1.0 - nu)
}

/// Where a ray in direction `w` may start that leaves a surface at `p`, known to `p_err`, with normal `ng` (either
/// side): a point off the error box on `w`'s side (Pharr, Jakob & Humphreys 2023, section 6.8.6: the box's extent along
/// the normal, then each coordinate moved away from the surface by what its sum may have been rounded).
#[inline(always)]
pub fn offset_origin<F: Float>(p: Vec3<F>, p_err: Vec3<F>, ng: Vec3<F>, w: Vec3<F>) -> Vec3<F> {
    let d = ng.abs().dot(p_err);
    let push = ng * F::select(w.dot(ng).lt(F::ZERO), -d, d);
    Vec3::new(away(p.x, push.x), away(p.y, push.y), away(p.z, push.z))
}

/// x + o, and further: a number's distance to the next is at most EPSILON of it, and sums of subnormal size are exact.
#[inline(always)]
fn away<F: Float>(x: F, o: F) -> F {
    let y = x + o;
    F::select(o.eq(F::ZERO), y, y + (y.abs() * f32::EPSILON).copysign(o))
}

/// One end of a shadow ray: a point with its error and normal. The normal is zero where there is no surface (a point
/// light, a camera), and then the end is the point itself. Or many of them side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End<F = f32> {
    /// The point.
    pub p: Vec3<F>,
    /// Bound of the error of its coordinates.
    pub p_err: Vec3<F>,
    /// Geometric normal, either side; zero for a point in space.
    pub ng: Vec3<F>,
}

impl<F: Float> End<F> {
    /// Where a ray that leaves along `w` starts: off the surface by the error bound of the point.
    #[inline(always)]
    pub fn leave(&self, w: Vec3<F>) -> Vec3<F> {
        offset_origin(self.p, self.p_err, self.ng, w)
    }

    /// Origin and direction of [`ray_between`] this end and another.
    #[inline(always)]
    pub fn way_to(&self, to: &Self) -> [Vec3<F>; 2] {
        let way = to.p - self.p;
        self.way_from(self.leave(way), way, to)
    }

    /// Where the way from this end to another begins, at `o`, and what it is.
    #[inline(always)]
    fn way_from(&self, o: Vec3<F>, way: Vec3<F>, to: &Self) -> [Vec3<F>; 2] {
        let q = offset_origin(to.p, to.p_err + way.abs() * F::splat(gamma(8)), to.ng, -way);
        [o, q - o]
    }

    /// `yes` where the mask says so, `no` elsewhere.
    #[inline(always)]
    pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            p: Vec3::select(mask, yes.p, no.p),
            p_err: Vec3::select(mask, yes.p_err, no.p_err),
            ng: Vec3::select(mask, yes.ng, no.ng),
        }
    }

    /// The same end many times side by side.
    #[inline(always)]
    pub fn uniform(end: &End) -> Self {
        Self { p: Vec3::uniform(end.p), p_err: Vec3::uniform(end.p_err), ng: Vec3::uniform(end.ng) }
    }

    /// A point in space.
    #[inline(always)]
    pub fn in_space(p: Vec3<F>) -> Self {
        Self { p, p_err: Vec3::splat(F::ZERO), ng: Vec3::splat(F::ZERO) }
    }
}

/// An end on a triangle whose rays may leave from the smooth surface above it. Or many side by side.
#[derive(Clone, Copy, Debug)]
pub struct Raised<F: Float = f32> {
    /// The point of the triangle.
    pub end: End<F>,
    /// How far above it the smooth surface lies, on the viewer's side.
    pub bulge: Vec3<F>,
    /// Whether rays leave from there, to the viewer's side alone; else from the point.
    pub is: F::Mask,
}

/// Up to this cosine to a triangle's normal rays leave from above it, the less the steeper they are: near the horizon a triangle has
/// false shadows, and elsewhere contact with other things must stay where it is (after Cycles' `shadow_terminator_geometry_offset`).
const GRAZING: f32 = 0.1;

impl<F: Float> Raised<F> {
    /// As [`End::leave`]. Directions below the triangle start above it as well, and may meet it.
    #[inline(always)]
    pub fn leave(&self, w: Vec3<F>) -> Vec3<F> {
        let o = self.end.leave(w);
        if !self.is.any() {
            return o;
        }
        let End { p, p_err, ng } = self.end;
        let ng = Vec3::select(self.bulge.dot(ng).lt(F::ZERO), -ng, ng);
        let cos = w.dot(ng) / w.length();
        let part = (F::ONE - cos * (1.0 / GRAZING)).max(F::ZERO).min(F::ONE);
        let push = ng * ng.abs().dot(p_err) + self.bulge * part;
        let raised = Vec3::new(away(p.x, push.x), away(p.y, push.y), away(p.z, push.z));
        Vec3::select(self.is, raised, o)
    }

    /// As [`End::way_to`].
    #[inline(always)]
    pub fn way_to(&self, to: &End<F>) -> [Vec3<F>; 2] {
        let way = to.p - self.end.p;
        self.end.way_from(self.leave(way), way, to)
    }
}

impl<F: Float> From<End<F>> for Raised<F> {
    /// One that isn't.
    #[inline(always)]
    fn from(end: End<F>) -> Self {
        Self { end, bulge: Vec3::splat(F::ZERO), is: F::Mask::splat(false) }
    }
}

impl From<&SurfacePoint> for End {
    #[inline]
    fn from(s: &SurfacePoint) -> Self {
        Self { p: s.p, p_err: s.p_err, ng: s.ng }
    }
}

/// The ray from one surface to another that sees neither: `t` = 1 is its far end, its time and mask are the
/// defaults of [`Ray::new`].
///
/// Both ends are pushed off their surfaces towards each other. The far one is pushed further by gamma(8) |d| in
/// each coordinate, which covers the rounding of d = q - p (one operation) and of the few more by which a search
/// that works relative to the ray's origin places a surface near t = 1; what is left is the rounding of t itself, a few
/// units in the last place below 1.
#[inline]
pub fn ray_between(from: &End, to: &End) -> Ray {
    let [o, d] = from.way_to(to);
    Ray { t_max: FAR_END, ..Ray::new(o, d) }
}

/// Where [`ray_between`] ends.
pub(crate) const FAR_END: f32 = 1.0 - gamma(4);

/// The error bound of `m.point(p)` for a `p` known to `p_err` that also covers the way back: transforming the
/// result by the rounded inverse gives a point within the bound, seen from the world, of where it started.
///
/// Forward, a sum of four products errs by gamma(4) of the sum S of absolute values, the rounded matrix included.
/// Back, |M'| S gamma(6) is the error of the product of the two rounded matrices and of the second sum; |M| of that
/// is how large it is in the world.
pub(super) fn error_through(m: &Transform, p: Vec3, p_err: Vec3) -> Vec3 {
    let abs_rows = |a: &[[f32; 4]; 3], v: Vec3, w: f32| {
        let row =
            |i: usize| a[i][0].abs() * v.x + a[i][1].abs() * v.y + a[i][2].abs() * v.z + a[i][3].abs() * w;
        Vec3::new(row(0), row(1), row(2))
    };
    let size = abs_rows(&m.forward, p.abs(), 1.0);
    let back = abs_rows(&m.inverse, size, 1.0) * gamma(6);
    size * gamma(4) + abs_rows(&m.forward, p_err + back, 0.0) * (1.0 + gamma(6))
}
