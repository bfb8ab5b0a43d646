//! Colours and spectra.
//!
//! A light's spectrum is scaled to a luminance of 1 by pbrt, except that of a colour in RGB: its numbers are what the film sees.

use std::collections::BTreeMap;
use std::sync::Arc;

use straal_color::Space;
use straal_color::spectrum::refraction::{self, Metal};
use straal_color::spectrum::{Illuminant, Observer, Quantity, TabulatedSpectrum};
use straal_scene::desc::{Index, Interpolation, Measured, Spectrum};
use straal_scene::value::{Asset, Known as KnownName, LinearRgb};
use straal_scene::{Span, Spanned, suggest};

use super::Reader;
use super::params::{Param, Params, Type, Values};
use crate::spd;

/// What a spectrum is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A share of light.
    Albedo,
    /// A number that may be above 1.
    Unbounded,
    /// Light.
    Illuminant,
}

/// What a file held, and the name by which the scene has it.
type FromFile = Option<(Asset<TabulatedSpectrum>, Arc<TabulatedSpectrum>)>;

/// Spectra that were read.
#[derive(Default)]
pub(super) struct Known {
    files: BTreeMap<String, FromFile>,
}

/// What goes by a name in pbrt.
enum Named {
    Metal(Metal, Part),
    /// An index that straal has no table of.
    Number(f64),
    Glass(KnownName<refraction::Glass>),
    /// Red, green and blue, where straal has no table.
    Rgb([f64; 3]),
    Light(KnownName<Illuminant>),
    Daylight(f64),
}

/// Which part of a metal's index.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Eta,
    K,
}

/// Metals and what stands for them, by pbrt's names.
const METALS: [(&str, &str); 4] = [("Ag", "silver"), ("Al", "aluminium"), ("Au", "gold"), ("Cu", "copper")];

/// Glasses. What pbrt calls F5, F10 and F11 are Schott's SF5, SF10 and SF11.
const GLASSES: [(&str, &str); 6] = [
    ("BK7", "N-BK7"),
    ("BAF10", "N-BAF10"),
    ("FK51A", "N-FK51A"),
    ("LASF9", "N-LASF9"),
    ("F10", "N-SF10"),
    ("F11", "N-SF11"),
];

/// Index of refraction of Schott's SF5 at the yellow line of helium.
const SF5: f64 = 1.6727;

/// Those that straal has no table of, as red, green and blue (at 612, 549 and 465 nm), real and imaginary part: brass, MgO and TiO2.
const AS_RGB: [(&str, [f64; 3], [f64; 3]); 3] = [
    ("CuZn", [0.444, 0.527, 1.094], [3.695, 2.765, 1.829]),
    ("MgO", [1.735, 1.740, 1.750], [0.0, 0.0, 0.0]),
    ("TiO2", [2.58, 2.64, 2.80], [0.0, 0.0, 0.0]),
];

fn named(name: &str) -> Option<Named> {
    if let Some(rest) = name.strip_prefix("metal-") {
        let (symbol, part) = rest.rsplit_once('-')?;
        let part = match part {
            "eta" => Part::Eta,
            "k" => Part::K,
            _ => return None,
        };
        if let Some((_, english)) = METALS.iter().find(|(known, _)| *known == symbol) {
            return Some(Named::Metal(Metal::named(english)?, part));
        }
        let (_, eta, k) = AS_RGB.iter().find(|(known, ..)| *known == symbol)?;
        return Some(Named::Rgb(if part == Part::Eta { *eta } else { *k }));
    }
    if let Some(glass) = name.strip_prefix("glass-") {
        if glass == "F5" {
            return Some(Named::Number(SF5));
        }
        let (_, own) = GLASSES.iter().find(|(known, _)| *known == glass)?;
        return Some(Named::Glass(KnownName::new((*own).to_owned())?));
    }
    if let Some(light) = name.strip_prefix("stdillum-") {
        let own = light.strip_prefix('F').map_or(light.to_owned(), |number| format!("FL{number}"));
        return Some(Named::Light(KnownName::new(own)?));
    }
    (name == "illum-acesD60").then_some(Named::Daylight(6000.0))
}

