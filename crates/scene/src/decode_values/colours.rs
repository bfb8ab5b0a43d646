//! Colours, spectra and indices of refraction, and values that a texture may stand for.

use serde_json::{Value as Json, json};
use straal_color::spectrum::Illuminant;

use crate::decode::{Decoder, Describe, write_only};
use crate::desc::{ColorIn, Formula, Index, Measured, Spectrum, TextureOf, Varying, Wrap, Wraps, check};
use crate::diagnostic::Diagnostic;
use crate::limit::Limit;
use crate::link::Places;
use crate::remedy;
use crate::schema;
use crate::schema::Definitions;
use crate::suggest;
use crate::tree::{Datum, Entry, Tree};
use crate::value::{Known, LinearRgb};
use crate::visit::Visitor;
use crate::writer::Writer;

impl Describe for LinearRgb {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Number(_) => Self::grey(components([tree], tree, limit, d).map_or(1.0, |[v]| v)),
            Datum::Sequence(items) => match items.as_slice() {
                [r, g, b] => components([r, g, b], tree, limit, d).map_or_else(Self::blank, Self),
                _ => Self::not_one(tree, d),
            },
            Datum::String(s) => Self::from_hex(s).unwrap_or_else(|| Self::not_one(tree, d)),
            Datum::Mapping(_) if remedy::colour(tree).is_some() => Self::not_one(tree, d),
            Datum::Mapping(_) => {
                let before = d.diagnostics.errors();
                let given = ColorIn::read(tree, limit, d);
                if d.diagnostics.errors() > before {
                    return Self::blank();
                }
                let color = given.color();
                d.note_wide(tree.span, color, limit);
                color
            }
            Datum::Null => {
                let message = format!("`{}` must be a colour, found nothing", d.key());
                let help = "write '#rrggbb' in quotes, `[r, g, b]`, or a number for a grey";
                d.push(Diagnostic::error(d.place(tree), message).help(help));
                Self::blank()
            }
            Datum::Bool(_) => Self::not_one(tree, d),
        }
    }
    fn blank() -> Self {
        Self::grey(1.0)
    }
    fn write_to(&self, out: &mut dyn Writer) {
        let Self([r, g, b]) = *self;
        if r < 0.0 || g < 0.0 || b < 0.0 {
            write_only("rgb", &self.0, out);
        } else if r == g && g == b {
            r.write_to(out)
        } else {
            self.0.write_to(out)
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        let channels = <[f64; 3]>::schema(limit, defs);
        let hex = json!({ "type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$" });
        json!({ "anyOf": [schema::number("number", limit), channels, hex, ColorIn::schema(limit, defs)] })
    }
}

impl LinearRgb {
    fn not_one(tree: &Tree, d: &mut Decoder) -> Self {
        let forms = "a colour (a number, `[r, g, b]`, '#rrggbb' or a form such as `{ xyz: [x, y, z] }`)";
        d.expected_or(forms, tree, remedy::colour(tree));
        Self::blank()
    }
}

/// The numbers of a colour, or `None` after one complaint about all of them.
fn components<const N: usize>(
    items: [&Tree; N],
    whole: &Tree,
    limit: Limit,
    d: &mut Decoder,
) -> Option<[f64; N]> {
    let mut values = [0.0; N];
    for (v, item) in values.iter_mut().zip(items) {
        let Datum::Number(n) = item.value else {
            d.number(item, limit);
            return None;
        };
        *v = n;
    }
    let wrong = (0..N).find(|&i| !limit.allows(values[i]));
    let Some(i) = wrong else { return Some(values) };
    let v = values[i];
    let is_bright = limit.max == 1.0 && v > 1.0 && v.is_finite();
    let message = limit.complaint(d.key(), v);
    let help = is_bright.then(|| remedy::too_bright(&values, d.diagnostics.sources.quote(whole.span)));
    d.push(Diagnostic::error(items[i].span, message).maybe_help(help));
    None
}

