//! OpenEXR: any channels of any layers as 32-bit floats.
//!
//! Read are scan lines and tiles (the largest resolution), uncompressed or with RLE, ZIP, PIZ or PXR24. Refused are
//! deep and subsampled files, and the compressions whose decoders in the `exr` crate (1.74) don't bear a damaged file:
//! B44 runs into arithmetic overflow, DWA allocates whatever the file says. Written are 32-bit floats in scan lines with ZIP compression, all layers in
//! one part, as every compositor reads it: the channel R of the layer albedo is called `albedo.R`.

use std::io::Cursor;

use exr::block::{BlockIndex, UncompressedBlock};
use exr::compression::Compression;
use exr::error::Error;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, Chromaticities, IntegerBounds, SampleType, Text};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use straal_color::{Adaptation, Chromaticity, RgbSpace, Space};
use straal_scene::Image;

use crate::limits::check;
use crate::{Limits, ReadError};

mod spectral;
mod write;

pub use spectral::{
    Contents as SpectralContents, LAYER as SPECTRAL_LAYER, is_attribute as is_spectral_attribute,
    is_layer as is_spectral_layer, layer as spectral_layer,
};
pub use write::write;

/// A picture with layers of any channels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// The frame that is shown.
    pub display_window: Window,
    /// The part of the plane that has pixels: the whole frame, or a crop of it.
    pub data_window: Window,
    /// The linear RGB space of the colours, where the file says it (attribute `chromaticities`).
    pub space: Option<RgbSpace>,
    /// The layers; the beauty picture is the one without a name.
    pub layers: Vec<Layer>,
    /// Text attributes by name, in alphabetical order when read.
    pub metadata: Vec<(String, String)>,
}

/// A rectangle of pixels; x goes right, y down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window {
    /// The leftmost column.
    pub x: i32,
    /// The topmost row.
    pub y: i32,
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
}

/// Channels that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// The name before the channels' last dot; empty for the picture itself.
    pub name: String,
    /// The channels: in a file they are sorted by name.
    pub channels: Vec<Channel>,
}

/// One number for every pixel of the data window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// The name without the layer's: R, G, B, Y, Z...
    pub name: String,
    /// The samples row by row from the top. Integers of the file are converted, exactly up to 2^24.
    pub samples: Vec<f32>,
}

impl Picture {
    /// A picture without layers whose windows are both `width` x `height`.
    pub fn of_size(width: usize, height: usize) -> Self {
        let window = Window::of_size(width, height);
        Self { display_window: window, data_window: window, ..Self::default() }
    }

    /// The layer of that name; the picture itself has the empty name.
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// The picture as linear RGB with the primaries of sRGB: that of [`Picture::beauty`].
    pub fn to_image(&self) -> Result<Image, ReadError> {
        let Beauty { mut pixels, space, .. } = self.beauty()?;
        let srgb = Space::Srgb.rgb();
        if let Some(space) = space.filter(|space| *space != srgb) {
            let matrix = space.to(&srgb, Adaptation::Bradford);
            pixels.iter_mut().for_each(|pixel| *pixel = matrix.apply_f32(*pixel));
        }
        Ok(Image { width: self.data_window.width, height: self.data_window.height, pixels })
    }

    /// The colours of the picture: the layer without a name; else X, Y and Z there; else the sum of its wavelengths, of radiance
    /// or of reflectance under D65; else the first layer that has colours or grey.
    pub fn beauty(&self) -> Result<Beauty, ReadError> {
        let of = |layer: &Layer| {
            layer.rgb().map(|pixels| Beauty { pixels, space: self.space, layer: layer.name.clone() })
        };
        let unnamed = self.layer("");
        let xyz = || {
            let pixels = unnamed?.triples(["X", "Y", "Z"])?;
            Some(Beauty { pixels, space: Some(RgbSpace::XYZ), layer: String::new() })
        };
        let named_rgb = |layer: &&Layer| layer.triples(["R", "G", "B"]).is_some();
        { unnamed }
            .filter(named_rgb)
            .and_then(of)
            .or_else(xyz)
            .or_else(|| unnamed.and_then(of))
            .or_else(|| spectral::beauty(self))
            .or_else(|| self.layers.iter().find_map(of))
            .ok_or_else(|| {
                let message = "the file has no layer with channels R, G and B, or X, Y and Z, or Y, nor any of wavelengths \
                               (S0.550,000nm or T.550,000nm)";
                ReadError::file(message)
            })
    }
}

