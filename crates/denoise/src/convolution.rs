//! The convolution: where all the time goes.
//!
//! Channels stand in blocks of sixteen, side by side in memory, so that a vector holds some output channels of one pixel. A few vectors
//! of a few neighbouring pixels are summed at once in registers: each weight that is loaded serves all of these pixels, and each input number all of these channels.
//! Every output number is the bias, plus input times weight by fused multiply-adds in the order of the weights, whichever pixels
//! are computed with it: so it has the same bits for any width of vectors, any tile and any number of threads.

// Iterators aren't inlined for sure, and what isn't inlined is compiled without the instruction set.
#![allow(clippy::needless_range_loop)]

use crate::network::Weights;
use straal_math::simd::{BLOCK, Block, Float, Kernel};

/// Pixels of zeros to the left of a row of pixels.
pub(crate) const LEFT: usize = 1;
/// Pixels of zeros to the right: one for the rim, one because every other pixel is read in pairs.
pub(crate) const RIGHT: usize = 2;

/// Rows of a tensor under the weights: by block of channels, then pixel, with zeros left and right.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    /// As many as there are rows of weights.
    pub rows: &'a [&'a [Block<f32>]],
    pub channels: usize,
    /// Pixels from one block of channels to the next, those of zeros among them.
    pub pitch: usize,
}

/// What a convolution of some rows makes of them.
pub(crate) enum Make<'a> {
    /// One row.
    Row(Rows<'a>),
    /// A row of half the width: the greatest of 2x2, of two rows that see these.
    Pooled([Rows<'a>; 2]),
    /// One row of twice the width: of two rows of the level below (`parity` of the row among its copies) and three beside.
    Raised { below: Rows<'a>, beside: Rows<'a>, parity: usize },
    /// One row, in the lanes of [`Weights::of_last`], without bias and with negative numbers.
    Last(Rows<'a>),
}

/// One row of one or two blocks of output channels.
pub(crate) struct Convolution<'a> {
    pub make: Make<'a>,
    pub weights: &'a Weights,
    /// The first block of output channels.
    pub block: usize,
    /// Where they go: as many blocks as it has rows of `pitch` pixels.
    pub out: &'a mut [Block<f32>],
    pub pitch: usize,
}

impl Kernel for Convolution<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { make, weights, mut block, out, pitch } = self;
        if F::WIDTH == BLOCK && out.len() == 2 * pitch {
            return Part::<2> { weights, block, out, pitch }.run::<F, 2, 8>(&make);
        }
        let mut start = 0;
        while start < out.len() {
            let part = Part::<1> { weights, block, out: &mut out[start..start + pitch], pitch };
            match F::WIDTH {
                BLOCK => part.run::<F, 1, 8>(&make),
                8 => part.run::<F, 2, 4>(&make),
                _ => part.run::<F, 16, 2>(&make),
            }
            block += 1;
            start += pitch;
        }
    }
}

/// As many blocks of output channels as are summed at once.
struct Part<'a, const BLOCKS: usize> {
    weights: &'a Weights,
    block: usize,
    out: &'a mut [Block<f32>],
    pitch: usize,
}

/// Sums of some vectors of output channels, for some pixels.
type Sums<F, const VECTORS: usize, const PIXELS: usize> = [[F; PIXELS]; VECTORS];

impl<'a, const BLOCKS: usize> Part<'a, BLOCKS> {
    /// `VECTORS` hold the lanes of the blocks; `PIXELS` are summed at once.
    #[inline(always)]
    fn run<F: Float, const VECTORS: usize, const PIXELS: usize>(mut self, make: &Make<'_>) {
        let width = self.pitch - LEFT - RIGHT;
        // A run of pixels that would end beyond the row starts earlier, and computes some of the pixels before it once more.
        match make {
            Make::Row(_) | Make::Last(_) => {
                let (mut x, wide) = (0, width >= PIXELS);
                while x < width {
                    if wide {
                        self.row::<F, VECTORS, PIXELS>(make, x.min(width - PIXELS));
                    } else {
                        self.row::<F, VECTORS, 1>(make, x);
                    }
                    x += if wide { PIXELS } else { 1 };
                }
            }
            Make::Pooled(rows) => {
                let (mut x, width) = (0, 2 * width);
                let wide = width >= PIXELS;
                while x < width {
                    if wide {
                        self.pooled::<F, VECTORS, PIXELS>(rows, x.min(width - PIXELS));
                    } else {
                        self.pooled::<F, VECTORS, 2>(rows, x);
                    }
                    x += if wide { PIXELS } else { 2 };
                }
            }
            Make::Raised { below, beside, parity } => {
                let (rows, width) = ([below, beside], width / 2);
                let wide = width >= PIXELS;
                let mut column = 0;
                while column < 2 {
                    let mut x = 0;
                    while x < width {
                        if wide {
                            self.raised::<F, VECTORS, PIXELS>(rows, [*parity, column], x.min(width - PIXELS));
                        } else {
                            self.raised::<F, VECTORS, 1>(rows, [*parity, column], x);
                        }
                        x += if wide { PIXELS } else { 1 };
                    }
                    column += 1;
                }
            }
        }
    }

    /// Weights of each block, of a list that is by block.
    #[inline(always)]
    fn of(&self, list: &'a [Block<f32>], blocks: usize) -> [&'a [Block<f32>]; BLOCKS] {
        let each = list.len() / blocks;
        let mut of = [&list[..0]; BLOCKS];
        for b in 0..BLOCKS {
            of[b] = &list[(self.block + b) * each..][..each];
        }
        of
    }

