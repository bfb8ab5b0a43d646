//! # Mirror
//!
//! Reflects light in one direction. The share is the same at every angle: an ideal, where a real mirror is a conductor. Or it grows
//! to all of the light at grazing angles, as Schlick (1994) has it ([`super::SchlickMirror`]).

use straal_color::Light;
use straal_math::Vec3;
use straal_scene::desc;

use super::{Bsdf, BsdfSample, Recipe, Scatter, SchlickMirror, Transport, Wants, facing};
use crate::error::CompileError;
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

    fn of(d: &desc::Mirror, paint: &mut Paint<'_>) -> Result<Self, CompileError> {
        Ok(Self {
            reflectance: paint.reflectance(&d.reflectance)?,
            schlick: d.fresnel == desc::MirrorFresnel::Schlick,
            two_sided: d.two_sided,
        })
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

/// A perfect mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Share of light that is reflected.
    pub reflectance: Light,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Scatter for Mirror {
    #[inline]
    fn sample(&self, wo: Vec3, _: f32, _: [f32; 2], _: Transport) -> Option<BsdfSample> {
        facing(wo, self.two_sided)?;
        Some(reflected(wo, self.reflectance, 1.0))
    }

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
pub(super) fn reflected(wo: Vec3, weight: Light, pdf: f32) -> BsdfSample {
    let wi = Vec3::new(-wo.x, -wo.y, wo.z);
    BsdfSample { wi, weight, pdf, delta: true, transmitted: false, eta: 1.0, wavelength: 0.0 }
}
