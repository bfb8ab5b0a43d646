//! What `straal denoise` takes.

use super::DevelopmentArgs;
use super::heading::{MACHINE, TALK};
use super::parsers::{effort, isa, picture_format};
use crate::exit;
use crate::quantity;
use clap::Args;
use std::path::PathBuf;
use straal::denoise::Effort;
use straal::picture::Format;
use straal_accel::Isa;

pub(super) const DENOISE_ABOUT: &str = "\
Makes a clean picture of a noisy one, by the network of Intel's Open Image Denoise in straal's own arithmetic: the same bits on \
every machine. PICTURE is an EXR, HDR, PFM or PNG, best an EXR whose layers tell albedo and normal of what each pixel shows, as \
those of straal do, or of Blender, pbrt, Mitsuba and others.

A clean picture isn't a true one: where the network can't know, it invents what looks likely. The noisy light stays in an \
EXR as the layer `noisy`. Light that is no number, or below 0, counts as black. Alpha stays as it is.";

const DENOISE_EXAMPLES: &str = "\
Examples:
  straal render scene.yaml --spp 16 -o noisy.exr
  straal denoise noisy.exr -o clean.exr -o clean.png
  straal denoise noisy.exr -o clean.png --fireflies 10 --exposure +1
  straal denoise photo.hdr -o clean.hdr          without guides: detail of textures may be lost
  straal denoise noisy.exr -o clean.exr --weights rt_hdr_alb.tza";

/// `straal denoise`
#[derive(Debug, Args)]
#[command(after_help = DENOISE_EXAMPLES, after_long_help = format!("{DENOISE_EXAMPLES}\n\n{}", exit::TABLE))]
pub struct DenoiseArgs {
    /// The noisy picture; - for standard input
    pub picture: PathBuf,

    /// Where the clean picture goes: .png, .exr, .hdr or .pfm, or - for standard output; may be given several times
    #[arg(short, long = "output", value_name = "PICTURE", required = true)]
    pub output: Vec<PathBuf>,

    /// The format of what goes to standard output; png when absent
    #[arg(long, value_name = "FORMAT", value_parser = picture_format())]
    pub format: Option<Format>,

    /// How much work the network does
    #[arg(long, value_name = "EFFORT", value_parser = effort(), default_value = "best")]
    pub effort: Effort,

    /// Before that, take away light of single pixels that are brighter than N times what is around them, and tell how much
    #[arg(long, value_name = "N", value_parser = quantity::fireflies)]
    pub fireflies: Option<f32>,

    /// Weights of another network of Open Image Denoise (.tza), which decide what guides it sees
    ///
    /// Of a folder the best for guides without noise are taken, and those that take the noise out of the guides before.
    #[arg(long, value_name = "FILE|FOLDER", conflicts_with = "effort")]
    pub weights: Option<PathBuf>,

    /// How a PNG is developed
    #[command(flatten)]
    pub development: DevelopmentArgs,

    /// Worker threads; all cores when absent
    #[arg(long, value_name = "N", value_parser = quantity::threads, help_heading = MACHINE)]
    pub threads: Option<usize>,

    /// Instruction set; the best that the processor has when absent
    #[arg(long, value_name = "SET", value_parser = isa(), hide_short_help = true, help_heading = MACHINE)]
    pub isa: Option<Isa>,

    /// Say nothing but errors
    #[arg(short, long, help_heading = TALK)]
    pub quiet: bool,

    /// Print one JSON object on standard output at the end
    #[arg(long, help_heading = TALK)]
    pub json: bool,
}
