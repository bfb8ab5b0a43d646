//! What was typed. What it means is worked out in [`crate::settings`].

use crate::exit;
use crate::quantity::{self, Crop, Dimensions, Every, Samples, Shape, Size};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use std::marker::PhantomData;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;
use straal::focus::Lens;
use straal::search;
use straal::{Bits, CostMeasure, Dither, Exposure, Gamma, Gamut, Look, Recording, Tone};
use straal_accel::{Build, Isa, Structure};
use straal_color::spectrum::{Observer, illuminant};
use straal_math::lowdisc::PatternKind;

/// The whole command line.
#[derive(Debug, Parser)]
#[command(
    name = "straal",
    version,
    about = "A physically based renderer that shows its work",
    long_about = "straal turns a scene file into a picture by following light, and tells what it did.\n\n\
        Try it without any file: `straal render` renders a scene that it brings along.",
    after_help = "`straal help COMMAND` tells all about a command, with examples.",
    after_long_help = exit::TABLE,
    subcommand_required = true,
    arg_required_else_help = true
)]
pub struct CommandLine {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to a picture
    #[command(long_about = RENDER_ABOUT)]
    Render(Box<RenderArgs>),
    /// Put together parts of a picture that were rendered apart
    #[command(long_about = MERGE_ABOUT)]
    Merge(MergeArgs),
    /// Check a scene without rendering it
    #[command(long_about = CHECK_ABOUT)]
    Check(CheckArgs),
    /// Compare search structures on the rays of a scene
    #[command(long_about = ACCEL_ABOUT)]
    Accel(AccelArgs),
    /// Draw sampling patterns and tell how evenly they lie
    #[command(long_about = SAMPLER_ABOUT)]
    Sampler(SamplerArgs),
    /// Print the JSON Schema of the scene language
    Schema,
    /// Compare two pictures of the same scene statistically
    #[command(long_about = DIFF_ABOUT)]
    Diff(DiffArgs),
    /// Print what a picture tells about itself
    #[command(long_about = INFO_ABOUT)]
    Info(InfoArgs),
    /// Develop a picture again without rendering
    #[command(long_about = DEVELOP_ABOUT)]
    Develop(DevelopArgs),
    /// Make the picture by which a screen's gamma is found
    #[command(long_about = GAMMA_CHART_ABOUT)]
    GammaChart(GammaChartArgs),
    /// Tell under which lights two spectra look alike, or make a spectrum that looks like another
    #[command(long_about = METAMER_ABOUT)]
    Metamer(MetamerArgs),
}

const RENDER_ABOUT: &str = "\
Renders a scene to a picture.

SCENE is a file in the scene language (.yaml, .json) or a bare mesh (.ply, .obj), which gets a floor, a camera and a \
light by itself. What is said here wins over what the scene says.

The same scene and settings give the same bits, whatever the number of threads, the instruction set or the crop. \
Rendering goes in passes over the whole picture; a render that is ended by --time or by Ctrl-C leaves the very \
picture that --spp of as many samples gives. A second Ctrl-C ends at once and writes nothing. What a checkpoint holds is not \
lost even to a power cut: --resume goes on from it.";

const RENDER_EXAMPLES: &str = "\
Examples:
  straal render                                 the scene that straal brings along, to straal.png
  straal render bunny.ply                       a look at a mesh, to bunny.png
  straal render scene.yaml -o a.exr -o a.png    all layers for compositing, and one to look at
  straal render scene.yaml --time 90s           as good as it gets in a minute and a half
  straal render scene.yaml --noise 2%           as many samples as it takes, where it takes them
  straal render scene.yaml --spp 4 --size 320x180 --crop 100,50,200,120
  straal render scene.yaml -o a.exr --resume    goes on where it was cut off
  straal render scene.yaml --json --quiet | jq .film_hash
  straal render scene.yaml -o a.exr --spp 16 --replicates 16
                                                a picture that knows its own variance, for `straal diff`";

