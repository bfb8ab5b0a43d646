//! # Diffuse transmission
//!
//! Paper, leaves, lampshades: light is scattered evenly on the side that it came from, f = r / pi, and on the other, f = t / pi. Energy is
//! conserved where r + t is at most 1; reciprocity holds.

use std::f32::consts::FRAC_1_PI;

use straal_color::Light;
use straal_math::simd::Float;
use straal_math::{Vec3, warp};
use straal_scene::desc;

use super::many::{self, Lobe, These, is_lobe};
use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// What scatters light evenly on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmissionMaterial {
    /// Share of light that is sent back.
    pub reflectance: Value<Colour>,
    /// Share of light that goes through.
    pub transmittance: Value<Colour>,
}

impl Recipe for DiffuseTransmissionMaterial {
    type Described = desc::DiffuseTransmission;

    fn of(d: &desc::DiffuseTransmission, paint: &mut Paint<'_>) -> Self {
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            transmittance: paint.reflectance(&d.transmittance),
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.reflectance.varies() || self.transmittance.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::DiffuseTransmission(DiffuseTransmission {
            reflectance: reading.eval(&self.reflectance, at),
            transmittance: reading.eval(&self.transmittance, at),
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let share = |v: f32| Light::rgb([v; 3]).into();
        let paper = Self { reflectance: share(0.4), transmittance: share(0.3) };
        vec![(paper, super::BsdfKind::DiffuseTransmission)]
    }
}

/// What scatters light evenly on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTransmission<F = f32> {
    /// Share of light that is sent back.
    pub reflectance: Light<F>,
    /// Share of light that goes through.
    pub transmittance: Light<F>,
}

impl<F: Float> DiffuseTransmission<F> {
    /// The chance of going through.
    #[inline(always)]
    fn chance(&self) -> F {
        let (r, t) = (self.reflectance.max_lane(), self.transmittance.max_lane());
        F::select(t.gt(F::ZERO), t / (r + t), F::ZERO)
    }
}

impl<F: Float> Lobe<F> for DiffuseTransmission<F> {
    type One = DiffuseTransmission;

    #[inline(always)]
    fn gather(these: impl These<DiffuseTransmission>) -> Self {
        Self {
            reflectance: many::light(these, |d: &DiffuseTransmission| d.reflectance),
            transmittance: many::light(these, |d: &DiffuseTransmission| d.transmittance),
        }
    }

    #[inline(always)]
    fn eval_pdf(&self, wo: Vec3<F>, wi: Vec3<F>, _: Transport) -> (Light<F>, F) {
        let even = wi.z.abs() * FRAC_1_PI;
        let even = F::select(wo.z.eq(F::ZERO) | wi.z.eq(F::ZERO), F::ZERO, even);
        let through = self.chance();
        let back = (wo.z * wi.z).gt(F::ZERO);
        let value = Light::select(back, self.reflectance, self.transmittance) * even;
        (value, F::select(back, F::ONE - through, through) * even)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, u_lobe: F, u: [F; 2], transport: Transport) -> (BsdfSample<F>, F::Mask) {
        let transmitted = u_lobe.lt(self.chance());
        let above = wo.z.gt(F::ZERO) ^ transmitted;
        let d = warp::cosine_hemisphere(u);
        let wi = Vec3::new(d.x, d.y, F::select(above, d.z, -d.z));
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        let sample = BsdfSample::reflected(wi, value * (F::ONE / pdf), pdf);
        (BsdfSample { transmitted, ..sample }, pdf.gt(F::ZERO))
    }
}

impl Scatter for DiffuseTransmission {
    const CHOOSES_LOBE: bool = true;
    const LOSES_BELOW: bool = true;
    const TRANSMITS: bool = true;

    is_lobe!(DiffuseTransmission);

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    fn albedo(&self) -> Light {
        self.reflectance + self.transmittance
    }

    fn ambient(&self) -> Light {
        self.reflectance
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        let grey = |v: f32| Light::rgb([v; 3]);
        let of = |r, t| Bsdf::DiffuseTransmission(Self { reflectance: grey(r), transmittance: grey(t) });
        let example = super::testing::Example::new;
        vec![
            example("paper", of(0.6, 0.4)).albedo(f64::from(0.6_f32) + f64::from(0.4_f32)),
            example("what lets all through", of(0.0, 1.0)).albedo(1.0),
        ]
    }
}
