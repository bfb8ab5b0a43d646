//! A thin lens.

#[cfg(test)]
use super::Camera;
use super::facts::degrees;
use super::perspective::ViewPlane;
use super::{
    CameraRays, Facts, FilmPoint, FilmPoints, Focus, Iris, Needs, Sees, Shown, Sought, View, Window, turned,
};
use crate::footprint::Footprint;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask};

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
}

impl Sees for ThinLens {
    #[inline(always)]
    fn rays<F: Float>(&self, at: &FilmPoints<F>) -> CameraRays<F> {
        let [x, y] = self.iris.sample(at.lens);
        let place = Vec3::uniform(self.right) * x + Vec3::uniform(self.up) * y;
        let towards = self.plane.direction(at.position) * F::splat(self.focus) - place;
        let o = Vec3::uniform(self.middle) + place;
        CameraRays { o, d: towards.normalize(), seen: Mask::splat(true) }
    }

    const SHOWS: bool = true;

    fn shows(&self, what: Sought, lens: [f32; 2]) -> Option<Shown> {
        let [x, y] = self.iris.sample(lens);
        let place = self.right * x + self.up * y;
        self.plane.shows(what, self.middle + place, place / self.focus)
    }

    fn footprint(&self, at: &FilmPoint) -> Footprint {
        let [x, y] = self.iris.sample(at.lens);
        let place = self.right * x + self.up * y;
        let towards = self.plane.direction(at.position) * self.focus - place;
        let [dx, dy] = [self.plane.dx, self.plane.dy].map(|d| d * self.focus);
        Footprint { d: turned(towards, dx, dy), ..Footprint::NONE }
    }

    fn needs(&self) -> Needs {
        Needs { lens: true, ..Needs::default() }
    }

    fn focal_pixels(&self) -> Option<f64> {
        Some(self.plane.window.focal_pixels())
    }

    fn facts(&self) -> Facts {
        let (radius, distance) = (f64::from(self.iris.radius()), f64::from(self.focus));
        let window = &self.plane.window;
        // Half a pixel's width in the plane in focus, over the radius: a point at distance z is spread over
        // 2 r |z - f| / z there.
        let part = window.tan_x * distance / f64::from(window.size[0]) / radius;
        let far = if part < 1.0 { distance / (1.0 - part) } else { f64::INFINITY };
        let focus = Focus { radius, distance, sharp: [distance / (1.0 + part), far] };
        Facts { kind: "thin lens", degrees: Some(degrees(window)), focus: Some(focus) }
    }

    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        let window = Window::new(0.5, size).shifted([0.1, -0.2]);
        let lens = |iris| Camera::ThinLens(Self::new(view, &window, iris, 3.0));
        vec![
            ("round lens", lens(Iris::round(0.2))),
            ("soft lens", lens(Iris::gaussian(0.2, 0.4))),
            ("blades", lens(Iris::polygon(0.2, 5, 10.0))),
        ]
    }
}
