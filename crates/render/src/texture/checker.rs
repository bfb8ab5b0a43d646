//! # Checker
//!
//! Squares of two colours in turn, over the texture coordinates. Where a pixel sees many squares it sees their mean: the pattern is
//! averaged in closed form over the box that holds the footprint, so that it turns into one colour towards the horizon, and doesn't
//! flicker.

use straal_color::Light;
use straal_math::ops;
use straal_scene::desc;

use super::{Maker, Pattern, Reading, ShadingPoint, Use};
use crate::error::CompileError;
use crate::lanes::{Colour, Lanes};

/// Squares of two colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Checker {
    /// The colour of the square next to the origin of the texture coordinates and of every other, and that of the rest.
    pub colours: [Colour; 2],
    /// How many squares there are from 0 to 1, across and up.
    pub squares: [f32; 2],
}

impl Checker {
    /// Of what a scene says.
    pub(super) fn of(d: &desc::Checker, make: &mut Maker<'_, '_>) -> Result<Self, CompileError> {
        Ok(Self {
            colours: [make.colour(&d.first)?, make.colour(&d.second)?],
            squares: d.squares.map(|n| n as f32),
        })
    }

    /// The share of the second colour in what a pixel sees: 0 or 1 where that is a point.
    fn share(&self, at: &ShadingPoint) -> f32 {
        let [a, b] = [0, 1].map(|k| {
            let x = self.squares[k] * at.uv[k];
            odd(x, 0.5 * self.squares[k] * (at.duvdx[k].abs() + at.duvdy[k].abs()))
        });
        // Squares are of the second colour where one of their two numbers is odd, and not both.
        a + b - 2.0 * a * b
    }
}

/// How much of what lies no further than `reach` from `x` is between an odd number and the next.
fn odd(x: f32, reach: f32) -> f32 {
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
        let [first, second] = [0, 1].map(|i| reading.light(&self.colours[i]));
        let share = self.share(at);
        first * (1.0 - share) + second * share
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, _: &Reading<'_, L>) -> f32 {
        let [first, second] = [0, 1].map(|i| self.colours[i].rgb[0]);
        let share = self.share(at);
        first * (1.0 - share) + second * share
    }

    fn most(&self) -> f32 {
        let [a, b] = [0, 1].map(|i| self.colours[i].strength);
        if a > b { a } else { b }
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let colours = [Light::rgb([0.9, 0.5, 0.1]), Light::rgb([0.2, 0.4, 0.3])].map(Colour::from);
        [[8.0, 8.0], [3.0, 0.5], [1.0, 100.0]].map(|squares| Self { colours, squares }).to_vec()
    }
}
