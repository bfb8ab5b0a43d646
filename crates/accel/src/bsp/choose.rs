//! Which planes cut a BSP tree.

use super::{
    BspParams,
    cell::Cell,
    plane::{Plane, Side, Vertices},
};
use crate::{
    partition::{self, chance},
    prim::{Prim, PrimKind},
};
use straal_math::DVec3;

/// A plane, and how many primitives touch its front and its back.
pub(super) struct Cut {
    pub plane: Plane,
    pub counts: [usize; 2],
}

/// What choices are made from.
pub(super) struct Chooser<'a> {
    pub prims: &'a [Prim],
    pub vertices: &'a Vertices<'a>,
    pub params: BspParams,
}

impl Chooser<'_> {
    /// The cut of some primitives with few of them across it and equal numbers on both sides; `None` where they are better
    /// left alone.
    pub fn most_even(&self, prims: &[u32]) -> Option<Cut> {
        let mut best: Option<(Cut, f64)> = None;
        for plane in self.polygons(prims).chain(self.median(prims)) {
            let [front, across, back] = self.count(prims, &plane);
            let counts = [front + across, across + back];
            let score = self.params.straddle_cost * across as f64 + front.abs_diff(back) as f64;
            // A plane that leaves everything on one side would be found again below.
            let parts = counts.iter().all(|&n| n < prims.len());
            if parts && best.as_ref().is_none_or(|b| score < b.1) {
                best = Some((Cut { plane, counts }, score));
            }
        }
        let (cut, _) = best?;
        let halves = self.cost(cut.counts[0] as f64 + cut.counts[1] as f64) / 2.0;
        (self.params.traversal_cost + halves < self.cost(prims.len() as f64)).then_some(cut)
    }

    /// The cut of primitives in a cell that the surface area heuristic finds cheapest, unless that is to leave them alone.
    pub fn cheapest(&self, prims: &[u32], space: &Cell) -> Option<Cut> {
        let whole = space.area();
        let mut best = None;
        let mut least = self.cost(prims.len() as f64);
        for plane in self.polygons(prims).chain(self.faces(prims)).chain(self.median(prims)) {
            let [front, across, back] = self.count(prims, &plane);
            let counts = [front + across, across + back];
            let chances = space.areas(&plane).map(|area| chance(area, whole));
            let tests = chances[0] * counts[0] as f64 + chances[1] * counts[1] as f64;
            let cost = self.params.traversal_cost + self.cost(tests);
            if cost < least {
                (best, least) = (Some(Cut { plane, counts }), cost);
            }
        }
        best
    }

    /// The cost of so many tests.
    fn cost(&self, tests: f64) -> f64 {
        self.params.intersection_cost * tests
    }

    /// Some of the primitives, evenly spaced in their order, which offer planes.
    fn offering<'a>(&self, prims: &'a [u32]) -> impl Iterator<Item = u32> + 'a {
        let wanted = (self.params.candidates as usize).min(prims.len());
        (0..wanted).map(move |i| prims[i * prims.len() / wanted])
    }

    /// The planes just before some triangles.
    fn polygons(&self, prims: &[u32]) -> impl Iterator<Item = Plane> {
        self.offering(prims).filter_map(|prim| match self.prims[prim as usize].kind {
            PrimKind::Triangle(id) => Plane::before_triangle(&(self.vertices)(id)),
            PrimKind::Object(_) => None,
        })
    }

    /// Planes at right angles to the axes, on both sides of the same primitives.
    fn faces(&self, prims: &[u32]) -> impl Iterator<Item = Plane> {
        self.offering(prims).flat_map(|prim| {
            let Prim { bounds, kind } = &self.prims[prim as usize];
            let vertices = match *kind {
                PrimKind::Triangle(id) => Some((self.vertices)(id)),
                PrimKind::Object(_) => None,
            };
            let bounds = partition::finite(bounds);
            (0..3).flat_map(move |axis| Plane::beside(axis, &bounds, vertices.as_ref()))
        })
    }

    /// The plane at right angles to the longest axis of the primitives' middles, through their median.
    fn median(&self, prims: &[u32]) -> Option<Plane> {
        let middle = |&i: &u32| {
            let b = partition::finite(&self.prims[i as usize].bounds);
            (b.min * 0.5 + b.max * 0.5).as_dvec3()
        };
        let (low, high) = prims
            .iter()
            .map(middle)
            .fold((DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        let axis = (high - low).max_axis();
        let mut middles: Vec<f64> = prims.iter().map(|i| middle(i)[axis]).collect();
        let half = middles.len() / 2;
        (!middles.is_empty()).then(|| {
            let (_, median, _) = middles.select_nth_unstable_by(half, f64::total_cmp);
            Plane::across(axis, *median)
        })
    }

    /// How many lie in front of a plane, across it, and behind it.
    fn count(&self, prims: &[u32], plane: &Plane) -> [usize; 3] {
        let mut out = [0; 3];
        for &prim in prims {
            out[match self.side(plane, prim) {
                Side::Front => 0,
                Side::Across => 1,
                Side::Back => 2,
            }] += 1;
        }
        out
    }

    /// On which side of a plane a primitive is looked for.
    pub fn side(&self, plane: &Plane, prim: u32) -> Side {
        plane.side_of(&self.prims[prim as usize], self.vertices)
    }
}
