//! A scene of another format, written in the scene language, gives the same bits.

use crate::common::Folder;

#[test]
fn what_is_converted_gives_the_same_bits() {
    let folder = Folder::new();
    let seed = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/gltf/scene.glb");
    std::fs::copy(seed, folder.path("scene.glb")).unwrap();
    std::fs::create_dir_all(folder.path("deep/er")).unwrap();
    let run = folder.straal("convert scene.glb deep/er/x.yaml");
    assert_eq!(run.code, Some(0), "{run:?}");
    for name in ["images-0.png", "meshes-0-primitives-0-shape-0.ply"] {
        assert!(folder.path("deep/er/x_files").join(name).is_file(), "{name}");
    }
    let film_hash = |scene: &str| {
        let report = folder.json(&format!("render {scene} --size 24x16 --spp 2 -o a.png"));
        report["film_hash"].as_str().unwrap_or_else(|| panic!("{scene}: {report}")).to_owned()
    };
    assert_eq!(film_hash("scene.glb"), film_hash("deep/er/x.yaml"));
}

/// A scene that moves is written with its frames, and `--frame` writes one of them.
#[test]
fn what_moves_is_converted_with_its_frames() {
    let folder = Folder::new();
    folder.write(
        "a.yaml",
        "animation: { frames: 9, fps: 8 }\ncamera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }\n\
         world: [{ box: { transform: [{ translate: { keyframes: { 0: [0, 0, 0], 8: [1, 0, 0] } } }] } }]\n\
         lights: [{ point: { position: [0, 3, 5], intensity: 100 } }]\n",
    );
    assert_eq!(folder.straal("convert a.yaml moving.glb").code, Some(0));
    assert_eq!(folder.straal("convert a.yaml still.glb --frame 8").code, Some(0));
    // Frames have noise of their own unless a seed is said.
    let film_hash = |scene: &str| {
        let report = folder.json(&format!("render {scene} --size 24x16 --spp 2 --seed 1 -o a.png"));
        report["film_hash"].as_str().unwrap_or_else(|| panic!("{scene}: {report}")).to_owned()
    };
    let last = film_hash("moving.glb --frame 8 -D fps=8");
    assert_ne!(film_hash("moving.glb --frame 0"), last);
    assert_eq!(film_hash("still.glb"), last);
}

#[test]
fn what_is_read_is_not_written_over() {
    let folder = Folder::new();
    folder.write(
        "a.yaml",
        "camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }\nworld: [sphere]\n",
    );
    let run = folder.straal("convert a.yaml a.yaml");
    assert_eq!(run.code, Some(2), "{run:?}");
    assert_eq!(folder.straal("convert a.yaml a.png").code, Some(2));
    assert_eq!(folder.straal("convert a.yaml b.yaml").code, Some(0));
    for gltf in ["b.gltf", "b.glb"] {
        assert_eq!(folder.straal(&format!("convert a.yaml {gltf}")).code, Some(0));
        assert_eq!(folder.straal(&format!("check {gltf}")).code, Some(0));
    }
    assert!(folder.path("b.bin").is_file());
}
