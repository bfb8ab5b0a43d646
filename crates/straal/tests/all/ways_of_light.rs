//! The integrators, and the ways in which the path tracer finds light, against one another.

use std::path::Path;
use straal::{Control, Job, LoadOptions, Overrides};
use straal_scene::desc::Integrator;

/// Lamps of every kind, a floor, a glossy ball and one of glass.
const SCENE: &str = "\
camera: { perspective: { eye: [0, 1.5, 5], look_at: [0, 0.6, 0], fov: 45 } }
film: { size: [16, 16] }
world:
  - plane: { material: { diffuse: { reflectance: [0.6, 0.5, 0.4] } } }
  - sphere: { center: [-0.8, 0.6, 0], radius: 0.6, material: { conductor: { metal: gold, roughness: 0.3 } } }
  - sphere: { center: [0.8, 0.6, 0], radius: 0.6, material: { dielectric: { eta: 1.5 } } }
  - sphere: { center: [0, 2.5, 1], radius: 0.5, emission: [6, 7, 8] }
lights:
  - environment: { radiance: [0.3, 0.4, 0.5] }
  - point: { position: [2, 3, 3], intensity: 5 }
";

/// The mean of the picture and its standard error, by channel.
fn mean(scene: &str, integrator: &str, spp: u32, seed: u64) -> [(f64, f64); 3] {
    let text = format!("{scene}integrator: {integrator}\n");
    let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
    let wish = Overrides { spp: Some(spp), seed: Some(seed), ..Overrides::default() };
    let job = Job::new(loaded.unwrap_or_else(|d| panic!("{integrator}: {d}")), wish).unwrap();
    let outcome = job.render(&mut Control::to_the_end()).unwrap();
    assert_eq!(outcome.dropped.count, 0, "{integrator}");
    let layers = &outcome.picture.layers;
    let n = layers.rgb.len() as f64;
    std::array::from_fn(|c| {
        let mean = layers.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / n;
        let variance = layers.variance.iter().map(|p| f64::from(p[c])).sum::<f64>() / (n * n);
        (mean, variance.sqrt())
    })
}

/// Whether two means are of one picture: z of each channel below 4.5, and neither so uncertain that this says nothing.
fn agree(a: [(f64, f64); 3], b: [(f64, f64); 3]) -> bool {
    a.iter().zip(&b).all(|(a, b)| {
        let error = (a.1 * a.1 + b.1 * b.1).sqrt();
        assert!(error < 0.03 * b.0, "{a:?} {b:?}");
        (a.0 - b.0).abs() < 4.5 * error + 1e-5 * b.0
    })
}

#[test]
fn each_technique_gives_the_same_picture() {
    let mis = mean(SCENE, "{ path: { max_depth: 4 } }", 64, 1);
    for technique in ["lights", "bsdf"] {
        let other = mean(SCENE, &format!("{{ path: {{ max_depth: 4, technique: {technique} }} }}"), 256, 2);
        assert!(agree(mis, other), "{technique}: {mis:?} {other:?}");
        let brighter = other.map(|(mean, error)| (1.1 * mean, error));
        assert!(!agree(mis, brighter), "{technique}: 10 % more light isn't seen");
    }
}

