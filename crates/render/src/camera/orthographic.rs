//! A camera at infinity.

use super::{Camera, CameraRays, Facts, FilmPoint, FilmPoints, Sees, Setup, Shown, Sought, View};
use crate::footprint::Footprint;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask};
use straal_scene::desc;

/// Parallel rays: a point of the film is a point of a plane through the eye.
#[derive(Clone, Debug, PartialEq)]
pub struct Orthographic {
    corner: Vec3,
    dx: Vec3,
    dy: Vec3,
    forward: Vec3,
}

impl Orthographic {
    /// `width` is the picture's width in the scene's units.
    pub fn new(view: &View, width: f64, size: [u32; 2]) -> Self {
        let (w, h) = (f64::from(size[0]), f64::from(size[1]));
        let height = width * h / w;
        Self {
            corner: (view.eye - view.right * (0.5 * width) + view.up * (0.5 * height)).as_vec3(),
            dx: (view.right * (width / w)).as_vec3(),
            dy: (view.up * (-height / h)).as_vec3(),
            forward: view.forward.as_vec3(),
        }
    }

    /// Of what a scene says.
    pub(super) fn of(c: &desc::Orthographic, setup: &Setup<'_>) -> Camera {
        Camera::Orthographic(Self::new(&setup.view, c.width, setup.size))
    }
}

impl Sees for Orthographic {
    #[inline(always)]
    fn rays<F: Float>(&self, at: &FilmPoints<F>) -> CameraRays<F> {
        let [x, y] = at.position;
        let o = Vec3::uniform(self.corner) + Vec3::uniform(self.dx) * x + Vec3::uniform(self.dy) * y;
        CameraRays { o, d: Vec3::uniform(self.forward), seen: Mask::splat(true) }
    }

    const SHOWS: bool = true;

    /// Of what is infinitely far away it sees a single direction.
    fn shows(&self, what: Sought, _: [f32; 2]) -> Option<Shown> {
        let Sought::Point(p) = what else { return None };
        let (way, [dx, dy]) = (p - self.corner, [self.dx, self.dy].map(Vec3::length_squared));
        let position = [way.dot(self.dx) / dx, way.dot(self.dy) / dy];
        let (depth, density) = (way.dot(self.forward), 1.0 / (dx * dy).sqrt());
        let sound = depth > 0.0 && density.is_finite() && position.iter().all(|v| v.is_finite());
        sound.then(|| Shown { o: p - self.forward * depth, d: self.forward, position, density })
    }

    fn footprint(&self, _: &FilmPoint) -> Footprint {
        Footprint { o: [self.dx, self.dy], ..Footprint::NONE }
    }

    fn facts(&self) -> Facts {
        Facts::plain("orthographic")
    }

    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        vec![("orthographic", Camera::Orthographic(Self::new(view, 4.0, size)))]
    }
}
