//! YAML 1.2, and with it JSON, into a tree of values that know where they stand.
//!
//! Broken syntax ends the reading at the first error. What is well formed but has no place in a scene (a key twice,
//! a tag, a merge key) is complained of and passed over.

mod other;
mod scalar;
mod write;

pub(crate) use other::is_of_another_program;
pub use scalar::resolve;
pub use write::write;

use std::collections::HashMap;
use std::ops::Range;

use saphyr_parser::{Event, Parser, ScalarStyle, Span as Marks, Tag};
use straal_scene::diagnostic::start_of;
use straal_scene::tree::{Datum, Entry, Tree};
use straal_scene::{Diagnostic, Diagnostics, FileId, Span, Spanned, suggest};

/// How much a text may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most values, those that aliases repeat counted each time; a long text counts as several. One takes 40 bytes.
    pub nodes: usize,
    /// Most lists and mappings inside one another.
    pub depth: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { nodes: 5_000_000, depth: 100 }
    }
}

/// Reads the text of a file that is kept in `d.sources`. `None` when it can't be read on; errors are in `d`.
pub fn read(file: FileId, limits: &Limits, d: &mut Diagnostics) -> Option<Tree> {
    let text = d.sources.text(file).to_owned();
    if let Some((at, c)) = text.char_indices().find(|&(_, c)| is_forbidden(c)) {
        let span = span(file, at, at + c.len_utf8());
        let message = format!("the control character U+{:04X} has no place in a text file", c as u32);
        d.push(Diagnostic::error(span, message));
        return None;
    }
    if let Some(complaint) = other::program(file, &text) {
        d.push(complaint);
        return None;
    }
    let mut builder = Builder {
        file,
        offsets: Offsets::new(&text),
        limits: *limits,
        budget: limits.nodes,
        open: Vec::new(),
        anchors: HashMap::new(),
        root: None,
        d,
    };
    let mut documents = 0;
    for event in Parser::new_from_str(&text) {
        match event {
            Ok((Event::DocumentStart(_), marks)) => {
                documents += 1;
                if documents > 1 {
                    let span = builder.span(&marks);
                    let message = "a second document begins here, but a file holds one scene";
                    builder.d.push(Diagnostic::error(span, message));
                    return None;
                }
            }
            Ok((event, marks)) => {
                if let Err(stop) = builder.event(event, &marks) {
                    builder.d.push(*stop);
                    return None;
                }
            }
            Err(e) => {
                let at = builder.offsets.byte(e.marker().index());
                let end = at + text[at..].chars().next().map_or(0, char::len_utf8);
                let at = span(file, at, end);
                // The parser looks ahead, and has a limit of its own.
                let deep = e.info().contains("recursion limit");
                builder.d.push(match comment_for_colour(&text[..end]) {
                    _ if deep => too_deep(at, limits),
                    // It takes away what would have closed a bracket.
                    Some(colour) => in_quotes(span(file, colour.start, colour.end), &text[colour]),
                    None => syntax(at, e.info()),
                });
                return None;
            }
        }
    }
    // A file of nothing but comments says nothing.
    Some(builder.root.unwrap_or(Tree { value: Datum::Null, span: start_of(file) }))
}

fn span(file: FileId, start: usize, end: usize) -> Span {
    let clamp = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    Span { file, start: clamp(start), end: clamp(end) }
}

/// What YAML 1.2 (5.1) leaves out of its character set, as far as it is a control character.
fn is_forbidden(c: char) -> bool {
    c.is_control() && !matches!(c, '\t' | '\n' | '\r' | '\u{85}')
}

/// The last `#rrggbb` of a text that stands where a value should, but begins a comment.
fn comment_for_colour(text: &str) -> Option<Range<usize>> {
    let mut found = None;
    for (i, _) in text.match_indices('#') {
        let before = text[..i].trim_end_matches([' ', '\t']);
        if before.len() < i
            && before.ends_with([':', ',', '[', '-'])
            && let Some(colour) = colour_at(text, i)
        {
            found = Some(colour);
        }
    }
    found
}

