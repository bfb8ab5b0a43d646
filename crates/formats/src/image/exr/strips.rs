//! Reading OpenEXR by rows: of a picture that is larger than memory likes, some rows at a time, from the file itself.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;

use exr::block::UncompressedBlock;
use exr::block::chunk::Chunk;
use exr::meta::{BlockDescription, MetaData};

use super::choose::Choice;
use super::read::{self, Wanted};
use super::{Beauty, Layered};
use crate::image::header::PIXEL;
use crate::limits::check;
use crate::{Limits, ReadError};

/// A picture whose rows are read when they are asked for. It holds the chunks that were decoded last: rows that are asked for one after the other, from the
/// top, are decoded once.
pub struct Strips<R> {
    source: R,
    meta: MetaData,
    names: Vec<Vec<(String, String)>>,
    /// Which channels are the picture.
    choice: Choice,
    of_choice: Vec<Vec<bool>>,
    /// All but the numbers.
    head: Layered,
    /// In the order of the file.
    chunks: Vec<Place>,
    /// By their places in `chunks`.
    decoded: Vec<(usize, UncompressedBlock)>,
}

/// A chunk of the file.
struct Place {
    part: usize,
    /// Rows of the window of all.
    rows: Range<i64>,
    at: u64,
}

impl<R: Read + Seek> Strips<R> {
    /// Reads the headers, and where the chunks are. What is held of a picture besides is for whoever asks for its rows to count: `limits` is asked for its light
    /// alone.
    pub fn open(mut source: R, limits: &Limits) -> Result<Self, ReadError> {
        let failed = |e: std::io::Error| ReadError::file(format!("the EXR file can't be read: {e}"));
        let size = source.seek(SeekFrom::End(0)).map_err(failed)?;
        check("bytes", size, limits.max_bytes)?;
        source.rewind().map_err(failed)?;
        let told = |error| read::told(&error);
        let meta = MetaData::read_from_buffered(&mut source, false).map_err(told)?;
        read::check_kinds(&meta.headers)?;
        let plan = read::Plan::new(&meta.headers, limits, Wanted::All)?;
        let light = (plan.window.width as u64).saturating_mul(plan.window.height as u64);
        limits.check_decoded(light.saturating_mul(2 * PIXEL))?;
        read::check_promises(&meta.headers, size, limits)?;
        MetaData::validate(&meta.headers, false).map_err(told)?;
        let start = source.stream_position().map_err(failed)?;
        let names = read::names(&meta.headers);
        let (choice, of_choice) = read::picture_of(&names, None)?;
        let mut head = plan.empty(&meta.headers);
        for part in &names {
            let names: Vec<_> = part.iter().cloned().map(Some).collect();
            read::add_layers(&names, names.iter().map(|_| Some(Vec::new())).collect(), &mut head.layers);
        }
        let mut strips =
            Self { source, meta, names, choice, of_choice, head, chunks: Vec::new(), decoded: Vec::new() };
        strips.find_chunks(start, size)?;
        Ok(strips)
    }

    /// The picture without its numbers: windows, names of layers and channels, texts.
    pub fn head(&self) -> &Layered {
        &self.head
    }

    /// These rows of the picture, which have a window of their own.
    pub fn rows(&mut self, rows: Range<usize>) -> Result<Layered, ReadError> {
        self.rows_of(rows, |_| true)
    }

    /// The same of some layers only.
    pub fn rows_of(
        &mut self,
        rows: Range<usize>,
        is_wanted: impl Fn(&str) -> bool,
    ) -> Result<Layered, ReadError> {
        let wanted: Vec<Vec<bool>> = { self.names.iter() }
            .map(|part| part.iter().map(|(layer, _)| is_wanted(layer)).collect())
            .collect();
        self.decode(rows, &wanted)
    }

    /// The colours of these rows.
    pub fn colours(&mut self, rows: Range<usize>) -> Result<Beauty, ReadError> {
        let wanted = std::mem::take(&mut self.of_choice);
        let picture = self.decode(rows, &wanted);
        self.of_choice = wanted;
        picture?.colours(&self.choice)
    }

    /// The colours among rows of all layers.
    pub fn colours_of(&self, rows: &Layered) -> Result<Beauty, ReadError> {
        rows.colours(&self.choice)
    }

