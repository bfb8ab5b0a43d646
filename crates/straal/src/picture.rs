//! A finished picture: its layers, its story, and how it becomes a file.

use std::io;
use std::path::Path;
use straal_color::{Tone, srgb};
use straal_formats::atomic::{self, WriteError};
use straal_formats::image::exr::{self, Channel, Layer, Window};
use straal_formats::image::{pfm, png};
use straal_math::ops;
use straal_render::film::{Film, Layers};
use straal_render::settings::Region;
use straal_scene::Image;

/// How light becomes a picture for the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// In stops: each doubles the light.
    pub exposure: f32,
    /// What becomes of what is brighter than white.
    pub tone: Tone,
}

/// A rendered picture or a crop of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Size of the whole picture.
    pub size: [u32; 2],
    /// The part that `layers` holds.
    pub crop: Region,
    /// Radiance, its variance and the guides.
    pub layers: Layers,
    /// What the picture tells about itself: keys that start with `straal.`, and values.
    pub story: Vec<(String, String)>,
}

/// Why a picture wasn't written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The name's extension is none that can be written.
    #[error("can't tell the format of {0}: the name must end in .exr, .png or .pfm")]
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
    /// PNG, 8 bits, sRGB, developed.
    Png,
    /// Portable float map, linear.
    Pfm,
}

impl Format {
    /// By the name's extension.
    pub fn of(path: &Path) -> Result<Self, SaveError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            Some("pfm") => Ok(Self::Pfm),
            _ => Err(SaveError::Format(path.display().to_string())),
        }
    }
}

impl Picture {
    pub(crate) fn new(film: &Film, layers: Layers) -> Self {
        Self { size: film.size, crop: film.crop, layers, story: Vec::new() }
    }

    /// The value of a key of the story, which is written here without the leading `straal.`.
    pub fn tells(&self, key: &str) -> Option<&str> {
        self.story.iter().find(|(k, _)| k.strip_prefix("straal.") == Some(key)).map(|(_, v)| v.as_str())
    }

    /// Writes the picture, whole or not at all, in the format that the name's extension says.
    pub fn save(&self, path: &Path, look: &Look) -> Result<(), SaveError> {
        let format = Format::of(path)?;
        atomic::write(path, |mut file| match format {
            Format::Exr => exr::write(&mut file, &self.to_exr()),
            Format::Png => self.write_png(&mut file, look),
            Format::Pfm => pfm::write(&mut file, &self.to_image()),
        })?;
        Ok(())
    }

    /// Linear RGB alone.
    pub fn to_image(&self) -> Image {
        Image { width: self.layers.width, height: self.layers.height, pixels: self.layers.rgb.clone() }
    }

    fn to_exr(&self) -> exr::Picture {
        let l = &self.layers;
        let one = |name: &str, channel: &str, samples: Vec<f32>| Layer {
            name: name.into(),
            channels: vec![Channel { name: channel.into(), samples }],
        };
        let normal = {
            let mut layer = Layer::from_rgb("normal", &l.normal);
            for (channel, axis) in layer.channels.iter_mut().zip(["X", "Y", "Z"]) {
                channel.name = axis.into();
            }
            layer
        };
        let (x, y) = (self.crop.min[0] as i32, self.crop.min[1] as i32);
        exr::Picture {
            display_window: Window::of_size(self.size[0] as usize, self.size[1] as usize),
            data_window: Window { x, y, width: l.width, height: l.height },
            layers: vec![
                Layer::from_rgb("", &l.rgb),
                Layer::from_rgb("albedo", &l.albedo),
                normal,
                one("depth", "Z", l.depth.clone()),
                one("samples", "N", l.samples.iter().map(|&n| n as f32).collect()),
                Layer::from_rgb("variance", &l.variance),
            ],
            metadata: self.story.clone(),
        }
    }

    fn write_png(&self, out: &mut dyn io::Write, look: &Look) -> io::Result<()> {
        let factor = ops::exp2(look.exposure);
        let develop = |&rgb: &[f32; 3]| look.tone.apply(rgb, factor).map(srgb::encode_u8);
        let pixels: Vec<[u8; 3]> = self.layers.rgb.iter().map(develop).collect();
        let (width, height) = (self.layers.width, self.layers.height);
        png::write(out, &png::Encoded { width, height, pixels: &pixels, metadata: &self.story })
    }
}
