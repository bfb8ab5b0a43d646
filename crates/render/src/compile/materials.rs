//! Materials: from names and descriptions to an array.

use super::Custom;
use crate::lanes::Colour;
use crate::light::Groups;
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
    /// What of the scene's lights is told apart, and the group that each material says.
    groups: Groups,
    of_group: HashMap<u32, u16>,
    /// Where the scene's are; a program's own of the same name stands in for one.
    scenes: Vec<u32>,
}

impl<'a> Materials<'a> {
    /// Tells something of the scene, once.
    pub fn note(&mut self, note: String) {
        if !self.paint.notes.contains(&note) {
            self.paint.notes.push(note);
        }
    }

    pub fn new(scene: &'a Scene, custom: &Custom, paint: Paint<'a>) -> Self {
        let list = material::Materials::default();
        let mut all = Self {
            scene,
            paint,
            list,
            known: HashMap::new(),
            custom: HashMap::new(),
            groups: Groups::of_scene(scene),
            of_group: HashMap::new(),
            scenes: Vec::new(),
        };
        all.push(&desc::Material::Diffuse(desc::Diffuse::default()));
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
            let made = all.make(m);
            all.list.replace(place as u32 + 1, made);
            all.pretend(place as u32 + 1, m);
        }
        all
    }

    pub fn finish(mut self) -> (material::Materials, Paint<'a>, Groups) {
        self.list.settle();
        (self.list, self.paint, self.groups)
    }

    /// The group of lights of a surface that glows: its own, else that of its material.
    pub fn group_of(&self, surface: &desc::Surface, material: u32) -> u16 {
        match &surface.lamp.light_group {
            Some(own) => self.groups.number(Some(own)),
            None => self.of_group.get(&material).copied().unwrap_or(0),
        }
    }

    /// The share of light that meets a surface that glows, if that isn't all.
    pub fn opacity(&mut self, material: u32) -> Option<Value<f32>> {
        if !self.list.any_may_pass() {
            return None;
        }
        self.list.settle();
        self.list.plain_opacity(material)
    }

    /// Whether light may pass through a material as if nothing were there.
    pub fn has_holes(&mut self, material: u32) -> bool {
        if !self.list.any_may_pass() {
            return false;
        }
        self.list.settle();
        self.list.may_pass(material)
    }

    /// What a material sends out by itself, and the material.
    pub fn shining(&self, material: u32) -> Option<(Emission, Box<Material>)> {
        let found = self.list.get(material as usize)?;
        Some((found.emission()?, Box::new(found.clone())))
    }

    /// Light that a surface sends out.
    pub fn emission(&mut self, s: &desc::Varying<desc::Spectrum>) -> Value<Colour> {
        self.paint.emission(s)
    }

    /// The index of the material that a node names or describes; `default` when it does neither.
    pub fn of(&mut self, given: Option<&MaterialRef>, default: u32) -> u32 {
        match given {
            None => default,
            // A scene without errors leads everywhere.
            Some(MaterialRef::Named(link)) => {
                link.to().and_then(|m| self.scenes.get(m.index())).copied().unwrap_or(default)
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

    /// Whether a material has a map that tells normals about the way its surface runs.
    pub fn maps_normals(&self, material: u32) -> bool {
        let relief = self.list.relief(material);
        relief.and_then(|relief| relief.normals).is_some_and(|map| !map.of_object)
    }

    /// Whether a material may ask where it is: what is known of parts is handed on at the end only.
    pub fn wants_point(&self, material: u32) -> bool {
        self.list.wants(material).point || self.list.is_made_of_others(material)
    }

    /// The material that a program's own shape names; that of surfaces without one where there is none of that name.
    pub fn named(&self, name: &str) -> u32 {
        let custom = self.custom.get(name).copied();
        custom.or_else(|| self.scene.materials.handle(name).map(|m| m.index() as u32 + 1)).unwrap_or(0)
    }

    /// A material that has no name here; those that are written alike share a place.
    pub fn add(&mut self, m: &desc::Material) -> u32 {
        match self.known.get(&key(m)) {
            Some(&index) => index,
            None => self.push(m),
        }
    }

    /// A material, and those that it is made of.
    fn make(&mut self, m: &desc::Material) -> Material {
        let parts = m.parts().into_iter().map(|part| self.of(Some(part), 0)).collect::<Vec<_>>();
        let mut made = Material::of(m, &mut self.paint);
        made.link(&parts);
        made
    }

    /// A new place in the list; of several that are written alike the first is known.
    fn push(&mut self, m: &desc::Material) -> u32 {
        let made = self.make(m);
        let index = self.list.push(made);
        self.pretend(index, m);
        self.known.entry(key(m)).or_insert(index);
        index
    }

    /// Gives a material the relief that is said of it, and takes note of its group of lights.
    fn pretend(&mut self, index: u32, m: &desc::Material) {
        if let Some(group) = m.light_group() {
            self.of_group.insert(index, self.groups.number(Some(group)));
        }
        if let Some(relief) = Relief::of(m.relief(), &mut self.paint) {
            self.list.pretend(index, relief);
        }
    }
}

fn key(m: &desc::Material) -> String {
    m.write().to_string()
}
