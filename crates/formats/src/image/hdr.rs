//! Radiance HDR (RGBE), the usual format of environment maps.
//!
//! After Ward, *Real Pixels* (Graphics Gems II, 1991) and the Radiance file format notes: a text header, a line with
//! the size and orientation, then scan lines of four bytes a pixel, flat or run-length encoded in either of two ways.

use std::io::{self, Write};

use straal_color::{Chromaticity, RgbSpace};
use straal_scene::Image;
use straal_scene::bitmap::Number;

use super::header::PIXEL;
use super::{Format, Photo};
use crate::read_error::quoted;
use crate::{Limits, ReadError};

/// Reads an HDR picture as linear light with the primaries of sRGB, as [`read_photo`] does.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    Ok(read_photo(bytes, limits)?.to_srgb())
}

/// Reads an HDR picture. `EXPOSURE` and `COLORCORR` lines are undone, so that the numbers are radiances again; they are of the
/// primaries that a line `PRIMARIES` says. `xyze` colours are refused. All eight orientations are turned upright.
pub fn read_photo(bytes: &[u8], limits: &Limits) -> Result<Photo, ReadError> {
    limits.check_bytes(bytes)?;
    let header = Header::parse(bytes)?;
    let pixels = limits.check_size(header.line_length as u64, header.lines as u64)?;
    limits.check_decoded(header.promise(pixels as u64).decoded_bytes)?;
    // A run of the old encoding holds at most 255 << 24 pixels in four bytes, but no real file is like that; the
    // other one holds 127 numbers in two bytes.
    let body = &bytes[header.length..];
    if (pixels / 256) as u64 > body.len() as u64 {
        return Err(ReadError::byte(
            header.length,
            format!("{pixels} pixels are promised, but only {} bytes are there", body.len()),
        ));
    }
    let mut image = Image { width: header.width(), height: header.height(), pixels: vec![[0.0; 3]; pixels] };
    let scale = header.correction.map(|c| 1.0 / (header.exposure * c));
    let mut line = vec![[0u8; 4]; header.line_length];
    let mut reader = Lines { bytes, at: header.length };
    for i in 0..header.lines {
        reader.read(&mut line)?;
        for (j, rgbe) in line.iter().enumerate() {
            let (x, y) = header.place(i, j);
            let stored = decode(*rgbe);
            image.pixels[y * image.width + x] = [0, 1, 2].map(|k| (f64::from(stored[k]) * scale[k]) as f32);
        }
    }
    let Header { space, notes, .. } = header;
    Ok(Photo { space, notes, ..Photo::of_image(Format::Hdr, image) })
}

/// What the header promises.
pub(super) fn header(bytes: &[u8], limits: &Limits) -> Result<super::Header, ReadError> {
    let header = Header::parse(bytes)?;
    let pixels = limits.check_size(header.line_length as u64, header.lines as u64)? as u64;
    Ok(header.promise(pixels))
}

