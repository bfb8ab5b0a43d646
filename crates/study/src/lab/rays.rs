//! The rays of a real render, recorded.

use super::Error;
use straal_math::Ray;
use straal_render::driver::Render;
use straal_render::integrator::{AnyIntegrator, PathTracer};
use straal_render::probe::{Recorder, Tape};
use straal_render::settings::Settings;
use straal_render::world::World;

/// Where a ray comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// From the camera.
    Primary,
    /// From a surface, on along a path.
    Bounce,
    /// From a surface to a light: whether anything is between.
    Shadow,
}

impl Kind {
    /// All of them, in the order of every array by kind.
    pub const ALL: [Self; 3] = [Self::Primary, Self::Bounce, Self::Shadow];

    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Bounce => "bounce",
            Self::Shadow => "shadow",
        }
    }
}

/// Rays of one kind, in the slices in which the renderer asked for them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RaySet {
    /// The rays.
    pub rays: Vec<Ray>,
    /// Where each slice ends among them.
    pub ends: Vec<usize>,
    /// Rays that a sample of the picture has on average.
    pub per_sample: f64,
}

/// Slices of a set without slices of its own.
const SLICE: usize = 1024;

/// Most rays of a kind that are recorded before they are thinned: 80 MB.
const MOST: usize = 1 << 21;

impl RaySet {
    /// The slices, one after the other.
    pub fn slices(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| start..end)
    }

    /// Every n-th ray of the set: for structures that would take too long with all of them.
    pub fn every(&self, n: usize) -> Self {
        self.cut(self.rays.iter().copied().step_by(n).collect())
    }

    /// The rays that `keep` wants.
    pub(crate) fn filtered(&self, keep: impl Fn(&Ray) -> bool) -> Self {
        self.cut(self.rays.iter().copied().filter(keep).collect())
    }

    /// Some of the rays, in slices of their own.
    fn cut(&self, rays: Vec<Ray>) -> Self {
        let ends = (1..=rays.len().div_ceil(SLICE)).map(|i| rays.len().min(i * SLICE)).collect();
        Self { rays, ends, per_sample: self.per_sample }
    }

    /// Whole slices, evenly spread over the tape, of at most `limit` rays together.
    fn thinned(tape: Tape, limit: usize, samples: f64) -> Self {
        let per_sample = tape.asked as f64 / samples;
        if tape.rays.len() <= limit {
            return Self { rays: tape.rays, ends: tape.ends, per_sample };
        }
        let part = limit as f64 / tape.rays.len() as f64;
        let mut out = Self { per_sample, ..Self::default() };
        let mut start = 0;
        for (i, &end) in tape.ends.iter().enumerate() {
            let room = limit - out.rays.len();
            // A whole number lies between i and i + 1 parts: as many slices are taken as that.
            if room > 0 && ((i + 1) as f64 * part).floor() > (i as f64 * part).floor() {
                out.rays.extend(tape.rays[start..end].iter().take(room));
                out.ends.push(out.rays.len());
            }
            start = end;
        }
        if out.rays.is_empty() {
            // A single slice larger than the limit.
            out.rays.extend(tape.rays.iter().take(limit));
            out.ends.push(out.rays.len());
        }
        out
    }
}

/// Renders with one thread and keeps at most `limit` rays of each kind, by [`Kind`].
pub fn record(
    world: &World,
    integrator: PathTracer,
    settings: Settings,
    sampling: Sampling,
) -> Result<[RaySet; 3], Error> {
    let samples = settings.crop.area() as f64 * f64::from(sampling.spp);
    let settings = Settings { threads: 1, noise: None, blocks: false, ..settings };
    let integrator = AnyIntegrator::Path(integrator);
    let mut render = Render::by(world, integrator, settings, None).map_err(straal::Error::from)?;
    let recorder = render.advance_through(sampling.spp, || Recorder::new(MOST)).pop().unwrap_or_default();
    let Recorder { primary, bounce, shadow, .. } = recorder;
    Ok([primary, bounce, shadow].map(|tape| RaySet::thinned(tape, sampling.rays, samples)))
}

/// How much is recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Samples per pixel.
    pub spp: u32,
    /// Most rays of a kind.
    pub rays: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_math::Vec3;

    fn tape(slices: &[usize]) -> Tape {
        let mut tape = Tape::default();
        for &n in slices {
            for _ in 0..n {
                tape.rays.push(Ray::new(Vec3::splat(tape.rays.len() as f32), Vec3::X));
            }
            tape.ends.push(tape.rays.len());
        }
        tape.asked = tape.rays.len() as u64;
        tape
    }

    #[test]
    fn thinning_keeps_whole_slices_from_everywhere() {
        let set = RaySet::thinned(tape(&[10; 100]), 200, 500.0);
        assert_eq!((set.rays.len(), set.ends.len(), set.per_sample), (200, 20, 2.0));
        let first: Vec<f32> = set.slices().map(|s| set.rays[s.start].o.x).collect();
        assert!(first.windows(2).all(|w| w[1] - w[0] == 50.0), "evenly spread: {first:?}");
        assert!(set.slices().all(|s| s.len() == 10));
    }

    #[test]
    fn what_fits_stays_as_it_is() {
        let set = RaySet::thinned(tape(&[3, 4]), 10, 7.0);
        assert_eq!((set.rays.len(), set.ends.as_slice()), (7, [3, 7].as_slice()));
        assert_eq!(RaySet::thinned(tape(&[50]), 10, 1.0).rays.len(), 10);
        assert_eq!(RaySet::thinned(Tape::default(), 10, 1.0).slices().count(), 0);
    }

    #[test]
    fn every_third() {
        let set = RaySet::thinned(tape(&[5000]), 10_000, 1.0).every(3);
        assert_eq!((set.rays.len(), set.ends.as_slice()), (1667, [1024, 1667].as_slice()));
        assert_eq!(set.rays[1].o.x, 3.0);
    }
}
