//! Rays per CPU second, on one thread, beside Embree where it is installed: `cargo bench -p straal-accel`.
//!
//! Words behind `--` choose: names of meshes (`bunny`, `sphere`, `room`), of ray sets, and of parts (`search`; `build`;
//! `trees`, what each build's tree costs a ray; `classics`, every structure on the bunny; `counting`, what counting
//! tests costs; `scale`, up to ten million triangles; `shapes`, those that are formulas); `isa=avx2` an instruction set; `rounds=9` how often each is timed. The library of Embree 4 is looked for on the system and in the
//! Python package `embreex` (`pip install embreex`), or `EMBREE_LIB` names it.
//!
//! Contestants take turns within a round, and a ratio is the median over the rounds of the ratios within each, so that
//! what else the machine does weighs on all alike.
#![allow(clippy::print_stdout, clippy::disallowed_methods)] // a program that prints, and whose rays reach no pixel

#[path = "../../tests/all/common/mod.rs"]
mod common;
mod embree;
mod rays;
mod scenes;
mod shapes;

use common::world;
use embree::{Embree, Quality};
use scenes::Mesh;
use straal_accel::{
    Build, BvhParams, Flight, Geometry, GeometryKind, Hit, Input, Isa, Options, Scene, Structure,
};
use straal_math::Ray;

/// What was asked for.
struct Plan {
    words: Vec<String>,
    isa: Isa,
    rounds: usize,
}

impl Plan {
    fn new() -> Self {
        let mut plan = Self { words: Vec::new(), isa: Isa::detect(), rounds: 5 };
        for word in std::env::args().skip(1).filter(|w| !w.starts_with("--")) {
            match word.split_once('=') {
                Some(("isa", isa)) => plan.isa = isa.parse().expect("an instruction set"),
                Some(("rounds", n)) => plan.rounds = n.parse().expect("a number"),
                _ => plan.words.push(word),
            }
        }
        plan
    }

    /// Whether one of a kind's names is wanted: all are when none of that kind was named.
    fn wants(&self, kind: &[&str], name: &str) -> bool {
        let named: Vec<&String> = self.words.iter().filter(|w| kind.contains(&w.as_str())).collect();
        named.is_empty() || named.iter().any(|w| *w == name)
    }
}

const MESHES: [&str; 3] = ["bunny", "sphere", "room"];
const SETS: [&str; 7] = ["primary", "bounce", "shuffled", "second", "shadow", "segments", "misses"];
const PARTS: [&str; 7] = ["search", "build", "trees", "classics", "counting", "scale", "shapes"];

fn main() {
    let plan = Plan::new();
    let embree = match Embree::open() {
        Ok(e) => {
            println!("Embree: {}", e.path.display());
            Some(e)
        }
        Err(e) => {
            println!("without Embree ({e}): pip install embreex, or name its library in EMBREE_LIB");
            None
        }
    };
    println!("straal: {}", plan.isa);
    for name in MESHES.into_iter().filter(|name| plan.wants(&MESHES, name)) {
        let mesh = match name {
            "bunny" => scenes::bunny(),
            "room" => Some(scenes::room()),
            _ => Some(scenes::sphere("sphere", 8)),
        };
        let Some(mesh) = mesh else {
            println!("\n{name}: skipped: no shared data");
            continue;
        };
        println!("\n{name}: {} triangles", mesh.indices.len());
        if plan.wants(&PARTS, "search") {
            search(&plan, &mesh, embree.as_ref());
        }
        if plan.wants(&PARTS, "build") {
            build(&plan, &mesh, embree.as_ref());
        }
        if plan.wants(&PARTS, "trees") {
            trees(&plan, &mesh);
        }
        if plan.wants(&PARTS, "counting") {
            counting(&plan, &mesh);
        }
    }
    if plan.wants(&PARTS, "shapes") {
        shapes::all(plan.isa, plan.rounds);
    }
    if plan.wants(&PARTS, "classics")
        && let Some(mesh) = scenes::bunny()
    {
        classics(&plan, &mesh);
    }
    if plan.wants(&PARTS, "scale") {
        scale(&plan, embree.as_ref());
    }
}

