//! What prims show: groups, shapes, objects and their instances.

use straal_math::{Affine, DVec3};
use straal_scene::desc::{Group, Instance, Instances, MaterialRef, Node, Sphere, Step, Surface, Transform};
use straal_scene::value::{Link, Matrix, Name};

use super::xform::{self, Local};
use super::{Translation, material};
use crate::scene::motion;

/// What a prim has of those that it is in.
#[derive(Clone, Debug)]
pub(super) struct Within {
    /// Where they stand in the scene.
    pub global: Affine,
    /// The prim of the material that counts.
    pub material: Option<usize>,
    /// Whether no binding further in counts.
    is_strong: bool,
    /// What isn't a group of its own, as there are too many already: it is placed here.
    pending: Affine,
    depth: usize,
    /// Instances within instances.
    instances: usize,
    /// Whether this is an object, which stands nowhere by itself.
    is_object: bool,
}

/// Ways of what moves while the shutter is open, each of them straight.
const WAYS: usize = 8;

/// Groups are within one another so deep at most; deeper prims stand in the last of them.
const DEEPEST: usize = 40;

/// Instances within instances: more are written out.
const INSTANCES: usize = 6;

/// Prims that are walked through, those that are written out again included.
const MOST: usize = 4_000_000;

impl Translation<'_, '_> {
    /// The world of the stage.
    pub fn world(&mut self) {
        let within = Within {
            global: self.root,
            material: None,
            is_strong: false,
            pending: Affine::IDENTITY,
            depth: 0,
            instances: 0,
            is_object: false,
        };
        let mut nodes = Vec::new();
        for child in self.stage.prims[0].children.clone() {
            nodes.append(&mut self.prim(child, &within));
        }
        nodes.append(&mut self.reset);
        if nodes.is_empty() {
            return;
        }
        self.scene.world = if self.root.is_identity() {
            nodes
        } else {
            vec![grouped(nodes, vec![Step::Matrix(Matrix(self.root))], None)]
        };
    }

    /// What a prim and those in it show, in the coordinates of the one that it is in.
    fn prim(&mut self, prim: usize, around: &Within) -> Vec<Node> {
        self.walked += 1;
        if self.walked > MOST {
            if self.walked == MOST + 1 {
                self.fail(format!("`{}` shows too many prims: {MOST} are read", self.name));
            }
            return Vec::new();
        }
        if !self.stage.prims[prim].is_defined {
            return Vec::new();
        }
        let word = |t: &Self, name: &str| t.stage.text(prim, name).unwrap_or_default();
        if word(self, "visibility") == "invisible"
            || matches!(word(self, "purpose").as_str(), "proxy" | "guide")
        {
            return Vec::new();
        }
        let local = xform::local(&self.stage, prim);
        if let Some(unknown) = &local.unknown {
            let message = format!("the transform op `{}` is left out", straal_scene::suggest::brief(unknown));
            self.warn(prim, &message);
        }
        let Some(own) = local.affine() else {
            self.warn(prim, "it is left out: its transform leaves nothing of it");
            return Vec::new();
        };
        let mut within = Within { depth: around.depth + 1, ..around.clone() };
        self.bind(prim, &mut within);
        within.global = if local.is_reset { own.then(&self.root) } else { own.then(&around.global) };
        let is_deep = around.depth >= DEEPEST;
        let above = if local.is_reset { Affine::IDENTITY } else { around.pending };
        within.pending = if is_deep { own.then(&above) } else { Affine::IDENTITY };
        let moving = self.moving(prim, &own);
        if is_deep && !moving.is_empty() {
            self.warn(prim, "what stands so deep in others isn't blurred while it moves");
        }
        let mut nodes = self.shows(prim, &within);
        if local.is_reset && around.is_object {
            self.warn(prim, "`!resetXformStack!` isn't kept to within instances");
        }
        if is_deep && !local.is_reset {
            return nodes;
        }
        if nodes.is_empty() {
            return nodes;
        }
        let Local { mut steps, .. } = local;
        if is_deep {
            steps = Vec::new();
        }
        let name: Name = self.stage.prims[prim].name.clone().into();
        // A prim that only stands around another says nothing by itself.
        nodes = if !moving.is_empty() && !is_deep {
            let transform = motion::transform(&moving);
            vec![Node::Group(Group {
                transform,
                look_at: None,
                material: None,
                children: nodes,
                name: Some(name),
            })]
        } else if steps.is_empty() && nodes.len() == 1 && is_named(&nodes[0]) {
            nodes
        } else {
            vec![grouped(nodes, steps, Some(name))]
        };
        if self.is_reset(prim) && !around.is_object {
            self.reset.append(&mut nodes);
        }
        nodes
    }

