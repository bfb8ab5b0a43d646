//! Cameras end to end: from a scene's words to a picture.

use std::path::Path;
use straal::{Control, Job, LoadOptions, Outcome, Overrides, Picture};
use straal_render::camera::Camera;
use straal_render::film::channel::DEPTH;

/// Balls that glow and balls that don't, around the origin, without noise where only glow is seen.
const WORLD: &str = "
film: { size: [60, 44] }
sampler: { spp: 4 }
objects: { bead: { sphere: { radius: 0.2 } } }
world:
  - plane: { point: [0, -1, 0], material: { diffuse: { reflectance: [0.6, 0.5, 0.4] } } }
  - sphere: { name: red, center: [0.5, 0, -3], radius: 0.7, emission: [2, 0.2, 0.1] }
  - group:
      name: pair
      transform: [translate: [3, 0.5, 0.5]]
      children: [sphere: { emission: [0.1, 1.5, 0.3] }, sphere: { center: [0, 1.6, 0], radius: 0.5, emission: [1, 1, 1] }]
  - sphere: { center: [-2.5, -0.4, 1], radius: 0.9, emission: [0.2, 0.3, 2] }
  - sphere: { center: [0.3, 3, 0.4], radius: 0.8, emission: [1.5, 1.2, 0.1] }
  - instance: { of: bead, transform: [translate: [-0.4, 0.1, -1.5]] }
  - instance: { of: bead, transform: [translate: [0.6, -0.5, -5]] }
lights:
  - environment: { radiance: [0.3, 0.4, 0.5] }
";

fn try_job(camera: &str, wish: Overrides) -> Result<Job, String> {
    let text = format!("camera: {camera}\n{WORLD}");
    let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
    Job::new(loaded.map_err(|d| d.to_string())?, wish).map_err(|e| e.to_string())
}

fn job(camera: &str, wish: Overrides) -> Job {
    try_job(camera, wish).unwrap_or_else(|e| panic!("{camera}:\n{e}"))
}

fn render(camera: &str, wish: Overrides) -> Outcome {
    job(camera, wish).render(&mut Control::to_the_end()).unwrap_or_else(|e| panic!("{camera}: {e}"))
}

fn perspective(more: &str) -> String {
    format!("{{ perspective: {{ eye: [0, 0.2, 2], look_at: [0, 0, -2], {more} }} }}")
}

fn of_kind(kind: &str, more: &str) -> String {
    format!("{{ {kind}: {{ eye: [0, 0.2, 0], look_at: [0, 0.2, -2], {more} }} }}")
}

#[test]
fn every_camera_gives_the_same_bits() {
    let cameras = [
        perspective("roll: 10, shift: [0.1, 0.2]"),
        perspective("lens: { radius: 0.1 }"),
        perspective("lens: { radius: 0.1, profile: gaussian }"),
        perspective("lens: { radius: 0.1, blades: 5 }"),
        perspective("stereo: {}"),
        perspective("stereo: { layout: crossed }"),
        perspective("stereo: { layout: anaglyph, separation: 0.3 }, lens: { radius: 0.1 }"),
        perspective("moving_to: { eye: [0.5, 0.2, 2], roll: 5 }, lens: { radius: 0.05 }"),
        perspective(
            "moving_to: [{ time: 0.3, eye: [0.5, 0.2, 2] }, { time: 0.8, roll: 5 }], shutter: [0.1, 0.9]",
        ),
        of_kind("orthographic", "moving_to: { up: [0.2, 1, 0] }, width: 5"),
        of_kind("fisheye", ""),
        of_kind("fisheye", "fov: 360, projection: equisolid"),
        of_kind("panorama", "rows: centered"),
        of_kind("cube_map", ""),
        of_kind("cube_map", "layout: row, moving_to: { eye: [0, 0.4, 0] }"),
    ];
    for camera in &cameras {
        let plain = render(camera, Overrides { threads: Some(1), ..Overrides::default() }).picture;
        let hash = |p: &Picture| p.tells("film_hash").expect("a film hash").to_owned();
        for wish in [
            Overrides { threads: Some(7), batch: Some(7), shuffle_tiles: Some(3), ..Overrides::default() },
            Overrides { batch: Some(1), ..Overrides::default() },
        ] {
            assert_eq!(hash(&render(camera, wish).picture), hash(&plain), "{camera}");
        }
        let [x0, y0, x1, y1] = [7, 5, 50, 31];
        let crop = render(camera, Overrides { crop: Some([x0, y0, x1, y1]), ..Overrides::default() }).picture;
        for (i, rgb) in crop.layers.rgb.iter().enumerate() {
            let (x, y) = (x0 as usize + i % crop.layers.width, y0 as usize + i / crop.layers.width);
            let whole = plain.layers.rgb[y * plain.layers.width + x];
            assert_eq!(rgb.map(f32::to_bits), whole.map(f32::to_bits), "{camera}: pixel {x},{y}");
        }
    }
}

