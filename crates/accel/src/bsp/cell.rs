//! A convex part of space with flat faces: what cuts by planes leave of a box. Only its surface is asked for.

use super::plane::Plane;
use crate::section::{self, Slice};
use straal_math::{Bounds, DVec3};

/// A convex polyhedron.
pub(crate) struct Cell {
    faces: Vec<Face>,
}

/// A convex polygon by its edges, at least one, in no order, since its area needs none.
struct Face {
    edges: Vec<[DVec3; 2]>,
    area: f64,
}

impl Face {
    fn of(edges: Vec<[DVec3; 2]>) -> Self {
        let area = area(&edges);
        Self { edges, area }
    }
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
            Face::of((0..4).map(|i| [corners[ring[i]], corners[ring[(i + 1) % 4]]]).collect())
        };
        Self { faces: (0..6).map(|i| face(i / 2, i % 2)).collect() }
    }

    /// The surface.
    pub fn area(&self) -> f64 {
        self.faces.iter().map(|face| face.area).sum()
    }

    /// The surfaces of the two parts of [`Self::cut`], without making them. What lies in the plane counts as in front.
    pub fn areas(&self, plane: &Plane) -> [f64; 2] {
        let mut out = [0.0; 2];
        // A corner of the new face, about which it is made of triangles, one for each edge.
        let mut corner = None;
        let mut lid = 0.0;
        for face in &self.faces {
            let edges = face.edges.iter().map(|&[a, b]| Split { a, b, at: plane.crossing(a, b) });
            let Some(first) = edges.clone().find_map(|e| e.at) else {
                let front = plane.distance(face.edges[0][0]) >= 0.0;
                out[usize::from(!front)] += face.area;
                continue;
            };
            let corner = *corner.get_or_insert(first);
            let second = edges.clone().rev().find_map(|e| e.at).unwrap_or(first);
            lid += triangle(corner, first, second);
            for e in edges {
                let front = plane.distance(e.a) >= 0.0;
                let at = e.at.unwrap_or(e.b);
                out[usize::from(!front)] += triangle(first, e.a, at);
                // Nothing where the edge isn't cut.
                out[usize::from(front)] += triangle(first, at, e.b);
            }
        }
        out.map(|area| area + lid)
    }

    /// The parts in front of a plane and behind it. Either may have no face, if the plane misses the cell.
    pub fn cut(&self, plane: &Plane) -> [Self; 2] {
        [1.0, -1.0].map(|sign| {
            let mut faces = Vec::with_capacity(self.faces.len() + 1);
            // The new face has an edge where the plane crosses an old one.
            let mut lid = Vec::new();
            for face in &self.faces {
                let (mut kept, mut crossings) = (Vec::with_capacity(face.edges.len() + 1), Vec::new());
                for &[a, b] in &face.edges {
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
                faces.push(Face::of(kept));
            }
            if !lid.is_empty() && !faces.is_empty() {
                faces.push(Face::of(lid));
            }
            Self { faces }
        })
    }
}

impl Slice for Cell {
    fn slice(&self, z: f64) -> Vec<[f64; 2]> {
        section::ring(self.faces.iter().flat_map(|face| &face.edges), z)
    }
}

/// An edge, and where a plane cuts it.
struct Split {
    a: DVec3,
    b: DVec3,
    at: Option<DVec3>,
}

impl Plane {
    /// Where the plane passes between two points.
    fn crossing(&self, a: DVec3, b: DVec3) -> Option<DVec3> {
        let (fa, fb) = (self.distance(a), self.distance(b));
        ((fa >= 0.0) != (fb >= 0.0)).then(|| a + (b - a) * (fa / (fa - fb)))
    }
}

/// The area of a triangle.
fn triangle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b - a).cross(c - a).length() * 0.5
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
    edges.iter().map(|&[a, b]| triangle(middle, a, b)).sum()
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
    fn areas_are_those_of_the_parts() {
        let mut cell =
            Cell::of_box(&Bounds { min: Vec3::new(-1.0, 0.0, 2.0), max: Vec3::new(2.0, 1.0, 4.0) });
        for (normal, offset) in [
            (DVec3::new(1.0, 2.0, 3.0), 9.5),
            (DVec3::new(-1.0, 2.0, 0.5), 1.9),
            (DVec3::new(0.3, -1.0, 1.0), 2.4),
            (DVec3::new(0.0, 1.0, 0.0), 0.3),
            (DVec3::new(1.0, 0.0, 0.0), 100.0),
        ] {
            let normal = normal.try_normalize().unwrap();
            let plane = Plane { normal, offset };
            let parts = cell.cut(&plane);
            let [front, back] = cell.areas(&plane);
            close(front, parts[0].area());
            close(back, parts[1].area());
            let [front, back] = parts;
            cell = if front.area() > back.area() { front } else { back };
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
