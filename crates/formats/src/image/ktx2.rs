//! KTX2, Khronos's textures: their largest level, uncompressed or in blocks of BC1 to BC7, plain or packed by Zstandard or zlib.
//!
//! Smaller copies in the file aren't used, for straal makes its own in linear light. Of an array the first layer is taken; cubes and
//! volumes are refused. So are Basis Universal (ETC1S and UASTC), ETC2, ASTC and PVRTC: no reader of them in Rust is small and well
//! kept. The crate `basisu` 0.1 reads all of Basis Universal, in 680,000 lines, most of them tables for graphics cards.
//! Formats and colours have their numbers from the `ktx2` crate, whose own reader trusts its file; blocks are decoded by `bcdec_rs`, Zstandard by `ruzstd`.

use ::ktx2::{ColorPrimaries, Format as Vk, TransferFunction};
use ruzstd::decoding::StreamingDecoder;
use std::borrow::Cow;
use std::io::Read;
use straal_color::{RgbSpace, Space};
use straal_scene::Image;
use straal_scene::bitmap::{Bitmap, Number, TexelFormat, Texels, of_half, to_half};

use super::coded::no_memory;
use super::header::PIXEL;
use super::icc::Response;
use super::light::Light;
use super::png::{Curve, Encoding};
use super::{Format, Header, Photo};
use crate::{Limits, ReadError};

/// How it begins.
pub(super) const MAGIC: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";

/// How texels lie in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layout {
    number: Number,
    /// Numbers of a texel, once it is decoded.
    channels: usize,
    packing: Packing,
    is_srgb: bool,
}

/// How the numbers of a texel, or of a block of 4 x 4, are packed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Packing {
    /// One after the other.
    Plain,
    /// One after the other, blue first.
    BlueFirst,
    /// Three of nine bits with one exponent.
    SharedExponent,
    /// Floats of 11, 11 and 10 bits.
    Small,
    /// A block of that kind, of so many bytes.
    Block(Block),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Block {
    /// With its alpha, or without.
    Bc1 {
        is_opaque: bool,
    },
    Bc2,
    Bc3,
    Bc4,
    Bc5,
    Bc6 {
        is_signed: bool,
    },
    Bc7,
}

