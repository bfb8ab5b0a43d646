//! Picture files are denoised.
//!
//! An EXR of 3840 x 2160 pixels with a dozen layers is a gigabyte of numbers. Of such a file only the light is in memory. Guides are read row by row as the
//! network comes to them, clean light takes the place of the noisy, and all other layers are read once more while the clean file is written, sixteen rows at a time.

use super::{DENOISED, Denoised, Denoising, Guides, NoDenoise, Noisy, Ready, fireflies};
use crate::develop::PictureFile;
use crate::development::Development;
use crate::picture::{Format, SaveError, with_development};
use std::borrow::Cow;
use std::io::{self, BufReader, Cursor, Read, Seek, Write};
use std::ops::Range;
use std::path::Path;
use straal_denoise::GuideRows;
use straal_formats::image::exr::{Layered, StripWriter, Strips};
use straal_formats::image::{self, Faults, Photo};
use straal_formats::{Limits, ReadError, atomic};

/// Bytes that are read more than once: a file, or what was read of a pipe.
pub trait Source: Read + Seek + Send {}

impl<T: Read + Seek + Send> Source for T {}

/// A picture file on its way to being a clean one.
pub struct NoisyFile {
    /// The light and the texts; of an EXR no layers.
    picture: PictureFile,
    /// The layers of an EXR.
    layers: Option<Layers>,
}

struct Layers {
    strips: Strips<Box<dyn Source>>,
    /// The layer that is the picture.
    light: String,
    /// What the clean picture tells of its weights.
    told: Option<String>,
}

impl NoisyFile {
    /// Opens a picture of any format, whose first bytes say which it is.
    pub fn open(source: impl Source + 'static, limits: &Limits) -> Result<Self, ReadError> {
        let mut source: Box<dyn Source> = Box::new(BufReader::with_capacity(1 << 16, source));
        let failed = |e: io::Error| ReadError::file(format!("it can't be read: {e}"));
        let mut bytes = Vec::new();
        source.by_ref().take(4096).read_to_end(&mut bytes).map_err(failed)?;
        if image::Format::of(&bytes)? != image::Format::Exr {
            source.take(limits.max_bytes).read_to_end(&mut bytes).map_err(failed)?;
            return Ok(Self { picture: PictureFile::read(&bytes, limits)?, layers: None });
        }
        let mut strips = Strips::open(source, limits)?;
        let photo = Photo::of_strips(&mut strips)?;
        let light = photo.layer.clone();
        let picture = PictureFile { picture: strips.head().clone(), photo };
        Ok(Self { picture, layers: Some(Layers { strips, light, told: None }) })
    }

    /// What a person should know of how it was read, each a sentence without a full stop.
    pub fn notes(&self) -> &[String] {
        self.picture.notes()
    }

    /// Where its numbers are no light.
    pub fn faults(&self) -> Faults {
        self.picture.faults()
    }

    /// Width and height of the whole picture, of which this may be a crop.
    pub fn size(&self) -> [usize; 2] {
        self.picture.size()
    }

    /// How its metadata says that it is developed.
    pub fn development(&self) -> Development {
        self.picture.development()
    }

