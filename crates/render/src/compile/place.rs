//! The walk over the tree of the world.

use super::build::{Build, Place};
use super::meshes::{bezier_mesh, shaded};
use super::round::standing;
use super::{Custom, Detail};
use crate::shape::{Cylinder, Disc, Drawn, Ellipsoid, Parallelogram, Plane, Shape, Sphere, TriangleMesh};
use crate::world::INHERIT;
use straal_accel as accel;
use straal_math::{Affine, DVec3, Motion, Transform};
use straal_scene::Mesh;
use straal_scene::desc::{self, Node};
use straal_scene::glow::MOST_COPIES;
use straal_scene::value::Link;

/// Quads along a patch's edge in a draft.
const DRAFT: u32 = 4;

impl<'a> Build<'a> {
    pub fn world(&mut self) {
        let mut place = Place { transform: self.to_world, material: 0, group: 0, dissolved: false };
        // Down to what `Scene::top_level` gives.
        let mut nodes = self.scene.world.as_slice();
        let mut is_all_named = false;
        while let [node @ Node::Group(g)] = nodes
            && g.transform.later.is_empty()
        {
            is_all_named |= self.focus.is_some_and(|name| node.goes_by(name));
            self.within |= self.names.bits(|name| node.goes_by(name));
            place = Place { transform: placed(node, place), ..place };
            place = self.with_material(g.material.as_ref(), place);
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

    pub fn custom_shapes(&mut self, custom: &Custom) {
        (self.node, self.within) = (None, 0);
        for (i, (shape, material)) in custom.shapes.iter().enumerate() {
            let material = self.materials.named(material);
            self.geometry.custom.push(shape.clone());
            let place = Place { transform: Affine::IDENTITY, material, group: 0, dissolved: false };
            let record = self.add_shape(Shape::Custom(i as u32), place, material, false);
            self.geometries.push(record);
        }
    }

    fn node(&mut self, node: &'a Node, place: Place) {
        if !self.names.matter() {
            return self.node_in_focus(node, place);
        }
        let outside = self.within;
        self.within |= self.names.bits(|name| node.goes_by(name));
        self.node_in_focus(node, place);
        self.within = outside;
    }

    fn node_in_focus(&mut self, node: &'a Node, place: Place) {
        let is_for_camera = place.group == 0 && !place.dissolved;
        if !(is_for_camera && self.focus.is_some_and(|name| node.goes_by(name))) {
            return self.kind_of_node(node, place);
        }
        let before = self.in_world();
        let outside = std::mem::replace(&mut self.in_focus, true);
        self.kind_of_node(node, place);
        self.in_focus = outside;
        self.named.push(self.since(before));
    }

    fn kind_of_node(&mut self, node: &'a Node, place: Place) {
        self.node = Some(node);
        let motion = self.motion(node, place);
        if !motion.is_empty() {
            return self.moving(node, place, motion);
        }
        self.inside(node, Place { transform: placed(node, place), ..place });
    }

    /// A node whose own coordinates are those of `own`.
    fn inside(&mut self, node: &'a Node, own: Place) {
        match node {
            Node::Group(g) => {
                let inner = self.with_material(g.material.as_ref(), own);
                g.children.iter().for_each(|child| self.node(child, inner));
            }
            Node::Instance(i) => {
                let inner = self.with_material(i.material.as_ref(), own);
                self.instance(&i.of, own.group, inner)
            }
            Node::Instances(i) => {
                let all = self.with_material(i.material.as_ref(), own);
                for each in &i.transforms {
                    let inner = Place { transform: each.0.then(&all.transform), ..all };
                    self.instance(&i.of, own.group, inner);
                }
            }
            shape => self.one_shape(shape, own),
        }
    }

    /// Where a node is while the shutter is open; empty if it stays. What glows stays where it is at first, which is told.
    fn motion(&mut self, node: &Node, place: Place) -> Vec<Affine> {
        let motion: Vec<Affine> = node.motion().iter().map(|own| own.then(&place.transform)).collect();
        if motion.is_empty() || !(self.glow.node(node) || self.materials.shining(place.material).is_some()) {
            return motion;
        }
        let what = node.name().map_or_else(|| "something".to_owned(), |name| format!("`{}`", name.value));
        let note = format!(
            "{what} moves while the shutter is open and glows: light from what moves isn't blurred, so it stays where it is at first"
        );
        self.materials.note(note);
        Vec::new()
    }

    /// A node that moves: an object of its own, whose one instance does.
    fn moving(&mut self, node: &'a Node, place: Place, motion: Vec<Affine>) {
        let Some((first, motion)) = motion.first().copied().zip(Motion::new(motion)) else {
            return self.leave_out();
        };
        let before = self.input.motions.len() as u32;
        self.input.motions.push(motion);
        if let Node::Instance(i) = node {
            let inner = self.with_material(i.material.as_ref(), Place { transform: first, ..place });
            return self.instance_moved(&i.of, place.group, inner, Some(before));
        }
        let group = self.new_group();
        self.inside(node, Place { transform: Affine::IDENTITY, group, ..place });
        self.put(group, place.group, Place { transform: first, ..place }, Some(before));
    }

    fn new_group(&mut self) -> u32 {
        let group = self.input.groups.len() as u32;
        self.input.groups.push(accel::Group::default());
        self.group_materials.push(Vec::new());
        self.linked.instances.push(Vec::new());
        group
    }

    /// Puts a group into another.
    fn put(&mut self, group: u32, outer: u32, inner: Place, motion: Option<u32>) {
        let Some(transform) = Transform::new(&inner.transform) else { return self.leave_out() };
        let instance = accel::Instance { group, transform, motion, mask: u32::MAX };
        self.input.groups[outer as usize].instances.push(instance);
        self.group_materials[outer as usize].push(inner.material);
        if let Some(instances) = self.linked.instances.get_mut(outer as usize) {
            instances.push(self.within);
        }
    }

    /// A node that is a shape; `place` is that of its own coordinates.
    pub(super) fn one_shape(&mut self, node: &'a Node, place: Place) {
        let m = place.transform;
        match node {
            Node::Group(_) | Node::Instance(_) | Node::Instances(_) => (),
            Node::Sphere(s) if s.heights.is_some() || s.phi != desc::WHOLE_TURN => {
                self.part_of_sphere(s, place)
            }
            Node::Sphere(s) => {
                let material = self.materials.of(s.surface.material.as_ref(), place.material);
                // What is brushed must know which way it was turned, and so must what a map tells normals of.
                let is_directed = self.materials.wants_tangent(material)
                    || is_turned(&m) && self.materials.maps_normals(material);
                let ball = if is_directed { ellipsoid(s, &m) } else { sphere(s, &m) };
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
                let disc = disc.drawn(drawn(&s.light_sampling, &s.surface));
                self.shape(&s.surface, place, Shape::Disc(Box::new(disc)), false)
            }
            Node::Rectangle(s) => {
                let (mut a, mut b) = (m.vector(s.edges[0]), m.vector(s.edges[1]));
                if s.surface.flip != (m.determinant() < 0.0) {
                    (a, b) = (b, a);
                }
                let corner = m.point(s.corner).as_vec3();
                let r = Parallelogram::new(corner, a.as_vec3(), b.as_vec3());
                let r = r.drawn(drawn(&s.light_sampling, &s.surface));
                self.shape(&s.surface, place, Shape::Parallelogram(Box::new(r)), false)
            }
            Node::Cylinder(s) => self.cylinder(s, place),
            Node::Cone(s) => self.cone(s, place),
            Node::Annulus(s) => self.annulus(s, place),
            Node::Torus(s) => self.torus(s, place),
            Node::Paraboloid(s) => self.paraboloid(s, place),
            Node::Hyperboloid(s) => self.hyperboloid(s, place),
            Node::Capsule(s) => self.capsule(s, place),
            Node::Box(s) => {
                let mesh = TriangleMesh::cuboid(s.min.as_vec3(), s.max.as_vec3());
                self.whole_mesh(mesh, &s.surface, place)
            }
            Node::Triangle(s) => {
                let positions = s.vertices.map(|v| v.as_vec3().to_array()).to_vec();
                let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
                let drawn = drawn(&s.light_sampling, &s.surface);
                self.whole_mesh(TriangleMesh { drawn, ..TriangleMesh::from(&mesh) }, &s.surface, place)
            }
            Node::Bilinear(s) => self.bilinear(s, place),
            Node::HeightField(s) => self.height_field(s, place),
            Node::Curves(s) => self.curves(s, place),
            Node::Union(_) | Node::Intersection(_) | Node::Difference(_) => self.combination(node, place),
            Node::DistanceField(s) => self.distance_field(s, place),
            Node::Mesh(m) => self.mesh_node(m, place),
            Node::Bezier(b) => {
                let is_draft = self.detail == Detail::Draft && !self.in_focus;
                let resolution = if is_draft { b.resolution.min(DRAFT) } else { b.resolution };
                let mesh = shaded(bezier_mesh(b, resolution), &b.shading);
                self.whole_mesh(mesh, &b.surface, place)
            }
        }
    }

    fn with_material(&mut self, material: Option<&'a desc::MaterialRef>, place: Place) -> Place {
        Place { material: self.materials.of(material, place.material), ..place }
    }

    /// An instance in a group; `inner` is the place of the object's own coordinates.
    fn instance(&mut self, of: &'a Link<Node>, outer: u32, inner: Place) {
        self.instance_moved(of, outer, inner, None);
    }

    /// The same of one that may move.
    fn instance_moved(&mut self, of: &'a Link<Node>, outer: u32, inner: Place, motion: Option<u32>) {
        // A scene without errors leads everywhere.
        let objects = &self.scene.objects;
        let Some((id, (name, object))) = of.to().and_then(|id| Some((id, objects.at(id)?))) else {
            return;
        };
        // What has no material of its own shines by that around it, or has its holes.
        let is_dissolved = self.materials.shining(inner.material).is_some()
            || self.glow.object(of) && self.materials.has_holes(inner.material);
        if is_dissolved {
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
                let group = self.new_group();
                self.objects.insert(id, (group, name));
                let place = Place { transform: Affine::IDENTITY, material: INHERIT, group, dissolved: false };
                // What it is within besides, each of its instances says.
                let outside = std::mem::take(&mut self.within);
                self.node(object, place);
                self.within = outside;
                group
            }
        };
        self.put(group, outer, inner, motion);
    }

    fn cylinder(&mut self, s: &'a desc::Cylinder, place: Place) {
        if s.phi != desc::WHOLE_TURN {
            return self.part_of_cylinder(s, place);
        }
        let own = standing(s.from, s.to, s.radius);
        let Some(wall) = Cylinder::new(own.then(&place.transform)) else { return self.leave_out() };
        self.shape(&s.surface, place, Shape::Cylinder(Box::new(wall)), s.surface.flip);
        if s.caps {
            let (a, b) = tangents(unit(s.to - s.from));
            let (a, b) = (a * s.radius, b * s.radius);
            self.cap(&s.surface, place, [s.from, b, a]);
            self.cap(&s.surface, place, [s.to, a, b]);
        }
    }
}

/// How points of a lamp are drawn.
pub(super) fn drawn(said: &desc::LightSampling, surface: &desc::Surface) -> Drawn {
    match said {
        desc::LightSampling::Auto => Drawn::Auto { both_sides: surface.two_sided_emission },
        desc::LightSampling::Area => Drawn::ByArea,
        desc::LightSampling::SolidAngle => Drawn::BySolidAngle,
        desc::LightSampling::ProjectedSolidAngle => Drawn::ByProjectedSolidAngle,
    }
}

/// Validation has seen that it has a length.
pub(super) fn unit(v: DVec3) -> DVec3 {
    v.try_normalize().unwrap_or(DVec3::Y)
}

/// The place of a node's own coordinates, which validation has seen.
fn placed(node: &Node, place: Place) -> Affine {
    node.placement().map_or(place.transform, |own| own.then(&place.transform))
}

/// Two unit vectors that make a right-handed frame with `n`.
pub(super) fn tangents(n: DVec3) -> (DVec3, DVec3) {
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

/// Whether a map does more than move things and scale them evenly.
fn is_turned(m: &Affine) -> bool {
    let size = m.rows[0][0];
    let is_even = |i: usize, j: usize| m.rows[i][j] == if i == j { size } else { 0.0 };
    size <= 0.0 || !(0..3).all(|i| (0..3).all(|j| is_even(i, j)))
}

/// It knows where its pole is. `None` where it leaves the range of numbers.
fn ellipsoid(s: &desc::Sphere, m: &Affine) -> Option<Shape> {
    let unit_to_local = Affine::scale(DVec3::splat(s.radius)).then(&Affine::translate(s.center));
    Some(Shape::Ellipsoid(Box::new(Ellipsoid::new(unit_to_local.then(m))?)))
}
