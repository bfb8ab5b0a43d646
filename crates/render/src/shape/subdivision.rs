//! Subdivision surfaces: a control cage becomes a smooth mesh.
//!
//! Vertices at one place are one vertex, whatever else they have; texture coordinates stay with the corners of faces and are divided evenly,
//! so that seams stay where they are. Open borders become smooth curves of their own, and a border's vertex where more than two of its
//! edges meet stays. Where more than two faces share an edge, it counts as a border. In the end vertices are moved to where endless
//! subdivision would bring them.

use std::collections::BTreeMap;

use straal_math::DVec3;
use straal_scene::desc::Subdivision;

use super::TriangleMesh;

/// A mesh of polygons.
struct Cage {
    points: Vec<DVec3>,
    /// Vertices of all faces, one face after the other.
    corners: Vec<u32>,
    /// The same of their texture coordinates; empty when there are none.
    uvs: Vec<[f64; 2]>,
    /// Where each face begins, and where the last one ends.
    starts: Vec<usize>,
    /// For each face of the first cage, which of these come of it.
    of: Vec<usize>,
}

/// An edge of a cage: its ends, and the faces beside it.
struct Edge {
    ends: [u32; 2],
    faces: Vec<u32>,
}

impl Edge {
    fn is_border(&self) -> bool {
        self.faces.len() != 2
    }
}

/// A mesh subdivided, and for each of its triangles that there were before, how many there are up to it: the n-th number is where those
/// of the n-th begin.
pub struct Subdivided {
    /// The smooth mesh.
    pub mesh: TriangleMesh,
    /// By triangle of the cage, with one more at the end.
    pub starts: Vec<u32>,
}

/// Subdivides a mesh whose triangles were cut from polygons with so many `sides` each; without, all were triangles.
pub fn subdivide(mesh: &TriangleMesh, sides: &[u32], scheme: &Subdivision, levels: u32) -> Subdivided {
    let is_loop = *scheme == Subdivision::Loop;
    let (mut cage, triangles_of) = Cage::new(mesh, if is_loop { &[] } else { sides });
    for _ in 0..levels {
        cage = if is_loop { cage.looped() } else { cage.catmull_clark() };
    }
    if levels > 0 {
        cage.points = cage.limit(is_loop);
    }
    cage.finish(&triangles_of, mesh.flip)
}

