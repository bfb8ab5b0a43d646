//! # Conductor
//!
//! Metal: what isn't reflected is absorbed. Polished, it is a mirror of Fresnel's reflectance; rough, its facets
//! are (GGX), and light that would bounce between them more than once is lost, so that very rough metal is a little
//! too dark.

use straal_color::Light;
use straal_math::{Vec3, ops};

use super::{BsdfSample, facing, fresnel, ggx::Ggx, mirror::reflected};

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
    fn reflected(&self, cos: f32) -> Light {
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

impl Conductor {
    #[inline]
    pub(super) fn sample(&self, wo: Vec3) -> Option<BsdfSample> {
        facing(wo, self.two_sided)?;
        Some(reflected(wo, self.metal.reflected(wo.z.abs()), 1.0))
    }
}

/// Metal of GGX microfacets with Smith's shadowing, `wo` and `wi` shadowed independently (G = G1 G1), and facets
/// drawn as they are seen (Heitz 2018): the weight of a sample is then Fresnel's reflectance times G1(wi).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor {
    /// What the facets are made of.
    pub metal: Metal,
    facets: Ggx,
    two_sided: bool,
}

impl RoughConductor {
    /// Metal that looks the same from both sides, of GGX's `alpha` above 0, held within [10^-4, 1].
    #[inline]
    pub fn new(metal: Metal, alpha: f32) -> Self {
        Self { metal, facets: Ggx::new(alpha), two_sided: true }
    }

    /// The same, black from behind.
    #[inline]
    pub fn one_sided(self) -> Self {
        Self { two_sided: false, ..self }
    }

    #[inline]
    pub(super) fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Light, f32) {
        let Some(side) = facing(wo, self.two_sided) else { return (Light::ZERO, 0.0) };
        let (wo, wi) = (Vec3::new(wo.x, wo.y, side * wo.z), Vec3::new(wi.x, wi.y, side * wi.z));
        let h = wo + wi;
        let hh = h.length_squared();
        // Opposite directions along the surface have no half-way; f is 0 in the limit.
        if wi.z <= 0.0 || hh <= f32::MIN_POSITIVE {
            return (Light::ZERO, 0.0);
        }
        // G1(wo) D (wo.m) / cos wo is the density of facets, 4 (wo.m) the stretch of reflecting.
        let pdf = 0.5 * self.facets.density(h) * self.facets.seen_over_twice_cos(wo);
        let share = self.metal.reflected(wo.dot(h) / hh.sqrt());
        (share * (pdf * self.facets.seen(wi)), pdf)
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        let side = facing(wo, self.two_sided)?;
        let wo = Vec3::new(wo.x, wo.y, side * wo.z);
        let m = self.facets.sample_seen(wo, u);
        let cos = wo.dot(m);
        let wi = m * (2.0 * cos) - wo;
        if !(wi.z > 0.0 && cos > 0.0) {
            return None;
        }
        Some(BsdfSample {
            wi: Vec3::new(wi.x, wi.y, side * wi.z),
            weight: self.metal.reflected(cos) * self.facets.seen(wi),
            pdf: 0.5 * self.facets.density(m) * self.facets.seen_over_twice_cos(wo),
            delta: false,
            transmitted: false,
            eta: 1.0,
            wavelength: 0.0,
        })
    }
}
