//! The bilinear patch.

use straal_math::{Bounds, DVec3, Ray};

use super::exact::{clamped, outward, rounded, size, unit_or};
use super::revolved::{gauss, roots::Roots, roots::quadratic};
use super::tangents::unit_change;
use super::{AreaSample, Form, ShapeHit, SurfacePoint, Tangents};

/// The patch between four corners at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1), straight along u and along v: part of a hyperbolic
/// paraboloid. Its normal is dp/du × dp/dv.
///
/// Hit coordinates: u and v. Texture coordinates: these, or what they become between those of the corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bilinear {
    /// The corner at (0, 0), the ways along u and v there, and what the second changes along the first.
    p: DVec3,
    u: DVec3,
    v: DVec3,
    twist: DVec3,
    uvs: [[f64; 2]; 4],
    size: f64,
}

impl Bilinear {
    /// By its corners and their texture coordinates.
    pub fn new([a, b, c, d]: [DVec3; 4], uvs: [[f64; 2]; 4]) -> Self {
        let size = size(a) + size(b) + size(c) + size(d);
        Self { p: a, u: b - a, v: c - a, twist: (d - c) - (b - a), uvs, size }
    }

    fn corners(&self) -> [DVec3; 4] {
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|uv| self.at(uv))
    }

    fn at(&self, [u, v]: [f64; 2]) -> DVec3 {
        self.p + self.u * u + self.v * v + self.twist * (u * v)
    }

    /// How the point moves with u and with v.
    fn ways(&self, [u, v]: [f64; 2]) -> [DVec3; 2] {
        [self.u + self.twist * v, self.v + self.twist * u]
    }

    fn normal(&self, uv: [f64; 2]) -> DVec3 {
        let [du, dv] = self.ways(uv);
        du.cross(dv)
    }

    fn point(&self, uv: [f64; 2]) -> SurfacePoint {
        let (p, p_err) = rounded::<f32>(self.at(uv), self.size);
        let n = unit_or(self.normal(uv), DVec3::Y).as_vec3();
        let uv = between(&self.uvs, uv).map(|x| x as f32);
        SurfacePoint { p, p_err, ng: n, n, uv }
    }

    /// u and v of a point on it, by Gauss and Newton from the middle.
    fn back(&self, q: DVec3) -> [f64; 2] {
        let [mut u, mut v] = [0.5, 0.5];
        for _ in 0..12 {
            let off = q - self.at([u, v]);
            let [a, b] = self.ways([u, v]);
            let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
            let det = aa * bb - ab * ab;
            let (p, q) = (a.dot(off), b.dot(off));
            let (du, dv) = ((bb * p - ab * q) / det, (aa * q - ab * p) / det);
            if !(du.is_finite() && dv.is_finite()) {
                break;
            }
            (u, v) = (clamped(u + du, -0.5, 1.5), clamped(v + dv, -0.5, 1.5));
        }
        [u, v].map(|x| clamped(x, 0.0, 1.0))
    }
}

/// A value of each corner, between them.
fn between(of: &[[f64; 2]; 4], [u, v]: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|k| {
        let [a, b, c, d] = of.map(|x| x[k]);
        (a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v
    })
}

impl Form for Bilinear {
    fn bounds(&self) -> Option<Bounds> {
        let [a, b, c, d] = self.corners();
        Some(outward(a.min(b).min(c.min(d)), a.max(b).max(c.max(d)), self.size))
    }

    /// The lines along v that meet the ray: their u is a root of a quadratic (Reshetov 2019, "Cool Patches", Ray Tracing Gems ch. 8).
    fn intersect(&self, ray: &Ray) -> Option<ShapeHit> {
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        let at = self.p - o;
        // [p + u du - o, v + u twist, d] = 0.
        let a = self.u.cross(self.twist).dot(d);
        let b = at.cross(self.twist).dot(d) + self.u.cross(self.v).dot(d);
        let c = at.cross(self.v).dot(d);
        let mut roots = Roots::default();
        // A flat patch that is a parallelogram has one.
        let scale = self.size * self.size * d.length() * 1e-14;
        if a.abs() <= scale {
            roots.add(-c / b);
        } else {
            quadratic(a, 0.5 * b, c).for_each(|u| roots.add(u));
        }
        let mut best: Option<ShapeHit> = None;
        for u in roots.iter().filter(|u| (0.0..=1.0).contains(u)) {
            let (from, way) = (at + self.u * u, self.v + self.twist * u);
            let perpendicular = d.cross(way);
            let length = perpendicular.dot(perpendicular);
            // Where the line and the ray meet: from + v way = t d.
            let v = from.cross(d).dot(perpendicular) / length;
            let t = (from.cross(way).dot(perpendicular) / length) as f32;
            let is_met =
                (0.0..=1.0).contains(&v) && t >= ray.t_min && t <= ray.t_max && t.abs() < f32::INFINITY;
            if is_met && best.is_none_or(|b| t < b.t) {
                best = Some(ShapeHit { t, u: u as f32, v: v as f32 });
            }
        }
        best
    }

