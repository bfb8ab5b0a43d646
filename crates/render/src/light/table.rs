//! The choice of an emitter.

use straal_math::simd::{Float, Uint};
use straal_math::table::{Choices, Table1};

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
    /// By power, for rays that leave lights.
    by_power: Option<Table1>,
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

/// Chosen emitters, side by side.
#[derive(Clone, Copy, Debug)]
pub struct Picks<F: Float> {
    /// Which.
    pub index: F::Uint,
    /// With which probability; 0 where nothing shines.
    pub pmf: F,
    /// What is left of the numbers that chose.
    pub rest: F,
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
        // Relative to the strongest, so that single precision holds them.
        let most = powers.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        let relative: Vec<f32> = powers.iter().map(|&w| (w / most) as f32).collect();
        Self { way, by_power: Table1::new(&relative) }
    }

    fn by_power(powers: &[f64], shining: usize) -> Way {
        let total: f64 = powers.iter().sum();
        let weight = |w: &f64| if *w > 0.0 { (0.5 / shining as f64 + 0.5 * (w / total)) as f32 } else { 0.0 };
        Table1::new(&powers.iter().map(weight).collect::<Vec<_>>()).map_or(Way::Nothing, Way::Many)
    }

    /// Picks the light that a ray is to leave, by power; `None` when nothing shines.
    pub fn pick_by_power(&self, u: f32) -> Option<Pick> {
        let choice = self.by_power.as_ref()?.sample(u);
        Some(Pick { index: choice.index as u32, pmf: choice.pmf, rest: choice.rest })
    }

    /// Picks for a point by `u` in [0, 1); `None` when nothing shines on it.
    #[inline]
    pub fn pick(&self, u: f32, at: &Receiver) -> Option<Pick> {
        let Picks { index, pmf, rest } = self.picks(u, at);
        (pmf > 0.0).then_some(Pick { index, pmf, rest })
    }

    /// [`Self::pick`] for many points side by side.
    #[inline(always)]
    pub fn picks<F: Float>(&self, u: F, at: &Receiver<F>) -> Picks<F> {
        match &self.way {
            Way::Nothing => Picks { index: F::Uint::splat(0), pmf: F::ZERO, rest: u },
            Way::Only(index) => Picks { index: F::Uint::splat(*index), pmf: F::ONE, rest: u },
            Way::Few(lights) => picks_of_few(lights, u, at),
            Way::Many(table) => {
                let Choices { index, pmf, rest } = table.samples(u);
                Picks { index, pmf, rest }
            }
        }
    }

    /// The probability with which an emitter is picked for a point.
    #[inline]
    pub fn pmf(&self, index: u32, at: &Receiver) -> f32 {
        self.pmfs(index, at)
    }

    /// [`Self::pmf`] for many points side by side.
    #[inline(always)]
    pub fn pmfs<F: Float>(&self, index: u32, at: &Receiver<F>) -> F {
        match &self.way {
            Way::Nothing => F::ZERO,
            Way::Only(only) => F::splat(f32::from(u8::from(*only == index))),
            Way::Few(lights) => {
                let Some(place) = lights.iter().position(|(i, _)| *i == index) else { return F::ZERO };
                let shares = Shares::of(lights, at);
                shares.each[place] / shares.steps
            }
            Way::Many(table) => F::splat(table.pmf(index as usize)),
        }
    }
}

#[inline(always)]
fn picks_of_few<F: Float>(lights: &[(u32, Reach)], u: F, at: &Receiver<F>) -> Picks<F> {
    let shares = Shares::of(lights, at);
    // Exact: the steps are a power of two.
    let place = u * shares.steps;
    let mut first = F::ZERO;
    let mut picked = Picks { index: F::Uint::splat(0), pmf: F::ZERO, rest: F::ZERO };
    for ((index, _), &width) in lights.iter().zip(&shares.each) {
        let end = first + width;
        // Those before have ended at or before it.
        let it = place.lt(end) & !place.lt(first);
        picked.index = F::Uint::select(it, F::Uint::splat(*index), picked.index);
        picked.pmf = F::select(it, width / shares.steps, picked.pmf);
        picked.rest = F::select(it, ((place - first) / width).min(F::splat(BELOW_ONE)), picked.rest);
        first = end;
    }
    picked
}

/// Probabilities in whole steps.
struct Shares<F> {
    steps: f32,
    /// By light; their sum is `steps`, or 0 when none shines there.
    each: [F; FEW],
}

impl<F: Float> Shares<F> {
    #[inline(always)]
    fn of(lights: &[(u32, Reach)], at: &Receiver<F>) -> Self {
        let mut weights = [F::ZERO; FEW];
        let (mut total, mut count) = (F::ZERO, F::ZERO);
        for (weight, (_, reach)) in weights.iter_mut().zip(lights) {
            let w = reach.estimate(at);
            let shines = w.gt(F::ZERO);
            // On a light of no size anything is infinite.
            *weight = F::select(shines, w.min(F::splat(1e30)), F::ZERO);
            total += *weight;
            count += F::select(shines, F::ONE, F::ZERO);
        }
        let steps = if lights.len() <= 4 { 16.0 } else { 64.0 };
        let mut each = [F::ZERO; FEW];
        let shared = F::splat(steps) - count;
        let (mut sum, mut before, mut last) = (F::ZERO, F::ZERO, F::ZERO);
        for (i, (share, &weight)) in each.iter_mut().zip(&weights).enumerate().take(lights.len()) {
            // One step, and of the others its part, by rounding the running sum.
            let shines = weight.gt(F::ZERO);
            sum += weight;
            let now = (shared * (sum / total) + 0.5).trunc();
            *share = F::select(shines, now - before + 1.0, F::ZERO);
            before = F::select(shines, now, before);
            last = F::select(shines, F::splat(i as f32), last);
        }
        // Should rounding have left a step over.
        let over = F::select(count.gt(F::ZERO), shared - before, F::ZERO);
        for (i, share) in each.iter_mut().enumerate().take(lights.len()) {
            *share += F::select(last.eq(F::splat(i as f32)), over, F::ZERO);
        }
        Self { steps, each }
    }
}
