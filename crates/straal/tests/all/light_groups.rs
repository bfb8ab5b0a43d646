//! Light told apart by the lamps that it comes from.

use std::path::Path;
use straal::develop::PictureFile;
use straal::relight::Relight;
use straal::sums::{self, Allowed, Kept};
use straal::{
    Control, Development, Isa, Job, LoadOptions, Overrides, Picture, Recording, Snapshot, Structure,
};
use straal_color::spectrum::Bands;
use straal_formats::Limits;
use straal_formats::image::exr;
use straal_scene::desc::{Denoise, Integrator};

/// Lamps of every kind, each of which can be left out.
const LAMPS: [(&str, &str, &str); 6] = [
    (
        "ball",
        "world",
        "  - sphere: { center: [0, 2.5, 1], radius: 0.5, emission: [6, 7, 8], light_group: ball }\n",
    ),
    (
        "paint",
        "world",
        "  - rectangle: { corner: [-3, 0, -1], edges: [[1, 0, 0], [0, 2, 0]], \
        material: { open_pbr: { emission_luminance: 2, emission_color: [1, 0.2, 0.1], light_group: paint } } }\n",
    ),
    ("sky", "lights", "  - environment: { radiance: [0.3, 0.4, 0.5], light_group: sky }\n"),
    (
        "sun",
        "lights",
        "  - directional: { direction: [1, -2, -1], irradiance: 2, angle: 4, light_group: sun }\n",
    ),
    (
        "sun",
        "lights",
        "  - spot: { position: [2, 3, 2], look_at: [0, 0, 0], intensity: 5, light_group: sun }\n",
    ),
    ("rest", "lights", "  - point: { position: [2, 3, 3], intensity: 5 }\n"),
];

const AMBIENT: (&str, &str, &str) =
    ("nowhere", "lights", "  - ambient: { radiance: 0.1, light_group: nowhere }\n");

fn text(lamps: &[(&str, &str, &str)], more: &str) -> String {
    let of = |list: &str| -> String { lamps.iter().filter(|l| l.1 == list).map(|l| l.2).collect() };
    format!(
        "camera: {{ perspective: {{ eye: [0, 1.5, 5], look_at: [0, 0.6, 0], fov: 45 }} }}\n{more}\
         world:\n  - rectangle: {{ corner: [-9, 0, 9], edges: [[18, 0, 0], [0, 0, -18]] }}\n  \
         - sphere: {{ center: [-0.8, 0.6, 0], radius: 0.6, material: {{ conductor: {{ metal: gold }} }} }}\n  \
         - sphere: {{ center: [0.8, 0.6, 0], radius: 0.6, material: {{ dielectric: {{ eta: 1.5 }} }} }}\n{}\
         lights:\n{}",
        of("world"),
        of("lights")
    )
}

fn job(text: &str, wish: Overrides) -> Job {
    let loaded = straal::load_str("test.yaml", text, Path::new(""), &LoadOptions::default());
    Job::new(loaded.unwrap_or_else(|d| panic!("{d}\n{text}")), wish).expect("a job")
}

fn render(text: &str, wish: Overrides) -> Picture {
    let outcome = job(text, wish).render(&mut Control::to_the_end()).expect("a picture");
    assert_eq!(outcome.dropped.count, 0);
    outcome.picture
}

fn small() -> Overrides {
    Overrides { size: Some([20, 16]), spp: Some(4), ..Overrides::default() }
}

fn with(integrator: &str) -> Overrides {
    let integrator = Integrator::bare(integrator).expect("an integrator");
    Overrides { integrator: Some(integrator), ..small() }
}

/// What all groups add up to, and what they don't have of the picture, relative to its brightest pixel.
#[track_caller]
fn adds_up(picture: &Picture, what: &str) {
    let layers = &picture.layers;
    let most = layers.rgb.as_flattened().iter().fold(0.0_f32, |m, v| if v.abs() > m { v.abs() } else { m });
    assert!(most > 0.1, "{what}: there is light");
    for (i, pixel) in layers.rgb.iter().enumerate() {
        for (c, &whole) in pixel.iter().enumerate() {
            let sum: f64 = layers.groups.iter().map(|g| f64::from(g.rgb[i][c])).sum();
            let off = (sum - f64::from(whole)).abs();
            // Each number is rounded to single precision, a sample's and the mean's.
            let allowed = 1e-6 * f64::from(whole.abs() + 0.01 * most);
            assert!(off < allowed, "{what}: pixel {i}: {sum}, not {whole}");
        }
    }
}

