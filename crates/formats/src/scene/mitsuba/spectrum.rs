//! Colours and numbers: constants, spectra, and what textures make of them.
//!
//! A colour is red, green and blue, one number, or a table over wavelengths. As Mitsuba has it, a table lies on straight lines and is 0 beyond its ends, and
//! one number as a `<spectrum>` that shines is the same *energy* at each wavelength, which isn't white.

use straal_color::spectrum::{Illuminant, TabulatedSpectrum};
use straal_math::ops;
use straal_scene::desc::{Interpolation, Measured, ScaleTexture, Spectrum, Texture, TextureOf, Varying};
use straal_scene::limit::Limit;
use straal_scene::value::{Known, LinearRgb};
use straal_scene::{Diagnostic, Span, Spanned, suggest};

use super::texture::Role;
use super::translate::Translator;
use super::tree::{Class, Numbers, Object, Property, Value};
use super::uv::Uv;
use super::xml;

/// What a colour is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum For {
    /// A share of light: 0 to 1.
    Share,
    /// Light that is sent out.
    Light,
    /// Any number of 0 or above, such as an index of refraction.
    Any,
}

impl For {
    pub const fn limit(self) -> Limit {
        match self {
            Self::Share => Limit::UNIT,
            Self::Light | Self::Any => Limit::NON_NEGATIVE,
        }
    }
}

/// What an illuminant or a table begins and ends with, in nm.
const VISIBLE: [f64; 2] = [360.0, 830.0];

impl<'o> Translator<'o, '_, '_> {
    /// A colour of a surface, which may be a texture.
    pub fn colour(&mut self, o: &'o Object, name: &str, absent: f64, what: For, uv: Uv) -> Varying<Spectrum> {
        let Some(property) = self.get(o, name) else { return Varying::Constant(Spectrum::grey(absent)) };
        self.colour_of(property, what, uv)
    }

    /// The same of a property.
    pub fn colour_of(&mut self, property: &'o Property, what: For, uv: Uv) -> Varying<Spectrum> {
        if let Value::Object(i) = property.value
            && self.objects[i].class == Class::Texture
            && !is_spectrum(&self.objects[i].plugin)
        {
            return Varying::Texture(Box::new(self.texture(i, uv, Role::of(what))));
        }
        Varying::Constant(self.constant_of(property, what))
    }

    /// A colour that is the same everywhere.
    pub fn constant(&mut self, o: &'o Object, name: &str, absent: f64, what: For) -> Spectrum {
        match self.get(o, name) {
            Some(property) => self.constant_of(property, what),
            None => Spectrum::grey(absent),
        }
    }

    fn constant_of(&mut self, property: &'o Property, what: For) -> Spectrum {
        let span = property.span;
        match &property.value {
            Value::Float(v) => self.grey(span, &property.name, *v, what),
            Value::Integer(v) => self.grey(span, &property.name, *v as f64, what),
            Value::Rgb(rgb) => self.rgb(span, &property.name, *rgb, what),
            Value::Spectrum(numbers) => self.numbers(span, &property.name, numbers, what),
            Value::Object(i) if is_spectrum(&self.objects[*i].plugin) => self.plugin(*i, what),
            Value::Object(i) if self.objects[*i].class == Class::Texture => {
                let message = format!("`{}` can't be a texture here: grey is taken", property.name);
                self.warn(span, message);
                Spectrum::grey(0.5)
            }
            _ => {
                let message = format!("`{}` must be a colour", suggest::brief(&property.name));
                self.fail(span, message);
                Spectrum::grey(0.5)
            }
        }
    }

    fn grey(&mut self, span: Span, name: &str, v: f64, what: For) -> Spectrum {
        Spectrum::grey(self.held(span, name, v, what.limit()))
    }

    fn rgb(&mut self, span: Span, name: &str, rgb: [f64; 3], what: For) -> Spectrum {
        let mut held = rgb;
        for v in &mut held {
            *v = self.held(span, name, *v, what.limit());
        }
        Spectrum::Rgb(LinearRgb(held))
    }

