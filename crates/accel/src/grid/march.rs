//! Which cells a ray visits, and why no hit is lost.
//!
//! Box tests are lenient (`slab.rs`): rounded crossings are compared, and the exit is pushed out a little, by an amount
//! that grows with the distance from the ray's origin. So a primitive may count though an exact walk would pass by its cells,
//! through an edge or a corner, or far away. The walk is as lenient as the box test:
//!
//! Along one axis a ray crosses the planes at t_0 <= t_1 <= ..., each the very number that a box test computes for a face
//! at that plane. The layer between planes j and j+1 is *open* from t_j to loosen(t_{j+1}), which is at least t_{j+1} and at
//! least what a box test allows. A cell is visited when its three layers are open at once.
//!
//! Let a primitive's box count as crossed, and let t be its entry, or `t_min` if that is greater. On each axis, take the
//! last of the layers it has a part of that are entered at t or before; there is one, since the first is entered no later
//! than the box. If the next layer belongs to the box too, it is entered after t, so this one is open at t. If not, the layer
//! ends at the box' face or behind it, and stays open at least as long as the box test allows: it is open at t. So the
//! primitive is in a cell all of whose layers are open at t, which is visited, and whose entry is no later than t. The
//! primitive's hit has no lesser t. A walk may therefore end when the next layer opens strictly beyond the best hit.
//!
//! Nearly always one layer is open on each axis, and this is the textbook's walk; right behind a plane there are two.

use super::Grid;
use crate::{
    local::LocalRay,
    slab::{self, EXIT},
};
use straal_math::ops;

/// An axis during a walk. Layers are counted in the direction of the ray.
#[derive(Clone, Copy)]
struct Axis<'a> {
    planes: &'a [f32],
    /// Whether the ray meets the last plane first.
    neg: bool,
    o: f32,
    inv: f32,
    /// The open layers.
    back: usize,
    front: usize,
    /// Where the last open layer closes.
    close: f32,
    /// Where the next layer opens; infinite when there is none.
    open: f32,
    /// From a layer to its first cell.
    stride: usize,
}

/// Not before t, and not before the exit that a box test allows; monotone, as both are.
#[inline(always)]
fn loosen(t: f32) -> f32 {
    ops::max(t * EXIT, t)
}

impl<'a> Axis<'a> {
    /// The layers that are open at `t`, where the ray is in the grid.
    #[inline(always)]
    fn new(planes: &'a [f32], r: &LocalRay, axis: usize, stride: usize, t: f32) -> Self {
        let (o, inv, neg) = (r.ray.o[axis], r.inv[axis], r.neg[axis] != 0);
        let mut a = Self { planes, neg, o, inv, back: 0, front: 0, close: 0.0, open: 0.0, stride };
        // The first plane is crossed at t or before.
        let (mut low, mut high) = (0, a.layers());
        while high - low > 1 {
            let middle = low.midpoint(high);
            if a.crossing(middle) <= t { low = middle } else { high = middle }
        }
        a.front = low;
        a.back = low;
        while a.back > 0 && loosen(a.crossing(a.back)) >= t {
            a.back -= 1;
        }
        a.close = loosen(a.crossing(a.back + 1));
        a.open = a.next_open();
        a
    }

    #[inline(always)]
    fn layers(&self) -> usize {
        self.planes.len() - 1
    }

    /// Where the ray crosses the j-th plane, as `slab::entry` computes it.
    #[inline(always)]
    fn crossing(&self, j: usize) -> f32 {
        let plane = if self.neg { self.planes[self.layers() - j] } else { self.planes[j] };
        (plane - self.o) * self.inv
    }

    #[inline(always)]
    fn next_open(&self) -> f32 {
        if self.front + 1 < self.layers() { self.crossing(self.front + 1) } else { f32::INFINITY }
    }

    /// Closes the layers that end before `t`; false when none is left.
    #[inline(always)]
    fn close_before(&mut self, t: f32) -> bool {
        while self.close < t {
            self.back += 1;
            if self.back >= self.layers() {
                return false;
            }
            self.close = loosen(self.crossing(self.back + 1));
        }
        true
    }

    /// The offset of a layer's cells.
    #[inline(always)]
    fn offset(&self, j: usize) -> usize {
        let layer = if self.neg { self.layers() - 1 - j } else { j };
        layer * self.stride
    }
}

