//! Rough metal, of which [`super::ConductorMaterial`] is made where it isn't polished.

use straal_color::Light;
use straal_math::Vec3;

use super::{BsdfSample, Metal, Scatter, Transport, facing, ggx::Ggx};

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
}

impl Scatter for RoughConductor {
    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Light, f32) {
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
    fn sample(&self, wo: Vec3, _: f32, u: [f32; 2], _: Transport) -> Option<BsdfSample> {
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

    fn albedo(&self) -> Light {
        self.metal.albedo()
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, gold, lossless};
        let rough =
            |name, metal, alpha| Example::new(name, super::Bsdf::RoughConductor(Self::new(metal, alpha)));
        vec![
            rough("gold, almost polished", gold(), 0.01).focus(6),
            rough("gold, satin", gold(), 0.05).focus(4),
            rough("gold, rough", gold(), 0.3).focus(2),
            rough("lossless metal, rough", lossless(), 0.5),
            rough("lossless metal, very rough", lossless(), 1.0),
            Example::new("one-sided metal", super::Bsdf::RoughConductor(Self::new(gold(), 0.2).one_sided()))
                .focus(2),
        ]
    }
}
