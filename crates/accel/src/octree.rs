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
//! By `partition.rs`. A primitive goes to the children that its padded box touches. Rays walk the tree by
//! `cells.rs`.

use crate::{
    cells::{self, CellOptions, Cells, Interval, Later, Opened, Todo},
    clip::Limits,
    local::LocalRay,
    partition::{self, Budget, crossing, early, half_area, late},
    prim::{Packed, Prim},
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

#[derive(Clone, Copy, Debug)]
enum Node {
    /// The middle, and the index of the first of eight children.
    Inner { middle: Vec3, children: u32 },
    /// `count` references from `first` on.
    Leaf { first: u32, count: u32 },
}

/// Bytes of a node.
pub(crate) const NODE_BYTES: usize = size_of::<Node>();

/// The tree.
pub(crate) struct Octree {
    /// Around all primitives.
    bounds: Bounds,
    /// Never empty; the root is the first.
    nodes: Vec<Node>,
    references: Vec<Packed>,
    params: OctreeParams,
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
        cells::validate(self, prims, prims.to_vec(), |cut, p| {
            (0..8).filter(|&i| touches(&p.bounds, cut.middle, i)).map(|i| cut.child(i)).collect::<Vec<_>>()
        })
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

/// The middle of a cell, and the first of its eight children.
#[derive(Clone, Copy)]
pub(crate) struct Cut {
    middle: Vec3,
    children: u32,
}

impl Cut {
    #[inline(always)]
    fn child(&self, i: usize) -> u32 {
        self.children + i as u32
    }
}

impl Cells for Octree {
    type Cut = Cut;
    type Line<'a> = &'a LocalRay;
    type Part = Interval;
    type Space = Bounds;

    #[inline(always)]
    fn open(&self, node: u32) -> Opened<'_, Cut> {
        match self.nodes[node as usize] {
            Node::Leaf { first, count } => Opened::Leaf(&self.references[first as usize..][..count as usize]),
            Node::Inner { middle, children } => Opened::Inner(Cut { middle, children }),
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
        &Limits::NONE
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
        let t = [0, 1, 2].map(|axis| crossing(cut.middle[axis], axis, ray));
        // The farthest first, since the stack gives the last one first.
        for step in (0..8).rev() {
            let mut part = part;
            for (axis, &t) in t.iter().enumerate() {
                if step >> axis & 1 == 0 {
                    part.exit = ops::min(part.exit, late(t));
                } else {
                    part.enter = ops::max(part.enter, early(t));
                }
            }
            if part.enter <= part.exit {
                later.push(Todo { node: cut.child(step ^ usize::from(ray.octant)), part });
            }
        }
        later.pop()
    }

    fn root_space(&self) -> Bounds {
        cube(&self.bounds)
    }

    /// Cells count as far as they lie in the box around the primitives, which rays enter first.
    fn area(&self, space: &Bounds) -> f64 {
        half_area(&space.intersection(self.bounds))
    }

    fn divide(cut: &Cut, space: &Bounds) -> Vec<(u32, Bounds)> {
        (0..8).map(|i| (cut.child(i), eighth(space, cut.middle, i))).collect()
    }
}
