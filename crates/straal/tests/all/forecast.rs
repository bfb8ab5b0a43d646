//! What `straal check` says of memory before a render, beside what the search structures take.

use crate::common;

use std::path::Path;
use straal::{Job, LoadOptions, Overrides, Recording};
use straal_color::spectrum::Bands;
use straal_render::film::{Extent, Film};

/// Forecast and truth of a world searched by a structure, in bytes.
fn search_bytes(world: &str, structure: &str, base: &Path) -> [f64; 2] {
    let text = format!(
        "camera: {{ perspective: {{ eye: [0, 0, 5], look_at: [0, 0, 0] }} }}\n\
         accel: {{ structure: {structure} }}\n{world}"
    );
    let loaded = straal::load_str("scene.yaml", &text, base, &LoadOptions::default())
        .unwrap_or_else(|e| panic!("{text}\n{e}"));
    let forecast = straal::forecast(&loaded, &Overrides::default()).unwrap();
    let job = Job::new(loaded, Overrides::default()).unwrap();
    // Instances, and places of shapes, are counted with the geometry.
    let objects = if world.contains("instance") { forecast.geometry } else { 0 };
    let forecast = forecast.search + objects;
    [forecast as f64, job.world.accel.memory_bytes() as f64]
}

const STRUCTURES: [&str; 19] = [
    "brute",
    "volumes",
    "bvh",
    "{ bvh: { compact: true } }",
    "{ bvh: { build: fast } }",
    "{ bvh: { build: best } }",
    "bvh2",
    "{ bvh2: { leaf_size: 1 } }",
    "{ bvh2: { split: agglomerative } }",
    "grid",
    "{ grid: { factor: 1 } }",
    "{ grid: { factor: 4 } }",
    "kd",
    "{ kd: { clip: true } }",
    "{ kd: { leaf_size: 8 } }",
    "octree",
    "{ octree: { leaf_size: 1 } }",
    "bsp",
    "{ bsp: { choice: sah } }",
];

#[test]
fn search_structures_take_what_was_said() {
    let teapot = "world: [bezier: { builtin: teapot, resolution: 12 }]";
    let mut worlds = vec![(teapot, common::project())];
    if let Some(shared) = common::shared() {
        worlds.push(("world: [mesh: { file: spot_triangulated.obj }]", shared.join("scenes/meshes/spot")));
        let bunny = "world: [mesh: { file: bun_zipper.ply }]";
        worlds.push((bunny, shared.join("scenes/meshes/stanford-bunny")));
    }
    let mut off = Vec::new();
    for (world, base) in &worlds {
        for structure in STRUCTURES {
            // The bunny's 69,000 triangles take long: what is built quickly.
            if base.ends_with("stanford-bunny") && !matches!(structure, "bvh" | "bvh2" | "grid") {
                continue;
            }
            let [forecast, truth] = search_bytes(world, structure, base);
            let ratio = truth / forecast;
            if !(1.0 / 1.5..=1.5).contains(&ratio) {
                off.push(format!("{world}, {structure}: {truth} bytes, {ratio:.2} times what was said"));
            }
        }
    }
    assert!(off.is_empty(), "{off:#?}");
}

/// What counts in a scene of many copies is the copies.
#[test]
fn instances_count() {
    let mut world = String::from(
        "objects: { ball: { group: { children: [sphere: {}, disc: { center: [0, 2, 0] }] } } }\nworld:\n",
    );
    for i in 0..2000 {
        world +=
            &format!("  - instance: {{ of: ball, transform: [translate: [{}, {}, 0]] }}\n", i % 50, i / 50);
    }
    for structure in ["volumes", "bvh", "bvh2", "kd", "octree"] {
        let [forecast, truth] = search_bytes(&world, structure, Path::new(""));
        assert!((0.5..=2.0).contains(&(truth / forecast)), "{structure}: {truth} bytes, {forecast} forecast");
    }
}

/// Lamps that light some things only have a choice of light for each, and what `clamp` takes away has a sum in each sample under way.
#[test]
fn choices_of_light_and_what_is_taken_away_count() {
    let scene = |linked: &str| {
        let mut text =
            String::from("camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }\nworld:\n");
        for i in 0..400 {
            let name = ["a", "b", "c"][i % 3];
            text += &format!(
                "  - sphere: {{ center: [{i}, 0, 0], radius: 0.1, name: {name}, emission: 1{linked} }}\n"
            );
        }
        text.replacen("name: a, emission: 1", "name: a, emission: 1, lights_all_but: [c]", 1)
    };
    let load =
        |text: &str| straal::load_str("scene.yaml", text, Path::new(""), &LoadOptions::default()).unwrap();
    let one = load(&scene(""));
    let several = load(&scene(", lights_only: [a, b]").replace(", lights_all_but: [c]", ""));
    let kept = |loaded: &straal_formats::load::Loaded| {
        let forecast = straal::forecast(loaded, &Overrides::default()).unwrap();
        let truth = Job::new(loaded.clone(), Overrides::default()).unwrap().world.light_bytes();
        (forecast.lights, truth as f64)
    };
    for (lights, truth) in [kept(&one), kept(&several)] {
        let ratio = truth / lights as f64;
        assert!((0.5..=2.0).contains(&ratio), "{truth} bytes, {lights} forecast");
    }
    let threads = |clamp| {
        let wish = Overrides { clamp, threads: Some(1), ..Overrides::default() };
        straal::forecast(&one, &wish).unwrap().threads
    };
    assert!(threads(Some(1.0)) > threads(None));
}

