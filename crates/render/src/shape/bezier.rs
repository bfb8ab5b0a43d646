//! Bicubic Bézier patches, tessellated; among them the Utah teapot.

use straal_math::{DVec3, Vec3};

use super::TriangleMesh;

/// A patch: 4 x 4 control points, row by row; u runs along a row, v from row to row.
pub type Patch = [Vec3; 16];

/// Cuts every patch into `n` x `n` quads of two triangles, with smooth normals and texture coordinates (u, v) of the
/// patch. The outside is where ∂p/∂u × ∂p/∂v points.
///
/// Patches that share the control points of an edge, in either direction, share the vertices of that edge to the last
/// bit, so that nothing shows between them. Where an edge is collapsed into a point its triangles are left out and
/// the normals are those of the surface close by.
pub fn tessellate(patches: &[Patch], n: u32) -> TriangleMesh {
    let n = if n == 0 { 1 } else { n };
    let (mut positions, mut normals, mut uvs, mut indices) = (vec![], vec![], vec![], vec![]);
    for patch in patches {
        let control = patch.map(Vec3::as_dvec3);
        let first = positions.len() as u32;
        for j in 0..=n {
            for i in 0..=n {
                let (u, v) = (Weight::new(i, n), Weight::new(j, n));
                positions.push(evaluate(&control, u, v).p.as_vec3());
                normals.push(normal(&control, u, v));
                uvs.push([u.t as f32, v.t as f32]);
            }
        }
        for j in 0..n {
            for i in 0..n {
                let a = first + j * (n + 1) + i;
                let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
                indices.extend([[a, b, c], [a, c, d]].into_iter().filter(|t| {
                    let [p, q, r] = t.map(|i: u32| positions[i as usize]);
                    p != q && q != r && r != p
                }));
            }
        }
    }
    TriangleMesh {
        positions: positions.into(),
        indices: indices.into(),
        normals,
        uvs,
        ..TriangleMesh::default()
    }
}

/// The control points of Martin Newell's teapot (1975): 32 patches, with its bottom, y up, the spout towards +x, standing
/// on y = 0, 3.15 high.
///
/// The numbers are those of the original data set, which is in the public domain.
pub fn teapot() -> Vec<Patch> {
    let mut lines = include_str!("teapot.txt").lines().filter(|l| !l.starts_with('#') && !l.is_empty());
    let rows: Vec<Vec<f32>> =
        lines.by_ref().map(|l| l.split_whitespace().filter_map(|w| w.parse().ok()).collect()).collect();
    // The file's z is up; a turn about x keeps the hand.
    let points: Vec<Vec3> =
        rows.iter().filter(|r| r.len() == 3).map(|r| Vec3::new(r[0], r[2], -r[1])).collect();
    rows.iter()
        .filter(|r| r.len() == 16)
        .map(|r| std::array::from_fn(|k| points.get(r[k] as usize).copied().unwrap_or(Vec3::ZERO)))
        .collect()
}

/// A parameter with both its weights, each rounded by itself, so that i of n seen from one end is bit for bit n - i
/// of n seen from the other.
#[derive(Clone, Copy)]
struct Weight {
    /// The weight of the far end: the parameter.
    t: f64,
    /// The weight of the near end.
    s: f64,
}

impl Weight {
    fn new(i: u32, n: u32) -> Self {
        let n = f64::from(n);
        let i = f64::from(i);
        Self { t: i / n, s: (n - i) / n }
    }

    /// The sum's order doesn't matter to its bits, and at either end it is that end exactly.
    fn between(self, a: DVec3, b: DVec3) -> DVec3 {
        a * self.s + b * self.t
    }
}

struct Evaluated {
    p: DVec3,
    du: DVec3,
    dv: DVec3,
}

/// De Casteljau's construction along u in every row, then along v.
fn evaluate(c: &[DVec3; 16], u: Weight, v: Weight) -> Evaluated {
    let rows: [(DVec3, DVec3); 4] =
        std::array::from_fn(|j| curve([c[4 * j], c[4 * j + 1], c[4 * j + 2], c[4 * j + 3]], u));
    let (p, dv) = curve(rows.map(|r| r.0), v);
    let (du, _) = curve(rows.map(|r| r.1), v);
    Evaluated { p, du, dv }
}

/// A cubic's point and derivative.
fn curve([a, b, c, d]: [DVec3; 4], w: Weight) -> (DVec3, DVec3) {
    let (ab, bc, cd) = (w.between(a, b), w.between(b, c), w.between(c, d));
    let (abc, bcd) = (w.between(ab, bc), w.between(bc, cd));
    (w.between(abc, bcd), (bcd - abc) * 3.0)
}

