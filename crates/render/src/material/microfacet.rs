//! Microfacets of any kind: after Trowbridge and Reitz (1975; GGX of Walter et al. 2007) or after Beckmann (1963), of one roughness along
//! the tangent and another across it, each written once for many surfaces side by side.
//!
//! Directions are unit vectors in the local frame of the surface; m is the normal of a facet, with z > 0. Shadowing is Smith's, of both
//! directions independently (G = G1 G1).

use std::f32::consts::{FRAC_1_PI, TAU};

use straal_math::simd::{Float, Mask};
use straal_math::{Vec3, ops};
use straal_scene::desc;

/// How rough.
#[derive(Clone, Copy, Debug)]
pub struct Facets<F: Float = f32> {
    /// Along the tangent and across it.
    alpha: [F; 2],
    /// Beckmann's, else GGX.
    beckmann: F::Mask,
}

impl Facets {
    /// Of roughness along the tangent and across it, held within [10^-4, 1].
    pub fn new(alpha: [f32; 2], distribution: desc::Distribution) -> Self {
        let beckmann = distribution == desc::Distribution::Beckmann;
        Self { alpha: alpha.map(|a| ops::clamp(a, 1e-4, 1.0)), beckmann }
    }

    /// Whether they are Beckmann's.
    pub(super) fn are_beckmanns(&self) -> bool {
        self.beckmann
    }

    /// Roughness along the tangent and across it.
    pub(super) fn alphas(&self) -> [f32; 2] {
        self.alpha
    }
}

impl<F: Float> Facets<F> {
    /// The mean roughness, by which tables are looked up.
    #[inline(always)]
    pub(super) fn mean_alpha(&self) -> F {
        (self.alpha[0] * self.alpha[1]).sqrt()
    }

    /// The same written for other numbers of lanes: roughness and kind.
    #[inline(always)]
    pub fn of_lanes(alpha: [F; 2], beckmann: F::Mask) -> Self {
        Self { alpha, beckmann }
    }

    /// The density of facet normals D(m) per solid angle and area, for m along `h`, which may have any length but 0.
    #[inline(always)]
    pub(super) fn density(self, h: Vec3<F>) -> F {
        let (x, y) = (h.x / self.alpha[0], h.y / self.alpha[1]);
        let slope = x * x + y * y;
        let (zz, hh) = (h.z * h.z, h.length_squared());
        let scale = F::splat(FRAC_1_PI) / (self.alpha[0] * self.alpha[1]);
        // GGX: 1 / (pi a b (x²/a² + y²/b² + z²)²).
        let ratio = hh / (slope + zz);
        let ggx = scale * ratio * ratio;
        if !self.beckmann.any() {
            return ggx;
        }
        // Beckmann: exp(-(x²/a² + y²/b²) / z²) / (pi a b z⁴).
        let upright = zz.gt(F::splat(1e-20) * hh);
        let zz = F::select(upright, zz, F::ONE);
        let ratio = hh / zz;
        let bell = F::select(upright, ops::exp(-(slope / zz)) * scale * ratio * ratio, F::ZERO);
        F::select(self.beckmann, bell, ggx)
    }

    /// Smith's share of the facets that are seen from `v`, G1 (Walter et al. 2007, eq. 27 and 34).
    #[inline(always)]
    pub(super) fn seen(self, v: Vec3<F>) -> F {
        let (cos, spread) = (v.z.abs(), self.spread(v));
        let ggx = (cos + cos) / (cos + (cos * cos + spread * spread).sqrt());
        if !self.beckmann.any() {
            return ggx;
        }
        let a = cos / spread;
        let rational = (a * 3.535 + a * a * 2.181) / (a * 2.276 + a * a * 2.577 + 1.0);
        let bell = F::select(a.lt(F::splat(1.6)), rational, F::ONE);
        F::select(self.beckmann, bell, ggx)
    }

    /// By how much roughness tilts what is seen from `v`: sqrt(a² x² + b² y²).
    #[inline(always)]
    fn spread(self, v: Vec3<F>) -> F {
        let (x, y) = (self.alpha[0] * v.x, self.alpha[1] * v.y);
        (x * x + y * y).sqrt()
    }