/// The colours of a picture with layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Beauty {
    /// Row by row from the top.
    pub pixels: Vec<[f32; 3]>,
    /// What the three numbers are, where the file says it.
    pub space: Option<RgbSpace>,
    /// The layer they come from.
    pub layer: String,
}

impl Window {
    /// A window whose first pixel is (0, 0).
    pub fn of_size(width: usize, height: usize) -> Self {
        Self { x: 0, y: 0, width, height }
    }
}

impl Layer {
    /// A layer with the channels R, G and B.
    pub fn from_rgb(name: &str, pixels: &[[f32; 3]]) -> Self {
        let channel = |(k, name): (usize, &str)| Channel {
            name: name.to_string(),
            samples: pixels.iter().map(|pixel| pixel[k]).collect(),
        };
        Self {
            name: name.to_string(),
            channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect(),
        }
    }

    /// The channel of that name.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| channel.samples.as_slice())
    }

    /// The pixels of a layer with R, G and B; grey from Y, or from the only channel there is.
    pub fn rgb(&self) -> Option<Vec<[f32; 3]>> {
        let only = || (self.channels.len() == 1).then(|| self.channels[0].samples.as_slice());
        let grey = || self.channel("Y").or_else(only);
        self.triples(["R", "G", "B"]).or_else(|| Some(grey()?.iter().map(|&y| [y; 3]).collect()))
    }

    /// The pixels of three channels.
    fn triples(&self, names: [&str; 3]) -> Option<Vec<[f32; 3]>> {
        let [a, b, c] = names.map(|name| self.channel(name));
        Some(a?.iter().zip(b?).zip(c?).map(|((&a, &b), &c)| [a, b, c]).collect())
    }
}

/// No compression of the format makes pixels smaller than this: deflate's limit is 1:1032, and the Huffman runs of
/// PIZ come near it. A file that promises more is lying.
const MAX_COMPRESSION: u64 = 2048;

/// Reads a picture. Parts with other data windows than the first are cut or filled with zeros to fit it.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Picture, ReadError> {
    limits.check_bytes(bytes)?;
    let mut cursor = Cursor::new(bytes);
    let meta = MetaData::read_from_buffered(&mut cursor, false).map_err(|error| told(&error))?;
    let headers = meta.headers.as_slice();
    check_promises(headers, bytes.len(), limits)?;
    check_chunks(&meta, bytes, cursor.position() as usize)?;
    let Some(first) = headers.first() else {
        return Err(ReadError::file("the file has no part"));
    };
    let bounds =
        |b: IntegerBounds| Window { x: b.position.0, y: b.position.1, width: b.size.0, height: b.size.1 };
    let data_window = bounds(first.data_window());
    let mut picture = Picture {
        display_window: bounds(first.shared_attributes.display_window),
        data_window,
        space: first.shared_attributes.chromaticities.and_then(space),
        layers: Vec::new(),
        metadata: metadata(first),
    };

    let size = data_window.width * data_window.height; // checked against the limits
    let mut planes: Vec<Vec<Vec<f32>>> =
        headers.iter().map(|header| vec![vec![0.0; size]; header.channels.list.len()]).collect();
    let reader = exr::block::read(Cursor::new(bytes), false);
    let chunks = reader.and_then(|reader| reader.all_chunks(false)).map_err(|error| told(&error))?;
    for chunk in chunks {
        let block = chunk.and_then(|chunk| UncompressedBlock::decompress_chunk(chunk, &meta, false));
        let block = block.map_err(|error| told(&error))?;
        if block.index.level == Vec2(0, 0) {
            let header = &headers[block.index.layer];
            copy_block(header, &block, data_window, &mut planes[block.index.layer])?;
        }
    }
    for (header, planes) in headers.iter().zip(planes) {
        add_layers(header, planes, &mut picture.layers);
    }
    Ok(picture)
}

