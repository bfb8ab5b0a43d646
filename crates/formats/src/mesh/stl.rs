//! STL, the triangles of 3D printers: binary and ASCII.
//!
//! A binary file has 80 bytes of anything, the number of triangles, and 50 bytes for each: a normal, three corners, and two bytes of which some
//! programs make a colour. What begins with `solid` is ASCII, unless its length is just that of a binary file. Corners at the very same place
//! become one vertex, as they are one in the program that wrote them. The normals of the file are left out: they are those of the triangles,
//! where they are told at all.

use std::collections::HashMap;

use straal_scene::Mesh;
use straal_scene::mesh::{Attribute, Part, Per};

use super::attributes::COLOUR;
use super::lines::Lines;
use super::{colours_left_out, count, empty};
use crate::limits::check;
use crate::read_error::quoted;
use crate::{Limits, Place, ReadError, number};

/// What an STL file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StlFile {
    /// The mesh; its parts are the file's solids, where it names several.
    pub mesh: Mesh,
    /// What was passed over.
    pub warnings: Vec<String>,
}

/// Bytes before the triangles of a binary file.
const HEAD: usize = 84;

/// Bytes of a triangle.
const RECORD: usize = 50;

/// The number of triangles that a binary file tells.
fn told(bytes: &[u8]) -> Option<u64> {
    let four = bytes.get(80..HEAD)?;
    Some(u64::from(u32::from_le_bytes([four[0], four[1], four[2], four[3]])))
}

/// Whether it is binary: its length says so, or it doesn't begin as the other kind does.
fn is_binary(bytes: &[u8]) -> bool {
    let length = told(bytes).map(|triangles| HEAD as u64 + RECORD as u64 * triangles);
    length == Some(bytes.len() as u64) || !begins_as_ascii(bytes)
}

/// Whether it begins with the word `solid` in any letters.
fn begins_as_ascii(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes).trim_ascii_start();
    let (word, rest) = bytes.split_at_checked(5).unwrap_or((bytes, &[]));
    word.eq_ignore_ascii_case(b"solid") && rest.first().is_none_or(u8::is_ascii_whitespace)
}

/// Whether bytes that have lost their name are such a file: ASCII, or binary of just the length that it tells.
pub fn is_stl(bytes: &[u8]) -> bool {
    let length = told(bytes).map(|triangles| HEAD as u64 + RECORD as u64 * triangles);
    begins_as_ascii(bytes) || length == Some(bytes.len() as u64)
}

/// Reads a mesh; with the colours of its faces where `wanted` asks for `color`. One without a triangle is an error.
pub fn read(bytes: &[u8], limits: &Limits, wanted: &dyn Fn(&str) -> bool) -> Result<StlFile, ReadError> {
    limits.check_bytes(bytes)?;
    let mut corners = Corners { known: HashMap::new(), mesh: Mesh::default(), limits, odd: 0 };
    let warnings =
        if is_binary(bytes) { binary(bytes, &mut corners, wanted)? } else { ascii(bytes, &mut corners)? };
    let Corners { mesh, odd, .. } = corners;
    if mesh.triangles.is_empty() {
        return Err(ReadError::file(empty(odd)));
    }
    let mut file = StlFile { mesh, warnings };
    if odd > 0 {
        file.warnings.push(format!("{} with a vertex that is not finite: left out", count(odd, "face")));
    }
    Ok(file)
}

/// Triangles while they are read.
struct Corners<'a> {
    /// Vertices by the bits of their coordinates.
    known: HashMap<[u32; 3], u32>,
    mesh: Mesh,
    limits: &'a Limits,
    /// Triangles that were left out.
    odd: u64,
}

impl Corners<'_> {
    /// Adds a triangle; whether it was taken.
    fn add(&mut self, corners: [[f32; 3]; 3]) -> Result<bool, ReadError> {
        if !corners.as_flattened().iter().all(|v| v.is_finite()) {
            self.odd += 1;
            return Ok(false);
        }
        let mut triangle = [0; 3];
        for (to, p) in triangle.iter_mut().zip(corners) {
            // Zeros of both signs are one place.
            let bits = p.map(|v| (v + 0.0).to_bits());
            let positions = &mut self.mesh.positions;
            let next = positions.len();
            let limit = self.limits.max_vertices.min(u64::from(u32::MAX));
            *to = match self.known.get(&bits) {
                Some(known) => *known,
                None => {
                    check("vertices", next as u64 + 1, limit)?;
                    positions.push(p);
                    self.known.insert(bits, next as u32);
                    next as u32
                }
            };
        }
        check("triangles", self.mesh.triangles.len() as u64 + 1, self.limits.max_triangles)?;
        self.mesh.triangles.push(triangle);
        Ok(true)
    }
}

