//! Materials of other kinds as the material `gltf`: some are the same, others are near to it, which is told.

use straal_color::Space;
use straal_color::spectrum::{Bins, Quantity, metal, refraction};
use straal_scene::desc::{
    Conductor, Dielectric, Gltf, Index, Interior, Material, MaterialRef, Mix, OpenPbr, Plastic, Principled,
    Relief, ScaleTexture, Spectrum, Texture, TextureOf, Varying,
};
use straal_scene::value::LinearRgb;

use super::Out;

/// Materials are so deep within one another at most.
const DEEPEST: u32 = 64;

impl<'a> Out<'a> {
    /// The material that a name or text means, and its name; none where there is none.
    pub fn material(&self, given: Option<&'a MaterialRef>) -> (Option<&'a Material>, Option<&'a str>) {
        match given {
            None => (None, None),
            Some(MaterialRef::Inline(material)) => (Some(material.as_ref()), None),
            Some(MaterialRef::Named(link)) => (self.scene.materials.of(link), Some(link.name.value.as_str())),
        }
    }

    /// A material as glTF's.
    pub fn likeness(&mut self, material: &Material, depth: u32) -> Gltf {
        let relief = material.relief().clone();
        let grounded = |color: &Varying<Spectrum>, roughness: Varying<f64>, two_sided: bool| Gltf {
            base_color: color.clone(),
            metallic: Varying::Constant(0.0),
            roughness,
            double_sided: two_sided,
            relief: relief.clone(),
            ..Gltf::default()
        };
        let metal = |color: Varying<Spectrum>, roughness: Varying<f64>, two_sided: bool| Gltf {
            metallic: Varying::Constant(1.0),
            ..grounded(&color, roughness, two_sided)
        };
        match material {
            Material::Gltf(m) => m.clone(),
            Material::Diffuse(m) => {
                if m.roughness != Varying::Constant(0.0) {
                    self.tell("rough diffuse materials are smooth ones (Lambert's)");
                }
                // Without a glossy surface it is Lambert's.
                Gltf {
                    specular: Varying::Constant(0.0),
                    ..grounded(&m.reflectance, Varying::Constant(1.0), m.two_sided)
                }
            }
            Material::Mirror(m) => metal(m.reflectance.clone(), Varying::Constant(0.0), m.two_sided),
            Material::Conductor(m) => {
                let color = self.facing(m);
                metal(color, self.root(&m.roughness, m.roughness_v.is_some()), m.two_sided)
            }
            Material::Dielectric(m) => self.glass(m),
            Material::ThinDielectric(m) => Gltf {
                transmission: Varying::Constant(1.0),
                ior: self.over([&m.eta, &m.eta_outside]),
                ..grounded(&m.transmittance, Varying::Constant(0.0), true)
            },
            Material::Plastic(m) => self.plastic(m),
            Material::OpenPbr(m) => self.open_pbr(m),
            Material::Principled(m) => self.principled(m),
            Material::CoatedDiffuse(m) => {
                self.near(material);
                Gltf {
                    clearcoat: Varying::Constant(1.0),
                    clearcoat_roughness: self.root(&m.coat.coat_roughness, false),
                    ..grounded(&m.reflectance, Varying::Constant(1.0), m.coat.two_sided)
                }
            }
            Material::Sheen(m) => {
                self.near(material);
                Gltf {
                    specular: Varying::Constant(0.0),
                    sheen_color: m.color.clone(),
                    sheen_roughness: m.roughness.clone(),
                    ..grounded(&m.reflectance, Varying::Constant(1.0), m.two_sided)
                }
            }
            Material::DiffuseTransmission(m) => {
                self.near(material);
                Gltf {
                    specular: Varying::Constant(0.0),
                    diffuse_transmission: Varying::Constant(0.5),
                    diffuse_transmission_color: m.transmittance.clone(),
                    ..grounded(&m.reflectance, Varying::Constant(1.0), true)
                }
            }
            Material::Phong(m) => {
                self.near(material);
                grounded(&m.reflectance, Varying::Constant(0.4), m.two_sided)
            }
            Material::Glossy(m) => {
                self.near(material);
                metal(m.reflectance.clone(), Varying::Constant(0.4), m.two_sided)
            }
            Material::Transparent(m) => {
                self.near(material);
                let mut glass = Gltf {
                    transmission: Varying::Constant(1.0),
                    ior: self.over([&m.eta, &m.eta_outside]),
                    ..grounded(&m.transmittance, Varying::Constant(0.0), true)
                };
                self.fill(&mut glass, &m.interior);
                glass
            }
            Material::ThinFilm(_) | Material::CoatedConductor(_) => {
                self.near(material);
                metal(Varying::Constant(Spectrum::grey(0.8)), Varying::Constant(0.2), true)
            }
            Material::Mask(m) => {
                let inside = self.part(&m.material, depth);
                let alpha = match (&inside.alpha, &m.opacity) {
                    (Varying::Constant(1.0), opacity) => opacity.clone(),
                    (alpha, opacity) => both(alpha, opacity),
                };
                Gltf { alpha, ..inside }
            }
            Material::TwoFaces(m) => {
                let front = self.part(&m.front, depth);
                let is_hole = matches!(
                    self.resolved(&m.back),
                    Some(Material::Mask(back)) if back.opacity == Varying::Constant(0.0)
                );
                if !is_hole {
                    self.tell("of materials with two faces the front is written");
                }
                Gltf { double_sided: !is_hole && front.double_sided, ..front }
            }
            Material::Mix(m) => self.mixed(m, depth),
        }
    }