/// `straal render`
#[derive(Debug, Args)]
#[command(after_help = RENDER_EXAMPLES, after_long_help = format!("{RENDER_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct RenderArgs {
    /// The scene or mesh; an embedded scene when absent
    pub scene: Option<PathBuf>,

    /// Where the picture goes: .exr (linear, all layers), .png, .hdr or .pfm; may be given several times. When absent, the
    /// scene's name with .png in the current folder
    #[arg(short, long = "output", value_name = "PICTURE")]
    pub output: Vec<PathBuf>,

    /// Samples per pixel
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,

    /// Render passes until the time is up, such as 90s, 2m, 1h30m or 500ms, counted from the start of the command;
    /// with --spp, whichever ends first
    #[arg(long, value_parser = quantity::duration)]
    pub time: Option<Duration>,

    /// Sample each block of 8x8 pixels until its noise, the relative standard error of its pixels, is at most this, such as
    /// 2%. No pixel gets more samples than --spp says, without it 262144
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = quantity::noise)]
    pub noise: Option<f64>,

    /// Take a part of the samples only, such as 64..128: the first (from 0), and one past the last. For --save-sums on
    /// several machines
    #[arg(long, value_name = "A..B", value_parser = quantity::samples)]
    pub samples: Option<Samples>,

    /// Write the exact sums of what was rendered to a file, for `straal merge`. Without -o there is no picture then
    #[arg(long, value_name = "FILE")]
    pub save_sums: Option<PathBuf>,

    /// Write what there is beside the picture, to PICTURE.checkpoint, whenever so much time has passed, for --resume; or off.
    /// 60s where an EXR or sums are written, else off. The file goes when the picture is there
    #[arg(long, value_name = "TIME", value_parser = quantity::checkpoint)]
    pub checkpoint: Option<Every>,

    /// Go on from the checkpoint beside the picture, to the same bits; from the beginning where there is none
    #[arg(long)]
    pub resume: bool,

    /// Width and height of the whole picture, such as 640x360
    #[arg(long, value_name = "WxH", value_parser = quantity::size)]
    pub size: Option<Size>,

    /// Render a part of the picture only: left, top, right, bottom in pixels, the last two exclusive
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = quantity::crop)]
    pub crop: Option<Crop>,

    /// Largest number of edges of a path: 1 sees emitters, 2 is direct light
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub max_depth: Option<u32>,

    /// Compute light by wavelengths instead of red, green and blue
    #[arg(long)]
    pub spectral: bool,

    /// Let a sample count in every pixel that the filter reaches it from, in place of one pixel by whose filter it is drawn
    #[arg(long, conflicts_with = "noise")]
    pub splat: bool,

    /// In which numbers an EXR holds the picture: rgb of the work space; xyz; or spectral, by wavelengths in 16 bands from 380
    /// to 780 nm besides rgb, or in bands as in spectral:40 or spectral:40:400:700
    #[arg(long, value_name = "NUMBERS", value_parser = quantity::recording)]
    pub channels: Option<Recording>,

    /// Seed of all random numbers
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,

    /// Pattern of the random numbers
    #[arg(long, value_name = "PATTERN", value_parser = pattern())]
    pub sampler: Option<PatternKind>,

    /// Render R independently seeded sets of --spp samples; the picture is their mean, and its variance is measured
    /// from their spread
    #[arg(long, value_name = "R", value_parser = clap::value_parser!(u32).range(2..=10_000), conflicts_with = "time")]
    pub replicates: Option<u32>,

    /// How a PNG is developed
    #[command(flatten)]
    pub look: LookArgs,

    /// Worker threads; all cores when absent
    #[arg(long, value_name = "N", value_parser = quantity::threads)]
    pub threads: Option<usize>,

    /// Structure in which rays are searched, and its parameters, as in bvh:build=fast,compact=true; changes the speed
    /// only
    #[arg(long, value_name = "STRUCTURE[:KEY=VALUE,...]", value_parser = StructureParser)]
    pub accel: Option<Structure>,

    /// Work that goes into the tree of the structure bvh; changes the speed only
    #[arg(long, value_name = "WORK", value_parser = build())]
    pub build: Option<Build>,

    /// Instruction set of the search; changes the speed only. The best that the processor has when absent
    #[arg(long, value_name = "SET", value_parser = isa())]
    pub isa: Option<Isa>,

    /// Paths that travel together; changes the speed only
    #[arg(long, value_name = "N", value_parser = quantity::batch)]
    pub batch: Option<usize>,

    /// Count what the searches of each pixel cost, for the layers cost.nodes, cost.primitives and cost.time of an EXR;
    /// slower, and the same picture
    #[arg(long)]
    pub cost: bool,

    /// Write what the searches of each pixel cost as a PNG in false colours, with a legend; counts as --cost does
    #[arg(long, value_name = "PICTURE")]
    pub cost_picture: Option<PathBuf>,

    /// Which cost --cost-picture shows
    #[arg(long, value_name = "COST", value_parser = measure(), default_value = "nodes", requires = "cost_picture")]
    pub cost_of: CostMeasure,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Print one JSON object on standard output at the end: pictures, hashes, times, costs, complaints
    #[arg(long)]
    pub json: bool,

    /// Take unknown keys of the scene for warnings
    #[arg(long)]
    pub lenient: bool,
}

