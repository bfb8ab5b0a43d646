//! Truevision TGA: grey, colours and palettes, plain or with runs (Truevision, *TGA File Format Specification*, version 2.0, 1991).

use straal_scene::Image;

use super::coded::{Coded, Codes, zeros};
use super::light::Light;
use super::{Format, Header};
use crate::{Limits, ReadError};

/// Bytes of the header.
const HEAD: usize = 18;

/// What the header says.
#[derive(Clone, Copy, Debug)]
struct Tga {
    width: usize,
    height: usize,
    kind: Kind,
    has_runs: bool,
    /// Bytes of a pixel, or of its number in the palette.
    pixel: usize,
    has_alpha: bool,
    /// Whether the first row is the top one, and the first pixel of a row the right one.
    from_top: bool,
    from_right: bool,
    /// The number of the first colour of the palette, how many there are, and bytes of each.
    palette: [usize; 3],
    /// Where the palette, or the pixels, begin.
    start: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Palette,
    Colours,
    Grey,
}

/// Whether a file begins as a TGA does. It has no mark of its own, so all that is said must make sense.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    Tga::parse(bytes).is_ok_and(|tga| tga.width > 0 && tga.height > 0)
}

impl Tga {
    fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let Some(head) = bytes.first_chunk::<HEAD>() else { return Err(damaged("it is too short")) };
        let short = |at: usize| usize::from(u16::from_le_bytes([head[at], head[at + 1]]));
        let bits = head[16];
        let (kind, fits) = match head[2] & 7 {
            1 => (Kind::Palette, head[1] == 1 && matches!(bits, 8 | 16)),
            2 => (Kind::Colours, matches!(bits, 15 | 16 | 24 | 32)),
            3 => (Kind::Grey, matches!(bits, 8 | 16)),
            _ => return Err(damaged("its kind is unknown")),
        };
        let entry = match head[7] {
            _ if head[1] == 0 => 0,
            15 | 16 => 2,
            24 => 3,
            32 => 4,
            _ => return Err(damaged("its palette makes no sense")),
        };
        if !fits || head[1] > 1 || !matches!(head[2], 1..=3 | 9..=11) || head[17] & 0xc0 != 0 {
            return Err(damaged("its header makes no sense"));
        }
        let palette = if head[1] == 1 { [short(3), short(5), entry] } else { [0; 3] };
        let alpha = head[17] & 15;
        Ok(Self {
            width: short(12),
            height: short(14),
            kind,
            has_runs: head[2] > 8,
            pixel: usize::from(bits).div_ceil(8),
            has_alpha: match kind {
                Kind::Palette => entry == 4,
                Kind::Colours => alpha > 0 && matches!(bits, 16 | 32),
                Kind::Grey => bits == 16,
            },
            from_top: head[17] & 0x20 != 0,
            from_right: head[17] & 0x10 != 0,
            palette,
            start: HEAD + usize::from(head[0]),
        })
    }

    fn channels(&self) -> usize {
        let colours = if self.kind == Kind::Grey { 1 } else { 3 };
        colours + usize::from(self.has_alpha)
    }
}

/// Reads a TGA as linear light with the primaries of sRGB.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    Ok(read_codes(bytes, limits)?.into_photo().to_srgb())
}

/// Its codes.
pub(super) fn read_codes(bytes: &[u8], limits: &Limits) -> Result<Coded, ReadError> {
    limits.check_bytes(bytes)?;
    let tga = Tga::parse(bytes)?;
    let count = limits.check_size(tga.width as u64, tga.height as u64)?;
    let [first, colours, entry] = tga.palette;
    let palette_bytes = bytes.get(tga.start..).unwrap_or_default();
    let (Some(palette), Some(mut rest)) =
        (palette_bytes.get(..colours * entry), palette_bytes.get(colours * entry..))
    else {
        return Err(damaged("its palette is missing"));
    };
    // A run of 128 pixels takes at least two bytes.
    let least = if tga.has_runs { count.div_ceil(128) * (1 + tga.pixel) } else { count * tga.pixel };
    if rest.len() < least {
        return Err(missing());
    }
    let channels = tga.channels();
    let mut codes = zeros(count * channels)?;
    let mut put = |i: usize, pixel: &[u8]| -> Result<(), ReadError> {
        let [across, down] = [i % tga.width, i / tga.width];
        let x = if tga.from_right { tga.width - 1 - across } else { across };
        let y = if tga.from_top { down } else { tga.height - 1 - down };
        let colour = match (tga.kind, pixel) {
            (Kind::Palette, number) => {
                let number = number.iter().rev().fold(0, |sum, b| sum << 8 | usize::from(*b));
                let at = number.checked_sub(first).filter(|n| *n < colours);
                let at = at.ok_or_else(|| damaged("a pixel is of a colour that isn't in its palette"))?;
                rgba(&palette[at * entry..(at + 1) * entry])
            }
            (Kind::Colours, pixel) => rgba(pixel),
            (Kind::Grey, pixel) => [pixel[0], pixel.last().copied().unwrap_or(255), 0, 0],
        };
        codes[(y * tga.width + x) * channels..][..channels].copy_from_slice(&colour[..channels]);
        Ok(())
    };
    let mut take = |length: usize| -> Result<&[u8], ReadError> {
        let (taken, after) = rest.split_at_checked(length).ok_or_else(missing)?;
        rest = after;
        Ok(taken)
    };
    let mut done = 0;
    while done < count {
        if !tga.has_runs {
            let pixel = take(tga.pixel)?;
            put(done, pixel)?;
            done += 1;
            continue;
        }
        let head = take(1)?[0];
        let length = usize::from(head & 127) + 1;
        let length = length.min(count - done);
        let pixels = take(if head > 127 { tga.pixel } else { length * tga.pixel })?;
        for i in 0..length {
            let at = if head > 127 { 0 } else { i * tga.pixel };
            put(done + i, &pixels[at..at + tga.pixel])?;
        }
        done += length;
    }
    let light = Light::of_profile(None);
    Ok(Coded { format: Format::Tga, width: tga.width, height: tga.height, channels, bytes: codes, light })
}

/// Blue, green, red and alpha, or five bits of each and one, as red, green, blue and alpha.
fn rgba(pixel: &[u8]) -> [u8; 4] {
    match *pixel {
        [low, high] => {
            let v = u16::from_le_bytes([low, high]);
            let five = |shift: u32| {
                let v = (v >> shift & 31) as u8;
                v << 3 | v >> 2
            };
            [five(10), five(5), five(0), if v >> 15 == 1 { 255 } else { 0 }]
        }
        [b, g, r] => [r, g, b, 255],
        [b, g, r, a] => [r, g, b, a],
        _ => [0; 4],
    }
}

/// What its header promises.
pub(super) fn header(bytes: &[u8], limits: &Limits) -> Result<Header, ReadError> {
    let tga = Tga::parse(bytes)?;
    let channels = tga.channels();
    Codes { format: Format::Tga, size: [tga.width, tga.height], channels, passing: channels }.header(limits)
}

fn missing() -> ReadError {
    damaged("pixels are missing")
}

fn damaged(problem: &str) -> ReadError {
    ReadError::damaged("TGA", problem)
}
