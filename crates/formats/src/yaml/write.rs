//! A tree of values as YAML that people read: a key a line, and in one line what fits there.

use serde_json::Value as Json;

use super::resolve;
use straal_scene::tree::Datum;

/// Longest line, in bytes, that lists and mappings are written in.
const WIDTH: usize = 110;

/// The text of a tree, which [`super::read`] reads as the same tree.
pub fn write(tree: &Json) -> String {
    let mut out = String::new();
    block(tree, 0, &mut out);
    out
}

/// The lines of a value, each indented by so much; the first one's indentation is there already when the text doesn't end with
/// a line.
fn block(value: &Json, indent: usize, out: &mut String) {
    match value {
        Json::Object(map) if !map.is_empty() => {
            for (key, value) in map {
                begin(indent, out);
                out.push_str(&word(key));
                out.push(':');
                behind(value, indent, '\n', out);
            }
        }
        Json::Array(list) if !list.is_empty() => {
            for value in list {
                begin(indent, out);
                out.push('-');
                behind(value, indent, ' ', out);
            }
        }
        simple => {
            begin(indent, out);
            out.push_str(&flow(simple));
            out.push('\n');
        }
    }
}

fn begin(indent: usize, out: &mut String) {
    if out.is_empty() || out.ends_with('\n') {
        out.extend(std::iter::repeat_n(' ', indent));
    }
}

/// A value behind its key or the mark of an item: in the same line where it fits, else as lines of its own, which begin after `gap`.
fn behind(value: &Json, indent: usize, gap: char, out: &mut String) {
    let line = flow(value);
    if fits(value, &line, indent) {
        out.push(' ');
        out.push_str(&line);
        out.push('\n');
    } else {
        out.push(gap);
        block(value, indent + 2, out);
    }
}

/// Whether a value is written in one line: what is simple always, a list or a mapping where it is short and holds none that
/// holds others.
fn fits(value: &Json, line: &str, indent: usize) -> bool {
    depth(value) == 0 || depth(value) <= 3 && indent + line.len() < WIDTH
}

fn depth(value: &Json) -> usize {
    match value {
        Json::Object(map) if !map.is_empty() => 1 + map.values().map(depth).max().unwrap_or(0),
        Json::Array(list) if !list.is_empty() => 1 + list.iter().map(depth).max().unwrap_or(0),
        _ => 0,
    }
}

fn flow(value: &Json) -> String {
    match value {
        Json::Object(map) if map.is_empty() => "{}".to_owned(),
        Json::Object(map) => {
            let pairs: Vec<_> = map.iter().map(|(k, v)| format!("{}: {}", word(k), flow(v))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
        Json::Array(list) => format!("[{}]", list.iter().map(flow).collect::<Vec<_>>().join(", ")),
        Json::String(text) => word(text),
        other => other.to_string(),
    }
}

/// A string, bare where that can't be taken for anything else.
fn word(text: &str) -> String {
    let plain = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_' || c == '.' || c == '/')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.' | '/' | '+'));
    if plain && matches!(resolve(text.to_owned()), Datum::String(_)) {
        return text.to_owned();
    }
    // A string of JSON is one of YAML, but for what only JSON lets stand as it is.
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}') => {
                quoted.push_str(&format!("\\u{:04x}", c as u32));
            }
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn short_values_are_lines_and_long_ones_blocks() {
        let long: Vec<[f64; 3]> = (0..40).map(|i| [f64::from(i), 0.5, -1e-7]).collect();
        let tree = json!({
            "camera": { "perspective": { "eye": [0, 1.5, 3], "look_at": [0, 0, 0] } },
            "none": {}, "empty": [], "words": ["yes", "true", "1e3", "~", "a b", "#fff", "x: y", "a\"b\\\n\u{1}é", ""],
            "world": [{ "mesh": { "file": "../a/b.ply", "positions": long } }, "sphere"],
        });
        let text = write(&tree);
        assert!(
            text.starts_with("camera: { perspective: { eye: [0, 1.5, 3], look_at: [0, 0, 0] } }\n"),
            "{text}"
        );
        assert!(
            text.contains(
                "world:\n  - mesh:\n      file: ../a/b.ply\n      positions:\n        - [0.0, 0.5, -1e-7]\n"
            ),
            "{text}"
        );
        assert!(text.ends_with("  - sphere\n"), "{text}");
        assert!(text.lines().all(|l| l.len() < 120), "{text}");

        let mut d = straal_scene::Diagnostics::default();
        let file = d.sources.add("written", &text);
        let read = super::super::read(file, &super::super::Limits::default(), &mut d);
        assert!(d.list.is_empty(), "{d}");
        let back = as_json(&read.unwrap());
        assert_eq!(back, tree_of_floats(&tree));
    }

    /// YAML has one kind of number.
    fn tree_of_floats(tree: &Json) -> Json {
        match tree {
            Json::Object(map) => map.iter().map(|(k, v)| (k.clone(), tree_of_floats(v))).collect(),
            Json::Array(list) => list.iter().map(tree_of_floats).collect(),
            Json::Number(n) => json!(n.as_f64()),
            other => other.clone(),
        }
    }

    fn as_json(tree: &straal_scene::tree::Tree) -> Json {
        match &tree.value {
            Datum::Null => Json::Null,
            Datum::Bool(b) => json!(b),
            Datum::Number(n) => json!(n),
            Datum::String(s) => json!(s),
            Datum::Sequence(list) => list.iter().map(as_json).collect(),
            Datum::Mapping(map) => map.iter().map(|e| (e.key.value.clone(), as_json(&e.value))).collect(),
        }
    }
}
