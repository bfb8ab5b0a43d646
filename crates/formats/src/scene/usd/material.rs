//! Materials: `UsdPreviewSurface` as straal's `gltf`, and colours that meshes have without one.

use straal_scene::desc::{
    AttributeName, AttributePer, AttributeTexture, Diffuse, Gltf, GreenAxis, Mask, Material, MaterialRef,
    NormalMap, NormalSpace, Relief, RemapTexture, ScaleTexture, Spectrum, Texture, TextureChannel, TextureOf,
    TextureSpace, Varying,
};
use straal_scene::value::LinearRgb;

use super::layer::Value;
use super::texture::Read;
use super::{Translation, mtlx, within};

/// What a mesh has that materials are read off.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Has {
    /// The name of its own texture coordinates.
    pub own: Option<String>,
    /// Names of others.
    pub others: Vec<String>,
    /// Whether vertices have colours.
    pub colour: bool,
    /// Whether vertices have opacities.
    pub opacity: bool,
}

/// What a surface is shown with.
#[derive(Clone, Debug)]
pub(super) struct Look {
    /// The name of its material.
    pub material: String,
}

/// Nodes of MaterialX within one another.
const MOST_NODES: usize = 16;

/// Nodes that are read in all: each of two others, they could be asked for endlessly.
const MOST_COMPUTED: usize = 200_000;

/// The colour of what has none (`UsdPreviewSurface`).
const GREY: [f64; 3] = [0.18; 3];

/// What an input of a shader says.
pub(super) enum Input {
    Value(Value),
    Texture(Box<Read>),
}

impl Translation<'_, '_> {
    /// The look of a prim that has that material, or none.
    pub fn look(&mut self, prim: usize, material: Option<usize>, has: &Has) -> Look {
        let shader = material.and_then(|material| self.surface_shader(material));
        if shader.is_none() {
            if let Some(material) = material {
                self.warn(
                    material,
                    "it has no surface that is read: what has it is shown in its display colour",
                );
            }
            return self.display(prim, has);
        }
        let key = (material, has.clone());
        if let Some(known) = self.looks.get(&key) {
            return known.clone();
        }
        let made = match shader {
            Some((shader, Some(kind))) => self.layered(shader, kind, has),
            Some((shader, None)) => self.preview(shader, has),
            None => Material::Diffuse(Diffuse::default()),
        };
        let wanted = material.map_or(String::new(), |material| self.stage.prims[material].name.clone());
        let look = Look { material: self.add(&wanted, made) };
        self.looks.insert(key, look.clone());
        look
    }

    /// Adds a material, under a name that no other has.
    fn add(&mut self, wanted: &str, material: Material) -> String {
        // Meshes that have other primvars may be shown alike.
        if self.scene.materials.get(wanted) == Some(&material) {
            return wanted.to_owned();
        }
        let name = self.names.free(wanted, |name| self.scene.materials.get(name).is_some());
        self.scene.materials.insert(name.clone().into(), material);
        name
    }

    /// The look of what has no material: diffuse, in its own display colour or that of a prim that it is in.
    fn display(&mut self, prim: usize, has: &Has) -> Look {
        let own = |name: &str, t: &Self| {
            let mut above = Some(prim);
            std::iter::from_fn(|| {
                let here = above?;
                above = t.stage.prims[here].parent;
                Some(here)
            })
            .find(|&here| {
                here == prim && t.stage.has(here, name)
                    || matches!(t.stage.interpolation(here, name), None | Some("constant"))
                        && t.stage.has(here, name)
            })
        };
        let colour = own("primvars:displayColor", self).and_then(|from| {
            let values = self.stage.numbers(from, "primvars:displayColor", 3)?;
            values.first_chunk::<3>().copied()
        });
        let opacity = own("primvars:displayOpacity", self)
            .and_then(|from| self.stage.numbers(from, "primvars:displayOpacity", 1)?.first().copied());
        let reflectance = if has.colour {
            of_texture(vertices("color", TextureChannel::Luminance))
        } else {
            rgb(colour.unwrap_or(GREY).map(share))
        };
        let opacity = if has.opacity {
            of_texture(vertices("displayOpacity", TextureChannel::Luminance))
        } else {
            Varying::Constant(share(opacity.unwrap_or(1.0)))
        };
        let rgb = reflectance.constant().and_then(Spectrum::rgb).map_or([0.0; 3], |LinearRgb(v)| v);
        let bits = rgb.into_iter().chain(opacity.constant().copied()).map(f64::to_bits).collect();
        let key = (bits, has.colour, has.opacity);
        if let Some(known) = self.displays.get(&key) {
            return known.clone();
        }
        let material = masked(Material::Diffuse(Diffuse { reflectance, ..Diffuse::default() }), opacity);
        let look = Look { material: self.add("display", material) };
        self.displays.insert(key, look.clone());
        look
    }