/// A `#` with three, four, six or eight hexadecimal digits and nothing joined to them.
fn colour_at(text: &str, at: usize) -> Option<Range<usize>> {
    let digits = text.get(at..)?.strip_prefix('#')?;
    let count = digits.bytes().take_while(u8::is_ascii_hexdigit).count();
    let joined = digits[count..].starts_with(|c: char| c.is_alphanumeric());
    ([3, 4, 6, 8].contains(&count) && !joined).then_some(at..at + 1 + count)
}

fn in_quotes(at: Span, colour: &str) -> Diagnostic {
    let message = format!("`{colour}` is not read: `#` begins a comment");
    Diagnostic::error(at, message).help(format!("write '{colour}', in quotes"))
}

fn too_deep(at: Span, limits: &Limits) -> Diagnostic {
    Diagnostic::error(at, format!("lists and mappings nest deeper than {} levels", limits.depth))
}

fn syntax(span: Span, info: &str) -> Diagnostic {
    let info = info.trim_end_matches('.');
    let help = if info.contains("tab") {
        "indent with spaces"
    } else if info.contains("while parsing a flow") || info.contains("',' or") {
        "look for a missing comma or closing bracket just before this"
    } else if info.contains("mapping values are not allowed") || info.contains("simple key") {
        "check the indentation, and that each `:` is followed by a space"
    } else if info.contains("anchor") {
        "an alias `*name` repeats what `&name` stands before, further up"
    } else if info.contains("quoted scalar") {
        "look for a missing closing quote"
    } else {
        "check indentation, brackets and quotes just before this"
    };
    Diagnostic::error(span, format!("this is not valid YAML: {info}")).help(help)
}

/// From the parser's characters to bytes: a table entry for every so many characters, when they differ.
struct Offsets {
    table: Vec<usize>,
    text: String,
}

impl Offsets {
    const STEP: usize = 64;

    fn new(text: &str) -> Self {
        if text.is_ascii() {
            return Self { table: Vec::new(), text: text.to_owned() };
        }
        let table = text.char_indices().step_by(Self::STEP).map(|(i, _)| i).collect();
        Self { table, text: text.to_owned() }
    }

    fn byte(&self, character: usize) -> usize {
        let end = self.text.len();
        if self.table.is_empty() {
            return if character < end { character } else { end };
        }
        let Some(&base) = self.table.get(character / Self::STEP) else { return end };
        self.text[base..].char_indices().nth(character % Self::STEP).map_or(end, |(i, _)| base + i)
    }
}

/// A list or mapping whose end has not come.
struct Open {
    start: Marks,
    anchor: usize,
    tag: Option<String>,
    inside: Inside,
    /// Values inside, for the budget of aliases.
    nodes: usize,
}

enum Inside {
    Sequence(Vec<Tree>),
    Mapping { entries: Vec<Entry>, seen: HashMap<String, Span>, key: Option<Key> },
}

/// A key whose value has not come.
enum Key {
    /// It is new to its mapping.
    Good(Spanned<String>),
    /// It was complained of.
    Bad,
    /// It is a number that is there already, with the complaint that this may deserve: `0, 0, 1` without brackets is three keys,
    /// of which whoever reads the mapping will complain.
    Again(Stop),
}

/// What ends the reading.
type Stop = Box<Diagnostic>;

struct Builder<'a> {
    file: FileId,
    offsets: Offsets,
    limits: Limits,
    budget: usize,
    open: Vec<Open>,
    anchors: HashMap<usize, (Tree, usize)>,
    root: Option<Tree>,
    d: &'a mut Diagnostics,
}

