//! Whether a tree is what searches rely on.

use super::{Bvh2, MAX_DEPTH};
use crate::prim::Prim;
use std::collections::BTreeMap;

impl Bvh2 {
    /// Every primitive in exactly one leaf and inside every box above it, no deeper than the stack allows.
    pub fn validate(&self, prims: &[Prim]) -> Result<(), String> {
        let mut expected: BTreeMap<u32, &Prim> =
            prims.iter().map(|p| (p.kind.packed().number(), p)).collect();
        let mut stack: Vec<(u32, usize)> = self.nodes.first().map(|_| (0, 0)).into_iter().collect();
        while let Some((i, depth)) = stack.pop() {
            if depth >= MAX_DEPTH {
                return Err(format!("depth {depth} is more than the stack can hold"));
            }
            let node = &self.nodes[i as usize];
            if node.count == 0 {
                for child in [node.first, node.first + 1] {
                    if node.bounds.union(self.nodes[child as usize].bounds) != node.bounds {
                        return Err(format!("node {child} sticks out of node {i}"));
                    }
                    stack.push((child, depth + 1));
                }
                continue;
            }
            for prim in self.leaf(node) {
                match expected.remove(&prim.number()) {
                    None => return Err(format!("{:?} is in two leaves, or unknown", prim.kind())),
                    Some(p) if node.bounds.union(p.bounds) != node.bounds => {
                        return Err(format!("{:?} sticks out of node {i}", prim.kind()));
                    }
                    Some(_) => {}
                }
            }
        }
        match expected.len() {
            0 => Ok(()),
            n => Err(format!("{n} primitives are in no leaf")),
        }
    }
}
