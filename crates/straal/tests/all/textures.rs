//! What a texture is told where it is read, by textures that write it down, in whole renders.

use std::path::Path;
use std::sync::{Arc, Mutex};
use straal::{Control, Job, LoadOptions, Overrides};
use straal_math::{Frame, ops};
use straal_render::camera::FilmPoint;
use straal_render::compile::Custom;
use straal_render::footprint::PackedFootprint;
use straal_render::lanes::Rgb;
use straal_render::material::{Black, Bsdf, CustomMaterial, DiffuseMaterial, Material, Wants};
use straal_render::texture::{
    CustomTexture, ReadRgb, ShadingPoint, Texture, TextureKind, TextureRef, Use, Value,
};

/// One colour all over; writes down where it is read.
#[derive(Debug)]
struct Plain {
    rgb: [f32; 3],
    read: Mutex<Vec<ShadingPoint>>,
}

impl CustomTexture for Plain {
    fn rgb(&self, at: &ShadingPoint) -> [f32; 3] {
        self.read.lock().expect("no panic").push(*at);
        self.rgb
    }

    fn fingerprint(&self) -> u64 {
        1
    }
}

fn job(text: &str, wish: Overrides, custom: &Custom) -> Job {
    let loaded = straal::load_str("test.yaml", text, Path::new(""), &LoadOptions::default());
    Job::with_custom(loaded.unwrap_or_else(|d| panic!("{d}")), wish, custom).expect("a world")
}

/// Makes the scene's first material diffuse, of a colour that is read off a texture.
fn textured(job: &mut Job, rgb: [f32; 3]) -> Arc<Plain> {
    let texture = Arc::new(Plain { rgb, read: Mutex::default() });
    let world = &mut job.world;
    let id = world.textures.len() as u32;
    world.textures.push(Texture::new(TextureKind::Custom(texture.clone()), Use::Reflectance));
    let most = rgb.into_iter().fold(0.0, |a: f32, b| if b > a { b } else { a });
    let reflectance = Value::Texture(TextureRef { id, most });
    world.replace_material(
        1,
        Material::Diffuse(DiffuseMaterial { reflectance, ..DiffuseMaterial::default() }),
    );
    texture
}

fn film(job: &Job) -> String {
    let outcome = job.render(&mut Control::to_the_end()).expect("a picture");
    outcome.picture.tells("film_hash").expect("a hash").to_owned()
}

const ROOM: &str = "camera: { perspective: { eye: [0, 1, 6], look_at: [0, 0.5, 0], fov: 40 } }
film: { size: [48, 32] }
sampler: { spp: 4 }
materials:
  paint: { diffuse: { reflectance: [0.8, 0.4, 0.2] } }
  silver: { mirror: {} }
  glass: { dielectric: {} }
objects: { egg: { sphere: { radius: 0.5, material: paint } } }
world:
  - plane: { material: paint }
  - sphere: { center: [-1, 1, 0], radius: 1, material: silver }
  - sphere: { center: [1.3, 0.7, 0.5], radius: 0.7, material: glass }
  - instance: { of: egg, transform: [{ scale: [1, 1.5, 0.8] }, { rotate: { axis: z, degrees: 30 } }, { translate: [0.3, 0.6, 1.5] }] }
lights:
  - environment: { radiance: 1 }
";

#[test]
fn a_texture_of_one_colour_is_that_colour_to_the_bit() {
    let wish = || Overrides { threads: Some(1), ..Overrides::default() };
    let plain = job(ROOM, wish(), &Custom::default());
    let mut other = job(ROOM, wish(), &Custom::default());
    let texture = textured(&mut other, [0.8, 0.4, 0.2]);
    assert_eq!(film(&plain), film(&other));
    assert!(texture.read.lock().unwrap().len() > 1000);
}

#[test]
fn wavelengths_see_a_texture_in_its_colour() {
    let floor = "camera: { perspective: { eye: [0, 3, 0.1], look_at: [0, 0, 0] } }
film: { size: [8, 8] }
sampler: { spp: 64 }
materials: { paint: { diffuse: {} } }
world: [ plane: { material: paint } ]
lights: [ environment: { radiance: 1 } ]
";
    let wish = Overrides { spectral: Some(true), ..Overrides::default() };
    let mut job = job(floor, wish, &Custom::default());
    textured(&mut job, [0.7, 0.4, 0.1]);
    let picture = job.render(&mut Control::to_the_end()).expect("a picture").picture;
    let n = picture.layers.rgb.len() as f64;
    for (c, want) in [0.7, 0.4, 0.1].into_iter().enumerate() {
        let mean: f64 = picture.layers.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / n;
        let error = picture.layers.variance.iter().map(|v| f64::from(v[c])).sum::<f64>().sqrt() / n;
        assert!((mean - want).abs() < 4.5 * error + 0.005, "channel {c}: {mean} for {want}, error {error}");
    }
}