/// The unit normal. Where the tangents vanish or are parallel, that of a point a little further inside, in steps of
/// 1/4096 of the patch.
fn normal(c: &[DVec3; 16], u: Weight, v: Weight) -> Vec3 {
    let inwards = |w: Weight, step: u32| {
        let k = f64::from(step) / 4096.0;
        let t = w.t + (0.5 - w.t) * k;
        Weight { t, s: 1.0 - t }
    };
    for step in [0, 1, 4, 16, 64, 256] {
        let e = evaluate(c, inwards(u, step), inwards(v, step));
        let n = e.du.cross(e.dv);
        // A collapsed edge leaves rounding errors, some 1e-16, for a tangent.
        if n.length() > 1e-9 * (e.du.length_squared() + e.dv.length_squared())
            && let Some(n) = n.try_normalize()
        {
            return n.as_vec3();
        }
    }
    Vec3::Y
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn bits(p: Vec3) -> [u32; 3] {
        // + 0 makes one zero of two.
        p.to_array().map(|x| (x + 0.0).to_bits())
    }

    /// The control points of a patch's four borders.
    fn borders(p: &Patch) -> [[Vec3; 4]; 4] {
        [[0, 1, 2, 3], [12, 13, 14, 15], [0, 4, 8, 12], [3, 7, 11, 15]].map(|i| i.map(|i: usize| p[i]))
    }

    #[test]
    fn the_teapot_has_its_published_shape() {
        let patches = teapot();
        assert_eq!(patches.len(), 32);
        let all = straal_math::Bounds::of_points(patches.iter().flatten().copied());
        assert_eq!((all.min, all.max), (Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.525, 3.15, 2.0)));
    }

    #[test]
    fn patches_that_share_a_border_share_its_vertices() {
        let patches = teapot();
        // From 2 on: straight edges in place of two curves with the same ends would count as shared.
        for n in [2, 3, 7, 10] {
            let mesh = tessellate(&patches, n);
            // How many triangles have each edge, by position.
            let mut edges: BTreeMap<[[u32; 3]; 2], u32> = BTreeMap::new();
            for i in 0..mesh.indices.len() as u32 {
                let c = mesh.corners(i).map(bits);
                for k in 0..3 {
                    let (a, b) = (c[k], c[(k + 1) % 3]);
                    *edges.entry(if a < b { [a, b] } else { [b, a] }).or_default() += 1;
                }
            }
            // The borders that only one patch has, either way round, and not collapsed, are all that is open.
            let mut curves: BTreeMap<[[u32; 3]; 4], u32> = BTreeMap::new();
            for border in patches.iter().flat_map(borders) {
                let there = border.map(bits);
                let mut back = there;
                back.reverse();
                if there.iter().any(|p| *p != there[0]) {
                    *curves.entry(if there < back { there } else { back }).or_default() += 1;
                }
            }
            let open = curves.values().filter(|&&c| c == 1).count() as u32;
            let single = edges.values().filter(|&&c| c == 1).count() as u32;
            assert_eq!(single, open * n, "n {n}");
            assert!(edges.values().all(|&c| c <= 2), "n {n}");
            assert!(open < 40, "{open}");
        }
    }

    #[test]
    fn normals_are_finite_smooth_and_outside() {
        let mesh = tessellate(&teapot(), 8);
        assert!(mesh.is_whole());
        for i in 0..mesh.indices.len() as u32 {
            let s = mesh.surface(i, 1.0 / 3.0, 1.0 / 3.0);
            assert!(mesh.triangle_area(i) > 0.0);
            assert!(s.n.dot(s.ng) > 0.5, "triangle {i}: {s:?}");
        }
        for n in &mesh.normals {
            assert!((n.length() - 1.0).abs() < 1e-6);
        }
        // Body, lid and bottom are a surface of revolution: their normals point away from the axis' inside.
        for (patch, vertices) in mesh.positions.chunks_exact(81).enumerate() {
            let normals = &mesh.normals[patch * 81..][..81];
            let middle = vertices.iter().fold(Vec3::ZERO, |a, &p| a + p) * (1.0 / 81.0);
            let n = normals.iter().fold(Vec3::ZERO, |a, &p| a + p).normalize();
            match patch {
                4..=11 => assert!(n.dot(Vec3::new(middle.x, 0.0, middle.z).normalize()) > 0.5, "{patch}"),
                0..=3 | 24..=27 => assert!(n.y > 0.5, "{patch}"),
                28..=31 => assert!(n.y < -0.5, "{patch}"),
                _ => {}
            }
        }
    }

    #[test]
    fn a_flat_patch_is_a_plane() {
        let patch: Patch = std::array::from_fn(|i| Vec3::new((i % 4) as f32, (i / 4) as f32, 0.0));
        let mesh = tessellate(&[patch], 3);
        assert_eq!((mesh.positions.len(), mesh.indices.len()), (16, 18));
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            assert_eq!((p.z, *n), (0.0, Vec3::Z));
        }
        assert_eq!(mesh.positions[5], Vec3::new(1.0, 1.0, 0.0));
        let point: Patch = [Vec3::ONE; 16];
        let none = tessellate(&[point], 0);
        assert!(none.indices.is_empty() && none.normals.iter().all(|n| n.is_finite()));
    }
}