/// A spectrum times a number, within what light can be computed with.
pub(super) fn times(spectrum: &Spectrum, factor: f64) -> Spectrum {
    const MOST: f64 = 1e30;
    let held = |v: f64| if v < MOST { v } else { MOST };
    match spectrum {
        Spectrum::Rgb(LinearRgb(rgb)) => Spectrum::Rgb(LinearRgb(rgb.map(|v| held(v * factor)))),
        Spectrum::Measured(m) => {
            let scale = held(m.scale * factor);
            Spectrum::Measured(Box::new(Measured { scale, ..(**m).clone() }))
        }
    }
}

/// How bright light of a spectrum is, where white of 1 is 1.
fn luminance(spectrum: &TabulatedSpectrum) -> f64 {
    Observer::Cie1931.light(&spectrum.bins(Quantity::Emission))[1]
}

/// A table as a description says it.
fn measured(spectrum: &TabulatedSpectrum, scale: f64) -> Spectrum {
    let (wavelengths, values) = spectrum.points().unzip();
    let interpolation = Some(Interpolation::Linear);
    Spectrum::Measured(Box::new(Measured {
        wavelengths,
        values,
        interpolation,
        scale,
        ..Measured::default()
    }))
}

impl Reader<'_, '_> {
    /// A parameter's spectrum, if it is said; light comes without what the film makes of it.
    pub(super) fn spectrum(&mut self, params: &Params, name: &'static str, role: Role) -> Option<Spectrum> {
        let is_colour =
            |t| matches!(t, Type::Rgb | Type::Xyz | Type::Spectrum | Type::Blackbody | Type::Float);
        let param = params.find(name, is_colour)?;
        match &param.values {
            Values::Numbers(v) => match (param.kind, v.as_slice()) {
                (Type::Float, [v, ..]) => self.rgb([*v; 3], param, role),
                (Type::Rgb, [r, g, b, ..]) => {
                    let rgb = param.space.to(Space::Srgb).apply([*r, *g, *b]);
                    // Rounding turns grey into what is nearly grey.
                    let rgb = if param.space == Space::Srgb { [*r, *g, *b] } else { rgb };
                    self.rgb(rgb, param, role)
                }
                (Type::Xyz, [x, y, z, ..]) => {
                    let rgb = Space::Srgb.rgb().from_xyz().apply([*x, *y, *z]);
                    self.rgb(rgb, param, role)
                }
                (Type::Blackbody, [kelvin, rest @ ..]) => {
                    if !(100.0..=1e6).contains(kelvin) {
                        self.error(param.span, "a black body's temperature must be from 100 to 1000000 K");
                        return None;
                    }
                    // The second number is a factor of version 3.
                    let scale = rest.first().copied().filter(|v| *v >= 0.0).unwrap_or(1.0);
                    if role != Role::Illuminant {
                        self.warn(param.span, "a black body is light, and no light is wanted here");
                    }
                    let body = Measured { blackbody: Some(*kelvin), scale, ..Measured::default() };
                    Some(Spectrum::Measured(Box::new(body)))
                }
                (_, table) => {
                    let (wavelengths, values) = table.chunks_exact(2).map(|pair| (pair[0], pair[1])).unzip();
                    match TabulatedSpectrum::new(wavelengths, values) {
                        Ok(table) => self.table(&table, param, role),
                        Err(fault) => {
                            self.error(param.span, fault.to_string());
                            None
                        }
                    }
                }
            },
            Values::Strings(names) => {
                let said = names.first()?;
                match named(said) {
                    Some(found) => self.of_name(said, &found, role),
                    None => self.of_file(said, role),
                }
            }
            _ => None,
        }
    }

    /// Light without a colour of its own: that of the space's white.
    pub(super) const fn white() -> Spectrum {
        Spectrum::grey(1.0)
    }

