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
    /// Bytes that it takes, without those of itself.
    pub fn heap_bytes(&self) -> u64 {
        // What the allocator takes beside each piece.
        const PIECE: usize = 16;
        match &self.value {
            Datum::Null | Datum::Bool(_) | Datum::Number(_) => 0,
            Datum::String(text) => (text.capacity() + PIECE) as u64,
            Datum::Sequence(list) => {
                let own = (list.capacity() * size_of::<Self>() + PIECE) as u64;
                list.iter().fold(own, |sum, tree| sum + tree.heap_bytes())
            }
            Datum::Mapping(entries) => {
                let own = (entries.capacity() * size_of::<Entry>() + PIECE) as u64;
                let each = |e: &Entry| (e.key.value.capacity() + PIECE) as u64 + e.value.heap_bytes();
                entries.iter().fold(own, |sum, entry| sum + each(entry))
            }
        }
    }

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
