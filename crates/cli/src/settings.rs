//! What a command line for `straal render` means: the defaults filled in, and all that can be known to fail before a
//! ray is traced found out.

use crate::args::{LookArgs, RenderArgs};
use crate::exit::Failure;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Duration;
use straal::picture::{Format, SaveError};
use straal::{CostMeasure, Look, Overrides};
use straal_formats::atomic;

/// What is to be rendered, how, and where to.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// The file; `None` for the embedded scene.
    pub scene: Option<PathBuf>,
    /// Where the picture goes; at least one place.
    pub outputs: Vec<PathBuf>,
    /// What goes to standard output, where one of the places is `-`.
    pub format: Format,
    /// What wins over the scene.
    pub overrides: Overrides,
    /// The time that all of it may take.
    pub time: Option<Duration>,
    /// Independent sets of samples.
    pub replicates: Option<u32>,
    /// Where the picture of the searches' costs goes, and which cost it shows.
    pub cost_picture: Option<(PathBuf, CostMeasure)>,
    /// Steps of the look in place of the scene's.
    pub look: LookArgs,
    /// Whether only errors are told.
    pub quiet: bool,
    /// Whether the result is told to a script.
    pub json: bool,
    /// Whether unknown keys are warnings.
    pub lenient: bool,
}

impl RenderSettings {
    /// What the arguments mean, or why they can't be followed. Nothing stays on the disk.
    pub fn new(args: RenderArgs) -> Result<Self, Failure> {
        if let Some(isa) = args.isa.filter(|isa| !isa.is_available()) {
            let help = format!("without --isa the best there is is taken: {}", straal_accel::Isa::detect());
            return Err(Failure::input(format!("this processor has no {isa}")).help(help));
        }
        let outputs = match args.output {
            none if none.is_empty() => vec![default_output(args.scene.as_deref())],
            given => given,
        };
        if let Some(path) = &args.cost_picture {
            if !matches!(Format::of(path), Ok(Format::Png)) {
                return Err(Failure::input(SaveError::NotPng(path.display().to_string()).to_string()));
            }
            check_output(path)?;
            if outputs.contains(path) {
                return Err(Failure::input(format!("{} is named twice", path.display())));
            }
        }
        let format = check_outputs(&outputs, args.format)?;
        if args.json && outputs.iter().any(|o| is_stream(o)) {
            let help = "write the picture to a file, or leave out --json";
            return Err(Failure::input("`-o -` and --json can't share standard output").help(help));
        }
        if args.scene.as_deref().is_some_and(|scene| outputs.iter().any(|o| is_same_file(o, scene))) {
            return Err(Failure::input("the picture would replace the scene"));
        }
        let has_exr = outputs.iter().any(|o| format_of(o, format) == Some(Format::Exr));
        Ok(Self {
            format,
            scene: args.scene,
            outputs,
            overrides: Overrides {
                spp: args.spp,
                size: args.size.map(|s| s.0),
                crop: args.crop.map(|c| c.0),
                seed: args.seed,
                noise: args.noise,
                pattern: args.sampler,
                max_depth: args.max_depth,
                spectral: args.spectral.then_some(true),
                recording: args.channels,
                error: Some(has_exr),
                splat: args.splat.then_some(true),
                threads: args.threads,
                accel: args.accel,
                build: args.build,
                isa: args.isa,
                batch: args.batch,
                shuffle_tiles: None,
                cost: (args.cost || args.cost_picture.is_some()).then_some(true),
            },
            time: args.time,
            replicates: args.replicates,
            cost_picture: args.cost_picture.map(|path| (path, args.cost_of)),
            look: args.look,
            quiet: args.quiet,
            json: args.json,
            lenient: args.lenient,
        })
    }

    /// How a scene's look is shown.
    pub fn look(&self, scene: Look) -> Look {
        self.look.over(scene)
    }

    /// Whether a look was asked for that none of the pictures has, nor an EXR remembers.
    pub fn look_is_lost(&self) -> bool {
        let shows = |o: &PathBuf| matches!(format_of(o, self.format), Some(Format::Png | Format::Exr));
        let has_png = self.outputs.iter().any(shows);
        self.look != LookArgs::default() && !has_png
    }
}

/// Whether a name stands for standard input or output.
pub fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// The format of what goes to a place, `stream` being that of standard output.
pub fn format_of(path: &Path, stream: Format) -> Option<Format> {
    if is_stream(path) { Some(stream) } else { Format::of(path).ok() }
}

