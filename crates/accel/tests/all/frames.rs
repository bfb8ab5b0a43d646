//! A scene after another takes over the structures of what has stayed, and is the scene that it would be by itself.

use crate::common::*;
use straal_accel::*;
use straal_math::{Affine, DVec3, Motion, Transform, Vec3};

/// Two objects, of which the first stands twice in the world and the other once, at `x`.
fn scene(first: &Geometry, second: &Geometry, x: f64) -> Input {
    let place = |group, x: f64| Instance {
        group,
        transform: Transform::new(&Affine::translate(DVec3::new(x, 0.2, 0.0))).unwrap(),
        motion: None,
        mask: u32::MAX,
    };
    let of = |geometry| Group { geometries: vec![geometry], instances: vec![] };
    let world = Group { geometries: vec![], instances: vec![place(1, -2.0), place(1, 2.0), place(2, x)] };
    Input {
        groups: vec![world, of(0), of(1)],
        geometries: vec![first.clone(), second.clone()],
        motions: Vec::new(),
    }
}

fn hits(scene: &Scene, rays: &[straal_math::Ray]) -> Vec<Hit> {
    let mut out = vec![Hit::MISS; rays.len()];
    scene.closest(&(), rays, &mut out);
    out
}

#[test]
fn what_stays_is_taken_over_and_what_changes_is_built() {
    let mut r = Random(77);
    let (triangles, others) = (soup(&mut r, 200), soup(&mut r, 150));
    let (first, second, bent) = (mesh(&triangles), mesh(&others), mesh(&soup(&mut r, 150)));
    // The same triangles in another place of memory.
    let again = mesh(&triangles);
    let rays = rays(&mut r, &triangles, 300);
    for structure in [Structure::default(), Structure::Kd(KdParams::DEFAULT)] {
        let options = Options { structure, ..Options::default() };
        let mut before = Scene::build(scene(&first, &second, 0.0), &(), &options).unwrap();
        assert_eq!(before.taken_over(), 0);
        for (input, kept) in [
            (scene(&again, &second, 0.5), 2),
            (scene(&again, &bent, 0.5), 1),
            (scene(&bent, &bent, 0.7), 1),
            (scene(&first, &second, 0.7), 0),
        ] {
            let fresh = Scene::build(input.clone(), &(), &options).unwrap();
            let after = Scene::build_after(Some(before), input, &(), &options).unwrap();
            assert_eq!(after.taken_over(), kept);
            after.validate().unwrap();
            assert_eq!(after.dropped(), fresh.dropped());
            for (a, b) in hits(&after, &rays).iter().zip(&hits(&fresh, &rays)) {
                assert_eq!(bits(a), bits(b));
            }
            before = after;
        }
        let other = Options { structure: Structure::Brute, ..options };
        let after = Scene::build_after(Some(before), scene(&first, &second, 0.7), &(), &other).unwrap();
        assert_eq!(after.taken_over(), 0, "another structure");
    }
}

/// A sheet of triangles in the plane z = 0, with `n` on each side, that waves with an amplitude.
fn sheet(n: u32, amplitude: f32) -> Geometry {
    let side = n + 1;
    let place = |i: u32| {
        let (x, y) = ((i % side) as f32 / n as f32, (i / side) as f32 / n as f32);
        // Folds like those of a flag, without a function that differs by machine.
        let fold = |s: f32| 4.0 * (s - s.floor()) * (1.0 - (s - s.floor()));
        Vec3::new(4.0 * x - 2.0, 4.0 * y - 2.0, amplitude * (fold(3.0 * x) + fold(2.0 * y)))
    };
    let faces = (0..n * n).flat_map(|i| {
        let a = i % n + i / n * side;
        [[a, a + 1, a + side], [a + 1, a + side + 1, a + side]]
    });
    Geometry {
        kind: GeometryKind::Triangles {
            positions: (0..side * side).map(place).collect(),
            indices: faces.collect(),
        },
        mask: u32::MAX,
    }
}

