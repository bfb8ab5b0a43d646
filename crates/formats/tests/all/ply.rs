//! PLY in all three encodings, and what is said of files that aren't right.

use crate::common;

use straal_formats::mesh::ply;
use straal_formats::{Limits, ReadError};
use straal_scene::Mesh;
use straal_scene::mesh::Per;

fn read(bytes: impl AsRef<[u8]>) -> Result<Mesh, ReadError> {
    ply::read(bytes.as_ref(), &Limits::default()).map(|file| file.mesh)
}

/// What is told of a file that is read.
fn warned(bytes: impl AsRef<[u8]>) -> Vec<String> {
    ply::read(bytes.as_ref(), &Limits::default()).unwrap().warnings
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
    assert_eq!(
        told("ply\nformat binary_little_endian 1.0\nelement face 1\nproperty quad x\nend_header\n"),
        "line 4: unknown property type 'quad': how many bytes it takes isn't known"
    );
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

/// A square of which lines of the header end in any way.
fn square(end: &str) -> String {
    let lines = [
        "ply",
        "format ascii 1.0",
        "comment a square",
        "element vertex 4",
        "property float x",
        "property float y",
        "property float z",
        "element face 1",
        "property list uchar int vertex_indices",
        "end_header",
        "0 0 0",
        "1 0 0",
        "1 1 0",
        "0 1 0",
        "4 0 1 2 3",
    ];
    lines.map(|line| format!("{line}{end}")).concat()
}

#[test]
fn lines_end_in_any_of_three_ways() {
    let want = read(square("\n")).unwrap();
    assert_eq!(want.positions, SQUARE);
    for end in ["\r", "\r\n", "\n\n", " \r\n"] {
        assert_eq!(read(square(end)).unwrap(), want, "{end:?}");
    }
    let mixed = square("\r").replacen('\r', "\n", 2).replacen('\r', "\r\n", 2);
    assert_eq!(read(mixed).unwrap(), want);
    // Lines are counted all the same.
    assert_eq!(told(square("\r").replace("1 1 0", "1 x 0")), "line 13: expected a number, found 'x'");
    assert_eq!(told(square("\r\n").replace("1 1 0", "1 x 0")), "line 13: expected a number, found 'x'");
    assert_eq!(
        told(square("\r").replace("1 2 3", "1 2 9")),
        "line 15: face 0 names vertex 9, but there are 4"
    );
}

#[test]
fn binary_numbers_may_begin_with_the_byte_of_a_line_feed() {
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty int x\nproperty char y\n\
        property char z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
    let body = [10, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2];
    let file = |header: &str| [header.as_bytes(), &body].concat();
    let want = read(file(header)).unwrap();
    assert_eq!(want.positions, [[10., 0., 0.], [1., 0., 0.], [1., 1., 0.]]);
    assert_eq!(read(file(&header.replace('\n', "\r"))).unwrap(), want);
    assert_eq!(read(file(&header.replace('\n', "\r\n"))).unwrap(), want);
}

#[test]
fn what_stands_before_the_header_is_passed_over() {
    let want = read(square("\n")).unwrap();
    for before in ["\u{feff}", "\n", "\r\n \r\n", "\u{feff}\n\t"] {
        let file = format!("{before}{}", square("\n"));
        assert!(ply::is_ply(file.as_bytes()));
        assert_eq!(read(&file).unwrap(), want, "{before:?}");
    }
    assert_eq!(told("\nply\nformat ascii 1.0\n"), "line 4: the header has no 'end_header'");
    for no in ["plywood", "\nplate", "", "pl"] {
        assert!(!ply::is_ply(no.as_bytes()), "{no}");
    }
    // A comment in another encoding.
    let latin = [b"ply\ncomment caf\xe9\n".as_slice(), &square("\n").as_bytes()[4..]].concat();
    assert_eq!(read(latin).unwrap(), want);
}

#[test]
fn properties_of_any_type_are_passed_over() {
    let want = read(square("\n")).unwrap();
    for kind in ["int64", "uint64", "long", "half", "quad"] {
        let more = format!("property float z\nproperty {kind} id\nproperty list {kind} {kind} ids\n");
        let text = square("\n").replace("property float z\n", &more);
        let text = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"].iter().fold(text, |text, v| {
            text.replace(&format!("{v}\n"), &format!("{v} -7 2 18446744073709551615 1\n"))
        });
        assert_eq!(read(text).unwrap(), want, "{kind}");
    }
    let header = |kind: &str, tail: &str| {
        format!(
            "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty char x\nproperty {kind} id\nproperty char y\n\
             property char z\nelement face 1\nproperty list uint64 int64 vertex_index\n{tail}end_header\n"
        )
    };
    let body = |width: usize| {
        let id = vec![9; width];
        let mut body: Vec<u8> = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]
            .iter()
            .flat_map(|&[x, y, z]| [vec![x], id.clone(), vec![y, z]].concat())
            .collect();
        body.extend([3u64, 0, 1, 2].iter().flat_map(|v| v.to_be_bytes()));
        body
    };
    let file = |kind: &str, width: usize, tail: &str| [header(kind, tail).into_bytes(), body(width)].concat();
    let want = read(file("uchar", 1, "")).unwrap();
    assert_eq!(want.triangles, [[0, 1, 2]]);
    for (kind, width) in [("int64", 8), ("uint64", 8), ("half", 2), ("float128", 16), ("bool", 1)] {
        assert_eq!(read(file(kind, width, "")).unwrap(), want, "{kind}");
    }
    assert!(told(file("long", 8, "")).starts_with("line 5: unknown property type 'long'"));
    // Behind all that is needed nothing has to be known.
    assert_eq!(read(file("uchar", 1, "element more 7\nproperty long a\n")).unwrap(), want);
}

