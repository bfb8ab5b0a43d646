//! A bare mesh gets a studio, and a scene its forecast.

use std::path::Path;

use straal_formats::studio::{Background, Finish, Side, Studio, Up};
use straal_formats::{Diagnostics, Loaded, Options, load, load_str, yaml};
use straal_math::{Affine, DVec3, ops};
use straal_scene::count::{Space, count};
use straal_scene::decode::Describe;
use straal_scene::desc::{
    Camera, Index, Material, MaterialRef, Node, Shading, Smoothing, Spectrum, Texture, TextureChannel,
    TextureOf, TriangleMesh, Varying,
};
use straal_scene::value::{LinearRgb, Link};

/// The mesh node and what material it is given, and that everything its camera should see is in view.
fn framed(loaded: &Loaded) -> (&TriangleMesh, Option<&MaterialRef>) {
    let (node, around) = match &loaded.scene.world[0] {
        Node::Group(g) => (&g.children[0], g.material.as_ref()),
        node => (node, None),
    };
    let Node::Mesh(node) = node else { panic!("not a mesh: {node:?}") };
    let place = node.surface.transform.affine().unwrap();
    let Camera::Perspective(camera) = &loaded.scene.camera else { panic!("not a perspective") };
    let observer = &camera.observer;
    let to_camera = Affine::look_at(observer.eye, observer.look_at, observer.up).unwrap().inverse().unwrap();
    let (s, c) = ops::sin_cos_degrees(0.5 * camera.fov.unwrap());
    let [width, height] = loaded.scene.film.size.map(f64::from);
    let mesh = &loaded.assets.mesh(node.file.as_ref().unwrap().handle).mesh;
    let mut farthest: f64 = 0.0;
    let mut box_of = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for p in &mesh.positions {
        let p = place.point(DVec3::from_array(p.map(f64::from)));
        assert!(p.y > -1e-6 && p.length() < 2.1, "{p:?} does not stand on the floor");
        let q = to_camera.point(p);
        assert!(q.z < 0.0, "{p:?} is behind the camera");
        for (k, v) in [q.x, q.y, q.z].into_iter().enumerate() {
            box_of[0][k] = if v < box_of[0][k] { v } else { box_of[0][k] };
            box_of[1][k] = if v > box_of[1][k] { v } else { box_of[1][k] };
        }
        for at in [q.x / -q.z / (s / c * width / height), q.y / -q.z / (s / c)] {
            assert!(at.abs() < 0.81, "{p:?} is out of the picture");
            farthest = if at.abs() > farthest { at.abs() } else { farthest };
        }
    }
    // A needle seen from its end is small wherever the camera stands.
    let [across, up, along] = [0, 1, 2].map(|k| box_of[1][k] - box_of[0][k]);
    assert!(farthest > 0.5 || along > 20.0 * (across + up), "the mesh fills only {farthest} of the picture");
    (node, node.surface.material.as_ref().or(around))
}

fn named(name: &str) -> MaterialRef {
    MaterialRef::Named(Link::new(name.to_owned()))
}

fn in_studio(path: &Path, studio: Studio) -> Result<Loaded, Diagnostics> {
    load(path, &Options { studio, ..Options::default() })
}

#[test]
fn a_ply_is_clay_in_a_studio() {
    let loaded = load(Path::new("tests/data/triangle.ply"), &Options::default()).unwrap();
    // Which way is up was guessed, and told.
    let told = loaded.warnings.to_string();
    assert_eq!(
        told,
        "note: `tests/data/triangle.ply`: y is taken to be up, which is a guess\n  = help: `--up z` if it lies on its side\n"
    );
    let (mesh, material) = framed(&loaded);
    assert_eq!(material, Some(&named("clay")));
    assert_eq!(loaded.assets.mesh(mesh.file.as_ref().unwrap().handle).mesh.triangles.len(), 1);
    // The studio is a scene like any other: nothing in it breaks a rule, and its text says all of it.
    let written = yaml::write(&loaded.scene.write());
    let again =
        load_str("written", &written, Path::new(""), &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.scene, loaded.scene);
}

