//! Where nodes and blocks lie in memory: nodes that have nothing but nodes below them first, then each of the others with its
//! blocks behind it.
//!
//! The first ones are few, and what most rays visit is close together. Of the others, a ray that visits one visits its blocks
//! next. On Zen 4, slices are searched 2 to 4 % faster than with nodes and blocks in two arrays.

use crate::{
    kernel::lines::{BLOCK, Lines, NODE},
    node::{Block, Child, ChildKind, Node, WIDTH},
};

/// A child has room for the numbers of so many lines: 64 GiB.
pub(super) const MOST_LINES: usize = Child::OBJECT as usize;

/// Blocks by their numbers in the whole tree.
pub(super) struct Blocks<'a> {
    /// By subtree.
    pub parts: Vec<&'a [Block]>,
    /// The number of each subtree's first block.
    pub first: Vec<usize>,
}

impl Blocks<'_> {
    /// The block of a number.
    fn get(&self, i: u32) -> &Block {
        let part = self.first.partition_point(|&first| first <= i as usize) - 1;
        &self.parts[part][i as usize - self.first[part]]
    }

    /// Whether there is none, since the tree is compact or has objects alone.
    fn is_empty(&self) -> bool {
        self.parts.iter().all(|part| part.is_empty())
    }
}

impl Node {
    /// How many of its children are blocks.
    fn blocks(&self) -> usize {
        let is_used = |slot: &usize| self.planes[0][*slot] < f32::INFINITY;
        (0..WIDTH).filter(is_used).filter(|&slot| self.children[slot].is_block()).count()
    }
}

/// Lays out nodes, which are numbered through all parts, and blocks; children become numbers of lines. Blocks of a compact
/// tree keep their numbers. `None` if it takes more than `most` lines.
pub(super) fn lay_out(
    root: Child,
    parts: &[Vec<Node>],
    blocks: &Blocks<'_>,
    most: usize,
) -> Option<(Child, Lines)> {
    let nodes = || parts.iter().flatten();
    let is_compact = blocks.is_empty();
    // At most eight each.
    let own: Vec<u8> = nodes().map(|node| if is_compact { 0 } else { node.blocks() as u8 }).collect();
    let mut places = vec![0_u32; own.len()];
    let mut len = if root.is_block() && !is_compact { BLOCK } else { 0 };
    for has_own in [false, true] {
        for (&own, place) in own.iter().zip(&mut places).filter(|(own, _)| (**own > 0) == has_own) {
            // Beyond 32 bits, it isn't used.
            *place = len as u32;
            len += NODE + BLOCK * usize::from(own);
        }
    }
    if len > most {
        return None;
    }
    let mut lines = Lines::with_capacity(len);
    // What a child becomes, once a block is written that isn't there yet: `next` says where it will be.
    let placed = |child: Child, next: &mut usize| match child.kind() {
        ChildKind::Node(i) => (Child::node(places[i as usize]), None),
        ChildKind::Block(i) if !is_compact => {
            let line = *next as u32;
            *next += BLOCK;
            (Child::block(line), Some(blocks.get(i)))
        }
        _ => (child, None),
    };
    let (root, only) = placed(root, &mut 0);
    only.into_iter().for_each(|block| lines.push_block(block));
    for has_own in [false, true] {
        for (node, _) in nodes().zip(&own).filter(|(_, own)| (**own > 0) == has_own) {
            let mut out = *node;
            let mut behind = [None; WIDTH];
            let mut next = lines.len() + NODE;
            let slots = out.children.iter_mut().zip(&mut behind).zip(&node.planes[0]);
            for ((child, block), &least) in slots {
                (*child, *block) = match least < f32::INFINITY {
                    true => placed(*child, &mut next),
                    false => (Child::node(0), None),
                };
            }
            lines.push_node(&out);
            behind.into_iter().flatten().for_each(|block| lines.push_block(block));
        }
    }
    Some((root, lines))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Outline;
    use straal_math::Vec3;

    /// A node whose children all have boxes.
    fn node(children: &[Child]) -> Node {
        let mut out = Node::EMPTY;
        for (slot, &child) in children.iter().enumerate() {
            out.children[slot] = child;
            out.planes.iter_mut().for_each(|plane| plane[slot] = slot as f32);
        }
        out
    }

    /// A block of the one triangle of a number.
    fn block(id: u32) -> Block {
        let corners = |_| [0, 1, 2].map(|i| Vec3::splat(i as f32));
        Outline::of(id..id + 1, corners).expect("three vertices").1
    }

    /// The root has a node above blocks, a node above nodes, and an object; blocks 0, 1 are of one subtree, 2, 3 of the
    /// other.
    fn small() -> [Vec<Node>; 2] {
        let root = node(&[Child::node(1), Child::object(7), Child::node(2)]);
        let leaf = node(&[Child::block(1), Child::object(3), Child::block(0)]);
        let upper = node(&[Child::node(3)]);
        let last = node(&[Child::block(3), Child::block(2)]);
        [vec![root, leaf], vec![upper, last]]
    }

    #[test]
    fn blocks_lie_behind_their_node_and_nodes_of_nodes_first() {
        let of: Vec<Block> = (0..4).map(block).collect();
        let blocks = Blocks { parts: vec![&of[..2], &of[2..]], first: vec![0, 2] };
        let (root, lines) = lay_out(Child::node(0), &small(), &blocks, 28).expect("28 lines");
        assert_eq!((root, lines.len()), (Child::node(0), 28));
        assert_eq!(lines.node(0).children[..3], [Child::node(8), Child::object(7), Child::node(4)]);
        assert_eq!(lines.node(4).children[..1], [Child::node(18)]);
        assert_eq!(lines.node(8).children[..3], [Child::block(12), Child::object(3), Child::block(15)]);
        assert_eq!(lines.node(18).children[..2], [Child::block(22), Child::block(25)]);
        assert_eq!([12, 15, 22, 25].map(|line| lines.block(line).id(0)), [1, 0, 3, 2]);
        assert_eq!(lines.node(4).planes[0][..2], [0.0, f32::INFINITY]);
        assert!(lay_out(Child::node(0), &small(), &blocks, 27).is_none());
    }

    #[test]
    fn blocks_of_a_compact_tree_keep_their_numbers() {
        let blocks = Blocks { parts: vec![&[], &[]], first: vec![0, 2] };
        let (_, lines) = lay_out(Child::node(0), &small(), &blocks, MOST_LINES).expect("16 lines");
        assert_eq!(lines.len(), 16);
        assert_eq!(lines.node(4).children[..3], [Child::block(1), Child::object(3), Child::block(0)]);
        assert_eq!(lines.node(8).children[..1], [Child::node(12)]);
    }

    #[test]
    fn a_root_may_be_a_block() {
        let of = [block(5)];
        let blocks = Blocks { parts: vec![&of], first: vec![0] };
        let (root, lines) = lay_out(Child::block(0), &[], &blocks, MOST_LINES).expect("three lines");
        assert_eq!((root, lines.len(), lines.block(0).id(0)), (Child::block(0), BLOCK, 5));
    }
}
