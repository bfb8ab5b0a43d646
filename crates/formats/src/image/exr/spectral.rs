//! Wavelengths in OpenEXR, after Fichet, Pacanowski and Wilkie (2021), "An OpenEXR Layout for Spectral Images".
//!
//! Radiance at 550 nm is the channel `S0.550,000nm`: S0 is the first of Stokes' parameters, the comma keeps the
//! number apart from the names of layers, and the unit is metres or hertz with or without a prefix. S1 to S3 tell how light
//! is polarised.
//!
//! The share of light that comes back or passes at 550 nm is the channel `T.550,000nm`. Of a fluorescent surface,
//! `T.400,000nm.550,000nm` is what light of 400 nm makes shine at 550 nm.

use super::choose::Names;
use super::{Channel, Layer, Layered};
use straal_color::spectrum::bands::{xyz_of_reflectances, xyz_of_samples};
use straal_color::spectrum::illuminant;

/// The layer of radiance by wavelengths.
pub const LAYER: &str = "S0";

/// The layer of reflectances.
const REFLECTIVE: &str = "T";

/// What a picture has by wavelengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    /// At how many wavelengths it has radiance.
    pub radiance: usize,
    /// At how many it has the share of light that comes back or passes.
    pub reflectance: usize,
    /// Whether it tells how the light is polarised, which isn't read.
    pub polarised: bool,
    /// Whether it tells what light of one wavelength makes shine at another, which isn't read.
    pub fluorescent: bool,
}

impl Contents {
    /// Those of a picture.
    pub fn of(picture: &Layered) -> Self {
        let count = |name: &str| picture.layer(name).map_or(0, |l| named(l).len());
        let polarised = ["S1", "S2", "S3"].into_iter().any(|name| count(name) > 0);
        let fluorescent = picture.layers.iter().any(|l| is_fluorescence(&l.name));
        Self { radiance: count(LAYER), reflectance: count(REFLECTIVE), polarised, fluorescent }
    }
}

/// Whether a layer is one that [`Contents`] tells of.
pub fn is_layer(layer: &Layer) -> bool {
    is_fluorescence(&layer.name)
        || [LAYER, "S1", "S2", "S3", REFLECTIVE].contains(&layer.name.as_str()) && !named(layer).is_empty()
}

fn is_fluorescence(layer: &str) -> bool {
    layer.split_once('.').is_some_and(|(first, nm)| first == REFLECTIVE && nanometres(nm).is_some())
}

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

/// The channels of a layer that are named by a wavelength, by rising wavelength in nm, each once.
fn named(layer: &Layer) -> Vec<(f64, &[f32])> {
    let channels = layer.channels.iter();
    let mut channels: Vec<(f64, &[f32])> =
        channels.filter_map(|c| Some((nanometres(&c.name)?, c.samples.as_slice()))).collect();
    channels.sort_by(|a, b| a.0.total_cmp(&b.0));
    channels.dedup_by(|a, b| a.0 == b.0);
    channels
}

/// The layer of wavelengths, two at least, that is the picture's colours: that of radiance; without any, that of reflectance.
pub(super) fn summed(layers: &[Names]) -> Option<&'static str> {
    [LAYER, REFLECTIVE].into_iter().find(|name| {
        let Some(layer) = layers.iter().find(|l| l.layer == *name) else { return false };
        let mut wavelengths: Vec<f64> = layer.channels.iter().filter_map(|c| nanometres(c)).collect();
        wavelengths.sort_by(f64::total_cmp);
        wavelengths.dedup();
        wavelengths.len() > 1 && !weights(name, &wavelengths).is_empty()
    })
}