/// However a way is told, it is the same: by its end, or by a list, with the times that would be taken anyhow or without.
#[test]
fn a_way_may_be_told_in_several_ways() {
    let at = |way: &str| camera(&perspective(&format!("moving_to: {way}")), Overrides::default());
    let straight = at("{ eye: [0.5, 0.2, 2], roll: 5 }");
    assert_eq!(at("[{ eye: [0.5, 0.2, 2], roll: 5 }]"), straight);
    assert_eq!(at("[{ time: 1, eye: [0.5, 0.2, 2], roll: 5 }]"), straight);
    // What a keyframe leaves out stays as it was in the one before.
    let bent = at("[{ eye: [0.5, 0.2, 2] }, { roll: 5 }]");
    assert_eq!(at("[{ time: 0.5, eye: [0.5, 0.2, 2] }, { time: 1, eye: [0.5, 0.2, 2], roll: 5 }]"), bent);
    assert_ne!(bent, straight);
}

fn camera(text: &str, wish: Overrides) -> Camera {
    job(text, wish).world.camera
}

#[test]
fn an_angle_may_be_told_in_three_ways() {
    // A right angle across: half the width is the distance.
    let ways =
        ["fov: 90", "focal_length: 18", "focal_length: 12, sensor: 24", "view_distance: 30, pixel_size: 1"];
    for size in [None, Some([120, 44]), Some([33, 71])] {
        let wish = || Overrides { size, ..Overrides::default() };
        let zoomed = "view_distance: 15, pixel_size: 1, zoom: 2";
        for way in ways.into_iter().chain([zoomed]) {
            let [across, _] = camera(&perspective(way), wish()).facts().degrees.expect("a view plane");
            assert!((across - 90.0).abs() < 1e-9, "{way} at {size:?}: {across}");
        }
    }
}

#[test]
fn a_lens_may_be_told_in_two_ways() {
    // 50 mm at f/2 have a radius of 12.5 mm; so has a lens with the angle of 50 mm before a sensor of 36 mm.
    let at = |more: &str| camera(&perspective(more), Overrides::default());
    let by_radius = at("focal_length: 50, lens: { radius: 0.0125 }");
    assert_eq!(at("focal_length: 50, lens: { f_number: 2 }"), by_radius);
    let Camera::ThinLens(by_angle) = at("fov: 39.597752, lens: { f_number: 2 }") else { panic!("no lens") };
    assert!((by_angle.iris().radius() - 0.0125).abs() < 1e-7);
}

#[test]
fn focus_is_found_by_name() {
    let focus = |more: &str| match camera(
        &perspective(&format!("lens: {{ radius: 0.1, {more} }}")),
        Overrides::default(),
    ) {
        Camera::ThinLens(c) => f64::from(c.focus()),
        other => panic!("{other:?}"),
    };
    // Along the view, which goes from (0, 0.2, 2) to (0, 0, -2).
    let along = |[x, y, z]: [f64; 3]| (x * 0.0 + (y - 0.2) * -0.2 + (z - 2.0) * -4.0) / 16.04_f64.sqrt();
    assert!((focus("focus_on: red") - along([0.5, 0.0, -3.0])).abs() < 1e-5);
    // The middle of the box around both balls: from -1 to 2.1 above the group's origin.
    assert!((focus("focus_on: pair") - along([3.0, 0.5 + 0.55, 0.5])).abs() < 1e-5);
    // Of several instances the nearest.
    assert!((focus("focus_on: bead") - along([-0.4, 0.1, -1.5])).abs() < 1e-5);
    assert!((focus("focus_distance: 2.5") - 2.5).abs() < 1e-6);
    assert!((focus("") - 16.04_f64.sqrt()).abs() < 1e-6, "else what is looked at is in focus");
}

#[test]
fn what_only_compiling_finds_out_is_told() {
    let says = |camera: &str| {
        try_job(camera, Overrides::default()).err().unwrap_or_else(|| panic!("{camera} was taken"))
    };
    let away =
        "{ perspective: { eye: [0, 0, 2], look_at: [0, 0, 5], lens: { radius: 0.1, focus_on: red } } }";
    assert!(
        says(away).contains("can't be focused on `red`: its middle is not in front of it"),
        "{}",
        says(away)
    );
    assert!(
        says(&perspective("view_distance: 1e30, pixel_size: 1e-30")).contains("beyond the range of numbers")
    );
    let small = |kind: &str, size| {
        try_job(kind, Overrides { size: Some(size), ..Overrides::default() }).err().unwrap_or_default()
    };
    assert!(small(&of_kind("cube_map", ""), [3, 9]).contains("no room for 4 x 3 faces"));
    assert!(small(&perspective("stereo: {}"), [1, 9]).contains("no room for two eyes"));
}

