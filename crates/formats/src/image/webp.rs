//! WebP: lossy and lossless, with and without transparency; of a moving picture the first frame.

use std::io::Cursor;

use image_webp::WebPDecoder;
use straal_scene::Image;

use super::coded::{Coded, Codes, zeros};
use super::light::Light;
use super::{Format, Header};
use crate::{Limits, ReadError};

/// Reads a WebP as linear light with the primaries of sRGB.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    Ok(read_codes(bytes, limits)?.into_photo().to_srgb())
}

/// Its codes.
pub(super) fn read_codes(bytes: &[u8], limits: &Limits) -> Result<Coded, ReadError> {
    limits.check_bytes(bytes)?;
    let mut decoder = open(bytes)?;
    let (width, height) = decoder.dimensions();
    let count = limits.check_size(width.into(), height.into())?;
    decoder.set_memory_limit(count.saturating_mul(16).saturating_add(bytes.len()));
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let size = count * channels;
    if decoder.output_buffer_size() != Some(size) {
        return Err(damaged("its size makes no sense"));
    }
    let profile = decoder.icc_profile().map_err(|e| damaged(&e.to_string()))?;
    let mut codes = zeros(size)?;
    decoder.read_image(&mut codes).map_err(|e| damaged(&e.to_string()))?;
    let mut light = Light::of_profile(profile.as_deref());
    if decoder.is_animated() {
        light.notes.push("it is a moving picture: its first frame is taken".into());
    }
    let (width, height) = (width as usize, height as usize);
    Ok(Coded { format: Format::Webp, width, height, channels, bytes: codes, light })
}

/// What its header promises. It stands in the first bytes of each of the three kinds (RFC 9649).
pub(super) fn header(bytes: &[u8], limits: &Limits) -> Result<Header, ReadError> {
    let short = |at: usize| bytes.get(at..)?.first_chunk::<2>().map(|b| usize::from(u16::from_le_bytes(*b)));
    let long = |at: usize| bytes.get(at..)?.first_chunk::<4>().map(|b| u32::from_le_bytes(*b) as usize);
    let found = match bytes.get(12..16) {
        Some(b"VP8 ") => short(26).zip(short(28)).map(|(w, h)| (w & 0x3fff, h & 0x3fff, 3)),
        Some(b"VP8L") => long(21).map(|v| ((v & 0x3fff) + 1, (v >> 14 & 0x3fff) + 1, 3 + (v >> 28 & 1))),
        Some(b"VP8X") => long(24)
            .zip(long(26))
            .zip(bytes.get(20))
            .map(|((w, h), flags)| ((w & 0x00ff_ffff) + 1, (h >> 8) + 1, 3 + usize::from(flags >> 4 & 1))),
        _ => None,
    };
    let (width, height, channels) = found.ok_or_else(|| damaged("it doesn't begin with its size"))?;
    // Codes twice, as decoded and as given.
    Codes { format: Format::Webp, size: [width, height], channels, passing: 8 }.header(limits)
}

fn open(bytes: &[u8]) -> Result<WebPDecoder<Cursor<&[u8]>>, ReadError> {
    WebPDecoder::new(Cursor::new(bytes)).map_err(|e| damaged(&e.to_string()))
}

fn damaged(problem: &str) -> ReadError {
    ReadError::damaged("WebP", problem)
}
