//! Searching the tree with one ray.

use super::{
    Bvh, Distance,
    answers::Answers,
    few_triangles::Among,
    many::{FLIGHT, REMOTE_FLIGHT},
    near::Near,
};
use crate::{
    hit::Hit,
    kernel::{
        Candidate, LaneHit,
        descent::{ALL, Descent},
        prefetch::{NOT, TO_FIRST, TO_SECOND},
    },
    node::{Block, Child, WIDTH, bundle::PACKET},
    query::{Built, DescendMany, Place, Query, Stats},
    slab::loosened,
    stage::GroupData,
    triangle,
};
use straal_math::{Ray, simd::Simd};

impl Bvh {
    /// Offers what a block has to the nearest hit; tells whether that moved.
    #[inline(always)]
    pub(super) fn block_closest<K: DescendMany, const COUNT: bool>(
        q: &mut Query<'_, K, COUNT>,
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
            let found = lanes.certain(lane);
            if found.hit.t <= near.t {
                moved |= Self::offer(q, at, (block, &found), near, best);
            }
        }
        let mut mask = lanes.doubtful;
        while mask != 0 {
            let lane = take(&mut mask);
            if let Some([t, u, v]) = triangle::intersect(&block.vertices(lane), at.ray, near.t) {
                let hit = Candidate { t, uv: [u, v], det: 1.0 };
                let found = LaneHit { lane: lane as u32, boxed: false, hit };
                moved |= Self::offer(q, at, (block, &found), near, best);
            }
        }
        moved
    }

    #[inline(always)]
    pub(super) fn offer<K: DescendMany, const COUNT: bool>(
        q: &Query<'_, K, COUNT>,
        at: &Place<'_>,
        (block, found): (&Block, &LaneHit),
        near: &mut Near,
        best: &Hit,
    ) -> bool {
        match q.lane_counts(at, block, found) {
            Some(t) => {
                let id = block.id(found.lane as usize % WIDTH);
                near.offer(at, id, Candidate { t, ..found.hit }, best)
            }
            None => false,
        }
    }

    #[inline(always)]
    pub(super) fn block_occluded<K: DescendMany, const COUNT: bool>(
        q: &mut Query<'_, K, COUNT>,
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
            let is_certain = lanes.hit >> lane & 1 == 1;
            let found = LaneHit {
                lane: lane as u32,
                boxed: is_certain && lanes.boxed >> lane & 1 == 1,
                ..LaneHit::NONE
            };
            let is_hit =
                is_certain || triangle::intersect(&block.vertices(lane), at.ray, at.ray.ray.t_max).is_some();
            if is_hit && q.lane_counts(at, block, &found).is_some() {
                return true;
            }
        }
        false
    }

    /// Offers what a block of shapes has to the nearest hit; tells whether that moved.
    #[inline(always)]
    pub(super) fn shapes_closest<K: DescendMany, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        i: usize,
        near: &mut Near,
        best: &mut Hit,
    ) -> bool {
        let block = self.shapes.get(i);
        let found = q.shapes_met(at, block, near.t);
        if found.hit == 0 {
            return false;
        }
        near.settle(at, best);
        q.shapes_offer(at, block, &found, best);
        *near = Near::new(best);
        true
    }

    /// Searches a slice, in packets where its rays make some.
    #[inline(always)]
    fn slice<K: DescendMany, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        rays: &[Ray],
        out: &mut (impl Answers + ?Sized),
    ) {
        if !self.few.is_empty() {
            self.few_many::<K, ANY>(q, group, rays, out);
            if self.root.is_none() && group.unbounded.is_empty() {
                return;
            }
        }
        let simd = q.kernel.simd();
        if !self.triangles.is_empty() && group.unbounded.is_empty() && simd != Simd::PLAIN {
            let (stage, after_shapes) = (q.scene, !self.few.is_empty());
            simd.run(Among::<_, _, ANY> { few: &self.triangles, stage, group, rays, out, after_shapes });
            return;
        }
        // From here on nothing is done.
        let mut rest = 0;
        let mut start = 0;
        let (mut packets, mut failures) = (0, 0);
        loop {
            let end = if rays.len() - start < PACKET { rays.len() } else { start + PACKET };
            let window = &rays[start..end];
            let is_end = window.is_empty();
            let is_done = K::IN_PACKETS
                && !is_end
                && failures * PATIENCE <= packets
                && self.packet::<K, ANY>(q, group, window, (out, start));
            if is_done || is_end {
                // In one place: it becomes part of this function.
                self.one_by_one::<K, ANY>(q, group, &rays[rest..start], (out, rest));
                rest = end;
                packets += 1;
            } else {
                failures += 1;
            }
            if is_end {
                return;
            }
            start = end;
        }
    }

    #[inline(always)]
    fn one_by_one<K: DescendMany, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        rays: &[Ray],
        out: (&mut (impl Answers + ?Sized), usize),
    ) {
        if rays.is_empty() {
            return;
        }
        if !K::FETCHES {
            return self.many::<K, ANY, FLIGHT, NOT>(q, group, rays, out);
        }
        match self.distance() {
            Distance::Near => self.many::<K, ANY, FLIGHT, NOT>(q, group, rays, out),
            Distance::Far => self.many::<K, ANY, FLIGHT, TO_FIRST>(q, group, rays, out),
            Distance::Remote => self.many::<K, ANY, REMOTE_FLIGHT, TO_SECOND>(q, group, rays, out),
        }
    }
}

