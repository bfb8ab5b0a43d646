//! Spectra, and indices of refraction by wavelength.

use straal_color::spectrum::{self, Illuminant, TabulatedSpectrum, illuminant, refraction};

use crate::Assets;
use crate::desc::check;
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::{Asset, Known, LinearRgb};

/// A colour of the scene: in RGB, or a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// Linear RGB; rendered by wavelengths, a smooth spectrum of that colour.
    Rgb(LinearRgb),
    /// A spectrum as it was measured or as its name says.
    Measured(Box<Measured>),
}

impl Spectrum {
    /// The same in all channels, or at all wavelengths.
    pub const fn grey(v: f64) -> Self {
        Self::Rgb(LinearRgb::grey(v))
    }

    /// Its linear RGB, if that is what the scene says.
    pub const fn rgb(&self) -> Option<LinearRgb> {
        match self {
            Self::Rgb(color) => Some(*color),
            Self::Measured(_) => None,
        }
    }

    /// The file it is in, if any, and what is said of it.
    pub fn in_file(&self) -> Option<(&Asset<TabulatedSpectrum>, &Measured)> {
        match self {
            Self::Rgb(_) => None,
            Self::Measured(m) => Some((m.file.as_ref()?, m)),
        }
    }
}

impl From<LinearRgb> for Spectrum {
    fn from(c: LinearRgb) -> Self {
        Self::Rgb(c)
    }
}

describe! {
    /// A spectrum: one of `name`, `blackbody`, `daylight`, `file`, and `wavelengths` with `values`.
    pub struct Measured [check::measured] {
        /// An illuminant of the CIE, such as `D65`, `A` or `FL2`, with the luminance of RGB 1.
        name: Option<Known<Illuminant>> = None,
        /// Light of a black body of this temperature in kelvins, with the luminance of RGB 1.
        blackbody: Option<f64> [Limit::within(100.0, 1e6)] = None,
        /// Daylight of this correlated colour temperature in kelvins, with the luminance of RGB 1.
        daylight: Option<f64> [Limit::within(4000.0, 25000.0)] = None,
        /// A file with a wavelength in nm and a value on each line.
        file: Option<Asset<TabulatedSpectrum>> = None,
        /// Wavelengths in nm, rising; `values` has as many.
        wavelengths: Vec<f64> = Vec::new(),
        /// The value at each of `wavelengths`.
        values: Vec<f64> = Vec::new(),
        /// What lies between the wavelengths of a file or of `wavelengths`; `smooth` if not told for 4 or more in equal steps
        /// of at most 20 nm, `linear` for others.
        interpolation: Option<Interpolation> = None,
        /// What all values are multiplied by.
        scale: f64 [Limit::NON_NEGATIVE] = 1.0,
    }
}

impl Measured {
    /// The keys of this mapping.
    pub(crate) const KEYS: [&'static str; 8] =
        ["name", "blackbody", "daylight", "file", "wavelengths", "values", "interpolation", "scale"];

    /// An illuminant by name.
    pub fn named(illuminant: Known<Illuminant>) -> Self {
        Self { name: Some(illuminant), ..Self::default() }
    }

    /// The spectrum, its scale included; 1 at all wavelengths for what a check has complained of.
    pub fn spectrum(&self, assets: &Assets) -> TabulatedSpectrum {
        match &self.file {
            Some(file) => self.of_table(assets.spectrum(file.handle)).unwrap_or_default(),
            None => self.said().unwrap_or_default(),
        }
    }

    /// The spectrum that the description itself says, its scale included; `None` for one of a file, and for what a check complains of.
    pub(crate) fn said(&self) -> Option<TabulatedSpectrum> {
        let light = if let Some(illuminant) = &self.name {
            illuminant.what.spectrum()
        } else if let Some(kelvin) = self.blackbody {
            illuminant::of_unit_luminance(&spectrum::thermal::black_body(kelvin))
        } else if let Some(kelvin) = self.daylight {
            illuminant::of_unit_luminance(&spectrum::thermal::daylight(kelvin)?)
        } else {
            let table = TabulatedSpectrum::new(self.wavelengths.clone(), self.values.clone()).ok()?;
            return self.of_table(&table).ok();
        };
        Some(light.scaled(self.scale))
    }

    /// The spectrum that it makes of a table, which for one of a file is what was read.
    pub(crate) fn of_table(&self, table: &TabulatedSpectrum) -> Result<TabulatedSpectrum, spectrum::Fault> {
        let scaled = table.scaled(self.scale);
        match self.interpolation {
            None => Ok(scaled),
            Some(Interpolation::Linear) => scaled.interpolated(spectrum::Interpolation::Linear),
            Some(Interpolation::Smooth) => scaled.interpolated(spectrum::Interpolation::Smooth),
        }
    }
}

describe! {
    /// What lies between two wavelengths of a table.
    pub enum Interpolation {
        /// A straight line.
        "linear" => Linear,
        /// A curve through the four nearest points, as colorimetry has it (ASTM E2022). Where it would go below 0, or above 1 as a
        /// reflectance, there are straight lines.
        "smooth" => Smooth,
    }
}

/// An index of refraction that may depend on the wavelength.
#[derive(Clone, Debug, PartialEq)]
pub enum Index {
    /// The same for all wavelengths.
    Constant(f64),
    /// A glass or another clear medium by name.
    Named(Known<refraction::Glass>),
    /// By a formula.
    Formula(Formula),
}

impl From<f64> for Index {
    fn from(v: f64) -> Self {
        Self::Constant(v)
    }
}

describe! {
    /// An index of refraction by the wavelength l in micrometres: `cauchy` or `sellmeier`.
    pub struct Formula [check::formula] {
        /// n = A + B / l^2 + C / l^4 ...: the list `[A, B, C, ...]`.
        cauchy: Vec<f64> = Vec::new(),
        /// n^2 = 1 + sum of B l^2 / (l^2 - C): a list of `[B, C]`.
        sellmeier: Vec<[f64; 2]> = Vec::new(),
    }
}

impl Index {
    /// The index by wavelength.
    pub fn index(&self) -> refraction::Index {
        match self {
            Self::Constant(n) => refraction::Index::Constant(*n),
            Self::Named(glass) => glass.what.index(),
            Self::Formula(f) if !f.cauchy.is_empty() => refraction::Index::Cauchy(f.cauchy.clone()),
            Self::Formula(f) => refraction::Index::Sellmeier(f.sellmeier.clone()),
        }
    }
}
