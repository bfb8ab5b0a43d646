//! Eight lanes of AVX2.
//!
//! Every lane does the operations of `slab.rs` and `triangle.rs` in their order: none is fused.
//!
//! Safety: an [`Avx2`] is made only where the processor has AVX2, BMI1 and BMI2, which all functions here need.

use super::{Children, Kernel, Lanes, entry::entry_points};
use crate::{
    bvh::{Block, Node},
    local::LocalRay,
    slab::EXIT,
};
use std::arch::x86_64::*;

/// The proof that the processor has AVX2.
#[derive(Clone, Copy)]
pub(crate) struct Avx2(());

impl Avx2 {
    pub fn new() -> Option<Self> {
        crate::Isa::Avx2.is_available().then_some(Self(()))
    }
}

impl Kernel for Avx2 {
    #[inline(always)]
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children {
        let mut out = Children::NONE;
        // SAFETY: see the head of the file. Eight numbers are written to an array of eight.
        unsafe {
            let [x, y, z] = r.neg.map(usize::from);
            let enter = _mm256_max_ps(plane(r, node, 0, x), plane(r, node, 1, y));
            let enter = _mm256_max_ps(enter, plane(r, node, 2, z));
            let enter = _mm256_max_ps(enter, _mm256_set1_ps(r.ray.t_min));
            let exit = _mm256_min_ps(plane(r, node, 0, x ^ 1), plane(r, node, 1, y ^ 1));
            let exit = _mm256_min_ps(exit, plane(r, node, 2, z ^ 1));
            let exit = _mm256_min_ps(_mm256_mul_ps(exit, _mm256_set1_ps(EXIT)), _mm256_set1_ps(limit));
            out.mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, exit)) as u32;
            let bits = _mm256_castps_si256(_mm256_max_ps(enter, _mm256_setzero_ps()));
            let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let keys = _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(7), bits), lanes);
            _mm256_storeu_si256((&raw mut out.keys).cast(), keys);
        }
        out
    }

    #[inline(always)]
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes {
        // SAFETY: `self` is the proof that the processor has AVX2.
        unsafe { block_avx2(r, block, limit) }
    }

    #[inline(always)]
    fn prefetch<T>(self, what: &T) {
        super::prefetch(what);
    }

    entry_points!("avx2,bmi1,bmi2,lzcnt,popcnt");
}

/// Where the ray crosses a plane of each box.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn plane(r: &LocalRay, node: &Node, axis: usize, side: usize) -> __m256 {
    // SAFETY: the caller's promise; eight numbers are read from an array of eight.
    unsafe {
        let b = _mm256_loadu_ps(node.planes[2 * axis + (side & 1)].as_ptr());
        _mm256_mul_ps(_mm256_sub_ps(b, _mm256_set1_ps(r.ray.o[axis])), _mm256_set1_ps(r.inv[axis]))
    }
}

/// A vertex of each triangle, moved to the ray's origin and sheared.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn sheared(r: &LocalRay, vertex: &[[f32; 8]; 3]) -> [__m256; 3] {
    // SAFETY: the caller's promise; eight numbers are read from arrays of eight.
    unsafe {
        let [x, y, z] = r.axes.map(usize::from);
        let x = _mm256_loadu_ps(vertex[x % 3].as_ptr());
        let y = _mm256_loadu_ps(vertex[y % 3].as_ptr());
        let z = _mm256_loadu_ps(vertex[z % 3].as_ptr());
        let x = _mm256_sub_ps(x, _mm256_set1_ps(r.origin[0]));
        let y = _mm256_sub_ps(y, _mm256_set1_ps(r.origin[1]));
        let z = _mm256_sub_ps(z, _mm256_set1_ps(r.origin[2]));
        let x = _mm256_sub_ps(x, _mm256_mul_ps(_mm256_set1_ps(r.shear[0]), z));
        let y = _mm256_sub_ps(y, _mm256_mul_ps(_mm256_set1_ps(r.shear[1]), z));
        [x, y, z]
    }
}

/// Edge functions of the edges from `q` to `p`.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn edge(p: &[__m256; 3], q: &[__m256; 3]) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm256_sub_ps(_mm256_mul_ps(p[0], q[1]), _mm256_mul_ps(p[1], q[0])) }
}

/// [`Kernel::block`], also for AVX-512: blocks have eight triangles.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn block_avx2(r: &LocalRay, block: &Block, limit: f32) -> Lanes {
    let mut out = Lanes::NONE;
    // SAFETY: the caller's promise; eight numbers are written to arrays of eight.
    unsafe {
        let (a, b, c) = (sheared(r, &block.v[0]), sheared(r, &block.v[1]), sheared(r, &block.v[2]));
        let (u, v, w) = (edge(&c, &b), edge(&a, &c), edge(&b, &a));
        let least = _mm256_min_ps(u, _mm256_min_ps(v, w));
        let most = _mm256_max_ps(u, _mm256_max_ps(v, w));
        let zero = _mm256_setzero_ps();
        let positive = _mm256_cmp_ps::<_CMP_GE_OQ>(least, zero);
        let negative = _mm256_cmp_ps::<_CMP_LE_OQ>(most, zero);
        let inside = _mm256_movemask_ps(_mm256_or_ps(positive, negative)) as u32;
        if inside == 0 {
            return out;
        }
        let on_edge = _mm256_cmp_ps::<_CMP_EQ_OQ>(least, zero);
        let on_edge = _mm256_or_ps(on_edge, _mm256_cmp_ps::<_CMP_EQ_OQ>(most, zero));
        out.zero = _mm256_movemask_ps(on_edge) as u32;
        let det = _mm256_add_ps(_mm256_add_ps(u, v), w);
        let depth = _mm256_add_ps(_mm256_mul_ps(u, a[2]), _mm256_mul_ps(v, b[2]));
        let depth = _mm256_add_ps(depth, _mm256_mul_ps(w, c[2]));
        let t = _mm256_div_ps(_mm256_mul_ps(depth, _mm256_set1_ps(r.shear[2])), det);
        let late = _mm256_cmp_ps::<_CMP_GE_OQ>(t, _mm256_set1_ps(r.ray.t_min));
        let early = _mm256_cmp_ps::<_CMP_LE_OQ>(t, _mm256_set1_ps(limit));
        out.hit = _mm256_movemask_ps(_mm256_and_ps(late, early)) as u32 & inside & !out.zero;
        if out.hit != 0 {
            _mm256_storeu_ps(out.t.as_mut_ptr(), t);
            _mm256_storeu_ps(out.det.as_mut_ptr(), det);
            _mm256_storeu_ps(out.e1.as_mut_ptr(), v);
            _mm256_storeu_ps(out.e2.as_mut_ptr(), w);
        }
        out
    }
}
