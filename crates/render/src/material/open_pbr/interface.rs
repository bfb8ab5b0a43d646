//! What smooth boundaries reflect: Fresnel's equations, their mean over all directions, and metals by two colours.

use straal_color::Light;
use straal_math::simd::Float;

use crate::material::fresnel;

/// Share of unpolarised light that is reflected between transparent media: `cos` >= 0 of the direction, `eta` the index beyond the
/// boundary over that before it.
#[inline(always)]
pub(in super::super) fn dielectric<F: Float>(cos: F, eta: F) -> F {
    fresnel::dielectric(cos, eta).reflected
}

/// The cosine of the refracted direction, 0 for total reflection.
#[inline(always)]
pub(in super::super) fn refracted_cos<F: Float>(cos: F, eta: F) -> F {
    fresnel::dielectric(cos, eta).cos_refracted
}

/// The mean of [`dielectric`] over directions weighted by their cosine, within half a percent (Kulla and Conty 2017, "Revisiting Physically
/// Based Shading at Imageworks", slide 18).
#[inline(always)]
pub(in super::super) fn mean<F: Float>(eta: F) -> F {
    let above = (eta - F::ONE) / (F::splat(4.085_67) + eta * 1.000_71);
    let below =
        F::splat(0.997_118) + eta * (F::splat(0.1014) + eta * (F::splat(-0.965_241) - eta * 0.130_607));
    F::select(eta.gt(F::ONE), above, below)
}

/// Share that is reflected straight back.
#[inline(always)]
pub(in super::super) fn facing<F: Float>(eta: F) -> F {
    let r = (eta - F::ONE) / (eta + F::ONE);
    r * r
}

/// The index whose [`facing`] reflectance is that of `eta` times a weight, on the same side of 1.
#[inline(always)]
pub(in super::super) fn weighted<F: Float>(eta: F, weight: F) -> F {
    let r = (facing(eta) * weight).min(F::splat(0.9999)).sqrt();
    let above = (F::ONE + r) / (F::ONE - r);
    F::select(eta.lt(F::ONE), F::ONE / above, above)
}

/// The cosine of the angle of 82 degrees at which the second colour of a metal counts, and the fifth power of 1 less it.
const EDGE: f32 = 1.0 / 7.0;
const REST_5: f32 = {
    let c = 1.0 - EDGE;
    c * c * c * c * c
};

/// What is taken from Schlick's curve for a metal to have a tint at its edge.
#[inline(always)]
fn dip<F: Float>(f0: Light<F>, edge: Light<F>) -> Light<F> {
    let rest = Light::splat(F::ONE) - f0;
    (f0 + rest * F::splat(REST_5))
        * (Light::splat(F::ONE) - edge)
        * F::splat(1.0 / (EDGE * REST_5 * (1.0 - EDGE)))
}

/// Reflectance of a metal: `f0` straight back, and `edge` times Schlick's curve at 82 degrees (the F82-tint model of Kutz, Hašan and
/// Edmondson 2021, "Novel aspects of the Adobe Standard Material", after Hoffman 2019).
#[inline(always)]
pub(in super::super) fn metal<F: Float>(cos: F, f0: Light<F>, edge: Light<F>) -> Light<F> {
    let c = F::ONE - cos;
    let c2 = c * c;
    let c5 = c2 * c2 * c;
    (f0 + (Light::splat(F::ONE) - f0 - dip(f0, edge) * (cos * c)) * c5).as_shares()
}

/// The mean of [`metal`] over directions weighted by their cosine.
#[inline(always)]
pub(in super::super) fn metal_mean<F: Float>(f0: Light<F>, edge: Light<F>) -> Light<F> {
    (f0 + (Light::splat(F::ONE) - f0) * F::splat(1.0 / 21.0) - dip(f0, edge) * F::splat(1.0 / 126.0))
        .as_shares()
}
