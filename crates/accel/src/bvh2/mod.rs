//! The textbook's bounding volume hierarchy: a binary tree of boxes (Kay and Kajiya 1986, "Ray Tracing Complex
//! Scenes"; Goldsmith and Salmon 1987, "Automatic Creation of Object Hierarchies for Ray Tracing").
//!
//! An inner node has two children, each with a box around all that is inside; a leaf has a few primitives. A ray that
//! misses a box misses all inside. The nearer child is searched first, and the other only if it isn't entered beyond the hit
//! found. What differs is how the tree is built ([`Split`]): `build.rs` cuts sets in two from the top down, `agglomerate.rs`
//! joins pairs from the bottom up.
//!
//! Boxes are tested by `slab::entry` alone. It is monotone: of two boxes, one inside the other, the outer is never entered
//! later or left earlier, in any rounding. So no node above a primitive's box is missed where the box itself counts as
//! crossed, or skipped while a hit in it could still come first.

mod agglomerate;
mod build;
mod validate;

use crate::{
    hit::Hit,
    kernel::stack::Stack,
    partition::{chance, half_area},
    prim::{Packed, Prim},
    query::{Built, Descend, Place, Query, Search, Stats},
    section::{Section, Slice},
    slab,
};
use straal_math::Bounds;

/// How a binary tree is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bvh2Params {
    /// How sets are cut in two, or joined.
    pub split: Split,
    /// Most primitives in a leaf; those made by costs may have fewer. 0 counts as 1.
    pub leaf_size: u32,
    /// Cost of a step to an inner node, with the tests of its two boxes.
    pub traversal_cost: f64,
    /// Cost of the test of a primitive, in the same unit.
    pub intersection_cost: f64,
}

impl Bvh2Params {
    /// The best of the textbook's trees.
    pub const DEFAULT: Self =
        Self { split: Split::Sah, leaf_size: 4, traversal_cost: 1.0, intersection_cost: 1.0 };
}

impl Default for Bvh2Params {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// How the sets of a binary tree come about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Split {
    /// From the top down: two halves of equal number, along the axis on which the boxes' centres lie widest apart.
    Median,
    /// From the top down: at the middle between the outermost centres on that axis.
    Middle,
    /// From the top down, where the surface area heuristic expects the least cost, among all ways to cut the primitives in
    /// two after sorting them along an axis.
    #[default]
    Sah,
    /// From the bottom up: neighbours whose common box is smallest are joined.
    Agglomerative,
}

/// A box and what is in it.
#[derive(Clone, Copy)]
struct Node {
    bounds: Bounds,
    /// Of a leaf the first primitive, else the first of two children side by side.
    first: u32,
    /// Primitives of a leaf; 0 for an inner node.
    count: u32,
}

/// No tree is deeper, whatever the input.
const MAX_DEPTH: usize = 192;

/// Bytes of a node.
pub(crate) const NODE_BYTES: usize = size_of::<Node>();

/// The tree.
pub(crate) struct Bvh2 {
    params: Bvh2Params,
    /// The root first; empty when there is nothing.
    nodes: Vec<Node>,
    /// Those of a leaf side by side.
    prims: Vec<Packed>,
}

impl Bvh2 {
    pub fn build(prims: &[Prim], params: &Bvh2Params) -> Self {
        let mut tree = Self { params: *params, nodes: Vec::new(), prims: Vec::with_capacity(prims.len()) };
        if !prims.is_empty() {
            match params.split {
                Split::Agglomerative => agglomerate::build(&mut tree, prims),
                Split::Median | Split::Middle | Split::Sah => build::build(&mut tree, prims),
            }
            tree.nodes.shrink_to_fit();
        }
        tree
    }

    #[inline(always)]
    fn leaf(&self, node: &Node) -> &[Packed] {
        &self.prims[node.first as usize..(node.first + node.count) as usize]
    }
}

impl Bvh2Params {
    /// Whether a set may become a leaf, and is expected to cost no more as one. `split_cost` is the cost of the parts;
    /// all are relative to a line that meets a box of area 1.
    fn prefers_leaf(&self, count: usize, area: f64, split_cost: f64) -> bool {
        count <= self.most_in_leaf()
            && self.intersection_cost * count as f64 * area <= self.traversal_cost * area + split_cost
    }

