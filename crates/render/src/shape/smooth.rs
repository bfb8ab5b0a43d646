//! Normals at the vertices of a mesh that came without, or whose own are to be put aside.

use std::collections::HashMap;

use straal_math::{DVec3, Vec3, ops};
use straal_scene::mesh::Per;

use super::TriangleMesh;

/// Faces at one edge that are compared each with each: a fold of a surface has two, a fan around a pole may have millions.
const COMPARED: usize = 8;

/// Bytes that smoothing takes for each vertex, of which there is one for two faces, besides what it leaves: the faces' normals,
/// their corners in fans, places, and the edges that leave from the corners.
pub const SMOOTHING_BYTES: usize = {
    let (faces, corners) = (2, 6);
    faces * size_of::<DVec3>()
        + corners * (size_of::<u32>() + size_of::<bool>())
        + 2 * size_of::<u32>()
        + corners * size_of::<([u32; 2], u32)>()
};

/// The mesh with a normal for each vertex: the mean of the faces' around it, each weighed by its angle at the vertex
/// (Thürmer & Wüthrich 1998), which doesn't depend on how a flat face is cut into triangles.
///
/// Two faces are one surface where they share an edge and their normals differ by no more than `crease` degrees; over a
/// sharper edge no mean is taken, so that a vertex there is parted into several. Vertices that stand in the same
/// place count as one, so that a seam in the texture doesn't show. Faces that are wound against each other have
/// normals against each other, and are smooth across their edge nonetheless.
pub fn smooth(mut mesh: TriangleMesh, crease: f64) -> TriangleMesh {
    mesh.normals.clear();
    if !mesh.is_whole() {
        return mesh;
    }
    let faces: Vec<DVec3> = (0..mesh.indices.len() as u32).map(|i| face_normal(&mesh, i)).collect();
    let mut fans = Fans::new(3 * faces.len());
    fans.join_across_edges(&mesh, &faces, crease);
    let (group, means) = fans.means(&mesh, &faces);

    // The first corner at a vertex keeps it; one with another normal gets a copy.
    let mut owner: Vec<Option<(u32, bool)>> = vec![None; mesh.positions.len()];
    let mut copies: HashMap<(u32, u32, bool), u32> = HashMap::new();
    let mut copied: Vec<u32> = Vec::new();
    mesh.normals = vec![Vec3::ZERO; mesh.positions.len()];
    let mut indices = mesh.indices.to_vec();
    for (corner, index) in indices.as_flattened_mut().iter_mut().enumerate() {
        let vertex = *index;
        let key = group[corner];
        let normal = means[key.0 as usize] * if key.1 { -1.0 } else { 1.0 };
        match &mut owner[vertex as usize] {
            free @ None => {
                *free = Some(key);
                mesh.normals[vertex as usize] = normal.as_vec3();
            }
            Some(taken) if *taken == key => {}
            Some(_) => {
                *index = *copies.entry((vertex, key.0, key.1)).or_insert_with(|| {
                    copied.push(vertex);
                    mesh.normals.push(normal.as_vec3());
                    (mesh.normals.len() - 1) as u32
                });
            }
        }
    }
    if !copied.is_empty() {
        let of = |v: &u32| *v as usize;
        let moved = copied.iter().map(|v| mesh.positions[of(v)]);
        mesh.positions = mesh.positions.iter().copied().chain(moved).collect();
        if !mesh.uvs.is_empty() {
            let uvs: Vec<_> = copied.iter().map(|v| mesh.uvs[of(v)]).collect();
            mesh.uvs.extend(uvs);
        }
        let tangents: Vec<_> = copied.iter().filter_map(|v| mesh.tangents.get(of(v)).copied()).collect();
        mesh.tangents.extend(tangents);
        for attribute in mesh.attributes.iter_mut().filter(|a| a.per == Per::Vertex) {
            let more = attribute.of(copied.iter().map(|v| *v as usize));
            attribute.values.extend(more.values);
        }
        mesh.indices = indices.into();
    }
    mesh
}

/// Of unit length; zero for a face without area.
fn face_normal(mesh: &TriangleMesh, face: u32) -> DVec3 {
    let [a, b, c] = mesh.corners(face).map(Vec3::as_dvec3);
    (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::ZERO)
}

/// The angle of a face at one of its corners, in radians; 0 where it has none.
fn angle(mesh: &TriangleMesh, corner: usize) -> f64 {
    let corners = mesh.corners((corner / 3) as u32).map(Vec3::as_dvec3);
    let k = corner % 3;
    let [p, q, r] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
    match ((q - p).try_normalize(), (r - p).try_normalize()) {
        (Some(e), Some(f)) => ops::acos_d(e.dot(f)),
        _ => 0.0,
    }
}

