//! Searching the tree with a packet: rays that start close together and go about the same way.
//!
//! The rays of a tile's pixels, or from what they hit to a lamp, meet nearly the same nodes. So a packet goes down the
//! tree as one: a node's boxes are tested against intervals of the rays' origins and reciprocal directions (Boulos, Wald
//! and Shirley 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets"), which tells with one test what
//! all rays miss. Only at a leaf is each ray tested, eight at a time, against the leaf's box, and those that cross it
//! against its triangles by the kernel that single rays use.
//!
//! Interval arithmetic here is that of `slab.rs` on the intervals' ends. Its roundings are monotone, so that the bounds
//! hold for each ray's own rounded crossings without any slack.
//!
//! Rays that don't belong together would visit each other's leaves; a packet that does so is given up, which costs the
//! time that went into it and changes nothing else.

use super::{Bvh, Child, ChildKind, Node, STACK, WIDTH, many::Members, near::Near, traverse::take};
use crate::{
    hit::{Chain, Hit},
    input::Shapes,
    kernel::{Kernel, LaneHit, prefetch::TO_FIRST},
    local::LocalRay,
    query::Query,
    scene::GroupData,
    slab::EXIT,
    structure::Place,
};
use straal_math::{Ray, Vec3};

/// Rays in a packet.
pub(super) const PACKET: usize = 64;

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

type Lanes = [f32; WIDTH];

/// One value for each of eight lanes. Written so that the compiler makes vector instructions of it.
#[inline(always)]
fn lanes(f: impl Fn(usize) -> f32) -> Lanes {
    std::array::from_fn(f)
}

