//! What every structure is asked, and the tests that it makes: one triangle, one object, one block.
//!
//! A structure is written for any [`Descend`]: a kernel that can also go down into a group, whatever structure that has. So a
//! structure knows of no other.

use crate::{
    analytic::block::{Block as ShapeBlock, Found},
    hit::{Chain, Cost, Hit},
    input::Shapes,
    kernel::{Kernel, LaneHit},
    local::LocalRay,
    node::{Block, WIDTH},
    prim::PrimKind,
    section::Section,
    slab,
    stage::{GroupData, Object, ObjectKind, Stage},
    triangle,
};
use straal_math::{Ray, Vec3};

/// What every structure over a group's bounded primitives is asked by a ray. The wide tree, whose search is compiled for each kernel, has the same
/// functions for a [`DescendMany`].
///
/// `closest` offers to `best` every primitive that could come before it, by the tests of `Query`, which are the same
/// for all; it may leave out only what lies strictly beyond `best.t` or outside the ray's interval.
pub(crate) trait Search: Built {
    fn closest<K: Descend, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    );

    /// Whether there is any hit in the ray's interval.
    fn occluded<K: Descend, const COUNT: bool>(&self, q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool;
}

/// What every structure is asked when it stands.
pub(crate) trait Built: Sized {
    fn memory_bytes(&self) -> usize;

    /// What a report says of the structure; it walks the whole of it.
    fn stats(&self) -> Stats;

    /// What a drawing of the structure shows at a height: cells, or the boxes of a binary tree. Other structures show nothing.
    fn section(&self, _z: f64) -> Vec<Section> {
        Vec::new()
    }
}

/// What a structure is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves or cells, the empty ones included.
    pub leaves: usize,
    /// Primitives in all leaves; more than there are where a primitive may be in several.
    pub references: usize,
    /// Steps from the root to the deepest leaf.
    pub depth: u32,
    /// What a random line through the root's box costs, in tests of one primitive, by the surface area heuristic with the
    /// structure's own costs (Goldsmith and Salmon 1987; MacDonald and Booth 1990).
    pub sah_cost: f64,
}

/// Where a search stands: a ray in a group's space, and the instances passed on the way.
pub(crate) struct Place<'a> {
    pub group: &'a GroupData,
    pub ray: &'a LocalRay,
    pub chain: &'a Chain,
}

/// Who searches groups, whatever structures these have.
pub(crate) trait Descend: Copy {
    /// A structure over a group.
    type Searcher: Sync;

    /// Searches a whole group.
    fn closest_in<const COUNT: bool>(self, q: &mut Query<'_, Self, COUNT>, at: &Place<'_>, best: &mut Hit);

    /// Whether anything in a group is hit.
    fn occluded_in<const COUNT: bool>(self, q: &mut Query<'_, Self, COUNT>, at: &Place<'_>) -> bool;
}

/// A kernel that searches groups, compiled for its instruction set, and slices of rays as well.
pub(crate) trait DescendMany: Descend + Kernel {
    /// The first hit of each ray in a group's space, with the chain from there on.
    fn closest_slice(self, q: &mut Query<'_, Self, false>, group: &GroupData, rays: &[Ray], hits: &mut [Hit]);

    /// Whether each ray hits anything in a group's space.
    fn occluded_slice(
        self,
        q: &mut Query<'_, Self, false>,
        group: &GroupData,
        rays: &[Ray],
        blocked: &mut [bool],
    );
}

/// One ray's search through a scene.
pub(crate) struct Query<'a, K: Descend, const COUNT: bool> {
    /// Who goes down into groups; a kernel proves that the processor has its instructions.
    pub kernel: K,
    pub scene: &'a Stage<K::Searcher>,
    pub shapes: &'a dyn Shapes,
    /// Stays 0 unless `COUNT`.
    pub cost: Cost,
}

/// The least t at which a hit at `t` in a box entered at `entry` counts. A branch rather than a maximum: that the entry comes
/// later is rare, and what follows the hit needn't wait for the box.
#[inline(always)]
pub(crate) fn not_before(t: f32, entry: f32) -> f32 {
    if entry > t { later(entry) } else { t }
}

/// Keeps the compiler from making the branch above a maximum.
#[cold]
#[inline(never)]
fn later(entry: f32) -> f32 {
    entry
}