/// How light becomes a picture for the screen; what isn't said is as the scene, or the picture that is developed again,
/// has it.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Developing a PNG")]
pub struct LookArgs {
    /// Brighten (or, below 0, darken) by stops, each of which doubles the light; or by a meter: auto makes the mean grey,
    /// highlights shows nearly all within white, perhaps with stops as in auto+1.5
    #[arg(long, value_name = "EV", allow_hyphen_values = true, value_parser = str::parse::<Exposure>)]
    pub exposure: Option<Exposure>,

    /// Tone curve: what becomes of what is brighter than white; reinhard and hable may be followed by what becomes white,
    /// as in reinhard:4
    #[arg(long, value_name = "CURVE", value_parser = Listed::<Tone>::new(Tone::ALL.map(Tone::name)))]
    pub tone: Option<Tone>,

    /// What becomes of colours that the screen can't show after that; flag may be followed by a colour, as in flag:1,0,1
    #[arg(long, value_name = "WAY", value_parser = Listed::<Gamut>::new(["clip", "desaturate", "flag"]))]
    pub gamut: Option<Gamut>,

    /// How light becomes a signal: srgb, or the power of a plain gamma curve such as 2.2
    #[arg(long, value_name = "GAMMA", value_parser = str::parse::<Gamma>)]
    pub gamma: Option<Gamma>,

    /// Bits a channel
    #[arg(long, value_name = "BITS", value_parser = named(vec![("8", Bits::Eight), ("16", Bits::Sixteen)]))]
    pub bits: Option<Bits>,

    /// Whether smooth gradients are dithered, so that they show no steps
    #[arg(long, value_name = "ON", value_parser = named(vec![("on", Dither::On), ("off", Dither::Off)]))]
    pub dither: Option<Dither>,
}

impl LookArgs {
    /// What is said here over what is there.
    pub fn over(&self, look: Look) -> Look {
        Look {
            exposure: self.exposure.unwrap_or(look.exposure),
            tone: self.tone.unwrap_or(look.tone),
            gamut: self.gamut.unwrap_or(look.gamut),
            gamma: self.gamma.unwrap_or(look.gamma),
            bits: self.bits.unwrap_or(look.bits),
            dither: self.dither.unwrap_or(look.dither),
        }
    }
}

const DEVELOP_ABOUT: &str = "\
Develops a picture again, without rendering: exposure, tone curve, gamut, gamma and dithering of a PNG. PICTURE is an EXR, \
HDR, PFM or PNG; an EXR of straal remembers the look that its scene or command asked for, and what isn't said here stays \
as it was, so that the same settings give the very file that `straal render` writes.

EXR, HDR and PFM outputs hold light as it is: of all options only --depth-of-field changes them.";

const DEVELOP_EXAMPLES: &str = "\
Examples:
  straal develop scene.exr -o scene.png --exposure +1 --tone agx
  straal develop scene.exr -o scene.png --exposure auto --gamut flag
  straal develop scene.exr -o scene.hdr         light in another format
  straal develop scene.exr -o near.png --depth-of-field focus=3.5,radius=0.05";

