//! What each pixel of a block has of its noise.
//!
//! What two or three batches tell of a block is the sum of 64 pixels, unless few of them make the noise: one pixel's batches may tell far too little by luck, and would end
//! the block. So a block counts for no less than its pixels' smaller batches tell, the more the fewer pixels make its noise: half of that, since smaller batches are less
//! even than larger ones and tell more than there is. Nor for less than what an edge through a pixel leaves: of n points, one in each of as many
//! cells, only those in the cells along the edge are chance, a part of about 1 / sqrt(n) of what independent samples would leave.
//!
//! Among the pixels the sum is dealt out by what all batches tell, and as much by the spread of samples, scaled to the same sum: a pixel has only five to eight batches, but as many samples as it takes, and
//! which pixels are noisy shows soonest in these.

use super::{Half, PIXELS, at_least};

/// The part of what all batches tell that is surely there.
const SURE: f64 = 0.5;

/// What an edge leaves, of what independent samples do, is so much over the root of their number.
const EDGE: f64 = 0.5;

/// The least that a pixel's variance can be, by what isn't luck.
fn least(half: &Half) -> f64 {
    let root = at_least(half.count, 1.0).sqrt();
    at_least(SURE * half.by_all, EDGE / root * half.spread)
}

/// The part of one pixel in the noise of some, where all are alike 1 over their number.
fn part_of_one(variances: impl Iterator<Item = f64>) -> f64 {
    let (sum, squares) = variances.fold((0.0, 0.0), |(sum, squares), v| (sum + v, squares + v * v));
    if sum > 0.0 { squares / (sum * sum) } else { 0.0 }
}

/// What the pixels of a district show, block by block, each with its part of its block's variance; `own` are the halves that it is asked for.
pub(super) fn told_apart(own: &[Half], shown: &[Half]) -> Vec<Half> {
    let mut out = shown.to_vec();
    for (own, out) in own.chunks(PIXELS).zip(out.chunks_mut(PIXELS)) {
        let of_all =
            |of: &dyn Fn(&Half) -> f64| out.iter().filter(|half| half.count > 0.0).map(of).sum::<f64>();
        let open = own.iter().zip(&*out).filter(|(own, half)| own.is_open && half.count > 0.0);
        let alone = part_of_one(open.map(|(_, half)| at_least(half.variance, least(half))));
        let (few, all) = (of_all(&|half| half.variance), of_all(&|half| half.by_all));
        let total = few + alone * at_least(of_all(&least) - few, 0.0);
        let spread = of_all(&|half| half.spread);
        let scale = if spread > 0.0 { all / spread } else { 0.0 };
        let share = |half: &Half| half.by_all + scale * half.spread;
        let shares = of_all(&share);
        if shares > 0.0 {
            out.iter_mut().for_each(|half| half.variance = total * share(half) / shares);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half(variance: f64, by_all: f64, spread: f64) -> Half {
        Half { count: 64.0, brightness: 1.0, variance, by_all, spread, is_open: true }
    }

    /// Of alike pixels the block's noise stays what few batches tell, whatever more of them do.
    #[test]
    fn alike_pixels_are_told_by_few_batches() {
        let shown: Vec<Half> =
            (0..PIXELS).map(|i| half(if i % 2 == 0 { 0.0 } else { 2.0 }, 3.0, 4.0)).collect();
        let told = told_apart(&shown, &shown);
        // A half of 3 is more than 1 by half of it, of which one in 64 counts.
        assert!(told.iter().all(|t| t.variance > 1.0 && t.variance < 1.02), "{}", told[0].variance);
    }

    /// One pixel's batches agree by luck: it counts for half of what smaller ones tell, and for what an edge leaves, where all agree.
    #[test]
    fn one_pixel_is_not_taken_by_its_luck() {
        for (by_all, want) in [(3.0, 1.5), (0.01, 0.5 / 8.0 * 4.0)] {
            let mut shown = vec![half(1e-6, 1e-6, 1e-6); PIXELS];
            shown[9] = half(0.02, by_all, 4.0);
            let told = told_apart(&shown, &shown);
            assert!((told[9].variance / want - 1.0).abs() < 0.01, "{}, not {want}", told[9].variance);
            assert!(told[8].variance < 1e-4, "{}", told[8].variance);
        }
        // Where it has ended, it has no say in how alike those are that go on.
        let mut shown = vec![half(1.0, 1.0, 1.0); PIXELS];
        shown[9] = half(0.0, 1000.0, 1000.0);
        let mut own = shown.clone();
        own[9].is_open = false;
        let told: f64 = told_apart(&own, &shown).iter().map(|t| t.variance).sum();
        assert!(told > 63.0 && told < 75.0, "{told}");
    }

    /// Batches of single pixels are luck: which of them are noisy is told by their samples as well.
    #[test]
    fn pixels_are_told_apart_by_their_samples() {
        let shown: Vec<Half> = (0..PIXELS)
            .map(|i| {
                let luck = [0.1, 0.4, 2.5][i % 3];
                let v = if i < 32 { 1.0 } else { 9.0 };
                half(v * luck, v * luck, v)
            })
            .collect();
        let told = told_apart(&shown, &shown);
        let sum = |halves: &[Half]| halves.iter().map(|half| half.variance).sum::<f64>();
        assert!((sum(&told) / sum(&shown) - 1.0).abs() < 1e-9, "{} and {}", sum(&told), sum(&shown));
        let least = |range: std::ops::Range<usize>| {
            told[range].iter().fold(f64::INFINITY, |l, t| if t.variance < l { t.variance } else { l })
        };
        assert!(least(32..64) > 3.0 && least(0..32) > 0.3, "{} and {}", least(0..32), least(32..64));
    }
}
