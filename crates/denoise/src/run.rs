//! A picture through the network.

use crate::convolution::{Convolution, LEFT, Make, Rows};
use crate::network::{Layer, Network, Reads};
use crate::schedule::{Schedule, Size};
use crate::transfer::{self, Transfer};
use crate::{DenoiseError, GuideRows};
use rayon::prelude::*;
use std::ops::Range;
use straal_math::simd::{BLOCK, Block, Float, Kernel, Simd};

/// The rows of a tensor that are in memory: row y lies at y modulo their number.
#[derive(Default)]
struct Ring {
    rows: Vec<Vec<Block<f32>>>,
}

/// A picture on its way.
pub(crate) struct Run<'a> {
    pub network: &'a Network,
    /// Pixels of a row of the picture.
    pub width: usize,
    /// Its rows.
    pub height: usize,
    pub transfer: Transfer,
    pub simd: Simd,
    pub schedule: Schedule,
}

impl Run<'_> {
    /// All bands. `guides` is asked for rows, from the top, each once; clean rows take the places of noisy ones, which the network has taken in long before. `done` is told
    /// how many of them there are, and may end it by `false`.
    pub fn run<'g, E: From<DenoiseError>>(
        &self,
        color: &mut [[f32; 3]],
        mut guides: impl FnMut(Range<usize>) -> Result<GuideRows<'g>, E>,
        mut done: impl FnMut(usize) -> bool,
    ) -> Result<(), E> {
        let sizes = &self.schedule.sizes;
        let mut rings: Vec<Ring> = { self.schedule.kept.iter().zip(sizes) }
            .map(|(kept, size)| {
                let row = vec![Block::default(); size.pitch() * size.shape.blocks()];
                Ring { rows: vec![row; *kept] }
            })
            .collect();
        let widest = sizes.iter().map(|s| s.pitch() * s.shape.blocks()).max();
        let zeros = vec![Block::default(); widest.unwrap_or(0)];
        let last = self.network.layers.len();
        for band in &self.schedule.bands {
            let inside = band[0].start.min(self.height)..band[0].end.min(self.height);
            let guides = if inside.is_empty() { GuideRows::default() } else { guides(inside.clone())? };
            check_rows(self.network, &guides, (inside.end - inside.start) * self.width)?;
            self.enter(&mut rings[0], &band[0], color, &guides);
            for (k, layer) in self.network.layers[..last - 1].iter().enumerate() {
                let mut ring = std::mem::take(&mut rings[k + 1]);
                self.layer(layer, &rings, &zeros, &mut ring, &band[k + 1], sizes[k + 1]);
                rings[k + 1] = ring;
            }
            self.leave(&self.network.layers[last - 1], &rings, &zeros, &band[last], color);
            if !done(band[last].end.min(self.height)) {
                return Err(DenoiseError::Ended.into());
            }
        }
        Ok(())
    }

    /// What the network sees of rows of the picture; zeros beyond it. The guides are of these rows.
    fn enter(&self, ring: &mut Ring, rows: &Range<usize>, color: &[[f32; 3]], guides: &GuideRows<'_>) {
        let (width, height) = (self.width, self.height);
        each_row(ring, rows).into_par_iter().for_each(|(y, out)| {
            if y >= height {
                return out.fill(Block::default());
            }
            let row = |y: usize| y * width..y * width + width;
            let own = row(y - rows.start);
            let out = &mut out[LEFT..LEFT + width];
            let see = Sees::Signal(self.transfer);
            self.simd.run(Enter { from: &color[row(y)], see, first: 0, out });
            if let Some(albedo) = &guides.albedo {
                self.simd.run(Enter { from: &albedo[own.clone()], see: Sees::Albedo, first: 3, out });
            }
            if let Some(normal) = &guides.normal {
                let first = if guides.albedo.is_some() { 6 } else { 3 };
                self.simd.run(Enter { from: &normal[own], see: Sees::Normal, first, out });
            }
        });
    }

    /// Rows of a layer that isn't the last.
    fn layer(
        &self,
        layer: &Layer,
        rings: &[Ring],
        zeros: &[Block<f32>],
        ring: &mut Ring,
        rows: &Range<usize>,
        size: Size,
    ) {
        let pitch = size.pitch();
        let items: Vec<_> = each_row(ring, rows)
            .into_iter()
            .flat_map(|(y, row)| row.chunks_mut(2 * pitch).enumerate().map(move |(k, out)| (y, 2 * k, out)))
            .collect();
        let row = |tensor: usize, y: usize| self.row(rings, zeros, tensor, y);
        items.into_par_iter().for_each(|(y, block, out)| {
            let convolve = |make, out| {
                self.simd.run(Convolution { make, weights: &layer.weights, block, out, pitch });
            };
            // Rows are counted from 1, so that 0 is the row of zeros above the first.
            match layer.reads {
                Reads::Plain(from) if layer.pools => {
                    let rows: [_; 4] = std::array::from_fn(|k| row(from, 2 * y + k));
                    let make = [self.rows(from, &rows[..3]), self.rows(from, &rows[1..])];
                    convolve(Make::Pooled(make), out);
                }
                Reads::Plain(from) => {
                    let rows: [_; 3] = std::array::from_fn(|k| row(from, y + k));
                    convolve(Make::Row(self.rows(from, &rows)), out);
                }
                Reads::Up { below, beside } => {
                    let (parity, first) = (y & 1, y.div_ceil(2));
                    let low: [_; 2] = std::array::from_fn(|k| row(below, first + k));
                    let own: [_; 3] = std::array::from_fn(|k| row(beside, y + k));
                    let (below, beside) = (self.rows(below, &low), self.rows(beside, &own));
                    convolve(Make::Raised { below, beside, parity }, out);
                }
            }
        });
    }

    /// Rows of the last layer, as light.
    fn leave(
        &self,
        layer: &Layer,
        rings: &[Ring],
        zeros: &[Block<f32>],
        rows: &Range<usize>,
        out: &mut [[f32; 3]],
    ) {
        let Reads::Plain(from) = layer.reads else { return };
        let (width, height) = (self.width, self.height);
        let pitch = self.schedule.sizes[from].pitch();
        let (start, end) = (rows.start.min(height), rows.end.min(height));
        let out = out[start * width..end * width].par_chunks_mut(width);
        out.zip(start..end).for_each(|(out, y)| {
            let own: [_; 3] = std::array::from_fn(|k| self.row(rings, zeros, from, y + k));
            let mut sums = vec![Block::default(); pitch];
            let make = Make::Last(self.rows(from, &own));
            let weights = &layer.weights;
            self.simd.run(Convolution { make, weights, block: 0, out: &mut sums, pitch });
            let bias = layer.weights.bias[0].0;
            self.simd.run(Leave { sums: &sums, bias, transfer: self.transfer, out });
        });
    }

    /// A row of a tensor, where 1 is the first; zeros beyond.
    fn row<'a>(
        &self,
        rings: &'a [Ring],
        zeros: &'a [Block<f32>],
        tensor: usize,
        y: usize,
    ) -> &'a [Block<f32>] {
        let rows = &rings[tensor].rows;
        let is_inside = (1..=self.schedule.sizes[tensor].height).contains(&y);
        if is_inside { &rows[(y - 1) % rows.len()] } else { zeros }
    }

    fn rows<'a>(&self, tensor: usize, rows: &'a [&'a [Block<f32>]]) -> Rows<'a> {
        let size = self.schedule.sizes[tensor];
        Rows { rows, channels: size.shape.channels, pitch: size.pitch() }
    }
}

