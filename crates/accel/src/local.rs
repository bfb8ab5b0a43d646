//! A ray in the space of one group, with what every test there needs.

use straal_math::{Ray, Vec3};

/// A valid ray in a group's space. Computed once a level; scalar code and vector kernels read the same numbers.
///
/// What tests of boxes read comes first, then what tests of triangles read.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub(crate) struct LocalRay {
    /// The ray with its interval cut to finite numbers from 0 on: a hit never lies at infinity or behind the origin.
    pub ray: Ray,
    /// 255 where `inv` is negative, else 0: which of a box' two planes on each axis comes first.
    pub neg: [u8; 3],
    /// The same in the lowest three bits.
    pub octant: u8,
    /// 1 / d, kept finite so that 0 times it is never NaN.
    pub inv: Vec3,
    /// `inv` for the far planes of nodes: times [`NODE_EXIT`].
    pub far: [f32; 3],
    /// The origin along the axes x, y, z of the sheared space of `triangle.rs`.
    pub origin: [f32; 3],
    /// Shear and scale: d[x] / d[z], d[y] / d[z], 1 / d[z].
    pub shear: [f32; 3],
    /// Where the coordinates along these axes stand in a block, in bytes; the last is 0.
    pub rows: [u8; 4],
}

/// As `slab::EXIT` for the boxes of wide nodes, whose far planes are crossed with a reciprocal direction that is raised by this
/// beforehand: what leaves a box late enough is to leave the nodes around it late enough. A raised reciprocal is off by up to
/// 2 epsilon (it is never below 2^21 units in the last place, where numbers are subnormal). A crossing x is off by half a unit
/// more than a box' there, and that box' raised one by half a unit again; from 2^18 units on, below which `slab::EXIT` changes
/// nothing, 48 epsilon x make up for that.
pub(crate) const NODE_EXIT: f32 = 1.0 + 72.0 * f32::EPSILON;

/// A direction's coordinate below this counts as this when box planes are crossed: the reciprocal stays finite.
pub(crate) const LEAST: f32 = 1e-37;

impl LocalRay {
    /// Some ray, to be overwritten.
    pub const IDLE: Self = Self {
        ray: Ray::new(Vec3::ZERO, Vec3::X),
        neg: [0; 3],
        octant: 0,
        inv: Vec3::ONE,
        far: [0.0; 3],
        origin: [0.0; 3],
        shear: [0.0; 3],
        rows: [0; 4],
    };

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
        let octant = (0..3).fold(0, |bits, axis| bits | usize::from(inv[axis] < 0.0) << axis);
        let local = Self {
            ray: Ray { t_min, t_max, ..*r },
            neg: NEG[octant],
            octant: octant as u8,
            inv: Vec3::from_array(inv),
            far: inv.map(|x| x * NODE_EXIT),
            origin: [o[x], o[y], o[z]],
            shear: [d[x] * scale, d[y] * scale, scale],
            rows: [x as u8 * ROW, y as u8 * ROW, z as u8 * ROW, 0],
        };
        (local, is_valid)
    }

    /// The axes x, y, z of the sheared space of `triangle.rs`.
    #[inline(always)]
    pub fn axes(&self) -> [usize; 3] {
        let [x, y, z, _] = self.rows.map(|row| usize::from(row / ROW));
        [x, y, z]
    }
}

/// [`LocalRay::neg`] by octant.
pub(crate) static NEG: [[u8; 3]; 8] = {
    let mut out = [[0; 3]; 8];
    let mut i = 0;
    while i < 24 {
        out[i / 3][i % 3] = if (i / 3) >> (i % 3) & 1 == 1 { 255 } else { 0 };
        i += 1;
    }
    out
};

/// Bytes of one coordinate of the vertices of a block: a cache line.
pub(crate) const ROW: u8 = 64;

/// The axis after, in a circle: after axis z come x = `NEXT[z]` and y = `NEXT[z + 1]`.
const NEXT: [usize; 4] = [1, 2, 0, 1];
