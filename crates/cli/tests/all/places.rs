//! Results that would replace what they are made from.

use crate::common::{BALL, Folder};

const OBJ: &str = "mtllib m.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const MTL: &str = "newmtl red\nKd 1 0 0\n";

/// A scene with a mesh and surroundings; a picture of it must not take the place of any of them.
fn folder() -> Folder {
    let folder = Folder::with_scene(
        "camera: { perspective: { eye: [0, 0, 4], look_at: [0, 0, 0], fov: 40 } }\n\
         film: { size: [8, 8] }\n\
         sampler: { spp: 1 }\n\
         world:\n  - mesh: { file: m.obj }\n\
         lights:\n  - environment: { file: sky.pfm }\n",
    );
    folder.write("m.obj", OBJ);
    folder.write("m.mtl", MTL);
    folder.write("bright.yaml", BALL);
    assert_eq!(folder.straal("render bright.yaml -o sky.pfm --size 8x4").code, Some(0));
    folder
}

fn refused(folder: &Folder, words: &str, told: &str) {
    let before = folder.names();
    let run = folder.straal(words);
    assert_eq!(run.code, Some(2), "{words}: {run:?}");
    assert!(run.err.contains(told), "{words}: {run:?}");
    assert_eq!(folder.names(), before);
}

#[test]
fn surroundings_meshes_and_scenes_stay() {
    let folder = folder();
    assert_eq!(folder.straal("render scene.yaml -o a.png").code, Some(0));
    refused(&folder, "render scene.yaml -o sky.pfm", "sky.pfm would replace");
    refused(&folder, "render scene.yaml -o b.png -o ./sky.pfm", "would replace sky.pfm");
    refused(&folder, "accel scene.yaml --html scene.yaml", "scene.yaml would replace");
    refused(&folder, "render scene.yaml -o a.png -o ./a.png", "named twice");
    #[cfg(unix)]
    for (name, target) in
        [("t.png", "m.obj"), ("l.png", "m.mtl"), ("s.png", "scene.yaml"), ("e.exr", "sky.pfm")]
    {
        std::os::unix::fs::symlink(target, folder.path(name)).unwrap();
        let hard = format!("hard-{name}");
        std::fs::hard_link(folder.path(target), folder.path(&hard)).unwrap();
        for name in [name, &hard] {
            refused(&folder, &format!("render scene.yaml -o {name}"), "would replace");
            if name.ends_with(".png") {
                refused(
                    &folder,
                    &format!("render scene.yaml -o x.png --cost-picture {name}"),
                    "would replace",
                );
            }
        }
    }
    #[cfg(unix)]
    refused(&folder, "render m.obj -o l.png", "would replace");
}
