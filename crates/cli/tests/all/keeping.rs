//! Nothing is lost: checkpoints, renders that go on, and parts that are put together.

use crate::common::{BALL, Folder, Run};
use std::fs;
use std::time::Duration;

const CHECKPOINT: &str = "a.exr.checkpoint";

/// The end of the samples that a file of sums has; `None` while there is none.
fn samples_in(folder: &Folder, name: &str) -> Option<u32> {
    let bytes = fs::read(folder.path(name)).ok()?;
    let header = String::from_utf8_lossy(&bytes[16..bytes.len().min(4000)]).into_owned();
    let line = header.lines().find_map(|l| l.strip_prefix("samples "))?;
    line.split(' ').nth(1)?.parse().ok()
}

/// Runs the command, and kills it when there is another checkpoint than before; `None` when it ended by itself.
fn killed(folder: &Folder, words: &str, before: Option<&[u8]>) -> Option<Vec<u8>> {
    let mut child = folder.command(words).spawn().unwrap();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "{words}");
            return None;
        }
        let now = fs::read(folder.path(CHECKPOINT)).ok();
        if now.is_some() && now.as_deref() != before {
            // On every system the end of a process that can't do anything about it.
            child.kill().unwrap();
            child.wait().unwrap();
            return fs::read(folder.path(CHECKPOINT)).ok();
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Renders in one go, and again killed ten times: the same film and the same file.
fn ten_kills(scene: &str, options: &str) {
    let folder = Folder::with_scene(scene);
    let whole = folder.json(&format!("render scene.yaml -o whole.exr --checkpoint off {options}"));
    let words = format!("render scene.yaml -o a.exr --checkpoint 1ms --resume {options}");
    let mut kept = None;
    for kill in 0..10 {
        let farther = killed(&folder, &words, kept.as_deref());
        assert!(farther.is_some(), "it ended before the kill {kill}");
        kept = farther;
    }
    let kept = samples_in(&folder, CHECKPOINT).unwrap();
    let rest = folder.json(&words);
    assert_eq!(rest["resumed_samples"].as_u64().unwrap(), u64::from(kept), "{rest}");
    for key in ["film_hash", "samples", "passes", "noisy_blocks", "dropped", "complete"] {
        assert_eq!(rest[key], whole[key], "{key}");
    }
    assert_eq!(folder.names(), ["a.exr", "scene.yaml", "whole.exr"]);
    assert!(folder.read("a.exr") == folder.read("whole.exr"), "{options}");
}

#[test]
fn kills_lose_nothing() {
    ten_kills(BALL, "--spp 700");
}

#[test]
fn kills_lose_nothing_where_noise_decides() {
    ten_kills(BALL, "--noise 0.5%");
}

#[test]
fn kills_lose_nothing_of_wavelengths_and_splats() {
    let filtered = BALL.replace("size: [24, 16]", "size: [24, 16], filter: { gaussian: { radius: 2 } }");
    ten_kills(
        &filtered,
        "--spp 300 --splat --spectral --channels spectral:4 --crop 3,2,20,15 --sampler random",
    );
}

fn refused(run: &Run, told: &[&str]) {
    assert_eq!(run.code, Some(2), "{run:?}");
    for part in told {
        assert!(run.err.contains(part), "no `{part}` in {run:?}");
    }
}

/// A folder with the checkpoint of a render that time has ended after a few samples.
fn ended_by_time() -> (Folder, u64) {
    let folder = Folder::with_scene(BALL);
    let words = "render scene.yaml -o a.exr --spp 100000 --time 20ms --checkpoint 10s --json";
    let run = folder.straal(words);
    assert_eq!(run.code, Some(0), "{run:?}");
    let report = run.json();
    assert_eq!((&report["complete"], report["checkpoint"].as_str()), (&false.into(), Some(CHECKPOINT)));
    (folder, report["samples"].as_u64().unwrap())
}

#[test]
fn a_render_goes_on_where_time_ended_it() {
    let (folder, samples) = ended_by_time();
    let more = samples + 9;
    let whole = folder.json(&format!("render scene.yaml -o whole.exr --spp {more}"));
    let rest =
        folder.json(&format!("render scene.yaml -o a.exr --resume --spp {more} --threads 1 --isa scalar"));
    assert_eq!((&rest["film_hash"], &rest["checkpoint"]), (&whole["film_hash"], &serde_json::Value::Null));
    assert!(folder.read("a.exr") == folder.read("whole.exr"));
    // There is nothing left to go on from: it begins anew.
    let again = folder.straal(&format!("render scene.yaml -o a.exr --resume --spp {more}"));
    assert!(again.err.contains("beginning with the first sample"), "{again:?}");
    assert!(folder.read("a.exr") == folder.read("whole.exr"));
}

#[test]
fn another_render_does_not_go_on() {
    let folder = Folder::with_scene(BALL);
    let words = "render scene.yaml -o a.exr --spp 100000 --checkpoint 1ms --resume";
    while samples_in(&folder, CHECKPOINT) <= Some(8) {
        let kept = fs::read(folder.path(CHECKPOINT)).ok();
        killed(&folder, words, kept.as_deref());
    }
    let before = folder.read(CHECKPOINT);
    folder.write("other.yaml", &BALL.replace("0.5, 0]", "0.4, 0]"));
    for (words, told) in [
        ("render other.yaml -o a.exr --spp 100000", "scene hash"),
        ("render scene.yaml -o a.exr --spp 100000 --seed 7", "seed 0 there and 7 here"),
        ("render scene.yaml -o a.exr --spp 100000 --sampler halton", "sampler sobol there and halton here"),
        ("render scene.yaml -o a.exr --spp 100000 --size 12x8", "size 24x16 there and 12x8 here"),
        ("render scene.yaml -o a.exr --spp 100000 --max-depth 2", "max depth unlimited there and 2 here"),
        ("render scene.yaml -o a.exr --spp 100000 --spectral", "light rgb there and wavelengths here"),
        ("render scene.yaml -o a.exr --spp 100000 --noise 3%", "noise none there and 0.03 here"),
        ("render scene.yaml -o a.exr --spp 1", "more than the 1 that are wanted"),
    ] {
        refused(&folder.straal(&format!("{words} --resume")), &[CHECKPOINT, told, "leave out --resume"]);
        assert!(folder.read(CHECKPOINT) == before, "{words}");
    }
    let run = folder.straal("render scene.yaml -o a.exr --spp 4 --replicates 2 --resume");
    refused(&run, &["--resume can't be used with --replicates", "--seed"]);
    // What isn't asked to go on says so.
    let run = folder.straal("render scene.yaml -o a.exr");
    assert!(run.err.contains("isn't used without --resume"), "{run:?}");
}

#[test]
fn damaged_checkpoints_are_told() {
    let (folder, _) = ended_by_time();
    let bytes = folder.read(CHECKPOINT);
    let resume = |bytes: &[u8]| {
        fs::write(folder.path(CHECKPOINT), bytes).unwrap();
        let run = folder.straal("render scene.yaml -o b.exr -o a.exr --spp 100000 --time 1ms --resume");
        refused(&run, &["a.exr.checkpoint", "leave out --resume"]);
        run.err
    };
    for length in [0, 7, 8, 15, 16, 100, bytes.len() / 2, bytes.len() - 1] {
        let told = resume(&bytes[..length]);
        let expected = if length == 0 { "is empty" } else { "cut off" };
        assert!(told.contains(expected), "{length}: {told}");
    }
    for place in [0, 8, 12, 13, 14, 15, 20, 200, bytes.len() / 2, bytes.len() - 1] {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x40;
        let told = resume(&damaged);
        assert!(!told.contains("has a bug"), "{place}: {told}");
    }
    assert!(resume(&[bytes.as_slice(), b"more"].concat()).contains("is damaged"));
    assert!(resume(b"P6 1 1 255 and something else").contains("no sums of straal"));
    assert_eq!(folder.names(), ["a.exr", CHECKPOINT, "scene.yaml"]);
}

/// Renders parts, one for each list of options, and merges them in the wrong order.
fn merged(folder: &Folder, common: &str, parts: &[&str]) -> serde_json::Value {
    let mut names = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        let name = format!("{i}.sums");
        let report = folder.json(&format!("render scene.yaml {common} {part} --save-sums {name}"));
        assert_eq!(report["sums"], name.as_str());
        names.insert(0, name);
    }
    let both = folder.json(&format!("merge {} -o m.exr -o m.png", names.join(" ")));
    let whole = folder.json(&format!("render scene.yaml {common} -o w.exr -o w.png"));
    for key in ["film_hash", "scene_hash", "samples", "size", "crop"] {
        assert_eq!(both[key], whole[key], "{common} {key}");
    }
    for [merged, whole] in [["m.exr", "w.exr"], ["m.png", "w.png"]] {
        assert!(folder.read(merged) == folder.read(whole), "{common} {merged}");
    }
    both
}

