//! Where a range of primitives is cut in two so that each primitive stays whole: binned SAH (Wald 2007, "On fast
//! Construction of SAH-based Bounding Volume Hierarchies").

use super::{
    params::Build,
    span::{Box4, Ref, Span},
};
use crate::node::WIDTH;
use rayon::prelude::*;
use std::ops::Range;
use straal_math::Vec3;

/// Bins on each axis.
const BINS: usize = 32;

/// Ranges longer than this are binned in pieces of this size by all threads.
pub(super) const PIECE: usize = 1 << 16;

/// A cut of a range, and what it would lead to.
pub(super) struct ObjectSplit {
    /// Sum of half area times number of blocks.
    pub cost: f32,
    /// Around what goes to each side.
    pub sides: [Box4; 2],
    plane: Plane,
}

/// What testing triangles costs: a block is tested as a whole.
pub(super) fn blocks(n: u32) -> f32 {
    n.div_ceil(WIDTH as u32) as f32
}

/// The cheapest cut at a plane between bins; `None` when bins can't separate the primitives.
pub(super) fn find(refs: &[Ref], span: &Span, build: Build) -> Option<ObjectSplit> {
    let low = [span.centers.lo[0], span.centers.lo[1], span.centers.lo[2]];
    let scale: [f32; 3] = std::array::from_fn(|i| {
        let extent = span.spread(i);
        if extent > 0.0 { BINS as f32 * (1.0 - f32::EPSILON) / extent } else { 0.0 }
    });
    // A fast build looks along the longest axis alone.
    let longest = longest(span);
    let axes = if build == Build::Fast { longest..longest + 1 } else { 0..3 };
    let mut bins = Bins::EMPTY;
    if refs.len() > PIECE {
        let pieces: Vec<Bins> = refs
            .par_chunks(PIECE)
            .map(|piece| {
                let mut bins = Bins::EMPTY;
                bins.fill(piece, &axes, &low, &scale);
                bins
            })
            .collect();
        pieces.iter().for_each(|b| bins.join(b));
    } else {
        bins.fill(refs, &axes, &low, &scale);
    }
    let mut best: Option<ObjectSplit> = None;
    for axis in axes.filter(|&axis| scale[axis] > 0.0) {
        let mut right = [Box4::EMPTY; BINS];
        let mut right_cost = [0.0; BINS];
        let (mut bounds, mut count) = (Box4::EMPTY, 0);
        for bin in (1..BINS).rev() {
            bounds = bounds.with(&bins.bounds[axis][bin]);
            count += bins.count[axis][bin];
            right[bin] = bounds;
            right_cost[bin] = if count == 0 { 0.0 } else { bounds.half_area() * blocks(count) };
        }
        let (mut bounds, mut count) = (Box4::EMPTY, 0);
        for bin in 1..BINS {
            bounds = bounds.with(&bins.bounds[axis][bin - 1]);
            count += bins.count[axis][bin - 1];
            if count == 0 || count as usize == refs.len() {
                continue;
            }
            let cost = bounds.half_area() * blocks(count) + right_cost[bin];
            if best.as_ref().is_none_or(|b| cost < b.cost) {
                let plane = Plane { axis, bin, low: low[axis], scale: scale[axis] };
                best = Some(ObjectSplit { cost, sides: [bounds, right[bin]], plane });
            }
        }
    }
    best
}

/// Cuts a range; `None`, with nothing changed but the order, when all would be on one side.
pub(super) fn cut(refs: &mut [Ref], span: &Span, split: &ObjectSplit) -> Option<[Span; 2]> {
    let depth = span.depth + 1;
    let mut left = Span::empty(span.start, depth);
    let mut right = Span::empty(0, depth);
    let (mut i, mut j) = (0, refs.len());
    while i < j {
        if split.plane.is_left(&refs[i]) {
            left.add(&refs[i]);
            i += 1;
        } else {
            right.add(&refs[i]);
            j -= 1;
            refs.swap(i, j);
        }
    }
    (right.start, right.end) = (left.end, span.end);
    (left.len() > 0 && right.len() > 0).then_some([left, right])
}

/// Cuts a range of at least two in halves of equal number.
pub(super) fn halve(refs: &mut [Ref], span: &Span) -> [Span; 2] {
    let axis = longest(span);
    let half = refs.len() / 2;
    refs.select_nth_unstable_by(half, |a, b| Ref::along(axis, a, b));
    let (a, b) = refs.split_at(half);
    let depth = span.depth + 1;
    [Span::of(a, span.start, depth), Span::of(b, span.start + half, depth)]
}

fn longest(span: &Span) -> usize {
    Vec3::new(span.spread(0), span.spread(1), span.spread(2)).max_axis()
}

/// A plane between bins.
#[derive(Clone, Copy)]
struct Plane {
    axis: usize,
    /// Bins below this go left.
    bin: usize,
    low: f32,
    scale: f32,
}

#[inline(always)]
fn bin_of(center: f32, low: f32, scale: f32) -> usize {
    // Rounding can reach BINS; what isn't a number goes to 0.
    (((center - low) * scale) as i32).clamp(0, BINS as i32 - 1) as usize
}

impl Plane {
    #[inline(always)]
    fn is_left(&self, r: &Ref) -> bool {
        bin_of(r.center(self.axis), self.low, self.scale) < self.bin
    }
}

struct Bins {
    bounds: [[Box4; BINS]; 3],
    count: [[u32; BINS]; 3],
}

impl Bins {
    const EMPTY: Self = Self { bounds: [[Box4::EMPTY; BINS]; 3], count: [[0; BINS]; 3] };

    fn fill(&mut self, refs: &[Ref], axes: &Range<usize>, low: &[f32; 3], scale: &[f32; 3]) {
        for r in refs {
            let b = r.bounds();
            for axis in axes.clone() {
                let bin = bin_of(b.lo[axis] + b.hi[axis], low[axis], scale[axis]);
                self.bounds[axis][bin].grow(&b.lo, &b.hi);
                self.count[axis][bin] += 1;
            }
        }
    }

    fn join(&mut self, o: &Self) {
        for axis in 0..3 {
            for bin in 0..BINS {
                let b = &o.bounds[axis][bin];
                self.bounds[axis][bin].grow(&b.lo, &b.hi);
                self.count[axis][bin] += o.count[axis][bin];
            }
        }
    }
}
