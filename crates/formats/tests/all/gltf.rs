//! Small scenes of glTF, made by hand, and what comes of them.

use std::path::Path;

use straal_formats::scene::Foreign;
use straal_formats::{Diagnostics, Loaded, Options, load_foreign_bytes};
use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    Camera, CoatNormal, Gltf, Light, Material, MaterialRef, Node, Texture, TextureOf, Varying,
};
use straal_scene::{Mesh, Severity};

/// Bytes as a data URI.
fn uri(bytes: &[u8]) -> String {
    let digits: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    format!("data:application/octet-stream,{digits}")
}

fn floats(list: &[f32]) -> Vec<u8> {
    list.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// The corners of a triangle in the plane z = 0.
const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// A file of one buffer and a mesh of a triangle, and whatever else is said.
fn file(bytes: &[u8], views: &str, accessors: &str, more: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {}, "uri": "{}"}}],
        "bufferViews": [{views}], "accessors": [{accessors}]{more}}}"#,
        bytes.len(),
        uri(bytes)
    )
}

/// A triangle and whatever else is said.
fn triangle(more: &str) -> String {
    let mesh = r#", "meshes": [{"name": "m", "primitives": [{"attributes": {"POSITION": 0}}]}]"#;
    let view = r#"{"buffer": 0, "byteLength": 36}"#;
    let accessor = r#"{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}"#;
    file(&floats(&CORNERS), view, accessor, &format!("{mesh}{more}"))
}

fn load_with(text: &str, define: &[(&str, &str)]) -> Result<Loaded, Diagnostics> {
    let define = define.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    let options = Options { define, ..Options::default() };
    load_foreign_bytes(Foreign::Gltf, Path::new("nowhere/a.gltf"), text.as_bytes().to_vec(), &options)
}

