//! The sphere.

use straal_math::simd::{Double, Float, Mask};
use straal_math::{Bounds, DVec3, Ray, Vec3, ops, warp};

use super::exact::{at, outward, rounded, size, unit_or};
use super::offset::End;
use super::{
    Analytic, AreaSample, DirSample, DirSamples, Form, ShapeHit, SurfacePoint, Tangents, by_solid_angle,
    sampling, solid_angle_pdf,
};

/// A sphere; its normal points outwards.
///
/// Hit coordinates: none (0). Texture coordinates: u turns about +y from +z towards +x, v rises from 0 at -y to 1
/// at +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Center.
    pub center: Vec3,
    /// Radius, positive.
    pub radius: f32,
}

impl Sphere {
    /// See [`super::Geometry::bounds`].
    pub fn bounds(&self) -> Bounds {
        let (c, r) = (self.center.as_dvec3(), f64::from(self.radius));
        outward(c - DVec3::splat(r), c + DVec3::splat(r), size(c) + r)
    }

    /// See [`super::Geometry::analytic`].
    #[inline]
    pub fn analytic(&self) -> Analytic {
        Analytic::sphere(self.center.as_dvec3(), f64::from(self.radius))
    }

    /// See [`super::Geometry::surface`].
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.towards(at(ray, hit.t) - self.center.as_dvec3())
    }

    /// The point of the sphere in the direction `q` from its center.
    fn towards(&self, q: DVec3) -> SurfacePoint {
        let End { p, p_err, ng } = end::<f32>((self.center, self.radius), q);
        SurfacePoint { p, p_err, ng, n: ng, uv: sphere_uv(ng) }
    }

    /// See [`super::Geometry::tangents`].
    pub fn tangents(&self, at: &SurfacePoint) -> Tangents {
        let [du, dv] = sphere_tangents(at.ng);
        Tangents { dpdu: du * self.radius, dpdv: dv * self.radius, dndu: du, dndv: dv }
    }

    /// See [`super::Geometry::area`].
    pub fn area(&self) -> f32 {
        4.0 * std::f32::consts::PI * self.radius * self.radius
    }

    /// See [`super::Geometry::sample_area`].
    pub fn sample_area(&self, u: [f32; 2]) -> AreaSample {
        AreaSample { point: self.towards(sampling::sphere(u)), pdf_area: 1.0 / self.area() }
    }

    /// From outside, directions in the cone that the sphere fills, uniformly; from inside, points by area.
    pub fn sample_from(&self, p: Vec3, u: [f32; 2]) -> Option<DirSample> {
        let DirSamples { end: End { p, p_err, ng }, wi, pdf } = self.sample_from_many(p, u);
        let point = SurfacePoint { p, p_err, ng, n: ng, uv: sphere_uv(ng) };
        (pdf > 0.0).then_some(DirSample { point, wi, pdf })
    }

    #[inline(always)]
    fn sample_from_many<F: Float>(&self, p: Vec3<F>, u: [F; 2]) -> DirSamples<F> {
        let (cone, outside) = self.cones(p);
        let s = cone.sample(u);
        let end =
            end((Vec3::uniform(self.center), F::splat(self.radius)), s.w * s.t - cone.axis * cone.distance);
        let (wi, there) = s.w.normalize_checked();
        let pdf = F::from_double(cone.pdf());
        let pdf = F::select(there & pdf.is_finite(), pdf, F::ZERO);
        let seen = DirSamples { end, wi: Vec3::from_double(wi), pdf };
        if outside.all() {
            return seen;
        }
        let within = DirSamples::one_by_one(
            !outside,
            #[inline(always)]
            |i| by_solid_angle(p.lane(i), self.sample_area([u[0].lane(i), u[1].lane(i)])),
        );
        DirSamples::select(outside, seen, within)
    }

    /// The density of [`Self::sample_from`].
    pub fn pdf_from(&self, p: Vec3, hit: &SurfacePoint) -> f32 {
        match self.cone(p) {
            Some(cone) => finite_or_zero(cone.pdf() as f32),
            None => solid_angle_pdf(p, hit, 1.0 / self.area()),
        }
    }

    fn cone(&self, p: Vec3) -> Option<Cone> {
        let (cone, outside) = self.cones(p);
        outside.then_some(cone)
    }

    /// The cones that it fills, seen from these points, and which of them are outside.
    #[inline(always)]
    fn cones<F: Float>(&self, p: Vec3<F>) -> (Cone<F::Double>, F::Mask) {
        let (center, radius) = (self.center.as_dvec3(), f64::from(self.radius));
        let reach = radius + center.x.abs() + center.y.abs() + center.z.abs();
        let to = DVec3::uniform(center) - p.to_double();
        Cone::seen(to, F::Double::splat(radius), F::Double::splat(reach))
    }
}