fn binary(
    bytes: &[u8],
    corners: &mut Corners<'_>,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<Vec<String>, ReadError> {
    let mut warnings = Vec::new();
    let (Some(triangles), Some(body)) = (told(bytes), bytes.get(HEAD..)) else {
        return Err(ReadError::file(
            "not an STL file: it neither begins with 'solid' nor has room for a header",
        ));
    };
    check("triangles", triangles, corners.limits.max_triangles)?;
    let there = (body.len() / RECORD) as u64;
    if there < triangles {
        let problem =
            format!("the file ends too soon: {triangles} triangles are promised, {there} are there");
        return Err(ReadError::at(Place::Byte(bytes.len()), problem));
    }
    let triangles = triangles as usize;
    if body.len() > triangles * RECORD {
        warnings.push(format!(
            "{} behind the last triangle are left out",
            count((body.len() - triangles * RECORD) as u64, "byte")
        ));
    }
    let records = || body.chunks_exact(RECORD).take(triangles);
    corners.mesh.triangles.reserve(triangles);
    // Two ways to tell colours in what were to be zeros: with a word in the header, where the highest bit says that a face has the colour of
    // the whole, and without it, where it says that the face has one.
    let is_magics = bytes[..80].windows(6).any(|word| word == b"COLOR=");
    let code = |record: &[u8]| u16::from_le_bytes([record[48], record[49]]);
    let has_colours = is_magics || (triangles > 0 && records().all(|record| code(record) & 0x8000 != 0));
    let mut values = Vec::new();
    for record in records() {
        let number = |i: usize| f32::from_le_bytes([record[i], record[i + 1], record[i + 2], record[i + 3]]);
        let corner = |k: usize| std::array::from_fn(|i| number(12 + 12 * k + 4 * i));
        if corners.add([corner(0), corner(1), corner(2)])? && has_colours && wanted(COLOUR) {
            values.extend(colour(code(record), is_magics, &bytes[..80]));
        }
    }
    if has_colours && !wanted(COLOUR) {
        warnings.push(colours_left_out("faces"));
    }
    if !values.is_empty() {
        let name = COLOUR.to_owned();
        corners.mesh.attributes.push(Attribute { name, per: Per::Face, channels: 3, is_code: true, values });
    }
    Ok(warnings)
}

/// The colour of a face, in five bits each.
fn colour(code: u16, is_magics: bool, head: &[u8]) -> [f32; 3] {
    let five = |at: u32| f32::from(code >> at & 31) / 31.0;
    if !is_magics {
        return [five(10), five(5), five(0)];
    }
    if code & 0x8000 == 0 {
        return [five(0), five(5), five(10)];
    }
    let at = head.windows(6).position(|word| word == b"COLOR=").unwrap_or(0) + 6;
    std::array::from_fn(|i| f32::from(head.get(at + i).copied().unwrap_or(255)) / 255.0)
}

