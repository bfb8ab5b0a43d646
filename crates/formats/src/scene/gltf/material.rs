//! Materials: metallic and rough, with all ratified extensions, as straal's own material of that name.

use straal_scene::desc::{
    AttributeName, AttributePer, AttributeTexture, CoatMap, CoatNormal, Diffuse, Gltf, GreenAxis,
    ImageTexture, Mask, Material, MaterialRef, NormalMap, NormalSpace, Relief, RemapTexture, ScaleTexture,
    Spectrum, Texture, TextureChannel, TextureOf, TextureSpace, TwoFaces, Varying,
};
use straal_scene::value::{LinearRgb, Link};

use super::document::{Fault, Result, flag, number_or, text, vector_or};
use super::geometry::SETS;
use super::json::{Json, Value};
use super::textures::{Map, set_of};
use super::{Translation, Within};

/// What a mesh has that materials are read off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Has {
    /// Which sets of texture coordinates.
    pub sets: [bool; SETS],
    /// Which of them is the mesh's own.
    pub primary: usize,
    /// Numbers of its vertices' colours: 0, 3 or 4.
    pub colours: usize,
    /// Whether these are in a picture of the mesh.
    pub painted: bool,
    /// Whether backs of its triangles can be seen that aren't to be.
    pub shows_backs: bool,
}

/// What a mesh is shown with.
#[derive(Clone, Default)]
pub(super) struct Look {
    /// The name of its material.
    pub material: String,
    /// What it shines by itself, where its material doesn't say so.
    pub emission: Option<Varying<Spectrum>>,
    /// Whether it shines on both sides.
    pub both_sides: bool,
}

const BLACK: [f64; 3] = [0.0; 3];
const WHITE: [f64; 3] = [1.0; 3];

