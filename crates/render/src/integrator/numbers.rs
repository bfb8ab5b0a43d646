//! Random numbers of a block of vertices, drawn side by side.

use straal_math::lowdisc::{Pattern, Purpose, SampleName};
use straal_math::simd::{Float, Kernel, Simd, Uint};

pub(super) use crate::surface::BLOCK;

/// A number for each vertex.
#[derive(Default)]
#[repr(align(64))]
struct Column([f32; BLOCK]);

/// What is drawn for each vertex of a block. Numbers that weren't wanted are left over from another block.
#[derive(Default)]
pub(super) struct Numbers {
    light: [Column; 2],
    direction: [Column; 3],
    roulette: Column,
    /// The nodes to which the paths go on, and the samples' places at the nodes where they are.
    next: [[u32; BLOCK]; 2],
}

/// What any vertex of a block needs; as numbers are pure functions of their names, those drawn for nothing change none.
#[derive(Clone, Copy, Default)]
pub(super) struct Wanted {
    /// [`Numbers::light`].
    pub light: bool,
    /// [`Numbers::direction`].
    pub direction: bool,
    /// The third of them.
    pub lobe: bool,
    /// [`Numbers::roulette`].
    pub roulette: bool,
}

impl Numbers {
    /// Draws for vertices with these names.
    #[inline]
    pub fn draw(&mut self, simd: Simd, pattern: Pattern, names: &[SampleName], wanted: Wanted) {
        simd.run(Draw { pattern, names, wanted, numbers: self });
    }

    /// The name of the next vertex of path `i`, whose name was `name`.
    #[inline(always)]
    pub fn next(&self, i: usize, name: &SampleName) -> SampleName {
        name.onward(self.next[0][i], self.next[1][i])
    }

    /// Choose lights and points on them, from vertex `first` on.
    #[inline(always)]
    pub fn light<F: Float>(&self, first: usize) -> [F; 2] {
        [F::load(&self.light[0].0[first..]), F::load(&self.light[1].0[first..])]
    }

    /// Choose the directions in which the paths go on, from vertex `first` on: a lobe, and where in it.
    #[inline(always)]
    pub fn direction<F: Float>(&self, first: usize) -> [F; 3] {
        let [u, v, lobe] = &self.direction;
        [F::load(&lobe.0[first..]), F::load(&u.0[first..]), F::load(&v.0[first..])]
    }

    /// Whether the paths from vertex `first` on go on.
    #[inline(always)]
    pub fn roulette<F: Float>(&self, first: usize) -> F {
        F::load(&self.roulette.0[first..])
    }
}

struct Draw<'a> {
    pattern: Pattern,
    names: &'a [SampleName],
    wanted: Wanted,
    numbers: &'a mut Numbers,
}

impl Kernel for Draw<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { pattern, names, wanted, numbers } = self;
        let last = names.len().saturating_sub(1);
        for first in (0..names.len().min(BLOCK)).step_by(F::WIDTH) {
            // Lanes without a vertex do what the last one does.
            let name = SampleName::<F>::from_fn(
                #[inline(always)]
                |lane| names[if first + lane < last { first + lane } else { last }],
            );
            for (to, from) in numbers.next.iter_mut().zip([name.child(0).node(), name.place()]) {
                to[first..first + F::WIDTH].copy_from_slice(from.to_array().as_ref());
            }
            if wanted.light {
                store(pattern.d2(&name, Purpose::LightPoint), &mut numbers.light, first);
            }
            if wanted.direction {
                let drawn = if wanted.lobe {
                    pattern.d3(&name, Purpose::Direction)
                } else {
                    let [u, v] = pattern.d2(&name, Purpose::Direction);
                    [u, v, F::ZERO]
                };
                store(drawn, &mut numbers.direction, first);
            }
            if wanted.roulette {
                store(
                    [pattern.d1(&name, Purpose::Roulette)],
                    std::array::from_mut(&mut numbers.roulette),
                    first,
                );
            }
        }
    }
}

#[inline(always)]
fn store<F: Float, const D: usize>(drawn: [F; D], columns: &mut [Column; D], first: usize) {
    for (d, column) in columns.iter_mut().enumerate() {
        drawn[d].store(&mut column.0[first..]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::simd::Isa;

    #[test]
    fn a_vertex_draws_the_same_whatever_stands_beside_it() {
        let names: Vec<_> =
            (0..BLOCK as u32).map(|i| SampleName::new(7, [i % 5, i], i * i).child(i)).collect();
        for (isa, pattern) in Isa::ALL
            .into_iter()
            .flat_map(|isa| [Pattern::Sobol, Pattern::Random, Pattern::Halton].map(|pattern| (isa, pattern)))
        {
            let Some(simd) = Simd::new(isa) else { continue };
            for count in [1, 7, 16, 17, 31, 32] {
                let mut numbers = Numbers::default();
                let wanted = Wanted { light: true, direction: true, lobe: count % 2 == 1, roulette: true };
                numbers.draw(simd, pattern, &names[..count], wanted);
                for (i, name) in names[..count].iter().enumerate() {
                    assert_eq!(numbers.next(i, name), name.child(0), "{isa}");
                    let [lobe, u, v] = numbers.direction::<f32>(i);
                    assert_eq!(
                        numbers.light::<f32>(i),
                        pattern.d2(name, Purpose::LightPoint),
                        "{isa} {pattern:?}"
                    );
                    assert_eq!([u, v], pattern.d2(name, Purpose::Direction), "{isa} {pattern:?}");
                    assert_eq!(
                        numbers.roulette::<f32>(i),
                        pattern.d1(name, Purpose::Roulette),
                        "{isa} {pattern:?}"
                    );
                    if wanted.lobe {
                        assert_eq!(lobe, pattern.d3(name, Purpose::Direction)[2], "{isa} {pattern:?}");
                    }
                }
            }
        }
    }
}