    fn numbers(&mut self, span: Span, name: &str, numbers: &Numbers, what: For) -> Spectrum {
        match numbers {
            Numbers::Uniform(v) if what == For::Light => {
                let v = self.held(span, name, *v, what.limit());
                measured(VISIBLE.to_vec(), vec![v; 2])
            }
            Numbers::Uniform(v) => self.grey(span, name, *v, what),
            Numbers::Table(wavelengths, values) => self.table(span, name, (wavelengths, values), what),
            Numbers::BlackBody(kelvin, scale) => {
                let kelvin = self.held(span, "temperature", *kelvin, Limit::within(100.0, 1e6));
                let scale = self.held(span, "scale", *scale, Limit::NON_NEGATIVE);
                black_body(kelvin, scale)
            }
            Numbers::File(file) => {
                let file = Spanned::new(file.clone(), span);
                let object = &self.objects[0];
                let Some(found) = self.file(object, &file) else { return Spectrum::grey(0.5) };
                let file = Some(self.made.in_file(Spanned::new(found.name, span)));
                let interpolation = Some(Interpolation::Linear);
                Spectrum::Measured(Box::new(Measured { file, interpolation, ..Measured::default() }))
            }
        }
    }

    /// A table, whose values are held within what they are for.
    fn table(
        &mut self,
        span: Span,
        name: &str,
        (wavelengths, values): (&[f64], &[f64]),
        what: For,
    ) -> Spectrum {
        let limit = what.limit();
        let beyond = values.iter().find(|v| !limit.allows(**v)).copied();
        let mut values = values.to_vec();
        if let Some(v) = beyond {
            self.warn(span, format!("{}: it is cut off", limit.complaint(name, v)));
            for v in &mut values {
                *v = if limit.allows(*v) {
                    *v
                } else if *v > 0.0 && limit.max == 1.0 {
                    1.0
                } else {
                    0.0
                };
            }
        }
        let checked = TabulatedSpectrum::new(wavelengths.to_vec(), values.clone());
        if let Err(fault) = checked {
            self.push(Diagnostic::error(span, fault.to_string()));
            return Spectrum::grey(0.5);
        }
        measured(wavelengths.to_vec(), values)
    }

    /// A spectrum that is an object.
    pub(super) fn plugin(&mut self, i: usize, what: For) -> Spectrum {
        let o: &'o Object = &self.objects[i];
        let span = o.plugin.span;
        let list = |t: &mut Self, name: &str| -> Vec<f64> {
            let Some(text) = t.text(o, name) else { return Vec::new() };
            xml::numbers(&text).unwrap_or_else(|| {
                t.fail(text.span, format!("`{name}` is a list of numbers"));
                Vec::new()
            })
        };
        match o.plugin.as_str() {
            "uniform" => {
                self.only(o, &["value", "wavelength_min", "wavelength_max"]);
                let v = self.within(o, "value", 1.0, what.limit());
                self.numbers(span, "value", &Numbers::Uniform(v), what)
            }
            "d65" => {
                self.only(o, &["scale", "color", "*"]);
                let scale = self.within(o, "scale", 1.0, Limit::NON_NEGATIVE);
                let nested = self.get(o, "color").or_else(|| o.objects().next().map(|(p, _)| p));
                match nested {
                    Some(color) => {
                        let color = self.constant_of(color, what);
                        self.times(span, color, scale)
                    }
                    None => {
                        let name = Known::<Illuminant>::new("D65".to_owned());
                        Spectrum::Measured(Box::new(Measured { name, scale, ..Measured::default() }))
                    }
                }
            }
            "blackbody" => {
                self.only(o, &["temperature", "scale", "wavelength_min", "wavelength_max"]);
                let kelvin = self.within(o, "temperature", 5000.0, Limit::within(100.0, 1e6));
                let scale = self.within(o, "scale", 1.0, Limit::NON_NEGATIVE);
                black_body(kelvin, scale)
            }
            "regular" | "irregular" => {
                self.only(o, &["value", "values", "wavelengths", "wavelength_min", "wavelength_max"]);
                if let Some(property) = self.get(o, "value") {
                    return self.constant_of(property, what);
                }
                let values = list(self, "values");
                let wavelengths = if o.plugin.as_str() == "irregular" {
                    list(self, "wavelengths")
                } else {
                    let low = self.within(o, "wavelength_min", VISIBLE[0], Limit::POSITIVE);
                    let high = self.within(o, "wavelength_max", VISIBLE[1], Limit::POSITIVE);
                    let steps = values.len().saturating_sub(1).max(1) as f64;
                    (0..values.len()).map(|k| low + (high - low) * k as f64 / steps).collect()
                };
                if wavelengths.len() != values.len() {
                    let message =
                        format!("there are {} wavelengths and {} values", wavelengths.len(), values.len());
                    self.fail(span, message);
                    return Spectrum::grey(0.5);
                }
                self.table(span, "values", (&wavelengths, &values), what)
            }
            // srgb, rawconstant
            _ => {
                self.only(o, &["color", "value", "unbounded"]);
                let found = self.get(o, "color").or_else(|| self.get(o, "value"));
                match found.map(|p| (&p.value, p.span)) {
                    Some((Value::Vector(v), span)) => self.rgb(span, "value", *v, what),
                    Some(_) => found.map_or(Spectrum::grey(0.5), |p| self.constant_of(p, what)),
                    None => {
                        self.fail(span, format!("`{}` has no colour", suggest::brief(&o.plugin)));
                        Spectrum::grey(0.5)
                    }
                }
            }
        }
    }

