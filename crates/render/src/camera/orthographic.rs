//! A camera at infinity.

use super::{Camera, CameraRays, Facts, FilmPoint, FilmPoints, Sees, Setup, View};
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
