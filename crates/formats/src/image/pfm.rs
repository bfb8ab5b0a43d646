//! PFM, the portable float map: raw floats, rows from the bottom.

use std::io::{self, Write};

use straal_scene::Image;
use straal_scene::bitmap::Number;

use super::header::PIXEL;
use super::{Format, Header};
use crate::read_error::quoted;
use crate::{Limits, ReadError};

/// Reads a PFM in colour (`PF`) or grey (`Pf`), either byte order. The scale in its header, whose sign tells the
/// order, has units that nobody agrees on: it is not applied.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    limits.check_bytes(bytes)?;
    let Start { channels, width, height, scale, length: at } = Start::parse(bytes)?;
    let pixels = limits.check_size(width.into(), height.into())?;
    limits.check_decoded((pixels as u64).saturating_mul(PIXEL))?;
    let (width, height) = (width as usize, height as usize);
    let body = bytes.get(at..).unwrap_or_default();
    let samples = pixels.checked_mul(channels).filter(|&n| body.len() / 4 >= n);
    let Some(samples) = samples else {
        let problem =
            format!("{width} x {height} pixels are promised, but only {} bytes are there", body.len());
        return Err(ReadError::byte(at, problem));
    };
    let decode = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let rows = body.as_chunks::<4>().0[..samples].chunks_exact(width * channels).rev();
    let mut light = Vec::with_capacity(pixels);
    for row in rows {
        if channels == 3 {
            light.extend(row.as_chunks::<3>().0.iter().map(|pixel| pixel.map(decode)));
        } else {
            light.extend(row.iter().map(|&grey| [decode(grey); 3]));
        }
    }
    Ok(Image { width, height, pixels: light })
}

/// What the header promises.
pub(super) fn header(bytes: &[u8], limits: &Limits) -> Result<Header, ReadError> {
    let Start { channels, width, height, .. } = Start::parse(bytes)?;
    let pixels = limits.check_size(width.into(), height.into())? as u64;
    let (width, height) = (width as usize, height as usize);
    let (decoded_bytes, texel) = (pixels.saturating_mul(PIXEL), Header::texel(Number::Single, channels));
    Ok(Header { format: Format::Pfm, width, height, channels, decoded_bytes, texel })
}

/// What stands before the pixels.
struct Start {
    channels: usize,
    width: u32,
    height: u32,
    /// Negative where the pixels' bytes begin with the lowest.
    scale: f32,
    /// Bytes up to the pixels.
    length: usize,
}

impl Start {
    fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let mut at = 0;
        let channels = match word(bytes, &mut at) {
            b"PF" => 3,
            b"Pf" => 1,
            _ => return Err(ReadError::file("not a PFM picture: it doesn't begin with 'PF' or 'Pf'")),
        };
        let width: u32 = number(bytes, &mut at, "the width")?;
        let height: u32 = number(bytes, &mut at, "the height")?;
        let scale: f32 = number(bytes, &mut at, "the scale")?;
        if scale == 0.0 || !scale.is_finite() {
            return Err(ReadError::byte(at, format!("the scale is {scale}")));
        }
        // Exactly one white space stands before the pixels.
        Ok(Self { channels, width, height, scale, length: at + 1 })
    }
}

/// Writes a PFM in colour, little-endian.
pub fn write<W: Write>(mut writer: W, image: &Image) -> io::Result<()> {
    if image.width == 0 || image.pixels.len() != image.width * image.height {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the picture's size and pixels differ"));
    }
    write!(writer, "PF\n{} {}\n-1.0\n", image.width, image.height)?;
    for row in image.pixels.chunks_exact(image.width).rev() {
        let bytes: Vec<u8> = row.iter().flatten().flat_map(|sample| sample.to_le_bytes()).collect();
        writer.write_all(&bytes)?;
    }
    Ok(())
}

fn word<'a>(bytes: &'a [u8], at: &mut usize) -> &'a [u8] {
    let rest = &bytes[*at..];
    let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
    let rest = &rest[start..];
    let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
    *at += start + length;
    &rest[..length]
}

fn number<T: std::str::FromStr>(bytes: &[u8], at: &mut usize, what: &str) -> Result<T, ReadError> {
    let word = word(bytes, at);
    let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
    number
        .ok_or_else(|| ReadError::byte(*at - word.len(), format!("expected {what}, found {}", quoted(word))))
}
