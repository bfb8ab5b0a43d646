//! Whether volumes are what searches rely on.

use super::{Content, Volume, Volumes};
use crate::prim::{Prim, PrimKind};

impl Volumes {
    /// Every primitive in exactly one object, inside its volume.
    pub fn validate(&self, prims: &[Prim], content: &impl Content) -> Result<(), String> {
        if !self.prims.iter().map(|p| p.kind()).eq(prims.iter().map(|p| p.kind)) {
            return Err("the primitives aren't those of the group".into());
        }
        let mut next = 0;
        for object in &self.objects {
            if object.first as usize != next {
                return Err(format!("primitive {next} is in no object, or in two"));
            }
            next += object.count as usize;
            for prim in &prims[object.first as usize..next] {
                let points: Vec<_> = match prim.kind {
                    PrimKind::Triangle(id) => content.vertices(id).into(),
                    PrimKind::Object(_) => prim.bounds.corners().into(),
                };
                let inside = match &object.volume {
                    Volume::Box(b) => b.union(prim.bounds) == *b,
                    Volume::Sphere(s) => points.iter().all(|p| s.contains(p.as_dvec3())),
                    Volume::Oriented(o) => points.iter().all(|p| o.contains(p.as_dvec3())),
                };
                if !inside {
                    return Err(format!("{:?} sticks out of its volume", prim.kind));
                }
            }
        }
        if next == prims.len() {
            Ok(())
        } else {
            Err(format!("{} primitives in no object", prims.len() - next))
        }
    }
}
