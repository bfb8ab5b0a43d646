//! Rays that go along, through or just beside what structures divide space by, and from far away.
//!
//! Box tests are lenient, the more so the farther a ray comes from, and brute force counts whatever they let pass. The
//! shapes here are solid boxes that count as hit wherever a ray passes that test: a structure that is less lenient in any
//! cell or node loses hits.

use crate::common::*;
use straal_accel::*;
use straal_math::{Bounds, Ray, Vec3};

/// Boxes whose own routine says yes to every ray.
struct Solid(Vec<Bounds>);

impl Shapes for Solid {
    fn bounds(&self, shape: u32) -> Option<Bounds> {
        Some(self.0[shape as usize])
    }

    fn intersect(&self, _: u32, ray: &Ray) -> Option<ShapeHit> {
        Some(ShapeHit { t: ray.t_min, u: 0.0, v: 0.0 })
    }
}

fn shapes(count: usize) -> Geometry {
    Geometry { kind: GeometryKind::Shapes { first: 0, count: count as u32 }, mask: u32::MAX }
}

/// Boxes on a lattice, single and in runs, some flat, with a few tiny ones in between.
fn lattice(r: &mut Random, n: usize) -> Vec<Bounds> {
    let mut corner = || Vec3::new(r.below(9) as f32, r.below(9) as f32, r.below(9) as f32);
    let mut out: Vec<Bounds> = (0..n).map(|_| Bounds::of_points([corner(), corner()])).collect();
    for b in out.iter_mut().skip(1).step_by(2) {
        b.max = b.min + Vec3::ONE;
    }
    for _ in 0..n / 4 {
        let c = r.point() * 4.0 + Vec3::splat(4.0);
        out.push(Bounds { min: c, max: c + Vec3::splat(1e-5) });
    }
    out
}

/// A coordinate at, or a few units in the last place beside, a plane that divides [0, 8] evenly.
fn near_plane(r: &mut Random) -> f32 {
    let n = [8, 16, 3, 5, 7, 12][r.below(6)];
    let mut x = 8.0 * r.below(n + 1) as f32 / n as f32;
    for _ in 0..r.below(4) {
        x = if r.below(2) == 0 { x.next_up() } else { x.next_down() };
    }
    x
}

fn near_corner(r: &mut Random) -> Vec3 {
    Vec3::new(near_plane(r), near_plane(r), near_plane(r))
}

/// From near a corner of cells to near another, moved back along itself by up to a million times the scene's size.
fn awkward(r: &mut Random, n: usize) -> Vec<Ray> {
    (0..n)
        .map(|i| {
            let (a, b) = (near_corner(r), near_corner(r));
            let d = match r.below(6) {
                0 => [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z][r.below(6)],
                1 => [Vec3::ONE, Vec3::new(1.0, -1.0, 0.0), Vec3::new(-1.0, 1.0, 1.0)][r.below(3)],
                2 => Vec3::new(1.0, 1e-7 * r.signed(), -1e-20),
                3 => r.direction(),
                _ if a == b => Vec3::X,
                _ => b - a,
            };
            let back = [0.0, 1.0, 10.0, 1e3, 1e4, 1e5, 1e6, 8e6][r.below(8)];
            let mut ray = Ray::new(a - d * back, d * [1.0, 1.0, 1e-3, 1e3][r.below(4)]);
            match i % 8 {
                0 => ray.t_min = back,
                1 => ray.t_min = f32::NEG_INFINITY,
                2 => (ray.t_min, ray.t_max) = (-10.0, 0.0),
                3 => ray.t_max = back + 0.5,
                _ => {}
            }
            ray
        })
        .collect()
}

#[test]
fn solid_boxes_on_a_lattice() {
    for (seed, n) in [(21, 1), (22, 12), (23, 150)] {
        let mut r = Random(seed);
        let boxes = lattice(&mut r, n);
        let rays = awkward(&mut r, part(4500));
        let solid = Solid(boxes);
        let hits = all_agree(&world(vec![shapes(solid.0.len())]), &solid, &rays);
        let hit = hits.iter().filter(|h| h.is_hit()).count();
        assert!(hit * 15 > rays.len(), "{hit} of {} rays hit: the test says little", rays.len());
    }
}

#[test]
fn triangles_on_a_lattice() {
    let mut r = Random(24);
    let mut corner = || Vec3::new(r.below(9) as f32, r.below(9) as f32, r.below(9) as f32);
    let mut triangles: Vec<[Vec3; 3]> = (0..200).map(|_| [corner(), corner(), corner()]).collect();
    for t in triangles.iter_mut().skip(1).step_by(2) {
        *t = [t[0], t[0] + Vec3::X, t[0] + Vec3::new(0.0, 1.0, 1.0)];
    }
    let rays = awkward(&mut r, part(4500));
    all_agree(&world(triangles.chunks(40).map(mesh).collect()), &(), &rays);
}

#[test]
fn huge_beside_tiny() {
    let mut r = Random(25);
    let mut boxes: Vec<Bounds> = Vec::new();
    for scale in [1e-6, 1e-2, 1.0, 1e4, 1e9, 1e18] {
        for _ in 0..12 {
            boxes.push(Bounds::of_points([r.point() * scale, r.point() * scale]));
        }
    }
    boxes.push(Bounds { min: Vec3::splat(-3e38), max: Vec3::splat(3e38) });
    boxes.push(Bounds { min: Vec3::new(-f32::MAX, -1.0, -1.0), max: Vec3::new(f32::MAX, 1.0, 1.0) });
    let solid = Solid(boxes);
    let rays: Vec<Ray> = (0..part(4500))
        .map(|_| {
            let b = solid.0[r.below(72)];
            let o = r.point() * [1e-6, 1.0, 1e5, 1e12, 1e20][r.below(5)];
            let d = match r.below(3) {
                0 => r.direction() * [1e-30, 1.0, 1e30][r.below(3)],
                _ => [b.min, b.max, b.center()][r.below(3)] - o,
            };
            let mut ray = Ray::new(o, d);
            if r.below(3) == 0 {
                ray.t_min = f32::NEG_INFINITY;
            }
            ray
        })
        .collect();
    all_agree(&world(vec![shapes(solid.0.len())]), &solid, &rays);
    // Without the two that hold everything, there is more to miss.
    all_agree(&world(vec![shapes(solid.0.len() - 2)]), &solid, &rays);
}

#[test]
fn copies_in_one_place() {
    let t = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let mut triangles = vec![t; 3000];
    triangles.push([Vec3::splat(1e5), Vec3::splat(1e5) + Vec3::X, Vec3::splat(1e5) + Vec3::Y]);
    let rays = [
        Ray::new(Vec3::new(0.25, 0.25, 3.0), -Vec3::Z),
        Ray::new(Vec3::new(1e5 + 0.25, 1e5 + 0.25, 0.0), Vec3::Z),
        Ray::new(Vec3::new(-1.0, 0.0, 0.0), Vec3::X),
    ];
    let hits = all_agree(&world(vec![mesh(&triangles)]), &(), &rays);
    assert_eq!((hits[0].primitive, hits[1].primitive), (0, 3000));
}
