//! Round discs as they are seen from a point: an ellipse on the sphere around it (Guillén and others 2017, "Area-Preserving Parameterizations for Spherical
//! Ellipses"). Their maps are even, but ask for elliptic integrals and a search for each sample. This one has neither: the angle about the cone's axis is drawn as
//! that of an ellipse, and the cosine to the axis evenly up to the rim. Its density is exact, and all but even.

use std::f32::consts::TAU;
use straal_math::simd::Float;
use straal_math::{DVec3, Vec3, warp};

use super::patch::Patch;
use super::spherical::LEAST;

/// Nearer to its plane than this share of its radius a disc is sampled by area: single precision can't tell there how far away a piece of it is.
const NEAREST: f32 = 1e-3;

/// The cone that a round disc fills about a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct SphericalEllipse<F> {
    /// Unit vectors: x in the disc's plane towards its middle, y in it as well, z across it and away from the point.
    x: Vec3<F>,
    y: Vec3<F>,
    z: Vec3<F>,
    /// From the point to the disc's plane, and from there along x to its middle.
    height: F,
    offset: F,
    radius: F,
    /// The cone's axis: the sine and cosine of its angle to z, towards x.
    axis: [F; 2],
    /// Of the ellipse that the cone cuts out of a plane across its axis at a distance of 1, the squares of the half-axes: in the plane of x and z, and along y.
    squares: [F; 2],
    /// Half-axes of the ellipse by which angles about the axis are drawn. Their squares are what the cosines to the cone's rim lack to 1 along both, so that
    /// there the density is that of all.
    half: [F; 2],
}

impl<F: Float> SphericalEllipse<F> {
    /// A patch whose axes are at right angles and of the same length, seen from `p`.
    #[inline(always)]
    pub fn new(patch: &Patch, p: Vec3<F>) -> Self {
        let length = patch.a.length();
        let d = DVec3::uniform(patch.origin) - p.to_double();
        let above: F = F::from_double(d.dot(DVec3::uniform(patch.n)));
        let n = Vec3::uniform(patch.n.as_vec3());
        let z = Vec3::select(above.lt(F::ZERO), -n, n);
        let (height, radius) = (above.abs(), F::splat(length as f32));
        let flat = Vec3::from_double(d) - n * above;
        let (x, there) = flat.normalize_checked();
        // Straight above the middle any direction will do.
        let x = Vec3::select(there, x, Vec3::uniform((patch.a * (1.0 / length)).as_vec3()));
        let offset = F::select(there, flat.dot(x), F::ZERO);
        // The cone is (h x - D z)² + h² y² = R² z². Of its part in x and z one eigenvalue is above 0, `plus`, and one below, -`minus`, and their
        // product is -(h R)²: the larger is a sum without cancellation, and the other follows.
        let (hh, hr) = (height * height, height * radius);
        let trace = hh + (offset - radius) * (offset + radius);
        let larger = ((trace * trace + hr * hr * 4.0).sqrt() + trace.abs()) * 0.5;
        let smaller = hr * hr / larger;
        let is_wide = trace.lt(F::ZERO);
        let (plus, minus) = (F::select(is_wide, smaller, larger), F::select(is_wide, larger, smaller));
        let (sin, cos) = (height * offset, hh + minus);
        let scale = F::ONE / (sin * sin + cos * cos).sqrt();
        let squares = [minus / plus, minus / hh];
        let half = [lack(squares[0]).sqrt(), lack(squares[1]).sqrt()];
        Self { x, y: z.cross(x), z, height, offset, radius, axis: [sin * scale, cos * scale], squares, half }
    }

    /// Where it is large enough to be sampled so.
    #[inline(always)]
    pub fn is_large(&self) -> F::Mask {
        // The solid angle of a round cone, and nearly that of others.
        let about = self.half[0] * self.half[1] * TAU;
        about.gt(F::splat(LEAST)) & self.height.gt(self.radius * NEAREST)
    }

    /// The density by solid angle of directions about the axis that go so much along the two half-axes; and what the cosine to the rim lacks to 1 there.
    #[inline(always)]
    fn density(&self, [along, across]: [F; 2]) -> [F; 2] {
        let ([a, b], [e, f]) = (self.squares, self.half);
        let (c, s) = (along * along, across * across);
        let all = c + s;
        let is_axis = all.eq(F::ZERO);
        let (c, all) = (F::select(is_axis, F::ONE, c), F::select(is_axis, F::ONE, all));
        let rim = lack(a * b * all / (b * c + a * s));
        let by_angle = e * f * all / ((f * f * c + e * e * s) * TAU);
        [by_angle / rim, rim]
    }

