//! # Dielectric
//!
//! A smooth boundary between two transparent media, such as glass and air: light is reflected and refracted in the
//! shares of Fresnel's equations or of Schlick's approximation, and reflected totally where it can't get out. What it is filled
//! with ([`super::Interior`]) may dim light on its way.

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask};
use straal_scene::desc;

use super::energy::{ByIndex, Kept};
use super::fresnel::Split;
use super::many::{self, Lobe, These, is_lobe};
use super::microfacet::Facets;
use super::mirror::reflected;
use super::{
    Bsdf, BsdfSample, Clear, DispersiveDielectric, Interior, Recipe, Relative, RoughDielectric, Scatter,
    Share, Transport, Wants, fresnel,
};
use crate::lanes::{Colour, Eta, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// A smooth boundary between transparent media; the shading normal points outside. Where the index of refraction depends on the
/// wavelength it is read as a [`DispersiveDielectric`].
#[derive(Clone, Debug, PartialEq)]
pub struct DielectricMaterial {
    /// Index of refraction inside over that outside.
    pub eta: Eta,
    /// What that is multiplied by, which may differ from point to point.
    pub by: Relative,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Value<Colour>,
    /// Tint of what passes; physical is 1.
    pub transmittance: Value<Colour>,
    /// Whether shares are Schlick's.
    pub schlick: bool,
    /// Its facets, where it isn't smooth.
    pub rough: Option<Rough>,
    /// What it is filled with.
    pub interior: Interior,
}

/// How a boundary is rough.
#[derive(Clone, Debug, PartialEq)]
pub struct Rough {
    /// Alpha of the facets, along the tangent if it is another across it.
    pub roughness: Value<f32>,
    /// Alpha across the tangent, where it is another.
    pub across: Option<Value<f32>>,
    /// How facets are spread.
    pub distribution: desc::Distribution,
    /// What is kept of light from outside and from within, where light that bounces more than once is put back.
    pub kept: Option<Box<[ByIndex<Kept>; 2]>>,
}

impl Rough {
    /// Of what the scene says, unless it is smooth everywhere.
    fn of(d: &desc::Dielectric, (eta, by): (&Eta, &Relative), paint: &mut Paint<'_>) -> Option<Self> {
        let roughness = paint.number(&d.roughness);
        let across = d.roughness_v.as_ref().map(|v| paint.number(v));
        let &Eta::Constant(eta) = eta else { return None };
        if roughness.most() == 0.0 && across.is_none_or(|v| v.most() == 0.0) {
            return None;
        }
        let constant = match (roughness, across) {
            (Value::Constant(alpha), None) => Some([alpha; 2]),
            (Value::Constant(along), Some(Value::Constant(across))) => Some([along, across]),
            _ => None,
        };
        let kept = |turned: bool| {
            ByIndex::new(by.constant().map(|_| eta), |eta| {
                Kept::by_glass(constant, &d.distribution, if turned { 1.0 / eta } else { eta })
            })
        };
        let kept = d.multiple_bounces.then(|| Box::new([false, true].map(kept)));
        Some(Self { roughness, across, distribution: d.distribution.clone(), kept })
    }

    /// Alpha along the tangent and across it.
    fn alpha<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> [f32; 2] {
        let along = reading.eval(&self.roughness, at);
        [along, self.across.as_ref().map_or(along, |v| reading.eval(v, at))]
    }
}

impl Recipe for DielectricMaterial {
    type Described = desc::Dielectric;

    fn is_clear(&self) -> bool {
        true
    }

    fn of(d: &desc::Dielectric, paint: &mut Paint<'_>) -> Self {
        let (eta, by) = paint.index_of_refraction(&d.eta, &d.eta_outside);
        let one = |v: &desc::Varying<desc::Index>| match v.constant() {
            Some(desc::Index::Constant(n)) => Some(*n),
            _ => None,
        };
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            transmittance: paint.reflectance(&d.transmittance),
            rough: Rough::of(d, (&eta, &by), paint),
            eta,
            by,
            schlick: d.fresnel == desc::Fresnel::Schlick,
            interior: Interior::of(&d.interior, [one(&d.eta), one(&d.eta_outside)], paint),
        }
    }

    fn interior(&self) -> Option<&Interior> {
        Some(&self.interior)
    }

    fn wants(&self) -> Wants {
        let tangent = self.rough.as_ref().is_some_and(|r| r.across.is_some());
        let rough = self.rough.as_ref().is_some_and(|r| r.roughness.varies());
        let varies = self.by.varies() || self.reflectance.varies() || self.transmittance.varies() || rough;
        Wants { point: varies || tangent, tangent }
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let reflectance = reading.eval(&self.reflectance, at);
        let transmittance = reading.eval(&self.transmittance, at);
        let by = self.by.at(at, reading);
        if let (Some(rough), &Eta::Constant(eta)) = (&self.rough, &self.eta) {
            let eta = eta * by;
            let alpha = rough.alpha(at, reading);
            if alpha[0] > 0.0 || alpha[1] > 0.0 {
                let facets = Facets::new(alpha, rough.distribution.clone());
                let kept = rough.kept.as_deref();
                return Bsdf::RoughDielectric(RoughDielectric {
                    eta,
                    facets,
                    reflectance,
                    transmittance,
                    kept,
                });
            }
        }
        match &self.eta {
            &Eta::Constant(eta) if self.schlick => {
                Bsdf::Clear(Clear { eta: eta * by, reflectance, transmittance, share: Share::Schlick })
            }
            &Eta::Constant(eta) => Bsdf::Dielectric(Dielectric { eta: eta * by, reflectance, transmittance }),
            Eta::Table(eta) => Bsdf::DispersiveDielectric(DispersiveDielectric {
                eta,
                by,
                tables: reading.tables,
                carried: reading.lanes.carried().packed(),
                reflectance,
                transmittance,
            }),
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        use straal_color::spectrum::refraction::{Glass, Index};
        let white = || super::testing::WHITE.into();
        let of = |eta| Self {
            eta,
            by: 1.0.into(),
            reflectance: white(),
            transmittance: white(),
            schlick: false,
            rough: None,
            interior: Interior::default(),
        };
        let satin =
            Rough { roughness: 0.2.into(), across: None, distribution: desc::Distribution::Ggx, kept: None };
        let crown = Glass::named("BK7").expect("a glass").index();
        vec![
            (of(Eta::Constant(1.5)), super::BsdfKind::Dielectric),
            (Self { rough: Some(satin), ..of(Eta::Constant(1.5)) }, super::BsdfKind::RoughDielectric),
            (Self { schlick: true, ..of(Eta::Constant(1.5)) }, super::BsdfKind::Clear),
            (
                of(Eta::Table(crate::lanes::EtaTable::new(&crown, &Index::Constant(1.0)))),
                super::BsdfKind::DispersiveDielectric,
            ),
        ]
    }
}

/// A smooth boundary between transparent media, or many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric<F = f32> {
    /// Index of refraction on the side of -z over that on the side of z.
    pub eta: F,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Light<F>,
    /// Tint of what passes; physical is 1.
    pub transmittance: Light<F>,
}

