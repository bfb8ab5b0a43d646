//! The nearest hit of a search under way, as little of it as triangles need.

use crate::{hit::Hit, kernel::Candidate, query::Place, slab::loosened};

/// The nearest triangle so far, which may come before a hit that was found elsewhere.
///
/// Copying a whole [`Hit`] with its chain for every candidate would show; most searches find nothing but triangles.
#[derive(Clone, Copy)]
pub(super) struct Near {
    /// Nothing beyond this counts.
    pub t: f32,
    /// u and v, times `det`: they are divided when the search is over, since most hits don't stay the nearest.
    uv: [f32; 2],
    det: f32,
    /// The triangle's number in the group, or one of the two below.
    id: u32,
    /// What is entered beyond this is left out: `t`, [`loosened`].
    pub limit: f32,
}

/// Nothing was found.
const NONE: u32 = u32::MAX;

/// The nearest hit isn't a triangle of this tree.
const ELSEWHERE: u32 = u32::MAX - 1;

impl Near {
    /// Nothing found up to `t`.
    #[inline(always)]
    pub fn nothing(t: f32) -> Self {
        Self { t, uv: [0.0; 2], det: 1.0, id: NONE, limit: loosened(t) }
    }

    /// What was found elsewhere, if it is a hit.
    #[inline(always)]
    pub fn new(best: &Hit) -> Self {
        Self { id: if best.is_hit() { ELSEWHERE } else { NONE }, ..Self::nothing(best.t) }
    }

    /// For searches that want any hit: there is one.
    #[inline(always)]
    pub fn set_found(&mut self, elsewhere: &mut Hit) {
        elsewhere.geometry = 0;
        self.id = ELSEWHERE;
    }

    #[inline(always)]
    pub fn is_found(&self) -> bool {
        self.id != NONE
    }

    /// Keys of entries up to this are visited.
    #[inline(always)]
    pub fn key(&self) -> u32 {
        crate::kernel::key_of_limit(self.limit)
    }

    /// Takes a triangle's hit at `t` if it comes before what there is; tells whether it does.
    #[inline(always)]
    pub fn offer(&mut self, at: &Place<'_>, id: u32, c: Candidate, elsewhere: &Hit) -> bool {
        let Candidate { t, uv, det } = c;
        if t > self.t {
            return false;
        }
        if t == self.t {
            let earlier = match self.id {
                NONE => true,
                ELSEWHERE => elsewhere.comes_after(at.chain, at.group.locate(id)),
                other => id < other,
            };
            if !earlier {
                return false;
            }
        }
        *self = Self { t, uv, det, id, limit: loosened(t) };
        true
    }

    /// The hit of a search in the world that is over.
    #[inline(always)]
    pub fn hit(&self, at: &Place<'_>, elsewhere: &Hit) -> Hit {
        match self.id {
            NONE => Hit::MISS,
            ELSEWHERE => elsewhere.finished(),
            id => {
                let (geometry, primitive) = at.group.locate(id);
                let [u, v] = self.uv.map(|x| x / self.det);
                Hit { t: self.t, u, v, geometry, primitive, chain: *at.chain }
            }
        }
    }

    /// Writes what is known where hits from elsewhere are kept.
    #[inline(always)]
    pub fn settle(&mut self, at: &Place<'_>, elsewhere: &mut Hit) {
        match self.id {
            NONE => *elsewhere = Hit::limit(self.t),
            ELSEWHERE => {}
            _ => {
                *elsewhere = self.hit(at, elsewhere);
                self.id = ELSEWHERE;
            }
        }
    }
}
