//! How much memory a scene will need, before anything is rendered.

mod search;

use crate::Assets;
use crate::desc::{Bezier, BezierPatches, Channels, MeshSource, Node, SamplerKind, Scene, TriangleMesh};

/// Bytes that a scene needs while it is rendered, and what it is made of. Rough by nature: a search tree's size
/// depends on where the triangles are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Forecast {
    /// Triangles that are kept, those of an object or file once.
    pub triangles: u64,
    /// Vertices that are kept.
    pub vertices: u64,
    /// Triangles and other shapes that rays can meet, instances counted each time.
    pub visible: u64,
    /// Bytes of meshes.
    pub mesh_bytes: u64,
    /// Bytes of the search structures.
    pub search_bytes: u64,
    /// Bytes of pictures.
    pub image_bytes: u64,
    /// Bytes of the film.
    pub film_bytes: u64,
}

/// Position (12), normal (12) and texture coordinates (8), as the reader gives them and as the renderer keeps them.
const VERTEX: u64 = 2 * (12 + 12 + 8);

/// Three indices, twice as well.
const TRIANGLE: u64 = 2 * 12;

/// An RGB pixel of three `f32` (12), the renderer's four lanes (16), and its place in the sampling table (8).
const PIXEL: u64 = 12 + 16 + 8;

/// Sums of 128 bits of the colour, its square and the depth (7), of 64 bits of albedo and normal (6), two counts, padded to 16 bytes;
/// and the layers that they become (14 of 32 bits).
const FILM: u64 = 7 * 16 + 6 * 8 + 16 + 14 * 4;

/// By which noise is told of well-spread points: two sums of a colour. An EXR's layer `error` takes as much where nothing adapts.
const BATCHES: u64 = 2 * 3 * 8;

/// Sums of 128 bits of weighted colours (9) and weights (2).
const SPLAT: u64 = 11 * 16;

/// Control points of the built-in teapot make this many patches.
const TEAPOT_PATCHES: u64 = 32;

impl Forecast {
    /// All bytes together.
    pub fn total_bytes(&self) -> u64 {
        [self.search_bytes, self.image_bytes, self.film_bytes]
            .iter()
            .fold(self.mesh_bytes, |sum, &b| sum.saturating_add(b))
    }
}

/// What a scene without errors will need.
pub fn forecast(scene: &Scene, assets: &Assets) -> Forecast {
    let mut f = Forecast::default();
    for asset in assets.meshes.values() {
        f.vertices += asset.mesh.positions.len() as u64;
        f.triangles += asset.mesh.triangles.len() as u64;
    }
    let (mut shapes, mut instances) = (0, 0);
    scene.visit(|node| match node {
        Node::Group(_) => {}
        Node::Instance(_) => instances += 1,
        Node::Mesh(m) if m.source() == MeshSource::Inline => {
            f.vertices += m.positions.len() as u64;
            f.triangles += m.triangles.len() as u64;
        }
        Node::Mesh(_) => {}
        Node::Bezier(b) => {
            let side = u64::from(b.resolution);
            f.vertices += patches(b) * (side + 1) * (side + 1);
            f.triangles += patches(b) * side * side * 2;
        }
        _ => shapes += 1,
    });
    f.mesh_bytes = f.vertices * VERTEX + f.triangles * TRIANGLE;
    f.search_bytes = search::bytes(&scene.accel.structure, f.triangles + shapes, instances);
    let pixels = |i: &crate::Image| (i.width as u64).saturating_mul(i.height as u64);
    f.image_bytes = assets.images.values().map(|i| pixels(i).saturating_mul(PIXEL)).sum();
    let bands = match &scene.film.channels {
        Channels::Spectral(s) => u64::from(s.bands),
        Channels::Rgb | Channels::Xyz => 0,
    };
    let mut each = FILM + (16 + 4) * bands;
    if scene.sampler.noise.is_some() && scene.sampler.kind != SamplerKind::Random {
        each += BATCHES;
    }
    if scene.film.splat {
        // Tiles of 16 x 16 hold sums for the pixels around them as well.
        let side = 16 + 2 * scene.film.filter.radius().ceil() as u64;
        each += (SPLAT + 16 * bands) * side * side / 256;
    }
    f.film_bytes = u64::from(scene.film.size[0]) * u64::from(scene.film.size[1]) * each;
    let mut visible = Visible { scene, assets, known: vec![None; scene.objects.len()] };
    f.visible = scene.world.iter().fold(0, |sum: u64, node| sum.saturating_add(visible.count(node)));
    f
}

fn patches(b: &Bezier) -> u64 {
    match b.source() {
        BezierPatches::Builtin(_) => TEAPOT_PATCHES,
        BezierPatches::Inline => b.patches.len() as u64,
    }
}

struct Visible<'a> {
    scene: &'a Scene,
    assets: &'a Assets,
    known: Vec<Option<u64>>,
}

impl Visible<'_> {
    fn count(&mut self, node: &Node) -> u64 {
        match node {
            Node::Group(g) => g.children.iter().fold(0, |sum: u64, n| sum.saturating_add(self.count(n))),
            Node::Instance(i) => self.scene.objects.position(&i.of).map_or(0, |i| self.object(i)),
            Node::Mesh(m) => self.mesh(m),
            Node::Bezier(b) => patches(b) * u64::from(b.resolution) * u64::from(b.resolution) * 2,
            _ => 1,
        }
    }

    /// Validation has made sure that objects end.
    fn object(&mut self, i: usize) -> u64 {
        if let Some(known) = self.known[i] {
            return known;
        }
        let scene = self.scene;
        let count = scene.objects.at(i).map_or(0, |(_, node)| self.count(node));
        self.known[i] = Some(count);
        count
    }

    fn mesh(&self, m: &TriangleMesh) -> u64 {
        match m.source() {
            MeshSource::Inline => m.triangles.len() as u64,
            MeshSource::File(f) => self.assets.mesh(f).map_or(0, |a| a.mesh.triangles.len() as u64),
        }
    }
}
