//! Surfaces side by side: those of many hits are, to the bit, those of each.

use std::path::Path;
use straal::{Job, LoadOptions, Overrides};
use straal_accel::{Hit, Isa};
use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::simd::Simd;
use straal_math::{Ray, Vec3, warp};
use straal_render::footprint::PackedFootprint;
use straal_render::shape::offset::End;
use straal_render::surface::{BLOCK, Met, Surfaces};

/// All forms: triangles flat and smooth, turned round and mirrored; flat shapes and spheres, flipped or not; those that are done one
/// by one; and instances.
const SHAPES: &str = "camera: { perspective: { eye: [0, 1, 9], look_at: [0, 0.5, 0], fov: 60 } }
film: { size: [16, 16] }
materials:
  grey: { diffuse: { reflectance: 0.5 } }
objects: { egg: { sphere: { radius: 0.5 } } }
world:
  - plane: { point: [0, -1, 0] }
  - rectangle: { transform: [{ scale: 2 }, { rotate: { axis: y, degrees: 20 } }, { translate: [-2, 1, -2] }] }
  - rectangle: { flip: true, emission: 2, material: grey, transform: [{ translate: [2, 1, -3] }] }
  - disc: { center: [0, 2, -1], normal: [0.2, 0.1, 1], radius: 1, material: grey }
  - sphere: { center: [-1, 0, 1], radius: 0.7 }
  - sphere: { center: [1, 0, 1.5], radius: 0.6, flip: true, emission: [1, 2, 3] }
  - sphere: { radius: 1, transform: [{ scale: [1, 0.5, 0.7] }, { translate: [3, 0, 0] }] }
  - cylinder: { from: [-3, -1, 0], to: [-3, 1, 0.5], radius: 0.5, material: grey }
  - box: { min: [-0.5, -1, 2], max: [0.3, -0.4, 3], material: grey }
  - triangle: { vertices: [[2, -1, 3], [3, -1, 3], [2.5, 1, 2]], flip: true }
  - instance: { of: egg, material: grey, transform: [{ scale: [1, 2, 1] }, { translate: [0, 1, 2] }] }
  - mesh:
      positions: &points [[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0]]
      normals: &normals [[0, 0, 1], [0.5, 0, 1], [0, 0, -1], [-0.9, 0.9, 0.1]]
      triangles: &corners [[0, 1, 2], [0, 2, 3]]
  - mesh:
      { positions: *points, normals: *normals, triangles: *corners, material: grey,
        transform: [{ scale: [-1, 1, 2] }, { translate: [0, 2, 1] }] }
  - mesh:
      { positions: *points, normals: *normals, triangles: *corners, flip: true, emission: 3,
        transform: [{ translate: [-3, 2, 0] }] }
";

fn job() -> Job {
    let loaded = straal::load_str("shapes.yaml", SHAPES, Path::new(""), &LoadOptions::default());
    Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), Overrides::default()).expect("a world")
}

/// From all around, so that surfaces are seen from both sides.
fn rays(count: u32) -> Vec<Ray> {
    let ray = |i| {
        let name = SampleName::new(5, [0, 0], i);
        let [a, b, c, d] = Pattern::Random.d4(&name, Purpose::Custom);
        let [e, f] = Pattern::Random.d2(&name.child(0), Purpose::Custom);
        let o = warp::uniform_sphere([a, b]) * 6.0 + Vec3::Y * 0.5;
        let to = warp::uniform_sphere([c, d]) * 3.0 * e + Vec3::Y * f;
        Ray::new(o, (to - o).normalize())
    };
    (0..count).map(ray).collect()
}

#[test]
fn many_are_what_each_is() {
    let world = job().world;
    let rays = rays(6000);
    let mut hits = vec![Hit::MISS; rays.len()];
    world.closest(&rays, &mut hits);
    let mut order: Vec<u32> = (0..rays.len() as u32).filter(|&i| hits[i as usize].is_hit()).collect();
    let geometries = || order.iter().map(|&i| hits[i as usize].geometry);
    assert_eq!(geometries().collect::<std::collections::BTreeSet<_>>().len(), 14);
    // Runs of all lengths: first as they come, then those of one geometry one after the other.
    let mut sorted = order.clone();
    sorted.sort_by_key(|&i| hits[i as usize].geometry);
    order.append(&mut sorted);
    let footprint = |_| PackedFootprint::NONE;
    let mut surfaces = Surfaces::default();
    for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
        for order in order.chunks(BLOCK).chain(order.chunks(7)) {
            surfaces.meet(
                &world,
                simd,
                &Met { order, rays: &rays, hits: &hits, corner: &|_| 0.5 },
                footprint,
            );
            for (i, &k) in order.iter().enumerate() {
                let (ray, hit) = (&rays[k as usize], &hits[k as usize]);
                let one = world.surface(ray, hit, &PackedFootprint::NONE);
                assert_eq!(surfaces.end(i), End::from(&one.point), "{simd:?} {hit:?}");
                assert_eq!((surfaces.frame(i), surfaces.ng(i)), (one.frame, one.ng), "{simd:?} {hit:?}");
                assert_eq!(surfaces.bulge(i), one.bulge, "{simd:?} {hit:?}");
                assert_eq!(surfaces.wo.at(i), one.frame.to_local(-ray.d), "{simd:?} {hit:?}");
                assert_eq!((surfaces.material[i], surfaces.emitter[i]), (one.material, one.emitter));
            }
        }
    }
}
