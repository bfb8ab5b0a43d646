//! Names, and what they lead to.

use serde_json::{Value as Json, json};

use crate::decode::{Decoder, Describe, write_entry};
use crate::desc::{
    AttributeName, CoordinatesName, LampChoice, LightGroup, Material, MaterialRef, Texture, TextureOf,
};
use crate::diagnostic::Diagnostic;
use crate::handle::{Handle, Kind};
use crate::limit::Limit;
use crate::link::{Familiar, Linked, Places};
use crate::remedy;
use crate::schema::Definitions;
use crate::span::Spanned;
use crate::suggest;
use crate::tree::{Datum, Tree};
use crate::value::{Asset, FileRef, Known, Link, Name, Named};
use crate::visit::Visitor;
use crate::writer::Writer;

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
    fn write_to(&self, out: &mut dyn Writer) {
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
    fn write_to(&self, out: &mut dyn Writer) {
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
    fn write_to(&self, out: &mut dyn Writer) {
        self.name.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        Name::schema(limit, defs)
    }
}

impl Describe for AttributeName {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        Self(Name::read(tree, limit, d))
    }
    fn blank() -> Self {
        Self(Name::blank())
    }
    fn write_to(&self, out: &mut dyn Writer) {
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
    fn write_to(&self, out: &mut dyn Writer) {
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

impl Describe for LightGroup {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        let name = Name::read(tree, limit, d);
        if let Some(complaint) = Self::complaint(&name).filter(|_| matches!(tree.value, Datum::String(_))) {
            d.push(Diagnostic::error(tree.span, complaint));
        }
        Self(name)
    }
    fn blank() -> Self {
        Self(Name::blank())
    }
    fn write_to(&self, out: &mut dyn Writer) {
        self.0.write_to(out)
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        Name::schema(limit, defs)
    }
    fn show<'a>(&'a self, _: Limit, visitor: &mut dyn Visitor<'a>) {
        visitor.light_group(&self.0);
    }
}

impl Describe for LampChoice {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        match &tree.value {
            Datum::Number(_) => Self::Number(u32::read(tree, limit, d)),
            Datum::String(_) => Self::Named(Name::read(tree, limit, d)),
            _ => {
                d.expected("a number or a name", tree);
                Self::blank()
            }
        }
    }
    fn blank() -> Self {
        Self::Number(1)
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self {
            Self::Number(number) => number.write_to(out),
            Self::Named(name) => name.write_to(out),
        }
    }
    fn schema(limit: Limit, defs: &mut Definitions) -> Json {
        json!({ "anyOf": [u32::schema(limit, defs), Name::schema(limit, defs)] })
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
    fn write_to(&self, out: &mut dyn Writer) {
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
    fn write_to(&self, out: &mut dyn Writer) {
        out.begin_map();
        for (name, thing) in self.iter() {
            write_entry(&name.value, thing, out);
        }
        out.end_map();
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
    fn write_to(&self, out: &mut dyn Writer) {
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
