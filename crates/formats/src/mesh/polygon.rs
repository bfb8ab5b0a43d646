//! Cutting polygons into triangles.

/// The most corners of a polygon that isn't convex. Cutting ears takes time that grows with their square.
pub(crate) const MAX_CONCAVE_CORNERS: usize = 4096;

/// Cuts one polygon into triangles with the same winding and hands each to `emit` as indices into the polygon's
/// corners. `points` are the corners in order. A convex polygon is cut as a fan from its first corner, as other
/// readers do; a concave one by cutting ears (Meisters 1975) after projection along its normal. Every polygon of n
/// corners gives n - 2 triangles, also where it crosses itself or has no area. `Err` tells that it is concave and
/// has too many corners.
pub(crate) fn triangulate(
    points: &[[f32; 3]],
    mut emit: impl FnMut([usize; 3]),
) -> Result<(), TooManyCorners> {
    if points.len() < 3 {
        return Ok(());
    }
    if points.len() == 3 {
        emit([0, 1, 2]);
        return Ok(());
    }
    let flat = project(points);
    if is_convex(&flat) {
        for i in 1..points.len() - 1 {
            emit([0, i, i + 1]);
        }
        return Ok(());
    }
    if points.len() > MAX_CONCAVE_CORNERS {
        return Err(TooManyCorners);
    }
    Ears::new(&flat).cut(emit);
    Ok(())
}

/// The polygon is concave and has more than [`MAX_CONCAVE_CORNERS`] corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooManyCorners;

/// The corners in the plane of the two axes in which the polygon's area is largest, turned counter-clockwise.
fn project(points: &[[f32; 3]]) -> Vec<[f64; 2]> {
    // Newell's method: the normal's components are the signed areas of the projections onto the axis planes.
    // Corners are taken relative to the first one, so that a small polygon far from the origin keeps its digits.
    let origin = points[0];
    let relative = |p: &[f32; 3]| [0, 1, 2].map(|k| f64::from(p[k]) - f64::from(origin[k]));
    let mut normal = [0.0f64; 3];
    let mut a = relative(&points[points.len() - 1]);
    for point in points {
        let b = relative(point);
        for (k, component) in normal.iter_mut().enumerate() {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            *component += (a[u] - b[u]) * (a[v] + b[v]);
        }
        a = b;
    }
    let mut axis = 0;
    for k in 1..3 {
        if normal[k].abs() > normal[axis].abs() {
            axis = k;
        }
    }
    let (u, v) =
        if normal[axis] < 0.0 { ((axis + 2) % 3, (axis + 1) % 3) } else { ((axis + 1) % 3, (axis + 2) % 3) };
    points
        .iter()
        .map(|p| {
            let p = relative(p);
            [p[u], p[v]]
        })
        .collect()
}

/// Twice the signed area of a triangle: positive when it turns left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether a fan from corner 0 covers the polygon without overlap: no triangle of the fan turns right, and the
/// polygon doesn't either. A star that winds twice fails the first, a dent the second.
fn is_convex(p: &[[f64; 2]]) -> bool {
    let n = p.len();
    (0..n).all(|i| turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) >= 0.0)
        && (1..n - 1).all(|i| turn(p[0], p[i], p[i + 1]) >= 0.0)
}

/// A polygon from which ears are being cut: the corners that remain are a ring of links. Which corners are ears is
/// kept up to date, so that each cut looks again at its two neighbours only and the whole takes O(n²).
struct Ears<'a> {
    points: &'a [[f64; 2]],
    next: Vec<usize>,
    previous: Vec<usize>,
    ear: Vec<bool>,
}

impl<'a> Ears<'a> {
    fn new(points: &'a [[f64; 2]]) -> Self {
        let n = points.len();
        let mut ears = Self {
            points,
            next: (0..n).map(|i| (i + 1) % n).collect(),
            previous: (0..n).map(|i| (i + n - 1) % n).collect(),
            ear: vec![false; n],
        };
        for i in 0..n {
            ears.ear[i] = ears.is_ear(i);
        }
        ears
    }

    fn cut(mut self, mut emit: impl FnMut([usize; 3])) {
        let mut corner = 0;
        for remaining in (3..=self.points.len()).rev() {
            let mut looked_at = 0;
            while !self.ear[corner] && looked_at < remaining {
                corner = self.next[corner];
                looked_at += 1;
            }
            // A polygon that crosses itself, or whose corners lie on a line, may have no ear: any corner will do.
            let (before, after) = (self.previous[corner], self.next[corner]);
            emit([before, corner, after]);
            self.next[before] = after;
            self.previous[after] = before;
            self.ear[before] = self.is_ear(before);
            self.ear[after] = self.is_ear(after);
            // Going on past the next corner spreads the cuts around the polygon and avoids slivers.
            corner = self.next[after];
        }
    }

