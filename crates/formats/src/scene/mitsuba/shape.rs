//! Shapes.
//!
//! Each is placed by one matrix: that of its own parameters (`center`, `radius`, `p0`), then `to_world`. Balls, tubes and discs stand about Mitsuba's z; straal's ball about y,
//! so that it is turned first, and so are its texture coordinates ([`Uv`]).

use std::sync::Arc;

use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    Cylinder, Disc, Group, Instance, Leaving, Node, Rectangle, Shading, Smoothing, Spectrum, Sphere, Surface,
    TriangleMesh, Varying,
};
use straal_scene::limit::Limit;
use straal_scene::value::{Asset, Link};
use straal_scene::{Diagnostic, Mesh, MeshAsset, Spanned, suggest};

use super::bsdf::Around;
use super::translate::{Translator, free_name};
use super::tree::{Class, Object, Value};
use super::uv::Uv;
use super::{bsdf, serialized};
use crate::files::{self, Refusal};

/// What every shape may have.
const COMMON: [&str; 6] =
    ["to_world", "interior", "exterior", "flip_normals", "silhouette_sampling_weight", "*"];

/// Straal's ball has its pole along y and begins at z; Mitsuba's along z, and begins at x.
const BALL: Affine = Affine { rows: [[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]] };

/// The most copies of triangles by way of references to shapes and groups; real scenes have instances.
const MOST_NODES: usize = 20_000_000;

impl<'o> Translator<'o, '_, '_> {
    /// A shape, as what it becomes.
    pub fn shape(&mut self, i: usize) -> Vec<Node> {
        let o: &'o Object = &self.objects[i];
        self.nodes += 1;
        if self.nodes > MOST_NODES {
            if self.nodes == MOST_NODES + 1 {
                self.fail(o.plugin.span, "shapes refer to one another too often");
            }
            return Vec::new();
        }
        let one = match o.plugin.as_str() {
            "sphere" => self.sphere(o),
            "cylinder" => self.cylinder(o),
            "disk" => self.disc(o),
            "rectangle" => self.rectangle(o),
            "cube" => self.cube(o),
            "obj" | "ply" => self.mesh_file(o),
            "serialized" => self.serialized(o),
            "bsplinecurve" | "linearcurve" | "hair" => self.curves(o),
            "sdfgrid" => self.distances(o),
            "heightfield" => self.heights(o),
            "ellipsoids" | "ellipsoidsmesh" => self.ellipsoids(i),
            "shapegroup" => {
                self.group(i);
                None
            }
            "instance" => self.instance(o),
            "merge" => {
                self.only(o, &COMMON);
                let inner = self.inside(o, Class::Shape);
                return inner.into_iter().flat_map(|inner| self.shape(inner)).collect();
            }
            _ => {
                self.unsupported(o, "it is left out");
                None
            }
        };
        one.into_iter().collect()
    }

    fn known(&mut self, o: &'o Object, more: &[&str]) {
        self.only(o, &[&COMMON, more].concat());
    }