    /// The shader of a material's surface, if it is one that is read, and which of MaterialX it is.
    fn surface_shader(&mut self, material: usize) -> Option<(usize, Option<mtlx::Kind>)> {
        let mut unknown = None;
        // MaterialX says more than what others are shown by.
        for name in ["outputs:mtlx:surface", "outputs:surface"] {
            let Some((shader, _)) = self.source(material, name) else { continue };
            let id = self.stage.text(shader, "info:id").unwrap_or_default();
            if matches!(id.as_str(), "UsdPreviewSurface" | "ND_UsdPreviewSurface_surfaceshader") {
                return Some((shader, None));
            }
            if let Some(kind) = mtlx::Kind::of(&id) {
                return Some((shader, Some(kind)));
            }
            unknown = Some((shader, id));
        }
        let (shader, id) = unknown?;
        let id = if id.is_empty() { "one of its own".to_owned() } else { id };
        self.warn(shader, &format!("the shader `{}` isn't read", straal_scene::suggest::brief(&id)));
        None
    }

    /// The shader that an input or output leads to, and its output: through graphs and what materials pass on.
    pub fn source(&self, prim: usize, property: &str) -> Option<(usize, String)> {
        /// Graphs within graphs, at most.
        const MOST: usize = 16;
        let (mut prim, mut property) = (prim, property.to_owned());
        for _ in 0..MOST {
            let target = self.stage.targets(prim, &property).into_iter().next()?;
            let (path, name) = target.rsplit_once('.')?;
            let found = *self.stage.places.get(path)?;
            if let Some(output) = name.strip_prefix("outputs:")
                && self.stage.has(found, "info:id")
            {
                return Some((found, output.to_owned()));
            }
            (prim, property) = (found, name.to_owned());
        }
        None
    }

    /// The prim and property that say an input's value, where no shader does.
    pub fn said(&self, prim: usize, name: &str) -> (usize, String) {
        let (mut prim, mut property) = (prim, format!("inputs:{name}"));
        for _ in 0..16 {
            let Some(target) = self.stage.targets(prim, &property).into_iter().next() else { break };
            let Some((path, name)) = target.rsplit_once('.') else { break };
            let Some(&found) = self.stage.places.get(path) else { break };
            (prim, property) = (found, name.to_owned());
        }
        (prim, property)
    }

    /// What an input says.
    pub fn input(&mut self, shader: usize, name: &str, has: &Has) -> Option<Input> {
        let property = format!("inputs:{name}");
        if let Some((source, output)) = self.source(shader, &property) {
            let id = self.stage.text(source, "info:id").unwrap_or_default();
            if let Some(node) = mtlx::node(&id)
                && !matches!(
                    node,
                    "image" | "tiledimage" | "geompropvalue" | "geomcolor" | "UsdPrimvarReader"
                )
            {
                // Nodes that lead back to themselves.
                if self.nested > MOST_NODES || self.computed > MOST_COMPUTED {
                    return None;
                }
                (self.nested, self.computed) = (self.nested + 1, self.computed + 1);
                let found = self.computed(source, node, has);
                self.nested -= 1;
                return found;
            }
            return self.read(source, &output, has).map(|read| Input::Texture(Box::new(read)));
        }
        let (prim, property) = self.said(shader, name);
        self.stage.value(prim, &property).map(Input::Value)
    }