fn input(mesh: &Mesh) -> Input {
    let kind = GeometryKind::Triangles {
        positions: mesh.positions.clone().into(),
        indices: mesh.indices.clone().into(),
    };
    world(vec![Geometry { kind, mask: u32::MAX }])
}

/// A contestant's name and what it does with all rays of a set.
type Contestant<'a> = (&'static str, Box<dyn FnMut() + 'a>);

fn search(plan: &Plan, mesh: &Mesh, embree: Option<&Embree>) {
    let options = |flight| Options { isa: plan.isa, flight, ..Options::default() };
    let one = Scene::build(input(mesh), &(), &options(Flight::One)).expect("a sound mesh");
    let many = Scene::build(input(mesh), &(), &options(Flight::Many)).expect("a sound mesh");
    let peer = embree.map(|e| e.build(&mesh.positions, &mesh.indices, Quality::Medium, thread_seconds));
    for set in rays::sets(&one, mesh).iter().filter(|s| plan.wants(&SETS, s.name)) {
        let rays = set.rays.as_slice();
        let (mut hits, mut blocked) = (vec![(0, 0.0); rays.len()], vec![false; rays.len()]);
        let (mut hits2, mut blocked2) = (hits.clone(), blocked.clone());
        let (mut peer_hits, mut peer_blocked) = (hits.clone(), blocked.clone());
        let mut packet_hits = peer_hits.clone();
        let mut contestants: Vec<Contestant<'_>> = Vec::new();
        if let Some(peer) = &peer {
            contestants.push(match set.any {
                true => ("embree", Box::new(|| peer.occluded(rays, &mut peer_blocked))),
                false => ("embree", Box::new(|| peer.closest(rays, &mut peer_hits))),
            });
        }
        contestants.push(("single", Box::new(|| trace(&one, set.any, rays, 1, &mut hits, &mut blocked))));
        contestants
            .push(("batches", Box::new(|| trace(&many, set.any, rays, 1024, &mut hits2, &mut blocked2))));
        if let (Some(peer), "primary") = (&peer, set.name) {
            contestants.push(("embree8", Box::new(|| peer.closest8(rays, &mut packet_hits))));
        }
        let times = duel(plan.rounds, &mut contestants);
        let names: Vec<&str> = contestants.iter().map(|c| c.0).collect();
        drop(contestants);
        print!("  {:9}", set.name);
        for (name, t) in names.iter().zip(&times) {
            let rate = rays.len() as f64 / median(t.clone()) * 1e-6;
            let ratio = median(times[0].iter().zip(t).map(|(a, b)| a / b).collect());
            print!("  {name} {rate:6.2} ({ratio:.2} x)");
        }
        let [nodes, blocks] = steps(&one, set);
        print!("  {nodes:.1} nodes, {blocks:.1} blocks a ray");
        if peer.is_some() {
            let differ = match set.any {
                true => blocked.iter().zip(&peer_blocked).filter(|(a, b)| a != b).count(),
                false => hits.iter().zip(&peer_hits).filter(|(a, b)| a.0 != b.0).count(),
            };
            print!(", {differ} of {} unlike Embree's", rays.len());
        }
        println!();
    }
}

/// Searches in slices of `batch` rays, and keeps of each hit what is kept of Embree's: the triangle and the ray parameter.
fn trace(
    scene: &Scene,
    any: bool,
    rays: &[Ray],
    batch: usize,
    hits: &mut [(u32, f32)],
    blocked: &mut [bool],
) {
    if any {
        for (r, b) in rays.chunks(batch).zip(blocked.chunks_mut(batch)) {
            scene.occluded(&(), r, b);
        }
        return;
    }
    let mut found = vec![Hit::MISS; batch];
    for (r, kept) in rays.chunks(batch).zip(hits.chunks_mut(batch)) {
        let found = &mut found[..r.len()];
        scene.closest(&(), r, found);
        for (kept, hit) in kept.iter_mut().zip(found) {
            *kept = (hit.primitive, hit.t);
        }
    }
}