impl Layout {
    /// Of a format by Vulkan's number.
    fn of(format: Vk) -> Option<Self> {
        let plain = |number, channels| (number, channels, Packing::Plain, false);
        let bytes = |channels, packing, is_srgb| (Number::Byte, channels, packing, is_srgb);
        let block = |channels, block, is_srgb| (Number::Byte, channels, Packing::Block(block), is_srgb);
        let clear = Block::Bc1 { is_opaque: false };
        let opaque = Block::Bc1 { is_opaque: true };
        let (number, channels, packing, is_srgb) = match format {
            Vk::R8_UNORM => bytes(1, Packing::Plain, false),
            Vk::R8_SRGB => bytes(1, Packing::Plain, true),
            Vk::R8G8_UNORM => bytes(2, Packing::Plain, false),
            Vk::R8G8_SRGB => bytes(2, Packing::Plain, true),
            Vk::R8G8B8_UNORM => bytes(3, Packing::Plain, false),
            Vk::R8G8B8_SRGB => bytes(3, Packing::Plain, true),
            Vk::B8G8R8_UNORM => bytes(3, Packing::BlueFirst, false),
            Vk::B8G8R8_SRGB => bytes(3, Packing::BlueFirst, true),
            Vk::R8G8B8A8_UNORM | Vk::A8B8G8R8_UNORM_PACK32 => bytes(4, Packing::Plain, false),
            Vk::R8G8B8A8_SRGB | Vk::A8B8G8R8_SRGB_PACK32 => bytes(4, Packing::Plain, true),
            Vk::B8G8R8A8_UNORM => bytes(4, Packing::BlueFirst, false),
            Vk::B8G8R8A8_SRGB => bytes(4, Packing::BlueFirst, true),
            Vk::R16_UNORM => plain(Number::Short, 1),
            Vk::R16G16_UNORM => plain(Number::Short, 2),
            Vk::R16G16B16_UNORM => plain(Number::Short, 3),
            Vk::R16G16B16A16_UNORM => plain(Number::Short, 4),
            Vk::R16_SFLOAT => plain(Number::Half, 1),
            Vk::R16G16_SFLOAT => plain(Number::Half, 2),
            Vk::R16G16B16_SFLOAT => plain(Number::Half, 3),
            Vk::R16G16B16A16_SFLOAT => plain(Number::Half, 4),
            Vk::R32_SFLOAT => plain(Number::Single, 1),
            Vk::R32G32_SFLOAT => plain(Number::Single, 2),
            Vk::R32G32B32_SFLOAT => plain(Number::Single, 3),
            Vk::R32G32B32A32_SFLOAT => plain(Number::Single, 4),
            Vk::E5B9G9R9_UFLOAT_PACK32 => (Number::Half, 3, Packing::SharedExponent, false),
            Vk::B10G11R11_UFLOAT_PACK32 => (Number::Half, 3, Packing::Small, false),
            Vk::BC1_RGB_UNORM_BLOCK => block(3, opaque, false),
            Vk::BC1_RGB_SRGB_BLOCK => block(3, opaque, true),
            Vk::BC1_RGBA_UNORM_BLOCK => block(4, clear, false),
            Vk::BC1_RGBA_SRGB_BLOCK => block(4, clear, true),
            Vk::BC2_UNORM_BLOCK => block(4, Block::Bc2, false),
            Vk::BC2_SRGB_BLOCK => block(4, Block::Bc2, true),
            Vk::BC3_UNORM_BLOCK => block(4, Block::Bc3, false),
            Vk::BC3_SRGB_BLOCK => block(4, Block::Bc3, true),
            Vk::BC4_UNORM_BLOCK => block(1, Block::Bc4, false),
            Vk::BC5_UNORM_BLOCK => block(2, Block::Bc5, false),
            Vk::BC6H_UFLOAT_BLOCK => {
                (Number::Half, 3, Packing::Block(Block::Bc6 { is_signed: false }), false)
            }
            Vk::BC6H_SFLOAT_BLOCK => (Number::Half, 3, Packing::Block(Block::Bc6 { is_signed: true }), false),
            Vk::BC7_UNORM_BLOCK => block(4, Block::Bc7, false),
            Vk::BC7_SRGB_BLOCK => block(4, Block::Bc7, true),
            _ => return None,
        };
        Some(Self { number, channels, packing, is_srgb })
    }

    /// Bytes of so many texels.
    fn bytes(&self, width: u64, height: u64) -> u64 {
        let texels = width.saturating_mul(height);
        let blocks = width.div_ceil(4).saturating_mul(height.div_ceil(4));
        match self.packing {
            Packing::Plain | Packing::BlueFirst => {
                texels.saturating_mul((self.channels * self.number.bytes()) as u64)
            }
            Packing::SharedExponent | Packing::Small => texels.saturating_mul(4),
            Packing::Block(block) => blocks.saturating_mul(block.bytes() as u64),
        }
    }
}

impl Block {
    const fn bytes(self) -> usize {
        if matches!(self, Self::Bc1 { .. } | Self::Bc4) { 8 } else { 16 }
    }
}

/// Where a channel of the picture comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Channel(usize),
    Zero,
    One,
}

impl Layout {
    /// Red, green, blue and alpha: as the file swizzles them. A single channel is grey.
    fn sources(&self, swizzle: Option<&[u8]>) -> [Source; 4] {
        let own = |i: usize| if i < self.channels { Source::Channel(i) } else { Source::Zero };
        let alpha = if self.channels == 4 { Source::Channel(3) } else { Source::One };
        let plain = match self.channels {
            1 => [Source::Channel(0), Source::Channel(0), Source::Channel(0), Source::One],
            _ => [own(0), own(1), own(2), alpha],
        };
        let Some(&[r, g, b, a]) = swizzle.and_then(|s| s.first_chunk::<4>()) else { return plain };
        let of = |letter: u8| {
            Some(match letter {
                b'r' => own(0),
                b'g' => own(1),
                b'b' => own(2),
                b'a' => alpha,
                b'0' => Source::Zero,
                b'1' => Source::One,
                _ => return None,
            })
        };
        match [r, g, b, a].map(of) {
            [Some(r), Some(g), Some(b), Some(a)] => [r, g, b, a],
            _ => plain,
        }
    }

