//! A film's exact sums as bytes, to be taken up again or put together.
//!
//! [`Record::visit`] is the one list of what a pixel's sums are made of, in the order in which they are written: integers
//! and, for batches, doubles or singles, all little-endian and of fixed size. A film is written pixel by pixel, row by
//! row from the top, whatever its tiles; what several tiles have splatted onto a pixel is added up before.

mod joined;
mod record;

use super::error_estimate::BatchSums;
use super::{Costs, ErrorEstimate, Film, Region, TILE};
pub use joined::Joined;
use record::{Number, Record, for_each_record, parts, take};
use std::io::{self, Read, Write};
use straal_color::spectrum::Bands;

/// What a film holds of each pixel: two films that hold the same can be put together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Held {
    /// Costs of searches, and whether with their time.
    pub costs: Option<bool>,
    /// Bands of wavelengths.
    pub bands: Option<Bands>,
    /// Names of groups of lights whose light is told apart.
    pub light_groups: Vec<String>,
    /// Sums over the samples that a filter reaches.
    pub splats: bool,
    /// Where batches end.
    pub batches: bool,
    /// Squares of light.
    pub squares: bool,
    /// What the other layers are made of.
    pub guides: bool,
    /// Light from paths that are no pixel's own.
    pub light_splats: bool,
    /// Size of the samples' weights where the filter has negative lobes.
    pub weight: Option<f64>,
    /// What pixels whose blocks end by themselves keep of their halves.
    pub halves: bool,
    /// Mean squares of the filter's height by distance in pixels, where samples are splatted.
    pub mean_squares: Vec<f64>,
}

/// A run of samples, and the part of the picture whose sums some bytes hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The part of the picture that is wanted.
    pub crop: Region,
    /// The part that was rendered, with what counts in the crop.
    pub region: Region,
    /// Index of the first sample.
    pub first: u32,
    /// One past that of the last; with noise, of the pixels that have the most.
    pub end: u32,
}

impl Film {
    /// What it holds of each pixel.
    pub fn held(&self) -> Held {
        Held {
            costs: match self.costs {
                Costs::No => None,
                Costs::Tests => Some(false),
                Costs::TestsAndTime => Some(true),
            },
            bands: self.bands,
            light_groups: self.groups.clone(),
            splats: self.tiles.first().is_some_and(|t| t.splats.is_some()),
            batches: self.tiles.first().is_some_and(|t| !t.batch_sums.is_empty() || !t.ends.is_empty()),
            squares: self.keep.squares || self.keep.layers,
            weight: self.tiles.first().filter(|t| !t.controls.is_empty()).map(|t| t.weight),
            halves: self.tiles.first().is_some_and(|t| !t.halves.is_empty()),
            guides: self.keep.layers,
            light_splats: self.tiles.first().is_some_and(|t| !t.light_splats.is_empty()),
            mean_squares: self.mean_squares.clone(),
        }
    }

    /// The part of the picture that is rendered.
    pub fn region(&self) -> Region {
        match (self.tiles.first(), self.tiles.last()) {
            (Some(first), Some(last)) => Region { min: first.region.min, max: last.region.max },
            _ => self.crop,
        }
    }

    /// Index of the first sample.
    pub fn first_sample(&self) -> u32 {
        self.tiles.first().map_or(0, |t| t.first)
    }

    /// Leaves out the samples before `first`: the film is still empty. Where its noise is to be told by batches, these are
    /// kept for who puts it together with the samples before; by itself it tells the spread.
    pub(crate) fn begin_at(&mut self, first: u32) {
        if first == 0 {
            return;
        }
        for tile in &mut self.tiles {
            tile.first = first;
            tile.ends = vec![BatchSums::default(); tile.batch_sums.len()];
            tile.batch_sums = Vec::new();
        }
        self.tell_spread();
    }

    fn tell_spread(&mut self) {
        self.error = self.error.map(|_| ErrorEstimate::Spread);
    }

    /// Writes all sums.
    pub fn write_sums(&self, out: &mut dyn Write) -> io::Result<()> {
        let (held, region) = (self.held(), self.region());
        let mut bytes = Vec::new();
        for y in region.min[1]..region.max[1] {
            bytes.clear();
            for x in region.min[0]..region.max[0] {
                let mut record = self.record([x, y], &held);
                for part in parts(&held, self.first_sample()) {
                    record.visit(part, &held, &mut |number| match number {
                        Number::Sum(v) => bytes.extend(v.to_le_bytes()),
                        Number::Guide(v) => bytes.extend(v.to_le_bytes()),
                        Number::Cost(v) => bytes.extend(v.to_le_bytes()),
                        Number::Count(v) => bytes.extend(v.to_le_bytes()),
                        Number::Flag(v) => bytes.push(*v),
                        Number::Double(v) => bytes.extend(v.to_le_bytes()),
                        Number::Single(v) => bytes.extend(v.to_le_bytes()),
                    });
                }
            }
            out.write_all(&bytes)?;
        }
        Ok(())
    }

