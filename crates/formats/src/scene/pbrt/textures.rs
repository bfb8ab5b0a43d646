//! Textures.

use std::collections::BTreeMap;

use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    Checker, CornersTexture, CubesTexture, CylindricalMapping, DotsTexture, FacingTexture, ImageTexture,
    InvertTexture, Mapping, MappingSpace, MixTexture, NoiseForm, NoiseTexture, PlanarMapping,
    RampInterpolation, RampStop, RampTexture, RemapTexture, ScaleTexture, Spectrum, SphericalMapping,
    Texture, TextureChannel, TextureFilter, TextureOf, TextureSpace, Transform, UvMapping, Varying, Wrap,
    Wraps,
};
use straal_scene::value::{LinearRgb, Link};
use straal_scene::{Bitmap, Spanned, suggest};

use super::params::Params;
use super::spectra::Role;
use super::state::as_transform;
use super::{Reader, Thing};

/// Whether a texture is of numbers or of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Of {
    Numbers,
    Colours,
}

/// What stands for a texture of pbrt.
#[derive(Clone)]
enum Stand {
    /// One of the scene's textures, by that name.
    Texture(String),
    /// The same everywhere.
    Constant(Spectrum),
}

/// The textures so far. Those of numbers and of colours have names of their own.
#[derive(Default)]
pub(super) struct Known {
    by_name: BTreeMap<(Of, String), Stand>,
}

impl Reader<'_, '_> {
    /// Makes a texture.
    pub(super) fn texture(&mut self, name: Spanned<String>, of: &Spanned<String>, thing: Thing) {
        let of = match of.as_str() {
            "float" => Of::Numbers,
            "spectrum" | "color" => Of::Colours,
            _ => return self.unknown("type of texture", of, &["float", "spectrum"]),
        };
        let key = (of, name.value.clone());
        if self.textures.by_name.contains_key(&key) {
            return self
                .error(name.span, format!("the texture `{}` is defined twice", suggest::brief(&name)));
        }
        let Thing { kind, params } = thing;
        let params = params.within(&self.state.attributes.texture);
        if self.state.moves() {
            self.warn_once(
                params.span,
                "lights, curves and textures that move stand where they are when motion begins",
            );
        }
        let made = self.texture_of(&kind, &params, of);
        params.complain(&format!("the texture `{}`", kind.value), self.means.d);
        let stand = match made {
            Varying::Constant(value) => Stand::Constant(value),
            Varying::Texture(texture) => {
                let mut own = name.value.clone();
                if self.scene.textures.get(&own).is_some() {
                    own = match of {
                        Of::Numbers => format!("{own} (numbers)"),
                        Of::Colours => format!("{own} (colours)"),
                    };
                }
                match *texture {
                    TextureOf::Inline(texture) => {
                        self.scene.textures.insert(Spanned::new(own.clone(), name.span), texture);
                        Stand::Texture(own)
                    }
                    // Another one under a second name.
                    TextureOf::Named(link) => Stand::Texture(link.name.value),
                }
            }
        };
        self.textures.by_name.insert(key, stand);
    }

