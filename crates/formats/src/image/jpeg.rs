//! JPEG: baseline and progressive, grey, colours and CMYK.

use straal_scene::Image;
use straal_scene::bitmap::Number;
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use super::coded::{Coded, zeros};
use super::header::PIXEL;
use super::light::Light;
use super::{Format, Header};
use crate::{Limits, ReadError};

/// A picture has no more pixels for each byte of its file: a square of 16 x 16 takes at least 12 bits where all of it is one
/// colour, less where a progressive file tells many of them at once.
const MOST_PIXELS_A_BYTE: usize = 4096;

/// Reads a JPEG as linear light with the primaries of sRGB.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    Ok(read_codes(bytes, limits)?.into_photo().to_srgb())
}

/// Its codes. CMYK becomes RGB as if inks were perfect filters.
pub(super) fn read_codes(bytes: &[u8], limits: &Limits) -> Result<Coded, ReadError> {
    limits.check_bytes(bytes)?;
    let mut decoder = open(bytes)?;
    let (width, height) = size(&decoder)?;
    let count = limits.check_size(width as u64, height as u64)?;
    if count / MOST_PIXELS_A_BYTE > bytes.len() {
        return Err(ReadError::file(format!(
            "the header promises {width} x {height} pixels, which can't be in a file of {} bytes",
            bytes.len()
        )));
    }
    is_whole(bytes)?;
    let (out, channels) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (ColorSpace::Luma, 1),
        Some(ColorSpace::CMYK) => (ColorSpace::CMYK, 4),
        _ => (ColorSpace::RGB, 3),
    };
    decoder.set_options(options().jpeg_set_out_colorspace(out));
    let mut codes = zeros(count * channels)?;
    // What it takes must be what was made ready for it.
    if decoder.output_buffer_size().is_none_or(|size| size > codes.len()) {
        return Err(damaged("its colours make no sense"));
    }
    decoder.decode_into(&mut codes).map_err(|e| damaged(&told(&e.to_string())))?;
    if out == ColorSpace::CMYK {
        codes = rgb_of_inks(codes, is_adobe(bytes));
    }
    let profile = decoder.icc_profile();
    let mut light = Light::of_profile(profile.as_deref());
    if decoder.exif().is_some_and(|exif| is_turned(exif)) {
        light.notes.push("its EXIF data say that it is to be turned, which it isn't".into());
    }
    let channels = if channels == 4 { 3 } else { channels };
    Ok(Coded { format: Format::Jpeg, width, height, channels, bytes: codes, light })
}

/// What its header promises.
pub(super) fn header(bytes: &[u8], limits: &Limits) -> Result<Header, ReadError> {
    let decoder = open(bytes)?;
    let (width, height) = size(&decoder)?;
    let pixels = limits.check_size(width as u64, height as u64)? as u64;
    let channels = decoder.input_colorspace().map_or(3, |space| space.num_components());
    // Codes, and the coefficients of a progressive picture, of 16 bits.
    let decoded_bytes = pixels.saturating_mul(PIXEL + 3 * channels as u64);
    Ok(Header {
        format: Format::Jpeg,
        width,
        height,
        channels,
        decoded_bytes,
        texel: Header::texel(Number::Byte, if channels == 1 { 1 } else { 3 }),
    })
}

fn options() -> DecoderOptions {
    // Limits are checked here.
    DecoderOptions::default().set_max_width(1 << 16).set_max_height(1 << 16).set_strict_mode(false)
}

fn open(bytes: &[u8]) -> Result<JpegDecoder<ZCursor<&[u8]>>, ReadError> {
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options());
    decoder.decode_headers().map_err(|e| damaged(&told(&e.to_string())))?;
    Ok(decoder)
}

fn size(decoder: &JpegDecoder<ZCursor<&[u8]>>) -> Result<(usize, usize), ReadError> {
    decoder.dimensions().ok_or_else(|| damaged("it has no size"))
}

fn damaged(problem: &str) -> ReadError {
    ReadError::file(format!("the JPEG file is damaged, or of a rare kind: {problem}"))
}

/// What the decoder says, without the marks around it.
fn told(problem: &str) -> String {
    problem.trim().trim_matches('"').trim_end_matches('.').to_owned()
}

/// After the last scan begins there must be an end: within the pixels' own data neither mark can stand.
fn is_whole(bytes: &[u8]) -> Result<(), ReadError> {
    let last = |mark: u8| memchr::memmem::rfind(bytes, &[0xff, mark]);
    match (last(0xda), last(0xd9)) {
        (Some(scan), Some(end)) if end > scan => Ok(()),
        _ => Err(ReadError::file("the JPEG file is damaged: it ends before its picture does")),
    }
}

/// Whether a segment of Adobe's is there: their inks are inverted.
fn is_adobe(bytes: &[u8]) -> bool {
    memchr::memmem::find(bytes, b"\xff\xee\x00\x0eAdobe").is_some()
}

fn rgb_of_inks(mut codes: Vec<u8>, is_inverted: bool) -> Vec<u8> {
    let flip = if is_inverted { 0 } else { 255 };
    for i in 0..codes.len() / 4 {
        let black = u16::from(codes[4 * i + 3] ^ flip);
        for c in 0..3 {
            let ink = u16::from(codes[4 * i + c] ^ flip);
            codes[3 * i + c] = ((ink * black + 127) / 255) as u8;
        }
    }
    codes.truncate(codes.len() / 4 * 3);
    codes
}

/// Whether EXIF data tell another orientation than the usual: tag 0x0112 of the first directory.
fn is_turned(exif: &[u8]) -> bool {
    let little = exif.starts_with(b"II");
    let short = |at: usize| {
        let b = exif.get(at..)?.first_chunk::<2>()?;
        Some(if little { u16::from_le_bytes(*b) } else { u16::from_be_bytes(*b) })
    };
    let long = |at: usize| {
        let b = exif.get(at..)?.first_chunk::<4>()?;
        Some(if little { u32::from_le_bytes(*b) } else { u32::from_be_bytes(*b) } as usize)
    };
    let found = || {
        let first = long(4)?;
        let count = usize::from(short(first)?);
        let entry = (0..count).map(|i| first + 2 + 12 * i).find(|at| short(*at) == Some(0x0112))?;
        short(entry + 8)
    };
    found().is_some_and(|orientation| (2..=8).contains(&orientation))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inks_become_colours() {
        // Adobe's: 255 is no ink.
        assert_eq!(rgb_of_inks(vec![255, 0, 255, 255, 200, 200, 200, 0], true), [255, 0, 255, 0, 0, 0]);
        assert_eq!(rgb_of_inks(vec![0, 255, 0, 0], false), [255, 0, 255]);
    }

    #[test]
    fn a_turned_picture_is_known() {
        let exif = |orientation: u8| {
            let mut bytes = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0".to_vec();
            bytes.extend([orientation, 0, 0, 0]);
            bytes
        };
        assert!(is_turned(&exif(6)) && !is_turned(&exif(1)) && !is_turned(&exif(6)[..18]) && !is_turned(b""));
    }
}
