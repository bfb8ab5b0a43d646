//! A convex part of space with flat faces: what cuts by planes leave of a box. Only its surface is asked for.

use super::plane::Plane;
use straal_math::{Bounds, DVec3};

/// A convex polyhedron. Each face is a set of edges, in no order, since the area of a convex polygon needs none.
pub(crate) struct Cell {
    faces: Vec<Vec<[DVec3; 2]>>,
}

impl Cell {
    pub fn of_box(b: &Bounds) -> Self {
        if b.is_empty() {
            return Self { faces: Vec::new() };
        }
        let corners = b.corners().map(|p| p.as_dvec3());
        let face = |axis: usize, upper: usize| {
            let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            let first = upper << axis;
            let ring = [first, first | u, first | u | v, first | v];
            (0..4).map(|i| [corners[ring[i]], corners[ring[(i + 1) % 4]]]).collect()
        };
        Self { faces: (0..6).map(|i| face(i / 2, i % 2)).collect() }
    }

    /// The surface.
    pub fn area(&self) -> f64 {
        self.faces.iter().map(|face| area(face)).sum()
    }

    /// The parts in front of a plane and behind it. Either may have no face, if the plane misses the cell.
    pub fn cut(&self, plane: &Plane) -> [Self; 2] {
        [1.0, -1.0].map(|sign| {
            let mut faces = Vec::with_capacity(self.faces.len() + 1);
            // The new face has an edge where the plane crosses an old one.
            let mut lid = Vec::new();
            for face in &self.faces {
                let (mut kept, mut crossings) = (Vec::with_capacity(face.len() + 1), Vec::new());
                for &[a, b] in face {
                    let (fa, fb) = (plane.distance(a) * sign, plane.distance(b) * sign);
                    if fa * fb < 0.0 {
                        let at = a + (b - a) * (fa / (fa - fb));
                        kept.push(if fa > 0.0 { [a, at] } else { [at, b] });
                        crossings.push(at);
                    } else if fa > 0.0 || fb > 0.0 {
                        kept.push([a, b]);
                    }
                    // Edges in the plane itself come back as the edge between their ends.
                    crossings.extend([(a, fa), (b, fb)].into_iter().filter(|x| x.1 == 0.0).map(|x| x.0));
                }
                if kept.is_empty() {
                    continue;
                }
                if let Some(edge) = farthest(&crossings) {
                    lid.push(edge);
                    kept.push(edge);
                }
                faces.push(kept);
            }
            if !lid.is_empty() && !faces.is_empty() {
                faces.push(lid);
            }
            Self { faces }
        })
    }
}

/// The two of a few points on a line that are farthest apart; `None` when they are all the same.
fn farthest(points: &[DVec3]) -> Option<[DVec3; 2]> {
    let mut best = None;
    let mut most = 0.0;
    for (i, &a) in points.iter().enumerate() {
        for &b in &points[i + 1..] {
            let d = (b - a).length_squared();
            if d > most {
                (best, most) = (Some([a, b]), d);
            }
        }
    }
    best
}

/// The area of a convex polygon by its edges: triangles to a point inside.
fn area(edges: &[[DVec3; 2]]) -> f64 {
    let sum = edges.iter().fold(DVec3::ZERO, |sum, &[a, b]| sum + a + b);
    let middle = sum * (0.5 / edges.len() as f64);
    edges.iter().map(|&[a, b]| (a - middle).cross(b - middle).length() * 0.5).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::Vec3;

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12, "{a} should be {b}");
    }

    /// The plane through three points.
    fn plane([a, b, c]: &[Vec3; 3]) -> Option<Plane> {
        let normal = (*b - *a).as_dvec3().cross((*c - *a).as_dvec3()).try_normalize()?;
        Some(Plane { normal, offset: normal.dot(a.as_dvec3()) })
    }

    #[test]
    fn a_cube_and_its_parts() {
        let cube = Cell::of_box(&Bounds { min: Vec3::ZERO, max: Vec3::ONE });
        close(cube.area(), 6.0);
        let [upper, lower] = cube.cut(&Plane::across(2, 0.25));
        close(upper.area(), 2.0 + 4.0 * 0.75);
        close(lower.area(), 2.0 + 4.0 * 0.25);
        // A corner: three half squares and a triangle of side sqrt 2.
        let [rest, corner] = cube.cut(&plane(&[Vec3::X, Vec3::Y, Vec3::Z]).unwrap());
        let lid = 3.0_f64.sqrt() / 2.0;
        close(corner.area(), 1.5 + lid);
        close(rest.area(), 4.5 + lid);
        // Through the diagonals of two faces.
        let diagonal = plane(&[Vec3::ZERO, Vec3::Z, Vec3::new(1.0, 1.0, 0.0)]).unwrap();
        for half in cube.cut(&diagonal) {
            close(half.area(), 3.0 + 2.0_f64.sqrt());
        }
    }

    #[test]
    fn a_plane_that_misses_leaves_all_on_one_side() {
        let cube = Cell::of_box(&Bounds { min: Vec3::ZERO, max: Vec3::ONE });
        let [upper, lower] = cube.cut(&Plane::across(0, 2.0));
        close(upper.area(), 0.0);
        close(lower.area(), 6.0);
    }
}
