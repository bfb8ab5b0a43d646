//! Where a range of triangles is cut in two by a plane, and triangles across the plane with it: Stich, Friedrich and
//! Dietrich 2009, "Spatial Splits in Bounding Volume Hierarchies".
//!
//! The box of a long slanting triangle is nearly empty, and no way of sorting such boxes into two heaps keeps the heaps
//! apart. So a triangle may have several references, each with the box of a part of it. A plane is looked for only where
//! the boxes of the cheapest heaps overlap by more than [`OVERLAP`] of the root's area (there, section 4.1) and by more
//! than [`OWN_OVERLAP`] of their own range's; where there are no such triangles, little is lost. A reference that would
//! be cut is left whole where that is cheaper ("reference unsplitting", section 4.2). The tree has room for a limited number
//! of references beyond one for each triangle. A range shares its room out to its halves by the areas of their
//! boxes, since that is where cutting pays.
//!
//! # Exactness
//! What `clip.rs` says of clipped triangles holds here. A ray comes, at the t of its hit, within a few roundings of a
//! point p of the triangle: on each axis within e (|t d| + L), where L is the triangle's longest extent. Each
//! reference has the box of what is on its side of the planes that cut it, grown by [`PAD`] L, and never smaller: so a leaf
//! that has the triangle, and all boxes above it, have p and the part of the error that grows with L well inside. The
//! other part is a factor of the crossings of planes: the ray's point is off by at most 5.5 epsilon |t d| (the sheared
//! vertices, 2.5, and t, 3), a crossing by 1.5 more. So the box is entered before t (1 + 7 epsilon) and left after
//! t (1 - 7 epsilon), and a search visits it: exits are moved by 16 epsilon (`slab::EXIT`), and the latest entry
//! that is still visited by as much (`slab::loosened`).
//!
//! A triangle that is tested twice gives the same hit twice.

use super::{
    object_split::{PIECE, blocks},
    params::{Build, Plan},
    span::{Box4, Ref, Span},
};
use crate::node::WIDTH;
use rayon::prelude::*;

/// Bins on each axis.
const BINS: usize = 16;

/// Heaps whose boxes overlap by less of the root's area than this are good enough. Where overlaps are smaller, cutting gains
/// nothing that could be measured.
pub(super) const OVERLAP: f32 = 1e-3;

/// The same, of the area of their range's box.
const OWN_OVERLAP: f32 = 0.2;

/// No more references of a range than this, evenly spaced, are put into bins.
const SAMPLE: usize = 1 << 10;

/// So few references aren't cut: they fill two blocks.
const FEW: usize = 2 * WIDTH;

/// How much cheaper than a split into heaps a spatial one must be.
const GAIN: f32 = 0.99;

/// What boxes are grown by, in units of the triangle's longest extent.
const PAD: f32 = 64.0 * f32::EPSILON;

/// The same, of each coordinate: more than cutting an edge in single precision is off.
const PAD_COORDINATE: f32 = 2.0 * f32::EPSILON;

/// How many references there may be beyond one for each of `n` primitives.
pub(super) const fn room(build: Build, n: usize) -> usize {
    match build {
        // References are numbered with 30 bits.
        _ if n >= 1 << 29 => 0,
        Build::Fast => 0,
        Build::Default => n / 16,
        Build::Best => n / 4,
    }
}

/// Whether boxes of triangles overlap so much that cutting them is worth the time: whether a ray across the whole crosses
/// more than [`CROWD`] of them on the mean.
pub(super) fn is_crowded(refs: &[Ref], whole: &Span) -> bool {
    let areas = refs.iter().filter(|r| r.is_triangle()).map(|r| f64::from(r.bounds().half_area()));
    areas.sum::<f64>() > CROWD * f64::from(whole.bounds.half_area())
}

/// Boxes on a ray: about four on a sphere of even triangles, 26 in a room of long ones.
const CROWD: f64 = 8.0;

