//! A disc of the sky that shines: the sun, or parallel light with a width.

use crate::lanes::{Colour, Lanes};
use crate::texture::{Readings, ShadingPoint, Value};
use straal_color::Light;
use straal_math::simd::{Float, Mask};
use straal_math::{Frame, Vec3, ops, warp};

use super::{Extent, LightSample, Reach, Receiver, Shine, strength};
use crate::shape::Geometry;

/// A disc infinitely far away, which may be darker towards its rim. All of it is sampled, evenly by solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunDisc {
    /// About the direction towards its middle.
    frame: Frame,
    /// 1 - cosine of the angle from its middle to its rim: the cosine itself would lose the size of the sun.
    spread: f32,
    /// On a surface that faces it, in W/m².
    irradiance: Value<Colour>,
    /// The square of the sine of that angle.
    sin_squared: f32,
    limb_darkening: bool,
}

/// Radiance against that of the disc's middle, as a polynomial in the cosine at the sun's surface: Neckel and Labs' measurements (1994, "Solar Limb
/// Darkening 1986-1990") at 560 nm, as Hošek and Wilkie (2013) have them. One for all wavelengths: the rim's redness is left out.
const LIMB: [f32; 6] = [0.26892, 1.34319, -1.58427, 1.91271, -1.3135, 0.37295];

/// The mean of that over the disc: of the k-th power of the cosine it is 2 / (k + 2).
const LIMB_MEAN: f32 = LIMB[0]
    + LIMB[1] * (2.0 / 3.0)
    + LIMB[2] * 0.5
    + LIMB[3] * 0.4
    + LIMB[4] * (1.0 / 3.0)
    + LIMB[5] * (2.0 / 7.0);

impl SunDisc {
    /// Towards a unit vector, so many degrees wide from rim to rim.
    pub fn towards(wi: Vec3, degrees: f64, irradiance: impl Into<Value<Colour>>) -> Self {
        // 1 - cos a = 2 sin²(a / 2).
        let half = ops::sin_cos_degrees(0.25 * degrees).0;
        let (sin, _) = ops::sin_cos_degrees(0.5 * degrees);
        Self {
            frame: Frame::from_normal(wi),
            spread: (2.0 * half * half) as f32,
            irradiance: irradiance.into(),
            sin_squared: (sin * sin) as f32,
            limb_darkening: false,
        }
    }

    /// The same, darker towards its rim as the sun is.
    pub const fn darkened(self) -> Self {
        Self { limb_darkening: true, ..self }
    }

    /// The direction towards its middle.
    pub const fn middle(&self) -> Vec3 {
        self.frame.n
    }

    /// What its radiance is in parts of its irradiance, 0 beyond its rim: the disc's projection onto a surface that faces it has the area π sin².
    #[inline(always)]
    fn per_irradiance<F: Float>(&self, wi: Vec3<F>) -> F {
        let lack = (wi - Vec3::uniform(self.frame.n)).length_squared() * 0.5;
        let mut radiance = F::splat(std::f32::consts::FRAC_1_PI / self.sin_squared);
        if self.limb_darkening {
            // On the sun's surface, whose disc is seen so large: sin² = 2 lack - lack².
            let out = lack * (F::splat(2.0) - lack) / self.sin_squared;
            let cos = (F::ONE - out).max(F::ZERO).sqrt();
            let bright = LIMB.iter().rev().fold(
                F::ZERO,
                #[inline(always)]
                |sum, k| sum * cos + *k,
            );
            radiance *= bright / LIMB_MEAN;
        }
        F::select(lack.le(F::splat(self.spread)), radiance, F::ZERO)
    }
}

impl Shine for SunDisc {
    const EXTENT: Extent = Extent::Disc;

    #[inline(always)]
    fn sample_many<F: Float, L: Lanes>(
        &self,
        _: &Geometry,
        (at, u): (&Receiver<F>, [F; 2]),
        readings: &Readings<'_, L>,
    ) -> LightSample<F> {
        let spread = F::splat(self.spread);
        let frame = Frame {
            s: Vec3::uniform(self.frame.s),
            t: Vec3::uniform(self.frame.t),
            n: Vec3::uniform(self.frame.n),
        };
        let (wi, is_direction) = frame.to_world(warp::uniform_cone(u, spread)).normalize_checked();
        let (radiance, pdf) = self.radiance_pdf_from_many(at, wi, readings);
        LightSample::from_afar(wi, radiance, pdf).only(is_direction & !radiance.is_black())
    }

