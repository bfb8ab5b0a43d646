//! The lab: which search structure is best for this scene, and why?
//!
//! The rays of a real render are recorded once and replayed through every structure. All numbers are of one thread, and
//! of the same rays in the slices in which the renderer asks for them. The library reads no clock: the caller lends one.
//!
//! ```no_run
//! # let clock: straal::Clock = std::sync::Arc::new(|| 0);
//! let loaded = straal::load("scene.yaml".as_ref(), &straal::LoadOptions::default())?;
//! let report = straal_study::lab::run(&loaded, &straal_study::lab::Request::default(), &clock, &mut |_| ())?;
//! println!("{}", straal_study::lab::text::table(&report));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod base64;
pub mod json;
mod measure;
pub mod moving;
pub mod page;
pub mod pictures;
mod rays;
mod same;
pub mod table;
pub mod text;
pub mod volumes;

pub use measure::{ByKind, Payoff, Row, Tests};
pub use rays::{Kind, RaySet};
pub use same::{Agreement, Answer, Difference};

use measure::Bench;
use moving::Moving;
use pictures::CostPictures;
use rays::Sampling;
use std::path::PathBuf;
use straal::{Clock, Job, Loaded, Overrides, search};
use straal_accel::{BuildError, Input, Isa, Options, Scene, Structure};
use straal_render::compile::Custom;
use straal_render::world::World;
use straal_scene::desc::Node;
use straal_scene::suggest;
use volumes::Volumes;

/// What the lab is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What is compared with the baseline, the wide BVH; `None` for one of each kind.
    pub structures: Option<Vec<Contender>>,
    /// Size of the picture whose rays are recorded; `None` for one with about as many pixels as `rays`.
    pub size: Option<[u32; 2]>,
    /// Its samples per pixel.
    pub spp: u32,
    /// Most rays of each kind.
    pub rays: usize,
    /// How often every structure is timed, taking turns; the best time counts.
    pub rounds: u32,
    /// The object at the top of the world that moves; `None` for the one with the most primitives.
    pub moving: Option<String>,
    /// Whether cost pictures are made.
    pub pictures: bool,
    /// Instruction set of the search; the best there is when absent.
    pub isa: Option<Isa>,
    /// Bytes of memory that may be used; no limit when absent.
    pub memory: Option<u64>,
}

impl Default for Request {
    fn default() -> Self {
        Self {
            structures: None,
            size: None,
            spp: 1,
            rays: 1 << 16,
            rounds: 5,
            moving: None,
            pictures: false,
            isa: None,
            memory: None,
        }
    }
}

/// A structure that is compared, and what it is called in reports.
#[derive(Clone, Debug, PartialEq)]
pub struct Contender {
    /// As it was typed.
    pub name: String,
    /// What it is.
    pub structure: Structure,
}

impl Contender {
    fn of_kind(structure: Structure) -> Self {
        Self { name: structure.name().to_owned(), structure }
    }
}

/// What the lab found.
#[derive(Clone, Debug)]
pub struct Report {
    /// Size of the picture whose rays were recorded.
    pub recorded_size: [u32; 2],
    /// Its samples per pixel.
    pub recorded_spp: u32,
    /// Rays that were replayed, by [`Kind`].
    pub rays: [usize; 3],
    /// Rays that a sample has on average, by [`Kind`].
    pub rays_per_sample: [f64; 3],
    /// Size of the scene's own picture.
    pub picture_size: [u32; 2],
    /// Its samples per pixel.
    pub picture_spp: u32,
    /// Triangles, shapes and instances that can be hit, those of an instanced object once.
    pub primitives: usize,
    /// Instruction set of the search.
    pub isa: Isa,
    /// The baseline first.
    pub rows: Vec<Row>,
    /// What was left out, and why.
    pub left_out: Vec<String>,
    /// The bounding-volume inequality, object by object.
    pub volumes: Volumes,
    /// One tree or two, when an object moves; or why that can't be told.
    pub moving: Result<Moving, String>,
    /// Where rays of each pixel are expensive, by row; empty unless asked for.
    pub pictures: Option<CostPictures>,
}

impl Report {
    /// Whether every structure gave every hit of the baseline.
    pub fn hits_equal(&self) -> bool {
        self.rows.iter().all(|row| row.agreement.is_whole())
    }

