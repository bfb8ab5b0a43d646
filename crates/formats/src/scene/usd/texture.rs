//! Textures: `UsdUVTexture`, `UsdPrimvarReader` and `UsdTransform2d`, and the pictures of packages.

use std::sync::Arc;

use straal_math::ops;
use straal_scene::desc::{
    AttributeMapping, CoordinatesName, ImageTexture, Mapping, RemapTexture, ScaleTexture, Spectrum, Texture,
    TextureChannel, TextureFilter, TextureSpace, UvMapping, Varying, Wrap, Wraps,
};
use straal_scene::value::{Asset, LinearRgb};
use straal_scene::{Bitmap, Diagnostic, Image, Span};

use super::library::Place;
use super::material::{Has, of_texture, vertices};
use super::{Translation, mtlx};
use crate::image;

/// Pictures of packages that are still to be decoded.
#[derive(Default)]
pub(super) struct Pictures {
    packed: Vec<(usize, std::ops::Range<usize>, Asset<Bitmap>)>,
}

/// A texture as an input reads it: what it reads, and what is done to its numbers.
pub(super) struct Read {
    texture: Texture,
    channel: TextureChannel,
    /// What its numbers are multiplied by, and what is added then.
    scale: [f64; 4],
    bias: [f64; 4],
}

impl Read {
    fn of(texture: Texture, channel: TextureChannel) -> Self {
        Self { texture, channel, scale: [1.0; 4], bias: [0.0; 4] }
    }

    /// What vertices have, by its name.
    pub fn vertices(name: &str) -> Self {
        Self::of(vertices(name, TextureChannel::Luminance), TextureChannel::Luminance)
    }

    /// Has it read one channel.
    pub fn take(&mut self, channel: usize) {
        const ALL: [TextureChannel; 4] =
            [TextureChannel::Red, TextureChannel::Green, TextureChannel::Blue, TextureChannel::Alpha];
        self.channel = ALL[channel.min(3)].clone();
    }

    /// Multiplies its colours.
    pub fn scale_by(&mut self, factor: [f64; 3]) {
        let all = [factor[0], factor[1], factor[2], factor[0]];
        for (v, factor) in self.scale.iter_mut().chain(&mut self.bias).zip(all.iter().chain(&all)) {
            *v *= factor;
        }
    }

    /// As a colour.
    pub fn colour(&self) -> Varying<Spectrum> {
        let [r, g, b, _] = self.scale;
        let of = of_texture(self.texture.clone());
        let most = [r, g, b].into_iter().fold(0.0, |most, v| if v > most { v } else { most });
        if self.scale[..3] == [1.0; 3] && self.bias[..3] == [0.0; 3] {
            return of;
        }
        if r == g && g == b && self.bias[..3] != [0.0; 3] {
            return of_texture(Texture::Remap(RemapTexture {
                of,
                from: [0.0, 1.0],
                to: [self.bias[0], self.bias[0] + r].map(|v| super::within(v, 0.0, 1e30)),
                ..RemapTexture::default()
            }));
        }
        if most <= 0.0 {
            return Varying::Constant(Spectrum::grey(0.0));
        }
        let tint = [r, g, b].map(|v| super::within(v / most, 0.0, 1.0));
        of_texture(Texture::Scale(ScaleTexture {
            of,
            by: most.into(),
            tint: Varying::Constant(Spectrum::Rgb(LinearRgb(tint))),
        }))
    }

    /// As a number of its channel.
    pub fn number(&self) -> Varying<f64> {
        let i = match self.channel {
            TextureChannel::Green => 1,
            TextureChannel::Blue => 2,
            TextureChannel::Alpha => 3,
            _ => 0,
        };
        let mut texture = self.texture.clone();
        match &mut texture {
            Texture::Image(image) => {
                (image.color_space, image.channel) = (TextureSpace::Raw, self.channel.clone());
            }
            Texture::Attribute(attribute) => attribute.channel = self.channel.clone(),
            _ => {}
        }
        if (self.scale[i], self.bias[i]) == (1.0, 0.0) {
            return of_texture(texture);
        }
        let to = [self.bias[i], self.bias[i] + self.scale[i]].map(|v| super::within(v, 0.0, 1.0));
        of_texture(Texture::Remap(RemapTexture {
            of: of_texture(texture),
            from: [0.0, 1.0],
            to,
            ..RemapTexture::default()
        }))
    }

    /// The picture itself, its numbers as they stand: for normals.
    pub fn plain(&self) -> Option<Texture> {
        match &self.texture {
            Texture::Image(image) => Some(Texture::Image(ImageTexture {
                color_space: TextureSpace::Raw,
                channel: TextureChannel::Luminance,
                ..image.clone()
            })),
            _ => None,
        }
    }
}

