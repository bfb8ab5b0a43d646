//! Surroundings whose colours sRGB doesn't hold.

use std::path::Path;
use straal::{Control, Development, Job, LoadOptions, Overrides, Picture, Recording};

struct Rendered {
    picture: Picture,
    notes: Vec<String>,
}

fn render(folder: &Path, text: &str, spectral: bool) -> Rendered {
    let loaded = straal::load_str("test.yaml", text, folder, &LoadOptions::default());
    let wish =
        Overrides { spectral: Some(spectral), recording: Some(Recording::Xyz), ..Overrides::default() };
    let job = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish).expect("a job");
    let picture = job.render(&mut Control::to_the_end()).expect("a picture").picture;
    Rendered { picture, notes: job.world.notes.clone() }
}

/// The mean X, Y and Z.
fn mean(r: &Rendered) -> [f64; 3] {
    let pixels = &r.picture.layers.rgb;
    std::array::from_fn(|c| pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / pixels.len() as f64)
}

/// Surroundings of a colour of a space, as a picture; seen by themselves.
fn seen(folder: &Path, (space, rgb): (&str, [f64; 3]), work: &str, spectral: bool) -> Rendered {
    let make = format!(
        "camera: {{ panorama: {{ eye: [0, 0, 0], look_at: [0, 0, -1] }} }}
film: {{ size: [8, 5] }}
sampler: {{ spp: 1 }}
color: {{ space: {space} }}
lights: [environment: {{ radiance: {{ rgb: {rgb:?}, space: {space} }} }}]
"
    );
    let loaded = straal::load_str("make.yaml", &make, folder, &LoadOptions::default());
    let job = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), Overrides::default()).expect("a job");
    let picture = job.render(&mut Control::to_the_end()).expect("a picture").picture;
    picture.save(&folder.join("wide.exr"), &Development::default()).expect("a file");
    let text = format!(
        "camera: {{ perspective: {{ eye: [0, 0, 0], look_at: [0, 0, -1] }} }}
film: {{ size: [8, 8] }}
sampler: {{ spp: 1024 }}
color: {{ space: {work} }}
lights: [environment: {{ file: wide.exr }}]
"
    );
    render(folder, &text, spectral)
}

#[test]
fn wide_surroundings_keep_their_colours_by_wavelengths() {
    let folder = tempfile::tempdir().expect("a folder");
    for colour in [
        ("rec2020", [0.1, 1.0, 0.1]),
        ("rec2020", [1.0, 0.05, 0.3]),
        ("display_p3", [1.0, 0.01, 0.01]),
        ("display_p3", [0.0, 2.0, 0.1]),
        ("acescg", [0.1, 0.2, 1.0]),
    ] {
        // A wide work space loses nothing in RGB.
        let rgb = seen(folder.path(), colour, "acescg", false);
        assert_eq!(rgb.notes, [""; 0], "{colour:?}");
        let want = mean(&rgb);
        for work in ["srgb", "acescg"] {
            let spectral = seen(folder.path(), colour, work, true);
            assert_eq!(spectral.notes, [""; 0], "{colour:?}");
            let got = mean(&spectral);
            // Chance (65,536 samples), and the purest red of Display P3, which is at the very limit of light.
            for c in 0..3 {
                assert!(
                    (got[c] - want[c]).abs() < 0.015 * (want[1] + want[c]),
                    "{colour:?}: {got:?}, {want:?}"
                );
            }
        }
    }
}

#[test]
fn colours_that_are_lost_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let rgb = seen(folder.path(), ("rec2020", [0.0, 1.0, 0.0]), "srgb", false);
    let [note] = rgb.notes.as_slice() else { panic!("{:?}", rgb.notes) };
    assert!(
        note.starts_with("40 of the 40 pixels of `wide.exr` are of colours that the work space `srgb`"),
        "{note}"
    );
    // Beyond all light, if only just: what is seen has .028 of red.
    let spectral = seen(folder.path(), ("acescg", [0.0, 1.0, 0.0]), "acescg", true);
    assert!(
        matches!(spectral.notes.as_slice(), [note] if note.contains("are more colourful than light can be"))
    );
    // Far beyond it.
    let spectral = seen(folder.path(), ("aces", [0.0, 0.0, 1.0]), "srgb", true);
    let [note] = spectral.notes.as_slice() else { panic!("{:?}", spectral.notes) };
    assert!(note.contains("are more colourful than light can be"), "{note}");

    // A measured cyan whose red is below 0 in sRGB.
    let paint = "{ wavelengths: [400, 470, 520, 570, 700], values: [0.1, 0.9, 0.9, 0.1, 0.02] }";
    let scene = |work: &str| {
        format!(
            "camera: {{ perspective: {{ eye: [0, 0, 5], look_at: [0, 0, 0] }} }}
film: {{ size: [2, 2] }}
sampler: {{ spp: 1 }}
color: {{ space: {work} }}
world: [sphere: {{ material: {{ diffuse: {{ reflectance: {paint} }} }} }}]
lights: [environment: {{ radiance: 1 }}]
"
        )
    };
    let told = |work: &str, spectral: bool| render(folder.path(), &scene(work), spectral).notes;
    assert!(
        matches!(told("srgb", false).as_slice(), [note] if note.starts_with("a spectrum has the colour [-0."))
    );
    assert!(told("acescg", false).is_empty() && told("srgb", true).is_empty());
}
