//! PLY, the Stanford polygon format: ASCII and both binary orders.
//!
//! Read are the elements `vertex` (properties x y z; nx ny nz; one of u v, s t, texture_u texture_v; and tangent_x to tangent_side), `face` and
//! `tristrips` (a list named vertex_indices or vertex_index; -1 ends a strip), and of vertices and faces what somebody asks for by
//! name: `color`, which is red green blue or r g b, perhaps with alpha, or any other property that is a number. Everything else that the header
//! declares is skipped. Faces of one or two corners have no area and are left out. Numbers of the ASCII form are
//! separated by any white space, so that a record may run over several lines. Lines of the header end in a line feed, a
//! carriage return or both.

pub(super) mod header;
mod stream;
mod write;

pub use write::write;

use std::io::Read;

use straal_scene::Mesh;
use straal_scene::mesh::Per;

use self::header::{Element, Encoding, Header, Kind, Property, Scalar};
use super::attributes::{COLOUR, Columns};
use super::{colours_left_out, count, polygon};
use crate::limits::check;
use crate::number;
use crate::read_error::quoted;
use crate::{Limits, Place, ReadError};

/// What a PLY file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyFile {
    /// The mesh.
    pub mesh: Mesh,
    /// What was passed over.
    pub warnings: Vec<String>,
}

/// Whether a file begins as a PLY file does: with a line `ply`, perhaps after a byte order mark and blank lines.
pub fn is_ply(bytes: &[u8]) -> bool {
    let rest = bytes[header::start(bytes)..].strip_prefix(b"ply");
    rest.is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// Reads a mesh without attributes. One without a triangle is an error.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<PlyFile, ReadError> {
    read_with(bytes, limits, &|_| false)
}

/// Reads a mesh with the attributes that are wanted by their names.
pub fn read_with(bytes: &[u8], limits: &Limits, wanted: &dyn Fn(&str) -> bool) -> Result<PlyFile, ReadError> {
    read_all(bytes, &Asked { limits, wanted, points_alone: false })
}

/// Reads vertices with the attributes that are wanted, of a file that may have no triangle.
pub(crate) fn read_points(
    bytes: &[u8],
    limits: &Limits,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<Mesh, ReadError> {
    Ok(read_all(bytes, &Asked { limits, wanted, points_alone: true })?.mesh)
}

/// What is asked of a file.
struct Asked<'a> {
    limits: &'a Limits,
    /// Attributes by name.
    wanted: &'a dyn Fn(&str) -> bool,
    /// Whether it may have no triangle.
    points_alone: bool,
}

fn read_all(bytes: &[u8], asked: &Asked<'_>) -> Result<PlyFile, ReadError> {
    asked.limits.check_bytes(bytes)?;
    let header = Header::parse(bytes)?;
    match header.encoding {
        Encoding::Ascii => {
            read_body(&header, Ascii { bytes, at: header.length, line: header.lines + 1 }, asked)
        }
        Encoding::Little => read_body(&header, Binary { bytes, at: header.length, big: false }, asked),
        Encoding::Big => read_body(&header, Binary { bytes, at: header.length, big: true }, asked),
    }
}

