//! Textures: pictures in files, URIs and buffers, how they are read (samplers), and how they lie (`KHR_texture_transform`).

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use straal_math::ops;
use straal_scene::desc::{
    AttributeMapping, CoordinatesName, ImageTexture, Mapping, TextureChannel, TextureFilter, TextureSpace,
    UvMapping, Wrap, Wraps,
};
use straal_scene::value::Asset;
use straal_scene::{Bitmap, Diagnostic};

use super::container;
use super::document::{Fault, Result, number, required, size, size_or, text, vector_or};
use super::geometry::set_name;
use super::json::Json;
use super::material::Has;
use super::{Translation, degrees};
use crate::image;
use crate::scene::Means;

/// The pictures of a file, as far as they were asked for.
#[derive(Default)]
pub(super) struct Pictures<'a> {
    known: BTreeMap<usize, Option<Picture>>,
    /// Those that aren't in files of their own, which are decoded when all are known.
    packed: Vec<Packed<'a>>,
}

/// A picture that a texture is read off.
#[derive(Clone)]
struct Picture {
    asset: Asset<Bitmap>,
    has_alpha: bool,
}

/// A picture whose bytes are at hand.
struct Packed<'a> {
    at: &'a Json,
    asset: Asset<Bitmap>,
    bytes: Vec<u8>,
    /// Bytes that decoding it takes, and those that it takes then.
    needs: [u64; 2],
}

/// A texture as a material reads it.
#[derive(Clone)]
pub(super) struct Map {
    image: ImageTexture,
    /// Whether its picture has alpha.
    pub has_alpha: bool,
}

impl Map {
    /// As a colour in sRGB.
    pub fn colour(&self) -> ImageTexture {
        ImageTexture { color_space: TextureSpace::Srgb, ..self.image.clone() }
    }

    /// As numbers that stand as they are.
    pub fn number(&self, channel: TextureChannel) -> ImageTexture {
        ImageTexture { color_space: TextureSpace::Raw, channel, ..self.image.clone() }
    }
}