    /// What texels of these become, and the sources of their channels.
    fn texel(&self, [r, g, b, a]: [Source; 4]) -> (TexelFormat, Vec<Source>) {
        let sources = match a {
            _ if r != g || g != b => vec![r, g, b, a],
            Source::One => vec![r],
            a => vec![r, a],
        };
        (TexelFormat { number: self.number, channels: sources.len() }, sources)
    }
}

/// The numbers that stand at the beginning of a file.
struct Start {
    layout: Layout,
    width: u32,
    height: u32,
    scheme: u32,
}

impl Start {
    fn of(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        let head = bytes.first_chunk::<80>().ok_or_else(|| damaged("it ends in its header"))?;
        let number = |i: usize| {
            let at = 12 + 4 * i;
            u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]])
        };
        let [format, _, width, height, depth, _, faces] = [0, 1, 2, 3, 4, 5, 6].map(number);
        let scheme = number(8);
        if scheme == 1 || format == 0 {
            return Err(ReadError::file(
                "it is a KTX2 texture in Basis Universal (ETC1S or UASTC), which is not supported: convert it to PNG, or to KTX2 without it",
            ));
        }
        let layout = Vk::new(format).and_then(Layout::of).ok_or_else(|| {
            let name = Vk::new(format).map_or(String::new(), |format| format!(" {format:?}"));
            ReadError::file(format!(
                "it is a KTX2 texture of the format{name} ({format}), which is not supported: whole numbers of 8 and 16 bits, floats and BC1 to BC7 are"
            ))
        })?;
        if faces > 1 || depth > 1 {
            let what = if faces > 1 { "a cube of six pictures" } else { "a volume" };
            return Err(ReadError::file(format!("it is a KTX2 texture that is {what}, not a picture")));
        }
        let height = if height == 0 { 1 } else { height };
        limits.check_size(width.into(), height.into())?;
        Ok(Self { layout, width, height, scheme })
    }
}

/// What lies where in a file (Khronos, KTX File Format Specification 2.0, section 3).
struct Container<'a> {
    /// The largest level.
    level: &'a [u8],
    /// What is told of the texture, by keys.
    values: Vec<(&'a [u8], &'a [u8])>,
    layers: u32,
    /// The four bytes of the basic descriptor that tell of colours: model, primaries, transfer function and flags.
    colours: Option<[u8; 4]>,
}

impl<'a> Container<'a> {
    fn of(bytes: &'a [u8]) -> Result<Self, ReadError> {
        let short = || damaged("it ends in its header");
        let number = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
        let long = |at: usize| Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
        let section = |start: u64, length: u64| {
            let (start, end) =
                (usize::try_from(start).ok()?, usize::try_from(start.checked_add(length)?).ok()?);
            bytes.get(start..end)
        };
        let layers = number(32).ok_or_else(short)?;
        let [descriptors, values] = [48, 56].map(|at| {
            let (start, length) = (number(at)?, number(at + 4)?);
            section(start.into(), length.into())
        });
        let (descriptors, values) = (descriptors.ok_or_else(short)?, values.ok_or_else(short)?);
        let (start, length) = long(80).zip(long(88)).ok_or_else(|| damaged("it has no level"))?;
        let level = section(start, length).ok_or_else(|| damaged("its level lies beyond its end"))?;
        // The size of all, then a basic block: who defined it and its kind (0), its version and size, and the bytes that are wanted.
        let is_basic = descriptors.get(4..8) == Some(&[0; 4]);
        let colours = descriptors.get(12..).and_then(|d| d.first_chunk()).copied().filter(|_| is_basic);
        Ok(Self { level, values: pairs(values), layers, colours })
    }

    fn value(&self, key: &str) -> Option<&'a [u8]> {
        self.values.iter().find(|(k, _)| *k == key.as_bytes()).map(|(_, value)| *value)
    }
}

