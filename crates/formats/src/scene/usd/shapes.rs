//! Shapes that are a formula, and curves.

use straal_math::DVec3;
use straal_scene::desc::{
    Capsule, Cone, Cuboid, CurveBasis, CurveForm, Curves, Cylinder, Node, Rectangle, Sphere,
};

use super::Translation;
use super::material::Has;
use super::world::Within;

impl Translation<'_, '_> {
    /// A shape, by its type.
    pub fn shape(&mut self, prim: usize, kind: &str, within: &Within) -> Vec<Node> {
        let number = |name: &str, otherwise: f64| self.stage.number(prim, name).unwrap_or(otherwise);
        let word = self.stage.text(prim, "axis");
        let axis = match word.as_deref() {
            Some("X") => DVec3::X,
            Some("Y") => DVec3::Y,
            _ => DVec3::Z,
        };
        let height = number("height", if kind.starts_with("Capsule") { 1.0 } else { 2.0 });
        let radius = number("radius", if kind.starts_with("Capsule") { 0.5 } else { 1.0 });
        let (bottom, top) = (number("radiusBottom", radius), number("radiusTop", radius));
        let (size, width, length) = (number("size", 2.0), number("width", 2.0), number("length", 2.0));
        let needed = match kind {
            "Cube" => size,
            "Plane" => width * length,
            "Sphere" => radius,
            "BasisCurves" => return self.curves(prim, within),
            "Cylinder_1" | "Capsule_1" => bottom,
            _ => radius,
        };
        if !(needed > 0.0 && (height > 0.0 || !matches!(kind, "Cylinder" | "Cylinder_1" | "Cone"))) {
            self.warn(prim, "it is left out: it has no size");
            return Vec::new();
        }
        let surface = self.surface(prim, within, &Has::default());
        let [from, to] = [axis * (-0.5 * height), axis * (0.5 * height)];
        let node = match kind {
            "Sphere" => Node::Sphere(Sphere { radius, surface, ..Sphere::default() }),
            "Cube" => {
                let max = DVec3::splat(0.5 * size);
                Node::Box(Cuboid { min: -max, max, surface })
            }
            "Cone" => Node::Cone(Cone { from, to, radius, caps: true, surface, ..Cone::default() }),
            "Cylinder_1" if top != bottom => {
                let top = if top > 0.0 { top } else { 0.0 };
                Node::Cone(Cone {
                    from,
                    to,
                    radius: bottom,
                    top_radius: top,
                    caps: true,
                    surface,
                    ..Cone::default()
                })
            }
            "Capsule" | "Capsule_1" if height > 0.0 => {
                let end_radius = (kind == "Capsule_1" && top != bottom && top > 0.0).then_some(top);
                let radius = if kind == "Capsule_1" { bottom } else { radius };
                Node::Capsule(Capsule { from, to, radius, end_radius, surface })
            }
            "Capsule" | "Capsule_1" => Node::Sphere(Sphere { radius: needed, surface, ..Sphere::default() }),
            "Plane" => {
                // Width lies along x, or along z where the axis is x; length along y, or along z where the axis is y.
                let (across, up) = match word.as_deref() {
                    Some("X") => (DVec3::Y * length, DVec3::Z * width),
                    Some("Y") => (DVec3::Z * length, DVec3::X * width),
                    _ => (DVec3::X * width, DVec3::Y * length),
                };
                let corner = (across + up) * -0.5;
                Node::Rectangle(Rectangle { corner, edges: [across, up], surface, ..Rectangle::default() })
            }
            _ => {
                let radius = if kind == "Cylinder_1" { bottom } else { radius };
                Node::Cylinder(Cylinder { from, to, radius, caps: true, surface, ..Cylinder::default() })
            }
        };
        vec![node]
    }

