//! Searching the tree with many rays in flight.
//!
//! One ray waits most of the time: for a node to arrive from memory, for one test to end before the next can be chosen,
//! and for a branch that was guessed wrongly. So many rays are searched side by side. They stand in queues by what they
//! visit next: a node, a block, an object, or nothing more. A queue is worked through from one end to the other: what
//! is done for one ray doesn't depend on the ray before, and which queue the ray goes to is computed, not branched on, so
//! that the processor works on several at a time. What a ray visits next is prefetched when it is put in its queue.

use super::{Bvh, Child, class, near::Near};
use crate::{
    hit::{Chain, Hit},
    input::Shapes,
    kernel::{Children, Kernel, descent::Descent},
    local::LocalRay,
    query::Query,
    scene::GroupData,
    structure::Place,
};
use straal_math::{Ray, Vec3};

/// Rays in flight. Enough that the first of a queue has its node from memory when the last was prefetched.
const FLIGHT: usize = 32;

/// A ray in flight.
#[derive(Clone, Copy)]
struct Flight {
    ray: LocalRay,
    near: Near,
    /// A hit that isn't a triangle of this tree.
    best: Hit,
    /// What is visited next.
    child: Child,
    /// Its place in the slice.
    index: usize,
}

/// Rays that do the same next.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Queue {
    len: u32,
    lanes: [u8; FLIGHT],
}

impl Queue {
    const EMPTY: Self = Self { len: 0, lanes: [0; FLIGHT] };

    #[inline(always)]
    fn push(&mut self, lane: u8) {
        // There are no more rays than places.
        self.lanes[self.len as usize % FLIGHT] = lane;
        self.len += 1;
    }

    /// The lanes, taken out.
    #[inline(always)]
    fn take(&mut self) -> Self {
        let out = *self;
        self.len = 0;
        out
    }

    #[inline(always)]
    fn lanes(&self) -> &[u8] {
        let len = self.len as usize;
        &self.lanes[..if len < FLIGHT { len } else { FLIGHT }]
    }
}