    /// Rays of the scene's own picture, by [`Kind`].
    pub fn picture_rays(&self) -> [f64; 3] {
        let [w, h] = self.picture_size.map(f64::from);
        self.rays_per_sample.map(|n| n * w * h * f64::from(self.picture_spp))
    }
}

/// Why the lab can't do its work.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene can't be rendered.
    #[error(transparent)]
    Job(#[from] straal::Error),
    /// A structure can't be built.
    #[error("can't build the structure {name}: {error}")]
    Build {
        /// Of the structure.
        name: String,
        /// Why.
        error: BuildError,
    },
    /// A name in a list of structures that stands for none.
    #[error("{0}")]
    Structures(String),
    /// No object at the top of the world is called so.
    #[error("{message}")]
    NoSuchObject {
        /// What is wrong.
        message: String,
        /// What would be right.
        help: String,
    },
    /// The operating system gave no thread.
    #[error("can't start a thread: {0}")]
    Thread(#[from] rayon::ThreadPoolBuildError),
}

/// Brute force is left out, unless it is asked for, of scenes with more primitives than this.
const MOST_FOR_BRUTE: usize = 200_000;

/// Compares structures on the rays of a scene. `say` is told what is being done.
pub fn run(
    loaded: &Loaded,
    request: &Request,
    clock: &Clock,
    say: &mut (dyn FnMut(&str) + Send),
) -> Result<Report, Error> {
    // Builds use the threads of the pool that they run in.
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| compare(loaded, request, clock, say))
}

fn compare(
    loaded: &Loaded,
    request: &Request,
    clock: &Clock,
    say: &mut (dyn FnMut(&str) + Send),
) -> Result<Report, Error> {
    let film = loaded.scene.film.size;
    let size = request.size.unwrap_or_else(|| fitted(film, request.rays));
    let wish = Overrides {
        size: Some(size),
        spp: Some(request.spp),
        accel: Some(Structure::default()),
        isa: request.isa,
        memory: request.memory,
        threads: Some(1),
        cost: Some(false),
        ..Overrides::default()
    };
    let job = Job::of(loaded, &wish, &Custom::default())?;
    for dropped in &job.world.dropped {
        say(&format!("warning: {}", dropped.message));
    }
    let input = job.world.accel.input();
    let objects = objects(loaded.scene.top_level(), &job.world, &input);
    // A wrong name is told before anything takes its time.
    let moving = moving::choose(&objects, request.moving.as_deref())?;

    say("recording rays");
    let sampling = Sampling { spp: request.spp, rays: request.rays };
    let rays = rays::record(&job.world, job.path_tracer(), job.settings.clone(), sampling)?;
    let picture_spp = loaded.scene.sampler.spp;
    let pixels = f64::from(film[0]) * f64::from(film[1]);
    let mix = [0, 1, 2].map(|k| rays[k].per_sample * pixels * f64::from(picture_spp));
    let bench = Bench { world: &job.world, isa: job.isa(), clock, rays: &rays, wished: request.rays, mix };

    let primitives = bench.build(&input, Structure::Brute).map(|s| references(&s)).map_err(named("brute"))?;
    let (contenders, left_out) = contenders(request.structures.as_deref(), primitives);
    let mut built = Vec::with_capacity(contenders.len());
    for contender in &contenders {
        say(&format!("building {}", contender.name));
        built.push(bench.contestant(&input, contender, primitives).map_err(named(&contender.name))?);
    }
    let expected = built[0].answers(&bench);
    for contestant in &mut built {
        say(&format!("counting the tests of {}", contestant.name()));
        contestant.count(&bench, &expected);
    }
    for round in 1..=request.rounds {
        say(&format!("timing, round {round} of {}", request.rounds));
        for contestant in &mut built {
            contestant.time(&bench, &expected);
        }
    }
    let pictures = request.pictures.then(|| {
        say("drawing cost pictures");
        pictures::draw(&job.world, size, bench.most_tests(), built.iter().map(|c| (c.name(), c.scene())))
    });
    let rows = measure::rows(built, &mix);
    say("weighing bounding volumes");
    let volumes = volumes::weigh(&bench, &input, &objects);
    say("moving an object");
    let moving = moving.and_then(|i| moving::compare(&bench, &input, &objects, i));
    Ok(Report {
        recorded_size: size,
        recorded_spp: request.spp,
        rays: [0, 1, 2].map(|k| rays[k].rays.len()),
        rays_per_sample: [0, 1, 2].map(|k| rays[k].per_sample),
        picture_size: film,
        picture_spp,
        primitives,
        isa: job.isa(),
        rows,
        left_out,
        volumes,
        moving,
        pictures,
    })
}

