//! Surroundings in a square of equal areas, brought to latitude and longitude, as those on a cube are ([`super::cube`]).
//!
//! The square is a disc of equal areas for the half of all directions about +z, folded out to the corners for the other half (Clarberg 2008, "Fast
//! Equal-Area Mapping of the (Hemi)Sphere using SIMD"; pbrt-v4 keeps pictures so). At the equator a pixel of the result is a little smaller than one of
//! the square, and each is the mean of several directions.

use std::f64::consts::FRAC_2_PI;

use straal_math::{DVec3, ops};
use straal_scene::Image;

use super::resampled;

/// The picture in latitude and longitude (the middle column along -z, +x to the right of it, the poles in the middle of the first and last row) of
/// a square one.
pub fn latitude_longitude(image: &Image) -> Image {
    let side = image.width;
    let at = |share: f64| ((share * side as f64) as usize).min(side - 1);
    resampled::latitude_longitude([2 * side, side + 1], |d| {
        let [u, v] = place(d);
        image.pixels[at(v) * side + at(u)].map(f64::from)
    })
}

/// Where in the square a unit vector is shown: u to the right, v down, each from 0 to 1.
fn place(d: DVec3) -> [f64; 2] {
    let [x, y, z] = [d.x.abs(), d.y.abs(), d.z.abs()];
    let r = if z < 1.0 { (1.0 - z).sqrt() } else { 0.0 };
    let phi = if x == 0.0 && y == 0.0 { 0.0 } else { ops::atan2_d(y, x) * FRAC_2_PI };
    let mut v = phi * r;
    let mut u = r - v;
    if d.z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    let sign = |part: f64, of: f64| if of < 0.0 { -part } else { part };
    [0.5 * (sign(u, d.x) + 1.0), 0.5 * (sign(v, d.y) + 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_where_pbrt_has_them() {
        let near = |d: DVec3, want: [f64; 2]| {
            let found = place(d.try_normalize().unwrap());
            assert!((0..2).all(|k| (found[k] - want[k]).abs() < 1e-9), "{d:?}: {found:?}");
        };
        near(DVec3::Z, [0.5, 0.5]);
        near(DVec3::X, [1.0, 0.5]);
        near(DVec3::Y, [0.5, 1.0]);
        near(-DVec3::X, [0.0, 0.5]);
        near(-DVec3::Y, [0.5, 0.0]);
        // Half-way down the upper half: a quarter of all, in half of the square's extent.
        near(DVec3::new(0.75f64.sqrt(), 0.0, 0.5), [0.5 + 0.5 * 0.5f64.sqrt(), 0.5]);
        let [u, v] = place(-DVec3::Z);
        assert!([u, v].iter().all(|w| *w == 0.0 || *w == 1.0));
    }

    #[test]
    fn equal_areas_stay_so() {
        // A quarter of the square, the half-space of x and y above 0.
        let side = 32;
        let lit = |i: usize| {
            let both = i % side >= side / 2 && i / side >= side / 2;
            if both { [1.0; 3] } else { [0.0; 3] }
        };
        let square = Image { width: side, height: side, pixels: (0..side * side).map(lit).collect() };
        let made = latitude_longitude(&square);
        assert_eq!((made.width, made.height), (64, 33));
        let (mut sum, mut all) = (0.0, 0.0);
        for (i, pixel) in made.pixels.iter().enumerate() {
            let (sin, _) = ops::sin_cos_degrees(180.0 * (i / 64) as f64 / 32.0);
            sum += sin * f64::from(pixel[0]);
            all += sin;
        }
        assert!((sum / all - 0.25).abs() < 0.01, "{}", sum / all);
        // +x is a quarter of the way to the right of the middle, and up is +y.
        assert_eq!(made.pixels[8 * 64 + 48], [1.0; 3]);
        assert_eq!(made.pixels[24 * 64 + 48], [0.0; 3]);
        assert_eq!(made.pixels[8 * 64 + 16], [0.0; 3]);
    }
}
