//! What a scene's world will hold, counted before any of it is made: nothing is tessellated, copied or built for it. How much memory
//! that takes is not known here.

use crate::desc::{
    Bezier, BezierPatches, CurveBasis, CurveForm, EnvironmentLayout, Light, MaterialRef, MeshSource, Node,
    Scene, Shading, Subdivide, TriangleMesh,
};
use crate::glow::Glow;
use crate::value::Link;
use crate::{Assets, Handle};

/// What a world will hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// All that is kept, in the world itself and in the objects that it has instances of.
    pub kept: Tally,
    /// Triangles and other shapes that rays can meet, instances counted each time.
    pub visible: u64,
    /// What is in each space that gets a search structure of its own, the world's first.
    pub spaces: Vec<Space>,
    /// Pixels of each picture that is all around.
    pub surroundings: Vec<u64>,
}

/// What rays are searched for in one space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Space {
    /// Triangles.
    pub triangles: u64,
    /// Spheres.
    pub spheres: u64,
    /// Shapes of other kinds.
    pub shapes: u64,
    /// Instances of objects.
    pub instances: u64,
}

/// Numbers of things.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Triangles.
    pub triangles: u64,
    /// Vertices.
    pub vertices: u64,
    /// Those of them that have normals.
    pub normals: u64,
    /// Those of them that have texture coordinates.
    pub uvs: u64,
    /// Vertices whose normals are computed from the faces around them.
    pub smoothed: u64,
    /// Meshes, or parts of them with a material of their own.
    pub meshes: u64,
    /// Shapes that aren't meshes.
    pub shapes: u64,
    /// Spheres among them.
    pub spheres: u64,
    /// Discs among them, the caps of cylinders as well.
    pub discs: u64,
    /// Rectangles among them.
    pub rectangles: u64,
    /// Cylinders among them, without their caps.
    pub cylinders: u64,
    /// Other shapes among them that turn about an axis.
    pub revolved: u64,
    /// Pieces of curves among them.
    pub curves: u64,
    /// Instances of objects; where the material around them glows they are copies of all that is inside.
    pub instances: u64,
    /// Those of them in which something glows.
    pub lit_instances: u64,
    /// Surfaces that glow.
    pub lights: u64,
    /// Triangles of those.
    pub lit_triangles: u64,
}

impl Tally {
    fn add(&mut self, o: &Self) {
        let sum = |a: &mut u64, b: u64| *a = a.saturating_add(b);
        sum(&mut self.triangles, o.triangles);
        sum(&mut self.vertices, o.vertices);
        sum(&mut self.normals, o.normals);
        sum(&mut self.uvs, o.uvs);
        sum(&mut self.smoothed, o.smoothed);
        sum(&mut self.meshes, o.meshes);
        sum(&mut self.shapes, o.shapes);
        sum(&mut self.spheres, o.spheres);
        sum(&mut self.discs, o.discs);
        sum(&mut self.rectangles, o.rectangles);
        sum(&mut self.cylinders, o.cylinders);
        sum(&mut self.revolved, o.revolved);
        sum(&mut self.curves, o.curves);
        sum(&mut self.instances, o.instances);
        sum(&mut self.lit_instances, o.lit_instances);
        sum(&mut self.lights, o.lights);
        sum(&mut self.lit_triangles, o.lit_triangles);
    }

    /// So many times all of it.
    fn times(&self, count: u64) -> Self {
        let Self {
            triangles,
            vertices,
            normals,
            uvs,
            smoothed,
            meshes,
            shapes,
            spheres,
            discs,
            rectangles,
            cylinders,
            revolved,
            curves,
            instances,
            lit_instances,
            lights,
            lit_triangles,
        } = *self;
        let of = |n: u64| n.saturating_mul(count);
        Self {
            triangles: of(triangles),
            vertices: of(vertices),
            normals: of(normals),
            uvs: of(uvs),
            smoothed: of(smoothed),
            meshes: of(meshes),
            shapes: of(shapes),
            spheres: of(spheres),
            discs: of(discs),
            rectangles: of(rectangles),
            cylinders: of(cylinders),
            revolved: of(revolved),
            curves: of(curves),
            instances: of(instances),
            lit_instances: of(lit_instances),
            lights: of(lights),
            lit_triangles: of(lit_triangles),
        }
    }

