//! PNG: 8 or 16 bits out; any PNG in.

use std::io::{self, Cursor, Write};

use straal_color::srgb;
use straal_scene::Image;

use crate::{Limits, ReadError};

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

/// Reads a PNG of any depth and kind as linear light. Its numbers are taken as sRGB: `gAMA`, `cHRM` and `iCCP` are
/// not looked at, as files that carry them are wrong more often than right. Transparency is left out.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    limits.check_bytes(bytes)?;
    let told = |error: png::DecodingError| ReadError::file(format!("the PNG file is damaged: {error}"));
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut reader = decoder.read_info().map_err(told)?;
    let (width, height) = reader.info().size();
    let pixels = limits.check_size(width.into(), height.into())?;
    // Deflate can't do better than 1:1032; a header that promises more has nothing to back it.
    if reader.info().raw_bytes() as u64 / 2048 > bytes.len() as u64 {
        return Err(ReadError::file(format!(
            "the header promises {width} x {height} pixels, which can't be in a file of {} bytes",
            bytes.len()
        )));
    }
    let size = reader.output_buffer_size().ok_or_else(|| ReadError::file("the picture is too large"))?;
    let mut raw = vec![0; size];
    let frame = reader.next_frame(&mut raw).map_err(told)?;
    reader.finish().map_err(told)?;
    let channels = frame.color_type.samples();
    let (codes, depth) = if frame.bit_depth == png::BitDepth::Sixteen { (1 << 16, 2) } else { (1 << 8, 1) };
    let table: Vec<f32> = (0..codes).map(|code| srgb::decode(code as f32 / (codes - 1) as f32)).collect();
    let code = |sample: &[u8]| match *sample {
        [high, low] => usize::from(u16::from_be_bytes([high, low])),
        [code] => usize::from(code),
        _ => 0,
    };
    let (green, blue) = if channels >= 3 { (1, 2) } else { (0, 0) };
    let pixels: Vec<[f32; 3]> = raw
        .chunks_exact(channels * depth)
        .take(pixels)
        .map(|pixel| [0, green, blue].map(|k| table[code(&pixel[k * depth..][..depth])]))
        .collect();
    Ok(Image { width: width as usize, height: height as usize, pixels })
}

/// Width, height and the texts (`iTXt`, by keyword in the order of the file) of a PNG, without its pixels. Only what
/// stands before the pixels is found, which is where [`write()`] puts it.
pub fn read_metadata(bytes: &[u8], limits: &Limits) -> Result<Metadata, ReadError> {
    limits.check_bytes(bytes)?;
    let told = |error: png::DecodingError| ReadError::file(format!("the PNG file is damaged: {error}"));
    let reader = png::Decoder::new(Cursor::new(bytes)).read_info().map_err(told)?;
    let texts = reader.info().utf8_text.iter();
    let texts = texts.filter_map(|chunk| Some((chunk.keyword.clone(), chunk.get_text().ok()?)));
    Ok(Metadata { size: reader.info().size(), texts: texts.collect() })
}

/// What a PNG tells about itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Keywords and texts.
    pub texts: Vec<(String, String)>,
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