#[test]
fn around_a_fisheyes_circle_it_is_black_and_counted() {
    let layers = render(&of_kind("fisheye", ""), Overrides::default()).picture.layers;
    assert!(layers.samples.iter().all(|&n| n == 4));
    let depth = &layers.channel(&DEPTH).expect("all layers").values;
    for (i, rgb) in layers.rgb.iter().enumerate() {
        let (x, y) = ((i % 60) as f64 + 0.5 - 30.0, (i / 60) as f64 + 0.5 - 22.0);
        let r = (x * x + y * y).sqrt();
        if r > 23.0 {
            assert!(*rgb == [0.0; 3] && depth[i] == 0.0, "{x} {y}");
        } else if r < 21.0 {
            assert!(rgb[2] > 0.0, "{x} {y}");
        }
    }
}

/// Each colour of an anaglyph is what the eye behind that glass sees, as far as noise allows: its mean squared distance from
/// that eye's picture is what both variances say, and far less than from the other eye's.
#[test]
fn an_anaglyph_is_the_pictures_of_both_eyes() {
    let eye = |layout: &str| {
        let more = format!("stereo: {{ layout: {layout}, separation: 0.4, convergence: 8 }}");
        let wish = Overrides { spp: Some(64), pattern: None, ..Overrides::default() };
        render(&perspective(&more), wish).picture.layers
    };
    let (left, right, both) = (eye("left"), eye("right"), eye("anaglyph"));
    for channel in 0..3 {
        let off = |other: &straal_render::film::Layers| -> f64 {
            let pairs = both.rgb.iter().zip(&other.rgb);
            pairs.map(|(a, b)| f64::from(a[channel] - b[channel])).map(|d| d * d).sum()
        };
        let (own, other) = if channel == 0 { (&left, &right) } else { (&right, &left) };
        assert!(off(own) * 5.0 < off(other), "channel {channel}: {} {}", off(own), off(other));
        // The mean over the picture, which noise hardly moves.
        let mean = |l: &straal_render::film::Layers| -> f64 {
            l.rgb.iter().map(|p| f64::from(p[channel])).sum::<f64>() / l.rgb.len() as f64
        };
        let variance: f64 =
            [own, &both].iter().flat_map(|l| &l.variance).map(|v| f64::from(v[channel])).sum();
        let error = variance.sqrt() / both.rgb.len() as f64;
        assert!((mean(own) - mean(&both)).abs() < 4.5 * error, "{} {} +- {error}", mean(own), mean(&both));
    }
}

/// What a panorama has seen, used as surroundings, is seen again, in the same directions.
#[test]
fn a_panorama_gives_back_the_surroundings() {
    let folder = std::env::temp_dir().join(format!("straal-panorama-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the picture");
    let panorama = of_kind("panorama", "rows: centered");
    let seen = job(&panorama, Overrides { size: Some([256, 129]), spp: Some(16), ..Overrides::default() });
    let picture = seen.render(&mut Control::to_the_end()).expect("a picture").picture;
    picture.save(&folder.join("around.pfm"), &seen.development()).expect("room for the picture");

    let views = [
        "perspective: { eye: [0, 0.2, 0], look_at: [0.4, 0.3, -2], fov: 80 }",
        "perspective: { eye: [0, 0.2, 0], look_at: [-2, 0, 1.5], fov: 70 }",
        "fisheye: { eye: [0, 0.2, 0], look_at: [0.1, 3, 0.2], up: [0, 0, 1], fov: 200 }",
    ];
    for view in views {
        let wish = || Overrides { spp: Some(64), ..Overrides::default() };
        let real = render(&format!("{{ {view} }}"), wish()).picture.layers.rgb;
        let text = format!(
            "camera: {{ {view} }}\nfilm: {{ size: [60, 44] }}\nlights: [environment: {{ file: around.pfm }}]\n"
        );
        let loaded = straal::load_str("again.yaml", &text, &folder, &LoadOptions::default());
        let again = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish()).expect("a world");
        let again = again.render(&mut Control::to_the_end()).expect("a picture").picture.layers.rgb;
        let off = |other: &dyn Fn(usize) -> usize| -> f64 {
            let sum: f64 = (0..real.len())
                .flat_map(|i| (0..3).map(move |c| (i, c)))
                .map(|(i, c)| f64::from((real[i][c] - again[other(i)][c]).abs()))
                .sum();
            sum / (3 * real.len()) as f64
        };
        // Edges are as sharp as the panorama's pixels, 1.4 degrees, and the floor has noise.
        let (found, mirrored) = (off(&|i| i), off(&|i| i / 60 * 60 + 59 - i % 60));
        assert!(found < 0.015, "{view}: {found}");
        assert!(mirrored > 3.0 * found, "{view}: {found} {mirrored}");
    }
    std::fs::remove_dir_all(&folder).expect("the folder is ours");
}
