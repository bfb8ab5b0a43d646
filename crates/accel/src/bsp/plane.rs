//! A plane at any angle: on which side of it primitives lie, and where a ray is on which side.
//!
//! # Exactness
//! `partition.rs` relies on crossings that are monotone in the plane's coordinate. For a plane at an angle there is
//! no such thing, so that errors have to be bounded. The plane is *defined* by its rounded numbers in double
//! precision: f(x) = n x - d. Let the ray be x(t) = o + t D with D = 1 / `inv`, the direction that box tests go by.
//!
//! At its moment m (see `partition.rs`) the ray is, on each axis, within `SLACK` |m D| of the primitive's box: the
//! crossing (b - o) `inv` takes two roundings, `slab` moves an exit by 16 units in the last place, and where the
//! crossing is so small that it loses digits it is off by less than 2^-148. So if f >= 0 in all of the box,
//!
//! f(x(m)) >= -(`SLACK` |m| + 2^-140) G, with G the sum of |n_i D_i|.
//!
//! The front child gets the t with h(t) = f(x(t)) + (`SLACK` |t| + 2^-140) G + r >= 0, in which r bounds the
//! roundings of f in double precision, and the back child those with the sign of f turned. Where f >= 0 in the box
//! the moment is among the former, where f <= 0 among the latter. A primitive of which neither is certain is in both
//! children, and since the two h add up to something positive, its moment is with one of them. So there is a leaf
//! with the primitive that the search comes to, as in `partition.rs`, no later than t. Both h are convex, so that
//! they are negative between two points where they are negative: the interval is cut at one end or at none. (Of two
//! pieces in which h isn't negative the hull is taken.)
//!
//! Triangles are told apart by their vertices, not by their boxes. Their moment is the t of the hit, at which the ray is
//! within `SLACK` |t D| and `clip::pad` of a point of the triangle on each axis (`clip.rs`). So a triangle counts as in
//! front where f >= `pad` (|n_x| + |n_y| + |n_z|) at its vertices, and what is said above of a box holds for it, for the
//! rays within `clip::Limits`.

use crate::{
    cells::Part,
    clip,
    local::LocalRay,
    prim::{Prim, PrimKind},
};
use straal_math::{Bounds, DVec3, Vec3};

/// Where the corners of a triangle are, by its number.
pub(super) type Vertices<'a> = dyn Fn(u32) -> [Vec3; 3] + 'a;

/// As in `partition.rs`; it leaves room for the roundings of G and of f's slope.
const SLACK: f64 = 64.0 * f32::EPSILON as f64;

/// More than the relative error of sums of four products in double precision.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

/// By how much a plane must be moved to be beside what is at it, beyond [`Plane::error`].
const BESIDE: f64 = 8.0 * ROUNDING;

/// Crossings that underflow are off by less.
const TINY: f64 = f64::from_bits((1023 - 140) << 52);

/// The points x with `normal` x = `offset`; the front is where `normal` points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    /// About of unit length.
    pub normal: DVec3,
    pub offset: f64,
}

/// Where a primitive lies from a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Front,
    Back,
    /// On both sides, or nobody knows.
    Across,
}

/// A ray in double precision.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    o: DVec3,
    d: DVec3,
}

impl Line {
    #[inline]
    pub fn new(r: &LocalRay) -> Self {
        let inv = r.inv.as_dvec3();
        Self { o: r.ray.o.as_dvec3(), d: DVec3::new(1.0 / inv.x, 1.0 / inv.y, 1.0 / inv.z) }
    }
}

/// An interval of ray parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub enter: f64,
    pub exit: f64,
}

impl Part for Interval {
    #[inline(always)]
    fn between(enter: f32, exit: f32) -> Self {
        Self { enter: f64::from(enter), exit: f64::from(exit) }
    }

    #[inline(always)]
    fn is_beyond(&self, t: f32) -> bool {
        self.enter > f64::from(t)
    }
}

impl Plane {
    /// On which side a primitive is looked for.
    pub fn side_of(&self, prim: &Prim, vertices: &Vertices<'_>) -> Side {
        match prim.kind {
            PrimKind::Triangle(id) => self.side_of_triangle(&vertices(id)),
            PrimKind::Object(_) => self.side_of_box(&prim.bounds),
        }
    }

