//! A bounding sphere.

use super::{EachPoint, line::Line, padding};
use straal_math::{Bounds, DVec3};

pub(super) struct Sphere {
    center: DVec3,
    radius: f64,
}

impl Sphere {
    /// Around the middle of the box, as far as the farthest point. (The least sphere has another centre, but is hardly
    /// ever smaller by much.)
    pub fn around(bounds: &Bounds, points: &EachPoint<'_>) -> Self {
        let center = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
        let mut farthest = 0.0;
        points(&mut |p| {
            let squared = (p - center).length_squared();
            if squared > farthest {
                farthest = squared;
            }
        });
        Self { center, radius: farthest.sqrt() + padding(bounds) }
    }

    /// Whether the line's distance from the centre is at most the radius, and the sphere between start and `limit`.
    #[inline(always)]
    pub fn meets(&self, line: &Line, limit: f32) -> bool {
        let Some(margin) = line.margin(self.center, self.radius) else { return true };
        let radius = self.radius + margin;
        let moment = (self.center - line.o).cross(line.d);
        moment.length_squared() <= radius * radius * line.d.length_squared()
            && line.passes(self.center, |_| radius, limit)
    }

    /// Half the surface: 2 pi r^2.
    pub fn half_area(&self) -> f64 {
        2.0 * std::f64::consts::PI * self.radius * self.radius
    }

    /// A volume that isn't finite lets every ray pass.
    pub fn contains(&self, p: DVec3) -> bool {
        !self.radius.is_finite() || (p - self.center).length() <= self.radius
    }
}
