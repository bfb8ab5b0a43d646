//! # Conductor
//!
//! Metal: what isn't reflected is absorbed. Polished, it is a mirror of Fresnel's reflectance; rough, its facets
//! are (GGX or Beckmann's, alike in all directions or brushed), and light that would bounce between them more than once is lost, so that very rough metal is a
//! little too dark, or put back ([`super::FacetConductor`]).

use std::sync::Arc;

use straal_color::Light;
use straal_math::simd::Float;
use straal_math::{Vec3, ops};
use straal_scene::desc;

use super::energy::Kept;
use super::many::{self, Lobe, These, is_lobe};
use super::microfacet::Facets;
use super::mirror::reflected;
use super::{
    Bsdf, BsdfSample, FacetConductor, Recipe, RoughConductor, Scatter, Transport, Wants, facing_or_zero,
    fresnel,
};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// A metal, polished or rough.
#[derive(Clone, Debug, PartialEq)]
pub struct ConductorMaterial {
    /// Real part of the index of refraction, relative to the outside.
    pub eta: Value<Colour>,
    /// Imaginary part: absorption.
    pub k: Value<Colour>,
    /// Alpha of the facets, along the tangent if it is another across it; 0 is polished.
    pub roughness: Value<f32>,
    /// Alpha across the tangent, where it is another.
    pub roughness_v: Option<Value<f32>>,
    /// How facets are spread.
    pub distribution: desc::Distribution,
    /// What is kept of light, where what bounces more than once is put back.
    pub kept: Option<Arc<Kept>>,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Value<Colour>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Recipe for ConductorMaterial {
    type Described = desc::Conductor;

    fn of(d: &desc::Conductor, paint: &mut Paint<'_>) -> Self {
        let [eta, k] = paint.metal(d);
        let (roughness, roughness_v) =
            (paint.number(&d.roughness), d.roughness_v.as_ref().map(|v| paint.number(v)));
        let constant = match (roughness, roughness_v) {
            (Value::Constant(alpha), None) => Some([alpha; 2]),
            (Value::Constant(along), Some(Value::Constant(across))) => Some([along, across]),
            _ => None,
        };
        Self {
            eta,
            k,
            kept: d.multiple_bounces.then(|| Arc::new(Kept::by_metal(constant, &d.distribution))),
            roughness,
            roughness_v,
            distribution: d.distribution.clone(),
            reflectance: paint.reflectance(&d.reflectance),
            two_sided: d.two_sided,
        }
    }

    fn wants(&self) -> Wants {
        let varies = self.roughness.varies()
            || self.roughness_v.is_some_and(|v| v.varies())
            || self.eta.varies()
            || self.k.varies()
            || self.reflectance.varies();
        // What is brushed must know which way.
        let tangent = self.roughness_v.is_some();
        Wants { point: varies || tangent, tangent }
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let (eta, k) = (reading.eval(&self.eta, at), reading.eval(&self.k, at));
        let metal = Metal { eta, k, reflectance: reading.eval(&self.reflectance, at) };
        let (alpha, two_sided) = (reading.eval(&self.roughness, at), self.two_sided);
        let across = self.roughness_v.as_ref().map_or(alpha, |v| reading.eval(v, at));
        if alpha <= 0.0 && across <= 0.0 {
            return Bsdf::Conductor(Conductor { metal, two_sided });
        }
        if self.roughness_v.is_some() || self.kept.is_some() || self.distribution != desc::Distribution::Ggx {
            let facets = Facets::new([alpha, across], self.distribution.clone());
            let kept = self.kept.as_deref();
            Bsdf::FacetConductor(FacetConductor { metal, facets, kept, two_sided })
        } else {
            let rough = RoughConductor::new(metal, alpha);
            Bsdf::RoughConductor(if two_sided { rough } else { rough.one_sided() })
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let super::Metal { eta, k, reflectance } = super::testing::gold();
        let of = |alpha: f32| Self {
            eta: eta.into(),
            k: k.into(),
            roughness: alpha.into(),
            roughness_v: None,
            distribution: desc::Distribution::Ggx,
            kept: None,
            reflectance: reflectance.into(),
            two_sided: true,
        };
        let kept = Kept::by_metal(Some([0.1; 2]), &desc::Distribution::Ggx);
        let whole = Self { kept: Some(Arc::new(kept)), ..of(0.1) };
        vec![
            (of(0.0), super::BsdfKind::Conductor),
            (of(0.1), super::BsdfKind::RoughConductor),
            (whole, super::BsdfKind::FacetConductor),
        ]
    }
}

/// What metal it is, of one surface or of many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal<F = f32> {
    /// Real part of the index of refraction, relative to the outside.
    pub eta: Light<F>,
    /// Imaginary part: absorption.
    pub k: Light<F>,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Light<F>,
}

impl<F: Float> Metal<F> {
    /// That of each of these.
    #[inline(always)]
    pub(super) fn gather<K>(these: impl These<K>, of: impl Fn(&K) -> &Metal) -> Self {
        Self {
            eta: many::light(these, |k: &K| of(k).eta),
            k: many::light(these, |k: &K| of(k).k),
            reflectance: many::light(these, |k: &K| of(k).reflectance),
        }
    }

    /// Share of light that is reflected straight back.
    pub(super) fn albedo(&self) -> Light<F> {
        self.reflected(F::ONE)
    }

    /// Share of light that is reflected at an angle.
    #[inline(always)]
    pub(super) fn reflected(&self, cos: F) -> Light<F> {
        self.reflectance * fresnel::conductor(ops::clamp(cos, F::ZERO, F::ONE), self.eta, self.k)
    }
}

/// Polished metal, or many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor<F: Float = f32> {
    /// Which.
    pub metal: Metal<F>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: F::Mask,
}

impl<F: Float> Lobe<F> for Conductor<F> {
    type One = Conductor;

    #[inline(always)]
    fn gather(these: impl These<Conductor>) -> Self {
        Self {
            metal: Metal::gather(these, |c: &Conductor| &c.metal),
            two_sided: many::which::<_, F>(these, |c: &Conductor| c.two_sided),
        }
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, _: F, _: [F; 2], _: Transport) -> (BsdfSample<F>, F::Mask) {
        let sample = reflected(wo, self.metal.reflected(wo.z.abs()), F::ONE);
        (sample, facing_or_zero(wo, self.two_sided).ne(F::ZERO))
    }
}

impl Scatter for Conductor {
    is_lobe!(Conductor);

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
