//! Scenes read as a whole.

use std::collections::BTreeMap;
use std::path::Path;

use straal_math::DVec3;
use straal_scene::desc::{
    Camera, EnvironmentLayout, FovAxis, Integrator, Light, Material, MaterialRef, Node, Spectrum, Varying,
};
use straal_scene::memory::Ledger;
use straal_scene::value::{Depth, LinearRgb};
use straal_scene::{Diagnostics, Scene, Severity};

use crate::Limits;
use crate::files::Finder;
use crate::scene::{Foreign, Means, Translated};

/// Reads a scene in a folder.
fn read_in(base: &Path, text: &str) -> (Option<Translated>, Diagnostics) {
    let mut d = Diagnostics::default();
    let (limits, mut finder, mut ledger) = (Limits::default(), Finder::default(), Ledger::new(None));
    let define = BTreeMap::new();
    let mut means = Means {
        frame: 0.0,
        base,
        limits: &limits,
        finder: &mut finder,
        ledger: &mut ledger,
        define: &define,
        lenient: false,
        size: None,
        d: &mut d,
    };
    let translated = Foreign::Pbrt.translate("a.pbrt", text.as_bytes(), &mut means);
    (translated, d)
}

fn read(text: &str) -> (Scene, Diagnostics) {
    let (translated, d) = read_in(Path::new("/nowhere"), text);
    (translated.unwrap().scene, d)
}

/// What is complained of, each with its place.
fn told(d: &Diagnostics) -> Vec<String> {
    d.list.iter().map(|one| format!("{} {}: {}", d.place(one.span), one.severity, one.message)).collect()
}

/// A scene that nothing is said against.
fn sound(text: &str) -> Scene {
    let (scene, d) = read(text);
    assert!(d.list.is_empty(), "{d}");
    scene
}

const SPHERE: &str = "Shape \"sphere\"\n";