/// Lamps that light some things only: each way to find light finds the same, and leaving a lamp out of the choice is no other than
/// having its light come to nothing.
#[test]
fn lamps_light_what_they_are_said_to() {
    let scene = "\
camera: { perspective: { eye: [0, 1.5, 5], look_at: [0, 0.6, 0], fov: 45 } }
film: { size: [16, 16] }
objects:
  ball: { sphere: { radius: 0.6 } }
world:
  - rectangle: { corner: [-6, 0, 6], edges: [[12, 0, 0], [0, 0, -12]], name: floor }
  - instance: { of: ball, name: left, transform: [{ translate: [-0.8, 0.6, 0] }] }
  - instance: { of: ball, name: right, transform: [{ translate: [0.8, 0.6, 0] }], material: { conductor: { metal: gold, roughness: 0.3 } } }
  - sphere: { center: [0, 2.5, 1], radius: 0.5, emission: [6, 7, 8], lights_only: [left, floor] }
  - sphere: { center: [1, 2.5, 0], radius: 0.4, emission: [9, 2, 1], lights_all_but: [left] }
lights:
  - environment: { radiance: [0.3, 0.4, 0.5], lights_only: [ball] }
  - point: { position: [2, 3, 3], intensity: 5, lights_all_but: [floor] }
";
    let mis = mean(scene, "{ path: { max_depth: 4 } }", 64, 1);
    for technique in ["lights", "bsdf"] {
        let other = mean(scene, &format!("{{ path: {{ max_depth: 4, technique: {technique} }} }}"), 256, 2);
        assert!(agree(mis, other), "{technique}: {mis:?} {other:?}");
    }
    let [direct, path] = [mean(scene, "direct", 64, 3), mean(scene, "{ path: { max_depth: 2 } }", 64, 4)];
    assert!(agree(direct, path), "{direct:?} {path:?}");
    // All light is less than that of lamps without links, and more than nothing.
    let without = scene
        .replace("lights_only: [left, floor]", "flip: false")
        .replace("lights_all_but: [left]", "flip: false");
    let without = without.replace(", lights_only: [ball]", "").replace(", lights_all_but: [floor]", "");
    let all = mean(&without, "{ path: { max_depth: 4 } }", 64, 5);
    assert!(
        mis.iter().zip(&all).all(|(some, all)| some.0 < 0.95 * all.0 && some.0 > 0.2 * all.0),
        "{mis:?} {all:?}"
    );
}

/// A large lamp of which something casts no shadow is found in glossy surfaces by the rays that these scatter, as others are; but where that stands in their way, by points on the lamp alone.
#[test]
fn shadows_that_are_left_out_cost_no_noise() {
    let scene = |ball: &str, said: &str| {
        format!(
            "camera: {{ perspective: {{ eye: [0, 1.5, 5], look_at: [0, 0, 0], fov: 30 }} }}\nfilm: {{ size: [16, 16] }}\nworld:\n\
             \x20 - plane: {{ material: {{ conductor: {{ metal: gold, roughness: 0.05 }} }} }}\n\
             \x20 - sphere: {{ center: {ball}, radius: 0.3, name: ball }}\n\
             \x20 - rectangle: {{ corner: [-2, 0, -3], edges: [[4, 0, 0], [0, 4, 0]], emission: 3{said} }}\n"
        )
    };
    let found = |ball: &str, said: &str, technique: &str, spp: u32| {
        let integrator = format!("{{ path: {{ max_depth: 2, technique: {technique} }} }}");
        mean(&scene(ball, said), &integrator, spp, 1)
    };
    let error = |found: [(f64, f64); 3]| found.iter().map(|(_, error)| error).sum::<f64>();
    let (linked, beside, between) = (", shadows_all_but: [ball]", "[0, 0.5, 9]", "[0, 0.5, 0]");
    let plain = error(found(beside, "", "mis", 64));
    let points = error(found(beside, linked, "lights", 64));
    let now = error(found(beside, linked, "mis", 64));
    assert!(now < 1.3 * plain && now < 0.1 * points, "{now}, not {plain}; {points} by points alone");
    let (both, points) = (found(between, linked, "mis", 64), found(between, linked, "lights", 1024));
    assert!(agree(both, points), "{both:?} {points:?}");
}

