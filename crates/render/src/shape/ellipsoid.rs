//! The ellipsoid: what a sphere becomes under scaling and shear.

use straal_math::simd::{Double, Float};
use straal_math::{Affine, Bounds, DVec3, Ray, Vec3};

use super::exact::{at, outward, rounded, unit_or};
use super::offset::End;
use super::sphere::{Cone, finite_or_zero, sphere_tangents, sphere_uv};
use super::tangents::unit_change;
use super::{
    Analytic, AreaSample, DirSample, Form, ShapeHit, SurfacePoint, Tangents, by_solid_angle, sampling,
    solid_angle_pdf,
};

/// The image of the unit sphere under an affine map; its normal points outwards.
///
/// Hit coordinates: none (0). Texture coordinates: those of the unit sphere (see [`super::Sphere`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    map: Affine,
    inverse: Affine,
    area: f64,
}

impl Ellipsoid {
    /// The image of the unit sphere under `map`; `None` when that is singular.
    pub fn new(map: Affine) -> Option<Self> {
        let inverse = map.inverse()?;
        Some(Self { map, inverse, area: area(&map) })
    }

    /// See [`super::Geometry::bounds`].
    pub fn bounds(&self) -> Bounds {
        let c = self.map.point(DVec3::ZERO);
        let reach = |i: usize| {
            let [x, y, z, _] = self.map.rows[i];
            DVec3::new(x, y, z).length()
        };
        let r = DVec3::new(reach(0), reach(1), reach(2));
        outward(c - r, c + r, self.size())
    }

    /// See [`super::Geometry::analytic`].
    #[inline]
    pub fn analytic(&self) -> Analytic {
        Analytic::ellipsoid(&self.inverse)
    }

    /// See [`super::Geometry::surface`].
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.towards(self.inverse.point(at(ray, hit.t)))
    }

    /// The image of the unit sphere's point in direction `q`.
    fn towards(&self, q: DVec3) -> SurfacePoint {
        let q = unit_or(q, DVec3::Y);
        let End { p, p_err, ng } = self.end_at(q);
        SurfacePoint { p, p_err, ng, n: ng, uv: sphere_uv(q.as_vec3()) }
    }

    /// The image of points of the unit sphere.
    #[inline(always)]
    fn end_at<F: Float>(&self, q: DVec3<F::Double>) -> End<F> {
        let (p, p_err) = rounded(self.map.point(q), F::Double::splat(self.size()));
        let n = unit_or(self.inverse.normal_by_inverse(q), DVec3::Y);
        End { p, p_err, ng: Vec3::from_double(n) }
    }

    /// See [`super::Geometry::tangents`].
    pub fn tangents(&self, at: &SurfacePoint) -> Tangents {
        let q = self.inverse.point(at.p.as_dvec3()).try_normalize().unwrap_or(DVec3::Y);
        let turns = sphere_tangents(q.as_vec3()).map(Vec3::as_dvec3);
        let [dpdu, dpdv] = turns.map(|d| self.map.vector(d).as_vec3());
        let long = self.inverse.normal_by_inverse(q).as_vec3();
        let [dndu, dndv] = turns.map(|d| unit_change(long, self.inverse.normal_by_inverse(d).as_vec3()));
        Tangents { dpdu, dpdv, dndu, dndv }
    }

    /// See [`super::Geometry::area`].
    pub fn area(&self) -> f32 {
        self.area as f32
    }

    /// Points of the unit sphere, uniformly, carried over.
    pub fn sample_area(&self, u: [f32; 2]) -> AreaSample {
        let q = sampling::sphere(u);
        AreaSample { point: self.towards(q), pdf_area: self.density(q) }
    }

    /// The cone to the unit sphere, seen from a point of its own space; `None` inside or on it.
    fn cone(&self, o: DVec3) -> Option<Cone> {
        let row = |i: usize| self.inverse.rows[i][..3].iter().map(|v| v.abs()).sum::<f64>();
        Cone::new(-o, 1.0, (row(0) + row(1) + row(2)) * self.size())
    }

    /// From outside, directions in the cone that the unit sphere fills in its own space, uniformly there; from inside,
    /// points by area.
    pub fn sample_from(&self, p: Vec3, u: [f32; 2]) -> Option<DirSample> {
        let o = self.inverse.point(p.as_dvec3());
        let Some(cone) = self.cone(o) else {
            return by_solid_angle(p, self.sample_area(u));
        };
        let s = cone.sample(u);
        let point = self.towards(o + s.w * s.t);
        let w = self.map.vector(s.w).try_normalize()?;
        let pdf = (cone.pdf() * self.narrowing(w)) as f32;
        (pdf > 0.0 && pdf.is_finite()).then_some(DirSample { point, wi: w.as_vec3(), pdf })
    }

    /// The density of [`Self::sample_from`].
    pub fn pdf_from(&self, p: Vec3, hit: &SurfacePoint) -> f32 {
        match self.cone(self.inverse.point(p.as_dvec3())) {
            Some(cone) => {
                let w = (hit.p - p).as_dvec3().try_normalize().unwrap_or(DVec3::Y);
                finite_or_zero((cone.pdf() * self.narrowing(w)) as f32)
            }
            None => {
                let q = self.inverse.point(hit.p.as_dvec3()).try_normalize().unwrap_or(DVec3::Y);
                solid_angle_pdf(p, hit, self.density(q))
            }
        }
    }

    /// Solid angle in the unit sphere's space over that in the world, about the unit direction `w`: |det M^-1| /
    /// |M^-1 w|³, since a linear map carries the volume of a thin pyramid, a third of solid angle times length³.
    fn narrowing(&self, w: DVec3) -> f64 {
        let v = self.inverse.vector(w);
        self.inverse.determinant().abs() / (v.length() * v.dot(v))
    }

    /// 1 / (4 pi) of the unit sphere over the local stretch of area, |det M| |M^-T q|.
    fn density(&self, q: DVec3) -> f32 {
        let stretch = self.map.determinant().abs() * self.inverse.normal_by_inverse(q).length();
        (1.0 / (4.0 * std::f64::consts::PI * stretch)) as f32
    }

    /// No number behind a point is larger than this.
    fn size(&self) -> f64 {
        self.map.rows.iter().flatten().map(|x| x.abs()).sum()
    }
}

