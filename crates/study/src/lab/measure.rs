//! Building, counting and timing: one structure, the recorded rays, one thread.

use super::rays::{Kind, RaySet};
use super::same::{Agreement, Answer};
use super::{Contender, options};
use std::hint::black_box;
use straal::Clock;
use straal_accel::{BuildError, Cost, Hit, Input, Isa, Scene, Stats, Structure};
use straal_math::Ray;
use straal_render::shape::Geometry;
use straal_render::world::World;

/// Numbers by [`Kind`].
pub type ByKind<T> = [T; 3];

/// Nodes, boxes and primitives that a structure may test for the rays of a kind, for each ray that was wished for. One that
/// would need more is asked with every n-th ray only: brute force on a large scene must end.
const TESTS_PER_RAY: u64 = 150;

/// Rays that tell beforehand how many tests a ray takes.
const PILOTS: usize = 64;

/// A build that takes less than this is repeated, and the best counts: short times are noisy.
const SHORT: u64 = 200_000_000;
const BUILDS: usize = 5;

/// What all measurements share.
pub(crate) struct Bench<'a> {
    pub world: &'a World,
    pub isa: Isa,
    pub clock: &'a Clock,
    pub rays: &'a [RaySet; 3],
    /// Most rays of a kind that were wished for.
    pub wished: usize,
    /// Rays of the scene's own picture.
    pub mix: ByKind<f64>,
}

impl Bench<'_> {
    /// Tests that may be made for the rays of a kind.
    pub fn most_tests(&self) -> u64 {
        self.wished as u64 * TESTS_PER_RAY
    }

    pub fn shapes(&self) -> &Geometry {
        &self.world.geometry
    }

    /// Nanoseconds that `work` takes, and what it gives.
    pub fn timed<T>(&self, work: impl FnOnce() -> T) -> (u64, T) {
        let start = (self.clock)();
        let done = work();
        ((self.clock)().saturating_sub(start), done)
    }

    pub fn build(&self, input: &Input, structure: Structure) -> Result<Scene, BuildError> {
        Scene::build(input.clone(), self.shapes(), &options(structure, self.isa))
    }

    /// The scene, and the seconds of its fastest build.
    pub fn timed_build(&self, input: &Input, structure: Structure) -> Result<(Scene, f64), BuildError> {
        let mut best = u64::MAX;
        for _ in 1..BUILDS {
            let copy = input.clone();
            let (ns, scene) = self.timed(|| Scene::build(copy, self.shapes(), &options(structure, self.isa)));
            best = best.min(ns);
            if ns > SHORT {
                return Ok((scene?, best as f64 * 1e-9));
            }
            scene?;
        }
        let copy = input.clone();
        let (ns, scene) = self.timed(|| Scene::build(copy, self.shapes(), &options(structure, self.isa)));
        Ok((scene?, best.min(ns) as f64 * 1e-9))
    }

    /// Nanoseconds for all rays of a set, slice by slice as the renderer asks; `answers` is told what was found.
    pub fn search(&self, scene: &Scene, kind: Kind, set: &RaySet, scratch: &mut Scratch) -> u64 {
        let n = set.rays.len();
        let (ns, ()) = match kind {
            Kind::Primary | Kind::Bounce => {
                scratch.hits.clear();
                scratch.hits.resize(n, Hit::MISS);
                self.timed(|| {
                    for slice in set.slices() {
                        scene.closest(self.shapes(), &set.rays[slice.clone()], &mut scratch.hits[slice]);
                    }
                    black_box(&mut scratch.hits);
                })
            }
            Kind::Shadow => {
                scratch.blocked.clear();
                scratch.blocked.resize(n, false);
                self.timed(|| {
                    for slice in set.slices() {
                        scene.occluded(self.shapes(), &set.rays[slice.clone()], &mut scratch.blocked[slice]);
                    }
                    black_box(&mut scratch.blocked);
                })
            }
        };
        ns
    }

    /// For a mean ray of the picture: the kinds weighed by how many of each it has.
    pub fn mean(&self, values: &ByKind<f64>) -> f64 {
        let all: f64 = self.mix.iter().sum();
        let weighed: f64 = self.mix.iter().zip(values).map(|(n, v)| n * v).sum();
        if all > 0.0 { weighed / all } else { 0.0 }
    }

    /// Nanoseconds a ray of each kind takes, the best of some rounds in which the scenes take turns.
    pub fn race<const N: usize>(&self, scenes: [&Scene; N], sets: &[RaySet; 3]) -> [ByKind<f64>; N] {
        let mut best = [[u64::MAX; 3]; N];
        let mut scratch = Scratch::default();
        for _ in 0..3 {
            for (scene, best) in scenes.iter().zip(&mut best) {
                for (k, kind) in Kind::ALL.into_iter().enumerate() {
                    best[k] = best[k].min(self.search(scene, kind, &sets[k], &mut scratch));
                }
            }
        }
        best.map(|b| [0, 1, 2].map(|k| mean(b[k], sets[k].rays.len())))
    }
}