/// A reference to a whole triangle, with room for what its parts' boxes are grown by.
pub(super) fn whole(r: Ref) -> Ref {
    if !r.is_triangle() {
        return r;
    }
    let b = r.bounds();
    let (x, y, z) = (b.extent(0), b.extent(1), b.extent(2));
    let longest = if x > y { x } else { y };
    r.in_box(&padded(b, if z > longest { z } else { longest }))
}

#[inline(always)]
fn padded(b: Box4, longest: f32) -> Box4 {
    let pad = longest * PAD;
    Box4 {
        lo: b.lo.map(|x| x - (pad + x.abs() * PAD_COORDINATE)),
        hi: b.hi.map(|x| x + (pad + x.abs() * PAD_COORDINATE)),
    }
}

/// A triangle that may be cut.
struct Triangle {
    v: [[f32; 4]; 3],
    longest: f32,
}

impl Triangle {
    #[inline(always)]
    fn of(id: u32, plan: &Plan<'_>) -> Self {
        let v = (plan.vertices)(id).map(|p| [p.x, p.y, p.z, 0.0]);
        let mut b = Box4::EMPTY;
        v.iter().for_each(|p| b.grow(p, p));
        let (x, y, z) = (b.extent(0), b.extent(1), b.extent(2));
        let longest = if x > y { x } else { y };
        Self { v, longest: if z > longest { z } else { longest } }
    }

    /// The boxes, within `b`, of the parts below and above a plane; empty where there is none.
    #[inline(always)]
    fn cut(&self, b: &Box4, axis: usize, plane: f32) -> [Box4; 2] {
        let mut below = Box4::EMPTY;
        let mut above = Box4::EMPTY;
        for (i, p) in self.v.iter().enumerate() {
            let q = &self.v[(i + 1) % 3];
            if p[axis] <= plane {
                below.grow(p, p);
            }
            if p[axis] >= plane {
                above.grow(p, p);
            }
            if (p[axis] < plane && q[axis] > plane) || (p[axis] > plane && q[axis] < plane) {
                let s = (plane - p[axis]) / (q[axis] - p[axis]);
                let mut at: [f32; 4] = std::array::from_fn(|i| p[i] + (q[i] - p[i]) * s);
                at[axis] = plane;
                below.grow(&at, &at);
                above.grow(&at, &at);
            }
        }
        [below, above].map(|part| padded(part, self.longest).intersection(b))
    }
}

/// A plane, and what it would lead to.
pub(super) struct SpatialSplit {
    pub cost: f32,
    axis: usize,
    plane: f32,
    /// Around the parts on each side.
    sides: [Box4; 2],
    /// References on each side.
    counts: [u32; 2],
}

/// Whether boxes overlap enough to look for a plane.
pub(super) fn is_wanted(span: &Span, sides: &[Box4; 2], plan: &Plan<'_>) -> bool {
    let common = sides[0].intersection(&sides[1]);
    if span.room == 0 || span.len() <= FEW || common.is_empty() {
        return false;
    }
    let common = common.half_area();
    common > plan.least_overlap && common > OWN_OVERLAP * span.bounds.half_area()
}

/// The slabs of space into which a range is cut along one axis.
#[derive(Clone, Copy)]
struct Slabs {
    low: f32,
    width: f32,
    scale: f32,
}

impl Slabs {
    fn new(span: &Span, axis: usize) -> Self {
        let extent = span.bounds.extent(axis);
        let scale = if extent > 0.0 { BINS as f32 / extent } else { 0.0 };
        Self { low: span.bounds.lo[axis], width: extent / BINS as f32, scale }
    }

    #[inline(always)]
    fn slab_of(&self, x: f32) -> usize {
        (((x - self.low) * self.scale) as i32).clamp(0, BINS as i32 - 1) as usize
    }

    /// The plane below a slab.
    #[inline(always)]
    fn plane(&self, slab: usize) -> f32 {
        self.low + self.width * slab as f32
    }
}

/// What is in the slabs along one axis.
#[derive(Clone, Copy)]
struct Bins {
    bounds: [Box4; BINS],
    /// References that begin in each slab, and that end there.
    begin: [u32; BINS],
    end: [u32; BINS],
}

