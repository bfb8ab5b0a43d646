//! How far a render has come, told while it goes on: a bar on a terminal, now and then a line elsewhere.

use crate::out;
use crate::quantity::{count, grouped, tell_duration};
use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use straal::{Blocks, FIRST_CHECK, Listener, LoadOptions, Progress, Reading};
use straal_math::ops::{exp_d, ln_d};

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
    /// Seconds that it still takes until noise ends the render, as foreseen at `seconds`.
    pub until_clean: Option<f64>,
}

/// Columns of the bar's own line that are left for words, so that all of it fits a terminal of 80.
const WORDS: usize = 60;

impl Pace {
    /// Millions of rays a second.
    pub fn mrays_per_second(&self) -> f64 {
        if self.seconds > 0.0 { self.rays as f64 / self.seconds / 1e6 } else { 0.0 }
    }

    /// Seconds left at `now` (in seconds of rendering), from the measured time of the passes that are done, and how sure that is.
    pub fn left(&self, now: f64) -> Option<(&'static str, f64)> {
        let by_samples = self.of.filter(|_| self.samples > 0).map(|of| {
            let each = self.seconds / self.samples as f64;
            let seconds = self.seconds + each * of.saturating_sub(self.samples) as f64 - now;
            (if self.blocks.is_some() { "at most " } else { "about " }, seconds)
        });
        let by_noise = self.until_clean.map(|left| ("about ", self.seconds + left - now));
        let by_time = self.limit.map(|limit| ("", limit - now));
        let (how, left) = [by_noise, by_samples, by_time]
            .into_iter()
            .flatten()
            .reduce(|least, other| if other.1 < least.1 { other } else { least })?;
        Some((how, if left > 0.0 { left } else { 0.0 }))
    }

    /// Whether another pass of `samples` samples is expected to end in time.
    pub fn has_time_for(&self, samples: u64) -> bool {
        let (Some(limit), true) = (self.limit, self.samples > 0) else { return true };
        self.seconds + self.seconds / self.samples as f64 * samples as f64 <= limit
    }

    /// All of it in a line; of what doesn't go into so many columns, the less important parts are left out.
    pub fn tell(&self, now: f64, columns: usize) -> String {
        let samples = match self.of {
            Some(of) => format!("{} of {}", grouped(self.samples), count(of, "sample")),
            None => count(self.samples, "sample"),
        };
        let blocks = self
            .blocks
            .map(|Blocks { left, of }| format!("{} of {} left", grouped(left), count(of, "block")));
        let rate = (self.samples > 0).then(|| format!("{:.2} Mrays/s", self.mrays_per_second()));
        let left = self.left(now).map(|(how, left)| format!("{how}{} left", tell_duration(left)));
        // In the order of the line, each with its place in the order of importance.
        let mut parts: Vec<(usize, String)> = [(0, Some(samples)), (2, blocks), (3, rate), (1, left)]
            .into_iter()
            .filter_map(|(i, p)| Some((i, p?)))
            .collect();
        let width =
            |parts: &[(usize, String)]| parts.iter().map(|(_, p)| p.chars().count() + 2).sum::<usize>();
        while parts.len() > 1 && width(&parts) > columns + 2 {
            let least = parts.iter().map(|(i, _)| *i).max();
            parts.retain(|(i, _)| Some(*i) != least);
        }
        parts.into_iter().map(|(_, part)| part).collect::<Vec<_>>().join(", ")
    }
}

/// Foresees when noise ends a render, from how many blocks still needed samples after so many. Noise falls with the square root of
/// the number of samples, and blocks are ended one after the other; how many are left has been found to fall as a power of that
/// number, which is measured here.
#[derive(Clone, Debug, Default)]
struct Foresight {
    /// Samples and blocks left, whenever these had become fewer.
    looks: Vec<(u64, u64)>,
    /// Samples of blocks that were taken.
    work: f64,
    /// Samples of the last pass.
    samples: u64,
}

