//! Pictures of 8-bit codes, as JPEG, WebP, TGA and BMP hold them.

use straal_scene::Image;
use straal_scene::bitmap::{Bitmap, Number, TexelFormat, Texels};

use super::header::PIXEL;
use super::light::Light;
use super::{Format, Header, Photo};
use crate::{Limits, ReadError};

/// A picture of 8-bit codes.
#[derive(Clone, Debug)]
pub(super) struct Coded {
    pub format: Format,
    pub width: usize,
    pub height: usize,
    /// Bytes of a pixel: grey, grey and alpha, RGB, or RGB and alpha.
    pub channels: usize,
    /// Row by row from the top.
    pub bytes: Vec<u8>,
    /// How codes become light.
    pub light: Light,
}

/// What a header says of such a picture.
pub(super) struct Codes {
    pub format: Format,
    /// Width and height.
    pub size: [usize; 2],
    /// Bytes of a pixel.
    pub channels: usize,
    /// Bytes that a pixel takes while it is decoded.
    pub passing: usize,
}

impl Codes {
    /// What it promises, if that is within the limits.
    pub fn header(self, limits: &Limits) -> Result<Header, ReadError> {
        let Self { format, size: [width, height], channels, passing } = self;
        let pixels = limits.check_size(width as u64, height as u64)? as u64;
        let decoded_bytes = pixels.saturating_mul(PIXEL + passing as u64);
        let texel = Header::texel(Number::Byte, channels);
        Ok(Header { format, width, height, channels, decoded_bytes, texel })
    }
}

/// What is said where a picture is too large for the memory that there is.
pub(super) fn no_memory() -> ReadError {
    ReadError::file("there is no memory for the picture's pixels")
}

/// So many bytes of zeros.
pub(super) fn zeros(count: usize) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(count).map_err(|_| no_memory())?;
    bytes.resize(count, 0);
    Ok(bytes)
}

/// A texel of a pixel's codes: three become four, fully there.
#[inline(always)]
pub(super) fn texel(pixel: &[u8]) -> [u8; 4] {
    match *pixel {
        [grey] => [grey, 0, 0, 0],
        [grey, alpha] => [grey, alpha, 0, 0],
        [r, g, b] => [r, g, b, 255],
        [r, g, b, a] => [r, g, b, a],
        _ => [0; 4],
    }
}

impl Coded {
    /// As a texture takes it, and what a person should know of it.
    pub fn into_bitmap(self) -> Result<(Bitmap, Vec<String>), ReadError> {
        let Self { width, height, channels, bytes, light, .. } = self;
        let format = TexelFormat { number: Number::Byte, channels: if channels == 3 { 4 } else { channels } };
        let mut texels = Texels::new(width, height, format).ok_or_else(no_memory)?;
        for (i, pixel) in bytes.chunks_exact(channels).take(width * height).enumerate() {
            texels.put(i % width, i / width, &texel(pixel)[..format.channels]);
        }
        let (response, space) = light.of_codes(256);
        let has_alpha = channels % 2 == 0;
        Ok((Bitmap { texels, response, space, has_alpha }, light.notes))
    }

    /// As light.
    pub fn into_photo(self) -> Photo {
        let Self { format, width, height, channels, bytes, mut light } = self;
        let tables = light.tables(256);
        let has_alpha = channels % 2 == 0;
        let mut is_transparent = false;
        let mut decode = |pixel: &[u8]| {
            is_transparent |= has_alpha && pixel[channels - 1] < 255;
            let at = |c: usize| usize::from(pixel[if channels < 3 { 0 } else { c }]);
            [tables[0][at(0)], tables[1][at(1)], tables[2][at(2)]]
        };
        let pixels = bytes.chunks_exact(channels).take(width * height).map(&mut decode).collect();
        if is_transparent {
            light.notes.push("its transparency is left out".into());
        }
        Photo {
            space: light.space,
            encoding: Some(light.encoding),
            notes: light.notes,
            ..Photo::of_image(format, Image { width, height, pixels })
        }
    }
}
