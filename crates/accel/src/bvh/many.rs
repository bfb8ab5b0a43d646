//! Searching the tree with many rays in flight.
//!
//! One ray waits most of the time: for a node to arrive from memory, for one test to end before the next can be chosen,
//! and for a branch that was guessed wrongly. So many rays are searched side by side. In each turn all of them go one
//! step, those that do the same one after the other: a node, a block, an object, or nothing more. What is done for one ray
//! doesn't depend on the ray before, and is computed rather than branched on, so that the processor works on several at a
//! time. What a ray visits next is prefetched.
//!
//! Which rays do what is told by sets of bits, made for all at once at the start of a turn. Queues would do less well:
//! where an entry is put is known late, and the processor, which has seen that what is loaded next may be what was put
//! there, would wait for it.

use super::{
    Bvh,
    answers::Answers,
    batch::{self, Batch, Members},
    near::Near,
};
use crate::{
    hit::{Chain, Hit},
    kernel::{
        LaneHit, Next,
        descent::{Descent, Spilled},
        prefetch::{NOT, TO_SECOND},
    },
    local::LocalRay,
    node::{Child, class},
    query::{DescendMany, Place, Query},
    stage::GroupData,
};
use straal_math::Ray;

/// Rays in flight: enough that the first of a loop has its node from the third-level cache when the last was prefetched.
pub(super) const FLIGHT: usize = 32;

/// The same from memory, which is farther. Yet more push each other's stacks out of the first-level cache (at ten million
/// triangles, 40 and 64 are 2 % slower, 32 is 5 %).
pub(super) const REMOTE_FLIGHT: usize = 48;

/// Of so many rays, those at a node go their step before what they visit next is prefetched. Close together, prefetches wait
/// side by side for where their pages are, which in large trees isn't at hand; each in its step, they hold up what follows.
const TOGETHER: usize = 16;

/// Size of a ray's stack: nearly all rays do with fewer. All stacks together are to stay in the first-level cache.
const STACK: usize = 64;

/// A ray in flight: two cache lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Flight {
    ray: LocalRay,
    near: Near,
    /// Its place in the slice; `u32::MAX` for none.
    index: u32,
}

const _: () = assert!(size_of::<Flight>() == 128);

/// Rays that are still to be launched.
struct Waiting<'a> {
    rays: &'a [Ray],
    next: usize,
}

