//! Film, pixel filter, sampler and integrator.

use straal_color::Space;
use straal_scene::desc::{
    AmbientOcclusion, Channels, DirectLight, Filter, Gamma, Gaussian, Integrator, Lanczos, LightTracer,
    Mitchell, OcclusionFalloff, OcclusionWarp, PathTracer, Roulette, SamplerKind, SpectralChannels,
    Technique, Tent, Tone, WorkSpace,
};
use straal_scene::value::Depth;

use super::params::Params;
use super::{Reader, Thing};

/// Pixels that a filter may reach.
const WIDEST: f64 = 16.0;

/// The most samples of a pixel.
const MOST_SAMPLES: i32 = 262_144;

impl Reader<'_, '_> {
    /// All that is said before the world.
    pub(super) fn picture(&mut self) {
        self.film();
        self.filter();
        self.sampler();
        self.integrator();
        self.camera();
        // The camera has asked for the film's diagonal.
        if let Some(Thing { kind, params }) = self.options.film.take() {
            params.pass_over(&["diagonal"]);
            params.complain(&format!("the film `{}`", kind.value), self.means.d);
        }
    }

    fn film(&mut self) {
        // As pbrt's own pictures are.
        self.scene.film.tone = Tone::Clamp;
        self.scene.film.gamma = Gamma::Srgb;
        self.scene.film.size = [1280, 720];
        self.filter_of_film();
        let exposure = self.exposure_time();
        self.light_scale = exposure;
        let Some(Thing { kind, params }) = self.options.film.take() else { return };
        params.pass_over(&["filename", "savefp16"]);
        let span = params.span;
        match kind.as_str() {
            "rgb" => {}
            "image" => self.warn(kind.span, "the film `image` of pbrt-v3 is taken for `rgb`"),
            "gbuffer" => {
                params.pass_over(&["coordinatesystem"]);
                self.warn(
                    kind.span,
                    "of a `gbuffer` only the picture is made: ask straal for layers by `--aov`",
                );
            }
            "spectral" => {
                let from = params.float("lambdamin", 360.0);
                let to = params.float("lambdamax", 830.0);
                let bands = params.integer("nbuckets", 16).clamp(2, 470) as u32;
                let channels = SpectralChannels { bands, from, to };
                if from >= 360.0 && to <= 830.0 && from < to && channels.bands().is_some() {
                    self.scene.film.channels = Channels::Spectral(channels);
                    self.scene.spectral = true;
                } else {
                    self.error(span, "the bands of a spectral film must lie within 360 and 830 nm and be 1 nm wide or more");
                }
            }
            _ => return self.unknown("film", &kind, &["rgb", "gbuffer", "spectral"]),
        }
        let size = [params.integer("xresolution", 1280), params.integer("yresolution", 720)];
        let fits = size.iter().all(|n| (1..=65_536).contains(n));
        if !fits || i64::from(size[0]) * i64::from(size[1]) > 1 << 30 {
            self.error(span, format!("a picture of {} x {} pixels can't be made", size[0], size[1]));
        } else {
            self.scene.film.size = size.map(i32::unsigned_abs);
        }
        self.crop(&params);
        let iso = params.float("iso", 100.0);
        let factor = iso / 100.0;
        if iso > 0.0 && (exposure * factor) as f32 > 0.0 {
            self.light_scale = exposure * factor;
        } else {
            self.warn(span, "`iso` must be above 0: it is passed over");
        }
        if let Some(sensor) = params.string("sensor")
            && sensor.as_str() != "cie1931"
        {
            let message = format!(
                "the sensor `{}` is not known: colours are those of the observer of 1931",
                sensor.value
            );
            self.warn(sensor.span, message);
        }
        if params.maybe_float("whitebalance").is_some_and(|kelvin| kelvin != 0.0) {
            self.warn(span, "`whitebalance` is passed over: white is D65");
        }
        if params.maybe_float("maxcomponentvalue").is_some_and(f64::is_finite) {
            self.warn(span, "`maxcomponentvalue` is passed over: samples are not cut off");
        }
        self.scene.color.space = match self.film_space() {
            Space::Srgb => WorkSpace::Srgb,
            Space::DisplayP3 => WorkSpace::DisplayP3,
            Space::Rec2020 => WorkSpace::Rec2020,
            Space::AcesCg => WorkSpace::AcesCg,
            Space::Aces => WorkSpace::Aces,
        };
        self.options.film = Some(Thing { kind, params });
    }

    /// The space in which the film's colours are, that of the state.
    const fn film_space(&self) -> Space {
        self.state.space
    }

    /// pbrt's own filter where none is said.
    fn filter_of_film(&mut self) {
        self.scene.film.filter = Filter::Gaussian(Gaussian { radius: 1.5, sigma: 0.5 });
    }

