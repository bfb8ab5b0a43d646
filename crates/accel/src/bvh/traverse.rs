//! Searching the tree with one ray.

use super::{Block, Bvh, Child, ChildKind, Node, build};
use crate::{
    hit::Hit,
    input::Shapes,
    kernel::{Children, Kernel, stack::Stack},
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

/// Takes the nearest of the entered children and pushes the others, the farthest first.
#[inline(always)]
fn nearest_first<const N: usize>(
    node: &Node,
    found: &mut Children,
    stack: &mut Stack<Todo, N>,
) -> Option<Child> {
    let child = |key: u32| node.children[(key & 7) as usize];
    let todo = |key: u32| Todo { entry: key & !7, child: child(key) };
    let keys = &mut found.keys;
    match found.count {
        0 => None,
        1 => Some(child(keys[0])),
        2 => {
            let (near, far) = if keys[0] < keys[1] { (keys[0], keys[1]) } else { (keys[1], keys[0]) };
            stack.push(todo(far));
            Some(child(near))
        }
        n => {
            let keys = &mut keys[..n.min(8)];
            for i in 1..keys.len() {
                let key = keys[i];
                let mut j = i;
                while j > 0 && keys[j - 1] < key {
                    keys[j] = keys[j - 1];
                    j -= 1;
                }
                keys[j] = key;
            }
            let (near, others) = keys.split_last()?;
            for &key in others {
                stack.push(todo(key));
            }
            Some(child(*near))
        }
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
        let Some(mut child) = self.root else { return };
        let mut stack = Stack::<Todo, { build::STACK }>::new();
        loop {
            match child.kind() {
                ChildKind::Node(i) => {
                    q.count_node();
                    let node = &self.nodes[i as usize];
                    let mut found = q.kernel.node(at.ray, node, best.t);
                    if let Some(next) = nearest_first(node, &mut found, &mut stack) {
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
                match stack.pop() {
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
        let mut stack = Stack::<Child, { build::STACK }>::new();
        loop {
            let found = match child.kind() {
                ChildKind::Node(i) => {
                    q.count_node();
                    let node = &self.nodes[i as usize];
                    let found = q.kernel.node(at.ray, node, at.ray.ray.t_max);
                    for &key in &found.keys[..found.count.min(8)] {
                        stack.push(node.children[(key & 7) as usize]);
                    }
                    false
                }
                ChildKind::Block(i) => Self::block_occluded(q, at, &self.blocks[i as usize]),
                ChildKind::Object(i) => q.object_occluded(at, i),
            };
            if found {
                return true;
            }
            match stack.pop() {
                Some(next) => child = next,
                None => return false,
            }
        }
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.blocks.as_slice())
    }
}
