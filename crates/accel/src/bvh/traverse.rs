//! Searching the tree with one ray.

use super::{Block, Bvh, Child, ChildKind, build};
use crate::{
    hit::Hit,
    input::Shapes,
    kernel::{Children, Kernel},
    query::Query,
    structure::{Place, Search},
    triangle,
};
use straal_math::ops;

/// A subtree to be visited, with the bits of an entry that isn't later than the true one (and not below 0).
#[derive(Clone, Copy)]
struct Todo {
    entry: u32,
    child: Child,
}

impl Bvh {
    #[inline(always)]
    fn block_closest<K: Kernel, S: Shapes, const COUNT: bool>(
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
            let lane = mask.trailing_zeros() as usize % 8;
            mask &= mask - 1;
            let (t, det) = (lanes.t[lane], lanes.det[lane]);
            let tuv = [t, lanes.e1[lane] / det, lanes.e2[lane] / det];
            if t <= best.t {
                q.triangle_hit(at, block.id[lane], &block.vertices(lane), tuv, best);
            }
        }
        let mut mask = lanes.zero;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize % 8;
            mask &= mask - 1;
            q.triangle_closest(at, block.id[lane], &block.vertices(lane), best);
        }
    }

    #[inline(always)]
    fn block_occluded<K: Kernel, S: Shapes, const COUNT: bool>(
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
            let lane = mask.trailing_zeros() as usize % 8;
            mask &= mask - 1;
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

/// Puts the entered children in order, the nearest last.
#[inline(always)]
fn sort_far_first(found: &mut Children) {
    let keys = &mut found.keys[..found.count.min(8)];
    for i in 1..keys.len() {
        let key = keys[i];
        let mut j = i;
        while j > 0 && keys[j - 1] < key {
            keys[j] = keys[j - 1];
            j -= 1;
        }
        keys[j] = key;
    }
}

impl Search for Bvh {
    #[inline(always)]
    fn closest<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        let Some(root) = self.root else { return };
        let mut stack = [Todo { entry: 0, child: root }; build::STACK];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let todo = stack[height];
            // Nothing is skipped but what is entered strictly beyond the best t; entries below 0 were raised to 0.
            if f32::from_bits(todo.entry) > ops::max(best.t, 0.0) {
                continue;
            }
            match todo.child.kind() {
                ChildKind::Node(i) => {
                    q.count_node();
                    let node = &self.nodes[i as usize];
                    let mut found = q.kernel.node(at.ray, node, best.t);
                    sort_far_first(&mut found);
                    for &key in &found.keys[..found.count.min(8)] {
                        stack[height] = Todo { entry: key & !7, child: node.children[(key & 7) as usize] };
                        height += 1;
                    }
                }
                ChildKind::Block(i) => {
                    Self::block_closest(q, at, &self.blocks[i as usize], best);
                }
                ChildKind::Object(i) => q.object_closest(at, i, best),
            }
        }
    }

    #[inline(always)]
    fn occluded<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
    ) -> bool {
        let Some(root) = self.root else { return false };
        let mut stack = [root; build::STACK];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            match stack[height].kind() {
                ChildKind::Node(i) => {
                    q.count_node();
                    let node = &self.nodes[i as usize];
                    let found = q.kernel.node(at.ray, node, at.ray.ray.t_max);
                    for &key in &found.keys[..found.count.min(8)] {
                        stack[height] = node.children[(key & 7) as usize];
                        height += 1;
                    }
                }
                ChildKind::Block(i) => {
                    if Self::block_occluded(q, at, &self.blocks[i as usize]) {
                        return true;
                    }
                }
                ChildKind::Object(i) => {
                    if q.object_occluded(at, i) {
                        return true;
                    }
                }
            }
        }
        false
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.blocks.as_slice())
    }
}