#[test]
fn parts_make_the_whole() {
    let folder = Folder::with_scene(&BALL.replace("size: [24, 16]", "size: [24, 16], exposure: 1"));
    merged(&folder, "--spp 24", &["--samples 0..5", "--samples 5..17", "--samples 17..24"]);
    merged(&folder, "--spp 16", &["--samples 0..8", "--samples 8..16 --threads 1"]);
    merged(&folder, "--spp 12 --sampler multi_jittered", &["--samples 0..3", "--samples 3..12"]);
    merged(
        &folder,
        "--spp 9 --spectral --channels spectral --splat --sampler random",
        &["--samples 0..1", "--samples 1..9"],
    );
    merged(&folder, "--spp 7", &["--crop 0,0,9,16", "--crop 9,0,24,5", "--crop 9,5,24,16"]);
    merged(&folder, "--spp 300 --noise 3%", &["--crop 0,0,9,16", "--crop 9,0,24,16"]);
    assert!(!folder.path("scene.png").exists(), "sums alone make no picture");
}

#[test]
fn what_does_not_fit_together_is_told() {
    let folder = Folder::with_scene(BALL);
    for (name, words) in [
        ("a", "--samples 0..4 --spp 8"),
        ("b", "--samples 4..8 --spp 8"),
        ("c", "--samples 3..8 --spp 8"),
        ("d", "--samples 6..8 --spp 8"),
        ("e", "--samples 4..8 --spp 8 --seed 3"),
        ("left", "--crop 0,0,8,16"),
        ("right", "--crop 9,0,24,16"),
        ("wide", "--crop 7,0,24,16"),
    ] {
        folder.json(&format!("render scene.yaml --save-sums {name} {words}"));
    }
    for (words, told) in [
        ("a", "samples 4..8 of the crop 0,0,24,16 are in none"),
        ("b", "samples 0..4 of the crop 0,0,24,16 are in none"),
        ("a d", "samples 4..6 of the crop 0,0,24,16 are in none"),
        ("a c", "samples 3..4 are in a and in c"),
        ("a b a", "samples 0..4 are in a and in a"),
        ("a e", "seed 0 in a, 3 in e"),
        ("left right", "leave 16 pixels"),
        ("left wide", "overlap"),
        ("a scene.yaml", "scene.yaml: it holds no sums of straal"),
        ("a none", "can't read none"),
    ] {
        refused(&folder.straal(&format!("merge {words} -o x.png")), &[told]);
    }
    assert!(!folder.path("x.png").exists());
    let run = folder.straal("merge d a -o x.exr --allow-gaps --json");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.err.contains("warning: samples 4..6"), "{run:?}");
    assert_eq!(run.json()["samples"], 6);
    refused(&folder.straal("merge a b -o a"), &["can't tell the format"]);
    fs::copy(folder.path("a"), folder.path("a.exr")).unwrap();
    refused(&folder.straal("merge a.exr b -o a.exr"), &["would replace what it is made from"]);
}

