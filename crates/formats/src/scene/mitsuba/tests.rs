//! Small scenes, rebuilt by hand.

use std::collections::BTreeMap;
use std::path::Path;

use straal_math::DVec3;
use straal_scene::desc::{
    Camera, Filter, Index, Integrator, Light, Mapping, Material, MaterialRef, Node, Scene, Shading, Spectrum,
    Texture, TextureFilter, TextureOf, TextureSpace, Varying,
};
use straal_scene::memory::Ledger;
use straal_scene::value::{Depth, LinearRgb};
use straal_scene::{Diagnostics, validate};

use super::serialized;
use super::tree::Class;
use crate::Limits;
use crate::files::Finder;
use crate::scene::{Foreign, Means, Translated};

/// Reads a scene in a folder, with values for names.
fn read_in(base: &Path, text: &str, define: &[(&str, &str)]) -> (Option<Translated>, Diagnostics) {
    let define: BTreeMap<String, String> =
        define.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    let (mut finder, mut ledger, mut d) = (Finder::default(), Ledger::new(None), Diagnostics::default());
    let mut means = Means {
        base,
        limits: &Limits::default(),
        finder: &mut finder,
        ledger: &mut ledger,
        define: &define,
        frame: 0.0,
        lenient: false,
        size: None,
        d: &mut d,
    };
    let translated = Foreign::Mitsuba.translate("scene.xml", text.as_bytes(), &mut means);
    (translated, d)
}

fn read(text: &str) -> (Scene, Diagnostics) {
    let (translated, d) = read_in(Path::new("/nonexistent"), text, &[]);
    (translated.expect("a scene").scene, d)
}

/// A scene without complaints, but those that start with one of these.
fn sound(text: &str) -> Scene {
    let (scene, d) = read(text);
    assert!(d.list.is_empty(), "{d}");
    scene
}

const SENSOR: &str =
    r#"<integrator type="path"/><sensor type="perspective"><float name="fov" value="30"/></sensor>"#;

fn with(inside: &str) -> String {
    format!("<scene version=\"3.0.0\">{SENSOR}{inside}</scene>")
}

fn complaints(text: &str) -> String {
    read_in(Path::new("/nonexistent"), text, &[]).1.to_string()
}

fn material<'a>(scene: &'a Scene, node: &'a Node) -> &'a Material {
    match node.material() {
        Some(MaterialRef::Inline(m)) => m,
        Some(MaterialRef::Named(link)) => scene.materials.get(&link.name.value).expect("a material"),
        None => panic!("no material"),
    }
}

#[test]
fn a_sensor_looks_along_z_with_x_to_the_left() {
    let scene = sound(
        r#"<scene version="3.0.0"><integrator type="volpath"><integer name="max_depth" value="7"/></integrator>
        <sensor type="thinlens">
          <float name="aperture_radius" value=".25"/><float name="focus_distance" value="6"/><string name="fov_axis" value="smaller"/>
          <float name="fov" value="45"/><float name="principal_point_offset_y" value="0.1"/>
          <transform name="to_world"><rotate y="1" angle="180"/><translate value="1,2,3"/></transform>
          <sampler type="multijitter"><integer name="sample_count" value="16"/></sampler>
          <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="32"/>
            <integer name="crop_offset_x" value="8"/><integer name="crop_width" value="16"/><rfilter type="catmullrom"/></film>
        </sensor></scene>"#,
    );
    let Camera::Perspective(c) = &scene.camera else { panic!() };
    assert_eq!(c.observer.eye, DVec3::new(1.0, 2.0, 3.0));
    assert!((c.observer.look_at - DVec3::new(1.0, 2.0, 2.0)).length() < 1e-12, "{:?}", c.observer);
    assert_eq!((c.fov, c.shift), (Some(45.0), [0.0, -0.1]));
    let lens = c.lens.as_ref().unwrap();
    assert_eq!((lens.radius, lens.focus_distance), (Some(0.25), Some(6.0)));
    assert_eq!((scene.film.size, scene.film.crop), ([64, 32], Some([8, 0, 24, 32])));
    assert!(matches!(&scene.film.filter, Filter::Mitchell(f) if f.b == 0.0 && f.c == 0.5));
    assert_eq!(scene.sampler.spp, 16);
    assert!(matches!(&scene.integrator, Integrator::Path(p) if p.max_depth == Depth::Edges(7)));
}

