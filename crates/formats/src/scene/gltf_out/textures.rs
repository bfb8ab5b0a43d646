//! What a colour or a number is a product of, and the pictures that it is read off.

use std::sync::Arc;

use serde_json::{Map, Value as Json, json};
use straal_color::luminance;
use straal_color::spectrum::{Quantity, uplift::Uplift};
use straal_math::ops;
use straal_scene::bitmap::{Number, TexelFormat, Texels};
use straal_scene::desc::{
    ImageTexture, Mapping, Spectrum, Texture, TextureChannel, TextureFilter, TextureOf, TextureSpace,
    UvMapping, Varying, Wrap,
};
use straal_scene::value::LinearRgb;
use straal_scene::{Bitmap, bitmap};

use super::Out;
use crate::image::png;

/// What a picture is made of: for each of its channels the picture and the channel of it, or what stands for all of it.
pub(super) type Key = [Option<(usize, u8)>; 4];

/// A colour or a number as glTF has it: a factor, times a picture, times the colours of vertices.
#[derive(Clone, Default)]
pub(super) struct Product {
    pub factor: [f64; 3],
    pub image: Option<ImageTexture>,
    pub is_painted: bool,
}

impl Product {
    fn of(factor: [f64; 3]) -> Self {
        Self { factor, image: None, is_painted: false }
    }

    /// The factor of a number.
    pub fn number(&self) -> f64 {
        self.factor[0]
    }
}

/// What a channel of a picture is wanted to be.
#[derive(Clone)]
pub(super) enum Slot {
    /// Nothing reads it.
    Any,
    /// 1 all over.
    One,
    /// A half all over.
    Half,
    /// The channel that a texture says.
    Of(ImageTexture),
}

const CHANNELS: [TextureChannel; 4] =
    [TextureChannel::Red, TextureChannel::Green, TextureChannel::Blue, TextureChannel::Alpha];

