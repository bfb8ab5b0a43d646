//! The formulas, in any number of lanes.

use super::Kind;
use crate::lanes::{Double, Mask};

/// Rays, one in each lane.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<D> {
    pub o: [D; 3],
    pub d: [D; 3],
    pub t_min: D,
    /// Finite.
    pub t_max: D,
}

/// What each lane's ray meets. Numbers are of no use where nothing is hit.
#[derive(Clone, Copy)]
pub(crate) struct Met<D: Double> {
    pub is_hit: D::Mask,
    /// Rounded to single precision.
    pub t: D,
    /// Still to be rounded.
    pub u: D,
    pub v: D,
}

impl<D: Double> Met<D> {
    /// No lane meets anything.
    #[inline(always)]
    fn nothing(r: &Lanes<D>) -> Self {
        let zero = r.t_min.splat(0.0);
        // Zero isn't below itself.
        Self { is_hit: zero.below(zero), t: zero, u: zero, v: zero }
    }
}

/// The hit with the least t of each lane's ray with each lane's shape; `n` gives the numbers of the shapes, all of which are of
/// one kind.
#[inline(always)]
pub(crate) fn meet<D: Double>(kind: Kind, n: impl Fn(usize) -> D + Copy, r: &Lanes<D>) -> Met<D> {
    match kind {
        Kind::Sphere => sphere(n, r),
        Kind::Plane => plane(n, r),
        Kind::Parallelogram => parallelogram(n, r),
        Kind::Disc => disc(n, r),
        Kind::Ellipsoid => ellipsoid(n, r),
        Kind::Cylinder => cylinder(n, r),
    }
}

type Vector<D> = [D; 3];

