//! Footprints against finite differences: what a pixel sees by way of mirrors and glass, flat and curved.

use super::*;
use crate::camera::{Camera, FilmPoint, Perspective, View, Window};
use crate::material::{Bsdf, Conductor, Dielectric, Diffuse, Metal, Mirror, Transport};
use crate::shape::{Geometry, Parallelogram, Plane, Shape, Sphere, SurfacePoint, TriangleMesh};
use straal_color::Light;
use straal_math::DVec3;

/// What a path meets on its way: a surface, and whether it is reflected there or refracted.
enum Stop {
    /// A shape with this BSDF; the number chooses the lobe.
    Shape(Shape, Bsdf<'static>, f32),
    /// A mirror made of triangles with normals of their own.
    Mesh(TriangleMesh),
}

const WHITE: Light = Light([1.0, 1.0, 1.0, 0.0]);

fn mirror() -> Bsdf<'static> {
    Bsdf::Mirror(Mirror { reflectance: WHITE, two_sided: true })
}

fn glass() -> Bsdf<'static> {
    Bsdf::Dielectric(Dielectric { eta: 1.5, reflectance: WHITE, transmittance: WHITE })
}

fn camera() -> Camera {
    let view = View::look_at(DVec3::new(0.0, 1.0, 4.0), DVec3::new(0.0, 0.4, 0.0), DVec3::Y).unwrap();
    Camera::Perspective(Perspective::new(&view, &Window::new(0.4, [64, 48])))
}

/// The floor on which a checker lies.
fn floor() -> Shape {
    Shape::Plane(Plane { point: Vec3::new(0.0, -0.7, 0.0), normal: Vec3::Y })
}

/// A point of the mirror mesh: the nearest triangle's.
fn meet(mesh: &TriangleMesh, ray: &Ray) -> Option<(f32, SurfacePoint, Tangents)> {
    let hits = (0..mesh.indices.len() as u32).filter_map(|i| {
        // Moller and Trumbore.
        let [a, b, c] = mesh.corners(i).map(Vec3::as_dvec3);
        let (e1, e2, d) = (b - a, c - a, ray.d.as_dvec3());
        let h = d.cross(e2);
        let s = ray.o.as_dvec3() - a;
        let q = s.cross(e1);
        let det = e1.dot(h);
        let (u, v, t) = (s.dot(h) / det, d.dot(q) / det, e2.dot(q) / det);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-6).then_some((i, u as f32, v as f32, t as f32))
    });
    let (i, u, v, t) = hits.min_by(|a, b| a.3.total_cmp(&b.3))?;
    Some((t, mesh.surface(i, u, v), mesh.tangents(i, u, v)))
}

fn meet_shape(shape: &Shape, ray: &Ray) -> Option<(f32, SurfacePoint, Tangents)> {
    let geometry = Geometry { shapes: vec![shape.clone()], ..Geometry::default() };
    let hit = geometry.intersect(0, ray)?;
    let point = geometry.surface(0, ray, &hit);
    Some((hit.t, point, geometry.tangents(0, &point)))
}

/// Sends the camera's ray by way of the stops to the floor: its texture coordinates there, and by the footprint their change
/// from pixel to pixel.
fn follow(stops: &[Stop], position: [f32; 2]) -> Option<([f32; 2], [[f32; 2]; 2])> {
    let at = FilmPoint { pixel: [32, 24], ..FilmPoint::at(position) };
    let mut ray = camera().ray(&at)?;
    let mut footprint = camera().footprint(&at).packed();
    for stop in stops {
        let (bsdf, lobe, (t, point, tangents)) = match stop {
            Stop::Shape(shape, bsdf, lobe) => (*bsdf, *lobe, meet_shape(shape, &ray)?),
            Stop::Mesh(mesh) => (mirror(), 0.0, meet(mesh, &ray)?),
        };
        let frame = Frame::from_normal(point.n);
        let wo = frame.to_local(-ray.d);
        let s = bsdf.sample(wo, lobe, [0.5; 2], Transport::Radiance)?;
        let s = BsdfSample { wi: frame.to_world(s.wi), ..s };
        let arriving = footprint.unpacked();
        let dp = arriving.on_surface(&ray, t, point.ng);
        let bend = Bend { dp, n: point.n, tangents: &tangents };
        footprint = arriving.scattered(ray.d, &bend, &s).packed();
        // Off the surface by far more than rounding and far less than a pixel.
        ray = Ray::new(point.p + s.wi * 1e-4, s.wi);
    }
    let (t, point, tangents) = meet_shape(&floor(), &ray)?;
    let duv = footprint.unpacked().on_surface(&ray, t, point.ng).map(|dp| tangents.coordinates(dp));
    Some((point.uv, duv))
}

