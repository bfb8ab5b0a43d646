//! A picture and its smaller copies, each half as wide and high as the one before.
//!
//! A texel of a smaller copy is the mean of the light of what it covers, by area where sizes are odd (as in Guthe and Heckbert 2005,
//! "Non-power-of-two mipmap creation"), so that no light gets lost and none rings, and it is rounded once: means are taken of means
//! in single precision, not of codes. All copies together take a third of the picture.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;
use straal_color::RgbSpace;
use straal_color::{Adaptation, Matrix3, Space, Transfer};
use straal_math::ops;
use straal_scene::bitmap::{Bitmap, Number, Response, TexelFormat, Texels, of_half, to_half};
use straal_scene::desc::TextureSpace;

/// A picture, its smaller copies, and how they are read as light.
#[derive(Clone)]
pub struct Pyramid {
    base: Arc<Bitmap>,
    /// Each half the size of the one before, down to one texel; none where only the picture itself is read.
    smaller: Vec<Texels>,
    /// The light of a code, for red, green and blue; none where codes are light.
    tables: Option<[Arc<[f32]>; 3]>,
    /// From the picture's red, green and blue to linear sRGB, where these are others.
    to_srgb: Option<[[f32; 3]; 3]>,
    /// The largest number of its texels.
    most: f32,
}

/// What a picture's numbers are taken for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Meaning {
    /// How codes become light; as the file says where absent.
    response: Option<Transfer>,
    /// The primaries; as the file says where absent.
    space: Option<RgbSpace>,
}

impl Meaning {
    /// Of what a scene says, for a colour or for a number.
    pub fn of(said: &TextureSpace, is_number: bool) -> Self {
        // IEC 61966-2-5 and Adobe RGB (1998) Color Image Encoding.
        let adobe = || {
            let mut space = Space::Srgb.rgb();
            space.primaries[1] = straal_color::Chromaticity { x: 0.21, y: 0.71 };
            space
        };
        let of = |response, space| Self { response: Some(response), space: Some(space) };
        match said {
            TextureSpace::Auto if is_number => of(Transfer::Linear, Space::Srgb.rgb()),
            TextureSpace::Auto => Self { response: None, space: None },
            TextureSpace::Srgb => of(Transfer::Srgb, Space::Srgb.rgb()),
            TextureSpace::Linear | TextureSpace::Raw => of(Transfer::Linear, Space::Srgb.rgb()),
            TextureSpace::DisplayP3 => of(Transfer::Srgb, Space::DisplayP3.rgb()),
            TextureSpace::AdobeRgb => of(Transfer::Gamma(563.0 / 256.0), adobe()),
            TextureSpace::Rec2020 => of(Transfer::Linear, Space::Rec2020.rgb()),
            TextureSpace::AcesCg => of(Transfer::Linear, Space::AcesCg.rgb()),
            TextureSpace::Aces => of(Transfer::Linear, Space::Aces.rgb()),
        }
    }

    /// Tables of the light of codes.
    fn tables(&self, bitmap: &Bitmap) -> Option<[Arc<[f32]>; 3]> {
        let codes = match bitmap.texels.format().number {
            Number::Byte => 256,
            Number::Short => 65_536,
            Number::Half | Number::Single => return None,
        };
        match (self.response, &bitmap.response) {
            (Some(Transfer::Linear), _) | (None, Response::Linear) => None,
            (None, Response::Table(tables)) => {
                tables.iter().all(|table| table.len() == codes).then(|| tables.clone())
            }
            (Some(transfer), _) => {
                let most = (codes - 1) as f32;
                let table: Arc<[f32]> = (0..codes).map(|code| transfer.decode(code as f32 / most)).collect();
                Some([table.clone(), table.clone(), table])
            }
        }
    }

    fn to_srgb(&self, bitmap: &Bitmap) -> Option<[[f32; 3]; 3]> {
        Self::matrix(self.space.or(bitmap.space)?)
    }

    /// From the primaries of a space to those of sRGB; none from these.
    pub fn matrix(space: RgbSpace) -> Option<[[f32; 3]; 3]> {
        let srgb = Space::Srgb.rgb();
        let Matrix3(rows) = Some(space).filter(|space| *space != srgb)?.to(&srgb, Adaptation::Bradford);
        Some(rows.map(|row| row.map(|v| v as f32)))
    }
}

