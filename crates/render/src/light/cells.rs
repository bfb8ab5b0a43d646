//! Directions drawn by the cells of a grid of longitudes and latitudes: the way that surroundings of any radiance are sampled.
//!
//! Columns wrap round, the first beginning half a column beyond -z; rows lie between equal steps of the polar angle, from straight up down to
//! as far as they reach. A cell is drawn in proportion to its mean radiance times its solid angle, and roughly to the cosine at the surface ([`Facing`]);
//! within it directions are uniform.

use straal_math::simd::{Double, Float, Uint};
use straal_math::{DVec3, Vec3, ops};

use super::facing::Facing;

/// The grid.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    columns: usize,
    rows: usize,
    /// Rows that reach from straight up to straight down: no more than these, and no fewer than `rows`.
    half_turn: usize,
    /// `None` when all is black.
    facing: Option<Facing>,
    /// Cosine of the polar angle of each edge between rows.
    cosines: Vec<f64>,
    /// Of each row of cells its solid angle, times the number of rows: what densities over the unit square are divided by.
    bands: Vec<f64>,
    /// Local x, y and z in the world: an orthonormal frame.
    axes: [Vec3; 3],
    /// Integral of the radiance over all directions.
    pub total: f64,
    /// Roughly what falls on surfaces that face +x, -x, +y, -y, +z and -z of the world; 0 only where all is black.
    pub irradiance: [f32; 6],
}

/// How the grid lies.
pub(super) struct Grid {
    pub columns: usize,
    pub rows: usize,
    /// See [`Cells`].
    pub half_turn: usize,
    /// Local x, y and z in the world: an orthonormal frame.
    pub axes: [DVec3; 3],
    /// Whether cells no brighter than the mean are nearly left to BSDF sampling.
    pub is_compensated: bool,
}

/// A place within a cell, or many side by side.
pub(super) struct Place<F: Float> {
    pub column: F::Uint,
    pub row: F::Uint,
    /// Weights of the next column and row.
    pub x: F,
    pub y: F,
}

/// Directions that were drawn.
pub(super) struct Drawn<F: Float> {
    /// Of unit length where it is one.
    pub wi: Vec3<F>,
    pub is_direction: F::Mask,
    pub place: Place<F>,
    /// By solid angle.
    pub pdf: F,
}

/// What is left of the density of cells that are left to BSDF sampling: where that doesn't look, light must be found all the same.
const FLOOR: f64 = 0.05;

impl Cells {
    /// Of cells whose mean radiance is a function of column and row.
    pub fn new(grid: Grid, radiance: impl Fn(usize, usize) -> f64) -> Self {
        let Grid { columns, rows, half_turn, axes: [x, y, z], is_compensated } = grid;
        let cosines: Vec<f64> =
            (0..=rows).map(|j| ops::sin_cos_degrees(180.0 * j as f64 / half_turn as f64).1).collect();
        let mut weights = Vec::with_capacity(columns * rows);
        let mut irradiance = [0.0; 6];
        // Where the middle of a column lies.
        let around: Vec<DVec3> = (0..columns)
            .map(|i| {
                let (s, c) = ops::sin_cos_degrees(360.0 * (i + 1) as f64 / columns as f64);
                x * s - z * c
            })
            .collect();
        let mut angles = Vec::with_capacity(rows);
        for j in 0..rows {
            let band = cosines[j] - cosines[j + 1];
            let up = 0.5 * (cosines[j] + cosines[j + 1]);
            let out = (1.0 - up * up).sqrt();
            angles.push(band * (2.0 * std::f64::consts::PI / columns as f64));
            for (i, around) in around.iter().enumerate() {
                let weight = radiance(i, j) * band * (2.0 * std::f64::consts::PI / columns as f64);
                weights.push(weight);
                let d = (*around * out + y * up) * weight;
                for (axis, v) in [d.x, d.y, d.z].into_iter().enumerate() {
                    irradiance[2 * axis + usize::from(v < 0.0)] += v.abs();
                }
            }
        }
        let total: f64 = weights.iter().sum();
        // A quarter of the mean over all sides: between six directions a small sun must not be forgotten.
        let irradiance = irradiance.map(|v: f64| (0.75 * v + 0.0625 * total) as f32);
        if is_compensated {
            compensate(&mut weights, &angles, columns);
        }
        let most = weights.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        let relative: Vec<f32> = weights.iter().map(|w| (w / most) as f32).collect();
        // Rows are bands between two edges, and columns lie half of one beyond their place.
        let direction = |across: f64, down: f64| {
            let at = down * rows as f64;
            let row = (at as usize).min(rows - 1);
            let up = cosines[row] + (cosines[row + 1] - cosines[row]) * (at - row as f64);
            let (s, c) = ops::sin_cos_degrees(360.0 * (across + 0.5 / columns as f64));
            (x * s - z * c) * (1.0 - up * up).abs().sqrt() + y * up
        };
        let facing = Facing::new([columns, rows], &relative, direction);
        let band = |c: &[f64]| 2.0 * std::f64::consts::PI * (c[0] - c[1]) * rows as f64;
        let bands = cosines.windows(2).map(band).collect();
        let axes = [x, y, z].map(DVec3::as_vec3);
        Self { columns, rows, half_turn, facing, cosines, bands, axes, total, irradiance }
    }

