//! Renders that stop where the picture is good enough.

use crate::common;

use straal::{Control, Overrides, PatternKind, Picture, Verdict};

const SCENE: &str = "scenes/reference/box-diffuse.yaml";

/// 40 x 37 pixels whose blocks get from 64 to 192 samples.
fn wish() -> Overrides {
    Overrides { size: Some([40, 37]), spp: Some(256), noise: Some(0.14), ..Overrides::default() }
}

fn bits(p: &Picture, [x, y]: [u32; 2]) -> ([u32; 3], [u32; 3], u32) {
    let i = y as usize * p.layers.width + x as usize;
    (p.layers.rgb[i].map(f32::to_bits), error_of(p, i).map(f32::to_bits), p.layers.samples[i])
}

/// What the layer `error` tells of a pixel.
fn error_of(p: &Picture, i: usize) -> [f32; 3] {
    p.layers.error.as_ref().expect("the layer `error`").rgb[i]
}

fn range(p: &Picture) -> [u32; 2] {
    let counts = &p.layers.samples;
    [*counts.iter().min().expect("pixels"), *counts.iter().max().expect("pixels")]
}

#[test]
fn threads_tiles_batches_and_passes_change_nothing() {
    let plain = common::render(SCENE, wish()).picture;
    let [least, most] = range(&plain);
    assert!(least <= 64 && most >= 128, "{least} to {most} samples");
    for other in [
        Overrides { threads: Some(1), ..wish() },
        Overrides { threads: Some(7), batch: Some(7), shuffle_tiles: Some(5), ..wish() },
    ] {
        assert_eq!(common::render(SCENE, other).picture.layers, plain.layers);
    }
    let sobol = || Overrides { pattern: Some(PatternKind::Sobol), noise: Some(0.12), ..wish() };
    let one = common::render(SCENE, Overrides { threads: Some(1), ..sobol() }).picture;
    let [least, most] = range(&one);
    assert!(least <= 64 && most >= 128, "{least} to {most} Sobol points");
    let other = Overrides { threads: Some(7), batch: Some(7), shuffle_tiles: Some(5), ..sobol() };
    assert_eq!(common::render(SCENE, other).picture.layers, one.layers);
    // Ended between two checks, it is the picture of as many samples.
    let mut until_80 = |p: &straal::Progress| if p.samples >= 80 { Verdict::Stop } else { Verdict::GoOn };
    for wish in [wish(), sobol()] {
        let job = common::job(SCENE, wish.clone());
        let ended = job.render(&mut Control::new(&mut until_80)).expect("a picture");
        let asked = common::render(SCENE, Overrides { spp: Some(ended.samples), ..wish });
        assert_eq!(ended.picture.layers, asked.picture.layers);
        assert!(!ended.complete && asked.complete);
    }
}

#[test]
fn a_crop_is_cut_from_the_whole() {
    // In one district, and in the middle one of three.
    let wide = Overrides { size: Some([136, 20]), spp: Some(96), noise: Some(0.15), ..wish() };
    for (wish, [x0, y0, x1, y1]) in [(wish(), [11, 5, 27, 37]), (wide, [70, 3, 90, 17])] {
        let whole = common::render(SCENE, wish.clone()).picture;
        let crop = common::render(SCENE, Overrides { crop: Some([x0, y0, x1, y1]), ..wish }).picture;
        for y in y0..y1 {
            for x in x0..x1 {
                assert_eq!(bits(&crop, [x - x0, y - y0]), bits(&whole, [x, y]), "pixel {x},{y}");
            }
        }
    }
}

