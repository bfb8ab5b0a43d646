//! Mitsuba's own mesh files, `.serialized`: versions 3, 4 and 5.
//!
//! A file is one mesh behind the other, each a header of four bytes and a stream of zlib, and at the end the places where they begin. What
//! a stream promises is believed only as far as its bytes could hold it: deflate makes at most 1032 of one.

use miniz_oxide::inflate::stream::{InflateState, inflate};
use miniz_oxide::{DataFormat, MZFlush};
use straal_scene::Mesh;
use straal_scene::mesh::{Attribute, Per};

use crate::limits::check;
use crate::{Limits, ReadError};

const MAGIC: u16 = 0x041c;
/// What deflate can make of a byte, and a little for small streams.
const MOST_RATIO: u64 = 1040;
/// Bytes of a name.
const MOST_NAME: usize = 1 << 16;

const NORMALS: u32 = 0x1;
const UVS: u32 = 0x2;
const COLOURS: u32 = 0x8;
const FLAT: u32 = 0x10;
const DOUBLE: u32 = 0x2000;
/// Of version 5.
const TANGENTS: u32 = 0x2;
const UVS_5: u32 = 0x4;

/// Reads the mesh of an index, and whether it says that it is flat. `most` is how many bytes of memory may be used.
pub(super) fn read(bytes: &[u8], index: u32, limits: &Limits, most: u64) -> Result<(Mesh, bool), ReadError> {
    let broken = || ReadError::file("it is no mesh of Mitsuba: it doesn't begin as one");
    let (magic, version) = (u16_at(bytes, 0).ok_or_else(broken)?, u16_at(bytes, 2).ok_or_else(broken)?);
    if magic != MAGIC {
        return Err(broken());
    }
    if !(3..=5).contains(&version) {
        return Err(ReadError::file(format!("version {version} of this format isn't known")));
    }
    let stream = stream_of(bytes, version, index)?;
    let mut stream = Stream { rest: stream, state: InflateState::new_boxed(DataFormat::Zlib), most };
    let flags = stream.u32()?;
    match version {
        5 => {
            let length = stream.u32()? as usize;
            stream.skip(length.min(MOST_NAME + 1))?;
            if length > MOST_NAME {
                return Err(ReadError::file("the name of the mesh is too long"));
            }
            packed(&mut stream, flags, limits)
        }
        4 => {
            let mut length = 0;
            while stream.bytes::<1>()? != [0] {
                length += 1;
                if length > MOST_NAME {
                    return Err(ReadError::file("the name of the mesh is too long"));
                }
            }
            plain(&mut stream, flags, limits)
        }
        _ => plain(&mut stream, flags, limits),
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at.checked_add(2)?)?.try_into().ok()?))
}

/// The compressed bytes of a mesh, and all behind them.
fn stream_of(bytes: &[u8], version: u16, index: u32) -> Result<&[u8], ReadError> {
    let start = if index == 0 {
        Some(0)
    } else {
        let number = |from_end: usize, size: usize| {
            let at = bytes.len().checked_sub(from_end)?;
            let mut all = [0; 8];
            all[..size].copy_from_slice(bytes.get(at..at.checked_add(size)?)?);
            usize::try_from(u64::from_le_bytes(all)).ok()
        };
        let count = number(4, 4).unwrap_or(0);
        let index = index as usize;
        if index >= count {
            return Err(ReadError::file(format!("it has {count} meshes: there is none of index {index}")));
        }
        let size = if version >= 4 { 8 } else { 4 };
        (count - index)
            .checked_mul(size)
            .and_then(|n| n.checked_add(4))
            .and_then(|from_end| number(from_end, size))
    };
    let stream = start.and_then(|start| bytes.get(start.checked_add(4)?..));
    stream.ok_or_else(|| ReadError::file("it says that a mesh begins beyond its end"))
}

/// Numbers of a compressed stream.
struct Stream<'a> {
    rest: &'a [u8],
    state: Box<InflateState>,
    most: u64,
}

