//! What is written is sound, and is read back as what it was.

use std::path::Path;

use serde_json::Value as Json;
use straal_color::spectrum::{Quantity, refraction, uplift::Uplift};
use straal_math::{Affine, DVec3, ops::atan2_d};
use straal_scene::Mesh;
use straal_scene::desc::{
    Camera, Gltf, ImageTexture, Light, Material, MaterialRef, Node, Spectrum, Texture, TextureOf, Varying,
};
use straal_scene::value::LinearRgb;

use super::{Form, Written, write};
use crate::scene::Foreign;
use crate::{Loaded, Options, load, load_foreign_bytes, load_str};

/// Two meshes, of which one is shown twice, a camera, lights, and materials with a texture.
const SCENE: &str = r"
camera: { perspective: { eye: [1, 2, 6], look_at: [0, 0.5, 0], fov: 35, fov_axis: y } }
film: { size: [800, 450] }
materials:
  painted:
    gltf:
      base_color: { texture: { image: { file: p.png, color_space: srgb } } }
      metallic: 0.25
      roughness: { texture: { image: { file: p.png, color_space: raw, channel: green, wrap: [clamp, mirror] } } }
      ior: 1.4
      specular: 0.5
      specular_color: [1, 0.5, 0.25]
      clearcoat: 0.75
      clearcoat_roughness: 0.125
      sheen_color: [0.5, 0.25, 0]
      sheen_roughness: 0.5
      emissive: [1, 0.5, 0]
      emissive_strength: 3
  clear:
    gltf:
      metallic: 0
      roughness: 0
      transmission: 1
      volume: true
      attenuation_color: [0.5, 0.75, 1]
      attenuation_distance: 2
      dispersion: 0.5
      iridescence: 0.5
      iridescence_ior: 1.5
      iridescence_thickness: 300
      anisotropy: 0.25
  leaf:
    gltf:
      base_color: [0.25, 0.5, 0.125]
      alpha: 0.5
      diffuse_transmission: 0.5
      diffuse_transmission_color: [0.5, 1, 0.25]
objects:
  thing:
    mesh:
      positions: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
      triangles: [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
      uvs: [[0, 0], [1, 0], [0, 1], [1, 1]]
      material: painted
world:
  - instance: { of: thing, transform: [{ rotate: { y: 30 } }, { translate: [1, 2, 3] }], name: first }
  - instance: { of: thing, transform: [{ scale: [-1, 2, 1] }] }
  - group:
      name: both
      transform: [{ translate: [0, 0, -2] }]
      children:
        - mesh:
            positions: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
            normals: [[0, 0, 1], [0, 0, 1], [0, 0, 1]]
            triangles: [[0, 1, 2]]
            material: clear
        - mesh:
            positions: [[0, 0, 0], [2, 0, 0], [0, 1, 0]]
            triangles: [[0, 1, 2]]
            material: leaf
lights:
  - point: { position: [1, 5, 2], intensity: [100, 50, 25] }
  - directional: { direction: [1, -2, 0.5], irradiance: [2, 2, 1] }
  - spot: { position: [0, 4, 0], direction: [0, -1, 0], intensity: [8, 4, 2], cutoff: 30, beam: 20, falloff: smooth }
";

/// A PNG of 4 x 2 texels in three colours.
fn picture() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 4, 2);
    encoder.set_color(png::ColorType::Rgb);
    let codes: Vec<u8> = (0..24).map(|i| i * 10).collect();
    encoder.write_header().unwrap().write_image_data(&codes).unwrap();
    bytes
}

