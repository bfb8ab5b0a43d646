//! What the partitions of space (kd-tree, octree, BSP tree) share: why none of them loses a hit, and how none of them
//! grows without end.
//!
//! # Exactness
//! A textbook's partition believes a hit only inside of the cell in which it was found. Here a hit has to be that of
//! brute force to the last bit, and float arithmetic has no opinion on which side of a plane a hit *on* it lies. So
//! no hit is ever refused, and a search stops only when the best t is below all that is unvisited. What is to be
//! proved is that the search comes to a leaf with the primitive soon enough. Call the **moment** of a primitive the
//! ray parameter m at which it is entered: the later of `slab::entry` of its padded box and `t_min`. Brute force
//! counts a hit only when the ray crosses that box, and raises its t to the entry, so that
//!
//! 1. m <= t, and m lies in `[t_min, t_max]`;
//! 2. on each axis the crossing `(b - o) * inv` of the box' near plane is at most m, and that of the far plane, where
//!    positive multiplied by `slab::EXIT`, at least m.
//!
//! A search carries for each cell an interval `[a, b]` of ray parameters, and visits a cell unless the interval is
//! empty or a > best t. It holds for the root, which contains every box, that a <= m <= b: crossings are monotone in
//! the plane's coordinate, in any rounding, and [`late`] is at least `slab`'s factor. Let a plane at s on some axis
//! cut a cell whose interval has the moment, and t_s = `(s - o) * inv` be its crossing. The near child gets `[a,
//! min(b, late(t_s))]`, the far child `[max(a, early(t_s)), b]`.
//! - The box lies on the near side: its far plane isn't beyond s, so that m <= `late` of its crossing <=
//!   `late(t_s)`. The near child's interval has the moment.
//! - The box lies on the far side: `early(t_s)` <= t_s <= the crossing of its near plane <= m. The far child's has
//!   it.
//! - The primitive is in both children. The two intervals overlap and cover `[a, b]`, so that one of them has the
//!   moment.
//!
//! By induction there is a leaf that holds the primitive and whose interval, like those of all cells above it, has
//! the moment. It isn't visited only when some a > best t; then t >= m >= a > best t, and the primitive doesn't
//! matter. A box that merely touches the plane may go to either side or both. Octrees cut three times at once. Planes
//! that aren't axis-aligned have their own crossings, in `bsp/plane.rs`, with the same conclusion.
//!
//! # Bounded size
//! A primitive can lie in many leaves. Each subtree has a [`Budget`] of references, which it shares out to its
//! children; where it doesn't suffice, the subtree ends in a leaf.

use crate::{
    local::LocalRay,
    prim::{Packed, Prim},
};
use std::collections::BTreeMap;
use straal_math::{Bounds, Vec3, ops};

/// How far, relative to itself, a crossing is moved each way. `slab` moves exits by 16 units in the last place; the
/// rest is for clipped boxes (`clip.rs`), whose hits lie within a few units more.
const SLACK: f32 = 64.0 * f32::EPSILON;

/// A ray parameter that is before `t` by more than the arithmetic is off.
#[inline(always)]
pub(crate) fn early(t: f32) -> f32 {
    ops::min(t * (1.0 - SLACK), t * (1.0 + SLACK))
}

/// A ray parameter that is after `t` by more than the arithmetic is off.
#[inline(always)]
pub(crate) fn late(t: f32) -> f32 {
    ops::max(t * (1.0 - SLACK), t * (1.0 + SLACK))
}

/// The interval of ray parameters in which the moments of all primitives inside a box lie, if there can be any.
#[inline(always)]
pub(crate) fn interval(b: &Bounds, r: &LocalRay) -> Option<(f32, f32)> {
    let (mut enter, mut exit) = (r.ray.t_min, r.ray.t_max);
    for axis in 0..3 {
        let (low, high) = (crossing(b.min[axis], axis, r), crossing(b.max[axis], axis, r));
        let (near, far) = if r.neg[axis] == 0 { (low, high) } else { (high, low) };
        enter = ops::max(enter, early(near));
        exit = ops::min(exit, late(far));
    }
    (enter <= exit).then_some((enter, exit))
}

/// Where a ray crosses a plane at right angles to an axis: the very operations of `slab`.
#[inline(always)]
pub(crate) fn crossing(plane: f32, axis: usize, r: &LocalRay) -> f32 {
    (plane - r.ray.o[axis]) * r.inv[axis]
}

/// Around all boxes, cut to finite numbers: where planes are looked for and areas are measured. (The boxes of huge
/// primitives can be infinite.)
pub(crate) fn finite(b: &Bounds) -> Bounds {
    let cut = |v: Vec3| Vec3::from_array(v.to_array().map(|x| ops::clamp(x, f32::MIN, f32::MAX)));
    Bounds { min: cut(b.min), max: cut(b.max) }
}

