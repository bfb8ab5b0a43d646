//! Small stages of USD, and what comes of them. Those in `data/usd` were written by Pixar's own library (`usd-core` 26.11).

use std::path::Path;

use straal_formats::scene::Foreign;
use straal_formats::{Diagnostics, Loaded, Options, load, load_foreign_bytes};
use straal_math::{Affine, DVec3};
use straal_scene::desc::{
    Camera, Light, Material, MaterialRef, Node, Scene, Shading, Spectrum, Subdivision, Texture, TextureOf,
    Varying,
};
use straal_scene::value::LinearRgb;

const TEXT: &[u8] = include_bytes!("../data/usd/stage.usda");
const BINARY: &[u8] = include_bytes!("../data/usd/stage.usdc");
const PACKAGE: &[u8] = include_bytes!("../data/usd/stage.usdz");
const PACKED: &[u8] = include_bytes!("../data/usd/packed.usdc");

fn read(bytes: &[u8], options: &Options) -> Result<Loaded, Diagnostics> {
    load_foreign_bytes(Foreign::Usd, Path::new("nowhere/a.usd"), bytes.to_vec(), options)
}

fn loaded(bytes: &[u8]) -> Loaded {
    read(bytes, &Options::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// A stage in metres, y up, of this text.
fn stage(body: &str) -> Loaded {
    loaded(format!("#usda 1.0\n( metersPerUnit = 1 )\n{body}").as_bytes())
}

fn refused(body: &str) -> String {
    let text = format!("#usda 1.0\n{body}");
    read(text.as_bytes(), &Options::default())
        .err()
        .map_or_else(|| panic!("it is read: {text}"), |d| d.to_string())
}

/// All shapes of the world and where they stand, through groups and instances.
fn shapes(scene: &Scene) -> Vec<(String, Affine, Node)> {
    fn walk(scene: &Scene, node: &Node, above: &Affine, to: &mut Vec<(String, Affine, Node)>) {
        let here = node.placement().unwrap().then(above);
        match node {
            Node::Group(g) => g.children.iter().for_each(|child| walk(scene, child, &here, to)),
            Node::Instance(i) => walk(scene, scene.objects.of(&i.of).unwrap(), &here, to),
            Node::Instances(i) => {
                let object = scene.objects.of(&i.of).unwrap();
                i.transforms.iter().for_each(|m| walk(scene, object, &m.0.then(&here), to));
            }
            _ => {
                let name = node.surface().unwrap().name.as_ref().unwrap().value.clone();
                to.push((name, here, node.clone()));
            }
        }
    }
    let mut found = Vec::new();
    scene.world.iter().for_each(|node| walk(scene, node, &Affine::IDENTITY, &mut found));
    found
}

fn shape(loaded: &Loaded, name: &str) -> (Affine, Node) {
    let found = shapes(&loaded.scene).into_iter().find(|(n, ..)| n == name);
    found.map_or_else(|| panic!("no {name}"), |(_, place, node)| (place, node))
}

fn near(a: DVec3, b: DVec3) {
    assert!((a - b).length() < 1e-9, "{a:?} is not {b:?}");
}

fn material<'s>(loaded: &'s Loaded, node: &Node) -> &'s Material {
    match &node.surface().unwrap().material {
        Some(MaterialRef::Named(link)) => loaded.scene.materials.of(link).unwrap(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn text_binary_and_package_are_the_same_scene() {
    let text = loaded(TEXT);
    for bytes in [BINARY, PACKAGE] {
        let other = loaded(bytes);
        assert_eq!(other.scene.world, text.scene.world);
        assert_eq!(other.scene.camera, text.scene.camera);
        assert_eq!(other.scene.lights, text.scene.lights);
        assert_eq!(other.scene.materials, text.scene.materials);
        assert_eq!(other.scene.objects, text.scene.objects);
        let meshes = |l: &Loaded| l.assets.meshes.iter().map(|m| (*m.mesh).clone()).collect::<Vec<_>>();
        assert_eq!(meshes(&other), meshes(&text));
    }
    assert_eq!(text.warnings.list.len(), 0, "{}", text.warnings);
}

#[test]
fn a_stage_stands_in_metres_with_y_up() {
    let loaded = loaded(TEXT);
    // 30 cm along x, and 20 cm along x and y of z up.
    near(shape(&loaded, "Ball").0.point(DVec3::ZERO), DVec3::new(0.3, 0.0, 0.0));
    let (place, cone) = shape(&loaded, "Cone");
    near(place.point(DVec3::ZERO), DVec3::new(0.2, 0.0, -0.2));
    near(place.vector(DVec3::Z), DVec3::new(0.0, 0.01, 0.0));
    let Node::Cone(shape) = &cone else { panic!("{cone:?}") };
    near(shape.to, DVec3::Z);
    // The variant that is chosen says its colour.
    let Material::Diffuse(green) = material(&loaded, &cone) else { panic!() };
    assert_eq!(green.reflectance, Varying::Constant(Spectrum::Rgb(LinearRgb([0.0, 1.0, 0.0]))));
    let Camera::Perspective(camera) = &loaded.scene.camera else { panic!() };
    near(camera.observer.eye, DVec3::new(0.0, 0.4, 1.5));
    let ahead = (camera.observer.look_at - camera.observer.eye).try_normalize().unwrap();
    let (s, c) = straal_math::ops::sin_cos_degrees(15.0);
    near(ahead, DVec3::new(0.0, -s, -c));
    let half = straal_math::ops::atan2_d(0.5 * 20.955, 50.0) * 180.0 / std::f64::consts::PI;
    assert!((camera.fov.unwrap() - 2.0 * half).abs() < 1e-12);
    assert_eq!(loaded.scene.film.size, [703, 513]);
}

#[test]
fn what_is_shown_several_times_is_one_object() {
    let loaded = loaded(TEXT);
    assert_eq!(loaded.scene.objects.len(), 2, "of two instances, and of an instancer's prototype");
    let cubes: Vec<DVec3> = shapes(&loaded.scene)
        .iter()
        .filter(|(n, ..)| n == "C")
        .map(|(_, m, _)| m.point(DVec3::ZERO))
        .collect();
    for wanted in [DVec3::new(-0.2, 0.0, 0.0), DVec3::new(-0.3, 0.0, 0.0), DVec3::new(0.05, 0.25, 0.0)] {
        assert!(cubes.iter().any(|c| (*c - wanted).length() < 1e-9), "{cubes:?}");
    }
    // And the prototype itself, which is a prim like others.
    assert_eq!(cubes.len(), 6);
}

#[test]
fn frames_show_what_moves() {
    let at = |frame: f64| {
        let options = Options { frame, ..Options::default() };
        shape(&read(BINARY, &options).unwrap(), "Cube").0.vector(DVec3::X).try_normalize().unwrap()
    };
    // Turned about x, then y, then z, and then z is up.
    let wanted = |degrees: [f64; 3]| {
        let mut v = DVec3::X;
        for (axis, angle) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(degrees) {
            v = Affine::rotate(axis, angle).unwrap().vector(v);
        }
        DVec3::new(v.x, v.z, -v.y)
    };
    near(at(0.0), wanted([10.0, 20.0, 30.0]));
    near(at(12.0), wanted([15.0, 30.0, 45.0]));
    near(at(99.0), wanted([20.0, 40.0, 60.0]));
}

#[test]
fn packed_numbers_and_moving_points_are_read() {
    let options = Options { frame: 4.0, ..Options::default() };
    let loaded = read(PACKED, &options).unwrap();
    assert_eq!(loaded.scene.animation.frames, 10);
    let mesh = &loaded.assets.meshes.iter().next().unwrap().mesh;
    // Time 5 is half-way from 1 to 9.
    assert!(mesh.positions.len() == 36 && mesh.positions.iter().all(|p| p[1] == 1.0));
    assert_eq!((mesh.triangles.len(), mesh.sides.len()), (50, 25));
    let first = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
    assert_eq!(first, [[0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0]]);
    let (_, wires) = shape(&loaded, "Wires");
    let Node::Curves(wires) = wires else { panic!() };
    assert_eq!((wires.points.len(), wires.starts.len()), (40, 20));
    assert_eq!(&wires.radii[..4], [0.125, 0.25, 0.375, 0.125]);
}

#[test]
fn faces_have_primvars_and_subsets_have_materials() {
    let loaded = stage(
        r#"def Mesh "M" {
            int[] faceVertexCounts = [4, 3]
            int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
            point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0)]
            texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)] ( interpolation = "faceVarying" )
            int[] primvars:st:indices = [0, 1, 2, 3, 4, 4, 4]
            color3f[] primvars:displayColor = [(1, 0, 0), (0, 0, 1)] ( interpolation = "uniform" )
            uniform token subdivisionScheme = "none"
            uniform token orientation = "leftHanded"
            def GeomSubset "S" ( prepend apiSchemas = ["MaterialBindingAPI"] ) {
                uniform token familyName = "materialBind"
                int[] indices = [1]
                rel material:binding = </Red>
            }
        }
        def Material "Red" {
            token outputs:surface.connect = </Red/P.outputs:surface>
            def Shader "P" {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = (1, 0, 0)
                float inputs:roughness.connect = </Red.inputs:rough>
            }
            float inputs:rough = 0.25
        }
        def DomeLight "D" {}"#,
    );
    let meshes: Vec<_> = loaded.assets.meshes.iter().map(|m| &m.mesh).collect();
    let [subset, rest] = meshes[..] else { panic!("{}", meshes.len()) };
    // Turned over; a corner whose face has another value is a vertex of its own.
    assert_eq!((subset.positions.len(), rest.positions.len()), (3, 4));
    assert_eq!(rest.positions[0], [0.0, 1.0, 0.0]);
    assert_eq!((rest.uvs[0], subset.uvs[0]), ([0.0, 1.0], [0.5, 0.5]));
    assert_eq!(subset.attributes[0].values[..3], [0.0, 0.0, 1.0]);
    let Material::Gltf(red) = material(&loaded, &shape(&loaded, "S").1) else { panic!() };
    assert_eq!(red.roughness, Varying::Constant(0.25));
    let (_, node) = shape(&loaded, "M");
    let Material::Diffuse(own) = material(&loaded, &node) else { panic!() };
    assert!(matches!(own.reflectance, Varying::Texture(_)));
    assert!(matches!(&node, Node::Mesh(m) if m.shading == Shading::Flat && m.subdivide.is_none()));
}

