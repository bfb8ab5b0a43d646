//! Indices of refraction that may differ from point to point.

use straal_scene::desc;

use crate::lanes::Lanes;
use crate::paint::Paint;
use crate::texture::{Reading, ShadingPoint, Value};

/// Between which a texture's index of refraction is kept, whatever a picture has: as the scene language has it.
pub const RANGE: [f32; 2] = [0.1, 10.0];

/// An index of refraction over the one outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relative {
    /// The same everywhere.
    Constant(f32),
    /// Inside and outside, of which one is a texture at least.
    Varying([Value<f32>; 2]),
}

impl Relative {
    /// Of what the scene says of both.
    pub(crate) fn of(
        inside: &desc::Varying<f64>,
        outside: &desc::Varying<f64>,
        paint: &mut Paint<'_>,
    ) -> Self {
        if let (desc::Varying::Constant(inside), desc::Varying::Constant(outside)) = (inside, outside) {
            return Self::Constant(*inside as f32 / *outside as f32);
        }
        Self::Varying([inside, outside].map(|v| paint.number_within(v, RANGE)))
    }

    /// Whether it differs from point to point.
    pub fn varies(&self) -> bool {
        matches!(self, Self::Varying(_))
    }

    /// At a point.
    #[inline]
    pub fn at<L: Lanes>(&self, at: &ShadingPoint, reading: &Reading<'_, L>) -> f32 {
        match self {
            Self::Constant(eta) => *eta,
            Self::Varying([inside, outside]) => reading.eval(inside, at) / reading.eval(outside, at),
        }
    }

    /// The number, where it is one.
    pub fn constant(&self) -> Option<f32> {
        match self {
            Self::Constant(eta) => Some(*eta),
            Self::Varying(_) => None,
        }
    }
}

impl From<f32> for Relative {
    fn from(eta: f32) -> Self {
        Self::Constant(eta)
    }
}