impl fmt::Debug for Pyramid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Pyramid of {} levels over {:?}", self.levels(), self.base)
    }
}

/// A grey texel, and one without alpha, are fully there.
const FULL: f32 = 1.0;

impl Pyramid {
    /// Of a picture whose colours are in a space, with its smaller copies.
    pub fn of(base: Arc<Bitmap>, space: &TextureSpace) -> Self {
        Self::new(base, &Meaning::of(space, false), true)
    }

    /// Of a picture. Without smaller copies nothing but the picture itself can be read.
    pub(crate) fn new(base: Arc<Bitmap>, meaning: &Meaning, has_smaller: bool) -> Self {
        let mut pyramid = Self {
            tables: meaning.tables(&base),
            to_srgb: meaning.to_srgb(&base),
            smaller: Vec::new(),
            most: 0.0,
            base,
        };
        pyramid.most = pyramid.brightest();
        if has_smaller {
            let mut light = pyramid.halved();
            while let Some(level) = pyramid.rounded(&light) {
                pyramid.smaller.push(level);
                light = light.halved();
            }
        }
        pyramid
    }

    /// Bytes that smaller copies of a picture take, and making them besides.
    pub fn bytes_of(texels: &Texels) -> [u64; 2] {
        let (mut w, mut h) = (texels.width(), texels.height());
        let mut kept = 0_u64;
        let making = (w / 2).max(1) * (h / 2).max(1) * texels.format().channels * 4;
        while w > 1 || h > 1 {
            (w, h) = ((w / 2).max(1), (h / 2).max(1));
            kept += Texels::bytes_of(w as u64, h as u64, texels.format());
        }
        // Of the next level as well.
        [kept, (making + making / 4) as u64]
    }

    /// How many levels there are; the picture itself is the first.
    #[inline(always)]
    pub fn levels(&self) -> usize {
        1 + self.smaller.len()
    }

    /// A level; the last where there are fewer.
    #[inline(always)]
    pub fn level(&self, level: usize) -> &Texels {
        match level.checked_sub(1) {
            None => &self.base.texels,
            Some(i) => self.smaller.get(i).or(self.smaller.last()).unwrap_or(&self.base.texels),
        }
    }

    /// Width and height of the picture.
    #[inline(always)]
    pub fn size(&self) -> [f32; 2] {
        [self.base.texels.width() as f32, self.base.texels.height() as f32]
    }

    /// What all texels are.
    #[inline(always)]
    pub fn format(&self) -> TexelFormat {
        self.base.texels.format()
    }

    /// The largest number, red, green and blue of linear sRGB.
    pub fn most(&self) -> f32 {
        match &self.to_srgb {
            None => self.most,
            Some(rows) => rows
                .iter()
                .map(|row| row.iter().filter(|v| **v > 0.0).sum::<f32>() * self.most)
                .fold(0.0, ops::max),
        }
    }

    /// Numbers of the picture as linear sRGB and alpha.
    #[inline(always)]
    pub fn to_srgb(&self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        let (r, g, b) = if self.base.texels.format().channels < 3 { (r, r, r) } else { (r, g, b) };
        match &self.to_srgb {
            None => [r, g, b, a],
            Some(m) => {
                let [x, y, z] = m.map(|row| row[0] * r + row[1] * g + row[2] * b);
                [x, y, z, a]
            }
        }
    }