/// A lamp in the dark, by independent samples: a block beside it of which a sliver of one pixel shines. Alone, most halves of that block would end black.
#[test]
fn a_sliver_of_a_lamp_is_not_missed() {
    let text = "camera: { orthographic: { eye: [8, 8, 5], look_at: [8, 8, 0], width: 16 } }\n\
                film: { size: [16, 16], filter: box }\n\
                world:\n  - disc: { center: [4.89, 11, 0], normal: [0, 0, 1], radius: 3.15, emission: 20 }\n";
    let (target, n) = (0.5, 32);
    let render = |seed| {
        let loaded = straal::load_str("lamp", text, &common::project(), &straal::LoadOptions::default());
        let wish = Overrides {
            noise: Some(target),
            spp: Some(65_536),
            pattern: Some(PatternKind::Random),
            seed: Some(seed),
            ..Overrides::default()
        };
        let job = straal::Job::new(loaded.expect("a scene"), wish).expect("a job");
        job.render(&mut Control::to_the_end()).expect("a picture").picture.layers
    };
    let runs: Vec<_> = (0..n).map(render).collect();
    // The disc reaches from 8 to 8.04 in the block on the right, whose first row is that of y from 16 to 15.
    let values = |k: usize| runs.iter().map(move |l| f64::from(l.rgb[k / 8 * 16 + 8 + k % 8][0]));
    let (mut mean, mut variance) = (0.0, 0.0);
    for k in 0..64 {
        let m = values(k).sum::<f64>() / n as f64;
        mean += m / 64.0;
        variance += values(k).map(|v| (v - m) * (v - m)).sum::<f64>() / (n - 1) as f64 / 64.0;
    }
    // The part of the disc beyond the block's left side, by the midpoint rule.
    let (r, d) = (3.15_f64, 3.11_f64);
    let middles = (0..1000).map(|i| d + (r - d) * (f64::from(i) + 0.5) / 1000.0);
    let area = middles.map(|x| 2.0 * (r * r - x * x).sqrt()).sum::<f64>() * (r - d) / 1000.0;
    let truth = 20.0 * area / 64.0;
    assert!((mean - truth).abs() < 4.0 * (variance / (64 * n) as f64).sqrt(), "{mean}, not {truth}");
    let noise = variance.sqrt() / if truth > 0.01 { truth } else { 0.01 };
    // With the 32 samples after which most halves look black it is thirteen times what was asked for.
    assert!(noise < 1.5 * target, "{noise}");
}

#[test]
fn it_ends_by_itself_and_keeps_its_word() {
    let target = 0.08;
    let wish =
        Overrides { size: Some([32, 32]), spp: Some(100_000), noise: Some(target), ..Overrides::default() };
    let outcome = common::render(SCENE, wish);
    assert!(outcome.complete && outcome.samples < 4096, "{} samples", outcome.samples);
    // The noise of each block as it is told by the layer `variance`, the halves of a block together.
    let layers = &outcome.picture.layers;
    let mut above = 0;
    let mut blocks = 0;
    for by in 0..layers.height / 8 {
        for bx in 0..layers.width / 8 {
            let (mut variance, mut brightness) = (0.0, 0.0);
            for k in 0..64 {
                let i = (8 * by + k / 8) * layers.width + 8 * bx + k % 8;
                variance += layers.variance[i].iter().map(|&v| f64::from(v)).sum::<f64>() / 192.0;
                brightness += layers.rgb[i].iter().map(|&v| f64::from(v)).sum::<f64>() / 192.0;
            }
            blocks += 1;
            above += usize::from(variance.sqrt() / brightness > 1.25 * target);
        }
    }
    assert!(above * 10 <= blocks, "{above} of {blocks} blocks are far above the target");
}

/// Sobol points, judged by batches: what is left is measured between seeds, and must be as little as was asked for; and
/// independent samples must have needed more.
#[test]
fn noise_of_well_spread_samples_is_told_as_it_is() {
    let target = 0.08;
    let wish = |kind, seed| Overrides {
        size: Some([32, 32]),
        spp: Some(100_000),
        noise: Some(target),
        pattern: Some(kind),
        seed: Some(seed),
        ..Overrides::default()
    };
    let runs: Vec<Picture> =
        (0..12).map(|seed| common::render(SCENE, wish(PatternKind::Sobol, seed)).picture).collect();
    let n = runs.len() as f64;
    let samples = |p: &Picture| p.layers.samples.iter().map(|&s| f64::from(s)).sum::<f64>() / 1024.0;
    let (mut worst, mut squares, mut told, mut truth) = (0.0, 0.0, 0.0, 0.0);
    for block in 0..16 {
        let (mut variance, mut brightness) = (0.0, 0.0);
        for k in 0..64 {
            let i = (block / 4 * 8 + k / 8) * 32 + block % 4 * 8 + k % 8;
            for c in 0..3 {
                let values = || runs.iter().map(|p| f64::from(p.layers.rgb[i][c]));
                let mean = values().sum::<f64>() / n;
                variance += values().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
                brightness += mean;
                let errors = || runs.iter().map(|p| f64::from(error_of(p, i)[c]));
                told += errors().map(|e| e * e).sum::<f64>() / n;
            }
        }
        truth += variance;
        let noise = (variance / 192.0).sqrt() / (brightness / 192.0);
        worst = if noise > worst { noise } else { worst };
        squares += noise * noise / 16.0;
    }
    let typical = squares.sqrt();
    assert!(typical < target && worst < 1.25 * target, "{typical} typically, {worst} at worst");
    assert!(typical > 0.5 * target, "{typical}: far more samples than need be");
    let told = (told / truth).sqrt();
    assert!((0.9..1.7).contains(&told), "the layer `error` tells {told} of the truth");
    let (sobol, random) =
        (samples(&runs[0]), samples(&common::render(SCENE, wish(PatternKind::Random, 0)).picture));
    assert!(sobol < 0.9 * random, "{sobol} Sobol points, {random} independent ones");
}

