//! The small values that descriptions are made of.

use std::fmt;

use straal_math::{Affine, DVec3};

use crate::handle::Handle;
pub use crate::link::{Known, Link, Named};
use crate::span::Spanned;

/// A name said in the scene; equal to another when the text is.
pub type Name = Spanned<String>;

/// A file as the scene names it: absolute, or relative to the scene's folder.
pub type FileRef = Spanned<String>;

/// A mesh or picture that a description has a handle to, and what it calls it: a file, or what a program made up.
pub struct Asset<T> {
    /// As the scene names it.
    pub file: FileRef,
    /// Which it is.
    pub handle: Handle<T>,
}

impl<T> Asset<T> {
    /// What goes by that handle, called so.
    pub fn new(file: impl Into<FileRef>, handle: Handle<T>) -> Self {
        Self { file: file.into(), handle }
    }
}

impl<T> Clone for Asset<T> {
    fn clone(&self) -> Self {
        Self { file: self.file.clone(), handle: self.handle }
    }
}

impl<T> PartialEq for Asset<T> {
    fn eq(&self, o: &Self) -> bool {
        self.file == o.file && self.handle == o.handle
    }
}

impl<T> fmt::Debug for Asset<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {:?}", self.handle, self.file.value)
    }
}

/// A colour in linear RGB (Rec. 709 primaries, D65 white). What these primaries don't hold has components below 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearRgb(pub [f64; 3]);

impl LinearRgb {
    /// The same number in all three channels.
    pub const fn grey(v: f64) -> Self {
        Self([v; 3])
    }

    /// From `#rrggbb` or `#rgb` in sRGB; `None` when it isn't that.
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#')?.as_bytes();
        let digit = |i: usize| char::from(digits[i]).to_digit(16);
        let channel = |i: usize| match digits.len() {
            3 => digit(i).map(|v| 17 * v),
            6 => Some(16 * digit(2 * i)? + digit(2 * i + 1)?),
            _ => None,
        };
        Some(Self([linear(channel(0)?), linear(channel(1)?), linear(channel(2)?)]))
    }
}

/// An 8-bit sRGB code as linear light (IEC 61966-2-1).
fn linear(code: u32) -> f64 {
    let c = f64::from(code) / 255.0;
    if c <= 0.04045 {
        return c / 12.92;
    }
    // b^2.4 = b^2 y with y = b^(2/5), the root of y^5 = b^2: Newton's method from above is monotonic, and uses no
    // function that differs between machines.
    let b = (c + 0.055) / 1.055;
    let mut y = 1.0;
    for _ in 0..40 {
        let y4 = y * y * y * y;
        y -= (y4 * y - b * b) / (5.0 * y4);
    }
    b * b * y
}

/// A direction that may be written `x`, `y` or `z`; not zero, not necessarily of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis(pub DVec3);

/// Factors for each axis, which may be written as one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors(pub DVec3);

/// An affine map written as rows of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix(pub Affine);

/// How many edges a path may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depth {
    /// As many as it likes.
    #[default]
    Unlimited,
    /// At most so many, the camera's edge included: 1 sees emitters, 2 is direct light.
    Edges(u32),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_is_srgb() {
        // Reference values of the sRGB transfer function to 7 digits.
        let LinearRgb([r, g, b]) = LinearRgb::from_hex("#ff8000").unwrap();
        assert_eq!((r, b), (1.0, 0.0));
        assert!((g - 0.2158605).abs() < 1e-7);
        assert!((LinearRgb::from_hex("#0b0b0b").unwrap().0[0] - 0.0033465).abs() < 1e-7);
        assert_eq!(LinearRgb::from_hex("#f80"), LinearRgb::from_hex("#ff8800"));
        for wrong in ["", "#", "ff8000", "#ff80", "#gg8000", "#ff80000", "#+f+f+f", "#é00"] {
            assert_eq!(LinearRgb::from_hex(wrong), None, "{wrong}");
        }
    }
}