/// An object that bends, as itself and in the world with an instance beside it: the tree of the frame before is given other boxes as long as that
/// is about as good, and rays hit what they hit in a tree that is built.
#[test]
fn the_tree_of_what_bends_is_kept_while_it_is_as_good() {
    let mut r = Random(5);
    let rays = rays(&mut r, &soup(&mut Random(6), 200), 400);
    let of = |bent: &Geometry, x: f64| {
        let mut input = scene(bent, &mesh(&soup(&mut Random(9), 90)), x);
        input.groups[0].geometries = vec![0, 1];
        input
    };
    for (n, compact) in [(24, false), (24, true), (4, false)] {
        let structure = Structure::Bvh(BvhParams { compact, ..BvhParams::DEFAULT });
        let options = Options { structure, ..Options::default() };
        let mut before = Scene::build(of(&sheet(n, 0.3), 0.0), &(), &options).unwrap();
        // What bends a little keeps the tree; triangles by a rule of chance don't; no more does another number of them.
        for (bent, x, refitted) in [
            (sheet(n, 0.31), 0.01, 2),
            (sheet(n, 0.32), 0.02, 2),
            (mesh(&soup(&mut Random(8), 2 * (n * n) as usize)), 0.0, 0),
            (sheet(n + 1, 0.3), 0.0, 0),
        ] {
            let fresh = Scene::build(of(&bent, x), &(), &options).unwrap();
            let after = Scene::build_after(Some(before), of(&bent, x), &(), &options).unwrap();
            after.validate().unwrap();
            assert_eq!(after.refitted(), refitted, "{n} {compact}");
            assert_eq!(after.taken_over(), 1, "the object that stays");
            assert_eq!((after.bounds(), after.dropped()), (fresh.bounds(), fresh.dropped()));
            for (a, b) in hits(&after, &rays).iter().zip(&hits(&fresh, &rays)) {
                assert_eq!(bits(a), bits(b));
            }
            before = after;
        }
    }
}

/// Shapes that are formulas move in the tree as triangles do, in their blocks and beside the tree.
#[test]
fn the_tree_of_shapes_that_move_is_kept() {
    for count in [10, 300] {
        let mut r = Random(31);
        let shapes = Formulas((0..count).map(|i| formula(&mut r, i, 0.1)).collect());
        let other = Formulas(shapes.0.iter().rev().cloned().collect());
        let rays = rays(&mut r, &soup(&mut Random(6), 100), 400);
        let of = |amplitude: f32| {
            let kind = GeometryKind::Shapes { first: 0, count: count as u32 };
            let shapes = Geometry { kind, mask: u32::MAX };
            world(vec![sheet(20, amplitude), shapes])
        };
        let options = Options::default();
        let before = Scene::build(of(0.3), &shapes, &options).unwrap();
        let after = Scene::build_after(Some(before), of(0.31), &shapes, &options).unwrap();
        assert_eq!(after.refitted(), 1);
        let after = Scene::build_after(Some(after), of(0.3), &other, &options).unwrap();
        let fresh = Scene::build(of(0.3), &other, &options).unwrap();
        after.validate().unwrap();
        // Beside the tree they may be whatever they like.
        assert_eq!(after.refitted(), usize::from(count == 10));
        let hits = |scene: &Scene| {
            let mut out = vec![Hit::MISS; rays.len()];
            scene.closest(&other, &rays, &mut out);
            out
        };
        for (a, b) in hits(&after).iter().zip(&hits(&fresh)) {
            assert_eq!(bits(a), bits(b));
        }
    }
}

