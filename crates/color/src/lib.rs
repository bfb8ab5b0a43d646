//! Light as four lanes, measured spectra, CIE XYZ and Lab, RGB spaces, tone curves, gamma, and a colour map for numbers.
#![forbid(unsafe_code)]

pub mod adaptation;
pub mod dither;
pub mod exposure;
pub mod gamut;
pub mod heat;
pub mod lab;
pub mod light;
pub mod matrix;
pub mod oklab;
pub mod parse;
pub mod space;
pub mod spectrum;
pub mod srgb;
pub mod tone;
pub mod transfer;
pub mod xyz;

pub use adaptation::Adaptation;
pub use dither::Dither;
pub use exposure::{Exposure, Meter};
pub use gamut::Gamut;
pub use lab::{Lab, Lch};
pub use light::Light;
pub use matrix::Matrix3;
pub use parse::ParseError;
pub use space::{RgbSpace, Space};
pub use tone::Tone;
pub use transfer::Transfer;
pub use xyz::{Chromaticity, White, XyY, Xyz};

/// Luminance of linear RGB with Rec. 709 primaries and D65 white.
pub fn luminance(rgb: [f32; 3]) -> f32 {
    0.212_639 * rgb[0] + 0.715_168_7 * rgb[1] + 0.072_192_3 * rgb[2]
}
