use super::*;

/// The statistic of Pearson's test that `values` in [0, 1) are even over `bins`.
fn chi_square(values: impl Iterator<Item = f32>, bins: usize) -> f64 {
    let mut counts = vec![0_u32; bins];
    let mut n = 0;
    for v in values {
        counts[(v * bins as f32) as usize] += 1;
        n += 1;
    }
    let want = f64::from(n) / bins as f64;
    counts.iter().map(|&c| (f64::from(c) - want).powi(2) / want).sum()
}

/// Whether a chi-square statistic is within 5 standard deviations of its mean, on either side.
fn plausible(statistic: f64, degrees: usize) -> bool {
    (statistic - degrees as f64).abs() < 5.0 * (2.0 * degrees as f64).sqrt()
}

#[test]
fn numbers_are_in_the_unit_interval() {
    assert_eq!(to_unit::<f32>(u32::MAX), 1.0 - 2f32.powi(-24));
    for kind in PatternKind::ALL {
        // A set of fewer is gone beyond.
        let pattern = Pattern::new(kind, 1000);
        assert_eq!(pattern.kind(), kind);
        for index in 0..4096 {
            let name = pattern.name(7, [3, 5], index);
            assert_eq!(name.index(), index);
            let four = pattern.d4(&name, Purpose::Film);
            let three = pattern.d3(&name, Purpose::Film);
            let one = pattern.d1(&name, Purpose::Film);
            assert!(four.iter().chain(&three).chain([&one]).all(|u| (0.0..1.0).contains(u)));
            assert_eq!(three[..2], four[..2]);
            assert_eq!(pattern.d2(&name, Purpose::Film), four[..2]);
            if matches!(kind, PatternKind::Random | PatternKind::Sobol) {
                assert_eq!(three[2], four[2]);
                assert_eq!(one, four[0]);
            }
        }
    }
}

#[test]
fn sobol_is_stratified_in_every_elementary_interval() {
    for (seed, purpose) in [(1, Purpose::Direction), (2, Purpose::LightPoint), (3, Purpose::Film)] {
        for k in 0..=10_u32 {
            for block in [0, 1, 5] {
                let names: Vec<_> = (block << k..(block + 1) << k)
                    .map(|i| SampleName::new(seed, [11, 4], i).child(1))
                    .collect();
                let two: Vec<_> = names.iter().map(|n| Pattern::Sobol.d2(n, purpose)).collect();
                let four: Vec<_> = names.iter().map(|n| Pattern::Sobol.d4(n, purpose)).collect();
                let once = |cells: &mut dyn Iterator<Item = usize>| {
                    let mut hit = vec![false; 1 << k];
                    cells.for_each(|c| {
                        assert!(!std::mem::replace(&mut hit[c], true), "cell {c} of 2^{k} twice")
                    });
                };
                let cell = |u: f32, bits: u32| (u * (1_u32 << bits) as f32) as usize;
                for x in 0..=k {
                    once(&mut two.iter().map(|u| cell(u[0], x) << (k - x) | cell(u[1], k - x)));
                    once(&mut four.iter().map(|u| cell(u[0], x) << (k - x) | cell(u[1], k - x)));
                }
                for d in 0..4 {
                    once(&mut four.iter().map(|u| cell(u[d], k)));
                }
                once(&mut names.iter().map(|n| cell(Pattern::Sobol.d1(n, purpose), k)));
            }
        }
    }
}

#[test]
fn a_direction_and_what_is_drawn_where_it_leads_are_spread_together() {
    // Of all ways to cut both pairs into 2^k boxes, those in which each of 2^k samples has a box of its own.
    let alone = |four: &[[f32; 4]], cuts: [u32; 4]| {
        let mut hit = vec![false; four.len()];
        four.iter().all(|u| {
            let cells = u.iter().zip(cuts);
            let cell = cells.fold(0, |cell, (u, k)| cell << k | (u * (1_u32 << k) as f32) as usize);
            !std::mem::replace(&mut hit[cell], true)
        })
    };
    for (k, least) in [(4, 19), (6, 43), (8, 83)] {
        for (seed, purpose) in [(1, Purpose::LightPoint), (2, Purpose::Direction)] {
            for block in [0, 3] {
                let names = (block << k..(block + 1) << k)
                    .map(|i| Pattern::Sobol.name(seed, [7, 9], i).child(0).child(0));
                let drawn = names.map(|name: SampleName| {
                    let [a, b] = Pattern::Sobol.d2(&name, Purpose::Direction);
                    let [c, d] = Pattern::Sobol.d2(&name.child(0), purpose);
                    [a, b, c, d]
                });
                let four: Vec<_> = drawn.collect();
                let mut good = 0;
                for a in 0..=k {
                    for b in 0..=k - a {
                        for c in 0..=k - a - b {
                            let cuts = [a, b, c, k - a - b - c];
                            let is_of_both = a + b > 0 && a + b < k;
                            good += u32::from(is_of_both && alone(&four, cuts));
                        }
                    }
                }
                assert!(good >= least, "2^{k} samples, {purpose:?}: {good} of at least {least}");
            }
        }
    }
}

