//! Light tracing: paths that start at lights, and light for any place of the film.

use std::path::Path;
use straal::{Control, Error, Job, LoadOptions, Overrides, Recording};
use straal_accel::Isa;
use straal_render::driver::{Render, RenderError};
use straal_render::film::hash_of;
use straal_render::integrator::{AnyIntegrator, LightTracer};
use straal_render::settings::Settings;
use straal_scene::desc::Denoise;

const SIZE: [u32; 2] = [48, 32];

/// A point light above a ball and a table with a wall.
const POINT: &str = "\
camera: { perspective: { eye: [0, 0, 0], look_at: [0, 0, -1], fov: 60 } }
world:
  - rectangle: { corner: [-4, -1, 1], edges: [[8, 0, 0], [0, 0, -8]], material: { diffuse: { reflectance: [0.7, 0.6, 0.5] } } }
  - rectangle: { corner: [-4, -1, -6], edges: [[8, 0, 0], [0, 6, 0]], material: { diffuse: { reflectance: [0.3, 0.5, 0.7] } } }
  - sphere: { center: [-0.4, -0.4, -3], radius: 0.6, material: { diffuse: { reflectance: 0.8 } } }
lights:
  - point: { position: [1, 2.5, -2], intensity: [9, 7, 5] }
";

/// Lamps with an area, of either side and with a picture of their own, through a lens: gloss, a smooth mesh of few triangles, light that goes
/// through, and a mixture.
const AREA: &str = "\
camera: { perspective: { eye: [0, 0.4, 0.5], look_at: [0, -0.2, -3], fov: 50, lens: { radius: 0.1, focus_distance: 3 } } }
film: { filter: tent }
materials:
  gold: { conductor: { metal: gold, roughness: 0.5 } }
  clay: { diffuse: { reflectance: [0.7, 0.5, 0.4] } }
world:
  - rectangle: { corner: [-3, -1, 0], edges: [[6, 0, 0], [0, 0, -6]], material: { mix: { first: clay, second: gold, weight: 0.4 } } }
  - rectangle: { corner: [0.5, -0.6, -2.5], edges: [[1, 0, 0.4], [0, 1, 0]], material: { diffuse_transmission: { reflectance: 0.2, transmittance: 0.6 } } }
  - bezier: { builtin: teapot, resolution: 8, material: { plastic: { roughness: 0.3 } }, transform: [{ scale: 0.3 }, { translate: [-0.5, -1, -2.6] }] }
  - sphere: { center: [-1.2, 1, -3.5], radius: 0.3, emission: [16, 12, 8] }
  - rectangle: { corner: [1, -0.9, -3.5], edges: [[0.4, 0, 0], [0, 0.9, 0]], two_sided_emission: true, emission: { texture: { checker: { first: 6, second: 1, squares: [4, 4] } } } }
";

/// Light from afar and in a cone, by parallel rays; a boundary that absorbs, and light through rough glass.
const AFAR: &str = "\
camera: { orthographic: { eye: [1, 2, 3], look_at: [0, 0, 0], width: 4 } }
world:
  - rectangle: { corner: [-4, 0, 4], edges: [[8, 0, 0], [0, 0, -8]], material: { diffuse: { reflectance: 0.6 } } }
  - sphere: { center: [-0.7, 0.7, 0], radius: 0.5, material: { dielectric: { eta: 1.5, roughness: 0.4 } } }
  - box: { min: [0.3, 0, -0.5], max: [0.9, 0.8, 0.2], material: { phong: { reflectance: 0.4, specular: 0.4, exponent: 8 } } }
lights:
  - directional: { direction: [-1, -2, -1], irradiance: [2, 1.5, 1] }
  - environment: { radiance: [0.3, 0.4, 0.6] }
  - spot: { position: [1.5, 2, 1], look_at: [0, 0, 0], intensity: 3, cutoff: 30 }
";

fn job_of(scene: &str, integrator: &str, wish: Overrides) -> Job {
    let text = format!("{scene}integrator: {integrator}\n");
    let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
    Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), Overrides { size: Some(SIZE), ..wish })
        .expect("a world")
}

