//! The shapes of a group that has but a few: they stand beside the tree, and are tested before it is walked.
//!
//! A slice's rays are tested eight side by side (`analytic/octet.rs`). Where there is nothing else, as in the scenes with
//! which courses begin, no tree is walked at all. So are shapes without a box, however many they are, which every ray has to test.

use super::{Bvh, answers::Answers};
use crate::{
    analytic::{
        block::{Blocks, Member},
        octet::{Octets, RAYS},
    },
    hit::{Chain, Hit},
    lanes::ROW,
    query::{DescendMany, Place, Query},
    stage::GroupData,
};
use straal_math::Ray;

/// A group of more shapes than this has them in its tree.
pub(super) const FEW: usize = 16;

/// Parts the shapes that stand beside the tree from those that go into it.
pub(super) fn part(members: Vec<Member>) -> (Blocks, Vec<Member>) {
    let are_few = members.len() <= FEW;
    let (few, many): (Vec<Member>, Vec<Member>) =
        members.into_iter().partition(|m| are_few || !m.bounds.is_finite());
    (Blocks::of(&few), many)
}

impl Bvh {
    /// The first hits of rays in the world among the few shapes, or any where `ANY`.
    #[inline(always)]
    pub(super) fn few_many<K: DescendMany, const ANY: bool>(
        &self,
        q: &Query<'_, K, false>,
        group: &GroupData,
        rays: &[Ray],
        out: &mut (impl Answers + ?Sized),
    ) {
        let mut found = Octets::EMPTY;
        for (n, rays) in rays.chunks(RAYS).enumerate() {
            q.kernel.octets::<ANY>(&self.few, rays, &mut found);
            for i in 0..rays.len() {
                let (firsts, lane) = (&found.firsts[i / ROW % (RAYS / ROW)], i % ROW);
                let hit = match firsts.object(lane) {
                    Some(object) if !ANY => {
                        let (geometry, primitive) = group.shape(object);
                        let [t, u, v] = [firsts.t[lane], firsts.u[lane], firsts.v[lane]].map(|x| x as f32);
                        Hit { t, u, v, geometry, primitive, chain: Chain::EMPTY }
                    }
                    Some(_) => Hit { geometry: 0, ..Hit::MISS },
                    None => Hit::MISS,
                };
                out.set(n * RAYS + i, hit);
            }
        }
    }

    /// One ray among the few shapes.
    #[inline(always)]
    pub(super) fn few_closest<K: DescendMany, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        for block in self.few.iter() {
            q.shapes_closest(at, block, best);
        }
    }

    /// Whether one ray hits any of the few shapes.
    #[inline(always)]
    pub(super) fn few_occluded<K: DescendMany, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
    ) -> bool {
        self.few.iter().any(|block| q.shapes_occluded(at, block))
    }
}
