//! `straal render` as a person meets it.

use crate::common::{BALL, Folder};
use straal_formats::image::exr;

#[test]
fn pictures_go_where_they_are_told() {
    let folder = Folder::with_scene(BALL);
    let run = folder.straal("render scene.yaml -o a.exr -o b.png -o c.pfm");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(folder.names(), ["a.exr", "b.png", "c.pfm", "scene.yaml"]);
    assert!(run.out.is_empty());
    assert!(
        run.err.contains("wrote a.exr, b.png, c.pfm: 4 samples") && run.err.contains("film hash "),
        "{run:?}"
    );
    let starts = ["a.exr", "b.png", "c.pfm"].map(|name| folder.read(name)[..2].to_vec());
    assert_eq!(starts, [vec![0x76, 0x2f], vec![0x89, b'P'], b"PF".to_vec()]);
}

#[test]
fn without_a_name_the_picture_is_called_after_the_scene() {
    let folder = Folder::with_scene(BALL);
    let run = folder.straal("render scene.yaml");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(folder.names(), ["scene.png", "scene.yaml"]);
    assert!(run.err.contains("wrote scene.png"), "{run:?}");
}

#[test]
fn without_a_scene_there_is_one() {
    let folder = Folder::new();
    let run = folder.straal("render --size 32x18 --spp 1");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(folder.names(), ["straal.png"]);
    assert!(run.err.contains("wrote straal.png"), "{run:?}");
}

#[test]
fn quiet_is_quiet() {
    let folder = Folder::with_scene(BALL);
    let run = folder.straal("render scene.yaml --quiet");
    assert_eq!((run.code, run.out.as_str(), run.err.as_str()), (Some(0), "", ""));
}

#[test]
fn scripts_get_one_object() {
    let folder = Folder::with_scene(BALL);
    let report = folder.json("render scene.yaml -o a.exr -o a.png --threads 1 --accel brute --isa scalar");
    assert_eq!(report["pictures"], serde_json::json!(["a.exr", "a.png"]));
    assert_eq!((report["samples"].as_u64(), report["complete"].as_bool()), (Some(4), Some(true)));
    assert_eq!((report["threads"].as_u64(), report["dropped"]["count"].as_u64()), (Some(1), Some(0)));
    assert_eq!((report["isa"].as_str(), report["structure"].as_str()), (Some("scalar"), Some("brute")));
    assert_eq!(report["crop"], serde_json::json!([0, 0, 24, 16]));
    assert!(report["rays"].as_u64().unwrap() >= 4 * 24 * 16);
    let shares = report["share_of_time"].as_object().unwrap();
    assert_eq!(shares.keys().collect::<Vec<_>>(), ["camera", "search", "shading", "lights", "film"]);
    let sum: f64 = shares.values().map(|v| v.as_f64().unwrap()).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    for key in ["film_hash", "scene_hash", "version"] {
        assert!(report[key].as_str().is_some_and(|s| !s.is_empty()), "{key}");
    }
    for key in ["seconds", "render_seconds", "mrays_per_second", "passes", "shadow_rays"] {
        assert!(report[key].as_f64().is_some_and(|n| n > 0.0), "{key}");
    }
    if cfg!(target_os = "linux") {
        assert!(report["peak_memory_bytes"].as_u64().unwrap() > 1 << 16);
        assert!(report["cpu_seconds"].is_number());
    }
    let metadata = folder.json("info a.exr")["metadata"].clone();
    assert_eq!(metadata["straal.film_hash"], report["film_hash"]);
    assert_eq!(folder.json("info a.png")["metadata"]["straal.film_hash"], report["film_hash"]);
}

#[test]
fn the_command_line_wins_over_the_scene() {
    let folder = Folder::with_scene(BALL);
    folder.json("render scene.yaml -o a.exr --spp 2 --size 20x10 --seed 5 --max-depth 3 --sampler random");
    let metadata = folder.json("info a.exr")["metadata"].clone();
    for (key, value) in
        [("samples", "2"), ("size", "20x10"), ("seed", "5"), ("max_depth", "3"), ("sampler", "random")]
    {
        assert_eq!(metadata[format!("straal.{key}")], value);
    }
}

