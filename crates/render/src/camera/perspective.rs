//! An ideal pinhole.

use super::{FilmPoint, View, turned};
use crate::footprint::Footprint;
use straal_math::{Ray, Vec3};

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

    #[inline]
    pub fn direction(&self, [x, y]: [f32; 2]) -> Vec3 {
        self.corner + self.dx * x + self.dy * y
    }
}

impl Perspective {
    /// Sees a part of the view plane.
    pub fn new(view: &View, window: &Window) -> Self {
        Self { eye: view.eye.as_vec3(), plane: ViewPlane::new(view, window) }
    }

    #[inline]
    pub(super) fn ray(&self, at: &FilmPoint) -> Ray {
        Ray { time: at.time, ..Ray::new(self.eye, self.plane.direction(at.position).normalize()) }
    }

    pub(super) fn footprint(&self, at: &FilmPoint) -> Footprint {
        let plane = &self.plane;
        Footprint { d: turned(plane.direction(at.position), plane.dx, plane.dy), ..Footprint::NONE }
    }
}
