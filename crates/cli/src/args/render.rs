//! What `straal render` takes.

use super::heading::{COST, KEEPING, LIGHT, MACHINE, PICTURE, SAMPLING, SEARCH, TALK};
use super::parsers::{
    StructureParser, build, denoise, guides, integrator, isa, measure, pattern, picture_format,
};
use super::{DevelopmentArgs, ReadingArgs, StudioArgs};
use crate::exit;
use crate::quantity::{self, Crop, Every, Frames, Samples, Size};
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;
use straal::Guides;
use straal::Recording;
use straal::picture::Format;
use straal_accel::{Build, Isa, Structure};
use straal_math::lowdisc::PatternKind;
use straal_scene::desc::{Denoise, Integrator};
use straal_study::cost;

pub(super) const RENDER_ABOUT: &str = "\
Renders a scene to a picture.

SCENE is a file in the scene language (.yaml, .json), a scene of glTF (.gltf, .glb), pbrt (.pbrt), Mitsuba (.xml) or OpenUSD (.usda, .usdc, .usdz), or a bare \
mesh (.ply, .obj, .stl), which is put into a studio with a camera and lights by itself. What is said here wins over what the scene says.

The same scene and settings give the same bits, whatever the number of threads, the instruction set or the crop. \
Rendering goes in passes over the whole picture; a render that is ended by --time or by Ctrl-C leaves the very \
picture that --spp of as many samples gives. A second Ctrl-C ends at once and writes nothing. What a checkpoint holds is not \
lost even to a power cut: --resume goes on from it.";

const RENDER_EXAMPLES: &str = "\
Examples:
  straal render                                 the scene that straal brings along, to straal.png
  straal render bunny.ply                       a look at a mesh, to bunny.png
  straal render part.obj --up z --material metal --write-scene part.yaml
                                                another look, and the scene that gives it
  straal render scene.yaml -o a.exr -o a.png    all layers for compositing, and one to look at
  straal render scene.yaml --time 90s           as good as it gets in a minute and a half
  straal render scene.yaml --noise 2%           as many samples as it takes, where it takes them
  straal render scene.yaml --spp 16 --denoise   clean after a few samples, but not in every detail true
  straal render scene.yaml --spp 4 --size 320x180 --crop 100,50,200,120
  straal render scene.yaml -o a.exr --resume    goes on where it was cut off
  straal render robot.yaml --frames 0..48 -o film/robot.####.exr -o robot.apng
                                                a scene that moves, frame by frame and as one animation
  straal render scene.yaml --json --quiet | jq .film_hash
  make-scene | straal render - -o - > a.png     from standard input, to standard output
  straal render scene.yaml -o a.exr --spp 16 --replicates 16
                                                a picture that knows its own variance, for `straal diff`";