#[test]
fn what_changes_the_speed_only_changes_the_speed_only() {
    let folder = Folder::with_scene(BALL);
    let hash = |words: &str| folder.json(&format!("render scene.yaml {words}"))["film_hash"].clone();
    let want = hash("");
    for words in ["--threads 3", "--accel brute", "--isa scalar", "--batch 1", "--batch 7"] {
        assert_eq!(hash(words), want, "{words}");
    }
    assert_ne!(hash("--seed 1"), want);
}

#[test]
fn a_crop_is_cut_out_of_the_whole() {
    let folder = Folder::with_scene(BALL);
    folder.json("render scene.yaml -o whole.exr");
    folder.json("render scene.yaml -o part.exr --crop 5,3,17,12");
    let read = |name| exr::read(&folder.read(name), &Default::default()).unwrap();
    let (whole, part) = (read("whole.exr"), read("part.exr"));
    assert_eq!(part.display_window, whole.data_window);
    assert_eq!(part.data_window, exr::Window { x: 5, y: 3, width: 12, height: 9 });
    let (all, some) = (whole.to_image().unwrap(), part.to_image().unwrap());
    for y in 0..9 {
        for x in 0..12 {
            let want = all.pixels[(y + 3) * 24 + x + 5].map(f32::to_bits);
            assert_eq!(some.pixels[(y + 3) * 24 + x + 5].map(f32::to_bits), want, "{x}, {y}");
        }
    }
}

#[test]
fn time_only_decides_how_many_samples() {
    let folder = Folder::with_scene(BALL);
    let timed = folder.json("render scene.yaml --time 200ms");
    let samples = timed["samples"].as_u64().unwrap();
    assert!(samples > 1 && timed["complete"].as_bool() == Some(true), "{timed}");
    let counted = folder.json(&format!("render scene.yaml --spp {samples}"));
    assert_eq!(timed["film_hash"], counted["film_hash"]);

    let both = folder.json("render scene.yaml --time 1h --spp 2");
    assert_eq!((both["samples"].as_u64(), both["complete"].as_bool()), (Some(2), Some(true)));
}

#[test]
fn wrong_wishes_are_refused_before_anything_is_written() {
    let folder = Folder::with_scene(BALL);
    for (words, complaint) in [
        ("render scene.yaml -o a.jpg", "the name must end in .exr, .png, .hdr or .pfm"),
        ("render scene.yaml -o no/a.png", "there is no folder no"),
        ("render scene.yaml --crop 0,0,25,16", "is not a part of a picture of 24 x 16 pixels"),
        ("render scene.yaml --spp 0", "invalid value '0' for '--spp <N>'"),
        ("render scene.yaml --spq 3", "did you mean `--spp`?"),
        ("render scene.yml", "did you mean `scene.yaml`?"),
        ("render scene.yaml -o a.png -o a.png", "a.png is named twice"),
        ("render scene.yaml --cost-picture a.exr", "the name must end in .png"),
        ("render scene.yaml --cost-of time", "--cost-picture"),
        ("rendr scene.yaml", "did you mean `render`?"),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(2), "{words}: {run:?}");
        assert!(run.err.contains(complaint), "{words}: {}", run.err);
        assert_eq!(folder.names(), ["scene.yaml"], "{words}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn what_can_not_be_written_is_told() {
    let folder = Folder::with_scene(BALL);
    std::os::unix::fs::symlink("/dev/full", folder.path("full.png")).unwrap();
    let run = folder.straal("render scene.yaml -o full.png --json");
    assert_eq!(run.code, Some(3), "{run:?}");
    assert!(run.err.contains("can't write full.png"), "{run:?}");
    assert_eq!(run.json()["exit_code"], 3);
    // Nobody, not even the administrator, can make files there.
    let run = folder.straal("render scene.yaml -o /proc/picture.png");
    assert_eq!(run.code, Some(3), "{run:?}");
    assert!(run.err.contains("can't write /proc/picture.png") && !run.err.contains("rendering"), "{run:?}");
}

#[test]
fn counting_costs_adds_layers_and_leaves_the_picture() {
    let folder = Folder::with_scene(BALL);
    let plain = folder.json("render scene.yaml")["film_hash"].clone();
    for words in ["--cost", "--cost-picture cost.png", "--cost --replicates 2 --threads 1"] {
        let report = folder.json(&format!("render scene.yaml -o a.exr {words}"));
        let same = report["film_hash"] == plain;
        assert_eq!(same, !words.contains("replicates"), "{words}");
        let layers = exr::read(&folder.read("a.exr"), &Default::default()).unwrap();
        let cost = layers.layer("cost").expect("a layer of costs");
        let names: Vec<_> = cost.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["nodes", "primitives", "time"], "{words}");
        for c in &cost.channels {
            assert!(c.samples.iter().all(|v| v.is_finite() && *v >= 0.0), "{words}: {}", c.name);
            // A tree over a single ball has no nodes.
            assert_eq!(c.samples.iter().any(|v| *v > 0.0), c.name != "nodes", "{words}: {}", c.name);
        }
        assert_eq!(folder.json("info a.exr")["metadata"]["straal.cost"], "bvh");
    }
    assert!(folder.read("cost.png").starts_with(b"\x89PNG"));
    let shown = straal_formats::image::read(&folder.read("cost.png"), &Default::default()).unwrap();
    assert!(shown.height > 16 && shown.width >= 24, "a legend stands below the 24 x 16 pixels");
    folder.json("render scene.yaml -o a.exr");
    let plain = exr::read(&folder.read("a.exr"), &Default::default()).unwrap();
    assert!(plain.layer("cost").is_none());
}