    /// A colour times a number.
    pub fn times(&mut self, span: Span, colour: Spectrum, factor: f64) -> Spectrum {
        match colour {
            Spectrum::Rgb(LinearRgb(rgb)) => self.rgb(span, "scale", rgb.map(|v| v * factor), For::Any),
            Spectrum::Measured(mut m) => {
                m.scale = self.held(span, "scale", m.scale * factor, Limit::NON_NEGATIVE);
                Spectrum::Measured(m)
            }
        }
    }

    /// The same of what may be a texture.
    pub fn times_varying(&mut self, span: Span, told: Varying<Spectrum>, factor: f64) -> Varying<Spectrum> {
        match told {
            Varying::Constant(colour) => Varying::Constant(self.times(span, colour, factor)),
            of @ Varying::Texture(_) => {
                let scaled = ScaleTexture { of, by: factor.into(), ..ScaleTexture::default() };
                Varying::Texture(Box::new(TextureOf::Inline(Texture::Scale(scaled))))
            }
        }
    }

    /// A number of a surface, which may be a texture.
    pub fn varying(&mut self, o: &'o Object, name: &str, absent: f64, limit: Limit, uv: Uv) -> Varying<f64> {
        let Some(property) = self.get(o, name) else { return Varying::Constant(absent) };
        match &property.value {
            Value::Object(i)
                if self.objects[*i].class == Class::Texture && !is_spectrum(&self.objects[*i].plugin) =>
            {
                Varying::Texture(Box::new(self.texture(*i, uv, Role::Number)))
            }
            Value::Rgb(rgb) => {
                let v = luminance(*rgb);
                Varying::Constant(self.held(property.span, name, v, limit))
            }
            Value::Object(i) => {
                let o: &'o Object = &self.objects[*i];
                Varying::Constant(self.within(o, "value", absent, limit))
            }
            _ => Varying::Constant(self.within(o, name, absent, limit)),
        }
    }
}

/// How bright a colour is (ITU-R BT.709).
pub(super) fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.212_671 * r + 0.715_160 * g + 0.072_169 * b
}

/// Whether a plugin is a spectrum and no texture.
pub(super) fn is_spectrum(plugin: &str) -> bool {
    ["uniform", "regular", "irregular", "srgb", "d65", "blackbody", "rawconstant"].contains(&plugin)
}

fn measured(wavelengths: Vec<f64>, values: Vec<f64>) -> Spectrum {
    let interpolation = Some(Interpolation::Linear);
    Spectrum::Measured(Box::new(Measured { wavelengths, values, interpolation, ..Measured::default() }))
}

/// Planck's radiance in W/(m² sr nm), with the constants of CODATA 2018.
fn black_body(kelvin: f64, scale: f64) -> Spectrum {
    const STEP: usize = 5;
    let wavelengths: Vec<f64> = (360..=830).step_by(STEP).map(f64::from).collect();
    let radiance = |nm: f64| {
        let x = 1.438_776_877e7 / (nm * kelvin);
        let m = nm * 1e-9;
        // 2 h c² = 1.191042972e-16 W m²; a nanometre is 1e-9 m.
        let v = 1e-9 * 1.191_042_972e-16 / (m * m * m * m * m) / (ops::exp_d(x) - 1.0);
        if v.is_finite() { v } else { 0.0 }
    };
    let values = wavelengths.iter().map(|nm| radiance(*nm)).collect();
    let Spectrum::Measured(mut m) = measured(wavelengths, values) else { return Spectrum::grey(0.0) };
    m.scale = scale;
    Spectrum::Measured(m)
}
