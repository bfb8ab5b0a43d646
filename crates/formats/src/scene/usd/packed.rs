//! How layers in binary (.usdc) pack their bytes and numbers: LZ4 blocks, and whole numbers as differences.

/// One byte of LZ4 stands for so many at most.
const RATIO: usize = 255;

/// Unpacks what LZ4 packed in one piece or several: a byte says in how many, 0 for one without its size.
pub(super) fn unpack(bytes: &[u8], most: usize) -> Option<Vec<u8>> {
    let (count, mut rest) = bytes.split_first()?;
    let mut out = Vec::new();
    if *count == 0 {
        block(rest, most, &mut out)?;
        return Some(out);
    }
    for _ in 0..*count {
        let (size, behind) = rest.split_first_chunk::<4>()?;
        let size = usize::try_from(i32::from_le_bytes(*size)).ok()?;
        block(behind.get(..size)?, most, &mut out)?;
        rest = &behind[size..];
    }
    Some(out)
}

/// A block of LZ4: literals, and copies of what came before.
fn block(bytes: &[u8], most: usize, out: &mut Vec<u8>) -> Option<()> {
    let start = out.len();
    // No more is taken than the packed bytes can stand for.
    let most = most.min(out.len().saturating_add(bytes.len().saturating_mul(RATIO)));
    let mut at = 0;
    let next = |at: &mut usize| {
        let byte = bytes.get(*at).copied();
        *at += 1;
        byte
    };
    let length = |at: &mut usize, nibble: u8| -> Option<usize> {
        let mut length = usize::from(nibble);
        if nibble == 15 {
            loop {
                let more = next(at)?;
                length += usize::from(more);
                if more != 255 {
                    break;
                }
            }
        }
        Some(length)
    };
    while at < bytes.len() {
        let token = next(&mut at)?;
        let literals = length(&mut at, token >> 4)?;
        let end = at.checked_add(literals)?;
        let copied = bytes.get(at..end)?;
        if out.len() + literals > most {
            return None;
        }
        out.extend_from_slice(copied);
        at = end;
        if at == bytes.len() {
            return Some(());
        }
        let back = usize::from(u16::from_le_bytes([next(&mut at)?, next(&mut at)?]));
        let count = 4 + length(&mut at, token & 15)?;
        if back == 0 || back > out.len() - start || out.len() + count > most {
            return None;
        }
        let from = out.len() - back;
        for i in 0..count {
            out.push(out[from + i]);
        }
    }
    Some(())
}

/// So many whole numbers of 4 or 8 bytes, told by the difference from the one before: the most frequent one, then for each two bits that
/// say whether it is that or how many bytes it has, then those bytes.
pub(super) fn integers(bytes: &[u8], count: usize, wide: bool) -> Option<Vec<i64>> {
    let base: usize = if wide { 8 } else { 4 };
    let codes = bytes.get(base..base.checked_add(count.div_ceil(4))?)?;
    let mut rest = &bytes[base + codes.len()..];
    let little = |bytes: &[u8]| {
        let mut all = [if bytes.last().is_some_and(|b| *b >= 128) { 255 } else { 0 }; 8];
        all[..bytes.len()].copy_from_slice(bytes);
        i64::from_le_bytes(all)
    };
    let common = little(&bytes[..base]);
    let mut last = 0_i64;
    let mut out = Vec::with_capacity(count);
    for i in 0..count {
        let difference = match codes[i / 4] >> (2 * (i % 4)) & 3 {
            0 => common,
            code => {
                let length = (1 << (code - 1)) * if wide { 2 } else { 1 };
                let (value, behind) = rest.split_at_checked(length)?;
                rest = behind;
                little(value)
            }
        };
        last = last.wrapping_add(difference);
        last = if wide { last } else { i64::from(last as i32) };
        out.push(last);
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_unpacked() {
        // "ab", then eight bytes from two back, then "c" alone.
        let packed = [0, 0x24, b'a', b'b', 2, 0, 0x10, b'c'];
        assert_eq!(
            unpack(&packed, 100).unwrap(),
            b"ababababab".iter().chain(b"c").copied().collect::<Vec<u8>>()
        );
        assert_eq!(unpack(&packed, 5), None, "no more than that is made");
        for end in 0..packed.len() {
            let _ = unpack(&packed[..end], 100);
        }
        assert_eq!(unpack(&[0, 0x04, 9, 0], 100), None, "nothing lies so far back");
    }

    #[test]
    fn numbers_are_told_by_their_differences() {
        // 1, 2, 3, 300, 299: +1 is the most frequent, 297 has two bytes, -1 has one.
        let packed = [1, 0, 0, 0, 0b1000_0000, 0b01, 41, 1, 255];
        assert_eq!(integers(&packed, 5, false).unwrap(), [1, 2, 3, 300, 299]);
        assert_eq!(integers(&packed[..8], 5, false), None);
        assert_eq!(integers(&packed, usize::MAX, false), None);
    }
}
