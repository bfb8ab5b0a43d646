//! Four lanes of SSE4.2, twice.
//!
//! Every lane does the operations of `slab.rs` and `triangle.rs` in their order.
//!
//! Safety: an [`Sse`] is made only where the processor has SSE4.2.

use super::{Children, Kernel, Lanes, NOT_ENTERED, entry::entry_points, lines::Lines};
use crate::{
    local::LocalRay,
    node::{Block, Child, Node},
    triangle::{FLAT, LEAST_DETERMINANT},
};
use std::arch::x86_64::*;

/// The proof that the processor has SSE4.2.
#[derive(Clone, Copy)]
pub(crate) struct Sse(());

impl Sse {
    pub fn new() -> Option<Self> {
        crate::Isa::Sse.is_available().then_some(Self(()))
    }
}

impl Kernel for Sse {
    #[inline(always)]
    fn chosen(self) -> super::Chosen {
        super::Chosen::Sse(self)
    }

    #[inline(always)]
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children {
        let mut out = Children::NONE;
        for half in [0, 4] {
            // SAFETY: see the head of the file. `half` is at most 4, so that four numbers from there are inside.
            unsafe {
                let [x, y, z] = r.neg.map(|n| usize::from(n & 1));
                let near = |axis, side| _mm_mul_ps(from(r, node, axis, side, half), _mm_set1_ps(r.inv[axis]));
                let far =
                    |axis, side| _mm_mul_ps(from(r, node, axis, side ^ 1, half), _mm_set1_ps(r.far[axis]));
                let enter = _mm_max_ps(_mm_max_ps(near(0, x), near(1, y)), near(2, z));
                let enter = _mm_max_ps(enter, _mm_set1_ps(r.ray.t_min));
                let exit = earliest(earliest(far(0, x), far(1, y)), far(2, z));
                let exit = earliest(exit, _mm_set1_ps(limit));
                let entered = _mm_cmple_ps(enter, exit);
                out.mask |= (_mm_movemask_ps(entered) as u32) << half;
                let bits = _mm_castps_si128(enter);
                let lanes = _mm_add_epi32(_mm_setr_epi32(0, 1, 2, 3), _mm_set1_epi32(half as i32));
                let key = _mm_or_si128(_mm_andnot_si128(_mm_set1_epi32(7), bits), lanes);
                let none = _mm_set1_epi32(NOT_ENTERED as i32);
                let key = _mm_blendv_epi8(none, key, _mm_castps_si128(entered));
                _mm_storeu_si128(out.keys.as_mut_ptr().add(half).cast(), key);
            }
        }
        out
    }

    #[inline(always)]
    fn entered(self, r: &LocalRay, node: &Node, limit: f32) -> u32 {
        self.node(r, node, limit).mask
    }

    #[inline(always)]
    fn inside(self, r: &LocalRay, block: &Block) -> u32 {
        let mut out = 0;
        for half in [0, 4] {
            // SAFETY: see the head of the file. `half` is at most 4, so that four numbers from there are inside.
            unsafe {
                let [a, b, c] = moved(r, block, half);
                let (a, b, c) = (sheared(r, &a), sheared(r, &b), sheared(r, &c));
                let (u, v, w) = (edge(&c, &b), edge(&a, &c), edge(&b, &a));
                let least = _mm_min_ps(u, _mm_min_ps(v, w));
                let most = _mm_max_ps(u, _mm_max_ps(v, w));
                let zero = _mm_setzero_ps();
                let inside = _mm_or_ps(_mm_cmpge_ps(least, zero), _mm_cmple_ps(most, zero));
                out |= (_mm_movemask_ps(inside) as u32) << half;
            }
        }
        out & block.lanes()
    }

    #[inline(always)]
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes {
        let mut out = Lanes::NONE;
        for half in [0, 4] {
            // SAFETY: see the head of the file. `half` is at most 4, so that four numbers from there are inside.
            unsafe {
                let moved @ [a, b, c] = moved(r, block, half);
                let (a, b, c) = (sheared(r, &a), sheared(r, &b), sheared(r, &c));
                let (u, v, w) = (edge(&c, &b), edge(&a, &c), edge(&b, &a));
                let least = _mm_min_ps(u, _mm_min_ps(v, w));
                let most = _mm_max_ps(u, _mm_max_ps(v, w));
                let zero = _mm_setzero_ps();
                let inside = _mm_or_ps(_mm_cmpge_ps(least, zero), _mm_cmple_ps(most, zero));
                let inside = _mm_movemask_ps(inside) as u32 & block.lanes() >> half;
                if inside == 0 {
                    continue;
                }
                let on_edge = _mm_or_ps(_mm_cmpeq_ps(least, zero), _mm_cmpeq_ps(most, zero));
                let det = _mm_add_ps(_mm_add_ps(u, v), w);
                let size = |x| _mm_andnot_ps(_mm_set1_ps(-0.0), x);
                let reach = _mm_max_ps(size(a[0]), size(a[1]));
                let reach = _mm_max_ps(reach, _mm_max_ps(size(b[0]), size(b[1])));
                let reach = _mm_max_ps(reach, _mm_max_ps(size(c[0]), size(c[1])));
                let enough = _mm_mul_ps(_mm_mul_ps(reach, reach), _mm_set1_ps(FLAT));
                let enough = _mm_max_ps(enough, _mm_set1_ps(LEAST_DETERMINANT));
                let depth = _mm_add_ps(_mm_mul_ps(u, a[2]), _mm_mul_ps(v, b[2]));
                let depth = _mm_add_ps(depth, _mm_mul_ps(w, c[2]));
                let numerator = _mm_mul_ps(depth, _mm_set1_ps(r.shear[2]));
                let enough = _mm_add_ps(enough, _mm_mul_ps(_mm_add_ps(numerator, det), zero));
                let flat = _mm_cmpnge_ps(size(det), enough);
                let doubtful = _mm_movemask_ps(_mm_or_ps(on_edge, flat)) as u32 & inside;
                let t = _mm_div_ps(numerator, det);
                let late = _mm_cmpge_ps(t, _mm_set1_ps(r.ray.t_min));
                let within = _mm_and_ps(late, _mm_cmple_ps(t, _mm_set1_ps(limit)));
                let within = _mm_movemask_ps(within) as u32;
                out.doubtful |= doubtful << half;
                out.hit |= (within & inside & !doubtful) << half;
                out.boxed |= boxed(r, &moved, t) << half;
                _mm_storeu_ps(out.t.as_mut_ptr().add(half), t);
                _mm_storeu_ps(out.det.as_mut_ptr().add(half), det);
                _mm_storeu_ps(out.e1.as_mut_ptr().add(half), v);
                _mm_storeu_ps(out.e2.as_mut_ptr().add(half), w);
            }
        }
        out
    }