impl Builder<'_> {
    fn span(&self, marks: &Marks) -> Span {
        span(self.file, self.offsets.byte(marks.start.index()), self.offsets.byte(marks.end.index()))
    }

    fn event(&mut self, event: Event<'_>, marks: &Marks) -> Result<(), Stop> {
        match event {
            Event::Scalar(text, style, anchor, tag) => {
                let at = self.span(marks);
                let nodes = 1 + text.len() / 32;
                self.spend(nodes, at)?;
                let value = match self.lost_colour(&text, style, at) {
                    Some(colour) => Datum::String(colour),
                    None => self.scalar(text.into_owned(), style, tag.as_deref(), at),
                };
                self.value(Tree { value, span: at }, anchor, nodes)
            }
            Event::SequenceStart(anchor, tag) => {
                self.begin(marks, anchor, tag.as_deref(), Inside::Sequence(Vec::new()))
            }
            Event::MappingStart(anchor, tag) => {
                let inside = Inside::Mapping { entries: Vec::new(), seen: HashMap::new(), key: None };
                self.begin(marks, anchor, tag.as_deref(), inside)
            }
            Event::SequenceEnd | Event::MappingEnd => self.end(marks),
            Event::Alias(anchor) => self.alias(anchor, marks),
            Event::Nothing
            | Event::StreamStart
            | Event::StreamEnd
            | Event::DocumentStart(_)
            | Event::DocumentEnd => Ok(()),
        }
    }

    fn spend(&mut self, nodes: usize, at: Span) -> Result<(), Stop> {
        match self.budget.checked_sub(nodes) {
            Some(rest) => {
                self.budget = rest;
                Ok(())
            }
            None => {
                let message = format!("this scene has more than {} values", self.limits.nodes);
                let help = "keep large meshes in PLY or OBJ files; aliases count as often as they repeat";
                Err(Box::new(Diagnostic::error(at, message).help(help)))
            }
        }
    }

    fn begin(&mut self, marks: &Marks, anchor: usize, tag: Option<&Tag>, inside: Inside) -> Result<(), Stop> {
        let at = self.span(marks);
        self.spend(1, at)?;
        if self.open.len() >= self.limits.depth {
            return Err(Box::new(too_deep(at, &self.limits)));
        }
        let tag = tag.map(|t| format!("{}{}", t.handle, t.suffix));
        self.open.push(Open { start: *marks, anchor, tag, inside, nodes: 1 });
        Ok(())
    }

    fn end(&mut self, marks: &Marks) -> Result<(), Stop> {
        let Some(open) = self.open.pop() else { return Ok(()) };
        let start = self.span(&open.start);
        let (value, last, tag) = match open.inside {
            Inside::Sequence(items) => {
                let last = items.last().map(|t| t.span);
                (Datum::Sequence(items), last, "tag:yaml.org,2002:seq")
            }
            Inside::Mapping { entries, .. } => {
                let last = entries.last().map(|e| e.value.span);
                (Datum::Mapping(entries), last, "tag:yaml.org,2002:map")
            }
        };
        // A block's end mark is where the next thing begins, far below; its last value is where it ends for people.
        let mut end = self.span(marks);
        if end.start == end.end
            && let Some(last) = last
        {
            end = last;
        }
        let at = start.to(end);
        if let Some(found) = open.tag
            && found != tag
        {
            self.tag(&found, start);
        }
        self.value(Tree { value, span: at }, open.anchor, open.nodes)
    }

    fn alias(&mut self, anchor: usize, marks: &Marks) -> Result<(), Stop> {
        let at = self.span(marks);
        let Some(&(_, nodes)) = self.anchors.get(&anchor) else {
            let message = "this alias stands inside what it repeats, or repeats a key";
            return Err(Box::new(Diagnostic::error(at, message)));
        };
        self.spend(nodes, at)?;
        let Some((tree, _)) = self.anchors.get(&anchor) else { return Ok(()) };
        if self.open.len() + depth(tree) > self.limits.depth {
            return Err(Box::new(too_deep(at, &self.limits)));
        }
        let tree = tree.clone();
        self.value(tree, 0, nodes)
    }

    /// Puts a whole value where it belongs.
    fn value(&mut self, tree: Tree, anchor: usize, nodes: usize) -> Result<(), Stop> {
        if anchor != 0 {
            self.spend(nodes, tree.span)?;
            self.anchors.insert(anchor, (tree.clone(), nodes));
        }
        let Some(open) = self.open.last_mut() else {
            self.root = Some(tree);
            return Ok(());
        };
        open.nodes += nodes;
        match &mut open.inside {
            Inside::Sequence(items) => items.push(tree),
            Inside::Mapping { entries, seen, key } => match key.take() {
                None => *key = Some(key_of(tree, seen, self.d, self.offsets.text.as_str())),
                Some(Key::Good(key)) => entries.push(Entry { key, value: tree }),
                Some(Key::Again(complaint)) if tree.value != Datum::Null => self.d.push(*complaint),
                Some(Key::Again(_) | Key::Bad) => {}
            },
        }
        Ok(())
    }

    fn scalar(&mut self, text: String, style: ScalarStyle, tag: Option<&Tag>, at: Span) -> Datum {
        let Some(tag) = tag else {
            return if style == ScalarStyle::Plain { scalar::resolve(text) } else { Datum::String(text) };
        };
        if tag.is_yaml_core_schema() && tag.suffix == "str" || tag.handle.is_empty() && tag.suffix == "!" {
            return Datum::String(text);
        }
        let value = scalar::resolve(text);
        let known = tag.is_yaml_core_schema()
            && matches!(
                (tag.suffix.as_str(), &value),
                ("int" | "float", Datum::Number(_)) | ("bool", Datum::Bool(_)) | ("null", Datum::Null)
            );
        if !known {
            self.tag(&format!("{}{}", tag.handle, tag.suffix), at);
        }
        value
    }

    /// A colour that became a comment, after a complaint: nothing stands where it was meant to.
    fn lost_colour(&mut self, text: &str, style: ScalarStyle, at: Span) -> Option<String> {
        if !text.is_empty() || style != ScalarStyle::Plain {
            return None;
        }
        let all = self.offsets.text.as_str();
        let start = match &self.open.last()?.inside {
            Inside::Mapping { key: Some(Key::Good(key)), .. } => {
                let rest = &all[key.span.end as usize..];
                rest.trim_start_matches(['"', '\'']).starts_with(':').then(|| all.len() - rest.len())?
            }
            Inside::Mapping { .. } => return None,
            // An item that is nothing has its place where the next thing begins.
            Inside::Sequence(_) => all[..at.start as usize].trim_end().rfind('-')?,
        };
        let line = all[start..].lines().next()?;
        let colour = comment_for_colour(line)?;
        let is_alone =
            line[..colour.start].trim().trim_start_matches(['"', '\'', ':', '-', ' ', '\t']).is_empty();
        let (colour, written) = (colour.start + start..colour.end + start, &line[colour]);
        if !is_alone {
            return None;
        }
        // With an alpha it would be complained of again.
        let kept = match written.len() {
            5 => 4,
            9 => 7,
            whole => whole,
        };
        let (kept, complaint) =
            (written[..kept].to_owned(), in_quotes(span(self.file, colour.start, colour.end), written));
        self.d.push(complaint);
        Some(kept)
    }

    fn tag(&mut self, tag: &str, at: Span) {
        let message = format!("the tag `{}` has no place here", suggest::brief(tag));
        self.d.push(Diagnostic::error(at, message).help("leave the tag out"));
    }
}

