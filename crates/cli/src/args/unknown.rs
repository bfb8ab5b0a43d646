//! What is said of a command line that can't be read. clap guesses by letters alone, so that it takes `--samples` for `--sampler`
//! and `-spp 64` for a value; here the words that people bring from other renderers are known.

use super::CommandLine;
use crate::exit::Failure;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory};
use std::ffi::OsString;
use straal_scene::suggest::did_you_mean;

/// What a word of another program is here.
enum Here {
    /// An option of the same meaning, and how it is written.
    Called(&'static str, &'static str),
    /// Nothing: why, or what does it instead.
    Not(&'static str),
}

use Here::{Called, Not};

/// Options of other renderers: their names without hyphens, and what they are here.
const OPTIONS: &[(&[&str], Here)] = &[
    (
        &[
            "samples",
            "sample",
            "samplecount",
            "numsamples",
            "nsamples",
            "pixelsamples",
            "samplesperpixel",
            "sampleperpixel",
            "aasamples",
            "aa",
            "cyclessamples",
        ],
        Called("spp", "--spp 64"),
    ),
    (
        &["width", "height", "w", "resolution", "res", "dimensions", "pixels", "x", "y"],
        Called("size", "--size 640x360"),
    ),
    (
        &[
            "outfile",
            "out",
            "outputfile",
            "outputpath",
            "file",
            "filename",
            "image",
            "imagefile",
            "renderoutput",
            "save",
        ],
        Called("output", "--output picture.png"),
    ),
    (
        &["nthreads", "thread", "numthreads", "cpus", "cores", "jobs", "j", "t"],
        Called("threads", "--threads 4"),
    ),
    (&["cropwindow", "window", "region", "tile", "border"], Called("crop", "--crop 100,50,200,120")),
    (&["maxbounces", "bounces", "depth", "raydepth", "maxdepth", "d"], Called("max-depth", "--max-depth 8")),
    (&["randomseed", "rngseed"], Called("seed", "--seed 7")),
    (&["timelimit", "timeout", "maxtime", "haltt", "seconds"], Called("time", "--time 90s")),
    (
        &["noisethreshold", "noiselevel", "threshold", "error", "adaptive", "convergence"],
        Called("noise", "--noise 2%"),
    ),
    (
        &["tonemap", "tonemapping", "tonemapper", "tonecurve", "filmic", "viewtransform"],
        Called("tone", "--tone agx"),
    ),
    (&["ev", "stops", "brightness"], Called("exposure", "--exposure 1.5")),
    (&["upaxis", "upvector", "zup"], Called("up", "--up z")),
    (&["angle", "crease", "smoothing", "autosmooth"], Called("smooth", "--smooth 40")),
    (&["silent"], Called("quiet", "--quiet")),
    (&["wavelengths", "spectrum", "hwss"], Called("spectral", "--spectral")),
    (&["accelerator", "bvh", "kdtree"], Called("accel", "--accel bvh")),
    (&["pattern", "rng"], Called("sampler", "--sampler sobol")),
    (&["bit", "bitdepth", "depthbits"], Called("bits", "--bits 16")),
    (&["force", "keepgoing", "ignoreerrors"], Called("lenient", "--lenient")),
    (&["denoiser", "oidn"], Called("denoise", "--denoise")),
    (
        &["gpu", "device", "cuda", "optix", "hip", "metal", "wavefront"],
        Not("straal renders on the processor alone; --threads says with how many"),
    ),
    (
        &["verbose", "v", "log", "loglevel", "progress"],
        Not("progress and complaints are told without asking; --json tells the most"),
    ),
    (
        &["camera", "fov", "lookat", "eye"],
        Not(
            "the camera stands in the scene: `camera: { perspective: { eye: [0, 1, 4], look_at: [0, 0, 0] } }`",
        ),
    ),
    (
        &["frame", "f", "animation", "a", "start", "end", "frames"],
        Not("animations are not supported yet: a scene is one picture"),
    ),
    (
        &["b", "batchmode", "headless", "nogui", "interactive", "gui"],
        Not("straal has no window: it always works in the background"),
    ),
    (&["overwrite", "yes"], Not("pictures that are there are replaced without asking")),
];

/// Commands of other programs, and what they are here.
const COMMANDS: &[(&[&str], &str)] = &[
    (&["convert", "export", "import", "translate"], "scenes of other programs can't be converted yet"),
    (
        &["view", "show", "display", "open"],
        "straal has no window: render to a .png and open that, or `straal info PICTURE`",
    ),
    (&["validate", "lint", "verify", "test"], "it is called `straal check SCENE`"),
    (&["compare", "cmp"], "it is called `straal diff A B`"),
    (&["tonemap", "postprocess", "post"], "it is called `straal develop PICTURE -o PICTURE.png`"),
    (&["bench", "benchmark"], "`straal accel SCENE` times the search structures"),
    (&["clean", "oidn", "filter"], "it is called `straal denoise PICTURE -o CLEAN.exr`"),
    (&["complete", "completion"], "it is called `straal completions`"),
    (&["manual", "manpage", "mangen"], "it is called `straal man`"),
    (&["trace", "run", "start", "draw"], "it is called `straal render SCENE`"),
];

/// What is wrong with a command line; `words` is all of it, the program's name first. Where clap tells it best, it is told in its
/// words.
pub fn failure(error: &clap::Error, words: &[OsString]) -> Failure {
    let words: Vec<String> = words.iter().skip(1).map(|w| w.to_string_lossy().into_owned()).collect();
    let all = CommandLine::command();
    let command = words.iter().find_map(|w| all.find_subcommand(w));
    let told = match error.kind() {
        ErrorKind::UnknownArgument => context(error, ContextKind::InvalidArg)
            .map(|typed| unknown_argument(&typed, &words, command, &all)),
        ErrorKind::InvalidSubcommand => {
            context(error, ContextKind::InvalidSubcommand).map(|typed| unknown_command(&typed, &words, &all))
        }
        _ => None,
    };
    told.unwrap_or_else(|| as_clap_says(error))
}

fn context(error: &clap::Error, kind: ContextKind) -> Option<String> {
    match error.get(kind)? {
        ContextValue::String(s) => Some(s.clone()),
        _ => None,
    }
}

fn unknown_argument(typed: &str, words: &[String], command: Option<&Command>, all: &Command) -> Failure {
    // Of `-spp` clap names the first letter.
    let word = match typed.strip_prefix('-') {
        Some(letter) if letter.chars().count() == 1 => {
            let long =
                words.iter().find(|w| w.len() > typed.len() && w.starts_with(typed) && !w.starts_with("--"));
            long.map_or(typed, String::as_str)
        }
        _ => typed,
    };
    let name = word.split('=').next().unwrap_or(word);
    let Some(command) = command else {
        let has = all.get_subcommands().find(|c| has_option(c, bare(name)));
        let help = has.map_or(
            "such as `straal render scene.yaml`; `straal --help` lists the commands".to_owned(),
            |c| format!("options come after the command: `straal {} {name} ...`", c.get_name()),
        );
        return Failure::input(format!("a command must come before `{word}`")).help(help);
    };
    let title = format!("straal {}", command.get_name());
    if !word.starts_with('-') {
        return superfluous(word, words, command);
    }
    let failure = Failure::input(format!("`{title}` has no option `{name}`"));
    if !name.starts_with("--") && has_option(command, bare(name)) && bare(name).len() > 1 {
        return failure.help(format!("names of options have two hyphens: `--{}`", bare(name)));
    }
    let folded = fold(name);
    match OPTIONS.iter().find(|(names, _)| names.contains(&folded.as_str())) {
        Some((_, Called(option, example))) if has_option(command, option) => {
            return failure.help(format!("it is called `--{option}` here: `{example}`"));
        }
        Some((_, Not(why))) => return failure.help(*why),
        _ => {}
    }
    let longs = || command.get_arguments().filter_map(|a| a.get_long());
    if let Some(near) = did_you_mean(bare(name), longs()) {
        return failure
            .help(near.replace('`', "").replacen("did you mean ", "did you mean `--", 1).replace('?', "`?"));
    }
    let elsewhere = all.get_subcommands().find(|c| has_option(c, bare(name)));
    failure.help(match elsewhere {
        Some(other) => {
            format!("`straal {}` has it; `{title} --help` lists those of this one", other.get_name())
        }
        None => format!("`{title} --help` lists all options"),
    })
}

/// A word where nothing is expected any more.
fn superfluous(word: &str, words: &[String], command: &Command) -> Failure {
    let failure =
        Failure::input(format!("`straal {}` doesn't know what to do with `{word}`", command.get_name()));
    let before =
        words.iter().position(|w| w == word).and_then(|i| i.checked_sub(2)).and_then(|i| words.get(i..i + 2));
    let is_number = |s: &str| s.parse::<f64>().is_ok();
    match before {
        Some([option, first]) if option.starts_with('-') && is_number(first) && is_number(word) => {
            let joined =
                if option == "--size" { format!("{first}x{word}") } else { format!("{first},{word},...") };
            failure.help(format!("numbers of one option are written without spaces: `{option} {joined}`"))
        }
        _ => failure.help(format!("`straal {} --help` tells what it takes", command.get_name())),
    }
}

fn unknown_command(typed: &str, words: &[String], all: &Command) -> Failure {
    let is_file =
        ["yaml", "yml", "json", "ply", "obj", "stl", "gltf", "glb", "pbrt", "usd", "usda", "usdc", "usdz"]
            .iter()
            .any(|e| typed.to_lowercase().ends_with(&format!(".{e}")));
    let failure = Failure::input(format!("straal has no command `{typed}`"));
    if is_file || std::path::Path::new(typed).is_file() {
        let rest: Vec<&str> = words.iter().map(String::as_str).collect();
        return failure.help(format!("to render it: `straal render {}`", rest.join(" ")));
    }
    let folded = fold(typed);
    if let Some((_, help)) = COMMANDS.iter().find(|(names, _)| names.contains(&folded.as_str())) {
        return failure.help(*help);
    }
    let names = all.get_subcommands().map(Command::get_name);
    failure
        .help(did_you_mean(typed, names).unwrap_or_else(|| "`straal --help` lists the commands".to_owned()))
}

fn has_option(command: &Command, long: &str) -> bool {
    command.get_arguments().any(|a| a.get_long() == Some(long))
}

/// A name without its hyphens in front.
fn bare(name: &str) -> &str {
    name.trim_start_matches('-')
}

/// How a name is looked up: case and hyphens don't count.
fn fold(name: &str) -> String {
    name.chars().filter(|c| !matches!(c, '-' | '_')).flat_map(char::to_lowercase).collect()
}

/// The first paragraph of what clap says is what is wrong, and its tip is what would be right.
fn as_clap_says(error: &clap::Error) -> Failure {
    let text = error.to_string();
    let mut paragraphs = text.split("\n\n");
    let message = paragraphs.next().unwrap_or_default();
    let lines: Vec<&str> =
        message.strip_prefix("error: ").unwrap_or(message).lines().map(str::trim).collect();
    let tips: Vec<&str> =
        paragraphs.flat_map(str::lines).filter_map(|l| l.trim().strip_prefix("tip: ")).collect();
    let failure = Failure::input(lines.join(" "));
    if tips.is_empty() { failure.help("`--help` tells more") } else { failure.help(tips.join("; ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn told(line: &str) -> (String, String) {
        let words: Vec<OsString> = line.split_whitespace().map(OsString::from).collect();
        let error = CommandLine::try_parse_from(&words).expect_err(line);
        let failure = failure(&error, &words);
        (failure.message, failure.help.unwrap_or_default())
    }

    #[test]
    fn words_of_other_renderers_are_known() {
        for (line, message, help) in [
            ("straal render a.yaml -spp 64", "`straal render` has no option `-spp`", "two hyphens: `--spp`"),
            (
                "straal render a.yaml --samples-per-pixel=4",
                "no option `--samples-per-pixel`",
                "called `--spp` here",
            ),
            ("straal render a.yaml --samples 64", "samples per pixel are `--spp 64`", "`--help` tells more"),
            ("straal render a.yaml --width 640", "no option `--width`", "`--size 640x360`"),
            ("straal render a.yaml -w 640", "no option `-w`", "`--size 640x360`"),
            ("straal render a.yaml --outfile a.png", "no option `--outfile`", "`--output picture.png`"),
            ("straal render a.yaml --nthreads 3", "no option `--nthreads`", "`--threads 4`"),
            ("straal render a.yaml --denoiser oidn", "no option `--denoiser`", "`--denoise`"),
            ("straal render a.yaml --spq 4", "no option `--spq`", "did you mean `--spp`?"),
            (
                "straal render a.yaml --frobnicate",
                "no option `--frobnicate`",
                "`straal render --help` lists all",
            ),
            ("straal check a.yaml --spp 4", "`straal check` has no option `--spp`", "`straal render` has it"),
            ("straal render a.yaml --size 640 360", "what to do with `360`", "`--size 640x360`"),
            ("straal render a.yaml b.yaml", "what to do with `b.yaml`", "`straal render --help`"),
            ("straal --spp 4 a.yaml", "a command must come before `--spp`", "`straal render --spp ...`"),
            ("straal a.yaml --spp 4", "no command `a.yaml`", "`straal render a.yaml --spp 4`"),
            ("straal rendr a.yaml", "no command `rendr`", "did you mean `render`?"),
            ("straal validate a.yaml", "no command `validate`", "`straal check SCENE`"),
            ("straal frob", "no command `frob`", "`straal --help`"),
            (
                "straal render a.yaml --spp many",
                "invalid value 'many' for '--spp <N>'",
                "`--help` tells more",
            ),
            (
                "straal render a.yaml --tone agxx",
                "'agxx' for '--tone <CURVE>' [possible values: ",
                "similar value exists: 'agx'",
            ),
        ] {
            let (found, advice) = told(line);
            assert!(found.contains(message) && advice.contains(help), "{line}\n  {found}\n  {advice}");
        }
    }

    #[test]
    fn what_is_called_otherwise_here_is_here() {
        let all = CommandLine::command();
        let render = all.find_subcommand("render").unwrap();
        for (names, here) in OPTIONS {
            if let Called(option, example) = here {
                assert!(
                    has_option(render, option) && example.starts_with(&format!("--{option}")),
                    "{option}"
                );
            }
            assert!(names.iter().all(|n| fold(n) == *n), "{names:?}");
        }
    }
}
