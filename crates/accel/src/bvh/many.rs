//! Searching the tree with many rays in flight.
//!
//! One ray waits most of the time: for a node to arrive from memory, and for one test to end before the next can be
//! chosen. So several rays take turns, one node or leaf each, and what a ray needs at its next turn is prefetched while
//! the others have theirs. Each ray's own search is that of `traverse.rs`, step by step.

use super::{
    Bvh, Child, ChildKind, build,
    traverse::{Todo, nearest_first, take},
};
use crate::{
    hit::{Chain, Hit},
    input::Shapes,
    kernel::{Kernel, stack::Stacks},
    local::LocalRay,
    query::Query,
    scene::GroupData,
    structure::Place,
};
use straal_math::{Ray, ops};

/// Rays in flight.
const FLIGHT: usize = 16;

/// A ray in flight.
#[derive(Clone, Copy)]
struct Flight {
    ray: LocalRay,
    best: Hit,
    /// What is visited at the next turn.
    child: Child,
    /// Its place in the slice.
    index: usize,
}

impl Bvh {
    /// Calls `done` with each ray's place and hit; when `ANY`, with any hit of the ray.
    #[inline(always)]
    pub(super) fn many<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        mut done: impl FnMut(usize, &Hit),
    ) {
        let Some(idle) = LocalRay::new(&Ray::new(straal_math::Vec3::ZERO, straal_math::Vec3::X)) else {
            return;
        };
        let mut flights = [Flight { ray: idle, best: Hit::MISS, child: Child::node(0), index: 0 }; FLIGHT];
        let mut stacks = Stacks::<Todo, { build::STACK }, FLIGHT>::new();
        let mut next = 0;
        let mut flying = 0;
        while flying < FLIGHT
            && self.launch::<K, S, ANY>(q, group, rays, &mut next, &mut flights[flying], &mut done)
        {
            flying += 1;
        }
        while flying > 0 {
            let mut lane = 0;
            while lane < flying {
                let f = &mut flights[lane];
                if self.turn::<K, S, ANY>(q, group, f, lane, &mut stacks) {
                    lane += 1;
                    continue;
                }
                done(f.index, &f.best.finished());
                stacks.clear(lane);
                if self.launch::<K, S, ANY>(q, group, rays, &mut next, f, &mut done) {
                    lane += 1;
                } else {
                    // The last takes its place, stack and all.
                    flying -= 1;
                    flights[lane] = flights[flying];
                    stacks.swap(lane, flying);
                }
            }
        }
    }

    /// Takes the next ray that isn't settled at once; false when there is none left.
    #[inline(always)]
    fn launch<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        next: &mut usize,
        f: &mut Flight,
        done: &mut impl FnMut(usize, &Hit),
    ) -> bool {
        while let Some(ray) = rays.get(*next) {
            let index = *next;
            *next += 1;
            let Some(ray) = LocalRay::new(ray) else {
                done(index, &Hit::MISS);
                continue;
            };
            let mut best = Hit::limit(ray.ray.t_max);
            let at = Place { group, ray: &ray, chain: &Chain::EMPTY };
            for &object in &group.unbounded {
                q.object_closest(&at, object, &mut best);
            }
            match self.root {
                Some(child) if !(ANY && best.is_hit()) => {
                    *f = Flight { ray, best, child, index };
                    return true;
                }
                _ => done(index, &best.finished()),
            }
        }
        false
    }

    /// Visits one node or leaf; false when the ray's search is over.
    #[inline(always)]
    fn turn<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        f: &mut Flight,
        lane: usize,
        stacks: &mut Stacks<Todo, { build::STACK }, FLIGHT>,
    ) -> bool {
        let at = Place { group, ray: &f.ray, chain: &Chain::EMPTY };
        let mut found = None;
        match f.child.kind() {
            ChildKind::Node(i) => {
                let node = &self.nodes[i as usize];
                let children = q.kernel.node(&f.ray, node, f.best.t);
                if ANY {
                    let mut mask = children.mask;
                    if mask != 0 {
                        found = Some(node.children[take(&mut mask)]);
                        while mask != 0 {
                            stacks.push(lane, Todo { entry: 0, child: node.children[take(&mut mask)] });
                        }
                    }
                } else {
                    found = nearest_first(node, &children, |todo| stacks.push(lane, todo));
                }
            }
            ChildKind::Block(i) => {
                let block = &self.blocks[i as usize];
                if !ANY {
                    Self::block_closest(q, &at, block, &mut f.best);
                } else if Self::block_occluded(q, &at, block) {
                    f.best.geometry = 0;
                    return false;
                }
            }
            ChildKind::Object(i) => {
                if !ANY {
                    q.object_closest(&at, i, &mut f.best);
                } else if q.object_occluded(&at, i) {
                    f.best.geometry = 0;
                    return false;
                }
            }
        }
        f.child = match found {
            Some(child) => child,
            None => {
                let limit = ops::max(f.best.t, 0.0);
                loop {
                    match stacks.pop(lane) {
                        None => return false,
                        Some(todo) if f32::from_bits(todo.entry) <= limit => break todo.child,
                        Some(_) => {}
                    }
                }
            }
        };
        match f.child.kind() {
            ChildKind::Node(i) => q.kernel.prefetch(&self.nodes[i as usize]),
            ChildKind::Block(i) => q.kernel.prefetch(&self.blocks[i as usize]),
            ChildKind::Object(_) => {}
        }
        true
    }
}