/// CPU seconds of each contestant in each round.
fn duel(rounds: usize, contestants: &mut [Contestant<'_>]) -> Vec<Vec<f64>> {
    let mut times = vec![Vec::new(); contestants.len()];
    for round in 0..=rounds {
        for ((_, run), times) in contestants.iter_mut().zip(&mut times) {
            let start = thread_seconds();
            run();
            if round > 0 {
                times.push(thread_seconds() - start);
            }
        }
    }
    times
}

fn build(plan: &Plan, mesh: &Mesh, embree: Option<&Embree>) {
    let pool = one_thread();
    let triangles = mesh.indices.len() as f64;
    let mut rows: Vec<(String, Vec<f64>, f64)> = Vec::new();
    let mut add = |name: String, seconds: f64, bytes: f64| match rows.iter_mut().find(|r| r.0 == name) {
        Some(row) => row.1.push(seconds),
        None => rows.push((name, vec![seconds], bytes / triangles)),
    };
    let peers = [Quality::Low, Quality::Medium, Quality::High];
    let ours = [
        ("fast", Build::Fast, false),
        ("default", Build::Default, false),
        ("best", Build::Best, false),
        ("compact", Build::Default, true),
    ];
    // In turns: what is built right after one's own kind finds its memory already there.
    for _ in 0..plan.rounds {
        for (i, (name, build, compact)) in ours.into_iter().enumerate() {
            if let (Some(e), Some(&quality)) = (embree, peers.get(i)) {
                let scene = e.build(&mesh.positions, &mesh.indices, quality, thread_seconds);
                let name = ["embree low", "embree medium", "embree high"][i];
                add(name.to_owned(), scene.seconds, scene.bytes() as f64);
            }
            let input = input(mesh);
            let structure = Structure::Bvh(BvhParams { build, compact });
            let options = Options { structure, isa: plan.isa, ..Options::default() };
            let (scene, seconds) = build_alone(&pool, input, &options);
            add(format!("straal {name}"), seconds, scene.memory_bytes() as f64);
        }
    }
    for (name, seconds, bytes) in rows {
        println!("  build {name:14} {:.3} CPU s, {bytes:.1} bytes a triangle", median(seconds));
    }
}

fn one_thread() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread")
}

/// Builds with a pool of one thread; the scene and CPU seconds.
fn build_alone(pool: &rayon::ThreadPool, input: Input, options: &Options) -> (Scene, f64) {
    pool.install(|| {
        let start = thread_seconds();
        let scene = Scene::build(input, &(), options).expect("a sound mesh");
        (scene, thread_seconds() - start)
    })
}

/// What each build's tree costs a ray, and how fast it is beside the default.
fn trees(plan: &Plan, mesh: &Mesh) {
    let scenes: Vec<(&str, Scene)> =
        [("default", Build::Default), ("fast", Build::Fast), ("best", Build::Best)]
            .into_iter()
            .map(|(name, build)| {
                let structure = Structure::Bvh(BvhParams { build, compact: false });
                let options = Options { structure, isa: plan.isa, ..Options::default() };
                (name, Scene::build(input(mesh), &(), &options).expect("a sound mesh"))
            })
            .collect();
    for (name, scene) in &scenes {
        let s = scene.stats()[0].expect("the world");
        let n = mesh.indices.len() as f64;
        println!(
            "  tree {name:9} cost {:.1}, {:.3} references and {:.1} bytes a triangle, {} deep",
            s.sah_cost,
            s.references as f64 / n,
            scene.memory_bytes() as f64 / n,
            s.depth
        );
    }
    for set in rays::sets(&scenes[0].1, mesh).iter().filter(|s| plan.wants(&SETS, s.name)) {
        let rays = set.rays.as_slice();
        let mut contestants: Vec<Contestant<'_>> = Vec::new();
        for (name, scene) in &scenes {
            let (mut hits, mut blocked) = (vec![(0, 0.0); rays.len()], vec![false; rays.len()]);
            let run = move || trace(scene, set.any, rays, 1024, &mut hits, &mut blocked);
            contestants.push((name, Box::new(run)));
        }
        let times = duel(plan.rounds, &mut contestants);
        print!("  {:9}", set.name);
        for ((name, scene), t) in scenes.iter().zip(&times) {
            let rate = rays.len() as f64 / median(t.clone()) * 1e-6;
            let ratio = median(times[0].iter().zip(t).map(|(a, b)| a / b).collect());
            let [nodes, blocks] = steps(scene, set);
            print!("  {name} {rate:.2} ({ratio:.2} x; {nodes:.1} nodes, {blocks:.1} blocks)");
        }
        println!();
    }
}