    pub fn colour(&mut self, shader: usize, name: &str, otherwise: [f64; 3], has: &Has) -> Varying<Spectrum> {
        match self.input(shader, name, has) {
            Some(Input::Texture(read)) => read.colour(),
            Some(Input::Value(value)) => rgb(three(&value).unwrap_or(otherwise)),
            None => rgb(otherwise),
        }
    }

    pub fn amount(&mut self, shader: usize, name: &str, otherwise: f64, has: &Has) -> Varying<f64> {
        match self.input(shader, name, has) {
            Some(Input::Texture(read)) => read.number(),
            Some(Input::Value(value)) => Varying::Constant(share(one(&value).unwrap_or(otherwise))),
            None => Varying::Constant(otherwise),
        }
    }

    pub fn number(&self, shader: usize, name: &str, otherwise: f64) -> f64 {
        let (prim, property) = self.said(shader, name);
        self.stage.number(prim, &property).unwrap_or(otherwise)
    }

    /// `UsdPreviewSurface`.
    fn preview(&mut self, shader: usize, has: &Has) -> Material {
        /// What an index of 5 reflects straight on.
        const MOST: f64 = 4.0 / 9.0;
        let base_color = limited(self.colour(shader, "diffuseColor", GREY, has));
        let mut made =
            Gltf { base_color, double_sided: true, metallic: Varying::Constant(0.0), ..Gltf::default() };
        made.roughness = self.amount(shader, "roughness", 0.5, has);
        let ior = self.number(shader, "ior", 1.5);
        // An index below 1 is that of what is inside of something denser: the surface reflects as much.
        let ior = if ior > 0.0 && ior < 1.0 { 1.0 / ior } else { ior };
        made.ior = within(ior, 1.0, 5.0).into();
        if self.number(shader, "useSpecularWorkflow", 0.0) != 0.0 {
            made.ior = 5.0.into();
            let specular = self.colour(shader, "specularColor", [0.0; 3], has);
            made.specular_color = match specular {
                Varying::Constant(Spectrum::Rgb(LinearRgb(v))) => rgb(v.map(|v| share(v) / MOST)),
                texture => of_texture(Texture::Scale(ScaleTexture {
                    of: texture,
                    by: (1.0 / MOST).into(),
                    ..ScaleTexture::default()
                })),
            };
        } else {
            made.metallic = self.amount(shader, "metallic", 0.0, has);
        }
        made.clearcoat = self.amount(shader, "clearcoat", 0.0, has);
        if made.clearcoat != Varying::Constant(0.0) {
            made.clearcoat_roughness = self.amount(shader, "clearcoatRoughness", 0.01, has);
        }
        let emissive = self.colour(shader, "emissiveColor", [0.0; 3], has);
        made.emissive = positive(emissive);
        made.relief = self.relief(shader, "normal", has);
        if let Some(Input::Texture(_)) = self.input(shader, "displacement", has) {
            self.warn(shader, "`displacement` is left out");
        }
        self.opacity(shader, has, made)
    }

