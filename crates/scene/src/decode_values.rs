//! How the small values of descriptions are read, written and described.

use serde_core::ser::Serializer;
use serde_json::{Value as Json, json};
use straal_color::spectrum::Illuminant;
use straal_math::{Affine, DVec3};

use crate::decode::{Decoder, Describe, Written};
use crate::desc::{
    AttributeName, AxisAngle, ColorIn, Coordinate, CoordinatesName, Formula, Index, Material, MaterialRef,
    Measured, Rotation, Spectrum, Step, Texture, TextureOf, Transform, Varying, Wrap, Wraps, check,
};
use crate::diagnostic::Diagnostic;
use crate::handle::{Handle, Kind};
use crate::limit::Limit;
use crate::link::{Familiar, Linked, Places};
use crate::remedy;
use crate::schema::{self, Definitions};
use crate::span::{Span, Spanned};
use crate::suggest;
use crate::tree::{Datum, Entry, Tree};
use crate::value::{Asset, Axis, Color, Depth, Factors, FileRef, Known, Link, Matrix, Name, Named};
use crate::visit::Visitor;

impl Describe for f64 {
    const IS_NUMBER: bool = true;
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        d.number(tree, limit).unwrap_or_else(Self::blank)
    }
    fn blank() -> Self {
        1.0
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        schema::write_number(*self, out)
    }
    fn schema(limit: Limit, _: &mut Definitions) -> Json {
        schema::number("number", limit)
    }
}

/// Whole numbers up to `$most`, or up to 2^53 where every program can hold them exactly.
macro_rules! whole {
    ($T:ident, $most:expr) => {
        impl Describe for $T {
            fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
                let v = d.integer(tree, within(limit, $most));
                v.and_then(|v| Self::try_from(v).ok()).unwrap_or_else(Self::blank)
            }
            fn blank() -> Self {
                1
            }
            fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
                out.serialize_u64(u64::from(*self))
            }
            fn schema(limit: Limit, _: &mut Definitions) -> Json {
                schema::number("integer", within(limit, $most))
            }
        }
    };
}

whole!(u32, 4_294_967_295.0);
whole!(u64, 9_007_199_254_740_991.0);

fn within(limit: Limit, most: f64) -> Limit {
    let min = if limit.min > 0.0 { limit.min } else { 0.0 };
    Limit { min, max: if limit.max < most { limit.max } else { most }, ..limit }
}

impl Describe for bool {
    fn read(tree: &Tree, _: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Bool(b) => *b,
            _ => {
                d.expected_or("`true` or `false`", tree, remedy::truth(tree));
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        false
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.serialize_bool(*self)
    }
    fn schema(_: Limit, _: &mut Definitions) -> Json {
        json!({ "type": "boolean" })
    }
}

/// Names and files.
impl Describe for Spanned<String> {
    fn read(tree: &Tree, _: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::String(s) if s.is_empty() => {
                let message = format!("`{}` must not be empty", d.key());
                d.push(Diagnostic::error(tree.span, message));
                Self::blank()
            }
            Datum::String(s) => Self::new(s.clone(), tree.span),
            _ => {
                let quoted = matches!(tree.value, Datum::Number(_) | Datum::Bool(_));
                d.expected(if quoted { "a text (in quotes)" } else { "a text" }, tree);
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self::new(String::new(), Span::NONE)
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.serialize_str(&self.value)
    }
    fn schema(_: Limit, _: &mut Definitions) -> Json {
        json!({ "type": "string", "minLength": 1 })
    }
}

/// Meshes and pictures, by the names of their files.
impl<T: Kind> Describe for Asset<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let file = FileRef::read(tree, limit, d);
        let handle = d.handle(&file);
        Self { file, handle }
    }
    fn blank() -> Self {
        Self::new(Spanned::blank(), Handle::new(0))
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.file.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        <Spanned<String>>::schema(limit, defs)
    }
    fn show<'a>(&'a self, _: Limit, visitor: &mut dyn Visitor<'a>) {
        T::show(self, visitor);
    }
}

