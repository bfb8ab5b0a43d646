//! The CIE's illuminants by name.

use straal_math::ops;

use super::{Bins, Interpolation, Observer, Quantity, Spectrum, rows, thermal};

/// The names of illuminants, apart from black bodies and daylight of any temperature.
pub const NAMES: &[&str] = &[
    "A", "C", "D50", "D55", "D65", "D75", "E", "FL1", "FL2", "FL3", "FL4", "FL5", "FL6", "FL7", "FL8", "FL9",
    "FL10", "FL11", "FL12",
];

/// What stands in a column of the table.
const COLUMNS: &[&str] = &[
    "C", "D50", "D65", "FL1", "FL2", "FL3", "FL4", "FL5", "FL6", "FL7", "FL8", "FL9", "FL10", "FL11", "FL12",
];

/// An illuminant by its name, in capitals or not, with or without `CIE` before it (`D65`, `cie-a`); its luminance Y is 1.
pub fn by_name(name: &str) -> Option<Spectrum> {
    let upper = name.to_ascii_uppercase();
    let short =
        upper.strip_prefix("CIE").map_or(upper.as_str(), |rest| rest.trim_start_matches(['-', '_', ' ']));
    let spectrum = match short {
        "A" => a(),
        "E" => Spectrum::new(vec![1.0, 1e6], vec![1.0; 2]).ok()?,
        "D55" => thermal::daylight(5500.0)?,
        "D75" => thermal::daylight(7500.0)?,
        _ => table(COLUMNS.iter().position(|c| *c == short)?)?,
    };
    Some(of_unit_luminance(&spectrum))
}

/// D65, mean daylight: the white of sRGB; its luminance is 1.
pub fn d65() -> Bins {
    by_name("D65").map_or([1.0; super::COUNT], |s| s.bins(Quantity::Emission))
}

/// The same spectrum with luminance Y = 1; one without luminance stays as it is.
pub fn of_unit_luminance(spectrum: &Spectrum) -> Spectrum {
    let [_, y, _] = Observer::Cie1931.light(&spectrum.bins(Quantity::Emission));
    if y > 0.0 { spectrum.scaled(1.0 / y) } else { spectrum.clone() }
}

/// A tungsten lamp: Planck's law at 2848 K with the second constant of 1931 (CIE 15:2018, eq. 1).
fn a() -> Spectrum {
    let power = |nm: f64| {
        let power =
            |nm: f64| 1.0 / (ops::pow_d(nm / 560.0, 5.0) * (ops::exp_d(1.435e7 / (2848.0 * nm)) - 1.0));
        100.0 * power(nm) / power(560.0)
    };
    thermal::sampled(power)
}

/// By straight lines, as the CIE's daylight is defined, and since curves ring beside the lines of fluorescent lamps.
fn table(column: usize) -> Option<Spectrum> {
    let points = rows(include_str!("../../data/illuminants.txt"))
        .filter_map(|row| Some(((*row.first()?)?, (*row.get(column + 1)?)?)));
    let (wavelengths, values) = points.unzip();
    Spectrum::new(wavelengths, values).ok()?.interpolated(Interpolation::Linear).ok()
}
