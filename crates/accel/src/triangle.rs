//! The one routine that decides whether a ray hits a triangle, and where.
//!
//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection": vertices are moved to the ray's origin and
//! sheared so that the ray is the z axis; the signs of three edge functions decide. Neighbours compute the very
//! negative of each other on a shared edge, so that no ray slips between. Rounding can turn an edge function into 0 but
//! not turn its sign (products are rounded monotonically), and 0 is decided in double precision, where products are
//! exact.
//!
//! Where the edge functions are sums of products much larger than themselves (a sliver, or a triangle seen from its edge),
//! their signs can be trusted but not their sizes, and t, u and v go by the sizes: these too are computed in double
//! precision. So they are where products of three lengths leave the range of single precision: where a triangle is seen tiny,
//! or a scene is huge. So the ray's point at t is as near to the triangle as the roundings of the sheared vertices allow,
//! whatever the triangle's shape and size, which is what structures that cut triangles in pieces rely on.
//!
//! Vector kernels do the operations of [`edges`] and [`Edges::numerator`] in each lane, and give lanes with a zero, or in which
//! [`Edges::is_well_conditioned`] doesn't hold, to this file.

use crate::local::LocalRay;
use straal_math::{Vec3, ops};

/// Determinants of less than this part of the square of the sheared triangle's reach aren't trusted.
pub(crate) const FLAT: f32 = 0.125;

/// Nor are those below 2^-50, of triangles that the ray sees a ten millionth of a unit wide: see
/// [`Edges::is_well_conditioned`].
pub(crate) const LEAST_DETERMINANT: f32 = f32::from_bits((127 - 50) << 23);

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
    let [kx, ky, kz] = r.axes();
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
    /// Whether single precision is enough for t, u and v. With S the largest of the sheared coordinates, an edge function
    /// is off by no more than 1.5 S^2 epsilon, so that the point with these weights is off by 4.5 S^3 epsilon / determinant:
    /// no more than 36 S epsilon here.
    ///
    /// Products below the least normal number are off by up to 2^-150. Divided by a determinant of
    /// [`LEAST_DETERMINANT`] this moves the point by 2^-97 at most, and t itself, whose numerator is a product too, by 2^-99
    /// more. Sums that overflow aren't trusted either: zero times what isn't finite is NaN.
    #[inline(always)]
    pub fn is_well_conditioned(&self, determinant: f32, numerator: f32) -> bool {
        let [a, b, c] = self.xy;
        let reach = [a[0], a[1], b[0], b[1], c[0], c[1]].map(f32::abs).into_iter().fold(0.0, ops::max);
        let enough = ops::max(reach * reach * FLAT, LEAST_DETERMINANT);
        determinant.abs() >= enough + (numerator + determinant) * 0.0
    }

    /// t, u and v in double precision, in which the products are exact; `None` where the ray passes by after all.
    #[inline]
    fn exactly(&self, shear_z: f32) -> Option<[f32; 3]> {
        let [a, b, c] = self.xy.map(|p| p.map(f64::from));
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if !((u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0)) {
            return None;
        }
        let det = u + v + w;
        let z = self.z.map(f64::from);
        let t = (u * z[0] + v * z[1] + w * z[2]) * f64::from(shear_z) / det;
        (det != 0.0).then_some([t as f32, (v / det) as f32, (w / det) as f32])
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

    /// The ray parameter times the determinant.
    #[inline(always)]
    pub fn numerator(&self, shear_z: f32) -> f32 {
        let [u, v, w] = self.e;
        (u * self.z[0] + v * self.z[1] + w * self.z[2]) * shear_z
    }
}

/// t, u, v of the hit when it lies in [`t_min`, `limit`].
#[inline]
pub(crate) fn intersect(v: &[Vec3; 3], r: &LocalRay, limit: f32) -> Option<[f32; 3]> {
    let edges = edges(v, r);
    if !edges.inside() {
        return None;
    }
    let (det, numerator) = (edges.determinant(), edges.numerator(r.shear[2]));
    let hit = if edges.e.contains(&0.0) || !edges.is_well_conditioned(det, numerator) {
        edges.exactly(r.shear[2])?
    } else {
        [numerator / det, edges.e[1] / det, edges.e[2] / det]
    };
    (hit[0] >= r.ray.t_min && hit[0] <= limit).then_some(hit)
}

/// Whether a triangle can be hit at all: finite, and with an area.
#[inline]
pub(crate) fn is_sound(v: &[Vec3; 3]) -> bool {
    let [a, b, c] = v.map(|p| p.as_dvec3());
    v.iter().all(|p| p.is_finite()) && (b - a).cross(c - a) != straal_math::DVec3::ZERO
}
