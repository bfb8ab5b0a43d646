//! The same bits whatever the threads, batches, tiles, crops, passes and instruction sets.

use crate::common;

use straal::{Overrides, Picture};
use straal_accel::{Isa, Structure};
use straal_render::film::Channel;
use straal_render::film::channel::{NODES, NORMAL, PRIMITIVES, TIME};

const SCENES: [&str; 5] = [
    "scenes/embedded.yaml",
    "scenes/cornell-box.yaml",
    "scenes/glass-and-mirror.yaml",
    "scenes/teapots.yaml",
    "scenes/shapes.yaml",
];

fn small() -> Overrides {
    Overrides { size: Some([50, 37]), spp: Some(3), ..Overrides::default() }
}

fn hash(scene: &str, wish: Overrides) -> String {
    common::render(scene, wish).picture.tells("film_hash").expect("a film hash").to_owned()
}

/// Every variant of the way to the picture must give the plain way's hash.
fn all_equal(variants: &[(&str, Overrides)]) {
    for scene in SCENES {
        let plain = hash(scene, small());
        for (name, wish) in variants {
            assert_eq!(hash(scene, wish.clone()), plain, "{scene} with {name}");
        }
    }
}

#[test]
fn threads_batches_and_tiles() {
    all_equal(&[
        ("1 thread", Overrides { threads: Some(1), ..small() }),
        ("2 threads", Overrides { threads: Some(2), ..small() }),
        ("7 threads", Overrides { threads: Some(7), ..small() }),
        ("batches of 1", Overrides { batch: Some(1), ..small() }),
        ("batches of 7", Overrides { batch: Some(7), ..small() }),
        ("batches of 1024", Overrides { batch: Some(1024), ..small() }),
        ("shuffled tiles", Overrides { shuffle_tiles: Some(42), threads: Some(7), ..small() }),
    ]);
}

#[test]
fn instruction_sets() {
    let sets = Isa::ALL.into_iter().filter(|isa| isa.is_available());
    let variants: Vec<_> = sets.map(|isa| (isa.name(), Overrides { isa: Some(isa), ..small() })).collect();
    assert!(!variants.is_empty());
    all_equal(&variants);
}

#[test]
fn structures() {
    let other: Vec<_> = Structure::ALL.into_iter().filter(|&s| s != Structure::default()).collect();
    let wish = |structure| Overrides { accel: Some(structure), ..small() };
    for &structure in &other {
        let scene = "scenes/cornell-box.yaml";
        assert_eq!(hash(scene, wish(structure)), hash(scene, small()), "{structure}");
    }
    // What tests every triangle of an object can't do a thousand teapots in a test.
    for &structure in other.iter().filter(|s| !matches!(s, Structure::Brute | Structure::Volumes(_))) {
        let tiny = |wish| Overrides { size: Some([20, 15]), spp: Some(2), ..wish };
        for scene in ["scenes/glass-and-mirror.yaml", "scenes/teapots.yaml", "scenes/shapes.yaml"] {
            assert_eq!(
                hash(scene, tiny(wish(structure))),
                hash(scene, tiny(small())),
                "{scene}: {structure}"
            );
        }
    }
}

/// Counts of tests are sums of integers: the same whatever the threads and batches, and no part of the picture.
#[test]
fn costs() {
    for scene in SCENES {
        let cost = |wish: Overrides| {
            let picture = common::render(scene, Overrides { cost: Some(true), ..wish }).picture;
            let cost = |of: &Channel| picture.layers.channel(of).map(|layer| layer.values.clone());
            assert_eq!(cost(&TIME), None, "no clock, no time");
            let counted = [&NODES, &PRIMITIVES].map(|of| cost(of).expect("costs were asked for"));
            (picture.tells("film_hash").expect("a film hash").to_owned(), counted)
        };
        let one = cost(Overrides { threads: Some(1), ..small() });
        assert!(one.0 == hash(scene, small()), "{scene}: counting changes the picture");
        assert!(one == cost(Overrides { threads: Some(7), batch: Some(7), ..small() }), "{scene}");
        assert!(one.1.iter().all(|values| values.iter().any(|n| *n > 0.0)));
    }
}

#[test]
fn a_crop_is_cut_from_the_whole() {
    for scene in SCENES {
        let whole = common::render(scene, small()).picture;
        let [x0, y0, x1, y1] = [11, 5, 34, 30];
        let crop = common::render(scene, Overrides { crop: Some([x0, y0, x1, y1]), ..small() }).picture;
        for y in y0..y1 {
            for x in x0..x1 {
                let at = |p: &Picture, x: u32, y: u32| {
                    let i = y as usize * p.layers.width + x as usize;
                    let normal = &p.layers.channel(&NORMAL).expect("all layers").values[3 * i..3 * (i + 1)];
                    (
                        p.layers.rgb[i].map(f32::to_bits),
                        normal.iter().map(|v| v.to_bits()).collect::<Vec<_>>(),
                    )
                };
                assert_eq!(at(&crop, x - x0, y - y0), at(&whole, x, y), "{scene}, pixel {x},{y}");
            }
        }
    }
}

/// What a ray stands for is carried where a texture is read, and not for the tangent of brushed metal.
#[test]
fn footprints_are_carried_where_they_are_read() {
    let wants = |scene| common::job(scene, Overrides::default()).world.wants_footprints();
    assert!(wants("tests/scenes/checker-from-afar.yaml"));
    assert!(!wants("tests/scenes/furnace-brushed-metal.yaml"));
}

/// A path's last ray looks for lights alone: where none can be met, it isn't sent.
#[test]
fn no_ray_is_sent_in_vain() {
    let rays = |scene, depth| {
        let wish = Overrides { max_depth: Some(depth), spp: Some(4), ..Overrides::default() };
        common::render(scene, wish).times.rays
    };
    let [of_points, of_sky] = ["tests/scenes/point-light.yaml", "tests/scenes/sky-over-plane.yaml"];
    assert_eq!(rays(of_points, 2), rays(of_points, 1));
    assert!(rays(of_points, 3) > rays(of_points, 2));
    assert!(rays(of_sky, 2) > rays(of_sky, 1));
}

/// By wavelengths as well, and with wavelengths that part.
#[test]
fn by_wavelengths() {
    for scene in ["scenes/embedded.yaml", "scenes/glass-and-mirror.yaml", "scenes/prism.yaml"] {
        let wish = || Overrides { spectral: Some(true), ..small() };
        let plain = hash(scene, Overrides { threads: Some(1), ..wish() });
        for (name, other) in [
            ("7 threads, batches of 7", Overrides { threads: Some(7), batch: Some(7), ..wish() }),
            ("shuffled tiles", Overrides { shuffle_tiles: Some(42), ..wish() }),
            ("scalar search", Overrides { isa: Some(Isa::Scalar), ..wish() }),
        ] {
            assert_eq!(hash(scene, other), plain, "{scene} with {name}");
        }
        assert_ne!(plain, hash(scene, Overrides { spectral: Some(false), ..small() }), "{scene}");
    }
}

#[test]
fn seeds_differ() {
    assert_ne!(hash(SCENES[0], Overrides { seed: Some(1), ..small() }), hash(SCENES[0], small()));
}
