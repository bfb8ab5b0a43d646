//! Cells of a picture all around, drawn in proportion to what they bring to a surface that faces some way.
//!
//! Half of a sky lies behind any surface, and most of the rest comes in at a slant. The picture's cells are joined to blocks, some
//! eleven degrees wide. For each of 81 normals, and for the case that none is known, a table has the blocks by their light times the
//! cosine; within a block, cells are drawn by their light alone, from a table of the block's own. So what is drawn is near the product of
//! light and cosine, with tables that don't grow with the picture. The density is that of the same normal's table, exactly.
//!
//! A block that any surface facing the way of its normal's part of the sphere may see has a share, if it shines.

use straal_math::simd::{Double, Float, Uint};
use straal_math::table::{Table2, Tables2};
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
    chosen: Tables2,
    /// By block, row by row; of a single cell where it is black.
    within: Tables2,
    /// Where each block's cells begin, across and down.
    starts: [Vec<u32>; 2],
    /// In which block a cell lies, across and down.
    owners: [Vec<u32>; 2],
}

/// Cells, places in them, and the densities over the unit square of all cells.
pub(super) struct Drawn<F: Float> {
    pub column: F::Uint,
    pub row: F::Uint,
    /// In [0, 1].
    pub across: F::Double,
    pub down: F::Double,
    pub pdf: F,
}

impl Facing {
    /// Bytes of the tables by normals, and of the blocks' own beside their cells: a block's cell in the tables takes at most eight and a half.
    pub const BYTES: usize =
        (SIDE * SIDE + 1) * ACROSS * DOWN * 17 / 2 + (ACROSS * DOWN + SIDE * SIDE + 1) * Tables2::BYTES;

