//! Axis-aligned boxes.

use crate::{Affine, Vec3};

/// A box with faces along the axes; empty when `min` exceeds `max` on any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };

    /// The smallest box around the given points; NaN coordinates are passed over.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| b.with_point(p))
    }

    /// The smallest box around this one and a point.
    #[inline]
    pub fn with_point(self, p: Vec3) -> Self {
        Self { min: p.min(self.min), max: p.max(self.max) }
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(self, o: Self) -> Self {
        Self { min: self.min.min(o.min), max: self.max.max(o.max) }
    }

    /// What both have in common (empty when nothing).
    #[inline]
    pub fn intersection(self, o: Self) -> Self {
        Self { min: self.min.max(o.min), max: self.max.min(o.max) }
    }

    /// Whether the box holds no point.
    #[inline]
    pub fn is_empty(self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Whether both corners are finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// Midpoint.
    #[inline]
    pub fn center(self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Edge lengths.
    #[inline]
    pub fn extent(self) -> Vec3 {
        self.max - self.min
    }

    /// Half the surface area (the factor 2 cancels wherever the surface area heuristic uses it); 0 when empty.
    #[inline]
    pub fn half_area(self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// Whether the point is inside or on the surface.
    #[inline]
    pub fn contains(self, p: Vec3) -> bool {
        p.x >= self.min.x
            && p.y >= self.min.y
            && p.z >= self.min.z
            && p.x <= self.max.x
            && p.y <= self.max.y
            && p.z <= self.max.z
    }

    /// The eight corners.
    pub fn corners(self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// The box around the transformed box, rounded outwards.
    pub fn transformed(self, m: &Affine) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let mut out = Self::EMPTY;
        for c in self.corners() {
            let p = m.point(c.as_dvec3());
            let r = p.as_vec3();
            out = out.with_point(Vec3::new(r.x.next_down(), r.y.next_down(), r.z.next_down()));
            out = out.with_point(Vec3::new(r.x.next_up(), r.y.next_up(), r.z.next_up()));
        }
        out
    }

    /// Grown by `by` on each side.
    pub fn padded(self, by: Vec3) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }
}
