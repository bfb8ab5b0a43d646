//! Triangle meshes: vertices in flat arrays, and the surface between them.

use std::sync::Arc;

use straal_math::simd::{BLOCK, Double, Float, Mask, Uint};
use straal_math::{Affine, DVec3, Vec3, warp};

use super::drawn::Nearby;
use super::exact::{HALF_ULP, SUBNORMAL, bound, unit_or};
use super::offset::End;
use super::spherical_triangle::SphericalTriangle;
use super::tangents::unit_change;
use super::{
    AreaSample, DirSample, DirSamples, Drawn, SurfacePoint, Tangents, by_solid_angle, solid_angle_pdf,
};
use crate::texture::MeshAttribute;

/// An indexed triangle mesh. Every index is in range, and `normals` and `uvs` are empty or as long as `positions`:
/// readers guarantee it and [`TriangleMesh::is_whole`] tells.
///
/// A triangle's geometric normal is (p1 - p0) × (p2 - p0): it points at whoever sees its vertices counter-clockwise.
/// Hit coordinates u and v are the barycentric weights of vertices 1 and 2.
#[derive(Clone, Debug, Default)]
pub struct TriangleMesh {
    /// Vertex positions; shared with the search structure.
    pub positions: Arc<[Vec3]>,
    /// Three vertices a triangle; shared with the search structure.
    pub indices: Arc<[[u32; 3]]>,
    /// Shading normals, one a vertex, of unit length (or zero, where the file's had no direction); empty for flat shading.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one a vertex; empty when there are none, and then (u, v) of the hit stands in.
    pub uvs: Vec<[f32; 2]>,
    /// Directions that brushed surfaces and maps of normals follow, one a vertex, with a side, as [`straal_scene::Mesh::tangents`]; empty without.
    pub tangents: Vec<[f32; 4]>,
    /// What vertices or triangles have besides, as far as textures read it.
    pub attributes: Vec<MeshAttribute>,
    /// Whether the geometric normal is turned round: set when the mesh was mirrored.
    pub flip: bool,
    /// What is made of the normals.
    pub between: Between,
    /// How points of its triangles are drawn, where it shines; by projected solid angle they aren't.
    pub drawn: Drawn,
}

/// What is interpolated between the vertices of a mesh that has shading normals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Between {
    /// Normals (Phong 1975), and rays leave from the surface that these tell of, see [`TriangleMesh::bulge`].
    #[default]
    Surface,
    /// Normals; rays leave from the triangles.
    Normals,
    /// Colours (Gouraud 1971): light is scattered at the corners alone.
    Colours,
}

impl From<&straal_scene::Mesh> for TriangleMesh {
    fn from(m: &straal_scene::Mesh) -> Self {
        let unit = |n: &[f32; 3]| Vec3::from_array(*n).try_normalize().unwrap_or(Vec3::ZERO);
        Self {
            positions: m.positions.iter().map(|p| Vec3::from_array(*p)).collect(),
            indices: m.triangles.as_slice().into(),
            normals: m.normals.iter().map(unit).collect(),
            uvs: m.uvs.clone(),
            tangents: m.tangents.clone(),
            ..Self::default()
        }
    }
}

