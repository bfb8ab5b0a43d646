//! Every structure, instruction set and batch size gives the hit of brute force to the last bit.

use crate::common::*;
use straal_accel::*;
use straal_math::{Affine, Bounds, DVec3, Ray, Transform, Vec3};

#[test]
fn soups() {
    for (seed, n) in [(1, 1), (2, 3), (3, 9), (4, 40), (5, 300), (6, 1500)] {
        let mut r = Random(seed);
        let triangles = soup(&mut r, n);
        let rays = rays(&mut r, &triangles, part(1500));
        let hits = all_agree(&world(vec![mesh(&triangles)]), &(), &rays);
        if n >= 40 {
            let (hit, all) = (hits.iter().filter(|h| h.is_hit()).count(), rays.len());
            assert!(hit > all / 5 && hit < all - 3, "{hit} of {all} rays hit: the test says little");
        }
    }
}

#[test]
fn meshes_shapes_and_masks() {
    let mut r = Random(7);
    let triangles = soup(&mut r, 200);
    let mut parts: Vec<Geometry> = triangles.chunks(23).map(mesh).collect();
    let mut shapes = Spheres((0..40).map(|_| (r.point(), r.signed().abs() * 0.2)).collect());
    shapes.0.push((Vec3::splat(-1.5), -1.0));
    shapes.0.push((Vec3::splat(1.5), -1.0));
    parts.insert(3, Geometry { kind: GeometryKind::Shapes { first: 0, count: 42 }, mask: u32::MAX });
    for (i, g) in parts.iter_mut().enumerate() {
        g.mask = 1 << (i % 3);
    }
    let mut rays = rays(&mut r, &triangles, part(1500));
    for ray in &mut rays {
        ray.mask = [u32::MAX, 1, 2, 4, 3, 8, 0][r.below(7)];
    }
    let hits = all_agree(&world(parts.clone()), &shapes, &rays);
    for (ray, hit) in rays.iter().zip(&hits).filter(|(_, h)| h.is_hit()) {
        assert!(parts[hit.geometry as usize].mask & ray.mask != 0);
    }
    assert!(hits.iter().any(|h| h.geometry == 3 && h.primitive >= 40), "a plane is hit");
    assert!(hits.iter().any(|h| h.geometry == 3 && h.primitive < 40), "a sphere is hit");
}

/// Shapes alone and with triangles, a few and many, in the world and in instances, some of which can't be seen.
#[test]
fn formulas() {
    for (seed, shapes, triangles) in [(21, 1, 0), (22, 8, 0), (23, 16, 90), (24, 300, 0), (25, 300, 90)] {
        let mut r = Random(seed);
        let size = if shapes < 50 { 0.5 } else { 0.15 };
        let formulas = Formulas((0..shapes).map(|i| formula(&mut r, i, size)).collect());
        let soup = soup(&mut r, 200);
        let run = |first: u32, count: u32, mask: u32| Geometry {
            kind: GeometryKind::Shapes { first, count },
            mask,
        };
        let half = shapes as u32 / 2;
        let mut geometries = vec![run(0, half, 1), run(half, shapes as u32 - half, u32::MAX)];
        geometries.extend((triangles > 0).then(|| mesh(&soup[..triangles])));
        let mut rays = rays(&mut r, &soup, 400);
        for ray in &mut rays {
            ray.mask = [u32::MAX, u32::MAX, 2][r.below(3)];
        }
        let mut input = world(geometries);
        let hits = all_agree(&input, &formulas, &rays);
        if shapes > 1 {
            let hit = hits.iter().filter(|h| h.is_hit()).count();
            assert!(hit > 50, "{hit} of 400 rays hit: the test says little");
            assert!(hits.iter().any(|h| h.geometry == 0) && hits.iter().any(|h| h.geometry == 1));
        }
        // The same, three times, inside of a world that has one of its own.
        let inner = std::mem::take(&mut input.groups[0]);
        let mut outer = Group { geometries: vec![0], instances: vec![] };
        for _ in 0..3 {
            outer.instances.push(Instance {
                group: 1,
                transform: place(&mut r, 0.7),
                motion: None,
                mask: u32::MAX,
            });
        }
        input.groups = vec![outer, inner];
        let hits = all_agree(&input, &formulas, &rays);
        assert!(shapes == 1 || hits.iter().any(|h| !h.chain.is_empty()));
    }
}

fn place(r: &mut Random, scale: f64) -> Transform {
    let m = Affine::scale(DVec3::new(scale, scale * 1.1, -scale * 0.9))
        .then(&Affine::rotate(r.direction().as_dvec3(), f64::from(r.signed()) * 180.0).unwrap())
        .then(&Affine::translate(r.point().as_dvec3() * 0.3));
    Transform::new(&m).unwrap()
}

