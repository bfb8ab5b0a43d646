//! What of a scene glows: surfaces by an emission of their own, by that of their material, or by that of a mesh file's own materials.

use std::collections::{BTreeMap, BTreeSet};
use std::ptr;

use crate::Assets;
use crate::assets::PartMaterial;
use crate::decode::Describe;
use crate::desc::{Material, MaterialRef, Node, Scene, Spectrum, TextureOf, Varying};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::limit::Limit;
use crate::span::Span;
use crate::validate::DEEPEST;
use crate::value::{Link, Name};
use crate::visit::Visitor;

/// Most copies of what glows.
pub const MOST_COPIES: u64 = 1_000_000;

/// What of a scene glows.
pub struct Glow<'a> {
    scene: &'a Scene,
    assets: &'a Assets,
    /// Whether each object does.
    objects: Vec<bool>,
}

impl<'a> Glow<'a> {
    /// Finds out.
    pub fn of(scene: &'a Scene, assets: &'a Assets) -> Self {
        let mut glow = Self { scene, assets, objects: vec![false; scene.objects.len()] };
        // What is in an object is known a round later than what it shows.
        for _ in 0..=DEEPEST {
            let found: Vec<bool> = scene.objects.iter().map(|(_, object)| glow.node(object)).collect();
            if found == glow.objects {
                break;
            }
            glow.objects = found;
        }
        glow
    }

    /// Whether an object glows, wherever it stands.
    pub fn object(&self, link: &Link<Node>) -> bool {
        link.to().and_then(|to| self.objects.get(to.index())).copied().unwrap_or(false)
    }

    /// Whether a node glows, or anything in it. What it takes from around it, a material that shines, doesn't count.
    pub fn node(&self, node: &Node) -> bool {
        let has_light = self.material(node.material());
        match node {
            Node::Group(g) => has_light || g.children.iter().any(|child| self.node(child)),
            Node::Instance(i) => has_light || self.object(&i.of),
            Node::Instances(i) => has_light || self.object(&i.of),
            surface => {
                let own = surface.surface().is_some_and(|s| s.emission.is_some());
                let inside = surface.children().iter().any(|child| self.node(child));
                own || inside
                    || has_light
                    || self.parts(surface).any(|p| p.emission.is_some() || p.material.shines())
            }
        }
    }

    /// Whether a material shines.
    pub fn material(&self, given: Option<&MaterialRef>) -> bool {
        given.and_then(|given| resolved(self.scene, given)).is_some_and(Material::shines)
    }

    /// The materials that a mesh has of its file.
    fn parts(&self, node: &Node) -> impl Iterator<Item = &'a PartMaterial> + use<'a> {
        let file = if let Node::Mesh(m) = node { m.file.as_ref() } else { None };
        let mesh = file.map(|file| self.assets.mesh(file.handle));
        mesh.into_iter().flat_map(|mesh| mesh.materials.values())
    }
}

/// The material that is meant.
fn resolved<'s>(scene: &'s Scene, given: &'s MaterialRef) -> Option<&'s Material> {
    match given {
        MaterialRef::Inline(material) => Some(material),
        MaterialRef::Named(link) => scene.materials.of(link),
    }
}

/// Complains of what may not glow as the scene wants it to.
pub(crate) fn validate(scene: &Scene, assets: &Assets, d: &mut Diagnostics) {
    let glow = Glow::of(scene, assets);
    if !copies(&glow, d) {
        return;
    }
    let mut walk = Surfaces { glow, seen: BTreeSet::new(), d };
    for node in &scene.world {
        walk.node(node, None);
    }
}

/// Complains of too many copies of what glows; whether there aren't.
fn copies(glow: &Glow<'_>, d: &mut Diagnostics) -> bool {
    let mut count = Copies { glow, known: BTreeMap::new() };
    let mut all = 0_u64;
    for node in &glow.scene.world {
        all = all.saturating_add(count.node(node, false));
        if all > MOST_COPIES {
            let mut span = Span::NONE;
            node.visit(&mut |n| {
                if let Some(of) = n.object() {
                    span = of.name.span;
                }
            });
            let message = format!(
                "more than {MOST_COPIES} instances of objects that glow, which are too many to choose among"
            );
            d.push(Diagnostic::error(span, message));
            return false;
        }
    }
    true
}

/// Counts instances that are copies of all that is in their objects, since these glow.
struct Copies<'g, 'a> {
    glow: &'g Glow<'a>,
    /// How many there are in objects, by whether the material around these shines.
    known: BTreeMap<(usize, bool), u64>,
}

impl Copies<'_, '_> {
    /// Of an instance of an object.
    fn instances(&mut self, of: &Link<Node>, is_lit: bool) -> u64 {
        let Some(to) = of.to().filter(|_| is_lit || self.glow.object(of)) else { return 0 };
        let inside = match self.known.get(&(to.index(), is_lit)) {
            Some(known) => *known,
            None => {
                // One that contains itself ends here.
                self.known.insert((to.index(), is_lit), 0);
                let found = self.glow.scene.objects.of(of).map_or(0, |o| self.node(o, is_lit));
                self.known.insert((to.index(), is_lit), found);
                found
            }
        };
        inside.saturating_add(1)
    }