    fn texture_of(&mut self, kind: &Spanned<String>, params: &Params, of: Of) -> Varying<Spectrum> {
        let zero = || Varying::Constant(Spectrum::grey(0.0));
        let one = || Varying::Constant(Spectrum::grey(1.0));
        let half = || Varying::Constant(Spectrum::grey(0.5));
        match kind.as_str() {
            "constant" => self.value(params, "value", of).unwrap_or_else(one),
            "imagemap" => self.image_map(params),
            "scale" => {
                // Version 3 calls them `tex1` and `tex2`.
                let first = if params.has("tex") { "tex" } else { "tex1" };
                let second = if params.has("scale") { "scale" } else { "tex2" };
                let texture = self.value(params, first, of).unwrap_or_else(one);
                let by_colour = of == Of::Colours && second == "tex2";
                let by =
                    self.value(params, second, if by_colour { of } else { Of::Numbers }).unwrap_or_else(one);
                scaled(texture, by)
            }
            "mix" | "directionmix" => {
                let first = self.value(params, "tex1", of).unwrap_or_else(zero);
                let second = self.value(params, "tex2", of).unwrap_or_else(one);
                if kind.as_str() == "directionmix" {
                    let direction = self.state.transform().vector(params.vector("dir").unwrap_or(DVec3::Y));
                    let space = MappingSpace::World;
                    return inline(Texture::Facing(FacingTexture { first, second, direction, space }));
                }
                let amount = self.number(params, "amount").unwrap_or(Varying::Constant(0.5));
                inline(Texture::Mix(MixTexture { first, second, amount: share(amount) }))
            }
            "checkerboard" => {
                let first = self.value(params, "tex1", of).unwrap_or_else(one);
                let second = self.value(params, "tex2", of).unwrap_or_else(zero);
                if params.integer("dimension", 2) == 3 {
                    params.pass_over(&[
                        "mapping", "uscale", "vscale", "udelta", "vdelta", "v1", "v2", "aamode",
                    ]);
                    let (space, transform) = (MappingSpace::World, self.solid(params));
                    return inline(Texture::Cubes(CubesTexture { first, second, space, transform }));
                }
                let mapping = self.mapping(params);
                params.pass_over(&["aamode"]);
                let squares = [1.0, 1.0];
                inline(Texture::Checker(Checker { first, second, squares, averaged: true, mapping }))
            }
            "bilerp" => {
                let [v00, v10] = ["v00", "v10"].map(|name| self.value(params, name, of).unwrap_or_else(zero));
                let [v01, v11] = ["v01", "v11"].map(|name| self.value(params, name, of).unwrap_or_else(one));
                let mapping = self.mapping(params);
                inline(Texture::Corners(CornersTexture { v00, v10, v01, v11, mapping }))
            }
            "dots" => {
                let inside = self.value(params, "inside", of).unwrap_or_else(one);
                let outside = self.value(params, "outside", of).unwrap_or_else(zero);
                let mapping = self.mapping(params);
                inline(Texture::Dots(DotsTexture { inside, outside, mapping }))
            }
            "fbm" | "wrinkled" | "windy" | "marble" => self.noise(kind, params),
            "ptex" => {
                params.pass_over(&["filename", "gamma", "scale", "encoding"]);
                self.warn(kind.span, "textures in Ptex can't be read: it is grey, 0.5");
                half()
            }
            _ => {
                self.unknown(
                    "texture",
                    kind,
                    &[
                        "bilerp",
                        "checkerboard",
                        "constant",
                        "directionmix",
                        "dots",
                        "fbm",
                        "imagemap",
                        "marble",
                        "mix",
                        "ptex",
                        "scale",
                        "windy",
                        "wrinkled",
                    ],
                );
                half()
            }
        }
    }

    /// Where a pattern of space lies, by the transform that is in force.
    fn solid(&mut self, params: &Params) -> Transform {
        let map = *self.state.transform();
        if straal_math::Transform::new(&map).is_none() {
            self.warn(params.span, "the texture's transform is singular: the world's places are taken");
            return Transform::default();
        }
        as_transform(&map, params.span)
    }

    fn noise(&mut self, kind: &Spanned<String>, params: &Params) -> Varying<Spectrum> {
        let form = match kind.as_str() {
            "fbm" => NoiseForm::Fbm,
            "wrinkled" => NoiseForm::Wrinkled,
            "windy" => NoiseForm::Windy,
            _ => NoiseForm::Marble,
        };
        let is_marble = form == NoiseForm::Marble;
        let mut noise = NoiseTexture { form, space: MappingSpace::World, ..NoiseTexture::default() };
        noise.transform = self.solid(params);
        if noise.form != NoiseForm::Windy {
            let octaves = params.integer("octaves", 8);
            noise.octaves = octaves.clamp(1, 16) as u32;
            let roughness = params.float("roughness", 0.5);
            noise.roughness =
                if roughness > 0.0 { if roughness < 1.0 { roughness } else { 1.0 } } else { 0.0 };
            if i64::from(noise.octaves) != i64::from(octaves) || noise.roughness != roughness {
                self.warn(params.span, "`octaves` are kept from 1 to 16 here, `roughness` from 0 to 1");
            }
        }
        if !is_marble {
            return inline(Texture::Noise(noise));
        }
        let scale = params.float("scale", 1.0);
        let variation = params.float("variation", 0.2);
        noise.variation = if variation.abs() <= 1e3 { variation } else { 0.2 };
        let larger = Affine::scale(DVec3::splat(1.0 / scale)).then(self.state.transform());
        if scale != 1.0 && straal_math::Transform::new(&larger).is_some() {
            noise.transform = as_transform(&larger, params.span);
        }
        inline(Texture::Ramp(RampTexture {
            of: Varying::Texture(Box::new(TextureOf::Inline(Texture::Noise(noise)))),
            stops: marble(),
            interpolation: RampInterpolation::Linear,
        }))
    }

