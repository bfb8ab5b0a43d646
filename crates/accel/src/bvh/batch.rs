//! Rays that enter the same instance go on together: they are moved into its space one after the other, and searched there as a
//! slice, so that what makes slices quick holds on every level.

use crate::{
    hit::Hit,
    local::LocalRay,
    query::{DescendMany, Query, not_before},
    stage::{Object, ObjectKind, Stage},
};
use straal_math::{Ray, Vec3};

/// The members of a set of up to `N` rays, in order.
pub(super) struct Members<const N: usize>(pub u64);

impl<const N: usize> Iterator for Members<N> {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let first = self.0.trailing_zeros() as usize;
        self.0 &= self.0.wrapping_sub(1);
        (first < N).then_some(first)
    }
}

/// Rays in a batch.
const ROOM: usize = 64;

/// Fewer rays than this are searched one by one: setting up a slice wouldn't pay.
const LEAST: u32 = 8;

/// Rays in an instance's space, and what they hit there.
pub(super) struct Batch {
    rays: [Ray; ROOM],
    /// Where each enters the instance's box.
    entries: [f32; ROOM],
    /// The places of the rays where they come from.
    places: [u8; ROOM],
    hits: [Hit; ROOM],
    blocked: [bool; ROOM],
    len: usize,
}

/// Whether an object is an instance of something large, and rays are enough to be searched together in it.
#[inline(always)]
pub(super) fn pays<S>(stage: &Stage<S>, o: &Object, rays: u64) -> bool {
    rays.count_ones() >= LEAST
        && match o.kind {
            ObjectKind::Instance(id) => stage.groups[stage.instances[id as usize].group as usize].is_large,
            ObjectKind::Shape { .. } => false,
        }
}

impl Batch {
    pub const EMPTY: Self = Self {
        rays: [Ray::new(Vec3::ZERO, Vec3::X); ROOM],
        entries: [0.0; ROOM],
        places: [0; ROOM],
        hits: [Hit::MISS; ROOM],
        blocked: [false; ROOM],
        len: 0,
    };

    pub const fn clear(&mut self) {
        self.len = 0;
    }

    /// Takes a ray if it can see the instance and crosses its box; what lies beyond `limit` doesn't count.
    #[inline]
    pub fn add<K: DescendMany>(
        &mut self,
        q: &mut Query<'_, K, false>,
        ray: &LocalRay,
        o: &Object,
        limit: f32,
        place: usize,
    ) {
        let ObjectKind::Instance(id) = o.kind else { return };
        let Some(entry) = q.enter(ray, o) else { return };
        if self.len < ROOM {
            let inner = q.scene.inverse_ray(&q.scene.instances[id as usize], &ray.ray);
            // That no hit lies beyond what was found already is all that an end says.
            self.rays[self.len] = Ray { t_max: limit, ..inner };
            self.entries[self.len] = entry;
            self.places[self.len] = place as u8;
            self.len += 1;
        }
    }

    /// Searches the instance; calls `found` with the place of each ray that hits something in it, and the hit.
    #[inline]
    pub fn closest<K: DescendMany>(
        &mut self,
        q: &mut Query<'_, K, false>,
        o: &Object,
        mut found: impl FnMut(usize, &Hit),
    ) {
        let ObjectKind::Instance(id) = o.kind else { return };
        let group = &q.scene.groups[q.scene.instances[id as usize].group as usize];
        let hits = &mut self.hits[..self.len];
        q.kernel.closest_slice(q, group, &self.rays[..self.len], hits);
        for (i, hit) in hits.iter_mut().enumerate().filter(|(_, hit)| hit.is_hit()) {
            hit.t = not_before(hit.t, self.entries[i]);
            hit.chain = hit.chain.inside(id);
            found(usize::from(self.places[i]), hit);
        }
    }

    /// Searches the instance for any hits; the rays that have one.
    #[inline]
    pub fn occluded<K: DescendMany>(&mut self, q: &mut Query<'_, K, false>, o: &Object) -> Members<ROOM> {
        let ObjectKind::Instance(id) = o.kind else { return Members(0) };
        let group = &q.scene.groups[q.scene.instances[id as usize].group as usize];
        let blocked = &mut self.blocked[..self.len];
        q.kernel.occluded_slice(q, group, &self.rays[..self.len], blocked);
        let bit = |(&is_blocked, &place): (&bool, &u8)| u64::from(is_blocked) << (place % 64);
        Members(blocked.iter().zip(&self.places).map(bit).fold(0, |all, bit| all | bit))
    }
}