/// Pictures of several seeds.
fn pictures(scene: &str, integrator: &str, seeds: std::ops::Range<u64>, spp: u32) -> Vec<Vec<[f32; 3]>> {
    seeds
        .map(|seed| {
            let wish =
                Overrides { seed: Some(seed), spp: Some(spp), layers: Some(false), ..Overrides::default() };
            let wish = Overrides { error: Some(false), ..wish };
            let outcome = job_of(scene, integrator, wish).render(&mut Control::to_the_end()).unwrap();
            assert_eq!(outcome.dropped.count, 0);
            outcome.picture.layers.rgb
        })
        .collect()
}

/// By blocks of 8 x 8 pixels and colour: the difference of two means of pictures over its standard error.
fn z_values(a: &[Vec<[f32; 3]>], b: &[Vec<[f32; 3]>]) -> Vec<f64> {
    let blocks = |picture: &Vec<[f32; 3]>| -> Vec<f64> {
        let across = SIZE[0] as usize / 8;
        let mut sums = vec![0.0; 3 * across * (SIZE[1] as usize / 8)];
        for (i, rgb) in picture.iter().enumerate() {
            let (x, y) = (i % SIZE[0] as usize, i / SIZE[0] as usize);
            for c in 0..3 {
                sums[3 * (y / 8 * across + x / 8) + c] += f64::from(rgb[c]);
            }
        }
        sums
    };
    let moments = |pictures: &[Vec<[f32; 3]>]| -> Vec<[f64; 2]> {
        let all: Vec<Vec<f64>> = pictures.iter().map(blocks).collect();
        let n = all.len() as f64;
        let of = |k: usize| {
            let mean = all.iter().map(|p| p[k]).sum::<f64>() / n;
            let spread = all.iter().map(|p| (p[k] - mean) * (p[k] - mean)).sum::<f64>();
            [mean, spread / (n * (n - 1.0))]
        };
        (0..all[0].len()).map(of).collect()
    };
    let z = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]) / (a[1] + b[1]).sqrt();
    moments(a).iter().zip(&moments(b)).map(z).filter(|z| z.is_finite()).collect()
}

/// Light tracing tells no noise: it is told by pictures of other seeds.
fn agrees(scene: &str, max_depth: u32, spp: u32) {
    let by_light = pictures(scene, &format!("{{ light: {{ max_depth: {max_depth} }} }}"), 1..13, spp);
    let by_path = pictures(scene, &format!("{{ path: {{ max_depth: {max_depth} }} }}"), 101..113, spp);
    let moments = |by_light: &[Vec<[f32; 3]>]| -> (f64, f64) {
        let z = z_values(by_light, &by_path);
        let square = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
        (square, z.iter().fold(0.0, |worst, z| if z.abs() > worst { z.abs() } else { worst }))
    };
    // Student's t of 22 degrees of freedom has the variance 22 / 20 = 1.1, and the deviation of its square is 1.7. Blocks, and
    // colours of one block, aren't independent: the 24 blocks count.
    let limit = 1.1 + 3.0 * 1.7 / 24.0_f64.sqrt();
    let (square, worst) = moments(&by_light);
    assert!(square < limit && worst < 5.5, "depth {max_depth}: {square} {worst}");
    let mut brighter = by_light;
    brighter.iter_mut().flatten().for_each(|rgb| *rgb = rgb.map(|v| 1.05 * v));
    assert!(moments(&brighter).0 > limit, "5 % more light isn't seen: {}", moments(&brighter).0);
}

#[test]
fn agrees_with_path_tracing_on_a_point_light() {
    agrees(POINT, 2, 16);
    agrees(POINT, 4, 16);
}

#[test]
fn agrees_with_path_tracing_on_lamps_with_an_area() {
    agrees(AREA, 1, 16);
    agrees(AREA, 4, 16);
}

#[test]
fn agrees_with_path_tracing_on_light_from_afar() {
    agrees(AFAR, 5, 16);
}

