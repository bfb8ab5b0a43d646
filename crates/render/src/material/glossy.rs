//! # Glossy
//!
//! The textbook's glossy reflector (Suffern 2007, chapter 25): a mirror whose image is blurred. Directions lie about the mirrored one, by a power e of
//! the cosine to it, p = (e + 1) / 2 pi cos^e; those that would lie below the surface are turned half-way round the mirrored direction, which brings
//! them above it. What is reflected is the share k_r at every angle,
//!
//! f |cos| = k_r p (once more as much where a direction's partner lies below).
//!
//! Of even surroundings each viewer sees the share k_r, exactly. Reciprocity doesn't hold, since f is divided by the cosine of `wi` alone, so that of a lamp at a
//! grazing angle more than all light comes back. Phong's highlight alone, normalised
//! ([`super::Phong`] without an even part), is reciprocal and loses light at grazing angles: no lobe about the mirrored direction has both.

use std::f32::consts::TAU;

use straal_color::Light;
use straal_math::simd::Float;
use straal_math::{Frame, Vec3, ops, warp};
use straal_scene::desc;

use super::many::{self, Lobe, These, is_lobe};
use super::{Bsdf, BsdfSample, Recipe, Scatter, Transport, Wants, facing_or_zero};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// A blurred mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlossyMaterial {
    /// Share of light that is reflected: k_r.
    pub reflectance: Value<Colour>,
    /// Sharpness of the image: e.
    pub exponent: Value<f32>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

impl Recipe for GlossyMaterial {
    type Described = desc::Glossy;

    fn of(d: &desc::Glossy, paint: &mut Paint<'_>) -> Self {
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            exponent: paint.number(&d.exponent),
            two_sided: d.two_sided,
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.reflectance.varies() || self.exponent.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        Bsdf::Glossy(Glossy {
            reflectance: reading.eval(&self.reflectance, at),
            exponent: ops::clamp(reading.eval(&self.exponent, at), 0.0, 1e5),
            two_sided: self.two_sided,
        })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let reflectance = super::testing::WHITE.into();
        vec![(Self { reflectance, exponent: 100.0.into(), two_sided: true }, super::BsdfKind::Glossy)]
    }
}

/// A blurred mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glossy<F: Float = f32> {
    /// Share of light that is reflected.
    pub reflectance: Light<F>,
    /// Sharpness of the image.
    pub exponent: F,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: F::Mask,
}

impl Glossy {
    /// The density of `wi`; 0 below the surface. `wo` is above it.
    #[inline(always)]
    pub(crate) fn pdf<F: Float>(exponent: F, wo: Vec3<F>, wi: Vec3<F>) -> F {
        let cos = wi.z * wo.z - (wi.x * wo.x + wi.y * wo.y);
        let lit = cos.gt(F::ZERO) & wi.z.gt(F::ZERO);
        let lobe = (exponent + 1.0) * (1.0 / TAU) * ops::pow(F::select(lit, cos, F::ONE), exponent);
        // The partner's height, and whether it lies below.
        let folded = (cos * wo.z * 2.0 - wi.z).le(F::ZERO);
        F::select(lit, F::select(folded, lobe + lobe, lobe), F::ZERO)
    }

    /// A direction by that density.
    #[inline(always)]
    pub(crate) fn draw<F: Float>(exponent: F, wo: Vec3<F>, u: [F; 2]) -> Vec3<F> {
        let lobe = warp::cosine_power_hemisphere(u, exponent);
        let frame = Frame::from_normal(Vec3::new(-wo.x, -wo.y, wo.z));
        let drawn = frame.to_world(lobe);
        let partner = frame.to_world(Vec3::new(-lobe.x, -lobe.y, lobe.z));
        let below = drawn.z.le(F::ZERO);
        let choose = |a: F, b: F| F::select(below, a, b);
        Vec3::new(choose(partner.x, drawn.x), choose(partner.y, drawn.y), choose(partner.z, drawn.z))
    }
}

impl<F: Float> Lobe<F> for Glossy<F> {
    type One = Glossy;

    #[inline(always)]
    fn gather(these: impl These<Glossy>) -> Self {
        Self {
            reflectance: many::light(these, |g: &Glossy| g.reflectance),
            exponent: many::each(these, |g: &Glossy| g.exponent),
            two_sided: many::which::<_, F>(these, |g: &Glossy| g.two_sided),
        }
    }

    #[inline(always)]
    fn eval_pdf(&self, wo: Vec3<F>, wi: Vec3<F>, _: Transport) -> (Light<F>, F) {
        let side = facing_or_zero(wo, self.two_sided);
        let (wo, wi) = (Vec3::new(wo.x, wo.y, side * wo.z), Vec3::new(wi.x, wi.y, side * wi.z));
        let pdf = Glossy::pdf(self.exponent, wo, wi);
        let pdf = F::select(side.ne(F::ZERO), pdf, F::ZERO);
        (self.reflectance * pdf, pdf)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, _: F, u: [F; 2], _: Transport) -> (BsdfSample<F>, F::Mask) {
        let side = facing_or_zero(wo, self.two_sided);
        let wo = Vec3::new(wo.x, wo.y, side * wo.z);
        let wi = Glossy::draw(self.exponent, wo, u);
        let pdf = Glossy::pdf(self.exponent, wo, wi);
        let sample = BsdfSample::reflected(Vec3::new(wi.x, wi.y, side * wi.z), self.reflectance, pdf);
        (sample, side.ne(F::ZERO) & pdf.gt(F::ZERO))
    }
}

impl Scatter for Glossy {
    is_lobe!(Glossy);

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    fn albedo(&self) -> Light {
        self.reflectance
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let of = |name, exponent, two_sided| {
            Example::new(name, Bsdf::Glossy(Self { reflectance: WHITE, exponent, two_sided }))
                .albedo(1.0)
                .one_way()
        };
        vec![
            of("glossy", 100.0, true).focus(4),
            of("glossy, sharp", 5000.0, true).focus(8),
            of("glossy, dull", 1.0, true),
            of("glossy, one-sided", 20.0, false).focus(2),
        ]
    }
}