    #[inline(always)]
    fn prefetch<const HOW: u8>(self, lines: &Lines, child: Child) {
        super::prefetch::prefetch::<HOW>(lines, child);
    }

    entry_points!("sse4.2,popcnt");
}

/// `scalar::earliest` in four lanes.
///
/// # Safety
/// The processor must have SSE4.1.
#[inline(always)]
unsafe fn earliest(a: __m128, b: __m128) -> __m128 {
    // SAFETY: the caller's promise.
    unsafe { _mm_castsi128_ps(_mm_min_epi32(_mm_castps_si128(a), _mm_castps_si128(b))) }
}

/// A plane of four boxes, from the ray's origin.
///
/// # Safety
/// The processor must have SSE4.2, and `half` be at most 4.
#[inline(always)]
unsafe fn from(r: &LocalRay, node: &Node, axis: usize, side: usize, half: usize) -> __m128 {
    // SAFETY: the caller's promise; four numbers are read from within an array of eight.
    unsafe {
        let b = _mm_loadu_ps(node.planes[2 * axis + (side & 1)].as_ptr().add(half));
        _mm_sub_ps(b, _mm_set1_ps(r.ray.o[axis]))
    }
}

/// The vertices of four triangles along the axes of the sheared space, moved to the ray's origin.
///
/// # Safety
/// The processor must have SSE4.2.
#[inline(always)]
unsafe fn moved(r: &LocalRay, block: &Block, half: usize) -> [[__m128; 3]; 3] {
    let [x, y, z] = r.axes();
    let four = [0, 1, 2, 3].map(|lane| block.vertices(half + lane));
    [0, 1, 2].map(|corner: usize| {
        // SAFETY: the caller's promise.
        let along = |axis: usize, origin: f32| unsafe {
            let [a, b, c, d] = four.map(|vertices| vertices[corner][axis]);
            _mm_sub_ps(_mm_setr_ps(a, b, c, d), _mm_set1_ps(origin))
        };
        [along(x, r.origin[0]), along(y, r.origin[1]), along(z, r.origin[2])]
    })
}

/// The same vertex sheared.
///
/// # Safety
/// The processor must have SSE4.2.
#[inline(always)]
unsafe fn sheared(r: &LocalRay, [x, y, z]: &[__m128; 3]) -> [__m128; 3] {
    // SAFETY: the caller's promise.
    unsafe {
        let x = _mm_sub_ps(*x, _mm_mul_ps(_mm_set1_ps(r.shear[0]), *z));
        let y = _mm_sub_ps(*y, _mm_mul_ps(_mm_set1_ps(r.shear[1]), *z));
        [x, y, *z]
    }
}

/// The lanes in which `t` lies in the triangle's own box, see [`Lanes::boxed`], from its moved vertices. Rounding doesn't
/// change an order, so that the first and the last crossing of vertices are those of the box' planes.
///
/// # Safety
/// The processor must have SSE4.2.
#[inline(always)]
unsafe fn boxed(r: &LocalRay, [a, b, c]: &[[__m128; 3]; 3], t: __m128) -> u32 {
    // SAFETY: the caller's promise.
    unsafe {
        let (mut enter, mut exit) = (_mm_set1_ps(f32::NEG_INFINITY), _mm_set1_ps(f32::INFINITY));
        for (i, axis) in r.axes().into_iter().enumerate() {
            let inv = _mm_set1_ps(r.inv[axis]);
            let (a, b, c) = (_mm_mul_ps(a[i], inv), _mm_mul_ps(b[i], inv), _mm_mul_ps(c[i], inv));
            enter = _mm_max_ps(enter, _mm_min_ps(_mm_min_ps(a, b), c));
            exit = _mm_min_ps(exit, _mm_max_ps(_mm_max_ps(a, b), c));
        }
        _mm_movemask_ps(_mm_and_ps(_mm_cmple_ps(enter, t), _mm_cmple_ps(t, exit))) as u32
    }
}

/// Edge functions of the edges from `q` to `p`.
///
/// # Safety
/// The processor must have SSE4.2.
#[inline(always)]
unsafe fn edge(p: &[__m128; 3], q: &[__m128; 3]) -> __m128 {
    // SAFETY: the caller's promise.
    unsafe { _mm_sub_ps(_mm_mul_ps(p[0], q[1]), _mm_mul_ps(p[1], q[0])) }
}