/// Reads a mesh of a file of so many bytes whose first are there and whose rest comes as it is asked for. `None` of one that has to be in memory
/// as a whole: text, one whose faces come before its vertices, and one whose header is long.
pub(crate) fn read_in_passing(
    (head, rest): (&[u8], &mut dyn Read),
    size: u64,
    limits: &Limits,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<Option<PlyFile>, ReadError> {
    // What is wrong with a header is told when all of it is there.
    let Ok(header) = Header::parse(head) else { return Ok(None) };
    let place = |is: fn(&Element) -> bool| header.elements.iter().position(is);
    let (vertices, faces) = (place(|e| e.name == "vertex"), place(Element::holds_faces));
    let is_in_order = vertices.is_some_and(|v| faces.is_none_or(|f| v < f));
    let big = match header.encoding {
        Encoding::Ascii => return Ok(None),
        Encoding::Little => false,
        Encoding::Big => true,
    };
    if !is_in_order || header.length > head.len() {
        return Ok(None);
    }
    let body = stream::Stream::new(rest, (head, header.length), size, big);
    read_body(&header, body, &Asked { limits, wanted, points_alone: false }).map(Some)
}

/// Reads the elements in the order of the header. Faces need the vertices, so that faces that come first are passed
/// over and read at the end.
fn read_body<B: Body>(
    header: &Header,
    mut body: B,
    &Asked { limits, wanted, points_alone }: &Asked<'_>,
) -> Result<PlyFile, ReadError> {
    let mut reader = Reader { mesh: Mesh::default(), limits, wanted, is_finite: true, odd_faces: 0 };
    let mut later = Vec::new();
    let mut have_vertices = false;
    let is_wanted = |element: &Element| element.name == "vertex" || element.holds_faces();
    let needed = header.elements.iter().rposition(is_wanted).map_or(0, |last| last + 1);
    for (i, element) in header.elements.iter().enumerate() {
        if !B::KNOWS_WIDTHS
            && let Some((line, name)) = &element.unknown
        {
            if i >= needed {
                // Nothing behind it is needed.
                break;
            }
            let name = quoted(name.as_bytes());
            return Err(ReadError::line(
                *line,
                format!("unknown property type {name}: how many bytes it takes isn't known"),
            ));
        }
        check_promise(element, &body)?;
        if element.name == "vertex" {
            if have_vertices {
                return Err(ReadError::line(element.line, "a second 'vertex' element"));
            }
            check("vertices", element.count, limits.max_vertices.min(u64::from(u32::MAX)))?;
            reader.vertices(element, &mut body)?;
            have_vertices = true;
        } else if !element.holds_faces() {
            skip(element, &mut body)?;
        } else if have_vertices {
            reader.faces(element, &mut body)?;
        } else {
            later.extend(body.again().map(|body| (element, body)));
            skip(element, &mut body)?;
        }
    }
    if !have_vertices {
        return Err(ReadError::file("there is no 'vertex' element"));
    }
    for (element, mut body) in later {
        reader.faces(element, &mut body)?;
    }
    let mut warnings = Vec::new();
    let coloured = |name: &str| header.elements.iter().any(|e| e.name == name && e.has_colours());
    if !wanted(COLOUR) {
        warnings.extend(coloured("vertex").then(|| colours_left_out("vertices")));
        warnings.extend(coloured("face").then(|| colours_left_out("faces")));
    }
    if reader.odd_faces > 0 {
        let faces = count(reader.odd_faces, "face");
        let what = if reader.odd_faces == 1 {
            "has a vertex that is not finite and is left out"
        } else {
            "have vertices that are not finite and are left out"
        };
        warnings.push(format!("{faces} {what}"));
    }
    if reader.mesh.triangles.is_empty() && !points_alone {
        return Err(ReadError::file(super::empty(reader.odd_faces)));
    }
    warnings.extend(reader.flatten_odd_normals()?);
    Ok(PlyFile { mesh: reader.mesh, warnings })
}

/// Refuses an element whose records can't all be in what is left of the file, before anything is done for it.
fn check_promise<B: Body>(element: &Element, body: &B) -> Result<(), ReadError> {
    let least = element.properties.iter().map(|p| body.least_size(p.kind)).fold(0u64, u64::saturating_add);
    let left = body.left();
    // The last number of an ASCII file needs no separator.
    if element.count.saturating_mul(least) > left.saturating_add(1) {
        let Element { name, count, line, .. } = element;
        return Err(ReadError::line(
            *line,
            format!("the header promises {count} of '{name}', but only {left} bytes are left for them"),
        ));
    }
    Ok(())
}

fn skip<B: Body>(element: &Element, body: &mut B) -> Result<(), ReadError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            body.skip(property.kind)?;
        }
    }
    Ok(())
}

