//! A million rays from inside of a closed mesh that the project didn't make, none of which may escape; and a million
//! copies of one triangle, which must neither hang a build nor fill the memory.
//!
//! The whole million takes minutes, so that a plain run does with a part. `STRAAL_MILLION=1` asks for all of it, and
//! `-- --nocapture` shows what each structure took.

use crate::common::*;
use crate::shared::shared;
use rayon::prelude::*;
use std::{sync::Arc, time::Instant};
use straal_accel::*;
use straal_math::{Bounds, DVec3, Ray, Vec3};

/// Says what was measured to whoever asked for the million.
#[allow(clippy::print_stdout)]
fn tell(line: &str) {
    println!("{line}");
}

/// Vertices and triangles.
type Mesh = (Arc<[Vec3]>, Arc<[[u32; 3]]>);

/// An OBJ file that has nothing but triangles.
fn read_obj(text: &str) -> Mesh {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || words.next().unwrap().parse().unwrap();
                positions.push(Vec3::new(next(), next(), next()));
            }
            Some("f") => {
                let corners: Vec<u32> =
                    words.map(|w| w.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                indices.push(<[u32; 3]>::try_from(corners).unwrap());
            }
            _ => {}
        }
    }
    (positions.into(), indices.into())
}

/// The cow Spot of the shared data, if it is there.
fn spot() -> Option<Mesh> {
    let path = shared()?.join("scenes/meshes/spot/spot_triangulated.obj");
    Some(read_obj(&std::fs::read_to_string(path).expect("the cow")))
}

/// Whether each edge has one triangle on either side, both turned the same way.
fn is_closed(indices: &[[u32; 3]]) -> bool {
    let mut edges: Vec<(u32, u32)> = indices.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    edges.sort_unstable();
    edges.windows(2).all(|e| e[0] != e[1]) && edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok())
}

/// How often a closed mesh goes around a point: the solid angles of its triangles, in full turns (van Oosterom and
/// Strackee 1983). It asks nothing of a ray.
fn winding(positions: &[Vec3], indices: &[[u32; 3]], p: Vec3) -> f64 {
    let angle = |t: &[u32; 3]| {
        let [a, b, c]: [DVec3; 3] = t.map(|i| positions[i as usize].as_dvec3() - p.as_dvec3());
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let height = a.dot(b.cross(c));
        let width = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * straal_math::ops::atan2_d(height, width)
    };
    indices.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// Rays from inside of a mesh: in all directions, at vertices, at edges, and at triangles.
fn from_inside(positions: &[Vec3], indices: &[[u32; 3]], n: usize) -> Vec<Ray> {
    let mut r = Random(41);
    let around = positions.iter().fold(Bounds::EMPTY, |b, &p| b.union(Bounds { min: p, max: p }));
    let (middle, half) = (around.center(), around.extent().max_element() * 0.5);
    let mut origins = Vec::new();
    while origins.len() < 256 {
        let p = middle + r.point() * half;
        let turns = winding(positions, indices, p).abs();
        assert!(
            (turns - turns.round()).abs() < 1e-6,
            "a closed mesh goes around a whole number of times: {turns}"
        );
        if turns > 0.5 {
            origins.push(p);
        }
    }
    (0..n)
        .map(|i| {
            let o = origins[i % origins.len()];
            let [a, b, c] = indices[r.below(indices.len())].map(|i| positions[i as usize]);
            let d = match r.below(4) {
                0 => r.direction(),
                1 => a - o,
                2 => (a + b) * 0.5 - o,
                _ => a * 0.5 + b * 0.25 + c * 0.25 - o,
            };
            Ray::new(o, d)
        })
        .collect()
}

/// Two threads of its own, so that a build that is timed doesn't do the other test's work while it waits.
fn in_own_pool(test: impl FnOnce() + Send) {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap().install(test);
}

fn hits(scene: &Scene, rays: &[Ray]) -> Vec<Hit> {
    let mut out = vec![Hit::MISS; rays.len()];
    rays.par_chunks(1024)
        .zip(out.par_chunks_mut(1024))
        .for_each(|(rays, hits)| scene.closest(&(), rays, hits));
    out
}

#[test]
fn a_million_rays_stay_inside() {
    let Some((positions, indices)) = spot() else { return };
    assert!(is_closed(&indices));
    in_own_pool(|| {
        let rays = from_inside(&positions, &indices, if is_whole() { 1_000_000 } else { 4_000 });
        let kind = GeometryKind::Triangles { positions, indices };
        let input = world(vec![Geometry { kind, mask: u32::MAX }]);
        let mut expected: Option<Vec<Hit>> = None;
        // Brute force, the first of all, is what the others are held against.
        for options in all_options() {
            // A twentieth for those that test nearly everything.
            let few = rays.len() / if tests_nearly_all(&options.structure) { 20 } else { 1 };
            let scene = Scene::build(input.clone(), &(), &options).unwrap();
            let start = Instant::now();
            let found = hits(&scene, &rays[..few]);
            let seconds = start.elapsed().as_secs_f64();
            let escaped = found.iter().filter(|h| !h.is_hit()).count();
            let mut blocked = vec![false; few];
            rays.par_chunks(1024)
                .zip(blocked.par_chunks_mut(1024))
                .for_each(|(rays, blocked)| scene.occluded(&(), rays, blocked));
            let free = blocked.iter().filter(|b| !**b).count();
            tell(&format!("{few} rays, {escaped} escaped, {seconds:.2} s, {options:?}"));
            assert_eq!((escaped, free), (0, 0), "{options:?}");
            let expected = expected.get_or_insert_with(|| found.clone());
            for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
                assert_eq!(bits(found), bits(expected), "{options:?}, ray {i}: {:?}", rays[i]);
            }
        }
    });
}

