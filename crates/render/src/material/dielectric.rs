//! # Dielectric
//!
//! A smooth boundary between two transparent media, such as glass and air: light is reflected and refracted in the
//! shares of Fresnel's equations or of Schlick's approximation, and reflected totally where it can't get out. What it is filled
//! with ([`super::Interior`]) may dim light on its way.

use straal_color::Light;
use straal_math::Vec3;
use straal_scene::desc;

use super::energy::{self, Shares};
use super::microfacet::Facets;
use super::{
    Bsdf, BsdfSample, Clear, DispersiveDielectric, Interior, Recipe, RoughDielectric, Scatter, Share,
    Transport, Wants, fresnel, mirror::reflected,
};
use crate::error::CompileError;
use crate::lanes::{Colour, Eta, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// A smooth boundary between transparent media; the shading normal points outside. Where the index of refraction depends on the
/// wavelength it is read as a [`DispersiveDielectric`].
#[derive(Clone, Debug, PartialEq)]
pub struct DielectricMaterial {
    /// Index of refraction inside over that outside.
    pub eta: Eta,
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
    pub kept: Option<Box<[Shares; 2]>>,
}

impl Rough {
    /// Of what the scene says, unless it is smooth everywhere.
    fn of(d: &desc::Dielectric, eta: &Eta, paint: &mut Paint<'_>) -> Result<Option<Self>, CompileError> {
        let roughness = paint.number(&d.roughness)?;
        let across = d.roughness_v.as_ref().map(|v| paint.number(v)).transpose()?;
        let &Eta::Constant(eta) = eta else { return Ok(None) };
        if roughness.most() == 0.0 && across.is_none_or(|v| v.most() == 0.0) {
            return Ok(None);
        }
        let constant = match (roughness, across) {
            (Value::Constant(alpha), None) => Some(alpha),
            _ => None,
        };
        let kept = d
            .multiple_bounces
            .then(|| Box::new([eta, 1.0 / eta].map(|eta| energy::kept(constant, &d.distribution, eta))));
        Ok(Some(Self { roughness, across, distribution: d.distribution.clone(), kept }))
    }

    /// Alpha along the tangent and across it.
    fn alpha<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> [f32; 2] {
        let along = reading.eval(&self.roughness, at);
        [along, self.across.as_ref().map_or(along, |v| reading.eval(v, at))]
    }
}

impl Recipe for DielectricMaterial {
    type Described = desc::Dielectric;

    const CLEAR: bool = true;

    fn of(d: &desc::Dielectric, paint: &mut Paint<'_>) -> Result<Self, CompileError> {
        let eta = paint.index_of_refraction(&d.eta, &d.eta_outside)?;
        Ok(Self {
            reflectance: paint.reflectance(&d.reflectance)?,
            transmittance: paint.reflectance(&d.transmittance)?,
            rough: Rough::of(d, &eta, paint)?,
            eta,
            schlick: d.fresnel == desc::Fresnel::Schlick,
            interior: Interior::of(&d.interior, [&d.eta, &d.eta_outside], paint)?,
        })
    }

    fn interior(&self) -> Option<&Interior> {
        Some(&self.interior)
    }

    fn wants(&self) -> Wants {
        let tangent = self.rough.as_ref().is_some_and(|r| r.across.is_some());
        let rough = self.rough.as_ref().is_some_and(|r| r.roughness.varies());
        let varies = self.reflectance.varies() || self.transmittance.varies() || rough;
        Wants { point: varies || tangent, tangent }
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let reflectance = reading.eval(&self.reflectance, at);
        let transmittance = reading.eval(&self.transmittance, at);
        if let (Some(rough), &Eta::Constant(eta)) = (&self.rough, &self.eta) {
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
                Bsdf::Clear(Clear { eta, reflectance, transmittance, share: Share::Schlick })
            }
            &Eta::Constant(eta) => Bsdf::Dielectric(Dielectric { eta, reflectance, transmittance }),
            Eta::Table(eta) => Bsdf::DispersiveDielectric(DispersiveDielectric {
                eta,
                tables: reading.tables,
                carried: reading.lanes.carried().packed(),
                reflectance,
                transmittance,
            }),
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        use straal_color::spectrum::refraction::{Index, glass};
        let white = || super::testing::WHITE.into();
        let of = |eta| Self {
            eta,
            reflectance: white(),
            transmittance: white(),
            schlick: false,
            rough: None,
            interior: Interior::default(),
        };
        let satin =
            Rough { roughness: 0.2.into(), across: None, distribution: desc::Distribution::Ggx, kept: None };
        let crown = glass("BK7").expect("a glass");
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

/// A smooth boundary between transparent media.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Index of refraction on the side of -z over that on the side of z.
    pub eta: f32,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Light,
    /// Tint of what passes; physical is 1.
    pub transmittance: Light,
}

impl Scatter for Dielectric {
    const CHOOSES_LOBE: bool = true;

    fn albedo(&self) -> Light {
        let share = fresnel::dielectric(1.0, self.eta).reflected;
        self.reflectance * share + self.transmittance * (1.0 - share)
    }

    /// Reflects with the probability of Fresnel's share, so that both weights are 1 but for tint and the
    /// compression of radiance.
    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, _: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let split = fresnel::dielectric(wo.z.abs(), eta);
        if u_lobe < split.reflected {
            return Some(reflected(wo, self.reflectance, split.reflected));
        }
        self.refracted(wo, transport)
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

impl Dielectric {
    /// What passes, at its full share; `None` where all is reflected.
    #[inline]
    pub(super) fn refracted(&self, wo: Vec3, transport: Transport) -> Option<BsdfSample> {
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let split = fresnel::dielectric(wo.z.abs(), eta);
        let inverse = 1.0 / eta;
        // The tangential part shrinks by the ratio of the indices (Snell), the rest follows from unit length.
        let wi = Vec3::new(-inverse * wo.x, -inverse * wo.y, (-split.cos_refracted).copysign(-wo.z));
        let compression = match transport {
            Transport::Radiance => inverse * inverse,
            Transport::Importance => 1.0,
        };
        Some(BsdfSample {
            wi,
            weight: self.transmittance * compression,
            pdf: 1.0 - split.reflected,
            delta: true,
            transmitted: true,
            eta,
            wavelength: 0.0,
        })
    }
}
