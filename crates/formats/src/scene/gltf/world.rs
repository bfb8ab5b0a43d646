//! What nodes show: meshes, once or many times, as groups, objects and instances of straal's world.

use std::collections::BTreeMap;

use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    Group, Instance, Instances, Node, Shading, Surface, Transform, TriangleMesh, Varying,
};
use straal_scene::value::{Asset, Link, Matrix, Name};
use straal_scene::{Mesh, MeshAsset};

use super::Translation;
use super::document::{Fault, Result, in_list, number, required, size, text};
use super::geometry::{self, Mode, SETS, Shape};
use super::json::Json;
use super::material::{self, Has};
use super::tree::{self, Tree};
use super::unlit;

/// A primitive as it was read, for others that show the same.
#[derive(Clone)]
pub(super) struct Known {
    pub asset: Asset<Mesh>,
    pub has: Has,
    pub has_normals: bool,
    /// The box around it.
    pub bounds: Option<[DVec3; 2]>,
}

/// The name of one of the scene's objects, and the box around it.
pub(super) type Object = (String, Option<[DVec3; 2]>);

/// What a mesh is shown as.
struct Shown {
    nodes: Vec<Node>,
    bounds: Option<[DVec3; 2]>,
}

impl<'a> Translation<'a, '_> {
    /// The world of the nodes that are shown; `later` are where they are afterwards, while the shutter is open.
    pub fn world(&mut self, tree: &Tree<'a>, later: &[Tree<'a>]) -> Result<()> {
        let mut uses: BTreeMap<usize, u32> = BTreeMap::new();
        for &node in &tree.shown {
            if let Some(at) = tree.nodes[node].get("mesh") {
                *uses.entry(size(at)?).or_default() += 1;
            }
        }
        // From the leaves to the roots, what stands in each node's group.
        let mut inside: BTreeMap<usize, Vec<Node>> = BTreeMap::new();
        for &node in tree.shown.iter().rev() {
            let said = &tree.nodes[node];
            let mut children = inside.remove(&node).unwrap_or_default();
            children.reverse();
            let mut own = Vec::new();
            if let Some(at) = said.get("mesh") {
                let (mesh, _) = self.document.item("meshes", at)?;
                let is_shared = uses.get(&mesh).is_some_and(|uses| *uses > 1);
                own = self.mesh_of(tree, node, at, is_shared)?;
            }
            own.append(&mut children);
            if own.is_empty() {
                continue;
            }
            let mut transform = tree.placed(node)?;
            let mut moved = Vec::new();
            for tree in later {
                moved.push(tree.placed(node)?);
            }
            let moves = moved.iter().any(|later| later.steps != transform.steps);
            if moves && moved.iter().all(|later| tree::affine(later).inverse().is_some()) {
                transform.later = moved.into_iter().map(|later| later.steps).collect();
            }
            if tree::affine(&transform).inverse().is_none() {
                self.warn(
                    said,
                    "the node and what is in it is left out: its scale or matrix leaves nothing of it",
                );
                continue;
            }
            let name = said.get("name").map(text).transpose()?.filter(|name| !name.is_empty());
            let grouped = placed(own, transform, name.map(|name| name.to_owned().into()));
            match tree.group_of(node) {
                Some(above) => inside.entry(above).or_default().push(grouped),
                None => self.scene.world.push(grouped),
            }
        }
        self.scene.world.reverse();
        let mut skinned = std::mem::take(&mut self.skinned);
        self.scene.world.append(&mut skinned);
        Ok(())
    }

    /// What a node shows as its mesh.
    fn mesh_of(&mut self, tree: &Tree<'a>, node: usize, at: &'a Json, is_shared: bool) -> Result<Vec<Node>> {
        let said = &tree.nodes[node];
        let (_, mesh) = self.document.item("meshes", at)?;
        let still = said.get("weights").or_else(|| mesh.get("weights"));
        let weights: Vec<f64> = match (tree.poses.get(&node).and_then(|pose| pose.weights.clone()), still) {
            (Some(weights), _) => weights,
            (None, Some(list)) => list.items().iter().map(number).collect::<Result<_>>()?,
            (None, None) => Vec::new(),
        };
        let global = tree.globals[node].unwrap_or(Affine::IDENTITY);
        if let Some(skin) = said.get("skin") {
            // What follows a skeleton stands where its joints are, wherever its node is.
            let joints = self.joints(tree, skin)?;
            let shown = self.mesh(
                mesh,
                Shape { weights: &weights, joints: Some(&joints), primary: 0, directions: None },
            )?;
            self.reach(&shown, &Affine::IDENTITY);
            self.skinned.extend(shown.nodes);
            return Ok(Vec::new());
        }
        let shape = Shape { weights: &weights, joints: None, primary: 0, directions: None };
        let instances = said.extension("EXT_mesh_gpu_instancing");
        if instances.is_none() && !is_shared {
            let shown = self.mesh(mesh, shape)?;
            self.reach(&shown, &global);
            return Ok(shown.nodes);
        }
        let Some((name, bounds)) = self.object(mesh, shape)? else { return Ok(Vec::new()) };
        let shown = Shown { nodes: Vec::new(), bounds };
        let instance = |transform: Transform| {
            Node::Instance(Instance {
                of: Link::new(name.clone()),
                transform,
                look_at: None,
                material: None,
                name: None,
            })
        };
        let Some(instances) = instances else {
            self.reach(&shown, &global);
            return Ok(vec![instance(Transform::default())]);
        };
        let mut transforms = Vec::new();
        for transform in self.instances(instances)? {
            let place = tree::affine(&transform);
            if place.inverse().is_none() {
                self.warn(instances, "an instance is left out: its scale leaves nothing of it");
                continue;
            }
            self.reach(&shown, &place.then(&global));
            transforms.push(Matrix(place));
        }
        if transforms.is_empty() {
            return Ok(Vec::new());
        }
        let (of, transform) = (Link::new(name.clone()), Transform::default());
        Ok(vec![Node::Instances(Instances {
            of,
            transforms,
            transform,
            look_at: None,
            material: None,
            name: None,
        })])
    }

    /// A mesh as one of the scene's objects, and the box around it; none where there is nothing to see.
    fn object(&mut self, mesh: &'a Json, shape: Shape<'_>) -> Result<Option<Object>> {
        let key = (mesh.start, shape.weights.iter().map(|w| w.to_bits()).collect::<Vec<u64>>());
        if let Some(known) = self.objects.get(&key) {
            return Ok(known.clone());
        }
        let shown = self.mesh(mesh, shape)?;
        let object = if shown.nodes.is_empty() {
            None
        } else {
            let wanted = mesh.get("name").map_or(Ok(""), text)?;
            let wanted = if wanted.is_empty() { "mesh" } else { wanted };
            let mut name = wanted.to_owned();
            let mut count = 1;
            while self.scene.objects.get(&name).is_some() {
                count += 1;
                name = format!("{wanted} ({count})");
            }
            let node = placed(shown.nodes, Transform::default(), None);
            self.scene.objects.insert(name.clone().into(), node);
            Some((name, shown.bounds))
        };
        self.objects.insert(key, object.clone());
        Ok(object)
    }

    /// The primitives of a mesh.
    fn mesh(&mut self, mesh: &'a Json, shape: Shape<'_>) -> Result<Shown> {
        let mut shown = Shown { nodes: Vec::new(), bounds: None };
        for primitive in required(mesh, "primitives")?.items() {
            let material = self.material_of(primitive)?;
            let (primary, directions) = (self.shining_set(material)?, self.direction_set(material)?);
            let shape = Shape { primary, directions, ..shape };
            let Some(mut known) = self.primitive(primitive, shape)? else { continue };
            if !self.is_double_sided(material)? {
                known.has.shows_backs = geometry::is_open(&self.made.assets.mesh(known.asset.handle).mesh);
            }
            shown.bounds = union(shown.bounds, known.bounds);
            let mut painted = None;
            if known.has.colours > 0 && self.shows_vertices(material)? {
                let picture;
                (known, picture) = self.painted(primitive, &known)?;
                painted = Some(picture);
            } else if known.has.colours > 0
                && self.is_unlit(material)?
                && let Some(colour) = unlit::even(&self.made.assets.mesh(known.asset.handle).mesh)
            {
                known.has.painted = true;
                painted = Some(Varying::Constant(colour));
            }
            let mut look = self.look(material, known.has)?;
            if let Some(picture) = painted {
                let factor = look.emission.take();
                look.emission = factor.map(|factor| material::scaled(factor, 1.0.into(), picture));
            }
            let surface = Surface {
                material: Some(material::named(&look)),
                two_sided_emission: look.both_sides,
                emission: look.emission,
                ..Surface::default()
            };
            let shading = if known.has_normals { Shading::Auto } else { Shading::Flat };
            shown.nodes.push(Node::Mesh(TriangleMesh {
                file: Some(known.asset),
                shading,
                surface,
                ..TriangleMesh::default()
            }));
        }
        Ok(shown)
    }

    /// The material of a primitive, by the variant that is chosen.
    fn material_of(&self, primitive: &'a Json) -> Result<Option<&'a Json>> {
        let own = primitive.get("material");
        let (Some(variant), Some(said)) = (self.variant, primitive.extension("KHR_materials_variants"))
        else {
            return Ok(own);
        };
        for mapping in required(said, "mappings")?.items() {
            for at in required(mapping, "variants")?.items() {
                if size(at)? == variant {
                    return Ok(Some(required(mapping, "material")?));
                }
            }
        }
        Ok(own)
    }

    /// A primitive's triangles; none where there are none.
    fn primitive(&mut self, primitive: &'a Json, shape: Shape<'_>) -> Result<Option<Known>> {
        let mode = match Mode::of(primitive)? {
            Ok(mode) => mode,
            Err(what) => {
                let message = if what == "points" {
                    "points are left out: they have no surface"
                } else {
                    "lines are left out: they have no surface"
                };
                self.warn(primitive, message);
                return Ok(None);
            }
        };
        if required(primitive, "attributes")?.get("POSITION").is_none()
            && primitive.extension("KHR_draco_mesh_compression").is_none()
        {
            self.warn(primitive, "a part of a mesh without positions is left out");
            return Ok(None);
        }
        let is_plain =
            shape.joints.is_none() && (shape.weights.is_empty() || primitive.get("targets").is_none());
        let key = is_plain
            .then(|| format!("{} {:?} {}", shape.primary, shape.directions, self.key(primitive, mode)));
        if let Some(known) = key.as_ref().and_then(|key| self.primitives.get(key)) {
            return Ok(Some(known.clone()));
        }
        let made = geometry::read(&mut self.document, primitive, mode, shape, self.means.limits)?;
        for note in made.notes {
            self.warn(primitive, note);
        }
        let mesh = made.mesh;
        if mesh.triangles.is_empty() {
            return Ok(None);
        }
        self.vertices += mesh.positions.len() as u64;
        let most = self.means.limits.max_vertices;
        if self.vertices > most {
            return Err(Fault::of(
                primitive,
                format!("too many vertices in all meshes together: the limit is {most}"),
            ));
        }
        let bytes = mesh.heap_bytes();
        if let Some(shortage) = self.means.ledger.refuse(
            self.kept + bytes,
            || "the scene's meshes".to_owned(),
            "meshes of fewer triangles take less",
        ) {
            self.means.d.lacks_memory = true;
            return Err(Fault::of(primitive, shortage.to_string()));
        }
        self.kept += bytes;
        let mut has = Has { sets: [false; SETS], primary: shape.primary, ..Has::default() };
        has.sets[shape.primary] = !mesh.uvs.is_empty();
        for attribute in &mesh.attributes {
            if attribute.name == "color" {
                has.colours = attribute.channels;
            }
            for set in (0..SETS).filter(|set| *set != shape.primary) {
                has.sets[set] |= attribute.name == geometry::set_name(set, shape.primary);
            }
        }
        let bounds = bounds(&mesh);
        let called = {
            let (_, path) = self.document.place((primitive.start, primitive.end));
            let path = path.trim_matches(['`', ':', ' ']).to_owned();
            let again = self.meshes;
            self.meshes += 1;
            if is_plain {
                format!("{}#{path}", self.name)
            } else {
                format!("{}#{path} shape {again}", self.name)
            }
        };
        let asset = self.made.mesh(called, MeshAsset { mesh: mesh.into(), ..MeshAsset::default() });
        let known = Known { asset, has, has_normals: made.has_normals, bounds };
        if let Some(key) = key {
            self.primitives.insert(key, known.clone());
        }
        Ok(Some(known))
    }

    /// What tells one primitive's triangles from another's.
    fn key(&self, primitive: &Json, mode: Mode) -> String {
        let mut key = format!("{mode:?}");
        let parts = ["attributes", "indices"].map(|key| primitive.get(key));
        let draco = primitive.extension("KHR_draco_mesh_compression").and_then(|d| d.get("bufferView"));
        let index = |v: &Json| v.number().map_or(String::new(), |v| v.to_string());
        for part in parts.into_iter().chain([draco]) {
            key += "|";
            let Some(part) = part else { continue };
            key += &index(part);
            for (name, at) in part.entries() {
                key += &format!(" {name}={}", index(at));
            }
        }
        key
    }

    /// Where the instances of a mesh stand.
    fn instances(&mut self, said: &'a Json) -> Result<Vec<Transform>> {
        let attributes = required(said, "attributes")?;
        let mut lists = [Vec::new(), Vec::new()];
        for (list, key) in lists.iter_mut().zip(["TRANSLATION", "SCALE"]) {
            if let Some(at) = attributes.get(key) {
                let numbers = self.document.numbers(at)?;
                *list = numbers.lists::<3>().ok_or_else(|| Fault::of(at, "three numbers each are wanted"))?;
            }
        }
        let mut turns = Vec::new();
        if let Some(at) = attributes.get("ROTATION") {
            let numbers = self.document.numbers(at)?;
            turns = numbers.lists::<4>().ok_or_else(|| Fault::of(at, "four numbers each are wanted"))?;
        }
        let [moves, scales] = lists;
        let counts = [moves.len(), turns.len(), scales.len()];
        let count = counts.into_iter().find(|n| *n > 0).unwrap_or(0);
        if counts.into_iter().any(|n| n != 0 && n != count) {
            return Err(Fault::of(attributes, "there must be as many of each"));
        }
        let bytes = (count * (size_of::<Transform>() + size_of::<Matrix>())) as u64;
        if let Some(shortage) =
            self.means.ledger.refuse(bytes, || format!("{count} instances"), "fewer instances take less")
        {
            self.means.d.lacks_memory = true;
            return Err(Fault::of(attributes, shortage.to_string()));
        }
        let double3 = |v: &[f32; 3]| v.map(f64::from);
        Ok((0..count)
            .map(|i| {
                let turn = turns.get(i).map(|v| v.map(f64::from));
                tree::steps(moves.get(i).map(double3), turn, scales.get(i).map(double3))
            })
            .collect())
    }

    /// From the bind pose of each joint of a skin to where the joint is.
    fn joints(&mut self, tree: &Tree<'a>, skin: &Json) -> Result<Vec<Affine>> {
        let (_, skin) = self.document.item("skins", skin)?;
        let joints = required(skin, "joints")?.items();
        let inverse = match skin.get("inverseBindMatrices") {
            Some(at) => {
                let numbers = self.document.numbers(at)?;
                let lists = numbers.lists::<16>().filter(|lists| lists.len() >= joints.len());
                lists.ok_or_else(|| Fault::of(at, "a matrix for each joint is wanted"))?
            }
            None => Vec::new(),
        };
        let mut out = Vec::new();
        for (i, at) in joints.iter().enumerate() {
            let (node, _) = in_list("nodes", tree.nodes, at)?;
            let global = tree.globals[node].unwrap_or(Affine::IDENTITY);
            let bind = inverse.get(i).map_or(Affine::IDENTITY, |m| Affine {
                rows: std::array::from_fn(|r| std::array::from_fn(|c| f64::from(m[4 * c + r]))),
            });
            out.push(bind.then(&global));
        }
        Ok(out)
    }

    /// Takes note of where something is, for a camera that shows all.
    fn reach(&mut self, shown: &Shown, place: &Affine) {
        let Some([min, max]) = shown.bounds else { return };
        for corner in 0..8 {
            let pick = |bit: u32, a: f64, b: f64| if corner >> bit & 1 == 0 { a } else { b };
            let p =
                place.point(DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z)));
            if p.to_array().iter().all(|v| v.is_finite()) {
                self.corners.push(p);
            }
        }
    }
}

