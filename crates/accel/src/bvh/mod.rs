//! A tree of boxes, eight wide, with blocks of up to eight triangles in its leaves.
//!
//! `build.rs` makes it from boxes alone, `refit.rs` gives it other boxes, `traverse.rs` searches it with one ray, `many.rs` with a slice of them; the arithmetic is the kernels'.

mod answers;
mod batch;
mod build;
mod collapse;
mod few;
mod few_triangles;
mod layout;
pub(crate) mod many;
pub(crate) mod near;
mod object_split;
mod packet;
pub mod params;
mod refit;
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
    node::{Block, Child, Outline},
    prim::Prim,
    stage::{GroupData, Stage},
};
use few_triangles::FewTriangles;
use params::BvhParams;
use straal_math::Vec3;

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
    /// All that is in the tree, where that is but a few triangles.
    triangles: FewTriangles,
    /// Of one whose boxes were made anew, what a search cost when it was built.
    built_cost: Option<f64>,
}

impl Bvh {
    pub const EMPTY: Self = Self {
        root: None,
        lines: Lines::EMPTY,
        outlines: Vec::new(),
        shapes: Blocks::EMPTY,
        few: Blocks::EMPTY,
        triangles: FewTriangles::EMPTY,
        built_cost: None,
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
            + self.triangles.bytes()
    }

    /// A leaf's block; `room` is for one that has to be put together.
    #[inline(always)]
    fn block<'a, S>(
        &'a self,
        scene: &Stage<S>,
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
    fn gather<S>(&self, scene: &Stage<S>, group: &GroupData, i: usize) -> Block {
        self.outlines[i].block(|id| scene.vertices(group, id))
    }

    /// The numbers of a block's triangles.
    fn block_ids(&self, i: u32) -> impl Iterator<Item = u32> + '_ {
        let block = self.outlines.is_empty().then(|| self.lines.block(i as usize).ids());
        // One of both has none.
        block.into_iter().flatten().chain(self.outlines.get(i as usize).into_iter().flat_map(Outline::ids))
    }

    /// Builds the tree over primitives and shapes that are formulas; `vertices` gives a triangle's by its number in the group.
    /// `locate` where it is found. `None` if it takes more than 64 GiB.
    pub fn build(
        prims: Vec<Prim>,
        shapes: Vec<Member>,
        params: &BvhParams,
        vertices: impl Fn(u32) -> [Vec3; 3] + Sync,
        locate: impl Fn(u32) -> (u32, u32),
    ) -> Option<Self> {
        let (few, many) = few::part(shapes);
        let mut triangles = FewTriangles::EMPTY;
        if many.is_empty() {
            triangles = FewTriangles::of(&prims, &vertices, locate);
        }
        Some(Self { few, triangles, ..build::build(prims, &many, params, &vertices)? })
    }
}
