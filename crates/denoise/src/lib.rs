//! A clean picture from a noisy one: the ray tracing network of Intel's Open Image Denoise, run by straal's own code.
//!
//! ```
//! use straal_denoise::{Picture, Settings, Weights, denoise};
//!
//! let noisy = vec![[0.5, 0.25, 0.125]; 20 * 10];
//! let picture = Picture { width: 20, height: 10, color: &noisy, albedo: None, normal: None };
//! let clean = denoise(&Weights::Light.network()?, &picture, &Settings::default())?;
//! assert_eq!(clean.len(), 200);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The weights are the ones that Intel trained and published (version 2.5.1, Apache-2.0; `data/NOTICE`), and so are the way a picture is
//! brought to the network's scale and back, and how it is completed to a multiple of sixteen pixels: for the same input the output is that of the original, but
//! for roundings. The arithmetic is in single precision and sums in one order, so that a picture comes out with the same bits on every
//! machine, for any number of threads and any instruction set.
//!
//! Where the original cuts large pictures into overlapping tiles, here rows are computed in bands from top to bottom, each once (`schedule.rs`). A
//! pixel sees no farther than the original's overlap, so that its tiles and these bands have the same result.
//!
//! Threads are those of the current `rayon` pool.
#![forbid(unsafe_code)]

mod convolution;
mod exposure;
mod network;
mod run;
mod schedule;
mod transfer;
mod tza;
mod weights;

pub use network::Network;
pub use weights::Weights;

use schedule::Schedule;
use std::borrow::Cow;
use std::ops::Range;
use straal_math::simd::Simd;
use transfer::Transfer;

/// What the numbers of a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Signal {
    /// Linear light of any brightness.
    Light,
    /// Shares of light, from 0 to 1.
    Albedo,
    /// Coordinates of unit vectors, from -1 to 1.
    Normal,
}

/// A noisy picture with what guides the network, all by rows from the top left.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// What is to become clean. NaN counts as 0, as do negative numbers of light.
    pub color: &'a [[f32; 3]],
    /// Share of light that the surface of each pixel reflects or passes on. Brought into 0 to 1.
    pub albedo: Option<&'a [[f32; 3]]>,
    /// Normal of the surface, in any frame that is the same for all pixels.
    pub normal: Option<&'a [[f32; 3]]>,
}

/// What guides the network in some rows of a picture, as in [`Picture`].
#[derive(Clone, Debug, Default)]
pub struct GuideRows<'a> {
    /// Share of light that the surface of each pixel reflects or passes on.
    pub albedo: Option<Cow<'a, [[f32; 3]]>>,
    /// Normal of the surface.
    pub normal: Option<Cow<'a, [[f32; 3]]>>,
}

/// How it is done. None of it changes the result but `exposure`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// By which instruction set.
    pub simd: Simd,
    /// Rows that are computed together, a multiple of 16: more of them keep more threads busy and take more memory.
    pub band: usize,
    /// What light is multiplied by for the network, and divided by after it; from the picture's own brightness where absent.
    pub exposure: Option<f32>,
}

impl Default for Settings {
    fn default() -> Self {
        let band = if rayon::current_num_threads() <= 8 { 16 } else { 64 };
        Self { simd: Simd::best(), band, exposure: None }
    }
}

/// Why an archive of weights is none that can be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// The first bytes are other.
    #[error("not an archive of weights (TZA)")]
    NoArchive,
    /// Of another version.
    #[error("an archive of version {0}: expected version 2")]
    Version(u8),
    /// It says of more bytes than it has.
    #[error("the archive is damaged or cut short")]
    Short,
    /// A tensor that is none of a network's.
    #[error("the tensor '{0}' has a shape or a type that doesn't fit")]
    Tensor(String),
    /// A tensor that every network has.
    #[error("the tensor '{0}' is missing")]
    Missing(String),
    /// A network that sees something else.
    #[error("the network sees {0} numbers of a pixel, which isn't what such a picture has")]
    Inputs(usize),
}