#[inline(always)]
fn less(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn more(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Bounds of all rays of a packet along one axis.
#[derive(Clone, Copy)]
struct AxisBounds {
    /// The origin from which near planes are crossed first, and the one from which far planes are crossed last.
    near_o: f32,
    far_o: f32,
    inv: [f32; 2],
    /// Which of a box' two planes is the near one: 0 or 1.
    near: usize,
}

/// What holds for all rays of a packet.
struct Bundle {
    axes: [AxisBounds; 3],
    enter: f32,
}

impl Bundle {
    /// Boxes that some ray may enter no later than `limit`, and earliest entries.
    #[inline(always)]
    fn entries<K: Kernel>(&self, kernel: K, node: &Node, limit: f32) -> (u32, Lanes) {
        let mut enter = [self.enter; WIDTH];
        let mut exit = [f32::INFINITY; WIDTH];
        for (axis, a) in self.axes.iter().enumerate() {
            let near = &node.planes[2 * axis + (a.near & 1)];
            let far = &node.planes[2 * axis + (a.near & 1 ^ 1)];
            let first = lanes(|i| less((near[i] - a.near_o) * a.inv[0], (near[i] - a.near_o) * a.inv[1]));
            let last = lanes(|i| more((far[i] - a.far_o) * a.inv[0], (far[i] - a.far_o) * a.inv[1]));
            enter = lanes(|i| more(first[i], enter[i]));
            exit = lanes(|i| less(last[i], exit[i]));
        }
        (kernel.no_more(&enter, &lanes(|i| less(exit[i] * EXIT, limit))), enter)
    }
}

/// What is to be visited: a child, its earliest entry, and where its box is.
#[derive(Clone, Copy)]
struct Item {
    entry: f32,
    child: Child,
    node: u32,
    slot: u32,
}

/// A packet under way. Numbers of all rays of one kind lie together, to be tested eight at a time.
struct Packet {
    rays: [LocalRay; PACKET],
    near: [Near; PACKET],
    best: [Hit; PACKET],
    first: [LaneHit; PACKET],
    o: [[Lanes; PACKET / WIDTH]; 3],
    inv: [[Lanes; PACKET / WIDTH]; 3],
    enter: [Lanes; PACKET / WIDTH],
    /// What is entered beyond this is left out; negative where the search is over.
    limit: [Lanes; PACKET / WIDTH],
}

impl Packet {
    /// The rays that enter a child's box.
    #[inline(always)]
    fn entering<K: Kernel>(&self, kernel: K, bundle: &Bundle, node: &Node, slot: usize) -> u64 {
        let mut out = 0;
        for g in 0..PACKET / WIDTH {
            let mut enter = self.enter[g];
            let mut exit = [f32::INFINITY; WIDTH];
            for (axis, a) in bundle.axes.iter().enumerate() {
                let near = node.planes[2 * axis + (a.near & 1)][slot];
                let far = node.planes[2 * axis + (a.near & 1 ^ 1)][slot];
                let (o, inv) = (&self.o[axis][g], &self.inv[axis][g]);
                enter = lanes(|i| more((near - o[i]) * inv[i], enter[i]));
                exit = lanes(|i| less((far - o[i]) * inv[i], exit[i]));
            }
            let mask = kernel.no_more(&enter, &lanes(|i| less(exit[i] * EXIT, self.limit[g][i])));
            out |= u64::from(mask) << (WIDTH * g);
        }
        out
    }

    /// The latest limit of all rays.
    #[inline(always)]
    fn limit(&self) -> f32 {
        let all = self.limit.iter().fold([-1.0; WIDTH], |a, b| lanes(|i| more(a[i], b[i])));
        all.into_iter().fold(-1.0, more)
    }

    #[inline(always)]
    fn set_limit(&mut self, ray: usize, limit: f32) {
        self.limit[ray / WIDTH % (PACKET / WIDTH)][ray % WIDTH] = limit;
    }
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
    /// Searches with a packet and calls `done` with each ray's place and hit (when `ANY`, with any hit of the ray). False,
    /// with nothing done, when the rays make none or it was given up.
    #[inline(always)]
    pub(super) fn packet<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        mut done: impl FnMut(usize, Hit),
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
        self.search_packet::<K, S, ANY>(q, group, rays, root, &mut done)
    }

    #[inline(always)]
    fn search_packet<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
        group: &GroupData,
        rays: &[Ray],
        root: Child,
        done: &mut impl FnMut(usize, Hit),
    ) -> bool {
        let mut p = Packet {
            rays: [LocalRay::IDLE; PACKET],
            near: [Near::nothing(0.0); PACKET],
            best: [Hit::MISS; PACKET],
            first: [LaneHit::NONE; PACKET],
            o: [[[0.0; WIDTH]; PACKET / WIDTH]; 3],
            inv: [[[0.0; WIDTH]; PACKET / WIDTH]; 3],
            enter: [[0.0; WIDTH]; PACKET / WIDTH],
            limit: [[-1.0; WIDTH]; PACKET / WIDTH],
        };
        for (i, ray) in rays.iter().enumerate().take(PACKET) {
            if !q.kernel.prepare(ray, &mut p.rays[i]) {
                return false;
            }
            let local = &p.rays[i];
            p.near[i] = Near::nothing(local.ray.t_max);
            let (g, lane) = (i / WIDTH, i % WIDTH);
            for axis in 0..3 {
                p.o[axis][g][lane] = local.ray.o[axis];
                p.inv[axis][g][lane] = local.inv[axis];
            }
            p.enter[g][lane] = local.enter;
            p.limit[g][lane] = p.near[i].limit;
        }
        let bounds = |all: &[Lanes]| {
            let low = all.iter().fold([f32::INFINITY; WIDTH], |a, b| lanes(|i| less(a[i], b[i])));
            let high = all.iter().fold([f32::NEG_INFINITY; WIDTH], |a, b| lanes(|i| more(a[i], b[i])));
            [low.into_iter().fold(f32::INFINITY, less), high.into_iter().fold(f32::NEG_INFINITY, more)]
        };
        let bundle = Bundle {
            axes: std::array::from_fn(|axis| {
                let ([low, high], inv) = (bounds(&p.o[axis]), bounds(&p.inv[axis]));
                let near = usize::from(p.rays[0].neg[axis] & 1);
                let (near_o, far_o) = if near == 0 { (high, low) } else { (low, high) };
                AxisBounds { near_o, far_o, inv, near }
            }),
            enter: bounds(&p.enter)[0],
        };
        let mut stack = [Item { entry: 0.0, child: Child::DONE, node: u32::MAX, slot: 0 }; STACK];
        let mut len = 0;
        let mut limit = p.limit();
        let (mut leaves, mut crossed) = (0, 0);
        let mut item = Item { entry: 0.0, child: root, node: u32::MAX, slot: 0 };
        loop {
            if let ChildKind::Node(index) = item.child.kind() {
                let node = &self.nodes[index as usize];
                let (mut mask, entries) = bundle.entries(q.kernel, node, limit);
                let start = len;
                while mask != 0 && len < STACK {
                    let slot = take(&mut mask);
                    let entry = entries[slot];
                    q.kernel.prefetch::<TO_FIRST>(&self.nodes, &self.blocks, node.children[slot]);
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
                let entering = match self.nodes.get(item.node as usize) {
                    Some(node) => p.entering(q.kernel, &bundle, node, item.slot as usize % WIDTH),
                    None => u64::MAX,
                };
                leaves += 1;
                crossed += entering.count_ones();
                if leaves >= TRIAL && crossed < leaves * const { fewest(ANY) } {
                    return false;
                }
                self.leaf::<K, S, ANY>(q, group, item.child, &mut p, entering);
                if entering != 0 {
                    limit = p.limit();
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
            done(i, near.hit(&Place { group, ray, chain: &Chain::EMPTY }, best));
        }
        true
    }

    /// Tests some rays of a packet against a leaf.
    #[inline(always)]
    fn leaf<K: Kernel, S: Shapes, const ANY: bool>(
        &self,
        q: &mut Query<'_, K, S, false>,
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
                        p.set_limit(i, limit);
                    }
                }
                for i in Members::<PACKET>(several) {
                    let at = Place { group, ray: &p.rays[i], chain: &Chain::EMPTY };
                    if ANY {
                        if Self::block_occluded(q, &at, block) {
                            p.near[i].set_found(&mut p.best[i]);
                            p.set_limit(i, -1.0);
                        }
                    } else if Self::block_closest(q, &at, block, &mut p.near[i], &p.best[i]) {
                        p.set_limit(i, p.near[i].limit);
                    }
                }
            }
            ChildKind::Object(o) => {
                for i in Members::<PACKET>(entering) {
                    let at = Place { group, ray: &p.rays[i], chain: &Chain::EMPTY };
                    let (near, best) = (&mut p.near[i], &mut p.best[i]);
                    if ANY {
                        if q.object_occluded(&at, o) {
                            near.set_found(best);
                            p.set_limit(i, -1.0);
                        }
                    } else {
                        near.settle(&at, best);
                        q.object_closest(&at, o, best);
                        *near = Near::new(best);
                        p.set_limit(i, p.near[i].limit);
                    }
                }
            }
            ChildKind::Node(_) | ChildKind::Done => {}
        }
    }
}
