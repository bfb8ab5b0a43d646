//! Microfacets after Trowbridge and Reitz (1975), called GGX by Walter et al. 2007, of one roughness in all
//! directions, with Smith's shadowing.
//!
//! Directions are unit vectors with z > 0, in the local frame of the surface; m is the normal of a facet.

use std::f32::consts::{FRAC_1_PI, TAU};

use straal_math::simd::Float;
use straal_math::{Vec3, ops};

/// How rough, of one surface or of many side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ggx<F = f32> {
    pub alpha: F,
}

impl Ggx {
    /// Below 10^-4 the lobe is narrower than single precision can tell directions apart: it is taken as that.
    pub(super) fn new(alpha: f32) -> Self {
        Self { alpha: ops::clamp(alpha, 1e-4, 1.0) }
    }
}

impl<F: Float> Ggx<F> {
    /// The density of facet normals D(m) per solid angle and area, for m along `h`, which may have any length
    /// but 0.
    #[inline(always)]
    pub(super) fn density(self, h: Vec3<F>) -> F {
        // alpha² / (pi (sin² + alpha² cos²)²), written with h so that nothing cancels near the normal.
        let a2 = self.alpha * self.alpha;
        let spread = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
        let ratio = h.length_squared() / spread;
        a2 * FRAC_1_PI * ratio * ratio
    }

    /// Smith's share of the facets that are seen from `v`, divided by 2 v.z: 1 / (v.z + sqrt(v.z² + alpha² sin²)).
    #[inline(always)]
    pub(super) fn seen_over_twice_cos(self, v: Vec3<F>) -> F {
        F::ONE / (v.z + self.slope(v))
    }

    /// Smith's share of the facets that are seen from `v`, G1 (Walter et al. 2007, eq. 34).
    #[inline(always)]
    pub(super) fn seen(self, v: Vec3<F>) -> F {
        v.z * 2.0 / (v.z + self.slope(v))
    }

    #[inline(always)]
    fn slope(self, v: Vec3<F>) -> F {
        let a2 = self.alpha * self.alpha;
        (v.z * v.z + a2 * (v.x * v.x + v.y * v.y)).sqrt()
    }

    /// Draws a facet normal in proportion to how much of it is seen from `v`: with density
    /// G1(v) D(m) (v.m) / v.z (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps").
    #[inline(always)]
    pub(super) fn sample_seen(self, v: Vec3<F>, u: [F; 2]) -> Vec3<F> {
        let stretched = Vec3::new(self.alpha * v.x, self.alpha * v.y, v.z).normalize();
        // An even point of the cap of reflected directions; half-way to it is the facet.
        let z = (F::ONE - u[0]) * (F::ONE + stretched.z) - stretched.z;
        let r = ops::max((F::ONE - z) * (F::ONE + z), F::ZERO).sqrt();
        let (s, c) = ops::sin_cos(u[1] * TAU);
        let h = stretched + Vec3::new(r * c, r * s, z);
        Vec3::new(self.alpha * h.x, self.alpha * h.y, ops::max(h.z, F::ZERO)).normalize()
    }
}
