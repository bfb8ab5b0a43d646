//! Search structures and their parameters.

use crate::describe::describe;
use crate::limit::Limit;

/// What a cost may be: only the ratio of costs matters.
const COST: Limit = Limit { min: 0.0, max: 1e6, open: true };

describe! {
    /// How rays are searched. It never changes the picture.
    pub struct Accel {
        /// Which structure.
        structure: Structure = Structure::default(),
        /// Counts what the searches of each pixel cost, for the layers `cost.nodes`, `cost.primitives` and `cost.time` of an
        /// EXR. Slower; the picture is the same.
        cost: bool = false,
    }
}

describe! {
    /// A search structure.
    pub enum Structure {
        /// Bounding volume hierarchy, eight wide.
        "bvh" => Bvh(WideBvh),
        /// Bounding volume hierarchy, two boxes in each node, built as the textbook does.
        "bvh2" => Bvh2(BinaryBvh),
        /// Every primitive for every ray: slow, and what the others are held against.
        "brute" => Brute,
        /// Equal cells.
        "grid" => Grid(UniformGrid),
    }
}

impl Default for Structure {
    fn default() -> Self {
        Self::Bvh(WideBvh::default())
    }
}

describe! {
    /// A tree of boxes, eight in each node.
    pub struct WideBvh {
        /// How much work goes into the tree.
        build: Build = Build::Default,
        /// Whether memory is spared at the cost of some speed.
        compact: bool = false,
    }
}

describe! {
    /// How much work goes into a tree.
    pub enum Build {
        /// Little: for a preview.
        "fast" => Fast,
        /// What pays off for one picture.
        "default" => Default,
        /// As much as helps: for many rays.
        "best" => Best,
    }
}

describe! {
    /// A tree of boxes, two in each node.
    pub struct BinaryBvh {
        /// How sets of primitives are cut in two, or joined.
        split: Split = Split::Sah,
        /// Most primitives in a leaf.
        leaf_size: u32 [Limit::within(1.0, 1e6)] = 4,
        /// Cost of a step to an inner node, with the tests of its two boxes.
        traversal_cost: f64 [COST] = 1.0,
        /// Cost of the test of a primitive, in the same unit.
        intersection_cost: f64 [COST] = 1.0,
    }
}

describe! {
    /// How the sets of a binary tree come about.
    pub enum Split {
        /// From the top down: two halves of equal number.
        "median" => Median,
        /// From the top down: at the middle of space.
        "middle" => Middle,
        /// From the top down: where the surface area heuristic expects the least cost.
        "sah" => Sah,
        /// From the bottom up: neighbours are joined.
        "agglomerative" => Agglomerative,
    }
}

describe! {
    /// Equal cells, of which a ray visits those on its way.
    pub struct UniformGrid {
        /// Along each axis, cells for each one that a grid with as many cells as primitives would have.
        factor: f64 [Limit { min: 0.0, max: 64.0, open: true }] = 2.0,
        /// Whether a ray remembers the primitives that it tested last, so that one in several cells is tested once.
        mailboxes: bool = true,
        /// Most cells, and most entries in the cells' lists beyond one for each primitive; where there would be more, the
        /// factor is halved.
        max_cells: u32 [Limit::within(1.0, 268_435_456.0)] = 33_554_432,
        /// Cost of a step to the next cell.
        traversal_cost: f64 [COST] = 0.5,
        /// Cost of the test of a primitive, in the same unit.
        intersection_cost: f64 [COST] = 1.0,
    }
}
