//! Whether a tree is what searches rely on.

use super::{Bvh, params::Build, spatial_split};
use crate::{
    clip,
    node::{Child, ChildKind, STACK, WIDTH},
    prim::{Prim, PrimKind},
};
use std::collections::BTreeMap;
use straal_math::{Bounds, Vec3};

impl Bvh {
    /// Every primitive in one leaf, whose box and all above it contain the primitive's; or, if it is a triangle, its parts
    /// in several, whose boxes together contain it. No deeper than the stack allows.
    pub fn validate(&self, prims: &[Prim], vertices: impl Fn(u32) -> [Vec3; 3]) -> Result<(), String> {
        let mut leaves: BTreeMap<(bool, u32), Vec<Bounds>> =
            prims.iter().map(|p| (key(p.kind), Vec::new())).collect();
        let mut references = 0;
        let everything = Bounds { min: Vec3::splat(f32::NEG_INFINITY), max: Vec3::splat(f32::INFINITY) };
        let mut stack: Vec<(Child, Bounds, usize)> =
            self.root.iter().map(|&root| (root, everything, 0)).collect();
        while let Some((child, outer, depth)) = stack.pop() {
            if depth * (WIDTH - 1) + 1 > STACK {
                return Err(format!("depth {depth} is more than the stack can hold"));
            }
            let mut take = |kind: PrimKind| {
                references += 1;
                let boxes = leaves.get_mut(&key(kind)).ok_or_else(|| format!("{kind:?} is unknown"))?;
                boxes.push(outer);
                Ok::<(), String>(())
            };
            match child.kind() {
                ChildKind::Done => return Err("a child that ends a search".into()),
                ChildKind::Object(i) => take(PrimKind::Object(i))?,
                ChildKind::Shapes(i) => {
                    let head = self.shapes.get(i as usize).head;
                    for &object in &head.objects[..head.count as usize] {
                        take(PrimKind::Object(object))?;
                    }
                }
                ChildKind::Block(i) => {
                    for id in self.block_ids(i) {
                        take(PrimKind::Triangle(id))?;
                    }
                }
                ChildKind::Node(i) => {
                    let node = self.lines.node(i as usize);
                    for lane in 0..WIDTH {
                        let b = node.bounds(lane);
                        if b.is_empty() {
                            continue;
                        }
                        if outer.union(b) != outer {
                            return Err(format!("child {lane} of node {i} sticks out"));
                        }
                        stack.push((node.children[lane], b, depth + 1));
                    }
                }
            }
        }
        for block in self.few.iter() {
            for &object in &block.head.objects[..block.head.count as usize] {
                // The unbounded ones aren't among the primitives.
                if let Some(boxes) = leaves.get_mut(&(true, object)) {
                    boxes.push(everything);
                    references += 1;
                }
            }
        }
        let most = prims.len() + spatial_split::room(Build::Best, prims.len());
        if references > most {
            return Err(format!("{references} references are more than {most}"));
        }
        for p in prims {
            let sound = match (leaves[&key(p.kind)].as_slice(), p.kind) {
                ([], _) => Err("is in no leaf"),
                ([only], _) if only.union(p.bounds) == *only => Ok(()),
                ([_], _) => Err("sticks out of its leaf"),
                (parts, PrimKind::Triangle(id)) if clip::is_covered(&vertices(id), parts) => Ok(()),
                (_, PrimKind::Triangle(_)) => Err("sticks out of its leaves"),
                (_, PrimKind::Object(_)) => Err("is in several leaves"),
            };
            sound.map_err(|e| format!("{:?} {e}", p.kind))?;
        }
        Ok(())
    }
}

fn key(kind: PrimKind) -> (bool, u32) {
    match kind {
        PrimKind::Triangle(i) => (false, i),
        PrimKind::Object(i) => (true, i),
    }
}
