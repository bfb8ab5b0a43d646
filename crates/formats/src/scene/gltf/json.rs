//! JSON with places: values that know where in their text they stand, so that a complaint can quote the line and name the path.

use std::fmt::Write;

/// A value and the bytes of the text that it stands in.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Json {
    pub value: Value,
    pub start: u32,
    pub end: u32,
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Null,
    Bool(bool),
    Number(f64),
    String(Box<str>),
    List(Vec<Json>),
    /// By key in the order of the alphabet; of a key that is there twice the last counts.
    Object(Vec<(Box<str>, Json)>),
}

/// What is wrong, and at which byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wrong {
    pub at: usize,
    pub problem: &'static str,
}

/// Lists and objects may be within one another so deep.
const DEEPEST: usize = 64;

/// Bytes that the values of a text take at most for each of its bytes.
pub(super) const BYTES: u64 = 32;

impl Json {
    /// What an object has under a key; `null` is nothing.
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Value::Object(entries) = &self.value else { return None };
        let i = entries.binary_search_by(|(k, _)| (**k).cmp(key)).ok()?;
        Some(&entries[i].1).filter(|found| found.value != Value::Null)
    }

    /// What an extension says of it.
    pub fn extension(&self, name: &str) -> Option<&Self> {
        self.get("extensions")?.get(name)
    }

    /// The values of a list; none of anything else.
    pub fn items(&self) -> &[Self] {
        if let Value::List(items) = &self.value { items } else { &[] }
    }

    /// The keys and values of an object; none of anything else.
    pub fn entries(&self) -> &[(Box<str>, Self)] {
        if let Value::Object(entries) = &self.value { entries } else { &[] }
    }

    /// A text.
    pub fn text(&self) -> Option<&str> {
        if let Value::String(text) = &self.value { Some(text) } else { None }
    }

    /// A number.
    pub fn number(&self) -> Option<f64> {
        if let Value::Number(v) = self.value { Some(v) } else { None }
    }

    /// What is said where a kind of value is told.
    pub fn kind(&self) -> &'static str {
        match self.value {
            Value::Null => "null",
            Value::Bool(_) => "true or false",
            Value::Number(_) => "a number",
            Value::String(_) => "a text",
            Value::List(_) => "a list",
            Value::Object(_) => "an object",
        }
    }

    /// The way from here to a value within, such as `meshes[3].primitives[0]`; told by where it stands.
    pub fn path_to(&self, start: u32, end: u32) -> String {
        let mut path = String::new();
        let mut here = self;
        while (here.start, here.end) != (start, end) {
            let holds = |inner: &Self| inner.start <= start && end <= inner.end;
            let next = match &here.value {
                Value::List(items) => {
                    // In the order of the text.
                    let i = items.partition_point(|item| item.end < end);
                    items.get(i).filter(|item| holds(item)).inspect(|_| {
                        let _ = write!(path, "[{i}]");
                    })
                }
                Value::Object(entries) => {
                    entries.iter().find(|(_, inner)| holds(inner)).map(|(key, inner)| {
                        let _ = write!(path, "{}{}", if path.is_empty() { "" } else { "." }, shown(key));
                        inner
                    })
                }
                _ => None,
            };
            let Some(next) = next else { break };
            here = next;
        }
        path
    }

    /// The value of a text.
    pub fn parse(text: &str) -> Result<Self, Wrong> {
        let mut parser = Parser { bytes: text.as_bytes(), text, at: 0 };
        let value = parser.value(0)?;
        parser.space();
        if parser.at < text.len() {
            return Err(parser.wrong("something follows the end of the JSON text"));
        }
        Ok(value)
    }
}

/// A key as it can be shown.
fn shown(key: &str) -> String {
    key.chars().take(60).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

struct Parser<'a> {
    bytes: &'a [u8],
    text: &'a str,
    at: usize,
}

