//! Nodes: groups, objects and their copies, and the meshes that they show.

use std::ops::Range;
use std::sync::Arc;

use serde_json::{Map, Value as Json, json};
use straal_math::Affine;
use straal_scene::desc::{MaterialRef, MeshSource, Node, Shading, Surface, TriangleMesh};
use straal_scene::value::Link;
use straal_scene::{Mesh, MeshAsset};

use super::Out;
use super::geometry::{Form, Normals};
use super::material::Look;

/// A node that is placed.
pub(super) fn placed(place: &Affine) -> Map<String, Json> {
    let mut node = Map::new();
    if !place.is_identity() {
        // Column by column.
        let m: Vec<f64> = (0..16)
            .map(|i| match i % 4 {
                3 => f64::from(u8::from(i == 15)),
                row => place.rows[row][i / 4],
            })
            .collect();
        node.insert("matrix".to_owned(), json!(m));
    }
    node
}

impl<'a> Out<'a> {
    /// The nodes of the world.
    pub fn world(&mut self) -> Vec<usize> {
        let scene = self.scene;
        let nodes = scene.world.iter().filter_map(|node| self.node(node, None, 0)).collect();
        if self.nodes.items.len() >= self.most {
            self.tell(format!("nodes beyond the first {} are left out", self.most));
        }
        nodes
    }

    /// A node and all in it; none where it shows nothing. `around` is the material that it has if it doesn't say one.
    fn node(&mut self, node: &'a Node, around: Option<&'a MaterialRef>, depth: usize) -> Option<usize> {
        // Objects aren't within themselves, which is checked; so deep none are.
        const DEEPEST: usize = 200;
        if self.nodes.items.len() >= self.most || depth > DEEPEST {
            return None;
        }
        let place = node.placement()?;
        let track = self.frames.and_then(|frames| frames.of_node(node));
        if track.is_none() && !node.motion().is_empty() {
            self.tell("what moves stands where it is when the shutter opens");
        }
        if is_slanted(&place) {
            self.tell("matrices that slant are written, which not every program reads");
        }
        let (mut out, parts) = self.standing(&place, track);
        let material = node.material().or(around);
        let name = match node {
            Node::Group(g) => g.name.as_ref(),
            Node::Instance(i) => i.name.as_ref(),
            Node::Instances(i) => i.name.as_ref(),
            other => other.surface().and_then(|s| s.name.as_ref()),
        };
        if let Some(name) = name {
            out.insert("name".to_owned(), json!(name.value));
        }
        let shown = match node {
            Node::Group(g) => {
                let children = &g.children;
                let nodes = children.iter().filter_map(|child| self.node(child, material, depth + 1));
                Shown::Nodes(nodes.collect())
            }
            Node::Instance(i) => self.copy(&i.of, material, depth)?,
            Node::Instances(i) => {
                let mut copies = Vec::new();
                for matrix in &i.transforms {
                    if self.nodes.items.len() >= self.most {
                        break;
                    }
                    let mut copy = placed(&matrix.0);
                    if let Some(shown) = self.copy(&i.of, material, depth) {
                        shown.put(&mut copy);
                        copies.push(self.nodes.add(copy.into()));
                    }
                }
                Shown::Nodes(copies)
            }
            _ => Shown::Mesh(self.mesh(node, material)?),
        };
        shown.put(&mut out)?;
        let index = self.nodes.add(out.into());
        self.moves(index, &parts);
        Some(index)
    }

    /// What a copy of an object shows: where the object is a mesh that stands at the origin, that mesh.
    fn copy(&mut self, of: &Link<Node>, material: Option<&'a MaterialRef>, depth: usize) -> Option<Shown> {
        let object = self.scene.objects.of(of)?;
        let is_plain = !matches!(object, Node::Group(_) | Node::Instance(_) | Node::Instances(_))
            && object.placement().is_some_and(|place| place.is_identity())
            && self.frames.is_none_or(|frames| frames.of_node(object).is_none());
        if is_plain {
            return Some(Shown::Mesh(self.mesh(object, object.material().or(material))?));
        }
        Some(Shown::Nodes(vec![self.node(object, material, depth + 1)?]))
    }