impl Out<'_> {
    /// A spectrum as linear sRGB, none of it below 0.
    pub fn rgb(&mut self, spectrum: &Spectrum, quantity: Quantity) -> [f64; 3] {
        let rgb = match spectrum {
            Spectrum::Rgb(LinearRgb(rgb)) => *rgb,
            Spectrum::Measured(measured) => {
                self.tell("spectra are written as their colours");
                let bins = measured.spectrum(self.assets).means(quantity);
                let uplift = self.uplift.get_or_insert_with(|| Box::new(Uplift::new()));
                match quantity {
                    Quantity::Emission => uplift.rgb_of_light(&bins),
                    Quantity::Reflectance | Quantity::Index => uplift.rgb_of_reflectance(&bins),
                }
            }
        };
        rgb.map(|v| if v > 0.0 { v } else { 0.0 })
    }

    /// What a colour is a product of. What glTF has no like of is told, and becomes a mean colour.
    pub fn colour(&mut self, of: &Varying<Spectrum>, quantity: Quantity) -> Product {
        let mut product = Product::of([1.0; 3]);
        if self.times(of, quantity, &mut product) {
            return product;
        }
        self.tell("textures that aren't pictures, or of several, become one colour: glTF has pictures only");
        Product::of(self.mean(of, quantity))
    }

    /// What a number is a product of.
    pub fn amount(&mut self, of: &Varying<f64>) -> Product {
        let mut product = Product::of([1.0; 3]);
        if self.times_number(of, &mut product) {
            return product;
        }
        self.tell("textures that aren't pictures, or of several, become one number: glTF has pictures only");
        Product::of([0.5; 3])
    }

    /// Multiplies by a colour; whether that can be said.
    fn times(&mut self, of: &Varying<Spectrum>, quantity: Quantity, product: &mut Product) -> bool {
        match of {
            Varying::Constant(spectrum) => {
                let rgb = self.rgb(spectrum, quantity);
                product.factor.iter_mut().zip(rgb).for_each(|(f, v)| *f *= v);
                true
            }
            Varying::Texture(texture) => self.times_texture(texture, quantity, product),
        }
    }

    fn times_number(&mut self, of: &Varying<f64>, product: &mut Product) -> bool {
        match of {
            Varying::Constant(v) => {
                product.factor.iter_mut().for_each(|f| *f *= v);
                true
            }
            Varying::Texture(texture) => self.times_texture(texture, Quantity::Reflectance, product),
        }
    }

    fn times_texture(&mut self, of: &TextureOf, quantity: Quantity, product: &mut Product) -> bool {
        let scene = self.scene;
        let texture = match of {
            TextureOf::Inline(texture) => texture,
            TextureOf::Named(link) => match scene.textures.of(link) {
                Some(texture) => texture,
                None => return false,
            },
        };
        match texture {
            Texture::Image(image) => {
                let is_lone = product.image.is_none();
                product.image.get_or_insert_with(|| image.clone());
                is_lone
            }
            Texture::Attribute(a) if a.name.0.value == "color" => {
                product.is_painted = true;
                true
            }
            Texture::Scale(s) => {
                self.times(&s.of, quantity, product)
                    && self.times_number(&s.by, product)
                    && self.times(&s.tint, quantity, product)
            }
            _ => false,
        }
    }

    /// A colour for a texture that can't be written.
    fn mean(&mut self, of: &Varying<Spectrum>, quantity: Quantity) -> [f64; 3] {
        let scene = self.scene;
        let texture = match of {
            Varying::Constant(spectrum) => return self.rgb(spectrum, quantity),
            Varying::Texture(texture) => match texture.as_ref() {
                TextureOf::Inline(texture) => Some(texture),
                TextureOf::Named(link) => scene.textures.of(link),
            },
        };
        if let Some(Texture::Checker(checker)) = texture {
            // Of constants only: a checker may have textures within it, which may be deep.
            let parts = [&checker.first, &checker.second].map(|part| part.constant());
            if let [Some(a), Some(b)] = parts {
                let (a, b) = (self.rgb(a, quantity), self.rgb(b, quantity));
                return std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
            }
        }
        [0.5; 3]
    }

    /// How a material names a picture of colours in sRGB, with an alpha that is read as `alpha` says.
    pub fn colours(&mut self, image: Option<&ImageTexture>, alpha: Slot) -> Option<Json> {
        if let Some(image) = image {
            let bitmap = self.assets.bitmap(image.file.handle);
            let is_light = matches!(bitmap.texels.format().number, Number::Half | Number::Single);
            let is_srgb = match image.color_space {
                TextureSpace::Srgb => true,
                TextureSpace::Auto => bitmap.space.is_none(),
                _ => false,
            };
            if !is_srgb && !is_light {
                self.tell("the codes of pictures are taken for sRGB");
            }
        }
        let channel = |channel: &TextureChannel| match image {
            Some(image) => Slot::Of(ImageTexture { channel: channel.clone(), ..image.clone() }),
            None => Slot::One,
        };
        let [r, g, b, _] = &CHANNELS;
        self.picture([channel(r), channel(g), channel(b), alpha])
    }

    /// How a material names a picture of those channels: that of the scene, where it has them; else one that is put together.
    pub fn picture(&mut self, slots: [Slot; 4]) -> Option<Json> {
        let first = slots.iter().find_map(|slot| if let Slot::Of(image) = slot { Some(image) } else { None });
        let first = first?.clone();
        let lies_like = |image: &ImageTexture| image.mapping == first.mapping && image.wrap == first.wrap;
        let mut key: Key = [None; 4];
        let mut is_as_it_is = true;
        for (i, slot) in slots.iter().enumerate() {
            let Slot::Of(image) = slot else {
                is_as_it_is &= matches!(slot, Slot::Any);
                if matches!(slot, Slot::Half) {
                    key[i] = Some((usize::MAX, 0));
                }
                continue;
            };
            if !lies_like(image) {
                self.tell(
                    "of textures that glTF has in one picture and that lie differently, one is left out",
                );
                is_as_it_is = false;
                continue;
            }
            let grey = self.assets.bitmap(image.file.handle).texels.format().channels < 3;
            // Of grey pictures all colours are the same.
            let fits = image.channel == CHANNELS[i] || (grey && i < 3 && image.channel != CHANNELS[3]);
            is_as_it_is &= fits && image.file.handle == first.file.handle;
            key[i] = Some((image.file.handle.index(), code(&image.channel)));
        }
        if is_as_it_is {
            key = [Some((first.file.handle.index(), u8::MAX)); 4];
        }
        let source = match self.pictures.get(&key) {
            Some(known) => *known,
            None => {
                let bitmap = self.assets.bitmap(first.file.handle).clone();
                let made = if is_as_it_is { Some(bitmap) } else { self.put_together(&slots, &key, &bitmap) };
                let source = made.and_then(|bitmap| self.image(&bitmap, &first.file.file.value));
                self.pictures.insert(key, source);
                source
            }
        }?;
        let texture = json!({ "sampler": self.sampler(&first), "source": source });
        let mut info = Map::new();
        info.insert("index".to_owned(), json!(self.textures.once(texture)));
        self.lay(&first.mapping, &mut info)?;
        Some(info.into())
    }

    /// A picture of the channels of others, as large as the first of them.
    fn put_together(&mut self, slots: &[Slot; 4], key: &Key, first: &Bitmap) -> Option<Arc<Bitmap>> {
        let (width, height) = (first.texels.width(), first.texels.height());
        let format = TexelFormat { number: Number::Byte, channels: 4 };
        let mut texels = Texels::new(width, height, format)?;
        let assets = self.assets;
        let sources: Vec<_> = slots
            .iter()
            .zip(key)
            .map(|(slot, key)| match (slot, key) {
                (Slot::Of(image), Some(_)) => Some((assets.bitmap(image.file.handle), &image.channel)),
                _ => None,
            })
            .collect();
        let is_light =
            |bitmap: &Bitmap| matches!(bitmap.texels.format().number, Number::Half | Number::Single);
        if sources.iter().flatten().any(|(bitmap, _)| is_light(bitmap)) {
            self.tell("pictures of floating point are left out: glTF has PNG");
            return None;
        }
        for y in 0..height {
            for x in 0..width {
                let mut out =
                    [0, 1, 2, 3].map(|i| if matches!(slots[i], Slot::Half) { 128.0 } else { 255.0 });
                for (to, (bitmap, channel)) in
                    out.iter_mut().zip(&sources).filter_map(|(to, s)| Some((to, s.as_ref()?)))
                {
                    *to = code_of(bitmap, channel, [x, y], [width, height]);
                }
                texels.put_numbers(x, y, out);
            }
        }
        Some(Arc::new(Bitmap { texels, response: bitmap::Response::Linear, space: None, has_alpha: true }))
    }

    /// Writes a picture; none where no PNG holds it.
    fn image(&mut self, bitmap: &Bitmap, file: &str) -> Option<usize> {
        let mut bytes = Vec::new();
        match png::write_codes(&mut bytes, bitmap) {
            Some(Ok(())) => {}
            Some(Err(e)) => {
                self.tell(format!("a picture is left out: {e}"));
                return None;
            }
            None => {
                self.tell("pictures of floating point are left out: glTF has PNG");
                return None;
            }
        }
        let view = self.buffer.view(bytes, None);
        let name = file.rsplit(['/', '\\', '#']).next().unwrap_or(file);
        Some(self.images.add(json!({ "name": name, "bufferView": view, "mimeType": "image/png" })))
    }

    /// How a picture is read, and what is beyond its edges.
    fn sampler(&mut self, image: &ImageTexture) -> usize {
        let [magnify, minify] = match image.filter {
            TextureFilter::Nearest => [9728, 9728],
            _ => [9729, 9987],
        };
        let mut wraps = [10497; 2];
        for (code, wrap) in wraps.iter_mut().zip(&image.wrap.0) {
            *code = match wrap {
                Wrap::Repeat => 10497,
                Wrap::Mirror => 33648,
                Wrap::Clamp => 33071,
                Wrap::Black => {
                    self.tell("beyond the edges of pictures there are their last pixels rather than black");
                    33071
                }
            };
        }
        let [s, t] = wraps;
        self.samplers.once(json!({ "magFilter": magnify, "minFilter": minify, "wrapS": s, "wrapT": t }))
    }

    /// By which coordinates a texture lies, and how it is moved; none where glTF has no like.
    fn lay(&mut self, mapping: &Mapping, info: &mut Map<String, Json>) -> Option<()> {
        let (uv, set) = match mapping {
            Mapping::Uv(uv) => (uv, 0),
            Mapping::Attribute(named) => {
                let set = named.name.0.value.strip_prefix("uv").and_then(|set| set.parse::<u32>().ok());
                let Some(set) = set.filter(|set| (1..8).contains(set)) else {
                    self.tell(
                        "textures that lie by coordinates of other names than `uv1` to `uv7` are left out",
                    );
                    return None;
                };
                (&named.uv, set)
            }
            _ => {
                self.tell("textures that don't lie by texture coordinates are left out");
                return None;
            }
        };
        if set > 0 {
            info.insert("texCoord".to_owned(), json!(set));
        }
        if *uv != UvMapping::default() {
            self.extend(info, "KHR_texture_transform", transform(uv));
        }
        Some(())
    }
}