/// A number for each vertex, the same for those in the same place.
fn places(positions: &[Vec3]) -> Vec<u32> {
    // -0 is 0.
    let key = |i: u32| positions[i as usize].to_array().map(|v| (v + 0.0).to_bits());
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(i), i));
    let mut places = vec![0; positions.len()];
    let mut first = 0;
    for (n, &i) in order.iter().enumerate() {
        if n == 0 || key(i) != key(order[n - 1]) {
            first = i;
        }
        places[i as usize] = first;
    }
    places
}

/// Which corners of faces share a normal: sets that grow together, each corner with whether its face is wound against that of
/// the set's first one. A corner is numbered 3 x face + its place in the face.
struct Fans {
    parent: Vec<u32>,
    against: Vec<bool>,
}

impl Fans {
    fn new(corners: usize) -> Self {
        Self { parent: (0..corners as u32).collect(), against: vec![false; corners] }
    }

    /// The first corner of the set, and whether this one's face is wound against that one's.
    fn find(&mut self, corner: u32) -> (u32, bool) {
        let (mut i, mut against) = (corner as usize, false);
        loop {
            let p = self.parent[i] as usize;
            if p == i {
                return (i as u32, against);
            }
            // Halves the way for the next who asks.
            let above = self.parent[p];
            self.against[i] ^= self.against[p];
            self.parent[i] = above;
            against ^= self.against[i];
            i = above as usize;
        }
    }

    fn join(&mut self, a: u32, b: u32, against: bool) {
        let ((a, a_against), (b, b_against)) = (self.find(a), self.find(b));
        let (first, other) = if a < b { (a, b) } else { (b, a) };
        if first != other {
            self.parent[other as usize] = first;
            self.against[other as usize] = a_against ^ b_against ^ against;
        }
    }

    fn join_across_edges(&mut self, mesh: &TriangleMesh, faces: &[DVec3], crease: f64) {
        let least = if crease >= 180.0 { f64::NEG_INFINITY } else { ops::sin_cos_degrees(crease).1 - 1e-9 };
        let places = places(&mesh.positions);
        let place = |corner: usize| places[mesh.indices[corner / 3][corner % 3] as usize];
        let next = |corner: usize| corner - corner % 3 + (corner + 1) % 3;
        // Each edge with the corner that it leaves from.
        let mut edges: Vec<([u32; 2], u32)> = (0..3 * faces.len())
            .filter(|&corner| faces[corner / 3] != DVec3::ZERO)
            .map(|corner| {
                let (a, b) = (place(corner), place(next(corner)));
                (if a < b { [a, b] } else { [b, a] }, corner as u32)
            })
            .collect();
        edges.sort_unstable();
        for edge in edges.chunk_by(|a, b| a.0 == b.0) {
            let reach = if edge.len() > COMPARED { 1 } else { edge.len() };
            for (i, &(_, a)) in edge.iter().enumerate() {
                for &(_, b) in edge[i + 1..].iter().take(reach) {
                    let (a, b) = (a as usize, b as usize);
                    // Neighbours that are wound alike run along their edge in opposite directions.
                    let against = place(a) == place(b);
                    let cosine = faces[a / 3].dot(faces[b / 3]) * if against { -1.0 } else { 1.0 };
                    if cosine < least {
                        continue;
                    }
                    let (start, end) = if against { (b, next(b)) } else { (next(b), b) };
                    self.join(a as u32, start as u32, against);
                    self.join(next(a) as u32, end as u32, against);
                }
            }
        }
    }

