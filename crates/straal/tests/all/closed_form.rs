//! The scenes of `tests/scenes`, whose every pixel a formula gives, with every sampler and integrator that there is.
//!
//! The mean of the picture may be off by 4.5 of its standard errors (once in 150,000 comparisons by chance) and the
//! relative tolerance that the file names, which covers single precision. Sobol points scatter less than their
//! spread within a pixel says, so that for them the test is only stricter in truth than by its numbers.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use straal::{Control, Job, LoadOptions, Overrides};
use straal_math::lowdisc::PatternKind;
use straal_scene::decode::Describe;
use straal_scene::desc::{Camera, Integrator, Light, Material, MaterialRef, Node, Texture, TextureOf};
use straal_scene::limit::Limit;
use straal_scene::visit::Visitor;

/// Standard errors that the mean may be off by.
const SIGMAS: f64 = 4.5;

struct Expected {
    rgb: [f64; 3],
    tolerance: f64,
}

/// What the first comment lines of a file say.
fn expected(path: &Path) -> Expected {
    let text = std::fs::read_to_string(path).unwrap();
    let says = |key: &str| {
        let found = text
            .lines()
            .take_while(|l| l.starts_with('#'))
            .find_map(|l| l.strip_prefix(&format!("# {key}: ")));
        found.unwrap_or_else(|| panic!("{} says no `# {key}:`", path.display())).trim().to_owned()
    };
    let number = |s: &str| s.trim().parse::<f64>().unwrap_or_else(|e| panic!("{}: {s}: {e}", path.display()));
    let expect = says("expect");
    let rgb = match expect.strip_prefix('[').and_then(|s| s.strip_suffix(']')) {
        Some(list) => {
            let numbers: Vec<f64> = list.split(',').map(number).collect();
            numbers.try_into().unwrap_or_else(|_| panic!("{}: three numbers", path.display()))
        }
        None => [number(&expect); 3],
    };
    assert!(!says("how").is_empty());
    Expected { rgb, tolerance: number(&says("tolerance")) }
}

fn scenes() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/scenes");
    let mut all: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    all.retain(|p| p.extension().is_some_and(|e| e == "yaml"));
    all.sort();
    all
}

/// The picture's mean and its standard error, by channel.
fn render(path: &Path, kind: PatternKind, spectral: bool) -> [(f64, f64); 3] {
    let loaded =
        straal::load(path, &LoadOptions::default()).unwrap_or_else(|d| panic!("{}: {d:?}", path.display()));
    let wish =
        Overrides { pattern: Some(kind), seed: Some(1), spectral: Some(spectral), ..Overrides::default() };
    let job = Job::new(loaded, wish).unwrap();
    let outcome = job.render(&mut Control::to_the_end()).unwrap();
    assert_eq!(outcome.dropped.count, 0, "{}: samples that are no numbers", path.display());
    let layers = &outcome.picture.layers;
    let n = layers.rgb.len() as f64;
    std::array::from_fn(|c| {
        let mean: f64 = layers.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / n;
        let variance: f64 = layers.variance.iter().map(|p| f64::from(p[c])).sum::<f64>() / (n * n);
        (mean, variance.sqrt())
    })
}

/// How a picture is off, if it is.
fn fault(rendered: [(f64, f64); 3], expected: &Expected) -> Option<String> {
    let off = rendered.iter().zip(expected.rgb).find(|((mean, error), want)| {
        mean.is_nan() || (mean - want).abs() > SIGMAS * error + expected.tolerance * want.abs()
    });
    off.map(|((mean, error), want)| format!("{mean} +- {error}, expected {want}"))
}

/// Kinds of textures that are written where they are used.
struct Textures<'s>(&'s mut BTreeSet<&'static str>);

impl<'a> Visitor<'a> for Textures<'_> {
    fn texture(&mut self, texture: &'a TextureOf, _: Limit, _: bool) {
        if let TextureOf::Inline(texture) = texture {
            self.0.insert(texture.kind());
        }
    }
}