    fn rgb(&mut self, rgb: [f64; 3], param: &Param, role: Role) -> Option<Spectrum> {
        let most = if role == Role::Albedo { 1.0 } else { f64::from(f32::MAX) };
        if rgb.iter().any(|v| *v < -1e-4 || *v > most + 1e-4) {
            let message = match role {
                Role::Albedo => "a reflectance is from 0 to 1: what lies beyond is cut off",
                _ => "this is below 0 in linear sRGB: that is cut off",
            };
            self.warn_once(param.span, message);
        }
        let within = |v: f64| if v > 0.0 { if v < most { v } else { most } } else { 0.0 };
        Some(Spectrum::Rgb(LinearRgb(rgb.map(within))))
    }

    /// A table as what it is for.
    fn table(&mut self, table: &TabulatedSpectrum, param: &Param, role: Role) -> Option<Spectrum> {
        match role {
            Role::Illuminant => {
                let y = luminance(table);
                if !((1.0 / y) as f32).is_finite() {
                    self.error(param.span, "this light can't be seen: it has no luminance");
                    return None;
                }
                Some(measured(table, 1.0 / y))
            }
            Role::Albedo if table.peak() > 1.0 => {
                self.warn_once(
                    param.span,
                    "a reflectance is at most 1: this spectrum is scaled down to that",
                );
                Some(measured(table, 1.0 / table.peak()))
            }
            _ => Some(measured(table, 1.0)),
        }
    }

    fn of_name(&mut self, said: &Spanned<String>, found: &Named, role: Role) -> Option<Spectrum> {
        let is_light = matches!(found, Named::Light(_) | Named::Daylight(_));
        if is_light != (role == Role::Illuminant) {
            let what = if is_light { "light" } else { "no light" };
            self.warn(said.span, format!("`{}` is {what}, which isn't what is wanted here", said.value));
        }
        Some(match found {
            Named::Metal(metal, part) => measured(&metal.index()[usize::from(*part == Part::K)], 1.0),
            Named::Number(v) => Spectrum::grey(*v),
            Named::Glass(glass) => Spectrum::grey(glass.what.index().at(refraction::MIDDLE)),
            Named::Rgb(rgb) => {
                let message = format!("`{}` is approximated by red, green and blue", said.value);
                self.warn_once(said.span, message);
                Spectrum::Rgb(LinearRgb(*rgb))
            }
            Named::Light(illuminant) => Spectrum::Measured(Box::new(Measured::named(illuminant.clone()))),
            Named::Daylight(kelvin) => {
                let daylight = Measured { daylight: Some(*kelvin), ..Measured::default() };
                Spectrum::Measured(Box::new(daylight))
            }
        })
    }

    fn of_file(&mut self, said: &Spanned<String>, role: Role) -> Option<Spectrum> {
        let (asset, table) = self.spectrum_file(said)?;
        let asset = Asset { file: said.clone(), ..asset };
        let y = luminance(&table);
        let scale = match role {
            Role::Illuminant if ((1.0 / y) as f32).is_finite() => 1.0 / y,
            Role::Illuminant => {
                self.error(said.span, "this light can't be seen: it has no luminance");
                return None;
            }
            Role::Albedo if table.peak() > 1.0 => {
                self.warn_once(said.span, "a reflectance is at most 1: this spectrum is scaled down to that");
                1.0 / table.peak()
            }
            _ => 1.0,
        };
        let interpolation = Some(Interpolation::Linear);
        let m = Measured { file: Some(asset), interpolation, scale, ..Measured::default() };
        Some(Spectrum::Measured(Box::new(m)))
    }

    /// A file of a spectrum, read once.
    fn spectrum_file(&mut self, said: &Spanned<String>) -> FromFile {
        if let Some(known) = self.spectra.files.get(&said.value) {
            return known.clone();
        }
        let found = match self.bytes_of(said, spd::MOST_BYTES) {
            Err(refusal) if refusal.is_missing() => {
                let message =
                    format!("`{}` is neither a spectrum that is known nor a file", suggest::brief(said));
                let help = suggest::did_you_mean(said, NAMES).or(refusal.help);
                self.d().push(straal_scene::Diagnostic::error(said.span, message).maybe_help(help));
                None
            }
            Err(refusal) => {
                self.refuse(said, refusal);
                None
            }
            Ok((path, bytes)) => match spd::read(&bytes) {
                Err(e) => {
                    self.refuse(said, crate::files::Refusal::new(e.to_string()));
                    None
                }
                Ok(table) => {
                    self.files.push((path, said.value.clone(), blake3::hash(&bytes).into()));
                    let asset = self.made.in_file(said.clone());
                    let table = Arc::new(table);
                    self.made.assets.spectra.put(asset.handle, table.clone());
                    Some((asset, table))
                }
            },
        };
        self.spectra.files.insert(said.value.clone(), found.clone());
        found
    }