fn load(text: &str) -> Loaded {
    load_with(text, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// What is complained of, all of it.
fn complaints(text: &str) -> String {
    load_with(text, &[]).err().map_or_else(|| panic!("it is read: {text}"), |d| d.to_string())
}

/// The only mesh of a scene.
fn mesh(loaded: &Loaded) -> &Mesh {
    &loaded.assets.meshes.iter().next().expect("a mesh").mesh
}

/// The material of the first mesh in the world.
fn material(loaded: &Loaded) -> &Gltf {
    let mut found = None;
    loaded.scene.visit(|node| {
        if let Node::Mesh(m) = node
            && let Some(MaterialRef::Named(link)) = &m.surface.material
            && let Some(Material::Gltf(material)) = loaded.scene.materials.of(link)
        {
            found.get_or_insert(material);
        }
    });
    found.expect("a material")
}

/// Where every mesh of the world stands, through groups and instances.
fn places(loaded: &Loaded) -> Vec<Affine> {
    fn walk(loaded: &Loaded, node: &Node, above: &Affine, to: &mut Vec<Affine>) {
        let here = node.placement().unwrap().then(above);
        match node {
            Node::Group(g) => g.children.iter().for_each(|child| walk(loaded, child, &here, to)),
            Node::Instance(i) => walk(loaded, loaded.scene.objects.of(&i.of).unwrap(), &here, to),
            Node::Instances(i) => {
                let object = loaded.scene.objects.of(&i.of).unwrap();
                i.transforms.iter().for_each(|m| walk(loaded, object, &m.0.then(&here), to));
            }
            _ => to.push(here),
        }
    }
    let mut found = Vec::new();
    loaded.scene.world.iter().for_each(|node| walk(loaded, node, &Affine::IDENTITY, &mut found));
    found
}

#[test]
fn a_triangle_is_read_and_shown_in_a_studio() {
    let loaded = load(&triangle(r#", "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0"#));
    assert_eq!(mesh(&loaded).positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh(&loaded).triangles, [[0, 1, 2]]);
    assert!(matches!(loaded.scene.lights[..], [Light::Environment(_)]));
    assert_eq!(loaded.warnings.list.len(), 1, "{}", loaded.warnings);
    assert!(loaded.warnings.to_string().contains("has no lights"));
}

#[test]
fn what_moves_is_blurred_where_a_shutter_is_asked_for() {
    // A triangle that goes along x by 24 in a second, and a camera that stays.
    let mut bytes = floats(&CORNERS);
    bytes.extend(floats(&[0.0, 1.0, 0.0, 0.0, 0.0, 24.0, 0.0, 0.0]));
    let views = r#"{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8},
        {"buffer": 0, "byteOffset": 44, "byteLength": 24}"#;
    let accessors = r#"{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
        {"bufferView": 1, "componentType": 5126, "type": "SCALAR", "count": 2},
        {"bufferView": 2, "componentType": 5126, "type": "VEC3", "count": 2}"#;
    let more = r#", "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 5]}, {"camera": 0}],
        "animations": [{"samplers": [{"input": 1, "output": 2}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}},
                         {"sampler": 0, "target": {"node": 2, "path": "translation"}}]}]"#;
    let text = file(&bytes, views, accessors, more);
    let still = load(&text);
    assert!(still.scene.world[0].motion().is_empty());
    let blurred = load_with(&text, &[("shutter", "0.5")]).unwrap();
    let ends: Vec<f64> = blurred.scene.world[0].motion().iter().map(|p| p.point(DVec3::ZERO).x).collect();
    assert_eq!((ends.len(), ends[0], ends[8]), (9, 0.0, 0.5));
    assert!((ends[4] - 0.25).abs() < 1e-6, "{ends:?}");
    assert!(blurred.scene.camera.observer().moving_to.is_none());
    // A camera that moves is blurred as well.
    let seen = load_with(&text, &[("shutter", "1"), ("camera", "nodes[2]")]).unwrap();
    let keyframes = &seen.scene.camera.observer().moving_to.as_ref().expect("it moves").keyframes;
    assert!((keyframes[7].eye.unwrap().x - 1.0).abs() < 1e-6);
    let wrong = load_with(&text, &[("shutter", "two")]).unwrap_err().to_string();
    assert!(wrong.contains("-D shutter=N"), "{wrong}");
}

#[test]
fn numbers_of_every_encoding_are_read() {
    // Positions as bytes, interleaved with normals and 16-bit texture coordinates; indices of 8 bits; a corner that is told apart.
    let mut bytes = Vec::new();
    for ([x, y], [u, v]) in [([0_i8, 0], [0_u16, 0]), ([127, 0], [65_535, 0]), ([0, -128], [0, 32_768])] {
        bytes.extend([x as u8, y as u8, 0, 0, 0, 0, 127, 0]);
        bytes.extend(u.to_le_bytes().into_iter().chain(v.to_le_bytes()));
    }
    bytes.extend([2, 0, 1, 0]);
    bytes.extend(1_u16.to_le_bytes());
    bytes.extend([0x40, 0x81, 7, 0]);
    let views = r#"{"buffer": 0, "byteLength": 36, "byteStride": 12}, {"buffer": 0, "byteOffset": 36, "byteLength": 3},
        {"buffer": 0, "byteOffset": 40, "byteLength": 2}, {"buffer": 0, "byteOffset": 42, "byteLength": 3}"#;
    let accessors = r#"
        {"bufferView": 0, "componentType": 5120, "normalized": true, "type": "VEC3", "count": 3, "sparse": {"count": 1,
         "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3}}},
        {"bufferView": 0, "byteOffset": 4, "componentType": 5120, "normalized": true, "type": "VEC3", "count": 3},
        {"bufferView": 0, "byteOffset": 8, "componentType": 5123, "normalized": true, "type": "VEC2", "count": 3},
        {"bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": 3}"#;
    let more = r#", "meshes": [{"primitives": [{"indices": 3, "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}}]}],
        "nodes": [{"mesh": 0}]"#;
    let loaded = load(&file(&bytes, views, accessors, more));
    let mesh = mesh(&loaded);
    assert_eq!(mesh.positions, [[0.0, 0.0, 0.0], [64.0 / 127.0, -1.0, 7.0 / 127.0], [0.0, -1.0, 0.0]]);
    assert_eq!(mesh.normals, [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(mesh.uvs, [[0.0, 1.0], [1.0, 1.0], [0.0, 1.0 - 32_768.0 / 65_535.0]]);
    assert_eq!(mesh.triangles, [[2, 0, 1]]);
}

#[test]
fn nodes_stand_where_their_parents_put_them() {
    let nodes = r#", "nodes": [
        {"translation": [1, 0, 0], "children": [1, 2], "name": "above"},
        {"mesh": 0, "scale": [2, 2, -2]},
        {"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
        {"mesh": 0, "scale": [0, 1, 1]}]"#;
    let loaded = load(&triangle(nodes));
    assert_eq!(loaded.assets.meshes.iter().count(), 1, "a mesh that is shown twice is one");
    assert_eq!(loaded.scene.objects.len(), 1);
    let all = places(&loaded);
    assert_eq!(all.len(), 2);
    let x = all.map_points();
    assert_eq!(x, [[3.0, 0.0, 0.0], [1.0, 1.0, 5.0]]);
    assert!(all[0].determinant() < 0.0);
    assert!(loaded.warnings.to_string().contains("nothing of it"), "{}", loaded.warnings);
}

#[test]
fn nodes_move_from_frame_to_frame() {
    let mut bytes = floats(&CORNERS);
    bytes.extend(floats(&[0.0, 1.0, 0.0, 0.0, 0.0, 24.0, 0.0, 0.0]));
    let views = r#"{"buffer": 0, "byteLength": 68}"#;
    let accessors = r#"{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
        {"bufferView": 0, "byteOffset": 36, "componentType": 5126, "type": "SCALAR", "count": 2},
        {"bufferView": 0, "byteOffset": 44, "componentType": 5126, "type": "VEC3", "count": 2}"#;
    let more = r#", "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0, "translation": [7, 7, 7]}],
        "animations": [{"name": "go", "samplers": [{"input": 1, "output": 2}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]"#;
    let text = file(&bytes, views, accessors, more);
    let mut eye = None;
    for (frame, x) in [(0.0, 0.0), (6.0, 6.0), (99.0, 24.0)] {
        let options = Options { frame, ..Options::default() };
        let loaded =
            load_foreign_bytes(Foreign::Gltf, Path::new("a.gltf"), text.clone().into_bytes(), &options)
                .unwrap();
        assert_eq!(places(&loaded).map_points(), [[x + 1.0, 0.0, 0.0]]);
        assert_eq!(loaded.scene.animation.frames, 25);
        let Camera::Perspective(c) = loaded.scene.camera else { panic!() };
        assert_eq!(*eye.get_or_insert(c.observer.eye), c.observer.eye, "the camera stays");
    }
    assert!(load_with(&text, &[("animation", "stop")]).unwrap_err().to_string().contains("it has go"));
}

/// `KHR_animation_pointer`: a colour, a lamp and whether a node is there.
#[test]
fn any_number_moves_that_a_pointer_leads_to() {
    let more = r#", "extensionsUsed": ["KHR_animation_pointer"], "materials": [{"doubleSided": true}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "nodes": [{"mesh": 0}, {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}},
            {"extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 1}]}},
        "animations": [{"samplers": [{"input": 1, "output": 2}, {"input": 1, "output": 1, "interpolation": "STEP"}],
            "channels": [
                {"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer":
                    {"pointer": "/materials/0/pbrMetallicRoughness/baseColorFactor"}}}},
                {"sampler": 1, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer":
                    {"pointer": "/nodes/1/extensions/KHR_node_visibility/visible"}}}},
                {"sampler": 1, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer":
                    {"pointer": "/extensions/KHR_lights_punctual/lights/0/intensity"}}}}]}]"#;
    let numbers = [&CORNERS[..], &[0.0, 2.0], &[0.0, 0.0, 0.0, 1.0, 1.0, 0.5, 0.25, 1.0]].concat();
    let views = r#"{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8}, {"buffer": 0, "byteOffset": 44, "byteLength": 32}"#;
    let accessors = r#"{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
        {"bufferView": 1, "componentType": 5126, "type": "SCALAR", "count": 2},
        {"bufferView": 2, "componentType": 5126, "type": "VEC4", "count": 2}"#;
    let text = file(&floats(&numbers), views, accessors, more);
    let at = |frame: f64| {
        let options = Options { frame, ..Options::default() };
        load_foreign_bytes(Foreign::Gltf, Path::new("nowhere/a.gltf"), text.as_bytes().to_vec(), &options)
            .unwrap()
    };
    let (first, middle, last) = (at(0.0), at(24.0), at(48.0));
    assert!(first.warnings.list.iter().all(|w| !w.message.contains("KHR_animation_pointer")));
    assert_eq!((first.scene.animation.frames, places(&first).len(), places(&last).len()), (49, 1, 2));
    let colour = |loaded: &Loaded| material(loaded).base_color.constant().and_then(|c| c.rgb()).map(|c| c.0);
    assert_eq!(colour(&middle), Some([0.5, 0.25, 0.125]));
    let Light::Point(lamp) = &last.scene.lights[0] else { panic!() };
    assert_eq!(lamp.intensity.rgb().map(|c| c.0), Some([2.0; 3]));
}

#[test]
fn copies_stand_where_their_lists_say() {
    let mut bytes = floats(&CORNERS);
    bytes.extend(floats(&[
        0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0,
    ]));
    let views = r#"{"buffer": 0, "byteLength": 108}"#;
    let vectors = |at: u32| {
        format!(
            r#"{{"bufferView": 0, "byteOffset": {at}, "componentType": 5126, "type": "VEC3", "count": 3}}"#
        )
    };
    let more = r#", "extensionsRequired": ["EXT_mesh_gpu_instancing"], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0, "translation": [10, 0, 0], "extensions": {"EXT_mesh_gpu_instancing": {"attributes":
        {"TRANSLATION": 1, "SCALE": 2}}}}]"#;
    let loaded = load(&file(&bytes, views, &[0, 36, 72].map(vectors).join(","), more));
    assert_eq!(places(&loaded).map_points(), [[12.0, 0.0, 1.0], [11.0, 0.0, 2.0]]);
    assert!(loaded.warnings.to_string().contains("an instance is left out"), "{}", loaded.warnings);
}

