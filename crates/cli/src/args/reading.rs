//! How the files of a scene are read, and how much memory may be used: the same for all commands that read one.

use super::heading::{MACHINE, PICTURE, TALK};
use crate::machine;
use crate::quantity;
use clap::Args;
use std::path::PathBuf;
use straal::LoadOptions;

/// How much memory is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Args)]
pub struct MemoryArgs {
    /// Memory that may be used, such as 8G or 512M; more is refused before it is taken
    ///
    /// When absent, what the machine or its control group has free, less a tenth.
    #[arg(long, value_name = "SIZE", value_parser = quantity::memory, help_heading = MACHINE)]
    pub memory: Option<u64>,
}

impl MemoryArgs {
    /// Bytes that may be used, where that is known.
    pub fn limit(&self) -> Option<u64> {
        self.memory.or_else(machine::memory)
    }
}

/// How the files of a scene are read.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct ReadingArgs {
    /// How much memory is taken
    #[command(flatten)]
    pub memory: MemoryArgs,

    /// Read files from this folder only: what a scene names, and what those files name
    ///
    /// Symbolic links are followed first.
    #[arg(long, value_name = "DIR", help_heading = MACHINE)]
    pub root: Option<PathBuf>,

    /// The frame of a scene that moves, from 0; such as 12, or 12.5 between two
    #[arg(long, value_name = "N", value_parser = quantity::frame, hide_short_help = true, help_heading = PICTURE)]
    pub frame: Option<f64>,

    /// What stands for a name that a scene of Mitsuba leaves open, such as -D spp=16 for $spp; of a scene of glTF, which camera, scene, variant
    /// or animation is shown, as -D camera=NAME, how many frames a second has, fps, and for how many the shutter is open, shutter; of one of OpenUSD,
    /// which camera; may be given several times
    #[arg(
        short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = definition, hide_short_help = true,
        help_heading = MACHINE
    )]
    pub define: Vec<(String, String)>,

    /// The variant of its materials that a scene of glTF is shown in
    #[arg(long, value_name = "NAME", hide_short_help = true, help_heading = PICTURE)]
    pub variant: Option<String>,

    /// Put each lamp that has a name into a light group of that name: an EXR has the light of each as a layer
    ///
    /// Lights by their own name, surfaces that glow by theirs or that of what is around them, else by that of a material that shines. What has a group stays in it.
    #[arg(long, hide_short_help = true, help_heading = PICTURE)]
    pub group_lamps: bool,

    /// Take unknown keys of the scene for warnings
    #[arg(long, help_heading = TALK)]
    pub lenient: bool,
}

/// A name and what stands for it.
fn definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err("write NAME=VALUE, such as spp=16".to_owned()),
    }
}

impl ReadingArgs {
    /// What it means for who loads a scene.
    pub fn options(&self) -> LoadOptions {
        let (lenient, root, memory) = (self.lenient, self.root.clone(), self.memory.limit());
        let frame = self.frame.unwrap_or(0.0);
        let variant = self.variant.iter().map(|name| ("variant".to_owned(), name.clone()));
        let define = self.define.iter().cloned().chain(variant).collect();
        let group_lamps = self.group_lamps;
        LoadOptions { lenient, root, memory, frame, define, group_lamps, ..LoadOptions::default() }
    }
}