    /// Denoises the picture, as [`PictureFile::denoise`] does.
    pub fn denoise(&mut self, how: &Denoising) -> Result<Denoised, NoDenoise> {
        let Some(layers) = &mut self.layers else { return self.picture.denoise(how) };
        let picture = &mut self.picture;
        if let Some(told) = picture.told(DENOISED) {
            return Err(NoDenoise::Twice(told.to_owned()));
        }
        let width = picture.photo.part.width;
        let names = Guides::names(layers.strips.head(), &layers.light);
        let (strips, light) = (&mut layers.strips, layers.light.as_str());
        let mut read = |rows: Range<usize>| -> Result<Guides, ReadError> {
            let is_guide = |layer: &str| layer != light && names.iter().flatten().any(|name| name == layer);
            Ok(Guides::of(&strips.rows_of(rows, is_guide)?, light))
        };
        let mut guides = read(0..1)?;
        let ready = how.ready(&guides, false)?;
        let fireflies = how.fireflies.map(|times| fireflies::remove(width, &mut picture.photo.pixels, times));
        if how.prefilters.iter().any(Option::is_some) {
            // What is cleaned before it guides is needed as a whole.
            guides = ready.prefiltered(how, read(0..usize::MAX)?, width)?;
            let noisy = Noisy { width, rgb: &picture.photo.pixels, guides: &guides };
            picture.photo.pixels = ready.run(&noisy)?;
        } else {
            guides.bad = [0; 2];
            let bad = &mut guides.bad;
            let rows = |rows: Range<usize>| -> Result<GuideRows<'static>, NoDenoise> {
                let Guides { albedo, normal, bad: more, .. } = read(rows)?;
                *bad = [bad[0] + more[0], bad[1] + more[1]];
                let [sees_albedo, sees_normal] = ready.sees;
                Ok(GuideRows {
                    albedo: albedo.filter(|_| sees_albedo).map(Cow::Owned),
                    normal: normal.filter(|_| sees_normal).map(Cow::Owned),
                })
            };
            ready.run_in_place(width, &mut picture.photo.pixels, rows)?;
        }
        let mut notes = ready.notes.clone();
        notes.extend(guides.told());
        // Layers and texts become those of a clean picture; their numbers follow row by row.
        let clean = std::mem::take(&mut picture.photo.pixels);
        if picture.replace_light(Vec::new(), &[]) {
            notes.push(NO_WAVELENGTHS.into());
        }
        picture.photo.pixels = clean;
        picture.picture.metadata.push((DENOISED.into(), ready.told(&guides)));
        layers.told = Some(ready.told(&guides));
        let guides = ready.guides(&guides);
        Ok(Denoised { weights: ready.name, guides, fireflies, noise: Vec::new(), weight: None, notes })
    }

    /// Writes the picture, whole or not at all, in the format that the name's extension says, as [`PictureFile::save`] does.
    pub fn save(&mut self, path: &Path, development: &Development) -> Result<(), SaveError> {
        let format = Format::of(path)?;
        atomic::write(path, |mut file| match (&mut self.layers, format) {
            // A pipe has no place to go back to.
            (Some(layers), Format::Exr) if file.stream_position().is_ok() => {
                layers.write(&self.picture, &mut file, development)
            }
            _ => self.write(file, format, development),
        })?;
        Ok(())
    }

    /// Writes the picture in that format to what takes bytes, such as a pipe. An EXR of it is in memory first.
    pub fn write(
        &mut self,
        out: &mut dyn Write,
        format: Format,
        development: &Development,
    ) -> io::Result<()> {
        match &mut self.layers {
            Some(layers) if format == Format::Exr => {
                let mut bytes = Cursor::new(Vec::new());
                layers.write(&self.picture, &mut bytes, development)?;
                out.write_all(&bytes.into_inner())
            }
            _ => self.picture.write(out, format, development),
        }
    }
}

/// Said of a picture that has light by wavelengths besides its colours.
const NO_WAVELENGTHS: &str = "light by wavelengths isn't denoised and is left out";

impl Layers {
    /// Writes all layers, with the clean light of `picture`.
    fn write(
        &mut self,
        picture: &PictureFile,
        out: impl Write + Seek,
        development: &Development,
    ) -> io::Result<()> {
        const ROWS: usize = StripWriter::<Cursor<Vec<u8>>>::ROWS;
        let window = picture.picture.data_window;
        let metadata = with_development(&picture.picture.metadata, development);
        let first = Layered { metadata, ..self.rows(picture, 0..ROWS.min(window.height))? };
        let mut writer = StripWriter::new(out, window, &first)?;
        writer.strip(&first)?;
        drop(first);
        for start in (ROWS..window.height).step_by(ROWS) {
            writer.strip(&self.rows(picture, start..window.height.min(start + ROWS))?)?;
        }
        writer.end()
    }

