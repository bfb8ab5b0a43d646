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

/// Splits one thread's time over the phases.
pub struct Stopwatch {
    clock: Option<Clock>,
    last: u64,
    /// What was measured so far.
    pub times: Times,
}

impl Stopwatch {
    /// Starts to measure; without a clock only rays are counted.
    pub fn start(clock: Option<Clock>) -> Self {
        let last = clock.as_ref().map_or(0, |c| c());
        Self { clock, last, times: Times::default() }
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
}