#[test]
fn a_focal_length_is_of_the_diagonal_of_film() {
    let scene =
        sound(r#"<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"/></scene>"#);
    let Camera::Perspective(c) = &scene.camera else { panic!() };
    // 50 mm before 36 x 24 mm: 46.79 degrees from corner to corner.
    assert!((c.fov.unwrap() - 46.7930).abs() < 1e-3, "{:?}", c.fov);
    assert!(matches!(&scene.film.filter, Filter::Gaussian(g) if g.radius == 2.0 && g.sigma == 0.5));
}

#[test]
fn old_names_have_their_present_form() {
    let scene = sound(
        r##"<scene version="0.5.0"><integrator type="path"><integer name="maxDepth" value="-1"/><integer name="rrDepth" value="9"/></integrator>
        <sensor type="perspective"><string name="fovAxis" value="y"/><float name="nearClip" value="10"/><float name="fov" value="30"/>
          <transform name="toWorld"><lookat origin="0,0,-8" target="0,0,0" up="0,1,0"/></transform>
          <sampler type="ldsampler"><integer name="sampleCount" value="8"/></sampler></sensor>
        <shape type="rectangle"><bsdf type="roughplastic"><float name="intIOR" value="2"/>
          <rgb name="diffuseReflectance" value="0.1 0.2 0.3"/></bsdf></shape>
        <shape type="sphere"><bsdf type="diffuse"><srgb name="diffuseReflectance" value="#ff0000"/></bsdf></shape></scene>"##,
    );
    assert!(matches!(&scene.integrator, Integrator::Path(p) if p.roulette_depth == 9));
    let Material::Plastic(m) = material(&scene, &scene.world[0]) else { panic!() };
    assert_eq!((&m.eta, &m.eta_outside, m.two_sided), (&2.0.into(), &1.000_277.into(), false));
    assert_eq!(m.reflectance, Varying::Constant(Spectrum::Rgb(LinearRgb([0.1, 0.2, 0.3]))));
    let Material::Diffuse(m) = material(&scene, &scene.world[1]) else { panic!() };
    assert_eq!(m.reflectance, Varying::Constant(Spectrum::Rgb(LinearRgb([1.0, 0.0, 0.0]))));
}

#[test]
fn the_index_of_a_metal_may_be_a_texture_relative_to_what_is_around_it() {
    let scene = sound(&with(
        r#"<shape type="sphere"><bsdf type="roughconductor">
          <texture name="eta" type="checkerboard"><rgb name="color0" value=".2"/><rgb name="color1" value="1.5"/></texture>
          <rgb name="k" value="3"/><float name="ext_eta" value="1.5"/></bsdf></shape>"#,
    ));
    let Material::Conductor(m) = material(&scene, &scene.world[0]) else { panic!() };
    let Some(Varying::Texture(eta)) = &m.eta else { panic!("{:?}", m.eta) };
    let TextureOf::Inline(Texture::Scale(scaled)) = &**eta else { panic!("{eta:?}") };
    assert_eq!(scaled.by, Varying::Constant(1.0 / 1.5));
    let Varying::Texture(of) = &scaled.of else { panic!("{scaled:?}") };
    assert!(matches!(&**of, TextureOf::Inline(Texture::Checker(_))), "{of:?}");
    assert_eq!(m.k, Some(Varying::Constant(Spectrum::Rgb(LinearRgb([2.0; 3])))));
}

#[test]
fn bsdfs_have_one_side_unless_twosided_is_around_them() {
    let scene = sound(&with(
        r#"<bsdf type="diffuse" id="a"/>
        <shape type="cube"><ref id="a"/></shape>
        <shape type="cube"><bsdf type="twosided"><ref id="a"/></bsdf></shape>
        <shape type="cube"><bsdf type="twosided"><bsdf type="blendbsdf"><float name="weight" value=".25"/><ref id="a"/><bsdf type="conductor"/></bsdf></bsdf></shape>
        <shape type="cube"><bsdf type="roughdielectric"><string name="ext_ior" value="Water"/><float name="alpha" value=".2"/></bsdf></shape>
        <shape type="cube"/><shape type="cube"><emitter type="area"/></shape>"#,
    ));
    let sides = |node: &Node| match material(&scene, node) {
        Material::Diffuse(m) => m.two_sided,
        _ => panic!(),
    };
    assert_eq!([sides(&scene.world[0]), sides(&scene.world[1])], [false, true]);
    let Material::Mix(m) = material(&scene, &scene.world[2]) else { panic!() };
    assert_eq!(m.weight, Varying::Constant(0.25));
    assert!(matches!(&*m.first, MaterialRef::Named(link) if link.name.value != "a"), "{m:?}");
    assert!(
        matches!(&*m.second, MaterialRef::Inline(m) if matches!(&**m, Material::Mirror(m) if m.two_sided))
    );
    let Material::Dielectric(m) = material(&scene, &scene.world[3]) else { panic!() };
    assert_eq!((&m.eta, &m.eta_outside), (&Index::Constant(1.5046).into(), &Index::Constant(1.333).into()));
    let reflectance = |i: usize| match material(&scene, &scene.world[i]) {
        Material::Diffuse(m) => m.reflectance.clone(),
        _ => panic!(),
    };
    assert_eq!(reflectance(4), Varying::Constant(Spectrum::grey(0.5)));
    assert_eq!(reflectance(5), Varying::Constant(Spectrum::grey(0.0)), "a lamp reflects nothing");
}

#[test]
fn shapes_stand_where_they_do_there() {
    let scene = sound(&with(
        r#"<shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="2"/>
          <transform name="to_world"><translate x="10"/></transform></shape>
        <shape type="cylinder"><point name="p0" value="0,1,0"/><point name="p1" value="0,4,0"/><float name="radius" value=".5"/></shape>
        <shape type="rectangle"><boolean name="flip_normals" value="true"/></shape>
        <shape type="shapegroup" id="g"><shape type="disk"/><shape type="cube"/></shape>
        <shape type="instance"><ref id="g"/><transform name="to_world"><scale value="2"/></transform></shape>
        <shape type="merge"><shape type="disk"/><shape type="disk"/></shape>"#,
    ));
    let at = |i: usize, p: DVec3| scene.world[i].placement().unwrap().point(p);
    // The pole is Mitsuba's z.
    assert_eq!(at(0, DVec3::ZERO), DVec3::new(11.0, 2.0, 3.0));
    assert_eq!(at(0, DVec3::Y), DVec3::new(11.0, 2.0, 5.0));
    assert!((at(1, DVec3::new(1.0, 0.0, 1.0)) - DVec3::new(0.5, 4.0, 0.0)).length() < 1e-12);
    let Node::Rectangle(r) = &scene.world[2] else { panic!() };
    assert!(r.edges[0].cross(r.edges[1]).z < 0.0 && !r.surface.flip);
    let Node::Instance(i) = &scene.world[3] else { panic!() };
    assert_eq!(scene.objects.get(&i.of.name.value).map(|g| g.children().len()), Some(2));
    assert_eq!(scene.world.len(), 6);
    let Node::Mesh(cube) = &scene.objects.get("g").unwrap().children()[1] else { panic!() };
    assert_eq!(cube.shading, Shading::Flat);
}

#[test]
fn lights_and_their_units() {
    let scene = sound(&with(
        r#"<emitter type="spot"><rgb name="intensity" value="1,2,3"/><float name="cutoff_angle" value="40"/>
          <transform name="to_world"><lookat origin="0,4,0" target="0,0,0" up="0,0,1"/></transform></emitter>
        <emitter type="directional" id="sun"><transform name="to_world"><rotate x="1" angle="90"/></transform></emitter>
        <emitter type="point"><transform name="to_world"><translate y="2"/></transform><spectrum name="intensity" value="3"/></emitter>
        <emitter type="constant"><float name="radiance" value="2"/></emitter>
        <shape type="sphere"><emitter type="area"><spectrum name="radiance" value="400:0, 500:8, 700:18"/></emitter></shape>"#,
    ));
    let Light::Spot(l) = &scene.lights[0] else { panic!() };
    assert_eq!((l.position, l.cutoff, l.full_beam()), (DVec3::new(0.0, 4.0, 0.0), 40.0, 30.0));
    assert!((l.axis() + DVec3::Y).length() < 1e-12);
    let Light::Directional(l) = &scene.lights[1] else { panic!() };
    assert!((l.axis() + DVec3::Y).length() < 1e-12);
    assert_eq!(l.name.as_ref().map(|name| &*name.value), Some("sun"));
    let Light::Point(l) = &scene.lights[2] else { panic!() };
    assert_eq!(l.position, DVec3::new(0.0, 2.0, 0.0));
    // The same at all wavelengths isn't white.
    assert!(matches!(&l.intensity, Spectrum::Measured(m) if m.values == [3.0, 3.0]));
    let Node::Sphere(s) = &scene.world[0] else { panic!() };
    let Some(Varying::Constant(Spectrum::Measured(m))) = &s.surface.emission else { panic!() };
    assert_eq!(m.wavelengths, [400.0, 500.0, 700.0]);
}

#[test]
fn sun_and_sky_stand_upright_and_a_mirrored_sensor_mirrors() {
    let scene = sound(
        r#"<scene version="3.0.0"><integrator type="ptracer"/>
        <sensor type="orthographic"><transform name="to_world"><scale x="-3" y="3"/></transform></sensor>
        <emitter type="sunsky"><vector name="sun_direction" value="-.5,.5,.6"/><float name="sun_scale" value="2"/>
          <transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>
        <emitter type="sky"><float name="hour" value="9"/></emitter>
        <emitter type="projector"><rgb name="irradiance" value="1,2,3"/><float name="scale" value="2"/><float name="fov" value="33"/>
          <transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform></emitter></scene>"#,
    );
    assert!(matches!(&scene.camera, Camera::Orthographic(c) if c.width == 6.0 && c.observer.mirror));
    assert!(matches!(scene.integrator, Integrator::Light(_)));
    let Light::Sky(sky) = &scene.lights[0] else { panic!() };
    let all = sky.transform.affine().unwrap();
    // Straal's up is the world's here, and the sun stands where it was said.
    assert!((all.vector(DVec3::Y) - DVec3::Y).length() < 1e-12);
    assert!((all.vector(sky.sun_direction.unwrap()) - DVec3::new(-0.5, 0.5, 0.6)).length() < 1e-12);
    let Light::Sky(sky) = &scene.lights[1] else { panic!() };
    // North is Mitsuba's x, and up its z.
    let all = sky.transform.affine().unwrap();
    assert_eq!((all.vector(-DVec3::Z), all.vector(DVec3::Y)), (DVec3::X, DVec3::Z));
    assert!(sky.sun_scale == 0.0 && sky.when.as_ref().is_some_and(|w| w.hour == 9.0));
    let Light::Projector(l) = &scene.lights[2] else { panic!() };
    assert!((l.intensity - 2.0 * std::f64::consts::PI).abs() < 1e-12 && l.up == DVec3::Y);
}

#[test]
fn pictures_lie_as_they_do_there() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.png"), b"not looked at").unwrap();
    let text = with(
        r#"<texture type="bitmap" id="p"><string name="filename" value="a.png"/><string name="filter_type" value="nearest"/><boolean name="raw" value="true"/></texture>
        <bsdf type="diffuse" id="m"><ref id="p" name="reflectance"/></bsdf>
        <shape type="rectangle"><ref id="m"/></shape><shape type="disk"><ref id="m"/></shape><shape type="sphere"><ref id="m"/></shape>
        <shape type="rectangle"><bsdf type="bumpmap"><ref id="p"/><float name="scale" value="3"/><ref id="m"/></bsdf></shape>"#,
    );
    let (translated, d) = read_in(folder.path(), &text, &[]);
    assert!(d.list.is_empty(), "{d}");
    let scene = translated.unwrap().scene;
    let picture = |i: usize| {
        let Material::Diffuse(m) = material(&scene, &scene.world[i]) else { panic!() };
        let Varying::Texture(t) = &m.reflectance else { panic!() };
        let texture = match &**t {
            TextureOf::Named(link) => scene.textures.get(&link.name.value).unwrap(),
            TextureOf::Inline(texture) => texture,
        };
        let Texture::Image(t) = texture else { panic!() };
        t
    };
    let flat = picture(0);
    assert!(flat.filter == TextureFilter::Nearest && flat.color_space == TextureSpace::Raw);
    let Mapping::Uv(uv) = &flat.mapping else { panic!() };
    // The first row lies at v = 0.
    assert_eq!((uv.scale, uv.translate), ([1.0, -1.0], [0.0, 1.0]));
    assert!(
        matches!(picture(1).mapping, Mapping::Polar(_))
            && matches!(picture(2).mapping, Mapping::Spherical(_))
    );
    let bump = material(&scene, &scene.world[3]).relief().bump.as_ref().unwrap();
    assert_eq!(bump.height, 3.0);
}

