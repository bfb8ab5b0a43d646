//! Lamps within objects: every surface of the registry, stretched, mirrored and nested.

use super::*;
use crate::light::Copies;
use crate::light::copies::Stand;
use crate::light::table::LightTable;
use crate::testing::{ChiSquare, SphereGrid, sidak};
use std::collections::BTreeMap;
use straal_accel::{self as accel, Chain, GeometryKind, Group, Input, Instance};
use straal_math::Transform;

/// A world with objects in which lamps stand.
struct Objects {
    geometry: Geometry,
    search: accel::Scene,
    copies: Copies,
}

impl Objects {
    /// `instances` gives, group by group, what stands in it and how; the world's first. Lamps stand in the groups that `lamps` says.
    fn new(geometry: Geometry, instances: &[&[(u32, Affine)]], lamps: &[u32]) -> Self {
        let groups = instances.iter().map(|all| Group {
            geometries: vec![],
            instances: all
                .iter()
                .map(|(group, m)| Instance {
                    group: *group,
                    transform: Transform::new(m).unwrap(),
                    motion: None,
                    mask: u32::MAX,
                })
                .collect(),
        });
        let mut input = Input { groups: groups.collect(), ..Input::default() };
        for (id, group) in lamps.iter().enumerate() {
            let kind = match geometry.meshes.get(id) {
                Some(mesh) => GeometryKind::Triangles {
                    positions: mesh.positions.clone(),
                    indices: mesh.indices.clone(),
                },
                None => GeometryKind::Shapes { first: 0, count: 1 },
            };
            input.groups[*group as usize].geometries.push(id as u32);
            input.geometries.push(accel::Geometry { kind, mask: u32::MAX });
        }
        let mut copies = Copies::new(&input.groups, lamps);
        copies.complete(lamps.len());
        let search = accel::Scene::build(input, &geometry, &accel::Options::default()).unwrap();
        Self { geometry, search, copies }
    }

    fn within(&self) -> Within<'_> {
        Within { copies: &self.copies, search: Some(&self.search) }
    }
}

