//! A tree that stays as it is while what is in it moves: only its boxes are made anew.
//!
//! A mesh that bends has the same triangles in other places. What lay together mostly still does, so that the tree of the frame
//! before, with boxes that fit, is about as good as one that is built, for a fraction of the work (Wald, Boulos and Shirley 2007,
//! "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", section 5). Whether it is, is told by what a search costs
//! by the surface area heuristic, against what it cost when the tree was built. Hits don't depend on the tree, so that nothing but the numbers
//! of what is in it has to be the same.

use super::{Bvh, few, few_triangles::FewTriangles};
use crate::{
    analytic::block::{Blocks, Member},
    node::{Child, ChildKind, Outline, WIDTH},
    partition::half_area,
    prim::{Prim, PrimKind},
    slab,
};
use rayon::prelude::*;
use straal_math::{Bounds, Vec3};

/// A tree is kept while a search costs at most this many times what it cost when it was built (`benches/refit.rs` measures what that
/// saves and costs).
const MOST: f64 = 1.1;

/// Whether a number is that of something, and whether it was met in a leaf.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Seen {
    Unknown,
    Wanted,
    Found,
}

/// What is to be in the tree, by number.
struct Content {
    triangles: Vec<Seen>,
    objects: Vec<(Seen, Bounds)>,
    missing: usize,
}

/// The sum over nodes and primitives of half the areas of the boxes in which they are met.
#[derive(Clone, Copy, Default)]
struct Cost(f64);

impl Bvh {
    /// The tree with the boxes of other places; `None` where it hasn't the same primitives, or is much worse than one that is built.
    pub fn refitted(
        mut self,
        prims: &[Prim],
        shapes: &[Member],
        vertices: &(impl Fn(u32) -> [Vec3; 3] + Sync),
        locate: impl Fn(u32) -> (u32, u32),
    ) -> Option<Self> {
        let root = self.root?;
        let (few, many) = few::part(shapes.to_vec());
        let mut content = Content::of(prims, &many);
        let mut leaves = Vec::new();
        self.find(root, &mut content, &mut leaves)?;
        if content.missing > 0 {
            return None;
        }
        let built_cost = self.built_cost.unwrap_or_else(|| self.cost(root));
        self.put_blocks(&leaves, vertices)?;
        self.shapes = self.shapes_again(&many)?;
        let mut cost = Cost::default();
        let whole = self.refit(root, &content, vertices, &mut cost);
        if cost.of(&whole) > MOST * built_cost {
            return None;
        }
        self.triangles = match many.is_empty() {
            true => FewTriangles::of(prims, &|id| vertices(id), locate),
            false => FewTriangles::EMPTY,
        };
        Some(Self { few, built_cost: Some(built_cost), ..self })
    }

    /// The blocks of triangles below a child, while everything that is met is ticked off; `None` if something isn't known.
    fn find(&self, child: Child, content: &mut Content, blocks: &mut Vec<u32>) -> Option<()> {
        match child.kind() {
            ChildKind::Done => return None,
            ChildKind::Object(i) => content.tick(PrimKind::Object(i))?,
            ChildKind::Shapes(i) => {
                let head = self.shapes.get(i as usize).head;
                for &object in &head.objects[..head.count as usize] {
                    content.tick(PrimKind::Object(object))?;
                }
            }
            ChildKind::Block(i) => {
                for id in self.block_ids(i) {
                    content.tick(PrimKind::Triangle(id))?;
                }
                blocks.push(i);
            }
            ChildKind::Node(i) => {
                let node = *self.lines.node(i as usize);
                for lane in (0..WIDTH).filter(|&lane| node.is_used(lane)) {
                    self.find(node.children[lane], content, blocks)?;
                }
            }
        }
        Some(())
    }

    /// Puts the triangles of blocks where they are; `None` if some no longer share the vertices that they shared, and
    /// don't fit.
    fn put_blocks(&mut self, blocks: &[u32], vertices: &(impl Fn(u32) -> [Vec3; 3] + Sync)) -> Option<()> {
        /// Blocks that are put together at a time.
        const MANY: usize = 1 << 14;
        let is_compact = !self.outlines.is_empty();
        for some in blocks.chunks(MANY) {
            let again = |&i: &u32| Outline::of(self.block_ids(i), vertices);
            let made: Option<Vec<_>> = some.par_iter().with_min_len(64).map(again).collect();
            for (&i, (outline, block)) in some.iter().zip(made?) {
                match is_compact {
                    true => self.outlines[i as usize] = outline,
                    false => self.lines.set_block(i as usize, &block),
                }
            }
        }
        Some(())
    }

    /// The blocks of shapes, each with the shapes that it has.
    fn shapes_again(&self, members: &[Member]) -> Option<Blocks> {
        let mut out = Blocks::EMPTY;
        for block in self.shapes.iter() {
            let of = |&object: &u32| {
                members.binary_search_by_key(&object, |m| m.object).ok().map(|at| members[at])
            };
            let objects = &block.head.objects[..block.head.count as usize];
            let mut block: Vec<Member> = objects.iter().map(of).collect::<Option<_>>()?;
            block.sort_unstable_by_key(|m| (m.shape.kind, m.object));
            out.push(&block);
        }
        Some(out)
    }