#[test]
fn a_usual_camera_is_mirrored_and_one_after_a_flip_is_not() {
    let scene = sound(&format!(
        "LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 30 WorldBegin {SPHERE}"
    ));
    let Camera::Perspective(c) = &scene.camera else { panic!() };
    assert_eq!((c.fov, &c.fov_axis), (Some(30.0), &FovAxis::Smaller));
    let o = &c.observer;
    assert_eq!((o.eye, o.look_at, o.up), (DVec3::new(0.0, 0.0, -5.0), DVec3::new(0.0, 0.0, -4.0), DVec3::Y));
    assert!(o.mirror);
    let flipped =
        sound(&format!("Scale -1 1 1 LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" WorldBegin {SPHERE}"));
    assert!(!flipped.camera.observer().mirror);
    // The transform of the camera goes on in the coordinate system of its name.
    let scene = sound(
        "LookAt 1 2 -5 1 2 0 0 1 0 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\" LightSource \"point\" \
         \"rgb I\" [ 1 2 3 ]",
    );
    let [Light::Point(p)] = scene.lights.as_slice() else { panic!() };
    assert_eq!(
        (p.position, &p.intensity),
        (DVec3::new(1.0, 2.0, -5.0), &Spectrum::Rgb(LinearRgb([1.0, 2.0, 3.0])))
    );
}

#[test]
fn a_screen_window_is_a_shift_and_an_angle() {
    let scene = sound(&format!(
        "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 100\n\
         Camera \"perspective\" \"float fov\" 90 \"float screenwindow\" [ 0 1 -1 0 ] WorldBegin {SPHERE}"
    ));
    let Camera::Perspective(c) = &scene.camera else { panic!() };
    // Half as wide as a plane of 45 degrees to each side.
    // Twice the angle whose tangent is 1/2.
    assert!((c.fov.unwrap() - 53.130_102_354_155_98).abs() < 1e-9);
    assert_eq!((&c.fov_axis, c.shift), (&FovAxis::X, [0.5, -0.5]));
}

#[test]
fn the_sensor_scales_all_light() {
    let scene = sound(
        "Camera \"perspective\" \"float shutteropen\" 0 \"float shutterclose\" 0.5\n\
         Film \"rgb\" \"float iso\" 400 WorldBegin\n\
         LightSource \"point\" \"rgb I\" [ 1 1 1 ] \"float scale\" 3\n\
         LightSource \"distant\" \"blackbody L\" 3000 \"float illuminance\" 5\n\
         AreaLightSource \"diffuse\" \"rgb L\" [ 1 2 3 ] \"bool twosided\" true\n\
         Shape \"sphere\"",
    );
    let [Light::Point(p), Light::Directional(s)] = scene.lights.as_slice() else { panic!() };
    assert_eq!(p.intensity, Spectrum::grey(6.0));
    let Spectrum::Measured(m) = &s.irradiance else { panic!() };
    assert_eq!((m.blackbody, m.scale), (Some(3000.0), 10.0));
    let surface = scene.world[0].surface().unwrap();
    assert_eq!(surface.emission, Some(Varying::Constant(Spectrum::Rgb(LinearRgb([2.0, 4.0, 6.0])))));
    assert!(surface.two_sided_emission);
}

#[test]
fn attributes_come_back_and_instances_are_gathered() {
    let scene = sound(
        "WorldBegin\n\
         ObjectBegin \"ball\" Translate 1 0 0 Shape \"sphere\" ObjectEnd\n\
         AttributeBegin Translate 0 2 0 ObjectInstance \"ball\" AttributeEnd\n\
         Rotate 90 0 0 1 ObjectInstance \"ball\"\n\
         ObjectInstance \"ball\"",
    );
    let [Node::Instances(all)] = scene.world.as_slice() else { panic!("{:?}", scene.world) };
    assert_eq!(all.transforms.len(), 3);
    assert_eq!(all.transforms[0].0.point(DVec3::X), DVec3::new(1.0, 2.0, 0.0));
    assert!((all.transforms[1].0.point(DVec3::X) - DVec3::Y).length() < 1e-12);
    assert!(all.of.to().is_some());
    let Node::Group(ball) = scene.objects.get("ball").unwrap() else { panic!() };
    assert_eq!(ball.children[0].placement().unwrap().point(DVec3::ZERO), DVec3::X);
}

#[test]
fn materials_by_name_and_on_the_spot() {
    let scene = sound(
        "WorldBegin\n\
         MakeNamedMaterial \"a\" \"string type\" \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\" \
         \"float roughness\" 0.25\n\
         MakeNamedMaterial \"b\" \"string type\" [ \"interface\" ]\n\
         NamedMaterial \"a\" Shape \"sphere\" \"float alpha\" 0.5\n\
         NamedMaterial \"b\" Shape \"sphere\"\n\
         Material \"dielectric\" \"spectrum eta\" \"glass-BK7\" Shape \"disk\"",
    );
    let Some(Material::Conductor(m)) = scene.materials.get("a") else { panic!() };
    assert_eq!(m.metal.as_ref().map(|m| m.what.name()), Some("gold"));
    // A roughness is the square of alpha, as pbrt has it.
    assert_eq!(m.roughness, Varying::Constant(0.5));
    assert_eq!(scene.world.len(), 2, "what has no surface isn't there");
    let Some(MaterialRef::Inline(mask)) = &scene.world[0].surface().unwrap().material else { panic!() };
    assert!(matches!(&**mask, Material::Mask(m) if m.opacity == Varying::Constant(0.5)));
    let Some(MaterialRef::Named(glass)) = &scene.world[1].surface().unwrap().material else { panic!() };
    assert!(glass.to().is_some());
}

#[test]
fn meshes_of_the_text_stand_beside_the_description() {
    let text = "WorldBegin ReverseOrientation Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 ]\n\
                \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] \"point2 uv\" [ 0 0 1 0 0 1 ]";
    let (translated, d) = read_in(Path::new(""), text);
    assert!(d.list.is_empty(), "{d}");
    let Translated { scene, made, .. } = translated.unwrap();
    let [Node::Mesh(m)] = scene.world.as_slice() else { panic!() };
    assert!(m.surface.flip);
    let mesh = &made.assets.mesh(m.file.as_ref().unwrap().handle).mesh;
    assert_eq!((mesh.triangles.as_slice(), mesh.uvs.len()), ([[0, 1, 2]].as_slice(), 3));
}

#[test]
fn parts_of_round_shapes_and_curves_are_straals_own() {
    let scene = sound(
        "WorldBegin Shape \"sphere\" \"float radius\" 2 \"float zmin\" -1 \"float phimax\" 90\n\
         Shape \"disk\" \"float innerradius\" 0.5 Shape \"cylinder\" \"float phimax\" 180\n\
         Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 2 1 0 ] \"float width0\" 2 \"float width1\" 0\n\
         Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 2 1 0 ] \"string type\" \"flat\"\n\
         Shape \"loopsubdiv\" \"integer levels\" 2 \"integer indices\" [ 0 1 2 ] \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]",
    );
    let [Node::Sphere(s), Node::Annulus(a), Node::Cylinder(c), Node::Curves(k), Node::Mesh(m)] =
        scene.world.as_slice()
    else {
        panic!("{:?}", scene.world)
    };
    assert_eq!((s.heights, s.phi), (Some([-1.0, 2.0]), [0.0, 90.0]));
    // What is a height along y there is one along z here.
    assert_eq!(s.surface.transform.affine().unwrap().point(DVec3::Y), DVec3::Z);
    assert_eq!((a.inner_radius, a.phi, c.phi), (0.5, [0.0, 360.0], [0.0, 180.0]));
    assert_eq!((k.starts.as_slice(), k.points.len()), ([0, 4].as_slice(), 8));
    assert_eq!((k.radii[0], k.radii[3], k.radii[4]), (1.0, 0.0, 0.5));
    assert_eq!(m.subdivide.as_ref().map(|s| s.levels), Some(2));
}

#[test]
fn power_is_shared_out_by_area() {
    let scene = sound(
        "WorldBegin AreaLightSource \"diffuse\" \"float power\" 100 Scale 2 2 2 Shape \"sphere\" \"float radius\" 0.5",
    );
    let pi = std::f64::consts::PI;
    let Some(Varying::Constant(Spectrum::Rgb(LinearRgb([r, ..])))) =
        scene.world[0].surface().unwrap().emission
    else {
        panic!()
    };
    // Radiance times pi times the area of a sphere of radius 1.
    assert!((r * pi * 4.0 * pi - 100.0).abs() < 1e-9, "{r}");
}

#[test]
fn what_nobody_asks_for_is_told_with_its_place() {
    let (_, d) = read(
        "WorldBegin\nShape \"sphere\" \"float raduis\" 2\n  \"point3 radius\" [ 1 2 3 ]\nShape \"spere\"\nShpae \"a\"",
    );
    assert_eq!(
        told(&d),
        [
            "a.pbrt:2:16 warning: the shape `sphere` has no parameter `raduis`: it is passed over",
            "a.pbrt:3:3 warning: `radius` of the shape `sphere` is of another type: it is passed over",
            "a.pbrt:4:7 error: there is no shape `spere`",
            "a.pbrt:5:1 error: there is no directive `Shpae`",
        ]
    );
    let helps: Vec<_> = d.list.iter().map(|one| one.help.as_deref()).collect();
    assert_eq!(helps[0], Some("did you mean `radius`?"));
    assert_eq!(helps[2..], [Some("did you mean `sphere`?"), Some("did you mean `Shape`?")]);
}

#[test]
fn wrong_words_are_errors_with_their_places() {
    for (text, want) in [
        ("WorldBegin Translate 1 2 x", "1:26 error: expected a number, found `x`"),
        ("WorldBegin Transform [ 1 2 ]", "1:28 error: expected a number, found `]`"),
        ("WorldBegin Shape \"sphere\" \"flot radius\" 1", "1:27 error: there is no type of parameter `flot`"),
        ("WorldBegin AttributeEnd", "1:12 error: nothing is open that this could end"),
        ("WorldBegin AttributeBegin", "1:12 error: this has no `AttributeEnd`"),
        (
            "Shape \"sphere\" WorldBegin",
            "1:1 error: `Shape` comes before `WorldBegin`, where only the picture is told of",
        ),
        ("WorldBegin Film \"rgb\"", "1:12 error: `Film` must come before `WorldBegin`"),
        ("WorldBegin ObjectInstance \"a\"", "1:27 error: there is no object named `a`"),
        ("WorldBegin NamedMaterial \"a\" Shape \"sphere\"", "1:26 error: there is no material named `a`"),
        (
            "WorldBegin Include \"missing.pbrt\"",
            "1:20 error: cannot read `missing.pbrt`: there is no such file",
        ),
        ("WorldBegin Shape \"sphere", "1:18 error: this string has no end: `\"` is missing"),
        (
            "Film \"rgb\" \"integer xresolution\" 0 WorldBegin",
            "1:1 error: a picture of 0 x 720 pixels can't be made",
        ),
        ("LookAt 0 0 0 0 0 0 0 1 0 WorldBegin", "1:1 error: `LookAt` has no direction"),
        ("", "1:1 error: the file ends before `WorldBegin`"),
    ] {
        let (_, d) = read_in(Path::new("/nowhere"), text);
        let all = told(&d);
        assert!(all.iter().any(|one| one.starts_with(&format!("a.pbrt:{want}"))), "{text}: {all:?}");
    }
}

#[test]
fn includes_have_places_of_their_own_and_end() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("b.pbrt"), "Translate 1 0 0\nShape \"sphere\" \"float x\" 1\n")
        .unwrap();
    std::fs::write(folder.path().join("c.pbrt"), "Translate 5 0 0 Include \"b.pbrt\"").unwrap();
    std::fs::write(folder.path().join("d.pbrt"), "Include \"d.pbrt\"").unwrap();
    let (translated, d) =
        read_in(folder.path(), "WorldBegin Import \"c.pbrt\" Include \"b.pbrt\" Shape \"disk\"");
    let scene = translated.unwrap().scene;
    let x = |i: usize| scene.world[i].placement().unwrap().point(DVec3::ZERO).x;
    // What is imported leaves the transform as it was.
    assert_eq!([x(0), x(1), x(2)], [6.0, 1.0, 1.0]);
    assert!(
        told(&d)
            .iter()
            .all(|one| one.contains("b.pbrt:2:16 warning: the shape `sphere` has no parameter `x`")),
        "{d}"
    );
    let (_, d) = read_in(folder.path(), "WorldBegin Include \"d.pbrt\"");
    assert!(told(&d)[0].contains("more than 64 deep"), "{d}");
}

