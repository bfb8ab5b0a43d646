//! Cameras: from a position on the film to a ray.

use straal_math::{DVec3, Ray, Vec3};

/// What a camera ray is made from.
#[derive(Clone, Copy, Debug)]
pub struct FilmPoint {
    /// Position on the whole picture in pixels, x to the right, y down.
    pub position: [f32; 2],
}

/// A camera of a picture of known size.
#[derive(Clone, Debug, PartialEq)]
pub enum Camera {
    /// All rays start at one point.
    Perspective(Perspective),
    /// All rays are parallel.
    Orthographic(Orthographic),
}

impl Camera {
    /// The ray through a point of the film; its direction has length 1.
    #[inline]
    pub fn ray(&self, at: FilmPoint) -> Ray {
        match self {
            Self::Perspective(c) => c.ray(at),
            Self::Orthographic(c) => c.ray(at),
        }
    }
}

impl Camera {
    /// Pixels to which a length on a plane at distance 1 is magnified, for cameras that magnify by distance alone.
    pub fn focal_pixels(&self) -> Option<f64> {
        match self {
            Self::Perspective(c) => Some(1.0 / f64::from(c.dx.length())),
            Self::Orthographic(_) => None,
        }
    }
}

/// Where an observer stands and looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// To the right in the picture, unit length.
    pub right: DVec3,
    /// Upwards in the picture, unit length.
    pub up: DVec3,
    /// The way the camera looks, unit length.
    pub forward: DVec3,
    /// The place it looks from.
    pub eye: DVec3,
}

impl View {
    /// `None` when eye and target coincide or `up` is along the view.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<Self> {
        let m = straal_math::Affine::look_at(eye, target, up)?;
        Some(Self { right: m.vector(DVec3::X), up: m.vector(DVec3::Y), forward: m.vector(-DVec3::Z), eye })
    }
}

/// An ideal pinhole: a point of the film is a direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Perspective {
    eye: Vec3,
    /// Direction (not normalised) through the picture's upper left corner, and its change with each pixel.
    corner: Vec3,
    dx: Vec3,
    dy: Vec3,
}

impl Perspective {
    /// `tan_x` is the tangent of half the horizontal field of view.
    pub fn new(view: &View, tan_x: f64, size: [u32; 2]) -> Self {
        let (w, h) = (f64::from(size[0]), f64::from(size[1]));
        let tan_y = tan_x * h / w;
        Self {
            eye: view.eye.as_vec3(),
            corner: (view.forward - view.right * tan_x + view.up * tan_y).as_vec3(),
            dx: (view.right * (2.0 * tan_x / w)).as_vec3(),
            dy: (view.up * (-2.0 * tan_y / h)).as_vec3(),
        }
    }

    #[inline]
    fn ray(&self, at: FilmPoint) -> Ray {
        let [x, y] = at.position;
        Ray::new(self.eye, (self.corner + self.dx * x + self.dy * y).normalize())
    }
}

/// A camera at infinity: a point of the film is a point of a plane through the eye.
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
    fn ray(&self, at: FilmPoint) -> Ray {
        let [x, y] = at.position;
        Ray::new(self.corner + self.dx * x + self.dy * y, self.forward)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        View::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y).unwrap()
    }

    #[test]
    fn perspective_frames_its_field_of_view() {
        let c = Perspective::new(&view(), 0.5, [200, 100]);
        let d = c.ray(FilmPoint { position: [100.0, 50.0] }).d;
        assert!((d + Vec3::Z).length() < 1e-6);
        let right = c.ray(FilmPoint { position: [200.0, 50.0] }).d;
        assert!((right.x / -right.z - 0.5).abs() < 1e-6);
        let top = c.ray(FilmPoint { position: [100.0, 0.0] }).d;
        assert!((top.y / -top.z - 0.25).abs() < 1e-6);
    }

    #[test]
    fn orthographic_rays_are_parallel_and_as_wide_as_told() {
        let c = Orthographic::new(&view(), 4.0, [200, 100]);
        let (a, b) =
            (c.ray(FilmPoint { position: [0.0, 50.0] }), c.ray(FilmPoint { position: [200.0, 50.0] }));
        assert_eq!(a.d, b.d);
        assert!((b.o - a.o - Vec3::X * 4.0).length() < 1e-6);
    }
}