#[test]
fn a_mesh_that_says_nothing_else_is_a_cage() {
    let loaded = stage(
        r#"def Mesh "M" {
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
            point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
            normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1)]
        }"#,
    );
    let (_, Node::Mesh(mesh)) = shape(&loaded, "M") else { panic!() };
    assert!(mesh.subdivide.is_some_and(|s| s.scheme == Subdivision::CatmullClark));
    assert!(
        loaded.assets.meshes.iter().next().unwrap().mesh.normals.is_empty(),
        "those of a cage don't count"
    );
    assert!(loaded.warnings.to_string().contains("has no lights"));
}

#[test]
fn textures_are_read_with_their_places() {
    let body = r#"def Mesh "M" ( prepend apiSchemas = ["MaterialBindingAPI"] ) {
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]
            texCoord2f[] primvars:map = [(0, 0), (1, 0), (1, 1)] ( interpolation = "vertex" )
            uniform token subdivisionScheme = "none"
            rel material:binding = </Mat>
        }
        def Material "Mat" {
            token outputs:surface.connect = </Mat/P.outputs:surface>
            def Shader "P" {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor.connect = </Mat/T.outputs:rgb>
                float inputs:metallic.connect = </Mat/T.outputs:b>
            }
            def Shader "T" {
                uniform token info:id = "UsdUVTexture"
                asset inputs:file = @data/checks.pfm@
                float2 inputs:st.connect = </Mat/Move.outputs:result>
                token inputs:wrapS = "repeat"
                token inputs:wrapT = "mirror"
                float4 inputs:scale = (0.5, 0.25, 0.5, 1)
            }
            def Shader "Move" {
                uniform token info:id = "UsdTransform2d"
                float2 inputs:in.connect = </Mat/R.outputs:result>
                float2 inputs:scale = (2, 3)
                float inputs:rotation = 90
            }
            def Shader "R" {
                uniform token info:id = "UsdPrimvarReader_float2"
                string inputs:varname = "map"
            }
        }
        def DomeLight "D" {}"#;
    let text = format!("#usda 1.0\n{body}");
    // The picture isn't there, which is all that is wrong.
    let complaints = read(text.as_bytes(), &Options::default()).unwrap_err();
    assert_eq!(complaints.errors(), 1, "{complaints}");
    assert!(complaints.to_string().contains("data/checks.pfm"), "{complaints}");
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    let pfm = [&b"PF\n1 1\n-1.0\n"[..], &[0; 12]].concat();
    std::fs::write(folder.path().join("data/checks.pfm"), pfm).unwrap();
    std::fs::write(folder.path().join("a.usda"), &text).unwrap();
    let loaded = load(&folder.path().join("a.usda"), &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    let Material::Gltf(made) = material(&loaded, &shape(&loaded, "M").1) else { panic!() };
    let Varying::Texture(colour) = &made.base_color else { panic!() };
    let TextureOf::Inline(Texture::Scale(scale)) = &**colour else { panic!("{colour:?}") };
    assert_eq!(
        (&scale.by, &scale.tint),
        (&0.5.into(), &Varying::Constant(Spectrum::Rgb(LinearRgb([1.0, 0.5, 1.0]))))
    );
    let Varying::Texture(image) = &scale.of else { panic!() };
    let TextureOf::Inline(Texture::Image(image)) = &**image else { panic!() };
    let straal_scene::desc::Mapping::Uv(uv) = &image.mapping else { panic!() };
    assert_eq!((uv.scale, uv.rotate), ([2.0, 3.0], 90.0));
}

