//! Fresnel's equations: the share of unpolarised light that a smooth boundary reflects.

use straal_color::Light;
use straal_math::ops;
use straal_math::simd::Float;

/// What becomes of light at a boundary between dielectrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split<F = f32> {
    /// Share that is reflected; 1 for total reflection.
    pub reflected: F,
    /// Cosine of the refracted direction to the normal, 0 for total reflection.
    pub cos_refracted: F,
}

/// Between transparent media: `cos` >= 0 of the incident direction, `eta` the index of refraction beyond the boundary
/// over that before it.
#[inline(always)]
pub fn dielectric<F: Float>(cos: F, eta: F) -> Split<F> {
    // Snell's law, its square: sin² = 1 - cos² as a product, which is exact near normal and grazing incidence.
    let sin2 = ops::max((F::ONE - cos) * (F::ONE + cos), F::ZERO);
    let cos2_refracted = F::ONE - sin2 / (eta * eta);
    // NaN, as from two indices of 0, reflects as well.
    let passes = cos2_refracted.gt(F::ZERO);
    let cos_refracted = cos2_refracted.sqrt();
    // Amplitudes perpendicular and parallel to the plane of incidence.
    let s = (cos - eta * cos_refracted) / (cos + eta * cos_refracted);
    let p = (eta * cos - cos_refracted) / (eta * cos + cos_refracted);
    Split {
        reflected: F::select(passes, (s * s + p * p) * 0.5, F::ONE),
        cos_refracted: F::select(passes, cos_refracted, F::ZERO),
    }
}

/// The same with the share by Schlick's approximation (1994, eq. 15): R + (1 - R) (1 - cos)^5 with the share R of light that
/// arrives straight on, and the cosine on the side of the smaller index, so that both sides see the same share.
#[inline]
pub fn dielectric_by_schlick(cos: f32, eta: f32) -> Split {
    let exact = dielectric(cos, eta);
    if exact.cos_refracted == 0.0 {
        return exact;
    }
    let straight = (eta - 1.0) / (eta + 1.0);
    let cos = if eta < 1.0 { exact.cos_refracted } else { cos };
    Split { reflected: schlick(straight * straight, cos), ..exact }
}

/// Schlick's curve (1994): from `straight` at cosine 1 to 1 at grazing angles.
#[inline(always)]
pub fn schlick<F: Float>(straight: F, cos: F) -> F {
    let lack = F::ONE - cos;
    let square = lack * lack;
    straight + (F::ONE - straight) * (square * square * lack)
}

/// Against a conductor of complex index `eta` + i `k` (relative to the medium before it), lane by lane; `cos` in
/// [0, 1]. Exact (Born and Wolf, Principles of Optics, 14.2). 1 where both are 0, so that a dead lane stays harmless.
#[inline(always)]
pub fn conductor<F: Float>(cos: F, eta: Light<F>, k: Light<F>) -> Light<F> {
    let cos2 = cos * cos;
    let sin2 = ops::max((F::ONE - cos) * (F::ONE + cos), F::ZERO);
    eta.zip(
        k,
        #[inline(always)]
        |eta, k| {
            // (a + ib)² = (eta + ik)² - sin².
            let real = eta * eta - k * k - sin2;
            let modulus = (real * real + eta * 4.0 * eta * k * k).sqrt();
            let a = ops::max((modulus + real) * 0.5, F::ZERO).sqrt();
            let sum = modulus + cos2;
            let cross = a * 2.0 * cos;
            let s = (sum - cross) / (sum + cross);
            let sum_p = modulus * cos2 + sin2 * sin2;
            let cross_p = cross * sin2;
            let divisor = sum_p + cross_p;
            let p_over_s = F::select(divisor.gt(F::ZERO), (sum_p - cross_p) / divisor, F::ONE);
            s * 0.5 * (F::ONE + p_over_s)
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_is_the_textbooks() {
        assert!((dielectric(1.0, 1.5).reflected - 0.04).abs() < 1e-7);
        assert!((dielectric(1.0, 1.0 / 1.5).reflected - 0.04).abs() < 1e-7);
        let (eta, k) = (Light::rgb([0.2, 0.92, 1.1]), Light::rgb([3.91, 2.45, 2.14]));
        let f = conductor(1.0, eta, k);
        for lane in 0..3 {
            let (n, k) = (f64::from(eta[lane]), f64::from(k[lane]));
            let want = ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k);
            assert!((f64::from(f[lane]) - want).abs() < 1e-6);
        }
        assert_eq!(f[3], 1.0);
    }

    #[test]
    fn special_angles_hold() {
        // Brewster's angle, tan = eta: only the perpendicular part is reflected.
        let eta = 1.5_f32;
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        let split = dielectric(cos, eta);
        let s = (cos - eta * split.cos_refracted) / (cos + eta * split.cos_refracted);
        assert!((split.reflected - 0.5 * s * s).abs() < 1e-7);
        // Beyond the critical angle everything is reflected, and along the surface as well.
        let critical = (1.0 - 1.0 / (1.5_f64 * 1.5)).sqrt() as f32;
        assert!(dielectric(critical + 1e-3, 1.0 / 1.5).reflected < 1.0);
        assert_eq!(dielectric(critical - 1e-3, 1.0 / 1.5), Split { reflected: 1.0, cos_refracted: 0.0 });
        assert_eq!(dielectric(0.0, 1.5).reflected, 1.0);
        assert_eq!(conductor(0.0, Light::splat(1.1), Light::splat(2.0)), Light::ONE);
        let matched = dielectric(0.3, 1.0);
        assert!(matched.reflected < 1e-12 && (matched.cos_refracted - 0.3).abs() < 1e-6);
    }

    #[test]
    fn conductor_without_absorption_is_a_dielectric() {
        for i in 0..=100 {
            let cos = i as f32 / 100.0;
            for eta in [0.5, 1.2, 1.5, 3.0] {
                let (c, d) =
                    (conductor(cos, Light::splat(eta), Light::ZERO)[0], dielectric(cos, eta).reflected);
                assert!((c - d).abs() < 1e-5, "cos {cos}, eta {eta}: {c} {d}");
            }
        }
    }

    #[test]
    fn light_sees_the_same_share_from_both_sides() {
        for i in 1..=100 {
            let cos = i as f32 / 100.0;
            let out = dielectric(cos, 1.5);
            let back = dielectric(out.cos_refracted, 1.0 / 1.5);
            // The square of the cosine comes back as a difference of numbers near 1.
            let tolerance = 1e-6 / cos;
            assert!((out.reflected - back.reflected).abs() < 4.0 * tolerance);
            assert!((back.cos_refracted - cos).abs() < tolerance);
        }
    }
}
