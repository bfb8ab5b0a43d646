//! A text format's values with their places: what every reader of scenes makes first.

use crate::span::{Span, Spanned};
use crate::suggest::brief;

/// A value and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// The value.
    pub value: Datum,
    /// Where it stands.
    pub span: Span,
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub enum Datum {
    /// Nothing.
    Null,
    /// True or false.
    Bool(bool),
    /// A number. Whole numbers are exact up to 2^53, as in JSON.
    Number(f64),
    /// Text.
    String(String),
    /// A list.
    Sequence(Vec<Tree>),
    /// Keys with values, in the order of the text; no key occurs twice.
    Mapping(Vec<Entry>),
}

/// A key and its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: Spanned<String>,
    /// What it stands for.
    pub value: Tree,
}

/// A number as people write it: very large and small ones with an exponent.
pub fn shown(v: f64) -> String {
    let size = v.abs();
    if v.is_finite() && size != 0.0 && !(1e-4..1e16).contains(&size) {
        format!("{v:e}")
    } else {
        v.to_string()
    }
}

impl Tree {
    /// A key and its value, when this is a mapping that has it.
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        match &self.value {
            Datum::Mapping(entries) => entries.iter().find(|e| e.key.value == key),
            _ => None,
        }
    }

    /// What this is, as messages call it.
    pub fn kind(&self) -> String {
        match &self.value {
            Datum::Null => "nothing".to_owned(),
            Datum::Bool(b) => format!("`{b}`"),
            Datum::Number(n) => format!("the number {}", shown(*n)),
            Datum::String(s) => format!("the text `{}`", brief(s)),
            Datum::Sequence(v) if v.len() == 1 => "a list of 1".to_owned(),
            Datum::Sequence(v) => format!("a list of {}", v.len()),
            Datum::Mapping(_) => "a mapping of keys to values".to_owned(),
        }
    }
}
