//! A bare mesh gets a studio, and a scene its forecast.

use std::path::Path;

use straal_formats::{Loaded, Options, load, load_str};
use straal_math::{Affine, DVec3};
use straal_scene::decode::Describe;
use straal_scene::desc::{Camera, Index, Material, MaterialRef, Node};
use straal_scene::forecast;
use straal_scene::value::Color;

/// The mesh node, and that everything its camera should see is in view.
fn framed(loaded: &Loaded) -> &Node {
    let Camera::Perspective(camera) = &loaded.scene.camera else { panic!("not a perspective") };
    let observer = &camera.observer;
    let to_camera = Affine::look_at(observer.eye, observer.look_at, observer.up).unwrap().inverse().unwrap();
    let tan = 0.267_949_192_431;
    let [width, height] = loaded.scene.film.size.map(f64::from);
    let mesh = &loaded.assets.meshes.values().next().unwrap().mesh;
    let mut farthest: f64 = 0.0;
    for p in &mesh.positions {
        let q = to_camera.point(DVec3::from_array(p.map(f64::from)));
        assert!(q.z < 0.0, "{p:?} is behind the camera");
        for at in [q.x / -q.z / (tan * width / height), q.y / -q.z / tan] {
            assert!(at.abs() < 1.0, "{p:?} is out of the picture");
            farthest = if at.abs() > farthest { at.abs() } else { farthest };
        }
    }
    assert!(farthest > 0.4, "the mesh fills only {farthest} of the picture");
    loaded.scene.world.iter().find(|n| matches!(n, Node::Mesh(_))).unwrap()
}

#[test]
fn a_ply_is_clay_in_a_studio() {
    let loaded = load(Path::new("tests/data/triangle.ply"), &Options::default()).unwrap();
    assert!(loaded.warnings.list.is_empty());
    let node = framed(&loaded);
    assert_eq!(node.material(), Some(&MaterialRef::Named("clay".to_owned().into())));
    let Node::Mesh(mesh) = node else { unreachable!() };
    assert_eq!(loaded.assets.mesh(mesh.file.as_ref().unwrap()).unwrap().mesh.triangles.len(), 1);
    // The studio is a scene like any other: nothing in it breaks a rule.
    let written = loaded.scene.write().to_string();
    let again =
        load_str("written", &written, Path::new(""), &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.scene, loaded.scene);
}

#[test]
fn an_obj_keeps_its_own_materials() {
    let loaded = load(Path::new("tests/data/lamp.obj"), &Options::default()).unwrap();
    assert_eq!(framed(&loaded).material(), None);
    assert!(loaded.warnings.to_string().contains("map_Kd"), "{}", loaded.warnings);
    let materials = &loaded.assets.meshes.values().next().unwrap().materials;
    assert_eq!(materials["glow"].emission, Some(Color([3.0, 2.0, 1.0])));
    assert!(
        matches!(&materials["glass"].material, Material::Dielectric(d) if matches!(d.eta, Index::Constant(n) if n > 1.32))
    );
}

#[test]
fn what_is_no_scene_is_refused() {
    let says = |path: &str| load(Path::new(path), &Options::default()).map(|_| ()).unwrap_err().to_string();
    assert_eq!(
        says("tests/data/trangle.ply"),
        "error: cannot read `tests/data/trangle.ply`: there is no such file\n  = help: did you mean `triangle.ply`?\n"
    );
    assert!(says("tests/data/empty.ply").contains("empty"));
    assert!(says("tests/data").contains("it is a folder"));
    assert!(says("scene.pbrt").contains(".pbrt files are not supported"));
    // Nothing of another file is shown.
    assert_eq!(
        says("tests/data/notes.txt"),
        "error: `tests/data/notes.txt` is no scene: none of a scene's keys, such as `camera:` and `world:`, is in it\n  \
         = help: straal reads scenes in YAML or JSON (.yaml, .json) and meshes (.ply, .obj)\n"
    );
}

#[test]
fn bytes_that_are_no_text_are_placed() {
    let bytes = b"camera:\n  per\xffspective:";
    let complaints =
        straal_formats::load_bytes("scene.yaml", bytes, Path::new(""), &Options::default()).unwrap_err();
    let text = complaints.to_string();
    assert!(
        text.starts_with("scene.yaml:2:6: error: this is not a text: the file must be UTF-8\n"),
        "{text}"
    );
}

#[test]
fn the_hash_is_of_what_is_said() {
    let hash = |text: &str| {
        load_str("scene.yaml", text, Path::new("tests/data"), &Options::default())
            .unwrap_or_else(|e| panic!("{e}"))
            .hash
    };
    let camera = "camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }\n";
    let plain = hash(&format!("{camera}world: [sphere: {{ emission: 1 }}]"));
    let chatty =
        hash(&format!("# a comment\nworld:\n  - sphere: {{ emission: [1, 1, 1], radius: 1.0 }}\n{camera}"));
    assert_eq!(plain, chatty);
    let other = hash(&format!("{camera}world: [sphere: {{ emission: 2 }}]"));
    assert_ne!(plain, other);
    let mesh = |file: &str| hash(&format!("{camera}world: [mesh: {{ file: {file}, emission: 1 }}]"));
    assert_ne!(mesh("triangle.ply"), mesh("lamp.obj"));
}

#[test]
fn instances_are_counted_each_time_and_kept_once() {
    let text = "
camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }
film: { size: [100, 50] }
objects:
  pot: { bezier: { builtin: teapot, resolution: 4 } }
  row: { group: { children: [instance: { of: pot }, instance: { of: pot }, sphere: {}] } }
world:
  - instance: { of: row }
  - instance: { of: row }
  - mesh: { file: triangle.ply, emission: 1 }
";
    let loaded = load_str("scene.yaml", text, Path::new("tests/data"), &Options::default()).unwrap();
    let f = forecast(&loaded.scene, &loaded.assets);
    // 32 patches of 4 x 4 squares of two triangles; each patch has 5 x 5 vertices.
    assert_eq!((f.triangles, f.vertices), (32 * 32 + 1, 32 * 25 + 3));
    assert_eq!(f.visible, 2 * (2 * 1024 + 1) + 1);
    assert_eq!(f.film_bytes, 100 * 50 * 232);
    assert!(f.total_bytes() > f.mesh_bytes + f.search_bytes);
}
