//! From the bottom up: pairs of neighbours are joined until one set is left.
//!
//! Clustering in the order of a space-filling curve (Meister and Bittner 2018, "Parallel Locally-Ordered Clustering for
//! Bounding Volume Hierarchy Construction"): each cluster looks for the one, among a few to its left and right in Morton order, with
//! which it has the smallest common box, and two that chose each other are joined. Looking at all pairs instead (Walter et
//! al. 2008, "Fast Agglomerative Clustering for Rendering") would need time that grows with n^2.
//!
//! Deviation from the paper: where fewer than one in eight clusters finds a partner, all are joined with the next one
//! instead. So a step leaves at most 7/8 of the clusters, which bounds time and depth for degenerate scenes.

use super::{Bvh2, MAX_DEPTH, Node, build::center};
use crate::{
    partition::half_area,
    prim::{Packed, Prim},
};
use rayon::prelude::*;
use straal_math::Bounds;

/// How many clusters are looked at on either side.
const RADIUS: usize = 16;

// From 2^30 primitives, ln(2^30) / ln(8/7) = 156 steps lead to the last 8 clusters, and 7 more to one.
const _: () = assert!(MAX_DEPTH > 156 + 7 + 1);

/// A set of primitives, as a tree of its own.
struct Cluster {
    bounds: Bounds,
    /// The two it was joined from, or a primitive.
    parts: Parts,
    count: usize,
    /// By the surface area heuristic, for a line that meets a box of area 1.
    cost: f64,
    is_leaf: bool,
}

#[derive(Clone, Copy)]
enum Parts {
    Prim(Packed),
    Pair([u32; 2]),
}

pub(super) fn build(out: &mut Bvh2, prims: &[Prim]) {
    let codes = morton_codes(prims);
    let mut order: Vec<u32> = (0..prims.len() as u32).collect();
    order.par_sort_unstable_by_key(|&i| (codes[i as usize], i));
    let params = out.params;
    let mut all: Vec<Cluster> = Vec::with_capacity(2 * prims.len());
    all.extend(order.iter().map(|&i| {
        let prim = &prims[i as usize];
        let cost = params.intersection_cost * half_area(&prim.bounds);
        let parts = Parts::Prim(prim.kind.packed());
        Cluster { bounds: prim.bounds, parts, count: 1, cost, is_leaf: true }
    }));
    let mut active: Vec<u32> = (0..prims.len() as u32).collect();
    while active.len() > 1 {
        let partners = partners(&all, &active);
        let mut next = Vec::with_capacity(active.len());
        for (i, &partner) in partners.iter().enumerate() {
            if partner == i {
                next.push(active[i]);
            } else if i < partner {
                let pair = [active[i], active[partner]];
                let [a, b] = pair.map(|c| &all[c as usize]);
                let (bounds, count) = (a.bounds.union(b.bounds), a.count + b.count);
                let area = half_area(&bounds);
                let is_leaf = params.prefers_leaf(count, area, a.cost + b.cost);
                let cost = if is_leaf {
                    params.intersection_cost * count as f64 * area
                } else {
                    params.traversal_cost * area + a.cost + b.cost
                };
                next.push(all.len() as u32);
                all.push(Cluster { bounds, parts: Parts::Pair(pair), count, cost, is_leaf });
            }
        }
        active = next;
    }
    write(out, &all, active[0]);
}

/// By place in `active`, the place of the one to join with; its own where there is none.
fn partners(all: &[Cluster], active: &[u32]) -> Vec<usize> {
    let n = active.len();
    let bounds: Vec<Bounds> = active.iter().map(|&i| all[i as usize].bounds).collect();
    let nearest: Vec<usize> = (0..n)
        .into_par_iter()
        .with_min_len(1024)
        .map(|i| {
            let (low, high) = (i.saturating_sub(RADIUS), (i + RADIUS + 1).min(n));
            let mut best = (i, f64::INFINITY);
            for j in (low..high).filter(|&j| j != i) {
                let area = half_area(&bounds[i].union(bounds[j]));
                // Of equal ones that whose number differs least in binary: no two choose differently.
                let closer = area.total_cmp(&best.1).then((i ^ j).cmp(&(i ^ best.0)));
                if best.0 == i || closer.is_lt() {
                    best = (j, area);
                }
            }
            best.0
        })
        .collect();
    let chosen: Vec<usize> = (0..n).map(|i| if nearest[nearest[i]] == i { nearest[i] } else { i }).collect();
    let joined = chosen.iter().enumerate().filter(|&(i, &partner)| i < partner).count();
    if joined > 0 && joined * 8 >= n {
        return chosen;
    }
    (0..n).map(|i| if i ^ 1 < n { i ^ 1 } else { i }).collect()
}

/// Brings the clusters in the form that is searched.
fn write(out: &mut Bvh2, all: &[Cluster], root: u32) {
    out.nodes.push(Node { bounds: Bounds::EMPTY, first: 0, count: 0 });
    let mut todo = vec![(root, 0_usize)];
    while let Some((cluster, slot)) = todo.pop() {
        let c = &all[cluster as usize];
        let (first, count) = match c.parts {
            Parts::Pair(pair) if !c.is_leaf => {
                let first = out.nodes.len();
                let blank = out.nodes[slot];
                out.nodes.extend([blank, blank]);
                todo.extend([(pair[1], first + 1), (pair[0], first)]);
                (first as u32, 0)
            }
            _ => {
                let first = out.prims.len() as u32;
                let mut inside = vec![cluster];
                while let Some(i) = inside.pop() {
                    match all[i as usize].parts {
                        Parts::Prim(prim) => out.prims.push(prim),
                        Parts::Pair([a, b]) => inside.extend([b, a]),
                    }
                }
                (first, c.count as u32)
            }
        };
        out.nodes[slot] = Node { bounds: c.bounds, first, count };
    }
}

/// Where boxes' centres lie on a curve that visits all of space: 21 bits of each coordinate, interleaved.
fn morton_codes(prims: &[Prim]) -> Vec<u64> {
    const BITS: u32 = 21;
    let centers = |axis: usize| prims.iter().map(move |p| center(p, axis));
    let range = |axis: usize| {
        centers(axis).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (if x < low { x } else { low }, if x > high { x } else { high })
        })
    };
    let ranges: [(f64, f64); 3] = std::array::from_fn(range);
    let steps = f64::from((1_u32 << BITS) - 1);
    let code = |p: &Prim| {
        (0..3).fold(0_u64, |code, axis| {
            let (low, high) = ranges[axis];
            // What isn't a number becomes 0.
            let x = ((center(p, axis) - low) / (high - low) * steps) as u64;
            (0..BITS).fold(code, |code, bit| code | (x >> bit & 1) << (3 * bit + axis as u32))
        })
    };
    prims.par_iter().map(code).collect()
}
