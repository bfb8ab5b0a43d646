//! Affine maps: set-up composes them in double precision, rays use both directions in single precision.

use crate::simd::{Double, Float};
use crate::{DVec3, Ray, Vec3, ops};

/// An affine map in double precision: x -> M x + b, as three rows of four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// Rows; the fourth column is the translation.
    pub rows: [[f64; 4]; 3],
}

impl Affine {
    /// The map that changes nothing.
    pub const IDENTITY: Self =
        Self { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };

    /// Moves by `v`.
    pub const fn translate(v: DVec3) -> Self {
        Self { rows: [[1.0, 0.0, 0.0, v.x], [0.0, 1.0, 0.0, v.y], [0.0, 0.0, 1.0, v.z]] }
    }

    /// Scales each axis about the origin.
    pub const fn scale(v: DVec3) -> Self {
        Self { rows: [[v.x, 0.0, 0.0, 0.0], [0.0, v.y, 0.0, 0.0], [0.0, 0.0, v.z, 0.0]] }
    }

    /// Turns about an axis through the origin by an angle in degrees, counter-clockwise seen from the axis' tip.
    /// `None` when the axis has no direction.
    pub fn rotate(axis: DVec3, degrees: f64) -> Option<Self> {
        let a = axis.try_normalize()?;
        let (s, c) = ops::sin_cos_degrees(degrees);
        let k = 1.0 - c;
        Some(Self {
            rows: [
                [c + a.x * a.x * k, a.x * a.y * k - a.z * s, a.x * a.z * k + a.y * s, 0.0],
                [a.y * a.x * k + a.z * s, c + a.y * a.y * k, a.y * a.z * k - a.x * s, 0.0],
                [a.z * a.x * k - a.y * s, a.z * a.y * k + a.x * s, c + a.z * a.z * k, 0.0],
            ],
        })
    }

    /// The frame of an observer: local -z looks from `eye` towards `target`, local y is as near to `up` as it
    /// can be, local x points right. `None` when `eye` and `target` coincide or `up` is along the view.
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Option<Self> {
        let w = (eye - target).try_normalize()?;
        let u = up.try_normalize()?.cross(w);
        if u.length() < 1e-9 {
            return None;
        }
        let u = u.try_normalize()?;
        let v = w.cross(u);
        Some(Self { rows: [[u.x, v.x, w.x, eye.x], [u.y, v.y, w.y, eye.y], [u.z, v.z, w.z, eye.z]] })
    }

