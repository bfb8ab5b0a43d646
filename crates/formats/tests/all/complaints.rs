//! The text of every complaint about a scene, pinned down in `complaints.txt`.
//!
//! After a title, each entry of that file has a scene and, below a line of `----`, what is said about it. `camera` and
//! `world` are added to a scene that has none, unless the title begins with "whole". Run with `STRAAL_BLESS=1` to
//! write down what is said, then read the difference.

#![allow(clippy::print_stderr)] // what was written is said

use std::fmt::Write;
use std::path::Path;

use straal_formats::{Options, load_str};

const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/complaints.txt");

struct Case<'a> {
    title: &'a str,
    scene: &'a str,
    says: &'a str,
}

fn cases(table: &str) -> Vec<Case<'_>> {
    let parts = table.split("\n==== ").skip(1);
    let split = |part| {
        let (title, rest): (&str, &str) = str::split_once(part, '\n').expect("a title has a line of its own");
        let (scene, says) = rest.split_once("----\n").expect("a scene ends with ----");
        Case { title, scene, says: says.trim_end() }
    };
    parts.map(split).collect()
}

fn says(case: &Case<'_>) -> String {
    let mut text = case.scene.to_owned();
    if !case.title.starts_with("whole") {
        if !text.contains("camera:") {
            text += "camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }\n";
        }
        if !text.contains("world:") {
            text += "world: [sphere: { emission: 1 }]\n";
        }
    }
    let options = Options { lenient: case.title.contains("--lenient"), ..Options::default() };
    let base = Path::new("tests/data");
    match load_str("scene.yaml", &text, base, &options) {
        Ok(loaded) if loaded.warnings.list.is_empty() => "nothing\n".to_owned(),
        Ok(loaded) => loaded.warnings.to_string(),
        Err(complaints) => complaints.to_string(),
    }
}

#[test]
fn complaints_read_as_they_should() {
    let table = std::fs::read_to_string(TABLE).unwrap();
    let cases = cases(&table);
    assert!(cases.len() > 70, "only {} complaints are pinned", cases.len());
    if std::env::var_os("STRAAL_BLESS").is_some() {
        let mut out = table.split("\n==== ").next().unwrap_or("").to_owned();
        for case in &cases {
            write!(out, "\n==== {}\n{}----\n{}", case.title, case.scene, says(case)).unwrap();
        }
        std::fs::write(TABLE, out).unwrap();
        eprintln!("wrote {TABLE}");
        return;
    }
    let wrong: Vec<String> = cases
        .iter()
        .filter_map(|case| {
            let found = says(case);
            let differs = found.trim_end() != case.says;
            differs.then(|| format!("==== {}\nexpected\n{}\nfound\n{found}", case.title, case.says))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
