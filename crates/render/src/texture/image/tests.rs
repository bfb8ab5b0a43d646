//! Pictures against what a formula says of them, and against their supersampled truth.

use super::*;
use straal_color::Space;
use straal_math::lowdisc::{Pattern as Points, Purpose, SampleName};
use straal_scene::Bitmap;
use straal_scene::bitmap::{Number, Response, TexelFormat, Texels};
use straal_scene::desc::{TextureFilter, TextureSpace, Wrap};

const FILTERS: [TextureFilter; 5] = [
    TextureFilter::Nearest,
    TextureFilter::Bilinear,
    TextureFilter::Trilinear,
    TextureFilter::Ewa,
    TextureFilter::Stochastic,
];

/// A picture of codes or of light; rows go downwards.
fn bitmap(
    size: [usize; 2],
    number: Number,
    channels: usize,
    code: impl Fn(usize, usize, usize) -> f32,
) -> Arc<Bitmap> {
    let mut texels = Texels::new(size[0], size[1], TexelFormat { number, channels }).unwrap();
    for i in 0..size[0] * size[1] {
        let (x, y) = (i % size[0], i / size[0]);
        texels.put_numbers(x, y, std::array::from_fn(|c| code(x, y, c)));
    }
    Arc::new(Bitmap { texels, response: Response::Linear, space: None, has_alpha: false })
}

fn texture(bitmap: &Arc<Bitmap>, filter: &TextureFilter, wrap: Wrap, space: &TextureSpace) -> ImageTexture {
    let sampling = Sampling::of(filter, &[wrap.clone(), wrap], 16.0);
    let meaning = Meaning::of(space, false);
    let pyramid = Arc::new(Pyramid::new(bitmap.clone(), &meaning, sampling.needs_smaller()));
    ImageTexture { pyramid, sampling, channel: Channel::Luminance, mapping: Mapping::Coordinates }
}

/// Smooth and not far from grey, so that a box and other shapes of the same width have nearly the same mean.
pub(super) fn examples() -> Vec<ImageTexture> {
    let gentle = bitmap([16, 8], Number::Byte, 4, |x, y, c| (120 + (x + y / 2 + c) % 2) as f32);
    let light = bitmap([5, 7], Number::Half, 1, |x, y, _| 0.5 + ((x + y) % 2) as f32 / 64.0);
    let all = FILTERS.iter().flat_map(|filter| {
        let srgb = texture(&gentle, filter, Wrap::Repeat, &TextureSpace::Srgb);
        [srgb, texture(&light, filter, Wrap::Mirror, &TextureSpace::Auto)]
    });
    all.collect()
}

fn numbers(i: u32) -> [f32; 4] {
    Points::Sobol.d4(&SampleName::new(7, [0, 0], i), Purpose::Custom)
}

fn point(st: [f32; 2]) -> Spot {
    Spot { st, dx: [0.0; 2], dy: [0.0; 2], lot: None }
}

#[test]
fn texels_lie_where_they_should() {
    let four = bitmap([2, 2], Number::Single, 1, |x, y, _| (1 + x + 2 * y) as f32);
    for filter in &FILTERS {
        let t = texture(&four, filter, Wrap::Repeat, &TextureSpace::Auto);
        let at = |s, v| t.sampling.look_up(&t.pyramid, &point([s, v]))[0];
        // The first row of the file is the upper one.
        let centres = [at(0.25, 0.75), at(0.75, 0.75), at(0.25, 0.25), at(0.75, 0.25)];
        assert_eq!(centres, [1.0, 2.0, 3.0, 4.0], "{filter:?}");
        if *filter != TextureFilter::Nearest {
            assert_eq!([at(0.5, 0.5), at(0.375, 0.75), at(0.75, 0.5)], [2.5, 1.25, 3.0], "{filter:?}");
        }
    }
}

#[test]
fn what_is_beyond_the_edges_is_as_it_was_said() {
    let row = bitmap([4, 1], Number::Single, 1, |x, _, _| (1 + x) as f32);
    let want = [
        (Wrap::Repeat, [4.0, 3.0, 1.0, 2.0]),
        (Wrap::Mirror, [1.0, 2.0, 4.0, 3.0]),
        (Wrap::Clamp, [1.0, 1.0, 4.0, 4.0]),
        (Wrap::Black, [0.0; 4]),
    ];
    for (wrap, want) in want {
        for filter in &FILTERS {
            let t = texture(&row, filter, wrap.clone(), &TextureSpace::Auto);
            let at = |s| t.sampling.look_up(&t.pyramid, &point([s, 0.5]))[0];
            assert_eq!([at(-0.125), at(-0.375), at(1.125), at(1.375)], want, "{wrap:?} {filter:?}");
            if wrap == Wrap::Mirror {
                assert_eq!([at(2.125), at(-1.125)], [1.0, 4.0]);
            }
        }
    }
}

