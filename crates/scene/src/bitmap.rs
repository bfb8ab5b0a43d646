//! Pictures that textures are read off: the numbers that their files have, in tiles.
//!
//! A texture is looked up here and there, a few texels at a time that lie beside and above one another. So texels lie in tiles of one cache
//! line, 64 bytes: 4 x 4 of them where a texel has four bytes. And they stay as small as the file has them: codes of 8 or 16 bits
//! and half-precision numbers become light when they are looked up.

use std::fmt;
use std::sync::Arc;

use straal_color::RgbSpace;

/// A picture that a texture is read off. Its first row is the top one.
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    /// Its numbers.
    pub texels: Texels,
    /// How its codes become light, by what its file says; unused where they are numbers of floating point.
    pub response: Response,
    /// What its red, green and blue are, where the file says it.
    pub space: Option<RgbSpace>,
    /// Whether the last channel tells how much of a texel is there.
    pub has_alpha: bool,
}

impl Bitmap {
    /// One texel of black.
    pub(crate) fn black() -> Self {
        let format = TexelFormat { number: Number::Byte, channels: 1 };
        let texels = Texels { width: 1, height: 1, format, across: 1, lines: vec![Line([0; 64])] };
        Self { texels, response: Response::Linear, space: None, has_alpha: false }
    }
}

/// How codes become light.
#[derive(Clone, Default, PartialEq)]
pub enum Response {
    /// They are light.
    #[default]
    Linear,
    /// By tables for red, green and blue: the light of each code.
    Table([Arc<[f32]>; 3]),
}

/// What a number of a texel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Number {
    /// A code from 0 to 255.
    Byte,
    /// A code from 0 to 65,535.
    Short,
    /// Light in half precision.
    Half,
    /// Light in single precision.
    Single,
}

impl Number {
    /// How many bytes it has.
    pub const fn bytes(self) -> usize {
        match self {
            Self::Byte => 1,
            Self::Short | Self::Half => 2,
            Self::Single => 4,
        }
    }
}

/// The numbers of a texel: grey; grey and alpha; or red, green, blue and alpha, which is full where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TexelFormat {
    /// What each is.
    pub number: Number,
    /// How many: 1, 2 or 4.
    pub channels: usize,
}

impl TexelFormat {
    /// How many bytes a texel has: a power of 2, at most 16.
    pub const fn bytes(self) -> usize {
        self.number.bytes() * self.channels
    }

    /// The binary logarithms of a tile's width and height.
    const fn tile(self) -> [u32; 2] {
        tile_of(self.bytes())
    }
}

/// As square as 64 bytes allow, else wider than high.
const fn tile_of(texel: usize) -> [u32; 2] {
    let texels = 6 - texel.trailing_zeros();
    [texels.div_ceil(2), texels / 2]
}

/// A tile: as much as a processor fetches at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
struct Line([u8; 64]);

/// A rectangle of texels.
#[derive(Clone, PartialEq)]
pub struct Texels {
    width: usize,
    height: usize,
    format: TexelFormat,
    /// Tiles in a row.
    across: usize,
    lines: Vec<Line>,
}

impl Texels {
    /// So many texels of zeros; `None` where there are none, or no memory for them.
    pub fn new(width: usize, height: usize, format: TexelFormat) -> Option<Self> {
        if width == 0 || height == 0 || !matches!(format.channels, 1 | 2 | 4) {
            return None;
        }
        let tile = format.tile();
        let [across, down] = [width.div_ceil(1 << tile[0]), height.div_ceil(1 << tile[1])];
        let count = across.checked_mul(down)?;
        let mut lines = Vec::new();
        lines.try_reserve_exact(count).ok()?;
        lines.resize(count, Line([0; 64]));
        Some(Self { width, height, format, across, lines })
    }

    /// How many texels there are in a row.
    #[inline(always)]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// How many rows there are.
    #[inline(always)]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// What a texel is.
    #[inline(always)]
    pub const fn format(&self) -> TexelFormat {
        self.format
    }

    /// The tile of a texel, and its first byte in there.
    #[inline(always)]
    fn place(&self, x: usize, y: usize, bytes: usize) -> (usize, usize) {
        let [w, h] = tile_of(bytes);
        let tile = (y >> h) * self.across + (x >> w);
        let within = ((y & ((1 << h) - 1)) << w) + (x & ((1 << w) - 1));
        (tile, within * bytes)
    }