    fn image_map(&mut self, params: &Params) -> Varying<Spectrum> {
        let Some(file) = params.string("filename").cloned() else {
            self.error(params.span, "a texture `imagemap` needs a `filename`");
            return Varying::Constant(Spectrum::grey(0.5));
        };
        let asset = self.made.in_file::<Bitmap>(file.clone());
        let is_png = file.to_ascii_lowercase().ends_with(".png");
        let encoding = params.string("encoding");
        let color_space = match encoding.map(|e| e.as_str()) {
            Some("sRGB" | "srgb") => TextureSpace::Srgb,
            Some("linear") => TextureSpace::Linear,
            None if is_png => TextureSpace::Srgb,
            // Version 4 takes all else for linear; version 3 says so for each.
            None => match params.find("gamma", |_| true) {
                Some(_) => TextureSpace::Auto,
                None => TextureSpace::Linear,
            },
            Some(other) => {
                let message = format!("the encoding `{}` is taken for that of sRGB", suggest::brief(other));
                let span = encoding.map_or(params.span, |e| e.span);
                self.warn(span, message);
                TextureSpace::Srgb
            }
        };
        let filter = match params.string("filter").map(|f| f.as_str()) {
            Some("point") => TextureFilter::Nearest,
            Some("ewa" | "EWA") => TextureFilter::Ewa,
            // pbrt's `bilinear` chooses among smaller copies as well.
            _ => TextureFilter::Trilinear,
        };
        params.pass_over(&["trilinear"]);
        let wrap = match params.string("wrap").map(|w| w.as_str()) {
            Some("clamp") => Wrap::Clamp,
            Some("black") => Wrap::Black,
            _ => Wrap::Repeat,
        };
        let anisotropy = params.float("maxanisotropy", 8.0);
        let texture = Texture::Image(ImageTexture {
            file: asset,
            color_space,
            channel: TextureChannel::Luminance,
            filter,
            anisotropy: if (1.0..=64.0).contains(&anisotropy) { anisotropy } else { 8.0 },
            wrap: Wraps([wrap.clone(), wrap]),
            mapping: self.mapping(params),
        });
        let scale = params.float("scale", 1.0);
        let mut texture = inline(texture);
        if scale != 1.0 && scale >= 0.0 {
            texture = scaled(texture, Varying::Constant(Spectrum::grey(scale)));
        }
        if params.bool("invert", false) {
            texture = inline(Texture::Invert(InvertTexture { of: texture }));
        }
        texture
    }