/// `straal develop`
#[derive(Debug, Args)]
#[command(after_help = DEVELOP_EXAMPLES, after_long_help = format!("{DEVELOP_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct DevelopArgs {
    /// The picture to develop
    pub picture: PathBuf,

    /// Where the developed picture goes: .png, .exr, .hdr or .pfm; may be given several times
    #[arg(short, long = "output", value_name = "PICTURE", required = true)]
    pub output: Vec<PathBuf>,

    /// How a PNG is developed
    #[command(flatten)]
    pub look: LookArgs,

    /// Blur by the layer `depth` of an EXR, as a lens would: the distance in metres that is sharp, and the radius of the
    /// lens in metres. Rims of near things and mirror images come out other than through a true lens
    #[arg(long, value_name = "focus=D,radius=R", value_parser = str::parse::<Lens>)]
    pub depth_of_field: Option<Lens>,

    /// Horizontal field of view of the whole picture in degrees, for --depth-of-field, where the picture doesn't tell
    #[arg(long, value_name = "DEGREES", value_parser = quantity::field_of_view, requires = "depth_of_field")]
    pub fov: Option<f64>,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// `straal gamma-chart`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct GammaChartArgs {
    /// Where the chart goes, a PNG
    #[arg(short, long, value_name = "PICTURE", default_value = "gamma-chart.png")]
    pub output: PathBuf,
}

const MERGE_ABOUT: &str = "\
Puts together parts of a picture that `straal render --save-sums` wrote, on whatever machines: runs of samples, crops, or \
both, in any order. The picture is that of one render of all of it, to the last bit. Samples that several files have are \
refused, and so are gaps.";

const MERGE_EXAMPLES: &str = "\
Examples:
  straal render scene.yaml --spp 128 --samples 0..64 --save-sums a.sums       here
  straal render scene.yaml --spp 128 --samples 64..128 --save-sums b.sums     there
  straal merge a.sums b.sums -o scene.exr -o scene.png
  straal merge scene.exr.checkpoint -o so-far.png --allow-gaps";

/// `straal merge`
#[derive(Debug, Args)]
#[command(after_help = MERGE_EXAMPLES, after_long_help = format!("{MERGE_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct MergeArgs {
    /// The files of sums
    #[arg(required = true)]
    pub sums: Vec<PathBuf>,

    /// Where the picture goes: .exr, .png, .hdr or .pfm; may be given several times
    #[arg(short, long = "output", value_name = "PICTURE", required = true)]
    pub output: Vec<PathBuf>,

    /// Take samples that are missing for a warning
    #[arg(long)]
    pub allow_gaps: bool,

    /// How a PNG is developed
    #[command(flatten)]
    pub look: LookArgs,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,

    /// Print one JSON object on standard output
    #[arg(long)]
    pub json: bool,
}

const CHECK_ABOUT: &str = "\
Checks a scene without rendering it: reads all its files, tells everything that is wrong with them in one go, and \
forecasts how much memory a render takes.";

/// `straal check`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct CheckArgs {
    /// The scene or mesh
    pub scene: PathBuf,

    /// Print one JSON object on standard output instead
    #[arg(long)]
    pub json: bool,

    /// Take unknown keys for warnings
    #[arg(long)]
    pub lenient: bool,
}

const ACCEL_ABOUT: &str = "\
Compares search structures on one scene: records the rays of a real render of it, camera rays, bounces and shadow rays, \
and replays them through each structure. Tells what each is made of, what it cost to build, how many tests a ray takes, \
how fast it is and after how many pictures a costlier build has paid off; and proves that all find the same hits, or \
says where they differ, and ends with code 1.

It also tells for each object of the world whether a box around it pays, and, should one of them move, whether to keep \
its tree apart.";

const ACCEL_EXAMPLES: &str = "\
Examples:
  straal accel scene.yaml
  straal accel scene.yaml --structures bvh:build=fast,bvh:build=best,brute
  straal accel scene.yaml --html lab.html       with cost pictures of all structures side by side
  straal accel scene.yaml --moving teapot --json | jq .moving";

