//! The one routine that decides whether a ray hits a triangle, and where.
//!
//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection": vertices are moved to the ray's origin and
//! sheared so that the ray is the z axis; the signs of three edge functions decide. Neighbours compute the very
//! negative of each other on a shared edge, so that no ray slips between. Rounding can turn an edge function into 0 but
//! not turn its sign (products are rounded monotonically), and 0 is decided in double precision, where products are
//! exact.
//!
//! Vector kernels do the operations of [`edges`] and [`Edges::t`] in each lane, and give lanes with a zero to this file.

use crate::local::LocalRay;
use straal_math::Vec3;

/// Edge functions and depths of one triangle and one ray.
pub(crate) struct Edges {
    /// Twice the signed areas opposite to vertices 0, 1, 2 (unnormalised barycentric weights).
    pub e: [f32; 3],
    /// The vertices' depths along the dominant axis, from the origin.
    pub z: [f32; 3],
    /// Sheared x and y of the vertices.
    xy: [[f32; 2]; 3],
}

#[inline(always)]
pub(crate) fn edges(v: &[Vec3; 3], r: &LocalRay) -> Edges {
    let [kx, ky, kz] = r.axes.map(usize::from);
    let mut z = [0.0; 3];
    let mut xy = [[0.0; 2]; 3];
    for i in 0..3 {
        z[i] = v[i][kz] - r.origin[2];
        xy[i] = [(v[i][kx] - r.origin[0]) - r.shear[0] * z[i], (v[i][ky] - r.origin[1]) - r.shear[1] * z[i]];
    }
    let [a, b, c] = xy;
    let e = [c[0] * b[1] - c[1] * b[0], a[0] * c[1] - a[1] * c[0], b[0] * a[1] - b[1] * a[0]];
    Edges { e, z, xy }
}

impl Edges {
    /// Decides zeros in double precision.
    #[inline]
    fn settle(&mut self) {
        let [a, b, c] = self.xy.map(|p| p.map(f64::from));
        self.e = [
            (c[0] * b[1] - c[1] * b[0]) as f32,
            (a[0] * c[1] - a[1] * c[0]) as f32,
            (b[0] * a[1] - b[1] * a[0]) as f32,
        ];
    }

    /// Whether no two signs differ; false when anything is NaN.
    #[inline(always)]
    pub fn inside(&self) -> bool {
        let [u, v, w] = self.e;
        (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0)
    }

    #[inline(always)]
    pub fn determinant(&self) -> f32 {
        self.e[0] + self.e[1] + self.e[2]
    }

    /// The ray parameter.
    #[inline(always)]
    pub fn t(&self, determinant: f32, shear_z: f32) -> f32 {
        let [u, v, w] = self.e;
        (u * self.z[0] + v * self.z[1] + w * self.z[2]) * shear_z / determinant
    }
}

/// t, u, v of the hit when it lies in [`t_min`, `limit`].
#[inline]
pub(crate) fn intersect(v: &[Vec3; 3], r: &LocalRay, limit: f32) -> Option<[f32; 3]> {
    let mut edges = edges(v, r);
    if !edges.inside() {
        return None;
    }
    if edges.e.contains(&0.0) {
        edges.settle();
        if !edges.inside() {
            return None;
        }
    }
    let det = edges.determinant();
    if det == 0.0 {
        return None;
    }
    let t = edges.t(det, r.shear[2]);
    (t >= r.ray.t_min && t <= limit).then(|| [t, edges.e[1] / det, edges.e[2] / det])
}

/// Whether a triangle can be hit at all: finite, and with an area.
#[inline]
pub(crate) fn is_sound(v: &[Vec3; 3]) -> bool {
    let [a, b, c] = v.map(|p| p.as_dvec3());
    v.iter().all(|p| p.is_finite()) && (b - a).cross(c - a) != straal_math::DVec3::ZERO
}