fn mean(rgb: &[[f32; 3]]) -> f64 {
    rgb.as_flattened().iter().map(|v| f64::from(*v)).sum::<f64>() / (3 * rgb.len()) as f64
}

/// Every integrator that can say it, and every way in which the film sums: the groups make the whole, and the picture is the very one
/// that there is without them.
#[test]
fn groups_make_the_whole() {
    let bands = Bands::new(400.0, 700.0, 3).expect("bands");
    let wishes = [
        ("path", with("path")),
        ("direct", with("direct")),
        ("whitted", with("whitted")),
        // A lamp of little power among strong ones sends few rays.
        ("light", Overrides { spp: Some(64), ..with("light") }),
        ("splat", Overrides { splat: Some(true), crop: Some([3, 2, 18, 15]), ..small() }),
        ("noise", Overrides { noise: Some(0.2), spp: Some(96), ..small() }),
        ("xyz", Overrides { recording: Some(Recording::Xyz), ..small() }),
        ("bands", Overrides { recording: Some(Recording::Spectral(bands)), spectral: Some(true), ..small() }),
    ];
    for filter in ["box", "mitchell"] {
        let film = format!("film: {{ filter: {filter} }}\n");
        for (name, wish) in &wishes {
            let mut lamps = LAMPS.to_vec();
            if *name != "light" {
                lamps.push(AMBIENT);
            }
            let named = render(&text(&lamps, &film), wish.clone());
            let what = format!("{name}, {filter}");
            let names: Vec<&str> = named.layers.groups.iter().map(|g| g.name.as_str()).collect();
            let nowhere = if *name == "light" { None } else { Some("nowhere") };
            let want: Vec<&str> =
                ["rest", "ball"].into_iter().chain(nowhere).chain(["paint", "sky", "sun"]).collect();
            assert_eq!(names, want, "{what}");
            adds_up(&named, &what);
            let dark: Vec<&String> =
                named.layers.groups.iter().filter(|g| mean(&g.rgb) < 1e-5).map(|g| &g.name).collect();
            assert!(dark.is_empty(), "{what}: {dark:?} bring no light");
            let without =
                |text: String, l: &(&str, &str, &str)| text.replace(&format!(", light_group: {}", l.0), "");
            let plain = render(&lamps.iter().fold(text(&lamps, &film), without), wish.clone());
            assert!(plain.layers.groups.is_empty());
            assert_eq!(plain.layers.rgb, named.layers.rgb, "{what}: the picture is the same");
            assert_eq!(plain.layers.error, named.layers.error, "{what}");
        }
    }
}

/// Lamps that have a name are groups where that is asked for: by their own name, that of what is around them, of their object or of a material that shines.
#[test]
fn lamps_are_groups_by_their_names() {
    let text = "camera: { perspective: { eye: [0, 1, 4], look_at: [0, 0, 0] } }\nfilm: { size: [4, 4] }\n\
        materials: { paint: { open_pbr: { emission_luminance: 1 } }, dull: diffuse }\n\
        objects: { bulb: { sphere: { center: [3, 3, 0], emission: 1 } } }\n\
        world:\n  - plane: { name: ground }\n  - instance: { of: bulb, name: one }\n  - sphere: { material: paint, name: skin }\n\
        \x20 - group: { name: rig, children: [{ sphere: { emission: 1 } }, { sphere: { emission: 1, name: own } }, { sphere: { emission: 1, light_group: said } }] }\n\
        lights:\n  - point: { position: [0, 5, 0], name: the sun.001 }\n  - environment: { radiance: 1 }\n";
    let with = |group_lamps| {
        let options = LoadOptions { group_lamps, ..LoadOptions::default() };
        straal::load_str("test.yaml", text, Path::new(""), &options).unwrap_or_else(|d| panic!("{d}")).scene
    };
    assert_eq!(with(false).light_groups(), ["said"]);
    assert_eq!(with(true).light_groups(), ["bulb", "own", "paint", "rig", "said", "the_sun_001"]);
}

