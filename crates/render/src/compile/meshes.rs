//! Meshes on the walk over the world: those of files with their materials, and what becomes one.

use super::Detail;
use super::build::{Build, Place};
use super::place::drawn;
use super::solids::height_field;
use crate::shape::mesh::Between;
use crate::shape::subdivision::{Subdivided, subdivide};
use crate::shape::{TriangleMesh, bezier, smooth::smooth};
use crate::surface::Alike;
use crate::world::{GeometryRecord, Kind};
use std::collections::BTreeMap;
use std::sync::Arc;
use straal_accel as accel;
use straal_math::Vec3;
use straal_scene::bitmap::Number;
use straal_scene::desc::{self, Leaving, MeshSource, Shading};
use straal_scene::mesh::Per;
use straal_scene::{Mesh, Part, PartMaterial};

impl<'a> Build<'a> {
    pub(super) fn mesh_node(&mut self, m: &'a desc::TriangleMesh, place: Place) {
        let drawn = drawn(&m.light_sampling, &m.surface);
        if let MeshSource::Asset(asset) = m.source() {
            let asset = self.assets.mesh(asset.handle);
            let has_own = m.surface.material.is_some();
            if let Some(how) = &m.subdivide {
                let cage = TriangleMesh::from(&*asset.mesh);
                let Subdivided { mesh, starts } = self.subdivided(&cage, &asset.mesh.sides, how);
                let start = |i: usize| starts.get(i).copied().unwrap_or(0) as usize;
                let mut parts = asset.mesh.parts.clone();
                parts.iter_mut().for_each(|p| p.triangles = start(p.triangles.start)..start(p.triangles.end));
                let mesh = shaded(TriangleMesh { drawn, ..mesh }, &m.shading);
                let runs = runs(&mesh.indices, &parts, &asset.materials, has_own);
                return self.mesh(mesh, &runs, &m.surface, place);
            }
            let attributes = self.materials.attributes(&asset.mesh);
            let mesh =
                shaded(TriangleMesh { attributes, drawn, ..TriangleMesh::from(&*asset.mesh) }, &m.shading);
            let runs = runs(&mesh.indices, &asset.mesh.parts, &asset.materials, has_own);
            return self.mesh(mesh, &runs, &m.surface, place);
        }
        let mesh = Mesh {
            positions: m.positions.iter().map(|p| p.as_vec3().to_array()).collect(),
            normals: m.normals.iter().map(|n| n.as_vec3().to_array()).collect(),
            uvs: m.uvs.iter().map(|uv| uv.map(|v| v as f32)).collect(),
            tangents: m.tangents.iter().map(|t| t.map(|v| v as f32)).collect(),
            triangles: m.triangles.clone(),
            ..Mesh::default()
        };
        let mut mesh = TriangleMesh::from(&mesh);
        if let Some(how) = &m.subdivide {
            mesh = self.subdivided(&mesh, &[], how).mesh;
        }
        self.whole_mesh(shaded(TriangleMesh { drawn, ..mesh }, &m.shading), &m.surface, place)
    }

    /// A control cage as a smooth surface; as coarse as it is seen in a draft.
    fn subdivided(&self, cage: &TriangleMesh, sides: &[u32], how: &desc::Subdivide) -> Subdivided {
        /// Levels of a draft.
        const DRAFT: u32 = 2;
        let is_draft = self.detail == Detail::Draft && !self.in_focus;
        let levels = if is_draft { how.levels.min(DRAFT) } else { how.levels };
        subdivide(cage, sides, &how.scheme, levels)
    }

