//! Search structures and their parameters.

use crate::describe::describe;
use crate::limit::Limit;

/// What the cost of a test may be: only the ratio of costs matters.
const COST: Limit = Limit { min: 0.0, max: 1e6, open: true };

/// What a cost beside it may be. It may be no cost at all.
const COST_BESIDE: Limit = Limit::within(0.0, 1e6);

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
        /// A bounding volume around each object.
        "volumes" => Volumes(BoundingVolumes),
        /// Bounding volume hierarchy, two boxes in each node, built as the textbook does.
        "bvh2" => Bvh2(BinaryBvh),
        /// Equal cells.
        "grid" => Grid(UniformGrid),
        /// Space cut in two by planes at right angles to the axes, where the surface area heuristic wants it.
        "kd" => Kd(KdTree),
        /// A cube cut in eight at its middle, again and again.
        "octree" => Octree(Octree),
        /// Space cut in two by the planes of the scene's own triangles.
        "bsp" => Bsp(BspTree),
        /// Every primitive for every ray: slow, and what the others are held against.
        "brute" => Brute,
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
    /// A bounding volume around each mesh, shape and instance, tested before it.
    pub struct BoundingVolumes {
        /// The kind of volume.
        volume: VolumeKind = VolumeKind::Box,
        /// Cost of the test of a volume.
        traversal_cost: f64 [COST_BESIDE] = 0.5,
        /// Cost of the test of a primitive, in the same unit.
        intersection_cost: f64 [COST] = 1.0,
    }
}

describe! {
    /// A kind of bounding volume.
    pub enum VolumeKind {
        /// A sphere.
        "sphere" => Sphere,
        /// A box along the axes.
        "box" => Box,
        /// A box along the principal axes of the object's vertices, unless one along the scene's axes is smaller.
        "oriented" => Oriented,
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
        traversal_cost: f64 [COST_BESIDE] = 1.0,
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
        traversal_cost: f64 [COST_BESIDE] = 0.5,
        /// Cost of the test of a primitive, in the same unit.
        intersection_cost: f64 [COST] = 1.0,
    }
}

describe! {
    /// A kd-tree, built by the exact surface area heuristic.
    pub struct KdTree {
        /// Cost of a step through a node, beside `intersection_cost`.
        traversal_cost: f64 [COST_BESIDE] = 0.75,
        /// Cost of the test of one primitive.
        intersection_cost: f64 [COST] = 1.0,
        /// Part of the cost that is remitted to a cut that leaves one side empty.
        empty_bonus: f64 [Limit::UNIT] = 0.2,
        /// Most levels; 0 for 8 + 1.3 log2 n.
        max_depth: u32 [Limit::within(0.0, 64.0)] = 0,
        /// Cells of so few primitives are left alone.
        leaf_size: u32 [Limit::within(1.0, 65536.0)] = 1,
        /// Whether a cut triangle counts with the box of its part in the cell alone.
        clip: bool = false,
        /// Whether a ray remembers the primitives that it tested last, so that one in several leaves is tested once.
        mailboxes: bool = true,
    }
}

describe! {
    /// An octree.
    pub struct Octree {
        /// Most levels below the root.
        max_depth: u32 [Limit::within(0.0, 24.0)] = 12,
        /// Cells of so few primitives are left alone.
        leaf_size: u32 [Limit::within(1.0, 65536.0)] = 8,
        /// Whether a ray remembers the primitives that it tested last, so that one in several leaves is tested once.
        mailboxes: bool = true,
        /// Cost of a step through a node, beside `intersection_cost`; for the reported cost alone.
        traversal_cost: f64 [COST_BESIDE] = 1.0,
        /// Cost of the test of one primitive; for the reported cost alone.
        intersection_cost: f64 [COST] = 1.0,
    }
}

describe! {
    /// A tree of planes at any angle.
    pub struct BspTree {
        /// Which of the candidates cuts a cell.
        choice: PlaneChoice = PlaneChoice::Even,
        /// How many triangles of a cell offer their planes for a cut.
        candidates: u32 [Limit::within(0.0, 1024.0)] = 8,
        /// Cells of so few primitives are left alone.
        leaf_size: u32 [Limit::within(1.0, 65536.0)] = 4,
        /// Most levels; 0 for 8 + 1.3 log2 n.
        max_depth: u32 [Limit::within(0.0, 64.0)] = 0,
        /// What a primitive on both sides of a plane weighs against one too many on one side, where `choice` is `even`.
        straddle_cost: f64 [COST_BESIDE] = 4.0,
        /// Whether a ray remembers the primitives that it tested last, so that one in several leaves is tested once.
        mailboxes: bool = true,
        /// Cost of a step through a node, beside `intersection_cost`.
        traversal_cost: f64 [COST_BESIDE] = 1.5,
        /// Cost of the test of one primitive.
        intersection_cost: f64 [COST] = 1.0,
    }
}

describe! {
    /// Which plane cuts a cell of a BSP tree.
    pub enum PlaneChoice {
        /// The one with few primitives across it, and equal numbers on both sides.
        "even" => Even,
        /// The one from which the surface area heuristic expects the least cost. Planes beside triangles, at right angles to
        /// the axes, are candidates as well. Dearer to build, and far cheaper to search.
        "sah" => Sah,
    }
}
