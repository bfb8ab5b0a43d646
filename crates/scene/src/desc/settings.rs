//! Film, sampler and integrator: how a picture is made.

use crate::desc::{Gamma, Gamut, Tone, check};
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::{Depth, Name};
use straal_color::Exposure;
use straal_color::spectrum::Bands;

/// Pixels that a filter may reach.
const FILTER_RADIUS: Limit = Limit { min: 0.0, max: 16.0, open: true };

describe! {
    /// The picture to make.
    pub struct Film [check::film] {
        /// Width and height in pixels.
        size: [u32; 2] [Limit::within(1.0, 65536.0)] = [640, 360],
        /// How samples are weighed around a pixel.
        filter: Filter = Filter::Box,
        /// Whether a sample counts in every pixel that the filter reaches it from, in place of one pixel by whose filter it is drawn.
        splat: bool = false,
        /// In which numbers an EXR holds the picture.
        channels: Channels = Channels::Rgb,
        /// Whether the picture is denoised: a clean picture, and only a likely one.
        denoise: Denoise = Denoise::Off,
        /// The part to render, `[x0, y0, x1, y1]` in pixels from the top left; the ends are exclusive.
        crop: Option<[u32; 4]> = None,
        /// Exposure of pictures for the screen in stops, each of which doubles the light; or by a meter: `auto`, which makes
        /// the mean grey, or `highlights`, which shows nearly all within white, perhaps with stops as in `auto+1.5`.
        exposure: Exposure [Limit::within(-64.0, 64.0)] = Exposure::default(),
        /// Tone curve of pictures for the screen. The usual one draws in what is brighter than the screen; `clamp` keeps numbers as they are.
        tone: Tone = Tone::KhronosNeutral,
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
    /// In which numbers an EXR holds the picture.
    pub enum Channels {
        /// Linear red, green and blue of the work space.
        "rgb" => Rgb,
        /// X, Y and Z of the observer of 1931, where the scene's white is D65.
        "xyz" => Xyz,
        /// Red, green and blue, and the mean radiance in bands of wavelengths; needs light by wavelengths.
        "spectral" => Spectral(SpectralChannels),
    }
}

describe! {
    /// Whether the picture is denoised, and how.
    pub enum Denoise {
        /// It stays as it is.
        "off" => Off,
        /// By three of Open Image Denoise's networks, each with the share in which the samples tell it to be right.
        "best" => Best,
        /// By a single, small network: a sixth of the work, a little less clean.
        "fast" => Fast,
    }
}

describe! {
    /// Bands of wavelengths of equal width.
    pub struct SpectralChannels [check::spectral_channels] {
        /// How many.
        bands: u32 [Limit::within(2.0, 470.0)] = 16,
        /// Where the first begins, in nm.
        from: f64 [Limit::within(360.0, 830.0)] = 380.0,
        /// Where the last ends, in nm.
        to: f64 [Limit::within(360.0, 830.0)] = 780.0,
    }
}

impl SpectralChannels {
    /// The bands, where they make sense.
    pub fn bands(&self) -> Option<Bands> {
        Bands::new(self.from, self.to, self.bands)
    }
}

describe! {
    /// How samples are weighed around a pixel.
    pub enum Filter {
        /// Each pixel is the plain mean of the samples inside it.
        "box" => Box,
        /// Falls evenly from the pixel's centre to the middles of its neighbours.
        "tent" => Tent(Tent),
        /// A bell that overlaps neighbours: smoother edges.
        "gaussian" => Gaussian(Gaussian),
        /// Mitchell and Netravali's cubic: sharp, with faint dark lines along edges.
        "mitchell" => Mitchell(Mitchell),
        /// The four-term window of Blackman and Harris: a bell with a soft end.
        "blackman_harris" => BlackmanHarris(BlackmanHarris),
        /// A windowed sinc: the sharpest, and it rings along edges.
        "lanczos" => Lanczos(Lanczos),
    }
}

impl Filter {
    /// Half its width in pixels.
    pub const fn radius(&self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Tent(f) => f.radius,
            Self::Gaussian(f) => f.radius,
            Self::Mitchell(f) => f.radius,
            Self::BlackmanHarris(f) => f.radius,
            Self::Lanczos(f) => f.radius,
        }
    }

    /// Whether it may be below 0 somewhere.
    pub const fn is_signed(&self) -> bool {
        matches!(self, Self::Mitchell(_) | Self::Lanczos(_))
    }
}

