//! A picture file developed again, without rendering: as a render with the same settings would have written it.

use crate::denoise;
use crate::development::{Bits, Development, Gamma, Undeveloped, to_screen};
use crate::focus::{self, Blur, NoBlur};
use crate::picture::{DEVELOPMENT, ERROR, Format, Picture, SaveError, with_development, write_png};
use std::borrow::Cow;
use std::io;
use std::path::Path;
use straal_color::{RgbSpace, Tone};
use straal_formats::image::exr::{self, Layer};
use straal_formats::image::{self, Faults, Photo, hdr, pfm, png};
use straal_formats::{Limits, ReadError, atomic};
use straal_scene::Image;

/// A picture as a file holds it: linear light, and in an EXR its layers and metadata.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFile {
    /// All that an EXR of it has; of another file its pixels.
    pub(crate) picture: exr::Layered,
    /// Its colours.
    pub(crate) photo: Photo,
}

/// The key of the metadata under which a picture that was developed before tells how.
const DEVELOPED: &str = "straal.developed";

/// The key of the metadata that is of the very pixels of a film.
const FILM_HASH: &str = "straal.film_hash";

impl From<&Picture> for PictureFile {
    /// What the picture's EXR holds, but for how it is to be developed, which a picture doesn't know.
    fn from(picture: &Picture) -> Self {
        let exr = picture.to_exr();
        let photo = Photo {
            format: image::Format::Exr,
            size: picture.size.map(|v| v as usize),
            part: exr.data_window,
            pixels: picture.layers.rgb.clone(),
            space: Some(picture.space),
            layer: String::new(),
            encoding: None,
            metadata: exr.metadata.clone(),
            notes: Vec::new(),
        };
        Self { picture: exr, photo }
    }
}

impl PictureFile {
    /// Reads an EXR, HDR, PFM or PNG.
    pub fn read(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        if image::Format::of(bytes)? == image::Format::Exr {
            let picture = exr::read(bytes, limits)?;
            let photo = Photo::of_exr(&picture, None)?;
            return Ok(Self { picture, photo });
        }
        Ok(Self::of_photo(Photo::read(bytes, limits)?))
    }

    /// Reads a layer of an EXR as if it were the picture, and nothing else of it.
    pub fn read_layer(bytes: &[u8], limits: &Limits, layer: &str) -> Result<Self, ReadError> {
        Ok(Self::of_photo(Photo::read_layer(bytes, limits, Some(layer))?))
    }

    /// A picture of colours alone.
    fn of_photo(mut photo: Photo) -> Self {
        let mut picture = exr::Layered::of_size(photo.size[0], photo.size[1]);
        picture.data_window = photo.part;
        picture.space = Some(photo.space_or_srgb());
        picture.layers.push(Layer::from_rgb("", &photo.pixels));
        // The fingerprint is of the film, from which a screen's picture or another layer was made, and of other layers nothing is left.
        let is_of_others = |key: &str| [FILM_HASH, ERROR].contains(&key) || exr::is_spectral_attribute(key);
        photo.metadata.retain(|(key, _)| !is_of_others(key));
        if photo.format == image::Format::Png {
            // What was done to the light before stays told, but is not to be done again.
            photo.metadata.retain(|(key, _)| key != DEVELOPED);
            photo
                .metadata
                .iter_mut()
                .filter(|(key, _)| key == DEVELOPMENT)
                .for_each(|(key, _)| *key = DEVELOPED.into());
        }
        picture.metadata = photo.metadata.clone();
        photo.layer.clear();
        Self { picture, photo }
    }

    /// How its metadata says that it is developed; as usual where it says nothing that can be understood. A PNG has been developed: it keeps
    /// its curve and depth, and all else is left as it is.
    pub fn development(&self) -> Development {
        let Some(encoding) = &self.photo.encoding else {
            return self.told(DEVELOPMENT).and_then(|text| text.parse().ok()).unwrap_or_default();
        };
        let [least, most] = Gamma::RANGE;
        let told: Option<Development> = self.told(DEVELOPED).and_then(|text| text.parse().ok());
        let gamma =
            match encoding.curve {
                Some(png::Curve::Gamma(power)) if power >= least && power <= most => {
                    // The file has it to five digits only.
                    let near = |own: &f32| (own / power - 1.0).abs() < 1e-3;
                    let own = told.and_then(|development| {
                        if let Gamma::Power(own) = development.gamma { Some(own) } else { None }
                    });
                    Gamma::Power(own.filter(near).unwrap_or(power))
                }
                _ => Gamma::Srgb,
            };
        let bits = Bits::of(encoding.bits).unwrap_or_default();
        Development { gamma, bits, tone: Tone::Clamp, ..Development::default() }
    }

    /// What a person should know of how it was read, each a sentence without a full stop.
    pub fn notes(&self) -> &[String] {
        &self.photo.notes
    }

    /// Where its numbers are no light.
    pub fn faults(&self) -> Faults {
        self.photo.faults()
    }