fn of_text(text: &str) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("p.png"), picture()).unwrap();
    load_str("a.yaml", text, folder.path(), &Options::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn of_bytes(bytes: Vec<u8>) -> Loaded {
    let path = Path::new("nowhere/a.glb");
    load_foreign_bytes(Foreign::Gltf, path, bytes, &Options::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn said(warnings: &straal_scene::Diagnostics) -> Vec<&str> {
    warnings.list.iter().map(|d| d.message.as_str()).collect()
}

/// The chunks of a .glb, whose lengths are what they are told to be.
fn chunks(glb: &[u8]) -> (Json, &[u8]) {
    let number = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&glb[..4], number(4), number(8)), (b"glTF".as_slice(), 2, glb.len()));
    let text = number(12);
    assert_eq!((&glb[16..20], text % 4), (b"JSON".as_slice(), 0));
    let json = serde_json::from_slice(&glb[20..20 + text]).unwrap();
    let rest = &glb[20 + text..];
    if rest.is_empty() {
        return (json, rest);
    }
    assert_eq!((number(20 + text), &rest[4..8]), (rest.len() - 8, b"BIN\0".as_slice()));
    (json, &rest[8..])
}

fn list<'j>(root: &'j Json, key: &str) -> &'j [Json] {
    let list = root.get(key).map_or(&[][..], |list| list.as_array().unwrap());
    assert!(root.get(key).is_none() || !list.is_empty(), "{key} may not be empty");
    list
}

fn index(at: &Json) -> usize {
    at.as_u64().unwrap_or_else(|| panic!("{at}: an index")) as usize
}

/// Checks all that leads somewhere, and that numbers are where and what they are told to be.
fn sound(root: &Json, buffer: &[u8]) {
    let length = list(root, "buffers").first().map_or(0, |b| index(&b["byteLength"]));
    assert!(length <= buffer.len() && buffer.len() < length + 4);
    let views = list(root, "bufferViews");
    for view in views {
        assert_eq!(index(&view["byteOffset"]) % 4, 0);
        assert!(index(&view["byteOffset"]) + index(&view["byteLength"]) <= length && view["byteLength"] != 0);
    }
    let accessors = list(root, "accessors");
    let numbers = |accessor: &Json| -> Vec<[u8; 4]> {
        let view = &views[index(&accessor["bufferView"])];
        let (start, bytes) = (index(&view["byteOffset"]), index(&view["byteLength"]));
        let channels = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            vector => vector[3..].parse().unwrap(),
        };
        assert_eq!(bytes, 4 * channels * index(&accessor["count"]));
        buffer[start..start + bytes].as_chunks::<4>().0.to_vec()
    };
    for mesh in list(root, "meshes") {
        for primitive in list(mesh, "primitives") {
            let attributes = primitive["attributes"].as_object().unwrap();
            let count = |at: &Json| index(&accessors[index(at)]["count"]);
            let vertices = count(&attributes["POSITION"]);
            assert!(attributes.values().all(|at| count(at) == vertices));
            let corners = numbers(&accessors[index(&primitive["indices"])]);
            assert!(
                corners.len() % 3 == 0
                    && corners.iter().all(|i| (u32::from_le_bytes(*i) as usize) < vertices)
            );
            let positions = &accessors[index(&attributes["POSITION"])];
            let values: Vec<f32> = numbers(positions).into_iter().map(f32::from_le_bytes).collect();
            for axis in 0..3 {
                let all = || values.iter().skip(axis).step_by(3).copied();
                // The text has all digits; what reads it here may be off in the last of them.
                let told = |key: &str| positions[key][axis].as_f64().unwrap() as f32;
                assert_eq!(told("min"), all().fold(f32::INFINITY, |a, b| if b < a { b } else { a }));
                assert_eq!(told("max"), all().fold(-f32::INFINITY, |a, b| if b > a { b } else { a }));
            }
            for normal in attributes
                .get("NORMAL")
                .map_or(Vec::new(), |at| numbers(&accessors[index(at)]))
                .as_chunks::<3>()
                .0
            {
                let length: f32 = normal.iter().map(|v| f32::from_le_bytes(*v)).map(|v| v * v).sum();
                assert!((length - 1.0).abs() < 1e-3, "{length}");
            }
            assert!(index(&primitive["material"]) < list(root, "materials").len());
        }
    }
    let (nodes, mut is_child) = (list(root, "nodes"), vec![false; list(root, "nodes").len()]);
    for node in nodes {
        for (key, of) in [("mesh", "meshes"), ("camera", "cameras")] {
            assert!(node.get(key).is_none_or(|at| index(at) < list(root, of).len()));
        }
        for child in list(node, "children") {
            assert!(!std::mem::replace(&mut is_child[index(child)], true), "a child has one parent");
        }
    }
    for root in list(&root["scenes"][0], "nodes") {
        assert!(!is_child[index(root)]);
    }
    for texture in list(root, "textures") {
        assert!(index(&texture["source"]) < list(root, "images").len());
        assert!(index(&texture["sampler"]) < list(root, "samplers").len());
    }
    for image in list(root, "images") {
        let view = &views[index(&image["bufferView"])];
        assert!(buffer[index(&view["byteOffset"])..].starts_with(b"\x89PNG"));
    }
    // What materials and nodes extend is told.
    let used: Vec<&str> = list(root, "extensionsUsed").iter().map(|v| v.as_str().unwrap()).collect();
    let lists = [list(root, "materials"), nodes].concat();
    for name in lists.iter().filter_map(|m| m.get("extensions")?.as_object()).flat_map(|e| e.keys()) {
        assert!(used.contains(&name.as_str()), "{name}");
    }
}

