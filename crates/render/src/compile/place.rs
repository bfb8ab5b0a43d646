//! The walk over the tree of the world.

use super::materials::Materials;
use super::{Custom, Detail};
use crate::lanes::Colour;
use crate::light::LightTable;
use crate::material::{self, Material};
use crate::paint::Paint;
use crate::shape::{Cylinder, Disc, Ellipsoid, Geometry, Parallelogram, Plane, Shape, Sphere, TriangleMesh};
use crate::shape::{bezier, smooth::smooth};
use crate::texture::Value;
use crate::world::{GeometryRecord, INHERIT, Kind, TopLevel, UNPLACED};
use std::collections::BTreeMap;
use std::sync::Arc;
use straal_accel as accel;
use straal_math::{Affine, DVec3, Transform, Vec3};
use straal_scene::count::{self, Tally};
use straal_scene::desc::{self, MeshSource, Node, Shading};
use straal_scene::glow::{self, MOST_COPIES};
use straal_scene::mesh::Per;
use straal_scene::{Assets, Handle, Mesh, Part, PartMaterial, Scene};

/// Quads along a patch's edge in a draft.
const DRAFT: u32 = 4;

/// A surface that glows.
pub(super) struct Glowing {
    pub kind: Kind,
    pub radiance: Value<Colour>,
    /// The share of light that meets its material, if that isn't all.
    pub opacity: Option<Value<f32>>,
    /// The material that shines, if it isn't the surface.
    pub below: Option<Box<Material>>,
    pub two_sided: bool,
    pub flip: bool,
    /// See [`crate::light::AreaLight::placement`].
    pub placement: Option<Transform>,
}

/// What a surface sends out.
struct Glow {
    radiance: Value<Colour>,
    below: Option<Box<Material>>,
    both_sides: bool,
}

/// Bytes that a surface that glows takes while its world is made: itself, and the weights that it is chosen by.
pub const GLOWING_BYTES: usize = size_of::<Glowing>() + LightTable::MAKING_BYTES;

/// Where the walk is.
#[derive(Clone, Copy)]
struct Place {
    /// From the present node to the group that it ends up in.
    transform: Affine,
    /// For what has none of its own.
    material: u32,
    group: u32,
    /// Within an object whose instance is dissolved, where names aren't for the camera.
    dissolved: bool,
}

