//! Surfaces of MaterialX in a stage, `standard_surface` and `open_pbr_surface`, and the nodes that they read: pictures, constants, and products with these.
//!
//! `standard_surface` becomes `open_pbr` as MaterialX's own translation has it (`standard_surface_to_open_pbr`), whose layers it shares.

use straal_scene::desc::{Material, OpenPbr, Spectrum, Varying, Wrap};

use super::layer::{self, Value};
use super::material::{Has, Input, limited, one, positive, three};
use super::texture::Read;
use super::{Translation, within};

/// A surface of MaterialX.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Standard,
    OpenPbr,
}

impl Kind {
    /// By a shader's name.
    pub fn of(id: &str) -> Option<Self> {
        // Behind it may stand a version.
        match id.strip_prefix("ND_")? {
            name if name.starts_with("standard_surface_surfaceshader") => Some(Self::Standard),
            name if name.starts_with("open_pbr_surface_surfaceshader") => Some(Self::OpenPbr),
            _ => None,
        }
    }
}

/// A node by its name, without its types: `image` of `ND_image_color3`.
pub(super) fn node(id: &str) -> Option<&str> {
    const KNOWN: [&str; 14] = [
        "tiledimage",
        "image",
        "constant",
        "multiply",
        "convert",
        "extract",
        "swizzle",
        "dot",
        "normalmap",
        "texcoord",
        "geompropvalue",
        "geomcolor",
        "place2d",
        "UsdPrimvarReader",
    ];
    let name = id.strip_prefix("ND_")?;
    // What has one type only may stand without it.
    let is_whole = |rest: &str| rest.is_empty() || rest.starts_with('_');
    KNOWN.into_iter().find(|known| name.strip_prefix(known).is_some_and(is_whole))
}

/// How a picture goes on beyond its edges.
pub(super) fn wrap(word: Option<String>) -> Wrap {
    match word.as_deref() {
        Some("clamp") => Wrap::Clamp,
        Some("mirror") => Wrap::Mirror,
        Some("constant") => Wrap::Black,
        _ => Wrap::Repeat,
    }
}

impl Translation<'_, '_> {
    /// A surface of MaterialX as `open_pbr`.
    pub fn layered(&mut self, shader: usize, kind: Kind, has: &Has) -> Material {
        let mut made = match kind {
            Kind::Standard => self.standard(shader, has),
            Kind::OpenPbr => self.open_pbr(shader, has),
        };
        made.two_sided = true;
        for (name, what) in [
            ("coat_normal", "normals of a coat's own are left out"),
            ("geometry_coat_normal", "normals of a coat's own are left out"),
            ("tangent", "directions of brushed surfaces are those of the mesh"),
            ("geometry_tangent", "directions of brushed surfaces are those of the mesh"),
        ] {
            if self.source(shader, &format!("inputs:{name}")).is_some_and(|(node, _)| !self.is_own(node)) {
                self.warn(shader, what);
            }
        }
        let normal = if kind == Kind::Standard { "normal" } else { "geometry_normal" };
        made.relief = self.relief(shader, normal, has);
        let shines = made.emission_luminance != Varying::Constant(0.0);
        if shines && made.geometry_opacity != Varying::Constant(1.0) {
            // What shines may have holes as a whole only.
            made.emission_luminance = Varying::Constant(0.0);
            self.warn(shader, "it doesn't shine, as it has holes");
        }
        Material::OpenPbr(made)
    }

    /// Whether a node says what the mesh itself has.
    fn is_own(&self, node: usize) -> bool {
        let id = self.stage.text(node, "info:id").unwrap_or_default();
        id.starts_with("ND_normal_") || id.starts_with("ND_tangent_")
    }