impl Describe for Spectrum {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::String(s) if Illuminant::named(s).is_none() && remedy::colour(tree).is_some() => {
                Self::Rgb(LinearRgb::read(tree, limit, d))
            }
            Datum::String(s) if !s.starts_with('#') => {
                let measured = Measured::named(Known::read(tree, limit, d));
                check::reflectance(&measured, tree.span, limit, d);
                Self::Measured(Box::new(measured))
            }
            // Its first key tells a spectrum from a colour, one that is nearly right as well.
            Datum::Mapping(entries)
                if entries.first().is_some_and(|e| {
                    let key = e.key.value.as_str();
                    let colour = ["rgb", "space", "xyz", "xyy", "lab", "lch", "white"];
                    Measured::KEYS.contains(&key)
                        || !colour.contains(&key) && suggest::did_you_mean(key, Measured::KEYS).is_some()
                }) =>
            {
                let measured = Measured::read(tree, limit, d);
                check::reflectance(&measured, tree.span, limit, d);
                Self::Measured(Box::new(measured))
            }
            _ => Self::Rgb(LinearRgb::read(tree, limit, d)),
        }
    }
    fn blank() -> Self {
        Self::Rgb(LinearRgb::blank())
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self {
            Self::Rgb(color) => color.write_to(out),
            Self::Measured(m) => m.write_to(out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        let name = json!({ "type": "string", "pattern": "^[A-Za-z]" });
        json!({ "anyOf": [LinearRgb::schema(limit, defs), name, Measured::schema(limit, defs)] })
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        visitor.spectrum(self, limit);
    }
}

impl Describe for Index {
    const IS_NUMBER: bool = true;
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Number(_) => Self::Constant(f64::read(tree, limit, d)),
            Datum::String(_) => Self::Named(Known::read(tree, limit, d)),
            Datum::Mapping(_) => Self::Formula(Formula::read(tree, limit, d)),
            _ => {
                d.expected("a number, the name of a glass, or a formula", tree);
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self::Constant(1.5)
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self {
            Self::Constant(v) => v.write_to(out),
            Self::Named(name) => name.write_to(out),
            Self::Formula(f) => f.write_to(out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        let name = json!({ "type": "string", "minLength": 1 });
        json!({ "anyOf": [schema::number("number", limit), name, Formula::schema(limit, defs)] })
    }
}

impl<T: Describe> Describe for Varying<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let Datum::Mapping(entries) = &tree.value else { return Self::Constant(T::read(tree, limit, d)) };
        let [Entry { key, value, .. }] = entries.as_slice() else {
            return Self::Constant(T::read(tree, limit, d));
        };
        if key.value != "texture" {
            return Self::Constant(T::read(tree, limit, d));
        }
        let texture = d.under(&key.value, key.span, |d| TextureOf::read(value, limit, d));
        if let TextureOf::Inline(texture) = &texture {
            check::texture(texture, value.span, (limit, T::IS_NUMBER), d);
        }
        Self::Texture(Box::new(texture))
    }
    fn blank() -> Self {
        Self::Constant(T::blank())
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self {
            Self::Constant(v) => v.write_to(out),
            Self::Texture(t) => write_only("texture", &**t, out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        let textured = defs.refer("Textured", |defs| {
            let mut keys = schema::Properties::default();
            let texture = TextureOf::schema(Limit::FINITE, defs);
            keys.add("texture", &[" What it is read off: a texture, or the name of one."], texture, None);
            keys.into_schema(&[" A value that differs from point to point of a surface."])
        });
        json!({ "anyOf": [T::schema(limit, defs), textured] })
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        match self {
            Self::Constant(v) => v.show(limit, visitor),
            Self::Texture(t) => {
                visitor.texture(t, limit, T::IS_NUMBER);
                t.show(limit, visitor);
                visitor.end_of_texture();
            }
        }
    }
    fn lead(&mut self, places: &Places) {
        match self {
            Self::Constant(v) => v.lead(places),
            Self::Texture(t) => t.lead(places),
        }
    }
}

/// One for both sides, or a list of two.
impl Describe for Wraps {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Sequence(_) => Self(<[Wrap; 2]>::read(tree, limit, d)),
            _ => {
                let both = Wrap::read(tree, limit, d);
                Self([both.clone(), both])
            }
        }
    }
    fn blank() -> Self {
        Self([Wrap::Repeat, Wrap::Repeat])
    }
    fn write_to(&self, out: &mut dyn Writer) {
        let Self([u, v]) = self;
        if u == v { u.write_to(out) } else { self.0.write_to(out) }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [Wrap::schema(limit, defs), <[Wrap; 2]>::schema(limit, defs)] })
    }
}