/// Writes an HDR picture, flat: every pixel in four bytes that share an exponent, with an error of up to a 256th of the
/// strongest component. The format has no numbers below 0 nor above 2^127: those, and what is no number, become the
/// nearest it has.
pub fn write<W: Write>(mut writer: W, image: &Image) -> io::Result<()> {
    if image.width == 0 || image.pixels.len() != image.width * image.height {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the picture's size and pixels differ"));
    }
    write!(writer, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", image.height, image.width)?;
    for row in image.pixels.chunks_exact(image.width) {
        let bytes: Vec<u8> = row.iter().copied().flat_map(encode).collect();
        writer.write_all(&bytes)?;
    }
    Ok(())
}

/// Four bytes of a pixel. A flat file can be taken for a run-length encoded one where a line begins with 2, 2 or ends a
/// run with 1, 1, 1: mantissas are normalised, so that the largest is at least 128 and neither can be.
fn encode(rgb: [f32; 3]) -> [u8; 4] {
    let rgb = rgb.map(|v| if v > 0.0 { f64::from(v) } else { 0.0 });
    let most = rgb.into_iter().fold(0.0, |a: f64, b| if b > a { b } else { a });
    // The smallest normal number of the format is 2^-128.
    if most < f64::from_bits((1023 - 128) << 52) {
        return [0; 4];
    }
    // most = m 2^e with m in [1/2, 1); the scale brings it to [128, 256).
    let e = if most.is_finite() { (most.to_bits() >> 52) as i64 - 1022 } else { 128 };
    let e = if e < 127 { e } else { 127 };
    let scale = f64::from_bits(((8 - e + 1023) as u64) << 52);
    let code = |v: f64| (v * scale) as u8;
    let [r, g, b] = rgb.map(code);
    [r, g, b, (e + 128) as u8]
}

/// Radiance of a pixel: mantissa / 256 * 2^(exponent - 128); an exponent of 0 is black. Like most readers, and
/// unlike Radiance itself, no half step is added to the mantissa, so that 0 stays 0.
fn decode([r, g, b, e]: [u8; 4]) -> [f32; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    // 2^(e - 136), the smallest of which is subnormal as a float but not as a double.
    let scale = f64::from_bits(((i64::from(e) - 136 + 1023) as u64) << 52);
    [r, g, b].map(|v| (f64::from(v) * scale) as f32)
}

struct Header {
    /// Pixels of a scan line and the number of scan lines, which run along x or y.
    line_length: usize,
    lines: usize,
    lines_along_x: bool,
    /// Whether x and y of the file fall from one pixel to the next.
    x_falls: bool,
    y_falls: bool,
    /// The product of all exposures that were applied to the pixels.
    exposure: f64,
    /// The product of all corrections of red, green and blue that were.
    correction: [f64; 3],
    /// What red, green, blue and white are, where the file says it.
    space: Option<RgbSpace>,
    /// What couldn't be honoured.
    notes: Vec<String>,
    /// Bytes up to the first scan line.
    length: usize,
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let mut exposure = 1.0f64;
        let mut correction = [1.0f64; 3];
        let mut space = None;
        let mut notes = Vec::new();
        let mut at = 0;
        let mut number = 0;
        let mut next = || {
            let length = bytes[at..].iter().position(|&b| b == b'\n')?;
            let line = bytes[at..at + length].trim_ascii();
            at += length + 1;
            number += 1;
            Some((number, at, line))
        };
        let unfinished = || ReadError::file("the header ends too early");
        let (_, _, magic) = next().ok_or_else(unfinished)?;
        if !magic.starts_with(b"#?") {
            return Err(ReadError::file("not an HDR picture: it doesn't begin with '#?'"));
        }
        loop {
            let (number, _, line) = next().ok_or_else(unfinished)?;
            if line.is_empty() {
                break;
            }
            if let Some(format) = line.strip_prefix(b"FORMAT=") {
                if format.trim_ascii() != b"32-bit_rle_rgbe" {
                    let format = quoted(format);
                    return Err(ReadError::line(
                        number,
                        format!("the format {format} is not supported, only '32-bit_rle_rgbe'"),
                    ));
                }
            } else if let Some(value) = line.strip_prefix(b"EXPOSURE=") {
                let factor = numbers::<1>(value).filter(|[f]| *f > 0.0);
                let Some([factor]) = factor else {
                    let value = quoted(value);
                    return Err(ReadError::line(number, format!("expected an exposure, found {value}")));
                };
                exposure *= factor;
            } else if let Some(value) = line.strip_prefix(b"COLORCORR=") {
                let Some(factors) = numbers::<3>(value).filter(|f| f.iter().all(|f| *f > 0.0)) else {
                    let value = quoted(value);
                    let wanted = "expected three factors of red, green and blue";
                    return Err(ReadError::line(number, format!("{wanted}, found {value}")));
                };
                correction = [0, 1, 2].map(|k| correction[k] * factors[k]);
            } else if let Some(value) = line.strip_prefix(b"PRIMARIES=") {
                let Some(told) = numbers::<8>(value) else {
                    let value = quoted(value);
                    let wanted = "expected x and y of red, green, blue and white";
                    return Err(ReadError::line(number, format!("{wanted}, found {value}")));
                };
                let at = |k: usize| Chromaticity { x: told[2 * k], y: told[2 * k + 1] };
                let all = RgbSpace { primaries: [0, 1, 2].map(at), white: at(3) };
                space = Some(all.recognised()).filter(RgbSpace::is_sound);
                // Many files of panoramas have noughts there, which say nothing.
                if space.is_none() && told != [0.0; 8] {
                    notes.push("its PRIMARIES make no sense: those of sRGB are taken".into());
                }
            } else if let Some(value) = line.strip_prefix(b"GAMMA=")
                && numbers::<1>(value) != Some([1.0])
            {
                notes.push(format!("its gamma of {} is not undone: the format holds light", quoted(value)));
            }
        }
        let sound = |factor: f64| factor > 0.0 && factor.is_finite();
        if !sound(exposure) || !correction.iter().all(|c| sound(exposure * c)) {
            return Err(ReadError::file("the exposures and corrections multiply to no number"));
        }
        let (number, length, line) = next().ok_or_else(unfinished)?;
        let wrong = || {
            let line = quoted(line);
            ReadError::line(number, format!("expected a size such as '-Y 512 +X 1024', found {line}"))
        };
        let text = std::str::from_utf8(line).map_err(|_| wrong())?;
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        let &[first, lines, second, line_length] = words.as_slice() else {
            return Err(wrong());
        };
        let lines = lines.parse().map_err(|_| wrong())?;
        let line_length = line_length.parse().map_err(|_| wrong())?;
        let axis = |word: &str| match word {
            "+X" => Some((true, false)),
            "-X" => Some((true, true)),
            "+Y" => Some((false, false)),
            "-Y" => Some((false, true)),
            _ => None,
        };
        let ((first_is_x, first_falls), (second_is_x, second_falls)) =
            axis(first).zip(axis(second)).ok_or_else(wrong)?;
        if first_is_x == second_is_x {
            return Err(wrong());
        }
        let (x_falls, y_falls) =
            if first_is_x { (first_falls, second_falls) } else { (second_falls, first_falls) };
        let lines_along_x = !first_is_x;
        Ok(Self {
            line_length,
            lines,
            lines_along_x,
            x_falls,
            y_falls,
            exposure,
            correction,
            space,
            notes,
            length,
        })
    }

    /// What is promised of so many pixels.
    fn promise(&self, pixels: u64) -> super::Header {
        super::Header {
            format: Format::Hdr,
            width: self.width(),
            height: self.height(),
            channels: 3,
            decoded_bytes: pixels.saturating_mul(PIXEL).saturating_add(4 * self.line_length as u64),
            texel: super::Header::texel(Number::Single, 3),
        }
    }

    fn width(&self) -> usize {
        if self.lines_along_x { self.line_length } else { self.lines }
    }

    fn height(&self) -> usize {
        if self.lines_along_x { self.lines } else { self.line_length }
    }

    /// Column and row, from the top left, of pixel `j` of scan line `i`. Y of the file points up.
    fn place(&self, i: usize, j: usize) -> (usize, usize) {
        let (x, y) = if self.lines_along_x { (j, i) } else { (i, j) };
        let x = if self.x_falls { self.width() - 1 - x } else { x };
        let y = if self.y_falls { y } else { self.height() - 1 - y };
        (x, y)
    }
}

