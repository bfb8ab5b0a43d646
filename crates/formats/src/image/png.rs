//! PNG: 8 or 16 bits out; any PNG in.

use std::io::{self, Cursor, Write};

use straal_scene::Image;
use straal_scene::bitmap::{Bitmap, Number, TexelFormat, Texels};

use super::header::PIXEL;
use super::light::Light;
use super::{Format, Header, Photo, coded};
use crate::{Limits, ReadError};

mod light;

/// An encoded picture and the text that goes with it.
#[derive(Clone, Copy, Debug)]
pub struct Encoded<'a> {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// `width * height` pixels of R, G, B, row by row from the top.
    pub pixels: Pixels<'a>,
    /// How light was encoded.
    pub curve: Curve,
    /// Keyword and text, as `iTXt` chunks in this order. A keyword has 1 to 79 Latin-1 characters.
    pub metadata: &'a [(String, String)],
}

/// Codes of pixels.
#[derive(Clone, Copy, Debug)]
pub enum Pixels<'a> {
    /// 8 bits a channel.
    Eight(&'a [[u8; 3]]),
    /// 16 bits a channel.
    Sixteen(&'a [[u16; 3]]),
}

/// How a PNG says its light was encoded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Curve {
    /// As sRGB (chunk `sRGB`).
    #[default]
    Srgb,
    /// Codes are the 1/gamma-th power of light (chunk `gAMA`).
    Gamma(f32),
}

/// How a PNG that was read encodes light.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoding {
    /// Bits a channel: 8, which fewer count as, or 16.
    pub bits: u32,
    /// As [`write()`] can write it again; `None` where it can't.
    pub curve: Option<Curve>,
    /// The curve in words.
    pub told: String,
}

/// Reads a PNG of any depth and kind as linear light with the primaries of sRGB, as [`read_photo`] does.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    Ok(read_photo(bytes, limits)?.to_srgb())
}

/// Reads a PNG of any depth and kind as linear light of its own primaries. How its numbers become light is told by its chunks, as the
/// standard has it: the first of `cICP`, `iCCP`, `sRGB` that is there and understood, else `gAMA` and `cHRM`, else they are sRGB.
/// Transparency is left out.
pub fn read_photo(bytes: &[u8], limits: &Limits) -> Result<Photo, ReadError> {
    let mut opened = Opened::new(bytes, limits)?;
    let Opened { width, height, channels, depth, .. } = opened;
    let codes = opened.codes();
    let tables = opened.light.tables(codes);
    let code = |pixel: &[u8], channel: usize| match pixel[channel * depth..][..depth] {
        [high, low] => usize::from(u16::from_be_bytes([high, low])),
        [code] => usize::from(code),
        _ => 0,
    };
    let (green, blue) = if channels >= 3 { (1, 2) } else { (0, 0) };
    let has_alpha = channels % 2 == 0;
    let mut is_transparent = false;
    let mut pixels = Vec::with_capacity(width * height);
    opened.rows(|_, row| {
        pixels.extend(row.chunks_exact(channels * depth).take(width).map(|pixel| {
            is_transparent |= has_alpha && code(pixel, channels - 1) < codes - 1;
            [tables[0][code(pixel, 0)], tables[1][code(pixel, green)], tables[2][code(pixel, blue)]]
        }));
    })?;
    let Opened { mut light, metadata, .. } = opened;
    if is_transparent {
        light.notes.push("its transparency is left out".into());
    }
    let image = Image { width, height, pixels };
    Ok(Photo {
        space: light.space,
        encoding: Some(light.encoding),
        metadata,
        notes: light.notes,
        ..Photo::of_image(Format::Png, image)
    })
}

