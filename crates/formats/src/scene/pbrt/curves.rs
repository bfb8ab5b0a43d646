//! Curves, as thin tubes and ribbons of triangles. Those that follow one another with the same material become one mesh: hair is
//! thousands of them.

use straal_math::{Affine, DVec3, ops};
use straal_scene::desc::MaterialRef;
use straal_scene::{Mesh, Span};

use super::Reader;
use super::params::{Params, Type};

/// Pieces of a segment.
const PIECES: usize = 8;

/// Corners around a tube, and around one that stands for a flat curve, which turns towards who looks at it.
const SIDES: [usize; 2] = [8, 4];

/// Curves that become one mesh.
pub(super) struct Gathered {
    mesh: Mesh,
    map: Affine,
    material: Option<MaterialRef>,
    span: Span,
}

/// How a curve is as wide as it is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    Flat,
    Round,
    Ribbon,
}

/// A cubic Bezier curve.
type Cubic = [DVec3; 4];

impl Reader<'_, '_> {
    /// What was gathered is a mesh.
    pub(super) fn end_of_curves(&mut self) {
        if let Some(Gathered { mesh, map, material, span }) = self.curves.take() {
            self.made_mesh(mesh, (&map, material), span);
        }
    }

    pub(super) fn curve(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let span = params.span;
        let degree = params.integer("degree", 3);
        let is_spline = match params.string("basis").map_or("bezier", |b| b.as_str()) {
            "bezier" => false,
            "bspline" => true,
            _ => return self.error(span, "the `basis` of a curve must be `bezier` or `bspline`"),
        };
        if degree != 2 && degree != 3 {
            return self.error(span, "the `degree` of a curve must be 2 or 3");
        }
        let form = match params.string("type").map_or("flat", |t| t.as_str()) {
            "flat" => Form::Flat,
            "ribbon" => Form::Ribbon,
            "cylinder" => Form::Round,
            _ => return self.error(span, "the `type` of a curve must be `flat`, `ribbon` or `cylinder`"),
        };
        params.pass_over(&["splitdepth"]);
        let points = |list: Option<(&[f32], Span)>| -> Vec<DVec3> {
            let numbers = list.map_or(&[][..], |(numbers, _)| numbers);
            numbers.chunks_exact(3).map(|c| DVec3::new(c[0].into(), c[1].into(), c[2].into())).collect()
        };
        let p = points(params.singles("P", &[Type::Point3, Type::Vector3]));
        let normals = points(params.singles("N", &[Type::Normal, Type::Vector3]));
        let Some(segments) = segments(&p, degree as usize, is_spline) else {
            let message = format!("{} points are no curve of this degree and basis", p.len());
            return self.error(span, message);
        };
        let width = params.float("width", 1.0);
        let [first, last] = ["width0", "width1"].map(|name| params.float(name, width));
        if form == Form::Ribbon && normals.len() != segments.len() + 1 {
            let message =
                format!("a ribbon of {} segments needs {} normals", segments.len(), segments.len() + 1);
            return self.error(span, message);
        }
        if form == Form::Flat {
            self.warn_once(span, "flat curves, which turn towards who looks at them, become tubes");
        }
        let mut one = Mesh::default();
        tessellate(&segments, [first, last], (form, &normals), &mut one);
        let fits = |g: &Gathered| g.map == *map && g.material == material && g.mesh.positions.len() < 1 << 24;
        if !self.curves.as_ref().is_some_and(fits) || self.state.area_light.is_some() {
            self.end_of_curves();
        }
        match &mut self.curves {
            Some(all) => {
                let offset = all.mesh.positions.len() as u32;
                all.mesh.positions.append(&mut one.positions);
                all.mesh.normals.append(&mut one.normals);
                all.mesh.uvs.append(&mut one.uvs);
                all.mesh.triangles.extend(one.triangles.iter().map(|t| t.map(|i| i + offset)));
            }
            None => self.curves = Some(Gathered { mesh: one, map: *map, material, span }),
        }
    }
}

/// The Bezier curves of a list of control points.
fn segments(p: &[DVec3], degree: usize, is_spline: bool) -> Option<Vec<Cubic>> {
    let raised = |a: DVec3, b: DVec3, c: DVec3| [a, a + (b - a) * (2.0 / 3.0), c + (b - c) * (2.0 / 3.0), c];
    if p.len() < degree + 1 || !is_spline && (p.len() - 1) % degree != 0 {
        return None;
    }
    let starts: Vec<usize> = if is_spline {
        (0..p.len() - degree).collect()
    } else {
        (0..(p.len() - 1) / degree).map(|i| i * degree).collect()
    };
    let middle = |a: DVec3, b: DVec3| (a + b) * 0.5;
    let of = |i: &usize| match (degree, &p[*i..]) {
        (2, [a, b, c, ..]) if is_spline => raised(middle(*a, *b), *b, middle(*b, *c)),
        (2, [a, b, c, ..]) => raised(*a, *b, *c),
        (_, [a, b, c, d, ..]) if is_spline => [
            (*a + *b * 4.0 + *c) * (1.0 / 6.0),
            (*b * 2.0 + *c) * (1.0 / 3.0),
            (*b + *c * 2.0) * (1.0 / 3.0),
            (*b + *c * 4.0 + *d) * (1.0 / 6.0),
        ],
        (_, [a, b, c, d, ..]) => [*a, *b, *c, *d],
        _ => [DVec3::ZERO; 4],
    };
    Some(starts.iter().map(of).collect())
}

