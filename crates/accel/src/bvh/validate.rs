//! Whether a tree is what searches rely on.

use super::{Bvh, Child, ChildKind, WIDTH, build};
use crate::structure::{Prim, PrimKind};
use straal_math::{Bounds, Vec3};

impl Bvh {
    /// Every primitive in exactly one leaf and inside every box above it, no deeper than the stack allows.
    pub fn validate(&self, prims: &[Prim]) -> Result<(), String> {
        let mut expected: std::collections::BTreeMap<(bool, u32), Bounds> = prims
            .iter()
            .map(|p| match p.kind {
                PrimKind::Triangle(i) => ((false, i), p.bounds),
                PrimKind::Object(i) => ((true, i), p.bounds),
            })
            .collect();
        let everything = Bounds { min: Vec3::splat(f32::NEG_INFINITY), max: Vec3::splat(f32::INFINITY) };
        let mut stack: Vec<(Child, Bounds, usize)> =
            self.root.iter().map(|&root| (root, everything, 0)).collect();
        while let Some((child, outer, depth)) = stack.pop() {
            if depth * (WIDTH - 1) + 1 > build::STACK {
                return Err(format!("depth {depth} is more than the stack can hold"));
            }
            let mut take = |key: (bool, u32)| match expected.remove(&key) {
                None => Err(format!("primitive {key:?} is in two leaves, or unknown")),
                Some(b) if outer.union(b) != outer => {
                    Err(format!("primitive {key:?} sticks out of {outer:?}"))
                }
                Some(_) => Ok(()),
            };
            match child.kind() {
                ChildKind::Done => return Err("a child that ends a search".into()),
                ChildKind::Object(i) => take((true, i))?,
                ChildKind::Block(i) => {
                    for id in self.block_ids(i) {
                        take((false, id))?;
                    }
                }
                ChildKind::Node(i) => {
                    let node = &self.nodes[i as usize];
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
        match expected.len() {
            0 => Ok(()),
            n => Err(format!("{n} primitives are in no leaf")),
        }
    }
}
