//! What a picture is by its first bytes, without decoding it.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::{Format, Header, bmp, exr, hdr, jpeg, ktx2, pfm, png, tga, webp};
use crate::{Limits, ReadError};

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
}