impl<'a> Translation<'a, '_> {
    /// What an object has as a texture under a key: none where there is none, or where it has no effect, which is told. `has` says which
    /// texture coordinates there are.
    pub fn map(&mut self, of: &'a Json, key: &str, has: Has) -> Result<Option<Map>> {
        let Some(info) = of.get(key) else { return Ok(None) };
        let (_, texture) = self.document.item("textures", required(info, "index")?)?;
        let moved = info.extension("KHR_texture_transform");
        let set = set_of(info)?;
        if !has.sets.get(set).is_some_and(|is_there| *is_there) {
            self.warn(info, "the texture has no effect: the mesh has no texture coordinates of that number");
            return Ok(None);
        }
        let uv = match moved {
            Some(moved) => {
                let turn = moved.get("rotation").map_or(Ok(0.0), number)?;
                transform(vector_or(moved, "offset", [0.0; 2])?, turn, vector_or(moved, "scale", [1.0; 2])?)
            }
            None => UvMapping::default(),
        };
        let mapping = if set == has.primary {
            Mapping::Uv(uv)
        } else {
            Mapping::Attribute(AttributeMapping {
                name: CoordinatesName(set_name(set, has.primary).into()),
                uv,
            })
        };
        let Some(picture) = self.source(texture)? else { return Ok(None) };
        let (filter, wrap) = self.sampler(texture)?;
        let Picture { asset, has_alpha } = picture;
        let image = ImageTexture {
            file: asset,
            color_space: TextureSpace::Raw,
            channel: TextureChannel::Luminance,
            filter,
            anisotropy: 16.0,
            wrap,
            mapping,
        };
        Ok(Some(Map { image, has_alpha }))
    }

    /// How a texture is read.
    fn sampler(&self, texture: &Json) -> Result<(TextureFilter, Wraps)> {
        let (mut filter, mut wraps) = (TextureFilter::Ewa, [Wrap::Repeat, Wrap::Repeat]);
        if let Some(at) = texture.get("sampler") {
            let (_, sampler) = self.document.item("samplers", at)?;
            if size_or(sampler, "magFilter", 9729)? == 9728 {
                filter = TextureFilter::Nearest;
            }
            for (wrap, key) in wraps.iter_mut().zip(["wrapS", "wrapT"]) {
                *wrap = match size_or(sampler, key, 10497)? {
                    10497 => Wrap::Repeat,
                    33071 => Wrap::Clamp,
                    33648 => Wrap::Mirror,
                    other => return Err(Fault::of(sampler, format!("{other} is no way to wrap a texture"))),
                };
            }
        }
        Ok((filter, Wraps(wraps)))
    }

    /// The picture of a texture; none after a complaint.
    fn source(&mut self, texture: &'a Json) -> Result<Option<Picture>> {
        // Of several that show the same, the plainest.
        let other = ["EXT_texture_webp", "KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"];
        let others = other.iter().filter_map(|name| texture.extension(name)?.get("source"));
        let mut sources: Vec<&Json> = texture.get("source").into_iter().chain(others).collect();
        let Some(last) = sources.pop() else {
            self.warn(texture, "the texture has no picture, and no effect");
            return Ok(None);
        };
        let first = sources.first().copied().unwrap_or(last);
        let (i, image) = self.document.item("images", first)?;
        if let Some(known) = self.pictures.known.get(&i) {
            return Ok(known.clone());
        }
        let picture = match self.picture(i, image) {
            Ok(picture) => Some(picture),
            Err(fault) => {
                // Of pictures that are missing all are told.
                self.means.d.push(self.document.error(&fault));
                None
            }
        };
        self.pictures.known.insert(i, picture.clone());
        Ok(picture)
    }

    fn picture(&mut self, i: usize, image: &'a Json) -> Result<Picture> {
        let called = match image.get("name").and_then(Json::text) {
            Some(name) => format!("{}#images[{i}] {name}", self.name),
            None => format!("{}#images[{i}]", self.name),
        };
        let bytes = if let Some(view) = image.get("bufferView") {
            self.document.view(view)?.bytes().to_vec()
        } else {
            let at = image
                .get("uri")
                .ok_or_else(|| Fault::of(image, "the picture has neither `uri` nor `bufferView`"))?;
            let uri = text(at)?;
            match container::data(uri) {
                Some(held) => held.map_err(|problem| Fault::of(at, problem))?,
                None => return self.in_file(at, uri),
            }
        };
        let limits = self.means.limits;
        let header = image::header(&bytes, limits)
            .map_err(|e| Fault::of(image, format!("the picture can't be read: {e}")))?;
        let asset = self.made.in_file(called);
        let has_alpha = header.channels % 2 == 0;
        let needs = [header.decoded_bytes, header.bitmap_bytes()];
        self.means.ledger.keep(bytes.len() as u64);
        self.pictures.packed.push(Packed { at: image, asset: asset.clone(), bytes, needs });
        Ok(Picture { asset, has_alpha })
    }

    /// A picture in a file, which is read later with all others.
    fn in_file(&mut self, at: &Json, uri: &str) -> Result<Picture> {
        let name = container::file(uri).map_err(|problem| Fault::of(at, problem))?;
        // What is wrong with the file is told where it is read.
        let found = self.means.finder.find(self.means.base, &name).ok();
        let header = found.and_then(|found| image::Header::open(&found.path, self.means.limits).ok());
        let has_alpha = header.is_some_and(|header| header.channels % 2 == 0);
        let (span, _) = self.document.place((at.start, at.end));
        let asset = self.made.in_file(straal_scene::Spanned::new(name, span));
        Ok(Picture { asset, has_alpha })
    }

    /// Decodes what stands in buffers and URIs, several at a time.
    pub fn decode_pictures(&mut self) {
        let packed = std::mem::take(&mut self.pictures.packed);
        for Packed { at, needs: [passing, kept], .. } in &packed {
            let what = || "a picture".to_owned();
            let shortage =
                self.means.ledger.refuse(passing.saturating_add(*kept), what, "a smaller picture takes less");
            if let Some(shortage) = shortage {
                self.means.d.lacks_memory = true;
                let fault = Fault::of(at, shortage.to_string());
                self.means.d.push(self.document.error(&fault));
                return;
            }
            self.means.ledger.pass(passing.saturating_add(*kept));
            self.means.ledger.keep(*kept);
        }
        for (Packed { at, asset, .. }, result) in packed.iter().zip(decode(&packed, self.means)) {
            match result {
                Ok((bitmap, notes)) => {
                    self.made.bitmap(asset.file.clone(), Arc::new(bitmap));
                    for note in notes {
                        let (span, path) = self.document.place((at.start, at.end));
                        self.means.d.push(Diagnostic::warning(span, format!("{path}{note}")));
                    }
                }
                Err(e) => {
                    let fault = Fault::of(at, format!("the picture can't be read: {e}"));
                    self.means.d.push(self.document.error(&fault));
                }
            }
        }
    }
}