impl Translation<'_, '_> {
    /// What a shader gives at an output; nothing where it has no effect, which is told.
    pub fn read(&mut self, shader: usize, output: &str, has: &Has) -> Option<Read> {
        let id = self.stage.text(shader, "info:id").unwrap_or_default();
        let channel = match output {
            "r" => TextureChannel::Red,
            "g" => TextureChannel::Green,
            "b" => TextureChannel::Blue,
            "a" => TextureChannel::Alpha,
            _ => TextureChannel::Luminance,
        };
        match id.as_str() {
            "UsdUVTexture" | "ND_UsdUVTexture" | "ND_UsdUVTexture_23" => self.picture(shader, channel, has),
            id if matches!(mtlx::node(id), Some("image" | "tiledimage")) => {
                self.picture(shader, channel, has)
            }
            id if matches!(mtlx::node(id), Some("geompropvalue" | "geomcolor" | "UsdPrimvarReader")) => {
                self.geometry(shader, has)
            }
            id if id.starts_with("UsdPrimvarReader_") => {
                let name = self.word_of(shader, "varname")?;
                match name.as_str() {
                    "displayColor" if has.colour => {
                        Some(Read::of(vertices("color", channel.clone()), channel))
                    }
                    "displayOpacity" if has.opacity => {
                        Some(Read::of(vertices("displayOpacity", channel.clone()), channel))
                    }
                    _ => {
                        let name = straal_scene::suggest::brief(&name).into_owned();
                        self.warn(shader, &format!("the mesh has no primvar `{name}` that is read"));
                        None
                    }
                }
            }
            _ => {
                let id = straal_scene::suggest::brief(&id).into_owned();
                self.warn(shader, &format!("the shader `{id}` isn't read"));
                None
            }
        }
    }

    /// Whether a shader is a picture of MaterialX itself.
    fn is_of_mtlx(&self, shader: usize) -> bool {
        let id = self.stage.text(shader, "info:id").unwrap_or_default();
        matches!(mtlx::node(&id), Some("image" | "tiledimage"))
    }

    /// An input that is a word.
    pub fn word_of(&self, shader: usize, name: &str) -> Option<String> {
        let (prim, property) = self.said(shader, name);
        self.stage.text(prim, &property)
    }

    /// `UsdUVTexture`.
    fn picture(&mut self, shader: usize, channel: TextureChannel, has: &Has) -> Option<Read> {
        let (prim, property) = self.said(shader, "file");
        let Some(file) = self.stage.text(prim, &property).filter(|file| !file.is_empty()) else {
            self.warn(shader, "the texture has no picture, and no effect");
            return None;
        };
        let layer = self.stage.layer_of(prim, &property);
        let space = self.word_of(shader, "sourceColorSpace");
        let space = space.or_else(|| self.stage.color_space(prim, &property).map(str::to_owned));
        let mapping = self.coordinates(shader, has)?;
        let asset = self.bitmap(shader, layer, &file)?;
        let is_of_mtlx = self.is_of_mtlx(shader);
        let wrap = |word: Option<String>| match word.as_deref() {
            _ if is_of_mtlx => mtlx::wrap(word),
            Some("repeat") => Wrap::Repeat,
            Some("mirror") => Wrap::Mirror,
            Some("clamp") => Wrap::Clamp,
            // What a file without words on it means is black beyond its edges.
            _ => Wrap::Black,
        };
        let names = if is_of_mtlx { ["uaddressmode", "vaddressmode"] } else { ["wrapS", "wrapT"] };
        let wrap = Wraps(names.map(|name| wrap(self.word_of(shader, name))));
        let color_space = match space.as_deref() {
            Some("raw" | "Raw" | "data" | "lin_rec709" | "lin_rec709_scene" | "lin_srgb") => {
                TextureSpace::Linear
            }
            Some("sRGB" | "srgb_texture" | "srgb_rec709_scene" | "srgb_tx") => TextureSpace::Srgb,
            None | Some("auto" | "") => TextureSpace::Auto,
            Some(other) => {
                let other = straal_scene::suggest::brief(other).into_owned();
                let message = format!(
                    "the colour space `{other}` isn't read: its picture is taken as one of its format is"
                );
                self.warn(shader, &message);
                TextureSpace::Auto
            }
        };
        let four = |t: &Self, name: &str, otherwise: f64| {
            let (prim, property) = t.said(shader, name);
            t.stage.vector::<4>(prim, &property).unwrap_or([otherwise; 4])
        };
        let (scale, bias) = (four(self, "scale", 1.0), four(self, "bias", 0.0));
        let texture = Texture::Image(ImageTexture {
            file: asset,
            color_space,
            channel: TextureChannel::Luminance,
            filter: TextureFilter::Ewa,
            anisotropy: 16.0,
            wrap,
            mapping,
        });
        Some(Read { texture, channel, scale, bias })
    }

