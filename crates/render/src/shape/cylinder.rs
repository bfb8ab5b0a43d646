//! The cylinder without caps.

use straal_math::simd::{Double, Float};
use straal_math::{Affine, Bounds, DVec3, Ray, Vec3, ops};

use super::exact::{at, outward, rounded, size, unit_or};
use super::offset::End;
use super::tangents::unit_change;
use super::{Analytic, AreaSample, Form, ShapeHit, SurfacePoint, Tangents, sampling};

/// The image of the open unit cylinder x² + z² = 1, 0 <= y <= 1, under an affine map; its normal points away from the
/// axis.
///
/// Hit coordinates: 0 and y. Texture coordinates: u turns about +y from +z towards +x, v = y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    map: Affine,
    inverse: Affine,
    area: f64,
}

impl Cylinder {
    /// The image of the unit cylinder under `map`; `None` when that is singular.
    pub fn new(map: Affine) -> Option<Self> {
        let inverse = map.inverse()?;
        let mut shape = Self { map, inverse, area: 0.0 };
        // The trapezoid rule converges exponentially on a smooth periodic function; 1024 points are exact to 1e-9
        // for an ellipse a hundred times as long as wide.
        const POINTS: u32 = 1024;
        let step = 360.0 / f64::from(POINTS);
        let mean = (0..POINTS)
            .map(|i| {
                let (s, c) = ops::sin_cos_degrees(f64::from(i) * step);
                shape.stretch(s, c)
            })
            .sum::<f64>()
            / f64::from(POINTS);
        shape.area = 2.0 * std::f64::consts::PI * mean;
        Some(shape)
    }

    /// The round cylinder of a radius whose axis runs from one point to another; `None` when they coincide or the
    /// radius is not positive.
    pub fn between(from: DVec3, to: DVec3, radius: f64) -> Option<Self> {
        let axis = to - from;
        let n = axis.try_normalize()?;
        if radius <= 0.0 {
            return None;
        }
        let (x, z) = sampling::tangents(n);
        let (x, z) = (x * -radius, z * radius);
        Self::new(Affine {
            rows: [[x.x, axis.x, z.x, from.x], [x.y, axis.y, z.y, from.y], [x.z, axis.z, z.z, from.z]],
        })
    }

