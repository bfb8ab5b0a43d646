//! Looking through a description without knowing what is in it.
//!
//! [`Describe::show`] comes from the same definition as reading and writing does: a new key of a new
//! material is seen by all who look for colours, without a list of colours that anyone has to keep.

use std::collections::BTreeSet;

use crate::Bitmap;
use crate::decode::Describe;
use crate::desc::{Material, MaterialRef, Scene, Spectrum, Texture, TextureOf};
use crate::limit::Limit;
use crate::value::{Asset, Link, Name};

/// Is shown the values of a description, in the order of its keys.
pub trait Visitor<'a> {
    /// A colour, and what its numbers must be within.
    fn spectrum(&mut self, _spectrum: &'a Spectrum, _limit: Limit) {}

    /// What a value is read off, which is shown next; what its numbers must be within, and whether one number is wanted and no colour.
    fn texture(&mut self, _texture: &'a TextureOf, _limit: Limit, _is_number: bool) {}

    /// After what was shown of it.
    fn end_of_texture(&mut self) {}

    /// The name of a texture that is used.
    fn texture_name(&mut self, _name: &'a Link<Texture>) {}

    /// A material that is used or that one is made of; whether what is written there is shown as well.
    fn material(&mut self, _material: &'a MaterialRef) -> bool {
        true
    }

    /// The name of what meshes have at their vertices or on their faces, and a texture reads.
    fn attribute(&mut self, _name: &'a Name) {}

    /// The name of texture coordinates that a mapping takes of meshes; it was shown as an attribute before.
    fn coordinates(&mut self, _name: &'a Name) {}

    /// The name of a group of lights.
    fn light_group(&mut self, _name: &'a Name) {}

    /// A picture that a texture is read off.
    fn bitmap(&mut self, _bitmap: &'a Asset<Bitmap>) {}
}

/// A list of colours.
impl<'a> Visitor<'a> for Vec<(&'a Spectrum, Limit)> {
    fn spectrum(&mut self, spectrum: &'a Spectrum, limit: Limit) {
        self.push((spectrum, limit));
    }
}

/// A list of pictures.
impl<'a> Visitor<'a> for Vec<&'a Asset<Bitmap>> {
    fn bitmap(&mut self, bitmap: &'a Asset<Bitmap>) {
        self.push(bitmap);
    }
}

/// A list of attributes.
struct Attributes<'a>(Vec<&'a Name>);

impl<'a> Visitor<'a> for Attributes<'a> {
    fn attribute(&mut self, name: &'a Name) {
        self.0.push(name);
    }
}

/// A list of texture coordinates by name, and the textures and materials that are named on the way.
#[derive(Default)]
struct Coordinates<'a> {
    found: Vec<&'a Name>,
    textures: Vec<&'a Link<Texture>>,
    materials: Vec<&'a Link<Material>>,
}

impl<'a> Visitor<'a> for Coordinates<'a> {
    fn coordinates(&mut self, name: &'a Name) {
        self.found.push(name);
    }

    fn texture_name(&mut self, name: &'a Link<Texture>) {
        self.textures.push(name);
    }

    fn material(&mut self, material: &'a MaterialRef) -> bool {
        if let MaterialRef::Named(link) = material {
            self.materials.push(link);
        }
        true
    }
}

impl Scene {
    /// The texture coordinates, by name, that a material wants of the meshes it lies on, besides their own.
    pub fn coordinates_of<'a>(&'a self, material: &'a Material) -> Vec<&'a Name> {
        let mut all = Coordinates::default();
        material.show(Limit::FINITE, &mut all);
        // Each once: they may be made of one another.
        let (mut textures, mut materials) = (BTreeSet::new(), BTreeSet::new());
        loop {
            if let Some(handle) = all.textures.pop().map(Link::to) {
                let found =
                    handle.filter(|handle| textures.insert(*handle)).and_then(|h| self.textures.at(h));
                found.into_iter().for_each(|(_, texture)| texture.show(Limit::FINITE, &mut all));
            } else if let Some(handle) = all.materials.pop().map(Link::to) {
                let found =
                    handle.filter(|handle| materials.insert(*handle)).and_then(|h| self.materials.at(h));
                found.into_iter().for_each(|(_, material)| material.show(Limit::FINITE, &mut all));
            } else {
                return all.found;
            }
        }
    }

    /// The texture coordinates, by name, that any texture wants of meshes, besides their own.
    pub fn coordinates(&self) -> Vec<&Name> {
        let mut all = Coordinates::default();
        self.show(Limit::FINITE, &mut all);
        all.found
    }

    /// What textures read of meshes, by name, with repetitions.
    pub fn attributes(&self) -> Vec<&Name> {
        let mut found = Attributes(Vec::new());
        self.show(Limit::FINITE, &mut found);
        found.0
    }

    /// The pictures that textures are read off, with repetitions.
    pub fn bitmap_files(&self) -> Vec<&Asset<Bitmap>> {
        let mut found = Vec::new();
        self.show(Limit::FINITE, &mut found);
        found
    }

    /// Every colour of the scene, with what its numbers must be within.
    pub fn spectra(&self) -> Vec<(&Spectrum, Limit)> {
        let mut found = Vec::new();
        self.show(Limit::FINITE, &mut found);
        found
    }
}

#[cfg(test)]
mod tests {
    use crate::decode::Describe;
    use crate::desc::{Material, Spectrum};
    use crate::limit::Limit;

    #[test]
    fn all_colours_are_found() {
        let conductor = Material::Conductor(crate::desc::Conductor {
            eta: Some(Spectrum::grey(0.2).into()),
            k: Some(Spectrum::grey(3.0).into()),
            ..crate::desc::Conductor::default()
        });
        let glass = Material::Dielectric(crate::desc::Dielectric::default());
        let mut found: Vec<(&Spectrum, Limit)> = Vec::new();
        conductor.show(Limit::FINITE, &mut found);
        glass.show(Limit::FINITE, &mut found);
        let limits: Vec<Limit> = found.iter().map(|(_, limit)| *limit).collect();
        assert_eq!(limits, [Limit::NON_NEGATIVE, Limit::NON_NEGATIVE, Limit::UNIT, Limit::UNIT, Limit::UNIT]);
    }
}
