//! The film hash.

/// A picture's fingerprint: BLAKE3 (the first 16 bytes, in hexadecimal) of its pixels, R, G, B as little-endian
/// single floats, row by row from the top.
pub fn hash_of(rgb: &[[f32; 3]]) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut bytes = Vec::with_capacity(1 << 16);
    for chunk in rgb.chunks(4096) {
        bytes.clear();
        bytes.extend(chunk.iter().flatten().flat_map(|v| v.to_le_bytes()));
        hasher.update(&bytes);
    }
    hasher.finalize().to_hex()[..32].to_string()
}
