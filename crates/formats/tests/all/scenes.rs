//! Every scene of the project is read, written out and read again.

use crate::common;
use std::path::{Path, PathBuf};

use straal_formats::{Options, load, load_str};
use straal_scene::decode::{Describe, write_json};

/// All `.yaml` files below a folder of the project.
fn scenes(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
    let mut found = Vec::new();
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "yaml") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[test]
fn every_scene_of_the_project_round_trips() {
    let all = [scenes("scenes"), scenes("tests/scenes")].concat();
    assert!(all.len() >= 40, "only {} scenes found", all.len());
    for path in all {
        let text = std::fs::read_to_string(&path).unwrap();
        if text.contains("shared/") && common::shared().is_none() {
            continue;
        }
        let first = load(&path, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        assert!(first.warnings.list.is_empty(), "{}", first.warnings);
        let written = first.scene.write().to_string();
        let mut pieces = Vec::new();
        write_json(&first.scene, &mut pieces).unwrap();
        assert!(pieces == written.as_bytes(), "{}: piece by piece as in one", path.display());
        if first.files.is_empty() {
            assert_eq!(first.hash, *blake3::hash(&pieces).as_bytes(), "{}", path.display());
        }
        let base = path.parent().unwrap();
        let second =
            load_str("written", &written, base, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(first.scene, second.scene, "{}", path.display());
        assert_eq!(first.hash, second.hash, "{}", path.display());
    }
}