/// A channel's number in a key.
const fn code(channel: &TextureChannel) -> u8 {
    match channel {
        TextureChannel::Red => 0,
        TextureChannel::Green => 1,
        TextureChannel::Blue => 2,
        TextureChannel::Alpha => 3,
        TextureChannel::Luminance => 4,
    }
}

/// A channel of a picture as a code of a byte, at a place of a picture of another size.
fn code_of(bitmap: &Bitmap, channel: &TextureChannel, at: [usize; 2], size: [usize; 2]) -> f32 {
    let texels = &bitmap.texels;
    let TexelFormat { number, channels } = texels.format();
    let full = if number == Number::Short { 65535.0 } else { 255.0 };
    let numbers = texels.numbers(at[0] * texels.width() / size[0], at[1] * texels.height() / size[1]);
    let (rgb, alpha) = match channels {
        1 => ([numbers[0]; 3], full),
        2 => ([numbers[0]; 3], numbers[1]),
        _ => ([numbers[0], numbers[1], numbers[2]], numbers[3]),
    };
    let alpha = if bitmap.has_alpha { alpha } else { full };
    let v = match channel {
        TextureChannel::Red => rgb[0],
        TextureChannel::Green => rgb[1],
        TextureChannel::Blue => rgb[2],
        TextureChannel::Alpha => alpha,
        TextureChannel::Luminance => luminance(rgb),
    };
    (v / full * 255.0).round()
}

/// What `KHR_texture_transform` says of a mapping: the reader's own is undone, where v rises.
fn transform(uv: &UvMapping) -> Json {
    let UvMapping { scale: [su, sv], rotate, translate: [u, v] } = *uv;
    let (sin, cos) = ops::sin_cos_degrees(rotate);
    json!({
        "offset": [u - sv * sin, 1.0 - v - sv * cos],
        "rotation": rotate.to_radians(),
        "scale": [su, sv],
    })
}