    pub(super) fn height_field(&mut self, s: &'a desc::HeightField, place: Place) {
        let [low, high] = s.between;
        let mesh = if let Some(file) = &s.file {
            let texels = &self.assets.bitmap(file.handle).texels;
            let most = match texels.format().number {
                Number::Byte => 255.0,
                Number::Short => 65535.0,
                Number::Half | Number::Single => 1.0,
            };
            let grey = texels.format().channels < 4;
            let height = |i: usize, j: usize| {
                let [r, g, b, _] = texels.numbers(i, j).map(f64::from);
                let y = if grey { r } else { 0.2126 * r + 0.7152 * g + 0.0722 * b };
                low + (high - low) * y / most
            };
            height_field([texels.width(), texels.height()], s.size, height)
        } else {
            let width = s.heights.first().map_or(0, Vec::len);
            let height = |i: usize, j: usize| {
                let h = s.heights.get(j).and_then(|row| row.get(i)).copied().unwrap_or(0.0);
                low + (high - low) * h
            };
            height_field([width, s.heights.len()], s.size, height)
        };
        let mesh = match s.shading {
            Shading::Auto => smooth(mesh, 180.0),
            _ => shaded(mesh, &s.shading),
        };
        self.whole_mesh(mesh, &s.surface, place)
    }

    pub(super) fn whole_mesh(&mut self, mesh: TriangleMesh, surface: &'a desc::Surface, place: Place) {
        let all = Run { material: None, triangles: mesh.indices.clone(), numbers: Vec::new() };
        self.mesh(mesh, &[all], surface, place)
    }

    /// Moves a mesh to its group's space and adds it, a geometry for each run.
    fn mesh(&mut self, mesh: TriangleMesh, runs: &[Run<'a>], surface: &'a desc::Surface, place: Place) {
        let m = place.transform;
        let moved = if m.is_identity() { Some(mesh) } else { mesh.transformed(&m) };
        let Some(mut mesh) = moved.filter(TriangleMesh::is_whole) else { return self.leave_out() };
        if surface.flip {
            mesh.flip = !mesh.flip;
            mesh.normals.iter_mut().for_each(|n| *n = -*n);
            mesh.tangents.iter_mut().for_each(|t| t[3] = -t[3]);
        }
        let default = self.materials.of(surface.material.as_ref(), place.material);
        let own_glow = surface.emission.as_ref().map(|e| self.materials.emission(e));
        let mut known = Vec::new();
        for run in runs {
            let material = match run.material {
                Some(part) => self.materials.add(&part.material),
                None => default,
            };
            let part_glow = run.material.and_then(|part| part.emission.as_ref());
            let radiance = match (own_glow, part_glow) {
                (Some(own), _) => Some(own),
                (None, Some(part)) => Some(self.materials.emission(part)),
                (None, None) => None,
            };
            let id = self.geometry.meshes.len() as u32;
            let part = match runs {
                [_] => TriangleMesh { indices: run.triangles.clone(), ..std::mem::take(&mut mesh) },
                _ => part(&mesh, run, &mut known),
            };
            let (positions, indices) = (part.positions.clone(), part.indices.clone());
            self.geometry.meshes.push(part);
            self.add_geometry(place.group, accel::GeometryKind::Triangles { positions, indices });
            let kind = Kind::Mesh(id);
            let glow = self.glow_of(radiance, material);
            let emission_varies = glow.as_ref().is_some_and(|g| g.varies(surface));
            let emitter =
                glow.map(|glow| self.glow(surface, (kind, material, false), glow, (place.group, &m)));
            let placement = self.placement(&m, material);
            let last = self.geometry.meshes.last();
            let colours_at_corners =
                last.is_some_and(|m| m.between == Between::Colours && !m.normals.is_empty());
            let record = GeometryRecord {
                kind,
                material,
                emitter,
                emission_varies,
                flip: false,
                colours_at_corners,
                placement,
                alike: Alike::Apart,
            };
            self.geometries.push(record);
        }
    }
}

/// Triangles of a mesh that share a material of its file.
struct Run<'a> {
    material: Option<&'a PartMaterial>,
    triangles: Arc<[[u32; 3]]>,
    /// Which triangles of the mesh they are, where it has several runs.
    numbers: Vec<u32>,
}