/// Where a vertex property goes: a place in a record of x y z, nx ny nz, u v, and the tangent and its side, which straal alone writes.
const VERTEX_NAMES: [&[&str]; 12] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["u", "s", "texture_u", "texture_s"],
    &["v", "t", "texture_v", "texture_t"],
    &["tangent_x"],
    &["tangent_y"],
    &["tangent_z"],
    &["tangent_side"],
];

/// A mesh that is being read.
struct Reader<'a> {
    mesh: Mesh,
    limits: &'a Limits,
    /// Whether an attribute is asked for.
    wanted: &'a dyn Fn(&str) -> bool,
    /// Whether all vertices so far are finite.
    is_finite: bool,
    /// Faces that were left out because a vertex isn't.
    odd_faces: u64,
}

impl Reader<'_> {
    fn vertices<B: Body>(&mut self, element: &Element, body: &mut B) -> Result<(), ReadError> {
        let mut found = [false; VERTEX_NAMES.len()];
        let mut plan = Vec::with_capacity(element.properties.len());
        for property in &element.properties {
            let slot = VERTEX_NAMES.iter().position(|names| names.contains(&property.name.as_str()));
            let slot = slot.filter(|&slot| matches!(property.kind, Kind::Scalar(_)) && !found[slot]);
            if let Some(slot) = slot {
                found[slot] = true;
            }
            plan.push((property.kind, slot));
        }
        let free = |i: usize| plan[i].1.is_none();
        let mut columns = Columns::new(&element.properties, Per::Vertex, self.wanted, free);
        if let Some(missing) = (0..3).find(|&k| !found[k]) {
            let name = VERTEX_NAMES[missing][0];
            return Err(ReadError::line(element.line, format!("the vertices have no property '{name}'")));
        }
        let has_normals = found[3] && found[4] && found[5];
        let has_uvs = found[6] && found[7];
        let has_tangents = found[8..].iter().all(|found| *found);
        let mesh = &mut self.mesh;
        let count = element.count as usize; // proven by the file's size
        mesh.positions.reserve_exact(count);
        mesh.normals.reserve_exact(if has_normals { count } else { 0 });
        mesh.uvs.reserve_exact(if has_uvs { count } else { 0 });
        mesh.tangents.reserve_exact(if has_tangents { count } else { 0 });
        for _ in 0..count {
            let mut record = [0.0f32; VERTEX_NAMES.len()];
            for (i, &(kind, slot)) in plan.iter().enumerate() {
                match (kind, slot) {
                    (Kind::Scalar(scalar), Some(slot)) => record[slot] = body.number(scalar)?,
                    (Kind::Scalar(scalar), None) if columns.has(i) => columns.put(i, body.number(scalar)?),
                    _ => body.skip(kind)?,
                }
            }
            columns.end_record(1);
            let [x, y, z, nx, ny, nz, u, v, tx, ty, tz, side] = record;
            self.is_finite &= x.is_finite() && y.is_finite() && z.is_finite();
            mesh.positions.push([x, y, z]);
            if has_normals {
                mesh.normals.push([nx, ny, nz]);
            }
            if has_uvs {
                mesh.uvs.push([u, v]);
            }
            if has_tangents {
                mesh.tangents.push([tx, ty, tz, side]);
            }
        }
        self.mesh.attributes.extend(columns.finish());
        Ok(())
    }

    fn faces<B: Body>(&mut self, element: &Element, body: &mut B) -> Result<(), ReadError> {
        let is_list = |p: &Property| matches!(p.kind, Kind::List { .. }) && is_index_list(&p.name);
        let Some(list) = element.properties.iter().position(is_list) else {
            let problem = format!("'{}' has no list named 'vertex_indices' or 'vertex_index'", element.name);
            return Err(ReadError::line(element.line, problem));
        };
        let is_strips = element.name == "tristrips";
        let mut columns = Columns::new(&element.properties, Per::Face, self.wanted, |i| i != list);
        // Triangles of elements before have none of these.
        columns.end_record(self.mesh.triangles.len());
        if !is_strips {
            self.mesh.triangles.reserve(element.count as usize); // proven by the file's size
        }
        let mut corners: Vec<u32> = Vec::new();
        let mut points: Vec<[f32; 3]> = Vec::new();
        for face in 0..element.count {
            let before = self.mesh.triangles.len();
            for (i, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::List { count, item } if i == list => {
                        let place = body.place();
                        let told = |problem: String| ReadError::at(place, format!("face {face} {problem}"));
                        let count = body.list_length(count, item)?;
                        corners.clear();
                        for _ in 0..count {
                            let index = body.integer(item)?;
                            if is_strips && index == -1 {
                                self.strip(&corners);
                                corners.clear();
                                continue;
                            }
                            let known = self.mesh.positions.len();
                            match u32::try_from(index) {
                                Ok(index) if (index as usize) < known => corners.push(index),
                                _ => {
                                    return Err(told(format!("names vertex {index}, but there are {known}")));
                                }
                            }
                        }
                        if is_strips {
                            self.strip(&corners);
                        } else if !self.is_finite && corners.len() > 2 && !self.are_finite(&corners) {
                            self.odd_faces += 1;
                        } else if let &[a, b, c] = corners.as_slice() {
                            self.mesh.triangles.push([a, b, c]);
                            self.mesh.note_polygon(3);
                        } else {
                            points.clear();
                            points.extend(corners.iter().map(|&i| self.mesh.positions[i as usize]));
                            let triangles = &mut self.mesh.triangles;
                            polygon::triangulate(&points, |t| triangles.push(t.map(|i| corners[i])))
                                .map_err(|_| {
                                    let most = polygon::MAX_CONCAVE_CORNERS;
                                    told(format!("is concave with {count} corners, the limit is {most}"))
                                })?;
                            self.mesh.note_polygon(corners.len());
                        }
                        check("triangles", self.mesh.triangles.len() as u64, self.limits.max_triangles)?;
                    }
                    Kind::Scalar(scalar) if columns.has(i) => columns.put(i, body.number(scalar)?),
                    kind => body.skip(kind)?,
                }
            }
            columns.end_record(self.mesh.triangles.len() - before);
        }
        self.mesh.attributes.extend(columns.finish());
        Ok(())
    }

    /// Adds the triangles of a strip, every second one turned so that all wind the same way. Degenerate ones, which
    /// only stitch strips together, are left out.
    fn strip(&mut self, strip: &[u32]) {
        for (i, corner) in strip.windows(3).enumerate() {
            let [a, b, c] = [corner[0], corner[1], corner[2]];
            if a == b || b == c || a == c {
                continue;
            }
            if !self.is_finite && !self.are_finite(corner) {
                self.odd_faces += 1;
                continue;
            }
            self.mesh.triangles.push(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
        }
    }

    fn are_finite(&self, corners: &[u32]) -> bool {
        corners.iter().all(|&i| self.mesh.positions[i as usize].iter().all(|v| v.is_finite()))
    }

    /// Gives triangles with a normal that isn't finite vertices of their own, with the normal of the triangle.
    fn flatten_odd_normals(&mut self) -> Result<Option<String>, ReadError> {
        let Mesh { positions, normals, uvs, triangles, attributes, .. } = &mut self.mesh;
        let is_odd = |n: &[f32; 3]| n.iter().any(|v| !v.is_finite());
        if !normals.iter().any(is_odd) {
            return Ok(None);
        }
        if normals.iter().all(is_odd) {
            normals.clear();
            return Ok(Some("its normals are not finite and are left out".to_owned()));
        }
        let mut flat = 0;
        for triangle in triangles {
            if !triangle.iter().any(|&i| is_odd(&normals[i as usize])) {
                continue;
            }
            flat += 1;
            let first = positions.len() as u64;
            check("vertices", first + 3, self.limits.max_vertices.min(u64::from(u32::MAX)))?;
            let corners = triangle.map(|i| positions[i as usize]);
            for (k, i) in triangle.iter_mut().enumerate() {
                positions.push(corners[k]);
                normals.push(super::flat_normal(&corners));
                if let Some(&uv) = uvs.get(*i as usize) {
                    uvs.push(uv);
                }
                for a in attributes.iter_mut().filter(|a| a.per == Per::Vertex) {
                    let start = *i as usize * a.channels;
                    a.values.extend_from_within(start..start + a.channels);
                }
                *i = first as u32 + k as u32;
            }
        }
        let what = if flat == 1 {
            "has a normal that is not finite and is flat"
        } else {
            "have normals that are not finite and are flat"
        };
        Ok((flat > 0).then(|| format!("{} {what}", count(flat, "triangle"))))
    }
}

