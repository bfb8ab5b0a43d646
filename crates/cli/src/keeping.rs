//! What is kept of a render so that nothing is lost: its checkpoint while it goes on, its sums at the end.

use crate::exit::Failure;
use crate::interrupt::Interrupt;
use crate::out;
use crate::quantity::count;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};
use straal::sums::Kept;
use straal::{Job, Pause, Snapshot};
use straal_formats::atomic::{self, WriteError};

/// What is to be kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wish {
    /// How often a checkpoint is written, if at all.
    pub every: Option<Duration>,
    /// Whether that was said, or the render goes on from one: then what an interrupted render has is kept even if it went on
    /// for less than that.
    pub is_said: bool,
    /// Whether to go on from a checkpoint.
    pub resume: bool,
    /// Where sums go at the end.
    pub sums: Option<PathBuf>,
}

fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

/// Where the checkpoint of a render is that writes `result`.
pub fn checkpoint_of(result: &Path) -> PathBuf {
    let mut name = result.as_os_str().to_owned();
    name.push(".checkpoint");
    name.into()
}

/// Keeps what a wish says.
pub struct Keeping<'a> {
    interrupt: &'a Interrupt,
    wish: &'a Wish,
    /// Where the checkpoint goes.
    path: PathBuf,
    began: Instant,
    /// When the next checkpoint is due, in milliseconds since the beginning.
    due: Arc<AtomicU64>,
    /// Whether the present state is kept since a signal came.
    is_safe: Arc<AtomicBool>,
    is_quiet: bool,
    /// Samples of each pixel that the render goes on from.
    resumed: u32,
    /// Samples in the checkpoint that is there, of this render.
    kept: Option<u32>,
    written: u32,
    has_failed: bool,
    /// Whether all samples that were asked for are taken.
    is_complete: bool,
    sums: Option<Result<(), WriteError>>,
}

impl<'a> Keeping<'a> {
    /// For a render of these results; with sums to go on from, where that is asked for and there are some.
    pub fn new(
        wish: &'a Wish,
        results: &[PathBuf],
        interrupt: &'a Interrupt,
        is_quiet: bool,
    ) -> Result<(Self, Option<Kept>), Failure> {
        let places: Vec<PathBuf> = results
            .iter()
            .chain(&wish.sums)
            .filter(|r| r.as_os_str() != "-")
            .map(|r| checkpoint_of(r))
            .collect();
        if places.is_empty() && wish.resume {
            return Err(Failure::input("--resume needs a picture in a file, beside which the checkpoint is"));
        }
        let found = places.iter().find(|p| p.exists());
        let path = found.or(places.first()).cloned().unwrap_or_default();
        let mut this = Self {
            interrupt,
            wish,
            path,
            began: Instant::now(),
            due: Arc::new(AtomicU64::new(wish.every.map_or(u64::MAX, milliseconds))),
            is_safe: Arc::default(),
            is_quiet,
            resumed: 0,
            kept: None,
            written: 0,
            has_failed: false,
            is_complete: false,
            sums: None,
        };
        let name = this.path.display();
        let kept = match (found, wish.resume) {
            (Some(path), true) => {
                let kept = Kept::open(path).map_err(|e| Failure::input(e.to_string()).help(ANEW))?;
                this.say(&format!("going on from {} in {name}", count(kept.samples().into(), "sample")));
                this.resumed = kept.samples();
                this.kept = Some(this.resumed);
                Some(kept)
            }
            (None, true) => {
                this.say(&format!("there is no {name} to go on from: beginning with the first sample"));
                None
            }
            (Some(_), false) if wish.every.is_some() => {
                this.say(&format!("warning: there is a {name}, which isn't used without --resume"));
                None
            }
            _ => None,
        };
        Ok((this, kept))
    }

    /// Samples of each pixel that the render goes on from.
    pub const fn resumed(&self) -> u32 {
        self.resumed
    }

    /// Whether the render has anything to show for this.
    pub const fn is_wanted(&self) -> bool {
        self.wish.every.is_some() || self.wish.sums.is_some()
    }

