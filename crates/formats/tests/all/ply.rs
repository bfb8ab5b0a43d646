//! PLY in all three encodings, and what is said of files that aren't right.

use crate::common;

use straal_formats::mesh::ply;
use straal_formats::{Limits, ReadError};
use straal_scene::Mesh;

fn read(bytes: impl AsRef<[u8]>) -> Result<Mesh, ReadError> {
    ply::read(bytes.as_ref(), &Limits::default())
}

/// The message for a file that must not be read.
fn told(bytes: impl AsRef<[u8]>) -> String {
    read(bytes).unwrap_err().to_string()
}

const SQUARE: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];

#[test]
fn ascii_with_everything_around_it() {
    let text = "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info no scan\r\n\
        element material 1\r\nproperty uchar red\r\nproperty list uchar float knots\r\n\
        element vertex 4\r\nproperty double x\r\nproperty float32 y\r\nproperty float z\r\nproperty uchar red\r\n\
        property float nx\r\nproperty float ny\r\nproperty float nz\r\nproperty float s\r\nproperty float t\r\n\
        element face 2\r\nproperty uchar flags\r\nproperty list uchar int vertex_indices\r\n\
        property list uchar float texcoord\r\nend_header\r\n\
        255 2 0.5 1\r\n\
        0 0 0 9 0 0 1 0 0\r\n1 0 0 9 0 0 1 1 0\r\n1 1 0 9 0 0 1 1 1\r\n0 1e0 -0 9 0 0 1 0 1\r\n\
        7 4 0 1 2 3 0\r\n7 3 0\r\n 2 3 2 0.5 0.5";
    let mesh = read(text).unwrap();
    assert_eq!(mesh.positions, SQUARE);
    assert_eq!(mesh.normals, [[0., 0., 1.]; 4]);
    assert_eq!(mesh.uvs, [[0., 0.], [1., 0.], [1., 1.], [0., 1.]]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
    assert!(mesh.parts.is_empty());
}

/// A square with all sizes of integers, in a binary order given by how numbers are written.
fn binary(format: &str, big: bool) -> Vec<u8> {
    let ordered = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        bytes
    };
    let mut file = format!(
        "ply\nformat {format} 1.0\nelement face 2\nproperty list ushort uint8 vertex_index\nproperty short a\n\
         element vertex 4\nproperty float x\nproperty double y\nproperty int z\nproperty list uint int8 b\n\
         property float u\nproperty float v\nend_header\n"
    )
    .into_bytes();
    for face in [[0, 1, 2].as_slice(), &[0, 2, 3]] {
        file.extend(ordered((face.len() as u16).to_le_bytes().to_vec()));
        file.extend(face);
        file.extend(ordered((-7i16).to_le_bytes().to_vec()));
    }
    for [x, y, z] in SQUARE {
        file.extend(ordered(x.to_le_bytes().to_vec()));
        file.extend(ordered(f64::from(y).to_le_bytes().to_vec()));
        file.extend(ordered((z as i32).to_le_bytes().to_vec()));
        file.extend(ordered(2u32.to_le_bytes().to_vec()));
        file.extend([1, 2]);
        file.extend(ordered(x.to_le_bytes().to_vec()));
        file.extend(ordered(y.to_le_bytes().to_vec()));
    }
    file
}

