//! What a scene can't show is told, and what lies far away is not lost.

use straal::{Control, Job, LoadOptions, Overrides};

fn job(text: &str) -> Job {
    let loaded =
        straal::load_str("doubts.yaml", text, std::path::Path::new(""), &LoadOptions::default()).expect(text);
    Job::new(loaded, Overrides { threads: Some(2), ..Overrides::default() }).expect("a job")
}

fn notes(world: &str, lights: &str) -> Vec<String> {
    job(&format!(
        "camera: {{ orthographic: {{ eye: [0, 0.5, 2.2], look_at: [0, 0, 0], width: 0.5 }} }}
film: {{ size: [8, 8] }}
world:
{world}
lights:
{lights}
"
    ))
    .world
    .notes
    .clone()
}

#[test]
fn lights_without_size_behind_glass_are_told() {
    let slab = "  - plane: {}\n  - box: { min: [-5, 1, -5], max: [5, 1.1, 5], material: { dielectric: {} } }";
    let bulb = "  - plane: {}\n  - sphere: { center: [0, 1, 0], radius: 0.3, material: { dielectric: { eta: BK7 } } }";
    for (world, light) in [
        (bulb, "  - point: { position: [0, 1, 0], intensity: 1 }"),
        (bulb, "  - spot: { position: [0, 1, 0], look_at: [0, 0, 0], intensity: 1, cutoff: 3 }"),
        (slab, "  - directional: { direction: [0, -1, 0], irradiance: 1 }"),
        (slab, "  - spot: { position: [0, 2, 0], look_at: [0, 0, 0], intensity: 1, cutoff: 30 }"),
        (slab, "  - point: { position: [0, 2, 0], intensity: 1 }"),
    ] {
        let notes = notes(world, light);
        assert!(notes.len() == 1 && notes[0].contains("doesn't get through glass"), "{light}: {notes:?}");
    }
    let film = "  - plane: {}\n  - box: { min: [-5, 1, -5], max: [5, 1.1, 5], material: { thin_film: { thickness: 300 } } }";
    let light = "  - point: { position: [0, 2, 0], intensity: 1 }";
    assert_eq!(notes(film, light).len(), 1);
    // Metal, which no light passes, whatever lies on it.
    let oxide = &film.replace("thickness: 300", "thickness: 300, metal: gold");
    for (world, light) in [
        // Beside a glass ball, under the slab, and lamps that have a size.
        (bulb, "  - point: { position: [3, 1, 0], intensity: 1 }"),
        (slab, "  - point: { position: [0, 0.5, 0], intensity: 1 }"),
        (slab, "  - environment: { radiance: 1 }"),
        (oxide, "  - point: { position: [0, 2, 0], intensity: 1 }"),
        ("  - plane: {}", "  - point: { position: [0, 1, 0], intensity: 1 }"),
    ] {
        assert_eq!(notes(world, light), [""; 0], "{light}");
    }
}

#[test]
fn distances_beyond_the_film_are_told() {
    let far =
        notes("  - sphere: { center: [0, 0, -5.0e9], radius: 1.0e9 }", "  - environment: { radiance: 1 }");
    assert!(far.len() == 1 && far[0].contains("depth.Z"), "{far:?}");
    assert_eq!(notes("  - sphere: { radius: 1.0e9 }", "  - environment: { radiance: 1 }"), [""; 0]);
}

/// A closed room about a place, with a lamp, a ball, an instance and a camera in it.
fn room([x, y, z]: [f64; 3]) -> String {
    let at = |a: f64, b: f64, c: f64| format!("[{:?}, {:?}, {:?}]", x + a, y + b, z + c);
    format!(
        "camera: {{ perspective: {{ eye: {}, look_at: {}, fov: 60 }} }}
film: {{ size: [24, 24] }}
sampler: {{ spp: 16 }}
objects:
  stone: {{ sphere: {{ radius: 0.3 }} }}
world:
  - box: {{ min: {}, max: {}, material: {{ diffuse: {{ reflectance: 0.6 }} }} }}
  - sphere: {{ center: {}, radius: 0.2, emission: 4 }}
  - instance: {{ of: stone, transform: [translate: {}] }}
lights:
  - point: {{ position: {}, intensity: 2 }}
  - environment: {{ radiance: 1000 }}
",
        at(0.0, 1.5, 1.8),
        at(0.0, 1.0, 0.0),
        at(-2.0, 0.0, -2.0),
        at(2.0, 3.0, 2.0),
        at(0.7, 2.0, -0.5),
        at(-0.5, 0.4, 0.2),
        at(0.0, 2.5, 0.0),
    )
}

#[test]
fn rooms_far_from_the_origin_do_not_leak() {
    let render = |text: &str| job(text).render(&mut Control::to_the_end()).expect("a picture").picture.layers;
    let near = render(&room([0.0; 3]));
    let mean = |l: &straal_render::film::Layers| {
        l.rgb.iter().flatten().map(|v| f64::from(*v)).sum::<f64>() / l.rgb.len() as f64
    };
    for place in [[1e5, 0.0, 0.0], [-1e5, 2e4, 3e5], [1e7, 1e7, 1e7]] {
        let far = render(&room(place));
        // A single ray that slips out brings a thousand.
        assert!((mean(&far) / mean(&near) - 1.0).abs() < 0.01, "{place:?}: {} {}", mean(&far), mean(&near));
        let brightest = far.rgb.iter().flatten().fold(0.0_f32, |a, v| if *v > a { *v } else { a });
        assert!(brightest < 10.0, "{place:?}: {brightest}");
    }
}
