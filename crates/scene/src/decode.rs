//! From a spanned tree to typed values: every complaint is noted and reading goes on.

use std::borrow::Cow;

use serde_json::{Map, Value as Json};
use straal_color::Space;

use crate::desc::{Integrator, Light, Scene};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::limit::Limit;
use crate::schema::{Definitions, Properties};
use crate::span::Span;
use crate::suggest;
use crate::tree::{Datum, Entry, Tree, shown};
use crate::validate;
use crate::value::Color;

/// A type of the scene language.
///
/// Reading always gives a value: where the tree is wrong a complaint is noted and [`Describe::blank`] stands in, so
/// that the rest is checked as well. Whoever starts the reading looks at the complaints first.
pub trait Describe: Sized {
    /// Reads a value whose numbers must be within `limit`.
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self;

    /// What stands in for a value that couldn't be read.
    fn blank() -> Self;

    /// The value as [`Describe::read`] would take it.
    fn write(&self) -> Json;

    /// The JSON Schema of the values that [`Describe::read`] takes.
    fn schema(limit: Limit, defs: &mut Definitions) -> Json;

    /// Whether nothing at all is a value, because everything in it has a default.
    fn may_be_empty() -> bool {
        false
    }
}

/// A type that is read from the keys of a mapping, perhaps beside another's.
pub trait Fields: Sized {
    /// Reads its own keys.
    fn read_fields(keys: &mut Keys<'_>, d: &mut Decoder) -> Self;

    /// What stands in for a value that couldn't be read.
    fn blank_fields() -> Self;

    /// Writes the keys that differ from their defaults.
    fn write_fields(&self, out: &mut Map<String, Json>);

    /// Adds its keys to a schema.
    fn schema_fields(out: &mut Properties, defs: &mut Definitions);

    /// Whether all of its keys have defaults.
    fn all_optional() -> bool;
}

/// How to read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Strictness {
    /// Whether unknown keys are only warned of.
    pub lenient: bool,
}

/// Collects complaints while a tree is read.
#[derive(Debug, Default)]
pub struct Decoder {
    /// What was complained of so far.
    pub diagnostics: Diagnostics,
    strictness: Strictness,
    /// The keys on the way to the value being read, each with its place.
    path: Vec<(String, Span)>,
    /// Colours that are told in another form than linear sRGB: a narrow work space may not hold them.
    wide: Vec<Wide>,
}

/// A colour whose place in the work space is known only when the whole scene is read.
#[derive(Clone, Debug)]
struct Wide {
    span: Span,
    key: String,
    color: Color,
    limit: Limit,
}

impl Decoder {
    /// A reader that adds to `diagnostics`.
    pub fn new(diagnostics: Diagnostics, strictness: Strictness) -> Self {
        Self { diagnostics, strictness, ..Self::default() }
    }

    /// Notes a complaint.
    pub fn push(&mut self, d: Diagnostic) {
        self.diagnostics.push(d);
    }

    /// Notes a colour that the scene's work space may not hold within `limit`.
    pub fn note_wide(&mut self, span: Span, color: Color, limit: Limit) {
        let key = self.key().to_owned();
        self.wide.push(Wide { span, key, color, limit });
    }

    /// Complains of noted colours that the work space doesn't hold: light can't be below 0, nor a surface reflect more
    /// than falls on it.
    fn check_wide(&mut self, space: Space) {
        for Wide { span, key, color, limit } in std::mem::take(&mut self.wide) {
            // Conversions round: this much is no fault of the scene's.
            const SLACK: f64 = 1e-6;
            let holds = |space: Space| {
                let inside = |v: &f64| *v >= limit.min - SLACK && *v <= limit.max + SLACK && v.is_finite();
                Space::Srgb.to(space).apply(color.0).iter().all(inside)
            };
            if holds(space) {
                continue;
            }
            let [r, g, b] = Space::Srgb.to(space).apply(color.0).map(|v| (v * 1e4).round() / 1e4);
            let message = format!(
                "`{key}` is beyond the work space `{}`: its linear RGB there is [{r}, {g}, {b}], and must be {limit}",
                space.name()
            );
            let other = Space::ALL.into_iter().find(|s| holds(*s));
            let help =
                other.map(|s| format!("`color: {{ space: {} }}` at the top of the scene holds it", s.name()));
            self.push(Diagnostic::error(span, message).maybe_help(help));
        }
    }

