//! Which primitives a ray has tested already, where one may lie in many cells.

use crate::{
    hit::Hit,
    prim::Packed,
    query::{Descend, Place, Query},
};

/// The primitives that a ray tested last, a place for each remainder of their numbers. It belongs to the search, not
/// to the primitives, so that rays on any number of threads share nothing.
pub(crate) struct Mailboxes {
    last: [Packed; Self::PLACES],
    on: bool,
}

impl Mailboxes {
    const PLACES: usize = 32;

    #[inline(always)]
    pub const fn new(on: bool) -> Self {
        Self { last: [Packed::NONE; Self::PLACES], on }
    }

    /// Whether the primitive is known to have been tested; from this call on it is.
    #[inline(always)]
    fn was_tested(&mut self, prim: Packed) -> bool {
        if !self.on {
            return false;
        }
        let place = &mut self.last[prim.number() as usize % Self::PLACES];
        let known = *place == prim;
        *place = prim;
        known
    }

    /// Tests the primitives of a cell that weren't tested yet.
    #[inline(always)]
    pub fn closest<K: Descend, const COUNT: bool>(
        &mut self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        cell: &[Packed],
        best: &mut Hit,
    ) {
        for &prim in cell {
            if self.was_tested(prim) {
                q.count_duplicate();
            } else {
                q.prim_closest(at, prim.kind(), best);
            }
        }
    }

    /// Whether a primitive of a cell that wasn't tested yet is hit.
    #[inline(always)]
    pub fn occluded<K: Descend, const COUNT: bool>(
        &mut self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        cell: &[Packed],
    ) -> bool {
        for &prim in cell {
            if self.was_tested(prim) {
                q.count_duplicate();
            } else if q.prim_occluded(at, prim.kind()) {
                return true;
            }
        }
        false
    }
}
