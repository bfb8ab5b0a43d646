//! Shapes that are a formula: plain numbers, and the one routine of each kind that decides whether a ray hits it, and where.
//!
//! The caller says that a shape of its own is one of these by [`crate::Shapes::analytic`], and asks the same routine
//! ([`Analytic::intersect`]) where it tests a shape by itself. So the wide tree may test many of a kind at a time (`block.rs`),
//! or one against many rays (`octet.rs`), and gives the same bits: [`forms`] is written once for any number of lanes.
//!
//! All is computed in double precision, in which what comes in is exact, so that t is right to its last bits at any distance and
//! scale.

pub(crate) mod block;
pub(crate) mod forms;
pub(crate) mod octet;

use crate::hit::ShapeHit;
use forms::{Lanes, meet};
use straal_math::{Affine, DVec3, Ray};

/// The most numbers that a shape has.
pub(crate) const NUMBERS: usize = 12;

/// What formula a shape is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// Center, radius squared.
    Sphere,
    /// A point, a normal.
    Plane,
    /// Origin, normal, and the two vectors by which a point's coordinates are told.
    Parallelogram,
    /// The same.
    Disc,
    /// Three rows of the map to the unit sphere.
    Ellipsoid,
    /// Three rows of the map to the unit cylinder.
    Cylinder,
}

impl Kind {
    /// How many numbers it takes.
    pub const fn numbers(self) -> usize {
        match self {
            Self::Sphere => 4,
            Self::Plane => 6,
            _ => NUMBERS,
        }
    }
}

/// A shape that is a formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Analytic {
    pub(crate) kind: Kind,
    pub(crate) numbers: [f64; NUMBERS],
}

/// A plane with coordinates: the point r from the origin has x = r · `dual[0]` and y = r · `dual[1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Where x and y are 0.
    pub origin: DVec3,
    /// A normal of any length.
    pub normal: DVec3,
    /// What coordinates are told by.
    pub dual: [DVec3; 2],
}

impl Analytic {
    fn new<const N: usize>(kind: Kind, parts: [DVec3; N]) -> Self {
        let mut numbers = [0.0; NUMBERS];
        for (to, part) in numbers.chunks_exact_mut(3).zip(parts) {
            to.copy_from_slice(&part.to_array());
        }
        Self { kind, numbers }
    }

    /// The sphere of a center and a radius. Its hits have no coordinates (0).
    pub fn sphere(center: DVec3, radius: f64) -> Self {
        Self::new(Kind::Sphere, [center, DVec3::new(radius * radius, 0.0, 0.0)])
    }

    /// The unbounded plane through a point with a normal of any length. Its hits have no coordinates (0).
    pub fn plane(point: DVec3, normal: DVec3) -> Self {
        Self::new(Kind::Plane, [point, normal])
    }

    /// Where x and y lie in [0, 1]; they are the hit's u and v.
    pub fn parallelogram(patch: &Patch) -> Self {
        Self::new(Kind::Parallelogram, [patch.origin, patch.normal, patch.dual[0], patch.dual[1]])
    }

    /// Where x² + y² <= 1; they are the hit's u and v.
    pub fn disc(patch: &Patch) -> Self {
        Self { kind: Kind::Disc, ..Self::parallelogram(patch) }
    }

    /// What a map carries to the unit sphere. Its hits have no coordinates (0).
    pub fn ellipsoid(to_unit: &Affine) -> Self {
        Self { kind: Kind::Ellipsoid, numbers: rows(to_unit) }
    }

    /// What a map carries to the open unit cylinder x² + z² = 1, 0 <= y <= 1. Its hits have u = 0 and v = y.
    pub fn cylinder(to_unit: &Affine) -> Self {
        Self { kind: Kind::Cylinder, numbers: rows(to_unit) }
    }

    /// The hit with the least t in [`t_min`, `t_max`] of a ray whose direction may have any length.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        // No hit is infinitely far.
        let t_min = if ray.t_min < -f32::MAX { -f32::MAX } else { ray.t_min };
        let t_max = if ray.t_max > f32::MAX { f32::MAX } else { ray.t_max };
        let lanes = Lanes {
            o: ray.o.as_dvec3().to_array(),
            d: ray.d.as_dvec3().to_array(),
            t_min: f64::from(t_min),
            t_max: f64::from(t_max),
        };
        let met = meet(self.kind, |i| self.numbers[i], &lanes);
        met.is_hit.then_some(ShapeHit { t: met.t as f32, u: met.u as f32, v: met.v as f32 })
    }
}

/// The rows of a map, one after the other.
fn rows(map: &Affine) -> [f64; NUMBERS] {
    std::array::from_fn(|i| map.rows[i / 4][i % 4])
}
