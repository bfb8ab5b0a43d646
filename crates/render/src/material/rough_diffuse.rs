//! Rough diffuse surfaces, of which [`super::DiffuseMaterial`] is made where they are rough.
//!
//! They consist of facets that scatter evenly, so that the moon is as bright at its rim as in its middle. With s = wi.wo - cos i cos o and its part
//! t = s / max(cos i, cos o) where s > 0 and s elsewhere:
//!
//! - **EON** (Portsmouth, Kutz and Hill 2024, "EON: A practical energy-preserving rough diffuse BRDF", by a roughness r from 0 to 1):
//!   f = rho / pi A (1 + r t) of single bounces, A = 1 / (1 + c1 r), and rho_m / pi (1 - E(o)) (1 - E(i)) / (1 - E) of all others, with E what single bounces of a white
//!   surface send back. Energy is conserved, all of it where rho is 1 (to 0.1 %, by their fit of E); reciprocity holds.
//! - **Oren and Nayar** (1994, their qualitative model, eq. 30, with sigma in radians): f = rho / pi (A + B t) where s > 0, A = 1 - sigma² / 2 (sigma² + 0.33), B = 0.45
//!   sigma² / (sigma² + 0.09). What bounces between facets is lost; reciprocity holds.

use std::f32::consts::{FRAC_1_PI, PI};

use straal_color::Light;
use straal_math::simd::Float;
use straal_math::{Vec3, warp};

use super::many::{self, Lobe, These, is_lobe};
use super::{BsdfSample, Scatter, Transport, facing_or_zero};

/// A rough surface that scatters evenly from facet to facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDiffuse<F: Float = f32> {
    /// Share of light that is reflected.
    pub reflectance: Light<F>,
    /// How rough it is.
    pub roughness: F,
    /// By EON, else by Oren and Nayar.
    pub eon: F::Mask,
    /// Whether the back looks like the front; else it is black.
    pub two_sided: F::Mask,
}

/// c1 and c2 of EON.
const C: [f32; 2] = [0.5 - 2.0 / (3.0 * PI), 2.0 / 3.0 - 28.0 / (15.0 * PI)];

impl RoughDiffuse {
    /// What a white surface sends back of light at a cosine by single bounces (the paper's fit).
    #[inline(always)]
    pub(crate) fn single<F: Float>(roughness: F, cos: F) -> F {
        let c = F::ONE - cos;
        let g = c * (c * (c * (c * 0.071_442_99 - 0.332_181_45) + 0.491_881_88) + 0.057_108_53);
        (roughness * g + 1.0) / (roughness * C[0] + 1.0)
    }

    /// What EON's single bounces off a white surface send back in the mean over all directions.
    #[inline(always)]
    pub(crate) fn mean<F: Float>(roughness: F) -> F {
        (roughness * C[1] + 1.0) / (roughness * C[0] + 1.0)
    }

    /// f pi over the reflectance of single bounces; of EON's all others without what depends on the reflectance.
    #[inline(always)]
    pub(crate) fn shape<F: Float>(eon: F::Mask, roughness: F, wo: Vec3<F>, wi: Vec3<F>) -> [F; 2] {
        let s = wo.x * wi.x + wo.y * wi.y;
        let over = s / wo.z.max(wi.z);
        let t = F::select(s.gt(F::ZERO), over, s);
        let average = (roughness * C[1] + 1.0) / (roughness * C[0] + 1.0);
        let facets = (roughness * t + 1.0) / (roughness * C[0] + 1.0);
        let lost = |cos: F| (F::ONE - Self::single(roughness, cos)).max(F::splat(1e-7));
        let others = lost(wo.z) * lost(wi.z) / (F::ONE - average).max(F::splat(1e-7));
        let v = roughness * roughness;
        let (a, b) = (F::ONE - v * 0.5 / (v + 0.33), v * 0.45 / (v + 0.09));
        let oren_nayar = a + b * t.max(F::ZERO);
        [F::select(eon, facets, oren_nayar), F::select(eon, others, F::ZERO)]
    }
}

impl<F: Float> RoughDiffuse<F> {
    /// The value for directions above the surface.
    #[inline(always)]
    fn on_front(&self, wo: Vec3<F>, wi: Vec3<F>) -> Light<F> {
        let [facets, others] = RoughDiffuse::shape(self.eon, self.roughness, wo, wi);
        let average = RoughDiffuse::mean(self.roughness);
        self.reflectance.map(
            #[inline(always)]
            |rho| {
                let many = rho * rho * average / (F::ONE - rho * (F::ONE - average));
                (rho * facets + many * others) * FRAC_1_PI * wi.z
            },
        )
    }
}

impl<F: Float> Lobe<F> for RoughDiffuse<F> {
    type One = RoughDiffuse;

    #[inline(always)]
    fn gather(these: impl These<RoughDiffuse>) -> Self {
        Self {
            reflectance: many::light(these, |r: &RoughDiffuse| r.reflectance),
            roughness: many::each(these, |r: &RoughDiffuse| r.roughness),
            eon: many::which::<_, F>(these, |r: &RoughDiffuse| r.eon),
            two_sided: many::which::<_, F>(these, |r: &RoughDiffuse| r.two_sided),
        }
    }

    #[inline(always)]
    fn eval_pdf(&self, wo: Vec3<F>, wi: Vec3<F>, _: Transport) -> (Light<F>, F) {
        let side = facing_or_zero(wo, self.two_sided);
        let (wo, wi) = (Vec3::new(wo.x, wo.y, side * wo.z), Vec3::new(wi.x, wi.y, side * wi.z));
        let there = side.ne(F::ZERO) & wi.z.gt(F::ZERO);
        let value = Light::select(there, self.on_front(wo, wi), Light::splat(F::ZERO));
        (value, F::select(there, wi.z * FRAC_1_PI, F::ZERO))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<F>, _: F, u: [F; 2], transport: Transport) -> (BsdfSample<F>, F::Mask) {
        let d = warp::cosine_hemisphere(u);
        let wi = Vec3::new(d.x, d.y, facing_or_zero(wo, self.two_sided) * d.z);
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        (BsdfSample::reflected(wi, value * (F::ONE / pdf), pdf), pdf.gt(F::ZERO))
    }
}

impl Scatter for RoughDiffuse {
    const LOSES_BELOW: bool = true;

    is_lobe!(RoughDiffuse);

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
        let of = |name, reflectance, roughness, eon| {
            let bsdf = Self { reflectance, roughness, eon, two_sided: true };
            Example::new(name, super::Bsdf::RoughDiffuse(bsdf))
        };
        let clay = Light::rgb([0.7, 0.4, 0.3]);
        vec![
            of("white EON", WHITE, 1.0, true).nearly_energy(1e-2),
            of("white EON, half as rough", WHITE, 0.5, true).nearly_energy(1e-2),
            of("clay", clay, 0.8, true),
            of("Oren and Nayar's clay", clay, 0.5, false),
        ]
    }
}
