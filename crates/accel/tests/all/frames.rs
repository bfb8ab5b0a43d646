//! A scene after another takes over the structures of what has stayed, and is the scene that it would be by itself.

use crate::common::*;
use straal_accel::*;
use straal_math::{Affine, DVec3, Transform};

/// Two objects, of which the first stands twice in the world and the other once, at `x`.
fn scene(first: &Geometry, second: &Geometry, x: f64) -> Input {
    let place = |group, x: f64| Instance {
        group,
        transform: Transform::new(&Affine::translate(DVec3::new(x, 0.2, 0.0))).unwrap(),
        mask: u32::MAX,
    };
    let of = |geometry| Group { geometries: vec![geometry], instances: vec![] };
    let world = Group { geometries: vec![], instances: vec![place(1, -2.0), place(1, 2.0), place(2, x)] };
    Input { groups: vec![world, of(0), of(1)], geometries: vec![first.clone(), second.clone()] }
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
