//! Rays.

use crate::Vec3;

/// A half-open piece of a line, o + t d for `t_min` <= t <= `t_max`, at one moment of time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Origin.
    pub o: Vec3,
    /// Least t that counts as a hit; a search takes what is below 0 for 0.
    pub t_min: f32,
    /// Direction; not necessarily of length 1 (instances transform it without renormalising).
    pub d: Vec3,
    /// Largest t that counts as a hit.
    pub t_max: f32,
    /// Moment, 0 to 1 over the shutter.
    pub time: f32,
    /// What the ray can see: a primitive is visible if its mask shares a bit with this.
    pub mask: u32,
}

impl Ray {
    /// The whole half-line from `o` along `d`, at time 0, seeing everything.
    #[inline]
    pub const fn new(o: Vec3, d: Vec3) -> Self {
        Self { o, t_min: 0.0, d, t_max: f32::INFINITY, time: 0.0, mask: u32::MAX }
    }

    /// The point o + t d.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }

    /// Whether origin and direction are finite, the direction isn't zero and the interval isn't empty: any
    /// other ray misses everything.
    #[inline]
    pub fn is_valid(&self) -> bool {
        self.o.is_finite() && self.d.is_finite() && self.d != Vec3::ZERO && self.t_min <= self.t_max
    }
}