pub(super) struct Build<'a> {
    scene: &'a Scene,
    assets: &'a Assets,
    materials: Materials<'a>,
    geometry: Geometry,
    input: accel::Input,
    geometries: Vec<GeometryRecord>,
    /// The node that each geometry comes from; none of a program's own.
    nodes: Vec<Option<&'a Node>>,
    /// The node that the walk is at.
    node: Option<&'a Node>,
    /// Nodes that can't be made.
    left_out: Vec<&'a Node>,
    /// Materials of each group's instances, by group.
    group_materials: Vec<Vec<u32>>,
    /// Groups of the objects met so far, and their names.
    objects: BTreeMap<Handle<Node>, (u32, &'a str)>,
    /// What of the scene glows.
    glow: glow::Glow<'a>,
    glowing: Vec<Glowing>,
    dissolved: u64,
    top_level: Vec<TopLevel>,
    /// What the camera is to be focused on, if that has a name.
    focus: Option<&'a str>,
    named: Vec<TopLevel>,
    /// From the description's space.
    to_world: Affine,
    detail: Detail,
    /// Within what the camera is focused on.
    in_focus: bool,
    /// See [`crate::world::World::placements`].
    placements: Vec<Transform>,
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
    let input =
        accel::Input { groups: vec![accel::Group::default()], geometries: Vec::with_capacity(geometries) };
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
        }
    }

    pub fn world(&mut self) {
        let mut place = Place { transform: self.to_world, material: 0, group: 0, dissolved: false };
        // Down to what `Scene::top_level` gives.
        let mut nodes = self.scene.world.as_slice();
        let mut is_all_named = false;
        while let [node @ Node::Group(g)] = nodes {
            is_all_named |= self.focus.is_some_and(|name| node.goes_by(name));
            place = self.step_into(node, g.material.as_ref(), place);
            nodes = &g.children;
        }
        for node in nodes {
            let before = self.in_world();
            self.node(node, place);
            self.top_level.push(self.since(before));
        }
        if is_all_named {
            self.named.push(self.since([0, 0]));
        }
    }

    /// Geometries and instances that stand in the world's own group.
    fn in_world(&self) -> [usize; 2] {
        let world = &self.input.groups[0];
        [world.geometries.len(), world.instances.len()]
    }

    /// What came to the world's own group since it held so many.
    fn since(&self, before: [usize; 2]) -> TopLevel {
        let after = self.in_world();
        TopLevel { geometries: before[0]..after[0], instances: before[1]..after[1] }
    }

    pub fn custom_shapes(&mut self, custom: &Custom) {
        self.node = None;
        for (i, (shape, material)) in custom.shapes.iter().enumerate() {
            let material = self.materials.named(material);
            self.geometry.custom.push(shape.clone());
            let place = Place { transform: Affine::IDENTITY, material, group: 0, dissolved: false };
            let look = self.add_shape(Shape::Custom(i as u32), place, material, false);
            self.geometries.push(look);
        }
    }

    pub fn finish(self) -> Built<'a> {
        let (materials, paint) = self.materials.finish();
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
        }
    }

    /// What leaves the range of numbers only where it stands, or lacks something, isn't there, which is told.
    fn leave_out(&mut self) {
        self.left_out.extend(self.node);
    }

    fn node(&mut self, node: &'a Node, place: Place) {
        let is_for_camera = place.group == 0 && !place.dissolved;
        if !(is_for_camera && self.focus.is_some_and(|name| node.goes_by(name))) {
            return self.kind_of_node(node, place);
        }
        let before = self.in_world();
        let outside = std::mem::replace(&mut self.in_focus, true);
        self.kind_of_node(node, place);
        self.in_focus = outside;
        self.named.push(self.since(before));
        ()
    }

    fn kind_of_node(&mut self, node: &'a Node, place: Place) {
        self.node = Some(node);
        match node {
            Node::Group(g) => {
                let inner = self.step_into(node, g.material.as_ref(), place);
                g.children.iter().for_each(|child| self.node(child, inner));
            }
            Node::Instance(i) => {
                let inner = self.step_into(node, i.material.as_ref(), place);
                self.instance(i, place.group, inner)
            }
            shape => self.one_shape(shape, Place { transform: placed(shape, place), ..place }),
        }
    }

    /// A node that is a shape; `place` is that of its own coordinates.
    fn one_shape(&mut self, node: &'a Node, place: Place) {
        let m = place.transform;
        match node {
            Node::Group(_) | Node::Instance(_) => (),
            Node::Sphere(s) => {
                let material = self.materials.of(s.surface.material.as_ref(), place.material);
                // What is brushed must know which way it was turned.
                let ball =
                    if self.materials.wants_tangent(material) { ellipsoid(s, &m) } else { sphere(s, &m) };
                let Some(ball) = ball else { return self.leave_out() };
                self.shape(&s.surface, place, ball, s.surface.flip)
            }
            Node::Plane(s) => {
                let Some(inverse) = m.inverse() else { return self.leave_out() };
                let normal = unit(inverse.normal_by_inverse(s.normal));
                let normal = if s.surface.flip { -normal } else { normal };
                let plane =
                    Shape::Plane(Plane { point: m.point(s.point).as_vec3(), normal: normal.as_vec3() });
                self.shape(&s.surface, place, plane, false)
            }
            Node::Disc(s) => {
                let (a, b) = tangents(unit(s.normal));
                let (mut a, mut b) = (m.vector(a * s.radius), m.vector(b * s.radius));
                if s.surface.flip != (m.determinant() < 0.0) {
                    (a, b) = (b, a);
                }
                let disc = Disc::new(m.point(s.center).as_vec3(), a.as_vec3(), b.as_vec3());
                self.shape(&s.surface, place, Shape::Disc(Box::new(disc)), false)
            }
            Node::Rectangle(s) => {
                let (mut a, mut b) = (m.vector(s.edges[0]), m.vector(s.edges[1]));
                if s.surface.flip != (m.determinant() < 0.0) {
                    (a, b) = (b, a);
                }
                let corner = m.point(s.corner).as_vec3();
                let r = Parallelogram::new(corner, a.as_vec3(), b.as_vec3());
                self.shape(&s.surface, place, Shape::Parallelogram(Box::new(r)), false)
            }
            Node::Cylinder(s) => self.cylinder(s, place),
            Node::Box(s) => {
                let mesh = TriangleMesh::cuboid(s.min.as_vec3(), s.max.as_vec3());
                self.whole_mesh(mesh, &s.surface, place)
            }
            Node::Triangle(s) => {
                let positions = s.vertices.map(|v| v.as_vec3().to_array()).to_vec();
                let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
                self.whole_mesh(TriangleMesh::from(&mesh), &s.surface, place)
            }
            Node::Mesh(m) => self.mesh_node(m, place),
            Node::Bezier(b) => {
                let is_draft = self.detail == Detail::Draft && !self.in_focus;
                let resolution = if is_draft { b.resolution.min(DRAFT) } else { b.resolution };
                let mesh = shaded(bezier_mesh(b, resolution), &b.shading);
                self.whole_mesh(mesh, &b.surface, place)
            }
        }
    }

    fn step_into(&mut self, node: &Node, material: Option<&'a desc::MaterialRef>, place: Place) -> Place {
        Place {
            transform: placed(node, place),
            material: self.materials.of(material, place.material),
            ..place
        }
    }

    /// An instance in a group; `inner` is the place of the object's own coordinates.
    fn instance(&mut self, i: &'a desc::Instance, outer: u32, inner: Place) {
        // A scene without errors leads everywhere.
        let objects = &self.scene.objects;
        let Some((id, (name, object))) = i.of.to().and_then(|id| Some((id, objects.at(id)?))) else {
            return ();
        };
        if self.glow.object(&i.of) || self.materials.shining(inner.material).is_some() {
            // Validation has counted them.
            self.dissolved += 1;
            if self.dissolved <= MOST_COPIES {
                self.node(object, Place { dissolved: true, ..inner });
            }
            return;
        }

        let group = match self.objects.get(&id) {
            Some(&(g, _)) => g,
            None => {
                let group = self.input.groups.len() as u32;
                self.input.groups.push(accel::Group::default());
                self.group_materials.push(Vec::new());
                self.objects.insert(id, (group, name));
                let place = Place { transform: Affine::IDENTITY, material: INHERIT, group, dissolved: false };
                self.node(object, place);
                group
            }
        };
        let Some(transform) = Transform::new(&inner.transform) else { return self.leave_out() };
        self.input.groups[outer as usize].instances.push(accel::Instance {
            group,
            transform,
            mask: u32::MAX,
        });
        self.group_materials[outer as usize].push(inner.material);
        ()
    }

    fn cylinder(&mut self, s: &'a desc::Cylinder, place: Place) {
        let m = place.transform;
        let axis = s.to - s.from;
        let (a, b) = tangents(unit(axis));
        let (a, b) = (a * s.radius, b * s.radius);
        // The unit cylinder stands along y.
        let unit_to_local = Affine {
            rows: [[b.x, axis.x, a.x, s.from.x], [b.y, axis.y, a.y, s.from.y], [b.z, axis.z, a.z, s.from.z]],
        };
        let Some(wall) = Cylinder::new(unit_to_local.then(&m)) else { return self.leave_out() };
        self.shape(&s.surface, place, Shape::Cylinder(Box::new(wall)), s.surface.flip);
        if s.caps {
            for (center, a, b) in [(s.from, b, a), (s.to, a, b)] {
                let (mut a, mut b) = (m.vector(a), m.vector(b));
                if s.surface.flip != (m.determinant() < 0.0) {
                    (a, b) = (b, a);
                }
                let cap = Disc::new(m.point(center).as_vec3(), a.as_vec3(), b.as_vec3());
                self.shape(&s.surface, place, Shape::Disc(Box::new(cap)), false);
            }
        }
    }

    /// Adds a shape that stands in its group's space.
    fn shape(&mut self, surface: &'a desc::Surface, place: Place, shape: Shape, flip: bool) {
        let material = self.materials.of(surface.material.as_ref(), place.material);
        let mut look = self.add_shape(shape, place, material, flip);
        let own = surface.emission.as_ref().map(|e| self.materials.emission(e));
        if let Some(glow) = self.glow_of(own, material) {
            let opacity = self.materials.opacity(material);
            let two_sided = surface.two_sided_emission || glow.both_sides;
            look.emission_varies = glow.radiance.varies() || glow.below.is_some();
            let placement = glowing_place(&place.transform, &glow.radiance);
            let Glow { radiance, below, .. } = glow;
            let glowing = Glowing { kind: look.kind, radiance, opacity, below, two_sided, flip, placement };
            look.emitter = Some(self.glow(glowing));
        }
        self.geometries.push(look);
        ()
    }

    fn add_shape(&mut self, shape: Shape, place: Place, material: u32, flip: bool) -> GeometryRecord {
        let first = self.geometry.shapes.len() as u32;
        self.geometry.shapes.push(shape);
        self.add_geometry(place.group, accel::GeometryKind::Shapes { first, count: 1 });
        let placement = self.placement(&place.transform, material);
        let kind = Kind::Shapes(first);
        GeometryRecord { kind, material, emitter: None, emission_varies: false, flip, placement }
    }

    /// Where a thing's own coordinates lie in its group's, if anybody may ask.
    fn placement(&mut self, transform: &Affine, material: u32) -> u32 {
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

    fn add_geometry(&mut self, group: u32, kind: accel::GeometryKind) {
        let id = self.input.geometries.len() as u32;
        self.input.geometries.push(accel::Geometry { kind, mask: u32::MAX });
        self.nodes.push(self.node);
        self.input.groups[group as usize].geometries.push(id);
    }

    /// The light of a surface: its own, else its material's.
    fn glow_of(&self, own: Option<Value<Colour>>, material: u32) -> Option<Glow> {
        if let Some(radiance) = own {
            return Some(Glow { radiance, below: None, both_sides: false });
        }
        let (emission, below) = self.materials.shining(material)?;
        Some(Glow { radiance: emission.radiance, below: Some(below), both_sides: emission.both_sides })
    }

    fn glow(&mut self, surface: Glowing) -> u32 {
        self.glowing.push(surface);
        (self.glowing.len() - 1) as u32
    }

    fn mesh_node(&mut self, m: &'a desc::TriangleMesh, place: Place) {
        if let MeshSource::Asset(asset) = m.source() {
            let asset = self.assets.mesh(asset.handle);
            let attributes = self.materials.attributes(&asset.mesh);
            let mesh = shaded(TriangleMesh { attributes, ..TriangleMesh::from(&*asset.mesh) }, &m.shading);
            let has_own = m.surface.material.is_some();
            let runs = runs(&mesh.indices, &asset.mesh.parts, &asset.materials, has_own);
            return self.mesh(mesh, &runs, &m.surface, place);
        }
        let mesh = Mesh {
            positions: m.positions.iter().map(|p| p.as_vec3().to_array()).collect(),
            normals: m.normals.iter().map(|n| n.as_vec3().to_array()).collect(),
            uvs: m.uvs.iter().map(|uv| uv.map(|v| v as f32)).collect(),
            triangles: m.triangles.clone(),
            ..Mesh::default()
        };
        self.whole_mesh(shaded(TriangleMesh::from(&mesh), &m.shading), &m.surface, place)
    }

    fn whole_mesh(&mut self, mesh: TriangleMesh, surface: &'a desc::Surface, place: Place) {
        let all = Run { material: None, triangles: mesh.indices.clone(), numbers: Vec::new() };
        self.mesh(mesh, &[all], surface, place)
    }

    /// Moves a mesh to its group's space and adds it, a geometry for each run.
    fn mesh(&mut self, mesh: TriangleMesh, runs: &[Run<'a>], surface: &'a desc::Surface, place: Place) {
        let m = place.transform;
        let moved = if m.is_identity() { Some(mesh) } else { mesh.transformed(&m) };
        let Some(mut mesh) = moved.filter(TriangleMesh::is_whole) else { return self.leave_out() };
        if surface.flip {
            mesh.flip = !mesh.flip;
            mesh.normals.iter_mut().for_each(|n| *n = -*n);
        }
        let default = self.materials.of(surface.material.as_ref(), place.material);
        let own_glow = surface.emission.as_ref().map(|e| self.materials.emission(e));
        let mut known = Vec::new();
        for run in runs {
            let material = match run.material {
                Some(part) => self.materials.add(&part.material),
                None => default,
            };
            let part_glow = run.material.and_then(|part| part.emission.as_ref());
            let radiance = match (own_glow, part_glow) {
                (Some(own), _) => Some(own),
                (None, Some(part)) => Some(self.materials.emission(part)),
                (None, None) => None,
            };
            let id = self.geometry.meshes.len() as u32;
            let part = match runs {
                [_] => TriangleMesh { indices: run.triangles.clone(), ..std::mem::take(&mut mesh) },
                _ => part(&mesh, run, &mut known),
            };
            let (positions, indices) = (part.positions.clone(), part.indices.clone());
            self.geometry.meshes.push(part);
            self.add_geometry(place.group, accel::GeometryKind::Triangles { positions, indices });
            let kind = Kind::Mesh(id);
            let glow = self.glow_of(radiance, material);
            let emission_varies = glow.as_ref().is_some_and(|g| g.radiance.varies() || g.below.is_some());
            let emitter = match glow {
                Some(Glow { radiance, below, both_sides }) => {
                    let opacity = self.materials.opacity(material);
                    let placement = glowing_place(&m, &radiance);
                    let two_sided = surface.two_sided_emission || both_sides;
                    let flip = false;
                    Some(self.glow(Glowing { kind, radiance, opacity, below, two_sided, flip, placement }))
                }
                None => None,
            };
            let placement = self.placement(&m, material);
            let record = GeometryRecord { kind, material, emitter, emission_varies, flip: false, placement };
            self.geometries.push(record);
        }
    }
}

/// Where the coordinates of what glows lie, if its radiance is read off a texture and they are others.
fn glowing_place(place: &Affine, radiance: &Value<Colour>) -> Option<Transform> {
    Transform::new(place).filter(|_| radiance.varies() && !place.is_identity())
}

/// Triangles of a mesh that share a material of its file.
struct Run<'a> {
    material: Option<&'a PartMaterial>,
    triangles: Arc<[[u32; 3]]>,
    /// Which triangles of the mesh they are, where it has several runs.
    numbers: Vec<u32>,
}