    /// One mesh; of what its vertices have besides positions.
    fn mesh(triangles: u64, vertices: u64, [normals, uvs]: [bool; 2]) -> Self {
        let of = |is_held: bool| if is_held { vertices } else { 0 };
        Self { triangles, vertices, normals: of(normals), uvs: of(uvs), meshes: 1, ..Self::default() }
    }

    /// A shape of one of the kinds that are counted apart, or of another.
    fn shape(kind: Self) -> Self {
        Self { shapes: 1, ..kind }
    }
}

/// Parts of a curve's piece, on average, where it is long and thin.
const CURVE_PARTS: u64 = 4;

/// Control points of the built-in teapot make this many patches.
const TEAPOT_PATCHES: u64 = 32;

/// Counts what a scene without errors will hold.
pub fn count(scene: &Scene, assets: &Assets) -> Contents {
    let mut walk = Walk {
        scene,
        assets,
        glow: Glow::of(scene, assets),
        objects: vec![None; scene.objects.len()],
        kept: Tally::default(),
        spaces: vec![Space::default()],
    };
    let (mut world, mut visible) = (Tally::default(), 0_u64);
    for node in &scene.world {
        let found = walk.node(node);
        world.add(&found.own);
        visible = visible.saturating_add(found.visible);
    }
    walk.keep(&world, 0);
    let mut surroundings = Vec::new();
    for light in &scene.lights {
        if let Light::Environment(l) = light
            && let Some(file) = &l.file
        {
            let pixels = assets.image(file.handle).pixels.len() as u64;
            // In latitude and longitude it has twice as many.
            let is_square = l.layout == EnvironmentLayout::EqualArea;
            surroundings.push(if is_square { pixels.saturating_mul(2) } else { pixels });
        }
    }
    Contents { kept: walk.kept, visible, spaces: walk.spaces, surroundings }
}

impl Scene {
    /// Bytes of its nodes, and of the lists in them.
    pub fn heap_bytes(&self) -> u64 {
        let mut bytes = 0;
        self.visit(|node| {
            let lists = match node {
                Node::Mesh(TriangleMesh { positions, normals, uvs, triangles, .. }) => {
                    size_of_val(positions.as_slice())
                        + size_of_val(normals.as_slice())
                        + size_of_val(uvs.as_slice())
                        + size_of_val(triangles.as_slice())
                }
                Node::Bezier(b) => size_of_val(b.points.as_slice()) + size_of_val(b.patches.as_slice()),
                Node::Instances(i) => size_of_val(i.transforms.as_slice()),
                _ => 0,
            };
            bytes += (size_of::<Node>() + lists) as u64;
        });
        bytes
    }
}

/// A node, or an object, as it is found.
#[derive(Clone, Copy, Default)]
struct Found {
    /// What it brings to the space that it stands in.
    own: Tally,
    visible: u64,
    /// Whether anything inside glows.
    glows: bool,
}

struct Walk<'a> {
    scene: &'a Scene,
    assets: &'a Assets,
    glow: Glow<'a>,
    /// What each object that was met holds.
    objects: Vec<Option<Found>>,
    kept: Tally,
    spaces: Vec<Space>,
}

