//! Along which axes points are spread.

use super::EachPoint;
use straal_math::DVec3;

/// The principal axes of a set of points: the eigenvectors of its covariance, at right angles and of length 1.
pub(super) fn axes(points: &EachPoint<'_>) -> [DVec3; 3] {
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    points(&mut |p| {
        sum += p;
        count += 1.0;
    });
    let mean = sum / count;
    let mut covariance = [[0.0; 3]; 3];
    points(&mut |p| {
        let p = p - mean;
        for (i, row) in covariance.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x += p[i] * p[j];
            }
        }
    });
    eigenvectors(covariance)
}

/// Jacobi's method (Golub and Van Loan 1996, "Matrix Computations", algorithm 8.4.2): rotations of two axes at a time
/// make the elements beside the diagonal 0. Convergence is quadratic: a symmetric matrix of three rows takes five or six
/// sweeps in double precision.
fn eigenvectors(mut m: [[f64; 3]; 3]) -> [DVec3; 3] {
    const SWEEPS: usize = 12;
    let mut axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q] == 0.0 || !m[p][q].is_finite() {
                continue;
            }
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let t = 1.0_f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cos = 1.0 / (t * t + 1.0).sqrt();
            let sin = t * cos;
            let turned = |a: f64, b: f64| (cos * a - sin * b, sin * a + cos * b);
            for row in &mut m {
                (row[p], row[q]) = turned(row[p], row[q]);
            }
            let (above, below) = (m[p], m[q]);
            for (k, (&a, &b)) in above.iter().zip(&below).enumerate() {
                (m[p][k], m[q][k]) = turned(a, b);
            }
            (m[p][q], m[q][p]) = (0.0, 0.0);
            (axes[p], axes[q]) = (axes[p] * cos - axes[q] * sin, axes[p] * sin + axes[q] * cos);
        }
    }
    axes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_of_a_turned_brick() {
        let turned = [DVec3::new(1.0, 2.0, 2.0), DVec3::new(2.0, 1.0, -2.0), DVec3::new(2.0, -2.0, 1.0)];
        let turned = turned.map(|a| a / 3.0);
        let sizes = [5.0, 2.0, 0.5];
        let corner =
            |i: usize| (0..3).fold(DVec3::ONE, |p, k| p + turned[k] * (sizes[k] * [-1.0, 1.0][i >> k & 1]));
        let found = axes(&|visit| (0..8).for_each(|i| visit(corner(i))));
        for (i, a) in found.iter().enumerate() {
            assert!((a.length() - 1.0).abs() < 1e-14);
            assert!(a.dot(found[(i + 1) % 3]).abs() < 1e-14);
            let along = turned.iter().filter(|t| (t.dot(*a).abs() - 1.0).abs() < 1e-14).count();
            assert_eq!(along, 1, "{a:?} is along one of the brick's axes");
        }
    }

    #[test]
    fn anything_has_axes() {
        for points in [vec![DVec3::ONE; 3], vec![DVec3::ZERO, DVec3::new(1e38, -1e38, 1e38)]] {
            let found = axes(&|visit| points.iter().for_each(|&p| visit(p)));
            assert!(found.iter().all(|a| (a.length() - 1.0).abs() < 1e-12), "{found:?}");
        }
    }
}