    /// Draws directions by `u` in [0, 1)², for surfaces of unit normals, or any way where these are zero.
    #[inline(always)]
    pub fn draw<F: Float>(&self, u: [F; 2], n: Vec3<F>) -> Option<Drawn<F>> {
        let facing = self.facing.as_ref()?;
        // Compiled once, not for each way to read colours.
        Some(F::vectorize(
            #[inline(always)]
            || self.draw_by(facing, u, n),
        ))
    }

    #[inline(always)]
    fn draw_by<F: Float>(&self, facing: &Facing, u: [F; 2], n: Vec3<F>) -> Drawn<F> {
        let cell = facing.samples(u, n);
        let (column, row) = (cell.column, cell.row);
        let next = row.wrapping_add(F::Uint::splat(1));
        let (above, below) = (entries::<F>(&self.cosines, row), entries::<F>(&self.cosines, next));
        let cos = above + (below - above) * cell.down;
        let rows = std::f64::consts::FRAC_1_PI * self.half_turn as f64;
        let y = ops::acos_d(cos) * rows - F::from_uint(row).to_double();
        let turned = (F::from_uint(column).to_double() + 0.5 + cell.across) * 360.0 / self.columns as f64;
        let (s, c) = ops::sin_cos_two_turns(turned);
        let sin = (F::Double::ONE - cos * cos).abs().sqrt();
        let [ax, ay, az] = &self.axes;
        let (ax, ay, az) =
            (DVec3::uniform(ax.as_dvec3()), DVec3::uniform(ay.as_dvec3()), DVec3::uniform(az.as_dvec3()));
        let (wi, is_direction) = (ax * (sin * s) + ay * cos - az * (sin * c)).normalize_checked();
        let y = ops::clamp(F::from_double(y), F::ZERO, F::ONE);
        let place = Place { column, row, x: F::from_double(cell.across), y };
        let pdf = self.density(cell.pdf, row);
        Drawn { wi: Vec3::from_double(wi), is_direction, place, pdf }
    }

    /// The density by solid angle with which directions in these cells are drawn.
    #[inline(always)]
    pub fn pdf<F: Float>(&self, place: &Place<F>, n: Vec3<F>) -> F {
        let Some(facing) = &self.facing else { return F::ZERO };
        self.density(facing.pdfs([place.column, place.row], n), place.row)
    }

    /// A density over the unit square, in a row of cells, as density by solid angle: the square's equal
    /// rows are bands of solid angle 2 pi times a difference of cosines.
    #[inline(always)]
    fn density<F: Float>(&self, over_square: F, row: F::Uint) -> F {
        F::from_double(over_square.to_double() / entries::<F>(&self.bands, row))
    }

    /// Where a direction lies; one below the last row as if it lay at that row's end.
    #[inline(always)]
    pub fn place<F: Float>(&self, wi: Vec3<F>) -> Place<F> {
        F::vectorize(
            #[inline(always)]
            || self.place_of(wi),
        )
    }

    #[inline(always)]
    fn place_of<F: Float>(&self, wi: Vec3<F>) -> Place<F> {
        use std::f32::consts::FRAC_1_PI;
        let [x, y, z] = &self.axes;
        let (x, y, z) = (Vec3::uniform(*x).dot(wi), Vec3::uniform(*y).dot(wi), Vec3::uniform(*z).dot(wi));
        // In cells. The polar angle by its tangent: near the poles the cosine has lost it.
        let across = ops::atan2(x, -z) * (0.5 * FRAC_1_PI) * self.columns as f32 - 0.5;
        let down = ops::atan2((x * x + z * z).sqrt(), y) * FRAC_1_PI * self.half_turn as f32;
        let left = across.floor();
        let row = down.to_uint().min(F::Uint::splat(self.rows as u32 - 1));
        // From half a turn to the left of the middle: once around for what lies there.
        let column = left.to_int();
        let around = column.wrapping_add(F::Uint::splat(self.columns as u32));
        Place {
            column: F::Uint::select(column.lt_signed(F::Uint::splat(0)), around, column),
            row,
            x: across - left,
            y: ops::clamp(down - F::from_uint(row), F::ZERO, F::ONE),
        }
    }
}

/// MIS compensation (Karlík, Šik, Vévoda, Skřivan and Křivánek 2019): what BSDF sampling finds by itself, taken as the mean radiance, is taken off what light
/// sampling looks for. A small part of the density stays, so that light is found by sampling lights alone as well.
fn compensate(weights: &mut [f64], angles: &[f64], columns: usize) {
    let (all, sum): (f64, f64) = (angles.iter().sum::<f64>() * columns as f64, weights.iter().sum());
    let mean = sum / all;
    for (row, angle) in weights.chunks_mut(columns).zip(angles) {
        for weight in row {
            let (above, floor) = (*weight - mean * angle, FLOOR * *weight);
            *weight = if above > floor { above } else { floor };
        }
    }
}

/// Those of a list with these numbers.
#[inline(always)]
fn entries<F: Float>(list: &[f64], index: F::Uint) -> F::Double {
    let index = index.to_array();
    F::Double::from_fn(
        #[inline(always)]
        |i| list[index.as_ref()[i] as usize],
    )
}
