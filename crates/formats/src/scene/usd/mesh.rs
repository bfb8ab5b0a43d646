//! Meshes: faces, primvars of every interpolation, subsets of faces with materials of their own.

use std::collections::HashMap;
use std::rc::Rc;

use straal_math::DVec3;
use straal_scene::desc::{Node, Shading, Subdivide, Subdivision, TriangleMesh};
use straal_scene::mesh::{Attribute, Per};
use straal_scene::{Mesh, MeshAsset};

use super::material::Has;
use super::skel::Skin;
use super::world::Within;
use super::{Translation, within};
use crate::mesh::polygon;

/// A primvar: a value for each of something.
struct Column {
    name: String,
    width: usize,
    values: Rc<[f64]>,
    indices: Option<Rc<[f64]>>,
    per: Each,
}

/// What has one of a primvar's values each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Each {
    All,
    Face,
    Point,
    Corner,
}

/// A corner of a face: which face, which of all corners, which point.
#[derive(Clone, Copy)]
struct Corner {
    face: usize,
    corner: usize,
    point: usize,
}

impl Column {
    /// The value at a corner, if there is one.
    fn at(&self, c: Corner) -> Option<&[f64]> {
        let i = match self.per {
            Each::All => 0,
            Each::Face => c.face,
            Each::Point => c.point,
            Each::Corner => c.corner,
        };
        let i = match &self.indices {
            Some(indices) => *indices.get(i).filter(|i| **i >= 0.0)? as usize,
            None => i,
        };
        self.values.get(i.checked_mul(self.width)?..(i + 1).checked_mul(self.width)?)
    }
}

/// Faces of a mesh.
struct Faces {
    /// Corners of each face, and where its first one is.
    counts: Vec<(usize, usize)>,
    /// The point of each corner.
    points: Vec<usize>,
}

/// A mesh as its prim says it.
struct Cage<'c> {
    points: &'c [f64],
    faces: &'c Faces,
    columns: &'c [Column],
    scheme: &'c str,
    is_left: bool,
}

/// So many columns besides the places tell vertices apart.
const COLUMNS: usize = 6;

/// Names of texture coordinates that count as the mesh's own, the first that it has.
const OWN: [&str; 4] = ["st", "UVMap", "st0", "map1"];

impl Translation<'_, '_> {
    /// What a mesh shows: itself, or a mesh for each of its subsets.
    pub fn mesh(&mut self, prim: usize, around: &Within) -> Vec<Node> {
        let points = self.stage.numbers(prim, "points", 3).unwrap_or_default();
        let (points, skin) = self.posed(prim, points);
        let Some(faces) = self.faces(prim, points.len() / 3) else { return Vec::new() };
        let scheme = self.stage.text(prim, "subdivisionScheme").unwrap_or_else(|| "catmullClark".to_owned());
        let is_smooth = matches!(scheme.as_str(), "catmullClark" | "loop");
        let mut columns = self.columns(prim, is_smooth);
        if let Some(skin) = &skin {
            for normals in columns.iter_mut().filter(|column| column.name == "normals") {
                turn(normals, &faces, skin);
            }
        }
        let holes = self.stage.numbers(prim, "holeIndices", 1).unwrap_or_default();
        let mut is_free = vec![true; faces.counts.len()];
        for hole in holes.iter() {
            if let Some(free) = is_free.get_mut(*hole as usize).filter(|_| *hole >= 0.0) {
                *free = false;
            }
        }
        let is_sharp = ["creaseSharpnesses", "cornerSharpnesses"]
            .into_iter()
            .any(|name| self.stage.numbers(prim, name, 1).is_some_and(|s| !s.is_empty()));
        if is_smooth && is_sharp {
            self.warn(prim, "its creases and corners are as smooth as the rest");
        }
        let is_left = self.stage.text(prim, "orientation").as_deref() == Some("leftHanded");
        let cage = Cage { points: &points, faces: &faces, columns: &columns, scheme: &scheme, is_left };
        let mut nodes = Vec::new();
        // Faces of subsets first; the rest has the mesh's own material.
        for subset in self.stage.prims[prim].children.clone() {
            let is_one = self.stage.prims[subset].type_name == "GeomSubset";
            let family = self.stage.text(subset, "familyName").unwrap_or_default();
            let kind = self.stage.text(subset, "elementType").unwrap_or_else(|| "face".to_owned());
            if !is_one || family != "materialBind" || kind != "face" {
                continue;
            }
            let mut inside = around.clone();
            self.bind(subset, &mut inside);
            let mut chosen = vec![false; is_free.len()];
            for face in self.stage.numbers(subset, "indices", 1).unwrap_or_default().iter() {
                let free = is_free.get_mut(*face as usize).filter(|_| *face >= 0.0);
                if free.is_some_and(std::mem::take) {
                    chosen[*face as usize] = true;
                }
            }
            nodes.extend(self.part((prim, subset), &cage, &chosen, &inside));
        }
        nodes.extend(self.part((prim, prim), &cage, &is_free, around));
        nodes
    }

