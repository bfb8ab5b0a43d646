//! Materials: from names and colours to an array.

use super::{CompileError, Custom};
use crate::material::{self, Material, Value};
use std::borrow::Cow;
use std::collections::BTreeMap;
use straal_color::{Light, Matrix3, Space};
use straal_scene::desc::{self, MaterialRef};
use straal_scene::value::{self, Color};
use straal_scene::{Image, Scene};

/// The world's materials while it is built: the first is that of surfaces without one, then the scene's by their place in
/// it, then a program's own, then those that are written where they are used.
pub(super) struct Materials<'a> {
    scene: &'a Scene,
    to_work: ToWork,
    list: material::Materials,
    custom: BTreeMap<String, u32>,
}

impl<'a> Materials<'a> {
    pub fn new(scene: &'a Scene, custom: &Custom) -> Self {
        let to_work = ToWork::of(scene);
        let grey = to_work.colour(Color::grey(0.5)).into();
        let default = Material::Diffuse { reflectance: grey, two_sided: true };
        let named = scene.materials.iter().map(|(_, m)| to_work.material(m));
        let mut list =
            material::Materials { list: std::iter::once(default).chain(named).collect(), custom: vec![] };
        let mut names = BTreeMap::new();
        for (i, (name, m)) in custom.materials.iter().enumerate() {
            names.insert(name.clone(), list.list.len() as u32);
            list.list.push(Material::Custom(i as u32));
            list.custom.push(m.clone());
        }
        Self { scene, to_work, list, custom: names }
    }

    pub fn finish(self) -> material::Materials {
        self.list
    }

    /// The index of the material that a node names or describes; `default` when it does neither.
    pub fn of(&mut self, given: Option<&MaterialRef>, default: u32) -> Result<u32, CompileError> {
        match given {
            None => Ok(default),
            Some(MaterialRef::Named(name)) => {
                self.named(name).map_err(|e| CompileError::at(e.message, name.span))
            }
            Some(MaterialRef::Inline(m)) => Ok(self.add(m)),
        }
    }

    pub fn named(&self, name: &str) -> Result<u32, CompileError> {
        let custom = self.custom.get(name).copied();
        custom
            .or_else(|| self.scene.materials.position(name).map(|i| i as u32 + 1))
            .ok_or_else(|| CompileError::new(format!("there is no material `{name}`")))
    }

    /// A material that has no name here; equal ones share a place.
    pub fn add(&mut self, m: &desc::Material) -> u32 {
        let m = self.to_work.material(m);
        let known = self.list.list.iter().position(|other| *other == m);
        known.unwrap_or_else(|| {
            self.list.list.push(m);
            self.list.list.len() - 1
        }) as u32
    }
}

/// How colours of the scene become light: in the scene's work space.
#[derive(Clone, Copy, Debug)]
pub(super) struct ToWork {
    /// `None` where linear sRGB is the work space itself.
    matrix: Option<Matrix3>,
}

impl ToWork {
    pub fn of(scene: &Scene) -> Self {
        let space = scene.color.space.space();
        Self { matrix: (space != Space::Srgb).then(|| Space::Srgb.to(space)) }
    }

    /// A colour of the scene as light. What is a hair below 0 by rounding is 0.
    pub fn colour(&self, c: Color) -> Light {
        let rgb = self.matrix.map_or(c.0, |m| m.apply(c.0));
        Light::rgb(rgb.map(|v| if v < 0.0 { 0.0 } else { v as f32 }))
    }

    /// A picture of radiance.
    pub fn image<'a>(&self, image: &'a Image) -> Cow<'a, Image> {
        let Some(m) = &self.matrix else { return Cow::Borrowed(image) };
        Cow::Owned(Image { pixels: image.pixels.iter().map(|p| m.apply_f32(*p)).collect(), ..*image })
    }

    fn material(&self, m: &desc::Material) -> Material {
        let colour = |v: &value::Value<Color>| -> Value<Light> { self.colour(v.constant()).into() };
        // Indices of refraction are no colours: they are those of red, green and blue in any space.
        let index =
            |v: &value::Value<Color>| -> Value<Light> { Light::rgb(v.constant().0.map(|v| v as f32)).into() };
        let number = |v: &value::Value<f64>| -> Value<f32> { (v.constant() as f32).into() };
        match m {
            desc::Material::Diffuse(d) => {
                Material::Diffuse { reflectance: colour(&d.reflectance), two_sided: d.two_sided }
            }
            desc::Material::Mirror(d) => {
                Material::Mirror { reflectance: colour(&d.reflectance), two_sided: d.two_sided }
            }
            desc::Material::Dielectric(d) => Material::Dielectric {
                eta: number(&d.eta),
                eta_outside: number(&d.eta_outside),
                reflectance: colour(&d.reflectance),
                transmittance: colour(&d.transmittance),
            },
            desc::Material::Conductor(d) => Material::Conductor {
                eta: index(&d.eta),
                k: index(&d.k),
                roughness: number(&d.roughness),
                reflectance: colour(&d.reflectance),
                two_sided: d.two_sided,
            },
        }
    }
}
