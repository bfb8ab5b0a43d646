//! Choosing in proportion to weights: piecewise constant distributions over a list and over a grid.
//!
//! Probabilities are whole multiples of 2^-24, the step of a random number (see [`crate::lowdisc`]). So what is
//! drawn has exactly the probability that is told, nothing of probability 0 is ever drawn, and, in lists of up
//! to eight million, every weight above 0 has at least one step. Tables are built in double precision and fixed
//! order.
//!
//! A table is asked for one number or for many side by side ([`crate::simd`]), of which each gets what it would get alone.

mod plane;

pub use plane::{Point2, Points2, Table2, Tables2};

use crate::ops;
use crate::simd::{Float, Mask, Uint};

/// Steps of probability: the resolution of a random number in [0, 1).
const STEPS: u32 = 1 << 24;
/// One step.
const STEP: f32 = 1.0 / STEPS as f32;
/// The greatest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// A choice from a list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Which.
    pub index: usize,
    /// Its probability.
    pub pmf: f32,
    /// What the number that chose has left, again even in [0, 1): log2(1/pmf) bits poorer.
    pub rest: f32,
}

/// Choices from a list, one in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Choices<F: Float> {
    /// Which.
    pub index: F::Uint,
    /// Their probabilities.
    pub pmf: F,
    /// What the numbers that chose have left, as [`Choice::rest`].
    pub rest: F,
}

/// A distribution over a list, or piecewise constant over [0, 1).
#[derive(Clone, Debug, PartialEq)]
pub struct Table1 {
    /// Steps before each entry; one longer than the list.
    cdf: Vec<u32>,
    guide: Vec<u32>,
}

impl Table1 {
    /// Bytes that an entry takes: its steps, and its place in the guide.
    pub const BYTES: usize = 2 * size_of::<u32>();

    /// A table of weights, where negative, infinite and NaN ones count as 0. `None` if nothing is left to choose.
    pub fn new(weights: &[f32]) -> Option<Self> {
        let mut cdf = vec![0; weights.len() + 1];
        let total = total(weights);
        if total <= 0.0 || weights.len() >= u32::MAX as usize {
            return None;
        }
        fill(&mut cdf, weights, total);
        let mut guide = vec![0; guide_len(weights.len())];
        fill_guide(&mut guide, &cdf);
        Some(Self { cdf, guide })
    }

    /// How many entries there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.cdf.len() - 1
    }

    /// Never: a table with nothing in it isn't made.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Chooses by `u` in [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> Choice {
        let Choices { index, pmf, rest } = self.samples(u);
        Choice { index: index as usize, pmf, rest }
    }

    /// As [`Self::sample`], in each lane.
    #[inline(always)]
    pub fn samples<F: Float>(&self, u: F) -> Choices<F> {
        self.whole().choose(List::among(F::Uint::splat(0), self.len(), self.guide.len()), u)
    }

    #[inline(always)]
    fn whole(&self) -> Lists<'_> {
        Lists { cdfs: &self.cdf, guides: &self.guide }
    }

    /// The probability of an entry; 0 beyond the list.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        if index < self.len() { self.pmfs(index as u32) } else { 0.0 }
    }

    /// As [`Self::pmf`], in each lane.
    #[inline(always)]
    pub fn pmfs<F: Float>(&self, index: F::Uint) -> F {
        let pmf = self.whole().pmf(F::Uint::splat(0), index);
        F::select(index.lt(F::Uint::splat(self.len() as u32)), pmf, F::ZERO)
    }

    /// The number that [`Self::sample`] turns into this entry and rest, but for rounding.
    #[inline]
    pub fn invert(&self, index: usize, rest: f32) -> f32 {
        invert(&self.cdf, index, rest)
    }
}

/// Sum of the weights that count.
fn total(weights: &[f32]) -> f64 {
    weights.iter().map(|&w| counted(w)).sum()
}

#[inline(always)]
fn counted(weight: f32) -> f64 {
    if weight > 0.0 && weight < f32::INFINITY { f64::from(weight) } else { 0.0 }
}

/// Rounded to single precision, but not to 0.
fn keep_above_zero(x: f64) -> f32 {
    let rounded = x as f32;
    if rounded > 0.0 { rounded } else { f32::MIN_POSITIVE }
}

/// Shares the steps out. Each weight above 0 gets one as long as that leaves half of them, the rest go in
/// proportion, by rounding the running sum.
fn fill(cdf: &mut [u32], weights: &[f32], total: f64) {
    let chosen = weights.iter().filter(|&&w| counted(w) > 0.0).count();
    let each = if chosen <= STEPS as usize / 2 { 1 } else { 0 };
    let shared = f64::from(STEPS) - (each as usize * chosen) as f64;
    let (mut sum, mut given) = (0.0, 0);
    let mut last = 0;
    for (i, &weight) in weights.iter().enumerate() {
        if counted(weight) > 0.0 {
            sum += counted(weight);
            given += each;
            last = i;
        }
        // A running sum can't pass the total: both add the same numbers in the same order.
        cdf[i + 1] = given + (shared * (sum / total)) as u32;
    }
    // Should division have left the quotient a hair below 1, the last weight gets the step.
    cdf[last + 1..].fill(STEPS);
}

