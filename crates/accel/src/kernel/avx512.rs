//! AVX-512 in vectors of eight lanes: masks, and lanes packed by a mask, in place of tables. Its sixteen lanes (near planes
//! in the lower half, far ones negated in the upper) take as long where the processor runs them in two halves, as Zen 4
//! does.
//!
//! Safety: an [`Avx512`] is made only where the processor has AVX-512 F, DQ and VL, and all that AVX2 needs.

use super::{
    Children, Kernel, Lanes, NOT_ENTERED,
    avx2::{block_avx2, inside_avx2, interval, keys, least, push_sorted},
    descent::Descent,
    entry::entry_points,
};
use crate::{
    bvh::{Block, Child, Node},
    local::LocalRay,
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

impl Kernel for Avx512 {
    #[inline(always)]
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children {
        let mut out = Children::NONE;
        // SAFETY: see the head of the file. Eight numbers are written to an array of eight.
        unsafe {
            let (enter, exit) = interval(r, node, limit);
            let entered = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, exit);
            out.mask = u32::from(entered);
            let none = _mm256_set1_epi32(NOT_ENTERED as i32);
            _mm256_storeu_si256(
                (&raw mut out.keys).cast(),
                _mm256_mask_mov_epi32(none, entered, keys(enter)),
            );
        }
        out
    }

    #[inline(always)]
    fn entered(self, r: &LocalRay, node: &Node) -> u32 {
        // SAFETY: see the head of the file.
        unsafe {
            let (enter, exit) = interval(r, node, r.leave);
            u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, exit))
        }
    }

    #[inline(always)]
    fn descend(self, node: &Node, found: &Children, stack: &mut Descent) -> Child {
        // SAFETY: see the head of the file. Eight numbers are read from an array of eight.
        unsafe {
            let keys = _mm256_loadu_si256((&raw const found.keys).cast());
            descend_to(node, least(keys) & 7, found.mask as __mmask8, keys, stack)
        }
    }

    #[inline(always)]
    fn descend_any(self, node: &Node, mask: u32, stack: &mut Descent) -> Child {
        // SAFETY: see the head of the file.
        unsafe {
            let first = mask.trailing_zeros() & 7;
            descend_to(node, first, mask as __mmask8, _mm256_setzero_si256(), stack)
        }
    }

    #[inline(always)]
    fn push_sorted(self, node: &Node, found: &Children, stack: &mut Descent) {
        // SAFETY: an `Avx512` is made only where there is AVX2 too.
        unsafe { push_sorted(node, found, stack) }
    }

    #[inline(always)]
    fn inside(self, r: &LocalRay, block: &Block) -> u32 {
        // SAFETY: an `Avx512` is made only where there is AVX2 too.
        unsafe { inside_avx2(r, block) }
    }

    #[inline(always)]
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes {
        // SAFETY: an `Avx512` is made only where there is AVX2 too.
        unsafe { block_avx2(r, block, limit) }
    }

    #[inline(always)]
    fn prefetch(self, nodes: &[Node], blocks: &[Block], child: Child) {
        super::prefetch(nodes, blocks, child);
    }

    entry_points!("avx512f,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt");
}

/// Steps down to the child in slot `first`, if `entered` has it, and pushes the others that it has.
///
/// # Safety
/// The processor must have AVX-512 F and VL.
#[inline(always)]
unsafe fn descend_to(
    node: &Node,
    first: u32,
    entered: __mmask8,
    keys: __m256i,
    stack: &mut Descent,
) -> Child {
    let others = entered & !(1 << first);
    let any = (usize::from(entered) + 255) >> 8;
    let chosen = node.children[(first & 7) as usize];
    // SAFETY: the caller's promise; eight numbers are read from an array of eight, and eight of each stored, of which the
    // first are the others.
    unsafe {
        let children = _mm256_loadu_si256(node.children.as_ptr().cast());
        let children = _mm256_maskz_compress_epi32(others, children);
        let keys = _mm256_maskz_compress_epi32(others, keys);
        stack.descend(any, chosen, others.count_ones() as usize, |k: *mut u32, c: *mut u32| {
            _mm256_storeu_si256(k.cast(), keys);
            _mm256_storeu_si256(c.cast(), children);
        })
    }
}
