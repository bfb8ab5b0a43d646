//! Distance fields for the tests of the contract, and each distance against its promises.

use super::distance::{Grid, Mix};
use super::*;
use crate::shape::Shape;
use crate::shape::tests::{Example, Rng, Setting};

/// A ball, whose distance is exact.
pub(super) fn examples(stand: &Setting) -> Vec<Example> {
    if stand.scale != 1.0 {
        return vec![];
    }
    let (map, inverse) = (stand.map, stand.map.inverse().expect("it has one"));
    let field = Field::new(map, Arc::new(Body::Ball(DVec3::ZERO, 1.0))).expect("it is somewhere");
    vec![Example::new("field", Shape::Field(Box::new(field)), move |p| {
        let q = inverse.point(p);
        (q.length() - 1.0, inverse.normal_by_inverse(q.normalize()))
    })]
}

fn bodies() -> Vec<(&'static str, Body)> {
    let ball = |x: f64, r: f64| Body::Ball(DVec3::new(x, 0.0, 0.0), r);
    let cube = Body::Box(DVec3::new(0.1, 0.0, -0.1), DVec3::new(0.5, 0.4, 0.3));
    let turn = Affine::scale(DVec3::splat(0.7)).then(&Affine::rotate(DVec3::ONE, 40.0).expect("an axis"));
    let back = turn.inverse().expect("it has one");
    let n = 9;
    let values = (0..n * n * n)
        .map(|i| {
            let at = |k: usize| (k % n) as f64 / 4.0 - 1.0;
            DVec3::new(at(i), at(i / n), at(i / n / n)).length() - 0.7
        })
        .collect();
    vec![
        ("box", cube.clone()),
        ("ring", Body::Ring(DVec3::ZERO, [0.7, 0.2])),
        ("capsule", Body::Capsule([DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.4, 0.5, 0.1)], 0.3)),
        ("cylinder", Body::Cylinder([DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.4, 0.5, 0.1)], 0.3)),
        ("union", Body::Several(Mix::Union, vec![ball(-0.3, 0.5), ball(0.4, 0.4)], 0.3)),
        ("intersection", Body::Several(Mix::Intersection, vec![ball(-0.3, 0.6), ball(0.4, 0.6)], 0.1)),
        ("difference", Body::Several(Mix::Difference, vec![cube.clone(), ball(0.4, 0.3)], 0.1)),
        ("moved", Body::Moved(Box::new(cube.clone()), turn, back, 0.7)),
        ("grown", Body::Grown(Box::new(cube.clone()), 0.1)),
        ("shell", Body::Shell(Box::new(ball(0.0, 0.6)), 0.05)),
        ("ripples", Body::Ripples(Box::new(ball(0.0, 0.7)), [0.05, 0.4])),
        ("grid", Body::Grid(Grid::new(DVec3::splat(-1.0), DVec3::ONE, [n; 3], values).expect("it fits"))),
    ]
}

/// Gradients are those of the values, nothing is steeper than told, and nothing is outside of the box.
#[test]
fn distances_keep_their_promises() {
    let mut rng = Rng(51);
    for (name, body) in bodies() {
        let (low, high) = body.within(0.0);
        let steepest = body.steepest();
        for _ in 0..2000 {
            let p = rng.cube().as_dvec3() * 1.5;
            let q = p + rng.direction().as_dvec3() * 0.3;
            let (a, b) = (body.distance(p), body.distance(q));
            assert!((a - b).abs() <= steepest * (p - q).length() * (1.0 + 1e-9), "{name}: {p:?} {q:?}");
            if a < 0.0 {
                let inside = p.x >= low.x && p.y >= low.y && p.z >= low.z;
                assert!(inside && p.x <= high.x && p.y <= high.y && p.z <= high.z, "{name}: {p:?}");
            }
            let jet = body.value(Jet::of(p));
            let w = rng.direction().as_dvec3() * 1e-6;
            let change = body.distance(p + w) - body.distance(p - w);
            let told = 2.0 * jet.gradient().dot(w);
            // But for the creases.
            assert!((change - told).abs() < 1e-8 || (change.abs() < 2.1e-6 * steepest), "{name}: {p:?}");
        }
    }
}

/// Rays from outside and inside meet a field where its distance is 0, on the side that they come from.
#[test]
fn fields_are_met_where_their_distance_is_nothing() {
    let map = Affine::scale(DVec3::new(1.0, 1.5, 0.6));
    for (name, body) in bodies() {
        let field = Field::new(map, Arc::new(body)).expect("it is somewhere");
        let mut rng = Rng(52);
        let mut hits = 0;
        for _ in 0..400 {
            let o = rng.direction() * 4.0;
            let mut ray = Ray::new(o, rng.cube() * 0.6 - o);
            let mut inside = false;
            while let Some(hit) = field.intersect(&ray) {
                let s = field.surface(&ray, &hit);
                let q = field.inverse.point(s.p.as_dvec3());
                assert!(field.body.distance(q).abs() < 1e-6 * field.steepest, "{name}: {s:?}");
                assert!(s.ng.dot(ray.d) * if inside { 1.0 } else { -1.0 } > -1e-3, "{name}: {s:?} {ray:?}");
                assert!(field.bounds().expect("bounded").contains(s.p), "{name}: {s:?}");
                if !inside {
                    let away = crate::shape::offset_origin(s.p, s.p_err, s.ng, s.ng);
                    assert!(field.body.distance(field.inverse.point(away.as_dvec3())) > 0.0, "{name}: {s:?}");
                }
                inside = !inside;
                ray.t_min = hit.t.next_up();
                hits += 1;
            }
            assert!(!inside, "{name}: {ray:?} never left");
        }
        assert!(hits > 100, "{name}: {hits}");
    }
}
