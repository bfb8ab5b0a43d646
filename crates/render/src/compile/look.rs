//! Materials: from names and colours to an array.

use super::paint::Paint;
use super::{CompileError, Custom};
use crate::lanes::Colour;
use crate::material::{self, Material};
use std::collections::BTreeMap;
use straal_scene::Scene;
use straal_scene::desc::{self, MaterialRef};
use straal_scene::value::Name;

/// The world's materials while it is built: the first is that of surfaces without one, then the scene's by their place in
/// it, then a program's own, then those that are written where they are used.
pub(super) struct Materials<'a> {
    scene: &'a Scene,
    paint: Paint<'a>,
    list: material::Materials,
    custom: BTreeMap<String, u32>,
    /// Where the scene's are; a program's own of the same name stands in for one.
    scenes: Vec<u32>,
}

impl<'a> Materials<'a> {
    pub fn new(scene: &'a Scene, custom: &Custom, mut paint: Paint<'a>) -> Result<Self, CompileError> {
        let grey = paint.reflectance(&desc::Spectrum::grey(0.5))?.into();
        let default = Material::Diffuse { reflectance: grey, two_sided: true };
        let mut list = material::Materials { list: vec![default], custom: vec![] };
        for (_, m) in scene.materials.iter() {
            list.list.push(paint.material(m)?);
        }
        let mut names = BTreeMap::new();
        for (i, (name, m)) in custom.materials.iter().enumerate() {
            names.insert(name.clone(), list.list.len() as u32);
            list.list.push(Material::Custom(i as u32));
            list.custom.push(m.clone());
        }
        let place = |(i, name): (usize, &Name)| names.get(&name.value).copied().unwrap_or(i as u32 + 1);
        let scenes = scene.materials.iter().map(|(name, _)| name).enumerate().map(place).collect();
        Ok(Self { scene, paint, list, custom: names, scenes })
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
            // A scene without errors leads everywhere.
            Some(MaterialRef::Named(link)) => {
                Ok(link.to().and_then(|m| self.scenes.get(m.index())).copied().unwrap_or(default))
            }
            Some(MaterialRef::Inline(m)) => self.add(m),
        }
    }

    pub fn named(&self, name: &str) -> Result<u32, CompileError> {
        let custom = self.custom.get(name).copied();
        custom
            .or_else(|| self.scene.materials.handle(name).map(|m| m.index() as u32 + 1))
            .ok_or_else(|| CompileError::new(format!("there is no material `{name}`")))
    }

    /// A material that has no name here; equal ones share a place.
    pub fn add(&mut self, m: &desc::Material) -> Result<u32, CompileError> {
        let m = self.paint.material(m)?;
        let known = self.list.list.iter().position(|other| *other == m);
        Ok(known.unwrap_or_else(|| {
            self.list.list.push(m);
            self.list.list.len() - 1
        }) as u32)
    }
}