impl<'a> Translation<'a, '_> {
    /// The look of a mesh that has that material, or none.
    pub fn look(&mut self, at: Option<&'a Json>, has: Has) -> Result<Look> {
        let (i, said) = match at {
            Some(at) => {
                let (i, said) = self.document.item("materials", at)?;
                (Some(i), said)
            }
            None => (None, &NOTHING),
        };
        if let Some(known) = self.looks.get(&(i, has)) {
            return Ok(known.clone());
        }
        let (material, emission, both_sides) = self.material(said, has)?;
        let called = said.get("name").map_or(Ok(""), text)?;
        let called = match (i, called) {
            (None, _) => "default".to_owned(),
            (Some(i), "") => format!("material {i}"),
            (_, name) => name.to_owned(),
        };
        let name = self.free_name(&called);
        self.scene.materials.insert(name.clone().into(), material);
        let look = Look { material: name, emission, both_sides };
        self.looks.insert((i, has), look.clone());
        Ok(look)
    }

    /// The set of texture coordinates by which what a material shines is read: a mesh must have it for its own.
    pub fn shining_set(&self, at: Option<&'a Json>) -> Result<usize> {
        let Some(at) = at else { return Ok(0) };
        let (_, said) = self.document.item("materials", at)?;
        let info = if said.extension("KHR_materials_unlit").is_some() {
            said.get("pbrMetallicRoughness").and_then(|pbr| pbr.get("baseColorTexture"))
        } else if vector_or(said, "emissiveFactor", BLACK)? != BLACK {
            said.get("emissiveTexture")
        } else {
            None
        };
        Ok(info.map_or(Ok(0), set_of)?.min(SETS - 1))
    }

    /// The set of texture coordinates along which a material tells directions of its surface, if it tells any: normals, or the way that it is brushed.
    pub fn direction_set(&self, at: Option<&'a Json>) -> Result<Option<usize>> {
        let Some(at) = at else { return Ok(None) };
        let (_, said) = self.document.item("materials", at)?;
        let coat = said.extension("KHR_materials_clearcoat").and_then(|c| c.get("clearcoatNormalTexture"));
        let brushed = said.extension("KHR_materials_anisotropy");
        let info = said.get("normalTexture").or(coat).or(brushed.and_then(|b| b.get("anisotropyTexture")));
        match info {
            Some(info) => Ok(Some(set_of(info)?.min(SETS - 1))),
            None => Ok(brushed.map(|_| 0)),
        }
    }

    /// Whether the backs of what has that material are seen.
    pub fn is_double_sided(&self, at: Option<&'a Json>) -> Result<bool> {
        at.map_or(Ok(false), |at| flag(self.document.item("materials", at)?.1, "doubleSided"))
    }

    /// A name that no material has: the one that is wanted, or one with a number.
    fn free_name(&self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut count = 1;
        while self.scene.materials.get(&name).is_some() {
            count += 1;
            name = format!("{wanted} ({count})");
        }
        name
    }

    /// A material, what it shines besides, and whether on both sides.
    fn material(&mut self, said: &'a Json, has: Has) -> Result<(Material, Option<Varying<Spectrum>>, bool)> {
        let base = Base::of(self, said, has)?;
        if said.extension("KHR_materials_unlit").is_some() {
            if has.colours == 0 || has.painted {
                let black =
                    Diffuse { reflectance: Varying::Constant(Spectrum::grey(0.0)), ..Diffuse::default() };
                return Ok((masked(Material::Diffuse(black), base.alpha), Some(base.colour), true));
            }
            self.warn(said, "vertices have colours besides a picture, by which nothing can shine: what should be unlit is lit");
        }
        // Backs that aren't to be seen are holes, where any can be seen.
        let mut material = Gltf { base_color: base.colour, double_sided: true, ..Gltf::default() };
        match &base.gloss {
            None => self.metal_and_roughness(&mut material, said, has)?,
            Some(gloss) => self.specular_and_gloss(&mut material, gloss, has)?,
        }
        let emissive_factor = vector_or(said, "emissiveFactor", BLACK)?.map(share);
        let map = self.map(said, "emissiveTexture", has)?;
        let (mut shines, mut strength) = (false, 1.0);
        if emissive_factor != BLACK {
            material.emissive = colour(map.as_ref(), emissive_factor);
            if let Some(more) = said.extension("KHR_materials_emissive_strength") {
                strength = positive(number_or(more, "emissiveStrength", 1.0)?);
            }
            material.emissive_strength = strength.into();
            shines = strength > 0.0;
        }
        material.relief.normal_map = self.normal_map(said, "normalTexture", has)?;
        self.layers(&mut material, said, has)?;
        self.inside(&mut material, said, has)?;
        if shines && base.alpha != Varying::Constant(1.0) {
            // What shines may have holes as a whole only.
            let none = Varying::Constant(Spectrum::grey(0.0));
            let emissive = std::mem::replace(&mut material.emissive, none);
            material.emissive_strength = 1.0.into();
            let emission = match emissive {
                emissive if strength == 1.0 => emissive,
                Varying::Constant(_) => {
                    Varying::Constant(Spectrum::Rgb(LinearRgb(emissive_factor.map(|v| v * strength))))
                }
                texture => scaled(texture, strength.into(), Varying::Constant(Spectrum::grey(1.0))),
            };
            return Ok((masked(Material::Gltf(material), base.alpha), Some(emission), false));
        }
        material.alpha = base.alpha;
        let has_inside = material.volume && material.transmission != Varying::Constant(0.0);
        if has.shows_backs && !shines && !has_inside {
            let none = Material::Diffuse(Diffuse::default());
            let [front, back] = [Material::Gltf(material), masked(none, Varying::Constant(0.0))]
                .map(|part| Box::new(MaterialRef::Inline(Box::new(part))));
            return Ok((
                Material::TwoFaces(TwoFaces { front, back, relief: Relief::default() }),
                None,
                false,
            ));
        }
        Ok((Material::Gltf(material), None, false))
    }

    fn metal_and_roughness(&mut self, material: &mut Gltf, said: &'a Json, has: Has) -> Result<()> {
        let pbr = said.get("pbrMetallicRoughness").unwrap_or(&NOTHING);
        let map = self.map(pbr, "metallicRoughnessTexture", has)?;
        let number = |channel, key| Ok(amount(map.as_ref(), channel, share(number_or(pbr, key, 1.0)?)));
        material.metallic = number(TextureChannel::Blue, "metallicFactor")?;
        material.roughness = number(TextureChannel::Green, "roughnessFactor")?;
        Ok(())
    }

    /// `KHR_materials_pbrSpecularGlossiness`, which is no longer recommended: no metal, but a coloured surface of an index so high that
    /// it can reflect as much as metal does.
    fn specular_and_gloss(&mut self, material: &mut Gltf, gloss: &'a Json, has: Has) -> Result<()> {
        /// What an index of 5 reflects straight on.
        const MOST: f64 = 4.0 / 9.0;
        let map = self.map(gloss, "specularGlossinessTexture", has)?;
        let factor = share(number_or(gloss, "glossinessFactor", 1.0)?);
        material.metallic = Varying::Constant(0.0);
        material.ior = 5.0.into();
        let specular = vector_or(gloss, "specularFactor", WHITE)?.map(share);
        material.specular_color = colour(map.as_ref(), specular.map(|v| v / MOST));
        material.roughness = match &map {
            Some(map) => range(map.number(TextureChannel::Alpha), [0.0, 1.0], [1.0, 1.0 - factor]),
            None => Varying::Constant(1.0 - factor),
        };
        Ok(())
    }

    /// A map of normals under some name.
    fn normal_map(&mut self, said: &'a Json, key: &'static str, has: Has) -> Result<Option<NormalMap>> {
        let map = self.map(said, key, has)?;
        let strength = said.get(key).map_or(Ok(1.0), |info| number_or(info, "scale", 1.0))?;
        Ok(map.map(|map| NormalMap {
            texture: TextureOf::Inline(Texture::Image(map.number(TextureChannel::Luminance))),
            space: NormalSpace::Tangent,
            green: GreenAxis::Up,
            strength: strength.within(-100.0, 100.0),
        }))
    }

    /// What lies on the base: specular, clearcoat, sheen, iridescence, anisotropy.
    fn layers(&mut self, material: &mut Gltf, said: &'a Json, has: Has) -> Result<()> {
        if let Some(more) = said.extension("KHR_materials_ior") {
            let ior = number_or(more, "ior", 1.5)?;
            // 0 stands for endless: a surface that reflects all.
            material.ior = if ior == 0.0 { 5.0 } else { ior.within(1.0, 5.0) }.into();
        }
        if let Some(more) = said.extension("KHR_materials_specular") {
            let strength = self.map(more, "specularTexture", has)?;
            let tint = self.map(more, "specularColorTexture", has)?;
            let factor = share(number_or(more, "specularFactor", 1.0)?);
            material.specular = amount(strength.as_ref(), TextureChannel::Alpha, factor);
            let factor = vector_or(more, "specularColorFactor", WHITE)?.map(|v| v.within(0.0, 3.9));
            material.specular_color = colour(tint.as_ref(), factor);
        }
        if let Some(more) = said.extension("KHR_materials_clearcoat") {
            let map = self.map(more, "clearcoatTexture", has)?;
            let factor = share(number_or(more, "clearcoatFactor", 0.0)?);
            material.clearcoat = amount(map.as_ref(), TextureChannel::Red, factor);
            let map = self.map(more, "clearcoatRoughnessTexture", has)?;
            let rough = share(number_or(more, "clearcoatRoughnessFactor", 0.0)?);
            material.clearcoat_roughness = amount(map.as_ref(), TextureChannel::Green, rough);
            material.clearcoat_normal = match self.normal_map(more, "clearcoatNormalTexture", has)? {
                _ if factor == 0.0 => CoatNormal::Base,
                // As the base, whose map is the same.
                Some(map) if material.relief.normal_map.as_ref() == Some(&map) => CoatNormal::Base,
                Some(NormalMap { texture, green, strength, .. }) => {
                    CoatNormal::Map(CoatMap { texture, green, strength })
                }
                None if material.relief.normal_map.is_some() => CoatNormal::Surface,
                None => CoatNormal::Base,
            };
        }
        if let Some(more) = said.extension("KHR_materials_sheen") {
            let map = self.map(more, "sheenColorTexture", has)?;
            let factor = vector_or(more, "sheenColorFactor", BLACK)?.map(share);
            if factor != BLACK {
                material.sheen_color = colour(map.as_ref(), factor);
            }
            let map = self.map(more, "sheenRoughnessTexture", has)?;
            let rough = share(number_or(more, "sheenRoughnessFactor", 0.0)?);
            material.sheen_roughness = amount(map.as_ref(), TextureChannel::Alpha, rough);
        }
        if let Some(more) = said.extension("KHR_materials_iridescence") {
            let map = self.map(more, "iridescenceTexture", has)?;
            let factor = share(number_or(more, "iridescenceFactor", 0.0)?);
            material.iridescence = amount(map.as_ref(), TextureChannel::Red, factor);
            material.iridescence_ior = number_or(more, "iridescenceIor", 1.3)?.within(1.0, 5.0).into();
            let nm = |v: f64| v.within(0.0, 6500.0);
            let least = nm(number_or(more, "iridescenceThicknessMinimum", 100.0)?);
            let most = nm(number_or(more, "iridescenceThicknessMaximum", 400.0)?);
            material.iridescence_thickness = match self.map(more, "iridescenceThicknessTexture", has)? {
                Some(map) => range(map.number(TextureChannel::Green), [0.0, 1.0], [least, most]),
                None => Varying::Constant(most),
            };
        }
        if let Some(more) = said.extension("KHR_materials_anisotropy") {
            let map = self.map(more, "anisotropyTexture", has)?;
            let factor = share(number_or(more, "anisotropyStrength", 0.0)?);
            material.anisotropy = amount(map.as_ref(), TextureChannel::Blue, factor);
            if factor > 0.0 {
                material.anisotropy_rotation =
                    number_or(more, "anisotropyRotation", 0.0)?.to_degrees().into();
                material.anisotropy_direction =
                    map.map(|map| TextureOf::Inline(Texture::Image(map.number(TextureChannel::Luminance))));
            }
        }
        Ok(())
    }

    /// What light does that isn't sent back: transmission, volume, dispersion.
    fn inside(&mut self, material: &mut Gltf, said: &'a Json, has: Has) -> Result<()> {
        let mut is_clear = false;
        if let Some(more) = said.extension("KHR_materials_transmission") {
            let map = self.map(more, "transmissionTexture", has)?;
            let factor = share(number_or(more, "transmissionFactor", 0.0)?);
            is_clear = factor > 0.0;
            material.transmission = amount(map.as_ref(), TextureChannel::Red, factor);
        }
        if let Some(more) = said.extension("KHR_materials_diffuse_transmission") {
            let factor = share(number_or(more, "diffuseTransmissionFactor", 0.0)?);
            let map = self.map(more, "diffuseTransmissionTexture", has)?;
            material.diffuse_transmission = amount(map.as_ref(), TextureChannel::Alpha, factor);
            let map = self.map(more, "diffuseTransmissionColorTexture", has)?;
            let factor = vector_or(more, "diffuseTransmissionColorFactor", WHITE)?.map(share);
            material.diffuse_transmission_color = colour(map.as_ref(), factor);
        }
        if let Some(more) = said.extension("KHR_materials_volume").filter(|_| is_clear) {
            // How thick it is the path finds out; that there is an inside is what counts.
            material.volume = number_or(more, "thicknessFactor", 0.0)? > 0.0;
            material.attenuation_color =
                Spectrum::Rgb(LinearRgb(vector_or(more, "attenuationColor", WHITE)?.map(share)));
            if let Some(distance) = more.get("attenuationDistance") {
                let distance = super::document::number(distance)?;
                if distance <= 0.0 {
                    return Err(Fault::of(more, "`attenuationDistance` must be above 0"));
                }
                material.attenuation_distance = Some(distance);
            }
        }
        if let Some(more) = said.extension("KHR_materials_dispersion").filter(|_| is_clear) {
            material.dispersion = number_or(more, "dispersion", 0.0)?.within(0.0, 3.2).into();
        }
        Ok(())
    }
}

