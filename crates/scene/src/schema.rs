//! The JSON Schema (draft 2020-12) of the scene language, made from the same definitions as its reading.

use serde_json::{Map, Value as Json, json};

use crate::limit::Limit;
use crate::writer::Writer;

/// The schemas of named types, while they are gathered.
#[derive(Debug, Default)]
pub struct Definitions {
    map: Map<String, Json>,
}

impl Definitions {
    /// All of them by their names.
    pub fn into_map(self) -> Map<String, Json> {
        self.map
    }

    /// A reference to the type of that name, which `make` describes the first time it is met.
    pub fn refer(&mut self, name: &str, make: impl FnOnce(&mut Self) -> Json) -> Json {
        // What is the same for all types is compiled once.
        if self.is_new(name) {
            let schema = make(self);
            self.set(name, schema);
        }
        reference(name)
    }

    /// Whether a name is met for the first time; it has a place from then on.
    fn is_new(&mut self, name: &str) -> bool {
        let is_new = !self.map.contains_key(name);
        if is_new {
            self.set(name, Json::Null);
        }
        is_new
    }

    fn set(&mut self, name: &str, schema: Json) {
        self.map.insert(name.to_owned(), schema);
    }
}

/// A reference to the type of that name.
fn reference(name: &str) -> Json {
    json!({ "$ref": format!("#/$defs/{name}") })
}

/// The keys of a mapping, while they are gathered.
#[derive(Debug, Default)]
pub struct Properties {
    map: Map<String, Json>,
    required: Vec<&'static str>,
}

impl Properties {
    /// Adds a key; without a default it is required.
    pub fn add(&mut self, key: &'static str, docs: &[&str], schema: Json, default: Option<Json>) {
        let mut schema = described(docs, schema);
        match default {
            None => self.required.push(key),
            // An absent key is no value that could be written.
            Some(Json::Null) => {}
            Some(v) => {
                if let Json::Object(map) = &mut schema {
                    map.insert("default".to_owned(), v);
                }
            }
        }
        self.map.insert(key.to_owned(), schema);
    }

    /// The schema of the mapping.
    pub fn into_schema(self, docs: &[&str]) -> Json {
        let mut schema = json!({ "type": "object", "additionalProperties": false, "properties": self.map });
        if let (Json::Object(map), false) = (&mut schema, self.required.is_empty()) {
            map.insert("required".to_owned(), json!(self.required));
        }
        described(docs, schema)
    }
}

/// The choices of an externally tagged enum, while they are gathered.
#[derive(Debug, Default)]
pub struct Choices {
    list: Vec<Json>,
}

impl Choices {
    /// Adds a choice that is its bare name.
    pub fn word(&mut self, key: &str, docs: &[&str]) {
        self.list.push(described(docs, json!({ "const": key })));
    }

    /// Adds a choice with a payload; its bare name does as well when the payload may be empty.
    pub fn payload(&mut self, key: &str, docs: &[&str], schema: Json, may_be_empty: bool) {
        if may_be_empty {
            self.word(key, docs);
        }
        let schema = if may_be_empty { json!({ "anyOf": [schema, { "type": "null" }] }) } else { schema };
        let one = json!({
            "type": "object", "additionalProperties": false, "required": [key], "properties": { key: schema }
        });
        self.list.push(described(docs, one));
    }

    /// Adds a choice that is described elsewhere.
    pub fn or(&mut self, schema: Json, docs: &str) {
        self.list.push(described(&[docs], schema));
    }

    /// The schema of the enum.
    pub fn into_schema(self, docs: &[&str]) -> Json {
        described(docs, json!({ "oneOf": self.list }))
    }
}

/// A schema with its description, made of the lines of a doc comment.
pub fn described(docs: &[&str], schema: Json) -> Json {
    let text = docs.iter().map(|d| d.trim()).collect::<Vec<_>>().join(" ");
    let mut map = Map::new();
    map.insert("description".to_owned(), json!(text.trim()));
    if let Json::Object(rest) = schema {
        map.extend(rest);
    }
    Json::Object(map)
}

/// A number's schema.
pub fn number(kind: &str, limit: Limit) -> Json {
    let mut map = Map::new();
    map.insert("type".to_owned(), json!(kind));
    let (least, most) =
        if limit.open { ("exclusiveMinimum", "exclusiveMaximum") } else { ("minimum", "maximum") };
    if limit.min.is_finite() {
        map.insert(least.to_owned(), short(limit.min));
    }
    if limit.max.is_finite() {
        map.insert(most.to_owned(), short(limit.max));
    }
    Json::Object(map)
}

/// A number without `.0` when it is whole.
pub fn short(v: f64) -> Json {
    whole(v).map_or(json!(v), |v| json!(v))
}

/// The same, written.
pub fn write_number(v: f64, out: &mut dyn Writer) {
    match whole(v) {
        Some(v) => out.whole(v),
        None => out.number(v),
    }
}

/// A whole number that is told exactly.
fn whole(v: f64) -> Option<i64> {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    (v.floor() == v && v.abs() <= EXACT).then_some(v as i64)
}