/// Nodes and blocks a ray: of every 16th ray.
fn steps(scene: &Scene, set: &rays::Set) -> [f64; 2] {
    let (mut nodes, mut blocks, mut n) = (0, 0, 0);
    for ray in set.rays.iter().step_by(16) {
        let (_, c) = match set.any {
            true => (Hit::MISS, scene.occluded_counted(&(), ray).1),
            false => scene.closest_counted(&(), ray),
        };
        (nodes, blocks, n) = (nodes + u64::from(c.nodes), blocks + u64::from(c.blocks), n + 1);
    }
    [nodes, blocks].map(|x| x as f64 / f64::from(n))
}

/// Bounces on one sphere in ten thousand to ten million triangles, of pictures of two sizes: where rays are few, each meets
/// triangles of its own, which come from memory; in a picture of some million pixels neighbours share them.
fn scale(plan: &Plan, embree: Option<&Embree>) {
    for side in [512, 2048] {
        println!(
            "\nscale: bounces of {side} x {side} pixels, and the rate times log2 n beside that of the fewest triangles"
        );
        scale_of(plan, embree, side);
    }
}

/// All sizes take turns, so that a phase in which the machine is slow can't be taken for what a size costs.
fn scale_of(plan: &Plan, embree: Option<&Embree>, side: usize) {
    let sizes: Vec<Size<'_>> = (4..=9).map(|levels| Size::new(plan, levels, embree, side)).collect();
    let (mut hits, mut peer_hits) = (Vec::new(), Vec::new());
    for size in &sizes {
        hits.push(vec![(0, 0.0); size.rays.len()]);
        peer_hits.push(vec![(0, 0.0); size.rays.len()]);
    }
    let mut contestants: Vec<Contestant<'_>> = Vec::new();
    for ((size, hits), peer_hits) in sizes.iter().zip(&mut hits).zip(&mut peer_hits) {
        contestants.push(("straal", Box::new(|| trace(&size.scene, false, &size.rays, 1024, hits, &mut []))));
        if let Some(peer) = &size.peer {
            contestants.push(("embree", Box::new(|| peer.closest(&size.rays, peer_hits))));
        }
    }
    let times = duel(plan.rounds, &mut contestants);
    let each = contestants.len() / sizes.len();
    for (i, size) in sizes.iter().enumerate() {
        print!("  {:8} triangles", size.triangles);
        for c in 0..each {
            let (name, t, first) = (contestants[c].0, &times[i * each + c], &times[c]);
            let log = |size: &Size<'_>| (size.triangles as f64).log2() * size.rays.len() as f64;
            let ratios = first.iter().zip(t).map(|(a, b)| a / b * log(size) / log(&sizes[0])).collect();
            let rate = size.rays.len() as f64 / median(t.clone()) * 1e-6;
            print!("  {name} {rate:6.2} Mrays/s ({:.2} x)", median(ratios));
        }
        println!("  {:.1} nodes, {:.1} blocks a ray", size.steps[0], size.steps[1]);
    }
}

/// A sphere of one size, and the bounces on it.
struct Size<'e> {
    triangles: usize,
    scene: Scene,
    peer: Option<embree::Scene<'e>>,
    rays: Vec<Ray>,
    steps: [f64; 2],
}

impl<'e> Size<'e> {
    fn new(plan: &Plan, levels: u32, embree: Option<&'e Embree>, side: usize) -> Self {
        let mesh = scenes::sphere("sphere", levels).halved();
        let options = Options { isa: plan.isa, ..Options::default() };
        let scene = Scene::build(input(&mesh), &(), &options).expect("a sound mesh");
        let peer = embree.map(|e| e.build(&mesh.positions, &mesh.indices, Quality::Medium, thread_seconds));
        let bounces = rays::Set { name: "bounce", any: false, rays: rays::bounces(&scene, &mesh, side) };
        let steps = steps(&scene, &bounces);
        Self { triangles: mesh.indices.len(), scene, peer, rays: bounces.rays, steps }
    }
}

