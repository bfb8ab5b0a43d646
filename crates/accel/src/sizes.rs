//! Bytes of the parts that search structures are made of, for who forecasts what a structure takes.

use crate::analytic::{Kind, NUMBERS, block};
use crate::node::{Block, Node, Outline};
use crate::prim::{Packed, Prim};
use crate::stage::Object;
use crate::{bsp, bvh2, kd, octree};

/// A reference to a primitive, in a leaf.
pub const REFERENCE: usize = size_of::<Packed>();

/// A primitive and its box, from which structures are built.
pub const PRIMITIVE: usize = size_of::<Prim>();

/// What every structure knows of a shape or instance: kind, mask and box.
pub const OBJECT: usize = size_of::<Object>();

/// A node of the wide tree: eight boxes.
pub const WIDE_NODE: usize = size_of::<Node>();

/// Up to eight triangles of the wide tree, with their vertices.
pub const BLOCK: usize = size_of::<Block>();

/// The same in a compact tree, which asks the meshes for vertices.
pub const OUTLINE: usize = size_of::<Outline>();

/// Up to eight spheres of the wide tree.
pub const BLOCK_OF_SPHERES: usize = block_of(Kind::Sphere.numbers());

/// Up to eight shapes of another kind.
pub const BLOCK_OF_SHAPES: usize = block_of(NUMBERS);

/// A block of shapes that have so many numbers.
const fn block_of(numbers: usize) -> usize {
    size_of::<block::Head>() + numbers * block::ROW_BYTES
}

/// A node of the binary tree of boxes.
pub const BINARY_NODE: usize = bvh2::NODE_BYTES;

/// A node of the kd-tree.
pub const KD_NODE: usize = kd::NODE_BYTES;

/// A node of the octree.
pub const OCTREE_NODE: usize = octree::NODE_BYTES;

/// A node of the BSP tree.
pub const BSP_NODE: usize = bsp::NODE_BYTES;