    /// How often a checkpoint is written; beside standard output there is no place for one.
    fn every(&self) -> Option<Duration> {
        self.wish.every.filter(|_| !self.path.as_os_str().is_empty())
    }

    /// Whether a checkpoint is due in the middle of a pass: when its time has come, and when a signal did, since who sent it may
    /// not wait for the pass to end.
    pub fn pause(&self) -> Option<Pause> {
        let every = milliseconds(self.every()?);
        let (began, due, is_safe) = (self.began, self.due.clone(), self.is_safe.clone());
        let (interrupt, is_said) = (self.interrupt.clone(), self.wish.is_said);
        Some(Arc::new(move || {
            let now = milliseconds(began.elapsed());
            let is_long = is_said || now >= every;
            now >= due.load(Relaxed) || (is_long && !is_safe.load(Relaxed) && interrupt.asked().is_some())
        }))
    }

    /// Looks at the render after a pass.
    pub fn look(&mut self, snapshot: &Snapshot<'_>) {
        self.is_complete = snapshot.is_complete && self.interrupt.asked().is_none();
        if let (true, Some(path)) = (snapshot.is_last, &self.wish.sums) {
            self.sums = Some(self.write(path, snapshot));
        }
        let Some(every) = self.every() else { return };
        let now = milliseconds(self.began.elapsed());
        let is_asked = self.interrupt.asked().is_some();
        let is_due = if snapshot.is_last || is_asked {
            let is_long = self.wish.is_said || self.kept.is_some() || now >= milliseconds(every);
            !self.is_complete && is_long
        } else {
            now >= self.due.load(Relaxed)
        };
        if !is_due {
            return;
        }
        match self.write(&self.path, snapshot) {
            Ok(()) => {
                self.kept = Some(snapshot.samples());
                self.written += 1;
            }
            Err(e) if !self.has_failed => {
                self.has_failed = true;
                self.say(&format!(
                    "warning: {e}; the render goes on without a checkpoint, which is tried again"
                ));
            }
            Err(_) => {}
        }
        self.is_safe.store(is_asked, Relaxed);
        self.due.store(milliseconds(self.began.elapsed()).saturating_add(milliseconds(every)), Relaxed);
    }

    fn write(&self, path: &Path, snapshot: &Snapshot<'_>) -> Result<(), WriteError> {
        self.interrupt.whole(|| atomic::write(path, |file| snapshot.write(file)))
    }

    /// What became of the sums that are written at the end, and where they are.
    pub fn sums(&mut self) -> Option<(&'a Path, Result<(), WriteError>)> {
        self.wish.sums.as_deref().zip(self.sums.take())
    }

    /// When all results of a job are tried: a render that is complete, and written, needs no checkpoint any more; nor an
    /// earlier one that wasn't used.
    pub fn end(mut self, job: &Job, is_written: bool) -> Told {
        let is_ours = |path: &Path| Kept::open(path).is_ok_and(|kept| job.is_source_of(&kept));
        if is_written && self.is_complete && is_ours(&self.path) && fs::remove_file(&self.path).is_ok() {
            self.kept = None;
        }
        if let Some(samples) = self.kept {
            let samples = count(samples.into(), "sample");
            self.say(&format!("--resume goes on from {samples} in {}", self.path.display()));
        }
        Told {
            resumed: self.resumed,
            checkpoint: self.kept.map(|_| self.path),
            written: self.written,
            sums: self.wish.sums.clone(),
        }
    }

    fn say(&self, what: &str) {
        if !self.is_quiet {
            out::say(&format!("{what}\n"));
        }
    }
}

/// How to do without a checkpoint.
pub const ANEW: &str = "to begin anew, leave out --resume";

/// What there is to tell of it.
#[derive(Clone, Debug, Default)]
pub struct Told {
    /// Samples of each pixel that the render went on from.
    pub resumed: u32,
    /// The checkpoint that is left.
    pub checkpoint: Option<PathBuf>,
    /// How many were written.
    pub written: u32,
    /// Where the sums are.
    pub sums: Option<PathBuf>,
}
