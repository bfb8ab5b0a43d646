//! How many cells there are, and which primitives are in which.

use super::{Grid, GridParams};
use crate::prim::{Packed, Prim};
use straal_math::{Bounds, ops};

/// Bounds of [`GridParams::factor`] and [`GridParams::max_cells`] whatever a caller asks for.
const MAX_FACTOR: f64 = 1024.0;
const MAX_CELLS: u32 = 1 << 28;

impl Grid {
    pub fn build(prims: &[Prim], params: &GridParams) -> Self {
        let mut grid = Self {
            params: *params,
            prims: prims.len(),
            planes: Default::default(),
            starts: Vec::new(),
            entries: Vec::new(),
        };
        if prims.is_empty() {
            return grid;
        }
        let whole = prims.iter().fold(Bounds::EMPTY, |b, p| b.union(p.bounds));
        let most = u64::from(params.max_cells.min(MAX_CELLS));
        let mut factor = if params.factor < MAX_FACTOR { params.factor } else { MAX_FACTOR };
        // One cell for everything, which is reached in the end, has exactly one entry for each primitive.
        loop {
            let size = layers(&whole, prims.len(), factor);
            let cells = size.iter().fold(1, |n: u64, &s| n.saturating_mul(s));
            if cells <= most || cells == 1 {
                grid.planes = planes(&whole, size);
                let entries: u64 = prims.iter().map(|p| grid.cells(&p.bounds).count()).sum();
                if entries <= prims.len() as u64 + most || cells == 1 {
                    break;
                }
            }
            factor *= 0.5;
        }
        grid.fill(prims);
        grid
    }

    /// Counts each cell's primitives, then puts them behind one another, in their order.
    fn fill(&mut self, prims: &[Prim]) {
        let size = self.size();
        let cells = size[0] * size[1] * size[2];
        let mut starts = vec![0_u32; cells + 1];
        for p in prims {
            self.cells(&p.bounds).each(size, |cell| starts[cell + 1] += 1);
        }
        for cell in 0..cells {
            starts[cell + 1] += starts[cell];
        }
        let total = starts[cells] as usize;
        let mut next = starts.clone();
        let mut entries = vec![Packed::NONE; total];
        for p in prims {
            let packed = p.kind.packed();
            self.cells(&p.bounds).each(size, |cell| {
                entries[next[cell] as usize] = packed;
                next[cell] += 1;
            });
        }
        (self.starts, self.entries) = (starts, entries);
    }

    /// The cells of which a box has a part, decided by the very planes that a ray crosses.
    pub(super) fn cells(&self, b: &Bounds) -> Cells {
        let mut out = Cells { first: [0; 3], last: [0; 3] };
        for axis in 0..3 {
            let planes = &self.planes[axis];
            let inner = &planes[1..planes.len() - 1];
            out.first[axis] = inner.partition_point(|&p| p <= b.min[axis]);
            out.last[axis] = inner.partition_point(|&p| p < b.max[axis]).max(out.first[axis]);
        }
        out
    }
}

/// A block of cells, by axis; ends are included.
pub(super) struct Cells {
    pub first: [usize; 3],
    pub last: [usize; 3],
}

impl Cells {
    fn count(&self) -> u64 {
        (0..3).map(|i| (self.last[i] - self.first[i] + 1) as u64).product()
    }

    pub(super) fn each(&self, size: [usize; 3], mut visit: impl FnMut(usize)) {
        for z in self.first[2]..=self.last[2] {
            for y in self.first[1]..=self.last[1] {
                for x in self.first[0]..=self.last[0] {
                    visit(x + size[0] * (y + size[1] * z));
                }
            }
        }
    }
}

/// Layers of cells along each axis by the textbook's formula.
fn layers(whole: &Bounds, prims: usize, factor: f64) -> [u64; 3] {
    let w: [f64; 3] = std::array::from_fn(|i| clamped(whole.max[i]) - clamped(whole.min[i]));
    let mut thick = [true; 3];
    loop {
        let dimensions = thick.iter().filter(|&&t| t).count();
        let volume: f64 = (0..3).filter(|&i| thick[i]).map(|i| w[i]).product();
        let edge = ops::pow_d(volume / prims as f64, 1.0 / dimensions as f64);
        let cells = |i: usize| factor * w[i] / edge;
        // The thinnest goes first: without it the others' cells get smaller, or larger.
        let thinnest = (0..3).filter(|&i| thick[i]).min_by(|&a, &b| w[a].total_cmp(&w[b]));
        match thinnest {
            Some(i) if dimensions > 1 && (cells(i) < 1.0 || w[i] == 0.0) => thick[i] = false,
            // What isn't a number becomes 0, and so one layer.
            _ => {
                return std::array::from_fn(
                    |i| if thick[i] { (cells(i) as u64).saturating_add(1) } else { 1 },
                );
            }
        }
    }
}

/// Padding can push a face of the box over the edge of what single precision holds.
fn clamped(x: f32) -> f64 {
    f64::from(ops::clamp(x, f32::MIN, f32::MAX))
}

/// Planes at equal distances; the outermost are the faces of the box to the last bit.
fn planes(whole: &Bounds, size: [u64; 3]) -> [Vec<f32>; 3] {
    std::array::from_fn(|axis| {
        let (low, high) = (whole.min[axis], whole.max[axis]);
        let (start, width) = (clamped(low), clamped(high) - clamped(low));
        let n = size[axis];
        let inner = (1..n).map(|k| {
            // Rounding is monotone, so that planes may coincide but never change places.
            let at = (start + width * k as f64 / n as f64) as f32;
            ops::clamp(at, low, high)
        });
        std::iter::once(low).chain(inner).chain([high]).collect()
    })
}