/// The point of a sphere, given by center and radius, in the direction `q` from its center.
#[inline(always)]
pub(crate) fn end<F: Float>((center, radius): (Vec3<F>, F), q: DVec3<F::Double>) -> End<F> {
    let (c, r) = (center.to_double(), radius.to_double());
    let n = unit_or(q, DVec3::Y);
    let (p, p_err) = rounded(c + n * r, size(c) + r);
    End { p, p_err, ng: Vec3::from_double(n) }
}

impl Form for Sphere {
    fn bounds(&self) -> Option<Bounds> {
        Some(Sphere::bounds(self))
    }

    #[inline]
    fn analytic(&self) -> Option<Analytic> {
        Some(Sphere::analytic(self))
    }

    #[inline]
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        Sphere::surface(self, ray, hit)
    }

    #[inline(always)]
    fn end<F: Float>(&self, near: DVec3<F::Double>) -> Option<End<F>> {
        let center = Vec3::uniform(self.center);
        Some(end((center, F::splat(self.radius)), near - center.to_double()))
    }

    fn tangents(&self, at: &SurfacePoint) -> Tangents {
        Sphere::tangents(self, at)
    }

    fn area(&self) -> Option<f32> {
        Some(Sphere::area(self))
    }

    #[inline]
    fn sample_area(&self, u: [f32; 2]) -> Option<AreaSample> {
        Some(Sphere::sample_area(self, u))
    }

    #[inline]
    fn sample_from(&self, p: Vec3, u: [f32; 2]) -> Option<DirSample> {
        Sphere::sample_from(self, p, u)
    }

    #[inline(always)]
    fn sample_from_many<F: Float>(&self, p: Vec3<F>, u: [F; 2]) -> DirSamples<F> {
        Sphere::sample_from_many(self, p, u)
    }

    fn pdf_from(&self, p: Vec3, hit: &SurfacePoint) -> f32 {
        Sphere::pdf_from(self, p, hit)
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        use super::tests::Example;
        let &super::tests::Setting { center, scale, .. } = stand;
        let (c, r) = (center.as_dvec3(), f64::from(scale));
        vec![Example::new("sphere", super::Shape::Sphere(Self { center, radius: scale }), move |p| {
            ((p - c).length() - r, (p - c).normalize())
        })]
    }
}

/// The directions from a point outside a sphere that meet it; or from many points, side by side.
pub(super) struct Cone<D = f64> {
    axis: DVec3<D>,
    distance: D,
    radius: D,
    one_minus_cos_max: D,
}

/// A direction in a [`Cone`], and how far the sphere is there.
pub(super) struct ConeSample<D = f64> {
    pub w: DVec3<D>,
    pub t: D,
}

impl Cone {
    /// [`Cone::seen`], for who is outside.
    pub fn new(to: DVec3, radius: f64, reach: f64) -> Option<Self> {
        let (cone, outside) = Self::seen(to, radius, reach);
        outside.then_some(cone)
    }
}

