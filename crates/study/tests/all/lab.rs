//! The lab on small scenes: hits are equal, reports are whole, and adding an object can lower the number of tests.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use straal::{Clock, LoadOptions, Loaded, Structure};
use straal_study::lab::{self, Contender, Kind, Payoff, Report, Request};

/// A clock that goes on by a microsecond each time it is read, so that nothing here depends on the machine's pace.
fn clock() -> Clock {
    let now = AtomicU64::new(0);
    Arc::new(move || now.fetch_add(1000, Ordering::Relaxed))
}

/// The project's own folder.
fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn load(scene: &str) -> Loaded {
    let path = project().join(scene);
    straal::load(&path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{scene}:\n{e}"))
}

fn small() -> Request {
    Request { size: Some([32, 24]), rays: 1000, rounds: 1, pictures: true, ..Request::default() }
}

fn run(loaded: &Loaded, request: &Request) -> Report {
    lab::run(loaded, request, &clock(), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn all_structures_find_the_same() {
    for scene in ["scenes/cornell-box.yaml", "scenes/embedded.yaml", "scenes/teapots.yaml"] {
        let report = run(&load(scene), &small());
        let names: Vec<&str> = report.rows.iter().map(|r| r.name.as_str()).collect();
        assert_eq!(names[0], "bvh");
        assert!(Structure::ALL.iter().all(|s| names.contains(&s.name())), "{scene}: {names:?}");
        assert!(report.hits_equal(), "{scene}:\n{}", lab::text::notes(&report));
        for row in &report.rows {
            assert!(row.agreement.compared > 20, "{scene} {}: {:?}", row.name, row.agreement);
            assert!(row.nanoseconds.iter().all(|ns| *ns > 0.0) && row.picture_seconds > 0.0, "{scene}");
            assert!(row.stats.references >= report.primitives, "{scene} {}", row.name);
        }
        let moving = report.moving.as_ref().unwrap_or_else(|e| panic!("{scene}: {e}"));
        assert_eq!(moving.differing, 0, "{scene}");
        assert!(
            report.volumes.rows.iter().filter_map(|w| w.bounded).all(|b| (0.0..=1.0).contains(&b.crossing))
        );
    }
}

#[test]
fn counts_are_the_same_each_time() {
    let loaded = load("scenes/cornell-box.yaml");
    let tests = || run(&loaded, &small()).rows.iter().map(|r| (r.name.clone(), r.tests)).collect::<Vec<_>>();
    let first = tests();
    assert_eq!(first, tests());
    let (_, bvh) = &first[0];
    assert!(bvh.iter().all(|t| t.rays > 0 && t.nodes > 0 && t.boxes >= t.nodes && t.primitives > 0));
}

#[test]
fn rays_are_those_of_a_render() {
    let loaded = load("scenes/cornell-box.yaml");
    let report = run(&loaded, &Request { rays: 1 << 20, spp: 2, ..small() });
    assert_eq!(report.rays[Kind::Primary as usize], 32 * 24 * 2);
    assert_eq!(report.rays_per_sample[0], 1.0);
    // Most vertices in the box ask for a shadow ray, and most paths go on.
    assert!(report.rays_per_sample[1] > 1.0 && report.rays_per_sample[2] > 1.0);
    let pixels = f64::from(loaded.scene.film.size[0] * loaded.scene.film.size[1]);
    assert_eq!(report.picture_rays()[0], pixels * f64::from(loaded.scene.sampler.spp));
}

#[test]
fn reports_are_whole_in_every_form() {
    let report = run(&load("scenes/embedded.yaml"), &small());
    let json = lab::json::report(&report);
    let keys = |v: &serde_json::Value| v.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(
        keys(&json),
        [
            "hits_equal",
            "baseline",
            "structures",
            "left_out",
            "primitives",
            "isa",
            "threads",
            "recorded",
            "picture",
            "bounding_volumes",
            "moving"
        ]
    );
    for s in json["structures"].as_array().unwrap() {
        assert_eq!(
            keys(s),
            [
                "name",
                "build_seconds",
                "bytes",
                "nodes",
                "leaves",
                "depth",
                "sah_cost",
                "references",
                "references_per_primitive",
                "groups",
                "node_tests_per_ray",
                "box_tests_per_ray",
                "primitive_tests_per_ray",
                "duplicates_avoided_per_ray",
                "rays_asked",
                "mrays_per_second",
                "mrays_per_second_by_kind",
                "picture_seconds",
                "pays_off_after",
                "hits_equal",
                "answers_compared",
                "answers_differing",
                "differences"
            ]
        );
        for number in ["build_seconds", "bytes", "primitive_tests_per_ray", "mrays_per_second"] {
            assert!(s[number].as_f64().is_some_and(|n| n > 0.0), "{number}: {s:#}");
        }
        assert_eq!(keys(&s["mrays_per_second_by_kind"]), ["primary", "bounce", "shadow"]);
        assert_eq!(s["hits_equal"], true);
    }

    let text = lab::text::report(&report);
    let page = lab::page::html(&report, "a <scene>");
    for row in &report.rows {
        assert!(text.contains(&row.name) && page.contains(&format!("<th>{}</th>", row.name)), "{}", row.name);
        assert!(page.contains(&format!("<figcaption>{}:", row.name)));
    }
    for line in lab::table::LINES {
        assert!(text.contains(line.label) && page.contains(line.label), "{}", line.label);
    }
    // A picture for each structure, and the legend; nothing from elsewhere, nothing that runs.
    assert_eq!(page.matches("data:image/png;base64,iVBORw0KGgo").count(), report.rows.len() + 1);
    for foreign in ["http", "<script", "<link", "url(", "@import", "a <scene>"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
}

/// What a structure that loses a triangle would look like in the report.
#[test]
fn a_broken_structure_is_told() {
    use lab::{Answer, Difference};
    use straal_accel::Hit;
    let mut report = run(&load("scenes/cornell-box.yaml"), &small());
    let row = report.rows.last_mut().unwrap();
    let name = row.name.clone();
    row.agreement.differing = 1;
    row.agreement.first.push(Difference {
        kind: Kind::Bounce,
        ray: 17,
        expected: Answer::Hit(Hit { t: 2.5, geometry: 1, primitive: 4, ..Hit::MISS }),
        found: Answer::Hit(Hit::MISS),
    });
    assert!(!report.hits_equal());
    let words = "bounce ray 17: a miss instead of t 2.5, u 0.0, v 0.0 on geometry 1, primitive 4";
    assert!(lab::text::report(&report).contains(&format!("{name}: 1 of ")));
    assert!(lab::text::report(&report).contains(words) && lab::page::html(&report, "").contains(words));
    let json = lab::json::report(&report);
    assert_eq!(json["hits_equal"], false);
    assert_eq!(json["structures"].as_array().unwrap().last().unwrap()["differences"][0]["ray"], 17);
}

#[test]
fn parameters_make_rows_of_their_own() {
    let structures = Some(lab::parse_structures("bvh:build=fast,brute,bvh").unwrap());
    let report = run(&load("scenes/embedded.yaml"), &Request { structures, ..small() });
    let names: Vec<&str> = report.rows.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["bvh", "bvh:build=fast", "brute"]);
    assert_eq!(report.rows.iter().filter(|r| r.payoff == Payoff::Cheapest).count(), 1);
}

/// Brute force on a hundred thousand triangles is asked for few rays, and says so.
#[test]
fn slow_structures_are_asked_less() {
    let text = "
camera: { perspective: { eye: [0, 2, 8], look_at: [0, 1, 0], fov: 40 } }
world:
  - bezier: { builtin: teapot, resolution: 32 }
lights:
  - environment: { radiance: 1 }
";
    let loaded = straal::load_str("test", text, Path::new(""), &LoadOptions::default()).unwrap();
    let brute = Contender { name: "brute".into(), structure: Structure::Brute };
    let request = Request { structures: Some(vec![brute]), rays: 1000, ..small() };
    let report = run(&loaded, &request);
    let row = &report.rows[1];
    assert!(row.strides[0] > 1 && row.tests[0].rays < report.rays[0] as u64, "{:?}", row.tests);
    assert!(row.agreement.is_whole() && row.agreement.compared > 0);
    assert!(lab::text::notes(&report).contains("brute: asked with 1 ray in"));
    // One object, and nothing beside it.
    assert!(report.moving.as_ref().unwrap_err().contains("nothing stands"));
}

#[test]
fn scenes_without_anything_to_hit_have_a_report() {
    for world in ["[]", "[{ plane: {} }]"] {
        let text = format!(
            "camera: {{ perspective: {{ eye: [0, 1, 3], look_at: [0, 0, 0] }} }}\nworld: {world}\nlights:\n  - environment: {{ radiance: 1 }}\n"
        );
        let loaded = straal::load_str("test", &text, Path::new(""), &LoadOptions::default()).unwrap();
        let report = run(&loaded, &small());
        assert!(report.hits_equal() && report.moving.is_err(), "{world}");
        assert!(
            !lab::text::report(&report).contains("NaN") && !lab::page::html(&report, "x").contains("NaN")
        );
    }
}

/// A ball inside a ball of leaves ends rays that would go on through the leaves.
#[test]
fn adding_an_object_can_lower_the_number_of_tests() {
    let tests = |scene: &str| {
        let loaded = load(scene);
        let structures = Some(vec![]);
        let report = run(
            &loaded,
            &Request { structures, rays: 2000, size: Some([48, 48]), pictures: false, ..small() },
        );
        let mix = report.picture_rays();
        (loaded.scene.world.len(), report.rows[0].mean_tests(&mix, |t| t.boxes + t.primitives))
    };
    let (hollow, without) = tests("scenes/topiary-hollow.yaml");
    let (filled, with) = tests("scenes/topiary.yaml");
    assert_eq!(filled, hollow + 1);
    assert!(with < 0.9 * without, "{with} tests a ray with the ball, {without} without");
}

#[test]
fn the_topiaries_differ_by_the_ball_alone() {
    let text = |name: &str| std::fs::read_to_string(project().join(name)).unwrap();
    let body = |text: &str| {
        let (_, rest) = text.split_once("\ncamera:").unwrap();
        let (before, core) = rest.split_once("  # ANCHOR: core\n").unwrap_or((rest, ""));
        let after = core.split_once("# ANCHOR_END: core\n").map_or("", |(_, after)| after);
        format!("{before}{after}")
    };
    assert_eq!(body(&text("scenes/topiary.yaml")), body(&text("scenes/topiary-hollow.yaml")));
}
