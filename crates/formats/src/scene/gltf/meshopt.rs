//! Views packed by meshoptimizer (`EXT_meshopt_compression`): vertices byte by byte as differences, triangles by the edges that they
//! share with those before, and the filters after that. Written by appendices A and B of the extension's text.

/// What is said of a packed view.
pub(super) struct Packed<'a> {
    pub count: usize,
    pub stride: usize,
    pub mode: &'a str,
    pub filter: &'a str,
}

/// What can be wrong with the bytes.
type Unpacked<T> = Result<T, &'static str>;

const CUT: &str = "the packed bytes end too soon";

impl Packed<'_> {
    /// The bytes that were packed.
    pub fn unpack(&self, from: &[u8]) -> Unpacked<Vec<u8>> {
        let Self { count, stride, mode, filter } = *self;
        match mode {
            "ATTRIBUTES" => {
                if stride == 0 || !stride.is_multiple_of(4) || stride > 256 {
                    return Err("`byteStride` must be a multiple of 4, and 256 at most");
                }
                let mut bytes = attributes(from, count, stride)?;
                match (filter, stride) {
                    ("NONE", _) => {}
                    ("OCTAHEDRAL", 4) => octahedral::<1>(&mut bytes),
                    ("OCTAHEDRAL", 8) => octahedral::<2>(&mut bytes),
                    ("QUATERNION", 8) => quaternions(&mut bytes),
                    ("EXPONENTIAL", _) => exponential(&mut bytes),
                    ("OCTAHEDRAL" | "QUATERNION", _) => return Err("`byteStride` doesn't suit the filter"),
                    _ => return Err("the filter is none that is known"),
                }
                Ok(bytes)
            }
            "TRIANGLES" | "INDICES" => {
                if stride != 2 && stride != 4 {
                    return Err("`byteStride` of indices must be 2 or 4");
                }
                let indices =
                    if mode == "TRIANGLES" { triangles(from, count)? } else { indices(from, count)? };
                let mut bytes = Vec::new();
                bytes
                    .try_reserve_exact(count.saturating_mul(stride))
                    .map_err(|_| "there is no memory for it")?;
                indices.iter().for_each(|i| bytes.extend(&i.to_le_bytes()[..stride]));
                Ok(bytes)
            }
            _ => Err("the mode is none that is known"),
        }
    }
}

/// Takes bytes off the front.
fn take<'a>(from: &mut &'a [u8], count: usize) -> Unpacked<&'a [u8]> {
    let (front, rest) = from.split_at_checked(count).ok_or(CUT)?;
    *from = rest;
    Ok(front)
}

fn zigzag(v: u8) -> u8 {
    if v & 1 != 0 { !(v >> 1) } else { v >> 1 }
}

/// Mode 0, of the stream's version 0.
fn attributes(from: &[u8], count: usize, stride: usize) -> Unpacked<Vec<u8>> {
    if from.first() != Some(&0xa0) {
        return Err("the packed attributes don't begin with 0xa0: another version of the encoding");
    }
    let tail = if stride < 32 { 32 } else { stride };
    let body = from.len().checked_sub(1 + tail).ok_or(CUT)?;
    let mut rest = &from[1..1 + body];
    let mut last = from[from.len() - stride..].to_vec();
    // A group of 16 has two bits at the least for each byte of a thing.
    let least = (count / 64).saturating_mul(stride);
    if least > from.len() {
        return Err(CUT);
    }
    let total = count.checked_mul(stride).ok_or("it is too large")?;
    let mut out = Vec::new();
    out.try_reserve_exact(total).map_err(|_| "there is no memory for it")?;
    out.resize(total, 0);
    let most = ((8192 / stride) & !15).min(256);
    let mut done = 0;
    while done < count {
        let block = most.min(count - done);
        let groups = block.div_ceil(16);
        for byte in 0..stride {
            let header = take(&mut rest, groups.div_ceil(4))?;
            for group in 0..groups {
                let deltas = group_of_16(&mut rest, header[group / 4] >> (2 * (group % 4)) & 3)?;
                for (i, delta) in deltas.into_iter().enumerate().take(block - group * 16) {
                    last[byte] = last[byte].wrapping_add(zigzag(delta));
                    out[(done + group * 16 + i) * stride + byte] = last[byte];
                }
            }
        }
        done += block;
    }
    Ok(out)
}