/// Reads a PNG of any depth and kind as a texture takes it: its codes.
pub(super) fn read_bitmap(bytes: &[u8], limits: &Limits) -> Result<(Bitmap, Vec<String>), ReadError> {
    let mut opened = Opened::new(bytes, limits)?;
    let Opened { width, height, channels, depth, .. } = opened;
    let number = if depth == 2 { Number::Short } else { Number::Byte };
    let format = TexelFormat { number, channels: if channels == 3 { 4 } else { channels } };
    let mut texels = Texels::new(width, height, format).ok_or_else(coded::no_memory)?;
    opened.rows(|y, row| {
        for (x, pixel) in row.chunks_exact(channels * depth).take(width).enumerate() {
            // Fully there, unless it says otherwise; 16 bits in the machine's order.
            let mut bytes = [255; 8];
            bytes[..pixel.len()].copy_from_slice(pixel);
            if depth == 2 {
                for code in bytes.as_chunks_mut::<2>().0 {
                    *code = u16::from_be_bytes(*code).to_ne_bytes();
                }
            }
            texels.put(x, y, &bytes[..format.bytes()]);
        }
    })?;
    let (response, space) = opened.light.of_codes(opened.codes());
    Ok((Bitmap { texels, response, space, has_alpha: channels % 2 == 0 }, opened.light.notes))
}

/// A PNG of which all is read but its pixels.
struct Opened<'b> {
    reader: png::Reader<Cursor<&'b [u8]>>,
    width: usize,
    height: usize,
    /// Codes of a pixel, and bytes of each, once palettes and few bits are expanded.
    channels: usize,
    depth: usize,
    light: Light,
    metadata: Vec<(String, String)>,
}