/// Ways to stand: stretched, mirrored, and stretched within what was turned and stretched.
fn stands() -> [(&'static str, Vec<Affine>); 3] {
    let stretch = Affine::scale(DVec3::new(1.2, 0.5, 0.8)).then(&turned());
    let mirror = Affine::scale(DVec3::new(-0.9, 0.9, 0.9));
    let within = Affine::scale(DVec3::new(1.25, 1.0, 1.1));
    [("stretched", vec![stretch]), ("mirrored", vec![mirror]), ("nested", vec![stretch, within])]
}

/// The only copy of an example.
fn alone(entry: &Example, way: &[Affine]) -> Objects {
    let each: Vec<[(u32, Affine); 1]> = (1..).zip(way).map(|(group, m)| [(group, *m)]).collect();
    let mut instances: Vec<&[(u32, Affine)]> = each.iter().map(<[_; 1]>::as_slice).collect();
    instances.push(&[]);
    Objects::new(entry.geometry.clone(), &instances, &[way.len() as u32])
}

fn surfaces() -> Vec<Example> {
    registry().into_iter().filter(|e| matches!(e.emitter, Emitter::Area(_))).collect()
}

/// [`Example::pdf`] of a copy.
fn pdf(entry: &Example, stand: &Stand<'_>, at: &Receiver, w: Vec3) -> f32 {
    let from = stand.receiver(at).p;
    // A point that way, brought to the lamp's space.
    let there = stand.receiver(&Receiver::anywhere(at.p + w)).p;
    let Some(own) = (there - from).try_normalize() else { return 0.0 };
    let crossings = entry.crossings(from, own);
    let round = matches!(entry.geometry.shapes.first(), Some(Shape::Sphere(_) | Shape::Ellipsoid(_)));
    let inside = crossings.first().is_some_and(|(_, s)| s.ng.dot(own) > 0.0);
    let points = if round && !inside && !crossings.is_empty() { &crossings[..1] } else { &crossings };
    let of = |(i, s): &(u32, SurfacePoint)| {
        entry.emitter.pdf_of_copy(&entry.geometry, stand, at, (*i, &stand.outwards(s)), false)
    };
    points.iter().map(of).sum()
}

#[test]
fn copies_have_the_density_that_is_told() {
    let all = surfaces();
    let tests = all.len() * VIEWS.len() * stands().len();
    for entry in &all {
        for (how, way) in stands() {
            let objects = alone(entry, &way);
            let stand = objects.within().stand(0, 0);
            // From the first place that it lights: the others lie farther off, where it needs finer cells.
            let mut is_lit = false;
            for (i, p) in VIEWS.into_iter().enumerate() {
                let at = Receiver::anywhere(p);
                let sample = |u: [f32; 4]| {
                    entry.emitter.sample_copy(&entry.geometry, &stand, (&at, [u[0], u[1]]), None, &in_rgb())
                };
                let fine = SphereGrid { rings: 48, sectors: 48, ..SphereGrid::default() };
                let grid = if p.length() < 1.0 {
                    fine
                } else {
                    SphereGrid { axis: (-p).normalize(), focus: 4, ..fine }
                };
                let test = ChiSquare { grid, seed: 300 + i as u64, tests, samples: 10_000 };
                let outcome = test.run(|u| sample(u).map(|s| s.wi), |w| pdf(entry, &stand, &at, w));
                if outcome.drawn == 0.0 {
                    assert!(outcome.integral < 1e-6, "{}, {how}, from {p:?}: {outcome}", entry.name);
                    continue;
                }
                // As for lamps of the world; the way into the object and out rounds a little more.
                let fine =
                    outcome.p >= sidak(0.01, tests) && outcome.impossible <= 20 && outcome.integral < 1.001;
                assert!(fine, "{}, {how}, from {p:?}: {outcome}", entry.name);
                is_lit = true;
                break;
            }
            assert!(is_lit, "{}, {how}, is never lit", entry.name);
        }
    }
}

#[test]
fn what_is_sampled_of_a_copy_is_what_is_hit() {
    let mut rng = Rng(77);
    for entry in surfaces() {
        for (how, way) in stands() {
            let objects = alone(&entry, &way);
            let stand = objects.within().stand(0, 0);
            let mut found = 0;
            for i in 0..300 {
                let at = Receiver { p: VIEWS[i % VIEWS.len()], n: rng.direction() };
                let u = rng.square();
                let Some(s) = entry.emitter.sample_copy(&entry.geometry, &stand, (&at, u), None, &in_rgb())
                else {
                    continue;
                };
                found += 1;
                let hit = SurfacePoint { p: s.to.p, p_err: s.to.p_err, ng: s.to.ng, ..blank() };
                let radiance = entry.emitter.radiance_of_copy(&stand, &hit, -s.wi, &in_rgb());
                // Near its rim the cone of narrowed light is steep.
                let off = (radiance - s.radiance).map(f32::abs).max_lane();
                assert!(off < 2e-3, "{}, {how}: {radiance:?} {s:?}", entry.name);
                assert!(((hit.p - at.p).normalize() - s.wi).length() < 1e-5);
                // The way back to the object rounds the point, which counts where it is seen edge-on.
                let part = (0..entry.geometry.meshes.first().map_or(1, |m| m.indices.len() as u32))
                    .map(|i| entry.emitter.pdf_of_copy(&entry.geometry, &stand, &at, (i, &hit), false));
                let told = part.fold(f32::INFINITY, |best, pdf| {
                    if (pdf - s.pdf).abs() < (best - s.pdf).abs() { pdf } else { best }
                });
                let edge = s.wi.dot(hit.ng).abs();
                assert!(
                    (told / s.pdf - 1.0).abs() < 1e-3 + 2e-6 / edge,
                    "{}, {how}: {told} {s:?}",
                    entry.name
                );
            }
            assert!(found > 20, "{}, {how}: {found}", entry.name);
        }
    }
}

/// What falls on a disc by rays that leave the copy, and by directions to it.
#[test]
fn rays_bring_what_sampling_finds_of_a_copy() {
    let mut told = 0;
    for entry in surfaces() {
        if ["sphere, inside", "ellipsoid"].contains(&entry.name) {
            continue;
        }
        for (how, way) in stands() {
            let objects = alone(&entry, &way);
            let stand = objects.within().stand(0, 0);
            let disc =
                Disc::new(Vec3::new(0.4, 1.9, 0.3), Vec3::new(1.6, 0.0, 0.2), Vec3::new(0.1, 0.3, 1.5));
            let area = Geometry { shapes: vec![Shape::Disc(Box::new(disc))], ..Geometry::default() };
            let mut rng = Rng(5);
            let by_rays = monte_carlo(7, 10_000, |u| {
                let [v, w] = rng.square();
                let u = [u[0], u[1], v, w];
                let Some(emitted) = entry.emitter.emit_copy(&entry.geometry, &stand, u, &in_rgb()) else {
                    return 0.0;
                };
                let ray = Ray::new(emitted.from.p, emitted.d);
                if area.intersect(0, &ray).is_some() { f64::from(emitted.power()[1]) } else { 0.0 }
            });
            let by_directions = monte_carlo(8, 10_000, |u| {
                let Some(s) = area.sample_area(0, rng.square()) else { return 0.0 };
                let at = Receiver::anywhere(s.point.p);
                let light = entry.emitter.sample_copy(&entry.geometry, &stand, (&at, u), None, &in_rgb());
                let Some(light) = light else { return 0.0 };
                let cos = light.wi.dot(s.point.ng).abs();
                f64::from(light.radiance[1] * cos / light.pdf / s.pdf_area)
            });
            let error = (by_rays.1 * by_rays.1 + by_directions.1 * by_directions.1).sqrt();
            assert!(
                (by_rays.0 - by_directions.0).abs() <= 4.5 * error + 1e-4 * by_rays.0,
                "{}, {how}: {by_rays:?} {by_directions:?}",
                entry.name
            );
            told += u32::from(by_rays.0 > 0.0 && error < 0.1 * by_rays.0);
        }
    }
    assert!(told >= 10, "{told} say anything");
}

/// Six boxes and a ball in a crate; crates in shelves, stretched, mirrored and turned; shelves in the world, and a lamp of its own.
fn warehouse(shelves: usize) -> (Objects, Vec<Emitter>) {
    let meshes = vec![super::many::stairs(), TriangleMesh::cuboid(-Vec3::ONE, Vec3::ONE)];
    let geometry = Geometry { meshes, ..Geometry::default() };
    let mut rng = Rng(91);
    let mut place = |spread: f64| {
        let mut f = || f64::from(2.0 * rng.f() - 1.0);
        let scale = DVec3::new(0.3 + 0.2 * f(), 0.3 + 0.2 * f(), if f() > 0.0 { 0.4 } else { -0.4 });
        let axis = DVec3::new(f(), f(), 1.5);
        let turn = Affine::rotate(axis, 180.0 * f()).unwrap();
        let to = DVec3::new(f(), 0.3 * f(), f()) * spread;
        Affine::scale(scale).then(&turn).then(&Affine::translate(to))
    };
    let world: Vec<(u32, Affine)> = (0..shelves).map(|_| (1, place(6.0))).collect();
    let shelf: Vec<(u32, Affine)> = (0..3).map(|_| (2, place(3.0))).collect();
    let objects = Objects::new(geometry, &[&world, &shelf, &[]], &[2, 0]);
    let light = |mesh: u32| {
        let (surface, sides) = (LitSurface::mesh(&objects.geometry, mesh), Sides::Front);
        let (spread, radiance) = (area::Spread::default(), RADIANCE.into());
        Emitter::Area(AreaLight {
            surface,
            radiance,
            opacity: None,
            below: None,
            sides,
            spread,
            placement: None,
        })
    };
    let emitters = vec![light(0), light(1)];
    (objects, emitters)
}

#[test]
fn a_copy_knows_its_way_and_a_hit_its_copy() {
    let (objects, _) = warehouse(5);
    let copies = &objects.copies;
    assert!(copies.has(0) && !copies.has(1) && (copies.count(0), copies.count(1)) == (15, 1));
    let mut seen = std::collections::BTreeSet::new();
    for outer in 0..5 {
        for inner in 5..8 {
            let chain = Chain::EMPTY.inside(inner).inside(outer);
            assert_eq!(chain.iter().collect::<Vec<_>>(), [outer, inner]);
            let number = copies.number(&chain);
            assert!(number < 15 && seen.insert(number));
            assert_eq!(copies.way(0, number).iter().collect::<Vec<_>>(), [outer, inner]);
        }
    }
}

#[test]
fn copies_are_picked_with_the_probability_that_is_told() {
    let (objects, emitters) = warehouse(5);
    let within = objects.within();
    let table = LightTable::within(&emitters, &objects.geometry, 20.0, within);
    assert!(table.splits(0));
    let parts = |index: u32| objects.geometry.meshes[index as usize].indices.len() as u32;
    let (mut rng, mut seen) = (Rng(42), 0);
    for i in 0..6 {
        let p = rng.cube();
        let p = Vec3::new(6.0 * p.x, 2.0 * p.y, 6.0 * p.z);
        let at = Receiver { p, n: if i == 0 { Vec3::ZERO } else { rng.direction() } };
        let rounds = 40_000;
        let mut counts = BTreeMap::<[u32; 3], u32>::new();
        for k in 0..rounds {
            let u = (k as f32 + rng.f()) / rounds as f32;
            let Some(pick) = table.pick(u, &at, within) else { continue };
            let name = [pick.index, pick.copy, pick.part];
            assert_eq!(pick.pmf, table.pmf_of_copy(name, &at, within), "{pick:?}");
            assert!((0.0..1.0).contains(&pick.rest));
            *counts.entry(name).or_default() += 1;
        }
        let (mut total, mut missed) = (0.0, 0);
        for index in 0..2 {
            for (copy, part) in
                (0..objects.copies.count(index)).flat_map(|c| (0..parts(index)).map(move |part| (c, part)))
            {
                let told = table.pmf_of_copy([index, copy, part], &at, within);
                total += told;
                let share = counts.get(&[index, copy, part]).copied().unwrap_or(0) as f32 / rounds as f32;
                missed += u32::from((share - told).abs() > 3.5 / rounds as f32 + 2e-5);
                // Whatever is lit may be picked.
                let stand = within.stand(index, copy);
                let light = &emitters[index as usize];
                let u = rng.square();
                let s = if index == 0 {
                    light.sample_copy(&objects.geometry, &stand, (&at, u), Some(part), &in_rgb())
                } else {
                    let one = in_rgb();
                    let readings = Readings::one(&one);
                    let all =
                        light.sample_parts::<f32, _>(&objects.geometry, (&at, u), Some(part), &readings);
                    (all.pdf > 0.0).then_some(all)
                };
                let lights = s.is_some_and(|s| at.n == Vec3::ZERO || s.wi.dot(at.n) > 1e-3);
                assert!(told > 0.0 || !lights, "{index} {copy} {part} at {at:?}");
            }
        }
        assert!(missed == 0, "{missed} are picked otherwise");
        // Nothing is picked where a node only looks as if it brought something, nor where nothing shines.
        assert!(total < 1.0 + 1e-4, "{total}");
        seen += u32::from(total > 0.0);
    }
    assert!(seen > 0, "no place is lit");
}

/// By points on all of them, by those of a few, and by power: the same light.
#[test]
fn however_copies_are_picked_they_bring_the_same() {
    let at = Receiver { p: Vec3::new(0.5, 3.0, -0.5), n: Vec3::new(0.6, -0.8, 0.0) };
    let brought = |s: Option<LightSample>| {
        s.map_or(0.0, |s| f64::from(s.radiance[1] * ops::max(s.wi.dot(at.n), 0.0) / s.pdf))
    };
    let (objects, emitters) = warehouse(4);
    let within = objects.within();
    let table = LightTable::within(&emitters, &objects.geometry, 20.0, within);
    let by = |pick: Option<Pick>, v: f32, splits: bool| {
        let Some(pick) = pick else { return 0.0 };
        let (light, u) = (&emitters[pick.index as usize], [pick.rest, v]);
        let part = splits.then_some(pick.part);
        let s = if objects.copies.has(pick.index) {
            let stand = within.stand(pick.index, pick.copy);
            light.sample_copy(&objects.geometry, &stand, (&at, u), part, &in_rgb())
        } else {
            let reading = in_rgb();
            let readings = Readings::one(&reading);
            let s = light.sample_parts::<f32, _>(&objects.geometry, (&at, u), part, &readings);
            (s.pdf > 0.0).then_some(s)
        };
        brought(s) / f64::from(pick.pmf)
    };
    let by_tree = monte_carlo(1, 8000, |[u, v]| by(table.pick(u, &at, within), v, true));
    let by_power = monte_carlo(2, 60_000, |[u, v]| by(table.pick_by_power(u, within), v, false));
    let error = (by_tree.1 * by_tree.1 + by_power.1 * by_power.1).sqrt();
    assert!((by_tree.0 - by_power.0).abs() < 4.5 * error, "{by_tree:?} {by_power:?}");
    assert!(error < 0.1 * by_power.0, "{by_tree:?} {by_power:?}");
    assert!(by_tree.1 * 8000.0_f64.sqrt() < by_power.1 * 60_000.0_f64.sqrt());
}

/// Few lamps, of which copies are dealt out in strata.
#[test]
fn a_few_copies_are_weighed_like_a_few_lamps() {
    let geometry = Geometry {
        shapes: vec![Shape::Sphere(Sphere { center: Vec3::ZERO, radius: 0.5 })],
        ..Geometry::default()
    };
    let at =
        |x: f64| Affine::scale(DVec3::new(1.0, 0.6, 1.0)).then(&Affine::translate(DVec3::new(x, 2.0, 0.0)));
    let world = [(1, at(-2.0)), (1, at(0.5)), (1, at(3.0))];
    let objects = Objects::new(geometry, &[&world, &[]], &[1]);
    let (surface, sides) = (LitSurface::Shape(0), Sides::Front);
    let (spread, radiance) = (area::Spread::default(), RADIANCE.into());
    let light = AreaLight { surface, radiance, opacity: None, below: None, sides, spread, placement: None };
    let emitters = [Emitter::Area(light)];
    let table = LightTable::within(&emitters, &objects.geometry, 5.0, objects.within());
    let here = Receiver { p: Vec3::ZERO, n: Vec3::Y };
    let pmf = [0, 1, 2].map(|copy| table.pmf_of_copy([0, copy, 0], &here, objects.within()));
    assert!(pmf.iter().all(|p| (p * 16.0).fract() == 0.0) && pmf.iter().sum::<f32>() == 1.0, "{pmf:?}");
    assert!(pmf[1] > pmf[0] && pmf[0] > pmf[2], "{pmf:?}");
}
