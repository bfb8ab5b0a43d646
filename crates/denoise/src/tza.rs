//! Weights as Intel publishes them: the tensor archives (TZA, version 2) of Open Image Denoise.
//!
//! Numbers are little-endian. A header (magic 0x41D7, two bytes of version, a `u64`: where the table lies), then numbers, then the table: a
//! `u32`, how many tensors there are, and of each its name (`u16` for the length), its number of dimensions (a byte), as many `u32`, as many letters of layout, a letter for the
//! type (`h`: half, `f`: single precision), and a `u64`: where its numbers lie.

use crate::WeightsError;

/// The first two bytes of an archive.
const MAGIC: u16 = 0x41D7;

/// No network has more numbers in one tensor: it bounds what a file can make us allocate.
const MOST_NUMBERS: usize = 1 << 26;

/// A tensor of the archive, in single precision.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tensor {
    pub name: String,
    /// Output channels, input channels, rows and columns; of a bias the channels alone.
    pub shape: Vec<usize>,
    pub numbers: Vec<f32>,
}

/// Reads bytes one after the other.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], WeightsError> {
        let end = self.at.checked_add(n).filter(|end| *end <= self.bytes.len()).ok_or(WeightsError::Short)?;
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn number(&mut self, bytes: usize) -> Result<u64, WeightsError> {
        Ok(self.take(bytes)?.iter().rev().fold(0, |sum, b| sum << 8 | u64::from(*b)))
    }

    fn size(&mut self, bytes: usize) -> Result<usize, WeightsError> {
        usize::try_from(self.number(bytes)?).map_err(|_| WeightsError::Short)
    }
}

/// Reads an archive.
pub(crate) fn read(bytes: &[u8]) -> Result<Vec<Tensor>, WeightsError> {
    let mut header = Cursor { bytes, at: 0 };
    if header.number(2).map_err(|_| WeightsError::NoArchive)? != u64::from(MAGIC) {
        return Err(WeightsError::NoArchive);
    }
    let version = header.number(2)? & 0xff;
    if version != 2 {
        return Err(WeightsError::Version(version as u8));
    }
    let at = header.size(8)?;
    let mut table = Cursor { bytes, at };
    let count = table.size(4)?;
    // Grows with what is read: a count alone reserves nothing.
    let mut tensors = Vec::new();
    for _ in 0..count {
        tensors.push(tensor(bytes, &mut table)?);
    }
    Ok(tensors)
}

fn tensor(bytes: &[u8], table: &mut Cursor<'_>) -> Result<Tensor, WeightsError> {
    let length = table.size(2)?;
    let name = String::from_utf8_lossy(table.take(length)?).into_owned();
    let dimensions = table.size(1)?;
    let shape = (0..dimensions).map(|_| table.size(4)).collect::<Result<Vec<_>, _>>()?;
    let layout = table.take(dimensions)?;
    if layout != b"x" && layout != b"oihw" {
        return Err(WeightsError::Tensor(name));
    }
    let is_half = match table.take(1)? {
        b"h" => true,
        b"f" => false,
        _ => return Err(WeightsError::Tensor(name)),
    };
    let count = shape.iter().try_fold(1_usize, |n, d| n.checked_mul(*d)).filter(|n| *n <= MOST_NUMBERS);
    let count = count.ok_or_else(|| WeightsError::Tensor(name.clone()))?;
    let mut data = Cursor { bytes, at: table.size(8)? };
    let data = data.take(count * if is_half { 2 } else { 4 })?;
    let numbers = if is_half {
        data.as_chunks().0.iter().map(|b| half(u16::from_le_bytes(*b))).collect()
    } else {
        data.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect()
    };
    Ok(Tensor { name, shape, numbers })
}

/// A half float in single precision, which is exact.
fn half(bits: u16) -> f32 {
    let sign = u32::from(bits & 0x8000) << 16;
    let (exponent, fraction) = (u32::from(bits >> 10 & 31), u32::from(bits & 0x3ff));
    let magnitude = match exponent {
        // Units of 2^-24.
        0 => (fraction as f32 * f32::from_bits((127 - 24) << 23)).to_bits(),
        31 => 0x7f80_0000 | fraction << 13,
        _ => (exponent + 127 - 15) << 23 | fraction << 13,
    };
    f32::from_bits(sign | magnitude)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_exact() {
        let known = [
            (0x0000, 0.0),
            (0x8001, -1.0 / 16_777_216.0),
            (0x03ff, 1023.0 / 16_777_216.0),
            (0x0400, 1.0 / 16_384.0),
            (0x3c00, 1.0),
            (0xc248, -3.140_625),
            (0x7bff, 65504.0),
            (0x7c00, f32::INFINITY),
        ];
        for (bits, value) in known {
            assert_eq!(half(bits), value, "{bits:#x}");
        }
        assert!(half(0x7e00).is_nan());
    }

    /// One bias of two halves.
    fn small() -> Vec<u8> {
        let mut bytes = vec![0xd7, 0x41, 2, 0];
        bytes.extend(16_u64.to_le_bytes());
        bytes.extend([0x00, 0x3c, 0x00, 0x40]);
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(1_u16.to_le_bytes());
        bytes.extend(b"b\x01");
        bytes.extend(2_u32.to_le_bytes());
        bytes.extend(b"xh");
        bytes.extend(12_u64.to_le_bytes());
        bytes
    }

    #[test]
    fn an_archive_is_read_and_every_shorter_one_refused() {
        let bytes = small();
        let expected = Tensor { name: "b".into(), shape: vec![2], numbers: vec![1.0, 2.0] };
        assert_eq!(read(&bytes).unwrap(), [expected]);
        for length in 0..bytes.len() {
            assert!(read(&bytes[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn sizes_that_lie_take_no_memory() {
        let mut bytes = small();
        let dimension = bytes.len() - 14;
        bytes[dimension..dimension + 4].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(matches!(read(&bytes), Err(WeightsError::Tensor(name)) if name == "b"));
    }
}
