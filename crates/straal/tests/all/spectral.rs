//! Rendering by wavelengths beside RGB.

use crate::common;

use std::path::Path;
use straal::compare::{Estimate, Tails, compare};
use straal::{Control, Job, LoadOptions, Overrides, Picture, Recording};
use straal_color::spectrum::uplift;
use straal_color::{RgbSpace, Space};
use straal_formats::Limits;
use straal_formats::image::exr;
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

/// The measured patches of a ColorChecker as they are rendered under D65, and the X, Y and Z that another program
/// (colour-science 0.4.7, ASTM E308) gives them. Nothing if this machine has no shared data.
struct Checker {
    wavelengths: Vec<f64>,
    patches: Vec<Patch>,
}

struct Patch {
    values: Vec<f64>,
    xyz: [f64; 3],
    /// Linear, and below 0 where sRGB doesn't hold the colour.
    srgb: [f64; 3],
}

impl Checker {
    const COLUMNS: usize = 6;

    fn read() -> Option<Self> {
        let folder = common::shared()?.join("scenes/spectral");
        let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect("a table");
        let (table, expected) = (read("colourchecker_babelcolor_average.csv"), read("expected_values.txt"));
        let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|l| l.split(',').collect()).collect();
        let column = |c: usize| -> Vec<f64> { rows[1..].iter().map(|r| r[c].parse().unwrap()).collect() };
        let patch = |c: usize| {
            let label = format!("BabelColor Average {} XYZ under D65 /100: [", rows[0][c]);
            let after = expected.split_once(&label).expect("an expected value").1;
            let three = |text: &str| -> [f64; 3] {
                let numbers = text.split(']').next().unwrap().split_whitespace();
                numbers.map(|w| w.parse().unwrap()).collect::<Vec<_>>().try_into().unwrap()
            };
            let (_, srgb) = after.split_once("linear sRGB: [").expect("its colour");
            Patch { values: column(c), xyz: three(after), srgb: three(srgb) }
        };
        Some(Self { wavelengths: column(0), patches: (1..rows[0].len()).map(patch).collect() })
    }

    /// One pixel for each patch.
    fn render(&self, interpolation: &str, wish: Overrides) -> Vec<[f32; 3]> {
        let mut text = String::from(
            "camera: { orthographic: { eye: [3, 2, 5], look_at: [3, 2, 0], width: 6 } }
film: { size: [6, 4], filter: box }
integrator: { path: { max_depth: 2 } }
lights: [directional: { direction: [0, 0, -1], irradiance: { name: D65, scale: 3.14159265359 } }]
world:
",
        );
        for (k, patch) in self.patches.iter().enumerate() {
            let [x, y] = [k % Self::COLUMNS, 3 - k / Self::COLUMNS];
            let spectrum = format!("wavelengths: {:?}, values: {:?}", self.wavelengths, patch.values);
            let material = format!("{{ diffuse: {{ reflectance: {{ {spectrum}, {interpolation} }} }} }}");
            let edges = "edges: [[1, 0, 0], [0, 1, 0]]";
            text += &format!("  - rectangle: {{ corner: [{x}, {y}, 0], {edges}, material: {material} }}\n");
        }
        let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
        let job = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish).expect("a world");
        job.render(&mut Control::to_the_end()).expect("a picture").picture.layers.rgb
    }

    /// The greatest difference from what is expected.
    fn error(&self, pixels: &[[f32; 3]], want: impl Fn(&Patch) -> [f64; 3]) -> f64 {
        let far = |(pixel, patch): (&[f32; 3], &Patch)| {
            let want = want(patch);
            // What a screen can't show is black in RGB.
            let shown = want.map(|v| if v > 0.0 { v } else { 0.0 });
            (0..3).map(|c| (f64::from(pixel[c]) - shown[c]).abs()).fold(0.0, greater)
        };
        pixels.iter().zip(&self.patches).map(far).fold(0.0, greater)
    }
}

fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// What is rendered of measured patches is what colorimetry makes of their tables, to 1e-4; straight lines between every 10 nm miss it.
#[test]
fn a_rendered_color_checker_is_that_of_the_oracle() {
    let Some(checker) = Checker::read() else { return };
    assert_eq!(checker.patches.len(), 24);
    let spectral = Overrides {
        spectral: Some(true),
        spp: Some(1 << 14),
        recording: Some(Recording::Xyz),
        ..Overrides::default()
    };
    let error = checker.error(&checker.render("", spectral.clone()), |patch| patch.xyz);
    assert!(error < 1e-4, "{error}");
    // Smooth is what is usual. Few samples tell it, and that straight lines are far off.
    let few = |interpolation: &str| {
        checker.render(interpolation, Overrides { spp: Some(1 << 11), ..spectral.clone() })
    };
    assert_eq!(few(""), few("interpolation: smooth"));
    assert!(checker.error(&few("interpolation: linear"), |patch| patch.xyz) > 1e-3);
    let rgb = checker.render("", Overrides { spp: Some(1), ..Overrides::default() });
    let error = checker.error(&rgb, |patch| uplift::rgb_from_xyz(Space::Srgb).apply(patch.xyz));
    assert!(error < 1e-4, "{error}");
    // The oracle's own linear sRGB: its matrix is that of the standard, rounded to four digits.
    let error = checker.error(&rgb, |patch| patch.srgb);
    assert!(error < 3e-4, "{error}");
}

/// The same tables as a picture of reflectances are developed to the same colours.
#[test]
fn a_picture_of_reflectances_is_seen_under_daylight() {
    let Some(checker) = Checker::read() else { return };
    let mut picture = exr::Layered::of_size(checker.patches.len(), 1);
    let channel = |(i, nm): (usize, &f64)| exr::Channel {
        name: format!("{nm:.3}nm").replace('.', ","),
        samples: checker.patches.iter().map(|p| p.values[i] as f32).collect(),
    };
    let channels = checker.wavelengths.iter().enumerate().map(channel).collect();
    picture.layers = vec![exr::Layer { name: "T".into(), channels }];
    let mut bytes = Vec::new();
    exr::write(&mut bytes, &picture).expect("an EXR");
    let beauty = exr::read(&bytes, &Limits::default()).expect("an EXR").beauty().expect("colours");
    assert_eq!(beauty.space, Some(RgbSpace::XYZ));
    let error = checker.error(&beauty.pixels, |patch| patch.xyz);
    assert!(error < 1e-4, "{error}");
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

/// Side of the squares of the reference's pixels that make one pixel here.
const BLOCK: usize = 4;

/// The means of blocks of pixels, times `scale`.
fn in_blocks(large: &Image, scale: f64) -> Image {
    let (width, height) = (large.width / BLOCK, large.height / BLOCK);
    let mean = |k: usize, c: usize| {
        let (x, y) = (k % width * BLOCK, k / width * BLOCK);
        let rows = large.pixels.chunks(large.width).skip(y).take(BLOCK);
        let sum: f64 = rows.flat_map(|row| &row[x..x + BLOCK]).map(|p| f64::from(p[c])).sum();
        (sum / (BLOCK * BLOCK) as f64 * scale) as f32
    };
    let pixels = (0..width * height).map(|k| std::array::from_fn(|c| mean(k, c))).collect();
    Image { width, height, pixels }
}

/// The measured Cornell box beside what another renderer made of it, by its RGB numbers and by its spectra.
#[test]
fn the_measured_cornell_box_is_that_of_another_renderer() {
    let Some(shared) = common::shared() else { return };
    let names = ["cbox-rgb", "cbox-spectral"];
    let theirs = names.map(|name| {
        // With a box filter the mean of BLOCK x BLOCK pixels is the pixel of the smaller picture, and its variance that of a mean.
        [("mean", 1.0), ("var", 1.0 / (BLOCK * BLOCK) as f64)].map(|(file, scale)| {
            let path = shared.join(format!("reference/{name}/{file}.exr"));
            let bytes = std::fs::read(path).expect("a reference");
            let large =
                straal_formats::image::read(&bytes, &straal_formats::Limits::default()).expect("a picture");
            in_blocks(&large, scale)
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