#[test]
fn both_binary_orders_and_faces_before_vertices() {
    let little = read(binary("binary_little_endian", false)).unwrap();
    assert_eq!(little.positions, SQUARE);
    assert_eq!(little.uvs, [[0., 0.], [1., 0.], [1., 1.], [0., 1.]]);
    assert_eq!(little.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(read(binary("binary_big_endian", true)).unwrap(), little);
}

#[test]
fn strips_and_polygons() {
    let header =
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
    let points = "0 0 0\n2 1 0\n0 2 0\n.5 1 0\n9 9 9\n";
    let strip = format!(
        "{header}element tristrips 1\nproperty list int int vertex_indices\nend_header\n{points}8 0 1 2 3 -1 4 3 2\n"
    );
    assert_eq!(read(strip).unwrap().triangles, [[0, 1, 2], [2, 1, 3], [4, 3, 2]]);
    // An arrowhead: the diagonal from its first corner would lie outside. Points and edges are passed over.
    let concave = format!(
        "{header}element face 3\nproperty list char int vertex_indices\nend_header\n{points}1 0\n2 0 1\n4 0 1 2 3\n"
    );
    assert_eq!(read(concave).unwrap().triangles, [[3, 0, 1], [1, 2, 3]]);
}

#[test]
fn messages_say_what_and_where() {
    assert_eq!(told(""), "not a PLY file: it doesn't begin with 'ply'");
    assert_eq!(told("ply\nformat ascii 1.0\n"), "line 3: the header has no 'end_header'");
    assert_eq!(told("ply\nformat martian 1.0\n"), "line 2: unknown format 'martian'");
    assert_eq!(told("ply\nend_header\n"), "the header has no 'format' line");
    assert_eq!(
        told("ply\nformat ascii 1.0\nelement vertex many\n"),
        "line 3: expected a number of elements, found 'many'"
    );
    assert_eq!(told("ply\nproperty int x\n"), "line 2: a property before the first element");
    assert_eq!(told("ply\nelement face 1\nproperty quad x\n"), "line 3: unknown property type 'quad'");
    assert_eq!(told("ply\nformat ascii 1.0\nend_header\n"), "there is no 'vertex' element");
    let vertices = |count: u64| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\n"
        )
    };
    assert_eq!(
        told(vertices(4_000_000_000) + "end_header\n0 0 0\n"),
        "line 3: the header promises 4000000000 of 'vertex', but only 6 bytes are left for them"
    );
    assert_eq!(told(vertices(1) + "end_header\n0 0 zero\n"), "line 8: expected a number, found 'zero'");
    assert_eq!(told(vertices(2) + "end_header\n0 0 0\n0 000\n"), "line 10: the file ends too early");
    assert_eq!(
        told(vertices(1) + "end_header\n0 0 0\n"),
        "the mesh is empty: it has no face with three corners"
    );
    let faces = vertices(3)
        + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n";
    assert_eq!(told(faces.clone() + "3 0 1 3\n"), "line 13: face 0 names vertex 3, but there are 3");
    assert_eq!(told(faces.clone() + "3 0 1 -1\n"), "line 13: face 0 names vertex -1, but there are 3");
    assert_eq!(told(faces + "3 0 1 1.5\n"), "line 13: expected a whole number, found 1.5");
    assert_eq!(
        told(vertices(1).replace(" z", " w") + "end_header\n0 0 0\n"),
        "line 3: the vertices have no property 'z'"
    );
    let mut cut = binary("binary_little_endian", false);
    cut.pop();
    assert_eq!(told(&cut), format!("byte {}: the file ends too early", cut.len() - 3));
    let limits = Limits { max_vertices: 3, ..Limits::default() };
    let many = ply::read(&binary("binary_big_endian", true), &limits).unwrap_err();
    assert_eq!(many.to_string(), "too many vertices: 4, the limit is 3");
}

#[test]
fn the_scanned_meshes_are_read_whole() {
    let Some(shared) = common::shared() else { return };
    for (name, vertices, triangles) in [
        ("stanford-bunny/bun_zipper.ply", 35_947, 69_451),
        ("stanford-dragon/dragon_vrip_res2_binary.ply", 100_250, 202_520),
        ("stanford-dragon/dragon_vrip_res3_ascii.ply", 22_998, 47_794),
    ] {
        let bytes = std::fs::read(shared.join("scenes/meshes").join(name)).unwrap();
        let mesh = read(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (vertices, triangles), "{name}");
        assert!(mesh.positions.iter().flatten().all(|v| v.abs() < 1.0));
    }
}