fn is_index_list(name: &str) -> bool {
    name == "vertex_indices" || name == "vertex_index"
}

/// The part of the file after the header, read number by number.
trait Body: Sized {
    /// Whether numbers of a type that isn't known can be passed over.
    const KNOWS_WIDTHS: bool;

    /// To read the same once more; `None` where what is read is gone.
    fn again(&self) -> Option<Self>;
    /// Where the next number is.
    fn place(&self) -> Place;
    /// How many bytes are left.
    fn left(&self) -> u64;
    /// The fewest bytes that a property takes in a record.
    fn least_size(&self, kind: Kind) -> u64;
    fn number(&mut self, scalar: Scalar) -> Result<f32, ReadError>;
    fn integer(&mut self, scalar: Scalar) -> Result<i64, ReadError>;
    fn skip_scalars(&mut self, scalar: Scalar, count: usize) -> Result<(), ReadError>;

    /// The length of a list, which the rest of the file is known to be long enough for.
    fn list_length(&mut self, count: Scalar, item: Scalar) -> Result<usize, ReadError> {
        let place = self.place();
        let count = self.integer(count)?;
        let Ok(length) = u64::try_from(count) else {
            return Err(ReadError::at(place, format!("a list of {count} items")));
        };
        if length.saturating_mul(self.least_size(Kind::Scalar(item))) > self.left().saturating_add(1) {
            let problem = format!("a list of {count} items, but only {} bytes are left", self.left());
            return Err(ReadError::at(place, problem));
        }
        Ok(length as usize)
    }

