//! Building a BSP tree from the top down.

use super::{
    BspChoice, BspParams, BspTree, Node,
    cell::Cell,
    choose::{Chooser, Cut},
    plane::{Side, Vertices},
};
use crate::{
    clip::Limits,
    partition::{self, Budget, depth_limit},
    prim::{Packed, Prim},
};
use straal_math::Bounds;

pub(super) fn build(prims: &[Prim], params: &BspParams, vertices: &Vertices<'_>) -> BspTree {
    let bounds = prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds));
    let max_depth = depth_limit(params.max_depth, prims.len());
    let chooser = Chooser { prims, vertices, params: *params };
    let mut builder = Builder { chooser, max_depth, nodes: Vec::new(), references: Vec::new() };
    let space = match params.choice {
        BspChoice::Even => None,
        BspChoice::Sah => Some(Cell::of_box(&partition::finite(&bounds))),
    };
    let all = Part { prims: (0..prims.len() as u32).collect(), space, depth: 0 };
    builder.subtree(all, Budget::of(prims.len()));
    builder.nodes.shrink_to_fit();
    builder.references.shrink_to_fit();
    let limits = Limits::of(prims, vertices);
    BspTree { bounds, nodes: builder.nodes, references: builder.references, limits, params: *params }
}

/// A part of space that is still to be built.
struct Part {
    prims: Vec<u32>,
    /// Its shape, if areas are asked for.
    space: Option<Cell>,
    depth: u32,
}

struct Builder<'a> {
    chooser: Chooser<'a>,
    max_depth: u32,
    nodes: Vec<Node>,
    references: Vec<Packed>,
}

impl Builder<'_> {
    /// Builds a part of space, at most `MAX_DEPTH` deep.
    fn subtree(&mut self, part: Part, budget: Budget) {
        let chosen = self.choose(&part).and_then(|cut| Some((budget.share(cut.counts)?, cut)));
        let Some((shares, cut)) = chosen else {
            let first = self.references.len() as u32;
            self.references.extend(part.prims.iter().map(|&i| self.chooser.prims[i as usize].kind.packed()));
            self.nodes.push(Node::Leaf { first, count: part.prims.len() as u32 });
            return;
        };
        let [front, back] = self.divide(&part, &cut);
        drop(part);
        let node = self.nodes.len();
        self.nodes.push(Node::Inner { plane: cut.plane, back: 0 });
        self.subtree(front, shares[0]);
        self.nodes[node] = Node::Inner { plane: cut.plane, back: self.nodes.len() as u32 };
        self.subtree(back, shares[1]);
    }

    fn choose(&self, part: &Part) -> Option<Cut> {
        let Chooser { params, .. } = &self.chooser;
        if part.depth >= self.max_depth || part.prims.len() <= params.leaf_size as usize {
            return None;
        }
        match &part.space {
            None => self.chooser.most_even(&part.prims),
            Some(space) => self.chooser.cheapest(&part.prims, space),
        }
    }

    fn divide(&self, part: &Part, cut: &Cut) -> [Part; 2] {
        let spaces = part.space.as_ref().map(|space| space.cut(&cut.plane));
        let [front, back] = match spaces {
            Some(spaces) => spaces.map(Some),
            None => [None, None],
        };
        let mut spaces = [front, back].into_iter();
        let mut parts = cut.counts.map(|n| Part {
            prims: Vec::with_capacity(n),
            space: spaces.next().flatten(),
            depth: part.depth + 1,
        });
        for &prim in &part.prims {
            let side = self.chooser.side(&cut.plane, prim);
            if side != Side::Back {
                parts[0].prims.push(prim);
            }
            if side != Side::Front {
                parts[1].prims.push(prim);
            }
        }
        parts
    }
}
