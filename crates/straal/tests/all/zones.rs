//! The zones of a lamp's shadow, where cones that touch two balls say where they end.

use std::path::Path;
use straal::{Control, Job, LoadOptions, Overrides, Picture};
use straal_accel::Isa;

const UMBRA: [f32; 3] = [0.01, 0.015, 0.06];
const ANTUMBRA: [f32; 3] = [1.0, 0.4, 0.03];
const LIT: [f32; 3] = [1.0; 3];

/// Heights of a ball lamp and of a ball below it, on one axis.
const HEIGHTS: [f64; 2] = [5.0, 2.0];

fn job(text: &str, wish: Overrides) -> Result<Job, String> {
    let loaded = straal::load_str("test.yaml", text, Path::new(""), &LoadOptions::default());
    Job::new(loaded.map_err(|d| d.to_string())?, wish).map_err(|e| e.to_string())
}

fn picture(text: &str, wish: Overrides) -> Picture {
    job(text, wish).unwrap().render(&mut Control::to_the_end()).unwrap().picture
}

/// What a place of the ground at `x` looks like, from just above it.
fn at(x: f64, world: &str, keys: &str) -> [f32; 3] {
    let text = format!(
        "camera: {{ orthographic: {{ eye: [{x}, 0.5, 0], look_at: [{x}, 0, 0], up: [0, 0, 1], width: 1e-6 }} }}\n\
         film: {{ size: [1, 1] }}\nsampler: {{ spp: 1 }}\nintegrator: {{ zones: {{ {keys} }} }}\n\
         world:\n  - plane: {{}}\n{world}"
    );
    picture(&text, Overrides::default()).layers.rgb[0]
}

/// The film holds light to fewer digits than the colours have.
fn is(rgb: [f32; 3], zone: [f32; 3]) -> bool {
    rgb.iter().zip(zone).all(|(a, b)| (a - b).abs() < 1e-4)
}

fn balls(lamp: f64, ball: f64) -> String {
    let [high, low] = HEIGHTS;
    format!(
        "  - sphere: {{ center: [0, {high}, 0], radius: {lamp}, emission: 2 }}\n  - sphere: {{ center: [0, {low}, 0], radius: {ball} }}\n"
    )
}

/// How far from the axis the ground is met by a line that touches the lamp and the ball, on one side of both (`side` 1: below 0 where the cone has
/// ended above the ground) or on opposite sides (-1). Of a line at the distance c from the origin along its unit normal (cos, sin): the
/// ball's middle is at c - r, the lamp's at c - side R.
fn edge(lamp: f64, ball: f64, side: f64) -> f64 {
    let [high, low] = HEIGHTS;
    let sin = (ball - side * lamp) / (high - low);
    (high * sin + side * lamp) / (1.0 - sin * sin).sqrt()
}

/// A ball that casts an umbra to the ground, and one whose umbra ends above it.
#[test]
fn zones_end_where_the_cones_do() {
    for (lamp, ball) in [(0.5, 0.4), (1.0, 0.3)] {
        let world = balls(lamp, ball);
        let zone = |x| at(x, &world, "across: 32");
        let (inner, outer) = (edge(lamp, ball, 1.0), edge(lamp, ball, -1.0));
        let within = if inner > 0.0 { UMBRA } else { ANTUMBRA };
        let near = inner.abs();
        assert!(near > 0.1 && outer > near + 0.2, "{inner} {outer}");
        for x in [0.0, 0.5 * near, 0.97 * near] {
            assert!(is(zone(x), within), "{lamp} {ball} at {x} of {inner}");
        }
        let between = [1.03 * near, 0.5 * (near + outer), 0.98 * outer].map(zone);
        for rgb in between {
            assert!(
                ![UMBRA, ANTUMBRA, LIT].iter().any(|zone| is(rgb, *zone)) && rgb[2] > 1.5 * rgb[0],
                "{rgb:?}"
            );
        }
        assert!(between[0][1] < between[1][1] && between[1][1] < between[2][1], "{between:?}");
        for x in [1.01 * outer, 2.0 * outer] {
            assert!(is(zone(x), LIT), "{lamp} {ball} at {x} of {outer}");
        }
    }
}

/// On the axis what is seen is a ring between two cones: by solid angle 1 - (1 - cos b) / (1 - cos a).
#[test]
fn the_share_is_that_of_solid_angles() {
    let (lamp, ball) = (1.0, 0.35);
    let lack = |radius: f64, height: f64| 1.0 - (1.0 - radius * radius / (height * height)).sqrt();
    let want = 1.0 - lack(ball, HEIGHTS[1]) / lack(lamp, HEIGHTS[0]);
    let rgb = at(0.0, &balls(lamp, ball), "across: 64, show: share");
    assert!(rgb.iter().all(|v| (f64::from(*v) - want).abs() < 5e-3), "{rgb:?}, expected {want}");
}