/// What all materials have: a colour, and how much of it is there.
struct Base<'a> {
    colour: Varying<Spectrum>,
    alpha: Varying<f64>,
    /// What is said of specular and gloss in place of metal and roughness.
    gloss: Option<&'a Json>,
}

impl<'a> Base<'a> {
    fn of(t: &mut Translation<'a, '_>, said: &'a Json, has: Has) -> Result<Self> {
        let gloss = said.extension("KHR_materials_pbrSpecularGlossiness");
        let (of, factor, texture) = match gloss {
            Some(gloss) => (gloss, "diffuseFactor", "diffuseTexture"),
            None => {
                let pbr = said.get("pbrMetallicRoughness").unwrap_or(&NOTHING);
                (pbr, "baseColorFactor", "baseColorTexture")
            }
        };
        let [r, g, b, a] = vector_or(of, factor, [1.0; 4])?.map(share);
        let map = t.map(of, texture, has)?;
        let painted = (has.colours > 0 && !has.painted).then(|| vertices(TextureChannel::Luminance));
        let colour = match painted {
            None => colour(map.as_ref(), [r, g, b]),
            // The vertices' colours times the rest.
            Some(painted) => scaled(colour(map.as_ref(), [r, g, b]), 1.0.into(), of_texture(painted)),
        };
        let mode = said.get("alphaMode").map_or(Ok("OPAQUE"), text)?;
        let alpha = match mode {
            "OPAQUE" => Varying::Constant(1.0),
            "MASK" | "BLEND" => {
                let map = map.as_ref().filter(|map| map.has_alpha);
                let mut alpha = amount(map, TextureChannel::Alpha, a);
                if has.colours == 4 {
                    let painted = vertices(TextureChannel::Alpha);
                    alpha = of_texture(Texture::Scale(ScaleTexture {
                        of: of_texture(painted),
                        by: alpha,
                        ..ScaleTexture::default()
                    }));
                }
                if mode == "MASK" { cut(alpha, number_or(said, "alphaCutoff", 0.5)?) } else { alpha }
            }
            _ => {
                let at = said.get("alphaMode").unwrap_or(said);
                return Err(Fault::of(at, "the mode is `OPAQUE`, `MASK` or `BLEND`"));
            }
        };
        Ok(Self { colour, alpha, gloss })
    }
}

