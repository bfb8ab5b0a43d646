//! A scene after another takes over the structures of what has stayed, and is the scene that it would be by itself.

use crate::common::*;
use straal_accel::*;
use straal_math::{Affine, DVec3, Motion, Transform};

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
