//! Choosing in proportion to weights: piecewise constant distributions over a list and over a grid.
//!
//! Probabilities are whole multiples of 2^-24, the step of a random number (see [`crate::lowdisc`]). So what is
//! drawn has exactly the probability that is told, nothing of probability 0 is ever drawn, and, in lists of up
//! to eight million, every weight above 0 has at least one step. Tables are built in double precision and fixed
//! order.
//!
//! A table is asked for one number or for many side by side ([`crate::simd`]), of which each gets what it would get alone.

use crate::ops;
use crate::simd::{Float, Mask, Uint};

/// Steps of probability: the resolution of a random number in [0, 1).
const STEPS: u32 = 1 << 24;
/// One step.
const STEP: f32 = 1.0 / STEPS as f32;
/// The greatest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// A choice from a list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Which.
    pub index: usize,
    /// Its probability.
    pub pmf: f32,
    /// What the number that chose has left, again even in [0, 1): log2(1/pmf) bits poorer.
    pub rest: f32,
}

/// Choices from a list, one in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Choices<F: Float> {
    /// Which.
    pub index: F::Uint,
    /// Their probabilities.
    pub pmf: F,
    /// What the numbers that chose have left, as [`Choice::rest`].
    pub rest: F,
}

/// A distribution over a list, or piecewise constant over [0, 1).
#[derive(Clone, Debug, PartialEq)]
pub struct Table1 {
    /// Steps before each entry; one longer than the list.
    cdf: Vec<u32>,
    guide: Vec<u32>,
}

impl Table1 {
    /// Bytes that an entry takes: its steps, and its place in the guide.
    pub const BYTES: usize = 2 * size_of::<u32>();

    /// A table of weights, where negative, infinite and NaN ones count as 0. `None` if nothing is left to choose.
    pub fn new(weights: &[f32]) -> Option<Self> {
        let mut cdf = vec![0; weights.len() + 1];
        let total = total(weights);
        if total <= 0.0 || weights.len() >= u32::MAX as usize {
            return None;
        }
        fill(&mut cdf, weights, total);
        let mut guide = vec![0; guide_len(weights.len())];
        fill_guide(&mut guide, &cdf);
        Some(Self { cdf, guide })
    }

    /// How many entries there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.cdf.len() - 1
    }

    /// Never: a table with nothing in it isn't made.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Chooses by `u` in [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> Choice {
        let Choices { index, pmf, rest } = self.samples(u);
        Choice { index: index as usize, pmf, rest }
    }

    /// As [`Self::sample`], in each lane.
    #[inline(always)]
    pub fn samples<F: Float>(&self, u: F) -> Choices<F> {
        self.whole().choose(List::among(F::Uint::splat(0), self.len(), self.guide.len()), u)
    }

    #[inline(always)]
    fn whole(&self) -> Lists<'_> {
        Lists { cdfs: &self.cdf, guides: &self.guide }
    }

    /// The probability of an entry; 0 beyond the list.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        if index < self.len() { self.pmfs(index as u32) } else { 0.0 }
    }

    /// As [`Self::pmf`], in each lane.
    #[inline(always)]
    pub fn pmfs<F: Float>(&self, index: F::Uint) -> F {
        let pmf = self.whole().pmf(F::Uint::splat(0), index);
        F::select(index.lt(F::Uint::splat(self.len() as u32)), pmf, F::ZERO)
    }

    /// The number that [`Self::sample`] turns into this entry and rest, but for rounding.
    #[inline]
    pub fn invert(&self, index: usize, rest: f32) -> f32 {
        invert(&self.cdf, index, rest)
    }
}

/// A point drawn from a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point2 {
    /// In [0, 1)²: u across, v along rows.
    pub uv: [f32; 2],
    /// Column and row.
    pub texel: [usize; 2],
    /// Density over the unit square.
    pub pdf: f32,
}

/// Points drawn from a grid, one in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Points2<F: Float> {
    /// In [0, 1)²: u across, v along rows.
    pub uv: [F; 2],
    /// Column and row.
    pub texel: [F::Uint; 2],
    /// Density over the unit square.
    pub pdf: F,
}

/// A distribution over the unit square, constant within each texel of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Table2 {
    width: usize,
    rows: Table1,
    /// For each row as in [`Table1`], one after the other.
    cdfs: Vec<u32>,
    guides: Vec<u32>,
}