    /// The index of refraction of something clear.
    pub(super) fn index(&mut self, params: &Params, name: &'static str, absent: f64) -> Index {
        if let Some(v) = params.maybe_float(name) {
            return Index::Constant(self.within(v, params.span));
        }
        let said = params.find(name, |t| matches!(t, Type::Spectrum | Type::Rgb));
        let Some(param) = said else { return Index::Constant(absent) };
        if let Some([said, ..]) = param.strings()
            && let Some(found) = named(said)
        {
            match found {
                Named::Glass(glass) => return Index::Named(glass),
                Named::Number(v) => return Index::Constant(v),
                Named::Rgb([_, green, _]) => return Index::Constant(self.within(green, param.span)),
                _ => {}
            }
        }
        let span = param.span;
        let v = match self.spectrum(params, name, Role::Unbounded) {
            Some(Spectrum::Rgb(LinearRgb([r, g, b]))) => (r + g + b) / 3.0,
            Some(Spectrum::Measured(m)) => {
                self.warn_once(span, "an index of refraction by wavelengths is taken at 588 nm");
                m.spectrum(&self.made.assets).at(refraction::MIDDLE, Quantity::Index)
            }
            None => absent,
        };
        Index::Constant(self.within(v, span))
    }

    fn within(&mut self, eta: f64, span: Span) -> f64 {
        if (0.1..=10.0).contains(&eta) {
            return eta;
        }
        self.warn(span, "an index of refraction must be from 0.1 to 10: 1.5 is taken");
        1.5
    }
}

/// Which metal an index is that of, if it is both its parts.
pub(super) fn metal_of(eta: &Spanned<String>, k: &Spanned<String>) -> Option<KnownName<Metal>> {
    match (named(eta)?, named(k)?) {
        (Named::Metal(a, Part::Eta), Named::Metal(b, Part::K)) if a == b => {
            KnownName::new(Spanned::new(a.name().to_owned(), eta.span))
        }
        _ => None,
    }
}

/// An index as one number.
pub(super) fn as_number(index: &Index) -> f64 {
    index.index().at(refraction::MIDDLE)
}

/// Spectra that pbrt knows, for 'did you mean'.
const NAMES: [&str; 27] = [
    "glass-BK7",
    "glass-BAF10",
    "glass-FK51A",
    "glass-LASF9",
    "glass-F5",
    "glass-F10",
    "glass-F11",
    "metal-Ag-eta",
    "metal-Ag-k",
    "metal-Al-eta",
    "metal-Al-k",
    "metal-Au-eta",
    "metal-Au-k",
    "metal-Cu-eta",
    "metal-Cu-k",
    "metal-CuZn-eta",
    "metal-CuZn-k",
    "metal-MgO-eta",
    "metal-MgO-k",
    "metal-TiO2-eta",
    "metal-TiO2-k",
    "stdillum-A",
    "stdillum-D50",
    "stdillum-D65",
    "stdillum-F1",
    "stdillum-F2",
    "illum-acesD60",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_of_pbrt_leads_to_something() {
        for name in NAMES {
            assert!(named(name).is_some(), "{name}");
        }
        for name in ["metal-Ag", "metal-Xx-eta", "glass-X", "stdillum-Q", "spds/a.spd"] {
            assert!(named(name).is_none(), "{name}");
        }
    }

    #[test]
    fn light_has_a_luminance_of_one() {
        let table = TabulatedSpectrum::new(vec![400.0, 700.0], vec![3.0, 9.0]).unwrap();
        let Spectrum::Measured(m) = measured(&table, 1.0 / luminance(&table)) else { panic!() };
        let light = m.spectrum(&straal_scene::Assets::default());
        assert!((luminance(&light) - 1.0).abs() < 1e-9);
    }
}