impl Form for Ellipsoid {
    fn bounds(&self) -> Option<Bounds> {
        Some(Ellipsoid::bounds(self))
    }

    #[inline]
    fn analytic(&self) -> Option<Analytic> {
        Some(Ellipsoid::analytic(self))
    }

    #[inline]
    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        Ellipsoid::surface(self, ray, hit)
    }

    #[inline(always)]
    fn end<F: Float>(&self, near: DVec3<F::Double>) -> Option<End<F>> {
        Some(self.end_at(unit_or(self.inverse.point(near), DVec3::Y)))
    }

    fn tangents(&self, at: &SurfacePoint) -> Tangents {
        Ellipsoid::tangents(self, at)
    }

    fn area(&self) -> Option<f32> {
        Some(Ellipsoid::area(self))
    }

    #[inline]
    fn sample_area(&self, u: [f32; 2]) -> Option<AreaSample> {
        Some(Ellipsoid::sample_area(self, u))
    }

    #[inline]
    fn sample_from(&self, p: Vec3, u: [f32; 2]) -> Option<DirSample> {
        Ellipsoid::sample_from(self, p, u)
    }

    fn pdf_from(&self, p: Vec3, hit: &SurfacePoint) -> f32 {
        Ellipsoid::pdf_from(self, p, hit)
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        use super::tests::Example;
        let (map, inverse) = (stand.map, stand.map.inverse().expect("it has one"));
        let shape = super::Shape::Ellipsoid(Box::new(Self::new(map).expect("it has an inverse")));
        vec![Example::new("ellipsoid", shape, move |p| {
            let q = inverse.point(p);
            (q.length() - 1.0, inverse.normal_by_inverse(q.normalize()))
        })]
    }
}

/// The area of the image of the unit sphere: 4 pi R_G(x, y, z), where x, y, z are the squared products of two
/// semi-axes, the eigenvalues of C Cᵀ for the cofactor matrix C (NIST DLMF 19.33.1, 19.33.2).
fn area(m: &Affine) -> f64 {
    let row = |i: usize| DVec3::new(m.rows[i][0], m.rows[i][1], m.rows[i][2]);
    let c = [row(1).cross(row(2)), row(2).cross(row(0)), row(0).cross(row(1))];
    let eigen = eigenvalues(std::array::from_fn(|i| std::array::from_fn(|j| c[i].dot(c[j]))));
    4.0 * std::f64::consts::PI * carlson_rg(eigen)
}

/// Eigenvalues of a symmetric matrix that isn't negative, by Jacobi's rotations.
fn eigenvalues(mut m: [[f64; 3]; 3]) -> [f64; 3] {
    // Convergence is quadratic: a handful of sweeps reaches the last bit.
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q] == 0.0 {
                continue;
            }
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let t = 1.0_f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut m {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (a, b) = (m[p], m[q]);
            m[p] = std::array::from_fn(|k| c * a[k] - s * b[k]);
            m[q] = std::array::from_fn(|k| s * a[k] + c * b[k]);
        }
    }
    [m[0][0].abs(), m[1][1].abs(), m[2][2].abs()]
}

/// Carlson's symmetric integral of the second kind, from R_F and R_D by duplication (Carlson 1995, "Numerical
/// computation of real or complex elliptic integrals"; DLMF 19.21.10).
fn carlson_rg(mut v: [f64; 3]) -> f64 {
    v.sort_by(f64::total_cmp);
    let [x, y, z] = v;
    if !(z > 0.0 && z.is_finite()) {
        return 0.0;
    }
    // Scaled by the largest, and the smallest kept off 0, where R_F and R_D have no value of their own: a relative
    // change of the area of some 1e-15.
    let (x, y) = (if x / z < 1e-30 { 1e-30 } else { x / z }, if y / z < 1e-15 { 1e-15 } else { y / z });
    // 2 R_G = z R_F - (x - z)(y - z)/3 R_D + sqrt(x y / z), here with z = 1.
    let [rf, rd] = carlson_rf_rd(x, y);
    0.5 * z.sqrt() * (rf - (x - 1.0) * (y - 1.0) / 3.0 * rd + (x * y).sqrt())
}

/// R_F(x, y, 1) and R_D(x, y, 1).
fn carlson_rf_rd(mut x: f64, mut y: f64) -> [f64; 2] {
    let mut z = 1.0_f64;
    let (mut sum, mut power) = (0.0, 1.0);
    // Each duplication quarters the differences.
    for _ in 0..40 {
        let (a, b, c) = (x.sqrt(), y.sqrt(), z.sqrt());
        let lambda = a * b + b * c + c * a;
        sum += power / (c * (z + lambda));
        power *= 0.25;
        (x, y, z) = (0.25 * (x + lambda), 0.25 * (y + lambda), 0.25 * (z + lambda));
    }
    // All three agree to the last bits: R_F(m, m, m) = m^-1/2, R_D(m, m, m) = m^-3/2.
    let m = (x + y + z) / 3.0;
    [1.0 / m.sqrt(), 3.0 * sum + power / (m * m.sqrt())]
}