/// `straal accel`
#[derive(Debug, Args)]
#[command(after_help = ACCEL_EXAMPLES, after_long_help = format!("{ACCEL_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct AccelArgs {
    /// The scene or mesh
    pub scene: PathBuf,

    /// What is compared with bvh, with commas between: names, and parameters as --accel of `straal render` takes them.
    /// One of each kind when absent, but brute only where the scene is small
    #[arg(long, value_name = "A,B,...")]
    pub structures: Option<String>,

    /// Size of the picture whose rays are recorded; when absent the scene's, made smaller to about --rays pixels
    #[arg(long, value_name = "WxH", value_parser = quantity::size)]
    pub size: Option<Size>,

    /// Samples per pixel of that picture
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub spp: u32,

    /// Most rays of each kind (primary, bounce, shadow)
    #[arg(long, value_name = "N", default_value_t = 65_536, value_parser = quantity::rays)]
    pub rays: usize,

    /// Rounds in which the structures are timed in turn; the best time counts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rounds: u32,

    /// The object that moves: its number in the world, from 1, or the name of the file or object it shows; the one with
    /// the most primitives when absent
    #[arg(long, value_name = "OBJECT")]
    pub moving: Option<String>,

    /// Instruction set of the search; the best that the processor has when absent
    #[arg(long, value_name = "SET", value_parser = isa())]
    pub isa: Option<Isa>,

    /// Write a page for a browser, with cost pictures in false colours; it needs no other file
    #[arg(long, value_name = "PAGE")]
    pub html: Option<PathBuf>,

    /// Say nothing but errors, besides the table
    #[arg(short, long)]
    pub quiet: bool,

    /// Print one JSON object on standard output instead
    #[arg(long)]
    pub json: bool,

    /// Take unknown keys of the scene for warnings
    #[arg(long)]
    pub lenient: bool,
}

const SAMPLER_ABOUT: &str = "\
Tells how evenly the points of a sampling pattern, or of all of them, lie in the unit square: their L2-star discrepancy, \
and by how much the pixels of a picture of (1 + sin(x²y²))/2 are off when each is sampled by them. --plot draws the points, \
mapped to a disc, a hemisphere or what else --map says, beside their power spectrum.";

const SAMPLER_EXAMPLES: &str = "\
Examples:
  straal sampler                                all patterns, 64 points each
  straal sampler sobol --count 256 --plot       to sobol.svg
  straal sampler jittered --plot disc.svg --map disc
  straal sampler n_rooks --map hemisphere:e=10 --plot";

/// `straal sampler`
#[derive(Debug, Args)]
#[command(after_help = SAMPLER_EXAMPLES, after_long_help = format!("{SAMPLER_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct SamplerArgs {
    /// The pattern; all of them when absent
    #[arg(value_parser = pattern())]
    pub pattern: Option<PatternKind>,

    /// How many points
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=straal::points::MOST as i64))]
    pub count: u32,

    /// Seed of the pattern
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,

    /// Which two of the four numbers that a sample may draw at once, from 0
    #[arg(long, value_name = "X,Y", default_value = "0,1", value_parser = quantity::dimensions)]
    pub dimensions: Dimensions,

    /// Draw the points as an SVG (.svg); when no name follows, to one of the pattern's name in the current folder
    #[arg(long, value_name = "DRAWING")]
    pub plot: Option<Option<PathBuf>>,

    /// What the square is mapped to in the drawing: square, disc, hemisphere:e=1, sphere, triangle or cone:degrees=30
    #[arg(long, value_name = "SHAPE", default_value = "square", value_parser = quantity::shape)]
    pub map: Shape,

    /// Print one JSON array on standard output instead
    #[arg(long)]
    pub json: bool,
}

const DIFF_ABOUT: &str = "\
Tells whether two pictures of the same scene differ by more than chance: by Welch's t-test at every pixel and on 8 x \
8 blocks of pixels, corrected for the number of tests.

The noise of A comes from its layer `variance`, which every EXR of straal has (best measured with --replicates). The \
noise of B comes from --variance, else from B's own layer `variance`.";

const DIFF_EXAMPLES: &str = "\
Examples:
  straal diff mine.exr reference.exr --variance reference-variance.exr
  straal diff before.exr after.exr --json | jq .relmse";

