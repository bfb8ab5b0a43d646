//! Reading OpenEXR.

use std::io::Cursor;

use exr::block::{BlockIndex, UncompressedBlock};
use exr::compression::Compression;
use exr::error::Error;
use exr::math::Vec2;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, Chromaticities, IntegerBounds, SampleType, Text,
};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use straal_color::{Chromaticity, RgbSpace};
use straal_scene::bitmap::Number;

use super::choose::{Choice, Kind, Names};
use super::{Beauty, Channel, Layer, Layered, Window, choice, nothing_to_show};
use crate::image;
use crate::image::header::PIXEL;
use crate::limits::check;
use crate::{Limits, ReadError};

/// No compression of the format makes pixels smaller than this: deflate's limit is 1:1032, and the Huffman runs of
/// PIZ come near it. A file that promises more is lying.
const MAX_COMPRESSION: u64 = 2048;

/// What of a file is read.
#[derive(Clone, Copy)]
pub(super) enum Wanted<'a> {
    All,
    /// What is the picture, or the layer of that name.
    Picture(Option<&'a str>),
}

/// Reads a picture with all its layers. Parts that don't cover the window of all are filled with zeros.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Layered, ReadError> {
    let (plan, meta) = prepare(bytes, limits, Wanted::All)?;
    decode(bytes, &plan, &meta)
}

/// Reads the colours alone, or those of a layer: other layers are not decoded.
pub fn read_colours(
    bytes: &[u8],
    limits: &Limits,
    layer: Option<&str>,
) -> Result<(Layered, Beauty), ReadError> {
    let (plan, meta) = prepare(bytes, limits, Wanted::Picture(layer))?;
    let picture = decode(bytes, &plan, &meta)?;
    let choice = plan.choice.ok_or_else(nothing_to_show)?;
    let beauty = picture.colours(&choice)?;
    Ok((picture, beauty))
}

/// What the headers of the parts promise of the picture itself.
pub fn header(bytes: &[u8], limits: &Limits) -> Result<image::Header, ReadError> {
    let meta = MetaData::read_from_buffered(&mut Cursor::new(bytes), false).map_err(|error| told(&error))?;
    check_kinds(&meta.headers)?;
    let plan = Plan::new(&meta.headers, limits, Wanted::Picture(None))?;
    Ok(image::Header {
        format: image::Format::Exr,
        width: plan.display.width,
        height: plan.display.height,
        channels: meta.headers.iter().map(|h| h.channels.list.len()).sum(),
        decoded_bytes: plan.bytes,
        texel: image::Header::texel(Number::Single, 3),
    })
}

/// What is read of a file, and what that takes.
pub(super) struct Plan {
    display: Window,
    /// The parts that are read lie in it.
    pub window: Window,
    /// The layer and channel that each channel of each part becomes; `None` of those that are not read.
    channels: Vec<Vec<Option<(String, String)>>>,
    /// Which of it is the picture, where only that is read.
    choice: Option<Choice>,
    /// The most that is allocated at a time.
    bytes: u64,
}