fn group_of_16(from: &mut &[u8], kind: u8) -> Unpacked<[u8; 16]> {
    let mut deltas = [0; 16];
    match kind {
        0 => {}
        3 => deltas.copy_from_slice(take(from, 16)?),
        _ => {
            // Two or four bits each, from the highest; all ones say that a byte follows.
            let bits = 2 * usize::from(kind);
            let each = 8 / bits;
            let full = (1_u8 << bits) - 1;
            let packed = take(from, 16 / each)?;
            for (i, delta) in deltas.iter_mut().enumerate() {
                let v = packed[i / each] >> (8 - bits * (i % each + 1)) & full;
                *delta = if v == full { take(from, 1)?[0] } else { v };
            }
        }
    }
    Ok(deltas)
}

/// A number of seven bits a byte.
fn varint(from: &mut &[u8]) -> Unpacked<u32> {
    let mut out = 0_u32;
    for i in 0..5 {
        let byte = take(from, 1)?[0];
        out |= u32::from(byte & 0x7f) << (7 * i);
        if byte < 0x80 {
            return Ok(out);
        }
    }
    Err("a packed number is too long")
}

fn zigzag_32(v: u32) -> u32 {
    if v & 1 != 0 { !(v >> 1) } else { v >> 1 }
}

/// The last sixteen of something; the youngest has index 0.
struct Recent<T> {
    list: [T; 16],
    next: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Self {
        Self { list: [T::default(); 16], next: 0 }
    }

    fn push(&mut self, v: T) {
        self.list[self.next] = v;
        self.next = (self.next + 1) % 16;
    }

    fn get(&self, age: usize) -> T {
        self.list[(self.next + 31 - age) % 16]
    }
}

/// Mode 1.
fn triangles(from: &[u8], count: usize) -> Unpacked<Vec<u32>> {
    if from.first() != Some(&0xe1) {
        return Err("the packed triangles don't begin with 0xe1: another version of the encoding");
    }
    if !count.is_multiple_of(3) {
        return Err("`count` of triangles must be a multiple of 3");
    }
    let body = from.len().checked_sub(17).ok_or(CUT)?;
    let table = &from[1 + body..];
    let (codes, mut data) = from[1..1 + body].split_at_checked(count / 3).ok_or(CUT)?;
    let mut out = Vec::new();
    out.try_reserve_exact(count).map_err(|_| "there is no memory for it")?;
    let (mut edges, mut vertices) = (Recent::<[u32; 2]>::new(), Recent::<u32>::new());
    let (mut next, mut last) = (0_u32, 0_u32);
    let fresh = |next: &mut u32| {
        let v = *next;
        *next = next.wrapping_add(1);
        v
    };
    let explicit = |data: &mut &[u8], last: &mut u32| -> Unpacked<u32> {
        *last = last.wrapping_add(zigzag_32(varint(data)?));
        Ok(*last)
    };
    for &code in codes {
        let (high, low) = (usize::from(code >> 4), usize::from(code & 15));
        if high < 15 {
            let [a, b] = edges.get(high);
            let c = match low {
                0 => fresh(&mut next),
                1..13 => vertices.get(low),
                13 | 14 => {
                    last = if low == 13 { last.wrapping_sub(1) } else { last.wrapping_add(1) };
                    last
                }
                _ => explicit(&mut data, &mut last)?,
            };
            edges.push([c, b]);
            edges.push([a, c]);
            if low == 0 || low >= 13 {
                vertices.push(c);
            }
            out.extend([a, b, c]);
            continue;
        }
        let (z, w) = if low < 14 {
            (usize::from(table[low] >> 4), usize::from(table[low] & 15))
        } else {
            let both = take(&mut data, 1)?[0];
            if both == 0 {
                next = 0;
            }
            (usize::from(both >> 4), usize::from(both & 15))
        };
        let a = if low < 15 { fresh(&mut next) } else { explicit(&mut data, &mut last)? };
        let mut other = |which: usize, next: &mut u32| match which {
            0 => Ok((fresh(next), true)),
            15 if low >= 14 => explicit(&mut data, &mut last).map(|v| (v, true)),
            age => Ok((vertices.get(age - 1), false)),
        };
        let (b, b_is_new) = other(z, &mut next)?;
        let (c, c_is_new) = other(w, &mut next)?;
        edges.push([b, a]);
        edges.push([c, b]);
        edges.push([a, c]);
        vertices.push(a);
        if b_is_new {
            vertices.push(b);
        }
        if c_is_new {
            vertices.push(c);
        }
        out.extend([a, b, c]);
    }
    Ok(out)
}

