//! Building the tree from boxes by the surface area heuristic.
//!
//! Ranges of primitives are split in two (`object_split.rs`; where it pays also `spatial_split.rs`), down to blocks: a
//! binary tree, of which `collapse.rs` chooses what becomes a node. Large ranges are split first; the small ones that
//! remain are independent tasks, whose results are joined in their order. A fast build looks for the cut along
//! the longest axis alone; the best one cuts triangles where that pays. All limits depend on the input alone, so that any
//! number of threads builds the same tree.

use super::{
    Bvh,
    collapse::{Costs, Twig, What, choose},
    object_split,
    params::{Build, BvhParams, Plan, Vertices},
    span::{Class, Ref, Span},
    spatial_split,
    wide::{Binary, join},
};
use crate::{
    analytic::block::Member,
    node::{Child, MOST_LEVELS, Outline, WIDTH},
    prim::Prim,
};
use rayon::prelude::*;

/// Splits by SAH down to this many binary levels, and in equal halves below: degenerate scenes can't make the tree
/// deeper than this + 30.
const MAX_SAH_DEPTH: u32 = 40;

const _: () = assert!(MAX_SAH_DEPTH as usize + 31 <= MOST_LEVELS);

/// Ranges up to this long are tasks of one thread.
const TASK: usize = 2048;

pub(super) fn build(
    prims: Vec<Prim>,
    shapes: &[Member],
    params: &BvhParams,
    vertices: &Vertices<'_>,
) -> Option<Bvh> {
    let numbered = (0..).zip(shapes);
    let mut refs: Vec<Ref> = prims.into_iter().map(|p| Ref::of(&p)).collect();
    refs.extend(numbered.map(|(id, m)| Ref::of_shape(id, m)));
    if refs.is_empty() {
        return Some(Bvh::EMPTY);
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
    let plan = Plan { shapes, vertices, build: params.build, compact: params.compact, least_overlap };
    let mut upper = Binary::default();
    upper.grow(&mut refs, &root, TASK.max(root.len() / 64), &plan);
    // Tasks come in the order of their ranges.
    let mut rest = refs.as_mut_slice();
    let mut jobs = Vec::with_capacity(upper.tasks.len());
    for task in &upper.tasks {
        let (mine, others) = rest.split_at_mut(task.places().len());
        rest = others;
        jobs.push((mine, Span { start: 0, end: task.len(), ..*task }));
    }
    let (trees, costs): (Vec<Binary>, Vec<Costs>) = jobs
        .into_par_iter()
        .map(|(refs, span)| {
            let mut tree = Binary::default();
            tree.grow(refs, &span, 0, &plan);
            let costs = choose(&mut tree.twigs, &[]);
            (tree, costs)
        })
        .unzip();
    drop(refs);
    choose(&mut upper.twigs, &costs);
    join(&upper.twigs, &trees)
}

impl Binary {
    /// Splits a range of references until nothing but leaves is left, or ranges up to `task_size`.
    fn grow(&mut self, refs: &mut [Ref], span: &Span, task_size: usize, plan: &Plan<'_>) {
        let at = self.twigs.len();
        if span.len() <= task_size {
            self.twigs.push(Twig::new(&span.bounds, What::Task(self.tasks.len() as u32)));
            self.tasks.push(*span);
        } else if let Some(leaf) = self.leaf(&refs[span.start..span.end], span, plan) {
            self.twigs.push(Twig::new(&span.bounds, What::Leaf(leaf)));
        } else {
            let [left, right] = split(&mut refs[span.places()], span, plan);
            self.twigs.push(Twig::new(&span.bounds, What::Leaf(Child::DONE)));
            self.grow(refs, &left, task_size, plan);
            self.twigs[at].what = What::Fork { right: self.twigs.len() as u32, shares: [0; WIDTH] };
            self.grow(refs, &right, task_size, plan);
        }
    }

    /// A block of triangles or of shapes, or one object, if that is what the range is.
    fn leaf(&mut self, refs: &[Ref], span: &Span, plan: &Plan<'_>) -> Option<Child> {
        if refs.len() == 1 && refs[0].class == Class::Object {
            return Some(Child::object(refs[0].id));
        }
        if refs.len() <= WIDTH && span.shapes == refs.len() {
            let mut block: Vec<Member> = refs.iter().map(|r| plan.shapes[r.id as usize]).collect();
            block.sort_unstable_by_key(|m| (m.shape.kind, m.object));
            self.shapes.push(&block);
            return Some(Child::shapes(self.shapes.len() as u32 - 1));
        }
        if refs.len() > WIDTH || span.objects > 0 {
            return None;
        }
        let (outline, block) = Outline::of(refs.iter().map(|r| r.id), plan.vertices)?;
        match plan.compact {
            true => self.outlines.push(outline),
            false => self.blocks.push(block),
        }
        Some(Child::block(self.leaves() as u32 - 1))
    }
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