/// Why a picture wasn't denoised.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DenoiseError {
    /// A layer has other pixels than its width times its height.
    #[error("the layer of {layer} has {pixels} pixels: {width} x {height} were expected")]
    Size {
        /// Which.
        layer: &'static str,
        /// Its pixels.
        pixels: usize,
        /// The picture's width.
        width: usize,
        /// The picture's height.
        height: usize,
    },
    /// The network was trained with other layers than there are.
    #[error("these weights want {wanted}, but the picture has {given}")]
    Layers {
        /// What the network sees.
        wanted: &'static str,
        /// What it was given.
        given: &'static str,
    },
    /// An exposure that is no number, or not above 0.
    #[error("an exposure must be a number greater than 0")]
    Exposure,
    /// There are other guides for some rows than these rows have pixels.
    #[error("there are {pixels} pixels of {layer} for rows of {wanted}")]
    Rows {
        /// Which.
        layer: &'static str,
        /// Its pixels.
        pixels: usize,
        /// Pixels of these rows.
        wanted: usize,
    },
    /// The caller ended it.
    #[error("ended before the picture was done")]
    Ended,
}

/// Denoises a picture.
pub fn denoise(
    network: &Network,
    picture: &Picture<'_>,
    settings: &Settings,
) -> Result<Vec<[f32; 3]>, DenoiseError> {
    denoise_with(network, picture, settings, |_| true)
}

/// Denoises a picture; `progress` is told how many of its rows are done, and ends it by `false`.
pub fn denoise_with(
    network: &Network,
    picture: &Picture<'_>,
    settings: &Settings,
    progress: impl FnMut(usize) -> bool,
) -> Result<Vec<[f32; 3]>, DenoiseError> {
    check(network, picture)?;
    let mut out = picture.color.to_vec();
    let guides = |rows: Range<usize>| {
        let pixels = rows.start * picture.width..rows.end * picture.width;
        let [albedo, normal] = [picture.albedo, picture.normal]
            .map(|layer| layer.map(|layer| Cow::Borrowed(&layer[pixels.clone()])));
        Ok(GuideRows { albedo, normal })
    };
    denoise_in_place::<DenoiseError>(network, picture.width, &mut out, settings, guides, progress)?;
    Ok(out)
}

/// Denoises light of rows of that width where it stands, and asks for the guides of rows as they are needed: from the top, each row once. So neither a second picture nor
/// the guides need to be in memory.
pub fn denoise_in_place<'g, E: From<DenoiseError>>(
    network: &Network,
    width: usize,
    color: &mut [[f32; 3]],
    settings: &Settings,
    guides: impl FnMut(Range<usize>) -> Result<GuideRows<'g>, E>,
    progress: impl FnMut(usize) -> bool,
) -> Result<(), E> {
    if settings.exposure.is_some_and(|e| !(e.is_finite() && e > 0.0)) {
        return Err(DenoiseError::Exposure.into());
    }
    let pixels = color.len();
    if pixels == 0 {
        return Ok(());
    }
    let height = pixels.checked_div(width).unwrap_or(0);
    if height * width != pixels {
        return Err(DenoiseError::Size { layer: "colour", pixels, width, height }.into());
    }
    let exposure = settings.exposure.unwrap_or_else(|| match network.signal {
        Signal::Light => exposure::exposure(width, height, color),
        Signal::Albedo | Signal::Normal => 1.0,
    });
    let run = run::Run {
        network,
        width,
        height,
        transfer: Transfer::new(network.signal, exposure),
        simd: settings.simd,
        schedule: Schedule::new(network, width, height, settings.band),
    };
    run.run(color, guides, progress)
}

/// Bytes that denoising a picture of that size takes, besides the picture and the result.
pub fn working_bytes(network: &Network, width: usize, height: usize, settings: &Settings) -> usize {
    Schedule::new(network, width, height, settings.band).bytes()
}

fn check(network: &Network, picture: &Picture<'_>) -> Result<(), DenoiseError> {
    let Picture { width, height, color, albedo, normal } = *picture;
    let layers = [("colour", Some(color)), ("albedo", albedo), ("normals", normal)];
    for (layer, pixels) in layers.into_iter().filter_map(|(name, layer)| Some((name, layer?))) {
        if width.checked_mul(height) != Some(pixels.len()) {
            return Err(DenoiseError::Size { layer, pixels: pixels.len(), width, height });
        }
    }
    network.check([albedo.is_some(), normal.is_some()])
}