impl Plan {
    pub fn new(headers: &[Header], limits: &Limits, wanted: Wanted<'_>) -> Result<Self, ReadError> {
        let first = headers.first().ok_or_else(|| ReadError::file("the file has no part"))?;
        let display = bounds(first.shared_attributes.display_window);
        let names = names(headers);
        let (choice, is_read): (_, Vec<Vec<bool>>) = match wanted {
            Wanted::All => (None, names.iter().map(|part| vec![true; part.len()]).collect()),
            Wanted::Picture(layer) => {
                let (choice, is_read) = picture_of(&names, layer)?;
                (Some(choice), is_read)
            }
        };
        let mut window: Option<Window> = None;
        let (mut count, mut area) = (0_u64, 0_u64);
        for (header, is_read) in headers.iter().zip(&is_read) {
            let own = bounds(header.data_window());
            let pixels = limits.check_size(own.width as u64, own.height as u64)? as u64;
            let channels = is_read.iter().filter(|read| **read).count() as u64;
            if channels > 0 {
                window = Some(window.map_or(own, |w| w.around(&own)));
                count += channels;
                area = area.saturating_add(pixels);
            }
        }
        let window = window.ok_or_else(nothing_to_show)?;
        let pixels = limits.check_size(window.width as u64, window.height as u64)? as u64;
        // Zeros between the parts are in no file; a real one has few.
        if pixels > area.saturating_mul(16).saturating_add(1 << 20) {
            return Err(ReadError::file("the parts of the picture lie too far apart"));
        }
        let samples = pixels.saturating_mul(count);
        check("numbers", samples, limits.max_samples)?;
        let shown = limits.check_size(display.width as u64, display.height as u64)? as u64;
        // Of the planes colours are made, and then of these the whole picture where they are a part of it.
        let whole = if window == display { 0 } else { shown.saturating_mul(PIXEL) };
        // A sum of wavelengths is kept in double precision.
        let sums = choice.as_ref().map_or(0, |c| if c.kind == Kind::Spectral { 2 * PIXEL } else { 0 });
        let planes = samples.saturating_mul(4).saturating_add(pixels.saturating_mul(sums));
        let channels = names
            .into_iter()
            .zip(is_read)
            .map(|(part, read)| part.into_iter().zip(read).map(|(name, read)| read.then_some(name)).collect())
            .collect();
        let bytes = pixels.saturating_mul(PIXEL).saturating_add(planes.max(whole));
        Ok(Self { display, window, channels, choice, bytes })
    }

    /// The picture without layers.
    pub fn empty(&self, headers: &[Header]) -> Layered {
        let first = headers.first();
        let told = first.and_then(|header| header.shared_attributes.chromaticities);
        let mut picture = Layered {
            display_window: self.display,
            data_window: self.window,
            space: told.and_then(space),
            layers: Vec::new(),
            metadata: first.map(metadata).unwrap_or_default(),
            notes: Vec::new(),
        };
        if told.is_some() && picture.space.is_none() {
            picture.notes.push("its `chromaticities` make no sense: the primaries of sRGB are taken".into());
        }
        picture
    }
}

/// The layer and the name of each channel of each part.
pub(super) fn names(headers: &[Header]) -> Vec<Vec<(String, String)>> {
    headers.iter().map(|header| channel_names(header, headers.len() > 1)).collect()
}

/// Which of the channels of each part are the picture.
pub(super) fn picture_of(
    parts: &[Vec<(String, String)>],
    layer: Option<&str>,
) -> Result<(Choice, Vec<Vec<bool>>), ReadError> {
    let mut layers: Vec<Names> = Vec::new();
    // Of each channel, which of the layers it belongs to.
    let mut places: Vec<Vec<usize>> = Vec::new();
    for part in parts {
        let start = layers.len();
        let mut own = Vec::with_capacity(part.len());
        for (layer, channel) in part {
            let known = layers[start..].iter().position(|known| known.layer == *layer).map(|i| start + i);
            let place = known.unwrap_or_else(|| {
                layers.push(Names { layer: layer.clone(), channels: Vec::new() });
                layers.len() - 1
            });
            layers[place].channels.push(channel.clone());
            own.push(place);
        }
        places.push(own);
    }
    let choice = choice(&layers, layer)?;
    let place = layers.iter().position(|l| l.layer == choice.layer);
    let is_read = |(name, at): (&(String, String), &usize)| {
        Some(*at) == place && (choice.channels.is_empty() || choice.channels.contains(&name.1))
    };
    let is_read =
        parts.iter().zip(&places).map(|(part, places)| part.iter().zip(places).map(is_read).collect());
    let is_read = is_read.collect();
    Ok((choice, is_read))
}