#[test]
fn a_scene_can_ask_for_its_costs() {
    let folder = Folder::with_scene(&format!("{BALL}accel: {{ cost: true, structure: brute }}\n"));
    folder.json("render scene.yaml -o a.exr");
    let layers = exr::read(&folder.read("a.exr"), &Default::default()).unwrap();
    let primitives = &layers.layer("cost").unwrap().channels[1];
    // Brute force: a ball and a plane for every ray, and there is one ray a sample at the least.
    assert!(primitives.name == "primitives" && primitives.samples.iter().all(|v| *v >= 2.0));
    assert_eq!(folder.json("info a.exr")["metadata"]["straal.cost"], "brute");
}

#[test]
fn replicates_are_their_mean_and_tell_their_number() {
    let folder = Folder::with_scene(BALL);
    let report = folder.json("render scene.yaml -o a.exr --replicates 3");
    assert_eq!((report["samples"].as_u64(), report["complete"].as_bool()), (Some(12), Some(true)));
    assert_eq!(folder.json("info a.exr")["metadata"]["straal.replicates"], "3");
}

#[test]
fn help_and_version_are_told() {
    let folder = Folder::new();
    for (words, part) in [
        ("--version", env!("CARGO_PKG_VERSION")),
        ("help", "Exit codes:"),
        ("help render", "Exit codes:"),
        ("render --help", "straal render bunny.ply"),
        ("check --help", "forecasts how much memory"),
        ("diff --help", "Welch"),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(0), "{words}: {run:?}");
        assert!(run.out.contains(part), "{words}: {}", run.out);
    }
    assert_eq!(folder.straal("").code, Some(2));
}

/// What ends a render by noise is told when it begins, and what it left when it ends.
#[test]
fn noise_and_its_limit_are_told() {
    let folder = Folder::with_scene(BALL);
    let open = folder.straal("render scene.yaml --noise 30%");
    assert_eq!(open.code, Some(0), "{open:?}");
    assert!(open.err.contains("at most 30 %; no pixel gets more than 262,144 samples\n"), "{open:?}");
    let few = folder.straal("render scene.yaml --noise 0.1% --spp 40");
    assert!(few.err.contains("at most 0.1 %; no pixel gets more than 40 samples\n"), "{few:?}");
    assert!(
        few.err.contains("blocks of 8 x 8 pixels are noisier than 0.1 %: no pixel was given more than 40"),
        "{few:?}"
    );
    let never = folder.straal("render scene.yaml --noise 30% --spp 20");
    assert!(never.err.contains("warning: no block can be found to be within 30 % of noise"), "{never:?}");
    let folder = Folder::with_scene(&BALL.replace("spp: 4", "spp: 48, noise: 0.3"));
    let scene = folder.straal("render scene.yaml");
    assert!(scene.err.contains("no pixel gets more than 48 samples\n"), "{scene:?}");
    assert!(folder.straal("check scene.yaml").out.contains("24 x 16 pixels, at most 48 samples"));
}