/// Keys and values: the length of both, the key, a zero, the value, and zeros to the next multiple of four.
fn pairs(mut bytes: &[u8]) -> Vec<(&[u8], &[u8])> {
    let mut out = Vec::new();
    while let Some((length, rest)) = bytes.split_first_chunk() {
        let length = u32::from_le_bytes(*length) as usize;
        let Some(pair) = rest.get(..length) else { break };
        if let Some(end) = pair.iter().position(|b| *b == 0) {
            out.push((&pair[..end], &pair[end + 1..]));
        }
        bytes = rest.get(length.next_multiple_of(4)..).unwrap_or_default();
    }
    out
}

/// What it promises.
pub(super) fn header(bytes: &[u8], limits: &Limits) -> Result<Header, ReadError> {
    let Start { layout, width, height, scheme } = Start::of(bytes, limits)?;
    let (w, h) = (u64::from(width), u64::from(height));
    let unpacked = if scheme == 0 { 0 } else { layout.bytes(w, h) };
    Ok(Header {
        format: Format::Ktx2,
        width: width as usize,
        height: height as usize,
        channels: layout.channels,
        decoded_bytes: w.saturating_mul(h).saturating_mul(PIXEL).saturating_add(unpacked),
        texel: Header::texel(layout.number, if layout.channels == 2 { 4 } else { layout.channels }),
    })
}

/// Reads a KTX2 texture as linear light with the primaries of sRGB.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Image, ReadError> {
    Ok(read_photo(bytes, limits)?.to_srgb())
}

/// As light.
pub(super) fn read_photo(bytes: &[u8], limits: &Limits) -> Result<Photo, ReadError> {
    let Decoded { texels, mut light, .. } = read_texels(bytes, limits)?;
    let (width, height) = (texels.width(), texels.height());
    let TexelFormat { number, channels } = texels.format();
    let codes = if number == Number::Short { 65_536 } else { 256 };
    let tables = light.tables(codes);
    let is_code = matches!(number, Number::Byte | Number::Short);
    let colour = |i: usize| {
        let numbers = texels.numbers(i % width, i / width);
        let [r, g, b] = if channels < 3 { [numbers[0]; 3] } else { [numbers[0], numbers[1], numbers[2]] };
        if !is_code {
            return [r, g, b];
        }
        [tables[0][r as usize], tables[1][g as usize], tables[2][b as usize]]
    };
    let pixels = (0..width * height).map(colour).collect();
    if channels % 2 == 0 {
        light.notes.push("its transparency is left out".into());
    }
    Ok(Photo {
        space: light.space,
        encoding: is_code.then_some(light.encoding),
        notes: light.notes,
        ..Photo::of_image(Format::Ktx2, Image { width, height, pixels })
    })
}

/// As a texture takes it.
pub(super) fn read_bitmap(bytes: &[u8], limits: &Limits) -> Result<(Bitmap, Vec<String>), ReadError> {
    let Decoded { texels, light, has_alpha } = read_texels(bytes, limits)?;
    let (response, space) = match texels.format().number {
        Number::Byte => light.of_codes(256),
        Number::Short => light.of_codes(65_536),
        Number::Half | Number::Single => Default::default(),
    };
    let space = space.or(light.space).filter(|space| *space != Space::Srgb.rgb());
    Ok((Bitmap { texels, response, space, has_alpha }, light.notes))
}

/// What was read.
struct Decoded {
    texels: Texels,
    light: Light,
    has_alpha: bool,
}