impl Parser<'_> {
    fn wrong(&self, problem: &'static str) -> Wrong {
        Wrong { at: self.at, problem }
    }

    fn space(&mut self) {
        while matches!(self.bytes.get(self.at), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    /// Whether that byte comes next, which is stepped over then.
    fn eats(&mut self, byte: u8) -> bool {
        self.space();
        let is_it = self.bytes.get(self.at) == Some(&byte);
        self.at += usize::from(is_it);
        is_it
    }

    fn value(&mut self, depth: usize) -> Result<Json, Wrong> {
        self.space();
        let start = self.at as u32;
        let value = match self.bytes.get(self.at) {
            Some(b'{' | b'[') if depth == DEEPEST => return Err(self.wrong("it is nested too deeply")),
            Some(b'{') => self.object(depth + 1)?,
            Some(b'[') => self.list(depth + 1)?,
            Some(b'"') => Value::String(self.string()?.into()),
            Some(b'-' | b'0'..=b'9') => self.number()?,
            Some(_) => self.word()?,
            None => return Err(self.wrong("the JSON text ends before a value")),
        };
        Ok(Json { value, start, end: self.at as u32 })
    }

    fn word(&mut self) -> Result<Value, Wrong> {
        let words = [("true", Value::Bool(true)), ("false", Value::Bool(false)), ("null", Value::Null)];
        let Some((word, value)) =
            words.into_iter().find(|(word, _)| self.bytes[self.at..].starts_with(word.as_bytes()))
        else {
            return Err(
                self.wrong("a value was expected here: an object, a list, a text in quotes, a number")
            );
        };
        self.at += word.len();
        Ok(value)
    }

    fn list(&mut self, depth: usize) -> Result<Value, Wrong> {
        self.at += 1;
        let mut items = Vec::new();
        if self.eats(b']') {
            return Ok(Value::List(items));
        }
        loop {
            items.push(self.value(depth)?);
            if self.eats(b']') {
                items.shrink_to_fit();
                return Ok(Value::List(items));
            }
            if !self.eats(b',') {
                return Err(self.wrong("a comma or `]` was expected here"));
            }
        }
    }

    fn object(&mut self, depth: usize) -> Result<Value, Wrong> {
        self.at += 1;
        let mut entries: Vec<(Box<str>, Json)> = Vec::new();
        if self.eats(b'}') {
            return Ok(Value::Object(entries));
        }
        loop {
            self.space();
            if self.bytes.get(self.at) != Some(&b'"') {
                return Err(self.wrong("a key in quotes was expected here"));
            }
            let key = self.string()?.into();
            if !self.eats(b':') {
                return Err(self.wrong("a colon was expected here"));
            }
            entries.push((key, self.value(depth)?));
            if self.eats(b'}') {
                break;
            }
            if !self.eats(b',') {
                return Err(self.wrong("a comma or `}` was expected here"));
            }
        }
        // The sort is stable, and of equal keys the first in reverse order stays.
        entries.reverse();
        entries.sort_by(|(a, _), (b, _)| a.cmp(b));
        entries.dedup_by(|(a, _), (b, _)| a == b);
        entries.shrink_to_fit();
        Ok(Value::Object(entries))
    }

    fn number(&mut self) -> Result<Value, Wrong> {
        let start = self.at;
        let digits = |p: &mut Self| {
            let from = p.at;
            while p.bytes.get(p.at).is_some_and(u8::is_ascii_digit) {
                p.at += 1;
            }
            p.at > from
        };
        self.at += usize::from(self.bytes[self.at] == b'-');
        let mut is_one = digits(self);
        if self.bytes.get(self.at) == Some(&b'.') {
            self.at += 1;
            is_one &= digits(self);
        }
        if let Some(b'e' | b'E') = self.bytes.get(self.at) {
            self.at += 1;
            self.at += usize::from(matches!(self.bytes.get(self.at), Some(b'+' | b'-')));
            is_one &= digits(self);
        }
        let number = self.text[start..self.at].parse().ok().filter(|v: &f64| v.is_finite() && is_one);
        number.map(Value::Number).ok_or(Wrong { at: start, problem: "this is no number" })
    }

    /// A text in quotes.
    fn string(&mut self) -> Result<String, Wrong> {
        self.at += 1;
        let mut out = String::new();
        loop {
            let rest = &self.bytes[self.at..];
            let Some(plain) = rest.iter().position(|b| matches!(b, b'"' | b'\\' | 0..=0x1f)) else {
                return Err(self.wrong("the text in quotes doesn't end"));
            };
            out.push_str(&self.text[self.at..self.at + plain]);
            self.at += plain;
            match rest[plain] {
                b'"' => {
                    self.at += 1;
                    return Ok(out);
                }
                b'\\' => out.push(self.escape()?),
                _ => return Err(self.wrong("a line break or another control character stands in a text")),
            }
        }
    }

    fn escape(&mut self) -> Result<char, Wrong> {
        let wrong = self.wrong("this escape isn't one of JSON's");
        let code = *self.bytes.get(self.at + 1).ok_or(wrong.clone())?;
        self.at += 2;
        Ok(match code {
            b'"' | b'\\' | b'/' => char::from(code),
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'n' => '\n',
            b'r' => '\r',
            b't' => '\t',
            b'u' => {
                let first = self.hex().ok_or(wrong)?;
                let is_high = (0xd800..0xdc00).contains(&first);
                if is_high && self.bytes[self.at..].starts_with(b"\\u") {
                    let before = self.at;
                    self.at += 2;
                    if let Some(second) = self.hex().filter(|v| (0xdc00..0xe000).contains(v)) {
                        let code = 0x1_0000 + ((first - 0xd800) << 10) + (second - 0xdc00);
                        return Ok(char::from_u32(code).unwrap_or('\u{fffd}'));
                    }
                    self.at = before;
                }
                char::from_u32(first).unwrap_or('\u{fffd}')
            }
            _ => return Err(wrong),
        })
    }

    fn hex(&mut self) -> Option<u32> {
        let digits = self.bytes.get(self.at..self.at + 4)?;
        let mut code = 0;
        for digit in digits {
            code = 16 * code + char::from(*digit).to_digit(16)?;
        }
        self.at += 4;
        Some(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_with_their_places() {
        let text = r#" {"b": [1, -2.5e2, true, null], "a": {"x y": "\u00e9\ud83d\ude00\/\n"}, "b2": []} "#;
        let json = Json::parse(text).unwrap();
        let list = json.get("b").unwrap();
        assert_eq!(list.items()[1].number(), Some(-250.0));
        assert_eq!(json.get("a").unwrap().get("x y").unwrap().text(), Some("é😀/\n"));
        assert!(list.get("x").is_none() && json.get("c").is_none());
        let place = |v: &Json| json.path_to(v.start, v.end);
        assert_eq!(place(&list.items()[2]), "b[2]");
        assert_eq!(place(json.get("a").unwrap().get("x y").unwrap()), "a.x y");
        assert_eq!(&text[list.start as usize..list.end as usize], "[1, -2.5e2, true, null]");
        assert_eq!(Json::parse(r#"{"a": 1, "a": 2}"#).unwrap().get("a").unwrap().number(), Some(2.0));
    }

    #[test]
    fn what_is_no_json_is_refused_where_it_is_wrong() {
        let deep = "[".repeat(100_000);
        for (text, at) in [
            ("", 0),
            ("{", 1),
            ("[1 2]", 3),
            ("{\"a\" 1}", 5),
            ("{a: 1}", 1),
            ("[1,]", 3),
            ("\"abc", 1),
            ("\"\\x\"", 1),
            ("1 2", 2),
            ("nul", 0),
            ("-", 0),
            ("1.", 0),
            ("1e999", 0),
            ("\"a\nb\"", 2),
            (&deep, 64),
        ] {
            assert_eq!(Json::parse(text).unwrap_err().at, at, "{:.20}", text);
        }
    }
}
