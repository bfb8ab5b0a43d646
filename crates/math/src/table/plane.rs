//! Cells of a grid by their weights: one table, and many of one size side by side.

use super::*;

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