    fn surface(&self, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        self.point([hit.u, hit.v].map(f64::from))
    }

    fn tangents(&self, s: &SurfacePoint) -> Tangents {
        let uv = self.back(s.p.as_dvec3());
        let [du, dv] = self.ways(uv);
        let n = self.normal(uv).as_vec3();
        let turn = |dn: DVec3| unit_change(n, dn.as_vec3());
        let (nu, nv) = (turn(du.cross(self.twist)), turn(self.twist.cross(dv)));
        // By the patch's own u and v so far: textures' may run otherwise.
        let [a, b, c, d] = self.uvs;
        let [u, v] = uv;
        let change = |k: usize| {
            [(b[k] - a[k]) * (1.0 - v) + (d[k] - c[k]) * v, (c[k] - a[k]) * (1.0 - u) + (d[k] - b[k]) * u]
        };
        let ([su, sv], [tu, tv]) = (change(0), change(1));
        let det = su * tv - sv * tu;
        if det == 0.0 || !det.is_finite() {
            return Tangents { dpdu: du.as_vec3(), dpdv: dv.as_vec3(), dndu: nu, dndv: nv };
        }
        let s_of = |x: DVec3, y: DVec3| ((x * tv - y * tu) / det).as_vec3();
        let t_of = |x: DVec3, y: DVec3| ((y * su - x * sv) / det).as_vec3();
        let (nu, nv) = (nu.as_dvec3(), nv.as_dvec3());
        Tangents { dpdu: s_of(du, dv), dpdv: t_of(du, dv), dndu: s_of(nu, nv), dndv: t_of(nu, nv) }
    }

    fn area(&self) -> Option<f32> {
        let mut sum = 0.0;
        for (u, part) in gauss::<8>() {
            for (v, share) in gauss::<8>() {
                sum += part * share * self.normal([u, v]).length();
            }
        }
        Some(sum as f32)
    }

    /// Even in u and v.
    fn sample_area(&self, u: [f32; 2]) -> Option<AreaSample> {
        let uv = u.map(f64::from);
        Some(AreaSample { point: self.point(uv), pdf_area: (1.0 / self.normal(uv).length()) as f32 })
    }

    fn pdf_area(&self, s: &SurfacePoint) -> f32 {
        (1.0 / self.normal(self.back(s.p.as_dvec3())).length()) as f32
    }

    #[cfg(test)]
    fn examples(stand: &super::tests::Setting) -> Vec<super::tests::Example> {
        use super::tests::Example;
        let (o, a, b) = (stand.center.as_dvec3(), stand.a.as_dvec3(), stand.b.as_dvec3());
        let n = a.cross(b).normalize() * (0.3 * f64::from(stand.scale));
        let corners = [o - a - b + n, o + a - b - n, o - a + b - n, o + a + b + n];
        let square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let shape = super::Shape::Bilinear(Box::new(Self::new(corners, square)));
        // p = o + x a + y b + x y n.
        let (dual_a, dual_b) = (b.cross(n), n.cross(a));
        let det = a.dot(dual_a);
        let dual_n = a.cross(b) / det;
        let (dual_a, dual_b) = (dual_a / det, dual_b / det);
        vec![Example::new("saddle", shape, move |p| {
            let (x, y, z) = ((p - o).dot(dual_a), (p - o).dot(dual_b), (p - o).dot(dual_n));
            (z - x * y, dual_n - dual_a * y - dual_b * x)
        })]
    }
}
