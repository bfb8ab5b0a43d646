//! Eight lanes of AVX2.
//!
//! Every lane does the operations of `slab.rs` and `triangle.rs` in their order: none is fused.
//!
//! Safety: an [`Avx2`] is made only where the processor has AVX2, BMI1 and BMI2, which all functions here need.

use super::{
    Children, FAR_TO_NEAR, Kernel, Lanes, NOT_ENTERED, Next, ahead, bundle, by_class,
    descent::Descent,
    entry::entry_points,
    leaf::{self, Pick, Twelve},
    lines::Lines,
    vec3::{own_box_avx, prepare_avx},
};
use crate::{
    local::LocalRay,
    node::{Block, Child, Node, bundle::Bundle},
};
use std::arch::x86_64::*;
use straal_math::{Ray, simd::Simd};

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
    fn chosen(self) -> super::Chosen {
        super::Chosen::Avx2(self)
    }

    #[inline(always)]
    fn simd(self) -> Simd {
        Simd::new(crate::Isa::Avx2).unwrap_or(Simd::PLAIN)
    }

    #[inline(always)]
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children {
        let mut out = Children::NONE;
        // SAFETY: see the head of the file. Eight numbers are written to an array of eight.
        unsafe {
            let (enter, exit) = interval(r, node, limit);
            let entered = _mm256_cmp_ps::<_CMP_LE_OQ>(enter, exit);
            out.mask = _mm256_movemask_ps(entered) as u32;
            let none = _mm256_set1_epi32(NOT_ENTERED as i32);
            let keys = _mm256_blendv_epi8(none, keys(enter), _mm256_castps_si256(entered));
            _mm256_storeu_si256((&raw mut out.keys).cast(), keys);
        }
        out
    }

    #[inline(always)]
    fn entered(self, r: &LocalRay, node: &Node, limit: f32) -> u32 {
        // SAFETY: see the head of the file.
        unsafe {
            let (enter, exit) = interval(r, node, limit);
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, exit)) as u32
        }
    }

    #[inline(always)]
    fn prepare(self, ray: &Ray, out: &mut LocalRay) -> bool {
        // SAFETY: see the head of the file.
        unsafe { prepare_avx(ray, out) }
    }

    #[inline(always)]
    fn step<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        // SAFETY: see the head of the file. Eight numbers are read from arrays of eight, and eight of each stored, of which
        // the first are those of the mask by the table.
        unsafe {
            let (enter, exit) = interval(r, node, limit);
            let order = far_to_near(r);
            let (enter, exit) =
                (_mm256_permutevar8x32_ps(enter, order), _mm256_permutevar8x32_ps(exit, order));
            let children = _mm256_loadu_si256(node.children.as_ptr().cast());
            let children = _mm256_permutevar8x32_epi32(children, order);
            let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, exit)) as u32;
            let packed = set_first(mask);
            let children = _mm256_permutevar8x32_epi32(children, packed);
            let keys = _mm256_permutevar8x32_epi32(_mm256_castps_si256(enter), packed);
            stack.step(mask.count_ones() as usize, |k: *mut u32, c: *mut u32| {
                _mm256_storeu_si256(k.cast(), keys);
                _mm256_storeu_si256(c.cast(), children);
            })
        }
    }

    #[inline(always)]
    fn step_any<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        // SAFETY: as above.
        unsafe {
            let mask = self.entered(r, node, limit);
            let children = _mm256_loadu_si256(node.children.as_ptr().cast());
            let children = _mm256_permutevar8x32_epi32(children, set_first(mask));
            stack.step(mask.count_ones() as usize, |k: *mut u32, c: *mut u32| {
                _mm256_storeu_si256(k.cast(), _mm256_setzero_si256());
                _mm256_storeu_si256(c.cast(), children);
            })
        }
    }

    #[inline(always)]
    fn own_box(self, r: &LocalRay, block: &Block, lane: usize) -> Option<f32> {
        // SAFETY: see the head of the file.
        unsafe { own_box_avx(r, block, lane) }
    }

    #[inline(always)]
    fn any<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        let entered = self.entered(r, node, limit);
        let others = entered & entered.wrapping_sub(1);
        if others != 0 {
            // SAFETY: as with `step`.
            unsafe {
                let children = _mm256_loadu_si256(node.children.as_ptr().cast());
                let children = _mm256_permutevar8x32_epi32(children, set_first(others));
                stack.push_several(others.count_ones() as usize, |k: *mut u32, c: *mut u32| {
                    _mm256_storeu_si256(k.cast(), _mm256_setzero_si256());
                    _mm256_storeu_si256(c.cast(), children);
                });
            }
        }
        (entered != 0).then(|| node.children[(entered.trailing_zeros() & 7) as usize])
    }

    #[inline(always)]
    fn entries(self, b: &Bundle, node: &Node, limit: f32) -> (u32, [f32; 8]) {
        // SAFETY: see the head of the file.
        unsafe { bundle::entries(b, node, limit) }
    }

    #[inline(always)]
    fn entering(self, b: &Bundle, node: &Node, slot: usize) -> u64 {
        // SAFETY: see the head of the file.
        unsafe { bundle::entering(b, node, slot) }
    }

    #[inline(always)]
    fn classes<const N: usize>(self, next: &Next<N>) -> [u64; 4] {
        // SAFETY: see the head of the file.
        unsafe { classes_avx2(next) }
    }

    #[inline(always)]
    fn nearest<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        // SAFETY: as with `step`.
        unsafe {
            let (enter, exit) = interval(r, node, limit);
            let entered = _mm256_cmp_ps::<_CMP_LE_OQ>(enter, exit);
            let mask = _mm256_movemask_ps(entered) as u32;
            let none = _mm256_set1_epi32(NOT_ENTERED as i32);
            let keys = _mm256_blendv_epi8(none, keys(enter), _mm256_castps_si256(entered));
            let least = ahead(least(keys));
            if mask & mask.wrapping_sub(1) == 0 {
                return (mask != 0).then(|| node.children[(mask.trailing_zeros() & 7) as usize]);
            }
            let order = far_to_near(r);
            let keys = _mm256_permutevar8x32_epi32(keys, order);
            let others = _mm256_and_si256(
                _mm256_cmpgt_epi32(keys, _mm256_set1_epi32(least as i32)),
                _mm256_cmpgt_epi32(none, keys),
            );
            let others = _mm256_movemask_ps(_mm256_castsi256_ps(others)) as u32;
            let packed = set_first(others);
            let children = _mm256_loadu_si256(node.children.as_ptr().cast());
            let children = _mm256_permutevar8x32_epi32(children, order);
            let children = _mm256_permutevar8x32_epi32(children, packed);
            let keys = _mm256_permutevar8x32_epi32(keys, packed);
            stack.push_several(others.count_ones() as usize, |k: *mut u32, c: *mut u32| {
                _mm256_storeu_si256(k.cast(), keys);
                _mm256_storeu_si256(c.cast(), children);
            });
            Some(node.children[(least & 7) as usize])
        }
    }

    #[inline(always)]
    fn inside(self, r: &LocalRay, block: &Block) -> u32 {
        // SAFETY: `self` is the proof that the processor has AVX2.
        unsafe { leaf::inside::<Self>(r, block) }
    }

    #[inline(always)]
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes {
        // SAFETY: `self` is the proof that the processor has AVX2.
        unsafe { leaf::block::<Self>(r, block, limit) }
    }

    #[inline(always)]
    fn prefetch<const HOW: u8>(self, lines: &Lines, child: Child) {
        super::prefetch::prefetch::<HOW>(lines, child);
    }

    entry_points!("avx2,bmi1,bmi2,lzcnt,popcnt");
}

