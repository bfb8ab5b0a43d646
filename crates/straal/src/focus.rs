//! Depth of field after the fact: a sharp picture blurred by its depth layer.
//!
//! Each pixel's light is spread over the disc, its circle of confusion, that a thin lens would make of it. That is not
//! what a lens sees (Potmesil and Chakravarty 1981): what is hidden behind the rim of something near is not in the
//! picture, so that blurred foregrounds are opaque at their rims; a pixel whose samples met several surfaces has the mean
//! of their depths; mirrors and glass are as far as their own surface, not what is seen in them; and highlights have
//! the shape of a disc everywhere. A camera with a lens has none of these limits.

use rayon::prelude::*;
use std::fmt;
use std::str::FromStr;
use straal_math::ops;

/// The key of the metadata that tells how strongly the camera magnifies.
pub(crate) const FOCAL_PIXELS: &str = "straal.focal_pixels";

/// Largest radius of a circle of confusion in pixels; what would be blurred more is blurred so much.
pub const LARGEST_RADIUS: f64 = 100.0;

/// A lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Distance in metres, along the axis, at which things are sharp.
    pub focus: f64,
    /// Radius of the lens in metres.
    pub radius: f64,
}

/// A lens and the picture it is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blur {
    /// The lens.
    pub lens: Lens,
    /// Pixels of the whole picture to which a length on a plane in front of the camera is magnified, times the plane's
    /// distance.
    pub focal_pixels: f64,
}

/// Why a picture can't be blurred.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoBlur {
    /// There is no layer to go by.
    #[error("the picture has no layer `depth`, which an EXR of straal has")]
    NoDepth,
}

impl Blur {
    /// Pixels for a whole picture that spans so many degrees from left to right.
    pub fn focal_pixels(width: usize, degrees: f64) -> f64 {
        let (sin, cos) = ops::sin_cos_degrees(0.5 * degrees);
        0.5 * width as f64 * cos / sin
    }

    /// Radius in pixels of the circle of confusion of what lies at `z` in front of the camera; 0 stands for infinity.
    pub fn radius_at(&self, z: f64) -> f64 {
        let Lens { focus, radius } = self.lens;
        // On the plane of focus a point at z covers a disc of radius R |z - f| / z.
        let share = if z > 0.0 { (z - focus).abs() / z } else { 1.0 };
        let pixels = radius * share * self.focal_pixels / focus;
        if pixels < LARGEST_RADIUS { pixels } else { LARGEST_RADIUS }
    }
}

impl fmt::Display for Blur {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "focus={} radius={} focal_pixels={}", self.lens.focus, self.lens.radius, self.focal_pixels)
    }
}

impl FromStr for Lens {
    type Err = String;

    /// `focus=METRES,radius=METRES` in either order.
    fn from_str(text: &str) -> Result<Self, String> {
        let (mut focus, mut radius) = (None, None);
        for word in text.split(',') {
            let (key, value) = word.split_once('=').ok_or_else(|| format!("`{word}` is no key=value"))?;
            let place = match key.trim() {
                "focus" => &mut focus,
                "radius" => &mut radius,
                other => return Err(format!("`{other}` is neither focus nor radius")),
            };
            let metres = value.trim().parse().ok().filter(|v: &f64| *v > 0.0 && *v <= 1e9);
            *place = Some(metres.ok_or_else(|| format!("`{value}` is no length in metres above 0"))?);
        }
        match (focus, radius) {
            (Some(focus), Some(radius)) => Ok(Self { focus, radius }),
            (None, _) => Err("the distance that is sharp is missing: focus=METRES".into()),
            (_, None) => Err("the radius of the lens is missing: radius=METRES".into()),
        }
    }
}

/// A picture that can be blurred.
pub(crate) struct Plane<'a> {
    pub pixels: &'a [[f32; 3]],
    /// Distance from the camera in metres; 0 where nothing was met.
    pub depth: &'a [f32],
    pub width: usize,
    /// Where the axis of the camera meets the picture, in pixels from its upper left corner.
    pub center: [f64; 2],
}

/// A pixel as it is spread.
#[derive(Clone, Copy)]
struct Spread {
    /// Of its circle, in pixels.
    radius: f32,
    /// Along the axis; infinite where nothing was met.
    z: f32,
}

