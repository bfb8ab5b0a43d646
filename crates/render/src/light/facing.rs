//! Cells of a picture all around, drawn in proportion to what they bring to a surface that faces some way.
//!
//! Half of a sky lies behind any surface, and most of the rest comes in at a slant. The picture's cells are joined to blocks, some
//! eleven degrees wide. For each of 81 normals, and for the case that none is known, a table has the blocks by their light times the
//! cosine; within a block, cells are drawn by their light alone, from a table of the block's own. So what is drawn is near the product of
//! light and cosine, with tables that don't grow with the picture. The density is that of the same normal's table, exactly.
//!
//! A block that any surface facing the way of its normal's part of the sphere may see has a share, if it shines.

use straal_math::table::Table2;
use straal_math::{DVec3, Vec3};

/// Blocks across and down, at most.
const ACROSS: usize = 32;
const DOWN: usize = 16;

/// Normals a side of the square onto which the sphere is unfolded; odd, so that the axes are among them.
const SIDE: usize = 9;

/// The part of a block's share that goes by whether it can be seen at all, rather than by the mean cosine of its middle.
const SURE: f64 = 0.1;

/// The tables.
#[derive(Clone, Debug)]
pub(super) struct Facing {
    /// Cells across and down.
    cells: [usize; 2],
    /// Blocks across and down.
    blocks: [usize; 2],
    /// By normal, then that for none.
    chosen: Vec<Table2>,
    /// By block, row by row; `None` where it is black.
    within: Vec<Option<Table2>>,
}

/// A cell, a place in it, and the density over the unit square of all cells.
pub(super) struct Drawn {
    pub column: usize,
    pub row: usize,
    /// In [0, 1).
    pub across: f64,
    pub down: f64,
    pub pdf: f32,
}

impl Facing {
    /// Bytes of the tables by normals, and of the blocks' own beside their cells: a block's cell in the tables takes at most eight and a half.
    pub const BYTES: usize = (SIDE * SIDE + 1) * ACROSS * DOWN * 17 / 2 + ACROSS * DOWN * size_of::<Table2>();

    /// For `weights` of cells, row by row; `direction` tells where the place (across, down) of the unit square lies in the world, a unit
    /// vector. `None` where all is black.
    pub fn new(
        [width, height]: [usize; 2],
        weights: &[f32],
        direction: impl Fn(f64, f64) -> DVec3,
    ) -> Option<Self> {
        let blocks = [width.min(ACROSS), height.min(DOWN)];
        let mut sums = vec![0.0_f64; blocks[0] * blocks[1]];
        let mut within = Vec::with_capacity(sums.len());
        let mut seen = Vec::with_capacity(sums.len());
        for y in 0..blocks[1] {
            for x in 0..blocks[0] {
                let (columns, rows) = (range(x, blocks[0], width), range(y, blocks[1], height));
                let mut own = Vec::with_capacity(columns.len() * rows.len());
                for row in rows.clone() {
                    own.extend_from_slice(&weights[row * width..][columns.clone()]);
                }
                sums[y * blocks[0] + x] = own.iter().map(|w| f64::from(*w)).sum();
                within.push(Table2::new(columns.len(), rows.len(), &own));
                let part = |k: f64, r: &std::ops::Range<usize>, of: usize| {
                    (r.start as f64 + k * r.len() as f64) / of as f64
                };
                seen.push(Block::new(|u, v| direction(part(u, &columns, width), part(v, &rows, height))));
            }
        }
        let most = sums.iter().copied().fold(0.0, |a: f64, b| if b > a { b } else { a });
        if most <= 0.0 {
            return None;
        }
        let table = |share: &dyn Fn(&Block) -> f64| {
            let share = |(sum, block): (&f64, &Block)| (sum / most * share(block)) as f32;
            Table2::new(blocks[0], blocks[1], &sums.iter().zip(&seen).map(share).collect::<Vec<f32>>())
        };
        let any = table(&|_| 1.0)?;
        // Where all that a surface sees is black nothing is drawn that isn't.
        let facing =
            |i: usize| table(&|block| block.share(normal(i), spread(i))).unwrap_or_else(|| any.clone());
        let mut chosen: Vec<Table2> = (0..SIDE * SIDE).map(facing).collect();
        chosen.push(any);
        Some(Self { cells: [width, height], blocks, chosen, within })
    }