    /// Takes up the sums that a film of the same kind has written, in place of its own.
    pub(crate) fn read_sums(
        &mut self,
        input: &mut dyn Read,
        dropped: Option<([u32; 2], u32)>,
    ) -> io::Result<()> {
        let (held, region, first) = (self.held(), self.region(), self.first_sample());
        for y in region.min[1]..region.max[1] {
            for_each_record(input, &held, first, region, |x, bytes| {
                let mut record = Record::empty(&held);
                let mut bytes = bytes;
                for part in parts(&held, first) {
                    record.visit(part, &held, &mut |number| take(number, &mut bytes, |_, new| new));
                }
                self.put([x, y], record);
            })?;
        }
        self.note_dropped(dropped);
        Ok(())
    }

    fn note_dropped(&mut self, dropped: Option<([u32; 2], u32)>) {
        let order = |(p, i): ([u32; 2], u32)| (p[1], p[0], i);
        if let Some(new) = dropped
            && let Some(tile) = self.tiles.iter_mut().find(|t| t.region.contains(new.0))
            && tile.first_dropped.is_none_or(|old| order(new) < order(old))
        {
            tile.first_dropped = Some(new);
        }
    }

    /// Where the tile is that a pixel of the region lies in.
    fn tile_at(&self, [x, y]: [u32; 2]) -> usize {
        let Region { min, max } = self.region();
        let across = max[0].div_ceil(TILE) - min[0] / TILE;
        ((y / TILE - min[1] / TILE) * across + (x / TILE - min[0] / TILE)) as usize
    }

    fn record(&self, pixel: [u32; 2], held: &Held) -> Record {
        let tile = &self.tiles[self.tile_at(pixel)];
        let k = tile.index(pixel);
        let mut record = Record::empty(held);
        let count = record.bands.len();
        record.pixel = tile.pixels[k];
        record.squares = tile.squares.get(k).copied().unwrap_or_default();
        record.channels = tile.channels.iter().flat_map(|plane| plane.record(k)).collect();
        record.light_splats = tile.light_splats.get(k).copied().unwrap_or_default();
        record.ended = tile.ended(pixel);
        record.control = tile.controls.get(k).copied().unwrap_or_default();
        if held.weight.is_some() {
            record.negative_bands.copy_from_slice(&tile.negative_bands[k * count..][..count]);
        }
        record.halves = tile.halves.get(k).copied().unwrap_or_default();
        record.bands.copy_from_slice(&tile.bands[k * count..][..count]);
        let [second, second_negative] = &mut record.second_bands;
        for (own, all) in [
            (&mut record.band_splats, &tile.band_splats),
            (second, &tile.second_bands[0]),
            (second_negative, &tile.second_bands[1]),
        ] {
            let from = all.iter().skip(k * count);
            own.iter_mut().zip(from).for_each(|(own, v)| *own = *v);
        }
        record.batch_sums = tile.batch_sums.get(k).copied().unwrap_or_default();
        record.ends = tile.ends.get(k).copied().unwrap_or_default();
        if let Some(splats) = &tile.splats {
            // Tiles around have splatted here as well.
            let near = Region { min: pixel, max: pixel.map(|p| p + 1) }.grown(splats.reach());
            let near = near.intersection(self.region());
            for y in near.min[1] / TILE..near.max[1].div_ceil(TILE) {
                for x in near.min[0] / TILE..near.max[0].div_ceil(TILE) {
                    let corner = [x * TILE, y * TILE];
                    let inside = [0, 1].map(|a| corner[a].max(near.min[a]));
                    let splats = self.tiles[self.tile_at(inside)].splats.as_ref();
                    if let Some((splat, bands)) = splats.and_then(|s| s.at(pixel)) {
                        record.splat.merge(&splat);
                        record.splat_bands.iter_mut().zip(bands).for_each(|(sum, v)| *sum += *v);
                    }
                }
            }
        }
        record
    }

    /// In place of what is there; other tiles must not have splatted here.
    fn put(&mut self, pixel: [u32; 2], record: Record) {
        let i = self.tile_at(pixel);
        let tile = &mut self.tiles[i];
        let k = tile.index(pixel);
        let count = record.bands.len();
        tile.pixels[k] = record.pixel;
        if let Some(squares) = tile.squares.get_mut(k) {
            *squares = record.squares;
        }
        let mut channels = record.channels.iter().copied();
        tile.channels.iter_mut().for_each(|plane| plane.put(k, &mut channels));
        if let Some(splats) = tile.light_splats.get_mut(k) {
            *splats = record.light_splats;
        }
        tile.end_halves(pixel, record.ended);
        if let Some(control) = tile.controls.get_mut(k) {
            *control = record.control;
            tile.negative_bands[k * count..][..count].copy_from_slice(&record.negative_bands);
        }
        if let Some(halves) = tile.halves.get_mut(k) {
            *halves = record.halves;
        }
        tile.bands[k * count..][..count].copy_from_slice(&record.bands);
        let [second, second_negative] = &mut tile.second_bands;
        for (all, own) in [
            (&mut tile.band_splats, &record.band_splats),
            (second, &record.second_bands[0]),
            (second_negative, &record.second_bands[1]),
        ] {
            let to = all.iter_mut().skip(k * count);
            to.zip(own).for_each(|(sum, v)| *sum = *v);
        }
        if let Some(sums) = tile.batch_sums.get_mut(k) {
            *sums = record.batch_sums;
        }
        if let Some(ends) = tile.ends.get_mut(k) {
            *ends = record.ends;
        }
        if let Some(splats) = &mut tile.splats {
            splats.put(pixel, &record.splat, &record.splat_bands);
        }
    }
}

#[cfg(test)]
mod tests;