    fn standard(&mut self, shader: usize, has: &Has) -> OpenPbr {
        let film = self.number(shader, "thin_film_thickness", 0.0);
        let abbe = self.number(shader, "transmission_dispersion", 0.0);
        if self.number(shader, "transmission_extra_roughness", 0.0) != 0.0 {
            self.warn(shader, "`transmission_extra_roughness` is left out");
        }
        if self.number(shader, "coat_affect_roughness", 0.0) != 0.0 {
            self.warn(
                shader,
                "`coat_affect_roughness` is left out: a coat roughens what lies below by itself",
            );
        }
        OpenPbr {
            base_weight: self.amount(shader, "base", 1.0, has),
            base_color: self.share_of(shader, "base_color", 0.8, has),
            base_diffuse_roughness: self.amount(shader, "diffuse_roughness", 0.0, has),
            base_metalness: self.amount(shader, "metalness", 0.0, has),
            specular_weight: self.amount(shader, "specular", 1.0, has),
            specular_color: self.share_of(shader, "specular_color", 1.0, has),
            specular_roughness: self.amount(shader, "specular_roughness", 0.2, has),
            specular_roughness_anisotropy: self.amount(shader, "specular_anisotropy", 0.0, has),
            specular_ior: self.index(shader, "specular_IOR", 1.5),
            transmission_weight: self.amount(shader, "transmission", 0.0, has),
            transmission_color: self.share_of(shader, "transmission_color", 1.0, has),
            transmission_depth: self.length(shader, "transmission_depth"),
            transmission_dispersion_scale: Varying::Constant(if abbe > 0.0 { 1.0 } else { 0.0 }),
            transmission_dispersion_abbe_number: Varying::Constant(within(abbe, 6.2, 1e6)),
            subsurface_weight: self.amount(shader, "subsurface", 0.0, has),
            subsurface_color: self.share_of(shader, "subsurface_color", 1.0, has),
            fuzz_weight: self.amount(shader, "sheen", 0.0, has),
            fuzz_color: self.share_of(shader, "sheen_color", 1.0, has),
            fuzz_roughness: self.amount(shader, "sheen_roughness", 0.3, has),
            coat_weight: self.amount(shader, "coat", 0.0, has),
            coat_color: self.share_of(shader, "coat_color", 1.0, has),
            coat_roughness: self.amount(shader, "coat_roughness", 0.1, has),
            coat_roughness_anisotropy: self.amount(shader, "coat_anisotropy", 0.0, has),
            coat_ior: self.index(shader, "coat_IOR", 1.5),
            // Below a coat of it nothing is darker.
            coat_darkening: Varying::Constant(0.0),
            thin_film_weight: Varying::Constant(if film > 0.0 { 1.0 } else { 0.0 }),
            // From nanometres.
            thin_film_thickness: Varying::Constant(within(film / 1000.0, 0.0, 6.5)),
            thin_film_ior: self.index(shader, "thin_film_IOR", 1.5),
            emission_luminance: self.brightness(shader, "emission"),
            emission_color: self.light_of(shader, "emission_color", has),
            geometry_opacity: self.presence(shader, "opacity", has),
            geometry_thin_walled: self.number(shader, "thin_walled", 0.0) != 0.0,
            ..OpenPbr::default()
        }
    }

    fn open_pbr(&mut self, shader: usize, has: &Has) -> OpenPbr {
        let metres = self.unit;
        let number = |t: &Self, name: &str, otherwise: f64, most: f64| {
            Varying::Constant(within(t.number(shader, name, otherwise), 0.0, most))
        };
        let radius = self.number(shader, "subsurface_radius", 1.0) * metres;
        OpenPbr {
            base_weight: self.amount(shader, "base_weight", 1.0, has),
            base_color: self.share_of(shader, "base_color", 0.8, has),
            base_diffuse_roughness: self.amount(shader, "base_diffuse_roughness", 0.0, has),
            base_metalness: self.amount(shader, "base_metalness", 0.0, has),
            specular_weight: self.amount(shader, "specular_weight", 1.0, has),
            specular_color: self.share_of(shader, "specular_color", 1.0, has),
            specular_roughness: self.amount(shader, "specular_roughness", 0.3, has),
            specular_roughness_anisotropy: self.amount(shader, "specular_roughness_anisotropy", 0.0, has),
            specular_ior: self.index(shader, "specular_ior", 1.5),
            transmission_weight: self.amount(shader, "transmission_weight", 0.0, has),
            transmission_color: self.share_of(shader, "transmission_color", 1.0, has),
            transmission_depth: self.length(shader, "transmission_depth"),
            transmission_dispersion_scale: self.amount(shader, "transmission_dispersion_scale", 0.0, has),
            transmission_dispersion_abbe_number: Varying::Constant(within(
                self.number(shader, "transmission_dispersion_abbe_number", 20.0),
                6.2,
                1e6,
            )),
            subsurface_weight: self.amount(shader, "subsurface_weight", 0.0, has),
            subsurface_color: self.share_of(shader, "subsurface_color", 0.8, has),
            subsurface_radius: Varying::Constant(within(radius, 0.0, 1e30)),
            subsurface_scatter_anisotropy: Varying::Constant(within(
                self.number(shader, "subsurface_scatter_anisotropy", 0.0),
                -1.0,
                1.0,
            )),
            fuzz_weight: self.amount(shader, "fuzz_weight", 0.0, has),
            fuzz_color: self.share_of(shader, "fuzz_color", 1.0, has),
            fuzz_roughness: self.amount(shader, "fuzz_roughness", 0.5, has),
            coat_weight: self.amount(shader, "coat_weight", 0.0, has),
            coat_color: self.share_of(shader, "coat_color", 1.0, has),
            coat_roughness: self.amount(shader, "coat_roughness", 0.0, has),
            coat_roughness_anisotropy: self.amount(shader, "coat_roughness_anisotropy", 0.0, has),
            coat_ior: self.index(shader, "coat_ior", 1.6),
            coat_darkening: self.amount(shader, "coat_darkening", 1.0, has),
            thin_film_weight: self.amount(shader, "thin_film_weight", 0.0, has),
            thin_film_thickness: number(self, "thin_film_thickness", 0.5, 6.5),
            thin_film_ior: self.index(shader, "thin_film_ior", 1.4),
            emission_luminance: self.brightness(shader, "emission_luminance"),
            emission_color: self.light_of(shader, "emission_color", has),
            geometry_opacity: self.presence(shader, "geometry_opacity", has),
            geometry_thin_walled: self.number(shader, "geometry_thin_walled", 0.0) != 0.0,
            ..OpenPbr::default()
        }
    }