/// Every structure with its default parameters, one ray at a time.
fn classics(plan: &Plan, mesh: &Mesh) {
    println!("\nclassics: {} triangles, bounces one by one", mesh.indices.len());
    let fast = Scene::build(input(mesh), &(), &Options::default()).expect("a sound mesh");
    let sets = rays::sets(&fast, mesh);
    let pool = one_thread();
    for structure in Structure::ALL {
        let options = Options { structure, isa: plan.isa, flight: Flight::One };
        let (scene, seconds) = build_alone(&pool, input(mesh), &options);
        // Those that test everything would take minutes.
        let tests_all = matches!(structure, Structure::Brute | Structure::Volumes(_));
        let stride = if tests_all { 1024 } else { 4 };
        let rays: Vec<Ray> = sets[1].rays.iter().step_by(stride).copied().collect();
        let mut hits = vec![(0, 0.0); rays.len()];
        let mut contestants: Vec<Contestant<'_>> =
            vec![("", Box::new(|| trace(&scene, false, &rays, 1, &mut hits, &mut [])))];
        let rate = rays.len() as f64 / median(duel(plan.rounds, &mut contestants).remove(0)) * 1e-6;
        let costs = rays.iter().map(|r| scene.closest_counted(&(), r).1);
        let (nodes, prims) =
            costs.fold((0, 0), |(n, p), c| (n + u64::from(c.nodes), p + u64::from(c.primitives)));
        let each = |x: u64| x as f64 / rays.len() as f64;
        println!(
            "  {structure:8} {rate:8.4} Mrays/s, {:.1} nodes and {:.1} primitives a ray, build {seconds:.3} CPU s, {:.1} bytes a triangle",
            each(nodes),
            each(prims),
            scene.memory_bytes() as f64 / mesh.indices.len() as f64
        );
    }
}

/// The search that doesn't count, beside itself (what the clock is off by) and beside the one that counts.
fn counting(plan: &Plan, mesh: &Mesh) {
    let options = Options { isa: plan.isa, flight: Flight::One, ..Options::default() };
    let scene = Scene::build(input(mesh), &(), &options).expect("a sound mesh");
    for set in rays::sets(&scene, mesh).iter().filter(|s| s.name == "bounce" || s.name == "shadow") {
        let rays = set.rays.as_slice();
        let scene = &scene;
        let plain = || {
            let (mut hits, mut blocked) = (vec![(0, 0.0); rays.len()], vec![false; rays.len()]);
            move || trace(scene, set.any, rays, 1, &mut hits, &mut blocked)
        };
        let (first, again) = (plain(), plain());
        let counted = || {
            for ray in rays {
                match set.any {
                    true => _ = std::hint::black_box(scene.occluded_counted(&(), ray)),
                    false => _ = std::hint::black_box(scene.closest_counted(&(), ray)),
                }
            }
        };
        let mut contestants: Vec<Contestant<'_>> =
            vec![("off", Box::new(first)), ("off again", Box::new(again)), ("counting", Box::new(counted))];
        let times = duel(plan.rounds, &mut contestants);
        print!("  counting {:7}", set.name);
        for ((name, _), t) in contestants.iter().zip(&times) {
            let ratio = median(times[0].iter().zip(t).map(|(a, b)| a / b).collect());
            print!("  {name} {:.2} ({ratio:.2} x)", rays.len() as f64 / median(t.clone()) * 1e-6);
        }
        println!();
    }
}

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

/// CPU time of this thread, on which all that is timed happens. That of the whole process would count an idle worker of
/// Embree's as well, which goes on asking for work long after a tree is built.
#[allow(unsafe_code)]
fn thread_seconds() -> f64 {
    #[repr(C)]
    struct Timespec {
        seconds: i64,
        nanoseconds: i64,
    }
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut Timespec) -> i32;
    }
    /// `CLOCK_THREAD_CPUTIME_ID` of Linux.
    const THREAD: i32 = 3;
    let mut time = Timespec { seconds: 0, nanoseconds: 0 };
    // SAFETY: the C library of every Unix has the function; it writes one `timespec`.
    unsafe { clock_gettime(THREAD, &raw mut time) };
    time.seconds as f64 + time.nanoseconds as f64 * 1e-9
}
