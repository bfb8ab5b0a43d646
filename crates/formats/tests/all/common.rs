//! What the tests of this crate share.

use std::path::PathBuf;

/// The folder of shared assets (`STRAAL_SHARED`, else beside the project), or a note that a test is skipped.
pub fn shared() -> Option<PathBuf> {
    let folder = std::env::var_os("STRAAL_SHARED")
        .map(PathBuf::from)
        .unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"));
    if !folder.is_dir() {
        #[allow(clippy::print_stdout)] // a note to whoever runs the tests
        {
            println!("skipped: no shared data");
        }
        return None;
    }
    Some(folder)
}

/// A PNG with other chunks between its header and all else; those of these names that it had are left out.
pub fn with_chunks(png: &[u8], chunks: &[([u8; 4], Vec<u8>)]) -> Vec<u8> {
    let (signature, mut rest) = png.split_at(8);
    let mut out = signature.to_vec();
    while let Some((start, after)) = rest.split_first_chunk::<8>() {
        let length = u32::from_be_bytes([start[0], start[1], start[2], start[3]]) as usize + 4;
        if !chunks.iter().any(|(name, _)| *name == start[4..]) {
            out.extend(start);
            out.extend(&after[..length]);
        }
        if start[4..] == *b"IHDR" {
            for (name, data) in chunks.iter().filter(|(_, data)| !data.is_empty()) {
                let body = [name.as_slice(), data].concat();
                out.extend((data.len() as u32).to_be_bytes());
                out.extend(&body);
                out.extend(crc(&body).to_be_bytes());
            }
        }
        rest = &after[length..];
    }
    out
}

/// A PNG without the chunks of these names.
pub fn without_chunks(png: &[u8], names: &[[u8; 4]]) -> Vec<u8> {
    with_chunks(png, &names.iter().map(|name| (*name, Vec::new())).collect::<Vec<_>>())
}

/// The checksum of a chunk (ISO 3309), bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}
