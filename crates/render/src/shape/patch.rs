//! What flat shapes with two axes share.

use straal_accel as accel;
use straal_math::{DVec3, Ray, Vec3};

use super::exact::{at, bound, padding, size};
use super::plane::project;
use super::{ShapeHit, SurfacePoint, Tangents};

/// A plane with coordinates: origin + x a + y b; in double precision, with what follows from it kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    /// Where x and y are 0.
    pub origin: DVec3,
    /// First axis.
    pub a: DVec3,
    /// Second axis.
    pub b: DVec3,
    /// Unit normal along a × b.
    n: DVec3,
    /// The scalar product of r = x a + y b with the first is x, with the second y. Not finite when the axes are parallel.
    dual: [DVec3; 2],
    /// For [`bound`].
    pad: f64,
}

impl Patch {
    pub fn new(origin: Vec3, a: Vec3, b: Vec3) -> Self {
        let [origin, a, b] = [origin, a, b].map(Vec3::as_dvec3);
        let cross = a.cross(b);
        let n = cross.try_normalize().unwrap_or(DVec3::Y);
        let dual = [b.cross(cross), cross.cross(a)].map(|v| v / cross.dot(cross));
        Self { origin, a, b, n, dual, pad: padding(size(origin) + size(a) + size(b)) }
    }

    /// Area of the parallelogram between the axes.
    pub fn area(&self) -> f64 {
        self.a.cross(self.b).length()
    }

    /// As a search knows it.
    pub const fn formula(&self) -> accel::Patch {
        accel::Patch { origin: self.origin, normal: self.n, dual: self.dual }
    }

    /// The point of a hit of this ray, with the coordinates of the hit as texture's.
    #[inline(always)]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.point(project(at(ray, hit.t), self.origin, self.n), [hit.u, hit.v])
    }

    /// The point at x and y, with these as texture's.
    #[inline(always)]
    pub fn point_at(&self, [x, y]: [f32; 2]) -> SurfacePoint {
        self.point(self.origin + self.a * f64::from(x) + self.b * f64::from(y), [x, y])
    }

    #[inline(always)]
    fn point(&self, q: DVec3, uv: [f32; 2]) -> SurfacePoint {
        let bound = |x: f64| bound(x, self.pad);
        let p_err = Vec3::new(bound(q.x), bound(q.y), bound(q.z));
        let ng = self.n.as_vec3();
        SurfacePoint { p: q.as_vec3(), p_err, ng, n: ng, uv }
    }

    /// The axes.
    pub fn tangents(&self) -> Tangents {
        Tangents::flat(self.a.as_vec3(), self.b.as_vec3())
    }
}
