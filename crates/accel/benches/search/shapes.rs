//! Shapes that are formulas, tested many at a time, against the same shapes asked one by one.

use super::{
    common::{Formulas, Random, formula, world},
    duel, median,
};
use straal_accel::{
    Analytic, Flight, Geometry, GeometryKind, Group, Hit, Input, Instance, Isa, Options, Patch, Scene,
    ShapeHit, Shapes,
};
use straal_math::{Affine, Bounds, DVec3, Ray, Transform, Vec3};

/// Shapes whose formulas are kept from the search.
struct Kept<'a>(&'a Formulas);

impl Shapes for Kept<'_> {
    fn bounds(&self, shape: u32) -> Option<Bounds> {
        self.0.bounds(shape)
    }

    fn intersect(&self, shape: u32, ray: &Ray) -> Option<ShapeHit> {
        self.0.intersect(shape, ray)
    }
}

/// A room of six rectangles with two balls, as in textbooks.
fn room() -> Formulas {
    let mut all = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let unit = |i: usize| DVec3::from_array(std::array::from_fn(|j| f64::from(u8::from(i % 3 == j))));
            let (n, a, b) = (unit(axis) * side, unit(axis + 1), unit(axis + 2));
            let patch = Patch { origin: n - a - b, normal: n, dual: [a * 0.5, b * 0.5] };
            let (p, q) = ((n - a - b).as_vec3(), (n + a + b).as_vec3());
            all.push((Some(Bounds { min: p.min(q), max: p.max(q) }), Analytic::parallelogram(&patch)));
        }
    }
    for (x, y, z, r) in [(0.42, -0.65, 0.3, 0.35), (-0.42, -0.6, -0.25, 0.4)] {
        let c = Vec3::new(x, y, z);
        let bounds = Bounds { min: c - Vec3::splat(r), max: c + Vec3::splat(r) };
        all.push((Some(bounds), Analytic::sphere(c.as_dvec3(), f64::from(r))));
    }
    Formulas(all)
}

/// Many balls, or shapes of all bounded kinds.
fn field(count: usize, mixed: bool) -> Formulas {
    let mut r = Random(1);
    let mut all = Vec::new();
    while all.len() < count {
        let i = if mixed { all.len() % 5 } else { 0 };
        all.push(formula(&mut r, i, 0.03));
    }
    Formulas(all)
}

/// Rays from inside in all directions.
fn rays(n: usize) -> Vec<Ray> {
    let mut r = Random(2);
    (0..n).map(|_| Ray::new(r.point() * 0.9, r.direction())).collect()
}

fn run(name: &str, input: Input, formulas: &Formulas, isa: Isa, rounds: usize) {
    let kept = Kept(formulas);
    let options = Options { isa, flight: Flight::Many, ..Options::default() };
    let many = Scene::build(input.clone(), formulas, &options).expect("sound shapes");
    let alone = Scene::build(input, &kept, &options).expect("sound shapes");
    let rays = rays(1 << 16);
    let mut hits = [vec![Hit::MISS; rays.len()], vec![Hit::MISS; rays.len()]];
    let mut blocked = [vec![false; rays.len()], vec![false; rays.len()]];
    let closest = |scene: &Scene, shapes: &dyn Shapes, hits: &mut [Hit]| {
        rays.chunks(1024).zip(hits.chunks_mut(1024)).for_each(|(r, h)| scene.closest(shapes, r, h));
    };
    let occluded = |scene: &Scene, shapes: &dyn Shapes, blocked: &mut [bool]| {
        rays.chunks(1024).zip(blocked.chunks_mut(1024)).for_each(|(r, b)| scene.occluded(shapes, r, b));
    };
    {
        let ([a, b], [c, d]) = (&mut hits, &mut blocked);
        let times = duel(
            rounds,
            &mut [
                ("one by one", Box::new(|| closest(&alone, &kept, a))),
                ("many", Box::new(|| closest(&many, formulas, b))),
                ("one by one, any", Box::new(|| occluded(&alone, &kept, c))),
                ("many, any", Box::new(|| occluded(&many, formulas, d))),
            ],
        );
        for (what, i) in [("closest", 0), ("any", 2)] {
            let ns = |t: &[f64]| median(t.to_vec()) / rays.len() as f64 * 1e9;
            let ratio = median(times[i].iter().zip(&times[i + 1]).map(|(a, b)| a / b).collect());
            let (one, many) = (ns(&times[i]), ns(&times[i + 1]));
            println!("  {name:24} {what:7}  one by one {one:6.1} ns  many {many:6.1} ns  ({ratio:.2} x)");
        }
    }
    assert!(hits[0] == hits[1] && blocked[0] == blocked[1], "the same hits");
}

/// All of them.
pub fn all(isa: Isa, rounds: usize) {
    println!("\nshapes");
    let scene = |f: &Formulas| {
        let kind = GeometryKind::Shapes { first: 0, count: f.0.len() as u32 };
        world(vec![Geometry { kind, mask: u32::MAX }])
    };
    for (name, f) in [
        ("room of 8", room()),
        ("field of 3000 balls", field(3000, false)),
        ("field of 3000 of all kinds", field(3000, true)),
    ] {
        run(name, scene(&f), &f, isa, rounds);
    }
    // Ten fields in a row, each an instance.
    let f = field(1000, false);
    let mut input = scene(&f);
    let inner = std::mem::take(&mut input.groups[0]);
    let instances = (0..10).map(|i| {
        let m =
            Affine::scale(DVec3::splat(0.5)).then(&Affine::translate(DVec3::X * (0.1 * f64::from(i) - 0.5)));
        Instance {
            group: 1,
            transform: Transform::new(&m).expect("a sound map"),
            motion: None,
            mask: u32::MAX,
        }
    });
    let outer = Group { geometries: vec![], instances: instances.collect() };
    input.groups = vec![outer, inner];
    run("ten instances of 1000", input, &f, isa, rounds);
}