#[test]
fn numbers_that_are_none_are_read_and_told() {
    let square = square("\n");
    for nan in ["nan", "-nan(ind)", "1.#QNAN0", "-1.#IND", "inf", "-1.#INF00"] {
        let file = square
            .replace("\n0 1 0\n4 0 1 2 3", &format!("\n0 {nan} 0\n3 0 1 2"))
            .replace("face 1", "face 2")
            + "3 0 2 3\n";
        assert_eq!(read(&file).unwrap().triangles, [[0, 1, 2]], "{nan}");
        assert_eq!(warned(&file), ["1 face has a vertex that is not finite and is left out"]);
    }
    assert_eq!(
        told(square.replace("1 1 0", "1 1 nan")),
        "the mesh is empty: 1 face left out, for a vertex is not finite"
    );
    let with_normals = square
        .replace(
            "property float z",
            "property float z\nproperty float nx\nproperty float ny\nproperty float nz",
        )
        .replace("0 0 0\n1 0 0\n1 1 0\n0 1 0", "0 0 0 0 1 0\n1 0 0 0 1 0\n1 1 0 0 1 0\n0 1 0 0 -1.#IND 0");
    let mesh = read(&with_normals).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [4, 5, 6]]);
    assert_eq!(mesh.normals[4..], [[0., 0., 1.]; 3]);
    assert_eq!(mesh.positions[4..], [SQUARE[0], SQUARE[2], SQUARE[3]]);
    assert_eq!(warned(&with_normals), ["1 triangle has a normal that is not finite and is flat"]);
}

