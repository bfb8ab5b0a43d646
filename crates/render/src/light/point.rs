//! The point light.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Readings, ShadingPoint, Value};
use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{DVec3, Vec3};
use straal_scene::desc;

use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine, strength};
use crate::paint::Paint;
use crate::shape::Geometry;
use crate::shape::offset::End;

/// A point that shines evenly all around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it is.
    pub position: Vec3,
    /// Radiant intensity in W/sr.
    pub intensity: Value<Colour>,
    /// Whether its light falls with the distance squared, and isn't everywhere what it is at a distance of 1.
    pub falls: bool,
}

impl PointLight {
    /// Where its intensity is looked up.
    fn place(&self) -> ShadingPoint {
        ShadingPoint::of([0.0; 2], self.position)
    }

    /// Of what a scene says.
    pub(super) fn of(l: &desc::PointLight, paint: &mut Paint<'_>, centre: DVec3) -> Emitter {
        let position = (l.position - centre).as_vec3();
        let falls = l.decay == desc::Decay::InverseSquare;
        Emitter::Point(Self { position, intensity: paint.light(&l.intensity), falls })
    }
}

impl Shine for PointLight {
    const EXTENT: Extent = Extent::None;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        (at, _): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        towards(
            (self.position, self.falls),
            at.p,
            #[inline(always)]
            |_| readings.eval(&self.intensity, &self.place()),
        )
    }

    /// Of one that doesn't fall there are no rays.
    fn starts_at(&self) -> Option<Vec3> {
        self.falls.then_some(self.position)
    }

    /// Of one that doesn't fall, what it would send out if it did.
    fn power(&self, _: &Geometry, _: f64) -> f64 {
        4.0 * std::f64::consts::PI * strength(&self.intensity)
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        let intensity = strength(&self.intensity) as f32;
        Some(Reach::Point { position: self.position, intensity, falls: self.falls })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let point = |name, falls| {
            let position = Vec3::new(0.1, 0.2, -0.1);
            let light = Self { position, intensity: super::tests::RADIANCE.into(), falls };
            super::tests::Example::alone(name, Emitter::Point(light))
        };
        vec![point("point", true), point("point, the same from afar", false)]
    }
}

/// The one direction to a point whose intensity towards `p` is a function of `wi`; whether it falls with the distance squared.
#[inline(always)]
pub(super) fn towards<F: Float>(
    (position, falls): (Vec3, bool),
    p: Vec3<F>,
    intensity: impl FnOnce(Vec3<F>) -> Light<F>,
) -> LightSample<F> {
    let position = Vec3::uniform(position);
    let way = position - p;
    let (wi, there) = way.normalize_checked();
    let mut radiance = intensity(wi);
    if falls {
        radiance = radiance / way.length_squared();
    }
    let sample = LightSample {
        delta: F::Mask::splat(true),
        far: F::Mask::splat(false),
        to: End::in_space(position),
        ..LightSample::from_afar(wi, radiance, F::ONE)
    };
    sample.only(there & !radiance.is_black() & radiance.is_finite())
}
