//! OBJ, Wavefront's object files: polygons, normals, texture coordinates, groups and materials.
//!
//! Colours and weights of vertices, smoothing groups (where a file has normals they say the same, and better) and
//! what describes curves and surfaces are not read. A reader of our own rather than the `tobj` crate, because that
//! tells neither the line of a mistake nor what it passed over.

use std::collections::HashMap;

use straal_scene::{Mesh, Part};

use super::lines::{Lines, Statement, Warnings};
use super::mtl::{self, MtlMaterial};
use super::polygon;
use crate::limits::check;
use crate::read_error::quoted;
use crate::{Limits, ReadError};

/// All that an OBJ file and its material libraries say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjFile {
    /// The triangles, one part for each run of faces of one group and material, if any material is named. Vertices
    /// come in the order in which faces name them, the same position, texture coordinate and normal once.
    pub mesh: Mesh,
    /// The materials of the libraries that were found, with their names; of two with one name the first.
    pub materials: Vec<(String, MtlMaterial)>,
    /// What was passed over, with lines.
    pub warnings: Vec<String>,
}

/// Reads a mesh and its materials. `library` is asked for the bytes of a material library by the name in the file
/// and answers `None` when there is no such file, which is a warning. A mesh without a triangle is an error.
pub fn read(
    bytes: &[u8],
    limits: &Limits,
    library: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<ObjFile, ReadError> {
    limits.check_bytes(bytes)?;
    let mut soup = Soup::default();
    let mut libraries = Libraries::default();
    let mut warnings = Warnings::default();
    for statement in Lines::new(bytes) {
        let line = statement.line;
        match statement.keyword() {
            "v" => {
                soup.positions.push(statement.numbers()?);
                check("vertices", soup.positions.len() as u64, limits.max_vertices.min(u64::from(NONE)))?;
            }
            "vn" => soup.normals.push(statement.numbers()?),
            "vt" => soup.uvs.push(texture_coordinate(&statement)?),
            "f" | "fo" => soup.add_face(&statement, &mut warnings)?,
            "g" | "o" => soup.name = statement.name().to_string(),
            "usemtl" => soup.material = Some(statement.name().to_string()),
            "mtllib" => libraries.load(&statement, limits, library, &mut warnings)?,
            "s" | "mg" | "vw" | "lod" | "shadow_obj" | "trace_obj" | "bevel" | "c_interp" | "d_interp" => {}
            keyword @ ("l" | "p") => warnings.once(keyword, || {
                let what = if keyword == "l" { "lines" } else { "points" };
                format!("line {line}: {what} have no surface and are left out")
            }),
            unknown => warnings.once(unknown, || {
                let unknown = quoted(unknown.as_bytes());
                format!("line {line}: {unknown} is not supported and has no effect")
            }),
        }
    }
    for run in &soup.runs {
        if let Some(name) = run.material.as_ref().filter(|name| !libraries.has(name)) {
            warnings.once(&format!("usemtl {name}"), || {
                format!("no material library has the material {}", quoted(name.as_bytes()))
            });
        }
    }
    soup.drop_dangling(&mut warnings);
    let mesh = soup.into_mesh(limits)?;
    Ok(ObjFile { mesh, materials: libraries.materials, warnings: warnings.finish() })
}

fn texture_coordinate(statement: &Statement) -> Result<[f32; 2], ReadError> {
    if statement.words().nth(1).is_none() {
        return Ok([statement.numbers::<1>()?[0], 0.0]);
    }
    statement.numbers()
}

/// The libraries that were loaded.
#[derive(Default)]
struct Libraries {
    names: Vec<String>,
    materials: Vec<(String, MtlMaterial)>,
}

impl Libraries {
    /// Loads what a `mtllib` line names: one file whose name may have spaces in it, or else several.
    fn load(
        &mut self,
        statement: &Statement,
        limits: &Limits,
        library: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let whole = statement.name();
        if self.names.iter().any(|name| name == whole) {
            return Ok(());
        }
        self.names.push(whole.to_string());
        if let Some(bytes) = library(whole) {
            return self.add(whole, &bytes, statement.line, limits, warnings);
        }
        let names: Vec<&str> = statement.words().collect();
        for &name in &names {
            let found = if names.len() > 1 { library(name) } else { None };
            match found {
                Some(bytes) => self.add(name, &bytes, statement.line, limits, warnings)?,
                None => warnings.once(&format!("mtllib {name}"), || {
                    let name = quoted(name.as_bytes());
                    format!("line {}: the material library {name} was not found", statement.line)
                }),
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        name: &str,
        bytes: &[u8],
        line: usize,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let file = mtl::read(bytes, limits).map_err(|error| {
            ReadError::line(line, format!("in the material library {}, {error}", quoted(name.as_bytes())))
        })?;
        for warning in file.warnings {
            warnings.once(&format!("{name} {warning}"), || format!("{name}, {warning}"));
        }
        for (material, value) in file.materials {
            if self.has(&material) {
                warnings.once(&format!("newmtl {material}"), || {
                    format!("{name}: the material {} is there already", quoted(material.as_bytes()))
                });
            } else {
                self.materials.push((material, value));
            }
        }
        Ok(())
    }

    fn has(&self, material: &str) -> bool {
        self.materials.iter().any(|(name, _)| name == material)
    }
}

/// An index that a corner doesn't have.
const NONE: u32 = u32::MAX;

/// A corner of a face: indices of its position, texture coordinate and normal.
type Corner = [u32; 3];

/// The polygons as they are in the file.
#[derive(Default)]
struct Soup {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Vec<Corner>,
    faces: Vec<Face>,
    runs: Vec<Run>,
    /// The group and material of the faces to come.
    name: String,
    material: Option<String>,
}

/// A face: where its corners end, and its line.
struct Face {
    end: usize,
    line: usize,
}

/// Faces from `start` up to the next run's have one group and one material.
struct Run {
    start: usize,
    name: String,
    material: Option<String>,
}

impl Soup {
    fn add_face(&mut self, statement: &Statement, warnings: &mut Warnings) -> Result<(), ReadError> {
        let line = statement.line;
        let start = self.corners.len();
        for word in statement.words() {
            let corner = self.corner(word, line)?;
            self.corners.push(corner);
        }
        if self.corners.len() - start < 3 {
            self.corners.truncate(start);
            warnings.once("f", || format!("line {line}: a face with fewer than three corners is left out"));
            return Ok(());
        }
        let same = |run: &Run| run.name == self.name && run.material == self.material;
        if !self.runs.last().is_some_and(same) {
            let (name, material) = (self.name.clone(), self.material.clone());
            self.runs.push(Run { start: self.faces.len(), name, material });
        }
        self.faces.push(Face { end: self.corners.len(), line });
        Ok(())
    }

    /// A corner such as 1, 1/2, 1//3, 1/2/3 or -1/-1/-1. Whether there are so many vertices is known at the end.
    fn corner(&self, word: &str, line: usize) -> Result<Corner, ReadError> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [NONE; 3];
        let mut parts = word.split('/');
        for (k, (count, part)) in counts.into_iter().zip(parts.by_ref()).enumerate() {
            if part.is_empty() && k > 0 {
                continue;
            }
            let wrong = || {
                let word = quoted(word.as_bytes());
                ReadError::line(
                    line,
                    format!("expected a corner such as 1, 1/2, 1//3 or 1/2/3, found {word}"),
                )
            };
            let index: i64 = part.parse().map_err(|_| wrong())?;
            let absolute = match index {
                0 => return Err(ReadError::line(line, format!("index 0 in '{word}': OBJ counts from 1"))),
                1.. => index - 1,
                _ => count as i64 + index,
            };
            let known = u32::try_from(absolute).ok().filter(|&index| index != NONE);
            corner[k] = known.ok_or_else(|| out_of_range(k, index, count, line))?;
        }
        if parts.next().is_some() {
            return Err(ReadError::line(line, format!("too many indices in {}", quoted(word.as_bytes()))));
        }
        Ok(corner)
    }

    /// Some writers number texture coordinates or normals that they leave out: then there are none.
    fn drop_dangling(&mut self, warnings: &mut Warnings) {
        for (k, what, count) in
            [(1, "texture coordinates", self.uvs.len()), (2, "normals", self.normals.len())]
        {
            if count == 0 && self.corners.iter().any(|corner| corner[k] != NONE) {
                self.corners.iter_mut().for_each(|corner| corner[k] = NONE);
                warnings.once(what, || format!("the faces name {what}, but the file has none"));
            }
        }
    }

    fn into_mesh(mut self, limits: &Limits) -> Result<Mesh, ReadError> {
        let has_uvs = self.corners.iter().any(|corner| corner[1] != NONE);
        let has_normals = self.corners.iter().any(|corner| corner[2] != NONE);
        let mut mesh = Mesh::default();
        let mut vertices = Vertices::new(has_uvs || has_normals, self.positions.len());
        let mut starts = Vec::with_capacity(self.runs.len());
        let mut runs = self.runs.iter().peekable();
        let mut points = Vec::new();
        let mut indices = Vec::new();
        let mut start = 0;
        for (i, face) in self.faces.iter().enumerate() {
            if runs.next_if(|run| run.start == i).is_some() {
                starts.push(mesh.triangles.len());
            }
            let corners = &mut self.corners[start..face.end];
            start = face.end;
            check_range(corners, [self.positions.len(), self.uvs.len(), self.normals.len()], face.line)?;
            points.clear();
            points.extend(corners.iter().map(|corner| self.positions[corner[0] as usize]));
            if has_normals && corners.iter().any(|corner| corner[2] == NONE) {
                // In a mesh with normals a face without them is flat.
                check("normals", self.normals.len() as u64, u64::from(NONE - 1))?;
                let normal = self.normals.len() as u32;
                self.normals.push(flat_normal(&points));
                corners.iter_mut().filter(|corner| corner[2] == NONE).for_each(|corner| corner[2] = normal);
            }
            indices.clear();
            for corner in corners.iter() {
                let (index, is_first) = vertices.index(*corner)?;
                indices.push(index);
                if is_first {
                    mesh.positions.push(self.positions[corner[0] as usize]);
                    if has_uvs {
                        mesh.uvs.push(self.uvs.get(corner[1] as usize).copied().unwrap_or_default());
                    }
                    if has_normals {
                        mesh.normals.push(self.normals[corner[2] as usize]);
                    }
                }
            }
            polygon::triangulate(&points, |t| mesh.triangles.push(t.map(|i| indices[i]))).map_err(|_| {
                let (count, most) = (points.len(), polygon::MAX_CONCAVE_CORNERS);
                ReadError::line(
                    face.line,
                    format!("a concave face with {count} corners, the limit is {most}"),
                )
            })?;
            check("triangles", mesh.triangles.len() as u64, limits.max_triangles)?;
        }
        if mesh.triangles.is_empty() {
            return Err(ReadError::file("the mesh is empty: it has no face with three corners"));
        }
        if self.runs.iter().any(|run| run.material.is_some()) {
            let ends = starts.iter().skip(1).copied().chain([mesh.triangles.len()]);
            let parts = self.runs.into_iter().zip(starts.iter().zip(ends));
            mesh.parts = parts
                .map(|(run, (&start, end))| Part {
                    name: run.name,
                    material: run.material,
                    triangles: start..end,
                })
                .collect();
        }
        Ok(mesh)
    }
}

fn check_range(corners: &[Corner], counts: [usize; 3], line: usize) -> Result<(), ReadError> {
    for corner in corners {
        for (k, (&index, count)) in corner.iter().zip(counts).enumerate() {
            if index != NONE && index as usize >= count {
                return Err(out_of_range(k, i64::from(index) + 1, count, line));
            }
        }
    }
    Ok(())
}

fn out_of_range(k: usize, index: i64, count: usize, line: usize) -> ReadError {
    let what = ["vertex", "texture coordinate", "normal"][k];
    ReadError::line(line, format!("a face names {what} {index}, but there are {count}"))
}

/// The vector area of a polygon (Newell's method), as a normal of unit length.
fn flat_normal(points: &[[f32; 3]]) -> [f32; 3] {
    let mut normal = [0.0f64; 3];
    for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
        let [a, b] = [a, b].map(|p| p.map(f64::from));
        for (k, component) in normal.iter_mut().enumerate() {
            let (u, v) = ((k + 1) % 3, (k + 2) % 3);
            *component += (a[u] - b[u]) * (a[v] + b[v]);
        }
    }
    let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length > 0.0 { normal.map(|v| (v / length) as f32) } else { [0.0, 0.0, 1.0] }
}

/// The vertices that exist already, by corner. Only looked up, never listed, so that their order is that of use.
enum Vertices {
    /// Every corner is a position only: the vertex of each, or `NONE`.
    ByPosition(Vec<u32>, u32),
    ByCorner(HashMap<Corner, u32>),
}

impl Vertices {
    fn new(by_corner: bool, positions: usize) -> Self {
        if by_corner { Self::ByCorner(HashMap::new()) } else { Self::ByPosition(vec![NONE; positions], 0) }
    }

    /// The index of a corner's vertex, and whether it is seen for the first time.
    fn index(&mut self, corner: Corner) -> Result<(u32, bool), ReadError> {
        match self {
            Self::ByPosition(known, count) => {
                let index = &mut known[corner[0] as usize];
                let is_first = *index == NONE;
                if is_first {
                    *index = *count;
                    *count += 1;
                }
                Ok((*index, is_first))
            }
            Self::ByCorner(known) => {
                let next = known.len() as u32;
                if next == NONE {
                    return Err(ReadError::file("the mesh has more than 4,294,967,294 different corners"));
                }
                let index = *known.entry(corner).or_insert(next);
                Ok((index, index == next && known.len() as u32 > next))
            }
        }
    }
}
