//! # Dielectric
//!
//! A smooth boundary between two transparent media, such as glass and air: light is reflected and refracted in the
//! shares of Fresnel's equations, and reflected totally where it can't get out.

use straal_color::Light;
use straal_math::Vec3;

use super::{BsdfSample, Transport, fresnel, mirror::reflected};

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

impl Dielectric {
    pub(super) fn albedo(&self) -> Light {
        let share = fresnel::dielectric(1.0, self.eta).reflected;
        self.reflectance * share + self.transmittance * (1.0 - share)
    }

    /// Reflects with the probability of Fresnel's share, so that both weights are 1 but for tint and the
    /// compression of radiance.
    #[inline]
    pub(super) fn sample(&self, wo: Vec3, u_lobe: f32, transport: Transport) -> Option<BsdfSample> {
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
