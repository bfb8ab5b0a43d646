//! Every primitive against every ray: slow, and plainly right. What all other structures are held against.

use crate::{
    hit::Hit,
    prim::{Prim, PrimKind},
    query::{Built, Descend, Place, Query, Search, Stats},
};

/// A group's bounded primitives, in no order.
pub(crate) struct Brute {
    prims: Vec<PrimKind>,
}

impl Brute {
    pub fn build(prims: &[Prim]) -> Self {
        Self { prims: prims.iter().map(|p| p.kind).collect() }
    }
}

impl Search for Brute {
    #[inline(always)]
    fn closest<K: Descend, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        for &prim in &self.prims {
            q.prim_closest(at, prim, best);
        }
    }

    #[inline(always)]
    fn occluded<K: Descend, const COUNT: bool>(&self, q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool {
        self.prims.iter().any(|&prim| q.prim_occluded(at, prim))
    }
}

impl Built for Brute {
    fn stats(&self) -> Stats {
        Stats {
            leaves: 1,
            references: self.prims.len(),
            sah_cost: self.prims.len() as f64,
            ..Stats::default()
        }
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.prims.as_slice())
    }
}