impl TriangleMesh {
    /// A box between two corners, six flat faces with their own vertices, each with texture coordinates 0 to 1.
    pub fn cuboid(min: Vec3, max: Vec3) -> Self {
        // Each face: its axis, its side, and the two axes that turn counter-clockwise seen from outside.
        const FACES: [(usize, bool, usize, usize); 6] = [
            (0, false, 2, 1),
            (0, true, 1, 2),
            (1, false, 0, 2),
            (1, true, 2, 0),
            (2, false, 1, 0),
            (2, true, 0, 1),
        ];
        const CORNERS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let (mut positions, mut uvs, mut indices) = (vec![], vec![], vec![]);
        for (axis, high, a, b) in FACES {
            let first = positions.len() as u32;
            for uv in CORNERS {
                let mut p = min;
                p[axis] = if high { max[axis] } else { min[axis] };
                p[a] = if uv[0] > 0.0 { max[a] } else { min[a] };
                p[b] = if uv[1] > 0.0 { max[b] } else { min[b] };
                positions.push(p);
                uvs.push(uv);
            }
            indices.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        Self { positions: positions.into(), indices: indices.into(), uvs, ..Self::default() }
    }

    /// The mesh moved by `m`, computed in double precision; `None` when `m` is singular. A mirrored mesh keeps its
    /// outside outside.
    pub fn transformed(&self, m: &Affine) -> Option<Self> {
        let inverse = m.inverse()?;
        let normal = |n: &Vec3| {
            inverse.normal_by_inverse(n.as_dvec3()).try_normalize().unwrap_or(DVec3::ZERO).as_vec3()
        };
        let mirrors = m.determinant() < 0.0;
        let side = if mirrors { -1.0 } else { 1.0 };
        let tangent = |t: &[f32; 4]| {
            let [x, y, z, w] = *t;
            let along = m.vector(Vec3::new(x, y, z).as_dvec3());
            let [x, y, z] = along.try_normalize().unwrap_or(DVec3::ZERO).as_vec3().to_array();
            [x, y, z, w * side]
        };
        Some(Self {
            positions: self.positions.iter().map(|p| m.point(p.as_dvec3()).as_vec3()).collect(),
            indices: self.indices.clone(),
            normals: self.normals.iter().map(normal).collect(),
            uvs: self.uvs.clone(),
            tangents: self.tangents.iter().map(tangent).collect(),
            attributes: self.attributes.clone(),
            flip: self.flip != mirrors,
            between: self.between,
            drawn: self.drawn,
        })
    }

    /// Whether every index is in range and the optional arrays fit.
    pub fn is_whole(&self) -> bool {
        let n = self.positions.len();
        self.indices.iter().flatten().all(|&i| (i as usize) < n)
            && (self.normals.is_empty() || self.normals.len() == n)
            && (self.uvs.is_empty() || self.uvs.len() == n)
            && (self.tangents.is_empty() || self.tangents.len() == n)
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, primitive: u32) -> [Vec3; 3] {
        self.indices[primitive as usize].map(|i| self.positions[i as usize])
    }

    /// Area of one triangle; 0 when a corner isn't finite.
    pub fn triangle_area(&self, primitive: u32) -> f64 {
        let [a, b, c] = self.corners(primitive).map(Vec3::as_dvec3);
        let area = 0.5 * (b - a).cross(c - a).length();
        if area.is_finite() { area } else { 0.0 }
    }

    /// The surface of a triangle at barycentric weights u and v of its vertices 1 and 2.
    ///
    /// The error bound is that of the point's rounding, and of a search in single precision that looks for this triangle
    /// from this point again: it works with corners relative to the ray's origin, which costs it some gamma(8) of
    /// their distance.
    #[inline]
    pub fn surface(&self, primitive: u32, u: f32, v: f32) -> SurfacePoint {
        let End { p, p_err, ng } = end(self.corners(primitive), [u, v], self.flip);
        let n = match self.corner_normals(primitive) {
            None => ng,
            Some(normals) => shading_normal(normals, [u, v], ng),
        };
        let index = self.indices[primitive as usize].map(|i| i as usize);
        SurfacePoint { p, p_err, ng, n, uv: self.uv(index, [u, v]) }
    }

    /// How far the surface that a triangle's shading normals tell of lies above it, seen in the direction `d`: the mean of the point's projections
    /// onto the planes through the corners across their normals (Boubekeur and Alexa 2008, "Phong Tessellation"). Zero where there is none.
    pub fn bulge(&self, primitive: u32, [u, v]: [f32; 2], d: Vec3) -> Vec3 {
        let normals = self.corner_normals(primitive).filter(|_| self.between == Between::Surface);
        let Some(normals) = normals else { return Vec3::ZERO };
        let corners = self.corners(primitive);
        let ng = end(corners, [u, v], self.flip).ng;
        bulge(corners, normals, [u, v], if d.dot(ng) > 0.0 { -ng } else { ng })
    }

    /// The shading normals of a triangle's corners; `None` in a mesh that has none.
    #[inline(always)]
    pub(crate) fn corner_normals(&self, primitive: u32) -> Option<[Vec3; 3]> {
        let index = self.indices[primitive as usize];
        (!self.normals.is_empty()).then(|| index.map(|i| self.normals[i as usize]))
    }

    #[inline]
    fn uv(&self, index: [usize; 3], [u, v]: [f32; 2]) -> [f32; 2] {
        if self.uvs.is_empty() {
            return [u, v];
        }
        let [t0, t1, t2] = index.map(|i| self.uvs[i]);
        let b0 = 1.0 - u - v;
        [0, 1].map(|k| b0 * t0[k] + u * t1[k] + v * t2[k])
    }

    /// How a point of a triangle moves with its texture coordinates: by those of the mesh; along the edges from vertex 0
    /// where it has none, or a triangle's have no extent.
    pub fn tangents(&self, primitive: u32, u: f32, v: f32) -> Tangents {
        let index = self.indices[primitive as usize].map(|i| i as usize);
        let [p0, p1, p2] = index.map(|i| self.positions[i]);
        let edges = [p1 - p0, p2 - p0];
        // How the normal turns from vertex 0 to the others.
        let turns = match self.normals.get(index[0]..) {
            None | Some([]) => [Vec3::ZERO; 2],
            Some(_) => {
                let [n0, n1, n2] = index.map(|i| self.normals[i]);
                let n = n0 * (1.0 - u - v) + n1 * u + n2 * v;
                [unit_change(n, n1 - n0), unit_change(n, n2 - n0)]
            }
        };
        let sound_ones = |[dpdu, dpdv]: [Vec3; 2], [dndu, dndv]: [Vec3; 2]| {
            let sound = dpdu != Vec3::ZERO && [dpdu, dpdv, dndu, dndv].iter().all(|v| v.is_finite());
            sound.then_some(Tangents { dpdu, dpdv, dndu, dndv })
        };
        let by_texture = (!self.uvs.is_empty()).then(|| {
            let [t0, t1, t2] = index.map(|i| self.uvs[i]);
            let (d1, d2) = ([t1[0] - t0[0], t1[1] - t0[1]], [t2[0] - t0[0], t2[1] - t0[1]]);
            let det = d1[0] * d2[1] - d2[0] * d1[1];
            let by_uv = |[a, b]: [Vec3; 2]| [(a * d2[1] - b * d1[1]) / det, (b * d1[0] - a * d2[0]) / det];
            sound_ones(by_uv(edges), by_uv(turns))
        });
        let found = by_texture.flatten().or_else(|| sound_ones(edges, turns));
        found.unwrap_or_else(|| Tangents::about(self.surface(primitive, u, v).ng))
    }

    /// The mesh's own tangent at a point of a triangle, and what lies across it, both along the surface as it is shaded and of any length; `None`
    /// where it has none.
    pub(crate) fn own_tangent(&self, primitive: u32, [u, v]: [f32; 2]) -> Option<[Vec3; 2]> {
        if self.tangents.is_empty() {
            return None;
        }
        let index = self.indices[primitive as usize];
        let mut along = Vec3::ZERO;
        let mut side = 0.0;
        for (i, weight) in index.into_iter().zip([1.0 - u - v, u, v]) {
            let [x, y, z, w] = self.tangents[i as usize];
            along += Vec3::new(x, y, z) * weight;
            side += w * weight;
        }
        let n = self.surface(primitive, u, v).n;
        let across = n.cross(along) * if side < 0.0 { -1.0 } else { 1.0 };
        let is_sound = across.is_finite() && across.length_squared() > 1e-12 * along.length_squared();
        is_sound.then_some([along, across])
    }

    /// Two numbers that the corners of a triangle have, by the attribute's number; `None` where there are none.
    pub(crate) fn coordinates(&self, attribute: u32, primitive: u32) -> Option<[[f32; 2]; 3]> {
        let found = self.attributes.iter().find(|a| a.id == attribute && a.channels >= 2)?;
        let corners = self.indices.get(primitive as usize)?;
        let of = |i: u32| found.values.get(i as usize * found.channels..)?.first_chunk::<2>().copied();
        let [a, b, c] = corners.map(of);
        Some([a?, b?, c?])
    }

    /// How the barycentric weights of a triangle's vertices 1 and 2 change where its texture coordinates change by `duv`: see
    /// [`Self::tangents`], whose coordinates these are.
    pub(crate) fn place_change(&self, primitive: u32, [du, dv]: [f32; 2]) -> [f32; 2] {
        let corners = self.indices[primitive as usize].map(|i| self.uvs.get(i as usize));
        let [Some(t0), Some(t1), Some(t2)] = corners else { return [du, dv] };
        let (d1, d2) = ([t1[0] - t0[0], t1[1] - t0[1]], [t2[0] - t0[0], t2[1] - t0[1]]);
        let det = d1[0] * d2[1] - d2[0] * d1[1];
        let change = [(du * d2[1] - dv * d2[0]) / det, (dv * d1[0] - du * d1[1]) / det];
        // Where they have no extent the weights themselves stand in.
        if change.iter().all(|v| v.is_finite()) { change } else { [du, dv] }
    }

    /// A point of a triangle, uniformly; `pdf_area` is that of the triangle alone.
    pub fn sample_triangle(&self, primitive: u32, u: [f32; 2]) -> AreaSample {
        let [b1, b2] = warp::uniform_triangle(u);
        let area = self.triangle_area(primitive);
        AreaSample { point: self.surface(primitive, b1, b2), pdf_area: (1.0 / area) as f32 }
    }

    /// A direction from `p` towards a triangle that was picked with the probability `pmf`, which counts in its density.
    pub fn sample_triangle_from(
        &self,
        (primitive, pmf): (u32, f32),
        p: Vec3,
        u: [f32; 2],
    ) -> Option<DirSample> {
        if let Some(seen) = self.seen(primitive, p) {
            let solid_angle = seen.solid_angle();
            let [b1, b2] = seen.sample(solid_angle, u);
            let point = self.surface(primitive, b1, b2);
            let wi = (point.p - p).try_normalize()?;
            return Some(DirSample { point, wi, pdf: pmf / solid_angle });
        }
        let AreaSample { point, pdf_area } = self.sample_triangle(primitive, u);
        by_solid_angle(p, AreaSample { point, pdf_area: pdf_area * pmf })
    }

    /// The density of [`Self::sample_triangle_from`] at a point of the triangle.
    pub fn pdf_triangle_from(&self, (primitive, pmf): (u32, f32), p: Vec3, hit: &SurfacePoint) -> f32 {
        match self.seen(primitive, p) {
            Some(seen) => pmf / seen.solid_angle(),
            None => solid_angle_pdf(p, hit, (1.0 / self.triangle_area(primitive)) as f32 * pmf),
        }
    }

    /// A triangle about a point, where it is drawn as it is seen from there.
    #[inline]
    fn seen(&self, primitive: u32, p: Vec3) -> Option<SphericalTriangle<f32>> {
        if self.drawn == Drawn::ByArea {
            return None;
        }
        let corners = self.corners(primitive);
        let near = nearby(corners, (self.drawn, self.flip)).has(p);
        near.then(|| SphericalTriangle::new(corners, p)).filter(|seen| seen.is_large())
    }

    /// [`Self::sample_triangle_from`] for many side by side, without what only shading wants.
    #[inline(always)]
    pub(crate) fn sample_triangles_from<F: Float>(
        &self,
        (primitive, pmf): (F::Uint, F),
        p: Vec3<F>,
        u: [F; 2],
    ) -> DirSamples<F> {
        // Compiled once, not for each way to read colours.
        F::vectorize(
            #[inline(always)]
            || self.sample_these_from((primitive, pmf), p, u),
        )
    }

    #[inline(always)]
    fn sample_these_from<F: Float>(
        &self,
        (primitive, pmf): (F::Uint, F),
        p: Vec3<F>,
        u: [F; 2],
    ) -> DirSamples<F> {
        let mut rows = [[Vec3::ZERO; 3]; BLOCK];
        for (i, corners) in rows.iter_mut().enumerate().take(F::WIDTH) {
            *corners = self.corners(primitive.lane(i));
        }
        let corners = [corner(&rows, 0), corner(&rows, 1), corner(&rows, 2)];
        let [p0, p1, p2] = corners;
        let (e1, e2) = (p1.to_double() - p0.to_double(), p2.to_double() - p0.to_double());
        let area: F::Double = e1.cross(e2).length() * 0.5;
        let area = F::Double::select(area.lt(F::Double::splat(f64::INFINITY)), area, F::Double::ZERO);
        let flip = F::Mask::splat(self.flip);
        let end_by_area = end(corners, warp::uniform_triangle(u), flip);
        let by_area = DirSamples::by_area(p, end_by_area, F::from_double(F::Double::ONE / area) * pmf);
        if self.drawn == Drawn::ByArea {
            return by_area;
        }
        let near = nearby(corners, (self.drawn, self.flip)).has(p);
        if !near.any() {
            return by_area;
        }
        let seen = SphericalTriangle::new(corners, p);
        let large = near & seen.is_large();
        if !large.any() {
            return by_area;
        }
        let solid_angle = seen.solid_angle();
        let end = end(corners, seen.sample(solid_angle, u), flip);
        let (wi, there) = (end.p - p).normalize_checked();
        let pdf = F::select(there, pmf / solid_angle, F::ZERO);
        DirSamples::select(large, DirSamples { end, wi, pdf }, by_area)
    }
}

/// From where a triangle is drawn as it is seen.
#[inline(always)]
fn nearby<F: Float>(corners: [Vec3<F>; 3], (drawn, flip): (Drawn, bool)) -> Nearby<F> {
    let [a, b, c] = corners;
    let middle = (a + b + c) * F::splat(1.0 / 3.0);
    // One by one: a map over an array of such vectors is compiled apart, without the instruction set of its caller.
    let (da, db, dc) = (a - middle, b - middle, c - middle);
    let rim = da.length_squared().max(db.length_squared()).max(dc.length_squared());
    let n = (b - a).cross(c - a);
    drawn.nearby(middle, rim, if flip { -n } else { n })
}

/// A corner of the triangle of each row.
#[inline(always)]
fn corner<F: Float>(rows: &[[Vec3; 3]; BLOCK], k: usize) -> Vec3<F> {
    let [x, y, z, _] = F::from_rows(
        #[inline(always)]
        |i| {
            let p = rows[i][k];
            [p.x, p.y, p.z, 0.0]
        },
    );
    Vec3::new(x, y, z)
}

/// The point of a triangle at barycentric weights of its corners 1 and 2, with its geometric normal, which is turned round
/// where `flip` says so; see [`TriangleMesh::surface`].
#[inline(always)]
pub(crate) fn end<F: Float>(corners: [Vec3<F>; 3], [u, v]: [F; 2], flip: F::Mask) -> End<F> {
    let [p0, p1, p2] = corners;
    let (p0, p1, p2) = (p0.to_double(), p1.to_double(), p2.to_double());
    let (b1, b2) = (u.to_double(), v.to_double());
    let (e1, e2) = (p1 - p0, p2 - p0);
    let q = p0 + e1 * b1 + e2 * b2;
    // The corners' mean distance, by the weights: as the triangle inequality bounds it for each coordinate.
    let one = F::Double::ONE;
    let spread = e1.abs() * (b1 * 2.0 * (one - b1)).abs() + e2.abs() * (b2 * 2.0 * (one - b2)).abs();
    let pad = spread.max_element() * (8.0 * HALF_ULP) + SUBNORMAL;
    let out = Vec3::from_double(unit_or(e1.cross(e2), DVec3::Y));
    End { p: Vec3::from_double(q), p_err: bound(q, pad), ng: Vec3::select(flip, -out, out) }
}

/// How far above a triangle, at barycentric weights of its corners 1 and 2, the surface lies that the corners' normals tell of: the
/// mean of the point's projections onto the planes through the corners across their normals (Boubekeur and Alexa 2008, "Phong
/// Tessellation"). It is how rays leave without meeting the shadow of the triangles where the smooth surface has none (Hanika 2021,
/// "Hacking the Shadow Terminator"; where that takes the projections that lie above, this takes all, so that normals that lean all alike
/// tell of no bulge). `out` is the triangle's unit normal on the viewer's side; below it there is nothing to rise from.
///
/// Zero where it is no more than what may be rounding.
#[inline(always)]
pub(crate) fn bulge<F: Float>(
    [p0, p1, p2]: [Vec3<F>; 3],
    normals: [Vec3<F>; 3],
    [u, v]: [F; 2],
    out: Vec3<F>,
) -> Vec3<F> {
    let (e1, e2) = (p1 - p0, p2 - p0);
    // From each corner to the point.
    let from_0 = e1 * u + e2 * v;
    let [n0, n1, n2] = normals;
    let towards = |n: Vec3<F>, from: Vec3<F>, weight: F| n * (from.dot(n) * weight);
    let below =
        towards(n0, from_0, F::ONE - u - v) + towards(n1, from_0 - e1, u) + towards(n2, from_0 - e2, v);
    let least = (e1.abs() + e2.abs()).max_element() * (16.0 * f32::EPSILON);
    // What isn't a number is no bulge either.
    Vec3::select((-below).dot(out).gt(least), -below, Vec3::splat(F::ZERO))
}

/// The shading normal between those of a triangle's corners; the geometric one where they leave no direction.
#[inline(always)]
pub(crate) fn shading_normal<F: Float>([n0, n1, n2]: [Vec3<F>; 3], [u, v]: [F; 2], ng: Vec3<F>) -> Vec3<F> {
    let (b1, b2) = (u.to_double(), v.to_double());
    let b0 = F::from_double(F::Double::ONE - b1 - b2);
    let (n, there) = (n0 * b0 + n1 * u + n2 * v).normalize_checked();
    Vec3::select(there, n, ng)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Rng, assert_agrees, monte_carlo};
    use super::*;