    /// A colour of which each channel is a share.
    fn share_of(&mut self, shader: usize, name: &str, otherwise: f64, has: &Has) -> Varying<Spectrum> {
        limited(self.colour(shader, name, [otherwise; 3], has))
    }

    fn light_of(&mut self, shader: usize, name: &str, has: &Has) -> Varying<Spectrum> {
        positive(self.colour(shader, name, [1.0; 3], has))
    }

    fn index(&mut self, shader: usize, name: &str, otherwise: f64) -> Varying<f64> {
        Varying::Constant(within(self.number(shader, name, otherwise), 0.1, 5.0))
    }

    /// A length, from the stage's units.
    fn length(&mut self, shader: usize, name: &str) -> Varying<f64> {
        Varying::Constant(within(self.number(shader, name, 0.0) * self.unit, 0.0, 1e30))
    }

    fn brightness(&mut self, shader: usize, name: &str) -> Varying<f64> {
        Varying::Constant(within(self.number(shader, name, 0.0), 0.0, 1e30))
    }

    /// What part of a surface is there: a number, or the mean of a colour.
    fn presence(&mut self, shader: usize, name: &str, has: &Has) -> Varying<f64> {
        match self.input(shader, name, has) {
            Some(Input::Texture(read)) => read.number(),
            Some(Input::Value(value)) => {
                let mean = three(&value).map(|[r, g, b]| (r + g + b) / 3.0).or_else(|| one(&value));
                Varying::Constant(within(mean.unwrap_or(1.0), 0.0, 1.0))
            }
            None => Varying::Constant(1.0),
        }
    }

    /// What a node gives that isn't a picture: a constant, or another node's, perhaps multiplied. `None` of nodes that aren't read.
    pub fn computed(&mut self, shader: usize, node: &str, has: &Has) -> Option<Input> {
        match node {
            "constant" => self.input(shader, "value", has),
            "extract" | "swizzle" => {
                let named = self.word_of(shader, "channels").and_then(|word| word.chars().next());
                let i = match named {
                    Some('g' | 'y') => 1,
                    Some('b' | 'z') => 2,
                    Some('a' | 'w') => 3,
                    Some(_) => 0,
                    None => within(self.number(shader, "index", 0.0), 0.0, 3.0) as usize,
                };
                let mut found = self.input(shader, "in", has);
                if let Some(Input::Texture(read)) = &mut found {
                    read.take(i);
                }
                found
            }
            "convert" | "dot" | "normalmap" => self.input(shader, "in", has),
            "multiply" => {
                let (a, b) = (self.input(shader, "in1", has)?, self.input(shader, "in2", has)?);
                Some(match (a, b) {
                    (Input::Texture(mut read), Input::Value(v))
                    | (Input::Value(v), Input::Texture(mut read)) => {
                        let factor = three(&v).or_else(|| one(&v).map(|v| [v; 3]))?;
                        read.scale_by(factor);
                        Input::Texture(read)
                    }
                    (Input::Value(a), Input::Value(b)) => {
                        let wide = |v| three(v).or_else(|| one(v).map(|v| [v; 3]));
                        let (a, b) = (wide(&a)?, wide(&b)?);
                        let product = a.iter().zip(b).map(|(a, b)| a * b).collect();
                        Input::Value(Value::numbers(3, product, layer::Kind::Real))
                    }
                    (Input::Texture(a), Input::Texture(_)) => {
                        self.warn(shader, "of two pictures that are multiplied the first counts");
                        Input::Texture(a)
                    }
                })
            }
            _ => None,
        }
    }

    /// A colour of vertices, by the name of what they have.
    pub fn geometry(&mut self, shader: usize, has: &Has) -> Option<Read> {
        let name = self.word_of(shader, "geomprop").or_else(|| self.word_of(shader, "varname"));
        match name.as_deref() {
            Some("displayColor") | None if has.colour => Some(Read::vertices("color")),
            Some("displayOpacity") if has.opacity => Some(Read::vertices("displayOpacity")),
            name => {
                let name = straal_scene::suggest::brief(name.unwrap_or("displayColor")).into_owned();
                self.warn(shader, &format!("the mesh has no primvar `{name}` that is read"));
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_with_and_without_versions() {
        assert_eq!(Kind::of("ND_standard_surface_surfaceshader_100"), Some(Kind::Standard));
        assert_eq!(Kind::of("ND_open_pbr_surface_surfaceshader"), Some(Kind::OpenPbr));
        assert_eq!(Kind::of("ND_UsdPreviewSurface_surfaceshader"), None);
        assert_eq!(node("ND_image_color3"), Some("image"));
        assert_eq!(node("ND_tiledimage_float"), Some("tiledimage"));
        assert_eq!(node("ND_normalmap"), Some("normalmap"));
        assert_eq!(node("ND_imagine_float"), None);
    }
}
