//! Films that hold XYZ or bands of wavelengths.

use std::path::Path;
use straal::develop::PictureFile;
use straal::{Control, Development, Job, LoadOptions, Overrides, Picture, Recording};
use straal_color::spectrum::Bands;
use straal_color::{Adaptation, RgbSpace, Space};
use straal_formats::Limits;
use straal_formats::image::exr;

const SCENE: &str = "
camera: { perspective: { eye: [0, 1, 6], look_at: [0, 0.6, 0], fov: 40 } }
film: { size: [40, 30] }
sampler: { spp: 8 }
color: { space: WORK }
world:
  - plane: { material: { diffuse: { reflectance: [0.2, 0.6, 0.3] } } }
  - sphere: { center: [-1, 0.8, 0], radius: 0.8, material: { conductor: { metal: gold } } }
  - sphere: { center: [1, 0.8, 0], radius: 0.8, material: { dielectric: { eta: SF11 } } }
lights:
  - environment: { radiance: 0.5 }
  - point: { position: [2, 4, 3], intensity: [20, 15, 8] }
";

fn job(work: Space, wish: Overrides) -> Result<Job, straal::Error> {
    let text = SCENE.replace("WORK", work.name());
    let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
    Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish)
}

fn render(work: Space, wish: Overrides) -> Picture {
    let job = job(work, wish).unwrap_or_else(|e| panic!("{e}"));
    job.render(&mut Control::to_the_end()).expect("a picture").picture
}

fn wish(recording: Recording, spectral: bool) -> Overrides {
    Overrides { recording: Some(recording), spectral: Some(spectral), ..Overrides::default() }
}

fn spectral() -> Recording {
    Recording::Spectral(Bands::new(360.5, 829.5, 469).expect("bands"))
}

#[track_caller]
fn close(a: &[[f32; 3]], b: &[[f32; 3]], tolerance: f32) {
    assert_eq!(a.len(), b.len());
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        let size = b.iter().fold(0.1_f32, |m, v| if v.abs() > m { v.abs() } else { m });
        for c in 0..3 {
            assert!((a[c] - b[c]).abs() <= tolerance * size, "pixel {i}: {a:?}, not {b:?}");
        }
    }
}

/// The file that a picture becomes, read again.
fn file(picture: &Picture) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    picture.save(&path, &Development::default()).expect("a file");
    std::fs::read(path).expect("the file")
}

#[test]
fn xyz_is_the_colour_that_rgb_has_in_every_work_space() {
    for by_wavelengths in [false, true] {
        for work in [Space::Srgb, Space::Rec2020, Space::AcesCg] {
            let rgb = render(work, wish(Recording::Rgb, by_wavelengths));
            let xyz = render(work, wish(Recording::Xyz, by_wavelengths));
            assert_eq!(xyz.space, RgbSpace::XYZ);
            let back = RgbSpace::XYZ.to(&work.rgb(), Adaptation::Bradford);
            let back: Vec<_> = xyz.layers.rgb.iter().map(|p| back.apply_f32(*p)).collect();
            close(&back, &rgb.layers.rgb, 2e-6);
            let picture_file = PictureFile::read(&file(&xyz), &Limits::default()).expect("an EXR of XYZ");
            assert_eq!(picture_file.space(), RgbSpace::XYZ);
        }
    }
}

#[test]
fn bands_add_up_to_the_colour() {
    let picture = render(Space::AcesCg, wish(spectral(), true));
    let plain = render(Space::AcesCg, wish(Recording::Rgb, true));
    assert!(picture.layers.rgb == plain.layers.rgb, "the bands changed the picture");
    let mut read = exr::read(&file(&picture), &Limits::default()).expect("an EXR");
    let attribute = |name: &str| read.metadata.iter().any(|(key, _)| key == name);
    assert!(attribute("spectralLayoutVersion") && attribute("emissiveUnits"));
    // As a program would write it that knows of wavelengths only.
    read.layers.retain(|l| l.name == exr::SPECTRAL_LAYER);
    assert_eq!(read.layers[0].channels.len(), 469);
    let beauty = read.beauty().expect("colours");
    let back = RgbSpace::XYZ.to(&Space::AcesCg.rgb(), Adaptation::Bradford);
    let back: Vec<_> = beauty.pixels.iter().map(|p| back.apply_f32(*p)).collect();
    // Each band is a nanometre; the first and the last, which hardly anybody sees and few samples have, are in none.
    close(&back, &plain.layers.rgb, 1e-3);
    let mean = |pixels: &[[f32; 3]]| -> f64 {
        pixels.as_flattened().iter().map(|v| f64::from(*v)).sum::<f64>() / (3 * pixels.len()) as f64
    };
    assert!((mean(&back) / mean(&plain.layers.rgb) - 1.0).abs() < 3e-5);
}

