//! What a report says of a tree.

use super::Bvh;
use crate::{
    node::{Child, ChildKind, WIDTH},
    partition::{self, half_area},
    query::Stats,
};
use straal_math::Bounds;

impl Bvh {
    pub(super) fn tree_stats(&self) -> Stats {
        let mut out = Stats::default();
        // Every ray tests what stands beside the tree.
        out.leaves = self.few.len();
        out.references = self.few.iter().map(|block| block.head.count as usize).sum();
        out.sah_cost = out.references as f64;
        let Some(root) = self.root else { return out };
        let whole = match root.kind() {
            ChildKind::Node(i) => {
                let node = self.lines.node(i as usize);
                half_area(&(0..WIDTH).fold(Bounds::EMPTY, |b, lane| b.union(node.bounds(lane))))
            }
            _ => 1.0,
        };
        // A child, how likely a line through the root's box meets its box, and its depth.
        let mut stack: Vec<(Child, f64, u32)> = vec![(root, 1.0, 0)];
        while let Some((child, chance, depth)) = stack.pop() {
            out.depth = out.depth.max(depth);
            match child.kind() {
                ChildKind::Done => {}
                ChildKind::Object(_) => {
                    out.leaves += 1;
                    out.references += 1;
                    out.sah_cost += chance;
                }
                ChildKind::Shapes(i) => {
                    let n = self.shapes.get(i as usize).head.count as usize;
                    out.leaves += 1;
                    out.references += n;
                    out.sah_cost += chance * n as f64;
                }
                ChildKind::Block(i) => {
                    let n = self.block_ids(i).count();
                    out.leaves += 1;
                    out.references += n;
                    out.sah_cost += chance * n as f64;
                }
                ChildKind::Node(i) => {
                    out.nodes += 1;
                    out.sah_cost += chance;
                    let node = self.lines.node(i as usize);
                    for lane in 0..WIDTH {
                        let b = node.bounds(lane);
                        if !b.is_empty() {
                            let chance = partition::chance(half_area(&b), whole);
                            stack.push((node.children[lane], chance, depth + 1));
                        }
                    }
                }
            }
        }
        out
    }
}
