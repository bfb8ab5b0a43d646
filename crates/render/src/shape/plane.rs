//! The unbounded plane.

use straal_math::simd::{Double, Float};
use straal_math::{Bounds, DVec3, Frame, Ray, Vec3};

use super::exact::{at, rounded, size};
use super::offset::End;
use super::{Analytic, Form, ShapeHit, SurfacePoint, Tangents};

/// A plane through a point; its normal is the one given.
///
/// Hit coordinates: none (0). Texture coordinates: metres along two fixed tangents from the given point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point of the plane.
    pub point: Vec3,
    /// Normal, of any length but zero.
    pub normal: Vec3,
}

impl Plane {
    /// See [`super::Geometry::analytic`].
    #[inline]
    pub fn analytic(&self) -> Analytic {
        Analytic::plane(self.point.as_dvec3(), self.normal.as_dvec3())
    }

    /// See [`super::Geometry::surface`].
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let q = self.project(at(ray, hit.t));
        let End { p, p_err, ng } = self.end_at::<f32>(q);
        let frame = Frame::from_normal(ng);
        let r = (q - self.point.as_dvec3()).as_vec3();
        SurfacePoint { p, p_err, ng, n: ng, uv: [r.dot(frame.s), r.dot(frame.t)] }
    }

    fn unit(&self) -> DVec3 {
        self.normal.as_dvec3().try_normalize().unwrap_or(DVec3::Y)
    }

    /// Its points next to others.
    #[inline(always)]
    fn project<D: Double>(&self, p: DVec3<D>) -> DVec3<D> {
        project(p, DVec3::uniform(self.point.as_dvec3()), DVec3::uniform(self.unit()))
    }

    /// Points that lie in it.
    #[inline(always)]
    fn end_at<F: Float>(&self, q: DVec3<F::Double>) -> End<F> {
        let (p, p_err) = rounded(q, size(q) + size(self.point.as_dvec3()));
        End { p, p_err, ng: Vec3::uniform(self.unit().as_vec3()) }
    }

    /// See [`super::Geometry::tangents`].
    pub fn tangents(&self) -> Tangents {
        Tangents::about(self.normal.try_normalize().unwrap_or(Vec3::Y))
    }
}

impl Form for Plane {
    fn bounds(&self) -> Option<Bounds> {
        None
    }

    #[inline]
    fn analytic(&self) -> Option<Analytic> {
        Some(Plane::analytic(self))
    }

    #[inline]
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        Plane::surface(self, ray, hit)
    }

    #[inline(always)]
    fn end<F: Float>(&self, near: DVec3<F::Double>) -> Option<End<F>> {
        Some(self.end_at(self.project(near)))
    }

    fn tangents(&self, _: &SurfacePoint) -> Tangents {
        Plane::tangents(self)
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        use super::tests::Example;
        let (point, normal) = (stand.center, stand.a);
        vec![Example::flat("plane", super::Shape::Plane(Self { point, normal }), point, normal.as_dvec3())]
    }
}

/// The point of the plane through `c` with unit normal `n` that is nearest to `p`.
#[inline(always)]
pub(super) fn project<D: Double>(p: DVec3<D>, c: DVec3<D>, n: DVec3<D>) -> DVec3<D> {
    p - n * (p - c).dot(n)
}
