//! Pictures as textures take them: the numbers that are in the file.

use straal_scene::bitmap::{Bitmap, TexelFormat, Texels};

use super::coded::no_memory;
use super::{Format, Header, Photo, bmp, header, jpeg, ktx2, png, tga, webp};
use crate::{Limits, ReadError};

/// Reads a picture for textures, and tells what a person should know of how it was read, each a sentence without a full stop.
/// Codes of 8 and 16 bits stay what they are, with how they become light by what the file says; so do numbers in half precision.
/// Alpha is kept where there are codes.
pub fn bitmap(bytes: &[u8], limits: &Limits) -> Result<(Bitmap, Vec<String>), ReadError> {
    limits.check_bytes(bytes)?;
    limits.check_decoded(header(bytes, limits)?.decoded_bytes)?;
    match Format::of(bytes)? {
        Format::Png => png::read_bitmap(bytes, limits),
        Format::Jpeg => jpeg::read_codes(bytes, limits)?.into_bitmap(),
        Format::Webp => webp::read_codes(bytes, limits)?.into_bitmap(),
        Format::Tga => tga::read_codes(bytes, limits)?.into_bitmap(),
        Format::Bmp => bmp::read_codes(bytes, limits)?.into_bitmap(),
        Format::Ktx2 => ktx2::read_bitmap(bytes, limits),
        Format::Exr | Format::Hdr | Format::Pfm => {
            let (mut photo, space) = {
                let mut photo = Photo::read(bytes, limits)?;
                photo.tame();
                let space = photo.space.take();
                (photo, space)
            };
            let notes = std::mem::take(&mut photo.notes);
            let size = photo.size;
            let whole = photo.whole();
            let bitmap = Bitmap::of_light(size, &whole.pixels, space).ok_or_else(no_memory)?;
            Ok((bitmap, notes))
        }
    }
}

impl Header {
    /// The most bytes that a [`Bitmap`] of it takes.
    pub fn bitmap_bytes(&self) -> u64 {
        Texels::bytes_of(self.width as u64, self.height as u64, self.texel)
    }

    /// The largest texel that a picture of so many channels may need.
    pub(super) const fn texel(number: straal_scene::bitmap::Number, channels: usize) -> TexelFormat {
        TexelFormat { number, channels: if channels > 2 { 4 } else { channels } }
    }
}
