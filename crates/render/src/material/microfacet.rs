//! Microfacets after Trowbridge and Reitz (1975), called GGX by Walter et al. 2007, of two roughnesses, with Smith's shadowing; for
//! many vertices side by side.
//!
//! Directions are unit vectors with z > 0, in a frame whose x and y lie along the two roughnesses; m is the normal of a facet.

use std::f32::consts::{FRAC_1_PI, TAU};

use straal_math::simd::Float;
use straal_math::{Vec3, ops};

/// How rough, along x and along y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facets<F> {
    x: F,
    y: F,
}

/// Below 10^-4 a lobe is narrower than single precision can tell directions apart.
pub(super) const SMOOTH: f32 = 1e-4;

impl<F: Float> Facets<F> {
    /// Of GGX's alpha along x and y.
    #[inline(always)]
    pub fn new(x: F, y: F) -> Self {
        Self { x: x.max(F::splat(SMOOTH)), y: y.max(F::splat(SMOOTH)) }
    }

    /// The density of facet normals D(m) per solid angle and area, for m along `h`, which may have any length but 0.
    #[inline(always)]
    pub fn density(self, h: Vec3<F>) -> F {
        // 1 / (pi a b ((x / a)² + (y / b)² + z²)²), written with h so that nothing cancels near the normal.
        let ab = self.x * self.y;
        let spread = h.x * h.x * (self.y / self.x) + h.y * h.y * (self.x / self.y) + h.z * h.z * ab;
        let ratio = h.length_squared() / spread;
        ab * ratio * ratio * FRAC_1_PI
    }

    /// The length of v with facets stretched to be as rough as a half ball.
    #[inline(always)]
    fn stretch(self, v: Vec3<F>) -> F {
        let (x, y) = (self.x * v.x, self.y * v.y);
        (x * x + y * y + v.z * v.z).sqrt()
    }

    /// Smith's share of the facets that are seen from `v`, G1 (Walter et al. 2007, eq. 34; Heitz 2014 for two roughnesses).
    #[inline(always)]
    pub fn seen(self, v: Vec3<F>) -> F {
        v.z * 2.0 / (v.z + self.stretch(v))
    }

    /// Up to which part of the way below the horizon reflected directions are drawn: 1 for all that facets send somewhere, less to leave out
    /// what goes into the surface anyway (Eto and Tokuyoshi 2023, "Bounded VNDF Sampling for Smith-GGX Reflections").
    #[inline(always)]
    pub fn bound(self, v: Vec3<F>) -> F {
        let a = self.x.min(self.y).min(F::ONE);
        let a2 = a * a;
        let s = F::ONE + (v.x * v.x + v.y * v.y).sqrt();
        let s2 = s * s;
        (F::ONE - a2) * s2 / (s2 + a2 * v.z * v.z)
    }

    /// What a facet's density is to be multiplied by for the density of the direction reflected by facets drawn with [`Self::draw`].
    #[inline(always)]
    pub fn reflects(self, v: Vec3<F>, bound: F) -> F {
        F::ONE / ((bound * v.z + self.stretch(v)) * 2.0)
    }

    /// Draws a facet normal in proportion to how much of it is seen from `v` (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals
    /// with Spherical Caps"), within a bound.
    #[inline(always)]
    pub fn draw(self, v: Vec3<F>, bound: F, u: [F; 2]) -> Vec3<F> {
        let stretched = Vec3::new(self.x * v.x, self.y * v.y, v.z).normalize();
        // An even point of the cap of reflected directions; half-way to it is the facet.
        let least = bound * stretched.z;
        let z = (F::ONE - u[0]) * (F::ONE + least) - least;
        let r = ((F::ONE - z) * (F::ONE + z)).max(F::ZERO).sqrt();
        let (s, c) = ops::sin_cos(u[1] * TAU);
        let h = stretched + Vec3::new(r * c, r * s, z);
        Vec3::new(self.x * h.x, self.y * h.y, h.z.max(F::ZERO)).normalize()
    }
}