impl Stream<'_> {
    fn fill(&mut self, mut out: &mut [u8]) -> Result<(), ReadError> {
        while !out.is_empty() {
            let step = inflate(&mut self.state, self.rest, out, MZFlush::None);
            self.rest = &self.rest[step.bytes_consumed..];
            out = &mut out[step.bytes_written..];
            if step.bytes_consumed == 0 && step.bytes_written == 0 {
                let what = if step.status.is_err() && !self.rest.is_empty() {
                    "is damaged"
                } else {
                    "ends too early"
                };
                return Err(ReadError::file(format!("the mesh {what}")));
            }
        }
        Ok(())
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let mut out = [0; N];
        self.fill(&mut out)?;
        Ok(out)
    }

    fn u32(&mut self) -> Result<u32, ReadError> {
        Ok(u32::from_le_bytes(self.bytes()?))
    }

    fn u64(&mut self) -> Result<u64, ReadError> {
        Ok(u64::from_le_bytes(self.bytes()?))
    }

    fn skip(&mut self, mut count: usize) -> Result<(), ReadError> {
        let mut out = [0; 4096];
        while count > 0 {
            let step = count.min(out.len());
            self.fill(&mut out[..step])?;
            count -= step;
        }
        Ok(())
    }

    /// Refuses what can't be in the rest of the stream, or what there is no memory for.
    fn promise(&self, records: u64, bytes: u64) -> Result<(), ReadError> {
        let bytes = records.saturating_mul(bytes);
        if bytes > MOST_RATIO.saturating_mul(self.rest.len() as u64 + 1024) {
            return Err(ReadError::file("the mesh promises more than the file can hold"));
        }
        if bytes > self.most {
            return Err(ReadError::file(format!(
                "the mesh takes {bytes} bytes, and there is memory for {}",
                self.most
            )));
        }
        Ok(())
    }

    /// So many records of numbers, each made of its bytes.
    fn records<const N: usize, T>(
        &mut self,
        count: usize,
        of: impl Fn([u8; N]) -> T,
    ) -> Result<Vec<T>, ReadError> {
        const TOGETHER: usize = 256;
        let mut out = Vec::new();
        let mut buffer = vec![0; N * TOGETHER];
        let mut left = count;
        while left > 0 {
            let step = left.min(TOGETHER);
            let part = &mut buffer[..N * step];
            self.fill(part)?;
            if out.try_reserve(step).is_err() {
                return Err(ReadError::file("there is no memory for the mesh"));
            }
            out.extend(part.as_chunks::<N>().0.iter().map(|bytes| of(*bytes)));
            left -= step;
        }
        Ok(out)
    }

    /// Records of floats.
    fn floats<const N: usize>(&mut self, count: usize, is_double: bool) -> Result<Vec<[f32; N]>, ReadError> {
        let values = if is_double {
            self.records(count * N, |bytes: [u8; 8]| f64::from_le_bytes(bytes) as f32)?
        } else {
            self.records(count * N, f32::from_le_bytes)?
        };
        Ok(values.as_chunks::<N>().0.to_vec())
    }
}

/// Vertices and triangles as many as they may be.
fn counts(stream: &mut Stream<'_>, limits: &Limits) -> Result<[usize; 2], ReadError> {
    let (vertices, triangles) = (stream.u64()?, stream.u64()?);
    check("vertices", vertices, limits.max_vertices)?;
    check("triangles", triangles, limits.max_triangles)?;
    let fits =
        |n: u64| usize::try_from(n).map_err(|_| ReadError::file("the mesh is too large for this machine"));
    Ok([fits(vertices)?, fits(triangles)?])
}

/// Versions 3 and 4: a list for each thing.
fn plain(stream: &mut Stream<'_>, flags: u32, limits: &Limits) -> Result<(Mesh, bool), ReadError> {
    let [vertices, triangles] = counts(stream, limits)?;
    let is_double = flags & DOUBLE != 0;
    stream.promise(vertices as u64, if is_double { 24 } else { 12 })?;
    stream.promise(triangles as u64, 12)?;
    let mut mesh = Mesh { positions: stream.floats(vertices, is_double)?, ..Mesh::default() };
    if flags & NORMALS != 0 {
        mesh.normals = stream.floats(vertices, is_double)?;
    }
    if flags & UVS != 0 {
        mesh.uvs = stream.floats(vertices, is_double)?;
    }
    if flags & COLOURS != 0 {
        let values = stream.floats::<3>(vertices, is_double)?.into_flattened();
        mesh.attributes.push(attribute("vertex_color", 3, values));
    }
    let indices = stream.records(3 * triangles, u32::from_le_bytes)?;
    mesh.triangles = indices.as_chunks::<3>().0.to_vec();
    whole(mesh, flags & FLAT != 0)
}

