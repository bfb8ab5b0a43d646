//! OBJ with MTL, and what is said of files that aren't right.

use crate::common;

use std::fs;

use straal_formats::mesh::mtl::{self, MtlMaterial};
use straal_formats::mesh::obj::{self, ObjFile};
use straal_formats::{Limits, ReadError};

fn read(text: &str) -> Result<ObjFile, ReadError> {
    obj::read(text.as_bytes(), &Limits::default(), &mut |_| None)
}

/// The message for a file that must not be read.
fn told(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0 1.0\nv 1 1 0 .5 .5 .5\nv 0 1 0\n";

#[test]
fn all_forms_of_corners() {
    let plain = read(&format!("{SQUARE}f 1 2 3 4\n")).unwrap();
    assert_eq!(plain.mesh.positions, [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    assert_eq!(plain.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(plain.mesh.normals.is_empty() && plain.mesh.uvs.is_empty() && plain.mesh.parts.is_empty());
    assert!(plain.warnings.is_empty());
    for faces in
        ["f -4 -3 -2 -1", "f 1 2 \\\r\n 3\\\n 4", "f\t1 2 3 4 # a square", "s 1\r\nf 1// 2// 3// 4//"]
    {
        assert_eq!(read(&format!("{SQUARE}{faces}")).unwrap().mesh, plain.mesh, "{faces}");
    }
    // Absolute indices may point ahead.
    assert_eq!(read(&format!("f 1 2 3 4\n{SQUARE}")).unwrap().mesh, plain.mesh);

    let full =
        format!("{SQUARE}vt 0 0\nvt 1 0 0\nvt .5\nvn 0 0 2\nf 1/1/1 2/2/1 3/3/1\nf -4/-3/-1 3/3/1 4/2/1\n");
    let full = read(&full).unwrap().mesh;
    assert_eq!(full.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(full.uvs, [[0., 0.], [1., 0.], [0.5, 0.], [1., 0.]]);
    assert_eq!(full.normals, [[0., 0., 2.]; 4]);
}

#[test]
fn vertices_are_told_apart_by_all_three_indices() {
    let seam = read(&format!("{SQUARE}vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 3/1 4/1\n")).unwrap().mesh;
    assert_eq!(seam.triangles, [[0, 1, 2], [3, 2, 4]]);
    assert_eq!(seam.positions[0], seam.positions[3]);
    // Normals that are numbered but not there.
    let dangling = read(&format!("{SQUARE}f 1//1 2//2 3//3\n")).unwrap();
    assert!(dangling.mesh.normals.is_empty());
    assert_eq!(dangling.warnings, ["the faces name normals, but the file has none"]);
    // A face without normals or coordinates beside one that has them: flat, and at 0, 0.
    let mixed = read(&format!("{SQUARE}vt 1 1\nvn 1 0 0\nf 1/1/1 2/1/1 3/1/1\nf 1 3 4\n")).unwrap().mesh;
    assert_eq!(mixed.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(mixed.normals[2..4], [[1., 0., 0.], [0., 0., 1.]]);
    assert_eq!(mixed.uvs[2..4], [[1., 1.], [0., 0.]]);
}

#[test]
fn groups_and_materials_make_parts() {
    let text = format!(
        "mtllib my paints.mtl\nmtllib a.mtl b.mtl\n{SQUARE}f 1 2 3\nusemtl red\nf 1 2 3 4\ng left  wing\nusemtl red\n\
         usemtl glass \no body\nf 1 3 4\nusemtl none\nl 1 2\np 1\nf 1 2\nusemtl glass\nf 2 3 4\ncurv 0 1 1 2\n"
    );
    let mut asked = Vec::new();
    let file = obj::read(text.as_bytes(), &Limits::default(), &mut |name| {
        asked.push(name.to_string());
        match name {
            "my paints.mtl" => Some(b"newmtl red\nKd 1 0 0\nmap_Kd red.png\n".to_vec()),
            "b.mtl" => Some(b"newmtl glass\r\n\tNi 1.5\r\nnewmtl red\nKd 0 0 0\n".to_vec()),
            _ => None,
        }
    })
    .unwrap();
    assert_eq!(asked, ["my paints.mtl", "a.mtl b.mtl", "a.mtl", "b.mtl"]);
    let parts: Vec<_> = file
        .mesh
        .parts
        .iter()
        .map(|part| (part.name.as_str(), part.material.as_deref(), part.triangles.clone()))
        .collect();
    assert_eq!(parts, [("", None, 0..1), ("", Some("red"), 1..3), ("body", Some("glass"), 3..5)]);
    assert_eq!(
        file.materials,
        [
            ("red".to_string(), MtlMaterial { diffuse: Some([1., 0., 0.]), ..MtlMaterial::default() }),
            ("glass".to_string(), MtlMaterial { ior: Some(1.5), ..MtlMaterial::default() }),
        ]
    );
    assert_eq!(
        file.warnings,
        [
            "my paints.mtl, line 3: texture maps are not supported yet: 'map_Kd' has no effect ('red')",
            "line 2: the material library 'a.mtl' was not found",
            "b.mtl: the material 'red' is there already",
            "line 16: lines have no surface and are left out",
            "line 17: points have no surface and are left out",
            "line 18: a face with fewer than three corners is left out",
            "line 21: 'curv' is not supported and has no effect",
        ]
    );
    let missing = read(&format!("{SQUARE}usemtl red\nf 1 2 3\n")).unwrap();
    assert_eq!(missing.warnings, ["no material library has the material 'red'"]);
}

#[test]
fn materials_keep_what_the_file_says() {
    let text = "# paints\n  newmtl all\nKa 1 1 1\nKd .1 .2 .3\nKs 0.5\nKe 4 5 6\nTf .7 .8 .9\nNs 96.5\nNi 1.45\n\
        d -halo 0.25\nillum 7\nPr .3\nPm 1\nnewmtl late\nd 0.75\nTr 0.5\nKd spectral paint.rfl\nKd2 1\n";
    let file = mtl::read(text.as_bytes(), &Limits::default()).unwrap();
    let all = MtlMaterial {
        diffuse: Some([0.1, 0.2, 0.3]),
        specular: Some([0.5; 3]),
        emission: Some([4., 5., 6.]),
        transmission: Some([0.7, 0.8, 0.9]),
        shininess: Some(96.5),
        ior: Some(1.45),
        opacity: Some(0.25),
        illumination: Some(7),
        roughness: Some(0.3),
        metallic: Some(1.0),
    };
    let late = MtlMaterial { opacity: Some(0.5), ..MtlMaterial::default() };
    assert_eq!(file.materials, [("all".to_string(), all), ("late".to_string(), late)]);
    assert_eq!(
        file.warnings,
        [
            "line 17: 'Kd spectral' is not supported and has no effect",
            "line 18: 'Kd2' is not known and has no effect ('late')"
        ]
    );
}

#[test]
fn messages_say_what_and_where() {
    assert_eq!(told(""), "the mesh is empty: it has no face with three corners");
    assert_eq!(told("v 0 0\n"), "line 1: 'v' needs 3 numbers");
    assert_eq!(told("\n# points\nv 0 zero 0\n"), "line 3: expected a number, found 'zero'");
    assert_eq!(told(&format!("{SQUARE}f 1 2 5\n")), "line 5: a face names vertex 5, but there are 4");
    assert_eq!(told(&format!("{SQUARE}f 1 2 -5\n")), "line 5: a face names vertex -5, but there are 4");
    assert_eq!(
        told(&format!("{SQUARE}vt 0 0\nf 1 2/2 3\n")),
        "line 6: a face names texture coordinate 2, but there are 1"
    );
    assert_eq!(told(&format!("{SQUARE}f 0 1 2\n")), "line 5: index 0 in '0': OBJ counts from 1");
    assert_eq!(
        told(&format!("{SQUARE}f 1 2 x\n")),
        "line 5: expected a corner such as 1, 1/2, 1//3 or 1/2/3, found 'x'"
    );
    assert_eq!(told(&format!("{SQUARE}f 1/1/1/1 2 3\n")), "line 5: too many indices in '1/1/1/1'");
    let library = obj::read(b"\nmtllib a.mtl\n", &Limits::default(), &mut |_| Some(b"Kd 1 1 1".to_vec()));
    assert_eq!(
        library.unwrap_err().to_string(),
        "line 2: in the material library 'a.mtl', line 1: 'Kd' comes before the first 'newmtl'"
    );
}

#[test]
fn files_that_broke_another_reader_are_read_or_refused_with_a_line() {
    let Some(shared) = common::shared() else { return };
    let folder = shared.join("scenes/conformance/tinyobjloader-models");
    let mut read = 0;
    let mut refused = Vec::new();
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "obj") {
            continue;
        }
        let bytes = fs::read(&path).unwrap();
        match obj::read(&bytes, &Limits::default(), &mut |name| fs::read(folder.join(name)).ok()) {
            Ok(_) => read += 1,
            Err(error) => refused.push(format!("{}: {error}", path.file_name().unwrap().display())),
        }
    }
    refused.sort();
    let empty = "the mesh is empty: it has no face with three corners";
    assert_eq!(
        refused,
        [
            format!("invalid-face-definition.obj: {empty}"),
            "invalid-relative-texture-index.obj: line 2: a face names texture coordinate -2, but there are 1"
                .into(),
            "invalid-relative-vertex-index.obj: line 1: a face names vertex -4, but there are 0".into(),
            "issue-140-zero-face-idx.obj: line 16: index 0 in '0/0/0': OBJ counts from 1".into(),
            format!("issue-356-leading-spaces-newmtl.obj: {empty}"),
            format!("line-prim.obj: {empty}"),
            format!("points-prim.obj: {empty}"),
        ]
    );
    assert_eq!(read, 40);
}

#[test]
fn shared_meshes_are_read_whole() {
    let Some(shared) = common::shared() else { return };
    for (name, vertices, triangles) in [
        ("utah-teapot/teapot.obj", 3644, 6320),
        ("spot/spot_triangulated.obj", 3225, 5856),
        ("spot/spot_quadrangulated.obj", 3225, 5856),
    ] {
        let bytes = fs::read(shared.join("scenes/meshes").join(name)).unwrap();
        let file = obj::read(&bytes, &Limits::default(), &mut |_| None).unwrap();
        assert_eq!((file.mesh.positions.len(), file.mesh.triangles.len()), (vertices, triangles), "{name}");
    }
}