/// What stands where nothing is said.
static NOTHING: Json = Json { value: Value::Object(Vec::new()), start: 0, end: 0 };

/// A material that is there for a share of the light only.
fn masked(material: Material, opacity: Varying<f64>) -> Material {
    if opacity == Varying::Constant(1.0) {
        return material;
    }
    let material = Box::new(MaterialRef::Inline(Box::new(material)));
    Material::Mask(Mask { material, opacity, relief: Relief::default() })
}

fn share(v: f64) -> f64 {
    v.within(0.0, 1.0)
}

fn positive(v: f64) -> f64 {
    v.within(0.0, f64::from(f32::MAX))
}

fn of_texture<T>(texture: Texture) -> Varying<T> {
    Varying::Texture(Box::new(TextureOf::Inline(texture)))
}

/// The colours of vertices, which are light.
fn vertices(channel: TextureChannel) -> Texture {
    Texture::Attribute(AttributeTexture {
        name: AttributeName("color".to_owned().into()),
        per: AttributePer::Vertex,
        color_space: TextureSpace::Linear,
        channel,
        absent: Spectrum::grey(1.0),
    })
}

pub(super) fn scaled(of: Varying<Spectrum>, by: Varying<f64>, tint: Varying<Spectrum>) -> Varying<Spectrum> {
    of_texture(Texture::Scale(ScaleTexture { of, by, tint }))
}

