//! Pictures of straal come back as what they were, and those of others are taken as their files say.

use crate::common::{BALL, Folder};
use straal_formats::Limits;
use straal_formats::image::{self, exr};

/// Light of 0.2 from everywhere, and nothing else.
const EVEN: &str = "\
camera: { perspective: { eye: [0, 0, 4], look_at: [0, 0, 0] } }
film: { size: [6, 4] }
sampler: { spp: 1 }
lights:
  - environment: { radiance: [0.2, 0.2, 0.2] }
";

fn write(folder: &Folder, name: &str, picture: &exr::Layered) {
    let mut bytes = Vec::new();
    exr::write(&mut bytes, picture).unwrap();
    std::fs::write(folder.path(name), bytes).unwrap();
}

fn light(folder: &Folder, name: &str) -> image::Photo {
    image::Photo::read(&folder.read(name), &Limits::default()).unwrap()
}

/// What a PNG says in its chunk gAMA.
fn gamma(png: &[u8]) -> Option<&[u8]> {
    let at = png.windows(4).position(|w| w == b"gAMA")?;
    png.get(at + 4..at + 8)
}

#[test]
fn a_png_of_straal_is_the_light_that_it_was() {
    let folder = Folder::with_scene(EVEN);
    folder.straal("render scene.yaml -o a.exr -o a.hdr -o a.pfm -q --tone clamp");
    for (i, look) in ["--gamma 1 --bits 16", "--gamma 2.2 --bits 16", "--bits 16"].into_iter().enumerate() {
        folder.straal(&format!("render scene.yaml -o {i}.png -q --tone clamp {look}"));
        assert!((light(&folder, &format!("{i}.png")).pixels[0][0] - 0.2).abs() < 2e-5, "{look}");
        let told = folder.json(&format!("info {i}.png"));
        let mean = told["layers"][0]["channels"][0]["mean"].as_f64().unwrap();
        assert!((mean - 0.2).abs() < 2e-5, "{told}");
        assert_eq!(folder.straal(&format!("diff a.exr {i}.png")).code, Some(0), "{look}");
        // Developed again it keeps its curve and depth, and so its very codes.
        assert_eq!(folder.straal(&format!("develop {i}.png -o again{i}.png -q")).code, Some(0));
        assert_eq!(
            light(&folder, &format!("{i}.png")).pixels,
            light(&folder, &format!("again{i}.png")).pixels
        );
        assert_eq!(folder.straal(&format!("diff {i}.png again{i}.png")).code, Some(0));
    }
    for i in 0..3 {
        assert_eq!(gamma(&folder.read(&format!("{i}.png"))), gamma(&folder.read(&format!("again{i}.png"))));
    }
    assert_eq!(gamma(&folder.read("again0.png")), Some(100_000_u32.to_be_bytes().as_slice()));
    for name in ["a.hdr", "a.pfm"] {
        assert!((light(&folder, name).pixels[0][0] - 0.2).abs() < 1e-3, "{name}");
    }
    // Another curve is another encoding of the same light.
    folder.straal("develop 0.png -o other.png -q --gamma srgb");
    assert_eq!(folder.straal("diff a.exr other.png").code, Some(0));
    // Of a picture that was exposed it is told that it isn't the light of the film.
    folder.straal("render scene.yaml -o bright.png -q --exposure 1 --bits 16 --tone clamp");
    let run = folder.straal("diff a.exr bright.png");
    assert!(run.code == Some(1) && run.err.contains("bright.png: it was developed (exposure 1"), "{run:?}");
}

#[test]
fn a_crop_is_compared_where_it_was_rendered() {
    let folder = Folder::with_scene(BALL);
    folder.straal("render scene.yaml -o whole.exr -q");
    folder.straal("render scene.yaml -o crop.exr -o crop.png -q --crop 5,3,17,12");
    folder.straal("render scene.yaml -o other.exr -q --crop 10,2,20,9");
    for (words, part) in [
        ("diff crop.exr whole.exr", "12 x 9 pixels from 5, 3"),
        ("diff whole.exr crop.exr", "12 x 9 pixels from 5, 3"),
        ("diff crop.exr other.exr", "7 x 6 pixels from 10, 3"),
    ] {
        let run = folder.straal(words);
        assert_eq!((run.code, run.out.contains(part)), (Some(0), true), "{words}: {run:?}");
    }
    assert_eq!(folder.json("diff crop.exr whole.exr")["part"], serde_json::json!([5, 3, 12, 9]));
    let told = folder.straal("info crop.exr").out;
    assert!(told.contains("12 x 9 pixels from 5, 3; the rest was not rendered"), "{told}");
    // A format without windows holds the crop alone, as a render writes it.
    folder.straal("develop crop.exr -o developed.png -o crop.pfm -q");
    assert_eq!(folder.read("crop.png"), folder.read("developed.png"));
    assert_eq!(light(&folder, "crop.pfm").size, [12, 9]);
    assert_eq!(folder.straal("diff crop.exr crop.pfm").code, Some(0));
}