impl Bvh {
    /// Calls `done` with each ray's place and hit; when `ANY`, with any hit of the ray.
    #[inline(always)]
    pub(super) fn many<K: Kernel, S: Shapes, const ANY: bool, const PREFETCH: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        mut done: impl FnMut(usize, Hit),
    ) {
        let (idle_ray, _) = LocalRay::prepare(&Ray::new(Vec3::ZERO, Vec3::X));
        let near = Near::new(&Hit::limit(0.0));
        let idle = Flight { ray: idle_ray, near, best: Hit::MISS, child: Child::DONE, index: usize::MAX };
        let mut flights = [idle; FLIGHT];
        let mut stacks = Descent::many::<FLIGHT>();
        let mut queues = [Queue::EMPTY; 4];
        let mut room = None;
        for lane in 0..FLIGHT {
            queues[class::DONE].push(lane as u8);
        }
        let mut found = [Children::NONE; FLIGHT];
        let mut staged =
            Staged { rays: [idle_ray; FLIGHT], is_valid: [false; FLIGHT], next: 0, len: 0, taken: 0 };
        loop {
            for &lane in queues[class::DONE].take().lanes() {
                let f = &mut flights[usize::from(lane) % FLIGHT];
                if f.index != usize::MAX {
                    done(f.index, f.near.hit(&Place { group, ray: &f.ray, chain: &Chain::EMPTY }, &f.best));
                    f.index = usize::MAX;
                }
                if self.launch::<K, S, ANY>(q, group, rays, &mut staged, f, &mut done) {
                    stacks[usize::from(lane) % FLIGHT].reset();
                    self.enqueue::<K, PREFETCH>(q.kernel, f, lane, &mut queues);
                }
            }
            // Two short loops rather than a long one: more rays of each fit into what the processor looks ahead.
            let nodes = queues[class::NODE].take();
            for (&lane, found) in nodes.lanes().iter().zip(&mut found) {
                let f = &flights[usize::from(lane) % FLIGHT];
                let node = &self.nodes[f.child.index()];
                match ANY {
                    true => found.mask = q.kernel.entered(&f.ray, node),
                    false => *found = q.kernel.node(&f.ray, node, f.near.limit),
                }
            }
            for (&lane, found) in nodes.lanes().iter().zip(&found) {
                let f = &mut flights[usize::from(lane) % FLIGHT];
                let stack = &mut stacks[usize::from(lane) % FLIGHT];
                let node = &self.nodes[f.child.index()];
                f.child = match ANY {
                    true => q.kernel.descend_any(node, found.mask, stack),
                    false => q.kernel.descend(node, found, stack),
                };
                self.enqueue::<K, PREFETCH>(q.kernel, f, lane, &mut queues);
            }
            let mut crossed = [Queue::EMPTY; 2];
            for &lane in queues[class::BLOCK].take().lanes() {
                let f = &flights[usize::from(lane) % FLIGHT];
                let block = self.block(q.scene, group, f.child.index(), &mut room);
                let inside = q.kernel.inside(&f.ray, block);
                crossed[usize::from(inside != 0)].push(lane);
            }
            for &lane in crossed[0].lanes() {
                let f = &mut flights[usize::from(lane) % FLIGHT];
                f.child = stacks[usize::from(lane) % FLIGHT].pop();
                self.enqueue::<K, PREFETCH>(q.kernel, f, lane, &mut queues);
            }
            for &lane in crossed[1].lanes() {
                let f = &mut flights[usize::from(lane) % FLIGHT];
                let stack = &mut stacks[usize::from(lane) % FLIGHT];
                let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
                let block = self.block(q.scene, group, f.child.index(), &mut room);
                if ANY {
                    if Self::block_occluded(q, &at, block) {
                        f.best.geometry = 0;
                        stack.reset();
                    }
                } else if Self::block_closest(q, &at, block, &mut f.near, &f.best) {
                    stack.keep_within(f.near.key());
                }
                f.child = stack.pop();
                self.enqueue::<K, PREFETCH>(q.kernel, f, lane, &mut queues);
            }
            for &lane in queues[class::OBJECT].take().lanes() {
                let f = &mut flights[usize::from(lane) % FLIGHT];
                let stack = &mut stacks[usize::from(lane) % FLIGHT];
                let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
                let object = f.child.index() as u32;
                if ANY {
                    if q.object_occluded(&at, object) {
                        f.best.geometry = 0;
                        stack.reset();
                    }
                } else {
                    f.near.settle(&at, &mut f.best);
                    q.object_closest(&at, object, &mut f.best);
                    f.near = Near::new(&f.best);
                    stack.keep_within(f.near.key());
                }
                f.child = stack.pop();
                self.enqueue::<K, PREFETCH>(q.kernel, f, lane, &mut queues);
            }
            if queues.iter().all(|q| q.len == 0) {
                return;
            }
        }
    }

    /// Puts a ray into the queue of what it visits next, and begins to load that.
    #[inline(always)]
    fn enqueue<K: Kernel, const PREFETCH: bool>(
        &self,
        kernel: K,
        f: &Flight,
        lane: u8,
        queues: &mut [Queue; 4],
    ) {
        queues[f.child.class()].push(lane);
        if PREFETCH {
            kernel.prefetch(&self.nodes, &self.blocks, f.child);
        }
    }

    /// Takes the next ray that isn't settled at once; false when there is none left.
    #[inline(always)]
    fn launch<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        staged: &mut Staged,
        f: &mut Flight,
        done: &mut impl FnMut(usize, Hit),
    ) -> bool {
        loop {
            if staged.next == staged.len && !staged.refill(rays) {
                return false;
            }
            let (at, index) = (staged.next % FLIGHT, staged.taken - staged.len + staged.next);
            staged.next += 1;
            if !staged.is_valid[at] {
                done(index, Hit::MISS);
                continue;
            }
            f.ray = staged.rays[at];
            f.best = Hit::limit(f.ray.ray.t_max);
            if !group.unbounded.is_empty() {
                let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
                for &object in &group.unbounded {
                    q.object_closest(&at, object, &mut f.best);
                }
            }
            match self.root {
                Some(child) if !(ANY && f.best.is_hit()) => {
                    f.near = Near::new(&f.best);
                    f.child = child;
                    f.index = index;
                    return true;
                }
                _ => done(index, f.best.finished()),
            }
        }
    }
}

/// Rays made ready to be launched, many at a time.
struct Staged {
    rays: [LocalRay; FLIGHT],
    is_valid: [bool; FLIGHT],
    /// The first that isn't launched.
    next: usize,
    /// How many there are.
    len: usize,
    /// How many of the slice were staged.
    taken: usize,
}

impl Staged {
    /// Stages the next rays of the slice; false when there are none.
    #[inline(always)]
    fn refill(&mut self, rays: &[Ray]) -> bool {
        let rest = &rays[self.taken..];
        self.len = if rest.len() < FLIGHT { rest.len() } else { FLIGHT };
        self.taken += self.len;
        self.next = 0;
        for ((ray, local), valid) in rest.iter().zip(&mut self.rays).zip(&mut self.is_valid) {
            (*local, *valid) = LocalRay::prepare(ray);
        }
        self.len > 0
    }
}