#[test]
fn round_shapes_of_version_3_stand_about_z() {
    let scene = sound(
        "WorldBegin Shape \"cone\" \"float radius\" 2 \"float height\" 3 \"float phimax\" 90 \
         Shape \"paraboloid\" \"float radius\" 2 \"float zmin\" 1 \"float zmax\" 4 \
         Shape \"hyperboloid\" \"point3 p1\" [1 0 0] \"point3 p2\" [0 1 2] \
         Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 3 \"float Pz\" [0 1 2 3 4 5]",
    );
    let [Node::Cone(cone), Node::Paraboloid(bowl), Node::Hyperboloid(hyper), Node::Mesh(mesh)] =
        &scene.world[..]
    else {
        panic!("{:?}", scene.world)
    };
    assert_eq!((cone.from, cone.to, cone.radius, cone.phi), (DVec3::ZERO, DVec3::Z * 3.0, 2.0, [0.0, 90.0]));
    assert_eq!((bowl.to, bowl.begin, bowl.radius), (DVec3::Z * 4.0, 0.25, 2.0));
    // Where the ends of its line are put.
    let place = Node::Hyperboloid(hyper.clone()).placement().unwrap();
    let ends = hyper.line.map(|p| place.point(p));
    assert_eq!(ends, [DVec3::X, DVec3::new(0.0, 1.0, 2.0)]);
    assert!(mesh.file.is_some());
    let (_, d) =
        read("WorldBegin Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 2 \"float Pz\" [0 1 2]");
    assert!(told(&d)[0].contains("2 x 2 has as many heights, found 3"), "{d}");
}