    /// The mesh that a surface becomes.
    fn mesh(&mut self, node: &'a Node, material: Option<&'a MaterialRef>) -> Option<usize> {
        let surface = node.surface()?;
        self.links(&surface.lamp);
        if surface.emission.is_some() && surface.emission_spread < 180.0 {
            self.tell("what glows does so in all directions in front of it");
        }
        let (mesh, normals, parts) = match node {
            Node::Mesh(described) => self.triangles(node, described, surface)?,
            _ => (self.shape(node)?, Normals::Own, Vec::new()),
        };
        let mut primitives = Vec::new();
        let parts = if parts.is_empty() { vec![(0..mesh.triangles.len(), None)] } else { parts };
        for (range, part) in parts {
            let Look { index, is_painted } = match part {
                Some(part) => self.look(Some(&part.material), None, surface, part.emission.as_ref()),
                None => {
                    let (found, name) = self.material(material);
                    self.look(found, name, surface, None)
                }
            };
            let form = Form { normals, flip: surface.flip, is_painted };
            if let Some(mut primitive) = self.primitive(&mesh, &range, form) {
                primitive["material"] = json!(index);
                primitives.push(primitive);
            }
        }
        if primitives.is_empty() {
            self.tell("meshes without a triangle are left out");
            return None;
        }
        Some(self.meshes.once(json!({ "primitives": primitives })))
    }

    /// A mesh's triangles, its normals, and the parts that have materials of its file.
    fn triangles(
        &mut self,
        node: &Node,
        described: &TriangleMesh,
        surface: &Surface,
    ) -> Option<Triangles<'a>> {
        if described.subdivide.is_some() {
            self.tell("meshes that are subdivided are written as their cages");
        }
        let normals = match &described.shading {
            Shading::Auto => Normals::Own,
            Shading::Flat => Normals::None,
            Shading::Smooth(s) if s.recompute || s.crease < 180.0 => Normals::Mean,
            Shading::Smooth(_) => Normals::Smooth,
            Shading::Gouraud(_) => {
                self.tell("meshes whose colours are those of vertices (Gouraud) are shaded at each point");
                Normals::Smooth
            }
        };
        if normals == Normals::Mean {
            self.tell("normals that are computed are the mean of the faces around, over edges as well");
        }
        let assets = self.assets;
        let MeshSource::Asset(asset) = described.source() else {
            let key = std::ptr::from_ref(node) as usize;
            let made = self.made.entry(key).or_insert_with(|| Some(Arc::new(inline(described))));
            return Some((made.clone()?, normals, Vec::new()));
        };
        let MeshAsset { mesh, materials } = assets.mesh(asset.handle);
        let mut parts = Vec::new();
        if surface.material.is_none() {
            for part in &mesh.parts {
                let own = part.material.as_ref().and_then(|name| materials.get(name));
                parts.push((part.triangles.clone(), own));
            }
        }
        Some((mesh.clone(), normals, parts))
    }
}

/// A mesh, its normals, and the parts of it that have materials of their own.
type Triangles<'a> = (Arc<Mesh>, Normals, Vec<(Range<usize>, Option<&'a straal_scene::PartMaterial>)>);

/// What a node shows.
enum Shown {
    Mesh(usize),
    Nodes(Vec<usize>),
}

impl Shown {
    /// Has a node show it; none where there is nothing.
    fn put(self, node: &mut Map<String, Json>) -> Option<()> {
        match self {
            Self::Mesh(mesh) => node.insert("mesh".to_owned(), json!(mesh)),
            Self::Nodes(nodes) if nodes.is_empty() => return None,
            Self::Nodes(nodes) => node.insert("children".to_owned(), json!(nodes)),
        };
        Some(())
    }
}

/// A mesh that the scene's text writes out.
fn inline(described: &TriangleMesh) -> Mesh {
    let single = |v: &straal_math::DVec3| v.to_array().map(|v| v as f32);
    Mesh {
        positions: described.positions.iter().map(single).collect(),
        normals: described.normals.iter().map(single).collect(),
        uvs: described.uvs.iter().map(|uv| uv.map(|v| v as f32)).collect(),
        tangents: described.tangents.iter().map(|t| t.map(|v| v as f32)).collect(),
        triangles: described.triangles.clone(),
        ..Mesh::default()
    }
}

/// Whether a map isn't made of scale, turn and move alone: its axes aren't at right angles.
pub(super) fn is_slanted(place: &Affine) -> bool {
    use straal_math::DVec3;
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| place.vector(axis).try_normalize());
    let [Some(x), Some(y), Some(z)] = axes else { return true };
    [x.dot(y), y.dot(z), z.dot(x)].iter().any(|v| v.abs() > 1e-6)
}
