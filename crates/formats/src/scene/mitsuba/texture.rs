//! Textures.

use straal_math::Affine;
use straal_scene::desc::{
    AttributeName, AttributePer, AttributeTexture, Checker, ImageTexture, ScaleTexture, Spectrum, Texture,
    TextureChannel, TextureFilter, TextureOf, TextureSpace, Varying, Wrap, Wraps,
};
use straal_scene::limit::Limit;
use straal_scene::value::LinearRgb;
use straal_scene::{Spanned, suggest};

use super::spectrum::{For, is_spectrum, luminance};
use super::translate::Translator;
use super::tree::{Class, Object, Value};
use super::uv::Uv;

/// What a texture is read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Role {
    /// A share of light.
    Share,
    /// Light that is sent out.
    Light,
    /// A number.
    Number,
}

impl Role {
    pub const fn of(what: For) -> Self {
        match what {
            For::Share => Self::Share,
            For::Light | For::Any => Self::Light,
        }
    }

    /// What of a name tells a texture that is read so from others.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Share => "",
            Self::Light => "light",
            Self::Number => "number",
        }
    }

    const fn colours(self) -> For {
        match self {
            Self::Share | Self::Number => For::Share,
            Self::Light => For::Light,
        }
    }
}

impl<'o> Translator<'o, '_, '_> {
    /// A texture, for a surface with these coordinates.
    pub fn texture(&mut self, i: usize, uv: Uv, role: Role) -> TextureOf {
        self.shared_texture((i, uv, role), |t| t.new_texture(i, uv, role))
    }

    fn new_texture(&mut self, i: usize, uv: Uv, role: Role) -> Texture {
        let o: &'o Object = &self.objects[i];
        match o.plugin.as_str() {
            "bitmap" => self.bitmap(o, uv, role),
            "checkerboard" | "gridtexture" => self.checkerboard(o, uv, role),
            "mesh_attribute" => self.attribute(o, role),
            "vertexcolors" => {
                self.only(o, &[]);
                attribute("color", AttributePer::Vertex)
            }
            "scale" => {
                self.only(o, &["scale", "*"]);
                let factor = match self.get(o, "scale").map(|p| &p.value) {
                    Some(Value::Rgb(_) | Value::Spectrum(_)) => {
                        let colour = self.constant(o, "scale", 1.0, For::Any);
                        colour.rgb().map_or(1.0, |c| luminance(c.0))
                    }
                    _ => self.within(o, "scale", 1.0, Limit::NON_NEGATIVE),
                };
                let inner = self.inside(o, Class::Texture).first().copied();
                let of = match inner {
                    Some(inner) => Varying::Texture(Box::new(self.texture(inner, uv, role))),
                    None => Varying::Constant(Spectrum::grey(1.0)),
                };
                Texture::Scale(ScaleTexture { of, by: Varying::Constant(factor), ..ScaleTexture::default() })
            }
            "volume" => {
                self.only(o, &["volume", "*"]);
                let inner = self.inside(o, Class::Volume).first().copied();
                let of = match inner.map(|inner| &self.objects[inner]) {
                    None => self.colour(o, "volume", 0.75, role.colours(), uv),
                    // The same everywhere.
                    Some(inner) if inner.plugin.as_str() == "constvolume" => {
                        self.only(inner, &["value", "to_world", "*"]);
                        self.colour(inner, "value", 1.0, role.colours(), uv)
                    }
                    Some(inner) => {
                        self.unsupported(inner, "grey stands in for it");
                        return grey(0.5);
                    }
                };
                Texture::Scale(ScaleTexture { of, ..ScaleTexture::default() })
            }
            plugin if is_spectrum(plugin) => {
                let of = Varying::Constant(self.plugin(i, role.colours()));
                Texture::Scale(ScaleTexture { of, ..ScaleTexture::default() })
            }
            _ => {
                self.unsupported(o, "grey stands in for it");
                grey(0.5)
            }
        }
    }

