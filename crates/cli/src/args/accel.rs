//! What `straal accel` takes.

use super::ReadingArgs;
use super::heading::TALK;
use super::parsers::isa;
use crate::exit;
use crate::quantity::{self, Size};
use clap::Args;
use std::path::PathBuf;
use straal_accel::Isa;

pub(super) const ACCEL_ABOUT: &str = "\
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

    /// What is compared with bvh, with commas between; one of each kind when absent
    ///
    /// Names, and parameters as --accel of `straal render` takes them. When absent, brute is there only where the scene is
    /// small.
    #[arg(long, value_name = "A,B,...")]
    pub structures: Option<String>,

    /// Size of the picture whose rays are recorded; when absent the scene's, made smaller to about --rays pixels
    #[arg(long, value_name = "WxH", value_parser = quantity::size)]
    pub size: Option<Size>,

    /// Samples per pixel of that picture
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = quantity::recorded_spp)]
    pub spp: u32,

    /// Most rays of each kind (primary, bounce, shadow)
    #[arg(long, value_name = "N", default_value_t = 65_536, value_parser = quantity::rays)]
    pub rays: usize,

    /// Rounds in which the structures are timed in turn; the best time counts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = quantity::rounds)]
    pub rounds: u32,

    /// The object that moves: its number in the world, from 1, or the name of the file or object it shows
    ///
    /// The one with the most primitives when absent.
    #[arg(long, value_name = "OBJECT")]
    pub moving: Option<String>,

    /// Instruction set of the search; the best that the processor has when absent
    #[arg(long, value_name = "SET", value_parser = isa())]
    pub isa: Option<Isa>,

    /// Write a page for a browser, with cost pictures in false colours; it needs no other file
    #[arg(long, value_name = "PAGE")]
    pub html: Option<PathBuf>,

    /// Say nothing but errors, besides the table
    #[arg(short, long, help_heading = TALK)]
    pub quiet: bool,

    /// Print one JSON object on standard output instead
    #[arg(long, help_heading = TALK)]
    pub json: bool,

    /// How the files of the scene are read
    #[command(flatten)]
    pub reading: ReadingArgs,
}