/// The footprint agrees with neighbouring paths within 5 per cent of its length, in both directions, over the picture.
fn assert_agrees(name: &str, stops: &[Stop]) {
    let mut tried = 0;
    for j in 0..24 {
        for i in 0..32 {
            let at = [2.0 * i as f32 + 0.5, 2.0 * j as f32 + 0.5];
            let Some((_, told)) = follow(stops, at) else { continue };
            for axis in 0..2 {
                const STEP: f32 = 0.02;
                let moved = |by: f32| {
                    let mut place = at;
                    place[axis] += by;
                    follow(stops, place).map(|(uv, _)| uv)
                };
                let (Some(after), Some(before)) = (moved(STEP), moved(-STEP)) else { continue };
                let found = [0, 1].map(|k| (after[k] - before[k]) / (2.0 * STEP));
                let length = |v: [f32; 2]| (v[0] * v[0] + v[1] * v[1]).sqrt();
                // Neither near the horizon or a rim, where a step of a fiftieth of a pixel isn't small, nor where paths come to
                // different triangles.
                let far = found.iter().zip(told[axis]).map(|(a, b)| (a - b).abs() / length(found));
                let off = far.fold(0.0, straal_math::ops::max);
                if length(found) > 0.5 {
                    continue;
                }
                tried += 1;
                assert!(off < 0.05, "{name} at {at:?}, axis {axis}: {:?}, found {found:?}", told[axis]);
            }
        }
    }
    assert!(tried > 40, "{name}: {tried}");
}

fn ball(bsdf: Bsdf<'static>, lobe: f32) -> Stop {
    Stop::Shape(Shape::Sphere(Sphere { center: Vec3::new(0.1, 0.3, 0.0), radius: 0.9 }), bsdf, lobe)
}

fn upright(bsdf: Bsdf<'static>, z: f32, lobe: f32) -> Stop {
    let corner = Vec3::new(-3.0, -0.7, z);
    let pane = Parallelogram::new(corner, Vec3::new(6.0, 0.0, 1.5), Vec3::new(0.0, 4.0, -0.3));
    Stop::Shape(Shape::Parallelogram(Box::new(pane)), bsdf, lobe)
}

#[test]
fn a_checker_seen_straight_or_by_way_of_mirrors_has_its_footprint() {
    assert_agrees("straight", &[]);
    assert_agrees("a flat mirror", &[upright(mirror(), 0.0, 0.0)]);
    assert_agrees("a round mirror", &[ball(mirror(), 0.0)]);
    let metal = Metal { eta: Light::ZERO, k: Light::ZERO, reflectance: WHITE };
    let polished = Bsdf::Conductor(Conductor { metal, two_sided: true });
    assert_agrees("a flat mirror, then metal", &[upright(mirror(), -2.0, 0.0), ball(polished, 0.0)]);
}

#[test]
fn a_checker_seen_through_glass_has_its_footprint() {
    // Numbers of 1 - 2^-24 choose what passes.
    const PASSES: f32 = 0.999_999_94;
    assert_agrees("into glass", &[upright(glass(), 0.0, PASSES)]);
    assert_agrees("a glass ball", &[ball(glass(), PASSES), ball(glass(), PASSES)]);
    assert_agrees(
        "a glass ball with a reflection within",
        &[ball(glass(), PASSES), ball(glass(), 0.0), ball(glass(), PASSES)],
    );
}

