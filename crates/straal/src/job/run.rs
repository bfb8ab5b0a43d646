//! A job's render: passes until all samples are taken, noise is low enough or the caller ends it.

use super::{Job, Snapshot};
use crate::denoise::Denoised;
use crate::picture::Picture;
use crate::resolve::{Error, PASS, passes};
use crate::sums::Kept;
use straal_render::driver::{Pause, Render};
use straal_render::film::{FIRST_CHECK, Film, MAX_SAMPLES, hash_of};
use straal_render::settings::Settings;
use straal_render::stopwatch::{Clock, Times};

/// What a caller lends to a render: a say in when it ends, and a clock.
pub struct Control<'a> {
    /// Called between passes; a pass adds the same number of samples to every pixel.
    pub progress: Option<&'a mut dyn FnMut(&Progress) -> Verdict>,
    /// To tell where the time goes; without it [`Outcome::times`] has ray counts only.
    pub clock: Option<Clock>,
    /// Whether to go on for as long as `progress` says, past the samples that the scene asks for.
    pub open_ended: bool,
    /// Sums of the same render up to some sample, to go on from; not in replicates.
    pub resume: Option<Kept>,
    /// Called between passes and at the end with what there is; not in replicates.
    pub keep: Option<&'a mut dyn FnMut(&Snapshot<'_>)>,
    /// Asked by all threads, time and again, whether `keep` should be shown what there is in the middle of a pass.
    pub pause: Option<Pause>,
    keep_on: bool,
}

impl<'a> Control<'a> {
    /// Renders all samples, says nothing.
    pub fn to_the_end() -> Self {
        Self {
            progress: None,
            clock: None,
            open_ended: false,
            resume: None,
            keep: None,
            pause: None,
            keep_on: true,
        }
    }

    /// Renders until all samples are taken or `progress` ends it.
    pub fn new(progress: &'a mut dyn FnMut(&Progress) -> Verdict) -> Self {
        Self { progress: Some(progress), ..Self::to_the_end() }
    }
}

/// Whether a render goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// With the next pass.
    GoOn,
    /// The picture so far is the result.
    Stop,
}

/// How far a render has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Samples per pixel taken, all replicates together.
    pub samples: u64,
    /// Samples per pixel to take in all.
    pub of: u64,
    /// Samples per pixel that the next pass will add; 0 after the last of a picture or replicate.
    pub next: u64,
    /// Pixels of the crop.
    pub pixels: u64,
    /// Rays traced so far, and time where a clock was lent.
    pub times: Times,
    /// How many blocks still need samples, where noise decides that; of the replicate under way.
    pub blocks: Option<Blocks>,
}

/// Blocks of 8 x 8 pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    /// Those that need further samples.
    pub left: u64,
    /// All of them.
    pub of: u64,
}

/// What a render leaves.
#[derive(Debug)]
pub struct Outcome {
    /// The picture with its layers and metadata.
    pub picture: Picture,
    /// Samples per pixel taken; of an adaptive render, of the pixels that have the most.
    pub samples: u32,
    /// Samples of a pixel on average.
    pub mean_samples: f64,
    /// Passes they were taken in.
    pub passes: u32,
    /// Whether all samples asked for were taken.
    pub complete: bool,
    /// Blocks of 8 x 8 pixels that are noisier than was asked, of an adaptive render; in replicates, of all of them together.
    pub noisy_blocks: u64,
    /// How it was denoised, where it was.
    pub denoised: Option<Denoised>,
    /// The share of the light that `clamp` took away, where it was asked for.
    pub clamped: Option<f64>,
    /// Rays, and time by phase where a clock was lent.
    pub times: Times,
    /// Worker threads.
    pub threads: usize,
    /// Samples that were not numbers or beyond the film's range, and where the first was: pixel, sample index.
    pub dropped: straal_render::film::Dropped,
}

/// A film and how it came about.
pub(crate) struct Run {
    pub film: Film,
    pub samples: u32,
    /// Whether there was nothing more to do.
    pub complete: bool,
    pub passes: u32,
    pub times: Times,
    pub threads: usize,
}

impl Job {
    /// Renders the picture.
    pub fn render(&self, control: &mut Control<'_>) -> Result<Outcome, Error> {
        if let Some(reason) = self.needs_count().filter(|_| control.open_ended) {
            return Err(Error::Request(reason));
        }
        let of = if control.open_ended { MAX_SAMPLES } else { self.spp };
        let mut progress = Progress { of: u64::from(of - self.first), ..self.progress() };
        let run = self.film(self.settings.seed, of, control, &mut progress)?;
        let mut picture = Picture::new(&run.film, run.film.layers(), self.film_space());
        picture.metadata = self.metadata(run.samples);
        picture.metadata.push(("straal.passes".into(), run.passes.to_string()));
        let clamped = picture.layers.clamped();
        let (mean_samples, dropped) = (run.film.mean_samples(), run.film.dropped());
        let noisy_blocks = self.noisy_blocks(&run.film);
        let denoised = match &self.denoise {
            Some(how) => {
                let halves = run.film.halves();
                // Sums are larger than the picture, and all that denoising takes wants their place.
                drop(run.film);
                let seen = self.seen(&picture.layers)?;
                Some(picture.denoise_apart(how, halves, seen)?)
            }
            None => None,
        };
        picture.metadata.push(("straal.film_hash".into(), hash_of(&picture.layers.rgb)));
        Ok(Outcome {
            picture,
            samples: run.samples,
            mean_samples,
            passes: run.passes,
            complete: control.open_ended || run.complete,
            noisy_blocks: match (&denoised, self.denoised_noise) {
                (Some(denoised), Some(target)) => denoised.blocks_noisier_than(target),
                _ => noisy_blocks,
            },
            denoised,
            clamped,
            times: run.times,
            threads: run.threads,
            dropped,
        })
    }