impl Bvh {
    /// Searches rays whose answers begin at a place; when `ANY`, for any hit. Where there are a few shapes beside the tree, the
    /// answers are what these gave.
    #[inline(always)]
    pub(super) fn many<K: DescendMany, const ANY: bool, const N: usize, const PREFETCH: u8>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        rays: &[Ray],
        (out, from): (&mut (impl Answers + ?Sized), usize),
    ) {
        let idle = Flight { ray: LocalRay::IDLE, near: Near::nothing(0.0), index: u32::MAX };
        let mut flights = [idle; N];
        let mut next = Next([Child::DONE; N]);
        // Hits that aren't triangles of this tree, of those who have one.
        let mut elsewhere = [Hit::MISS; N];
        let mut stacks = Descent::<STACK>::many::<N>();
        let mut spilled: [Spilled; N] = std::array::from_fn(|_| Spilled::new());
        let mut first = [LaneHit::NONE; N];
        let mut room = None;
        let mut together = None;
        let mut waiting = Waiting { rays, next: 0 };
        let nodes = self.lines.nodes();
        let prefetch = |kernel: K, child: Child| {
            if const { PREFETCH != NOT } {
                kernel.prefetch::<PREFETCH>(&self.lines, child);
            }
        };
        // Rays that are searched or may be.
        let mut live = u64::MAX >> (64 - N);
        while live != 0 {
            let classes = q.kernel.classes(&next).map(|set| set & live);
            for i in Members::<N>(classes[class::DONE]) {
                let (f, stack) = (&mut flights[i], &mut stacks[i]);
                if f.index != u32::MAX {
                    if !(ANY && f.near.is_found()) && stack.refill(&mut spilled[i]) {
                        next.0[i] = stack.pop();
                        continue;
                    }
                    let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
                    out.set(from + f.index as usize, f.near.hit(&at, &elsewhere[i]));
                }
                match self.launch::<K, ANY>(q, group, &mut waiting, (f, &mut elsewhere[i]), (&mut *out, from))
                {
                    Some(root) => {
                        stack.reset();
                        spilled[i].clear();
                        next.0[i] = root;
                    }
                    None => live &= !(1 << i),
                }
            }
            let at_once = const { if PREFETCH == NOT { N } else { TOGETHER } };
            for start in (0..N).step_by(at_once) {
                let some = classes[class::NODE] & (u64::MAX >> (64 - at_once)) << start;
                for i in Members::<N>(some) {
                    let (f, stack) = (&flights[i], &mut stacks[i]);
                    let node = nodes.get(next.0[i].index());
                    let child = match ANY {
                        true => q.kernel.step_any(&f.ray, node, f.near.limit, stack),
                        false => q.kernel.step(&f.ray, node, f.near.limit, stack),
                    };
                    match child {
                        Some(child) => next.0[i] = child,
                        // It goes its step in the next turn.
                        None => stack.spill(&mut spilled[i]),
                    }
                }
                // The compiler would keep a loop that does nothing.
                if PREFETCH != NOT {
                    Members::<N>(some).for_each(|i| prefetch(q.kernel, next.0[i]));
                }
            }
            // In steps, none of which waits for the one before: whether a ray crosses any triangle, which most don't; where;
            // and whether that counts. Only where a block has several to choose from are they taken at once.
            let (mut crossed, mut one, mut several) = (0_u64, 0_u64, 0_u64);
            for i in Members::<N>(classes[class::BLOCK]) {
                let block = self.block(q.scene, group, next.0[i].index(), &mut room);
                crossed |= u64::from(q.kernel.inside(&flights[i].ray, block) != 0) << i;
            }
            // From memory, the earlier what comes next is asked for the better.
            let early = if PREFETCH == TO_SECOND { classes[class::BLOCK] & !crossed } else { 0 };
            for i in Members::<N>(early) {
                let child = stacks[i].pop();
                next.0[i] = child;
                prefetch(q.kernel, child);
            }
            for i in Members::<N>(crossed) {
                let (f, block) = (&flights[i], self.block(q.scene, group, next.0[i].index(), &mut room));
                let lanes = q.kernel.block(&f.ray, block, f.near.t);
                first[i] = lanes.first();
                one |= u64::from(lanes.is_one()) << i;
                several |= u64::from(lanes.is_several()) << i;
            }
            for i in Members::<N>(one) {
                let (f, stack) = (&mut flights[i], &mut stacks[i]);
                let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
                let block = self.block(q.scene, group, next.0[i].index(), &mut room);
                if Self::offer(q, &at, (block, &first[i]), &mut f.near, &elsewhere[i]) {
                    match ANY {
                        true => stack.reset(),
                        false => stack.keep_within(f.near.key()),
                    }
                }
            }
            for i in Members::<N>(several) {
                let (f, stack) = (&mut flights[i], &mut stacks[i]);
                let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
                let block = self.block(q.scene, group, next.0[i].index(), &mut room);
                if ANY {
                    if Self::block_occluded(q, &at, block) {
                        f.near.set_found(&mut elsewhere[i]);
                        stack.reset();
                    }
                } else if Self::block_closest(q, &at, block, &mut f.near, &elsewhere[i]) {
                    stack.keep_within(f.near.key());
                }
            }
            for i in Members::<N>(classes[class::BLOCK] & !early) {
                let child = stacks[i].pop();
                next.0[i] = child;
                prefetch(q.kernel, child);
            }
            // Rays wait at instances of something large until half of all are at one, so that more go together.
            let mut objects = classes[class::OBJECT];
            for i in Members::<N>(objects) {
                let Some(block) = next.0[i].as_shapes() else { continue };
                objects &= !(1 << i);
                let (f, stack, best) = (&mut flights[i], &mut stacks[i], &mut elsewhere[i]);
                let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
                if ANY {
                    if q.shapes_occluded(&at, self.shapes.get(block)) {
                        f.near.set_found(best);
                        stack.reset();
                    }
                } else if self.shapes_closest(q, &at, block, &mut f.near, best) {
                    stack.keep_within(f.near.key());
                }
                let child = stack.pop();
                next.0[i] = child;
                prefetch(q.kernel, child);
            }
            if group.has_large && objects.count_ones() * 2 < live.count_ones() {
                continue;
            }
            let mut rest = objects;
            while rest != 0 {
                let first = next.0[rest.trailing_zeros() as usize % N];
                let same = Members::<N>(rest).filter(|&i| next.0[i] == first);
                let same = same.fold(0_u64, |set, i| set | 1 << i);
                rest &= !same;
                let object = first.index() as u32;
                let o = &group.objects[object as usize];
                if batch::pays(q.scene, o, same) {
                    let batch = together.get_or_insert(Batch::EMPTY);
                    batch.clear();
                    for i in Members::<N>(same) {
                        batch.add(q, &flights[i].ray, o, flights[i].near.t, i);
                    }
                    if ANY {
                        for i in batch.occluded(q, o) {
                            flights[i].near.set_found(&mut elsewhere[i]);
                            stacks[i].reset();
                        }
                    } else {
                        batch.closest(q, o, |i, hit| {
                            let (f, best) = (&mut flights[i], &mut elsewhere[i]);
                            f.near.settle(&Place { group, ray: &f.ray, chain: &Chain::EMPTY }, best);
                            best.offer(hit);
                            f.near = Near::new(best);
                            stacks[i].keep_within(f.near.key());
                        });
                    }
                } else {
                    for i in Members::<N>(same) {
                        let (f, stack, best) = (&mut flights[i], &mut stacks[i], &mut elsewhere[i]);
                        let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
                        if ANY {
                            if q.object_occluded(&at, object) {
                                f.near.set_found(best);
                                stack.reset();
                            }
                        } else {
                            f.near.settle(&at, best);
                            q.object_closest(&at, object, best);
                            f.near = Near::new(best);
                            stack.keep_within(f.near.key());
                        }
                    }
                }
                for i in Members::<N>(same) {
                    let child = stacks[i].pop();
                    next.0[i] = child;
                    prefetch(q.kernel, child);
                }
            }
        }
    }

    /// Takes the next ray that isn't settled at once, and tells what it visits first; `None` when there is none left.
    #[inline(always)]
    fn launch<K: DescendMany, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        waiting: &mut Waiting<'_>,
        (f, elsewhere): (&mut Flight, &mut Hit),
        (out, from): (&mut (impl Answers + ?Sized), usize),
    ) -> Option<Child> {
        while let Some(ray) = waiting.rays.get(waiting.next) {
            let index = waiting.next;
            waiting.next += 1;
            if !q.kernel.prepare(ray, &mut f.ray) {
                out.set(from + index, Hit::MISS);
                continue;
            }
            f.near = Near::nothing(f.ray.ray.t_max);
            let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
            if !self.few.is_empty() {
                *elsewhere = out.get(from + index);
                if elsewhere.is_hit() {
                    f.near = Near::new(elsewhere);
                }
            }
            if !group.unbounded.is_empty() {
                if !f.near.is_found() {
                    *elsewhere = Hit::limit(f.ray.ray.t_max);
                }
                for &object in &group.unbounded {
                    q.object_closest(&at, object, elsewhere);
                }
                f.near = Near::new(elsewhere);
            }
            match self.root {
                Some(root) if !(ANY && f.near.is_found()) => {
                    f.index = index as u32;
                    return Some(root);
                }
                _ => out.set(from + index, f.near.hit(&at, elsewhere)),
            }
        }
        None
    }
}
