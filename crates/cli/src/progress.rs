//! How far a render has come, told while it goes on: a bar on a terminal, now and then a line elsewhere.

use crate::out;
use crate::quantity::{count, tell_duration};
use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use straal::{Blocks, Progress};

/// Time between two lines where no terminal is.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// What was measured when the last pass ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    /// Samples per pixel taken.
    pub samples: u64,
    /// Samples per pixel to take; `None` when only time ends the render.
    pub of: Option<u64>,
    /// Rays of all kinds traced.
    pub rays: u64,
    /// Seconds of rendering these took.
    pub seconds: f64,
    /// Seconds of rendering after which no pass begins.
    pub limit: Option<f64>,
    /// Blocks that need further samples, where noise ends the render.
    pub blocks: Option<Blocks>,
}

impl Pace {
    /// Millions of rays a second.
    pub fn mrays_per_second(&self) -> f64 {
        if self.seconds > 0.0 { self.rays as f64 / self.seconds / 1e6 } else { 0.0 }
    }

    /// Seconds left at `now` (in seconds of rendering), from the measured time of the passes that are done.
    pub fn left(&self, now: f64) -> Option<f64> {
        let by_samples = self.of.filter(|_| self.samples > 0).map(|of| {
            let each = self.seconds / self.samples as f64;
            self.seconds + each * of.saturating_sub(self.samples) as f64 - now
        });
        let by_time = self.limit.map(|limit| limit - now);
        let left = match (by_samples, by_time) {
            (Some(a), Some(b)) if b < a => b,
            (Some(a), _) => a,
            (None, b) => b?,
        };
        Some(if left > 0.0 { left } else { 0.0 })
    }

    /// Whether another pass of `samples` samples is expected to end in time.
    pub fn has_time_for(&self, samples: u64) -> bool {
        let (Some(limit), true) = (self.limit, self.samples > 0) else { return true };
        self.seconds + self.seconds / self.samples as f64 * samples as f64 <= limit
    }

    /// All of it in a line.
    pub fn tell(&self, now: f64) -> String {
        let mut line = match self.of {
            Some(of) => {
                let percent = 100 * self.samples / of.max(1);
                format!("{} of {}, {percent} %", self.samples, count(of, "sample"))
            }
            None => count(self.samples, "sample"),
        };
        if let Some(Blocks { left, of }) = self.blocks {
            let _ = write!(line, ", {left} of {} left", count(of, "block"));
        }
        if self.samples > 0 {
            let _ = write!(line, ", {:.2} Mrays/s", self.mrays_per_second());
        }
        if let Some(left) = self.left(now) {
            let about = match (self.blocks, self.of) {
                (Some(_), _) => "at most ",
                (None, Some(_)) => "about ",
                (None, None) => "",
            };
            let _ = write!(line, ", {about}{} left", tell_duration(left));
        }
        line
    }
}

/// Tells people how far a render is.
pub struct Teller {
    start: Instant,
    pace: Arc<Mutex<Pace>>,
    way: Way,
}

/// How it is told.
enum Way {
    Quietly,
    Lines { last: Instant },
    Bar(ProgressBar),
}