    /// The plane in which a triangle lies, moved forward by a hair, so that the triangle itself and neighbours of no
    /// more than its size that don't rise over it lie behind; `None` when its vertices don't tell a plane.
    pub fn before_triangle(v: &[Vec3; 3]) -> Option<Self> {
        let [a, b, c] = v.map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a).try_normalize()?;
        let hair = Self { normal, offset: 0.0 }.spread(clip::pad(v)) * 2.0;
        let offset = normal.dot(a) + hair;
        offset.is_finite().then_some(Self { normal, offset })
    }

    /// The planes at right angles to an axis, just before a primitive and just behind it: a triangle if its vertices are
    /// given, else what fills its box.
    pub fn beside(axis: usize, b: &Bounds, triangle: Option<&[Vec3; 3]>) -> [Self; 2] {
        let hair = triangle.map_or(0.0, |v| clip::pad(v) * 2.0);
        let (low, high) = (f64::from(b.min[axis]) - hair, f64::from(b.max[axis]) + hair);
        [Self::across(axis, low - low.abs() * BESIDE), Self::across(axis, high + high.abs() * BESIDE)]
    }

    /// The plane at right angles to an axis, its front towards the axis' end.
    pub fn across(axis: usize, at: f64) -> Self {
        let mut normal = DVec3::ZERO;
        normal[axis] = 1.0;
        Self { normal, offset: at }
    }

    /// Distance of a point, positive in front.
    #[inline]
    pub fn distance(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }

    /// Where a box lies.
    pub fn side_of_box(&self, b: &Bounds) -> Side {
        self.side(&b.corners(), 0.0)
    }

    /// Where a triangle and all its hits lie.
    pub fn side_of_triangle(&self, v: &[Vec3; 3]) -> Side {
        self.side(v, self.spread(clip::pad(v)))
    }

    /// Where the convex hull of points lies, of which a plane within `margin` isn't clear.
    fn side(&self, points: &[Vec3], margin: f64) -> Side {
        let (mut front, mut back) = (true, true);
        for p in points {
            let p = p.as_dvec3();
            let (f, error) = (self.distance(p), self.error(p) + margin);
            // What is no number is across.
            front &= f >= error;
            back &= f <= -error;
        }
        match (front, back) {
            (true, _) => Side::Front,
            (false, true) => Side::Back,
            (false, false) => Side::Across,
        }
    }

    /// How far a point's distance can change when it moves by `pad` along each axis.
    fn spread(&self, pad: f64) -> f64 {
        let n = self.normal.abs();
        (n.x + n.y + n.z) * pad
    }

    /// More than the error of [`Self::distance`].
    #[inline]
    fn error(&self, p: DVec3) -> f64 {
        (self.normal.abs().dot(p.abs()) + self.offset.abs()) * ROUNDING
    }

    /// The parts of a ray's interval in which it may be in front of the plane, and behind it.
    #[inline]
    pub fn parts(&self, line: &Line, whole: Interval) -> [Option<Interval>; 2] {
        let (at, slope) = (self.distance(line.o), self.normal.dot(line.d));
        let spread = self.normal.abs().dot(line.d.abs());
        let margin = 2.0 * self.error(line.o) + spread * TINY;
        let bend = spread * SLACK;
        [1.0, -1.0].map(|sign| part(sign * at + margin, [sign * slope - bend, sign * slope + bend], whole))
    }
}

