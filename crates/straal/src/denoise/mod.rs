//! A clean picture of a noisy one.
//!
//! The network of [`straal_denoise`] sees the picture's light and, where they are there, albedo and normal of what each pixel shows.

mod blend;
mod edges;
mod file;
mod fireflies;
mod groups;
mod guides;
mod shares;

pub use file::{NoisyFile, Source};
pub use fireflies::Fireflies;
pub use guides::Guides;
pub use straal_denoise::{Network, Signal, Weights, WeightsError};

use crate::job::{Seen, SeenLight};
use crate::picture::Picture;
use edges::Edges;
use std::fmt;
use straal_denoise::{DenoiseError, Settings};
use straal_formats::ReadError;
use straal_math::simd::{Isa, Simd};
use straal_render::film::channel::{self, Channel};
use straal_render::film::{BLOCK, CLAMPED, DARK, HalfPictures, Region};

/// How much work the network does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Effort {
    /// The usual network.
    #[default]
    Best,
    /// A single, smaller network: a little less clean. Without guides there is none, and the usual one is taken.
    Fast,
}

impl Effort {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Best, Self::Fast];

    /// The name as it is typed.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Best => "best",
            Self::Fast => "fast",
        }
    }

    /// The weights for pictures with all guides, which have no noise or some, or with none.
    fn weights(self, is_guided: bool, is_clean: bool) -> Weights {
        match (is_guided, self) {
            (true, Self::Best) if is_clean => Weights::CleanGuided,
            (true, Self::Best) => Weights::Guided,
            (true, Self::Fast) => Weights::GuidedFast,
            (false, _) => Weights::Light,
        }
    }
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// How a picture is denoised.
///
/// ```
/// # use straal::{Control, EMBEDDED_SCENE, Job, LoadOptions, Overrides, denoise::Denoising, load_str};
/// # let loaded = load_str("scene", EMBEDDED_SCENE, "".as_ref(), &LoadOptions::default()).map_err(|_| "wrong")?;
/// let few = Overrides { size: Some([16, 9]), spp: Some(4), ..Overrides::default() };
/// let mut picture = Job::new(loaded, few)?.render(&mut Control::to_the_end())?.picture;
/// let denoised = picture.denoise(&Denoising::default(), None)?;
/// assert_eq!(denoised.guides, ["albedo", "normal"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Denoising {
    /// How much work the network does.
    pub effort: Effort,
    /// A network with other weights, and its name.
    pub network: Option<(String, Network)>,
    /// Networks that take the noise out of albedo and normals before they guide: for weights that want guides without noise.
    pub prefilters: [Option<Network>; 2],
    /// Take away light of single pixels that are brighter than this many times what is around them, before anything else.
    pub fireflies: Option<f32>,
    /// Worker threads; all cores when absent. They change the speed only.
    pub threads: Option<usize>,
    /// Instruction set; the best that the processor has when absent. It changes the speed only.
    pub isa: Option<Isa>,
}

/// What was done to a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// Name of the weights.
    pub weights: String,
    /// What guided the network.
    pub guides: Vec<String>,
    /// What was taken away before, where that was asked for.
    pub fireflies: Option<Fireflies>,
    /// Of a render: the relative error of each block of 8 x 8 pixels, as film noise is told; empty where it isn't known.
    pub noise: Vec<f64>,
    /// The share of the denoised picture in the result, where it was weighed against the noisy one.
    pub weight: Option<f64>,
    /// What a person should know, each a sentence without a full stop.
    pub notes: Vec<String>,
}

