//! What is said to people and to scripts: words of other programs, standard input and output, one object whatever happens.

use crate::common::{BALL, Folder, Run};
use std::io::Write;
use std::process::Stdio;

/// Runs the command with something on standard input; the bytes of standard output, and what was said.
fn with_input(folder: &Folder, words: &str, input: &[u8]) -> (Option<i32>, Vec<u8>, String) {
    let mut child = folder.command(words).stdin(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    let o = child.wait_with_output().unwrap();
    (o.status.code(), o.stdout, String::from_utf8(o.stderr).unwrap())
}

#[test]
fn a_scene_comes_in_and_a_picture_goes_out_through_pipes() {
    let folder = Folder::with_scene(BALL);
    folder.json("render scene.yaml -o file.png");
    let (code, picture, said) = with_input(&folder, "render - -o -", BALL.as_bytes());
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(picture, folder.read("file.png"), "nothing but the picture is on standard output");
    let (code, exr, said) = with_input(&folder, "render - -o - --format exr -q", BALL.as_bytes());
    assert!(code == Some(0) && said.is_empty() && exr.starts_with(&[0x76, 0x2f, 0x31, 0x01]), "{said}");
    // On through the next command.
    let (code, png, said) = with_input(&folder, "develop - -o -", &exr);
    assert!(code == Some(0) && png.starts_with(b"\x89PNG"), "{said}");
    let (code, story, said) = with_input(&folder, "info - --json", &exr);
    assert_eq!(code, Some(0), "{said}");
    assert!(String::from_utf8(story).unwrap().contains("film_hash"));
    assert_eq!(folder.names(), ["file.png", "scene.yaml"]);
}

#[test]
fn a_mesh_may_come_through_a_pipe() {
    let folder = Folder::new();
    let obj = b"# by hand\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    for mesh in [obj.as_slice(), ply] {
        let (code, picture, said) = with_input(&folder, "render - -o - --size 16x9 --spp 1", mesh);
        assert!(code == Some(0) && picture.starts_with(b"\x89PNG"), "{said}");
    }
}

#[test]
fn what_pipes_can_not_do_is_told() {
    let folder = Folder::with_scene(BALL);
    for (words, complaint) in [
        ("render scene.yaml -o - --json", "can't share standard output"),
        ("render scene.yaml -o - -o -", "- is named twice"),
        ("render scene.yaml --format exr", "--format is for `-o -`"),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(2), "{words}: {run:?}");
        assert!(run.err.contains(complaint), "{words}: {}", run.err);
    }
    let (code, _, said) = with_input(&folder, "check -", b"camera: {");
    assert!(code == Some(2) && said.contains("standard input:1"), "{said}");
}

/// Whatever goes wrong: with --json there is one object on standard output, which says so.
#[test]
fn scripts_always_get_one_object() {
    let folder = Folder::with_scene(BALL);
    folder.write("bad.yaml", "camera: 1\n");
    folder.json("render scene.yaml -o a.exr");
    for (words, code) in [
        ("render scene.yaml --spp many --json", 2),
        ("render scene.yaml --samples-per-pixel 4 --json", 2),
        ("rendr --json", 2),
        ("render missing.yaml --json", 2),
        ("render bad.yaml --json", 2),
        ("render scene.yaml -o no/a.png --json", 2),
        ("check bad.yaml --json", 2),
        ("accel missing.yaml --json", 2),
        ("diff a.exr missing.exr --json", 2),
        ("diff a.exr scene.yaml --json", 2),
        ("info missing.exr --json", 2),
        ("info scene.yaml --json", 2),
        ("develop missing.exr -o b.png --json", 2),
        ("develop a.exr --json", 2),
        ("gamma-chart -o chart.exr --json", 2),
        ("metamer missing.spd other.spd --json", 2),
        ("sampler sobel --json", 2),
        ("sampler sobol --json", 0),
        ("develop a.exr -o b.png --json", 0),
        ("gamma-chart -o chart.png --json", 0),
        ("info a.exr --json", 0),
        ("diff a.exr a.exr --json", 0),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(code), "{words}: {run:?}");
        let report = run.json();
        assert!(report.is_object(), "{words}: {report}");
        if code != 0 {
            assert_eq!(report["exit_code"], code, "{words}");
            assert!(report["error"].as_str().is_some_and(|e| !e.is_empty()), "{words}");
        }
    }
}

#[test]
fn equal_pictures_are_called_identical() {
    let folder = Folder::with_scene(BALL);
    folder.json("render scene.yaml -o a.exr");
    folder.json("render scene.yaml -o b.exr");
    folder.json("render scene.yaml -o c.exr --seed 3");
    let same = folder.straal("diff a.exr b.exr");
    assert_eq!(same.out, "the pictures are identical: all 24 x 16 pixels are the same to the last bit\n");
    assert_eq!(same.code, Some(0));
    assert_eq!(folder.json("diff a.exr b.exr")["identical"], true);
    let other: Run = folder.straal("diff a.exr c.exr");
    assert!(!other.out.contains("identical"), "{other:?}");
}

#[test]
fn shells_and_man_know_every_command() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = folder.straal(&format!("completions {shell}")).out;
        for word in ["render", "gamma-chart", "max-depth", "khronos_neutral"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    assert!(folder.straal("man").out.contains(".TH straal 1"));
    let page = folder.straal("man render").out;
    assert!(
        page.contains(".TH straal-render 1") && page.contains("samples per pixel")
            || page.contains("Samples per pixel")
    );
    let wrong = folder.straal("man rendr");
    assert!(wrong.code == Some(2) && wrong.err.contains("did you mean `render`?"), "{wrong:?}");
}

/// A new option should find its heading: what stands under `Options:` is only what all commands have.
#[test]
fn every_option_of_render_has_its_heading() {
    let folder = Folder::new();
    let help = folder.straal("render --help").out;
    let (_, plain) = help.split_once("\nOptions:\n").unwrap();
    let plain = plain.split("\n\n").take_while(|part| part.starts_with("  -")).collect::<Vec<_>>().join("\n");
    assert!(plain.contains("--help") && plain.matches("--").count() <= 2, "{plain}");
    let short = folder.straal("render -h").out;
    assert!(short.lines().count() < 2 * help.lines().count() / 3, "-h is short");
}