    fn skip(&mut self, kind: Kind) -> Result<(), ReadError> {
        match kind {
            Kind::Scalar(scalar) => self.skip_scalars(scalar, 1),
            Kind::List { count, item } => {
                let length = self.list_length(count, item)?;
                self.skip_scalars(item, length)
            }
        }
    }
}

/// Bytes of numbers, in the order of the smallest first.
trait Bytes {
    /// The next ones.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ReadError>;
    /// Where they are.
    fn here(&self) -> Place;
}

#[inline]
fn number_of(body: &mut impl Bytes, scalar: Scalar) -> Result<f32, ReadError> {
    Ok(match scalar {
        Scalar::F32 => f32::from_le_bytes(body.take()?),
        Scalar::F64 => f64::from_le_bytes(body.take()?) as f32,
        Scalar::U64 => u64::from_le_bytes(body.take()?) as f32,
        _ => integer_of(body, scalar)? as f32,
    })
}

#[inline]
fn integer_of(body: &mut impl Bytes, scalar: Scalar) -> Result<i64, ReadError> {
    Ok(match scalar {
        Scalar::I8 => i8::from_le_bytes(body.take()?).into(),
        Scalar::U8 => u8::from_le_bytes(body.take()?).into(),
        Scalar::I16 => i16::from_le_bytes(body.take()?).into(),
        Scalar::U16 => u16::from_le_bytes(body.take()?).into(),
        Scalar::I32 => i32::from_le_bytes(body.take()?).into(),
        Scalar::U32 => u32::from_le_bytes(body.take()?).into(),
        Scalar::I64 => i64::from_le_bytes(body.take()?),
        Scalar::U64 => {
            let place = body.here();
            let number = u64::from_le_bytes(body.take()?);
            i64::try_from(number)
                .map_err(|_| ReadError::at(place, format!("the number {number} is too large")))?
        }
        Scalar::Other(_) => {
            return Err(ReadError::at(body.here(), "a number of a type that can only be passed over"));
        }
        Scalar::F32 => whole(f32::from_le_bytes(body.take()?).into(), body.here())?,
        Scalar::F64 => whole(f64::from_le_bytes(body.take()?), body.here())?,
    })
}

