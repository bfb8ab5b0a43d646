//! How light becomes a picture for the screen: exposure, tone curve, gamut, gamma, whole numbers.

use std::fmt;
use std::str::FromStr;
use straal_color::{
    Adaptation, Dither, Exposure, Gamut, Matrix3, ParseError, RgbSpace, Space, Tone, Transfer,
};
use straal_formats::image::png;
use straal_scene::desc;

/// The steps from linear light to codes, in their order. The screen has the primaries of sRGB.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Development {
    /// What light is multiplied by.
    pub exposure: Exposure,
    /// What becomes of what is brighter than white.
    pub tone: Tone,
    /// What becomes of what the screen can't show after that.
    pub gamut: Gamut,
    /// How light becomes a signal.
    pub gamma: Gamma,
    /// How many codes a channel has.
    pub bits: Bits,
    /// How the signal is rounded to a code.
    pub dither: Dither,
}

/// How light becomes a signal for the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Gamma {
    /// The curve of sRGB.
    #[default]
    Srgb,
    /// The signal is this root of light, from 0.1 to 10.
    Power(f32),
}

/// How many codes a channel of a picture has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bits {
    /// 256.
    #[default]
    Eight,
    /// 65,536.
    Sixteen,
}

impl Bits {
    /// Their number.
    pub const fn number(self) -> u32 {
        match self {
            Self::Eight => 8,
            Self::Sixteen => 16,
        }
    }

    /// By their number.
    pub const fn of(number: u32) -> Option<Self> {
        match number {
            8 => Some(Self::Eight),
            16 => Some(Self::Sixteen),
            _ => None,
        }
    }
}

impl Gamma {
    /// Least and greatest power.
    pub const RANGE: [f32; 2] = [0.1, 10.0];

    fn transfer(self) -> Transfer {
        match self {
            Self::Srgb => Transfer::Srgb,
            Self::Power(gamma) => Transfer::Gamma(gamma),
        }
    }

    /// What a PNG says of it.
    pub(crate) fn curve(self) -> png::Curve {
        match self {
            Self::Srgb => png::Curve::Srgb,
            Self::Power(gamma) => png::Curve::Gamma(gamma),
        }
    }
}

impl fmt::Display for Gamma {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Srgb => f.write_str("srgb"),
            Self::Power(gamma) => write!(f, "{gamma}"),
        }
    }
}

impl FromStr for Gamma {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "srgb" {
            return Ok(Self::Srgb);
        }
        let [least, most] = Self::RANGE;
        let gamma = text.parse().ok().filter(|v: &f32| *v >= least && *v <= most);
        gamma.map(Self::Power).ok_or_else(|| format!("expected srgb or a number from {least} to {most}"))
    }
}

impl fmt::Display for Development {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { exposure, tone, gamut, gamma, bits, dither } = self;
        let dither = if *dither == Dither::On { "on" } else { "off" };
        let bits = bits.number();
        write!(f, "exposure={exposure} tone={tone} gamut={gamut} gamma={gamma} bits={bits} dither={dither}")
    }
}

impl FromStr for Development {
    type Err = String;

    /// Reads what development settings tell of themselves; steps that aren't named are the usual ones.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut development = Self::default();
        let told = |e: ParseError| e.to_string();
        for word in text.split_whitespace() {
            let (key, value) = word.split_once('=').ok_or_else(|| format!("`{word}` is no key=value"))?;
            match key {
                "exposure" => development.exposure = value.parse().map_err(told)?,
                "tone" => development.tone = value.parse().map_err(told)?,
                "gamut" => development.gamut = value.parse().map_err(told)?,
                "gamma" => development.gamma = value.parse()?,
                "bits" => {
                    let bits = value.parse().ok().and_then(Bits::of);
                    development.bits = bits.ok_or("bits are 8 or 16")?;
                }
                "dither" => {
                    development.dither = match value {
                        "on" => Dither::On,
                        "off" => Dither::Off,
                        _ => return Err("dither is on or off".into()),
                    }
                }
                _ => return Err(format!("`{key}` is no step of development")),
            }
        }
        Ok(development)
    }
}

impl Development {
    /// How a film wants its picture developed.
    pub fn of(film: &desc::Film) -> Self {
        Self {
            exposure: film.exposure,
            tone: film.tone.curve(),
            gamut: film.gamut.way(),
            gamma: match film.gamma {
                desc::Gamma::Srgb => Gamma::Srgb,
                desc::Gamma::Power(gamma) => Gamma::Power(gamma as f32),
            },
            bits: Bits::of(film.bits).unwrap_or_default(),
            dither: if film.dither { Dither::On } else { Dither::Off },
        }
    }
}

/// Linear light that waits to be developed: a picture or a crop of one.
#[derive(Clone, Copy, Debug)]
pub struct Undeveloped<'a> {
    /// Row by row from the top.
    pub pixels: &'a [[f32; 3]],
    /// Pixels of a row.
    pub width: usize,
    /// Where the first pixel lies in the whole picture, which dithering goes by: a crop is developed as it is in the
    /// whole.
    pub at: [u32; 2],
    /// The space of the light.
    pub space: RgbSpace,
}