#[test]
fn instances_eight_deep() {
    let mut r = Random(8);
    let triangles = soup(&mut r, 60);
    let shapes = Spheres(vec![(Vec3::ZERO, 0.3), (Vec3::X, -1.0), (Vec3::splat(0.5), 0.1)]);
    let spheres = |first, count| Geometry { kind: GeometryKind::Shapes { first, count }, mask: u32::MAX };
    let geometries = vec![mesh(&triangles[..30]), mesh(&triangles[30..]), spheres(0, 1), spheres(1, 2)];
    let mut groups: Vec<Group> =
        (0..9).map(|i| Group { geometries: vec![(i % 3) as u32], instances: vec![] }).collect();
    for (i, g) in groups.iter_mut().enumerate().take(8) {
        let mut add = |mask| {
            g.instances.push(Instance {
                group: i as u32 + 1,
                transform: place(&mut r, 0.9),
                motion: None,
                mask,
            });
        };
        add(u32::MAX);
        add([u32::MAX, 1][i % 2]);
    }
    // The same thing twice in the same place: a tie for the chain to decide.
    let again = groups[0].instances[0];
    groups[0].instances.push(again);
    groups[5].geometries.push(3);
    let input = Input { groups, geometries, motions: Vec::new() };
    let mut rays = rays(&mut r, &triangles, part(900));
    for ray in &mut rays {
        ray.mask = [u32::MAX, 2][r.below(2)];
    }
    let hits = all_agree(&input, &shapes, &rays);
    assert!(hits.iter().any(|h| h.chain.len() == 8), "something eight deep is hit");
    let scene = Scene::build(input.clone(), &shapes, &Options::default()).unwrap();
    for hit in hits.iter().filter(|h| h.is_hit()) {
        let mut group = 0;
        for id in hit.chain.iter() {
            assert!(id != 16, "the twin with the lower number comes first");
            group = scene.instance(id).unwrap().group;
        }
        assert!(input.groups[group as usize].geometries.contains(&hit.geometry));
    }
}

#[test]
fn equal_t_goes_to_the_least_primitive() {
    let t = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
    let input = world(vec![mesh(&[t; 21]), mesh(&[t; 3])]);
    let rays = [Ray::new(Vec3::Z, -Vec3::Z), Ray::new(Vec3::new(0.1, 0.2, -3.0), Vec3::Z)];
    for hit in all_agree(&input, &(), &rays) {
        assert_eq!((hit.geometry, hit.primitive), (0, 0));
    }
}

#[test]
fn barycentrics_are_of_vertices_one_and_two() {
    let v = [Vec3::new(0.0, 0.0, 5.0), Vec3::new(4.0, 0.0, 5.0), Vec3::new(0.0, 4.0, 5.0)];
    let hits = all_agree(&world(vec![mesh(&[v])]), &(), &[Ray::new(Vec3::new(1.0, 2.0, 0.0), Vec3::Z)]);
    assert_eq!((hits[0].t, hits[0].u, hits[0].v), (5.0, 0.25, 0.5));
}

#[test]
fn none_escapes_a_closed_mesh() {
    let (positions, indices) = icosphere(4);
    let mesh =
        Geometry { kind: GeometryKind::Triangles { positions: positions.clone(), indices }, mask: u32::MAX };
    for options in all_options().into_iter().filter(|o| o.structure != Structure::Brute) {
        let count = match &options.structure {
            Structure::Bvh(_) => part(60_000),
            other if tests_nearly_all(other) => part(2_000),
            _ => part(15_000),
        };
        let scene = Scene::build(world(vec![mesh.clone()]), &(), &options).unwrap();
        let mut r = Random(9);
        let rays: Vec<Ray> = (0..count)
            .map(|i| {
                let o = r.point() * 0.5;
                // Half of them aim at vertices and the middles of pairs of them, many of which are edges.
                let a = positions[r.below(positions.len())];
                let b = positions[r.below(positions.len())];
                Ray::new(o, [r.direction(), a - o, (a + b) * 0.5 - o, r.direction()][i % 4])
            })
            .collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        scene.closest(&(), &rays, &mut hits);
        let escaped = hits.iter().filter(|h| !h.is_hit()).count();
        assert_eq!(escaped, 0, "{options:?}");
    }
}