    /// The bytes of a texel of `N` bytes, in the machine's order.
    ///
    /// # Panics
    /// Beyond the rectangle, or where texels have another number of bytes.
    #[inline(always)]
    pub fn bytes<const N: usize>(&self, x: usize, y: usize) -> [u8; N] {
        debug_assert!(N == self.format.bytes() && x < self.width && y < self.height);
        let (tile, first) = self.place(x, y, N);
        let mut bytes = [0; N];
        bytes.copy_from_slice(&self.lines[tile].0[first..first + N]);
        bytes
    }

    /// Puts the bytes of a texel, in the machine's order; what doesn't fit is left out.
    #[inline]
    pub fn put(&mut self, x: usize, y: usize, bytes: &[u8]) {
        let size = self.format.bytes();
        let (tile, first) = self.place(x, y, size);
        if let Some(to) = self.lines.get_mut(tile)
            && bytes.len() == size
        {
            to.0[first..first + size].copy_from_slice(bytes);
        }
    }

    /// The numbers of a texel as they are: codes as whole numbers, and light.
    pub fn numbers(&self, x: usize, y: usize) -> [f32; 4] {
        let (tile, first) = self.place(x, y, self.format.bytes());
        let TexelFormat { number, channels } = self.format;
        let mut out = [0.0; 4];
        let bytes = &self.lines[tile].0[first..first + self.format.bytes()];
        for (v, bytes) in out.iter_mut().zip(bytes.chunks_exact(number.bytes())).take(channels) {
            *v = match (number, bytes) {
                (Number::Byte, &[b]) => f32::from(b),
                (Number::Short, &[a, b]) => f32::from(u16::from_ne_bytes([a, b])),
                (Number::Half, &[a, b]) => of_half(u16::from_ne_bytes([a, b])),
                (Number::Single, &[a, b, c, d]) => f32::from_ne_bytes([a, b, c, d]),
                _ => 0.0,
            };
        }
        out
    }

    /// Puts numbers as [`Self::numbers`] gives them: codes are cut off after the point, light is rounded.
    pub fn put_numbers(&mut self, x: usize, y: usize, numbers: [f32; 4]) {
        let TexelFormat { number, channels } = self.format;
        let mut bytes = [0; 16];
        let size = number.bytes();
        for (v, to) in numbers.into_iter().zip(bytes.chunks_exact_mut(size)).take(channels) {
            match number {
                Number::Byte => to.copy_from_slice(&[v as u8]),
                Number::Short => to.copy_from_slice(&(v as u16).to_ne_bytes()),
                Number::Half => to.copy_from_slice(&to_half(v).to_ne_bytes()),
                Number::Single => to.copy_from_slice(&v.to_ne_bytes()),
            }
        }
        self.put(x, y, &bytes[..self.format.bytes()]);
    }

    /// Bytes that it takes.
    pub fn heap_bytes(&self) -> u64 {
        size_of_val(self.lines.as_slice()) as u64
    }

    /// Bytes that so many texels take.
    pub fn bytes_of(width: u64, height: u64, format: TexelFormat) -> u64 {
        let [w, h] = format.tile();
        width.div_ceil(1 << w).saturating_mul(height.div_ceil(1 << h)).saturating_mul(64)
    }
}

impl Bitmap {
    /// A picture of light, row by row from the top: of one channel where it is grey all over, and in half precision where that
    /// holds all of its numbers. `None` where there are no pixels, or no memory for them.
    pub fn of_light(
        [width, height]: [usize; 2],
        pixels: &[[f32; 3]],
        space: Option<RgbSpace>,
    ) -> Option<Self> {
        let is_grey = pixels.iter().all(|[r, g, b]| r == g && g == b);
        let is_held = |v: &f32| of_half(to_half(*v)).to_bits() == v.to_bits();
        let number = if pixels.as_flattened().iter().all(is_held) { Number::Half } else { Number::Single };
        let mut texels =
            Texels::new(width, height, TexelFormat { number, channels: if is_grey { 1 } else { 4 } })?;
        for (i, [r, g, b]) in pixels.iter().take(width * height).enumerate() {
            texels.put_numbers(i % width, i / width, [*r, *g, *b, 1.0]);
        }
        Some(Self { texels, response: Response::Linear, space, has_alpha: false })
    }

    /// Bytes of its numbers and tables.
    pub fn heap_bytes(&self) -> u64 {
        let tables = match &self.response {
            Response::Linear => 0,
            Response::Table([table, ..]) => size_of_val(&**table) as u64,
        };
        self.texels.heap_bytes() + tables
    }
}