    fn decode(&mut self, rows: Range<usize>, wanted: &[Vec<bool>]) -> Result<Layered, ReadError> {
        let window = self.head.data_window;
        let rows = rows.start.min(window.height)..rows.end.min(window.height);
        let y = i64::from(window.y) + rows.start as i64;
        let y = i32::try_from(y).map_err(|_| ReadError::file("the picture's window is too large"))?;
        let strip = super::Window { y, height: rows.len(), ..window };
        let plane = |is: &bool| is.then(|| vec![0.0; strip.width * strip.height]);
        let mut planes: Vec<Vec<Option<Vec<f32>>>> =
            wanted.iter().map(|part| part.iter().map(plane).collect()).collect();
        let (first, end) = (rows.start as i64, rows.end as i64);
        for (k, place) in self.chunks.iter().enumerate() {
            let is_apart = place.rows.end <= first || end <= place.rows.start;
            if is_apart || planes[place.part].iter().all(Option::is_none) {
                continue;
            }
            let known = self.decoded.iter().position(|(of, _)| *of == k);
            let known = match known {
                Some(known) => known,
                None => {
                    self.decoded.push((k, decoded(&mut self.source, &self.meta, place)?));
                    self.decoded.len() - 1
                }
            };
            let block = &self.decoded[known].1;
            read::copy_block(&self.meta.headers[place.part], block, strip, &mut planes[place.part])?;
        }
        // What ends here isn't asked for again by who goes down the rows.
        self.decoded.retain(|(k, _)| self.chunks[*k].rows.end > end);
        let mut picture = Layered { data_window: strip, layers: Vec::new(), ..self.head.clone() };
        for ((names, planes), wanted) in self.names.iter().zip(planes).zip(wanted) {
            let names = names.iter().zip(wanted).map(|(name, is)| is.then(|| name.clone()));
            read::add_layers(&names.collect::<Vec<_>>(), planes, &mut picture.layers);
        }
        Ok(picture)
    }

    /// Goes along the chunks, of which each tells its size.
    fn find_chunks(&mut self, start: u64, size: u64) -> Result<(), ReadError> {
        let count: usize = self.meta.headers.iter().map(|header| header.chunk_count).sum();
        let mut at = start.saturating_add((count as u64).saturating_mul(8));
        for _ in 0..count {
            let chunk = at;
            let missing =
                |_| ReadError::byte(chunk as usize, "the EXR file is damaged: a block of pixels is missing");
            self.source.seek(SeekFrom::Start(at)).map_err(missing)?;
            let mut number = || -> Result<i32, ReadError> {
                let mut bytes = [0; 4];
                self.source.read_exact(&mut bytes).map_err(missing)?;
                at += 4;
                Ok(i32::from_le_bytes(bytes))
            };
            let part = if self.meta.requirements.has_multiple_layers { number()? } else { 0 };
            let header = usize::try_from(part).ok().and_then(|part| self.meta.headers.get(part));
            let Some(header) = header else {
                let message = format!("a block of part {part}, which doesn't exist");
                return Err(ReadError::byte(chunk as usize, message));
            };
            let own = header.own_attributes.layer_position.1;
            let (row, lines, is_full_size) = match header.blocks {
                BlockDescription::ScanLines => {
                    let row = i64::from(number()?) - i64::from(own);
                    (row, header.compression.scan_lines_per_block(), true)
                }
                BlockDescription::Tiles(tiles) => {
                    let [_, y, across, down] = [number()?, number()?, number()?, number()?];
                    let lines = tiles.tile_size.1;
                    (i64::from(y).saturating_mul(lines as i64), lines, across == 0 && down == 0)
                }
            };
            let claimed = number()?;
            let left = size.saturating_sub(at);
            let Some(bytes) = u64::try_from(claimed).ok().filter(|bytes| *bytes <= left) else {
                let message = format!("a block of {claimed} bytes, but only {left} are left");
                return Err(ReadError::byte(at as usize, message));
            };
            at += bytes;
            if is_full_size {
                let row = row + i64::from(own) - i64::from(self.head.data_window.y);
                let rows = row..row.saturating_add(lines as i64);
                self.chunks.push(Place { part: part as usize, rows, at: chunk });
            }
        }
        Ok(())
    }
}

fn decoded(
    source: &mut (impl Read + Seek),
    meta: &MetaData,
    place: &Place,
) -> Result<UncompressedBlock, ReadError> {
    let failed = |e: std::io::Error| ReadError::file(format!("the EXR file can't be read: {e}"));
    source.seek(SeekFrom::Start(place.at)).map_err(failed)?;
    let chunk = Chunk::read(source, meta).map_err(|error| read::told(&error))?;
    if chunk.layer_index != place.part {
        return Err(ReadError::file("the EXR file changed while it was read"));
    }
    UncompressedBlock::decompress_chunk(chunk, meta, false).map_err(|error| read::told(&error))
}
