//! A finished picture: its layers, its metadata, and how it becomes a file.

use crate::denoise;
use crate::development::{self, Development, Undeveloped};
use crate::relight;
use std::io;
use std::path::Path;
use straal_color::RgbSpace;
use straal_formats::atomic::{self, WriteError};
use straal_formats::image::exr::{self, Channel, Layer, Window};
use straal_formats::image::{hdr, pfm, png};
use straal_render::film::Region;
use straal_render::film::channel::Source;
pub use straal_render::film::hash_of as film_hash;
use straal_render::film::{BandLayers, ChannelLayer, Film, Layers};
use straal_scene::Image;

/// A rendered picture or a crop of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Size of the whole picture.
    pub size: [u32; 2],
    /// The part that `layers` holds.
    pub crop: Region,
    /// Radiance, its variance and the guides.
    pub layers: Layers,
    /// The light as it was, where the picture is denoised; its error is in `layers` then.
    pub noisy: Option<Vec<[f32; 3]>>,
    /// What the three numbers of a pixel are: RGB of a space, or XYZ.
    pub space: RgbSpace,
    /// What the picture tells about itself: keys that start with `straal.`, and values.
    pub metadata: Vec<(String, String)>,
}

/// Why a picture wasn't written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The name's extension is none that can be written.
    #[error("can't tell the format of {0}: the name must end in .exr, .png, .hdr or .pfm")]
    Format(String),
    /// The disk refused.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// A format that pictures are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR, 32-bit float, linear, all layers.
    Exr,
    /// PNG, developed for the screen.
    Png,
    /// Radiance RGBE, linear sRGB.
    Hdr,
    /// Portable float map, linear sRGB.
    Pfm,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Exr, Self::Png, Self::Hdr, Self::Pfm];

    /// The name's extension.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exr => "exr",
            Self::Png => "png",
            Self::Hdr => "hdr",
            Self::Pfm => "pfm",
        }
    }

    /// By the name's extension.
    pub fn of(path: &Path) -> Result<Self, SaveError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            Some("hdr") => Ok(Self::Hdr),
            Some("pfm") => Ok(Self::Pfm),
            _ => Err(SaveError::Format(path.display().to_string())),
        }
    }
}

impl Picture {
    pub(crate) fn new(film: &Film, layers: Layers, space: RgbSpace) -> Self {
        Self { size: film.size, crop: film.crop, layers, noisy: None, space, metadata: Vec::new() }
    }

    /// The value of a key of the metadata, which is written here without the leading `straal.`.
    pub fn tells(&self, key: &str) -> Option<&str> {
        self.metadata.iter().find(|(k, _)| k.strip_prefix("straal.") == Some(key)).map(|(_, v)| v.as_str())
    }

    /// Writes the picture, whole or not at all, in the format that the name's extension says. A PNG is developed; an EXR
    /// tells in its metadata how it is developed, so that it can be developed again.
    pub fn save(&self, path: &Path, development: &Development) -> Result<(), SaveError> {
        let format = Format::of(path)?;
        atomic::write(path, |file| self.write(file, format, development))?;
        Ok(())
    }

    /// Writes the picture in that format to what takes bytes, such as a pipe.
    pub fn write(
        &self,
        out: &mut dyn io::Write,
        format: Format,
        development: &Development,
    ) -> io::Result<()> {
        match format {
            Format::Exr => {
                let picture = self.to_exr();
                let metadata = with_development(&picture.metadata, development);
                exr::write_with(out, &picture, &metadata)
            }
            Format::Png => {
                let undeveloped = Undeveloped {
                    pixels: &self.layers.rgb,
                    width: self.layers.width,
                    at: self.crop.min,
                    space: self.space,
                };
                write_png(out, &undeveloped, development, &with_development(&self.metadata, development))
            }
            Format::Hdr => hdr::write(out, &self.to_srgb()),
            Format::Pfm => pfm::write(out, &self.to_srgb()),
        }
    }

    /// Linear RGB alone, with the primaries of sRGB: formats that can't say otherwise are taken to have them.
    fn to_srgb(&self) -> Image {
        let mut image = self.to_image();
        if let Some(matrix) = development::to_screen(&self.space) {
            image.pixels.iter_mut().for_each(|pixel| *pixel = matrix.apply_f32(*pixel));
        }
        image
    }

