//! Three by three matrices in double precision, for what is linear in colour.

use std::ops::Mul;

/// A matrix by rows; it multiplies columns from the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix3(pub [[f64; 3]; 3]);

impl Matrix3 {
    /// Leaves everything as it is.
    pub const IDENTITY: Self = Self::diagonal([1.0; 3]);

    /// Scales each number by itself.
    pub const fn diagonal([a, b, c]: [f64; 3]) -> Self {
        Self([[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]])
    }

    /// The matrix times a column.
    pub fn apply(&self, v: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    /// The same for single precision, computed in double.
    pub fn apply_f32(&self, v: [f32; 3]) -> [f32; 3] {
        self.apply(v.map(f64::from)).map(|x| x as f32)
    }

    /// Rows for columns.
    pub fn transpose(&self) -> Self {
        let m = &self.0;
        Self([0, 1, 2].map(|i| [m[0][i], m[1][i], m[2][i]]))
    }

    /// The inverse by cofactors; `None` where the determinant is 0 or no number.
    pub fn inverse(&self) -> Option<Self> {
        let m = &self.0;
        let cofactor = |i: usize, j: usize| {
            let (r, s) = ((i + 1) % 3, (i + 2) % 3);
            let (c, d) = ((j + 1) % 3, (j + 2) % 3);
            m[r][c] * m[s][d] - m[r][d] * m[s][c]
        };
        let determinant = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        Some(Self([0, 1, 2].map(|i| [0, 1, 2].map(|j| cofactor(j, i) / determinant))))
    }
}

impl Mul for Matrix3 {
    type Output = Self;
    /// First `other`, then `self`.
    fn mul(self, other: Self) -> Self {
        let columns = other.transpose();
        Self(columns.0.map(|column| self.apply(column))).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_and_its_inverse_make_the_identity() {
        let m = Matrix3([[2.0, -1.0, 0.5], [0.25, 3.0, 1.0], [-4.0, 0.0, 1.5]]);
        let one = m * m.inverse().unwrap();
        for (row, want) in one.0.iter().flatten().zip(Matrix3::IDENTITY.0.iter().flatten()) {
            assert!((row - want).abs() < 1e-15, "{one:?}");
        }
        assert_eq!(m * Matrix3::IDENTITY, m);
        assert_eq!(Matrix3([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 1.0, 0.0]]).inverse(), None);
        assert_eq!(Matrix3::diagonal([1.0, f64::NAN, 1.0]).inverse(), None);
    }

    #[test]
    fn a_product_applies_its_right_side_first() {
        let a = Matrix3([[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let b = Matrix3::diagonal([1.0, 3.0, 1.0]);
        assert_eq!((a * b).apply([0.0, 1.0, 0.0]), [6.0, 3.0, 0.0]);
    }
}
