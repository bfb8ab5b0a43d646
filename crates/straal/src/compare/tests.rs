//! The comparison's own power and restraint, on pictures whose truth is known.

use straal_math::ops::{ln_d, sin_cos_d};

use super::*;

/// Random numbers from a seed: SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number from the normal distribution of mean 0 and variance 1 (Box and Muller 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * ln_d(1.0 - self.uniform())).sqrt();
        radius * sin_cos_d(std::f64::consts::TAU * self.uniform()).0
    }
}

const WIDTH: usize = 64;
const HEIGHT: usize = 60;

/// What the noise of one sample around the true value 1 is like; all have mean 1.
#[derive(Clone, Copy)]
enum Noise {
    /// Normal with this standard deviation.
    Normal(f64),
    /// Light that one path in so many finds.
    HitOrMiss(f64),
    /// Normal noise of a tenth, and one path in 3000 that brings a part of the light 300 times over.
    Spikes,
}

impl Noise {
    /// The mean of `n` samples.
    fn mean(self, n: usize, random: &mut Random) -> f64 {
        let root = (n as f64).sqrt();
        let mut hits =
            |one_in: f64| (0..n).filter(|_| random.uniform() * one_in < 1.0).count() as f64 / n as f64;
        match self {
            Self::Normal(deviation) => 1.0 + deviation * random.normal() / root,
            Self::HitOrMiss(one_in) => hits(one_in) * one_in,
            Self::Spikes => hits(3000.0) * 300.0 + 0.9 + 0.1 * random.normal() / root,
        }
    }
}

/// A picture of `truth` and its variance, from 16 replicates of `samples` samples.
fn render(truth: &Image, noise: Noise, samples: usize, seed: u64) -> (Image, Image) {
    let mut random = Random(seed.wrapping_mul(0x1234_5678_9abc_def1));
    let (mut mean, mut variance) = (truth.clone(), truth.clone());
    for (pixel, spread) in mean.pixels.iter_mut().zip(&mut variance.pixels) {
        let replicates: Vec<f64> = (0..16).map(|_| noise.mean(samples, &mut random)).collect();
        let average = replicates.iter().sum::<f64>() / 16.0;
        let square = replicates.iter().map(|v| (v - average) * (v - average)).sum::<f64>() / (15.0 * 16.0);
        // The channels of a pixel share their paths.
        for (value, spread) in pixel.iter_mut().zip(spread) {
            *spread = (square * f64::from(*value) * f64::from(*value)) as f32;
            *value = (average * f64::from(*value)) as f32;
        }
    }
    (mean, variance)
}

/// A picture with edges, ramps and black parts.
fn truth() -> Image {
    let pixels = (0..WIDTH * HEIGHT)
        .map(|i| {
            let (x, y) = (i % WIDTH, i / WIDTH);
            let edge = if (x / 10 + y / 7) % 2 == 0 { 1.0 } else { 0.3 };
            let v = edge * (0.2 + x as f32 / WIDTH as f32);
            if y < 4 { [0.0; 3] } else { [v, 0.5 * v, 0.1 + 0.2 * v] }
        })
        .collect();
    Image { width: WIDTH, height: HEIGHT, pixels }
}

fn scaled(image: &Image, by: f32) -> Image {
    let pixels = image.pixels.iter().map(|pixel| pixel.map(|v| v * by)).collect();
    Image { pixels, ..image.clone() }
}

/// The picture moved to the right by a pixel.
fn shifted(image: &Image) -> Image {
    let pixels =
        (0..image.pixels.len()).map(|i| image.pixels[if i % WIDTH > 0 { i - 1 } else { i }]).collect();
    Image { pixels, ..image.clone() }
}

