//! Triangles cut by boxes. The box of a triangle's part in a cell is what the kd-tree calls "perfect splits" (Havran 2000; Wald and Havran 2006, section 3.2).
//!
//! # Exactness
//! The part's box isn't the triangle's, so that the moment of `partition.rs`, where the ray enters the triangle's own
//! box, may lie outside. For a clipped triangle the moment is the t of its hit, and what has to be known is where the
//! ray is then. Let e be the rounding unit of single precision and L the triangle's longest extent. Moving and
//! shearing the vertices (`triangle.rs`) puts the ray, along each axis, within a few e (|t d| + L) of a point p of
//! the triangle, *provided* that t is as well-conditioned as p is: a t from a determinant that is itself a rounding
//! error can be that of any place along a sliver, or along a triangle seen edge-on.
//!
//! The part of the error that grows with |t d| is one of the crossings of planes, and `early` and `late` cover it.
//! For the other the triangle is clipped to the cell grown by [`PAD`] L, and the box of what remains is grown by as
//! much: it holds a box of half that size around p. The proof in `partition.rs` goes through with that small box in
//! the place of the primitive's own: as long as the search follows the cells whose interval has the moment, p lies in
//! the cell or within `PAD` L of it, so that the cell has the triangle.
//!
//! Two errors grow with neither: t is rounded to a number that may have lost its digits, by underflow, and planes are
//! crossed along a direction whose small coordinates were made larger (`local.rs`). A quarter of the padding is for
//! each; for rays for which this isn't enough a search tests every primitive ([`Limits`]).

use crate::{
    local::{LEAST, LocalRay},
    prim::{Prim, PrimKind},
};
use straal_math::{Bounds, Vec3};

/// In units of the triangle's longest extent.
const PAD: f64 = 128.0 * f32::EPSILON as f64;

/// Triangles of a lesser extent have a determinant below `triangle::LEAST_DETERMINANT`, however they are seen, and so a t
/// that is computed in double precision.
const SMALL: f64 = 1.0 / (1 << 27) as f64;

/// The error of t by underflow: of small triangles that of the last rounding, of others that of the numerator.
const ERROR_OF_SMALL: f64 = f64::from_bits((1023 - 149) << 52);
const ERROR: f64 = f64::from_bits((1023 - 98) << 52);

/// A triangle cut by six planes has at most nine corners.
const CORNERS: usize = 9;

/// A convex polygon.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [[f64; 3]; CORNERS],
    count: usize,
}

impl Polygon {
    fn of([a, b, c]: [[f64; 3]; 3]) -> Self {
        let mut corners = [[0.0; 3]; CORNERS];
        (corners[0], corners[1], corners[2]) = (a, b, c);
        Self { corners, count: 3 }
    }

    fn corners(&self) -> &[[f64; 3]] {
        &self.corners[..self.count]
    }

    /// The part where `sign` times the coordinate is at most `sign` times `plane` (Sutherland and Hodgman 1974).
    fn cut(&self, axis: usize, plane: f64, sign: f64) -> Self {
        let mut out = Self { corners: [[0.0; 3]; CORNERS], count: 0 };
        let mut add = |p: [f64; 3]| {
            // Rounding can't make a convex polygon have more corners, but this is no place to find out.
            if let Some(slot) = out.corners.get_mut(out.count) {
                *slot = p;
                out.count += 1;
            }
        };
        let corners = self.corners();
        for (i, a) in corners.iter().enumerate() {
            let b = &corners[(i + 1) % corners.len()];
            let (above_a, above_b) = ((a[axis] - plane) * sign, (b[axis] - plane) * sign);
            if above_a <= 0.0 {
                add(*a);
            }
            if (above_a < 0.0 && above_b > 0.0) || (above_a > 0.0 && above_b < 0.0) {
                let s = above_a / (above_a - above_b);
                let mut p: [f64; 3] = std::array::from_fn(|i| a[i] + (b[i] - a[i]) * s);
                p[axis] = plane;
                add(p);
            }
        }
        out
    }
}

/// How far along each axis a hit of the triangle may be found beside it, apart from what grows with t.
pub(crate) fn pad(v: &[Vec3; 3]) -> f64 {
    PAD * longest(&v.map(|p| p.to_array().map(f64::from)))
}

/// For which rays hits of triangles are where [`pad`] says.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Coordinates of the direction aren't greater.
    direction: f64,
    /// The search ends at this t, or earlier.
    t: f64,
}

impl Limits {
    /// Where no triangle is told by anything but its box.
    pub const NONE: Self = Self { direction: f64::INFINITY, t: f64::INFINITY };

    pub fn of(prims: &[Prim], vertices: &dyn Fn(u32) -> [Vec3; 3]) -> Self {
        let mut out = Self::NONE;
        for prim in prims {
            if let PrimKind::Triangle(id) = prim.kind {
                let longest = longest(&vertices(id).map(|p| p.to_array().map(f64::from)));
                let quarter = longest * PAD * 0.25;
                let direction = quarter / if longest < SMALL { ERROR_OF_SMALL } else { ERROR };
                let t = quarter / f64::from(LEAST);
                out = Self {
                    direction: if direction < out.direction { direction } else { out.direction },
                    t: if t < out.t { t } else { out.t },
                };
            }
        }
        out
    }