/// The data window of a picture of others is a part of it, and the rest is black.
#[test]
fn a_window_of_others_is_honoured_everywhere() {
    let folder = Folder::new();
    let mut part = exr::Layered::of_size(6, 4);
    part.data_window = exr::Window { x: 2, y: 1, width: 3, height: 2 };
    part.layers = vec![exr::Layer::from_rgb("", &[[0.5, 0.25, 1.0]; 6])];
    write(&folder, "part.exr", &part);
    let mut whole = exr::Layered::of_size(6, 4);
    let image = part.to_image().unwrap();
    assert_eq!((image.pixels[0], image.pixels[8]), ([0.0; 3], [0.5, 0.25, 1.0]));
    whole.layers = vec![exr::Layer::from_rgb("", &image.pixels)];
    write(&folder, "whole.exr", &whole);
    for words in ["diff part.exr whole.exr", "diff whole.exr part.exr"] {
        assert_eq!(folder.straal(words).code, Some(0), "{words}");
    }
    let told = folder.straal("info part.exr").out;
    assert!(
        told.contains("6 x 4 pixels") && told.contains("3 x 2 pixels from 2, 1; the rest is black"),
        "{told}"
    );
    for name in ["part", "whole"] {
        folder.straal(&format!("develop {name}.exr -o {name}.png -o {name}.hdr -o {name}.pfm -q"));
    }
    for kind in ["png", "hdr", "pfm"] {
        let [a, b] = ["part", "whole"].map(|name| light(&folder, &format!("{name}.{kind}")));
        assert_eq!((a.size, a.pixels), ([6, 4], b.pixels), "{kind}");
    }
    // As surroundings it gives what the whole gives, and says that it is a part.
    let scene = |name: &str| EVEN.replace("radiance: [0.2, 0.2, 0.2]", &format!("file: {name}.exr"));
    folder.write("a.yaml", &scene("part"));
    folder.write("b.yaml", &scene("whole"));
    let told = folder.json("render a.yaml -o a.exr");
    let warning = told["diagnostics"][0]["message"].as_str().unwrap_or_default();
    assert!(
        warning
            .contains("`part.exr`: it has 3 x 2 pixels from 2, 1 of a picture of 6 x 4: the rest is black"),
        "{told}"
    );
    folder.straal("render b.yaml -o b.exr -q");
    assert_eq!(light(&folder, "a.exr").pixels, light(&folder, "b.exr").pixels);
}

#[test]
fn numbers_that_are_no_light_are_told() {
    let folder = Folder::new();
    let mut picture = exr::Layered::of_size(4, 2);
    let mut pixels = [[0.5_f32; 3]; 8];
    pixels[5] = [f32::NAN; 3];
    pixels[6] = [f32::INFINITY; 3];
    pixels[7] = [f32::NAN, 0.5, -1.0];
    picture.layers = vec![exr::Layer::from_rgb("", &pixels)];
    write(&folder, "odd.exr", &picture);
    let run = folder.straal("develop odd.exr -o odd.png");
    for want in [
        "numbers of 2 pixels are no number (NaN), the first at 1, 1: black",
        "the pixel 2, 1 is infinite: white",
    ] {
        assert!(run.code == Some(0) && run.err.contains(want), "{run:?}");
    }
    let shown = light(&folder, "odd.png").pixels;
    assert_eq!((shown[5], shown[6]), ([0.0; 3], [1.0; 3]));
    assert_eq!(folder.straal("develop odd.exr -o odd.png -q").err, "");
    assert!(folder.straal("info odd.exr").out.contains("no number (NaN), the first at 1, 1"));
    folder.write("sky.yaml", &EVEN.replace("radiance: [0.2, 0.2, 0.2]", "file: odd.exr"));
    let told = folder.json("check sky.yaml");
    let told = told.to_string();
    for want in ["2, 1 is infinite: 65504 is taken", "no number (NaN), the first at 1, 1", "3, 1 is below 0"]
    {
        assert!(told.contains(want), "{want}: {told}");
    }
    folder.straal("render sky.yaml -o sky.exr -q");
    assert!(light(&folder, "sky.exr").pixels.iter().flatten().all(|v| v.is_finite()));
}

#[test]
fn a_layer_can_be_developed_by_its_name() {
    let folder = Folder::new();
    let mut picture = exr::Layered::of_size(1, 1);
    picture.layers = ["key", "fill"].map(|l| exr::Layer::from_rgb(l, &[[l.len() as f32 / 8.0; 3]])).into();
    write(&folder, "lights.exr", &picture);
    let run = folder.straal("develop lights.exr -o a.exr");
    assert!(run.err.contains("`fill` and `key`: `fill` is taken; `straal develop --layer NAME`"), "{run:?}");
    assert!(folder.straal("info lights.exr").out.contains("the layer fill"));
    let run = folder.straal("develop lights.exr -o key.exr -o key.pfm --layer KEY");
    assert_eq!((run.code, run.err.as_str()), (Some(0), "wrote key.exr, key.pfm\n"));
    for name in ["key.exr", "key.pfm"] {
        let key = light(&folder, name);
        assert_eq!((key.pixels[0], key.layer.as_str()), ([0.375; 3], ""), "{name}");
    }
    let run = folder.straal("develop lights.exr -o key.exr --layer rim");
    assert!(
        run.code == Some(2) && run.err.contains("it has no layer `rim`, only `fill` and `key`"),
        "{run:?}"
    );
}