/// `straal render`
#[derive(Debug, Args)]
#[command(after_help = RENDER_EXAMPLES, after_long_help = format!("{RENDER_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct RenderArgs {
    /// The scene or mesh; - for standard input, an embedded scene when absent
    pub scene: Option<PathBuf>,

    /// Where the picture goes: .exr (linear, all layers), .png, .hdr or .pfm; may be given several times
    ///
    /// When absent, the scene's name with .png in the current folder; - is standard output.
    #[arg(short, long = "output", value_name = "PICTURE", help_heading = PICTURE)]
    pub output: Vec<PathBuf>,

    /// The format of what goes to standard output, for -o -; png when absent
    #[arg(long, value_name = "FORMAT", value_parser = picture_format(), hide_short_help = true, help_heading = PICTURE)]
    pub format: Option<Format>,

    /// Width and height of the whole picture, such as 640x360
    #[arg(long, value_name = "WxH", value_parser = quantity::size, help_heading = PICTURE)]
    pub size: Option<Size>,

    /// Render a part of the picture only: left, top, right, bottom in pixels, the last two exclusive
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = quantity::crop, help_heading = PICTURE)]
    pub crop: Option<Crop>,

    /// In which numbers an EXR holds the picture: rgb, xyz, or spectral (by wavelengths)
    ///
    /// rgb is that of the work space; spectral is 16 bands from 380 to 780 nm besides rgb, or bands as in spectral:40 or
    /// spectral:40:400:700.
    #[arg(long, value_name = "NUMBERS", value_parser = quantity::recording, hide_short_help = true, help_heading = PICTURE)]
    pub channels: Option<Recording>,

    /// Render frames of a scene that moves: the first, and one past the last, such as 0..48; or all
    ///
    /// Their numbers stand in the names of the pictures, in place of # signs where there are any: film.####.png becomes film.0007.png.
    /// A picture that ends in .apng is all of them, as one animation. With --resume, frames whose pictures are there are left as they are.
    #[arg(
        long, value_name = "A..B", value_parser = quantity::frames, conflicts_with = "frame", hide_short_help = true,
        help_heading = PICTURE
    )]
    pub frames: Option<Frames>,

    /// Denoise the picture: a clean one, and only a likely one; fast is a sixth of the work, off is not even what the scene says
    ///
    /// Where the noisy light is nearer to the truth, it is blended back; an EXR tells the error that is left, and keeps the noisy light
    /// as the layer noisy. With --noise the render ends by the error of the denoised picture.
    #[arg(
        long, value_name = "EFFORT", value_parser = denoise(), num_args = 0..=1, default_missing_value = "best",
        help_heading = PICTURE
    )]
    pub denoise: Option<Denoise>,

    /// What the layers of albedo and normals are of: the first surface, or the first that scatters, by way of mirrors and glass
    ///
    /// specular when absent for a picture that is denoised, else first.
    #[arg(long, value_name = "GUIDES", value_parser = guides(), hide_short_help = true, help_heading = PICTURE)]
    pub guides: Option<Guides>,

    /// Before denoising, take away light of single pixels that are brighter than N times what is around them, and tell how much
    #[arg(long, value_name = "N", value_parser = quantity::fireflies, hide_short_help = true, help_heading = PICTURE)]
    pub fireflies: Option<f32>,

    /// Write the scene that is rendered, with all that is said here in it, as YAML (.yaml)
    ///
    /// `straal render` of that file gives the same bits: a start for a scene of one's own, from a bare mesh or from the scene
    /// that straal brings along.
    #[arg(long, value_name = "SCENE", help_heading = PICTURE)]
    pub write_scene: Option<PathBuf>,

    /// How a bare mesh is shown
    #[command(flatten)]
    pub studio: StudioArgs,

    /// Samples per pixel
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = quantity::spp, help_heading = SAMPLING)]
    pub spp: Option<u32>,

    /// Render passes until the time is up, such as 90s, 2m, 1h30m or 500ms
    ///
    /// It is counted from the start of the command; with --spp, whichever ends first.
    #[arg(long, value_parser = quantity::duration, help_heading = SAMPLING)]
    pub time: Option<Duration>,

    /// Take samples until the noise is at most this, such as 2%
    ///
    /// Each block of 8x8 pixels is sampled until its noise, the relative standard error of its pixels, is at most this. No
    /// pixel gets more samples than --spp says, without it 262,144.
    #[arg(
        long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = quantity::noise, help_heading = SAMPLING
    )]
    pub noise: Option<f64>,

    /// Seed of all random numbers
    #[arg(long, value_name = "N", help_heading = SAMPLING, value_parser = quantity::seed)]
    pub seed: Option<u64>,

    /// Pattern of the random numbers
    #[arg(long, value_name = "PATTERN", value_parser = pattern(), hide_short_help = true, help_heading = SAMPLING)]
    pub sampler: Option<PatternKind>,

    /// Let a sample count in every pixel that the filter reaches it from
    ///
    /// Without it a sample counts in one pixel, by whose filter its place is drawn.
    #[arg(long, conflicts_with = "noise", hide_short_help = true, help_heading = SAMPLING)]
    pub splat: bool,

    /// Render R independently seeded sets of --spp samples, which measure the noise of their mean
    ///
    /// The picture is the mean of the sets, and its variance is measured from their spread.
    #[arg(
        long, value_name = "R", value_parser = quantity::replicates, conflicts_with_all = ["time", "denoise"], hide_short_help = true,
        help_heading = SAMPLING
    )]
    pub replicates: Option<u32>,

    /// How light is computed, with its usual settings; see `integrator` in the scene language for others
    #[arg(long, value_name = "INTEGRATOR", value_parser = integrator(), help_heading = LIGHT)]
    pub integrator: Option<Integrator>,

    /// Largest number of edges of a path: 1 sees emitters, 2 is direct light
    #[arg(long, value_name = "N", value_parser = quantity::depth, help_heading = LIGHT)]
    pub max_depth: Option<u32>,

    /// The most that one piece of light may bring that came by way of more than one surface; how much that took away is told
    ///
    /// The picture becomes cleaner, and darker than the truth. Of `path`.
    #[arg(long, value_name = "N", value_parser = quantity::clamp, hide_short_help = true, help_heading = LIGHT)]
    pub clamp: Option<f64>,

    /// Compute light by wavelengths instead of red, green and blue
    #[arg(long, help_heading = LIGHT)]
    pub spectral: bool,

    /// Write what there is beside the picture whenever so much time has passed, for --resume; or off
    ///
    /// It goes to PICTURE.checkpoint: every 60s where an EXR or sums are written, else off. The file goes when the picture is there.
    #[arg(long, value_name = "TIME", value_parser = quantity::checkpoint, help_heading = KEEPING)]
    pub checkpoint: Option<Every>,

    /// Go on from the checkpoint beside the picture, to the same bits; from the beginning where there is none
    #[arg(long, help_heading = KEEPING)]
    pub resume: bool,

    /// Take a part of the samples only, such as 64..128: the first (from 0), and one past the last
    ///
    /// For --save-sums on several machines.
    #[arg(long, value_name = "A..B", value_parser = quantity::samples, hide_short_help = true, help_heading = KEEPING)]
    pub samples: Option<Samples>,

    /// Write the exact sums of what was rendered to a file, for `straal merge`
    ///
    /// Without -o there is no picture then.
    #[arg(long, value_name = "FILE", hide_short_help = true, help_heading = KEEPING)]
    pub save_sums: Option<PathBuf>,

    /// How a PNG is developed
    #[command(flatten)]
    pub development: DevelopmentArgs,

    /// Structure in which rays are searched, and its parameters, as in bvh:build=fast,compact=true
    #[arg(
        long, value_name = "STRUCTURE[:KEY=VALUE,...]", value_parser = StructureParser, hide_short_help = true,
        help_heading = SEARCH
    )]
    pub accel: Option<Structure>,

    /// Work that goes into the tree of the structure bvh
    #[arg(long, value_name = "WORK", value_parser = build(), hide_short_help = true, help_heading = SEARCH)]
    pub build: Option<Build>,

    /// Instruction set of the search; the best that the processor has when absent
    #[arg(long, value_name = "SET", value_parser = isa(), hide_short_help = true, help_heading = SEARCH)]
    pub isa: Option<Isa>,

    /// Paths that travel together
    #[arg(long, value_name = "N", value_parser = quantity::batch, hide_short_help = true, help_heading = SEARCH)]
    pub batch: Option<usize>,

    /// Count what the searches of each pixel cost, for layers of an EXR; slower, and the same picture
    ///
    /// The layers are cost.nodes, cost.primitives and cost.time.
    #[arg(long, hide_short_help = true, help_heading = COST)]
    pub cost: bool,

    /// Write what the searches of each pixel cost as a PNG in false colours, with a legend
    ///
    /// Counts as --cost does.
    #[arg(long, value_name = "PICTURE", hide_short_help = true, help_heading = COST)]
    pub cost_picture: Option<PathBuf>,

    /// Which cost --cost-picture shows
    #[arg(
        long, value_name = "COST", value_parser = measure(), default_value = "nodes", requires = "cost_picture",
        hide_short_help = true, help_heading = COST
    )]
    pub cost_of: cost::Measure,

    /// Worker threads; all cores when absent
    #[arg(long, value_name = "N", value_parser = quantity::threads, help_heading = MACHINE)]
    pub threads: Option<usize>,

    /// Say nothing but errors
    #[arg(short, long, help_heading = TALK)]
    pub quiet: bool,

    /// Print one JSON object on standard output at the end: pictures, hashes, times, costs, complaints
    #[arg(long, help_heading = TALK)]
    pub json: bool,

    /// How the files of the scene are read
    #[command(flatten)]
    pub reading: ReadingArgs,
}
