//! OpenEXR: any channels of any layers as 32-bit floats.
//!
//! Read are scan lines and tiles (the largest resolution), uncompressed or with RLE, ZIP, PIZ or PXR24. Refused are
//! deep and subsampled files, and the compressions whose decoders in the `exr` crate (1.74) don't bear a damaged file:
//! B44 runs into arithmetic overflow, DWA allocates whatever the file says. Written are 32-bit floats in scan lines with ZIP compression, all layers in
//! one part, as every compositor reads it: the channel R of the layer albedo is called `albedo.R`.

use straal_color::{RgbSpace, Space};
use straal_scene::Image;

use self::choose::{Choice, Kind, Names};
use crate::ReadError;

mod choose;
mod read;
mod spectral;
mod strips;
mod write;

pub(super) use read::header;
pub use read::{read, read_colours};
pub use spectral::{
    Contents as SpectralContents, LAYER as SPECTRAL_LAYER, is_attribute as is_spectral_attribute,
    is_layer as is_spectral_layer, layer as spectral_layer,
};
pub use strips::Strips;
pub use write::{StripWriter, write, write_with};

/// A picture with layers of any channels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layered {
    /// The frame that is shown.
    pub display_window: Window,
    /// The part of the plane that has pixels: the whole frame, or a crop of it.
    pub data_window: Window,
    /// The linear RGB space of the colours, where the file says it (attribute `chromaticities`).
    pub space: Option<RgbSpace>,
    /// The layers; the beauty picture is the one without a name.
    pub layers: Vec<Layer>,
    /// Text attributes by name, in alphabetical order when read.
    pub metadata: Vec<(String, String)>,
    /// What a person should know of how it was read, each a sentence without a full stop; not written.
    pub notes: Vec<String>,
}

/// A rectangle of pixels; x goes right, y down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window {
    /// The leftmost column.
    pub x: i32,
    /// The topmost row.
    pub y: i32,
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
}

/// Channels that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// The name before the channels' last dot; empty for the picture itself.
    pub name: String,
    /// The channels: in a file they are sorted by name.
    pub channels: Vec<Channel>,
}

/// One number for every pixel of the data window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// The name without the layer's: R, G, B, Y, Z...
    pub name: String,
    /// The samples row by row from the top. Integers of the file are converted, exactly up to 2^24.
    pub samples: Vec<f32>,
}

impl Layered {
    /// A picture without layers whose windows are both `width` x `height`.
    pub fn of_size(width: usize, height: usize) -> Self {
        let window = Window::of_size(width, height);
        Self { display_window: window, data_window: window, ..Self::default() }
    }

    /// The layer of that name; the picture itself has the empty name.
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// The whole picture as linear RGB with the primaries of sRGB: that of [`Layered::beauty`], within the display window.
    pub fn to_image(&self) -> Result<Image, ReadError> {
        Ok(super::Photo::of_exr(self, None)?.to_srgb())
    }

    /// The colours of the picture: the layer without a name, else the one whose name says so (`Combined`, `beauty`, `rgba`), else
    /// the sum of its wavelengths, of radiance or of reflectance under D65, else other colours, else grey.
    pub fn beauty(&self) -> Result<Beauty, ReadError> {
        self.colours(&choice(&self.names(), None)?)
    }

    /// The colours of a layer by its name, or by the end of it.
    pub fn colours_of(&self, layer: &str) -> Result<Beauty, ReadError> {
        self.colours(&choice(&self.names(), Some(layer))?)
    }

    fn names(&self) -> Vec<Names> {
        let channels = |l: &Layer| l.channels.iter().map(|c| c.name.clone()).collect();
        self.layers.iter().map(|l| Names { layer: l.name.clone(), channels: channels(l) }).collect()
    }

    fn colours(&self, choice: &Choice) -> Result<Beauty, ReadError> {
        let missing = || ReadError::file("the picture's channels are not there");
        let layer = || self.layers.iter().find(|l| l.name == choice.layer).ok_or_else(missing);
        let triples = || match choice.channels.as_slice() {
            [a, b, c] => layer()?.triples([a, b, c]).ok_or_else(missing),
            _ => Err(missing()),
        };
        let (pixels, space) = match choice.kind {
            Kind::Rgb => (triples()?, self.space),
            Kind::Xyz => (triples()?, Some(RgbSpace::XYZ)),
            Kind::Chroma => (self.chroma_as_rgb(triples()?), self.space),
            Kind::Grey => {
                let channel = choice.channels.first().and_then(|name| layer().ok()?.channel(name));
                (channel.ok_or_else(missing)?.iter().map(|&y| [y; 3]).collect(), self.space)
            }
            Kind::Spectral => {
                let pixels = spectral::pixels(self, &choice.layer).ok_or_else(missing)?;
                (pixels, Some(RgbSpace::XYZ))
            }
        };
        let notes = self.notes.iter().chain(&choice.note).cloned().collect();
        Ok(Beauty { pixels, space, layer: choice.layer.clone(), notes })
    }

