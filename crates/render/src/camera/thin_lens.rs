//! A thin lens.

use super::perspective::ViewPlane;
use super::{FilmPoint, Iris, View, Window, turned};
use crate::footprint::Footprint;
use straal_math::{Ray, Vec3};

/// A lens without thickness or faults: of all light that leaves a point of the plane in focus, every place on the lens sends
/// the same to one point of the film. So the ray of a place on the film goes from any place on the lens to where the pinhole's
/// ray meets that plane (Cook et al. 1984, "Distributed Ray Tracing").
///
/// A point at distance z, along the view, is spread over a circle in the plane in focus at distance f, of radius
/// r |z - f| / z for a lens of radius r.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinLens {
    /// The middle of the lens.
    middle: Vec3,
    right: Vec3,
    up: Vec3,
    pub(super) plane: ViewPlane,
    iris: Iris,
    /// Distance of the plane in focus along the view.
    focus: f32,
}

impl ThinLens {
    /// `focus` is the distance along the view of what is sharp.
    pub fn new(view: &View, window: &Window, iris: Iris, focus: f64) -> Self {
        Self {
            middle: view.eye.as_vec3(),
            right: view.right.as_vec3(),
            up: view.up.as_vec3(),
            plane: ViewPlane::new(view, window),
            iris,
            focus: focus as f32,
        }
    }

    /// What opening light passes.
    pub fn iris(&self) -> &Iris {
        &self.iris
    }

    /// Distance of the plane in focus along the view.
    pub fn focus(&self) -> f32 {
        self.focus
    }

    #[inline]
    pub(super) fn ray(&self, at: &FilmPoint) -> Ray {
        let [x, y] = self.iris.sample(at.lens);
        let place = self.right * x + self.up * y;
        let towards = self.plane.direction(at.position) * self.focus - place;
        Ray { time: at.time, ..Ray::new(self.middle + place, towards.normalize()) }
    }

    pub(super) fn footprint(&self, at: &FilmPoint) -> Footprint {
        let [x, y] = self.iris.sample(at.lens);
        let place = self.right * x + self.up * y;
        let towards = self.plane.direction(at.position) * self.focus - place;
        let [dx, dy] = [self.plane.dx, self.plane.dy].map(|d| d * self.focus);
        Footprint { d: turned(towards, dx, dy), ..Footprint::NONE }
    }
}
