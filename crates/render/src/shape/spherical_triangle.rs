//! Triangles as they are seen from a point: sampled evenly by solid angle (Arvo 1995, "Stratified Sampling of Spherical Triangles"), by the formulas of
//! Peters (2021, "BRDF Importance Sampling for Polygonal Lights"), which need no angles within the triangle and lose no digits by cancellation.

use straal_math::simd::Float;
use straal_math::{Vec3, ops};

/// The tangent of half of what is large enough, see [`super::spherical::LEAST`].
const LEAST_TANGENT: f32 = 0.025_005_21;

/// Below this volume of the pyramid of unit edges towards the corners the triangle is seen edge-on, and rounding makes more of its solid angle than the
/// samples gain.
const FLATTEST: f32 = 1e-3;

/// A triangle about a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphericalTriangle<F> {
    /// Unit vectors towards its corners.
    a: Vec3<F>,
    b: Vec3<F>,
    c: Vec3<F>,
    /// Distances of the corners.
    distances: [F; 3],
    /// Six times the volume of the pyramid between the unit vectors.
    volume: F,
    /// 1 + a·b.
    along_ab: F,
    /// a·c + b·c.
    along_c: F,
    /// a·b + b·c + c·a + 1: with the volume, the tangent of half the solid angle (Van Oosterom and Strackee 1983).
    denominator: F,
}

impl<F: Float> SphericalTriangle<F> {
    /// By its corners, seen from `p`.
    #[inline(always)]
    pub fn new(corners: [Vec3<F>; 3], p: Vec3<F>) -> Self {
        let [p0, p1, p2] = corners;
        let (d0, d1, d2) = (p0 - p, p1 - p, p2 - p);
        let distances = [d0.length(), d1.length(), d2.length()];
        let [l0, l1, l2] = distances;
        let (a, b, c) = (d0 * (F::ONE / l0), d1 * (F::ONE / l1), d2 * (F::ONE / l2));
        // By the edges, not the unit vectors: those of a small triangle are all but the same.
        let volume = d0.dot((p1 - p0).cross(p2 - p0)).abs() / (l0 * l1 * l2);
        let (along_ab, along_c) = (F::ONE + a.dot(b), a.dot(c) + b.dot(c));
        Self { a, b, c, distances, volume, along_ab, along_c, denominator: along_ab + along_c }
    }

    /// Where it is large enough to be sampled so.
    #[inline(always)]
    pub fn is_large(&self) -> F::Mask {
        self.volume.gt(F::splat(FLATTEST)) & self.volume.gt(self.denominator * LEAST_TANGENT)
    }

    /// Its solid angle, in sr.
    #[inline(always)]
    pub fn solid_angle(&self) -> F {
        ops::atan2(self.volume, self.denominator) * 2.0
    }

    /// Barycentric weights of corners 1 and 2 by two numbers from 0 to 1: the first cuts off a part of it from the edge between corners 0 and 1, the second
    /// goes from corner 1 to the cut.
    #[inline(always)]
    pub fn sample(&self, solid_angle: F, u: [F; 2]) -> [F; 2] {
        let Self { a, b, c, volume, .. } = *self;
        // The cut part has the corners a, b and the reflection of a about o = `of_a` a + `of_c` c. Of half its solid angle the tangent is
        // det(a, b, o) / (a·o + b·o).
        let (sin, cos) = ops::sin_cos(u[0] * solid_angle * 0.5);
        let (of_a, of_c) = (volume * cos - self.along_c * sin, self.along_ab * sin);
        let o = a * of_a + c * of_c;
        let twice = a.dot(o) * 2.0 / o.length_squared();
        let (of_a, of_c) = (twice * of_a - F::ONE, twice * of_c);
        let cut = a * of_a + c * of_c;
        // The cosine to corner 1 is even from 1 to that of the cut's end; told as how much it lacks to 1.
        let lack = (b - cut).length_squared() * 0.5;
        let part = u[1] * lack;
        let two = F::splat(2.0);
        let of_cut = (u[1] * (two - part) / (two - lack)).max(F::ZERO).sqrt();
        let of_b = (F::ONE - part) - of_cut * (F::ONE - lack);
        // From weights of unit vectors to weights of corners.
        let [l0, l1, l2] = self.distances;
        let weight = |of: F, distance: F| of.max(F::ZERO) / distance;
        let [w0, w1, w2] = [weight(of_cut * of_a, l0), weight(of_b, l1), weight(of_cut * of_c, l2)];
        let all = w0 + w1 + w2;
        [w1 / all, w2 / all]
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Rng, assert_agrees, monte_carlo};
    use super::*;
    use straal_math::{DVec3, ops::atan2_d};

