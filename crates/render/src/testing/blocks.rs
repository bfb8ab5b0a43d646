//! Vertices of one material side by side, as a path tracer shades them; for benches, which see no more of a crate than its users.

use crate::material::many::{Among, OfKind, WithKind};
use crate::material::{Bsdf, Transport};
use std::marker::PhantomData;
use straal_math::Vec3;
use straal_math::simd::{BLOCK, Float, Kernel, Simd};

/// As many vertices as stand in the widest vectors, of one BSDF; their directions, and numbers to draw others by.
#[derive(Debug)]
pub struct Shaded<'w> {
    bsdf: [Bsdf<'w>; 1],
    /// The coordinates of `wo` and of `wi`, and numbers in [0, 1).
    columns: [[f32; BLOCK]; 9],
    /// What was reckoned of each.
    sums: [f32; BLOCK],
}

impl<'w> Shaded<'w> {
    /// With unit directions on the side of the normal, and numbers in [0, 1), for each vertex.
    pub fn new(bsdf: Bsdf<'w>, vertex: impl Fn(usize) -> ([Vec3; 2], [f32; 3])) -> Self {
        let mut columns = [[0.0; BLOCK]; 9];
        for i in 0..BLOCK {
            let ([wo, wi], u) = vertex(i);
            let numbers = [wo.x, wo.y, wo.z, wi.x, wi.y, wi.z, u[0], u[1], u[2]];
            for (column, x) in columns.iter_mut().zip(numbers) {
                column[i] = x;
            }
        }
        Self { bsdf: [bsdf], columns, sums: [0.0; BLOCK] }
    }

    /// What a step asks of a BSDF: its value for one pair of directions, and another direction. Gives a number that all of it went into.
    pub fn step(&mut self, simd: Simd) -> f32 {
        let kind = self.bsdf[0].kind();
        kind.hand_to(Ask { simd, block: self });
        self.sums.iter().sum()
    }
}

struct Ask<'a, 'w> {
    simd: Simd,
    block: &'a mut Shaded<'w>,
}

impl<'w> WithKind<'w> for Ask<'_, 'w> {
    fn with<K: OfKind<'w>>(self) {
        self.simd.run(AskOf::<K> { block: self.block, kind: PhantomData });
    }
}

struct AskOf<'a, 'w, K> {
    block: &'a mut Shaded<'w>,
    kind: PhantomData<K>,
}

impl<'w, K: OfKind<'w>> Kernel for AskOf<'_, 'w, K> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Shaded { bsdf, columns, sums } = self.block;
        let which = [0; BLOCK];
        let mut first = 0;
        while first < BLOCK {
            let Some(these) = Among::<K>::new(bsdf, &which[first..], &bsdf[0]) else { return };
            let [a, b, c, d, e, f, u, v, w] = &*columns;
            let load = |column: &[f32; BLOCK]| F::load(&column[first..]);
            let (wo, wi) = (Vec3::new(load(a), load(b), load(c)), Vec3::new(load(d), load(e), load(f)));
            let (value, pdf) = K::eval_pdf_many(these, [wo, wi], Transport::Radiance);
            let (s, there) = K::sample_many(these, wo, [load(u), load(v), load(w)], Transport::Radiance);
            let all = value.max_lane() + pdf + s.weight.max_lane() + s.pdf + s.wi.x + s.wi.y + s.wi.z;
            F::select(there & all.is_finite(), all, pdf).store(&mut sums[first..]);
            first += F::WIDTH;
        }
    }
}
