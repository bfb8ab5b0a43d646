//! Sixteen lanes of AVX-512 for boxes: near planes in the lower eight, far planes negated in the upper, so that one
//! maximum serves both. Triangles, eight in a block, go by AVX2.
//!
//! Safety: an [`Avx512`] is made only where the processor has AVX-512 F, DQ and VL, and all that AVX2 needs.

use super::{Children, Kernel, Lanes, avx2::block_avx2, entry::entry_points};
use crate::{
    bvh::{Block, Node},
    local::LocalRay,
    slab::EXIT,
};
use std::arch::x86_64::*;

/// The proof that the processor has AVX-512.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(());

impl Avx512 {
    pub fn new() -> Option<Self> {
        crate::Isa::Avx512.is_available().then_some(Self(()))
    }
}

/// The upper eight lanes.
const UPPER: u16 = 0xff00;

impl Kernel for Avx512 {
    #[inline(always)]
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children {
        let mut out = Children::NONE;
        // SAFETY: see the head of the file. Eight numbers are written to an array of eight.
        unsafe {
            let both = _mm512_max_ps(crossing(r, node, 0), crossing(r, node, 1));
            let both = _mm512_max_ps(both, crossing(r, node, 2));
            let both = _mm512_mul_ps(both, halves(1.0, EXIT));
            let both = _mm512_max_ps(both, halves(r.ray.t_min, -limit));
            let enter = _mm512_castps512_ps256(both);
            let exit = _mm256_xor_ps(_mm512_extractf32x8_ps::<1>(both), _mm256_set1_ps(-0.0));
            out.mask = u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, exit));
            let bits = _mm256_castps_si256(_mm256_max_ps(enter, _mm256_setzero_ps()));
            let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let keys = _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(7), bits), lanes);
            _mm256_storeu_si256((&raw mut out.keys).cast(), keys);
        }
        out
    }

    #[inline(always)]
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes {
        // SAFETY: an `Avx512` is made only where there is AVX2 too.
        unsafe { block_avx2(r, block, limit) }
    }

    #[inline(always)]
    fn prefetch<T>(self, what: &T) {
        super::prefetch(what);
    }

    entry_points!("avx512f,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt");
}

/// Where the ray crosses the near and, negated, the far plane of each box.
///
/// # Safety
/// The processor must have AVX-512 F and DQ.
#[inline(always)]
unsafe fn crossing(r: &LocalRay, node: &Node, axis: usize) -> __m512 {
    // SAFETY: the caller's promise; eight numbers are read from arrays of eight.
    unsafe {
        let side = usize::from(r.neg[axis]);
        let near = _mm256_loadu_ps(node.planes[2 * axis + (side & 1)].as_ptr());
        let far = _mm256_loadu_ps(node.planes[2 * axis + (side & 1 ^ 1)].as_ptr());
        let both = _mm512_insertf32x8::<1>(_mm512_castps256_ps512(near), far);
        let inv = halves(r.inv[axis], -r.inv[axis]);
        _mm512_mul_ps(_mm512_sub_ps(both, _mm512_set1_ps(r.ray.o[axis])), inv)
    }
}

/// One number in the lower, another in the upper lanes.
///
/// # Safety
/// The processor must have AVX-512 F.
#[inline(always)]
unsafe fn halves(lower: f32, upper: f32) -> __m512 {
    // SAFETY: the caller's promise.
    unsafe { _mm512_mask_mov_ps(_mm512_set1_ps(lower), UPPER, _mm512_set1_ps(upper)) }
}
