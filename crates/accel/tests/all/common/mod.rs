//! Scenes and rays for the tests.
#![allow(dead_code)] // each test binary uses its own part

use std::sync::Arc;
use straal_accel::*;
use straal_math::{Affine, Bounds, DVec3, Ray, Vec3};

/// Whether the tests that try very much were asked for all of it, by `STRAAL_MILLION=1`; a plain run does with a part.
pub fn is_whole() -> bool {
    std::env::var_os("STRAAL_MILLION").is_some()
}

/// So many, or a part of them in a plain run.
pub fn part(of: usize) -> usize {
    if is_whole() { of } else { of / 3 }
}

/// A small generator (Steele et al. 2014, SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// In [-1, 1).
    pub fn signed(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    pub fn point(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// One of few values, so that coordinates coincide.
    pub fn grid(&mut self) -> Vec3 {
        let mut c = || self.below(5) as f32 * 0.5 - 1.0;
        Vec3::new(c(), c(), c())
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            if let Some(d) = self.point().try_normalize() {
                return d;
            }
        }
    }
}

pub fn mesh(triangles: &[[Vec3; 3]]) -> Geometry {
    let positions: Arc<[Vec3]> = triangles.iter().flatten().copied().collect();
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Geometry { kind: GeometryKind::Triangles { positions, indices }, mask: u32::MAX }
}

pub fn world(geometries: Vec<Geometry>) -> Input {
    let all = (0..geometries.len() as u32).collect();
    Input { groups: vec![Group { geometries: all, instances: vec![] }], geometries, motions: Vec::new() }
}

/// Random triangles together with everything that is awkward.
pub fn soup(r: &mut Random, n: usize) -> Vec<[Vec3; 3]> {
    let mut out: Vec<[Vec3; 3]> = Vec::new();
    for i in 0..n {
        let at = r.point();
        let t = match r.below(12) {
            0..=2 => [at, at + r.point() * 0.2, at + r.point() * 0.2],
            3 => [r.grid(), r.grid(), r.grid()],
            4 if i > 0 => out[r.below(i)],
            5 if i > 0 => {
                let [a, b, c] = out[r.below(i)];
                [b, c, a]
            }
            // A neighbour along an edge.
            6 if i > 0 => {
                let [a, b, _] = out[r.below(i)];
                [b, a, a + r.point() * 0.3]
            }
            // Slivers: long and thin.
            7 => {
                let d = r.point() * 3.0;
                [at, at + d, at + d * 0.5 + r.point() * 1e-6]
            }
            8 => [at, at + (r.point() * 1e-5), at + r.point() * 1e-5],
            9 => [at * 1e4, r.point() * 1e4, r.point() * 1e4],
            // Flat in an axis plane.
            10 => {
                let z = (r.below(3) as f32 - 1.0) * 0.5;
                let mut p = || Vec3::new(r.signed(), r.signed(), z);
                [p(), p(), p()]
            }
            // Degenerate, or not finite.
            _ => match r.below(4) {
                0 => [at, at, r.point()],
                1 => [at, at + Vec3::X, at + Vec3::X * 2.0],
                2 => [at, Vec3::new(f32::NAN, 0.0, 0.0), r.point()],
                _ => [at, Vec3::new(f32::INFINITY, 0.0, 0.0), r.point()],
            },
        };
        out.push(t);
    }
    out
}

