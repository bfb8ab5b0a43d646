//! The lines of OBJ and MTL files.

use std::borrow::Cow;

use crate::ReadError;
use crate::number;
use crate::read_error::quoted;

/// The statements of a file: lines without comments and blank ones, joined where one ends in a backslash. A line ends in a
/// line feed, a carriage return or both.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
    /// Whether what was read so far shows that the file is what it should be: only then do messages quote it. Another
    /// file may hold what isn't for everyone's eyes.
    pub(crate) is_trusted: bool,
    /// Whether a comment holds colours of vertices, as ZBrush writes them (`#MRGB`).
    pub(crate) has_painted: bool,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let rest = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
        Self { rest, number: 0, is_trusted: false, has_painted: false }
    }

    /// The next line, and whether there is a `#` in it.
    fn next_raw(&mut self) -> Option<(&'a [u8], bool)> {
        if self.rest.is_empty() {
            return None;
        }
        let mut length = memchr::memchr3(b'\n', b'\r', b'#', self.rest).unwrap_or(self.rest.len());
        let has_hash = self.rest.get(length) == Some(&b'#');
        if has_hash {
            let behind = &self.rest[length..];
            length += memchr::memchr2(b'\n', b'\r', behind).unwrap_or(behind.len());
        }
        let (line, rest) = self.rest.split_at(length);
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => rest,
        };
        self.number += 1;
        Some((line.trim_ascii(), has_hash))
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Statement<'a>> {
        let end_of_code =
            |line: &[u8], has_hash: bool| if has_hash { number::comment(line) } else { line.len() };
        loop {
            let (line, has_hash) = self.next_raw()?;
            let number = self.number;
            if line.is_empty() || line[0] == b'#' {
                self.has_painted |= line.starts_with(b"#MRGB ");
                continue;
            }
            let mut line = Cow::Borrowed(line);
            let mut code = end_of_code(&line, has_hash);
            // A backslash in a comment, such as that of a path, joins nothing.
            while line.last() == Some(&b'\\') && code == line.len() {
                let joined = line.to_mut();
                joined.pop();
                joined.push(b' ');
                code = joined.len();
                let Some((more, has_hash)) = self.next_raw() else { break };
                joined.extend(more);
                code += end_of_code(more, has_hash);
            }
            let (text, code) = match line {
                Cow::Borrowed(line) => match std::str::from_utf8(line) {
                    Ok(text) => (Cow::Borrowed(text), code),
                    Err(_) => owned(String::from_utf8_lossy(line).into_owned()),
                },
                Cow::Owned(line) => owned(String::from_utf8_lossy(&line).into_owned()),
            };
            return Some(Statement { line: number, text, code, is_trusted: self.is_trusted });
        }
    }
}

/// A text that was changed on the way, and where its comment begins.
fn owned<'a>(text: String) -> (Cow<'a, str>, usize) {
    let code = number::comment(text.as_bytes());
    (Cow::Owned(text), code)
}

/// A keyword and what follows it.
pub(crate) struct Statement<'a> {
    /// The line that it begins in, from 1.
    pub(crate) line: usize,
    text: Cow<'a, str>,
    /// Where its comment begins.
    code: usize,
    is_trusted: bool,
}