    /// How long the shutter is open, which makes the picture brighter.
    fn exposure_time(&mut self) -> f64 {
        let Some(Thing { params, .. }) = &self.options.camera else { return 1.0 };
        let time = params.float("shutterclose", 1.0) - params.float("shutteropen", 0.0);
        let span = params.span;
        if time as f32 > 0.0 {
            return time;
        }
        self.error(span, "the camera's shutter doesn't open: `shutterclose` must be after `shutteropen`");
        1.0
    }

    fn crop(&mut self, params: &Params) {
        let size = self.scene.film.size;
        let pixels = |share: f64, k: usize| {
            let at = (share * f64::from(size[k])).ceil();
            if at > 0.0 { if at < f64::from(size[k]) { at as u32 } else { size[k] } } else { 0 }
        };
        let crop = if let Some(w) = params.floats("cropwindow") {
            params.pass_over(&["pixelbounds"]);
            let Ok([x0, x1, y0, y1]) = <[f64; 4]>::try_from(w) else {
                return self.warn(params.span, "`cropwindow` must have four numbers: it is passed over");
            };
            let [x, y] = [[x0, x1], [y0, y1]].map(|[a, b]| if a < b { [a, b] } else { [b, a] });
            [pixels(x[0], 0), pixels(y[0], 1), pixels(x[1], 0), pixels(y[1], 1)]
        } else if let Some(b) = params.integers("pixelbounds") {
            let Ok([x0, x1, y0, y1]) = <[i32; 4]>::try_from(b) else {
                return self.warn(params.span, "`pixelbounds` must have four numbers: it is passed over");
            };
            let within = |v: i32, k: usize| v.max(0).unsigned_abs().min(size[k]);
            [within(x0, 0), within(y0, 1), within(x1, 0), within(y1, 1)]
        } else {
            return;
        };
        let [x0, y0, x1, y1] = crop;
        if x0 >= x1 || y0 >= y1 {
            return self.error(params.span, "the part of the picture that is asked for is empty");
        }
        if crop != [0, 0, size[0], size[1]] {
            self.scene.film.crop = Some(crop);
        }
    }

    fn filter(&mut self) {
        let Some(Thing { kind, params }) = self.options.filter.take() else { return };
        let usual = match kind.as_str() {
            "box" => 0.5,
            "gaussian" => 1.5,
            "mitchell" | "triangle" => 2.0,
            "sinc" => 4.0,
            _ => return self.unknown("filter", &kind, &["box", "gaussian", "mitchell", "sinc", "triangle"]),
        };
        // Version 3 says widths.
        let older = params.maybe_float("xwidth").or(params.maybe_float("ywidth"));
        params.pass_over(&["ywidth", "alpha"]);
        let x = params.float("xradius", older.unwrap_or(usual));
        let y = params.float("yradius", older.unwrap_or(usual));
        if x != y {
            self.warn(
                params.span,
                "a filter is as high as wide: the radius is the mean of `xradius` and `yradius`",
            );
        }
        let radius = 0.5 * (x + y);
        if !(radius as f32 > 0.0 && radius <= WIDEST) {
            return self.error(
                params.span,
                format!("the filter's radius must be above 0 and at most {WIDEST} pixels"),
            );
        }
        self.scene.film.filter = match kind.as_str() {
            "box" => {
                if radius != 0.5 {
                    self.warn(params.span, "a box filter is one pixel wide here");
                }
                Filter::Box
            }
            "gaussian" => {
                let sigma = params.float("sigma", 0.5);
                if sigma < 1e-3 * radius || sigma > 16.0 {
                    return self.error(params.span, "`sigma` of this filter is out of range");
                }
                Filter::Gaussian(Gaussian { radius, sigma })
            }
            "mitchell" => {
                let within = |v: f64| if v > 0.0 { if v < 1.0 { v } else { 1.0 } } else { 0.0 };
                let [b, c] = ["B", "C"].map(|name| within(params.float(name, 1.0 / 3.0)));
                Filter::Mitchell(Mitchell { radius, b, c })
            }
            "sinc" => {
                let tau = params.float("tau", 3.0);
                // Its window is what straal's filter ends with.
                let radius = if tau > 0.0 && tau < radius { tau } else { radius };
                Filter::Lanczos(Lanczos { radius })
            }
            _ => Filter::Tent(Tent { radius }),
        };
        params.complain(&format!("the filter `{}`", kind.value), self.means.d);
    }