impl<'a, K: Descend, const COUNT: bool> Query<'a, K, COUNT> {
    /// The same search by whom else goes down.
    #[inline(always)]
    pub fn by<J: Descend<Searcher = K::Searcher>, R>(
        &mut self,
        kernel: J,
        search: impl FnOnce(&mut Query<'a, J, COUNT>) -> R,
    ) -> R {
        let mut q = Query { kernel, scene: self.scene, shapes: self.shapes, cost: self.cost };
        let answer = search(&mut q);
        self.cost = q.cost;
        answer
    }

    /// Counts a node, or a cell, and how many boxes are tested in it.
    #[inline(always)]
    pub fn count_node(&mut self, boxes: u32) {
        if COUNT {
            self.cost.nodes += 1;
            self.cost.boxes += boxes;
        }
    }

    /// Counts a test that a mailbox made needless.
    #[inline(always)]
    pub fn count_duplicate(&mut self) {
        if COUNT {
            self.cost.duplicates += 1;
        }
    }

    /// Tests a primitive of any kind, one by itself.
    #[inline(always)]
    pub fn prim_closest(&mut self, at: &Place<'_>, prim: PrimKind, best: &mut Hit) {
        match prim {
            PrimKind::Triangle(id) => {
                if COUNT {
                    self.cost.primitives += 1;
                }
                self.triangle_closest(at, id, &self.scene.vertices(at.group, id), best);
            }
            PrimKind::Object(i) => self.object_closest(at, i, best),
        }
    }

    /// Whether a primitive of any kind is hit.
    #[inline(always)]
    pub fn prim_occluded(&mut self, at: &Place<'_>, prim: PrimKind) -> bool {
        match prim {
            PrimKind::Triangle(id) => {
                if COUNT {
                    self.cost.primitives += 1;
                }
                self.triangle_occluded(at, id, &self.scene.vertices(at.group, id))
            }
            PrimKind::Object(i) => self.object_occluded(at, i),
        }
    }

    /// Counts a block of triangles or shapes.
    #[inline(always)]
    pub fn count_block(&mut self, primitives: u32) {
        if COUNT {
            self.cost.blocks += 1;
            self.cost.primitives += primitives;
        }
    }

    /// Tests one triangle by the canonical routine.
    #[inline(always)]
    pub fn triangle_closest(&mut self, at: &Place<'_>, id: u32, v: &[Vec3; 3], best: &mut Hit) {
        if let Some([t, u, v_]) = triangle::intersect(v, at.ray, best.t)
            && let Some(t) = self.triangle_counts(at, id, v, t)
        {
            let (geometry, primitive) = at.group.locate(id);
            best.offer(&Hit { t, u, v: v_, geometry, primitive, chain: *at.chain });
        }
    }

    /// Whether one triangle is hit, by the canonical routine.
    #[inline(always)]
    pub fn triangle_occluded(&mut self, at: &Place<'_>, id: u32, v: &[Vec3; 3]) -> bool {
        triangle::intersect(v, at.ray, at.ray.ray.t_max)
            .is_some_and(|[t, ..]| self.triangle_counts(at, id, v, t).is_some())
    }

    /// Whether a triangle that the canonical routine found hit at `t` counts, and the t of its hit.
    #[inline(always)]
    fn triangle_counts(&self, at: &Place<'_>, id: u32, v: &[Vec3; 3], t: f32) -> Option<f32> {
        if !self.sees(at, id) {
            return None;
        }
        slab::entry(&slab::triangle_bounds(v), at.ray).map(|entry| not_before(t, entry))
    }

    /// Whether the ray's mask and that of a triangle's mesh share a bit.
    #[inline(always)]
    fn sees(&self, at: &Place<'_>, id: u32) -> bool {
        let mask = at.ray.ray.mask;
        mask & at.group.all_masks != 0 || mask & self.scene.geometry_mask(at.group.locate(id).0) != 0
    }

    /// The entry into an object's box if the ray can see the object and crosses the box.
    #[inline]
    pub fn enter(&mut self, ray: &LocalRay, o: &Object) -> Option<f32> {
        if COUNT {
            self.cost.primitives += 1;
        }
        if o.mask & ray.ray.mask == 0 {
            return None;
        }
        match &o.bounds {
            Some(b) => slab::entry(b, ray),
            None => Some(f32::NEG_INFINITY),
        }
    }

    /// Tests a shape or an instance.
    #[inline(never)]
    pub fn object_closest(&mut self, at: &Place<'_>, object: u32, best: &mut Hit) {
        let o = &at.group.objects[object as usize];
        let Some(entry) = self.enter(at.ray, o) else { return };
        match o.kind {
            ObjectKind::Shape { shape, geometry, primitive } => {
                let Some(h) = self.shape(at, shape) else { return };
                let (u, v) = (h.u, h.v);
                best.offer(&Hit { t: not_before(h.t, entry), u, v, geometry, primitive, chain: *at.chain });
            }
            ObjectKind::Instance(id) => {
                let Some((group, ray)) = self.descend(at, id) else { return };
                let mut inner = Hit::limit(best.t);
                let there = Place { group, ray: &ray, chain: &at.chain.with(id) };
                self.kernel.closest_in(self, &there, &mut inner);
                if inner.is_hit() {
                    inner.t = not_before(inner.t, entry);
                    best.offer(&inner);
                }
            }
        }
    }

    /// Whether a shape or an instance is hit.
    #[inline(never)]
    pub fn object_occluded(&mut self, at: &Place<'_>, object: u32) -> bool {
        let o = &at.group.objects[object as usize];
        if self.enter(at.ray, o).is_none() {
            return false;
        }
        match o.kind {
            ObjectKind::Shape { shape, .. } => self.shape(at, shape).is_some(),
            ObjectKind::Instance(id) => match self.descend(at, id) {
                Some((group, ray)) => {
                    let there = Place { group, ray: &ray, chain: &at.chain.with(id) };
                    self.kernel.occluded_in(self, &there)
                }
                None => false,
            },
        }
    }

    #[inline]
    fn shape(&self, at: &Place<'_>, shape: u32) -> Option<crate::ShapeHit> {
        let ray = &at.ray.ray;
        self.shapes.intersect(shape, ray).filter(|h| h.t >= ray.t_min && h.t <= ray.t_max)
    }

    /// The ray in an instance's own space.
    #[inline]
    fn descend(&self, at: &Place<'_>, id: u32) -> Option<(&'a GroupData, LocalRay)> {
        let instance = &self.scene.instances[id as usize];
        let ray = LocalRay::new(&self.scene.inverse_ray(instance, &at.ray.ray))?;
        Some((&self.scene.groups[instance.group as usize], ray))
    }
}

impl<K: DescendMany, const COUNT: bool> Query<'_, K, COUNT> {
    /// Whether a block's triangle that was found hit counts, and the t of its hit.
    #[inline(always)]
    pub fn lane_counts(&self, at: &Place<'_>, block: &Block, found: &LaneHit) -> Option<f32> {
        let (lane, t) = (found.lane as usize % WIDTH, found.hit.t);
        if !self.sees(at, block.id(lane)) {
            return None;
        }
        match found.boxed {
            true => Some(t),
            false => self.kernel.own_box(at.ray, block, lane).map(|entry| not_before(t, entry)),
        }
    }

