//! A camera at infinity.

use super::{FilmPoint, View};
use crate::footprint::Footprint;
use straal_math::{Ray, Vec3};

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

    #[inline]
    pub(super) fn ray(&self, at: &FilmPoint) -> Ray {
        let [x, y] = at.position;
        Ray { time: at.time, ..Ray::new(self.corner + self.dx * x + self.dy * y, self.forward) }
    }

    pub(super) fn footprint(&self) -> Footprint {
        Footprint { o: [self.dx, self.dy], ..Footprint::NONE }
    }
}