/// Names of objects, materials and textures.
impl<T: Linked> Describe for Link<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        Self::new(Name::read(tree, limit, d))
    }
    fn blank() -> Self {
        Self::new(Name::blank())
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.name.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        Name::schema(limit, defs)
    }
    fn lead(&mut self, places: &Places) {
        self.find(places);
    }
}

/// Names of what straal knows by itself.
impl<T: Familiar> Describe for Known<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let name = Name::read(tree, limit, d);
        let what = T::named(&name);
        if what.is_none() && !name.is_empty() {
            let names = T::names();
            let near = suggest::did_you_mean(&name, names.iter().copied());
            let help =
                near.unwrap_or_else(|| format!("the names are {}", suggest::list(names.iter().copied())));
            let message = format!("there is no {} named `{}`", T::KIND, suggest::brief(&name));
            d.push(Diagnostic::error(name.span, message).help(help));
        }
        Self { name, what: what.unwrap_or_else(T::stand_in) }
    }
    fn blank() -> Self {
        Self { name: Name::blank(), what: T::stand_in() }
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.name.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        Name::schema(limit, defs)
    }
}

impl<T: Describe> Describe for Option<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        (tree.value != Datum::Null).then(|| T::read(tree, limit, d))
    }
    fn blank() -> Self {
        None
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self {
            Some(value) => value.write_to(out),
            None => out.serialize_unit(),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [T::schema(limit, defs), { "type": "null" }] })
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        if let Some(v) = self {
            v.show(limit, visitor);
        }
    }
    fn lead(&mut self, places: &Places) {
        if let Some(v) = self {
            v.lead(places);
        }
    }
}

impl<T: Describe> Describe for Box<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        Self::new(T::read(tree, limit, d))
    }
    fn blank() -> Self {
        Self::new(T::blank())
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        (**self).write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        T::schema(limit, defs)
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        (**self).show(limit, visitor);
    }
    fn lead(&mut self, places: &Places) {
        (**self).lead(places);
    }
}

impl<T: Describe> Describe for Vec<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        // A key with nothing after it is an empty list: `lights:` with every entry commented out.
        if tree.value == Datum::Null {
            return Self::new();
        }
        let Datum::Sequence(items) = &tree.value else {
            d.expected_or("a list", tree, remedy::list(tree));
            return Self::new();
        };
        items.iter().map(|item| T::read(item, limit, d)).collect()
    }
    fn blank() -> Self {
        Self::new()
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.collect_seq(self.iter().map(Written))
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "type": "array", "items": T::schema(limit, defs) })
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        self.iter().for_each(|v| v.show(limit, visitor));
    }
    fn lead(&mut self, places: &Places) {
        self.iter_mut().for_each(|v| v.lead(places));
    }
}

impl<T: Describe, const N: usize> Describe for [T; N] {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let what = format!("a list of {N}");
        match &tree.value {
            Datum::Sequence(items) if items.len() == N => {
                std::array::from_fn(|i| T::read(&items[i], limit, d))
            }
            _ => {
                d.expected_or(&what, tree, remedy::several::<N>(tree));
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        std::array::from_fn(|_| T::blank())
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.collect_seq(self.iter().map(Written))
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "type": "array", "items": T::schema(limit, defs), "minItems": N, "maxItems": N })
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        self.iter().for_each(|v| v.show(limit, visitor));
    }
    fn lead(&mut self, places: &Places) {
        self.iter_mut().for_each(|v| v.lead(places));
    }
}

impl Describe for DVec3 {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Sequence(items) if items.len() == 3 => {
                Self::from_array(std::array::from_fn(|i| f64::read(&items[i], limit, d)))
            }
            _ => {
                d.expected_or("three numbers `[x, y, z]`", tree, remedy::vector(tree));
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self::ONE
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.to_array().write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        <[f64; 3]>::schema(limit, defs)
    }
}

/// A point of which it matters where it was said.
impl Describe for Spanned<DVec3> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        Self::new(DVec3::read(tree, limit, d), tree.span)
    }
    fn blank() -> Self {
        DVec3::blank().into()
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.value.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        DVec3::schema(limit, defs)
    }
}

