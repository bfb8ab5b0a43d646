//! From a spanned tree to typed values: every complaint is noted and reading goes on.

use std::borrow::Cow;
use std::io;

use serde_json::Value as Json;
use straal_color::Space;

use crate::alias::{self, Here};
use crate::diagnostic::{Diagnostic, Diagnostics, Mark, Severity};
use crate::handle::{Handle, Handles, Kind};
use crate::limit::Limit;
use crate::link::Places;
use crate::remedy;
use crate::schema::{Definitions, Properties};
use crate::span::Span;
use crate::suggest;
use crate::tree::{Datum, Entry, Tree, shown};
use crate::value::LinearRgb;
use crate::visit::Visitor;
use crate::writer::{Grown, Line, Writer};

/// A type of the scene language.
///
/// Reading always gives a value: where the tree is wrong a complaint is noted and [`Describe::blank`] stands in, so
/// that the rest is checked as well. Whoever starts the reading looks at the complaints first.
pub trait Describe: Sized {
    /// Whether it is a number, which a texture of colours can't stand for.
    const IS_NUMBER: bool = false;

    /// Reads a value whose numbers must be within `limit`.
    fn read(tree: &Tree, limit: Limit, d: &mut Decoder) -> Self;

    /// What stands in for a value that couldn't be read.
    fn blank() -> Self;

    /// Writes the value as [`Describe::read`] would take it, piece by piece: no more of it is held than what takes it keeps.
    fn write_to(&self, out: &mut dyn Writer);

    /// The same as a tree.
    fn write(&self) -> Json {
        let mut tree = Grown::default();
        self.write_to(&mut tree);
        tree.finish()
    }

    /// The JSON Schema of the values that [`Describe::read`] takes.
    fn schema(limit: Limit, defs: &mut Definitions) -> Json;

    /// Whether nothing at all is a value, because everything in it has a default.
    fn may_be_empty() -> bool {
        false
    }

    /// Shows what is in it to a visitor; nothing, unless it says otherwise. `limit` is what its numbers must be within.
    fn show<'a>(&'a self, _limit: Limit, _visitor: &mut dyn Visitor<'a>) {}

    /// Leads the names in it to what they name; nothing, unless it says otherwise.
    fn lead(&mut self, _places: &Places) {}
}

