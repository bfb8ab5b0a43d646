//! Shapes.
//!
//! Round ones stand about z, and `phimax` goes from +x towards +y.

use std::sync::Arc;
use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    self, Annulus, Cone, Cylinder, Disc, Hyperboloid, MaterialRef, Node, Paraboloid, Sphere, Subdivide,
    Transform, TriangleMesh,
};
use straal_scene::value::Asset;
use straal_scene::{Mesh, MeshAsset, Span, Spanned};

use super::params::Params;
use super::state::{as_transform, scale_of};
use super::{Reader, Thing};
use crate::scene::motion;

/// pbrt's shapes.
const KINDS: [&str; 8] =
    ["bilinearmesh", "curve", "cylinder", "disk", "loopsubdiv", "plymesh", "sphere", "trianglemesh"];

/// What a round shape is cut down to.
pub(super) struct Cut {
    pub radius: f64,
    pub z: [f64; 2],
    /// Degrees about z, from +x.
    pub phi: f64,
}

/// From straal's axes of a sphere, whose pole is y, to pbrt's: its seam is at +x.
pub(super) const UPRIGHT: Affine =
    Affine { rows: [[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]] };

impl Reader<'_, '_> {
    /// A shape with the material and light of the state.
    pub(super) fn shape(&mut self, thing: Thing) {
        let Thing { kind, params } = thing;
        let params = params.within(&self.state.attributes.shape);
        if kind.as_str() != "curve" {
            self.end_of_curves();
        }
        let is_curve = kind.as_str() == "curve";
        let map = if is_curve { self.still(params.span) } else { self.invertible(params.span) };
        let Some(map) = map else { return };
        let Some(material) = self.surface(&params) else { return };
        match kind.as_str() {
            "sphere" => self.sphere(&params, (&map, material)),
            "disk" => self.disk(&params, (&map, material)),
            "cylinder" => self.cylinder(&params, (&map, material)),
            "trianglemesh" => self.triangle_mesh(&params, (&map, material)),
            "bilinearmesh" => self.bilinear_mesh(&params, (&map, material)),
            "plymesh" => self.ply_mesh(&params, (&map, material)),
            "loopsubdiv" => self.loop_subdivision(&params, (&map, material)),
            "curve" => self.curve(&params, (&map, material)),
            "cone" => self.cone(&params, (&map, material)),
            "paraboloid" => self.paraboloid(&params, (&map, material)),
            "hyperboloid" => self.hyperboloid(&params, (&map, material)),
            "heightfield" | "heightfield2" => self.height_field(&params, (&map, material)),
            "nurbs" => {
                let message = format!("the shape `{}` of pbrt-v3 is left out", kind.value);
                return self.warn(kind.span, message);
            }
            _ => return self.unknown("shape", &kind, &KINDS),
        }
        params.complain(&format!("the shape `{}`", kind.value), self.means.d);
    }

    /// When the camera's shutter opens and closes.
    pub(super) fn shutter(&self) -> [f64; 2] {
        [("shutteropen", 0.0), ("shutterclose", 1.0)].map(|(name, usual)| {
            self.options.camera.as_ref().map_or(usual, |camera| camera.params.float(name, usual))
        })
    }

    /// The places from one transform to the other while the shutter is open: they count at the times that `TransformTimes` says.
    pub(super) fn swept(&self, [open, close]: [f64; 2], [start, end]: [&Affine; 2]) -> Vec<Affine> {
        /// Each of these is straight.
        const WAYS: u32 = 16;
        let [from, to] = self.options.transform_times.unwrap_or([0.0, 1.0]);
        // One that mirrors, as cameras of pbrt do, goes as its mirror image does.
        if start.determinant() < 0.0 && end.determinant() < 0.0 {
            let mirror = Affine::scale(DVec3::new(-1.0, 1.0, 1.0));
            let all = self.swept([open, close], [&mirror.then(start), &mirror.then(end)]);
            return all.iter().map(|place| mirror.then(place)).collect();
        }
        if [open, close] == [from, to] || to <= from || close <= open {
            return motion::between(start, end);
        }
        let at = |i: u32| {
            let time = open + (close - open) * f64::from(i) / f64::from(WAYS);
            motion::part(start, end, (time - from) / (to - from))
        };
        (0..=WAYS).map(at).collect()
    }