#[test]
fn names_stand_for_what_is_said_outside_or_first() {
    let text = r#"<scene version="3.0.0"><default name="n" value="4"/><default name="n" value="5"/><default name="kind" value="pa"/>
        <integrator type="${kind}th"/><sensor type="perspective"><float name="fov" value="$n$n"/>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor></scene>"#;
    let text = text.replace("${kind}th", "$kindth");
    let (translated, d) = read_in(Path::new("/nonexistent"), &text, &[("spp", "9"), ("other", "1")]);
    let scene = translated.unwrap().scene;
    assert!(matches!(&scene.camera, Camera::Perspective(c) if c.fov == Some(44.0)));
    assert_eq!(scene.sampler.spp, 9);
    assert_eq!(d.to_string().trim(), "warning: nothing in this scene is called `$other`");
    assert!(complaints(&text).contains("nothing says what `$spp` is"));
}

#[test]
fn files_are_included_and_looked_for() {
    let folder = tempfile::tempdir().unwrap();
    let (inner, beside) = (folder.path().join("inner"), folder.path().join("inner/scene"));
    std::fs::create_dir_all(&beside).unwrap();
    let bytes =
        serialized::tests::file(4, &[serialized::tests::triangle(0.0), serialized::tests::triangle(7.0)]);
    std::fs::write(inner.join("m.serialized"), bytes).unwrap();
    std::fs::write(
        beside.join("more.xml"),
        r#"<scene version="3.0.0"><shape type="serialized"><string name="filename" value="m.serialized"/><integer name="shape_index" value="1"/></shape></scene>"#,
    )
    .unwrap();
    let (translated, d) = read_in(&beside, &with(r#"<include filename="more.xml"/>"#), &[]);
    let translated = translated.unwrap();
    assert!(d.list.len() == 1 && d.to_string().contains("it is looked for in `..` as well"), "{d}");
    let Node::Mesh(m) = &translated.scene.world[0] else { panic!() };
    let asset = m.file.as_ref().unwrap();
    assert_eq!(translated.made.assets.mesh(asset.handle).mesh.positions[0], [7.0, 0.0, 0.0]);
    assert_eq!(translated.files.len(), 2);
}

#[test]
fn absorbing_media_fill_glass_and_others_are_told() {
    let (scene, d) = read(&with(
        r#"<shape type="sphere"><bsdf type="dielectric"/><medium name="interior" type="homogeneous">
          <float name="albedo" value="0"/><rgb name="sigma_t" value="1,2,3"/><float name="scale" value="2"/></medium></shape>
        <shape type="sphere"><bsdf type="null"/><medium name="interior" type="heterogeneous"/></shape>"#,
    ));
    let Material::Dielectric(m) = material(&scene, &scene.world[0]) else { panic!() };
    assert_eq!(m.interior.sigma_a, Some(Spectrum::Rgb(LinearRgb([2.0, 4.0, 6.0]))));
    assert!(
        matches!(material(&scene, &scene.world[1]), Material::Mask(m) if m.opacity == Varying::Constant(0.0))
    );
    assert!(
        !d.has_errors() && d.to_string().contains("the medium `heterogeneous` isn't rendered yet"),
        "{d}"
    );
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    for (inside, wanted) in [
        (r#"<shape type="shpere"/>"#, "did you mean `sphere`?"),
        (r#"<shape type="sphere"><float name="raduis" value="1"/></shape>"#, "did you mean `radius`?"),
        (r#"<shape type="sphere"><float name="radius" value="x"/></shape>"#, "`x` is no number"),
        (r#"<shape type="sphere"><ref id="nobody"/></shape>"#, "nothing is called `nobody`"),
        (r#"<shape type="instance"/>"#, "an instance needs a `shapegroup`"),
        (r#"<bsdf type="twosided" id="a"><ref id="a"/></bsdf>"#, "`a` is a part of itself"),
        (r#"<shape type="ply"><string name="filename" value="no.ply"/></shape>"#, "cannot read `no.ply`"),
        (r#"<shape type="heightfield"/>"#, "a height field needs a `filename`"),
        (r#"<shape type="deformable"/>"#, "isn't supported: it is left out"),
        (
            r#"<shape type="sphere"><transform name="to_world"><scale x="0"/></transform></shape>"#,
            "has no inverse",
        ),
        (r#"<sphere/>"#, "no element of a scene"),
        (r#"<shape type="sphere" id="a"/><shape type="cube" id="a"/>"#, "the `id` of something already"),
        (
            r#"<shape type="sphere"><bsdf type="conductor"><string name="material" value="Unobtainium"/></bsdf></shape>"#,
            "chromium stands in for it",
        ),
        (
            r#"<shape type="sphere"><bsdf type="diffuse"><rgb name="reflectance" value="2,0,0"/></bsdf></shape>"#,
            "1 is taken",
        ),
        (r#"<shape type="sphere"><bsdf type="measured"/></shape>"#, "grey that scatters evenly"),
    ] {
        let told = complaints(&with(inside));
        assert!(told.contains(wanted) && told.contains("scene.xml:1:"), "{inside}\n{told}");
    }
    let told = complaints("<scene version=\"3.0.0\">\n  <shape type=\"shpere\"/></scene>");
    assert!(told.contains("scene.xml:2:16: error: Mitsuba has no shape `shpere`"), "{told}");
    assert!(complaints("<scene version=\"3.0.0\"/>").contains("nobody looks at this scene"));
    assert!(complaints("<html/>").contains("no scene of Mitsuba"));
    assert!(complaints("<scene").contains("this is not XML"));
}

#[test]
fn what_moves_is_blurred_while_the_shutter_is_open() {
    let scene = |close: &str| {
        sound(&format!(
            r#"<scene version="0.6.0"><integrator type="path"/><sensor type="perspective"><float name="fov" value="30"/>
                <float name="shutterOpen" value="1"/><float name="shutterClose" value="{close}"/>
                <animation name="toWorld"><transform time="1"><translate z="1"/></transform>
                    <transform time="3"><translate z="5"/></transform></animation></sensor>
            <shape type="sphere"><animation name="toWorld"><transform time="2"><translate x="4"/></transform>
                <transform time="0"><rotate y="1" angle="0"/></transform></animation></shape></scene>"#
        ))
    };
    let moving = scene("2");
    let places: Vec<f64> = moving.world[0].motion().iter().map(|m| m.point(DVec3::ZERO).x).collect();
    assert_eq!((places[0], places[8], places[16]), (2.0, 3.0, 4.0));
    let observer = moving.camera.observer();
    assert_eq!(observer.eye, DVec3::Z);
    let keyframes = &observer.moving_to.as_ref().unwrap().keyframes;
    assert_eq!(keyframes.last().unwrap().eye, Some(DVec3::Z * 3.0));
    let still = scene("1");
    assert!(still.world[0].motion().is_empty() && still.camera.observer().moving_to.is_none());
    assert_eq!(still.world[0].placement().unwrap().point(DVec3::ZERO), DVec3::X * 2.0);
}

#[test]
fn nothing_hangs_or_grows_without_end() {
    let entities = "<!DOCTYPE s [<!ENTITY a \"b\">]><scene version=\"3.0.0\">&a;</scene>";
    assert!(complaints(entities).contains("a document type"));
    let deep = format!("{}{}", "<bsdf type=\"twosided\">".repeat(5000), "</bsdf>".repeat(5000));
    assert!(complaints(&with(&deep)).contains("nest deeper"));
    // References in a chain as long as the file.
    let chain: String = (0..1000)
        .map(|i| format!("<bsdf type=\"mask\" id=\"m{i}\"><ref id=\"m{}\"/></bsdf>\n", i + 1))
        .chain([
            "<bsdf type=\"diffuse\" id=\"m1000\"/><shape type=\"cube\"><ref id=\"m0\"/></shape>".to_owned()
        ])
        .collect();
    assert!(complaints(&with(&chain)).contains("objects inside one another"));
    // Each of two others, in reliefs of its own.
    let doubling: String = (0..40)
        .map(|i| {
            let part = |k: u32| format!("<bsdf type=\"bumpmap\"><float name=\"scale\" value=\"{}\"/><texture type=\"checkerboard\"/><ref id=\"m{}\"/></bsdf>", 2 * i + k, i + 1);
            format!("<bsdf type=\"blendbsdf\" id=\"m{i}\"><float name=\"weight\" value=\".5\"/>{}{}</bsdf>", part(0), part(1))
        })
        .chain(["<bsdf type=\"diffuse\" id=\"m40\"/><shape type=\"cube\"><ref id=\"m0\"/></shape>".to_owned()])
        .collect();
    let _ = complaints(&with(&doubling));
    let values: String =
        (0..60).map(|i| format!("<default name=\"a{}z\" value=\"$a{i}z$a{i}z\"/>", i + 1)).collect();
    let long = format!("<default name=\"a0z\" value=\"xxxxxxxx\"/>{values}");
    assert!(complaints(&with(&long)).contains("too long"));
    let folder = tempfile::tempdir().unwrap();
    let twice = "<include filename=\"self.xml\"/>".repeat(2);
    std::fs::write(folder.path().join("self.xml"), format!("<scene version=\"3.0.0\">{twice}</scene>"))
        .unwrap();
    let (_, d) = read_in(folder.path(), &with("<include filename=\"self.xml\"/>"), &[]);
    assert!(d.has_errors() && d.to_string().contains("includes itself"));
}

/// Cut anywhere: a complaint, or a scene that is sound as a whole.
#[test]
fn cut_texts_are_refused() {
    let text = with(
        r#"<bsdf type="twosided" id="a"><bsdf type="roughconductor"><string name="material" value="Au"/><float name="alpha" value=".2"/></bsdf></bsdf>
        <shape type="shapegroup" id="g"><shape type="sphere"><ref id="a"/></shape></shape><shape type="instance"><ref id="g"/></shape>
        <emitter type="envmap"><string name="filename" value="a.hdr"/></emitter>"#,
    );
    for length in 0..text.len() {
        let (translated, mut d) = read_in(Path::new("/nonexistent"), &text[..length], &[]);
        assert!(d.has_errors(), "{length}");
        if let Some(translated) = translated {
            validate::validate(&translated.scene, &mut d);
        }
    }
}

#[test]
fn height_fields_and_ellipsoids_become_what_straal_has() {
    let folder = tempfile::tempdir().unwrap();
    // The last row first, as the format has it.
    let heights = [0.0_f32, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).concat();
    std::fs::write(folder.path().join("h.pfm"), [b"Pf\n3 2\n-1.0\n".as_slice(), &heights].concat()).unwrap();
    let columns = "x y z scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split(' ');
    let columns: String = columns.map(|name| format!("property float {name}\n")).collect();
    let cloud =
        format!("ply\nformat ascii 1.0\nelement vertex 1\n{columns}end_header\n5 0 0 0 0 0 1 0 0 0\n");
    std::fs::write(folder.path().join("c.ply"), cloud).unwrap();
    let text = with(
        r#"<shape type="heightfield"><texture type="bitmap"><string name="filename" value="h.pfm"/></texture>
          <float name="scale" value="3"/><transform name="to_world"><scale value="2"/></transform></shape>
        <shape type="ellipsoids" id="e"><string name="filename" value="c.ply"/><float name="extent" value="2"/>
          <transform name="to_world"><translate y="1"/></transform></shape>"#,
    );
    let (translated, d) = read_in(folder.path(), &text, &[]);
    assert!(d.list.len() == 1 && d.to_string().contains("`ellipsoids` are solids here"), "{d}");
    let translated = translated.unwrap();
    let Node::Mesh(field) = &translated.scene.world[0] else { panic!() };
    let mesh = &translated.made.assets.mesh(field.file.as_ref().unwrap().handle).mesh;
    assert_eq!(mesh.positions[1], [0.0, -1.0, 3.0]);
    let Node::Instances(all) = &translated.scene.world[1] else { panic!() };
    let place = all.transforms[0].0.then(&translated.scene.world[1].placement().unwrap());
    assert_eq!(place.point(DVec3::X), DVec3::new(7.0, 1.0, 0.0));
}

#[test]
fn emitters_are_hidden_from_the_camera_where_the_integrator_says_so() {
    let text = |hides: bool| {
        format!(
            r#"<scene version="3.0.0"><integrator type="aov"><integrator type="path"><boolean name="hide_emitters" value="{hides}"/></integrator></integrator>
            <sensor type="perspective"><float name="fov" value="30"/></sensor><emitter type="constant"/><emitter type="point"/>
            <shape type="sphere"><emitter type="area"/></shape><shape type="cube"/></scene>"#
        )
    };
    for hides in [false, true] {
        let (scene, _) = read(&text(hides));
        let seen: Vec<bool> = scene.lights.iter().map(|light| light.lamp().seen).collect();
        assert_eq!(seen, [!hides; 2]);
        let seen = |i: usize| scene.world[i].surface().unwrap().lamp.seen;
        assert_eq!((seen(0), seen(1)), (!hides, true));
    }
}

/// Each plugin of any version is read, or something says its name: what is known isn't taken for a slip, and nothing is left out in silence.
#[test]
fn every_plugin_is_read_or_told_by_name() {
    let scene = |class: Class, plugin: &str| {
        let of = |tag: &str, inside: &str| format!("<{tag} type=\"{plugin}\">{inside}</{tag}>");
        let file = format!("<string name=\"filename\" value=\"{plugin}.file\"/>");
        let parts = "<bsdf type=\"diffuse\"/>";
        let on_ball = |inside: &str| with(&format!("<shape type=\"sphere\">{inside}</shape>"));
        let seen = |inside: &str| {
            format!(
                "<scene version=\"3.0.0\"><integrator type=\"path\"/><sensor type=\"perspective\">\
                 <float name=\"fov\" value=\"30\"/>{inside}</sensor></scene>"
            )
        };
        match class {
            Class::Shape => with(&of("shape", &file)),
            Class::Bsdf => on_ball(&of("bsdf", parts)),
            Class::Emitter if plugin.contains("area") => on_ball(&of("emitter", "")),
            Class::Emitter => with(&of("emitter", &file)),
            Class::Sensor => {
                let inside = of("sensor", "<float name=\"aperture_radius\" value=\".1\"/>");
                format!("<scene version=\"3.0.0\"><integrator type=\"path\"/>{inside}</scene>")
            }
            Class::Film => seen(&of("film", "")),
            Class::Sampler => seen(&of("sampler", "")),
            Class::Filter => seen(&format!("<film type=\"hdrfilm\">{}</film>", of("rfilter", ""))),
            Class::Integrator => {
                format!(
                    "<scene version=\"3.0.0\">{}<sensor type=\"perspective\"/></scene>",
                    of("integrator", "<integrator type=\"path\"/>")
                )
            }
            Class::Texture => {
                let texture = format!("<texture type=\"{plugin}\" name=\"reflectance\">{file}</texture>");
                on_ball(&format!("<bsdf type=\"diffuse\">{texture}</bsdf>"))
            }
            Class::Medium => {
                on_ball(&format!("<bsdf type=\"null\"/><medium type=\"{plugin}\" name=\"interior\"/>"))
            }
            Class::Volume | Class::Phase | Class::Subsurface | Class::Scene => on_ball(&of(class.word(), "")),
        }
    };
    // Part of what is left out by the name of the medium around them.
    let classes = [
        Class::Shape,
        Class::Bsdf,
        Class::Emitter,
        Class::Sensor,
        Class::Film,
        Class::Sampler,
        Class::Filter,
        Class::Integrator,
        Class::Texture,
        Class::Medium,
        Class::Subsurface,
    ];
    let mut told_of = Vec::new();
    for class in classes {
        for plugin in super::kinds::of(class) {
            let text = scene(class, plugin);
            let told = complaints(&text);
            let is_known = !told.contains(&format!("Mitsuba has no {} `{plugin}`", class.word()));
            assert!(is_known && (told.is_empty() || told.contains(plugin)), "{text}\n{told}");
            if told.contains("isn't supported") {
                told_of.push(*plugin);
            }
        }
    }
    // A new name on the list is noticed here, and so is one whose support is lost.
    let told_of = told_of.join(" ");
    assert_eq!(told_of, TOLD);
}

/// The plugins that are told to be left out or replaced.
const TOLD: &str = "deformable blender measured measured_polarized hair polarizer retarder circular hk irawan \
    directionalarea timed_sunsky collimated radiancemeter irradiancemeter distant telecentric \
    perspective_rdist fluencemeter mfilm depth stokes prb prb_basic prbvolpath direct_projective \
    prb_projective bdpt photonmapper ppm sppm pssmlt mlt erpt adaptive vpl irrcache multichannel \
    field motion volprim_rf_basic gridtexture wireframe curvature dipole singlescatter";

/// A light that stands in the scene itself and is named in a shape is that shape's.
#[test]
fn shapes_share_an_area_light_that_stands_in_the_scene() {
    let light = r#"<emitter type="area" id="glow"><rgb name="radiance" value="1,2,3"/></emitter>"#;
    let shape = r#"<shape type="sphere"><ref id="glow"/></shape>"#;
    for text in [format!("{light}{shape}{shape}"), format!("{shape}{shape}{light}")] {
        let scene = sound(&with(&text));
        let glows = |node: &Node| node.surface().and_then(|s| s.emission.as_ref()).is_some();
        assert_eq!((scene.world.iter().filter(|n| glows(n)).count(), scene.lights.len()), (2, 0));
    }
    assert!(complaints(&with(light)).contains("an area light belongs into a shape"));
}

/// A spectrum where a texture is needed is the same everywhere.
#[test]
fn a_spectrum_may_stand_where_a_texture_does() {
    let scene = sound(&with(
        r#"<shape type="sphere"><bsdf type="normalmap"><texture name="normalmap" type="rawconstant"><vector name="value" value="0.5, 0.5, 1.0"/></texture>
        <bsdf type="diffuse"/></bsdf></shape>"#,
    ));
    let Material::Diffuse(m) = material(&scene, &scene.world[0]) else { panic!("diffuse") };
    let map = m.relief.normal_map.as_ref().expect("a map of normals");
    let TextureOf::Inline(Texture::Scale(s)) = &map.texture else { panic!("a constant texture") };
    assert_eq!(s.of, Varying::Constant(Spectrum::Rgb(LinearRgb([0.5, 0.5, 1.0]))));
}