#[test]
fn what_moves_is_where_it_is_while_the_shutter_is_open() {
    let moving = "WorldBegin AttributeBegin Translate 1 0 0 ActiveTransform EndTime Translate 0 2 0 ActiveTransform All ";
    let scene = sound(&format!("{moving} Shape \"sphere\" Shape \"disk\" AttributeEnd {SPHERE}"));
    for node in &scene.world[..2] {
        let places: Vec<DVec3> = node.motion().iter().map(|place| place.point(DVec3::ZERO)).collect();
        assert_eq!(places, [DVec3::X, DVec3::new(1.0, 2.0, 0.0)]);
    }
    assert!(scene.world[2].motion().is_empty());
    // An instance that turns keeps its size, while its middle goes straight.
    let scene = sound(
        "WorldBegin ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ActiveTransform EndTime Rotate 180 0 0 1 \
         ActiveTransform All Translate 5 0 0 ObjectInstance \"o\"",
    );
    let [Node::Instance(_)] = &scene.world[..] else { panic!("{:?}", scene.world) };
    for (i, place) in scene.world[0].motion().iter().enumerate() {
        let middle = DVec3::X * (5.0 - 10.0 * i as f64 / 16.0);
        assert!((place.point(DVec3::ZERO) - middle).length() < 1e-9, "{i}");
        assert!((place.vector(DVec3::X).length() - 1.0).abs() < 1e-9, "{i}");
    }
    assert_eq!(scene.world[0].motion().len(), 17);
}