impl Cage {
    /// The polygons of a mesh, and where the triangles of each begin, with one more at the end.
    fn new(mesh: &TriangleMesh, sides: &[u32]) -> (Self, Vec<u32>) {
        let mut known: BTreeMap<[u32; 3], u32> = BTreeMap::new();
        let mut points = Vec::new();
        // + 0 makes one zero of two.
        let welded: Vec<u32> = mesh
            .positions
            .iter()
            .map(|p| {
                *known.entry(p.to_array().map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                    points.push(p.as_dvec3());
                    points.len() as u32 - 1
                })
            })
            .collect();
        let mut cage = Self { points, corners: vec![], uvs: vec![], starts: vec![0], of: vec![] };
        let mut triangles_of = vec![0];
        let mut at = 0;
        let mut sides = sides.iter();
        while at < mesh.indices.len() {
            let count = (sides.next().map_or(1, |n| n.saturating_sub(2)) as usize).max(1);
            let end = (at + count).min(mesh.indices.len());
            let ring = outline(&mesh.indices[at..end]);
            cage.corners.extend(ring.iter().map(|i| welded[*i as usize]));
            cage.uvs
                .extend(ring.iter().filter_map(|i| mesh.uvs.get(*i as usize).map(|uv| uv.map(f64::from))));
            cage.starts.push(cage.corners.len());
            cage.of.push(cage.of.len());
            at = end;
            triangles_of.push(at as u32);
        }
        if cage.uvs.len() != cage.corners.len() {
            cage.uvs.clear();
        }
        (cage, triangles_of)
    }

    fn faces(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        self.starts.windows(2).map(|w| w[0]..w[1])
    }

    /// All edges, by their ends, and which edge each corner begins.
    fn edges(&self) -> (Vec<Edge>, Vec<u32>) {
        let mut known: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let (mut edges, mut begun): (Vec<Edge>, Vec<u32>) = (Vec::new(), Vec::new());
        for (f, face) in self.faces().enumerate() {
            let corners = &self.corners[face];
            for (i, &a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                let ends = if a < b { [a, b] } else { [b, a] };
                let edge = *known.entry(ends).or_insert_with(|| {
                    edges.push(Edge { ends, faces: vec![] });
                    edges.len() as u32 - 1
                });
                edges[edge as usize].faces.push(f as u32);
                begun.push(edge);
            }
        }
        (edges, begun)
    }

    fn point(&self, i: u32) -> DVec3 {
        self.points[i as usize]
    }

    fn mean<T>(all: &[T], zero: T, times: impl Fn(T, f64) -> T, plus: impl Fn(T, T) -> T) -> T
    where
        T: Copy,
    {
        times(all.iter().fold(zero, |sum, x| plus(sum, *x)), 1.0 / all.len() as f64)
    }

    fn middle(&self, face: std::ops::Range<usize>) -> DVec3 {
        let points: Vec<_> = self.corners[face].iter().map(|i| self.point(*i)).collect();
        Self::mean(&points, DVec3::ZERO, |p, k| p * k, |a, b| a + b)
    }

    /// What is next to each vertex.
    fn around(&self, edges: &[Edge]) -> Vec<Around> {
        let mut all = vec![Around::default(); self.points.len()];
        for edge in edges {
            for (i, &v) in edge.ends.iter().enumerate() {
                let (here, other) = (&mut all[v as usize], self.point(edge.ends[1 - i]));
                here.edges += 1;
                here.sum += other;
                if edge.is_border() {
                    here.borders += 1;
                    here.border_sum += other;
                }
            }
        }
        all
    }

    /// One step of Catmull & Clark (1978), with their borders as cubic B-splines.
    fn catmull_clark(&self) -> Self {
        let (edges, begun) = self.edges();
        let middles: Vec<_> = self.faces().map(|face| self.middle(face)).collect();
        let mut around = self.around(&edges);
        for (face, middle) in self.faces().zip(&middles) {
            for v in &self.corners[face] {
                let here = &mut around[*v as usize];
                here.faces += 1;
                here.middle_sum += *middle;
            }
        }
        let mut points: Vec<DVec3> = self
            .points
            .iter()
            .zip(&around)
            .map(|(&p, a)| {
                let n = f64::from(a.edges);
                match a.borders {
                    0 if a.edges > 0 && a.faces > 0 => {
                        let edges = (a.sum / n + p) * 0.5;
                        (a.middle_sum / f64::from(a.faces) + edges * 2.0 + p * (n - 3.0)) / n
                    }
                    2 => p * 0.75 + a.border_sum * 0.125,
                    _ => p,
                }
            })
            .collect();
        let first_edge = points.len() as u32;
        points.extend(edges.iter().map(|edge| {
            let ends = self.point(edge.ends[0]) + self.point(edge.ends[1]);
            match edge.faces.as_slice() {
                [f, g] => (ends + middles[*f as usize] + middles[*g as usize]) * 0.25,
                _ => ends * 0.5,
            }
        }));
        let first_middle = points.len() as u32;
        points.extend(&middles);
        let mut out = Self { points, corners: vec![], uvs: vec![], starts: vec![0], of: vec![] };
        for (f, face) in self.faces().enumerate() {
            let n = face.len();
            let uvs = self.uvs.get(face.clone()).unwrap_or_default();
            let half = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            let middle =
                Self::mean(uvs, [0.0; 2], |x, k| x.map(|x| x * k), |a, b| [a[0] + b[0], a[1] + b[1]]);
            for i in 0..n {
                let before = (i + n - 1) % n;
                let (here, back) = (face.start + i, face.start + before);
                out.corners.extend([
                    self.corners[here],
                    first_edge + begun[here],
                    first_middle + f as u32,
                    first_edge + begun[back],
                ]);
                if !uvs.is_empty() {
                    out.uvs.extend([
                        uvs[i],
                        half(uvs[i], uvs[(i + 1) % n]),
                        middle,
                        half(uvs[before], uvs[i]),
                    ]);
                }
                out.starts.push(out.corners.len());
                out.of.push(self.of[f]);
            }
        }
        out
    }

    /// One step of Loop (1987), with Warren's weights.
    fn looped(&self) -> Self {
        let (edges, begun) = self.edges();
        let around = self.around(&edges);
        let mut points: Vec<DVec3> = self
            .points
            .iter()
            .zip(&around)
            .map(|(&p, a)| match a.borders {
                0 if a.edges > 0 => {
                    let (n, beta) = (f64::from(a.edges), beta(a.edges));
                    p * (1.0 - n * beta) + a.sum * beta
                }
                2 => p * 0.75 + a.border_sum * 0.125,
                _ => p,
            })
            .collect();
        let first_edge = points.len() as u32;
        points.extend(edges.iter().map(|edge| {
            let [a, b] = edge.ends;
            let ends = self.point(a) + self.point(b);
            if edge.is_border() {
                return ends * 0.5;
            }
            let opposite = edge.faces.iter().fold(DVec3::ZERO, |sum, f| {
                let face = &self.corners[3 * *f as usize..][..3];
                sum + face.iter().find(|v| **v != a && **v != b).map_or(ends * 0.5, |v| self.point(*v))
            });
            ends * 0.375 + opposite * 0.125
        }));
        let mut out = Self { points, corners: vec![], uvs: vec![], starts: vec![0], of: vec![] };
        for (f, face) in self.faces().enumerate() {
            let v = &self.corners[face.clone()];
            let e: Vec<_> = begun[face.clone()].iter().map(|e| first_edge + e).collect();
            let uvs = self.uvs.get(face).unwrap_or_default();
            let half = |i: usize, j: usize| [0.5 * (uvs[i][0] + uvs[j][0]), 0.5 * (uvs[i][1] + uvs[j][1])];
            out.corners.extend([v[0], e[0], e[2], e[0], v[1], e[1], e[2], e[1], v[2], e[0], e[1], e[2]]);
            if !uvs.is_empty() {
                let (a, b, c) = (half(0, 1), half(1, 2), half(2, 0));
                out.uvs.extend([uvs[0], a, c, a, uvs[1], b, c, b, uvs[2], a, b, c]);
            }
            for _ in 0..4 {
                out.starts.push(out.starts.last().copied().unwrap_or(0) + 3);
                out.of.push(self.of[f]);
            }
        }
        out
    }

    /// Where vertices end up (Loop: Hoppe et al. 1994; Catmull & Clark: Halstead, Kass & DeRose 1993).
    fn limit(&self, is_loop: bool) -> Vec<DVec3> {
        let (edges, _) = self.edges();
        let mut around = self.around(&edges);
        if !is_loop {
            for face in self.faces() {
                let corners = &self.corners[face];
                for (i, v) in corners.iter().enumerate() {
                    // The corner across.
                    let here = &mut around[*v as usize];
                    here.middle_sum += self.point(corners[(i + 2) % corners.len()]);
                }
            }
        }
        self.points
            .iter()
            .zip(&around)
            .map(|(&p, a)| {
                let n = f64::from(a.edges);
                match (a.borders, is_loop) {
                    (0, true) if a.edges > 0 => {
                        let gamma = 1.0 / (n + 0.375 / beta(a.edges));
                        p * (1.0 - n * gamma) + a.sum * gamma
                    }
                    (0, false) if a.edges > 0 => (p * (n * n) + a.sum * 4.0 + a.middle_sum) / (n * (n + 5.0)),
                    (2, true) => p * 0.6 + a.border_sum * 0.2,
                    (2, false) => (p * 4.0 + a.border_sum) / 6.0,
                    _ => p,
                }
            })
            .collect()
    }

    /// As triangles, with smooth normals.
    fn finish(&self, triangles_of: &[u32], flip: bool) -> Subdivided {
        let mut normals = vec![DVec3::ZERO; self.points.len()];
        for face in self.faces() {
            let corners = &self.corners[face];
            let n = corners.len();
            // The area of each corner's own triangle weighs it.
            for i in 0..n {
                let [a, b, c] = [(i + n - 1) % n, i, (i + 1) % n].map(|k| self.point(corners[k]));
                let here = &mut normals[corners[i] as usize];
                *here += (c - b).cross(a - b);
            }
        }
        // A vertex for each place and texture coordinate.
        let mut known: BTreeMap<(u32, [u32; 2]), u32> = BTreeMap::new();
        let (mut positions, mut vertex_normals, mut uvs, mut indices) = (vec![], vec![], vec![], vec![]);
        let mut ends = vec![0_u32; triangles_of.len()];
        for (f, face) in self.faces().enumerate() {
            let of: Vec<u32> = face
                .map(|k| {
                    let v = self.corners[k];
                    let uv = self.uvs.get(k).map(|uv| uv.map(|x| x as f32));
                    *known.entry((v, uv.map_or([0; 2], |uv| uv.map(f32::to_bits)))).or_insert_with(|| {
                        positions.push(self.point(v).as_vec3());
                        let n = normals[v as usize].try_normalize().unwrap_or(DVec3::Y).as_vec3();
                        vertex_normals.push(if flip { -n } else { n });
                        uvs.extend(uv);
                        positions.len() as u32 - 1
                    })
                })
                .collect();
            for i in 1..of.len().saturating_sub(1) {
                indices.push([of[0], of[i], of[i + 1]]);
            }
            ends[self.of[f] + 1] = indices.len() as u32;
        }
        // All triangles of a face of the cage begin where its first one does.
        let mut starts = Vec::new();
        for (f, run) in triangles_of.windows(2).enumerate() {
            starts.extend((run[0]..run[1]).map(|_| ends[f]));
        }
        starts.push(indices.len() as u32);
        let mesh = TriangleMesh {
            positions: positions.into(),
            indices: indices.into(),
            normals: vertex_normals,
            uvs,
            flip,
            ..TriangleMesh::default()
        };
        Subdivided { mesh, starts }
    }
}