    /// The material that a part of another means.
    fn resolved<'s>(&self, given: &'s MaterialRef) -> Option<&'s Material>
    where
        'a: 's,
    {
        match given {
            MaterialRef::Inline(material) => Some(material.as_ref()),
            MaterialRef::Named(link) => self.scene.materials.of(link),
        }
    }

    fn part(&mut self, given: &MaterialRef, depth: u32) -> Gltf {
        let scene = self.scene;
        let found = match given {
            MaterialRef::Inline(material) => Some(material.as_ref()),
            MaterialRef::Named(link) => scene.materials.of(link),
        };
        match found.filter(|_| depth < DEEPEST) {
            Some(material) => self.likeness(material, depth + 1),
            None => Gltf::default(),
        }
    }

    /// Tells that a material is only near to what is written.
    fn near(&mut self, material: &Material) {
        let what = material.kind();
        self.tell(format!("materials of the kind `{what}` are written as what is near to them in glTF"));
    }

    /// Of two materials the one that there is more of.
    fn mixed(&mut self, m: &Mix, depth: u32) -> Gltf {
        self.tell("of mixed materials the one is written that there is more of");
        let is_second = m.weight.constant().is_some_and(|w| *w > 0.5);
        self.part(if is_second { &m.second } else { &m.first }, depth)
    }

    /// Roughness as glTF tells it: the root of a facets' alpha. Textures are read off as they are.
    fn root(&mut self, alpha: &Varying<f64>, is_brushed: bool) -> Varying<f64> {
        if is_brushed {
            self.tell("what is rough in two ways is rough in one");
        }
        match alpha {
            Varying::Constant(v) => Varying::Constant(v.sqrt()),
            texture => {
                self.tell("textures of roughness are taken for its root, as glTF tells it");
                texture.clone()
            }
        }
    }

    /// The colour of a metal, looked at straight.
    fn facing(&mut self, m: &Conductor) -> Varying<Spectrum> {
        let same = |v: &'_ Option<Varying<Spectrum>>| v.as_ref().and_then(|v| v.constant().cloned());
        let (eta, k) = (same(&m.eta), same(&m.k));
        if [&m.eta, &m.k].into_iter().flatten().any(|v| v.constant().is_none()) {
            self.tell("textures of a metal's index of refraction are left out: it is written as gold");
        }
        let rgb = match (&eta, &k) {
            (Some(Spectrum::Rgb(LinearRgb(eta))), Some(Spectrum::Rgb(LinearRgb(k)))) => {
                std::array::from_fn(|i| {
                    let (n, k) = (eta[i], k[i] * k[i]);
                    ((n - 1.0) * (n - 1.0) + k) / ((n + 1.0) * (n + 1.0) + k)
                })
            }
            (Some(eta), Some(k)) => {
                let [eta, k] = [eta, k].map(|part| self.bins(part));
                metal::in_rgb(&eta, &k, Space::Srgb).facing
            }
            _ => {
                let metal = m.metal.as_ref().map_or_else(refraction::Metal::default, |known| known.what);
                let [eta, k] = metal.index().map(|part| part.means(Quantity::Index));
                metal::in_rgb(&eta, &k, Space::Srgb).facing
            }
        };
        self.tell("metals are written by their colour, looked at straight");
        let color = Spectrum::Rgb(LinearRgb(rgb.map(unit)));
        match &m.reflectance {
            tint if *tint == Varying::Constant(Spectrum::grey(1.0)) => Varying::Constant(color),
            tint => tinted(Varying::Constant(color), tint.clone()),
        }
    }

    /// An index of refraction by wavelength; one in RGB is the same all over.
    fn bins(&self, part: &Spectrum) -> Bins {
        match part {
            Spectrum::Rgb(LinearRgb(rgb)) => [rgb.iter().sum::<f64>() / 3.0; straal_color::spectrum::COUNT],
            Spectrum::Measured(m) => m.spectrum(self.assets).means(Quantity::Index),
        }
    }

    fn glass(&mut self, m: &Dielectric) -> Gltf {
        let [inside, outside] = [(&m.eta, 1.5), (&m.eta_outside, 1.0)].map(|(v, absent)| match v {
            Varying::Constant(index) => index.index(),
            Varying::Texture(_) => {
                self.tell(NO_INDICES);
                refraction::Index::Constant(absent)
            }
        });
        let eta = inside.at(refraction::MIDDLE) / outside.at(refraction::MIDDLE);
        let abbe = inside.abbe_number();
        let parts = !matches!(m.eta, Varying::Constant(Index::Constant(_))) && abbe.is_finite() && abbe > 0.0;
        if m.reflectance != Varying::Constant(Spectrum::grey(1.0)) {
            self.tell("tints of what glass reflects are left out");
        }
        let mut glass = Gltf {
            base_color: m.transmittance.clone(),
            metallic: Varying::Constant(0.0),
            roughness: self.root(&m.roughness, m.roughness_v.is_some()),
            transmission: Varying::Constant(1.0),
            ior: within(eta).into(),
            dispersion: if parts { 20.0 / abbe } else { 0.0 }.into(),
            relief: m.relief.clone(),
            ..Gltf::default()
        };
        if eta < 1.0 {
            self.tell("what is thinner than its surroundings is written as if it were like them");
        }
        self.fill(&mut glass, &m.interior);
        glass
    }

    /// Fills a clear material.
    fn fill(&mut self, glass: &mut Gltf, interior: &Interior) {
        glass.volume = true;
        if let Some(color) = &interior.attenuation_color {
            glass.attenuation_color = color.clone();
            glass.attenuation_distance = Some(interior.attenuation_distance);
        } else if let Some(sigma) = &interior.sigma_a {
            // What is left after a metre (Beer's law).
            let sigma = self.rgb(sigma, Quantity::Index);
            let left = sigma.map(|s| straal_math::ops::exp_d(-s));
            glass.attenuation_color = Spectrum::Rgb(LinearRgb(left));
            glass.attenuation_distance = Some(1.0);
        }
        if interior.priority != 0 {
            self.tell("priorities of clear materials are left out");
        }
    }

    fn plastic(&mut self, m: &Plastic) -> Gltf {
        self.tell("materials of the kind `plastic` are written as what is near to them in glTF");
        Gltf {
            base_color: m.reflectance.clone(),
            metallic: Varying::Constant(0.0),
            roughness: self.root(&m.roughness, false),
            ior: self.over([&m.eta, &m.eta_outside]),
            specular_color: m.specular.clone(),
            double_sided: m.two_sided,
            relief: m.relief.clone(),
            ..Gltf::default()
        }
    }

    fn open_pbr(&mut self, m: &OpenPbr) -> Gltf {
        self.tell("materials of the kind `open_pbr` are written as what is near to them in glTF");
        let shines = m.emission_luminance != Varying::Constant(0.0);
        Gltf {
            base_color: m.base_color.clone(),
            metallic: m.base_metalness.clone(),
            roughness: m.specular_roughness.clone(),
            emissive: if shines { m.emission_color.clone() } else { Varying::Constant(Spectrum::grey(0.0)) },
            emissive_strength: m.emission_luminance.clone(),
            alpha: m.geometry_opacity.clone(),
            ior: within(self.same(&m.specular_ior, 1.5)).into(),
            specular: m.specular_weight.clone(),
            specular_color: m.specular_color.clone(),
            clearcoat: m.coat_weight.clone(),
            clearcoat_roughness: m.coat_roughness.clone(),
            transmission: m.transmission_weight.clone(),
            volume: !m.geometry_thin_walled && m.transmission_weight != Varying::Constant(0.0),
            double_sided: m.two_sided,
            relief: m.relief.clone(),
            ..Gltf::default()
        }
    }

    /// A number that glTF has no texture for.
    pub(super) fn same(&mut self, v: &Varying<f64>, absent: f64) -> f64 {
        v.constant().copied().unwrap_or_else(|| {
            self.tell(NO_INDICES);
            absent
        })
    }

    /// An index of refraction over that outside.
    fn over(&mut self, [inside, outside]: [&Varying<f64>; 2]) -> Varying<f64> {
        within(self.same(inside, 1.5) / self.same(outside, 1.0)).into()
    }

    fn principled(&mut self, m: &Principled) -> Gltf {
        self.tell("materials of the kind `principled` are written as what is near to them in glTF");
        Gltf {
            base_color: m.base_color.clone(),
            metallic: m.metallic.clone(),
            roughness: m.roughness.clone(),
            ior: within(m.eta.as_ref().map_or(1.5, |eta| self.same(eta, 1.5))).into(),
            clearcoat: m.clearcoat.clone(),
            transmission: m.spec_trans.clone(),
            volume: m.spec_trans != Varying::Constant(0.0),
            double_sided: m.two_sided,
            relief: m.relief.clone(),
            ..Gltf::default()
        }
    }
}

