//! Search structures and their parameters.

use crate::describe::describe;

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