/// What casts no shadows of a lamp: each way to find light finds the same, that of the scene where it isn't there.
#[test]
fn shadows_are_cast_by_what_is_said_to() {
    let scene = "\
camera: { perspective: { eye: [0, 1.5, 5], look_at: [0, 0, 0], fov: 30 } }
film: { size: [16, 16] }
objects:
  sheet: { rectangle: { corner: [-2, 0, -2], edges: [[0, 0, 4], [4, 0, 0]], material: { diffuse: { reflectance: 0 } } } }
world:
  - plane: { name: floor }
  - sphere: { center: [0, 0.6, 0], radius: 0.6, name: ball, material: { conductor: { metal: gold, roughness: 0.3 } } }
  - instance: { of: sheet, name: roof, transform: [{ translate: [0, 2, 0] }] }
  - sphere: { center: [0, 3.5, 1], radius: 0.5, emission: [6, 7, 8], shadows_all_but: [sheet] }
  - rectangle: { corner: [1, 3, 0], edges: [[1, 0, 0], [0, 0, 1]], emission: [9, 2, 1], shadows_only: [ball], light_group: key }
lights:
  - environment: { radiance: [0.3, 0.4, 0.5], shadows_all_but: [roof] }
  - point: { position: [2, 3, 3], intensity: 5, shadows_all_but: [roof] }
";
    let by = |integrator: &str, spp, seed| mean(scene, integrator, spp, seed);
    let mis = by("{ path: { max_depth: 2 } }", 64, 1);
    let others = [
        "{ path: { max_depth: 2, technique: lights } }",
        "{ path: { max_depth: 2, technique: bsdf } }",
        "direct",
        "{ direct: { light_samples: 3, technique: bsdf } }",
    ];
    let spp = |integrator: &str| if integrator.contains("bsdf") { 1024 } else { 64 };
    for (other, seed) in others.into_iter().zip(2..) {
        let found = by(other, spp(other), seed);
        assert!(agree(mis, found), "{other}: {mis:?} {found:?}");
    }
    // A roof that lets a part of what is scattered through: of the lamps' light it hides none.
    let gauze = scene.replace(
        "material: { diffuse: { reflectance: 0 } }",
        "material: { mask: { opacity: 0.6, material: { diffuse: { reflectance: 0 } } } }",
    );
    let found = mean(&gauze, "{ path: { max_depth: 2, technique: lights } }", 64, 6);
    for (other, seed) in others[1..].iter().chain(&["{ path: { max_depth: 2 } }"]).zip(7..) {
        let with = mean(&gauze, other, spp(other), seed);
        assert!(agree(found, with), "{other}: {found:?} {with:?}");
    }
    // Out of sight, so that it hides nothing from the camera or from light that was scattered before.
    let linked = ["shadows_all_but: [sheet]", "shadows_only: [ball]", "shadows_all_but: [roof]"];
    let without =
        linked.iter().fold(scene.replace("translate: [0, 2, 0]", "translate: [0, -9, 0]"), |text, said| {
            text.replace(said, "light_group: key")
        });
    let without = without.replace("light_group: key, light_group: key", "light_group: key");
    let bare = mean(&without, "{ path: { max_depth: 2 } }", 64, 9);
    assert!(agree(mis, bare), "{mis:?} {bare:?}");
    // And the roof would hide most of it.
    let all = linked.iter().fold(scene.to_owned(), |text, said| text.replace(said, "light_group: key"));
    let dark = mean(
        &all.replace("light_group: key, light_group: key", "light_group: key"),
        "{ path: { max_depth: 2 } }",
        64,
        9,
    );
    assert!(mis.iter().zip(&dark).all(|(some, dark)| dark.0 < 0.8 * some.0), "{mis:?} {dark:?}");
    // By roulette that learns, and by more than one edge.
    let [root, ears] = ["root", "ears"].map(|roulette| {
        by(&format!("{{ path: {{ max_depth: 4, roulette_depth: 2, roulette: {roulette} }} }}"), 64, 5)
    });
    assert!(agree(root, ears), "{root:?} {ears:?}");
    let text = format!("{scene}integrator: light\n");
    let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
    let refused = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), Overrides::default());
    assert!(refused.is_err_and(|e| e.to_string().contains("casts shadows of that lamp")));
}

#[test]
fn roulette_leaves_the_mean() {
    let by = |roulette: &str, seed| {
        mean(SCENE, &format!("{{ path: {{ roulette_depth: 2, roulette: {roulette} }} }}"), 64, seed)
    };
    let (root, ears) = (by("root", 1), by("ears", 3));
    for roulette in ["throughput", "off"] {
        let other = by(roulette, 2);
        assert!(agree(root, other), "{roulette}: {root:?} {other:?}");
        assert!(agree(ears, other), "ears, {roulette}: {ears:?} {other:?}");
    }
}

