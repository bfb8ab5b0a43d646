//! A grid of cells over the sphere of directions, and integrals over them.

use straal_math::{Frame, Vec3, ops};

/// Cells of a sphere about an axis: rings by rows, sectors by columns. Near the axis the rings may be finer.
#[derive(Clone, Copy, Debug)]
pub struct SphereGrid {
    /// A unit vector: where it matters most, say the middle of a lobe.
    pub axis: Vec3,
    /// 1 for rings of equal solid angle. With p the cosine of row coordinate t is 1 - 2 t^p.
    pub focus: i32,
    /// How many rings.
    pub rings: usize,
    /// How many cells a ring has.
    pub sectors: usize,
}

impl Default for SphereGrid {
    fn default() -> Self {
        Self { axis: Vec3::Z, focus: 1, rings: 24, sectors: 32 }
    }
}

/// A rectangle of the grid's parameters t (row) and s (turn), both in [0, 1].
#[derive(Clone, Copy)]
struct Patch {
    t: [f64; 2],
    s: [f64; 2],
}

impl SphereGrid {
    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.rings * self.sectors
    }

    /// The cell that a direction belongs to.
    pub fn cell(&self, d: Vec3) -> usize {
        let local = Frame::from_normal(self.axis).to_local(d).as_dvec3();
        let half_lack = 0.5 * (1.0 - local.z / local.length());
        let half_lack = if half_lack > 0.0 { half_lack } else { 0.0 };
        let t = ops::pow_d(half_lack, 1.0 / f64::from(self.focus));
        let turn = ops::atan2_d(local.y, local.x) / std::f64::consts::TAU;
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let ring = ((t * self.rings as f64) as usize).min(self.rings - 1);
        let sector = ((turn * self.sectors as f64) as usize).min(self.sectors - 1);
        ring * self.sectors + sector
    }

    /// The integral of `f` over each cell, by solid angle, cells being cut up where `f` is uneven until
    /// `tolerance` is met or the cut has been halved seven times.
    pub fn integrate(&self, f: impl Fn(Vec3) -> f64, tolerance: f64) -> Vec<f64> {
        let frame = Frame::from_normal(self.axis);
        let per_cell = tolerance / self.cells() as f64;
        let of_patch = |patch: &Patch| self.gauss(&frame, &f, patch);
        (0..self.cells())
            .map(|cell| {
                let (ring, sector) = (cell / self.sectors, cell % self.sectors);
                let span = |i: usize, n: usize| [i as f64 / n as f64, (i + 1) as f64 / n as f64];
                let patch = Patch { t: span(ring, self.rings), s: span(sector, self.sectors) };
                refine(&of_patch, &patch, of_patch(&patch), Budget { tolerance: per_cell, halvings: 7 })
            })
            .collect()
    }

    /// The integral of `f` over the whole sphere.
    pub fn total(&self, f: impl Fn(Vec3) -> f64, tolerance: f64) -> f64 {
        self.integrate(f, tolerance).into_iter().sum()
    }

    /// The product rule of Gauss with three points a side.
    fn gauss(&self, frame: &Frame, f: &impl Fn(Vec3) -> f64, patch: &Patch) -> f64 {
        const NODES: [f64; 3] = [-0.774_596_669_241_483_4, 0.0, 0.774_596_669_241_483_4];
        const WEIGHTS: [f64; 3] = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];
        let at = |span: [f64; 2], x: f64| 0.5 * ((1.0 - x) * span[0] + (1.0 + x) * span[1]);
        let p = f64::from(self.focus);
        let mut sum = 0.0;
        for (x, wx) in NODES.into_iter().zip(WEIGHTS) {
            let t = at(patch.t, x);
            let half_lack = ops::pow_d(t, p);
            let sin = 2.0 * (half_lack * (1.0 - half_lack)).sqrt();
            // d(cos)/dt times d(phi)/ds.
            let stretch = 2.0 * p * (half_lack / t) * std::f64::consts::TAU;
            for (y, wy) in NODES.into_iter().zip(WEIGHTS) {
                let (s, c) = ops::sin_cos_d(std::f64::consts::TAU * at(patch.s, y));
                let local = Vec3::new((sin * c) as f32, (sin * s) as f32, (1.0 - 2.0 * half_lack) as f32);
                sum += f(frame.to_world(local)) * stretch * wx * wy;
            }
        }
        sum * (patch.t[1] - patch.t[0]) * (patch.s[1] - patch.s[0])
    }
}

#[derive(Clone, Copy)]
struct Budget {
    tolerance: f64,
    halvings: u32,
}

/// Cuts a patch in four as long as that changes its integral.
fn refine(of_patch: &impl Fn(&Patch) -> f64, patch: &Patch, whole: f64, budget: Budget) -> f64 {
    let (tm, sm) = (0.5 * (patch.t[0] + patch.t[1]), 0.5 * (patch.s[0] + patch.s[1]));
    let quarters = [
        Patch { t: [patch.t[0], tm], s: [patch.s[0], sm] },
        Patch { t: [patch.t[0], tm], s: [sm, patch.s[1]] },
        Patch { t: [tm, patch.t[1]], s: [patch.s[0], sm] },
        Patch { t: [tm, patch.t[1]], s: [sm, patch.s[1]] },
    ];
    let parts = quarters.each_ref().map(of_patch);
    let sum = parts[0] + parts[1] + parts[2] + parts[3];
    // What isn't finite won't get better.
    if budget.halvings == 0 || !sum.is_finite() || (sum - whole).abs() <= budget.tolerance {
        return sum;
    }
    let budget = Budget { tolerance: budget.tolerance / 2.0, halvings: budget.halvings - 1 };
    quarters.iter().zip(parts).map(|(q, part)| refine(of_patch, q, part, budget)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_over_the_sphere_are_the_known_ones() {
        let axis = Vec3::new(0.6, 0.0, 0.8);
        for focus in [1, 4] {
            let grid = SphereGrid { axis, focus, ..SphereGrid::default() };
            let pi = std::f64::consts::PI;
            assert!((grid.total(|_| 1.0, 1e-6) - 4.0 * pi).abs() < 1e-6);
            assert!((grid.total(|d| f64::from(d.x * d.x), 1e-6) - 4.0 * pi / 3.0).abs() < 1e-5);
            // A cap with a sharp edge, not along the cells.
            let cap = grid.total(|d| if d.z > 0.9 { 1.0 } else { 0.0 }, 1e-4);
            assert!((cap / (2.0 * pi * 0.1) - 1.0).abs() < 1e-3, "{cap}");
        }
    }

    #[test]
    fn cells_are_where_their_integral_is() {
        let grid = SphereGrid { axis: Vec3::new(0.0, -0.8, 0.6), focus: 3, rings: 5, sectors: 7 };
        for cell in 0..grid.cells() {
            let own = grid.integrate(|d| if grid.cell(d) == cell { 1.0 } else { 0.0 }, 1e-3);
            for (i, v) in own.iter().enumerate() {
                assert_eq!(*v > 0.0, i == cell);
            }
        }
    }
}