/// A colour, times what a texture has.
fn colour(map: Option<&Map>, factor: [f64; 3]) -> Varying<Spectrum> {
    let constant = Varying::Constant(Spectrum::Rgb(LinearRgb(factor)));
    match map.map(|map| of_texture(Texture::Image(map.colour()))) {
        None => constant,
        Some(texture) if factor == WHITE => texture,
        Some(texture) => scaled(constant, 1.0.into(), texture),
    }
}

/// A number, times what a texture has in a channel.
fn amount(map: Option<&Map>, channel: TextureChannel, factor: f64) -> Varying<f64> {
    let Some(map) = map.filter(|_| factor > 0.0) else { return Varying::Constant(factor) };
    let texture = Texture::Image(map.number(channel));
    if factor == 1.0 {
        return of_texture(texture);
    }
    of_texture(Texture::Scale(ScaleTexture {
        of: of_texture(texture),
        by: factor.into(),
        ..ScaleTexture::default()
    }))
}

/// A number of a texture, from one range to another.
fn range(texture: ImageTexture, from: [f64; 2], to: [f64; 2]) -> Varying<f64> {
    of_texture(Texture::Remap(RemapTexture {
        of: of_texture(Texture::Image(texture)),
        from,
        to,
        ..RemapTexture::default()
    }))
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

/// The material of a look, as nodes name it.
pub(super) fn named(look: &Look) -> MaterialRef {
    MaterialRef::Named(Link::new(look.material.clone()))
}
