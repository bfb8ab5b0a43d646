//! Textures, and the values that may be read off them.

use crate::desc::spectrum::Spectrum;
use crate::describe::describe;
use crate::limit::Limit;

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
    }
}

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
