//! `straal develop`

use super::{print, read_bytes};
use crate::args::{DevelopArgs, LookArgs};
use crate::exit::{Exit, Failure};
use crate::out;
use crate::settings::{check_outputs, format_of, is_same_file, is_stream};
use serde_json::json;
use std::path::PathBuf;
use straal::develop::Plate;
use straal::focus::Blur;
use straal::picture::Format;
use straal_formats::Limits;

/// Develops a picture again.
pub fn run(args: &DevelopArgs) -> Result<Exit, Failure> {
    let stream = check_outputs(&args.output, args.format)?;
    if args.json && args.output.iter().any(|o| is_stream(o)) {
        let help = "write the picture to a file, or leave out --json";
        return Err(Failure::input("`-o -` and --json can't share standard output").help(help));
    }
    let shows = |o: &PathBuf| matches!(format_of(o, stream), Some(Format::Png | Format::Exr));
    let has_png = args.output.iter().any(shows);
    if let Some(path) = args.output.iter().find(|o| is_same_file(o, &args.picture)) {
        return Err(Failure::input(format!("{} would replace the picture it is made from", path.display())));
    }
    if args.look != LookArgs::default() && !has_png && !args.quiet {
        out::say("warning: how a PNG is developed was said, but neither a PNG nor an EXR is written\n");
    }
    let name = args.picture.display();
    let bytes = read_bytes(&args.picture)?;
    let mut plate = Plate::read(&bytes, &Limits::default())
        .map_err(|e| Failure::input(format!("can't read {name}: {e}")))?;
    if let Some(lens) = args.depth_of_field {
        let spanned = args.fov.map(|degrees| Blur::focal_pixels(plate.size()[0], degrees));
        let Some(focal_pixels) = spanned.or(plate.focal_pixels()) else {
            let help = "say it by --fov DEGREES";
            return Err(Failure::input(format!("{name} doesn't tell its field of view")).help(help));
        };
        plate
            .blur(&Blur { lens, focal_pixels })
            .map_err(|e| Failure::input(format!("can't blur {name}: {e}")))?;
    }
    let look = args.look.over(plate.look());
    for path in &args.output {
        if is_stream(path) {
            let written = out::picture(|to| plate.write(to, stream, &look));
            written.map_err(|e| Failure::system(format!("can't write to standard output: {e}")))?;
        } else {
            plate.save(path, &look).map_err(|e| Failure::system(e.to_string()))?;
        }
    }
    if !args.quiet {
        let names: Vec<String> = args.output.iter().map(|p| p.display().to_string()).collect();
        out::say(&format!("wrote {}\n", names.join(", ")));
    }
    if args.json {
        let names: Vec<_> = args.output.iter().map(|p| p.to_string_lossy()).collect();
        print(&format!(
            "{:#}\n",
            json!({ "pictures": names, "size": plate.size(), "look": look.to_string() })
        ))?;
    }
    Ok(Exit::Fine)
}