/// Compares pictures of two truths with independent noise.
fn judge(a: &Image, b: &Image, noise: Noise, tails: Tails, seed: u64) -> Comparison {
    // B is the reference: eight times the samples.
    let (a, va) = render(a, noise, 4, 2 * seed);
    let (b, vb) = render(b, noise, 32, 2 * seed + 1);
    compare(Estimate::new(&a, Some(&va)), Estimate::new(&b, Some(&vb)), tails).unwrap()
}

#[test]
fn equal_pictures_pass() {
    let truth = truth();
    for seed in 0..30 {
        for (noise, tails) in [
            (Noise::Normal(0.3), Tails::Light),
            (Noise::HitOrMiss(20.0), Tails::Light),
            (Noise::Normal(0.3), Tails::Heavy),
            (Noise::Spikes, Tails::Heavy),
        ] {
            let found = judge(&truth, &truth, noise, tails, seed);
            assert!(!found.differs, "seed {seed}: {found:?}");
            assert!(found.pixels.tested > 1000 && found.blocks.tested > 150);
        }
    }
}

#[test]
fn a_hundredth_more_light_is_found() {
    let (truth, brighter) = (truth(), scaled(&truth(), 1.01));
    for seed in 0..8 {
        for (a, b) in [(&brighter, &truth), (&truth, &brighter)] {
            let found = judge(a, b, Noise::Normal(0.3), Tails::Light, seed);
            assert!(found.differs && found.reasons[0].contains("the mean of red"), "seed {seed}: {found:?}");
        }
        let found = judge(&scaled(&truth, 1.02), &truth, Noise::Normal(0.3), Tails::Heavy, seed);
        assert!(found.differs, "seed {seed}: {found:?}");
    }
}

#[test]
fn a_shift_by_a_pixel_is_found() {
    let truth = truth();
    for seed in 0..8 {
        for noise in [Noise::Normal(0.3), Noise::HitOrMiss(5.0)] {
            let found = judge(&shifted(&truth), &truth, noise, Tails::Light, seed);
            assert!(found.reasons.iter().any(|reason| reason.contains("pixel")), "seed {seed}: {found:?}");
        }
        let found = judge(&shifted(&truth), &truth, Noise::Normal(0.3), Tails::Heavy, seed);
        assert!(found.reasons.iter().any(|reason| reason.contains("blocks")), "seed {seed}: {found:?}");
    }
}

#[test]
fn a_wrong_corner_is_found_where_the_mean_is_right() {
    let truth = truth();
    let mut wrong = truth.clone();
    for i in 0..WIDTH * HEIGHT {
        let (x, y) = (i % WIDTH, i / WIDTH);
        if (16..24).contains(&y) && x < 16 {
            wrong.pixels[i] = wrong.pixels[i].map(|v| v * if x < 8 { 1.1 } else { 0.9 });
        }
    }
    let found = judge(&wrong, &truth, Noise::Normal(0.3), Tails::Light, 1);
    assert!(found.reasons.iter().any(|reason| reason.contains("the block at")), "{found:?}");
    assert!(found.blocks.worst_at[1] == 16 && found.blocks.worst_at[0] < 16);
}

/// Student's t as it stands: of skewed noise more values are beyond its bound than there should be, and equal
/// pictures would be told apart. This is why noise is borrowed.
#[test]
fn skewed_noise_needs_the_other_pictures_variance() {
    let truth = truth();
    let (a, va) = render(&truth, Noise::HitOrMiss(20.0), 4, 5);
    let (b, vb) = render(&truth, Noise::HitOrMiss(20.0), 32, 6);
    let values = Values { a: Estimate::new(&a, Some(&va)), b: Estimate::new(&b, Some(&vb)) };
    let ratio = values.noise_ratio();
    assert!((6.0..10.0).contains(&ratio.unwrap()), "{ratio:?}");
    let (mut plain, mut borrowing) = (Tests::default(), Tests::default());
    for i in 0..WIDTH * HEIGHT {
        let mut sums = Sums::default();
        sums.add(values.at(i).unwrap()[0]);
        plain.add(0, [i, 0], sums.welch([15.0; 2]));
        borrowing.add(0, [i, 0], sums.borrowing(ratio).welch([15.0; 2]));
    }
    assert!(plain.finish().p_count < ALPHA, "{:?}", plain.finish());
    assert!(borrowing.finish().p_count > ALPHA, "{:?}", borrowing.finish());
}

