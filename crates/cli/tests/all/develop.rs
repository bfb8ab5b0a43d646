//! `straal develop`: the same picture as a render with the same settings, and what is wrong told.

use crate::common::{BALL, Folder};
use straal_formats::Limits;
use straal_formats::image::{exr, hdr, pfm, png};

/// Looks that between them have every step.
const LOOKS: [&str; 5] = [
    "",
    "--exposure auto+0.5 --tone reinhard:4 --gamut desaturate --dither on",
    "--exposure -1 --tone max_to_one --bits 16 --gamma 2.2",
    "--exposure highlights+2 --tone clamp --gamut flag:1,0,1",
    "--tone agx --dither on --bits 16",
];

#[test]
fn a_picture_developed_again_is_the_one_that_was_rendered() {
    let folder =
        Folder::with_scene(&BALL.replace("film: {", "color: { space: acescg }\nfilm: { exposure: 1,"));
    // The crop shows that dithering goes by the place in the whole picture.
    folder.straal("render scene.yaml -o plain.exr --crop 3,5,20,16 -q");
    for (i, look) in LOOKS.iter().enumerate() {
        folder.straal(&format!("render scene.yaml -o r{i}.png -o r{i}.exr --crop 3,5,20,16 -q {look}"));
        folder.straal(&format!("develop plain.exr -o d{i}.png -q {look}"));
        // The EXR remembers the look.
        folder.straal(&format!("develop r{i}.exr -o e{i}.png -q"));
        let rendered = folder.read(&format!("r{i}.png"));
        assert_eq!(rendered, folder.read(&format!("d{i}.png")), "{look}");
        assert_eq!(rendered, folder.read(&format!("e{i}.png")), "{look}");
        let others =
            LOOKS[..i].iter().enumerate().filter(|(j, _)| folder.read(&format!("r{j}.png")) == rendered);
        assert_eq!(others.count(), 0, "{look} changes nothing");
    }
    let told = png::read_metadata(&folder.read("r2.png"), &Limits::default()).unwrap();
    let look = told.texts.iter().find(|(key, _)| key == "straal.look").unwrap();
    assert_eq!(look.1, "exposure=-1 tone=max_to_one gamut=clip gamma=2.2 bits=16 dither=off");
}

#[test]
fn light_is_kept_in_other_formats() {
    let folder = Folder::with_scene(&BALL.replace("film:", "color: { space: rec2020 }\nfilm:"));
    folder.straal("render scene.yaml -o a.exr -o a.pfm -o a.hdr -q");
    folder.straal("develop a.exr -o b.exr -o b.pfm -o b.hdr -q");
    for name in ["a.pfm", "a.hdr"] {
        assert_eq!(folder.read(name), folder.read(&name.replace('a', "b")), "{name}");
    }
    let limits = Limits::default();
    let [a, b] = ["a.exr", "b.exr"].map(|name| exr::read(&folder.read(name), &limits).unwrap());
    assert_eq!(a, b);
    assert_eq!(a.space, Some(straal_color::Space::Rec2020.rgb()));
    // EXR in another space and PFM in sRGB are the same light.
    let (rgb, light) = (a.to_image().unwrap(), pfm::read(&folder.read("a.pfm"), &limits).unwrap());
    assert_eq!(rgb.pixels, light.pixels);
    assert_eq!(hdr::read(&folder.read("b.hdr"), &limits).unwrap().pixels.len(), light.pixels.len());
    // Of a picture that doesn't know its look the plain one is made.
    folder.straal("develop b.pfm -o c.png -q");
    folder.straal("develop b.exr -o d.png -q");
    let [c, d] = ["c.png", "d.png"].map(|name| png::read(&folder.read(name), &limits).unwrap().pixels);
    assert_eq!(c, d);
}

#[test]
fn the_space_that_light_is_computed_in_hardly_shows() {
    let folder = Folder::with_scene(BALL);
    folder.straal("render scene.yaml -o a.pfm -q");
    folder.write("wide.yaml", &format!("color: {{ space: aces }}\n{BALL}"));
    folder.straal("render wide.yaml -o b.pfm -q");
    let limits = Limits::default();
    let [a, b] = ["a.pfm", "b.pfm"].map(|name| pfm::read(&folder.read(name), &limits).unwrap().pixels);
    // Greys only: the space makes no difference but for rounding.
    for (a, b) in a.as_flattened().iter().zip(b.as_flattened()) {
        assert!((a - b).abs() < 1e-5 * (1.0 + a), "{a} {b}");
    }
}

#[test]
fn blur_by_depth_needs_depth() {
    let folder = Folder::with_scene(BALL);
    folder.straal("render scene.yaml -o a.exr -o a.pfm -o a.png -q");
    let fine = folder.straal("develop a.exr -o b.exr -o b.png --depth-of-field focus=3,radius=0.5");
    assert_eq!(fine.code, Some(0), "{}", fine.err);
    assert_ne!(folder.read("a.png"), folder.read("b.png"));
    let blurred = exr::read(&folder.read("b.exr"), &Limits::default()).unwrap();
    assert!(
        ["variance", "error"].iter().all(|l| blurred.layer(l).is_none()) && blurred.layer("depth").is_some()
    );
    assert!(blurred.metadata.iter().any(|(key, _)| key == "straal.depth_of_field"));
    let told = folder.straal("develop a.pfm -o c.png --depth-of-field focus=3,radius=0.5 --fov 40");
    assert_eq!(told.code, Some(2));
    assert!(told.err.contains("has no layer `depth`"), "{}", told.err);
    let told = folder.straal("develop a.pfm -o c.png --depth-of-field focus=3,radius=0.5");
    assert!(
        told.err.contains("doesn't tell its field of view") && told.err.contains("--fov"),
        "{}",
        told.err
    );
}

