//! In which numbers a film takes light.

use straal_color::spectrum::Bands;

/// In which numbers a film takes light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Recording {
    /// Linear RGB of the work space.
    #[default]
    Rgb,
    /// X, Y and Z of the observer of 1931; white of the scene has those of D65.
    Xyz,
    /// Linear RGB, and the mean radiance in bands of wavelengths.
    Spectral(Bands),
}

impl Recording {
    /// The bands, if it has any.
    pub const fn bands(&self) -> Option<&Bands> {
        match self {
            Self::Spectral(bands) => Some(bands),
            Self::Rgb | Self::Xyz => None,
        }
    }

    /// The name of its kind.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Rgb => "rgb",
            Self::Xyz => "xyz",
            Self::Spectral(_) => "spectral",
        }
    }
}