impl Grid {
    /// Calls `visit` with the cells on a ray's way in the order in which it enters them, none twice. What it returns is the
    /// t beyond which nothing matters any more; `None` ends the walk.
    #[inline(always)]
    pub(super) fn march(&self, r: &LocalRay, mut limit: f32, mut visit: impl FnMut(usize) -> Option<f32>) {
        let Some(enter) = slab::entry(&self.bounds(), r) else { return };
        let start = ops::max(enter, r.ray.t_min);
        if start > limit {
            return;
        }
        let [nx, ny, _] = self.size();
        let strides = [1, nx, nx * ny];
        let mut axes: [Axis<'_>; 3] =
            std::array::from_fn(|i| Axis::new(&self.planes[i], r, i, strides[i], start));
        let mut first = axes.map(|a| a.back);
        loop {
            for z in first[2]..=axes[2].front {
                for y in first[1]..=axes[1].front {
                    for x in first[0]..=axes[0].front {
                        let cell = axes[0].offset(x) + axes[1].offset(y) + axes[2].offset(z);
                        match visit(cell) {
                            Some(t) => limit = t,
                            None => return,
                        }
                    }
                }
            }
            let next = usize::from(axes[1].open < axes[0].open);
            let next = if axes[2].open < axes[next].open { 2 } else { next };
            let t = axes[next].open;
            // Also when no layer is left to open: a limit is finite.
            if t > limit {
                return;
            }
            for axis in &mut axes {
                if !axis.close_before(t) {
                    return;
                }
            }
            axes[next].front += 1;
            axes[next].open = axes[next].next_open();
            // Visited next: the opened layer where it meets the open ones of the other axes.
            first = axes.map(|a| a.back);
            first[next] = axes[next].front;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        grid::GridParams,
        prim::{Prim, PrimKind},
    };
    use straal_math::{Bounds, Ray, Vec3};

    fn grid_of_eight() -> Grid {
        let cell = |i: u32| {
            let min = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
            Prim { bounds: Bounds { min, max: min + Vec3::ONE }, kind: PrimKind::Triangle(i) }
        };
        let prims: Vec<Prim> = (0..8).map(cell).collect();
        Grid::build(&prims, &GridParams { factor: 0.99, ..GridParams::DEFAULT })
    }

    fn visited(grid: &Grid, o: [f32; 3], d: [f32; 3]) -> Vec<usize> {
        let mut out = Vec::new();
        let ray = LocalRay::new(&Ray::new(Vec3::from_array(o), Vec3::from_array(d))).unwrap();
        grid.march(&ray, ray.ray.t_max, |cell| {
            out.push(cell);
            Some(ray.ray.t_max)
        });
        out
    }

    #[test]
    fn a_walk_visits_the_cells_in_order() {
        let grid = grid_of_eight();
        assert_eq!(grid.size(), [2; 3]);
        assert_eq!(visited(&grid, [-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]), [0, 1]);
        assert_eq!(visited(&grid, [0.5, 0.5, 3.0], [0.0, 0.0, -2.0]), [4, 0]);
        assert_eq!(visited(&grid, [0.5, 0.7, 0.5], [1.0, 1.0, 0.0]), [0, 2, 3]);
        assert_eq!(visited(&grid, [5.0, 0.5, 0.5], [1.0, 0.0, 0.0]), [0_usize; 0]);
    }

    #[test]
    fn a_ray_through_an_edge_or_a_corner_visits_all_around() {
        let grid = grid_of_eight();
        let mut all = visited(&grid, [-1.0; 3], [1.0; 3]);
        assert_eq!((all[0], all.len()), (0, 8));
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2, 3, 4, 5, 6, 7]);
        let mut four = visited(&grid, [-1.0, -1.0, 0.5], [1.0, 1.0, 0.0]);
        four.sort_unstable();
        assert_eq!(four, [0, 1, 2, 3]);
    }

    #[test]
    fn cells_are_as_cubical_as_they_can_be() {
        let flat = |n: u32| -> Vec<Prim> {
            let at = |i: u32| Vec3::new((i % 10) as f32, (i / 10) as f32 * 4.0, 0.0);
            let bounds = |i: u32| Bounds { min: at(i), max: at(i) + Vec3::new(1.0, 4.0, 1e-7) };
            (0..n).map(|i| Prim { bounds: bounds(i), kind: PrimKind::Triangle(i) }).collect()
        };
        let size =
            |factor: f64| Grid::build(&flat(100), &GridParams { factor, ..GridParams::DEFAULT }).size();
        // 10 by 40 units hold 100 primitives: cells of 2 by 2 for a factor of 1.
        assert_eq!(size(1.0), [6, 21, 1]);
        assert_eq!(size(2.0), [11, 41, 1]);
    }

    #[test]
    fn memory_is_bounded() {
        let one = Bounds { min: Vec3::splat(-1.0), max: Vec3::ONE };
        let prims: Vec<Prim> = (0..5000).map(|i| Prim { bounds: one, kind: PrimKind::Triangle(i) }).collect();
        let max_cells = 10_000;
        for factor in [1e-9, 2.0, 1e300, f64::INFINITY, f64::NAN, -1.0] {
            let grid = Grid::build(&prims, &GridParams { factor, max_cells, ..GridParams::DEFAULT });
            let stats = crate::query::Built::stats(&grid);
            assert!(stats.leaves <= 10_000 && stats.references <= 15_000, "{factor}: {stats:?}");
        }
    }
}
