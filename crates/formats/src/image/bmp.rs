//! BMP of Windows and OS/2: palettes, 16, 24 and 32 bits, runs, and bits by masks (Microsoft, *Bitmap Storage*).

use straal_scene::Image;

use super::coded::{Coded, Codes, zeros};
use super::light::Light;
use super::{Format, Header};
use crate::{Limits, ReadError};

/// What the headers say.
#[derive(Clone, Debug)]
struct Bmp {
    width: usize,
    height: usize,
    from_top: bool,
    bits: usize,
    compression: Compression,
    /// Masks of red, green, blue and alpha, where a pixel has 16 or 32 bits.
    masks: [u32; 4],
    /// Where the palette begins, how many colours it has, and bytes of each.
    palette: [usize; 3],
    /// Where the pixels begin.
    start: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Compression {
    None,
    /// Runs of pixels of so many bits.
    Runs,
}

impl Bmp {
    fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let short = |at: usize| {
            let found = bytes.get(at..).and_then(|b| b.first_chunk::<2>());
            found.map(|b| u16::from_le_bytes(*b)).ok_or_else(|| damaged("its header is missing"))
        };
        let long = |at: usize| {
            let found = bytes.get(at..).and_then(|b| b.first_chunk::<4>());
            found.map(|b| u32::from_le_bytes(*b)).ok_or_else(|| damaged("its header is missing"))
        };
        let start = long(10)? as usize;
        let head = long(14)? as usize;
        if head == 12 {
            let bits = usize::from(short(24)?);
            return Self {
                width: short(18)?.into(),
                height: short(20)?.into(),
                from_top: false,
                bits,
                compression: Compression::None,
                masks: [0; 4],
                palette: [26, if bits <= 8 { 1 << bits } else { 0 }, 3],
                start,
            }
            .checked();
        }
        if !matches!(head, 16 | 40 | 52 | 56 | 64 | 108 | 124) {
            return Err(damaged("its header is of a kind that straal doesn't know"));
        }
        let bits = usize::from(short(28)?);
        let method = if head >= 40 { long(30)? } else { 0 };
        let (width, height) = (long(18)? as i32, long(22)? as i32);
        let compression = match (method, bits) {
            (0, _) | (3 | 6, 16 | 32) => Compression::None,
            (1, 8) | (2, 4) => Compression::Runs,
            (4 | 5, _) => return Err(ReadError::file("a JPEG or PNG within a BMP is not supported")),
            _ => return Err(damaged("its compression makes no sense")),
        };
        let has_masks = matches!(method, 3 | 6);
        let masks = if has_masks {
            let alpha = head >= 56 || method == 6;
            [long(54)?, long(58)?, long(62)?, if alpha { long(66)? } else { 0 }]
        } else if bits == 16 {
            [0x7c00, 0x03e0, 0x001f, 0]
        } else {
            [0x00ff_0000, 0xff00, 0xff, 0]
        };
        // Masks stand behind a header that has no room for them.
        let behind = if head == 40 && has_masks { if method == 6 { 16 } else { 12 } } else { 0 };
        let told = if head >= 40 { long(46)? as usize } else { 0 };
        let most = if bits <= 8 { 1 << bits } else { 0 };
        let colours = if told == 0 || told > most { most } else { told };
        Self {
            width: usize::try_from(width).map_err(|_| damaged("its width is below 0"))?,
            height: height.unsigned_abs() as usize,
            from_top: height < 0,
            bits,
            compression,
            masks,
            palette: [14 + head + behind, colours, 4],
            start,
        }
        .checked()
    }

    fn checked(self) -> Result<Self, ReadError> {
        if !matches!(self.bits, 1 | 2 | 4 | 8 | 16 | 24 | 32) {
            return Err(damaged(&format!("pixels of {} bits make no sense", self.bits)));
        }
        Ok(self)
    }

    fn channels(&self) -> usize {
        if self.masks[3] != 0 && self.bits > 8 && self.bits != 24 { 4 } else { 3 }
    }

    /// Bytes of a row, which ends at a multiple of four.
    fn row(&self) -> usize {
        self.width.saturating_mul(self.bits).div_ceil(32).saturating_mul(4)
    }
}

/// Reads a BMP as linear light with the primaries of sRGB.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    Ok(read_codes(bytes, limits)?.into_photo().to_srgb())
}