    /// Blocks of a film that are noisier than was asked.
    pub(crate) fn noisy_blocks(&self, film: &Film) -> u64 {
        if self.settings.adapts() { film.open_blocks() } else { 0 }
    }

    pub(crate) fn progress(&self) -> Progress {
        Progress { pixels: self.settings.crop.area() as u64, ..Progress::default() }
    }

    /// One film of samples up to `end` with a seed of its own.
    pub(crate) fn film(
        &self,
        seed: u64,
        end: u32,
        control: &mut Control<'_>,
        progress: &mut Progress,
    ) -> Result<Run, Error> {
        let settings = Settings { seed, ..self.settings.clone() };
        let mut render = Render::by(&self.world, self.integrator, settings, control.clock.clone())?;
        render.begin_at(self.first);
        if let Some(kept) = control.resume.take() {
            self.take_up(&mut render, kept, end)?;
        }
        let (before, times) = (progress.samples, progress.times);
        let adapts = self.settings.adapts();
        let all_blocks = self.noisy_blocks(render.film());
        if let (Some(pause), true) = (&control.pause, control.keep.is_some()) {
            render.pause_when(pause.clone());
        }
        let mut look = Look::new(self.denoised_noise, render.samples_done());
        let next_pass = |render: &Render<'_>, most: u32, look: &Look| {
            if render.is_settled() {
                0
            } else {
                // Where few pixels are left, a pass takes more of each: going through the picture costs as much as some samples.
                let most = most.saturating_mul(if adapts { render.film().sparsity() } else { 1 });
                look.pass(most, render.samples_done()).min(end - render.samples_done())
            }
        };
        let mut next = next_pass(&render, if render.samples_done() == self.first { 1 } else { PASS }, &look);
        while next > 0 && control.keep_on {
            render.advance(next);
            while render.is_midway() {
                self.show(&render, control, [false, false]);
                render.advance(0);
            }
            look.at(self, &mut render)?;
            next = next_pass(&render, PASS, &look);
            progress.samples = before + u64::from(render.samples_done() - self.first);
            progress.next = u64::from(next);
            progress.times = times;
            progress.times += render.times();
            progress.blocks =
                adapts.then(|| Blocks { left: self.noisy_blocks(render.film()), of: all_blocks });
            control.keep_on = control.progress.as_mut().is_none_or(|say| say(progress) == Verdict::GoOn);
            if next > 0 && control.keep_on {
                self.show(&render, control, [false, false]);
            }
        }
        // Time is the end of what has no other; of what noise should end, it is too early.
        let ends_by_time = control.open_ended && !adapts;
        self.show(&render, control, [true, next == 0 || ends_by_time]);
        let samples = render.samples_done() - self.first;
        Ok(Run {
            samples,
            complete: next == 0,
            passes: passes(samples),
            times: render.times(),
            threads: render.threads(),
            film: render.into_film(),
        })
    }
}

/// When a denoised picture is looked at, to end the blocks that are good enough: with 32, 64, 128, ... samples. A look costs as much as some
/// samples, so that twice as many are taken before the next.
struct Look {
    /// The noise that is wanted.
    target: Option<f64>,
    /// Samples of the next look.
    next: u32,
}

impl Look {
    fn new(target: Option<f64>, done: u32) -> Self {
        let next = if done < FIRST_CHECK { FIRST_CHECK } else { (done + 1).next_power_of_two() };
        Self { target, next }
    }

    /// Samples of the next pass, so that it ends where a look comes.
    fn pass(&self, most: u32, done: u32) -> u32 {
        if self.target.is_some() { most.min(self.next - done) } else { most }
    }

    /// Looks at the film, where that is due.
    fn at(&mut self, job: &Job, render: &mut Render<'_>) -> Result<(), Error> {
        let (Some(target), Some(how)) = (self.target, &job.denoise) else { return Ok(()) };
        if render.samples_done() < self.next {
            return Ok(());
        }
        self.next = self.next.saturating_mul(2);
        let film = render.film();
        let mut picture = Picture::new(film, film.layers(), job.film_space());
        // Groups of lights are for the finished picture.
        picture.layers.groups.clear();
        let seen = job.seen(&picture.layers)?;
        let denoised = picture.denoise_apart(how, film.halves(), seen)?;
        let crop = job.settings.crop;
        render.end_blocks(|first| denoised.noise_at(crop, first).is_some_and(|noise| noise <= target));
        Ok(())
    }
}
