//! PLY, the Stanford polygon format: ASCII and both binary orders.
//!
//! Read are the elements `vertex` (properties x y z; nx ny nz; and one of u v, s t, texture_u texture_v), `face` and
//! `tristrips` (a list named vertex_indices or vertex_index; -1 ends a strip). Everything else that the header
//! declares is skipped. Faces of one or two corners have no area and are left out. Numbers of the ASCII form are
//! separated by any white space, so that a record may run over several lines.

use straal_scene::Mesh;

use super::polygon;
use crate::limits::check;
use crate::read_error::quoted;
use crate::{Limits, Place, ReadError};

/// Reads a mesh. One without a triangle is an error.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Mesh, ReadError> {
    limits.check_bytes(bytes)?;
    let header = Header::parse(bytes)?;
    match header.encoding {
        Encoding::Ascii => {
            read_body(&header, Ascii { bytes, at: header.length, line: header.lines + 1 }, limits)
        }
        Encoding::Little => read_body(&header, Binary { bytes, at: header.length, big: false }, limits),
        Encoding::Big => read_body(&header, Binary { bytes, at: header.length, big: true }, limits),
    }
}

/// Reads the elements in the order of the header. Faces need the vertices, so that faces that come first are passed
/// over and read at the end.
fn read_body<B: Body>(header: &Header, mut body: B, limits: &Limits) -> Result<Mesh, ReadError> {
    let mut mesh = Mesh::default();
    let mut later = Vec::new();
    let mut have_vertices = false;
    for element in &header.elements {
        check_promise(element, &body)?;
        if element.name == "vertex" {
            if have_vertices {
                return Err(ReadError::line(element.line, "a second 'vertex' element"));
            }
            check("vertices", element.count, limits.max_vertices.min(u64::from(u32::MAX)))?;
            read_vertices(element, &mut body, &mut mesh)?;
            have_vertices = true;
        } else if !element.holds_faces() {
            skip(element, &mut body)?;
        } else if have_vertices {
            read_faces(element, &mut body, &mut mesh, limits)?;
        } else {
            later.push((element, body.clone()));
            skip(element, &mut body)?;
        }
    }
    if !have_vertices {
        return Err(ReadError::file("there is no 'vertex' element"));
    }
    for (element, mut body) in later {
        read_faces(element, &mut body, &mut mesh, limits)?;
    }
    if mesh.triangles.is_empty() {
        return Err(ReadError::file("the mesh is empty: it has no face with three corners"));
    }
    Ok(mesh)
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

/// Where a vertex property goes: a place in a record of x y z, nx ny nz, u v.
const VERTEX_NAMES: [&[&str]; 8] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["u", "s", "texture_u", "texture_s"],
    &["v", "t", "texture_v", "texture_t"],
];

fn read_vertices<B: Body>(element: &Element, body: &mut B, mesh: &mut Mesh) -> Result<(), ReadError> {
    let mut found = [false; 8];
    let mut plan = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        let slot = VERTEX_NAMES.iter().position(|names| names.contains(&property.name.as_str()));
        let slot = slot.filter(|&slot| matches!(property.kind, Kind::Scalar(_)) && !found[slot]);
        if let Some(slot) = slot {
            found[slot] = true;
        }
        plan.push((property.kind, slot));
    }
    if let Some(missing) = (0..3).find(|&k| !found[k]) {
        let name = VERTEX_NAMES[missing][0];
        return Err(ReadError::line(element.line, format!("the vertices have no property '{name}'")));
    }
    let has_normals = found[3] && found[4] && found[5];
    let has_uvs = found[6] && found[7];
    let count = element.count as usize; // proven by the file's size
    mesh.positions.reserve_exact(count);
    mesh.normals.reserve_exact(if has_normals { count } else { 0 });
    mesh.uvs.reserve_exact(if has_uvs { count } else { 0 });
    for _ in 0..count {
        let mut record = [0.0f32; 8];
        for &(kind, slot) in &plan {
            match (kind, slot) {
                (Kind::Scalar(scalar), Some(slot)) => record[slot] = body.number(scalar)?,
                _ => body.skip(kind)?,
            }
        }
        let [x, y, z, nx, ny, nz, u, v] = record;
        mesh.positions.push([x, y, z]);
        if has_normals {
            mesh.normals.push([nx, ny, nz]);
        }
        if has_uvs {
            mesh.uvs.push([u, v]);
        }
    }
    Ok(())
}

fn read_faces<B: Body>(
    element: &Element,
    body: &mut B,
    mesh: &mut Mesh,
    limits: &Limits,
) -> Result<(), ReadError> {
    let is_list = |p: &Property| matches!(p.kind, Kind::List { .. }) && is_index_list(&p.name);
    let Some(list) = element.properties.iter().position(is_list) else {
        let problem = format!("'{}' has no list named 'vertex_indices' or 'vertex_index'", element.name);
        return Err(ReadError::line(element.line, problem));
    };
    let is_strips = element.name == "tristrips";
    if !is_strips {
        mesh.triangles.reserve(element.count as usize); // proven by the file's size
    }
    let mut corners: Vec<u32> = Vec::new();
    let mut points: Vec<[f32; 3]> = Vec::new();
    for face in 0..element.count {
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
                            push_strip(&corners, mesh);
                            corners.clear();
                            continue;
                        }
                        let known = mesh.positions.len();
                        match u32::try_from(index) {
                            Ok(index) if (index as usize) < known => corners.push(index),
                            _ => return Err(told(format!("names vertex {index}, but there are {known}"))),
                        }
                    }
                    if is_strips {
                        push_strip(&corners, mesh);
                    } else if let &[a, b, c] = corners.as_slice() {
                        mesh.triangles.push([a, b, c]);
                    } else {
                        points.clear();
                        points.extend(corners.iter().map(|&i| mesh.positions[i as usize]));
                        let triangles = &mut mesh.triangles;
                        polygon::triangulate(&points, |t| triangles.push(t.map(|i| corners[i]))).map_err(
                            |_| {
                                let most = polygon::MAX_CONCAVE_CORNERS;
                                told(format!("is concave with {count} corners, the limit is {most}"))
                            },
                        )?;
                    }
                    check("triangles", mesh.triangles.len() as u64, limits.max_triangles)?;
                }
                kind => body.skip(kind)?,
            }
        }
    }
    Ok(())
}