#[test]
fn lights_are_as_bright_as_they_say() {
    let loaded = stage(
        r#"def Sphere "S" {}
        def DistantLight "Sun" { float inputs:intensity = 2; float inputs:exposure = 3; float inputs:angle = 60 }
        def RectLight "R" { float inputs:intensity = 12; bool inputs:normalize = 1
            float inputs:width = 2; float inputs:height = 3
            double3 xformOp:scale = (1, 2, 1)
            uniform token[] xformOpOrder = ["xformOp:scale"] }
        def SphereLight "P" { bool treatAsPoint = 1; float inputs:radius = 2; color3f inputs:color = (1, 2, 3) }
        def DomeLight "D" { bool inputs:enableColorTemperature = 1; float inputs:colorTemperature = 3000 }
        def SphereLight "Warm" { bool inputs:enableColorTemperature = 1; float inputs:colorTemperature = 3000
            color3f inputs:color = (1, 1, 0) }"#,
    );
    let rgb = |s: &Spectrum| s.rgb().unwrap().0;
    let names = loaded.scene.lights.iter().filter_map(|light| light.name().map(|name| &*name.value));
    assert_eq!(names.collect::<Vec<_>>(), ["Sun", "P", "D"]);
    let [Light::Directional(sun), Light::Point(point), Light::Environment(dome)] = &loaded.scene.lights[..]
    else {
        panic!("{:?}", loaded.scene.lights)
    };
    // pi sin^2(30 degrees) is what it takes of the sky.
    assert!((rgb(&sun.irradiance)[0] - 16.0 * std::f64::consts::PI * 0.25).abs() < 1e-12);
    assert_eq!((sun.angle, sun.direction), (60.0, Some(-DVec3::Z)));
    assert!((rgb(&point.intensity)[2] - 3.0 * 4.0 * std::f64::consts::PI).abs() < 1e-9);
    let Some(Spectrum::Measured(warm)) = &dome.radiance else { panic!() };
    assert_eq!((warm.blackbody, warm.scale), (Some(3000.0), 1.0));
    let (place, rect) = shape(&loaded, "R");
    // Divided by its size of 2 by 6.
    let emission = |node: &Node| match &node.surface().unwrap().emission {
        Some(Varying::Constant(Spectrum::Rgb(LinearRgb(v)))) => *v,
        other => panic!("{other:?}"),
    };
    assert_eq!(emission(&rect), [1.0; 3]);
    let Node::Rectangle(shape_of) = &rect else { panic!() };
    let [a, b] = shape_of.edges.map(|e| place.vector(e));
    near(a.cross(b).try_normalize().unwrap(), -DVec3::Z);
    // A warm light without blue: red over green as a black body of 3000 K has it.
    let [r, g, b] = emission(&shape(&loaded, "Warm").1);
    assert!(b == 0.0 && (1.5..3.0).contains(&(r / g)), "{r} {g}");
}

