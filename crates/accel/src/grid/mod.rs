//! A uniform grid, searched cell by cell with a 3D-DDA (Suffern 2007, "Ray Tracing from the Ground Up", chapter 22;
//! Amanatides and Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing").
//!
//! The box around everything is cut into equal cells, and each cell lists the primitives whose boxes overlap it. A ray
//! visits the cells on its way and stops at the first hit that lies before the exit from the cell: a hit further on, by
//! a primitive that also reaches into this cell, is kept but not believed before the ray has come there.
//!
//! With n primitives in a box of w_x by w_y by w_z, the edge of a cell that holds one of them on average is
//! s = (w_x w_y w_z / n)^(1/3), and axis i gets floor(factor w_i / s) + 1 cells (Suffern, section 22.3). An axis along
//! which all is thinner than a cell gets one cell, and the others share the cells as in a grid of fewer dimensions.
//!
//! It is quick to build, and quick to search where primitives are of one size and evenly spread. It loses where they
//! aren't: all of a small dense object falls into one cell of a huge empty scene (the "teapot in a stadium").
//!
//! `build.rs` makes the lists; `march.rs` walks the cells, and says why no hit is lost.

mod build;
mod march;
mod validate;

use crate::{
    hit::Hit,
    mailbox::Mailboxes,
    partition::{chance, finite},
    prim::Packed,
    query::{Built, Descend, Place, Query, Search, Stats},
    section::Section,
};
use straal_math::Bounds;

/// How a grid is built and searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridParams {
    /// Along each axis, cells for each one that a grid with as many cells as primitives would have. At most 1024.
    pub factor: f64,
    /// Whether a ray remembers the primitives that it tested last, so that one in several cells is tested once.
    pub mailboxes: bool,
    /// Most cells, and most entries in the cells' lists beyond one for each primitive: the factor is halved until both
    /// hold. At most 2^28; each cell and each entry takes 4 bytes.
    pub max_cells: u32,
    /// Cost of a step to the next cell.
    pub traversal_cost: f64,
    /// Cost of the test of a primitive, in the same unit.
    pub intersection_cost: f64,
}

impl GridParams {
    /// The textbook's.
    pub const DEFAULT: Self = Self {
        factor: 2.0,
        mailboxes: true,
        max_cells: 1 << 25,
        traversal_cost: 0.5,
        intersection_cost: 1.0,
    };
}

impl Default for GridParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The cells and what is in them.
pub(crate) struct Grid {
    params: GridParams,
    /// Number of primitives.
    prims: usize,
    /// By axis, the planes between layers of cells, ascending: one more than there are layers. The first and the last are
    /// the faces of the box around everything. Empty when there is nothing.
    planes: [Vec<f32>; 3],
    /// Where each cell's list starts in `entries`, and at the end where the last list ends; x varies fastest.
    starts: Vec<u32>,
    entries: Vec<Packed>,
}

impl Grid {
    /// Layers of cells along each axis.
    #[inline(always)]
    fn size(&self) -> [usize; 3] {
        std::array::from_fn(|i| self.planes[i].len().saturating_sub(1))
    }

    /// The primitives in a cell.
    #[inline(always)]
    fn list(&self, cell: usize) -> &[Packed] {
        &self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Around everything; empty when there is nothing.
    fn bounds(&self) -> Bounds {
        let mut out = Bounds::EMPTY;
        for (axis, planes) in self.planes.iter().enumerate() {
            if let (Some(&low), Some(&high)) = (planes.first(), planes.last()) {
                (out.min[axis], out.max[axis]) = (low, high);
            }
        }
        out
    }
}

impl Search for Grid {
    #[inline(always)]
    fn closest<K: Descend, const COUNT: bool>(
        &self,
        q: &mut Query<'_, K, COUNT>,
        at: &Place<'_>,
        best: &mut Hit,
    ) {
        let mut tested = Mailboxes::new(self.params.mailboxes);
        q.count_node(1);
        self.march(at.ray, best.t, |cell| {
            q.count_node(0);
            tested.closest(q, at, self.list(cell), best);
            Some(best.t)
        });
    }

    #[inline(always)]
    fn occluded<K: Descend, const COUNT: bool>(&self, q: &mut Query<'_, K, COUNT>, at: &Place<'_>) -> bool {
        let mut tested = Mailboxes::new(self.params.mailboxes);
        let mut found = false;
        q.count_node(1);
        self.march(at.ray, at.ray.ray.t_max, |cell| {
            q.count_node(0);
            found = tested.occluded(q, at, self.list(cell));
            (!found).then_some(at.ray.ray.t_max)
        });
        found
    }
}

impl Built for Grid {
    fn section(&self, z: f64) -> Vec<Section> {
        let [nx, ny, nz] = self.size();
        let between = |axis: usize, i: usize| [self.planes[axis][i], self.planes[axis][i + 1]].map(f64::from);
        let Some(layer) = (0..nz).find(|&k| between(2, k)[0] <= z && z <= between(2, k)[1]) else {
            return Vec::new();
        };
        let cell = |i: usize| {
            let ([x0, x1], [y0, y1]) = (between(0, i % nx), between(1, i / nx));
            let outline = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
            Section { outline, depth: 0, primitives: Some(self.list(layer * nx * ny + i).len()) }
        };
        (0..nx * ny).map(cell).collect()
    }

    fn memory_bytes(&self) -> usize {
        let planes: usize = self.planes.iter().map(|p| size_of_val(p.as_slice())).sum();
        planes + size_of_val(self.starts.as_slice()) + size_of_val(self.entries.as_slice())
    }

    fn stats(&self) -> Stats {
        let [nx, ny, nz] = self.size();
        let leaves = nx * ny * nz;
        let p = &self.params;
        let step = p.traversal_cost / p.intersection_cost;
        // All cells have one shape, so that a line meets each with the same probability.
        let area = |w: [f64; 3]| w[0] * w[1] + w[1] * w[2] + w[2] * w[0];
        let bounds = finite(&self.bounds());
        let w = bounds.max.as_dvec3() - bounds.min.as_dvec3();
        let whole = area([w.x, w.y, w.z]);
        let cell = area([w.x / nx as f64, w.y / ny as f64, w.z / nz as f64]);
        let chance = chance(cell, whole);
        let sah_cost = match leaves {
            0 => 0.0,
            _ => chance * (leaves as f64 * step + self.entries.len() as f64),
        };
        Stats { nodes: 0, leaves, references: self.entries.len(), depth: u32::from(leaves > 0), sah_cost }
    }
}
