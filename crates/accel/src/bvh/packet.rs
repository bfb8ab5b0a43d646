//! Searching the tree with a packet: rays that start close together and go about the same way.
//!
//! The rays of a tile's pixels, or from what they hit to a lamp, meet nearly the same nodes. So a packet goes down the
//! tree as one: a node's boxes are tested against all rays together (`bundle.rs`). Only at a leaf is each ray tested, eight
//! at a time, against the leaf's box, and those that cross it against its triangles, as single rays are.
//!
//! Rays that don't belong together would visit each other's leaves; a packet that does so is given up, which costs the
//! time that went into it and changes nothing else.

use super::{
    Bvh,
    answers::Answers,
    batch::Members,
    batch::{self, Batch},
    near::Near,
    traverse::take,
};
use crate::{
    hit::{Chain, Hit},
    kernel::{LaneHit, prefetch::TO_FIRST},
    local::LocalRay,
    node::{
        Child, ChildKind, STACK, WIDTH,
        bundle::{Bundle, PACKET},
    },
    query::{DescendMany, Place, Query},
    stage::GroupData,
};
use straal_math::{Ray, Vec3};

/// Directions may differ by this much per unit along their greatest axis.
const SPREAD: f32 = 0.3;

/// Origins may lie apart by this part of the group's extent.
const APART: f32 = 0.1;

/// After this many leaves a packet is given up if too few of its rays cross a leaf on the mean.
const TRIAL: u32 = 16;

/// How many rays must cross a leaf. Where any hit will do, rays searched side by side end sooner, so that more is asked:
/// measured with the bench on a bunny, a sphere with twenty times the triangles, and a room.
const fn fewest(any_hit: bool) -> u32 {
    if any_hit { 4 } else { 3 }
}

/// What is to be visited: a child, its earliest entry, and where its box is.
#[derive(Clone, Copy)]
struct Item {
    entry: f32,
    child: Child,
    node: u32,
    slot: u32,
}

/// A packet under way.
struct Packet {
    rays: [LocalRay; PACKET],
    near: [Near; PACKET],
    best: [Hit; PACKET],
    first: [LaneHit; PACKET],
    bundle: Bundle,
}

/// Whether rays may make a packet: as many as one has, valid, and of the same signs on all axes.
#[inline(always)]
fn may_be_packet(rays: &[Ray]) -> bool {
    let bits = |d: Vec3| [d.x.to_bits(), d.y.to_bits(), d.z.to_bits()];
    let differing = |a: [u32; 3], b: [u32; 3]| (a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2]);
    rays.len() == PACKET
        && rays
            .chunks(WIDTH)
            .all(|some| some.iter().fold(0, |all, r| all | differing(bits(r.d), bits(rays[0].d))) >> 31 == 0)
}