impl Walk<'_> {
    /// Takes note of what stands in a space.
    fn keep(&mut self, own: &Tally, space: usize) {
        self.kept.add(own);
        self.spaces[space] = Space {
            triangles: own.triangles,
            spheres: own.spheres,
            shapes: own.shapes - own.spheres,
            instances: own.instances,
        };
    }

    /// So many instances of an object.
    fn instances(&mut self, of: &Link<Node>, material: Option<&MaterialRef>, count: u64) -> Found {
        let Some(object) = of.to() else { return Found::default() };
        let inside = self.object(object);
        let visible = inside.visible.saturating_mul(count);
        if self.glow.material(material) {
            return Found { own: inside.own.times(count), visible, ..inside };
        }
        let lit_instances = if inside.glows { count } else { 0 };
        Found { own: Tally { instances: count, lit_instances, ..Tally::default() }, visible, ..inside }
    }

    fn node(&mut self, node: &Node) -> Found {
        match node {
            Node::Group(g) => {
                let mut all = Found::default();
                for child in &g.children {
                    let found = self.node(child);
                    all.own.add(&found.own);
                    all.visible = all.visible.saturating_add(found.visible);
                    all.glows |= found.glows;
                }
                all
            }
            Node::Instance(i) => self.instances(&i.of, i.material.as_ref(), 1),
            Node::Instances(i) => self.instances(&i.of, i.material.as_ref(), i.transforms.len() as u64),
            Node::Mesh(m) => self.mesh(node, m),
            Node::Bezier(b) => {
                let side = u64::from(b.resolution);
                let [quads, vertices] =
                    [side * side, (side + 1) * (side + 1)].map(|n| n.saturating_mul(patches(b)));
                let normals = !matches!(b.shading, Shading::Flat);
                self.lit(node, Tally::mesh(quads.saturating_mul(2), vertices, [normals, true]))
            }
            Node::Box(_) => self.lit(node, Tally::mesh(12, 24, [false, true])),
            Node::Triangle(_) => self.lit(node, Tally::mesh(1, 3, [false, false])),
            Node::Sphere(_) => self.lit(node, Tally::shape(Tally { spheres: 1, ..Tally::default() })),
            Node::Cylinder(c) if c.caps => {
                let parts = Tally { shapes: 3, cylinders: 1, discs: 2, ..Tally::default() };
                let mut found = self.lit(node, parts);
                found.own.lights *= 3;
                found
            }
            Node::Cone(c) if c.caps => {
                let discs = if c.top_radius > 0.0 { 2 } else { 1 };
                let mut found =
                    self.lit(node, Tally { shapes: 1 + discs, discs, revolved: 1, ..Tally::default() });
                found.own.lights *= 1 + discs;
                found
            }
            Node::Cone(_)
            | Node::Annulus(_)
            | Node::Torus(_)
            | Node::Paraboloid(_)
            | Node::Hyperboloid(_)
            | Node::Capsule(_) => self.lit(node, Tally::shape(Tally { revolved: 1, ..Tally::default() })),
            Node::HeightField(h) => {
                let [width, depth] = match &h.file {
                    Some(file) => {
                        let texels = &self.assets.bitmap(file.handle).texels;
                        [texels.width(), texels.height()]
                    }
                    None => [h.heights.first().map_or(0, Vec::len), h.heights.len()],
                };
                let quads = (width.saturating_sub(1) * depth.saturating_sub(1)) as u64;
                let normals = !matches!(h.shading, Shading::Flat);
                let mut own = Tally::mesh(2 * quads, (width * depth) as u64, [normals, true]);
                own.smoothed = if normals { own.vertices } else { 0 };
                self.lit(node, own)
            }
            Node::Curves(c) => {
                let pieces = c.runs().filter_map(|run| c.pieces(run.len())).sum::<usize>() as u64;
                if c.basis == CurveBasis::Linear && c.form == CurveForm::Round {
                    let own = Tally { shapes: pieces, revolved: pieces, ..Tally::default() };
                    return lights(self.lit(node, own), pieces);
                }
                // A long piece is kept in several.
                let parts = pieces.saturating_mul(CURVE_PARTS);
                lights(self.lit(node, Tally { shapes: parts, curves: parts, ..Tally::default() }), parts)
            }
            Node::Union(c) | Node::Intersection(c) | Node::Difference(c) => {
                let mut all = Tally::default();
                for child in &c.of {
                    let own = self.node(child).own;
                    // A mesh of a combination is a face in the world.
                    all.add(&Tally { shapes: own.shapes.saturating_add(own.meshes), ..own });
                }
                self.lit(node, Tally { lights: 0, lit_triangles: 0, ..all })
            }
            Node::Disc(_) => self.lit(node, Tally::shape(Tally { discs: 1, ..Tally::default() })),
            Node::Rectangle(_) => self.lit(node, Tally::shape(Tally { rectangles: 1, ..Tally::default() })),
            Node::Cylinder(_) => self.lit(node, Tally::shape(Tally { cylinders: 1, ..Tally::default() })),
            _ => self.lit(node, Tally::shape(Tally::default())),
        }
    }

    /// Validation has made sure that objects end.
    fn object(&mut self, object: Handle<Node>) -> Found {
        let i = object.index();
        if let Some(known) = self.objects.get(i).copied().flatten() {
            return known;
        }
        let scene = self.scene;
        let Some((_, node)) = scene.objects.at(object) else { return Found::default() };
        let found = self.node(node);
        self.objects[i] = Some(found);
        self.spaces.push(Space::default());
        self.keep(&found.own, self.spaces.len() - 1);
        found
    }

    fn mesh(&self, node: &Node, m: &TriangleMesh) -> Found {
        let smooth = |has: bool| match m.shading {
            Shading::Flat => false,
            Shading::Smooth(_) | Shading::Gouraud(_) => true,
            Shading::Auto => has,
        };
        let smoothed = |has: bool, vertices: u64| {
            let recompute = match &m.shading {
                Shading::Smooth(s) => Some(s.recompute),
                Shading::Gouraud(s) => Some(s.recompute),
                Shading::Flat | Shading::Auto => None,
            };
            let computed = recompute.is_some_and(|recompute| !has || recompute);
            if computed { vertices } else { 0 }
        };
        let asset = match m.source() {
            MeshSource::Inline => {
                let mut own = Tally::mesh(
                    m.triangles.len() as u64,
                    m.positions.len() as u64,
                    [smooth(!m.normals.is_empty()), !m.uvs.is_empty()],
                );
                own.smoothed = smoothed(!m.normals.is_empty(), own.vertices);
                if let Some(how) = &m.subdivide {
                    own = subdivided(own, 3 * own.triangles, how);
                }
                return self.lit(node, own);
            }
            MeshSource::Asset(asset) => self.assets.mesh(asset.handle),
        };
        let mesh = &asset.mesh;
        let mut own = Tally::mesh(
            mesh.triangles.len() as u64,
            mesh.positions.len() as u64,
            [smooth(!mesh.normals.is_empty()), !mesh.uvs.is_empty()],
        );
        own.smoothed = smoothed(!mesh.normals.is_empty(), own.vertices);
        if let Some(how) = &m.subdivide {
            own = subdivided(own, mesh.corners(), how);
        }
        if m.surface.material.is_none() && !asset.materials.is_empty() {
            let mut names: Vec<_> = mesh.parts.iter().map(|p| p.material.as_deref()).collect();
            names.sort_unstable();
            names.dedup();
            own.meshes = (names.len() as u64).max(1);
        }
        self.lit(node, own)
    }

    /// What a surface holds, which may glow.
    fn lit(&self, node: &Node, own: Tally) -> Found {
        let (glows, visible) = (self.glow.node(node), own.triangles.saturating_add(own.shapes));
        if !glows {
            return Found { own, visible, glows };
        }
        let lights = if own.meshes > 0 { own.meshes } else { 1 };
        Found { own: Tally { lights, lit_triangles: own.triangles, ..own }, visible, glows }
    }
}

/// What glows in so many pieces.
fn lights(mut found: Found, pieces: u64) -> Found {
    found.own.lights = found.own.lights.saturating_mul(pieces);
    found
}

/// What a cage becomes whose polygons have so many corners in all.
fn subdivided(own: Tally, corners: u64, how: &Subdivide) -> Tally {
    let triangles = how.triangles(corners, own.triangles);
    // A smooth surface has about two triangles for a vertex.
    let vertices = if how.levels == 0 { own.vertices } else { triangles / 2 + own.vertices };
    let uvs = if own.uvs > 0 { vertices } else { 0 };
    Tally { triangles, vertices, normals: vertices, uvs, ..own }
}

fn patches(b: &Bezier) -> u64 {
    match b.source() {
        BezierPatches::Builtin(_) => TEAPOT_PATCHES,
        BezierPatches::Inline => b.patches.len() as u64,
    }
}