/// Paths that split have names of their own: the picture is the same whatever the threads and batches.
#[test]
fn paths_that_split_have_the_same_bits() {
    let render = |roulette: &str, threads, batch| {
        let text = format!("{SCENE}integrator: {{ path: {{ roulette: {roulette} }} }}\n");
        let loaded = straal::load_str("test.yaml", &text, Path::new(""), &LoadOptions::default());
        let (spp, threads, batch) = (Some(4), Some(threads), Some(batch));
        let wish = Overrides { spp, threads, batch, ..Overrides::default() };
        let job = Job::new(loaded.unwrap_or_else(|d| panic!("{d}")), wish).unwrap();
        job.render(&mut Control::to_the_end()).unwrap()
    };
    let (one, other) = (render("ears", 1, 1024), render("ears", 3, 7));
    assert_eq!(one.picture.layers.rgb, other.picture.layers.rgb);
    assert_eq!(one.times.rays, other.times.rays);
    assert_eq!(one.picture.tells("roulette"), Some("ears"));
    // It is no other rule under another name.
    for usual in ["root", "off"] {
        assert_ne!(one.times.rays, render(usual, 1, 1024).times.rays, "{usual}");
    }
}

/// What `path` finds with two edges, however many rays are sent for each sample of the pixel.
#[test]
fn direct_light_is_that_of_the_path_tracer() {
    let path = mean(SCENE, "{ path: { max_depth: 2 } }", 64, 1);
    for direct in [
        "direct",
        "{ direct: { light_samples: 4, bsdf_samples: 2 } }",
        "{ direct: { technique: lights, light_samples: 8 } }",
        "{ direct: { technique: bsdf, bsdf_samples: 8 } }",
    ] {
        let other = mean(SCENE, direct, 64, 2);
        assert!(agree(path, other), "{direct}: {path:?} {other:?}");
    }
}

/// Rays of one sample are spread as well as samples of the pixel are.
#[test]
fn many_rays_are_as_good_as_many_samples() {
    let scene = SCENE.replace(
        "eye: [0, 1.5, 5], look_at: [0, 0.6, 0], fov: 45",
        "eye: [0, 1, 5], look_at: [0, 0, 0], fov: 1",
    );
    let error = |integrator: &str, spp| mean(&scene, integrator, spp, 1)[1].1;
    let by_rays = error("{ direct: { technique: lights, light_samples: 16 } }", 4);
    let by_samples = error("{ direct: { technique: lights } }", 64);
    let by_few = error("{ direct: { technique: lights } }", 4);
    assert!(by_rays < 2.0 * by_samples && by_rays < 0.5 * by_few, "{by_rays} {by_samples} {by_few}");
}

/// A scene of which the path tracer sees nothing but what the textbook's sees.
#[test]
fn whitted_sees_what_comes_straight_from_lamps() {
    let scene = "\
camera: { perspective: { eye: [0, 1.5, 5], look_at: [0, 0.6, 0], fov: 45 } }
film: { size: [16, 16] }
world:
  - plane: { material: { diffuse: { reflectance: 0.5 } } }
  - sphere: { center: [-0.8, 0.6, 0], radius: 0.6, material: { mirror: { reflectance: [0.9, 0.7, 0.5] } } }
  - sphere: { center: [0.8, 0.6, 0], radius: 0.6, material: { phong: { exponent: 20 } } }
lights:
  - point: { position: [2, 3, 3], intensity: 5 }
  - directional: { direction: [1, -2, -1], irradiance: 1 }
";
    // The floor's light on the floor is left out by a depth of two edges, of which a mirror needs three.
    let whitted = mean(scene, "{ whitted: { max_depth: 2 } }", 64, 1);
    let naive = mean(scene, "{ whitted: { max_depth: 2, shadows: false } }", 64, 1);
    assert!(whitted.iter().zip(&naive).all(|(a, b)| a.0 < b.0), "no shadows: {whitted:?} {naive:?}");
    let without_mirror =
        scene.replace("mirror: { reflectance: [0.9, 0.7, 0.5] }", "diffuse: { reflectance: 0 }");
    let path = mean(&without_mirror, "{ path: { max_depth: 2 } }", 64, 2);
    let black = mean(&without_mirror, "{ whitted: { reflections: false } }", 64, 1);
    assert!(agree(path, black), "{path:?} {black:?}");
}

