//! What may be there though no sample has met it.
//!
//! Beside a pixel in which a lamp shines lies one of which the lamp's edge covers a part in a hundred. Its first samples are all black, like those of its neighbours that the lamp
//! doesn't reach, and if it is black around as well, that part is most of its block's light. After n samples without an event, a part of 1 / n can't be ruled
//! out, and the chance that an edge leaves so little of a pixel falls as its root. So the pixels around what is bright are taken to have a variance of
//! 2 B² / (n + 1)^1.5, where B is the light of single samples there: the mean of their squares over their mean, which is the lamp's own radiance
//! however little of the pixel it covers. A block has one such edge more often than two: all of its pixels together count for the one that may be worst.
//!
//! What a path meets by way of glass or metal may be as bright, and lie anywhere. A pixel that has a part p of light B shows nothing of it in n samples with a chance of
//! exp(-p n), and has a variance of p B², so that B² / (e n) may be hidden in every block; to rule that out takes tens of thousands of samples where it is dark. So it is the
//! first samples that this is for: each block is taken to hide B² / 5 (n + 1)² in one of its pixels, with the brightest B of the district; less where its samples are all
//! alike, since paths that differ so little meet the surroundings alone.
//!
//! Where the half that shows it has ended, it is as if it had gone on without an event for as many samples as the one that goes on: this one by itself can't make up for the other.

use super::{ALL, DISTRICT, Half, PIXELS, at_least, place};

/// So many pixels around may hide a part of what a pixel shows.
const REACH: usize = 2;

/// By what the chance is scaled; tried on reference scenes.
const CHANCE: f64 = 2.0;

/// By what the chance is scaled that a block hides light as bright as any in its district; tried on reference scenes.
const FAR: f64 = 0.2;

/// The variance of single samples that `count` of them without an event of brightness `bright` leave possible.
fn possible(bright: f64, count: f64) -> f64 {
    let n = count + 1.0;
    CHANCE * bright * bright / (n * n.sqrt())
}

/// The greatest of the numbers on a line within [`REACH`] of each place.
fn greatest_along(line: &[f64], out: &mut [f64]) {
    for (i, out) in out.iter_mut().enumerate() {
        let near = &line[i.saturating_sub(REACH)..(i + REACH + 1).min(line.len())];
        *out = near.iter().fold(0.0, |most, v| if *v > most { *v } else { most });
    }
}

/// How unlike the samples of some pixels are: their variance over the square of their brightness, 1 at most.
fn unlike(shown: &[Half]) -> f64 {
    let (spread, squares) = shown.iter().fold((0.0, 0.0), |(spread, squares), half| {
        (spread + half.spread, squares + half.brightness * half.brightness)
    });
    if spread < squares {
        spread / squares
    } else if spread > 0.0 {
        1.0
    } else {
        0.0
    }
}

