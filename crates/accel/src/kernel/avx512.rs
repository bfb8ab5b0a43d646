//! AVX-512: the near and far planes of an axis in one vector of sixteen lanes, and lanes packed by a mask.
//!
//! A processor that runs such a vector in two halves, as Zen 4 does, gains as well: half as many instructions are to be
//! read and kept track of.
//!
//! Safety: an [`Avx512`] is made only where the processor has AVX-512 F, DQ and VL, and all that AVX2 needs.

use super::{
    Children, Kernel, Lanes, NOT_ENTERED, Next, ahead,
    avx2::{self, classes_avx2, earliest, far_to_near, keys, latest, least},
    bundle,
    descent::Descent,
    entry::entry_points,
    leaf::{self, Pick, Twelve},
    lines::Lines,
    vec3::{own_box_avx, prepare_avx},
};
use crate::{
    local::{LocalRay, NODE_EXIT},
    node::{
        Block, Child, Node, WIDTH,
        bundle::{Bundle, GROUPS},
    },
    slab::EXIT,
};
use std::arch::x86_64::*;
use straal_math::{Ray, simd::Simd};

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
    fn chosen(self) -> super::Chosen {
        super::Chosen::Avx512(self)
    }

    #[inline(always)]
    fn simd(self) -> Simd {
        Simd::new(crate::Isa::Avx512).unwrap_or(Simd::PLAIN)
    }

    #[inline(always)]
    fn prepare(self, ray: &Ray, out: &mut LocalRay) -> bool {
        // SAFETY: see the head of the file.
        unsafe { prepare_avx(ray, out) }
    }

    #[inline(always)]
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children {
        let mut out = Children::NONE;
        // SAFETY: see the head of the file. Eight numbers are written to an array of eight.
        unsafe {
            let (enter, exit) = avx2::interval(r, node, limit);
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
    fn entered(self, r: &LocalRay, node: &Node, limit: f32) -> u32 {
        // SAFETY: see the head of the file.
        unsafe {
            let (enter, exit) = avx2::interval(r, node, limit);
            u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, exit))
        }
    }

    #[inline(always)]
    fn step<const N: usize>(
        self,
        r: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<N>,
    ) -> Option<Child> {
        // SAFETY: see the head of the file. Eight numbers are read from an array of eight, and eight of each stored, of which
        // the first are those of the mask.
        unsafe {
            let order = far_to_near(r);
            let (enter, exit) = slabs(r, node);
            let ordered = (_mm256_permutexvar_ps(order, enter), _mm256_permutexvar_ps(order, exit));
            let (enter, exit) = within(r, limit, ordered);
            let children = _mm256_loadu_si256(node.children.as_ptr().cast());
            let children = _mm256_permutexvar_epi32(order, children);
            let mask = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, exit);
            let keys = _mm256_maskz_compress_epi32(mask, _mm256_castps_si256(enter));
            let children = _mm256_maskz_compress_epi32(mask, children);
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
            let (enter, exit) = within(r, limit, slabs(r, node));
            let mask = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, exit);
            let children = _mm256_loadu_si256(node.children.as_ptr().cast());
            let children = _mm256_maskz_compress_epi32(mask, children);
            stack.step(mask.count_ones() as usize, |k: *mut u32, c: *mut u32| {
                _mm256_storeu_si256(k.cast(), _mm256_setzero_si256());
                _mm256_storeu_si256(c.cast(), children);
            })
        }
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
                let children = _mm256_maskz_compress_epi32(others as __mmask8, children);
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
        unsafe { entering(b, node, slot) }
    }

    #[inline(always)]
    fn classes<const N: usize>(self, next: &Next<N>) -> [u64; 4] {
        // SAFETY: an `Avx512` is made only where there is AVX2 too.
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
            let (enter, exit) = avx2::interval(r, node, limit);
            let entered = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, exit);
            let none = _mm256_set1_epi32(NOT_ENTERED as i32);
            let keys = _mm256_mask_mov_epi32(none, entered, keys(enter));
            let least = ahead(least(keys));
            if entered & entered.wrapping_sub(1) == 0 {
                return (entered != 0).then(|| node.children[(entered.trailing_zeros() & 7) as usize]);
            }
            let order = far_to_near(r);
            let keys = _mm256_permutexvar_epi32(order, keys);
            let others = _mm256_cmpgt_epi32_mask(keys, _mm256_set1_epi32(least as i32));
            let others = _mm256_mask_cmplt_epi32_mask(others, keys, none);
            let children = _mm256_loadu_si256(node.children.as_ptr().cast());
            let children = _mm256_permutexvar_epi32(order, children);
            let children = _mm256_maskz_compress_epi32(others, children);
            let keys = _mm256_maskz_compress_epi32(others, keys);
            stack.push_several(others.count_ones() as usize, |k: *mut u32, c: *mut u32| {
                _mm256_storeu_si256(k.cast(), keys);
                _mm256_storeu_si256(c.cast(), children);
            });
            Some(node.children[(least & 7) as usize])
        }
    }

    #[inline(always)]
    fn inside(self, r: &LocalRay, block: &Block) -> u32 {
        // SAFETY: an `Avx512` is made only where there is AVX2 too.
        unsafe { leaf::inside::<Self>(r, block) }
    }

    #[inline(always)]
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes {
        // SAFETY: an `Avx512` is made only where there is AVX2 too.
        unsafe { leaf::block::<Self>(r, block, limit) }
    }

    #[inline(always)]
    fn own_box(self, r: &LocalRay, block: &Block, lane: usize) -> Option<f32> {
        // SAFETY: an `Avx512` is made only where there is AVX2 too.
        unsafe { own_box_avx(r, block, lane) }
    }

    #[inline(always)]
    fn prefetch<const HOW: u8>(self, lines: &Lines, child: Child) {
        super::prefetch::prefetch::<HOW>(lines, child);
    }

    entry_points!("avx512f,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt");
}

