//! Searching the tree with one ray.

use super::{Block, Bvh, Child, ChildKind, Node, WIDTH, build};
use crate::{
    hit::Hit,
    input::Shapes,
    kernel::{Children, Kernel, stack::Stacks},
    query::Query,
    scene::GroupData,
    structure::{Place, Search, Stats},
    triangle,
};
use straal_math::{Ray, ops};

/// A subtree to be visited, with the bits of an entry that isn't later than the true one (and not below 0).
#[derive(Clone, Copy)]
pub(super) struct Todo {
    pub entry: u32,
    pub child: Child,
}

impl Bvh {
    #[inline(always)]
    pub(super) fn block_closest<K: Kernel, S: Shapes, const COUNT: bool>(
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        block: &Block,
        best: &mut Hit,
    ) {
        if COUNT {
            q.count_block(block.count());
        }
        let lanes = q.kernel.block(at.ray, block, best.t);
        let mut mask = lanes.hit;
        while mask != 0 {
            let lane = take(&mut mask);
            let (t, det) = (lanes.t[lane], lanes.det[lane]);
            let tuv = [t, lanes.e1[lane] / det, lanes.e2[lane] / det];
            if t <= best.t {
                q.triangle_hit(at, block.id[lane], &block.vertices(lane), tuv, best);
            }
        }
        let mut mask = lanes.zero;
        while mask != 0 {
            let lane = take(&mut mask);
            q.triangle_closest(at, block.id[lane], &block.vertices(lane), best);
        }
    }

    #[inline(always)]
    pub(super) fn block_occluded<K: Kernel, S: Shapes, const COUNT: bool>(
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        block: &Block,
    ) -> bool {
        if COUNT {
            q.count_block(block.count());
        }
        let lanes = q.kernel.block(at.ray, block, at.ray.ray.t_max);
        let mut mask = lanes.hit | lanes.zero;
        while mask != 0 {
            let lane = take(&mut mask);
            let v = block.vertices(lane);
            let found =
                lanes.hit >> lane & 1 == 1 || triangle::intersect(&v, at.ray, at.ray.ray.t_max).is_some();
            if found && q.triangle_blocks(at, block.id[lane], &v) {
                return true;
            }
        }
        false
    }
}

/// The lowest lane of a set, taken out of it.
#[inline(always)]
pub(super) fn take(mask: &mut u32) -> usize {
    let lane = mask.trailing_zeros() as usize % WIDTH;
    *mask &= mask.wrapping_sub(1);
    lane
}

/// Takes the nearest of the entered children and pushes the others, the farthest first.
#[inline(always)]
pub(super) fn nearest_first(node: &Node, found: &Children, mut push: impl FnMut(Todo)) -> Option<Child> {
    let todo = |key: u32| Todo { entry: key & !7, child: node.children[(key & 7) as usize] };
    let mut mask = found.mask;
    if mask == 0 {
        return None;
    }
    let first = take(&mut mask);
    if mask == 0 {
        return Some(node.children[first]);
    }
    let (a, b) = (found.keys[first], found.keys[take(&mut mask)]);
    let (near, far) = if a < b { (a, b) } else { (b, a) };
    if mask == 0 {
        push(todo(far));
        return Some(node.children[(near & 7) as usize]);
    }
    let mut sorted = [0; WIDTH];
    (sorted[0], sorted[1]) = (far, near);
    let mut count = 2;
    while mask != 0 {
        let key = found.keys[take(&mut mask)];
        let mut i = count % WIDTH;
        while i > 0 && sorted[i - 1] < key {
            sorted[i] = sorted[i - 1];
            i -= 1;
        }
        sorted[i] = key;
        count += 1;
    }
    for &key in &sorted[..(count - 1) % WIDTH] {
        push(todo(key));
    }
    Some(node.children[(sorted[(count - 1) % WIDTH] & 7) as usize])
}

impl Search for Bvh {
    #[inline(always)]
    fn closest<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        let Some(mut child) = self.root else { return };
        let mut stack = Stacks::<Todo, { build::STACK }, 1>::new();
        loop {
            match child.kind() {
                ChildKind::Node(i) => {
                    let node = &self.nodes[i as usize];
                    if COUNT {
                        q.count_node(node.count());
                    }
                    let found = q.kernel.node(at.ray, node, best.t);
                    if let Some(next) = nearest_first(node, &found, |todo| stack.push(0, todo)) {
                        child = next;
                        continue;
                    }
                }
                ChildKind::Block(i) => Self::block_closest(q, at, &self.blocks[i as usize], best),
                ChildKind::Object(i) => q.object_closest(at, i, best),
            }
            // Nothing is skipped but what is entered strictly beyond the best t; entries below 0 were raised to 0.
            let limit = ops::max(best.t, 0.0);
            child = loop {
                match stack.pop(0) {
                    None => return,
                    Some(todo) if f32::from_bits(todo.entry) <= limit => break todo.child,
                    Some(_) => {}
                }
            };
        }
    }

    #[inline(always)]
    fn occluded<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
    ) -> bool {
        let Some(mut child) = self.root else { return false };
        let mut stack = Stacks::<Child, { build::STACK }, 1>::new();
        loop {
            let found = match child.kind() {
                ChildKind::Node(i) => {
                    let node = &self.nodes[i as usize];
                    if COUNT {
                        q.count_node(node.count());
                    }
                    let mut mask = q.kernel.node(at.ray, node, at.ray.ray.t_max).mask;
                    if mask != 0 {
                        child = node.children[take(&mut mask)];
                        while mask != 0 {
                            stack.push(0, node.children[take(&mut mask)]);
                        }
                        continue;
                    }
                    false
                }
                ChildKind::Block(i) => Self::block_occluded(q, at, &self.blocks[i as usize]),
                ChildKind::Object(i) => q.object_occluded(at, i),
            };
            if found {
                return true;
            }
            match stack.pop(0) {
                Some(next) => child = next,
                None => return false,
            }
        }
    }

    #[inline(always)]
    fn closest_many<K: Kernel, S: Shapes>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        hits: &mut [Hit],
    ) {
        self.many::<K, S, false>(q, group, rays, |i, hit| hits[i] = *hit);
    }

    #[inline(always)]
    fn occluded_many<K: Kernel, S: Shapes>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        blocked: &mut [bool],
    ) {
        self.many::<K, S, true>(q, group, rays, |i, hit| blocked[i] = hit.is_hit());
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.blocks.as_slice())
    }

    fn stats(&self) -> Stats {
        self.tree_stats()
    }
}
