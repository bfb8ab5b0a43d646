//! What a pixel's sums are made of, number by number, and how these become bytes.

use super::super::adaptive::Halves;
use super::super::channel::{self, Scale, Sum};
use super::super::control::Control;
use super::super::error_estimate::BatchSums;
use super::super::fixed::{Fixed, Square};
use super::super::splat::Splat;
use super::super::{Pixel, Region};
use super::Held;
use std::io::{self, Read};
use straal_color::spectrum::Bands;

/// All that a film has summed of one pixel.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Record {
    pub(super) pixel: Pixel,
    pub(super) squares: [Square; 3],
    /// Of every channel and component.
    pub(super) channels: Vec<Sum>,
    pub(super) light_splats: [Fixed; 3],
    /// A bit for each half of the pixel that needs no further samples.
    pub(super) ended: u8,
    pub(super) bands: Vec<Fixed>,
    pub(super) band_splats: Vec<Fixed>,
    pub(super) second_bands: [Vec<Fixed>; 2],
    pub(super) splat: Splat,
    pub(super) splat_bands: Vec<Fixed>,
    pub(super) control: Control,
    pub(super) negative_bands: Vec<Fixed>,
    pub(super) halves: Halves,
    pub(super) batch_sums: BatchSums<f64>,
    pub(super) ends: BatchSums<Fixed>,
}

/// One number of a record.
pub(super) enum Number<'a> {
    Sum(&'a mut i128),
    Guide(&'a mut i64),
    Cost(&'a mut u64),
    Count(&'a mut u32),
    Flag(&'a mut u8),
    Double(&'a mut f64),
    Single(&'a mut f32),
}

/// Which numbers of the pixel's are meant.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Part {
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
    pub(super) fn empty(held: &Held) -> Self {
        let bands = vec![Fixed::default(); held.bands_of_each()];
        let some = |is: bool| if is { bands.clone() } else { Vec::new() };
        let (splat_bands, negative_bands) = (some(held.splats), some(held.weight.is_some()));
        let second_bands = [some(held.halves), some(held.halves && held.weight.is_some())];
        let band_splats = some(held.light_splats);
        let channels = channel::empty_record(held.guides, held.costs.is_some());
        Self { channels, splat_bands, negative_bands, second_bands, band_splats, bands, ..Self::default() }
    }

    /// Every number of a part, in the order of the file.
    pub(super) fn visit(&mut self, part: Part, held: &Held, see: &mut impl FnMut(Number<'_>)) {
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
                self.band_splats.iter_mut().for_each(|v| see(Number::Sum(&mut v.0)));
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
                    h.batches
                        .iter_mut()
                        .flat_map(|m| m.0.as_flattened_mut())
                        .for_each(|v| see(Number::Single(v)));
                    self.second_bands.iter_mut().flatten().for_each(|v| see(Number::Sum(&mut v.0)));
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
pub(super) fn parts(held: &Held, first: u32) -> impl Iterator<Item = Part> {
    let ends = match (held.batches, first) {
        (false, _) => None,
        (true, 0) => Some(Part::BatchSums),
        (true, _) => Some(Part::Ends),
    };
    [Part::Own, Part::Splat].into_iter().chain(ends)
}

impl Held {
    /// How many bands there are, of wavelengths and of groups of lights.
    pub(super) fn bands_of_each(&self) -> usize {
        self.bands.as_ref().map_or(0, Bands::count) + 3 * self.light_groups.len()
    }

    /// The names of all bands' numbers.
    fn names_of_bands(&self, before: &str) -> String {
        let [bands, groups] = [self.bands.as_ref().map_or(0, Bands::count), 3 * self.light_groups.len()];
        let name = |(what, count): (&str, usize)| match count {
            0 => String::new(),
            _ => format!(" {before}{what}:{count}xi128"),
        };
        [("bands", bands), ("light_groups", groups)].map(name).concat()
    }

    /// Bytes of a pixel's record.
    pub fn bytes_a_pixel(&self, first: u32) -> usize {
        let (mut record, mut bytes) = (Record::empty(self), 0);
        for part in parts(self, first) {
            record.visit(part, self, &mut |number| {
                bytes += match number {
                    Number::Sum(_) => 16,
                    Number::Guide(_) | Number::Cost(_) | Number::Double(_) => 8,
                    Number::Count(_) | Number::Single(_) => 4,
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
        names += &self.names_of_bands("");
        if self.light_splats {
            names += &self.names_of_bands("light_splats_");
        }
        if self.weight.is_some() {
            names += " negative_count:u32 negative:3xi128";
            names += &self.names_of_bands("negative_");
        }
        if self.halves {
            names += " second_count:u32 second_value:3xi128 second_square:3xi128 second_negative_count:u32 \
                      second_negative:3xi128 halves_batches:42xf32";
            names += &self.names_of_bands("second_");
            if self.weight.is_some() {
                names += &self.names_of_bands("second_negative_");
            }
        }
        if self.splats {
            let [values, weights] = Splat::NUMBERS;
            names += &format!(" splat:{values}xi128 weight:{weights}xi64");
            names += &self.names_of_bands("splat_");
        }
        match (self.batches, first) {
            (false, _) => {}
            (true, 0) => names += " batch_ends:6xf64",
            (true, _) => names += " batch_ends:6xi128",
        }
        names
    }
}

/// Takes one number off some bytes; `add` makes the new one of the old and what was read.
pub(super) fn take(number: Number<'_>, bytes: &mut &[u8], add: impl Fn(i128, i128) -> i128) {
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
        Number::Single(v) => *v = f32::from_le_bytes(next(bytes)),
    }
}

/// Reads a row of records: the column of each, and its bytes.
pub(super) fn for_each_record(
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