impl Plane<'_> {
    /// Every pixel gathers from those whose circles reach it, each weighed by one over its circle's area. What lies
    /// behind the pixel reaches no farther than the pixel's own circle, so that what is sharp is not covered by what is
    /// behind it.
    pub fn blurred(&self, blur: &Blur) -> Vec<[f32; 3]> {
        let spreads = self.spreads(blur);
        let height = self.pixels.len() / self.width;
        let reach = self.reach(&spreads);
        let rows: Vec<Vec<[f32; 3]>> = (0..height)
            .into_par_iter()
            .map(|y| (0..self.width).map(|x| self.gathered([x, y], &spreads, &reach)).collect())
            .collect();
        rows.concat()
    }

    fn spreads(&self, blur: &Blur) -> Vec<Spread> {
        let spread = |(i, &depth): (usize, &f32)| {
            let x = (i % self.width) as f64 + 0.5 - self.center[0];
            let y = (i / self.width) as f64 + 0.5 - self.center[1];
            let f = blur.focal_pixels;
            // Depth is measured along the ray; focus along the axis.
            let z = f64::from(depth) * f / (f * f + x * x + y * y).sqrt();
            let is_met = z > 0.0 && z.is_finite();
            let radius = blur.radius_at(if is_met { z } else { 0.0 }) as f32;
            Spread { radius, z: if is_met { z as f32 } else { f32::INFINITY } }
        };
        self.depth.iter().enumerate().map(spread).collect()
    }

    /// For blocks of pixels, how far away a circle can be whose pixel reaches into the block: the largest radius of all,
    /// but no more than is near.
    fn reach(&self, spreads: &[Spread]) -> Reach {
        let height = self.pixels.len() / self.width;
        let (columns, rows) = (self.width.div_ceil(BLOCK), height.div_ceil(BLOCK));
        let mut most = vec![0.0_f32; columns * rows];
        for (i, s) in spreads.iter().enumerate() {
            let block = i / self.width / BLOCK * columns + i % self.width / BLOCK;
            most[block] = ops::max(most[block], s.radius);
        }
        let span = (LARGEST_RADIUS as usize).div_ceil(BLOCK) + 1;
        let around = |column: usize, row: usize| {
            let mut reach = 0.0_f32;
            for r in row.saturating_sub(span)..rows.min(row + span + 1) {
                for c in column.saturating_sub(span)..columns.min(column + span + 1) {
                    let gap = |a: usize, b: usize| a.abs_diff(b).saturating_sub(1) * BLOCK;
                    let away = gap(c, column).max(gap(r, row)) as f32;
                    let radius = most[r * columns + c];
                    if radius + 1.0 >= away {
                        reach = ops::max(reach, radius);
                    }
                }
            }
            reach
        };
        let all = (0..columns * rows).map(|i| around(i % columns, i / columns)).collect();
        Reach { columns, all }
    }

    fn gathered(&self, [x, y]: [usize; 2], spreads: &[Spread], reach: &Reach) -> [f32; 3] {
        let height = self.pixels.len() / self.width;
        let own = spreads[y * self.width + x];
        let far = (reach.all[y / BLOCK * reach.columns + x / BLOCK] + 0.5).ceil() as usize;
        let (mut sum, mut weights) = ([0.0_f64; 3], 0.0_f64);
        for v in y.saturating_sub(far)..height.min(y + far + 1) {
            for u in x.saturating_sub(far)..self.width.min(x + far + 1) {
                let i = v * self.width + u;
                let other = spreads[i];
                let radius = if other.z > own.z { ops::min(other.radius, own.radius) } else { other.radius };
                let (dx, dy) = (x.abs_diff(u) as f32, y.abs_diff(v) as f32);
                // A circle's rim is soft over one pixel, and the smallest circle is the pixel itself.
                let cover = ops::clamp(radius + 0.5 - (dx * dx + dy * dy).sqrt(), 0.0, 1.0);
                let light = self.pixels[i];
                if cover > 0.0 && light.iter().all(|c| c.is_finite()) {
                    let size = ops::max(other.radius, 0.5);
                    let weight = f64::from(cover) / f64::from(size * size);
                    weights += weight;
                    for (sum, c) in sum.iter_mut().zip(light) {
                        *sum += weight * f64::from(c);
                    }
                }
            }
        }
        if weights > 0.0 { sum.map(|s| (s / weights) as f32) } else { self.pixels[y * self.width + x] }
    }
}