#[test]
fn codes_are_light_before_they_are_mixed() {
    let two = bitmap([2, 1], Number::Byte, 1, |x, _, _| 255.0 * x as f32);
    for filter in [TextureFilter::Bilinear, TextureFilter::Ewa] {
        let t = texture(&two, &filter, Wrap::Clamp, &TextureSpace::Srgb);
        let got = t.sampling.look_up(&t.pyramid, &point([0.5, 0.5]));
        assert_eq!(got, [0.5, 0.5, 0.5, 1.0]);
    }
    let grey = bitmap([1, 1], Number::Byte, 1, |_, _, _| 128.0);
    let of = |space| {
        let t = texture(&grey, &TextureFilter::Nearest, Wrap::Clamp, &space);
        t.sampling.look_up(&t.pyramid, &point([0.5, 0.5]))[0]
    };
    assert!((of(TextureSpace::Srgb) - 0.215_861).abs() < 1e-5);
    assert_eq!(of(TextureSpace::Raw), 128.0 / 255.0);
    // Greys are grey in all primaries.
    assert!((of(TextureSpace::AcesCg) - 128.0 / 255.0).abs() < 1e-6);
    let green = bitmap([1, 1], Number::Byte, 4, |_, _, c| if c == 1 { 255.0 } else { 0.0 });
    let t = texture(&green, &TextureFilter::Nearest, Wrap::Clamp, &TextureSpace::DisplayP3);
    let got = t.sampling.look_up(&t.pyramid, &point([0.5, 0.5]));
    let want = Space::DisplayP3.to(Space::Srgb).apply([0.0, 1.0, 0.0]);
    (0..3).for_each(|c| assert!((f64::from(got[c]) - want[c]).abs() < 1e-5));
}

/// A fine picture that is seen by few pixels shows what its supersampled truth does, whatever it is made of: upright, askew, and eight times
/// as long as wide.
#[test]
fn pictures_from_afar_are_their_supersampled_truth() {
    const SIDE: usize = 512;
    // Noise over slow waves: a filter that skips texels is off by the noise, one that is too wide by the waves.
    let noisy = bitmap([SIDE, SIDE], Number::Byte, 4, |x, y, c| {
        let mut h =
            (x as u32).wrapping_mul(0x9e37_79b9) ^ (y as u32).wrapping_mul(0x85eb_ca6b) ^ (c as u32) << 13;
        h = (h ^ h >> 15).wrapping_mul(0x2c1b_3c6d);
        let wave = |v: usize, length: f32| 120.0 * ((v as f32 / length).fract() - 0.5).abs();
        let wave = wave(x, 256.0) + wave(y, 512.0);
        (wave + ((h >> 8) as f32 / (1 << 24) as f32) * 130.0).floor()
    });
    for (dx, dy) in [([1.0, 0.0], [0.0, 1.0]), ([0.8, 0.6], [-0.6, 0.8]), ([0.25, 0.0], [0.1, 2.0])] {
        // A pixel sees 16 texels.
        let scale = 16.0 / SIDE as f32;
        let (dx, dy) = (dx.map(|v: f32| v * scale), dy.map(|v: f32| v * scale));
        for filter in [TextureFilter::Trilinear, TextureFilter::Ewa] {
            let t = texture(&noisy, &filter, Wrap::Repeat, &TextureSpace::Srgb);
            let bilinear = texture(&noisy, &TextureFilter::Bilinear, Wrap::Repeat, &TextureSpace::Srgb);
            let (mut off, mut count) = ([0.0_f64; 2], 0.0);
            for i in 0..64 {
                let [u, v, ..] = numbers(i);
                // As pixels see it: the mean of samples all over the pixel, each with its footprint.
                let mean = |t: &ImageTexture, n: u32| {
                    let mut sum = 0.0_f64;
                    for k in 0..n {
                        let [x, y, ..] = numbers(100 + k);
                        let st = [0, 1].map(|j| [u, v][j] + (x - 0.5) * dx[j] + (y - 0.5) * dy[j]);
                        sum += f64::from(t.sampling.look_up(&t.pyramid, &Spot { st, dx, dy, lot: None })[1]);
                    }
                    sum / f64::from(n)
                };
                let (got, truth) = (mean(&t, 16), mean(&bilinear, 256));
                off[0] += (got - truth) * (got - truth);
                off[1] += got - truth;
                count += 1.0;
            }
            let [square, bias] = off.map(|v| v / count);
            // Noise of texels has a standard deviation of about 0.13, which leaves 0.008 in the mean of 256; of the four
            // times as many of a long footprint less, but there `trilinear` takes the length for both.
            let off = square.sqrt();
            assert!(off < 0.014 && bias.abs() < 0.004, "{filter:?} {dx:?}: {off} {bias}");
        }
    }
}