/// Whatever a scene can be made of stands in one of these scenes: a new kind of thing fails this until it does.
#[test]
fn every_kind_of_thing_has_a_closed_form() {
    let mut seen = BTreeSet::new();
    for path in scenes() {
        let loaded = straal::load(&path, &LoadOptions::default()).unwrap();
        let scene = &loaded.scene;
        seen.extend([scene.integrator.kind(), scene.camera.kind()]);
        seen.extend(scene.lights.iter().map(Light::kind));
        seen.extend(scene.materials.iter().map(|(_, m)| m.kind()));
        seen.extend(scene.textures.iter().map(|(_, t)| t.kind()));
        scene.show(Limit::FINITE, &mut Textures(&mut seen));
        scene.visit(|node| {
            seen.insert(node.kind());
            if let Some(MaterialRef::Inline(material)) = node.material() {
                seen.insert(material.kind());
            }
        });
    }
    let lit = [Integrator::KINDS, Camera::KINDS, Light::KINDS].concat();
    let all = [lit, [Material::KINDS, Node::KINDS, Texture::KINDS].concat()].concat();
    let missing: Vec<&str> = all.into_iter().filter(|kind| !seen.contains(kind)).collect();
    assert!(missing.is_empty(), "no scene in tests/scenes has {}", missing.join(", "));
}

fn all_agree(kind: PatternKind) {
    let scenes = scenes();
    assert!(scenes.len() >= 40, "{} scenes", scenes.len());
    let faults: Vec<String> = scenes
        .iter()
        .filter_map(|path| {
            let found = fault(render(path, kind, false), &expected(path))?;
            Some(format!("{}: {found}", path.file_name().unwrap_or_default().display()))
        })
        .collect();
    assert!(faults.is_empty(), "{kind}, seed 1:\n{}", faults.join("\n"));
}

#[test]
fn closed_forms_with_sobol_points() {
    all_agree(PatternKind::Sobol);
}

#[test]
fn closed_forms_with_random_numbers() {
    all_agree(PatternKind::Random);
}

/// The remaining patterns take turns, a scene each with some of them: all with all would take long and find little more.
#[test]
fn closed_forms_with_all_other_patterns() {
    let others: Vec<PatternKind> = PatternKind::ALL
        .into_iter()
        .filter(|k| k.is_unbiased() && !matches!(k, PatternKind::Sobol | PatternKind::Random))
        .collect();
    let mut faults = Vec::new();
    for (i, path) in scenes().iter().enumerate() {
        for kind in [others[i % others.len()], others[(i + 1) % others.len()]] {
            if let Some(found) = fault(render(path, kind, false), &expected(path)) {
                faults.push(format!("{}, {kind}: {found}", path.file_name().unwrap_or_default().display()));
            }
        }
    }
    assert!(faults.is_empty(), "seed 1:\n{}", faults.join("\n"));
}

/// Scenes without colour give the same by wavelengths: furnaces above all.
#[test]
fn closed_forms_without_colour_by_wavelengths() {
    let grey: Vec<PathBuf> = scenes()
        .into_iter()
        .filter(|path| {
            let [r, g, b] = expected(path).rgb;
            let text = std::fs::read_to_string(path).unwrap();
            // Light that rays from lamps bring tells no noise by which wavelengths could be judged.
            let tells_noise = !text.contains("integrator: { light:");
            r == g
                && g == b
                && tells_noise
                && !text.lines().any(|l| !l.starts_with('#') && l.contains("file:"))
        })
        .collect();
    assert!(grey.iter().filter(|p| p.to_string_lossy().contains("furnace")).count() >= 10);
    let faults: Vec<String> = grey
        .iter()
        .filter_map(|path| {
            let found = fault(render(path, PatternKind::Sobol, true), &expected(path))?;
            Some(format!("{}: {found}", path.file_name().unwrap_or_default().display()))
        })
        .collect();
    assert!(faults.is_empty(), "by wavelengths, seed 1:\n{}", faults.join("\n"));
}

#[test]
fn the_test_can_fail() {
    let path = scenes().into_iter().find(|p| p.ends_with("rectangle-light.yaml")).unwrap();
    let right = expected(&path);
    let rendered = render(&path, PatternKind::Sobol, false);
    assert_eq!(fault(rendered, &right), None);
    let wrong = Expected { rgb: right.rgb.map(|v| 1.01 * v), tolerance: right.tolerance };
    assert!(fault(rendered, &wrong).is_some());
}
