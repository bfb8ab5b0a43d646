//! The partitions of space (kd-tree, octree, BSP tree) give the hits of brute force to the last bit, with whatever
//! parameters, and stay small whatever they are given.

use crate::common::*;
use straal_accel::*;
use straal_math::{Ray, Vec3};

fn options(structure: Structure) -> Options {
    Options { structure, isa: Isa::Scalar, flight: Flight::One }
}

/// All kinds, with several settings of their parameters.
fn trees() -> Vec<Structure> {
    let mut out = vec![
        Structure::Kd(KdParams::DEFAULT),
        Structure::Octree(OctreeParams::DEFAULT),
        Structure::Bsp(BspParams::DEFAULT),
    ];
    out.extend(partitions());
    out.extend(clipped());
    out
}

fn hits(scene: &Scene, rays: &[Ray]) -> Vec<Hit> {
    let mut out = vec![Hit::MISS; rays.len()];
    scene.closest(&(), rays, &mut out);
    out
}

/// Compares every tree with brute force; returns how many rays hit.
fn trees_agree(triangles: &[[Vec3; 3]], rays: &[Ray]) -> usize {
    agree(&trees(), triangles, rays)
}

fn agree(trees: &[Structure], triangles: &[[Vec3; 3]], rays: &[Ray]) -> usize {
    let input = world(vec![mesh(triangles)]);
    let expected = hits(&Scene::build(input.clone(), &(), &options(Structure::Brute)).unwrap(), rays);
    for &structure in trees {
        let scene = Scene::build(input.clone(), &(), &options(structure)).unwrap();
        scene.validate().unwrap();
        let found = hits(&scene, rays);
        let mut blocked = vec![false; rays.len()];
        scene.occluded(&(), rays, &mut blocked);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(bits(&found[i]), bits(&expected[i]), "{structure:?}, ray {i}: {ray:?}");
            assert_eq!(blocked[i], expected[i].is_hit(), "{structure:?}, ray {i}: {ray:?}");
        }
    }
    expected.iter().filter(|h| h.is_hit()).count()
}

#[test]
fn soups() {
    for (seed, n) in [(21, 2), (22, 8), (23, 30), (24, 100), (25, 400), (26, 1500)] {
        let mut r = Random(seed);
        let triangles = soup(&mut r, n);
        let rays = rays(&mut r, &triangles, part(2400));
        let (hit, all) = (trees_agree(&triangles, &rays), rays.len());
        assert!(n < 30 || (hit > all / 6 && hit < all - 3), "{hit} of {all} rays hit: the test says little");
    }
}

/// Planes of partitions go through vertices, edges and faces of a lattice, and so do the rays.
#[test]
fn lattices() {
    let mut r = Random(27);
    let triangles: Vec<[Vec3; 3]> = (0..400).map(|_| [r.grid(), r.grid(), r.grid()]).collect();
    let axes = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
    let rays: Vec<Ray> = (0..4000)
        .map(|i| {
            let (o, to) = (r.grid() * 2.0, r.grid());
            Ray::new(o, [axes[r.below(6)], to - o, to * 0.5 + r.grid() * 0.5 - o, r.grid()][i % 4])
        })
        .collect();
    let hit = trees_agree(&triangles, &rays);
    assert!(hit > 1000, "{hit}");
}

/// Slivers seen along their edges and along their planes, where t is all but undetermined.
#[test]
fn slivers_edge_on() {
    let mut r = Random(28);
    let mut triangles = Vec::new();
    for i in 0..300 {
        let (at, along) = (r.point(), r.direction() * [0.1, 1.0, 5.0][i % 3]);
        let width = [0.0, 1e-7, 1e-5, 1e-3][r.below(4)];
        triangles.push([at, at + along, at + along * 0.5 + r.direction() * width]);
    }
    let rays: Vec<Ray> = (0..4000)
        .map(|i| {
            let [a, b, c] = triangles[r.below(300)];
            let inside = a * 0.3 + b * 0.3 + c * 0.4;
            let o = inside - (b - a) * r.signed() * 4.0 + r.point() * [0.0, 1e-7, 1e-4, 0.1][i % 4];
            Ray::new(o, [b - a, c - a, inside - o, inside + (b - a) * 0.1 - o][r.below(4)])
        })
        .collect();
    let hit = trees_agree(&triangles, &rays);
    assert!(hit > 500, "{hit}");
}

/// Slivers no wider than a rounding of their ends, among a crowd of others that could be taken for nearer: what a float
/// determinant says of t would be any place along the sliver.
#[test]
fn slivers_in_a_crowd() {
    for seed in [3026, 3078, 3087] {
        let mut r = Random(seed);
        let mut triangles = Vec::new();
        for _ in 0..100 {
            let (at, along) = (r.point(), r.direction() * 2.0);
            let width = [0.0, 1e-7, 3e-7, 1e-6][r.below(4)];
            triangles.push([at, at + along, at + along * 0.5 + r.direction() * width]);
        }
        for _ in 0..1500 {
            let at = r.point() * 1.5;
            triangles.push([at, at + r.point() * 0.1, at + r.point() * 0.1]);
        }
        let rays: Vec<Ray> = (0..4000)
            .map(|_| {
                let [a, b, c] = triangles[r.below(100)];
                let u = r.signed() * 0.5 + 0.5;
                let inside = a * (1.0 - u) * 0.9 + b * u * 0.9 + c * 0.1;
                let d = r.direction() + (b - a).normalize() * [0.0, 1.0, 5.0][r.below(3)];
                Ray::new(inside - d * 0.5, d)
            })
            .collect();
        let hit = trees_agree(&triangles, &rays);
        assert!(hit > 1000, "{hit}");
    }
}

