//! From the top down: sets are cut in two along an axis until they are leaves.
//!
//! Primitives are sorted once along each axis by their boxes' centres, and cutting a set keeps its three orders (as Wald
//! and Havran 2006 do for kd-trees), so that a tree takes O(n log n). Each kind of tree only chooses where to cut: the surface
//! area heuristic looks at all n - 1 places on each axis.

use super::{Bvh2, Node, Split};
use crate::{partition::half_area, prim::Prim};
use rayon::prelude::*;
use straal_math::{Bounds, ops};

/// Cuts below this depth are halves, whatever the kind of tree: degenerate scenes get no deeper than this + 30.
const FREE_DEPTH: usize = 96;

/// A set of primitives, as a range of each order, and its depth.
#[derive(Clone, Copy)]
struct Set {
    start: usize,
    end: usize,
    depth: usize,
}

impl Set {
    const fn len(&self) -> usize {
        self.end - self.start
    }
}

/// After which primitive in the order of which axis to cut.
#[derive(Clone, Copy)]
struct Cut {
    axis: usize,
    count: usize,
}

struct Builder<'a> {
    prims: &'a [Prim],
    /// Primitives sorted along each axis.
    order: [Vec<u32>; 3],
    /// By primitive, whether it goes left in the cut at hand.
    left: Vec<bool>,
    /// Room for the ones that go right.
    right: Vec<u32>,
    /// By place in the order at hand, the area of the box around all from there on.
    areas: Vec<f64>,
    out: &'a mut Bvh2,
}

pub(super) fn build(out: &mut Bvh2, prims: &[Prim]) {
    let order = std::array::from_fn(|axis| {
        let mut order: Vec<u32> = (0..prims.len() as u32).collect();
        let center = |i: u32| center(&prims[i as usize], axis);
        order.par_sort_unstable_by(|&a, &b| center(a).total_cmp(&center(b)).then(a.cmp(&b)));
        order
    });
    let (left, areas) = (vec![false; prims.len()], vec![0.0; prims.len()]);
    let mut builder = Builder { prims, order, left, right: Vec::new(), areas, out };
    builder.out.nodes.push(Node { bounds: Bounds::EMPTY, first: 0, count: 0 });
    builder.subtree(0, Set { start: 0, end: prims.len(), depth: 0 });
}

/// Twice the centre of a box, finite even where padding isn't.
pub(super) fn center(prim: &Prim, axis: usize) -> f64 {
    let finite = |x: f32| f64::from(ops::clamp(x, f32::MIN, f32::MAX));
    finite(prim.bounds.min[axis]) + finite(prim.bounds.max[axis])
}

impl Builder<'_> {
    /// Builds a set below the node at `slot`.
    fn subtree(&mut self, slot: usize, set: Set) {
        let bounds = self.order[0][set.start..set.end]
            .iter()
            .fold(Bounds::EMPTY, |b, &i| b.union(self.prims[i as usize].bounds));
        let Some(cut) = self.choose(&set, &bounds) else {
            let first = self.out.prims.len() as u32;
            let members = &self.order[0][set.start..set.end];
            self.out.prims.extend(members.iter().map(|&i| self.prims[i as usize].kind.packed()));
            self.out.nodes[slot] = Node { bounds, first, count: set.len() as u32 };
            return;
        };
        self.cut(&set, cut);
        let child = self.out.nodes.len();
        let inner = Node { bounds, first: child as u32, count: 0 };
        self.out.nodes[slot] = inner;
        self.out.nodes.extend([inner, inner]);
        let (middle, depth) = (set.start + cut.count, set.depth + 1);
        self.subtree(child, Set { end: middle, depth, ..set });
        self.subtree(child + 1, Set { start: middle, depth, ..set });
    }

    /// Where to cut a set; `None` when it becomes a leaf.
    fn choose(&mut self, set: &Set, bounds: &Bounds) -> Option<Cut> {
        let params = self.out.params;
        if set.len() == 1 {
            return None;
        }
        if params.split == Split::Sah {
            let (cut, areas_times_counts) = self.cheapest(set);
            if params.prefers_leaf(
                set.len(),
                half_area(bounds),
                areas_times_counts * params.intersection_cost,
            ) {
                return None;
            }
            if set.depth < FREE_DEPTH {
                return Some(cut);
            }
        } else if set.len() <= params.most_in_leaf() {
            return None;
        }
        let ends = |axis: usize| {
            let order = &self.order[axis][set.start..set.end];
            let center = |i: u32| center(&self.prims[i as usize], axis);
            (center(order[0]), center(order[order.len() - 1]))
        };
        let width = |axis: usize| ends(axis).1 - ends(axis).0;
        let axis = (1..3).fold(0, |best, axis| if width(axis) > width(best) { axis } else { best });
        let half = Cut { axis, count: set.len() / 2 };
        if params.split != Split::Middle || set.depth >= FREE_DEPTH {
            return Some(half);
        }
        let middle = (ends(axis).0 + ends(axis).1) * 0.5;
        let order = &self.order[axis][set.start..set.end];
        let count = order.partition_point(|&i| center(&self.prims[i as usize], axis) < middle);
        // Nothing is on one side where all centres are the same.
        Some(if count == 0 || count == set.len() { half } else { Cut { axis, count } })
    }

    /// The cut with the least sum of each side's area times its number of primitives, and that sum. Of equal ones, the
    /// most even, so that copies in one place don't make a list of the tree.
    fn cheapest(&mut self, set: &Set) -> (Cut, f64) {
        let n = set.len();
        let uneven = |count: usize| count.abs_diff(n - count);
        let mut best = (Cut { axis: 0, count: n / 2 }, f64::INFINITY);
        for axis in 0..3 {
            let order = &self.order[axis][set.start..set.end];
            let bounds = |i: usize| self.prims[order[i] as usize].bounds;
            let mut after = Bounds::EMPTY;
            for i in (1..n).rev() {
                after = after.union(bounds(i));
                self.areas[i] = half_area(&after);
            }
            let mut before = Bounds::EMPTY;
            for count in 1..n {
                before = before.union(bounds(count - 1));
                let sum = half_area(&before) * count as f64 + self.areas[count] * (n - count) as f64;
                if sum < best.1 || (sum == best.1 && uneven(count) < uneven(best.0.count)) {
                    best = (Cut { axis, count }, sum);
                }
            }
        }
        best
    }

    /// Parts a set's orders, each of which stays sorted on both sides.
    fn cut(&mut self, set: &Set, cut: Cut) {
        for (place, &i) in self.order[cut.axis][set.start..set.end].iter().enumerate() {
            self.left[i as usize] = place < cut.count;
        }
        for axis in (0..3).filter(|&axis| axis != cut.axis) {
            let order = &mut self.order[axis][set.start..set.end];
            self.right.clear();
            let mut count = 0;
            for place in 0..order.len() {
                let i = order[place];
                if self.left[i as usize] {
                    order[count] = i;
                    count += 1;
                } else {
                    self.right.push(i);
                }
            }
            order[count..].copy_from_slice(&self.right);
        }
    }
}