    /// What all surfaces share. `flip` says whether front and back change places.
    pub(super) fn surface(&mut self, o: &'o Object, at: &Affine, uv: Uv, flip: bool) -> Surface {
        let emitter = self.inside(o, Class::Emitter).first().copied();
        let emission = emitter.and_then(|e| self.area_light(e, uv));
        let media = |t: &Self, name: &str| match t.get(o, name).map(|p| &p.value) {
            Some(Value::Object(i)) if t.objects[*i].class == Class::Medium => Some(*i),
            _ => None,
        };
        let (interior, exterior) = (media(self, "interior"), media(self, "exterior"));
        if let Some(medium) = exterior {
            self.medium_is_left_out(medium, "nothing is there instead");
        }
        let codes = self.codes_in_hand();
        let around = Around { uv, interior: interior.map_or(0, |m| m + 1), codes, ..Around::default() };
        let parts = self.inside(o, Class::Bsdf);
        if let [_, more, ..] = parts[..] {
            self.warn(self.objects[more].plugin.span, "a shape has one BSDF: the first counts");
        }
        let material = match parts.first() {
            Some(&part) => Some(self.bsdf(part, around)),
            None => {
                if let Some(medium) = interior {
                    self.medium_is_left_out(medium, "nothing is there instead");
                }
                let is_boundary =
                    o.is_old && (interior.is_some() || exterior.is_some()) && emission.is_none();
                let made = if is_boundary {
                    bsdf::nothing()
                } else {
                    // As it is there: a surface that shines reflects nothing unless it says so.
                    let share = if emission.is_some() { 0.0 } else { 0.5 };
                    let reflectance = Varying::Constant(Spectrum::grey(share));
                    straal_scene::desc::Material::Diffuse(straal_scene::desc::Diffuse {
                        reflectance,
                        two_sided: false,
                        ..Default::default()
                    })
                };
                Some(straal_scene::desc::MaterialRef::Inline(Box::new(made)))
            }
        };
        for inner in self.inside(o, Class::Subsurface) {
            let inner: &'o Object = &self.objects[inner];
            self.unsupported(inner, "the surface alone is seen");
        }
        let name = o.id.clone().map(|id| Spanned::new(id, o.plugin.span));
        let lamp = if emission.is_some() { self.lamp() } else { Default::default() };
        Surface { material, emission, transform: self.moving(o, at), flip, name, lamp, ..Surface::default() }
    }

    /// Where a shape stands whose own parameters are `own`.
    pub(super) fn placed(&mut self, o: &'o Object, own: &Affine) -> Affine {
        let to_world = self.world_of(o);
        let all = own.then(&to_world);
        if all.inverse().is_none() || !all.is_finite() {
            self.fail(o.plugin.span, format!("this {} has no size", suggest::brief(&o.plugin)));
            return Affine::IDENTITY;
        }
        all
    }

    pub(super) fn flips(&mut self, o: &'o Object) -> bool {
        self.boolean(o, "flip_normals").unwrap_or(false)
    }

