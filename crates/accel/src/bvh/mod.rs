//! A tree of boxes, eight wide, with blocks of up to eight triangles in its leaves.
//!
//! `build.rs` makes it from boxes alone, `traverse.rs` searches it with one ray, `many.rs` with a slice of them; the arithmetic is the kernels'.

mod build;
mod many;
pub mod params;
mod stats;
mod traverse;
mod validate;

use crate::structure::Prim;
use params::BvhParams;
use straal_math::{Bounds, Vec3};

/// Boxes in a node, triangles in a block.
pub(crate) const WIDTH: usize = 8;

/// Eight boxes and what is inside each: four cache lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Least x, greatest x, least y, ... of all children. Those of an empty slot can't be crossed.
    pub planes: [[f32; WIDTH]; 6],
    pub children: [Child; WIDTH],
}

impl Node {
    const EMPTY: Self = {
        let (least, most) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self { planes: [least, most, least, most, least, most], children: [Child(0); WIDTH] }
    };
}

impl Node {
    /// Boxes in it, for counting.
    fn count(&self) -> u32 {
        self.planes[0].iter().map(|&x| u32::from(x < f32::INFINITY)).sum()
    }

    /// The box of a child.
    fn bounds(&self, lane: usize) -> Bounds {
        let p = |plane: usize| self.planes[plane][lane];
        Bounds { min: Vec3::new(p(0), p(2), p(4)), max: Vec3::new(p(1), p(3), p(5)) }
    }
}

#[cfg(test)]
impl Node {
    /// A node of boxes alone, to test kernels.
    pub fn of_planes(planes: [[f32; WIDTH]; 6]) -> Self {
        Self { planes, ..Self::EMPTY }
    }
}

/// What a box contains: the highest two bits tell the kind, the others are an index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Child(u32);

/// The same, taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChildKind {
    Node(u32),
    Block(u32),
    Object(u32),
}

impl Child {
    const LEAF: u32 = 1 << 31;
    const OBJECT: u32 = 1 << 30;

    const fn node(i: u32) -> Self {
        Self(i)
    }

    const fn block(i: u32) -> Self {
        Self(i | Self::LEAF)
    }

    const fn object(i: u32) -> Self {
        Self(i | Self::LEAF | Self::OBJECT)
    }

    /// The same, where `nodes` and `blocks` stand before its own.
    const fn moved(self, nodes: u32, blocks: u32) -> Self {
        match self.kind() {
            ChildKind::Node(i) => Self::node(i + nodes),
            ChildKind::Block(i) => Self::block(i + blocks),
            ChildKind::Object(_) => self,
        }
    }

    #[inline(always)]
    const fn is_node(self) -> bool {
        self.0 & Self::LEAF == 0
    }

    #[inline(always)]
    const fn kind(self) -> ChildKind {
        let i = self.0 & (Self::OBJECT - 1);
        match (self.is_node(), self.0 & Self::OBJECT == 0) {
            (true, _) => ChildKind::Node(i),
            (false, true) => ChildKind::Block(i),
            (false, false) => ChildKind::Object(i),
        }
    }
}

/// Up to eight triangles, coordinate by coordinate: five cache lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Block {
    /// By vertex, then axis. NaN in an unused lane, which nothing hits.
    pub v: [[[f32; WIDTH]; 3]; 3],
    /// The triangles' numbers in the group; `u32::MAX` in an unused lane.
    pub id: [u32; WIDTH],
}

impl Block {
    const EMPTY: Self = Self { v: [[[f32::NAN; WIDTH]; 3]; 3], id: [u32::MAX; WIDTH] };

    #[inline(always)]
    pub fn vertices(&self, lane: usize) -> [Vec3; 3] {
        let at = |i: usize| Vec3::new(self.v[i][0][lane], self.v[i][1][lane], self.v[i][2][lane]);
        [at(0), at(1), at(2)]
    }

    /// Triangles in it, for counting.
    fn count(&self) -> u32 {
        self.id.iter().map(|&id| u32::from(id != u32::MAX)).sum()
    }
}

/// The tree.
pub(crate) struct Bvh {
    /// `None` when there is nothing to hit.
    root: Option<Child>,
    nodes: Vec<Node>,
    blocks: Vec<Block>,
}

impl Bvh {
    pub const EMPTY: Self = Self { root: None, nodes: Vec::new(), blocks: Vec::new() };

    /// Builds the tree over primitives; `vertices` gives a triangle's by its number in the group.
    pub fn build(prims: &[Prim], _params: &BvhParams, vertices: impl Fn(u32) -> [Vec3; 3] + Sync) -> Self {
        build::build(prims, &vertices)
    }
}