#[test]
fn a_camera_moves_while_its_shutter_is_open() {
    let text = |times: &str| {
        format!(
            "{times} LookAt 0 0 -5 0 0 0 0 1 0 ActiveTransform EndTime Identity LookAt 4 0 -5 4 0 0 0 1 0 ActiveTransform All \
             Camera \"perspective\" WorldBegin {SPHERE}"
        )
    };
    let eyes = |times: &str| {
        let scene = sound(&text(times));
        let observer = scene.camera.observer().clone();
        let later = observer.moving_to.map_or_else(Vec::new, |moving| moving.keyframes);
        std::iter::once(observer.eye.x).chain(later.iter().map(|k| k.eye.unwrap().x)).collect::<Vec<_>>()
    };
    assert_eq!(eyes(""), [0.0, 4.0]);
    // The transforms are those of two seconds, of which the shutter is open for the first.
    let slower = eyes("TransformTimes 0 2");
    assert!(slower.len() == 17 && (slower[16] - 2.0).abs() < 1e-12, "{slower:?}");
}

#[test]
fn light_comes_in_through_its_portal() {
    let scene = sound(
        "WorldBegin Translate 0 0 1 LightSource \"infinite\" \"rgb L\" [1 1 1] \
         \"point3 portal\" [0 0 0  1 0 0  1 2 0  0 2 0]",
    );
    let [Light::Environment(light)] = &scene.lights[..] else { panic!() };
    assert_eq!(light.portals[0].corner, DVec3::Z);
    assert_eq!(light.portals[0].edges, [DVec3::X, DVec3::Y * 2.0]);
    let scene = sound(&format!("Integrator \"lightpath\" \"integer maxdepth\" 3 WorldBegin {SPHERE}"));
    let Integrator::Light(light) = &scene.integrator else { panic!() };
    assert_eq!(light.max_depth, Depth::Edges(4));
}

#[test]
fn packed_files_are_unpacked() {
    let folder = tempfile::tempdir().unwrap();
    let text = b"Shape \"sphere\"";
    let mut packed = vec![0x1f, 0x8b, 8, 8, 0, 0, 0, 0, 0, 3, b'x', 0];
    packed.extend(miniz_oxide::deflate::compress_to_vec(text, 6));
    packed.extend([0; 8]);
    std::fs::write(folder.path().join("b.pbrt.gz"), &packed).unwrap();
    let (translated, d) = read_in(folder.path(), "WorldBegin Include \"b.pbrt.gz\"");
    assert!(d.list.is_empty(), "{d}");
    assert_eq!(translated.unwrap().scene.world.len(), 1);
    std::fs::write(folder.path().join("b.pbrt.gz"), &packed[..14]).unwrap();
    let (_, d) = read_in(folder.path(), "WorldBegin Include \"b.pbrt.gz\"");
    assert!(told(&d)[0].contains("packed by gzip, and damaged"), "{d}");
}