    /// A texel as light: red, green, blue and alpha, or grey in the first place. `NUMBER` and `CHANNELS` are those of
    /// [`Self::format`], so that the compiler knows them.
    #[inline(always)]
    pub fn texel<const NUMBER: u8, const CHANNELS: usize>(
        &self,
        level: &Texels,
        x: usize,
        y: usize,
    ) -> [f32; 4] {
        let code = |channel: usize, code: usize, most: f32| match &self.tables {
            Some(tables) => tables[channel].get(code).copied().unwrap_or(0.0),
            None => code as f32 / most,
        };
        let byte = |channel, v: u8| code(channel, usize::from(v), 255.0);
        let short = |channel, a, b| code(channel, usize::from(u16::from_ne_bytes([a, b])), 65_535.0);
        let part = |a: u8, b: u8| f32::from(u16::from_ne_bytes([a, b])) / 65_535.0;
        let half = |a: u8, b: u8| of_half(u16::from_ne_bytes([a, b]));
        match (NUMBER, CHANNELS) {
            (BYTE, 1) => {
                let [v] = level.bytes(x, y);
                [byte(0, v), 0.0, 0.0, FULL]
            }
            (BYTE, 2) => {
                let [v, a] = level.bytes(x, y);
                [byte(0, v), 0.0, 0.0, f32::from(a) / 255.0]
            }
            (BYTE, _) => {
                let [r, g, b, a] = level.bytes(x, y);
                [byte(0, r), byte(1, g), byte(2, b), f32::from(a) / 255.0]
            }
            (SHORT, 1) => {
                let [a, b] = level.bytes(x, y);
                [short(0, a, b), 0.0, 0.0, FULL]
            }
            (SHORT, 2) => {
                let [a, b, c, d] = level.bytes(x, y);
                [short(0, a, b), 0.0, 0.0, part(c, d)]
            }
            (SHORT, _) => {
                let [a, b, c, d, e, f, g, h] = level.bytes(x, y);
                [short(0, a, b), short(1, c, d), short(2, e, f), part(g, h)]
            }
            (HALF, 1) => {
                let [a, b] = level.bytes(x, y);
                [half(a, b), 0.0, 0.0, FULL]
            }
            (HALF, 2) => {
                let [a, b, c, d] = level.bytes(x, y);
                [half(a, b), 0.0, 0.0, half(c, d)]
            }
            (HALF, _) => {
                let [a, b, c, d, e, f, g, h] = level.bytes(x, y);
                [half(a, b), half(c, d), half(e, f), half(g, h)]
            }
            (_, 1) => [f32::from_ne_bytes(level.bytes(x, y)), 0.0, 0.0, FULL],
            (_, 2) => {
                let [a, b, c, d, e, f, g, h] = level.bytes(x, y);
                [f32::from_ne_bytes([a, b, c, d]), 0.0, 0.0, f32::from_ne_bytes([e, f, g, h])]
            }
            _ => {
                let bytes: [u8; 16] = level.bytes(x, y);
                let (four, _) = bytes.as_chunks::<4>();
                [0, 1, 2, 3].map(|i| f32::from_ne_bytes(four[i]))
            }
        }
    }

    /// As [`Self::texel`], whatever the format.
    fn any_texel(&self, x: usize, y: usize) -> [f32; 4] {
        struct At<'a>(&'a Pyramid, usize, usize);
        impl Formatted for At<'_> {
            type Output = [f32; 4];
            #[inline(always)]
            fn run<const NUMBER: u8, const CHANNELS: usize>(self) -> [f32; 4] {
                self.0.texel::<NUMBER, CHANNELS>(self.0.level(0), self.1, self.2)
            }
        }
        by_format(self.format(), At(self, x, y))
    }

    /// The picture's light at half its size.
    fn halved(&self) -> Plane {
        let (texels, channels) = (&self.base.texels, self.format().channels);
        Plane::of_means([texels.width(), texels.height()], channels, |x, y| {
            let [r, g, b, a] = self.any_texel(x, y);
            if channels == 2 { [r, a, 0.0, 0.0] } else { [r, g, b, a] }
        })
    }

    /// The largest number of its colours.
    fn brightest(&self) -> f32 {
        let texels = &self.base.texels;
        let colours = if self.format().channels < 3 { 1 } else { 3 };
        let of_row = |y: usize| {
            let row = (0..texels.width()).flat_map(|x| self.any_texel(x, y).into_iter().take(colours));
            row.fold(0.0, ops::max)
        };
        // The largest is the same in any order.
        (0..texels.height()).into_par_iter().map(of_row).reduce(|| 0.0, ops::max)
    }

    /// A level of the pyramid; `None` where the last is one texel already.
    fn rounded(&self, plane: &Plane) -> Option<Texels> {
        let last = self.level(self.levels() - 1);
        if last.width() == 1 && last.height() == 1 {
            return None;
        }
        let format = self.format();
        let mut texels = Texels::new(plane.width, plane.height, format)?;
        for (i, light) in plane.light.chunks_exact(format.channels).enumerate() {
            let mut numbers = [0.0; 4];
            for (channel, (number, light)) in numbers.iter_mut().zip(light).enumerate() {
                *number = self.number(channel, *light);
            }
            texels.put_numbers(i % plane.width, i / plane.width, numbers);
        }
        Some(texels)
    }

    /// The code that is nearest in light, or the light itself.
    fn number(&self, channel: usize, light: f32) -> f32 {
        let TexelFormat { number, channels } = self.format();
        let most = match number {
            Number::Byte => 255.0,
            Number::Short => 65_535.0,
            Number::Half => return of_half(to_half(light)),
            Number::Single => return light,
        };
        let is_alpha = channel == 3 || (channels == 2 && channel == 1);
        match &self.tables {
            Some(tables) if !is_alpha => {
                let table = &tables[channel];
                let above = table.partition_point(|v| *v < light).min(table.len() - 1);
                let below = above.saturating_sub(1);
                let is_below = light - table[below] < table[above] - light;
                (if is_below { below } else { above }) as f32
            }
            _ => ops::clamp(light * most + 0.5, 0.0, most).floor(),
        }
    }
}