/// One run for each material that the file names, in order of first mention; one in all when the node has its own.
fn runs<'a>(
    triangles: &Arc<[[u32; 3]]>,
    parts: &[Part],
    materials: &'a BTreeMap<String, PartMaterial>,
    own: bool,
) -> Vec<Run<'a>> {
    /// A material's name, its triangles, and which of the mesh they are.
    type Found<'a> = (Option<&'a str>, Vec<[u32; 3]>, Vec<u32>);
    let mut runs: Vec<Found<'_>> = Vec::new();
    let mut known = BTreeMap::new();
    if !own && !materials.is_empty() {
        for part in parts {
            let name = part.material.as_deref().filter(|n| materials.contains_key(*n));
            let run = *known.entry(name).or_insert_with(|| {
                runs.push((name, Vec::new(), Vec::new()));
                runs.len() - 1
            });
            let found = triangles.get(part.triangles.clone()).unwrap_or_default();
            runs[run].1.extend(found);
            runs[run].2.extend((part.triangles.start as u32..).take(found.len()));
        }
    }
    if runs.is_empty() {
        return vec![Run { material: None, triangles: triangles.clone(), numbers: Vec::new() }];
    }
    let finish = |(name, triangles, numbers): Found<'_>| Run {
        material: name.and_then(|n| materials.get(n)),
        triangles: triangles.into(),
        numbers,
    };
    runs.into_iter().map(finish).collect()
}

