//! Building the tree from boxes by the surface area heuristic.
//!
//! Ranges of primitives are split in two by binned SAH (Wald 2007, "On fast Construction of SAH-based Bounding
//! Volume Hierarchies"). A node opens the child with the largest box until it has eight or only leaves are left. Large
//! ranges are split first; the small ones that remain are independent tasks, whose results are joined in their order.
//! A fast build looks for the cut along the longest axis alone; the best one looks at every place between two centres
//! where ranges are small, which is where most cuts are made.
//! All limits depend on the input alone, so that any number of threads builds the same tree.

use super::{
    Block, Bvh, Child, Node, WIDTH,
    params::{Build, BvhParams},
    slots,
};
use crate::structure::{Prim, PrimKind};
use rayon::prelude::*;
use std::ops::Range;
use straal_math::Vec3;

/// Splits by SAH down to this many binary levels, and in equal halves below: degenerate scenes can't make the tree
/// deeper than this + 30.
const MAX_SAH_DEPTH: u32 = 40;

/// What a search's stack must hold: seven more on each level, of at most `MAX_SAH_DEPTH` + 31.
pub(crate) const STACK: usize = 7 * (MAX_SAH_DEPTH as usize + 31) + 1;

/// Bins on each axis.
const BINS: usize = 32;

/// Ranges up to this long are tasks of one thread.
const TASK: usize = 2048;

/// Ranges longer than this are binned in pieces of this size by all threads.
const PIECE: usize = 1 << 16;

/// Ranges up to this long are swept, not binned, by the best build.
const SWEEP: usize = 4096;

type Vertices<'a> = dyn Fn(u32) -> [Vec3; 3] + Sync + 'a;

/// What a build goes by.
#[derive(Clone, Copy)]
struct Plan<'a> {
    vertices: &'a Vertices<'a>,
    build: Build,
    compact: bool,
}

/// A box with a spare lane, which the compiler turns into vector instructions.
#[derive(Clone, Copy)]
struct Box4 {
    lo: [f32; 4],
    hi: [f32; 4],
}

impl Box4 {
    const EMPTY: Self = Self { lo: [f32::INFINITY; 4], hi: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    fn grow(&mut self, lo: &[f32; 4], hi: &[f32; 4]) {
        for i in 0..4 {
            self.lo[i] = if lo[i] < self.lo[i] { lo[i] } else { self.lo[i] };
            self.hi[i] = if hi[i] > self.hi[i] { hi[i] } else { self.hi[i] };
        }
    }

    #[inline(always)]
    fn half_area(&self) -> f32 {
        let e = |i: usize| self.hi[i] - self.lo[i];
        e(0) * e(1) + e(1) * e(2) + e(2) * e(0)
    }
}

/// A primitive while the tree is built: its box, and as a leaf refers to it.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
struct Ref {
    lo: [f32; 3],
    id: u32,
    hi: [f32; 3],
    object: bool,
}

impl Ref {
    #[inline(always)]
    fn corners(&self) -> ([f32; 4], [f32; 4]) {
        ([self.lo[0], self.lo[1], self.lo[2], 0.0], [self.hi[0], self.hi[1], self.hi[2], 0.0])
    }

    /// Twice the centre.
    #[inline(always)]
    fn center(&self, axis: usize) -> f32 {
        self.lo[axis] + self.hi[axis]
    }
}

/// A range of primitives with what is known of it.
#[derive(Clone, Copy)]
struct Span {
    start: usize,
    end: usize,
    bounds: Box4,
    /// Around twice the centres.
    centers: Box4,
    /// How many aren't triangles.
    objects: usize,
    depth: u32,
}

impl Span {
    const fn empty(start: usize, depth: u32) -> Self {
        Self { start, end: start, bounds: Box4::EMPTY, centers: Box4::EMPTY, objects: 0, depth }
    }

    #[inline(always)]
    fn add(&mut self, r: &Ref) {
        let (lo, hi) = r.corners();
        let center = std::array::from_fn(|i| lo[i] + hi[i]);
        self.bounds.grow(&lo, &hi);
        self.centers.grow(&center, &center);
        self.objects += usize::from(r.object);
        self.end += 1;
    }