/// `straal diff`
#[derive(Debug, Args)]
#[command(after_help = DIFF_EXAMPLES, after_long_help = format!("{DIFF_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct DiffArgs {
    /// The picture to judge
    pub a: PathBuf,

    /// The picture to judge it by
    pub b: PathBuf,

    /// A picture of the variance of B
    #[arg(long, value_name = "PICTURE")]
    pub variance: Option<PathBuf>,

    /// Judge pictures with rare bright pixels: by the mean of the picture and by blocks only
    #[arg(long)]
    pub heavy_tails: bool,

    /// Print one JSON object on standard output instead
    #[arg(long)]
    pub json: bool,
}

const GAMMA_CHART_ABOUT: &str = "\
Makes the picture by which a screen's gamma is found: fields of black and white checks, each with a grey in its middle that \
is as bright as they are together on a screen of one gamma only, from 1.0 to 3.0. Show it at its own size, step back until \
the checks blur, and look for the field whose middle vanishes: its label is the screen's gamma.";

const INFO_ABOUT: &str = "\
Prints what a picture tells about itself: size, windows, colour space, layers with the least, the mean and the greatest \
number of each channel and how many are no numbers, and the story that straal wrote into it; whether the film hash in the \
story is that of the pixels.";

/// `straal info`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct InfoArgs {
    /// An EXR, PNG, HDR or PFM picture
    pub picture: PathBuf,

    /// Print one JSON object instead
    #[arg(long)]
    pub json: bool,
}

const METAMER_ABOUT: &str = "\
Tells how much two surfaces differ in colour under each illuminant of the CIE, as CIEDE2000: below about 1 nobody sees \
a difference, and surfaces that match under one light and not under another are metamers.

A spectrum is a file with a wavelength in nm and a value on each line, the name of a colour as '#c08040', or a grey such \
as 0.4. With --make and one spectrum, a metamer of it is made: of the same colour under --under and as different \
otherwise as reflectances from 0 to 1 allow.";

const METAMER_EXAMPLES: &str = "\
Examples:
  straal metamer paint.spd print.spd
  straal metamer paint.spd --make twin.spd --under D65
  straal metamer '#8090a0' --make twin.spd && straal metamer '#8090a0' twin.spd --json";

/// `straal metamer`
#[derive(Debug, Args)]
#[command(after_help = METAMER_EXAMPLES, after_long_help = format!("{METAMER_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct MetamerArgs {
    /// A spectrum of reflectance: a file, a metal by name, '#rrggbb' or a number
    pub a: String,

    /// The spectrum to compare it with
    #[arg(required_unless_present = "make", conflicts_with = "make")]
    pub b: Option<String>,

    /// Write a metamer of A to this file
    #[arg(long, value_name = "FILE")]
    pub make: Option<PathBuf>,

    /// The light under which the metamer has the colour of A
    #[arg(long, value_name = "LIGHT", default_value = "D65", value_parser = PossibleValuesParser::new(illuminant::NAMES), ignore_case = true)]
    pub under: String,

    /// Whose eyes: the observer of 2 or of 10 degrees
    #[arg(long, value_name = "DEGREES", default_value = "2", value_parser = observer())]
    pub observer: Observer,

    /// Print one JSON object on standard output instead
    #[arg(long)]
    pub json: bool,
}

/// A parser of names that lists them in the help and, for a wrong one, suggests the nearest.
fn named<T: Clone + Send + Sync + 'static>(all: Vec<(&'static str, T)>) -> impl TypedValueParser<Value = T> {
    let names: Vec<_> = all.iter().map(|(name, _)| *name).collect();
    PossibleValuesParser::new(names).try_map(move |typed| {
        let found = all.iter().find(|(name, _)| *name == typed);
        found.map(|(_, value)| value.clone()).ok_or("no such name")
    })
}

fn observer() -> impl TypedValueParser<Value = Observer> {
    named(vec![("2", Observer::Cie1931), ("10", Observer::Cie1964)])
}

fn pattern() -> impl TypedValueParser<Value = PatternKind> {
    named(PatternKind::ALL.map(|k| (k.name(), k)).to_vec())
}

/// Reads what has a name that may be followed by more; the help lists the names.
#[derive(Clone)]
struct Listed<T> {
    names: Vec<&'static str>,
    is: PhantomData<fn() -> T>,
}

