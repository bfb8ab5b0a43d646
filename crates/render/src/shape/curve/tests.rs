//! Curves for the tests of the contract, and bent ones against their own equation.

use super::*;
use crate::shape::tests::{Example, Rng, Setting};
use crate::shape::{Shape, offset_origin};
use straal_math::Vec3;

/// A straight tube, which is a cylinder.
pub(super) fn examples(stand: &Setting) -> Vec<Example> {
    if stand.scale != 1.0 {
        return vec![];
    }
    let (map, inverse) = (stand.map, stand.map.inverse().expect("it has one"));
    let space = Arc::new(Space::new(map).expect("it has an inverse"));
    let points = [-0.6, -0.2, 0.2, 0.6].map(|y| DVec3::new(0.1, y, 0.0));
    let tube = Curve::new(space.clone(), points, [0.5; 4], [0.0, 1.0], Section::Round);
    let ribbon = Curve::new(space, points, [0.5; 4], [0.0, 1.0], Section::Ribbon([DVec3::Z; 2]));
    let out = |q: DVec3| DVec3::new(q.x - 0.1, 0.0, q.z);
    vec![
        Example::new("tube", Shape::Curve(Box::new(tube)), move |p| {
            let q = out(inverse.point(p));
            (q.length() - 0.5, inverse.normal_by_inverse(q.normalize()))
        }),
        Example::new("ribbon", Shape::Curve(Box::new(ribbon)), move |p| {
            (inverse.point(p).z, inverse.normal_by_inverse(DVec3::Z))
        }),
    ]
}

fn bent(section: Section) -> Curve {
    let space = Arc::new(Space::new(Affine::scale(DVec3::new(1.0, 1.3, 0.8))).expect("it has an inverse"));
    let points = [
        DVec3::new(-1.0, 0.0, 0.0),
        DVec3::new(-0.5, 1.6, 0.4),
        DVec3::new(0.6, -1.2, 0.3),
        DVec3::new(1.0, 0.6, 0.0),
    ];
    Curve::new(space, points, [0.1, 0.14, 0.08, 0.05], [0.0, 1.0], section)
}

/// Rays at a bent tube from everywhere: what they hit lies on it, looks outwards, and isn't hit by what leaves.
#[test]
fn bent_tubes_are_met_where_they_are() {
    let (tube, mut rng) = (bent(Section::Round), Rng(31));
    let mut hits = 0;
    for _ in 0..3000 {
        let o = rng.direction() * 4.0;
        let u = f64::from(rng.f());
        let m = tube.moving(u);
        let aim = tube.space.map.point(m.p + rng.direction().as_dvec3() * (0.9 * m.r)).as_vec3();
        let ray = Ray::new(o, aim - o);
        let hit = tube.intersect(&ray);
        // A point in the tube is behind its skin, but for those that look in at an open end.
        let inside = (0.05..0.95).contains(&u);
        assert!(hit.is_some() || !inside, "{u} {ray:?}");
        let Some(hit) = hit else { continue };
        let s = tube.surface(&ray, &hit);
        let q = tube.space.inverse.point(s.p.as_dvec3());
        let (_, foot) = tube.foot(q, f64::from(s.uv[0]));
        assert!(((q - foot.p).length() - foot.r).abs() < 1e-6, "{s:?}");
        assert!((ray.at(hit.t) - s.p).length() < 1e-5 / ray.d.normalize().dot(s.ng).abs());
        assert!(tube.bounds().expect("bounded").contains(s.p));
        let looks = s.ng.dot(ray.d) < 0.0;
        if looks {
            let away = s.ng + rng.direction() * 0.5;
            let leaving = Ray { t_max: 0.02, ..Ray::new(offset_origin(s.p, s.p_err, s.ng, away), away) };
            assert_eq!(tube.intersect(&leaving), None, "{s:?}");
        }
        hits += 1;
    }
    assert!(hits > 2800, "{hits}");
}

/// The halves of a curve are the curve.
#[test]
fn halves_are_the_same_curve() {
    for section in [Section::Round, Section::Flat, Section::Ribbon([DVec3::Z, DVec3::X])] {
        let (whole, mut rng) = (bent(section), Rng(32));
        let halves = whole.halves();
        let mut hits = 0;
        for _ in 0..1000 {
            let o = rng.direction() * 3.0;
            let ray = Ray::new(o, rng.cube() * 0.6 - o);
            let nearest =
                halves.iter().filter_map(|h| h.intersect(&ray)).map(|h| h.t).fold(f32::INFINITY, f32_min);
            match whole.intersect(&ray) {
                Some(hit) => {
                    assert!((hit.t - nearest).abs() < 2e-3 || section != Section::Round, "{hit:?} {nearest}");
                    hits += 1;
                }
                None => assert!(nearest == f32::INFINITY || section != Section::Round, "{ray:?} {nearest}"),
            }
        }
        assert!(hits > 50, "{section:?}: {hits}");
    }
}

fn f32_min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// A band turns towards the ray, and is as wide as it is told.
#[test]
fn flat_bands_face_whoever_looks() {
    let space = Arc::new(Space::new(Affine::IDENTITY).expect("it has an inverse"));
    let points = [0.0, 1.0, 2.0, 3.0].map(|x| DVec3::new(x, 0.0, 0.0));
    let band = Curve::new(space, points, [0.1; 4], [0.0, 1.0], Section::Flat);
    for turn in 0..12 {
        let (s, c) = ops::sin_cos_degrees(30.0 * f64::from(turn));
        let side = Vec3::new(0.0, c as f32, -s as f32);
        let from = Vec3::new(1.5, 5.0 * s as f32, 5.0 * c as f32);
        for (off, is_hit) in [(-0.11, false), (-0.09, true), (0.0, true), (0.09, true), (0.11, false)] {
            let ray = Ray::new(from + side * off, Vec3::new(0.0, -s as f32, -c as f32));
            let hit = band.intersect(&ray);
            assert_eq!(hit.is_some(), is_hit, "{turn} {off}");
            if let Some(hit) = hit {
                let p = band.surface(&ray, &hit);
                assert!((p.p - ray.at(hit.t)).length() < 1e-5, "{p:?}");
                assert!((p.ng + ray.d).length() < 1e-5 && (p.uv[0] - 0.5).abs() < 1e-5);
            }
        }
    }
}
