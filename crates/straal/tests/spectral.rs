//! Rendering by wavelengths beside RGB.

mod common;

use std::path::Path;
use straal::compare::{Estimate, Tails, compare};
use straal::{Control, Job, LoadOptions, Overrides, Picture};
use straal_math::lowdisc::PatternKind;
use straal_scene::Image;

const REPLICATES: u32 = 12;

fn replicates(text: &str, spectral: bool) -> Picture {
    let loaded = straal::load_str("test.yaml", text, Path::new(""), &LoadOptions::default());
    let wish = Overrides {
        spectral: Some(spectral),
        pattern: Some(PatternKind::Random),
        seed: Some(u64::from(spectral)),
        ..Overrides::default()
    };
    let job = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish).expect("a world");
    job.render_replicates(REPLICATES, &mut Control::to_the_end()).expect("replicates").picture
}

fn differ(a: &Picture, b: &Picture) -> bool {
    let image = |p: &Picture| (p.to_image(), Image { pixels: p.layers.variance.clone(), ..p.to_image() });
    let ((am, av), (bm, bv)) = (image(a), image(b));
    let dof = f64::from(REPLICATES - 1);
    let of = |mean, variance| Estimate { dof, ..Estimate::new(mean, Some(variance)) };
    compare(of(&am, &av), of(&bm, &bv), Tails::Light).expect("equal sizes").differs
}

fn room(wall: &str) -> String {
    format!(
        "camera: {{ perspective: {{ eye: [0, 1, 6], look_at: [0, 0.6, 0], fov: 40 }} }}
film: {{ size: [32, 24] }}
sampler: {{ spp: 64 }}
world:
  - plane: {{ material: {{ diffuse: {{ reflectance: {wall} }} }} }}
  - sphere: {{ center: [-1, 0.8, 0], radius: 0.8, material: {{ diffuse: {{ reflectance: 0.7 }} }} }}
  - sphere: {{ center: [1, 0.8, 0], radius: 0.8, material: {{ conductor: {{ eta: 1.2, k: 3, roughness: 0.3 }} }} }}
  - sphere: {{ center: [0, 0.4, 1.5], radius: 0.4, material: {{ dielectric: {{ eta: 1.5 }} }} }}
lights:
  - environment: {{ radiance: 0.5 }}
  - point: {{ position: [2, 4, 3], intensity: 20 }}
"
    )
}

#[test]
fn greys_are_the_same_by_wavelengths() {
    let rgb = replicates(&room("0.5"), false);
    assert!(!differ(&rgb, &replicates(&room("0.5"), true)));
    // The test can fail: a wall that is a little blue.
    assert!(differ(&rgb, &replicates(&room("[0.48, 0.5, 0.52]"), true)));
}

#[test]
fn direct_light_keeps_its_colour() {
    let seen = |light: &str, wall: &str, spectral: bool| -> [f64; 3] {
        let text = format!(
            "camera: {{ orthographic: {{ eye: [0, 0, 5], look_at: [0, 0, 0], width: 1 }} }}
film: {{ size: [8, 8] }}
sampler: {{ spp: 256 }}
integrator: {{ path: {{ max_depth: 2 }} }}
world: [rectangle: {{ material: {{ diffuse: {{ reflectance: {wall} }} }} }}]
lights: [directional: {{ direction: [0, 0, -1], irradiance: {light} }}]
"
        );
        let picture = replicates(&text, spectral);
        let n = picture.layers.rgb.len() as f64;
        std::array::from_fn(|c| picture.layers.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / n)
    };
    for (light, wall) in
        [("3", "[0.6, 0.3, 0.1]"), ("[3, 2, 0.5]", "0.5"), ("[0, 0, 2]", "0.9"), ("1", "'#c02060'")]
    {
        let (a, b) = (seen(light, wall, false), seen(light, wall, true));
        for c in 0..3 {
            assert!((a[c] - b[c]).abs() < 0.004, "{light} {wall}: {a:?} {b:?}");
        }
    }
    // An illuminant by name has luminance 1 and its own colour: tungsten is orange.
    let [r, g, b] = seen("cie-a", "1", true);
    let scale = std::f64::consts::PI;
    assert!(
        r > g && g > b && (scale * (0.2126 * r + 0.7152 * g + 0.0722 * b) - 1.0).abs() < 0.01,
        "{r} {g} {b}"
    );
    // In RGB as well.
    let rgb = seen("cie-a", "1", false);
    assert!((rgb[0] - r).abs() < 0.01 && (rgb[2] - b).abs() < 0.01, "{rgb:?}");
}

/// What the film makes of a wavelength doesn't depend on the scene's work space but by the matrix.
#[test]
fn white_is_white_in_every_work_space() {
    for space in ["srgb", "rec2020", "acescg"] {
        let text = format!("{}color: {{ space: {space} }}\n", room("0.5"));
        let picture = replicates(&text, true);
        let n = picture.layers.rgb.len() as f64;
        let mean = |c: usize| picture.layers.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / n;
        assert!((mean(0) / mean(1) - 1.0).abs() < 0.01 && (mean(2) / mean(1) - 1.0).abs() < 0.01, "{space}");
    }
}

/// The measured Cornell box beside what another renderer made of it, by its RGB numbers and by its spectra.
#[test]
fn the_measured_cornell_box_is_that_of_another_renderer() {
    if common::shared().is_none() {
        return;
    }
    let names = ["cbox-rgb", "cbox-spectral"];
    let theirs = names.map(|name| {
        ["mean", "var"].map(|file| {
            let path = common::project().join(format!("tests/references/{name}/{file}.exr"));
            let bytes = std::fs::read(path).expect("a reference");
            straal_formats::image::read(&bytes, &straal_formats::Limits::default()).expect("a picture")
        })
    });
    for (k, name) in names.into_iter().enumerate() {
        let wish = Overrides { size: Some([64, 64]), spp: Some(32), ..Overrides::default() };
        let job = common::job(&format!("scenes/reference/{name}.yaml"), wish);
        let ours = job.render_replicates(REPLICATES, &mut Control::to_the_end()).expect("replicates").picture;
        let variance = Image { pixels: ours.layers.variance.clone(), ..ours.to_image() };
        let mean = ours.to_image();
        for (their, [their_mean, their_variance]) in theirs.iter().enumerate() {
            let a = Estimate { dof: f64::from(REPLICATES - 1), ..Estimate::new(&mean, Some(&variance)) };
            let b = Estimate::new(their_mean, Some(their_variance));
            let found = compare(a, b, Tails::Light).expect("equal sizes");
            // Light by RGB and light by wavelengths are told apart: 1 % in red.
            assert_eq!(found.differs, their != k, "{name} by {}: {:?}", names[their], found.reasons);
        }
    }
}
