//! # Diffuse
//!
//! Scatters light evenly, so that it looks equally bright from everywhere (Lambert 1760): f = reflectance / pi.
//! Chalk, plaster, paper. Where it is rough its facets do so ([`super::RoughDiffuse`]).

use std::f32::consts::FRAC_1_PI;

use straal_color::Light;
use straal_math::simd::Float;
use straal_math::{Vec3, ops, warp};
use straal_scene::desc;

use super::many::{self, Lobe, These, is_lobe};
use super::{Black, Bsdf, BsdfSample, Recipe, RoughDiffuse, Scatter, Transport, Wants, facing_or_zero};
use crate::lanes::{Colour, Lanes};
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// What scatters light evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseMaterial {
    /// Share of light that is reflected.
    pub reflectance: Value<Colour>,
    /// How rough it is.
    pub roughness: Value<f32>,
    /// By EON where it is rough, else by Oren and Nayar.
    pub eon: bool,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: bool,
}

/// Black, smooth and the same from both sides.
impl Default for DiffuseMaterial {
    fn default() -> Self {
        Self { reflectance: Light::ZERO.into(), roughness: 0.0.into(), eon: true, two_sided: true }
    }
}

impl Recipe for DiffuseMaterial {
    type Described = desc::Diffuse;

    fn of(d: &desc::Diffuse, paint: &mut Paint<'_>) -> Self {
        Self {
            reflectance: paint.reflectance(&d.reflectance),
            roughness: paint.number(&d.roughness),
            eon: d.model == desc::RoughDiffuse::Eon,
            two_sided: d.two_sided,
        }
    }

    fn wants(&self) -> Wants {
        Wants::point(self.reflectance.varies() || self.roughness.varies())
    }

    #[inline]
    fn bsdf<'w, L: Lanes>(&'w self, at: &ShadingPoint, reading: &Reading<'w, L>) -> Bsdf<'w> {
        let reflectance = reading.eval(&self.reflectance, at);
        if reflectance.is_black() {
            return Bsdf::Black(Black);
        }
        let roughness = reading.eval(&self.roughness, at);
        if roughness > 0.0 {
            let (eon, two_sided) = (self.eon, self.two_sided);
            return Bsdf::RoughDiffuse(RoughDiffuse {
                reflectance,
                roughness: ops::min(roughness, 1.0),
                eon,
                two_sided,
            });
        }
        Bsdf::Diffuse(Diffuse { reflectance, two_sided: self.two_sided })
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, super::BsdfKind)> {
        let of = |v: f32| Self { reflectance: Light::rgb([v; 3]).into(), ..Self::default() };
        let rough = Self { roughness: 0.5.into(), ..of(0.5) };
        vec![
            (of(0.5), super::BsdfKind::Diffuse),
            (of(0.0), super::BsdfKind::Black),
            (rough, super::BsdfKind::RoughDiffuse),
        ]
    }
}

/// An evenly scattering surface, or many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffuse<F: Float = f32> {
    /// Share of light that is reflected.
    pub reflectance: Light<F>,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: F::Mask,
}

impl<F: Float> Lobe<F> for Diffuse<F> {
    type One = Diffuse;

    #[inline(always)]
    fn gather(these: impl These<Diffuse>) -> Self {
        Self {
            reflectance: many::light(these, |d: &Diffuse| d.reflectance),
            two_sided: many::which::<_, F>(these, |d: &Diffuse| d.two_sided),
        }
    }

    #[inline(always)]
    fn eval_pdf(&self, wo: Vec3<F>, wi: Vec3<F>, _: Transport) -> (Light<F>, F) {
        let cos = facing_or_zero(wo, self.two_sided) * wi.z;
        let pdf = F::select(cos.gt(F::ZERO), cos * FRAC_1_PI, F::ZERO);
        (self.reflectance * pdf, pdf)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, _: F, u: [F; 2], _: Transport) -> (BsdfSample<F>, F::Mask) {
        let side = facing_or_zero(wo, self.two_sided);
        let d = warp::cosine_hemisphere(u);
        let wi = Vec3::new(d.x, d.y, side * d.z);
        let there = side.ne(F::ZERO) & d.z.gt(F::ZERO);
        (BsdfSample::reflected(wi, self.reflectance, d.z * FRAC_1_PI), there)
    }
}

impl Scatter for Diffuse {
    const LOSES_BELOW: bool = true;

    is_lobe!(Diffuse);

    #[inline]
    fn is_delta(&self) -> bool {
        false
    }

    fn albedo(&self) -> Light {
        self.reflectance
    }

    fn ambient(&self) -> Light {
        self.reflectance
    }

    #[cfg(test)]
    fn examples() -> Vec<super::testing::Example> {
        use super::testing::{Example, WHITE};
        let red = Self { reflectance: Light::rgb([0.8, 0.5, 0.2]), two_sided: true };
        let one_sided = Self { reflectance: WHITE, two_sided: false };
        vec![
            Example::new("diffuse", Bsdf::Diffuse(red)).albedo(f64::from(0.8_f32)),
            Example::new("diffuse, one-sided", Bsdf::Diffuse(one_sided)).albedo(1.0),
        ]
    }
}