/// Version 5: packed records.
fn packed(stream: &mut Stream<'_>, flags: u32, limits: &Limits) -> Result<(Mesh, bool), ReadError> {
    let [vertices, triangles] = counts(stream, limits)?;
    let (places, groups) = (stream.u64()?, stream.u64()?);
    stream.promise(vertices as u64, 32)?;
    stream.promise(triangles as u64, 16)?;
    let records: Vec<[f32; 8]> = stream.floats(vertices, false)?;
    let mut mesh =
        Mesh { positions: records.iter().map(|r| [r[0], r[1], r[2]]).collect(), ..Mesh::default() };
    // With tangents the three numbers are a frame in a form of its own; normals are computed then.
    if flags & NORMALS != 0 && flags & TANGENTS == 0 {
        mesh.normals = records.iter().map(|r| [r[3], r[4], r[5]]).collect();
    }
    if flags & UVS_5 != 0 {
        mesh.uvs = records.iter().map(|r| [r[6], r[7]]).collect();
    }
    drop(records);
    let faces = stream.records(triangles, |b: [u8; 16]| {
        [0, 4, 8].map(|at| u32::from_le_bytes([b[at], b[at + 1], b[at + 2], b[at + 3]]))
    })?;
    mesh.triangles = faces;
    for present in [places, groups] {
        if present > 0 {
            stream.skip(vertices.saturating_mul(4))?;
        }
    }
    let attributes = stream.u32()?;
    check("attributes", u64::from(attributes), 64)?;
    for _ in 0..attributes {
        let length = stream.u32()? as usize;
        check("letters of a name", length as u64, MOST_NAME as u64)?;
        let name = stream.records(length, |b: [u8; 1]| b[0])?;
        let name = String::from_utf8_lossy(&name).into_owned();
        stream.skip(1)?;
        let channels = stream.u32()? as usize;
        if !(1..=4).contains(&channels) {
            return Err(ReadError::file(format!(
                "an attribute of the mesh has {channels} numbers: 1 to 4 are known"
            )));
        }
        let count = if name.starts_with("face_") { triangles } else { vertices };
        stream.promise(count as u64, 4 * channels as u64)?;
        let values = stream.records(count * channels, f32::from_le_bytes)?;
        mesh.attributes.push(attribute(&name, channels, values));
    }
    whole(mesh, flags & FLAT != 0)
}

/// An attribute by Mitsuba's name, as textures ask for it here.
fn attribute(name: &str, channels: usize, mut values: Vec<f32>) -> Attribute {
    values.iter_mut().filter(|v| !v.is_finite()).for_each(|v| *v = 0.0);
    let (per, rest) = match name.split_once('_') {
        Some(("face", rest)) => (Per::Face, rest),
        Some(("vertex", rest)) => (Per::Vertex, rest),
        _ => (Per::Vertex, name),
    };
    let is_colour = rest == "color" || rest.ends_with("_color");
    let name = if is_colour { rest.to_owned() } else { format!("{rest}_0") };
    Attribute { name, per, channels, is_code: false, values }
}

