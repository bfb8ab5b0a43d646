//! Four lanes of NEON, twice.
//!
//! Every lane does the operations of `slab.rs` and `triangle.rs` in their order. The least and the greatest of two are
//! taken by comparing, since NEON's own give NaN where one of them is NaN, and the other kernels the second.
//!
//! Safety: a [`Neon`] is made only where the processor has NEON.

use super::{Children, Kernel, Lanes, NOT_ENTERED, entry::entry_points};
use crate::{
    local::LocalRay,
    node::{Block, Node},
    triangle::{FLAT, LEAST_DETERMINANT},
};
use std::arch::aarch64::*;
use straal_math::simd::Simd;

/// The proof that the processor has NEON.
#[derive(Clone, Copy)]
pub(crate) struct Neon(());

impl Neon {
    pub fn new() -> Option<Self> {
        crate::Isa::Neon.is_available().then_some(Self(()))
    }
}

impl Kernel for Neon {
    #[inline(always)]
    fn chosen(self) -> super::Chosen {
        super::Chosen::Neon(self)
    }

    #[inline(always)]
    fn simd(self) -> Simd {
        Simd::new(crate::Isa::Neon).unwrap_or(Simd::PLAIN)
    }

    #[inline(always)]
    fn node(self, r: &LocalRay, node: &Node, limit: f32) -> Children {
        let mut out = Children::NONE;
        for half in [0, 4] {
            // SAFETY: see the head of the file. `half` is at most 4, so that four numbers from there are inside.
            unsafe {
                let [x, y, z] = r.neg.map(|n| usize::from(n & 1));
                let near = |axis, side| vmulq_n_f32(from(r, node, axis, side, half), r.inv[axis]);
                let far = |axis, side| vmulq_n_f32(from(r, node, axis, side ^ 1, half), r.far[axis]);
                let enter = more(more(near(0, x), near(1, y)), near(2, z));
                let enter = more(enter, vdupq_n_f32(r.ray.t_min));
                let exit = earliest(earliest(far(0, x), far(1, y)), far(2, z));
                let exit = earliest(exit, vdupq_n_f32(limit));
                let entered = vcleq_f32(enter, exit);
                out.mask |= mask(entered) << half;
                let lanes = vaddq_u32(vld1q_u32(LANES.as_ptr()), vdupq_n_u32(half as u32));
                let key = vorrq_u32(vbicq_u32(vreinterpretq_u32_f32(enter), vdupq_n_u32(7)), lanes);
                let key = vbslq_u32(entered, key, vdupq_n_u32(NOT_ENTERED));
                vst1q_u32(out.keys.as_mut_ptr().add(half), key);
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
        // SAFETY: see the head of the file. 0 and 4 are at most 4.
        let all = unsafe {
            mask(Crossing::new(r, block, 0).inside()) | mask(Crossing::new(r, block, 4).inside()) << 4
        };
        all & block.lanes()
    }

    #[inline(always)]
    fn block(self, r: &LocalRay, block: &Block, limit: f32) -> Lanes {
        let mut out = Lanes::NONE;
        for half in [0, 4] {
            // SAFETY: see the head of the file. `half` is at most 4, so that four numbers from there are inside.
            unsafe {
                let crossing = Crossing::new(r, block, half);
                let inside = mask(crossing.inside()) & block.lanes() >> half;
                if inside == 0 {
                    continue;
                }
                let Crossing { moved, a, b, c, edges: [u, v, w], least, most } = crossing;
                let zero = vdupq_n_f32(0.0);
                let on_edge = vorrq_u32(vceqq_f32(least, zero), vceqq_f32(most, zero));
                let det = vaddq_f32(vaddq_f32(u, v), w);
                let reach = more(vabsq_f32(a[0]), vabsq_f32(a[1]));
                let reach = more(reach, more(vabsq_f32(b[0]), vabsq_f32(b[1])));
                let reach = more(reach, more(vabsq_f32(c[0]), vabsq_f32(c[1])));
                let enough = vmulq_f32(vmulq_f32(reach, reach), vdupq_n_f32(FLAT));
                let enough = more(enough, vdupq_n_f32(LEAST_DETERMINANT));
                let depth = vaddq_f32(vmulq_f32(u, a[2]), vmulq_f32(v, b[2]));
                let depth = vaddq_f32(depth, vmulq_f32(w, c[2]));
                let numerator = vmulq_f32(depth, vdupq_n_f32(r.shear[2]));
                let enough = vaddq_f32(enough, vmulq_f32(vaddq_f32(numerator, det), zero));
                let flat = vmvnq_u32(vcgeq_f32(vabsq_f32(det), enough));
                let doubtful = mask(vorrq_u32(on_edge, flat)) & inside;
                let t = vdivq_f32(numerator, det);
                let late = vcgeq_f32(t, vdupq_n_f32(r.ray.t_min));
                let within = mask(vandq_u32(late, vcleq_f32(t, vdupq_n_f32(limit))));
                out.doubtful |= doubtful << half;
                out.hit |= (within & inside & !doubtful) << half;
                out.boxed |= boxed(r, &moved, t) << half;
                vst1q_f32(out.t.as_mut_ptr().add(half), t);
                vst1q_f32(out.det.as_mut_ptr().add(half), det);
                vst1q_f32(out.e1.as_mut_ptr().add(half), v);
                vst1q_f32(out.e2.as_mut_ptr().add(half), w);
            }
        }
        out
    }

    entry_points!("neon");
}

static LANES: [u32; 4] = [0, 1, 2, 3];
static BITS: [u32; 4] = [1, 2, 4, 8];

/// One bit for each lane that has all bits.
///
/// # Safety
/// The processor must have NEON.
#[inline(always)]
unsafe fn mask(lanes: uint32x4_t) -> u32 {
    // SAFETY: the caller's promise; four numbers are read from an array of four.
    unsafe { vaddvq_u32(vandq_u32(lanes, vld1q_u32(BITS.as_ptr()))) }
}

/// # Safety
/// The processor must have NEON.
#[inline(always)]
unsafe fn more(a: float32x4_t, b: float32x4_t) -> float32x4_t {
    // SAFETY: the caller's promise.
    unsafe { vbslq_f32(vcgtq_f32(a, b), a, b) }
}

/// # Safety
/// The processor must have NEON.
#[inline(always)]
unsafe fn less(a: float32x4_t, b: float32x4_t) -> float32x4_t {
    // SAFETY: the caller's promise.
    unsafe { vbslq_f32(vcltq_f32(a, b), a, b) }
}

/// `scalar::earliest` in four lanes.
///
/// # Safety
/// The processor must have NEON.
#[inline(always)]
unsafe fn earliest(a: float32x4_t, b: float32x4_t) -> float32x4_t {
    // SAFETY: the caller's promise.
    unsafe { vreinterpretq_f32_s32(vminq_s32(vreinterpretq_s32_f32(a), vreinterpretq_s32_f32(b))) }
}

/// A plane of four boxes, from the ray's origin.
///
/// # Safety
/// The processor must have NEON, and `half` be at most 4.
#[inline(always)]
unsafe fn from(r: &LocalRay, node: &Node, axis: usize, side: usize, half: usize) -> float32x4_t {
    // SAFETY: the caller's promise; four numbers are read from within an array of eight.
    unsafe {
        let b = vld1q_f32(node.planes[2 * axis + (side & 1)].as_ptr().add(half));
        vsubq_f32(b, vdupq_n_f32(r.ray.o[axis]))
    }
}

/// The vertices of four triangles along the axes of the sheared space, moved to the ray's origin.
///
/// # Safety
/// The processor must have NEON, and `half` be 0 or 4.
#[inline(always)]
unsafe fn moved(r: &LocalRay, block: &Block, half: usize) -> [[float32x4_t; 3]; 3] {
    // SAFETY: the caller's promise; four numbers are read from arrays of at least four from there.
    unsafe {
        let [x, y, z] = r.axes();
        let rows = [(x, 0), (y, 1), (z, 2)].map(|(row, axis)| {
            let places = &block.rows[row % 3].places;
            let moved = |from: usize| {
                let four = vld1q_f32(places.as_ptr().add(from));
                vreinterpretq_u8_f32(vsubq_f32(four, vdupq_n_f32(r.origin[axis])))
            };
            uint8x16x3_t(moved(0), moved(4), moved(8))
        });
        [0, 1, 2].map(|corner: usize| {
            let corners = vdupq_n_u32(block.rows[corner].corners >> (4 * half));
            let vertices = vandq_u32(vshlq_u32(corners, vld1q_s32(SHIFTS.as_ptr())), vdupq_n_u32(15));
            // A vertex' number four times over is where it begins in bytes, and so on for its other bytes.
            let bytes = vmlaq_n_u32(vdupq_n_u32(0x0302_0100), vertices, 0x0404_0404);
            rows.map(|row| vreinterpretq_f32_u8(vqtbl3q_u8(row, vreinterpretq_u8_u32(bytes))))
        })
    }
}

static SHIFTS: [i32; 4] = [0, -4, -8, -12];

/// The same vertex sheared.
///
/// # Safety
/// The processor must have NEON.
#[inline(always)]
unsafe fn sheared(r: &LocalRay, [x, y, z]: &[float32x4_t; 3]) -> [float32x4_t; 3] {
    // SAFETY: the caller's promise.
    unsafe {
        let x = vsubq_f32(*x, vmulq_f32(vdupq_n_f32(r.shear[0]), *z));
        let y = vsubq_f32(*y, vmulq_f32(vdupq_n_f32(r.shear[1]), *z));
        [x, y, *z]
    }
}

/// The lanes in which `t` lies in the triangle's own box, see [`Lanes::boxed`], from its moved vertices. Rounding doesn't
/// change an order, so that the first and the last crossing of vertices are those of the box' planes.
///
/// # Safety
/// The processor must have NEON.
#[inline(always)]
unsafe fn boxed(r: &LocalRay, [a, b, c]: &[[float32x4_t; 3]; 3], t: float32x4_t) -> u32 {
    // SAFETY: the caller's promise.
    unsafe {
        let (mut enter, mut exit) = (vdupq_n_f32(f32::NEG_INFINITY), vdupq_n_f32(f32::INFINITY));
        for (i, axis) in r.axes().into_iter().enumerate() {
            let inv = r.inv[axis];
            let (a, b, c) = (vmulq_n_f32(a[i], inv), vmulq_n_f32(b[i], inv), vmulq_n_f32(c[i], inv));
            enter = more(enter, less(less(a, b), c));
            exit = less(exit, more(more(a, b), c));
        }
        mask(vandq_u32(vcleq_f32(enter, t), vcleq_f32(t, exit)))
    }
}

/// Edge functions of the edges from `q` to `p`.
///
/// # Safety
/// The processor must have NEON.
#[inline(always)]
unsafe fn edge(p: &[float32x4_t; 3], q: &[float32x4_t; 3]) -> float32x4_t {
    // SAFETY: the caller's promise.
    unsafe { vsubq_f32(vmulq_f32(p[0], q[1]), vmulq_f32(p[1], q[0])) }
}

/// Four triangles as `triangle::edges` has one.
struct Crossing {
    /// The vertices along the axes of the sheared space, moved to the ray's origin.
    moved: [[float32x4_t; 3]; 3],
    a: [float32x4_t; 3],
    b: [float32x4_t; 3],
    c: [float32x4_t; 3],
    edges: [float32x4_t; 3],
    least: float32x4_t,
    most: float32x4_t,
}

impl Crossing {
    /// # Safety
    /// The processor must have NEON, and `half` be at most 4.
    #[inline(always)]
    unsafe fn new(r: &LocalRay, block: &Block, half: usize) -> Self {
        // SAFETY: the caller's promise.
        unsafe {
            let moved @ [a, b, c] = moved(r, block, half);
            let (a, b, c) = (sheared(r, &a), sheared(r, &b), sheared(r, &c));
            let edges @ [u, v, w] = [edge(&c, &b), edge(&a, &c), edge(&b, &a)];
            Self { moved, a, b, c, edges, least: less(u, less(v, w)), most: more(u, more(v, w)) }
        }
    }

    /// All bits of the lanes in which no two signs differ.
    ///
    /// # Safety
    /// The processor must have NEON.
    #[inline(always)]
    unsafe fn inside(&self) -> uint32x4_t {
        // SAFETY: the caller's promise.
        unsafe {
            let zero = vdupq_n_f32(0.0);
            vorrq_u32(vcgeq_f32(self.least, zero), vcleq_f32(self.most, zero))
        }
    }
}
