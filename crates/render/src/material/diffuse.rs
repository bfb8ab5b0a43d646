//! # Diffuse
//!
//! Scatters light evenly, so that it looks equally bright from everywhere (Lambert 1760): f = reflectance / pi.
//! Chalk, plaster, paper.

use std::f32::consts::FRAC_1_PI;

use straal_color::Light;
use straal_math::{Vec3, warp};

use super::{BsdfSample, facing};

/// An evenly scattering surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse {
    /// Share of light that is reflected.
    pub reflectance: Light,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Diffuse {
    #[inline]
    pub(super) fn eval_pdf(&self, wo: Vec3, wi: Vec3) -> (Light, f32) {
        let cos = facing(wo, self.two_sided).map_or(0.0, |side| side * wi.z);
        if cos > 0.0 {
            let pdf = cos * FRAC_1_PI;
            (self.reflectance * pdf, pdf)
        } else {
            (Light::ZERO, 0.0)
        }
    }

    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        let side = facing(wo, self.two_sided)?;
        let d = warp::cosine_hemisphere(u);
        (d.z > 0.0).then_some(BsdfSample {
            wi: Vec3::new(d.x, d.y, side * d.z),
            weight: self.reflectance,
            pdf: d.z * FRAC_1_PI,
            delta: false,
            transmitted: false,
            eta: 1.0,
            wavelength: 0.0,
        })
    }
}