/// A group's layer is the picture by its lamps alone.
#[test]
fn a_group_is_what_its_lamps_bring() {
    let wish = |seed| Overrides { spp: Some(64), seed: Some(seed), ..small() };
    let all = render(&text(&LAMPS, ""), wish(1));
    for group in ["ball", "paint", "sky", "sun", "rest"] {
        // All things stay where they are, but the other lamps are off.
        let off =
            |text: &str| text.replace("emission: [6, 7, 8], ", "").replace("luminance: 2", "luminance: 0");
        let texts = LAMPS.map(|(name, list, lamp)| {
            let is_off = name != group && list == "world";
            (name, list, if is_off { off(lamp) } else { lamp.to_owned() })
        });
        let stays = |l: &&(&'static str, &'static str, String)| l.1 == "world" || l.0 == group;
        let lamps: Vec<_> = texts.iter().filter(stays).map(|l| (l.0, l.1, l.2.as_str())).collect();
        let alone = render(&text(&lamps, ""), wish(2));
        let layer = all.layers.groups.iter().find(|g| g.name == group).expect("a layer");
        let (a, b) = (mean(&layer.rgb), mean(&alone.layers.rgb));
        let n = 3.0 * alone.layers.rgb.len() as f64;
        let variance: f64 = alone.layers.variance.as_flattened().iter().map(|v| f64::from(*v)).sum();
        // Among others a lamp is asked less often: three times the error of its own picture is more than enough.
        let error = 3.0 * (variance / (n * n) * 3.0).sqrt() + 0.01 * b;
        assert!((a - b).abs() < 4.5 * error, "{group}: {a}, not {b} ± {error}");
    }
}

/// Threads and batches change no bit of a group's layer, and neither does a file of sums, whose parts make the whole.
#[test]
fn layers_have_the_same_bits() {
    let scene = text(&LAMPS, "");
    let folder = tempfile::tempdir().expect("a folder");
    for wish in [
        small(),
        with("light"),
        Overrides { splat: Some(true), ..small() },
        Overrides { noise: Some(0.2), spp: Some(40), ..small() },
    ] {
        let whole = render(&scene, wish.clone());
        for other in [
            Overrides { threads: Some(1), batch: Some(7), ..wish.clone() },
            Overrides { threads: Some(3), shuffle_tiles: Some(5), ..wish.clone() },
        ] {
            assert_eq!(render(&scene, other).layers, whole.layers, "{wish:?}");
        }
        let mut parts = Vec::new();
        let spp = wish.spp.expect("a number");
        let halves = [[0, 3], [3, spp]].map(|samples| Overrides { samples: Some(samples), ..wish.clone() });
        let all = if wish.noise.is_some() { vec![wish.clone()] } else { halves.to_vec() };
        for (i, part) in all.into_iter().enumerate() {
            let path = folder.path().join(format!("{i}.sums"));
            let mut keep = |snapshot: &Snapshot<'_>| {
                if snapshot.is_last {
                    let mut file = std::fs::File::create(&path).expect("a file");
                    snapshot.write(&mut file).expect("a disk");
                }
            };
            let mut control = Control::to_the_end();
            control.keep = Some(&mut keep);
            job(&scene, part).render(&mut control).expect("a picture");
            parts.push(Kept::open(&path).expect("sums"));
        }
        let merged = sums::merge(parts, Allowed::default()).expect("parts of one picture");
        assert_eq!(merged.picture.layers.groups, whole.layers.groups, "{wish:?}");
    }
}

/// Several seeds' layers are averaged.
#[test]
fn replicates_have_groups() {
    let outcome =
        job(&text(&LAMPS, ""), small()).render_replicates(3, &mut Control::to_the_end()).expect("a picture");
    assert_eq!(outcome.picture.layers.groups.len(), 5);
    adds_up(&outcome.picture, "replicates");
}

