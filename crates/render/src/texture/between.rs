//! Two colours, and what lies between them: what a pattern of two colours has where a pixel sees some of each.

use straal_color::Light;
use straal_math::ops;

use super::{Reading, ShadingPoint, Value};
use crate::lanes::{Colour, Lanes};

/// The light of two colours, by the share of the second.
pub(super) fn light<L: Lanes>(
    colours: [&Value<Colour>; 2],
    share: f32,
    at: &ShadingPoint,
    reading: &Reading<'_, L>,
) -> Light {
    let [first, second] = colours.map(|colour| reading.eval(colour, at));
    first * (1.0 - share) + second * share
}

/// The same of numbers.
pub(super) fn number<L: Lanes>(
    colours: [&Value<Colour>; 2],
    share: f32,
    at: &ShadingPoint,
    reading: &Reading<'_, L>,
) -> f32 {
    let [first, second] = colours.map(|colour| reading.number(colour, at));
    first * (1.0 - share) + second * share
}

/// What is not exceeded by either.
pub(super) fn most(colours: &[Value<Colour>; 2]) -> f32 {
    ops::max(colours[0].most(), colours[1].most())
}