/// The most memory that the process had so far, in bytes; 0 where the system doesn't tell.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// What can't be parted: a builder that goes on trying takes for ever, and one that puts copies on both sides of each
/// cut doubles them at every level.
#[test]
fn a_million_copies_of_one_triangle() {
    let n = if is_whole() { 1_000_000 } else { 40_000 };
    let one = [Vec3::new(-1.0, -1.0, 0.25), Vec3::new(1.0, -0.5, 0.5), Vec3::new(0.0, 1.0, -0.25)];
    let positions: Arc<[Vec3]> = one.into();
    let kind = GeometryKind::Triangles { positions, indices: vec![[0, 1, 2]; n].into() };
    let input = world(vec![Geometry { kind, mask: u32::MAX }]);
    let mut r = Random(42);
    let middle = one[0] * 0.5 + one[1] * 0.25 + one[2] * 0.25;
    let ray = |i| {
        let o = r.point() * 2.0;
        Ray::new(o, if i < 4 { r.direction() } else { middle - o })
    };
    let rays: Vec<Ray> = (0..8).map(ray).collect();
    in_own_pool(|| {
        let mut expected: Option<Vec<Hit>> = None;
        for structure in all_structures() {
            let options = Options { structure, ..Options::default() };
            let start = Instant::now();
            let scene = Scene::build(input.clone(), &(), &options).unwrap();
            let built = start.elapsed().as_secs_f64();
            let found = hits(&scene, &rays);
            let seconds = start.elapsed().as_secs_f64() - built;
            let (bytes, peak) = (scene.memory_bytes(), peak_memory());
            tell(&format!(
                "{n} copies: built in {built:.2} s, {} bytes each, 8 rays in {seconds:.2} s, peak of all so far {} MB, {structure:?}",
                bytes / n,
                peak >> 20
            ));
            // A million takes seconds; what doubles at every level takes for ever.
            assert!(built < 60.0, "{structure:?} took {built} s to build");
            // A grid may have as many cells and entries as its parameters allow, however few primitives there are.
            assert!(bytes < (300 * n).max(300 << 20), "{structure:?} takes {bytes} bytes");
            assert!(peak < 2 << 30, "{structure:?} had {peak} bytes at a time");
            assert!(found[4..].iter().all(|h| h.is_hit()), "{structure:?}");
            let expected = expected.get_or_insert_with(|| found.clone());
            for (found, expected) in found.iter().zip(expected) {
                assert_eq!(bits(found), bits(expected), "{structure:?}");
            }
        }
    });
}