/// So many finite numbers in a row, and nothing else.
fn numbers<const N: usize>(text: &[u8]) -> Option<[f64; N]> {
    let text = std::str::from_utf8(text).ok()?;
    let all: Option<Vec<f64>> =
        text.split_ascii_whitespace().map(|word| word.parse().ok().filter(|v: &f64| v.is_finite())).collect();
    all?.try_into().ok()
}

/// The scan lines, one after another.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Lines<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let Some(&taken) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(ReadError::byte(self.at, "the file ends too early"));
        };
        self.at += N;
        Ok(taken)
    }

    fn read(&mut self, line: &mut [[u8; 4]]) -> Result<(), ReadError> {
        // Lines of 8 to 32,767 pixels may begin with 2, 2 and their length: then each component is encoded apart.
        let start = self.bytes[self.at..].first_chunk::<4>();
        match start {
            Some(&[2, 2, high, low]) if high < 128 && (8..32768).contains(&line.len()) => {
                if usize::from(u16::from_be_bytes([high, low])) != line.len() {
                    return Err(ReadError::byte(self.at, "a scan line has another length than the picture"));
                }
                self.at += 4;
                (0..4).try_for_each(|k| self.read_component(line, k))
            }
            _ => self.read_old(line),
        }
    }

    /// One component of a line: a byte above 128 repeats the next one that many times less 128, any other is
    /// followed by as many single ones.
    fn read_component(&mut self, line: &mut [[u8; 4]], k: usize) -> Result<(), ReadError> {
        let mut x = 0;
        while x < line.len() {
            let place = self.at;
            let [count] = self.take()?;
            let (count, run) = if count > 128 { (count - 128, true) } else { (count, false) };
            let Some(pixels) = line.get_mut(x..x + usize::from(count)).filter(|p| !p.is_empty()) else {
                return Err(ReadError::byte(place, "a run of a scan line has a wrong length"));
            };
            x += pixels.len();
            if run {
                let [value] = self.take()?;
                pixels.iter_mut().for_each(|pixel| pixel[k] = value);
            } else {
                for pixel in pixels {
                    [pixel[k]] = self.take()?;
                }
            }
        }
        Ok(())
    }

    /// Plain pixels, among which 1, 1, 1, n repeats the one before n times; further such pixels are the higher
    /// digits of the count, to the base 256.
    fn read_old(&mut self, line: &mut [[u8; 4]]) -> Result<(), ReadError> {
        let mut x = 0;
        let mut shift = 0;
        while x < line.len() {
            let place = self.at;
            let pixel: [u8; 4] = self.take()?;
            if let [1, 1, 1, digit] = pixel {
                let count = if shift < 32 { usize::from(digit) << shift } else { usize::MAX };
                let end = x.saturating_add(count);
                if x == 0 || end > line.len() {
                    return Err(ReadError::byte(place, "a run of a scan line has a wrong length"));
                }
                let before = line[x - 1];
                line[x..end].fill(before);
                x = end;
                shift += 8;
            } else {
                line[x] = pixel;
                x += 1;
                shift = 0;
            }
        }
        Ok(())
    }
}
