//! Film, sampler and integrator: how a picture is made.

use crate::desc::{Gamma, Gamut, Tone, check};
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::Depth;
use straal_color::Exposure;

describe! {
    /// The picture to make.
    pub struct Film [check::film] {
        /// Width and height in pixels.
        size: [u32; 2] [Limit::within(1.0, 65536.0)] = [640, 360],
        /// How samples are weighed around a pixel.
        filter: Filter = Filter::Box,
        /// The part to render, `[x0, y0, x1, y1]` in pixels from the top left; the ends are exclusive.
        crop: Option<[u32; 4]> = None,
        /// Exposure of pictures for the screen in stops, each of which doubles the light; or by a meter: `auto`, which makes
        /// the mean grey, or `highlights`, which shows nearly all within white, perhaps with stops as in `auto+1.5`.
        exposure: Exposure [Limit::within(-64.0, 64.0)] = Exposure::default(),
        /// Tone curve of pictures for the screen.
        tone: Tone = Tone::Clamp,
        /// What becomes of colours that the screen can't show.
        gamut: Gamut = Gamut::Clip,
        /// How light becomes a signal for the screen: `srgb`, or the power of a plain gamma curve.
        gamma: Gamma = Gamma::Srgb,
        /// Bits a channel of pictures for the screen: 8 or 16.
        bits: u32 [Limit::within(8.0, 16.0)] = 8,
        /// Whether pictures for the screen are dithered, so that smooth gradients show no steps.
        dither: bool = false,
    }
}

describe! {
    /// How samples are weighed around a pixel.
    pub enum Filter {
        /// Each pixel is the plain mean of the samples inside it.
        "box" => Box,
        /// A bell that overlaps neighbours: smoother edges.
        "gaussian" => Gaussian(Gaussian),
    }
}

describe! {
    /// A Gaussian, lowered so that it ends in 0 at `radius`.
    pub struct Gaussian {
        /// Half its width in pixels.
        radius: f64 [Limit { min: 0.0, max: 16.0, open: true }] = 1.5,
        /// Standard deviation in pixels.
        sigma: f64 [Limit { min: 0.0, max: 16.0, open: true }] = 0.5,
    }
}

describe! {
    /// Where the random numbers come from.
    pub struct Sampler {
        /// Which pattern.
        kind: SamplerKind = SamplerKind::Sobol,
        /// Samples per pixel.
        spp: u32 [Limit::within(1.0, 262_144.0)] = 64,
        /// Another seed gives other noise.
        seed: u64 = 0,
    }
}

describe! {
    /// Which pattern random numbers follow.
    pub enum SamplerKind {
        /// Owen-scrambled Sobol points: less noise at the same number of samples.
        "sobol" => Sobol,
        /// Independent random numbers.
        "random" => Random,
    }
}

describe! {
    /// How light is computed.
    pub enum Integrator {
        /// Path tracing with next-event estimation and multiple importance sampling.
        "path" => Path(PathTracer),
    }
}

impl Default for Integrator {
    fn default() -> Self {
        Self::Path(PathTracer::default())
    }
}

describe! {
    /// A path tracer.
    pub struct PathTracer {
        /// Most edges a path may have, the camera's included: 1 sees emitters, 2 is direct light; or `unlimited`.
        max_depth: Depth = Depth::Unlimited,
        /// Number of edges after which Russian roulette may end a path.
        roulette_depth: u32 = 5,
    }
}
