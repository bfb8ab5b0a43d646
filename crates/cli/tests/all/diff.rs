//! `straal diff`

use crate::common::{BALL, Folder};

#[test]
fn chance_is_told_from_change() {
    let folder = Folder::with_scene(BALL);
    folder.write("bright.yaml", &BALL.replace("[1, 1, 1]", "[1.2, 1.2, 1.2]"));
    folder.json("render scene.yaml -o a.exr --replicates 8 --sampler random");
    folder.json("render scene.yaml -o b.exr --replicates 16 --seed 77 --sampler random");
    folder.json("render bright.yaml -o c.exr --replicates 16 --seed 77 --sampler random");

    let same = folder.straal("diff a.exr b.exr");
    assert_eq!(same.code, Some(0), "{same:?}");
    let other = folder.straal("diff a.exr c.exr");
    assert_eq!(other.code, Some(1), "{other:?}");
    assert_eq!(folder.straal("diff a.exr c.exr --heavy-tails").code, Some(1));

    let report = folder.json("diff a.exr b.exr --variance b.exr");
    assert!(report["relmse"].is_number() && report["relmse_biased"].is_number(), "{report}");
    assert_eq!(report["differ"], false);
    let run = folder.straal("diff a.exr c.exr --json");
    assert_eq!((run.code, run.json()["differ"].as_bool()), (Some(1), Some(true)));
}

#[test]
fn pictures_that_can_not_be_compared_are_refused() {
    let folder = Folder::with_scene(BALL);
    folder.json("render scene.yaml -o a.exr");
    folder.json("render scene.yaml -o b.exr --size 16x16");
    folder.json("render scene.yaml -o left.exr --crop 0,0,12,16");
    folder.json("render scene.yaml -o right.exr --crop 12,0,24,16");
    for (words, complaint) in [
        ("diff a.exr b.exr", "24 x 16"),
        ("diff left.exr right.exr", "different parts"),
        ("diff a.exr missing.exr", "can't read missing.exr"),
        ("diff a.exr scene.yaml", "can't read scene.yaml"),
        ("diff a.exr a.exr --variance b.exr", "16 x 16"),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(2), "{words}: {run:?}");
        assert!(run.err.contains(complaint), "{words}: {}", run.err);
    }
}

#[test]
fn pictures_in_other_numbers_are_brought_to_the_same() {
    let folder = Folder::with_scene(BALL);
    folder.json("render scene.yaml -o a.exr");
    folder.json("render scene.yaml -o xyz.exr --channels xyz");
    folder.json("render scene.yaml -o bands.exr --spectral --channels spectral:20");
    folder.json("render scene.yaml -o brighter.exr --channels xyz --seed 5 --spp 1 --max-depth 1");
    for (words, code) in [
        ("diff a.exr xyz.exr", 0),
        ("diff xyz.exr a.exr", 0),
        ("diff bands.exr xyz.exr", 0),
        ("diff a.exr brighter.exr", 1),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(code), "{words}: {run:?}");
    }
    let told = folder.straal("info xyz.exr").out;
    assert!(told.contains("CIE XYZ in place of R, G and B; white is D65"), "{told}");
    let told = folder.straal("info bands.exr").out;
    assert!(told.contains("linear RGB of srgb; radiance at 20 wavelengths"), "{told}");
    let run = folder.straal("render scene.yaml -o c.exr --channels spectral");
    assert!(run.code == Some(2) && run.err.contains("--spectral"), "{run:?}");
}