/// Rays of all kinds, also aimed at the triangles' vertices, edges and insides, and some that aren't valid.
pub fn rays(r: &mut Random, triangles: &[[Vec3; 3]], n: usize) -> Vec<Ray> {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    let mut out = Vec::new();
    while out.len() < n {
        let t = triangles[r.below(triangles.len())];
        let o = match r.below(4) {
            0 => r.point() * 2.0,
            1 => r.point() * 100.0,
            2 => t[r.below(3)],
            _ => r.grid(),
        };
        let target = match r.below(4) {
            0 => t[r.below(3)],
            1 => (t[0] + t[1]) * 0.5,
            2 => t[0] * 0.25 + t[1] * 0.5 + t[2] * 0.25,
            _ => r.grid(),
        };
        let d = match r.below(6) {
            0 => axes[r.below(6)],
            1 => r.direction(),
            2 => r.direction() * 1e-3,
            3 => Vec3::new(r.signed(), r.signed(), 0.0),
            _ => target - o,
        };
        let mut ray = Ray::new(o, d);
        match r.below(10) {
            0 => ray.t_min = 0.5,
            1 => ray.t_max = 1.0,
            2 => ray.t_min = -1.0,
            3 => (ray.t_min, ray.t_max) = (f32::NEG_INFINITY, 2.0),
            _ => {}
        }
        match r.below(60) {
            0 => ray.o.x = f32::NAN,
            1 => ray.d.y = f32::INFINITY,
            2 => ray.d = Vec3::ZERO,
            3 => ray.t_max = f32::NAN,
            4 => (ray.t_min, ray.t_max) = (1.0, 0.5),
            5 => ray.d = Vec3::new(1e-42, -1e-42, 0.0),
            6 => ray.d *= 1e30,
            7 => ray.o *= 1e30,
            _ => {}
        }
        out.push(ray);
    }
    out
}

/// Every structure, with several settings of its parameters.
pub fn all_structures() -> Vec<Structure> {
    let mut out = Structure::ALL.to_vec();
    let grid = |factor, mailboxes, max_cells| {
        Structure::Grid(GridParams { factor, mailboxes, max_cells, ..GridParams::DEFAULT })
    };
    let volumes = |volume| Structure::Volumes(VolumesParams { volume, ..VolumesParams::DEFAULT });
    let wide = |build, compact| Structure::Bvh(BvhParams { build, compact });
    out.extend([wide(Build::Fast, true), wide(Build::Best, false)]);
    out.extend([volumes(VolumeKind::Sphere), volumes(VolumeKind::Oriented)]);
    let tree = |split, leaf_size| Structure::Bvh2(Bvh2Params { split, leaf_size, ..Bvh2Params::DEFAULT });
    out.extend([
        tree(Split::Median, 1),
        tree(Split::Middle, 8),
        tree(Split::Sah, 0),
        tree(Split::Agglomerative, 1),
        tree(Split::Agglomerative, 6),
    ]);
    out.extend(partitions());
    out.extend(clipped());
    out.extend([grid(0.5, false, 1 << 16), grid(5.0, true, 1 << 12), grid(1.0, true, 1)]);
    out
}

/// Kd-trees, octrees and BSP trees that cut as far as they can, and others that hardly do.
pub fn partitions() -> Vec<Structure> {
    let (kd, octree, bsp) = (KdParams::DEFAULT, OctreeParams::DEFAULT, BspParams::DEFAULT);
    vec![
        Structure::Kd(KdParams { traversal_cost: 0.01, empty_bonus: 0.9, max_depth: 64, leaf_size: 0, ..kd }),
        Structure::Kd(KdParams { mailboxes: false, empty_bonus: 0.0, max_depth: 3, ..kd }),
        Structure::Octree(OctreeParams { max_depth: 24, leaf_size: 0, mailboxes: false, ..octree }),
        Structure::Octree(OctreeParams { max_depth: 1, ..octree }),
        Structure::Bsp(BspParams { candidates: 0, leaf_size: 1, mailboxes: false, ..bsp }),
        Structure::Bsp(BspParams {
            candidates: 30,
            leaf_size: 0,
            max_depth: 64,
            straddle_cost: 0.0,
            traversal_cost: 0.0,
            ..bsp
        }),
        Structure::Bsp(BspParams { choice: BspChoice::Sah, ..bsp }),
        Structure::Bsp(BspParams {
            choice: BspChoice::Sah,
            candidates: 3,
            leaf_size: 0,
            max_depth: 64,
            traversal_cost: 0.0,
            ..bsp
        }),
    ]
}

/// Kd-trees whose triangles are clipped.
pub fn clipped() -> Vec<Structure> {
    let kd = KdParams { clip: true, ..KdParams::DEFAULT };
    vec![
        Structure::Kd(kd),
        Structure::Kd(KdParams { traversal_cost: 0.01, max_depth: 64, leaf_size: 0, ..kd }),
    ]
}