impl Bvh {
    /// Searches with a packet of rays whose answers begin at a place, as in `many.rs`. False, with nothing done, when the rays make
    /// none or it was given up.
    #[inline(always)]
    pub(super) fn packet<K: DescendMany, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        rays: &[Ray],
        out: (&mut (impl Answers + ?Sized), usize),
    ) -> bool {
        let Some(root) = self.root else { return false };
        if !may_be_packet(rays) || !group.unbounded.is_empty() {
            return false;
        }
        let extent = group.extent();
        // A sample of the rays is enough to guess by.
        let sample = || rays.iter().step_by(WIDTH + 1);
        let (mut low, mut high) = (rays[0].o, rays[0].o);
        for r in sample() {
            low = low.min(r.o);
            high = high.max(r.o);
        }
        if (high - low).max_element() > extent * APART {
            return false;
        }
        let axis = rays[0].d.abs().max_axis();
        let (mut first, mut last) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        for r in sample() {
            let slope = r.d / r.d[axis];
            first = first.min(slope);
            last = last.max(slope);
        }
        if (last - first).max_element() > SPREAD {
            return false;
        }
        self.search_packet::<K, ANY>(q, group, rays, root, out)
    }

    #[inline(always)]
    fn search_packet<K: DescendMany, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        rays: &[Ray],
        root: Child,
        (out, from): (&mut (impl Answers + ?Sized), usize),
    ) -> bool {
        let mut p = Packet {
            rays: [LocalRay::IDLE; PACKET],
            near: [Near::nothing(0.0); PACKET],
            best: [Hit::MISS; PACKET],
            first: [LaneHit::NONE; PACKET],
            bundle: Bundle::EMPTY,
        };
        for (i, ray) in rays.iter().enumerate().take(PACKET) {
            if !q.kernel.prepare(ray, &mut p.rays[i]) {
                return false;
            }
            let local = &p.rays[i];
            p.near[i] = Near::nothing(local.ray.t_max);
            let mut limit = p.near[i].limit;
            if !self.few.is_empty() {
                p.best[i] = out.get(from + i);
                if p.best[i].is_hit() {
                    p.near[i] = Near::new(&p.best[i]);
                    limit = if ANY { -1.0 } else { p.near[i].limit };
                }
            }
            p.bundle.set(i, local, limit);
        }
        p.bundle.bound(&p.rays[0]);
        let mut stack = [Item { entry: 0.0, child: Child::DONE, node: u32::MAX, slot: 0 }; STACK];
        let mut len = 0;
        let mut limit = p.bundle.limit();
        let (mut leaves, mut crossed) = (0, 0);
        let mut item = Item { entry: 0.0, child: root, node: u32::MAX, slot: 0 };
        loop {
            if let ChildKind::Node(index) = item.child.kind() {
                let node = self.lines.node(index as usize);
                let (mut mask, entries) = q.kernel.entries(&p.bundle, node, limit);
                let start = len;
                while mask != 0 && len < STACK {
                    let slot = take(&mut mask);
                    let entry = entries[slot];
                    q.kernel.prefetch::<TO_FIRST>(&self.lines, node.children[slot]);
                    // The farthest first.
                    let mut i = len;
                    while i > start && stack[i - 1].entry < entry {
                        stack[i] = stack[i - 1];
                        i -= 1;
                    }
                    stack[i] = Item { entry, child: node.children[slot], node: index, slot: slot as u32 };
                    len += 1;
                }
            } else {
                let entering = match item.node {
                    u32::MAX => u64::MAX,
                    i => {
                        q.kernel.entering(&p.bundle, self.lines.node(i as usize), item.slot as usize % WIDTH)
                    }
                };
                leaves += 1;
                crossed += entering.count_ones();
                if leaves >= TRIAL && crossed < leaves * const { fewest(ANY) } {
                    return false;
                }
                self.leaf::<K, ANY>(q, group, item.child, &mut p, entering);
                if entering != 0 {
                    limit = p.bundle.limit();
                    if limit < 0.0 {
                        break;
                    }
                }
            }
            loop {
                if len == 0 {
                    item.child = Child::DONE;
                    break;
                }
                len -= 1;
                item = stack[len];
                if item.entry <= limit {
                    break;
                }
            }
            if item.child == Child::DONE {
                break;
            }
        }
        for (i, ((ray, near), best)) in p.rays.iter().zip(&p.near).zip(&p.best).enumerate() {
            out.set(from + i, near.hit(&Place { group, ray, chain: &Chain::EMPTY }, best));
        }
        true
    }

    /// Tests some rays of a packet against a leaf.
    #[inline(always)]
    fn leaf<K: DescendMany, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, false>,
        group: &GroupData,
        child: Child,
        p: &mut Packet,
        entering: u64,
    ) {
        match child.kind() {
            ChildKind::Block(b) => {
                let mut room = None;
                let block = self.block(q.scene, group, b as usize, &mut room);
                // In steps, as in `many.rs`.
                let (mut crossed, mut one, mut several) = (0, 0, 0);
                for i in Members::<PACKET>(entering) {
                    crossed |= u64::from(q.kernel.inside(&p.rays[i], block) != 0) << i;
                }
                for i in Members::<PACKET>(crossed) {
                    let lanes = q.kernel.block(&p.rays[i], block, p.near[i].t);
                    p.first[i] = lanes.first();
                    one |= u64::from(lanes.is_one()) << i;
                    several |= u64::from(lanes.is_several()) << i;
                }
                for i in Members::<PACKET>(one) {
                    let at = Place { group, ray: &p.rays[i], chain: &Chain::EMPTY };
                    if Self::offer(q, &at, (block, &p.first[i]), &mut p.near[i], &p.best[i]) {
                        let limit = if ANY { -1.0 } else { p.near[i].limit };
                        p.bundle.set_limit(i, limit);
                    }
                }
                for i in Members::<PACKET>(several) {
                    let at = Place { group, ray: &p.rays[i], chain: &Chain::EMPTY };
                    if ANY {
                        if Self::block_occluded(q, &at, block) {
                            p.near[i].set_found(&mut p.best[i]);
                            p.bundle.set_limit(i, -1.0);
                        }
                    } else if Self::block_closest(q, &at, block, &mut p.near[i], &p.best[i]) {
                        p.bundle.set_limit(i, p.near[i].limit);
                    }
                }
            }
            ChildKind::Object(o) if batch::pays(q.scene, &group.objects[o as usize], entering) => {
                let o = &group.objects[o as usize];
                let mut batch = Batch::EMPTY;
                for i in Members::<PACKET>(entering) {
                    batch.add(q, &p.rays[i], o, p.near[i].t, i);
                }
                if ANY {
                    for i in batch.occluded(q, o) {
                        p.near[i].set_found(&mut p.best[i]);
                        p.bundle.set_limit(i, -1.0);
                    }
                } else {
                    batch.closest(q, o, |i, hit| {
                        let (near, best) = (&mut p.near[i], &mut p.best[i]);
                        near.settle(&Place { group, ray: &p.rays[i], chain: &Chain::EMPTY }, best);
                        best.offer(hit);
                        *near = Near::new(best);
                        p.bundle.set_limit(i, near.limit);
                    });
                }
            }
            ChildKind::Object(o) => {
                for i in Members::<PACKET>(entering) {
                    let at = Place { group, ray: &p.rays[i], chain: &Chain::EMPTY };
                    let (near, best) = (&mut p.near[i], &mut p.best[i]);
                    if ANY {
                        if q.object_occluded(&at, o) {
                            near.set_found(best);
                            p.bundle.set_limit(i, -1.0);
                        }
                    } else {
                        near.settle(&at, best);
                        q.object_closest(&at, o, best);
                        *near = Near::new(best);
                        p.bundle.set_limit(i, p.near[i].limit);
                    }
                }
            }
            ChildKind::Shapes(b) => {
                for i in Members::<PACKET>(entering) {
                    let at = Place { group, ray: &p.rays[i], chain: &Chain::EMPTY };
                    let (near, best) = (&mut p.near[i], &mut p.best[i]);
                    if ANY {
                        if q.shapes_occluded(&at, self.shapes.get(b as usize)) {
                            near.set_found(best);
                            p.bundle.set_limit(i, -1.0);
                        }
                    } else if self.shapes_closest(q, &at, b as usize, near, best) {
                        p.bundle.set_limit(i, near.limit);
                    }
                }
            }
            ChildKind::Node(_) | ChildKind::Done => {}
        }
    }
}