impl Foresight {
    /// Takes note of a pass; seconds that are left after it, when that can be foreseen.
    fn pass(&mut self, samples: u64, Blocks { left, of }: Blocks, seconds: f64) -> Option<f64> {
        // Those that were open while the pass was rendered.
        let open = self.looks.last().map_or(of, |l| l.1);
        self.work += open as f64 * (samples - self.samples) as f64;
        self.samples = samples;
        // Before the first look nothing can have ended.
        if samples >= u64::from(FIRST_CHECK) && self.looks.last().is_none_or(|l| l.1 > left) {
            self.looks.push((samples, left));
        }
        let &(now, last) = self.looks.last().filter(|l| l.1 > 0)?;
        // Far enough back that chance is small.
        let &(then, first) = self.looks.iter().rev().find(|l| 2 * l.0 <= now).or(self.looks.first())?;
        if first <= last || then >= now || self.work <= 0.0 {
            return None;
        }
        let fall = ln_d(first as f64 / last as f64) / ln_d(now as f64 / then as f64);
        // Until half a block is left.
        let stretch = ln_d(2.0 * last as f64) / fall;
        // The integral of the blocks that are left over samples.
        let rest = if (1.0 - fall).abs() < 1e-6 {
            stretch
        } else {
            (exp_d((1.0 - fall) * stretch) - 1.0) / (1.0 - fall)
        };
        // Blocks are ended at the next look after they are good enough, which is on average a fifth later.
        const LATE: f64 = 1.2;
        let work = LATE * last as f64 * now as f64 * rest - last as f64 * (samples - now) as f64;
        Some(seconds / self.work * if work > 0.0 { work } else { last as f64 })
    }
}