    /// The key whose value is being read, for messages.
    pub fn key(&self) -> &str {
        self.path.last().map_or("the scene", |p| p.0.as_str())
    }

    /// Notes that a value isn't of the type that is expected.
    pub fn expected(&mut self, what: &str, tree: &Tree) {
        let message = match self.path.last() {
            Some((key, _)) => format!("`{key}` must be {what}, found {}", tree.kind()),
            None => format!("a scene must be {what}, found {}", tree.kind()),
        };
        self.push(Diagnostic::error(self.place(tree), message).label(format!("expected {what}")));
    }

    /// Where to point for a value: what is left out has no extent, so its key is shown.
    pub fn place(&self, tree: &Tree) -> Span {
        match self.path.last() {
            Some((_, key)) if tree.value == Datum::Null && tree.span.start == tree.span.end => *key,
            _ => tree.span,
        }
    }

    /// Reads with `key` as the key that messages name.
    pub fn under<T>(&mut self, key: &str, span: Span, read: impl FnOnce(&mut Self) -> T) -> T {
        self.path.push((suggest::brief(key).into_owned(), span));
        let value = read(self);
        self.path.pop();
        value
    }

    /// A number within `limit`, or `None` after a complaint.
    pub fn number(&mut self, tree: &Tree, limit: Limit) -> Option<f64> {
        let Datum::Number(v) = tree.value else {
            self.expected("a number", tree);
            return None;
        };
        if !limit.allows(v) {
            let range = match v {
                _ if !v.is_finite() => "finite".to_owned(),
                _ if !(v as f32).is_finite() => Limit::FINITE.to_string(),
                _ => limit.to_string(),
            };
            let message = format!("`{}` must be {range}, found {}", self.key(), shown(v));
            self.push(Diagnostic::error(tree.span, message));
            return None;
        }
        Some(v)
    }

    /// A whole number within `limit`, or `None` after a complaint.
    pub fn integer(&mut self, tree: &Tree, limit: Limit) -> Option<u64> {
        let v = self.number(tree, limit)?;
        const EXACT: f64 = 9_007_199_254_740_992.0;
        if v < 0.0 || v.floor() != v || v > EXACT {
            let message = format!("`{}` must be a whole number, found {}", self.key(), shown(v));
            self.push(Diagnostic::error(tree.span, message));
            return None;
        }
        Some(v as u64)
    }

