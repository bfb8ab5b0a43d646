//! Rough metal, of which [`super::ConductorMaterial`] is made where it isn't polished.

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::Float;

use super::many::{self, Lobe, These, is_lobe};
use super::{BsdfSample, Metal, Scatter, Transport, facing_or_zero, ggx::Ggx};

/// Metal of GGX microfacets with Smith's shadowing, `wo` and `wi` shadowed independently (G = G1 G1), and facets
/// drawn as they are seen (Heitz 2018): the weight of a sample is then Fresnel's reflectance times G1(wi). Or many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughConductor<F: Float = f32> {
    /// What the facets are made of.
    pub metal: Metal<F>,
    facets: Ggx<F>,
    two_sided: F::Mask,
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

impl<F: Float> Lobe<F> for RoughConductor<F> {
    type One = RoughConductor;

    #[inline(always)]
    fn gather(these: impl These<RoughConductor>) -> Self {
        Self {
            metal: Metal::gather(these, |r: &RoughConductor| &r.metal),
            facets: Ggx { alpha: many::each(these, |r: &RoughConductor| r.facets.alpha) },
            two_sided: many::which::<_, F>(these, |r: &RoughConductor| r.two_sided),
        }
    }

    #[inline(always)]
    fn eval_pdf(&self, wo: Vec3<F>, wi: Vec3<F>, _: Transport) -> (Light<F>, F) {
        let side = facing_or_zero(wo, self.two_sided);
        let (wo, wi) = (Vec3::new(wo.x, wo.y, side * wo.z), Vec3::new(wi.x, wi.y, side * wi.z));
        let h = wo + wi;
        let hh = h.length_squared();
        // Opposite directions along the surface have no half-way; f is 0 in the limit.
        let there = side.ne(F::ZERO) & wi.z.gt(F::ZERO) & hh.gt(F::splat(f32::MIN_POSITIVE));
        // G1(wo) D (wo.m) / cos wo is the density of facets, 4 (wo.m) the stretch of reflecting.
        let pdf = self.facets.density(h) * 0.5 * self.facets.seen_over_twice_cos(wo);
        let pdf = F::select(there, pdf, F::ZERO);
        let share = self.metal.reflected(wo.dot(h) / hh.sqrt());
        let value = share * (pdf * self.facets.seen(wi));
        (Light::select(there, value, Light::splat(F::ZERO)), pdf)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, _: F, u: [F; 2], _: Transport) -> (BsdfSample<F>, F::Mask) {
        let side = facing_or_zero(wo, self.two_sided);
        let wo = Vec3::new(wo.x, wo.y, side * wo.z);
        let m = self.facets.sample_seen(wo, u);
        let cos = wo.dot(m);
        let wi = m * (cos * 2.0) - wo;
        let there = side.ne(F::ZERO) & wi.z.gt(F::ZERO) & cos.gt(F::ZERO);
        let weight = self.metal.reflected(cos) * self.facets.seen(wi);
        let pdf = self.facets.density(m) * 0.5 * self.facets.seen_over_twice_cos(wo);
        (BsdfSample::reflected(Vec3::new(wi.x, wi.y, side * wi.z), weight, pdf), there)
    }
}

impl Scatter for RoughConductor {
    is_lobe!(RoughConductor);

    #[inline]
    fn is_delta(&self) -> bool {
        false
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
