//! From the unit square to the shapes that directions and points are drawn from, each with its density.
//!
//! `u` is always in [0, 1)². Directions are unit vectors about +z and their pdf is per solid angle. Every map keeps
//! neighbours near one another where it can, so that stratified numbers stay stratified. Each maps one point or many side by side
//! ([`crate::simd`]).

use crate::simd::{Float, Mask};
use crate::{Vec3, ops};
use std::f32::consts::{FRAC_1_PI, FRAC_1_SQRT_2, FRAC_PI_4, PI, TAU};

/// A point of the unit disc, evenly by area (pdf 1/pi), without tearing the square apart (Shirley and Chiu 1997, "A
/// Low Distortion Map Between Disk and Square").
#[inline(always)]
pub fn concentric_disc<F: Float>(u: [F; 2]) -> [F; 2] {
    let (a, b) = (u[0] * 2.0 - 1.0, u[1] * 2.0 - 1.0);
    // In the wedges about the x axis the radius is a, in the others b; the angle from the wedge's axis is at
    // most an eighth of a turn.
    let about_x = a.abs().gt(b.abs());
    let (r, across) = (F::select(about_x, a, b), F::select(about_x, b, a));
    // In the middle, where both are 0, any angle will do.
    let turned = F::select(r.eq(F::ZERO), F::ZERO, across / r);
    let (s, c) = ops::sin_cos_eighth(turned * FRAC_PI_4);
    let (along, across) = (r * c, r * s);
    [F::select(about_x, along, across), F::select(about_x, across, along)]
}

/// A point of [`concentric_disc`] with the square of its radius, which rounding leaves at most at 1.
#[inline(always)]
fn disc_and_square<F: Float>(u: [F; 2]) -> ([F; 2], F) {
    let [x, y] = concentric_disc(u);
    let rr = x * x + y * y;
    let inside = rr.le(F::ONE);
    if inside.all() {
        return ([x, y], rr);
    }
    let shrink = F::select(inside, F::ONE, F::ONE / rr.sqrt());
    ([x * shrink, y * shrink], F::select(inside, rr, F::ONE))
}

/// Square root of what rounding may have left a little below 0.
#[inline(always)]
fn safe_sqrt<F: Float>(x: F) -> F {
    x.max(F::ZERO).sqrt()
}

/// A direction of the upper hemisphere in proportion to its cosine. Its z may be 0, where the pdf is 0.
#[inline(always)]
pub fn cosine_hemisphere<F: Float>(u: [F; 2]) -> Vec3<F> {
    let [x, y] = concentric_disc(u);
    Vec3::new(x, y, safe_sqrt(F::ONE - x * x - y * y))
}

/// The density of [`cosine_hemisphere`].
#[inline(always)]
pub fn cosine_hemisphere_pdf<F: Float>(cos_theta: F) -> F {
    cos_theta.max(F::ZERO) * FRAC_1_PI
}

/// Any direction of the upper hemisphere, evenly.
#[inline(always)]
pub fn uniform_hemisphere<F: Float>(u: [F; 2]) -> Vec3<F> {
    // The cosine is 1 - r² over a disc evenly filled, and so is even itself (Archimedes).
    let [x, y] = concentric_disc(u);
    let rr = x * x + y * y;
    let stretch = safe_sqrt(F::splat(2.0) - rr);
    Vec3::new(x * stretch, y * stretch, (F::ONE - rr).max(F::ZERO))
}

/// The density of [`uniform_hemisphere`].
#[inline(always)]
pub fn uniform_hemisphere_pdf<F: Float>(cos_theta: F) -> F {
    F::select(cos_theta.ge(F::ZERO), F::splat(0.5 * FRAC_1_PI), F::ZERO)
}

/// A direction of the upper hemisphere in proportion to a power of its cosine, `exponent` >= 0 (Phong's lobe). Its z may be 0,
/// where the pdf is 0 unless the exponent is.
#[inline(always)]
pub fn cosine_power_hemisphere<F: Float>(u: [F; 2], exponent: F) -> Vec3<F> {
    // The lobe's share within an angle is 1 - cos^(e + 1): the disc's within a radius, r².
    let ([x, y], rr) = disc_and_square(u);
    let power = F::ONE / (exponent + 1.0);
    // By how much the cosine falls from 1, over r²: of -ln(1 - r²) / r² first, then of (1 - exp(-t)) / t, by their series
    // where differences have no digits left. At the rim the logarithm ends.
    let log = F::select(
        rr.lt(F::splat(0.01)),
        rr * (rr * (rr * 0.25 + 1.0 / 3.0) + 0.5) + 1.0,
        -ops::ln((F::ONE - rr).max(F::splat(0.5 * f32::EPSILON))) / rr,
    );
    let t = power * rr * log;
    let share = F::select(
        t.lt(F::splat(0.01)),
        F::ONE - t * (F::splat(0.5) - t * (1.0 / 6.0)),
        (F::ONE - ops::exp(-t)) / t,
    );
    let fall = power * log * share;
    let stretch = safe_sqrt(fall * (F::splat(2.0) - rr * fall));
    Vec3::new(x * stretch, y * stretch, (F::ONE - rr * fall).max(F::ZERO))
}