/// Groups of a denoised picture add up to it, and each has lost its noise.
#[test]
fn denoised_groups_make_the_clean_whole() {
    let scene = text(&LAMPS, "");
    let plain = render(&scene, small());
    let clean = render(&scene, Overrides { denoise: Some(Denoise::Fast), ..small() });
    adds_up(&clean, "denoised");
    let roughness = |rgb: &[[f32; 3]]| {
        let pairs = rgb.chunks(20).flat_map(|row| row.windows(2));
        let differences = pairs.map(|p| f64::from(p[0][1] - p[1][1]));
        differences.map(|d| d * d).sum::<f64>()
    };
    for (plain, clean) in plain.layers.groups.iter().zip(&clean.layers.groups) {
        assert_eq!(plain.name, clean.name);
        // Lamps that are seen keep their edges: the ball is one of them.
        if ["sun", "rest", "sky"].contains(&plain.name.as_str()) {
            let (noisy, left) = (roughness(&plain.rgb), roughness(&clean.rgb));
            // What scatters finds the sky by itself, so that it has little noise to lose.
            let most = if plain.name == "sky" { 1.0 } else { 0.95 };
            assert!(left < most * noisy, "{}: {noisy} {left}", plain.name);
        }
    }
    // What is relit needs no warning.
    let mut file = PictureFile::from(&clean);
    let change: Relight = "sun=0.5".parse().expect("a change");
    file.relight(&[change]).expect("relit");
    assert!(file.notes().is_empty(), "{:?}", file.notes());
}

/// A picture of colours alone holds no groups, and integrators that know no lamps say so.
#[test]
fn where_there_are_none() {
    let scene = text(&LAMPS, "");
    assert!(render(&scene, Overrides { layers: Some(false), ..small() }).layers.groups.is_empty());
    let job = job(&scene, with("ao"));
    assert!(job.world.notes.iter().any(|note| note.contains("groups of lights")), "{:?}", job.world.notes);
    let picture = job.render(&mut Control::to_the_end()).expect("a picture").picture;
    assert!(picture.layers.groups.is_empty());
}

/// The only lamp twice as bright gives twice the light, as a render of the brighter lamp does, to the bit: twice is exact.
#[test]
fn relit_is_rendered() {
    let lamp = |intensity: u32| {
        let lamp =
            format!("  - point: {{ position: [2, 3, 3], intensity: {intensity}, light_group: key }}\n");
        render(&text(&[("key", "lights", lamp.as_str())], ""), small())
    };
    let (one, two) = (lamp(5), lamp(10));
    let mut file = PictureFile::from(&one);
    let relight: Relight = "key=2".parse().expect("a change");
    file.relight(std::slice::from_ref(&relight)).expect("a group");
    let mut bytes = [Vec::new(), Vec::new()];
    file.write(&mut bytes[0], straal::picture::Format::Pfm, &Development::default()).expect("memory");
    two.write(&mut bytes[1], straal::picture::Format::Pfm, &Development::default()).expect("memory");
    assert_eq!(bytes[0], bytes[1]);
    // The EXR holds the groups by the names that they are asked for.
    let mut exr = Vec::new();
    one.write(&mut exr, straal::picture::Format::Exr, &Development::default()).expect("memory");
    let read = PictureFile::read(&exr, &Limits::default()).expect("whole");
    assert_eq!(read.light_groups(), ["key", "rest"]);
}

/// The first pixel of a picture of layers that a file holds, relit.
fn relit(layers: &[(&str, [f32; 3])], changes: &[&str]) -> Result<[f32; 3], String> {
    let mut picture = exr::Layered::of_size(2, 1);
    picture.layers = layers.iter().map(|(name, rgb)| exr::Layer::from_rgb(name, &[*rgb, [0.0; 3]])).collect();
    let mut bytes = Vec::new();
    exr::write(&mut bytes, &picture).expect("memory takes all");
    let mut file = PictureFile::read(&bytes, &Limits::default()).expect("whole");
    let changes: Vec<Relight> = changes.iter().map(|text| text.parse().expect("a change")).collect();
    file.relight(&changes).map_err(|e| e.to_string())?;
    let mut out = Vec::new();
    file.write(&mut out, straal::picture::Format::Exr, &Development::default()).expect("memory takes all");
    let read = exr::read(&out, &Limits::default()).expect("whole");
    Ok(read.beauty().expect("a picture").pixels[0])
}