/// The layer and the name of each channel of a part.
fn channel_names(header: &Header, has_parts: bool) -> Vec<(String, String)> {
    // Of a single part the channels' own names say all.
    let part = header.own_attributes.layer_name.as_ref().filter(|_| has_parts);
    let part = part.map(Text::to_string).unwrap_or_default();
    let name = |channel: &ChannelDescription| {
        let full = channel.name.to_string();
        let (prefix, name) = full.rsplit_once('.').unwrap_or(("", &full));
        let is_told_twice =
            || prefix.strip_prefix(&part).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        let layer = match (part.as_str(), prefix) {
            ("", prefix) => prefix.to_string(),
            (part, "") => part.to_string(),
            (_, prefix) if is_told_twice() => prefix.to_string(),
            (part, prefix) => format!("{part}.{prefix}"),
        };
        (layer, name.to_string())
    };
    header.channels.list.iter().map(name).collect()
}

fn bounds(b: IntegerBounds) -> Window {
    Window { x: b.position.0, y: b.position.1, width: b.size.0, height: b.size.1 }
}

/// Reads the headers and makes sure that what they promise can be there, before anything is allocated for it.
fn prepare(bytes: &[u8], limits: &Limits, wanted: Wanted<'_>) -> Result<(Plan, MetaData), ReadError> {
    limits.check_bytes(bytes)?;
    let mut cursor = Cursor::new(bytes);
    let meta = MetaData::read_from_buffered(&mut cursor, false).map_err(|error| told(&error))?;
    check_kinds(&meta.headers)?;
    let plan = Plan::new(&meta.headers, limits, wanted)?;
    limits.check_decoded(plan.bytes)?;
    check_promises(&meta.headers, bytes.len() as u64, limits)?;
    check_chunks(&meta, bytes, cursor.position() as usize)?;
    Ok((plan, meta))
}

/// Reads what is planned.
fn decode(bytes: &[u8], plan: &Plan, meta: &MetaData) -> Result<Layered, ReadError> {
    let headers = meta.headers.as_slice();
    let size = plan.window.width * plan.window.height; // checked against the limits
    let plane = |name: &Option<_>| name.as_ref().map(|_| vec![0.0; size]);
    let mut planes: Vec<Vec<Option<Vec<f32>>>> =
        plan.channels.iter().map(|part| part.iter().map(plane).collect()).collect();
    let reader = exr::block::read(Cursor::new(bytes), false);
    let chunks = reader.and_then(|reader| reader.all_chunks(false)).map_err(|error| told(&error))?;
    for chunk in chunks {
        let chunk = chunk.map_err(|error| told(&error))?;
        if planes.get(chunk.layer_index).is_some_and(|part| part.iter().all(Option::is_none)) {
            continue;
        }
        let block = UncompressedBlock::decompress_chunk(chunk, meta, false).map_err(|error| told(&error))?;
        if block.index.level == Vec2(0, 0) {
            let header = &headers[block.index.layer];
            copy_block(header, &block, plan.window, &mut planes[block.index.layer])?;
        }
    }
    let mut picture = plan.empty(headers);
    for (names, planes) in plan.channels.iter().zip(planes) {
        add_layers(names, planes, &mut picture.layers);
    }
    Ok(picture)
}

/// The space that a file tells in single precision: the exact one where it has a name, and none where it makes no sense.
fn space(told: Chromaticities) -> Option<RgbSpace> {
    let at = |Vec2(x, y): Vec2<f32>| Chromaticity { x: f64::from(x), y: f64::from(y) };
    let space = RgbSpace { primaries: [told.red, told.green, told.blue].map(at), white: at(told.white) };
    Some(space.recognised()).filter(RgbSpace::is_sound)
}