    #[inline(always)]
    fn radiance_pdf_from_many<F: Float, L: Lanes>(
        &self,
        _: &Receiver<F>,
        wi: Vec3<F>,
        readings: &Readings<'_, L>,
    ) -> (Light<F>, F) {
        let share = self.per_irradiance(wi);
        let irradiance: Light<F> = readings.eval(&self.irradiance, &ShadingPoint::NOWHERE);
        let is_lit = share.gt(F::ZERO) & F::Mask::splat(self.irradiance.most() > 0.0);
        let pdf = F::select(is_lit, warp::uniform_cone_pdf(F::splat(self.spread)), F::ZERO);
        (irradiance * share, pdf)
    }

    #[inline]
    fn pdf_from(&self, _: &Receiver, wi: Vec3) -> f32 {
        let is_lit = self.per_irradiance(wi) > 0.0 && self.irradiance.most() > 0.0;
        if is_lit { warp::uniform_cone_pdf(self.spread) } else { 0.0 }
    }

    /// What falls on discs as wide as the scene, each across its direction: radiance times solid angle.
    fn power(&self, _: &Geometry, disc: f64) -> f64 {
        let solid_angle = 2.0 * std::f64::consts::PI * f64::from(self.spread);
        disc * strength(&self.irradiance) * solid_angle / (std::f64::consts::PI * f64::from(self.sin_squared))
    }

    fn reach(&self, _: &Geometry) -> Option<Reach> {
        let (wi, sin) = (self.frame.n, self.sin_squared.sqrt());
        Some(Reach::Parallel { wi, irradiance: strength(&self.irradiance) as f32, sin })
    }

    #[cfg(test)]
    fn examples() -> Vec<super::tests::Example> {
        let towards = Vec3::new(1.0, 2.0, 0.3).normalize();
        let light = |degrees| Self::towards(towards, degrees, super::tests::RADIANCE);
        let alone = |name, light| super::tests::Example::alone(name, super::Emitter::Disc(light));
        vec![
            alone("disc of the sky", light(50.0)),
            alone("disc of the sky, darker at its rim", light(80.0).darkened()),
            alone("disc of the sky, widest", light(179.0)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::tests::monte_carlo;
    use crate::testing::in_rgb;

    /// A surface that faces it receives what it is said to, whatever its size and its rim.
    #[test]
    fn it_brings_its_irradiance() {
        let n = Vec3::new(-0.36, 0.48, 0.8);
        for degrees in [0.01, 0.5358, 30.0, 120.0, 179.0] {
            for disc in [SunDisc::towards(n, degrees, super::super::tests::RADIANCE)]
                .into_iter()
                .flat_map(|d| [d, d.darkened()])
            {
                let brought = monte_carlo(5, 20_000, |u| {
                    let at = Receiver { p: Vec3::ZERO, n };
                    disc.sample(&Geometry::default(), (&at, u), &in_rgb())
                        .map_or(0.0, |s| f64::from(s.radiance[0] * s.wi.dot(n) / s.pdf))
                });
                crate::shape::tests::assert_agrees("disc", brought, 2.0);
            }
        }
    }

    #[test]
    fn its_rim_is_darker_and_beyond_is_nothing() {
        let disc = SunDisc::towards(Vec3::Y, 0.5358, Light::rgb([1.0; 3])).darkened();
        let at = |degrees: f64| {
            let (s, c) = ops::sin_cos_degrees(degrees);
            disc.radiance_pdf_from(
                &Receiver::anywhere(Vec3::ZERO),
                Vec3::new(s as f32, c as f32, 0.0),
                &in_rgb(),
            )
            .0[0]
        };
        let (middle, half, rim) = (at(0.0), at(0.134), at(0.267));
        assert!(
            (half / middle - 0.9).abs() < 0.05 && rim / middle < 0.5 && rim > 0.0,
            "{half} {rim} of {middle}"
        );
        assert_eq!((at(0.27), at(90.0), at(180.0)), (0.0, 0.0, 0.0));
    }
}