impl Table2 {
    /// A grid of weights, row by row; as [`Table1::new`]. `None` also if `weights` isn't of `width` times `height`,
    /// and for grids of four thousand million texels, which indices of 32 bits don't reach.
    pub fn new(width: usize, height: usize, weights: &[f32]) -> Option<Self> {
        if width.checked_mul(height)? != weights.len() || weights.is_empty() {
            return None;
        }
        u32::try_from(width.checked_add(1)?.checked_mul(height)?).ok()?;
        let totals: Vec<f64> = weights.chunks_exact(width).map(total).collect();
        // Scaled, so that a row's total fits single precision.
        let most = totals.iter().copied().fold(0.0, |m: f64, t| if t > m { t } else { m });
        let scaled: Vec<f32> =
            totals.iter().map(|&t| if t > 0.0 { keep_above_zero(t / most) } else { 0.0 }).collect();
        let rows = Table1::new(&scaled)?;
        let guide_len = guide_len(width);
        let mut cdfs = vec![0; (width + 1) * height];
        let mut guides = vec![0; guide_len * height];
        let per_row = cdfs.chunks_exact_mut(width + 1).zip(guides.chunks_exact_mut(guide_len));
        for ((cdf, guide), (row, &total)) in per_row.zip(weights.chunks_exact(width).zip(&totals)) {
            if total > 0.0 {
                fill(cdf, row, total);
                fill_guide(guide, cdf);
            }
        }
        Some(Self { width, rows, cdfs, guides })
    }

    /// Columns and rows.
    #[inline]
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.rows.len()]
    }

    /// Draws a point by `u` in [0, 1)²: the second number chooses the row.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Point2 {
        let Points2 { uv, texel, pdf } = self.samples(u);
        Point2 { uv, texel: texel.map(|i| i as usize), pdf }
    }

    /// As [`Self::sample`], in each lane.
    #[inline(always)]
    pub fn samples<F: Float>(&self, u: [F; 2]) -> Points2<F> {
        let row = self.rows.samples(u[1]);
        let list = List::among(row.index, self.width, guide_len(self.width));
        let column = self.lists().choose(list, u[0]);
        let [width, height] = self.size().map(|n| F::Uint::splat(n as u32));
        Points2 {
            uv: [place(column, width), place(row, height)],
            texel: [column.index, row.index],
            pdf: self.density(column.pmf, row.pmf),
        }
    }

    /// The density at a point of the unit square, 0 outside; or at many.
    #[inline(always)]
    pub fn pdf<F: Float>(&self, uv: [F; 2]) -> F {
        let (across, x) = texel_of(uv[0], F::Uint::splat(self.width as u32));
        let (along, y) = texel_of(uv[1], F::Uint::splat(self.rows.len() as u32));
        F::select(across & along, self.texel_pdfs([x, y]), F::ZERO)
    }

    /// The density within a texel (column, row), 0 outside of the grid.
    #[inline]
    pub fn texel_pdf(&self, texel: [usize; 2]) -> f32 {
        if texel[0] >= self.width || texel[1] >= self.rows.len() {
            return 0.0;
        }
        self.texel_pdfs(texel.map(|i| i as u32))
    }

    /// As [`Self::texel_pdf`], in each lane.
    #[inline(always)]
    pub fn texel_pdfs<F: Float>(&self, texel: [F::Uint; 2]) -> F {
        let start = texel[1].wrapping_mul(F::Uint::splat(self.width as u32 + 1));
        let pdf = self.density(self.lists().pmf(start, texel[0]), self.rows.pmfs(texel[1]));
        let [width, height] = self.size();
        let within = texel[0].lt(F::Uint::splat(width as u32)) & texel[1].lt(F::Uint::splat(height as u32));
        F::select(within, pdf, F::ZERO)
    }

    /// The numbers that [`Self::sample`] turns into this point, but for rounding; `None` outside of the square and
    /// where the density is 0.
    pub fn invert(&self, uv: [f32; 2]) -> Option<[f32; 2]> {
        let (across, x) = texel_of(uv[0], self.width as u32);
        let (along, y) = texel_of(uv[1], self.rows.len() as u32);
        if !(across && along) {
            return None;
        }
        let [x, y] = [x, y].map(|i| i as usize);
        if self.texel_pdf([x, y]) == 0.0 {
            return None;
        }
        let rest = |v: f32, n: usize, i: usize| v * n as f32 - i as f32;
        Some([
            invert(self.cdf(y), x, rest(uv[0], self.width, x)),
            self.rows.invert(y, rest(uv[1], self.rows.len(), y)),
        ])
    }

    #[inline(always)]
    fn cdf(&self, row: usize) -> &[u32] {
        &self.cdfs[row * (self.width + 1)..(row + 1) * (self.width + 1)]
    }

    /// All rows.
    #[inline(always)]
    fn lists(&self) -> Lists<'_> {
        Lists { cdfs: &self.cdfs, guides: &self.guides }
    }

    #[inline(always)]
    fn density<F: Float>(&self, column_pmf: F, row_pmf: F) -> F {
        (column_pmf * self.width as f32) * (row_pmf * self.rows.len() as f32)
    }
}

