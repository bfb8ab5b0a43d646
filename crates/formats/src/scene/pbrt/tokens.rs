//! From the bytes of a scene and of what it includes to words, strings, brackets and numbers, each with its place.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::rc::Rc;

use straal_scene::{Diagnostic, Diagnostics, FileId, Span};

use crate::files::Refusal;
use crate::number;

/// A piece of a scene's text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Anything that isn't one of the others: a directive, a number, `true`.
    Word,
    /// What stands in quotes; its span is that of the quotes as well.
    Text,
    /// `[`.
    Open,
    /// `]`.
    Close,
}

/// A piece of text and where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub kind: Kind,
    pub span: Span,
}

/// The text of a file.
#[derive(Clone)]
enum Text<'t> {
    /// That of the scene's own.
    Lent(&'t str),
    Own(Rc<String>),
}

impl std::ops::Deref for Text<'_> {
    type Target = str;

    fn deref(&self) -> &str {
        match self {
            Self::Lent(text) => text,
            Self::Own(text) => text,
        }
    }
}

/// A file that is being read.
struct Frame<'t> {
    text: Text<'t>,
    file: FileId,
    at: usize,
    /// Whether what it changes of the graphics state stays within it.
    is_import: bool,
}

/// What of a file has come to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    Token(Token),
    /// A file that was imported has ended.
    EndOfImport,
    /// All files have.
    End,
}

/// Most files within one another.
const DEEPEST: usize = 64;

/// Most times that files are included.
const MOST_FILES: usize = 100_000;

/// Most bytes of all files together, each as often as it is included.
const MOST_BYTES: u64 = 1 << 34;

/// The pieces of a scene and of what it includes, in the order in which they count.
pub(super) struct Tokens<'t> {
    frames: Vec<Frame<'t>>,
    /// What was read, by its path.
    known: BTreeMap<PathBuf, (Text<'t>, FileId)>,
    /// How many files were included, and how many bytes they had.
    included: (usize, u64),
    /// A piece that was looked at and is still to come.
    waiting: Option<Token>,
}

/// Bytes as text of the same length: what is no UTF-8, as may be in old comments, becomes question marks.
pub(super) fn as_text(bytes: &[u8]) -> String {
    if let Ok(text) = std::str::from_utf8(bytes) {
        return text.to_owned();
    }
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        text.extend(std::iter::repeat_n('?', chunk.invalid().len()));
    }
    text
}

/// A text of more bytes isn't kept for messages, but only the places of its lines.
const LARGE: usize = 1 << 24;

/// Bytes that are kept of a text.
pub(super) const fn kept(length: usize) -> u64 {
    if length > LARGE { 0 } else { length as u64 }
}

/// Keeps a text for messages, or what is kept of it.
fn keep(name: &str, text: &str, d: &mut Diagnostics) -> FileId {
    if text.len() > LARGE { d.sources.add_lines(name, text) } else { d.sources.add(name, text) }
}

impl<'t> Tokens<'t> {
    /// Those of a text.
    pub fn new(name: &str, bytes: &'t [u8], d: &mut Diagnostics) -> Self {
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => Text::Lent(text),
            Err(_) => Text::Own(Rc::new(as_text(bytes))),
        };
        let file = keep(name, &text, d);
        let frame = Frame { text, file, at: 0, is_import: false };
        Self { frames: vec![frame], known: BTreeMap::new(), included: (0, 0), waiting: None }
    }

    /// Goes on in another file before what is left of this one; says why not, if so. `read` gives its bytes.
    pub fn enter(
        &mut self,
        path: &PathBuf,
        is_import: bool,
        d: &mut Diagnostics,
        read: impl FnOnce(&mut Diagnostics) -> Result<(String, Vec<u8>), Refusal>,
    ) -> Result<(), Refusal> {
        if self.frames.len() >= DEEPEST {
            return Err(Refusal::new(format!("files include one another more than {DEEPEST} deep")));
        }
        let (text, file) = match self.known.get(path) {
            Some(known) => known.clone(),
            None => {
                let (name, bytes) = read(d)?;
                let text = String::from_utf8(bytes).unwrap_or_else(|e| as_text(e.as_bytes()));
                let file = keep(&name, &text, d);
                let found = (Text::Own(Rc::new(text)), file);
                self.known.insert(path.clone(), found.clone());
                found
            }
        };
        let (files, bytes) = (self.included.0 + 1, self.included.1 + text.len() as u64);
        if files > MOST_FILES || bytes > MOST_BYTES {
            return Err(Refusal::new("files are included too often"));
        }
        self.included = (files, bytes);
        self.frames.push(Frame { text, file, at: 0, is_import });
        Ok(())
    }

    /// The next piece.
    pub fn next(&mut self, d: &mut Diagnostics) -> Next {
        if let Some(token) = self.waiting.take() {
            return Next::Token(token);
        }
        loop {
            let Some(frame) = self.frames.last_mut() else { return Next::End };
            if let Some(token) = frame.next(d) {
                return Next::Token(token);
            }
            let is_import = frame.is_import;
            // The first stays, so that complaints about the end have a place.
            if self.frames.len() == 1 {
                return Next::End;
            }
            self.frames.pop();
            if is_import {
                return Next::EndOfImport;
            }
        }
    }

    /// The next piece of this file, if there is one: a directive's own words don't go on in another.
    pub fn here(&mut self, d: &mut Diagnostics) -> Option<Token> {
        self.waiting.take().or_else(|| self.frames.last_mut()?.next(d))
    }

    /// Gives a piece back, which is then the next.
    pub fn put_back(&mut self, token: Token) {
        self.waiting = Some(token);
    }

    /// The place that reading has come to.
    pub fn place(&self) -> Span {
        self.frames.last().map_or(Span::NONE, |frame| {
            let at = clamp(frame.at);
            Span { file: frame.file, start: at, end: at }
        })
    }

    /// The text of a piece of the file that is being read, without its quotes.
    pub fn text(&self, token: Token) -> &str {
        let Some(frame) = self.frames.last() else { return "" };
        let (start, end) = (token.span.start as usize, token.span.end as usize);
        let (start, end) = if token.kind == Kind::Text { (start + 1, end - 1) } else { (start, end) };
        frame.text.get(start..end).unwrap_or("")
    }

    /// Reads numbers up to a closing bracket and hands each to `take`; the first piece that is no number is given back, `None` where
    /// the file ends.
    pub fn numbers(&mut self, mut take: impl FnMut(f64), d: &mut Diagnostics) -> Option<Token> {
        loop {
            let token = self.here(d)?;
            if token.kind != Kind::Word {
                return Some(token);
            }
            match number::double(self.text(token)) {
                Some(v) => take(v),
                None => return Some(token),
            }
        }
    }
}