type Decoded = std::result::Result<(Bitmap, Vec<String>), crate::ReadError>;

/// Decodes pictures in any order; gives them in theirs.
fn decode(packed: &[Packed<'_>], means: &Means<'_>) -> Vec<Decoded> {
    let (limits, next) = (means.limits, AtomicUsize::new(0));
    let bytes: Vec<&[u8]> = packed.iter().map(|p| p.bytes.as_slice()).collect();
    let work = || {
        let mut done = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(mine) = bytes.get(i) else { return done };
            done.push((i, image::bitmap(mine, limits)));
        }
    };
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let mut decoded: Vec<Option<Decoded>> = packed.iter().map(|_| None).collect();
    std::thread::scope(|scope| {
        let threads = if processors < packed.len() { processors } else { packed.len() };
        let running: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        for thread in running {
            for (i, result) in thread.join().unwrap_or_default() {
                decoded[i] = Some(result);
            }
        }
    });
    let broken = || Err(crate::ReadError::file("its decoder broke down"));
    decoded.into_iter().map(|result| result.unwrap_or_else(broken)).collect()
}

/// Which set of texture coordinates a texture lies by.
pub(super) fn set_of(info: &Json) -> Result<usize> {
    match info.extension("KHR_texture_transform").and_then(|moved| moved.get("texCoord")) {
        Some(set) => size(set),
        None => size_or(info, "texCoord", 0),
    }
}

/// What `KHR_texture_transform` does, for texture coordinates whose v rises upwards. With v downwards a point p becomes
/// offset + R (scale p), where R turns counter-clockwise for who looks at the picture: u' = u cos + v sin, v' = v cos - u sin (as the
/// extension's example has it, and programs do; the matrix in its text is the transposed one).
fn transform([u, v]: [f64; 2], turn: f64, [su, sv]: [f64; 2]) -> UvMapping {
    let rotate = degrees(turn);
    let (sin, cos) = ops::sin_cos_degrees(rotate);
    UvMapping { scale: [su, sv], rotate, translate: [u + sv * sin, 1.0 - v - sv * cos] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the extension's text: the lower left quarter of the picture, turned clockwise by a quarter.
    #[test]
    fn textures_are_moved_as_the_extension_says() {
        let UvMapping { scale, rotate, translate } =
            transform([0.0, 1.0], std::f64::consts::FRAC_PI_2, [0.5, 0.5]);
        let (sin, cos) = ops::sin_cos_degrees(rotate);
        let place = |u: f64, v: f64| {
            let [u, v] = [scale[0] * u, scale[1] * v];
            [u * cos - v * sin + translate[0], u * sin + v * cos + translate[1]]
        };
        // With v upwards, the lower left quarter is that from 0 to 0.5.
        for (corner, want) in [
            ([0.0, 0.0], [0.5, 0.0]),
            ([1.0, 0.0], [0.5, 0.5]),
            ([0.0, 1.0], [0.0, 0.0]),
            ([1.0, 1.0], [0.0, 0.5]),
        ] {
            let got = place(corner[0], corner[1]);
            assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{corner:?}: {got:?}");
        }
        assert_eq!(transform([0.0; 2], 0.0, [1.0; 2]), UvMapping::default());
    }
}
