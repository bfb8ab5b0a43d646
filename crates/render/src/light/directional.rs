//! Parallel light.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Reading, ShadingPoint, Value};
use straal_math::{DVec3, Vec3};
use straal_scene::desc;

use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine, Target, strength};
use crate::error::CompileError;
use crate::paint::Paint;
use crate::shape::Geometry;

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

    /// Of what a scene says.
    pub(super) fn of(
        l: &desc::DirectionalLight,
        paint: &mut Paint<'_>,
        _: DVec3,
    ) -> Result<Emitter, CompileError> {
        Self::new(l.axis().as_vec3(), paint.light(&l.irradiance)?)
            .map(Emitter::Directional)
            .ok_or_else(|| CompileError::new("the direction of a directional light has no length"))
    }
}

impl Shine for DirectionalLight {
    const EXTENT: Extent = Extent::None;

    #[inline]
    fn sample<L: Lanes>(
        &self,
        _: &Geometry,
        _: (&Receiver, [f32; 2]),
        reading: &Reading<'_, L>,
    ) -> Option<LightSample> {
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
    fn power(&self, _: &Geometry, disc: f64) -> f64 {
        disc * strength(&self.irradiance)
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Parallel { wi: self.wi, irradiance: strength(&self.irradiance) as f32 })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let light = Self::new(Vec3::new(1.0, -2.0, 0.3), super::tests::RADIANCE).expect("a direction");
        vec![super::tests::Example::alone("directional", Emitter::Directional(light))]
    }
}