/// Readers refuse texts of 4 GiB and more.
fn clamp(i: usize) -> u32 {
    u32::try_from(i).unwrap_or(u32::MAX)
}

/// What ends a word.
const fn ends(b: u8) -> bool {
    matches!(b, b' ' | b'\n' | b'\t' | b'\r' | b'"' | b'[' | b']')
}

impl Frame<'_> {
    fn next(&mut self, d: &mut Diagnostics) -> Option<Token> {
        let bytes = self.text.as_bytes();
        let mut at = self.at;
        let start = loop {
            match *bytes.get(at)? {
                b' ' | b'\n' | b'\t' | b'\r' => at += 1,
                b'#' => {
                    at += memchr::memchr2(b'\n', b'\r', &bytes[at..]).unwrap_or(bytes.len() - at);
                }
                _ => break at,
            }
        };
        let (kind, end) = match bytes[start] {
            b'[' => (Kind::Open, start + 1),
            b']' => (Kind::Close, start + 1),
            b'"' => {
                let mut end = start + 1;
                loop {
                    match bytes.get(end) {
                        Some(b'"') => break (Kind::Text, end + 1),
                        Some(b'\\') if end + 1 < bytes.len() => end += 2,
                        None | Some(b'\n') => {
                            let span = Span { file: self.file, start: clamp(start), end: clamp(start + 1) };
                            d.push(Diagnostic::error(span, "this string has no end: `\"` is missing"));
                            self.at = bytes.len();
                            return None;
                        }
                        Some(_) => end += 1,
                    }
                }
            }
            _ => {
                let length = bytes[start..].iter().position(|b| ends(*b)).unwrap_or(bytes.len() - start);
                (Kind::Word, start + length)
            }
        };
        self.at = end;
        let span = Span { file: self.file, start: clamp(start), end: clamp(end) };
        Some(Token { kind, span })
    }
}

/// A string without its quotes, with what backslashes stand for.
pub(super) fn unescaped(text: &str) -> String {
    if !text.contains('\\') {
        return text.to_owned();
    }
    let mut out = String::with_capacity(text.len());
    let mut letters = text.chars();
    while let Some(c) = letters.next() {
        out.push(match c {
            '\\' => match letters.next() {
                Some('n') => '\n',
                Some('t') => '\t',
                Some('r') => '\r',
                Some('b') => '\u{8}',
                Some('f') => '\u{c}',
                Some(other) => other,
                None => '\\',
            },
            other => other,
        });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(text: &str) -> (Vec<String>, Diagnostics) {
        let mut d = Diagnostics::default();
        let mut tokens = Tokens::new("a.pbrt", text.as_bytes(), &mut d);
        let mut found = Vec::new();
        while let Next::Token(token) = tokens.next(&mut d) {
            found.push(format!("{:?} {}", token.kind, tokens.text(token)));
        }
        (found, d)
    }

    #[test]
    fn words_strings_and_brackets_come_apart() {
        let (found, d) = pieces("Shape\"sphere\" # a ]\r\"float radius\"[1 -2e3]\ttrue#no");
        let want = [
            "Word Shape",
            "Text sphere",
            "Text float radius",
            "Open [",
            "Word 1",
            "Word -2e3",
            "Close ]",
            "Word true#no",
        ];
        assert_eq!(found, want);
        assert!(d.list.is_empty());
    }

    #[test]
    fn a_string_ends_on_its_line() {
        let (found, d) = pieces("A \"b\\\"c\"\n\"d\ne");
        assert_eq!(found, ["Word A", "Text b\\\"c"]);
        assert_eq!(unescaped("b\\\"c\\n"), "b\"c\n");
        assert_eq!(d.place(d.list[0].span), "a.pbrt:2:1");
    }

    #[test]
    fn what_is_no_text_keeps_its_length() {
        assert_eq!(as_text(b"a\xff\xfeb\xc3\xa9"), "a??b\u{e9}");
    }
}
