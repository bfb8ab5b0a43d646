//! `straal render`

use super::{Writing, frames, load, print, refused, warn};
use crate::args::RenderArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::interrupt::{Cause, Interrupt};
use crate::keeping::{ANEW, Keeping};
use crate::out;
use crate::places::refuse_inputs;
use crate::progress::{Pace, Teller, while_reading};
use crate::quantity::{count, tell_percent};
use crate::report::Report;
use crate::settings::RenderSettings;
use serde_json::Value as Json;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use straal::sums::Kept;
use straal::written;
use straal::{
    Control, Development, EMBEDDED_SCENE, Job, Loaded, Outcome, Picture, Progress, Snapshot, Verdict,
};
use straal_formats::atomic;
use straal_study::cost;

/// Renders a scene; `start` is when the command began.
pub fn run(args: RenderArgs, start: Instant, interrupt: &Interrupt) -> Result<Exit, Failure> {
    let settings = RenderSettings::new(args)?;
    if let Some(wanted) = settings.frames {
        return frames::run(&settings, wanted, start, interrupt);
    }
    let (exit, report, _) = one(&settings, start, interrupt, (None, &mut |_, _| Ok(())))?;
    if settings.json {
        print(&format!("{report:#}\n"))?;
    }
    Ok(exit)
}

/// What takes a picture and how it is developed, besides the files that it goes to.
pub type Taker<'a> = dyn FnMut(&Picture, &Development) -> std::io::Result<()> + 'a;