impl Statement<'_> {
    pub(crate) fn keyword(&self) -> &str {
        self.text.split_ascii_whitespace().next().unwrap_or_default()
    }

    /// All that follows the keyword, as one name that may hold spaces; a comment behind it included, for names may hold a
    /// `#` as well: see [`bare`].
    pub(crate) fn name(&self) -> &str {
        self.text.trim_ascii_start().strip_prefix(self.keyword()).unwrap_or_default().trim_ascii()
    }

    /// The words after the keyword, up to a comment.
    pub(crate) fn words(&self) -> impl Iterator<Item = &str> {
        self.text[..self.code].split_ascii_whitespace().skip(1)
    }

    /// The first `N` words as numbers; more are not looked at.
    pub(crate) fn numbers<const N: usize>(&self) -> Result<[f32; N], ReadError> {
        Ok(self.numbers_and_more()?.0)
    }

    /// The first `N` words as numbers, and how many more there are, up to 3.
    #[inline]
    pub(crate) fn numbers_and_more<const N: usize>(&self) -> Result<([f32; N], usize), ReadError> {
        let mut numbers = [0.0; N];
        let mut words = self.words();
        for number in &mut numbers {
            let Some(word) = words.next() else {
                let keyword = self.keyword();
                let what = if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
                return Err(ReadError::line(self.line, format!("'{keyword}' needs {what}")));
            };
            *number = self.number(word)?;
        }
        Ok((numbers, words.take(3).count()))
    }

    pub(crate) fn number(&self, word: &str) -> Result<f32, ReadError> {
        number::single(word)
            .ok_or_else(|| ReadError::line(self.line, format!("expected a number{}", self.found(word))))
    }

    /// What was found in place of what was expected, unless it isn't to be shown.
    pub(crate) fn found(&self, word: &str) -> String {
        if self.is_trusted { format!(", found {}", quoted(word.as_bytes())) } else { String::new() }
    }
}

/// A name as it is meant: without the quotes around it and the comment behind it.
pub(crate) fn bare(name: &str) -> &str {
    for quote in ['"', '\''] {
        if let Some((inside, behind)) = name.strip_prefix(quote).and_then(|rest| rest.split_once(quote)) {
            let behind = behind.trim_ascii();
            if behind.is_empty() || behind.starts_with('#') {
                return inside.trim_ascii();
            }
        }
    }
    let is_comment =
        |(i, _): &(usize, &str)| name[..*i].chars().next_back().is_none_or(|c| c.is_ascii_whitespace());
    let end = name.match_indices('#').find(is_comment).map_or(name.len(), |(i, _)| i);
    name[..end].trim_ascii()
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

    /// The same of what is said however much was said before, because it changes the picture.
    pub(crate) fn surely_once(&mut self, kind: &str, text: impl FnOnce() -> String) {
        if !self.said.iter().any(|(said, _)| said == kind) {
            self.said.push((kind.to_string(), text()));
        }
    }

    pub(crate) fn finish(self) -> Vec<String> {
        let left_out = (self.left_out > 0).then(|| format!("{} more warnings are left out", self.left_out));
        self.said.into_iter().map(|(_, text)| text).chain(left_out).collect()
    }
}

/// A number and a noun, with an s where there are several.
pub(crate) fn count(number: u64, noun: &str) -> String {
    if number == 1 { format!("1 {noun}") } else { format!("{number} {noun}s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_of_three_ways() {
        let text = b"\xef\xbb\xbfv 1\rv 2\r\n\rv 3 \\\r 4 \\\r\n5\n# no\\\nv 6 # c:\\\nv 7#\r#MRGB ff\r\r\nv \xff\xff 8 # x";
        let mut lines = Lines::new(text);
        let mut found = Vec::new();
        for s in lines.by_ref() {
            found.push((s.line, s.words().collect::<Vec<_>>().join(" ")));
        }
        let want = [(1, "1"), (2, "2"), (4, "3 4 5"), (8, "6"), (9, "7"), (12, "\u{fffd}\u{fffd} 8")];
        assert_eq!(found, want.map(|(line, words)| (line, words.to_owned())));
        assert!(lines.has_painted);
    }

    #[test]
    fn names_lose_quotes_and_comments() {
        for (name, want) in [
            ("red", "red"),
            ("red # by hand", "red"),
            ("red\t#", "red"),
            ("paint#3", "paint#3"),
            ("\"red\"", "red"),
            ("\"my red.mtl\" # x", "my red.mtl"),
            ("'a b'", "a b"),
            ("it's", "it's"),
            ("\"a\" \"b\"", "\"a\" \"b\""),
            ("# none", ""),
            ("\"", "\""),
            ("", ""),
        ] {
            assert_eq!(bare(name), want, "{name}");
        }
    }
}
