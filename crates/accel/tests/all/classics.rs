//! What the textbook's structures promise beside the right hit: costs, bounds of depth and memory, the same structure
//! for any number of threads.

use crate::common::*;
use straal_accel::*;
use straal_math::{Ray, Vec3, ops};

fn tree(split: Split) -> Structure {
    Structure::Bvh2(Bvh2Params { split, leaf_size: 4, ..Bvh2Params::DEFAULT })
}

const SPLITS: [Split; 4] = [Split::Median, Split::Middle, Split::Sah, Split::Agglomerative];

fn build(input: &Input, structure: Structure) -> Scene {
    let scene = Scene::build(input.clone(), &(), &Options { structure, ..Options::default() }).unwrap();
    scene.validate().unwrap();
    scene
}

fn stats(input: &Input, structure: Structure) -> Stats {
    build(input, structure).stats()[0].unwrap()
}

fn sphere(levels: u32) -> Geometry {
    let (positions, indices) = icosphere(levels);
    Geometry { kind: GeometryKind::Triangles { positions, indices }, mask: u32::MAX }
}

/// A sphere of 1280 triangles in a room a thousand times its size.
fn teapot_in_a_stadium() -> Input {
    // The sphere stands away from the middle, where cells would part it.
    let far = |x: f32, y: f32, z: f32| Vec3::new(x + 0.1, y + 0.1, z + 0.1) * 1000.0;
    let room = mesh(&[
        [far(-1.0, -1.0, -1.0), far(1.0, -1.0, -1.0), far(1.0, -1.0, 1.0)],
        [far(-1.0, -1.0, -1.0), far(1.0, -1.0, 1.0), far(-1.0, -1.0, 1.0)],
        [far(-1.0, 1.0, -1.0), far(1.0, 1.0, -1.0), far(1.0, 1.0, 1.0)],
    ]);
    world(vec![sphere(3), room])
}

/// The padded box of a triangle can reach to infinity; the costs that reports and builders go by can't.
#[test]
fn costs_of_huge_triangles_are_numbers() {
    let mut triangles = vec![[Vec3::splat(-3.4e38), Vec3::splat(3.4e38), Vec3::X]];
    triangles.extend((0..20).map(|i| [Vec3::X, Vec3::Y, Vec3::Z].map(|p| p + Vec3::splat(i as f32))));
    for structure in all_structures() {
        let cost = stats(&world(vec![mesh(&triangles)]), structure).sah_cost;
        assert!(cost.is_finite() && cost >= 0.0, "{structure:?}: {cost}");
    }
}

#[test]
fn costs_are_as_the_heuristic_says() {
    let mut r = Random(30);
    let mut parts = vec![sphere(3)];
    parts.extend((0..20).map(|_| {
        let at = r.point() * 20.0;
        mesh(&(0..10).map(|_| [at, at + r.point() * 3.0, at + r.point()]).collect::<Vec<_>>())
    }));
    let input = world(parts);
    let [median, middle, sah, agglomerative] = SPLITS.map(|split| stats(&input, tree(split)).sah_cost);
    assert!(sah <= middle && sah < median, "{sah} {middle} {median}");
    assert!(agglomerative < median, "{agglomerative} {median}");
    // By hand: the box of two triangles side by side is met in two parts with a chance of 3/5 each (half areas of 1
    // by 1 by 1 in 2 by 1 by 1), up to the padding.
    let at = |x: f32| [Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1.0, 1.0, 0.0), Vec3::new(x, 0.0, 1.0)];
    let two = world(vec![mesh(&[at(0.0), at(1.0)])]);
    let found = stats(
        &two,
        Structure::Bvh2(Bvh2Params {
            split: Split::Median,
            leaf_size: 1,
            traversal_cost: 0.5,
            intersection_cost: 2.0,
        }),
    );
    assert_eq!((found.nodes, found.leaves, found.depth), (1, 2, 1));
    assert!((found.sah_cost - (0.25 + 2.0 * 0.6)).abs() < 1e-5, "{}", found.sah_cost);
}

#[test]
fn the_grid_loses_in_the_stadium_and_the_tree_does_not() {
    let input = teapot_in_a_stadium();
    let tests = |structure: Structure| {
        let scene = build(&input, structure);
        let mut r = Random(31);
        let mut sum = 0;
        for _ in 0..2000 {
            let o = r.direction() * 5.0;
            sum += scene.closest_counted(&(), &Ray::new(o, r.point() - o)).1.primitives;
        }
        f64::from(sum) / 2000.0
    };
    let (grid, sah) = (tests(Structure::Grid(GridParams::DEFAULT)), tests(tree(Split::Sah)));
    assert!(grid > 500.0 && sah < 20.0, "{grid} and {sah} triangles a ray");
}

/// By areas, empty space is cut off, which equal numbers on both sides don't do.
#[test]
fn areas_spare_tests_of_bsp_trees() {
    let input = teapot_in_a_stadium();
    let cost = |choice| {
        let scene = build(&input, Structure::Bsp(BspParams { choice, ..BspParams::DEFAULT }));
        let mut r = Random(38);
        let mut sum = Cost::default();
        for _ in 0..2000 {
            let o = r.direction() * 5.0;
            let cost = scene.closest_counted(&(), &Ray::new(o, r.point() - o)).1;
            sum.primitives += cost.primitives;
            sum.nodes += cost.nodes;
        }
        (sum, scene.stats()[0].unwrap().sah_cost)
    };
    let ((even, even_cost), (sah, sah_cost)) = (cost(BspChoice::Even), cost(BspChoice::Sah));
    assert!(sah.primitives * 3 < even.primitives && sah.nodes * 3 < even.nodes * 2, "{sah:?} {even:?}");
    assert!(sah_cost < even_cost, "{sah_cost} {even_cost}");
}

