//! Readers of triangle meshes.

mod attributes;
mod lines;
pub mod mtl;
pub mod obj;
pub mod ply;
pub(crate) mod polygon;
pub mod stl;

pub(crate) use lines::count;

/// What is said where vertices or faces have colours.
fn colours_left_out(of: &str) -> String {
    format!(
        "the colours of its {of} are left out, as nothing in the scene reads them: `reflectance: {{ texture: attribute }}` would"
    )
}

/// What is said of a mesh without triangles, of which so many faces were left out because a vertex isn't finite.
fn empty(odd_faces: u64) -> String {
    if odd_faces == 0 {
        return "the mesh is empty: it has no face with three corners".to_owned();
    }
    format!("the mesh is empty: {} left out, for a vertex is not finite", count(odd_faces, "face"))
}

/// The vector area of a polygon (Newell's method), as a normal of unit length.
fn flat_normal(points: &[[f32; 3]]) -> [f32; 3] {
    let mut normal = [0.0f64; 3];
    for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
        let [a, b] = [a, b].map(|p| p.map(f64::from));
        for (k, component) in normal.iter_mut().enumerate() {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            *component += (a[u] - b[u]) * (a[v] + b[v]);
        }
    }
    let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length > 0.0 { normal.map(|v| (v / length) as f32) } else { [0.0, 0.0, 1.0] }
}
