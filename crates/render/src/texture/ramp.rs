//! # Ramp
//!
//! A colour for each number: those of a list of stops, and what lies between them.

use std::sync::Arc;

use straal_color::Light;
use straal_math::ops;
use straal_scene::desc::{self, RampInterpolation};

use super::{Maker, Pattern, Reading, ShadingPoint, Use, Value};
use crate::lanes::{Colour, Lanes};

/// Colours along a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// Where on it.
    pub of: Value<f32>,
    /// Rising numbers and their colours; at least one.
    pub stops: Arc<[(f32, Colour)]>,
    /// What lies between them.
    pub between: Between,
}

/// What lies between two stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// The lower one.
    Step,
    /// A straight line.
    Linear,
    /// 3x² - 2x³, which is level at the stops.
    Smooth,
}

impl Ramp {
    pub(super) fn of(d: &desc::RampTexture, make: &mut dyn Maker) -> Self {
        let mut stops = Vec::with_capacity(d.stops.len());
        for stop in &d.stops {
            stops.push((stop.at as f32, make.colour(&stop.color)));
        }
        // Validation has seen one.
        if stops.is_empty() {
            stops.push((0.0, Colour::default()));
        }
        let between = match d.interpolation {
            RampInterpolation::Step => Between::Step,
            RampInterpolation::Linear => Between::Linear,
            RampInterpolation::Smooth => Between::Smooth,
        };
        Self { of: make.number(&d.of), stops: stops.into(), between }
    }

    /// The stops at both sides of a number, and the share of the second.
    fn place(&self, v: f32) -> (usize, usize, f32) {
        let above = self.stops.partition_point(|(at, _)| *at <= v);
        let last = self.stops.len() - 1;
        if above == 0 || above > last {
            let end = above.min(last);
            return (end, end, 0.0);
        }
        let (low, high) = (self.stops[above - 1].0, self.stops[above].0);
        let x = ops::clamp((v - low) / (high - low), 0.0, 1.0);
        let share = match self.between {
            Between::Step => 0.0,
            Between::Linear => x,
            Between::Smooth => x * x * (3.0 - 2.0 * x),
        };
        (above - 1, above, share)
    }
}

impl Pattern for Ramp {
    fn light<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>, _: Use) -> Light {
        let (a, b, share) = self.place(reading.eval(&self.of, at));
        let [a, b] = [a, b].map(|i| reading.light(&self.stops[i].1));
        a * (1.0 - share) + b * share
    }

    fn number<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        let (a, b, share) = self.place(reading.eval(&self.of, at));
        let [a, b] = [a, b].map(|i| self.stops[i].1.rgb[0]);
        a * (1.0 - share) + b * share
    }

    fn most(&self) -> f32 {
        self.stops.iter().map(|(_, colour)| colour.strength).fold(0.0, ops::max)
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let colour = |rgb| Colour::from(Light::rgb(rgb));
        let stops: Arc<[_]> = [(0.2, colour([0.1, 0.2, 0.3])), (0.7, colour([0.9, 0.5, 0.0]))].into();
        let of = |v: f32, between| Self { of: v.into(), stops: stops.clone(), between };
        vec![
            of(0.3, Between::Linear),
            of(0.0, Between::Step),
            of(0.65, Between::Smooth),
            of(2.0, Between::Linear),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::in_rgb;

    #[test]
    fn colours_lie_between_their_stops() {
        let grey = |v: f32| Colour::from(Light::rgb([v; 3]));
        let ramp = |v: f32, between| {
            let stops: Arc<[_]> =
                [(0.0, grey(0.0)), (0.5, grey(1.0)), (0.5, grey(0.2)), (1.0, grey(0.4))].into();
            Ramp { of: v.into(), stops, between }.number(&ShadingPoint::NOWHERE, &in_rgb())
        };
        for (v, linear, step, smooth) in [
            (-1.0, 0.0, 0.0, 0.0),
            (0.125, 0.25, 0.0, 0.156_25),
            (0.5, 0.2, 0.2, 0.2),
            (0.75, 0.3, 0.2, 0.3),
            (9.0, 0.4, 0.4, 0.4),
        ] {
            let got = [Between::Linear, Between::Step, Between::Smooth].map(|between| ramp(v, between));
            for (got, want) in got.into_iter().zip([linear, step, smooth]) {
                assert!((got - want).abs() < 1e-6, "{v}: {got}, not {want}");
            }
        }
    }
}