/// The padding of boxes must cover the roundings of a triangle test far from the ray's origin.
#[test]
fn none_slips_through_a_far_floor() {
    let n = 24;
    let mut r = Random(12);
    let corner = |x: usize, z: usize| Vec3::new(x as f32 * 0.37 - 4.0, 0.1, z as f32 * 0.41 - 5.0);
    let mut triangles = Vec::new();
    for x in 0..n {
        for z in 0..n {
            let [a, b, c, d] = [corner(x, z), corner(x + 1, z), corner(x + 1, z + 1), corner(x, z + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let scene = Scene::build(world(vec![mesh(&triangles)]), &(), &Options::default()).unwrap();
    for distance in [1e-3, 1.0, 1e3, 1e5] {
        let rays: Vec<Ray> = (0..20_000)
            .map(|i| {
                let mut o = r.direction() * distance;
                o.y = o.y.abs() + 0.101;
                // Seams between the boxes of neighbours, and anywhere.
                let seam = corner(1 + r.below(n - 1), 1 + r.below(n - 1));
                let other = corner(1 + r.below(n - 1), 1 + r.below(n - 1));
                let to = [seam, Vec3::new(seam.x, seam.y, other.z), seam * 0.3 + other * 0.7][i % 3];
                Ray::new(o, to - o)
            })
            .collect();
        let mut hits = vec![Hit::MISS; rays.len()];
        scene.closest(&(), &rays, &mut hits);
        let slipped = hits.iter().filter(|h| !h.is_hit()).count();
        assert_eq!(slipped, 0, "from {distance}");
        let off = hits.iter().map(|h| (h.t - 1.0).abs()).fold(0.0, |a, b| if b > a { b } else { a });
        assert!(off < 1e-3, "t should be near 1, was off by {off}");
    }
}

#[test]
fn threads_do_not_matter() {
    let mut r = Random(10);
    let triangles = soup(&mut r, 20_000);
    let rays = rays(&mut r, &triangles, 300);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let scene = Scene::build(world(vec![mesh(&triangles)]), &(), &Options::default()).unwrap();
            scene.validate().unwrap();
            let found: Vec<_> = rays.iter().map(|ray| scene.closest_counted(&(), ray)).collect();
            (scene.memory_bytes(), found)
        })
    };
    let (one, two, seven) = (run(1), run(2), run(7));
    assert!(one == two && one == seven, "hits, numbers of tests or sizes differ");
}

#[test]
fn bad_input_is_an_error() {
    let build = |input: Input| Scene::build(input, &(), &Options::default()).err();
    let instance = |group| Instance { group, transform: Transform::IDENTITY, motion: None, mask: u32::MAX };
    let group = |instances| Group { geometries: vec![], instances };
    assert_eq!(build(Input::default()), Some(BuildError::NoWorld));
    let named = Input {
        groups: vec![Group { geometries: vec![0], instances: vec![] }],
        geometries: vec![],
        motions: Vec::new(),
    };
    assert!(matches!(build(named), Some(BuildError::NoSuchGeometry { geometry: 0, count: 0, .. })));
    let input = |groups| Input { groups, geometries: vec![], motions: Vec::new() };
    assert!(matches!(build(input(vec![group(vec![instance(1)])])), Some(BuildError::NoSuchGroup { .. })));
    let cycle = vec![group(vec![instance(1)]), group(vec![instance(2)]), group(vec![instance(1)])];
    assert!(matches!(build(input(cycle)), Some(BuildError::Cycle { .. })));
    let tower = |n: u32| (0..=n).map(|i| group(if i < n { vec![instance(i + 1)] } else { vec![] })).collect();
    assert_eq!(build(input(tower(8))), None);
    assert_eq!(build(input(tower(9))), Some(BuildError::TooDeep));
    let mut bad = mesh(&[[Vec3::X, Vec3::Y, Vec3::Z]]);
    if let GeometryKind::Triangles { indices, .. } = &mut bad.kind {
        *indices = [[0, 1, 3]].into();
    }
    assert!(matches!(build(world(vec![bad])), Some(BuildError::NoSuchVertex { vertex: 3, count: 3, .. })));
}

#[test]
fn nothing_to_hit() {
    let rays = [Ray::new(Vec3::ZERO, Vec3::X)];
    assert!(!all_agree(&world(vec![]), &(), &rays)[0].is_hit());
    let empty = Geometry { kind: GeometryKind::Shapes { first: 0, count: 5 }, mask: u32::MAX };
    let nan = Vec3::new(0.0, f32::NAN, 0.0);
    let flat = mesh(&[[Vec3::X; 3], [Vec3::X, Vec3::Y, nan], [Vec3::ZERO, Vec3::X, Vec3::X * 2.0]]);
    let scene = Scene::build(world(vec![empty, flat]), &(), &Options::default()).unwrap();
    let lost =
        |geometry, not_finite, empty| Dropped { from: DroppedFrom::Geometry(geometry), not_finite, empty };
    assert_eq!(scene.dropped(), [lost(0, 0, 5), lost(1, 1, 2)]);
    assert!(scene.bounds().is_empty());
}

#[test]
fn bounds_hold_the_instances() {
    let shift = Transform::new(&Affine::translate(DVec3::new(10.0, 0.0, 0.0))).unwrap();
    let input = Input {
        groups: vec![
            Group {
                geometries: vec![],
                instances: vec![Instance { group: 1, transform: shift, motion: None, mask: 1 }],
            },
            Group { geometries: vec![0], instances: vec![] },
        ],
        geometries: vec![mesh(&[[Vec3::X, Vec3::Y, Vec3::Z]])],
        motions: Vec::new(),
    };
    let b = Scene::build(input, &(), &Options::default()).unwrap().bounds();
    let exact = Bounds { min: Vec3::new(10.0, 0.0, 0.0), max: Vec3::new(11.0, 1.0, 1.0) };
    assert_eq!(b.union(exact), b);
    assert!((b.min - exact.min).length() < 1e-4 && (b.max - exact.max).length() < 1e-4);
}

/// A scene that is built again from what it was built from is the same.
#[test]
fn a_scene_tells_its_input() {
    let mut r = Random(11);
    let triangles = soup(&mut r, 40);
    let place = |r: &mut Random, group| Instance { group, transform: place(r, 0.8), motion: None, mask: 3 };
    let groups = vec![
        Group { geometries: vec![1], instances: vec![place(&mut r, 2), place(&mut r, 1)] },
        Group { geometries: vec![0, 1], instances: vec![] },
        Group { geometries: vec![0], instances: vec![place(&mut r, 1)] },
    ];
    let input = Input {
        groups,
        geometries: vec![mesh(&triangles[..20]), mesh(&triangles[20..])],
        motions: Vec::new(),
    };
    let scene = Scene::build(input.clone(), &(), &Options::default()).unwrap();
    let told = scene.input();
    assert_eq!(format!("{told:?}"), format!("{input:?}"));
    let again = Scene::build(told, &(), &Options::default()).unwrap();
    for ray in rays(&mut r, &triangles, 200) {
        assert_eq!(again.closest_counted(&(), &ray), scene.closest_counted(&(), &ray));
    }
}

#[test]
fn names_round_trip() {
    for s in Structure::ALL {
        assert_eq!(s.to_string().parse(), Ok(s));
    }
    for i in Isa::ALL {
        assert_eq!(i.to_string().parse(), Ok(i));
    }
    let e = "avx3".parse::<Isa>().unwrap_err().to_string();
    assert_eq!(e, "unknown instruction set 'avx3': expected one of scalar, neon, sse, avx2, avx512");
    assert!("tree".parse::<Structure>().is_err());
}

/// Rays that go side by side are searched as packets, which must not show.
#[test]
fn bundles_of_rays() {
    let mut r = Random(14);
    let triangles = soup(&mut r, 200);
    let (positions, indices) = icosphere(2);
    let ball = Geometry { kind: GeometryKind::Triangles { positions, indices }, mask: 2 };
    let shapes = Spheres((0..40).map(|_| (r.point(), r.signed().abs() * 0.1)).collect());
    let spheres = Geometry { kind: GeometryKind::Shapes { first: 0, count: 40 }, mask: 3 };
    let mut input = world(vec![mesh(&triangles), ball, spheres]);
    input.groups.push(Group { geometries: vec![1, 2], instances: vec![] });
    let instances = (0..5)
        .map(|_| Instance { group: 1, transform: place(&mut r, 0.2), motion: None, mask: u32::MAX })
        .collect();
    input.groups[0].instances = instances;
    let mut rays = Vec::new();
    for bundle in 0..20 {
        let (o, at) = (r.point() * [2.0, 30.0, 1e4][bundle % 3], r.point());
        for _ in 0..[64, 64, 70, 200][bundle % 4] {
            // From one point, or towards one: a camera's rays, and a lamp's. Some along an axis.
            let (o, at) = match bundle % 5 {
                0 | 1 => (o, at + r.point() * 0.1),
                2 | 3 => (o + r.point() * 0.05, at),
                _ => {
                    (Vec3::new(at.x + r.signed() * 0.02, at.y + r.signed() * 0.02, -3.0), at + Vec3::Z * 3.0)
                }
            };
            let d = if bundle % 5 == 4 { Vec3::Z } else { at - o };
            let mut ray = Ray::new(o, d);
            match r.below(20) {
                0 => ray.t_max = 1.0,
                1 => ray.t_min = 0.5,
                2 => ray.mask = 1,
                _ => {}
            }
            rays.push(ray);
        }
    }
    let hits = all_agree(&input, &shapes, &rays);
    let hit = hits.iter().filter(|h| h.is_hit()).count();
    assert!(
        hit * 4 > rays.len() && hit < rays.len(),
        "{hit} of {} rays hit: the test says little",
        rays.len()
    );
}
