//! The CIE's illuminants by name.

use straal_math::ops;

use super::{Bins, Interpolation, Observer, Quantity, TabulatedSpectrum, rows, thermal};

/// An illuminant that goes by a name, which black bodies and daylight of any temperature don't.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Illuminant(&'static str);

/// The names of illuminants.
pub const NAMES: &[&str] = &[
    "A", "C", "D50", "D55", "D65", "D75", "E", "FL1", "FL2", "FL3", "FL4", "FL5", "FL6", "FL7", "FL8", "FL9",
    "FL10", "FL11", "FL12",
];

/// What stands in a column of the table.
const COLUMNS: &[&str] = &[
    "C", "D50", "D65", "FL1", "FL2", "FL3", "FL4", "FL5", "FL6", "FL7", "FL8", "FL9", "FL10", "FL11", "FL12",
];

impl Illuminant {
    /// The same at all wavelengths.
    pub const E: Self = Self("E");

    /// A lamp of tungsten.
    pub const A: Self = Self("A");

    /// D65, mean daylight: the white of sRGB.
    pub const D65: Self = Self("D65");

    /// By its name, in capitals or not, with or without `CIE` before it (`D65`, `cie-a`).
    pub fn named(name: &str) -> Option<Self> {
        let upper = name.to_ascii_uppercase();
        let short =
            upper.strip_prefix("CIE").map_or(upper.as_str(), |rest| rest.trim_start_matches(['-', '_', ' ']));
        NAMES.iter().find(|known| **known == short).map(|known| Self(known))
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        self.0
    }

    /// Its spectrum, of luminance Y = 1.
    pub fn spectrum(self) -> TabulatedSpectrum {
        let even = TabulatedSpectrum::default;
        let spectrum = match self.0 {
            "A" => a(),
            "D55" => thermal::daylight(5500.0).unwrap_or_else(even),
            "D75" => thermal::daylight(7500.0).unwrap_or_else(even),
            // E is the same at all wavelengths. A test reads all others.
            name => COLUMNS.iter().position(|c| *c == name).and_then(table).unwrap_or_else(even),
        };
        of_unit_luminance(&spectrum)
    }
}

/// D65; its luminance is 1.
pub fn d65() -> Bins {
    Illuminant::D65.spectrum().bins(Quantity::Emission)
}

/// The same spectrum with luminance Y = 1; one without luminance stays as it is.
pub fn of_unit_luminance(spectrum: &TabulatedSpectrum) -> TabulatedSpectrum {
    let [_, y, _] = Observer::Cie1931.light(&spectrum.bins(Quantity::Emission));
    if y > 0.0 { spectrum.scaled(1.0 / y) } else { spectrum.clone() }
}

/// A tungsten lamp: Planck's law at 2848 K with the second constant of 1931 (CIE 15:2018, eq. 1).
fn a() -> TabulatedSpectrum {
    let power = |nm: f64| {
        let power =
            |nm: f64| 1.0 / (ops::pow_d(nm / 560.0, 5.0) * (ops::exp_d(1.435e7 / (2848.0 * nm)) - 1.0));
        100.0 * power(nm) / power(560.0)
    };
    thermal::sampled(power)
}

/// By straight lines, as the CIE's daylight is defined, and since curves ring beside the lines of fluorescent lamps.
fn table(column: usize) -> Option<TabulatedSpectrum> {
    let points = rows(include_str!("../../data/illuminants.txt"))
        .filter_map(|row| Some(((*row.first()?)?, (*row.get(column + 1)?)?)));
    let (wavelengths, values) = points.unzip();
    TabulatedSpectrum::new(wavelengths, values).ok()?.interpolated(Interpolation::Linear).ok()
}