/// Side of a block of pixels that share a reach.
const BLOCK: usize = 16;

struct Reach {
    columns: usize,
    all: Vec<f32>,
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLUR: Blur = Blur { lens: Lens { focus: 2.0, radius: 0.05 }, focal_pixels: 100.0 };

    fn plane<'a>(pixels: &'a [[f32; 3]], depth: &'a [f32]) -> Plane<'a> {
        Plane { pixels, depth, width: 33, center: [16.5, 16.5] }
    }

    fn point() -> Vec<[f32; 3]> {
        let mut pixels = vec![[0.0; 3]; 33 * 33];
        pixels[16 * 33 + 16] = [1000.0; 3];
        pixels
    }

    #[test]
    fn circles_of_confusion_are_those_of_a_thin_lens() {
        assert_eq!(BLUR.radius_at(2.0), 0.0);
        // At twice the distance half of the lens is covered on the plane of focus: 0.025 m, magnified 50 times.
        assert!((BLUR.radius_at(4.0) - 1.25).abs() < 1e-12);
        assert!((BLUR.radius_at(1.0) - 2.5).abs() < 1e-12);
        assert!((BLUR.radius_at(0.0) - 2.5).abs() < 1e-12, "infinitely far");
        assert_eq!(BLUR.radius_at(1e-9), LARGEST_RADIUS);
        assert!((Blur::focal_pixels(200, 90.0) - 100.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_in_focus_stays() {
        let pixels = point();
        // Depth along the rays to a plane at distance 2.
        let depth: Vec<f32> = (0..33 * 33)
            .map(|i| {
                let (x, y) = ((i % 33) as f32 - 16.0, (i / 33) as f32 - 16.0);
                2.0 * (1e4 + x * x + y * y).sqrt() / 100.0
            })
            .collect();
        for (a, b) in plane(&pixels, &depth).blurred(&BLUR).as_flattened().iter().zip(pixels.as_flattened()) {
            assert!((a - b).abs() < 1e-2, "{a} {b}");
        }
    }

    /// A point far out of focus becomes a disc of the right size that holds all its light, and an even picture stays even.
    #[test]
    fn a_point_becomes_a_disc() {
        let blur = Blur { lens: Lens { focus: 2.0, radius: 0.16 }, ..BLUR };
        let (pixels, nothing) = (point(), vec![0.0; 33 * 33]);
        let out = plane(&pixels, &nothing).blurred(&blur);
        let sum: f32 = out.iter().map(|p| p[0]).sum();
        assert!((sum - 1000.0).abs() < 10.0, "{sum}");
        let lit = out.iter().filter(|p| p[0] > 1.0).count() as f32;
        let want = std::f32::consts::PI * 8.0 * 8.0;
        assert!((lit / want - 1.0).abs() < 0.15, "{lit} pixels, not {want}");
        let even = plane(&vec![[0.5; 3]; 33 * 33], &nothing).blurred(&blur);
        assert!(even.as_flattened().iter().all(|v| (v - 0.5).abs() < 1e-6));
    }

    #[test]
    fn what_is_behind_does_not_cover_what_is_sharp() {
        let mut pixels = vec![[0.0; 3]; 33 * 33];
        let mut depth = vec![0.0; 33 * 33];
        for i in (0..33 * 33).filter(|i| i % 33 < 16) {
            pixels[i] = [1.0; 3];
            depth[i] = 2.0;
        }
        let blur = Blur { focal_pixels: 1e4, lens: Lens { focus: 2.0, radius: 0.001 } };
        let out = plane(&pixels, &depth).blurred(&blur);
        for (i, p) in out.iter().enumerate().filter(|(i, _)| i % 33 < 16) {
            assert!(p[0] > 0.95, "{} {}: {p:?}", i % 33, i / 33);
        }
    }

    #[test]
    fn lenses_are_read() {
        assert_eq!("radius=0.05,focus=2".parse(), Ok(BLUR.lens));
        for wrong in
            ["", "focus=2", "radius=1", "focus=0,radius=1", "focus=2,radius=nan", "f=1,radius=1", "focus"]
        {
            assert!(wrong.parse::<Lens>().is_err(), "{wrong}");
        }
    }
}
