//! # Mirror
//!
//! Reflects light in one direction. The share is the same at every angle: an ideal, where a real mirror is a conductor. Or it grows
//! to all of the light at grazing angles, as Schlick (1994) has it ([`super::SchlickMirror`]).

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask};
use straal_scene::desc;

use super::many::{self, Lobe, These, is_lobe};
use super::{Bsdf, BsdfSample, Recipe, Scatter, SchlickMirror, Transport, Wants, facing_or_zero};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// What is a perfect mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorMaterial {
    /// Share of light that is reflected; with `schlick`, straight on.
    pub reflectance: Value<Colour>,
    /// Whether the share grows towards grazing angles, as Schlick has it.
    pub schlick: bool,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Recipe for MirrorMaterial {
    type Described = desc::Mirror;

    fn of(d: &desc::Mirror, paint: &mut Paint<'_>) -> Self {
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            schlick: d.fresnel == desc::MirrorFresnel::Schlick,
            two_sided: d.two_sided,
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.reflectance.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let (reflectance, two_sided) = (reading.eval(&self.reflectance, at), self.two_sided);
        if self.schlick {
            return Bsdf::SchlickMirror(SchlickMirror { reflectance, most: reading.lanes.full(), two_sided });
        }
        Bsdf::Mirror(Mirror { reflectance, two_sided })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let of = |schlick| Self { reflectance: super::testing::WHITE.into(), schlick, two_sided: true };
        vec![(of(false), super::BsdfKind::Mirror), (of(true), super::BsdfKind::SchlickMirror)]
    }
}

/// A perfect mirror, or many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror<F: Float = f32> {
    /// Share of light that is reflected.
    pub reflectance: Light<F>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: F::Mask,
}

impl<F: Float> Lobe<F> for Mirror<F> {
    type One = Mirror;

    #[inline(always)]
    fn gather(these: impl These<Mirror>) -> Self {
        Self {
            reflectance: many::light(these, |m: &Mirror| m.reflectance),
            two_sided: many::which::<_, F>(these, |m: &Mirror| m.two_sided),
        }
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, _: F, _: [F; 2], _: Transport) -> (BsdfSample<F>, F::Mask) {
        (reflected(wo, self.reflectance, F::ONE), facing_or_zero(wo, self.two_sided).ne(F::ZERO))
    }
}

impl Scatter for Mirror {
    is_lobe!(Mirror);

    fn albedo(&self) -> Light {
        self.reflectance
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let mirror = |two_sided| Bsdf::Mirror(Self { reflectance: WHITE, two_sided });
        vec![
            Example::new("mirror", mirror(true)).albedo(1.0),
            Example::new("mirror, one-sided", mirror(false)).albedo(1.0),
        ]
    }
}

/// The delta lobe of a mirror: chosen with probability `pdf`, its coefficient divided by that is `weight`.
#[inline(always)]
pub(super) fn reflected<F: Float>(wo: Vec3<F>, weight: Light<F>, pdf: F) -> BsdfSample<F> {
    let wi = Vec3::new(-wo.x, -wo.y, wo.z);
    BsdfSample { delta: F::Mask::splat(true), ..BsdfSample::reflected(wi, weight, pdf) }
}