    /// Where a prim is at even times while the shutter is open, from `own`; empty if it stays.
    fn moving(&mut self, prim: usize, own: &Affine) -> Vec<Affine> {
        let times = self.times();
        if times.is_empty() {
            return Vec::new();
        }
        let first = self.stage.time;
        let mut places = vec![*own];
        for time in times {
            self.stage.time = time;
            let place = xform::local(&self.stage, prim).affine();
            places.extend(place);
            if place.is_none() {
                break;
            }
        }
        self.stage.time = first;
        if places.len() == WAYS + 1 && places.iter().any(|place| place != own) { places } else { Vec::new() }
    }

    /// Even times after the first while the shutter is open; none where nothing is blurred.
    pub fn times(&self) -> Vec<f64> {
        let (first, open) = (self.stage.time, self.open);
        if open <= 0.0 {
            return Vec::new();
        }
        (1..=WAYS).map(|way| first + open * way as f64 / WAYS as f64).collect()
    }

    /// Balls at points.
    fn points(&mut self, prim: usize, within: &Within) -> Vec<Node> {
        let positions = self.stage.numbers(prim, "points", 3).unwrap_or_default();
        let widths = self.stage.numbers(prim, "widths", 1).unwrap_or_default();
        let is_each = widths.len() * 3 == positions.len();
        let place = |(i, p): (usize, &[f64])| {
            let width = widths.get(if is_each { i } else { 0 }).copied().unwrap_or(1.0);
            let place = Affine::scale(DVec3::splat(0.5 * width));
            let place = place.then(&Affine::translate(DVec3::new(p[0], p[1], p[2])));
            (width > 0.0 && place.inverse().is_some()).then_some(Matrix(place))
        };
        let transforms: Vec<Matrix> = positions.chunks_exact(3).enumerate().filter_map(place).collect();
        if transforms.is_empty() {
            return Vec::new();
        }
        self.stage.library.means.ledger.keep(size_of_val(transforms.as_slice()) as u64);
        let colours = self.stage.numbers(prim, "primvars:displayColor", 3).unwrap_or_default();
        if colours.len() > 3 {
            self.warn(prim, "all points have the colour of the first");
        }
        let mut surface = self.surface(prim, within, &material::Has::default());
        surface.name = None;
        let ball = Node::Sphere(Sphere { surface, ..Sphere::default() });
        let wanted = self.stage.prims[prim].name.clone();
        let name = self.names.free(&wanted, |name| self.scene.objects.get(name).is_some());
        self.scene.objects.insert(name.clone().into(), ball);
        let own: Name = wanted.into();
        vec![Node::Instances(Instances {
            of: Link::new(name),
            transforms,
            transform: Transform::default(),
            look_at: None,
            material: None,
            name: Some(own),
        })]
    }

    fn is_reset(&self, prim: usize) -> bool {
        self.stage.texts(prim, "xformOpOrder").iter().any(|op| op == "!resetXformStack!")
    }

    /// The material that counts for a prim.
    pub fn bind(&mut self, prim: usize, within: &mut Within) {
        if within.is_strong {
            return;
        }
        for name in ["material:binding:full", "material:binding", "material:binding:preview"] {
            let Some(target) = self.stage.targets(prim, name).into_iter().next() else { continue };
            let Some(found) = self.stage.places.get(&target).copied() else {
                self.warn(prim, "its material isn't there");
                continue;
            };
            within.material = Some(found);
            within.is_strong = self.stage.is_strong(prim, name);
            return;
        }
    }

    /// What a prim shows by itself, and what those in it show, in its own coordinates.
    fn shows(&mut self, prim: usize, within: &Within) -> Vec<Node> {
        let kind = self.stage.prims[prim].type_name.clone();
        if self.stage.prims[prim].is_instance {
            return self.instance(prim, within);
        }
        let mut nodes = match kind.as_str() {
            "PointInstancer" => return self.point_instancer(prim, within),
            // What is in these isn't seen by itself.
            "Material" | "Shader" | "NodeGraph" | "GeomSubset" | "Camera" => return Vec::new(),
            "Mesh" => self.mesh(prim, within),
            "Sphere" | "Cube" | "Cylinder" | "Cylinder_1" | "Cone" | "Capsule" | "Capsule_1" | "Plane"
            | "BasisCurves" => self.shape(prim, &kind, within),
            "Points" => self.points(prim, within),
            "NurbsPatch" | "NurbsCurves" | "HermiteCurves" | "TetMesh" | "Volume" => {
                self.warn(prim, &format!("`{kind}` is left out"));
                Vec::new()
            }
            kind if kind.ends_with("Light") || kind == "DomeLight_1" => self.light(prim, kind, within),
            _ => Vec::new(),
        };
        if !within.pending.is_identity() {
            let steps = vec![Step::Matrix(Matrix(within.pending))];
            nodes = nodes.into_iter().map(|node| grouped(vec![node], steps.clone(), None)).collect();
        }
        for child in self.stage.prims[prim].children.clone() {
            nodes.append(&mut self.prim(child, within));
        }
        nodes
    }

