//! What a picture's first bytes promise, without decoding it.

use straal_scene::bitmap::TexelFormat;

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

impl Header {
    /// The bytes of the picture once it is read.
    pub fn kept_bytes(&self) -> u64 {
        (self.width as u64).saturating_mul(self.height as u64).saturating_mul(PIXEL)
    }
}
