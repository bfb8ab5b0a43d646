//! # Mirror
//!
//! Reflects light in one direction, at every angle alike: an ideal, where a real mirror is a conductor.

use straal_color::Light;
use straal_math::Vec3;

use super::{BsdfSample, facing};

/// A perfect mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Share of light that is reflected.
    pub reflectance: Light,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Mirror {
    #[inline]
    pub(super) fn sample(&self, wo: Vec3) -> Option<BsdfSample> {
        facing(wo, self.two_sided)?;
        Some(reflected(wo, self.reflectance, 1.0))
    }
}

/// The delta lobe of a mirror: chosen with probability `pdf`, its coefficient divided by that is `weight`.
#[inline(always)]
pub(super) fn reflected(wo: Vec3, weight: Light, pdf: f32) -> BsdfSample {
    let wi = Vec3::new(-wo.x, -wo.y, wo.z);
    BsdfSample { wi, weight, pdf, delta: true, transmitted: false, eta: 1.0, wavelength: 0.0 }
}