/// Whether pictures can go to all these places; the format of what goes to standard output.
pub fn check_outputs(outputs: &[PathBuf], said: Option<Format>) -> Result<Format, Failure> {
    for (i, path) in outputs.iter().enumerate() {
        if outputs[..i].contains(path) {
            return Err(Failure::input(format!("{} is named twice", path.display())));
        }
        if is_stream(path) {
            if std::io::stdout().is_terminal() {
                let help = "send it on, as in `straal render scene.yaml -o - > picture.png`";
                return Err(Failure::input(
                    "`-o -` writes a picture to standard output, and that is a terminal",
                )
                .help(help));
            }
            continue;
        }
        Format::of(path).map_err(|e| Failure::input(e.to_string()))?;
        check_output(path)?;
    }
    if said.is_some() && !outputs.iter().any(|o| is_stream(o)) {
        let help = "the name of a file says its format, such as `-o picture.exr`";
        return Err(Failure::input("--format is for `-o -`, standard output").help(help));
    }
    Ok(said.unwrap_or(Format::Png))
}

/// The scene's name with .png, in the current folder.
fn default_output(scene: Option<&Path>) -> PathBuf {
    let stem = scene.filter(|path| !is_stream(path)).and_then(Path::file_stem).unwrap_or("straal".as_ref());
    let mut name = stem.to_owned();
    name.push(".png");
    name.into()
}

/// Whether a file can go there.
pub fn check_output(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::input(format!("{} is a folder", path.display())));
    }
    match path.parent() {
        Some(folder) if folder.exists() && !folder.is_dir() => {
            Err(Failure::input(format!("{} is not a folder", folder.display())))
        }
        Some(folder) if !folder.as_os_str().is_empty() && !folder.exists() => {
            let message = format!("there is no folder {} for {}", folder.display(), path.display());
            Err(Failure::input(message).help(format!("make it first: mkdir -p {}", folder.display())))
        }
        _ => atomic::check(path).map_err(|e| Failure::system(e.to_string())),
    }
}

/// Whether both names lead to one file.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{Command, CommandLine};
    use clap::Parser;
    use straal::{Exposure, Tone};

    fn settings(words: &str) -> Result<RenderSettings, Failure> {
        let words = ["straal", "render"].into_iter().chain(words.split_whitespace());
        match CommandLine::try_parse_from(words).unwrap().command {
            Command::Render(args) => RenderSettings::new(*args),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn pictures_are_called_after_the_scene() {
        assert_eq!(settings("").unwrap().outputs, [PathBuf::from("straal.png")]);
        assert_eq!(settings("some/where/bunny.v2.ply").unwrap().outputs, [PathBuf::from("bunny.v2.png")]);
        assert_eq!(settings("a.yaml -o b.EXR").unwrap().outputs, [PathBuf::from("b.EXR")]);
    }

    #[test]
    fn what_can_not_be_written_is_told_first() {
        for (words, complaint) in [
            ("-o a.jpg", "can't tell the format of a.jpg: the name must end in .exr, .png, .hdr or .pfm"),
            ("-o a", "can't tell the format of a: the name must end in .exr, .png, .hdr or .pfm"),
            ("-o Cargo.toml/a.png", "Cargo.toml is not a folder"),
            ("-o no/such/folder/a.png", "there is no folder no/such/folder for no/such/folder/a.png"),
            ("-o a.png -o b.exr -o a.png", "a.png is named twice"),
        ] {
            let failure = settings(words).unwrap_err();
            assert_eq!((failure.exit, failure.message.as_str()), (crate::exit::Exit::Input, complaint));
        }
    }

    #[test]
    fn a_look_is_the_scenes_unless_said_otherwise() {
        let scene = Look { exposure: Exposure::stops(1.0), tone: Tone::Filmic, ..Look::default() };
        assert_eq!(settings("").unwrap().look(scene), scene);
        let s = settings("--exposure -2 -o a.pfm").unwrap();
        assert_eq!(s.look(scene), Look { exposure: Exposure::stops(-2.0), ..scene });
        assert!(s.look_is_lost());
        assert!(!settings("--tone clamp -o a.pfm -o a.png").unwrap().look_is_lost());
        assert!(!settings("--tone clamp -o a.exr").unwrap().look_is_lost(), "an EXR remembers it");
        assert!(!settings("-o a.pfm").unwrap().look_is_lost());
    }
}