/// One sample has no noise: pixels that are wholly of one place come out alike whatever the seed.
#[test]
fn whitted_draws_nothing_by_chance() {
    let scene = "\
camera: { orthographic: { eye: [0, 3, 3], look_at: [0, 0, 0], width: 1e-4 } }
film: { size: [4, 4] }
world:
  - plane: { material: { diffuse: { reflectance: 0.5 } } }
  - box: { min: [-1, 0.5, -1], max: [1, 0.6, 1], material: { dielectric: { eta: 1.6 } } }
  - rectangle: { corner: [2, 3, -1], edges: [[0, 0, 2], [0, 1, 0]], emission: 10 }
lights:
  - point: { position: [0, 3, 0], intensity: 5 }
  - environment: { radiance: [1, 2, 3] }
";
    let [a, b] = [1, 2].map(|seed| mean(scene, "whitted", 1, seed));
    for (a, b) in a.iter().zip(&b) {
        assert!(a.0 > 0.0 && (a.0 - b.0).abs() < 1e-3 * a.0, "{a:?} {b:?}");
    }
}

#[test]
fn occlusion_is_the_same_by_either_warp() {
    let cosine = mean(SCENE, "{ ao: { radius: 1.5 } }", 64, 1);
    let uniform = mean(SCENE, "{ ao: { radius: 1.5, directions: uniform } }", 64, 2);
    assert!(agree(cosine, uniform), "{cosine:?} {uniform:?}");
    // Below a disc that hides what is within asin(sqrt(0.2)) of the zenith, as in tests/scenes/ao-disc.yaml; the wrong one hides the square of that.
    let disc = "\
camera: { orthographic: { eye: [2, 2, 0], look_at: [0, 0, 0], up: [0, 1, 0], width: 0.001 } }
film: { size: [8, 8] }
world:
  - plane: {}
  - disc: { center: [0, 1, 0], normal: [0, -1, 0], radius: 0.5 }
";
    let wrong = mean(disc, "{ ao: { directions: wrong } }", 256, 3)[0].0;
    let hidden = 0.214_969_1;
    assert!((wrong - (1.0 - hidden)).abs() < 2e-3, "{wrong} {hidden}");
}

/// Every integrator can be named alone.
#[test]
fn integrators_stand_by_themselves() {
    for kind in Integrator::KINDS {
        assert_eq!(Integrator::bare(kind).map(|i| i.kind()), Some(*kind));
    }
    assert_eq!(Integrator::bare("bdpt"), None);
}

