//! The frames of a scene that moves, one after the other: `straal render --frames`.

use super::{print, render};
use crate::exit::{Exit, Failure};
use crate::interrupt::Interrupt;
use crate::out;
use crate::quantity::Frames;
use crate::settings::RenderSettings;
use serde_json::json;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Instant;
use straal::Shelf;
use straal::picture::Format;
use straal_formats::atomic;
use straal_formats::image::apng;

/// Whether a picture is to be an animation, by its name.
pub fn is_animation(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("apng"))
}

/// The one animation that is to be written, if any.
pub fn animation(named: Vec<PathBuf>, has_frames: bool) -> Result<Option<PathBuf>, Failure> {
    match named.as_slice() {
        [] => Ok(None),
        [one] if has_frames => {
            crate::places::check_output(one)?;
            Ok(Some(one.clone()))
        }
        [one] => {
            let message = format!("{} is an animation, and one frame is rendered", one.display());
            Err(Failure::input(message).help("say which: --frames 0..48, or --frames all"))
        }
        [first, second, ..] => {
            let message = format!("{} and {} are the same animation", first.display(), second.display());
            Err(Failure::input(message).help("name one of them"))
        }
    }
}

/// A file's name with the number of a frame: in place of its last # signs, else before its ending.
pub fn numbered(path: &Path, frame: u32) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let name = match name.rfind('#') {
        Some(last) => {
            let first = name[..last].trim_end_matches('#').len();
            let width = last + 1 - first;
            format!("{}{frame:0width$}{}", &name[..first], &name[last + 1..])
        }
        None => match name.rsplit_once('.') {
            Some((stem, extension)) => format!("{stem}.{frame:04}.{extension}"),
            None => format!("{name}.{frame:04}"),
        },
    };
    path.with_file_name(name)
}

/// Renders frames until all are done or a signal comes.
pub fn run(
    settings: &RenderSettings,
    wanted: Frames,
    start: Instant,
    interrupt: &Interrupt,
) -> Result<Exit, Failure> {
    // Files are read, and structures of what stays are built, once for all frames.
    let mut settings = settings.clone();
    settings.reading.shelf = Shelf::new();
    let settings = &settings;
    let played = render::scene(settings)?.scene.animation;
    let frames: Range<u32> = match wanted {
        Frames::All => 0..played.frames,
        Frames::Some([first, end]) => first..end,
    };
    let (mut exit, mut reports, mut shown) = (Exit::Fine, Vec::new(), Vec::new());
    let mut before = None;
    let count = frames.len();
    for (i, frame) in frames.enumerate() {
        let of_frame = settings.of_frame(frame);
        let is_there = |path: &PathBuf| path.exists();
        if settings.keep.resume && settings.animation.is_none() && of_frame.outputs.iter().all(is_there) {
            if !settings.quiet {
                out::say(&format!("frame {frame} is there\n"));
            }
            continue;
        }
        if !settings.quiet {
            out::say(&format!("frame {frame}, {} of {count}\n", i + 1));
        }
        let began = if i == 0 { start } else { Instant::now() };
        let mut take = |picture: &straal::Picture, development: &straal::Development| {
            if settings.animation.is_some() {
                let mut png = Vec::new();
                picture.write(&mut png, Format::Png, development)?;
                shown.push(png);
            }
            Ok(())
        };
        let (ended, report, job) = render::one(&of_frame, began, interrupt, (before.take(), &mut take))?;
        reports.push(report);
        before = Some(job);
        exit = ended;
        if exit == Exit::Interrupted {
            break;
        }
    }
    if let Some(path) = settings.animation.as_ref().filter(|_| !shown.is_empty()) {
        interrupt
            .whole(|| atomic::write(path, |out| apng::write(out, &shown, played.fps)))
            .map_err(|e| Failure::system(e.to_string()))?;
        if !settings.quiet {
            out::say(&format!(
                "wrote {}: {} at {} a second\n",
                path.display(),
                crate::quantity::count(shown.len() as u64, "frame"),
                played.fps
            ));
        }
    }
    if settings.json {
        print(&format!("{:#}\n", json!({ "frames": reports })))?;
    }
    Ok(exit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_where_the_name_says() {
        for (name, want) in [
            ("a.png", "a.0007.png"),
            ("film/a.####.exr", "film/a.0007.exr"),
            ("a#.png", "a7.png"),
            ("##/a##b.c.png", "##/a07b.c.png"),
            ("a", "a.0007"),
        ] {
            assert_eq!(numbered(Path::new(name), 7), PathBuf::from(want), "{name}");
        }
        assert_eq!(numbered(Path::new("a.##.png"), 12345), PathBuf::from("a.12345.png"));
    }

    #[test]
    fn an_animation_has_frames() {
        assert!(is_animation(Path::new("a.APNG")) && !is_animation(Path::new("a.png")));
        let failure = animation(vec!["a.apng".into()], false).unwrap_err();
        assert_eq!(failure.message, "a.apng is an animation, and one frame is rendered");
        assert!(animation(vec!["a.apng".into(), "b.apng".into()], true).is_err());
    }
}
