//! A mirror whose share grows towards grazing angles, of which [`super::MirrorMaterial`] is made where it says so.

use straal_color::Light;
use straal_math::Vec3;

use super::{BsdfSample, Scatter, Transport, facing, fresnel, mirror::reflected};

/// A mirror that reflects R + (1 - R) (1 - cos)^5 (Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering", eq. 15).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SchlickMirror {
    /// Share of light that is reflected straight on.
    pub reflectance: Light,
    /// To what it grows: 1 in all lanes that carry light.
    pub most: Light,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Scatter for SchlickMirror {
    #[inline]
    fn sample(&self, wo: Vec3, _: f32, _: [f32; 2], _: Transport) -> Option<BsdfSample> {
        facing(wo, self.two_sided)?;
        let share = self.reflectance.map(|r| fresnel::schlick(r, wo.z.abs()));
        Some(reflected(wo, self.most * share, 1.0))
    }

    fn albedo(&self) -> Light {
        self.reflectance
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let mirror = |r: f32| Self { reflectance: Light::rgb([r; 3]), most: WHITE, two_sided: true };
        vec![
            Example::new("mirror after Schlick", super::Bsdf::SchlickMirror(mirror(0.1))),
            Example::new("white mirror after Schlick", super::Bsdf::SchlickMirror(mirror(1.0))).albedo(1.0),
        ]
    }
}