/// Every structure with every instruction set that this processor has; those that don't use its vectors with the best.
pub fn all_options() -> Vec<Options> {
    let isas: Vec<Isa> = Isa::ALL.into_iter().filter(|i| i.is_available()).collect();
    let mut out = Vec::new();
    for structure in all_structures() {
        for &isa in &isas {
            if matches!(structure, Structure::Bvh(_)) {
                out.extend([Flight::One, Flight::Many].map(|flight| Options { structure, isa, flight }));
            } else if isa == Isa::detect() {
                out.push(Options { structure, isa, flight: Flight::One });
            }
        }
    }
    out
}

/// Whether searches test hardly fewer primitives than brute force does.
pub fn tests_nearly_all(structure: &Structure) -> bool {
    match structure {
        Structure::Brute | Structure::Volumes(_) => true,
        Structure::Grid(p) => p.max_cells == 1,
        _ => false,
    }
}

pub fn bits(h: &Hit) -> (u32, u32, u32, u32, u32, Chain) {
    (h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.geometry, h.primitive, h.chain)
}

pub fn reference() -> Options {
    Options { structure: Structure::Brute, isa: Isa::Scalar, flight: Flight::One }
}

/// Compares everything with brute force, one ray at a time.
pub fn all_agree<S: Shapes>(input: &Input, shapes: &S, rays: &[Ray]) -> Vec<Hit> {
    let brute = Scene::build(input.clone(), shapes, &reference()).unwrap();
    let mut expected = vec![Hit::MISS; rays.len()];
    for (ray, hit) in rays.iter().zip(&mut expected) {
        brute.closest(shapes, std::slice::from_ref(ray), std::slice::from_mut(hit));
    }
    for options in all_options() {
        let scene = Scene::build(input.clone(), shapes, &options).unwrap();
        scene.validate().unwrap();
        // Only the wide tree searches a slice otherwise than ray by ray, and that only by many.
        let batches: &[usize] = if options.flight == Flight::Many { &[1, 7, 32, 1024] } else { &[32] };
        for &batch in batches {
            let mut hits = vec![Hit::MISS; rays.len()];
            let mut blocked = vec![false; rays.len()];
            for (rays, hits) in rays.chunks(batch).zip(hits.chunks_mut(batch)) {
                scene.closest(shapes, rays, hits);
            }
            for (rays, blocked) in rays.chunks(batch).zip(blocked.chunks_mut(batch)) {
                scene.occluded(shapes, rays, blocked);
            }
            for (i, ray) in rays.iter().enumerate() {
                let (got, want) = (&hits[i], &expected[i]);
                assert_eq!(bits(got), bits(want), "{options:?}, batch {batch}, ray {i}: {ray:?}");
                assert_eq!(blocked[i], want.is_hit(), "{options:?}, batch {batch}, ray {i}: {ray:?}");
            }
        }
        for (ray, want) in rays.iter().zip(&expected) {
            assert_eq!(bits(&scene.closest_counted(shapes, ray).0), bits(want));
            assert_eq!(scene.occluded_counted(shapes, ray).0, want.is_hit());
        }
    }
    expected
}

/// Spheres, and planes at right angles to z (where the radius is negative).
pub struct Spheres(pub Vec<(Vec3, f32)>);

impl Shapes for Spheres {
    fn bounds(&self, shape: u32) -> Option<Bounds> {
        let (c, r) = self.0[shape as usize];
        let half = Vec3::splat(r);
        (r >= 0.0).then(|| Bounds { min: c - half, max: c + half })
    }

    fn intersect(&self, shape: u32, ray: &Ray) -> Option<ShapeHit> {
        let (c, r) = self.0[shape as usize];
        let inside = |t: f32| t >= ray.t_min && t <= ray.t_max;
        if r < 0.0 {
            let t = (c.z - ray.o.z) / ray.d.z;
            return inside(t).then_some(ShapeHit { t, u: 0.0, v: 0.0 });
        }
        let (o, d) = ((ray.o - c).as_dvec3(), ray.d.as_dvec3());
        let (a, b) = (d.dot(d), o.dot(d));
        let root = (b * b - a * (o.dot(o) - f64::from(r) * f64::from(r))).sqrt();
        [(-b - root) / a, (-b + root) / a]
            .into_iter()
            .map(|t| t as f32)
            .find(|&t| inside(t))
            .map(|t| ShapeHit { t, u: 0.25, v: 0.5 })
    }
}

