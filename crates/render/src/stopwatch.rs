//! Where the time goes. The library reads no clock: the caller lends one.

use std::sync::Arc;

/// A clock: nanoseconds since any fixed moment.
pub type Clock = Arc<dyn Fn() -> u64 + Send + Sync>;

/// Parts of the work of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Random numbers of the film, camera rays.
    Camera,
    /// What rays hit, shadow rays included.
    Search,
    /// Surfaces, materials, the choice of the next direction.
    Shading,
    /// Choice of lights, points on them, what they would bring.
    Lights,
    /// Adding samples to the film.
    Film,
}

impl Phase {
    /// All phases, in the order of [`Times::nanoseconds`].
    pub const ALL: [Self; 5] = [Self::Camera, Self::Search, Self::Shading, Self::Lights, Self::Film];

    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Search => "search",
            Self::Shading => "shading",
            Self::Lights => "lights",
            Self::Film => "film",
        }
    }
}

/// Time spent in each phase, summed over threads, and rays traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Times {
    /// By [`Phase`]; all 0 when no clock was lent.
    pub nanoseconds: [u64; 5],
    /// Rays whose closest hit was sought.
    pub rays: u64,
    /// Shadow rays.
    pub shadow_rays: u64,
}

impl std::ops::AddAssign for Times {
    fn add_assign(&mut self, o: Self) {
        for (a, b) in self.nanoseconds.iter_mut().zip(o.nanoseconds) {
            *a += b;
        }
        self.rays += o.rays;
        self.shadow_rays += o.shadow_rays;
    }
}

/// Of so many blocks of one kind of work, one is timed part by part: to ask a clock takes as long as some vertices do.
const BLOCKS: u32 = 8;

/// Splits one thread's time over the phases.
pub struct Stopwatch {
    clock: Option<Clock>,
    last: u64,
    /// Blocks of the present stretch of work.
    blocks: u32,
    /// When the part under way of a block that is timed began.
    part_began: Option<u64>,
    /// Time of the parts of those blocks, by phase.
    parts: [u64; 5],
    /// What was measured so far.
    pub times: Times,
}

impl Stopwatch {
    /// Starts to measure; without a clock only rays are counted.
    pub fn start(clock: Option<Clock>) -> Self {
        let last = clock.as_ref().map_or(0, |c| c());
        Self { clock, last, blocks: 0, part_began: None, parts: [0; 5], times: Times::default() }
    }

    /// Books the time since the last call on `phase`.
    #[inline]
    pub fn lap(&mut self, phase: Phase) {
        if let Some(clock) = &self.clock {
            let t = clock();
            self.times.nanoseconds[phase as usize] += t.saturating_sub(self.last);
            self.last = t;
        }
    }

    /// A block begins of a stretch of work that consists of many alike, each of parts in different phases.
    #[inline]
    pub fn begin_block(&mut self) {
        let is_timed = self.blocks.is_multiple_of(BLOCKS);
        self.blocks += 1;
        self.part_began = self.clock.as_ref().filter(|_| is_timed).map(|clock| clock());
    }

    /// A part of the block is done.
    #[inline]
    pub fn part(&mut self, phase: Phase) {
        if let (Some(clock), Some(began)) = (&self.clock, self.part_began) {
            let t = clock();
            self.parts[phase as usize] += t.saturating_sub(began);
            self.part_began = Some(t);
        }
    }

    /// Books the time since the last call of [`Self::lap`] on the phases as they shared the blocks that were timed.
    pub fn lap_of_blocks(&mut self) {
        let parts = std::mem::take(&mut self.parts);
        (self.blocks, self.part_began) = (0, None);
        let (Some(clock), timed @ 1..) = (&self.clock, parts.iter().sum::<u64>()) else { return };
        let t = clock();
        let whole = t.saturating_sub(self.last) as f64 / timed as f64;
        for (sum, part) in self.times.nanoseconds.iter_mut().zip(parts) {
            *sum += (part as f64 * whole) as u64;
        }
        self.last = t;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    #[test]
    fn blocks_are_booked_as_those_that_were_timed() {
        let now = Arc::new(AtomicU64::new(5));
        let pass = |nanoseconds| now.fetch_add(nanoseconds, Ordering::Relaxed);
        let clock = now.clone();
        let mut watch = Stopwatch::start(Some(Arc::new(move || clock.load(Ordering::Relaxed))));
        for _ in 0..20 {
            watch.begin_block();
            pass(30);
            watch.part(Phase::Shading);
            pass(10);
            watch.part(Phase::Lights);
        }
        watch.lap_of_blocks();
        assert_eq!(watch.times.nanoseconds, [0, 0, 600, 200, 0]);
        // What comes between is the next lap's.
        watch.lap_of_blocks();
        pass(7);
        watch.lap(Phase::Film);
        assert_eq!(watch.times.nanoseconds, [0, 0, 600, 200, 7]);
    }
}
