//! The lines of OBJ and MTL files.

use std::borrow::Cow;

use crate::ReadError;
use crate::read_error::quoted;

/// The statements of a file: lines without comments and blank ones, joined where one ends in a backslash.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let rest = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
        Self { rest, number: 0 }
    }

    fn next_raw(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let length = self.rest.iter().position(|&b| b == b'\n').unwrap_or(self.rest.len());
        let line = &self.rest[..length];
        self.rest = &self.rest[self.rest.len().min(length + 1)..];
        self.number += 1;
        Some(line.trim_ascii())
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Statement<'a>> {
        loop {
            let mut line = Cow::Borrowed(self.next_raw()?);
            let number = self.number;
            if line.is_empty() || line[0] == b'#' {
                continue;
            }
            while line.last() == Some(&b'\\') {
                let joined = line.to_mut();
                joined.pop();
                joined.push(b' ');
                match self.next_raw() {
                    Some(more) => joined.extend(more),
                    None => break,
                }
            }
            let text = match line {
                Cow::Borrowed(line) => String::from_utf8_lossy(line),
                Cow::Owned(line) => Cow::Owned(String::from_utf8_lossy(&line).into_owned()),
            };
            return Some(Statement { line: number, text });
        }
    }
}

/// A keyword and what follows it.
pub(crate) struct Statement<'a> {
    /// The line that it begins in, from 1.
    pub(crate) line: usize,
    text: Cow<'a, str>,
}

impl Statement<'_> {
    pub(crate) fn keyword(&self) -> &str {
        self.text.split_ascii_whitespace().next().unwrap_or_default()
    }

    /// All that follows the keyword, as one name that may hold spaces.
    pub(crate) fn name(&self) -> &str {
        self.text.trim_ascii_start().strip_prefix(self.keyword()).unwrap_or_default().trim_ascii()
    }

    /// The words after the keyword, up to a comment.
    pub(crate) fn words(&self) -> impl Iterator<Item = &str> {
        self.text.split_ascii_whitespace().skip(1).take_while(|word| !word.starts_with('#'))
    }

    /// The first `N` words as numbers; more are not looked at.
    pub(crate) fn numbers<const N: usize>(&self) -> Result<[f32; N], ReadError> {
        let mut numbers = [0.0; N];
        let mut words = self.words();
        for number in &mut numbers {
            let Some(word) = words.next() else {
                let keyword = self.keyword();
                return Err(ReadError::line(self.line, format!("'{keyword}' needs {N} numbers")));
            };
            *number = self.number(word)?;
        }
        Ok(numbers)
    }

    pub(crate) fn number(&self, word: &str) -> Result<f32, ReadError> {
        if let Ok(number) = word.parse() {
            return Ok(number);
        }
        // How an old Microsoft C library writes what is no number.
        match word.trim_start_matches(['+', '-']) {
            "1.#INF" if word.starts_with('-') => Ok(f32::NEG_INFINITY),
            "1.#INF" => Ok(f32::INFINITY),
            "1.#IND" | "1.#QNAN" | "1.#SNAN" => Ok(f32::NAN),
            _ => {
                let word = quoted(word.as_bytes());
                Err(ReadError::line(self.line, format!("expected a number, found {word}")))
            }
        }
    }
}

/// Warnings, each said once and not without end.
#[derive(Default)]
pub(crate) struct Warnings {
    said: Vec<(String, String)>,
    left_out: usize,
}

impl Warnings {
    const MOST: usize = 50;

    /// Adds a warning unless one of the same kind was said before.
    pub(crate) fn once(&mut self, kind: &str, text: impl FnOnce() -> String) {
        if self.said.iter().any(|(said, _)| said == kind) {
            return;
        }
        if self.said.len() < Self::MOST {
            self.said.push((kind.to_string(), text()));
        } else {
            self.left_out += 1;
        }
    }

    pub(crate) fn finish(self) -> Vec<String> {
        let left_out = (self.left_out > 0).then(|| format!("{} more warnings are left out", self.left_out));
        self.said.into_iter().map(|(_, text)| text).chain(left_out).collect()
    }
}