/// Origins as far as a million times the scene, where a crossing's rounding is as large as many a cell.
#[test]
fn far_origins() {
    let mut r = Random(29);
    let triangles = soup(&mut r, 300);
    for distance in [1e2, 1e4, 1e6] {
        let rays: Vec<Ray> = (0..1500)
            .map(|i| {
                let [a, b, c] = triangles[r.below(300)];
                let to = [a, (a + b) * 0.5, a * 0.25 + b * 0.5 + c * 0.25][i % 3];
                let d = if i % 5 == 0 { Vec3::Z } else { r.direction() };
                Ray::new(to - d * distance, if i % 2 == 0 { d } else { d * distance })
            })
            .collect();
        trees_agree(&triangles, &rays);
    }
}

/// Each factor of ten from 1e-6 to 1e6, all around the origin; and coordinates whose boxes' edges are infinite.
#[test]
fn huge_next_to_tiny() {
    let mut r = Random(30);
    let mut triangles: Vec<[Vec3; 3]> = (0..260)
        .map(|i| {
            let scale = straal_math::ops::powi(10.0, i % 13 - 6);
            [r.point() * scale, r.point() * scale, r.point() * scale]
        })
        .collect();
    let rays: Vec<Ray> = (0..3000)
        .map(|i| {
            let scale = straal_math::ops::powi(10.0, i % 13 - 6);
            let t = triangles[r.below(260)];
            let o = r.point() * scale;
            Ray::new(o, [r.direction(), t[0] - o, (t[1] + t[2]) * 0.5 - o][r.below(3)])
        })
        .collect();
    let hit = trees_agree(&triangles, &rays);
    assert!(hit > 1500, "{hit}");
    triangles.push([Vec3::new(3e38, -3e38, 0.0), Vec3::new(-3e38, -3e38, 0.0), Vec3::new(0.0, 3e38, 1.0)]);
    triangles.push([Vec3::splat(-3e38), Vec3::splat(3e38), Vec3::X]);
    trees_agree(&triangles, &rays);
}

#[test]
fn none_escapes_a_closed_mesh() {
    let (positions, indices) = icosphere(4);
    let kind = GeometryKind::Triangles { positions: positions.clone(), indices };
    let input = world(vec![Geometry { kind, mask: u32::MAX }]);
    for structure in trees() {
        let scene = Scene::build(input.clone(), &(), &options(structure)).unwrap();
        let mut r = Random(31);
        let rays: Vec<Ray> = (0..part(15_000))
            .map(|i| {
                let o = r.point() * 0.5;
                let (a, b) = (positions[r.below(positions.len())], positions[r.below(positions.len())]);
                Ray::new(o, [r.direction(), a - o, (a + b) * 0.5 - o, r.direction()][i % 4])
            })
            .collect();
        let escaped = hits(&scene, &rays).iter().filter(|h| !h.is_hit()).count();
        assert_eq!(escaped, 0, "{structure:?}");
    }
}

/// Neither depth nor memory runs away, whatever can't be parted.
#[test]
fn copies_stay_small() {
    let mut r = Random(32);
    let n = part(18_000);
    let one = [r.point(), r.point(), r.point()];
    let small = one.map(|p| p * 1e-4);
    let same = vec![one; n];
    // Copies at the middle of a scene, and slivers that all cross at one place.
    let mut middle = vec![small; n];
    middle.extend([[Vec3::splat(-1.0), Vec3::new(-1.0, -0.9, -1.0), Vec3::new(-0.9, -1.0, -1.0)]; 2]);
    middle.extend([[Vec3::splat(1.0), Vec3::new(1.0, 0.9, 1.0), Vec3::new(0.9, 1.0, 1.0)]; 2]);
    let star: Vec<[Vec3; 3]> = (0..n)
        .map(|_| {
            let d = r.direction();
            [d, -d, r.direction() * 1e-3]
        })
        .collect();
    for (name, triangles) in [("same", same), ("middle", middle), ("star", star)] {
        for structure in trees() {
            let scene = Scene::build(world(vec![mesh(&triangles)]), &(), &options(structure)).unwrap();
            let stats = scene.stats()[0].unwrap();
            assert!(stats.depth <= 64, "{name}, {structure:?}: {stats:?}");
            assert!(stats.references + stats.leaves <= 17 * n, "{name}, {structure:?}: {stats:?}");
            assert!(scene.memory_bytes() < 2000 * n, "{name}, {structure:?}: {}", scene.memory_bytes());
            let ray =
                Ray::new(Vec3::new(0.3, 0.2, 5.0), triangles[0][0] * 0.4 + triangles[0][1] * 0.3 - Vec3::Z);
            assert_eq!(scene.closest_counted(&(), &ray).0.is_hit(), scene.occluded_counted(&(), &ray).0);
        }
    }
}

#[test]
fn nothing_and_one() {
    let mut r = Random(33);
    let rays = rays(&mut r, &[[Vec3::X, Vec3::Y, Vec3::Z]], 500);
    assert_eq!(trees_agree(&[], &rays), 0);
    assert!(trees_agree(&[[Vec3::X, Vec3::Y, Vec3::Z]], &rays) > 20);
    for structure in trees() {
        let scene = Scene::build(world(vec![]), &(), &options(structure)).unwrap();
        let stats = scene.stats()[0].unwrap();
        assert_eq!((stats.nodes, stats.leaves, stats.references, stats.sah_cost), (0, 1, 0, 0.0));
    }
}
