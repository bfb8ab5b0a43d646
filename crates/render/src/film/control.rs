//! What a filter with negative lobes owes to a pixel's count of samples.
//!
//! Such a filter's samples weigh +W or -W. On average they weigh 1, but of so many samples never quite as many fall into the negative
//! lobes as should: light that is the same everywhere would come out noisy, by 2 % with 64 samples of Mitchell's filter and by 10 %
//! of Lanczos'. What the weights of a pixel's samples exceed 1 by is known, though, and what it brings is taken off: that excess
//! times the mean of the unweighted light (a control variate; Glasserman 2003, section 4.1). Each sample's excess is multiplied by
//! the mean of the *other* samples' light, so that the result is right on average with any number of them.

use super::Pixel;
use super::fixed::{Fixed, Square};

/// The samples of a pixel that weigh -W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Control {
    /// Sums of their weighed light.
    pub(super) negative: [Fixed; 3],
    /// How many they are.
    pub(super) count: u32,
}

impl Control {
    /// Takes note of a sample with a negative weight.
    pub fn add(&mut self, weighed: [f32; 3]) {
        self.count += 1;
        for (sum, v) in self.negative.iter_mut().zip(weighed) {
            sum.add(v);
        }
    }

    /// The samples that aren't among others.
    pub fn without(&self, o: &Self) -> Self {
        Self {
            negative: std::array::from_fn(|c| self.negative[c] - o.negative[c]),
            count: self.count - o.count,
        }
    }

    /// The sum of a channel without what the weights owe to chance; `size` is W.
    pub fn sum(&self, p: &Pixel, channel: usize, size: f64) -> f64 {
        self.of(p, size).sum(p.value[channel].to_f64(), self.negative[channel].to_f64())
    }

    /// The sum of anything else that the same samples were weighed for.
    pub fn sum_of(&self, p: &Pixel, [all, negative]: [Fixed; 2], size: f64) -> f64 {
        self.of(p, size).sum(all.to_f64(), negative.to_f64())
    }

    /// The variance of the mean of a channel by how samples scatter; 0 for a single one.
    pub fn variance(&self, (p, squares): (&Pixel, &[Square; 3]), channel: usize, size: f64) -> f64 {
        let weights = self.of(p, size);
        let (all, negative) = (p.value[channel].to_f64(), self.negative[channel].to_f64());
        let n = weights.count;
        if p.count < 2 {
            return 0.0;
        }
        // Of w L - (w - 1) l, where l is the mean of L.
        let light = weights.light(all, negative);
        let l = light / n;
        let ww = size * size;
        let squares = squares[channel].to_f64() - 2.0 * l * (ww * light - all)
            + l * l * (n * ww - 2.0 * weights.total + n);
        let middle = (all - l * (weights.total - n)) / n;
        let spread = squares / n - middle * middle;
        if spread > 0.0 { spread / (n - 1.0) } else { 0.0 }
    }

    fn of(&self, p: &Pixel, size: f64) -> Weights {
        let count = f64::from(p.count.max(1));
        Weights { count, total: size * (count - 2.0 * f64::from(self.count)), size }
    }
}

/// The weights of a pixel's samples.
struct Weights {
    count: f64,
    total: f64,
    size: f64,
}

impl Weights {
    /// The sum of unweighted light, by the sum of all weighed light and that of the negative.
    fn light(&self, all: f64, negative: f64) -> f64 {
        (all - 2.0 * negative) / self.size
    }

    fn sum(&self, all: f64, negative: f64) -> f64 {
        if self.count < 2.0 {
            return all;
        }
        let light = self.light(all, negative);
        // Over pairs of different samples, the sum of (w - 1) L.
        let owed = (self.total - self.count) * light - (all - light);
        all - owed / (self.count - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{FilmTile, Keep, Sample};
    use crate::film::Region;
    use crate::filter::{Filter, Profile, Separable};
    use straal_math::lowdisc::{Pattern, Purpose, SampleName};

    fn filters() -> [Filter; 2] {
        let third = 1.0 / 3.0;
        [(Profile::Mitchell { b: third, c: third }, 2.0), (Profile::Lanczos, 3.0)]
            .map(|(profile, radius)| Filter::Separable(Separable::new(profile, radius).unwrap()))
    }

    fn pixel(filter: &Filter, samples: u32, seed: u64, light: impl Fn([f32; 2]) -> f32) -> (f64, f64) {
        let mut tile = FilmTile::new(Region { min: [0, 0], max: [1, 1] }, Keep::ALL);
        tile.control(filter.signed_weight().unwrap().into());
        for i in 0..samples {
            let u = Pattern::Random.d2(&SampleName::new(seed, [0, 0], i), Purpose::Film);
            let s = filter.sample(u);
            let rgb = [light(s.offset) * s.weight; 3];
            tile.add([0, 0], i, &Sample { rgb, negative: s.weight < 0.0, ..Sample::default() }, &[]);
        }
        (tile.mean(0, 1), tile.variance_by_spread(0, 1))
    }

    #[test]
    fn even_light_has_no_noise() {
        for filter in filters() {
            for samples in [2, 3, 16, 64] {
                let (mean, variance) = pixel(&filter, samples, 1, |_| 0.75);
                assert!((mean - 0.75).abs() < 1e-6 && variance < 1e-12, "{samples}: {mean} {variance}");
            }
        }
    }

    /// Over an edge the mean stays that of the filter, with any number of samples, and the variance is told.
    #[test]
    fn edges_come_out_right_on_average() {
        for filter in filters() {
            let edge = |at: [f32; 2]| if at[0] < 0.3 { 1.0 } else { 0.25 };
            let heights = |end: f32| -> f64 {
                let middles = (0..8000).map(|i| (i as f32 + 0.5) / 1000.0 - 4.0).filter(|x| *x < end);
                middles.map(|x| f64::from(filter.relative_height(x))).sum()
            };
            let want = 0.25 + 0.75 * heights(0.3) / heights(4.0);
            for samples in [2, 4, 32] {
                let trials = 20_000;
                let (mut sum, mut squares, mut told) = (0.0, 0.0, 0.0);
                for seed in 0..trials {
                    let (mean, variance) = pixel(&filter, samples, seed, edge);
                    sum += mean;
                    squares += mean * mean;
                    told += variance;
                }
                let n = trials as f64;
                let (mean, told) = (sum / n, told / n);
                let variance = squares / n - mean * mean;
                assert!((mean - want).abs() < 4.5 * (variance / n).sqrt(), "{samples}: {mean}, not {want}");
                assert!(
                    samples < 32 || (told / variance - 1.0).abs() < 0.1,
                    "{samples}: {told}, not {variance}"
                );
            }
        }
    }
}