fn ascii(bytes: &[u8], corners: &mut Corners<'_>) -> Result<Vec<String>, ReadError> {
    let (mut parts, mut warnings): (Vec<Part>, Vec<String>) = (Vec::new(), Vec::new());
    let mut corner: Vec<[f32; 3]> = Vec::new();
    let mut is_open = false;
    let mut strange = 0;
    for statement in Lines::new(bytes) {
        let line = statement.line;
        let keyword = statement.keyword().to_ascii_lowercase();
        match keyword.as_str() {
            "solid" => {
                let start = corners.mesh.triangles.len();
                parts.push(Part {
                    name: statement.name().to_owned(),
                    material: None,
                    triangles: start..start,
                });
            }
            "vertex" => {
                let mut words = statement.words();
                let mut place = [0.0; 3];
                for v in &mut place {
                    let word = words.next().unwrap_or_default();
                    *v = number::single(word).ok_or_else(|| {
                        ReadError::line(
                            line,
                            format!(
                                "three numbers were expected after 'vertex', found {}",
                                quoted(word.as_bytes())
                            ),
                        )
                    })?;
                }
                corner.push(place);
            }
            "endfacet" | "endloop" if !corner.is_empty() => {
                // What has more corners than three is a fan; the format doesn't allow it, but programs write it.
                if corner.len() < 3 {
                    return Err(ReadError::line(
                        line,
                        format!("a face ends here that has {}", count(corner.len() as u64, "corner")),
                    ));
                }
                for k in 1..corner.len() - 1 {
                    corners.add([corner[0], corner[k], corner[k + 1]])?;
                }
                corner.clear();
            }
            "facet" | "outer" => {
                is_open = true;
                corner.clear();
            }
            "endfacet" | "endloop" | "endsolid" => is_open = false,
            _ => strange += 1,
        }
        if let Some(part) = parts.last_mut() {
            part.triangles.end = corners.mesh.triangles.len();
        }
    }
    if is_open && !corner.is_empty() {
        warnings.push("the file ends within a face, which is left out".to_owned());
    }
    if strange > 0 {
        warnings.push(format!("{} of none of the format's words left out", count(strange, "line")));
    }
    parts.retain(|part| !part.triangles.is_empty());
    let is_covered = parts.first().is_some_and(|part| part.triangles.start == 0);
    if parts.len() > 1 && is_covered {
        corners.mesh.parts = parts;
    }
    Ok(warnings)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles of a square.
    const SQUARE: [[[f32; 3]; 3]; 2] = [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]],
        [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, -0.0]],
    ];

    fn packed(head: &[u8], codes: [u16; 2]) -> Vec<u8> {
        let mut out = head.to_vec();
        out.resize(80, b' ');
        out.extend(2_u32.to_le_bytes());
        for (triangle, code) in SQUARE.iter().zip(codes) {
            out.extend([0; 12]);
            triangle.as_flattened().iter().for_each(|v| out.extend(v.to_le_bytes()));
            out.extend(code.to_le_bytes());
        }
        out
    }

    fn written() -> String {
        let mut out = "solid a square\r\n".to_owned();
        for triangle in SQUARE {
            out += " facet normal 0 0 1\n  outer loop\n";
            triangle.iter().for_each(|[x, y, z]| out += &format!("   vertex {x:e} {y} {z}\n"));
            out += "  endloop\n endfacet\n";
        }
        out + "endsolid a square\n"
    }

    fn read(bytes: &[u8]) -> Result<StlFile, ReadError> {
        super::read(bytes, &Limits::default(), &|_| true)
    }

    #[test]
    fn both_kinds_are_the_same_mesh() {
        // A binary file may well begin with the word of the other kind.
        let binary = read(&packed(b"solid, but binary", [0, 0])).unwrap();
        let ascii = read(written().as_bytes()).unwrap();
        assert_eq!(binary, ascii);
        assert_eq!(binary.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(binary.warnings.is_empty() && binary.mesh.attributes.is_empty());
    }

    #[test]
    fn faces_have_colours_two_ways() {
        let colours = |bytes: &[u8]| read(bytes).unwrap().mesh.attributes[0].values.clone();
        assert_eq!(colours(&packed(b"", [0x8000 | 31 << 10, 0x8000 | 31])), [1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(
            colours(&packed(b"COLOR=\xff\x00\x00\xff", [31 << 10, 0x8000])),
            [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]
        );
        let left_out = super::read(&packed(b"", [0x8000; 2]), &Limits::default(), &|_| false).unwrap();
        assert!(left_out.mesh.attributes.is_empty() && left_out.warnings.len() == 1);
    }

    #[test]
    fn what_is_cut_off_is_refused() {
        let whole = packed(b"x", [0, 0]);
        for cut in 0..whole.len() {
            assert!(read(&whole[..cut]).is_err(), "{cut}");
        }
        let text = written();
        for cut in 0..text.len() {
            // It ends, whatever comes of it.
            let _ = read(&text.as_bytes()[..cut]);
        }
        assert!(read(b"solid\nfacet\nouter loop\nvertex 1 2\n").is_err());
        assert!(read(b"solid\nendsolid").is_err());
        let mut longer = whole;
        longer.push(7);
        assert_eq!(read(&longer).unwrap().warnings.len(), 1);
    }
}
