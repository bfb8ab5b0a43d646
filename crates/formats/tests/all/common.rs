//! What the tests of this crate share.

#[path = "../../../../tests/shared.rs"]
mod shared_data;

pub use shared_data::shared;

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