    /// Whether the triangle of a corner and its neighbours lies within the polygon.
    fn is_ear(&self, corner: usize) -> bool {
        let (before, after) = (self.previous[corner], self.next[corner]);
        let [a, b, c] = [before, corner, after].map(|i| self.points[i]);
        if before == after || turn(a, b, c) <= 0.0 {
            return false;
        }
        let mut other = self.next[after];
        while other != before {
            let p = self.points[other];
            // A corner at the same place as one of the triangle's is where a hole was joined by a double edge.
            let inside = turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            if inside && p != a && p != b && p != c {
                return false;
            }
            other = self.next[other];
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangulates a polygon in the plane and checks that the triangles turn left and add up to its area.
    fn check(polygon: &[[f32; 2]]) -> Vec<[usize; 3]> {
        // The plane is tilted so that all three coordinates take part.
        let points: Vec<[f32; 3]> =
            polygon.iter().map(|p| [p[0], p[1], 5.0 + 0.5 * p[0] - 0.25 * p[1]]).collect();
        let mut triangles = Vec::new();
        triangulate(&points, |t| triangles.push(t)).unwrap();
        assert_eq!(triangles.len(), polygon.len() - 2);
        let flat: Vec<[f64; 2]> = polygon.iter().map(|p| p.map(f64::from)).collect();
        let n = flat.len();
        let area: f64 = (0..n).map(|i| turn([0.0, 0.0], flat[i], flat[(i + 1) % n])).sum();
        let mut covered = 0.0;
        for [a, b, c] in &triangles {
            let part = turn(flat[*a], flat[*b], flat[*c]);
            assert!(part * area.signum() >= 0.0, "a triangle is turned over: {triangles:?}");
            covered += part;
        }
        assert!((covered - area).abs() < 1e-9 * area.abs(), "{covered} of {area} covered");
        triangles
    }

    #[test]
    fn convex_polygons_become_fans() {
        assert_eq!(check(&[[0., 0.], [1., 0.], [1., 1.], [0., 1.]]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(check(&[[0., 1.], [1., 1.], [1., 0.], [0., 0.]]), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn concave_polygons_are_covered_exactly() {
        check(&[[0., 0.], [2., 1.], [0., 2.], [0.5, 1.]]); // an arrowhead: the fan's diagonal is outside
        check(&[[0.5, 1.], [0., 0.], [2., 1.], [0., 2.]]);
        check(&[[0., 0.], [3., 0.], [3., 3.], [2., 3.], [2., 1.], [1., 1.], [1., 3.], [0., 3.]]); // U
        // A square ring, its hole joined to the outside by a double edge.
        check(&[
            [0., 0.],
            [3., 0.],
            [3., 3.],
            [0., 3.],
            [0., 0.],
            [1., 1.],
            [1., 2.],
            [2., 2.],
            [2., 1.],
            [1., 1.],
        ]);
        let comb: Vec<[f32; 2]> = (0..50)
            .flat_map(|i| [[i as f32, 0.0], [i as f32 + 0.5, 10.0]])
            .chain([[60.0, -1.0], [-1.0, -1.0]])
            .collect();
        check(&comb);
        let mut star: Vec<[f32; 2]> = Vec::new();
        for i in 0..64 {
            let (sin, cos) = straal_math::ops::sin_cos_degrees(f64::from(i) * 360.0 / 64.0);
            let radius = if i % 2 == 0 { 1.0 } else { 0.3 };
            star.push([(radius * cos) as f32, (radius * sin) as f32]);
        }
        check(&star);
        star.reverse();
        check(&star);
    }

    #[test]
    fn hopeless_polygons_still_end() {
        let mut count = 0;
        for polygon in [
            vec![[0.0f32; 3]; 7],
            vec![[f32::NAN; 3]; 6],
            vec![[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.]], // a bow tie
            vec![[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [3., 0., 0.], [1.5, 0., 0.]],
            vec![[0., 0., f32::INFINITY], [1., 0., 0.], [2., 1., 0.], [3., 0., 0.], [1.5, 0., 0.]],
        ] {
            let before = count;
            triangulate(&polygon, |_| count += 1).unwrap();
            assert_eq!(count - before, polygon.len() - 2);
        }
        let teeth = (0..10_000).map(|i| [i as f32, (i % 2) as f32, 0.0]);
        let zigzag: Vec<[f32; 3]> = teeth.chain([[9999.0, -9.0, 0.0], [0.0, -9.0, 0.0]]).collect();
        assert_eq!(triangulate(&zigzag, |_| ()), Err(TooManyCorners));
    }
}
