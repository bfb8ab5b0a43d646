//! A bounding box along an object's own axes.

use super::{EachPoint, half_area, line::Line, padding, principal};
use straal_math::{Bounds, DVec3};

pub(super) struct Oriented {
    center: DVec3,
    /// At right angles to each other, of length 1.
    axes: [DVec3; 3],
    /// Half the extent along each axis.
    half: DVec3,
    /// Distance of the corners.
    radius: f64,
}

impl Oriented {
    /// Along the principal axes of the points, or along the scene's where that box is no larger: principal axes of
    /// regular objects, such as a cube, may be anything.
    pub fn around(bounds: &Bounds, points: &EachPoint<'_>) -> Self {
        let pad = padding(bounds);
        let own = Self::along(principal::axes(points), points, pad);
        let plain = Self::along([DVec3::X, DVec3::Y, DVec3::Z], points, pad);
        if own.half_area() < plain.half_area() { own } else { plain }
    }

    fn along(axes: [DVec3; 3], points: &EachPoint<'_>, pad: f64) -> Self {
        let (mut low, mut high) = (DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY));
        points(&mut |p| {
            let p = DVec3::from_array(axes.map(|a| a.dot(p)));
            (low, high) = (low.min(p), high.max(p));
        });
        let middle = (low + high) * 0.5;
        let center = axes[0] * middle.x + axes[1] * middle.y + axes[2] * middle.z;
        // Seen along the scene's axes the box grows by no less than `pad`.
        let half = (high - low) * 0.5 + DVec3::splat(pad);
        Self { center, axes, half, radius: half.length() }
    }

    /// Whether the line passes between the three pairs of faces at once, and the box is between start and `limit`.
    #[inline(always)]
    pub fn meets(&self, line: &Line, limit: f32) -> bool {
        let Some(margin) = line.margin(self.center, self.radius) else { return true };
        let o = line.o - self.center;
        let (mut enter, mut exit) = (f64::NEG_INFINITY, f64::INFINITY);
        for (i, axis) in self.axes.iter().enumerate() {
            let (o, d, half) = (axis.dot(o), axis.dot(line.d), self.half[i] + margin);
            if d == 0.0 {
                if o.abs() > half {
                    return false;
                }
                continue;
            }
            let (a, b) = ((-half - o) / d, (half - o) / d);
            let (near, far) = if a < b { (a, b) } else { (b, a) };
            enter = if near > enter { near } else { enter };
            exit = if far < exit { far } else { exit };
        }
        let extent = |axis: usize| {
            let part = |i: usize| self.axes[i][axis].abs() * (self.half[i] + margin);
            part(0) + part(1) + part(2)
        };
        enter <= exit && line.passes(self.center, extent, limit)
    }

    pub fn half_area(&self) -> f64 {
        half_area(self.half * 2.0)
    }

    /// A volume that isn't finite lets every ray pass.
    pub fn contains(&self, p: DVec3) -> bool {
        let p = p - self.center;
        !self.radius.is_finite() || (0..3).all(|i| self.axes[i].dot(p).abs() <= self.half[i])
    }
}
