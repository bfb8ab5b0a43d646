//! The wide tree's nodes, from binary trees of which `collapse.rs` chose what is opened.
//!
//! The upper nodes come first, then what is made of each task, a node before what is below it and the left half before the
//! right: what lies close together in space does so in this order, which `layout.rs` keeps.

use super::{
    Bvh,
    collapse::{Twig, What, parts},
    layout::{self, MOST_LINES, lay_out},
    slots,
    span::{Box4, Span},
};
use crate::{
    analytic::block::Blocks,
    node::{Block, Child, Node, Outline, WIDTH},
};
use rayon::prelude::*;

/// The binary tree of a range, and the triangles of its leaves; references are within it.
#[derive(Default)]
pub(super) struct Binary {
    pub twigs: Vec<Twig>,
    pub blocks: Vec<Block>,
    /// Blocks of shapes.
    pub shapes: Blocks,
    /// In place of blocks, in a compact tree.
    pub outlines: Vec<Outline>,
    /// Ranges that are to have trees of their own.
    pub tasks: Vec<Span>,
}

/// The wide tree of the upper binary one and those that hang below it; `None` if it is larger than a child can tell.
pub(super) fn join(upper: &[Twig], trees: &[Binary]) -> Option<Bvh> {
    let mut top = Top { upper, trees, nodes: Vec::new(), hanging: Vec::new() };
    let mut root = top.child(Site { task: None, twig: 0 }, None);
    let Top { nodes, hanging, .. } = top;
    let below: Vec<(Child, Vec<Node>)> = hanging
        .par_iter()
        .map(|h| {
            let mut nodes = Vec::new();
            (trees[h.task].wide(h.twig, &mut nodes), nodes)
        })
        .collect();
    let first_leaf: Vec<usize> =
        trees.iter().scan(0, |sum, t| Some(std::mem::replace(sum, *sum + t.leaves()))).collect();
    let first_shapes: Vec<usize> =
        trees.iter().scan(0, |sum, t| Some(std::mem::replace(sum, *sum + t.shapes.len()))).collect();
    let mut shapes = Blocks::EMPTY;
    trees.iter().for_each(|t| shapes.append(&t.shapes));
    let mut count = nodes.len();
    let mut parts = vec![nodes];
    for (h, (child, mut part)) in hanging.iter().zip(below) {
        let moved =
            |child: Child| child.moved(count as u32, first_leaf[h.task] as u32, first_shapes[h.task] as u32);
        part.iter_mut().for_each(|node| node.children = node.children.map(moved));
        let child = moved(child);
        match h.parent {
            Some((node, slot)) => parts[0][node].children[slot] = child,
            None => root = child,
        }
        count += part.len();
        parts.push(part);
    }
    let blocks =
        layout::Blocks { parts: trees.iter().map(|t| t.blocks.as_slice()).collect(), first: first_leaf };
    let (root, lines) = lay_out(root, &parts, &blocks, MOST_LINES)?;
    let mut outlines = Vec::with_capacity(trees.iter().map(|t| t.outlines.len()).sum());
    trees.iter().for_each(|t| outlines.extend_from_slice(&t.outlines));
    Some(Bvh { root: Some(root), lines, outlines, shapes, ..Bvh::EMPTY })
}

/// The wide tree's upper nodes under way.
struct Top<'a> {
    upper: &'a [Twig],
    trees: &'a [Binary],
    nodes: Vec<Node>,
    hanging: Vec<Hanging>,
}

/// A node of the upper tree, or of a task's.
#[derive(Clone, Copy)]
struct Site {
    task: Option<usize>,
    twig: u32,
}

/// A node of a task's tree, and where what is made of it hangs: the node and the slot, or none for the root.
struct Hanging {
    task: usize,
    twig: u32,
    parent: Option<(usize, usize)>,
}

impl Top<'_> {
    /// What a site becomes. Where it hangs is for those that are to be filled in.
    fn child(&mut self, site: Site, parent: Option<(usize, usize)>) -> Child {
        let Self { upper, trees, .. } = *self;
        let task = match site.task {
            Some(task) => Some((task, site.twig)),
            None => upper[site.twig as usize].what.task().map(|task| (task, 0)),
        };
        if let Some((task, twig)) = task {
            self.hanging.push(Hanging { task, twig, parent });
            return Child::DONE;
        }
        let none = Site { task: None, twig: 0 };
        let mut opened = Opened::new(none);
        parts(upper, site.twig, WIDTH, &mut |twig, k| match upper[twig as usize].what {
            What::Task(i) => {
                let (task, twigs) = (Some(i as usize), &trees[i as usize].twigs);
                parts(twigs, 0, k, &mut |twig, _| opened.push(Site { task, twig }, &twigs[twig as usize]));
            }
            _ => opened.push(Site { task: None, twig }, &upper[twig as usize]),
        });
        let (node, slots) = opened.push_node(&upper[site.twig as usize], &mut self.nodes);
        for (&site, slot) in opened.parts().iter().zip(slots) {
            self.nodes[node].children[slot] = self.child(site, Some((node, slot)));
        }
        Child::node(node as u32)
    }
}

impl Binary {
    /// Blocks of its own.
    pub fn leaves(&self) -> usize {
        self.blocks.len() + self.outlines.len()
    }

    /// Makes nodes of what is below a twig.
    fn wide(&self, twig: u32, nodes: &mut Vec<Node>) -> Child {
        let twigs = self.twigs.as_slice();
        if let What::Leaf(leaf) = twigs[twig as usize].what {
            return leaf;
        }
        let mut opened = Opened::new(0);
        parts(twigs, twig, WIDTH, &mut |part, _| opened.push(part, &twigs[part as usize]));
        let (node, slots) = opened.push_node(&twigs[twig as usize], nodes);
        for (&part, slot) in opened.parts().iter().zip(slots) {
            nodes[node].children[slot] = self.wide(part, nodes);
        }
        Child::node(node as u32)
    }
}

/// What a node is opened into.
struct Opened<T> {
    parts: [T; WIDTH],
    bounds: [Box4; WIDTH],
    count: usize,
}

impl<T: Copy> Opened<T> {
    const fn new(none: T) -> Self {
        Self { parts: [none; WIDTH], bounds: [Box4::EMPTY; WIDTH], count: 0 }
    }

    fn push(&mut self, part: T, twig: &Twig) {
        self.parts[self.count] = part;
        self.bounds[self.count] = twig.bounds();
        self.count += 1;
    }

    fn parts(&self) -> &[T] {
        &self.parts[..self.count]
    }

    /// A node with the boxes of the parts; its number, and the slot of each part.
    fn push_node(&self, whole: &Twig, nodes: &mut Vec<Node>) -> (usize, [usize; WIDTH]) {
        let (whole, bounds) = (whole.bounds(), &self.bounds[..self.count]);
        let mut offsets = [[0.0; 3]; WIDTH];
        for (offset, b) in offsets.iter_mut().zip(bounds) {
            let twice_center = |b: &Box4, axis: usize| b.lo[axis] + b.hi[axis];
            *offset = std::array::from_fn(|axis| twice_center(b, axis) - twice_center(&whole, axis));
        }
        let slots = slots::assign(&offsets[..self.count]);
        let mut node = Node::EMPTY;
        for (b, slot) in bounds.iter().zip(slots) {
            for axis in 0..3 {
                node.planes[2 * axis][slot] = b.lo[axis];
                node.planes[2 * axis + 1][slot] = b.hi[axis];
            }
        }
        nodes.push(node);
        (nodes.len() - 1, slots)
    }
}
