//! A bare mesh is shown as it is asked for, and --write-scene gives the scene of a picture.

use crate::common::Folder;

/// A wedge that looks different from all sides; its second axis points up.
const WEDGE: &str = "v 0 0 0\nv 3 0 0\nv 3 0 1\nv 0 0 1.5\nv 0 1 0\nv 2 2 0\nf 1 2 3 4\nf 5 4 3 6\nf 1 4 5\nf 2 6 3\nf 1 5 6 2\n";
const SMALL: &str = "--size 24x16 --spp 2";

fn with_wedge() -> Folder {
    let folder = Folder::new();
    folder.write("wedge.obj", WEDGE);
    folder
}

fn film_hash(folder: &Folder, words: &str) -> String {
    let report = folder.json(words);
    report["film_hash"].as_str().unwrap_or_else(|| panic!("{words}: {report}")).to_owned()
}

#[test]
fn the_scene_that_is_written_gives_the_same_bits() {
    let folder = with_wedge();
    std::fs::create_dir_all(folder.path("deep/er")).unwrap();
    for (words, also) in [
        ("", ""),
        ("--up z --view back --material metal --smooth 30 --background #204060", "--seed 7 --sampler halton"),
        (
            "--material glass --background none",
            "--max-depth 4 --tone reinhard:3 --exposure auto+0.5 --crop 2,3,20,11",
        ),
        ("--view top --material gold", "--spectral --channels spectral:4 --dither on --gamma 2.2 --bits 16"),
    ] {
        let first = film_hash(
            &folder,
            &format!("render wedge.obj {SMALL} {words} {also} -o a.png --write-scene deep/er/x.yaml"),
        );
        let again = film_hash(&folder, "render deep/er/x.yaml -o b.png");
        assert_eq!(first, again, "{words} {also}");
        // The look is in it as well. The pictures differ in what they tell of their scene, not in what they show.
        let pixels = |name: &str| {
            straal_formats::image::png::read(&folder.read(name), &Default::default()).unwrap().pixels
        };
        assert_eq!(pixels("a.png"), pixels("b.png"), "{words} {also}");
    }
}

#[test]
fn any_scene_is_written_with_what_is_said_of_it() {
    let folder = with_wedge();
    let scene = "camera: { perspective: { eye: [4, 3, 5], look_at: [1, 1, 0] } }\nfilm: { size: [24, 16], crop: [1, 1, 9, 9] }\n\
                 world: [mesh: { file: ../wedge.obj }]\nlights: [environment: { radiance: 1 }]\n";
    std::fs::create_dir(folder.path("sub")).unwrap();
    folder.write("sub/scene.yaml", scene);
    let first = film_hash(&folder, "render sub/scene.yaml --spp 3 -o a.png --write-scene all.yaml");
    assert_eq!(first, film_hash(&folder, "render all.yaml -o b.png"));
    assert!(String::from_utf8(folder.read("all.yaml")).unwrap().contains("file: wedge.obj"));

    // The scene that straal brings along, word by word where nothing is said otherwise.
    let run = folder.straal("render --time 1ms --write-scene own.yaml --threads 1");
    assert_eq!(run.code, Some(0), "{run:?}");
    assert!(run.err.contains("`straal render own.yaml` gives this picture"), "{}", run.err);
    assert_eq!(folder.read("own.yaml"), straal::EMBEDDED_SCENE.as_bytes());
    let first = film_hash(&folder, "render --size 24x16 --spp 2 -o a.png --write-scene own.yaml");
    assert_eq!(first, film_hash(&folder, "render own.yaml -o b.png"));
}

#[test]
fn a_mesh_is_turned_upright_and_seen_from_all_sides() {
    let folder = with_wedge();
    // The same mesh as a program has it in which z is up.
    let turned: String = WEDGE
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            ["v", x, y, z] => format!("v {x} {} {y}\n", -z.parse::<f32>().unwrap()),
            _ => format!("{line}\n"),
        })
        .collect();
    folder.write("turned.obj", &turned);
    let seen = |words: &str| film_hash(&folder, &format!("render {SMALL} -o a.png {words}"));
    assert_eq!(seen("wedge.obj --up y"), seen("turned.obj --up z"));

    let options = [
        "--view front",
        "--view back",
        "--view left",
        "--view right",
        "--view top",
        "--view three-quarter",
        "--up -y",
        "--up x",
        "--up -x",
        "--up z",
        "--up -z",
        "--material metal",
        "--material gold",
        "--material glass",
        "--material white",
        "--background white",
        "--background black",
        "--background none",
        "--background #123",
        "--smooth 180",
    ];
    let mut all: Vec<String> = options
        .iter()
        .map(|o| seen(&format!("wedge.obj {o} {}", if o.contains("up") { "" } else { "--up y" })))
        .collect();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), options.len(), "two of them look the same");
    assert_eq!(
        seen("wedge.obj --up y --smooth 0"),
        seen("wedge.obj --up y --smooth 10"),
        "all its edges are sharp"
    );
}

#[test]
fn a_guess_is_told_and_data() {
    let folder = with_wedge();
    let report = folder.json(&format!("render wedge.obj {SMALL}"));
    let note = &report["diagnostics"][0];
    assert_eq!(note["severity"], "note", "{report}");
    assert!(note["message"].as_str().unwrap().contains("is taken to be up"), "{report}");
    let report = folder.json(&format!("render wedge.obj {SMALL} --up y"));
    assert_eq!(report["diagnostics"].as_array().map(Vec::len), Some(0), "{report}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = with_wedge();
    folder.write("scene.yaml", crate::common::BALL);
    for (words, complaint) in [
        (
            "render scene.yaml --up z",
            "--up is for bare meshes (.ply, .obj, .stl): scene.yaml is a scene, which says that itself",
        ),
        ("render --material gold", "the scene that straal brings along says that itself"),
        ("render wedge.obj --smooth 200", "write degrees from 0 to 180"),
        ("render wedge.obj --smooth -5", "write degrees from 0 to 180"),
        ("render wedge.obj --up w", "[possible values: x, y, z, -x, -y, -z]"),
        ("render wedge.obj --view side", "[possible values: front, back, left, right, top, three-quarter]"),
        ("render wedge.obj --background mauve", "a colour in hexadecimal in quotes, such as '#4060a0'"),
        ("render wedge.obj --write-scene wedge.obj", "must end in .yaml"),
        ("render scene.yaml --write-scene scene.yaml", "scene.yaml would replace what it is made from"),
        ("render wedge.obj --write-scene no/such/a.yaml", "there is no folder no/such"),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(2), "{words}: {run:?}");
        // Lines are wrapped to the terminal.
        let said = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(complaint), "{words}: {}", run.err);
    }
}
