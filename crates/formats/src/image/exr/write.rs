//! Writing OpenEXR: one part, scan lines, 32-bit floats, ZIP.
//!
//! Written out here, after the OpenEXR file layout document, rather than by the `exr` crate, because that keeps
//! attributes in a hash map with a random order: the same picture must give the same file.

use std::io::{self, Seek, SeekFrom, Write};
use std::ops::Range;

use super::{Layered, Window};
use straal_color::RgbSpace;

/// Scan lines that are compressed together (the format's ZIP_COMPRESSION).
const LINES_PER_CHUNK: usize = 16;

/// Writes a picture. Attributes come in the order of `metadata`, after those that the format asks for.
pub fn write<W: Write>(writer: W, picture: &Layered) -> io::Result<()> {
    write_with(writer, picture, &picture.metadata)
}

/// Writes a picture with these metadata in place of its own.
pub fn write_with<W: Write>(
    mut writer: W,
    picture: &Layered,
    metadata: &[(String, String)],
) -> io::Result<()> {
    let channels = sorted_channels(picture)?;
    let header = header(picture, &channels, metadata)?;
    let Window { y: top, width, height, .. } = picture.data_window;
    // Each chunk is preceded by its row and its size; the table of their positions comes before the first.
    let mut chunks = Vec::with_capacity(height.div_ceil(LINES_PER_CHUNK));
    for first in (0..height).step_by(LINES_PER_CHUNK) {
        let rows = first..height.min(first + LINES_PER_CHUNK);
        chunks.push((top.wrapping_add(first as i32), chunk(&channels, width, rows)));
    }
    writer.write_all(&header)?;
    let mut position = header.len() + 8 * chunks.len();
    for (_, chunk) in &chunks {
        writer.write_all(&(position as u64).to_le_bytes())?;
        position += 8 + chunk.len();
    }
    for (row, chunk) in &chunks {
        put_chunk(&mut writer, *row, chunk)?;
    }
    Ok(())
}

/// Writes a picture of which only a strip of rows is there at a time. The file is the one that [`write()`] makes of the whole.
pub struct StripWriter<W> {
    writer: W,
    /// Of the whole picture.
    window: Window,
    /// Names of all channels in the order of the file.
    names: Vec<String>,
    /// Where the table of positions lies.
    table: u64,
    /// Of the chunks that are written.
    positions: Vec<u64>,
}

impl<W: Write + Seek> StripWriter<W> {
    /// Rows of a strip, of which the last one may have fewer.
    pub const ROWS: usize = LINES_PER_CHUNK;

    /// Begins a picture with the layers of its first strip, whose window is that of the whole.
    pub fn new(mut writer: W, window: Window, first: &Layered) -> io::Result<Self> {
        let channels = sorted_channels(first)?;
        let whole = Layered { data_window: window, layers: Vec::new(), ..first.clone() };
        writer.write_all(&header(&whole, &channels, &whole.metadata)?)?;
        let table = writer.stream_position()?;
        let count = window.height.div_ceil(LINES_PER_CHUNK);
        for _ in 0..count {
            writer.write_all(&[0; 8])?;
        }
        let names = channels.into_iter().map(|(name, _)| name).collect();
        Ok(Self { writer, window, names, table, positions: Vec::with_capacity(count) })
    }

    /// Writes the next rows, with the channels that the first ones had.
    pub fn strip(&mut self, strip: &Layered) -> io::Result<()> {
        let channels = sorted_channels(strip)?;
        let done = self.positions.len() * LINES_PER_CHUNK;
        let rows = strip.data_window.height;
        let is_next = rows == LINES_PER_CHUNK.min(self.window.height.saturating_sub(done));
        if !is_next || strip.data_window.width != self.window.width {
            return Err(wrong("these aren't the rows that come next"));
        }
        if !channels.iter().map(|(name, _)| name).eq(&self.names) {
            return Err(wrong("these rows have other channels than those before"));
        }
        self.positions.push(self.writer.stream_position()?);
        let chunk = chunk(&channels, self.window.width, 0..rows);
        put_chunk(&mut self.writer, self.window.y.wrapping_add(done as i32), &chunk)
    }

    /// Ends the file.
    pub fn end(mut self) -> io::Result<()> {
        if self.positions.len() != self.window.height.div_ceil(LINES_PER_CHUNK) {
            return Err(wrong("rows are missing"));
        }
        let end = self.writer.stream_position()?;
        self.writer.seek(SeekFrom::Start(self.table))?;
        for position in &self.positions {
            self.writer.write_all(&position.to_le_bytes())?;
        }
        self.writer.seek(SeekFrom::Start(end))?;
        Ok(())
    }
}

/// Rows of all channels, compressed.
fn chunk(channels: &[(String, &[f32])], width: usize, rows: Range<usize>) -> Vec<u8> {
    let mut raw = Vec::with_capacity(rows.len() * width * channels.len() * 4);
    for row in rows {
        for (_, samples) in channels {
            raw.extend(samples[row * width..][..width].iter().flat_map(|sample| sample.to_le_bytes()));
        }
    }
    compress(raw)
}

fn put_chunk(writer: &mut impl Write, row: i32, chunk: &[u8]) -> io::Result<()> {
    writer.write_all(&row.to_le_bytes())?;
    let size = i32::try_from(chunk.len()).map_err(|_| wrong("the picture is too wide"))?;
    writer.write_all(&size.to_le_bytes())?;
    writer.write_all(chunk)
}

fn wrong(problem: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, problem.into())
}