fn whole(mesh: Mesh, is_flat: bool) -> Result<(Mesh, bool), ReadError> {
    if mesh.triangles.is_empty() {
        return Err(ReadError::file("the mesh has no triangles"));
    }
    if !mesh.is_whole() {
        return Err(ReadError::file("a triangle names a vertex that isn't there"));
    }
    Ok((mesh, is_flat))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use miniz_oxide::deflate::compress_to_vec_zlib;

    /// A file of meshes, each of a version and what its stream says.
    pub fn file(version: u16, streams: &[Vec<u8>]) -> Vec<u8> {
        let (mut out, mut places) = (Vec::new(), Vec::new());
        for stream in streams {
            places.push(out.len() as u64);
            out.extend(MAGIC.to_le_bytes());
            out.extend(version.to_le_bytes());
            out.extend(compress_to_vec_zlib(stream, 6));
        }
        for place in places {
            match version {
                3 => out.extend((place as u32).to_le_bytes()),
                _ => out.extend(place.to_le_bytes()),
            }
        }
        out.extend((streams.len() as u32).to_le_bytes());
        out
    }

    /// A triangle of version 4, moved.
    pub fn triangle(by: f32) -> Vec<u8> {
        let mut out = (0x1002_u32).to_le_bytes().to_vec();
        out.extend(b"name\0");
        out.extend(3_u64.to_le_bytes());
        out.extend(1_u64.to_le_bytes());
        let floats = [by, 0.0, 0.0, by + 1.0, 0.0, 0.0, by, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
        out.extend(floats.iter().flat_map(|v: &f32| v.to_le_bytes()));
        out.extend([0_u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
        out
    }

    fn get(bytes: &[u8], index: u32) -> Result<(Mesh, bool), String> {
        read(bytes, index, &Limits::default(), u64::MAX).map_err(|e| e.to_string())
    }

    #[test]
    fn meshes_of_one_file_by_their_index() {
        let bytes = file(4, &[triangle(0.0), triangle(5.0)]);
        let (mesh, is_flat) = get(&bytes, 1).unwrap();
        assert_eq!(mesh.positions, [[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
        assert_eq!((mesh.uvs[1], mesh.triangles[0], is_flat), ([1.0, 0.0], [0, 1, 2], false));
        assert_eq!(get(&bytes, 0).unwrap().0.positions[0], [0.0; 3]);
        assert!(get(&bytes, 2).unwrap_err().contains("it has 2 meshes"));
    }

    #[test]
    fn doubles_without_a_name() {
        let mut out = (0x2010_u32).to_le_bytes().to_vec();
        out.extend(3_u64.to_le_bytes());
        out.extend(1_u64.to_le_bytes());
        out.extend([0.0_f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()));
        out.extend([0_u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
        let (mesh, is_flat) = get(&file(3, &[out]), 0).unwrap();
        assert_eq!((mesh.positions[1], is_flat), ([1.0, 0.0, 0.0], true));
    }

    #[test]
    fn packed_records_with_an_attribute() {
        let mut out = (0x1005_u32).to_le_bytes().to_vec();
        out.extend(1_u32.to_le_bytes());
        out.extend(b"m");
        for n in [3_u64, 1, 2, 0] {
            out.extend(n.to_le_bytes());
        }
        for [x, y] in [[0.0_f32, 0.0], [1.0, 0.0], [0.0, 1.0]] {
            out.extend([x, y, 0.0, 0.0, 0.0, 1.0, x, y].iter().flat_map(|v| v.to_le_bytes()));
        }
        out.extend([0_u32, 1, 2, 0].iter().flat_map(|i| i.to_le_bytes()));
        out.extend([0_u32, 1, 0].iter().flat_map(|i| i.to_le_bytes()));
        out.extend(1_u32.to_le_bytes());
        out.extend(12_u32.to_le_bytes());
        out.extend(b"vertex_rough");
        out.push(0);
        out.extend(1_u32.to_le_bytes());
        out.extend([0.1_f32, 0.2, 0.3].iter().flat_map(|v| v.to_le_bytes()));
        let (mesh, _) = get(&file(5, &[out]), 0).unwrap();
        assert_eq!((mesh.normals[2], mesh.uvs[2]), ([0.0, 0.0, 1.0], [0.0, 1.0]));
        assert_eq!((mesh.attributes[0].name.as_str(), mesh.attributes[0].values[1]), ("rough_0", 0.2));
    }

    #[test]
    fn what_is_promised_is_not_believed() {
        for (at, count) in [(9, u64::MAX), (9, 1 << 33), (9, 300_000_000), (17, 300_000_000), (17, u64::MAX)]
        {
            let mut stream = triangle(0.0);
            stream[at..at + 8].copy_from_slice(&count.to_le_bytes());
            assert!(get(&file(4, &[stream]), 0).is_err(), "{at} {count}");
        }
        let mut stream = triangle(0.0);
        let last = stream.len() - 1;
        stream[last] = 9;
        assert!(get(&file(4, &[stream]), 0).unwrap_err().contains("isn't there"));
    }

    /// Cut anywhere and changed anywhere: an error or a mesh, and no panic.
    #[test]
    fn damaged_files_are_refused() {
        let bytes = file(4, &[triangle(0.0), triangle(5.0)]);
        for length in 0..bytes.len() {
            let _ = get(&bytes[..length], 0);
            let _ = get(&bytes[..length], 1);
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 0x41;
            let _ = (get(&changed, 0), get(&changed, 1));
        }
    }
}