/// A type that is read from the keys of a mapping, perhaps beside another's.
pub trait Fields: Sized {
    /// Adds the names of its keys.
    fn names(out: &mut Vec<&'static str>);

    /// Reads its own keys.
    fn read_fields(keys: &mut Keys<'_>, d: &mut Decoder) -> Self;

    /// What stands in for a value that couldn't be read.
    fn blank_fields() -> Self;

    /// Writes the keys that differ from their defaults.
    fn write_fields(&self, out: &mut dyn Writer);

    /// Adds its keys to a schema.
    fn schema_fields(out: &mut Properties, defs: &mut Definitions);

    /// Whether all of its keys have defaults.
    fn all_optional() -> bool;

    /// Shows what is in its keys to a visitor.
    fn show_fields<'a>(&'a self, visitor: &mut dyn Visitor<'a>);

    /// Leads the names in its keys to what they name.
    fn lead_fields(&mut self, places: &Places);
}

/// Writes a key and its value.
pub fn write_entry<T: Describe>(key: &str, value: &T, out: &mut dyn Writer) {
    out.key(key);
    value.write_to(out);
}

/// Writes a mapping of one key.
pub fn write_only<T: Describe>(key: &str, value: &T, out: &mut dyn Writer) {
    out.begin_map();
    write_entry(key, value, out);
    out.end_map();
}

/// Writes a list.
pub fn write_list<'a, T: Describe + 'a>(items: impl IntoIterator<Item = &'a T>, out: &mut dyn Writer) {
    out.begin_list();
    items.into_iter().for_each(|item| item.write_to(out));
    out.end_list();
}

/// Writes a value as one line of JSON, piece by piece.
pub fn write_json<T: Describe>(value: &T, out: impl io::Write) -> io::Result<()> {
    let mut line = Line::new(out);
    value.write_to(&mut line);
    line.finish()
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
    /// Handles of the meshes and pictures that were named.
    handles: Handles,
    /// Colours that are told in another form than linear sRGB: a narrow work space may not hold them.
    wide: Vec<Wide>,
}

/// A colour whose place in the work space is known only when the whole scene is read.
#[derive(Clone, Debug)]
struct Wide {
    span: Span,
    key: String,
    color: LinearRgb,
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

    /// The handle of a mesh or picture that goes by a name.
    pub fn handle<T: Kind>(&mut self, name: &str) -> Handle<T> {
        self.handles.of(name)
    }

    /// Notes a colour that the scene's work space may not hold within `limit`.
    pub fn note_wide(&mut self, span: Span, color: LinearRgb, limit: Limit) {
        let key = self.key().to_owned();
        self.wide.push(Wide { span, key, color, limit });
    }

    /// Complains of noted colours that the work space doesn't hold: light can't be below 0, nor a surface reflect more
    /// than falls on it.
    pub(crate) fn check_wide(&mut self, space: Space) {
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
        self.expected_or(what, tree, None);
    }

    /// Whether what is being read stands in the value of any of these keys.
    pub fn is_within(&self, keys: &[&str]) -> bool {
        self.path.iter().any(|(key, _)| keys.contains(&key.as_str()))
    }

    /// The same, with what would be right where that can be told.
    pub fn expected_or(&mut self, what: &str, tree: &Tree, help: Option<String>) {
        let message = match self.path.last() {
            Some((key, _)) => format!("`{key}` must be {what}, found {}", tree.kind()),
            None => format!("a scene must be {what}, found {}", tree.kind()),
        };
        let complaint = Diagnostic::error(self.place(tree), message).label(format!("expected {what}"));
        self.push(complaint.maybe_help(help));
    }

    /// How much was complained of so far, for [`Decoder::rewind`].
    fn complaints(&self) -> (Mark, usize) {
        (self.diagnostics.mark(), self.wide.len())
    }

    /// Forgets what was complained of since, of what is complained of already: a second complaint would not help.
    fn rewind(&mut self, (mark, wide): (Mark, usize)) {
        self.diagnostics.rewind(mark);
        self.wide.truncate(wide);
    }

    /// The text of a value as the scene has it, if it is short enough for a message.
    pub fn quoted(&self, span: Span) -> Option<&str> {
        const LONGEST: usize = 48;
        let text = self.diagnostics.sources.quote(span).trim();
        let is_short = !text.is_empty() && text.len() <= LONGEST && !text.contains(char::is_control);
        is_short.then_some(text)
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
        self.enter(key, span);
        let value = read(self);
        self.path.pop();
        value
    }

    // What is the same for all types is compiled once, apart from what is compiled for each.

    fn enter(&mut self, key: &str, span: Span) {
        self.path.push((suggest::brief(key).into_owned(), span));
    }

    /// A number within `limit`, or `None` after a complaint.
    pub fn number(&mut self, tree: &Tree, limit: Limit) -> Option<f64> {
        let Datum::Number(v) = tree.value else {
            self.expected_or("a number", tree, remedy::number(tree));
            return None;
        };
        if !limit.allows(v) {
            self.push(Diagnostic::error(tree.span, limit.complaint(self.key(), v)));
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
        let Some(mut keys) = self.keys(tree, T::names) else { return T::blank_fields() };
        let before = self.diagnostics.errors();
        keys.complain_of_unknown(self);
        let value = T::read_fields(&mut keys, self);
        if self.diagnostics.errors() == before {
            check(&value, &keys, self);
        }
        value
    }

    /// The keys of a mapping that may have those that `names` adds, or `None` after a complaint.
    fn keys<'t>(&mut self, tree: &'t Tree, names: fn(&mut Vec<&'static str>)) -> Option<Keys<'t>> {
        let mut known = Vec::new();
        names(&mut known);
        let entries = match &tree.value {
            Datum::Mapping(entries) => entries.as_slice(),
            // Everything left to its default: `path:` or the bare word `path`.
            Datum::Null => &[],
            _ => {
                let help = remedy::mapping(tree, &known).or_else(|| {
                    let value = self.quoted(tree.span).unwrap_or_default();
                    remedy::main_key(tree, self.key(), value)
                });
                self.expected_or("a mapping of keys to values", tree, help);
                return None;
            }
        };
        Some(Keys { names: known, ..Keys::new(entries, self.owner(tree)) })
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
                [entry] if !is_type(entry) => (&entry.key.value, entry.key.span, Cow::Borrowed(&entry.value)),
                [first, second, ..] if !entries.iter().any(is_type) => {
                    self.push(several(self.key(), first, second, kinds));
                    return None;
                }
                [] => {
                    self.expected(&format!("one of {}", suggest::list(kinds.iter().copied())), tree);
                    return None;
                }
                entries => {
                    self.push(typed(entries, kinds));
                    return None;
                }
            },
            _ => {
                let help = remedy::choice(tree, kinds);
                self.expected_or(&format!("one of {}", suggest::list(kinds.iter().copied())), tree, help);
                return None;
            }
        };
        if let Some(kind) = kinds.iter().find(|k| *k == key) {
            return Some(Choice { kind, span, payload });
        }
        let shown = suggest::brief(key).into_owned();
        if let Some(kind) = kinds.iter().find(|k| suggest::is_same(k, key)) {
            let help = format!("write `{kind}`: small letters, and `_` between words");
            self.push(Diagnostic::error(span, format!("`{shown}` is written `{kind}`")).help(help));
            return Some(Choice { kind, span, payload });
        }
        let message = format!("unknown `{shown}` in `{}`", self.key()).replace("`the scene`", "the scene");
        let complaint = match alias::of_kind(key, kinds) {
            Some(Here::Called(kind)) => Diagnostic::error(span, format!("`{shown}` is called `{kind}` here"))
                .help(format!("write `{kind}` in its place")),
            Some(Here::Write(what)) => Diagnostic::error(span, message).help(to_write(what)),
            Some(Here::NotYet(what)) => not_yet(span, &shown, what),
            None => {
                let colour = remedy::colour_for_material(tree, kinds);
                let help = colour.or_else(|| self.help(key, kinds, "it can be", kinds));
                Diagnostic::error(span, message).maybe_help(help)
            }
        };
        self.push(complaint);
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

/// Whether a key says of which kind something is, as other languages do.
fn is_type(entry: &Entry) -> bool {
    ["type", "kind"].iter().any(|word| suggest::is_same(&entry.key.value, word))
}

/// The complaint of a kind that is said by `type`.
fn typed(entries: &[Entry], kinds: &[&str]) -> Diagnostic {
    let at = entries.iter().find(|e| is_type(e));
    let span = at.map_or(Span::NONE, |e| e.key.span);
    let message = "the kind of a thing is its key here, and all else stands inside";
    let said = match at.map(|e| &e.value.value) {
        Some(Datum::String(word)) => word.as_str(),
        _ => "",
    };
    let known = kinds.iter().copied().find(|k| suggest::is_same(k, said));
    let help = match (known, alias::of_kind(said, kinds)) {
        (Some(kind), _) | (None, Some(Here::Called(kind))) => {
            let rest = entries.iter().find(|e| !is_type(e)).map(|e| suggest::brief(&e.key.value));
            let inside = rest.map_or("...".to_owned(), |key| format!("{key}: ..."));
            format!("write `{kind}: {{ {inside} }}`")
        }
        (None, Some(Here::Write(what))) => to_write(what),
        (None, Some(Here::NotYet(what))) => format!("not supported yet: {what}"),
        (None, None) => format!("it can be {}", suggest::list(kinds.iter().copied())),
    };
    Diagnostic::error(span, message).help(help)
}

/// The complaint of two keys where one kind must be chosen.
fn several(owner: &str, first: &Entry, second: &Entry, kinds: &[&str]) -> Diagnostic {
    let (a, b) = (suggest::brief(&first.key.value), suggest::brief(&second.key.value));
    let known = |e: &Entry| kinds.contains(&e.key.value.as_str());
    if !known(first) && !known(second) {
        let all = suggest::list(kinds.iter().copied());
        let nearly = kinds
            .iter()
            .find(|k| suggest::is_same(k, &first.key.value) || suggest::is_same(k, &second.key.value));
        let help = match (nearly, alias::of_kind(&first.key.value, kinds)) {
            (Some(kind), _) => format!("write `{kind}`, and all else inside of it"),
            (None, Some(Here::Write(what))) => to_write(what),
            (None, Some(Here::Called(kind))) => format!("write `{kind}: {{ {b}: ... }}`"),
            _ => format!(
                "write the kind around them, such as `{}: {{ {a}: ... }}`; it can be {all}",
                kinds.first().unwrap_or(&"")
            ),
        };
        let message = format!("`{owner}` must say first of which kind it is, and found `{a}` and `{b}`");
        return Diagnostic::error(first.key.span, message).help(help);
    }
    let message = format!("`{a}` and `{b}` stand together where one is expected");
    let help = if known(first) && known(second) {
        "begin each with a `- ` of its own".to_owned()
    } else if known(first) {
        format!("indent `{b}` to make it a key of `{a}`")
    } else {
        format!("indent `{a}` to make it a key of `{b}`")
    };
    Diagnostic::error(second.key.span, message).related(first.key.span, "the first is here").help(help)
}

/// How what is to be written is told.
fn to_write(what: &str) -> String {
    match what.strip_prefix("nothing: ") {
        Some(why) => format!("leave it out: {why}"),
        None if what.starts_with('`') || what.starts_with("a comment") => format!("write {what}"),
        None => what.to_owned(),
    }
}

fn not_yet(span: Span, word: &str, what: &str) -> Diagnostic {
    Diagnostic::error(span, format!("`{word}` is not supported yet"))
        .help(format!("straal has no {what} so far"))
}

/// The keys of a mapping while they are read.
#[derive(Debug)]
pub struct Keys<'a> {
    entries: &'a [Entry],
    /// All that may be there.
    names: Vec<&'static str>,
    /// Those of them that are there, once it is asked which.
    present: Vec<&'static str>,
    owner: Span,
    /// What keys that are complained of were meant to be.
    meant: Vec<Meant<'a>>,
    /// What a complaint has told to write, so that it need not be missed as well.
    told: Vec<&'static str>,
}

/// A key that is wrong, and the name of the right one.
#[derive(Debug)]
struct Meant<'a> {
    entry: &'a Entry,
    name: &'static str,
    /// Whether the value is what belongs there, so that what is wrong in it is worth telling.
    is_sure: bool,
}

impl<'a> Keys<'a> {
    fn new(entries: &'a [Entry], owner: Span) -> Self {
        Self { entries, names: Vec::new(), present: Vec::new(), owner, meant: Vec::new(), told: Vec::new() }
    }

    /// Reads the value of a key; without it, `default`'s, or a complaint when there is none.
    pub fn field<T: Describe>(
        &mut self,
        key: &'static str,
        limit: Limit,
        default: Option<fn() -> T>,
        d: &mut Decoder,
    ) -> T {
        let Some((entry, is_sure)) = self.entry(key) else {
            return default.map_or_else(
                || {
                    self.miss(key, d);
                    T::blank()
                },
                |default| default(),
            );
        };
        let before = d.complaints();
        let value = d.under(key, entry.key.span, |d| T::read(&entry.value, limit, d));
        if !is_sure {
            d.rewind(before);
        }
        value
    }

    /// What is written for a key, and whether it is worth telling what is wrong in it.
    fn entry(&self, key: &str) -> Option<(&'a Entry, bool)> {
        match self.meant.iter().find(|m| m.name == key) {
            Some(meant) => Some((meant.entry, meant.is_sure)),
            None => self.entries.iter().find(|e| e.key.value == key).map(|e| (e, true)),
        }
    }

    /// Complains that a key isn't there.
    fn miss(&self, key: &str, d: &mut Decoder) {
        let quoted = format!("`{key}`");
        if self.told.iter().any(|text| text.contains(&quoted)) {
            return;
        }
        let message = format!("`{}` needs `{key}`", d.key());
        d.push(Diagnostic::error(self.owner, message.replace("`the scene`", "the scene")));
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

    fn complain_of_unknown(&mut self, d: &mut Decoder) {
        // Looked up once: a mapping may have a hundred thousand keys that nobody knows.
        let is_there = |name: &&str| self.entries.iter().any(|e| e.key.value == *name);
        self.present = self.names.iter().copied().filter(is_there).collect();
        let mut rest = self.entries;
        while let [entry, after @ ..] = rest {
            rest = after;
            // A list without brackets, `center: 1, 2, 3`, is a key with the first number and then numbers that look like keys.
            let loose = match remedy::begins_list(&entry.value) {
                true => after.iter().take_while(|e| is_loose_number(e)).count(),
                false => 0,
            };
            if loose > 0 {
                rest = &after[loose..];
                let name = self.called(&entry.key.value, d.key());
                d.push(without_brackets(name.unwrap_or(&entry.key.value), entry, &after[..loose], d));
                self.meant.extend(name.map(|name| Meant { entry, name, is_sure: false }));
                continue;
            }
            if self.names.contains(&entry.key.value.as_str()) {
                continue;
            }
            if d.diagnostics.is_full() {
                // Only counted.
                let severity = if d.strictness.lenient { Severity::Warning } else { Severity::Error };
                d.push(Diagnostic { severity, ..Diagnostic::error(entry.key.span, "unknown key") });
                continue;
            }
            let (complaint, meant, told) = self.unknown(entry, d);
            // Two keys that are told by one, such as `width` and `height`, need one complaint.
            if told.is_some_and(|text| self.told.contains(&text)) {
                continue;
            }
            self.told.extend(told);
            // A guess must not become part of a scene that is rendered.
            if d.strictness.lenient {
                d.push(Diagnostic { severity: Severity::Warning, ..complaint });
            } else {
                self.meant.extend(meant);
                d.push(complaint);
            }
        }
    }

    /// The name of the key that a word is, or is meant to be.
    fn called(&self, word: &str, owner: &str) -> Option<&'static str> {
        let own = self.names.iter().copied().find(|n| suggest::is_same(n, word));
        own.or_else(|| match alias::of_key(word, owner, &self.names) {
            Some(Here::Called(name)) => Some(name),
            _ => None,
        })
    }

    /// What is said of a key that nobody knows, what it was meant to be, and what to write in place of it.
    fn unknown(
        &self,
        entry: &'a Entry,
        d: &Decoder,
    ) -> (Diagnostic, Option<Meant<'a>>, Option<&'static str>) {
        let (key, span) = (entry.key.value.as_str(), entry.key.span);
        let shown = suggest::brief(key);
        let is_free =
            |name: &str| !self.present.contains(&name) && !self.meant.iter().any(|m| m.name == name);
        let meant = |name: &'static str, is_sure| is_free(name).then_some(Meant { entry, name, is_sure });
        let instead = |name: &str| {
            if let Some(other) = self.meant.iter().find(|m| m.name == name) {
                let other = suggest::brief(&other.entry.key.value);
                return format!("`{other}` is as well: one `{name}` says both");
            }
            if !is_free(name) {
                return format!("`{name}` is there already: leave one of them out");
            }
            // What begins on a line of its own would read badly.
            let between = Span { start: span.end, end: entry.value.span.start, ..span };
            let joined = !d.diagnostics.sources.quote(between).contains('\n');
            match d.quoted(entry.value.span) {
                Some(value) if joined && entry.value.value != Datum::Null => {
                    format!("write `{name}: {value}`")
                }
                _ => format!("write `{name}` in its place"),
            }
        };
        if let Some(name) = self.names.iter().find(|n| suggest::is_same(n, key)) {
            let complaint = Diagnostic::error(span, format!("`{shown}` is written `{name}`"));
            return (complaint.help(instead(name)), meant(name, true), None);
        }
        let message = format!("unknown key `{shown}` in `{}`", d.key()).replace("`the scene`", "the scene");
        match alias::of_key(key, d.key(), &self.names) {
            Some(Here::Called(name)) => {
                let complaint = Diagnostic::error(span, format!("`{shown}` is called `{name}` here"));
                return (complaint.help(instead(name)), meant(name, false), None);
            }
            Some(Here::Write(what)) => {
                return (Diagnostic::error(span, message).help(to_write(what)), None, Some(what));
            }
            Some(Here::NotYet(what)) => return (not_yet(span, &shown, what), None, None),
            None => {}
        }
        // What is inside is worth reading, a lone value isn't.
        let has_parts = matches!(entry.value.value, Datum::Mapping(_) | Datum::Sequence(_));
        let absent: Vec<&'static str> = self.names.iter().copied().filter(|n| is_free(n)).collect();
        let near = suggest::nearest(key, absent.iter().copied());
        let name = near.and_then(|near| absent.iter().copied().find(|n| *n == near));
        let help = d.help(key, &absent, "the keys are", &self.names);
        (
            Diagnostic::error(span, message).maybe_help(help),
            name.and_then(|name| meant(name, has_parts)),
            None,
        )
    }
}

/// A key that is a number, perhaps with the end of a bracket, and nothing after it.
fn is_loose_number(entry: &Entry) -> bool {
    entry.value.value == Datum::Null && remedy::loose_number(&entry.key.value).is_some()
}

/// The complaint of a list whose brackets are missing.
fn without_brackets(name: &str, entry: &Entry, rest: &[Entry], d: &Decoder) -> Diagnostic {
    let (key, name) = (suggest::brief(&entry.key.value), suggest::brief(name));
    let span = rest.last().map_or(entry.value.span, |last| entry.value.span.to(last.key.span));
    // As it was written: a number that is there twice is one key.
    let text = d.quoted(span).unwrap_or_default();
    let numbers = text.rsplit(['<', '(']).next().unwrap_or_default().trim_end_matches(['>', ')', ' ']);
    Diagnostic::error(span, format!("the numbers of `{key}` need brackets around them"))
        .help(format!("write `{name}: [{numbers}]`"))
}