/// Where the ray enters and leaves each box, no earlier than its start and no later than `limit`.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn interval(r: &LocalRay, node: &Node, limit: f32) -> (__m256, __m256) {
    // SAFETY: the caller's promise.
    unsafe {
        // Planes of an axis stand side by side, the near one second where the direction is negative.
        // As few operations as can be stand between the last plane and the result.
        let (x, y, z) = (near(r, node, 0), near(r, node, 1), near(r, node, 2));
        let enter = latest(latest(x, y), latest(z, _mm256_set1_ps(r.ray.t_min)));
        let (x, y, z) = (far(r, node, 0), far(r, node, 1), far(r, node, 2));
        let exit = earliest(earliest(x, y), earliest(z, _mm256_set1_ps(limit)));
        (enter, exit)
    }
}

/// The greater of two entries by their bits as integers. Of two below 0 it is the lesser, but `t_min`, among them, isn't below 0.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn latest(a: __m256, b: __m256) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm256_castsi256_ps(_mm256_max_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b))) }
}

/// `scalar::earliest` in eight lanes.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn earliest(a: __m256, b: __m256) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm256_castsi256_ps(_mm256_min_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b))) }
}

/// [`Children::keys`] of entries.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn keys(enter: __m256) -> __m256i {
    // SAFETY: the caller's promise.
    unsafe {
        let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(enter)), lanes)
    }
}