describe! {
    /// Falls evenly to 0.
    pub struct Tent {
        /// Half its width in pixels.
        radius: f64 [FILTER_RADIUS] = 1.0,
    }
}

describe! {
    /// The cubic of Mitchell and Netravali (1988).
    pub struct Mitchell {
        /// Half its width in pixels.
        radius: f64 [FILTER_RADIUS] = 2.0,
        /// How much it blurs.
        b: f64 [Limit::UNIT] = 1.0 / 3.0,
        /// How much it rings.
        c: f64 [Limit::UNIT] = 1.0 / 3.0,
    }
}

describe! {
    /// The four-term window of Blackman and Harris.
    pub struct BlackmanHarris {
        /// Half its width in pixels.
        radius: f64 [FILTER_RADIUS] = 1.5,
    }
}

describe! {
    /// A sinc, windowed by the middle lobe of one that is as wide as the filter.
    pub struct Lanczos {
        /// Half its width in pixels, which is how many lobes it has on each side.
        radius: f64 [FILTER_RADIUS] = 3.0,
    }
}

describe! {
    /// A Gaussian, lowered so that it ends in 0 at `radius`.
    pub struct Gaussian [check::gaussian] {
        /// Half its width in pixels.
        radius: f64 [FILTER_RADIUS] = 1.5,
        /// Standard deviation in pixels.
        sigma: f64 [Limit { min: 0.0, max: 16.0, open: true }] = 0.5,
    }
}

describe! {
    /// Where the random numbers come from.
    pub struct Sampler {
        /// Which pattern.
        kind: SamplerKind = SamplerKind::Sobol,
        /// Samples per pixel; with `noise`, the most that a pixel gets, unless the command line asks for `--noise` without `--spp`.
        spp: u32 [Limit::within(1.0, 262_144.0)] = 64,
        /// Another seed gives other noise.
        seed: u64 = 0,
        /// Stops where the picture is good enough: each block of 8 x 8 pixels is sampled until its relative standard error
        /// is at most this, such as 0.02.
        noise: Option<f64> [Limit::between(0.0, 1.0)] = None,
    }
}

describe! {
    /// Which pattern random numbers follow.
    pub enum SamplerKind {
        /// Owen-scrambled Sobol points: less noise at the same number of samples.
        "sobol" => Sobol,
        /// The same points dealt out over neighbouring pixels: about as much noise, finer to the eye.
        "blue_sobol" => BlueSobol,
        /// Scrambled Halton points.
        "halton" => Halton,
        /// Scrambled Hammersley points.
        "hammersley" => Hammersley,
        /// Correlated multi-jittered points.
        "multi_jittered" => MultiJittered,
        /// One point in each row and each column.
        "n_rooks" => NRooks,
        /// One point in each cell of a grid.
        "jittered" => Jittered,
        /// The middles of a grid's cells: shows what happens without chance.
        "regular" => Regular,
        /// Independent random numbers.
        "random" => Random,
    }
}