    /// Makes the boxes of a child anew, from the leaves up; the box around it.
    fn refit(
        &mut self,
        child: Child,
        content: &Content,
        vertices: &impl Fn(u32) -> [Vec3; 3],
        cost: &mut Cost,
    ) -> Bounds {
        let ChildKind::Node(i) = child.kind() else {
            let (bounds, count) = self.around_leaf(child, content, vertices);
            cost.add(&bounds, count);
            return bounds;
        };
        let mut node = *self.lines.node(i as usize);
        let mut whole = Bounds::EMPTY;
        for lane in 0..WIDTH {
            if node.is_used(lane) {
                let bounds = self.refit(node.children[lane], content, vertices, cost);
                node.set_bounds(lane, &bounds);
                whole = whole.union(bounds);
            }
        }
        self.lines.set_node(i as usize, &node);
        cost.add(&whole, 1);
        whole
    }

    /// The box around a leaf, and how many primitives are in it.
    fn around_leaf(
        &self,
        child: Child,
        content: &Content,
        vertices: &impl Fn(u32) -> [Vec3; 3],
    ) -> (Bounds, usize) {
        let object = |i: u32| content.objects.get(i as usize).map_or(Bounds::EMPTY, |o| o.1);
        let around = |all: &mut dyn Iterator<Item = Bounds>| {
            all.fold((Bounds::EMPTY, 0), |(whole, n), b| (whole.union(b), n + 1))
        };
        match child.kind() {
            ChildKind::Object(i) => (object(i), 1),
            ChildKind::Shapes(i) => {
                let head = self.shapes.get(i as usize).head;
                around(&mut head.objects[..head.count as usize].iter().map(|&i| object(i)))
            }
            ChildKind::Block(i) if self.outlines.is_empty() => {
                let block = self.lines.block(i as usize);
                let lanes = 0..block.count() as usize;
                around(&mut lanes.map(|lane| slab::triangle_bounds(&block.vertices(lane))))
            }
            ChildKind::Block(i) => {
                around(&mut self.block_ids(i).map(|id| slab::triangle_bounds(&vertices(id))))
            }
            ChildKind::Node(_) | ChildKind::Done => (Bounds::EMPTY, 0),
        }
    }

    /// What a search costs in the tree as it is.
    fn cost(&self, root: Child) -> f64 {
        let ChildKind::Node(i) = root.kind() else { return 0.0 };
        let whole = self.lines.node(i as usize).whole();
        let mut cost = Cost::default();
        let mut stack = vec![(root, whole)];
        while let Some((child, bounds)) = stack.pop() {
            let count = match child.kind() {
                ChildKind::Node(i) => {
                    let node = self.lines.node(i as usize);
                    let used = (0..WIDTH).filter(|&lane| node.is_used(lane));
                    stack.extend(used.map(|lane| (node.children[lane], node.bounds(lane))));
                    1
                }
                ChildKind::Block(i) => self.block_ids(i).count(),
                ChildKind::Shapes(i) => self.shapes.get(i as usize).head.count as usize,
                ChildKind::Object(_) => 1,
                ChildKind::Done => 0,
            };
            cost.add(&bounds, count);
        }
        cost.of(&whole)
    }
}

impl Content {
    fn of(prims: &[Prim], shapes: &[Member]) -> Self {
        let mut out =
            Self { triangles: Vec::new(), objects: Vec::new(), missing: prims.len() + shapes.len() };
        for prim in prims {
            match prim.kind {
                PrimKind::Triangle(id) => {
                    let id = id as usize;
                    if out.triangles.len() <= id {
                        out.triangles.resize(id + 1, Seen::Unknown);
                    }
                    out.triangles[id] = Seen::Wanted;
                }
                PrimKind::Object(i) => out.want(i, prim.bounds),
            }
        }
        shapes.iter().for_each(|m| out.want(m.object, m.bounds));
        out
    }

    fn want(&mut self, object: u32, bounds: Bounds) {
        let object = object as usize;
        if self.objects.len() <= object {
            self.objects.resize(object + 1, (Seen::Unknown, Bounds::EMPTY));
        }
        self.objects[object] = (Seen::Wanted, bounds);
    }

    /// One that is in a leaf; `None` if it isn't known. A triangle whose parts are in several leaves is met again.
    fn tick(&mut self, kind: PrimKind) -> Option<()> {
        let seen = match kind {
            PrimKind::Triangle(id) => self.triangles.get_mut(id as usize)?,
            PrimKind::Object(i) => &mut self.objects.get_mut(i as usize)?.0,
        };
        match *seen {
            Seen::Unknown => return None,
            Seen::Wanted => self.missing -= 1,
            Seen::Found => {}
        }
        *seen = Seen::Found;
        Some(())
    }
}

impl Cost {
    fn add(&mut self, bounds: &Bounds, count: usize) {
        self.0 += half_area(bounds) * count as f64;
    }

    /// For a line through the box around all; a single leaf, or what has no area, costs nothing.
    fn of(self, whole: &Bounds) -> f64 {
        let area = half_area(whole);
        if area > 0.0 { self.0 / area } else { 0.0 }
    }
}
