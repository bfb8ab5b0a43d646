//! Curves. Those that follow one another with the same material become one node: hair is thousands of them.

use straal_math::{Affine, DVec3};
use straal_scene::Span;
use straal_scene::desc::{self, CurveBasis, CurveForm, Curves, MaterialRef, Node};

use super::Reader;
use super::params::{Params, Type};
use super::state::as_transform;

/// Curves that become one node.
pub(super) struct Gathered {
    points: Vec<DVec3>,
    starts: Vec<u32>,
    radii: Vec<f64>,
    normals: Vec<DVec3>,
    form: CurveForm,
    map: Affine,
    material: Option<MaterialRef>,
    flip: bool,
    span: Span,
}

/// A cubic Bezier curve.
type Cubic = [DVec3; 4];

/// Most points of a node.
const MOST: usize = 1 << 28;

impl Reader<'_, '_> {
    /// What was gathered is a node.
    pub(super) fn end_of_curves(&mut self) {
        let Some(all) = self.curves.take() else { return };
        let Gathered { points, starts, radii, normals, form, map, material, flip, span } = all;
        if radii.iter().all(|r| *r <= 0.0) {
            return self.warn(span, "this curve is left out: it has no width");
        }
        let surface =
            desc::Surface { material, transform: as_transform(&map, span), flip, ..desc::Surface::default() };
        let basis = CurveBasis::Bezier;
        self.push(Node::Curves(Curves { points, starts, basis, radii, form, normals, surface }));
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
            "flat" => CurveForm::Flat,
            "ribbon" => CurveForm::Ribbon,
            "cylinder" => CurveForm::Round,
            _ => return self.error(span, "the `type` of a curve must be `flat`, `ribbon` or `cylinder`"),
        };
        params.pass_over(&["splitdepth"]);
        let points = |list: Option<(&[f32], Span)>| -> Vec<DVec3> {
            let numbers = list.map_or(&[][..], |(numbers, _)| numbers);
            numbers.chunks_exact(3).map(|c| DVec3::new(c[0].into(), c[1].into(), c[2].into())).collect()
        };
        let p = points(params.singles("P", &[Type::Point3, Type::Vector3]));
        let mut normals = points(params.singles("N", &[Type::Normal, Type::Vector3]));
        if p.iter().chain(&normals).any(|p| !p.to_array().iter().all(|v| v.is_finite())) {
            return self.error(span, "a point of this curve is not finite");
        }
        let Some(points) = bezier(&p, degree as usize, is_spline) else {
            let message = format!("{} points are no curve of this degree and basis", p.len());
            return self.error(span, message);
        };
        let pieces = (points.len() - 1) / 3;
        if form != CurveForm::Ribbon {
            normals.clear();
        } else if normals.len() != pieces + 1 || normals.contains(&DVec3::ZERO) {
            let message =
                format!("a ribbon of {pieces} pieces needs {} normals with a direction", pieces + 1);
            return self.error(span, message);
        }
        let width = params.float("width", 1.0);
        let [first, last] = ["width0", "width1"].map(|name| params.float(name, width));
        let last_point = (points.len() - 1) as f64;
        let radius = |i: usize| {
            let width = first + (last - first) * i as f64 / last_point;
            if width > 0.0 { 0.5 * width } else { 0.0 }
        };
        let radii = (0..points.len()).map(radius);
        if self.state.area_light.is_some() {
            self.warn_once(span, "curves can't shine yet: their light is left out");
        }
        let flip = self.state.reversed;
        let fits = |g: &Gathered| {
            g.map == *map
                && g.material == material
                && (&g.form, g.flip) == (&form, flip)
                && g.points.len() < MOST
        };
        if !self.curves.as_ref().is_some_and(fits) {
            self.end_of_curves();
        }
        match &mut self.curves {
            Some(all) => {
                all.starts.push(all.points.len() as u32);
                all.radii.extend(radii);
                all.points.extend(points);
                all.normals.extend(normals);
            }
            None => {
                let (map, radii) = (*map, radii.collect());
                let starts = vec![0];
                self.curves =
                    Some(Gathered { points, starts, radii, normals, form, map, material, flip, span });
            }
        }
    }
}

/// The control points of cubic Bezier pieces, each of which begins where the one before ends.
fn bezier(p: &[DVec3], degree: usize, is_spline: bool) -> Option<Vec<DVec3>> {
    if p.len() < degree + 1 || !is_spline && (p.len() - 1) % degree != 0 {
        return None;
    }
    let pieces = if is_spline { p.len() - degree } else { (p.len() - 1) / degree };
    let step = if is_spline { 1 } else { degree };
    let mut points = Vec::with_capacity(3 * pieces + 1);
    for i in 0..pieces {
        let [a, b, c, d] = piece(p.get(i * step..)?, degree, is_spline)?;
        if points.is_empty() {
            points.push(a);
        }
        points.extend([b, c, d]);
    }
    Some(points)
}

/// The first piece of a curve through some points.
fn piece(p: &[DVec3], degree: usize, is_spline: bool) -> Option<Cubic> {
    let raised = |a: DVec3, b: DVec3, c: DVec3| [a, a + (b - a) * (2.0 / 3.0), c + (b - c) * (2.0 / 3.0), c];
    let middle = |a: DVec3, b: DVec3| (a + b) * 0.5;
    Some(match (degree, p) {
        (2, [a, b, c, ..]) if is_spline => raised(middle(*a, *b), *b, middle(*b, *c)),
        (2, [a, b, c, ..]) => raised(*a, *b, *c),
        (3, [a, b, c, d, ..]) if is_spline => [
            (*a + *b * 4.0 + *c) * (1.0 / 6.0),
            (*b * 2.0 + *c) * (1.0 / 3.0),
            (*b + *c * 2.0) * (1.0 / 3.0),
            (*b + *c * 4.0 + *d) * (1.0 / 6.0),
        ],
        (3, [a, b, c, d, ..]) => [*a, *b, *c, *d],
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_by_degree_and_basis() {
        let line = |n: usize| (0..n).map(|i| DVec3::new(0.0, 0.0, i as f64)).collect::<Vec<_>>();
        for (points, degree, is_spline, want) in [
            (4, 3, false, Some(4)),
            (7, 3, false, Some(7)),
            (5, 3, false, None),
            (5, 2, false, Some(7)),
            (6, 3, true, Some(10)),
            (3, 2, true, Some(4)),
            (2, 2, true, None),
            (0, 3, false, None),
        ] {
            let found = bezier(&line(points), degree, is_spline);
            assert_eq!(found.as_ref().map(Vec::len), want, "{points} {degree} {is_spline}");
            // Control points of a straight line that is run along evenly are evenly apart.
            for pair in found.unwrap_or_default().windows(2) {
                let step =
                    [1.0, 2.0 / 3.0, 1.0 / 3.0].iter().any(|s| (pair[1].z - pair[0].z - s).abs() < 1e-12);
                assert!(step, "{pair:?}");
            }
        }
    }
}