/// Renders one picture, perhaps after another; gives what is told to scripts of it, and what it was rendered from.
pub fn one(
    settings: &RenderSettings,
    start: Instant,
    interrupt: &Interrupt,
    (before, taker): (Option<Job>, &mut Taker<'_>),
) -> Result<(Exit, Json, Job), Failure> {
    let loaded = scene(settings)?;
    refuse_inputs(settings.written(), &loaded.files)?;
    let scene = settings.write_scene.is_some().then(|| scene_text(&loaded, settings)).transpose()?;
    let mut warnings = loaded.warnings.clone();
    let job = Job::after(before, loaded, &settings.overrides).map_err(|e| refused(e, &warnings))?;
    warn(&mut warnings, &job);
    if !settings.quiet {
        if let Some(note) = &settings.note {
            out::say(&format!("{note}\n"));
        }
        out::say(&complaint::show(&warnings, out::has_colours()));
        if settings.look_is_lost() {
            out::say("warning: how a PNG is developed was said, but neither a PNG nor an EXR is written\n");
        }
    }
    if let Some(reason) = job.needs_count().filter(|_| settings.time.is_some()) {
        return Err(Failure::input(reason).help("leave out --time, or choose another --sampler"));
    }

    if let (Some(path), Some(text)) = (&settings.write_scene, scene) {
        atomic::write(path, |out| out.write_all(text.as_bytes()))
            .map_err(|e| Failure::system(e.to_string()))?;
        if !settings.quiet {
            out::say(&format!("wrote {0}: `straal render {0}` gives this picture\n", path.display()));
        }
    }

    let (mut keeping, kept) = Keeping::new(&settings.keep, &settings.outputs, interrupt, settings.quiet)?;
    let rendering = Instant::now();
    let outcome = render(&job, settings, interrupt, (start, kept, &mut keeping)).map_err(|e| {
        let failure = refused(e, &warnings);
        if settings.keep.resume && failure.help.is_none() { failure.help(ANEW) } else { failure }
    })?;
    let render_seconds = rendering.elapsed().as_secs_f64();
    let interrupted = interrupt.asked().map(Cause::name);
    interrupt.render_ends();

    let development = settings.development(job.development());
    let mut writing = Writing::default();
    if let Some((path, done)) = keeping.sums() {
        writing.note(path, done);
    }
    for path in &settings.outputs {
        let picture = &outcome.picture;
        interrupt.whole(|| {
            writing.picture(
                path,
                |to| picture.write(to, settings.format, &development),
                |path| picture.save(path, &development),
            );
        });
    }
    if interrupted.is_none() {
        taker(&outcome.picture, &development).map_err(|e| Failure::system(e.to_string()))?;
    }
    if let Some((path, of)) = &settings.cost_picture {
        writing.note(path, interrupt.whole(|| cost::save(&outcome.picture, path, *of)));
    }
    let written = writing.end();
    let kept = keeping.end(&job, written.is_ok());
    written?;
    let report = Report {
        pictures: &settings.outputs,
        job: &job,
        outcome: &outcome,
        warnings: &warnings,
        interrupted,
        kept: &kept,
        seconds: start.elapsed().as_secs_f64(),
        render_seconds,
        cpu_seconds: None,
        peak_memory_bytes: None,
    }
    .measured();
    if !settings.quiet {
        out::say(&report.tell());
    }
    let exit = if interrupted.is_some() { Exit::Interrupted } else { Exit::Fine };
    let report = report.as_json();
    Ok((exit, report, job))
}

/// The scene as a file says it.
pub fn scene(settings: &RenderSettings) -> Result<Loaded, Failure> {
    let options = &settings.reading;
    match &settings.scene {
        Some(path) => while_reading(settings.quiet, options, |options| load(path, options)),
        None => straal::load_str("the embedded scene", EMBEDDED_SCENE, Path::new(""), options)
            .map_err(Failure::scene),
    }
}

/// The scene as a file of its own, with all that was said on the command line.
fn scene_text(loaded: &Loaded, settings: &RenderSettings) -> Result<String, Failure> {
    if let Some(held) = loaded.held.first() {
        let message =
            format!("the scene's own file holds meshes or pictures, such as `{held}`, which one text can't");
        return Err(Failure::input(message).help("`straal convert` writes them beside the scene"));
    }
    let development = settings.development(Development::of(&loaded.scene.film));
    let scene = written::scene(loaded, &settings.overrides, &development)
        .map_err(|e| refused(e, &loaded.warnings))?;
    if settings.scene.is_none() && scene == loaded.scene {
        // With its comments.
        return Ok(EMBEDDED_SCENE.to_owned());
    }
    // What a scene names is beside it; a bare mesh is named from the current folder.
    let beside = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    let base =
        settings.scene.as_deref().filter(|path| !straal::is_mesh(path)).map(beside).unwrap_or_default();
    let folder = settings.write_scene.as_deref().map(beside).unwrap_or_default();
    Ok(written::text(&scene, &base, &folder))
}

/// Renders until all samples are taken, the time is up or Ctrl-C is pressed.
fn render(
    job: &Job,
    settings: &RenderSettings,
    interrupt: &Interrupt,
    (start, kept, keeping): (Instant, Option<Kept>, &mut Keeping<'_>),
) -> Result<Outcome, straal::Error> {
    let rendering = Instant::now();
    let until_done = settings.time.is_some() || settings.overrides.noise.is_some();
    let is_counted = settings.overrides.spp.is_some() || settings.overrides.samples.is_some();
    let open_ended = until_done && !is_counted && settings.replicates.is_none();
    // What was there before took no time of this render.
    let resumed = u64::from(keeping.resumed());
    let spp = u64::from(job.spp - job.first).saturating_sub(resumed);
    let of = spp * u64::from(settings.replicates.unwrap_or(1));
    let pace = Pace {
        of: (!open_ended).then_some(of),
        limit: settings.time.map(|t| t.saturating_sub(rendering - start).as_secs_f64()),
        ..Pace::default()
    };
    let teller = Teller::new(rendering, pace, settings.quiet);
    let mut teller = if settings.replicates.is_some() { teller.of_replicates() } else { teller };
    interrupt.render_begins(teller.announcer());
    teller.announcer().say(&begins(job));
    if let Some(noise) = job.settings.noise {
        let most = if open_ended { straal::MAX_SAMPLES } else { job.spp };
        teller.announcer().say(&ends_by_noise(noise, most));
    }
    if let Some(noise) = job.denoised_noise {
        let most = if open_ended { straal::MAX_SAMPLES } else { job.spp };
        teller.announcer().say(&format!(
            "until each block of 8 x 8 pixels of the denoised picture is within {} of the truth, by its own estimate; no pixel \
             gets more than {}",
            tell_percent(noise),
            count(most.into(), "sample")
        ));
    }
    let mut after_pass = |progress: &Progress| {
        let progress = &Progress { samples: progress.samples.saturating_sub(resumed), ..*progress };
        let pace = teller.pass(progress);
        if interrupt.asked().is_some() || !pace.has_time_for(progress.next) {
            Verdict::Stop
        } else {
            Verdict::GoOn
        }
    };
    let mut control = Control::new(&mut after_pass);
    control.clock = Some(Arc::new(move || u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)));
    control.open_ended = open_ended;
    control.resume = kept;
    control.pause = keeping.pause();
    let is_wanted = keeping.is_wanted();
    let mut keep = |snapshot: &Snapshot<'_>| keeping.look(snapshot);
    if is_wanted {
        control.keep = Some(&mut keep);
    }
    let outcome = match settings.replicates {
        Some(replicates) => job.render_replicates(replicates, &mut control),
        None => job.render(&mut control),
    };
    teller.end();
    outcome
}

/// What is said when the first ray flies.
fn begins(job: &Job) -> String {
    let region = &job.settings.crop;
    let (width, height) = (region.width(), region.height());
    format!("rendering {width} x {height} pixels, searching by {} on {}", job.structure(), job.isa())
}

/// What is said of when noise ends a render, and what else does.
fn ends_by_noise(noise: f64, most: u32) -> String {
    let percent = tell_percent(noise);
    let limit = count(most.into(), "sample");
    if most < straal::FIRST_CHECK {
        return format!(
            "warning: no block can be found to be within {percent} of noise: that is looked at first after {} samples, and no \
             pixel gets more than {limit}",
            straal::FIRST_CHECK
        );
    }
    format!(
        "until the noise of each block of 8 x 8 pixels is at most {percent}; no pixel gets more than {limit}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_of_samples_is_told() {
        assert_eq!(
            ends_by_noise(0.07, 262_144),
            "until the noise of each block of 8 x 8 pixels is at most 7 %; no pixel gets more than 262,144 samples"
        );
        let warning = ends_by_noise(0.005, 31);
        assert!(warning.starts_with("warning: ") && warning.ends_with("no pixel gets more than 31 samples"));
    }
}
