//! Surroundings of any layout, brought to latitude and longitude.

use straal_math::{DVec3, ops};
use straal_scene::Image;

/// Directions for each pixel, across and down.
const DIRECTIONS: usize = 4;

/// The picture in latitude and longitude (the middle column along -z, +x to the right of it, the poles in the middle of the first and last row), of
/// so many columns and rows, of what is seen in each direction. Each pixel is the mean of several directions.
pub fn latitude_longitude([width, height]: [usize; 2], seen: impl Fn(DVec3) -> [f64; 3]) -> Image {
    let part = |k: usize| (k as f64 + 0.5) / DIRECTIONS as f64 - 0.5;
    let longitudes: Vec<(f64, f64)> = (0..width * DIRECTIONS)
        .map(|i| {
            let place = (i / DIRECTIONS) as f64 + 0.5 + part(i % DIRECTIONS);
            ops::sin_cos_degrees(360.0 * (place / width as f64 - 0.5))
        })
        .collect();
    let mut pixels = Vec::with_capacity(width * height);
    for j in 0..height {
        let latitudes: [(f64, f64); DIRECTIONS] =
            std::array::from_fn(|k| ops::sin_cos_degrees(180.0 * (j as f64 + part(k)) / (height - 1) as f64));
        // By the solid angle about each, which near a pole differs from one to the next.
        let all: f64 = latitudes.iter().map(|(sin, _)| sin.abs()).sum::<f64>() * DIRECTIONS as f64;
        for i in 0..width {
            let mut sum = [0.0_f64; 3];
            for (sin, cos) in latitudes {
                for (s, c) in &longitudes[i * DIRECTIONS..][..DIRECTIONS] {
                    let light = seen(DVec3::new(sin * s, cos, -sin * c));
                    for k in 0..3 {
                        sum[k] += light[k] * (sin.abs() / all);
                    }
                }
            }
            pixels.push(sum.map(|v| v as f32));
        }
    }
    Image { width, height, pixels }
}
