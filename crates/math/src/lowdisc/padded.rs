//! Patterns of two dimensions, of which as many are put side by side as are wanted.

use super::mix;

/// A pattern of one and of two dimensions. Numbers are fractions of 32 bits. The order of the points must depend on
/// the stream, so that what is padded knows nothing of one another.
pub(super) trait Padded {
    /// One number of the point `index`.
    fn one(&self, stream: u64, index: u32) -> u32;

    /// Two numbers of the point `index`.
    fn two(&self, stream: u64, index: u32) -> [u32; 2];
}

/// As many dimensions as are wanted, two by two, each pair from a stream of its own.
pub(super) fn padded<const D: usize>(pattern: &impl Padded, stream: u64, index: u32) -> [u32; D] {
    let mut out = [0; D];
    let mut stream = stream;
    for part in out.chunks_mut(2) {
        match part {
            [a] => *a = pattern.one(stream, index),
            part => part.copy_from_slice(&pattern.two(stream, index)),
        }
        stream = mix(stream.wrapping_add(0x9e37_79b9_7f4a_7c15));
    }
    out
}