impl<F: Float> Lobe<F> for Dielectric<F> {
    type One = Dielectric;

    #[inline(always)]
    fn gather(these: impl These<Dielectric>) -> Self {
        Self {
            eta: many::each(these, |d: &Dielectric| d.eta),
            reflectance: many::light(these, |d: &Dielectric| d.reflectance),
            transmittance: many::light(these, |d: &Dielectric| d.transmittance),
        }
    }

    /// Reflects with the probability of Fresnel's share, so that both weights are 1 but for tint and the
    /// compression of radiance.
    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, u_lobe: F, _: [F; 2], transport: Transport) -> (BsdfSample<F>, F::Mask) {
        let (split, refracted) = self.refracted(wo, transport);
        let reflected = reflected(wo, self.reflectance, split.reflected);
        let sample = BsdfSample::select(u_lobe.lt(split.reflected), reflected, refracted);
        (sample, wo.z.ne(F::ZERO))
    }
}

impl<F: Float> Dielectric<F> {
    /// The shares, and what passes, at its full share: of no use where all is reflected.
    #[inline(always)]
    pub(super) fn refracted(&self, wo: Vec3<F>, transport: Transport) -> (Split<F>, BsdfSample<F>) {
        let eta = F::select(wo.z.gt(F::ZERO), self.eta, F::ONE / self.eta);
        let split = fresnel::dielectric(wo.z.abs(), eta);
        let inverse = F::ONE / eta;
        // The tangential part shrinks by the ratio of the indices (Snell), the rest follows from unit length.
        let wi = Vec3::new(-inverse * wo.x, -inverse * wo.y, (-split.cos_refracted).copysign(-wo.z));
        let compression = match transport {
            Transport::Radiance => inverse * inverse,
            Transport::Importance => F::ONE,
        };
        let yes = F::Mask::splat(true);
        let weight = self.transmittance * compression;
        let pdf = F::ONE - split.reflected;
        (split, BsdfSample { wi, weight, pdf, delta: yes, transmitted: yes, eta, wavelength: F::ZERO })
    }
}

impl Scatter for Dielectric {
    const CHOOSES_LOBE: bool = true;

    is_lobe!(Dielectric);

    fn albedo(&self) -> Light {
        let share = fresnel::dielectric(1.0, self.eta).reflected;
        self.reflectance * share + self.transmittance * (1.0 - share)
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let glass = |name, eta| {
            let glass = Self { eta, reflectance: WHITE, transmittance: WHITE };
            Example::new(name, Bsdf::Dielectric(glass)).albedo(1.0)
        };
        vec![glass("glass", 1.5), glass("bubble", 1.0 / 1.33), glass("nothing at all", 1.0)]
    }
}