#[test]
fn layers_are_composed_by_their_strength() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), format!("#usda 1.0\n{text}")).unwrap()
    };
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    write(
        "shot.usda",
        r#"( subLayers = [@./set.usda@ (offset = 10)]
            metersPerUnit = 1 )
        over "World" { over "Ball" { double radius = 3 } }
        def "Late" ( references = @parts/ball.usda@ (offset = 100; scale = 2) ) {}
        def "Loud" ( prepend payload = @parts/ball.usda@</Ball/Inner> ) { double radius = 7 }
        def Sphere "Off" ( active = false ) {}
        def Sphere "Hidden" { token visibility = "invisible" }
        def Sphere "Rig" { uniform token purpose = "guide" }"#,
    );
    write(
        "set.usda",
        r#"def "World" { def Sphere "Ball" { double radius = 1; double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 10: (10, 0, 0) }
            uniform token[] xformOpOrder = ["xformOp:translate"] } }"#,
    );
    write(
        "parts/ball.usda",
        r#"( defaultPrim = "Ball" )
        def Sphere "Ball" ( inherits = </Base> ) {
            double radius.timeSamples = { 0: 1, 10: 11 }
            def Sphere "Inner" { double radius = 5; rel material:binding = </Ball/Mat> }
            def Material "Mat" { token outputs:surface.connect = </Ball/Mat/S.outputs:surface>
                def Shader "S" { uniform token info:id = "UsdPreviewSurface"; float inputs:roughness = 0.125 } }
        }
        class "Base" { color3f[] primvars:displayColor = [(0, 1, 0)] }"#,
    );
    let options = Options { frame: 15.0, ..Options::default() };
    let loaded = load(&folder.path().join("shot.usda"), &options).unwrap_or_else(|e| panic!("{e}"));
    let radius = |name: &str| match shape(&loaded, name).1 {
        Node::Sphere(s) => s.radius,
        other => panic!("{other:?}"),
    };
    assert_eq!(radius("Ball"), 3.0);
    near(shape(&loaded, "Ball").0.point(DVec3::ZERO), DVec3::new(5.0, 0.0, 0.0));
    // Its times begin at 100.
    assert_eq!(radius("Late"), 1.0);
    let Material::Diffuse(green) = material(&loaded, &shape(&loaded, "Late").1) else { panic!() };
    assert_eq!(green.reflectance, Varying::Constant(Spectrum::Rgb(LinearRgb([0.0, 1.0, 0.0]))));
    assert_eq!(radius("Loud"), 7.0);
    let names: Vec<String> = shapes(&loaded.scene).into_iter().map(|(name, ..)| name).collect();
    assert!(!names.iter().any(|n| ["Off", "Hidden", "Rig", "Base"].contains(&n.as_str())), "{names:?}");
    let Material::Gltf(mat) = material(&loaded, &shape(&loaded, "Inner").1) else { panic!() };
    assert_eq!(mat.roughness, Varying::Constant(0.125));
    // A file that isn't there is an error, unless one is lenient.
    write("lost.usda", "def Sphere \"S\" ( references = @nowhere.usd@ ) {}\ndef DomeLight \"D\" {}");
    let lost = load(&folder.path().join("lost.usda"), &Options::default()).unwrap_err().to_string();
    assert!(lost.contains("nowhere.usd") && lost.contains("--lenient"), "{lost}");
    let lenient = Options { lenient: true, ..Options::default() };
    assert!(load(&folder.path().join("lost.usda"), &lenient).is_ok());
}