/// X, Y and Z of each pixel, from a layer that is [`summed`]: of reflectance under D65.
pub(super) fn pixels(picture: &Layered, layer: &str) -> Option<Vec<[f32; 3]>> {
    let channels = named(picture.layer(layer)?);
    let wavelengths: Vec<f64> = channels.iter().map(|c| c.0).collect();
    let mut sums = vec![[0.0_f64; 3]; picture.data_window.width * picture.data_window.height];
    for ((_, samples), weight) in channels.iter().zip(weights(layer, &wavelengths)) {
        for (sum, &v) in sums.iter_mut().zip(*samples) {
            for c in 0..3 {
                sum[c] += weight[c] * f64::from(v);
            }
        }
    }
    Some(sums.into_iter().map(|sum| sum.map(|v| v as f32)).collect())
}

/// What each wavelength of a layer adds to X, Y and Z.
fn weights(layer: &str, wavelengths: &[f64]) -> Vec<[f64; 3]> {
    if layer == LAYER {
        xyz_of_samples(wavelengths)
    } else {
        xyz_of_reflectances(wavelengths, &illuminant::d65())
    }
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
    use straal_color::RgbSpace;
    use straal_color::spectrum::Observer;

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
        let mut picture = Layered::of_size(2, 1);
        let (layer, attributes) = layer((0..470).map(|i| (360.5 + f64::from(i), vec![1.0, 0.25])));
        assert_eq!((layer.channels[0].name.as_str(), attributes.len()), ("360,500nm", 2));
        picture.layers.push(layer);
        let xyz = picture.beauty().unwrap().pixels;
        assert!((xyz[0][1] - 1.0).abs() < 1e-6 && (xyz[1][1] - 0.25).abs() < 1e-6, "{xyz:?}");
    }

    fn layer_named(name: &str, channels: &[(&str, f32)]) -> Layer {
        let channel =
            |(name, v): &(&str, f32)| Channel { name: (*name).to_owned(), samples: vec![*v, 0.5 * v] };
        Layer { name: name.to_owned(), channels: channels.iter().map(channel).collect() }
    }

    #[test]
    fn reflectances_are_seen_under_daylight() {
        let mut picture = Layered::of_size(2, 1);
        let grey = [("400,000nm", 0.5), ("0,7um", 0.5), ("500nm", 0.5), ("A", 9.0)];
        picture.layers.push(layer_named("T", &grey));
        let white = Observer::Cie1931.light(&illuminant::d65());
        let seen = picture.beauty().unwrap();
        assert_eq!((seen.layer.as_str(), seen.space), ("T", Some(RgbSpace::XYZ)));
        for (c, white) in white.into_iter().enumerate() {
            assert!((f64::from(seen.pixels[0][c]) - 0.5 * white).abs() < 1e-6, "{seen:?}");
            assert!((f64::from(seen.pixels[1][c]) - 0.25 * white).abs() < 1e-6, "{seen:?}");
        }
        // Light counts before what it falls on.
        picture.layers.push(layer_named("S0", &[("400nm", 1.0), ("700nm", 1.0)]));
        assert_eq!(picture.beauty().unwrap().layer, "S0");
        // One wavelength is no spectrum, and infrared is no colour.
        for channels in [&[("500nm", 1.0)][..], &[("900nm", 1.0), ("1000nm", 1.0)]] {
            picture.layers = vec![layer_named("T", channels)];
            assert_eq!(summed(&picture.names()), None);
        }
    }

    #[test]
    fn what_is_by_wavelengths_is_told() {
        let mut picture = Layered::of_size(2, 1);
        assert_eq!(Contents::of(&picture), Contents::default());
        let two = [("400nm", 1.0), ("700nm", 1.0)];
        picture.layers = ["S0", "S1", "T", "T.400,0nm"].map(|name| layer_named(name, &two)).into();
        let want = Contents { radiance: 2, reflectance: 2, polarised: true, fluorescent: true };
        assert_eq!(Contents::of(&picture), want);
        assert!(picture.layers.iter().all(is_layer));
        for (name, channel) in [("T", "Z"), ("S2", "R"), ("T.x", "500nm"), ("", "500nm"), ("depth", "Z")] {
            assert!(!is_layer(&layer_named(name, &[(channel, 1.0)])), "{name}");
        }
    }
}
