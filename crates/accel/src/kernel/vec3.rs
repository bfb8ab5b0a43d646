//! Vectors of three coordinates in the lanes of one register: setting up a ray, and the box of one triangle.
//!
//! Every lane does the operations of `local.rs` and `slab.rs` in their order.

use crate::{
    local::{LEAST, LocalRay, NEG, NODE_EXIT, ROW},
    node::Block,
    slab::{EXIT, PAD_COORDINATE, PAD_EXTENT},
};
use std::{arch::x86_64::*, mem::offset_of};
use straal_math::{Ray, Vec3};

/// [`super::Kernel::prepare`] of AVX2 and AVX-512.
///
/// # Safety
/// The processor must have AVX.
#[inline(always)]
pub(super) unsafe fn prepare_avx(ray: &Ray, out: &mut LocalRay) -> bool {
    // SAFETY: the caller's promise. Origin and direction are each followed by one more number of `Ray`, the reciprocal by
    // that of far planes, that by `origin`, that by `shear`, and that by `rows`, so that four numbers from each are inside; each
    // is written before what follows it.
    unsafe {
        let o = _mm_loadu_ps((&raw const *ray).byte_add(offset_of!(Ray, o)).cast());
        let d = _mm_loadu_ps((&raw const *ray).byte_add(offset_of!(Ray, d)).cast());
        let to = &raw mut *out;
        let ray_at = offset_of!(LocalRay, ray);
        let zero = _mm_setzero_ps();
        // The fourth lanes are the interval's ends.
        let start = _mm_max_ps(o, zero);
        let end = _mm_min_ps(_mm_set1_ps(f32::MAX), d);
        // Zero times what isn't finite is NaN.
        let zeros = _mm_add_ps(_mm_mul_ps(o, zero), _mm_mul_ps(d, zero));
        let is_finite = _mm_movemask_ps(_mm_cmpeq_ps(zeros, zero)) & 7 == 7;
        let is_somewhere = _mm_movemask_ps(_mm_cmpneq_ps(d, zero)) & 7 != 0;
        let is_interval = _mm_and_ps(_mm_cmple_ps(o, d), _mm_cmple_ps(start, end));
        let is_valid = is_finite & is_somewhere & (_mm_movemask_ps(is_interval) & 8 != 0);
        _mm_storeu_ps(to.byte_add(ray_at + offset_of!(Ray, o)).cast(), _mm_blend_ps::<8>(o, start));
        _mm_storeu_ps(to.byte_add(ray_at + offset_of!(Ray, d)).cast(), _mm_blend_ps::<8>(d, end));
        ((*to).ray.time, (*to).ray.mask) = (ray.time, ray.mask);

        let sign = _mm_set1_ps(-0.0);
        let size = _mm_andnot_ps(sign, d);
        let least = _mm_set1_ps(LEAST);
        let kept = _mm_cmpgt_ps(size, least);
        let divisor = _mm_blendv_ps(_mm_or_ps(least, _mm_and_ps(sign, d)), d, kept);
        let one = _mm_set1_ps(1.0);
        let inv = _mm_div_ps(one, divisor);
        _mm_storeu_ps(to.byte_add(offset_of!(LocalRay, inv)).cast(), inv);
        let far = _mm_mul_ps(inv, _mm_set1_ps(NODE_EXIT));
        _mm_storeu_ps(to.byte_add(offset_of!(LocalRay, far)).cast(), far);
        // The signs of `inv`, known before it is.
        let octant = (_mm_movemask_ps(d) & 7) as usize;
        ((*to).neg, (*to).octant) = (NEG[octant], octant as u8);

        // y > x, z > x, z > y
        let later = _mm_cmpgt_ps(
            _mm_shuffle_ps::<0b10_10_10_01>(size, size),
            _mm_shuffle_ps::<0b01_01_00_00>(size, size),
        );
        let z = DOMINANT[(_mm_movemask_ps(later) & 7) as usize] as usize;
        let shear = &SHEARS[(octant >> z & 1) * 3 + z];
        let order = _mm_loadu_si128(shear.order.as_ptr().cast());
        let scale = _mm_blendv_ps(_mm_div_ps(one, d), inv, kept);
        let scale = _mm_permutevar_ps(scale, _mm_set1_epi32(z as i32));
        let d = _mm_mul_ps(_mm_permutevar_ps(d, order), scale);
        _mm_storeu_ps(to.byte_add(offset_of!(LocalRay, origin)).cast(), _mm_permutevar_ps(o, order));
        _mm_storeu_ps(to.byte_add(offset_of!(LocalRay, shear)).cast(), _mm_blend_ps::<4>(d, scale));
        (*to).rows = shear.rows;
        is_valid
    }
}