/// A guide has a power of two of buckets, about one for two entries.
fn guide_len(entries: usize) -> usize {
    (entries / 2).next_power_of_two().clamp(1, STEPS as usize)
}

/// For each bucket, an equal part of all steps, the entry that its first step belongs to.
fn fill_guide(guide: &mut [u32], cdf: &[u32]) {
    let shift = 24 - guide.len().trailing_zeros();
    let mut entry = 0;
    for (bucket, first) in guide.iter_mut().enumerate() {
        let step = (bucket as u32) << shift;
        while cdf[entry + 1] <= step {
            entry += 1;
        }
        *first = entry as u32;
    }
}

#[inline(always)]
fn width(cdf: &[u32], index: usize) -> u32 {
    cdf[index + 1] - cdf[index]
}

/// Lists one after the other, of which each lane asks one.
#[derive(Clone, Copy)]
struct Lists<'a> {
    /// Of each list one more than it has entries.
    cdfs: &'a [u32],
    guides: &'a [u32],
}

/// Which list a lane asks.
#[derive(Clone, Copy)]
struct List<U> {
    /// Where it begins in `cdfs`.
    start: U,
    /// Where it begins in `guides`.
    guide: U,
    /// Its entries.
    len: U,
    /// Of a step, how far it is shifted down to its bucket in the guide, of which there are as many as 24 less this tells bits.
    shift: U,
}

impl<U: Uint> List<U> {
    /// Number `list` of lists of the same length.
    #[inline(always)]
    fn among(list: U, len: usize, guide_len: usize) -> Self {
        Self {
            start: list.wrapping_mul(U::splat(len as u32 + 1)),
            guide: list.wrapping_mul(U::splat(guide_len as u32)),
            len: U::splat(len as u32),
            shift: U::splat(24 - guide_len.trailing_zeros()),
        }
    }
}

impl Lists<'_> {
    /// The probability of an entry of the list that starts at `start`.
    #[inline(always)]
    fn pmf<F: Float>(&self, start: F::Uint, index: F::Uint) -> F {
        let at = start.wrapping_add(index);
        let next = F::Uint::gather(self.cdfs, at.wrapping_add(F::Uint::splat(1)));
        F::from_int(next.wrapping_sub(F::Uint::gather(self.cdfs, at))) * STEP
    }

    #[inline(always)]
    fn choose<F: Float>(&self, list: List<F::Uint>, u: F) -> Choices<F> {
        let one = F::Uint::splat(1);
        // Exact: a power of two times u. What isn't in [0, 1) lands at the nearer end.
        let scaled = ops::clamp(u, F::ZERO, F::splat(BELOW_ONE)) * STEPS as f32;
        let step = scaled.to_int();
        let bucket = step.shr_each(list.shift);
        let at = list.guide.wrapping_add(bucket);
        let is_last = F::Uint::splat(STEPS - 1).shr_each(list.shift).eq(bucket);
        let last = list.len.wrapping_sub(one);
        let mut low = F::Uint::gather(self.guides, at);
        let mut high = F::Uint::select(is_last, last, F::Uint::gather(self.guides, at.wrapping_add(one)));
        // The entry is in low..=high: the last whose steps begin at or before this one.
        loop {
            let is_open = low.lt(high);
            if !is_open.any() {
                break;
            }
            // Lanes that have found it stay there.
            let middle = low.wrapping_add(high.wrapping_sub(low).wrapping_add(one) >> 1);
            let begins = F::Uint::gather(self.cdfs, list.start.wrapping_add(middle)).le(step);
            low = F::Uint::select(is_open & begins, middle, low);
            high = F::Uint::select(is_open & !begins, middle.wrapping_sub(one), high);
        }
        let at = list.start.wrapping_add(low);
        let first = F::Uint::gather(self.cdfs, at);
        let width = F::Uint::gather(self.cdfs, at.wrapping_add(one)).wrapping_sub(first);
        let width = F::from_int(width);
        let rest = (scaled - F::from_int(first)) / width;
        Choices { index: low, pmf: width * STEP, rest: rest.min(F::splat(BELOW_ONE)) }
    }
}

#[inline(always)]
fn invert(cdf: &[u32], index: usize, rest: f32) -> f32 {
    let u = (cdf[index] as f32 + rest * width(cdf, index) as f32) * STEP;
    if u < BELOW_ONE { u } else { BELOW_ONE }
}

/// A chosen cell and what is left as a coordinate, kept within the cell whatever the rounding.
#[inline(always)]
fn place<F: Float>(choice: Choices<F>, cells: F::Uint) -> F {
    let v = (F::from_uint(choice.index) + choice.rest) / F::from_uint(cells);
    let (inside, cell) = texel_of(v, cells);
    // Else it was rounded up into the next cell.
    let below = F::from_bits(v.to_bits().wrapping_sub(F::Uint::splat(1)));
    F::select(inside & cell.eq(choice.index), v, below)
}

/// Whether a coordinate is in [0, 1), and its cell.
#[inline(always)]
fn texel_of<F: Float>(v: F, cells: F::Uint) -> (F::Mask, F::Uint) {
    let cell = (v * F::from_uint(cells)).to_uint().min(cells.wrapping_sub(F::Uint::splat(1)));
    (v.ge(F::ZERO) & v.lt(F::ONE), cell)
}

#[cfg(test)]
mod tests;
