//! # Thin dielectric
//!
//! A pane of glass as a single surface, without an inside: light goes straight on, and the shift to the side that a thick pane has is left out. With
//! F the share that one boundary reflects, all that bounces between the two faces adds up to R = 2 F / (1 + F) reflected and T = 1 - R passed. Energy
//! is conserved; reciprocity holds.

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::{Float, Mask};
use straal_scene::desc;

use super::many::{self, Lobe, These, is_lobe};
use super::{Bsdf, BsdfSample, Recipe, Relative, Scatter, Transport, Wants, fresnel, mirror::reflected};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// A pane without an inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectricMaterial {
    /// Index of refraction of the pane over that outside.
    pub eta: Relative,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Value<Colour>,
    /// Tint of what passes; physical is 1.
    pub transmittance: Value<Colour>,
}

impl Recipe for ThinDielectricMaterial {
    type Described = desc::ThinDielectric;

    fn is_clear(&self) -> bool {
        true
    }

    fn of(d: &desc::ThinDielectric, paint: &mut Paint<'_>) -> Self {
        Self {
            eta: Relative::of(&d.eta, &d.eta_outside, paint),
            reflectance: paint.reflectance(&d.reflectance),
            transmittance: paint.reflectance(&d.transmittance),
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.eta.varies() || self.reflectance.varies() || self.transmittance.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::ThinDielectric(ThinDielectric {
            eta: self.eta.at(at, reading),
            reflectance: reading.eval(&self.reflectance, at),
            transmittance: reading.eval(&self.transmittance, at),
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let white = || super::testing::WHITE.into();
        let pane = Self { eta: 1.5.into(), reflectance: white(), transmittance: white() };
        vec![(pane, super::BsdfKind::ThinDielectric)]
    }
}

/// A pane without an inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric<F = f32> {
    /// Index of refraction of the pane over that outside.
    pub eta: F,
    /// Tint of what is reflected; physical is 1.
    pub reflectance: Light<F>,
    /// Tint of what passes; physical is 1.
    pub transmittance: Light<F>,
}

impl<F: Float> ThinDielectric<F> {
    #[inline(always)]
    fn share(&self, cos: F) -> F {
        let one = fresnel::dielectric(cos, self.eta).reflected;
        one * 2.0 / (one + 1.0)
    }
}

impl<F: Float> Lobe<F> for ThinDielectric<F> {
    type One = ThinDielectric;

    #[inline(always)]
    fn gather(these: impl These<ThinDielectric>) -> Self {
        Self {
            eta: many::each(these, |t: &ThinDielectric| t.eta),
            reflectance: many::light(these, |t: &ThinDielectric| t.reflectance),
            transmittance: many::light(these, |t: &ThinDielectric| t.transmittance),
        }
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, u_lobe: F, _: [F; 2], _: Transport) -> (BsdfSample<F>, F::Mask) {
        let share = self.share(wo.z.abs());
        let yes = F::Mask::splat(true);
        let through = BsdfSample {
            delta: yes,
            transmitted: yes,
            ..BsdfSample::reflected(-wo, self.transmittance, F::ONE - share)
        };
        let reflected = reflected(wo, self.reflectance, share);
        (BsdfSample::select(u_lobe.lt(share), reflected, through), wo.z.ne(F::ZERO))
    }
}

impl Scatter for ThinDielectric {
    const CHOOSES_LOBE: bool = true;

    is_lobe!(ThinDielectric);

    fn albedo(&self) -> Light {
        let share = self.share(1.0);
        self.reflectance * share + self.transmittance * (1.0 - share)
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let pane = |eta| Bsdf::ThinDielectric(Self { eta, reflectance: WHITE, transmittance: WHITE });
        vec![Example::new("pane", pane(1.5)).albedo(1.0), Example::new("film of air", pane(0.7)).albedo(1.0)]
    }
}