    /// Draws a cell and a place in it by `u` in [0, 1)², for a surface of a unit normal, or any way where that is zero.
    #[inline]
    pub fn sample(&self, u: [f32; 2], n: Vec3) -> Option<Drawn> {
        let block = self.chosen[index(n)].sample(u);
        let [x, y] = block.texel;
        let rest = [0, 1].map(|k| rest(block.uv[k], self.blocks[k], block.texel[k]));
        let table = self.within[y * self.blocks[0] + x].as_ref()?;
        let cell = table.sample(rest.map(|v| below_one(v as f32)));
        let size = table.size();
        let [across, down] = [0, 1].map(|k| self::rest(cell.uv[k], size[k], cell.texel[k]));
        Some(Drawn {
            column: range(x, self.blocks[0], self.cells[0]).start + cell.texel[0],
            row: range(y, self.blocks[1], self.cells[1]).start + cell.texel[1],
            across,
            down,
            pdf: self.density(block.pdf, cell.pdf, size),
        })
    }

    /// The density over the unit square of all cells with which that cell is drawn.
    #[inline]
    pub fn pdf(&self, [column, row]: [usize; 2], n: Vec3) -> f32 {
        let x = column * self.blocks[0] / self.cells[0];
        let y = row * self.blocks[1] / self.cells[1];
        let Some(table) = &self.within[y * self.blocks[0] + x] else { return 0.0 };
        let first =
            [range(x, self.blocks[0], self.cells[0]).start, range(y, self.blocks[1], self.cells[1]).start];
        let cell = table.texel_pdf([column - first[0], row - first[1]]);
        self.density(self.chosen[index(n)].texel_pdf([x, y]), cell, table.size())
    }

    /// From densities over the squares of the blocks and of the cells of one of them.
    #[inline]
    fn density(&self, of_block: f32, of_cell: f32, size: [usize; 2]) -> f32 {
        let share = |all: usize, part: usize| all as f32 / part as f32;
        let blocks = self.blocks[0] * self.blocks[1];
        of_block * of_cell * share(self.cells[0] * self.cells[1], blocks * size[0] * size[1])
    }
}

/// Cells of a block along an axis: those whose index times blocks over cells, rounded down, is the block's.
#[inline]
fn range(block: usize, blocks: usize, cells: usize) -> std::ops::Range<usize> {
    (block * cells).div_ceil(blocks)..((block + 1) * cells).div_ceil(blocks)
}

/// What is left of a place, times how many there are, beyond the one that it lies in: in [0, 1].
#[inline]
fn rest(uv: f32, count: usize, index: usize) -> f64 {
    let rest = f64::from(uv) * count as f64 - index as f64;
    if rest > 0.0 { if rest < 1.0 { rest } else { 1.0 } } else { 0.0 }
}

#[inline]
fn below_one(v: f32) -> f32 {
    if v < 1.0 { v } else { 1.0 - f32::EPSILON / 2.0 }
}

/// Where a block lies.
struct Block {
    /// Places in it.
    places: [DVec3; 9],
    /// Cosine and sine of an angle around its middle beyond which none of it lies.
    reach: [f64; 2],
}

impl Block {
    /// `place` has it over the unit square.
    fn new(place: impl Fn(f64, f64) -> DVec3) -> Self {
        let at = |k: usize, of: f64| k as f64 / of;
        let places = std::array::from_fn(|i| place(at(2 * (i % 3) + 1, 6.0), at(2 * (i / 3) + 1, 6.0)));
        let middle: DVec3 = places[4];
        // The farthest of its rim, and as much again as lies between two places of the rim.
        let mut farthest = 1.0;
        let mut gap = 1.0;
        let rim = |i: usize| match (i / 8, at(i % 8, 8.0)) {
            (0, k) => place(k, 0.0),
            (1, k) => place(1.0, k),
            (2, k) => place(1.0 - k, 1.0),
            (_, k) => place(0.0, 1.0 - k),
        };
        for i in 0..32 {
            let (a, b) = (rim(i), rim((i + 1) % 32));
            farthest = least(farthest, middle.dot(a));
            gap = least(gap, a.dot(b));
        }
        // A block that reaches around the sphere has no middle.
        let reach = if gap > 0.9 && farthest > 0.0 { plus(pair(farthest), pair(gap)) } else { [-1.0, 0.0] };
        Self { places, reach }
    }

