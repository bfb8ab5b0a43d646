//! Materials: from names and colours to an array.

use super::{CompileError, Custom};
use crate::material::{self, Material, Value};
use std::collections::BTreeMap;
use straal_color::Light;
use straal_scene::Scene;
use straal_scene::desc::{self, MaterialRef};
use straal_scene::value::{self, Color};

/// The world's materials while it is built: the first is that of surfaces without one, then the scene's by their place in
/// it, then a program's own, then those that are written where they are used.
pub(super) struct Materials<'a> {
    scene: &'a Scene,
    list: material::Materials,
    custom: BTreeMap<String, u32>,
}

impl<'a> Materials<'a> {
    pub fn new(scene: &'a Scene, custom: &Custom) -> Self {
        let default = Material::Diffuse { reflectance: colour(Color::grey(0.5)).into(), two_sided: true };
        let named = scene.materials.iter().map(|(_, m)| convert(m));
        let mut list =
            material::Materials { list: std::iter::once(default).chain(named).collect(), custom: vec![] };
        let mut names = BTreeMap::new();
        for (i, (name, m)) in custom.materials.iter().enumerate() {
            names.insert(name.clone(), list.list.len() as u32);
            list.list.push(Material::Custom(i as u32));
            list.custom.push(m.clone());
        }
        Self { scene, list, custom: names }
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
        let m = convert(m);
        let known = self.list.list.iter().position(|other| *other == m);
        known.unwrap_or_else(|| {
            self.list.list.push(m);
            self.list.list.len() - 1
        }) as u32
    }
}

/// A colour of the scene as light.
pub(super) fn colour(c: Color) -> Light {
    Light::rgb(c.0.map(|v| v as f32))
}

fn convert(m: &desc::Material) -> Material {
    let colour = |v: &value::Value<Color>| -> Value<Light> { colour(v.constant()).into() };
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
            eta: colour(&d.eta),
            k: colour(&d.k),
            roughness: number(&d.roughness),
            reflectance: colour(&d.reflectance),
            two_sided: d.two_sided,
        },
    }
}