/// Tells people how far a render is.
pub struct Teller {
    start: Instant,
    pace: Arc<Mutex<Pace>>,
    /// Absent where noise ends one of several replicates, not the render.
    foresight: Option<Foresight>,
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
        Self { start, pace, foresight: Some(Foresight::default()), way }
    }

    /// The same of a render of several replicates.
    pub fn of_replicates(self) -> Self {
        Self { foresight: None, ..self }
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
            pace.until_clean = self
                .foresight
                .as_mut()
                .zip(progress.blocks)
                .and_then(|(foresight, blocks)| foresight.pass(progress.samples, blocks, pace.seconds));
            *pace
        };
        match &mut self.way {
            Way::Quietly => {}
            Way::Lines { last } => {
                if now - *last >= BETWEEN_LINES {
                    *last = now;
                    out::say(&format!("{}\n", pace.tell(pace.seconds, usize::MAX - 2)));
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

/// Reads a scene's files under a bar that tells how many are read, where somebody watches.
pub fn while_reading<T>(quiet: bool, options: &LoadOptions, read: impl FnOnce(&LoadOptions) -> T) -> T {
    if quiet || !out::is_watched() {
        return read(options);
    }
    let style = ProgressStyle::default_bar();
    let told = "[{bar:16}] reading: {pos} of {len} files";
    let style = style.clone().template(told).unwrap_or(style).progress_chars("=> ");
    let bar = ProgressBar::new(0).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    let heard = bar.clone();
    let listener = Listener::new(move |Reading { done, of }| {
        heard.set_length(of as u64);
        heard.set_position(done as u64);
    });
    let result = read(&LoadOptions { listener, ..options.clone() });
    bar.finish_and_clear();
    result
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
        let _ = w.write_str(&pace.tell(start.elapsed().as_secs_f64(), WORDS));
    };
    let style = ProgressStyle::default_bar().with_key("told", told);
    let style = style.clone().template("[{bar:16}] {told}").unwrap_or(style).progress_chars("=> ");
    let bar = ProgressBar::new(length).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All of a line.
    const WIDE: usize = 1000;

    #[test]
    fn time_left_comes_from_whole_passes_and_counts_down() {
        let pace = Pace { samples: 16, of: Some(64), rays: 40_000_000, seconds: 8.0, ..Pace::default() };
        assert_eq!(pace.left(8.0), Some(("about ", 24.0)));
        assert_eq!(pace.left(10.0), Some(("about ", 22.0)));
        assert_eq!(pace.left(1000.0), Some(("about ", 0.0)));
        assert_eq!(pace.mrays_per_second(), 5.0);
        assert_eq!(pace.tell(8.0, WIDE), "16 of 64 samples, 5.00 Mrays/s, about 24 s left");
    }

    #[test]
    fn before_the_first_pass_nothing_is_promised() {
        let pace = Pace { of: Some(64), ..Pace::default() };
        assert_eq!(pace.left(3.0), None);
        assert_eq!(pace.tell(3.0, WIDE), "0 of 64 samples");
    }

    #[test]
    fn where_noise_ends_a_render_blocks_are_told() {
        let blocks = Some(Blocks { left: 12, of: 40 });
        let pace = Pace { samples: 64, rays: 40_000_000, seconds: 8.0, blocks, ..Pace::default() };
        assert_eq!(pace.tell(8.0, WIDE), "64 samples, 12 of 40 blocks left, 5.00 Mrays/s");
        let limited = Pace { of: Some(128), ..pace };
        let told = "64 of 128 samples, 12 of 40 blocks left, 5.00 Mrays/s, at most 8.0 s left";
        assert_eq!(limited.tell(8.0, WIDE), told);
        let foreseen = Pace { until_clean: Some(3.0), ..limited };
        assert!(foreseen.tell(9.0, WIDE).ends_with("about 2.0 s left"));
    }

    /// The longest line that there can be stands beside the bar, its brackets and a blank on 80 columns.
    #[test]
    fn the_line_fits_a_terminal() {
        assert!("[".len() + 16 + "] ".len() + WORDS < 80);
        let blocks = Some(Blocks { left: 1_048_575, of: 1_048_576 });
        let (samples, of) = (262_143, Some(262_144));
        let pace = Pace { samples, of, rays: u64::MAX / 2, seconds: 3e7, blocks, ..Pace::default() };
        for pace in [pace, Pace { of: None, ..pace }, Pace { blocks: None, ..pace }] {
            let line = pace.tell(3e7, WORDS);
            assert!(line.len() <= WORDS && line.contains("262,143"), "{line}");
        }
        assert!(pace.tell(3e7, WORDS).contains(" left"));
    }

    /// Blocks whose need of samples follows a power law: the time that is left is foreseen within a quarter, from the middle on.
    #[test]
    fn the_end_by_noise_is_foreseen() {
        let of = 10_000_u64;
        for fall in [0.8, 1.0, 1.6] {
            let open = |n: f64| (of as f64 * exp_d(fall * ln_d(32.0 / n))) as u64;
            let (mut foresight, mut seconds, mut n) = (Foresight::default(), 0.0, 0_u64);
            let mut told = Vec::new();
            let mut left = of;
            let mut look = 32_u64;
            while left > 0 {
                n += 4;
                seconds += 4.0 * left as f64 * 1e-4;
                if n >= look {
                    left = open(n as f64);
                    look += 1 << (look.ilog2() - 1);
                }
                told.push((seconds, foresight.pass(n, Blocks { left, of }, seconds)));
            }
            assert_eq!(told[3].1, None, "nothing is known before the first look");
            for part in [0.5, 0.8] {
                let Some((at, Some(foreseen))) =
                    told.iter().find(|(s, f)| *s >= part * seconds && f.is_some())
                else {
                    panic!("{fall}: nothing foreseen at {part}");
                };
                let truth = seconds - at;
                assert!((foreseen / truth - 1.0).abs() < 0.25, "{fall}, {part}: {foreseen} of {truth}");
            }
        }
    }

    #[test]
    fn a_limit_ends_before_a_pass_that_would_be_late() {
        let pace = Pace { samples: 8, rays: 1, seconds: 4.0, limit: Some(6.0), ..Pace::default() };
        assert!(pace.has_time_for(4));
        assert!(!pace.has_time_for(5));
        assert_eq!(pace.left(5.0), Some(("", 1.0)));
        assert!(pace.tell(5.0, WIDE).ends_with("Mrays/s, 1.0 s left"));
        let both = Pace { of: Some(9), ..pace };
        assert_eq!(both.left(4.0), Some(("about ", 0.5)));
        assert_eq!(Pace { of: Some(80), ..pace }.left(4.0), Some(("", 2.0)));
        assert!(Pace::default().has_time_for(1));
    }
}