    fn of(refs: &[Ref], start: usize, depth: u32) -> Self {
        let mut out = Self::empty(start, depth);
        refs.iter().for_each(|r| out.add(r));
        out
    }

    /// Of twice the centres along an axis.
    fn extent(&self, axis: usize) -> f32 {
        self.centers.hi[axis] - self.centers.lo[axis]
    }

    const fn len(&self) -> usize {
        self.end - self.start
    }

    /// A block of triangles, or one object.
    const fn is_leaf(&self) -> bool {
        self.len() == 1 || (self.len() <= WIDTH && self.objects == 0)
    }
}

/// What a task produces; references are within it.
#[derive(Default)]
struct Part {
    nodes: Vec<Node>,
    blocks: Vec<Block>,
    /// In place of blocks, in a compact tree.
    ids: Vec<[u32; WIDTH]>,
}

impl Part {
    fn leaves(&self) -> usize {
        self.blocks.len() + self.ids.len()
    }
}

/// A subtree that is still to be built, and where it hangs.
struct Task {
    node: usize,
    slot: usize,
    span: Span,
}

pub(super) fn build(prims: &[Prim], params: &BvhParams, vertices: &Vertices<'_>) -> Bvh {
    let plan = Plan { vertices, build: params.build, compact: params.compact };
    let mut refs: Vec<Ref> = prims
        .iter()
        .map(|p| {
            let (id, object) = match p.kind {
                PrimKind::Triangle(id) => (id, false),
                PrimKind::Object(id) => (id, true),
            };
            Ref { lo: p.bounds.min.to_array(), id, hi: p.bounds.max.to_array(), object }
        })
        .collect();
    if refs.is_empty() {
        return Bvh::EMPTY;
    }
    let root = Span::of(&refs, 0, 0);
    let mut top = Part::default();
    if root.len() <= TASK {
        let child = subtree(&mut refs, &root, &plan, &mut top);
        return finish(child, top);
    }
    let mut tasks = Vec::new();
    let task_size = TASK.max(root.len() / 64);
    let child = upper(&mut refs, &root, task_size, &plan, &mut Upper { part: &mut top, tasks: &mut tasks });
    // Tasks come in the order of their ranges.
    let mut rest = refs.as_mut_slice();
    let mut jobs = Vec::with_capacity(tasks.len());
    for task in &tasks {
        let (mine, others) = rest.split_at_mut(task.span.len());
        rest = others;
        jobs.push((mine, task.span));
    }
    let parts: Vec<(Child, Part)> = jobs
        .into_par_iter()
        .map(|(refs, span)| {
            let mut part = Part::default();
            let span = Span { start: 0, end: span.len(), ..span };
            (subtree(refs, &span, &plan, &mut part), part)
        })
        .collect();
    top.nodes.reserve_exact(parts.iter().map(|(_, p)| p.nodes.len()).sum());
    top.blocks.reserve_exact(parts.iter().map(|(_, p)| p.blocks.len()).sum());
    top.ids.reserve_exact(parts.iter().map(|(_, p)| p.ids.len()).sum());
    for (task, (child, mut part)) in tasks.iter().zip(parts) {
        let (nodes, blocks) = (top.nodes.len() as u32, top.leaves() as u32);
        top.nodes[task.node].children[task.slot] = child.moved(nodes, blocks);
        for node in &mut part.nodes {
            node.children = node.children.map(|c| c.moved(nodes, blocks));
        }
        top.nodes.append(&mut part.nodes);
        top.blocks.append(&mut part.blocks);
        top.ids.append(&mut part.ids);
    }
    finish(child, top)
}

fn finish(root: Child, mut part: Part) -> Bvh {
    part.nodes.shrink_to_fit();
    part.blocks.shrink_to_fit();
    part.ids.shrink_to_fit();
    Bvh { root: Some(root), nodes: part.nodes, blocks: part.blocks, ids: part.ids }
}

/// The upper part of a tree under way, and what hangs below it.
struct Upper<'a> {
    part: &'a mut Part,
    tasks: &'a mut Vec<Task>,
}

