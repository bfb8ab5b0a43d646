//! Rectangles as they are seen from a point: sampled evenly by solid angle (Ureña, Fajardo and King 2013, "An Area-Preserving Parametrization for Spherical
//! Rectangles").

use straal_math::simd::Float;
use straal_math::{DVec3, Vec3, ops};

use super::patch::Patch;

/// A rectangle in coordinates about a point: x and y along its edges, z across it and away from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphericalRectangle<F> {
    /// Of the first corner and the opposite one.
    x: [F; 2],
    y: [F; 2],
    /// At or below 0.
    z: F,
    /// The lengths of the edges.
    size: [F; 2],
    /// Cosines across the planes through the point and the two edges along x.
    b: [F; 2],
    k: F,
    /// Its solid angle, in sr.
    pub solid_angle: F,
}

/// Below this solid angle, in sr, single precision begins to lose it, and sampling by area does as well: seen from there the rectangle is small.
pub(super) const LEAST: f32 = 0.05;

impl<F: Float> SphericalRectangle<F> {
    /// A patch whose axes are at right angles, seen from `p`.
    #[inline(always)]
    pub fn new(patch: &Patch, p: Vec3<F>) -> Self {
        let (a, b) = (patch.a.length(), patch.b.length());
        let (x, y) = (patch.a * (1.0 / a), patch.b * (1.0 / b));
        let d = DVec3::uniform(patch.origin) - p.to_double();
        let along = |axis: DVec3| F::from_double(d.dot(DVec3::uniform(axis)));
        let size = [F::splat(a as f32), F::splat(b as f32)];
        let (x0, y0, z) = (along(x), along(y), -along(x.cross(y)).abs());
        let (x1, y1) = (x0 + size[0], y0 + size[1]);
        // Of the normals of the four planes through the point and an edge, the part across the rectangle; those and the edges meet in its inner angles.
        let across = |v: F| v / (v * v + z * z).sqrt();
        let n = [-across(y0), across(x1), across(y1), -across(x0)];
        let angle = |a: F, b: F| ops::acos(ops::clamp(-(a * b), F::splat(-1.0), F::ONE));
        let g = [angle(n[0], n[1]), angle(n[1], n[2]), angle(n[2], n[3]), angle(n[3], n[0])];
        let k = F::splat(2.0 * std::f32::consts::PI) - g[2] - g[3];
        Self { x: [x0, x1], y: [y0, y1], z, size, b: [n[0], n[2]], k, solid_angle: g[0] + g[1] - k }
    }

    /// Where it is large enough to be sampled so.
    #[inline(always)]
    pub fn is_large(&self) -> F::Mask {
        self.solid_angle.gt(F::splat(LEAST)) & self.z.lt(F::ZERO)
    }

    /// Coordinates from 0 to 1 along both edges, by numbers from 0 to 1.
    #[inline(always)]
    pub fn sample(&self, u: [F; 2]) -> [F; 2] {
        let [x0, x1] = self.x;
        let (sin, cos) = ops::sin_cos(u[0] * self.solid_angle + self.k);
        let f = (cos * self.b[0] - self.b[1]) / sin;
        let c = (F::ONE / (f * f + self.b[0] * self.b[0]).sqrt()).copysign(f);
        let c = ops::clamp(c, F::splat(-1.0), F::ONE);
        let lack = (F::ONE - c * c).max(F::splat(1e-12)).sqrt();
        let x = ops::clamp(-(c * self.z) / lack, x0, x1);
        let d2 = x * x + self.z * self.z;
        let h = self.y.map(
            #[inline(always)]
            |y| y / (d2 + y * y).sqrt(),
        );
        let h = h[0] + u[1] * (h[1] - h[0]);
        let lack = F::ONE - h * h;
        let y = F::select(lack.gt(F::splat(1e-6)), h * (d2 / lack).sqrt(), self.y[1]);
        let part = |v: F, first: F, size: F| ops::clamp((v - first) / size, F::ZERO, F::ONE);
        [part(x, x0, self.size[0]), part(y, self.y[0], self.size[1])]
    }
}