/// A triangle without area in one of two frames isn't in the tree of the other.
#[test]
fn what_can_never_be_hit_in_one_frame_has_no_part_in_a_tree_that_is_kept() {
    let flat = |amplitude: f32, is_flat: bool| {
        let mut sheet = sheet(20, amplitude);
        if let GeometryKind::Triangles { indices, .. } = &mut sheet.kind
            && is_flat
        {
            let mut other = indices.to_vec();
            other[7] = [0, 0, 1];
            *indices = other.into();
        }
        Input {
            groups: vec![Group { geometries: vec![0], instances: vec![] }],
            geometries: vec![sheet],
            motions: Vec::new(),
        }
    };
    let options = Options::default();
    let mut before = Scene::build(flat(0.2, false), &(), &options).unwrap();
    for (amplitude, is_flat, refitted) in
        [(0.21, true, 0), (0.22, true, 1), (0.23, false, 0), (0.24, false, 1)]
    {
        let after = Scene::build_after(Some(before), flat(amplitude, is_flat), &(), &options).unwrap();
        after.validate().unwrap();
        assert_eq!((after.refitted(), after.dropped().len()), (refitted, usize::from(is_flat)));
        before = after;
    }
}

/// Objects that move: every structure, instruction set and way of searching gives what a still scene of each ray's time gives.
#[test]
fn what_moves_is_met_where_it_is_at_a_rays_time() {
    let mut r = Random(123);
    let (small, large) = (mesh(&soup(&mut r, 20)), mesh(&soup(&mut r, 600)));
    let at = |x: f64, turn: f64| {
        let turned = Affine::rotate(DVec3::new(1.0, 2.0, 0.5), turn).unwrap();
        turned.then(&Affine::translate(DVec3::new(x, 0.1 * x, -0.3)))
    };
    let motions = vec![
        Motion::new(vec![at(-1.5, 0.0), at(-1.0, 20.0), at(0.5, 40.0)]).unwrap(),
        Motion::new(vec![at(1.0, 10.0), at(0.2, 0.0)]).unwrap(),
    ];
    let moving = |group, motion: u32| Instance {
        group,
        transform: motions[motion as usize].transforms()[0],
        motion: Some(motion),
        mask: u32::MAX,
    };
    let of = |geometry| Group { geometries: vec![geometry], instances: vec![] };
    // One within another that moves as well.
    let both = Group { geometries: vec![0], instances: vec![moving(2, 1)] };
    let world = Group { geometries: vec![], instances: vec![moving(1, 0), moving(2, 0), moving(3, 1)] };
    let input = Input {
        groups: vec![world, of(0), of(1), both],
        geometries: vec![small, large],
        motions: motions.clone(),
    };
    let times = [0.0, 0.125, 0.5, 0.8125, 1.0];
    let triangles = soup(&mut r, 50);
    let rays: Vec<_> = rays(&mut r, &triangles, part(600))
        .into_iter()
        .enumerate()
        .map(|(i, ray)| straal_math::Ray { time: times[i % times.len()], ..ray })
        .collect();
    // Still scenes, each of one moment.
    let still = |time: f32| {
        let mut input = input.clone();
        for instance in input.groups.iter_mut().flat_map(|g| &mut g.instances) {
            instance.transform = motions[instance.motion.unwrap() as usize].at(time);
            instance.motion = None;
        }
        input.motions.clear();
        Scene::build(input, &(), &Options::default()).unwrap()
    };
    let moments = times.map(|time| hits(&still(time), &rays));
    let mut found = 0;
    for structure in [
        Structure::default(),
        Structure::Brute,
        Structure::Kd(KdParams::DEFAULT),
        Structure::Grid(GridParams::DEFAULT),
        Structure::Bvh2(Bvh2Params::DEFAULT),
    ] {
        for isa in [Isa::Scalar, Isa::detect()] {
            for flight in [Flight::One, Flight::Many] {
                let scene = Scene::build(input.clone(), &(), &Options { structure, isa, flight }).unwrap();
                assert!(scene.moves());
                let (moved, mut blocked) = (hits(&scene, &rays), vec![false; rays.len()]);
                scene.occluded(&(), &rays, &mut blocked);
                for (i, hit) in moved.iter().enumerate() {
                    let want = &moments[i % times.len()][i];
                    assert_eq!(bits(hit), bits(want), "{structure:?} {isa} {flight:?}: ray {i}");
                    assert_eq!(blocked[i], want.is_hit());
                    found += usize::from(hit.is_hit());
                }
            }
        }
    }
    assert!(found > 1000, "only {found} hits");
}
