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
//! By `partition.rs`; with `clip`, by `clip.rs`.

mod build;
mod params;
mod sweep;

pub use params::KdParams;

use crate::{
    hit::Hit,
    input::Shapes,
    kernel::{Kernel, stack::Stack},
    mailbox::Mailboxes,
    partition::{self, Census, MAX_DEPTH, chance, crossing, early, half_area, late},
    query::Query,
    structure::{Packed, Place, Prim, PrimKind, Search, Stats},
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

/// The tree.
pub(crate) struct KdTree {
    /// Around all primitives.
    bounds: Bounds,
    /// Never empty; the root is the first.
    nodes: Vec<Node>,
    /// The primitives of the leaves, one leaf after the other.
    references: Vec<Packed>,
    params: KdParams,
}

/// A subtree that is still to be visited, and the ray's interval in it.
#[derive(Clone, Copy)]
struct Todo {
    node: u32,
    enter: f32,
    exit: f32,
}

impl KdTree {
    /// Builds the tree over primitives; `vertices` gives a triangle's by its number in the group.
    pub fn build(prims: &[Prim], params: &KdParams, vertices: impl Fn(u32) -> [Vec3; 3]) -> Self {
        build::build(prims, params, &vertices)
    }

    /// Every primitive in all leaves that its box reaches into, no deeper than the stack allows. With `clip`,
    /// triangles in some leaf.
    pub fn validate(&self, prims: &[Prim]) -> Result<(), String> {
        let mut census = Census::new(prims);
        let is_needed = |p: &&Prim| !self.params.clip || matches!(p.kind, PrimKind::Object(_));
        let needed: Vec<Prim> = prims.iter().filter(is_needed).copied().collect();
        let mut stack = vec![(0, needed, 0)];
        while let Some((node, needed, depth)) = stack.pop() {
            match self.nodes[node as usize] {
                Node::Leaf { first, count } => census.leaf(self.leaf(first, count), &needed, depth)?,
                Node::Inner { axis, plane, upper } => {
                    let axis = usize::from(axis);
                    let part = |is_in: &dyn Fn(&Bounds) -> bool| {
                        needed.iter().filter(|p| is_in(&p.bounds)).copied().collect()
                    };
                    stack.push((node + 1, part(&|b| b.min[axis] < plane), depth + 1));
                    stack.push((upper, part(&|b| b.max[axis] > plane), depth + 1));
                }
            }
        }
        census.end()
    }

    fn leaf(&self, first: u32, count: u32) -> &[Packed] {
        &self.references[first as usize..][..count as usize]
    }

    /// Calls `leaf` with the leaves that the ray passes, in order. It answers up to which t others still matter.
    #[inline(always)]
    fn walk<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        mut leaf: impl FnMut(&mut Query<'_, K, S, COUNT>, &[Packed]) -> f32,
    ) {
        let Some((enter, exit)) = partition::interval(&self.bounds, at.ray) else { return };
        let mut stack = Stack::<Todo, { MAX_DEPTH as usize + 1 }>::new();
        let mut todo = Todo { node: 0, enter, exit };
        // The least t beyond which nothing matters.
        let mut limit = exit;
        loop {
            q.count_node(0);
            let next = match self.nodes[todo.node as usize] {
                Node::Leaf { first, count } => {
                    limit = ops::min(limit, leaf(q, self.leaf(first, count)));
                    None
                }
                Node::Inner { axis, plane, upper } => {
                    let axis = usize::from(axis);
                    let t = crossing(plane, axis, at.ray);
                    let lower = todo.node + 1;
                    let (near, far) = if at.ray.neg[axis] == 0 { (lower, upper) } else { (upper, lower) };
                    let near = Todo { node: near, exit: ops::min(todo.exit, late(t)), ..todo };
                    let far = Todo { node: far, enter: ops::max(todo.enter, early(t)), ..todo };
                    match (near.enter <= near.exit, far.enter <= far.exit) {
                        (true, true) => {
                            stack.push(far);
                            Some(near)
                        }
                        (true, false) => Some(near),
                        (false, true) => Some(far),
                        (false, false) => None,
                    }
                }
            };
            todo = match next {
                Some(next) => next,
                // Nothing is skipped but what is entered strictly beyond the limit.
                None => loop {
                    match stack.pop() {
                        None => return,
                        Some(todo) if todo.enter <= limit => break todo,
                        Some(_) => {}
                    }
                },
            };
        }
    }
}

impl Search for KdTree {
    #[inline(always)]
    fn closest<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        let mut tested = Mailboxes::new(self.params.mailboxes);
        self.walk(q, at, |q, leaf| {
            tested.closest(q, at, leaf, best);
            best.t
        });
    }

    #[inline(always)]
    fn occluded<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
    ) -> bool {
        let mut tested = Mailboxes::new(self.params.mailboxes);
        let mut found = false;
        self.walk(q, at, |q, leaf| {
            found = tested.occluded(q, at, leaf);
            if found { f32::NEG_INFINITY } else { f32::INFINITY }
        });
        found
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.references.as_slice())
    }

    fn stats(&self) -> Stats {
        let mut out = Stats { references: self.references.len(), ..Stats::default() };
        let whole = half_area(&self.bounds);
        let step = self.params.traversal_cost / self.params.intersection_cost;
        let mut stack = vec![(0_u32, partition::finite(&self.bounds), 0)];
        while let Some((node, cell, depth)) = stack.pop() {
            out.depth = out.depth.max(depth);
            let chance = chance(half_area(&cell), whole);
            match self.nodes[node as usize] {
                Node::Leaf { count, .. } => {
                    out.leaves += 1;
                    out.sah_cost += chance * f64::from(count);
                }
                Node::Inner { axis, plane, upper } => {
                    out.nodes += 1;
                    out.sah_cost += chance * step;
                    let [lower_cell, upper_cell] = sweep::halves(&cell, usize::from(axis), plane);
                    stack.push((node + 1, lower_cell, depth + 1));
                    stack.push((upper, upper_cell, depth + 1));
                }
            }
        }
        out
    }
}