    /// Coordinates of the patch, in the unit disc, by two numbers from 0 to 1; and the density by solid angle.
    #[inline(always)]
    pub fn sample(&self, patch: &Patch, u: [F; 2]) -> ([F; 2], F) {
        let [x, y] = warp::concentric_disc(u);
        let ways = [x * self.half[0], y * self.half[1]];
        let [pdf, rim] = self.density(ways);
        let rr = (x * x + y * y).min(F::ONE);
        let lack = rr * rim;
        let sine = (lack * (F::splat(2.0) - lack)).max(F::ZERO).sqrt();
        let length = (ways[0] * ways[0] + ways[1] * ways[1]).sqrt();
        let scale = F::select(length.gt(F::ZERO), sine / length, F::ZERO);
        let (along, across, up) = (ways[0] * scale, ways[1] * scale, F::ONE - lack);
        // Back from the axis of the cone to that of the disc, and on to its plane.
        let [sin, cos] = self.axis;
        let per_height = self.height / (up * cos - along * sin);
        let (x, y) = ((up * sin + along * cos) * per_height - self.offset, across * per_height);
        // Rounding must not leave the disc.
        let rr = x * x + y * y;
        let shrink = F::select(rr.gt(self.radius * self.radius), self.radius / rr.sqrt(), F::ONE);
        let q = self.x * (x * shrink) + self.y * (y * shrink);
        let per = F::ONE / (self.radius * self.radius);
        let of = |axis: DVec3| q.dot(Vec3::uniform(axis.as_vec3())) * per;
        ([of(patch.a), of(patch.b)], pdf)
    }

    /// The density of [`Self::sample`] by solid angle in a direction of any length.
    #[inline(always)]
    pub fn pdf(&self, w: Vec3<F>) -> F {
        let [sin, cos] = self.axis;
        let along = w.dot(self.x) * cos - w.dot(self.z) * sin;
        self.density([along, w.dot(self.y)])[0]
    }
}

/// What a cosine lacks to 1, by the square of the tangent.
#[inline(always)]
fn lack<F: Float>(square: F) -> F {
    let secant = square + 1.0;
    square / (secant + secant.sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::tests::Rng;
    use super::*;

    /// However it is seen, the density is that of all directions alike but for a fifth.
    #[test]
    fn the_density_is_all_but_even() {
        let mut rng = Rng(71);
        let (mut furthest, mut tried) = (0.0_f32, 0);
        for _ in 0..20_000 {
            let patch = Patch::new(Vec3::ZERO, Vec3::X, Vec3::Z);
            let near = [0.003, 0.1, 1.0][(rng.f() * 3.0) as usize];
            let p = Vec3::new(rng.f() * 3.0, near * (0.1 + rng.f()), rng.f() * 3.0);
            let seen = SphericalEllipse::new(&patch, p);
            if !seen.is_large() {
                continue;
            }
            tried += 1;
            // The mean density over what is drawn is one over the solid angle.
            let pdfs: Vec<f32> = (0..64).map(|_| seen.sample(&patch, rng.square()).1).collect();
            let (least, most) = pdfs.iter().fold((f32::INFINITY, 0.0_f32), |(a, b), v| {
                (if *v < a { *v } else { a }, if *v > b { *v } else { b })
            });
            let off = most / least;
            furthest = if off > furthest { off } else { furthest };
        }
        assert!(tried > 3000 && furthest < 1.5 && furthest > 1.01, "{furthest} in {tried}");
    }

    /// What a point is drawn with is what its direction is told to have.
    #[test]
    fn points_have_the_density_of_their_directions() {
        let mut rng = Rng(72);
        for scale in [1e-3_f32, 1.0, 1e4] {
            let turn = straal_math::Frame::from_normal(rng.direction());
            let patch = Patch::new(rng.cube() * scale, turn.s * scale, turn.t * scale);
            for _ in 0..2000 {
                let p = patch.origin.as_vec3() + rng.cube() * (2.0 * scale);
                let seen = SphericalEllipse::new(&patch, p);
                if !seen.is_large() {
                    continue;
                }
                let ([x, y], pdf) = seen.sample(&patch, rng.square());
                assert!(x * x + y * y < 1.000_001 && pdf > 0.0, "{x} {y} {pdf}");
                let q = patch.origin + patch.a * f64::from(x) + patch.b * f64::from(y);
                let told = seen.pdf((q - p.as_dvec3()).as_vec3());
                assert!((told / pdf - 1.0).abs() < 2e-3, "{p:?} {x} {y}: {told}, not {pdf}");
            }
        }
    }

    /// Edge-on, far away, within its plane, and what is no place at all.
    #[test]
    fn what_is_hardly_seen_is_not_large() {
        let patch = Patch::new(Vec3::ZERO, Vec3::X, Vec3::Y);
        let large = |p: Vec3| SphericalEllipse::new(&patch, p).is_large();
        assert!(large(Vec3::new(0.0, 0.0, 0.5)) && large(Vec3::new(0.3, 0.2, -0.01)));
        assert!(large(Vec3::new(1.5, 0.0, 0.5)));
        for p in [[0.0, 0.0, 30.0], [0.3, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, 1e-6], [f32::NAN; 3]] {
            assert!(!large(Vec3::from_array(p)), "{p:?}");
        }
        assert!(!large(Vec3::splat(f32::INFINITY)));
    }
}
