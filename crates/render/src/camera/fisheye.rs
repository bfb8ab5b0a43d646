//! Fisheyes: pictures of up to all directions in a circle.

use super::view::Axes;
use super::{Camera, CameraRays, Facts, FilmPoint, FilmPoints, Sees, Setup, View};
use crate::footprint::Footprint;
use straal_math::simd::Float;
use straal_math::{Vec3, ops};
use straal_scene::desc;

/// How the angle a to the view follows from the distance r from the middle, both relative to those of the circle's edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// a as r.
    Equidistant,
    /// sin(a/2) as r: equal areas are equal solid angles.
    Equisolid,
    /// sin(a) as r, up to 90 degrees.
    Orthographic,
    /// tan(a/2) as r, below 180 degrees.
    Stereographic,
}

/// A camera whose picture is a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Fisheye {
    axes: Axes,
    middle: [f32; 2],
    /// One over the circle's radius in pixels.
    scale: f32,
    projection: Projection,
    /// What the projection does to the largest angle: the angle itself in radians, or its function.
    edge: f32,
}

impl Fisheye {
    /// `degrees` is the angle across the circle, at most 360, and `diameter` the circle's in pixels.
    pub fn new(view: &View, (projection, degrees): (Projection, f64), diameter: f64, size: [u32; 2]) -> Self {
        let (s, c) = ops::sin_cos_degrees(0.25 * degrees);
        let edge = match projection {
            Projection::Equidistant => (0.5 * degrees).to_radians(),
            Projection::Equisolid => s,
            Projection::Orthographic => ops::sin_cos_degrees(0.5 * degrees).0,
            Projection::Stereographic => s / c,
        };
        Self {
            axes: view.into(),
            middle: size.map(|n| (0.5 * f64::from(n)) as f32),
            scale: (2.0 / diameter) as f32,
            projection,
            edge: edge as f32,
        }
    }

    /// Of what a scene says.
    pub(super) fn of(c: &desc::Fisheye, setup: &Setup<'_>) -> Camera {
        let projection = match c.projection {
            desc::FisheyeProjection::Equidistant => Projection::Equidistant,
            desc::FisheyeProjection::Equisolid => Projection::Equisolid,
            desc::FisheyeProjection::Orthographic => Projection::Orthographic,
            desc::FisheyeProjection::Stereographic => Projection::Stereographic,
        };
        let diameter = c.fov_axis.extent(setup.size.map(f64::from));
        Camera::Fisheye(Self::new(&setup.view, (projection, c.fov), diameter, setup.size))
    }
}

impl Sees for Fisheye {
    #[inline(always)]
    fn rays<F: Float>(&self, at: &FilmPoints<F>) -> CameraRays<F> {
        let x = (at.position[0] - self.middle[0]) * self.scale;
        let y = (F::splat(self.middle[1]) - at.position[1]) * self.scale;
        let r = (x * x + y * y).sqrt();
        let q = r * self.edge;
        let rest = F::ONE - q * q;
        let (sin, cos) = match self.projection {
            Projection::Equidistant => ops::sin_cos(q),
            // By the half angle's sine or tangent q: sin a = 2 sin(a/2) cos(a/2), cos a = 1 - 2 sin(a/2)².
            Projection::Equisolid => (q * 2.0 * ops::max(rest, F::ZERO).sqrt(), F::ONE - q * 2.0 * q),
            Projection::Orthographic => (q, ops::max(rest, F::ZERO).sqrt()),
            Projection::Stereographic => {
                let n = F::ONE / (q * q + 1.0);
                (q * 2.0 * n, rest * n)
            }
        };
        let across = F::select(r.gt(F::ZERO), sin / r, F::ZERO);
        let d = self.axes.direction(x * across, y * across, cos);
        CameraRays { o: Vec3::uniform(self.axes.eye), d: d.normalize(), seen: !r.gt(F::ONE) }
    }

    /// Outwards the angle a to the view grows by da/dr, and about the view a step is as long as sin a / r.
    fn footprint(&self, at: &FilmPoint) -> Footprint {
        let x = (at.position[0] - self.middle[0]) * self.scale;
        let y = (self.middle[1] - at.position[1]) * self.scale;
        let r = (x * x + y * y).sqrt();
        if r > 1.0 {
            return Footprint::NONE;
        }
        let q = r * self.edge;
        // At the edge of half a sphere, or of a whole one, the angle grows without bound.
        let rest = ops::max(1.0 - q * q, 1e-6).sqrt();
        let (growth, sin, cos) = match self.projection {
            Projection::Equidistant => {
                let (sin, cos) = ops::sin_cos(q);
                (1.0, sin, cos)
            }
            Projection::Equisolid => (2.0 / rest, 2.0 * q * rest, 1.0 - 2.0 * q * q),
            Projection::Orthographic => (1.0 / rest, q, rest),
            Projection::Stereographic => {
                let n = 1.0 / (1.0 + q * q);
                (2.0 * n, 2.0 * q * n, (1.0 - q * q) * n)
            }
        };
        let outwards = growth * self.edge * self.scale;
        let (out, about) =
            if r > 0.0 { (([x / r, y / r]), sin / r * self.scale) } else { ([1.0, 0.0], outwards) };
        let radial = self.axes.direction(out[0] * cos, out[1] * cos, -sin) * outwards;
        let round = self.axes.direction(-out[1], out[0], 0.0) * about;
        let d = [radial * out[0] - round * out[1], -(radial * out[1] + round * out[0])];
        Footprint { d, ..Footprint::NONE }
    }

    fn facts(&self) -> Facts {
        Facts::plain("fisheye")
    }

    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        let fisheye =
            |projection, degrees| Camera::Fisheye(Self::new(view, (projection, degrees), 100.0, size));
        vec![
            ("equidistant", fisheye(Projection::Equidistant, 360.0)),
            ("equisolid", fisheye(Projection::Equisolid, 360.0)),
            ("orthographic fisheye", fisheye(Projection::Orthographic, 180.0)),
            ("stereographic", fisheye(Projection::Stereographic, 300.0)),
        ]
    }
}