describe! {
    /// How light is computed.
    pub enum Integrator {
        /// Path tracing with next-event estimation and multiple importance sampling.
        "path" => Path(PathTracer),
        /// Direct light alone: from lights to the first surface, no further.
        "direct" => Direct(DirectLight),
        /// Ambient occlusion: of each point the share of an even sky that it sees, whatever lights and materials there are.
        "ao" => Ao(AmbientOcclusion),
        /// Rays from lamps, whose light is brought to the camera from wherever they arrive: for bright spots by way of glass and mirrors.
        "light" => Light(LightTracer),
        /// The textbook's recursive ray tracer: light straight from lamps, hard shadows, perfect mirrors and glass; no noise at one sample a pixel.
        "whitted" => Whitted(Whitted),
        /// No light but a test of aliasing: (1 + sin(x²y²))/2 of the point where a ray meets the plane z = 0.
        "sine_product" => SineProduct,
        /// The zones of a lamp's shadow: umbra, penumbra and antumbra, or the share of the lamp that each point sees.
        "zones" => Zones(ShadowZones),
    }
}

impl Integrator {
    /// Whether its picture is black where nothing gives light.
    pub const fn needs_light(&self) -> bool {
        !matches!(self, Self::SineProduct | Self::Ao(_))
    }

    /// Whether it shows anything of the world.
    pub const fn needs_world(&self) -> bool {
        !matches!(self, Self::SineProduct)
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
        /// By which chance roulette lets a path go on.
        roulette: Roulette = Roulette::Root,
        /// How the light that falls on a point is found: `bsdf` is naive path tracing, `lights` has next-event estimation, `mis` both.
        technique: Technique = Technique::Mis,
        /// The most that one piece of light may bring that came by way of more than one surface, in W/(m^2 sr): what is beyond is taken away, which makes the picture cleaner and darker. How much
        /// it was, a render tells. None when absent.
        clamp: Option<f64> [Limit::POSITIVE] = None,
        /// How the directions are drawn in which paths go on.
        directions: Directions = Directions::Bsdf,
    }
}

describe! {
    /// A tracer of rays from lamps.
    pub struct LightTracer [check::light_tracer] {
        /// Most edges a path may have, the camera's included: 1 sees emitters, 2 is direct light; or `unlimited`.
        max_depth: Depth = Depth::Unlimited,
        /// Number of edges after which Russian roulette may end a path.
        roulette_depth: u32 = 5,
        /// By which chance roulette lets a path go on.
        roulette: Roulette = Roulette::Root,
    }
}

describe! {
    /// How the light that falls on a point is found.
    pub enum Technique {
        /// By both of the other ways, each sample weighed by how likely it was beside the other way.
        "mis" => Mis,
        /// By points on lights alone; mirrors and glass show lights nevertheless.
        "lights" => Lights,
        /// By directions of the BSDF alone; lights that no ray can hit are asked nevertheless.
        "bsdf" => Bsdf,
    }
}

describe! {
    /// How directions are drawn in which light is looked for. Mirrors, glass and what else lets light through always have their own.
    pub enum Directions {
        /// By what the surface scatters: those that bring more come more often.
        "bsdf" => Bsdf,
        /// By the cosine to the normal, whatever the surface is.
        "cosine" => Cosine,
        /// Evenly over the hemisphere.
        "uniform" => Uniform,
    }
}

describe! {
    /// By which chance roulette lets a path go on.
    pub enum Roulette {
        /// The root of the light that the path carries: noise against time.
        "root" => Root,
        /// The light that the path carries, as textbooks have it.
        "throughput" => Throughput,
        /// None: a path goes on until it leaves, is absorbed or is too long, or has 1000 edges.
        "off" => Off,
        /// What going on brings for what it costs, at any number of edges (Rath and others 2022): paths that bring much split into several. Learnt before the render. Of `path` only.
        "ears" => Ears,
    }
}

describe! {
    /// Direct light: for each sample of the pixel so many points on lights and so many directions of the BSDF.
    pub struct DirectLight {
        /// How it is found.
        technique: Technique = Technique::Mis,
        /// Points on lights for each sample of the pixel.
        light_samples: u32 [Limit::within(1.0, 4096.0)] = 1,
        /// Directions of the BSDF for each sample of the pixel.
        bsdf_samples: u32 [Limit::within(1.0, 4096.0)] = 1,
        /// How these are drawn.
        directions: Directions = Directions::Bsdf,
    }
}

