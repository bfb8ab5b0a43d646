//! Which pixels have samples enough.
//!
//! 1. A block wants so many samples that its noise, Σ q / n over its pixels, is what is wished for; q is a pixel's variance of single samples, drawn towards its
//!    surroundings' and over what the noise is measured against.
//! 2. It gets more where its district needs far more elsewhere: equal noise everywhere isn't the least error for so many samples. The mean square error of a
//!    picture, Σ v / n, is least for samples in proportion to the root of v (Neyman 1934, "On the Two Different Aspects of the Representative
//!    Method"). So the counts of a district are raised towards that until its error is no more than as many samples spread evenly would leave, or until half as many again
//!    are spent.
//! 3. Where few pixels make most of a block's noise, the edge of a lamp in the dark, only they go on: the others end when
//!    they have their part of what is least for the block.
//!
//! What has ended keeps the noise that it ended with, and what is open makes up for it as far as that takes no more than twice the samples.

use super::super::DARK;
use super::super::adaptive::FIRST_CHECK;
use super::known::{Blocks, Shown, drawn_together};
use super::lone;
use super::unmet;
use super::{ALL, Half, PIXELS, SIDE, at_least};

/// A district's error is worth the samples of others when it is so many times that of samples spread evenly.
const UNEVEN: f64 = 1.1;

/// At most so many times the samples that its blocks want a district has to lower its error.
const MOST: f64 = 1.5;

/// So many times the samples of blocks are raised, by an eighth each: to 2000 times at most.
const TRIES: usize = 64;

/// By so many events a pixel's variance must be known to be told from its neighbours', where it isn't more what lies beside it that may be unmet.
const TOLD: f64 = 8.0;

/// A block is taken apart where that takes at most this part of the samples.
const WORTH: f64 = 0.3;

/// The part of its wish that a block's open pixels have at least, whatever the others ended with.
const LEFT: f64 = 0.5;

/// A pixel's squares of noise, by single samples.
#[derive(Clone, Copy, Debug, Default)]
struct Noise {
    /// Relative to what its block is measured against.
    wished: f64,
    /// Relative to its own brightness, see [`super::DIM`].
    error: f64,
}

/// A block and what it wants.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    pixels: f64,
    /// Pixels that still take samples.
    open: f64,
    /// Sums over these.
    noise: Noise,
    /// What these may leave of noise.
    left: f64,
    /// Samples of each of them.
    wants: f64,
}

/// What has ended in a district: pixels, samples, and error, by single samples and as it is.
#[derive(Clone, Copy, Debug, Default)]
struct Ended {
    pixels: f64,
    samples: f64,
    error: f64,
    left: f64,
}

/// The noise of the pixels of a block, whose variance is known to be `variance` by so many events, and `unmet` more for each.
fn noise_of(shown: &[Half], (variance, events): (f64, f64), unmet: &[f64]) -> [Noise; PIXELS] {
    let sum = Shown::of(shown);
    if sum.pixels == 0.0 {
        return [Noise::default(); PIXELS];
    }
    let bright = at_least(sum.brightness / sum.pixels, DARK);
    let own: f64 = shown.iter().map(|half| half.variance / half.own_square()).sum();
    let by_pixels = own > sum.variance / (bright * bright);
    let seen = sum.mean_variance();
    let doubt = 1.0 + (2.0 / events).sqrt();
    std::array::from_fn(|i| {
        let half = &shown[i];
        if half.count == 0.0 {
            return Noise::default();
        }
        let variance = doubt * if seen > 0.0 { half.variance / seen * variance } else { variance };
        let own = 1.0 / half.own_square();
        let against = if by_pixels { own } else { 1.0 / (bright * bright) };
        Noise { wished: (variance + unmet[i]) * against, error: variance * own }
    })
}

