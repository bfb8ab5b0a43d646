//! Parallel light.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Readings, ShadingPoint, Value};
use straal_math::simd::{Float, Mask};
use straal_math::{DVec3, Vec3};
use straal_scene::desc;

use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine, SunDisc, strength, unit};
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

    /// Of what a scene says: this, or a disc.
    pub(super) fn of(l: &desc::DirectionalLight, paint: &mut Paint<'_>, _: DVec3) -> Emitter {
        let (wi, irradiance) = (unit(-l.axis()), paint.light(&l.irradiance));
        if l.angle > 0.0 {
            return Emitter::Disc(SunDisc::towards(wi, l.angle, irradiance));
        }
        Emitter::Directional(Self { wi, irradiance })
    }
}

impl Shine for DirectionalLight {
    const EXTENT: Extent = Extent::None;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        _: (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        let radiance = readings.eval(&self.irradiance, &ShadingPoint::NOWHERE);
        let wi = Vec3::uniform(self.wi);
        LightSample {
            delta: F::Mask::splat(true),
            ..LightSample::from_afar(wi, radiance, F::ONE).only(!radiance.is_black())
        }
    }

    /// What falls on the scene's disc.
    fn power(&self, _: &Geometry, disc: f64) -> f64 {
        disc * strength(&self.irradiance)
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Parallel { wi: self.wi, irradiance: strength(&self.irradiance) as f32, sin: 0.0 })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let light = Self::new(Vec3::new(1.0, -2.0, 0.3), super::tests::RADIANCE).expect("a direction");
        vec![super::tests::Example::alone("directional", Emitter::Directional(light))]
    }
}
