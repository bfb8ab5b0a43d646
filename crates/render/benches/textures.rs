//! What a look-up of a texture costs, in the time of its thread: a picture of 4096 x 4096 in 8 bits, on one thread, here and there and along rows, with each filter.
//!
//! `cargo bench -p straal-render --bench textures`; the same in OpenImageIO: `python crates/render/benches/textures.py` (`pip install openimageio`).
#![allow(clippy::print_stdout)] // the figures are what it is for

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use straal_render::texture::{Pyramid, Sampling, Spot};
use straal_scene::Bitmap;
use straal_scene::bitmap::{Number, Response, TexelFormat, Texels};
use straal_scene::desc::{TextureFilter, TextureSpace, Wrap};

const SIDE: usize = 4096;

/// Look-ups of a kind.
const COUNT: usize = 1 << 21;

/// A number that looks random.
fn noise(i: u32) -> u32 {
    let mut h = i.wrapping_mul(0x9e37_79b9);
    h = (h ^ h >> 15).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ h >> 12).wrapping_mul(0x297a_2d39);
    h ^ h >> 15
}

fn unit(i: u32) -> f32 {
    (noise(i) >> 8) as f32 / (1 << 24) as f32
}

/// The time that this thread has been computing, which other programs don't lengthen; where the system doesn't tell it, that of a clock.
fn computed(since: Instant) -> Duration {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse().ok());
    nanoseconds.map_or_else(|| since.elapsed(), Duration::from_nanos)
}

fn main() {
    let began = Instant::now();
    let format = TexelFormat { number: Number::Byte, channels: 4 };
    let Some(mut texels) = Texels::new(SIDE, SIDE, format) else { return };
    for i in 0..SIDE * SIDE {
        texels.put(i % SIDE, i / SIDE, &noise(i as u32).to_ne_bytes());
    }
    let bitmap = Arc::new(Bitmap { texels, response: Response::Linear, space: None, has_alpha: false });
    let start = Instant::now();
    let pyramid = Pyramid::of(bitmap, &TextureSpace::Srgb);
    println!("{:.2} s for the smaller copies of {SIDE} x {SIDE} texels", start.elapsed().as_secs_f64());
    println!("{:10} {:12} {:>8} {:>14}", "filter", "places", "texels", "million a second");
    let wrap = [Wrap::Repeat, Wrap::Repeat];
    let filters = [
        TextureFilter::Nearest,
        TextureFilter::Bilinear,
        TextureFilter::Trilinear,
        TextureFilter::Ewa,
        TextureFilter::Stochastic,
    ];
    for filter in filters {
        let sampling = Sampling::of(&filter, &wrap, 16.0);
        // What a pixel sees: one texel, and three by three, and that twice as long.
        for (seen, long) in [(1.0, 1.0), (3.0, 1.0), (3.0, 2.0)] {
            let step = seen / SIDE as f32;
            let (dx, dy) = ([step * long, 0.0], [0.0, step]);
            for (name, coherent) in [("random", false), ("coherent", true)] {
                let mut sum = [0.0; 4];
                let start = computed(began);
                for i in 0..COUNT {
                    let st = if coherent {
                        // Along rows of a thousand.
                        [(i % 1000) as f32 * step, (i / 1000) as f32 * step]
                    } else {
                        [unit(2 * i as u32), unit(2 * i as u32 + 1)]
                    };
                    let lot = Some([st[1], (i % 97) as f32 / 97.0]);
                    let found = sampling.look_up(&pyramid, &Spot { st, dx, dy, lot });
                    (0..4).for_each(|c| sum[c] += found[c]);
                }
                let seconds = (computed(began) - start).as_secs_f64();
                black_box(sum);
                println!(
                    "{:10} {name:12} {seen:>4} x {long} {:>14.1}",
                    format!("{filter:?}"),
                    COUNT as f64 / seconds / 1e6
                );
            }
        }
    }
}