/// Millions of numbers tell nothing.
impl fmt::Debug for Texels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} x {} texels of {:?}", self.width, self.height, self.format)
    }
}

/// As do tables.
impl fmt::Debug for Response {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if matches!(self, Self::Linear) { "Linear" } else { "Table" })
    }
}

/// A half-precision number that is neither infinite nor NaN.
#[inline(always)]
pub fn of_half(half: u16) -> f32 {
    let half = u32::from(half);
    // As a float its exponent is too small by 112, and subnormal numbers stay in proportion.
    let scale = f32::from_bits((127 + 112) << 23);
    let size = f32::from_bits((half & 0x7fff) << 13) * scale;
    f32::from_bits(size.to_bits() | (half & 0x8000) << 16)
}

/// The nearest half-precision number, even where two are as near; the largest for what is beyond it, and 0 for NaN.
pub fn to_half(v: f32) -> u16 {
    let sign = (v.to_bits() >> 16 & 0x8000) as u16;
    let size = v.to_bits() & 0x7fff_ffff;
    // 65,504.
    const LARGEST: u32 = 0x477f_e000;
    if size > 0x7f80_0000 {
        return 0;
    }
    if size >= LARGEST {
        return sign | 0x7bff;
    }
    if size < 0x3880_0000 {
        // Subnormal: in steps of 2^-24. Adding 1/2 leaves that many bits.
        let steps = f32::from_bits(size) + 0.5;
        return sign | (steps.to_bits() - 0.5_f32.to_bits()) as u16;
    }
    let rebased = size - (112 << 23);
    let rounded = (rebased + 0x0fff + (rebased >> 13 & 1)) >> 13;
    sign | if rounded > 0x7bff { 0x7bff } else { rounded as u16 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_go_there_and_back() {
        for half in (0..0x7c00_u16).chain(0x8000..0xfc00) {
            assert_eq!(to_half(of_half(half)), half, "{half:#x} {}", of_half(half));
        }
        assert_eq!(of_half(0x3c00), 1.0);
        assert_eq!(of_half(0x0001), f32::from_bits((127 - 24) << 23));
        assert_eq!(of_half(0xc500), -5.0);
        for (v, want) in [(f32::NAN, 0), (f32::INFINITY, 0x7bff), (-1e9, 0xfbff), (65_519.0, 0x7bff)] {
            assert_eq!(to_half(v), want);
        }
        // The nearest, and even where it is as near.
        assert_eq!(to_half(1.0 + 1.0 / 2048.0), 0x3c00);
        assert_eq!(to_half(1.0 + 3.0 / 2048.0), 0x3c02);
        assert_eq!(to_half(1.0 + 1.01 / 2048.0), 0x3c01);
    }

    #[test]
    fn texels_are_where_they_were_put() {
        for number in [Number::Byte, Number::Short, Number::Half, Number::Single] {
            for channels in [1, 2, 4] {
                let format = TexelFormat { number, channels };
                let mut texels = Texels::new(13, 7, format).unwrap();
                let value = |x: usize, y: usize| [x as f32, y as f32, (x + y) as f32, (x * y) as f32];
                (0..91).for_each(|i| texels.put_numbers(i % 13, i / 13, value(i % 13, i / 13)));
                for i in 0..91 {
                    let (x, y) = (i % 13, i / 13);
                    assert_eq!(
                        texels.numbers(x, y)[..channels],
                        value(x, y)[..channels],
                        "{format:?} {x} {y}"
                    );
                }
                assert_eq!(texels.heap_bytes(), Texels::bytes_of(13, 7, format));
            }
        }
        let bytes = TexelFormat { number: Number::Byte, channels: 4 };
        assert!(Texels::new(0, 3, bytes).is_none() && Texels::new(usize::MAX, 1 << 40, bytes).is_none());
    }

    #[test]
    fn light_takes_no_more_than_it_must() {
        let format = |pixels: &[[f32; 3]]| Bitmap::of_light([2, 1], pixels, None).unwrap().texels.format();
        let of = |number, channels| TexelFormat { number, channels };
        assert_eq!(format(&[[0.5; 3], [2.0; 3]]), of(Number::Half, 1));
        assert_eq!(format(&[[0.5; 3], [2.0, 1.0, 0.25]]), of(Number::Half, 4));
        assert_eq!(format(&[[0.1; 3], [2.0; 3]]), of(Number::Single, 1));
        assert_eq!(format(&[[1e6, 1.0, 1.0], [2.0; 3]]), of(Number::Single, 4));
        assert!(Bitmap::of_light([0, 0], &[], None).is_none());
    }
}