/// Several grids, of which each lane asks one.
#[derive(Clone, Debug, Default)]
pub struct Tables2 {
    /// Of each grid its rows as a list, then its rows one by one, as in [`Table1`].
    cdfs: Vec<u32>,
    guides: Vec<u32>,
    /// Eight numbers for each grid, see [`Grids`]: their bits, in rows that are brought to lanes by exchanges between registers.
    grids: Vec<[[f32; 4]; 2]>,
}

/// The grids that lanes ask.
struct Grids<F: Float> {
    /// Columns and rows.
    size: [F::Uint; 2],
    /// The list that chooses a row.
    rows: List<F::Uint>,
    /// The first row.
    cells: List<F::Uint>,
}

impl Tables2 {
    /// Bytes that a grid takes beside its cells, which take as many as those of a [`Table1`].
    pub const BYTES: usize = size_of::<[u32; 8]>();

    /// None yet, but room for grids of so many cells in all.
    pub fn with_room(cells: usize) -> Self {
        Self { cdfs: Vec::with_capacity(cells), guides: Vec::with_capacity(cells / 2), grids: Vec::new() }
    }

    /// Adds one; `None` where all of them have more cells than indices of 31 bits reach.
    pub fn push(&mut self, table: &Table2) -> Option<()> {
        let index = |n: usize| i32::try_from(n).ok().map(|n| n as u32);
        let (start, guide) = (index(self.cdfs.len())?, index(self.guides.len())?);
        self.cdfs.extend_from_slice(&table.rows.cdf);
        self.guides.extend_from_slice(&table.rows.guide);
        let (cells, cells_guide) = (index(self.cdfs.len())?, index(self.guides.len())?);
        self.cdfs.extend_from_slice(&table.cdfs);
        self.guides.extend_from_slice(&table.guides);
        index(self.cdfs.len())?;
        let [width, height] = table.size().map(|n| n as u32);
        let shift = |guide_len: usize| 24 - guide_len.trailing_zeros();
        let shifts = [shift(table.rows.guide.len()), shift(guide_len(table.width))];
        let rows = [[start, guide, cells, cells_guide], [width, height, shifts[0], shifts[1]]];
        self.grids.push(rows.map(|row| row.map(f32::from_bits)));
        Some(())
    }

    /// Draws a point of a grid by `u` in [0, 1)², as [`Table2::samples`]; and tells the grid's columns and rows.
    #[inline(always)]
    pub fn samples<F: Float>(&self, grid: F::Uint, u: [F; 2]) -> (Points2<F>, [F::Uint; 2]) {
        let Grids { size: [width, height], rows, cells } = self.grids::<F>(grid);
        let lists = Lists { cdfs: &self.cdfs, guides: &self.guides };
        let row = lists.choose(rows, u[1]);
        let one = F::Uint::splat(1);
        let guide_len = one.shl_each(F::Uint::splat(24).wrapping_sub(cells.shift));
        let column = lists.choose(
            List {
                start: cells.start.wrapping_add(row.index.wrapping_mul(width.wrapping_add(one))),
                guide: cells.guide.wrapping_add(row.index.wrapping_mul(guide_len)),
                ..cells
            },
            u[0],
        );
        let points = Points2 {
            uv: [place(column, width), place(row, height)],
            texel: [column.index, row.index],
            pdf: (column.pmf * F::from_uint(width)) * (row.pmf * F::from_uint(height)),
        };
        (points, [width, height])
    }

