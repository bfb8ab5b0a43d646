//! The world as far as it is made, and how it grows by a shape.

use super::materials::Materials;
use super::{Custom, Detail};
use crate::lanes::Colour;
use crate::light::links::{Linked, Names, Said};
use crate::light::{Groups, LightTable};
use crate::material::{self, Material};
use crate::paint::Paint;
use crate::shape::{Geometry, Shape};
use crate::surface::Alike;
use crate::texture::Value;
use crate::world::{GeometryRecord, INHERIT, Kind, TopLevel, UNPLACED};
use std::collections::BTreeMap;
use straal_accel as accel;
use straal_math::{Affine, DVec3, Transform};
use straal_scene::count::{self, Tally};
use straal_scene::desc::{self, Node};
use straal_scene::glow::{self, MOST_COPIES};
use straal_scene::{Assets, Handle, Scene};

/// A surface that glows.
pub(super) struct Glowing {
    pub kind: Kind,
    /// The group that it stands in.
    pub group: u32,
    pub radiance: Value<Colour>,
    /// The share of light that meets its material, if that isn't all.
    pub opacity: Option<Value<f32>>,
    /// The material that shines, if it isn't the surface.
    pub below: Option<Box<Material>>,
    pub two_sided: bool,
    pub flip: bool,
    /// Degrees of the cone that its light stays in.
    pub spread: f64,
    /// See [`crate::light::AreaLight::placement`].
    pub placement: Option<Transform>,
    /// The group of lights that it belongs to, and whom it lights.
    pub light_group: u16,
    pub said: Said,
    /// Whether it goes by the name of the lamp whose zones of shadow are shown.
    pub is_of_zones: bool,
    /// Whether the camera sees it.
    pub seen: bool,
}

/// What a surface sends out.
pub(super) struct Glow {
    pub radiance: Value<Colour>,
    pub below: Option<Box<Material>>,
    pub both_sides: bool,
}

impl Glow {
    /// Whether it isn't the same everywhere and in all directions.
    pub fn varies(&self, surface: &desc::Surface) -> bool {
        self.radiance.varies() || self.below.is_some() || surface.emission_spread < 180.0
    }
}

/// Bytes that a surface that glows takes while its world is made: itself, and the weights that it is chosen by.
pub const GLOWING_BYTES: usize = size_of::<Glowing>() + LightTable::MAKING_BYTES;

/// Where the walk is.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// From the present node to the group that it ends up in.
    pub transform: Affine,
    /// For what has none of its own.
    pub material: u32,
    pub group: u32,
    /// Within an object whose instance is dissolved, where names aren't for the camera.
    pub dissolved: bool,
}

pub(super) struct Build<'a> {
    pub scene: &'a Scene,
    pub assets: &'a Assets,
    pub materials: Materials<'a>,
    pub geometry: Geometry,
    pub input: accel::Input,
    pub geometries: Vec<GeometryRecord>,
    /// The node that each geometry comes from; none of a program's own.
    pub nodes: Vec<Option<&'a Node>>,
    /// The node that the walk is at.
    pub node: Option<&'a Node>,
    /// Nodes that can't be made.
    pub left_out: Vec<&'a Node>,
    /// Materials of each group's instances, by group.
    pub group_materials: Vec<Vec<u32>>,
    /// Groups of the objects met so far, and their names.
    pub objects: BTreeMap<Handle<Node>, (u32, &'a str)>,
    /// What of the scene glows.
    pub glow: glow::Glow<'a>,
    pub glowing: Vec<Glowing>,
    pub dissolved: u64,
    pub top_level: Vec<TopLevel>,
    /// What the camera is to be focused on, if that has a name.
    pub focus: Option<&'a str>,
    pub named: Vec<TopLevel>,
    /// From the description's space.
    pub to_world: Affine,
    pub detail: Detail,
    /// Within what the camera is focused on.
    pub in_focus: bool,
    /// See [`crate::world::World::placements`].
    pub placements: Vec<Transform>,
    /// The names that lamps say whom they light by, the bits of those that the walk is within, and of what is made.
    pub names: Names<'a>,
    pub within: u64,
    pub linked: Linked,
    /// The bit of the lamp whose zones of shadow are shown, if that has a name.
    pub of_zones: u64,
}

