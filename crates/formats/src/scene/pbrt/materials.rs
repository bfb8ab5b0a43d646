//! Materials.

use std::collections::BTreeSet;
use std::rc::Rc;

use straal_scene::desc::{
    Bump, Coat, CoatedConductor, CoatedDiffuse, Conductor, Dielectric, Diffuse, DiffuseTransmission,
    GreenAxis, ImageTexture, Index, Mapping, Mask, Material, MaterialRef, Mirror, Mix, NormalMap,
    NormalSpace, OpenPbr, Principled, Relief, RoughDiffuse, Spectrum, Texture, TextureChannel, TextureFilter,
    TextureOf, TextureSpace, ThinDielectric, Varying, Wrap, Wraps,
};
use straal_scene::value::{LinearRgb, Link, Name};
use straal_scene::{Bitmap, Spanned, suggest};

use super::params::{Params, Type};
use super::spectra::{Role, as_number, metal_of};
use super::state::Surface;
use super::textures::{Of, root, scaled, share};
use super::{Reader, Thing};

/// The materials so far.
#[derive(Default)]
pub(super) struct Known {
    /// Those that are nothing at all.
    nothing: BTreeSet<String>,
    /// How many have no name of their own.
    unnamed: usize,
}

/// pbrt-v4's, for 'did you mean'.
const KINDS: [&str; 12] = [
    "coatedconductor",
    "coateddiffuse",
    "conductor",
    "dielectric",
    "diffuse",
    "diffusetransmission",
    "hair",
    "interface",
    "measured",
    "mix",
    "subsurface",
    "thindielectric",
];

impl Reader<'_, '_> {
    /// A material for the shapes that follow.
    ///
    /// Some files name one that isn't there and tell of it in the next directive: it is taken for `MakeNamedMaterial`, as it must have been meant.
    pub(super) fn material(&mut self, thing: Thing, just_named: Option<Name>) {
        let Thing { kind, params } = thing;
        let params = params.within(&self.state.attributes.material);
        self.state.surface = match self.made_of(&kind, &params) {
            None => Surface::Nothing,
            Some(material) => {
                let name = match just_named {
                    Some(name) => {
                        let message = format!(
                            "there is no material named `{}`: the one that follows goes by it from here on",
                            suggest::brief(&name)
                        );
                        self.warn(name.span, message);
                        name
                    }
                    None => Spanned::new(self.free_name(&kind), kind.span),
                };
                self.scene.materials.insert(name.clone(), material);
                Surface::Named(Rc::new(name))
            }
        };
    }

    /// A name for what has none.
    fn free_name(&mut self, kind: &str) -> String {
        self.materials.unnamed += 1;
        let mut name = format!("{kind} {}", self.materials.unnamed);
        while self.scene.materials.get(&name).is_some() {
            name.push('\'');
        }
        name
    }

    /// A material by name.
    pub(super) fn make_named_material(&mut self, thing: Thing) {
        let Thing { kind: name, params } = thing;
        let params = params.within(&self.state.attributes.material);
        let is_known =
            self.scene.materials.get(&name).is_some() || self.materials.nothing.contains(&name.value);
        if is_known {
            return self
                .error(name.span, format!("the material `{}` is defined twice", suggest::brief(&name)));
        }
        let Some(kind) = params.string("type").cloned() else {
            let message = format!("the material `{}` has no `type`", suggest::brief(&name));
            return self.error(name.span, message);
        };
        match self.made_of(&kind, &params) {
            Some(material) => self.scene.materials.insert(name, material),
            None => {
                self.materials.nothing.insert(name.value);
            }
        }
    }

    /// Takes a material by name for the shapes that follow.
    pub(super) fn named_material(&mut self, name: Spanned<String>) {
        self.state.surface = if self.materials.nothing.contains(&name.value) {
            Surface::Nothing
        } else {
            self.just_named = self.scene.materials.get(&name).is_none().then(|| name.clone());
            Surface::Named(Rc::new(name))
        };
    }

