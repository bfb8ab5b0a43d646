//! The spot light.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Readings, ShadingPoint, Value};
use straal_math::simd::Float;
use straal_math::{DVec3, Frame, Vec3, ops, warp};
use straal_scene::desc;

use super::projector::{Thrown, mean_texture};
use super::{Emitter, Extent, LightSample, Reach, Receiver, Shine, point::towards, strength, unit};
use crate::paint::Paint;
use crate::shape::Geometry;

/// A point that shines in a cone, perhaps through a mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    position: Vec3,
    axis: Vec3,
    intensity: Value<Colour>,
    mask: Option<Mask>,
    falloff: Falloff,
    /// Angles from the axis in radians, `beam` <= `cutoff`, and their cosines.
    beam: f32,
    cutoff: f32,
    cos_beam: f32,
    cos_cutoff: f32,
}

/// What a spot's light passes through.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mask {
    /// The share that passes, over the square around the cone.
    texture: Value<Colour>,
    picture: Thrown,
    /// Of the light that the cone would have without it, the part that passes, in its strongest lane.
    passes: f64,
}

/// How a spot's intensity falls from full at the beam's edge to nothing at the cutoff.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Falloff {
    /// Linear in the angle from the axis, as in Mitsuba.
    Linear,
    /// A smooth step 3x² - 2x³ in the cosine of the angle, as in pbrt.
    Smooth,
}

/// A cone of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Its axis, of any length but zero.
    pub axis: Vec3,
    /// Angle from the axis in degrees up to which intensity is full.
    pub beam: f64,
    /// Angle from the axis in degrees from which there is none; at most 180.
    pub cutoff: f64,
    /// What is between the two.
    pub falloff: Falloff,
}

impl SpotLight {
    /// Where its intensity is looked up.
    fn place(&self) -> ShadingPoint {
        ShadingPoint::of([0.0; 2], self.position)
    }

    /// Where it is.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// Its axis, and the cosine of the angle from it from which there is no light.
    pub(super) fn cone(&self) -> (Vec3, f32) {
        (self.axis, self.cos_cutoff)
    }

    /// A direction within its cone, evenly.
    pub fn direction(&self, u: [f32; 2]) -> Vec3 {
        // A cone of no width is an axis.
        let spread = ops::max(1.0 - self.cos_cutoff, f32::MIN_POSITIVE);
        Frame::from_normal(self.axis).to_world(warp::uniform_cone(u, spread))
    }

    /// A spot of an intensity (on its axis, in W/sr); `None` when the axis has no direction. A beam wider than the
    /// cutoff is cut off.
    pub fn new(position: Vec3, intensity: impl Into<Value<Colour>>, cone: &Cone) -> Option<Self> {
        Some(Self::along(cone.axis.try_normalize()?, position, intensity.into(), cone))
    }

    /// The same for an axis of unit length, in place of the cone's.
    fn along(axis: Vec3, position: Vec3, intensity: Value<Colour>, cone: &Cone) -> Self {
        let beam = if cone.beam < cone.cutoff { cone.beam } else { cone.cutoff };
        let cosine = |degrees: f64| ops::sin_cos_degrees(degrees).1 as f32;
        Self {
            position,
            axis,
            intensity,
            mask: None,
            falloff: cone.falloff,
            beam: beam.to_radians() as f32,
            cutoff: cone.cutoff.to_radians() as f32,
            cos_beam: cosine(beam),
            cos_cutoff: cosine(cone.cutoff),
        }
    }

    /// How much of the full intensity goes in direction `w`, of any length.
    #[inline(always)]
    pub(super) fn share<F: Float>(&self, w: Vec3<F>) -> F {
        // By its tangent: near the axis the cosine has lost the angle.
        let axis = Vec3::uniform(self.axis);
        let angle = ops::atan2(axis.cross(w).length(), axis.dot(w));
        let (beam, cutoff) = (F::splat(self.beam), F::splat(self.cutoff));
        let between = match self.falloff {
            Falloff::Linear => (cutoff - angle) / (self.cutoff - self.beam),
            Falloff::Smooth => {
                let x = (ops::cos(angle) - self.cos_cutoff) / (self.cos_beam - self.cos_cutoff);
                let x = ops::clamp(x, F::ZERO, F::ONE);
                x * x * (F::splat(3.0) - x * 2.0)
            }
        };
        F::select(angle.le(beam), F::ONE, F::select(angle.ge(cutoff), F::ZERO, between))
    }

    /// Of what a scene says.
    pub(super) fn of(l: &desc::SpotLight, paint: &mut Paint<'_>, centre: DVec3) -> Emitter {
        let cone = Cone {
            axis: l.axis().as_vec3(),
            beam: l.full_beam(),
            cutoff: l.cutoff,
            falloff: match l.falloff {
                desc::Falloff::Linear => Falloff::Linear,
                desc::Falloff::Smooth => Falloff::Smooth,
            },
        };
        let position = (l.position - centre).as_vec3();
        let mut spot = Self::along(unit(l.axis()), position, paint.light(&l.intensity), &cone);
        if let Some(texture) = &l.texture {
            let texture = paint.reflectance(&desc::Varying::Texture(Box::new(texture.clone())));
            let slope = ops::tan(spot.cutoff);
            let picture = Thrown::new(spot.axis, l.up.as_vec3(), [slope, slope]);
            let of = |w| spot.share::<f32>(w);
            let passes =
                picture.mean(|w, uv| of(w) * mean_texture(paint, &texture, uv)) / picture.mean(|w, _| of(w));
            spot.mask = Some(Mask { texture, picture, passes });
        }
        Emitter::Spot(spot)
    }
}

impl Shine for SpotLight {
    const EXTENT: Extent = Extent::None;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        (at, _): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        towards(
            (self.position, true),
            at.p,
            #[inline(always)]
            |wi| {
                let all = readings.eval(&self.intensity, &self.place()) * self.share(-wi);
                match &self.mask {
                    None => all,
                    Some(mask) => all * mask.picture.look_up((&mask.texture, self.position), -wi, readings),
                }
            },
        )
    }

    fn starts_at(&self) -> Option<Vec3> {
        Some(self.position)
    }

    fn starts_towards(&self, u: [f32; 2]) -> (Vec3, f32) {
        let spread = ops::max(1.0 - self.cos_cutoff, f32::MIN_POSITIVE);
        (self.direction(u), warp::uniform_cone_pdf(spread))
    }

    /// The full beam, and half of what is between it and the cutoff; of that what a mask lets through.
    fn power(&self, _: &Geometry, _: f64) -> f64 {
        let cosines = 0.5 * (f64::from(self.cos_beam) + f64::from(self.cos_cutoff));
        let passes = self.mask.map_or(1.0, |mask| mask.passes);
        2.0 * std::f64::consts::PI * (1.0 - cosines) * strength(&self.intensity) * passes
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        Some(Reach::Spot { spot: *self, intensity: strength(&self.intensity) as f32 })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let spot = |name, falloff| {
            let cone = Cone { axis: Vec3::new(0.1, 1.0, 0.3), beam: 30.0, cutoff: 120.0, falloff };
            let light = Self::new(Vec3::new(0.1, 0.2, -0.1), super::tests::RADIANCE, &cone);
            super::tests::Example::alone(name, Emitter::Spot(light.expect("an axis")))
        };
        vec![spot("spot", Falloff::Linear), spot("spot, smooth", Falloff::Smooth)]
    }
}
