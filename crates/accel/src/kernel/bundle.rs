//! The tests of `bvh/bundle.rs`, eight lanes of AVX at a time: their operations in their order.

use crate::{
    node::{
        Node, WIDTH,
        bundle::{Bundle, GROUPS, Lanes},
    },
    slab::EXIT,
};
use std::arch::x86_64::*;

/// [`Kernel::entries`](super::Kernel::entries).
///
/// # Safety
/// The processor must have AVX.
#[inline(always)]
pub(super) unsafe fn entries(bundle: &Bundle, node: &Node, limit: f32) -> (u32, Lanes) {
    let mut out = [0.0; WIDTH];
    // SAFETY: the caller's promise; eight numbers are read from, and written to, arrays of eight.
    unsafe {
        let mut enter = _mm256_set1_ps(bundle.first);
        let mut exit = _mm256_set1_ps(f32::INFINITY);
        for (axis, a) in bundle.axes.iter().enumerate() {
            let near = _mm256_loadu_ps(node.planes[2 * axis + (a.near & 1)].as_ptr());
            let far = _mm256_loadu_ps(node.planes[2 * axis + (a.near & 1 ^ 1)].as_ptr());
            let near = _mm256_sub_ps(near, _mm256_set1_ps(a.near_o));
            let far = _mm256_sub_ps(far, _mm256_set1_ps(a.far_o));
            let (least, most) = (_mm256_set1_ps(a.inv[0]), _mm256_set1_ps(a.inv[1]));
            let first = _mm256_min_ps(_mm256_mul_ps(near, least), _mm256_mul_ps(near, most));
            let last = _mm256_max_ps(_mm256_mul_ps(far, least), _mm256_mul_ps(far, most));
            enter = _mm256_max_ps(first, enter);
            exit = _mm256_min_ps(last, exit);
        }
        let exit = _mm256_min_ps(_mm256_mul_ps(exit, _mm256_set1_ps(EXIT)), _mm256_set1_ps(limit));
        let entered = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, exit)) as u32;
        _mm256_storeu_ps(out.as_mut_ptr(), enter);
        (entered, out)
    }
}

/// [`Kernel::entering`](super::Kernel::entering).
///
/// # Safety
/// The processor must have AVX.
#[inline(always)]
pub(super) unsafe fn entering(bundle: &Bundle, node: &Node, slot: usize) -> u64 {
    let mut out = 0;
    for group in 0..GROUPS {
        // SAFETY: the caller's promise; eight numbers are read from arrays of eight.
        unsafe {
            let mut enter = _mm256_loadu_ps(bundle.enter[group].as_ptr());
            let mut exit = _mm256_set1_ps(f32::INFINITY);
            for (axis, a) in bundle.axes.iter().enumerate() {
                let near = _mm256_set1_ps(node.planes[2 * axis + (a.near & 1)][slot]);
                let far = _mm256_set1_ps(node.planes[2 * axis + (a.near & 1 ^ 1)][slot]);
                let o = _mm256_loadu_ps(bundle.o[axis][group].as_ptr());
                let inv = _mm256_loadu_ps(bundle.inv[axis][group].as_ptr());
                enter = _mm256_max_ps(_mm256_mul_ps(_mm256_sub_ps(near, o), inv), enter);
                exit = _mm256_min_ps(_mm256_mul_ps(_mm256_sub_ps(far, o), inv), exit);
            }
            let limit = _mm256_loadu_ps(bundle.limit[group].as_ptr());
            let exit = _mm256_min_ps(_mm256_mul_ps(exit, _mm256_set1_ps(EXIT)), limit);
            let entered = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, exit)) as u32;
            out |= u64::from(entered) << (WIDTH * group);
        }
    }
    out
}
