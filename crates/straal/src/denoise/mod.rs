//! A clean picture of a noisy one.
//!
//! The network of [`straal_denoise`] sees the picture's light and, where they are there, albedo and normal of what each pixel shows.

mod fireflies;
mod guides;

pub use fireflies::Fireflies;
pub use guides::Guides;
pub use straal_denoise::{Network, Signal, Weights, WeightsError};

use crate::develop::PictureFile;
use std::fmt;
use straal_denoise::{DenoiseError, Settings};
use straal_math::simd::{Isa, Simd};

/// How much work the network does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Effort {
    /// The usual network.
    #[default]
    Best,
    /// A smaller network: a third of the work, a little less clean. Without guides there is none, and the usual one is taken.
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

    /// The weights for pictures with all guides, or with none.
    fn weights(self, is_guided: bool) -> Weights {
        match (is_guided, self) {
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
#[derive(Clone, Debug, Default)]
pub struct Denoising {
    /// How much work the network does.
    pub effort: Effort,
    /// A network with other weights, and its name.
    pub network: Option<(String, Network)>,
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
    pub settings: Settings,
    pool: rayon::ThreadPool,
    /// Name of the weights.
    pub name: String,
    /// Which guides it sees.
    pub sees: [bool; 2],
    pub notes: Vec<String>,
}

impl Denoising {
    /// The network for a picture with these guides.
    pub(crate) fn ready(&self, guides: &Guides) -> Result<Ready, NoDenoise> {
        let (has_albedo, has_normal) = (guides.albedo.is_some(), guides.normal.is_some());
        let mut notes = Vec::new();
        let (name, network) = match &self.network {
            Some((name, network)) => (name.clone(), network.clone()),
            None => {
                let weights = self.effort.weights(has_albedo && has_normal);
                (weights.name().to_owned(), weights.network()?)
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
        Ok(Ready { network, settings, pool, name, sees, notes })
    }
}

impl Ready {
    /// Clean light.
    pub fn run(&self, noisy: &Noisy<'_>) -> Result<Vec<[f32; 3]>, NoDenoise> {
        let [albedo, normal] = [&noisy.guides.albedo, &noisy.guides.normal];
        let picture = straal_denoise::Picture {
            width: noisy.width,
            height: noisy.rgb.len() / if noisy.width > 0 { noisy.width } else { 1 },
            color: noisy.rgb,
            albedo: albedo.as_deref().filter(|_| self.sees[0]),
            normal: normal.as_deref().filter(|_| self.sees[1]),
        };
        let run = || straal_denoise::denoise(&self.network, &picture, &self.settings);
        Ok(self.pool.install(run)?)
    }

    /// Names of the guides that the network sees.
    pub fn guides(&self, guides: &Guides) -> Vec<String> {
        let names = [(&guides.albedo_name, self.sees[0]), (&guides.normal_name, self.sees[1])];
        names.into_iter().filter(|(_, sees)| *sees).map(|(name, _)| name.clone()).collect()
    }
}

impl PictureFile {
    /// Denoises the picture. Guides are the layers that are called so by straal and other renderers (`albedo`, `normal`, `Denoising
    /// Albedo`, `N`, ...). The light as it was stays as the layer `noisy`; alpha and all other layers stay, but for the variance,
    /// the error and wavelengths of what the picture no longer is.
    pub fn denoise(&mut self, how: &Denoising) -> Result<Denoised, NoDenoise> {
        if let Some(told) = self.told(DENOISED) {
            return Err(NoDenoise::Twice(told.to_owned()));
        }
        let guides = Guides::of(&self.picture, &self.photo.layer);
        let ready = how.ready(&guides)?;
        let noisy = self.photo.pixels.clone();
        let width = self.photo.part.width;
        let fireflies = how.fireflies.map(|times| fireflies::remove(width, &mut self.photo.pixels, times));
        let clean = ready.run(&Noisy { width, rgb: &self.photo.pixels, guides: &guides })?;
        let mut notes = ready.notes.clone();
        notes.extend(guides.notes.iter().cloned());
        if self.replace_light(clean, &noisy) {
            notes.push("light by wavelengths isn't denoised and is left out".into());
        }
        let guides = ready.guides(&guides);
        let told = [ready.name.as_str()].into_iter().chain(guides.iter().map(String::as_str));
        let told = told.collect::<Vec<_>>().join(", ");
        self.picture.metadata.push((DENOISED.into(), told));
        Ok(Denoised { weights: ready.name, guides, fireflies, notes })
    }
}
