//! What a command line for `straal render` means: the defaults filled in, and all that can be known to fail before a
//! ray is traced found out.

use crate::args::{DevelopmentArgs, RenderArgs};
use crate::command::frames;
use crate::exit::Failure;
use crate::keeping::Wish;
use crate::machine;
use crate::places::{check_output, check_pictures, format_of, is_stream, refuse_inputs, refuse_twins};
use crate::quantity::{Every, Frames, count};
use std::path::{Path, PathBuf};
use std::time::Duration;
use straal::picture::Format;
use straal::{Development, LoadOptions, Overrides};
use straal_study::{SaveError, cost};

/// What is lost at most when a render that writes an EXR is killed.
const BETWEEN_CHECKPOINTS: Duration = Duration::from_secs(60);

/// What is to be rendered, how, and where to.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// The file; `None` for the embedded scene.
    pub scene: Option<PathBuf>,
    /// Where the picture goes; nowhere if only sums are wanted.
    pub outputs: Vec<PathBuf>,
    /// The format of what goes to standard output, where one of the places is `-`.
    pub format: Format,
    /// The frames of a scene that moves, if several are rendered.
    pub frames: Option<Frames>,
    /// Where all frames go as one animation.
    pub animation: Option<PathBuf>,
    /// What wins over the scene.
    pub overrides: Overrides,
    /// The time that all of it may take.
    pub time: Option<Duration>,
    /// Independent sets of samples.
    pub replicates: Option<u32>,
    /// What is kept of it besides pictures.
    pub keep: Wish,
    /// Where the picture of the searches' costs goes, and which cost it shows.
    pub cost_picture: Option<(PathBuf, cost::Measure)>,
    /// Where the scene goes as a file.
    pub write_scene: Option<PathBuf>,
    /// Steps of development in place of the scene's.
    pub development: DevelopmentArgs,
    /// What is told before the render begins.
    pub note: Option<String>,
    /// Whether only errors are told.
    pub quiet: bool,
    /// Whether the result is told to a script.
    pub json: bool,
    /// How the scene is read.
    pub reading: LoadOptions,
}