/// Where the point (1, 0, 0) goes.
trait MapPoints {
    fn map_points(&self) -> Vec<[f64; 3]>;
}

impl MapPoints for Vec<Affine> {
    fn map_points(&self) -> Vec<[f64; 3]> {
        self.iter().map(|place| place.point(DVec3::X).to_array()).collect()
    }
}

#[test]
fn chains_of_nodes_may_be_as_long_as_they_like() {
    let count = 3000;
    let mut nodes = String::from(r#", "nodes": ["#);
    for i in 0..count - 1 {
        nodes += &format!(r#"{{"translation": [1, 0, 0], "children": [{}]}},"#, i + 1);
    }
    nodes += r#"{"mesh": 0}]"#;
    let all = places(&load(&triangle(&nodes)));
    assert_eq!(all.map_points(), [[f64::from(count), 0.0, 0.0]]);
}

#[test]
fn cameras_see_what_they_should() {
    let more = r#", "cameras": [
        {"type": "orthographic", "name": "flat", "orthographic": {"xmag": 2, "ymag": 1, "znear": 0, "zfar": 9}},
        {"type": "perspective", "perspective": {"yfov": 0.7853981633974483, "aspectRatio": 1, "znear": 1}}],
        "nodes": [{"mesh": 0}, {"camera": 0}, {"camera": 1, "translation": [0, 0, 4], "name": "near"}]"#;
    let first = load(&triangle(more));
    assert!(matches!(&first.scene.camera, Camera::Orthographic(c) if c.width == 4.0));
    assert_eq!(first.scene.film.size, [848, 424]);
    assert!(first.warnings.to_string().contains("2 cameras: flat, near"), "{}", first.warnings);
    let second = load_with(&triangle(more), &[("camera", "near")]).unwrap();
    let Camera::Perspective(c) = &second.scene.camera else { panic!("{:?}", second.scene.camera) };
    assert!((c.fov.unwrap() - 45.0).abs() < 1e-12 && second.scene.film.size == [600, 600]);
    assert_eq!(c.observer.eye, DVec3::new(0.0, 0.0, 4.0));
    assert_eq!(c.observer.look_at, DVec3::ZERO);
    assert!(load_with(&triangle(more), &[("camera", "none")]).is_err());
}

#[test]
fn lights_are_taken_as_they_are_and_exposed_for() {
    let more = r#", "extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights": [
        {"type": "directional", "name": "shared", "intensity": 3141.592653589793, "color": [1, 1, 1]},
        {"type": "spot", "intensity": 2, "color": [1, 0.5, 0], "spot": {"outerConeAngle": 0.5235987755982988}}]}},
        "nodes": [{"mesh": 0}, {"extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"name": "Key light", "translation": [0, 9, 0], "extensions": {"KHR_lights_punctual": {"light": 1}}}]"#;
    let loaded = load(&triangle(more));
    let names = loaded.scene.lights.iter().map(|light| light.name().map(|name| &*name.value));
    assert_eq!(
        names.collect::<Vec<_>>(),
        [Some("shared"), Some("Key light")],
        "that of the node, else its own"
    );
    let options = Options { group_lamps: true, ..Options::default() };
    let text = triangle(more).into_bytes();
    let grouped = load_foreign_bytes(Foreign::Gltf, Path::new("nowhere/a.gltf"), text, &options).unwrap();
    assert_eq!(grouped.scene.light_groups(), ["Key_light", "shared"]);
    assert_eq!(loaded.scene.light_groups(), [""; 0]);
    let [Light::Directional(sun), Light::Spot(spot)] = &loaded.scene.lights[..] else { panic!() };
    assert_eq!(sun.axis(), -DVec3::Z);
    assert!((spot.cutoff - 30.0).abs() < 1e-12 && spot.full_beam() == 0.0);
    assert_eq!(spot.intensity.rgb().unwrap().0, [2.0, 1.0, 0.0]);
    assert_eq!(loaded.scene.film.exposure.stops, -10.0, "{}", loaded.warnings);
    assert!(loaded.warnings.list.iter().all(|d| d.severity == Severity::Note), "{}", loaded.warnings);
}

#[test]
fn materials_mean_what_they_say() {
    let more = r#", "nodes": [{"mesh": 0}], "extensionsUsed": ["KHR_materials_volume", "KHR_materials_transmission",
        "KHR_materials_ior", "KHR_materials_emissive_strength", "VENDOR_thing"], "materials": [{"name": "glass", "alphaMode": "BLEND", "doubleSided": true,
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 0.75], "metallicFactor": 0, "roughnessFactor": 0.125},
        "emissiveFactor": [0, 1, 0], "extensions": {
        "KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.25},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0.5]},
        "KHR_materials_emissive_strength": {"emissiveStrength": 8}}}]"#;
    let text = triangle(more).replace(r#""POSITION": 0}"#, r#""POSITION": 0}, "material": 0"#);
    let loaded = load(&text);
    // What shines and lets light pass is a mask over what doesn't.
    let masked = loaded.scene.materials.iter().next().unwrap().1;
    let Material::Mask(mask) = masked else { panic!("{masked:?}") };
    assert_eq!(mask.opacity, Varying::Constant(0.75));
    let MaterialRef::Inline(inner) = &*mask.material else { panic!() };
    let Material::Gltf(m) = &**inner else { panic!() };
    let Node::Mesh(shown) = &loaded.scene.world[0] else { panic!() };
    assert_eq!(
        shown.surface.emission.as_ref().unwrap().constant().unwrap().rgb().unwrap().0,
        [0.0, 8.0, 0.0]
    );
    assert_eq!(m.base_color.constant().unwrap().rgb().unwrap().0, [0.5, 0.25, 1.0]);
    assert_eq!(
        [&m.metallic, &m.roughness, &m.transmission].map(|v| *v.constant().unwrap()),
        [0.0, 0.125, 1.0]
    );
    assert_eq!((&m.ior, m.volume, m.attenuation_distance), (&1.25.into(), true, Some(2.0)));
    assert!(loaded.warnings.to_string().contains("`VENDOR_thing` is left out"), "{}", loaded.warnings);
    // What must be understood is an error.
    let wanted =
        text.replace(r#""extensionsUsed""#, r#""extensionsRequired": ["VENDOR_thing"], "extensionsUsed""#);
    assert!(
        complaints(&wanted)
            .contains("`extensionsRequired[0]`: the file can't be shown without `VENDOR_thing`")
    );
}

/// A triangle with normals, tangents, texture coordinates and colours, and what its primitive has of them.
fn dressed(attributes: &str, more: &str) -> String {
    let mut bytes = floats(&CORNERS);
    bytes.extend(floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    bytes.extend(floats(&[0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0]));
    bytes.extend(floats(&[0.0, 0.0, 0.0, 1.0, 1.0, 0.0]));
    bytes.extend(floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]));
    let view = |at, length| format!(r#"{{"buffer": 0, "byteOffset": {at}, "byteLength": {length}}}"#);
    let views = [view(0, 36), view(36, 36), view(72, 48), view(120, 24), view(144, 36)].join(", ");
    let accessor = |view, kind| {
        format!(r#"{{"bufferView": {view}, "componentType": 5126, "type": "{kind}", "count": 3}}"#)
    };
    let kinds = ["VEC3", "VEC3", "VEC4", "VEC2", "VEC3"];
    let accessors: Vec<String> = kinds.iter().enumerate().map(|(i, kind)| accessor(i, kind)).collect();
    let mesh = format!(
        r#", "nodes": [{{"mesh": 0}}], "images": [{{"uri": "{DOT}"}}], "textures": [{{"source": 0}}, {{"source": 0}}],
        "meshes": [{{"primitives": [{{"material": 0, "attributes": {{"POSITION": 0{attributes}}}}}]}}]{more}"#
    );
    file(&bytes, &views, &accessors.join(", "), &mesh)
}

#[test]
fn tangents_are_the_files_or_follow_the_texture() {
    let more = r#", "materials": [{"doubleSided": true, "normalTexture": {"index": 0, "scale": 0.5}, "extensions": {
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1.5707963267948966, "anisotropyTexture": {"index": 1}},
        "KHR_materials_clearcoat": {"clearcoatFactor": 1}}}]"#;
    let all = r#", "NORMAL": 1, "TANGENT": 2, "TEXCOORD_0": 3"#;
    let loaded = load(&dressed(all, more));
    assert!(!loaded.warnings.to_string().contains("materials[0]"), "{}", loaded.warnings);
    assert_eq!(mesh(&loaded).tangents, [[0.0, 1.0, 0.0, -1.0]; 3]);
    let m = material(&loaded);
    assert!(
        matches!(m.anisotropy_rotation, Varying::Constant(v) if (v - 90.0).abs() < 1e-9)
            && m.anisotropy_direction.is_some()
    );
    // The coat is smooth, where it doesn't name the same map.
    assert_eq!(m.clearcoat_normal, CoatNormal::Surface);
    for (normals, want) in [(r#"{"index": 0, "scale": 0.5}"#, false), (r#"{"index": 0, "scale": 2}"#, true)] {
        let coat = format!(r#""clearcoatFactor": 1, "clearcoatNormalTexture": {normals}"#);
        let loaded = load(&dressed(all, &more.replace(r#""clearcoatFactor": 1"#, &coat)));
        let coat = &material(&loaded).clearcoat_normal;
        assert_eq!(matches!(coat, CoatNormal::Map(map) if map.strength == 2.0), want, "{coat:?}");
        assert_eq!(*coat == CoatNormal::Base, !want);
    }
    // Without tangents they follow u, which rises along y: v falls in the file along x.
    let loaded = load(&dressed(r#", "NORMAL": 1, "TEXCOORD_0": 3"#, more));
    for [x, y, z, side] in &mesh(&loaded).tangents {
        assert!(x.abs() < 1e-6 && (y - 1.0).abs() < 1e-6 && z.abs() < 1e-6 && *side == 1.0);
    }
    assert_eq!(mesh(&loaded).tangents.len(), 3);
    // Flat faces and plain materials need none.
    assert!(mesh(&load(&dressed(r#", "TANGENT": 2, "TEXCOORD_0": 3"#, more))).tangents.is_empty());
    assert!(mesh(&load(&dressed(all, r#", "materials": [{}]"#))).tangents.is_empty());
}

#[test]
fn unlit_surfaces_shine_in_the_colours_of_their_vertices() {
    let more = r#", "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1]},
        "extensions": {"KHR_materials_unlit": {}}}]"#;
    let loaded = load(&dressed(r#", "COLOR_0": 4"#, more));
    assert!(!loaded.warnings.to_string().contains("unlit"), "{}", loaded.warnings);
    let picture = &loaded.assets.bitmaps.iter().next().expect("a picture").texels;
    assert_eq!((picture.width(), picture.height()), (2, 2));
    assert_eq!(picture.numbers(1, 0), [0.0, 1.0, 0.0, 1.0]);
    let mut emission = None;
    loaded.scene.visit(|node| {
        if let Node::Mesh(m) = node {
            emission = m.surface.emission.clone();
        }
    });
    let Some(Varying::Texture(texture)) = emission else { panic!("{emission:?}") };
    let TextureOf::Inline(Texture::Scale(scale)) = &*texture else { panic!("{texture:?}") };
    assert_eq!(scale.of.constant().unwrap().rgb().unwrap().0, [0.5, 1.0, 1.0]);
    // With a picture besides it is lit.
    let textured = more.replace("[0.5, 1, 1, 1]", r#"[1, 1, 1, 1], "baseColorTexture": {"index": 0}"#);
    let loaded = load(&dressed(r#", "COLOR_0": 4, "TEXCOORD_0": 3"#, &textured));
    assert!(loaded.warnings.to_string().contains("what should be unlit is lit"), "{}", loaded.warnings);
}

/// A picture of one texel.
const DOT: &str = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";

#[test]
fn textures_are_read_as_they_lie() {
    let mut bytes = floats(&CORNERS);
    bytes.extend(floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    let views = r#"{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}"#;
    let accessors = r#"{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
        {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 3}"#;
    let more = format!(
        r#", "images": [{{"uri": "{DOT}"}}], "samplers": [{{"wrapS": 33071, "magFilter": 9728}}], "textures": [{{"source": 0, "sampler": 0}}],
        "materials": [{{"alphaMode": "MASK", "doubleSided": true, "pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0, "texCoord": 1}},
        "metallicRoughnessTexture": {{"index": 0}}, "roughnessFactor": 0.5}}}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"material": 0, "attributes": {{"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_1": 1}}}}]}}]"#
    );
    let loaded = load(&file(&bytes, views, accessors, &more));
    assert_eq!(loaded.assets.bitmaps.iter().count(), 1);
    let m = material(&loaded);
    let text = serde_json::to_string(&straal_scene::decode::Describe::write(&loaded.scene)).unwrap();
    assert!(text.contains(r#""name":"uv1""#) && text.contains(r#""filter":"nearest""#), "{text}");
    for value in [&m.alpha, &m.roughness] {
        assert!(
            matches!(value, Varying::Texture(t) if matches!(**t, TextureOf::Inline(Texture::Remap(_) | Texture::Scale(_))))
        );
    }
    assert_eq!(mesh(&loaded).attributes[0].values, [0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
}

#[test]
fn what_is_wrong_is_told_with_its_path() {
    let shown = r#", "nodes": [{"mesh": 0}]"#;
    let whole = triangle(shown);
    for (from, to, want) in [
        (r#""count": 3"#, r#""count": 4"#, "`accessors[0]`: 4 things of 12 bytes each"),
        (r#""count": 3"#, r#""count": 4e9"#, "more than the 36 bytes of the buffer view"),
        (r#""count": 3"#, r#""count": -1"#, "`accessors[0].count`: a whole number"),
        (
            r#""byteLength": 36}"#,
            r#""byteLength": 37}"#,
            "`bufferViews[0]`: 37 bytes from byte 0 on are more than the 36",
        ),
        (
            r#""POSITION": 0"#,
            r#""POSITION": 7"#,
            "`meshes[0].primitives[0].attributes.POSITION`: there is no accessors[7]",
        ),
        (r#"{"mesh": 0}"#, r#"{"mesh": 0, "children": [0]}"#, "the node is within itself"),
        (r#"{"mesh": 0}"#, r#"{"children": [1]}, {"children": [0]}"#, "the node is within itself"),
        (r#"{"mesh": 0}"#, r#"{"children": [1, 1]}, {}"#, "is a child of nodes[0] already"),
        (r#"{"mesh": 0}"#, r#"{"mesh": 0, "rotation": [0, 1]}"#, "`nodes[0].rotation`: a list of 4 numbers"),
        (r#"{"mesh": 0}"#, r#"{}"#, "shows nothing"),
        (r#""2.0""#, r#""1.0""#, "`asset.version`: the file is of glTF 1.0"),
        (r#""VEC3""#, r#""VEC2""#, "3 numbers a vertex are wanted, these are 2"),
        (
            "data:application/octet-stream,",
            "http://x/",
            "`buffers[0].uri`: files are read from beside the scene, not by `http:`",
        ),
        (r#"{"bufferView": 0, "#, r#"{"#, "`accessors[0].count`"),
        ("}}", "}", "this is no JSON"),
    ] {
        let text = whole.replacen(from, to, 1);
        assert_ne!(text, whole, "{from}");
        if want == "`accessors[0].count`" {
            // All zeros, of which there are no more than bytes: that is allowed.
            assert!(load(&text).warnings.to_string().contains("studio"));
            continue;
        }
        let said = complaints(&text);
        assert!(said.contains(want), "{to}: {said}");
    }
}

#[test]
fn what_only_promises_takes_nothing() {
    let text = triangle(r#", "nodes": [{"mesh": 0}]"#)
        .replace(r#"{"bufferView": 0, "#, "{")
        .replace(r#""count": 3"#, r#""count": 4000000000"#);
    assert!(complaints(&text).contains("more than a file of this size can mean"));
}

#[test]
fn every_shared_scene_is_read() {
    let Some(shared) = crate::common::shared() else { return };
    let mut count = 0;
    for (name, most) in [
        ("Box/glTF-Embedded/Box.gltf", 1),
        ("Box With Spaces/glTF/Box With Spaces.gltf", 1),
        ("SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf", 1),
        ("SimpleSkin/glTF/SimpleSkin.gltf", 1),
        ("MeshPrimitiveModes/glTF/MeshPrimitiveModes.gltf", 3),
        ("SimpleInstancing/glTF-Binary/SimpleInstancing.glb", 1),
        ("TextureTransformTest/glTF/TextureTransformTest.gltf", 1),
    ] {
        let path = shared.join("scenes/gltf").join(name);
        let loaded = straal_formats::load(&path, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
        let warnings = loaded.warnings.list.iter().filter(|d| d.severity == Severity::Warning).count();
        assert!(warnings <= most, "{name}: {}", loaded.warnings);
        count += 1;
    }
    assert_eq!(count, 7);
}

#[test]
fn damaged_files_end_in_a_scene_or_complaints() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/gltf");
    let read = |bytes: Vec<u8>| match load_foreign_bytes(
        Foreign::Gltf,
        Path::new("nowhere/a.glb"),
        bytes,
        &Options::default(),
    ) {
        Ok(loaded) => drop(loaded.warnings.to_string()),
        Err(complaints) => assert!(complaints.has_errors()),
    };
    // PCG's state (O'Neill 2014), so that every run breaks the same bytes.
    let mut state = 1_u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    for name in ["scene.gltf", "scene.glb"] {
        let whole = std::fs::read(folder.join(name)).unwrap();
        let loaded =
            load_foreign_bytes(Foreign::Gltf, Path::new("nowhere/a.glb"), whole.clone(), &Options::default());
        assert!(loaded.is_ok(), "{}", loaded.unwrap_err());
        for _ in 0..150 {
            read(whole[..random(whole.len())].to_vec());
            let mut broken = whole.clone();
            for _ in 0..=random(4) {
                let at = random(whole.len());
                broken[at] = match random(3) {
                    0 => b'0' + random(10) as u8,
                    1 => broken[at] ^ 1 << random(8),
                    _ => random(256) as u8,
                };
            }
            read(broken);
        }
    }
}

/// Where a file has no camera, one is made that shows all in the picture that is asked for.
#[test]
fn the_camera_that_shows_all_suits_the_picture() {
    let text =
        triangle(r#", "nodes": [{"mesh": 0, "scale": [8, 1, 1]}], "scenes": [{"nodes": [0]}], "scene": 0"#);
    let eye = |size: Option<[u32; 2]>| {
        let studio = straal_formats::studio::Studio { size, ..Default::default() };
        let options = Options { studio, ..Options::default() };
        let path = Path::new("nowhere/a.gltf");
        let loaded = load_foreign_bytes(Foreign::Gltf, path, text.clone().into_bytes(), &options).unwrap();
        assert_eq!(loaded.scene.film.size, size.unwrap_or([800, 450]));
        let Camera::Perspective(camera) = &loaded.scene.camera else { panic!("a perspective camera") };
        (camera.observer.eye - camera.observer.look_at).length()
    };
    let (wide, tall) = (eye(None), eye(Some([100, 400])));
    assert!(tall > 4.0 * wide, "{tall} from the side of a tall picture, {wide} of a wide one");
}
