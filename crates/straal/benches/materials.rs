//! What a material costs at a vertex, 16 side by side on one thread: its value for a pair of directions, and a direction drawn. Each is measured
//! in turn with a diffuse one, and given as so many times that; the goals are 1.5 for GGX, 2 for OpenPBR with all lobes off and 6 with all on.
//!
//! `cargo bench -p straal --bench materials`
#![allow(clippy::print_stdout, clippy::expect_used)] // the figures are what it is for, and its scenes are right

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use straal::{Job, LoadOptions, Overrides};
use straal_accel::Isa;
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::simd::{BLOCK, Simd};
use straal_math::{Vec3, warp};
use straal_render::lanes::Rgb;
use straal_render::testing::Shaded;
use straal_render::texture::ShadingPoint;

/// A turn takes at least so many seconds, many times the ticks in which systems tell how long a thread has been computing; of so many turns the fastest count.
const TURN: f64 = 0.04;
const TURNS: usize = 6;

const MATERIALS: [(&str, &str); 13] = [
    ("diffuse", "{ diffuse: {} }"),
    ("GGX metal", "{ conductor: { metal: gold, roughness: 0.3 } }"),
    ("OpenPBR, all lobes off", "{ open_pbr: { specular_weight: 0 } }"),
    ("OpenPBR, as it is when nothing is said", "{ open_pbr: {} }"),
    (
        "OpenPBR, all lobes on",
        "{ open_pbr: { base_metalness: 0.3, base_diffuse_roughness: 0.5, transmission_weight: 0.3, transmission_dispersion_scale: 0, \
         subsurface_weight: 0.3, specular_roughness_anisotropy: 0.4, coat_weight: 0.5, coat_roughness: 0.2, coat_color: [0.9, 0.8, 0.7], \
         fuzz_weight: 0.4, thin_film_weight: 0.5 } }",
    ),
    ("diffuse, EON", "{ diffuse: { roughness: 0.5 } }"),
    ("phong", "{ phong: {} }"),
    ("rough glass", "{ dielectric: { roughness: 0.3 } }"),
    ("plastic", "{ plastic: { roughness: 0.2 } }"),
    ("sheen", "{ sheen: {} }"),
    ("principled", "{ principled: { metallic: 0.3, sheen: 0.4, clearcoat: 0.5, spec_trans: 0.3 } }"),
    ("brushed metal", "{ conductor: { metal: gold, roughness: 0.3, roughness_v: 0.1 } }"),
    ("coated_diffuse", "{ coated_diffuse: { coat_roughness: 0.2 } }"),
];

/// The time that this thread has been computing, which other programs don't lengthen; where the system doesn't tell it, that of a clock.
fn computed(since: Instant) -> Duration {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse().ok());
    nanoseconds.map_or_else(|| since.elapsed(), Duration::from_nanos)
}

/// Seconds that so many steps take.
fn seconds(began: Instant, steps: usize, mut step: impl FnMut()) -> f64 {
    let start = computed(began);
    for _ in 0..steps {
        step();
    }
    (computed(began) - start).as_secs_f64()
}

fn main() {
    let began = Instant::now();
    let mut scene =
        String::from("camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }\nmaterials:\n");
    for (i, (_, material)) in MATERIALS.into_iter().enumerate() {
        scene += &format!("  m{i:02}: {material}\n");
    }
    scene += "world:\n  - sphere: { material: m00 }\n";
    let loaded = straal::load_str("bench.yaml", &scene, Path::new(""), &LoadOptions::default());
    let loaded = loaded.unwrap_or_else(|d| panic!("{scene}\n{d}"));
    let world = Job::new(loaded, Overrides::default()).expect("a world").world;
    let vertex = |i: usize| {
        let name = SampleName::new(7, [0, 0], i as u32);
        let [a, b, c, d] = Pattern::Sobol.d4(&name, Purpose::Custom);
        let [u, v] = Pattern::Sobol.d2(&name.child(0), Purpose::Custom);
        let up = |w: Vec3| Vec3::new(w.x, w.y, w.z.abs() * 0.95 + 0.05).normalize();
        ([up(warp::uniform_sphere([a, b])), up(warp::uniform_sphere([c, d]))], [0.5 * (a + u), u, v])
    };
    // The first is that of what has none.
    let of = |i: usize| {
        let bsdf = world.materials.bsdf(1 + i as u32, &ShadingPoint::NOWHERE, &world.reading(Rgb::default()));
        Shaded::new(bsdf, vertex)
    };
    let widest = Isa::ALL.into_iter().rev().find_map(Simd::new).unwrap_or(Simd::PLAIN);
    println!("{widest:?}, {BLOCK} vertices");
    println!("{:40} {:>14} {:>10}", "material", "ns a vertex", "diffuse");
    let mut plain = of(0);
    for (i, (name, _)) in MATERIALS.into_iter().enumerate() {
        let mut block = of(i);
        // Seconds a step, and how many steps make a turn.
        let mut fastest = [(f64::INFINITY, 1 << 10); 2];
        for _ in 0..TURNS {
            for (one, (best, steps)) in [&mut plain, &mut block].into_iter().zip(&mut fastest) {
                let mut turn = |steps| {
                    seconds(began, steps, || {
                        black_box(one.step(widest));
                    })
                };
                let mut spent = turn(*steps);
                while spent < TURN {
                    *steps *= 2;
                    spent = turn(*steps);
                }
                let spent = spent / *steps as f64;
                *best = if spent < *best { spent } else { *best };
            }
        }
        let [(diffuse, _), (own, _)] = fastest;
        println!("{name:40} {:>14.2} {:>10.2}", own * 1e9 / BLOCK as f64, own / diffuse);
    }
}