/// Pairs of numbers that should know nothing of one another, by which part of the name differs.
fn strangers(pattern: Pattern, i: u32) -> Vec<[f32; 2]> {
    let at = |pixel, index, purpose| pattern.d1(&pattern.name(9, pixel, index), purpose);
    let name = pattern.name(9, [i % 256, i / 256], 3);
    let four = pattern.d4(&name, Purpose::Film);
    let two = pattern.d2(&name, Purpose::Direction);
    vec![
        [at([0, 0], i, Purpose::Lobe), at([0, 0], i, Purpose::Roulette)],
        [at([0, 0], i, Purpose::Lobe), at([1, 0], i, Purpose::Lobe)],
        [at([5, 5], i, Purpose::Lobe), at([5, 6], i, Purpose::Lobe)],
        [
            pattern.d1(&pattern.name(1, [2, 2], i), Purpose::Lobe),
            pattern.d1(&pattern.name(2, [2, 2], i), Purpose::Lobe),
        ],
        [
            pattern.d1(&pattern.name(9, [8, 8], i).child(0), Purpose::Lobe),
            pattern.d1(&pattern.name(9, [8, 8], i).child(0).child(0), Purpose::Lobe),
        ],
        // Across pixels, for one and the same sample index.
        [pattern.d1(&name, Purpose::Lobe), pattern.d1(&name, Purpose::LightChoice)],
        [pattern.d1(&name, Purpose::Lobe), pattern.d1(&name.child(0), Purpose::Lobe)],
        [four[0], four[1]],
        [four[1], four[2]],
        [four[2], four[3]],
        two,
        [two[0], pattern.d2(&name, Purpose::LightPoint)[0]],
        [two[0], four[0]],
    ]
}

#[test]
fn different_names_are_independent() {
    const N: u32 = 1 << 16;
    const SIDE: usize = 16;
    // What is regular has its order alone to be independent by, and only as many values as cells.
    for kind in PatternKind::ALL.into_iter().filter(|k| k.is_unbiased()) {
        let pattern = Pattern::new(kind, N);
        let pairs: Vec<_> = (0..N).map(|i| strangers(pattern, i)).collect();
        for kind in 0..pairs[0].len() {
            let of_kind = || pairs.iter().map(|p| p[kind]);
            let covariance: f64 =
                of_kind().map(|[a, b]| (f64::from(a) - 0.5) * (f64::from(b) - 0.5)).sum::<f64>()
                    / f64::from(N);
            // The product of two centred uniform numbers has standard deviation 1/12.
            assert!(
                covariance.abs() < 5.0 / 12.0 / f64::from(N).sqrt(),
                "{pattern:?}, pair {kind}: {covariance}"
            );
            let cells = of_kind().map(|[a, b]| ((a * SIDE as f32).floor() + b) / SIDE as f32);
            let statistic = chi_square(cells, SIDE * SIDE);
            // Stratified margins may make counts evener than chance, never less even.
            let degrees = SIDE * SIDE - 1;
            let fine =
                plausible(statistic, degrees) || (pattern != Pattern::Random && statistic < degrees as f64);
            assert!(fine, "{pattern:?}, pair {kind}: {statistic}");
        }
    }
}

#[test]
fn random_numbers_are_uniform_along_every_axis() {
    const N: u32 = 1 << 16;
    let pattern = Pattern::Random;
    let axes: [fn(u32) -> SampleName; 5] = [
        |i| SampleName::new(0, [0, 0], i),
        |i| SampleName::new(0, [i, 0], 0),
        |i| SampleName::new(0, [0, i], 0),
        |i| SampleName::new(u64::from(i), [0, 0], 0),
        |i| SampleName::new(0, [0, 0], 0).child(i),
    ];
    for (axis, name) in axes.iter().enumerate() {
        for purpose in Purpose::ALL {
            let statistic = chi_square((0..N).map(|i| pattern.d1(&name(i), purpose)), 1000);
            assert!(plausible(statistic, 999), "axis {axis}, {purpose:?}: {statistic}");
            // Neighbours on the axis.
            let pairs = (0..N).map(|i| {
                let (a, b) = (pattern.d1(&name(i), purpose), pattern.d1(&name(i + 1), purpose));
                ((a * 32.0).floor() + b) / 32.0
            });
            let statistic = chi_square(pairs, 1024);
            assert!(plausible(statistic, 1023), "axis {axis}, {purpose:?}, neighbours: {statistic}");
        }
    }
}