/// The film's sums, and the layers that they become: 56 bytes a pixel, and 4 for each band.
#[test]
fn films_take_what_was_said() {
    let bands = Bands::new(400.0, 700.0, 16).expect("bands");
    let usual = Extent { layers: true, ..Extent::default() };
    let spectral = Extent { recording: Recording::Spectral(bands), ..usual };
    for (film, sampler, extent, layers) in [
        ("{}", "{ kind: random }", usual, 56 + 12),
        ("{}", "{}", Extent { batches: true, ..usual }, 56 + 12),
        ("{ channels: { spectral: { bands: 16 } } }", "{ kind: random }", spectral, 56 + 12 + 64),
    ] {
        let text = format!(
            "camera: {{ perspective: {{ eye: [0, 0, 5], look_at: [0, 0, 0] }} }}\nspectral: true\n\
             film: {film}\nsampler: {sampler}\nworld: [sphere: {{}}]\n"
        );
        let loaded = straal::load_str("scene.yaml", &text, Path::new(""), &LoadOptions::default())
            .unwrap_or_else(|e| panic!("{text}\n{e}"));
        let [width, height] = loaded.scene.film.size;
        let told = straal::forecast(&loaded, &Overrides::default()).unwrap();
        let pixels = u64::from(width * height);
        assert_eq!(told.layers, pixels * layers, "{film} {sampler}");
        // And a little for each tile.
        let beyond = told.film as f64 / (pixels * Film::bytes_a_pixel(&extent) as u64) as f64;
        assert!((1.0..1.02).contains(&beyond), "{film} {sampler}: {beyond}");
        // Colours alone take a third of it.
        let colours = Overrides { layers: Some(false), error: Some(false), ..Overrides::default() };
        let colours = straal::forecast(&loaded, &colours).unwrap();
        assert!(colours.film < told.film && colours.layers < told.layers);
    }
}

/// A job is refused by what it will take, before it is made.
#[test]
fn jobs_that_take_too_much_are_refused() {
    let text = "camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }\nworld: [sphere: {}]\n";
    let load = || straal::load_str("scene.yaml", text, Path::new(""), &LoadOptions::default()).unwrap();
    let wish = |memory| Overrides { size: Some([4000, 4000]), memory: Some(memory), ..Overrides::default() };
    let Err(straal::Error::Memory(shortage)) = Job::new(load(), wish(1 << 30)) else {
        panic!("it was taken")
    };
    assert!(shortage.needs > 4000 * 4000 * 176 && shortage.limit == 1 << 30, "{shortage}");
    assert!(Job::new(load(), wish(1 << 34)).is_ok());
}

/// Lamps of objects are kept once, however many instances there are.
#[test]
fn lamps_take_what_was_said() {
    let teapot = "bezier: { builtin: teapot, resolution: 2, emission: 3 }";
    let mut flat = format!("objects: {{ lamp: {{ {teapot} }} }}\nworld:\n");
    for i in 0..1000 {
        flat += &format!(
            "  - instance: {{ of: lamp, transform: [{{ scale: [1, 2, 1] }}, {{ translate: [{}, {}, 0] }}] }}\n",
            10 * (i % 40),
            10 * (i / 40)
        );
    }
    let mut nested = String::from("objects:\n  a: { sphere: { emission: 1 } }\n");
    for (outer, inner) in [("b", "a"), ("c", "b"), ("d", "c"), ("e", "d")] {
        nested += &format!("  {outer}: {{ group: {{ children: [");
        for i in 0..12 {
            let place = [3, 36, 432, 5184][usize::from(inner.as_bytes()[0] - b'a')] * i;
            nested += &format!("instance: {{ of: {inner}, transform: {{ translate: [{place}, 0, 0] }} }}, ");
        }
        nested += "] } }\n";
    }
    nested += "world: [instance: { of: e }]\n";
    for (world, most) in [(flat, 400_000), (nested, 20_000)] {
        let text = format!("camera: {{ perspective: {{ eye: [0, 0, 50], look_at: [0, 0, 0] }} }}\n{world}");
        let loaded = straal::load_str("scene.yaml", &text, Path::new(""), &LoadOptions::default())
            .unwrap_or_else(|e| panic!("{text}\n{e}"));
        let told = straal::forecast(&loaded, &Overrides::default()).unwrap().lights as f64;
        let truth = Job::new(loaded, Overrides::default()).unwrap().world.light_bytes() as f64;
        assert!((truth / told - 1.0).abs() < 0.1 && told < f64::from(most), "{truth} bytes, {told} forecast");
    }
}
