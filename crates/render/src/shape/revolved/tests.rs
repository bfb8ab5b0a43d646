//! Surfaces of revolution for the tests of the contract, and what each is by a formula.

use super::*;
use crate::shape::tests::{Example, Setting};
use crate::shape::{Geometry, Shape};
use straal_math::Vec3;

/// A curve with its equation in the half-plane: value and gradient.
type Plain = (&'static str, Curve, [f64; 2], fn(f64, f64) -> (f64, Across));

const SWEEP: [f64; 2] = [200.0, 330.0];

fn curves() -> Vec<Plain> {
    let line = [DVec3::new(0.1, -0.6, 0.5), DVec3::new(0.5, 0.5, -0.2)];
    vec![
        ("torus", Torus::new(0.3, [0.0, 360.0]).into(), [0.0, 360.0], |r, y| torus(r, y)),
        ("zone", Zone::new([-0.4, 0.8]).into(), [0.0, 360.0], |r, y| ball(r, y)),
        ("cone", Frustum::new([1.0, 0.3]).into(), [0.0, 360.0], |r, y| (r - 1.0 + 0.7 * y, [1.0, 0.7])),
        ("ring", Ring::new(0.4).into(), [0.0, 360.0], |_, y| (y, [0.0, 1.0])),
        ("bowl", Paraboloid::new(0.0).into(), [0.0, 360.0], |r, y| (r * r - y, [2.0 * r, -1.0])),
        ("line", Hyperboloid::new(line).expect("askew").into(), [0.0, 360.0], |r, y| askew(r, y)),
        ("capsule", Capsule::new([0.6, 0.4]).into(), [0.0, 360.0], |r, y| capsule(r, y)),
        ("part of torus", Torus::new(0.3, [-60.0, 100.0]).into(), SWEEP, |r, y| torus(r, y)),
        ("part of zone", Zone::new([-0.4, 0.8]).into(), SWEEP, |r, y| ball(r, y)),
        ("part of cylinder", Frustum::new([1.0, 1.0]).into(), SWEEP, |r, _| (r - 1.0, [1.0, 0.0])),
        ("part of line", Hyperboloid::new(line).expect("askew").into(), SWEEP, |r, y| askew(r, y)),
        ("part of ring", Ring::new(0.0).into(), SWEEP, |_, y| (y, [0.0, 1.0])),
    ]
}

fn ball(r: f64, y: f64) -> (f64, Across) {
    let length = (r * r + y * y).sqrt();
    (length - 1.0, [r / length, y / length])
}

fn torus(r: f64, y: f64) -> (f64, Across) {
    let length = ((r - 1.0) * (r - 1.0) + y * y).sqrt();
    (length - 0.3, [(r - 1.0) / length, y / length])
}

/// The hyperboloid through the line of `curves`.
fn askew(r: f64, y: f64) -> (f64, Across) {
    let v = (y + 0.6) / 1.1;
    let (x, z) = (0.1 + 0.4 * v, 0.5 - 0.7 * v);
    (r * r - x * x - z * z, [2.0 * r, -2.0 * (0.4 * x - 0.7 * z) / 1.1])
}

/// The distance from balls of radius 0.6 at height 0 and 0.4 at height 1, and all between.
fn capsule(r: f64, y: f64) -> (f64, Across) {
    let lean = 0.2_f64;
    let h = crate::shape::exact::clamped(y - r * lean / (1.0 - lean * lean).sqrt(), 0.0, 1.0);
    let length = (r * r + (y - h) * (y - h)).sqrt();
    (length - 0.6 + 0.2 * h, [r / length, (y - h) / length])
}

/// All of them where things are of ordinary size, and one elsewhere. Their map is stretched less than that of other shapes, so that
/// no torus curves too tightly for the bounds of the tests.
pub(super) fn examples(stand: &Setting) -> Vec<Example> {
    let map = Affine::scale(DVec3::new(1.0, 1.4, 4.0)).then(&stand.map);
    let inverse = map.inverse().expect("it has one");
    let all = curves();
    let mut out = vec![];
    let everywhere = stand.scale == 1.0 && stand.center != Vec3::ZERO;
    let one = (f64::from(stand.scale).to_bits() >> 40) as usize % all.len();
    for (i, (name, curve, phi, equation)) in all.into_iter().enumerate() {
        if !(everywhere || i == one) {
            continue;
        }
        let shape = Revolved::new(&map, curve, phi).expect("it has an inverse");
        out.push(Example::new(name, Shape::Revolved(Box::new(shape)), move |p| {
            let q = inverse.point(p);
            let out = DVec3::new(q.x, 0.0, q.z).normalize();
            let (f, g) = equation(out.dot(q), q.y);
            (f, inverse.normal_by_inverse(upright(g, out)))
        }));
    }
    out
}

fn geometry(curve: impl Into<Curve>, phi: [f64; 2]) -> Geometry {
    let shape = Revolved::new(&Affine::IDENTITY, curve, phi).expect("the map is sound");
    Geometry { shapes: vec![Shape::Revolved(Box::new(shape))], ..Geometry::default() }
}

#[test]
fn areas_are_those_of_the_textbook() {
    let pi = std::f64::consts::PI;
    let whole = [0.0, 360.0];
    let root = |x: f64| x.sqrt();
    for (name, shape, want) in [
        ("sphere", geometry(Zone::new([-1.0, 1.0]), whole), 4.0 * pi),
        ("cap", geometry(Zone::new([0.5, 1.0]), whole), pi),
        ("cone", geometry(Frustum::new([1.0, 0.0]), whole), pi * root(2.0)),
        ("cylinder", geometry(Frustum::new([1.0, 1.0]), [0.0, 90.0]), 0.5 * pi),
        ("ring", geometry(Ring::new(0.5), whole), 0.75 * pi),
        ("bowl", geometry(Paraboloid::new(0.0), whole), pi / 6.0 * (5.0 * root(5.0) - 1.0)),
        ("torus", geometry(Torus::new(0.25, whole), whole), 4.0 * pi * pi * 0.25),
        ("capsule", geometry(Capsule::new([0.5, 0.5]), whole), 2.0 * pi * 0.5 * 2.0),
    ] {
        let area = f64::from(shape.area(0).expect("it has one"));
        assert!((area / want - 1.0).abs() < 1e-6, "{name}: {area}, expected {want}");
    }
}

/// A torus seen at all angles: along a ray from outside it is entered and left by turns, at places that lie on it.
#[test]
fn a_torus_has_no_gaps_at_grazing_angles() {
    for tube in [0.9, 0.25, 0.01, 1e-4] {
        let torus = geometry(Torus::new(tube, [0.0, 360.0]), [0.0, 360.0]);
        let mut hits = 0;
        for i in 0..4000 {
            // Towards a point just inside the tube's skin, along a direction that all but touches it there.
            let (turn, about) = (f64::from(i) * 0.7, f64::from(i) * 1.3);
            let ((s, c), (sy, cy)) = (ops::sin_cos_d(turn), ops::sin_cos_d(about));
            let depth = [1e-2, 1e-4, 1e-6][i as usize % 3];
            let out = DVec3::new(s * cy, sy, c * cy);
            let p = DVec3::new(s, 0.0, c) + out * (tube * (1.0 - depth));
            let along = DVec3::new(c, 0.0, -s);
            let across = out.cross(along);
            let d = (across + along * 0.3 * f64::from(i % 7)).normalize();
            let ray = Ray::new((p - d * 3.0).as_vec3(), d.as_vec3());
            // What rounding of the ray moves it by.
            if depth * tube < 1e-6 {
                continue;
            }
            let hit = torus.intersect(0, &ray);
            assert!(hit.is_some(), "tube {tube}, {i}: {ray:?}");
            hits += 1;
        }
        assert!(hits > 1000 || tube < 0.02, "{tube}: {hits}");
    }
}

/// Rays that start inside what is closed leave it once, to the outside.
#[test]
fn rays_from_inside_leave() {
    let whole = [0.0, 360.0];
    for (shape, inside) in [
        (geometry(Torus::new(0.3, whole), whole), Vec3::new(0.0, 0.1, 1.0)),
        (geometry(Capsule::new([0.6, 0.4]), whole), Vec3::new(0.1, 0.4, 0.2)),
        (geometry(Zone::new([-1.0, 1.0]), whole), Vec3::new(0.1, 0.4, 0.2)),
    ] {
        let mut rng = crate::shape::tests::Rng(21);
        for _ in 0..2000 {
            let mut ray = Ray::new(inside, rng.direction());
            let mut crossings = 0;
            while let Some(hit) = shape.intersect(0, &ray) {
                let s = shape.surface(0, &ray, &hit);
                let leaves = ray.d.dot(s.ng) > 0.0;
                assert_eq!(leaves, crossings % 2 == 0, "{ray:?} {s:?}");
                crossings += 1;
                ray.t_min = hit.t.next_up();
            }
            assert!(crossings % 2 == 1, "{ray:?}: {crossings}");
        }
    }
}