#[test]
fn shapes_have_their_axes_and_sizes() {
    let loaded = stage(
        r#"def Cylinder "C" { double height = 4; double radius = 0.5; uniform token axis = "X" }
        def Capsule "K" {}
        def Plane "P" { double width = 4; uniform token axis = "Y" }
        def Cube "B" { double size = 3 }
        def Xform "Far" { double3 xformOp:translate = (0, 5, 0)
            uniform token[] xformOpOrder = ["xformOp:translate"]
            def Sphere "Reset" { uniform token[] xformOpOrder = ["!resetXformStack!"] }
            def Sphere "Back" { double3 xformOp:translate:a = (0, 5, 0)
                uniform token[] xformOpOrder = ["!invert!xformOp:translate:a"] } }"#,
    );
    let (_, Node::Cylinder(tube)) = shape(&loaded, "C") else { panic!() };
    assert_eq!((tube.from, tube.to, tube.caps), (DVec3::X * -2.0, DVec3::X * 2.0, true));
    let (_, Node::Capsule(capsule)) = shape(&loaded, "K") else { panic!() };
    assert_eq!((capsule.to, capsule.radius), (DVec3::Z * 0.5, 0.5));
    let (_, Node::Rectangle(plane)) = shape(&loaded, "P") else { panic!() };
    near(plane.edges[0].cross(plane.edges[1]), DVec3::Y * 8.0);
    let (_, Node::Box(cube)) = shape(&loaded, "B") else { panic!() };
    assert_eq!(cube.max, DVec3::splat(1.5));
    for name in ["Reset", "Back"] {
        near(shape(&loaded, name).0.point(DVec3::ZERO), DVec3::ZERO);
    }
}

#[test]
fn what_is_deep_within_others_stands_where_it_should() {
    let step = r#"def Xform "X" { double3 xformOp:translate = (0, 1, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"] "#;
    let loaded = stage(&format!("{}def Sphere \"S\" {{}}{}", step.repeat(100), "}".repeat(100)));
    near(shape(&loaded, "S").0.point(DVec3::ZERO), DVec3::Y * 100.0);
    assert!(refused(&format!("{}{}", step.repeat(200), "}".repeat(200))).contains("deep"));
}