    /// What is in an instance: an object, which others share, unless something in it stands by itself.
    fn instance(&mut self, prim: usize, within: &Within) -> Vec<Node> {
        let content = self.stage.prims[prim].prototype.unwrap_or(prim);
        if within.instances >= INSTANCES || self.stands_alone(content, 0) {
            let mut nodes = Vec::new();
            for child in self.stage.prims[content].children.clone() {
                nodes.append(&mut self.prim(child, within));
            }
            return nodes;
        }
        let Some(of) = self.object(content, false, within) else { return Vec::new() };
        let mut steps = Vec::new();
        if !within.pending.is_identity() {
            steps.push(Step::Matrix(Matrix(within.pending)));
        }
        let transform = Transform { steps, ..Transform::default() };
        vec![Node::Instance(Instance {
            of: Link::new(of),
            transform,
            look_at: None,
            material: None,
            name: None,
        })]
    }

    /// Whether something in a prim can't be a part of an object: lights from nowhere, and what stands in the world.
    fn stands_alone(&self, prim: usize, depth: usize) -> bool {
        let inside = self.stage.prims[prim].prototype.unwrap_or(prim);
        self.stage.prims[inside].children.iter().any(|&child| {
            let kind = self.stage.prims[child].type_name.as_str();
            kind.ends_with("Light")
                || kind == "DomeLight_1"
                || depth > DEEPEST
                || self.is_reset(child)
                || self.stands_alone(child, depth + 1)
        })
    }

    /// The name of the object that a prim is, or what is in it; none where that shows nothing.
    fn object(&mut self, prim: usize, with_itself: bool, within: &Within) -> Option<String> {
        let key = (prim, with_itself, within.material);
        if let Some(known) = self.objects.get(&key) {
            return known.clone();
        }
        // One that is met again while it is made is within itself.
        self.objects.insert(key, None);
        let inside = Within {
            depth: 0,
            pending: Affine::IDENTITY,
            instances: within.instances + 1,
            is_object: true,
            ..within.clone()
        };
        let mut nodes = Vec::new();
        if with_itself {
            nodes = self.prim(prim, &inside);
        } else {
            for child in self.stage.prims[prim].children.clone() {
                nodes.append(&mut self.prim(child, &inside));
            }
        }
        if nodes.is_empty() {
            return None;
        }
        let wanted = self.stage.prims[prim].name.clone();
        let name = self.names.free(&wanted, |name| self.scene.objects.get(name).is_some());
        let node = if nodes.len() == 1 { nodes.remove(0) } else { grouped(nodes, Vec::new(), None) };
        self.scene.objects.insert(name.clone().into(), node);
        self.objects.insert(key, Some(name.clone()));
        Some(name)
    }

