//! Whether a grid is what searches rely on.

use super::Grid;
use crate::prim::Prim;

impl Grid {
    /// Every primitive in exactly the cells that its box has a part of, and these around the whole box.
    pub fn validate(&self, prims: &[Prim]) -> Result<(), String> {
        if prims.len() != self.prims {
            return Err(format!("{} primitives, built of {}", prims.len(), self.prims));
        }
        let size = self.size();
        let mut expected = vec![Vec::new(); self.starts.len().saturating_sub(1)];
        for p in prims {
            let cells = self.cells(&p.bounds);
            for axis in 0..3 {
                let planes = &self.planes[axis];
                let (low, high) = (planes[cells.first[axis]], planes[cells.last[axis] + 1]);
                if !(low <= p.bounds.min[axis] && p.bounds.max[axis] <= high) {
                    return Err(format!("{:?} sticks out of its cells", p.kind));
                }
            }
            cells.each(size, |cell| expected[cell].push(p.kind));
        }
        for (cell, expected) in expected.iter().enumerate() {
            if !self.list(cell).iter().map(|p| p.kind()).eq(expected.iter().copied()) {
                return Err(format!("cell {cell} has other primitives than it should"));
            }
        }
        match self.planes.iter().all(|p| p.is_sorted()) {
            true => Ok(()),
            false => Err("planes are out of order".into()),
        }
    }
}
