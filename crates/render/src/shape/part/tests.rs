//! Combinations for the tests of the contract, and against what is known point by point.

use super::*;
use crate::shape::tests::{Example, Rng, Setting};
use crate::shape::{Ellipsoid, Shape, Sphere};
use straal_math::{Affine, DVec3, Vec3};

fn leaf(shape: Shape) -> Leaf {
    let geometry = Geometry { shapes: vec![shape], ..Geometry::default() };
    let kind = accel::GeometryKind::Shapes { first: 0, count: 1 };
    let input = accel::Input {
        groups: vec![accel::Group { geometries: vec![0], instances: vec![] }],
        geometries: vec![accel::Geometry { kind, mask: u32::MAX }],
        motions: Vec::new(),
    };
    Leaf::new(geometry, input, vec![Face::Shape(0)]).expect("it can be built")
}

fn mesh_leaf(mesh: crate::shape::TriangleMesh) -> Leaf {
    let kind =
        accel::GeometryKind::Triangles { positions: mesh.positions.clone(), indices: mesh.indices.clone() };
    let geometry = Geometry { meshes: vec![mesh], ..Geometry::default() };
    let input = accel::Input {
        groups: vec![accel::Group { geometries: vec![0], instances: vec![] }],
        geometries: vec![accel::Geometry { kind, mask: u32::MAX }],
        motions: Vec::new(),
    };
    Leaf::new(geometry, input, vec![Face::Mesh(0)]).expect("it can be built")
}

const EVERYWHERE: Bounds = Bounds { min: Vec3::splat(-f32::MAX), max: Vec3::splat(f32::MAX) };

/// A ball with a bite far away: on this side it is the whole ball.
pub(super) fn examples(stand: &Setting) -> Vec<Example> {
    if stand.scale != 1.0 {
        return vec![];
    }
    let (map, inverse) = (stand.map, stand.map.inverse().expect("it has one"));
    let ball =
        |map: Affine| leaf(Shape::Ellipsoid(Box::new(Ellipsoid::new(map).expect("it has an inverse"))));
    let away = Affine::translate(DVec3::new(0.0, 0.0, 1.5)).then(&map);
    let solid = Solid::new(vec![ball(map), ball(away)], vec![Step::Leaf(0), Step::Leaf(1), Step::Without(2)]);
    let part = Part::new(Arc::new(solid.expect("two leaves")), 0, 0, EVERYWHERE).expect("it is there");
    vec![Example::new("bitten ball", Shape::Part(Box::new(part)), move |p| {
        let q = inverse.point(p);
        (q.length() - 1.0, inverse.normal_by_inverse(q.normalize()))
    })]
}

/// What a ray meets first of all the parts of a solid.
fn nearest(parts: &[Part], ray: &Ray) -> Option<(ShapeHit, SurfacePoint)> {
    let hits = parts.iter().filter_map(|part| Some((part.intersect(ray)?, part)));
    let first = hits.fold(None, |best: Option<(ShapeHit, &Part)>, (hit, part)| match best {
        Some((b, _)) if b.t <= hit.t => best,
        _ => Some((hit, part)),
    });
    first.map(|(hit, part)| (hit, part.surface(ray, &hit)))
}

fn sphere(x: f32, radius: f32) -> Leaf {
    leaf(Shape::Sphere(Sphere { center: Vec3::new(x, 0.0, 0.0), radius }))
}

/// A solid whose every point is known: from crossing to crossing of its parts, rays are inside exactly where it is.
#[test]
fn boundaries_are_where_points_change_from_outside_to_inside() {
    let cube = || mesh_leaf(crate::shape::TriangleMesh::cuboid(Vec3::splat(-0.8), Vec3::splat(0.8)));
    let in_ball = |p: Vec3, x: f32, r: f32| (p - Vec3::new(x, 0.0, 0.0)).length() < r;
    let in_cube = |p: Vec3| p.abs().max_element() < 0.8;
    type Holds = fn(bool, bool, bool) -> bool;
    let cases: [(&str, Vec<Step>, Holds); 4] = [
        ("any", vec![Step::Leaf(0), Step::Leaf(1), Step::Leaf(2), Step::Any(3)], |a, b, c| a | b | c),
        ("all", vec![Step::Leaf(0), Step::Leaf(1), Step::Leaf(2), Step::All(3)], |a, b, c| a & b & c),
        ("without", vec![Step::Leaf(2), Step::Leaf(0), Step::Leaf(1), Step::Without(3)], |a, b, c| {
            c & !a & !b
        }),
        (
            "nested",
            vec![Step::Leaf(2), Step::Leaf(0), Step::Leaf(1), Step::Without(2), Step::Without(2)],
            |a, b, c| c & !(a & !b),
        ),
    ];
    for (name, steps, holds) in cases {
        let solid = Solid::new(vec![sphere(0.3, 1.0), sphere(-0.4, 0.9), cube()], steps).expect("sound");
        let solid = Arc::new(solid);
        let parts: Vec<_> =
            (0..3).map(|i| Part::new(solid.clone(), i, 0, EVERYWHERE).expect("it is there")).collect();
        let mut rng = Rng(41);
        let mut crossings = 0;
        for _ in 0..600 {
            let o = rng.direction() * 3.0;
            let mut ray = Ray::new(o, rng.cube() - o);
            let is_in = |p: Vec3| holds(in_ball(p, 0.3, 1.0), in_ball(p, -0.4, 0.9), in_cube(p));
            let (mut start, mut inside) = (0.0, false);
            while let Some((hit, s)) = nearest(&parts, &ray) {
                // In between nothing changes, and beyond it does.
                if hit.t - start > 1e-3 {
                    assert_eq!(is_in(ray.at(0.5 * (start + hit.t))), inside, "{name} {ray:?} {hit:?}");
                }
                assert_eq!(s.ng.dot(ray.d) > 0.0, inside, "{name}: {s:?} looks inwards");
                (start, inside) = (hit.t, !inside);
                ray.t_min = hit.t.next_up();
                crossings += 1;
            }
            assert!(!inside, "{name} {ray:?}: never left");
        }
        assert!(crossings > 300, "{name}: {crossings}");
    }
}

#[test]
fn steps_must_lead_to_one_answer() {
    let two = || vec![sphere(0.0, 1.0), sphere(1.0, 1.0)];
    assert!(Solid::new(two(), vec![Step::Leaf(0), Step::Leaf(1)]).is_none());
    assert!(Solid::new(two(), vec![Step::Leaf(0), Step::Any(2)]).is_none());
    assert!(Solid::new(two(), vec![Step::Leaf(2)]).is_none());
    assert!(Solid::new(vec![], vec![]).is_none());
    let all = Solid::new(two(), vec![Step::Leaf(0), Step::Leaf(1), Step::Without(2)]).expect("sound");
    assert_eq!((all.holds(0b01), all.holds(0b11), all.holds(0b10), all.turned), (true, false, false, 0b10));
}