/// Some triangles of a mesh with the vertices that they need, in order of first use: if each part of a file with many
/// materials held those of all, a small file would fill the memory. `known` is scratch.
fn part(mesh: &TriangleMesh, run: &Run<'_>, known: &mut Vec<u32>) -> TriangleMesh {
    const NONE: u32 = u32::MAX;
    known.resize(mesh.positions.len(), NONE);
    let mut used: Vec<u32> = Vec::new();
    let mut index = |i: u32| {
        let known = &mut known[i as usize];
        if *known == NONE {
            *known = used.len() as u32;
            used.push(i);
        }
        *known
    };
    let indices = run.triangles.iter().map(|t| t.map(&mut index)).collect();
    used.iter().for_each(|&i| known[i as usize] = NONE);
    let used = || used.iter().map(|&i| i as usize);
    TriangleMesh {
        positions: used().map(|i| mesh.positions[i]).collect(),
        indices,
        normals: used().filter_map(|i| mesh.normals.get(i).copied()).collect(),
        uvs: used().filter_map(|i| mesh.uvs.get(i).copied()).collect(),
        attributes: mesh
            .attributes
            .iter()
            .map(|a| match a.per {
                Per::Vertex => a.of(used()),
                Per::Face => a.of(run.numbers.iter().map(|i| *i as usize)),
            })
            .collect(),
        flip: mesh.flip,
    }
}

