//! The book's page of all keys, made from the definition that scenes are read by.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write;

/// The page's file.
pub const FILE: &str = "keys.md";

/// How the page begins.
const HEAD: &str = "\
# All keys of the scene language

<!-- The list is written by `cargo xtask book`; don't edit it. -->

This list is made from the definition that scenes are read by. What it lists by kind is explained in [the scene language](scene-language.md) and on the
pages of the course.
";

/// The page, up to the line that leads on.
pub fn text_of_page() -> String {
    page(&straal_scene::schema())
}

/// A section for each mapping and each choice, in the order in which a scene comes to them.
fn page(schema: &Value) -> String {
    let mut out = String::from(HEAD);
    let Some(types) = schema["$defs"].as_object() else { return out };
    for (name, t) in types {
        let _ = write!(out, "\n## {name}\n\n{}\n\n", text(t));
        if let Some(choices) = t["oneOf"].as_array() {
            out += "| one of | is |\n|---|---|\n";
            for (key, payload, docs) in merged(choices) {
                let what = payload.map_or(String::new(), |p| format!(": {}", kind(p)));
                let _ = writeln!(out, "| `{key}`{what} | {docs} |");
            }
            for other in choices.iter().filter(|c| c["$ref"].is_string()) {
                let _ = writeln!(out, "| the keys of {} | {} |", kind(other), text(other));
            }
        } else if let Some(keys) = t["properties"].as_object() {
            let required: BTreeSet<&str> =
                t["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
            out += "| key | takes | when absent | is |\n|---|---|---|---|\n";
            for (key, k) in keys {
                let absent = match k.get("default") {
                    Some(v) => format!("`{}`", v.to_string().replace(',', ", ").replace(':', ": ")),
                    None if required.contains(key.as_str()) => "must be given".to_owned(),
                    None => String::new(),
                };
                let _ = writeln!(out, "| `{key}` | {} | {absent} | {} |", kind(k), text(k));
            }
        }
    }
    out
}

/// What a type or key says of itself, fit for a cell of a table.
fn text(t: &Value) -> String {
    t["description"].as_str().unwrap_or_default().replace('|', "\\|")
}

/// The choices of an enum. One whose payload may be left out is listed twice in a schema: by its bare name and with
/// its payload.
fn merged(choices: &[Value]) -> Vec<(String, Option<&Value>, String)> {
    let mut out: Vec<(String, Option<&Value>, String)> = Vec::new();
    for c in choices {
        let tagged = c["properties"].as_object().and_then(|p| p.iter().next());
        let (key, payload) = match (c["const"].as_str(), tagged) {
            (Some(word), _) => (word.to_owned(), None),
            (None, Some((key, payload))) => (key.clone(), Some(payload)),
            (None, None) => continue,
        };
        match out.iter_mut().find(|(k, ..)| *k == key) {
            Some(seen) => seen.1 = payload,
            None => out.push((key, payload, text(c))),
        }
    }
    out
}

/// What a key takes, in words.
fn kind(t: &Value) -> String {
    if let Some(name) = t["$ref"].as_str().and_then(|r| r.rsplit('/').next()) {
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(choices) = t["anyOf"].as_array() {
        let real: Vec<&Value> = choices.iter().filter(|c| c["type"] != "null").collect();
        // A number, three numbers or #rrggbb: that is how colours are written.
        if real.iter().any(|c| c["pattern"].as_str().is_some_and(|p| p.starts_with("^#"))) {
            return format!("colour{}", limits(real[0]));
        }
        let mut words: Vec<String> = real.into_iter().map(kind).collect();
        words.dedup();
        return words.join(" or ");
    }
    if let Some(word) = t["const"].as_str() {
        return format!("`{word}`");
    }
    if let Some(words) = t["enum"].as_array() {
        return words
            .iter()
            .filter_map(Value::as_str)
            .map(|w| format!("`{w}`"))
            .collect::<Vec<_>>()
            .join(", ");
    }
    match t["type"].as_str() {
        Some("array") => {
            let (least, most) = (t["minItems"].as_u64(), t["maxItems"].as_u64());
            let of = kind(&t["items"]);
            match (least, most) {
                (Some(n), Some(m)) if n == m => format!("[{n} x {of}]"),
                _ => format!("list of {of}"),
            }
        }
        Some("object") => match &t["additionalProperties"] {
            Value::Object(_) => format!("mapping of names to {}", kind(&t["additionalProperties"])),
            _ => "mapping".to_owned(),
        },
        Some(number @ ("number" | "integer")) => format!("{number}{}", limits(t)),
        Some("boolean") => "`true` or `false`".to_owned(),
        Some("string") => "text".to_owned(),
        _ => String::new(),
    }
}

/// The range of a number.
fn limits(t: &Value) -> String {
    let shown = |key: &str| t.get(key).map(Value::to_string);
    match (shown("minimum"), shown("maximum"), shown("exclusiveMinimum"), shown("exclusiveMaximum")) {
        // The largest that a 32-bit number holds isn't worth telling.
        (Some(a), Some(b), ..) if b != u32::MAX.to_string() => format!(" from {a} to {b}"),
        (Some(a), ..) => format!(", {a} or more"),
        (_, _, Some(a), Some(b)) => format!(" between {a} and {b}"),
        (_, _, Some(a), None) => format!(" above {a}"),
        _ => String::new(),
    }
}
