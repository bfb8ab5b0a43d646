//! What was typed. What it means is worked out in [`crate::settings`].
//!
//! A file for each command. An option's first paragraph is what `-h` says of it, all of its paragraphs what `--help` says; under
//! which of the headings it stands is told by `help_heading`.

mod accel;
mod check;
mod completions;
mod convert;
mod denoise;
mod develop;
mod development;
mod diff;
mod gamma_chart;
mod info;
mod man;
mod merge;
mod metamer;
mod parsers;
mod reading;
mod render;
mod sampler;
mod studio;
mod tree;
mod unknown;

pub use accel::AccelArgs;
pub use check::CheckArgs;
pub use completions::CompletionsArgs;
pub use convert::ConvertArgs;
pub use denoise::DenoiseArgs;
pub use develop::DevelopArgs;
pub use development::DevelopmentArgs;
pub use diff::DiffArgs;
pub use gamma_chart::GammaChartArgs;
pub use info::InfoArgs;
pub use man::ManArgs;
pub use merge::MergeArgs;
pub use metamer::MetamerArgs;
pub use reading::{MemoryArgs, ReadingArgs};
pub use render::RenderArgs;
pub use sampler::SamplerArgs;
pub use studio::StudioArgs;
pub use tree::TreeArgs;
pub use unknown::failure;

use crate::exit;
use clap::{Parser, Subcommand};

/// The headings of the help, in the order in which a command shows them.
mod heading {
    /// What is made, how large, and where it goes.
    pub const PICTURE: &str = "Picture";
    /// How many samples, and which.
    pub const SAMPLING: &str = "Sampling";
    /// How light is followed.
    pub const LIGHT: &str = "Light";
    /// How a mesh without a scene is shown.
    pub const STUDIO: &str = "A bare mesh";
    /// From light to a picture for the screen.
    pub const DEVELOPMENT: &str = "Developing a PNG";
    /// What outlasts a render that is cut off, and parts of a picture.
    pub const KEEPING: &str = "Going on, and parts of a picture";
    /// How rays are searched: changes the speed only.
    pub const SEARCH: &str = "Search, which changes the speed only";
    /// What rays cost.
    pub const COST: &str = "What rays cost";
    /// What of the machine is used.
    pub const MACHINE: &str = "Machine";
    /// What is told, and how.
    pub const TALK: &str = "Messages";
}

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
    #[command(long_about = render::RENDER_ABOUT)]
    Render(Box<RenderArgs>),
    /// Put together parts of a picture that were rendered apart
    #[command(long_about = merge::MERGE_ABOUT)]
    Merge(MergeArgs),
    /// Check a scene without rendering it
    #[command(long_about = check::CHECK_ABOUT)]
    Check(CheckArgs),
    /// Write a scene of any format in the scene language
    #[command(long_about = convert::CONVERT_ABOUT)]
    Convert(ConvertArgs),
    /// Print what stands in a scene, and where
    #[command(long_about = tree::TREE_ABOUT)]
    Tree(TreeArgs),
    /// Compare search structures on the rays of a scene
    #[command(long_about = accel::ACCEL_ABOUT)]
    Accel(AccelArgs),
    /// Draw sampling patterns and tell how evenly they lie
    #[command(long_about = sampler::SAMPLER_ABOUT)]
    Sampler(SamplerArgs),
    /// Print the JSON Schema of the scene language
    Schema,
    /// Compare two pictures of the same scene statistically
    #[command(long_about = diff::DIFF_ABOUT)]
    Diff(DiffArgs),
    /// Print what a picture tells about itself
    #[command(long_about = info::INFO_ABOUT)]
    Info(InfoArgs),
    /// Develop a picture again without rendering
    #[command(long_about = develop::DEVELOP_ABOUT)]
    Develop(DevelopArgs),
    /// Make a clean picture of a noisy one
    #[command(long_about = denoise::DENOISE_ABOUT)]
    Denoise(DenoiseArgs),
    /// Make the picture by which a screen's gamma is found
    #[command(long_about = gamma_chart::GAMMA_CHART_ABOUT)]
    GammaChart(GammaChartArgs),
    /// Tell under which lights two spectra look alike, or make a spectrum that looks like another
    #[command(long_about = metamer::METAMER_ABOUT)]
    Metamer(MetamerArgs),
    /// Print what a shell needs to complete the command line
    #[command(long_about = completions::COMPLETIONS_ABOUT)]
    Completions(CompletionsArgs),
    /// Print the manual page
    #[command(long_about = man::MAN_ABOUT)]
    Man(ManArgs),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::{Crop, Size};
    use clap::CommandFactory;
    use std::path::PathBuf;
    use std::time::Duration;
    use straal::{Exposure, Tone};
    use straal_accel::{Build, Isa, Structure};
    use straal_math::lowdisc::PatternKind;
    use straal_study::cost;

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
        assert_eq!((a.sampler, a.development.tone), (Some(PatternKind::Random), Some(Tone::Filmic)));
        assert_eq!((a.accel, a.build, a.isa), (Some(Structure::Brute), Some(Build::Best), Some(Isa::Sse)));
        assert_eq!(a.development.exposure, Some(Exposure::stops(-1.5)));
        assert_eq!((a.cost_picture, a.cost_of), (Some("c.png".into()), cost::Measure::Time));
        assert!(a.quiet && a.json && a.reading.lenient && a.replicates.is_none());
    }

    #[test]
    fn nonsense_is_refused_with_a_hint() {
        for (words, hint) in [
            ("--sampler sobel", "a similar value exists: 'sobol'"),
            ("--spp 0", "write a whole number from 1 to 262,144"),
            ("--replicates 1", "write a whole number from 2 to 10,000"),
            ("--replicates 4 --time 3s", "cannot be used with"),
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
