//! Tangents for meshes that come without, as the specification asks for them: by the rules of MikkTSpace (Mikkelsen 2008, "Simulation of Wrinkled
//! Surfaces Revisited", and the code that he made public).
//!
//! Each triangle's direction of rising u is laid onto the plane across a vertex' normal, and the mean is taken over the triangles that share place,
//! normal and coordinates there, each weighed by its angle. Triangles that show the picture mirrored have a mean of their own. What is simpler than there: triangles that
//! meet in a vertex without sharing an edge are of one mean.

use std::collections::BTreeMap;

use straal_math::{DVec3, ops};
use straal_scene::Mesh;
use straal_scene::mesh::Per;

use super::geometry::set_name;

/// What tells one vertex from another, and whether it is of a mirrored triangle.
type Key = ([u32; 8], bool);

/// Gives a mesh with normals tangents by a set of texture coordinates. Where that is missing it stays without, and so it does where it would need too
/// many vertices.
pub(super) fn make(mesh: &mut Mesh, set: usize, primary: usize, most: u64) {
    let name = set_name(set, primary);
    let coordinates: Vec<[f32; 2]> = if set == primary {
        mesh.uvs.clone()
    } else {
        let Some(found) = mesh.attributes.iter().find(|a| a.name == name) else { return };
        found.values.chunks_exact(2).map(|uv| [uv[0], uv[1]]).collect()
    };
    let count = mesh.positions.len();
    if coordinates.len() != count || mesh.normals.len() != count {
        return;
    }
    let place = |i: u32| double(mesh.positions[i as usize]);
    let key = |i: u32, mirrored: bool| -> Key {
        let i = i as usize;
        let numbers = mesh.positions[i].iter().chain(&mesh.normals[i]).chain(&coordinates[i]);
        let mut out = [0; 8];
        out.iter_mut().zip(numbers).for_each(|(to, v)| *to = (v + 0.0).to_bits());
        (out, mirrored)
    };

    let mut sums: BTreeMap<Key, DVec3> = BTreeMap::new();
    let mut mirrors = Vec::with_capacity(mesh.triangles.len());
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| coordinates[i as usize].map(f64::from));
        let (d1, d2) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
        let area = d1[0] * d2[1] - d1[1] * d2[0];
        let mirrored = area < 0.0;
        mirrors.push(mirrored);
        let [pa, pb, pc] = t.map(place);
        let along = ((pb - pa) * d2[1] - (pc - pa) * d1[1]) * if mirrored { -1.0 } else { 1.0 };
        for k in 0..3 {
            let n = double(mesh.normals[t[k] as usize]).try_normalize().unwrap_or(DVec3::ZERO);
            let flat = |v: DVec3| (v - n * n.dot(v)).try_normalize();
            let [here, next, last] = [0, 1, 2].map(|step| place(t[(k + step) % 3]));
            let edges = flat(next - here).zip(flat(last - here));
            let sum = sums.entry(key(t[k], mirrored)).or_insert(DVec3::ZERO);
            if let (Some(along), Some((e, f)), true) = (flat(along), edges, area != 0.0) {
                let cos = e.dot(f);
                // A last bit beyond 1 is none.
                let cos = if cos < -1.0 { -1.0 } else { cos };
                *sum += along * ops::acos_d(if cos > 1.0 { 1.0 } else { cos });
            }
        }
    }

    // A vertex with triangles of both kinds becomes two.
    let mut kind: Vec<Option<bool>> = vec![None; count];
    let mut copies: BTreeMap<u32, u32> = BTreeMap::new();
    let mut triangles = mesh.triangles.clone();
    for (t, mirrored) in triangles.iter_mut().zip(&mirrors) {
        for i in t {
            if kind[*i as usize].get_or_insert(*mirrored) != mirrored {
                let next = (count + copies.len()) as u32;
                *i = *copies.entry(*i).or_insert(next);
            }
        }
    }
    if (count + copies.len()) as u64 > most {
        return;
    }
    let tangent = |i: u32, mirrored: bool| {
        let along = sums.get(&key(i, mirrored)).and_then(|sum| sum.try_normalize()).unwrap_or(DVec3::ZERO);
        let [x, y, z] = along.to_array().map(|v| v as f32);
        [x, y, z, if mirrored { -1.0 } else { 1.0 }]
    };
    let mut tangents: Vec<[f32; 4]> =
        (0..count as u32).map(|i| tangent(i, kind[i as usize].unwrap_or(false))).collect();
    let mut order: Vec<(u32, u32)> = copies.into_iter().map(|(of, copy)| (copy, of)).collect();
    order.sort_unstable();
    let copied: Vec<u32> = order.into_iter().map(|(_, of)| of).collect();
    tangents.extend(copied.iter().map(|&of| tangent(of, !kind[of as usize].unwrap_or(false))));
    mesh.triangles = triangles;
    mesh.tangents = tangents;
    for of in copied.into_iter().map(|of| of as usize) {
        mesh.positions.push(mesh.positions[of]);
        mesh.normals.push(mesh.normals[of]);
        if let Some(uv) = mesh.uvs.get(of).copied() {
            mesh.uvs.push(uv);
        }
        for a in mesh.attributes.iter_mut().filter(|a| a.per == Per::Vertex) {
            a.values.extend_from_within(of * a.channels..(of + 1) * a.channels);
        }
    }
}