/// Files of straal, of Blender and of Arnold are relit; the latter have no layer of the rest.
#[test]
fn files_are_relit() {
    let own: &[(&str, [f32; 3])] =
        &[("", [3.5, 2.0, 1.0]), ("Combined_key", [2.0, 1.0, 0.0]), ("Combined_rest", [1.5, 1.0, 1.0])];
    assert_eq!(relit(own, &["key=2"]), Ok([5.5, 3.0, 1.0]));
    assert_eq!(relit(own, &["key=off", "rest=2"]), Ok([3.0, 2.0, 2.0]));
    let blender: &[(&str, [f32; 3])] =
        &[("ViewLayer.Combined", [3.0, 2.0, 1.0]), ("ViewLayer.Combined_key", [2.0, 1.0, 0.5])];
    assert_eq!(relit(blender, &["key=off"]), Ok([1.0, 1.0, 0.5]));
    let arnold: &[(&str, [f32; 3])] = &[("", [3.0, 2.0, 1.0]), ("RGBA_key", [2.0, 1.0, 0.5])];
    assert_eq!(relit(arnold, &["key=3"]), Ok([7.0, 4.0, 2.0]));
    let unknown = relit(own, &["kee=2"]).expect_err("there is no such group");
    assert!(unknown.contains("`kee`") && unknown.contains("key"), "{unknown}");
    assert!(relit(&[("", [1.0; 3])], &["key=2"]).is_err());
    // A filter by temperature keeps the luminance.
    let white: &[(&str, [f32; 3])] =
        &[("", [1.0; 3]), ("Combined_key", [1.0; 3]), ("Combined_rest", [0.0; 3])];
    let warm = relit(white, &["key=warm"]).expect("a group");
    let luminance = 0.2126 * warm[0] + 0.7152 * warm[1] + 0.0722 * warm[2];
    assert!((luminance - 1.0).abs() < 2e-3 && warm[0] > 1.3 && warm[2] < 0.5, "{warm:?}");
}

/// Surfaces that are lit by other lamps than their neighbours have the same bits by every instruction set, in any batch and search structure.
#[test]
fn links_have_the_same_bits() {
    let scene = "\
camera: { perspective: { eye: [0, 1.5, 5], look_at: [0, 0.6, 0], fov: 45 } }
objects:
  ball: { sphere: { radius: 0.3 } }
world:
  - rectangle: { corner: [-6, 0, 6], edges: [[12, 0, 0], [0, 0, -12]], name: floor }
  - instance: { of: ball, name: left, transform: [{ translate: [-0.5, 0.4, 0] }] }
  - instance: { of: ball, name: right, transform: [{ translate: [0.5, 0.4, 0] }] }
  - sphere: { center: [0, 2.5, 1], radius: 0.5, emission: [6, 7, 8], lights_only: [left, floor], light_group: a }
  - sphere: { center: [1, 2.5, 0], radius: 0.4, emission: [9, 2, 1], lights_all_but: [left] }
lights:
  - environment: { radiance: [0.3, 0.4, 0.5], lights_only: [ball] }
";
    let plain = render(scene, small());
    adds_up(&plain, "links");
    let sets = Isa::ALL.into_iter().filter(|isa| isa.is_available());
    let sets = sets.map(|isa| Overrides { isa: Some(isa), ..small() });
    let others = [
        Overrides { batch: Some(1), ..small() },
        Overrides { batch: Some(7), threads: Some(3), ..small() },
        Overrides { accel: Some(Structure::Brute), ..small() },
    ];
    for wish in sets.chain(others) {
        assert_eq!(render(scene, wish.clone()).layers, plain.layers, "{wish:?}");
    }
}