/// Pixels on, the texture coordinates move by the footprint that was told, within 5 per cent: a floor by way of a mirror.
fn footprints_agree(name: &str, mirror: &str, floor: &str, pixel: [u32; 2]) {
    let text = format!(
        "camera: {{ perspective: {{ eye: [0, 1.2, 4], look_at: [0, 0.7, 0], fov: 40 }} }}
film: {{ size: [64, 48], filter: box }}
sampler: {{ spp: 256 }}
integrator: {{ path: {{ max_depth: 3 }} }}
materials: {{ paint: {{ diffuse: {{}} }}, silver: {{ mirror: {{}} }} }}
objects: {{ slab: {{ plane: {{ material: paint }} }} }}
world:
  - {floor}
  - {mirror}
lights: [ environment: {{ radiance: 1 }} ]
"
    );
    // What all samples of a pixel have read, in the mean: their places are spread evenly over it.
    let mean = |[x, y]: [u32; 2]| {
        let wish = Overrides { crop: Some([x, y, x + 1, y + 1]), ..Overrides::default() };
        let mut job = job(&text, wish, &Custom::default());
        let texture = textured(&mut job, [0.5; 3]);
        film(&job);
        let read = texture.read.lock().unwrap();
        assert!(!read.is_empty() && read.len().is_multiple_of(256), "{name}: {} of 256 paths", read.len());
        let of = |f: &dyn Fn(&ShadingPoint) -> f32| {
            read.iter().map(|at| f64::from(f(at))).sum::<f64>() / read.len() as f64
        };
        [0, 1].map(|k| [of(&|at| at.uv[k]), of(&|at| at.duvdx[k]), of(&|at| at.duvdy[k])])
    };
    // Each of a pixel's samples has its own share of the footprint.
    let share = (1..=256).map(|n| ops::max(1.0 / f64::from(n).sqrt() as f32, 0.125)).sum::<f32>() / 256.0;
    let share = f64::from(share);
    let here = mean(pixel);
    for (axis, step) in [[1, 0], [0, 1]].into_iter().enumerate() {
        let after = mean([0, 1].map(|k| pixel[k] + step[k]));
        let before = mean([0, 1].map(|k| pixel[k] - step[k]));
        let found = [0, 1].map(|k| 0.5 * (after[k][0] - before[k][0]));
        let told = here.map(|k| k[1 + axis] / share);
        let length = (found[0] * found[0] + found[1] * found[1]).sqrt();
        for k in 0..2 {
            assert!((found[k] - told[k]).abs() < 0.05 * length, "{name}: {told:?}, found {found:?}");
        }
    }
}

#[test]
fn paths_carry_footprints_by_way_of_mirrors() {
    let plain = "plane: { material: paint }";
    let pane = "rectangle: { corner: [-3, 0, -1], edges: [[6, 0, 0.8], [0, 4, 0.3]], material: silver }";
    footprints_agree("a flat mirror", pane, plain, [30, 27]);
    let ball = "sphere: { center: [0, 1, 0], radius: 1, material: silver }";
    footprints_agree("a round mirror", ball, plain, [36, 30]);
    // Instances transform the surface, not the footprint.
    let turned =
        "instance: { of: slab, transform: [{ scale: [-2, 1, 0.5] }, { rotate: { axis: y, degrees: 25 } }] }";
    footprints_agree("an instance", ball, turned, [28, 31]);
    let flipped = "sphere: { center: [0, 1, 0], radius: 1, material: silver, flip: true }";
    footprints_agree("a flipped mirror", flipped, plain, [36, 30]);
}

/// A material that scatters along a tangent.
#[derive(Debug)]
struct Brushed;

impl CustomMaterial for Brushed {
    fn bsdf(&self, _: &ShadingPoint, _: &dyn ReadRgb) -> Bsdf<'_> {
        Bsdf::Black(Black)
    }

    fn wants(&self) -> Wants {
        Wants { point: true, tangent: true }
    }

    fn fingerprint(&self) -> u64 {
        2
    }
}