#[test]
fn many_prims_of_one_name_are_read_quickly() {
    let one = |i: usize| {
        let [r, g] = [i % 256, i / 256].map(|v| v as f64 / 256.0);
        format!(
            "def \"G{i}\" {{ def Sphere \"S\" {{ color3f[] primvars:displayColor = [({r}, {g}, 0)] }} }}\n"
        )
    };
    let start = std::time::Instant::now();
    let loaded = stage(&(0..20_000).map(one).collect::<String>());
    assert_eq!((shapes(&loaded.scene).len(), loaded.scene.materials.len()), (20_000, 20_000));
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn what_is_wrong_is_told() {
    assert!(refused("def Sphere \"S\" { double radius = }").contains("a.usd:2:"), "with its place");
    assert!(refused("").contains("shows nothing"));
    for (bytes, says) in
        [(&b"PXR-USDC\0\x03\0"[..], "0.3.0"), (b"PK\x03\x04", "list of its files"), (b"\xff\xff", "neither")]
    {
        let complaints = read(bytes, &Options::default()).unwrap_err().to_string();
        assert!(complaints.contains(says), "{complaints}");
    }
    let more = [("camera".to_owned(), "Nobody".to_owned())].into();
    let options = Options { define: more, ..Options::default() };
    assert!(read(TEXT, &options).unwrap_err().to_string().contains("/World/Cam"));
}

#[test]
fn no_stage_refers_to_itself_for_ever() {
    let rings = [
        "def Sphere \"A\" ( references = </B> ) {}\ndef \"B\" ( references = </A> ) {}".to_owned(),
        "def Sphere \"A\" ( references = </A/B> ) { def \"B\" ( references = </A> ) {} }".to_owned(),
        "def Sphere \"A\" ( inherits = </A> ) {}".to_owned(),
        // Each of thirty prims holds the next one twice.
        (0..30).map(|i| {
            let next = i + 1;
            format!("def Sphere \"A{i}\" {{ def \"x\" ( references = </A{next}> ) {{}} def \"y\" ( references = </A{next}> ) {{}} }}\n")
        }).collect(),
        // And brings it in twice.
        (0..30).map(|i| {
            let next = i + 1;
            format!("def Sphere \"A{i}\" ( references = [</A{next}>, </A{next}> (offset = 1)] ) {{}}\n")
        }).collect(),
    ];
    for text in rings {
        let text = format!("#usda 1.0\n{text}");
        let start = std::time::Instant::now();
        let _ = read(text.as_bytes(), &Options::default());
        assert!(start.elapsed().as_secs() < 20, "{text}");
    }
}

#[test]
fn damaged_files_end_in_complaints_or_scenes() {
    let mut state = 1_u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let mut cases = 0;
    for whole in [TEXT, BINARY, PACKAGE, PACKED] {
        for end in (0..whole.len()).step_by(7) {
            let _ = read(&whole[..end], &Options::default());
        }
        for _ in 0..600 {
            let mut bytes = whole.to_vec();
            for _ in 0..1 + random(4) {
                let at = random(bytes.len());
                bytes[at] = if random(2) == 0 { random(256) as u8 } else { bytes[at] ^ 1 << random(8) };
            }
            match read(&bytes, &Options::default()) {
                Ok(loaded) => drop(loaded.warnings.to_string()),
                Err(complaints) => assert!(complaints.to_string().contains("error: ")),
            }
            cases += 1;
        }
    }
    assert_eq!(cases, 2400);
}

/// Two joints, of which the second is turned by a quarter about z and hangs one unit above the first.
#[test]
fn points_follow_the_joints_of_a_skeleton() {
    let text_of = |animation: &str, between: &str, skinning: &str| {
        format!(
            r#"def SkelRoot "figure" {{
    double3 xformOp:translate = (10, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Skeleton "bones" {{
        uniform token[] joints = ["a", "a/b"]
        uniform matrix4d[] bindTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,1,0,1))]
        uniform matrix4d[] restTransforms = [((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1)), ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,1,0,1))]
        rel skel:animationSource = </figure/bones/walk>
        def SkelAnimation "walk" {{
            uniform token[] joints = ["a/b"]
            float3[] translations = [(0, 1, 0)]
            quatf[] rotations = [(0.70710678, 0, 0, 0.70710678)]
            half3[] scales = [(1, 1, 1)]
            {animation}
        }}
    }}
    def Mesh "skin" (prepend apiSchemas = ["SkelBindingAPI"]) {{
        double3 xformOp:translate = (0, 0, 5)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        uniform token subdivisionScheme = "none"
        point3f[] points = [(0, 0, 0), (1, 1, 0), (0, 2, 0)]
        normal3f[] normals = [(0, 0, 1), (0, 0, 1), (1, 0, 0)] (interpolation = "vertex")
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        rel skel:skeleton = </figure/bones>
        {skinning}
        int[] primvars:skel:jointIndices = [0, 1, 0, 1, 1, 0] (elementSize = 2 interpolation = "vertex")
        float[] primvars:skel:jointWeights = [1, 0, 0.5, 0.5, 1, 0] (elementSize = 2 interpolation = "vertex")
        matrix4d primvars:skel:geomBindTransform = ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))
        uniform token[] skel:blendShapes = ["up"]
        rel skel:blendShapeTargets = </figure/skin/up>
        def BlendShape "up" {{
            uniform vector3f[] offsets = [(0, 0, 2)]
            {between}
            uniform int[] pointIndices = [0]
        }}
    }}
}}"#
        )
    };
    let text = |animation: &str| text_of(animation, "", "");
    let points = |text: &str| {
        let loaded = stage(text);
        let (place, node) = shape(&loaded, "skin");
        let Node::Mesh(mesh) = node else { panic!() };
        let mesh = &loaded.assets.mesh(mesh.file.as_ref().unwrap().handle).mesh;
        let of = |v: &[f32; 3]| DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
        let places: Vec<DVec3> = mesh.positions.iter().map(|p| place.point(of(p))).collect();
        (places, mesh.normals.iter().map(of).collect::<Vec<_>>())
    };
    let (places, normals) = points(&text(""));
    // They stand in the skeleton's space, wherever the mesh does: the second half by each joint, the third by the turned one.
    let wanted = [DVec3::new(10.0, 0.0, 0.0), DVec3::new(10.5, 1.5, 0.0), DVec3::new(9.0, 1.0, 0.0)];
    for (found, wanted) in places.iter().zip(wanted) {
        assert!((*found - wanted).length() < 1e-5, "{found:?} is not {wanted:?}");
    }
    assert!((normals[2] - DVec3::Y).length() < 1e-5, "{normals:?}");
    let blended = text("uniform token[] blendShapes = [\"up\"]\nfloat[] blendShapeWeights = [0.5]");
    assert!((points(&blended).0[0] - DVec3::new(10.0, 0.0, 1.0)).length() < 1e-5);
    // By way of another shape, and beyond it.
    for (weight, wanted) in
        [(0.125, [2.0, 0.0]), (0.25, [4.0, 0.0]), (0.5, [8.0 / 3.0, 2.0 / 3.0]), (1.0, [0.0, 2.0])]
    {
        let animation =
            format!("uniform token[] blendShapes = [\"up\"]\nfloat[] blendShapeWeights = [{weight}]");
        let between = "uniform vector3f[] inbetweens:first = [(0, 4, 0)] ( weight = 0.25 )";
        let found = points(&text_of(&animation, between, "")).0[0];
        assert!((found - DVec3::new(10.0, wanted[0], wanted[1])).length() < 1e-5, "{weight}: {found:?}");
    }
    // As screws: halfway to a quarter turn about (0, 1) is an eighth of one, by which (1, 1) comes as far as it was.
    let method = "uniform token primvars:skel:skinningMethod = \"dualQuaternion\"";
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let wanted = [wanted[0], DVec3::new(10.0 + half, 1.0 + half, 0.0), wanted[2]];
    for (found, wanted) in points(&text_of("", "", method)).0.iter().zip(wanted) {
        assert!((*found - wanted).length() < 1e-5, "{found:?} is not {wanted:?}");
    }
}