    /// Where something is while the shutter is open, of which that is where it begins.
    pub(super) fn moving(&self, map: &Affine, span: Span) -> Transform {
        let [start, end] = self.state.transforms;
        let own = start.inverse().map(|back| map.then(&back));
        match own {
            Some(own) if self.state.moves() && end.inverse().is_some() => {
                let places: Vec<Affine> =
                    self.swept(self.shutter(), [&start, &end]).iter().map(|p| own.then(p)).collect();
                Transform { span, ..motion::transform(&places) }
            }
            _ => as_transform(map, span),
        }
    }

    /// What all surfaces share, of a shape whose area is known.
    pub(super) fn with(
        &mut self,
        map: &Affine,
        material: Option<MaterialRef>,
        (area, parts): (f64, usize),
        span: Span,
    ) -> desc::Surface {
        let shine = self.shine(area, parts, span);
        let (emission, two_sided_emission) = shine.map_or((None, false), |(e, two)| (Some(e), two));
        desc::Surface {
            material,
            emission,
            two_sided_emission,
            transform: self.moving(map, span),
            flip: self.state.reversed,
            ..desc::Surface::default()
        }
    }

    /// Radius and what is left of it, if that makes sense.
    fn cut(&mut self, params: &Params, usual: Option<[f64; 2]>) -> Option<Cut> {
        let radius = params.float("radius", 1.0);
        let [low, high] = usual.unwrap_or([-radius, radius]);
        let z = [params.float("zmin", low), params.float("zmax", high)];
        let phi = params.float("phimax", 360.0);
        let phi = if phi < 360.0 { phi } else { 360.0 };
        let [low, high] = if z[0] < z[1] { z } else { [z[1], z[0]] };
        if !((radius as f32) > 0.0 && phi > 0.0) {
            self.warn(params.span, "this shape is left out: it has no extent");
            return None;
        }
        Some(Cut { radius, z: [low, high], phi })
    }

    fn sphere(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let Some(cut) = self.cut(params, None) else { return };
        let Cut { radius, z: [low, high], phi } = cut;
        let whole = low <= -radius && high >= radius;
        let [low, high] =
            [if low > -radius { low } else { -radius }, if high < radius { high } else { radius }];
        if low >= high {
            return self.warn(params.span, "this shape is left out: it has no extent");
        }
        let scale = scale_of(map);
        let area = phi.to_radians() * radius * (high - low) * scale * scale;
        let surface = self.with(&UPRIGHT.then(map), material, (area, 1), params.span);
        let heights = (!whole).then_some([low, high]);
        self.push(Node::Sphere(Sphere { radius, heights, phi: [0.0, phi], surface, ..Sphere::default() }));
    }

    fn disk(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let radius = params.float("radius", 1.0);
        let inner = params.float("innerradius", 0.0);
        let height = params.float("height", 0.0);
        let phi = params.float("phimax", 360.0);
        let inner = if inner > 0.0 { inner } else { 0.0 };
        if !((radius as f32) > 0.0 && phi > 0.0 && inner < radius) {
            return self.warn(params.span, "this shape is left out: it has no extent");
        }
        let phi = if phi < 360.0 { phi } else { 360.0 };
        let scale = scale_of(map);
        let area = 0.5 * phi.to_radians() * (radius * radius - inner * inner) * scale * scale;
        let surface = self.with(map, material, (area, 1), params.span);
        let center = DVec3::new(0.0, 0.0, height);
        let normal = DVec3::Z;
        self.push(if inner > 0.0 || phi < 360.0 {
            let phi = [0.0, phi];
            Node::Annulus(Annulus { center, normal, radius, inner_radius: inner, phi, surface })
        } else {
            Node::Disc(Disc { center, normal, radius, surface, ..Disc::default() })
        });
    }

