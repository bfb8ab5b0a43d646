//! The JSON Schema takes what the reader takes, and refuses the keys that it refuses.

use std::path::Path;

use serde_json::{Map, Value as Json, json};
use straal_formats::{Diagnostics, Options, load_str, yaml};
use straal_scene::tree::{Datum, Tree};

/// A tree as JSON.
fn plain(tree: &Tree) -> Json {
    match &tree.value {
        Datum::Null => Json::Null,
        Datum::Bool(b) => json!(b),
        Datum::Number(n) => json!(n),
        Datum::String(s) => json!(s),
        Datum::Sequence(items) => Json::Array(items.iter().map(plain).collect()),
        Datum::Mapping(entries) => {
            Json::Object(entries.iter().map(|e| (e.key.value.clone(), plain(&e.value))).collect())
        }
    }
}

fn read(text: &str) -> Json {
    let mut d = Diagnostics::default();
    let file = d.sources.add("scene.yaml", text);
    plain(&yaml::read(file, &yaml::Limits::default(), &mut d).unwrap())
}

/// As much of JSON Schema 2020-12 as the scene language needs; any other keyword fails the test.
fn takes(schema: &Json, value: &Json, root: &Json) -> bool {
    let keywords = schema.as_object().expect("a schema is an object");
    keywords.iter().all(|(keyword, rule)| {
        let any = |rule: &Json| rule.as_array().unwrap().iter().filter(|s| takes(s, value, root)).count();
        match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "default" | "pattern" => true,
            "$ref" => {
                let name = rule.as_str().unwrap().strip_prefix("#/$defs/").unwrap();
                takes(&root["$defs"][name], value, root)
            }
            "anyOf" => any(rule) > 0,
            "oneOf" => any(rule) == 1,
            "const" => value == rule,
            "enum" => rule.as_array().unwrap().contains(value),
            "type" => match rule.as_str().unwrap() {
                "null" => value.is_null(),
                "boolean" => value.is_boolean(),
                "number" => value.is_number(),
                "integer" => value.as_f64().is_some_and(|v| v.floor() == v),
                "string" => value.is_string(),
                "array" => value.is_array(),
                "object" => value.is_object(),
                other => panic!("unknown type {other}"),
            },
            "minimum" => value.as_f64().is_none_or(|v| v >= rule.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|v| v <= rule.as_f64().unwrap()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|v| v > rule.as_f64().unwrap()),
            "exclusiveMaximum" => value.as_f64().is_none_or(|v| v < rule.as_f64().unwrap()),
            "minLength" => value.as_str().is_none_or(|v| v.len() as u64 >= rule.as_u64().unwrap()),
            "minItems" => value.as_array().is_none_or(|v| v.len() as u64 >= rule.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|v| v.len() as u64 <= rule.as_u64().unwrap()),
            "items" => value.as_array().is_none_or(|v| v.iter().all(|v| takes(rule, v, root))),
            "required" => value
                .as_object()
                .is_none_or(|v| rule.as_array().unwrap().iter().all(|k| v.contains_key(k.as_str().unwrap()))),
            "properties" => value
                .as_object()
                .is_none_or(|v| v.iter().all(|(k, v)| rule.get(k).is_none_or(|s| takes(s, v, root)))),
            "additionalProperties" => value.as_object().is_none_or(|v| {
                let known = keywords.get("properties").and_then(Json::as_object);
                let others = v.iter().filter(|(k, _)| known.is_none_or(|p| !p.contains_key(*k)));
                others
                    .into_iter()
                    .all(|(_, v)| if rule.is_object() { takes(rule, v, root) } else { *rule == json!(true) })
            }),
            other => panic!("unknown keyword {other}"),
        }
    })
}

/// The value with each of its keys misspelt in turn.
fn misspelt(value: &Json) -> Vec<Json> {
    match value {
        Json::Array(items) => (0..items.len())
            .flat_map(|i| misspelt(&items[i]).into_iter().map(move |wrong| (i, wrong)))
            .map(|(i, wrong)| {
                let mut items = items.clone();
                items[i] = wrong;
                Json::Array(items)
            })
            .collect(),
        Json::Object(map) => {
            let mut all = Vec::new();
            for (key, inner) in map {
                let with = |name: &str, value: Json| {
                    let swap = |(k, v): (&String, &Json)| {
                        if k == key { (name.to_owned(), value.clone()) } else { (k.clone(), v.clone()) }
                    };
                    Json::Object(map.iter().map(swap).collect::<Map<_, _>>())
                };
                all.push(with(&format!("{key}zzz"), inner.clone()));
                all.extend(misspelt(inner).into_iter().map(|wrong| with(key, wrong)));
            }
            all
        }
        _ => Vec::new(),
    }
}

#[test]
fn schema_and_reader_agree() {
    let schema = straal_scene::schema();
    let whole = read(&std::fs::read_to_string("tests/data/everything.yaml").unwrap());
    assert!(takes(&schema, &whole, &schema), "the schema takes the scene that has everything");
    let wrong = misspelt(&whole);
    assert!(wrong.len() > 140, "only {} keys", wrong.len());
    for scene in wrong {
        let text = scene.to_string();
        let result = load_str("scene.json", &text, Path::new("tests/data"), &Options::default());
        let Err(complaints) = result else {
            panic!("a key ends in zzz, and nobody complains:\n{text}");
        };
        let complaints = complaints.to_string();
        // Names are free: a misspelt one is missed where it is used, which no schema sees.
        if !complaints.contains("there is no") {
            assert!(complaints.contains("zzz"), "{complaints}");
            assert!(!takes(&schema, &scene, &schema), "the schema takes\n{text}");
        }
    }
}

#[test]
fn schema_says_what_each_key_is() {
    let schema = straal_scene::schema();
    let definitions = schema["$defs"].as_object().unwrap();
    let mut keys = 0;
    for (name, definition) in definitions {
        let description = |s: &Json| s["description"].as_str().is_some_and(|d| d.ends_with('.'));
        assert!(description(definition), "{name} has no description");
        for (key, property) in definition["properties"].as_object().into_iter().flatten() {
            assert!(description(property), "{name}.{key} has no description");
            keys += 1;
        }
    }
    assert!(keys > 100, "only {keys} keys");
    let sphere = &definitions["Sphere"]["properties"]["radius"];
    assert_eq!(sphere["default"], json!(1));
    assert_eq!(sphere["anyOf"][0]["exclusiveMinimum"], json!(0));
    assert_eq!(sphere["anyOf"][1], json!({ "$ref": "#/$defs/Keyframes of a value" }));
    assert_eq!(definitions["Triangle"]["required"], json!(["vertices"]));
}

#[test]
fn schema_takes_every_scene_of_the_project() {
    let schema = straal_scene::schema();
    let mut count = 0;
    for folder in ["../../scenes", "../../scenes/reference", "../../tests/scenes"] {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            if entry.path().extension().is_some_and(|e| e == "yaml") {
                let scene = read(&std::fs::read_to_string(entry.path()).unwrap());
                assert!(takes(&schema, &scene, &schema), "{}", entry.path().display());
                count += 1;
            }
        }
    }
    assert!(count >= 40, "only {count} scenes found");
}