    /// Tests a block of shapes.
    #[inline(always)]
    pub fn shapes_closest(&mut self, at: &Place<'_>, block: ShapeBlock<'_>, best: &mut Hit) {
        let found = self.shapes_met(at, block, best.t);
        self.shapes_offer(at, block, &found, best);
    }

    /// What a ray meets of a block of shapes up to a limit.
    #[inline(always)]
    pub fn shapes_met(&mut self, at: &Place<'_>, block: ShapeBlock<'_>, limit: f32) -> Found {
        self.count_block(block.head.count);
        self.kernel.meet(at.ray, block, limit)
    }

    /// Offers what was met of a block of shapes.
    #[inline(always)]
    pub fn shapes_offer(&self, at: &Place<'_>, block: ShapeBlock<'_>, found: &Found, best: &mut Hit) {
        let mut hit = found.hit;
        while hit != 0 {
            let lane = hit.trailing_zeros() as usize % WIDTH;
            hit &= hit - 1;
            if block.head.masks[lane] & at.ray.ray.mask != 0 {
                let (geometry, primitive) = at.group.shape(block.head.objects[lane]);
                let [t, u, v] = [found.t[lane], found.u[lane], found.v[lane]].map(|x| x as f32);
                best.offer(&Hit { t, u, v, geometry, primitive, chain: *at.chain });
            }
        }
    }

    /// Whether a shape of a block is hit.
    #[inline(always)]
    pub fn shapes_occluded(&mut self, at: &Place<'_>, block: ShapeBlock<'_>) -> bool {
        self.count_block(block.head.count);
        let mut hit = self.kernel.meet(at.ray, block, at.ray.ray.t_max).hit;
        while hit != 0 {
            if block.head.masks[hit.trailing_zeros() as usize % WIDTH] & at.ray.ray.mask != 0 {
                return true;
            }
            hit &= hit - 1;
        }
        false
    }
}
