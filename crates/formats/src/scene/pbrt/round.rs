//! Parts of round shapes, as triangles: a grid over the angle and over what goes along the axis or from rim to rim.

use straal_math::{DVec3, ops};
use straal_scene::Mesh;

use super::shapes::Cut;

/// Squares once around.
const AROUND: usize = 128;

/// Squares from pole to pole.
const ALONG: usize = 64;

/// A place on a shape and the normal there.
type Place = (DVec3, DVec3);

/// Of a sphere, what lies between two heights and within an angle.
pub(super) fn sphere(cut: &Cut) -> Mesh {
    let Cut { radius, z: [low, high], phi } = *cut;
    // Angles from the lower pole.
    let angle = |z: f64| ops::atan2_d((radius * radius - z * z).sqrt(), -z).to_degrees();
    let [from, to] = [angle(low), angle(high)];
    let rows = ((ALONG as f64) * (to - from) / 180.0).ceil() as usize;
    grid([columns(phi), rows.max(2)], |u, v| {
        let (sin, cos) = ops::sin_cos_degrees(u * phi);
        let (out, down) = ops::sin_cos_degrees(from + (to - from) * v);
        let n = DVec3::new(out * cos, out * sin, -down);
        (n * radius, n)
    })
}

/// Of a cylinder's wall, what lies between two heights and within an angle.
pub(super) fn tube(cut: &Cut) -> Mesh {
    let Cut { radius, z: [low, high], phi } = *cut;
    grid([columns(phi), 1], |u, v| {
        let (sin, cos) = ops::sin_cos_degrees(u * phi);
        (DVec3::new(radius * cos, radius * sin, low + (high - low) * v), DVec3::new(cos, sin, 0.0))
    })
}

/// Of a disc, what lies between two radii and within an angle; v goes from the outer rim inwards.
pub(super) fn ring([inner, outer]: [f64; 2], height: f64, phi: f64) -> Mesh {
    grid([columns(phi), 1], |u, v| {
        let (sin, cos) = ops::sin_cos_degrees(u * phi);
        let r = outer + (inner - outer) * v;
        (DVec3::new(r * cos, r * sin, height), DVec3::Z)
    })
}

fn columns(phi: f64) -> usize {
    let part = (AROUND as f64 * phi / 360.0).ceil() as usize;
    part.clamp(3, AROUND)
}

/// Squares over the unit square of u and v; the front is where the change with u and then that with v turn counter-clockwise.
fn grid([across, up]: [usize; 2], at: impl Fn(f64, f64) -> Place) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=up {
        for i in 0..=across {
            let (u, v) = (i as f64 / across as f64, j as f64 / up as f64);
            let (p, n) = at(u, v);
            mesh.positions.push(p.as_vec3().to_array());
            mesh.normals.push(n.as_vec3().to_array());
            mesh.uvs.push([u as f32, v as f32]);
        }
    }
    let index = |i: usize, j: usize| (j * (across + 1) + i) as u32;
    for j in 0..up {
        for i in 0..across {
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            // At poles and in the middle of a disc one side of a square is a point.
            for triangle in [[a, b, c], [a, c, d]] {
                let [p, q, r] = triangle.map(|i| mesh.positions[i as usize]);
                if p != q && q != r && r != p {
                    mesh.triangles.push(triangle);
                }
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The area, and whether all triangles face as their normals do.
    fn looked_at(mesh: &Mesh) -> (f64, bool) {
        let (mut area, mut agrees) = (0.0, true);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| DVec3::from_array(mesh.positions[i as usize].map(f64::from)));
            let n = DVec3::from_array(mesh.normals[t[0] as usize].map(f64::from));
            let cross = (b - a).cross(c - a);
            area += 0.5 * cross.length();
            agrees &= cross.dot(n) > 0.0;
        }
        (area, agrees)
    }

    #[test]
    fn parts_have_their_areas_and_face_outwards() {
        let pi = std::f64::consts::PI;
        let half = Cut { radius: 2.0, z: [0.0, 2.0], phi: 180.0 };
        let parts = [
            // A zone of a sphere: 2 pi r h, of which there is half.
            (sphere(&half), pi * 2.0 * 2.0),
            (tube(&half), pi * 2.0 * 2.0),
            (ring([1.0, 2.0], 0.5, 90.0), 0.25 * pi * 3.0),
        ];
        for (mesh, want) in parts {
            let (area, agrees) = looked_at(&mesh);
            assert!(agrees && (area / want - 1.0).abs() < 2e-3, "{area} for {want}");
            assert!(mesh.is_whole());
        }
    }
}