#[test]
fn whatever_its_size_and_place_a_mesh_stands_in_the_studio() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.obj");
    let faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    let quarter =
        [[1.0, 1.0, 1.0], [1.0, 0.0, 1.0], [40.0, 0.01, 0.01], [0.01, 40.0, 0.01], [0.01, 0.02, 40.0]];
    for (shape, (scale, at)) in quarter.iter().flat_map(|q| {
        [(1e-6, 0.0), (1e-30, 0.0), (1.0, 0.0), (1e15, 0.0), (1e30, 0.0), (1.0, 1000.0)].map(|p| (q, p))
    }) {
        let mut text = String::new();
        for i in 0..8 {
            let v = [0, 1, 2].map(|k| at + scale * shape[k] * f64::from(i >> k & 1));
            text += &format!("v {:e} {:e} {:e}\n", v[0], v[1], v[2]);
        }
        std::fs::write(&path, text + faces).unwrap();
        for up in [Some(Up::Y), Some(Up::NegX), None] {
            for view in Side::ALL {
                for size in [None, Some([100, 300]), Some([600, 100])] {
                    let studio = Studio { up, view, size, ..Studio::default() };
                    framed(
                        &in_studio(&path, studio).unwrap_or_else(|e| panic!("{shape:?} {scale} {at}: {e}")),
                    );
                }
            }
        }
    }
}

#[test]
fn stray_points_and_broken_triangles_are_not_framed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stray.obj");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1e6 1e6 1e6\nv nan 0 0\nf 1 2 3\nf 1 2 5\n";
    std::fs::write(&path, text).unwrap();
    let loaded = in_studio(&path, Studio::default()).unwrap();
    let Camera::Perspective(camera) = &loaded.scene.camera else { panic!("not a perspective") };
    assert!(camera.observer.eye.length() < 10.0, "{:?}", camera.observer);
    std::fs::write(&path, "v 1 1 1\nf 1 1 1\n").unwrap();
    let error = in_studio(&path, Studio::default()).unwrap_err().to_string();
    assert!(error.contains("all its points are in one place"), "{error}");
    std::fs::write(&path, "v 1e6 0 0\nv 1000001 0 0\nv 1e6 1 0\nf 1 2 3\n").unwrap();
    let told = in_studio(&path, Studio::default()).unwrap().warnings.to_string();
    assert!(told.contains("warning") && told.contains("single precision"), "{told}");
}

#[test]
fn what_is_asked_of_a_studio_is_in_the_scene() {
    let path = Path::new("tests/data/lamp.obj");
    let loaded = in_studio(path, Studio { finish: Some(Finish::Gold), ..Studio::default() }).unwrap();
    assert_eq!(framed(&loaded).1, Some(&named("gold")), "it takes the place of the file's own");
    let loaded = in_studio(path, Studio { smooth: Some(25.0), ..Studio::default() }).unwrap();
    assert_eq!(
        framed(&loaded).0.shading,
        Shading::Smooth(Smoothing { crease: 25.0, recompute: true, ..Smoothing::default() })
    );
    let loaded = in_studio(path, Studio { background: Background::Nothing, ..Studio::default() }).unwrap();
    assert!(loaded.scene.lights.is_empty() && loaded.scene.materials.get("paper").is_none());
    let paper = Background::Paper(LinearRgb([0.1, 0.2, 0.3]));
    let loaded = in_studio(path, Studio { background: paper, ..Studio::default() }).unwrap();
    let Some(Material::Diffuse(d)) = loaded.scene.materials.get("paper") else { panic!("no paper") };
    assert_eq!(d.reflectance, Spectrum::from(LinearRgb([0.1, 0.2, 0.3])).into());
}