    /// Whether a ray whose search ends at `exit` keeps them.
    #[inline(always)]
    pub fn hold(&self, r: &LocalRay, exit: f32) -> bool {
        f64::from(r.ray.d[r.axes()[2]].abs()) <= self.direction && f64::from(exit) <= self.t
    }
}

/// The box of a triangle's part in a cell, inside of that cell; `None` when there is no such part.
pub(crate) fn part(v: &[Vec3; 3], cell: &Bounds) -> Option<Bounds> {
    let mut polygon = Polygon::of(v.map(|p| p.to_array().map(f64::from)));
    let pad = pad(v);
    for axis in 0..3 {
        polygon = polygon.cut(axis, f64::from(cell.max[axis]) + pad, 1.0);
        polygon = polygon.cut(axis, f64::from(cell.min[axis]) - pad, -1.0);
    }
    if polygon.count == 0 {
        return None;
    }
    let mut out = Bounds::EMPTY;
    for axis in 0..3 {
        let (low, high) = range(polygon.corners(), axis);
        // Conversion rounds to the nearest.
        out.min[axis] = ((low - pad) as f32).next_down();
        out.max[axis] = ((high + pad) as f32).next_up();
    }
    let out = out.intersection(*cell);
    (!out.is_empty()).then_some(out)
}

/// Whether boxes together hold all of a triangle.
pub(crate) fn is_covered(v: &[Vec3; 3], boxes: &[Bounds]) -> bool {
    fn rest_is_covered(p: Polygon, boxes: &[Bounds]) -> bool {
        // A point or an edge that is left over lies on the face of a box that has it.
        if p.count < 3 {
            return true;
        }
        let Some((first, others)) = boxes.split_first() else { return false };
        let mut inside = p;
        for axis in 0..3 {
            for (plane, sign) in [(first.max[axis], 1.0), (first.min[axis], -1.0)] {
                let outside = inside.cut(axis, f64::from(plane), -sign);
                // In triangles, so that corners don't add up.
                let fan =
                    outside.corners().windows(2).skip(1).map(|edge| [outside.corners[0], edge[0], edge[1]]);
                if !fan.clone().all(|t| rest_is_covered(Polygon::of(t), others)) {
                    return false;
                }
                inside = inside.cut(axis, f64::from(plane), sign);
            }
        }
        true
    }
    rest_is_covered(Polygon::of(v.map(|p| p.to_array().map(f64::from))), boxes)
}

fn range(points: &[[f64; 3]], axis: usize) -> (f64, f64) {
    points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
        let x = p[axis];
        (if x < low { x } else { low }, if x > high { x } else { high })
    })
}

fn longest(points: &[[f64; 3]]) -> f64 {
    (0..3).fold(0.0, |longest, axis| {
        let (low, high) = range(points, axis);
        if high - low > longest { high - low } else { longest }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(min: [f32; 3], max: [f32; 3]) -> Bounds {
        Bounds { min: Vec3::from_array(min), max: Vec3::from_array(max) }
    }

    #[test]
    fn a_corner_of_a_diagonal() {
        let v = [Vec3::ZERO, Vec3::new(4.0, 4.0, 0.0), Vec3::new(4.0, 4.0, 1.0)];
        let b = part(&v, &cell([1.0, 0.0, -1.0], [2.0, 4.0, 2.0])).unwrap();
        let exact = cell([1.0, 1.0, 0.0], [2.0, 2.0, 0.5]);
        // The padding twice, on each axis.
        let most = 4.0 * pad(&v) as f32;
        assert!((b.min - exact.min).length() < most && (b.max - exact.max).length() < most, "{b:?}");
        assert!(b.union(exact) == b, "never smaller than the part");
    }

    #[test]
    fn boxes_overlap_but_the_triangle_does_not() {
        let v = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
        assert_eq!(part(&v, &cell([0.0; 3], [0.2; 3])), None);
        assert_eq!(part(&v, &cell([0.6; 3], [1.0; 3])), None);
        assert!(part(&v, &cell([0.2; 3], [0.5; 3])).is_some());
    }

    #[test]
    fn boxes_cover_a_triangle_together() {
        let v = [Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 4.0)];
        let (low, high) = (cell([-1.0; 3], [2.0, 5.0, 5.0]), cell([2.0, -1.0, -1.0], [5.0, 2.1, 2.1]));
        assert!(is_covered(&v, &[low, high]) && is_covered(&v, &[high, low]));
        assert!(!is_covered(&v, &[low]) && !is_covered(&v, &[high]));
        let gap = cell([2.01, -1.0, -1.0], [5.0; 3]);
        assert!(!is_covered(&v, &[low, gap]));
    }
}