/// Half the surface area in double precision, in which it never overflows; 0 for an empty box.
pub(crate) fn half_area(b: &Bounds) -> f64 {
    if b.is_empty() {
        return 0.0;
    }
    let e = finite(b);
    let [x, y, z] = [0, 1, 2].map(|axis| f64::from(e.max[axis]) - f64::from(e.min[axis]));
    x * y + y * z + z * x
}

/// The part of `whole`'s area that is `part`'s: how likely a line through the one meets the other.
pub(crate) fn chance(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 1.0 }
}

/// How many references and empty leaves a subtree may consist of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget(usize);

impl Budget {
    /// References for each primitive.
    const FACTOR: usize = 16;

    /// So much more for small trees.
    const LEAST: usize = 1024;

    /// The most, so that indices fit into 32 bits.
    const MOST: usize = 1 << 31;

    /// For a tree of `n` primitives.
    pub fn of(n: usize) -> Self {
        Self(n.saturating_mul(Self::FACTOR).saturating_add(Self::LEAST).min(Self::MOST))
    }

    /// Shares for children with that many primitives, in proportion; `None` when it doesn't suffice for them.
    pub fn share<const N: usize>(self, counts: [usize; N]) -> Option<[Self; N]> {
        let needed: usize = counts.iter().map(|&n| n.max(1)).sum();
        let all: usize = counts.iter().sum();
        let spare = self.0.checked_sub(needed)?;
        // In 128 bits, since 2^31 times 2^34 is more than 64 can hold.
        let part = |n: usize| (spare as u128 * n as u128 / all.max(1) as u128) as usize;
        Some(counts.map(|n| Self(n.max(1) + part(n))))
    }
}

/// The most levels of any tree; see [`depth_limit`].
pub(crate) const MAX_DEPTH: u32 = 64;

/// The depth at which a binary tree over `n` primitives ends: what was asked for, or for 0 the usual 8 + 1.3 log2 n
/// (Havran 2000, "Heuristic Ray Shooting Algorithms").
pub(crate) fn depth_limit(asked: u32, n: usize) -> u32 {
    let auto = 8.0 + 1.3 * ops::log2(n.max(1) as f32);
    if asked == 0 { auto as u32 } else { asked }.min(MAX_DEPTH)
}

/// Which primitives are in leaves, for `validate`.
pub(crate) struct Census(BTreeMap<u32, bool>);

impl Census {
    pub fn new(prims: &[Prim]) -> Self {
        Self(prims.iter().map(|p| (p.kind.packed().number(), false)).collect())
    }

    /// Takes note of a leaf, which has to have all of the `needed`.
    pub fn leaf(&mut self, leaf: &[Packed], needed: &[Prim], depth: u32) -> Result<(), String> {
        for prim in leaf {
            *self.0.get_mut(&prim.number()).ok_or_else(|| format!("{:?} is unknown", prim.kind()))? = true;
        }
        match needed.iter().find(|p| !leaf.contains(&p.kind.packed())) {
            Some(p) => Err(format!("{:?} is missing in a leaf at depth {depth}", p.kind)),
            None if depth > MAX_DEPTH => Err(format!("depth {depth} is more than the stack can hold")),
            None => Ok(()),
        }
    }

    /// Whether every primitive was in a leaf.
    pub fn end(&self) -> Result<(), String> {
        match self.0.values().filter(|seen| !**seen).count() {
            0 => Ok(()),
            n => Err(format!("{n} primitives are in no leaf")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn early_and_late_enclose() {
        for t in [0.0, 1.0, -1.0, 3e-30, -7e12, f32::MAX, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(early(t) <= t && t <= late(t), "{t}");
        }
        assert!(late(1.0) >= crate::slab::EXIT);
    }

    #[test]
    fn shares_never_exceed_the_whole() {
        for (whole, counts) in [(5, [2, 3]), (100, [0, 7]), (101, [50, 49]), (1 << 31, [1 << 30, 1 << 30])] {
            let shares = Budget(whole).share(counts).unwrap();
            assert!(shares[0].0 + shares[1].0 <= whole);
            assert!(shares.iter().zip(counts).all(|(s, n)| s.0 >= n && s.0 >= 1));
        }
        assert!(Budget(4).share([2, 3]).is_none());
        assert!(Budget(7).share([0, 7]).is_none());
    }

    #[test]
    fn depths() {
        assert_eq!([0, 1, 1024, 1 << 20].map(|n| depth_limit(0, n)), [8, 8, 21, 34]);
        assert_eq!(depth_limit(1000, 5), MAX_DEPTH);
    }
}
