//! The kd-tree: space cut in two by planes at right angles to the axes, each placed where the expected cost of a ray
//! is least.
//!
//! | parameter | meaning |
//! |---|---|
//! | `traversal_cost` | C_t, a step through an inner node |
//! | `intersection_cost` | C_i, the test of one primitive |
//! | `empty_bonus` | part of the cost remitted to a cut with an empty side |
//! | `max_depth` | most levels; 0 for 8 + 1.3 log2 n |
//! | `leaf_size` | cells of so few primitives aren't cut |
//! | `clip` | boxes of triangles are those of their part inside the cell ("perfect splits") |
//! | `mailboxes` | whether a ray remembers what it tested |
//!
//! # Where to cut
//! A line that meets a convex cell V meets a convex part V_L of it with the probability A(V_L) / A(V), A being the
//! surface area. If both sides of a cut became leaves, it would cost (MacDonald and Booth 1990, "Heuristics for ray
//! tracing using space subdivision")
//!
//! C = bonus (C_t + C_i (N_L A(V_L) + N_R A(V_R)) / A(V)),
//!
//! with bonus = 1 - `empty_bonus` when N_L or N_R is 0, else 1 (Hurley et al. 2002; Wald and Havran 2006, section
//! 2.3). Along an axis C is linear between the ends of the primitives' boxes, so that its minimum is at one of them:
//! 2n candidates a dimension, and all of them are looked at (`sweep.rs`). They stay sorted all the way down, so that
//! building takes O(n log n) (`build.rs`).
//!
//! # When to stop, and how that fails
//! A cell is a leaf when its cheapest cut isn't cheaper than C_i N, the cost of leaving it alone. This rule is
//! greedy: it ends where the *first* cut doesn't pay, though several together might. Its known failure is the
//! **hollow object**: a box of twelve triangles. A cut close to one of its walls parts two triangles from the other
//! ten, but eight touch that wall with an edge and are counted on both sides, so that it doesn't pay; yet after a few
//! such cuts the others do, and leave an empty room through which rays go without a test. The tree is a single leaf
//! (test `hollow_objects_stop_the_greedy_rule`). Structures of boxes have no such trouble.
//!
//! # Exactness
//! By `partition.rs`; with `clip`, by `clip.rs`. Rays walk the tree by `cells.rs`.

mod build;
mod params;
mod sweep;

pub use params::KdParams;

use crate::{
    cells::{self, CellOptions, Cells, Interval, Later, Opened, Todo},
    clip::Limits,
    local::LocalRay,
    partition::{self, crossing, early, half_area, late},
    prim::{Packed, Prim, PrimKind},
};
use straal_math::{Bounds, Vec3, ops};

/// A node. Nodes lie in depth-first order: an inner node's lower child comes right after it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Node {
    /// Cut at `plane` on an axis; `upper` is the index of the other child.
    Inner { axis: u8, plane: f32, upper: u32 },
    /// `count` references from `first` on.
    Leaf { first: u32, count: u32 },
}

/// Bytes of a node.
pub(crate) const NODE_BYTES: usize = size_of::<Node>();

/// The tree.
pub(crate) struct KdTree {
    /// Around all primitives.
    bounds: Bounds,
    /// Never empty; the root is the first.
    nodes: Vec<Node>,
    /// The primitives of the leaves, one leaf after the other.
    references: Vec<Packed>,
    limits: Limits,
    params: KdParams,
}

impl KdTree {
    /// Builds the tree over primitives; `vertices` gives a triangle's by its number in the group.
    pub fn build(prims: &[Prim], params: &KdParams, vertices: impl Fn(u32) -> [Vec3; 3]) -> Self {
        build::build(prims, params, &vertices)
    }

    /// Every primitive in all leaves that its box reaches into, no deeper than the stack allows. With `clip`,
    /// triangles in some leaf.
    pub fn validate(&self, prims: &[Prim]) -> Result<(), String> {
        let is_needed = |p: &&Prim| !self.params.clip || matches!(p.kind, PrimKind::Object(_));
        let needed = prims.iter().filter(is_needed).copied().collect();
        cells::validate(self, prims, needed, |cut, p| {
            let below = (p.bounds.min[cut.axis] < cut.plane).then_some(cut.lower);
            let above = (p.bounds.max[cut.axis] > cut.plane).then_some(cut.upper);
            [below, above].into_iter().flatten()
        })
    }
}

/// A plane at right angles to an axis, with the nodes on its two sides.
#[derive(Clone, Copy)]
pub(crate) struct Cut {
    axis: usize,
    plane: f32,
    lower: u32,
    upper: u32,
}

impl Cells for KdTree {
    type Cut = Cut;
    type Line<'a> = &'a LocalRay;
    type Part = Interval;
    type Space = Bounds;

    #[inline(always)]
    fn open(&self, node: u32) -> Opened<'_, Cut> {
        match self.nodes[node as usize] {
            Node::Leaf { first, count } => Opened::Leaf(&self.references[first as usize..][..count as usize]),
            Node::Inner { axis, plane, upper } => {
                Opened::Inner(Cut { axis: usize::from(axis), plane, lower: node + 1, upper })
            }
        }
    }

    #[inline(always)]
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn options(&self) -> CellOptions {
        let p = &self.params;
        CellOptions { mailboxes: p.mailboxes, step_cost: p.traversal_cost / p.intersection_cost }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.references.as_slice())
    }

    fn references(&self) -> &[Packed] {
        &self.references
    }

    #[inline(always)]
    fn limits(&self) -> &Limits {
        &self.limits
    }

    #[inline(always)]
    fn line(ray: &LocalRay) -> &LocalRay {
        ray
    }

    #[inline(always)]
    fn cross(
        cut: &Cut,
        ray: &&LocalRay,
        part: Interval,
        later: &mut Later<Interval>,
    ) -> Option<Todo<Interval>> {
        let t = crossing(cut.plane, cut.axis, ray);
        let (near, far) = match ray.neg[cut.axis] {
            0 => (cut.lower, cut.upper),
            _ => (cut.upper, cut.lower),
        };
        let before = Interval { exit: ops::min(part.exit, late(t)), ..part };
        let after = Interval { enter: ops::max(part.enter, early(t)), ..part };
        let near = Todo { node: near, part: before };
        let far = Todo { node: far, part: after };
        match (before.enter <= before.exit, after.enter <= after.exit) {
            (true, true) => {
                later.push(far);
                Some(near)
            }
            (true, false) => Some(near),
            (false, true) => Some(far),
            (false, false) => None,
        }
    }

    fn root_space(&self) -> Bounds {
        partition::finite(&self.bounds)
    }

    fn area(&self, space: &Bounds) -> f64 {
        half_area(space)
    }

    fn divide(cut: &Cut, space: &Bounds) -> Vec<(u32, Bounds)> {
        let [lower, upper] = sweep::halves(space, cut.axis, cut.plane);
        vec![(cut.lower, lower), (cut.upper, upper)]
    }
}
