//! A cube map that a camera makes lights another scene as the panorama of the same place does.

use std::path::Path;
use straal::{Control, Development, Job, LoadOptions, Overrides, Picture};

/// A place with something else in every direction.
const PLACE: &str = "
film: { size: SIZE }
sampler: { spp: 64 }
world:
  - plane: { material: { diffuse: { reflectance: [0.5, 0.4, 0.2] } } }
  - sphere: { center: [0, 1, -3], radius: 0.9, material: { diffuse: { reflectance: [0.8, 0.1, 0.1] } } }
  - sphere: { center: [3, 1.5, 0], radius: 0.9, material: { diffuse: { reflectance: [0.1, 0.7, 0.1] } } }
  - sphere: { center: [-3, 2, 1], radius: 0.9, material: { diffuse: { reflectance: [0.1, 0.1, 0.8] } } }
  - sphere: { center: [0.5, 4, 0.5], radius: 0.7, emission: [3, 2, 1] }
lights: [environment: { radiance: [0.3, 0.4, 0.6] }]
";

fn render(folder: &Path, text: &str) -> Picture {
    let loaded = straal::load_str("test.yaml", text, folder, &LoadOptions::default());
    let job = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), Overrides::default()).expect("a job");
    job.render(&mut Control::to_the_end()).expect("a picture").picture
}

#[test]
fn surroundings_are_the_same_from_cubes_and_from_panoramas() {
    let folder = tempfile::tempdir().expect("a folder");
    let see = |camera: &str, size: &str| {
        let eye = "eye: [0, 1, 0], look_at: [0, 1, -1]";
        let camera = camera.replace("EYE", eye);
        render(folder.path(), &format!("camera: {camera}{}", PLACE.replace("SIZE", size)))
    };
    let panorama = see("{ panorama: { EYE, rows: centered } }", "[192, 97]");
    for (layout, size) in [("cross", "[192, 144]"), ("row", "[288, 48]")] {
        let cube = see(&format!("{{ cube_map: {{ EYE, layout: {layout} }} }}"), size);
        cube.save(&folder.path().join("cube.exr"), &Development::default()).expect("a file");
        // Seen again as a panorama, from far away.
        let look = |light: &str| {
            render(
                folder.path(),
                &format!(
                    "camera: {{ panorama: {{ eye: [7, 8, 9], look_at: [7, 8, 8], rows: centered }} }}
film: {{ size: [192, 97] }}
sampler: {{ spp: 16 }}
lights: [environment: {{ file: cube.exr, layout: {layout}, {light} }}]
"
                ),
            )
        };
        let off = |picture: &Picture| {
            let (mut off, mut total) = (0.0_f64, 0.0_f64);
            for (a, b) in picture.layers.rgb.as_flattened().iter().zip(panorama.layers.rgb.as_flattened()) {
                off += f64::from((a - b).abs());
                total += f64::from(*b);
            }
            off / total
        };
        // Turned half way round and back: only edges, a pixel wide in both, and noise are left.
        let again = look("rotate: 180, transform: [rotate: { axis: y, degrees: 180 }]");
        let (right, turned) = (off(&again), off(&look("rotate: 90")));
        assert!(right < 0.07 && turned > 0.2, "{layout}: off by {right}, turned by {turned}");
        let means = [&again, &panorama].map(|p| p.layers.rgb.iter().map(|v| f64::from(v[1])).sum::<f64>());
        assert!((means[0] / means[1] - 1.0).abs() < 0.01, "{layout}: {means:?}");
    }
}

#[test]
fn layouts_that_do_not_fit_are_told_with_their_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = |film: &str, light: &str| {
        format!(
            "camera: {{ panorama: {{ eye: [0, 0, 0], look_at: [0, 0, -1] }} }}\nfilm: {{ size: {film} }}\nsampler: {{ spp: 1 }}\n\
             lights: [environment: {light}]\n"
        )
    };
    let wide = render(folder.path(), &text("[64, 32]", "{ radiance: 1 }"));
    wide.save(&folder.path().join("wide.exr"), &Development::default()).expect("a file");
    let load = |light: &str| {
        straal::load_str("test.yaml", &text("[8, 8]", light), folder.path(), &LoadOptions::default())
    };
    let error = load("{ file: wide.exr, layout: cross }").expect_err("an error").to_string();
    assert!(error.contains("64 x 32") && error.contains("4 by 3"), "{error}");
    let error = load("{ radiance: 1, layout: row }").expect_err("an error").to_string();
    assert!(error.contains("`layout` means nothing without `file`"), "{error}");
}