#[test]
fn an_obj_keeps_its_own_materials() {
    let loaded = load(Path::new("tests/data/lamp.obj"), &Options::default()).unwrap();
    // What has none in the file is clay.
    let (node, around) = framed(&loaded);
    assert_eq!((&node.surface.material, around), (&None, Some(&named("clay"))));
    assert!(loaded.warnings.to_string().contains("no texture coordinates"), "{}", loaded.warnings);
    let materials = &loaded.assets.meshes.iter().next().unwrap().materials;
    let glow = Spectrum::from(LinearRgb([3.0, 2.0, 1.0]));
    assert_eq!(materials["glow"].emission, Some(Varying::Constant(glow)));
    assert!(
        matches!(&materials["glass"].material, Material::Dielectric(d) if matches!(d.eta, Varying::Constant(Index::Constant(n)) if n > 1.32))
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
    assert!(says("scene.blend").contains(".blend files are not supported"));
    // Nothing of another file is shown.
    assert_eq!(
        says("tests/data/notes.txt"),
        "error: `tests/data/notes.txt` is no scene: none of a scene's keys, such as `camera:` and `world:`, is in it\n  \
         = help: straal reads scenes in YAML or JSON (.yaml, .json) and meshes (.ply, .obj, .stl)\n"
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
    let f = count(&loaded.scene, &loaded.assets);
    // 32 patches of 4 x 4 squares of two triangles; each patch has 5 x 5 vertices.
    assert_eq!((f.kept.triangles, f.kept.vertices), (32 * 32 + 1, 32 * 25 + 3));
    assert_eq!((f.kept.instances, f.kept.lights, f.kept.lit_triangles), (4, 1, 1));
    assert_eq!(f.visible, 2 * (2 * 1024 + 1) + 1);
    // The world with two rows and a mesh, a pot, and a row of two pots and a ball.
    let of = |[triangles, spheres, instances]: [u64; 3]| Space { triangles, spheres, instances, shapes: 0 };
    assert_eq!(f.spaces, [[1, 0, 2], [1024, 0, 0], [0, 1, 2]].map(of));
}

#[test]
fn instances_of_what_glows_are_kept_once() {
    let text = "
camera: { perspective: { eye: [0, 0, 5], look_at: [0, 0, 0] } }
objects:
  lamp: { bezier: { builtin: teapot, resolution: 4, emission: 1 } }
  pair: { group: { children: [instance: { of: lamp }, instance: { of: lamp }, instance: { of: ball }] } }
  ball: { sphere: {} }
world:
  - instance: { of: pair }
  - instance: { of: pair }
";
    let loaded = load_str("scene.yaml", text, Path::new(""), &Options::default()).unwrap();
    let f = count(&loaded.scene, &loaded.assets);
    assert_eq!((f.kept.triangles, f.kept.lights, f.kept.instances), (1024, 1, 5));
    let of = |[triangles, spheres, instances]: [u64; 3]| Space { triangles, spheres, instances, shapes: 0 };
    assert_eq!(f.spaces, [[0, 0, 2], [1024, 0, 0], [0, 1, 0], [0, 0, 3]].map(of));
}

#[test]
fn an_obj_is_painted_with_the_pictures_of_its_materials() {
    let loaded = load(Path::new("tests/data/painted.obj"), &Options::default()).unwrap();
    let told = loaded.warnings.to_string();
    assert!(told.contains("the picture 'gone.png' has no effect ('a'): there is no such file"), "{told}");
    assert!(told.contains("not a picture") && told.contains("painted.obj' has no effect ('b')"), "{told}");
    let materials = &loaded.assets.meshes.iter().next().unwrap().materials;
    let file_of = |texture: &TextureOf| match texture {
        TextureOf::Inline(Texture::Image(i)) => i.file.clone(),
        other => panic!("{other:?}"),
    };
    // A path of Windows, in another case; a picture that two materials share is one.
    let Material::Mask(mask) = &materials["a"].material else { panic!("{:?}", materials["a"]) };
    let Varying::Texture(opacity) = &mask.opacity else { panic!("{mask:?}") };
    let TextureOf::Inline(Texture::Image(image)) = &**opacity else { panic!("{opacity:?}") };
    assert_eq!(image.channel, TextureChannel::Alpha, "what is cut out is told by alpha");
    let MaterialRef::Inline(below) = &*mask.material else { panic!("{mask:?}") };
    let Material::Diffuse(a) = &**below else { panic!("{below:?}") };
    let Varying::Texture(colour) = &a.reflectance else { panic!("{a:?}") };
    let TextureOf::Inline(Texture::Scale(scaled)) = &**colour else { panic!("{colour:?}") };
    let Varying::Texture(painted) = &scaled.of else { panic!("{scaled:?}") };
    let Material::OpenPbr(b) = &materials["b"].material else { panic!("{:?}", materials["b"]) };
    let Varying::Texture(rough) = &b.specular_roughness else { panic!("{b:?}") };
    assert_eq!(file_of(painted).handle, file_of(rough).handle);
    assert_eq!(loaded.assets.bitmap(file_of(painted).handle).texels.width(), 16);
    assert!(b.relief.bump.as_ref().is_some_and(|bump| (bump.height - 0.01).abs() < 1e-6), "{b:?}");
    assert_eq!(loaded.assets.bitmaps.iter().count(), 2);
    assert!(loaded.files.iter().any(|f| f.ends_with("steps.png")), "{:?}", loaded.files);
    // Where a node has a material of its own, none of them is read.
    const CAMERA: &str = "camera: {perspective: {eye: [0, 0, 5], look_at: [0, 0, 0]}}\n";
    let scene = format!(
        "{CAMERA}world: [mesh: {{file: painted.obj, material: {{diffuse: {{reflectance: 0.5}}}}}}]\n"
    );
    let plain = load_str("scene.yaml", &scene, Path::new("tests/data"), &Options::default()).unwrap();
    assert_eq!(plain.assets.bitmaps.iter().count(), 0);
    // Beside pictures of the scene's own, each finds its own.
    let scene = format!(
        "{CAMERA}textures: {{own: {{image: {{file: ../../../../tests/pictures/steps.tga}}}}}}\n\
         world: [mesh: {{file: painted.obj}}, sphere: {{material: {{diffuse: {{reflectance: {{texture: own}}}}}}}}]\n"
    );
    let both = load_str("scene.yaml", &scene, Path::new("tests/data"), &Options::default()).unwrap();
    assert_eq!(both.assets.bitmaps.iter().count(), 3);
}

#[test]
fn texture_coordinates_that_a_mesh_lacks_are_told() {
    const START: &str = "camera: {perspective: {eye: [0, 0, 5], look_at: [0, 0, 0]}}\n\
        textures: {a: {checker: {mapping: {attribute: {name: uv1}}}}}\n\
        materials: {b: {diffuse: {reflectance: {texture: a}}}}\n";
    let says = |world: &str| {
        let scene = format!("{START}world: [{world}]\n");
        load_str("scene.yaml", &scene, Path::new("tests/data"), &Options::default())
            .map(|_| ())
            .map_err(|d| d.to_string())
    };
    let mesh = |file: &str| format!("mesh: {{file: {file}, material: {{mask: {{material: b}}}}}}");
    assert_eq!(says(&mesh("two-sets.ply")), Ok(()));
    let none = says("sphere: {material: b, emission: 1}").unwrap_err();
    assert!(none.contains("no mesh has the texture coordinates `uv1`"), "{none}");
    let one = says(&format!("{}, {}", mesh("two-sets.ply"), mesh("triangle.ply"))).unwrap_err();
    assert!(one.contains("`triangle.ply` hasn't the texture coordinates `uv1`"), "{one}");
}
