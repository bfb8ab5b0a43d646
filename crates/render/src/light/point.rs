//! The point light.

use crate::lanes::{Colour, Lanes, Reading};
use crate::texture::{ShadingPoint, Value};
use straal_color::Light;
use straal_math::Vec3;

use super::{LightSample, Target, strength};
use crate::shape::offset::End;

/// A point that shines evenly all around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it is.
    pub position: Vec3,
    /// Radiant intensity in W/sr.
    pub intensity: Value<Colour>,
}

impl PointLight {
    /// Where its intensity is looked up.
    fn place(&self) -> ShadingPoint {
        ShadingPoint::of([0.0; 2], self.position)
    }

    /// See [`super::Emitter::sample`].
    pub fn sample<L: Lanes>(&self, p: Vec3, reading: &Reading<'_, L>) -> Option<LightSample> {
        towards(self.position, p, |_| reading.eval(&self.intensity, &self.place()))
    }

    /// See [`super::Emitter::power`].
    pub fn power(&self) -> f64 {
        4.0 * std::f64::consts::PI * strength(&self.intensity)
    }
}

/// The one direction to a point whose intensity towards `p` is a function of `wi`; it falls with the distance squared.
pub(super) fn towards(position: Vec3, p: Vec3, intensity: impl FnOnce(Vec3) -> Light) -> Option<LightSample> {
    let way = position - p;
    let wi = way.try_normalize()?;
    let radiance = intensity(wi) / way.length_squared();
    let target = Target::Point(End { p: position, p_err: Vec3::ZERO, ng: Vec3::ZERO });
    (!radiance.is_black() && radiance.is_finite()).then_some(LightSample {
        wi,
        radiance,
        pdf: 1.0,
        delta: true,
        target,
    })
}