#[test]
fn has_the_same_bits_in_any_order() {
    for scene in [POINT, AREA, AFAR] {
        let job = job_of(scene, "light", Overrides::default());
        let AnyIntegrator::Light(tracer) = job.integrator() else { panic!("another integrator") };
        let hash = |job: &Job, settings: Settings, passes: &[u32]| {
            let mut render = Render::new(&job.world, tracer, settings, None).expect("threads");
            passes.iter().for_each(|samples| render.advance(*samples));
            hash_of(&render.into_film().layers().rgb)
        };
        let plain = || Settings { threads: 1, ..job.settings.clone() };
        let want = hash(&job, plain(), &[3]);
        assert_eq!(hash(&job, Settings { threads: 7, batch: 7, ..plain() }, &[3]), want);
        let shuffled = Settings { threads: 2, batch: 1, shuffle_tiles: Some(3), ..plain() };
        assert_eq!(hash(&job, shuffled, &[1, 2]), want);
        for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
            let job = job_of(scene, "light", Overrides { isa: Some(isa), ..Overrides::default() });
            assert_eq!(hash(&job, plain(), &[3]), want, "{isa:?}");
        }
    }
}

#[test]
fn by_wavelengths_it_is_the_same_picture() {
    let mean = |scene: &str, integrator: &str| -> f64 {
        let all = pictures(&format!("{scene}spectral: true\n"), integrator, 1..3, 16);
        all.iter().flatten().map(|rgb| f64::from(rgb[1])).sum()
    };
    let (by_light, by_path) =
        (mean(POINT, "{ light: { max_depth: 3 } }"), mean(POINT, "{ path: { max_depth: 3 } }"));
    assert!((by_light / by_path - 1.0).abs() < 0.02, "{by_light} {by_path}");
}

#[test]
fn its_error_is_told_by_replicates() {
    // As the command asks for an EXR.
    let wish = Overrides { spp: Some(2), error: Some(true), layers: Some(true), ..Overrides::default() };
    let job = job_of(POINT, "light", wish);
    let one = job.render(&mut Control::to_the_end()).unwrap().picture.layers;
    assert!(one.error.is_none() && one.variance.is_empty());
    let error = job.render_replicates(4, &mut Control::to_the_end()).unwrap().picture.layers.error;
    assert!(error.is_some_and(|e| e.rgb.iter().filter(|e| e[1] > 0.0).count() > 300));
}

#[test]
fn what_does_not_go_with_it_is_refused() {
    let refused = |scene: &str, wish: Overrides| {
        let text = format!("{scene}integrator: light\n");
        let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
        match Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish) {
            Err(Error::Request(why)) => why,
            Err(other) => panic!("{other}"),
            Ok(_) => panic!("it isn't refused"),
        }
    };
    let none = Overrides::default;
    for (wish, why) in [
        (Overrides { noise: Some(0.1), ..none() }, "--replicates"),
        (Overrides { splat: Some(true), ..none() }, "every pixel that the filter reaches"),
        (Overrides { denoise: Some(Denoise::Best), ..none() }, "denoiser"),
    ] {
        assert!(refused(POINT, wish).contains(why), "{why}");
    }
    let bands = Recording::Spectral(straal_color::spectrum::Bands::new(400.0, 700.0, 3).unwrap());
    let wish = Overrides { recording: Some(bands), spectral: Some(true), ..none() };
    assert!(refused(POINT, wish).contains("bands"));
    let fisheye = POINT.replace(
        "perspective: { eye: [0, 0, 0], look_at: [0, 0, -1], fov: 60 }",
        "fisheye: { eye: [0, 0, 0], look_at: [0, 0, -1] }",
    );
    assert!(refused(&fisheye, none()).contains("fisheye"));
    let ambient = POINT.replace("lights:\n", "lights:\n  - ambient: { radiance: 1 }\n");
    assert!(refused(&ambient, none()).contains("nowhere"));
    let plane = AFAR.replace("world:\n", "world:\n  - plane: {}\n");
    assert!(refused(&plane, none()).contains("without an end"));
    // A plane that a lamp stands over may be lit.
    let lit = POINT.replace("world:\n", "world:\n  - plane: {}\n");
    job_of(&lit, "light", none());

    let job = job_of(POINT, "light", none());
    let AnyIntegrator::Light(tracer) = job.integrator() else { panic!("another integrator") };
    assert_eq!(LightTracer { max_depth: u32::MAX, ..tracer }, tracer);
    for settings in [
        Settings { noise: Some(0.1), ..job.settings.clone() },
        Settings { splat: true, ..job.settings.clone() },
    ] {
        let refused = Render::new(&job.world, tracer, settings, None).err();
        assert!(matches!(refused, Some(RenderError::LightSplats(_))));
    }
}