/// A sun: below a disc that looks smaller, that looks as large, or larger. A mesh has no known rim.
#[test]
fn suns_discs_and_meshes() {
    let disc = |radius| {
        format!(
            "  - disc: {{ center: [0, 1, 0], normal: [0, 1, 0], radius: {radius} }}\nlights:\n  - directional: {{ direction: [0, -1, 0], irradiance: 1, angle: 20 }}\n"
        )
    };
    // tan 10° = 0.176
    assert!(is(at(0.0, &disc(0.17), ""), ANTUMBRA));
    assert!(is(at(0.0, &disc(0.18), ""), UMBRA));
    assert!(is(at(0.3, &disc(0.1), ""), LIT));
    let below = "  - disc: { center: [0, 1, 0], normal: [0, 1, 0], radius: 0.1 }\n";
    let rectangle = "  - rectangle: { corner: [-1, 2, -1], edges: [[2, 0, 0], [0, 0, 2]], emission: 1 }\n";
    let mesh = "  - mesh: { positions: [[-1, 2, -1], [1, 2, -1], [0, 2, 1]], triangles: [[0, 1, 2]], emission: 1 }\n";
    assert!(is(at(0.0, &format!("{rectangle}{below}"), ""), ANTUMBRA));
    let part = at(0.0, &format!("{mesh}{below}"), "");
    assert!(part[2] > part[1] && part[1] > part[0], "{part:?}");
    // The second lamp is the one that nothing hides.
    let two = format!("{rectangle}  - sphere: {{ center: [5, 5, 0], radius: 1, emission: 1 }}\n{below}");
    assert!(is(at(0.0, &two, "lamp: 2"), LIT));
    // By name: its own, or that of what it is in.
    let ball = "sphere: { center: [5, 5, 0], radius: 1, emission: 1 }";
    let named = two.replace("emission: 1 }", "emission: 1, name: lamp }");
    assert!(is(at(0.0, &named, "lamp: lamp"), ANTUMBRA));
    let group = two.replace(ball, &format!("group: {{ name: far, children: [{{ {ball} }}] }}"));
    assert!(is(at(0.0, &group, "lamp: far"), LIT));
    // A sun is as well, though a larger lamp comes before it.
    let sun = |radius| {
        let named = disc(radius).replace("angle: 20", "angle: 20, name: sun");
        format!("  - sphere: {{ center: [0, 5, 0], radius: 2, emission: 1, name: ball }}\n{named}")
    };
    assert!(is(at(0.0, &sun(0.18), "lamp: sun"), UMBRA));
    assert!(is(at(0.0, &sun(0.18), "lamp: ball"), ANTUMBRA));
}

#[test]
fn a_lamp_must_have_a_size() {
    let text = |rest: &str| {
        format!(
            "camera: {{ perspective: {{ eye: [0, 1, 4], look_at: [0, 0, 0] }} }}\nworld:\n  - plane: {{}}\n{rest}"
        )
    };
    let point = text("lights:\n  - point: { position: [0, 3, 0], intensity: 1 }\nintegrator: zones\n");
    let none = job(&point, Overrides::default()).err().expect("no lamp");
    assert!(none.contains("a lamp with a size"), "{none}");
    let one = text(
        "  - sphere: { center: [0, 3, 0], radius: 1, emission: 1 }\nintegrator: { zones: { lamp: 2 } }\n",
    );
    let beyond = job(&one, Overrides::default()).err().expect("one lamp");
    assert!(beyond.contains("lamp 2") && beyond.contains("one lamp"), "{beyond}");
    let named = text("  - sphere: { name: ball }\nintegrator: { zones: { lamp: ball } }\n");
    let dark = job(&named, Overrides::default()).err().expect("no lamp of that name");
    assert!(dark.contains("goes by the name"), "{dark}");
    let unknown =
        job(&named.replace("lamp: ball", "lamp: boll"), Overrides::default()).err().expect("no such name");
    assert!(unknown.contains("nothing is named `boll`") && unknown.contains("ball"), "{unknown}");
}

#[test]
fn the_same_bits_by_any_way() {
    let text = format!(
        "camera: {{ perspective: {{ eye: [1, 2, 6], look_at: [0, 0.5, 0] }} }}\nfilm: {{ size: [24, 16] }}\nsampler: {{ spp: 2 }}\n\
         integrator: {{ zones: {{ across: 4 }} }}\nworld:\n  - plane: {{}}\n{}",
        balls(1.0, 0.35)
    );
    let hash = |wish| picture(&text, wish).tells("film_hash").unwrap().to_owned();
    let plain = hash(Overrides::default());
    for isa in Isa::ALL.into_iter().filter(|isa| isa.is_available()) {
        for batch in [1, 7, 1024] {
            let wish =
                Overrides { isa: Some(isa), batch: Some(batch), threads: Some(2), ..Overrides::default() };
            assert_eq!(hash(wish), plain, "{isa:?}, batches of {batch}");
        }
    }
}