    /// The density within a texel (column, row) of a grid, as [`Table2::texel_pdfs`], and the grid's columns and rows. The texel is one
    /// of the grid's.
    #[inline(always)]
    pub fn texel_pdfs<F: Float>(&self, grid: F::Uint, [x, y]: [F::Uint; 2]) -> (F, [F::Uint; 2]) {
        let Grids { size: [width, height], rows, cells } = self.grids::<F>(grid);
        let lists = Lists { cdfs: &self.cdfs, guides: &self.guides };
        let row = cells.start.wrapping_add(y.wrapping_mul(width.wrapping_add(F::Uint::splat(1))));
        let (column_pmf, row_pmf): (F, F) = (lists.pmf(row, x), lists.pmf(rows.start, y));
        ((column_pmf * F::from_uint(width)) * (row_pmf * F::from_uint(height)), [width, height])
    }

    #[inline(always)]
    fn row(&self, grid: u32) -> [[f32; 4]; 2] {
        self.grids.get(grid as usize).copied().unwrap_or_default()
    }

    #[inline(always)]
    fn grids<F: Float>(&self, grid: F::Uint) -> Grids<F> {
        let grid = grid.to_array();
        let [start, guide, cells, cells_guide] = F::from_rows(
            #[inline(always)]
            |i| self.row(grid.as_ref()[i])[0],
        );
        let [width, height, row_shift, shift] = F::from_rows(
            #[inline(always)]
            |i| self.row(grid.as_ref()[i])[1],
        );
        let [start, guide] = [start.to_bits(), guide.to_bits()];
        let [cells, cells_guide] = [cells.to_bits(), cells_guide.to_bits()];
        let [width, height] = [width.to_bits(), height.to_bits()];
        let [row_shift, shift] = [row_shift.to_bits(), shift.to_bits()];
        Grids {
            size: [width, height],
            rows: List { start, guide, len: height, shift: row_shift },
            cells: List { start: cells, guide: cells_guide, len: width, shift },
        }
    }
}

/// Sum of the weights that count.
fn total(weights: &[f32]) -> f64 {
    weights.iter().map(|&w| counted(w)).sum()
}

#[inline(always)]
fn counted(weight: f32) -> f64 {
    if weight > 0.0 && weight < f32::INFINITY { f64::from(weight) } else { 0.0 }
}

/// Rounded to single precision, but not to 0.
fn keep_above_zero(x: f64) -> f32 {
    let rounded = x as f32;
    if rounded > 0.0 { rounded } else { f32::MIN_POSITIVE }
}

/// Shares the steps out. Each weight above 0 gets one as long as that leaves half of them, the rest go in
/// proportion, by rounding the running sum.
fn fill(cdf: &mut [u32], weights: &[f32], total: f64) {
    let chosen = weights.iter().filter(|&&w| counted(w) > 0.0).count();
    let each = if chosen <= STEPS as usize / 2 { 1 } else { 0 };
    let shared = f64::from(STEPS) - (each as usize * chosen) as f64;
    let (mut sum, mut given) = (0.0, 0);
    let mut last = 0;
    for (i, &weight) in weights.iter().enumerate() {
        if counted(weight) > 0.0 {
            sum += counted(weight);
            given += each;
            last = i;
        }
        // A running sum can't pass the total: both add the same numbers in the same order.
        cdf[i + 1] = given + (shared * (sum / total)) as u32;
    }
    // Should division have left the quotient a hair below 1, the last weight gets the step.
    cdf[last + 1..].fill(STEPS);
}

/// A guide has a power of two of buckets, about one for two entries.
fn guide_len(entries: usize) -> usize {
    (entries / 2).next_power_of_two().clamp(1, STEPS as usize)
}

/// For each bucket, an equal part of all steps, the entry that its first step belongs to.
fn fill_guide(guide: &mut [u32], cdf: &[u32]) {
    let shift = 24 - guide.len().trailing_zeros();
    let mut entry = 0;
    for (bucket, first) in guide.iter_mut().enumerate() {
        let step = (bucket as u32) << shift;
        while cdf[entry + 1] <= step {
            entry += 1;
        }
        *first = entry as u32;
    }
}