impl<'b> Opened<'b> {
    fn new(bytes: &'b [u8], limits: &Limits) -> Result<Self, ReadError> {
        limits.check_bytes(bytes)?;
        limits.check_decoded(header(bytes, limits)?.decoded_bytes)?;
        let mut decoder = png::Decoder::new(Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let reader = decoder.read_info().map_err(told)?;
        let (width, height) = reader.info().size();
        limits.check_size(width.into(), height.into())?;
        // Deflate can't do better than 1:1032; a header that promises more has nothing to back it.
        if reader.info().raw_bytes() as u64 / 2048 > bytes.len() as u64 {
            return Err(ReadError::file(format!(
                "the header promises {width} x {height} pixels, which can't be in a file of {} bytes",
                bytes.len()
            )));
        }
        let light = light_of(bytes, reader.info());
        let metadata = texts(reader.info());
        let (kind, depth) = reader.output_color_type();
        let depth = if depth == png::BitDepth::Sixteen { 2 } else { 1 };
        let (width, height) = (width as usize, height as usize);
        Ok(Self { width, height, channels: kind.samples(), depth, light, metadata, reader })
    }

    /// How many codes there are.
    fn codes(&self) -> usize {
        1 << (8 * self.depth)
    }

    /// Gives `each` row after row, from the top.
    fn rows(&mut self, mut each: impl FnMut(usize, &[u8])) -> Result<(), ReadError> {
        let Self { reader, width, height, channels, depth, .. } = self;
        let length = *width * *channels * *depth;
        let mut count = 0;
        if reader.info().interlaced {
            let size =
                reader.output_buffer_size().ok_or_else(|| ReadError::file("the picture is too large"))?;
            let mut raw = vec![0; size];
            reader.next_frame(&mut raw).map_err(told)?;
            for row in raw.chunks_exact(length).take(*height) {
                each(count, row);
                count += 1;
            }
        } else {
            // Row by row, so that what is decoded needn't be kept.
            while count < *height {
                let Some(row) = reader.next_row().map_err(told)? else { break };
                let Some(row) = row.data().get(..length) else { break };
                each(count, row);
                count += 1;
            }
        }
        reader.finish().map_err(told)?;
        if count < *height {
            return Err(ReadError::file("the PNG file is damaged: pixels are missing"));
        }
        Ok(())
    }
}

fn told(error: png::DecodingError) -> ReadError {
    // What it says of sums is not for people.
    if error.to_string().starts_with("CRC error") {
        return ReadError::file("the PNG file is damaged: a checksum is wrong");
    }
    ReadError::file(format!("the PNG file is damaged: {error}"))
}

/// Keywords and texts, as much of them as anybody reads: some can be unpacked to a thousand times the file.
fn texts(info: &png::Info<'_>) -> Vec<(String, String)> {
    let mut left: usize = 1 << 24;
    let mut text = |chunk: &png::text_metadata::ITXtChunk| {
        let mut chunk = chunk.clone();
        chunk.decompress_text_with_limit(left).ok()?;
        let text = chunk.get_text().ok()?;
        left = left.checked_sub(text.len())?;
        Some((chunk.keyword, text))
    };
    info.utf8_text.iter().filter_map(&mut text).collect()
}

/// How the codes of a PNG become light.
fn light_of(bytes: &[u8], info: &png::Info<'_>) -> Light {
    // A profile that the decoder couldn't unpack leaves no trace in its information.
    Light::of(info, has_chunk(bytes, *b"iCCP"))
}

/// Whether a chunk of that name stands before the pixels.
fn has_chunk(bytes: &[u8], name: [u8; 4]) -> bool {
    let mut rest = bytes.get(8..).unwrap_or_default();
    while let Some((start, after)) = rest.split_first_chunk::<8>() {
        let length = u32::from_be_bytes([start[0], start[1], start[2], start[3]]);
        if start[4..] == name {
            return true;
        }
        if start[4..] == *b"IDAT" {
            break;
        }
        rest = after.get((length as usize).saturating_add(4)..).unwrap_or_default();
    }
    false
}

/// What the first chunk promises. It is read by hand, as the decoder wants all that stands before the pixels.
pub(super) fn header(bytes: &[u8], limits: &Limits) -> Result<Header, ReadError> {
    let damaged = || ReadError::file("the PNG file is damaged: it doesn't begin with its size");
    let start = bytes.first_chunk::<29>().filter(|b| b[12..16] == *b"IHDR").ok_or_else(damaged)?;
    let number = |at: usize| u32::from_be_bytes([start[at], start[at + 1], start[at + 2], start[at + 3]]);
    let (width, height) = (number(16), number(20));
    let (channels, expanded): (usize, u64) = match start[25] {
        0 => (1, 1),
        2 => (3, 3),
        // A palette becomes colours, and grey or colours may become transparent.
        3 => (1, 4),
        4 => (2, 2),
        6 => (4, 4),
        other => {
            return Err(ReadError::file(format!("the PNG file is damaged: there is no colour type {other}")));
        }
    };
    // A colour, or entries of the palette, that are transparent: then all pixels get their share of being there.
    let (channels, expanded) = match expanded {
        1 if has_chunk(bytes, *b"tRNS") => (2, 2),
        3 | 4 if channels != 4 && has_chunk(bytes, *b"tRNS") => (channels + 1, 4),
        _ => (channels, expanded),
    };
    let depth = if start[24] == 16 { 2 } else { 1 };
    let pixels = limits.check_size(width.into(), height.into())? as u64;
    // An interlaced picture is decoded as a whole before it becomes light.
    let whole = if start[28] == 0 { 0 } else { pixels.saturating_mul((expanded + 1) * depth) };
    Ok(Header {
        format: Format::Png,
        width: width as usize,
        height: height as usize,
        channels,
        decoded_bytes: pixels.saturating_mul(PIXEL).saturating_add(whole),
        texel: Header::texel(if depth == 2 { Number::Short } else { Number::Byte }, expanded as usize),
    })
}

/// Width, height and the texts (`iTXt`, by keyword in the order of the file) of a PNG, without its pixels. Only what
/// stands before the pixels is found, which is where [`write()`] puts it.
pub fn read_metadata(bytes: &[u8], limits: &Limits) -> Result<Metadata, ReadError> {
    limits.check_bytes(bytes)?;
    let reader = png::Decoder::new(Cursor::new(bytes)).read_info().map_err(told)?;
    Ok(Metadata { size: reader.info().size(), texts: texts(reader.info()) })
}

/// What a PNG tells about itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Keywords and texts.
    pub texts: Vec<(String, String)>,
}

