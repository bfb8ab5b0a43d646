//! Every primitive against every ray: slow, and plainly right. What all other structures are held against.

use std::ops::Range;

use crate::{
    hit::Hit,
    prim::PrimKind,
    query::{Built, Descend, Place, Query, Search, Stats},
};

/// A group's bounded primitives, in no order.
#[derive(Default)]
pub(crate) struct Brute {
    /// Runs of triangles by their numbers: one of each mesh, as long as none of its triangles is dropped.
    triangles: Vec<Range<u32>>,
    objects: Vec<u32>,
}

impl Brute {
    /// One more.
    pub fn add(&mut self, prim: PrimKind) {
        match (prim, self.triangles.last_mut()) {
            (PrimKind::Triangle(id), Some(run)) if run.end == id => run.end += 1,
            (PrimKind::Triangle(id), _) => self.triangles.push(id..id + 1),
            (PrimKind::Object(id), _) => self.objects.push(id),
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.triangles.iter().map(ExactSizeIterator::len).sum::<usize>() + self.objects.len()
    }

    #[inline(always)]
    fn prims(&self) -> impl Iterator<Item = PrimKind> + '_ {
        let triangles = self.triangles.iter().flat_map(|run| run.clone().map(PrimKind::Triangle));
        triangles.chain(self.objects.iter().map(|id| PrimKind::Object(*id)))
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
        for prim in self.prims() {
            q.prim_closest(at, prim, best);
        }
    }

    #[inline(always)]
    fn occluded<K: Descend, const COUNT: bool>(&self, q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool {
        self.prims().any(|prim| q.prim_occluded(at, prim))
    }
}

impl Built for Brute {
    fn stats(&self) -> Stats {
        Stats { leaves: 1, references: self.len(), sah_cost: self.len() as f64, ..Stats::default() }
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice()) + size_of_val(self.objects.as_slice())
    }
}
