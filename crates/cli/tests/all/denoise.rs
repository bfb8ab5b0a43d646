//! `straal denoise`: what it keeps of a picture, what it takes for guides, and what it says of bad input.

use crate::common::{BALL, Folder};
use straal_formats::Limits;
use straal_formats::image::exr::{self, Layer, Layered};

fn read(folder: &Folder, name: &str) -> Layered {
    exr::read(&folder.read(name), &Limits::default()).unwrap()
}

fn write(folder: &Folder, name: &str, picture: &Layered) {
    let mut bytes = std::io::Cursor::new(Vec::new());
    exr::write(&mut bytes, picture).unwrap();
    std::fs::write(folder.path(name), bytes.into_inner()).unwrap();
}

/// The mean square of what neighbours in a row differ by.
fn roughness(layer: &Layer, width: usize) -> f64 {
    let rows = layer.rgb().unwrap();
    let rows = rows.chunks(width).flat_map(|row| row.windows(2));
    let differences = rows.map(|p| f64::from(p[0][1] - p[1][1]));
    differences.map(|d| d * d).sum()
}

#[test]
fn a_render_comes_out_clean_and_keeps_its_layers() {
    let folder = Folder::with_scene(BALL);
    folder.straal("render scene.yaml -o noisy.exr --crop 2,1,20,15 -q");
    let run = folder.straal("denoise noisy.exr -o clean.exr -o clean.png");
    assert_eq!((run.code, run.out.as_str()), (Some(0), ""), "{}", run.err);
    assert_eq!(run.err, "wrote clean.exr, clean.png, denoised by rt_hdr_alb_nrm (albedo, normal)\n");
    let (noisy, clean) = (read(&folder, "noisy.exr"), read(&folder, "clean.exr"));
    let layer = |picture: &Layered, name: &str| picture.layer(name).cloned().unwrap();
    assert!(roughness(&layer(&clean, ""), 18) < 0.9 * roughness(&layer(&noisy, ""), 18));
    // What was, and what it is of.
    assert_eq!(layer(&clean, "noisy").rgb(), layer(&noisy, "").rgb());
    assert_eq!(layer(&clean, "albedo"), layer(&noisy, "albedo"));
    assert_eq!((clean.data_window, clean.display_window), (noisy.data_window, noisy.display_window));
    assert!(clean.layer("variance").is_none() && clean.layer("error").is_none());
    let told = |key: &str| clean.metadata.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str());
    assert_eq!(told("straal.denoised"), Some("rt_hdr_alb_nrm, albedo, normal"));
    assert_eq!(told("straal.film_hash"), None);
    // The same bits by one thread and plain arithmetic.
    folder.straal("denoise noisy.exr -o plain.exr --threads 1 --isa scalar -q");
    assert_eq!(folder.read("plain.exr"), folder.read("clean.exr"));
    // Once is enough.
    let again = folder.straal("denoise clean.exr -o twice.exr");
    assert_eq!(again.code, Some(2));
    assert!(again.err.contains("it was denoised before"), "{}", again.err);
}

#[test]
fn alpha_stays_and_what_is_no_light_is_told() {
    let folder = Folder::new();
    let mut picture = Layered::of_size(3, 2);
    let mut light = Layer::from_rgb("", &[[0.5; 3]; 6]);
    light.channels[0].samples[4] = f32::NAN;
    let alpha = exr::Channel { name: "A".into(), samples: vec![0.0, 0.25, 0.5, 0.75, 1.0, 1.0] };
    light.channels.push(alpha.clone());
    picture.layers.push(light);
    picture.layers.push(Layer::from_rgb("albedo", &[[0.5; 3]; 6]));
    write(&folder, "a.exr", &picture);
    let report = folder.json("denoise a.exr -o b.exr --fireflies 10");
    assert_eq!(report["weights"], "rt_hdr_small");
    assert_eq!(report["fireflies"]["pixels"], 0);
    let notes = report["notes"].to_string();
    assert!(notes.contains("albedo without normals"), "{notes}");
    let clean = read(&folder, "b.exr");
    let beauty = clean.layer("").unwrap();
    assert_eq!(beauty.channel("A"), Some(alpha.samples.as_slice()));
    assert!(beauty.rgb().unwrap().iter().flatten().all(|v| v.is_finite()));
    let run = folder.straal("denoise a.exr -o c.png");
    assert!(run.err.contains("no number (NaN)"), "{}", run.err);
}

#[test]
fn what_cannot_be_denoised_is_refused() {
    let folder = Folder::new();
    folder.write("a.exr", "no picture");
    folder.write("w.tza", "no weights");
    let mut picture = Layered::of_size(1, 1);
    picture.layers.push(Layer::from_rgb("", &[[0.5; 3]]));
    write(&folder, "one.exr", &picture);
    for (words, told) in [
        ("denoise a.exr -o b.exr", "can't read a.exr"),
        (
            "denoise one.exr -o b.exr --weights w.tza",
            "can't read w.tza as weights: not an archive of weights (TZA)",
        ),
        ("denoise one.exr -o b.exr --weights .", "hasn't the weights for light, albedo and normals"),
        ("denoise one.exr -o b.exr --fireflies 0", "write a number from 1 to 1000000, such as 10"),
        ("denoise one.exr -o one.exr", "one.exr"),
        ("denoise one.exr", "--output"),
    ] {
        let run = folder.straal(words);
        assert_eq!(run.code, Some(2), "{words}: {}", run.err);
        assert!(run.err.contains(told), "{words}: {}", run.err);
    }
    // A picture of one pixel is one.
    assert_eq!(folder.straal("denoise one.exr -o b.exr").code, Some(0));
}

