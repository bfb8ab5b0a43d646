//! Readers and writers of pictures.

pub mod apng;
mod bitmap;
pub mod bmp;
mod coded;
pub mod exr;
mod first_bytes;
pub mod hdr;
mod header;
mod icc;
pub mod jpeg;
pub mod ktx2;
mod light;
pub mod pfm;
mod photo;
pub mod png;
pub mod tga;
pub mod webp;

pub use bitmap::bitmap;
pub use first_bytes::header;
pub use header::{Format, Header};
pub use photo::{Fault, Faults, Photo, framed, surroundings};

use std::fs::File;
use std::path::Path;

use straal_scene::Image;

use crate::files::{self, Refusal};
use crate::{Limits, ReadError};

/// Reads a picture as linear RGB with the primaries of sRGB: the whole of it, black where it has no pixels. The format is told
/// by the file's first bytes, whatever its name. Grey becomes three equal numbers, and transparency is left out.
///
/// What was guessed or couldn't be honoured is in the notes of a [`Photo`]; this is its picture alone.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    Ok(Photo::read(bytes, limits)?.to_srgb())
}

/// A file that begins as a picture does, to be read bit by bit.
pub fn open(path: &Path, limits: &Limits) -> Result<(File, Format), Refusal> {
    let mut format = Err(Refusal::new("it is no picture"));
    let opened = files::open_if(path, limits.max_bytes, |head| {
        format = Format::of(head).map_err(|e| Refusal::new(e.to_string()));
        Ok(())
    })?;
    Ok((opened.into_whole()?, format?))
}

/// The bytes of a file that begins as a picture does; of any other no more than its beginning is read.
pub fn bytes(path: &Path, limits: &Limits) -> Result<Vec<u8>, Refusal> {
    files::read_if(path, limits.max_bytes, |head| {
        Format::of(head).map(|_| ()).map_err(|e| Refusal::new(e.to_string()))
    })
}
