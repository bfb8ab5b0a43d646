//! Many lights, as a tree.

use super::*;
use crate::light::table::Picks;
use std::collections::BTreeMap;

/// Lamps of all kinds all over a street, black ones among them, a sun and a sky, and a mesh of many triangles.
fn street(count: usize) -> (Geometry, Vec<Emitter>) {
    let mut rng = Rng(41);
    let (mut geometry, mut emitters) = (Geometry::default(), Vec::new());
    for i in 0..count {
        let p = cube(&mut rng);
        let strong = ops::exp2(6.0 * rng.f() - 3.0);
        let light = Light::rgb([strong; 3]);
        let area = |surface, sides| {
            Emitter::Area(AreaLight {
                surface,
                radiance: light.into(),
                opacity: None,
                below: None,
                sides,
                spread: area::Spread::default(),
                placement: None,
            })
        };
        emitters.push(match i % 5 {
            0 => Emitter::Point(PointLight { position: p, intensity: light.into(), falls: true }),
            1 => {
                let cone = Cone { axis: rng.direction(), beam: 20.0, cutoff: 50.0, falloff: Falloff::Linear };
                Emitter::Spot(SpotLight::new(p, light, &cone).unwrap())
            }
            2 => {
                geometry.shapes.push(Shape::Sphere(Sphere { center: p, radius: 0.1 }));
                area(LitSurface::Shape(geometry.shapes.len() as u32 - 1), Sides::Front)
            }
            3 => {
                let (a, b) = (rng.direction() * 0.3, rng.direction() * 0.2);
                geometry.shapes.push(Shape::Parallelogram(Box::new(Parallelogram::new(p, a, b))));
                let sides = [Sides::Front, Sides::Back, Sides::Both][i / 5 % 3];
                area(LitSurface::Shape(geometry.shapes.len() as u32 - 1), sides)
            }
            _ => Emitter::Point(PointLight { position: p, intensity: Light::ZERO.into(), falls: true }),
        });
        if i == 0 {
            geometry.meshes.push(stairs());
            let mesh = LitSurface::mesh(&geometry, 0);
            let mut glows = area(mesh, Sides::Front);
            if let Emitter::Area(light) = &mut glows {
                light.radiance = Light::rgb([0.3; 3]).into();
            }
            emitters.push(glows);
        }
    }
    emitters.push(Emitter::Directional(DirectionalLight::new(Vec3::new(0.3, -1.0, 0.2), RADIANCE).unwrap()));
    emitters.push(Emitter::Constant(ConstantEnvironment { radiance: RADIANCE.into() }));
    (geometry, emitters)
}

/// Six boxes in a row, 72 triangles.
pub(super) fn stairs() -> TriangleMesh {
    let step =
        |i: usize| TriangleMesh::cuboid(Vec3::new(i as f32, 0.0, 0.0), Vec3::new(i as f32 + 0.8, 0.3, 1.0));
    let (mut positions, mut indices) = (vec![], vec![]);
    for i in 0..6 {
        let (next, first) = (step(i), positions.len() as u32);
        positions.extend_from_slice(&next.positions);
        indices.extend(next.indices.iter().map(|corners| corners.map(|c| c + first)));
    }
    TriangleMesh { positions: positions.into(), indices: indices.into(), ..TriangleMesh::default() }
}

fn cube(rng: &mut Rng) -> Vec3 {
    let p = rng.cube();
    Vec3::new(20.0 * p.x, 2.0 * p.y, 5.0 * p.z)
}

fn receiver(rng: &mut Rng, i: usize) -> Receiver {
    let p = cube(rng);
    Receiver { p, n: if i.is_multiple_of(3) { Vec3::ZERO } else { rng.direction() } }
}

/// By lamp and triangle.
fn pmf(table: &LightTable, (index, part): (u32, u32), at: &Receiver) -> f32 {
    if table.splits(index) { table.pmf_of_part(index, part, at) } else { table.pmf(index, at) }
}

