//! `straal merge`

use super::{Writing, print};
use crate::args::{DevelopmentArgs, MergeArgs};
use crate::exit::{Exit, Failure};
use crate::interrupt::Interrupt;
use crate::out;
use crate::places::{check_output, refuse_inputs, refuse_twins};
use crate::quantity::count;
use serde_json::json;
use std::path::PathBuf;
use straal::picture::Format;
use straal::sums::{self, Allowed, Kept, Merged, SumsError};

/// Puts parts of a picture together.
pub fn run(args: &MergeArgs, interrupt: &Interrupt) -> Result<Exit, Failure> {
    let outputs = || args.output.iter().map(PathBuf::as_path);
    let mut has_look = false;
    for path in &args.output {
        let format = Format::of(path).map_err(|e| Failure::input(e.to_string()))?;
        has_look |= matches!(format, Format::Png | Format::Exr);
        check_output(path)?;
    }
    refuse_twins(outputs())?;
    refuse_inputs(outputs(), &args.sums)?;
    if args.development != DevelopmentArgs::default() && !has_look && !args.quiet {
        out::say("warning: how a PNG is developed was said, but neither a PNG nor an EXR is written\n");
    }
    let allowed = Allowed { gaps: args.allow_gaps, memory: args.memory.limit() };
    let opened: Result<Vec<Kept>, SumsError> = args.sums.iter().map(|path| Kept::open(path)).collect();
    let Merged { picture, development, samples, gaps } =
        opened.and_then(|parts| sums::merge(parts, allowed)).map_err(|e| failure(&e))?;
    if !args.quiet {
        for gap in &gaps {
            out::say(&format!("warning: {gap}\n"));
        }
    }
    let development = args.development.over(development);
    let mut writing = Writing::default();
    for path in &args.output {
        writing.note(path, interrupt.whole(|| picture.save(path, &development)));
    }
    writing.end()?;
    let hash = picture.tells("film_hash").unwrap_or_default();
    if !args.quiet {
        let names: Vec<String> = args.output.iter().map(|p| p.display().to_string()).collect();
        out::say(&format!(
            "wrote {}: {}\nfilm hash {hash}\n",
            names.join(", "),
            count(samples.into(), "sample")
        ));
    }
    if args.json {
        let text =
            |paths: &[PathBuf]| paths.iter().map(|p| p.to_string_lossy().into_owned()).collect::<Vec<_>>();
        let corners = [picture.crop.min, picture.crop.max].concat();
        let told = json!({
            "pictures": text(&args.output),
            "sums": text(&args.sums),
            "film_hash": hash,
            "scene_hash": picture.tells("scene_hash"),
            "size": picture.size,
            "crop": corners,
            "samples": samples,
            "gaps": gaps,
            "version": straal::VERSION,
        });
        print(&format!("{told:#}\n"))?;
    }
    Ok(Exit::Fine)
}

fn failure(error: &SumsError) -> Failure {
    let failure = Failure::input(error.to_string());
    match error {
        SumsError::Memory(shortage) => Failure::memory(shortage),
        SumsError::Gaps(_) => failure.help("to have the picture all the same, say --allow-gaps"),
        _ => failure,
    }
}
