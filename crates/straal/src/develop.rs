//! A picture file developed again, without rendering: as a render with the same look would have written it.

use crate::focus::{self, Blur, NoBlur};
use crate::look::{Look, Negative, to_screen};
use crate::picture::{ERROR, Format, LOOK, Picture, SaveError, with_look, write_png};
use std::io;
use std::path::Path;
use straal_color::{RgbSpace, Space};
use straal_formats::image::exr::{self, Beauty, Layer, Window};
use straal_formats::image::{self, hdr, pfm};
use straal_formats::{Limits, ReadError, atomic};
use straal_scene::Image;

/// A picture as a file holds it: linear light, and in an EXR its layers and story.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// All that an EXR of it has; of another file its pixels.
    picture: exr::Picture,
    /// The pixels of the layer without a name, or of the first that has colours.
    pixels: Vec<[f32; 3]>,
    /// What they are, where the file says it.
    space: Option<RgbSpace>,
    /// Which layer they come from.
    beauty: String,
}

impl From<&Picture> for Plate {
    /// The plate that the picture's EXR holds, but for the look, which a picture doesn't know.
    fn from(picture: &Picture) -> Self {
        let pixels = picture.layers.rgb.clone();
        Self { picture: picture.to_exr(), pixels, space: Some(picture.space), beauty: String::new() }
    }
}

impl Plate {
    /// Reads an EXR, HDR, PFM or PNG.
    pub fn read(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            let picture = exr::read(bytes, limits)?;
            let Beauty { pixels, space, layer } = picture.beauty()?;
            return Ok(Self { picture, pixels, space, beauty: layer });
        }
        let Image { width, height, pixels } = image::read(bytes, limits)?;
        let mut picture = exr::Picture::of_size(width, height);
        picture.space = Some(Space::Srgb.rgb());
        picture.layers.push(Layer::from_rgb("", &pixels));
        let space = picture.space;
        Ok(Self { picture, pixels, space, beauty: String::new() })
    }

    /// The look that its story tells; the usual one where it tells none that can be understood.
    pub fn look(&self) -> Look {
        self.told(LOOK).and_then(|text| text.parse().ok()).unwrap_or_default()
    }

    /// Pixels to which a distance on a plane at distance 1 in front of the camera is magnified, where the story tells it.
    pub fn focal_pixels(&self) -> Option<f64> {
        let told = self.told(focus::FOCAL_PIXELS)?;
        told.parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0)
    }

    /// Width and height of the whole picture, of which this may be a crop.
    pub fn size(&self) -> [usize; 2] {
        [self.picture.display_window.width, self.picture.display_window.height]
    }

    fn told(&self, key: &str) -> Option<&str> {
        self.picture.metadata.iter().find(|(k, _)| k == key).map(|(_, v)| v.as_str())
    }

    /// The space of its colours; sRGB where the file doesn't say.
    pub fn space(&self) -> RgbSpace {
        self.space.unwrap_or(Space::Srgb.rgb())
    }

    /// Blurs the colours by the layer `depth`.
    pub fn blur(&mut self, blur: &Blur) -> Result<(), NoBlur> {
        let depth = self.picture.layer("depth").and_then(|l| l.channel("Z")).ok_or(NoBlur::NoDepth)?;
        let (data, display) = (self.picture.data_window, self.picture.display_window);
        // The middle of the whole picture, in pixels of this crop.
        let middle = |at: i32, start: i32, size: usize| f64::from(start) + 0.5 * size as f64 - f64::from(at);
        let center = [middle(data.x, display.x, display.width), middle(data.y, display.y, display.height)];
        let plane = focus::Plane { pixels: &self.pixels, depth, width: data.width, center };
        self.pixels = plane.blurred(blur);
        // What is by wavelengths is not blurred and no longer the same picture; its sum becomes the picture.
        let is_summed = self.picture.layer(&self.beauty).is_some_and(exr::is_spectral_layer);
        if self.picture.layers.iter().any(exr::is_spectral_layer) {
            self.picture.layers.retain(|l| !exr::is_spectral_layer(l));
            self.picture.metadata.retain(|(key, _)| !exr::is_spectral_attribute(key));
        }
        if is_summed {
            self.beauty.clear();
            self.picture.space = self.space;
        }
        self.picture.layers.retain(|l| l.name != self.beauty);
        self.picture.layers.insert(0, Layer::from_rgb(&self.beauty, &self.pixels));
        // The fingerprint was of other pixels, and so were the variance and the error.
        self.picture.layers.retain(|l| !["variance", "error"].contains(&l.name.as_str()));
        self.picture.metadata.retain(|(key, _)| key != "straal.film_hash" && key != ERROR);
        self.picture.metadata.push(("straal.depth_of_field".into(), blur.to_string()));
        Ok(())
    }

    /// Writes the picture, whole or not at all, in the format that the name's extension says: a PNG is developed, an EXR
    /// keeps all layers, HDR and PFM have linear sRGB.
    pub fn save(&self, path: &Path, look: &Look) -> Result<(), SaveError> {
        let format = Format::of(path)?;
        atomic::write(path, |file| self.write(file, format, look))?;
        Ok(())
    }

    /// Writes the picture in that format to what takes bytes, such as a pipe.
    pub fn write(&self, out: &mut dyn io::Write, format: Format, look: &Look) -> io::Result<()> {
        let mut story = with_look(&self.picture.metadata, look);
        let Window { x, y, width, height } = self.picture.data_window;
        match format {
            Format::Exr => exr::write(out, &exr::Picture { metadata: story, ..self.picture.clone() }),
            Format::Png => {
                story.retain(|(key, value)| key != ERROR && is_png_text(key, value));
                let at = [x as u32, y as u32];
                let negative = Negative { pixels: &self.pixels, width, at, space: self.space() };
                write_png(out, &negative, look, &story)
            }
            Format::Hdr | Format::Pfm => {
                let matrix = to_screen(&self.space());
                let srgb = |p: &[f32; 3]| matrix.map_or(*p, |m| m.apply_f32(*p));
                let image = Image { width, height, pixels: self.pixels.iter().map(srgb).collect() };
                if format == Format::Hdr { hdr::write(out, &image) } else { pfm::write(out, &image) }
            }
        }
    }
}

/// Whether a PNG can hold it: keywords are short and plain there.
fn is_png_text(key: &str, value: &str) -> bool {
    !exr::is_spectral_attribute(key)
        && (1..=79).contains(&key.len())
        && key.bytes().all(|b| b.is_ascii_graphic())
        && !value.contains('\0')
}