/// Adds the triangles of a strip, every second one turned so that all wind the same way. Degenerate ones, which
/// only stitch strips together, are left out.
fn push_strip(strip: &[u32], mesh: &mut Mesh) {
    for (i, corner) in strip.windows(3).enumerate() {
        let [a, b, c] = [corner[0], corner[1], corner[2]];
        if a != b && b != c && a != c {
            mesh.triangles.push(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
        }
    }
}

fn is_index_list(name: &str) -> bool {
    name == "vertex_indices" || name == "vertex_index"
}

/// What the header declares.
struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Bytes and lines up to and with `end_header`.
    length: usize,
    lines: usize,
}

#[derive(Clone, Copy)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
    /// The header's line that declares it.
    line: usize,
}

struct Property {
    name: String,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Clone, Copy, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Element {
    fn holds_faces(&self) -> bool {
        self.name == "face" || self.name == "tristrips"
    }
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        if !bytes.starts_with(b"ply") {
            return Err(ReadError::file("not a PLY file: it doesn't begin with 'ply'"));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut at = 0;
        let mut line = 0;
        loop {
            let Some(length) = bytes[at..].iter().position(|&b| b == b'\n') else {
                return Err(ReadError::line(line + 1, "the header has no 'end_header'"));
            };
            line += 1;
            let text = bytes[at..at + length].trim_ascii();
            at += length + 1;
            let text = std::str::from_utf8(text).unwrap_or("?");
            let words: Vec<&str> = text.split_ascii_whitespace().take(6).collect();
            match words.as_slice() {
                ["ply"] if line == 1 => {}
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, ..] => {
                    encoding = Some(match *name {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::Little,
                        "binary_big_endian" => Encoding::Big,
                        _ => {
                            let name = quoted(name.as_bytes());
                            return Err(ReadError::line(line, format!("unknown format {name}")));
                        }
                    });
                }
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| {
                        let count = quoted(count.as_bytes());
                        ReadError::line(line, format!("expected a number of elements, found {count}"))
                    })?;
                    elements.push(Element { name: (*name).to_string(), count, properties: Vec::new(), line });
                }
                ["property", rest @ ..] => {
                    let Some(element) = elements.last_mut() else {
                        return Err(ReadError::line(line, "a property before the first element"));
                    };
                    element.properties.push(Property::parse(rest, line)?);
                }
                ["end_header"] => break,
                _ => {
                    let text = quoted(text.as_bytes());
                    return Err(ReadError::line(line, format!("unknown header line {text}")));
                }
            }
        }
        let Some(encoding) = encoding else {
            return Err(ReadError::file("the header has no 'format' line"));
        };
        Ok(Self { encoding, elements, length: at, lines: line })
    }
}

impl Property {
    fn parse(words: &[&str], line: usize) -> Result<Self, ReadError> {
        let scalar = |word: &str| {
            Scalar::named(word).ok_or_else(|| {
                ReadError::line(line, format!("unknown property type {}", quoted(word.as_bytes())))
            })
        };
        match words {
            ["list", count, item, name] => {
                let (count, item) = (scalar(count)?, scalar(item)?);
                if matches!(count, Scalar::F32 | Scalar::F64) {
                    return Err(ReadError::line(line, "a list's length must be of an integer type"));
                }
                Ok(Self { name: (*name).to_string(), kind: Kind::List { count, item } })
            }
            [kind, name] => Ok(Self { name: (*name).to_string(), kind: Kind::Scalar(scalar(kind)?) }),
            _ => Err(ReadError::line(
                line,
                "expected 'property TYPE NAME' or 'property list COUNT_TYPE ITEM_TYPE NAME'",
            )),
        }
    }
}

impl Scalar {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// The part of the file after the header, read number by number.
trait Body: Clone {
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

#[derive(Clone)]
struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    big: bool,
}

impl Binary<'_> {
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
        Ok(match scalar {
            Scalar::F32 => f32::from_le_bytes(self.take()?),
            Scalar::F64 => f64::from_le_bytes(self.take()?) as f32,
            _ => self.integer(scalar)? as f32,
        })
    }

    fn integer(&mut self, scalar: Scalar) -> Result<i64, ReadError> {
        Ok(match scalar {
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => whole(f32::from_le_bytes(self.take()?).into(), self.place())?,
            Scalar::F64 => whole(f64::from_le_bytes(self.take()?), self.place())?,
        })
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
            self.line += usize::from(*byte == b'\n');
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
    fn place(&self) -> Place {
        let blank = self.bytes[self.at..].iter().take_while(|b| b.is_ascii_whitespace());
        Place::Line(self.line + blank.filter(|&&b| b == b'\n').count())
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
        word.parse().map_err(|_| self.not_a_number(word.as_bytes()))
    }

    fn integer(&mut self, _: Scalar) -> Result<i64, ReadError> {
        let word = self.word()?;
        match word.parse() {
            Ok(integer) => Ok(integer),
            Err(_) => {
                whole(word.parse().map_err(|_| self.not_a_number(word.as_bytes()))?, Place::Line(self.line))
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
