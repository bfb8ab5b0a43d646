//! A tree of boxes, eight wide, with blocks of up to eight triangles in its leaves.
//!
//! `build.rs` makes it from boxes alone, `traverse.rs` searches it with one ray, `many.rs` with a slice of them; the arithmetic is the kernels'.

mod answers;
mod batch;
pub(crate) mod block;
mod build;
pub(crate) mod bundle;
mod collapse;
mod few;
mod layout;
pub(crate) mod many;
pub(crate) mod near;
mod object_split;
mod packet;
pub mod params;
mod slots;
mod span;
mod spatial_split;
mod stats;
mod traverse;
mod validate;
mod wide;

use crate::{
    analytic::block::{Blocks, Member},
    kernel::lines::{LINE, Lines},
    scene::{GroupData, Scene},
    structure::Prim,
};
use params::BvhParams;
use straal_math::{Bounds, Vec3};

/// Boxes in a node, triangles in a block.
pub(crate) const WIDTH: usize = 8;

pub(crate) use block::{Block, Row};
pub(crate) use build::STACK;

use block::Outline;

/// Bytes of what a compact tree keeps of up to eight triangles.
pub(crate) const OUTLINE_BYTES: usize = size_of::<Outline>();

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

/// What a box contains: the highest two bits tell the kind, the others are an index: the first line of a node or of a
/// block, but the number of an object or of an outline, or with one more bit that of a block of shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct Child(u32);

/// The same, taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChildKind {
    Node(u32),
    Block(u32),
    Object(u32),
    Shapes(u32),
    Done,
}

/// The two highest bits of a child.
pub(crate) mod class {
    pub const NODE: usize = 0;
    pub const DONE: usize = 1;
    pub const BLOCK: usize = 2;
    pub const OBJECT: usize = 3;
}

impl Child {
    const LEAF: u32 = 1 << 31;
    const OBJECT: u32 = 1 << 30;
    const SHAPES: u32 = 1 << 29;

    /// The end of a search.
    pub const DONE: Self = Self(Self::OBJECT);

    pub const fn node(i: u32) -> Self {
        Self(i)
    }

    const fn block(i: u32) -> Self {
        Self(i | Self::LEAF)
    }

    const fn object(i: u32) -> Self {
        Self(i | Self::LEAF | Self::OBJECT)
    }

    const fn shapes(i: u32) -> Self {
        Self::object(i | Self::SHAPES)
    }

    /// The block of shapes that it is, if it is one.
    #[inline(always)]
    pub const fn as_shapes(self) -> Option<usize> {
        let of = Self::LEAF | Self::OBJECT | Self::SHAPES;
        if self.0 >= of { Some((self.0 - of) as usize) } else { None }
    }

    /// Whether it is a leaf of any kind: 0 or 1.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub const fn leaf(self) -> usize {
        (self.0 >> 31) as usize
    }

    /// The same, where `nodes`, `blocks` and blocks of `shapes` stand before its own.
    const fn moved(self, nodes: u32, blocks: u32, shapes: u32) -> Self {
        match self.kind() {
            ChildKind::Node(i) => Self::node(i + nodes),
            ChildKind::Block(i) => Self::block(i + blocks),
            ChildKind::Shapes(i) => Self::shapes(i + shapes),
            ChildKind::Object(_) | ChildKind::Done => self,
        }
    }

    /// The number in the class.
    #[inline(always)]
    pub const fn index(self) -> usize {
        (self.0 & (Self::OBJECT - 1)) as usize
    }

    /// Whether it is a node.
    #[inline(always)]
    pub const fn is_node(self) -> bool {
        self.0 < Self::OBJECT
    }

    /// Whether it is a block.
    #[inline(always)]
    pub const fn is_block(self) -> bool {
        self.class() == class::BLOCK
    }

    /// One of [`class`].
    #[inline(always)]
    pub const fn class(self) -> usize {
        (self.0 >> 30) as usize
    }

    #[inline(always)]
    const fn kind(self) -> ChildKind {
        let i = self.0 & (Self::OBJECT - 1);
        match self.class() {
            class::NODE => ChildKind::Node(i),
            class::BLOCK => ChildKind::Block(i),
            class::OBJECT if i >= Self::SHAPES => ChildKind::Shapes(i - Self::SHAPES),
            class::OBJECT => ChildKind::Object(i),
            _ => ChildKind::Done,
        }
    }
}

/// Trees of more bytes than this are prefetched from: smaller ones stay in the second-level cache, or nearly so.
const CACHED: usize = 1 << 20;

/// Nodes of trees of more bytes than this come from memory more often than from the third-level cache.
const REMOTE: usize = 32 << 20;

/// Where a tree's nodes are.
enum Distance {
    /// In the nearest caches.
    Near,
    /// In the third-level cache.
    Far,
    /// In memory.
    Remote,
}

/// The tree.
pub(crate) struct Bvh {
    /// `None` when there is nothing to hit.
    root: Option<Child>,
    /// Nodes, and the leaves' triangles but in a compact tree.
    lines: Lines,
    /// In a compact tree, what tells how to put each block together; blocks are numbers of these there.
    outlines: Vec<Outline>,
    /// Shapes in its leaves.
    shapes: Blocks,
    /// Shapes that stand beside the tree.
    few: Blocks,
}

impl Bvh {
    pub const EMPTY: Self = Self {
        root: None,
        lines: Lines::EMPTY,
        outlines: Vec::new(),
        shapes: Blocks::EMPTY,
        few: Blocks::EMPTY,
    };

    /// How long nodes are likely to be waited for.
    fn distance(&self) -> Distance {
        let bytes = self.bytes();
        if bytes > REMOTE {
            Distance::Remote
        } else if bytes > CACHED {
            Distance::Far
        } else {
            Distance::Near
        }
    }

    fn bytes(&self) -> usize {
        self.lines.len() * LINE
            + size_of_val(self.outlines.as_slice())
            + self.shapes.bytes()
            + self.few.bytes()
    }

    /// A leaf's block; `room` is for one that has to be put together.
    #[inline(always)]
    fn block<'a>(
        &'a self,
        scene: &Scene,
        group: &GroupData,
        i: usize,
        room: &'a mut Option<Block>,
    ) -> &'a Block {
        match self.outlines.is_empty() {
            true => self.lines.block(i),
            false => room.insert(self.gather(scene, group, i)),
        }
    }

    /// A block of a compact tree, its vertices taken from the meshes.
    #[inline(never)]
    fn gather(&self, scene: &Scene, group: &GroupData, i: usize) -> Block {
        self.outlines[i].block(|id| scene.vertices(group, id))
    }

    /// The numbers of a block's triangles.
    fn block_ids(&self, i: u32) -> impl Iterator<Item = u32> + '_ {
        let block = self.outlines.is_empty().then(|| self.lines.block(i as usize).ids());
        // One of both has none.
        block.into_iter().flatten().chain(self.outlines.get(i as usize).into_iter().flat_map(Outline::ids))
    }

    /// Builds the tree over primitives and shapes that are formulas; `vertices` gives a triangle's by its number in the group.
    /// `None` if it takes more than 64 GiB.
    pub fn build(
        prims: &[Prim],
        shapes: Vec<Member>,
        params: &BvhParams,
        vertices: impl Fn(u32) -> [Vec3; 3] + Sync,
    ) -> Option<Self> {
        let (few, many) = few::part(shapes);
        Some(Self { few, ..build::build(prims, &many, params, &vertices)? })
    }
}
