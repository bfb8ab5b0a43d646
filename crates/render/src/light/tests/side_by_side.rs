//! Lights at many places side by side give what they give at each.

use super::*;
use crate::light::table::Picks;
use straal_math::simd::{BLOCK, Isa, Kernel, Simd, Uint};

/// As many as two vectors of the widest set.
const COUNT: usize = 2 * BLOCK;

/// Places near and far, of known normal and not, some of them within shapes.
fn places(seed: u64) -> ([Receiver; COUNT], [[f32; 2]; COUNT]) {
    let mut rng = Rng(seed);
    let places = std::array::from_fn(|i| {
        let n = if i % 3 == 0 { Vec3::ZERO } else { rng.direction() };
        Receiver { p: rng.cube() * if i % 4 == 0 { 0.2 } else { 4.0 }, n }
    });
    (places, std::array::from_fn(|_| rng.square()))
}

fn lanes<F: Float>(at: &[Receiver], u: &[[f32; 2]]) -> (Receiver<F>, [F; 2]) {
    let at = Receiver { p: Vec3::from_fn(|i| at[i].p), n: Vec3::from_fn(|i| at[i].n) };
    (at, [0, 1].map(|k| F::from_fn(|i| u[i][k])))
}

struct Samples<'a>(&'a Example, &'a [Receiver; COUNT], &'a [[f32; 2]; COUNT]);

impl Kernel for Samples<'_> {
    type Output = Vec<(Option<LightSample>, (Light, f32))>;

    #[inline(always)]
    fn run<F: Float>(self) -> Self::Output {
        let Self(example, at, u) = self;
        let reading = in_rgb();
        let lanes_of = [reading.lanes; COUNT];
        let readings =
            Readings { tables: reading.tables, textures: reading.textures, meshes: &[], lanes: &lanes_of };
        let mut all = vec![];
        for first in (0..COUNT).step_by(F::WIDTH) {
            let (at, u) = lanes::<F>(&at[first..], &u[first..]);
            let s = example.emitter.sample_many(&example.geometry, &at, u, &readings);
            let (radiance, pdf) = example.emitter.radiance_pdf_from_many(&at, s.wi, &readings);
            let (mut light, mut seen) = ([Light::ZERO; BLOCK], [Light::ZERO; BLOCK]);
            s.radiance.for_each(|i, l| light[i] = l);
            radiance.for_each(|i, l| seen[i] = l);
            for i in 0..F::WIDTH {
                let to = End { p: s.to.p.lane(i), p_err: s.to.p_err.lane(i), ng: s.to.ng.lane(i) };
                let one = LightSample {
                    wi: s.wi.lane(i),
                    radiance: light[i],
                    pdf: s.pdf.lane(i),
                    delta: s.delta.lane(i),
                    far: s.far.lane(i),
                    to,
                };
                all.push((one.of_value(), (seen[i], pdf.lane(i))));
            }
        }
        all
    }
}

#[test]
fn points_on_lights_are_those_of_one_after_the_other() {
    for (name, examples) in super::super::registry() {
        for (k, e) in examples.iter().enumerate() {
            let (at, u) = places(k as u64 + 5);
            for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
                let all = simd.run(Samples(e, &at, &u));
                for (i, (sample, seen)) in all.into_iter().enumerate() {
                    let one = e.emitter.sample(&e.geometry, &at[i], u[i], &in_rgb());
                    assert_eq!(sample, one, "{name}, {}, {simd:?}", e.name);
                    let Some(one) = one else { continue };
                    let looked_up = e.emitter.radiance_pdf_from(&at[i], one.wi, &in_rgb());
                    assert_eq!(seen, looked_up, "{name}, {}, {simd:?}", e.name);
                }
            }
        }
    }
}

struct Choices<'a>(&'a LightTable, &'a [Receiver; COUNT], &'a [[f32; 2]; COUNT]);

impl Kernel for Choices<'_> {
    type Output = Vec<(u32, [f32; 4])>;

    #[inline(always)]
    fn run<F: Float>(self) -> Self::Output {
        let mut all = vec![];
        for first in (0..COUNT).step_by(F::WIDTH) {
            let (at, u) = lanes::<F>(&self.1[first..], &self.2[first..]);
            let Picks { index, pmf, rest, .. } = self.0.picks(u[0], &at, Within::WORLD);
            let told = [0, 1].map(|emitter| self.0.pmfs(emitter, &at));
            for i in 0..F::WIDTH {
                let numbers = [pmf.lane(i), rest.lane(i), told[0].lane(i), told[1].lane(i)];
                all.push((index.lane(i), numbers));
            }
        }
        all
    }
}

/// Of one light, of few, of more, and of many.
#[test]
fn lights_are_chosen_as_one_after_the_other() {
    let all: Vec<Emitter> = super::super::registry()
        .into_iter()
        .flat_map(|(_, examples)| examples)
        .filter(|e| e.geometry.shapes.is_empty() && e.geometry.meshes.is_empty())
        .map(|e| e.emitter)
        .collect();
    for count in [1, 3, 7, 40] {
        let emitters: Vec<Emitter> = all.iter().cycle().take(count).cloned().collect();
        let table = LightTable::new(&emitters, &Geometry::default(), 10.0);
        let (at, u) = places(count as u64);
        let plain = Simd::PLAIN.run(Choices(&table, &at, &u));
        for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
            assert_eq!(simd.run(Choices(&table, &at, &u)), plain, "{count}, {simd:?}");
        }
        for (i, (index, [pmf, rest, ..])) in plain.into_iter().enumerate() {
            let pick = table.pick(u[i][0], &at[i], Within::WORLD);
            assert_eq!(pick.map(|p| (p.index, p.pmf, p.rest)), (pmf > 0.0).then_some((index, pmf, rest)));
            assert!(pick.is_none_or(|p| table.pmf(p.index, &at[i]) == p.pmf));
        }
    }
}
