//! The rectangle, and any parallelogram.

use straal_math::{Bounds, DVec3, Ray, Vec3};

use super::disc::coordinates;
use super::exact::{at, in_interval, outward, rounded, size};
use super::plane::{meet, project};
use super::{AreaSample, ShapeHit, SurfacePoint};

/// A rectangle, or any parallelogram: corner + x a + y b for x and y in [0, 1]. Its normal is a × b.
///
/// Hit and texture coordinates: x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    /// Corner.
    pub corner: Vec3,
    /// First edge.
    pub a: Vec3,
    /// Second edge, not parallel to the first.
    pub b: Vec3,
}

impl Parallelogram {
    /// See [`super::Geometry::bounds`].
    pub fn bounds(&self) -> Bounds {
        let (c, a, b) = self.doubles();
        let (zero, both) = (DVec3::ZERO, a + b);
        let min = zero.min(a).min(b).min(both);
        let max = zero.max(a).max(b).max(both);
        outward(c + min, c + max, size(c) + size(a) + size(b))
    }

    /// See [`super::Geometry::intersect`].
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        let (c, a, b) = self.doubles();
        let n = a.cross(b);
        let t = meet(ray, c, n);
        let hit = in_interval(ray, t)?;
        let [x, y] = coordinates(ray.o.as_dvec3() + ray.d.as_dvec3() * t - c, a, b, n);
        let inside = (0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y);
        inside.then_some(ShapeHit { t: hit, u: x as f32, v: y as f32 })
    }

    /// See [`super::Geometry::surface`].
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let (c, a, b) = self.doubles();
        let n = a.cross(b).try_normalize().unwrap_or(DVec3::Y);
        self.point(project(at(ray, hit.t), c, n), n, [hit.u, hit.v])
    }

    fn point(&self, q: DVec3, n: DVec3, uv: [f32; 2]) -> SurfacePoint {
        let (c, a, b) = self.doubles();
        let (p, p_err) = rounded(q, size(c) + size(a) + size(b));
        let ng = n.as_vec3();
        SurfacePoint { p, p_err, ng, n: ng, uv, dpdu: self.a }
    }

    /// See [`super::Geometry::area`].
    pub fn area(&self) -> f32 {
        let (_, a, b) = self.doubles();
        a.cross(b).length() as f32
    }

    /// See [`super::Geometry::sample_area`].
    pub fn sample_area(&self, u: [f32; 2]) -> AreaSample {
        let (c, a, b) = self.doubles();
        let n = a.cross(b).try_normalize().unwrap_or(DVec3::Y);
        let q = c + a * f64::from(u[0]) + b * f64::from(u[1]);
        AreaSample { point: self.point(q, n, u), pdf_area: 1.0 / self.area() }
    }

    fn doubles(&self) -> (DVec3, DVec3, DVec3) {
        (self.corner.as_dvec3(), self.a.as_dvec3(), self.b.as_dvec3())
    }
}