/// Place and direction on a cubic.
fn on(c: &Cubic, t: f64) -> (DVec3, DVec3) {
    let s = 1.0 - t;
    let p = c[0] * (s * s * s) + c[1] * (3.0 * s * s * t) + c[2] * (3.0 * s * t * t) + c[3] * (t * t * t);
    let d = (c[1] - c[0]) * (s * s) + (c[2] - c[1]) * (2.0 * s * t) + (c[3] - c[2]) * (t * t);
    (p, d)
}

/// Adds a curve, whose width goes from one to the other, to a mesh.
fn tessellate(segments: &[Cubic], [from, to]: [f64; 2], (form, normals): (Form, &[DVec3]), mesh: &mut Mesh) {
    let rows = segments.len() * PIECES;
    let sides = match form {
        Form::Round => SIDES[0],
        Form::Flat => SIDES[1],
        Form::Ribbon => 1,
    };
    let mut side: Option<DVec3> = None;
    let mut along = DVec3::Z;
    for row in 0..=rows {
        let segment = (row / PIECES).min(segments.len() - 1);
        let t = (row - segment * PIECES) as f64 / PIECES as f64;
        let (p, d) = on(&segments[segment], t);
        along = d.try_normalize().unwrap_or(along);
        let v = row as f64 / rows as f64;
        let half = 0.5 * (from + (to - from) * v);
        if form == Form::Ribbon {
            let n = normals[segment] + (normals[segment + 1] - normals[segment]) * t;
            let n = n.try_normalize().unwrap_or(DVec3::Z);
            let across = along.cross(n).try_normalize().or(side).unwrap_or(DVec3::X);
            side = Some(across);
            for (u, sign) in [(0.0, -1.0), (1.0, 1.0)] {
                add(mesh, p + across * (half * sign), n, [u, v]);
            }
            continue;
        }
        // Carried along without turning about the curve.
        let last = side.unwrap_or(if along.x.abs() < 0.9 { DVec3::X } else { DVec3::Y });
        let x = (last - along * along.dot(last)).try_normalize().unwrap_or(last);
        side = Some(x);
        let y = along.cross(x);
        for i in 0..=sides {
            let u = i as f64 / sides as f64;
            let (sin, cos) = ops::sin_cos_degrees(360.0 * u);
            let n = x * cos + y * sin;
            add(mesh, p + n * half, n, [u, v]);
        }
    }
    let width = sides as u32 + 1;
    for row in 0..rows as u32 {
        for i in 0..sides as u32 {
            let a = row * width + i;
            mesh.triangles.extend([[a, a + 1, a + width + 1], [a, a + width + 1, a + width]]);
        }
    }
}

fn add(mesh: &mut Mesh, p: DVec3, n: DVec3, uv: [f64; 2]) {
    mesh.positions.push(p.as_vec3().to_array());
    mesh.normals.push(n.as_vec3().to_array());
    mesh.uvs.push(uv.map(|v| v as f32));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(n: usize) -> Vec<DVec3> {
        (0..n).map(|i| DVec3::new(0.0, 0.0, i as f64)).collect()
    }

    #[test]
    fn segments_by_degree_and_basis() {
        for (points, degree, is_spline, want) in [
            (4, 3, false, Some(1)),
            (7, 3, false, Some(2)),
            (5, 3, false, None),
            (5, 2, false, Some(2)),
            (6, 3, true, Some(3)),
            (3, 2, true, Some(1)),
            (2, 2, true, None),
            (0, 3, false, None),
        ] {
            let found = segments(&line(points), degree, is_spline);
            assert_eq!(found.map(|s| s.len()), want, "{points} {degree} {is_spline}");
        }
        // A straight line stays one, whatever its basis.
        let spline = segments(&line(4), 3, true).unwrap();
        assert!((on(&spline[0], 0.5).0.z - 1.5).abs() < 1e-12);
        let square = segments(&line(3), 2, false).unwrap();
        assert!((on(&square[0], 0.25).0.z - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_tube_faces_outwards() {
        let mut mesh = Mesh::default();
        tessellate(&segments(&line(4), 3, false).unwrap(), [0.2, 0.2], (Form::Round, &[]), &mut mesh);
        assert!(mesh.is_whole());
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| DVec3::from_array(mesh.positions[i as usize].map(f64::from)));
            let n = DVec3::from_array(mesh.normals[t[0] as usize].map(f64::from));
            assert!((b - a).cross(c - a).dot(n) > 0.0);
        }
    }
}
