//! How the small values of descriptions are read, written and described: here numbers, words and lists.

mod colours;
mod names;
mod space;

use serde_json::{Value as Json, json};

use crate::decode::{Decoder, Describe, write_list};
use crate::diagnostic::Diagnostic;
use crate::limit::Limit;
use crate::link::Places;
use crate::remedy;
use crate::schema;
use crate::schema::Definitions;
use crate::span::{Span, Spanned};
use crate::tree::{Datum, Tree};
use crate::value::Depth;
use crate::visit::Visitor;
use crate::writer::Writer;

impl Describe for f64 {
    const IS_NUMBER: bool = true;
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        d.number(tree, limit).unwrap_or_else(Self::blank)
    }
    fn blank() -> Self {
        1.0
    }
    fn write_to(&self, out: &mut dyn Writer) {
        schema::write_number(*self, out);
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
            fn write_to(&self, out: &mut dyn Writer) {
                out.count(u64::from(*self));
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
    fn write_to(&self, out: &mut dyn Writer) {
        out.truth(*self);
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
    fn write_to(&self, out: &mut dyn Writer) {
        out.text(&self.value);
    }
    fn schema(_: Limit, _: &mut Definitions) -> Json {
        json!({ "type": "string", "minLength": 1 })
    }
}

impl<T: Describe> Describe for Option<T> {
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self {
        (tree.value != Datum::Null).then(|| T::read(tree, limit, d))
    }
    fn blank() -> Self {
        None
    }
    fn write_to(&self, out: &mut dyn Writer) {
        match self {
            Some(value) => value.write_to(out),
            None => out.null(),
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
    fn write_to(&self, out: &mut dyn Writer) {
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
    fn write_to(&self, out: &mut dyn Writer) {
        write_list(self, out);
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
    fn write_to(&self, out: &mut dyn Writer) {
        write_list(self, out);
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
    fn write_to(&self, out: &mut dyn Writer) {
        match self {
            Self::Unlimited => out.text("unlimited"),
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