fn read_texels(bytes: &[u8], limits: &Limits) -> Result<Decoded, ReadError> {
    limits.check_bytes(bytes)?;
    let Start { layout, width, height, scheme } = Start::of(bytes, limits)?;
    let container = Container::of(bytes)?;
    let size = usize::try_from(layout.bytes(width.into(), height.into())).map_err(|_| no_memory())?;
    let data = unpacked(container.level, scheme, size)?;
    if data.len() < size {
        return Err(damaged("texels are missing"));
    }
    let (format, sources) = layout.texel(layout.sources(container.value("KTXswizzle")));
    let (width, height) = (width as usize, height as usize);
    let mut texels = Texels::new(width, height, format).ok_or_else(no_memory)?;
    // Rows run downwards, unless it says otherwise.
    let runs_up = container.value("KTXorientation").is_some_and(|o| o.get(1) == Some(&b'u'));
    layout.decode(&data, [width, height], |x, y, channels| {
        let number = |source: &Source| match source {
            Source::Channel(i) => channels[*i],
            Source::Zero => 0.0,
            Source::One => match layout.number {
                Number::Byte => 255.0,
                Number::Short => 65_535.0,
                Number::Half | Number::Single => 1.0,
            },
        };
        let mut numbers = [0.0; 4];
        numbers.iter_mut().zip(&sources).for_each(|(n, source)| *n = number(source));
        texels.put_numbers(x, if runs_up { height - 1 - y } else { y }, numbers);
    });
    let has_alpha = sources.len() % 2 == 0 && sources.last() != Some(&Source::One);
    Ok(Decoded { texels, light: light_of(&container, &layout), has_alpha })
}

impl Layout {
    /// Gives `each` the numbers of every texel, codes as whole numbers.
    fn decode(
        &self,
        data: &[u8],
        [width, height]: [usize; 2],
        mut each: impl FnMut(usize, usize, &[f32; 4]),
    ) {
        let size = self.number.bytes();
        let number = |bytes: &[u8]| match (self.number, bytes) {
            (Number::Byte, &[v]) => f32::from(v),
            (Number::Short, &[a, b]) => f32::from(u16::from_le_bytes([a, b])),
            (Number::Half, &[a, b]) => of_any_half(u16::from_le_bytes([a, b])),
            (Number::Single, &[a, b, c, d]) => tame(f32::from_le_bytes([a, b, c, d])),
            _ => 0.0,
        };
        let mut out = [0.0; 4];
        match self.packing {
            Packing::Plain | Packing::BlueFirst => {
                for (i, texel) in data.chunks_exact(self.channels * size).take(width * height).enumerate() {
                    out.iter_mut().zip(texel.chunks_exact(size)).for_each(|(o, v)| *o = number(v));
                    if self.packing == Packing::BlueFirst {
                        out.swap(0, 2);
                    }
                    each(i % width, i / width, &out);
                }
            }
            Packing::SharedExponent | Packing::Small => {
                for (i, texel) in data.as_chunks::<4>().0.iter().take(width * height).enumerate() {
                    let bits = u32::from_le_bytes(*texel);
                    let rgb = if self.packing == Packing::Small { small(bits) } else { shared(bits) };
                    out[..3].copy_from_slice(&rgb);
                    each(i % width, i / width, &out);
                }
            }
            Packing::Block(block) => {
                let across = width.div_ceil(4);
                for (i, bytes) in
                    data.chunks_exact(block.bytes()).take(across * height.div_ceil(4)).enumerate()
                {
                    let texels = block.decode(bytes);
                    let (x0, y0) = (4 * (i % across), 4 * (i / across));
                    for (k, numbers) in texels.iter().enumerate() {
                        let (x, y) = (x0 + k % 4, y0 + k / 4);
                        if x < width && y < height {
                            each(x, y, numbers);
                        }
                    }
                }
            }
        }
    }
}

impl Block {
    /// The sixteen texels of a block, row by row.
    fn decode(self, bytes: &[u8]) -> [[f32; 4]; 16] {
        let mut out = [[0.0; 4]; 16];
        let mut codes = [0_u8; 64];
        let channels = match self {
            Self::Bc6 { is_signed } => {
                let mut halves = [0_u16; 48];
                bcdec_rs::bc6h_half(bytes, &mut halves, 12, is_signed);
                for (texel, halves) in out.iter_mut().zip(halves.as_chunks::<3>().0) {
                    texel[..3].copy_from_slice(&halves.map(of_any_half));
                }
                return out;
            }
            Self::Bc4 => {
                bcdec_rs::bc4(bytes, &mut codes, 4, false);
                1
            }
            Self::Bc5 => {
                bcdec_rs::bc5(bytes, &mut codes, 8, false);
                2
            }
            Self::Bc1 { .. } | Self::Bc2 | Self::Bc3 | Self::Bc7 => {
                match self {
                    Self::Bc1 { .. } => bcdec_rs::bc1(bytes, &mut codes, 16),
                    Self::Bc2 => bcdec_rs::bc2(bytes, &mut codes, 16),
                    Self::Bc3 => bcdec_rs::bc3(bytes, &mut codes, 16),
                    _ => bcdec_rs::bc7(bytes, &mut codes, 16),
                }
                4
            }
        };
        for (texel, codes) in out.iter_mut().zip(codes.chunks_exact(channels)) {
            texel.iter_mut().zip(codes).for_each(|(t, c)| *t = f32::from(*c));
        }
        out
    }
}

