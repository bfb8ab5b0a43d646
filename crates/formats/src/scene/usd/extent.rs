//! Where all that is seen lies, for a camera that shows it.

use std::collections::BTreeMap;

use straal_math::{Affine, DVec3};
use straal_scene::desc::{MeshSource, Node, Scene};
use straal_scene::{Assets, Mesh, handle::Handle};

/// So many corners are enough to tell from.
const MOST: usize = 200_000;

type Bounds = Option<[DVec3; 2]>;

/// Corners of boxes around all that is seen.
pub(super) fn corners(scene: &Scene, assets: &Assets) -> Vec<DVec3> {
    let mut walk =
        Walk { scene, assets, meshes: BTreeMap::new(), objects: BTreeMap::new(), corners: Vec::new() };
    for node in &scene.world {
        walk.node(node, &Affine::IDENTITY);
    }
    walk.corners
}

struct Walk<'s> {
    scene: &'s Scene,
    assets: &'s Assets,
    meshes: BTreeMap<Handle<Mesh>, Bounds>,
    objects: BTreeMap<String, Bounds>,
    corners: Vec<DVec3>,
}

impl Walk<'_> {
    fn node(&mut self, node: &Node, above: &Affine) {
        if self.corners.len() > MOST {
            return;
        }
        let Some(placed) = node.placement() else { return };
        let here = placed.then(above);
        match node {
            Node::Group(group) => group.children.iter().for_each(|child| self.node(child, &here)),
            Node::Instance(instance) => {
                let bounds = self.object(&instance.of.name.value);
                self.reach(bounds, &here);
            }
            Node::Instances(instances) => {
                let bounds = self.object(&instances.of.name.value);
                for place in &instances.transforms {
                    self.reach(bounds, &place.0.then(&here));
                }
            }
            Node::Mesh(mesh) => {
                let MeshSource::Asset(asset) = mesh.source() else { return };
                let assets = self.assets;
                let bounds = *self.meshes.entry(asset.handle).or_insert_with(|| {
                    let mesh = &assets.mesh(asset.handle).mesh;
                    around(mesh.positions.iter().map(|p| DVec3::from_array(p.map(f64::from))))
                });
                self.reach(bounds, &here);
            }
            Node::Sphere(s) => self.reach(ball(s.center, s.radius), &here),
            Node::Box(s) => self.reach(Some([s.min, s.max]), &here),
            Node::Disc(s) => self.reach(ball(s.center, s.radius), &here),
            Node::Rectangle(s) => {
                let [a, b] = s.edges;
                let ends = [s.corner, s.corner + a, s.corner + b, s.corner + a + b];
                self.reach(around(ends.into_iter()), &here);
            }
            Node::Cylinder(s) => self.reach(along(s.from, s.to, s.radius), &here),
            Node::Cone(s) => {
                let radius = if s.radius > s.top_radius { s.radius } else { s.top_radius };
                self.reach(along(s.from, s.to, radius), &here);
            }
            Node::Capsule(s) => self.reach(along(s.from, s.to, s.radius), &here),
            Node::Curves(s) => self.reach(around(s.points.iter().copied()), &here),
            _ => {}
        }
    }

    /// The box around an object, which is looked for once.
    fn object(&mut self, name: &str) -> Bounds {
        if let Some(known) = self.objects.get(name) {
            return *known;
        }
        let scene = self.scene;
        // One that is within itself has none.
        self.objects.insert(name.to_owned(), None);
        let outer = std::mem::take(&mut self.corners);
        if let Some(node) = scene.objects.get(name) {
            self.node(node, &Affine::IDENTITY);
        }
        let own = std::mem::replace(&mut self.corners, outer);
        let bounds = around(own.into_iter());
        self.objects.insert(name.to_owned(), bounds);
        bounds
    }

    /// Takes note of where a box is.
    fn reach(&mut self, bounds: Bounds, place: &Affine) {
        let Some([min, max]) = bounds else { return };
        if self.corners.len() > MOST {
            return;
        }
        for corner in 0..8_u32 {
            let pick = |bit: u32, a: f64, b: f64| if corner >> bit & 1 == 0 { a } else { b };
            let p = DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
            let p = place.point(p);
            if p.to_array().iter().all(|v| v.is_finite()) {
                self.corners.push(p);
            }
        }
    }
}

fn ball(center: DVec3, radius: f64) -> Bounds {
    along(center, center, radius)
}

fn along(from: DVec3, to: DVec3, radius: f64) -> Bounds {
    let r = DVec3::splat(radius);
    Some([from.min(to) - r, from.max(to) + r])
}

fn around(points: impl Iterator<Item = DVec3>) -> Bounds {
    let finite = points.filter(|p| p.to_array().iter().all(|v| v.is_finite()));
    finite.fold(None, |found: Bounds, p| Some(found.map_or([p, p], |[min, max]| [min.min(p), max.max(p)])))
}
