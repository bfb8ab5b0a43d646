//! Where in which file something was said.

use std::ops::Deref;

/// Index of a file in [`Sources`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A range of bytes of one source file, or [`Span::NONE`] for what no file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// Which file.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte; at least `start`.
    pub end: u32,
}

impl Span {
    /// The span of what was built by a program instead of read.
    pub const NONE: Self = Self { file: FileId(u32::MAX), start: 0, end: 0 };

    /// Whether this points into a file.
    pub fn is_some(self) -> bool {
        self.file != Self::NONE.file
    }

    /// From the start of `self` to the end of `o` when both are in one file, else `self`.
    pub fn to(self, o: Self) -> Self {
        if self.file == o.file && o.end >= self.start { Self { end: o.end, ..self } } else { self }
    }
}

impl Default for Span {
    fn default() -> Self {
        Self::NONE
    }
}

/// A value and where it was said. Two are equal when their values are.
#[derive(Clone, Debug, Default)]
pub struct Spanned<T> {
    /// What was said.
    pub value: T,
    /// Where.
    pub span: Span,
}

impl<T> Spanned<T> {
    /// A value said at `span`.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

impl<T: PartialEq> PartialEq for Spanned<T> {
    fn eq(&self, o: &Self) -> bool {
        self.value == o.value
    }
}

impl<T> Deref for Spanned<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> From<T> for Spanned<T> {
    fn from(value: T) -> Self {
        Self { value, span: Span::NONE }
    }
}

/// One text that diagnostics can quote.
#[derive(Clone, Debug)]
struct File {
    name: String,
    text: String,
    /// Byte offset of the start of each line.
    lines: Vec<u32>,
}

/// The texts that were read, so that a [`Span`] can be shown.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<File>,
}

/// A place as people count it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

impl Sources {
    /// Keeps a text under the name by which messages call it.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        let text = text.into();
        let file = self.add_lines(name, &text);
        if let Some(own) = self.files.get_mut(file.0 as usize) {
            own.text = text;
        }
        file
    }

    /// Keeps the places of a text's lines only: a [`Span`] of it has its line and column, but can't be quoted.
    pub fn add_lines(&mut self, name: impl Into<String>, text: &str) -> FileId {
        // A line ends in a line feed, a carriage return or both.
        let bytes = text.as_bytes();
        let ends = |i: usize| bytes[i] == b'\n' || bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n');
        let starts = (0..bytes.len()).filter(|&i| ends(i)).map(|i| clamp(i + 1));
        let lines = std::iter::once(0).chain(starts).collect();
        self.files.push(File { name: name.into(), text: String::new(), lines });
        FileId(clamp(self.files.len() - 1))
    }

    /// The name of a file; empty for one that isn't here.
    pub fn name(&self, file: FileId) -> &str {
        self.file(file).map_or("", |f| &f.name)
    }

    /// The whole text of a file; empty for one that isn't here.
    pub fn text(&self, file: FileId) -> &str {
        self.file(file).map_or("", |f| &f.text)
    }

    /// Line and column of the start of a span.
    pub fn position(&self, span: Span) -> Position {
        let Some(file) = self.file(span.file) else { return Position { line: 1, column: 1 } };
        let line = file.lines.partition_point(|&s| s <= span.start).saturating_sub(1);
        let start = file.lines[line];
        let column = match file.text.get(start as usize..span.start as usize) {
            Some(head) => head.chars().count(),
            // What isn't kept is counted in bytes.
            None if file.text.is_empty() => span.start.saturating_sub(start) as usize,
            None => 0,
        };
        Position { line: line + 1, column: column + 1 }
    }

    /// The text of a line, counted from 1, without its line break.
    pub fn line(&self, file: FileId, line: usize) -> &str {
        let Some(file) = self.file(file) else { return "" };
        let Some(&start) = line.checked_sub(1).and_then(|i| file.lines.get(i)) else { return "" };
        let end = file.lines.get(line).map_or(file.text.len(), |&e| e as usize);
        file.text.get(start as usize..end).unwrap_or("").trim_end_matches(['\n', '\r'])
    }

    /// The text under a span.
    pub fn quote(&self, span: Span) -> &str {
        self.text(span.file).get(span.start as usize..span.end as usize).unwrap_or("")
    }

    fn file(&self, id: FileId) -> Option<&File> {
        self.files.get(id.0 as usize)
    }
}

/// Readers refuse texts of 4 GiB and more, so nothing is cut here in practice.
fn clamp(i: usize) -> u32 {
    u32::try_from(i).unwrap_or(u32::MAX)
}