#[inline(always)]
fn width(cdf: &[u32], index: usize) -> u32 {
    cdf[index + 1] - cdf[index]
}

/// Lists one after the other, of which each lane asks one.
#[derive(Clone, Copy)]
struct Lists<'a> {
    /// Of each list one more than it has entries.
    cdfs: &'a [u32],
    guides: &'a [u32],
}

/// Which list a lane asks.
#[derive(Clone, Copy)]
struct List<U> {
    /// Where it begins in `cdfs`.
    start: U,
    /// Where it begins in `guides`.
    guide: U,
    /// Its entries.
    len: U,
    /// Of a step, how far it is shifted down to its bucket in the guide, of which there are as many as 24 less this tells bits.
    shift: U,
}

impl<U: Uint> List<U> {
    /// Number `list` of lists of the same length.
    #[inline(always)]
    fn among(list: U, len: usize, guide_len: usize) -> Self {
        Self {
            start: list.wrapping_mul(U::splat(len as u32 + 1)),
            guide: list.wrapping_mul(U::splat(guide_len as u32)),
            len: U::splat(len as u32),
            shift: U::splat(24 - guide_len.trailing_zeros()),
        }
    }
}

impl Lists<'_> {
    /// The probability of an entry of the list that starts at `start`.
    #[inline(always)]
    fn pmf<F: Float>(&self, start: F::Uint, index: F::Uint) -> F {
        let at = start.wrapping_add(index);
        let next = F::Uint::gather(self.cdfs, at.wrapping_add(F::Uint::splat(1)));
        F::from_int(next.wrapping_sub(F::Uint::gather(self.cdfs, at))) * STEP
    }

    #[inline(always)]
    fn choose<F: Float>(&self, list: List<F::Uint>, u: F) -> Choices<F> {
        let one = F::Uint::splat(1);
        // Exact: a power of two times u. What isn't in [0, 1) lands at the nearer end.
        let scaled = ops::clamp(u, F::ZERO, F::splat(BELOW_ONE)) * STEPS as f32;
        let step = scaled.to_int();
        let bucket = step.shr_each(list.shift);
        let at = list.guide.wrapping_add(bucket);
        let is_last = F::Uint::splat(STEPS - 1).shr_each(list.shift).eq(bucket);
        let last = list.len.wrapping_sub(one);
        let mut low = F::Uint::gather(self.guides, at);
        let mut high = F::Uint::select(is_last, last, F::Uint::gather(self.guides, at.wrapping_add(one)));
        // The entry is in low..=high: the last whose steps begin at or before this one.
        loop {
            let is_open = low.lt(high);
            if !is_open.any() {
                break;
            }
            // Lanes that have found it stay there.
            let middle = low.wrapping_add(high.wrapping_sub(low).wrapping_add(one) >> 1);
            let begins = F::Uint::gather(self.cdfs, list.start.wrapping_add(middle)).le(step);
            low = F::Uint::select(is_open & begins, middle, low);
            high = F::Uint::select(is_open & !begins, middle.wrapping_sub(one), high);
        }
        let at = list.start.wrapping_add(low);
        let first = F::Uint::gather(self.cdfs, at);
        let width = F::Uint::gather(self.cdfs, at.wrapping_add(one)).wrapping_sub(first);
        let width = F::from_int(width);
        let rest = (scaled - F::from_int(first)) / width;
        Choices { index: low, pmf: width * STEP, rest: rest.min(F::splat(BELOW_ONE)) }
    }
}

#[inline(always)]
fn invert(cdf: &[u32], index: usize, rest: f32) -> f32 {
    let u = (cdf[index] as f32 + rest * width(cdf, index) as f32) * STEP;
    if u < BELOW_ONE { u } else { BELOW_ONE }
}

/// A chosen cell and what is left as a coordinate, kept within the cell whatever the rounding.
#[inline(always)]
fn place<F: Float>(choice: Choices<F>, cells: F::Uint) -> F {
    let v = (F::from_uint(choice.index) + choice.rest) / F::from_uint(cells);
    let (inside, cell) = texel_of(v, cells);
    // Else it was rounded up into the next cell.
    let below = F::from_bits(v.to_bits().wrapping_sub(F::Uint::splat(1)));
    F::select(inside & cell.eq(choice.index), v, below)
}