/// Several nodes as one that is placed.
fn placed(mut nodes: Vec<Node>, transform: Transform, name: Option<Name>) -> Node {
    if let [only] = nodes.as_mut_slice() {
        match only {
            Node::Mesh(mesh) if mesh.surface.transform.steps.is_empty() && mesh.surface.name.is_none() => {
                (mesh.surface.transform, mesh.surface.name) = (transform, name);
                return nodes.remove(0);
            }
            Node::Instance(instance) if instance.transform.steps.is_empty() && instance.name.is_none() => {
                (instance.transform, instance.name) = (transform, name);
                return nodes.remove(0);
            }
            Node::Instances(instances) => {
                (instances.transform, instances.name) = (transform, name);
                return nodes.remove(0);
            }
            _ => {}
        }
    }
    Node::Group(Group { transform, look_at: None, material: None, children: nodes, name })
}

/// The box around what is finite of a mesh.
fn bounds(mesh: &Mesh) -> Option<[DVec3; 2]> {
    let mut found: Option<[DVec3; 2]> = None;
    for p in mesh.positions.iter().filter(|p| p.iter().all(|v| v.is_finite())) {
        let p = DVec3::from_array(p.map(f64::from));
        found = union(found, Some([p, p]));
    }
    found
}

fn union(a: Option<[DVec3; 2]>, b: Option<[DVec3; 2]>) -> Option<[DVec3; 2]> {
    match (a, b) {
        (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
        (a, b) => a.or(b),
    }
}