    fn node(&mut self, node: &Node, is_lit: bool) -> u64 {
        let is_lit = node.material().map_or(is_lit, |material| self.glow.material(Some(material)));
        match node {
            Node::Group(g) => {
                g.children.iter().fold(0, |sum, child| sum.saturating_add(self.node(child, is_lit)))
            }
            Node::Instance(i) => self.instances(&i.of, is_lit),
            Node::Instances(i) => self.instances(&i.of, is_lit).saturating_mul(i.transforms.len() as u64),
            _ => 0,
        }
    }
}

/// Looks at all surfaces with the materials that they have where they stand.
struct Surfaces<'d, 'a> {
    glow: Glow<'a>,
    /// Objects that were looked at, with the material around them.
    seen: BTreeSet<(usize, *const MaterialRef)>,
    d: &'d mut Diagnostics,
}

impl<'a> Surfaces<'_, 'a> {
    fn node(&mut self, node: &'a Node, around: Option<&'a MaterialRef>) {
        let scene = self.glow.scene;
        let given = node.material().or(around);
        match node {
            Node::Group(g) => g.children.iter().for_each(|child| self.node(child, given)),
            Node::Instance(_) | Node::Instances(_) => {
                let of = node.object();
                let found = of.and_then(|of| of.to().zip(scene.objects.of(of)));
                let Some((to, object)) = found else { return };
                if self.seen.insert((to.index(), given.map_or(ptr::null(), ptr::from_ref))) {
                    self.node(object, given);
                }
            }
            surface => {
                surface.children().iter().for_each(|child| self.node(child, given));
                let own = surface.surface().and_then(|s| s.emission.as_ref());
                let material = given.and_then(|given| resolved(scene, given));
                self.surface(surface, own, material);
                if surface.material().is_none() {
                    for part in self.glow.parts(surface) {
                        let is_lit = own.is_some() || part.emission.is_some() || part.material.shines();
                        self.holes(surface, is_lit, &part.material);
                    }
                }
            }
        }
    }

    fn surface(&mut self, node: &Node, own: Option<&Varying<Spectrum>>, material: Option<&'a Material>) {
        let shining = material.and_then(Material::emission);
        if let Some(material) = material {
            self.holes(node, own.is_some() || shining.is_some(), material);
        }
        let Some(Varying::Texture(texture)) = own.or(shining) else { return };
        let mut uses = Attributes { scene: self.glow.scene, numbers: 0, found: None, seen: BTreeSet::new() };
        uses.of(texture);
        if let Some(name) = uses.found {
            let message = "an emission can't be read off the vertices or faces of a mesh yet";
            self.d.push(Diagnostic::error(name.span, message));
        }
    }

    /// A surface that glows may have a mask for its material, but none with a mask inside of another material.
    fn holes(&mut self, node: &Node, glows: bool, material: &Material) {
        let scene = self.glow.scene;
        let is_plain = match material {
            Material::Mask(m) => resolved(scene, &m.material).is_none_or(|inner| !has_holes(scene, inner, 0)),
            other => !has_holes(scene, other, 0),
        };
        if glows && !is_plain {
            let message = "a surface that glows may have a `mask` for its material, but none with a mask inside of another material";
            self.d.push(Diagnostic::error(node.transform().span, message));
        }
    }
}

/// Whether a material or any that it is made of is there for a part of what meets it only.
fn has_holes(scene: &Scene, material: &Material, depth: usize) -> bool {
    let inside =
        |part: &MaterialRef| resolved(scene, part).is_some_and(|part| has_holes(scene, part, depth + 1));
    material.has_holes() || depth < crate::materials::DEEPEST && material.parts().into_iter().any(inside)
}

/// Looks for what is read of meshes where a colour is wanted.
struct Attributes<'a> {
    scene: &'a Scene,
    /// How many textures that are read as numbers are open.
    numbers: u32,
    found: Option<&'a Name>,
    /// Textures of the scene that were looked into.
    seen: BTreeSet<usize>,
}

impl<'a> Attributes<'a> {
    fn of(&mut self, texture: &'a TextureOf) {
        texture.show(Limit::FINITE, self);
    }
}

impl<'a> Visitor<'a> for Attributes<'a> {
    fn texture(&mut self, _: &'a TextureOf, _: Limit, is_number: bool) {
        // Once in what is read as a number, all of it is.
        self.numbers += u32::from(is_number || self.numbers > 0);
    }

    fn end_of_texture(&mut self) {
        self.numbers = self.numbers.saturating_sub(1);
    }

    fn texture_name(&mut self, link: &'a Link<crate::desc::Texture>) {
        let Some((to, texture)) = link.to().zip(self.scene.textures.of(link)) else { return };
        if self.numbers == 0 && self.seen.insert(to.index()) {
            texture.show(Limit::FINITE, self);
        }
    }

    fn attribute(&mut self, name: &'a Name) {
        if self.numbers == 0 {
            self.found = self.found.or(Some(name));
        }
    }
}
