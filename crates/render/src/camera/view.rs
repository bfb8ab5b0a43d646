//! Where an observer stands and looks.

use straal_math::simd::Float;
use straal_math::{Affine, DVec3, Vec3, ops};

/// An orthonormal frame at the eye: the textbook's u, v and -w.
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
    /// From the origin along -z, with y up.
    pub const ORIGIN: Self =
        Self { right: DVec3::X, up: DVec3::Y, forward: DVec3::new(0.0, 0.0, -1.0), eye: DVec3::ZERO };

    /// `None` when eye and target coincide or `up` is along the view.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<Self> {
        let m = Affine::look_at(eye, target, up)?;
        Some(Self { right: m.vector(DVec3::X), up: m.vector(DVec3::Y), forward: m.vector(-DVec3::Z), eye })
    }

    /// With left and right exchanged in the picture.
    pub fn mirrored(self) -> Self {
        Self { right: -self.right, ..self }
    }

    /// Turned about the view by an angle in degrees, clockwise for who stands behind the camera.
    pub fn rolled(self, degrees: f64) -> Self {
        if degrees == 0.0 {
            return self;
        }
        let (s, c) = ops::sin_cos_degrees(degrees);
        Self { right: self.right * c - self.up * s, up: self.up * c + self.right * s, ..self }
    }
}

/// The same in single precision, as rays are made of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axes {
    pub right: Vec3,
    pub up: Vec3,
    pub forward: Vec3,
    pub eye: Vec3,
}

impl From<&View> for Axes {
    fn from(v: &View) -> Self {
        Self {
            right: v.right.as_vec3(),
            up: v.up.as_vec3(),
            forward: v.forward.as_vec3(),
            eye: v.eye.as_vec3(),
        }
    }
}

impl Axes {
    /// The direction with these components, not normalised.
    #[inline(always)]
    pub fn direction<F: Float>(&self, right: F, up: F, forward: F) -> Vec3<F> {
        Vec3::uniform(self.right) * right
            + Vec3::uniform(self.up) * up
            + Vec3::uniform(self.forward) * forward
    }
}
