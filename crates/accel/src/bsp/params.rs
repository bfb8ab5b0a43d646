//! How a BSP tree is built.

/// Parameters of the BSP tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BspParams {
    /// Which of the candidates cuts a cell.
    pub choice: BspChoice,
    /// How many triangles of a cell, evenly spaced in their order, offer their planes for a cut.
    pub candidates: u32,
    /// Cells of so few primitives aren't cut.
    pub leaf_size: u32,
    /// The most levels, at most 64; 0 for 8 + 1.3 log2 n.
    pub max_depth: u32,
    /// What a primitive across a plane weighs against one too many on one side, by [`BspChoice::Even`].
    pub straddle_cost: f64,
    /// Whether a ray remembers the primitives that it tested last, so that one in several leaves is tested once.
    pub mailboxes: bool,
    /// Cost of a step through an inner node.
    pub traversal_cost: f64,
    /// Cost of the test of one primitive.
    pub intersection_cost: f64,
}

impl BspParams {
    /// A plane at any angle takes three times the arithmetic of one at right angles to an axis.
    pub const DEFAULT: Self = Self {
        choice: BspChoice::Even,
        candidates: 8,
        leaf_size: 4,
        max_depth: 0,
        straddle_cost: 4.0,
        mailboxes: true,
        traversal_cost: 1.5,
        intersection_cost: 1.0,
    };
}

impl Default for BspParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Which plane cuts a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspChoice {
    /// The one with few primitives across it and equal numbers on both sides.
    #[default]
    Even,
    /// The one from which the surface area heuristic expects the least cost.
    Sah,
}