    fn cylinder(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let Some(cut) = self.cut(params, Some([-1.0, 1.0])) else { return };
        let Cut { radius, z: [low, high], phi } = cut;
        if low >= high {
            return self.warn(params.span, "this shape is left out: it has no extent");
        }
        let scale = scale_of(map);
        let area = phi.to_radians() * radius * (high - low) * scale * scale;
        let surface = self.with(map, material, (area, 1), params.span);
        let [from, to] = [low, high].map(|z| DVec3::new(0.0, 0.0, z));
        self.push(Node::Cylinder(Cylinder {
            from,
            to,
            radius,
            phi: [0.0, phi],
            surface,
            ..Cylinder::default()
        }));
    }

    /// Of version 3: it stands on the plane of x and y, and comes to a point.
    fn cone(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let Some(Cut { radius, phi, .. }) = self.cut(params, None) else { return };
        let height = params.float("height", 1.0);
        if height.is_nan() || (height as f32) <= 0.0 {
            return self.warn(params.span, "this shape is left out: it has no extent");
        }
        let scale = scale_of(map);
        let side = (radius * radius + height * height).sqrt();
        let area = 0.5 * phi.to_radians() * radius * side * scale * scale;
        let surface = self.with(map, material, (area, 1), params.span);
        let (to, phi) = (DVec3::Z * height, [0.0, phi]);
        self.push(Node::Cone(Cone { from: DVec3::ZERO, to, radius, phi, surface, ..Cone::default() }));
    }

    /// Of version 3: its apex is at the origin, and its radius that at `zmax`.
    fn paraboloid(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let Some(Cut { radius, z: [low, high], phi }) = self.cut(params, Some([0.0, 1.0])) else { return };
        let low = if low > 0.0 { low } else { 0.0 };
        let begin = low / high;
        if !(high as f32 > 0.0 && begin < 0.999) {
            return self.warn(params.span, "this shape is left out: it has no extent");
        }
        // Of a paraboloid of revolution, from its apex (Gray 1997).
        let scale = scale_of(map);
        let (k, slope) = (radius * radius / high, |z: f64| {
            let v = 1.0 + 4.0 * z * high / (radius * radius);
            v * v.sqrt()
        });
        let area = phi.to_radians() * k * k / 12.0 * (slope(high) - slope(low)) * scale * scale;
        let surface = self.with(map, material, (area, 1), params.span);
        let (to, phi) = (DVec3::Z * high, [0.0, phi]);
        self.push(Node::Paraboloid(Paraboloid { from: DVec3::ZERO, to, radius, begin, phi, surface }));
    }

    /// Of version 3: the line from `p1` to `p2`, turned about z.
    fn hyperboloid(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let line =
            [("p1", DVec3::ZERO), ("p2", DVec3::ONE)].map(|(name, p)| params.vector(name).unwrap_or(p));
        let phi = params.float("phimax", 360.0);
        let phi = if phi < 360.0 { phi } else { 360.0 };
        let [a, b] = line;
        let is_on_axis = [a, b].iter().all(|p| p.x == 0.0 && p.y == 0.0);
        if !(phi > 0.0 && (b - a).length() > 0.0 && !is_on_axis) {
            return self.warn(params.span, "this shape is left out: it has no extent");
        }
        // About the size of a cone's that is cut off.
        let scale = scale_of(map);
        let radii: f64 = line.iter().map(|p| (p.x * p.x + p.y * p.y).sqrt()).sum();
        let area = 0.5 * phi.to_radians() * radii * (b - a).length() * scale * scale;
        let surface = self.with(&UPRIGHT.then(map), material, (area, 1), params.span);
        // Its axis is y here.
        let line = line.map(|p| DVec3::new(p.y, p.z, p.x));
        self.push(Node::Hyperboloid(Hyperboloid { line, phi: [0.0, phi], surface }));
    }