/// [`Number`]s as the compiler may take them.
pub(super) const BYTE: u8 = 0;
pub(super) const SHORT: u8 = 1;
pub(super) const HALF: u8 = 2;
pub(super) const SINGLE: u8 = 3;

/// What is compiled for each format of texels.
pub(super) trait Formatted {
    type Output;
    fn run<const NUMBER: u8, const CHANNELS: usize>(self) -> Self::Output;
}

/// Runs what is compiled for a format.
#[inline(always)]
pub(super) fn by_format<F: Formatted>(format: TexelFormat, f: F) -> F::Output {
    match (format.number, format.channels) {
        (Number::Byte, 1) => f.run::<BYTE, 1>(),
        (Number::Byte, 2) => f.run::<BYTE, 2>(),
        (Number::Byte, _) => f.run::<BYTE, 4>(),
        (Number::Short, 1) => f.run::<SHORT, 1>(),
        (Number::Short, 2) => f.run::<SHORT, 2>(),
        (Number::Short, _) => f.run::<SHORT, 4>(),
        (Number::Half, 1) => f.run::<HALF, 1>(),
        (Number::Half, 2) => f.run::<HALF, 2>(),
        (Number::Half, _) => f.run::<HALF, 4>(),
        (Number::Single, 1) => f.run::<SINGLE, 1>(),
        (Number::Single, 2) => f.run::<SINGLE, 2>(),
        (Number::Single, _) => f.run::<SINGLE, 4>(),
    }
}

/// A level's light in single precision.
struct Plane {
    width: usize,
    height: usize,
    channels: usize,
    /// `channels` numbers of each texel, row by row.
    light: Vec<f32>,
}

impl Plane {
    /// At half the size of what has so many columns and rows and this light: the means over areas.
    fn of_means(
        [width, height]: [usize; 2],
        channels: usize,
        light: impl Fn(usize, usize) -> [f32; 4] + Sync,
    ) -> Self {
        let (across, down) = (Shares::of_half(width), Shares::of_half(height));
        let mut out = vec![0.0; across.len() * down.len() * channels];
        out.par_chunks_exact_mut(across.len() * channels).zip(&down).for_each(|(row, down)| {
            for (texel, across) in row.chunks_exact_mut(channels).zip(&across) {
                let mut sum = [0.0; 4];
                for (y, share) in down.parts() {
                    for (x, part) in across.parts() {
                        let light = light(x, y);
                        (0..4).for_each(|c| sum[c] += light[c] * (share * part));
                    }
                }
                texel.copy_from_slice(&sum[..channels]);
            }
        });
        Self { width: across.len(), height: down.len(), channels, light: out }
    }

    fn halved(&self) -> Self {
        let Self { width, height, channels, ref light } = *self;
        Self::of_means([width, height], channels, |x, y| {
            let texel = &light[(y * width + x) * channels..][..channels];
            std::array::from_fn(|c| texel.get(c).copied().unwrap_or(0.0))
        })
    }
}

/// Which texels in a row one of half the number covers, and which part of it each is.
struct Shares {
    first: usize,
    shares: [f32; 3],
}

impl Shares {
    fn of_half(count: usize) -> Vec<Self> {
        let half = (count / 2).max(1);
        // In steps of a `half`th of a texel: each of the half covers `count` of them.
        let one = |i: usize| {
            let (start, end) = (i * count, (i + 1) * count);
            let first = start / half;
            let shares = [0, 1, 2].map(|k| {
                let (from, to) = (((first + k) * half).max(start), ((first + k + 1) * half).min(end));
                to.saturating_sub(from) as f32 / count as f32
            });
            Self { first, shares }
        };
        (0..half).map(one).collect()
    }

