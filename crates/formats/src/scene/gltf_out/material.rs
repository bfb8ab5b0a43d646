//! The material `gltf`, with its extensions: each key of it that isn't as it is by itself.

use serde_json::{Map, Value as Json, json};
use straal_color::spectrum::Quantity;
use straal_scene::desc::{
    CoatNormal, Gltf, GreenAxis, Material, NormalSpace, Relief, Spectrum, Surface, Texture, TextureChannel,
    TextureOf, Varying,
};

use super::Out;
use super::likeness;
use super::textures::{Product, Slot};

/// A material that was written.
pub(super) struct Look {
    pub index: usize,
    /// Whether the colours of vertices are seen.
    pub is_painted: bool,
}

type Object = Map<String, Json>;

/// The alpha of a material.
enum Alpha {
    Opaque,
    /// All or nothing, from an amount on.
    Mask(Product, f64),
    Blend(Product),
}

impl Out<'_> {
    /// Writes the look of a surface that has that material, and shines by itself or as a part of a file says.
    pub fn look(
        &mut self,
        material: Option<&Material>,
        name: Option<&str>,
        surface: &Surface,
        part: Option<&Varying<Spectrum>>,
    ) -> Look {
        let unsaid = likeness::unsaid();
        let material = material.unwrap_or(&unsaid);
        let mut gltf = self.likeness(material, 0);
        let emission = surface.emission.as_ref().or(part);
        if let Some(emission) = emission {
            (gltf.emissive, gltf.emissive_strength) = (emission.clone(), 1.0.into());
        }
        if !gltf.double_sided && !matches!(material, Material::TwoFaces(_)) {
            self.tell("backs that are black aren't seen at all");
        }
        let mut out = Object::new();
        if let Some(name) = name {
            out.insert("name".to_owned(), json!(name));
        }
        let is_black = gltf.specular == Varying::Constant(0.0)
            && gltf.base_color == Varying::Constant(Spectrum::grey(0.0));
        let is_painted = if is_black && emission.is_some() && surface.two_sided_emission {
            self.unlit(&mut gltf, &mut out)
        } else {
            if emission.is_some() && surface.two_sided_emission {
                self.tell("whether backs glow is left to the program that reads the file");
            }
            self.lit(&gltf, &mut out)
        };
        if gltf.double_sided {
            out.insert("doubleSided".to_owned(), json!(true));
        }
        Look { index: self.materials.once(out.into()), is_painted }
    }

    /// What is black and shines on both sides: glTF has a colour that no light changes.
    fn unlit(&mut self, gltf: &mut Gltf, out: &mut Object) -> bool {
        let color = self.colour(&gltf.emissive, Quantity::Emission);
        if color.factor.iter().any(|v| *v > 1.0) {
            return self.lit(gltf, out);
        }
        gltf.base_color = std::mem::replace(&mut gltf.emissive, Varying::Constant(Spectrum::grey(0.0)));
        gltf.specular = Varying::Constant(1.0);
        self.extend(out, "KHR_materials_unlit", json!({}));
        self.lit(gltf, out)
    }

    /// All that the material says; whether the colours of vertices are seen.
    fn lit(&mut self, m: &Gltf, out: &mut Object) -> bool {
        if m.light_group.is_some() {
            self.tell("groups of lights are left out");
        }
        let is_painted = self.base(m, out);
        self.glow(m, out);
        self.relief(&m.relief, out);
        self.layers(m, out);
        self.inside(m, out);
        is_painted
    }

    /// Base colour, alpha, metallic and roughness.
    fn base(&mut self, m: &Gltf, out: &mut Object) -> bool {
        let mut pbr = Object::new();
        let base = self.colour(&m.base_color, Quantity::Reflectance);
        let alpha = self.alpha(&m.alpha);
        let (amount, slot) = match &alpha {
            Alpha::Opaque => (1.0, Slot::Any),
            Alpha::Mask(p, _) | Alpha::Blend(p) => {
                let has_alpha = |image: &straal_scene::desc::ImageTexture| {
                    self.assets.bitmap(image.file.handle).has_alpha
                };
                let slot = match (&p.image, &base.image) {
                    (Some(image), _) => Slot::Of(image.clone()),
                    (None, Some(image)) if has_alpha(image) => Slot::One,
                    (None, _) => Slot::Any,
                };
                (p.number(), slot)
            }
        };
        let [r, g, b] = base.factor;
        if [r, g, b, amount] != [1.0; 4] {
            pbr.insert("baseColorFactor".to_owned(), json!([r, g, b, amount]));
        }
        put(&mut pbr, "baseColorTexture", self.colours(base.image.as_ref(), slot));
        match &alpha {
            Alpha::Opaque => {}
            Alpha::Mask(_, cutoff) => {
                out.insert("alphaMode".to_owned(), json!("MASK"));
                out.insert("alphaCutoff".to_owned(), json!(cutoff));
            }
            Alpha::Blend(_) => {
                out.insert("alphaMode".to_owned(), json!("BLEND"));
            }
        }
        let [metallic, roughness] = [&m.metallic, &m.roughness].map(|v| self.amount(v));
        put_number(&mut pbr, "metallicFactor", metallic.number(), 1.0);
        put_number(&mut pbr, "roughnessFactor", roughness.number(), 1.0);
        if metallic.image.is_some() || roughness.image.is_some() {
            let slots = [Slot::Any, channel(&roughness), channel(&metallic), Slot::Any];
            put(&mut pbr, "metallicRoughnessTexture", self.picture(slots));
        }
        if !pbr.is_empty() {
            out.insert("pbrMetallicRoughness".to_owned(), pbr.into());
        }
        base.is_painted
    }

    fn alpha(&mut self, alpha: &Varying<f64>) -> Alpha {
        let Varying::Texture(texture) = alpha else {
            return match alpha {
                Varying::Constant(1.0) => Alpha::Opaque,
                other => Alpha::Blend(self.amount(other)),
            };
        };
        let scene = self.scene;
        let found = match texture.as_ref() {
            TextureOf::Inline(texture) => Some(texture),
            TextureOf::Named(link) => scene.textures.of(link),
        };
        // A step, as the reader has it: within a narrow range from nothing to all.
        if let Some(Texture::Remap(step)) = found
            && step.to == [0.0, 1.0]
            && (0.0..1e-3).contains(&(step.from[1] - step.from[0]))
            && let Varying::Texture(of) = &step.of
        {
            let product = self.amount(&Varying::Texture(of.clone()));
            return Alpha::Mask(product, step.from[1]);
        }
        Alpha::Blend(self.amount(alpha))
    }

    fn glow(&mut self, m: &Gltf, out: &mut Object) {
        let strength = self.same(&m.emissive_strength, 1.0);
        if strength <= 0.0 || m.emissive == Varying::Constant(Spectrum::grey(0.0)) {
            return;
        }
        let Product { factor, image, is_painted } = self.colour(&m.emissive, Quantity::Emission);
        if is_painted {
            self.tell("what glows has no colours of vertices");
        }
        let most = factor.iter().fold(1.0, |most, v| if *v > most { *v } else { most });
        out.insert("emissiveFactor".to_owned(), json!(factor.map(|v| v / most)));
        put(out, "emissiveTexture", self.colours(image.as_ref(), Slot::Any));
        let strength = most * strength;
        if strength != 1.0 {
            let said = json!({ "emissiveStrength": strength });
            self.extend(out, "KHR_materials_emissive_strength", said);
        }
    }

    fn relief(&mut self, relief: &Relief, out: &mut Object) {
        if likeness::is_bumpy(relief) {
            self.tell("bumps by height are left out: glTF has maps of normals");
        }
        let Some(map) = &relief.normal_map else { return };
        if map.space != NormalSpace::Tangent {
            self.tell("maps of normals in other axes than glTF's are left out");
            return;
        }
        if let Some(info) = self.normals(&map.texture, &map.green, map.strength) {
            out.insert("normalTexture".to_owned(), info);
        }
    }

    /// A map of normals in the axes of the surface.
    fn normals(&mut self, texture: &TextureOf, green: &GreenAxis, strength: f64) -> Option<Json> {
        if *green != GreenAxis::Up {
            self.tell("maps of normals in other axes than glTF's are left out");
            return None;
        }
        let texture = Varying::<f64>::Texture(Box::new(texture.clone()));
        let image = self.amount(&texture).image?;
        let of = |channel| Slot::Of(straal_scene::desc::ImageTexture { channel, ..image.clone() });
        let slots = [of(TextureChannel::Red), of(TextureChannel::Green), of(TextureChannel::Blue), Slot::Any];
        let mut info = self.picture(slots)?;
        if strength != 1.0 {
            info["scale"] = json!(strength);
        }
        Some(info)
    }

    /// What lies on the base: index, specular, clearcoat, sheen, iridescence, anisotropy.
    fn layers(&mut self, m: &Gltf, out: &mut Object) {
        let ior = self.same(&m.ior, 1.5);
        if ior != 1.5 {
            self.extend(out, "KHR_materials_ior", json!({ "ior": ior }));
        }
        let mut said = Object::new();
        let specular = self.amount(&m.specular);
        put_number(&mut said, "specularFactor", specular.number(), 1.0);
        let slots = [Slot::Any, Slot::Any, Slot::Any, channel_or_any(&specular)];
        put(&mut said, "specularTexture", self.picture(slots));
        let tint = self.colour(&m.specular_color, Quantity::Reflectance);
        if tint.factor != [1.0; 3] {
            said.insert("specularColorFactor".to_owned(), json!(tint.factor));
        }
        put(&mut said, "specularColorTexture", self.colours(tint.image.as_ref(), Slot::Any));
        self.put_extension(out, "KHR_materials_specular", said);

        let mut said = Object::new();
        let [coat, rough] = [&m.clearcoat, &m.clearcoat_roughness].map(|v| self.amount(v));
        put_number(&mut said, "clearcoatFactor", coat.number(), 0.0);
        let slots = [channel_or_any(&coat), Slot::Any, Slot::Any, Slot::Any];
        put(&mut said, "clearcoatTexture", self.picture(slots));
        put_number(&mut said, "clearcoatRoughnessFactor", rough.number(), 0.0);
        let slots = [Slot::Any, channel_or_any(&rough), Slot::Any, Slot::Any];
        put(&mut said, "clearcoatRoughnessTexture", self.picture(slots));
        if coat.number() > 0.0 {
            let normals = match &m.clearcoat_normal {
                CoatNormal::Base => out.get("normalTexture").cloned(),
                CoatNormal::Surface => None,
                CoatNormal::Map(map) => self.normals(&map.texture, &map.green, map.strength),
            };
            put(&mut said, "clearcoatNormalTexture", normals);
            self.put_extension(out, "KHR_materials_clearcoat", said);
        }

        let sheen = self.colour(&m.sheen_color, Quantity::Reflectance);
        if sheen.factor != [0.0; 3] {
            let mut said = Object::new();
            said.insert("sheenColorFactor".to_owned(), json!(sheen.factor));
            put(&mut said, "sheenColorTexture", self.colours(sheen.image.as_ref(), Slot::Any));
            let rough = self.amount(&m.sheen_roughness);
            put_number(&mut said, "sheenRoughnessFactor", rough.number(), 0.0);
            let slots = [Slot::Any, Slot::Any, Slot::Any, channel_or_any(&rough)];
            put(&mut said, "sheenRoughnessTexture", self.picture(slots));
            self.put_extension(out, "KHR_materials_sheen", said);
        }

        let film = self.amount(&m.iridescence);
        if film.number() > 0.0 {
            let mut said = Object::new();
            put_number(&mut said, "iridescenceFactor", film.number(), 0.0);
            let slots = [channel_or_any(&film), Slot::Any, Slot::Any, Slot::Any];
            put(&mut said, "iridescenceTexture", self.picture(slots));
            put_number(&mut said, "iridescenceIor", self.same(&m.iridescence_ior, 1.3), 1.3);
            self.thickness(&m.iridescence_thickness, &mut said);
            self.put_extension(out, "KHR_materials_iridescence", said);
        }

        let stretched = self.amount(&m.anisotropy);
        if stretched.number() > 0.0 {
            let mut said = Object::new();
            put_number(&mut said, "anisotropyStrength", stretched.number(), 0.0);
            put_number(
                &mut said,
                "anisotropyRotation",
                self.same(&m.anisotropy_rotation, 0.0).to_radians(),
                0.0,
            );
            let direction = m
                .anisotropy_direction
                .as_ref()
                .and_then(|texture| self.amount(&Varying::<f64>::Texture(Box::new(texture.clone()))).image);
            let [along, across] = match direction {
                Some(image) => [TextureChannel::Red, TextureChannel::Green]
                    .map(|channel| Slot::Of(straal_scene::desc::ImageTexture { channel, ..image.clone() })),
                // Along u.
                None => [Slot::One, Slot::Half],
            };
            let strength = match &stretched.image {
                Some(_) => channel_or_any(&stretched),
                None => Slot::One,
            };
            put(&mut said, "anisotropyTexture", self.picture([along, across, strength, Slot::Any]));
            self.put_extension(out, "KHR_materials_anisotropy", said);
        }
    }

    /// How thick a film is: a number, or from one to another by a texture's green.
    fn thickness(&mut self, thickness: &Varying<f64>, said: &mut Object) {
        let most = "iridescenceThicknessMaximum";
        let texture = match thickness {
            Varying::Constant(v) => return put_number(said, most, *v, 400.0),
            Varying::Texture(texture) => texture,
        };
        let range = match texture.as_ref() {
            TextureOf::Inline(Texture::Remap(r)) if r.from == [0.0, 1.0] && r.power == 1.0 => match &r.of {
                Varying::Texture(of) => Some((r.to, of.clone())),
                Varying::Constant(_) => None,
            },
            _ => None,
        };
        let Some(([least, top], of)) = range else {
            self.tell("textures of a film's thickness that aren't a range of a picture are left out");
            return;
        };
        let product = self.amount(&Varying::Texture(of));
        put_number(said, "iridescenceThicknessMinimum", least, 100.0);
        put_number(said, most, top, 400.0);
        let slots = [Slot::Any, channel_or_any(&product), Slot::Any, Slot::Any];
        put(said, "iridescenceThicknessTexture", self.picture(slots));
    }

    /// What light does that isn't sent back: transmission, volume, dispersion.
    fn inside(&mut self, m: &Gltf, out: &mut Object) {
        let through = self.amount(&m.diffuse_transmission);
        if through.number() > 0.0 {
            let mut said = Object::new();
            put_number(&mut said, "diffuseTransmissionFactor", through.number(), 0.0);
            let slots = [Slot::Any, Slot::Any, Slot::Any, channel_or_any(&through)];
            put(&mut said, "diffuseTransmissionTexture", self.picture(slots));
            let color = self.colour(&m.diffuse_transmission_color, Quantity::Reflectance);
            if color.factor != [1.0; 3] {
                said.insert("diffuseTransmissionColorFactor".to_owned(), json!(color.factor));
            }
            let picture = self.colours(color.image.as_ref(), Slot::Any);
            put(&mut said, "diffuseTransmissionColorTexture", picture);
            self.put_extension(out, "KHR_materials_diffuse_transmission", said);
        }
        let clear = self.amount(&m.transmission);
        if clear.number() <= 0.0 {
            return;
        }
        let mut said = Object::new();
        put_number(&mut said, "transmissionFactor", clear.number(), 0.0);
        let slots = [channel_or_any(&clear), Slot::Any, Slot::Any, Slot::Any];
        put(&mut said, "transmissionTexture", self.picture(slots));
        self.put_extension(out, "KHR_materials_transmission", said);
        let color = self.rgb(&m.attenuation_color, Quantity::Reflectance);
        if m.volume || color != [1.0; 3] || m.attenuation_distance.is_some() {
            let mut said = Object::new();
            // How thick things are rays find out; programs that don't follow any bend light as by a metre.
            put_number(&mut said, "thicknessFactor", f64::from(u8::from(m.volume)), 0.0);
            if color != [1.0; 3] {
                said.insert("attenuationColor".to_owned(), json!(color));
            }
            if let Some(distance) = m.attenuation_distance {
                said.insert("attenuationDistance".to_owned(), json!(distance));
            }
            self.put_extension(out, "KHR_materials_volume", said);
        }
        let dispersion = self.same(&m.dispersion, 0.0);
        if dispersion > 0.0 {
            self.extend(out, "KHR_materials_dispersion", json!({ "dispersion": dispersion }));
        }
    }

    fn put_extension(&mut self, out: &mut Object, name: &'static str, said: Object) {
        if !said.is_empty() {
            self.extend(out, name, said.into());
        }
    }
}

fn put(out: &mut Object, key: &str, said: Option<Json>) {
    if let Some(said) = said {
        out.insert(key.to_owned(), said);
    }
}

/// A number that isn't what it is where nothing is said.
fn put_number(out: &mut Object, key: &str, v: f64, unsaid: f64) {
    if v != unsaid {
        out.insert(key.to_owned(), json!(v));
    }
}

/// The channel of a picture that another reads as well: full where nothing but the factor counts, anything where that is 0.
fn channel(product: &Product) -> Slot {
    match &product.image {
        Some(image) => Slot::Of(image.clone()),
        None if product.number() == 0.0 => Slot::Any,
        None => Slot::One,
    }
}

/// The channel of a picture that nothing else reads.
fn channel_or_any(product: &Product) -> Slot {
    product.image.clone().map_or(Slot::Any, Slot::Of)
}