fn mean(sum: u64, n: usize) -> f64 {
    if n > 0 { sum as f64 / n as f64 } else { 0.0 }
}

/// Answers of the last search.
#[derive(Default)]
pub(crate) struct Scratch {
    pub hits: Vec<Hit>,
    pub blocked: Vec<bool>,
}

impl Scratch {
    fn answer(&self, kind: Kind, i: usize) -> Answer {
        match kind {
            Kind::Primary | Kind::Bounce => Answer::Hit(self.hits[i]),
            Kind::Shadow => Answer::Blocked(self.blocked[i]),
        }
    }
}

/// What one ray costs, and its answer.
fn counted(scene: &Scene, shapes: &Geometry, kind: Kind, ray: &Ray) -> (Answer, Cost) {
    match kind {
        Kind::Primary | Kind::Bounce => {
            let (hit, cost) = scene.closest_counted(shapes, ray);
            (Answer::Hit(hit), cost)
        }
        Kind::Shadow => {
            let (blocked, cost) = scene.occluded_counted(shapes, ray);
            (Answer::Blocked(blocked), cost)
        }
    }
}

/// Sums of the tests of many rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tests {
    /// Rays.
    pub rays: u64,
    /// Nodes opened or cells entered.
    pub nodes: u64,
    /// Boxes tested.
    pub boxes: u64,
    /// Primitives tested.
    pub primitives: u64,
    /// Tests of a primitive that a mailbox spared.
    pub duplicates: u64,
}

impl Tests {
    pub(crate) fn add(&mut self, c: &Cost) {
        self.rays += 1;
        self.nodes += u64::from(c.nodes);
        self.boxes += u64::from(c.boxes);
        self.primitives += u64::from(c.primitives);
        self.duplicates += u64::from(c.duplicates);
    }

    pub(crate) fn work(&self) -> u64 {
        self.nodes + self.boxes + self.primitives
    }
}

/// A structure on its way through the lab.
pub(crate) struct Contestant {
    contender: Contender,
    scene: Scene,
    build_seconds: f64,
    stats: Vec<Stats>,
    primitives: usize,
    tests: ByKind<Tests>,
    /// Every n-th ray is asked; 1 for all.
    strides: ByKind<usize>,
    /// The rays that are asked where they aren't all.
    few: ByKind<Option<RaySet>>,
    nanoseconds: ByKind<u64>,
    agreement: Agreement,
    rounds: u32,
    is_baseline: bool,
}

impl Bench<'_> {
    pub fn contestant(
        &self,
        input: &Input,
        contender: &Contender,
        primitives: usize,
    ) -> Result<Contestant, BuildError> {
        let (scene, build_seconds) = self.timed_build(input, contender.structure)?;
        let stats = scene.stats().into_iter().flatten().collect();
        Ok(Contestant {
            contender: contender.clone(),
            scene,
            build_seconds,
            stats,
            primitives,
            tests: [Tests::default(); 3],
            strides: [1; 3],
            few: [None, None, None],
            nanoseconds: [u64::MAX; 3],
            agreement: Agreement::default(),
            rounds: 0,
            is_baseline: contender.structure == Structure::default(),
        })
    }
}

/// The baseline's answers to all rays.
pub(crate) type Answers = ByKind<Vec<Answer>>;

impl Contestant {
    pub fn name(&self) -> &str {
        &self.contender.name
    }

    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What it finds for every ray, one at a time.
    pub fn answers(&self, bench: &Bench<'_>) -> Answers {
        [0, 1, 2].map(|k| {
            let ask = |ray| counted(&self.scene, bench.shapes(), Kind::ALL[k], ray).0;
            bench.rays[k].rays.iter().map(ask).collect()
        })
    }

