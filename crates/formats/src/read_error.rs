//! What went wrong while reading a file, and where in it.

use std::fmt;

/// A file that can't be read: what is wrong and where. The caller knows the file's name and puts it in front.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}{problem}")]
pub struct ReadError {
    /// Where in the file.
    pub place: Place,
    /// What is wrong, as a sentence without a full stop.
    pub problem: String,
}

/// A place in a file. Shown as a prefix that ends in ": ", or nothing for the file as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A byte of a binary file, counted from 0.
    Byte(usize),
}

impl ReadError {
    /// An error of the file as a whole.
    pub fn file(problem: impl Into<String>) -> Self {
        Self { place: Place::File, problem: problem.into() }
    }

    /// An error of a file that isn't what it should be, of a kind such as `BMP`.
    pub(crate) fn damaged(kind: &str, problem: &str) -> Self {
        Self::file(format!("the {kind} file is damaged: {problem}"))
    }

    /// An error at a place.
    pub fn at(place: Place, problem: impl Into<String>) -> Self {
        Self { place, problem: problem.into() }
    }

    /// An error in a line, counted from 1.
    pub fn line(line: usize, problem: impl Into<String>) -> Self {
        Self::at(Place::Line(line), problem)
    }

    /// An error at a byte, counted from 0.
    pub fn byte(byte: usize, problem: impl Into<String>) -> Self {
        Self::at(Place::Byte(byte), problem)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Line(line) => write!(f, "line {line}: "),
            Place::Byte(byte) => write!(f, "byte {byte}: "),
        }
    }
}

/// A piece of a file as it can be shown in a message: at most 40 characters, with what can't be printed escaped.
pub(crate) fn quoted(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(&text[..text.len().min(160)]);
    let mut shown: String = text.chars().take(40).flat_map(char::escape_debug).collect();
    if text.chars().count() > 40 {
        shown.push('…');
    }
    format!("'{shown}'")
}