    fn bitmap(&mut self, o: &'o Object, uv: Uv, role: Role) -> Texture {
        self.only(
            o,
            &[
                "filename",
                "raw",
                "filter_type",
                "wrap_mode",
                "to_uv",
                "format",
                "accel",
                "gamma",
                "channel",
                "max_anisotropy",
                "wrap_mode_u",
                "wrap_mode_v",
                "cache",
                "id",
            ],
        );
        let Some(file) = self.text(o, "filename") else {
            self.fail(o.plugin.span, "this picture has no `filename`");
            return grey(0.5);
        };
        let Some(found) = self.file(o, &file) else { return grey(0.5) };
        let asset = self.made.in_file(Spanned::new(found.name, file.span));
        let is_raw = self.boolean(o, "raw").unwrap_or(false);
        let gamma = self.float(o, "gamma").unwrap_or(-1.0);
        let color_space = match () {
            () if is_raw => TextureSpace::Raw,
            () if gamma == 1.0 => TextureSpace::Linear,
            () => TextureSpace::Srgb,
        };
        if gamma != 1.0 && gamma != -1.0 {
            self.warn(
                o.plugin.span,
                format!("a picture's own `gamma` of {gamma} isn't supported: it is read as sRGB"),
            );
        }
        let filter = match self.word(o, "filter_type", &["bilinear", "nearest", "ewa", "trilinear"]) {
            Some("nearest") => TextureFilter::Nearest,
            Some("ewa") => TextureFilter::Ewa,
            Some("trilinear") => TextureFilter::Trilinear,
            None if o.is_old => TextureFilter::Ewa,
            _ => TextureFilter::Bilinear,
        };
        let channel = match self.word(o, "channel", &["r", "g", "b", "a", "x", "y", "z"]) {
            Some("r") => TextureChannel::Red,
            Some("g") => TextureChannel::Green,
            Some("b") => TextureChannel::Blue,
            Some("a") => TextureChannel::Alpha,
            _ => TextureChannel::Luminance,
        };
        if o.has("channel") && role != Role::Number {
            self.warn(
                o.plugin.span,
                "one `channel` of a picture as a colour isn't supported: all of them are taken",
            );
        }
        let words = ["repeat", "mirror", "clamp", "zero", "one"];
        let wrap = |t: &mut Self, name: &str, absent: Wrap| match t.word(o, name, &words) {
            Some("repeat") => Wrap::Repeat,
            Some("mirror") => Wrap::Mirror,
            Some("clamp") => Wrap::Clamp,
            Some("zero") => Wrap::Black,
            Some(_) => {
                t.warn(o.plugin.span, "what is beyond a picture can't be 1 here: its edge goes on");
                Wrap::Clamp
            }
            None => absent,
        };
        let both = wrap(self, "wrap_mode", Wrap::Repeat);
        let across = wrap(self, "wrap_mode_u", both.clone());
        let down = wrap(self, "wrap_mode_v", both);
        let mapping = self.mapping(o, uv, true);
        Texture::Image(ImageTexture {
            file: asset,
            color_space,
            channel,
            filter,
            anisotropy: 16.0,
            wrap: Wraps([across, down]),
            mapping,
        })
    }

    fn checkerboard(&mut self, o: &'o Object, uv: Uv, role: Role) -> Texture {
        self.only(o, &["color0", "color1", "to_uv", "line_width"]);
        if o.plugin.as_str() == "gridtexture" {
            self.unsupported(o, "it is a checkerboard here");
        }
        let what = role.colours();
        let first = self.colour(o, "color0", 0.4, what, uv);
        let second = self.colour(o, "color1", 0.2, what, uv);
        let plain = |colour: Varying<Spectrum>| match colour {
            Varying::Constant(Spectrum::Rgb(LinearRgb(rgb))) if role == Role::Number => {
                Varying::Constant(Spectrum::grey(luminance(rgb)))
            }
            other => other,
        };
        // As a number Mitsuba's has its two colours the other way round.
        let (first, second) =
            if role == Role::Number { (plain(second), plain(first)) } else { (first, second) };
        let mapping = self.mapping(o, uv, false);
        Texture::Checker(Checker { first, second, squares: [2.0, 2.0], averaged: false, mapping })
    }

    fn mapping(&mut self, o: &'o Object, uv: Uv, is_picture: bool) -> straal_scene::desc::Mapping {
        let to_uv: Affine = self.transform(o, "to_uv");
        let (mapping, is_exact) = uv.mapping(&to_uv, is_picture);
        if !is_exact {
            let span = self.get(o, "to_uv").map_or(o.plugin.span, |p| p.span);
            self.warn(
                span,
                "this `to_uv` slants the texture, which isn't supported: it is scaled and turned only",
            );
        }
        mapping
    }

    fn attribute(&mut self, o: &'o Object, _: Role) -> Texture {
        self.only(o, &["name", "scale"]);
        let Some(name) = self.text(o, "name") else {
            self.fail(o.plugin.span, "`mesh_attribute` needs the `name` of what the mesh has");
            return grey(0.0);
        };
        let scale = self.within(o, "scale", 1.0, Limit::NON_NEGATIVE);
        let (per, rest) = match name.split_once('_') {
            Some(("vertex", rest)) => (AttributePer::Vertex, rest),
            Some(("face", rest)) => (AttributePer::Face, rest),
            _ => {
                let message =
                    format!("`{}` begins with neither `vertex_` nor `face_`", suggest::brief(&name));
                self.push(straal_scene::Diagnostic::error(name.span, message));
                return grey(0.0);
            }
        };
        let codes = self.codes.contains(name.as_str());
        // Mitsuba has bytes as they are, from 0 to 255.
        let scale = if codes { 255.0 * scale } else { scale };
        let read = attribute(rest, per);
        if scale == 1.0 {
            return read;
        }
        let of = Varying::Texture(Box::new(TextureOf::Inline(read)));
        Texture::Scale(ScaleTexture { of, by: Varying::Constant(scale), ..ScaleTexture::default() })
    }
}

/// What a mesh has, its numbers as they are; 0 where it hasn't.
fn attribute(name: &str, per: AttributePer) -> Texture {
    Texture::Attribute(AttributeTexture {
        name: AttributeName(name.to_owned().into()),
        per,
        color_space: TextureSpace::Raw,
        channel: TextureChannel::Luminance,
        absent: Spectrum::grey(0.0),
    })
}

/// A colour as a texture.
pub(super) fn grey(v: f64) -> Texture {
    let of = Varying::Constant(Spectrum::grey(v));
    Texture::Scale(ScaleTexture { of, ..ScaleTexture::default() })
}