fn double(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles that share the edge x = 1, of which the second shows the picture mirrored.
    fn book() -> Mesh {
        Mesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 0.0, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 4],
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            ..Mesh::default()
        }
    }

    #[test]
    fn mirrored_triangles_have_tangents_of_their_own() {
        let mut mesh = book();
        make(&mut mesh, 0, 0, 100);
        assert!(mesh.is_whole());
        assert_eq!((mesh.positions.len(), mesh.tangents.len()), (6, 6));
        for (t, (x, side)) in mesh.triangles.iter().zip([(1.0, 1.0), (-1.0, -1.0)]) {
            for i in t {
                let [a, b, c, w] = mesh.tangents[*i as usize];
                assert!(
                    (a - x).abs() < 1e-6 && b.abs() < 1e-6 && c.abs() < 1e-6 && w == side,
                    "{i}: {a} {w}"
                );
            }
        }
        assert_eq!(mesh.positions[4..], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
        // No room for the copies, and no coordinates.
        let mut mesh = book();
        make(&mut mesh, 0, 0, 5);
        assert!(mesh.tangents.is_empty() && mesh.positions.len() == 4);
        make(&mut mesh, 1, 0, 100);
        assert!(mesh.tangents.is_empty());
    }

    #[test]
    fn the_mean_is_weighed_by_angles() {
        // A ridge along y: u runs down both of its sides, so that on the ridge it is level.
        let mut mesh = Mesh {
            positions: vec![[-1.0, 0.0, -1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, -1.0]],
            normals: vec![[-0.7, 0.0, 0.7], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.7, 0.0, 0.7]],
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 0.0]],
            triangles: vec![[0, 1, 2], [1, 3, 2]],
            ..Mesh::default()
        };
        make(&mut mesh, 0, 0, 100);
        let near = |i: usize, want: [f64; 3]| {
            let [x, y, z, w] = mesh.tangents[i];
            let off = double([x, y, z]) - DVec3::from_array(want);
            assert!(off.length() < 1e-6 && w == 1.0, "{i}: {:?}", mesh.tangents[i]);
        };
        near(1, [1.0, 0.0, 0.0]);
        let half = 0.5_f64.sqrt();
        near(0, [half, 0.0, half]);
        near(3, [half, 0.0, -half]);
    }

    #[test]
    fn what_has_no_extent_has_no_tangent() {
        let mut mesh = Mesh { uvs: vec![[0.5, 0.5]; 4], ..book() };
        make(&mut mesh, 0, 0, 100);
        assert_eq!(mesh.tangents, vec![[0.0, 0.0, 0.0, 1.0]; 4]);
    }
}
