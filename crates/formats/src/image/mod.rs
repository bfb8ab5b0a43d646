//! Readers and writers of pictures.

pub mod exr;
pub mod hdr;
pub mod pfm;
pub mod png;

use straal_scene::Image;

use crate::{Limits, ReadError};

/// Reads a picture as linear RGB. The format is told by the file's first bytes, whatever its name.
///
/// EXR, HDR and PFM hold linear light; PNG is decoded from sRGB. Grey becomes three equal numbers, transparency is
/// left out, and of an EXR with several layers the one without a name is taken, else the first with a picture.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    match bytes {
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::read(bytes, limits)?.to_image(),
        [0x89, b'P', b'N', b'G', ..] => png::read(bytes, limits),
        [b'#', b'?', ..] => hdr::read(bytes, limits),
        [b'P', b'F' | b'f', ..] => pfm::read(bytes, limits),
        [] => Err(ReadError::file("the file is empty")),
        [0xff, 0xd8, 0xff, ..] => {
            Err(ReadError::file("JPEG pictures are not supported; EXR, HDR, PFM and PNG are"))
        }
        _ => Err(ReadError::file("not a picture that straal knows: EXR, HDR, PFM and PNG are")),
    }
}
