//! The BSP tree: space cut in two by planes at any angle, taken from the polygons of the scene themselves.
//!
//! | parameter | meaning |
//! |---|---|
//! | `candidates` | triangles of a cell that offer their planes |
//! | `leaf_size` | cells of so few primitives aren't cut |
//! | `max_depth` | most levels; 0 for 8 + 1.3 log2 n |
//! | `straddle_cost` | what a primitive on both sides weighs against one too many on one side |
//! | `mailboxes` | whether a ray remembers what it tested |
//! | `traversal_cost` | C_t, a step through an inner node |
//! | `intersection_cost` | C_i, the test of one primitive |
//!
//! Fuchs, Kedem and Naylor (1980, "On visible surface generation by a priori tree structures") cut along the polygons
//! themselves, which is called auto-partition: a wall, however it stands, parts what is before it from what is
//! behind. Rays walk the tree front to back as in a kd-tree (Jansen 1986; Ize, Wald and Parker 2008, "Ray tracing
//! with the BSP tree").
//!
//! Of a few candidates the plane is taken with the least `straddle_cost` S + |F - B|, where F, B and S primitives lie
//! in front, behind, and on both sides (`build.rs`). On a convex object every polygon has all others behind it, and
//! such a plane parts nothing: so the plane at right angles to the cell's longest axis, through the median of the
//! primitives' middles, is always a candidate too. It is the only one where there are no triangles. A cell is a leaf
//! when no candidate leaves fewer primitives on both sides, or when C_t + C_i (N_F + N_B) / 2, what it costs if each
//! side is met by half of the rays, isn't less than C_i N.
//!
//! A polygon lies in its own plane, and its neighbours touch it, so that a plane through it would have them all on
//! both sides. The cut is made a hair before the polygon instead: it and what doesn't rise over it are behind.
//!
//! A step takes a scalar product instead of a subtraction, and a node is several times the size of a kd-tree's: this
//! tree is here to be compared, not to win.
//!
//! # Exactness
//! By `partition.rs` and `plane.rs`: a triangle is on the sides that its vertices touch, anything else on those that
//! its padded box touches.

mod build;
mod cell;
mod params;
mod plane;

pub use params::BspParams;

use crate::{
    hit::Hit,
    input::Shapes,
    kernel::{Kernel, stack::Stack},
    mailbox::Mailboxes,
    partition::{self, Census, MAX_DEPTH, chance},
    query::Query,
    structure::{Packed, Place, Prim, Search, Stats},
};
use cell::Cell;
use plane::{Interval, Line, Plane, Side};
use straal_math::{Bounds, Vec3, ops};

/// A node. Nodes lie in depth-first order: an inner node's front child comes right after it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Node {
    /// Cut by a plane; `back` is the index of the other child.
    Inner { plane: Plane, back: u32 },
    /// `count` references from `first` on.
    Leaf { first: u32, count: u32 },
}

/// The tree.
pub(crate) struct BspTree {
    /// Around all primitives.
    bounds: Bounds,
    /// Never empty; the root is the first.
    nodes: Vec<Node>,
    references: Vec<Packed>,
    params: BspParams,
}

/// A subtree that is still to be visited, and the ray's interval in it.
#[derive(Clone, Copy)]
struct Todo {
    node: u32,
    interval: Interval,
}

impl BspTree {
    /// Builds the tree over primitives; `vertices` gives a triangle's by its number in the group.
    pub fn build(prims: &[Prim], params: &BspParams, vertices: impl Fn(u32) -> [Vec3; 3]) -> Self {
        build::build(prims, params, &vertices)
    }

    /// Every primitive in all leaves that it touches, no deeper than the stack allows.
    pub fn validate(&self, prims: &[Prim], vertices: impl Fn(u32) -> [Vec3; 3]) -> Result<(), String> {
        let mut census = Census::new(prims);
        let mut stack = vec![(0_u32, prims.to_vec(), 0)];
        while let Some((node, needed, depth)) = stack.pop() {
            match &self.nodes[node as usize] {
                Node::Leaf { first, count } => {
                    let leaf = &self.references[*first as usize..][..*count as usize];
                    census.leaf(leaf, &needed, depth)?;
                }
                Node::Inner { plane, back } => {
                    let part = |not: Side| {
                        needed.iter().filter(|p| build::side(plane, p, &vertices) != not).copied().collect()
                    };
                    stack.push((node + 1, part(Side::Back), depth + 1));
                    stack.push((*back, part(Side::Front), depth + 1));
                }
            }
        }
        census.end()
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
        let line = Line::new(at.ray);
        let interval = Interval { enter: f64::from(enter), exit: f64::from(exit) };
        let mut stack = Stack::<Todo, { MAX_DEPTH as usize + 1 }>::new();
        stack.push(Todo { node: 0, interval });
        // The least t beyond which nothing matters.
        let mut limit = exit;
        while let Some(mut todo) = stack.pop() {
            loop {
                if todo.interval.enter > f64::from(limit) {
                    break;
                }
                q.count_node(0);
                let (plane, back) = match &self.nodes[todo.node as usize] {
                    Node::Leaf { first, count } => {
                        let references = &self.references[*first as usize..][..*count as usize];
                        limit = ops::min(limit, leaf(q, references));
                        break;
                    }
                    Node::Inner { plane, back } => (plane, *back),
                };
                let [front, behind] = plane.parts(&line, todo.interval);
                let front = front.map(|interval| Todo { node: todo.node + 1, interval });
                let behind = behind.map(|interval| Todo { node: back, interval });
                todo = match (front, behind) {
                    (Some(a), Some(b)) => {
                        // Entered at once, the side that is left first is the nearer one.
                        let order = |t: &Todo| (t.interval.enter, t.interval.exit);
                        let (near, far) = if order(&b) < order(&a) { (b, a) } else { (a, b) };
                        stack.push(far);
                        near
                    }
                    (Some(only), None) | (None, Some(only)) => only,
                    (None, None) => break,
                };
            }
        }
    }
}

impl Search for BspTree {
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

    /// A line meets a convex cell with the probability of its surface, whatever the cell's shape.
    fn stats(&self) -> Stats {
        let mut out = Stats { references: self.references.len(), ..Stats::default() };
        let root = Cell::of_box(&partition::finite(&self.bounds));
        let whole = root.area();
        let step = self.params.traversal_cost / self.params.intersection_cost;
        let mut stack = vec![(0_u32, root, 0)];
        while let Some((node, cell, depth)) = stack.pop() {
            out.depth = out.depth.max(depth);
            let chance = chance(cell.area(), whole);
            match &self.nodes[node as usize] {
                Node::Leaf { count, .. } => {
                    out.leaves += 1;
                    out.sah_cost += chance * f64::from(*count);
                }
                Node::Inner { plane, back } => {
                    out.nodes += 1;
                    out.sah_cost += chance * step;
                    let [front, behind] = cell.cut(plane);
                    stack.push((node + 1, front, depth + 1));
                    stack.push((*back, behind, depth + 1));
                }
            }
        }
        out
    }
}
