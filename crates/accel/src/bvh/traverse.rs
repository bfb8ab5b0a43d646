//! Searching the tree with one ray.

use super::{
    Block, Bvh, ChildKind, Node, WIDTH,
    near::{Candidate, Near},
    packet::PACKET,
};
use crate::{
    hit::Hit,
    input::Shapes,
    kernel::{
        Kernel,
        descent::{ALL, Descent},
    },
    local::LocalRay,
    query::Query,
    scene::GroupData,
    structure::{Place, Search, Stats},
    triangle,
};
use straal_math::Ray;

impl Bvh {
    /// Offers what a block has to the nearest hit; tells whether that moved.
    #[inline(always)]
    pub(super) fn block_closest<K: Kernel, S: Shapes, const COUNT: bool>(
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        block: &Block,
        near: &mut Near,
        best: &Hit,
    ) -> bool {
        if COUNT {
            q.count_block(block.count());
        }
        let lanes = q.kernel.block(at.ray, block, near.t);
        let mut moved = false;
        let mut mask = lanes.hit;
        while mask != 0 {
            let lane = take(&mut mask);
            let hit = lanes.candidate(lane);
            if hit.t <= near.t {
                moved |= Self::offer(q, at, (block, lane), hit, near, best);
            }
        }
        let mut mask = lanes.doubtful;
        while mask != 0 {
            let lane = take(&mut mask);
            if let Some([t, u, v]) = triangle::intersect(&block.vertices(lane), at.ray, near.t) {
                let hit = Candidate { t, uv: [u, v], det: 1.0 };
                moved |= Self::offer(q, at, (block, lane), hit, near, best);
            }
        }
        moved
    }

    #[inline(always)]
    pub(super) fn offer<K: Kernel, S: Shapes, const COUNT: bool>(
        q: &Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        (block, lane): (&Block, usize),
        hit: Candidate,
        near: &mut Near,
        best: &Hit,
    ) -> bool {
        match q.lane_counts(at, block, lane, hit.t) {
            Some(t) => near.offer(at, block.id[lane], Candidate { t, ..hit }, best),
            None => false,
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
        let mut mask = lanes.hit | lanes.doubtful;
        while mask != 0 {
            let lane = take(&mut mask);
            let found = lanes.hit >> lane & 1 == 1
                || triangle::intersect(&block.vertices(lane), at.ray, at.ray.ray.t_max).is_some();
            if found && q.lane_counts(at, block, lane, 0.0).is_some() {
                return true;
            }
        }
        false
    }

    /// Searches a slice, in packets where its rays make some.
    #[inline(always)]
    fn slice<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        mut done: impl FnMut(usize, Hit),
    ) {
        // From here on nothing is done.
        let mut rest = 0;
        let mut start = 0;
        let mut failures = 0;
        while start < rays.len() {
            let end = if rays.len() - start < PACKET { rays.len() } else { start + PACKET };
            let window = &rays[start..end];
            let is_done = failures < PATIENCE
                && self.packet::<K, S, ANY>(q, group, window, |i, hit| done(start + i, hit));
            if is_done {
                self.one_by_one::<K, S, ANY>(q, group, &rays[rest..start], |i, hit| done(rest + i, hit));
                rest = end;
            } else {
                failures += 1;
            }
            start = end;
        }
        self.one_by_one::<K, S, ANY>(q, group, &rays[rest..], |i, hit| done(rest + i, hit));
    }

    #[inline(always)]
    fn one_by_one<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        done: impl FnMut(usize, Hit),
    ) {
        match (rays.is_empty(), self.is_large()) {
            (true, _) => {}
            (_, true) => self.many::<K, S, ANY, true>(q, group, rays, done),
            (_, false) => self.many::<K, S, ANY, false>(q, group, rays, done),
        }
    }

    /// The nearest child that is entered; the others are pushed, the farthest first.
    #[inline(always)]
    fn nearest_first<K: Kernel>(
        kernel: K,
        ray: &LocalRay,
        node: &Node,
        limit: f32,
        stack: &mut Descent<ALL>,
    ) -> Option<super::Child> {
        let found = kernel.node(ray, node, limit);
        let mut mask = found.mask;
        if mask == 0 {
            return None;
        }
        let first = take(&mut mask);
        if mask == 0 {
            return Some(node.children[first]);
        }
        let second = take(&mut mask);
        if mask == 0 {
            let (a, b) = (found.keys[first], found.keys[second]);
            let (near, far) = if a < b { (first, second) } else { (second, first) };
            stack.push(found.keys[far], node.children[far]);
            return Some(node.children[near]);
        }
        kernel.push_sorted(node, &found, stack);
        Some(stack.pop())
    }
}

/// How many packets of a slice may fail until no more are tried.
const PATIENCE: u32 = 1;

/// The lowest lane of a set, taken out of it.
#[inline(always)]
pub(super) fn take(mask: &mut u32) -> usize {
    let lane = mask.trailing_zeros() as usize % WIDTH;
    *mask &= mask.wrapping_sub(1);
    lane
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
        let mut near = Near::new(best);
        let mut room = None;
        let mut stack = Descent::<ALL>::new();
        loop {
            match child.kind() {
                ChildKind::Node(i) => {
                    let node = &self.nodes[i as usize];
                    if COUNT {
                        q.count_node(node.count());
                    }
                    if let Some(next) = Self::nearest_first(q.kernel, at.ray, node, near.limit, &mut stack) {
                        child = next;
                        continue;
                    }
                }
                ChildKind::Block(i) => {
                    let block = self.block(q.scene, at.group, i as usize, &mut room);
                    Self::block_closest(q, at, block, &mut near, best);
                }
                ChildKind::Object(i) => {
                    near.settle(at, best);
                    q.object_closest(at, i, best);
                    near = Near::new(best);
                }
                ChildKind::Done => break,
            }
            child = stack.pop_within(near.key());
        }
        if near.is_found() {
            near.settle(at, best);
        }
    }

    #[inline(always)]
    fn occluded<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
    ) -> bool {
        let Some(mut child) = self.root else { return false };
        let mut room = None;
        let mut stack = Descent::<ALL>::new();
        loop {
            let found = match child.kind() {
                ChildKind::Node(i) => {
                    let node = &self.nodes[i as usize];
                    if COUNT {
                        q.count_node(node.count());
                    }
                    let mut mask = q.kernel.entered(at.ray, node);
                    if mask != 0 {
                        child = node.children[take(&mut mask)];
                        while mask != 0 {
                            stack.push(0, node.children[take(&mut mask)]);
                        }
                        continue;
                    }
                    false
                }
                ChildKind::Block(i) => {
                    let block = self.block(q.scene, at.group, i as usize, &mut room);
                    Self::block_occluded(q, at, block)
                }
                ChildKind::Object(i) => q.object_occluded(at, i),
                ChildKind::Done => return false,
            };
            if found {
                return true;
            }
            child = stack.pop();
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
        self.slice::<K, S, false>(q, group, rays, |i, hit| hits[i] = hit);
    }

    #[inline(always)]
    fn occluded_many<K: Kernel, S: Shapes>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        blocked: &mut [bool],
    ) {
        self.slice::<K, S, true>(q, group, rays, |i, hit| blocked[i] = hit.is_hit());
    }

    fn memory_bytes(&self) -> usize {
        self.bytes()
    }

    fn stats(&self) -> Stats {
        self.tree_stats()
    }
}