/// The mesh with the normals that it shall be shaded with. Its triangles stay in order, but may have other vertices.
fn shaded(mut out: TriangleMesh, shading: &Shading) -> TriangleMesh {
    match shading {
        Shading::Flat => out.normals.clear(),
        Shading::Smooth(s) if s.recompute || out.normals.is_empty() => out = smooth(out, s.crease),
        Shading::Auto | Shading::Smooth(_) => {}
    }
    out
}

/// Validation has seen that it has a length.
fn unit(v: DVec3) -> DVec3 {
    v.try_normalize().unwrap_or(DVec3::Y)
}

/// The place of a node's own coordinates, which validation has seen.
fn placed(node: &Node, place: Place) -> Affine {
    node.placement().map_or(place.transform, |own| own.then(&place.transform))
}

/// Two unit vectors that make a right-handed frame with `n`.
fn tangents(n: DVec3) -> (DVec3, DVec3) {
    // Those of +z are x and y, so that a disc's texture coordinates are where one expects them.
    let helper = if n.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let a = helper - n * n.dot(helper);
    let a = a / a.length();
    (a, n.cross(a))
}

/// A sphere stays one under rotations and uniform scaling.
fn sphere(s: &desc::Sphere, m: &Affine) -> Option<Shape> {
    let column = |j: usize| DVec3::new(m.rows[0][j], m.rows[1][j], m.rows[2][j]);
    let (a, b, c) = (column(0), column(1), column(2));
    let scale = a.length();
    let near = |x: f64| x.abs() < 1e-9 * scale * scale;
    let similar = near(a.dot(b))
        && near(b.dot(c))
        && near(c.dot(a))
        && near(b.length_squared() - scale * scale)
        && near(c.length_squared() - scale * scale);
    let center = m.point(s.center);
    if similar {
        return Some(Shape::Sphere(Sphere { center: center.as_vec3(), radius: (scale * s.radius) as f32 }));
    }
    ellipsoid(s, m)
}

/// It knows where its pole is. `None` where it leaves the range of numbers.
fn ellipsoid(s: &desc::Sphere, m: &Affine) -> Option<Shape> {
    let unit_to_local = Affine::scale(DVec3::splat(s.radius)).then(&Affine::translate(s.center));
    Some(Shape::Ellipsoid(Box::new(Ellipsoid::new(unit_to_local.then(m))?)))
}

/// Validation has seen that patches name points that are there.
fn bezier_mesh(b: &desc::Bezier, resolution: u32) -> TriangleMesh {
    let patches = match b.source() {
        desc::BezierPatches::Builtin(desc::Patches::Teapot) => bezier::teapot(),
        desc::BezierPatches::Inline => {
            let point = |i: u32| b.points.get(i as usize).map_or(Vec3::ZERO, |p| p.as_vec3());
            b.patches.iter().map(|ids| ids.map(point)).collect()
        }
    };
    bezier::tessellate(&patches, resolution)
}
