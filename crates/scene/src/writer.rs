//! Where a description is written to, piece by piece: a tree, or one line of JSON.
//!
//! One trait object for both, rather than serde's serializers: a scene has some hundred types, of which each would be compiled anew for each
//! of them in each crate that writes.

use std::io;

use serde_json::{Map, Value as Json};

/// Takes the pieces of a value in the order of its text.
pub trait Writer {
    /// Nothing.
    fn null(&mut self);
    /// Whether.
    fn truth(&mut self, value: bool);
    /// A whole number.
    fn whole(&mut self, value: i64);
    /// A whole number that isn't negative.
    fn count(&mut self, value: u64);
    /// Any number; what isn't finite is nothing, since JSON can't say it.
    fn number(&mut self, value: f64);
    /// A text.
    fn text(&mut self, value: &str);
    /// What follows, up to [`Writer::end_list`], are the items of a list.
    fn begin_list(&mut self);
    /// The list that was begun last has no more items.
    fn end_list(&mut self);
    /// What follows, up to [`Writer::end_map`], are keys, each with a value.
    fn begin_map(&mut self);
    /// The key of the value that comes next.
    fn key(&mut self, key: &str);
    /// The mapping that was begun last has no more keys.
    fn end_map(&mut self);
}

/// Writes one line of JSON; the first thing that fails ends it.
pub struct Line<W> {
    out: W,
    /// Whether what comes next is the first of its list or mapping, or follows its key.
    fresh: bool,
    result: io::Result<()>,
}

impl<W: io::Write> Line<W> {
    /// A line at whose beginning nothing stands yet.
    pub const fn new(out: W) -> Self {
        Self { out, fresh: true, result: Ok(()) }
    }

    /// Whether all of it could be written.
    pub fn finish(self) -> io::Result<()> {
        self.result
    }

    fn put(&mut self, write: impl FnOnce(&mut W) -> io::Result<()>) {
        if self.result.is_ok() {
            self.result = write(&mut self.out);
        }
    }

    fn part(&mut self, write: impl FnOnce(&mut W) -> io::Result<()>) {
        if !std::mem::replace(&mut self.fresh, false) {
            self.put(|out| out.write_all(b","));
        }
        self.put(write);
    }

    fn begin(&mut self, bracket: &[u8]) {
        self.part(|out| out.write_all(bracket));
        self.fresh = true;
    }

    fn end(&mut self, bracket: &[u8]) {
        self.put(|out| out.write_all(bracket));
        self.fresh = false;
    }
}

impl<W: io::Write> Writer for Line<W> {
    fn null(&mut self) {
        self.part(|out| out.write_all(b"null"));
    }
    fn truth(&mut self, value: bool) {
        self.part(|out| write!(out, "{value}"));
    }
    fn whole(&mut self, value: i64) {
        self.part(|out| write!(out, "{value}"));
    }
    fn count(&mut self, value: u64) {
        self.part(|out| write!(out, "{value}"));
    }
    fn number(&mut self, value: f64) {
        self.part(|out| Ok(serde_json::to_writer(out, &value)?));
    }
    fn text(&mut self, value: &str) {
        self.part(|out| Ok(serde_json::to_writer(out, value)?));
    }
    fn begin_list(&mut self) {
        self.begin(b"[");
    }
    fn end_list(&mut self) {
        self.end(b"]");
    }
    fn begin_map(&mut self) {
        self.begin(b"{");
    }
    fn key(&mut self, key: &str) {
        self.text(key);
        self.put(|out| out.write_all(b":"));
        self.fresh = true;
    }
    fn end_map(&mut self) {
        self.end(b"}");
    }
}

/// Makes a tree.
#[derive(Default)]
pub struct Grown {
    whole: Json,
    /// The lists and mappings that are begun and not ended, with the key in each that has no value yet.
    open: Vec<(Json, String)>,
}

impl Grown {
    /// The tree, which has been written to its end.
    pub fn finish(self) -> Json {
        self.whole
    }

    fn put(&mut self, value: Json) {
        match self.open.last_mut() {
            Some((Json::Array(items), _)) => items.push(value),
            Some((Json::Object(entries), key)) => {
                entries.insert(std::mem::take(key), value);
            }
            _ => self.whole = value,
        }
    }

    fn begin(&mut self, empty: Json) {
        self.open.push((empty, String::new()));
    }

    fn end(&mut self) {
        if let Some((value, _)) = self.open.pop() {
            self.put(value);
        }
    }
}

impl Writer for Grown {
    fn null(&mut self) {
        self.put(Json::Null);
    }
    fn truth(&mut self, value: bool) {
        self.put(value.into());
    }
    fn whole(&mut self, value: i64) {
        self.put(value.into());
    }
    fn count(&mut self, value: u64) {
        self.put(value.into());
    }
    fn number(&mut self, value: f64) {
        self.put(value.into());
    }
    fn text(&mut self, value: &str) {
        self.put(value.into());
    }
    fn begin_list(&mut self) {
        self.begin(Json::Array(Vec::new()));
    }
    fn end_list(&mut self) {
        self.end();
    }
    fn begin_map(&mut self) {
        self.begin(Json::Object(Map::new()));
    }
    fn key(&mut self, key: &str) {
        if let Some((_, next)) = self.open.last_mut() {
            key.clone_into(next);
        }
    }
    fn end_map(&mut self) {
        self.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn say(out: &mut dyn Writer) {
        out.begin_map();
        out.key("a \"list\"");
        out.begin_list();
        out.whole(-3);
        out.number(0.5);
        out.number(f64::NAN);
        out.count(u64::MAX);
        out.begin_list();
        out.end_list();
        out.begin_map();
        out.end_map();
        out.text("ä\n");
        out.end_list();
        out.key("b");
        out.begin_map();
        out.key("c");
        out.truth(true);
        out.key("d");
        out.null();
        out.end_map();
        out.key("e");
        out.number(1e300);
        out.end_map();
    }

    #[test]
    fn a_line_and_a_tree_say_the_same() {
        let mut tree = Grown::default();
        say(&mut tree);
        let tree = tree.finish();
        let said = json!({
            "a \"list\"": [-3, 0.5, null, u64::MAX, [], {}, "ä\n"], "b": { "c": true, "d": null }, "e": 1e300,
        });
        assert_eq!(tree, said);

        let mut line = Vec::new();
        let mut out = Line::new(&mut line);
        say(&mut out);
        out.finish().unwrap();
        assert_eq!(String::from_utf8(line).unwrap(), said.to_string());
    }

    #[test]
    fn what_cannot_be_written_is_told() {
        let mut room = [0; 8];
        let mut out = Line::new(&mut room[..]);
        say(&mut out);
        assert!(out.finish().is_err());
    }
}