    /// Counts tests with the one-ray kernel, and compares what it finds.
    pub fn count(&mut self, bench: &Bench<'_>, expected: &Answers) {
        for (k, kind) in Kind::ALL.into_iter().enumerate() {
            let set = &bench.rays[k];
            // What the others are held against is asked with all.
            let n = if self.is_baseline { 1 } else { stride(&self.scene, bench, kind) };
            self.strides[k] = n;
            self.few[k] = (n > 1).then(|| set.every(n));
            for (i, ray) in set.rays.iter().enumerate().step_by(n) {
                let (found, cost) = counted(&self.scene, bench.shapes(), kind, ray);
                self.tests[k].add(&cost);
                self.agreement.compare(kind, i, [expected[k][i], found]);
            }
        }
    }

    /// Times the search in slices; the first time, compares what it finds.
    pub fn time(&mut self, bench: &Bench<'_>, expected: &Answers) {
        let mut scratch = Scratch::default();
        for (k, kind) in Kind::ALL.into_iter().enumerate() {
            let set = self.few[k].as_ref().unwrap_or(&bench.rays[k]);
            let ns = bench.search(&self.scene, kind, set, &mut scratch);
            self.nanoseconds[k] = self.nanoseconds[k].min(ns);
            if self.rounds == 0 {
                for i in 0..set.rays.len() {
                    let ray = i * self.strides[k];
                    self.agreement.compare(kind, ray, [expected[k][ray], scratch.answer(kind, i)]);
                }
            }
        }
        self.rounds += 1;
    }
}

/// Which part of a kind's rays can be asked: 1 in so many. Told by a few rays from everywhere.
fn stride(scene: &Scene, bench: &Bench<'_>, kind: Kind) -> usize {
    let rays = &bench.rays[kind as usize].rays;
    let mut tests = Tests::default();
    for ray in rays.iter().step_by(rays.len().div_ceil(PILOTS).max(1)) {
        tests.add(&counted(scene, bench.shapes(), kind, ray).1);
        if tests.work() > bench.most_tests() / 4 {
            break;
        }
    }
    let all = mean(tests.work(), tests.rays as usize) * rays.len() as f64;
    let n = (all / bench.most_tests() as f64).ceil() as usize;
    n.clamp(1, rays.len().max(1))
}

/// When a costlier build has paid off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Payoff {
    /// It is the cheapest to build: what the others are held against.
    Cheapest,
    /// After so many pictures.
    After(u64),
    /// It searches no faster than what is cheaper to build.
    Never,
}

/// What is known of a structure.
#[derive(Clone, Debug)]
pub struct Row {
    /// As it was typed.
    pub name: String,
    /// What it is.
    pub structure: Structure,
    /// Of the structures of all groups, one thread.
    pub build_seconds: f64,
    /// Of the structures, without the meshes themselves.
    pub bytes: usize,
    /// By group: the world, and the objects that are instanced.
    pub groups: Vec<Stats>,
    /// Sums over the groups; depth and cost are those of the group with the most references.
    pub stats: Stats,
    /// Primitives in leaves for each that there is.
    pub references_per_primitive: f64,
    /// Tests, by kind.
    pub tests: ByKind<Tests>,
    /// Every n-th ray was asked; 1 for all.
    pub strides: ByKind<usize>,
    /// Nanoseconds a ray, by kind; 0 where there are none.
    pub nanoseconds: ByKind<f64>,
    /// Seconds that all rays of the scene's own picture would take.
    pub picture_seconds: f64,
    /// Millions of rays in a second, the kinds mixed as in the picture.
    pub mrays_per_second: f64,
    /// After how many pictures its build has paid off against the cheapest.
    pub payoff: Payoff,
    /// Whether it found what the baseline did.
    pub agreement: Agreement,
}

impl Row {
    /// Millions of rays of a kind in a second; 0 when there were none.
    pub fn mrays(&self, kind: Kind) -> f64 {
        let ns = self.nanoseconds[kind as usize];
        if ns > 0.0 { 1e3 / ns } else { 0.0 }
    }