    /// Luminance Y and the differences RY = R / Y - 1 and BY = B / Y - 1 as R, G and B, by how bright each of the file's primaries
    /// is (OpenEXR, *Technical Introduction*, 'Luminance/Chroma Images').
    fn chroma_as_rgb(&self, mut pixels: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
        let [red, green, blue] = self.space.unwrap_or(Space::Srgb.rgb()).luminance();
        for pixel in &mut pixels {
            let [y, ry, by] = pixel.map(f64::from);
            let (r, b) = ((ry + 1.0) * y, (by + 1.0) * y);
            *pixel = [r, (y - r * red - b * blue) / green, b].map(|v| v as f32);
        }
        pixels
    }
}

/// Which of these layers is the picture; or how the one of that name is shown.
fn choice(layers: &[Names], wanted: Option<&str>) -> Result<Choice, ReadError> {
    let spectral = spectral::summed(layers);
    match (wanted, spectral) {
        (None, _) => choose::choose(layers, spectral).ok_or_else(nothing_to_show),
        (Some(layer), Some(spectral)) if layer == spectral => Ok(Choice::spectral(layer)),
        (Some(layer), _) => choose::named(layers, layer).map_err(ReadError::file),
    }
}

fn nothing_to_show() -> ReadError {
    let message = "the file has no layer with channels R, G and B, or X, Y and Z, or Y, nor any of wavelengths \
                   (S0.550,000nm or T.550,000nm)";
    ReadError::file(message)
}

/// The colours of a picture with layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Beauty {
    /// Row by row from the top.
    pub pixels: Vec<[f32; 3]>,
    /// What the three numbers are, where the file says it.
    pub space: Option<RgbSpace>,
    /// The layer they come from.
    pub layer: String,
    /// What a person should know of how they were found, each a sentence without a full stop.
    pub notes: Vec<String>,
}

impl Window {
    /// The smallest window that holds both.
    fn around(&self, other: &Self) -> Self {
        let across = hull((self.x, self.width), (other.x, other.width));
        let down = hull((self.y, self.height), (other.y, other.height));
        Self { x: across.0, y: down.0, width: across.1, height: down.1 }
    }

    /// A window whose first pixel is (0, 0).
    pub fn of_size(width: usize, height: usize) -> Self {
        Self { x: 0, y: 0, width, height }
    }
}

/// The smallest interval that holds both, each a start and a length.
fn hull(a: (i32, usize), b: (i32, usize)) -> (i32, usize) {
    let start = a.0.min(b.0);
    let end = |(start, length): (i32, usize)| i64::from(start) + length as i64;
    (start, (end(a).max(end(b)) - i64::from(start)) as usize)
}

impl Layer {
    /// A layer with the channels R, G and B.
    pub fn from_rgb(name: &str, pixels: &[[f32; 3]]) -> Self {
        let channel = |(k, name): (usize, &str)| Channel {
            name: name.to_string(),
            samples: pixels.iter().map(|pixel| pixel[k]).collect(),
        };
        Self {
            name: name.to_string(),
            channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect(),
        }
    }

    /// The channel of that name.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| channel.samples.as_slice())
    }

    /// The pixels of a layer with R, G and B; grey from Y, or from the only channel there is.
    pub fn rgb(&self) -> Option<Vec<[f32; 3]>> {
        let only = || (self.channels.len() == 1).then(|| self.channels[0].samples.as_slice());
        let grey = || self.channel("Y").or_else(only);
        self.triples(["R", "G", "B"]).or_else(|| Some(grey()?.iter().map(|&y| [y; 3]).collect()))
    }

    /// The pixels of three channels.
    fn triples(&self, names: [&str; 3]) -> Option<Vec<[f32; 3]>> {
        let [a, b, c] = names.map(|name| self.channel(name));
        Some(a?.iter().zip(b?).zip(c?).map(|((&a, &b), &c)| [a, b, c]).collect())
    }
}