    /// Draws a facet normal for `v`, with z > 0: of GGX in proportion to how much of it is seen (Dupuy and Benyoub 2023, "Sampling Visible GGX
    /// Normals with Spherical Caps"); of Beckmann in proportion to D(m) cos.
    #[inline(always)]
    pub(super) fn sample(self, v: Vec3<F>, u: [F; 2]) -> Vec3<F> {
        self.sample_within(v, u, F::ONE)
    }

    /// The density of [`Self::sample`], for m along `h`, whose z is above 0.
    #[inline(always)]
    pub(super) fn pdf(self, v: Vec3<F>, h: Vec3<F>) -> F {
        let (cos, spread) = (v.z, self.spread(v));
        let length = h.length_squared().sqrt();
        let density = self.density(h);
        // G1(v) D (v.m) / cos v.
        let seen = F::splat(2.0) / (cos + (cos * cos + spread * spread).sqrt());
        let ggx = seen * density * (v.dot(h) / length).abs();
        F::select(self.beckmann, density * (h.z / length), ggx)
    }

    /// The cap of GGX's visible facets from which reflection can leave the surface, by its lower end over that of the whole cap (Eto and Tokuyoshi 2023,
    /// "Bounded VNDF Sampling for Smith-GGX Reflections").
    #[inline(always)]
    pub(super) fn bound(self, v: Vec3<F>) -> F {
        let a = self.alpha[0].min(self.alpha[1]).min(F::ONE);
        let s = F::ONE + (v.x * v.x + v.y * v.y).sqrt();
        let (aa, ss) = (a * a, s * s);
        (F::ONE - aa) * ss / (ss + aa * v.z * v.z)
    }

    /// As [`Self::sample`] for reflection alone: of GGX's facets fewer whose reflection ends in the surface.
    #[inline(always)]
    pub(super) fn sample_reflecting(self, v: Vec3<F>, u: [F; 2]) -> Vec3<F> {
        self.sample_within(v, u, self.bound(v))
    }

    /// The density of the direction that the facet of [`Self::sample_reflecting`], along `h`, reflects to `v`.
    #[inline(always)]
    pub(super) fn pdf_reflecting(self, v: Vec3<F>, h: Vec3<F>) -> F {
        let (cos, spread) = (v.z, self.spread(v));
        let length = h.length_squared().sqrt();
        let density = self.density(h);
        let ggx = density / ((self.bound(v) * cos + (cos * cos + spread * spread).sqrt()) * 2.0);
        // Of facets drawn by D cos, over the stretch of reflecting.
        let bell = density * (h.z / length) / ((v.dot(h) / length).abs() * 4.0);
        F::select(self.beckmann, bell, ggx)
    }

    /// What GGX's density of a facet is to be multiplied by for that of the direction which it reflects to `v`, for one drawn with
    /// [`Self::sample_within`]; for a bound of 1 also G1(v) / (4 cos v).
    #[inline(always)]
    pub(super) fn reflects_within(self, v: Vec3<F>, bound: F) -> F {
        let spread = self.spread(v);
        F::ONE / ((bound * v.z + (v.z * v.z + spread * spread).sqrt()) * 2.0)
    }

