//! The BSP tree: space cut in two by planes at any angle, taken from the polygons of the scene themselves.
//!
//! | parameter | meaning |
//! |---|---|
//! | `choice` | which of the candidates cuts a cell |
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
//! By `Even`, of a few candidates the plane is taken with the least `straddle_cost` S + |F - B|, where F, B and S primitives lie
//! in front, behind, and on both sides (`choose.rs`). On a convex object every polygon has all others behind it, and
//! such a plane parts nothing: so the plane at right angles to the cell's longest axis, through the median of the
//! primitives' middles, is always a candidate too. It is the only one where there are no triangles. A cell is a leaf
//! when no candidate leaves fewer primitives on both sides, or when C_t + C_i (N_F + N_B) / 2, what it costs if each
//! side is met by half of the rays, isn't less than C_i N.
//!
//! By `Sah`, the plane is taken with the least C_t + C_i (N_F A_F + N_B A_B) / A, the surfaces A being those of the cell, a convex
//! polyhedron (`cell.rs`), and of its parts; a cell is a leaf where that isn't less than C_i N (Ize, Wald and Parker 2008,
//! section 3). As there, the candidates are planes of polygons and planes at right angles to the axes, here just before and
//! behind the same primitives: it is these that cut off empty space.
//!
//! A polygon lies in its own plane, and its neighbours touch it, so that a plane through it would have them all on
//! both sides. The cut is made a hair before the polygon instead: it and what doesn't rise over it are behind.
//!
//! A step takes a scalar product instead of a subtraction, and a node is several times the size of a kd-tree's: this
//! tree is here to be compared, not to win.
//!
//! # Exactness
//! By `partition.rs` and `plane.rs`: a triangle is on the sides that its vertices touch, anything else on those that
//! its padded box touches. Rays walk the tree by `cells.rs`.

mod build;
mod cell;
mod choose;
mod params;
mod plane;

pub use params::{BspChoice, BspParams};

use crate::{
    cells::{self, CellOptions, Cells, Later, Opened, Todo},
    clip::Limits,
    local::LocalRay,
    partition,
    prim::{Packed, Prim},
};
use cell::Cell;
use plane::{Interval, Line, Plane, Side};
use straal_math::{Bounds, Vec3};

/// A node. Nodes lie in depth-first order: an inner node's front child comes right after it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Node {
    /// Cut by a plane; `back` is the index of the other child.
    Inner { plane: Plane, back: u32 },
    /// `count` references from `first` on.
    Leaf { first: u32, count: u32 },
}

/// Bytes of a node.
pub(crate) const NODE_BYTES: usize = size_of::<Node>();

/// The tree.
pub(crate) struct BspTree {
    /// Around all primitives.
    bounds: Bounds,
    /// Never empty; the root is the first.
    nodes: Vec<Node>,
    references: Vec<Packed>,
    limits: Limits,
    params: BspParams,
}

impl BspTree {
    /// Builds the tree over primitives; `vertices` gives a triangle's by its number in the group.
    pub fn build(prims: &[Prim], params: &BspParams, vertices: impl Fn(u32) -> [Vec3; 3]) -> Self {
        build::build(prims, params, &vertices)
    }

    /// Every primitive in all leaves that it touches, no deeper than the stack allows.
    pub fn validate(&self, prims: &[Prim], vertices: impl Fn(u32) -> [Vec3; 3]) -> Result<(), String> {
        cells::validate(self, prims, prims.to_vec(), |cut, p| {
            let side = cut.plane.side_of(p, &vertices);
            let front = (side != Side::Back).then_some(cut.front);
            let back = (side != Side::Front).then_some(cut.back);
            [front, back].into_iter().flatten()
        })
    }
}

/// A plane, with the nodes before and behind it.
#[derive(Clone, Copy)]
pub(crate) struct Cut {
    plane: Plane,
    front: u32,
    back: u32,
}

impl Cells for BspTree {
    type Cut = Cut;
    type Line<'a> = Line;
    type Part = Interval;
    type Space = Cell;

    #[inline(always)]
    fn open(&self, node: u32) -> Opened<'_, Cut> {
        match self.nodes[node as usize] {
            Node::Leaf { first, count } => Opened::Leaf(&self.references[first as usize..][..count as usize]),
            Node::Inner { plane, back } => Opened::Inner(Cut { plane, front: node + 1, back }),
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
    fn line(ray: &LocalRay) -> Line {
        Line::new(ray)
    }

    #[inline(always)]
    fn cross(cut: &Cut, line: &Line, part: Interval, later: &mut Later<Interval>) -> Option<Todo<Interval>> {
        let [front, back] = cut.plane.parts(line, part);
        let front = front.map(|part| Todo { node: cut.front, part });
        let back = back.map(|part| Todo { node: cut.back, part });
        match (front, back) {
            (Some(a), Some(b)) => {
                // Entered at once, the side that is left first is the nearer one.
                let order = |t: &Todo<Interval>| (t.part.enter, t.part.exit);
                let (near, far) = if order(&b) < order(&a) { (b, a) } else { (a, b) };
                later.push(far);
                Some(near)
            }
            (only, None) | (None, only) => only,
        }
    }

    fn root_space(&self) -> Cell {
        Cell::of_box(&partition::finite(&self.bounds))
    }

    fn area(&self, space: &Cell) -> f64 {
        space.area()
    }

    fn divide(cut: &Cut, space: &Cell) -> Vec<(u32, Cell)> {
        let [front, back] = space.cut(&cut.plane);
        vec![(cut.front, front), (cut.back, back)]
    }
}
