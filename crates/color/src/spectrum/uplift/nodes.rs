//! Where the nodes of a table of colours lie.

use straal_math::ops;

/// Where one of some nodes lies: dense where a channel is weak, or nearly as strong as the strongest.
pub(super) fn share(node: usize, nodes: usize) -> f64 {
    let t = node as f64 / (nodes - 1) as f64;
    t * t * (3.0 - 2.0 * t)
}

/// Among so many nodes, the place of a share: where [`share`] has it.
#[inline]
pub(super) fn place_of_share(share: f32, nodes: usize) -> f32 {
    let t = 0.5 - ops::sin(ops::asin(ops::clamp(1.0 - 2.0 * share, -1.0, 1.0)) * (1.0 / 3.0));
    t * (nodes - 1) as f32
}