/// Raises what blocks want until their district's error is no more than that of as many samples spread evenly.
fn share_out(blocks: &mut [Block], ended: Ended) {
    let pixels = ended.pixels + blocks.iter().map(|b| b.open).sum::<f64>();
    let single = ended.error + blocks.iter().map(|b| b.noise.error).sum::<f64>();
    if single <= 0.0 {
        return;
    }
    let at = |b: &Block, raise: f64| {
        let share = raise * (b.noise.error / b.open).sqrt();
        at_least(at_least(b.wants, FIRST_CHECK.into()), share)
    };
    let open = || blocks.iter().filter(|b| b.open > 0.0);
    let spent = |raise: f64| ended.samples + open().map(|b| b.open * at(b, raise)).sum::<f64>();
    let error = |raise: f64| ended.left + open().map(|b| b.noise.error / at(b, raise)).sum::<f64>();
    let unevenness = |raise: f64| error(raise) * spent(raise) / (single * pixels);
    if unevenness(0.0) <= UNEVEN {
        return;
    }
    let most = MOST * spent(0.0);
    // Where the first block has more for the sake of all.
    let first = open().filter(|b| b.noise.error > 0.0).map(|b| at(b, 0.0) / (b.noise.error / b.open).sqrt());
    let first = first.fold(f64::INFINITY, |least, v| if v < least { v } else { least });
    // By an eighth more each time; what is spent goes up with it as soon as a block has an error.
    let raises = std::iter::successors(Some(first), |raise| Some(raise * 1.125)).take(TRIES);
    // Where only those are left that have most already, none is raised: it would make it worse.
    let mut taken = (0.0, unevenness(0.0));
    for raise in raises.take_while(|raise| raise.is_finite() && spent(*raise) <= most) {
        let left = unevenness(raise);
        if left < taken.1 {
            taken = (raise, left);
        }
        if left <= 1.0 {
            break;
        }
    }
    let (taken, _) = taken;
    let shares: Vec<f64> = blocks.iter().map(|b| if b.open > 0.0 { at(b, taken) } else { 0.0 }).collect();
    for (block, share) in blocks.iter_mut().zip(shares) {
        block.wants = share;
    }
}

/// Ends the pixels of a block that make little of its noise, where few make most of it: `raised` is by how much it wants more than it needs.
fn take_apart(
    (block, raised, around): (&Block, f64, f64),
    (own, shown, noise, unmet): (&[Half], &[Half], &[Noise; PIXELS], &[f64]),
    samples: f64,
    ends: &mut [bool],
) {
    let is_open = |i: &usize| own[*i].is_open && own[*i].count > 0.0;
    let is_told = |i: &usize| shown[*i].events() >= TOLD || unmet[*i] > shown[*i].variance;
    let mut told: Vec<usize> = (0..PIXELS).filter(is_open).filter(is_told).collect();
    told.sort_by(|a, b| noise[*b].wished.total_cmp(&noise[*a].wished));
    let all_events: f64 = (0..PIXELS).filter(is_open).map(|i| shown[i].events()).sum();
    let (mut few, mut events) = ((0.0, 0.0), 0.0);
    let mut best = (f64::INFINITY, 0, 0.0);
    for (taken, &i) in told.iter().enumerate() {
        few = (few.0 + 1.0, few.1 + noise[i].wished);
        events += shown[i].events();
        let rest = (block.open - few.0, block.noise.wished - few.1);
        if rest.0 < 0.5 {
            break;
        }
        // The rest's noise is drawn towards the block's by a single event.
        let known = at_least(all_events - events, around * rest.0 / PIXELS as f64);
        let its = (known * at_least(rest.1, 0.0) / rest.0 + block.noise.wished / block.open) / (known + 1.0)
            * rest.0;
        let roots = (few.0 * few.1).sqrt() + (rest.0 * its).sqrt();
        let cost = roots * roots / (block.open * block.noise.wished);
        if cost < best.0 {
            best = (cost, taken + 1, (its / rest.0).sqrt() * roots / block.left);
        }
    }
    let (cost, few, wants) = best;
    if cost <= WORTH && at_least(wants * raised, FIRST_CHECK.into()) <= samples {
        for i in (0..PIXELS).filter(is_open).filter(|i| !told[..few].contains(i)) {
            ends[i] = true;
        }
    }
}