/// Curves that close, and widths by their ends.
#[test]
fn curves_close_and_have_widths_at_their_ends() {
    let curve = |said: &str| {
        let loaded = stage(&format!(
            "def BasisCurves \"c\" {{ point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]\nint[] curveVertexCounts = [4]\n{said} }}"
        ));
        assert!(
            !loaded.warnings.to_string().contains("widths") && !loaded.warnings.to_string().contains("open")
        );
        let Node::Curves(curves) = shape(&loaded, "c").1 else { panic!("curves") };
        (curves.points.len(), curves.radii.clone())
    };
    let closed = |kind: &str| format!("uniform token type = \"{kind}\"\nuniform token wrap = \"periodic\"");
    assert_eq!(curve(&closed("linear")).0, 5);
    // Four pieces of Bezier's, and four of a B-spline.
    assert_eq!(curve(&format!("{}\nuniform token basis = \"catmullRom\"", closed("cubic"))).0, 13);
    assert_eq!(curve(&format!("{}\nuniform token basis = \"bspline\"", closed("cubic"))).0, 7);
    let widths = |said: &str, widths: &str| curve(&format!("{said}\nfloat[] widths = {widths}")).1;
    let bezier = "uniform token type = \"cubic\"\nuniform token basis = \"bezier\"";
    assert_eq!(widths(bezier, "[2, 8]"), vec![1.0, 2.0, 3.0, 4.0]);
    assert_eq!(
        widths("uniform token type = \"cubic\"\nuniform token basis = \"bspline\"", "[2, 4]"),
        vec![1.0, 1.0, 2.0, 2.0]
    );
}

#[test]
fn surfaces_of_materialx_are_layers() {
    let loaded = stage(
        r#"
def Mesh "a" ( prepend apiSchemas = ["MaterialBindingAPI"] ) {
    uniform token subdivisionScheme = "none"
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 1)] (interpolation = "vertex")
    rel material:binding = </m>
}
def Material "m" {
    token outputs:mtlx:surface.connect = </m/s.outputs:out>
    def Shader "s" {
        uniform token info:id = "ND_standard_surface_surfaceshader"
        color3f inputs:base_color.connect = </m/product.outputs:out>
        float inputs:metalness = 0.25
        float inputs:specular_roughness.connect = </m/rough.outputs:out>
        float inputs:thin_film_thickness = 400
        float inputs:coat = 1
        color3f inputs:opacity = (0.25, 0.5, 0.75)
        token outputs:out
    }
    def Shader "product" {
        uniform token info:id = "ND_multiply_color3FA"
        color3f inputs:in1.connect = </m/picture.outputs:out>
        float inputs:in2 = 0.5
        color3f outputs:out
    }
    def Shader "picture" {
        uniform token info:id = "ND_tiledimage_color3"
        asset inputs:file = @p.png@ (colorSpace = "srgb_texture")
        float2 inputs:uvtiling = (2, 3)
        color3f outputs:out
    }
    def Shader "rough" {
        uniform token info:id = "ND_constant_float"
        float inputs:value = 0.75
        float outputs:out
    }
}"#
        .replace("@p.png@", &format!("@{}/../../tests/pictures/halves.png@", env!("CARGO_MANIFEST_DIR")))
        .as_str(),
    );
    assert!(loaded.warnings.list.iter().all(|w| !w.message.contains("isn't read")), "{}", loaded.warnings);
    let (_, node) = shape(&loaded, "a");
    let Material::OpenPbr(m) = material(&loaded, &node) else { panic!() };
    assert_eq!(m.base_metalness, Varying::Constant(0.25));
    assert_eq!(m.specular_roughness, Varying::Constant(0.75));
    assert_eq!(m.thin_film_thickness, Varying::Constant(0.4));
    assert_eq!((&m.coat_weight, &m.geometry_opacity), (&Varying::Constant(1.0), &Varying::Constant(0.5)));
    let Varying::Texture(t) = &m.base_color else { panic!() };
    let TextureOf::Inline(Texture::Scale(product)) = &**t else { panic!("{t:?}") };
    assert_eq!(product.by, Varying::Constant(0.5));
}

#[test]
fn what_moves_is_blurred_while_the_camera_s_shutter_is_open() {
    let text = |close: f64| {
        format!(
            r#"def Camera "c" {{
    double shutter:open = 0
    double shutter:close = {close}
    double3 xformOp:translate.timeSamples = {{ 0: (0, 0, 9), 2: (4, 0, 9) }}
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}
def Sphere "ball" {{
    float xformOp:rotateY.timeSamples = {{ 0: 0, 1: 90 }}
    uniform token[] xformOpOrder = ["xformOp:rotateY"]
}}
def Points "dust" {{
    point3f[] points = [(0, 0, 0), (1, 2, 3)]
    float[] widths = [0.5, 1]
}}"#
        )
    };
    let moving = stage(&text(0.5));
    let Node::Group(ball) = &moving.scene.world[0] else { panic!("{:?}", moving.scene.world) };
    let places: Vec<DVec3> = Node::Group(ball.clone()).motion().iter().map(|m| m.vector(DVec3::Z)).collect();
    assert_eq!(places.len(), 9);
    near(places[8], DVec3::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()));
    let keyframes = &moving.scene.camera.observer().moving_to.as_ref().unwrap().keyframes;
    near(keyframes[7].eye.unwrap(), DVec3::new(1.0, 0.0, 9.0));
    let Node::Instances(dust) = &moving.scene.world[1] else { panic!() };
    near(dust.transforms[1].0.point(DVec3::X), DVec3::new(1.5, 2.0, 3.0));
    let still = stage(&text(0.0));
    assert!(still.scene.camera.observer().moving_to.is_none() && still.scene.world[0].motion().is_empty());
}