    /// The faces of a mesh; none where there are none, or after a complaint.
    fn faces(&mut self, prim: usize, points: usize) -> Option<Faces> {
        let counts = self.stage.numbers(prim, "faceVertexCounts", 1).unwrap_or_default();
        let indices = self.stage.numbers(prim, "faceVertexIndices", 1).unwrap_or_default();
        if counts.is_empty() || points == 0 {
            return None;
        }
        let limits = self.stage.library.means.limits;
        if points as u64 > limits.max_vertices || indices.len() as u64 > limits.max_triangles {
            let path = straal_scene::suggest::brief(&self.stage.prims[prim].path).into_owned();
            self.fail(format!("`{path}`: too many vertices or faces: {points} and {}", counts.len()));
            return None;
        }
        let (mut faces, mut next, mut beyond) = (Vec::with_capacity(counts.len()), 0_usize, 0);
        for count in counts.iter() {
            let count = if *count >= 0.0 { *count as usize } else { 0 };
            let end = next.saturating_add(count);
            let is_whole = end <= indices.len()
                && indices[next..end].iter().all(|i| *i >= 0.0 && (*i as usize) < points);
            beyond += usize::from(!is_whole);
            faces.push((if is_whole { count } else { 0 }, next));
            next = end;
        }
        if beyond > 0 {
            self.warn(prim, "some faces are left out: they name points that aren't there");
        }
        Some(Faces { counts: faces, points: indices.iter().map(|i| *i as usize).collect() })
    }

    /// The primvars of a mesh that something here reads.
    fn columns(&mut self, prim: usize, is_smooth: bool) -> Vec<Column> {
        let mut columns = Vec::new();
        let mut names = self.stage.names(prim, "primvars:");
        if !is_smooth && !names.iter().any(|name| name == "primvars:normals") {
            names.push("normals".to_owned());
        }
        for name in names {
            let short = name.strip_prefix("primvars:").unwrap_or(&name);
            if short.contains(':') {
                continue;
            }
            let (width, values) = match short {
                "displayColor" => (3, self.stage.numbers(prim, &name, 3)),
                "displayOpacity" => (1, self.stage.numbers(prim, &name, 1)),
                "normals" if is_smooth => continue,
                "normals" => (3, self.stage.numbers(prim, &name, 3)),
                _ => (2, self.stage.numbers(prim, &name, 2)),
            };
            let Some(values) = values.filter(|v| v.len() >= width) else { continue };
            let per = match self.stage.interpolation(prim, &name) {
                Some("faceVarying") => Each::Corner,
                Some("vertex" | "varying") => Each::Point,
                Some("uniform") => Each::Face,
                None if short == "normals" => Each::Point,
                _ => Each::All,
            };
            let indices = self.stage.numbers(prim, &format!("{name}:indices"), 1).filter(|i| !i.is_empty());
            columns.push(Column { name: short.to_owned(), width, values, indices, per });
        }
        // The mesh's own texture coordinates come first.
        let rank = |column: &Column| match OWN.iter().position(|own| *own == column.name) {
            Some(i) => i,
            None if column.width == 2 => OWN.len(),
            None => OWN.len() + 1,
        };
        columns.sort_by_key(rank);
        if columns.len() > COLUMNS {
            self.warn(prim, "it has more primvars than are read: the last are left out");
            columns.truncate(COLUMNS);
        }
        columns
    }

