//! Files from strangers, as a person meets them: what is told of a mesh, and which files are read.

use crate::common::{BALL, Folder};
use serde_json::Value as Json;

/// The messages of a report's diagnostics, but for notes.
fn messages(report: &Json) -> Vec<String> {
    let list = report["diagnostics"].as_array().unwrap();
    let told = list.iter().filter(|d| d["severity"] != "note");
    told.map(|d| d["message"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn what_can_never_be_hit_is_counted_and_told() {
    let scene = BALL.replace(
        "world:\n",
        "objects: { far: { sphere: { radius: 1.0e+20 } } }\nworld:\n  - mesh: { file: a.obj }\n  - mesh:\n      \
         positions: [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\n      triangles: [[0, 1, 2]]\n  \
         - instance: { of: far, transform: [scale: 1.0e+20] }\n",
    );
    let folder = Folder::with_scene(&scene);
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv -nan(ind) 0 0\n";
    folder.write("a.obj", &format!("{vertices}f 1 2 3\nf 1 2 4\nf 1 1 2\nf 1 2 5\n"));
    for command in ["check scene.yaml", "render scene.yaml"] {
        let report = folder.json(command);
        assert_eq!(report["dropped_primitives"], 4, "{report:#}");
        assert_eq!(
            messages(&report),
            [
                "in `a.obj`: line 9: 1 face has a vertex that is not finite and is left out",
                "in `a.obj`: 2 triangles without area are left out",
                "in a `mesh`: 1 triangle without area is left out",
                "1 instance of `far` with coordinates beyond single precision is left out",
            ]
        );
        let told = folder.straal(command).err;
        assert!(told.contains("2 triangles without area are left out"), "{told}");
    }
    let lab = folder.straal("accel scene.yaml --size 8x8 --rounds 1 --structures brute");
    assert!(lab.err.contains("warning: in a `mesh`: 1 triangle without area is left out"), "{lab:?}");
    let plain = Folder::with_scene(BALL).json("check scene.yaml");
    assert_eq!((plain["dropped_primitives"].as_u64(), messages(&plain).len()), (Some(0), 0));
    // The teapot's patches meet in points, which is no mistake.
    let teapot = Folder::with_scene(&BALL.replace("world:\n", "world:\n  - bezier: { builtin: teapot }\n"));
    assert_eq!(messages(&teapot.json("check scene.yaml")), [""; 0]);
}

#[test]
fn dissolve_and_colours_are_told() {
    let folder = Folder::new();
    folder.write("a.mtl", "newmtl red # paint\nKd .8 .1 .1\nillum 1\nd 0.3\nTr 0.3\n");
    folder.write(
        "a.obj",
        "mtllib .\\a.mtl\nusemtl red\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n",
    );
    let told = messages(&folder.json("check a.obj")).join("\n");
    for says in ["the colours of its vertices", "contradict each other"] {
        assert!(told.contains(says), "{says}: {told}");
    }
}

#[test]
fn a_root_confines_all_commands_that_read_scenes() {
    let folder = Folder::with_scene(&BALL.replace("world:\n", "world:\n  - mesh: { file: ../secret.ply }\n"));
    std::fs::create_dir(folder.path("in")).unwrap();
    folder.write("in/scene.yaml", &String::from_utf8(folder.read("scene.yaml")).unwrap());
    folder.write(
        "secret.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    );
    for command in
        ["render in/scene.yaml", "check in/scene.yaml", "accel in/scene.yaml --size 8x8 --rounds 1"]
    {
        let run = folder.straal(&format!("{command} --root in"));
        assert_eq!(run.code, Some(2), "{run:?}");
        let root = folder.path("in").canonicalize().unwrap();
        assert!(run.err.contains(&format!("lies outside of `{}`", root.display())), "{run:?}");
        let run = folder.straal(&format!("{command} --root ."));
        assert_eq!(run.code, Some(0), "{run:?}");
        let run = folder.straal(&format!("{command} --root none"));
        assert_eq!(run.code, Some(2), "{run:?}");
        assert!(run.err.contains("files can't be confined to `none`: there is no such folder"), "{run:?}");
    }
}

#[test]
fn what_is_no_picture_is_told_as_what_it_is() {
    let folder = Folder::new();
    folder.write("lfs.exr", "version https://git-lfs.github.com/spec/v1\noid sha256:aa\n");
    folder.write("empty.png", "");
    for command in ["info", "develop -o a.png", "diff lfs.exr"] {
        let run = folder.straal(&format!("{command} lfs.exr"));
        assert!(run.code == Some(2) && run.err.contains("pointer of Git LFS"), "{run:?}");
        let run = folder.straal(&format!("{command} empty.png"));
        assert!(run.code == Some(2) && (run.err.contains("empty") || command.starts_with("diff")), "{run:?}");
    }
    if std::path::Path::new("/proc/kmsg").exists() {
        for command in ["info", "check", "render", "metamer gold"] {
            let run = folder.straal(&format!("{command} /proc/kmsg"));
            assert_eq!(run.code, Some(2), "{run:?}");
        }
    }
}
