//! Loop's subdivision (Loop 1987), with the limits of corners and their normals as pbrt has them (Hoppe et al. 1994).

use std::collections::HashMap;

use straal_math::{DVec3, ops};
use straal_scene::Mesh;

/// A mesh of triangles with double precision.
struct Cage {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// What surrounds a corner.
#[derive(Default, Clone)]
struct Ring {
    /// Its neighbours.
    around: Vec<u32>,
    /// Those of them that are at an edge with one triangle only.
    rim: Vec<u32>,
}

/// Subdivides so many times, then moves corners to where they would go.
pub(super) fn subdivided(positions: &[[f32; 3]], triangles: &[[u32; 3]], levels: u32) -> Mesh {
    let positions = positions.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
    let mut cage = Cage { positions, triangles: triangles.to_vec() };
    for _ in 0..levels {
        cage = cage.finer();
    }
    let rings = cage.rings();
    let limit: Vec<DVec3> = (0..cage.positions.len())
        .map(|i| {
            let ring = &rings[i];
            match ring.rim.as_slice() {
                [] if ring.around.is_empty() => cage.positions[i],
                [] => {
                    let n = ring.around.len() as f64;
                    cage.mean(i, &ring.around, 1.0 / (n + 3.0 / (8.0 * beta(ring.around.len()))))
                }
                rim => cage.mean(i, rim, 0.2),
            }
        })
        .collect();
    let cage = Cage { positions: limit, ..cage };
    let normals = cage.normals();
    Mesh {
        positions: cage.positions.iter().map(|p| p.as_vec3().to_array()).collect(),
        normals,
        triangles: cage.triangles,
        ..Mesh::default()
    }
}

/// Loop's weight of each neighbour of a corner with so many.
fn beta(neighbours: usize) -> f64 {
    let n = neighbours as f64;
    let (_, cos) = ops::sin_cos_degrees(360.0 / n);
    let c = 0.375 + 0.25 * cos;
    (0.625 - c * c) / n
}

/// An edge by its ends, the smaller first.
fn edge(a: u32, b: u32) -> (u32, u32) {
    if a < b { (a, b) } else { (b, a) }
}

impl Cage {
    /// Of each edge, the corners across from it.
    fn edges(&self) -> (HashMap<(u32, u32), usize>, Vec<((u32, u32), Vec<u32>)>) {
        let mut known = HashMap::new();
        let mut edges: Vec<((u32, u32), Vec<u32>)> = Vec::new();
        for [a, b, c] in &self.triangles {
            for (from, to, across) in [(*a, *b, *c), (*b, *c, *a), (*c, *a, *b)] {
                let ends = edge(from, to);
                let at = *known.entry(ends).or_insert_with(|| {
                    edges.push((ends, Vec::new()));
                    edges.len() - 1
                });
                edges[at].1.push(across);
            }
        }
        (known, edges)
    }

    fn rings_of(&self, edges: &[((u32, u32), Vec<u32>)]) -> Vec<Ring> {
        let mut rings = vec![Ring::default(); self.positions.len()];
        for ((a, b), across) in edges {
            for (at, other) in [(*a, *b), (*b, *a)] {
                let ring = &mut rings[at as usize];
                ring.around.push(other);
                if across.len() == 1 {
                    ring.rim.push(other);
                }
            }
        }
        rings
    }

    fn rings(&self) -> Vec<Ring> {
        self.rings_of(&self.edges().1)
    }

    /// A corner's place when each of `others` weighs so much.
    fn mean(&self, i: usize, others: &[u32], weight: f64) -> DVec3 {
        let own = self.positions[i] * (1.0 - weight * others.len() as f64);
        others.iter().fold(own, |sum, &o| sum + self.positions[o as usize] * weight)
    }

    /// Four triangles for each.
    fn finer(&self) -> Self {
        let (known, edges) = self.edges();
        let rings = self.rings_of(&edges);
        let mut positions: Vec<DVec3> = (0..self.positions.len())
            .map(|i| match (rings[i].rim.as_slice(), rings[i].around.as_slice()) {
                ([], []) => self.positions[i],
                ([], around) => self.mean(i, around, beta(around.len())),
                (rim, _) => self.mean(i, rim, 0.125),
            })
            .collect();
        let first = positions.len() as u32;
        for ((a, b), across) in &edges {
            let at = |i: u32| self.positions[i as usize];
            positions.push(match across.as_slice() {
                [c, d] => (at(*a) + at(*b)) * 0.375 + (at(*c) + at(*d)) * 0.125,
                _ => (at(*a) + at(*b)) * 0.5,
            });
        }
        let middle = |a: u32, b: u32| first + known[&edge(a, b)] as u32;
        let mut triangles = Vec::with_capacity(4 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        Self { positions, triangles }
    }

    /// The mean of the faces around each corner, by their areas.
    fn normals(&self) -> Vec<[f32; 3]> {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| self.positions[i as usize]);
            let n = (b - a).cross(c - a);
            t.iter().for_each(|&i| sums[i as usize] = sums[i as usize] + n);
        }
        sums.iter().map(|n| n.try_normalize().unwrap_or(DVec3::Z).as_vec3().to_array()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_octahedron_becomes_round() {
        let positions: Vec<[f32; 3]> = vec![
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        let triangles =
            [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let mesh = subdivided(&positions, &triangles, 3);
        assert_eq!(mesh.triangles.len(), 8 * 64);
        assert!(mesh.is_whole());
        let length = |p: &[f32; 3]| p.iter().map(|v| v * v).sum::<f32>().sqrt();
        let all: Vec<f32> = mesh.positions.iter().map(length).collect();
        let (low, high) = all
            .iter()
            .fold((9.0f32, 0.0f32), |(l, h), &v| (if v < l { v } else { l }, if v > h { v } else { h }));
        assert!(low > 0.4 && high < 0.75 && high / low < 1.3, "{low} {high}");
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            let cos: f32 = p.iter().zip(n).map(|(a, b)| a * b).sum::<f32>() / length(p);
            assert!(cos > 0.95, "{p:?} {n:?}");
        }
    }

    #[test]
    fn what_hangs_together_oddly_does_no_harm() {
        let p = vec![[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0, 5.0, 5.0]];
        let mesh = subdivided(&p, &[[0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 0, 0]], 2);
        assert!(mesh.is_whole() && mesh.triangles.len() == 64);
    }
}