    /// Of version 3: heights over the square from 0 to 1 in x and y, row by row.
    fn height_field(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let counts = ["nu", "nv"].map(|name| usize::try_from(params.integer(name, 0)).unwrap_or(0));
        let Some(heights) = params.floats("Pz") else {
            return self.error(params.span, "a `heightfield` needs its heights `Pz`");
        };
        let [nu, nv] = counts;
        if nu < 2 || nv < 2 || nu.checked_mul(nv) != Some(heights.len()) {
            let message =
                format!("a `heightfield` of {nu} x {nv} has as many heights, found {}", heights.len());
            return self.error(params.span, message);
        }
        let mut mesh = Mesh::default();
        for (i, z) in heights.iter().enumerate() {
            let [x, y] = [i % nu, i / nu].map(|v| v as f32);
            let (x, y) = (x / (nu - 1) as f32, y / (nv - 1) as f32);
            mesh.positions.push([x, y, *z as f32]);
            mesh.uvs.push([x, y]);
        }
        for y in 0..nv as u32 - 1 {
            for x in 0..nu as u32 - 1 {
                let at = |x: u32, y: u32| x + y * nu as u32;
                mesh.triangles.push([at(x, y), at(x + 1, y), at(x + 1, y + 1)]);
                mesh.triangles.push([at(x, y), at(x + 1, y + 1), at(x, y + 1)]);
            }
        }
        self.made_mesh(mesh, (map, material), params.span);
    }

    fn ply_mesh(&mut self, params: &Params, (map, material): (&Affine, Option<MaterialRef>)) {
        let Some(file) = params.string("filename").cloned() else {
            return self.error(params.span, "a `plymesh` needs a `filename`");
        };
        params.pass_over(&["edgelength"]);
        if params.texture("displacement").is_some() {
            self.warn_once(params.span, "`displacement` of a mesh is passed over: it stays as it is");
        }
        // Its area isn't known yet.
        if self.state.area_light.as_ref().is_some_and(|light| light.power.is_some()) {
            self.warn(
                params.span,
                "`power` of a light on a PLY mesh is taken for that of a surface of 1 m² ",
            );
        }
        let asset = self.made.in_file::<Mesh>(file);
        let surface = self.with(map, material, (1.0, 1), params.span);
        self.push(Node::Mesh(mesh_node(asset, surface)));
    }

    /// A mesh that isn't in a file.
    pub(super) fn made_mesh(&mut self, mesh: Mesh, at: (&Affine, Option<MaterialRef>), span: Span) {
        let made = self.mesh(mesh, at, span);
        made.into_iter().for_each(|mesh| self.push(Node::Mesh(mesh)));
    }

    /// One that is a control cage.
    pub(super) fn made_cage(
        &mut self,
        mesh: Mesh,
        how: Subdivide,
        (at, span): ((&Affine, Option<MaterialRef>), Span),
    ) {
        let made = self.mesh(mesh, at, span);
        made.into_iter()
            .for_each(|mesh| self.push(Node::Mesh(TriangleMesh { subdivide: Some(how.clone()), ..mesh })));
    }

    fn mesh(
        &mut self,
        mesh: Mesh,
        (map, material): (&Affine, Option<MaterialRef>),
        span: Span,
    ) -> Option<TriangleMesh> {
        if mesh.triangles.is_empty() {
            self.warn(span, "this shape is left out: it has no triangles");
            return None;
        }
        let what = || "a mesh of this scene".to_owned();
        let help = "a mesh of fewer triangles takes less";
        if let Some(shortage) = self.means.ledger.refuse(self.mesh_bytes + mesh.heap_bytes(), what, help) {
            self.d().lacks_memory = true;
            self.error(span, shortage.to_string());
            return None;
        }
        self.mesh_bytes += mesh.heap_bytes();
        let extent = match self.state.area_light {
            Some(_) => (area(&mesh, map), mesh.triangles.len()),
            None => (1.0, 1),
        };
        let surface = self.with(map, material, extent, span);
        self.meshes += 1;
        let name = Spanned::new(format!("mesh {} of the scene", self.meshes), span);
        let asset = self.made.mesh(name, MeshAsset { mesh: Arc::new(mesh), ..MeshAsset::default() });
        Some(mesh_node(asset, surface))
    }
}

fn mesh_node(asset: Asset<Mesh>, surface: desc::Surface) -> TriangleMesh {
    TriangleMesh { file: Some(asset), surface, ..TriangleMesh::default() }
}

/// The area of a mesh where a map puts it.
fn area(mesh: &Mesh, map: &Affine) -> f64 {
    let corner = |i: u32| {
        let [x, y, z] = mesh.positions[i as usize].map(f64::from);
        map.point(DVec3::new(x, y, z))
    };
    let one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(corner);
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(one).filter(|a| a.is_finite()).sum()
}
