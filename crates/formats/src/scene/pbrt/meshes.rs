//! Meshes whose corners stand in the text.

use straal_math::Affine;
use straal_scene::Mesh;
use straal_scene::desc::{MaterialRef, Subdivide, Subdivision};

use super::Reader;
use super::params::{Params, Type};

/// Squares along an edge of a bilinear patch that isn't flat.
const FINE: usize = 8;

impl Reader<'_, '_> {
    /// Corners and what they have.
    fn corners(&mut self, params: &Params) -> Option<Mesh> {
        let Some((p, span)) = params.singles("P", &[Type::Point3, Type::Vector3]) else {
            self.error(params.span, "this mesh has no corners: `\"point3 P\"` is missing");
            return None;
        };
        let count = p.len() / 3;
        if count as u64 > self.means.limits.max_vertices {
            self.error(
                span,
                format!("too many vertices: {count}, the limit is {}", self.means.limits.max_vertices),
            );
            return None;
        }
        let mut mesh = Mesh { positions: triples(p), ..Mesh::default() };
        if let Some((n, span)) = params.singles("N", &[Type::Normal, Type::Vector3]) {
            if n.len() / 3 == count {
                mesh.normals = triples(n);
            } else {
                self.warn(
                    span,
                    format!("there are {} normals for {count} corners: they are left out", n.len() / 3),
                );
            }
        }
        let both = [Type::Point2, Type::Vector2];
        let uv = params.singles("uv", &both).or_else(|| params.singles("st", &both));
        let older = params.floats("uv").or_else(|| params.floats("st"));
        if let Some((uv, span)) = uv {
            if uv.len() / 2 == count {
                mesh.uvs = uv.chunks_exact(2).map(|c| [c[0], c[1]]).collect();
            } else {
                self.warn(
                    span,
                    format!(
                        "there are {} texture coordinates for {count} corners: they are left out",
                        uv.len() / 2
                    ),
                );
            }
        } else if let Some(uv) = older.filter(|uv| uv.len() == 2 * count) {
            mesh.uvs = uv.chunks_exact(2).map(|c| [c[0] as f32, c[1] as f32]).collect();
        }
        params.pass_over(&["S", "faceIndices", "faceindices"]);
        Some(mesh)
    }

    /// Indices, so many a face; complains of those that lead nowhere.
    fn faces<const N: usize>(&mut self, params: &Params, corners: usize) -> Option<Vec<[u32; N]>> {
        let Some(indices) = params.integers("indices") else {
            if corners == N {
                return Some(vec![std::array::from_fn(|i| i as u32)]);
            }
            self.error(params.span, "this mesh has no faces: `\"integer indices\"` is missing");
            return None;
        };
        if indices.len() % N != 0 {
            let message = format!(
                "there are {} indices, which is no multiple of {N}: the last are left out",
                indices.len()
            );
            self.warn(params.span, message);
        }
        let inside = |i: &i32| usize::try_from(*i).is_ok_and(|i| i < corners);
        if let Some(odd) = indices.iter().find(|i| !inside(i)) {
            let message =
                format!("`indices` names corner {odd}, but there are only {corners}, counted from 0");
            self.error(params.span, message);
            return None;
        }
        Some(indices.chunks_exact(N).map(|c| std::array::from_fn(|i| c[i].unsigned_abs())).collect())
    }

    pub(super) fn triangle_mesh(&mut self, params: &Params, at: (&Affine, Option<MaterialRef>)) {
        let Some(mut mesh) = self.corners(params) else { return };
        let Some(triangles) = self.faces::<3>(params, mesh.positions.len()) else { return };
        mesh.triangles = triangles;
        face_as_normals(&mut mesh);
        self.made_mesh(mesh, at, params.span);
    }

    pub(super) fn bilinear_mesh(&mut self, params: &Params, at: (&Affine, Option<MaterialRef>)) {
        if params.has("emissionfilename") {
            params.pass_over(&["emissionfilename"]);
        }
        let Some(corners) = self.corners(params) else { return };
        let Some(patches) = self.faces::<4>(params, corners.positions.len()) else { return };
        let mut mesh = Mesh::default();
        for patch in &patches {
            add_patch(&corners, patch, &mut mesh);
        }
        face_as_normals(&mut mesh);
        self.made_mesh(mesh, at, params.span);
    }