/// What the value of a mapping's key is to be called; [`Key::Bad`] after a complaint.
fn key_of(tree: Tree, seen: &mut HashMap<String, Span>, d: &mut Diagnostics, text: &str) -> Key {
    let at = tree.span;
    let written = || text.get(at.start as usize..at.end as usize).unwrap_or("").to_owned();
    let key = match tree.value {
        Datum::String(s) if s == "<<" && written() == "<<" => {
            let help = "write the keys out, or give the whole mapping an alias";
            d.push(Diagnostic::error(at, "merge keys are not part of YAML 1.2").help(help));
            return Key::Bad;
        }
        Datum::String(s) => s,
        // Names may look like numbers: `materials: { 1: ... }`.
        Datum::Number(_) | Datum::Bool(_) | Datum::Null if !written().is_empty() => written(),
        Datum::Null => {
            d.push(Diagnostic::error(at, "a key is missing before this `:`"));
            return Key::Bad;
        }
        _ => {
            d.push(Diagnostic::error(at, "a key must be a word, not a list or mapping"));
            return Key::Bad;
        }
    };
    if let Some(&first) = seen.get(&key) {
        let complaint = Diagnostic::error(at, format!("duplicate key `{}`", suggest::brief(&key)));
        let complaint = complaint.related(first, "the first is here");
        if key.parse::<f64>().is_ok() {
            return Key::Again(Box::new(complaint));
        }
        d.push(complaint);
        return Key::Bad;
    }
    seen.insert(key.clone(), at);
    Key::Good(Spanned::new(key, at))
}

/// Lists and mappings inside one another.
fn depth(tree: &Tree) -> usize {
    match &tree.value {
        Datum::Sequence(items) => 1 + items.iter().map(depth).max().unwrap_or(0),
        Datum::Mapping(entries) => 1 + entries.iter().map(|e| depth(&e.value)).max().unwrap_or(0),
        _ => 0,
    }
}