    /// First `self`, then `next`.
    pub fn then(&self, next: &Self) -> Self {
        let (a, b) = (&next.rows, &self.rows);
        let cell = |i: usize, j: usize| {
            a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] + if j == 3 { a[i][3] } else { 0.0 }
        };
        Self { rows: std::array::from_fn(|i| std::array::from_fn(|j| cell(i, j))) }
    }

    /// Determinant of the linear part.
    pub fn determinant(&self) -> f64 {
        let r = |i: usize| DVec3::new(self.rows[i][0], self.rows[i][1], self.rows[i][2]);
        r(0).dot(r(1).cross(r(2)))
    }

    /// The inverse, or `None` when the map is singular or not finite: the determinant is compared with the
    /// product of the row lengths, so that uniform scaling, however small, is no reason.
    pub fn inverse(&self) -> Option<Self> {
        let r = |i: usize| DVec3::new(self.rows[i][0], self.rows[i][1], self.rows[i][2]);
        let (a, b, c) = (r(0), r(1), r(2));
        let det = a.dot(b.cross(c));
        let size = a.length() * b.length() * c.length();
        if !(det.is_finite() && size.is_finite() && det.abs() > size * 1e-12 && det != 0.0) {
            return None;
        }
        let (x, y, z) = (b.cross(c) / det, c.cross(a) / det, a.cross(b) / det);
        let t = DVec3::new(self.rows[0][3], self.rows[1][3], self.rows[2][3]);
        let inv = Self { rows: [[x.x, y.x, z.x, 0.0], [x.y, y.y, z.y, 0.0], [x.z, y.z, z.z, 0.0]] };
        let back = inv.vector(t);
        let mut out = inv;
        (out.rows[0][3], out.rows[1][3], out.rows[2][3]) = (-back.x, -back.y, -back.z);
        out.rows.iter().flatten().all(|v| v.is_finite()).then_some(out)
    }

    /// The image of a point, or of many side by side.
    #[inline(always)]
    pub fn point<D: Double>(&self, p: DVec3<D>) -> DVec3<D> {
        let [a, b, c] = &self.rows;
        let DVec3 { x, y, z } = self.vector(p);
        DVec3::new(x + a[3], y + b[3], z + c[3])
    }

    /// The image of a displacement, or of many side by side.
    #[inline(always)]
    pub fn vector<D: Double>(&self, v: DVec3<D>) -> DVec3<D> {
        let [a, b, c] = &self.rows;
        DVec3::new(
            v.x * a[0] + v.y * a[1] + v.z * a[2],
            v.x * b[0] + v.y * b[1] + v.z * b[2],
            v.x * c[0] + v.y * c[1] + v.z * c[2],
        )
    }

    /// The image of a normal (not renormalised) when `self` is the **inverse** of the map that moves the surface; or of many
    /// side by side.
    #[inline(always)]
    pub fn normal_by_inverse<D: Double>(&self, n: DVec3<D>) -> DVec3<D> {
        let [a, b, c] = &self.rows;
        DVec3::new(
            n.x * a[0] + n.y * b[0] + n.z * c[0],
            n.x * a[1] + n.y * b[1] + n.z * c[1],
            n.x * a[2] + n.y * b[2] + n.z * c[2],
        )
    }

    /// Whether nothing moves.
    pub fn is_identity(&self) -> bool {
        *self == Self::IDENTITY
    }

    /// Whether no number is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        self.rows.iter().flatten().all(|v| v.is_finite())
    }
}

/// An invertible affine map in single precision, both ways: what instances and shapes keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Object to world, three rows of four.
    pub forward: [[f32; 4]; 3],
    /// World to object, three rows of four.
    pub inverse: [[f32; 4]; 3],
}

#[inline(always)]
fn apply<F: Float>(m: &[[f32; 4]; 3], p: Vec3<F>, w: f32) -> Vec3<F> {
    Vec3::new(row(m[0], p) + m[0][3] * w, row(m[1], p) + m[1][3] * w, row(m[2], p) + m[2][3] * w)
}

/// The linear part of a row times a vector.
#[inline(always)]
fn row<F: Float>(m: [f32; 4], p: Vec3<F>) -> F {
    p.x * m[0] + p.y * m[1] + p.z * m[2]
}

impl Transform {
    /// The map that changes nothing.
    pub const IDENTITY: Self = {
        let i = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        Self { forward: i, inverse: i }
    };

    /// Rounds a map and its inverse; `None` when it is singular, or leaves the range of single precision.
    pub fn new(m: &Affine) -> Option<Self> {
        let inv = m.inverse()?;
        let round = |a: &Affine| a.rows.map(|r| r.map(|v| v as f32));
        let t = Self { forward: round(m), inverse: round(&inv) };
        let finite = |a: &[[f32; 4]; 3]| a.iter().flatten().all(|v| v.is_finite());
        (finite(&t.forward) && finite(&t.inverse)).then_some(t)
    }

    /// Object point to world.
    #[inline(always)]
    pub fn point<F: Float>(&self, p: Vec3<F>) -> Vec3<F> {
        apply(&self.forward, p, 1.0)
    }

    /// Object displacement to world.
    #[inline(always)]
    pub fn vector<F: Float>(&self, v: Vec3<F>) -> Vec3<F> {
        apply(&self.forward, v, 0.0)
    }