impl<T> Listed<T> {
    fn new<const N: usize>(names: [&'static str; N]) -> Self {
        Self { names: names.to_vec(), is: PhantomData }
    }
}

impl<T: FromStr<Err = straal_color::ParseError> + Clone + Send + Sync + 'static> TypedValueParser
    for Listed<T>
{
    type Value = T;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<T, clap::Error> {
        // A plain name goes by the list, so that a wrong one is answered with the nearest.
        let is_plain = !value.to_string_lossy().contains(':');
        if is_plain {
            PossibleValuesParser::new(self.names.clone()).parse_ref(command, arg, value)?;
        }
        (|text: &str| text.parse::<T>()).parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.names.iter().map(PossibleValue::new)))
    }
}

/// Reads a search structure with its parameters; the help lists the names.
#[derive(Clone)]
struct StructureParser;

impl TypedValueParser for StructureParser {
    type Value = Structure;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<Structure, clap::Error> {
        search::parse.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(search::NAMES.iter().map(PossibleValue::new)))
    }
}

fn build() -> impl TypedValueParser<Value = Build> {
    named(Build::ALL.map(|b| (b.name(), b)).to_vec())
}

fn measure() -> impl TypedValueParser<Value = CostMeasure> {
    named(CostMeasure::ALL.map(|m| (m.name(), m)).to_vec())
}

fn isa() -> impl TypedValueParser<Value = Isa> {
    named(Isa::ALL.map(|i| (i.name(), i)).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn render(words: &str) -> Result<RenderArgs, clap::Error> {
        let words = ["straal", "render"].into_iter().chain(words.split_whitespace());
        match CommandLine::try_parse_from(words)?.command {
            Command::Render(args) => Ok(*args),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_definition_is_consistent() {
        CommandLine::command().debug_assert();
    }

    #[test]
    fn all_that_can_be_said_of_a_render() {
        let a = render(
            "scene.yaml -o a.exr -o a.png --spp 16 --time 1m30s --threads 3 --crop 1,2,3,4 --size 640x360 --seed 7 \
             --max-depth 5 --sampler random --accel brute --build best --isa sse --batch 7 --exposure -1.5 --tone filmic -q \
             --json --lenient --cost-picture c.png --cost-of time",
        )
        .unwrap();
        assert_eq!(a.scene, Some("scene.yaml".into()));
        assert_eq!(a.output, [PathBuf::from("a.exr"), "a.png".into()]);
        assert_eq!((a.spp, a.time), (Some(16), Some(Duration::from_secs(90))));
        assert_eq!((a.threads, a.seed, a.max_depth, a.batch), (Some(3), Some(7), Some(5), Some(7)));
        assert_eq!((a.size, a.crop), (Some(Size([640, 360])), Some(Crop([1, 2, 3, 4]))));
        assert_eq!((a.sampler, a.look.tone), (Some(PatternKind::Random), Some(Tone::Filmic)));
        assert_eq!((a.accel, a.build, a.isa), (Some(Structure::Brute), Some(Build::Best), Some(Isa::Sse)));
        assert_eq!(a.look.exposure, Some(Exposure::stops(-1.5)));
        assert_eq!((a.cost_picture, a.cost_of), (Some("c.png".into()), CostMeasure::Time));
        assert!(a.quiet && a.json && a.lenient && a.replicates.is_none());
    }

    #[test]
    fn nonsense_is_refused_with_a_hint() {
        for (words, hint) in [
            ("--sampler sobel", "a similar value exists: 'sobol'"),
            ("--spp 0", "0 is not in 1.."),
            ("--replicates 1", "1 is not in 2..=10000"),
            ("--replicates 4 --time 3s", "cannot be used with"),
            ("--samplers sobol", "a similar argument exists: '--sampler'"),
            ("--time 90", "write 90s"),
            ("--accel bhv", "unknown `bhv` in `accel`: did you mean `bvh`?"),
            ("--accel bvh:build=faster", "did you mean `fast`?"),
            ("--build slow", "[possible values: fast, default, best]"),
        ] {
            let error = render(words).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains(hint), "{words}: {error}");
        }
    }
}