#[test]
fn they_are_picked_with_the_probability_that_is_told() {
    let (geometry, emitters) = street(100);
    let table = LightTable::new(&emitters, &geometry, 20.0);
    assert!(table.splits(1) && !table.splits(0));
    let mut rng = Rng(42);
    for i in 0..6 {
        let at = receiver(&mut rng, i);
        let mut counts = BTreeMap::<(u32, u32), u32>::new();
        let rounds = 20_000;
        let (mut rests, mut picked) = (0.0, 0.0);
        for k in 0..rounds {
            let u = (k as f32 + rng.f()) / rounds as f32;
            let Some(pick) = table.pick(u, &at, Within::WORLD) else { continue };
            assert_eq!(pick.pmf, pmf(&table, (pick.index, pick.part), &at), "{pick:?}");
            assert!((0.0..1.0).contains(&pick.rest));
            rests += f64::from(pick.rest);
            picked += 1.0;
            *counts.entry((pick.index, pick.part)).or_default() += 1;
        }
        let parts = |index: u32| match &emitters[index as usize] {
            Emitter::Area(AreaLight { surface: LitSurface::Mesh { mesh, .. }, .. }) => {
                geometry.meshes[*mesh as usize].indices.len() as u32
            }
            _ => 1,
        };
        let all = (0..emitters.len() as u32).flat_map(|i| (0..parts(i)).map(move |part| (i, part)));
        let mut total = 0.0;
        for (index, part) in all {
            let told = pmf(&table, (index, part), &at);
            total += told;
            let part = if table.splits(index) { part } else { u32::MAX };
            let share = counts.get(&(index, part)).copied().unwrap_or(0) as f32 / rounds as f32;
            // Stratified numbers: off by two of them at most, and rounding.
            assert!((share - told).abs() <= 2.5 / rounds as f32 + 1e-5, "{index} {part}: {share} {told}");
        }
        // A node may look as if it brought something where neither of its halves does: then nothing is picked.
        assert!(total < 1.0 + 1e-4 && total > 0.5, "{total}");
        assert!((rests / picked - 0.5).abs() < 0.02, "{rests} {picked}");
    }
}

#[test]
fn whatever_lights_a_point_may_be_picked() {
    let (geometry, emitters) = street(60);
    let table = LightTable::new(&emitters, &geometry, 20.0);
    let mut rng = Rng(43);
    for i in 0..60 {
        let at = receiver(&mut rng, i);
        for (index, emitter) in (0..).zip(&emitters) {
            if table.splits(index) {
                continue;
            }
            let light = emitter.sample(&geometry, &at, rng.square(), &in_rgb());
            let Some(s) = light.filter(|s| at.n == Vec3::ZERO || s.wi.dot(at.n) > 1e-3) else { continue };
            assert!(table.pmf(index, &at) > 0.0, "{emitter:?} at {at:?}: {s:?}");
        }
    }
}

#[test]
fn side_by_side_they_are_picked_as_one_after_the_other() {
    use straal_math::simd::{BLOCK, Isa, Kernel, Simd, Uint};
    struct Pick<'a>(&'a LightTable, &'a [Receiver; BLOCK], &'a [f32; BLOCK]);
    impl Kernel for Pick<'_> {
        type Output = Vec<(u32, u32, f32, f32)>;

        #[inline(always)]
        fn run<F: Float>(self) -> Self::Output {
            let mut all = vec![];
            for first in (0..BLOCK).step_by(F::WIDTH) {
                let at = Receiver {
                    p: Vec3::from_fn(|i| self.1[first + i].p),
                    n: Vec3::from_fn(|i| self.1[first + i].n),
                };
                let u = F::from_fn(|i| self.2[first + i]);
                let Picks { index, pmf, rest, part, .. } = self.0.picks(u, &at, Within::WORLD);
                for i in 0..F::WIDTH {
                    let (pmf, rest) = (pmf.lane(i), rest.lane(i));
                    let number = |n: u32| if pmf > 0.0 { n } else { 0 };
                    all.push((
                        number(index.lane(i)),
                        number(part.lane(i)),
                        pmf,
                        if pmf > 0.0 { rest } else { 0.0 },
                    ));
                }
            }
            all
        }
    }
    let (geometry, emitters) = street(100);
    let table = LightTable::new(&emitters, &geometry, 20.0);
    let mut rng = Rng(44);
    for _ in 0..20 {
        let at = std::array::from_fn(|i| receiver(&mut rng, i));
        let u = std::array::from_fn(|_| rng.f());
        let plain = Simd::PLAIN.run(Pick(&table, &at, &u));
        for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
            assert_eq!(simd.run(Pick(&table, &at, &u)), plain, "{simd:?}");
        }
    }
}

