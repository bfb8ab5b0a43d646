//! Skinning by dual quaternions (Kavan, Collins, Zara and O'Sullivan 2008, "Geometric Skinning with Approximate Dual Quaternion Blending"): of
//! what joints do to a point, turns and moves are mixed as screws, so that a twisted arm doesn't become thin.
//!
//! What joints stretch is parted from what they turn, and mixed by itself, as it comes before.

use straal_math::{Affine, DVec3};

use super::xform;

/// What a joint does: it stretches by a symmetric matrix, turns, and moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Screw {
    stretch: [[f64; 3]; 3],
    /// The turn as x, y, z, w, and the dual part.
    real: [f64; 4],
    dual: [f64; 4],
}

impl Screw {
    /// None of a map that turns things inside out, or leaves nothing of them.
    pub fn of(m: &Affine) -> Option<Self> {
        /// The way to the nearest turn is halved and squared with each step, from stretches of any size.
        const MOST_STEPS: usize = 60;
        let linear = Affine { rows: m.rows.map(|[a, b, c, _]| [a, b, c, 0.0]) };
        if !(linear.determinant() > 0.0 && m.is_finite()) {
            return None;
        }
        // The polar decomposition by Newton's method: the mean of a matrix and its inverse transposed.
        let mut turn = linear;
        for _ in 0..MOST_STEPS {
            let back = turn.inverse()?;
            let next = std::array::from_fn(|i| {
                std::array::from_fn(|j| if j < 3 { 0.5 * (turn.rows[i][j] + back.rows[j][i]) } else { 0.0 })
            });
            let change: f64 = (0..9).map(|k| (turn.rows[k / 3][k % 3] - next[k / 3][k % 3]).abs()).sum();
            turn = Affine { rows: next };
            if change < 1e-14 {
                break;
            }
        }
        let r = turn.rows;
        let stretch = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..3).map(|k| r[k][i] * linear.rows[k][j]).sum::<f64>())
        });
        let real = quaternion(&r);
        let moved = [m.rows[0][3], m.rows[1][3], m.rows[2][3], 0.0];
        let dual = product(moved, real).map(|v| 0.5 * v);
        Some(Self { stretch, real, dual })
    }

    /// The mean of some by weights; none of none.
    pub fn mean<'a>(of: impl Iterator<Item = (f64, &'a Self)>) -> Option<Affine> {
        let (mut stretch, mut real, mut dual) = ([[0.0; 3]; 3], [0.0; 4], [0.0; 4]);
        let (mut first, mut sum) = (None, 0.0);
        for (weight, screw) in of {
            let first = *first.get_or_insert(screw.real);
            // A quaternion and its negative are the same turn: the shorter way counts.
            let dot: f64 = first.iter().zip(screw.real).map(|(a, b)| a * b).sum();
            let signed = if dot < 0.0 { 0.0 - weight } else { weight };
            sum += weight;
            for (to, from) in stretch.iter_mut().flatten().zip(screw.stretch.iter().flatten()) {
                *to += weight * from;
            }
            for k in 0..4 {
                real[k] += signed * screw.real[k];
                dual[k] += signed * screw.dual[k];
            }
        }
        let length = real.iter().map(|v| v * v).sum::<f64>().sqrt();
        if !(sum > 0.0 && length > 0.0 && length.is_finite()) {
            return None;
        }
        let real = real.map(|v| v / length);
        let dual = dual.map(|v| v / length);
        let back = [0.0 - real[0], 0.0 - real[1], 0.0 - real[2], real[3]];
        let [x, y, z, _] = product(dual, back).map(|v| 2.0 * v);
        let stretch = stretch.map(|row| row.map(|v| v / sum));
        let stretch = Affine { rows: stretch.map(|[a, b, c]| [a, b, c, 0.0]) };
        Some(stretch.then(&xform::quaternion(real)).then(&Affine::translate(DVec3::new(x, y, z))))
    }
}

/// Hamilton's product of two quaternions x, y, z, w.
fn product([ax, ay, az, aw]: [f64; 4], [bx, by, bz, bw]: [f64; 4]) -> [f64; 4] {
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

/// The unit quaternion of a turn, by the largest of its four numbers (Shepperd 1978).
fn quaternion(r: &[[f64; 4]; 3]) -> [f64; 4] {
    let trace = r[0][0] + r[1][1] + r[2][2];
    let squares = [r[0][0], r[1][1], r[2][2], trace];
    let most = (0..4).fold(0, |most, i| if squares[i] > squares[most] { i } else { most });
    let mut q = [0.0; 4];
    if most == 3 {
        let w = (1.0 + trace).sqrt();
        let f = 0.5 / w;
        q = [f * (r[2][1] - r[1][2]), f * (r[0][2] - r[2][0]), f * (r[1][0] - r[0][1]), 0.5 * w];
    } else {
        let (i, j, k) = (most, (most + 1) % 3, (most + 2) % 3);
        let v = (1.0 + r[i][i] - r[j][j] - r[k][k]).sqrt();
        let f = 0.5 / v;
        q[i] = 0.5 * v;
        q[j] = f * (r[j][i] + r[i][j]);
        q[k] = f * (r[k][i] + r[i][k]);
        q[3] = f * (r[k][j] - r[j][k]);
    }
    q
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: DVec3, b: DVec3) {
        assert!((a - b).length() < 1e-9, "{a:?} is not {b:?}");
    }

    #[test]
    fn one_joint_does_what_its_matrix_does() {
        for (x, degrees) in [(1.0, 30.0), (2.0, 180.0), (0.5, -120.0), (1.0, 0.0)] {
            for axis in [DVec3::X, DVec3::Y, DVec3::new(1.0, 2.0, 3.0)] {
                let m = Affine::scale(DVec3::new(x, 1.0, 3.0))
                    .then(&Affine::rotate(axis, degrees).unwrap())
                    .then(&Affine::translate(DVec3::new(1.0, -2.0, 5.0)));
                let mean = Screw::mean([(0.5, &Screw::of(&m).unwrap())].into_iter()).unwrap();
                for p in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z] {
                    near(mean.point(p), m.point(p));
                }
            }
        }
        assert!(Screw::of(&Affine::scale(DVec3::new(-1.0, 1.0, 1.0))).is_none());
        assert!(Screw::of(&Affine::scale(DVec3::ZERO)).is_none());
        assert!(Screw::mean(std::iter::empty()).is_none());
    }

    /// Where the mean of matrices is flat, between a turn by 0 and one by 180 degrees, here nothing is lost.
    #[test]
    fn halfway_to_a_turn_is_half_the_turn() {
        let turn = |degrees: f64| Affine::rotate(DVec3::Z, degrees).unwrap();
        let screws = [turn(0.0), turn(179.0)].map(|m| Screw::of(&m).unwrap());
        let mean = Screw::mean(screws.iter().map(|s| (0.5, s))).unwrap();
        near(mean.point(DVec3::X), turn(89.5).point(DVec3::X));
        // About the same axis elsewhere, things stay as far from it.
        let about = |m: Affine| {
            Affine::translate(DVec3::new(-3.0, 0.0, 0.0))
                .then(&m)
                .then(&Affine::translate(DVec3::new(3.0, 0.0, 0.0)))
        };
        let screws = [about(turn(0.0)), about(turn(90.0))].map(|m| Screw::of(&m).unwrap());
        let mean = Screw::mean(screws.iter().map(|s| (0.5, s))).unwrap();
        near(mean.point(DVec3::new(5.0, 0.0, 0.0)), about(turn(45.0)).point(DVec3::new(5.0, 0.0, 0.0)));
    }
}