    /// How a texture lies: by a primvar, which may be moved.
    fn coordinates(&mut self, shader: usize, has: &Has) -> Option<Mapping> {
        let mut uv = UvMapping::default();
        let is_of_mtlx = self.is_of_mtlx(shader);
        let two = |t: &Self, shader: usize, name: &str, otherwise: f64| {
            let (prim, property) = t.said(shader, name);
            t.stage.vector::<2>(prim, &property).unwrap_or([otherwise; 2])
        };
        let mut found = self.source(shader, if is_of_mtlx { "inputs:texcoord" } else { "inputs:st" });
        if is_of_mtlx {
            let offset = two(self, shader, "uvoffset", 0.0);
            uv.scale = two(self, shader, "uvtiling", 1.0);
            uv.translate = offset.map(|v| 0.0 - v);
        }
        if let Some((moved, _)) = &found
            && is_of_mtlx
            && self.stage.text(*moved, "info:id").is_some_and(|id| mtlx::node(&id) == Some("place2d"))
        {
            let moved = *moved;
            uv = self.placed(moved, uv);
            found = self.source(moved, "inputs:texcoord");
        }
        if let Some((moved, _)) = &found
            && self.stage.text(*moved, "info:id").as_deref() == Some("UsdTransform2d")
        {
            let moved = *moved;
            let (prim, property) = self.said(moved, "rotation");
            let rotate = self.stage.number(prim, &property).unwrap_or(0.0);
            uv = UvMapping {
                scale: two(self, moved, "scale", 1.0),
                rotate,
                translate: two(self, moved, "translation", 0.0),
            };
            found = self.source(moved, "inputs:in");
        }
        let name = match found {
            Some((reader, _)) => {
                let name = self.word_of(reader, "varname").or_else(|| self.word_of(reader, "geomprop"));
                let is_first =
                    self.stage.text(reader, "info:id").is_some_and(|id| id.starts_with("ND_texcoord"));
                name.unwrap_or_else(|| if is_first { "st".to_owned() } else { String::new() })
            }
            // Without a reader a texture lies by the mesh's own.
            None => "st".to_owned(),
        };
        if has.own.as_deref() == Some(name.as_str())
            || name == "st" && has.own.is_some() && !has.others.contains(&name)
        {
            return Some(Mapping::Uv(uv));
        }
        if has.others.contains(&name) {
            return Some(Mapping::Attribute(AttributeMapping { name: CoordinatesName(name.into()), uv }));
        }
        let name = straal_scene::suggest::brief(&name).into_owned();
        self.warn(shader, &format!("the texture has no effect: what it is on has no primvar `{name}`"));
        None
    }

