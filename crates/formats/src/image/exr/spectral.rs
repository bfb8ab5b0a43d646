//! Wavelengths in OpenEXR, after Fichet, Pacanowski and Wilkie (2021), "An OpenEXR Layout for Spectral Images".
//!
//! Radiance at 550 nm is the channel `S0.550,000nm`: S0 is the first of Stokes' parameters, the comma keeps the
//! number apart from the names of layers, and the unit is metres or hertz with or without a prefix.

use super::{Channel, Layer, Picture};
use straal_color::spectrum::bands::xyz_of_samples;

/// The layer of radiance by wavelengths.
pub const LAYER: &str = "S0";

/// Metres a second.
const LIGHT: f64 = 299_792_458.0;

/// The text attributes that say which layout it is, and of which unit the numbers are.
const ATTRIBUTES: [(&str, &str); 2] = [("emissiveUnits", "W.m^-2.sr^-1"), ("spectralLayoutVersion", "1.0")];

/// A layer of radiance at wavelengths in nm, with its samples by pixel, and the text attributes that go with it.
pub fn layer(wavelengths: impl Iterator<Item = (f64, Vec<f32>)>) -> (Layer, Vec<(String, String)>) {
    let channel =
        |(nm, samples): (f64, Vec<f32>)| Channel { name: format!("{nm:.3}nm").replace('.', ","), samples };
    let channels = wavelengths.map(channel).collect();
    let attributes = ATTRIBUTES.map(|(name, value)| (name.to_owned(), value.to_owned())).to_vec();
    (Layer { name: LAYER.to_owned(), channels }, attributes)
}

/// Whether a text attribute is one of those.
pub fn is_attribute(name: &str) -> bool {
    ATTRIBUTES.iter().any(|(own, _)| *own == name)
}

/// X, Y and Z of a picture that has wavelengths, two at least.
pub(super) fn xyz(picture: &Picture) -> Option<Vec<[f32; 3]>> {
    let layer = picture.layer(LAYER)?;
    let named = layer.channels.iter().filter_map(|c| Some((nanometres(&c.name)?, &c.samples)));
    let mut channels: Vec<(f64, &Vec<f32>)> = named.collect();
    channels.sort_by(|a, b| a.0.total_cmp(&b.0));
    channels.dedup_by(|a, b| a.0 == b.0);
    let wavelengths: Vec<f64> = channels.iter().map(|c| c.0).collect();
    let weights = xyz_of_samples(&wavelengths);
    if weights.is_empty() {
        return None;
    }
    let mut sums = vec![[0.0_f64; 3]; picture.data_window.width * picture.data_window.height];
    for ((_, samples), weight) in channels.iter().zip(weights) {
        for (sum, &v) in sums.iter_mut().zip(*samples) {
            for c in 0..3 {
                sum[c] += weight[c] * f64::from(v);
            }
        }
    }
    Some(sums.into_iter().map(|sum| sum.map(|v| v as f32)).collect())
}

/// The wavelength in nm that a channel is named by.
fn nanometres(name: &str) -> Option<f64> {
    let (rest, is_frequency) = match name.strip_suffix("Hz") {
        Some(rest) => (rest, true),
        None => (name.strip_suffix('m')?, false),
    };
    let digits = rest.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let factor = match &rest[digits.len()..] {
        "Y" => 1e24,
        "Z" => 1e21,
        "E" => 1e18,
        "P" => 1e15,
        "T" => 1e12,
        "G" => 1e9,
        "M" => 1e6,
        "k" => 1e3,
        "h" => 1e2,
        "da" => 1e1,
        "" => 1.0,
        "d" => 1e-1,
        "c" => 1e-2,
        "m" => 1e-3,
        "u" => 1e-6,
        "n" => 1e-9,
        "p" => 1e-12,
        _ => return None,
    };
    let number: f64 = digits.replace(',', ".").parse().ok()?;
    // Nanometres are so common that they shall come back to the digit.
    let nm = match (is_frequency, factor) {
        (true, _) => LIGHT / (number * factor) * 1e9,
        (false, 1e-9) => number,
        (false, _) => number * factor * 1e9,
    };
    (nm.is_finite() && nm > 0.0).then_some(nm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wavelengths_are_told_in_metres_and_hertz() {
        for (name, nm) in [
            ("550,000nm", 550.0),
            ("0,55um", 550.0),
            ("5,5E-7m", 550.0),
            ("545,077196THz", 550.0),
            ("400nm", 400.0),
        ] {
            let told = nanometres(name).unwrap_or(0.0);
            assert!((told - nm).abs() < 1e-5, "{name}: {told}");
        }
        for name in ["R", "550", "nm", "550nmm", "-1nm", "0nm", "infm", "550,0,0nm", "550xm", "Hz", "m"] {
            assert_eq!(nanometres(name), None, "{name}");
        }
    }

    #[test]
    fn light_of_one_at_all_wavelengths_has_a_luminance_of_one() {
        let mut picture = Picture::of_size(2, 1);
        let (layer, attributes) = layer((0..470).map(|i| (360.5 + f64::from(i), vec![1.0, 0.25])));
        assert_eq!((layer.channels[0].name.as_str(), attributes.len()), ("360,500nm", 2));
        picture.layers.push(layer);
        let xyz = xyz(&picture).unwrap();
        assert!((xyz[0][1] - 1.0).abs() < 1e-6 && (xyz[1][1] - 0.25).abs() < 1e-6, "{xyz:?}");
    }
}