#[test]
fn a_render_is_denoised_with_its_error_and_the_same_bits() {
    let folder = Folder::with_scene(BALL);
    folder.straal("render scene.yaml -o plain.exr -q");
    let run = folder.straal("render scene.yaml -o clean.exr --denoise best --threads 1");
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(
        [
            "denoised by rt_hdr_calb_cnrm ",
            " %, rt_hdr_alb_nrm ",
            " % and rt_hdr_small ",
            " % (albedo, normal), "
        ]
        .iter()
        .all(|part| run.err.contains(part)),
        "{}",
        run.err
    );
    assert!(run.err.contains("of the truth, by its own estimate\n"), "{}", run.err);
    let (plain, clean) = (read(&folder, "plain.exr"), read(&folder, "clean.exr"));
    // The samples are the same; what the error is of has changed.
    assert_eq!(clean.layer("noisy").unwrap().rgb(), plain.layer("").unwrap().rgb());
    assert!(roughness(clean.layer("").unwrap(), 24) < 0.9 * roughness(plain.layer("").unwrap(), 24));
    assert!(clean.layer("variance").is_none());
    let error = clean.layer("error").unwrap().rgb().unwrap();
    assert!(error.iter().flatten().all(|e| e.is_finite() && *e >= 0.0));
    assert!(error.iter().flatten().any(|e| *e > 0.0));
    let told = |key: &str| clean.metadata.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str());
    assert_eq!(told("straal.error"), Some("denoised halves"));
    assert_eq!(told("straal.guides_of"), Some("specular"));
    assert_eq!(folder.json("info clean.exr")["film_hash_is_right"], true);
    // The scene may say it, in the same bits for any threads and instruction set; and the command line has the last word.
    folder.write("said.yaml", &BALL.replace("film: {", "film: { denoise: best,"));
    folder.straal("render said.yaml -o said.exr --threads 3 --isa scalar -q");
    let said = read(&folder, "said.exr");
    assert_eq!(said.layer("").unwrap().rgb(), clean.layer("").unwrap().rgb());
    assert_eq!(said.layer("error"), clean.layer("error"));
    folder.straal("render said.yaml -o off.exr --denoise off -q");
    assert_eq!(read(&folder, "off.exr").layers, plain.layers);
    let refused = folder.straal("render scene.yaml -o a.exr --replicates 2 --denoise fast");
    assert_eq!(refused.code, Some(2));
}

#[test]
fn noise_is_that_of_the_denoised_picture() {
    let folder = Folder::with_scene(BALL);
    let report = folder.json("render scene.yaml -o a.exr --noise 3% --denoise fast");
    let (samples, noise) =
        (report["samples"].as_u64().unwrap(), report["denoised"]["noise"].as_f64().unwrap());
    assert!(samples.is_power_of_two() && samples >= 32 && noise <= 0.035, "{samples} {noise}");
    // Block by block.
    assert!(report["mean_samples"].as_f64().unwrap() <= samples as f64, "{report}");
    let picture = read(&folder, "a.exr");
    let counts = &picture.layer("samples").unwrap().channels[0].samples;
    assert!(counts.iter().all(|n| *n >= 32.0 && (*n as u32).is_power_of_two()), "{counts:?}");
    assert_eq!(report["complete"], true);
    let undenoised = folder.json("render scene.yaml -o b.exr --noise 3%");
    assert!(undenoised["mean_samples"].as_f64().unwrap() > samples as f64, "{undenoised}");
}

/// What a mirror shows is told by `--guides specular`.
#[test]
fn guides_follow_mirrors() {
    let scene = BALL
        .replace("radius: 0.5 }", "radius: 0.5, material: chrome }")
        .replace("plane: {}", "plane: { material: grey }")
        .replace(
            "world:",
            "materials: { chrome: { mirror: {} }, grey: { diffuse: { reflectance: 0.25 } } }\nworld:",
        );
    let folder = Folder::with_scene(&scene);
    let mut albedo = Vec::new();
    for guides in ["first", "specular"] {
        folder.straal(&format!("render scene.yaml -o {guides}.exr --spp 1 --guides {guides} -q"));
        let picture = read(&folder, &format!("{guides}.exr"));
        albedo.push(picture.layer("albedo").unwrap().rgb().unwrap());
        assert_eq!(picture.layer("").unwrap().rgb(), read(&folder, "first.exr").layer("").unwrap().rgb());
    }
    // The lower half of the ball shows the floor, the upper the sky, and the sky itself has albedo 1.
    let at = |k: usize, x: usize, y: usize| albedo[k][y * 24 + x][0];
    assert_eq!((at(0, 12, 11), at(1, 12, 11)), (1.0, 0.25));
    assert_eq!((at(0, 12, 5), at(1, 12, 5)), (1.0, 1.0));
    assert_eq!((at(0, 0, 0), at(1, 0, 0)), (0.0, 1.0));
}