#[test]
fn pictures_all_around_are_of_equal_areas_if_they_are_square() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |w: usize, h: usize| {
        let mut bytes = format!("PF\n{w} {h}\n-1\n").into_bytes();
        bytes.resize(bytes.len() + 12 * w * h, 0x3f);
        bytes
    };
    std::fs::write(folder.path().join("a.pfm"), picture(4, 4)).unwrap();
    std::fs::write(folder.path().join("b.pfm"), picture(4, 2)).unwrap();
    let text = "WorldBegin LightSource \"infinite\" \"string filename\" \"a.pfm\"\n\
                LightSource \"infinite\" \"string filename\" \"b.pfm\"";
    let (translated, d) = read_in(folder.path(), text);
    let layouts: Vec<_> = translated
        .unwrap()
        .scene
        .lights
        .iter()
        .map(|l| if let Light::Environment(e) = l { e.layout.clone() } else { panic!() })
        .collect();
    assert_eq!(layouts, [EnvironmentLayout::EqualArea, EnvironmentLayout::LatitudeLongitude]);
    assert_eq!(
        told(&d),
        ["a.pbrt:2:42 warning: this picture is taken to be in latitude and longitude, since it isn't square"]
    );
}

#[test]
fn depth_counts_the_cameras_edge_too() {
    let scene = sound(&format!(
        "Integrator \"path\" \"integer maxdepth\" 3 Sampler \"halton\" \"integer pixelsamples\" 8 WorldBegin {SPHERE}"
    ));
    let Integrator::Path(p) = &scene.integrator else { panic!() };
    assert_eq!((p.max_depth, scene.sampler.spp), (Depth::Edges(4), 8));
}

#[test]
fn the_words_of_version_3_are_read_with_a_warning() {
    let (scene, d) = read(
        "Film \"image\" \"integer xresolution\" [10] \"integer yresolution\" [10]\nWorldBegin\n\
         Texture \"t\" \"color\" \"checkerboard\" \"rgb tex1\" [1 0 0] \"float uscale\" 4\n\
         Material \"matte\" \"texture Kd\" \"t\"\n\
         Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point P\" [0 0 0 1 0 0 0 1 0]\n\
         TransformBegin Material \"mirror\" \"color Kr\" [.5 .5 .5] Shape \"sphere\" TransformEnd WorldEnd",
    );
    assert!(!d.has_errors(), "{d}");
    assert_eq!(d.list.iter().filter(|one| one.severity == Severity::Warning).count(), 4, "{d}");
    assert_eq!(scene.world.len(), 2);
    assert!(matches!(scene.materials.get("mirror 2"), Some(Material::Mirror(_))));
}

/// Whatever is cut off or changed is told of or not, and no more.
#[test]
fn cut_and_changed_scenes_do_no_harm() {
    let text = "LookAt 0 0 5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" [ 40 ] Film \"rgb\" \"integer xresolution\" 8\n\
                WorldBegin ColorSpace \"rec2020\" Texture \"f\" \"float\" \"constant\" \"float value\" 0.3\n\
                AttributeBegin AreaLightSource \"diffuse\" \"spectrum L\" [ 400 1 700 2 ] \"float power\" 3\n\
                Shape \"loopsubdiv\" \"integer levels\" 1 \"integer indices\" [ 0 1 2 ] \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]\n\
                AttributeEnd Material \"coateddiffuse\" \"texture roughness\" \"f\" \"rgb reflectance\" [ .1 .2 .3 ]\n\
                Shape \"curve\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 2 1 0 ] Shape \"sphere\" \"float zmax\" 0.2\n\
                Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 1 ] Attribute \"shape\" \"float radius\" 2\n\
                ObjectBegin \"o\" Shape \"disk\" \"float innerradius\" .2 ObjectEnd ObjectInstance \"o\"";
    assert!(!read(text).1.has_errors(), "{}", read(text).1);
    let bytes = text.as_bytes();
    for end in 0..bytes.len() {
        read_in(Path::new("/nowhere"), &text[..end]);
    }
    let mut state = 7u32;
    for _ in 0..300 {
        let mut changed = bytes.to_vec();
        for _ in 0..3 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let at = state as usize % changed.len();
            changed[at] = b"\"[]0-9e.# x\n"[(state >> 24) as usize % 12];
        }
        read_in(Path::new("/nowhere"), &String::from_utf8_lossy(&changed));
    }
}