/// Why a picture isn't denoised.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NoDenoise {
    /// It was before.
    #[error("it was denoised before ({0}): what looks like light to the network is its own invention")]
    Twice(String),
    /// The picture and the network don't fit.
    #[error(transparent)]
    Network(#[from] DenoiseError),
    /// The picture can't be read to its end.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The weights are none.
    #[error("the weights can't be read: {0}")]
    Weights(#[from] WeightsError),
    /// This processor hasn't the instruction set.
    #[error("this processor has no {0}")]
    Isa(Isa),
    /// The system gives no threads.
    #[error("no threads can be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// The key of the metadata under which a denoised picture tells by which weights and guides.
pub const DENOISED: &str = "straal.denoised";

/// The key under which it tells that its groups of lights are clean as well.
pub(crate) const GROUPS_DENOISED: &str = "straal.denoised_groups";

/// The layer that keeps the noisy light.
pub const NOISY: &str = "noisy";

/// A noisy picture with its guides, by rows from the top left.
#[derive(Clone, Copy, Debug)]
pub struct Noisy<'a> {
    /// Pixels of a row.
    pub width: usize,
    /// Light.
    pub rgb: &'a [[f32; 3]],
    /// What guides the network.
    pub guides: &'a Guides,
}

/// A network that is ready, with what it is to see.
pub(crate) struct Ready {
    pub network: Network,
    /// Others for the same, whose mistakes are others.
    pub others: Option<[Network; shares::NETWORKS - 1]>,
    pub settings: Settings,
    pool: rayon::ThreadPool,
    /// Name of the weights.
    pub name: String,
    /// Which guides it sees.
    pub sees: [bool; 2],
    pub notes: Vec<String>,
}

/// Networks beside the one for guides without noise. The last one sees the light alone, and knows shadows best, which no guide tells.
const OTHERS: [Weights; shares::NETWORKS - 1] = [Weights::Guided, Weights::Light];

impl Denoising {
    /// The network for a picture with these guides, which are as good as without noise or not.
    pub(crate) fn ready(&self, guides: &Guides, is_clean: bool) -> Result<Ready, NoDenoise> {
        let (has_albedo, has_normal) = (guides.albedo.is_some(), guides.normal.is_some());
        let mut notes = Vec::new();
        let (name, network, others) = match &self.network {
            Some((name, network)) => (name.clone(), network.clone(), None),
            None => {
                let weights = self.effort.weights(has_albedo && has_normal, is_clean);
                let others = match weights {
                    Weights::CleanGuided => Some([OTHERS[0].network()?, OTHERS[1].network()?]),
                    _ => None,
                };
                (weights.name().to_owned(), weights.network()?, others)
            }
        };
        let sees = [network.inputs() >= 2, network.inputs() >= 3];
        if network.inputs() == 1 {
            let unused = match (has_albedo, has_normal) {
                (true, false) => Some("albedo without normals"),
                (false, true) => Some("normals without albedo"),
                _ => None,
            };
            notes.extend(unused.map(|unused| {
                format!("the picture has {unused}; the network wants both, and sees the light alone")
            }));
            if !has_albedo && !has_normal {
                notes.push(
                    "the picture has no layers of albedo and normals: fine detail of textures may be lost"
                        .to_owned(),
                );
            }
        }
        let simd = match self.isa {
            Some(isa) => Simd::new(isa).ok_or(NoDenoise::Isa(isa))?,
            None => Simd::best(),
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads.unwrap_or(0)).build()?;
        let settings = pool.install(|| Settings { simd, ..Settings::default() });
        Ok(Ready { network, others, settings, pool, name, sees, notes })
    }
}

impl Ready {
    /// What all networks make of some light, the first one first; nothing if there is but one.
    fn run_all(&self, noisy: &Noisy<'_>) -> Result<Option<shares::Pictures>, NoDenoise> {
        let Some([second, third]) = &self.others else { return Ok(None) };
        Ok(Some([self.run(noisy)?, self.run_by(second, noisy)?, self.run_by(third, noisy)?]))
    }

    /// Clean light of both halves, as the mean of what the networks make of it, and their shares in it.
    fn run_halves(&self, [a, b]: [Noisy<'_>; 2]) -> Result<([shares::Light; 2], shares::Shares), NoDenoise> {
        let (Some(of_a), Some(of_b)) = (self.run_all(&a)?, self.run_all(&b)?) else {
            return Ok(([self.run(&a)?, self.run(&b)?], shares::USUAL));
        };
        let mut made = [of_a, of_b];
        let shares = self.install(|| shares::shares(a.width, [a.rgb, b.rgb], made.each_ref()));
        let mut mean = |half: usize| shares::mean(std::mem::take(&mut made[half]), shares);
        Ok(([mean(0), mean(1)], shares))
    }

    /// Clean light, of several networks as the mean by such shares. These see the picture in a mirror as well: a network makes other mistakes there, so that the mean of both has
    /// 2 to 4 % less error on reference scenes.
    fn run_shared(&self, noisy: &Noisy<'_>, shares: shares::Shares) -> Result<Vec<[f32; 3]>, NoDenoise> {
        let Some(all) = self.run_all(noisy)? else { return self.run(noisy) };
        let mut out = shares::mean(all, shares);
        let mirror = |rgb: &[[f32; 3]]| shares::mirrored(noisy.width, rgb);
        let rgb = mirror(noisy.rgb);
        let Guides { albedo, normal, .. } = noisy.guides;
        let [albedo, normal] = [albedo, normal].map(|guide| guide.as_deref().map(mirror));
        let guides = Guides { albedo, normal, ..Guides::default() };
        if let Some(all) = self.run_all(&Noisy { width: noisy.width, rgb: &rgb, guides: &guides })? {
            let back = mirror(&shares::mean(all, shares));
            out.as_flattened_mut().iter_mut().zip(back.as_flattened()).for_each(|(v, w)| *v = 0.5 * (*v + w));
        }
        Ok(out)
    }

    /// Clean light of one network.
    pub fn run(&self, noisy: &Noisy<'_>) -> Result<Vec<[f32; 3]>, NoDenoise> {
        self.run_by(&self.network, noisy)
    }

    fn run_by(&self, network: &Network, noisy: &Noisy<'_>) -> Result<Vec<[f32; 3]>, NoDenoise> {
        let [albedo, normal] = [&noisy.guides.albedo, &noisy.guides.normal];
        let picture = straal_denoise::Picture {
            width: noisy.width,
            height: noisy.rgb.len() / if noisy.width > 0 { noisy.width } else { 1 },
            color: noisy.rgb,
            albedo: albedo.as_deref().filter(|_| network.inputs() >= 2),
            normal: normal.as_deref().filter(|_| network.inputs() >= 3),
        };
        let run = || straal_denoise::denoise(network, &picture, &self.settings);
        Ok(self.pool.install(run)?)
    }

    /// The guides without their noise, as far as there are networks for that.
    pub fn prefiltered(
        &self,
        how: &Denoising,
        mut guides: Guides,
        width: usize,
    ) -> Result<Guides, NoDenoise> {
        let layers = [&mut guides.albedo, &mut guides.normal];
        for (network, layer) in how.prefilters.iter().zip(layers) {
            if let (Some(network), Some(layer)) = (network, layer) {
                let height = layer.len() / width.max(1);
                let picture =
                    straal_denoise::Picture { width, height, color: layer, albedo: None, normal: None };
                *layer = self.pool.install(|| straal_denoise::denoise(network, &picture, &self.settings))?;
            }
        }
        Ok(guides)
    }

    /// Does something on the threads.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        self.pool.install(work)
    }

    /// Puts the names of all networks, with their shares, in place of the first one's.
    fn tell(&mut self, shares: shares::Shares) {
        if self.others.is_some() {
            let [first, second, third] = shares.map(|share| (100.0 * share).round());
            let [more, most] = OTHERS.map(Weights::name);
            self.name = format!("{} {first} %, {more} {second} % and {most} {third} %", self.name);
        }
    }

    /// What a picture tells of it: the weights, and what they saw.
    pub fn told(&self, guides: &Guides) -> String {
        let guides = self.guides(guides);
        let told = [self.name.as_str()].into_iter().chain(guides.iter().map(String::as_str));
        told.collect::<Vec<_>>().join(", ")
    }

    /// Names of the guides that the network sees.
    pub fn guides(&self, guides: &Guides) -> Vec<String> {
        let names = [(&guides.albedo_name, self.sees[0]), (&guides.normal_name, self.sees[1])];
        names.into_iter().filter(|(_, sees)| *sees).map(|(name, _)| name.clone()).collect()
    }
}

impl Denoised {
    /// Blocks of 8 x 8 pixels whose error is greater than this.
    pub fn blocks_noisier_than(&self, noise: f64) -> u64 {
        self.noise.iter().filter(|n| **n > noise).count() as u64
    }

    /// The error of the block whose first pixel in the whole picture this is, of a picture of `crop`.
    pub(crate) fn noise_at(&self, crop: Region, first: [u32; 2]) -> Option<f64> {
        let across = crop.max[0].div_ceil(BLOCK).checked_sub(crop.min[0] / BLOCK)?;
        let [x, y] = [0, 1].map(|a| (first[a] / BLOCK).checked_sub(crop.min[a] / BLOCK));
        let x = x.filter(|x| *x < across)?;
        self.noise.get(y? as usize * across as usize + x as usize).copied()
    }

    /// The error that nineteen of twenty blocks are within, where it is known.
    pub fn noise(&self) -> Option<f64> {
        let mut sorted = self.noise.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get((sorted.len() * 19 / 20).min(sorted.len().saturating_sub(1))).copied()
    }
}

impl Denoising {
    /// Bytes of a pixel that denoising takes while the film is there: two halves, and the share of one.
    pub(crate) const BYTES_WITH_FILM: u64 = 2 * 12 + 4;

    /// Bytes that denoising a rendered picture takes besides its layers, when the film is gone: light and two halves, noisy and clean, what three networks make of it, guides, upright and in a mirror, what camera rays see of lamps, and what the
    /// weights are found by; and the network's rows.
    pub(crate) fn bytes(&self, crop: Region) -> u64 {
        const A_PIXEL: u64 = 13 * 12 + 2 * 12 + 12 + 3 * 12 + 7 * 4;
        // Measured, with twice the rows for many threads.
        const A_COLUMN: u64 = 70_000;
        (crop.area() as u64).saturating_mul(A_PIXEL).saturating_add(u64::from(crop.width()) * A_COLUMN)
    }
}

impl Picture {
    /// Denoises a rendered picture. Where it is known as two halves, these are denoised as well: what they differ by tells how far the result is from the truth, which becomes
    /// the layer `error`, and in which share the noisy light is nearer to it, which is blended back.
    pub fn denoise(&mut self, how: &Denoising, halves: Option<&HalfPictures>) -> Result<Denoised, NoDenoise> {
        self.denoise_apart(how, halves.cloned(), None)
    }

    /// The same with what camera rays tell by themselves.
    pub(crate) fn denoise_apart(
        &mut self,
        how: &Denoising,
        halves: Option<HalfPictures>,
        seen: Option<Seen>,
    ) -> Result<Denoised, NoDenoise> {
        if self.noisy.is_some() {
            return Err(NoDenoise::Twice(self.tells("denoised").unwrap_or_default().to_owned()));
        }
        let own = |channel: &'static Channel| {
            let values = self.layers.channel(channel)?.values.as_chunks::<3>().0;
            (values.len() == self.layers.rgb.len()).then_some(values)
        };
        let own = [own(&channel::ALBEDO), own(&channel::NORMAL)];
        let name = |channel: &Channel| channel.layer.to_owned();
        let (is_seen, is_clean) = (seen.is_some(), seen.as_ref().is_some_and(|seen| seen.is_clean));
        let (mut light, [albedo, normal]) = match seen {
            Some(seen) => (seen.light, seen.guides.map(Some)),
            None => (None, own.map(|own| own.map(<[_]>::to_vec))),
        };
        let guides = Guides {
            albedo,
            normal,
            albedo_name: name(&channel::ALBEDO),
            normal_name: name(&channel::NORMAL),
            ..Guides::default()
        };
        let mut ready = how.ready(&guides, is_clean)?;
        let width = self.layers.width;
        let guides = ready.prefiltered(how, guides, width)?;
        // What the network sees, in place of light that camera rays see by its own samples.
        let shown = |mut rgb: Vec<[f32; 3]>, own: Option<Vec<[f32; 3]>>, light: &Option<SeenLight>| {
            if let (Some(light), Some(own)) = (light, own) {
                add(&mut rgb, &own, -1.0);
                if !light.is_apart {
                    add(&mut rgb, &light.more, 1.0);
                }
            }
            let found = how.fireflies.map(|times| fireflies::remove(width, &mut rgb, times));
            (rgb, found)
        };
        let own_light = light.as_mut().map(|light| std::mem::take(&mut light.own));
        let (mut noisy, fireflies) = shown(self.layers.rgb.clone(), own_light, &light);
        let halves = halves.filter(|halves| halves.share.len() == noisy.len());
        let (shares, parts) = match halves {
            Some(HalfPictures { rgb: [a, b], share }) => {
                let [of_a, of_b] = match light.as_mut().map(|light| std::mem::take(&mut light.halves)) {
                    Some(own) => own.map(Some),
                    None => [None, None],
                };
                (Some(share), Some([shown(a, of_a, &light).0, shown(b, of_b, &light).0]))
            }
            None => (None, None),
        };
        let lamps = light.filter(|light| light.is_apart).map(|light| light.more);
        let with = |mut rgb: Vec<[f32; 3]>| {
            if let Some(lamps) = &lamps {
                add(&mut rgb, lamps, 1.0);
            }
            rgb
        };
        let (denoised, of_each) = match &parts {
            Some([a, b]) => {
                let (denoised, of_each) =
                    ready.run_halves([a, b].map(|rgb| Noisy { width, rgb, guides: &guides }))?;
                (Some(denoised), of_each)
            }
            None => (None, shares::USUAL),
        };
        if let ([Some(albedo), Some(normal)], Some(more), true) = (own, guides.both(), is_seen) {
            let first = match (&shares, &denoised) {
                (Some(shares), Some([a, b])) => blend::mean(shares, a, b),
                _ => ready.run(&Noisy { width, rgb: &noisy, guides: &guides })?,
            };
            let edges = Edges { width, own: [albedo, normal], more };
            ready.install(|| edges.correct(&mut noisy, &first));
        }
        let clean = with(ready.run_shared(&Noisy { width, rgb: &noisy, guides: &guides }, of_each)?);
        ready.tell(of_each);
        let noisy = with(noisy);
        let mut notes = ready.notes.clone();
        let (mut noise, mut weight) = (Vec::new(), None);
        let rgb = match (shares, parts, denoised) {
            (Some(share), Some(parts), Some(denoised)) => {
                let (parts, denoised) = (parts.map(with), denoised.map(with));
                let of = blend::Halves {
                    width,
                    noisy: [&parts[0], &parts[1]],
                    share: &share,
                    clean: [&denoised[0], &denoised[1]],
                };
                let blended = ready.install(|| blend::blend(&of, &noisy, &clean));
                noise = self.block_noise(&blended);
                let sum: f64 = blended.weight.iter().map(|w| f64::from(*w)).sum();
                weight = Some(sum / blended.weight.len().max(1) as f64);
                if let Some(error) = &mut self.layers.error {
                    error.rgb = blended.error;
                }
                blended.rgb
            }
            _ => {
                let why = "its error isn't known, and nothing is blended back: that takes two samples at least of each pixel, and none \
                           that counts in several";
                notes.push(why.to_owned());
                self.layers.error = None;
                clean
            }
        };
        if self.layers.groups.iter().any(|group| group.name != CLAMPED) {
            groups::denoise(&mut self.layers.groups, &ready, &guides, width, &rgb)?;
            self.metadata.push((GROUPS_DENOISED.into(), "yes".into()));
        }
        if self.layers.bands.take().is_some() {
            notes.push("light by wavelengths isn't denoised and is left out".into());
        }
        self.noisy = Some(std::mem::replace(&mut self.layers.rgb, rgb));
        self.metadata.push((DENOISED.into(), ready.told(&guides)));
        let guides = ready.guides(&guides);
        Ok(Denoised { weights: ready.name, guides, fireflies, noise, weight, notes })
    }

    /// The root mean square of the error over the mean brightness of each block, which is aligned to the whole picture.
    fn block_noise(&self, of: &blend::Blended) -> Vec<f64> {
        let [x0, y0] = self.crop.min;
        let across = (self.crop.max[0].div_ceil(BLOCK) - x0 / BLOCK) as usize;
        let down = (self.crop.max[1].div_ceil(BLOCK) - y0 / BLOCK) as usize;
        let mut blocks = vec![[0.0_f64; 3]; across * down];
        let width = self.layers.width.max(1);
        for (k, (rgb, error)) in of.rgb.iter().zip(&of.error).enumerate() {
            let [x, y] = [(k % width) as u32 + x0, (k / width) as u32 + y0];
            let block = (y / BLOCK - y0 / BLOCK) as usize * across + (x / BLOCK - x0 / BLOCK) as usize;
            for (v, e) in rgb.iter().zip(error) {
                let [v, e] = [*v, *e].map(f64::from);
                let sums = &mut blocks[block];
                *sums = [sums[0] + v.abs(), sums[1] + e * e, sums[2] + 1.0];
            }
        }
        let noise = |[brightness, square, count]: &[f64; 3]| {
            let brightness = brightness / count;
            (square / count).sqrt() / if brightness > DARK { brightness } else { DARK }
        };
        blocks.iter().filter(|b| b[2] > 0.0).map(noise).collect()
    }
}

/// Adds a picture times a factor of 1 or -1.
fn add(to: &mut [[f32; 3]], what: &[[f32; 3]], factor: f32) {
    let both = to.as_flattened_mut().iter_mut().zip(what.as_flattened());
    both.for_each(|(to, what)| *to += factor * what);
}