impl Bins {
    const EMPTY: Self = Self { bounds: [Box4::EMPTY; BINS], begin: [0; BINS], end: [0; BINS] };

    /// Of every `stride`-th reference.
    fn of(refs: &[Ref], stride: usize, slabs: &[Slabs; 3], plan: &Plan<'_>) -> [Self; 3] {
        let mut out = [Self::EMPTY; 3];
        for r in refs.iter().step_by(stride) {
            let b = r.bounds();
            let mut triangle = None;
            for axis in 0..3 {
                let (slabs, bins) = (&slabs[axis], &mut out[axis]);
                let (first, last) = match !r.is_triangle() {
                    false => (slabs.slab_of(b.lo[axis]), slabs.slab_of(b.hi[axis])),
                    true => [slabs.slab_of(r.center(axis) * 0.5); 2].into(),
                };
                bins.begin[first] += 1;
                bins.end[last] += 1;
                let mut rest = b;
                for slab in first..last {
                    let triangle = triangle.get_or_insert_with(|| Triangle::of(r.id, plan));
                    let [part, above] = triangle.cut(&rest, axis, slabs.plane(slab + 1));
                    if !part.is_empty() {
                        bins.bounds[slab].grow(&part.lo, &part.hi);
                    }
                    rest = above;
                }
                if !rest.is_empty() {
                    bins.bounds[last].grow(&rest.lo, &rest.hi);
                }
            }
        }
        out
    }

    fn join(&mut self, o: &Self) {
        for slab in 0..BINS {
            self.bounds[slab] = self.bounds[slab].with(&o.bounds[slab]);
            self.begin[slab] += o.begin[slab];
            self.end[slab] += o.end[slab];
        }
    }
}

/// The cheapest plane between slabs for which there is room.
pub(super) fn find(refs: &[Ref], span: &Span, plan: &Plan<'_>) -> Option<SpatialSplit> {
    let slabs = [0, 1, 2].map(|axis| Slabs::new(span, axis));
    let stride = refs.len().div_ceil(SAMPLE);
    let bins = if refs.len() > PIECE {
        let pieces: Vec<_> =
            refs.par_chunks(PIECE).map(|piece| Bins::of(piece, stride, &slabs, plan)).collect();
        let mut bins = [Bins::EMPTY; 3];
        for piece in &pieces {
            bins.iter_mut().zip(piece).for_each(|(b, p)| b.join(p));
        }
        bins
    } else {
        Bins::of(refs, stride, &slabs, plan)
    };
    let mut best: Option<SpatialSplit> = None;
    for (axis, bins) in bins.iter().enumerate() {
        let mut above = [(Box4::EMPTY, 0); BINS];
        let (mut bounds, mut count) = above[0];
        for slab in (1..BINS).rev() {
            bounds = bounds.with(&bins.bounds[slab]);
            count += bins.end[slab];
            above[slab] = (bounds, count);
        }
        let (mut bounds, mut count) = (Box4::EMPTY, 0);
        for (slab, &(other, others)) in above.iter().enumerate().skip(1) {
            bounds = bounds.with(&bins.bounds[slab - 1]);
            count += bins.begin[slab - 1];
            let counts = [count, others].map(|n| n * stride as u32);
            if bounds.is_empty() || other.is_empty() || count == 0 || others == 0 {
                continue;
            }
            if counts[0] as usize + counts[1] as usize > refs.len() + span.room {
                continue;
            }
            let cost = bounds.half_area() * blocks(counts[0]) + other.half_area() * blocks(counts[1]);
            if best.as_ref().is_none_or(|b| cost < b.cost) {
                let (plane, sides) = (slabs[axis].plane(slab), [bounds, other]);
                best = Some(SpatialSplit { cost, axis, plane, sides, counts });
            }
        }
    }
    best
}

/// Whether a plane is worth its duplicates.
pub(super) fn pays(split: &SpatialSplit, heaps: f32) -> bool {
    split.cost < heaps * GAIN
}

