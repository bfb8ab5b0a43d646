//! `straal accel` as a person and a script meet it.

use crate::common::{BALL, Folder};

const WORDS: &str = "accel scene.yaml --rays 200 --rounds 1";

#[test]
fn people_get_a_table() {
    let folder = Folder::with_scene(BALL);
    let run = folder.straal(WORDS);
    assert_eq!(run.code, Some(0), "{run:?}");
    for part in
        ["bvh", "brute", "build, ms", "Mrays/s", "pays off after", "equal to the last bit", "does a box"]
    {
        assert!(run.out.contains(part), "{part}: {}", run.out);
    }
    assert!(run.err.contains("recording rays"), "{run:?}");
    let quiet = folder.straal(&format!("{WORDS} -q"));
    assert_eq!((quiet.code, quiet.err.as_str()), (Some(0), ""));
    assert_eq!(folder.names(), ["scene.yaml"]);
}

#[test]
fn scripts_get_one_object() {
    let folder = Folder::with_scene(BALL);
    let report = folder.json(&format!("{WORDS} --structures brute"));
    let structures = report["structures"].as_array().unwrap();
    let names: Vec<_> = structures.iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["bvh", "brute"]);
    for s in structures {
        assert_eq!(s["hits_equal"], true);
        for key in ["build_seconds", "bytes", "primitive_tests_per_ray", "mrays_per_second"] {
            assert!(s[key].is_number(), "{key}: {s}");
        }
    }
}

#[test]
fn a_page_needs_no_other_file() {
    let folder = Folder::with_scene(BALL);
    let run = folder.straal(&format!("{WORDS} --html lab.html"));
    assert_eq!(run.code, Some(0), "{run:?}");
    let page = String::from_utf8(folder.read("lab.html")).unwrap();
    assert!(
        page.starts_with("<!doctype html>") && page.contains("scene.yaml") && page.contains("data:image/png")
    );
    assert!(!page.contains("http") && !page.contains("<script"));
}

#[test]
fn wrong_wishes_are_told() {
    let folder = Folder::with_scene(BALL);
    for (words, complaint) in [
        ("--structures bhv", "did you mean `bvh`?"),
        ("--structures bvh:biuld=fast", "did you mean `build`?"),
        ("--structures bvh,,brute", "a comma too many in `bvh,,brute`"),
        ("--structures bvh2,", "a comma too many in `bvh2,`"),
        ("--structures bvh,tre", "`tre` is no search structure"),
        ("--moving teapot", "there is no object `teapot`"),
        ("--moving 3", "the world has 2 objects, numbered from 1"),
        ("--rays 0", "write a whole number from 1"),
        ("--html no/lab.html", "there is no folder no"),
        ("--html scene.yaml", "scene.yaml would replace what it is made from"),
    ] {
        let run = folder.straal(&format!("accel scene.yaml {words}"));
        assert_eq!(run.code, Some(2), "{words}: {run:?}");
        assert!(run.err.contains(complaint), "{words}: {}", run.err);
        assert_eq!(folder.names(), ["scene.yaml"], "{words}");
    }
    let run = folder.straal("accel scene.yml");
    assert_eq!(run.code, Some(2));
    assert!(run.err.contains("did you mean `scene.yaml`?"), "{run:?}");
}
