//! The choice of an emitter.

use straal_math::table::Table1;

use super::Emitter;
use super::reach::{Reach, Receiver};
use crate::shape::Geometry;

/// Up to so many lights are weighed at each point.
const FEW: usize = 16;

/// Picks an emitter to sample. Black lights are never picked.
///
/// A few lights are weighed, at each point, by what they would bring if nothing were in the way, each of them getting one part of
/// the steps that probabilities are told in: sixteenths, or sixty-fourths for more than four lights. So a light that lies in
/// shadow can't starve the others, and a set of 64 well-spread samples is dealt out in whole numbers.
///
/// Of many lights, half of the time any that shines is picked, evenly, and half of the time in proportion to an estimate of
/// its power.
#[derive(Clone, Debug)]
pub struct LightTable {
    way: Way,
}

#[derive(Clone, Debug)]
enum Way {
    Nothing,
    /// A single one shines.
    Only(u32),
    Few(Vec<(u32, Reach)>),
    Many(Table1),
}

/// A chosen emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Which.
    pub index: u32,
    /// With which probability, above 0.
    pub pmf: f32,
    /// What is left of the number that chose: uniform in [0, 1) again.
    pub rest: f32,
}

/// The greatest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

impl LightTable {
    /// Bytes that it takes for each of many emitters.
    pub const BYTES: usize = Table1::BYTES;

    /// Bytes that it takes besides, for each, while it is made: powers, what shines, weights.
    pub const MAKING_BYTES: usize = size_of::<f64>() + size_of::<u32>() + size_of::<f32>();

    /// A table of all emitters of a scene of the given radius in m.
    pub fn new(emitters: &[Emitter], geometry: &Geometry, scene_radius: f64) -> Self {
        let powers: Vec<f64> = emitters
            .iter()
            .map(|e| e.power(geometry, scene_radius))
            .map(|w| if w > 0.0 && w.is_finite() { w } else { 0.0 })
            .collect();
        let shining: Vec<u32> = (0..).zip(&powers).filter(|(_, w)| **w > 0.0).map(|(i, _)| i).collect();
        let way = match shining[..] {
            [] => Way::Nothing,
            [only] => Way::Only(only),
            _ if shining.len() <= FEW => {
                let reach = |&i: &u32| Some((i, emitters[i as usize].reach(geometry)?));
                Way::Few(shining.iter().filter_map(reach).collect())
            }
            _ => Self::by_power(&powers, shining.len()),
        };
        Self { way }
    }

    fn by_power(powers: &[f64], shining: usize) -> Way {
        let total: f64 = powers.iter().sum();
        let weight = |w: &f64| if *w > 0.0 { (0.5 / shining as f64 + 0.5 * (w / total)) as f32 } else { 0.0 };
        Table1::new(&powers.iter().map(weight).collect::<Vec<_>>()).map_or(Way::Nothing, Way::Many)
    }

    /// Picks for a point by `u` in [0, 1); `None` when nothing shines on it.
    #[inline]
    pub fn pick(&self, u: f32, at: &Receiver) -> Option<Pick> {
        match &self.way {
            Way::Nothing => None,
            Way::Only(index) => Some(Pick { index: *index, pmf: 1.0, rest: u }),
            Way::Few(lights) => pick_of_few(lights, u, at),
            Way::Many(table) => {
                let choice = table.sample(u);
                Some(Pick { index: choice.index as u32, pmf: choice.pmf, rest: choice.rest })
            }
        }
    }

    /// The probability with which an emitter is picked for a point.
    #[inline]
    pub fn pmf(&self, index: u32, at: &Receiver) -> f32 {
        match &self.way {
            Way::Nothing => 0.0,
            Way::Only(only) => f32::from(u8::from(*only == index)),
            Way::Few(lights) => {
                let Some(place) = lights.iter().position(|(i, _)| *i == index) else { return 0.0 };
                let shares = Shares::of(lights, at);
                f32::from(shares.each[place]) / f32::from(shares.steps)
            }
            Way::Many(table) => table.pmf(index as usize),
        }
    }
}

/// Out of line: where a single light shines none of it is needed.
#[inline(never)]
fn pick_of_few(lights: &[(u32, Reach)], u: f32, at: &Receiver) -> Option<Pick> {
    let shares = Shares::of(lights, at);
    let steps = f32::from(shares.steps);
    // Exact: the steps are a power of two.
    let place = u * steps;
    let mut first = 0.0;
    for ((index, _), &share) in lights.iter().zip(&shares.each) {
        let width = f32::from(share);
        if place < first + width {
            let rest = (place - first) / width;
            let rest = if rest < BELOW_ONE { rest } else { BELOW_ONE };
            return Some(Pick { index: *index, pmf: width / steps, rest });
        }
        first += width;
    }
    None
}

/// Probabilities in whole steps.
struct Shares {
    steps: u8,
    /// By light; their sum is `steps`, or 0 when none shines there.
    each: [u8; FEW],
}

impl Shares {
    #[inline]
    fn of(lights: &[(u32, Reach)], at: &Receiver) -> Self {
        let mut weights = [0.0; FEW];
        let (mut total, mut count) = (0.0, 0_u8);
        for (weight, (_, reach)) in weights.iter_mut().zip(lights) {
            let w = reach.estimate(at);
            // On a light of no size anything is infinite.
            *weight = if w > 0.0 { if w < 1e30 { w } else { 1e30 } } else { 0.0 };
            total += *weight;
            count += u8::from(*weight > 0.0);
        }
        let steps = if lights.len() <= 4 { 16 } else { 64 };
        let mut each = [0; FEW];
        let shared = f32::from(steps - count);
        let (mut sum, mut before) = (0.0, 0_u8);
        let mut last = 0;
        for (i, (share, &weight)) in each.iter_mut().zip(&weights).enumerate() {
            if weight > 0.0 {
                // One step, and of the others its part, by rounding the running sum.
                sum += weight;
                let now = (shared * (sum / total) + 0.5) as u8;
                *share = 1 + now - before;
                (before, last) = (now, i);
            }
        }
        if count > 0 {
            // Should rounding have left a step over.
            each[last] += steps - count - before;
        }
        Self { steps, each }
    }
}
