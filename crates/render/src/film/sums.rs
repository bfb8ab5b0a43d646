//! A film's exact sums as bytes, to be owner up again or put together.
//!
//! [`Record::visit`] is the one list of what a pixel's sums are made of, in the order in which they are written: integers
//! and, for the ends of batches, doubles, all little-endian and of fixed size. A film is written pixel by pixel, row by
//! row from the top, whatever its tiles; what several tiles have splatted onto a pixel is added up before.

use super::adaptive::Halves;
use super::channel::{self, Scale, Sum};
use super::control::Control;
use super::error_estimate::BatchSums;
use super::fixed::{Fixed, Square};
use super::splat::Splat;
use super::{Costs, ErrorEstimate, Film, Keep, Pixel, Splats, TILE};
use crate::film::Region;
use std::io::{self, Read, Write};
use straal_color::spectrum::Bands;

/// What a film holds of each pixel: two films that hold the same can be put together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Held {
    /// Costs of searches, and whether with their time.
    pub costs: Option<bool>,
    /// Bands of wavelengths.
    pub bands: Option<Bands>,
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

/// All that a film has summed of one pixel.
#[derive(Clone, Debug, Default, PartialEq)]
struct Record {
    pixel: Pixel,
    squares: [Square; 3],
    /// Of every channel and component.
    channels: Vec<Sum>,
    light_splats: [Fixed; 3],
    /// A bit for each half of the pixel that needs no further samples.
    ended: u8,
    bands: Vec<Fixed>,
    splat: Splat,
    splat_bands: Vec<Fixed>,
    control: Control,
    negative_bands: Vec<Fixed>,
    halves: Halves,
    batch_sums: BatchSums<f64>,
    ends: BatchSums<Fixed>,
}

