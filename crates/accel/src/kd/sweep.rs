//! Where a cell is cut: every candidate plane is weighed, in the order of its place.

use super::KdParams;
use crate::partition::{chance, half_area};
use straal_math::Bounds;

/// What happens to a primitive's box along an axis, in the order in which a sweep upwards has to hear of it: at a
/// plane where one box ends, another starts and a third lies flat, the first is over, and the last not yet begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    End,
    /// The box is flat, and lies in the plane.
    Flat,
    Start,
}

/// A candidate for a cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    pub at: f32,
    pub kind: Kind,
    /// Whose box it is.
    pub prim: u32,
}

impl Event {
    /// The one or two events of a box along an axis.
    pub fn of(b: &Bounds, axis: usize, prim: u32) -> impl Iterator<Item = Self> {
        // Adding 0 turns -0 into 0, which sorts elsewhere though it is the same plane.
        let (low, high) = (b.min[axis] + 0.0, b.max[axis] + 0.0);
        let event = move |at, kind| Self { at, kind, prim };
        let (first, second) = if low == high {
            (event(low, Kind::Flat), None)
        } else {
            (event(low, Kind::Start), Some(event(high, Kind::End)))
        };
        std::iter::once(first).chain(second)
    }

    /// The order of the lists.
    pub fn cmp(&self, o: &Self) -> std::cmp::Ordering {
        self.at.total_cmp(&o.at).then(self.kind.cmp(&o.kind)).then(self.prim.cmp(&o.prim))
    }
}

/// A cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    pub axis: usize,
    pub plane: f32,
    /// Whether what lies flat in the plane goes to the lower side.
    pub flat_below: bool,
    /// Expected cost, by the formula of `mod.rs`.
    pub cost: f64,
    /// Primitives on the lower and the upper side.
    pub counts: [usize; 2],
}

/// The two parts of a cell.
pub(super) fn halves(cell: &Bounds, axis: usize, plane: f32) -> [Bounds; 2] {
    let (mut lower, mut upper) = (*cell, *cell);
    lower.max[axis] = plane;
    upper.min[axis] = plane;
    [lower, upper]
}

/// The cheaper of the two cuts by a plane with so many primitives below, flat in it, and above.
pub(super) fn weigh(
    params: &KdParams,
    cell: &Bounds,
    (axis, plane): (usize, f32),
    [below, flat, above]: [usize; 3],
) -> Cut {
    let whole = half_area(cell);
    let chances = halves(cell, axis, plane).map(|half| chance(half_area(&half), whole));
    let cut = |flat_below: bool| {
        let counts = if flat_below { [below + flat, above] } else { [below, above + flat] };
        let bonus = if counts.contains(&0) { 1.0 - params.empty_bonus } else { 1.0 };
        let tests = chances[0] * counts[0] as f64 + chances[1] * counts[1] as f64;
        let cost = bonus * (params.traversal_cost + params.intersection_cost * tests);
        Cut { axis, plane, flat_below, cost, counts }
    };
    let (a, b) = (cut(true), cut(false));
    if b.cost < a.cost { b } else { a }
}

/// The cheapest cut of a cell with `n` primitives, whose sorted events are given by axis; of equals, the first.
/// Planes on the cell's own faces cut nothing (Wald and Havran 2006, algorithm 4).
pub(super) fn cheapest(params: &KdParams, cell: &Bounds, events: &[Vec<Event>; 3], n: usize) -> Option<Cut> {
    let mut best: Option<Cut> = None;
    for (axis, events) in events.iter().enumerate() {
        let (mut below, mut above) = (0, n);
        for here in events.chunk_by(|a, b| a.at == b.at) {
            let count = |kind| here.iter().filter(|e| e.kind == kind).count();
            let (ends, flat, starts) = (count(Kind::End), count(Kind::Flat), count(Kind::Start));
            let plane = here[0].at;
            above -= flat + ends;
            if plane > cell.min[axis] && plane < cell.max[axis] {
                let cut = weigh(params, cell, (axis, plane), [below, flat, above]);
                if best.is_none_or(|b| cut.cost < b.cost) {
                    best = Some(cut);
                }
            }
            below += flat + starts;
        }
    }
    best
}