/// One run for each material that the file names, in order of first mention; one in all when the node has its own.
fn runs<'a>(
    triangles: &Arc<[[u32; 3]]>,
    parts: &[Part],
    materials: &'a BTreeMap<String, PartMaterial>,
    own: bool,
) -> Vec<Run<'a>> {
    /// A material's name, its triangles, and which of the mesh they are.
    type Found<'a> = (Option<&'a str>, Vec<[u32; 3]>, Vec<u32>);
    let mut runs: Vec<Found<'_>> = Vec::new();
    let mut known = BTreeMap::new();
    if !own && !materials.is_empty() {
        for part in parts {
            let name = part.material.as_deref().filter(|n| materials.contains_key(*n));
            let run = *known.entry(name).or_insert_with(|| {
                runs.push((name, Vec::new(), Vec::new()));
                runs.len() - 1
            });
            let found = triangles.get(part.triangles.clone()).unwrap_or_default();
            runs[run].1.extend(found);
            runs[run].2.extend((part.triangles.start as u32..).take(found.len()));
        }
    }
    if runs.is_empty() {
        return vec![Run { material: None, triangles: triangles.clone(), numbers: Vec::new() }];
    }
    let finish = |(name, triangles, numbers): Found<'_>| Run {
        material: name.and_then(|n| materials.get(n)),
        triangles: triangles.into(),
        numbers,
    };
    runs.into_iter().map(finish).collect()
}

/// Some triangles of a mesh with the vertices that they need, in order of first use: if each part of a file with many
/// materials held those of all, a small file would fill the memory. `known` is scratch.
fn part(mesh: &TriangleMesh, run: &Run<'_>, known: &mut Vec<u32>) -> TriangleMesh {
    const NONE: u32 = u32::MAX;
    known.resize(mesh.positions.len(), NONE);
    let mut used: Vec<u32> = Vec::new();
    let mut index = |i: u32| {
        let known = &mut known[i as usize];
        if *known == NONE {
            *known = used.len() as u32;
            used.push(i);
        }
        *known
    };
    let indices = run.triangles.iter().map(|t| t.map(&mut index)).collect();
    used.iter().for_each(|&i| known[i as usize] = NONE);
    let used = || used.iter().map(|&i| i as usize);
    TriangleMesh {
        positions: used().map(|i| mesh.positions[i]).collect(),
        indices,
        normals: used().filter_map(|i| mesh.normals.get(i).copied()).collect(),
        uvs: used().filter_map(|i| mesh.uvs.get(i).copied()).collect(),
        tangents: used().filter_map(|i| mesh.tangents.get(i).copied()).collect(),
        attributes: mesh
            .attributes
            .iter()
            .map(|a| match a.per {
                Per::Vertex => a.of(used()),
                Per::Face => a.of(run.numbers.iter().map(|i| *i as usize)),
            })
            .collect(),
        flip: mesh.flip,
        between: mesh.between,
        drawn: mesh.drawn,
    }
}

/// The mesh with the normals that it shall be shaded with. Its triangles stay in order, but may have other vertices.
pub(super) fn shaded(mut out: TriangleMesh, shading: &Shading) -> TriangleMesh {
    match shading {
        Shading::Flat => out.normals.clear(),
        Shading::Smooth(s) => {
            if s.recompute || out.normals.is_empty() {
                out = smooth(out, s.crease);
            }
            if s.rays == Leaving::Faces {
                out.between = Between::Normals;
            }
        }
        Shading::Gouraud(s) => {
            if s.recompute || out.normals.is_empty() {
                out = smooth(out, s.crease);
            }
            out.between = Between::Colours;
        }
        Shading::Auto => {}
    }
    out
}

/// Validation has seen that patches name points that are there.
pub(super) fn bezier_mesh(b: &desc::Bezier, resolution: u32) -> TriangleMesh {
    let patches = match b.source() {
        desc::BezierPatches::Builtin(desc::Patches::Teapot) => bezier::teapot(),
        desc::BezierPatches::Inline => {
            let point = |i: u32| b.points.get(i as usize).map_or(Vec3::ZERO, |p| p.as_vec3());
            b.patches.iter().map(|ids| ids.map(point)).collect()
        }
    };
    bezier::tessellate(&patches, resolution)
}
