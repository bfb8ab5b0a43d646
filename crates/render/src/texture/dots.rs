//! # Dots
//!
//! Discs of one colour on another, one in about half of the squares of a grid and each somewhat beside its middle, as noise has it (pbrt's `dots`). Where a pixel sees a part
//! of them it sees the exact mean over the box that holds its footprint; where it sees very many, the mean of all.

use std::f32::consts::{FRAC_PI_2, PI};

use straal_color::Light;
use straal_math::{Vec3, ops};
use straal_scene::desc;

use super::perlin::noise;
use super::{Maker, Mapping, Pattern, Reading, ShadingPoint, Spot, Use, Value, between};
use crate::lanes::{Colour, Lanes};
use crate::shape::TriangleMesh;

/// A dot's radius.
const RADIUS: f32 = 0.35;
/// How far from the middle of its square it may be.
const ASIDE: f32 = 0.5 - RADIUS;
/// Squares in a direction, beyond which all dots are seen as one.
const MANY: f32 = 8.0;

/// Discs of one colour on another.
#[derive(Clone, Debug, PartialEq)]
pub struct Dots {
    /// Of the dots, and of what is around them.
    pub colours: [Value<Colour>; 2],
    /// How they lie on the surface.
    pub mapping: Mapping,
}

impl Dots {
    pub(super) fn of(d: &desc::DotsTexture, make: &mut dyn Maker) -> Self {
        Self { colours: [make.part(&d.inside), make.part(&d.outside)], mapping: make.mapping(&d.mapping) }
    }

    /// The share of dots in what a pixel sees.
    fn share(&self, at: &ShadingPoint, meshes: &[TriangleMesh]) -> f32 {
        let [share] = self.mapping.over(at, meshes, |spot| [seen(spot)]);
        share
    }
}

fn seen(spot: &Spot) -> f32 {
    let half = [0, 1].map(|k| 0.5 * (spot.dx[k].abs() + spot.dy[k].abs()));
    let [s, t] = spot.st;
    if half.iter().any(|h| 2.0 * h > MANY) {
        return 0.5 * PI * RADIUS * RADIUS;
    }
    let first = [s - half[0], t - half[1]].map(|v| (v + 0.5).floor());
    let last = [s + half[0], t + half[1]].map(|v| (v + 0.5).floor());
    // Rounding has taken most digits of what is narrower.
    let is_point = half[0] * half[1] < 1e-5;
    let mut sum = 0.0;
    let (mut x, mut y) = (first[0], first[1]);
    while y <= last[1] {
        if let Some([cs, ct]) = dot(x, y) {
            if is_point {
                let (ds, dt) = (s - cs, t - ct);
                sum += if ds * ds + dt * dt < RADIUS * RADIUS { 1.0 } else { 0.0 };
            } else {
                let corner = |i: f32, j: f32| {
                    up_to([(s + i * half[0] - cs) / RADIUS, (t + j * half[1] - ct) / RADIUS])
                };
                let covered = corner(1.0, 1.0) - corner(-1.0, 1.0) - corner(1.0, -1.0) + corner(-1.0, -1.0);
                sum += covered * RADIUS * RADIUS / (4.0 * half[0] * half[1]);
            }
        }
        x += 1.0;
        if x > last[0] {
            (x, y) = (first[0], y + 1.0);
        }
        // Numbers so large that 1 more is the same.
        if x + 1.0 == x || y + 1.0 == y {
            break;
        }
    }
    ops::clamp(sum, 0.0, 1.0)
}

/// The middle of a square's dot, if it has one.
fn dot(x: f32, y: f32) -> Option<[f32; 2]> {
    let flat = |s: f32, t: f32| noise(Vec3::new(s, t, 0.5));
    let middle = || [x + ASIDE * flat(x + 1.5, y + 2.8), y + ASIDE * flat(x + 4.5, y + 9.8)];
    (flat(x + 0.5, y + 0.5) > 0.0).then(middle)
}

/// The area of the unit disc where neither coordinate is above that of a point.
fn up_to([x, y]: [f32; 2]) -> f32 {
    let (x, y) = (ops::clamp(x, -1.0, 1.0), ops::clamp(y, -1.0, 1.0));
    // Below the half circle, from its middle to t.
    let below = |t: f32| 0.5 * (t * ops::max(1.0 - t * t, 0.0).sqrt() + FRAC_PI_2 - ops::acos(t));
    // Where the line at y leaves the disc.
    let c = ops::max(1.0 - y * y, 0.0).sqrt();
    let within = ops::clamp(x, -c, c);
    let cut = y * (within + c) + below(within) - below(-c);
    if y <= 0.0 {
        return cut;
    }
    let whole = |from: f32, to: f32| 2.0 * (below(to) - below(from));
    cut + whole(-1.0, ops::min(x, -c)) + whole(c, ops::max(x, c))
}

impl Pattern for Dots {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        between::light([&self.colours[1], &self.colours[0]], self.share(at, reading.meshes), at, reading)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        between::number([&self.colours[1], &self.colours[0]], self.share(at, reading.meshes), at, reading)
    }

    fn most(&self) -> f32 {
        between::most(&self.colours)
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let colours = [Light::rgb([0.9, 0.5, 0.1]), Light::rgb([0.2, 0.4, 0.3])].map(Value::from);
        vec![Self { colours, mapping: Mapping::Coordinates }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_cut_by_a_corner() {
        for (x, y, want) in [
            (2.0, 2.0, PI),
            (0.0, 2.0, 0.5 * PI),
            (2.0, 0.0, 0.5 * PI),
            (0.0, 0.0, 0.25 * PI),
            (-2.0, 2.0, 0.0),
            (2.0, -1.0, 0.0),
            // Half of the disc's half, and a square with what is left of it.
            (0.5, 0.5, 0.25 * PI + 0.25 + 2.0 * 0.5 * (0.5 * 0.75_f32.sqrt() + PI / 6.0)),
        ] {
            let got = up_to([x, y]);
            assert!((got - want).abs() < 1e-5, "{x} {y}: {got}, not {want}");
        }
    }
}