fn named(name: &str) -> impl FnOnce(BuildError) -> Error {
    let name = name.to_owned();
    |error| Error::Build { name, error }
}

/// The scene's picture in as many pixels as there shall be rays.
fn fitted([w, h]: [u32; 2], rays: usize) -> [u32; 2] {
    let pixels = f64::from(w) * f64::from(h);
    let scale = (rays as f64 / pixels).sqrt();
    if scale >= 1.0 { [w, h] } else { [w, h].map(|n| ((f64::from(n) * scale) as u32).max(1)) }
}

/// Primitives in all leaves of all groups.
fn references(scene: &Scene) -> usize {
    scene.stats().iter().flatten().map(|s| s.references).sum()
}

/// The baseline, then what is compared with it; and what is left out.
fn contenders(wish: Option<&[Contender]>, primitives: usize) -> (Vec<Contender>, Vec<String>) {
    let baseline = Contender::of_kind(Structure::default());
    let (mut all, mut left_out) = (vec![baseline], Vec::new());
    match wish {
        Some(wish) => all.extend(wish.iter().cloned()),
        None => all.extend(Structure::ALL.map(Contender::of_kind)),
    }
    if wish.is_none() && primitives > MOST_FOR_BRUTE {
        all.retain(|c| c.structure != Structure::Brute);
        left_out.push(format!(
            "brute: {primitives} primitives are more than {MOST_FOR_BRUTE}; --structures brute takes it in, with few rays"
        ));
    }
    let mut seen: Vec<Structure> = Vec::new();
    all.retain(|c| {
        let fresh = !seen.contains(&c.structure);
        seen.push(c.structure);
        fresh
    });
    (all, left_out)
}

/// The structures of a list with commas between, each as [`search::parse`] reads it. The commas between parameters are
/// told from these: what follows them has a `=` and no `:` before it.
///
/// ```
/// let list = straal_study::lab::parse_structures("brute,bvh:build=fast,compact=true").unwrap();
/// assert_eq!([&list[0].name, &list[1].name], ["brute", "bvh:build=fast,compact=true"]);
/// ```
pub fn parse_structures(text: &str) -> Result<Vec<Contender>, Error> {
    let bad = |what: String| {
        let known = suggest::list(search::NAMES.iter().copied());
        Error::Structures(format!("{what} (there are {known})"))
    };
    let mut names: Vec<String> = Vec::new();
    for part in text.split(',') {
        let part = part.trim();
        if part.is_empty() {
            let what =
                if text.trim().is_empty() { "no search structure is named" } else { "a comma too many" };
            return Err(bad(format!(
                "{what} in `{}`: write names with commas between",
                suggest::brief(text)
            )));
        }
        let parameter = part.find('=').is_some_and(|at| !part[..at].contains(':'));
        match names.last_mut() {
            Some(last) if parameter && last.contains(':') => {
                last.push(',');
                last.push_str(part);
            }
            Some(last) if parameter => {
                let (last, part) = (suggest::brief(last), suggest::brief(part));
                return Err(bad(format!(
                    "`{part}` stands after a comma, but the first parameter of `{last}` after a colon: `{last}:{part}`"
                )));
            }
            _ => names.push(part.to_owned()),
        }
    }
    let contender = |name: String| {
        let kind = name.split(':').next().unwrap_or_default().trim();
        if !search::NAMES.contains(&kind) {
            let guess = suggest::did_you_mean(kind, search::NAMES.iter().copied());
            let guess = guess.map_or(String::new(), |guess| format!(": {guess}"));
            return Err(bad(format!("`{}` is no search structure{guess}", suggest::brief(kind))));
        }
        let structure = search::parse(&name)
            .map_err(|e| Error::Structures(format!("`{}`: {e}", suggest::brief(&name))))?;
        Ok(Contender { name, structure })
    };
    names.into_iter().map(contender).collect()
}

/// Something at the top of the scene's world.
#[derive(Clone, Debug)]
pub(crate) struct Object {
    /// For people: what it is, and the file or object that it shows.
    pub name: String,
    /// The word by which it can be chosen, besides its number.
    pub word: String,
    /// What stands for it in the world's own group.
    pub geometries: Vec<u32>,
    /// The same, as indices of the group's instances.
    pub instances: std::ops::Range<usize>,
    /// Primitives that can be hit, instances counted each time.
    pub primitives: u64,
    /// Whether nothing bounds it.
    pub unbounded: bool,
}