    fn sphere(&mut self, o: &'o Object) -> Option<Node> {
        self.known(o, &["center", "radius"]);
        let center = self.vector(o, "center").unwrap_or(DVec3::ZERO);
        let radius = self.within(o, "radius", 1.0, Limit::POSITIVE);
        let own = BALL.then(&Affine::scale(DVec3::splat(radius))).then(&Affine::translate(center));
        let at = self.placed(o, &own);
        let flip = self.flips(o);
        let surface = self.surface(o, &at, Uv::Ball, flip);
        Some(Node::Sphere(Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
            heights: None,
            phi: [0.0, 360.0],
            surface,
        }))
    }

    fn cylinder(&mut self, o: &'o Object) -> Option<Node> {
        self.known(o, &["p0", "p1", "radius"]);
        let from = self.vector(o, "p0").unwrap_or(DVec3::ZERO);
        let to = self.vector(o, "p1").unwrap_or(DVec3::Z);
        let radius = self.within(o, "radius", 1.0, Limit::POSITIVE);
        let axis = to - from;
        let Some(n) = axis.try_normalize() else {
            self.fail(o.plugin.span, "`p0` and `p1` are the same point: the cylinder has no length");
            return None;
        };
        let (s, t) = frame(n);
        let (s, t) = (s * radius, t * radius);
        let own = Affine {
            rows: [[s.x, t.x, axis.x, from.x], [s.y, t.y, axis.y, from.y], [s.z, t.z, axis.z, from.z]],
        };
        let at = self.placed(o, &own);
        let flip = self.flips(o);
        let surface = self.surface(o, &at, Uv::Same, flip);
        Some(Node::Cylinder(Cylinder {
            from: DVec3::ZERO,
            to: DVec3::Z,
            radius: 1.0,
            caps: false,
            phi: [0.0, 360.0],
            surface,
        }))
    }

    fn disc(&mut self, o: &'o Object) -> Option<Node> {
        self.known(o, &[]);
        let at = self.placed(o, &Affine::IDENTITY);
        let flip = self.flips(o);
        let surface = self.surface(o, &at, Uv::Disc, flip);
        Some(Node::Disc(Disc { surface, ..Disc::default() }))
    }

    fn rectangle(&mut self, o: &'o Object) -> Option<Node> {
        self.known(o, &[]);
        let at = self.placed(o, &Affine::IDENTITY);
        // A rectangle whose front is turned by a mirror image or by `flip` has its edges exchanged, and with them u and v: so neither
        // is let happen, and where the front must be the other side, u runs the other way.
        let is_mirrored = at.determinant() < 0.0;
        let is_turned = is_mirrored != self.flips(o);
        let uv = if is_turned { Uv::FlipU } else { Uv::Same };
        let surface = self.surface(o, &at, uv, is_mirrored);
        let mut flat = Rectangle { surface, ..Rectangle::default() };
        if is_turned {
            flat.corner = DVec3::new(1.0, -1.0, 0.0);
            flat.edges = [DVec3::new(-2.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0)];
        }
        Some(Node::Rectangle(flat))
    }

    fn cube(&mut self, o: &'o Object) -> Option<Node> {
        self.known(o, &["face_normals"]);
        let at = self.placed(o, &Affine::IDENTITY);
        let flip = self.flips(o);
        let surface = self.surface(o, &at, Uv::Same, flip);
        let file = self.cube_asset(o);
        Some(Node::Mesh(TriangleMesh {
            file: Some(file),
            shading: Shading::Flat,
            surface,
            ..TriangleMesh::default()
        }))
    }

    /// One mesh for all cubes.
    fn cube_asset(&mut self, o: &'o Object) -> Asset<Mesh> {
        const NAME: &str = "cube of Mitsuba";
        let file = Spanned::new(NAME.to_owned(), o.plugin.span);
        if self.has_cube {
            return self.made.in_file(file);
        }
        self.has_cube = true;
        self.made.mesh(file, MeshAsset { mesh: Arc::new(cube()), ..MeshAsset::default() })
    }

    /// How a mesh is shaded: by its own normals or by computed ones, unless it is to be flat. Rays start from its triangles, as there.
    pub(super) fn shading(&mut self, o: &'o Object) -> Shading {
        if self.boolean(o, "face_normals").unwrap_or(false) {
            return Shading::Flat;
        }
        Shading::Smooth(Smoothing { crease: 180.0, recompute: false, rays: Leaving::Faces })
    }

    fn mesh_file(&mut self, o: &'o Object) -> Option<Node> {
        self.known(
            o,
            &[
                "filename",
                "face_normals",
                "flip_tex_coords",
                "max_smooth_angle",
                "collapse",
                "srgb",
                "shape_index",
            ],
        );
        if o.has("max_smooth_angle") {
            self.alike(
                "crease",
                o,
                "`max_smooth_angle` isn't supported: normals are smooth over all edges".to_owned(),
            );
        }
        let Some(file) = self.text(o, "filename") else {
            self.fail(o.plugin.span, format!("this {} has no `filename`", suggest::brief(&o.plugin)));
            return None;
        };
        let found = self.file(o, &file)?;
        let is_ply = o.plugin.as_str() == "ply";
        self.codes = if is_ply { byte_attributes(&found.path) } else { Default::default() };
        let turned = self.boolean(o, "flip_tex_coords").unwrap_or(!is_ply);
        let at = self.placed(o, &Affine::IDENTITY);
        let flip = self.flips(o);
        let uv = if turned { Uv::FlipV } else { Uv::Same };
        let surface = self.surface(o, &at, uv, flip);
        self.codes.clear();
        let shading = self.shading(o);
        let file = Some(self.made.in_file(Spanned::new(found.name, file.span)));
        Some(Node::Mesh(TriangleMesh { file, shading, surface, ..TriangleMesh::default() }))
    }

    fn serialized(&mut self, o: &'o Object) -> Option<Node> {
        self.known(o, &["filename", "shape_index", "face_normals", "max_smooth_angle"]);
        let Some(file) = self.text(o, "filename") else {
            self.fail(o.plugin.span, "this mesh has no `filename`");
            return None;
        };
        let index = self.count(o, "shape_index", 0, [0, u32::MAX]);
        let found = self.file(o, &file)?;
        let name = format!("{}@{index}", found.name);
        let known = self.serialized.get(&name).copied();
        let is_flat = match known {
            Some(is_flat) => is_flat,
            None => {
                let read = self.read_serialized(&found.path, index);
                match read {
                    Ok((mesh, hash, is_flat)) => {
                        self.means.ledger.keep(mesh.heap_bytes());
                        let asset = MeshAsset { mesh: Arc::new(mesh), ..MeshAsset::default() };
                        self.made.mesh(name.clone(), asset);
                        self.serialized.insert(name.clone(), is_flat);
                        self.read.push((found.path, found.name, hash));
                        is_flat
                    }
                    Err(refusal) => {
                        self.refuse(&file, &refusal);
                        return None;
                    }
                }
            }
        };
        let at = self.placed(o, &Affine::IDENTITY);
        let flip = self.flips(o);
        let surface = self.surface(o, &at, Uv::Same, flip);
        let is_flat = is_flat && !o.has("face_normals");
        let shading = if is_flat { Shading::Flat } else { self.shading(o) };
        let file = Some(self.made.in_file(Spanned::new(name, file.span)));
        Some(Node::Mesh(TriangleMesh { file, shading, surface, ..TriangleMesh::default() }))
    }

    fn read_serialized(
        &mut self,
        path: &std::path::Path,
        index: u32,
    ) -> Result<(Mesh, [u8; 32], bool), Refusal> {
        let length = files::size(path, self.means.limits.max_bytes)?;
        let what = || format!("reading `{}`", path.display());
        if let Some(shortage) = self.means.ledger.refuse(length, what, "a mesh of fewer triangles takes less")
        {
            self.means.d.lacks_memory = true;
            return Err(Refusal::new(shortage.to_string()).help(shortage.help()));
        }
        let bytes = files::read(path, self.means.limits.max_bytes)?;
        let most = self.means.ledger.limit.unwrap_or(u64::MAX);
        let (mesh, is_flat) = serialized::read(&bytes, index, self.means.limits, most)
            .map_err(|e| Refusal::new(e.to_string()))?;
        self.means.ledger.pass(length + 2 * mesh.heap_bytes());
        Ok((mesh, blake3::hash(&bytes).into(), is_flat))
    }

    /// A group, which is seen where instances put it; its name.
    fn group(&mut self, i: usize) -> Option<Spanned<String>> {
        if let Some(name) = self.groups.get(&i) {
            return Some(name.clone());
        }
        let o: &'o Object = &self.objects[i];
        self.known(o, &[]);
        let inner = self.inside(o, Class::Shape);
        let mut children: Vec<Node> = Vec::new();
        for inner in inner {
            if self.objects[inner].class == Class::Shape
                && !self.inside(&self.objects[inner], Class::Emitter).is_empty()
            {
                self.alike("lamps", o, "lamps in a `shapegroup` shine here; Mitsuba refuses them".to_owned());
            }
            children.extend(self.shape(inner));
        }
        let own = o.id.clone().unwrap_or_else(|| format!("shapegroup {i}"));
        let name = free_name(&own, &[], |name| self.scene.objects.get(name).is_some());
        let name = Spanned::new(name, o.plugin.span);
        let group =
            Group { transform: Default::default(), look_at: None, material: None, children, name: None };
        self.scene.objects.insert(name.clone(), Node::Group(group));
        self.groups.insert(i, name.clone());
        Some(name)
    }

    fn instance(&mut self, o: &'o Object) -> Option<Node> {
        self.known(o, &[]);
        let groups: Vec<usize> = self
            .inside(o, Class::Shape)
            .into_iter()
            .filter(|i| self.objects[*i].plugin.as_str() == "shapegroup")
            .collect();
        let Some(&group) = groups.first() else {
            let help = "such as `<ref id=\"...\"/>` to a shape of `type=\"shapegroup\"`";
            self.push(Diagnostic::error(o.plugin.span, "an instance needs a `shapegroup`").help(help));
            return None;
        };
        let name = self.group(group)?;
        let at = self.placed(o, &Affine::IDENTITY);
        let own = o.id.clone().map(|id| Spanned::new(id, o.plugin.span));
        Some(Node::Instance(Instance {
            of: Link::new(name),
            transform: self.moving(o, &at),
            look_at: None,
            material: None,
            name: own,
        }))
    }

    /// Which of the lists of byte attributes the mesh in hand has.
    fn codes_in_hand(&mut self) -> usize {
        if let Some(known) = self.code_lists.iter().position(|list| *list == self.codes) {
            return known;
        }
        self.code_lists.push(self.codes.clone());
        self.code_lists.len() - 1
    }
}