/// A document of MaterialX is a layer: each of its materials brings the nodes that it leads to.
#[test]
fn documents_of_materialx_are_layers() {
    let document = r#"<?xml version="1.0"?>
<materialx version="1.38" colorspace="srgb_texture" fileprefix="tex/">
  <nodegraph name="NG">
    <input name="dark" type="float" value="0.5"/>
    <place2d name="place" type="vector2"><input name="scale" type="vector2" value="0.5, 0.25"/><input name="rotate" type="float" value="90"/>
      <input name="pivot" type="vector2" value="1, 0"/><input name="offset" type="vector2" value="0.25, 0.75"/></place2d>
    <image name="colour" type="color3"><input name="file" type="filename" value="p.pfm"/><input name="texcoord" type="vector2" nodename="place"/></image>
    <multiply name="product" type="color3"><input name="in1" type="color3" nodename="colour"/><input name="in2" type="float" interfacename="dark"/></multiply>
    <image name="bumps" type="vector3"><input name="file" type="filename" value="tex/p.pfm"/></image>
    <normalmap name="normal" type="vector3"><input name="in" type="vector3" nodename="bumps"/></normalmap>
    <output name="out_colour" type="color3" nodename="product"/>
    <output name="out_normal" type="vector3" nodename="normal"/>
  </nodegraph>
  <constant name="shiny" type="float"><input name="value" type="float" value="0.75"/></constant>
  <standard_surface name="S" type="surfaceshader">
    <input name="base_color" type="color3" nodegraph="NG" output="out_colour"/>
    <input name="normal" type="vector3" nodegraph="NG" output="out_normal"/>
    <input name="specular_roughness" type="float" nodename="shiny"/>
    <input name="metalness" type="float" value="0.25"/><input name="opacity" type="color3" value="0.25, 0.5, 0.75"/>
  </standard_surface>
  <surfacematerial name="M" type="material"><input name="surfaceshader" type="surfaceshader" nodename="S"/></surfacematerial>
  <surfacematerial name="Bare" type="material"/>
</materialx>"#;
    let stage = r#"#usda 1.0
( metersPerUnit = 1 )
def Mesh "a" ( prepend apiSchemas = ["MaterialBindingAPI"] ) {
    uniform token subdivisionScheme = "none"
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 1)] (interpolation = "vertex")
    rel material:binding = </Looks/M>
}
def "Looks" ( prepend references = @./m.mtlx@</MaterialX/Materials> ) {}
def DomeLight "D" {}"#;
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("tex")).unwrap();
    std::fs::write(folder.path().join("tex/p.pfm"), [&b"PF\n1 1\n-1.0\n"[..], &[0; 12]].concat()).unwrap();
    std::fs::write(folder.path().join("m.mtlx"), document).unwrap();
    std::fs::write(folder.path().join("a.usda"), stage).unwrap();
    let read = || load(&folder.path().join("a.usda"), &Options::default());
    let loaded = read().unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.warnings.list.is_empty(), "{}", loaded.warnings);
    let Material::OpenPbr(m) = material(&loaded, &shape(&loaded, "a").1) else { panic!() };
    assert_eq!(
        (&m.base_metalness, &m.specular_roughness),
        (&Varying::Constant(0.25), &Varying::Constant(0.75))
    );
    assert_eq!(m.geometry_opacity, Varying::Constant(0.5));
    assert!(m.relief.normal_map.is_some());
    let Varying::Texture(t) = &m.base_color else { panic!() };
    let TextureOf::Inline(Texture::Scale(product)) = &**t else { panic!("{t:?}") };
    assert_eq!(product.by, Varying::Constant(0.5));
    let Varying::Texture(t) = &product.of else { panic!() };
    let TextureOf::Inline(Texture::Image(image)) = &**t else { panic!("{t:?}") };
    assert_eq!(image.color_space, straal_scene::desc::TextureSpace::Srgb);
    let straal_scene::desc::Mapping::Uv(uv) = &image.mapping else { panic!() };
    // About (1, 0) scaled by 2 and 4 and turned clockwise: (u, v) goes to (4 v, 2 - 2 u), then by the offset and back to the pivot.
    assert_eq!((uv.scale, uv.rotate, uv.translate), ([2.0, 4.0], -90.0, [0.75, 1.25]));
    // One that ends anywhere, or has a byte of another, is read or complained of.
    for cut in (0..document.len()).step_by(11) {
        std::fs::write(folder.path().join("m.mtlx"), &document[..cut]).unwrap();
        assert!(read().is_err(), "{cut}");
        let mut other = document.as_bytes().to_vec();
        other[cut] = b"<>\"@()/a"[cut % 8];
        std::fs::write(folder.path().join("m.mtlx"), other).unwrap();
        let _ = read();
    }
    // What is no document ends in a complaint.
    for (text, complaint) in
        [("<materialx><a></materialx>", "is no XML"), ("<other/>", "neither a layer of USD nor")]
    {
        std::fs::write(folder.path().join("m.mtlx"), text).unwrap();
        let complaints = read().unwrap_err().to_string();
        assert!(complaints.contains(complaint), "{complaints}");
    }
}