impl Describe for Color {
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
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let Self([r, g, b]) = *self;
        if r < 0.0 || g < 0.0 || b < 0.0 {
            out.collect_map([("rgb", Written(&self.0))])
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

impl Color {
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
                Self::Rgb(Color::read(tree, limit, d))
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
            _ => Self::Rgb(Color::read(tree, limit, d)),
        }
    }
    fn blank() -> Self {
        Self::Rgb(Color::blank())
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Rgb(color) => color.write_to(out),
            Self::Measured(m) => m.write_to(out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        let name = json!({ "type": "string", "pattern": "^[A-Za-z]" });
        json!({ "anyOf": [Color::schema(limit, defs), name, Measured::schema(limit, defs)] })
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        visitor.spectrum(self, limit);
    }
}

impl Describe for Index {
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
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
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
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Constant(v) => v.write_to(out),
            Self::Texture(t) => out.collect_map([("texture", Written(&**t))]),
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

impl Describe for AttributeName {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        Self(Name::read(tree, limit, d))
    }
    fn blank() -> Self {
        Self(Name::blank())
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.0.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        Name::schema(limit, defs)
    }
    fn show<'a>(&'a self, _: Limit, visitor: &mut dyn Visitor<'a>) {
        visitor.attribute(&self.0);
    }
}

impl Describe for CoordinatesName {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        Self(Name::read(tree, limit, d))
    }
    fn blank() -> Self {
        Self(Name::blank())
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.0.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        Name::schema(limit, defs)
    }
    fn show<'a>(&'a self, _: Limit, visitor: &mut dyn Visitor<'a>) {
        visitor.attribute(&self.0);
        visitor.coordinates(&self.0);
    }
}

/// A texture, or a word that is none of their kinds: the name of one.
impl Describe for TextureOf {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::String(name) if !Texture::KINDS.iter().any(|kind| suggest::is_same(kind, name)) => {
                Self::Named(Link::read(tree, limit, d))
            }
            _ => Self::Inline(Texture::read(tree, limit, d)),
        }
    }
    fn blank() -> Self {
        Self::Named(Link::blank())
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Named(link) => link.write_to(out),
            Self::Inline(texture) => texture.write_to(out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [Texture::schema(limit, defs), Name::schema(limit, defs)] })
    }
    /// Whoever has one says what it is for.
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        match self {
            Self::Named(link) => visitor.texture_name(link),
            Self::Inline(texture) => texture.show(limit, visitor),
        }
    }
    fn lead(&mut self, places: &Places) {
        match self {
            Self::Named(link) => link.lead(places),
            Self::Inline(texture) => texture.lead(places),
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
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let Self([u, v]) = self;
        if u == v { u.write_to(out) } else { self.0.write_to(out) }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [Wrap::schema(limit, defs), <[Wrap; 2]>::schema(limit, defs)] })
    }
}

impl<T: Describe> Describe for Named<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let mut out = Self::default();
        match &tree.value {
            Datum::Mapping(entries) => {
                for e in entries {
                    let thing = d.under(&e.key.value, e.key.span, |d| T::read(&e.value, limit, d));
                    out.insert(e.key.clone(), thing);
                }
            }
            Datum::Null => {}
            _ => {
                d.expected_or("a mapping of names to descriptions", tree, remedy::named(tree));
                out = Self::unreadable();
            }
        }
        out
    }
    fn blank() -> Self {
        Self::default()
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        out.collect_map(self.iter().map(|(name, thing)| (&name.value, Written(thing))))
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "type": "object", "additionalProperties": T::schema(limit, defs) })
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        self.iter().for_each(|(_, thing)| thing.show(limit, visitor));
    }
    fn lead(&mut self, places: &Places) {
        self.things_mut().for_each(|thing| thing.lead(places));
    }
}