/// The least of eight keys.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn least(keys: __m256i) -> u32 {
    // SAFETY: the caller's promise.
    unsafe {
        let k = _mm_min_epi32(_mm256_castsi256_si128(keys), _mm256_extracti128_si256::<1>(keys));
        let k = _mm_min_epi32(k, _mm_shuffle_epi32::<0b01_00_11_10>(k));
        let k = _mm_min_epi32(k, _mm_shuffle_epi32::<0b10_11_00_01>(k));
        _mm_cvtsi128_si32(k) as u32
    }
}

/// [`Kernel::classes`], also for AVX-512.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn classes_avx2<const N: usize>(next: &Next<N>) -> [u64; 4] {
    let (mut high, mut low) = (0, 0);
    for (i, eight) in next.0.chunks_exact(8).enumerate() {
        // SAFETY: the caller's promise; eight numbers are read from eight.
        unsafe {
            let children = _mm256_loadu_si256(eight.as_ptr().cast());
            let second = _mm256_slli_epi32::<1>(children);
            high |= u64::from(_mm256_movemask_ps(_mm256_castsi256_ps(children)) as u32) << (8 * i);
            low |= u64::from(_mm256_movemask_ps(_mm256_castsi256_ps(second)) as u32) << (8 * i);
        }
    }
    by_class(high, low)
}

const _: () = assert!(size_of::<Child>() == size_of::<u32>());

/// The order in which `Kernel::step` pushes slots.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn far_to_near(r: &LocalRay) -> __m256i {
    // SAFETY: the caller's promise; eight numbers are read from an array of eight.
    unsafe { _mm256_loadu_si256(FAR_TO_NEAR[usize::from(r.octant & 7)].as_ptr().cast()) }
}

/// The order that brings the lanes of a set to the front.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn set_first(set: u32) -> __m256i {
    // SAFETY: the caller's promise; eight bytes are read from an array of eight.
    unsafe { _mm256_cvtepu8_epi32(_mm_loadl_epi64(SET_FIRST[(set & 255) as usize].as_ptr().cast())) }
}

/// For each set of lanes, its members in rising order, then zeros.
static SET_FIRST: [[u8; 8]; 256] = {
    let mut out = [[0; 8]; 256];
    let mut set = 0;
    while set < 256 {
        let (mut lane, mut count) = (0, 0);
        while lane < 8 {
            if set >> lane & 1 == 1 {
                out[set][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    out
};

/// Where the ray crosses the near plane of each box.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn near(r: &LocalRay, node: &Node, axis: usize) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm256_mul_ps(from(r, node, axis, r.neg[axis] & 32), _mm256_set1_ps(r.inv[axis])) }
}

/// Where the ray crosses the far plane of each box.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn far(r: &LocalRay, node: &Node, axis: usize) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm256_mul_ps(from(r, node, axis, !r.neg[axis] & 32), _mm256_set1_ps(r.far[axis])) }
}

/// A plane of each box, from the ray's origin; `row` is 0 or 32, the offset of the lesser or of the greater planes.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn from(r: &LocalRay, node: &Node, axis: usize, row: u8) -> __m256 {
    // SAFETY: the caller's promise; an axis has two rows of eight.
    unsafe {
        let b = _mm256_loadu_ps((&raw const node.planes).byte_add(64 * axis + usize::from(row)).cast());
        _mm256_sub_ps(b, _mm256_set1_ps(r.ray.o[axis]))
    }
}

impl Pick for Avx2 {
    #[inline(always)]
    unsafe fn pick(from: Twelve, vertices: __m256i) -> __m256 {
        // SAFETY: the caller's promise.
        unsafe {
            let first = _mm256_permutevar8x32_ps(from.0, vertices);
            let others = _mm256_permutevar8x32_ps(_mm256_castps128_ps256(from.1), vertices);
            // Bit 3 of the number chooses.
            let is_other = _mm256_slli_epi32::<28>(vertices);
            _mm256_blendv_ps(first, others, _mm256_castsi256_ps(is_other))
        }
    }
}