/// Packets are tried as long as no more than one in so many of a slice failed.
const PATIENCE: u32 = 4;

/// The lowest lane of a set, taken out of it.
#[inline(always)]
pub(super) fn take(mask: &mut u32) -> usize {
    let lane = mask.trailing_zeros() as usize % WIDTH;
    *mask &= mask.wrapping_sub(1);
    lane
}

impl Bvh {
    /// The hit of each ray of the world, searched together; `hits` is as long as `rays`.
    #[inline(always)]
    pub(crate) fn closest_many<K: DescendMany>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        rays: &[Ray],
        hits: &mut [Hit],
    ) {
        self.slice::<K, false>(q, group, rays, hits);
    }

    /// Whether each ray of the world hits anything, searched together; `blocked` is as long as `rays`.
    #[inline(always)]
    pub(crate) fn occluded_many<K: DescendMany>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        rays: &[Ray],
        blocked: &mut [bool],
    ) {
        self.slice::<K, true>(q, group, rays, blocked);
    }
}

impl Bvh {
    /// As [`Search::closest`](crate::query::Search::closest), in code compiled for the kernel.
    #[inline(always)]
    pub(crate) fn closest<K: DescendMany, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        self.few_closest(q, at, best);
        let Some(mut child) = self.root else { return };
        let mut near = Near::new(best);
        let mut room = None;
        let mut stack = Descent::<ALL>::new();
        loop {
            while child.is_node() {
                let node = self.lines.node(child.index());
                if COUNT {
                    q.count_node(node.count());
                }
                child = match q.kernel.nearest(at.ray, node, near.limit, &mut stack) {
                    Some(next) => next,
                    None => stack.pop_within(near.key()),
                };
            }
            if child.is_block() {
                let block = self.block(q.scene, at.group, child.index(), &mut room);
                Self::block_closest(q, at, block, &mut near, best);
            } else if child == Child::DONE {
                break;
            } else if let Some(i) = child.as_shapes() {
                self.shapes_closest(q, at, i, &mut near, best);
            } else {
                near.settle(at, best);
                q.object_closest(at, child.index() as u32, best);
                near = Near::new(best);
            }
            child = stack.pop_within(near.key());
        }
        if near.is_found() {
            near.settle(at, best);
        }
    }

    /// The same for any hit.
    #[inline(always)]
    pub(crate) fn occluded<K: DescendMany, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
    ) -> bool {
        if self.few_occluded(q, at) {
            return true;
        }
        let Some(mut child) = self.root else { return false };
        let limit = loosened(at.ray.ray.t_max);
        let mut room = None;
        let mut stack = Descent::<ALL>::new();
        loop {
            while child.is_node() {
                let node = self.lines.node(child.index());
                if COUNT {
                    q.count_node(node.count());
                }
                child = match q.kernel.any(at.ray, node, limit, &mut stack) {
                    Some(next) => next,
                    None => stack.pop(),
                };
            }
            let found = if child.is_block() {
                let block = self.block(q.scene, at.group, child.index(), &mut room);
                Self::block_occluded(q, at, block)
            } else if child == Child::DONE {
                return false;
            } else if let Some(i) = child.as_shapes() {
                q.shapes_occluded(at, self.shapes.get(i))
            } else {
                q.object_occluded(at, child.index() as u32)
            };
            if found {
                return true;
            }
            child = stack.pop();
        }
    }
}

impl Built for Bvh {
    fn memory_bytes(&self) -> usize {
        self.bytes()
    }

    fn stats(&self) -> Stats {
        self.tree_stats()
    }
}