impl RenderSettings {
    /// What the arguments mean, or why they can't be followed. Nothing stays on the disk.
    pub fn new(args: RenderArgs) -> Result<Self, Failure> {
        if let Some(isa) = args.isa.filter(|isa| !isa.is_available()) {
            let help = format!("without --isa the best there is is taken: {}", straal_accel::Isa::detect());
            return Err(Failure::input(format!("this processor has no {isa}")).help(help));
        }
        let of_one_render = [
            (args.samples.is_some(), "--samples"),
            (args.save_sums.is_some(), "--save-sums"),
            (args.resume, "--resume"),
            (args.checkpoint.is_some_and(|Every(time)| time.is_some()), "--checkpoint"),
        ]
        .into_iter()
        .find_map(|(is_said, option)| is_said.then_some(option));
        let (animations, given): (Vec<_>, Vec<_>) =
            args.output.into_iter().partition(|path| frames::is_animation(path));
        let animation = frames::animation(animations, args.frames.is_some())?;
        let outputs = match given {
            none if none.is_empty() && args.save_sums.is_none() && animation.is_none() => {
                vec![default_output(args.scene.as_deref())]
            }
            given => given,
        };
        if args.frames.is_some() && outputs.iter().any(|path| is_stream(path)) {
            let help = "name files: each frame goes to one of its own";
            return Err(Failure::input("frames can't go to standard output").help(help));
        }
        if let (Some(_), Some(option)) = (args.replicates, of_one_render) {
            let message = format!("{option} can't be used with --replicates");
            return Err(Failure::input(message).help(
                "replicates are renders of their own, of which the means are kept: where it is to be cut off, or shared \
                 out, render each with a --seed of its own",
            ));
        }
        if let Some(path) = &args.cost_picture {
            if !matches!(Format::of(path), Ok(Format::Png)) {
                return Err(Failure::input(SaveError::NotPng(path.display().to_string()).to_string()));
            }
            check_output(path)?;
        }
        let format = check_pictures(&outputs, args.format, args.json)?;
        if let Some(path) = &args.save_sums {
            check_output(path)?;
        }
        if let Some(path) = &args.write_scene {
            check_scene_output(path)?;
        }
        if let Some(option) = args.studio.first() {
            check_bare(option, args.scene.as_deref())?;
        }
        let all = || {
            outputs
                .iter()
                .chain(&args.cost_picture)
                .chain(&args.save_sums)
                .chain(&args.write_scene)
                .chain(&animation)
                .map(PathBuf::as_path)
        };
        refuse_twins(all())?;
        refuse_inputs(all(), args.scene.as_slice())?;
        let is_exr = |o: &&PathBuf| format_of(o, format) == Some(Format::Exr);
        let has_exr = outputs.iter().any(|o| is_exr(&o));
        let has_plain_exr =
            outputs.iter().filter(is_exr).any(|o| !is_stream(o) && (!o.exists() || o.is_file()));
        let is_long = has_plain_exr || args.save_sums.is_some() || args.resume;
        let by_default = (is_long && args.replicates.is_none()).then_some(BETWEEN_CHECKPOINTS);
        let keep = Wish {
            every: args.checkpoint.map_or(by_default, |Every(time)| time),
            is_said: args.checkpoint.is_some() || args.resume,
            resume: args.resume,
            sums: args.save_sums,
        };
        // What is put together later may become an EXR.
        let has_exr = has_exr || keep.sums.is_some();
        let (threads, note) = threads(args.threads);
        let size = args.size.map(|s| s.0);
        let reading = LoadOptions { studio: args.studio.studio(size), ..args.reading.options() };
        Ok(Self {
            format,
            scene: args.scene,
            outputs,
            frames: args.frames,
            animation,
            overrides: Overrides {
                spp: args.spp,
                samples: args.samples.map(|s| s.0),
                size,
                crop: args.crop.map(|c| c.0),
                seed: args.seed,
                noise: args.noise,
                pattern: args.sampler,
                integrator: args.integrator,
                max_depth: args.max_depth,
                clamp: args.clamp,
                spectral: args.spectral.then_some(true),
                recording: args.channels,
                error: Some(has_exr),
                layers: Some(has_exr),
                denoise: args.denoise,
                fireflies: args.fireflies,
                guides: args.guides,
                splat: args.splat.then_some(true),
                threads: Some(threads),
                accel: args.accel,
                build: args.build,
                isa: args.isa,
                batch: args.batch,
                shuffle_tiles: None,
                memory: reading.memory,
                cost: (args.cost || args.cost_picture.is_some()).then_some(true),
            },
            time: args.time,
            replicates: args.replicates,
            keep,
            cost_picture: args.cost_picture.map(|path| (path, args.cost_of)),
            write_scene: args.write_scene,
            development: args.development,
            note,
            quiet: args.quiet,
            json: args.json,
            reading,
        })
    }

    /// Those of one of several frames, whose number stands in the names of all that is written.
    pub fn of_frame(&self, frame: u32) -> Self {
        let mut of_frame = self.clone();
        let number = |path: &mut PathBuf| *path = frames::numbered(path, frame);
        of_frame.outputs.iter_mut().for_each(number);
        of_frame.keep.sums.iter_mut().for_each(number);
        of_frame.write_scene.iter_mut().for_each(number);
        of_frame.cost_picture.iter_mut().for_each(|(path, _)| number(path));
        of_frame.reading.frame = f64::from(frame);
        of_frame
    }

    /// Every file that is written.
    pub fn written(&self) -> impl Iterator<Item = &Path> {
        let cost = self.cost_picture.as_ref().map(|(path, _)| path);
        self.outputs.iter().chain(cost).chain(&self.keep.sums).chain(&self.write_scene).map(PathBuf::as_path)
    }

