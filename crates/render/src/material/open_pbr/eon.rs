//! Rough diffuse surfaces: EON, the energy-preserving model after Fujii's Oren-Nayar (Portsmouth, Kutz and Hill 2025, "EON: A
//! practical energy-preserving rough diffuse BRDF").

use std::f32::consts::{FRAC_1_PI, PI};

use straal_color::Light;
use straal_math::Vec3;
use straal_math::simd::Float;

/// 1/2 - 2 / (3 pi).
const A: f32 = 0.5 - 2.0 / (3.0 * PI);
/// 2/3 - 28 / (15 pi).
const B: f32 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// Share of the light that a white surface scatters once, for the cosine `mu` of the direction: the paper's polynomial, within
/// 0.1 % of the integral.
#[inline(always)]
fn once<F: Float>(mu: F, roughness: F) -> F {
    let c = F::ONE - mu;
    let g = c
        * (F::splat(0.057_108_53)
            + c * (F::splat(0.491_881_87) + c * (F::splat(-0.332_181_44) + c * 0.071_443)));
    (F::ONE + roughness * g) / (F::ONE + roughness * A)
}

/// f of a surface of a roughness from 0 (Lambert) to 1 that sends back `rho` of single scattering, for directions above it. Reciprocal;
/// white sends back all to the error of the polynomial.
#[inline(always)]
pub(super) fn value<F: Float>(rho: Light<F>, roughness: F, wo: Vec3<F>, wi: Vec3<F>) -> Light<F> {
    let s = wo.x * wi.x + wo.y * wi.y;
    let s_over_t = F::select(s.gt(F::ZERO), s / wo.z.max(wi.z), s);
    let a = F::ONE / (F::ONE + roughness * A);
    let single = a * (F::ONE + roughness * s_over_t) * FRAC_1_PI;
    let mean = a * (F::ONE + roughness * B);
    let least = F::splat(1e-7);
    let lost = F::ONE - mean;
    let multiple = (F::ONE - once(wo.z, roughness)).max(least) * (F::ONE - once(wi.z, roughness)).max(least)
        / lost.max(least)
        * mean
        * FRAC_1_PI;
    rho.map(
        #[inline(always)]
        |rho| rho * (single + rho * multiple / (F::ONE - rho * lost)),
    )
}
