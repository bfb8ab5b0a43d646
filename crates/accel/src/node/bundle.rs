//! What is known of a packet's rays together: a node's boxes are tested against intervals of their origins and reciprocal
//! directions (Boulos, Wald and Shirley 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets"), which tells
//! with one test what all rays miss.
//!
//! Interval arithmetic here is that of `slab.rs` on the intervals' ends. Its roundings are monotone, so that the bounds
//! hold for each ray's own rounded crossings without any slack.

use super::{Node, WIDTH};
use crate::{local::LocalRay, slab::EXIT};

/// Rays in a packet.
pub(crate) const PACKET: usize = 64;

/// Rays are tested in groups of eight.
pub(crate) const GROUPS: usize = PACKET / WIDTH;

/// A number for each of eight boxes or rays.
pub(crate) type Lanes = [f32; WIDTH];

/// Bounds of all rays of a packet along one axis.
#[derive(Clone, Copy)]
pub(crate) struct AxisBounds {
    /// The origin from which near planes are crossed first, and the one from which far planes are crossed last.
    pub near_o: f32,
    pub far_o: f32,
    pub inv: [f32; 2],
    /// Which of a box' two planes is the near one: 0 or 1.
    pub near: usize,
}

/// The rays. Numbers of one kind lie together, to be tested eight at a time.
#[repr(C, align(32))]
pub(crate) struct Bundle {
    pub o: [[Lanes; GROUPS]; 3],
    pub inv: [[Lanes; GROUPS]; 3],
    pub enter: [Lanes; GROUPS],
    /// What is entered beyond this is left out; negative where the search is over.
    pub limit: [Lanes; GROUPS],
    pub axes: [AxisBounds; 3],
    /// The earliest of all.
    pub first: f32,
}

#[inline(always)]
fn less(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn more(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn least(all: &[Lanes]) -> f32 {
    let lanes = all.iter().fold([f32::INFINITY; WIDTH], |a, b| std::array::from_fn(|i| less(a[i], b[i])));
    lanes.into_iter().fold(f32::INFINITY, less)
}

#[inline(always)]
fn most(all: &[Lanes]) -> f32 {
    let lanes = all.iter().fold([f32::NEG_INFINITY; WIDTH], |a, b| std::array::from_fn(|i| more(a[i], b[i])));
    lanes.into_iter().fold(f32::NEG_INFINITY, more)
}

impl Bundle {
    pub const EMPTY: Self = Self {
        o: [[[0.0; WIDTH]; GROUPS]; 3],
        inv: [[[0.0; WIDTH]; GROUPS]; 3],
        enter: [[0.0; WIDTH]; GROUPS],
        limit: [[-1.0; WIDTH]; GROUPS],
        axes: [AxisBounds { near_o: 0.0, far_o: 0.0, inv: [0.0; 2], near: 0 }; 3],
        first: 0.0,
    };

    /// Takes a ray and its limit.
    #[inline(always)]
    pub fn set(&mut self, ray: usize, local: &LocalRay, limit: f32) {
        let (group, lane) = (ray / WIDTH % GROUPS, ray % WIDTH);
        for axis in 0..3 {
            self.o[axis][group][lane] = local.ray.o[axis];
            self.inv[axis][group][lane] = local.inv[axis];
        }
        self.enter[group][lane] = local.ray.t_min;
        self.limit[group][lane] = limit;
    }

    /// Finds the bounds, when all rays are there; `some` is one of them.
    #[inline(always)]
    pub fn bound(&mut self, some: &LocalRay) {
        self.axes = std::array::from_fn(|axis| {
            let (low, high) = (least(&self.o[axis]), most(&self.o[axis]));
            let inv = [least(&self.inv[axis]), most(&self.inv[axis])];
            let near = usize::from(some.neg[axis] & 1);
            let (near_o, far_o) = if near == 0 { (high, low) } else { (low, high) };
            AxisBounds { near_o, far_o, inv, near }
        });
        self.first = least(&self.enter);
    }

    #[inline(always)]
    pub const fn set_limit(&mut self, ray: usize, limit: f32) {
        self.limit[ray / WIDTH % GROUPS][ray % WIDTH] = limit;
    }

    /// The latest limit of all rays; negative when all searches are over.
    #[inline(always)]
    pub fn limit(&self) -> f32 {
        most(&self.limit)
    }

    /// Boxes that some ray may enter no later than `limit`, and earliest entries.
    pub fn entries(&self, node: &Node, limit: f32) -> (u32, Lanes) {
        let (mut mask, mut entries) = (0, [0.0; WIDTH]);
        for (lane, entry) in entries.iter_mut().enumerate() {
            let (mut enter, mut exit) = (self.first, f32::INFINITY);
            for (axis, a) in self.axes.iter().enumerate() {
                let near = node.planes[2 * axis + (a.near & 1)][lane] - a.near_o;
                let far = node.planes[2 * axis + (a.near & 1 ^ 1)][lane] - a.far_o;
                enter = more(less(near * a.inv[0], near * a.inv[1]), enter);
                exit = less(more(far * a.inv[0], far * a.inv[1]), exit);
            }
            mask |= u32::from(enter <= less(exit * EXIT, limit)) << lane;
            *entry = enter;
        }
        (mask, entries)
    }

    /// The rays that enter a child's box.
    pub fn entering(&self, node: &Node, slot: usize) -> u64 {
        let enters = |ray: usize| {
            let (group, lane) = (ray / WIDTH, ray % WIDTH);
            let (mut enter, mut exit) = (self.enter[group][lane], f32::INFINITY);
            for (axis, a) in self.axes.iter().enumerate() {
                let near = node.planes[2 * axis + (a.near & 1)][slot];
                let far = node.planes[2 * axis + (a.near & 1 ^ 1)][slot];
                let (o, inv) = (self.o[axis][group][lane], self.inv[axis][group][lane]);
                enter = more((near - o) * inv, enter);
                exit = less((far - o) * inv, exit);
            }
            enter <= less(exit * EXIT, self.limit[group][lane])
        };
        (0..PACKET).map(|ray| u64::from(enters(ray)) << ray).sum()
    }
}