/// Two unit vectors that make a right-handed frame with `n` (Duff et al. 2017), as Mitsuba takes them.
fn frame(n: DVec3) -> (DVec3, DVec3) {
    let sign = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// From -1 to 1 on each axis, with texture coordinates from 0 to 1 on each side, as Mitsuba lays them.
fn cube() -> Mesh {
    // Four corners of each side: which of the eight, whose bits say where on x, y and z.
    const SIDES: [[u8; 4]; 6] =
        [[1, 5, 4, 0], [3, 2, 6, 7], [1, 3, 7, 5], [5, 7, 6, 4], [4, 6, 2, 0], [3, 1, 0, 2]];
    let mut mesh = Mesh::default();
    for side in SIDES {
        let first = mesh.positions.len() as u32;
        for (corner, uv) in side.into_iter().zip([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]) {
            mesh.positions.push([0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 }));
            mesh.uvs.push(uv);
        }
        mesh.triangles.push([first, first + 1, first + 2]);
        mesh.triangles.push([first + 3, first, first + 2]);
    }
    mesh
}

/// Which attributes of a PLY file are bytes, by Mitsuba's names, as its header has it.
fn byte_attributes(path: &std::path::Path) -> std::collections::BTreeSet<String> {
    let mut found = std::collections::BTreeSet::new();
    let mut start = Vec::new();
    // The beginning is enough, and all that is read.
    let _ = files::read_if(path, u64::MAX, |head| {
        start.extend_from_slice(head);
        Err(Refusal::new(""))
    });
    let text = String::from_utf8_lossy(&start);
    let mut element = "";
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["end_header", ..] => break,
            ["element", "vertex", ..] => element = "vertex",
            ["element", "face", ..] => element = "face",
            ["element", ..] => element = "",
            ["property", "uchar" | "uint8", name] if !element.is_empty() => {
                let name = match name {
                    "r" | "red" => "color".to_owned(),
                    _ => match name.rsplit_once('_') {
                        Some((stem, "r")) => format!("{stem}_color"),
                        Some((stem, "0")) => stem.to_owned(),
                        _ => continue,
                    },
                };
                found.insert(format!("{element}_{name}"));
            }
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_one_and_begins_at_x_about_z() {
        assert_eq!(frame(DVec3::Z), (DVec3::X, DVec3::Y));
        for n in [DVec3::Y, DVec3::new(0.6, 0.0, -0.8), -DVec3::Z] {
            let (s, t) = frame(n);
            assert!((s.cross(t) - n).length() < 1e-12 && s.dot(n).abs() < 1e-12, "{n:?}");
        }
    }

    #[test]
    fn a_cube_is_seen_from_outside() {
        let mesh = cube();
        for [a, b, c] in &mesh.triangles {
            let [a, b, c] = [a, b, c].map(|i| {
                let [x, y, z] = mesh.positions[*i as usize];
                DVec3::new(f64::from(x), f64::from(y), f64::from(z))
            });
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }

    /// Mitsuba's local z, where its v is 0, is straal's y.
    #[test]
    fn a_ball_is_turned_and_not_mirrored() {
        assert_eq!(BALL.vector(DVec3::Y), DVec3::Z);
        assert_eq!(BALL.vector(DVec3::Z), DVec3::X);
        assert!(BALL.determinant() > 0.0);
    }
}
