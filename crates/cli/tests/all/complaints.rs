//! Bad scenes: all that is wrong in one go, and nothing written.

use crate::common;

use crate::common::{BALL, Folder};
use serde_json::{Value as Json, json};

const WRONG: &str = "\
camera:
  perspective: { eye: [0, 1, 4], lok_at: [0, 0.5, 0], fov: 40 }
film: { size: [24, wide] }
materials:
  clay: { diffuse: { reflectance: 0.5 } }
world:
  - sphere: { radius: -1, material: caly }
  - mesh: { file: missing.ply }
";

#[test]
fn all_that_is_wrong_is_told_at_once() {
    let folder = Folder::with_scene(WRONG);
    let told = include_str!("../complaints.txt");
    for words in ["render scene.yaml -o a.png", "check scene.yaml"] {
        let run = folder.straal(words);
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{words}: {run:?}");
        assert_eq!(run.err, told, "{words}:\n{}", run.err);
        assert_eq!(folder.names(), ["scene.yaml"]);
    }
}

#[test]
fn scripts_get_the_same() {
    let folder = Folder::with_scene(WRONG);
    let run = folder.straal("check scene.yaml --json");
    assert_eq!(run.code, Some(2));
    let report = run.json();
    assert_eq!(report["exit_code"], 2);
    let list = report["diagnostics"].as_array().unwrap();
    let misspelt = list.iter().find(|d| d["message"].as_str().unwrap().contains("lok_at")).unwrap();
    assert_eq!(misspelt["place"], json!({ "file": "scene.yaml", "line": 2, "column": 34 }));
    assert_eq!(misspelt["severity"], "error");
    assert!(misspelt["help"].as_str().unwrap().contains("`look_at`"));
}

#[test]
fn lenient_takes_unknown_keys_for_warnings() {
    let folder = Folder::with_scene(&format!("{BALL}extra: 1\n"));
    assert_eq!(folder.straal("check scene.yaml").code, Some(2));
    let run = folder.straal("check scene.yaml --lenient");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.err.starts_with("warning: "), "{run:?}");
    let report = folder.json("render scene.yaml --lenient");
    assert_eq!(report["diagnostics"][0]["severity"], "warning");
}

#[test]
fn a_good_scene_is_forecast() {
    let folder = Folder::with_scene(BALL);
    let run = folder.straal("check scene.yaml");
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{run:?}");
    assert!(run.out.starts_with("scene.yaml: in order\n") && run.out.contains("24 x 16 pixels"), "{run:?}");
    assert_eq!(folder.names(), ["scene.yaml"]);
    let memory = folder.json("check scene.yaml")["memory_bytes"].clone();
    let bytes = |key: &str| memory[key].as_u64().unwrap();
    let parts = ["program", "geometry", "search", "images", "film", "layers", "threads"].map(bytes);
    assert!(parts.iter().sum::<u64>() <= bytes("total") + bytes("building"));
    assert!(bytes("film") >= 24 * 16 * 64);
    let film =
        |words: &str| folder.json(&format!("check scene.yaml {words}"))["memory_bytes"]["film"].as_u64();
    assert!(film("-o a.exr") > film("") && film("--size 48x16") > film("") && film("--splat") > film(""));
}

#[test]
fn the_schema_knows_every_key_of_a_scene() {
    let folder = Folder::new();
    let run = folder.straal("schema");
    assert_eq!(run.code, Some(0));
    let schema = run.json();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    let mut known = Vec::new();
    properties(&schema, &mut known);
    for line in BALL.lines() {
        for word in line.split([' ', '{', '}', ',', '-']).filter_map(|w| w.strip_suffix(':')) {
            assert!(known.iter().any(|k| k == word), "{word}");
        }
    }
}

/// All names of properties, at any depth.
fn properties(schema: &Json, known: &mut Vec<String>) {
    match schema {
        Json::Object(map) => {
            for (key, value) in map {
                if let ("properties", Some(map)) = (key.as_str(), value.as_object()) {
                    known.extend(map.keys().cloned());
                }
                properties(value, known);
            }
        }
        Json::Array(list) => list.iter().for_each(|v| properties(v, known)),
        _ => {}
    }
}

#[test]
fn nobody_has_to_read_to_the_end() {
    let folder = Folder::new();
    let mut child = folder.command("schema").spawn().unwrap();
    drop(child.stdout.take());
    let run: common::Run = child.wait_with_output().unwrap().into();
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
}