/// The memory of each of these rows, with its number.
fn each_row<'a>(ring: &'a mut Ring, rows: &Range<usize>) -> Vec<(usize, &'a mut [Block<f32>])> {
    let kept = ring.rows.len();
    let mut out: Vec<_> = { ring.rows.iter_mut().enumerate() }
        .filter_map(|(slot, row)| {
            // The first row from `rows.start` on that lies in this slot.
            let y = rows.start + (slot + kept - rows.start % kept) % kept;
            (y < rows.end).then_some((y, &mut row[..]))
        })
        .collect();
    out.sort_unstable_by_key(|(y, _)| *y);
    out
}

/// Whether there are as many guides as the network sees, of as many pixels.
fn check_rows(network: &Network, guides: &GuideRows<'_>, wanted: usize) -> Result<(), DenoiseError> {
    if wanted == 0 {
        return Ok(());
    }
    network.check([guides.albedo.is_some(), guides.normal.is_some()])?;
    for (layer, rows) in [("albedo", &guides.albedo), ("normals", &guides.normal)] {
        if let Some(rows) = rows.as_ref().filter(|rows| rows.len() != wanted) {
            return Err(DenoiseError::Rows { layer, pixels: rows.len(), wanted });
        }
    }
    Ok(())
}

/// What becomes of numbers on their way into the network.
#[derive(Clone, Copy)]
enum Sees {
    Signal(Transfer),
    Albedo,
    Normal,
}

/// Three numbers of each pixel of a row into three channels.
struct Enter<'a> {
    from: &'a [[f32; 3]],
    see: Sees,
    /// The first of the channels.
    first: usize,
    out: &'a mut [Block<f32>],
}

impl Kernel for Enter<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        for (from, out) in self.from.chunks(BLOCK).zip(self.out.chunks_mut(BLOCK)) {
            for c in 0..3 {
                let mut lanes = Block::<f32>::default();
                for (lane, pixel) in lanes.0.iter_mut().zip(from) {
                    *lane = pixel[c];
                }
                let mut at = 0;
                while at < BLOCK {
                    let x = F::load(&lanes.0[at..]);
                    let seen = match self.see {
                        Sees::Signal(transfer) => transfer.forward(x),
                        Sees::Albedo => transfer::albedo(x),
                        Sees::Normal => transfer::normal(x),
                    };
                    seen.store(&mut lanes.0[at..]);
                    at += F::WIDTH;
                }
                for (lane, out) in lanes.0.iter().zip(&mut *out) {
                    out.0[self.first + c] = *lane;
                }
            }
        }
    }
}

/// The sums of the last layer, columns added up, as light.
struct Leave<'a> {
    sums: &'a [Block<f32>],
    bias: [f32; BLOCK],
    transfer: Transfer,
    out: &'a mut [[f32; 3]],
}

impl Kernel for Leave<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        for (k, out) in self.out.chunks_mut(BLOCK).enumerate() {
            for c in 0..3 {
                let mut lanes = Block::<f32>::default();
                for (lane, sums) in lanes.0[..out.len()].iter_mut().zip(self.sums[k * BLOCK..].windows(3)) {
                    *lane = self.bias[c] + ((sums[0].0[c] + sums[1].0[3 + c]) + sums[2].0[6 + c]);
                }
                let mut at = 0;
                while at < BLOCK {
                    self.transfer.inverse(F::load(&lanes.0[at..])).store(&mut lanes.0[at..]);
                    at += F::WIDTH;
                }
                for (lane, out) in lanes.0.iter().zip(&mut *out) {
                    out[c] = *lane;
                }
            }
        }
    }
}
