//! What a picture's first bytes promise, without decoding it.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use straal_scene::bitmap::TexelFormat;

use super::{bmp, exr, hdr, jpeg, ktx2, pfm, png, tga, webp};
use crate::{Limits, ReadError};

/// A format of pictures that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR.
    Exr,
    /// PNG.
    Png,
    /// Radiance HDR.
    Hdr,
    /// Portable float map.
    Pfm,
    /// JPEG.
    Jpeg,
    /// WebP.
    Webp,
    /// Truevision TGA.
    Tga,
    /// BMP.
    Bmp,
    /// Khronos's textures, KTX2.
    Ktx2,
}

/// A picture's size and what it costs to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// By the first bytes.
    pub format: Format,
    /// Width of the whole picture in pixels: in an EXR that of the display window.
    pub width: usize,
    /// Height of the whole picture in pixels.
    pub height: usize,
    /// Numbers of a pixel in the file, of all layers.
    pub channels: usize,
    /// The most bytes that [`super::read`] takes at a time, besides those of the file.
    pub decoded_bytes: u64,
    /// The largest texel that [`super::bitmap()`] makes of a pixel.
    pub texel: TexelFormat,
}

/// Bytes of a pixel of three floats.
pub(super) const PIXEL: u64 = 12;

impl Format {
    /// By the first bytes, whatever the name.
    pub fn of(bytes: &[u8]) -> Result<Self, ReadError> {
        match bytes {
            [0x76, 0x2f, 0x31, 0x01, ..] => Ok(Self::Exr),
            [0x89, b'P', b'N', b'G', ..] => Ok(Self::Png),
            [b'#', b'?', ..] => Ok(Self::Hdr),
            [b'P', b'F' | b'f', ..] => Ok(Self::Pfm),
            [0xff, 0xd8, 0xff, ..] => Ok(Self::Jpeg),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Ok(Self::Webp),
            [b'B', b'M', ..] => Ok(Self::Bmp),
            _ if bytes.starts_with(&ktx2::MAGIC) => Ok(Self::Ktx2),
            [] => Err(ReadError::file("the file is empty")),
            // It has no mark.
            _ if tga::is_one(bytes) => Ok(Self::Tga),
            _ => Err(ReadError::file(
                "not a picture that straal knows: BMP, EXR, HDR, JPEG, KTX2, PFM, PNG, TGA and WebP are",
            )),
        }
    }
}

/// What a picture promises. The bytes may be the beginning of a file only, as long as its header is whole. Nothing is
/// allocated for the pixels; what is beyond the limits is refused.
pub fn header(bytes: &[u8], limits: &Limits) -> Result<Header, ReadError> {
    let header = match Format::of(bytes)? {
        Format::Exr => exr::header(bytes, limits),
        Format::Png => png::header(bytes, limits),
        Format::Hdr => hdr::header(bytes, limits),
        Format::Pfm => pfm::header(bytes, limits),
        Format::Jpeg => jpeg::header(bytes, limits),
        Format::Webp => webp::header(bytes, limits),
        Format::Tga => tga::header(bytes, limits),
        Format::Bmp => bmp::header(bytes, limits),
        Format::Ktx2 => ktx2::header(bytes, limits),
    }?;
    limits.check_decoded(header.decoded_bytes)?;
    Ok(header)
}

impl Header {
    /// Reads as much of a file as it takes to know.
    pub fn open(path: &Path, limits: &Limits) -> Result<Self, ReadError> {
        /// Enough for nearly every file, and for those with a small picture in their header.
        const STEPS: [u64; 2] = [1 << 16, 1 << 24];
        let told = |e: std::io::Error| ReadError::file(e.to_string());
        // A pipe, or a file of the kernel, would keep its readers waiting.
        crate::files::size(path, limits.max_bytes).map_err(|refusal| ReadError::file(refusal.problem))?;
        let mut file = File::open(path).map_err(told)?;
        let mut bytes = Vec::new();
        for (i, most) in STEPS.into_iter().enumerate() {
            let wanted = most - bytes.len() as u64;
            let got = file.by_ref().take(wanted).read_to_end(&mut bytes).map_err(told)? as u64;
            match header(&bytes, limits) {
                Err(_) if got == wanted && i + 1 < STEPS.len() => {}
                result => return result,
            }
        }
        Err(ReadError::file("the header is too long"))
    }

    /// The bytes of the picture once it is read.
    pub fn kept_bytes(&self) -> u64 {
        (self.width as u64).saturating_mul(self.height as u64).saturating_mul(PIXEL)
    }
}
