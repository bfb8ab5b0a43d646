//! The octree: a cube cut in eight at its middle, the eighths again, until few primitives are left in each.
//!
//! | parameter | meaning |
//! |---|---|
//! | `max_depth` | most levels below the root |
//! | `leaf_size` | cells of so few primitives aren't cut |
//! | `mailboxes` | whether a ray remembers what it tested |
//! | `traversal_cost` | C_t, a step through a node, for the reported cost |
//! | `intersection_cost` | C_i, the test of one primitive, for the reported cost |
//!
//! The oldest of the trees for rays (Glassner 1984, "Space subdivision for fast ray tracing"): nothing is measured,
//! nothing is weighed, and it adapts to where things are, which a grid doesn't. A node has a middle and eight
//! children. The child's number has a bit for each axis, set in the upper half; going through the numbers 0 to 7,
//! each with the bits of the ray's negative directions inverted, meets the children front to back: one of them can
//! hide another only if it is in the nearer half on every axis on which they differ, and such a one has a lower
//! number.
//!
//! It cuts where the middle is, not where it pays, and so is deep where a dense object is small in its scene, and
//! puts what lies on a middle plane in many leaves.
//!
//! # Exactness
//! By `partition.rs`. A primitive goes to the children that its padded box touches.

use crate::{
    hit::Hit,
    input::Shapes,
    kernel::{Kernel, stack::Stack},
    mailbox::Mailboxes,
    partition::{self, Budget, Census, chance, crossing, early, half_area, late},
    query::Query,
    structure::{Packed, Place, Prim, Search, Stats},
};
use straal_math::{Bounds, Vec3, ops};

/// Parameters of the octree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OctreeParams {
    /// The most levels below the root, at most 24: single precision can't cut much further.
    pub max_depth: u32,
    /// Cells of so few primitives aren't cut.
    pub leaf_size: u32,
    /// Whether a ray remembers the primitives that it tested last, so that one in several leaves is tested once.
    pub mailboxes: bool,
    /// Cost of a step through a node, for the reported cost.
    pub traversal_cost: f64,
    /// Cost of the test of one primitive, for the reported cost.
    pub intersection_cost: f64,
}

impl OctreeParams {
    /// Deep enough for an object a hundred times smaller than its scene.
    pub const DEFAULT: Self =
        Self { max_depth: 12, leaf_size: 8, mailboxes: true, traversal_cost: 1.0, intersection_cost: 1.0 };
}

impl Default for OctreeParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The most levels below the root.
const MAX_DEPTH: u32 = 24;

/// What a search's stack must hold: seven more on each level.
const STACK: usize = 7 * MAX_DEPTH as usize + 1;

#[derive(Clone, Copy, Debug)]
enum Node {
    /// The middle, and the index of the first of eight children.
    Inner { middle: Vec3, children: u32 },
    /// `count` references from `first` on.
    Leaf { first: u32, count: u32 },
}

/// The tree.
pub(crate) struct Octree {
    /// Around all primitives.
    bounds: Bounds,
    /// Never empty; the root is the first.
    nodes: Vec<Node>,
    references: Vec<Packed>,
    params: OctreeParams,
}

/// A subtree that is still to be visited, and the ray's interval in it.
#[derive(Clone, Copy)]
struct Todo {
    node: u32,
    enter: f32,
    exit: f32,
}