    fn volume(m: &TriangleMesh) -> f64 {
        let sum: f64 = (0..m.indices.len() as u32)
            .map(|i| {
                let [a, b, c] = m.corners(i).map(Vec3::as_dvec3);
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        if m.flip { -sum } else { sum }
    }

    #[test]
    fn a_cuboid_is_closed_and_faces_outwards() {
        let (min, max) = (Vec3::new(-1.0, 2.0, 0.5), Vec3::new(1.0, 5.0, 1.0));
        let m = TriangleMesh::cuboid(min, max);
        assert!(m.is_whole());
        assert_eq!(volume(&m), 2.0 * 3.0 * 0.5);
        let center = (min + max) * 0.5;
        for i in 0..12 {
            let s = m.surface(i, 0.3, 0.3);
            assert!(s.ng.dot(s.p - center) > 0.0, "face {i}");
            assert_eq!(s.n, s.ng);
            assert!(m.tangents(i, 0.3, 0.3).dpdu.dot(s.ng).abs() < 1e-6);
        }
    }

    #[test]
    fn a_mirrored_mesh_keeps_its_outside() {
        let mut m = TriangleMesh::cuboid(-Vec3::ONE, Vec3::ONE);
        m.normals = m.positions.iter().map(|p| p.normalize()).collect();
        let map = Affine::scale(DVec3::new(-1.0, 2.0, 3.0)).then(&Affine::rotate(DVec3::ONE, 20.0).unwrap());
        let moved = m.transformed(&map).unwrap();
        assert!(moved.flip);
        assert!((volume(&moved) - 48.0).abs() < 1e-4);
        for i in 0..12 {
            let s = moved.surface(i, 0.2, 0.5);
            assert!(s.ng.dot(s.p) > 0.0 && s.n.dot(s.ng) > 0.0);
            assert!((s.n.length() - 1.0).abs() < 1e-6 && (s.ng.length() - 1.0).abs() < 1e-6);
        }
        assert!(!moved.transformed(&map).unwrap().flip);
        assert!(m.transformed(&Affine::scale(DVec3::new(1.0, 0.0, 1.0))).is_none());
    }

    #[test]
    fn surfaces_interpolate_corners_normals_and_texture() {
        let m = TriangleMesh {
            positions: [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 3.0].into(),
            indices: [[0, 1, 2]].into(),
            normals: vec![Vec3::Z, Vec3::X, Vec3::Z],
            uvs: vec![[0.0, 0.0], [0.0, 4.0], [2.0, 0.0]],
            ..TriangleMesh::default()
        };
        let s = m.surface(0, 0.25, 0.5);
        assert_eq!(s.p, Vec3::new(0.5, 1.5, 0.0));
        assert_eq!((s.ng, s.uv), (Vec3::Z, [1.0, 1.0]));
        assert!((s.n - Vec3::new(1.0, 0.0, 3.0).normalize()).length() < 1e-6);
        // Texture u grows along +y, 2 over 3 metres.
        let t = m.tangents(0, 0.25, 0.5);
        assert!((t.dpdu - Vec3::new(0.0, 1.5, 0.0)).length() < 1e-6);
        // v grows along x, 4 over 2 metres.
        assert!((t.dpdv - Vec3::new(0.5, 0.0, 0.0)).length() < 1e-6);
    }

    /// Between the corners of a triangle that lies askew, coordinates are those of the point in space; mixed by the place on the film, as a
    /// rasteriser that doesn't divide does, they would be far off.
    #[test]
    fn texture_coordinates_are_right_in_perspective() {
        use straal_accel::{Geometry, GeometryKind, Group, Hit, Input, Options, Scene};
        use straal_math::Ray;
        // A floor from near to far, seen from the origin along -z.
        let corners = [[-1.0, -1.0, -2.0], [1.0, -1.0, -2.0], [1.0, -1.0, -12.0]].map(Vec3::from_array);
        let uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        let mesh = TriangleMesh {
            positions: corners.into(),
            indices: [[0, 1, 2]].into(),
            uvs: uvs.to_vec(),
            ..TriangleMesh::default()
        };
        let kind =
            GeometryKind::Triangles { positions: mesh.positions.clone(), indices: mesh.indices.clone() };
        let input = Input {
            groups: vec![Group { geometries: vec![0], instances: vec![] }],
            geometries: vec![Geometry { kind, mask: u32::MAX }],
            motions: Vec::new(),
        };
        let scene = Scene::build(input, &(), &Options::default()).unwrap();
        let depths = corners.map(|p| -p.z);
        let mut furthest = 0.0_f32;
        for weights in [[0.6, 0.2, 0.2], [0.2, 0.3, 0.5], [0.1, 0.1, 0.8], [1.0, 1.0, 1.0]] {
            let sum: f32 = weights.iter().sum();
            // By weights on the film, and with each corner's over its depth.
            let mixed = |weights: [f32; 3]| {
                let sum: f32 = weights.iter().sum();
                [0, 1].map(|k| (0..3).map(|i| weights[i] * uvs[i][k]).sum::<f32>() / sum)
            };
            let naive = mixed(weights);
            let right = mixed([0, 1, 2].map(|i| weights[i] / depths[i]));
            let place = (0..3).fold(Vec3::ZERO, |d, i| d + corners[i] * (weights[i] / depths[i] / sum));
            let mut hit = [Hit::MISS];
            scene.closest(&(), &[Ray::new(Vec3::ZERO, place.normalize())], &mut hit);
            let found = mesh.surface(hit[0].primitive, hit[0].u, hit[0].v).uv;
            for k in 0..2 {
                assert!((found[k] - right[k]).abs() < 1e-5, "{weights:?}: {found:?}, not {right:?}");
                furthest = if (naive[k] - right[k]).abs() > furthest {
                    (naive[k] - right[k]).abs()
                } else {
                    furthest
                };
            }
        }
        assert!(furthest > 0.3, "the naive kind is as good: {furthest}");
    }

    #[test]
    fn strange_triangles_have_finite_surfaces() {
        let nan = f32::NAN;
        for third in [Vec3::X, Vec3::X * 2.0, Vec3::splat(nan), Vec3::splat(f32::INFINITY)] {
            let m = TriangleMesh {
                positions: [Vec3::ZERO, Vec3::X, third].into(),
                indices: [[0, 1, 2]].into(),
                normals: vec![Vec3::ZERO, Vec3::splat(nan), Vec3::X],
                uvs: vec![[nan; 2], [0.0; 2], [0.0; 2]],
                ..TriangleMesh::default()
            };
            let s = m.surface(0, 0.25, 0.25);
            let t = m.tangents(0, 0.25, 0.25);
            assert!(s.ng.is_finite() && s.n.is_finite());
            assert!([t.dpdu, t.dpdv, t.dndu, t.dndv].iter().all(|v| v.is_finite()) && t.dpdu != Vec3::ZERO);
            assert_eq!(m.triangle_area(0), 0.0);
        }
    }

    #[test]
    fn points_lie_in_the_plane_within_their_error_and_are_uniform() {
        let mut rng = Rng(21);
        for scale in [1e-3, 1.0, 1e5] {
            for _ in 0..50 {
                let at = rng.cube() * (scale * 20.0);
                let positions = [0; 3].map(|_| at + rng.cube() * scale);
                let m = TriangleMesh {
                    positions: positions.into(),
                    indices: [[0, 1, 2]].into(),
                    normals: vec![],
                    uvs: vec![],
                    ..TriangleMesh::default()
                };
                let [a, b, c] = positions.map(Vec3::as_dvec3);
                let n = (b - a).cross(c - a).normalize();
                for _ in 0..50 {
                    let s = m.sample_triangle(0, rng.square()).point;
                    let off = (s.p.as_dvec3() - a).dot(n).abs();
                    assert!(off <= n.abs().dot(s.p_err.as_dvec3()) * 1.001, "{off}");
                }
                // Uniform: the mean of a linear function is its value at the middle.
                let middle = (a + b + c) / 3.0;
                let along = (b - a) / (b - a).dot(b - a);
                let mean = monte_carlo(22, 2000, |u| {
                    (m.sample_triangle(0, u).point.p.as_dvec3() - middle).dot(along) + 1.0
                });
                assert_agrees("mean", (mean.0, mean.1 + 1e-4), 1.0);
            }
        }
    }

    #[test]
    fn rays_that_leave_a_triangle_do_not_hit_it_again() {
        use super::super::bezier::{teapot, tessellate};
        use super::super::offset_origin;
        use straal_accel::{Geometry, GeometryKind, Group, Hit, Input, Options, Scene};
        use straal_math::Ray;

        let mut rng = Rng(23);
        for (scale, away) in [(1e-3, 0.0), (1.0, 0.0), (1.0, 1e3), (1e5, 1e5)] {
            let map = Affine::scale(DVec3::splat(scale))
                .then(&Affine::rotate(DVec3::ONE, 33.0).unwrap())
                .then(&Affine::translate(DVec3::new(0.6, -1.0, 0.3) * away));
            let mesh = tessellate(&teapot(), 6).transformed(&map).unwrap();
            let (positions, indices) = (mesh.positions.clone(), mesh.indices.clone());
            let kind = GeometryKind::Triangles { positions, indices };
            let input = Input {
                groups: vec![Group { geometries: vec![0], instances: vec![] }],
                geometries: vec![Geometry { kind, mask: u32::MAX }],
                motions: Vec::new(),
            };
            let scene = Scene::build(input, &(), &Options::default()).unwrap();
            let bounds = scene.bounds();
            let mut hits = 0;
            for _ in 0..3000 {
                let o = bounds.center() + rng.direction() * (5.0 * scale as f32);
                let d = bounds.center() + rng.cube() * scale as f32 - o;
                let mut hit = [Hit::MISS];
                scene.closest(&(), &[Ray::new(o, d)], &mut hit);
                if hit[0].primitive == u32::MAX {
                    continue;
                }
                hits += 1;
                let s = mesh.surface(hit[0].primitive, hit[0].u, hit[0].v);
                for _ in 0..4 {
                    let w = rng.direction();
                    if w.dot(s.ng).abs() < 1e-4 {
                        continue; // the normal's own rounding decides
                    }
                    let mut again = [Hit::MISS];
                    let ray = Ray::new(offset_origin(s.p, s.p_err, s.ng, w), w);
                    scene.closest(&(), &[ray], &mut again);
                    assert_ne!(again[0].primitive, hit[0].primitive, "scale {scale}: {s:?} {w:?}");
                }
            }
            assert!(hits > 500, "{hits}");
        }
    }
}