    fn parts(&self) -> impl Iterator<Item = (usize, f32)> {
        self.shares
            .iter()
            .enumerate()
            .filter(|(_, share)| **share > 0.0)
            .map(|(k, share)| (self.first + k, *share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of codes.
    pub fn picture(
        width: usize,
        height: usize,
        number: Number,
        channels: usize,
        code: impl Fn(usize, usize, usize) -> f32,
    ) -> Arc<Bitmap> {
        let mut texels = Texels::new(width, height, TexelFormat { number, channels }).unwrap();
        for i in 0..width * height {
            let (x, y) = (i % width, i / width);
            texels.put_numbers(x, y, std::array::from_fn(|c| code(x, y, c)));
        }
        Arc::new(Bitmap { texels, response: Response::Linear, space: None, has_alpha: channels % 2 == 0 })
    }

    /// A number from 0 to 1 that looks random.
    fn noise(x: usize, y: usize, c: usize) -> f32 {
        let mut h =
            (x as u32).wrapping_mul(0x9e37_79b9) ^ (y as u32).wrapping_mul(0x85eb_ca6b) ^ (c as u32) << 13;
        h = (h ^ h >> 15).wrapping_mul(0x2c1b_3c6d);
        (h >> 8) as f32 / (1 << 24) as f32
    }

    #[test]
    fn all_levels_have_the_same_mean() {
        for (w, h) in [(16, 16), (17, 5), (1, 9), (31, 64), (3, 1)] {
            for number in [Number::Byte, Number::Short, Number::Half, Number::Single] {
                let scale = match number {
                    Number::Byte => 255.0,
                    Number::Short => 65_535.0,
                    Number::Half | Number::Single => 3.0,
                };
                let base = picture(w, h, number, 4, |x, y, c| noise(x, y, c) * scale);
                for space in [TextureSpace::Linear, TextureSpace::Srgb] {
                    let pyramid = Pyramid::new(base.clone(), &Meaning::of(&space, false), true);
                    let mean = |level: &Texels| {
                        let (w, h) = (level.width(), level.height());
                        let mut sum = [0.0_f64; 4];
                        for i in 0..w * h {
                            let numbers = level.numbers(i % w, i / w);
                            for c in 0..4 {
                                let code = numbers[c] as usize;
                                let table = pyramid.tables.as_ref().filter(|_| c < 3);
                                let v = table.map_or(numbers[c], |t| t[c][code] * scale);
                                sum[c] += f64::from(v) / (w * h) as f64;
                            }
                        }
                        sum
                    };
                    let whole = mean(pyramid.level(0));
                    let top = pyramid.level(pyramid.levels() - 1);
                    assert_eq!((top.width(), top.height()), (1, 1));
                    // Codes are rounded once: half a step, of which those of sRGB are at most 2.3 times as large.
                    let step = if number == Number::Byte { 2.3 * 0.5 } else { 0.002 * f64::from(scale) };
                    for (got, want) in mean(top).into_iter().zip(whole) {
                        assert!(
                            (got - want).abs() <= step,
                            "{w} x {h} {number:?} {space:?}: {got}, not {want}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn all_levels_take_a_third_of_the_picture() {
        let base = picture(256, 256, Number::Byte, 4, |_, _, _| 7.0);
        let pyramid = Pyramid::new(base.clone(), &Meaning::of(&TextureSpace::Auto, false), true);
        let kept: u64 = pyramid.smaller.iter().map(Texels::heap_bytes).sum();
        assert_eq!(kept, Pyramid::bytes_of(&base.texels)[0]);
        assert!(kept as f64 <= base.texels.heap_bytes() as f64 * 0.334, "{kept}");
    }

    #[test]
    fn the_most_is_found_in_any_space() {
        let base = picture(9, 7, Number::Half, 4, |x, y, c| if (x, y, c) == (8, 6, 1) { 12.0 } else { 0.25 });
        let most = |space| Pyramid::new(base.clone(), &Meaning::of(&space, false), true).most();
        assert_eq!(most(TextureSpace::Linear), 12.0);
        // Green of Rec. 2020 is more than sRGB's.
        assert!(most(TextureSpace::Rec2020) >= 12.0 * 1.13, "{}", most(TextureSpace::Rec2020));
    }
}