/// The variance of single samples that each pixel of a district may have by what is around.
pub(super) fn variances(own: &[Half], shown: &[Half]) -> Vec<f64> {
    let side = DISTRICT as usize;
    let mut bright = vec![0.0; ALL];
    for y in 0..side {
        for x in 0..side {
            let half = &shown[place([x, y])];
            if half.brightness > 0.0 {
                bright[y * side + x] = half.brightness + half.spread / half.brightness;
            }
        }
    }
    let mut along_rows = vec![0.0; ALL];
    for (row, out) in bright.chunks(side).zip(along_rows.chunks_mut(side)) {
        greatest_along(row, out);
    }
    let mut out = vec![0.0; ALL];
    let (mut column, mut greatest) = (vec![0.0; side], vec![0.0; side]);
    for x in 0..side {
        column.iter_mut().enumerate().for_each(|(y, v)| *v = along_rows[y * side + x]);
        greatest_along(&column, &mut greatest);
        for (y, bright) in greatest.iter().enumerate() {
            let place = place([x, y]);
            if shown[place].count > 0.0 {
                out[place] = possible(*bright, at_least(own[place].count, shown[place].count));
            }
        }
    }
    let brightest = bright.iter().fold(0.0, |most, v| at_least(*v, most));
    for (block, shown) in out.chunks_mut(PIXELS).zip(shown.chunks(PIXELS)) {
        let chance = FAR * unlike(shown);
        for (out, half) in block.iter_mut().zip(shown).filter(|(_, half)| half.count > 0.0) {
            let n = half.count + 1.0;
            *out = at_least(*out, chance * brightest * brightest / (n * n));
        }
        let (sum, most) =
            block.iter().fold((0.0, 0.0), |(sum, most), v| (sum + v, if *v > most { *v } else { most }));
        if sum > 0.0 {
            block.iter_mut().for_each(|v| *v *= most / sum);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lamp that covers a quarter of a pixel: its neighbours within two pixels may have a part of it, and count as one in each block.
    #[test]
    fn what_lies_beside_a_lamp_may_hide_a_part_of_it() {
        let mut shown = vec![Half { count: 15.0, brightness: 0.01, is_open: true, ..Half::default() }; ALL];
        // Radiance 4: mean 1, variance 3.
        shown[place([8, 20])] =
            Half { count: 15.0, brightness: 1.0, variance: 3.0, by_all: 3.0, spread: 3.0, is_open: true };
        let got = variances(&shown, &shown);
        let one = CHANCE * 16.0 / 64.0;
        let sum = |x: usize| got[place([x, 16])..][..PIXELS].iter().sum::<f64>();
        assert!((sum(8) - one).abs() < 1e-12 && (sum(0) - one).abs() < 1e-12, "{} {}", sum(8), sum(0));
        let dark = CHANCE * 0.01 * 0.01 / 64.0;
        assert!((sum(16) - dark).abs() < 1e-12, "{}", sum(16));
        // Three columns of five rows of the lamp's own block, and two of the one beside it.
        let lit = |x: usize, y: usize| got[place([x, y])] > 0.01;
        for (x, y, is_lit) in [(10, 22, true), (11, 20, false), (6, 18, true), (5, 20, false), (8, 23, false)]
        {
            assert_eq!(lit(x, y), is_lit, "{x} {y}");
        }
        // What may lie anywhere in the lamp's own block takes a little of it.
        let [own, beside] = [got[place([8, 20])], got[place([7, 20])]];
        assert!(own < one / 15.0 && own > 0.9 * one / 15.0 && (beside - one / 10.0).abs() < 1e-3);
    }

    /// Light that one path in many finds may lie in any block of the district whose samples differ, until there are many of them.
    #[test]
    fn what_is_bright_may_lie_far_away() {
        let dark = |count| Half { count, brightness: 0.01, is_open: true, ..Half::default() };
        let hidden = |count: f64, spread: f64| {
            let mut shown = vec![dark(15.0); ALL];
            shown[place([40, 40])] = Half { brightness: 1.0, spread: 3.0, ..dark(15.0) };
            for half in &mut shown[..PIXELS] {
                *half = Half { spread, ..dark(count) };
            }
            variances(&shown, &shown)[..PIXELS].iter().sum::<f64>()
        };
        let (alike, far) = (CHANCE * 0.01 * 0.01 / 64.0, FAR * 16.0);
        assert!((hidden(15.0, 0.0) - alike).abs() < 1e-12);
        assert!((hidden(15.0, 1e-3) - far / 256.0).abs() < 1e-12);
        assert!((hidden(15.0, 1e-6) - 0.01 * far / 256.0).abs() < 1e-12);
        assert!((hidden(1023.0, 1e-3) - far / (1024.0 * 1024.0)).abs() < 1e-12);
    }

    /// A half that has ended early would keep the other going for ever.
    #[test]
    fn an_ended_half_counts_as_if_it_had_gone_on() {
        let mut shown = vec![Half { count: 15.0, ..Half::default() }; ALL];
        shown[place([8, 20])] = Half { count: 15.0, brightness: 1.0, spread: 3.0, ..Half::default() };
        let own = vec![Half { count: 255.0, is_open: true, ..Half::default() }; ALL];
        let sum = |own: &[Half]| variances(own, &shown)[place([0, 16])..][..PIXELS].iter().sum::<f64>();
        assert!((sum(&own) - possible(4.0, 255.0)).abs() < 1e-12);
        assert!((sum(&shown) - possible(4.0, 15.0)).abs() < 1e-12);
    }

    #[test]
    fn nothing_lies_outside_of_the_picture() {
        let mut shown = vec![Half::default(); ALL];
        shown[0] =
            Half { count: 4.0, brightness: 1.0, variance: 1.0, by_all: 1.0, spread: 1.0, is_open: true };
        let got = variances(&shown, &shown);
        assert_eq!(got[0], possible(2.0, 4.0));
        assert_eq!(got.iter().filter(|v| **v != 0.0).count(), 1);
    }
}