/// The density of [`cosine_power_hemisphere`].
#[inline(always)]
pub fn cosine_power_hemisphere_pdf<F: Float>(cos_theta: F, exponent: F) -> F {
    let pdf = (exponent + 1.0) * 0.5 * FRAC_1_PI * ops::pow(cos_theta, exponent);
    F::select(cos_theta.lt(F::ZERO), F::ZERO, pdf)
}

/// Any direction, evenly, without tearing the square apart (Clarberg 2008, "Fast Equal-Area Mapping of the (Hemi)Sphere using
/// SIMD"): the diamond within the square becomes the upper half by four concentric maps, the corners fold down to the lower.
#[inline(always)]
pub fn uniform_sphere<F: Float>(u: [F; 2]) -> Vec3<F> {
    let (a, b) = (u[0] * 2.0 - 1.0, u[1] * 2.0 - 1.0);
    let (across, up) = (a.abs(), b.abs());
    // From the diamond's rim inwards; less than 0 in the corners.
    let depth = F::ONE - (across + up);
    let r = F::ONE - depth.abs();
    // From -1 to 1 over a quarter of a turn, 0 in its middle.
    let turned = ops::clamp((up - across) / r, F::splat(-1.0), F::ONE);
    let turned = F::select(r.gt(F::ZERO), turned, F::ZERO);
    let (s, c) = ops::sin_cos_eighth(turned * FRAC_PI_4);
    let rr = r * r;
    let radius = r * FRAC_1_SQRT_2 * safe_sqrt(F::splat(2.0) - rr);
    Vec3::new((radius * (c - s)).copysign(a), (radius * (c + s)).copysign(b), (F::ONE - rr).copysign(depth))
}

/// The density of [`uniform_sphere`].
#[inline(always)]
pub fn uniform_sphere_pdf() -> f32 {
    0.25 * FRAC_1_PI
}

/// Any direction within an angle of +z, evenly. `spread` is 1 - cos of that angle: the cosine itself would lose
/// the size of a narrow cone. In (0, 2].
#[inline(always)]
pub fn uniform_cone<F: Float>(u: [F; 2], spread: F) -> Vec3<F> {
    let ([x, y], rr) = disc_and_square(u);
    let lack = rr * spread;
    let stretch = safe_sqrt(spread * (F::splat(2.0) - lack));
    Vec3::new(x * stretch, y * stretch, F::ONE - lack)
}

/// The density of [`uniform_cone`] inside of the cone.
#[inline(always)]
pub fn uniform_cone_pdf<F: Float>(spread: F) -> F {
    F::ONE / (spread * TAU)
}

/// Barycentric coordinates of a point of a triangle, evenly by area (pdf 1/area): the weights of the second and
/// third corner, the first has the rest (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
#[inline(always)]
pub fn uniform_triangle<F: Float>(u: [F; 2]) -> [F; 2] {
    let half = [u[0] * 0.5, u[1] * 0.5];
    let upper = u[1].gt(u[0]);
    [F::select(upper, half[0], u[0] - half[1]), F::select(upper, u[1] - half[0], half[1])]
}

