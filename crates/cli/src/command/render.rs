//! `straal render`

use super::{load, print, refused, warn};
use crate::args::RenderArgs;
use crate::complaint;
use crate::exit::{Exit, Failure};
use crate::interrupt::Interrupt;
use crate::out;
use crate::progress::{Pace, Teller};
use crate::quantity::{count, tell_percent};
use crate::report::Report;
use crate::settings::{RenderSettings, is_stream};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use straal::job::Verdict;
use straal::picture::SaveError;
use straal::{Control, EMBEDDED_SCENE, Job, LoadOptions, Loaded, Outcome, Progress};

/// Renders a scene; `start` is when the command began.
pub fn run(args: RenderArgs, start: Instant) -> Result<Exit, Failure> {
    let settings = RenderSettings::new(args)?;
    let interrupt = Interrupt::listen();
    let loaded = scene(&settings)?;
    let mut warnings = loaded.warnings.clone();
    let job = Job::new(loaded, settings.overrides.clone()).map_err(|e| refused(e, &warnings))?;
    warn(&mut warnings, &job);
    if !settings.quiet {
        out::say(&complaint::show(&warnings, out::has_colours()));
        if settings.look_is_lost() {
            out::say("warning: how a PNG is developed was said, but neither a PNG nor an EXR is written\n");
        }
    }
    if let Some(reason) = job.needs_count().filter(|_| settings.time.is_some()) {
        return Err(Failure::input(reason).help("leave out --time, or choose another --sampler"));
    }

    let rendering = Instant::now();
    let outcome = render(&job, &settings, &interrupt, start).map_err(|e| refused(e, &warnings))?;
    let render_seconds = rendering.elapsed().as_secs_f64();

    let look = settings.look(job.look());
    for path in &settings.outputs {
        if is_stream(path) {
            let format = settings.format;
            let written = interrupt.whole(|| out::picture(|to| outcome.picture.write(to, format, &look)));
            written.map_err(|e| Failure::system(format!("can't write to standard output: {e}")))?;
        } else {
            interrupt.whole(|| outcome.picture.save(path, &look)).map_err(|e| not_saved(&e))?;
        }
    }
    if let Some((path, of)) = &settings.cost_picture {
        interrupt.whole(|| outcome.picture.save_cost(path, *of)).map_err(|e| not_saved(&e))?;
    }
    let report = Report {
        pictures: &settings.outputs,
        job: &job,
        outcome: &outcome,
        warnings: &warnings,
        interrupted: interrupt.is_asked(),
        seconds: start.elapsed().as_secs_f64(),
        render_seconds,
        cpu_seconds: None,
        peak_memory_bytes: None,
    }
    .measured();
    if !settings.quiet {
        out::say(&report.tell());
    }
    if settings.json {
        print(&format!("{:#}\n", report.as_json()))?;
    }
    Ok(if report.interrupted { Exit::Interrupted } else { Exit::Fine })
}

fn scene(settings: &RenderSettings) -> Result<Loaded, Failure> {
    let options = LoadOptions { lenient: settings.lenient, ..LoadOptions::default() };
    match &settings.scene {
        Some(path) => load(path, &options),
        None => straal::load_str("the embedded scene", EMBEDDED_SCENE, Path::new(""), &options)
            .map_err(Failure::scene),
    }
}

/// Renders until all samples are taken, the time is up or Ctrl-C is pressed.
fn render(
    job: &Job,
    settings: &RenderSettings,
    interrupt: &Interrupt,
    start: Instant,
) -> Result<Outcome, straal::Error> {
    let rendering = Instant::now();
    let until_done = settings.time.is_some() || settings.overrides.noise.is_some();
    let open_ended = until_done && settings.overrides.spp.is_none() && settings.replicates.is_none();
    let of = u64::from(job.spp) * u64::from(settings.replicates.unwrap_or(1));
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
    let mut after_pass = |progress: &Progress| {
        let pace = teller.pass(progress);
        if interrupt.is_asked() || !pace.has_time_for(progress.next) { Verdict::Stop } else { Verdict::GoOn }
    };
    let mut control = Control::new(&mut after_pass);
    control.clock = Some(Arc::new(move || u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX)));
    control.open_ended = open_ended;
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
    if most < straal::FIRST_LOOK {
        return format!(
            "warning: no block can be found to be within {percent} of noise: that is looked at first after {} samples, and no \
             pixel gets more than {limit}",
            straal::FIRST_LOOK
        );
    }
    format!(
        "until the noise of each block of 8 x 8 pixels is at most {percent}; no pixel gets more than {limit}"
    )
}

fn not_saved(error: &SaveError) -> Failure {
    Failure::system(error.to_string())
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