/// Of light without anything in its way, less noise than by power; the same mean.
#[test]
fn a_tree_has_less_noise_than_power() {
    let (geometry, mut emitters) = street(300);
    emitters.truncate(emitters.len() - 2);
    let table = LightTable::new(&emitters, &geometry, 20.0);
    let mut rng = Rng(45);
    let (mut logs, mut lit) = (0.0, 0.0);
    for i in 0..8 {
        let at = Receiver { p: receiver(&mut rng, i).p, n: rng.direction() };
        let brought = |s: Option<LightSample>| {
            s.map_or(0.0, |s| f64::from(s.radiance[1] * ops::max(s.wi.dot(at.n), 0.0) / s.pdf))
        };
        let splits = |index: u32| table.splits(index);
        let by_tree = monte_carlo(1, 4000, |[u, v]| {
            let Some(pick) = table.pick(u, &at, Within::WORLD) else { return 0.0 };
            let reading = in_rgb();
            let part = splits(pick.index).then_some(pick.part);
            let light = &emitters[pick.index as usize];
            let s = light.sample_parts::<f32, _>(
                &geometry,
                (&at, [pick.rest, v]),
                part,
                &Readings::one(&reading),
            );
            brought((s.pdf > 0.0).then_some(s)) / f64::from(pick.pmf)
        });
        let by_power = monte_carlo(2, 20_000, |[u, v]| {
            let Some(pick) = table.pick_by_power(u, Within::WORLD) else { return 0.0 };
            let s = emitters[pick.index as usize].sample(&geometry, &at, [pick.rest, v], &in_rgb());
            brought(s) / f64::from(pick.pmf)
        });
        let error = (by_tree.1 * by_tree.1 + by_power.1 * by_power.1).sqrt();
        assert!((by_tree.0 - by_power.0).abs() < 4.5 * error, "{by_tree:?} {by_power:?}");
        // Errors of 4000 and 20,000 samples.
        if by_power.1 > 0.0 && by_tree.1 > 0.0 {
            logs += ops::ln_d(by_tree.1 * 4000.0_f64.sqrt() / (by_power.1 * 20_000.0_f64.sqrt()));
            lit += 1.0;
        }
    }
    assert!(lit > 4.0 && logs / lit < 0.0, "{logs} {lit}");
}

#[test]
fn however_lamps_stand_a_tree_is_made() {
    let point = |p: Vec3, i: f32| {
        Emitter::Point(PointLight { position: p, intensity: Light::rgb([i; 3]).into(), falls: true })
    };
    let here = Receiver::anywhere(Vec3::new(0.5, 0.5, 2.0));
    for place in
        [|_: u32| Vec3::ZERO, |i: u32| Vec3::X * i as f32, |i: u32| Vec3::splat(ops::exp2(i as f32 % 100.0))]
    {
        let emitters: Vec<Emitter> = (0..200).map(|i| point(place(i), 1.0)).collect();
        let table = LightTable::new(&emitters, &Geometry::default(), 1.0);
        let total: f32 = (0..200).map(|i| table.pmf(i, &here)).sum();
        assert!((total - 1.0).abs() < 1e-3, "{total}");
    }
    let strange: Vec<Emitter> = [f32::NAN, 0.0, f32::INFINITY, -1.0]
        .into_iter()
        .cycle()
        .take(40)
        .map(|i| point(Vec3::ONE, i))
        .collect();
    assert_eq!(LightTable::new(&strange, &Geometry::default(), 1.0).pick(0.5, &here, Within::WORLD), None);
}
