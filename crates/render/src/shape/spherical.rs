//! Rectangles as they are seen from a point: sampled evenly by solid angle (Ureña, Fajardo and King 2013, "An Area-Preserving Parametrization for Spherical
//! Rectangles"), or nearly by projected solid angle, as pbrt does it (Pharr, Jakob and Humphreys 2023, section 6.5.3): the map by solid angle is fed with numbers that
//! were drawn by the cosines to its corners, mixed over the square. (Exactly by projected solid angle goes Peters 2021, "BRDF Importance Sampling for Polygonal
//! Lights", with a search for each sample; of the mixed cosines the density is exact as well, and on large rectangles that stand across a horizon less good.)

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
        let n = [-across(y0, z), across(x1, z), across(y1, z), -across(x0, z)];
        let g = [angle(n[0], n[1]), angle(n[1], n[2]), angle(n[2], n[3]), angle(n[3], n[0])];
        let k = F::splat(2.0 * std::f32::consts::PI) - g[2] - g[3];
        let solid_angle = g[0] + g[1] - k;
        Self { x: [x0, x1], y: [y0, y1], z, size, b: [n[0], n[2]], k, solid_angle }
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

    /// The numbers that [`Self::sample`] makes these coordinates of: the share of the solid angle on this side of the first, and of the strip there on this
    /// side of the second.
    #[inline(always)]
    pub fn numbers(&self, [x, y]: [F; 2]) -> [F; 2] {
        let (x, y) = (self.x[0] + x * self.size[0], self.y[0] + y * self.size[1]);
        let up_to = across(x, self.z);
        let [first, second] = self.b;
        let part = angle(first, up_to) + angle(up_to, second) - self.k;
        let d2 = x * x + self.z * self.z;
        let [h0, h, h1] = [self.y[0], y, self.y[1]].map(
            #[inline(always)]
            |y| y / (d2 + y * y).sqrt(),
        );
        [part / self.solid_angle, (h - h0) / (h1 - h0)].map(
            #[inline(always)]
            |v| ops::clamp(v, F::ZERO, F::ONE),
        )
    }
}

/// Of the normal of the plane through the point and an edge at `v`, the part across the rectangle.
#[inline(always)]
fn across<F: Float>(v: F, z: F) -> F {
    v / (v * v + z * z).sqrt()
}

/// The inner angle between two planes by those parts.
#[inline(always)]
fn angle<F: Float>(a: F, b: F) -> F {
    ops::acos(ops::clamp(-(a * b), F::splat(-1.0), F::ONE))
}

/// The least that a corner counts, however flat its light falls: as much of the rectangle as lies above the horizon must be drawn.
const LEAST_COSINE: f32 = 0.01;

/// What falls on a surface from the corners of a rectangle, and by it numbers from 0 to 1 drawn: a density over the unit square that is mixed between its corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners<F>([F; 4]);

impl<F: Float> Corners<F> {
    /// For a surface at `p` with the normal `n`; even where that is zero.
    #[inline(always)]
    pub fn new(patch: &Patch, (p, n): (Vec3<F>, Vec3<F>)) -> Self {
        let origin: Vec3<F> = Vec3::from_double(DVec3::uniform(patch.origin) - p.to_double());
        let (a, b) = (Vec3::uniform(patch.a.as_vec3()), Vec3::uniform(patch.b.as_vec3()));
        let anywhere = n.x.eq(F::ZERO) & n.y.eq(F::ZERO) & n.z.eq(F::ZERO);
        Self([origin, origin + a, origin + b, origin + a + b].map(
            #[inline(always)]
            |d| {
                let cos = d.dot(n) / d.length();
                let cos = F::select(cos.gt(F::splat(LEAST_COSINE)), cos, F::splat(LEAST_COSINE));
                F::select(anywhere, F::ONE, cos)
            },
        ))
    }

    /// Draws by two even numbers.
    #[inline(always)]
    pub fn sample(&self, u: [F; 2]) -> [F; 2] {
        let [w00, w10, w01, w11] = self.0;
        let v = linear(u[1], [w00 + w10, w01 + w11]);
        [linear(u[0], [w00 + (w01 - w00) * v, w10 + (w11 - w10) * v]), v]
    }

    /// The density of [`Self::sample`].
    #[inline(always)]
    pub fn pdf(&self, [u, v]: [F; 2]) -> F {
        let [w00, w10, w01, w11] = self.0;
        let (near, far) = (w00 + (w10 - w00) * u, w01 + (w11 - w01) * u);
        (near + (far - near) * v) * 4.0 / (w00 + w10 + w01 + w11)
    }
}

/// A number from 0 to 1 by a density that goes evenly from `a` to `b`, both above 0.
#[inline(always)]
fn linear<F: Float>(u: F, [a, b]: [F; 2]) -> F {
    let square = a * a + (b * b - a * a) * u;
    (u * (a + b) / (a + square.max(F::ZERO).sqrt())).min(F::ONE)
}