    /// What of a surface is there, and what goes through.
    fn opacity(&mut self, shader: usize, has: &Has, mut made: Gltf) -> Material {
        let opacity = self.amount(shader, "opacity", 1.0, has);
        let threshold = self.number(shader, "opacityThreshold", 0.0);
        let (prim, property) = self.said(shader, "opacityMode");
        let is_presence = self.stage.text(prim, &property).as_deref() == Some("presence");
        let is_constant = opacity.constant().copied();
        if threshold > 0.0 {
            made.alpha = cut(opacity, threshold);
        } else if let (Some(v), false) = (is_constant, is_presence) {
            // It keeps its reflections where it is clear.
            made.transmission = Varying::Constant(1.0 - v);
        } else {
            made.alpha = opacity;
        }
        let shines = made.emissive != Varying::Constant(Spectrum::grey(0.0));
        if shines && made.alpha != Varying::Constant(1.0) {
            // What shines may have holes as a whole only.
            let alpha = std::mem::replace(&mut made.alpha, Varying::Constant(1.0));
            made.emissive = Varying::Constant(Spectrum::grey(0.0));
            self.warn(shader, "it doesn't shine, as it has holes");
            return masked(Material::Gltf(made), alpha);
        }
        Material::Gltf(made)
    }

    pub fn relief(&mut self, shader: usize, name: &str, has: &Has) -> Relief {
        let Some(Input::Texture(read)) = self.input(shader, name, has) else { return Relief::default() };
        let Some(texture) = read.plain() else {
            self.warn(shader, "a normal that comes of no picture is left out");
            return Relief::default();
        };
        let normal_map = Some(NormalMap {
            texture: TextureOf::Inline(texture),
            space: NormalSpace::Tangent,
            green: GreenAxis::Up,
            strength: 1.0,
        });
        Relief { normal_map, bump: None }
    }
}

/// All or nothing: whether an amount reaches a limit.
fn cut(alpha: Varying<f64>, limit: f64) -> Varying<f64> {
    /// As good as a step.
    const STEP: f64 = 1e-5;
    match alpha {
        Varying::Constant(v) => Varying::Constant(if v >= limit { 1.0 } else { 0.0 }),
        Varying::Texture(texture) => of_texture(Texture::Remap(RemapTexture {
            of: Varying::Texture(texture),
            from: [limit - STEP, limit],
            to: [0.0, 1.0],
            ..RemapTexture::default()
        })),
    }
}

/// A material that is there for a share of the light only.
fn masked(material: Material, opacity: Varying<f64>) -> Material {
    if opacity == Varying::Constant(1.0) {
        return material;
    }
    let material = Box::new(MaterialRef::Inline(Box::new(material)));
    Material::Mask(Mask { material, opacity, relief: Relief::default() })
}

/// What vertices have.
pub(super) fn vertices(name: &str, channel: TextureChannel) -> Texture {
    Texture::Attribute(AttributeTexture {
        name: AttributeName(name.to_owned().into()),
        per: AttributePer::Vertex,
        color_space: TextureSpace::Linear,
        channel,
        absent: Spectrum::grey(1.0),
    })
}

pub(super) fn of_texture<T>(texture: Texture) -> Varying<T> {
    Varying::Texture(Box::new(TextureOf::Inline(texture)))
}

pub(super) fn rgb(v: [f64; 3]) -> Varying<Spectrum> {
    Varying::Constant(Spectrum::Rgb(LinearRgb(v)))
}

fn share(v: f64) -> f64 {
    within(v, 0.0, 1.0)
}

/// A colour of which no more comes back than falls on it.
pub(super) fn limited(colour: Varying<Spectrum>) -> Varying<Spectrum> {
    match colour {
        Varying::Constant(Spectrum::Rgb(LinearRgb(v))) => rgb(v.map(share)),
        other => other,
    }
}

/// Light that isn't below 0.
pub(super) fn positive(colour: Varying<Spectrum>) -> Varying<Spectrum> {
    match colour {
        Varying::Constant(Spectrum::Rgb(LinearRgb(v))) => rgb(v.map(|v| within(v, 0.0, f64::from(f32::MAX)))),
        other => other,
    }
}

pub(super) fn one(value: &Value) -> Option<f64> {
    match value {
        Value::Numbers(v) => v.values.first().copied(),
        _ => None,
    }
}

pub(super) fn three(value: &Value) -> Option<[f64; 3]> {
    match value {
        Value::Numbers(v) => v.values.first_chunk::<3>().copied(),
        _ => None,
    }
}