    /// Of the light of this block, the part that counts for a surface whose normal is within an angle around `n`.
    fn share(&self, n: DVec3, spread: [f64; 2]) -> f64 {
        // It is seen if its middle is within 90 degrees, its own reach and the normal's spread of `n`.
        let [cos, sin] = plus(self.reach, spread);
        let wide = cos <= 0.0 || sin < 0.0;
        let up = n.dot(self.places[4]);
        if !wide && up < -sin {
            return 0.0;
        }
        let mean =
            self.places.iter().map(|d| n.dot(*d)).map(|c| if c > 0.0 { c } else { 0.0 }).sum::<f64>() / 9.0;
        SURE + (1.0 - SURE) * mean
    }
}

fn least(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// Cosine and sine of an angle up to 180 degrees, by its cosine.
fn pair(cos: f64) -> [f64; 2] {
    let cos = if cos > 1.0 { 1.0 } else { cos };
    [cos, (1.0 - cos * cos).sqrt()]
}

/// Those of the sum of two angles.
fn plus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]]
}

/// The octahedral map (Meyer et al. 2010): where on the unfolded square a normal lies, as the nearest of the normals there; the last for zero.
#[inline]
fn index(n: Vec3) -> usize {
    let sum = n.x.abs() + n.y.abs() + n.z.abs();
    if sum.is_nan() || sum <= 0.0 {
        return SIDE * SIDE;
    }
    let (mut u, mut v) = (n.x / sum, n.z / sum);
    if n.y < 0.0 {
        (u, v) = ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v));
    }
    let place = |v: f32| ((v * 0.5 + 0.5) * SIDE as f32) as usize;
    place(u).min(SIDE - 1) + SIDE * place(v).min(SIDE - 1)
}

/// A place of the unfolded square, in [-1, 1]², as a unit vector.
fn unfolded(u: f64, v: f64) -> DVec3 {
    let y = 1.0 - u.abs() - v.abs();
    let (x, z) = if y < 0.0 { ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)) } else { (u, v) };
    DVec3::new(x, y, z).normalize()
}

/// Where a part of the square begins.
fn edge(k: usize) -> f64 {
    2.0 * k as f64 / SIDE as f64 - 1.0
}

/// The normal in the middle of its part of the square.
fn normal(i: usize) -> DVec3 {
    let middle = |k: usize| 0.5 * (edge(k) + edge(k + 1));
    unfolded(middle(i % SIDE), middle(i / SIDE))
}

/// Cosine and sine of the widest angle between that and others of its part.
fn spread(i: usize) -> [f64; 2] {
    let (n, x, y) = (normal(i), i % SIDE, i / SIDE);
    let corners = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
    let cosines = corners.map(|(x, y)| n.dot(unfolded(edge(x), edge(y))));
    // A hair wider, for those between corners and for rounding.
    pair(cosines.into_iter().fold(1.0, least) - 0.01)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::tests::Rng;

    #[test]
    fn a_normal_is_within_the_spread_of_its_part() {
        let mut rng = Rng(3);
        let axes = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
        for n in axes.into_iter().chain((0..20_000).map(|_| rng.direction())) {
            let i = index(n);
            let cos = normal(i).dot(n.as_dvec3());
            assert!(cos >= spread(i)[0] && cos > 0.9, "{n:?} is {cos} from {:?}", normal(i));
        }
        for n in [Vec3::X, -Vec3::X, Vec3::Z, Vec3::Y] {
            assert!(normal(index(n)).dot(n.as_dvec3()) > 0.97);
        }
        assert!(normal(index(Vec3::Y)).dot(DVec3::Y) > 1.0 - 1e-12);
        assert_eq!(index(Vec3::ZERO), SIDE * SIDE);
    }
}