/// Refuses kinds of files that can't be decoded.
pub(super) fn check_kinds(headers: &[Header]) -> Result<(), ReadError> {
    for header in headers {
        if header.deep {
            return Err(ReadError::file("deep pictures are not supported"));
        }
        match header.compression {
            Compression::Uncompressed
            | Compression::RLE
            | Compression::ZIP1
            | Compression::ZIP16
            | Compression::PIZ
            | Compression::PXR24 => {}
            other => {
                return Err(ReadError::file(format!(
                    "{other} is not supported: save the file with ZIP or PIZ"
                )));
            }
        }
        if header.channels.list.is_empty() {
            return Err(ReadError::file("the picture has no channels"));
        }
        let sampled = header.channels.list.iter().find(|channel| channel.sampling != Vec2(1, 1));
        if let Some(channel) = sampled {
            let Vec2(x, y) = channel.sampling;
            return Err(ReadError::file(format!(
                "the channel `{}` has a sample for every {x} x {y} pixels only, which is not supported: save the file \
                 as RGB, or with all channels at full size",
                channel.name
            )));
        }
    }
    Ok(())
}

/// Refuses what is beyond what the bytes of the file can hold, before any pixel is allocated.
pub(super) fn check_promises(headers: &[Header], file_size: u64, limits: &Limits) -> Result<(), ReadError> {
    let mut bytes = 0u64;
    let mut chunks = 0u64;
    for header in headers {
        let Vec2(width, height) = header.layer_size;
        let pixels = limits.check_size(width as u64, height as u64)? as u64;
        bytes = bytes.saturating_add(pixels.saturating_mul(header.channels.bytes_per_pixel as u64));
        if let BlockDescription::Tiles(tiles) = header.blocks {
            // A tile may reach beyond the picture, but one that is much larger is made to waste memory.
            limits.check_size(tiles.tile_size.0 as u64, tiles.tile_size.1 as u64)?;
        }
        chunks = chunks.saturating_add(header.chunk_count as u64);
    }
    let promised = (bytes / MAX_COMPRESSION).saturating_add(chunks.saturating_mul(8));
    if promised > file_size {
        let Vec2(width, height) = headers.first().map_or(Vec2(0, 0), |header| header.layer_size);
        return Err(ReadError::file(format!(
            "the header promises {width} x {height} pixels, which can't be in a file of {file_size} bytes"
        )));
    }
    Ok(())
}

/// Refuses a block that claims more bytes than are left, as the decoder would make room for them first. `start` is
/// where the header ends and the table of the blocks' positions begins.
fn check_chunks(meta: &MetaData, bytes: &[u8], start: usize) -> Result<(), ReadError> {
    let count: usize = meta.headers.iter().map(|header| header.chunk_count).sum();
    let mut at = start.saturating_add(count.saturating_mul(8));
    let number = |at: usize| {
        let bytes = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        let number = bytes.map(|bytes| i32::from_le_bytes(*bytes)).and_then(|n| usize::try_from(n).ok());
        number.ok_or_else(|| ReadError::byte(at, "the EXR file is damaged: a block of pixels is missing"))
    };
    for _ in 0..count {
        let mut part = 0;
        if meta.requirements.has_multiple_layers {
            part = number(at)?;
            at += 4;
        }
        let Some(header) = meta.headers.get(part) else {
            return Err(ReadError::byte(at, format!("a block of part {part}, which doesn't exist")));
        };
        // A tile's column, row and two levels, or a row; then the size.
        at += if matches!(header.blocks, BlockDescription::Tiles(_)) { 16 } else { 4 };
        let size = number(at)?;
        at += 4;
        let left = bytes.len() - at;
        if size > left {
            return Err(ReadError::byte(at, format!("a block of {size} bytes, but only {left} are left")));
        }
        at += size;
    }
    Ok(())
}

