//! OBJ with MTL, and what is said of files that aren't right.

use crate::common;

use std::fs;

use straal_formats::mesh::mtl::{self, MtlChannel, MtlMap, MtlMaterial, MtlUse};
use straal_formats::mesh::obj::{self, ObjFile};
use straal_formats::{Limits, ReadError};

fn read(text: &str) -> Result<ObjFile, ReadError> {
    obj::read(text.as_bytes(), &Limits::default(), &mut |_| None)
}

/// The message for a file that must not be read.
fn told(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\n";

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
            (
                "red".to_string(),
                MtlMaterial {
                    diffuse: Some([1., 0., 0.]),
                    maps: [(MtlUse::Diffuse, MtlMap { file: "red.png".to_owned(), ..MtlMap::default() })]
                        .into(),
                    ..MtlMaterial::default()
                }
            ),
            ("glass".to_string(), MtlMaterial { ior: Some(1.5), ..MtlMaterial::default() }),
        ]
    );
    assert_eq!(
        file.warnings,
        [
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
        d -halo 0.25\nillum 7\nPr .3\nPm 1\nPs .25\nPc .5\nPcr .75\naniso .125\nnewmtl late\nd 0.75\nTr 0.5\nKd spectral paint.rfl\nKd2 1\n";
    let file = mtl::read(text.as_bytes(), &Limits::default()).unwrap();
    let all = MtlMaterial {
        diffuse: Some([0.1, 0.2, 0.3]),
        specular: Some([0.5; 3]),
        emission: Some([4., 5., 6.]),
        transmission: Some([0.7, 0.8, 0.9]),
        shininess: Some(96.5),
        ior: Some(1.45),
        dissolve: Some(0.25),
        transparency: None,
        illumination: Some(7),
        roughness: Some(0.3),
        metallic: Some(1.0),
        sheen: Some(0.25),
        clearcoat: Some(0.5),
        clearcoat_roughness: Some(0.75),
        anisotropy: Some(0.125),
        maps: [].into(),
    };
    let late = MtlMaterial { dissolve: Some(0.75), transparency: Some(0.5), ..MtlMaterial::default() };
    assert_eq!(file.materials, [("all".to_string(), all), ("late".to_string(), late)]);
    assert_eq!(
        file.warnings,
        [
            "line 21: 'Kd spectral' is not supported and has no effect",
            "line 22: 'Kd2' is not known and has no effect ('late')"
        ]
    );
}

#[test]
fn messages_say_what_and_where() {
    assert_eq!(told(""), "the mesh is empty: it has no face with three corners");
    assert_eq!(told("v 0 0\n"), "line 1: 'v' needs 3 numbers");
    assert_eq!(told("\n# points\nv 0 0 0\nv 0 zero 0\n"), "line 4: expected a number, found 'zero'");
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
    assert_eq!(
        told(&format!("{SQUARE}f 1/1/1/1 2 3\n")),
        "line 5: too many indices for a corner, found '1/1/1/1'"
    );
    let library =
        obj::read(b"\nmtllib a.mtl\n", &Limits::default(), &mut |_| Some(b"newmtl a\nKd x".to_vec()));
    assert_eq!(
        library.unwrap_err().to_string(),
        "line 2: in the material library 'a.mtl', line 2: expected a number, found 'x'"
    );
}

#[test]
fn lines_end_in_any_of_three_ways() {
    let text = format!("# two\n{SQUARE}vn 0 0 1\nusemtl red\nf 1 2 \\\n3 4\nf 1 2 x\n");
    let whole = text.replace("f 1 2 x\n", "");
    let want = read(&whole).unwrap();
    for end in ["\r", "\r\n"] {
        assert_eq!(read(&whole.replace('\n', end)).unwrap().mesh, want.mesh, "{end:?}");
    }
    for end in ["\n", "\r", "\r\n"] {
        let told = told(&text.replace('\n', end));
        assert!(told.starts_with("line 10: expected a corner"), "{end:?}: {told}");
    }
    let paints =
        mtl::read(b"\xef\xbb\xbfnewmtl red\rKd 1 0 0\r\rnewmtl blue\r\nKd 0 0 1", &Limits::default())
            .unwrap();
    let names: Vec<&str> = paints.materials.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!((names, paints.warnings), (vec!["red", "blue"], vec![]));
    assert_eq!(paints.materials[1].1.diffuse, Some([0., 0., 1.]));
}

#[test]
fn numbers_that_are_none_are_read_and_told() {
    for nan in ["nan", "-nan(ind)", "1.#IND00", "-1.#INF00", "1.#INF", "Infinity"] {
        let file = read(&format!("{SQUARE}v 0 {nan} 0 # gone\nf 1 2 3\nf 1 3 5\nf 1 2 5 3\n")).unwrap();
        assert_eq!(file.mesh.triangles, [[0, 1, 2]], "{nan}");
        assert_eq!(
            file.warnings,
            ["2 faces have vertices that are not finite and are left out, the first in line 7"]
        );
        let file =
            read(&format!("{SQUARE}vn 0 1 0\nvn {nan} 0 0\nf 1//1 2//1 3//1\nf 1//1 3//2 4//1\n")).unwrap();
        assert_eq!(file.mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(
            file.mesh.normals,
            [[0., 1., 0.], [0., 1., 0.], [0., 1., 0.], [0., 0., 1.], [0., 0., 1.], [0., 0., 1.]]
        );
        assert_eq!(file.warnings, ["line 8: 1 face has a normal that is not finite and is flat"]);
    }
    assert_eq!(
        told("v 0 0 0\nv 1 0 0\nv nan 0 0\nf 1 2 3\n"),
        "the mesh is empty: 1 face left out, for a vertex is not finite"
    );
    let paints =
        mtl::read(b"newmtl a\nKd 1 0 0\nKd -nan(ind) 0 0\nNi 1.#QNAN0 # x\nd 1.#INF\n", &Limits::default())
            .unwrap();
    let want = MtlMaterial { diffuse: Some([1., 0., 0.]), ..MtlMaterial::default() };
    assert_eq!(paints.materials, [("a".to_owned(), want)]);
    assert_eq!(paints.warnings[0], "line 3: 'Kd' is not a finite number and has no effect");
    assert_eq!(paints.warnings.len(), 3);
}

#[test]
fn indices_of_zero_name_nothing() {
    let file =
        read(&format!("{SQUARE}vt 1 1\nvn 0 1 0\nf 1/1/0 2/1/1 3/1/1\nf 1/0/1 3/1/1 4/1/1\n")).unwrap();
    assert_eq!(file.mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(file.mesh.normals[..3], [[0., 0., 1.]; 3]);
    assert_eq!(file.mesh.normals[3..], [[0., 1., 0.]; 3]);
    assert_eq!(file.mesh.uvs, [[1., 1.], [1., 1.], [1., 1.], [0., 0.], [1., 1.], [1., 1.]]);
    assert_eq!(
        file.warnings,
        [
            "line 7: a corner has the normal 0, where OBJ counts from 1: it has none, the face is flat",
            "line 8: a corner has the texture coordinate 0, where OBJ counts from 1: it has none, it is at 0, 0"
        ]
    );
}

#[test]
fn colours_are_told() {
    for vertices in [
        "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0\n",
        "v 0 0 0 1 1 0 0\nv 1 0 0\nv 1 1 0\n",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\n#MRGB ff00ff00\n",
    ] {
        let [told] = read(&format!("{vertices}f 1 2 3\n")).unwrap().warnings.try_into().unwrap();
        assert!(told.starts_with("the colours of its vertices are left out"), "{told}");
    }
}

#[test]
fn names_are_found_with_comments_quotes_and_other_slashes() {
    let material = |usemtl: &str, newmtl: &str| {
        let text = format!("mtllib a.mtl\n{SQUARE}usemtl {usemtl}\nf 1 2 3\n");
        let library = format!("newmtl {newmtl}\nKd 1 0 0\n");
        let file = obj::read(text.as_bytes(), &Limits::default(), &mut |name| {
            (name == "a.mtl").then(|| library.clone().into_bytes())
        })
        .unwrap();
        let named = file.mesh.parts[0].material.clone().unwrap();
        let is_there = file.materials.iter().any(|(name, _)| *name == named);
        (named, is_there, file.warnings)
    };
    for (usemtl, newmtl, want) in [
        ("red # paint", "red", "red"),
        ("red", "red # paint", "red"),
        ("\"red\"", "red", "red"),
        ("'my red'", "\"my red\" # x", "my red"),
        ("Material #25", "Material #25", "Material"),
        ("a#1", "a#1", "a#1"),
    ] {
        assert_eq!(material(usemtl, newmtl), (want.to_owned(), true, vec![]), "{usemtl} {newmtl}");
    }
    // Names that only their hashes tell apart keep them.
    let text = format!("mtllib a.mtl\n{SQUARE}usemtl Material #2\nf 1 2 3\n");
    let file = obj::read(text.as_bytes(), &Limits::default(), &mut |_| {
        Some(b"newmtl Material #1\nKd 1 0 0\nnewmtl Material #2\nKd 0 1 0\n".to_vec())
    })
    .unwrap();
    assert_eq!(file.mesh.parts[0].material.as_deref(), Some("Material #2"));
    assert_eq!(file.materials[1].0, "Material #2");
    for (usemtl, newmtl) in [("mats\\red", "mats/red"), ("RED", "Red")] {
        let (name, is_there, warnings) = material(usemtl, newmtl);
        assert!(is_there && name == newmtl, "{name}");
        assert_eq!(
            warnings,
            [format!(
                "no material library has the material '{}': '{newmtl}' is taken",
                usemtl.escape_debug()
            )]
        );
    }
}

#[test]
fn libraries_are_asked_for_by_every_reading_of_a_line() {
    let asked = |line: &str| {
        let mut asked = Vec::new();
        let text = format!("{line}\n{SQUARE}f 1 2 3\n{line}\n");
        obj::read(text.as_bytes(), &Limits::default(), &mut |name| {
            asked.push(name.to_owned());
            None
        })
        .unwrap();
        asked.join("|")
    };
    assert_eq!(asked("mtllib a.mtl # by hand"), "a.mtl # by hand|a.mtl");
    assert_eq!(asked("mtllib \"a b.mtl\""), "\"a b.mtl\"|a b.mtl|a|b.mtl");
    assert_eq!(asked("mtllib my a.mtl b.mtl"), "my a.mtl b.mtl|my a.mtl|my|a.mtl|b.mtl");
    // Whatever a file asks for, it is bounded.
    let mut count = 0;
    let many: String = (0..100_000).map(|i| format!("mtllib {i}.mtl\nusemtl {i}\n")).collect();
    let file = obj::read(format!("{many}{SQUARE}f 1 2 3\n").as_bytes(), &Limits::default(), &mut |_| {
        count += 1;
        None
    })
    .unwrap();
    assert_eq!(count, 10_000);
    assert!(file.warnings.iter().any(|w| w.contains("no more are looked for")), "{:?}", file.warnings);
}

#[test]
fn what_is_no_such_file_is_not_quoted() {
    for text in [
        "v secret 0 0\n",
        "f secret 1 2\n",
        "secret:x\nvn 0 secret\n",
        "vt secret\n",
        "v 1 2 3# secret\nv secret",
    ] {
        let is_obj = text.contains("1 2 3");
        assert_eq!(told(text).contains("secret"), is_obj, "{text}");
    }
    let told = mtl::read(b"root:secret:1\nKd secret\n", &Limits::default()).unwrap();
    assert_eq!(told.warnings, ["it holds no material: no line begins with 'newmtl'"]);
    let told = mtl::read(b"Kd secret\nnewmtl a\n", &Limits::default()).unwrap();
    assert_eq!(told.warnings.len(), 1);
    assert!(told.warnings[0].starts_with("line 1: what comes before the first 'newmtl'"));
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

#[test]
fn colours_are_read_when_somebody_asks_for_them() {
    let text =
        b"v 0 0 0\nv 1 0 0 1 0.5 0.25\nv 0 1 0 0 0 1\nv 1 1 0 0 1 0\nvt 0 0\nf 3/1 2/1 1/1\nf 2/1 3/1 4/1\n";
    let mesh = obj::read_with(text, &Limits::default(), &|name| name == "color", &mut |_| None).unwrap().mesh;
    let colours = &mesh.attributes[0];
    assert_eq!((colours.name.as_str(), colours.channels, colours.is_code), ("color", 3, true));
    // In the order of the faces' corners; the vertex that has none is white.
    assert_eq!(colours.values, [0.0, 0.0, 1.0, 1.0, 0.5, 0.25, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0]);
    assert!(obj::read(text, &Limits::default(), &mut |_| None).unwrap().mesh.attributes.is_empty());
}

#[test]
fn pictures_of_materials_come_with_their_options() {
    let text = "newmtl a\nmap_Kd -s 2 3 -o .5 my wood.png # oak\nmap_Bump \"bark \\ 1.png\" -bm 0.25\nmap_d -imfchan m -clamp on leaf.png\n\
        map_Ns -mm .25 .5 gloss.png\nmap_ORM -blendu on orm.png\ndisp hills.png\nmap_Kd2 x.png\nmap_Ke -t 1 1 1 -texres 64\nmap_Ka a.png\n\
        map_Ks -boost 3 -cc off -s inf 2 -2 shiny-1.png\n";
    let file = mtl::read(text.as_bytes(), &Limits::default()).unwrap();
    let named = |file: &str| MtlMap { file: file.to_owned(), ..MtlMap::default() };
    let maps = &file.materials[0].1.maps;
    let want = [
        (MtlUse::Diffuse, MtlMap { scale: [2.0, 3.0], offset: [0.5, 0.0], ..named("my wood.png") }),
        (MtlUse::Specular, MtlMap { scale: [1.0, 2.0], ..named("shiny-1.png") }),
        (MtlUse::Shininess, MtlMap { range: [0.25, 0.5], ..named("gloss.png") }),
        (
            MtlUse::Dissolve,
            MtlMap { channel: Some(MtlChannel::Alpha), is_clamped: true, ..named("leaf.png") },
        ),
        (MtlUse::Roughness, MtlMap { channel: Some(MtlChannel::Green), ..named("orm.png") }),
        (MtlUse::Metallic, MtlMap { channel: Some(MtlChannel::Blue), ..named("orm.png") }),
        (MtlUse::Bump, MtlMap { bump: 0.25, ..named("bark \\ 1.png") }),
    ];
    assert_eq!(maps.iter().map(|(of, map)| (*of, map.clone())).collect::<Vec<_>>(), want);
    assert_eq!(
        file.warnings,
        [
            "line 7: pictures for 'disp' are not supported and have no effect ('a')",
            "line 8: pictures for 'map_Kd2' are not supported and have no effect ('a')",
            "line 9: the option -t (turbulence) of 'map_Ke' has no effect ('a')",
            "line 9: the option -texres of 'map_Ke' has no effect ('a')",
            "line 9: 'map_Ke' names no picture",
            "line 11: the option -boost of 'map_Ks' has no effect ('a')",
        ]
    );
}