    /// The chosen faces as a mesh of their own, which is called as the second prim.
    fn part(
        &mut self,
        (prim, named): (usize, usize),
        cage: &Cage<'_>,
        chosen: &[bool],
        around: &Within,
    ) -> Option<Node> {
        let Cage { columns, scheme, .. } = *cage;
        let (mesh, faults) = build(cage, chosen);
        if faults > 0 {
            self.warn(prim, "some faces are left out: they have a dent and too many corners");
        }
        if mesh.triangles.is_empty() {
            return None;
        }
        self.vertices += mesh.positions.len() as u64;
        let bytes = mesh.heap_bytes();
        let means = &mut *self.stage.library.means;
        let most = means.limits.max_vertices;
        let held = self.kept + bytes;
        let what = || "the scene's meshes".to_owned();
        if let Some(shortage) = means.ledger.refuse(held, what, "meshes of fewer triangles take less") {
            means.d.lacks_memory = true;
            self.fail(shortage.to_string());
            return None;
        }
        if self.vertices > most {
            self.fail(format!("too many vertices in all meshes together: the limit is {most}"));
            return None;
        }
        self.kept = held;
        let mut has = Has::default();
        for column in columns {
            match column.name.as_str() {
                "displayColor" => has.colour = column.per != Each::All || column.indices.is_some(),
                "displayOpacity" => has.opacity = column.per != Each::All || column.indices.is_some(),
                _ if column.width == 2 && has.own.is_none() => has.own = Some(column.name.clone()),
                _ if column.width == 2 => has.others.push(column.name.clone()),
                _ => {}
            }
        }
        let has_normals = !mesh.normals.is_empty();
        let subdivide = match scheme {
            "catmullClark" => Some(Subdivision::CatmullClark),
            "loop" => Some(Subdivision::Loop),
            _ => None,
        };
        let subdivide = subdivide.map(|scheme| Subdivide { scheme, levels: levels(mesh.corners()) });
        let subdivide = subdivide.filter(|s| s.levels > 0);
        let name = format!("{}#{}", self.name, self.stage.prims[named].path);
        let file = Some(self.made.mesh(name, MeshAsset { mesh: mesh.into(), ..MeshAsset::default() }));
        let mut surface = self.surface(prim, around, &has);
        surface.flip = false;
        surface.name = Some(self.stage.prims[named].name.clone().into());
        self.mesh_light(prim, &mut surface);
        let shading = if has_normals || subdivide.is_some() { Shading::Auto } else { Shading::Flat };
        Some(Node::Mesh(TriangleMesh { file, shading, subdivide, surface, ..TriangleMesh::default() }))
    }
}

/// Has normals follow what the points of a mesh follow.
fn turn(normals: &mut Column, faces: &Faces, skin: &Skin) {
    let mut values = Vec::with_capacity(3 * faces.points.len());
    for (face, &(count, first)) in faces.counts.iter().enumerate() {
        // Corners that lie between, of faces that are left out, have normals as well, which nothing reads.
        values.resize(3 * first, 0.0);
        for corner in first..first + count {
            let point = faces.points[corner];
            let n = normals.at(Corner { face, corner, point }).unwrap_or(&[0.0, 0.0, 1.0]);
            let n = DVec3::new(n[0], n[1], n[2]);
            let turned = skin.at(point).inverse().map_or(n, |back| back.normal_by_inverse(n));
            values.extend(turned.try_normalize().unwrap_or(n).to_array());
        }
    }
    (normals.values, normals.indices, normals.per) = (values.into(), None, Each::Corner);
}

/// How often each face is divided into four: where there are few, more often.
fn levels(corners: u64) -> u32 {
    match corners {
        0..=20_000 => 3,
        20_001..=200_000 => 2,
        200_001..=2_000_000 => 1,
        _ => 0,
    }
}