/// Mode 2.
fn indices(from: &[u8], count: usize) -> Unpacked<Vec<u32>> {
    if from.first() != Some(&0xd1) {
        return Err("the packed indices don't begin with 0xd1: another version of the encoding");
    }
    let body = from.len().checked_sub(5).ok_or(CUT)?;
    let mut rest = &from[1..1 + body];
    if count > rest.len() {
        return Err(CUT);
    }
    let mut last = [0_u32; 2];
    (0..count)
        .map(|_| {
            let v = varint(&mut rest)?;
            let base = &mut last[(v & 1) as usize];
            *base = base.wrapping_add(zigzag_32(v >> 1));
            Ok(*base)
        })
        .collect()
}

/// Filter 1: unit vectors as points of an octahedron, x and y of it and what is 1 there; the fourth number stays.
fn octahedral<const W: usize>(bytes: &mut [u8]) {
    let most = if W == 1 { 127.0 } else { 32_767.0 };
    let get =
        |b: &[u8]| if W == 1 { f32::from(b[0] as i8) } else { f32::from(i16::from_le_bytes([b[0], b[1]])) };
    for thing in bytes.chunks_exact_mut(4 * W) {
        let [mut x, mut y, one] = [0, 1, 2].map(|i| get(&thing[i * W..]));
        let z = one - x.abs() - y.abs();
        // What is below is folded over.
        let fold = if z < 0.0 { z } else { 0.0 };
        x += if x >= 0.0 { fold } else { -fold };
        y += if y >= 0.0 { fold } else { -fold };
        let length = (x * x + y * y + z * z).sqrt();
        let scale = if length > 0.0 { most / length } else { 0.0 };
        for (i, v) in [x, y, z].into_iter().enumerate() {
            put::<W>(&mut thing[i * W..], v * scale);
        }
    }
}

/// Filter 2: unit quaternions of which three numbers are told, and which is the largest.
fn quaternions(bytes: &mut [u8]) {
    for thing in bytes.chunks_exact_mut(8) {
        let get = |i: usize| i16::from_le_bytes([thing[2 * i], thing[2 * i + 1]]);
        let last = get(3);
        // The two lowest bits tell the largest; with them, the number that stands for 1.
        let one = f32::from(last | 3);
        let told = [0, 1, 2].map(|i| f32::from(get(i)) / one);
        let [x, y, z] = told.map(|v| v / std::f32::consts::SQRT_2);
        let rest = 1.0 - x * x - y * y - z * z;
        let w = if rest > 0.0 { rest.sqrt() } else { 0.0 };
        let largest = (last & 3) as usize;
        for (i, v) in [x, y, z, w].into_iter().enumerate() {
            let to = (largest + 1 + i) % 4;
            put::<2>(&mut thing[2 * to..], v * 32_767.0);
        }
    }
}

