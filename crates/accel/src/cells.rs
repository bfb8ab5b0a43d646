//! What the kd-tree, the octree and the BSP tree share: trees of cells that don't overlap, which a ray passes front to
//! back. A tree says how a cut parts space, primitives and rays; the walk is the same for all.
//!
//! Why it loses no hit is told in `partition.rs`.

use crate::{
    clip::Limits,
    hit::Hit,
    kernel::stack::Stack,
    local::LocalRay,
    mailbox::Mailboxes,
    partition::{self, Census, chance},
    prim::{Packed, Prim},
    query::{Built, Descend, Place, Query, Search, Stats},
    section::{Section, Slice},
};
use straal_math::{Bounds, ops};

/// A tree of cells; the root is node 0.
pub(crate) trait Cells {
    /// What parts a cell, with the nodes of its parts.
    type Cut: Copy;
    /// A ray as cuts meet it.
    type Line<'a>;
    /// The part of a ray inside a cell.
    type Part: Part;
    /// The shape of a cell.
    type Space: Slice;

    fn open(&self, node: u32) -> Opened<'_, Self::Cut>;

    /// Around all primitives.
    fn bounds(&self) -> &Bounds;

    fn options(&self) -> CellOptions;

    fn bytes(&self) -> usize;

    /// The primitives of all leaves.
    fn references(&self) -> &[Packed];

    /// For which rays primitives are in the leaves where they are looked for.
    fn limits(&self) -> &Limits;

    fn line(ray: &LocalRay) -> Self::Line<'_>;

    /// The nearest of the parts that a cut leaves of a ray's; the others are put on the stack, the farthest first.
    fn cross(
        cut: &Self::Cut,
        line: &Self::Line<'_>,
        part: Self::Part,
        later: &mut Later<Self::Part>,
    ) -> Option<Todo<Self::Part>>;

    fn root_space(&self) -> Self::Space;

    /// Some part of a cell's surface that is the same for all cells.
    fn area(&self, space: &Self::Space) -> f64;

    /// The parts of a cell, with their nodes.
    fn divide(cut: &Self::Cut, space: &Self::Space) -> Vec<(u32, Self::Space)>;
}

/// A part of a ray.
pub(crate) trait Part: Copy {
    /// What lies between two of the ray's parameters.
    fn between(enter: f32, exit: f32) -> Self;

    /// Whether it begins strictly beyond `t`.
    fn is_beyond(&self, t: f32) -> bool;
}

/// A part of a ray by its parameters, for cuts at right angles to the axes.
#[derive(Clone, Copy)]
pub(crate) struct Interval {
    pub enter: f32,
    pub exit: f32,
}

impl Part for Interval {
    #[inline(always)]
    fn between(enter: f32, exit: f32) -> Self {
        Self { enter, exit }
    }

    #[inline(always)]
    fn is_beyond(&self, t: f32) -> bool {
        self.enter > t
    }
}

/// What is in a node.
pub(crate) enum Opened<'a, C> {
    Inner(C),
    Leaf(&'a [Packed]),
}

/// The settings of a tree that its building didn't use up.
#[derive(Clone, Copy)]
pub(crate) struct CellOptions {
    /// Whether a ray remembers the primitives that it tested last.
    pub mailboxes: bool,
    /// Cost of a step through an inner node, in tests of a primitive.
    pub step_cost: f64,
}

/// A subtree that is still to be visited, and the ray's part in it.
#[derive(Clone, Copy)]
pub(crate) struct Todo<P> {
    pub node: u32,
    pub part: P,
}

/// What waits on the way: on each level the children but one, which is seven of each of an octree's 24 levels, and one of
/// each of a binary tree's 64.
pub(crate) type Later<P> = Stack<Todo<P>, 169>;

