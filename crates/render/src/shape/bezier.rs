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
    TriangleMesh { positions: positions.into(), indices: indices.into(), normals, uvs, flip: false }
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
        if n.length() > 1e-9 * (e.du.length_squared() + e.dv.length_squared()) {
            if let Some(n) = n.try_normalize() {
                return n.as_vec3();
            }
        }
    }
    Vec3::Y
}
