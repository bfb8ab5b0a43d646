//! An ideal pinhole.

use super::facts::degrees;
use super::{
    Camera, CameraRays, Facts, FilmPoint, FilmPoints, Iris, Sees, Setup, Shown, Sought, Stereo, ThinLens,
    View, turned,
};
use crate::footprint::Footprint;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask};
use straal_scene::desc;

/// The part of the view plane that the film sees, the plane being at distance 1 from the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Its middle, to the right of the view and above it.
    pub middle: [f64; 2],
    /// Half its width: the tangent of half the angle across, when the middle is on the view.
    pub tan_x: f64,
    /// Pixels in width and height, which are as high as wide.
    pub size: [u32; 2],
}

impl Window {
    /// One about the view.
    pub fn new(tan_x: f64, size: [u32; 2]) -> Self {
        Self { middle: [0.0; 2], tan_x, size }
    }

    /// Half its height.
    pub fn tan_y(&self) -> f64 {
        let [w, h] = self.size.map(f64::from);
        self.tan_x * h / w
    }

    /// Pixels to which a length on the view plane is magnified.
    pub fn focal_pixels(&self) -> f64 {
        f64::from(self.size[0]) / (2.0 * self.tan_x)
    }

    /// Moved by parts of its own width and height.
    pub fn shifted(self, [x, y]: [f64; 2]) -> Self {
        let middle = [self.middle[0] + 2.0 * self.tan_x * x, self.middle[1] + 2.0 * self.tan_y() * y];
        Self { middle, ..self }
    }
}

/// An ideal pinhole: a point of the film is a direction, d = x u + y v - w in the textbook's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Perspective {
    /// Where all rays start.
    pub(super) eye: Vec3,
    pub(super) plane: ViewPlane,
}

/// Directions by place on the film, not normalised: all reach the plane at distance 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewPlane {
    /// Through the picture's upper left corner, and the change with each pixel.
    corner: Vec3,
    pub dx: Vec3,
    pub dy: Vec3,
    pub window: Window,
}

impl ViewPlane {
    pub fn new(view: &View, window: &Window) -> Self {
        let [w, h] = window.size.map(f64::from);
        let ([x, y], tan_x, tan_y) = (window.middle, window.tan_x, window.tan_y());
        Self {
            corner: (view.forward + view.right * (x - tan_x) + view.up * (y + tan_y)).as_vec3(),
            dx: (view.right * (2.0 * tan_x / w)).as_vec3(),
            dy: (view.up * (-2.0 * tan_y / h)).as_vec3(),
            window: *window,
        }
    }

    #[inline(always)]
    pub fn direction<F: Float>(&self, [x, y]: [F; 2]) -> Vec3<F> {
        Vec3::uniform(self.corner) + Vec3::uniform(self.dx) * x + Vec3::uniform(self.dy) * y
    }
}

impl ViewPlane {
    /// See [`super::Camera::shows`]: through a lens at `o`, which lies `aside` of the middle over the distance of what is in focus.
    pub fn shows(&self, what: Sought, o: Vec3, aside: Vec3) -> Option<Shown> {
        let forward = self.dx.cross(self.dy).normalize();
        let way = match what {
            Sought::Point(p) => p - o,
            Sought::Direction(d) => d,
        };
        let (depth, length) = (way.dot(forward), way.length());
        let on_plane = way / depth + aside - self.corner;
        let [dx, dy] = [self.dx, self.dy].map(Vec3::length_squared);
        let cos = depth / length;
        let of_direction = 1.0 / ((dx * dy).sqrt() * cos * cos * cos);
        let density = match what {
            Sought::Point(_) => of_direction / (length * length),
            Sought::Direction(_) => of_direction,
        };
        let position = [on_plane.dot(self.dx) / dx, on_plane.dot(self.dy) / dy];
        let sound = depth > 0.0 && density.is_finite() && position.iter().all(|v| v.is_finite());
        sound.then(|| Shown { o, d: way / length, position, density })
    }
}

impl Perspective {
    /// Sees a part of the view plane.
    pub fn new(view: &View, window: &Window) -> Self {
        Self { eye: view.eye.as_vec3(), plane: ViewPlane::new(view, window) }
    }

    /// Of what a scene says: this, one with a lens, or two.
    pub(super) fn of(c: &desc::Perspective, setup: &Setup<'_>) -> Camera {
        if let Some(pair) = &c.stereo {
            return Stereo::of(c, pair, setup);
        }
        let window = Window::new(c.tan_x(setup.film, setup.size), setup.size).shifted(c.shift);
        one_eye(&setup.view, &window, lens(c, setup))
    }
}

impl Sees for Perspective {
    #[inline(always)]
    fn rays<F: Float>(&self, at: &FilmPoints<F>) -> CameraRays<F> {
        let d = self.plane.direction(at.position).normalize();
        CameraRays { o: Vec3::uniform(self.eye), d, seen: Mask::splat(true) }
    }

    const SHOWS: bool = true;

    fn shows(&self, what: Sought, _: [f32; 2]) -> Option<Shown> {
        self.plane.shows(what, self.eye, Vec3::ZERO)
    }

    fn footprint(&self, at: &FilmPoint) -> Footprint {
        let plane = &self.plane;
        Footprint { d: turned(plane.direction(at.position), plane.dx, plane.dy), ..Footprint::NONE }
    }

    fn focal_pixels(&self) -> Option<f64> {
        Some(self.plane.window.focal_pixels())
    }

    fn facts(&self) -> Facts {
        Facts { degrees: Some(degrees(&self.plane.window)), ..Facts::plain("perspective") }
    }

    #[cfg(test)]
    fn examples(view: &View, size: [u32; 2]) -> Vec<(&'static str, Camera)> {
        let window = Window::new(0.5, size).shifted([0.1, -0.2]);
        vec![("pinhole", Camera::Perspective(Self::new(view, &window)))]
    }
}

/// A pinhole, or a lens.
pub(super) fn one_eye(view: &View, window: &Window, lens: Option<(Iris, f64)>) -> Camera {
    match lens {
        None => Camera::Perspective(Perspective::new(view, window)),
        Some((iris, focus)) => Camera::ThinLens(ThinLens::new(view, window, iris, focus)),
    }
}

/// The opening, and the distance that is in focus.
pub(super) fn lens(c: &desc::Perspective, setup: &Setup<'_>) -> Option<(Iris, f64)> {
    let Some(lens) = &c.lens else { return None };
    let focus = match (&lens.focus_on, lens.focus_distance) {
        (Some(name), _) => (setup.distance)(name, &setup.at_start),
        (None, Some(distance)) => distance,
        (None, None) => c.observer.distance(),
    };
    let radius = c.lens_radius(lens, setup.film, setup.size);
    let iris = match (lens.blades, &lens.profile) {
        (Some(blades), _) => Iris::polygon(radius, blades, lens.rotation),
        (None, desc::LensProfile::Uniform) => Iris::round(radius),
        (None, desc::LensProfile::Gaussian(g)) => Iris::gaussian(radius, g.sigma),
    };
    Some((iris, focus))
}