/// Writes a picture that textures are read off as the codes that it has, without a word of what they mean. Of one of floating point, which no
/// PNG holds, `None`.
pub fn write_codes<W: Write>(writer: W, picture: &Bitmap) -> Option<io::Result<()>> {
    let texels = &picture.texels;
    let TexelFormat { number, channels } = texels.format();
    let depth = match number {
        Number::Byte => png::BitDepth::Eight,
        Number::Short => png::BitDepth::Sixteen,
        Number::Half | Number::Single => return None,
    };
    let (color, kept) = match (channels, picture.has_alpha) {
        (1, _) => (png::ColorType::Grayscale, 1),
        (2, _) => (png::ColorType::GrayscaleAlpha, 2),
        (_, false) => (png::ColorType::Rgb, 3),
        (_, true) => (png::ColorType::Rgba, 4),
    };
    let mut bytes = Vec::new();
    for y in 0..texels.height() {
        for x in 0..texels.width() {
            for v in &texels.numbers(x, y)[..kept] {
                match depth {
                    png::BitDepth::Eight => bytes.push(*v as u8),
                    _ => bytes.extend((*v as u16).to_be_bytes()),
                }
            }
        }
    }
    let wrong = |problem: String| io::Error::new(io::ErrorKind::InvalidInput, problem);
    let told = |error: png::EncodingError| match error {
        png::EncodingError::IoError(error) => error,
        other => wrong(other.to_string()),
    };
    let written = || {
        let size = |size: usize| u32::try_from(size).map_err(|e| wrong(e.to_string()));
        let mut encoder = png::Encoder::new(writer, size(texels.width())?, size(texels.height())?);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().map_err(told)?;
        writer.write_image_data(&bytes).map_err(told)?;
        writer.finish().map_err(told)
    };
    Some(written())
}

/// Writes a PNG.
pub fn write<W: Write>(writer: W, picture: &Encoded<'_>) -> io::Result<()> {
    let wrong = |problem: &str| io::Error::new(io::ErrorKind::InvalidInput, problem.to_string());
    let size = |size: usize| u32::try_from(size).map_err(|_| wrong("the picture is too large for a PNG"));
    let (count, depth) = match picture.pixels {
        Pixels::Eight(pixels) => (pixels.len(), png::BitDepth::Eight),
        Pixels::Sixteen(pixels) => (pixels.len(), png::BitDepth::Sixteen),
    };
    if count != picture.width * picture.height {
        return Err(wrong("the picture's size and pixels differ"));
    }
    let mut encoder = png::Encoder::new(writer, size(picture.width)?, size(picture.height)?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(depth);
    match picture.curve {
        Curve::Srgb => encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual),
        Curve::Gamma(gamma) => encoder.set_source_gamma(png::ScaledFloat::new(1.0 / gamma)),
    }
    let told = |error: png::EncodingError| match error {
        png::EncodingError::IoError(error) => error,
        other => wrong(&other.to_string()),
    };
    for (keyword, text) in picture.metadata {
        encoder.add_itxt_chunk(keyword.clone(), text.clone()).map_err(told)?;
    }
    let mut writer = encoder.write_header().map_err(told)?;
    match picture.pixels {
        Pixels::Eight(pixels) => writer.write_image_data(pixels.as_flattened()).map_err(told)?,
        Pixels::Sixteen(pixels) => {
            let bytes: Vec<u8> = pixels.as_flattened().iter().flat_map(|code| code.to_be_bytes()).collect();
            writer.write_image_data(&bytes).map_err(told)?;
        }
    }
    writer.finish().map_err(told)
}