    /// Rows of all layers, with the clean light of `picture` where that is clean.
    fn rows(&mut self, picture: &PictureFile, rows: Range<usize>) -> io::Result<Layered> {
        let failed = |e: ReadError| io::Error::other(format!("what it is made of can't be read: {e}"));
        let strip = self.strips.rows(rows.clone()).map_err(failed)?;
        if self.told.is_none() {
            return Ok(strip);
        }
        let noisy = self.strips.colours_of(&strip).map_err(failed)?.pixels;
        let width = picture.photo.part.width;
        let clean = picture.photo.pixels[rows.start * width..rows.end * width].to_vec();
        let photo = Photo { layer: self.light.clone(), ..empty(&picture.photo) };
        let mut part = PictureFile { picture: strip, photo };
        part.replace_light(clean, &noisy);
        Ok(part.picture)
    }
}

/// All but the pixels.
fn empty(photo: &Photo) -> Photo {
    Photo {
        pixels: Vec::new(),
        layer: photo.layer.clone(),
        metadata: photo.metadata.clone(),
        notes: Vec::new(),
        encoding: None,
        ..*photo
    }
}

impl Ready {
    /// Makes light clean where it stands. The guides come by rows.
    fn run_in_place(
        &self,
        width: usize,
        color: &mut [[f32; 3]],
        rows: impl FnMut(Range<usize>) -> Result<GuideRows<'static>, NoDenoise> + Send,
    ) -> Result<(), NoDenoise> {
        let run =
            || straal_denoise::denoise_in_place(&self.network, width, color, &self.settings, rows, |_| true);
        self.install(run)
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
        let ready = how.ready(&guides, false)?;
        let noisy = self.photo.pixels.clone();
        let width = self.photo.part.width;
        let guides = ready.prefiltered(how, guides, width)?;
        let fireflies = how.fireflies.map(|times| fireflies::remove(width, &mut self.photo.pixels, times));
        let clean = ready.run(&Noisy { width, rgb: &self.photo.pixels, guides: &guides })?;
        let mut notes = ready.notes.clone();
        notes.extend(guides.told());
        if self.replace_light(clean, &noisy) {
            notes.push(NO_WAVELENGTHS.into());
        }
        self.picture.metadata.push((DENOISED.into(), ready.told(&guides)));
        let guides = ready.guides(&guides);
        Ok(Denoised { weights: ready.name, guides, fireflies, noise: Vec::new(), weight: None, notes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use straal_formats::image::exr::{self, Channel, Layer, Window};

    const WIDTH: usize = 7;

    /// A picture of noise with guides and layers of all kinds, as the bytes of an EXR.
    fn noisy(height: usize, more: impl FnOnce(&mut Layered)) -> Vec<u8> {
        let mut state = 7_u32;
        let mut layer = |name: &str, channels: &[&str]| {
            let mut next = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 8) as f32 / (1 << 24) as f32
            };
            let mut channel = |name: &&str| Channel {
                name: (*name).into(),
                samples: (0..WIDTH * height).map(|_| next()).collect(),
            };
            Layer { name: name.into(), channels: channels.iter().map(&mut channel).collect() }
        };
        let mut picture = Layered {
            data_window: Window { x: 3, y: 5, width: WIDTH, height },
            layers: vec![
                layer("", &["R", "G", "B", "A"]),
                layer("albedo", &["R", "G", "B"]),
                layer("normal", &["X", "Y", "Z"]),
                layer("depth", &["Z"]),
                layer("error", &["R", "G", "B"]),
            ],
            metadata: vec![("straal.film_hash".into(), "0".into()), ("straal.seed".into(), "1".into())],
            ..Layered::of_size(20, 80)
        };
        more(&mut picture);
        let mut bytes = Vec::new();
        exr::write(&mut bytes, &picture).unwrap();
        bytes
    }

    /// Denoises a file in memory and by rows.
    fn both(bytes: &[u8], how: &Denoising) -> [(Denoised, Vec<Vec<u8>>); 2] {
        let limits = Limits::default();
        let development = Development::default();
        let mut whole = PictureFile::read(bytes, &limits).unwrap();
        let told = whole.denoise(how).unwrap();
        let files = |write: &mut dyn FnMut(&mut dyn Write, Format) -> io::Result<()>| {
            let each = Format::ALL.map(|format| {
                let mut out = Vec::new();
                write(&mut out, format).unwrap();
                out
            });
            each.to_vec()
        };
        let in_memory = (told, files(&mut |out, format| whole.write(out, format, &development)));
        let mut rows = NoisyFile::open(Cursor::new(bytes.to_vec()), &limits).unwrap();
        assert_eq!(rows.size(), [20, 80]);
        let told = rows.denoise(how).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("clean.exr");
        rows.save(&path, &development).unwrap();
        let by_rows = files(&mut |out, format| rows.write(out, format, &development));
        assert!(std::fs::read(&path).unwrap() == by_rows[0], "a file is what a pipe gets");
        [in_memory, (told, by_rows)]
    }

    #[test]
    fn a_file_by_rows_is_the_file_in_memory() {
        let fast = Denoising { effort: crate::denoise::Effort::Fast, ..Denoising::default() };
        let [memory, rows] = both(&noisy(53, |_| ()), &Denoising { fireflies: Some(1.2), ..fast.clone() });
        assert!(memory == rows);
        assert!(rows.0.fireflies.is_some_and(|f| f.pixels > 0));
        // Guides that are no numbers, and a picture without guides.
        let [memory, rows] = both(&noisy(5, |p| p.layers[1].channels[0].samples[8] = f32::NAN), &fast);
        assert!(memory == rows);
        assert!(rows.0.notes.iter().any(|note| note == "albedo of 1 pixel are no numbers and count as 0"));
        let [memory, rows] = both(&noisy(5, |p| p.layers.truncate(1)), &fast);
        assert!(memory == rows);
        assert!(rows.0.guides.is_empty());
        // Light by wavelengths beside colours, and in their place.
        let spectral = |p: &mut Layered| {
            let (layer, attributes) =
                exr::spectral_layer([500.0, 600.0].map(|nm| (nm, vec![0.5; WIDTH * 3])).into_iter());
            p.layers.push(layer);
            p.metadata.extend(attributes);
        };
        let [memory, rows] = both(&noisy(3, spectral), &fast);
        assert!(memory == rows);
        let [memory, rows] = both(
            &noisy(3, |p| {
                spectral(p);
                p.layers.remove(0);
            }),
            &fast,
        );
        assert!(memory == rows);
        assert!(rows.0.notes.iter().any(|note| note == NO_WAVELENGTHS));
    }

    #[test]
    fn guides_are_cleaned_as_a_whole() {
        let network = |weights: crate::denoise::Weights, signal| {
            Some(straal_denoise::Network::from_archive(weights.archive(), signal).unwrap())
        };
        let prefilter = network(crate::denoise::Weights::Light, straal_denoise::Signal::Albedo);
        let how = Denoising { prefilters: [prefilter.clone(), prefilter], ..Denoising::default() };
        let [memory, rows] = both(&noisy(20, |_| ()), &how);
        assert!(memory == rows);
    }

    #[test]
    fn once_is_enough_and_other_formats_are_taken() {
        let bytes = noisy(2, |p| p.metadata.push((DENOISED.into(), "x".into())));
        let mut file = NoisyFile::open(Cursor::new(bytes), &Limits::default()).unwrap();
        assert!(matches!(file.denoise(&Denoising::default()), Err(NoDenoise::Twice(_))));
        // What isn't denoised is written as it was.
        let (mut a, mut b) = (Vec::new(), Vec::new());
        file.write(&mut a, Format::Exr, &Development::default()).unwrap();
        let again = PictureFile::read(&a, &Limits::default()).unwrap();
        again.write(&mut b, Format::Exr, &Development::default()).unwrap();
        assert!(a == b);
        let pfm = b"PF\n2 1\n-1.0\n".iter().copied().chain([0_u8; 24]).collect::<Vec<_>>();
        let mut file = NoisyFile::open(Cursor::new(pfm), &Limits::default()).unwrap();
        assert_eq!(file.denoise(&Denoising::default()).unwrap().guides, [""; 0]);
        assert!(NoisyFile::open(Cursor::new(b"no picture".to_vec()), &Limits::default()).is_err());
    }
}