impl Octree {
    pub fn build(prims: &[Prim], params: &OctreeParams) -> Self {
        let bounds = prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds));
        let leaf = Node::Leaf { first: 0, count: 0 };
        let mut tree = Self { bounds, nodes: vec![leaf], references: Vec::new(), params: *params };
        let all = (0..prims.len() as u32).collect();
        tree.subtree(prims, 0, Cell { cube: cube(&bounds), prims: all, depth: 0 }, Budget::of(prims.len()));
        tree.nodes.shrink_to_fit();
        tree.references.shrink_to_fit();
        tree
    }

    /// Builds a cell and all below it.
    fn subtree(&mut self, prims: &[Prim], node: usize, cell: Cell, budget: Budget) {
        let Some((middle, eighths, shares)) = self.divide(prims, &cell, budget) else {
            let first = self.references.len() as u32;
            self.nodes[node] = Node::Leaf { first, count: cell.prims.len() as u32 };
            self.references.extend(cell.prims.iter().map(|&i| prims[i as usize].kind.packed()));
            return;
        };
        drop(cell);
        let children = self.nodes.len();
        self.nodes[node] = Node::Inner { middle, children: children as u32 };
        self.nodes.extend([Node::Leaf { first: 0, count: 0 }; 8]);
        for (i, (eighth, share)) in eighths.into_iter().zip(shares).enumerate() {
            self.subtree(prims, children + i, eighth, share);
        }
    }

    /// The eight parts of a cell, unless it is a leaf.
    fn divide(&self, prims: &[Prim], cell: &Cell, budget: Budget) -> Option<(Vec3, [Cell; 8], [Budget; 8])> {
        let n = cell.prims.len();
        if n <= self.params.leaf_size as usize || cell.depth >= self.params.max_depth.min(MAX_DEPTH) {
            return None;
        }
        let middle = cell.cube.center();
        let is_inside =
            |axis: usize| middle[axis] > cell.cube.min[axis] && middle[axis] < cell.cube.max[axis];
        if !(0..3).all(is_inside) {
            return None;
        }
        let mut eighths: [Cell; 8] = std::array::from_fn(|i| Cell {
            cube: eighth(&cell.cube, middle, i),
            prims: Vec::new(),
            depth: cell.depth + 1,
        });
        for &prim in &cell.prims {
            let b = &prims[prim as usize].bounds;
            for (i, part) in eighths.iter_mut().enumerate() {
                if touches(b, middle, i) {
                    part.prims.push(prim);
                }
            }
        }
        // Where everything lies across the middle, as copies of one primitive do, nothing is gained.
        if eighths.iter().all(|part| part.prims.len() == n) {
            return None;
        }
        let shares = budget.share(std::array::from_fn(|i| eighths[i].prims.len()))?;
        Some((middle, eighths, shares))
    }

    /// Every primitive in all leaves that its box touches.
    pub fn validate(&self, prims: &[Prim]) -> Result<(), String> {
        let mut census = Census::new(prims);
        let mut stack = vec![(0_u32, prims.to_vec(), 0)];
        while let Some((node, needed, depth)) = stack.pop() {
            match self.nodes[node as usize] {
                Node::Leaf { first, count } => {
                    let leaf = &self.references[first as usize..][..count as usize];
                    census.leaf(leaf, &needed, depth)?;
                }
                Node::Inner { middle, children } => {
                    for i in 0..8 {
                        let part = needed.iter().filter(|p| touches(&p.bounds, middle, i)).copied().collect();
                        stack.push((children + i as u32, part, depth + 1));
                    }
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
        let negative = usize::from(at.ray.octant);
        let mut stack = Stack::<Todo, STACK>::new();
        stack.push(Todo { node: 0, enter, exit });
        // The least t beyond which nothing matters.
        let mut limit = exit;
        while let Some(todo) = stack.pop() {
            if todo.enter > limit {
                continue;
            }
            q.count_node(0);
            let (middle, children) = match self.nodes[todo.node as usize] {
                Node::Leaf { first, count } => {
                    let references = &self.references[first as usize..][..count as usize];
                    limit = ops::min(limit, leaf(q, references));
                    continue;
                }
                Node::Inner { middle, children } => (middle, children),
            };
            let t = [0, 1, 2].map(|axis| crossing(middle[axis], axis, at.ray));
            // The farthest first, since the stack gives the last one first.
            for step in (0..8).rev() {
                let child = step ^ negative;
                let mut next = Todo { node: children + child as u32, ..todo };
                for (axis, &t) in t.iter().enumerate() {
                    if step >> axis & 1 == 0 {
                        next.exit = ops::min(next.exit, late(t));
                    } else {
                        next.enter = ops::max(next.enter, early(t));
                    }
                }
                if next.enter <= next.exit && next.enter <= limit {
                    stack.push(next);
                }
            }
        }
    }
}

/// A part of space, and the primitives that touch it.
struct Cell {
    cube: Bounds,
    prims: Vec<u32>,
    depth: u32,
}

/// Whether a box touches a part of a cell, whose set bits stand for the upper half on that axis.
fn touches(b: &Bounds, middle: Vec3, bits: usize) -> bool {
    (0..3).all(
        |axis| {
            if bits >> axis & 1 == 0 { b.min[axis] <= middle[axis] } else { b.max[axis] >= middle[axis] }
        },
    )
}

/// The cube around a box, its numbers finite.
fn cube(b: &Bounds) -> Bounds {
    if b.is_empty() {
        return *b;
    }
    let b = partition::finite(b);
    let (middle, half) = (b.center(), (b.max * 0.5 - b.min * 0.5).max_element());
    partition::finite(&Bounds { min: middle - Vec3::splat(half), max: middle + Vec3::splat(half) })
}

/// A part of a cell.
fn eighth(cell: &Bounds, middle: Vec3, bits: usize) -> Bounds {
    let mut out = *cell;
    for axis in 0..3 {
        if bits >> axis & 1 == 0 {
            out.max[axis] = middle[axis];
        } else {
            out.min[axis] = middle[axis];
        }
    }
    out
}

impl Search for Octree {
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

    /// Cells count as far as they lie in the box around the primitives, which rays enter first.
    fn stats(&self) -> Stats {
        let mut out = Stats { references: self.references.len(), ..Stats::default() };
        let whole = half_area(&self.bounds);
        let step = self.params.traversal_cost / self.params.intersection_cost;
        let mut stack = vec![(0_u32, cube(&self.bounds), 0)];
        while let Some((node, cell, depth)) = stack.pop() {
            out.depth = out.depth.max(depth);
            let chance = chance(half_area(&cell.intersection(self.bounds)), whole);
            match self.nodes[node as usize] {
                Node::Leaf { count, .. } => {
                    out.leaves += 1;
                    out.sah_cost += chance * f64::from(count);
                }
                Node::Inner { middle, children } => {
                    out.nodes += 1;
                    out.sah_cost += chance * step;
                    for i in 0..8 {
                        stack.push((children + i as u32, eighth(&cell, middle, i), depth + 1));
                    }
                }
            }
        }
        out
    }
}