#[test]
fn interpolated_normals_bend_footprints_as_they_bend_rays() {
    // A dent of few triangles whose normals lean as if it were round.
    let corners = [[-2.0, -1.5], [2.0, -1.5], [2.0, 2.5], [-2.0, 2.5]];
    let positions: Vec<Vec3> = corners.iter().map(|c| Vec3::new(c[0], c[1], 0.0)).collect();
    let normals = positions.iter().map(|p| Vec3::new(0.15 * p.x, 0.1 * p.y, 1.0).normalize()).collect();
    let mesh = TriangleMesh {
        positions: positions.into(),
        indices: [[0, 1, 2], [0, 2, 3]].into(),
        normals,
        uvs: vec![],
        ..TriangleMesh::default()
    };
    assert_agrees("a mesh", &[Stop::Mesh(mesh.clone())]);
    let uvs = vec![[0.3, 0.1], [2.0, 0.4], [1.0, 3.0], [-1.0, 2.0]];
    assert_agrees("a mesh with a texture of its own", &[Stop::Mesh(TriangleMesh { uvs, ..mesh })]);
}

#[test]
fn rough_bounces_widen_and_packing_keeps_eight_bits() {
    let thin = Footprint { o: [Vec3::ZERO; 2], d: [Vec3::X * 1e-3, Vec3::Y * 2e-3] };
    let diffuse = Bsdf::Diffuse(Diffuse { reflectance: WHITE, two_sided: true });
    let s = diffuse.sample(Vec3::Z, 0.0, [0.4, 0.6], Transport::Radiance).unwrap();
    let tangents = Tangents::about(Vec3::Z);
    let bend = Bend { dp: [Vec3::X, Vec3::Y], n: Vec3::Z, tangents: &tangents };
    let wide = thin.scattered(-Vec3::Z, &bend, &s);
    let width = ROUGH / s.pdf.sqrt();
    for d in wide.d {
        assert!((d.length() / width - 1.0).abs() < 1e-5 && d.dot(s.wi).abs() < 1e-5, "{wide:?}");
    }
    // A lobe that is almost a mirror's has almost the mirror's footprint.
    let sharp = BsdfSample { pdf: 1e9, wi: Vec3::Z, ..s };
    let like_mirror = BsdfSample { delta: true, ..sharp };
    let (sharp, like_mirror) =
        (thin.scattered(-Vec3::Z, &bend, &sharp), thin.scattered(-Vec3::Z, &bend, &like_mirror));
    for k in 0..2 {
        assert!((sharp.d[k] - like_mirror.d[k]).length() < 1e-4);
    }

    let odd = Footprint {
        o: [Vec3::new(1.0, -2e-7, 3e5), Vec3::new(0.0, 0.1, -0.3)],
        d: [Vec3::splat(1e-3), Vec3::X],
    };
    let back = odd.packed().unpacked();
    for (a, b) in odd.o.into_iter().chain(odd.d).zip(back.o.into_iter().chain(back.d)) {
        for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
            assert!((a - b).abs() <= a.abs() / 256.0, "{a} {b}");
        }
    }
    for wrong in [f32::NAN, f32::INFINITY, 1e35, -f32::MAX] {
        assert_eq!(Footprint { o: [Vec3::X * wrong; 2], ..odd }.packed(), PackedFootprint::NONE);
    }
    assert!(size_of::<PackedFootprint>() == 24);
}

/// The first sample stands for its whole pixel, the fourth for a quarter of it, and none for less than 1/64.
#[test]
fn samples_stand_for_parts_of_a_pixel() {
    let whole =
        camera().footprint(&FilmPoint { pixel: [3, 4], position: [3.5, 4.5], lens: [0.5; 2], time: 0.0 });
    let width = |number: u64| {
        let part = whole.of_sample(number);
        part.d[0].length() / whole.d[0].length()
    };
    assert_eq!(whole.of_sample(0), whole);
    assert!((width(3) - 0.5).abs() < 1e-6 && (width(63) - 0.125).abs() < 1e-6);
    assert_eq!(width(1_000_000), width(63));
}
