//! Every primitive against every ray: slow, and plainly right. What all other structures are held against.

use crate::{
    hit::Hit,
    input::Shapes,
    kernel::Kernel,
    query::Query,
    structure::{Place, Prim, PrimKind, Search},
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
    fn closest<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        for &prim in &self.prims {
            match prim {
                PrimKind::Triangle(id) => {
                    q.count_block(1);
                    q.triangle_closest(at, id, &q.scene.vertices(at.group, id), best);
                }
                PrimKind::Object(i) => q.object_closest(at, i, best),
            }
        }
    }

    fn occluded<K: Kernel, S: Shapes, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, S, COUNT>,
        at: &Place<'_>,
    ) -> bool {
        self.prims.iter().any(|&prim| match prim {
            PrimKind::Triangle(id) => {
                q.count_block(1);
                q.triangle_occluded(at, id, &q.scene.vertices(at.group, id))
            }
            PrimKind::Object(i) => q.object_occluded(at, i),
        })
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.prims.as_slice())
    }
}