    /// How `place2d` of MaterialX and the tiling of the picture that follows it move a texture.
    ///
    /// By default places are scaled about a pivot by 1 over `scale`, turned clockwise, and moved by minus `offset`; in the other
    /// order they are moved first and scaled last.
    fn placed(&mut self, moved: usize, then: UvMapping) -> UvMapping {
        let two = |name: &str, otherwise: f64| {
            let (prim, property) = self.said(moved, name);
            self.stage.vector::<2>(prim, &property).unwrap_or([otherwise; 2])
        };
        let (pivot, scale, offset) = (two("pivot", 0.0), two("scale", 1.0), two("offset", 0.0));
        let scale = scale.map(|v| if v == 0.0 { 1.0 } else { 1.0 / v });
        let rotate = 0.0 - self.number(moved, "rotate", 0.0);
        let is_scaled_last = self.number(moved, "operationorder", 0.0) != 0.0;
        let (sin, cos) = ops::sin_cos_degrees(rotate);
        let turn = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
        let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0], a[1] * b[1]];
        // Scales after a turn aren't scales before it, unless they are the same along both axes.
        let (before, after) =
            if is_scaled_last { ([1.0; 2], times(scale, then.scale)) } else { (scale, then.scale) };
        if rotate != 0.0 && after[0] != after[1] {
            self.warn(moved, "a texture that is turned and then stretched is turned only");
        }
        let start =
            if is_scaled_last { pivot.map(|v| 0.0 - v) } else { times(scale, pivot).map(|v| 0.0 - v) };
        let first = if is_scaled_last { [start[0] - offset[0], start[1] - offset[1]] } else { start };
        let turned = turn(first);
        let rest = if is_scaled_last {
            let scaled = times(scale, turned);
            [scaled[0] + pivot[0], scaled[1] + pivot[1]]
        } else {
            [turned[0] - offset[0] + pivot[0], turned[1] - offset[1] + pivot[1]]
        };
        let rest = times(then.scale, rest);
        UvMapping {
            scale: times(before, after),
            rotate,
            translate: [rest[0] + then.translate[0], rest[1] + then.translate[1]],
        }
    }

    /// A picture for textures; nothing after a complaint.
    pub fn bitmap(&mut self, shader: usize, layer: usize, file: &str) -> Option<Asset<Bitmap>> {
        let file = self.one_of_many(shader, file);
        match self.stage.library.place(layer, &file) {
            Some(Place::File(name)) => Some(self.made.in_file(name)),
            // What is wrong with the name is told where the file is looked for.
            None => Some(self.made.in_file(file)),
            Some(Place::Packed { package, range, name }) => {
                let called = format!("{}#{name}", self.name);
                let is_new = self.made.handles.of::<Bitmap>(&called);
                let asset: Asset<Bitmap> = self.made.in_file(called);
                let is_known = self.pictures.packed.iter().any(|(_, _, known)| known.handle == is_new);
                if !is_known {
                    self.pictures.packed.push((package, range, asset.clone()));
                }
                Some(asset)
            }
        }
    }

    /// The first of a picture's tiles, where it has several.
    fn one_of_many(&mut self, shader: usize, file: &str) -> String {
        if file.contains("<UDIM>") {
            self.warn(shader, "of a picture in tiles the first is shown everywhere");
        }
        file.replace("<UDIM>", "1001")
    }

    /// A picture for surroundings; nothing after a complaint.
    pub fn surroundings(&mut self, layer: usize, file: &str) -> Option<Asset<Image>> {
        match self.stage.library.place(layer, file) {
            Some(Place::File(name)) => Some(self.made.in_file(name)),
            None => Some(self.made.in_file(file.to_owned())),
            Some(Place::Packed { package, range, name }) => {
                let bytes = Arc::<[u8]>::from(&self.stage.library.packages[package].bytes[range]);
                let called = format!("{}#{name}", self.name);
                self.room(&bytes, &called)?;
                match image::read(&bytes, self.stage.library.means.limits) {
                    Ok(picture) => Some(self.made.image(called, Arc::new(picture))),
                    Err(e) => {
                        self.fail(format!("`{called}` can't be read: {e}"));
                        None
                    }
                }
            }
        }
    }

    /// Takes note of what decoding a picture takes; nothing after a complaint.
    fn room(&mut self, bytes: &[u8], called: &str) -> Option<()> {
        let means = &mut *self.stage.library.means;
        let header = match image::header(bytes, means.limits) {
            Ok(header) => header,
            Err(e) => {
                means.d.push(Diagnostic::error(Span::NONE, format!("`{called}` can't be read: {e}")));
                return None;
            }
        };
        let [passing, kept] = [header.decoded_bytes, header.bitmap_bytes()];
        let all = passing.saturating_add(kept);
        let shortage = means.ledger.refuse(all, || format!("`{called}`"), "a smaller picture takes less");
        if let Some(shortage) = shortage {
            means.d.lacks_memory = true;
            means.d.push(Diagnostic::error(Span::NONE, shortage.to_string()));
            return None;
        }
        means.ledger.pass(all);
        means.ledger.keep(kept);
        Some(())
    }

    /// Decodes the pictures of packages.
    pub fn decode_pictures(&mut self) {
        for (package, range, asset) in std::mem::take(&mut self.pictures.packed) {
            let bytes = std::rc::Rc::clone(&self.stage.library.packages[package].bytes);
            let called = asset.file.value.clone();
            if self.room(&bytes[range.clone()], &called).is_none() {
                continue;
            }
            match image::bitmap(&bytes[range], self.stage.library.means.limits) {
                Ok((bitmap, notes)) => {
                    self.made.bitmap(asset.file, Arc::new(bitmap));
                    for note in notes {
                        let message = format!("`{called}`: {note}");
                        self.stage.library.means.d.push(Diagnostic::warning(Span::NONE, message));
                    }
                }
                Err(e) => self.fail(format!("`{called}` can't be read: {e}")),
            }
        }
    }
}

/// A power of two.
pub(super) fn stops(exposure: f64) -> f64 {
    ops::pow_d(2.0, super::within(exposure, -100.0, 100.0))
}