    /// How a texture lies on a surface.
    fn mapping(&mut self, params: &Params) -> Mapping {
        let delta = [params.float("udelta", 0.0), params.float("vdelta", 0.0)];
        let space = MappingSpace::World;
        let map = *self.state.transform();
        let kind = params.string("mapping").cloned();
        match kind.as_ref().map_or("uv", |kind| kind.as_str()) {
            "uv" => {
                let scale = [params.float("uscale", 1.0), params.float("vscale", 1.0)];
                Mapping::Uv(UvMapping { scale, rotate: 0.0, translate: delta })
            }
            "planar" => {
                let v1 = params.vector("v1").unwrap_or(DVec3::X);
                let v2 = params.vector("v2").unwrap_or(DVec3::Y);
                let n = v1.cross(v2);
                let to_plane = Affine { rows: [v1, v2, n].map(|v| [v.x, v.y, v.z, 0.0]) };
                let placed = to_plane.inverse().map(|own| own.then(&map));
                let Some(placed) = placed.filter(|m| straal_math::Transform::new(m).is_some()) else {
                    self.warn(
                        params.span,
                        "this planar mapping has no plane: the surface's own coordinates are taken",
                    );
                    return Mapping::default();
                };
                let uv = UvMapping { translate: delta, ..UvMapping::default() };
                let transform = as_transform(&placed, params.span);
                Mapping::Planar(PlanarMapping { space, uv, transform })
            }
            kind @ ("spherical" | "cylindrical") => {
                params.pass_over(&["uscale", "vscale"]);
                // About z, where straal's are about y: s goes from pole to pole, t once around from +x.
                let upright =
                    Affine { rows: [[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]] };
                let placed = upright.then(&map);
                if straal_math::Transform::new(&placed).is_none() {
                    self.warn(
                        params.span,
                        "the texture's transform is singular: the surface's own coordinates are taken",
                    );
                    return Mapping::default();
                }
                let transform = as_transform(&placed, params.span);
                let uv = UvMapping { scale: [1.0, -1.0], rotate: 90.0, translate: [0.0, -0.5] };
                self.warn_once(
                    params.span,
                    format!("the seam of a {kind} mapping may lie elsewhere than in pbrt"),
                );
                if kind == "spherical" {
                    Mapping::Spherical(SphericalMapping { space, uv, transform })
                } else {
                    Mapping::Cylindrical(CylindricalMapping { space, uv, transform })
                }
            }
            _ => {
                if let Some(kind) = kind {
                    self.unknown("mapping", &kind, &["uv", "spherical", "cylindrical", "planar"]);
                }
                Mapping::default()
            }
        }
    }

    /// A colour or number of a texture or material: a constant, or what a texture has.
    pub(super) fn value(&mut self, params: &Params, name: &'static str, of: Of) -> Option<Varying<Spectrum>> {
        if let Some(texture) = params.texture(name).cloned() {
            return Some(self.named_texture(&texture, of));
        }
        match of {
            Of::Numbers => {
                let v = params.maybe_float(name)?;
                if v < 0.0 {
                    self.warn_once(
                        params.span,
                        "a texture's numbers are 0 or above: what lies below is cut off",
                    );
                }
                Some(Varying::Constant(Spectrum::grey(if v > 0.0 { v } else { 0.0 })))
            }
            Of::Colours => self.spectrum(params, name, Role::Albedo).map(Varying::Constant),
        }
    }

    /// A number that a texture may tell.
    pub(super) fn number(&mut self, params: &Params, name: &'static str) -> Option<Varying<f64>> {
        if let Some(texture) = params.texture(name).cloned() {
            return Some(as_number(self.named_texture(&texture, Of::Numbers)));
        }
        params.maybe_float(name).map(Varying::Constant)
    }

    /// What a texture's name leads to.
    pub(super) fn named_texture(&mut self, name: &Spanned<String>, of: Of) -> Varying<Spectrum> {
        let known = &self.textures.by_name;
        let other = if of == Of::Numbers { Of::Colours } else { Of::Numbers };
        let stand = known.get(&(of, name.value.clone())).or_else(|| known.get(&(other, name.value.clone())));
        match stand {
            Some(Stand::Constant(value)) => Varying::Constant(value.clone()),
            Some(Stand::Texture(own)) => {
                let link = Link::new(Spanned::new(own.clone(), name.span));
                Varying::Texture(Box::new(TextureOf::Named(link)))
            }
            None => {
                let names = known.keys().map(|(_, name)| name.as_str()).take(1000);
                let help = suggest::did_you_mean(name, names);
                let message = format!("there is no texture `{}`", suggest::brief(name));
                self.d().push(straal_scene::Diagnostic::error(name.span, message).maybe_help(help));
                Varying::Constant(Spectrum::grey(0.5))
            }
        }
    }
}