/// Copies a block of a part into its planes, which cover `window`.
pub(super) fn copy_block(
    header: &Header,
    block: &UncompressedBlock,
    window: Window,
    planes: &mut [Option<Vec<f32>>],
) -> Result<(), ReadError> {
    let BlockIndex { pixel_position: Vec2(left, top), pixel_size: Vec2(width, height), .. } = block.index;
    let origin = header.own_attributes.layer_position;
    let x0 = left as i64 + i64::from(origin.0) - i64::from(window.x);
    let y0 = top as i64 + i64::from(origin.1) - i64::from(window.y);
    // The columns of the block that lie in the window.
    let from = (-x0).clamp(0, width as i64);
    let to = (window.width as i64 - x0).clamp(from, width as i64);
    let (from, to) = (from as usize, to as usize);
    let mut rest = block.data.as_slice();
    for row in 0..height as i64 {
        let y = y0 + row;
        for (channel, plane) in header.channels.list.iter().zip(&mut *planes) {
            let size = channel.sample_type.bytes_per_sample();
            let Some((line, after)) = rest.split_at_checked(width * size) else {
                return Err(ReadError::file("a block of pixels is too short"));
            };
            rest = after;
            if let Some(plane) =
                plane.as_mut().filter(|_| (0..window.height as i64).contains(&y) && from < to)
            {
                let start = y as usize * window.width + (x0 + from as i64) as usize;
                let target = &mut plane[start..start + (to - from)];
                convert(channel.sample_type, &line[from * size..to * size], target);
            }
        }
    }
    Ok(())
}

/// Samples of a file, in the machine's byte order, to floats.
fn convert(kind: SampleType, line: &[u8], target: &mut [f32]) {
    match kind {
        SampleType::F32 => {
            for (value, &bytes) in target.iter_mut().zip(line.as_chunks::<4>().0) {
                *value = f32::from_ne_bytes(bytes);
            }
        }
        SampleType::F16 => {
            for (value, &bytes) in target.iter_mut().zip(line.as_chunks::<2>().0) {
                *value = half_to_float(u16::from_ne_bytes(bytes));
            }
        }
        SampleType::U32 => {
            for (value, &bytes) in target.iter_mut().zip(line.as_chunks::<4>().0) {
                *value = u32::from_ne_bytes(bytes) as f32;
            }
        }
    }
}

/// An IEEE 754 half as a float; exact for every value.
fn half_to_float(half: u16) -> f32 {
    let sign = u32::from(half & 0x8000) << 16;
    let exponent = u32::from(half >> 10) & 0x1f;
    let fraction = u32::from(half & 0x3ff);
    match exponent {
        // Zero and subnormals are multiples of 2^-24.
        0 => f32::from_bits((fraction as f32 / 16_777_216.0).to_bits() | sign),
        31 => f32::from_bits(sign | 0x7f80_0000 | fraction << 13),
        _ => f32::from_bits(sign | (exponent + 112) << 23 | fraction << 13),
    }
}

/// Sorts the channels of a part into layers.
pub(super) fn add_layers(
    names: &[Option<(String, String)>],
    planes: Vec<Option<Vec<f32>>>,
    layers: &mut Vec<Layer>,
) {
    let start = layers.len();
    for (name, samples) in names.iter().zip(planes) {
        let Some(((layer, name), samples)) = name.as_ref().zip(samples) else { continue };
        let channel = Channel { name: name.clone(), samples };
        match layers[start..].iter_mut().find(|known| known.name == *layer) {
            Some(known) => known.channels.push(channel),
            None => layers.push(Layer { name: layer.clone(), channels: vec![channel] }),
        }
    }
}

/// The text attributes of a part, sorted by name.
fn metadata(header: &Header) -> Vec<(String, String)> {
    let own = &header.own_attributes;
    let named = [("owner", &own.owner), ("comments", &own.comments), ("capDate", &own.capture_date)];
    let named = named.into_iter().filter_map(|(name, text)| Some((name.to_string(), utf8(text.as_ref()?))));
    let other =
        own.other.iter().chain(&header.shared_attributes.other).filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((utf8(name), utf8(text))),
            _ => None,
        });
    let mut all: Vec<_> = named.chain(other).collect();
    all.sort();
    all.dedup();
    all
}

fn utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

pub(super) fn told(error: &Error) -> ReadError {
    match error {
        Error::NotSupported(what) => ReadError::file(format!("this kind of EXR is not supported: {what}")),
        Error::Invalid(what) => ReadError::file(format!("the EXR file is damaged: {what}")),
        Error::Io(error) => ReadError::file(format!("the EXR file is damaged: {error}")),
        Error::Aborted => ReadError::file("reading was stopped"),
    }
}