    /// The items of a list, or `None` after a complaint. `what` says what is expected.
    pub fn list<'a>(&mut self, tree: &'a Tree, what: &str) -> Option<&'a [Tree]> {
        match &tree.value {
            Datum::Sequence(items) => Some(items),
            _ => {
                self.expected(what, tree);
                None
            }
        }
    }

    /// Reads a mapping by the keys of `T`, complains of keys that nobody knows, and calls `check` on the whole when
    /// its parts are sound.
    pub fn fields<T: Fields>(&mut self, tree: &Tree, check: fn(&T, &Keys<'_>, &mut Self)) -> T {
        let mut keys = match &tree.value {
            Datum::Mapping(entries) => Keys::new(entries, self.owner(tree)),
            // Everything left to its default: `path:` or the bare word `path`.
            Datum::Null => Keys::new(&[], self.owner(tree)),
            _ => {
                self.expected("a mapping of keys to values", tree);
                return T::blank_fields();
            }
        };
        let before = self.diagnostics.errors();
        let value = T::read_fields(&mut keys, self);
        keys.complain_of_unknown(self);
        if self.diagnostics.errors() == before {
            check(&value, &keys, self);
        }
        value
    }

    fn owner(&self, tree: &Tree) -> Span {
        self.path.last().map_or(Span { end: tree.span.start, ..tree.span }, |p| p.1)
    }

    /// Reads an externally tagged choice: gives the position of its key in `kinds` and the payload's tree, or `None`
    /// after a complaint. A bare word is a key without payload.
    pub fn choice<'a>(&mut self, tree: &'a Tree, kinds: &[&'static str]) -> Option<Choice<'a>> {
        let (key, span, payload) = match &tree.value {
            Datum::String(word) => {
                (word, tree.span, Cow::Owned(Tree { value: Datum::Null, span: tree.span }))
            }
            Datum::Mapping(entries) => match entries.as_slice() {
                [entry] => (&entry.key.value, entry.key.span, Cow::Borrowed(&entry.value)),
                [] => {
                    self.expected(&format!("one of {}", suggest::list(kinds.iter().copied())), tree);
                    return None;
                }
                [first, second, ..] => {
                    self.push(several(first, second, kinds));
                    return None;
                }
            },
            _ => {
                self.expected(&format!("one of {}", suggest::list(kinds.iter().copied())), tree);
                return None;
            }
        };
        if let Some(kind) = kinds.iter().find(|k| *k == key) {
            return Some(Choice { kind, span, payload });
        }
        let message = format!("unknown `{}` in `{}`", suggest::brief(key), self.key());
        let help = self.help(key, kinds, "it can be", kinds);
        self.push(Diagnostic::error(span, message).maybe_help(help));
        None
    }

    /// Which of the words that would be right is near, or `otherwise` and all words; nothing when nobody would see it.
    fn help(&self, word: &str, right: &[&str], otherwise: &str, all: &[&str]) -> Option<String> {
        if self.diagnostics.is_full() {
            return None;
        }
        let near = suggest::did_you_mean(word, right.iter().copied());
        near.or_else(|| Some(format!("{otherwise} {}", suggest::list(all.iter().copied()))))
    }
}

/// An externally tagged choice.
#[derive(Clone, Debug)]
pub struct Choice<'a> {
    /// The key: one of those that were offered.
    pub kind: &'static str,
    /// Where the key stands.
    pub span: Span,
    /// What it stands for.
    pub payload: Cow<'a, Tree>,
}

impl Choice<'_> {
    /// Reads the payload.
    pub fn read<T: Describe>(&self, d: &mut Decoder) -> T {
        d.under(self.kind, self.span, |d| T::read(&self.payload, Limit::FINITE, d))
    }

    /// Complains of a payload where none belongs.
    pub fn nothing(&self, d: &mut Decoder) {
        let empty = match &self.payload.value {
            Datum::Null => true,
            Datum::Mapping(entries) => entries.is_empty(),
            _ => false,
        };
        if !empty {
            let message = format!("`{}` takes nothing, found {}", self.kind, self.payload.kind());
            d.push(Diagnostic::error(self.payload.span, message).help(format!("write only `{}`", self.kind)));
        }
    }
}

/// The complaint of two keys where one kind must be chosen.
fn several(first: &Entry, second: &Entry, kinds: &[&str]) -> Diagnostic {
    let (a, b) = (suggest::brief(&first.key.value), suggest::brief(&second.key.value));
    let message = format!("`{a}` and `{b}` stand together where one is expected");
    let known = |e: &Entry| kinds.contains(&e.key.value.as_str());
    let help = if known(first) && known(second) {
        "begin each with a `- ` of its own".to_owned()
    } else if known(first) {
        format!("indent `{b}` to make it a key of `{a}`")
    } else {
        format!("it can be {}", suggest::list(kinds.iter().copied()))
    };
    Diagnostic::error(second.key.span, message).related(first.key.span, "the first is here").help(help)
}

