//! `straal develop`

use super::{Writing, print, read_picture};
use crate::args::{DevelopArgs, DevelopmentArgs};
use crate::exit::{Exit, Failure};
use crate::out;
use crate::places::{check_pictures, format_of, refuse_inputs, refuse_twins};
use serde_json::json;
use std::path::PathBuf;
use straal::develop::PictureFile;
use straal::focus::Blur;
use straal::picture::Format;

/// What was guessed when the picture was read, and what of it is no light.
fn warn(args: &DevelopArgs, picture_file: &PictureFile) {
    let name = args.picture.display();
    let faults = picture_file.faults();
    let nan = faults.nan.told("no number (NaN)", "black in a PNG and an HDR, NaN in an EXR and a PFM");
    let infinite = "white in a PNG, the largest number of an HDR, infinite in an EXR and a PFM";
    let infinite = faults.infinite.told("infinite", infinite);
    for note in picture_file.notes().iter().chain(&nan).chain(&infinite) {
        out::say(&format!("warning: {name}: {note}\n"));
    }
}

/// Develops a picture again.
pub fn run(args: &DevelopArgs) -> Result<Exit, Failure> {
    let stream = check_pictures(&args.output, args.format, args.json)?;
    let shows = |o: &PathBuf| matches!(format_of(o, stream), Some(Format::Png | Format::Exr));
    let has_png = args.output.iter().any(shows);
    let outputs = || args.output.iter().map(PathBuf::as_path);
    refuse_twins(outputs())?;
    refuse_inputs(outputs(), std::slice::from_ref(&args.picture))?;
    if args.development != DevelopmentArgs::default() && !has_png && !args.quiet {
        out::say("warning: how a PNG is developed was said, but neither a PNG nor an EXR is written\n");
    }
    let name = args.picture.display();
    let bytes = read_picture(&args.picture)?;
    let limits = super::picture_limits();
    let picture_file = match &args.layer {
        Some(layer) => PictureFile::read_layer(&bytes, &limits, layer),
        None => PictureFile::read(&bytes, &limits),
    };
    let mut picture_file = picture_file.map_err(|e| Failure::input(format!("can't read {name}: {e}")))?;
    if !args.light_group.is_empty() {
        picture_file
            .relight(&args.light_group)
            .map_err(|e| Failure::input(format!("can't relight {name}: {e}")))?;
    }
    if !args.quiet {
        warn(args, &picture_file);
    }
    if let Some(lens) = args.depth_of_field {
        let spanned = args.fov.map(|degrees| Blur::focal_pixels(picture_file.size()[0], degrees));
        let Some(focal_pixels) = spanned.or(picture_file.focal_pixels()) else {
            let help = "say it by --fov DEGREES";
            return Err(Failure::input(format!("{name} doesn't tell its field of view")).help(help));
        };
        picture_file
            .blur(&Blur { lens, focal_pixels })
            .map_err(|e| Failure::input(format!("can't blur {name}: {e}")))?;
    }
    let development = args.development.over(picture_file.development());
    let mut writing = Writing::default();
    for path in &args.output {
        writing.picture(
            path,
            |to| picture_file.write(to, stream, &development),
            |path| picture_file.save(path, &development),
        );
    }
    writing.end()?;
    if !args.quiet {
        let names: Vec<String> = args.output.iter().map(|p| p.display().to_string()).collect();
        out::say(&format!("wrote {}\n", names.join(", ")));
    }
    if args.json {
        let names: Vec<_> = args.output.iter().map(|p| p.to_string_lossy()).collect();
        let report = json!({ "pictures": names, "size": picture_file.size(), "look": development.to_string(), "notes": picture_file.notes() });
        print(&format!("{report:#}\n"))?;
    }
    Ok(Exit::Fine)
}