    /// By the angles between its sides (Girard), in double precision.
    fn exact([a, b, c]: [DVec3; 3]) -> f64 {
        let (x, y, z) = (a.cross(b), b.cross(c), c.cross(a));
        let angle = |m: DVec3, n: DVec3| {
            let (m, n) = (m.normalize(), n.normalize());
            atan2_d(m.cross(n).length(), -m.dot(n))
        };
        angle(x, z) + angle(x, y) + angle(y, z) - std::f64::consts::PI
    }

    fn some(rng: &mut Rng) -> ([Vec3; 3], Vec3) {
        let scale = [1e-3, 1.0, 1e4][(rng.f() * 3.0) as usize];
        let at = rng.cube() * (5.0 * scale);
        let corners = [0; 3].map(|_| at + rng.cube() * scale);
        (corners, at + rng.cube() * (1.5 * scale))
    }

    #[test]
    fn the_solid_angle_is_that_between_its_sides() {
        let mut rng = Rng(61);
        let mut tried = 0;
        for _ in 0..3000 {
            let (corners, p) = some(&mut rng);
            let seen = SphericalTriangle::new(corners, p);
            if !seen.is_large() {
                continue;
            }
            tried += 1;
            let want = exact(corners.map(|q| (q.as_dvec3() - p.as_dvec3()).normalize()));
            let got = f64::from(seen.solid_angle());
            // Rounding of 1e-7 over the flattest.
            assert!((got - want).abs() < 1e-3 * want, "{corners:?} from {p:?}: {got}, not {want}");
        }
        assert!(tried > 500, "{tried}");
    }

    /// What is small, or seen edge-on, or no triangle at all is left to sampling by area.
    #[test]
    fn what_is_hardly_seen_is_not_large() {
        let seen = |corners: [Vec3; 3], p| SphericalTriangle::new(corners, p).is_large();
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Y];
        assert!(seen(flat, Vec3::new(0.2, 0.2, 0.1)));
        assert!(!seen(flat, Vec3::new(0.2, 0.2, 100.0)) && !seen(flat, Vec3::new(2.0, 0.2, 0.0)));
        assert!(!seen(flat, Vec3::new(0.2, 0.2, 0.0)) && !seen(flat, Vec3::ZERO));
        let (nan, far) = (Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY));
        for third in [Vec3::X * 2.0, Vec3::X, nan, far] {
            assert!(!seen([Vec3::ZERO, Vec3::X, third], Vec3::new(0.1, 0.3, 0.2)), "{third:?}");
        }
        assert!(!seen(flat, nan) && !seen(flat, far));
    }

    /// The mean of any function over its samples is that over its area, each piece by the solid angle that it has.
    #[test]
    fn directions_are_even() {
        let mut rng = Rng(62);
        let mut tried = 0;
        for round in 0..60 {
            let (corners, p) = some(&mut rng);
            let seen = SphericalTriangle::new(corners, p);
            if !seen.is_large() {
                continue;
            }
            tried += 1;
            let (all, axis) = (seen.solid_angle(), rng.direction());
            let at =
                |[v, w]: [f32; 2]| corners[0] + (corners[1] - corners[0]) * v + (corners[2] - corners[0]) * w;
            let probe = |q: Vec3| 1.0 + f64::from(ops::powi((q - p).normalize().dot(axis), 3));
            let drawn = monte_carlo(round, 10_000, |u| {
                let weights = seen.sample(all, u);
                assert!(
                    weights.iter().all(|w| (0.0..=1.0).contains(w)) && weights[0] + weights[1] <= 1.000_001
                );
                probe(at(weights))
            });
            let n = (corners[1] - corners[0]).cross(corners[2] - corners[0]) * 0.5;
            let by_area = monte_carlo(round + 100, 40_000, |u| {
                let q = at(straal_math::warp::uniform_triangle(u));
                let d = q - p;
                let share = n.dot(d).abs() / (d.length_squared() * d.length() * all);
                f64::from(share) * probe(q)
            });
            assert_agrees("mean", (drawn.0, drawn.1 + by_area.1 + 1e-4), by_area.0);
        }
        assert!(tried > 10, "{tried}");
    }
}