    /// Prototypes at many places.
    fn point_instancer(&mut self, prim: usize, within: &Within) -> Vec<Node> {
        let stage = &self.stage;
        let targets = stage.targets(prim, "prototypes");
        let which = stage.numbers(prim, "protoIndices", 1).unwrap_or_default();
        let positions = stage.numbers(prim, "positions", 3).unwrap_or_default();
        let turns = ["orientationsf", "orientations"]
            .into_iter()
            .find_map(|name| stage.numbers(prim, name, 4).filter(|turns| !turns.is_empty()));
        let scales = stage.numbers(prim, "scales", 3).unwrap_or_default();
        let ids = stage.numbers(prim, "ids", 1).unwrap_or_default();
        let hidden = stage.numbers(prim, "invisibleIds", 1).unwrap_or_default();
        let mut hidden: Vec<i64> = hidden.iter().map(|id| *id as i64).collect();
        hidden.sort_unstable();
        let three = |list: &[f64], i: usize| list.get(3 * i..3 * i + 3).map(|v| DVec3::new(v[0], v[1], v[2]));
        let mut places: Vec<Vec<Matrix>> = vec![Vec::new(); targets.len()];
        let mut lost = 0;
        for (i, proto) in which.iter().enumerate() {
            let id = ids.get(i).map_or(i as i64, |id| *id as i64);
            if hidden.binary_search(&id).is_ok() {
                continue;
            }
            let mut place = three(&scales, i).map_or(Affine::IDENTITY, Affine::scale);
            let turn = turns.as_ref().and_then(|turns| turns.get(4 * i..4 * i + 4)?.try_into().ok());
            if let Some(turn) = turn {
                place = place.then(&xform::quaternion(turn));
            }
            let position = three(&positions, i);
            place = place.then(&Affine::translate(position.unwrap_or(DVec3::ZERO)));
            let list = places.get_mut(*proto as usize).filter(|_| *proto >= 0.0);
            match list {
                Some(list) if position.is_some() && place.inverse().is_some() => list.push(Matrix(place)),
                _ => lost += 1,
            }
        }
        if lost > 0 {
            self.warn(prim, "some instances are left out: they have no prototype, no position or no size");
        }
        let mut nodes = Vec::new();
        for (target, transforms) in targets.into_iter().zip(places) {
            let Some(&prototype) = self.stage.places.get(&target).filter(|_| !transforms.is_empty()) else {
                continue;
            };
            if self.stands_alone(prototype, 0) {
                self.warn(prim, "lights in what is shown many times are left out");
            }
            let Some(of) = self.object(prototype, true, within) else { continue };
            let of = Link::new(of);
            let mut steps = Vec::new();
            if !within.pending.is_identity() {
                steps.push(Step::Matrix(Matrix(within.pending)));
            }
            let transform = Transform { steps, ..Transform::default() };
            nodes.push(Node::Instances(Instances {
                of,
                transforms,
                transform,
                look_at: None,
                material: None,
                name: None,
            }));
        }
        nodes
    }

    /// The surface of a shape that has that material.
    pub fn surface(&mut self, prim: usize, within: &Within, has: &material::Has) -> Surface {
        let look = self.look(prim, within.material, has);
        let flip = self.stage.text(prim, "orientation").as_deref() == Some("leftHanded");
        let name: Name = self.stage.prims[prim].name.clone().into();
        Surface {
            material: Some(MaterialRef::Named(Link::new(look.material))),
            flip,
            name: Some(name),
            ..Surface::default()
        }
    }

    /// Whether lights can be where objects are asked for.
    pub fn is_in_object(within: &Within) -> bool {
        within.is_object
    }
}

/// Whether a node says by itself what it is called.
fn is_named(node: &Node) -> bool {
    match node {
        Node::Group(group) => group.name.is_some(),
        Node::Instance(instance) => instance.name.is_some(),
        Node::Instances(instances) => instances.name.is_some(),
        other => other.surface().is_some_and(|surface| surface.name.is_some()),
    }
}

/// Several nodes as one that is placed.
pub(super) fn grouped(mut nodes: Vec<Node>, steps: Vec<Step>, name: Option<Name>) -> Node {
    if let [only] = nodes.as_mut_slice() {
        let (transform, own) = match only {
            Node::Group(group) => (&mut group.transform, &mut group.name),
            Node::Instance(instance) => (&mut instance.transform, &mut instance.name),
            Node::Instances(instances) => (&mut instances.transform, &mut instances.name),
            Node::Mesh(mesh) => (&mut mesh.surface.transform, &mut mesh.surface.name),
            Node::Sphere(shape) => (&mut shape.surface.transform, &mut shape.surface.name),
            Node::Box(shape) => (&mut shape.surface.transform, &mut shape.surface.name),
            Node::Cylinder(shape) => (&mut shape.surface.transform, &mut shape.surface.name),
            Node::Cone(shape) => (&mut shape.surface.transform, &mut shape.surface.name),
            Node::Capsule(shape) => (&mut shape.surface.transform, &mut shape.surface.name),
            Node::Rectangle(shape) => (&mut shape.surface.transform, &mut shape.surface.name),
            Node::Disc(shape) => (&mut shape.surface.transform, &mut shape.surface.name),
            Node::Curves(shape) => (&mut shape.surface.transform, &mut shape.surface.name),
            _ => {
                let transform = Transform { steps, ..Transform::default() };
                return Node::Group(Group {
                    transform,
                    look_at: None,
                    material: None,
                    children: nodes,
                    name,
                });
            }
        };
        // What comes later is applied later.
        transform.steps.extend(steps);
        if own.is_none() {
            *own = name;
        }
        return nodes.remove(0);
    }
    let transform = Transform { steps, ..Transform::default() };
    Node::Group(Group { transform, look_at: None, material: None, children: nodes, name })
}