    /// As [`Self::sample`], of the part of GGX's cap that `bound` leaves: all of it for 1.
    #[inline(always)]
    pub(super) fn sample_within(self, v: Vec3<F>, u: [F; 2], bound: F) -> Vec3<F> {
        let (s, c) = ops::sin_cos(u[1] * TAU);
        let [a, b] = self.alpha;
        let stretched = Vec3::new(a * v.x, b * v.y, v.z);
        let stretched = stretched * (F::ONE / stretched.length_squared().sqrt());
        // An even point of the cap of reflected directions; half-way to it is the facet.
        let low = bound * stretched.z;
        let z = (F::ONE - u[0]) * (low + 1.0) - low;
        let r = ((F::ONE - z) * (z + 1.0)).max(F::ZERO).sqrt();
        let h = Vec3::new(stretched.x + r * c, stretched.y + r * s, stretched.z + z);
        let mut m = Vec3::new(a * h.x, b * h.y, h.z.max(F::ZERO));
        if self.beckmann.any() {
            // The square of a slope, measured in roughness, is spread exponentially.
            let slope = (-ops::ln((F::ONE - u[0]).max(F::splat(1e-30)))).max(F::ZERO).sqrt();
            let choose = |x: F, y: F| F::select(self.beckmann, x, y);
            m = Vec3::new(choose(a * slope * c, m.x), choose(b * slope * s, m.y), choose(F::ONE, m.z));
        }
        m * (F::ONE / m.length_squared().sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::SphereGrid;
    use straal_math::simd::{Isa, Kernel, Simd};

    fn kinds() -> Vec<Facets> {
        use desc::Distribution::{Beckmann, Ggx};
        vec![
            Facets::new([0.3, 0.3], Ggx),
            Facets::new([0.2, 0.7], Ggx),
            Facets::new([0.4, 0.4], Beckmann),
            Facets::new([0.5, 0.25], Beckmann),
        ]
    }

    #[test]
    fn facets_cover_the_surface_once() {
        for facets in kinds() {
            let f = |m: Vec3| if m.z > 0.0 { f64::from(facets.density(m) * m.z) } else { 0.0 };
            let all = SphereGrid { focus: 3, ..SphereGrid::default() }.total(f, 1e-4);
            assert!((all - 1.0).abs() < 2e-3, "{facets:?}: {all}");
        }
    }

    /// What is seen of all facets is the projected area: the integral of G1 D (v.m) is cos v (for Beckmann's rational fit, within a percent).
    #[test]
    fn what_is_seen_is_the_projected_area() {
        for facets in kinds() {
            let v = Vec3::new(0.6, 0.3, 0.741_619_8);
            let f = |m: Vec3| {
                let towards = v.dot(m);
                if m.z > 0.0 && towards > 0.0 {
                    f64::from(facets.seen(v) * facets.density(m) * towards)
                } else {
                    0.0
                }
            };
            let all = SphereGrid { focus: 3, ..SphereGrid::default() }.total(f, 1e-4);
            assert!((all / f64::from(v.z) - 1.0).abs() < 1e-2, "{facets:?}: {all}");
        }
    }

    struct Lanes<'a>(&'a mut Vec<[f32; 4]>);

    impl Kernel for Lanes<'_> {
        type Output = ();

        #[inline(always)]
        fn run<F: Float>(self) {
            for first in (0..64).step_by(F::WIDTH) {
                let number = |i: usize, k: u32| {
                    let bits = ((first + i) as u32 * 4 + k).wrapping_mul(0x9e37_79b9);
                    (bits >> 8) as f32 / 16_777_216.0
                };
                let lane = |k: u32| {
                    F::from_fn(
                        #[inline(always)]
                        |i| number(i, k),
                    )
                };
                let facets =
                    Facets::of_lanes([lane(0) * 0.5 + 0.05, lane(1) * 0.5 + 0.05], lane(2).gt(F::splat(0.5)));
                let v = Vec3::new(lane(3) - 0.5, lane(1) - 0.5, lane(0) + 0.1);
                let v = v * (F::ONE / v.length_squared().sqrt());
                let m = facets.sample_reflecting(v, [lane(1), lane(2)]);
                let found = [m.x, facets.pdf(v, m), facets.pdf_reflecting(v, m), facets.seen(v)];
                let rows = found.map(|f| f.to_array());
                for i in 0..F::WIDTH {
                    self.0.push([0, 1, 2, 3].map(|k: usize| rows[k].as_ref()[i]));
                }
            }
        }
    }

    #[test]
    fn side_by_side_is_as_one_by_one() {
        let mut plain = Vec::new();
        Simd::PLAIN.run(Lanes(&mut plain));
        for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
            let mut found = Vec::new();
            simd.run(Lanes(&mut found));
            assert_eq!(found, plain, "{simd:?}");
        }
    }
}