/// The keys of a mapping while they are read.
#[derive(Debug)]
pub struct Keys<'a> {
    entries: &'a [Entry],
    known: Vec<&'static str>,
    owner: Span,
}

impl<'a> Keys<'a> {
    fn new(entries: &'a [Entry], owner: Span) -> Self {
        Self { entries, known: Vec::new(), owner }
    }

    /// Reads the value of a key; without it, `default`'s, or a complaint when there is none.
    pub fn field<T: Describe>(
        &mut self,
        key: &'static str,
        limit: Limit,
        default: Option<fn() -> T>,
        d: &mut Decoder,
    ) -> T {
        self.known.push(key);
        let found = self.entries.iter().find(|e| e.key.value == key);
        match (found, default) {
            (Some(e), _) => d.under(key, e.key.span, |d| T::read(&e.value, limit, d)),
            (None, Some(default)) => default(),
            (None, None) => {
                let message = format!("`{}` needs `{key}`", d.key());
                d.push(Diagnostic::error(self.owner, message.replace("`the scene`", "the scene")));
                T::blank()
            }
        }
    }

    /// Where the value of a key stands, or the whole when the key is absent.
    pub fn span(&self, key: &str) -> Span {
        self.entries.iter().find(|e| e.key.value == key).map_or(self.owner, |e| e.value.span)
    }

    /// Where a key itself stands, or the whole when it is absent.
    pub fn key_span(&self, key: &str) -> Span {
        self.entries.iter().find(|e| e.key.value == key).map_or(self.owner, |e| e.key.span)
    }

    /// The key, or start, of the whole.
    pub fn owner(&self) -> Span {
        self.owner
    }

    fn complain_of_unknown(&self, d: &mut Decoder) {
        let is_absent = |k: &&str| !self.entries.iter().any(|e| e.key.value == **k);
        let absent: Vec<&str> = self.known.iter().copied().filter(is_absent).collect();
        for entry in self.entries {
            let key = entry.key.value.as_str();
            if self.known.contains(&key) {
                continue;
            }
            let shown = suggest::brief(key);
            let message =
                format!("unknown key `{shown}` in `{}`", d.key()).replace("`the scene`", "the scene");
            let near = d.help(key, &absent, "the keys are", &self.known);
            let complaint = if d.strictness.lenient {
                Diagnostic::warning(entry.key.span, message)
            } else {
                Diagnostic::error(entry.key.span, message)
            };
            d.push(complaint.maybe_help(near));
        }
    }
}

/// Reads a scene and checks it as a whole. The scene is only of use when there are no errors among the complaints;
/// it is given all the same, so that the files it names can be looked for too.
pub fn read_scene(tree: &Tree, diagnostics: Diagnostics, strictness: Strictness) -> (Scene, Diagnostics) {
    let mut decoder = Decoder::new(diagnostics, strictness);
    let scene = Scene::read(tree, Limit::FINITE, &mut decoder);
    decoder.check_wide(scene.color.space.space());
    let mut diagnostics = decoder.diagnostics;
    let (at, nothing) = match tree.entry("world") {
        Some(e) => (e.key.span, e.value.value == Datum::Null || e.value.value == Datum::Sequence(Vec::new())),
        None => (
            Span { end: tree.span.start, ..tree.span },
            matches!(tree.value, Datum::Mapping(_) | Datum::Null),
        ),
    };
    let lit_by_all = scene.lights.iter().any(|l| matches!(l, Light::Environment(_)));
    let shows_a_chart = matches!(scene.integrator, Integrator::SineProduct);
    if nothing && !lit_by_all && !shows_a_chart {
        let help = "list shapes under `world:`, such as `- sphere: { radius: 1 }`";
        diagnostics.push(Diagnostic::error(at, "the world is empty: there is nothing to see").help(help));
    }
    validate::validate(&scene, &mut diagnostics);
    (scene, diagnostics)
}