    /// Curves: straight ones, and cubic ones of three bases.
    fn curves(&mut self, prim: usize, within: &Within) -> Vec<Node> {
        let stage = &self.stage;
        let points = stage.numbers(prim, "points", 3).unwrap_or_default();
        let counts = stage.numbers(prim, "curveVertexCounts", 1).unwrap_or_default();
        let is_linear = stage.text(prim, "type").as_deref() == Some("linear");
        let basis = stage.text(prim, "basis").unwrap_or_else(|| "bezier".to_owned());
        let wrap = stage.text(prim, "wrap").unwrap_or_else(|| "nonperiodic".to_owned());
        let widths = stage.numbers(prim, "widths", 1).unwrap_or_default();
        let per_point = widths.len() == points.len() / 3 && widths.len() > 1;
        let per_curve = !per_point && widths.len() == counts.len();
        let default = if widths.is_empty() { 1.0 } else { widths[0] };
        let (is_pinned, is_closed) = (wrap == "pinned", wrap == "periodic");
        let is_bezier = basis != "bspline" && basis != "catmullRom";
        // Ends of pieces, and how many points further the next one is.
        let ends = |count: usize| match (is_linear, is_bezier) {
            (true, _) => count,
            (_, true) if is_closed => count / 3,
            (_, true) => count.saturating_sub(1) / 3 + 1,
            _ if is_closed || is_pinned => count,
            _ => count.saturating_sub(2),
        };
        let all_ends: usize =
            counts.iter().map(|count| ends(if *count > 0.0 { *count as usize } else { 0 })).sum();
        let per_end = !per_point && !per_curve && widths.len() == all_ends;
        let mut first_end = 0_usize;
        if widths.len() > 1 && !per_point && !per_curve && !per_end {
            self.warn(prim, "widths that aren't told for each point are those of the first");
        }
        let (mut all, mut radii, mut starts, mut lost) = (Vec::new(), Vec::new(), Vec::new(), 0);
        let kind = match (is_linear, basis.as_str()) {
            (true, _) => CurveBasis::Linear,
            (_, "bspline") => CurveBasis::BSpline,
            _ => CurveBasis::Bezier,
        };
        let mut next = 0_usize;
        for (curve, count) in counts.iter().enumerate() {
            let count = if *count > 0.0 { *count as usize } else { 0 };
            let range = next..next.saturating_add(count);
            next = range.end;
            let (own_ends, start) = (ends(count), first_end);
            first_end = first_end.saturating_add(own_ends);
            let width = |i: usize| {
                if per_curve {
                    return widths[curve];
                }
                if !per_end || own_ends == 0 {
                    return default;
                }
                let last = (own_ends - 1) as f64;
                let place = match (is_linear, is_bezier) {
                    (true, _) => i as f64,
                    (_, true) => i as f64 / 3.0,
                    _ if is_closed || is_pinned => i as f64,
                    _ => i as f64 - 1.0,
                };
                let place = super::within(place, 0.0, last);
                let (low, share) = (place.floor() as usize, place.fract());
                let at = |i: usize| widths.get(start + i).copied().unwrap_or(default);
                at(low) + (at((low + 1).min(own_ends - 1)) - at(low)) * share
            };
            let Some(own) = points.get(3 * range.start..3_usize.saturating_mul(range.end)) else {
                lost += 1;
                continue;
            };
            let mut own: Vec<(DVec3, f64)> = own
                .chunks_exact(3)
                .zip(range)
                .enumerate()
                .map(|(k, (p, i))| {
                    (DVec3::new(p[0], p[1], p[2]), if per_point { widths[i] } else { width(k) })
                })
                .collect();
            if is_closed {
                // A piece goes on to the first point, or is made of the first three as well.
                let again = if is_linear || is_bezier { 1 } else { 3 };
                own.extend_from_within(..again.min(own.len()));
            }
            if !is_linear && basis == "catmullRom" {
                own = bezier_of(&own, is_pinned);
            } else if let (true, false, "bspline", [first, second, .., before, last]) =
                (is_pinned, is_linear, basis.as_str(), own.as_slice())
            {
                // A pinned curve begins at its first point.
                let mirrored = |end: &(DVec3, f64), inner: &(DVec3, f64)| (end.0 * 2.0 - inner.0, end.1);
                let (a, b) = (mirrored(first, second), mirrored(last, before));
                own.insert(0, a);
                own.push(b);
            }
            let fits = pieces(&kind, own.len());
            if !fits || own.iter().any(|(p, w)| !p.to_array().iter().all(|v| v.is_finite()) || !w.is_finite())
            {
                lost += 1;
                continue;
            }
            starts.push(all.len() as u32);
            all.extend(own.iter().map(|(p, _)| *p));
            radii.extend(own.iter().map(|(_, width)| if *width > 0.0 { 0.5 * width } else { 0.0 }));
        }
        if lost > 0 {
            self.warn(prim, "some curves are left out: their points don't suit their basis");
        }
        if all.is_empty() {
            return Vec::new();
        }
        if radii.iter().all(|r| *r == radii[0]) {
            radii.truncate(1);
        }
        let surface = self.surface(prim, within, &Has::default());
        vec![Node::Curves(Curves {
            points: all,
            starts,
            basis: kind,
            radii,
            form: CurveForm::Round,
            normals: Vec::new(),
            surface,
        })]
    }
}

/// Whether so many points make whole pieces.
fn pieces(basis: &CurveBasis, points: usize) -> bool {
    let [first, further] = basis.points();
    points.checked_sub(first).is_some_and(|rest| rest.is_multiple_of(further))
}

/// A curve through its points (Catmull & Rom 1974) as pieces of Bezier's; one that isn't pinned begins at its second point.
fn bezier_of(points: &[(DVec3, f64)], is_pinned: bool) -> Vec<(DVec3, f64)> {
    let mut all = points.to_vec();
    if let (true, [first, second, .., before, last]) = (is_pinned, points) {
        all.insert(0, (first.0 * 2.0 - second.0, first.1));
        all.push((last.0 * 2.0 - before.0, last.1));
    }
    let mut out = Vec::new();
    for four in all.windows(4) {
        let [a, b, c, d] = [four[0], four[1], four[2], four[3]];
        if out.is_empty() {
            out.push(b);
        }
        out.push((b.0 + (c.0 - a.0) * (1.0 / 6.0), b.1 + (c.1 - b.1) / 3.0));
        out.push((c.0 - (d.0 - b.0) * (1.0 / 6.0), c.1 - (c.1 - b.1) / 3.0));
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_through_their_points_are_pieces_of_bezier() {
        let points: Vec<(DVec3, f64)> = (0..5).map(|i| (DVec3::X * f64::from(i), 1.0)).collect();
        let made = bezier_of(&points, false);
        assert_eq!(made.len(), 7);
        // What lies evenly on a line is it, evenly.
        for (i, (p, _)) in made.iter().enumerate() {
            assert!((p.x - (1.0 + i as f64 / 3.0)).abs() < 1e-12);
        }
        let pinned = bezier_of(&points, true);
        assert_eq!((pinned.len(), pinned[0].0.x, pinned[12].0.x), (13, 0.0, 4.0));
    }
}