/// The vertices, triangles and attributes of the chosen faces, and how many faces can't be cut into triangles.
fn build(cage: &Cage<'_>, chosen: &[bool]) -> (Mesh, usize) {
    let Cage { points, faces, columns, is_left, .. } = *cage;
    let mut mesh = Mesh::default();
    // Values that are alike are one, so that corners that share them share a vertex.
    let mut alike: Vec<HashMap<[u32; 3], u32>> = vec![HashMap::new(); columns.len()];
    let mut vertices: HashMap<(usize, [u32; COLUMNS]), u32> = HashMap::new();
    let mut values: Vec<Vec<f32>> = vec![Vec::new(); columns.len()];
    let is_plain = columns.iter().all(|column| matches!(column.per, Each::Point | Each::All));
    let mut direct: Vec<u32> = if is_plain { vec![u32::MAX; points.len() / 3] } else { Vec::new() };
    let single = |column: &Column, c: Corner| -> [f32; 3] {
        let found = column.at(c).unwrap_or(&[]);
        std::array::from_fn(|i| found.get(i).map_or(0.0, |v| *v as f32))
    };
    let (mut ring, mut places, mut faults) = (Vec::new(), Vec::new(), 0);
    for (face, &(count, first)) in faces.counts.iter().enumerate().filter(|(face, _)| chosen[*face]) {
        if count < 3 {
            continue;
        }
        ring.clear();
        places.clear();
        for step in 0..count {
            let corner = first + if is_left { count - 1 - step } else { step };
            let c = Corner { face, corner, point: faces.points[corner] };
            let known = if is_plain {
                direct[c.point]
            } else {
                let mut key = [0; COLUMNS];
                for ((key, column), alike) in key.iter_mut().zip(columns).zip(&mut alike) {
                    if matches!(column.per, Each::Face | Each::Corner) {
                        let next = alike.len() as u32;
                        *key = *alike.entry(single(column, c).map(f32::to_bits)).or_insert(next);
                    }
                }
                *vertices.entry((c.point, key)).or_insert(u32::MAX)
            };
            let vertex = if known == u32::MAX {
                let vertex = mesh.positions.len() as u32;
                let p = &points[3 * c.point..3 * c.point + 3];
                mesh.positions.push([p[0] as f32, p[1] as f32, p[2] as f32]);
                for (column, values) in columns.iter().zip(&mut values) {
                    values.extend(&single(column, c)[..column.width]);
                }
                if is_plain {
                    direct[c.point] = vertex;
                } else {
                    let mut key = [0; COLUMNS];
                    for ((key, column), alike) in key.iter_mut().zip(columns).zip(&alike) {
                        if matches!(column.per, Each::Face | Each::Corner) {
                            *key = alike.get(&single(column, c).map(f32::to_bits)).copied().unwrap_or(0);
                        }
                    }
                    vertices.insert((c.point, key), vertex);
                }
                vertex
            } else {
                known
            };
            ring.push(vertex);
            places.push(mesh.positions[vertex as usize]);
        }
        let before = mesh.triangles.len();
        let cut = polygon::triangulate(&places, |t| mesh.triangles.push(t.map(|i| ring[i])));
        if cut.is_err() {
            mesh.triangles.truncate(before);
            faults += 1;
            continue;
        }
        mesh.note_polygon(count);
    }
    for (column, values) in columns.iter().zip(values) {
        let is_own = column.width == 2 && mesh.uvs.is_empty();
        match column.name.as_str() {
            "normals" => mesh.normals = values.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect(),
            "displayColor" | "displayOpacity" if column.per == Each::All && column.indices.is_none() => {}
            _ if is_own => mesh.uvs = values.chunks_exact(2).map(|v| [v[0], v[1]]).collect(),
            name => {
                let values = if column.width == 2 {
                    values
                } else {
                    values.into_iter().map(|v| within(f64::from(v), 0.0, 1.0) as f32).collect()
                };
                let name = if name == "displayColor" { "color" } else { name };
                mesh.attributes.push(Attribute {
                    name: name.to_owned(),
                    per: Per::Vertex,
                    channels: column.width,
                    is_code: false,
                    values,
                });
            }
        }
    }
    (mesh, faults)
}