    /// Tests of a mean ray of the picture: each kind by how many of it there are.
    pub fn mean_tests(&self, mix: &ByKind<f64>, of: impl Fn(&Tests) -> u64) -> f64 {
        let all: f64 = mix.iter().sum();
        let weighed = |(n, t): (&f64, &Tests)| n * mean(of(t), t.rays as usize);
        if all > 0.0 { mix.iter().zip(&self.tests).map(weighed).sum::<f64>() / all } else { 0.0 }
    }

    /// Rays that were asked, of all kinds.
    pub fn rays(&self) -> u64 {
        self.tests.iter().map(|t| t.rays).sum()
    }
}

/// The rows of a table, the payoffs worked out.
pub(crate) fn rows(contestants: Vec<Contestant>, mix: &ByKind<f64>) -> Vec<Row> {
    let mut rows: Vec<Row> = contestants.into_iter().map(|c| row(c, mix)).collect();
    let costs: Vec<Costs> = rows.iter().map(Costs::of).collect();
    for (i, row) in rows.iter_mut().enumerate() {
        row.payoff = payoff(&costs, i);
    }
    rows
}

fn row(c: Contestant, mix: &ByKind<f64>) -> Row {
    let rays = |k: usize| c.tests[k].rays as usize;
    let measured = |k: usize| if c.rounds > 0 { mean(c.nanoseconds[k], rays(k)) } else { 0.0 };
    let nanoseconds = [0, 1, 2].map(measured);
    let all: f64 = mix.iter().sum();
    let picture_seconds = mix.iter().zip(nanoseconds).map(|(n, ns)| n * ns * 1e-9).sum();
    let largest = c.stats.iter().copied().max_by_key(|s| s.references).unwrap_or_default();
    let sum = |of: fn(&Stats) -> usize| c.stats.iter().map(of).sum::<usize>();
    let references = sum(|s| s.references);
    Row {
        name: c.contender.name,
        structure: c.contender.structure,
        build_seconds: c.build_seconds,
        bytes: c.scene.memory_bytes(),
        stats: Stats { nodes: sum(|s| s.nodes), leaves: sum(|s| s.leaves), references, ..largest },
        groups: c.stats,
        references_per_primitive: mean(references as u64, c.primitives),
        tests: c.tests,
        strides: c.strides,
        nanoseconds,
        picture_seconds,
        mrays_per_second: if picture_seconds > 0.0 { all / picture_seconds * 1e-6 } else { 0.0 },
        payoff: Payoff::Cheapest,
        agreement: c.agreement,
    }
}

/// What a structure costs: once, and for each picture.
#[derive(Clone, Copy)]
struct Costs {
    /// Brute force has nothing to build, and is no yardstick for builds.
    is_built: bool,
    build: f64,
    picture: f64,
}

impl Costs {
    fn of(row: &Row) -> Self {
        let is_built = row.structure != Structure::Brute;
        Self { is_built, build: row.build_seconds, picture: row.picture_seconds }
    }
}

fn payoff(costs: &[Costs], i: usize) -> Payoff {
    let built = costs.iter().enumerate().filter(|(_, c)| c.is_built);
    let cheapest = built.min_by(|a, b| a.1.build.total_cmp(&b.1.build)).map(|(k, _)| k);
    let Some(cheapest) = cheapest.filter(|&k| k != i) else { return Payoff::Cheapest };
    let (own, other) = (costs[i], costs[cheapest]);
    let gain = other.picture - own.picture;
    if gain <= 0.0 {
        return Payoff::Never;
    }
    let dearer = own.build - other.build;
    Payoff::After(if dearer > 0.0 { (dearer / gain).ceil() as u64 } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dearer_build_pays_off_when_its_searches_have_gained_it() {
        let cost = |build, picture| Costs { is_built: true, build, picture };
        let brute = Costs { is_built: false, build: 0.0, picture: 100.0 };
        let all = [cost(1.0, 2.0), cost(3.5, 1.0), cost(2.0, 2.5), brute];
        let told: Vec<Payoff> = (0..4).map(|i| payoff(&all, i)).collect();
        assert_eq!(told, [Payoff::Cheapest, Payoff::After(3), Payoff::Never, Payoff::Never]);
        assert_eq!(payoff(&[brute], 0), Payoff::Cheapest);
    }
}