/// How levels are packed, where they are.
const ZSTANDARD: u32 = 2;
const ZLIB: u32 = 3;

/// A flag of the colours.
const ALPHA_IS_MULTIPLIED: u8 = 1;

/// The bytes of a level, unpacked to at most `size` of them.
fn unpacked(data: &[u8], scheme: u32, size: usize) -> Result<Cow<'_, [u8]>, ReadError> {
    match scheme {
        0 => Ok(Cow::Borrowed(data)),
        ZSTANDARD => {
            let decoder = StreamingDecoder::new(data).map_err(|e| damaged(&e.to_string()))?;
            let mut out = Vec::new();
            out.try_reserve_exact(size).map_err(|_| no_memory())?;
            decoder.take(size as u64).read_to_end(&mut out).map_err(|e| damaged(&e.to_string()))?;
            Ok(Cow::Owned(out))
        }
        ZLIB => {
            let out = miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(data, size);
            Ok(Cow::Owned(out.map_err(|e| damaged(&e.to_string()))?))
        }
        other => Err(ReadError::file(format!(
            "it is a KTX2 texture packed by the scheme {other}, which is not supported"
        ))),
    }
}

/// How its codes become light.
fn light_of(container: &Container<'_>, layout: &Layout) -> Light {
    let mut notes = Vec::new();
    let [_, primaries, transfer, flags] = container.colours.unwrap_or_default();
    let transfer = TransferFunction::new(transfer);
    let is_srgb = layout.is_srgb || transfer == Some(TransferFunction::SRGB);
    if let Some(other) = transfer.filter(|t| ![TransferFunction::SRGB, TransferFunction::Linear].contains(t))
    {
        notes.push(format!(
            "its transfer function {other:?} is not honoured: its numbers are taken for light"
        ));
    }
    if flags & ALPHA_IS_MULTIPLIED != 0 {
        notes.push("its colours are multiplied by its alpha, which is not undone".into());
    }
    if container.layers > 1 {
        notes.push("it is an array of pictures: the first is taken".into());
    }
    let space: Option<RgbSpace> = match ColorPrimaries::new(primaries) {
        Some(ColorPrimaries::DISPLAYP3) => Some(Space::DisplayP3.rgb()),
        Some(ColorPrimaries::BT2020) => Some(Space::Rec2020.rgb()),
        Some(ColorPrimaries::ACES) => Some(Space::Aces.rgb()),
        Some(ColorPrimaries::ACESCC) => Some(Space::AcesCg.rgb()),
        None | Some(ColorPrimaries::BT709) => None,
        Some(other) => {
            notes.push(format!("its primaries {other:?} are not honoured: those of sRGB are taken"));
            None
        }
    };
    let bits = if layout.number == Number::Short { 16 } else { 8 };
    let (response, curve, told) = if is_srgb {
        (Response::Srgb, Curve::Srgb, "sRGB, as its file says")
    } else {
        (Response::Power(1.0), Curve::Gamma(1.0), "linear, as its file says")
    };
    Light {
        responses: vec![response],
        is_narrow: false,
        space,
        encoding: Encoding { bits, curve: Some(curve), told: told.to_owned() },
        notes,
    }
}

/// What is infinite is as much as half precision holds, what is no number 0.
fn of_any_half(half: u16) -> f32 {
    match (half & 0x7c00 == 0x7c00, half & 0x03ff) {
        (true, 0) => of_half(half & 0x8000 | 0x7bff),
        (true, _) => 0.0,
        _ => of_half(half),
    }
}

