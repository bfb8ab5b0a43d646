//! How a kd-tree is built.

/// Parameters of the kd-tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KdParams {
    /// Cost of a step through an inner node.
    pub traversal_cost: f64,
    /// Cost of the test of one primitive.
    pub intersection_cost: f64,
    /// Part of the cost, in [0, 1], that is remitted to a cut that leaves one side empty.
    pub empty_bonus: f64,
    /// The most levels, at most 64; 0 for 8 + 1.3 log2 n.
    pub max_depth: u32,
    /// Cells of so few primitives aren't cut.
    pub leaf_size: u32,
    /// Whether the boxes of triangles are those of their part inside the cell.
    pub clip: bool,
    /// Whether a ray remembers the primitives that it tested last, so that one in several leaves is tested once.
    pub mailboxes: bool,
}

impl KdParams {
    /// Those of Wald and Havran: costs of 15 and 20, of which only the ratio matters, and a bonus of 20 %.
    pub const DEFAULT: Self = Self {
        traversal_cost: 0.75,
        intersection_cost: 1.0,
        empty_bonus: 0.2,
        max_depth: 0,
        leaf_size: 1,
        clip: false,
        mailboxes: true,
    };
}

impl Default for KdParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}
