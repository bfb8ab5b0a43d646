//! How noisy a block is, by what it shows and what is around it.
//!
//! A few samples tell the noise of a block only as far as they have met what makes it. A pixel in which a lamp's edge covers one part in a hundred is black
//! in most of its first samples, and light that comes by one path in a million in nearly all. What a block alone shows of these is nothing, or very much; either is
//! wrong. But its surroundings have more pixels, and some of these have met it. So a block's variance is drawn towards that of the square of four blocks that it lies in,
//! this towards that of the square of sixteen, and so on up to a district of 64 x 64 pixels:
//!
//! V' = (m V + c V'(around)) / (m + c),
//!
//! where m is by how many events V is known (shrinkage, as in empirical Bayes; Efron and Morris 1975, "Data Analysis Using Stein's Estimator and its Generalizations"). Events of a
//! pixel with mean μ and variance per sample v of n samples: n μ² / v, which is the number of bright samples where the others are
//! black, between 1 and n. Those of several pixels: (Σ v)² / Σ (v² / events), which is their sum where they are alike, and those of the
//! noisiest where one stands out. A square that has met nothing counts as many as its part of those around would have. So even light is judged by itself, after a few samples already, and what is rare by all that
//! has met it. What m events tell may be off by a part of sqrt(2 / (m + c)), by which a block's variance counts for more.

use super::{Half, SIDE};

/// The events that what lies around counts for.
const AROUND: f64 = 0.3;

/// What one half of the pixels' samples shows, summed over a square.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shown {
    pub(super) pixels: f64,
    /// Of single samples.
    pub(super) variance: f64,
    /// Squares of variances over the events that these are known by.
    doubt: f64,
    pub(super) brightness: f64,
}

impl Shown {
    /// What the halves of some pixels show.
    pub(super) fn of(pixels: &[Half]) -> Self {
        pixels.iter().filter(|half| half.count > 0.0).fold(Self::default(), |sum, half| {
            let doubt = if half.variance > 0.0 { half.variance * half.variance / half.events() } else { 0.0 };
            sum.plus(Self { pixels: 1.0, variance: half.variance, doubt, brightness: half.brightness })
        })
    }

    fn plus(self, other: Self) -> Self {
        Self {
            pixels: self.pixels + other.pixels,
            variance: self.variance + other.variance,
            doubt: self.doubt + other.doubt,
            brightness: self.brightness + other.brightness,
        }
    }

    /// By how many events the variance is known.
    fn events(&self) -> f64 {
        if self.doubt > 0.0 { self.variance * self.variance / self.doubt } else { 0.0 }
    }

    pub(super) fn mean_variance(&self) -> f64 {
        self.variance / if self.pixels > 0.0 { self.pixels } else { 1.0 }
    }
}

/// The blocks of a district, row by row.
pub(super) type Blocks<T> = [T; SIDE * SIDE];

/// The variance of single samples in each block, drawn towards what is around, and by how many events it is known.
pub(super) fn drawn_together(blocks: &Blocks<Shown>) -> Blocks<(f64, f64)> {
    // Squares of 2^level blocks a side.
    let square = |level: usize, [x, y]: [usize; 2]| {
        let side = 1 << level;
        let places = (0..side * side).map(|i| (y * side + i / side) * SIDE + x * side + i % side);
        places.fold(Shown::default(), |sum, place| sum.plus(blocks[place]))
    };
    let top = SIDE.ilog2() as usize;
    let whole = square(top, [0, 0]);
    let mut around = [(whole, (whole.mean_variance(), whole.events())); SIDE * SIDE];
    for level in (0..top).rev() {
        let across = SIDE >> level;
        let mut within = around;
        for (i, within) in within.iter_mut().enumerate().take(across * across) {
            let at = [i % across, i / across];
            let (outer, (its, _)) = around[at[1] / 2 * (across / 2) + at[0] / 2];
            let own = square(level, at);
            let part = outer.events() * own.pixels / if outer.pixels > 0.0 { outer.pixels } else { 1.0 };
            let events = if own.events() > part { own.events() } else { part };
            let known = events + AROUND;
            *within = (own, ((events * own.mean_variance() + AROUND * its) / known, known));
        }
        around = within;
    }
    around.map(|(_, known)| known)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of 64 pixels of this mean, variance of single samples, and number of events that these are known by.
    fn shown(mean: f64, variance: f64, events: f64) -> Shown {
        let square = 64.0 * variance * variance * 64.0;
        Shown {
            pixels: 64.0,
            variance: 64.0 * variance,
            doubt: if events > 0.0 { square / events } else { 0.0 },
            brightness: 64.0 * mean,
        }
    }

    #[test]
    fn what_is_known_well_is_judged_by_itself() {
        let mut blocks = [shown(1.0, 0.1, 1e4); SIDE * SIDE];
        blocks[20] = shown(1.0, 4.0, 1e4);
        for (i, (variance, _)) in drawn_together(&blocks).into_iter().enumerate() {
            let own = blocks[i].mean_variance();
            assert!((variance / own - 1.0).abs() < 1e-3, "{i}: {variance}, not {own}");
        }
    }

    /// A single event in the first of 64 blocks, whose variance is 1: of the whole 1/64. Of the squares that have met nothing, the largest count a
    /// quarter of an event each, and what lies within them none.
    #[test]
    fn what_is_rare_is_shared() {
        let mut blocks = [shown(1.0, 0.0, 0.0); SIDE * SIDE];
        blocks[0] = shown(1.0, 1.0, 1.0);
        let got = drawn_together(&blocks).map(|(variance, _)| variance);
        let towards =
            |own: f64, events: f64, around: f64| (events * own + AROUND * around) / (events + AROUND);
        let whole = 1.0 / 64.0;
        let far = towards(0.0, 0.25, whole);
        assert!((got[63] - far).abs() < 1e-12 && (got[7] - far).abs() < 1e-12, "{got:?}");
        let largest = towards(1.0 / 16.0, 1.0, whole);
        let next = towards(0.0, 0.25, largest);
        assert!((got[SIDE + 2] - next).abs() < 1e-12, "{got:?}");
        let own = towards(1.0, 1.0, towards(0.25, 1.0, largest));
        assert!((got[0] - own).abs() < 1e-12, "{got:?}");
        assert!(got[1] > next && next > far);
    }
}