/// Its codes.
pub(super) fn read_codes(bytes: &[u8], limits: &Limits) -> Result<Coded, ReadError> {
    limits.check_bytes(bytes)?;
    let bmp = Bmp::parse(bytes)?;
    let (width, height) = (bmp.width, bmp.height);
    let count = limits.check_size(width as u64, height as u64)?;
    let data = bytes.get(bmp.start..).ok_or_else(missing)?;
    let is_there = match bmp.compression {
        Compression::None => bmp.row().saturating_mul(height) <= data.len(),
        // A run of 255 pixels takes two bytes; few files skip more than they have.
        Compression::Runs => count / 1024 <= data.len(),
    };
    if !is_there {
        return Err(missing());
    }
    let palette = palette(&bmp, bytes);
    let channels = bmp.channels();
    let mut codes = zeros(count * channels)?;
    let mut put = |x: usize, row: usize, colour: [u8; 4]| {
        let y = if bmp.from_top { row } else { height - 1 - row };
        codes[(y * width + x) * channels..][..channels].copy_from_slice(&colour[..channels]);
    };
    if bmp.compression == Compression::Runs {
        runs(&bmp, data, |x, row, number| put(x, row, palette[usize::from(number)]))?;
    } else {
        for (row, line) in data.chunks_exact(bmp.row()).take(height).enumerate() {
            for x in 0..width {
                put(x, row, pixel(&bmp, line, x, &palette));
            }
        }
    }
    let light = Light::of_profile(None);
    Ok(Coded { format: Format::Bmp, width, height, channels, bytes: codes, light })
}

/// 256 colours; black where the file has none.
fn palette(bmp: &Bmp, bytes: &[u8]) -> Vec<[u8; 4]> {
    let [start, colours, entry] = bmp.palette;
    let mut all = vec![[0, 0, 0, 255]; 256];
    let known = bytes.get(start..).unwrap_or_default().chunks_exact(entry).take(colours);
    for (to, from) in all.iter_mut().zip(known) {
        *to = [from[2], from[1], from[0], 255];
    }
    all
}

fn pixel(bmp: &Bmp, line: &[u8], x: usize, palette: &[[u8; 4]]) -> [u8; 4] {
    match bmp.bits {
        24 => [line[3 * x + 2], line[3 * x + 1], line[3 * x], 255],
        16 => masked(u16::from_le_bytes([line[2 * x], line[2 * x + 1]]).into(), &bmp.masks),
        32 => {
            let bytes = [line[4 * x], line[4 * x + 1], line[4 * x + 2], line[4 * x + 3]];
            masked(u32::from_le_bytes(bytes), &bmp.masks)
        }
        bits => {
            let first = x * bits;
            let number = line[first / 8] >> (8 - bits - first % 8);
            palette[usize::from(number & (0xff >> (8 - bits)))]
        }
    }
}

/// Four numbers of a pixel by their masks, each as 8 bits; alpha is full where it has none.
fn masked(v: u32, masks: &[u32; 4]) -> [u8; 4] {
    let part = |mask: u32, absent: u8| {
        if mask == 0 {
            return absent;
        }
        let shift = mask.trailing_zeros();
        let most = u64::from(mask >> shift);
        ((u64::from((v & mask) >> shift) * 255 + most / 2) / most) as u8
    };
    [part(masks[0], 0), part(masks[1], 0), part(masks[2], 0), part(masks[3], 255)]
}

/// Goes through runs of 4 or 8 bits; `put` is given a column, a row of the file, and a number of the palette.
fn runs(bmp: &Bmp, data: &[u8], mut put: impl FnMut(usize, usize, u8)) -> Result<(), ReadError> {
    let (mut x, mut row, mut at) = (0_usize, 0_usize, 0_usize);
    let byte = |at: usize| data.get(at).copied().ok_or_else(missing);
    let number = |bytes: u8, i: usize| match bmp.bits {
        8 => bytes,
        _ if i.is_multiple_of(2) => bytes >> 4,
        _ => bytes & 15,
    };
    let mut one = |x: usize, row: usize, v: u8| {
        if x < bmp.width && row < bmp.height {
            put(x, row, v);
        }
    };
    while row < bmp.height {
        let (count, value) = (usize::from(byte(at)?), byte(at + 1)?);
        at += 2;
        match (count, value) {
            (0, 0) => (x, row) = (0, row + 1),
            (0, 1) => return Ok(()),
            (0, 2) => {
                (x, row) = (x + usize::from(byte(at)?), row + usize::from(byte(at + 1)?));
                at += 2;
            }
            (0, literal) => {
                let literal = usize::from(literal);
                let length = (literal * bmp.bits).div_ceil(8);
                for i in 0..literal {
                    one(x + i, row, number(byte(at + i * bmp.bits / 8)?, i));
                }
                x += literal;
                // Up to an even number of bytes.
                at += length.next_multiple_of(2);
            }
            (count, value) => {
                (0..count).for_each(|i| one(x + i, row, number(value, i)));
                x += count;
            }
        }
    }
    Ok(())
}

/// What its header promises.
pub(super) fn header(bytes: &[u8], limits: &Limits) -> Result<Header, ReadError> {
    let bmp = Bmp::parse(bytes)?;
    let channels = bmp.channels();
    Codes { format: Format::Bmp, size: [bmp.width, bmp.height], channels, passing: channels }.header(limits)
}

fn missing() -> ReadError {
    damaged("pixels are missing")
}

fn damaged(problem: &str) -> ReadError {
    ReadError::damaged("BMP", problem)
}
