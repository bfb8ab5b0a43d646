//! # Diffuse
//!
//! Scatters light evenly, so that it looks equally bright from everywhere (Lambert 1760): f = reflectance / pi.
//! Chalk, plaster, paper.

use std::f32::consts::FRAC_1_PI;

use straal_color::Light;
use straal_math::{Vec3, warp};
use straal_scene::desc;

use super::{Black, Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants, facing};
use crate::error::CompileError;
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// What scatters light evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseMaterial {
    /// Share of light that is reflected.
    pub reflectance: Value<Colour>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Recipe for DiffuseMaterial {
    type Described = desc::Diffuse;

    fn of(d: &desc::Diffuse, paint: &mut Paint<'_>) -> Result<Self, CompileError> {
        Ok(Self { reflectance: paint.reflectance(&d.reflectance)?, two_sided: d.two_sided })
    }

    fn wants(&self) -> Wants {
        Wants::point(self.reflectance.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let reflectance = reading.eval(&self.reflectance, at);
        if reflectance.is_black() {
            return Bsdf::Black(Black);
        }
        Bsdf::Diffuse(Diffuse { reflectance, two_sided: self.two_sided })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let of = |v: f32| Self { reflectance: Light::rgb([v; 3]).into(), two_sided: true };
        vec![(of(0.5), super::BsdfKind::Diffuse), (of(0.0), super::BsdfKind::Black)]
    }
}

/// An evenly scattering surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    /// Share of light that is reflected.
    pub reflectance: Light,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Scatter for Diffuse {
    const LOSES_BELOW: bool = true;

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Light, f32) {
        let cos = facing(wo, self.two_sided).map_or(0.0, |side| side * wi.z);
        if cos > 0.0 {
            let pdf = cos * FRAC_1_PI;
            (self.reflectance * pdf, pdf)
        } else {
            (Light::ZERO, 0.0)
        }
    }

    #[inline]
    fn sample(&self, wo: Vec3, _: f32, u: [f32; 2], _: Transport) -> Option<BsdfSample> {
        let side = facing(wo, self.two_sided)?;
        let d = warp::cosine_hemisphere(u);
        (d.z > 0.0).then_some(BsdfSample {
            wi: Vec3::new(d.x, d.y, side * d.z),
            weight: self.reflectance,
            pdf: d.z * FRAC_1_PI,
            delta: false,
            transmitted: false,
            eta: 1.0,
            wavelength: 0.0,
        })
    }

    fn albedo(&self) -> Light {
        self.reflectance
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let red = Self { reflectance: Light::rgb([0.8, 0.5, 0.2]), two_sided: true };
        let one_sided = Self { reflectance: WHITE, two_sided: false };
        vec![
            Example::new("diffuse", Bsdf::Diffuse(red)).albedo(f64::from(0.8_f32)),
            Example::new("diffuse, one-sided", Bsdf::Diffuse(one_sided)).albedo(1.0),
        ]
    }
}
