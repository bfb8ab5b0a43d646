//! Panoramas: all directions by longitude and latitude.

use super::view::Axes;
use super::{Camera, CameraRays, Facts, FilmPoint, FilmPoints, Sees, Setup, View};
use crate::footprint::Footprint;
use straal_math::simd::{Float, Mask};
use straal_math::{Vec3, ops};
use straal_scene::desc;

/// Where in the picture the ends of the latitudes are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rows {
    /// At its upper and lower edge.
    Even,
    /// In the middle of its first and last row, as [`crate::light::ImageEnvironment`] has them.
    Centered,
}

/// A camera that sees all around. A pixel at longitude l and latitude b looks in the direction
/// cos b (sin l right + cos l forward) + sin b up.
///
/// Places above the upper pole, where a filter may reach, are those across it.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    axes: Axes,
    /// Longitude of the left edge and of a pixel's width, latitude of the upper edge and of a pixel's height, in radians.
    left: f32,
    across: f32,
    top: f32,
    down: f32,
}

impl Panorama {
    /// Longitudes from left to right and latitudes from below to above, in degrees.
    pub fn new(view: &View, longitude: [f64; 2], (latitude, rows): ([f64; 2], Rows), size: [u32; 2]) -> Self {
        let [w, h] = size.map(f64::from);
        let [bottom, top] = latitude;
        // A single row has no first and last.
        let (height, above) = match rows {
            Rows::Centered if size[1] > 1 => ((top - bottom) / (h - 1.0), 0.5),
            _ => ((top - bottom) / h, 0.0),
        };
        Self {
            axes: view.into(),
            left: longitude[0].to_radians() as f32,
            across: ((longitude[1] - longitude[0]) / w).to_radians() as f32,
            top: (top + above * height).to_radians() as f32,
            down: height.to_radians() as f32,
        }
    }

    /// Of what a scene says.
    pub(super) fn of(c: &desc::Panorama, setup: &Setup<'_>) -> Camera {
        let rows = match c.rows {
            desc::PanoramaRows::Even => Rows::Even,
            desc::PanoramaRows::Centered => Rows::Centered,
        };
        Camera::Panorama(Self::new(&setup.view, c.longitude, (c.latitude, rows), setup.size))
    }
}

impl Sees for Panorama {
    #[inline(always)]
    fn rays<F: Float>(&self, at: &FilmPoints<F>) -> CameraRays<F> {
        let [x, y] = at.position;
        let (sin_l, cos_l) = ops::sin_cos(x * self.across + self.left);
        let (sin_b, cos_b) = ops::sin_cos(F::splat(self.top) - y * self.down);
        let d = self.axes.direction(sin_l * cos_b, sin_b, cos_l * cos_b);
        CameraRays { o: Vec3::uniform(self.axes.eye), d: d.normalize(), seen: Mask::splat(true) }
    }

    fn footprint(&self, at: &FilmPoint) -> Footprint {
        let [x, y] = at.position;
        let (sin_l, cos_l) = ops::sin_cos(self.left + self.across * x);
        let (sin_b, cos_b) = ops::sin_cos(self.top - self.down * y);
        let across = self.axes.direction(cos_l, 0.0, -sin_l) * (cos_b * self.across);
        let down = self.axes.direction(-sin_l * sin_b, cos_b, -cos_l * sin_b) * -self.down;
        Footprint { d: [across, down], ..Footprint::NONE }
    }

    fn facts(&self) -> Facts {
        Facts::plain("panorama")
    }

    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        let panorama = |rows| Camera::Panorama(Self::new(view, [-180.0, 180.0], ([-90.0, 90.0], rows), size));
        vec![("panorama", panorama(Rows::Even)), ("panorama for surroundings", panorama(Rows::Centered))]
    }
}