    fn sampler(&mut self) {
        let sampler = &mut self.scene.sampler;
        (sampler.kind, sampler.spp) = (SamplerKind::BlueSobol, 16);
        if let Some(seed) = self.options.seed {
            sampler.seed = seed;
        }
        let Some(Thing { kind, params }) = self.options.sampler.take() else { return };
        params.pass_over(&["randomization", "scramble"]);
        let mut samples = params.integer("pixelsamples", if kind.as_str() == "independent" { 4 } else { 16 });
        let pattern = match kind.as_str() {
            "zsobol" | "pmj02bn" => SamplerKind::BlueSobol,
            "paddedsobol" | "sobol" => SamplerKind::Sobol,
            "halton" => SamplerKind::Halton,
            "independent" => SamplerKind::Random,
            "stratified" => {
                let [x, y] = [params.integer("xsamples", 4), params.integer("ysamples", 4)];
                samples = x.saturating_mul(y);
                if params.bool("jitter", true) { SamplerKind::Jittered } else { SamplerKind::Regular }
            }
            "random" | "02sequence" | "lowdiscrepancy" | "maxmindist" => {
                let message = format!("the sampler `{}` is of pbrt-v3: `sobol` is used", kind.value);
                self.warn(kind.span, message);
                params.pass_over(&["dimensions"]);
                SamplerKind::Sobol
            }
            _ => {
                return self.unknown(
                    "sampler",
                    &kind,
                    &["zsobol", "paddedsobol", "halton", "sobol", "pmj02bn", "independent", "stratified"],
                );
            }
        };
        let sampler = &mut self.scene.sampler;
        sampler.kind = pattern;
        if let Some(seed) = params.maybe_integer("seed") {
            sampler.seed = u64::from(seed.unsigned_abs());
        }
        if (1..=MOST_SAMPLES).contains(&samples) {
            sampler.spp = samples.unsigned_abs();
        } else {
            let message = format!("samples of a pixel must be from 1 to {MOST_SAMPLES}, found {samples}");
            self.error(params.span, message);
        }
        params.complain(&format!("the sampler `{}`", kind.value), self.means.d);
    }

    fn integrator(&mut self) {
        let usual = |depth: i32| PathTracer {
            // pbrt counts where light is scattered; the camera's edge comes before.
            max_depth: Depth::Edges(depth.max(0).unsigned_abs().saturating_add(1)),
            ..PathTracer::default()
        };
        self.scene.integrator = Integrator::Path(usual(5));
        let Some(Thing { kind, params }) = self.options.integrator.take() else { return };
        let depth = params.integer("maxdepth", 5);
        params.pass_over(&["lightsampler", "lightsamplestrategy", "pixelbounds", "rrthreshold"]);
        let path = Integrator::Path(usual(depth));
        if params.bool("regularize", false) {
            self.warn(params.span, "`regularize` is passed over: what is glossy stays so after a bounce");
        }
        self.scene.integrator = match kind.as_str() {
            "path" => path,
            "volpath" => path,
            "simplepath" | "simplevolpath" => {
                let technique = match (params.bool("samplelights", true), params.bool("samplebsdf", true)) {
                    (false, _) => Technique::Bsdf,
                    (true, _) => Technique::Mis,
                };
                let roulette = Roulette::Off;
                Integrator::Path(PathTracer { technique, roulette, ..usual(depth) })
            }
            "randomwalk" => {
                let (technique, roulette) = (Technique::Bsdf, Roulette::Off);
                Integrator::Path(PathTracer { technique, roulette, ..usual(depth) })
            }
            "ao" => {
                let radius = params.maybe_float("maxdistance").filter(|r| (*r as f32) > 0.0);
                let directions = if params.bool("cossample", true) {
                    OcclusionWarp::Cosine
                } else {
                    OcclusionWarp::Uniform
                };
                let falloff = OcclusionFalloff::None;
                Integrator::Ao(AmbientOcclusion { radius, falloff, directions, rays: 1 })
            }
            "directlighting" => {
                let message = "the integrator `directlighting` is of pbrt-v3: light after the first surface is left out";
                self.warn(kind.span, message);
                params.pass_over(&["strategy"]);
                let technique = Technique::Mis;
                Integrator::Direct(DirectLight {
                    technique,
                    light_samples: 1,
                    bsdf_samples: 1,
                    ..DirectLight::default()
                })
            }
            "lightpath" => Integrator::Light(LightTracer {
                max_depth: Depth::Edges(depth.max(0).unsigned_abs().saturating_add(1)),
                ..LightTracer::default()
            }),
            "bdpt" | "mlt" | "sppm" | "whitted" | "function" => {
                let message = format!(
                    "the integrator `{}` is replaced by `path`: the same light, by paths from the camera",
                    kind.value
                );
                self.warn(kind.span, message);
                params.pass_over(&[
                    "visualizestrategies",
                    "visualizeweights",
                    "bootstrapsamples",
                    "chains",
                    "mutationsperpixel",
                    "largestepprobability",
                    "sigma",
                    "photonsperiteration",
                    "iterations",
                    "numiterations",
                    "radius",
                    "seed",
                    "function",
                ]);
                path
            }
            _ => {
                return self.unknown(
                    "integrator",
                    &kind,
                    &[
                        "path",
                        "volpath",
                        "simplepath",
                        "simplevolpath",
                        "lightpath",
                        "bdpt",
                        "mlt",
                        "sppm",
                        "ao",
                        "randomwalk",
                        "function",
                    ],
                );
            }
        };
        params.complain(&format!("the integrator `{}`", kind.value), self.means.d);
    }
}
