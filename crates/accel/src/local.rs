//! A ray in the space of one group, with what every test there needs.

use crate::{bvh::WIDTH, slab::loosened};
use straal_math::{Ray, Vec3};

/// A valid ray in a group's space. Computed once a level; scalar code and vector kernels read the same numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRay {
    /// The ray with its interval cut to finite numbers from 0 on: a hit never lies at infinity or behind the origin.
    pub ray: Ray,
    /// 1 / d, kept finite so that 0 times it is never NaN.
    pub inv: Vec3,
    /// `t_min`, raised to [`LEAST_ENTRY`]: where the ray enters a node that it starts in.
    pub enter: f32,
    /// `t_max`, loosened: nodes entered later hold no hit.
    pub leave: f32,
    /// 1 where `inv` is negative, else 0: which of a box' two planes on each axis comes first.
    pub neg: [u8; 3],
    /// Where the near planes of each axis stand in a node, in bytes: what vector kernels read instead of `neg`.
    near: [u32; 3],
    /// The axes x, y, z of the sheared space of `triangle.rs`.
    pub axes: [u8; 3],
    /// Where the coordinates of `axes` stand in a vertex of a block, in bytes.
    rows: [u32; 3],
    /// The origin along `axes`.
    pub origin: [f32; 3],
    /// Shear and scale: d[x] / d[z], d[y] / d[z], 1 / d[z].
    pub shear: [f32; 3],
}

/// No node is entered earlier than this, the ninth smallest float above 0, so that the bits of an entry, with the lowest
/// three replaced, are never 0. What starts in a node's padded box leaves it later.
pub(crate) const LEAST_ENTRY: f32 = f32::from_bits(8);

/// A direction's coordinate below this counts as this when box planes are crossed: the reciprocal stays finite.
const LEAST: f32 = 1e-37;

impl LocalRay {
    /// `None` when the ray misses everything because it isn't valid.
    #[inline(always)]
    pub fn new(r: &Ray) -> Option<Self> {
        let (local, is_valid) = Self::prepare(r);
        is_valid.then_some(local)
    }

    /// The same, of no use when the ray isn't valid; without branches, so that several can be made side by side.
    #[inline(always)]
    pub fn prepare(r: &Ray) -> (Self, bool) {
        let t_min = if r.t_min > 0.0 { r.t_min } else { 0.0 };
        let t_max = if r.t_max > f32::MAX { f32::MAX } else { r.t_max };
        // Zero times what isn't finite is NaN.
        let zeros = r.o * 0.0 + r.d * 0.0;
        let is_valid = (zeros.x + zeros.y + zeros.z == 0.0)
            & ((r.d.x != 0.0) | (r.d.y != 0.0) | (r.d.z != 0.0))
            & (r.t_min <= r.t_max)
            & (t_min <= t_max);
        let reciprocal = |d: f32| 1.0 / if d.abs() > LEAST { d } else { LEAST.copysign(d) };
        let inv = [reciprocal(r.d.x), reciprocal(r.d.y), reciprocal(r.d.z)];
        // The dominant axis becomes z; a negative one swaps the others, so that the winding stays.
        let (o, d) = (r.o.to_array(), r.d.to_array());
        let (ax, ay, az) = (d[0].abs(), d[1].abs(), d[2].abs());
        let over_x = usize::from(ay > ax) | (usize::from((az > ax) & (az > ay)) << 1);
        let z = if over_x > 2 { 2 } else { over_x };
        let back = usize::from(d[z] < 0.0);
        let (x, y) = (NEXT[z + back], NEXT[z + 1 - back]);
        let scale = if d[z].abs() > LEAST { inv[z] } else { 1.0 / d[z] };
        let neg = inv.map(|i| u8::from(i < 0.0));
        let local = Self {
            ray: Ray { t_min, t_max, ..*r },
            inv: Vec3::from_array(inv),
            enter: if t_min > LEAST_ENTRY { t_min } else { LEAST_ENTRY },
            leave: loosened(t_max),
            neg,
            near: std::array::from_fn(|axis| (2 * axis as u32 + u32::from(neg[axis])) * ROW),
            axes: [x as u8, y as u8, z as u8],
            rows: [x as u32 * ROW, y as u32 * ROW, z as u32 * ROW],
            origin: [o[x], o[y], o[z]],
            shear: [d[x] * scale, d[y] * scale, scale],
        };
        (local, is_valid)
    }
}

/// Bytes of one number for each slot of a node, or each triangle of a block.
const ROW: u32 = (WIDTH * size_of::<f32>()) as u32;

impl LocalRay {
    /// Where the near planes of an axis stand in a node, in bytes: one of its six rows.
    #[inline(always)]
    pub fn near_row(&self, axis: usize) -> usize {
        self.near[axis] as usize
    }

    /// The same of the far planes: the rows of an axis are a pair.
    #[inline(always)]
    pub fn far_row(&self, axis: usize) -> usize {
        (self.near[axis] ^ ROW) as usize
    }

    /// Where the coordinates along one of `axes` stand in a vertex of a block, in bytes: one of its three rows.
    #[inline(always)]
    pub fn vertex_row(&self, axis: usize) -> usize {
        self.rows[axis] as usize
    }
}

/// The axis after, in a circle: after axis z come x = `NEXT[z]` and y = `NEXT[z + 1]`.
const NEXT: [usize; 4] = [1, 2, 0, 1];