describe! {
    /// Ambient occlusion.
    pub struct AmbientOcclusion [check::ambient_occlusion] {
        /// Occluders that are further away don't count, in metres; absent: all do.
        radius: Option<f64> [Limit::POSITIVE] = None,
        /// How occluders within the radius count by their distance.
        falloff: OcclusionFalloff = OcclusionFalloff::None,
        /// How directions are drawn.
        directions: OcclusionWarp = OcclusionWarp::Cosine,
        /// Directions for each sample of the pixel.
        rays: u32 [Limit::within(1.0, 4096.0)] = 1,
    }
}

describe! {
    /// How an occluder counts by its distance.
    pub enum OcclusionFalloff {
        /// Each alike.
        "none" => None,
        /// What passes grows evenly from 0 at the point to 1 at the radius.
        "linear" => Linear,
        /// By the square of the distance.
        "quadratic" => Quadratic,
    }
}

describe! {
    /// How directions of the sky are drawn.
    pub enum OcclusionWarp {
        /// By the cosine to the normal: each counts alike.
        "cosine" => Cosine,
        /// Evenly over the hemisphere: each counts by its cosine.
        "uniform" => Uniform,
        /// With the angle from the normal as the root of the random number, in radians, each counting alike. To be seen, not used: it is wrong, since
        /// no direction is flatter than one radian, and those about it come too often.
        "wrong" => Wrong,
    }
}

describe! {
    /// The textbook's recursive ray tracer.
    pub struct Whitted {
        /// Most edges a path may have, the camera's included; beyond is black.
        max_depth: u32 [Limit::within(1.0, 64.0)] = 6,
        /// Rays that bring less than this share of the light at their end aren't followed.
        min_weight: f64 [Limit::within(0.0, 1.0)] = 0.001,
        /// Whether what stands between a lamp and a surface keeps the lamp's light off.
        shadows: bool = true,
        /// Whether mirrors and glass reflect.
        reflections: bool = true,
        /// Whether glass lets light through.
        refractions: bool = true,
        /// Into how many rays glass with dispersion splits white light.
        dispersion_rays: u32 [Limit::within(1.0, 256.0)] = 16,
        /// Rays start at this distance from the surface that they leave, in metres, as textbooks have it: where it is too small surfaces shade themselves,
        /// where it is too large shadows come loose. Absent: just outside of what rounding may have moved.
        epsilon: Option<f64> [Limit::NON_NEGATIVE] = None,
    }
}

/// Which lamp.
#[derive(Clone, Debug, PartialEq)]
pub enum LampChoice {
    /// Counted from 1.
    Number(u32),
    /// The first that goes by a name.
    Named(Name),
}

describe! {
    /// The zones of a lamp's shadow.
    pub struct ShadowZones {
        /// What is shown.
        show: ZonesShown = ZonesShown::Zones,
        /// Points across the lamp: the square of it are spread over the lamp and four times it along its rim, and a ray asks for each whether it is seen.
        across: u32 [Limit::within(2.0, 64.0)] = 8,
        /// Which of the lamps with a size (surfaces that glow, suns with an `angle`): counted from 1, or by the `name` of a sun, of what glows, or of a group around it.
        lamp: LampChoice [Limit::within(1.0, 1e9)] = LampChoice::Number(1),
    }
}

describe! {
    /// What a picture of a lamp's shadow shows.
    pub enum ZonesShown {
        /// Umbra, where nothing of the lamp is seen, dark; penumbra blue, the lighter the more is seen; antumbra, where the lamp's whole rim is seen and
        /// something within is hidden, orange; what sees all of it white. Lamps that are no ball, ellipsoid, disc or rectangle have no antumbra.
        "zones" => Zones,
        /// The share of the lamp that is seen, of 0 to 1.
        "share" => Share,
    }
}