    pub(super) fn loop_subdivision(&mut self, params: &Params, at: (&Affine, Option<MaterialRef>)) {
        let Some(cage) = self.corners(params) else { return };
        let Some(triangles) = self.faces::<3>(params, cage.positions.len()) else { return };
        params.pass_over(&["scheme"]);
        let wanted = params.maybe_integer("nlevels").unwrap_or_else(|| params.integer("levels", 3));
        let levels = wanted.clamp(0, 8).unsigned_abs();
        if i64::from(levels) != i64::from(wanted) {
            self.warn(params.span, format!("this is subdivided {levels} times"));
        }
        // Loop's rule knows places only.
        let cage = Mesh { normals: Vec::new(), uvs: Vec::new(), triangles, ..cage };
        self.made_cage(cage, Subdivide { scheme: Subdivision::Loop, levels }, (at, params.span));
    }
}

fn triples(numbers: &[f32]) -> Vec<[f32; 3]> {
    numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
}

/// Turns triangles round that look another way than the normals at their corners: these say where the front is.
fn face_as_normals(mesh: &mut Mesh) {
    let Mesh { positions, normals, triangles, .. } = mesh;
    if normals.is_empty() {
        return;
    }
    for t in triangles {
        let [a, b, c] = t.map(|i| positions[i as usize].map(f64::from));
        let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
        let cross = [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
        let along: f64 = t
            .iter()
            .map(|&i| (0..3).map(|k| cross[k] * f64::from(normals[i as usize][k])).sum::<f64>())
            .sum();
        if along < 0.0 {
            t.swap(1, 2);
        }
    }
}

/// Adds a patch between four corners: that at u = v = 0, that at u = 1, that at v = 1 and the one across.
fn add_patch(corners: &Mesh, patch: &[u32; 4], mesh: &mut Mesh) {
    let p = patch.map(|i| corners.positions[i as usize].map(f64::from));
    // Flat and straight where the corners make a parallelogram.
    let size = (0..3).map(|k| (p[3][k] - p[0][k]).abs() + (p[2][k] - p[1][k]).abs()).sum::<f64>();
    let bent = (0..3).map(|k| (p[0][k] + p[3][k] - p[1][k] - p[2][k]).abs()).sum::<f64>();
    let fine = if bent <= 1e-5 * size { 1 } else { FINE };
    let first = mesh.positions.len() as u32;
    for j in 0..=fine {
        for i in 0..=fine {
            let (u, v) = (i as f64 / fine as f64, j as f64 / fine as f64);
            let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
            let mix3 = |of: &dyn Fn(usize) -> [f32; 3]| {
                let each: [[f32; 3]; 4] = std::array::from_fn(of);
                [0, 1, 2].map(|k| (0..4).map(|c| weights[c] * f64::from(each[c][k])).sum::<f64>() as f32)
            };
            mesh.positions.push(mix3(&|c| corners.positions[patch[c] as usize]));
            if !corners.normals.is_empty() {
                mesh.normals.push(mix3(&|c| corners.normals[patch[c] as usize]));
            }
            mesh.uvs.push(match corners.uvs.is_empty() {
                true => [u as f32, v as f32],
                false => [0, 1].map(|k| {
                    (0..4).map(|c| weights[c] * f64::from(corners.uvs[patch[c] as usize][k])).sum::<f64>()
                        as f32
                }),
            });
        }
    }
    let row = fine as u32 + 1;
    for j in 0..fine as u32 {
        for i in 0..fine as u32 {
            let a = first + j * row + i;
            mesh.triangles.extend([[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normals_say_where_the_front_is() {
        let mut mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normals: vec![[0.0, 0.0, -1.0]; 3],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        face_as_normals(&mut mesh);
        assert_eq!(mesh.triangles, [[0, 2, 1]]);
    }

    #[test]
    fn a_flat_patch_is_two_triangles_and_a_bent_one_more() {
        let mut corners = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
            ..Mesh::default()
        };
        let mut mesh = Mesh::default();
        add_patch(&corners, &[0, 1, 2, 3], &mut mesh);
        assert_eq!(mesh.triangles, [[0, 1, 3], [0, 3, 2]]);
        corners.positions[3][2] = 1.0;
        add_patch(&corners, &[0, 1, 2, 3], &mut mesh);
        assert_eq!(mesh.triangles.len(), 2 + 2 * FINE * FINE);
        assert!(mesh.is_whole() && mesh.uvs.len() == mesh.positions.len());
    }
}
