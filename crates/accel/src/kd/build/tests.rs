//! The build against one that sorts nothing, keeps nothing and counts everything anew.

use super::*;
use crate::kd::sweep;
use crate::{kd::KdParams, query::Built, slab};

/// A small generator (Steele et al. 2014, SplitMix64).
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % n
    }

    /// In [-1, 1).
    fn signed(&mut self) -> f32 {
        self.below(1 << 24) as f32 / (1 << 23) as f32 - 1.0
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// One of few values, so that edges coincide.
    fn grid(&mut self) -> Vec3 {
        let mut c = || self.below(4) as f32 - 2.0;
        Vec3::new(c(), c(), c())
    }
}

/// Boxes of all kinds, many of them flat on some axis, and triangles.
fn scene(r: &mut Random, n: u32) -> (Vec<Prim>, Vec<[Vec3; 3]>) {
    let mut triangles = Vec::new();
    let prims = (0..n).map(|i| {
        let (a, b) = match r.below(4) {
            0 => (r.grid(), r.grid()),
            1 => (r.point(), r.grid()),
            _ => {
                let at = r.point();
                let t = [at, at + r.point() * 0.4, at + r.point() * 0.4];
                triangles.push(t);
                let kind = PrimKind::Triangle(triangles.len() as u32 - 1);
                return Prim { bounds: slab::triangle_bounds(&t), kind };
            }
        };
        Prim { bounds: Bounds { min: a.min(b), max: a.max(b) }, kind: PrimKind::Object(i) }
    });
    let prims = prims.collect();
    (prims, triangles)
}

/// The box of each primitive's part in a cell.
type Parts = Vec<(u32, Bounds)>;

/// Primitives that reach below a plane, lie flat in it, and reach above it, counted one by one.
fn count(parts: &Parts, axis: usize, plane: f32) -> [usize; 3] {
    let count =
        |is: &dyn Fn(f32, f32) -> bool| parts.iter().filter(|(_, b)| is(b.min[axis], b.max[axis])).count();
    [
        count(&|low, _| low < plane),
        count(&|low, high| low == plane && high == plane),
        count(&|_, high| high > plane),
    ]
}

/// Builds, by other means, the same tree.
struct Naive<'a>(Builder<'a>);

/// What is still to be built, and how many cuts on the way down it may make that don't pay.
struct Rest {
    bounds: Bounds,
    parts: Parts,
    depth: u32,
    budget: Budget,
    patience: u32,
}

impl Naive<'_> {
    fn cheapest(&self, rest: &Rest) -> Option<Cut> {
        let mut best: Option<Cut> = None;
        for axis in 0..3 {
            let edges = |(_, b): &(u32, Bounds)| [b.min[axis], b.max[axis]];
            let mut planes: Vec<f32> = rest.parts.iter().flat_map(edges).collect();
            planes.sort_by(f32::total_cmp);
            planes.retain(|&p| p > rest.bounds.min[axis] && p < rest.bounds.max[axis]);
            for plane in planes {
                let counts = count(&rest.parts, axis, plane);
                let cut = sweep::weigh(&self.0.params, &rest.bounds, (axis, plane), counts);
                if best.is_none_or(|b| cut.cost < b.cost) {
                    best = Some(cut);
                }
            }
        }
        best
    }

    fn subtree(&mut self, rest: Rest) {
        let n = rest.parts.len();
        let params = self.0.params;
        let is_over = rest.depth >= self.0.max_depth || n <= params.leaf_size as usize;
        let cut = self.cheapest(&rest).filter(|_| !is_over);
        let pays = cut.is_some_and(|cut| cut.cost < params.intersection_cost * n as f64);
        let chosen = cut
            .filter(|_| pays || rest.patience > 0)
            .and_then(|cut| Some((cut, rest.budget.share(cut.counts)?)));
        let Some((cut, shares)) = chosen else {
            let mut prims: Vec<u32> = rest.parts.iter().map(|p| p.0).collect();
            prims.sort_unstable();
            let first = self.0.references.len() as u32;
            self.0.references.extend(prims.iter().map(|&i| self.0.prims[i as usize].kind.packed()));
            self.0.nodes.push(Node::Leaf { first, count: n as u32 });
            return;
        };
        let node = self.0.nodes.len();
        self.0.nodes.push(Node::Leaf { first: 0, count: 0 });
        let halves = sweep::halves(&rest.bounds, cut.axis, cut.plane);
        for (side, bounds) in halves.into_iter().enumerate() {
            if side == 1 {
                let upper = self.0.nodes.len() as u32;
                self.0.nodes[node] = Node::Inner { axis: cut.axis as u8, plane: cut.plane, upper };
            }
            self.subtree(Rest {
                bounds,
                parts: self.side(&rest.parts, &cut, side, &bounds),
                depth: rest.depth + 1,
                budget: shares[side],
                patience: if pays { rest.patience } else { rest.patience - 1 },
            });
        }
    }

    /// The parts on one side of a cut.
    fn side(&self, parts: &Parts, cut: &Cut, side: usize, half: &Bounds) -> Parts {
        let mut out = Parts::new();
        for &(prim, b) in parts {
            let (low, high) = (b.min[cut.axis], b.max[cut.axis]);
            let below = high < cut.plane || (high == cut.plane && (low < cut.plane || cut.flat_below));
            let above = low > cut.plane || (low == cut.plane && (high > cut.plane || !cut.flat_below));
            match (below, above) {
                (true, _) if side == 0 => out.push((prim, b)),
                (_, true) if side == 1 => out.push((prim, b)),
                (false, false) => out.extend(self.0.part(prim, half).map(|b| (prim, b))),
                _ => {}
            }
        }
        out
    }
}

