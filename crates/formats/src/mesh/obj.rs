//! OBJ, Wavefront's object files: polygons, normals, texture coordinates, groups and materials.
//!
//! Colours of vertices are read where somebody asks for them. Weights of vertices, smoothing groups (where a file has normals they say the same, and better) and
//! what describes curves and surfaces are not read. A reader of our own rather than the `tobj` crate, because that
//! tells neither the line of a mistake nor what it passed over.

mod libraries;

use std::collections::HashMap;

use straal_scene::mesh::{Attribute, Per};
use straal_scene::{Mesh, Part};

use self::libraries::{Libraries, Request};
use super::attributes::COLOUR;
use super::lines::{Lines, Statement, Warnings, count};
use super::mtl::MtlMaterial;
use super::{colours_left_out, flat_normal, polygon};
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

/// Reads a mesh and its materials, without attributes; see [`read_with`].
pub fn read(
    bytes: &[u8],
    limits: &Limits,
    library: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<ObjFile, ReadError> {
    read_with(bytes, limits, &|_| false, library)
}

/// Reads a mesh and its materials. Colours of vertices are read where the attribute `color` is wanted. `library` is asked for the bytes of a material library by the name in the file
/// and answers `None` when there is no such file, which is a warning. A mesh without a triangle is an error.
pub fn read_with(
    bytes: &[u8],
    limits: &Limits,
    wanted: &dyn Fn(&str) -> bool,
    library: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<ObjFile, ReadError> {
    limits.check_bytes(bytes)?;
    let mut soup = Soup { wants_colours: wanted(COLOUR), ..Soup::default() };
    let mut libraries = Libraries::default();
    let mut warnings = Warnings::default();
    let mut lines = Lines::new(bytes);
    while let Some(statement) = lines.next() {
        let line = statement.line;
        match statement.keyword() {
            "v" => {
                let (position, more) = statement.numbers_and_more()?;
                soup.positions.push(position);
                // Three numbers more are a colour; a single one is a weight.
                soup.has_colours |= more == 3;
                if soup.wants_colours {
                    soup.add_colour(if more == 3 { Some(statement.numbers::<6>()?) } else { None });
                }
                lines.is_trusted = true;
                check("vertices", soup.positions.len() as u64, limits.max_vertices.min(u64::from(NONE)))?;
            }
            "vn" => soup.normals.push(statement.numbers()?),
            "vt" => soup.uvs.push(texture_coordinate(&statement)?),
            "f" | "fo" => soup.add_face(&statement, &mut warnings)?,
            "g" | "o" => soup.name = statement.name().to_string(),
            "usemtl" => {
                soup.material = Some(statement.name()).filter(|name| !name.is_empty()).map(str::to_owned)
            }
            "mtllib" => {
                libraries.load(&statement, &mut Request { limits, library, warnings: &mut warnings })?;
            }
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
    soup.has_colours |= lines.has_painted;
    let mut names = HashMap::new();
    for run in &mut soup.runs {
        let Some(name) = &mut run.material else { continue };
        let known =
            names.entry(std::mem::take(name)).or_insert_with_key(|name| libraries.meant(name, &mut warnings));
        run.material = known.clone();
    }
    soup.drop_dangling(&mut warnings);
    let mesh = soup.into_mesh(limits, &mut warnings)?;
    Ok(ObjFile { mesh, materials: libraries.finish(), warnings: warnings.finish() })
}

fn texture_coordinate(statement: &Statement) -> Result<[f32; 2], ReadError> {
    if statement.words().nth(1).is_none() {
        return Ok([statement.numbers::<1>()?[0], 0.0]);
    }
    statement.numbers()
}

/// An index that a corner doesn't have.
const NONE: u32 = u32::MAX;

/// What a corner names.
const NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];

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
    /// Whether vertices have colours.
    has_colours: bool,
    /// Whether anybody asks for them, and these; none of vertices before the first that has one.
    wants_colours: bool,
    colours: Vec<[f32; 3]>,
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
    /// The colour of the vertex that was added, behind its place.
    fn add_colour(&mut self, numbers: Option<[f32; 6]>) {
        const WHITE: [f32; 3] = [1.0; 3];
        match numbers {
            Some([_, _, _, r, g, b]) => {
                self.colours.resize(self.positions.len() - 1, WHITE);
                let sound = |v: f32| if v.is_finite() { v } else { 0.0 };
                self.colours.push([r, g, b].map(sound));
            }
            None if !self.colours.is_empty() => self.colours.push(WHITE),
            None => {}
        }
    }

    fn add_face(&mut self, statement: &Statement, warnings: &mut Warnings) -> Result<(), ReadError> {
        let line = statement.line;
        let start = self.corners.len();
        for word in statement.words() {
            let corner = self.corner(word, statement, warnings)?;
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
    fn corner(
        &self,
        word: &str,
        statement: &Statement,
        warnings: &mut Warnings,
    ) -> Result<Corner, ReadError> {
        let line = statement.line;
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [NONE; 3];
        let mut parts = word.split('/');
        for (k, (count, part)) in counts.into_iter().zip(parts.by_ref()).enumerate() {
            if part.is_empty() && k > 0 {
                continue;
            }
            let wrong = || {
                let found = statement.found(word);
                ReadError::line(line, format!("expected a corner such as 1, 1/2, 1//3 or 1/2/3{found}"))
            };
            let index: i64 = part.parse().map_err(|_| wrong())?;
            let absolute = match index {
                // Cinema 4D and others number what a corner doesn't have as 0.
                0 if k > 0 => {
                    let what = NAMES[k];
                    warnings.surely_once(&format!("0 {what}"), || {
                        let then = if k == 1 { "it is at 0, 0" } else { "the face is flat" };
                        format!("line {line}: a corner has the {what} 0, where OBJ counts from 1: it has none, {then}")
                    });
                    continue;
                }
                0 => return Err(ReadError::line(line, format!("index 0 in '{word}': OBJ counts from 1"))),
                1.. => index - 1,
                _ => count as i64 + index,
            };
            let known = u32::try_from(absolute).ok().filter(|&index| index != NONE);
            corner[k] = known.ok_or_else(|| out_of_range(k, index, count, line))?;
        }
        if parts.next().is_some() {
            return Err(ReadError::line(
                line,
                format!("too many indices for a corner{}", statement.found(word)),
            ));
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

    fn into_mesh(mut self, limits: &Limits, warnings: &mut Warnings) -> Result<Mesh, ReadError> {
        let finite = |list: &[[f32; 3]]| list.iter().flatten().all(|v| v.is_finite());
        let (sound_positions, sound_normals) = (finite(&self.positions), finite(&self.normals));
        let (mut odd_positions, mut odd_normals) = (Odd::default(), Odd::default());
        if self.has_colours && self.colours.is_empty() {
            warnings.surely_once("colours", || colours_left_out("vertices"));
        }
        let has_uvs = self.corners.iter().any(|corner| corner[1] != NONE);
        let has_normals = self.corners.iter().any(|corner| corner[2] != NONE);
        let mut mesh = Mesh::default();
        let mut colours = Vec::new();
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
            if !sound_positions && !finite(&points) {
                odd_positions.add(face.line);
                continue;
            }
            let is_odd = |n: Option<&[f32; 3]>| n.is_some_and(|n| n.iter().any(|v| !v.is_finite()));
            let has_odd =
                !sound_normals && corners.iter().any(|corner| is_odd(self.normals.get(corner[2] as usize)));
            if has_odd {
                odd_normals.add(face.line);
            }
            if has_normals && (has_odd || corners.iter().any(|corner| corner[2] == NONE)) {
                // In a mesh with normals a face without them is flat.
                check("normals", self.normals.len() as u64, u64::from(NONE - 1))?;
                let normal = self.normals.len() as u32;
                self.normals.push(flat_normal(&points));
                corners.iter_mut().for_each(|corner| corner[2] = normal);
            }
            indices.clear();
            for corner in corners.iter() {
                let (index, is_first) = vertices.index(*corner)?;
                indices.push(index);
                if is_first {
                    mesh.positions.push(self.positions[corner[0] as usize]);
                    colours.extend(self.colours.get(corner[0] as usize).copied().unwrap_or_default());
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
            mesh.note_polygon(points.len());
            check("triangles", mesh.triangles.len() as u64, limits.max_triangles)?;
        }
        if odd_positions.count > 0 {
            warnings.surely_once("odd positions", || {
                odd_positions.tell(
                    "has a vertex that is not finite and is left out",
                    "have vertices that are not finite and are left out",
                )
            });
        }
        if odd_normals.count > 0 {
            warnings.surely_once("odd normals", || {
                odd_normals.tell(
                    "has a normal that is not finite and is flat",
                    "have normals that are not finite and are flat",
                )
            });
        }
        if mesh.triangles.is_empty() {
            return Err(ReadError::file(super::empty(odd_positions.count)));
        }
        if !self.colours.is_empty() {
            // What programs write there are codes of sRGB over 255.
            let (name, per) = (COLOUR.to_owned(), Per::Vertex);
            mesh.attributes.push(Attribute { name, per, channels: 3, is_code: true, values: colours });
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

/// Faces in which something isn't a finite number.
#[derive(Default)]
struct Odd {
    count: u64,
    first_line: usize,
}

impl Odd {
    fn add(&mut self, line: usize) {
        if self.count == 0 {
            self.first_line = line;
        }
        self.count += 1;
    }

    /// In words for one face and for several.
    fn tell(&self, one: &str, several: &str) -> String {
        let (faces, line) = (count(self.count, "face"), self.first_line);
        let what = if self.count == 1 { one } else { several };
        if self.count == 1 {
            format!("line {line}: {faces} {what}")
        } else {
            format!("{faces} {what}, the first in line {line}")
        }
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
    let what = NAMES[k];
    ReadError::line(line, format!("a face names {what} {index}, but there are {count}"))
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
