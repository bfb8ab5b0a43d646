//! Building the tree from boxes by the surface area heuristic.
//!
//! Ranges of primitives are split in two (`object_split.rs`; in the best build also `spatial_split.rs`). A node opens
//! the child with the largest box until it has eight or only leaves are left. Large ranges are split first; the small
//! ones that remain are independent tasks, whose results are joined in their order. A fast build looks for the cut along
//! the longest axis alone; the best one cuts triangles where that pays. All limits depend on the input alone, so that any
//! number of threads builds the same tree.

use super::{
    Block, Bvh, Child, Node, WIDTH, object_split,
    params::{Build, BvhParams},
    slots,
    span::{Ref, Span},
    spatial_split,
};
use crate::{kernel::pages::want_large, structure::Prim};
use rayon::prelude::*;
use straal_math::Vec3;

/// Splits by SAH down to this many binary levels, and in equal halves below: degenerate scenes can't make the tree
/// deeper than this + 30.
const MAX_SAH_DEPTH: u32 = 40;

/// What a search's stack must hold: seven more on each level, of at most `MAX_SAH_DEPTH` + 31.
pub(crate) const STACK: usize = 7 * (MAX_SAH_DEPTH as usize + 31) + 1;

/// Ranges up to this long are tasks of one thread.
const TASK: usize = 2048;

type Vertices<'a> = dyn Fn(u32) -> [Vec3; 3] + Sync + 'a;

/// What a build goes by.
#[derive(Clone, Copy)]
pub(super) struct Plan<'a> {
    pub vertices: &'a Vertices<'a>,
    build: Build,
    compact: bool,
    /// Half the area of an overlap below which no triangle is cut.
    pub least_overlap: f32,
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
    let mut refs: Vec<Ref> = prims.iter().map(Ref::of).collect();
    if refs.is_empty() {
        return Bvh::EMPTY;
    }
    let mut root = Span::of(&refs, 0, 0);
    let cuts = params.build == Build::Best || spatial_split::is_crowded(&refs, &root);
    let room = if cuts { spatial_split::room(params.build, refs.len()) } else { 0 };
    if room > 0 {
        refs.iter_mut().for_each(|r| *r = spatial_split::whole(*r));
        root = Span { room, ..Span::of(&refs, 0, 0) };
        refs.resize(root.places().end, Ref::NONE);
    }
    let least_overlap = spatial_split::OVERLAP * root.bounds.half_area();
    let plan = Plan { vertices, build: params.build, compact: params.compact, least_overlap };
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
        let (mine, others) = rest.split_at_mut(task.span.places().len());
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
    want_large(&mut top.nodes);
    want_large(&mut top.blocks);
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
        let [left, right] = split(&mut refs[s.places()], &s, plan);
        spans.copy_within(i + 1..count, i + 2);
        (spans[i], spans[i + 1]) = (left, right);
        count += 1;
    }
    (spans, count)
}

/// Splits a range of at least two in two; `refs` are its places.
fn split(refs: &mut [Ref], span: &Span, plan: &Plan<'_>) -> [Span; 2] {
    let len = span.len();
    let heaps =
        if span.depth < MAX_SAH_DEPTH { object_split::find(&refs[..len], span, plan.build) } else { None };
    let mut out = None;
    if let Some(heaps) = heaps {
        if spatial_split::is_wanted(span, &heaps.sides, plan)
            && let Some(split) = spatial_split::find(&refs[..len], span, plan)
            && spatial_split::pays(&split, heaps.cost)
        {
            out = spatial_split::cut(refs, span, &split, plan);
        }
        out = out.or_else(|| object_split::cut(&mut refs[..len], span, &heaps).map(|s| with_room(s, span)));
    }
    let mut out = out.unwrap_or_else(|| with_room(object_split::halve(&mut refs[..len], span), span));
    spatial_split::share_room(refs, &mut out, plan);
    out
}

/// The room stays where it is, behind the right half.
const fn with_room([left, right]: [Span; 2], span: &Span) -> [Span; 2] {
    [left, Span { room: span.room, ..right }]
}