/// The hull of the part of an interval where h(t) = base + t slope >= 0, with the first slope for t < 0 and the
/// second, the greater, for t > 0.
#[inline]
fn part(base: f64, slopes: [f64; 2], whole: Interval) -> Option<Interval> {
    let h = |t: f64| base + t * slopes[usize::from(t > 0.0)];
    let (starts, ends) = (h(whole.enter) >= 0.0, h(whole.exit) >= 0.0);
    if !starts && !ends {
        return None;
    }
    let mut out = whole;
    // h falls through 0 on one side of t = 0 and rises through 0 on one, which depends on its sign there. A root that
    // isn't a number leaves the interval as it was.
    let upwards = -base / slopes[usize::from(base < 0.0)];
    let downwards = -base / slopes[usize::from(base >= 0.0)];
    let (early, late) = (upwards - upwards.abs() * ROUNDING, downwards + downwards.abs() * ROUNDING);
    if !starts && early > out.enter {
        out.enter = early;
    }
    if !ends && late < out.exit {
        out.exit = late;
    }
    (out.enter <= out.exit).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::Ray;

    fn interval(enter: f64, exit: f64) -> Interval {
        Interval { enter, exit }
    }

    #[test]
    fn a_ray_is_cut_where_it_crosses() {
        let third = 1.0 / 3.0_f64.sqrt();
        let plane = Plane { normal: DVec3::splat(third), offset: third };
        let ray = LocalRay::new(&Ray::new(Vec3::ZERO, Vec3::splat(1.0))).unwrap();
        let [front, back] = plane.parts(&Line::new(&ray), interval(-1.0, 1.0));
        let (front, back) = (front.unwrap(), back.unwrap());
        assert!((front.enter - 1.0 / 3.0).abs() < 1e-5 && front.enter <= 1.0 / 3.0 && front.exit == 1.0);
        assert!((back.exit - 1.0 / 3.0).abs() < 1e-5 && back.exit >= 1.0 / 3.0 && back.enter == -1.0);
        let [front, back] = plane.parts(&Line::new(&ray), interval(-1.0, 0.2));
        assert!(front.is_none() && back == Some(interval(-1.0, 0.2)));
    }

    #[test]
    fn a_ray_in_the_plane_is_on_both_sides() {
        let plane = Plane::across(1, 0.5);
        let ray = LocalRay::new(&Ray::new(Vec3::new(-1.0, 0.5, 0.0), Vec3::X)).unwrap();
        // Box tests take a direction of 0 for one of 1e-37.
        let whole = interval(0.0, 1e20);
        assert_eq!(plane.parts(&Line::new(&ray), whole), [Some(whole), Some(whole)]);
    }

    #[test]
    fn sides() {
        let plane = Plane::across(2, 0.0);
        let p = |z: f32| Vec3::new(3.0, 4.0, z);
        let side = |z: &[f32]| plane.side(&z.iter().map(|&z| p(z)).collect::<Vec<_>>(), 0.0);
        assert_eq!(side(&[1.0, 2.0]), Side::Front);
        assert_eq!(side(&[-1.0, -2.0]), Side::Back);
        assert_eq!(side(&[-1.0, 2.0]), Side::Across);
        assert_eq!(side(&[f32::NAN, 2.0]), Side::Across);
        assert_eq!(plane.side_of_box(&Bounds { min: p(0.5), max: p(0.75) }), Side::Front);
    }

    #[test]
    fn planes_beside() {
        let v = [Vec3::new(1e3, 0.0, 0.0), Vec3::new(1e3, 1.0, 0.0), Vec3::new(1e3, 0.0, 1e-3)];
        let b = Bounds::of_points(v);
        for axis in 0..3 {
            let sides = |of: [Plane; 2], side: &dyn Fn(&Plane) -> Side| of.map(|p| side(&p));
            let (front, back) = (Side::Front, Side::Back);
            assert_eq!(sides(Plane::beside(axis, &b, Some(&v)), &|p| p.side_of_triangle(&v)), [front, back]);
            assert_eq!(sides(Plane::beside(axis, &b, None), &|p| p.side_of_box(&b)), [front, back]);
        }
    }

    #[test]
    fn a_polygon_and_what_does_not_rise_over_it_are_behind() {
        let v = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let plane = Plane::before_triangle(&v).unwrap();
        let neighbour = |z: f32| plane.side_of_triangle(&[Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, z)]);
        assert_eq!(plane.side_of_triangle(&v), Side::Back);
        assert_eq!([-0.1, 0.0, 0.1].map(neighbour), [Side::Back, Side::Back, Side::Across]);
        assert_eq!(plane.side_of_triangle(&v.map(|p| p + Vec3::Z)), Side::Front);
        // The box of a slanting triangle reaches through a plane that the triangle doesn't.
        let slant = [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, 1.0, 1.0)];
        let beside = slant.map(|p| p + Vec3::new(0.1, -0.1, 0.0));
        let cut = Plane::before_triangle(&slant).unwrap();
        let around = beside.iter().fold(Bounds::EMPTY, |b, &p| b.union(Bounds { min: p, max: p }));
        assert_eq!(cut.side_of_box(&around), Side::Across);
        assert_eq!(cut.side_of_triangle(&beside), Side::Front);
        assert_eq!(Plane::before_triangle(&[Vec3::X; 3]), None);
    }
}
