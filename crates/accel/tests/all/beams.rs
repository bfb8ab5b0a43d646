//! Long thin triangles, which the best build cuts: the tree is better, and its hits are those of brute force.

use crate::common::*;
use straal_accel::*;
use straal_math::{Ray, Vec3};

/// Slanting beams all through a cube, with so many small triangles for each between them.
fn beams(r: &mut Random, count: usize, small: usize) -> Vec<[Vec3; 3]> {
    let mut out = Vec::new();
    for _ in 0..count {
        let (p, along) = (r.point(), r.direction() * 1.5);
        let side = along.cross(r.direction()).normalize() * 0.004;
        out.extend([[p, p + along, p + along + side], [p, p + along + side, p + side]]);
        for _ in 0..small {
            let q = r.point();
            out.push([q, q + r.point() * 0.02, q + r.point() * 0.02]);
        }
    }
    out
}

fn structure(build: Build, compact: bool) -> Structure {
    Structure::Bvh(BvhParams { build, compact })
}

fn options(build: Build) -> Options {
    Options { structure: structure(build, false), ..Options::default() }
}

/// Rays at points of the triangles, from near and from `far` away; the t of such a point is about 1.
fn aimed(r: &mut Random, triangles: &[[Vec3; 3]], far: f32, n: usize) -> Vec<Ray> {
    (0..n)
        .map(|_| {
            let [a, b, c] = triangles[r.below(triangles.len())];
            let (u, v) = (r.signed().abs(), r.signed().abs());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let target = a + (b - a) * u + (c - a) * v;
            let o = target + r.direction() * (far * (0.1 + r.signed().abs()));
            Ray::new(o, target - o)
        })
        .collect()
}

#[test]
fn cut_triangles_are_hit_as_whole_ones() {
    for (seed, at, far) in [(1, 0.0, 1.0), (2, 0.0, 300.0), (3, 50.0, 2.0), (4, 3.0, 1e5)] {
        let mut r = Random(seed);
        let at = Vec3::new(at, -at, at * 0.5);
        let triangles: Vec<_> = beams(&mut r, 300, 1).iter().map(|t| t.map(|p| p + at)).collect();
        let input = world(vec![mesh(&triangles)]);
        let mut rays = aimed(&mut r, &triangles, far, part(1500));
        let brute = Scene::build(input.clone(), &(), &reference()).unwrap();
        let mut hits = vec![Hit::MISS; rays.len()];
        brute.closest(&(), &rays, &mut hits);
        // Intervals that end, or begin, with the hit or just miss it.
        for (i, hit) in hits.iter().enumerate().filter(|(_, h)| h.is_hit()) {
            let ray = rays[i];
            rays.push(match i % 4 {
                0 => Ray { t_max: hit.t, ..ray },
                1 => Ray { t_max: hit.t.next_down(), ..ray },
                2 => Ray { t_min: hit.t, ..ray },
                _ => Ray { t_min: hit.t.next_up(), ..ray },
            });
        }
        let mut expected = vec![Hit::MISS; rays.len()];
        brute.closest(&(), &rays, &mut expected);
        for isa in Isa::ALL.into_iter().filter(|i| i.is_available()) {
            for (flight, compact) in [(Flight::One, false), (Flight::Many, false), (Flight::Many, true)] {
                let options = Options { structure: structure(Build::Best, compact), isa, flight };
                let scene = Scene::build(input.clone(), &(), &options).unwrap();
                scene.validate().unwrap();
                let mut blocked = vec![false; rays.len()];
                scene.closest(&(), &rays, hits_of(&rays, &mut hits));
                scene.occluded(&(), &rays, &mut blocked);
                for (i, ray) in rays.iter().enumerate() {
                    assert_eq!(bits(&hits[i]), bits(&expected[i]), "{options:?}, seed {seed}: {ray:?}");
                    assert_eq!(blocked[i], expected[i].is_hit(), "{options:?}, seed {seed}: {ray:?}");
                }
            }
        }
    }
}

/// Room for a hit of each ray.
fn hits_of<'a>(rays: &[Ray], hits: &'a mut Vec<Hit>) -> &'a mut Vec<Hit> {
    hits.resize(rays.len(), Hit::MISS);
    hits
}

#[test]
fn cutting_pays_within_bounds() {
    let mut r = Random(9);
    let triangles = beams(&mut r, 300, 40);
    let input = world(vec![mesh(&triangles)]);
    let of = |build| Scene::build(input.clone(), &(), &options(build)).unwrap();
    let (whole, some, most) = (of(Build::Fast), of(Build::Default), of(Build::Best));
    let [a, b, c] = [&whole, &some, &most].map(|s| s.stats()[0].unwrap());
    assert_eq!(a.references, triangles.len());
    assert!(b.references > triangles.len() && b.references <= triangles.len() * 17 / 16, "{b:?}");
    assert!(c.references > b.references && c.references <= triangles.len() * 5 / 4, "{c:?}");
    let costs = [a, b, c].map(|s| s.sah_cost);
    assert!(costs[1] < 0.95 * costs[0] && costs[2] < 0.8 * costs[0], "{costs:?}");
    let rays = aimed(&mut r, &triangles, 2.0, 2000);
    let blocks = |s: &Scene| rays.iter().map(|ray| s.closest_counted(&(), ray).1.blocks).sum::<u32>();
    let blocks = [&whole, &some, &most].map(|s| f64::from(blocks(s)));
    assert!(blocks[1] < 0.95 * blocks[0] && blocks[2] < 0.8 * blocks[0], "{blocks:?}");
}

#[test]
fn even_triangles_are_not_cut_by_default() {
    let (positions, indices) = icosphere(4);
    let triangles: Vec<_> = indices.iter().map(|t| t.map(|i| positions[i as usize])).collect();
    let scene = Scene::build(world(vec![mesh(&triangles)]), &(), &options(Build::Default)).unwrap();
    assert_eq!(scene.stats()[0].unwrap().references, triangles.len());
}

#[test]
fn threads_do_not_matter() {
    let mut r = Random(10);
    // More than one piece of what threads share.
    let triangles = beams(&mut r, 23_000, 1);
    let input = world(vec![mesh(&triangles)]);
    let rays = aimed(&mut r, &triangles, 1.0, 300);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let scene = pool.install(|| Scene::build(input.clone(), &(), &options(Build::Best))).unwrap();
        let found: Vec<_> = rays.iter().map(|ray| scene.closest_counted(&(), ray)).collect();
        (scene.stats()[0], scene.memory_bytes(), found.iter().map(|(h, c)| (bits(h), *c)).collect::<Vec<_>>())
    };
    assert_eq!(run(1), run(5));
}