/// A sphere of triangles: an icosahedron, its faces split in four `levels` times, with shared vertices.
pub fn icosphere(levels: u32) -> (Arc<[Vec3]>, Arc<[[u32; 3]]>) {
    let g = (1.0 + 5.0_f32.sqrt()) / 2.0;
    let mut p = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        p.push(Vec3::new(a, b, 0.0).normalize());
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        p.push(Vec3::new(0.0, a, b).normalize());
    }
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        p.push(Vec3::new(b, 0.0, a).normalize());
    }
    // Faces are the triples at the least distance of each other.
    let edge =
        p.iter().skip(1).map(|&q| (q - p[0]).length()).fold(9.0, |a: f32, b| if b < a { b } else { a });
    let near = |a: usize, b: usize| ((p[a] - p[b]).length() - edge).abs() < 1e-3;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    faces.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    assert_eq!(faces.len(), 20);
    for _ in 0..levels {
        let mut middle = std::collections::BTreeMap::new();
        let mut next = Vec::new();
        for f in faces {
            let m: [u32; 3] = std::array::from_fn(|i| {
                let (a, b) = (f[i], f[(i + 1) % 3]);
                *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    p.push((p[a as usize] + p[b as usize]).normalize());
                    p.len() as u32 - 1
                })
            });
            next.extend([[f[0], m[0], m[2]], [f[1], m[1], m[0]], [f[2], m[2], m[1]], m]);
        }
        faces = next;
    }
    (p.into(), faces.into())
}

/// Shapes that are formulas, with their boxes.
pub struct Formulas(pub Vec<(Option<Bounds>, Analytic)>);

impl Shapes for Formulas {
    fn bounds(&self, shape: u32) -> Option<Bounds> {
        self.0[shape as usize].0
    }

    fn intersect(&self, shape: u32, ray: &Ray) -> Option<ShapeHit> {
        self.0[shape as usize].1.intersect(ray)
    }

    fn analytic(&self, shape: u32) -> Option<Analytic> {
        // Some are kept to themselves, and must be found all the same.
        (shape % 13 != 12).then_some(self.0[shape as usize].1)
    }
}

/// A shape of each kind in turn, about so large.
pub fn formula(r: &mut Random, i: usize, size: f32) -> (Option<Bounds>, Analytic) {
    let at = if r.below(3) == 0 { r.grid() } else { r.point() };
    let around = |reach: f32| {
        Some(Bounds { min: at - Vec3::splat(reach * 1.001), max: at + Vec3::splat(reach * 1.001) })
    };
    let center = at.as_dvec3();
    let (a, b) = (r.direction().as_dvec3(), r.direction().as_dvec3());
    let (a, b) = if r.below(4) == 0 { (DVec3::X, DVec3::Y) } else { (a, b) };
    let normal = a.cross(b);
    let scale = f64::from(size);
    let dual = [b.cross(normal), normal.cross(a)].map(|v| v / (normal.dot(normal) * scale));
    let patch = Patch { origin: center, normal, dual };
    let map = Affine::scale(DVec3::new(1.0, 0.8, 0.5) * scale)
        .then(&Affine::rotate(a, f64::from(r.signed()) * 180.0).unwrap())
        .then(&Affine::translate(center));
    let to_unit = map.inverse().unwrap();
    match i % 6 {
        0 => (around(size), Analytic::sphere(center, scale)),
        1 => (around(2.0 * size), Analytic::parallelogram(&patch)),
        2 => (around(2.0 * size), Analytic::disc(&patch)),
        3 => (around(size), Analytic::ellipsoid(&to_unit)),
        4 => (around(2.0 * size), Analytic::cylinder(&to_unit)),
        _ if r.below(8) == 0 => (None, Analytic::plane(center, r.direction().as_dvec3())),
        _ => (around(size), Analytic::sphere(center, scale)),
    }
}