/// The channels of all layers by their full names, in the order that the format asks for.
fn sorted_channels(picture: &Layered) -> io::Result<Vec<(String, &[f32])>> {
    let Window { width, height, .. } = picture.data_window;
    let mut channels: Vec<(String, &[f32])> = Vec::new();
    for layer in &picture.layers {
        for channel in &layer.channels {
            let name = match layer.name.as_str() {
                "" => channel.name.clone(),
                layer => format!("{layer}.{}", channel.name),
            };
            let samples = channel.samples.len();
            if samples != width * height {
                return Err(wrong(format!(
                    "channel {name} has {samples} samples for {width} x {height} pixels"
                )));
            }
            channels.push((name, &channel.samples));
        }
    }
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    if let Some(pair) = channels.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(wrong(format!("two channels are called {}", pair[0].0)));
    }
    if channels.is_empty() || width == 0 || height == 0 {
        return Err(wrong("the picture is empty"));
    }
    Ok(channels)
}

/// The magic number, the version and the attributes.
fn header(
    picture: &Layered,
    channels: &[(String, &[f32])],
    metadata: &[(String, String)],
) -> io::Result<Vec<u8>> {
    let mut list = Vec::new();
    for (name, _) in channels {
        put_name(&mut list, name)?;
        list.extend(2i32.to_le_bytes()); // 32-bit float
        list.extend([0; 4]); // not perceptually linear; reserved
        list.extend(1i32.to_le_bytes());
        list.extend(1i32.to_le_bytes()); // a sample for every pixel
    }
    list.push(0);

    let names = channels.iter().map(|(name, _)| name).chain(metadata.iter().map(|(name, _)| name));
    let long_names = if names.clone().any(|name| name.len() > 31) { 0x400 } else { 0 };
    let mut header = vec![0x76, 0x2f, 0x31, 0x01];
    header.extend((2i32 | long_names).to_le_bytes());
    put(&mut header, "channels", "chlist", &list)?;
    put(&mut header, "compression", "compression", &[3])?; // ZIP, 16 lines
    put(&mut header, "dataWindow", "box2i", &bounds(picture.data_window)?)?;
    put(&mut header, "displayWindow", "box2i", &bounds(picture.display_window)?)?;
    put(&mut header, "lineOrder", "lineOrder", &[0])?; // from the top
    put(&mut header, "pixelAspectRatio", "float", &1.0f32.to_le_bytes())?;
    put(&mut header, "screenWindowCenter", "v2f", &[0; 8])?;
    put(&mut header, "screenWindowWidth", "float", &1.0f32.to_le_bytes())?;
    if let Some(space) = picture.space {
        let [red, green, blue] = space.primaries;
        let numbers = [red, green, blue, space.white].map(|c| [c.x as f32, c.y as f32]);
        let bytes: Vec<u8> = numbers.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        put(&mut header, "chromaticities", "chromaticities", &bytes)?;
        if space == RgbSpace::XYZ {
            let neutral = space.neutral();
            let bytes: Vec<u8> =
                [neutral.x, neutral.y].iter().flat_map(|v| (*v as f32).to_le_bytes()).collect();
            put(&mut header, "adoptedNeutral", "v2f", &bytes)?;
        }
    }
    for (i, (name, value)) in metadata.iter().enumerate() {
        if STANDARD.contains(&name.as_str()) || metadata[..i].iter().any(|(other, _)| other == name) {
            return Err(wrong(format!("two attributes are called {name}")));
        }
        put(&mut header, name, "string", value.as_bytes())?;
    }
    header.push(0);
    Ok(header)
}

/// Attributes that the format gives a meaning of its own and another type than text.
const STANDARD: [&str; 13] = [
    "adoptedNeutral",
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "chunkCount",
    "preview",
    "chromaticities",
];

fn put(header: &mut Vec<u8>, name: &str, kind: &str, value: &[u8]) -> io::Result<()> {
    put_name(header, name)?;
    put_name(header, kind)?;
    let size = i32::try_from(value.len()).map_err(|_| wrong(format!("attribute {name} is too long")))?;
    header.extend(size.to_le_bytes());
    header.extend(value);
    Ok(())
}

fn put_name(header: &mut Vec<u8>, name: &str) -> io::Result<()> {
    if name.is_empty() || name.len() > 255 || name.contains('\0') {
        return Err(wrong(format!("'{name}' can't be a name in an EXR file")));
    }
    header.extend(name.as_bytes());
    header.push(0);
    Ok(())
}

/// A window as the format has it: first and last column and row.
fn bounds(window: Window) -> io::Result<Vec<u8>> {
    let end = |start: i32, size: usize| {
        let size = i32::try_from(size).ok()?;
        start.checked_add(size)?.checked_sub(1)
    };
    match (end(window.x, window.width), end(window.y, window.height)) {
        (Some(right), Some(bottom)) => {
            Ok([window.x, window.y, right, bottom].iter().flat_map(|v| v.to_le_bytes()).collect())
        }
        _ => Err(wrong("the picture's window is too large")),
    }
}

/// ZIP as OpenEXR does it: bytes of even and odd positions apart, differences to the byte before, then zlib; and
/// left as it was where that wouldn't make it smaller.
fn compress(raw: Vec<u8>) -> Vec<u8> {
    let mut packed: Vec<u8> = raw.iter().step_by(2).chain(raw.iter().skip(1).step_by(2)).copied().collect();
    let mut before = packed[0];
    for byte in &mut packed[1..] {
        let difference = byte.wrapping_sub(before).wrapping_add(128);
        before = *byte;
        *byte = difference;
    }
    // Level 4 is OpenEXR's own: beyond it files of floats hardly shrink and take far longer.
    let zipped = miniz_oxide::deflate::compress_to_vec_zlib(&packed, 4);
    if zipped.len() < raw.len() { zipped } else { raw }
}