#[test]
fn parts_that_can_not_be_are_refused() {
    let folder = Folder::with_scene(BALL);
    for (words, told) in [
        ("--samples 0..64 --sampler hammersley", "must know how many there are in all, and that is 4"),
        ("--samples 4..9 --spp 8", "there are 8 of them"),
        ("--samples 0..4 --noise 2%", "decided by those before"),
        ("--samples 4..4", "the first must be less than the end"),
        ("--samples 4", "such as 64..128"),
        ("--samples 0..999999", "of at most 262144"),
        ("--samples 0..4 --replicates 2", "can't be used with --replicates"),
        ("--save-sums no/a.sums", "there is no folder no"),
        ("--save-sums scene.yaml", "would replace"),
    ] {
        let words = format!(
            "render scene.yaml {words} {}",
            if words.contains("save") { "" } else { "--save-sums a" }
        );
        refused(&folder.straal(&words), &[told]);
        assert_eq!(folder.names(), ["scene.yaml"], "{words}");
    }
}

#[test]
fn sums_tell_what_they_are() {
    let folder = Folder::with_scene(BALL);
    folder.json("render scene.yaml --save-sums a.sums --samples 1..3 --seed 9");
    let told = folder.json("info a.sums");
    assert_eq!(told["sums_of_samples"], serde_json::json!([1, 3]));
    assert_eq!(told["metadata"]["straal.seed"], "9");
    let text = folder.straal("info a.sums").out;
    assert!(text.contains("record count:u32 dropped:u32") && text.contains("batch_ends:6xi128"), "{text}");
    let mut bytes = folder.read("a.sums");
    let last = bytes.len() - 100;
    bytes[last] ^= 1;
    fs::write(folder.path("a.sums"), bytes).unwrap();
    refused(&folder.straal("info a.sums"), &["it is damaged"]);
    refused(&folder.straal("merge a.sums -o a.png --allow-gaps"), &["it is damaged"]);
}

