//! Meshes as binary PLY, from which they are read back bit for bit.

use std::io::{self, Write};

use straal_scene::Mesh;
use straal_scene::mesh::{Attribute, Per};

/// The properties of an attribute: the names by which it is read back. None of one that has more numbers than names tell apart.
fn properties(attribute: &Attribute) -> Option<Vec<String>> {
    let Attribute { name, channels, .. } = attribute;
    let named = |names: &[&str]| Some(names.iter().take(*channels).map(|n| (*n).to_owned()).collect());
    if name == "color" && (3..=4).contains(channels) {
        return named(&["red", "green", "blue", "alpha"]);
    }
    if let Some(set) = name.strip_prefix("uv").filter(|set| set.parse::<u8>().is_ok() && *channels == 2) {
        return Some(vec![format!("u{set}"), format!("v{set}")]);
    }
    let is_plain = name.bytes().all(|b| b.is_ascii_graphic()) && !name.is_empty();
    (*channels == 1 && is_plain).then(|| vec![name.clone()])
}

/// A number of an attribute: as a code where it was one.
fn put(out: &mut Vec<u8>, attribute: &Attribute, v: f32) {
    if attribute.is_code {
        out.push((v * 255.0 + 0.5) as u8);
    } else {
        out.extend(v.to_le_bytes());
    }
}

/// Writes a mesh with all that a PLY can say of it: attributes of several numbers that are no colours or texture coordinates are left out, and so
/// are the names of its parts.
pub fn write<W: Write>(mut out: W, mesh: &Mesh) -> io::Result<()> {
    let of = |per: Per| -> Vec<(&Attribute, Vec<String>)> {
        let all = mesh.attributes.iter().filter(move |a| a.per == per);
        all.filter_map(|a| Some((a, properties(a)?))).collect()
    };
    let (of_vertices, of_faces) = (of(Per::Vertex), of(Per::Face));
    let mut head = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
    let mut floats = vec!["x", "y", "z"];
    if !mesh.normals.is_empty() {
        floats.extend(["nx", "ny", "nz"]);
    }
    if !mesh.uvs.is_empty() {
        floats.extend(["u", "v"]);
    }
    if !mesh.tangents.is_empty() {
        floats.extend(["tangent_x", "tangent_y", "tangent_z", "tangent_side"]);
    }
    floats.iter().for_each(|name| head += &format!("property float {name}\n"));
    let declare = |head: &mut String, attributes: &[(&Attribute, Vec<String>)]| {
        for (attribute, names) in attributes {
            let kind = if attribute.is_code { "uchar" } else { "float" };
            names.iter().for_each(|name| *head += &format!("property {kind} {name}\n"));
        }
    };
    declare(&mut head, &of_vertices);
    head += &format!("element face {}\nproperty list uchar int vertex_indices\n", mesh.triangles.len());
    declare(&mut head, &of_faces);
    head += "end_header\n";
    out.write_all(head.as_bytes())?;

    let mut record = Vec::new();
    let attributes = |record: &mut Vec<u8>, all: &[(&Attribute, Vec<String>)], i: usize| {
        for (attribute, names) in all {
            let values = attribute.values.get(i * attribute.channels..).unwrap_or_default();
            (0..names.len()).for_each(|c| put(record, attribute, values.get(c).copied().unwrap_or(0.0)));
        }
    };
    for (i, position) in mesh.positions.iter().enumerate() {
        record.clear();
        let normal = mesh.normals.get(i).map_or(&[][..], |n| n.as_slice());
        let uv = mesh.uvs.get(i).map_or(&[][..], |uv| uv.as_slice());
        let tangent = mesh.tangents.get(i).map_or(&[][..], |t| t.as_slice());
        position.iter().chain(normal).chain(uv).chain(tangent).for_each(|v| record.extend(v.to_le_bytes()));
        attributes(&mut record, &of_vertices, i);
        out.write_all(&record)?;
    }
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        record.clear();
        record.push(3);
        triangle.iter().for_each(|v| record.extend(v.to_le_bytes()));
        attributes(&mut record, &of_faces, i);
        out.write_all(&record)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Limits;
    use crate::mesh::ply;

    #[test]
    fn what_is_written_is_read_back() {
        let attribute = |name: &str, per, channels, is_code, values: &[f32]| Attribute {
            name: name.to_owned(),
            per,
            channels,
            is_code,
            values: values.to_vec(),
        };
        let mesh = Mesh {
            positions: vec![[0.1, -0.0, 1e-30], [1.0, 0.0, 0.0], [0.0, 3e7, 0.5]],
            normals: vec![[0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [0.0, 1.0, 0.0]],
            uvs: vec![[0.25, 0.5], [2.0, -1.0], [0.0, 0.1]],
            tangents: vec![[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, -1.0], [0.5, 0.0, 0.5, 1.0]],
            triangles: vec![[0, 1, 2], [2, 1, 0]],
            attributes: vec![
                attribute(
                    "color",
                    Per::Vertex,
                    4,
                    false,
                    &[0.1, 0.2, 0.3, 1.0, 0.4, 0.5, 0.6, 0.0, 0.7, 0.8, 0.9, 0.5],
                ),
                attribute("uv1", Per::Vertex, 2, false, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]),
                attribute("heat", Per::Vertex, 1, false, &[7.0, 8.0, 9.0]),
                attribute("color", Per::Face, 3, true, &[0.0, 1.0, 128.0 / 255.0, 1.0, 0.0, 1.0]),
            ],
            ..Mesh::default()
        };
        let mut bytes = Vec::new();
        write(&mut bytes, &mesh).unwrap();
        let back = ply::read_with(&bytes, &Limits::default(), &|_| true).unwrap();
        assert_eq!(back.mesh, mesh);
        assert!(back.warnings.is_empty());
        let bare = Mesh {
            normals: Vec::new(),
            uvs: Vec::new(),
            tangents: Vec::new(),
            attributes: Vec::new(),
            ..mesh
        };
        bytes.clear();
        write(&mut bytes, &bare).unwrap();
        assert_eq!(ply::read(&bytes, &Limits::default()).unwrap().mesh, bare);
    }
}