    /// For `weights` of cells, row by row; `direction` tells where the place (across, down) of the unit square lies in the world, a unit
    /// vector. `None` where all is black.
    pub fn new(
        [width, height]: [usize; 2],
        weights: &[f32],
        direction: impl Fn(f64, f64) -> DVec3,
    ) -> Option<Self> {
        if width.max(height) >= 1 << 24 {
            return None;
        }
        let blocks = [width.min(ACROSS), height.min(DOWN)];
        let mut sums = vec![0.0_f64; blocks[0] * blocks[1]];
        let mut within = Tables2::with_room((width + blocks[0]) * (height + 2 * blocks[1]));
        let black = Table2::new(1, 1, &[1.0])?;
        let mut seen = Vec::with_capacity(sums.len());
        for y in 0..blocks[1] {
            for x in 0..blocks[0] {
                let (columns, rows) = (range(x, blocks[0], width), range(y, blocks[1], height));
                let mut own = Vec::with_capacity(columns.len() * rows.len());
                for row in rows.clone() {
                    own.extend_from_slice(&weights[row * width..][columns.clone()]);
                }
                sums[y * blocks[0] + x] = own.iter().map(|w| f64::from(*w)).sum();
                within.push(Table2::new(columns.len(), rows.len(), &own).as_ref().unwrap_or(&black))?;
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
        let mut chosen = Tables2::with_room((SIDE * SIDE + 1) * (blocks[0] + 1) * (blocks[1] + 1));
        for i in 0..SIDE * SIDE {
            let facing = table(&|block| block.share(normal(i), spread(i)));
            chosen.push(facing.as_ref().unwrap_or(&any))?;
        }
        chosen.push(&any)?;
        let starts = [0, 1].map(|k| {
            (0..blocks[k]).map(|block| range(block, blocks[k], [width, height][k]).start as u32).collect()
        });
        let owners = [0, 1].map(|k| {
            let cells = [width, height][k];
            (0..cells).map(|cell| (cell * blocks[k] / cells) as u32).collect()
        });
        Some(Self { cells: [width, height], blocks, chosen, within, starts, owners })
    }

    /// Draws a cell and a place in it by `u` in [0, 1)², for a surface of a unit normal, or any way where that is zero. For many such
    /// surfaces side by side.
    #[inline(always)]
    pub fn samples<F: Float>(&self, u: [F; 2], n: Vec3<F>) -> Drawn<F> {
        let (block, blocks) = self.chosen.samples(index(n), u);
        let [x, y] = block.texel;
        let left = [rest::<F>(block.uv[0], blocks[0], x), rest::<F>(block.uv[1], blocks[1], y)];
        let left = [below_one(F::from_double(left[0])), below_one(F::from_double(left[1]))];
        let (cell, size) = self.within.samples(y.wrapping_mul(blocks[0]).wrapping_add(x), left);
        Drawn {
            column: F::Uint::gather(&self.starts[0], x).wrapping_add(cell.texel[0]),
            row: F::Uint::gather(&self.starts[1], y).wrapping_add(cell.texel[1]),
            across: rest::<F>(cell.uv[0], size[0], cell.texel[0]),
            down: rest::<F>(cell.uv[1], size[1], cell.texel[1]),
            pdf: self.density(block.pdf, cell.pdf, size),
        }
    }

    /// The densities over the unit square of all cells with which these cells are drawn.
    #[inline(always)]
    pub fn pdfs<F: Float>(&self, [column, row]: [F::Uint; 2], n: Vec3<F>) -> F {
        let (x, y) = (F::Uint::gather(&self.owners[0], column), F::Uint::gather(&self.owners[1], row));
        let first = [F::Uint::gather(&self.starts[0], x), F::Uint::gather(&self.starts[1], y)];
        let (block, blocks): (F, _) = self.chosen.texel_pdfs(index(n), [x, y]);
        let within = y.wrapping_mul(blocks[0]).wrapping_add(x);
        let (cell, size) =
            self.within.texel_pdfs(within, [column.wrapping_sub(first[0]), row.wrapping_sub(first[1])]);
        // A black block has no cell but the first; it is never chosen.
        F::select(block.gt(F::ZERO), self.density(block, cell, size), F::ZERO)
    }

    /// From densities over the squares of the blocks and of the cells of one of them.
    #[inline(always)]
    fn density<F: Float>(&self, of_block: F, of_cell: F, size: [F::Uint; 2]) -> F {
        let all = F::splat((self.cells[0] * self.cells[1]) as f32);
        let blocks = F::Uint::splat((self.blocks[0] * self.blocks[1]) as u32);
        of_block * of_cell * (all / F::from_uint(blocks.wrapping_mul(size[0]).wrapping_mul(size[1])))
    }
}

/// Cells of a block along an axis: those whose index times blocks over cells, rounded down, is the block's.
#[inline]
fn range(block: usize, blocks: usize, cells: usize) -> std::ops::Range<usize> {
    (block * cells).div_ceil(blocks)..((block + 1) * cells).div_ceil(blocks)
}

/// What is left of a place, times how many there are, beyond the one that it lies in: in [0, 1].
#[inline(always)]
fn rest<F: Float>(uv: F, count: F::Uint, index: F::Uint) -> F::Double {
    // Both are below 2^24 (see `Facing::new`): single precision holds them.
    let rest = uv.to_double() * F::from_uint(count).to_double() - F::from_uint(index).to_double();
    rest.max(F::Double::ZERO).min(F::Double::ONE)
}

#[inline(always)]
fn below_one<F: Float>(v: F) -> F {
    v.min(F::splat(1.0 - f32::EPSILON / 2.0))
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
#[inline(always)]
fn index<F: Float>(n: Vec3<F>) -> F::Uint {
    let sum = n.x.abs() + n.y.abs() + n.z.abs();
    let (u, v) = (n.x / sum, n.z / sum);
    let below = n.y.lt(F::ZERO);
    let (u, v) = (
        F::select(below, (F::ONE - v.abs()).copysign(u), u),
        F::select(below, (F::ONE - u.abs()).copysign(v), v),
    );
    let part = place(u).wrapping_add(place(v).wrapping_mul(F::Uint::splat(SIDE as u32)));
    F::Uint::select(sum.gt(F::ZERO), part, F::Uint::splat((SIDE * SIDE) as u32))
}

/// The part of a side of the square where a place lies.
#[inline(always)]
fn place<F: Float>(v: F) -> F::Uint {
    ((v * 0.5 + 0.5) * SIDE as f32).to_uint().min(F::Uint::splat(SIDE as u32 - 1))
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
            let i = index(n) as usize;
            let cos = normal(i).dot(n.as_dvec3());
            assert!(cos >= spread(i)[0] && cos > 0.9, "{n:?} is {cos} from {:?}", normal(i));
        }
        for n in [Vec3::X, -Vec3::X, Vec3::Z, Vec3::Y] {
            assert!(normal(index(n) as usize).dot(n.as_dvec3()) > 0.97);
        }
        assert!(normal(index(Vec3::Y) as usize).dot(DVec3::Y) > 1.0 - 1e-12);
        assert_eq!(index(Vec3::ZERO) as usize, SIDE * SIDE);
    }
}