#[derive(Clone)]
struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    big: bool,
}

impl Bytes for Binary<'_> {
    fn here(&self) -> Place {
        Place::Byte(self.at)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let Some(&taken) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(ReadError::byte(self.at, "the file ends too early"));
        };
        self.at += N;
        let mut taken = taken;
        if self.big {
            taken.reverse();
        }
        Ok(taken)
    }
}

impl Body for Binary<'_> {
    const KNOWS_WIDTHS: bool = false;

    fn again(&self) -> Option<Self> {
        Some(self.clone())
    }

    fn place(&self) -> Place {
        Place::Byte(self.at)
    }

    fn left(&self) -> u64 {
        (self.bytes.len() - self.at) as u64
    }

    fn least_size(&self, kind: Kind) -> u64 {
        match kind {
            Kind::Scalar(scalar) | Kind::List { count: scalar, .. } => scalar.size() as u64,
        }
    }

    fn number(&mut self, scalar: Scalar) -> Result<f32, ReadError> {
        number_of(self, scalar)
    }

    fn integer(&mut self, scalar: Scalar) -> Result<i64, ReadError> {
        integer_of(self, scalar)
    }

    fn skip_scalars(&mut self, scalar: Scalar, count: usize) -> Result<(), ReadError> {
        let bytes = scalar.size().saturating_mul(count);
        if bytes as u64 > self.left() {
            return Err(ReadError::byte(self.at, "the file ends too early"));
        }
        self.at += bytes;
        Ok(())
    }
}

#[derive(Clone)]
struct Ascii<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Ascii<'a> {
    fn word(&mut self) -> Result<&'a str, ReadError> {
        while let Some(byte) = self.bytes.get(self.at).filter(|b| b.is_ascii_whitespace()) {
            let is_alone = || self.bytes.get(self.at + 1) != Some(&b'\n');
            self.line += usize::from(*byte == b'\n' || *byte == b'\r' && is_alone());
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(ReadError::line(self.line, "the file ends too early"));
        }
        self.at += length;
        std::str::from_utf8(&rest[..length]).map_err(|_| self.not_a_number(&rest[..length]))
    }

    fn not_a_number(&self, word: &[u8]) -> ReadError {
        ReadError::line(self.line, format!("expected a number, found {}", quoted(word)))
    }
}

impl Body for Ascii<'_> {
    /// White space tells where a number ends, whatever it is.
    const KNOWS_WIDTHS: bool = true;

    fn again(&self) -> Option<Self> {
        Some(self.clone())
    }

    fn place(&self) -> Place {
        let rest = &self.bytes[self.at..];
        let blank = rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
        Place::Line(self.line + header::line_ends(&rest[..blank]))
    }

    fn left(&self) -> u64 {
        (self.bytes.len() - self.at) as u64
    }

    /// A digit and a separator.
    fn least_size(&self, _: Kind) -> u64 {
        2
    }

    fn number(&mut self, _: Scalar) -> Result<f32, ReadError> {
        let word = self.word()?;
        number::single(word).ok_or_else(|| self.not_a_number(word.as_bytes()))
    }

    fn integer(&mut self, _: Scalar) -> Result<i64, ReadError> {
        let word = self.word()?;
        match word.parse() {
            Ok(integer) => Ok(integer),
            Err(_) => {
                let number = number::double(word).ok_or_else(|| self.not_a_number(word.as_bytes()))?;
                whole(number, Place::Line(self.line))
            }
        }
    }

    fn skip_scalars(&mut self, _: Scalar, count: usize) -> Result<(), ReadError> {
        for _ in 0..count {
            self.word()?;
        }
        Ok(())
    }
}

/// A float that stands where an integer should.
fn whole(number: f64, place: Place) -> Result<i64, ReadError> {
    let integer = number as i64;
    if integer as f64 == number {
        Ok(integer)
    } else {
        Err(ReadError::at(place, format!("expected a whole number, found {number}")))
    }
}