/// Lists with room for what is known to come, so that none leaves holes behind as it grows: there may be a light for each instance
/// of an object that glows.
fn room(t: &Tally) -> (Geometry, accel::Input, Vec<GeometryRecord>, Vec<Glowing>) {
    let of = |count: u64| count.min(4 * MOST_COPIES) as usize;
    let geometry = Geometry {
        shapes: Vec::with_capacity(of(t.shapes)),
        meshes: Vec::with_capacity(of(t.meshes)),
        ..Geometry::default()
    };
    let geometries = of(t.shapes.saturating_add(t.meshes));
    let input = accel::Input {
        groups: vec![accel::Group::default()],
        geometries: Vec::with_capacity(geometries),
        motions: Vec::new(),
    };
    (geometry, input, Vec::with_capacity(geometries), Vec::with_capacity(of(t.lights)))
}

/// What the walk leaves.
pub(super) struct Built<'a> {
    pub input: accel::Input,
    pub geometry: Geometry,
    pub geometries: Vec<GeometryRecord>,
    /// The node that each geometry comes from; none of a program's own.
    pub nodes: Vec<Option<&'a Node>>,
    /// Nodes that can't be made.
    pub left_out: Vec<&'a Node>,
    /// Names of objects, by their groups.
    pub objects: BTreeMap<u32, &'a str>,
    pub instance_materials: Vec<u32>,
    pub top_level: Vec<TopLevel>,
    /// What goes by the name that the camera is focused on.
    pub named: Vec<TopLevel>,
    pub glowing: Vec<Glowing>,
    pub materials: material::Materials,
    pub placements: Vec<Transform>,
    pub paint: Paint<'a>,
    pub light_groups: Groups,
    pub names: Names<'a>,
    pub linked: Linked,
}

impl<'a> Build<'a> {
    /// With this place of the description at the world's origin.
    pub fn new(
        scene: &'a Scene,
        assets: &'a Assets,
        custom: &Custom,
        (spectral, detail): (bool, Detail),
        centre: DVec3,
    ) -> Self {
        let (geometry, input, geometries, glowing) = room(&count::count(scene, assets).kept);
        let names = Names::of(scene);
        let of_zones = scene.lamp_of_zones().map_or(0, |lamp| names.bits(|name| *name == **lamp));
        Self {
            detail,
            in_focus: false,
            scene,
            assets,
            materials: Materials::new(scene, custom, Paint::new(scene, assets, (spectral, centre))),
            geometry,
            input,
            geometries,
            nodes: Vec::new(),
            node: None,
            left_out: Vec::new(),
            glow: glow::Glow::of(scene, assets),
            group_materials: vec![Vec::new()],
            objects: BTreeMap::new(),
            glowing,
            dissolved: 0,
            top_level: Vec::new(),
            focus: scene.camera.focus_on().map(|name| name.value.as_str()),
            named: Vec::new(),
            to_world: if centre == DVec3::ZERO { Affine::IDENTITY } else { Affine::translate(-centre) },
            placements: Vec::new(),
            names,
            of_zones,
            within: 0,
            linked: Linked { instances: vec![Vec::new()], ..Linked::default() },
        }
    }

    /// Geometries and instances that stand in the world's own group.
    pub fn in_world(&self) -> [usize; 2] {
        let world = &self.input.groups[0];
        [world.geometries.len(), world.instances.len()]
    }

    /// What came to the world's own group since it held so many.
    pub fn since(&self, before: [usize; 2]) -> TopLevel {
        let after = self.in_world();
        TopLevel { geometries: before[0]..after[0], instances: before[1]..after[1] }
    }