    /// See [`super::Geometry::bounds`].
    pub fn bounds(&self) -> Bounds {
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|v| self.map.vector(v));
        let reach = |a: f64, b: f64| (a * a + b * b).sqrt();
        let r = DVec3::new(reach(x.x, z.x), reach(x.y, z.y), reach(x.z, z.z));
        let c = self.map.point(DVec3::ZERO);
        outward(c.min(c + y) - r, c.max(c + y) + r, self.size())
    }

    /// See [`super::Geometry::analytic`].
    #[inline]
    pub fn analytic(&self) -> Analytic {
        Analytic::cylinder(&self.inverse)
    }

    /// See [`super::Geometry::surface`].
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.towards(self.inverse.point(at(ray, hit.t)))
    }

    /// The image of the unit cylinder's point at the height and in the direction of `q`.
    fn towards(&self, q: DVec3) -> SurfacePoint {
        let (End { p, p_err, ng }, out) = self.end_towards(q);
        let u = ops::atan2(out.x as f32, out.z as f32) * (0.5 * std::f32::consts::FRAC_1_PI);
        let uv = [if u < 0.0 { u + 1.0 } else { u }, q.y as f32];
        SurfacePoint { p, p_err, ng, n: ng, uv }
    }

    /// The images of points of the unit cylinder, and the directions from its axis in which they lie there.
    #[inline(always)]
    fn end_towards<F: Float>(&self, q: DVec3<F::Double>) -> (End<F>, DVec3<F::Double>) {
        let out = unit_or(DVec3::new(q.x, F::Double::ZERO, q.z), DVec3::Z);
        let on = DVec3::new(out.x, q.y, out.z);
        let (p, p_err) = rounded(self.map.point(on), F::Double::splat(self.size()));
        let n = unit_or(self.inverse.normal_by_inverse(out), DVec3::Y);
        (End { p, p_err, ng: Vec3::from_double(n) }, out)
    }

    /// See [`super::Geometry::tangents`].
    pub fn tangents(&self, at: &SurfacePoint) -> Tangents {
        let q = self.inverse.point(at.p.as_dvec3());
        let out = DVec3::new(q.x, 0.0, q.z).try_normalize().unwrap_or(DVec3::Z);
        let turn = DVec3::new(out.z, 0.0, -out.x) * (2.0 * std::f64::consts::PI);
        let normal = |d: DVec3| self.inverse.normal_by_inverse(d).as_vec3();
        Tangents {
            dpdu: self.map.vector(turn).as_vec3(),
            dpdv: self.map.vector(DVec3::Y).as_vec3(),
            dndu: unit_change(normal(out), normal(turn)),
            dndv: Vec3::ZERO,
        }
    }

    /// See [`super::Geometry::area`].
    pub fn area(&self) -> f32 {
        self.area as f32
    }

    /// Points of the unit cylinder, uniformly, carried over.
    pub fn sample_area(&self, u: [f32; 2]) -> AreaSample {
        let (s, c) = sampling::turn(u[0]);
        let point = self.towards(DVec3::new(s, f64::from(u[1]), c));
        AreaSample { point, pdf_area: self.density(s, c) }
    }

    /// The density of [`Self::sample_area`] at a point.
    pub fn pdf_area(&self, at: &SurfacePoint) -> f32 {
        let q = self.inverse.point(at.p.as_dvec3());
        let out = DVec3::new(q.x, 0.0, q.z).try_normalize().unwrap_or(DVec3::Z);
        self.density(out.x, out.z)
    }

    /// 1 / (2 pi) of the unit cylinder over the local stretch of area.
    fn density(&self, x: f64, z: f64) -> f32 {
        (1.0 / (2.0 * std::f64::consts::PI * self.stretch(x, z))) as f32
    }

    /// How much larger the image of a piece of surface at (x, z) is: |M tangent × M axis|.
    fn stretch(&self, x: f64, z: f64) -> f64 {
        self.map.vector(DVec3::new(z, 0.0, -x)).cross(self.map.vector(DVec3::Y)).length()
    }

    /// No number behind a point is larger than this.
    fn size(&self) -> f64 {
        self.map.rows.iter().flatten().map(|x| x.abs()).sum::<f64>() + size(DVec3::ONE)
    }
}

impl Form for Cylinder {
    fn bounds(&self) -> Option<Bounds> {
        Some(Cylinder::bounds(self))
    }

    #[inline]
    fn analytic(&self) -> Option<Analytic> {
        Some(Cylinder::analytic(self))
    }

    #[inline]
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        Cylinder::surface(self, ray, hit)
    }

    #[inline(always)]
    fn end<F: Float>(&self, near: DVec3<F::Double>) -> Option<End<F>> {
        Some(self.end_towards(self.inverse.point(near)).0)
    }

    fn tangents(&self, at: &SurfacePoint) -> Tangents {
        Cylinder::tangents(self, at)
    }

    fn area(&self) -> Option<f32> {
        Some(Cylinder::area(self))
    }

    #[inline]
    fn sample_area(&self, u: [f32; 2]) -> Option<AreaSample> {
        Some(Cylinder::sample_area(self, u))
    }

    #[inline]
    fn pdf_area(&self, hit: &SurfacePoint) -> f32 {
        Cylinder::pdf_area(self, hit)
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        use super::tests::Example;
        let (map, inverse) = (stand.map, stand.map.inverse().expect("it has one"));
        let shape = super::Shape::Cylinder(Box::new(Self::new(map).expect("it has an inverse")));
        vec![Example::new("cylinder", shape, move |p| {
            let q = inverse.point(p);
            let out = DVec3::new(q.x, 0.0, q.z);
            (out.length() - 1.0, inverse.normal_by_inverse(out.normalize()))
        })]
    }
}