/// Over many draws, one texel at a time is the mean that EWA takes: near, far, askew, and longer than wide.
#[test]
fn a_drawn_texel_is_right_in_the_mean() {
    const SIDE: usize = 256;
    // Waves as long as some footprints tell a filter that is too wide or too narrow; in light, so that nothing is rounded.
    let waves = bitmap([SIDE, SIDE], Number::Single, 1, |x, y, _| {
        let wave = |v: usize, length: usize| if v % length < length / 2 { 1.0 } else { 0.0 };
        0.5 * (wave(x, 64) + wave(y, 32))
    });
    let of = |filter| texture(&waves, &filter, Wrap::Repeat, &TextureSpace::Auto);
    let (mean, drawn) = (of(TextureFilter::Ewa), of(TextureFilter::Stochastic));
    for (texels, dx, dy) in [
        (0.5, [1.0, 0.0], [0.0, 1.0]),
        (3.0, [0.8, 0.6], [-0.6, 0.8]),
        (12.0, [1.0, 0.0], [0.0, 1.0]),
        (6.0, [4.0, 0.5], [0.0, 1.0]),
        (1e4, [1.0, 0.0], [0.0, 1.0]),
    ] {
        let scale = texels / SIDE as f32;
        let (dx, dy) = (dx.map(|v: f32| v * scale), dy.map(|v: f32| v * scale));
        let (mut bias, mut square) = (0.0_f64, 0.0_f64);
        for i in 0..64 {
            let [s, t, ..] = numbers(i);
            let look_up = |of: &ImageTexture, lot| {
                f64::from(of.sampling.look_up(&of.pyramid, &Spot { st: [s, t], dx, dy, lot })[0])
            };
            let want = look_up(&mean, None);
            assert_eq!(look_up(&drawn, None), want, "without a lot it is the mean");
            let draws = 256;
            let sum: f64 = (0..draws)
                .map(|k| {
                    let [u, v, ..] = numbers(1000 + k);
                    look_up(&drawn, Some([u, v]))
                })
                .sum();
            let off = sum / f64::from(draws) - want;
            bias += off / 64.0;
            square += off * off / 64.0;
        }
        // Numbers that fill the square leave less than 256 draws by chance would: 0.5 / 16.
        assert!(bias.abs() < 0.004 && square.sqrt() < 0.02, "{texels}: {bias} {}", square.sqrt());
    }
}

#[test]
fn nothing_breaks_a_look_up() {
    let picture = bitmap([7, 300], Number::Byte, 4, |x, y, _| ((x * 31 + y * 17) % 256) as f32);
    let odd = [
        0.0,
        1e-30,
        0.37,
        -12.5,
        1e6,
        3e9,
        -1e10,
        1e30,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    for filter in &FILTERS {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Black] {
            let t = texture(&picture, filter, wrap.clone(), &TextureSpace::Srgb);
            for a in odd {
                for b in odd {
                    for c in odd {
                        for spot in [
                            Spot { st: [a, b], dx: [c, 0.0], dy: [0.0, c], lot: None },
                            Spot { st: [0.1, a], dx: [b, c], dy: [c, 0.01], lot: None },
                            Spot { st: [a, 0.2], dx: [c, b], dy: [0.01, c], lot: Some([0.999_999_9, 0.37]) },
                        ] {
                            let got = t.sampling.look_up(&t.pyramid, &spot);
                            assert!(
                                got.iter().all(|v| (0.0..=1.0001).contains(v)),
                                "{filter:?} {spot:?} {got:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}
