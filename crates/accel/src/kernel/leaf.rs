//! A ray against a block of eight triangles, eight lanes of AVX at a time: [`Kernel::inside`](super::Kernel::inside) and
//! [`Kernel::block`](super::Kernel::block) of AVX2 and AVX-512.
//!
//! Vertices are moved to the ray's origin and sheared where the block keeps them, each once; triangles then pick theirs.
//! Every lane does the operations of `slab.rs` and `triangle.rs` in their order: none is fused.

use super::Lanes;
use crate::{
    local::{LocalRay, ROW},
    node::{Block, WIDTH},
    triangle::{FLAT, LEAST_DETERMINANT},
};
use std::arch::x86_64::*;

/// A number for each vertex of a block. In two registers, since picking from both at once takes half the time of picking from
/// one of sixteen, where AVX-512 would have it.
#[derive(Clone, Copy)]
pub(super) struct Twelve(pub __m256, pub __m128);

/// What instruction sets do differently.
pub(super) trait Pick: Copy {
    /// The numbers of vertices, of which the lowest four bits count.
    ///
    /// # Safety
    /// The processor must have the instruction set.
    unsafe fn pick(from: Twelve, vertices: __m256i) -> __m256;
}

impl Twelve {
    /// # Safety
    /// The processor must have AVX.
    #[inline(always)]
    unsafe fn minus(self, x: f32) -> Self {
        // SAFETY: the caller's promise.
        unsafe { Self(_mm256_sub_ps(self.0, _mm256_set1_ps(x)), _mm_sub_ps(self.1, _mm_set1_ps(x))) }
    }

    /// This minus `by` times the other.
    ///
    /// # Safety
    /// The processor must have AVX.
    #[inline(always)]
    unsafe fn minus_scaled(self, by: f32, other: Self) -> Self {
        // SAFETY: the caller's promise.
        unsafe {
            Self(
                _mm256_sub_ps(self.0, _mm256_mul_ps(_mm256_set1_ps(by), other.0)),
                _mm_sub_ps(self.1, _mm_mul_ps(_mm_set1_ps(by), other.1)),
            )
        }
    }
}

/// Coordinates of all vertices along an axis of the sheared space, moved to the ray's origin.
///
/// # Safety
/// The processor must have AVX.
#[inline(always)]
unsafe fn moved(r: &LocalRay, block: &Block, axis: usize) -> Twelve {
    // SAFETY: the caller's promise; `LocalRay` gives offsets of one of three rows, aligned cache lines that begin with twelve
    // coordinates.
    unsafe {
        let row = (&raw const block.rows).byte_add(usize::from(r.rows[axis])).cast::<f32>();
        Twelve(_mm256_load_ps(row), _mm_load_ps(row.add(8))).minus(r.origin[axis])
    }
}

/// The numbers of each triangle's first, second or third vertex in the lowest four bits.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn corners(block: &Block, i: usize) -> __m256i {
    // SAFETY: the caller's promise.
    unsafe {
        let lanes = _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28);
        _mm256_srlv_epi32(_mm256_set1_epi32(block.rows[i].corners as i32), lanes)
    }
}

/// Eight triangles as `triangle::edges` has one.
struct Crossing {
    /// Coordinates along the axes of the sheared space.
    moved: [Twelve; 3],
    /// Which vertices are each triangle's first, second and third.
    corners: [__m256i; 3],
    /// By vertex, sheared x and y.
    xy: [[__m256; 2]; 3],
    edges: [__m256; 3],
    /// The lanes with an edge function of zero.
    on_edge: __m256,
    /// The lanes in which no two signs differ, and those with a zero.
    inside: u32,
}

impl Crossing {
    /// # Safety
    /// The processor must have AVX2 and what `P` needs.
    #[inline(always)]
    unsafe fn new<P: Pick>(r: &LocalRay, block: &Block) -> Self {
        // SAFETY: the caller's promise.
        unsafe {
            let moved @ [x, y, z] = [moved(r, block, 0), moved(r, block, 1), moved(r, block, 2)];
            let (x, y) = (x.minus_scaled(r.shear[0], z), y.minus_scaled(r.shear[1], z));
            let corners @ [i, j, k] = [corners(block, 0), corners(block, 1), corners(block, 2)];
            let a = [P::pick(x, i), P::pick(y, i)];
            let b = [P::pick(x, j), P::pick(y, j)];
            let c = [P::pick(x, k), P::pick(y, k)];
            let edges @ [u, v, w] = [edge(&c, &b), edge(&a, &c), edge(&b, &a)];
            // A zero has either sign, so that any leaves the lane in.
            let zero = _mm256_setzero_ps();
            let is_zero = |x| _mm256_cmp_ps::<_CMP_EQ_OQ>(x, zero);
            let on_edge = _mm256_or_ps(is_zero(u), _mm256_or_ps(is_zero(v), is_zero(w)));
            let differ = _mm256_or_ps(_mm256_xor_ps(u, v), _mm256_xor_ps(v, w));
            let outside = _mm256_movemask_ps(_mm256_andnot_ps(on_edge, differ)) as u32;
            let inside = !outside & block.lanes();
            Self { moved, corners, xy: [a, b, c], edges, on_edge, inside }
        }
    }

    /// The coordinates of each triangle's vertices along an axis.
    ///
    /// # Safety
    /// The processor must have AVX2 and what `P` needs.
    #[inline(always)]
    unsafe fn along<P: Pick>(&self, axis: usize) -> [__m256; 3] {
        // SAFETY: the caller's promise.
        unsafe {
            let ([i, j, k], moved) = (self.corners, self.moved[axis]);
            [P::pick(moved, i), P::pick(moved, j), P::pick(moved, k)]
        }
    }
}