/// A point between two concentric circles, evenly by area (pdf 1 / (pi (outer² - inner²))).
#[inline(always)]
pub fn uniform_ring<F: Float>(u: [F; 2], inner: F, outer: F) -> [F; 2] {
    let (ii, oo) = (inner * inner, outer * outer);
    let radius = safe_sqrt(ii + u[0] * (oo - ii));
    let (s, c) = ops::sin_cos(u[1] * (2.0 * PI));
    [radius * c, radius * s]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 400;

    /// The midpoints of a grid of SIDE x SIDE, and the square's corners and edges.
    fn square() -> impl Iterator<Item = [f32; 2]> {
        (0..SIDE * SIDE).map(|i| [(i % SIDE) as f32 + 0.5, (i / SIDE) as f32 + 0.5].map(|v| v / SIDE as f32))
    }

    /// The mean of `f` over directions drawn by `draw` must be the integral of f pdf over the sphere.
    #[track_caller]
    fn agrees(draw: impl Fn([f32; 2]) -> Vec3, pdf: impl Fn(Vec3) -> f32) {
        // Functions without symmetry that could hide a wrong turn.
        let probes: [fn(Vec3) -> f64; 4] = [
            |_| 1.0,
            |d| f64::from(d.z),
            |d| f64::from(d.z * d.z + 0.3 * d.x),
            |d| f64::from((d.x + 0.5) * (d.y - 0.25) * (d.z + 1.0)),
        ];
        let mut drawn = [0.0; 4];
        for u in square() {
            let d = draw(u);
            assert!((d.length() - 1.0).abs() < 2e-6, "{u:?}: {d:?}");
            for (sum, probe) in drawn.iter_mut().zip(probes) {
                *sum += probe(d) / f64::from(SIDE * SIDE);
            }
        }
        let mut integral = [0.0; 4];
        let (rings, sectors) = (1600, 400);
        for i in 0..rings * sectors {
            let z = 1.0 - (f64::from(i / sectors) + 0.5) * 2.0 / f64::from(rings);
            let phi = (f64::from(i % sectors) + 0.5) * std::f64::consts::TAU / f64::from(sectors);
            let r = (1.0 - z * z).sqrt();
            let d = Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32);
            let area = 4.0 * std::f64::consts::PI / f64::from(rings * sectors);
            for (sum, probe) in integral.iter_mut().zip(probes) {
                *sum += probe(d) * f64::from(pdf(d)) * area;
            }
        }
        for (a, b) in drawn.into_iter().zip(integral) {
            assert!((a - b).abs() < 3e-3, "drawn {drawn:?}, integrated {integral:?}");
        }
    }

    #[test]
    fn directions_have_their_densities() {
        agrees(cosine_hemisphere, |d| cosine_hemisphere_pdf(d.z));
        agrees(uniform_hemisphere, |d| uniform_hemisphere_pdf(d.z));
        agrees(uniform_sphere, |_| uniform_sphere_pdf());
        for exponent in [0.0, 1.0, 7.5, 60.0] {
            agrees(|u| cosine_power_hemisphere(u, exponent), |d| cosine_power_hemisphere_pdf(d.z, exponent));
        }
        for spread in [0.1, 1.0, 2.0] {
            agrees(
                |u| uniform_cone(u, spread),
                |d| if 1.0 - d.z < spread { uniform_cone_pdf(spread) } else { 0.0 },
            );
        }
    }

    /// Maps neither tear the square nor stretch it much: neighbours stay neighbours. Of maps that keep areas up to a factor
    /// it also follows that none is squeezed much.
    #[test]
    fn warps_have_no_seams() {
        /// The greatest distance that `warp` puts between points of the square, over theirs; for steps of this length.
        fn stretch(warp: impl Fn([f32; 2]) -> Vec3, step: f32) -> f32 {
            let n = (1.0 / step) as u32;
            let at = |i: u32, j: u32| warp([i as f32 * step, j as f32 * step]);
            let mut most = 0.0;
            for j in 0..=n {
                for i in 0..n {
                    for (a, b) in [(at(i, j), at(i + 1, j)), (at(j, i), at(j, i + 1))] {
                        most = ops::max(most, (a - b).length() / step);
                    }
                }
            }
            most
        }
        const STEP: f32 = 1.0 / 512.0;
        // Without any distortion it were the root of the area: 3.5 for the sphere. Polar coordinates have no bound.
        let sphere = stretch(uniform_sphere, STEP);
        assert!(sphere < 2.1 * (4.0 * PI).sqrt(), "{sphere}");
        let hemisphere = stretch(uniform_hemisphere, STEP);
        assert!(hemisphere < 2.1 * TAU.sqrt(), "{hemisphere}");
        for spread in [1e-6_f32, 0.1, 1.0] {
            let cone = stretch(|u| uniform_cone(u, spread), STEP);
            assert!(cone < 2.1 * (TAU * spread).sqrt(), "{spread}: {cone}");
        }
        // At the rim the density is 0, and directions are far apart: as the root of the distance, or a smaller power.
        for exponent in [1.0, 7.5] {
            let power = 1.0 / (exponent + 1.0);
            let near = stretch(|u| cosine_power_hemisphere(u, exponent), STEP) * STEP;
            let bound = 2.5 * ops::pow(4.0 * STEP, if exponent > 1.0 { power } else { 0.5 });
            assert!(near < bound, "{exponent}: {near} {bound}");
            // Away from it they are as near as the lobe is narrow.
            let inner = |u: [f32; 2]| cosine_power_hemisphere(u.map(|v| 0.25 + 0.5 * v), exponent);
            let within = stretch(inner, STEP);
            assert!(within < 2.1 * (0.25 * TAU * power).sqrt() * 2.0, "{exponent}: {within}");
        }
    }

    #[test]
    fn spheres_fold_onto_themselves_at_the_edges_of_the_square() {
        for i in 0..=64_u8 {
            let v = f32::from(i) / 64.0;
            for (a, b) in [([0.0, v], [0.0, 1.0 - v]), ([1.0, v], [1.0, 1.0 - v]), ([v, 0.0], [1.0 - v, 0.0])]
            {
                assert!((uniform_sphere(a) - uniform_sphere(b)).length() < 1e-6, "{a:?}");
            }
        }
        assert_eq!(uniform_sphere([0.5, 0.5]), Vec3::new(0.0, 0.0, 1.0));
        for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
            assert_eq!(uniform_sphere(corner).z, -1.0);
        }
    }

    #[test]
    fn narrow_lobes_are_as_wide_as_their_power_says() {
        // Within the angle where cos^(e + 1) is 3/4 lies a quarter of the lobe, the disc's inner half.
        for exponent in [0.0, 1.0, 100.0, 1e4] {
            let rim = cosine_power_hemisphere([0.5, 0.25], exponent).z;
            let share = 1.0 - ops::pow(rim, exponent + 1.0);
            assert!((share - 0.25).abs() < 2e-3, "{exponent}: {share}");
            // The series near the middle meets the rest.
            let near = |r: f32| cosine_power_hemisphere([0.5, 0.5 - 0.5 * r], exponent);
            for r in [0.0316, 0.0999, 0.3] {
                let (a, b) = (near(r), near(r * 1.01));
                assert!((b.y / a.y - 1.01).abs() < 2e-3, "{exponent}: {a:?} {b:?}");
            }
        }
    }

    #[test]
    fn narrow_cones_stay_cones() {
        let spread = 1e-10;
        let widest = (0..1000).map(|i| uniform_cone([0.0, i as f32 / 1000.0], spread)).fold(0.0, |m, d| {
            let r = d.x.hypot(d.y);
            if r > m { r } else { m }
        });
        assert!((f64::from(widest) / (2e-10_f64).sqrt() - 1.0).abs() < 1e-4);
    }

    #[test]
    fn disc_is_even_and_closed() {
        let mut counts = [[0_u32; 4]; 4];
        for u in square() {
            let [x, y] = concentric_disc(u);
            let rr = x * x + y * y;
            assert!(rr <= 1.0 + 1e-6);
            let turn = y.atan2(x) / TAU + 0.5;
            counts[((rr * 4.0) as usize).min(3)][((turn * 4.0) as usize).min(3)] += 1;
        }
        for c in counts.into_iter().flatten() {
            assert!((f64::from(c) / f64::from(SIDE * SIDE / 16) - 1.0).abs() < 0.02, "{counts:?}");
        }
        assert_eq!(concentric_disc([0.5, 0.5]), [0.0, 0.0]);
        assert!((concentric_disc([0.0, 0.5])[0] + 1.0).abs() < 1e-6);
        assert!((concentric_disc([0.5, 0.0])[1] + 1.0).abs() < 1e-6);
    }

    #[test]
    fn triangle_is_even_and_inside() {
        let mut mean = [0.0; 2];
        let mut product = 0.0;
        for u in square() {
            let [b, c] = uniform_triangle(u);
            assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.0);
            mean[0] += f64::from(b) / f64::from(SIDE * SIDE);
            mean[1] += f64::from(c) / f64::from(SIDE * SIDE);
            product += f64::from(b * c) / f64::from(SIDE * SIDE);
        }
        // Moments of a triangle: 1/3, 1/3, and 1/12 for the product.
        assert!((mean[0] - 1.0 / 3.0).abs() < 1e-3 && (mean[1] - 1.0 / 3.0).abs() < 1e-3, "{mean:?}");
        assert!((product - 1.0 / 12.0).abs() < 1e-3, "{product}");
        for u in [[0.0, 0.0], [0.999_999_94, 0.0], [0.0, 0.999_999_94], [0.999_999_94; 2]] {
            let [b, c] = uniform_triangle(u);
            assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.0);
        }
    }

    #[test]
    fn rings_have_the_radii_they_are_given() {
        let mut mean_square = 0.0;
        for u in square() {
            let [x, y] = uniform_ring(u, 0.5, 2.0);
            let rr = f64::from(x * x + y * y);
            assert!((0.25 - 1e-6..=4.0 + 1e-5).contains(&rr));
            mean_square += rr / f64::from(SIDE * SIDE);
        }
        assert!((mean_square - 0.5 * (0.25 + 4.0)).abs() < 1e-3);
    }
}
