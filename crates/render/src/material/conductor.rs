//! # Conductor
//!
//! Metal: what isn't reflected is absorbed. Polished, it is a mirror of Fresnel's reflectance; rough, its facets
//! are (GGX), and light that would bounce between them more than once is lost, so that very rough metal is a little
//! too dark.

use straal_color::Light;
use straal_math::{Vec3, ops};
use straal_scene::desc;

use super::{
    Bsdf, BsdfSample, Recipe, RoughConductor, Scatter, Transport, Wants, facing, fresnel, mirror::reflected,
};
use crate::error::CompileError;
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// A metal, polished or rough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConductorMaterial {
    /// Real part of the index of refraction, relative to the outside.
    pub eta: Colour,
    /// Imaginary part: absorption.
    pub k: Colour,
    /// GGX alpha; 0 is polished.
    pub roughness: Value<f32>,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Value<Colour>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Recipe for ConductorMaterial {
    type Described = desc::Conductor;

    fn of(d: &desc::Conductor, paint: &mut Paint<'_>) -> Result<Self, CompileError> {
        let [eta, k] = paint.metal(d)?;
        Ok(Self {
            eta,
            k,
            roughness: paint.number(&d.roughness)?,
            reflectance: paint.reflectance(&d.reflectance)?,
            two_sided: d.two_sided,
        })
    }

    fn wants(&self) -> Wants {
        Wants::point(self.roughness.varies() || self.reflectance.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let (eta, k) = (reading.light(&self.eta), reading.light(&self.k));
        let metal = Metal { eta, k, reflectance: reading.eval(&self.reflectance, at) };
        let (alpha, two_sided) = (reading.eval(&self.roughness, at), self.two_sided);
        if alpha > 0.0 {
            let rough = RoughConductor::new(metal, alpha);
            Bsdf::RoughConductor(if two_sided { rough } else { rough.one_sided() })
        } else {
            Bsdf::Conductor(Conductor { metal, two_sided })
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let super::Metal { eta, k, reflectance } = super::testing::gold();
        let of = |alpha: f32| Self {
            eta: eta.into(),
            k: k.into(),
            roughness: alpha.into(),
            reflectance: reflectance.into(),
            two_sided: true,
        };
        vec![(of(0.0), super::BsdfKind::Conductor), (of(0.1), super::BsdfKind::RoughConductor)]
    }
}

/// What metal it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Real part of the index of refraction, relative to the outside.
    pub eta: Light,
    /// Imaginary part: absorption.
    pub k: Light,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Light,
}

impl Metal {
    /// Share of light that is reflected straight back.
    pub(super) fn albedo(&self) -> Light {
        self.reflected(1.0)
    }

    /// Share of light that is reflected at an angle.
    #[inline]
    pub(super) fn reflected(&self, cos: f32) -> Light {
        self.reflectance * fresnel::conductor(ops::clamp(cos, 0.0, 1.0), self.eta, self.k)
    }
}

/// Polished metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Which.
    pub metal: Metal,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Scatter for Conductor {
    #[inline]
    fn sample(&self, wo: Vec3, _: f32, _: [f32; 2], _: Transport) -> Option<BsdfSample> {
        facing(wo, self.two_sided)?;
        Some(reflected(wo, self.metal.reflected(wo.z.abs()), 1.0))
    }

    fn albedo(&self) -> Light {
        self.metal.albedo()
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, gold, lossless};
        let polished = |metal| Bsdf::Conductor(Self { metal, two_sided: true });
        vec![
            Example::new("gold, polished", polished(gold())),
            Example::new("lossless metal, polished", polished(lossless())).albedo(1.0),
        ]
    }
}