fn naive(prims: &[Prim], params: &KdParams, vertices: &Vertices<'_>, patience: u32) -> KdTree {
    let bounds = prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds));
    let builder = Builder {
        prims,
        vertices,
        params: *params,
        max_depth: depth_limit(params.max_depth, prims.len()),
        sides: Vec::new(),
        nodes: Vec::new(),
        references: Vec::new(),
    };
    let mut naive = Naive(builder);
    let parts = prims.iter().enumerate().map(|(i, p)| (i as u32, p.bounds)).collect();
    let budget = Budget::of(prims.len());
    naive.subtree(Rest { bounds: partition::finite(&bounds), parts, depth: 0, budget, patience });
    let Builder { nodes, references, .. } = naive.0;
    KdTree { bounds, nodes, references, limits: Limits::NONE, params: *params }
}

/// With the formula of `mod.rs` written out, and every plane tried that there is.
#[test]
fn the_sweep_finds_the_cheapest_plane() {
    let mut r = Random(1);
    for n in 2..40 {
        let (prims, _) = scene(&mut r, n);
        let cell = prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds));
        let params = KdParams { traversal_cost: 0.3, empty_bonus: 0.1, ..KdParams::DEFAULT };
        let mut events = [const { Vec::new() }; 3];
        for (i, p) in prims.iter().enumerate() {
            add_events(&mut events, &p.bounds, i as u32);
        }
        events.iter_mut().for_each(|list| list.sort_unstable_by(Event::cmp));
        let found = sweep::cheapest(&params, &cell, &events, prims.len());

        let parts: Parts = prims.iter().enumerate().map(|(i, p)| (i as u32, p.bounds)).collect();
        let edges = [0, 1, 2].map(|axis| f64::from(cell.max[axis]) - f64::from(cell.min[axis]));
        let area = |e: [f64; 3]| 2.0 * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
        let mut least = f64::INFINITY;
        for axis in 0..3 {
            for plane in parts.iter().flat_map(|(_, b)| [b.min[axis], b.max[axis]]) {
                if plane <= cell.min[axis] || plane >= cell.max[axis] {
                    continue;
                }
                let [below, flat, above] = count(&parts, axis, plane);
                let (mut lower, mut upper) = (edges, edges);
                lower[axis] = f64::from(plane) - f64::from(cell.min[axis]);
                upper[axis] = f64::from(cell.max[axis]) - f64::from(plane);
                for [l, u] in [[below + flat, above], [below, above + flat]] {
                    let tests = (l as f64 * area(lower) + u as f64 * area(upper)) / area(edges);
                    let cost = (0.3 + tests) * if l * u == 0 { 0.9 } else { 1.0 };
                    least = if cost < least { cost } else { least };
                }
            }
        }
        match found {
            Some(cut) => assert!((cut.cost - least).abs() < 1e-12 * least, "{n}: {} for {least}", cut.cost),
            None => assert_eq!(least, f64::INFINITY),
        }
    }
}

#[test]
fn sorted_events_give_the_planes_of_the_naive_build() {
    let mut r = Random(2);
    let mut inner = 0;
    for round in 0..60 {
        let (prims, triangles) = scene(&mut r, 1 + round * 2);
        let vertices = |id: u32| triangles[id as usize];
        for clip in [false, true] {
            let params =
                KdParams { clip, traversal_cost: [0.2, 0.5, 1.0][round as usize % 3], ..KdParams::DEFAULT };
            let tree = build(&prims, &params, &vertices);
            let expected = naive(&prims, &params, &vertices, 0);
            assert!(tree.nodes == expected.nodes, "nodes differ in round {round}, clip {clip}");
            assert!(tree.references == expected.references, "leaves differ in round {round}, clip {clip}");
            inner += tree.stats().nodes;
        }
    }
    assert!(inner > 3000, "{inner} nodes say little");
}

/// A root with six walls of two triangles each: no cut pays alone, and several do.
#[test]
fn hollow_objects_stop_the_greedy_rule() {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for at in [0.0, 1.0] {
            let corner = |u: f32, v: f32| {
                let mut p = Vec3::splat(at);
                (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (u, v);
                p
            };
            let [a, b, c, d] = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let prims: Vec<Prim> = (0..12)
        .map(|i| Prim { bounds: slab::triangle_bounds(&triangles[i]), kind: PrimKind::Triangle(i as u32) })
        .collect();
    let vertices = |id: u32| triangles[id as usize];
    let params = KdParams { traversal_cost: 0.2, ..KdParams::DEFAULT };
    let greedy = build(&prims, &params, &vertices).stats();
    assert_eq!((greedy.nodes, greedy.sah_cost), (0, 12.0));
    let patient = naive(&prims, &params, &vertices, 4).stats();
    assert!(patient.sah_cost < 6.5, "{patient:?}");
}

#[test]
fn clipping_makes_a_better_tree() {
    let mut r = Random(3);
    // Long and thin, and at odd angles.
    let triangles: Vec<[Vec3; 3]> = (0..400)
        .map(|_| {
            let (a, along) = (r.point(), r.point());
            [a, a + along, a + along * 0.5 + r.point() * 0.01]
        })
        .collect();
    let prims: Vec<Prim> = (0..400)
        .map(|i| Prim { bounds: slab::triangle_bounds(&triangles[i]), kind: PrimKind::Triangle(i as u32) })
        .collect();
    let vertices = |id: u32| triangles[id as usize];
    let cost = |clip| build(&prims, &KdParams { clip, ..KdParams::DEFAULT }, &vertices).stats().sah_cost;
    let (boxes, clipped) = (cost(false), cost(true));
    assert!(clipped < 0.8 * boxes, "{clipped} against {boxes}");
}