    /// Object normal to world, not renormalised.
    #[inline(always)]
    pub fn normal<F: Float>(&self, n: Vec3<F>) -> Vec3<F> {
        let m = &self.inverse;
        let [a, b, c] = [0, 1, 2].map(|j: usize| [m[0][j], m[1][j], m[2][j], 0.0]);
        Vec3::new(row(a, n), row(b, n), row(c, n))
    }

    /// World point to object.
    #[inline(always)]
    pub fn inverse_point<F: Float>(&self, p: Vec3<F>) -> Vec3<F> {
        apply(&self.inverse, p, 1.0)
    }

    /// World displacement to object.
    #[inline(always)]
    pub fn inverse_vector<F: Float>(&self, v: Vec3<F>) -> Vec3<F> {
        apply(&self.inverse, v, 0.0)
    }

    /// The ray in object space; its direction is not renormalised, so that t means the same in both spaces.
    #[inline]
    pub fn inverse_ray(&self, r: &Ray) -> Ray {
        Ray { o: self.inverse_point(r.o), d: self.inverse_vector(r.d), ..*r }
    }

    /// Upper bound of the absolute rounding error, each coordinate, of [`Self::point`] for object points that are
    /// themselves off by at most `p_err` (Higham's gamma(n) bound of a sum of four products; 3 roundings each).
    #[inline(always)]
    pub fn point_error<F: Float>(&self, p: Vec3<F>, p_err: Vec3<F>) -> Vec3<F> {
        const GAMMA4: f32 = 4.0 * f32::EPSILON * 0.5 * 1.001;
        #[inline(always)]
        fn of_row<F: Float>(m: [f32; 4], p: Vec3<F>, p_err: Vec3<F>) -> F {
            // The absolute value of a product is the product of absolute values, to the bit.
            let m = [m[0].abs(), m[1].abs(), m[2].abs(), m[3].abs()];
            (row(m, p.abs()) + m[3]) * GAMMA4 + row(m, p_err) * (1.0 + GAMMA4)
        }
        let [a, b, c] = self.forward;
        Vec3::new(of_row(a, p, p_err), of_row(b, p, p_err), of_row(c, p, p_err))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec3, b: DVec3) -> bool {
        (a - b).length() < 1e-12
    }

    #[test]
    fn rotation_turns_counter_clockwise() {
        let m = Affine::rotate(DVec3::Y, 90.0).unwrap();
        assert!(close(m.point(DVec3::Z), DVec3::X));
        assert!(close(m.point(DVec3::X), -DVec3::Z));
    }

    #[test]
    fn then_applies_in_reading_order() {
        let m = Affine::scale(DVec3::splat(2.0)).then(&Affine::translate(DVec3::X));
        assert!(close(m.point(DVec3::ONE), DVec3::new(3.0, 2.0, 2.0)));
    }

    #[test]
    fn inverse_undoes_and_refuses_the_singular() {
        let m = Affine::rotate(DVec3::new(1.0, 2.0, 3.0), 33.0)
            .unwrap()
            .then(&Affine::scale(DVec3::new(1e-9, 2e-9, 5e-9)))
            .then(&Affine::translate(DVec3::new(4.0, 5.0, 6.0)));
        let id = m.then(&m.inverse().unwrap());
        for p in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO] {
            assert!((id.point(p) - p).length() < 1e-6);
        }
        assert!(Affine::scale(DVec3::new(1.0, 0.0, 1.0)).inverse().is_none());
        assert!(Affine::scale(DVec3::splat(f64::NAN)).inverse().is_none());
    }

    #[test]
    fn look_at_faces_the_target() {
        let m = Affine::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y).unwrap();
        assert!(close(m.vector(-DVec3::Z), -DVec3::Z));
        assert!(close(m.vector(DVec3::X), DVec3::X));
        assert!(Affine::look_at(DVec3::Y, DVec3::ZERO, DVec3::Y).is_none());
    }
}
