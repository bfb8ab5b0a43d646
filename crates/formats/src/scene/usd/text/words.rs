//! Words, strings, numbers and values of a text.

use super::super::layer::{Kind, Value};
use super::{Parser, Result, Wrong};

/// Brackets within brackets, at most.
const NESTED: usize = 32;

impl<'t> Parser<'t> {
    pub(super) fn wrong(&self, problem: impl Into<String>) -> Wrong {
        Wrong { at: self.at, problem: problem.into() }
    }

    /// The byte at the place, without skipping anything.
    pub(super) fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Skips spaces and comments, and gives the next byte.
    pub(super) fn peek(&mut self) -> Option<u8> {
        let bytes = self.text.as_bytes();
        loop {
            match bytes.get(self.at)? {
                b' ' | b'\t' | b'\r' | b'\n' => self.at += 1,
                b'#' => self.skip_line(),
                b'/' if bytes.get(self.at + 1) == Some(&b'/') => self.skip_line(),
                b'/' if bytes.get(self.at + 1) == Some(&b'*') => {
                    let end = memchr::memmem::find(&bytes[self.at + 2..], b"*/");
                    self.at = end.map_or(bytes.len(), |end| self.at + end + 4);
                }
                byte => return Some(*byte),
            }
        }
    }

    pub(super) fn skip_line(&mut self) {
        let rest = &self.text.as_bytes()[self.at..];
        self.at += memchr::memchr(b'\n', rest).unwrap_or(rest.len());
    }

