//! What `straal convert` takes.

use super::ReadingArgs;
use super::heading::TALK;
use crate::exit;
use clap::Args;
use std::path::PathBuf;

pub(super) const CONVERT_ABOUT: &str = "\
Writes a scene of any format that is read (glTF, pbrt, Mitsuba, OpenUSD, the scene language itself, a bare mesh) in the scene language, or as glTF 2.0. For the scene language: what \
stands in files of its own stays there and is named from the new scene; meshes and pictures that the scene's file holds itself go into a \
folder beside it: OUT_files for OUT.yaml. \
A .glb holds all in one file, a .gltf has its numbers and pictures in OUT.bin beside it; what glTF can't say is told.";

/// `straal convert`
#[derive(Debug, Args)]
#[command(after_long_help = exit::TABLE)]
pub struct ConvertArgs {
    /// The scene or mesh
    pub scene: PathBuf,

    /// The scene to write (.yaml, .yml, .json, .gltf, .glb)
    pub output: PathBuf,

    /// Tell nothing but errors
    #[arg(short, long, help_heading = TALK)]
    pub quiet: bool,

    /// How the files of the scene are read
    #[command(flatten)]
    pub reading: ReadingArgs,
}
