//! Materials: from names and colours to an array.

use super::paint::Paint;
use super::{CompileError, Custom};
use crate::lanes::Colour;
use crate::material::{self, Material};
use std::collections::BTreeMap;
use straal_scene::Scene;
use straal_scene::desc::{self, MaterialRef};

/// The world's materials while it is built: the first is that of surfaces without one, then the scene's by their place in
/// it, then a program's own, then those that are written where they are used.
pub(super) struct Materials<'a> {
    scene: &'a Scene,
    paint: Paint<'a>,
    list: material::Materials,
    custom: BTreeMap<String, u32>,
}

impl<'a> Materials<'a> {
    pub fn new(scene: &'a Scene, custom: &Custom, mut paint: Paint<'a>) -> Result<Self, CompileError> {
        let grey = paint.reflectance(&desc::Spectrum::grey(0.5))?.into();
        let default = Material::Diffuse { reflectance: grey, two_sided: true };
        let mut list = material::Materials::default();
        list.push(default);
        for (_, m) in scene.materials.iter() {
            list.push(paint.material(m)?);
        }
        let mut names = BTreeMap::new();
        for (name, m) in &custom.materials {
            names.insert(name.clone(), list.push_custom(m.clone()));
        }
        Ok(Self { scene, paint, list, custom: names })
    }

    pub fn finish(self) -> (material::Materials, Paint<'a>) {
        (self.list, self.paint)
    }

    /// Light that a surface sends out.
    pub fn emission(&mut self, s: &desc::Spectrum) -> Result<Colour, CompileError> {
        self.paint.emission(s)
    }

    /// The index of the material that a node names or describes; `default` when it does neither.
    pub fn of(&mut self, given: Option<&MaterialRef>, default: u32) -> Result<u32, CompileError> {
        match given {
            None => Ok(default),
            Some(MaterialRef::Named(name)) => {
                self.named(name).map_err(|e| CompileError::at(e.message, name.span))
            }
            Some(MaterialRef::Inline(m)) => self.add(m),
        }
    }

    pub fn named(&self, name: &str) -> Result<u32, CompileError> {
        let custom = self.custom.get(name).copied();
        custom
            .or_else(|| self.scene.materials.position(name).map(|i| i as u32 + 1))
            .ok_or_else(|| CompileError::new(format!("there is no material `{name}`")))
    }

    /// A material that has no name here; equal ones share a place.
    pub fn add(&mut self, m: &desc::Material) -> Result<u32, CompileError> {
        let m = self.paint.material(m)?;
        let known = self.list.iter().position(|other| *other == m).map(|i| i as u32);
        Ok(known.unwrap_or_else(|| self.list.push(m)))
    }
}