    /// Takes a byte if it comes next.
    pub(super) fn takes(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    pub(super) fn expect(&mut self, byte: u8) -> Result<()> {
        if self.takes(byte) {
            Ok(())
        } else {
            Err(self.wrong(format!("`{}` was expected", char::from(byte))))
        }
    }

    /// A name, with its namespaces.
    pub(super) fn word(&mut self) -> Result<&'t str> {
        self.peek();
        let rest = &self.text.as_bytes()[self.at..];
        let is_part = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'_' | b':') || *b >= 0x80;
        let length = rest.iter().position(|b| !is_part(b)).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.wrong("a name was expected"));
        }
        let word = &self.text[self.at..self.at + length];
        self.at += length;
        Ok(word)
    }

    /// A string in quotes, single or threefold.
    pub(super) fn string(&mut self) -> Result<String> {
        let quote = match self.peek() {
            Some(quote @ (b'"' | b'\'')) => quote,
            _ => return Err(self.wrong("a string was expected")),
        };
        let bytes = self.text.as_bytes();
        let begins = self.at;
        let is_long = bytes[self.at..].starts_with(&[quote; 3]);
        self.at += if is_long { 3 } else { 1 };
        let mut out = String::new();
        let mut from = self.at;
        loop {
            match self.byte() {
                Some(b'\\') => {
                    out.push_str(&self.text[from..self.at]);
                    let escaped = self.text[self.at + 1..].chars().next();
                    self.at += 1 + escaped.map_or(0, char::len_utf8);
                    match escaped {
                        Some('n') => out.push('\n'),
                        Some('t') => out.push('\t'),
                        Some('r') => out.push('\r'),
                        Some(other) => out.push(other),
                        None => {}
                    }
                    from = self.at;
                }
                Some(b) if b == quote && (!is_long || bytes[self.at..].starts_with(&[quote; 3])) => {
                    out.push_str(&self.text[from..self.at]);
                    self.at += if is_long { 3 } else { 1 };
                    return Ok(out);
                }
                None | Some(b'\n') if self.byte().is_none() || !is_long => {
                    self.at = begins;
                    return Err(self.wrong("the string doesn't end"));
                }
                _ => self.at += 1,
            }
        }
    }

    /// What stands between two marks on a line: paths and the names of assets.
    pub(super) fn between(&mut self, open: &str, close: &str) -> Result<String> {
        let rest = &self.text[self.at + open.len()..];
        let end = rest.find(close).filter(|end| !rest[..*end].contains('\n'));
        let Some(end) = end else { return Err(self.wrong(format!("`{close}` is missing"))) };
        self.at += open.len() + end + close.len();
        Ok(rest[..end].to_owned())
    }

    pub(super) fn asset(&mut self) -> Result<String> {
        let mark = if self.text[self.at..].starts_with("@@@") { "@@@" } else { "@" };
        Ok(self.between(mark, mark)?.replace("\\@@@", "@@@"))
    }

    pub(super) fn number(&mut self) -> Result<f64> {
        self.peek();
        let rest = &self.text.as_bytes()[self.at..];
        let is_part = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.');
        let length = rest.iter().position(|b| !is_part(b)).unwrap_or(rest.len());
        let word = &self.text[self.at..self.at + length];
        let value = match word {
            "true" | "True" => Some(1.0),
            "false" | "False" => Some(0.0),
            _ => word.parse().ok(),
        };
        let Some(value) = value else { return Err(self.wrong("a number was expected")) };
        self.at += length;
        Ok(value)
    }

    /// The numbers of a tuple, of which each may be a tuple.
    pub(super) fn tuple(&mut self, out: &mut Vec<f64>, depth: usize) -> Result<()> {
        self.expect(b'(')?;
        while !self.takes(b')') {
            match self.peek() {
                Some(b'(') if depth < 4 => self.tuple(out, depth + 1)?,
                _ => out.push(self.number()?),
            }
            self.takes(b',');
        }
        Ok(())
    }

    /// Numbers, or tuples of as many each, up to the closing bracket.
    pub(super) fn list_of_numbers(&mut self) -> Result<Value> {
        let (mut values, mut width) = (Vec::new(), 0);
        while !self.takes(b']') {
            let before = values.len();
            if self.peek() == Some(b'(') {
                self.tuple(&mut values, 0)?;
            } else {
                values.push(self.number()?);
            }
            let count = values.len() - before;
            if width != 0 && count != width || count == 0 {
                return Err(self.wrong("the things of a list have as many numbers each"));
            }
            width = count;
            self.takes(b',');
        }
        Ok(Value::numbers(width.max(1), values, Kind::Real))
    }

    pub(super) fn value(&mut self) -> Result<Value> {
        match self.peek() {
            Some(b'@') => self.asset().map(Value::Text),
            Some(b'"' | b'\'') => self.string().map(Value::Text),
            Some(b'<') => self.between("<", ">").map(Value::Text),
            Some(b'(') => {
                let mut values = Vec::new();
                self.tuple(&mut values, 0)?;
                Ok(Value::numbers(values.len().max(1), values, Kind::Real))
            }
            Some(b'[') => {
                self.at += 1;
                match self.peek() {
                    Some(b'@' | b'"' | b'\'' | b'<') => {
                        let mut texts = Vec::new();
                        while !self.takes(b']') {
                            match self.value()? {
                                Value::Text(text) => texts.push(text),
                                _ => return Err(self.wrong("the things of a list are of one kind")),
                            }
                            self.takes(b',');
                        }
                        Ok(Value::Texts(texts))
                    }
                    Some(b'[' | b'{') => {
                        self.skip_to(b']')?;
                        Ok(Value::Other)
                    }
                    _ => self.list_of_numbers(),
                }
            }
            Some(b'{') => {
                self.at += 1;
                self.skip_to(b'}')?;
                Ok(Value::Other)
            }
            Some(b) if b.is_ascii_digit() || matches!(b, b'-' | b'+' | b'.') => {
                Ok(Value::numbers(1, vec![self.number()?], Kind::Real))
            }
            _ => {
                let start = self.at;
                match self.word()? {
                    "None" => Ok(Value::Blocked),
                    "true" | "True" | "false" | "False" | "inf" | "nan" => {
                        self.at = start;
                        Ok(Value::numbers(1, vec![self.number()?], Kind::Real))
                    }
                    word => Ok(Value::Text(word.to_owned())),
                }
            }
        }
    }

    /// Skips to the bracket that closes one which is open.
    pub(super) fn skip_to(&mut self, close: u8) -> Result<()> {
        let begins = self.at;
        let mut open = vec![close];
        while let Some(&last) = open.last() {
            match self.peek() {
                Some(b'"' | b'\'') => drop(self.string()?),
                Some(b'@') => drop(self.asset()?),
                Some(bracket @ (b'(' | b'[' | b'{')) if open.len() < NESTED => {
                    open.push(if bracket == b'(' { b')' } else { bracket + 2 });
                    self.at += 1;
                }
                Some(b) if b == last => {
                    open.pop();
                    self.at += 1;
                }
                Some(b) if !matches!(b, b'(' | b'[' | b'{') => self.at += 1,
                _ => {
                    self.at = begins;
                    return Err(self.wrong("the bracket isn't closed"));
                }
            }
        }
        Ok(())
    }
}
