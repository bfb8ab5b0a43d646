//! What a tree costs that is kept while its mesh bends, beside one that is built: `cargo bench -p straal-accel --bench refit`.
//!
//! Times are medians of rounds in which both take turns, on one thread; costs are by the surface area heuristic.
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // a program that prints, and whose rays reach no pixel

#[path = "../tests/all/common/mod.rs"]
mod common;

use std::time::Instant;

use common::{Random, world};
use straal_accel::{Geometry, GeometryKind, Hit, Input, Options, Scene};
use straal_math::{Ray, Vec3};

/// Squares along each side of the sheet that is bent.
const SIDE: u32 = 256;

/// How often everything is timed.
const ROUNDS: usize = 7;

/// A sheet with its corners where `place` has them.
fn sheet(place: impl Fn(f32, f32) -> Vec3) -> Input {
    let side = SIDE + 1;
    let at = |i: u32| place((i % side) as f32 / SIDE as f32, (i / side) as f32 / SIDE as f32);
    let faces = (0..SIDE * SIDE).flat_map(|i| {
        let a = i % SIDE + i / SIDE * side;
        [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]
    });
    let kind =
        GeometryKind::Triangles { positions: (0..side * side).map(at).collect(), indices: faces.collect() };
    world(vec![Geometry { kind, mask: u32::MAX }])
}

fn cloth(phase: f32) -> Input {
    sheet(|u, v| {
        let z = 0.2 * (12.0 * u + phase).sin() + 0.15 * (9.0 * v + 0.7 * phase).sin();
        Vec3::new(4.0 * u - 2.0, 4.0 * v - 2.0, z)
    })
}

/// A tube, turned the more the higher.
fn tube(turns: f32) -> Input {
    sheet(|u, v| {
        let angle = std::f32::consts::TAU * (u + turns * v);
        let wide = 1.0 + 0.3 * (5.0 * std::f32::consts::TAU * u).cos();
        Vec3::new(wide * angle.cos(), 4.0 * v - 2.0, wide * angle.sin())
    })
}

/// Rays from a sphere around to points within.
fn rays(n: usize) -> Vec<Ray> {
    let mut r = Random(3);
    let ray = |_| {
        let from = r.direction() * 6.0;
        Ray::new(from, (r.point() * 1.5 - from).normalize())
    };
    (0..n).map(ray).collect()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let options = Options::default();
    let rays = rays(200_000);
    let cost = |scene: &Scene| scene.stats().iter().flatten().map(|s| s.sah_cost).sum::<f64>();
    println!("{} triangles; {} rays", 2 * SIDE * SIDE, rays.len());
    println!("mesh   bent by  tree     made in ms: kept  built   cost kept/built   search kept/built");
    let mut hits = vec![Hit::MISS; rays.len()];
    for (name, mesh) in [("cloth", cloth as fn(f32) -> Input), ("tube", tube)] {
        for by in [0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6] {
            let (mut made, mut search) = ([vec![], vec![]], vec![]);
            let mut costs = [0.0; 2];
            let mut refitted = 0;
            for _ in 0..ROUNDS {
                let start = pool.install(|| Scene::build(mesh(0.0), &(), &options)).expect("a scene");
                let (kept, built) = (mesh(by), mesh(by));
                let time = Instant::now();
                let kept =
                    pool.install(|| Scene::build_after(Some(start), kept, &(), &options)).expect("a scene");
                made[0].push(time.elapsed().as_secs_f64() * 1e3);
                let time = Instant::now();
                let built = pool.install(|| Scene::build(built, &(), &options)).expect("a scene");
                made[1].push(time.elapsed().as_secs_f64() * 1e3);
                refitted = kept.refitted();
                costs = [cost(&kept), cost(&built)];
                let times = [&kept, &built].map(|scene| {
                    let time = Instant::now();
                    scene.closest(&(), &rays, &mut hits);
                    time.elapsed().as_secs_f64()
                });
                search.push(times[0] / times[1]);
            }
            let [kept, built] = made.map(median);
            let tree = if refitted > 0 { "kept" } else { "built" };
            let (costs, search) = (costs[0] / costs[1], median(search));
            println!("{name:6} {by:7} {tree:>6} {kept:17.1} {built:6.1} {costs:17.3} {search:19.3}");
        }
    }
}
