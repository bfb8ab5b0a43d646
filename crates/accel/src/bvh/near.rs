//! The nearest hit of a search under way, as little of it as triangles need.

use crate::{hit::Hit, slab::loosened, structure::Place};

/// The nearest triangle so far, which may come before a hit that was found elsewhere.
///
/// Copying a whole [`Hit`] with its chain for every candidate would show; most searches find nothing but triangles.
#[derive(Clone, Copy)]
pub(super) struct Near {
    /// Nothing beyond this counts.
    pub t: f32,
    u: f32,
    v: f32,
    /// The triangle's number in the group; `NONE` while the hit is elsewhere's.
    id: u32,
    /// What is entered beyond this is left out: `t`, and as much as an entry may be late (see [`loosened`]).
    pub limit: f32,
}

const NONE: u32 = u32::MAX;

impl Near {
    #[inline(always)]
    pub fn new(best: &Hit) -> Self {
        Self { t: best.t, u: 0.0, v: 0.0, id: NONE, limit: loosened(best.t) }
    }

    /// Keys of entries up to this are visited.
    #[inline(always)]
    pub fn key(&self) -> u32 {
        crate::kernel::key_of_limit(self.limit)
    }

    /// Takes a triangle's hit at `t` if it comes before what there is; tells whether it does.
    #[inline(always)]
    pub fn offer(&mut self, at: &Place<'_>, id: u32, tuv: [f32; 3], elsewhere: &Hit) -> bool {
        let [t, u, v] = tuv;
        if t > self.t {
            return false;
        }
        if t == self.t {
            let earlier = match self.id {
                NONE => elsewhere.comes_after(at.chain, at.group.locate(id)),
                other => id < other,
            };
            if !earlier {
                return false;
            }
        }
        *self = Self { t, u, v, id, limit: loosened(t) };
        true
    }

    /// The hit of a search in the world that is over.
    #[inline(always)]
    pub fn hit(&self, at: &Place<'_>, elsewhere: &Hit) -> Hit {
        if self.id == NONE {
            return elsewhere.finished();
        }
        let (geometry, primitive) = at.group.locate(self.id);
        Hit { t: self.t, u: self.u, v: self.v, geometry, primitive, chain: *at.chain }
    }

    /// Writes a triangle's hit where hits from elsewhere are kept.
    #[inline(always)]
    pub fn settle(&mut self, at: &Place<'_>, elsewhere: &mut Hit) {
        if self.id != NONE {
            *elsewhere = self.hit(at, elsewhere);
            self.id = NONE;
        }
    }
}