/// What is next to a vertex.
#[derive(Clone, Copy, Default)]
struct Around {
    edges: u32,
    faces: u32,
    borders: u32,
    sum: DVec3,
    border_sum: DVec3,
    middle_sum: DVec3,
}

/// The weight of each neighbour by their number.
fn beta(n: u32) -> f64 {
    if n == 3 { 0.1875 } else { 0.375 / f64::from(n) }
}

/// The vertices around a polygon that was cut into triangles: its edges are those that only one of them has.
fn outline(triangles: &[[u32; 3]]) -> Vec<u32> {
    if let [one] = triangles {
        return one.to_vec();
    }
    let mut next: BTreeMap<u32, u32> = BTreeMap::new();
    let pairs = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    for [a, b] in triangles.iter().flat_map(pairs) {
        let is_shared = triangles.iter().flat_map(pairs).any(|[c, d]| [d, c] == [a, b]);
        if !is_shared {
            next.insert(a, b);
        }
    }
    let Some(first) = triangles.first().map(|t| t[0]) else { return Vec::new() };
    let mut ring = vec![first];
    let mut at = first;
    while let Some(&to) = next.get(&at).filter(|to| **to != first && ring.len() < next.len()) {
        ring.push(to);
        at = to;
    }
    if ring.len() < 3 { triangles.first().map_or(ring, |t| t.to_vec()) } else { ring }
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::Vec3;

    fn cube() -> (TriangleMesh, Vec<u32>) {
        (TriangleMesh::cuboid(Vec3::splat(-1.0), Vec3::ONE), vec![4; 6])
    }

    #[test]
    fn a_cube_becomes_round() {
        let (cube, sides) = cube();
        for (scheme, sides) in [(Subdivision::CatmullClark, sides.as_slice()), (Subdivision::Loop, &[])] {
            let round = subdivide(&cube, sides, &scheme, 3);
            let mesh = &round.mesh;
            let corners = if sides.is_empty() { 36 } else { 24 };
            let how = straal_scene::desc::Subdivide { scheme: scheme.clone(), levels: 3 };
            assert_eq!(mesh.indices.len() as u64, how.triangles(corners, 12));
            assert!(mesh.is_whole());
            for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
                let r = p.length();
                assert!((0.5..1.2).contains(&r), "{scheme:?}: {p:?}");
                assert!(p.normalize().dot(*n) > 0.85, "{scheme:?}: {p:?} {n:?}");
            }
            assert_eq!(round.starts.len(), 13);
            assert_eq!((round.starts[0], round.starts[12]), (0, mesh.indices.len() as u32));
        }
    }

    /// The place of a cube's corner after endless subdivision is known: (9 p + 4 sum of edges + sum of faces) / 24 of the first cage's.
    #[test]
    fn corners_end_up_where_they_should() {
        let (cube, sides) = cube();
        // p = (1, 1, 1): edges lead to points whose sum is p, across its faces lie points whose sum is -p.
        let want = (9.0 + 4.0 - 1.0) / 24.0;
        for levels in 1..4 {
            let mesh = subdivide(&cube, &sides, &Subdivision::CatmullClark, levels).mesh;
            let off = |p: &Vec3| (*p - Vec3::splat(want as f32)).length();
            assert!(mesh.positions.iter().any(|p| off(p) < 1e-6), "{levels}");
        }
    }

    #[test]
    fn a_flat_sheet_stays_flat_and_in_its_border() {
        let positions: Vec<Vec3> = (0..9).map(|i| Vec3::new((i % 3) as f32, 0.0, (i / 3) as f32)).collect();
        let mut indices = vec![];
        for a in [0, 1, 3, 4] {
            indices.extend([[a, a + 3, a + 4], [a, a + 4, a + 1]]);
        }
        let uvs = positions.iter().map(|p| [p.x, p.z]).collect();
        let sheet = TriangleMesh {
            positions: positions.into(),
            indices: indices.into(),
            uvs,
            ..TriangleMesh::default()
        };
        for (scheme, sides) in [(Subdivision::CatmullClark, [4; 4].as_slice()), (Subdivision::Loop, &[])] {
            let mesh = subdivide(&sheet, sides, &scheme, 2).mesh;
            for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
                assert!(p.y == 0.0 && n.y > 0.999, "{p:?} {n:?}");
                assert!(p.x >= 0.0 && p.x <= 2.0 && p.z >= 0.0 && p.z <= 2.0, "{p:?}");
            }
            assert_eq!(mesh.uvs.len(), mesh.positions.len());
        }
    }

    #[test]
    fn polygons_are_put_together_again() {
        assert_eq!(outline(&[[4, 5, 6]]), [4, 5, 6]);
        assert_eq!(outline(&[[0, 1, 2], [0, 2, 3]]), [0, 1, 2, 3]);
        let mut ring = outline(&[[1, 2, 3], [3, 4, 0], [0, 1, 3]]);
        let first = ring.iter().position(|i| *i == 0).expect("it is there");
        ring.rotate_left(first);
        assert_eq!(ring, [0, 1, 2, 3, 4]);
    }
}
