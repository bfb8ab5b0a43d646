//! The disc.

use straal_math::{Bounds, DVec3, Ray, Vec3, warp};

use super::exact::{at, in_interval, outward, rounded, size};
use super::plane::{meet, project};
use super::{AreaSample, ShapeHit, SurfacePoint, sampling};

/// A disc, or an ellipse: center + x a + y b for x² + y² <= 1. Its normal is a × b.
///
/// Hit coordinates: x and y. Texture coordinates: (x + 1) / 2, (y + 1) / 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Center.
    pub center: Vec3,
    /// First half-axis (or any conjugate radius).
    pub a: Vec3,
    /// Second half-axis, not parallel to the first.
    pub b: Vec3,
}

impl Disc {
    /// The round disc about `center` that faces along `normal`; `None` when that has no direction.
    pub fn facing(center: DVec3, normal: DVec3, radius: f64) -> Option<Self> {
        let (a, b) = sampling::tangents(normal.try_normalize()?);
        Some(Self { center: center.as_vec3(), a: (a * radius).as_vec3(), b: (b * radius).as_vec3() })
    }

    /// See [`super::Geometry::bounds`].
    pub fn bounds(&self) -> Bounds {
        let (c, a, b) = self.doubles();
        let reach = |a: f64, b: f64| (a * a + b * b).sqrt();
        let r = DVec3::new(reach(a.x, b.x), reach(a.y, b.y), reach(a.z, b.z));
        outward(c - r, c + r, size(c) + size(r))
    }

    /// See [`super::Geometry::intersect`].
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        let (c, a, b) = self.doubles();
        let n = a.cross(b);
        let t = meet(ray, c, n);
        let hit = in_interval(ray, t)?;
        let [x, y] = coordinates(ray.o.as_dvec3() + ray.d.as_dvec3() * t - c, a, b, n);
        (x * x + y * y <= 1.0).then_some(ShapeHit { t: hit, u: x as f32, v: y as f32 })
    }

    /// See [`super::Geometry::surface`].
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let (c, a, b) = self.doubles();
        let n = a.cross(b).try_normalize().unwrap_or(DVec3::Y);
        self.point(project(at(ray, hit.t), c, n), n, [hit.u, hit.v])
    }

    fn point(&self, q: DVec3, n: DVec3, [x, y]: [f32; 2]) -> SurfacePoint {
        let (c, a, b) = self.doubles();
        let (p, p_err) = rounded(q, size(c) + size(a) + size(b));
        let ng = n.as_vec3();
        SurfacePoint { p, p_err, ng, n: ng, uv: [0.5 + 0.5 * x, 0.5 + 0.5 * y], dpdu: self.a * 2.0 }
    }

    /// See [`super::Geometry::area`].
    pub fn area(&self) -> f32 {
        let (_, a, b) = self.doubles();
        (std::f64::consts::PI * a.cross(b).length()) as f32
    }

    /// See [`super::Geometry::sample_area`].
    pub fn sample_area(&self, u: [f32; 2]) -> AreaSample {
        let (c, a, b) = self.doubles();
        let [x, y] = warp::concentric_disc(u);
        let n = a.cross(b).try_normalize().unwrap_or(DVec3::Y);
        let q = c + a * f64::from(x) + b * f64::from(y);
        AreaSample { point: self.point(q, n, [x, y]), pdf_area: 1.0 / self.area() }
    }

    fn doubles(&self) -> (DVec3, DVec3, DVec3) {
        (self.center.as_dvec3(), self.a.as_dvec3(), self.b.as_dvec3())
    }
}

/// x and y of a vector r = x a + y b, with n = a × b: x = (r × b)·n / n², y = (a × r)·n / n².
#[inline]
pub(super) fn coordinates(r: DVec3, a: DVec3, b: DVec3, n: DVec3) -> [f64; 2] {
    let scale = 1.0 / n.dot(n);
    [r.cross(b).dot(n) * scale, a.cross(r).dot(n) * scale]
}
