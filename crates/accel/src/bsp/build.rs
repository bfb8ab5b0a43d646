//! Which planes cut a BSP tree.

use super::{
    BspParams, BspTree, Node,
    plane::{Plane, Side},
};
use crate::{
    clip::Limits,
    partition::{Budget, depth_limit},
    structure::{Packed, Prim, PrimKind},
};
use straal_math::{Bounds, DVec3, Vec3};

type Vertices<'a> = dyn Fn(u32) -> [Vec3; 3] + 'a;

pub(super) fn build(prims: &[Prim], params: &BspParams, vertices: &Vertices<'_>) -> BspTree {
    let bounds = prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds));
    let max_depth = depth_limit(params.max_depth, prims.len());
    let mut builder =
        Builder { prims, vertices, params: *params, max_depth, nodes: Vec::new(), references: Vec::new() };
    builder.subtree((0..prims.len() as u32).collect(), 0, Budget::of(prims.len()));
    builder.nodes.shrink_to_fit();
    builder.references.shrink_to_fit();
    let limits = Limits::of(prims, vertices);
    BspTree { bounds, nodes: builder.nodes, references: builder.references, limits, params: *params }
}

struct Builder<'a> {
    prims: &'a [Prim],
    vertices: &'a Vertices<'a>,
    params: BspParams,
    max_depth: u32,
    nodes: Vec<Node>,
    references: Vec<Packed>,
}

/// On which side of a plane a primitive is looked for.
pub(super) fn side(plane: &Plane, prim: &Prim, vertices: &Vertices<'_>) -> Side {
    match prim.kind {
        PrimKind::Triangle(id) => plane.side_of_triangle(&vertices(id)),
        PrimKind::Object(_) => plane.side_of_box(&prim.bounds),
    }
}

/// A plane with the primitives on both sides of it.
struct Cut {
    plane: Plane,
    score: f64,
    /// Those that touch the front, and the back.
    counts: [usize; 2],
}

impl Builder<'_> {
    /// Builds a cell, given by its primitives, and all below it, at most `MAX_DEPTH` deep.
    fn subtree(&mut self, cell: Vec<u32>, depth: u32, budget: Budget) {
        let chosen = self.choose(&cell, depth).and_then(|cut| Some((budget.share(cut.counts)?, cut)));
        let Some((shares, cut)) = chosen else {
            let first = self.references.len() as u32;
            self.references.extend(cell.iter().map(|&i| self.prims[i as usize].kind.packed()));
            self.nodes.push(Node::Leaf { first, count: cell.len() as u32 });
            return;
        };
        let [front, back] = self.divide(&cell, &cut);
        drop(cell);
        let node = self.nodes.len();
        self.nodes.push(Node::Inner { plane: cut.plane, back: 0 });
        self.subtree(front, depth + 1, shares[0]);
        self.nodes[node] = Node::Inner { plane: cut.plane, back: self.nodes.len() as u32 };
        self.subtree(back, depth + 1, shares[1]);
    }

    /// The best of the candidates, unless the cell is better left alone.
    fn choose(&self, cell: &[u32], depth: u32) -> Option<Cut> {
        if depth >= self.max_depth || cell.len() <= self.params.leaf_size as usize {
            return None;
        }
        let mut best: Option<Cut> = None;
        for plane in self.candidates(cell) {
            let cut = self.weigh(cell, plane);
            // A plane that leaves everything on one side would be found again below.
            let parts = cut.counts.iter().all(|&n| n < cell.len());
            if parts && best.as_ref().is_none_or(|b| cut.score < b.score) {
                best = Some(cut);
            }
        }
        let cut = best?;
        let n = |n: usize| self.params.intersection_cost * n as f64;
        let halves = self.params.traversal_cost + n(cut.counts[0] + cut.counts[1]) / 2.0;
        (halves < n(cell.len())).then_some(cut)
    }

    /// The planes just before some triangles, and the one through the median across the longest axis.
    fn candidates(&self, cell: &[u32]) -> Vec<Plane> {
        let wanted = (self.params.candidates as usize).min(cell.len());
        let mut out: Vec<Plane> = (0..wanted)
            .filter_map(|i| match self.prims[cell[i * cell.len() / wanted] as usize].kind {
                PrimKind::Triangle(id) => Plane::before_triangle(&(self.vertices)(id)),
                PrimKind::Object(_) => None,
            })
            .collect();
        let middle = |&i: &u32| {
            let b = crate::partition::finite(&self.prims[i as usize].bounds);
            (b.min * 0.5 + b.max * 0.5).as_dvec3()
        };
        let (low, high) = cell
            .iter()
            .map(middle)
            .fold((DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        let axis = (high - low).max_axis();
        let mut middles: Vec<f64> = cell.iter().map(|i| middle(i)[axis]).collect();
        let half = middles.len() / 2;
        if !middles.is_empty() {
            let (_, median, _) = middles.select_nth_unstable_by(half, f64::total_cmp);
            out.push(Plane::across(axis, *median));
        }
        out
    }

    fn weigh(&self, cell: &[u32], plane: Plane) -> Cut {
        let (mut front, mut back, mut across) = (0, 0, 0);
        for &prim in cell {
            match self.side(&plane, prim) {
                Side::Front => front += 1,
                Side::Back => back += 1,
                Side::Across => across += 1,
            }
        }
        let score = self.params.straddle_cost * across as f64 + (front as f64 - back as f64).abs();
        Cut { plane, score, counts: [front + across, back + across] }
    }

    fn divide(&self, cell: &[u32], cut: &Cut) -> [Vec<u32>; 2] {
        let mut parts = cut.counts.map(Vec::with_capacity);
        for &prim in cell {
            let side = self.side(&cut.plane, prim);
            if side != Side::Back {
                parts[0].push(prim);
            }
            if side != Side::Front {
                parts[1].push(prim);
            }
        }
        parts
    }

    fn side(&self, plane: &Plane, prim: u32) -> Side {
        side(plane, &self.prims[prim as usize], self.vertices)
    }
}
