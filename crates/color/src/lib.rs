//! Light as four lanes, measured spectra, RGB spaces, tone curves, gamma, and a colour map for numbers.
#![forbid(unsafe_code)]

pub mod heat;
pub mod light;
pub mod oklab;
pub mod spectrum;
pub mod srgb;
pub mod tone;

pub use light::Light;
pub use tone::Tone;

/// Luminance of linear RGB with Rec. 709 primaries and D65 white.
pub fn luminance(rgb: [f32; 3]) -> f32 {
    0.212_639 * rgb[0] + 0.715_168_7 * rgb[1] + 0.072_192_3 * rgb[2]
}