#[test]
fn values_without_noise_agree_to_four_digits() {
    let truth = truth();
    let bare =
        |a: &Image, b: &Image| compare(Estimate::new(a, None), Estimate::new(b, None), Tails::Light).unwrap();
    let same = bare(&scaled(&truth, 1.00005), &truth);
    assert!(!same.differs && same.pixels.tested == 0 && same.blocks.tested == 0);
    assert_eq!(same.exact.compared, 3 * WIDTH * HEIGHT);
    assert_eq!(same.relmse, None);
    let other = bare(&scaled(&truth, 1.001), &truth);
    assert!(other.differs && other.exact.differing > 1000, "{other:?}");
    assert_eq!(other.reasons.len(), 1, "{other:?}");
    // Beyond 1 the digits count, not the places.
    let bright = scaled(&truth, 1e6);
    assert!(!bare(&scaled(&bright, 1.00005), &bright).differs);
}

#[test]
fn where_one_picture_is_sure_the_block_counts() {
    let truth = truth();
    let (a, va) = render(&truth, Noise::Normal(0.3), 4, 3);
    let against =
        |b: &Image| compare(Estimate::new(&a, Some(&va)), Estimate::new(b, None), Tails::Light).unwrap();
    let same = against(&truth);
    assert!(!same.differs && same.pixels.tested == 0 && same.blocks.tested > 150, "{same:?}");
    assert!(against(&scaled(&truth, 1.01)).differs);
}

#[test]
fn relmse_is_unbiased_with_the_variance_and_says_so_without() {
    let truth = Image { pixels: vec![[0.5; 3]; WIDTH * HEIGHT], ..truth() };
    let found = judge(&truth, &truth, Noise::Normal(0.4), Tails::Light, 9);
    // A value's variance is (0.4 * 0.5)² over the number of samples, 64 in A and 512 in B; the estimate of the mean
    // over 3840 pixels is good to 3 % (one standard deviation is 2 / root of 2 * 3840).
    let scale = 0.5 * 0.5 + 0.01;
    let (of_a, of_b) = (0.04 / 64.0 / scale, 0.04 / 512.0 / scale);
    let relmse = found.relmse.unwrap();
    assert!((relmse / of_a - 1.0).abs() < 0.08, "{relmse} {of_a}");
    assert!((found.relmse_biased / (of_a + of_b) - 1.0).abs() < 0.08);
    assert!(found.relmse_biased > relmse);
    // The median of a squared normal deviate is 0.455.
    assert!((found.relmse_median / of_a - 0.455).abs() < 0.12, "{}", found.relmse_median / of_a);
    let json = found.to_json();
    assert_eq!(json["relmse"].as_f64(), Some(relmse));
    assert_eq!(json["differs"].as_bool(), Some(false));
}

#[test]
fn damage_is_told() {
    let truth = truth();
    let mut broken = truth.clone();
    broken.pixels[1000][1] = f32::NAN;
    let found = compare(Estimate::new(&broken, None), Estimate::new(&truth, None), Tails::Heavy).unwrap();
    assert_eq!(found.reasons, ["1 pixels are infinite or not a number"]);
    assert!(found.mean_error == [0.0; 3] && found.relmse_biased == 0.0);
    let small = Image { width: 1, height: 1, pixels: vec![[0.0; 3]] };
    let error =
        compare(Estimate::new(&truth, Some(&small)), Estimate::new(&truth, None), Tails::Light).unwrap_err();
    assert_eq!(error.to_string(), "the variance of A is 1 x 1 pixels, picture A is 64 x 60");
}
