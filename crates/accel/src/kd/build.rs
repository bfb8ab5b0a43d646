//! Building in O(n log n) (Wald and Havran 2006, "On building fast kd-trees for ray tracing, and on doing that in O(N
//! log N)", section 4.3).
//!
//! Events are sorted once. A cut tells for each primitive whether it lies below, above or across (`classify`). Events
//! of the former two go to their side, in their order; those of primitives across are made anew for the box' part on
//! each side, sorted, and merged. Where few are across, of the order of sqrt n, a level takes O(n), and there are
//! O(log n) of them.
//!
//! Deviations from the paper: a list for each axis instead of one for all; a bound on depth and on the number of
//! references (`partition::Budget`).

use super::{
    KdParams, KdTree, Node,
    sweep::{self, Cut, Event, Kind},
};
use crate::{
    clip::{self, Limits},
    partition::{self, Budget, depth_limit},
    prim::{Packed, Prim, PrimKind},
};
use straal_math::{Bounds, Vec3};

type Vertices<'a> = dyn Fn(u32) -> [Vec3; 3] + 'a;

pub(super) fn build(prims: &[Prim], params: &KdParams, vertices: &Vertices<'_>) -> KdTree {
    let bounds = prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds));
    let mut builder = Builder {
        prims,
        vertices,
        params: *params,
        max_depth: depth_limit(params.max_depth, prims.len()),
        sides: vec![Side::Across; prims.len()],
        nodes: Vec::new(),
        references: Vec::new(),
    };
    let cell = partition::finite(&bounds);
    let mut events = [const { Vec::new() }; 3];
    for (i, prim) in prims.iter().enumerate() {
        add_events(&mut events, &prim.bounds.intersection(cell), i as u32);
    }
    events.iter_mut().for_each(|list| list.sort_unstable_by(Event::cmp));
    builder.subtree(Cell { bounds: cell, count: prims.len(), events, depth: 0 }, Budget::of(prims.len()));
    builder.nodes.shrink_to_fit();
    builder.references.shrink_to_fit();
    let limits = if params.clip { Limits::of(prims, vertices) } else { Limits::NONE };
    KdTree { bounds, nodes: builder.nodes, references: builder.references, limits, params: *params }
}

fn add_events(events: &mut [Vec<Event>; 3], b: &Bounds, prim: u32) {
    for (axis, list) in events.iter_mut().enumerate() {
        list.extend(Event::of(b, axis, prim));
    }
}

/// Where a primitive lies from a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Below,
    Above,
    Across,
}

/// What is still to be built: a box in space, and the primitives in it by their sorted events.
struct Cell {
    bounds: Bounds,
    count: usize,
    events: [Vec<Event>; 3],
    depth: u32,
}

impl Cell {
    /// The primitives in it, each once.
    fn prims(&self) -> impl Iterator<Item = u32> {
        self.events[0].iter().filter(|e| e.kind != Kind::End).map(|e| e.prim)
    }
}

struct Builder<'a> {
    prims: &'a [Prim],
    vertices: &'a Vertices<'a>,
    params: KdParams,
    max_depth: u32,
    /// By primitive, where it lies from the latest cut; of use while that is made.
    sides: Vec<Side>,
    nodes: Vec<Node>,
    references: Vec<Packed>,
}

impl Builder<'_> {
    /// Builds a cell and all below it, at most `MAX_DEPTH` deep.
    fn subtree(&mut self, cell: Cell, budget: Budget) {
        let Some((cut, shares)) = self.choose(&cell, budget) else {
            self.leaf(&cell);
            return;
        };
        let node = self.nodes.len();
        let [lower, upper] = self.divide(cell, &cut);
        self.nodes.push(Node::Inner { axis: cut.axis as u8, plane: cut.plane, upper: 0 });
        self.subtree(lower, shares[0]);
        let upper_index = self.nodes.len() as u32;
        self.nodes[node] = Node::Inner { axis: cut.axis as u8, plane: cut.plane, upper: upper_index };
        self.subtree(upper, shares[1]);
    }

    /// The cut of a cell, unless it is better left alone.
    fn choose(&self, cell: &Cell, budget: Budget) -> Option<(Cut, [Budget; 2])> {
        if cell.depth >= self.max_depth || cell.count <= self.params.leaf_size as usize {
            return None;
        }
        let cut = sweep::cheapest(&self.params, &cell.bounds, &cell.events, cell.count)?;
        let alone = self.params.intersection_cost * cell.count as f64;
        if cut.cost >= alone {
            return None;
        }
        Some((cut, budget.share(cut.counts)?))
    }

    fn leaf(&mut self, cell: &Cell) {
        let mut prims: Vec<u32> = cell.prims().collect();
        prims.sort_unstable();
        let first = self.references.len() as u32;
        self.references.extend(prims.iter().map(|&i| self.prims[i as usize].kind.packed()));
        self.nodes.push(Node::Leaf { first, count: prims.len() as u32 });
    }

    /// Notes for each primitive of a cell where it lies (algorithm 6).
    fn classify(&mut self, cell: &Cell, cut: &Cut) {
        for prim in cell.prims() {
            self.sides[prim as usize] = Side::Across;
        }
        for e in &cell.events[cut.axis] {
            let side = match e.kind {
                Kind::End if e.at <= cut.plane => Side::Below,
                Kind::Start if e.at >= cut.plane => Side::Above,
                Kind::Flat if e.at < cut.plane || (e.at == cut.plane && cut.flat_below) => Side::Below,
                Kind::Flat => Side::Above,
                Kind::End | Kind::Start => continue,
            };
            self.sides[e.prim as usize] = side;
        }
    }

    /// The two cells of a cut.
    fn divide(&mut self, cell: Cell, cut: &Cut) -> [Cell; 2] {
        self.classify(&cell, cut);
        let mut halves = sweep::halves(&cell.bounds, cut.axis, cut.plane).map(|bounds| Cell {
            bounds,
            count: 0,
            events: [const { Vec::new() }; 3],
            depth: cell.depth + 1,
        });
        for (half, side) in halves.iter_mut().zip([Side::Below, Side::Above]) {
            let mut across = [const { Vec::new() }; 3];
            for prim in cell.prims() {
                if self.sides[prim as usize] == Side::Across {
                    if let Some(b) = self.part(prim, &half.bounds) {
                        add_events(&mut across, &b, prim);
                        half.count += 1;
                    }
                } else if self.sides[prim as usize] == side {
                    half.count += 1;
                }
            }
            for ((to, from), across) in half.events.iter_mut().zip(&cell.events).zip(&mut across) {
                across.sort_unstable_by(Event::cmp);
                let stay = from.iter().filter(|e| self.sides[e.prim as usize] == side);
                *to = merge(stay, across);
            }
        }
        halves
    }

    /// The box of a primitive's part in a cell; `None` when it turns out to have none.
    fn part(&self, prim: u32, cell: &Bounds) -> Option<Bounds> {
        let prim = &self.prims[prim as usize];
        let part = prim.bounds.intersection(*cell);
        match prim.kind {
            PrimKind::Triangle(id) if self.params.clip => clip::part(&(self.vertices)(id), &part),
            _ => Some(part),
        }
    }
}

/// Two sorted lists as one.
fn merge<'a>(a: impl Iterator<Item = &'a Event>, b: &[Event]) -> Vec<Event> {
    let mut out = Vec::new();
    let mut b = b.iter().peekable();
    for e in a {
        while let Some(first) = b.next_if(|x| x.cmp(e).is_lt()) {
            out.push(*first);
        }
        out.push(*e);
    }
    out.extend(b);
    out
}

#[cfg(test)]
mod tests;
