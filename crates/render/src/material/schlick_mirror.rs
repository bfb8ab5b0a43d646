//! A mirror whose share grows towards grazing angles, of which [`super::MirrorMaterial`] is made where it says so.

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::Float;

use super::many::{self, Lobe, These, is_lobe};
use super::{BsdfSample, Scatter, Transport, facing_or_zero, fresnel, mirror::reflected};

/// A mirror that reflects R + (1 - R) (1 - cos)^5 (Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering", eq. 15).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SchlickMirror<F: Float = f32> {
    /// Share of light that is reflected straight on.
    pub reflectance: Light<F>,
    /// To what it grows: 1 in all lanes that carry light.
    pub most: Light<F>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: F::Mask,
}

impl<F: Float> Lobe<F> for SchlickMirror<F> {
    type One = SchlickMirror;

    #[inline(always)]
    fn gather(these: impl These<SchlickMirror>) -> Self {
        Self {
            reflectance: many::light(these, |m: &SchlickMirror| m.reflectance),
            most: many::light(these, |m: &SchlickMirror| m.most),
            two_sided: many::which::<_, F>(these, |m: &SchlickMirror| m.two_sided),
        }
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, _: F, _: [F; 2], _: Transport) -> (BsdfSample<F>, F::Mask) {
        let share = self.reflectance.map(
            #[inline(always)]
            |r| fresnel::schlick(r, wo.z.abs()),
        );
        (reflected(wo, self.most * share, F::ONE), facing_or_zero(wo, self.two_sided).ne(F::ZERO))
    }
}

impl Scatter for SchlickMirror {
    is_lobe!(SchlickMirror);

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
