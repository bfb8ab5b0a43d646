//! # Transparent
//!
//! The textbook's simple transparency (Suffern 2007, *Ray Tracing from the Ground Up*, chapter 27): light is bent by Snell's law, but at
//! every angle the same share k_r is reflected and the same share k_t passes. Where it can't get out, all of both is reflected. Energy is
//! conserved where k_r + k_t is at most 1; reciprocity holds.

use straal_color::Light;
use straal_math::Vec3;
use straal_scene::desc;

use super::{
    Bsdf, BsdfSample, Dielectric, Interior, Recipe, Relative, Scatter, Transport, Wants, fresnel,
    mirror::reflected,
};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// What reflects and lets through constant shares of the light; the shading normal points outside.
#[derive(Clone, Debug, PartialEq)]
pub struct TransparentMaterial {
    /// Index of refraction inside over that outside.
    pub eta: Relative,
    /// Share of light that is reflected: k_r.
    pub reflectance: Value<Colour>,
    /// Share of light that passes: k_t.
    pub transmittance: Value<Colour>,
    /// What it is filled with.
    pub interior: Interior,
}

impl Recipe for TransparentMaterial {
    type Described = desc::Transparent;

    fn is_clear(&self) -> bool {
        true
    }

    fn of(d: &desc::Transparent, paint: &mut Paint<'_>) -> Self {
        Self {
            eta: Relative::of(&d.eta, &d.eta_outside, paint),
            reflectance: paint.reflectance(&d.reflectance),
            transmittance: paint.reflectance(&d.transmittance),
            interior: Interior::of(
                &d.interior,
                [&d.eta, &d.eta_outside].map(|v| v.constant().copied()),
                paint,
            ),
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.eta.varies() || self.reflectance.varies() || self.transmittance.varies())
    }

    fn interior(&self) -> Option<&Interior> {
        Some(&self.interior)
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::Clear(Clear {
            eta: self.eta.at(at, reading),
            reflectance: reading.eval(&self.reflectance, at),
            transmittance: reading.eval(&self.transmittance, at),
            share: Share::Constant,
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let share = |v: f32| Light::rgb([v; 3]).into();
        let interior = Interior::default();
        let simple = Self { eta: 1.5.into(), reflectance: share(0.1), transmittance: share(0.9), interior };
        vec![(simple, super::BsdfKind::Clear)]
    }
}

/// Which share of light is reflected at a boundary of [`Clear`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// The same at every angle: what the reflectance says, and the transmittance says what passes.
    Constant,
    /// Schlick's approximation of Fresnel's; reflectance and transmittance are tints.
    Schlick,
}

/// A smooth boundary between transparent media whose shares aren't Fresnel's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clear {
    /// Index of refraction on the side of -z over that on the side of z.
    pub eta: f32,
    /// Of what is reflected: a share or a tint.
    pub reflectance: Light,
    /// Of what passes: a share or a tint.
    pub transmittance: Light,
    /// Which share is reflected.
    pub share: Share,
}

impl Scatter for Clear {
    const CHOOSES_LOBE: bool = true;

    fn albedo(&self) -> Light {
        match self.share {
            Share::Constant => (self.reflectance + self.transmittance).map(|v| if v < 1.0 { v } else { 1.0 }),
            Share::Schlick => {
                let share = fresnel::dielectric_by_schlick(1.0, self.eta).reflected;
                self.reflectance * share + self.transmittance * (1.0 - share)
            }
        }
    }

    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, _: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let eta = if wo.z > 0.0 { self.eta } else { 1.0 / self.eta };
        let split = fresnel::dielectric_by_schlick(wo.z.abs(), eta);
        let chance = match self.share {
            Share::Schlick => split.reflected,
            Share::Constant if split.cos_refracted == 0.0 => {
                return Some(reflected(wo, self.reflectance + self.transmittance, 1.0));
            }
            Share::Constant => {
                let (r, t) = (self.reflectance.max_lane(), self.transmittance.max_lane());
                r / (r + t)
            }
        };
        // What is black on both sides has no chance that is a number.
        if chance.is_nan() {
            return None;
        }
        let [of_reflected, of_passed] = match self.share {
            Share::Schlick => [1.0; 2],
            Share::Constant => [1.0 / chance, 1.0 / (1.0 - chance)],
        };
        if u_lobe < chance {
            return Some(reflected(wo, self.reflectance * of_reflected, chance));
        }
        let (reflectance, transmittance) = (self.reflectance, self.transmittance);
        let glass = Dielectric { eta: self.eta, reflectance, transmittance };
        let (_, through) = glass.refracted(wo, transport);
        let passes = 1.0 - chance;
        (passes > 0.0).then_some(BsdfSample { weight: through.weight * of_passed, pdf: passes, ..through })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let grey = |v: f32| Light::rgb([v; 3]);
        let simple = |r: f32, t: f32| {
            Bsdf::Clear(Self {
                eta: 1.5,
                reflectance: grey(r),
                transmittance: grey(t),
                share: Share::Constant,
            })
        };
        let schlick = Self { eta: 1.5, reflectance: WHITE, transmittance: WHITE, share: Share::Schlick };
        vec![
            Example::new("simple transparency", simple(0.25, 0.75)).albedo(1.0),
            Example::new("simple transparency that absorbs", simple(0.1, 0.6)),
            Example::new("glass after Schlick", Bsdf::Clear(schlick)).albedo(1.0),
        ]
    }
}