/// Calls `leaf` with the leaves that the ray passes, in order. It answers up to which t others still matter.
#[inline(always)]
fn walk<T: Cells, K: Descend, const COUNT: bool>(
    tree: &T,
    q: &mut Query<'_, K, COUNT>,
    at: &Place<'_>,
    mut leaf: impl FnMut(&mut Query<'_, K, COUNT>, &[Packed]) -> f32,
) {
    let Some((enter, exit)) = partition::interval(tree.bounds(), at.ray) else { return };
    if !tree.limits().hold(at.ray, exit) {
        leaf(q, tree.references());
        return;
    }
    let line = T::line(at.ray);
    let mut later = Later::new();
    let mut todo = Todo { node: 0, part: T::Part::between(enter, exit) };
    // The least t beyond which nothing matters.
    let mut limit = exit;
    loop {
        q.count_node(0);
        let next = match tree.open(todo.node) {
            Opened::Leaf(prims) => {
                limit = ops::min(limit, leaf(q, prims));
                None
            }
            Opened::Inner(cut) => T::cross(&cut, &line, todo.part, &mut later),
        };
        todo = match next {
            Some(next) => next,
            // Nothing is skipped but what is entered strictly beyond the limit.
            None => loop {
                match later.pop() {
                    None => return,
                    Some(todo) if !todo.part.is_beyond(limit) => break todo,
                    Some(_) => {}
                }
            },
        };
    }
}

impl<T: Cells> Search for T {
    #[inline(always)]
    fn closest<K: Descend, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        let mut tested = Mailboxes::new(self.options().mailboxes);
        walk(self, q, at, |q, leaf| {
            tested.closest(q, at, leaf, best);
            best.t
        });
    }

    #[inline(always)]
    fn occluded<K: Descend, const COUNT: bool>(&self, q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool {
        let mut tested = Mailboxes::new(self.options().mailboxes);
        let mut found = false;
        walk(self, q, at, |q, leaf| {
            found = tested.occluded(q, at, leaf);
            if found { f32::NEG_INFINITY } else { f32::INFINITY }
        });
        found
    }
}

impl<T: Cells> Built for T {
    fn memory_bytes(&self) -> usize {
        self.bytes()
    }

    /// A line that meets the root's cell meets a convex part of it with the probability of their surfaces' ratio.
    fn stats(&self) -> Stats {
        let mut out = Stats::default();
        let root = self.root_space();
        let whole = self.area(&root);
        let mut stack = vec![(0, root, 0)];
        while let Some((node, space, depth)) = stack.pop() {
            out.depth = out.depth.max(depth);
            let chance = chance(self.area(&space), whole);
            match self.open(node) {
                Opened::Leaf(prims) => {
                    out.leaves += 1;
                    out.references += prims.len();
                    out.sah_cost += chance * prims.len() as f64;
                }
                Opened::Inner(cut) => {
                    out.nodes += 1;
                    out.sah_cost += chance * self.options().step_cost;
                    let parts = T::divide(&cut, &space);
                    stack.extend(parts.into_iter().map(|(node, space)| (node, space, depth + 1)));
                }
            }
        }
        out
    }

    fn section(&self, z: f64) -> Vec<Section> {
        let mut out = Vec::new();
        let mut stack = vec![(0, self.root_space(), 0)];
        while let Some((node, space, depth)) = stack.pop() {
            match self.open(node) {
                Opened::Leaf(prims) => {
                    let outline = space.slice(z);
                    if outline.len() >= 3 {
                        out.push(Section { outline, depth, primitives: Some(prims.len()) });
                    }
                }
                Opened::Inner(cut) => {
                    let parts = T::divide(&cut, &space);
                    stack.extend(parts.into_iter().map(|(node, space)| (node, space, depth + 1)));
                }
            }
        }
        out
    }
}

/// Every primitive in all leaves that it touches, no deeper than the stack allows. `needed` are those that have to be;
/// `touches` gives the nodes on whose side of a cut a primitive lies.
pub(crate) fn validate<T: Cells, I: IntoIterator<Item = u32>>(
    tree: &T,
    prims: &[Prim],
    needed: Vec<Prim>,
    touches: impl Fn(&T::Cut, &Prim) -> I,
) -> Result<(), String> {
    let mut census = Census::new(prims);
    let mut stack = vec![(0, needed, 0)];
    while let Some((node, needed, depth)) = stack.pop() {
        let cut = match tree.open(node) {
            Opened::Leaf(prims) => {
                census.leaf(prims, &needed, depth)?;
                continue;
            }
            Opened::Inner(cut) => cut,
        };
        // Also those in which nothing has to be: what is there counts as seen. Of which space they are parts is no matter.
        for (child, _) in T::divide(&cut, &tree.root_space()) {
            let part = needed.iter().filter(|p| touches(&cut, p).into_iter().any(|n| n == child));
            stack.push((child, part.copied().collect(), depth + 1));
        }
    }
    census.end()
}