/// Which halves of a district's pixels, given block by block, take no further samples after `samples` of the pixels that go on: `own` are these halves, and `other` their
/// counterparts, which know nothing of their luck.
pub(super) fn ending(own: &[Half], other: &[Half], (samples, target): (f64, f64)) -> Vec<bool> {
    let other = &lone::told_apart(own, other);
    let shown: Blocks<Shown> = std::array::from_fn(|b| Shown::of(&other[b * PIXELS..][..PIXELS]));
    let known = drawn_together(&shown);
    let unmet = unmet::variances(own, other);
    let part = |b: usize| b * PIXELS..(b + 1) * PIXELS;
    let noise: Vec<[Noise; PIXELS]> =
        (0..SIDE * SIDE).map(|b| noise_of(&other[part(b)], known[b], &unmet[part(b)])).collect();
    let mut ended = Ended::default();
    let mut blocks = [Block::default(); SIDE * SIDE];
    for (b, block) in blocks.iter_mut().enumerate() {
        let mut used = 0.0;
        for (half, noise) in own[part(b)].iter().zip(&noise[b]).filter(|(half, _)| half.count > 0.0) {
            block.pixels += 1.0;
            if half.is_open {
                block.open += 1.0;
                block.noise.wished += noise.wished;
                block.noise.error += noise.error;
            } else {
                // The other half has as many, if it ended as well.
                let count = 2.0 * half.count;
                used += noise.wished / count;
                ended.pixels += 1.0;
                ended.samples += count;
                ended.error += noise.error;
                ended.left += noise.error / count;
            }
        }
        let wish = block.pixels * target * target;
        block.left = at_least(wish - used, LEFT * wish);
        if block.open > 0.0 {
            block.wants = block.noise.wished / block.left;
        }
    }
    let needs = blocks.map(|b| b.wants);
    share_out(&mut blocks, ended);
    let mut ends = vec![false; ALL];
    for (b, block) in blocks.iter().enumerate().filter(|(_, block)| block.open > 0.0) {
        if block.wants <= samples {
            ends[part(b)].fill(true);
        } else {
            let raised = at_least(block.wants / needs[b], 1.0);
            let halves = (&own[part(b)], &other[part(b)], &noise[b], &unmet[part(b)]);
            take_apart((block, raised, known[b].1), halves, samples, &mut ends[part(b)]);
        }
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pixels of one kind, known by a million events.
    fn even(brightness: f64, variance: f64, count: f64) -> Half {
        Half { count, brightness, variance, by_all: variance, spread: variance, is_open: true }
    }

    /// How many of a block's pixels end.
    fn ended(ends: &[bool], block: usize) -> usize {
        ends[block * PIXELS..][..PIXELS].iter().filter(|e| **e).count()
    }

    /// The samples after which all of a district's pixels end, by the looks at 32, 64, 128 ..., and how often each block was open.
    fn looks(kinds: impl Fn(usize) -> (f64, f64), target: f64) -> Vec<f64> {
        let mut own: Vec<Half> = (0..ALL).map(|_| even(0.0, 0.0, 16.0)).collect();
        let mut samples = 32.0;
        while own.iter().any(|half| half.is_open) && samples < 1e8 {
            for half in own.iter_mut().filter(|half| half.is_open) {
                half.count = samples / 2.0;
            }
            let other: Vec<Half> = own
                .iter()
                .enumerate()
                .map(|(i, half)| {
                    let (brightness, variance) = kinds(i);
                    Half { brightness, variance, by_all: variance, spread: variance, ..*half }
                })
                .collect();
            let ends = ending(&own, &other, (samples, target));
            own.iter_mut().zip(ends).for_each(|(half, end)| half.is_open &= !end);
            samples *= 2.0;
        }
        own.iter().map(|half| 2.0 * half.count).collect()
    }

    /// Even noise: as many samples as the wish asks for, at the next look.
    #[test]
    fn even_noise_ends_at_once() {
        // v / (n B²) = target² with 400 samples; what may be unmet adds a part in a thousand, doubt a hundredth.
        let got = looks(|_| (2.0, 0.16), 0.01);
        assert!(got.iter().all(|n| *n == 512.0), "{}", got[0]);
        assert!(looks(|_| (2.0, 0.0), 0.01).iter().all(|n| *n == 32.0));
    }

    /// A pixel with all of its block's noise goes on alone, and the block keeps what was asked for.
    #[test]
    fn few_pixels_go_on_alone() {
        let target = 0.02;
        // The edge of a lamp of radiance 1 across a pixel, in a wall of 0.1.
        let noisy = |i: usize| i == 27;
        let got = looks(|i| if noisy(i) { (0.5, 0.25) } else { (0.1, 1e-6) }, target);
        assert!(got[27] >= 1024.0, "{}", got[27]);
        let others = got[..PIXELS].iter().enumerate().filter(|(i, _)| !noisy(*i));
        assert!(others.clone().all(|(_, n)| *n * 4.0 <= got[27]), "{} and {}", got[26], got[27]);
        let bright = (63.0 * 0.1 + 0.5) / 64.0;
        let noise = (0.25 / got[27] + others.map(|(_, n)| 1e-6 / n).sum::<f64>()) / 64.0;
        assert!(noise.sqrt() / bright < target, "{}", noise.sqrt() / bright);
    }

    /// What has met few events isn't told from what is beside it.
    #[test]
    fn lucky_pixels_do_not_go_on_alone() {
        let mut halves = vec![even(0.1, 1e-6, 16.0); ALL];
        // A single bright sample of sixteen.
        halves[27] = even(1.0, 16.0, 16.0);
        let ends = ending(&halves, &halves, (32.0, 0.02));
        assert_eq!(ended(&ends, 0), 0);
    }

    /// Where a block needs far more than the others, those with much of the picture's error have more as well.
    #[test]
    fn a_district_is_no_worse_than_even_samples() {
        // In the dark 0.01 is measured against itself, and 1 against 1.
        let kinds = |i: usize| match i / PIXELS {
            0 => (0.01, 0.0003),
            1..16 => (1.0, 0.5),
            _ => (1.0, 0.02),
        };
        let target = 0.05;
        let got = looks(kinds, target);
        let error = |n: &dyn Fn(usize) -> f64| {
            (0..ALL)
                .map(|i| {
                    let (b, v) = kinds(i);
                    v / (b * b + 0.01) / n(i)
                })
                .sum::<f64>()
        };
        let mean = got.iter().sum::<f64>() / ALL as f64;
        let (adapted, even) = (error(&|i| got[i]), error(&|_| mean));
        assert!(adapted < even, "{adapted}, not less than {even}, with {mean} samples");
        assert!(got[PIXELS] > got[20 * PIXELS] && got[0] > got[PIXELS]);
    }

    /// One half of all pixels has ended, and the other goes on.
    #[test]
    fn what_has_ended_has_nothing_to_share() {
        let own = vec![Half { is_open: false, ..even(1.0, 1.0, 16.0) }; ALL];
        assert_eq!(ended(&ending(&own, &own, (64.0, 0.001)), 0), 0);
        let uneven = Ended { pixels: 2.0, samples: 200.0, error: 2.0, left: 1.0 };
        share_out(&mut [Block::default(); 4], uneven);
    }

    #[test]
    fn what_has_ended_is_made_up_for_in_part() {
        let block = |open: f64| Block {
            open,
            noise: Noise { wished: 1.0, error: open },
            wants: 100.0,
            ..Block::default()
        };
        let mut blocks = [block(64.0); 4];
        share_out(&mut blocks, Ended::default());
        assert!(blocks.iter().all(|b| b.wants == 100.0));
        // Those that are left have more than the others had: more still would be no gain.
        let before = Ended { pixels: 640.0, samples: 640.0 * 10.0, error: 640.0, left: 64.0 };
        share_out(&mut blocks, before);
        assert!(blocks.iter().all(|b| b.wants == 100.0), "{}", blocks[0].wants);
        // One block has spent a hundred times as many: the others go up, by a half of all at most.
        let ended = Ended { pixels: 64.0, samples: 64.0 * 1e4, error: 64.0, left: 64.0 / 1e4 };
        share_out(&mut blocks, ended);
        let spent = ended.samples + blocks.iter().map(|b| 64.0 * b.wants).sum::<f64>();
        assert!(
            blocks[0].wants > 800.0 && spent <= MOST * (ended.samples + 4.0 * 6400.0),
            "{}",
            blocks[0].wants
        );
    }
}