/// The space that a file tells in single precision: the exact one where it has a name, and none where it makes no sense.
fn space(told: Chromaticities) -> Option<RgbSpace> {
    let at = |Vec2(x, y): Vec2<f32>| Chromaticity { x: f64::from(x), y: f64::from(y) };
    let space = RgbSpace { primaries: [told.red, told.green, told.blue].map(at), white: at(told.white) };
    Some(space.recognised()).filter(RgbSpace::is_sound)
}

/// Refuses what is beyond the limits, or beyond what the bytes of the file can hold, before any pixel is allocated.
fn check_promises(headers: &[Header], file_size: usize, limits: &Limits) -> Result<(), ReadError> {
    let file_size = file_size as u64;
    let mut samples = 0u64;
    let mut bytes = 0u64;
    let mut chunks = 0u64;
    let planes = headers.first().map_or(Vec2(0, 0), |header| header.layer_size);
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
        let channels = header.channels.list.len() as u64;
        if channels == 0 {
            return Err(ReadError::file("the picture has no channels"));
        }
        if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
            return Err(ReadError::file("pictures with subsampled channels are not supported"));
        }
        for size in [header.layer_size, planes] {
            let pixels = limits.check_size(size.0 as u64, size.1 as u64)? as u64;
            samples = samples.saturating_add(pixels.saturating_mul(channels));
            bytes = bytes.saturating_add(pixels.saturating_mul(header.channels.bytes_per_pixel as u64));
        }
        if let BlockDescription::Tiles(tiles) = header.blocks {
            // A tile may reach beyond the picture, but one that is much larger is made to waste memory.
            limits.check_size(tiles.tile_size.0 as u64, tiles.tile_size.1 as u64)?;
        }
        chunks = chunks.saturating_add(header.chunk_count as u64);
    }
    check("numbers", samples / 2, limits.max_samples)?;
    let promised = (bytes / 2 / MAX_COMPRESSION).saturating_add(chunks.saturating_mul(8));
    if promised > file_size {
        let Vec2(width, height) = planes;
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
fn copy_block(
    header: &Header,
    block: &UncompressedBlock,
    window: Window,
    planes: &mut [Vec<f32>],
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
            if (0..window.height as i64).contains(&y) && from < to {
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

/// Sorts the channels of a part into layers by the name before the last dot, and the part's own.
fn add_layers(header: &Header, planes: Vec<Vec<f32>>, layers: &mut Vec<Layer>) {
    let part = header.own_attributes.layer_name.as_ref().map(Text::to_string).unwrap_or_default();
    let start = layers.len();
    for (channel, samples) in header.channels.list.iter().zip(planes) {
        let full = channel.name.to_string();
        let (prefix, name) = full.rsplit_once('.').unwrap_or(("", &full));
        let layer = match (part.as_str(), prefix) {
            ("", prefix) => prefix.to_string(),
            (part, "") => part.to_string(),
            (part, prefix) if part == prefix => part.to_string(),
            (part, prefix) => format!("{part}.{prefix}"),
        };
        let channel = Channel { name: name.to_string(), samples };
        match layers[start..].iter_mut().find(|known| known.name == layer) {
            Some(known) => known.channels.push(channel),
            None => layers.push(Layer { name: layer, channels: vec![channel] }),
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

fn told(error: &Error) -> ReadError {
    match error {
        Error::NotSupported(what) => ReadError::file(format!("this kind of EXR is not supported: {what}")),
        Error::Invalid(what) => ReadError::file(format!("the EXR file is damaged: {what}")),
        Error::Io(error) => ReadError::file(format!("the EXR file is damaged: {error}")),
        Error::Aborted => ReadError::file("reading was stopped"),
    }
}
