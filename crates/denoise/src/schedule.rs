//! Which rows of which tensor are computed when, so that only a few are in memory.
//!
//! The network is run over the whole picture from top to bottom, in bands of rows. For a band of the result each layer computes the rows
//! that are needed for it and weren't computed before; rows that no later band reads are overwritten. So no pixel is computed twice, as overlapping tiles do, and
//! memory grows with the width of the picture but not with its height.

use crate::convolution::{LEFT, RIGHT};
use crate::network::{ALIGNMENT, Network, Reads, Shape};
use std::ops::Range;
use straal_math::simd::Block;

/// Rows of the picture: where they are computed, and how many of each tensor are kept.
pub(crate) struct Schedule {
    /// For each band and each tensor: which rows are computed.
    pub bands: Vec<Vec<Range<usize>>>,
    /// For each tensor: how many rows are in memory at once.
    pub kept: Vec<usize>,
    /// For each tensor.
    pub sizes: Vec<Size>,
}

/// Width, height and channels of a tensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub width: usize,
    pub height: usize,
    pub shape: Shape,
}

impl Size {
    /// Pixels from one block of channels to the next.
    pub fn pitch(&self) -> usize {
        LEFT + self.width + RIGHT
    }
}

impl Schedule {
    /// For a picture of that size, in bands of so many rows, which is made a multiple of 16.
    pub fn new(network: &Network, width: usize, height: usize, band: usize) -> Self {
        let [width, height] = [width, height].map(|v| v.next_multiple_of(ALIGNMENT));
        let band = band.clamp(1, height.max(1)).next_multiple_of(ALIGNMENT);
        let sizes: Vec<Size> = { network.shapes.iter() }
            .map(|shape| Size { width: width >> shape.level, height: height >> shape.level, shape: *shape })
            .collect();
        let mut made = vec![0; sizes.len()];
        let mut kept = made.clone();
        let mut bands = Vec::new();
        for end in (0..height).step_by(band).map(|start| (start + band).min(height)) {
            let mut ends = made.clone();
            ends[sizes.len() - 1] = end;
            for (k, layer) in network.layers.iter().enumerate().rev() {
                let ends_at = ends[k + 1];
                for (tensor, range) in layer.reads_of(&(ends_at.saturating_sub(1)..ends_at), &sizes) {
                    ends[tensor] = ends[tensor].max(range.end);
                }
            }
            let rows: Vec<_> = made.iter().zip(&ends).map(|(start, end)| *start..*end).collect();
            let mut oldest = ends.clone();
            for (k, layer) in network.layers.iter().enumerate() {
                for (tensor, range) in layer.reads_of(&rows[k + 1], &sizes) {
                    oldest[tensor] = oldest[tensor].min(range.start);
                }
            }
            for (tensor, kept) in kept.iter_mut().enumerate() {
                *kept = (*kept).max(ends[tensor] - oldest[tensor].min(rows[tensor].start));
            }
            made = ends;
            bands.push(rows);
        }
        // The result goes to the picture.
        kept.pop();
        Self { bands, kept, sizes }
    }

    /// Bytes of the rows that are in memory at once.
    pub fn bytes(&self) -> usize {
        let tensors = self.kept.iter().zip(&self.sizes);
        tensors.map(|(kept, s)| kept * s.pitch() * s.shape.blocks() * size_of::<Block<f32>>()).sum()
    }
}

impl crate::network::Layer {
    /// Which rows of which tensors it reads for these rows of its own.
    fn reads_of(&self, rows: &Range<usize>, sizes: &[Size]) -> Vec<(usize, Range<usize>)> {
        let of = |tensor: usize, start: usize, end: usize| {
            let height = sizes[tensor].height;
            (tensor, start.min(height)..end.min(height))
        };
        let pooled = if self.pools { 2 } else { 1 };
        let (start, end) = (rows.start * pooled, rows.end * pooled);
        match self.reads {
            Reads::Plain(from) => vec![of(from, start.saturating_sub(1), end + 1)],
            Reads::Up { below, beside } => vec![
                of(below, start.saturating_sub(1) / 2, end / 2 + 1),
                of(beside, start.saturating_sub(1), end + 1),
            ],
        }
    }
}