fn objects(nodes: &[Node], world: &World, input: &Input) -> Vec<Object> {
    let sizes = volumes::Sizes::of(world, input);
    let object = |(i, node): (usize, &Node)| {
        let part = &world.top_level[i];
        let word = word(node);
        let name = format!("{} {}{word}", i + 1, node.kind());
        let group = &input.groups[0];
        let geometries = group.geometries[part.geometries.clone()].to_vec();
        let size = sizes.sum(&geometries, &group.instances[part.instances.clone()]);
        Object {
            name: name.trim_end().to_owned(),
            word: word.trim().to_owned(),
            geometries,
            instances: part.instances.clone(),
            primitives: size.primitives,
            unbounded: size.unbounded,
        }
    };
    nodes.iter().enumerate().take(world.top_level.len()).map(object).collect()
}

/// What a node shows, with a space before it; empty where there is no word for it.
fn word(node: &Node) -> String {
    let shown = match node {
        Node::Instance(_) | Node::Instances(_) => node.object().map(|of| of.name.value.clone()),
        Node::Mesh(m) => m.file.as_ref().and_then(|f| {
            PathBuf::from(&f.file.value).file_stem().map(|stem| stem.to_string_lossy().into_owned())
        }),
        Node::Bezier(b) => b.builtin.as_ref().map(|b| b.name.value.clone()),
        _ => None,
    };
    shown.map_or(String::new(), |s| format!(" {}", suggest::brief(&s)))
}

/// Search options of the lab: slices as the renderer asks for them.
fn options(structure: Structure, isa: Isa) -> Options {
    Options { structure, isa, ..Options::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_structures_keep_their_parameters_together() {
        let names = |text: &str| -> Vec<String> {
            parse_structures(text).unwrap().into_iter().map(|c| c.name).collect()
        };
        assert_eq!(names("brute"), ["brute"]);
        assert_eq!(names("bvh:build=fast,compact=true, brute"), ["bvh:build=fast,compact=true", "brute"]);
    }

    #[test]
    fn an_unknown_structure_is_told_with_the_known_ones() {
        for (text, parts) in [
            ("brute,bhv", ["`bhv`", "did you mean `bvh`?", "`brute`"]),
            ("bvh:biuld=fast", ["`bvh:biuld=fast`: ", "unknown key `biuld`", "did you mean `build`?"]),
            ("tree", ["`tree` is no search structure", "`bvh`", "`brute`"]),
            ("bvh2,", ["a comma too many in `bvh2,`", "`grid`", "`brute`"]),
            (",bvh2", ["a comma too many in `,bvh2`", "`grid`", "`brute`"]),
            ("bvh:build=fast,,brute", ["a comma too many", "`grid`", "`brute`"]),
            (" ", ["no search structure is named", "`grid`", "`brute`"]),
            ("bvh,build=fast", ["`build=fast` stands after a comma", "`bvh:build=fast`", "`brute`"]),
            ("build=fast", ["`build=fast` is no search structure", "`bvh`", "`brute`"]),
        ] {
            let told = parse_structures(text).unwrap_err().to_string();
            assert!(parts.iter().all(|part| told.contains(part)), "{told}");
        }
    }

    #[test]
    fn the_baseline_comes_first_and_once() {
        let names = |wish: Option<&[Contender]>, n| {
            let (all, left_out) = contenders(wish, n);
            (all.into_iter().map(|c| c.name).collect::<Vec<_>>(), left_out.len())
        };
        let (all, left_out) = names(None, 10);
        assert_eq!((all[0].as_str(), left_out), ("bvh", 0));
        assert_eq!(all.len(), Structure::ALL.len());
        let (all, left_out) = names(None, 1 << 20);
        assert!(!all.contains(&"brute".to_owned()) && left_out == 1);
        let asked = [Contender::of_kind(Structure::Brute)];
        assert_eq!(names(Some(&asked), 1 << 20), (vec!["bvh".to_owned(), "brute".to_owned()], 0));
    }

    #[test]
    fn the_recorded_picture_keeps_its_shape() {
        assert_eq!(fitted([800, 400], 1 << 15), [256, 128]);
        assert_eq!(fitted([10, 10], 1 << 15), [10, 10]);
        assert_eq!(fitted([1, 100_000], 16), [1, 1264]);
    }
}