impl<D: Double> Cone<D> {
    /// The cone to a sphere whose center is at `to`, seen from the origin, and whether that is outside: not inside, nor too near to
    /// tell: a point of the sphere itself, which sees its inside, is rounded to either side of it. `reach` bounds the coordinates
    /// that are rounded.
    #[inline(always)]
    pub fn seen(to: DVec3<D>, radius: D, reach: D) -> (Self, D::Mask) {
        /// A few units in the last place of single precision.
        const ROUNDING: f64 = 16.0 * f32::EPSILON as f64;
        let distance = to.length();
        let outside = distance.gt(radius + reach * ROUNDING);
        let sin = radius / distance;
        let sin2 = sin * sin;
        // 1 - cos = sin² / (1 + cos): no cancellation, however far the sphere is.
        let one_minus_cos_max = sin2 / (D::ONE + (D::ONE - sin2).sqrt());
        (Self { axis: to / distance, distance, radius, one_minus_cos_max }, outside)
    }

    /// Uniform by solid angle: over a disc in whose radius squared 1 - cos is even, so that the smallest cones keep all their
    /// digits.
    #[inline(always)]
    pub fn sample<F: Float<Double = D>>(&self, u: [F; 2]) -> ConeSample<D> {
        let [a, b] = warp::concentric_disc(u);
        let (a, b) = (a.to_double(), b.to_double());
        let rr = a * a + b * b;
        // Rounding may leave a point of the rim just outside.
        let beyond = rr.gt(D::ONE);
        let inwards = D::select(beyond, D::ONE / rr.sqrt(), D::ONE);
        let rr = D::select(beyond, D::ONE, rr);
        let one_minus_cos = rr * self.one_minus_cos_max;
        let cos = D::ONE - one_minus_cos;
        // The sine over the radius.
        let rest = D::splat(2.0) - one_minus_cos;
        let stretch = inwards * (self.one_minus_cos_max * rest).sqrt();
        let sin2 = one_minus_cos * rest;
        let (x, y) = sampling::tangents(self.axis);
        let w = self.axis * cos + (x * a + y * b) * stretch;
        let reach = self.radius * self.radius - self.distance * self.distance * sin2;
        ConeSample { w, t: self.distance * cos - D::select(reach.gt(D::ZERO), reach.sqrt(), D::ZERO) }
    }

    /// The density of [`Self::sample`].
    #[inline(always)]
    pub fn pdf(&self) -> D {
        D::ONE / (self.one_minus_cos_max * (2.0 * std::f64::consts::PI))
    }
}

/// A density that overflowed counts as one that is never met.
pub(super) fn finite_or_zero(pdf: f32) -> f32 {
    if pdf.is_finite() { pdf } else { 0.0 }
}

/// Texture coordinates of a unit vector.
#[inline]
pub(super) fn sphere_uv(n: Vec3) -> [f32; 2] {
    use std::f32::consts::FRAC_1_PI;
    let u = ops::atan2(n.x, n.z) * (0.5 * FRAC_1_PI);
    let v = 1.0 - ops::acos(n.y) * FRAC_1_PI;
    [if u < 0.0 { u + 1.0 } else { u }, v]
}

/// How a unit vector moves with each of its texture coordinates; at the poles, where u has no meaning, as next to them
/// at u = 0.
pub(super) fn sphere_tangents(n: Vec3) -> [Vec3; 2] {
    use std::f32::consts::{PI, TAU};
    // Sine of the angle to the axis, and the direction about it.
    let sin = (n.x * n.x + n.z * n.z).sqrt();
    if sin == 0.0 {
        return [Vec3::X, Vec3::Z * (-PI * n.y)];
    }
    let (x, z) = (n.x / sin, n.z / sin);
    [Vec3::new(n.z, 0.0, -n.x) * TAU, Vec3::new(-n.y * x, sin, -n.y * z) * PI]
}