#[test]
fn scrambles_are_uniform_over_pixels() {
    // One sample of many pixels is as good as random: no pixel's first sample favours a place, even in a set whose
    // number has no good grid. Dealt out over the pixels, points are evener than that.
    for kind in PatternKind::ALL.into_iter().filter(|k| k.is_unbiased()) {
        let pattern = Pattern::new(kind, 7);
        let fine = |statistic: f64, degrees: usize| {
            plausible(statistic, degrees) || (kind == PatternKind::BlueSobol && statistic < degrees as f64)
        };
        for index in [0, 1, 6] {
            let names = || (0..1_u32 << 16).map(move |i| pattern.name(4, [i % 256, i / 256], index));
            for d in 0..4 {
                let statistic = chi_square(names().map(|n| pattern.d4(&n, Purpose::Film)[d]), 1000);
                assert!(fine(statistic, 999), "{kind}, index {index}, dimension {d}: {statistic}");
            }
            let statistic = chi_square(names().map(|n| pattern.d1(&n, Purpose::Lobe)), 1000);
            assert!(fine(statistic, 999), "{kind}, index {index}: {statistic}");
            let cells = names().map(|n| {
                let [u, v] = pattern.d2(&n, Purpose::Direction);
                ((u * 32.0).floor() * 32.0 + (v * 32.0).floor() + 0.5) / 1024.0
            });
            let statistic = chi_square(cells, 1024);
            assert!(fine(statistic, 1023), "{kind}, index {index}, square: {statistic}");
        }
    }
}

/// How often each of `cells` is met.
fn tally(cells: impl Iterator<Item = usize>, n: usize) -> Vec<u32> {
    let mut counts = vec![0; n];
    cells.for_each(|c| counts[c] += 1);
    counts
}

/// One number, and four of another purpose.
type Drawn = (f32, [f32; 4]);

#[test]
fn sets_have_the_strata_they_promise() {
    for count in [1, 5, 12, 16, 61, 64] {
        let set = Set::new(count);
        let [columns, rows] = set.grid();
        let draw = |kind, index| {
            let pattern = Pattern::new(kind, count);
            let name = pattern.name(5, [9, 2], index).child(0);
            (pattern.d1(&name, Purpose::Lobe), pattern.d4(&name, Purpose::Direction))
        };
        let cell = |u: f32, n: u32| (f64::from(u) * f64::from(n)) as usize;
        for kind in PatternKind::ALL.into_iter().filter(|k| k.needs_count()) {
            let all: Vec<_> = (0..count).map(|i| draw(kind, i)).collect();
            let of = |f: &dyn Fn(&Drawn) -> usize, n: u32| tally(all.iter().map(f), n as usize);
            let once = |counts: Vec<u32>| counts.iter().all(|&c| c == 1);
            let most_once = |counts: Vec<u32>| counts.iter().all(|&c| c <= 1);
            if kind != PatternKind::Hammersley && kind != PatternKind::BlueSobol {
                assert!(once(of(&|p| cell(p.0, count), count)), "{kind}, {count}: one dimension");
            }
            for pair in [0, 2] {
                let in_grid =
                    |p: &Drawn| cell(p.1[pair], columns) + cell(p.1[pair + 1], rows) * columns as usize;
                if matches!(kind, PatternKind::Regular | PatternKind::Jittered) {
                    assert!(most_once(of(&in_grid, columns * rows)), "{kind}, {count}: grid");
                }
                if matches!(kind, PatternKind::NRooks | PatternKind::MultiJittered) {
                    assert!(once(of(&|p| cell(p.1[pair + 1], count), count)), "{kind}, {count}: rows");
                    let fine = if kind == PatternKind::NRooks { count } else { columns * rows };
                    assert!(most_once(of(&|p| cell(p.1[pair], fine), fine)), "{kind}, {count}: columns");
                }
                if kind == PatternKind::MultiJittered && columns * rows == count {
                    assert!(once(of(&in_grid, count)), "{kind}, {count}: grid");
                }
            }
        }
    }
}

#[test]
fn nodes_differ_along_and_across_paths() {
    let mut seen = std::collections::BTreeSet::new();
    let mut node = ROOT_NODE;
    for _depth in 0..1000 {
        for branch in 0..32 {
            assert!(seen.insert(child_node(node, branch)));
        }
        node = child_node(node, 0);
    }
}

#[test]
fn numbers_stay_what_they_are() {
    // Pictures are reproduced from their names: these values are part of the format.
    let name = SampleName::new(1, [2, 3], 4).child(5);
    let got = [
        Pattern::Random.d1(&name, Purpose::Lobe).to_bits(),
        Pattern::Sobol.d1(&name, Purpose::Lobe).to_bits(),
        Pattern::Sobol.d2(&name, Purpose::Direction)[1].to_bits(),
        Pattern::Sobol.d4(&name, Purpose::Film)[3].to_bits(),
    ];
    assert_eq!(got, [1064891021, 1058347246, 1050726398, 1060933944]);
}
