//! What flat shapes with two axes share.

use straal_accel as accel;
use straal_math::simd::{Double, Float};
use straal_math::{DVec3, Ray, Vec3};

use super::exact::{at, bound, padding, size};
use super::offset::End;
use super::plane::project;
use super::{ShapeHit, SurfacePoint, Tangents};

/// A plane with coordinates: origin + x a + y b; in double precision, with what follows from it kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Where x and y are 0.
    pub origin: DVec3,
    /// First axis.
    pub a: DVec3,
    /// Second axis.
    pub b: DVec3,
    /// Unit normal along a × b.
    pub n: DVec3,
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
        textured(self.level().nearest(at(ray, hit.t)), [hit.u, hit.v])
    }

    /// The point at x and y, with these as texture's.
    #[inline(always)]
    pub fn point_at(&self, xy: [f32; 2]) -> SurfacePoint {
        textured(self.end_at(xy), xy)
    }

    /// The points at these coordinates, with their errors and normals.
    #[inline(always)]
    pub fn end_at<F: Float>(&self, [x, y]: [F; 2]) -> End<F> {
        let (a, b) = (DVec3::uniform(self.a), DVec3::uniform(self.b));
        let q = DVec3::uniform(self.origin) + a * x.to_double() + b * y.to_double();
        Level::uniform(self).end(q)
    }

    /// The coordinates of a point of its plane.
    #[inline(always)]
    pub fn coordinates(&self, p: Vec3) -> [f32; 2] {
        let r = p.as_dvec3() - self.origin;
        self.dual.map(|dual| r.dot(dual) as f32)
    }

    /// The plane that it lies in.
    #[inline(always)]
    pub const fn level(&self) -> Level<f64> {
        Level { origin: self.origin, n: self.n, pad: self.pad }
    }

    /// The axes.
    pub fn tangents(&self) -> Tangents {
        Tangents::flat(self.a.as_vec3(), self.b.as_vec3())
    }
}

/// The point of a flat surface with its texture coordinates.
#[inline(always)]
fn textured(End { p, p_err, ng }: End, uv: [f32; 2]) -> SurfacePoint {
    SurfacePoint { p, p_err, ng, n: ng, uv }
}

/// The plane of a patch, or one in each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level<D> {
    origin: DVec3<D>,
    n: DVec3<D>,
    pad: D,
}

impl Level<f64> {
    /// How many numbers it has.
    pub const NUMBERS: usize = 7;
    /// Some plane.
    pub const EXAMPLE: Self = Self { origin: DVec3::ZERO, n: DVec3::Z, pad: 0.0 };
}

impl<D: Double> Level<D> {
    /// That of one patch in all lanes.
    #[inline(always)]
    pub fn uniform(patch: &Patch) -> Self {
        Self { origin: DVec3::uniform(patch.origin), n: DVec3::uniform(patch.n), pad: D::splat(patch.pad) }
    }

    /// Its numbers.
    #[inline(always)]
    pub const fn to_array(self) -> [D; Level::NUMBERS] {
        let Self { origin: o, n, pad } = self;
        [o.x, o.y, o.z, n.x, n.y, n.z, pad]
    }

    /// By its numbers.
    #[inline(always)]
    pub const fn from_array([ox, oy, oz, nx, ny, nz, pad]: [D; Level::NUMBERS]) -> Self {
        Self { origin: DVec3::new(ox, oy, oz), n: DVec3::new(nx, ny, nz), pad }
    }

    /// Its point next to `q`.
    #[inline(always)]
    pub fn nearest<F: Float<Double = D>>(&self, q: DVec3<D>) -> End<F> {
        self.end(project(q, self.origin, self.n))
    }

    /// `q`, which lies in it.
    #[inline(always)]
    fn end<F: Float<Double = D>>(&self, q: DVec3<D>) -> End<F> {
        End { p: Vec3::from_double(q), p_err: bound(q, self.pad), ng: Vec3::from_double(self.n) }
    }
}