    /// A material of a kind; none where it is nothing at all.
    fn made_of(&mut self, kind: &Spanned<String>, params: &Params) -> Option<Material> {
        let relief = self.relief(params);
        let material = match kind.as_str() {
            "" | "none" | "interface" => {
                params.complain("the material `interface`", self.means.d);
                return None;
            }
            "diffuse" => self.diffuse(params, "reflectance"),
            "coateddiffuse" => self.coated_diffuse(params),
            "coatedconductor" => self.coated_conductor(params),
            "conductor" => self.conductor(params),
            "dielectric" => self.dielectric(params, "eta"),
            "thindielectric" => self.thin_dielectric(params),
            "diffusetransmission" => self.diffuse_transmission(params),
            "mix" => self.mixed(params),
            "subsurface" | "kdsubsurface" => self.subsurface(kind, params),
            "hair" => self.hair(kind, params),
            "measured" | "fourier" => {
                params.pass_over(&["filename", "bsdffile"]);
                let message = format!("the material `{}` is approximated: diffuse, 0.5", kind.value);
                self.warn(kind.span, message);
                Material::Diffuse(Diffuse::default())
            }
            _ => match self.older(kind, params) {
                Some(material) => material,
                None => {
                    self.unknown("material", kind, &KINDS);
                    return Some(Material::Diffuse(Diffuse::default()));
                }
            },
        };
        params.complain(&format!("the material `{}`", kind.value), self.means.d);
        Some(with_relief(material, relief))
    }

    /// Bumps and normal maps.
    fn relief(&mut self, params: &Params) -> Relief {
        let mut relief = Relief::default();
        let texture = params.texture("displacement").or(params.texture("bumpmap")).cloned();
        if let Some(name) = texture
            && let Varying::Texture(texture) = self.named_texture(&name, Of::Numbers)
        {
            relief.bump = Some(Bump { texture: *texture, height: 1.0 });
        }
        params.pass_over(&["displacement"]);
        if let Some(file) = params.string("normalmap").cloned() {
            let texture = TextureOf::Inline(Texture::Image(ImageTexture {
                file: self.made.in_file::<Bitmap>(file),
                color_space: TextureSpace::Raw,
                channel: TextureChannel::Luminance,
                filter: TextureFilter::Trilinear,
                anisotropy: 16.0,
                wrap: Wraps([Wrap::Repeat, Wrap::Repeat]),
                mapping: Mapping::default(),
            }));
            let (space, green) = (NormalSpace::Tangent, GreenAxis::Up);
            relief.normal_map = Some(NormalMap { texture, space, green, strength: 1.0 });
        }
        relief
    }

    fn colour(&mut self, params: &Params, name: &'static str, absent: f64) -> Varying<Spectrum> {
        self.value(params, name, Of::Colours).unwrap_or(Varying::Constant(Spectrum::grey(absent)))
    }