/// Cuts a range; `refs` includes its room. `None`, with nothing changed but the order, when all would be on one side.
pub(super) fn cut(refs: &mut [Ref], span: &Span, split: &SpatialSplit, plan: &Plan<'_>) -> Option<[Span; 2]> {
    let depth = span.depth + 1;
    let (axis, plane) = (split.axis, split.plane);
    let mut left = Span::empty(span.start, depth);
    let mut right = Span::empty(0, depth);
    let mut weigh = Weigh { sides: split.sides, counts: split.counts.map(|n| n as f32) };
    let mut parts = Vec::new();
    let (mut i, mut j) = (0, span.len());
    while i < j {
        let b = refs[i].bounds();
        let is_across = refs[i].is_triangle() && b.lo[axis] < plane && b.hi[axis] > plane;
        let mut to_left = refs[i].center(axis) < 2.0 * plane;
        if is_across {
            let [below, above] = Triangle::of(refs[i].id, plan).cut(&b, axis, plane);
            let choice = match (below.is_empty(), above.is_empty()) {
                (false, false) if parts.len() < span.room => weigh.choose(&b),
                (false, false) => Choice::Whole(usize::from(!to_left)),
                (is_right, _) => Choice::Whole(usize::from(is_right)),
            };
            match choice {
                Choice::Whole(side) => to_left = side == 0,
                Choice::Cut => {
                    parts.push(refs[i].in_box(&above));
                    refs[i] = refs[i].in_box(&below);
                    to_left = true;
                }
            }
        }
        if to_left {
            left.add(&refs[i]);
            i += 1;
        } else {
            right.add(&refs[i]);
            j -= 1;
            refs.swap(i, j);
        }
    }
    right.start = left.end;
    for (place, part) in refs[span.len()..].iter_mut().zip(&parts) {
        right.add(part);
        *place = *part;
    }
    right.end = span.end + parts.len();
    if left.len() == 0 || right.len() == 0 {
        return None;
    }
    right.room = span.room - parts.len();
    Some([left, right])
}

enum Choice {
    Cut,
    /// To which side it goes.
    Whole(usize),
}

/// What the sides would be if all references across the plane that weren't looked at were cut.
struct Weigh {
    sides: [Box4; 2],
    counts: [f32; 2],
}

impl Weigh {
    /// What is cheapest for a reference across the plane (equations 2 to 4 there).
    fn choose(&mut self, b: &Box4) -> Choice {
        let areas = self.sides.map(|s| s.half_area());
        let [n, m] = self.counts;
        let grown = self.sides.map(|s| s.with(b));
        let cut = areas[0] * n + areas[1] * m;
        let left = grown[0].half_area() * n + areas[1] * (m - 1.0);
        let right = areas[0] * (n - 1.0) + grown[1].half_area() * m;
        let side = usize::from(right < left);
        if (if side == 1 { right } else { left }) >= cut {
            return Choice::Cut;
        }
        self.sides[side] = grown[side];
        self.counts[1 - side] -= 1.0;
        Choice::Whole(side)
    }
}

/// Gives the left of two neighbours its share of the room that the right one has behind it. `refs` begins where the left
/// one does.
pub(super) fn share_room(refs: &mut [Ref], [left, right]: &mut [Span; 2], plan: &Plan<'_>) {
    if right.room == 0 {
        return;
    }
    let (middle, end) = (left.len(), left.len() + right.len());
    // Below the least area nothing can overlap enough.
    let weight = |refs: &[Ref], span: &Span| match span.bounds.half_area() > plan.least_overlap {
        true => refs.iter().map(|r| f64::from(r.bounds().half_area())).sum(),
        false => 0.0,
    };
    let weights = [weight(&refs[..middle], left), weight(&refs[middle..end], right)];
    let sum = weights[0] + weights[1];
    let share = if sum > 0.0 { (right.room as f64 * weights[0] / sum) as usize } else { 0 };
    let share = share.min(right.room);
    // The order within a range has no meaning, so that as few as possible are moved.
    let moved = share.min(right.len());
    refs.copy_within(middle..middle + moved, end + share - moved);
    (left.room, right.room) = (share, right.room - share);
    (right.start, right.end) = (right.start + share, right.end + share);
}
