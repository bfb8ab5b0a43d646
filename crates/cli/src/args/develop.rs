//! What `straal develop` takes.

use super::DevelopmentArgs;
use super::heading::TALK;
use super::parsers::picture_format;
use crate::exit;
use crate::quantity;
use clap::Args;
use std::path::PathBuf;
use straal::focus::Lens;
use straal::picture::Format;
use straal::relight::Relight;

pub(super) const DEVELOP_ABOUT: &str = "\
Develops a picture again, without rendering: exposure, tone curve, gamut, gamma and dithering of a PNG. PICTURE is an EXR, \
HDR, PFM or PNG; an EXR of straal remembers how its scene or command wanted it developed, and what isn't said here stays \
as it was, so that the same settings give the very file that `straal render` writes.

EXR, HDR and PFM outputs hold light as it is: of all options only --light-group and --depth-of-field change them.";

const DEVELOP_EXAMPLES: &str = "\
Examples:
  straal develop scene.exr -o scene.png --exposure +1 --tone agx
  straal develop scene.exr -o scene.png --exposure auto --gamut flag
  straal develop scene.exr -o scene.hdr         light in another format
  straal develop scene.exr -o albedo.png --layer albedo
  straal develop scene.exr -o dusk.png --light-group sun=off --light-group lamps=2,warm
  straal develop scene.exr -o near.png --depth-of-field focus=3.5,radius=0.05";

/// `straal develop`
#[derive(Debug, Args)]
#[command(after_help = DEVELOP_EXAMPLES, after_long_help = format!("{DEVELOP_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct DevelopArgs {
    /// The picture to develop; - for standard input
    pub picture: PathBuf,

    /// Where the developed picture goes: .png, .exr, .hdr or .pfm, or - for standard output; may be given several times
    #[arg(short, long = "output", value_name = "PICTURE", required = true)]
    pub output: Vec<PathBuf>,

    /// The format of what goes to standard output; png when absent
    #[arg(long, value_name = "FORMAT", value_parser = picture_format())]
    pub format: Option<Format>,

    /// Develop this layer of an EXR as if it were the picture, and leave out the others: its name, or the last part of it
    #[arg(long, value_name = "NAME", conflicts_with = "depth_of_field")]
    pub layer: Option<String>,

    /// Change the light of a group of lights, as if its lamps had been others: a factor or off, and a tint such as warm, cool, 3000K or
    /// #ff8000; may be given several times
    ///
    /// The picture is an EXR whose scene gave lamps a `light_group`; what has none is in the group rest. EXRs of Blender and Arnold with
    /// light groups are known as well. An EXR that is written has the changed layers.
    #[arg(long = "light-group", value_name = "NAME=CHANGE", value_parser = str::parse::<Relight>, conflicts_with = "layer")]
    pub light_group: Vec<Relight>,

    /// How a PNG is developed
    #[command(flatten)]
    pub development: DevelopmentArgs,

    /// Blur by the layer `depth` of an EXR, as a lens would: what distance is sharp, and the radius of the lens, in metres
    ///
    /// Rims of near things and mirror images come out other than through a true lens.
    #[arg(long, value_name = "focus=D,radius=R", value_parser = str::parse::<Lens>)]
    pub depth_of_field: Option<Lens>,

    /// Horizontal field of view of the whole picture in degrees, for --depth-of-field, where the picture doesn't tell
    #[arg(long, value_name = "DEGREES", value_parser = quantity::field_of_view, requires = "depth_of_field")]
    pub fov: Option<f64>,

    /// Say nothing but errors
    #[arg(short, long, help_heading = TALK)]
    pub quiet: bool,

    /// Print one JSON object on standard output at the end
    #[arg(long, help_heading = TALK)]
    pub json: bool,
}
