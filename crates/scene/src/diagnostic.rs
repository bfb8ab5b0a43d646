//! Complaints as data: what is wrong, where, and what would be right. Showing them is for others; the plain text
//! form here is what tests pin down.

use std::fmt;

use crate::span::{FileId, Sources, Span};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The scene can't be used.
    Error,
    /// The scene can be used, though perhaps not as was meant.
    Warning,
    /// What was taken to be meant where nothing was said.
    Note,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        })
    }
}

/// One complaint.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, as a sentence without a full stop.
    pub message: String,
    /// Where; [`Span::NONE`] when it is nowhere in a file.
    pub span: Span,
    /// A few words under the quoted text; may be empty.
    pub label: String,
    /// Other places that matter, with a few words each.
    pub related: Vec<(Span, String)>,
    /// What would be right.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at a place.
    pub fn error(span: Span, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            span,
            label: String::new(),
            related: Vec::new(),
            help: None,
        }
    }

    /// A warning at a place.
    pub fn warning(span: Span, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(span, message) }
    }

    /// A note about a place.
    pub fn note(span: Span, message: impl Into<String>) -> Self {
        Self { severity: Severity::Note, ..Self::error(span, message) }
    }

    /// With a few words under the quoted text.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// With what would be right.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// With what would be right, if anything is known.
    pub fn maybe_help(mut self, help: Option<String>) -> Self {
        self.help = help.or(self.help);
        self
    }

    /// With another place that matters.
    pub fn related(mut self, span: Span, label: impl Into<String>) -> Self {
        self.related.push((span, label.into()));
        self
    }
}

/// How much was complained of at some time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    list: usize,
    dropped: usize,
    errors: usize,
}

/// Complaints and the texts they point into.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    /// The complaints; at most [`Diagnostics::MOST`].
    pub list: Vec<Diagnostic>,
    /// How many more there were.
    pub dropped: usize,
    /// The texts.
    pub sources: Sources,
    /// Whether there was too little memory: then the scene may be in order.
    pub lacks_memory: bool,
    errors: usize,
}

impl Diagnostics {
    /// How many complaints are kept: nobody reads more, and a hostile file may cause millions.
    pub const MOST: usize = 500;

    /// Adds a complaint.
    pub fn push(&mut self, d: Diagnostic) {
        self.errors += usize::from(d.severity == Severity::Error);
        if self.list.len() < Self::MOST {
            self.list.push(d);
        } else {
            self.dropped += 1;
        }
    }

    /// How much was complained of so far, for [`Diagnostics::rewind`].
    pub(crate) fn mark(&self) -> Mark {
        Mark { list: self.list.len(), dropped: self.dropped, errors: self.errors }
    }

    /// Forgets what was complained of since.
    pub(crate) fn rewind(&mut self, mark: Mark) {
        self.list.truncate(mark.list);
        (self.dropped, self.errors) = (mark.dropped, mark.errors);
    }

    /// Whether further complaints are only counted, so that help with them is wasted.
    pub fn is_full(&self) -> bool {
        self.list.len() >= Self::MOST
    }

    /// How many errors there were.
    pub fn errors(&self) -> usize {
        self.errors
    }

    /// Whether the scene can't be used.
    pub fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// Brings the complaints into the order of the text; those without a place come last.
    pub fn sort(&mut self) {
        self.list.sort_by_key(|d| (d.span.file, d.span.start));
    }

    /// One complaint as plain text with the line it points at.
    pub fn render(&self, d: &Diagnostic) -> String {
        let mut out = String::new();
        if d.span.is_some() {
            out += &format!("{}: ", self.place(d.span));
        }
        out += &format!("{}: {}\n", d.severity, d.message);
        if d.span.is_some() {
            out += &self.excerpt(d.span, '^', &d.label);
        }
        for (span, label) in &d.related {
            out += &format!("{}: {label}\n", self.place(*span));
            out += &self.excerpt(*span, '-', "");
        }
        if let Some(help) = &d.help {
            out += &format!("  = help: {help}\n");
        }
        out
    }

    /// `file:line:column` of the start of a span.
    pub fn place(&self, span: Span) -> String {
        let p = self.sources.position(span);
        format!("{}:{}:{}", self.sources.name(span.file), p.line, p.column)
    }

    fn excerpt(&self, span: Span, mark: char, label: &str) -> String {
        let at = self.sources.position(span);
        let line = self.sources.line(span.file, at.line);
        let length = self.sources.quote(span).lines().next().map_or(0, |l| l.chars().count());
        let window = Window::around(line, at.column - 1, length);
        let number = at.line.to_string();
        let gutter = " ".repeat(number.len());
        let caret: String = std::iter::repeat_n(mark, window.length).collect();
        let indent = " ".repeat(window.offset);
        let under = format!("{gutter} | {indent}{caret} {label}");
        format!("{gutter} |\n{number} | {}\n{}\n", window.text, under.trim_end())
    }
}

/// What of a line is shown: lines of machine-made files can be megabytes long.
struct Window {
    text: String,
    offset: usize,
    length: usize,
}

impl Window {
    const WIDTH: usize = 120;

    fn around(line: &str, column: usize, length: usize) -> Self {
        let skip = if column > Self::WIDTH / 2 && line.chars().nth(Self::WIDTH).is_some() {
            column - Self::WIDTH / 3
        } else {
            0
        };
        let shown = |c: char| if c.is_control() { ' ' } else { c };
        let mut text: String = line.chars().skip(skip).take(Self::WIDTH).map(shown).collect();
        let width = text.chars().count();
        let mut offset = column - skip;
        if skip > 0 {
            text.insert_str(0, "... ");
            offset += 4;
        }
        if line.chars().nth(skip + Self::WIDTH).is_some() {
            text += " ...";
        }
        let room = (skip + width).saturating_sub(column);
        let length = if length > room { room } else { length };
        Self { text, offset, length: if length == 0 { 1 } else { length } }
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, d) in self.list.iter().enumerate() {
            write!(f, "{}{}", if i > 0 { "\n" } else { "" }, self.render(d))?;
        }
        if self.dropped > 0 {
            writeln!(f, "\n... and {} more", self.dropped)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

/// Where a file's complaints go when it can't be shown: the file's start.
pub fn start_of(file: FileId) -> Span {
    Span { file, start: 0, end: 0 }
}