fn glb(loaded: &Loaded) -> Written {
    let written = write(loaded, Form::Packed).unwrap();
    let (root, buffer) = chunks(&written.bytes);
    sound(&root, buffer);
    written
}

/// A material of a scene, its pictures without the names that differ.
fn material(loaded: &Loaded, name: &str) -> Gltf {
    let Some(Material::Gltf(m)) = loaded.scene.materials.get(name) else { panic!("{name} is there") };
    m.clone()
}

fn image<T>(v: &Varying<T>) -> &ImageTexture {
    let Varying::Texture(texture) = v else { panic!("a texture") };
    let TextureOf::Inline(Texture::Image(image)) = texture.as_ref() else { panic!("a picture") };
    image
}

#[test]
fn what_is_exact_is_read_back_as_it_was() {
    let before = of_text(SCENE);
    let written = glb(&before);
    assert_eq!(said(&written.warnings), [""; 0]);
    let after = of_bytes(written.bytes);

    for name in ["painted", "clear", "leaf"] {
        let (mut a, mut b) = (material(&before, name), material(&after, name));
        if name == "painted" {
            // Of the picture of roughness only green is read.
            let pairs = [
                (image(&a.base_color), image(&b.base_color), 0..4),
                (image(&a.roughness), image(&b.roughness), 1..2),
            ];
            for (a, b, channels) in pairs {
                let codes = |of: &Loaded, image: &ImageTexture| {
                    let texels = &of.assets.bitmap(image.file.handle).texels;
                    let all = (0..texels.height()).flat_map(|y| (0..texels.width()).map(move |x| (x, y)));
                    let codes = all.map(|(x, y)| texels.numbers(x, y)[channels.clone()].to_vec());
                    (codes.collect::<Vec<_>>(), texels.width())
                };
                assert_eq!(codes(&before, a), codes(&after, b));
                assert_eq!((&a.wrap, &a.mapping, &a.filter), (&b.wrap, &b.mapping, &b.filter));
            }
            assert_eq!(image(&b.roughness).channel, straal_scene::desc::TextureChannel::Green);
            for m in [&mut a, &mut b] {
                m.base_color = Varying::Constant(Spectrum::grey(1.0));
                m.roughness = Varying::Constant(1.0);
            }
            // Beside a texture of roughness the picture's blue is full, so that the number stands.
            let Varying::Texture(metallic) = &b.metallic else { panic!("{:?}", b.metallic) };
            let TextureOf::Inline(Texture::Scale(scale)) = metallic.as_ref() else { panic!("{metallic:?}") };
            assert_eq!(scale.by, Varying::Constant(0.25));
            b.metallic = a.metallic.clone();
        }
        assert_eq!(a, b, "{name}");
    }

    let [first, second, group] = &after.scene.world[..] else { panic!("{:?}", after.scene.world) };
    assert_eq!(after.scene.objects.len(), 1, "the mesh is shared");
    for (old, new) in before.scene.world.iter().zip([first, second, group]) {
        let [old, new] = [old, new].map(|node| node.placement().unwrap());
        assert_eq!(old, new);
    }
    assert!(matches!(first, Node::Instance(i) if i.name.as_ref().unwrap().value == "first"));
    let Node::Group(group) = group else { panic!("{group:?}") };
    let meshes: Vec<&Mesh> = group
        .children
        .iter()
        .map(|node| {
            let Node::Mesh(mesh) = node else { panic!("{node:?}") };
            &*after.assets.mesh(mesh.file.as_ref().unwrap().handle).mesh
        })
        .collect();
    assert_eq!(meshes[0].positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!((meshes[0].normals.len(), meshes[1].normals.len()), (3, 0));
    assert_eq!((&meshes[1].triangles, meshes[1].positions[1]), (&vec![[0, 1, 2]], [2.0, 0.0, 0.0]));
    let object = after.scene.objects.iter().next().unwrap().1;
    let Node::Mesh(object) = object else { panic!("{object:?}") };
    let mesh = &after.assets.mesh(object.file.as_ref().unwrap().handle).mesh;
    assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    assert!(
        matches!(&object.surface.material, Some(MaterialRef::Named(link)) if link.name.value == "painted")
    );

    let (Camera::Perspective(a), Camera::Perspective(b)) = (&before.scene.camera, &after.scene.camera) else {
        panic!("{:?}", after.scene.camera)
    };
    assert!((a.fov.unwrap() - b.fov.unwrap()).abs() < 1e-12 && a.fov_axis == b.fov_axis);
    assert_eq!((a.observer.eye, after.scene.film.size), (b.observer.eye, [800, 450]));
    let view = |o: &straal_scene::desc::Observer| (o.look_at - o.eye).try_normalize().unwrap();
    assert!((view(&a.observer) - view(&b.observer)).length() < 1e-12);

    assert_eq!(after.scene.lights.len(), 3);
    for (a, b) in before.scene.lights.iter().zip(&after.scene.lights) {
        let told = |light: &Light| -> (Vec<f64>, DVec3) {
            let (power, numbers, axis) = match light {
                Light::Point(l) => (&l.intensity, vec![l.position], DVec3::ZERO),
                Light::Directional(l) => (&l.irradiance, vec![], l.axis()),
                Light::Spot(l) => {
                    (&l.intensity, vec![l.position, DVec3::new(l.cutoff, l.full_beam(), 0.0)], l.axis())
                }
                other => panic!("{other:?}"),
            };
            let LinearRgb(rgb) = power.rgb().unwrap();
            let numbers = numbers.into_iter().flat_map(DVec3::to_array).chain(rgb).collect();
            (numbers, axis.try_normalize().unwrap_or(DVec3::ZERO))
        };
        let ((a, to), (b, there)) = (told(a), told(b));
        assert!(a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
        assert!((to - there).length() < 1e-12);
    }
}

/// A .glb that straal wrote is read and written again: the same meshes and the same pictures of the same materials.
#[test]
fn what_was_written_once_stays_as_it_is() {
    let once = glb(&of_text(SCENE)).bytes;
    let twice = glb(&of_bytes(once.clone())).bytes;
    let ((a, of_a), (b, of_b)) = (chunks(&once), chunks(&twice));
    for key in ["meshes", "accessors", "bufferViews", "textures", "samplers", "materials", "extensionsUsed"] {
        assert_eq!(a[key], b[key], "{key}");
    }
    assert_eq!(of_a, of_b);
}

#[test]
fn a_gltf_names_its_buffer() {
    let loaded = of_text(SCENE);
    let written = write(&loaded, Form::Beside("a b.bin")).unwrap();
    let root: Json = serde_json::from_slice(&written.bytes).unwrap();
    assert_eq!(root["buffers"][0]["uri"], "a%20b.bin");
    sound(&root, written.buffer.as_ref().unwrap());
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a b.bin"), written.buffer.unwrap()).unwrap();
    std::fs::write(folder.path().join("a.gltf"), written.bytes).unwrap();
    let again = load(&folder.path().join("a.gltf"), &Options::default()).unwrap();
    assert_eq!((again.scene.world.len(), again.scene.lights.len()), (3, 3));
}

fn scene(rest: &str) -> Loaded {
    of_text(&format!("camera: {{ perspective: {{ eye: [0, 0, 9], look_at: [0, 0, 0] }} }}\n{rest}"))
}

/// The volume that a closed mesh has by the divergence theorem: above 0 where its triangles face outwards.
fn volume(mesh: &Mesh) -> f64 {
    let place = |i: u32| DVec3::from_array(mesh.positions[i as usize].map(f64::from));
    mesh.triangles.iter().map(|t| t.map(place)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

#[test]
fn shapes_hold_what_their_formulas_say() {
    use std::f64::consts::PI;
    for (shape, want, tolerance) in [
        ("sphere: { center: [3, 1, 0], radius: 2 }", 32.0 / 3.0 * PI, 0.01),
        ("box: { min: [1, 1, 1], max: [2, 3, 4] }", 6.0, 1e-6),
        ("cylinder: { from: [1, 0, 0], to: [1, 2, 2], radius: 0.5, caps: true }", PI / 2.0_f64.sqrt(), 0.01),
        ("cone: { from: [0, 0, 0], to: [0, 0, 3], radius: 1, caps: true }", PI, 0.01),
        ("torus: { radius: 2, tube_radius: 0.5 }", PI * PI, 0.02),
    ] {
        let after = of_bytes(glb(&scene(&format!("world: [{{ {shape} }}]"))).bytes);
        let mesh = &after.assets.meshes.iter().next().unwrap().mesh;
        assert!((volume(mesh) / want - 1.0).abs() < tolerance, "{shape}: {} for {want}", volume(mesh));
        for t in &mesh.triangles {
            let place = |i: u32| DVec3::from_array(mesh.positions[i as usize].map(f64::from));
            let [a, b, c] = t.map(place);
            let n = (b - a).cross(c - a);
            let shaded = t.map(|i| DVec3::from_array(mesh.normals[i as usize].map(f64::from)));
            assert!(shaded.iter().all(|s| s.dot(n) > 0.0), "{shape}: normals are on the triangles' side");
        }
    }
}

#[test]
fn what_is_not_said_is_told_once_for_each_kind() {
    let loaded = scene(
        "materials: { a: { plastic: { roughness: 0.25 } } }
world:
  - bezier: { builtin: teapot, material: a }
  - disc: { material: { conductor: { metal: gold, roughness: 0.25 } } }
  - disc: { material: { conductor: { metal: gold, roughness: 0.25 } } }
  - rectangle: { material: { diffuse: { reflectance: { texture: { checker: { first: 0.2, second: 0.6 } } } } } }
  - sphere: { material: { dielectric: { eta: BK7, attenuation_color: [0.5, 1, 1], attenuation_distance: 3 } } }
  - rectangle: { emission: [4, 2, 1], material: a }
lights: [{ environment: { radiance: 1 } }, { environment: { radiance: 1 } }]",
    );
    let written = glb(&loaded);
    let told = said(&written.warnings).join("\n");
    for want in [
        "shapes of the kind `bezier`",
        "metals are written by their colour, looked at straight, and so 1 more times",
        "lights of the kind `environment` are left out: glTF has none, and so 1 more times",
        "become one colour",
        "`plastic`",
        "round shapes are written as meshes",
    ] {
        assert_eq!(told.matches(want).count(), 1, "{want}:\n{told}");
    }
    let (root, _) = chunks(&written.bytes);
    let materials = list(&root, "materials");
    let pbr = |i: usize| &materials[i]["pbrMetallicRoughness"];
    assert_eq!(materials.len(), 4, "the gold of two discs is one");
    let near = |v: &Json, want: f64| assert!((v.as_f64().unwrap() - want).abs() < 0.02, "{v} for {want}");
    // What Fresnel's equations have of it straight on, seen under daylight.
    let [eta, k] = refraction::Metal::named("gold").unwrap().index().map(|part| part.bins(Quantity::Index));
    let gold = Uplift::new().rgb_of_reflectance(&refraction::facing(&eta, &k));
    gold.iter()
        .zip(0..)
        .for_each(|(want, i)| near(&pbr(0)["baseColorFactor"][i], if *want < 1.0 { *want } else { 1.0 }));
    assert_eq!(pbr(0)["roughnessFactor"], 0.5, "the root of the facets' alpha");
    near(&pbr(1)["baseColorFactor"][0], 0.4);
    let extended = |i: usize, name: &str, key: &str| materials[i]["extensions"][name][key].clone();
    near(&extended(2, "KHR_materials_ior", "ior"), 1.5168);
    near(&extended(2, "KHR_materials_dispersion", "dispersion"), 20.0 / 64.17);
    assert_eq!(extended(2, "KHR_materials_volume", "attenuationDistance"), 3.0);
    assert_eq!(extended(3, "KHR_materials_emissive_strength", "emissiveStrength"), 4.0);
    assert_eq!(materials[3]["emissiveFactor"], serde_json::json!([1.0, 0.5, 0.25]));
}

#[test]
fn the_view_is_as_high_however_it_is_told() {
    for (camera, size, want) in [
        ("fov: 90, fov_axis: x", [200, 100], 2.0 * atan2_d(0.5, 1.0)),
        ("fov: 90, fov_axis: y, zoom: 2", [200, 100], 2.0 * atan2_d(0.5, 1.0)),
        ("focal_length: 18, sensor: 36", [100, 100], std::f64::consts::FRAC_PI_2),
    ] {
        let [w, h] = size;
        let text = format!(
            "camera: {{ perspective: {{ eye: [0, 0, 9], look_at: [0, 0, 0], {camera} }} }}
film: {{ size: [{w}, {h}] }}\nworld: [box]"
        );
        let written = glb(&of_text(&text));
        let (root, _) = chunks(&written.bytes);
        let got = root["cameras"][0]["perspective"]["yfov"].as_f64().unwrap();
        assert!((got - want).abs() < 1e-12, "{camera}: {got} for {want}");
    }
}

#[test]
fn copies_of_copies_end() {
    // 8^7 copies of a box, each in its place.
    let mut text = "objects:\n  o0: { box: {} }\n".to_owned();
    for i in 0..7 {
        let copy = format!("{{ instance: {{ of: o{i} }} }}");
        text += &format!("  o{}: {{ group: {{ children: [{}] }} }}\n", i + 1, [copy.as_str(); 8].join(", "));
    }
    text += "world: [{ instance: { of: o7 } }]";
    let written = super::write_at_most(&scene(&text), None, Form::Packed, 5000).unwrap();
    assert!(
        said(&written.warnings).iter().any(|w| w.starts_with("nodes beyond the first 5000")),
        "it is told"
    );
}

/// Formulas become meshes whose vertices lie on them and whose triangles face as their normals do.
#[test]
fn shapes_of_formulas_are_meshes_that_face_outwards() {
    for (shape, is_on) in [
        ("plane: { point: [1, 2, 3], normal: [0, 0, 2] }", (|p: DVec3| p.z - 3.0) as fn(DVec3) -> f64),
        ("sphere: { radius: 2, phi: [20, 200], heights: [-1, 1.5] }", |p| p.length() - 2.0),
        ("cylinder: { from: [0, 0, 0], to: [0, 0, 3], radius: 0.5, phi: [-30, 60] }", |p| {
            DVec3::new(p.x, p.y, 0.0).length() - 0.5
        }),
        ("cone: { from: [0, 0, 0], to: [0, 2, 0], radius: 1, phi: [0, 90] }", |p| {
            DVec3::new(p.x, 0.0, p.z).length() - (1.0 - 0.5 * p.y)
        }),
        ("annulus: { radius: 2, inner_radius: 1, phi: [90, 300] }", |p| p.z),
        ("torus: { radius: 2, tube_radius: 0.5, phi: [0, 100], theta: [-90, 90] }", |p| {
            let away = DVec3::new(p.x, 0.0, p.z).length() - 2.0;
            DVec3::new(away, p.y, 0.0).length() - 0.5
        }),
        ("paraboloid: { from: [0, 0, 0], to: [0, 3, 0], radius: 1, begin: 0.25 }", |p| {
            p.y - 3.0 * (p.x * p.x + p.z * p.z)
        }),
        ("hyperboloid: { line: [[1, -1, 1], [1, 1, -1]], phi: [0, 180] }", |p| {
            p.x * p.x + p.z * p.z - 1.0 - p.y * p.y
        }),
        ("capsule: { from: [0, 0, 0], to: [0, 2, 0], radius: 1, end_radius: 0.5 }", |p| {
            // To the cone that touches both balls, or the balls.
            let r = DVec3::new(p.x, 0.0, p.z).length();
            let sin = 0.25;
            let cos = (1.0_f64 - sin * sin).sqrt();
            let along = p.y * cos - r * sin;
            let to_cone = r * cos + p.y * sin - 1.0;
            if along < 0.0 {
                p.length() - 1.0
            } else if along > 2.0 * cos {
                (p - DVec3::new(0.0, 2.0, 0.0)).length() - 0.5
            } else {
                to_cone
            }
        }),
        (
            "curves: { points: [[0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 3, 0]], radii: [0.25], basis: bezier }",
            |p| DVec3::new(p.x, 0.0, p.z).length() - 0.25,
        ),
        ("height_field: { heights: [[0, 1], [0, 1], [0, 1]], size: [2, 4] }", |p| p.y - 0.5 * (p.x + 1.0)),
        (
            "bezier: { points: [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [3, 1, 0], \
             [0, 2, 0], [1, 2, 0], [2, 2, 0], [3, 2, 0], [0, 3, 0], [1, 3, 0], [2, 3, 0], [3, 3, 0]], \
             patches: [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]] }",
            |p| p.z,
        ),
    ] {
        let written = glb(&scene(&format!("world: [{{ {shape} }}]")));
        let back = of_bytes(written.bytes);
        let mesh = &back.assets.meshes.iter().next().unwrap_or_else(|| panic!("{shape} is written")).mesh;
        let at = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        assert!(mesh.triangles.len() > 1 && mesh.normals.len() == mesh.positions.len(), "{shape}");
        for p in &mesh.positions {
            assert!(is_on(at(*p)).abs() < 1e-3, "{shape}: {p:?} is off by {}", is_on(at(*p)));
        }
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| at(mesh.positions[i as usize]));
            let n = t.map(|i| at(mesh.normals[i as usize])).into_iter().fold(DVec3::ZERO, |sum, n| sum + n);
            assert!((b - a).cross(c - a).dot(n) > 0.0, "{shape}: {t:?} faces inwards");
        }
    }
}

/// A scene whose parts move in all ways, read back at frames and between them.
#[test]
fn what_moves_is_read_back_where_it_was() {
    let text = r"
animation: { frames: 13, fps: 24 }
camera: { perspective: { eye: { keyframes: { 0: [0, 0, 9], 12: [3, 0, 8] } }, look_at: [0, 0, 0], fov: 30, fov_axis: y } }
objects:
  thing: { box: { transform: [{ rotate: { x: { keyframes: { 0: 0, 12: 60 } } } }] } }
world:
  - sphere: { transform: [{ translate: { keyframes: { 0: [0, 0, 0], 6: [1, 0, 0], 12: [1, 2, 0] }, interpolation: spline } }] }
  - group:
      transform: [{ scale: [-1, 2, 1] }, { rotate: { y: { keyframes: { 0: 0, 12: 300 } } } }]
      children: [{ box: { transform: [{ translate: { keyframes: { 0: [2, 0, 0], 5: [3, 0, 0] }, interpolation: step } }] } }]
  - instance: { of: thing, transform: [{ translate: [0, 3, 0] }] }
  - sphere: { radius: 0.5, transform: [{ scale: { keyframes: { 0: 1, 12: 0.25 } } }] }
lights:
  - point: { name: moving, position: { keyframes: { 0: [0, 5, 0], 12: [5, 5, 0] } }, intensity: { keyframes: { 0: 10, 12: 20 } } }
";
    let at = |frame: f64| {
        load_str("s.yaml", text, Path::new(""), &Options { frame, ..Options::default() }).unwrap()
    };
    let first = at(0.0);
    let mut frames = super::Frames::of(&first);
    (1..13).for_each(|frame| frames.add(&at(f64::from(frame))));
    let written = frames.write(Form::Packed).unwrap();
    let told = said(&written.warnings);
    assert!(told.len() == 2 && told[1].starts_with("what changes besides places"), "{told:?}");
    let (root, buffer) = chunks(&written.bytes);
    sound(&root, buffer);
    let animation = &list(&root, "animations")[0];
    let ways: Vec<&str> =
        list(animation, "samplers").iter().map(|s| s["interpolation"].as_str().unwrap()).collect();
    assert!(ways.contains(&"STEP") && ways.contains(&"LINEAR"), "{ways:?}");
    let back = |frame: f64| {
        let options = Options { frame, ..Options::default() };
        load_foreign_bytes(Foreign::Gltf, Path::new("s.glb"), written.bytes.clone(), &options).unwrap()
    };
    assert_eq!(back(0.0).scene.animation.frames, 13);
    // All places in the world, in order; what is nowhere is left out.
    fn places(nodes: &[Node], scene: &straal_scene::Scene, above: &Affine, all: &mut Vec<DVec3>) {
        for node in nodes {
            let Some(place) = node.placement().map(|place| place.then(above)) else { continue };
            match node {
                Node::Group(g) => places(&g.children, scene, &place, all),
                Node::Instance(i) => {
                    let object = scene.objects.of(&i.of).unwrap();
                    places(std::slice::from_ref(object), scene, &place, all);
                }
                _ => all.extend([DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| place.point(p))),
            }
        }
    }
    for frame in [0.0, 1.0, 4.0, 5.0, 7.0, 11.0] {
        let (from, to) = (at(frame).scene, back(frame).scene);
        let [mut wanted, mut found] = [Vec::new(), Vec::new()];
        places(&from.world, &from, &Affine::IDENTITY, &mut wanted);
        places(&to.world, &to, &Affine::IDENTITY, &mut found);
        assert_eq!(wanted.len(), found.len());
        for (a, b) in wanted.iter().zip(&found) {
            assert!((*a - *b).length() < 1e-5, "frame {frame}: {wanted:?}\n{found:?}");
        }
        assert!((from.camera.observer().eye - to.camera.observer().eye).length() < 1e-5);
        let [Light::Point(a), Light::Point(b)] = [&from.lights[0], &to.lights[0]] else { panic!() };
        assert_eq!((&a.name, a.name.is_some()), (&b.name, true));
        assert!((a.position - b.position).length() < 1e-5);
    }
}