/// The colours of pbrt's marble from 0 to 1: six curves of third degree (Bézier), each of four of nine colours, one on from the curve before. So the curves don't
/// meet. A curve is told by so many straight pieces that no colour is off by more than a thousandth.
fn marble() -> Vec<RampStop> {
    const LIGHT: [f64; 3] = [0.58, 0.58, 0.6];
    const COLOURS: [[f64; 3]; 9] =
        [LIGHT, LIGHT, LIGHT, [0.5; 3], [0.6, 0.59, 0.58], LIGHT, LIGHT, [0.2, 0.2, 0.33], LIGHT];
    const PIECES: u32 = 16;
    let mut stops = Vec::new();
    for (curve, points) in COLOURS.windows(4).enumerate() {
        for i in 0..=PIECES {
            let t = f64::from(i) / f64::from(PIECES);
            let s = 1.0 - t;
            let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
            let colour = [0, 1, 2].map(|k| {
                let mean: f64 = (0..4).map(|j| weights[j] * points[j][k]).sum();
                1.5 * mean
            });
            stops.push(RampStop {
                at: (curve as f64 + t) / (COLOURS.len() - 3) as f64,
                color: Spectrum::Rgb(LinearRgb(colour)),
            });
        }
    }
    stops
}

/// A texture where it is used.
pub(super) fn inline(texture: Texture) -> Varying<Spectrum> {
    Varying::Texture(Box::new(TextureOf::Inline(texture)))
}

/// What is read as one number.
pub(super) fn as_number(value: Varying<Spectrum>) -> Varying<f64> {
    match value {
        Varying::Constant(Spectrum::Rgb(LinearRgb([r, g, b]))) => Varying::Constant((r + g + b) / 3.0),
        Varying::Constant(Spectrum::Measured(_)) => Varying::Constant(0.5),
        Varying::Texture(texture) => Varying::Texture(texture),
    }
}

/// What is a share.
pub(super) fn share(value: Varying<f64>) -> Varying<f64> {
    match value {
        Varying::Constant(v) => Varying::Constant(if v > 0.0 { if v < 1.0 { v } else { 1.0 } } else { 0.0 }),
        texture => texture,
    }
}

/// The root of a number from 0 to 1, as pbrt makes a roughness the alpha of microfacets.
pub(super) fn root(value: Varying<f64>) -> Varying<f64> {
    match share(value) {
        Varying::Constant(v) => Varying::Constant(v.sqrt()),
        Varying::Texture(texture) => {
            let of = Varying::Texture(texture);
            let remap = RemapTexture { of, from: [0.0, 1.0], to: [0.0, 1.0], power: 0.5 };
            Varying::Texture(Box::new(TextureOf::Inline(Texture::Remap(remap))))
        }
    }
}

/// One times the other.
pub(super) fn scaled(of: Varying<Spectrum>, by: Varying<Spectrum>) -> Varying<Spectrum> {
    let grey = |v: &Varying<Spectrum>| {
        v.constant().and_then(Spectrum::rgb).filter(|LinearRgb([r, g, b])| r == g && g == b).map(|c| c.0[0])
    };
    if grey(&by) == Some(1.0) {
        return of;
    }
    if let (Varying::Constant(spectrum), Some(factor)) = (&of, grey(&by)) {
        return Varying::Constant(super::spectra::times(spectrum, factor));
    }
    let scale = match (grey(&by), by) {
        (Some(factor), _) => {
            ScaleTexture { of, by: Varying::Constant(factor), tint: Varying::Constant(Spectrum::grey(1.0)) }
        }
        (None, by) => ScaleTexture { of, by: Varying::Constant(1.0), tint: by },
    };
    inline(Texture::Scale(scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marble_has_the_colours_of_its_curves() {
        let stops = marble();
        assert!(stops.windows(2).all(|pair| pair[0].at <= pair[1].at));
        assert_eq!((stops[0].at, stops[stops.len() - 1].at), (0.0, 1.0));
        // All lie between the darkest and the lightest, and the first is the first colour.
        let rgb = |stop: &RampStop| stop.color.rgb().unwrap().0;
        assert!((rgb(&stops[0])[2] - 0.9).abs() < 1e-12);
        assert!(stops.iter().flat_map(rgb).all(|v| (0.3..=0.9 + 1e-12).contains(&v)));
    }
}