    fn most_in_leaf(&self) -> usize {
        self.leaf_size.max(1) as usize
    }
}

/// A subtree to be searched, and where its box is entered.
#[derive(Clone, Copy)]
struct Todo {
    entry: f32,
    node: u32,
}

impl Search for Bvh2 {
    #[inline(always)]
    fn closest<K: Descend, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = Stack::<Todo, MAX_DEPTH>::new();
        let mut current = 0;
        loop {
            let node = &self.nodes[current as usize];
            let mut next = None;
            if node.count > 0 {
                for prim in self.leaf(node) {
                    q.prim_closest(at, prim.kind(), best);
                }
            } else {
                q.count_node(2);
                let enter = |node: u32| {
                    let entry = slab::entry(&self.nodes[node as usize].bounds, at.ray)?;
                    (entry <= best.t).then_some(Todo { entry, node })
                };
                next = match (enter(node.first), enter(node.first + 1)) {
                    (Some(a), Some(b)) => {
                        let (near, far) = if b.entry < a.entry { (b, a) } else { (a, b) };
                        stack.push(far);
                        Some(near.node)
                    }
                    (a, b) => a.or(b).map(|todo| todo.node),
                };
            }
            current = match next {
                Some(node) => node,
                // Nothing is skipped but what is entered strictly beyond the best t.
                None => loop {
                    match stack.pop() {
                        None => return,
                        Some(todo) if todo.entry <= best.t => break todo.node,
                        Some(_) => {}
                    }
                },
            };
        }
    }

    #[inline(always)]
    fn occluded<K: Descend, const COUNT: bool>(&self, q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let mut stack = Stack::<u32, MAX_DEPTH>::new();
        let mut current = 0;
        loop {
            let node = &self.nodes[current as usize];
            let mut next = None;
            if node.count > 0 {
                if self.leaf(node).iter().any(|prim| q.prim_occluded(at, prim.kind())) {
                    return true;
                }
            } else {
                q.count_node(2);
                let enter = |node: u32| slab::entry(&self.nodes[node as usize].bounds, at.ray).map(|_| node);
                let (a, b) = (enter(node.first), enter(node.first + 1));
                if let (Some(_), Some(b)) = (a, b) {
                    stack.push(b);
                }
                next = a.or(b);
            }
            match next.or_else(|| stack.pop()) {
                Some(node) => current = node,
                None => return false,
            }
        }
    }
}

impl Built for Bvh2 {
    fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.prims.as_slice())
    }

    fn stats(&self) -> Stats {
        let mut out = Stats { references: self.prims.len(), ..Stats::default() };
        let step = self.params.traversal_cost / self.params.intersection_cost;
        let whole = self.nodes.first().map_or(0.0, |root| half_area(&root.bounds));
        let mut stack: Vec<(u32, u32)> = self.nodes.first().map(|_| (0, 0)).into_iter().collect();
        while let Some((i, depth)) = stack.pop() {
            let node = &self.nodes[i as usize];
            let chance = chance(half_area(&node.bounds), whole);
            out.depth = out.depth.max(depth);
            if node.count > 0 {
                out.leaves += 1;
                out.sah_cost += chance * f64::from(node.count);
            } else {
                out.nodes += 1;
                out.sah_cost += chance * step;
                stack.extend([(node.first, depth + 1), (node.first + 1, depth + 1)]);
            }
        }
        out
    }

    fn section(&self, z: f64) -> Vec<Section> {
        let mut out = Vec::new();
        let mut stack: Vec<(u32, u32)> = self.nodes.first().map(|_| (0, 0)).into_iter().collect();
        while let Some((i, depth)) = stack.pop() {
            let node = &self.nodes[i as usize];
            let outline = node.bounds.slice(z);
            let primitives = (node.count > 0).then_some(node.count as usize);
            if primitives.is_none() {
                stack.extend([(node.first, depth + 1), (node.first + 1, depth + 1)]);
            }
            if outline.len() >= 3 {
                out.push(Section { outline, depth, primitives });
            }
        }
        out
    }
}