#[inline(always)]
fn dot<D: Double>(a: Vector<D>, b: Vector<D>) -> D {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn minus<D: Double>(a: Vector<D>, b: Vector<D>) -> Vector<D> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + b t
#[inline(always)]
fn along<D: Double>(a: Vector<D>, b: Vector<D>, t: D) -> Vector<D> {
    [a[0] + b[0] * t, a[1] + b[1] * t, a[2] + b[2] * t]
}

#[inline(always)]
fn vector<D: Double>(n: impl Fn(usize) -> D, first: usize) -> Vector<D> {
    [n(first), n(first + 1), n(first + 2)]
}

impl<D: Double> Lanes<D> {
    /// t rounded, and whether it then lies in the ray's interval; not if it is NaN.
    #[inline(always)]
    fn interval(&self, t: D) -> (D::Mask, D) {
        let t = t.rounded();
        (self.t_min.at_most(t) & t.at_most(self.t_max), t)
    }

    /// In the space that the rows of a map lead to.
    #[inline(always)]
    fn mapped(&self, n: impl Fn(usize) -> D) -> (Vector<D>, Vector<D>) {
        let linear = |v: Vector<D>, i: usize| n(4 * i) * v[0] + n(4 * i + 1) * v[1] + n(4 * i + 2) * v[2];
        let o = [linear(self.o, 0) + n(3), linear(self.o, 1) + n(7), linear(self.o, 2) + n(11)];
        (o, [linear(self.d, 0), linear(self.d, 1), linear(self.d, 2)])
    }
}

#[inline(always)]
fn sphere<D: Double>(n: impl Fn(usize) -> D + Copy, r: &Lanes<D>) -> Met<D> {
    ball(minus(r.o, vector(n, 0)), r.d, n(3), r)
}

#[inline(always)]
fn ellipsoid<D: Double>(n: impl Fn(usize) -> D + Copy, r: &Lanes<D>) -> Met<D> {
    let (o, d) = r.mapped(n);
    ball(o, d, r.t_min.splat(1.0), r)
}

/// The ball about the origin of a radius squared.
#[inline(always)]
fn ball<D: Double>(o: Vector<D>, d: Vector<D>, r2: D, r: &Lanes<D>) -> Met<D> {
    let (a, b) = (dot(d, d), -dot(o, d));
    // The distance of center and line, as a vector: r² - l² doesn't cancel as b² - a c would.
    let l = along(o, d, b / a);
    let reduced = r2 - dot(l, l);
    if is_missed(a, reduced) {
        return Met::nothing(r);
    }
    let (is_met, roots) = roots(a, b, dot(o, o) - r2, reduced);
    let ((first, t0), (second, t1)) = (r.interval(roots[0]), r.interval(roots[1]));
    let zero = r.t_min.splat(0.0);
    Met { is_hit: is_met & (first | second), t: t0.or(first, t1), u: zero, v: zero }
}

#[inline(always)]
fn cylinder<D: Double>(n: impl Fn(usize) -> D + Copy, r: &Lanes<D>) -> Met<D> {
    let (o, d) = r.mapped(n);
    let (zero, one) = (r.t_min.splat(0.0), r.t_min.splat(1.0));
    let a = d[0] * d[0] + d[2] * d[2];
    let b = -(o[0] * d[0] + o[2] * d[2]);
    let s = b / a;
    let (x, z) = (o[0] + d[0] * s, o[2] + d[2] * s);
    let reduced = one - (x * x + z * z);
    if is_missed(a, reduced) {
        return Met::nothing(r);
    }
    let (is_met, roots) = roots(a, b, o[0] * o[0] + o[2] * o[2] - one, reduced);
    let accept = |root: D| {
        let y = o[1] + root * d[1];
        let (is_within, t) = r.interval(root);
        (is_within & zero.at_most(y) & y.at_most(one), t, y)
    };
    let ((first, t0, y0), (second, t1, y1)) = (accept(roots[0]), accept(roots[1]));
    Met { is_hit: is_met & (first | second), t: t0.or(first, t1), u: zero, v: y0.or(first, y1) }
}

/// The roots of a t² - 2 b t + c = 0 in ascending order, given the discriminant's `reduced` form (b² - a c) / a that
/// each caller computes without cancellation; not where there is none, or the line only touches.
///
/// c / q keeps the small root exact where b - s would cancel (Haines, Günther & Akenine-Möller 2019, "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7).
#[inline(always)]
fn roots<D: Double>(a: D, b: D, c: D, reduced: D) -> (D::Mask, [D; 2]) {
    let zero = a.splat(0.0);
    let q = b + (a * reduced).root().with_sign(b);
    let (t0, t1) = (c / q, q / a);
    let is_first = t0.below(t1);
    // Written so that NaN fails.
    (zero.below(reduced) & zero.below(a), [t0.or(is_first, t1), t1.or(is_first, t0)])
}

/// Whether no lane has roots: a square root and two divisions are saved then, and most rays that cross a box pass by what is inside.
#[inline(always)]
fn is_missed<D: Double>(a: D, reduced: D) -> bool {
    let zero = a.splat(0.0);
    (zero.below(reduced) & zero.below(a)).bits() == 0
}

/// Where the line meets the plane through `c` with normal `n`, in lengths of the line's direction; not finite when it
/// is parallel.
#[inline(always)]
fn plane_at<D: Double>(c: Vector<D>, n: Vector<D>, r: &Lanes<D>) -> D {
    dot(minus(c, r.o), n) / dot(r.d, n)
}

#[inline(always)]
fn plane<D: Double>(n: impl Fn(usize) -> D + Copy, r: &Lanes<D>) -> Met<D> {
    let (is_hit, t) = r.interval(plane_at(vector(n, 0), vector(n, 3), r));
    let zero = r.t_min.splat(0.0);
    Met { is_hit, t, u: zero, v: zero }
}

/// Where the ray meets the plane of a patch in its interval, and x and y there.
#[inline(always)]
fn patch<D: Double>(n: impl Fn(usize) -> D + Copy, r: &Lanes<D>) -> Met<D> {
    let origin = vector(n, 0);
    let t = plane_at(origin, vector(n, 3), r);
    let (is_hit, rounded) = r.interval(t);
    let at = minus(along(r.o, r.d, t), origin);
    Met { is_hit, t: rounded, u: dot(at, vector(n, 6)), v: dot(at, vector(n, 9)) }
}

#[inline(always)]
fn parallelogram<D: Double>(n: impl Fn(usize) -> D + Copy, r: &Lanes<D>) -> Met<D> {
    let met = patch(n, r);
    let (zero, one) = (r.t_min.splat(0.0), r.t_min.splat(1.0));
    let inside = |x: D| zero.at_most(x) & x.at_most(one);
    Met { is_hit: met.is_hit & inside(met.u) & inside(met.v), ..met }
}

#[inline(always)]
fn disc<D: Double>(n: impl Fn(usize) -> D + Copy, r: &Lanes<D>) -> Met<D> {
    let met = patch(n, r);
    let (x, y) = (met.u, met.v);
    Met { is_hit: met.is_hit & (x * x + y * y).at_most(r.t_min.splat(1.0)), ..met }
}