/// Where the ray's line enters and leaves each box: fewer instructions than `avx2::interval`, which counts where many rays are
/// in flight, but a longer way to the result, which counts where one is.
///
/// # Safety
/// The processor must have AVX-512 F, DQ and VL.
#[inline(always)]
unsafe fn slabs(r: &LocalRay, node: &Node) -> (__m256, __m256) {
    // SAFETY: the caller's promise.
    unsafe {
        let (x, y, z) = (crossed(r, node, 0), crossed(r, node, 1), crossed(r, node, 2));
        let enter = latest(latest(near_half(x), near_half(y)), near_half(z));
        (enter, earliest(earliest(far_half(x), far_half(y)), far_half(z)))
    }
}

/// The lanes of near planes.
///
/// # Safety
/// The processor must have AVX-512 F.
#[inline(always)]
unsafe fn near_half(crossed: __m512) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm512_castps512_ps256(crossed) }
}

/// The lanes of far planes.
///
/// # Safety
/// The processor must have AVX-512 DQ.
#[inline(always)]
unsafe fn far_half(crossed: __m512) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm512_extractf32x8_ps::<1>(crossed) }
}

/// What is left of that from the ray's start to `limit`; exits are raised. The lanes may be in any order: they are put in
/// order before this, since the compiler, if it is done behind, also puts the ray's eight equal numbers in order.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn within(r: &LocalRay, limit: f32, (enter, exit): (__m256, __m256)) -> (__m256, __m256) {
    // SAFETY: the caller's promise.
    unsafe {
        let exit = _mm256_mul_ps(exit, _mm256_set1_ps(NODE_EXIT));
        (latest(enter, _mm256_set1_ps(r.ray.t_min)), earliest(exit, _mm256_set1_ps(limit)))
    }
}

/// Where the ray crosses the near planes of an axis, and in the upper eight lanes the far ones.
///
/// # Safety
/// The processor must have AVX-512 F and DQ.
#[inline(always)]
unsafe fn crossed(r: &LocalRay, node: &Node, axis: usize) -> __m512 {
    // SAFETY: the caller's promise; the two rows of an axis, of eight numbers each, follow each other.
    unsafe {
        let planes = _mm512_castps_pd(_mm512_loadu_ps((&raw const node.planes).byte_add(64 * axis).cast()));
        // Near planes first: the halves change places where the direction is negative.
        let planes = _mm512_mask_shuffle_f64x2::<0b01_00_11_10>(planes, r.neg[axis], planes, planes);
        let from = _mm512_sub_ps(_mm512_castpd_ps(planes), _mm512_set1_ps(r.ray.o[axis]));
        _mm512_mul_ps(from, _mm512_set1_ps(r.inv[axis]))
    }
}

/// `bundle::entering`, sixteen rays at a time.
///
/// # Safety
/// The processor must have AVX-512 F.
#[inline(always)]
unsafe fn entering(bundle: &Bundle, node: &Node, slot: usize) -> u64 {
    let mut out = 0;
    for pair in 0..GROUPS / 2 {
        // SAFETY: the caller's promise; `pair` is less than half the groups.
        unsafe {
            let mut enter = rays(&bundle.enter, pair);
            let mut exit = _mm512_set1_ps(f32::INFINITY);
            for (axis, a) in bundle.axes.iter().enumerate() {
                let near = _mm512_set1_ps(node.planes[2 * axis + (a.near & 1)][slot]);
                let far = _mm512_set1_ps(node.planes[2 * axis + (a.near & 1 ^ 1)][slot]);
                let (o, inv) = (rays(&bundle.o[axis], pair), rays(&bundle.inv[axis], pair));
                enter = _mm512_max_ps(_mm512_mul_ps(_mm512_sub_ps(near, o), inv), enter);
                exit = _mm512_min_ps(_mm512_mul_ps(_mm512_sub_ps(far, o), inv), exit);
            }
            let exit = _mm512_min_ps(_mm512_mul_ps(exit, _mm512_set1_ps(EXIT)), rays(&bundle.limit, pair));
            let entered = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(enter, exit);
            out |= u64::from(entered) << (2 * WIDTH * pair);
        }
    }
    out
}

/// The numbers of sixteen rays.
///
/// # Safety
/// The processor must have AVX-512 F, and `pair` be less than half of [`GROUPS`].
#[inline(always)]
unsafe fn rays(groups: &[[f32; WIDTH]; GROUPS], pair: usize) -> __m512 {
    // SAFETY: the caller's promise; groups of eight numbers follow each other, and two of them are read.
    unsafe { _mm512_loadu_ps(groups.as_ptr().add(2 * pair).cast()) }
}

impl Pick for Avx512 {
    #[inline(always)]
    unsafe fn pick(from: Twelve, vertices: __m256i) -> __m256 {
        // SAFETY: the caller's promise.
        unsafe { _mm256_permutex2var_ps(from.0, vertices, _mm256_castps128_ps256(from.1)) }
    }
}