/// Splits ranges longer than a task and leaves the others to be done.
fn upper(refs: &mut [Ref], span: &Span, task_size: usize, plan: &Plan<'_>, out: &mut Upper<'_>) -> Child {
    let (spans, count) = open(refs, span, plan);
    let (node, slots) = push_node(span, &spans[..count], out.part);
    for (s, slot) in spans[..count].iter().zip(slots) {
        if s.len() > task_size {
            let child = upper(refs, s, task_size, plan, out);
            out.part.nodes[node].children[slot] = child;
        } else {
            out.tasks.push(Task { node, slot, span: *s });
        }
    }
    Child::node(node as u32)
}

/// Builds a whole range.
fn subtree(refs: &mut [Ref], span: &Span, plan: &Plan<'_>, out: &mut Part) -> Child {
    if span.is_leaf() {
        return leaf(&refs[span.start..span.end], plan, out);
    }
    let (spans, count) = open(refs, span, plan);
    let (node, slots) = push_node(span, &spans[..count], out);
    for (s, slot) in spans[..count].iter().zip(slots) {
        out.nodes[node].children[slot] = subtree(refs, s, plan, out);
    }
    Child::node(node as u32)
}

/// A node with the boxes of a range's parts; its number, and the slot of each part.
fn push_node(whole: &Span, spans: &[Span], out: &mut Part) -> (usize, [usize; WIDTH]) {
    let mut offsets = [[0.0; 3]; WIDTH];
    for (offset, s) in offsets.iter_mut().zip(spans) {
        let twice_center = |s: &Span, axis: usize| s.bounds.lo[axis] + s.bounds.hi[axis];
        *offset = std::array::from_fn(|axis| twice_center(s, axis) - twice_center(whole, axis));
    }
    let slots = slots::assign(&offsets[..spans.len()]);
    let mut node = Node::EMPTY;
    for (s, slot) in spans.iter().zip(slots) {
        for axis in 0..3 {
            node.planes[2 * axis][slot] = s.bounds.lo[axis];
            node.planes[2 * axis + 1][slot] = s.bounds.hi[axis];
        }
    }
    out.nodes.push(node);
    (out.nodes.len() - 1, slots)
}

fn leaf(refs: &[Ref], plan: &Plan<'_>, out: &mut Part) -> Child {
    if refs[0].object {
        return Child::object(refs[0].id);
    }
    let mut ids = [u32::MAX; WIDTH];
    for (id, r) in ids.iter_mut().zip(refs) {
        *id = r.id;
    }
    match plan.compact {
        true => out.ids.push(ids),
        false => out.blocks.push(Block::of(&ids, plan.vertices)),
    }
    Child::block(out.leaves() as u32 - 1)
}

/// Splits a range in up to eight, in the order of their places.
fn open(refs: &mut [Ref], span: &Span, plan: &Plan<'_>) -> ([Span; WIDTH], usize) {
    let mut spans = [*span; WIDTH];
    let mut count = 1;
    while count < WIDTH {
        let mut best: Option<(usize, f32)> = None;
        for (i, s) in spans[..count].iter().enumerate() {
            let area = s.bounds.half_area();
            if !s.is_leaf() && best.is_none_or(|(_, a)| area > a) {
                best = Some((i, area));
            }
        }
        let Some((i, _)) = best else { break };
        let s = spans[i];
        let (left, right) = split(&mut refs[s.start..s.end], &s, plan.build);
        spans.copy_within(i + 1..count, i + 2);
        (spans[i], spans[i + 1]) = (left, right);
        count += 1;
    }
    (spans, count)
}

/// Splits a range of at least two in two.
fn split(refs: &mut [Ref], span: &Span, build: Build) -> (Span, Span) {
    let depth = span.depth + 1;
    if depth <= MAX_SAH_DEPTH && build == Build::Best && refs.len() <= SWEEP {
        return sweep(refs, span);
    }
    if depth <= MAX_SAH_DEPTH
        && let Some(plane) = best_plane(refs, span, build)
    {
        let mut left = Span::empty(span.start, depth);
        let mut right = Span::empty(0, depth);
        let (mut i, mut j) = (0, refs.len());
        while i < j {
            if plane.is_left(&refs[i]) {
                left.add(&refs[i]);
                i += 1;
            } else {
                right.add(&refs[i]);
                j -= 1;
                refs.swap(i, j);
            }
        }
        if left.len() > 0 && right.len() > 0 {
            (right.start, right.end) = (left.end, span.end);
            return (left, right);
        }
    }
    let axis = Vec3::new(span.extent(0), span.extent(1), span.extent(2)).max_axis();
    let half = refs.len() / 2;
    refs.select_nth_unstable_by(half, |a, b| along(axis, a, b));
    let (a, b) = refs.split_at(half);
    (Span::of(a, span.start, depth), Span::of(b, span.start + half, depth))
}

