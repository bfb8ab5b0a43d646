//! # Checker
//!
//! Squares of two colours in turn, over the texture coordinates. Where a pixel sees many squares it sees their mean: the pattern is
//! averaged in closed form over the box that holds the footprint, so that it turns into one colour towards the horizon, and doesn't
//! flicker.

use straal_color::Light;
use straal_math::ops;
use straal_scene::desc;

use super::{Maker, Mapping, Pattern, Reading, ShadingPoint, Use, Value, between};
use crate::lanes::{Colour, Lanes};
use crate::shape::TriangleMesh;

/// Squares of two colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Checker {
    /// The colour of the square next to the origin of the texture coordinates and of every other, and that of the rest.
    pub colours: [Value<Colour>; 2],
    /// How many squares there are from 0 to 1, across and up.
    pub squares: [f32; 2],
    /// Whether they are averaged over what a pixel sees.
    pub averaged: bool,
    /// How they lie on the surface.
    pub mapping: Mapping,
}

impl Checker {
    /// Of what a scene says.
    pub(super) fn of(d: &desc::Checker, make: &mut dyn Maker) -> Self {
        let colours = [make.part(&d.first), make.part(&d.second)];
        Self {
            colours,
            squares: d.squares.map(|n| n as f32),
            averaged: d.averaged,
            mapping: make.mapping(&d.mapping),
        }
    }

    /// The share of the second colour in what a pixel sees: 0 or 1 where that is a point.
    fn share(&self, at: &ShadingPoint, meshes: &[TriangleMesh]) -> f32 {
        let [share] = self.mapping.over(at, meshes, |spot| {
            let [a, b] = [0, 1].map(|k| {
                let x = self.squares[k] * spot.st[k];
                let seen = if self.averaged { spot.dx[k].abs() + spot.dy[k].abs() } else { 0.0 };
                odd(x, 0.5 * self.squares[k] * seen)
            });
            // Squares are of the second colour where one of their two numbers is odd, and not both.
            [a + b - 2.0 * a * b]
        });
        share
    }
}

/// How much of what lies no further than `reach` from `x` is between an odd number and the next.
pub(super) fn odd(x: f32, reach: f32) -> f32 {
    // From 0 up to a number.
    let up_to = |x: f32| {
        let pairs = (0.5 * x).floor();
        let rest = x - 2.0 * pairs - 1.0;
        pairs + if rest > 0.0 { rest } else { 0.0 }
    };
    let (from, to) = (x - reach, x + reach);
    // Rounding has taken most digits of what is narrower.
    if to - from <= 256.0 * f32::EPSILON * (1.0 + x.abs()) {
        return if x.floor().rem_euclid(2.0) == 1.0 { 1.0 } else { 0.0 };
    }
    ops::clamp((up_to(to) - up_to(from)) / (to - from), 0.0, 1.0)
}

impl Pattern for Checker {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        between::light(self.colours.each_ref(), self.share(at, reading.meshes), at, reading)
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        between::number(self.colours.each_ref(), self.share(at, reading.meshes), at, reading)
    }

    fn most(&self) -> f32 {
        between::most(&self.colours)
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let colours = [Light::rgb([0.9, 0.5, 0.1]), Light::rgb([0.2, 0.4, 0.3])].map(Value::from);
        let of = |squares| Self { colours, squares, averaged: true, mapping: Mapping::Coordinates };
        [[8.0, 8.0], [3.0, 0.5], [1.0, 100.0]].map(of).to_vec()
    }
}