#[test]
fn tighter_volumes_spare_tests() {
    // Long rods, turned.
    let mut r = Random(36);
    let rods = (0..30)
        .map(|_| {
            let (at, along) = (r.point(), r.direction());
            let side = along.cross(r.direction()) * 0.02;
            let up = along.cross(side);
            let near = [at, at + side, at + side + up, at + up];
            let corner = |i: usize| near[i % 4] + if i < 4 { Vec3::ZERO } else { along };
            let quad = |[a, b, c, d]: [usize; 4]| {
                [[corner(a), corner(b), corner(c)], [corner(a), corner(c), corner(d)]]
            };
            let faces = [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
            mesh(&faces.map(quad).concat())
        })
        .collect();
    let input = world(rods);
    let tests = |structure: Structure| {
        let scene = build(&input, structure);
        let mut r = Random(37);
        (0..500)
            .map(|_| {
                let o = r.point() * 3.0;
                scene.closest_counted(&(), &Ray::new(o, r.point() - o)).1
            })
            .fold((0, 0), |(p, b), cost| (p + cost.primitives, b + cost.boxes))
    };
    let volume = |volume| Structure::Volumes(VolumesParams { volume, ..VolumesParams::DEFAULT });
    let all = [VolumeKind::Sphere, VolumeKind::Box, VolumeKind::Oriented];
    let [sphere, aligned, oriented] = all.map(|kind| tests(volume(kind)).0);
    assert_eq!(tests(Structure::Brute), (500 * 30 * 12, 0));
    assert_eq!(tests(volume(VolumeKind::Box)).1, 500 * 30);
    assert!(
        oriented * 4 < aligned && aligned < sphere && sphere < 500 * 30 * 12,
        "{oriented} {aligned} {sphere}"
    );
    let cost = |kind| stats(&input, volume(kind)).sah_cost;
    assert!(cost(VolumeKind::Oriented) < cost(VolumeKind::Box));
}

#[test]
fn mailboxes_spare_tests_and_a_finer_grid_has_fewer() {
    // Long triangles lie in many cells.
    let mut r = Random(32);
    let triangles: Vec<[Vec3; 3]> = (0..400).map(|_| [r.point(), r.point(), r.point()]).collect();
    let input = world(vec![mesh(&triangles)]);
    let cost = |factor, mailboxes| {
        let scene = build(&input, Structure::Grid(GridParams { factor, mailboxes, ..GridParams::DEFAULT }));
        let mut r = Random(33);
        let mut sum = Cost::default();
        for _ in 0..500 {
            let cost = scene.closest_counted(&(), &Ray::new(r.point() * 2.0, r.direction())).1;
            sum.primitives += cost.primitives;
            sum.duplicates += cost.duplicates;
            sum.nodes += cost.nodes;
        }
        sum
    };
    let (with, without) = (cost(2.0, true), cost(2.0, false));
    assert_eq!(with.primitives + with.duplicates, without.primitives);
    assert!(with.duplicates * 10 > without.primitives, "{with:?}");
    assert_eq!((without.duplicates, with.nodes), (0, without.nodes));
    let finer = cost(4.0, false);
    assert!(finer.nodes > without.nodes);
}

#[test]
fn degenerate_scenes_stay_shallow() {
    let one = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let copies = vec![one; 20_000];
    // Each half as large, and half as far from a corner, as the one before.
    let shrinking: Vec<[Vec3; 3]> = (0..120)
        .map(|k| {
            let s = ops::powi(2.0, -k);
            [Vec3::splat(s), Vec3::new(s * 1.5, s, s), Vec3::new(s, s * 1.5, s)]
        })
        .collect();
    // Boxes inside one another, all around one centre.
    let nested: Vec<[Vec3; 3]> =
        (1..3000).map(|k| one.map(|p| (p - Vec3::new(0.5, 0.5, 0.0)) * k as f32)).collect();
    for triangles in [&copies, &shrinking, &nested] {
        let input = world(vec![mesh(triangles)]);
        for split in SPLITS {
            let stats = stats(&input, tree(split));
            assert!(stats.depth < 130, "{split:?}: {stats:?}");
            assert_eq!(stats.references, triangles.len());
        }
    }
    let copies = stats(&world(vec![mesh(&copies)]), tree(Split::Sah));
    assert!(copies.depth <= 15, "copies in one place are halved: {copies:?}");
}

#[test]
fn leaves_hold_no_more_than_they_may() {
    let mut r = Random(34);
    let input = world(vec![mesh(&soup(&mut r, 2000))]);
    for split in SPLITS {
        let one = stats(&input, Structure::Bvh2(Bvh2Params { split, leaf_size: 1, ..Bvh2Params::DEFAULT }));
        assert_eq!((one.leaves, one.nodes + 1), (one.references, one.leaves), "{split:?}");
        let eight = stats(&input, Structure::Bvh2(Bvh2Params { split, leaf_size: 8, ..Bvh2Params::DEFAULT }));
        assert!(eight.leaves < one.leaves && eight.leaves * 8 >= eight.references, "{split:?}");
    }
}

#[test]
fn threads_do_not_matter() {
    let mut r = Random(35);
    let triangles = soup(&mut r, part(6000));
    let rays = rays(&mut r, &triangles, 100);
    let input = world(triangles.chunks(700).map(mesh).collect());
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let of = |structure: Structure| {
                let scene = build(&input, structure);
                let found: Vec<_> = rays.iter().map(|ray| scene.closest_counted(&(), ray)).collect();
                (scene.memory_bytes(), scene.stats(), found)
            };
            all_structures().into_iter().map(of).collect::<Vec<_>>()
        })
    };
    let (one, three) = (run(1), run(3));
    assert!(one == three, "hits, numbers of tests or sizes differ");
}