    /// Linear RGB alone, of the picture's own space.
    pub fn to_image(&self) -> Image {
        Image { width: self.layers.width, height: self.layers.height, pixels: self.layers.rgb.clone() }
    }

    pub(crate) fn to_exr(&self) -> exr::Layered {
        let l = &self.layers;
        let is_whole = l.rgb.len() == l.samples.len();
        let (x, y) = (self.crop.min[0] as i32, self.crop.min[1] as i32);
        let mut layers = vec![Layer::from_rgb("", &l.rgb)];
        if is_whole {
            let seen = l.channels.iter().filter(|l| matches!(l.channel.source, Source::FirstHit(_)));
            seen.for_each(|channel| add_channel(&mut layers, channel));
            let samples = l.samples.iter().map(|&n| n as f32).collect();
            layers.push(Layer {
                name: "samples".into(),
                channels: vec![Channel { name: "N".into(), samples }],
            });
            if self.noisy.is_none() {
                layers.push(Layer::from_rgb("variance", &l.variance));
            }
        }
        if let Some(noisy) = &self.noisy {
            layers.push(Layer::from_rgb(denoise::NOISY, noisy));
        }
        let mut metadata = self.metadata.clone();
        if let Some(error) = &l.error {
            layers.push(Layer::from_rgb("error", &error.rgb));
            let by = if self.noisy.is_some() { "denoised halves" } else { error.estimate.name() };
            metadata.push((ERROR.to_owned(), by.to_owned()));
        }
        let groups = l.groups.iter().map(|group| (relight::layer_of(&group.name), &group.rgb));
        layers.extend(groups.map(|(name, rgb)| Layer::from_rgb(&name, rgb)));
        let costs = l.channels.iter().filter(|l| matches!(l.channel.source, Source::Search(_)));
        costs.for_each(|channel| add_channel(&mut layers, channel));
        if let Some(BandLayers { bands, planes }) = &l.bands {
            let middles = (0..bands.count()).map(|k| bands.center(k));
            let (layer, attributes) = exr::spectral_layer(middles.zip(planes.iter().cloned()));
            layers.push(layer);
            metadata.extend(attributes);
        }
        exr::Layered {
            display_window: Window::of_size(self.size[0] as usize, self.size[1] as usize),
            data_window: Window { x, y, width: l.width, height: l.height },
            space: Some(self.space),
            layers,
            metadata,
            notes: Vec::new(),
        }
    }
}

/// The metadata of a picture that is developed so, in the order in which an EXR is read: the same metadata give the same file
/// wherever it comes from.
pub(crate) fn with_development(
    metadata: &[(String, String)],
    development: &Development,
) -> Vec<(String, String)> {
    let other = metadata.iter().filter(|(key, _)| key != DEVELOPMENT).cloned();
    let mut all: Vec<_> = other.chain([(DEVELOPMENT.to_owned(), development.to_string())]).collect();
    all.sort();
    all
}

/// The key of the metadata under which the development settings are told.
pub(crate) const DEVELOPMENT: &str = "straal.look";

/// The key of the metadata under which an EXR tells by what its layer `error` is told.
pub(crate) const ERROR: &str = "straal.error";

/// Develops light and writes it.
pub(crate) fn write_png(
    out: &mut dyn io::Write,
    undeveloped: &Undeveloped<'_>,
    development: &Development,
    metadata: &[(String, String)],
) -> io::Result<()> {
    let codes = undeveloped.develop(development);
    let width = undeveloped.width;
    let height = undeveloped.pixels.len() / if width > 0 { width } else { 1 };
    let encoded =
        png::Encoded { width, height, pixels: codes.as_png(), curve: development.gamma.curve(), metadata };
    png::write(out, &encoded)
}

/// Adds a channel of the film to its layer, as channels of an EXR.
fn add_channel(layers: &mut Vec<Layer>, of: &ChannelLayer) {
    let new = of.channel.components.iter().enumerate();
    let new = new.map(|(c, name)| Channel { name: (*name).into(), samples: of.component(c).collect() });
    match layers.last_mut().filter(|layer| layer.name == of.channel.layer) {
        Some(layer) => layer.channels.extend(new),
        None => layers.push(Layer { name: of.channel.layer.into(), channels: new.collect() }),
    }
}
