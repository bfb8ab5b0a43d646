//! Rough metal of any kind, of which [`super::ConductorMaterial`] is made where a [`super::RoughConductor`] won't do: brushed along a direction,
//! with Beckmann's facets, or with the light put back that bounces more than once.

use straal_color::Light;
use straal_math::Vec3;

use super::{BsdfSample, Metal, Scatter, Transport, energy::Kept, facing, microfacet::Facets};

/// Metal of microfacets: f = F D G / (4 cos cos). Directions are drawn as bounded visible normals give them.
///
/// The model follows light to one facet only, so that rough metal is too dark. With `kept` f is multiplied by 1 + F0 (1 / E - 1), with E what metal
/// without absorption would send back and F0 the metal's reflectance straight on (Turquin 2019, "Practical Multiple Scattering Compensation for
/// Microfacet Models", eq. 16): all light that isn't absorbed comes back, but since E is that of `wo` alone reciprocity doesn't hold.
#[derive(Clone, Copy, Debug)]
pub struct FacetConductor<'w> {
    /// What the facets are made of.
    pub metal: Metal,
    /// How they are spread.
    pub facets: Facets,
    /// What is kept of light, where what bounces more than once is put back.
    pub kept: Option<&'w Kept>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl FacetConductor<'_> {
    /// Reflectance with what bounces more than once, for `wo` above the surface.
    #[inline]
    fn share(&self, wo: Vec3, cos: f32) -> Light {
        let share = self.metal.reflected(cos);
        let Some(kept) = self.kept else { return share };
        let lost = kept.put_back(&self.facets, wo) - 1.0;
        share.zip(self.metal.albedo(), |f, straight| f * (1.0 + straight * lost))
    }
}

impl Scatter for FacetConductor<'_> {
    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Light, f32) {
        let Some(side) = facing(wo, self.two_sided) else { return (Light::ZERO, 0.0) };
        let [wo, wi] = [wo, wi].map(|w| Vec3::new(w.x, w.y, side * w.z));
        let h = wo + wi;
        let hh = h.length_squared();
        if wi.z <= 0.0 || hh <= f32::MIN_POSITIVE {
            return (Light::ZERO, 0.0);
        }
        let value = self.facets.density(h) * self.facets.seen(wo) * self.facets.seen(wi) / (4.0 * wo.z);
        (self.share(wo, wo.dot(h) / hh.sqrt()) * value, self.facets.pdf_reflecting(wo, h))
    }

    #[inline]
    fn sample(&self, wo: Vec3, _: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let side = facing(wo, self.two_sided)?;
        let seen = Vec3::new(wo.x, wo.y, side * wo.z);
        let m = self.facets.sample_reflecting(seen, u);
        let cos = seen.dot(m);
        let wi = m * (2.0 * cos) - seen;
        if !(wi.z > 0.0 && cos > 0.0) {
            return None;
        }
        let wi = Vec3::new(wi.x, wi.y, side * wi.z);
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        let weight = value * (1.0 / pdf);
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample { wi, weight, pdf, ..BsdfSample::REFLECTED })
    }

    fn albedo(&self) -> Light {
        self.metal.albedo()
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, gold, lossless};
        use std::sync::LazyLock;
        use straal_scene::desc::Distribution::{Beckmann, Ggx};
        static TABLES: LazyLock<[Kept; 2]> =
            LazyLock::new(|| [0.4, 1.0].map(|alpha| Kept::by_metal(Some([alpha; 2]), &Ggx)));
        let of = |name, metal, alpha, distribution| {
            let facets = Facets::new(alpha, distribution);
            let metal = FacetConductor { metal, facets, kept: None, two_sided: true };
            Example::new(name, super::Bsdf::FacetConductor(metal))
        };
        let whole = |name, alpha: f32| {
            let facets = Facets::new([alpha; 2], Ggx);
            let kept = Some(if alpha == 1.0 { &TABLES[1] } else { &TABLES[0] });
            let metal = FacetConductor { metal: lossless(), facets, kept, two_sided: true };
            Example::new(name, super::Bsdf::FacetConductor(metal)).one_way().nearly_energy(0.01)
        };
        vec![
            of("brushed gold", gold(), [0.3, 0.1], Ggx).focus(4),
            of("metal brushed across", lossless(), [0.1, 0.9], Ggx).focus(4),
            of("gold of Beckmann's facets", gold(), [0.3, 0.3], Beckmann).focus(3),
            of("brushed metal of Beckmann's facets", lossless(), [0.2, 0.5], Beckmann).focus(4),
            whole("metal that loses nothing, rough", 0.4).focus(2),
            whole("metal that loses nothing, very rough", 1.0),
        ]
    }
}