#[test]
fn colours_are_told() {
    let file = square("\n");
    assert!(warned(&file).is_empty());
    for (names, of) in [(["red", "green", "blue"], "vertices"), (["r", "g", "b"], "vertices")] {
        let more = names.map(|name| format!("property uchar {name}\n")).concat();
        let file = file.replace("property float z\n", &format!("property float z\n{more}"));
        let file = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"]
            .iter()
            .fold(file, |file, v| file.replace(&format!("{v}\n"), &format!("{v} 255 0 9\n")));
        let [told] = warned(file).try_into().unwrap();
        assert!(told.starts_with(&format!("the colours of its {of} are left out")), "{told}");
    }
    let faces = file
        .replace("vertex_indices\n", "vertex_indices\nproperty uchar red\n")
        .replace("4 0 1 2 3", "4 0 1 2 3 255");
    assert!(warned(faces)[0].starts_with("the colours of its faces are left out"));
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

#[test]
fn attributes_are_read_when_somebody_asks_for_them() {
    let bytes = std::fs::read("../../tests/meshes/painted.ply").unwrap();
    let file = ply::read_with(&bytes, &Limits::default(), &|name| name != "rough").unwrap();
    assert!(file.warnings.is_empty(), "{:?}", file.warnings);
    let [colour] = file.mesh.attributes.as_slice() else { panic!("{:?}", file.mesh.attributes) };
    assert_eq!(
        (colour.name.as_str(), colour.per, colour.channels, colour.is_code),
        ("color", Per::Vertex, 3, true)
    );
    assert_eq!(
        colour.values,
        [188.0 / 255.0, 99.0 / 255.0, 1.0].repeat(4).iter().map(|v: &f64| *v as f32).collect::<Vec<_>>()
    );
    let numbers = std::fs::read("../../tests/meshes/numbers.ply").unwrap();
    let faces = ply::read_with(&numbers, &Limits::default(), &|_| true).unwrap().mesh.attributes;
    let [share] = faces.as_slice() else { panic!("{faces:?}") };
    assert_eq!(
        (share.name.as_str(), share.per, share.channels, share.is_code),
        ("share", Per::Face, 1, false)
    );
    assert_eq!(share.values, [0.25, 0.75]);
    let file = ply::read_with(&bytes, &Limits::default(), &|name| name == "rough").unwrap();
    assert_eq!(file.mesh.attributes[0].values, [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(file.warnings.len(), 1);
    // A face of four corners is two triangles, of which each has its number; alpha belongs to the colour.
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float r\nproperty float g\n\
                property float b\nproperty float a\nelement face 1\nproperty float weight\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0 1 2 3 0.5\n1 0 0 1 2 3 0.5\n1 1 0 1 2 nan 0.5\n0 1 0 1 2 3 0.5\n7 4 0 1 2 3\n";
    let mesh = ply::read_with(text.as_bytes(), &Limits::default(), &|_| true).unwrap().mesh;
    assert_eq!(mesh.attributes[0].values[..8], [1.0, 2.0, 3.0, 0.5, 1.0, 2.0, 3.0, 0.5]);
    assert_eq!(mesh.attributes[0].values[10], 0.0);
    assert_eq!((mesh.triangles.len(), mesh.attributes[1].values.as_slice()), (2, [7.0, 7.0].as_slice()));
}

#[test]
fn further_sets_of_texture_coordinates_are_read_where_they_are_wanted() {
    let bytes = std::fs::read("tests/data/two-sets.ply").unwrap();
    let read = |wanted: &str| {
        let file = ply::read_with(&bytes, &Limits::default(), &|name| name == wanted).unwrap();
        (file.mesh, file.warnings)
    };
    let (mesh, warnings) = read("uv1");
    assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let [set] = &mesh.attributes[..] else { panic!("{:?}", mesh.attributes) };
    assert_eq!((set.name.as_str(), set.channels), ("uv1", 2));
    assert_eq!(set.values, [5.0, 6.0, 7.0, 6.0, 5.0, 9.0]);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert!(read("uv2").0.attributes.is_empty());
}

/// Mitsuba's names: three numbers that end in their places are an attribute, and so is one.
#[test]
fn numbers_whose_names_end_in_places_are_an_attribute() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float color_0\nproperty float \
                color_1\nproperty float color_2\nproperty float heat_0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0 1 2 3 7\n1 0 0 4 5 6 8\n1 1 0 0 0 0 9\n3 0 1 2\n";
    let read = |names: &'static [&str]| {
        let wanted = |name: &str| names.contains(&name);
        let mesh = ply::read_with(text.as_bytes(), &Limits::default(), &wanted).unwrap().mesh;
        mesh.attributes.iter().map(|a| (a.name.clone(), a.channels, a.values.clone())).collect::<Vec<_>>()
    };
    let colour = ("color".to_owned(), 3, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.0, 0.0, 0.0]);
    let heat = |name: &str| (name.to_owned(), 1, vec![7.0, 8.0, 9.0]);
    assert_eq!(read(&["color", "heat"]), [colour, heat("heat")]);
    assert_eq!(read(&["heat_0"]), [heat("heat_0")]);
}