/// The order of centres along an axis, and of primitives where they are equal.
fn along(axis: usize, a: &Ref, b: &Ref) -> std::cmp::Ordering {
    a.center(axis).total_cmp(&b.center(axis)).then((a.object, a.id).cmp(&(b.object, b.id)))
}

/// Splits a range of at least two where the surface area heuristic wants it, of all places between two centres.
fn sweep(refs: &mut [Ref], span: &Span) -> (Span, Span) {
    let depth = span.depth + 1;
    let mut right_area = vec![0.0; refs.len()];
    let (mut cost, mut place) = (f32::INFINITY, (0, refs.len() / 2));
    for axis in 0..3 {
        refs.sort_unstable_by(|a, b| along(axis, a, b));
        let mut bounds = Box4::EMPTY;
        for (r, area) in refs.iter().zip(&mut right_area).rev() {
            let (lo, hi) = r.corners();
            bounds.grow(&lo, &hi);
            *area = bounds.half_area();
        }
        let mut bounds = Box4::EMPTY;
        for at in 1..refs.len() {
            let (lo, hi) = refs[at - 1].corners();
            bounds.grow(&lo, &hi);
            let (left, right) = (blocks(at as u32), blocks((refs.len() - at) as u32));
            let c = bounds.half_area() * left + right_area[at] * right;
            if c < cost {
                (cost, place) = (c, (axis, at));
            }
        }
    }
    let (axis, at) = place;
    if axis != 2 {
        refs.sort_unstable_by(|a, b| along(axis, a, b));
    }
    let (a, b) = refs.split_at(at);
    (Span::of(a, span.start, depth), Span::of(b, span.start + at, depth))
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
            let (lo, hi) = r.corners();
            for axis in axes.clone() {
                let bin = bin_of(lo[axis] + hi[axis], low[axis], scale[axis]);
                self.bounds[axis][bin].grow(&lo, &hi);
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

/// What testing triangles costs: a block is tested as a whole.
fn blocks(n: u32) -> f32 {
    n.div_ceil(WIDTH as u32) as f32
}

/// Where the sum of area times number of blocks is least; `None` when bins can't separate them.
fn best_plane(refs: &[Ref], span: &Span, build: Build) -> Option<Plane> {
    let low = [span.centers.lo[0], span.centers.lo[1], span.centers.lo[2]];
    let scale: [f32; 3] = std::array::from_fn(|i| {
        let extent = span.extent(i);
        if extent > 0.0 { BINS as f32 * (1.0 - f32::EPSILON) / extent } else { 0.0 }
    });
    // A fast build looks along the longest axis alone.
    let longest = Vec3::new(span.extent(0), span.extent(1), span.extent(2)).max_axis();
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
    let mut best: Option<(f32, Plane)> = None;
    for axis in axes.filter(|&axis| scale[axis] > 0.0) {
        let mut right_cost = [0.0; BINS];
        let (mut bounds, mut count) = (Box4::EMPTY, 0);
        for bin in (1..BINS).rev() {
            let b = &bins.bounds[axis][bin];
            bounds.grow(&b.lo, &b.hi);
            count += bins.count[axis][bin];
            right_cost[bin] = if count == 0 { 0.0 } else { bounds.half_area() * blocks(count) };
        }
        let (mut bounds, mut count) = (Box4::EMPTY, 0);
        for (bin, right_cost) in right_cost.iter().enumerate().skip(1) {
            let b = &bins.bounds[axis][bin - 1];
            bounds.grow(&b.lo, &b.hi);
            count += bins.count[axis][bin - 1];
            if count == 0 || count as usize == refs.len() {
                continue;
            }
            let cost = bounds.half_area() * blocks(count) + right_cost;
            if best.is_none_or(|(c, _)| cost < c) {
                best = Some((cost, Plane { axis, bin, low: low[axis], scale: scale[axis] }));
            }
        }
    }
    best.map(|(_, plane)| plane)
}