/// The dominant axis, by which coordinates are greater than earlier ones: y than x, z than x, z than y.
static DOMINANT: [u8; 8] = [0, 1, 0, 1, 0, 1, 2, 2];

/// The axes of a sheared space.
#[repr(C, align(32))]
struct Shear {
    order: [u32; 4],
    rows: [u8; 4],
}

/// By the dominant axis, then those for a negative direction along it.
static SHEARS: [Shear; 6] = {
    const fn shear(x: u8, y: u8, z: u8) -> Shear {
        Shear { order: [x as u32, y as u32, z as u32, z as u32], rows: [x * ROW, y * ROW, z * ROW, 0] }
    }
    [shear(1, 2, 0), shear(2, 0, 1), shear(0, 1, 2), shear(2, 1, 0), shear(0, 2, 1), shear(1, 0, 2)]
};

/// A vector with 0 in the last lane.
///
/// # Safety
/// The processor must have AVX.
#[inline(always)]
unsafe fn vector(p: Vec3) -> __m128 {
    // SAFETY: the caller's promise.
    unsafe { _mm_setr_ps(p.x, p.y, p.z, 0.0) }
}

/// [`super::Kernel::own_box`] of AVX2 and AVX-512.
///
/// # Safety
/// The processor must have AVX.
#[inline(always)]
pub(super) unsafe fn own_box_avx(r: &LocalRay, block: &Block, lane: usize) -> Option<f32> {
    // SAFETY: the caller's promise. Four numbers from origin, and from reciprocal, are inside.
    unsafe {
        let [a, b, c] = block.vertices(lane & 7);
        let (a, b, c) = (vector(a), vector(b), vector(c));
        let low = _mm_min_ps(_mm_min_ps(a, b), c);
        let high = _mm_max_ps(_mm_max_ps(a, b), c);
        let extent = _mm_sub_ps(high, low);
        let extent = _mm_max_ps(extent, _mm_shuffle_ps::<0b00_01_00_01>(extent, extent));
        let extent = _mm_max_ps(extent, _mm_shuffle_ps::<0b10_10_10_10>(extent, extent));
        let by = _mm_mul_ps(_mm_shuffle_ps::<0>(extent, extent), _mm_set1_ps(PAD_EXTENT));
        let margin = |x| {
            let size = _mm_andnot_ps(_mm_set1_ps(-0.0), x);
            _mm_add_ps(by, _mm_mul_ps(size, _mm_set1_ps(PAD_COORDINATE)))
        };
        let (low, high) = (_mm_sub_ps(low, margin(low)), _mm_add_ps(high, margin(high)));
        let from = &raw const *r;
        let o = _mm_loadu_ps(from.byte_add(offset_of!(LocalRay, ray) + offset_of!(Ray, o)).cast());
        let inv = _mm_loadu_ps(from.byte_add(offset_of!(LocalRay, inv)).cast());
        let near = _mm_mul_ps(_mm_sub_ps(_mm_blendv_ps(low, high, inv), o), inv);
        let far = _mm_mul_ps(_mm_sub_ps(_mm_blendv_ps(high, low, inv), o), inv);
        let enter = _mm_max_ss(near, _mm_shuffle_ps::<0b01_01_01_01>(near, near));
        let enter = _mm_max_ss(enter, _mm_shuffle_ps::<0b10_10_10_10>(near, near));
        let exit = _mm_min_ss(far, _mm_shuffle_ps::<0b01_01_01_01>(far, far));
        let exit = _mm_min_ss(exit, _mm_shuffle_ps::<0b10_10_10_10>(far, far));
        let (enter, exit) = (_mm_cvtss_f32(enter), _mm_cvtss_f32(exit) * EXIT);
        let starts = if enter > r.ray.t_min { enter } else { r.ray.t_min };
        let ends = if exit < r.ray.t_max { exit } else { r.ray.t_max };
        (starts <= ends).then_some(enter)
    }
}
