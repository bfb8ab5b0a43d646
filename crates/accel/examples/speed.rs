//! Rays per CPU second: `cargo run --release -p straal-accel --example speed -- [MESH.ply]`.
//!
//! Without a mesh (ASCII PLY, triangles), a sphere of 1.3 million triangles with bumps is made.
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // a program that prints, and whose rays reach no pixel

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Random, icosphere, world};
use straal_accel::{Flight, Geometry, GeometryKind, Hit, Isa, Options, Scene, Structure};
use straal_math::{Frame, Ray, Vec3};

fn main() {
    let (positions, indices) = match std::env::args().nth(1) {
        Some(path) => read_ply(&std::fs::read_to_string(&path).expect("a readable file")),
        None => {
            let (p, i) = icosphere(8);
            let bump =
                |p: Vec3| 1.0 + 0.1 * (p.x * 9.0).sin() * (p.y * 11.0).sin() + 0.01 * (p.z * 90.0).sin();
            (p.iter().map(|&p| p * bump(p)).collect::<Vec<_>>(), i.to_vec())
        }
    };
    let triangles = indices.len();
    let kind =
        GeometryKind::Triangles { positions: positions.clone().into(), indices: indices.clone().into() };
    let input = world(vec![Geometry { kind, mask: u32::MAX }]);
    let mut sets: Vec<(&str, Vec<Ray>)> = Vec::new();
    let isas = Isa::ALL.into_iter().filter(|isa| isa.is_available());
    for isa in isas {
        if std::env::var("ISA").is_ok_and(|only| only != isa.name()) {
            continue;
        }
        let start = cpu_seconds();
        let options = Options { structure: Structure::default(), isa, flight: Flight::Many };
        let scene = Scene::build(input.clone(), &(), &options).expect("a sound mesh");
        let built = cpu_seconds() - start;
        if sets.is_empty() {
            sets = ray_sets(&scene, &positions, &indices);
        }
        println!(
            "{isa}: {triangles} triangles, built in {built:.3} s, {:.1} bytes a triangle",
            scene.memory_bytes() as f64 / triangles as f64
        );
        for (name, rays) in &sets {
            let mut hits = vec![Hit::MISS; rays.len()];
            let mut blocked = vec![false; rays.len()];
            let mut run = |batch: usize| {
                let mut best = f64::INFINITY;
                for _ in 0..3 {
                    let start = cpu_seconds();
                    if *name == "shadow" {
                        for (r, b) in rays.chunks(batch).zip(blocked.chunks_mut(batch)) {
                            scene.occluded(&(), r, b);
                        }
                    } else {
                        for (r, h) in rays.chunks(batch).zip(hits.chunks_mut(batch)) {
                            scene.closest(&(), r, h);
                        }
                    }
                    best = best.min(cpu_seconds() - start);
                }
                rays.len() as f64 / best * 1e-6
            };
            let (one, many) = (run(1), run(1024));
            let costs = rays.iter().step_by(16).map(|r| match *name {
                "shadow" => scene.occluded_counted(&(), r).1,
                _ => scene.closest_counted(&(), r).1,
            });
            let (mut nodes, mut blocks, mut n) = (0, 0, 0);
            for c in costs {
                (nodes, blocks, n) = (nodes + c.nodes, blocks + c.blocks, n + 1);
            }
            let each = |x: u32| f64::from(x) / f64::from(n);
            println!(
                "  {name:10} {one:6.2} one by one, {many:6.2} in batches, Mrays/s; {:.1} nodes and {:.1} blocks a ray",
                each(nodes),
                each(blocks)
            );
        }
    }
}

/// CPU time of all threads.
fn cpu_seconds() -> f64 {
    let mut sum = 0.0;
    for task in std::fs::read_dir("/proc/self/task").expect("Linux").flatten() {
        let text = std::fs::read_to_string(task.path().join("schedstat")).unwrap_or_default();
        sum += text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9;
    }
    sum
}

/// Primary rays in 8x8 tiles, cosine-distributed bounces in that order and shuffled, shadow rays to a square light.
fn ray_sets(scene: &Scene, positions: &[Vec3], indices: &[[u32; 3]]) -> Vec<(&'static str, Vec<Ray>)> {
    let b = scene.bounds();
    let (center, size) = (b.center(), b.extent().length());
    let eye = center + Vec3::new(0.3, 0.3, 1.0).normalize() * size * 0.9;
    let view = Frame::from_normal((center - eye).normalize());
    let n = 512;
    let mut primary = Vec::new();
    for tile in 0..(n / 8) * (n / 8) {
        for pixel in 0..64 {
            let x = (tile % (n / 8)) * 8 + pixel % 8;
            let y = (tile / (n / 8)) * 8 + pixel / 8;
            let c = |v: usize| (v as f32 + 0.5) / n as f32 - 0.5;
            primary.push(Ray::new(eye, view.to_world(Vec3::new(c(x), c(y), 1.2))));
        }
    }
    let mut hits = vec![Hit::MISS; primary.len()];
    scene.closest(&(), &primary, &mut hits);
    let mut r = Random(1);
    let light = center + Vec3::new(0.2, 1.0, 0.5) * size;
    let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
    for (ray, hit) in primary.iter().zip(&hits).filter(|(_, h)| h.is_hit()) {
        let [p0, p1, p2] = indices[hit.primitive as usize].map(|i| positions[i as usize]);
        let normal = (p1 - p0).cross(p2 - p0).normalize();
        let normal = if normal.dot(ray.d) > 0.0 { -normal } else { normal };
        let o = ray.at(hit.t) + normal * (size * 1e-5);
        bounce.push(Ray::new(o, (normal + r.direction()).normalize()));
        let to = light + Vec3::new(r.signed(), 0.0, r.signed()) * (size * 0.2);
        shadow.push(Ray { t_max: 1.0, ..Ray::new(o, to - o) });
    }
    let mut shuffled = bounce.clone();
    for i in (1..shuffled.len()).rev() {
        shuffled.swap(i, r.below(i + 1));
    }
    vec![("primary", primary), ("bounce", bounce), ("shuffled", shuffled), ("shadow", shadow)]
}

/// The least that reads the Stanford meshes.
fn read_ply(text: &str) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let count = |what: &str| {
        let line = text.lines().find_map(|l| l.strip_prefix(what)).expect("a count");
        line.trim().parse::<usize>().expect("a number")
    };
    let (vertices, faces) = (count("element vertex "), count("element face "));
    let mut lines = text.lines().skip_while(|l| *l != "end_header").skip(1);
    let mut rows = |n: usize| lines.by_ref().take(n).map(|l| l.split_whitespace()).collect::<Vec<_>>();
    let positions = rows(vertices)
        .into_iter()
        .map(|mut w| {
            let mut c = || w.next().and_then(|s| s.parse().ok()).expect("a coordinate");
            Vec3::new(c(), c(), c())
        })
        .collect();
    let indices = rows(faces)
        .into_iter()
        .map(|w| {
            let mut w = w.skip(1);
            std::array::from_fn(|_| w.next().and_then(|s| s.parse().ok()).expect("an index"))
        })
        .collect();
    (positions, indices)
}