    /// Which mean is each corner's, and whether it is turned round; and the means, of unit length or zero.
    fn means(mut self, mesh: &TriangleMesh, faces: &[DVec3]) -> (Vec<(u32, bool)>, Vec<DVec3>) {
        let corners = self.parent.len();
        let (mut group, mut sums) = (Vec::with_capacity(corners), Vec::<DVec3>::new());
        for corner in 0..corners {
            let (first, against) = self.find(corner as u32);
            // A set's first corner comes before all others, and so has its number already.
            let id = if first as usize == corner {
                sums.push(DVec3::ZERO);
                (sums.len() - 1) as u32
            } else {
                let (id, _): (u32, bool) = group[first as usize];
                id
            };
            group.push((id, against));
            let n = faces[corner / 3] * angle(mesh, corner);
            let sum = &mut sums[id as usize];
            *sum = if against { *sum - n } else { *sum + n };
        }
        (group, sums.iter().map(|n| n.try_normalize().unwrap_or(DVec3::ZERO)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A roof of two squares whose normals differ by `degrees`, the ridge along x; each square of two triangles.
    fn roof(degrees: f64, wound_against: bool) -> TriangleMesh {
        let (s, c) = ops::sin_cos_degrees(degrees / 2.0);
        let (s, c) = (s as f32, c as f32);
        let positions = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, -s, c),
            Vec3::new(1.0, -s, c),
            Vec3::new(0.0, -s, -c),
            Vec3::new(1.0, -s, -c),
        ];
        let mut indices = vec![[0, 2, 3], [0, 3, 1], [0, 1, 5], [0, 5, 4]];
        if wound_against {
            indices[2].swap(0, 1);
            indices[3].swap(0, 1);
        }
        TriangleMesh {
            positions: positions.into(),
            indices: indices.into(),
            normals: vec![],
            uvs: (0..6).map(|i| [i as f32, 0.0]).collect(),
            ..TriangleMesh::default()
        }
    }

    fn normals_at_the_ridge(mesh: &TriangleMesh) -> Vec<Vec3> {
        let at_ridge = |&i: &u32| mesh.positions[i as usize] == Vec3::ZERO;
        mesh.indices.iter().flatten().filter(|i| at_ridge(i)).map(|&i| mesh.normals[i as usize]).collect()
    }

    #[test]
    fn an_edge_is_smooth_up_to_the_crease_and_sharp_beyond() {
        let soft = smooth(roof(30.0, false), 40.0);
        assert_eq!(soft.positions.len(), 6, "no vertex is parted");
        for n in normals_at_the_ridge(&soft) {
            assert!((n - Vec3::Y).length() < 1e-6, "{n:?}");
        }
        let sharp = smooth(roof(50.0, false), 40.0);
        assert_eq!((sharp.positions.len(), sharp.uvs.len()), (8, 8), "both ends of the ridge are parted");
        assert!(sharp.is_whole());
        for (i, _) in sharp.indices.iter().enumerate() {
            let s = sharp.surface(i as u32, 0.3, 0.3);
            assert!((s.n - s.ng).length() < 1e-6, "a face of a sharp roof is flat");
            // A copy has the texture of what it is a copy of.
            assert_eq!(s.uv, roof(50.0, false).surface(i as u32, 0.3, 0.3).uv);
        }
        let plain = smooth(roof(50.0, false), 180.0);
        assert_eq!(plain.positions.len(), 6);
    }

    #[test]
    fn faces_that_are_wound_against_each_other_are_smooth() {
        let mixed = smooth(roof(30.0, true), 40.0);
        for (i, _) in mixed.indices.iter().enumerate() {
            let s = mixed.surface(i as u32, 0.3, 0.3);
            assert!(s.n.dot(s.ng) > 0.9, "{s:?}");
        }
        for n in normals_at_the_ridge(&mixed) {
            assert!((n.abs() - Vec3::Y).length() < 1e-6, "{n:?}");
        }
    }

    #[test]
    fn a_box_has_sharp_edges_and_a_fine_ball_has_none() {
        let corners = TriangleMesh::cuboid(-Vec3::ONE, Vec3::ONE);
        let flat = smooth(corners.clone(), 40.0);
        for i in 0..12 {
            let s = flat.surface(i, 0.2, 0.5);
            assert!((s.n - s.ng).length() < 1e-6);
        }
        // Its faces have their own vertices, but stand in the same places.
        let round = smooth(corners, 180.0);
        for (p, n) in round.positions.iter().zip(&round.normals) {
            assert!((*n - p.normalize()).length() < 1e-6, "{p:?} {n:?}");
        }
    }

    #[test]
    fn strange_faces_take_no_part() {
        let mut mesh = roof(30.0, false);
        let odd = [[0, 0, 1], [0, 1, 0], [6, 0, 1]];
        mesh.positions = mesh.positions.iter().copied().chain([Vec3::splat(f32::NAN)]).collect();
        mesh.uvs.push([0.0; 2]);
        mesh.indices = mesh.indices.iter().copied().chain(odd).collect();
        let mesh = smooth(mesh, 40.0);
        assert!(mesh.is_whole());
        assert!((mesh.normals[1] - Vec3::Y).length() < 1e-6);
        assert!(mesh.normals.iter().all(|n| n.is_finite()));
    }

    #[test]
    fn a_fan_of_many_faces_at_one_edge_takes_no_time() {
        let n = 20_000u32;
        let rim = (0..n).map(|i| {
            let (s, c) = ops::sin_cos_degrees(360.0 * f64::from(i) / f64::from(n));
            Vec3::new(s as f32, 0.5, c as f32)
        });
        let mesh = TriangleMesh {
            positions: [Vec3::ZERO, Vec3::Y].into_iter().chain(rim).collect(),
            indices: (0..n).map(|i| [0, 1, i + 2]).collect(),
            normals: vec![],
            uvs: vec![],
            ..TriangleMesh::default()
        };
        assert!(smooth(mesh, 40.0).is_whole());
    }
}