/// A lamp of many triangles, one of few and a ball, stretched, mirrored and nested, on a floor; in objects, or written out as groups.
fn lamps(of_objects: bool) -> String {
    let shade = "{ box: { min: [-0.5, 0, -0.5], max: [0.5, 0.2, 0.5], material: { diffuse: { reflectance: 0 } }, emission: [4, 3, 2], \
                 two_sided_emission: false } }";
    let ball = "{ sphere: { radius: 0.3, center: [0, 0.8, 0], emission: { texture: { checker: { first: [9, 1, 1], second: [1, 1, 9] } } } } }";
    let dish =
        "{ bezier: { builtin: teapot, resolution: 3, emission: [1, 2, 1], transform: { scale: 0.15 } } }";
    let lamp = format!("[{shade}, {ball}, {dish}]");
    let stands = [
        "[{ scale: [1, 0.5, 1.5] }, { rotate: { axis: [1, 1, 0], degrees: 40 } }, { translate: [-1.2, 1, 0] }]",
        "[{ scale: [-0.8, 0.8, 0.8] }, { translate: [1.3, 0.9, 0.2] }]",
    ];
    let twice = "[{ rotate: { y: 50 } }, { scale: [1, 1.2, 0.7] }, { translate: [0.2, 0.4, -1.5] }]";
    let mut text = String::from(
        "camera: { perspective: { eye: [0, 2.5, 5], look_at: [0, 0.6, 0], fov: 50 } }\nfilm: { size: [16, 16] }\n",
    );
    if of_objects {
        text += &format!("objects:\n  lamp: {{ group: {{ children: {lamp} }} }}\n");
        text += "  pair: { group: { children: [";
        for stand in stands {
            text += &format!("instance: {{ of: lamp, transform: {stand} }}, ");
        }
        text += "] } }\n";
    }
    text += "world:\n  - plane: { material: { diffuse: { reflectance: 0.6 } } }\n";
    for place in ["[]", twice] {
        if of_objects {
            text += &format!("  - instance: {{ of: pair, transform: {place} }}\n");
            continue;
        }
        let pair = stands.map(|s| format!("{{ group: {{ transform: {s}, children: {lamp} }} }}")).join(", ");
        text += &format!("  - group: {{ transform: {place}, children: [{pair}] }}\n");
    }
    text
}

#[test]
fn lamps_of_objects_shine_as_if_written_out() {
    let [objects, written] = [lamps(true), lamps(false)];
    for (integrator, spp) in [("{ path: { max_depth: 3 } }", 64), ("{ direct: { technique: bsdf } }", 128)] {
        let [a, b] = [mean(&objects, integrator, spp, 1), mean(&written, integrator, spp, 2)];
        assert!(agree(a, b), "{integrator}: {a:?} {b:?}");
    }
    for (technique, spp) in [("lights", 64), ("bsdf", 256)] {
        let integrator = format!("{{ path: {{ max_depth: 3, technique: {technique} }} }}");
        let [a, b] =
            [mean(&objects, &integrator, spp, 3), mean(&objects, "{ path: { max_depth: 3 } }", 64, 4)];
        assert!(agree(a, b), "{technique}: {a:?} {b:?}");
    }
}

/// The hemisphere form of the integral, by any directions, and the area form.
#[test]
fn directions_may_be_drawn_by_anything() {
    let path = mean(SCENE, "{ path: { max_depth: 3 } }", 64, 1);
    for (how, spp) in [
        ("cosine", 256),
        ("uniform", 256),
        ("cosine, technique: bsdf", 1024),
        ("uniform, technique: lights", 256),
    ] {
        let other = mean(SCENE, &format!("{{ path: {{ max_depth: 3, directions: {how} }} }}"), spp, 2);
        assert!(agree(path, other), "{how}: {path:?} {other:?}");
    }
    let direct = mean(SCENE, "direct", 64, 1);
    for how in ["cosine", "uniform", "uniform, technique: bsdf, bsdf_samples: 8"] {
        let other = mean(SCENE, &format!("{{ direct: {{ directions: {how} }} }}"), 256, 2);
        assert!(agree(direct, other), "{how}: {direct:?} {other:?}");
    }
}

/// Within glass, a drop of lower priority is as if it weren't there.
#[test]
fn direct_light_passes_what_has_no_boundary() {
    let scene = "\
camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0], fov: 20 } }
film: { size: [8, 8] }
world:
  - box: { min: [-2, -2, -2], max: [2, 2, 2], material: { dielectric: { eta: 1.5, priority: 2 } } }
  - sphere: { radius: 1.2, material: { dielectric: { eta: 1.3, priority: 1 } } }
  - sphere: { radius: 0.8, emission: [3, 2, 1], material: { diffuse: { reflectance: 0 } } }
";
    // A boundary that isn't there is an edge of a path.
    let [direct, path] = ["direct", "{ path: { max_depth: 3 } }"].map(|i| mean(scene, i, 64, 1));
    assert!(direct[0].0 > 0.1 && agree(direct, path), "{direct:?} {path:?}");
}