    /// How a scene's picture is developed.
    pub fn development(&self, scene: Development) -> Development {
        self.development.over(scene)
    }

    /// Whether development settings were given that none of the pictures shows, nor an EXR remembers.
    pub fn look_is_lost(&self) -> bool {
        let shows = |o: &PathBuf| matches!(format_of(o, self.format), Some(Format::Png | Format::Exr));
        let has_png = self.outputs.iter().any(shows);
        self.development != DevelopmentArgs::default() && !has_png
    }
}

/// Whether one of the pictures is an EXR, which holds more than colours.
pub fn has_exr(outputs: &[PathBuf]) -> Result<bool, Failure> {
    let formats: Result<Vec<_>, _> =
        outputs.iter().filter(|path| !is_stream(path)).map(|path| Format::of(path)).collect();
    let formats = formats.map_err(|e| Failure::input(e.to_string()))?;
    Ok(formats.contains(&Format::Exr))
}

/// Threads that are started, and what there is to say of that: as many as there are processors, or as were asked for. Far more than
/// there are processors only wait for one another.
pub fn threads(typed: Option<usize>) -> (usize, Option<String>) {
    let processors = machine::processors();
    let most = (4 * processors).max(64);
    match typed {
        None => (processors, None),
        Some(n) if n <= most => (n, None),
        Some(n) => {
            let cores = count(processors as u64, "processor");
            let note =
                format!("note: {n} threads would only wait for one another on {cores}: {most} are started");
            (most, Some(note))
        }
    }
}

/// Whether a scene can be written there.
fn check_scene_output(path: &Path) -> Result<(), Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if !matches!(extension.as_deref(), Some("yaml" | "yml")) {
        let message = format!("a scene is written as YAML: the name {} must end in .yaml", path.display());
        return Err(Failure::input(message));
    }
    check_output(path)
}

/// Whether what is rendered is a mesh without a scene, for which alone an option is.
fn check_bare(option: &str, scene: Option<&Path>) -> Result<(), Failure> {
    let what = match scene {
        Some(path) if straal::is_mesh(path) || is_stream(path) => return Ok(()),
        Some(path) => format!("{} is a scene, which", path.display()),
        None => "the scene that straal brings along".to_owned(),
    };
    let message = format!("{option} is for bare meshes (.ply, .obj, .stl): {what} says that itself");
    Err(Failure::input(message).help("change it in the scene; --write-scene gives one to begin with"))
}

/// The scene's name with .png, in the current folder.
fn default_output(scene: Option<&Path>) -> PathBuf {
    let stem = scene.filter(|path| !is_stream(path)).and_then(Path::file_stem).unwrap_or("straal".as_ref());
    let mut name = stem.to_owned();
    name.push(".png");
    name.into()
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
    fn threads_have_a_bound() {
        assert_eq!(threads(None), (machine::processors(), None));
        assert_eq!(threads(Some(3)), (3, None));
        let (started, note) = threads(Some(1 << 20));
        assert!(started < 1 << 20 && note.is_some_and(|n| n.contains(&format!("{started} are started"))));
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
        let scene =
            Development { exposure: Exposure::stops(1.0), tone: Tone::Filmic, ..Development::default() };
        assert_eq!(settings("").unwrap().development(scene), scene);
        let s = settings("--exposure -2 -o a.pfm").unwrap();
        assert_eq!(s.development(scene), Development { exposure: Exposure::stops(-2.0), ..scene });
        assert!(s.look_is_lost());
        assert!(!settings("--tone clamp -o a.pfm -o a.png").unwrap().look_is_lost());
        assert!(!settings("--tone clamp -o a.exr").unwrap().look_is_lost(), "an EXR remembers it");
        assert!(!settings("-o a.pfm").unwrap().look_is_lost());
    }
}
