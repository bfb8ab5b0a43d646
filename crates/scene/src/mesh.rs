//! Triangle meshes as files hold them.

use std::ops::Range;

/// An indexed triangle mesh. A reader guarantees that every index is in range and that the optional arrays are
/// either empty or as long as `positions`; coordinates may be anything, infinite and NaN included (such triangles
/// are dropped and counted when the search structure is built).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions in the file's own units.
    pub positions: Vec<[f32; 3]>,
    /// Shading normals, one a vertex, not necessarily of unit length; empty when the file has none.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, one a vertex; empty when the file has none.
    pub uvs: Vec<[f32; 2]>,
    /// Directions that brushed surfaces and maps of normals follow, one a vertex, and a side of 1 or -1: across them lies the cross
    /// product of the normal and the direction, times the side. Empty when the file has none: then they follow the texture coordinates.
    pub tangents: Vec<[f32; 4]>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// How many corners each polygon has that the triangles were cut from, in order: one of n corners gave n - 2 of them. Empty
    /// when all were triangles.
    pub sides: Vec<u32>,
    /// What vertices or faces have besides.
    pub attributes: Vec<Attribute>,
    /// Runs of triangles that name a material of the file, in order and without gaps; empty when it names none.
    pub parts: Vec<Part>,
}

impl Mesh {
    /// Whether all indices are in range, and the optional lists are empty or as long as `positions`.
    pub fn is_whole(&self) -> bool {
        let n = self.positions.len();
        let fits = |list: usize| list == 0 || list == n;
        self.triangles.iter().flatten().all(|&i| (i as usize) < n)
            && fits(self.normals.len())
            && fits(self.uvs.len())
            && fits(self.tangents.len())
    }

    /// Takes note that the last triangles were cut from a polygon of so many corners.
    pub fn note_polygon(&mut self, corners: usize) {
        let before = self.triangles.len().saturating_sub(corners.saturating_sub(2));
        if corners > 3 && self.sides.is_empty() {
            self.sides.resize(before, 3);
        }
        if corners > 3 || !self.sides.is_empty() {
            self.sides.push(corners as u32);
        }
    }

    /// Corners of all polygons.
    pub fn corners(&self) -> u64 {
        match self.sides.as_slice() {
            [] => 3 * self.triangles.len() as u64,
            sides => sides.iter().map(|n| u64::from(*n)).sum(),
        }
    }

    /// Bytes of its lists.
    pub fn heap_bytes(&self) -> u64 {
        let Self { positions, normals, uvs, tangents, triangles, sides, attributes, parts } = self;
        let values: usize = attributes.iter().map(|a| size_of_val(a.values.as_slice())).sum();
        (values
            + size_of_val(positions.as_slice())
            + size_of_val(normals.as_slice())
            + size_of_val(uvs.as_slice())
            + size_of_val(tangents.as_slice())
            + size_of_val(triangles.as_slice())
            + size_of_val(sides.as_slice())
            + size_of_val(parts.as_slice())) as u64
    }
}

/// What each vertex or triangle has besides its place: a colour, or a number of any meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// How textures call it: `color`, or as the file does.
    pub name: String,
    /// Whether vertices or triangles have it.
    pub per: Per,
    /// Numbers of each: 1 to 4.
    pub channels: usize,
    /// Whether its numbers were whole ones: codes, of which the largest is 1.
    pub is_code: bool,
    /// `channels` numbers of each vertex or triangle.
    pub values: Vec<f32>,
}

/// What has an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Each vertex: it is mixed between them.
    Vertex,
    /// Each triangle.
    Face,
}

/// A run of a mesh's triangles with one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The group's or object's name in the file; empty when it has none.
    pub name: String,
    /// The material's name in the file, if one is named.
    pub material: Option<String>,
    /// Which triangles.
    pub triangles: Range<usize>,
}