#[test]
fn frames_follow_the_texture_where_a_material_wants_it() {
    let text = "camera: { perspective: { eye: [0, 0, 9], look_at: [0, 0, 0], fov: 60 } }
film: { size: [64, 48] }
materials: { steel: { diffuse: {} } }
objects:
  egg: { sphere: { radius: 1 } }
world:
  - sphere: { center: [-3, 2, 0], material: steel }
  - sphere: { center: [0, 2, 0], transform: [{ scale: [1.4, 1, 1] }], material: steel, flip: true }
  - cylinder: { from: [3, 0.6, 0], to: [3.5, 2.5, 0.5], radius: 0.7, material: steel }
  - instance: { of: egg, material: steel, transform: [{ scale: [-1.2, 0.8, 1] }, { translate: [-3, -2, 0] }] }
  - bezier: { builtin: teapot, material: steel, transform: [{ scale: 0.5 }, { translate: [0, -2, 0] }] }
  - rectangle: { corner: [2, -3, 0], edges: [[2, 0, 0.4], [0.5, 2, 0]], material: steel }
";
    let custom = Custom { materials: vec![("steel".to_owned(), Arc::new(Brushed))], ..Custom::default() };
    let job = job(text, Overrides::default(), &custom);
    let world = &job.world;
    let rays: Vec<_> = (0..64 * 48)
        .filter_map(|i| world.camera.ray(&FilmPoint::at([(i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5])))
        .collect();
    let mut hits = vec![straal_accel::Hit::MISS; rays.len()];
    world.closest(&rays, &mut hits);
    let mut seen = std::collections::BTreeSet::new();
    for (ray, hit) in rays.iter().zip(&hits).filter(|(_, hit)| hit.is_hit()) {
        let surface = world.surface(ray, hit, &PackedFootprint::NONE);
        let Frame { s, t, n } = surface.frame;
        let at = surface.at.expect("it wants to know");
        assert_eq!(at.frame, surface.frame);
        for (a, b, want) in [(s, t, 0.0), (s, n, 0.0), (t, n, 0.0), (s, s, 1.0), (t, t, 1.0)] {
            assert!((a.dot(b) - want).abs() < 1e-5, "{:?}", surface.frame);
        }
        let across = at.dpdu - n * n.dot(at.dpdu);
        assert!(across.normalize().dot(s) > 0.9999, "{:?} {:?}", at.dpdu, surface.frame);
        if let Some(ng) = surface.ng {
            let away = surface.frame.to_world(ng).dot(surface.point.ng).abs();
            assert!((away - 1.0).abs() < 1e-4, "{ng:?}");
        }
        seen.insert(hit.geometry);
        // A thing's own place is not where it stands: of an instance's ball, and of one that is moved.
        if hit.geometry == 1 {
            assert!((1.4 * at.object.p.x - at.world.p.x).abs() < 1e-4, "{at:?}");
        }
        if !hit.chain.is_empty() {
            assert!((at.object.p - at.world.p).length() > 0.5);
            assert!((at.object.p.length() - 1.0).abs() < 1e-4);
            assert!((at.object_n - at.object.p).length() < 1e-3, "{at:?}");
        }
        assert_eq!(world.bsdf(&surface, Rgb::default()).albedo().to_rgb(), [0.0; 3]);
    }
    assert!(seen.len() >= 6, "{seen:?}");
}

/// A quarter of a pixel is black and the rest is white: its black neighbour sees nothing of that, since each sample filters no more than its share of the pixel.
#[test]
fn samples_filter_no_more_than_their_share_of_a_pixel() {
    const SCENE: &str =
        "camera: { orthographic: { eye: [0, 0, 5], look_at: [0, 0, 0], up: [0, 1, 0], width: 2 } }
film: { size: [4, 4] }
sampler: { spp: 256 }
world:
  - rectangle: { material: { phong: { reflectance: 0, specular: 0, ambient:
      { texture: { checker: { first: 0, second: 1, squares: [1.7777777777, 1] } } } } } }
lights: [ambient: { radiance: 1 }]
";
    let job = job(SCENE, Overrides::default(), &Custom::default());
    let outcome = job.render(&mut Control::to_the_end()).expect("a picture");
    let pixels = outcome.picture.to_image().pixels;
    for (x, want) in [(1, 0.0), (2, 0.75)] {
        let got = pixels[4 + x][0];
        assert!((got - want).abs() < 0.008, "pixel {x}: {got} for {want}");
    }
}