    /// Alpha of microfacets along u and v, by the names of their parameters.
    fn roughness(
        &mut self,
        params: &Params,
        [both, u, v]: [&'static str; 3],
        absent: f64,
    ) -> (Varying<f64>, Option<Varying<f64>>) {
        let remap = params.bool("remaproughness", true);
        let base = self.number(params, both).unwrap_or(Varying::Constant(absent));
        let [u, v] = [u, v].map(|name| self.number(params, name));
        let alpha = |value: Varying<f64>| if remap { root(value) } else { share(value) };
        let [u, v] = [u, v].map(|one| alpha(one.unwrap_or_else(|| base.clone())));
        if u == v { (u, None) } else { (u, Some(v)) }
    }

    /// The same for what is as rough in all directions.
    fn even_roughness(&mut self, params: &Params, names: [&'static str; 3], absent: f64) -> Varying<f64> {
        match self.roughness(params, names, absent) {
            (u, None) => u,
            (u, Some(v)) => {
                self.warn_once(params.span, "this is as rough along v as along u: the mean is taken");
                match (u, v) {
                    (Varying::Constant(u), Varying::Constant(v)) => Varying::Constant(0.5 * (u + v)),
                    (u, _) => u,
                }
            }
        }
    }

    fn diffuse(&mut self, params: &Params, name: &'static str) -> Material {
        let reflectance = self.colour(params, name, 0.5);
        Material::Diffuse(Diffuse { reflectance, ..Diffuse::default() })
    }

    /// What of a coat is the same over all grounds.
    fn coat(&mut self, params: &Params, names: [&'static str; 3], eta: &'static str) -> Coat {
        let coat_roughness = self.even_roughness(params, names, 0.0);
        let eta = as_number(&self.index(params, eta, 1.5));
        let coat_eta = if eta > 1.0001 { eta } else { 1.0001 };
        let mut number = |name, absent: f64, [least, most]: [f64; 2]| match self.number(params, name) {
            Some(Varying::Constant(v)) => held(v, least, most).into(),
            Some(texture) => texture,
            None => absent.into(),
        };
        let thickness = number("thickness", 0.01, [1e-6, 1e3]);
        let g = number("g", 0.0, [-0.99, 0.99]);
        let albedo = self.colour(params, "albedo", 0.0);
        params.pass_over(&["nsamples"]);
        Coat {
            coat_eta: coat_eta.into(),
            coat_roughness,
            thickness,
            albedo,
            g,
            max_depth: params.integer("maxdepth", 10).clamp(1, 1000).unsigned_abs(),
            two_sided: true,
        }
    }

    fn coated_diffuse(&mut self, params: &Params) -> Material {
        let reflectance = self.colour(params, "reflectance", 0.5);
        let coat = self.coat(params, ["roughness", "uroughness", "vroughness"], "eta");
        Material::CoatedDiffuse(CoatedDiffuse { reflectance, coat, relief: Relief::default() })
    }

    fn coated_conductor(&mut self, params: &Params) -> Material {
        let names = ["conductor.roughness", "conductor.uroughness", "conductor.vroughness"];
        let roughness = self.even_roughness(params, names, 0.0);
        let names = ["interface.roughness", "interface.uroughness", "interface.vroughness"];
        let coat = self.coat(params, names, "interface.eta");
        let mut metal = Conductor::default();
        self.metal(params, ["conductor.eta", "conductor.k"], &mut metal);
        let Conductor { metal, eta, k, .. } = metal;
        Material::CoatedConductor(CoatedConductor {
            metal,
            eta,
            k,
            roughness,
            coat,
            relief: Relief::default(),
        })
    }

    /// The index of a metal, or one that reflects what is asked for.
    fn metal(&mut self, params: &Params, [eta, k]: [&'static str; 2], out: &mut Conductor) {
        let constant = self.value(params, "reflectance", Of::Colours);
        if let Some(reflectance) = constant {
            let rgb = match reflectance.constant().and_then(Spectrum::rgb) {
                Some(LinearRgb(rgb)) => rgb,
                None => {
                    self.warn_once(
                        params.span,
                        "a metal with a `reflectance` that is no colour in RGB is grey, 0.5",
                    );
                    [0.5; 3]
                }
            };
            // With eta = 1, k of what reflects r straight on is 2 sqrt(r / (1 - r)).
            let of = |r: f64| {
                let r = held(r, 0.0, 0.9999);
                2.0 * (r / (1.0 - r)).sqrt()
            };
            out.eta = Some(Spectrum::grey(1.0).into());
            out.k = Some(Spectrum::Rgb(LinearRgb(rgb.map(of))).into());
            return;
        }
        let said =
            |name| params.find(name, |t| t == Type::Spectrum).and_then(|p| p.strings()?.first().cloned());
        let copper = |part: &str| Spanned::from(format!("metal-Cu-{part}"));
        let is_said = [params.has(eta), params.has(k)];
        let names = match is_said {
            [false, false] => Some((copper("eta"), copper("k"))),
            [true, true] => said(eta).zip(said(k)),
            _ => None,
        };
        if let Some(metal) = names.and_then(|(eta, k)| metal_of(&eta, &k)) {
            out.metal = Some(metal);
            return;
        }
        // Where one is missing, copper's own stands for it, as red, green and blue.
        let copper = |rgb: [f64; 3]| Spectrum::Rgb(LinearRgb(rgb));
        let mut part = |name, absent| match params.texture(name).cloned() {
            Some(texture) => self.named_texture(&texture, Of::Colours),
            None => self.spectrum(params, name, Role::Unbounded).unwrap_or(copper(absent)).into(),
        };
        out.eta = Some(part(eta, [0.271, 0.677, 1.316]));
        out.k = Some(part(k, [3.609, 2.625, 2.292]));
    }

    fn conductor(&mut self, params: &Params) -> Material {
        let (roughness, roughness_v) = self.roughness(params, ["roughness", "uroughness", "vroughness"], 0.0);
        // A reflectance that differs from place to place needs a material with a colour.
        if let Some(texture) = params.texture("reflectance").cloned() {
            let base_color = self.named_texture(&texture, Of::Colours);
            self.warn_once(
                params.span,
                "a metal with a texture for `reflectance` is approximated by that of `open_pbr`",
            );
            return Material::OpenPbr(OpenPbr {
                base_weight: Varying::Constant(1.0),
                base_color,
                base_metalness: Varying::Constant(1.0),
                specular_roughness: root(roughness),
                ..OpenPbr::default()
            });
        }
        let mut out = Conductor { roughness, roughness_v, ..Conductor::default() };
        self.metal(params, ["eta", "k"], &mut out);
        Material::Conductor(out)
    }

    fn dielectric(&mut self, params: &Params, eta: &'static str) -> Material {
        let (roughness, roughness_v) = self.roughness(params, ["roughness", "uroughness", "vroughness"], 0.0);
        let mut eta = self.index(params, eta, 1.5);
        let is_rough = roughness_v.is_some() || roughness != Varying::Constant(0.0);
        if is_rough && !matches!(eta, Index::Constant(_)) {
            self.warn_once(params.span, "rough glass doesn't disperse: its index is that at 588 nm");
            eta = Index::Constant(as_number(&eta));
        }
        Material::Dielectric(Dielectric { eta: eta.into(), roughness, roughness_v, ..Dielectric::default() })
    }

    fn thin_dielectric(&mut self, params: &Params) -> Material {
        let eta = as_number(&self.index(params, "eta", 1.5));
        Material::ThinDielectric(ThinDielectric { eta: eta.into(), ..ThinDielectric::default() })
    }

    fn diffuse_transmission(&mut self, params: &Params) -> Material {
        let scale = held(params.float("scale", 1.0), 0.0, 1e6);
        let by = || Varying::Constant(Spectrum::grey(scale));
        let mut both =
            ["reflectance", "transmittance"].map(|name| scaled(self.colour(params, name, 0.25), by()));
        // Together they may send on all light, and no more.
        let peak = |v: &Varying<Spectrum>| {
            let LinearRgb(rgb) = v.constant().and_then(Spectrum::rgb).unwrap_or_default();
            rgb.into_iter().fold(0.0, |a: f64, b| if b > a { b } else { a })
        };
        let sum = peak(&both[0]) + peak(&both[1]);
        if sum > 1.0 {
            self.warn_once(
                params.span,
                "`reflectance` and `transmittance` together are above 1: they are scaled down to that",
            );
            both = both.map(|v| scaled(v, Varying::Constant(Spectrum::grey((1.0 - 1e-9) / sum))));
        }
        let [reflectance, transmittance] = both;
        Material::DiffuseTransmission(DiffuseTransmission {
            reflectance,
            transmittance,
            relief: Relief::default(),
        })
    }

    fn mixed(&mut self, params: &Params) -> Material {
        let amount = self.number(params, "amount").unwrap_or(Varying::Constant(0.5));
        let names = params.find("materials", |t| t == Type::String).and_then(|p| p.strings());
        let older = params.string("namedmaterial1").zip(params.string("namedmaterial2"));
        let names = match (names, older) {
            (Some([first, second]), _) => [first.clone(), second.clone()],
            (_, Some((first, second))) => [first.clone(), second.clone()],
            _ => {
                self.error(
                    params.span,
                    "a material `mix` needs the names of two others: `\"string materials\" [ \"a\" \"b\" ]`",
                );
                return Material::Diffuse(Diffuse::default());
            }
        };
        let [first, second] = names.map(|name| {
            if self.materials.nothing.contains(&name.value) {
                self.error(name.span, "an `interface` can't be a part of a mixture");
            }
            Box::new(MaterialRef::Named(Link::new(name)))
        });
        Material::Mix(Mix { first, second, weight: share(amount), relief: Relief::default() })
    }

    /// Light that is scattered beneath a surface, as the colour that comes of it.
    fn subsurface(&mut self, kind: &Spanned<String>, params: &Params) -> Material {
        params.pass_over(&["name", "mfp", "g", "scale"]);
        let roughness = self.even_roughness(params, ["roughness", "uroughness", "vroughness"], 0.0);
        let colour =
            match self.value(params, if params.has("Kd") { "Kd" } else { "reflectance" }, Of::Colours) {
                Some(colour) => colour,
                None => {
                    let rgb = |s: Option<Spectrum>, absent: [f64; 3]| match s.as_ref().and_then(Spectrum::rgb)
                    {
                        Some(LinearRgb(rgb)) => rgb,
                        None => absent,
                    };
                    let absorbed = self.spectrum(params, "sigma_a", Role::Unbounded);
                    let scattered = self.spectrum(params, "sigma_s", Role::Unbounded);
                    let (a, s) = (rgb(absorbed, [0.0011, 0.0024, 0.014]), rgb(scattered, [2.55, 3.21, 3.77]));
                    // The albedo of a half-space of evenly scattering particles, by the fit of van de Hulst (1980).
                    let of = |k: usize| {
                        let all = a[k] + s[k];
                        let x = if all > 0.0 { (a[k] / all).sqrt() } else { 0.0 };
                        held((1.0 - x) * (1.0 - 0.139 * x) / (1.0 + 1.17 * x), 0.0, 1.0)
                    };
                    Varying::Constant(Spectrum::Rgb(LinearRgb([0, 1, 2].map(of))))
                }
            };
        let eta = params.float("eta", 1.33);
        self.warn(
            kind.span,
            "`subsurface` is approximated: what is scattered beneath the surface comes out where it went in",
        );
        Material::OpenPbr(OpenPbr {
            subsurface_weight: Varying::Constant(1.0),
            subsurface_color: colour,
            specular_ior: Varying::Constant(held(eta, 0.1, 5.0)),
            specular_roughness: root(roughness),
            ..OpenPbr::default()
        })
    }

    /// Fibres, as plainly diffuse ones of their colour.
    fn hair(&mut self, kind: &Spanned<String>, params: &Params) -> Material {
        params.pass_over(&["eta", "beta_m", "beta_n", "alpha", "sigma_a", "pheomelanin"]);
        let dark = params.maybe_float("eumelanin").unwrap_or(1.3);
        let name = if params.has("reflectance") { "reflectance" } else { "color" };
        // Darker with more of the pigment: brown at what pbrt takes for usual.
        let of = |strength: f64| held(0.8 / (1.0 + strength * dark), 0.0, 0.8);
        let brown = Spectrum::Rgb(LinearRgb([of(1.5), of(3.0), of(7.0)]));
        let reflectance = self.value(params, name, Of::Colours).unwrap_or(Varying::Constant(brown));
        self.warn(kind.span, "`hair` is approximated: its fibres are diffuse");
        Material::Diffuse(Diffuse { reflectance, ..Diffuse::default() })
    }

    /// The materials of pbrt-v3.
    fn older(&mut self, kind: &Spanned<String>, params: &Params) -> Option<Material> {
        let material = match kind.as_str() {
            "matte" => {
                let mut material = self.diffuse(params, "Kd");
                let sigma = match self.number(params, "sigma") {
                    Some(Varying::Constant(degrees)) => degrees,
                    _ => 0.0,
                };
                if let Material::Diffuse(m) = &mut material {
                    m.roughness = Varying::Constant(held(sigma.to_radians(), 0.0, 1.0));
                    m.model = RoughDiffuse::OrenNayar;
                }
                material
            }
            "mirror" => {
                let reflectance = self.colour(params, "Kr", 0.9);
                Material::Mirror(Mirror { reflectance, ..Mirror::default() })
            }
            "glass" => {
                let name = if params.has("index") { "index" } else { "eta" };
                let mut material = self.dielectric(params, name);
                if let Material::Dielectric(m) = &mut material {
                    m.reflectance = self.colour(params, "Kr", 1.0);
                    m.transmittance = self.colour(params, "Kt", 1.0);
                }
                material
            }
            "metal" => {
                let (roughness, roughness_v) =
                    self.roughness(params, ["roughness", "uroughness", "vroughness"], 0.01);
                let mut out = Conductor { roughness, roughness_v, ..Conductor::default() };
                self.metal(params, ["eta", "k"], &mut out);
                Material::Conductor(out)
            }
            "plastic" | "substrate" | "uber" => {
                let reflectance =
                    self.colour(params, "Kd", if kind.as_str() == "substrate" { 0.5 } else { 0.25 });
                params.pass_over(&["Ks", "Kr", "Kt", "opacity"]);
                let name = if params.has("index") { "index" } else { "eta" };
                let coat = self.coat(params, ["roughness", "uroughness", "vroughness"], name);
                Material::CoatedDiffuse(CoatedDiffuse { reflectance, coat, relief: Relief::default() })
            }
            "translucent" => {
                params.pass_over(&["Ks", "roughness", "remaproughness"]);
                let colour = self.colour(params, "Kd", 0.25);
                let half = |reader: &mut Self, name| {
                    let share = reader.colour(params, name, 0.5);
                    scaled(colour.clone(), share)
                };
                let (reflectance, transmittance) = (half(self, "reflect"), half(self, "transmit"));
                Material::DiffuseTransmission(DiffuseTransmission {
                    reflectance,
                    transmittance,
                    relief: Relief::default(),
                })
            }
            "disney" => {
                let number = |reader: &mut Self, name, absent: f64| {
                    share(reader.number(params, name).unwrap_or(Varying::Constant(absent)))
                };
                let base_color = self.colour(params, "color", 0.5);
                params.pass_over(&["scatterdistance", "difftrans", "thin"]);
                Material::Principled(Principled {
                    base_color,
                    roughness: number(self, "roughness", 0.5),
                    anisotropic: number(self, "anisotropic", 0.0),
                    metallic: number(self, "metallic", 0.0),
                    spec_trans: number(self, "spectrans", 0.0),
                    eta: Some(held(params.float("eta", 1.5), 1.01, 10.0).into()),
                    spec_tint: number(self, "speculartint", 0.0),
                    sheen: number(self, "sheen", 0.0),
                    sheen_tint: number(self, "sheentint", 0.5),
                    clearcoat: number(self, "clearcoat", 0.0),
                    clearcoat_gloss: number(self, "clearcoatgloss", 1.0),
                    flatness: number(self, "flatness", 0.0),
                    ..Principled::default()
                })
            }
            _ => return None,
        };
        self.warn_once(
            kind.span,
            format!("the material `{}` is of pbrt-v3: the nearest of version 4 is taken", kind.value),
        );
        Some(material)
    }

    /// The material of a shape, and whether it is there at all; `alpha` is the share of light that meets it.
    pub(super) fn surface(&mut self, params: &Params) -> Option<Option<MaterialRef>> {
        let material = match &self.state.surface {
            Surface::Nothing => return None,
            Surface::Plain => None,
            Surface::Named(name) => Some(MaterialRef::Named(Link::new((**name).clone()))),
        };
        params.pass_over(&["shadowalpha"]);
        let alpha = match self.number(params, "alpha") {
            None => return Some(material),
            Some(Varying::Constant(v)) if v >= 1.0 => return Some(material),
            Some(alpha) => share(alpha),
        };
        let plain = || MaterialRef::Inline(Box::new(Material::Diffuse(Diffuse::default())));
        let material = Box::new(material.unwrap_or_else(plain));
        Some(Some(MaterialRef::Inline(Box::new(masked(material, alpha)))))
    }
}

fn masked(material: Box<MaterialRef>, opacity: Varying<f64>) -> Material {
    Material::Mask(Mask { material, opacity, relief: Relief::default() })
}

/// A number within a range.
fn held(v: f64, low: f64, high: f64) -> f64 {
    if v > low { if v < high { v } else { high } } else { low }
}

/// The material with bumps; a mixture's parts have their own.
fn with_relief(mut material: Material, relief: Relief) -> Material {
    let own = match &mut material {
        Material::Diffuse(m) => &mut m.relief,
        Material::Mirror(m) => &mut m.relief,
        Material::Dielectric(m) => &mut m.relief,
        Material::Conductor(m) => &mut m.relief,
        Material::OpenPbr(m) => &mut m.relief,
        Material::Principled(m) => &mut m.relief,
        Material::ThinDielectric(m) => &mut m.relief,
        Material::DiffuseTransmission(m) => &mut m.relief,
        Material::CoatedDiffuse(m) => &mut m.relief,
        Material::CoatedConductor(m) => &mut m.relief,
        _ => return material,
    };
    *own = relief;
    material
}