/// Codes of a developed picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Codes {
    /// From 0 to 255.
    Eight(Vec<[u8; 3]>),
    /// From 0 to 65,535.
    Sixteen(Vec<[u16; 3]>),
}

impl Codes {
    /// As the PNG writer takes them.
    pub(crate) fn as_png(&self) -> png::Pixels<'_> {
        match self {
            Self::Eight(pixels) => png::Pixels::Eight(pixels),
            Self::Sixteen(pixels) => png::Pixels::Sixteen(pixels),
        }
    }
}

/// To the linear RGB of the screen; `None` where the light has it.
pub(crate) fn to_screen(space: &RgbSpace) -> Option<Matrix3> {
    let screen = Space::Srgb.rgb();
    (*space != screen).then(|| space.to(&screen, Adaptation::Bradford))
}

impl Undeveloped<'_> {
    /// Develops all pixels. Only the meter of an exposure looks at more than one of them.
    pub fn develop(&self, development: &Development) -> Codes {
        let factor = development.exposure.factor(self.pixels, self.space.luminance());
        let matrix = to_screen(&self.space);
        let transfer = development.gamma.transfer();
        let signal = |rgb: &[f32; 3]| {
            let exposed = rgb.map(|v| v * factor);
            let screen = matrix.map_or(exposed, |m| m.apply_f32(exposed));
            development.gamut.show(screen, development.tone).map(|v| transfer.encode(v))
        };
        let codes = |most: u32| {
            self.pixels.iter().enumerate().map(move |(i, rgb)| {
                let at = [
                    self.at[0].wrapping_add((i % self.width) as u32),
                    self.at[1].wrapping_add((i / self.width) as u32),
                ];
                let [r, g, b] = signal(rgb);
                [(r, 0), (g, 1), (b, 2)].map(|(v, channel)| development.dither.code(v, most, at, channel))
            })
        };
        match development.bits {
            Bits::Eight => Codes::Eight(codes(255).map(|rgb| rgb.map(|c| c as u8)).collect()),
            Bits::Sixteen => Codes::Sixteen(codes(65_535).map(|rgb| rgb.map(|c| c as u16)).collect()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_color::{Meter, srgb};

    fn undeveloped(pixels: &[[f32; 3]], space: Space) -> Undeveloped<'_> {
        Undeveloped { pixels, width: 4, at: [0, 0], space: space.rgb() }
    }

    #[test]
    fn what_a_look_tells_is_read_again() {
        for development in [
            Development::default(),
            Development {
                exposure: Exposure { meter: Meter::Average, stops: -0.5 },
                tone: Tone::Reinhard { white: 3.0 },
                gamut: Gamut::Flag([0.0, 0.5, 1.0]),
                gamma: Gamma::Power(2.2),
                bits: Bits::Sixteen,
                dither: Dither::On,
            },
        ] {
            assert_eq!(development.to_string().parse(), Ok(development));
        }
        for wrong in ["tone", "tone=x", "bits=9", "dither=maybe", "gamma=0", "gamma=nan", "colour=red"] {
            assert!(wrong.parse::<Development>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn without_a_curve_srgb_is_rounded() {
        let development = Development { tone: Tone::Clamp, ..Development::default() };
        let pixels: Vec<[f32; 3]> = (0..64_u8).map(|i| [f32::from(i) * 0.02, -0.3, f32::NAN]).collect();
        let Codes::Eight(codes) = undeveloped(&pixels, Space::Srgb).develop(&development) else { panic!() };
        for (rgb, code) in pixels.iter().zip(codes) {
            assert_eq!(code, [srgb::encode_u8(rgb[0]), 0, 0]);
        }
    }

    #[test]
    fn the_same_light_looks_the_same_from_every_space() {
        let light: Vec<[f32; 3]> =
            (0..64_u8).map(|i| [i % 4, i / 4 % 4, i / 16].map(|v| f32::from(v) * 0.45 + 0.01)).collect();
        let development = Development {
            tone: Tone::Agx,
            bits: Bits::Sixteen,
            gamut: Gamut::Desaturate,
            ..Development::default()
        };
        let Codes::Sixteen(want) = undeveloped(&light, Space::Srgb).develop(&development) else { panic!() };
        for space in Space::ALL {
            let there: Vec<_> = light.iter().map(|p| Space::Srgb.to(space).apply_f32(*p)).collect();
            let Codes::Sixteen(got) = undeveloped(&there, space).develop(&development) else { panic!() };
            for (a, b) in got.as_flattened().iter().zip(want.as_flattened()) {
                assert!(a.abs_diff(*b) <= 2, "{space:?}: {a} {b}");
            }
        }
    }

    #[test]
    fn dithering_goes_by_the_place_in_the_whole_picture() {
        let pixels = [[0.3; 3]; 16];
        let development = Development { dither: Dither::On, ..Development::default() };
        let whole = undeveloped(&pixels, Space::Srgb).develop(&development);
        let below =
            Undeveloped { at: [0, 2], ..undeveloped(&pixels[8..], Space::Srgb) }.develop(&development);
        let (Codes::Eight(whole), Codes::Eight(below)) = (whole, below) else { panic!() };
        assert_eq!(whole[8..], below);
    }
}
