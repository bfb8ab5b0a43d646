//! # Diffuse transmission
//!
//! Paper, leaves, lampshades: light is scattered evenly on the side that it came from, f = r / pi, and on the other, f = t / pi. Energy is
//! conserved where r + t is at most 1; reciprocity holds.

use std::f32::consts::FRAC_1_PI;

use straal_color::Light;
use straal_math::{Vec3, warp};
use straal_scene::desc;

use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants};
use crate::error::CompileError;
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

    fn of(d: &desc::DiffuseTransmission, paint: &mut Paint<'_>) -> Result<Self, CompileError> {
        Ok(Self {
            reflectance: paint.reflectance(&d.reflectance)?,
            transmittance: paint.reflectance(&d.transmittance)?,
        })
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
pub struct DiffuseTransmission {
    /// Share of light that is sent back.
    pub reflectance: Light,
    /// Share of light that goes through.
    pub transmittance: Light,
}

impl DiffuseTransmission {
    /// The chance of going through.
    #[inline]
    fn chance(&self) -> f32 {
        let (r, t) = (self.reflectance.max_lane(), self.transmittance.max_lane());
        if t > 0.0 { t / (r + t) } else { 0.0 }
    }
}

impl Scatter for DiffuseTransmission {
    const CHOOSES_LOBE: bool = true;
    const LOSES_BELOW: bool = true;
    const TRANSMITS: bool = true;

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Light, f32) {
        let even = wi.z.abs() * FRAC_1_PI;
        let through = self.chance();
        if wo.z == 0.0 || wi.z == 0.0 {
            (Light::ZERO, 0.0)
        } else if wo.z * wi.z > 0.0 {
            (self.reflectance * even, (1.0 - through) * even)
        } else {
            (self.transmittance * even, through * even)
        }
    }

    #[inline]
    fn sample(&self, wo: Vec3, u_lobe: f32, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let transmitted = u_lobe < self.chance();
        let side = if (wo.z > 0.0) == transmitted { -1.0 } else { 1.0 };
        let d = warp::cosine_hemisphere(u);
        let wi = Vec3::new(d.x, d.y, side * d.z);
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        (pdf > 0.0).then_some(BsdfSample {
            wi,
            weight: value * (1.0 / pdf),
            pdf,
            transmitted,
            ..BsdfSample::REFLECTED
        })
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