    /// Pixels to which a distance on a plane at distance 1 in front of the camera is magnified, where the metadata tells it.
    pub fn focal_pixels(&self) -> Option<f64> {
        let told = self.told(focus::FOCAL_PIXELS)?;
        told.parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0)
    }

    /// Width and height of the whole picture, of which this may be a crop.
    pub fn size(&self) -> [usize; 2] {
        [self.picture.display_window.width, self.picture.display_window.height]
    }

    pub(crate) fn told(&self, key: &str) -> Option<&str> {
        self.picture.metadata.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str())
    }

    /// The space of its colours; sRGB where the file doesn't say.
    pub fn space(&self) -> RgbSpace {
        self.photo.space_or_srgb()
    }

    /// Blurs the colours by the layer `depth`.
    pub fn blur(&mut self, blur: &Blur) -> Result<(), NoBlur> {
        let depth = self.picture.layer("depth").and_then(|l| l.channel("Z")).ok_or(NoBlur::NoDepth)?;
        let (data, display) = (self.picture.data_window, self.picture.display_window);
        // The middle of the whole picture, in pixels of this crop.
        let middle = |at: i32, start: i32, size: usize| f64::from(start) + 0.5 * size as f64 - f64::from(at);
        let center = [middle(data.x, display.x, display.width), middle(data.y, display.y, display.height)];
        let plane = focus::Plane { pixels: &self.photo.pixels, depth, width: data.width, center };
        self.photo.pixels = plane.blurred(blur);
        // What is by wavelengths is not blurred and no longer the same picture; its sum becomes the picture.
        let beauty = &mut self.photo.layer;
        let is_summed = self.picture.layer(beauty).is_some_and(exr::is_spectral_layer);
        if self.picture.layers.iter().any(exr::is_spectral_layer) {
            self.picture.layers.retain(|l| !exr::is_spectral_layer(l));
            self.picture.metadata.retain(|(key, _)| !exr::is_spectral_attribute(key));
        }
        if is_summed {
            beauty.clear();
            self.picture.space = self.photo.space;
        }
        self.picture.layers.retain(|l| l.name != *beauty);
        self.picture.layers.insert(0, Layer::from_rgb(beauty, &self.photo.pixels));
        // The fingerprint was of other pixels, and so were the variance and the error.
        self.picture.layers.retain(|l| !["variance", "error"].contains(&l.name.as_str()));
        self.picture.metadata.retain(|(key, _)| key != FILM_HASH && key != ERROR);
        self.picture.metadata.push(("straal.depth_of_field".into(), blur.to_string()));
        Ok(())
    }

    /// Puts clean light in the place of the noisy, which stays as a layer of its own; whether light by wavelengths had to go.
    pub(crate) fn replace_light(&mut self, clean: Vec<[f32; 3]>, noisy: &[[f32; 3]]) -> bool {
        let beauty = self.photo.layer.clone();
        let is_spectral = self.picture.layers.iter().any(exr::is_spectral_layer);
        if is_spectral {
            if self.picture.layer(&beauty).is_some_and(exr::is_spectral_layer) {
                self.photo.layer.clear();
                self.picture.space = self.photo.space;
            }
            self.picture.layers.retain(|l| !exr::is_spectral_layer(l));
            self.picture.metadata.retain(|(key, _)| !exr::is_spectral_attribute(key));
        }
        let new = Layer::from_rgb(&self.photo.layer, &clean);
        match self.picture.layers.iter_mut().find(|l| l.name == self.photo.layer) {
            // Alpha, and whatever else stands in the same layer, stays.
            Some(layer) => {
                layer
                    .channels
                    .retain(|c| !["R", "G", "B", "X", "Y", "Z", "RY", "BY"].contains(&c.name.as_str()));
                let others = std::mem::replace(&mut layer.channels, new.channels);
                layer.channels.extend(others);
            }
            None => self.picture.layers.insert(0, new),
        }
        self.picture.layers.retain(|l| !["variance", "error", denoise::NOISY].contains(&l.name.as_str()));
        self.picture.layers.push(Layer::from_rgb(denoise::NOISY, noisy));
        self.picture.metadata.retain(|(key, _)| key != FILM_HASH && key != ERROR);
        self.photo.pixels = clean;
        is_spectral
    }

    /// Writes the picture, whole or not at all, in the format that the name's extension says: a PNG is developed, an EXR
    /// keeps all layers, HDR and PFM have linear sRGB.
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
        let mut metadata = with_development(&self.picture.metadata, development);
        if format == Format::Exr {
            return exr::write_with(out, &self.picture, &metadata);
        }
        let (pixels, [width, height], at) = self.shown();
        if format == Format::Png {
            metadata.retain(|(key, value)| key != ERROR && is_png_text(key, value));
            let undeveloped = Undeveloped { pixels: &pixels, width, at, space: self.space() };
            return write_png(out, &undeveloped, development, &metadata);
        }
        let matrix = to_screen(&self.space());
        let srgb = |p: &[f32; 3]| matrix.map_or(*p, |m| m.apply_f32(*p));
        let image = Image { width, height, pixels: pixels.iter().map(srgb).collect() };
        if format == Format::Hdr { hdr::write(out, &image) } else { pfm::write(out, &image) }
    }

    /// What a format without windows shows, its size, and where its first pixel lies in the whole: a crop of straal by itself, as a render
    /// writes it, and any other picture as its frame.
    fn shown(&self) -> (Cow<'_, [[f32; 3]]>, [usize; 2], [u32; 2]) {
        let Photo { part, ref pixels, size, .. } = self.photo;
        if self.photo.is_crop() || self.photo.is_whole() {
            return (Cow::Borrowed(pixels), [part.width, part.height], [part.x as u32, part.y as u32]);
        }
        (Cow::Owned(image::framed(pixels, part, size).pixels), size, [0, 0])
    }
}

/// Whether a PNG can hold it: keywords are short and plain there.
fn is_png_text(key: &str, value: &str) -> bool {
    !exr::is_spectral_attribute(key)
        && (1..=79).contains(&key.len())
        && key.bytes().all(|b| b.is_ascii_graphic())
        && !value.contains('\0')
}