/// What other threads can say while a render goes on.
#[derive(Clone)]
pub struct Announcer {
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Teller {
    /// Starts to tell of a render that begins at `start`.
    pub fn new(start: Instant, pace: Pace, quiet: bool) -> Self {
        let pace = Arc::new(Mutex::new(pace));
        let way = if quiet {
            Way::Quietly
        } else if out::is_watched() {
            Way::Bar(bar(start, &pace))
        } else {
            Way::Lines { last: start }
        };
        Self { start, pace, way }
    }

    /// A voice for another thread.
    pub fn announcer(&self) -> Announcer {
        match &self.way {
            Way::Quietly => Announcer { bar: None, quiet: true },
            Way::Lines { .. } => Announcer { bar: None, quiet: false },
            Way::Bar(bar) => Announcer { bar: Some(bar.clone()), quiet: false },
        }
    }

    /// Takes note of a finished pass.
    pub fn pass(&mut self, progress: &Progress) -> Pace {
        let now = Instant::now();
        let pace = {
            let mut pace = self.pace.lock().unwrap_or_else(PoisonError::into_inner);
            pace.samples = progress.samples;
            pace.blocks = progress.blocks;
            pace.rays = progress.times.rays + progress.times.shadow_rays;
            pace.seconds = (now - self.start).as_secs_f64();
            *pace
        };
        match &mut self.way {
            Way::Quietly => {}
            Way::Lines { last } => {
                if now - *last >= BETWEEN_LINES {
                    *last = now;
                    out::say(&format!("{}\n", pace.tell(pace.seconds)));
                }
            }
            Way::Bar(bar) => match (pace.limit, pace.blocks) {
                (Some(limit), _) => bar.set_position(thousandths(pace.seconds, limit)),
                (None, Some(Blocks { left, of })) => {
                    bar.set_length(of);
                    bar.set_position(of - left);
                }
                (None, None) => bar.set_position(progress.samples),
            },
        }
        pace
    }

    /// Takes the bar away; to be called before anything else is said.
    pub fn end(self) {
        if let Way::Bar(bar) = self.way {
            bar.finish_and_clear();
        }
    }
}

impl Announcer {
    /// Says a line.
    pub fn say(&self, line: &str) {
        match &self.bar {
            _ if self.quiet => {}
            Some(bar) => bar.suspend(|| out::say(&format!("{line}\n"))),
            None => out::say(&format!("{line}\n")),
        }
    }
}

fn thousandths(part: f64, whole: f64) -> u64 {
    (1000.0 * part / whole) as u64
}

fn bar(start: Instant, pace: &Arc<Mutex<Pace>>) -> ProgressBar {
    let first = *pace.lock().unwrap_or_else(PoisonError::into_inner);
    let length = if first.limit.is_some() { 1000 } else { first.of.unwrap_or(0) };
    let pace = pace.clone();
    let told = move |_: &ProgressState, w: &mut dyn Write| {
        let pace = *pace.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = w.write_str(&pace.tell(start.elapsed().as_secs_f64()));
    };
    let style = ProgressStyle::default_bar().with_key("told", told);
    let style = style.clone().template("[{bar:30}] {told}").unwrap_or(style).progress_chars("=> ");
    let bar = ProgressBar::new(length).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_comes_from_whole_passes_and_counts_down() {
        let pace = Pace { samples: 16, of: Some(64), rays: 40_000_000, seconds: 8.0, ..Pace::default() };
        assert_eq!(pace.left(8.0), Some(24.0));
        assert_eq!(pace.left(10.0), Some(22.0));
        assert_eq!(pace.left(1000.0), Some(0.0));
        assert_eq!(pace.mrays_per_second(), 5.0);
        assert_eq!(pace.tell(8.0), "16 of 64 samples, 25 %, 5.00 Mrays/s, about 24 s left");
    }

    #[test]
    fn before_the_first_pass_nothing_is_promised() {
        let pace = Pace { of: Some(64), ..Pace::default() };
        assert_eq!(pace.left(3.0), None);
        assert_eq!(pace.tell(3.0), "0 of 64 samples, 0 %");
    }

    #[test]
    fn where_noise_ends_a_render_blocks_are_told() {
        let blocks = Some(Blocks { left: 12, of: 40 });
        let pace = Pace { samples: 64, rays: 40_000_000, seconds: 8.0, blocks, ..Pace::default() };
        assert_eq!(pace.tell(8.0), "64 samples, 12 of 40 blocks left, 5.00 Mrays/s");
        let limited = Pace { of: Some(128), ..pace };
        assert_eq!(
            limited.tell(8.0),
            "64 of 128 samples, 50 %, 12 of 40 blocks left, 5.00 Mrays/s, at most 8.0 s left"
        );
    }

    #[test]
    fn a_limit_ends_before_a_pass_that_would_be_late() {
        let pace = Pace { samples: 8, of: None, rays: 1, seconds: 4.0, limit: Some(6.0), blocks: None };
        assert!(pace.has_time_for(4));
        assert!(!pace.has_time_for(5));
        assert_eq!(pace.left(5.0), Some(1.0));
        assert!(pace.tell(5.0).ends_with("Mrays/s, 1.0 s left"));
        let both = Pace { of: Some(9), ..pace };
        assert_eq!(both.left(4.0), Some(0.5));
        assert_eq!(Pace { of: Some(80), ..pace }.left(4.0), Some(2.0));
        assert!(Pace::default().has_time_for(1));
    }
}