#[test]
fn wrong_words_are_answered() {
    let folder = Folder::with_scene(BALL);
    folder.straal("render scene.yaml -o a.exr -q");
    for (words, complaint) in [
        ("develop a.exr -o a.exr", "a.exr would replace what it is made from"),
        ("develop a.exr -o b.jpg", "the name must end in .exr, .png, .hdr or .pfm"),
        ("develop a.exr -o b.png -o b.png", "named twice"),
        ("develop none.exr -o b.png", "can't read none.exr"),
        ("develop scene.yaml -o b.png", "can't read scene.yaml"),
        ("develop a.exr -o b.png --tone filmik", "a similar value exists: 'filmic'"),
        ("develop a.exr -o b.png --tone hable:0", "what becomes white must be a number from 0.01"),
        ("develop a.exr -o b.png --tone clamp:3", "only reinhard and hable"),
        ("develop a.exr -o b.png --exposure loud", "expected stops from -64 to 64"),
        ("develop a.exr -o b.png --gamut flag:2,0,0", "three numbers from 0 to 1"),
        ("develop a.exr -o b.png --gamma 0", "expected srgb or a number from 0.1 to 10"),
        ("develop a.exr -o b.png --depth-of-field focus=1", "radius=METRES"),
        ("develop a.exr -o b.png --fov 40", "--depth-of-field"),
        ("develop a.exr -o b.png --light-group key=2", "no layers of groups of lights"),
        ("develop a.exr -o b.png --light-group key", "write the group and what becomes of it"),
        ("develop a.exr -o b.png --light-group key=hot", "neither a factor such as 2"),
        ("gamma-chart -o chart.exr", "the name must end in .png"),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(2), "{words}");
        assert!(run.err.contains(complaint), "{words}: {}", run.err);
    }
    // A look that an EXR tells but nobody understands is none.
    let mut picture = exr::read(&folder.read("a.exr"), &Limits::default()).unwrap();
    picture.metadata.retain(|(key, _)| key != "straal.look");
    picture.metadata.push(("straal.look".into(), "tone=loud".into()));
    let mut bytes = Vec::new();
    exr::write(&mut bytes, &picture).unwrap();
    std::fs::write(folder.path("odd.exr"), bytes).unwrap();
    assert_eq!(folder.straal("develop odd.exr -o odd.png").code, Some(0));
}

/// What is relit is developed, an unknown group is answered with those that are there, and an EXR has the changed layers.
#[test]
fn groups_of_lights_are_relit() {
    let folder = Folder::with_scene(
        "camera: { perspective: { eye: [0, 1, 4], look_at: [0, 0.5, 0] } }\nfilm: { size: [16, 12] }\nsampler: { spp: 4 }\n\
         world:\n  - sphere: { center: [0, 0.5, 0], radius: 0.5 }\nlights:\n  - point: { position: [2, 2, 2], intensity: 5, light_group: key }\n  \
         - point: { position: [-2, 2, 2], intensity: [1, 2, 3], light_group: fill }\n",
    );
    assert_eq!(folder.straal("render scene.yaml -o a.exr -q").code, Some(0));
    let run = folder.straal("develop a.exr -o b.exr --light-group key=off --light-group fill=3");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let read = |name: &str| exr::read(&folder.read(name), &Limits::default()).unwrap();
    let (before, after) = (read("a.exr"), read("b.exr"));
    let colours =
        |picture: &exr::Layered, layer: &str| picture.layer(layer).and_then(exr::Layer::rgb).unwrap();
    let fill = colours(&before, "Combined_fill");
    assert!(fill.iter().any(|v| v[2] > 0.05));
    let three_times: Vec<_> = fill.iter().map(|v| v.map(|v| 3.0 * v)).collect();
    assert_eq!(colours(&after, ""), three_times);
    assert_eq!(colours(&after, "Combined_fill"), three_times);
    assert!(colours(&after, "Combined_key").iter().all(|v| *v == [0.0; 3]));
    let run = folder.straal("develop a.exr -o c.png --light-group fil=2");
    assert_eq!(run.code, Some(2));
    assert!(run.err.contains("no group of lights `fil`") && run.err.contains("fill"), "{}", run.err);
}

#[test]
fn the_chart_has_its_fields() {
    let folder = Folder::new();
    assert_eq!(folder.straal("gamma-chart").code, Some(0));
    let chart = png::read(&folder.read("gamma-chart.png"), &Limits::default()).unwrap();
    let black = chart.pixels.iter().filter(|p| **p == [0.0; 3]).count();
    assert!(black > 22 * 3000, "{black}");
}
