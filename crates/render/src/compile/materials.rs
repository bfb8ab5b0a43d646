//! Materials: from names and descriptions to an array.

use super::{CompileError, Custom};
use crate::lanes::Colour;
use crate::material::{self, Emission, Material};
use crate::paint::Paint;
use crate::relief::Relief;
use crate::texture::{MeshAttribute, Value};
use std::collections::HashMap;
use straal_scene::decode::Describe;
use straal_scene::desc::{self, MaterialRef};
use straal_scene::{Mesh, Scene};

/// The world's materials while it is built: the first is that of surfaces without one, then the scene's by their place in
/// it, then a program's own, then those that are written where they are used.
pub(super) struct Materials<'a> {
    scene: &'a Scene,
    paint: Paint<'a>,
    list: material::Materials,
    /// Where a material is, by what a scene would write of it.
    known: HashMap<String, u32>,
    custom: HashMap<String, u32>,
    /// Where the scene's are; a program's own of the same name stands in for one.
    scenes: Vec<u32>,
}

impl<'a> Materials<'a> {
    pub fn new(scene: &'a Scene, custom: &Custom, paint: Paint<'a>) -> Result<Self, CompileError> {
        let list = material::Materials::default();
        let mut all =
            Self { scene, paint, list, known: HashMap::new(), custom: HashMap::new(), scenes: Vec::new() };
        all.push(&desc::Material::Diffuse(desc::Diffuse::default()))?;
        for (_, m) in scene.materials.iter() {
            // They may be made of each other: first each gets its place.
            let index = all.list.push(Material::default());
            all.known.entry(key(m)).or_insert(index);
            all.scenes.push(index);
        }
        for (name, m) in &custom.materials {
            let index = all.list.push_custom(m.clone());
            all.custom.insert(name.clone(), index);
            if let Some(place) = scene.materials.handle(name) {
                all.scenes[place.index()] = index;
            }
        }
        for (place, (_, m)) in scene.materials.iter().enumerate() {
            let made = all.make(m)?;
            all.list.replace(place as u32 + 1, made);
            all.pretend(place as u32 + 1, m)?;
        }
        Ok(all)
    }

    pub fn finish(mut self) -> Result<(material::Materials, Paint<'a>), CompileError> {
        if !self.list.settle() {
            let message = format!("materials are made of one another, more than {} deep", material::DEEPEST);
            return Err(CompileError::new(message));
        }
        Ok((self.list, self.paint))
    }

    /// The share of light that meets a surface that glows, if that isn't all.
    pub fn opacity(&mut self, material: u32) -> Result<Option<Value<f32>>, CompileError> {
        if !self.list.any_may_pass() {
            return Ok(None);
        }
        self.list.settle();
        self.list.plain_opacity(material).map_err(|()| {
            CompileError::new(
                "a surface that glows may have a `mask` for its material, but none with a mask inside of another material",
            )
        })
    }

    /// What a material sends out by itself, and the material.
    pub fn shining(&self, material: u32) -> Option<(Emission, Box<Material>)> {
        let found = self.list.get(material as usize)?;
        Some((found.emission()?, Box::new(found.clone())))
    }

    /// Light that a surface sends out.
    pub fn emission(&mut self, s: &desc::Varying<desc::Spectrum>) -> Result<Value<Colour>, CompileError> {
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

    /// What textures may read of a mesh.
    pub fn attributes(&mut self, mesh: &Mesh) -> Vec<MeshAttribute> {
        self.paint.attributes(mesh)
    }

    /// Whether a material scatters along a tangent.
    pub fn wants_tangent(&self, material: u32) -> bool {
        self.list.wants(material).tangent
    }

    /// Whether a material may ask where it is: what is known of parts is handed on at the end only.
    pub fn wants_point(&self, material: u32) -> bool {
        self.list.wants(material).point || self.list.is_made_of_others(material)
    }

    pub fn named(&self, name: &str) -> Result<u32, CompileError> {
        let custom = self.custom.get(name).copied();
        custom
            .or_else(|| self.scene.materials.handle(name).map(|m| m.index() as u32 + 1))
            .ok_or_else(|| CompileError::new(format!("there is no material `{name}`")))
    }

    /// A material that has no name here; those that are written alike share a place.
    pub fn add(&mut self, m: &desc::Material) -> Result<u32, CompileError> {
        match self.known.get(&key(m)) {
            Some(&index) => Ok(index),
            None => self.push(m),
        }
    }

    /// A material, and those that it is made of.
    fn make(&mut self, m: &desc::Material) -> Result<Material, CompileError> {
        let parts =
            m.parts().into_iter().map(|part| self.of(Some(part), 0)).collect::<Result<Vec<_>, _>>()?;
        let mut made = Material::of(m, &mut self.paint)?;
        made.link(&parts);
        Ok(made)
    }

    /// A new place in the list; of several that are written alike the first is known.
    fn push(&mut self, m: &desc::Material) -> Result<u32, CompileError> {
        let made = self.make(m)?;
        let index = self.list.push(made);
        self.pretend(index, m)?;
        self.known.entry(key(m)).or_insert(index);
        Ok(index)
    }

    /// Gives a material the relief that is said of it.
    fn pretend(&mut self, index: u32, m: &desc::Material) -> Result<(), CompileError> {
        if let Some(relief) = Relief::of(m.relief(), &mut self.paint)? {
            self.list.pretend(index, relief);
        }
        Ok(())
    }
}

fn key(m: &desc::Material) -> String {
    m.write().to_string()
}