/// Whether a coordinate is in [0, 1), and its cell.
#[inline(always)]
fn texel_of<F: Float>(v: F, cells: F::Uint) -> (F::Mask, F::Uint) {
    let cell = (v * F::from_uint(cells)).to_uint().min(cells.wrapping_sub(F::Uint::splat(1)));
    (v.ge(F::ZERO) & v.lt(F::ONE), cell)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Isa, Kernel, Simd};

    /// Points of grids by their numbers, with what densities are told of them.
    struct Draws<'a>(&'a Tables2, &'a [u32], &'a [[f32; 2]]);

    impl Kernel for Draws<'_> {
        type Output = Vec<(Point2, f32, [usize; 2])>;

        #[inline(always)]
        fn run<F: Float>(self) -> Self::Output {
            let mut all = vec![];
            for first in (0..self.1.len()).step_by(F::WIDTH) {
                let grid = F::Uint::load(&self.1[first..]);
                let u = [0, 1].map(|k| F::from_fn(|i| self.2[first + i][k]));
                let (points, size) = self.0.samples(grid, u);
                let (told, same_size): (F, _) = self.0.texel_pdfs(grid, points.texel);
                for i in 0..F::WIDTH {
                    let point = Point2 {
                        uv: points.uv.map(|v| v.lane(i)),
                        texel: points.texel.map(|v| v.lane(i) as usize),
                        pdf: points.pdf.lane(i),
                    };
                    let size = size.map(|n| n.lane(i) as usize);
                    assert_eq!(size, same_size.map(|n| n.lane(i) as usize));
                    all.push((point, told.lane(i), size));
                }
            }
            all
        }
    }

    #[test]
    fn several_grids_are_drawn_from_as_each_alone() {
        let grids: Vec<Table2> = [[1, 1], [3, 5], [32, 16], [31, 2], [1, 9]]
            .into_iter()
            .map(|[w, h]| {
                let weight = |i: usize| if i % 7 == 3 { 0.0 } else { (i % 5) as f32 + 0.1 };
                Table2::new(w, h, &(0..w * h).map(weight).collect::<Vec<_>>()).unwrap()
            })
            .collect();
        let mut all = Tables2::with_room(700);
        grids.iter().for_each(|grid| all.push(grid).unwrap());
        let asked: Vec<u32> = (0..320).map(|i| i % 5).collect();
        let u: Vec<[f32; 2]> =
            (0..320).map(|i| [(i * 37 % 320) as f32 / 320.0, (i * 91 % 320) as f32 / 320.0]).collect();
        for simd in Isa::ALL.into_iter().filter_map(Simd::new) {
            for (i, (point, told, size)) in simd.run(Draws(&all, &asked, &u)).into_iter().enumerate() {
                let grid = &grids[asked[i] as usize];
                assert_eq!((point, size), (grid.sample(u[i]), grid.size()), "{simd:?}");
                assert_eq!(told, grid.texel_pdf(point.texel), "{simd:?}");
            }
        }
    }

    #[test]
    fn probabilities_are_what_is_drawn() {
        let weights = [0.0, 3.0, 0.0, 1e-30, 5.0, f32::NAN, 0.5, -2.0, f32::INFINITY, 0.0];
        let table = Table1::new(&weights).unwrap();
        let mut steps = [0_u32; 10];
        for k in 0..STEPS {
            let c = table.sample(k as f32 * STEP);
            steps[c.index] += 1;
            assert!((0.0..1.0).contains(&c.rest));
        }
        for (i, &w) in weights.iter().enumerate() {
            assert_eq!(table.pmf(i), steps[i] as f32 * STEP);
            assert_eq!(counted(w) > 0.0, steps[i] > 0);
            assert!((f64::from(table.pmf(i)) - counted(w) / 8.5).abs() < 3e-7);
        }
        assert_eq!(table.pmf(10), 0.0);
    }

    #[test]
    fn what_is_left_is_even_again() {
        let table = Table1::new(&[1.0, 2.0, 5.0]).unwrap();
        let n = 1 << 16;
        let mut sums = [0.0; 3];
        for k in 0..n {
            let u = (k as f32 + 0.5) / n as f32;
            let c = table.sample(u);
            sums[c.index] += f64::from(c.rest);
            assert!((table.invert(c.index, c.rest) - u).abs() < 2.0 * STEP);
        }
        for (i, sum) in sums.iter().enumerate() {
            let mean = sum / (f64::from(n) * f64::from(table.pmf(i)));
            assert!((mean - 0.5).abs() < 1e-3, "{mean}");
        }
    }

    #[test]
    fn nothing_to_choose_is_no_table() {
        assert_eq!(Table1::new(&[]), None);
        assert_eq!(Table1::new(&[0.0, -1.0, f32::NAN, f32::INFINITY]), None);
        assert_eq!(Table2::new(0, 0, &[]), None);
        assert_eq!(Table2::new(2, 2, &[1.0; 3]), None);
        assert_eq!(Table2::new(usize::MAX, 2, &[1.0; 3]), None);
        assert_eq!(Table2::new(2, 2, &[0.0; 4]), None);
        assert!(Table1::new(&[1.0; 1]).is_some_and(|t| t.sample(0.7).pmf == 1.0 && !t.is_empty()));
    }

    #[test]
    fn long_lists_keep_every_weight() {
        let n = 100_003;
        let weights: Vec<f32> =
            (0..n).map(|i| if i == 777 { 1e20 } else { 1.0 / (1.0 + i as f32) }).collect();
        let table = Table1::new(&weights).unwrap();
        assert_eq!(table.len(), n);
        let sum: f64 = (0..n).map(|i| f64::from(table.pmf(i))).sum();
        assert_eq!(sum, 1.0);
        for i in 0..n {
            assert!(table.pmf(i) >= STEP);
            assert_eq!(table.sample(table.invert(i, 0.0)).index, i);
        }
        // Numbers beyond their range choose an end instead of reading past it.
        assert_eq!(table.sample(1.5).index, n - 1);
        assert_eq!(table.sample(f32::NAN).index, 0);
    }

    #[test]
    fn grids_draw_by_their_density() {
        let (w, h) = (37, 19);
        let weights: Vec<f32> = (0..w * h)
            .map(|i| match (i % w, i / w) {
                (_, 4) | (3, _) => 0.0,
                (20, 10) => 1e6,
                (x, y) => 1e-35 * (1 + x * y) as f32,
            })
            .collect();
        let table = Table2::new(w, h, &weights).unwrap();
        assert_eq!(table.size(), [w, h]);
        let mut integral = 0.0;
        for y in 0..h {
            for x in 0..w {
                let pdf = table.texel_pdf([x, y]);
                assert_eq!(pdf > 0.0, weights[y * w + x] > 0.0);
                let centre = [(x as f32 + 0.5) / w as f32, (y as f32 + 0.5) / h as f32];
                assert_eq!(table.pdf(centre), pdf);
                integral += f64::from(pdf) / (w * h) as f64;
                assert_eq!(table.invert(centre).is_some(), pdf > 0.0);
            }
        }
        assert!((integral - 1.0).abs() < 1e-6);
        for k in 0..200_000_u32 {
            let u =
                [0.754_877_7, 0.569_840_3].map(|a: f64| ((f64::from(k) * a).fract() as f32).min(BELOW_ONE));
            let p = table.sample(u);
            assert!(p.pdf > 0.0 && p.pdf == table.pdf(p.uv) && p.pdf == table.texel_pdf(p.texel));
            let back = table.invert(p.uv).unwrap();
            let cell = [20.5 / w as f32, 10.5 / h as f32];
            let tolerance = if p.pdf == table.pdf(cell) { 1e-4 } else { 1.0 };
            assert!((back[0] - u[0]).abs() < tolerance && (back[1] - u[1]).abs() < tolerance);
        }
        assert_eq!(table.pdf([1.0, 0.5]), 0.0);
        assert_eq!(table.pdf([f32::NAN, 0.5]), 0.0);
    }

    #[test]
    fn even_grids_give_points_back() {
        let table = Table2::new(16, 8, &[2.0; 128]).unwrap();
        for u in [[0.0, 0.0], [0.3, 0.7], [BELOW_ONE, BELOW_ONE]] {
            let p = table.sample(u);
            assert!((p.uv[0] - u[0]).abs() < 1e-6 && (p.uv[1] - u[1]).abs() < 1e-6);
            assert!((p.pdf - 1.0).abs() < 1e-5);
        }
    }
}
