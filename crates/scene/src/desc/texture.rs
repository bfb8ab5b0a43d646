//! Textures, and the values that may be read off them.

use crate::Bitmap;
use crate::desc::spectrum::Spectrum;
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::Asset;

describe! {
    /// What differs from point to point of a surface.
    pub enum Texture {
        /// Squares of two colours in turn, over the texture coordinates.
        "checker" => Checker(struct Checker {
            /// The colour of the square next to the origin, and of every other.
            first: Spectrum [Limit::NON_NEGATIVE] = Spectrum::grey(0.2),
            /// The colour of the rest.
            second: Spectrum [Limit::NON_NEGATIVE] = Spectrum::grey(0.8),
            /// How many squares there are from 0 to 1, across and up.
            squares: [f64; 2] [Limit::within(1e-6, 1e6)] = [8.0, 8.0],
        }),
        /// A picture.
        "image" => Image(struct ImageTexture {
            /// The picture: PNG, JPEG, WebP, TGA, BMP, EXR, HDR or PFM.
            file: Asset<Bitmap>,
            /// What its numbers mean.
            color_space: TextureSpace = TextureSpace::Auto,
            /// Which of its numbers is taken where one is wanted, such as a roughness.
            channel: TextureChannel = TextureChannel::Luminance,
            /// How it is read between its pixels, and where many of them are seen as one.
            filter: TextureFilter = TextureFilter::Ewa,
            /// The most that a pixel's view of it may be longer than wide before `ewa` blurs it.
            anisotropy: f64 [Limit::within(1.0, 64.0)] = 16.0,
            /// What is beyond its edges: one of these, or a list of two, for left and right and for below and above.
            wrap: Wraps = Wraps([Wrap::Repeat, Wrap::Repeat]),
        }),
    }
}

describe! {
    /// What the numbers of a picture mean. Pictures of floating point (EXR, HDR, PFM) hold light, and only the primaries are asked.
    pub enum TextureSpace {
        /// Where a colour is wanted, what the file says, and sRGB where it says nothing; where a number is wanted, as `raw`.
        "auto" => Auto,
        /// The primaries and the curve of sRGB.
        "srgb" => Srgb,
        /// Light with the primaries of sRGB.
        "linear" => Linear,
        /// No colours but numbers, taken as they stand, 0 to 1.
        "raw" => Raw,
        /// Display P3, with the curve of sRGB.
        "display_p3" => DisplayP3,
        /// Adobe RGB (1998): its primaries and a gamma of 563/256.
        "adobe_rgb" => AdobeRgb,
        /// Light with the primaries of Rec. 2020.
        "rec2020" => Rec2020,
        /// ACEScg: light.
        "acescg" => AcesCg,
        /// ACES2065-1: light.
        "aces" => Aces,
    }
}

describe! {
    /// One number of a texture's four.
    pub enum TextureChannel {
        /// How bright its colour is.
        "luminance" => Luminance,
        /// Red.
        "red" => Red,
        /// Green.
        "green" => Green,
        /// Blue.
        "blue" => Blue,
        /// How much of it is there; 1 where the picture doesn't say.
        "alpha" => Alpha,
    }
}

describe! {
    /// How a picture is read between its pixels, and where many of them are seen as one.
    pub enum TextureFilter {
        /// The pixel that the point lies in, however many are seen.
        "nearest" => Nearest,
        /// Between the four pixels around, however many are seen.
        "bilinear" => Bilinear,
        /// Between the four pixels around, of two smaller copies of the picture: as much as is seen, though as wide as long.
        "trilinear" => Trilinear,
        /// A Gaussian as long and wide as what is seen (elliptical weighted average).
        "ewa" => Ewa,
    }
}

describe! {
    /// What is beyond the edges of a picture.
    pub enum Wrap {
        /// The picture again.
        "repeat" => Repeat,
        /// The picture in a mirror.
        "mirror" => Mirror,
        /// The pixels of its edge.
        "clamp" => Clamp,
        /// Nothing: 0.
        "black" => Black,
    }
}

/// What is beyond the edges of a picture: at the left and right, and below and above.
#[derive(Clone, Debug, PartialEq)]
pub struct Wraps(pub [Wrap; 2]);

/// A number or colour of a surface, which may differ from point to point.
#[derive(Clone, Debug, PartialEq)]
pub enum Varying<T> {
    /// The same everywhere.
    Constant(T),
    /// Read off a texture.
    Texture(Box<Texture>),
}

impl<T> From<T> for Varying<T> {
    fn from(v: T) -> Self {
        Self::Constant(v)
    }
}

impl<T> Varying<T> {
    /// The value, if it is the same everywhere.
    pub const fn constant(&self) -> Option<&T> {
        match self {
            Self::Constant(v) => Some(v),
            Self::Texture(_) => None,
        }
    }
}