    #[inline(always)]
    fn bias<F: Float, const VECTORS: usize, const PIXELS: usize>(&self) -> Sums<F, VECTORS, PIXELS> {
        let mut sums = [[F::ZERO; PIXELS]; VECTORS];
        for v in 0..VECTORS {
            let (block, lane) = place::<F>(v);
            sums[v] = [F::load(&self.weights.bias[self.block + block].0[lane..]); PIXELS];
        }
        sums
    }

    /// `PIXELS` of a row, the first of which is `x`.
    #[inline(always)]
    fn row<F: Float, const VECTORS: usize, const PIXELS: usize>(&mut self, make: &Make<'_>, x: usize) {
        let (rows, is_last) = match make {
            Make::Row(rows) => (rows, false),
            Make::Last(rows) => (rows, true),
            _ => return,
        };
        let weights = self.of(&self.weights.plain, self.weights.bias.len());
        let (columns, from) = if is_last { (1, LEFT + x) } else { (3, x) };
        let mut sums = if is_last { [[F::ZERO; PIXELS]; VECTORS] } else { self.bias() };
        add::<F, BLOCKS, VECTORS, PIXELS, 1>(&mut sums, rows, columns, from, weights);
        for v in 0..VECTORS {
            let (block, lane) = place::<F>(v);
            let out = &mut self.out[block * self.pitch + LEFT + x..][..PIXELS];
            for p in 0..PIXELS {
                let sum = if is_last { sums[v][p] } else { sums[v][p].max(F::ZERO) };
                sum.store(&mut out[p].0[lane..]);
            }
        }
    }

    /// What `PIXELS` of two rows are pooled to, the first of which is `x`; both are even.
    #[inline(always)]
    fn pooled<F: Float, const VECTORS: usize, const PIXELS: usize>(
        &mut self,
        rows: &[Rows<'_>; 2],
        x: usize,
    ) {
        let weights = self.of(&self.weights.plain, self.weights.bias.len());
        // max(x, 0) of all, then the greatest, is the greatest and 0.
        let mut greatest = [[F::ZERO; PIXELS]; VECTORS];
        for rows in rows {
            let mut sums = self.bias();
            add::<F, BLOCKS, VECTORS, PIXELS, 1>(&mut sums, rows, 3, x, weights);
            for v in 0..VECTORS {
                for p in 0..PIXELS {
                    greatest[v][p] = sums[v][p].max(greatest[v][p]);
                }
            }
        }
        for v in 0..VECTORS {
            let (block, lane) = place::<F>(v);
            let out = &mut self.out[block * self.pitch + LEFT + x / 2..][..PIXELS / 2];
            for p in 0..PIXELS / 2 {
                greatest[v][2 * p].max(greatest[v][2 * p + 1]).store(&mut out[p].0[lane..]);
            }
        }
    }

    /// Every other of 2 `PIXELS`, those of a parity of rows and columns; `x` is the first among the pixels of the level below.
    #[inline(always)]
    fn raised<F: Float, const VECTORS: usize, const PIXELS: usize>(
        &mut self,
        [below, beside]: [&Rows<'_>; 2],
        [row, column]: [usize; 2],
        x: usize,
    ) {
        let blocks = self.weights.bias.len();
        let weights = self.of(&self.weights.below[2 * row + column], blocks);
        let mut sums = self.bias();
        add::<F, BLOCKS, VECTORS, PIXELS, 1>(&mut sums, below, 2, x + column, weights);
        let weights = self.of(&self.weights.plain, blocks);
        add::<F, BLOCKS, VECTORS, PIXELS, 2>(&mut sums, beside, 3, 2 * x + column, weights);
        for v in 0..VECTORS {
            let (block, lane) = place::<F>(v);
            let out = &mut self.out[block * self.pitch + LEFT + 2 * x + column..][..2 * PIXELS - 1];
            for p in 0..PIXELS {
                sums[v][p].max(F::ZERO).store(&mut out[2 * p].0[lane..]);
            }
        }
    }
}

/// The block of a vector of output channels, and its first lane there.
#[inline(always)]
fn place<F: Float>(vector: usize) -> (usize, usize) {
    (vector * F::WIDTH / BLOCK, vector * F::WIDTH % BLOCK)
}

/// Adds the products of rows and weights, for `PIXELS` that are `STEP` apart; the first column of weights lies over pixel `from` of the
/// rows, zeros counted.
#[inline(always)]
fn add<F: Float, const BLOCKS: usize, const VECTORS: usize, const PIXELS: usize, const STEP: usize>(
    sums: &mut Sums<F, VECTORS, PIXELS>,
    rows: &Rows<'_>,
    columns: usize,
    from: usize,
    weights: [&[Block<f32>]; BLOCKS],
) {
    let mut at = 0;
    let mut local = *sums;
    for block in 0..rows.channels.div_ceil(BLOCK) {
        let channels = (rows.channels - block * BLOCK).min(BLOCK);
        for row in rows.rows {
            for column in 0..columns {
                let start = block * rows.pitch + from + column;
                let pixels = row[start..start + PIXELS * STEP].as_chunks::<STEP>().0;
                let Ok(pixels) = <&[[Block<f32>; STEP]; PIXELS]>::try_from(pixels) else { return };
                let mut each = [&weights[0][..0]; BLOCKS];
                for b in 0..BLOCKS {
                    each[b] = &weights[b][at..at + channels];
                }
                at += channels;
                for i in 0..channels {
                    let mut w = [F::ZERO; VECTORS];
                    for v in 0..VECTORS {
                        let (b, lane) = place::<F>(v);
                        w[v] = F::load(&each[b][i].0[lane..]);
                    }
                    for p in 0..PIXELS {
                        let x = F::splat(pixels[p][0].0[i]);
                        for v in 0..VECTORS {
                            local[v][p] = x.mul_add(w[v], local[v][p]);
                        }
                    }
                }
            }
        }
    }
    *sums = local;
}