/// One number of a record.
enum Number<'a> {
    Sum(&'a mut i128),
    Guide(&'a mut i64),
    Cost(&'a mut u64),
    Count(&'a mut u32),
    Flag(&'a mut u8),
    Double(&'a mut f64),
}

/// Which numbers of the pixel's are meant.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    /// Those that are the pixel's own, and are added where samples are.
    Own,
    /// Those that a filter has brought.
    Splat,
    /// Where batches end, of samples from the first on.
    BatchSums,
    /// The same of samples from a later one on, exact.
    Ends,
}

impl Record {
    fn empty(held: &Held) -> Self {
        let bands = vec![Fixed::default(); held.bands.as_ref().map_or(0, Bands::count)];
        let some = |is: bool| if is { bands.clone() } else { Vec::new() };
        let (splat_bands, negative_bands) = (some(held.splats), some(held.weight.is_some()));
        let channels = channel::empty_record(held.guides, held.costs.is_some());
        Self { channels, splat_bands, negative_bands, bands, ..Self::default() }
    }

    /// Every number of a part, in the order of the file.
    fn visit(&mut self, part: Part, held: &Held, see: &mut impl FnMut(Number<'_>)) {
        match part {
            Part::Own => {
                let p = &mut self.pixel;
                see(Number::Count(&mut p.count));
                see(Number::Count(&mut p.dropped));
                see(Number::Flag(&mut self.ended));
                p.value.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
                if held.squares {
                    self.squares.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
                }
                for sum in &mut self.channels {
                    see(match sum {
                        Sum::Unit(v) => Number::Guide(v),
                        Sum::Length(v) => Number::Sum(v),
                        Sum::Count(v) => Number::Cost(v),
                    });
                }
                if held.light_splats {
                    self.light_splats.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
                }
                self.bands.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
                if held.weight.is_some() {
                    see_control(&mut self.control, see);
                    self.negative_bands.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
                }
                if held.halves {
                    let h = &mut self.halves;
                    see(Number::Count(&mut h.count));
                    h.value.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
                    h.square.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
                    see_control(&mut h.control, see);
                    h.batch_sums
                        .iter_mut()
                        .flat_map(|m| m.0.as_flattened_mut())
                        .for_each(|v| see(Number::Double(v)));
                }
            }
            Part::Splat if held.splats => {
                self.splat.values().for_each(|v| see(Number::Sum(v)));
                see(Number::Guide(self.splat.weights()));
                self.splat_bands.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
            }
            Part::Splat => {}
            Part::BatchSums => self.batch_sums.0.iter_mut().flatten().for_each(|v| see(Number::Double(v))),
            Part::Ends => self.ends.0.iter_mut().flatten().for_each(|v| see(Number::Sum(&mut v.0))),
        }
    }
}

fn see_control(control: &mut Control, see: &mut impl FnMut(Number<'_>)) {
    see(Number::Count(&mut control.count));
    control.negative.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
}

/// The parts of which a film's records are made, its samples being those from `first` on.
fn parts(held: &Held, first: u32) -> impl Iterator<Item = Part> {
    let ends = match (held.batches, first) {
        (false, _) => None,
        (true, 0) => Some(Part::BatchSums),
        (true, _) => Some(Part::Ends),
    };
    [Part::Own, Part::Splat].into_iter().chain(ends)
}

impl Held {
    /// Bytes of a pixel's record.
    pub fn bytes_a_pixel(&self, first: u32) -> usize {
        let (mut record, mut bytes) = (Record::empty(self), 0);
        for part in parts(self, first) {
            record.visit(part, self, &mut |number| {
                bytes += match number {
                    Number::Sum(_) => 16,
                    Number::Guide(_) | Number::Cost(_) | Number::Double(_) => 8,
                    Number::Count(_) => 4,
                    Number::Flag(_) => 1,
                };
            });
        }
        bytes
    }

    /// Its numbers by name, for those who read such a file by other means.
    pub fn names(&self, first: u32) -> String {
        let mut names = "count:u32 dropped:u32 ended:u8 value:3xi128".to_owned();
        if self.squares {
            names += " square:3xi128";
        }
        for (_, channel) in channel::held(self.guides, self.costs.is_some()) {
            let kind = match channel.scale {
                Scale::Unit => "i64",
                Scale::Length => "i128",
                Scale::Count => "u64",
            };
            names += &match channel.components.len() {
                1 => format!(" {}:{kind}", channel.name),
                n => format!(" {}:{n}x{kind}", channel.name),
            };
        }
        if self.light_splats {
            names += " light_splats:3xi128";
        }
        let bands = self.bands.as_ref().map_or(0, Bands::count);
        if bands > 0 {
            names += &format!(" bands:{bands}xi128");
        }
        if self.weight.is_some() {
            names += " negative_count:u32 negative:3xi128";
            if bands > 0 {
                names += &format!(" negative_bands:{bands}xi128");
            }
        }
        if self.halves {
            names += " second_count:u32 second_value:3xi128 second_square:3xi128 second_negative_count:u32 \
                      second_negative:3xi128 halves_batch_ends:12xf64";
        }
        if self.splats {
            let [values, weights] = Splat::NUMBERS;
            names += &format!(" splat:{values}xi128 weight:{weights}xi64");
            if bands > 0 {
                names += &format!(" splat_bands:{bands}xi128");
            }
        }
        match (self.batches, first) {
            (false, _) => {}
            (true, 0) => names += " batch_ends:6xf64",
            (true, _) => names += " batch_ends:6xi128",
        }
        names
    }
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

/// A film made of parts: of samples, or of the picture.
pub struct Joined {
    film: Film,
    region: Region,
    /// By pixel of the region: the group of spans of one crop, from 1, that it is owner from.
    owner: Vec<u32>,
    end: u32,
    gaps: bool,
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

/// Takes one number off some bytes; `add` makes the new one of the old and what was read.
fn take(number: Number<'_>, bytes: &mut &[u8], add: impl Fn(i128, i128) -> i128) {
    fn next<const N: usize>(bytes: &mut &[u8]) -> [u8; N] {
        let Some((head, rest)) = bytes.split_first_chunk() else { return [0; N] };
        *bytes = rest;
        *head
    }
    match number {
        Number::Sum(v) => *v = add(*v, i128::from_le_bytes(next(bytes))),
        Number::Guide(v) => *v = add(i128::from(*v), i64::from_le_bytes(next(bytes)).into()) as i64,
        Number::Cost(v) => *v = add(i128::from(*v), u64::from_le_bytes(next(bytes)).into()) as u64,
        Number::Count(v) => *v = add(i128::from(*v), u32::from_le_bytes(next(bytes)).into()) as u32,
        Number::Flag(v) => *v |= next::<1>(bytes)[0],
        Number::Double(v) => *v = f64::from_le_bytes(next(bytes)),
    }
}

/// Reads a row of records: the column of each, and its bytes.
fn for_each_record(
    input: &mut dyn Read,
    held: &Held,
    first: u32,
    region: Region,
    mut see: impl FnMut(u32, &[u8]),
) -> io::Result<()> {
    let size = held.bytes_a_pixel(first);
    let mut bytes = vec![0; size * 64];
    let mut x = region.min[0];
    while x < region.max[0] {
        let n = (region.max[0] - x).min(64);
        let chunk = &mut bytes[..n as usize * size];
        input.read_exact(chunk)?;
        for (k, record) in chunk.chunks_exact(size).enumerate() {
            see(x + k as u32, record);
        }
        x += n;
    }
    Ok(())
}

/// The powers of two from `first` on, below `end`: batches end there.
fn notes(first: u32, end: u32) -> usize {
    (0..31).filter(|k| (first..end).contains(&(1 << k))).count()
}

impl Joined {
    /// An empty film for the part `crop` of a picture of some size, of which more was rendered where `region` is larger.
    pub fn new(
        size: [u32; 2],
        [crop, region]: [Region; 2],
        held: &Held,
        error: Option<ErrorEstimate>,
    ) -> Self {
        let keep = Keep { squares: held.squares, layers: held.guides };
        let mut film = Film::over(size, [crop, region], keep);
        film.mean_squares.clone_from(&held.mean_squares);
        if let Some(bands) = held.bands {
            film.hold_bands(bands);
        }
        if held.splats {
            for tile in &mut film.tiles {
                tile.splats = Some(Splats::alone(tile.region, held.bands.as_ref().map_or(0, Bands::count)));
            }
        }
        if let Some(weight) = held.weight {
            film.control(weight);
        }
        if held.light_splats {
            film.hold_light_splats();
        }
        if held.halves {
            film.adapt(error == Some(ErrorEstimate::Batches));
        }
        if held.batches {
            film.hold_batches();
        }
        if let Some(timed) = held.costs {
            film.count_costs(timed);
        }
        film.error = error;
        Self { film, region, owner: vec![0; region.area()], end: 0, gaps: false }
    }

    /// Adds what a film of the same kind has written. Spans of one crop are a group, numbered from 1, and come in the order
    /// of their samples.
    pub fn add(
        &mut self,
        span: &Span,
        group: u32,
        input: &mut dyn Read,
        dropped: Option<([u32; 2], u32)>,
    ) -> io::Result<()> {
        let held = self.film.held();
        let notes = notes(span.first, span.end);
        let plus = |old: i128, new: i128| old.wrapping_add(new);
        for y in span.region.min[1]..span.region.max[1] {
            for_each_record(input, &held, span.first, span.region, |x, bytes| {
                let pixel = [x, y];
                if !self.region.contains(pixel) {
                    return;
                }
                let place = (y - self.region.min[1]) as usize * self.region.width() as usize
                    + (x - self.region.min[0]) as usize;
                // What lies beyond a crop is in its neighbour as well, and the same there.
                let is_own = self.owner[place] == 0 || self.owner[place] == group;
                let mut sums = self.film.record(pixel, &held);
                let before = sums.pixel.value;
                let (mut other, mut bytes) = (Record::empty(&held), bytes);
                for part in parts(&held, span.first) {
                    let is_added = match part {
                        Part::Own => is_own,
                        Part::Splat => span.crop.contains(pixel),
                        Part::BatchSums | Part::Ends => false,
                    };
                    let to = if is_added { &mut sums } else { &mut other };
                    to.visit(part, &held, &mut |number| take(number, &mut bytes, plus));
                }
                if is_own {
                    self.owner[place] = group;
                    if span.first == 0 {
                        sums.batch_sums = other.batch_sums;
                    } else if held.batches {
                        sums.batch_sums.follow(&before, &other.ends, notes);
                    }
                }
                self.film.put(pixel, sums);
            })?;
        }
        self.film.note_dropped(dropped);
        self.end = self.end.max(span.end);
        Ok(())
    }

    /// Takes note that samples are missing in between: batches tell nothing then.
    pub fn has_gaps(&mut self) {
        self.gaps = true;
    }

    /// The film of all parts.
    pub fn into_film(mut self) -> Film {
        if self.gaps {
            self.film.tiles.iter_mut().for_each(|tile| tile.batch_sums = Vec::new());
            self.film.tell_spread();
        }
        self.film
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BandSample, CostSample, Flying, Sample};
    use super::*;
    use crate::filter::{Filter, Profile, Separable};

    const SIZE: [u32; 2] = [37, 20];

    /// A number from 0 to 1 that belongs to a sample.
    fn number([x, y]: [u32; 2], index: u32) -> f32 {
        let mut z = u64::from(x) << 40 | u64::from(y) << 20 | u64::from(index);
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z >> 40) as f32 / (1_u64 << 24) as f32
    }

    fn filter() -> Filter {
        Filter::Separable(Separable::new(Profile::Tent, 2.0).expect("a filter"))
    }

    /// A film with everything, or with splats in place of batches, and samples from `first` on.
    fn film(crop: Region, samples: [u32; 2], splat: bool) -> Film {
        let region = if splat { crop.grown(2).intersection(Region::whole(SIZE)) } else { crop };
        let mut film = Film::over(SIZE, [crop, region], Keep::ALL);
        film.hold_bands(Bands::new(400.0, 700.0, 3).expect("bands"));
        film.count_costs(true);
        if splat {
            film.splat(&filter());
        } else {
            film.hold_batches();
        }
        film.tell_error(if splat { ErrorEstimate::Spread } else { ErrorEstimate::Batches });
        film.begin_at(samples[0]);
        for tile in &mut film.tiles {
            let Region { min, max } = tile.region;
            for pixel in (min[1]..max[1]).flat_map(|y| (min[0]..max[0]).map(move |x| [x, y])) {
                for i in samples[0]..samples[1] {
                    let v = number(pixel, i);
                    let rgb = if i == 13 && pixel[0] % 7 == 3 { [f32::NAN; 3] } else { [v, v * v, 7.0 * v] };
                    let seen = std::array::from_fn(|k| [v, 0.5 - v, k as f32 * v]);
                    let sample = Sample { rgb, negative: v < 0.1, seen };
                    let bands = [BandSample { band: (i % 3) as u16, value: v }];
                    let owner = tile.add(pixel, i, &sample, &bands);
                    tile.add_cost(pixel, &CostSample { nodes: i.into(), primitives: 2, nanoseconds: 3 });
                    if let Some(splats) = tile.splats() {
                        let sample = owner.then_some(&sample);
                        splats.add(
                            &filter(),
                            &Flying { pixel, offset: [v - 0.5, 0.25], sample, bands: &bands },
                        );
                    }
                }
            }
        }
        film
    }

    fn bytes(film: &Film) -> Vec<u8> {
        let mut bytes = Vec::new();
        film.write_sums(&mut bytes).expect("memory takes all");
        assert_eq!(bytes.len(), film.region().area() * film.held().bytes_a_pixel(film.first_sample()));
        bytes
    }

    fn same(a: &Film, b: &Film) {
        assert_eq!(a.layers(), b.layers());
        assert_eq!(a.dropped(), b.dropped());
    }

    fn joined(whole: &Film, parts: &[(Region, [u32; 2], u32)], splat: bool) -> Film {
        let mut joined = Joined::new(SIZE, [whole.crop, whole.region()], &whole.held(), whole.error);
        for &(crop, samples, group) in parts {
            let film = film(crop, samples, splat);
            let span = Span { crop, region: film.region(), first: samples[0], end: samples[1] };
            let sums = bytes(&film);
            joined.add(&span, group, &mut sums.as_slice(), film.dropped().first).expect("whole");
        }
        joined.into_film()
    }

    #[test]
    fn what_is_taken_up_is_what_was_written() {
        let crop = Region { min: [3, 2], max: [30, 19] };
        for splat in [false, true] {
            let whole = film(crop, [0, 23], splat);
            let mut empty = film(crop, [0, 0], splat);
            empty.read_sums(&mut bytes(&whole).as_slice(), whole.dropped().first).expect("whole");
            same(&empty, &whole);
            assert_eq!(bytes(&empty), bytes(&whole));
        }
    }

    #[test]
    fn runs_of_samples_make_the_whole() {
        let crop = Region::whole(SIZE);
        for splat in [false, true] {
            for ends in [[8, 16], [5, 6], [1, 2], [7, 22], [16, 17]] {
                let whole = film(crop, [0, 23], splat);
                let [a, b] = ends;
                let parts = [(crop, [0, a], 1), (crop, [a, b], 1), (crop, [b, 23], 1)];
                same(&joined(&whole, &parts, splat), &whole);
            }
        }
    }

    #[test]
    fn crops_make_the_whole() {
        let region = |min, max| Region { min, max };
        for splat in [false, true] {
            let whole = film(Region::whole(SIZE), [0, 9], splat);
            let parts = [
                (region([0, 0], [18, 20]), [0, 9], 1),
                (region([18, 0], [37, 7]), [0, 9], 2),
                (region([18, 7], [37, 20]), [0, 4], 3),
                (region([18, 7], [37, 20]), [4, 9], 3),
            ];
            same(&joined(&whole, &parts, splat), &whole);
        }
    }

    #[test]
    fn too_few_bytes_are_an_error() {
        let whole = film(Region::whole(SIZE), [0, 2], false);
        let sums = bytes(&whole);
        let mut empty = film(Region::whole(SIZE), [0, 0], false);
        assert!(empty.read_sums(&mut &sums[..sums.len() - 1], None).is_err());
    }
}
