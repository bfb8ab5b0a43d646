//! Rough glass, of which [`super::DielectricMaterial`] is made where it isn't smooth.

use straal_color::Light;
use straal_math::Vec3;

use super::energy::{ByIndex, Kept};
use super::{BsdfSample, Scatter, Transport, fresnel, microfacet::Facets};

/// A boundary of microfacets between transparent media (Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces", eq.
/// 20 and 21). Facets are drawn as they are seen, and one of reflection and refraction in proportion to Fresnel's shares.
///
/// Reciprocity holds, but for the compression of radiance; energy is lost where light would bounce more than once, except where it is put
/// back by a division by what is kept ([`super::energy`], after Turquin 2019), and then reciprocity doesn't hold.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric<'w> {
    /// Index of refraction on the side of -z over that on the side of z.
    pub eta: f32,
    /// How facets are spread.
    pub facets: Facets,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Light,
    /// Tint of what passes; physical is 1.
    pub transmittance: Light,
    /// What is kept of light from the side of z and from the other side, where what is lost is put back.
    pub kept: Option<&'w [ByIndex<Kept>; 2]>,
}

/// Directions of a pair, turned so that `wo` is above, and the relative index of refraction below.
struct Above {
    wo: Vec3,
    wi: Vec3,
    eta: f32,
    side: f32,
}

impl RoughDielectric<'_> {
    fn above(&self, wo: Vec3, wi: Vec3) -> Above {
        let (side, eta) = if wo.z > 0.0 { (1.0, self.eta) } else { (-1.0, 1.0 / self.eta) };
        let [wo, wi] = [wo, wi].map(|w| Vec3::new(w.x, w.y, side * w.z));
        Above { wo, wi, eta, side }
    }

    /// What the value is multiplied by for what bounces more than once.
    fn put_back(&self, wo: Vec3, side: f32) -> f32 {
        let Some(kept) = self.kept else { return 1.0 };
        kept[usize::from(side < 0.0)].between(self.eta, |kept| kept.put_back(&self.facets, wo))
    }
}

impl Scatter for RoughDielectric<'_> {
    const CHOOSES_LOBE: bool = true;
    const TRANSMITS: bool = true;

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Light, f32) {
        if wo.z == 0.0 || wi.z == 0.0 {
            return (Light::ZERO, 0.0);
        }
        let Above { wo, wi, eta, side } = self.above(wo, wi);
        let reflects = wi.z > 0.0;
        let h = if reflects { wo + wi } else { wo + wi * eta };
        let h = if h.z < 0.0 { -h } else { h };
        let Some(m) = h.try_normalize().filter(|m| m.z > 0.0) else { return (Light::ZERO, 0.0) };
        let (towards_o, towards_i) = (wo.dot(m), wi.dot(m));
        // A facet is seen from its front on both ways.
        if towards_o <= 0.0 || (towards_i > 0.0) != reflects {
            return (Light::ZERO, 0.0);
        }
        let split = fresnel::dielectric(towards_o, eta);
        let drawn = self.facets.pdf(wo, m);
        let seen = self.facets.density(m) * self.facets.seen(wo) * self.facets.seen(wi) / wo.z;
        let more = self.put_back(wo, side);
        if reflects {
            let value = split.reflected * seen * 0.25;
            (self.reflectance * (value * more), split.reflected * drawn / (4.0 * towards_o))
        } else {
            let sum = towards_o + eta * towards_i;
            // The stretch of refracting: of the facet's solid angle to that of `wi`.
            let stretch = eta * eta * -towards_i / (sum * sum);
            let compression = match transport {
                Transport::Radiance => 1.0 / (eta * eta),
                Transport::Importance => 1.0,
            };
            let passed = 1.0 - split.reflected;
            let value = passed * seen * towards_o * stretch * compression;
            if !stretch.is_finite() {
                return (Light::ZERO, 0.0);
            }
            (self.transmittance * (value * more), passed * drawn * stretch)
        }
    }

    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let Above { wo: up, eta, side, .. } = self.above(wo, wo);
        let m = self.facets.sample(up, u);
        let towards = up.dot(m);
        if towards <= 0.0 {
            return None;
        }
        let split = fresnel::dielectric(towards, eta);
        let transmitted = u_lobe >= split.reflected;
        let inverse = 1.0 / eta;
        let wi = if transmitted {
            up * -inverse + m * (inverse * towards - split.cos_refracted)
        } else {
            m * (2.0 * towards) - up
        };
        if (wi.z < 0.0) != transmitted || wi.z == 0.0 {
            return None;
        }
        let wi = Vec3::new(wi.x, wi.y, side * wi.z).try_normalize()?;
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        let weight = value * (1.0 / pdf);
        let eta = if transmitted { eta } else { 1.0 };
        (pdf > 0.0 && weight.is_finite()).then_some(BsdfSample {
            wi,
            weight,
            pdf,
            transmitted,
            eta,
            ..BsdfSample::REFLECTED
        })
    }

    fn albedo(&self) -> Light {
        let share = fresnel::dielectric(1.0, self.eta).reflected;
        self.reflectance * share + self.transmittance * (1.0 - share)
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        use straal_scene::desc::Distribution::{self, Beckmann, Ggx};
        let of = |name, eta, alpha, distribution: Distribution| {
            let facets = Facets::new(alpha, distribution);
            let glass = RoughDielectric { eta, facets, reflectance: WHITE, transmittance: WHITE, kept: None };
            Example::new(name, super::Bsdf::RoughDielectric(glass))
        };
        vec![
            of("rough glass", 1.5, [0.4; 2], Ggx).focus(2),
            of("very rough diamond", 2.4, [1.0; 2], Ggx),
            of("rough bubble", 1.0 / 1.5, [0.3; 2], Ggx).focus(2),
            of("brushed glass", 1.5, [0.6, 0.25], Ggx).focus(2),
            of("rough glass of Beckmann's facets", 1.5, [0.4; 2], Beckmann).focus(2),
        ]
    }
}