#[test]
fn bands_are_the_same_however_they_are_rendered() {
    let few = Recording::Spectral(Bands::new(401.5, 699.0, 7).expect("bands"));
    let planes = |wish: Overrides| render(Space::Srgb, wish).layers.bands.expect("bands").planes;
    let whole = planes(Overrides { threads: Some(1), ..wish(few, true) });
    let other = Overrides { threads: Some(3), batch: Some(7), shuffle_tiles: Some(5), ..wish(few, true) };
    assert!(planes(other) == whole);
    let crop = planes(Overrides { crop: Some([5, 7, 29, 30]), ..wish(few, true) });
    for (crop, whole) in crop.iter().zip(&whole) {
        assert!(crop.chunks(24).zip(whole.chunks(40).skip(7)).all(|(c, w)| *c == w[5..29]));
    }
}

#[test]
fn replicates_have_the_mean_of_their_bands() {
    let few = Recording::Spectral(Bands::new(400.0, 700.0, 3).expect("bands"));
    let job = job(Space::Srgb, wish(few, true)).expect("a job");
    let of = |outcome: straal::Outcome| outcome.picture.layers.bands.expect("bands").planes;
    let one = of(job.render(&mut Control::to_the_end()).expect("a picture"));
    let two = of(job.render_replicates(2, &mut Control::to_the_end()).expect("a picture"));
    let mean = |planes: &[Vec<f32>]| planes.iter().flatten().map(|v| f64::from(*v)).sum::<f64>();
    let (a, b) = (mean(&one), mean(&two));
    assert!(a != b && (a / b - 1.0).abs() < 0.05, "{a} {b}");
}

#[test]
fn wavelengths_that_are_not_computed_are_refused() {
    let error = job(Space::Srgb, wish(spectral(), false)).err().expect("an error").to_string();
    assert!(error.contains("--spectral"), "{error}");
}

/// A paint that sRGB doesn't hold keeps its colour by wavelengths, and one that can't be is told.
#[test]
fn colours_of_wide_spaces_are_kept_by_wavelengths() {
    let scene = |rgb: &str| {
        format!(
            "spectral: true
color: {{ space: rec2020 }}
camera: {{ orthographic: {{ eye: [0, 0, 1], look_at: [0, 0, 0], width: 1 }} }}
film: {{ size: [8, 8] }}
sampler: {{ spp: 256 }}
world:
  - rectangle: {{ corner: [-5, -5, 0], edges: [[10, 0, 0], [0, 10, 0]], material: {{ diffuse: {{ reflectance: {{ rgb: {rgb}, space: rec2020 }} }} }} }}
lights: [{{ directional: {{ direction: [0, 0, -1], irradiance: 3.141592653589793 }} }}]
"
        )
    };
    let job = |rgb: &str| {
        let text = scene(rgb);
        let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
        Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), Overrides::default()).expect("a job")
    };
    let green = job("[0.03, 0.4, 0.05]");
    assert_eq!(green.world.notes, Vec::<String>::new());
    let pixels = green.render(&mut Control::to_the_end()).expect("a picture").picture.layers.rgb;
    let mean: [f64; 3] =
        std::array::from_fn(|c| pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / pixels.len() as f64);
    for (got, want) in mean.iter().zip([0.03, 0.4, 0.05]) {
        assert!((got - want).abs() < 3e-3, "{mean:?}");
    }
    let notes = job("[0, 1, 0]").world.notes;
    assert!(notes.len() == 1 && notes[0].contains("more colourful than one can be"), "{notes:?}");
}