impl Describe for Depth {
    fn read(tree: &Tree, _: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Null => Self::Unlimited,
            Datum::String(s) if s == "unlimited" => Self::Unlimited,
            Datum::Number(_) => Self::Edges(u32::read(tree, Limit::within(1.0, f64::from(u32::MAX)), d)),
            _ => {
                d.expected("a whole number or `unlimited`", tree);
                Self::Unlimited
            }
        }
    }
    fn blank() -> Self {
        Self::Unlimited
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Unlimited => out.serialize_str("unlimited"),
            Self::Edges(n) => n.write_to(out),
        }
    }
    fn schema(_: Limit, _: &mut Definitions) -> Json {
        json!({ "anyOf": [
            schema::number("integer", Limit::within(1.0, f64::from(u32::MAX))),
            { "const": "unlimited" },
            { "type": "null" }
        ] })
    }
}

impl Describe for Axis {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::String(s) if s == "x" => Self(DVec3::X),
            Datum::String(s) if s == "y" => Self(DVec3::Y),
            Datum::String(s) if s == "z" => Self(DVec3::Z),
            Datum::Sequence(items) if items.len() == 3 => {
                let v = DVec3::read(tree, limit, d);
                if v == DVec3::ZERO {
                    let message = format!("`{}` has no direction: all three numbers are 0", d.key());
                    d.push(Diagnostic::error(tree.span, message));
                }
                Self(v)
            }
            _ => {
                d.expected("`x`, `y`, `z` or three numbers `[x, y, z]`", tree);
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self(DVec3::Y)
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            DVec3::X => out.serialize_str("x"),
            DVec3::Y => out.serialize_str("y"),
            DVec3::Z => out.serialize_str("z"),
            v => v.write_to(out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [{ "enum": ["x", "y", "z"] }, DVec3::schema(limit, defs)] })
    }
}

impl Describe for Factors {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let factors = match &tree.value {
            Datum::Number(_) => DVec3::splat(f64::read(tree, limit, d)),
            Datum::Sequence(items) if items.len() == 3 => DVec3::read(tree, limit, d),
            _ => {
                d.expected("a number or three numbers `[x, y, z]`", tree);
                DVec3::ONE
            }
        };
        if factors.to_array().contains(&0.0) {
            let message = format!("`{}` by 0 leaves nothing to see", d.key());
            d.push(Diagnostic::error(tree.span, message).help("to flatten, use a small factor such as 1e-3"));
            return Self::blank();
        }
        Self(factors)
    }
    fn blank() -> Self {
        Self(DVec3::ONE)
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        let v = self.0;
        if v.x == v.y && v.y == v.z { v.x.write_to(out) } else { v.write_to(out) }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [schema::number("number", limit), DVec3::schema(limit, defs)] })
    }
}

impl Describe for Matrix {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let rows = match &tree.value {
            Datum::Sequence(rows) if rows.len() == 3 || rows.len() == 4 => rows,
            _ => {
                d.expected("three or four rows of four numbers", tree);
                return Self::blank();
            }
        };
        if let Some(last) = rows.get(3)
            && <[f64; 4]>::read(last, limit, d) != [0.0, 0.0, 0.0, 1.0]
        {
            let message = "the fourth row of a matrix must be `[0, 0, 0, 1]`";
            d.push(Diagnostic::error(last.span, message));
        }
        Self(Affine { rows: std::array::from_fn(|i| <[f64; 4]>::read(&rows[i], limit, d)) })
    }
    fn blank() -> Self {
        Self(Affine::IDENTITY)
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.0.rows.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "type": "array", "items": <[f64; 4]>::schema(limit, defs), "minItems": 3, "maxItems": 4 })
    }
}