fn tame(v: f32) -> f32 {
    if v.is_finite() { v } else { of_half(to_half(v)) }
}

/// Three mantissas of nine bits and one exponent.
fn shared(bits: u32) -> [f32; 3] {
    // 2^(e - 15 - 9).
    let scale = f32::from_bits(((bits >> 27) + 127 - 24) << 23);
    [bits, bits >> 9, bits >> 18].map(|v| (v & 0x1ff) as f32 * scale)
}

/// Floats without a sign: five bits of exponent, and six, six and five of mantissa.
fn small(bits: u32) -> [f32; 3] {
    let half = |v: u32| of_any_half(v as u16);
    [half((bits & 0x7ff) << 4), half((bits >> 11 & 0x7ff) << 4), half((bits >> 22) << 5)]
}

fn damaged(problem: &str) -> ReadError {
    ReadError::file(format!("the KTX2 file is damaged: {problem}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of one level.
    fn file(format: Vk, [width, height]: [u32; 2], scheme: u32, transfer: u8, level: &[u8]) -> Vec<u8> {
        // The basic descriptor of a format with one channel: nothing but its colours is read.
        let mut block = vec![0, 0, 0, 0];
        block.extend(2_u16.to_le_bytes());
        block.extend(40_u16.to_le_bytes());
        block.extend([1, 1, transfer, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]);
        block.extend([0, 0, 7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 0, 0, 0]);
        let dfd = [&(block.len() as u32 + 4).to_le_bytes()[..], &block].concat();
        let start = 80 + 24 + dfd.len();
        let mut out = MAGIC.to_vec();
        for v in [format.value(), 1, width, height, 0, 0, 1, 1, scheme, 104, dfd.len() as u32, 0, 0] {
            out.extend(v.to_le_bytes());
        }
        for v in [0_u64, 0, start as u64, level.len() as u64, level.len() as u64] {
            out.extend(v.to_le_bytes());
        }
        out.extend(&dfd);
        out.extend(level);
        out
    }

    fn read(bytes: &[u8]) -> Result<Bitmap, String> {
        super::super::bitmap(bytes, &Limits::default()).map(|(b, _)| b).map_err(|e| e.to_string())
    }

    #[test]
    fn plain_texels_are_read_however_they_are_packed() {
        let rgba: Vec<u8> = (0..24).map(|i| i * 10).collect();
        let plain = read(&file(Vk::R8G8B8A8_SRGB, [3, 2], 0, 2, &rgba)).unwrap();
        assert_eq!(plain.texels.numbers(1, 1), [160.0, 170.0, 180.0, 190.0]);
        assert!(plain.has_alpha && matches!(plain.response, straal_scene::bitmap::Response::Table(_)));
        let blue = read(&file(Vk::B8G8R8A8_UNORM, [3, 2], 0, 1, &rgba)).unwrap();
        assert_eq!(blue.texels.numbers(1, 1), [180.0, 170.0, 160.0, 190.0]);
        assert_eq!(blue.response, straal_scene::bitmap::Response::Linear);
        let zlib = miniz_oxide::deflate::compress_to_vec_zlib(&rgba, 6);
        assert!(read(&file(Vk::R8G8B8A8_SRGB, [3, 2], 3, 2, &zlib)).unwrap() == plain);
        // A frame of Zstandard with a single block that isn't compressed (RFC 8878).
        let zstd = [&[0x28, 0xb5, 0x2f, 0xfd, 0x20, 24, 24 << 3 | 1, 0, 0][..], &rgba].concat();
        assert!(read(&file(Vk::R8G8B8A8_SRGB, [3, 2], 2, 2, &zstd)).unwrap() == plain);
        let grey = read(&file(Vk::R16_UNORM, [1, 1], 0, 1, &0x1234_u16.to_le_bytes())).unwrap();
        assert_eq!((grey.texels.format().channels, grey.texels.numbers(0, 0)[0]), (1, 4660.0));
        // 2 (1 + 1/4), 1 and 1/2 with one exponent; infinite, NaN and -1 in halves.
        let e5: u32 = 17 << 27 | 64 << 18 | 128 << 9 | 320;
        let shared = read(&file(Vk::E5B9G9R9_UFLOAT_PACK32, [1, 1], 0, 1, &e5.to_le_bytes())).unwrap();
        assert_eq!(shared.texels.numbers(0, 0), [2.5, 1.0, 0.5, 1.0]);
        let small: u32 = 0x3c0 | 0x400 << 11 | 0x1c0 << 22;
        let small = read(&file(Vk::B10G11R11_UFLOAT_PACK32, [1, 1], 0, 1, &small.to_le_bytes())).unwrap();
        assert_eq!(small.texels.numbers(0, 0), [1.0, 2.0, 0.5, 1.0]);
        let odd: Vec<u8> =
            [0x7c00_u16, 0x7e00, 0xbc00, 0x3c00].iter().flat_map(|h| h.to_le_bytes()).collect();
        let odd = read(&file(Vk::R16G16B16A16_SFLOAT, [1, 1], 0, 1, &odd)).unwrap();
        assert_eq!(odd.texels.numbers(0, 0), [65_504.0, 0.0, -1.0, 1.0]);
    }

    #[test]
    fn blocks_are_decoded_and_cut_at_the_edges() {
        // BC1: red and blue, then what lies between them; texel i has code i % 4.
        let bc1 = [0x00, 0xf8, 0x1f, 0x00, 0b1110_0100, 0b1110_0100, 0b1110_0100, 0b1110_0100];
        let found = read(&file(Vk::BC1_RGB_SRGB_BLOCK, [3, 2], 0, 2, &bc1)).unwrap();
        let at = |x| found.texels.numbers(x, 1);
        assert_eq!([at(0), at(1)], [[255.0, 0.0, 0.0, 255.0], [0.0, 0.0, 255.0, 255.0]]);
        assert!((at(2)[0] - 170.0).abs() <= 1.0 && (at(2)[2] - 85.0).abs() <= 1.0, "{:?}", at(2));
        // BC4: from 200 to 50; all texels have code 0, but the second code 1.
        let bc4 = [200, 50, 0b1000, 0, 0, 0, 0, 0];
        let found = read(&file(Vk::BC4_UNORM_BLOCK, [4, 4], 0, 1, &bc4)).unwrap();
        assert_eq!([0, 1, 2].map(|x| found.texels.numbers(x, 0)[0]), [200.0, 50.0, 200.0]);
        assert_eq!(found.texels.format().channels, 1);
    }

    #[test]
    fn what_is_not_read_is_said() {
        let level = [0_u8; 64];
        let says = |bytes: &[u8]| read(bytes).unwrap_err();
        let astc = file(Vk::ASTC_4x4_UNORM_BLOCK, [4, 4], 0, 1, &level);
        assert!(
            says(&astc).contains("ASTC_4x4_UNORM_BLOCK (157), which is not supported"),
            "{}",
            says(&astc)
        );
        let mut basis = file(Vk::R8_UNORM, [4, 4], 0, 1, &level);
        basis[12..16].copy_from_slice(&0_u32.to_le_bytes());
        assert!(says(&basis).contains("Basis Universal"));
        let mut cube = file(Vk::R8_UNORM, [4, 4], 0, 1, &level);
        cube[36] = 6;
        assert!(says(&cube).contains("a cube of six pictures"));
        assert!(says(&file(Vk::R8_UNORM, [9, 9], 0, 1, &level)).contains("texels are missing"));
        assert!(says(&file(Vk::R8_UNORM, [1 << 20, 1 << 20], 0, 1, &level)).contains("too large"));
        assert!(says(&file(Vk::R8_UNORM, [8, 8], 2, 1, &level)).contains("damaged"));
        // Cut anywhere, or with any byte changed, it is an error or a picture.
        let whole = file(Vk::R8G8B8A8_SRGB, [4, 4], 0, 2, &level);
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length}");
        }
        for i in 0..whole.len() - 64 {
            for v in [0, 1, 0x7f, 0xff] {
                let mut odd = whole.clone();
                odd[i] = v;
                let _ = read(&odd);
            }
        }
    }
}