/// Filter 3: 24 bits times 2 to the power of 8 bits.
fn exponential(bytes: &mut [u8]) {
    for thing in bytes.chunks_exact_mut(4) {
        let code = i32::from_le_bytes([thing[0], thing[1], thing[2], thing[3]]);
        let (exponent, mantissa) = (code >> 24, (code << 8) >> 8);
        // The exponent is from -100 to 100.
        let power = f32::from_bits(((127 + exponent.clamp(-126, 127)) as u32) << 23);
        let v = mantissa as f32 * power;
        thing.copy_from_slice(&v.to_le_bytes());
    }
}

/// Puts the nearest whole number.
fn put<const W: usize>(to: &mut [u8], v: f32) {
    let rounded = (v + if v >= 0.0 { 0.5 } else { -0.5 }) as i32;
    to[..W].copy_from_slice(&rounded.to_le_bytes()[..W]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unpack(mode: &str, filter: &str, [count, stride]: [usize; 2], from: &[u8]) -> Unpacked<Vec<u8>> {
        Packed { count, stride, mode, filter }.unpack(from)
    }

    /// The example of the extension's text.
    #[test]
    fn deltas_of_four_bits_are_read() {
        let mut from: &[u8] = &[0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5];
        let deltas = group_of_16(&mut from, 2).unwrap().map(|d| zigzag(d) as i8);
        assert_eq!(deltas, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
        assert!(from.is_empty());
        let mut from: &[u8] = &[0b0110_1100, 0, 0, 0, 200];
        assert_eq!(group_of_16(&mut from, 1).unwrap()[..4], [1, 2, 200, 0]);
    }

    #[test]
    fn attributes_are_sums_of_deltas() {
        // Of four bytes the first rises by 1 (zigzag 2), the others stay.
        let mut from = vec![0xa0, 0b11];
        from.extend([2; 16]);
        from.extend([0, 0, 0]);
        from.extend([0; 28]);
        from.extend([10, 20, 30, 40]);
        let got = unpack("ATTRIBUTES", "NONE", [2, 4], &from).unwrap();
        assert_eq!(got, [11, 20, 30, 40, 12, 20, 30, 40]);
        for cut in 0..from.len() {
            assert!(unpack("ATTRIBUTES", "NONE", [2, 4], &from[..cut]).is_err(), "{cut}");
        }
        assert!(unpack("ATTRIBUTES", "NONE", [usize::MAX / 256, 256], &from).is_err());
    }

    #[test]
    fn triangles_share_edges_with_those_before() {
        let mut from = vec![0xe1, 0xf0, 0x00, 0x0f, 0x0a];
        from.extend([0; 16]);
        // The last has its third corner told: 5 (zigzag 10).
        let got = unpack("TRIANGLES", "NONE", [9, 2], &from).unwrap();
        let got: Vec<u16> = got.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        assert_eq!(got, [0, 1, 2, 0, 2, 3, 0, 3, 5]);
        assert!(unpack("TRIANGLES", "NONE", [3_000_000, 4], &from).is_err());
    }

    #[test]
    fn indices_are_deltas_to_one_of_two() {
        let from = [0xd1, 20, 2, 0, 0, 0, 0];
        assert_eq!(unpack("INDICES", "NONE", [2, 4], &from).unwrap(), [5, 0, 0, 0, 4, 0, 0, 0]);
        assert!(unpack("INDICES", "NONE", [1 << 40, 4], &from).is_err());
    }

    #[test]
    fn filters_make_vectors_turns_and_numbers() {
        let mut bytes = [0, 0, 127, 9, 127, 0, 127, 9];
        octahedral::<1>(&mut bytes);
        assert_eq!(bytes, [0, 0, 127, 9, 127, 0, 0, 9]);
        let mut bytes = [0, 0, 0, 0, 0, 0, 0xfd, 0x7f];
        quaternions(&mut bytes);
        assert_eq!(bytes, [0, 0, 0xff, 0x7f, 0, 0, 0, 0]);
        let mut bytes = [3, 0, 0, 0xff];
        exponential(&mut bytes);
        assert_eq!(f32::from_le_bytes(bytes), 1.5);
    }
}