/// `{ axis: y, degrees: 30 }`, or `{ y: 30 }` in short.
impl Describe for Rotation {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Mapping(entries) => {
                if let [Entry { key, value }] = entries.as_slice()
                    && let Some(axis) = Coordinate::KINDS.iter().find(|k| **k == key.value)
                {
                    let degrees = d.under(axis, key.span, |d| f64::read(value, limit, d));
                    return Self { axis: Axis(axis_of(axis)), degrees };
                }
                // Several axes, or axes in other letters.
                if let Some(help) = remedy::turn(tree) {
                    let message = format!("`{}` turns about one axis", d.key());
                    d.push(Diagnostic::error(tree.span, message).help(help));
                    return Self::blank();
                }
                let AxisAngle { axis, degrees } = AxisAngle::read(tree, limit, d);
                Self { axis, degrees }
            }
            _ => {
                d.expected_or("an axis and an angle, such as `{ y: 30 }`", tree, remedy::turn(tree));
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self { axis: Axis::blank(), degrees: 0.0 }
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        AxisAngle { axis: self.axis, degrees: self.degrees }.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        let long = AxisAngle::schema(limit, defs);
        defs.refer("Rotation", |_| {
            let mut choices = schema::Choices::default();
            for (axis, docs) in [
                ("x", "About the x axis, in degrees."),
                ("y", "About the y axis, in degrees."),
                ("z", "About the z axis, in degrees."),
            ] {
                choices.payload(axis, &[docs], schema::number("number", limit), false);
            }
            choices.or(long, "About any axis.");
            choices.into_schema(&["A turn, counter-clockwise seen from the axis' tip."])
        })
    }
}

fn axis_of(name: &str) -> DVec3 {
    match name {
        "x" => DVec3::X,
        "y" => DVec3::Y,
        _ => DVec3::Z,
    }
}

impl Describe for Transform {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let before = d.diagnostics.errors();
        let steps = match &tree.value {
            Datum::Null => Vec::new(),
            Datum::Sequence(items) => items.iter().map(|item| Step::read(item, limit, d)).collect(),
            // One step needs no list; several keys would leave the order to chance.
            Datum::Mapping(entries) if entries.len() <= 1 => {
                entries.first().map(|_| Step::read(tree, limit, d)).into_iter().collect()
            }
            Datum::Mapping(entries) => {
                if entries.iter().all(|e| !Step::KINDS.iter().any(|k| suggest::is_same(k, &e.key.value))) {
                    Step::read(tree, limit, d);
                    return Self::default();
                }
                let message = "the steps of a transform have an order, so they must be a list";
                d.push(
                    Diagnostic::error(entries[1].key.span, message)
                        .help("write each step as an item: `- translate: [1, 0, 0]`"),
                );
                Vec::new()
            }
            _ => {
                d.expected("a list of steps", tree);
                Vec::new()
            }
        };
        let transform = Self { steps, span: tree.span };
        let sound = || transform.affine().is_some_and(|a| straal_math::Transform::new(&a).is_some());
        if d.diagnostics.errors() == before && !sound() {
            let message =
                "this transform is singular: it flattens everything, or leaves the range of numbers";
            d.push(Diagnostic::error(tree.span, message).label("has no inverse"));
        }
        transform
    }
    fn blank() -> Self {
        Self::default()
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        self.steps.write_to(out)
    }
    fn schema(_: Limit, defs: &mut Definitions) -> Json {
        let step = Step::schema(Limit::FINITE, defs);
        json!({ "anyOf": [{ "type": "array", "items": step }, step, { "type": "null" }] })
    }
}

impl Describe for MaterialRef {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::String(_) => Self::Named(Link::read(tree, limit, d)),
            Datum::Mapping(_) => Self::Inline(Box::new(Material::read(tree, limit, d))),
            _ => {
                let kinds = suggest::list(Material::KINDS.iter().copied());
                let help = remedy::choice(tree, Material::KINDS);
                d.expected_or(&format!("the name of a material, or one of {kinds}"), tree, help);
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self::Named(Link::blank())
    }
    fn write_to<S: Serializer>(&self, out: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Named(link) => link.write_to(out),
            Self::Inline(material) => material.write_to(out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [<Spanned<String>>::schema(limit, defs), Material::schema(limit, defs)] })
    }
    fn show<'a>(&'a self, limit: Limit, visitor: &mut dyn Visitor<'a>) {
        if let (true, Self::Inline(material)) = (visitor.material(self), self) {
            material.show(limit, visitor);
        }
    }
    fn lead(&mut self, places: &Places) {
        match self {
            Self::Named(link) => link.lead(places),
            Self::Inline(material) => material.lead(places),
        }
    }
}
