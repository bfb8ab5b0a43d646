//! Parallel light.

use crate::lanes::{Colour, Lanes, Reading};
use crate::texture::{ShadingPoint, Value};
use straal_math::Vec3;

use super::{LightSample, Target, strength};

/// Parallel light from infinitely far away, like the sun's (without its disc).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    wi: Vec3,
    irradiance: Value<Colour>,
}

impl DirectionalLight {
    /// Light that travels in a direction (of any length) and puts `irradiance`, in W/m², on a surface that faces it;
    /// `None` when the direction is none.
    pub fn new(direction: Vec3, irradiance: impl Into<Value<Colour>>) -> Option<Self> {
        Some(Self { wi: (-direction).try_normalize()?, irradiance: irradiance.into() })
    }

    /// Unit vector towards it.
    pub(super) fn wi(&self) -> Vec3 {
        self.wi
    }

    /// Its irradiance.
    pub(super) fn irradiance(&self) -> &Value<Colour> {
        &self.irradiance
    }

    /// See [`super::Emitter::sample`].
    pub fn sample<L: Lanes>(&self, reading: &Reading<'_, L>) -> Option<LightSample> {
        let radiance = reading.eval(&self.irradiance, &ShadingPoint::NOWHERE);
        (!radiance.is_black()).then_some(LightSample {
            wi: self.wi,
            radiance,
            pdf: 1.0,
            delta: true,
            target: Target::Direction,
        })
    }

    /// What falls on the scene's disc.
    pub fn power(&self, disc: f64) -> f64 {
        disc * strength(&self.irradiance)
    }
}