    pub fn finish(self) -> Built<'a> {
        let (materials, paint, groups) = self.materials.finish();
        Built {
            input: self.input,
            geometry: self.geometry,
            geometries: self.geometries,
            nodes: self.nodes,
            left_out: self.left_out,
            objects: self.objects.into_values().collect(),
            // The search structure numbers instances group by group, in this order.
            instance_materials: self.group_materials.concat(),
            top_level: self.top_level,
            named: self.named,
            glowing: self.glowing,
            materials,
            placements: self.placements,
            paint,
            light_groups: groups,
            names: self.names,
            linked: self.linked,
        }
    }

    /// What leaves the range of numbers only where it stands, or lacks something, isn't there, which is told.
    pub fn leave_out(&mut self) {
        self.left_out.extend(self.node);
    }

    /// Adds a shape that stands in its group's space.
    pub fn shape(&mut self, surface: &'a desc::Surface, place: Place, shape: Shape, flip: bool) {
        let material = self.materials.of(surface.material.as_ref(), place.material);
        let mut record = self.add_shape(shape, place, material, flip);
        let own = surface.emission.as_ref().map(|e| self.materials.emission(e));
        if let Some(glow) = self.glow_of(own, material) {
            record.emission_varies = glow.varies(surface);
            let lamp = (record.kind, material, flip);
            record.emitter = Some(self.glow(surface, lamp, glow, (place.group, &place.transform)));
        }
        self.geometries.push(record);
    }

    pub fn add_shape(&mut self, shape: Shape, place: Place, material: u32, flip: bool) -> GeometryRecord {
        let first = self.geometry.shapes.len() as u32;
        self.geometry.shapes.push(shape);
        self.add_geometry(place.group, accel::GeometryKind::Shapes { first, count: 1 });
        let placement = self.placement(&place.transform, material);
        let kind = Kind::Shapes(first);
        GeometryRecord {
            kind,
            material,
            emitter: None,
            emission_varies: false,
            flip,
            colours_at_corners: false,
            placement,
            alike: Alike::Apart,
        }
    }

    /// Where a thing's own coordinates lie in its group's, if anybody may ask.
    pub fn placement(&mut self, transform: &Affine, material: u32) -> u32 {
        let is_asked = material == INHERIT || self.materials.wants_point(material);
        let Some(transform) = Transform::new(transform).filter(|_| is_asked && !transform.is_identity())
        else {
            return UNPLACED;
        };
        // Parts of one thing come one after the other.
        if self.placements.last() != Some(&transform) {
            self.placements.push(transform);
        }
        (self.placements.len() - 1) as u32
    }

    pub fn add_geometry(&mut self, group: u32, kind: accel::GeometryKind) {
        let id = self.input.geometries.len() as u32;
        self.input.geometries.push(accel::Geometry { kind, mask: u32::MAX });
        self.nodes.push(self.node);
        self.linked.geometries.push(self.within);
        self.input.groups[group as usize].geometries.push(id);
    }

    /// The light of a surface: its own, else its material's.
    pub fn glow_of(&self, own: Option<Value<Colour>>, material: u32) -> Option<Glow> {
        if let Some(radiance) = own {
            return Some(Glow { radiance, below: None, both_sides: false });
        }
        let (emission, below) = self.materials.shining(material)?;
        Some(Glow { radiance: emission.radiance, below: Some(below), both_sides: emission.both_sides })
    }

    /// Makes a lamp of a surface of some material, that stands somewhere in a group; `flip` says whether its back shines.
    pub fn glow(
        &mut self,
        surface: &desc::Surface,
        (kind, material, flip): (Kind, u32, bool),
        glow: Glow,
        (group, place): (u32, &Affine),
    ) -> u32 {
        // It is that of the geometry that was added last.
        if let Some(geometry) = self.input.geometries.last_mut().filter(|_| !surface.lamp.seen) {
            geometry.mask = !crate::world::CAMERA;
        }
        self.glowing.push(Glowing {
            seen: surface.lamp.seen,
            kind,
            group,
            opacity: self.materials.opacity(material),
            below: glow.below,
            two_sided: surface.two_sided_emission || glow.both_sides,
            flip,
            spread: surface.emission_spread,
            placement: glowing_place(place, &glow.radiance),
            radiance: glow.radiance,
            light_group: self.materials.group_of(surface, material),
            said: self.names.said(&surface.lamp),
            is_of_zones: self.within & self.of_zones != 0,
        });
        (self.glowing.len() - 1) as u32
    }
}

/// Where the coordinates of what glows lie, if its radiance is read off a texture and they are others.
fn glowing_place(place: &Affine, radiance: &Value<Colour>) -> Option<Transform> {
    Transform::new(place).filter(|_| radiance.varies() && !place.is_identity())
}