/// What is said of what glTF has no texture for.
pub(super) const NO_INDICES: &str =
    "textures of indices of refraction, of dispersion and of how strongly something shines are left out";

/// A share from 0 to 1.
fn unit(v: f64) -> f64 {
    if v > 0.0 { if v < 1.0 { v } else { 1.0 } } else { 0.0 }
}

/// An index that glTF has.
fn within(ior: f64) -> f64 {
    if ior > 1.0 { if ior < 5.0 { ior } else { 5.0 } } else { 1.0 }
}

fn scaled(texture: ScaleTexture) -> Box<TextureOf> {
    Box::new(TextureOf::Inline(Texture::Scale(texture)))
}

fn tinted(of: Varying<Spectrum>, tint: Varying<Spectrum>) -> Varying<Spectrum> {
    Varying::Texture(scaled(ScaleTexture { of, by: 1.0.into(), tint }))
}

/// The product of two numbers.
fn both(a: &Varying<f64>, b: &Varying<f64>) -> Varying<f64> {
    let of = match a {
        Varying::Constant(v) => Varying::Constant(Spectrum::grey(*v)),
        Varying::Texture(texture) => Varying::Texture(texture.clone()),
    };
    Varying::Texture(scaled(ScaleTexture { of, by: b.clone(), ..ScaleTexture::default() }))
}

/// What is lit evenly where nothing else is said, as surfaces without a material are.
pub(super) fn unsaid() -> Material {
    Material::Diffuse(straal_scene::desc::Diffuse::default())
}

/// Whether a relief says anything but a map of normals.
pub(super) fn is_bumpy(relief: &Relief) -> bool {
    relief.bump.is_some()
}