#[test]
fn a_checkpoint_of_what_is_there_by_now_goes() {
    let (folder, _) = ended_by_time();
    let run = folder.straal("render scene.yaml -o a.exr --spp 2");
    assert!(run.err.contains("isn't used without --resume"), "{run:?}");
    assert_eq!(folder.names(), ["a.exr", "scene.yaml"]);
    // That of another render isn't this one's to remove.
    let (folder, _) = ended_by_time();
    folder.json("render scene.yaml -o a.exr --spp 2 --seed 5");
    assert_eq!(folder.names(), ["a.exr", CHECKPOINT, "scene.yaml"]);
}

/// A picture that can't be written is no reason to lose what was rendered.
#[test]
fn a_checkpoint_stays_until_the_picture_is_there() {
    let folder = Folder::with_scene(BALL);
    fs::create_dir(folder.path("out")).unwrap();
    let words = "render scene.yaml -o out/a.exr --spp 300 --checkpoint 1ms --resume";
    let mut child = folder.command(words).spawn().unwrap();
    while samples_in(&folder, "out/a.exr.checkpoint").is_none() {
        assert!(child.try_wait().unwrap().is_none(), "it ended without a checkpoint");
        std::thread::sleep(Duration::from_millis(1));
    }
    // A folder of the picture's name: nothing can be written there, by whomever.
    fs::create_dir(folder.path("out/a.exr")).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(3));
    assert!(samples_in(&folder, "out/a.exr.checkpoint").is_some());
    fs::remove_dir(folder.path("out/a.exr")).unwrap();
    let rest = folder.json(words);
    let whole = folder.json("render scene.yaml -o whole.exr --spp 300");
    assert_eq!(rest["film_hash"], whole["film_hash"]);
    assert!(rest["resumed_samples"].as_u64() > Some(0));
}