/// Lamps in the dark, seen from straight ahead by four blocks of pixels of one unit. What each block shows is known: the area of its lamps. One has
/// a corner of a single pixel, one an edge through all of its rows, one many small lamps, and one is bright all over but for an edge.
#[test]
fn stopping_early_does_not_darken() {
    // Corner and edges of each lamp, and the block that it lies in.
    let mut lamps = vec![([14.1, 14.2, 0.3, 0.3], 0), ([0.0, 8.0, 3.35, 8.0], 1), ([8.0, 0.0, 8.0, 6.63], 3)];
    lamps.extend((0..16).map(|i| {
        let [x, y] = [i % 4, i / 4].map(f64::from);
        ([2.0 * x + 0.3, 2.0 * y + 0.1 * x, 0.4, 0.2 + 0.1 * y], 2)
    }));
    let mut text = String::from(
        "camera: { orthographic: { eye: [8, 8, 5], look_at: [8, 8, 0], width: 16 } }\nfilm: { size: [16, 16], filter: box }\nworld:\n",
    );
    let mut truth = [0.0; 4];
    for ([x, y, w, h], block) in lamps {
        text += &format!(
            "  - rectangle: {{ corner: [{x}, {y}, 0], edges: [[{w}, 0, 0], [0, {h}, 0]], emission: 1 }}\n"
        );
        truth[block] += w * h / 64.0;
    }
    for (kind, noise) in [(PatternKind::Random, 0.4), (PatternKind::Sobol, 0.15)] {
        let n = 256;
        let mut counts = [0.0; 4];
        let mut sums = [[0.0; 2]; 4];
        for seed in 0..n {
            let wish = Overrides {
                noise: Some(noise),
                spp: Some(256),
                pattern: Some(kind),
                seed: Some(seed),
                ..Overrides::default()
            };
            let loaded =
                straal::load_str("lamps", &text, &common::project(), &straal::LoadOptions::default());
            let job = straal::Job::new(loaded.expect("a scene"), wish).expect("a job");
            let layers = job.render(&mut Control::to_the_end()).expect("a picture").picture.layers;
            // The picture's first rows are the highest.
            let corners = [[8, 0], [0, 0], [0, 8], [8, 8]];
            for (([x, y], truth), (count, sum)) in
                corners.into_iter().zip(truth).zip(counts.iter_mut().zip(&mut sums))
            {
                let at = |k: usize| (y + k / 8) * 16 + x + k % 8;
                let mean = (0..64).map(|k| f64::from(layers.rgb[at(k)][0])).sum::<f64>() / 64.0;
                *count += (0..64).map(|k| f64::from(layers.samples[at(k)])).sum::<f64>() / (64 * n) as f64;
                sum[0] += mean / n as f64;
                sum[1] += (mean - truth) * (mean - truth);
            }
        }
        for (block, ([mean, squares], truth)) in sums.into_iter().zip(truth).enumerate() {
            let error = squares.sqrt() / n as f64;
            assert!(
                (mean - truth).abs() < 3.0 * error,
                "{kind}, block {block}: {mean} +- {error}, not {truth}"
            );
        }
        assert!(counts.iter().any(|c| *c < 64.0) && counts.iter().any(|c| *c > 64.0), "{kind}: {counts:?}");
    }
}

#[test]
fn what_is_noisier_than_asked_is_counted() {
    let few = Overrides { noise: Some(0.001), spp: Some(20), ..wish() };
    // 40 x 37 pixels are 5 x 5 blocks.
    assert_eq!(common::render(SCENE, few.clone()).noisy_blocks, 25);
    assert_eq!(common::render(SCENE, Overrides { noise: Some(0.9), spp: Some(64), ..few }).noisy_blocks, 0);
}

#[test]
fn patterns_that_must_know_their_number_are_refused() {
    let loaded =
        straal::load(&common::project().join(SCENE), &straal::LoadOptions::default()).expect("a scene");
    let wish = Overrides { pattern: Some(PatternKind::NRooks), ..wish() };
    let refused = straal::Job::new(loaded, wish).err().expect("a refusal").to_string();
    assert!(refused.starts_with("the sampler n_rooks must know how many samples"), "{refused}");
}
