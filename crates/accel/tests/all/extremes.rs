//! Scenes and directions of any size that single precision has: products of lengths underflow or overflow, ray parameters
//! lose their digits, and small coordinates of directions are taken for larger ones.

use crate::common::*;
use straal_accel::*;
use straal_math::{Ray, Vec3};

fn ball(levels: u32) -> Vec<[Vec3; 3]> {
    let (positions, indices) = icosphere(levels);
    indices.iter().map(|f| f.map(|i| positions[i as usize])).collect()
}

fn scaled(triangles: &[[Vec3; 3]], by: f32) -> Vec<[Vec3; 3]> {
    triangles.iter().map(|t| t.map(|p| p * by)).collect()
}

fn longest(v: Vec3) -> f32 {
    v.abs().max_element()
}

/// From in and around the scene to its vertices, edges, faces and anywhere, along directions whose greatest coordinate is
/// `length`, or along an axis; some with ends.
fn rays_of(r: &mut Random, triangles: &[[Vec3; 3]], scale: f32, length: f32, n: usize) -> Vec<Ray> {
    let mut out = Vec::new();
    while out.len() < n {
        let t = triangles[r.below(triangles.len())];
        let o = match r.below(4) {
            0 => r.point() * (scale * 2.0),
            1 => r.point() * (scale * 30.0),
            2 => t[r.below(3)],
            _ => r.point() * scale,
        };
        let at = match r.below(4) {
            0 => t[r.below(3)],
            1 => t[0] * 0.5 + t[1] * 0.5,
            2 => t[0] * 0.3 + t[1] * 0.3 + t[2] * 0.4,
            _ => r.point() * scale,
        };
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X];
        let toward = (at.as_dvec3() - o.as_dvec3()).try_normalize().map(|d| d.as_vec3());
        let Some(d) = [Some(r.direction()), Some(axes[r.below(4)]), toward, toward][r.below(4)] else {
            continue;
        };
        let mut ray = Ray::new(o, d * (1.0 / longest(d)) * length);
        match r.below(12) {
            0 => ray.t_min = scale / length * 0.3,
            1 => ray.t_max = scale / length * 0.6,
            _ => {}
        }
        // Scaling a coordinate of 1 to the greatest number may round up.
        if ray.is_valid() {
            out.push(ray);
        }
    }
    out
}

const SCALES: [f32; 9] = [1e-38, 1e-30, 1e-20, 1e-15, 1e-12, 1e-7, 1.0, 1e15, 1e25];
const LENGTHS: [f32; 9] = [1e-38, 1e-36, 1e-30, 1e-10, 1.0, 1e6, 1e15, 1e30, f32::MAX];

#[test]
fn the_same_hits_at_any_size() {
    let mut r = Random(41);
    let soup = soup(&mut r, 40);
    for scale in SCALES {
        for triangles in [scaled(&ball(2), scale), scaled(&soup, scale)] {
            let rays: Vec<Ray> =
                LENGTHS.iter().flat_map(|&length| rays_of(&mut r, &triangles, scale, length, 25)).collect();
            let input = world(triangles.chunks(50).map(mesh).collect());
            let brute = Scene::build(input.clone(), &(), &reference()).unwrap();
            let mut expected = vec![Hit::MISS; rays.len()];
            brute.closest(&(), &rays, &mut expected);
            for options in all_options() {
                let scene = Scene::build(input.clone(), &(), &options).unwrap();
                scene.validate().unwrap();
                let (mut hits, mut blocked) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
                scene.closest(&(), &rays, &mut hits);
                scene.occluded(&(), &rays, &mut blocked);
                for (i, ray) in rays.iter().enumerate() {
                    let (got, want) = (&hits[i], &expected[i]);
                    assert_eq!(bits(got), bits(want), "{options:?}, scale {scale:e}, {ray:?}");
                    assert_eq!(blocked[i], want.is_hit(), "{options:?}, scale {scale:e}, {ray:?}");
                }
            }
        }
    }
}

/// Where brute force itself is right: as long as ray parameters are ordinary numbers, and products of two lengths finite.
#[test]
fn none_escapes_a_closed_mesh_of_any_size() {
    let mut r = Random(42);
    let ball = ball(2);
    for scale in SCALES.into_iter().filter(|s| (1e-30..1e18).contains(s)) {
        let triangles = scaled(&ball, scale);
        let scene = Scene::build(world(vec![mesh(&triangles)]), &(), &reference()).unwrap();
        for length in LENGTHS {
            let t = f64::from(scale) / f64::from(length);
            if length < 1e-30 || !(1e-37..1e37).contains(&t) {
                continue;
            }
            let mut rays = rays_of(&mut r, &triangles, scale, length, 60);
            for ray in &mut rays {
                *ray = Ray::new(r.point() * (scale * 0.5), ray.d);
            }
            let mut hits = vec![Hit::MISS; rays.len()];
            scene.closest(&(), &rays, &mut hits);
            for (ray, hit) in rays.iter().zip(&hits) {
                assert!(hit.is_hit(), "scale {scale:e}: {ray:?} escapes");
                let off =
                    (ray.o.as_dvec3() + ray.d.as_dvec3() * f64::from(hit.t)).length() / f64::from(scale);
                // The faces of this ball are no farther from its surface than 4 %.
                assert!((0.96..1.001).contains(&off), "scale {scale:e}: {ray:?} hits at {off} of the radius");
            }
        }
    }
}