/// Edge functions of the edges from `q` to `p`.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn edge(p: &[__m256; 2], q: &[__m256; 2]) -> __m256 {
    // SAFETY: the caller's promise.
    unsafe { _mm256_sub_ps(_mm256_mul_ps(p[0], q[1]), _mm256_mul_ps(p[1], q[0])) }
}

/// The first and the last crossing of a triangle's vertices along an axis, from their coordinates. Rounding doesn't change
/// an order, so that these are the crossings of its box' planes by `slab.rs`.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn crossings(r: &LocalRay, axis: usize, of: &[__m256; 3]) -> [__m256; 2] {
    // SAFETY: the caller's promise; `LocalRay` gives offsets of one of three numbers.
    unsafe {
        let number = usize::from(r.rows[axis]) / (usize::from(ROW) / size_of::<f32>());
        let inv = _mm256_set1_ps(*(&raw const r.inv).cast::<f32>().byte_add(number));
        let a = _mm256_mul_ps(of[0], inv);
        let b = _mm256_mul_ps(of[1], inv);
        let c = _mm256_mul_ps(of[2], inv);
        [_mm256_min_ps(_mm256_min_ps(a, b), c), _mm256_max_ps(_mm256_max_ps(a, b), c)]
    }
}

/// [`Kernel::inside`](super::Kernel::inside).
///
/// # Safety
/// The processor must have AVX2 and what `P` needs.
#[inline(always)]
pub(super) unsafe fn inside<P: Pick>(r: &LocalRay, block: &Block) -> u32 {
    // SAFETY: the caller's promise.
    unsafe { Crossing::new::<P>(r, block).inside }
}

/// [`Kernel::block`](super::Kernel::block).
///
/// # Safety
/// The processor must have AVX2 and what `P` needs.
#[inline(always)]
pub(super) unsafe fn block<P: Pick>(r: &LocalRay, block: &Block, limit: f32) -> Lanes {
    let mut out = Lanes::NONE;
    // SAFETY: the caller's promise; eight numbers are written to arrays of eight.
    unsafe {
        let crossing = Crossing::new::<P>(r, block);
        if crossing.inside == 0 {
            return out;
        }
        let Crossing { xy: [a, b, c], edges: [u, v, w], on_edge, inside, .. } = crossing;
        let zero = _mm256_setzero_ps();
        let det = _mm256_add_ps(_mm256_add_ps(u, v), w);
        let off = _mm256_set1_ps(-0.0);
        let size = |x| _mm256_andnot_ps(off, x);
        let reach = _mm256_max_ps(size(a[0]), size(a[1]));
        let reach = _mm256_max_ps(reach, _mm256_max_ps(size(b[0]), size(b[1])));
        let reach = _mm256_max_ps(reach, _mm256_max_ps(size(c[0]), size(c[1])));
        let enough = _mm256_mul_ps(_mm256_mul_ps(reach, reach), _mm256_set1_ps(FLAT));
        let enough = _mm256_max_ps(enough, _mm256_set1_ps(LEAST_DETERMINANT));
        let z = crossing.along::<P>(2);
        let depth = _mm256_add_ps(_mm256_mul_ps(u, z[0]), _mm256_mul_ps(v, z[1]));
        let depth = _mm256_add_ps(depth, _mm256_mul_ps(w, z[2]));
        let numerator = _mm256_mul_ps(depth, _mm256_set1_ps(r.shear[2]));
        let enough = _mm256_add_ps(enough, _mm256_mul_ps(_mm256_add_ps(numerator, det), zero));
        let flat = _mm256_cmp_ps::<_CMP_NGE_UQ>(size(det), enough);
        out.doubtful = _mm256_movemask_ps(_mm256_or_ps(on_edge, flat)) as u32 & inside;
        let t = _mm256_div_ps(numerator, det);
        let late = _mm256_cmp_ps::<_CMP_GE_OQ>(t, _mm256_set1_ps(r.ray.t_min));
        let early = _mm256_cmp_ps::<_CMP_LE_OQ>(t, _mm256_set1_ps(limit));
        out.hit = _mm256_movemask_ps(_mm256_and_ps(late, early)) as u32 & inside & !out.doubtful;
        let [enter_x, exit_x] = crossings(r, 0, &crossing.along::<P>(0));
        let [enter_y, exit_y] = crossings(r, 1, &crossing.along::<P>(1));
        let [enter_z, exit_z] = crossings(r, 2, &z);
        let enter = _mm256_max_ps(_mm256_max_ps(enter_x, enter_y), enter_z);
        let exit = _mm256_min_ps(_mm256_min_ps(exit_x, exit_y), exit_z);
        let past = _mm256_cmp_ps::<_CMP_LE_OQ>(enter, t);
        let before = _mm256_cmp_ps::<_CMP_LE_OQ>(t, exit);
        out.boxed = _mm256_movemask_ps(_mm256_and_ps(past, before)) as u32;
        _mm256_storeu_ps(out.t.as_mut_ptr(), t);
        _mm256_storeu_ps(out.det.as_mut_ptr(), det);
        _mm256_storeu_ps(out.e1.as_mut_ptr(), v);
        _mm256_storeu_ps(out.e2.as_mut_ptr(), w);
        out
    }
}

const _: () = assert!(WIDTH == 8);
